!> Units other than SI as endings of names, in scene files and in the columns of their tables:
!! `pressure_mpa = 30`, `rate_l_per_s`. Volumes per time become rates per metre of thickness by the
!! thickness of &scene, once the whole file has been read.
module scene_units
   use base_kinds, only: rk
   use scene_parameter_table, only: parameters
   use scene_parameters, only: kind_real, kind_reals, groups, parameter_t
   use scene_words, only: lower_case
   implicit none(type, external)
   private

   public :: find_with_unit, in_unit, unit_t

   !> A unit, as the ending of a name.
   type :: unit_t
      character(len=10) :: of = ""  !< unit of the parameter, in lower case
      character(len=10) :: ending = ""
      real(rk) :: factor = 1.0_rk  !< one of it in the unit of the parameter [-]
      logical :: per_thickness = .false.  !< still to be divided by the thickness
   end type unit_t

   real(rk), parameter :: barrel = 0.158987294928_rk  ! [m3]
   real(rk), parameter :: minute = 60.0_rk, hour = 3600.0_rk  ! [s]

   !> Units of other quantities than rates; endings of these follow below.
   type(unit_t), parameter :: others(*) = [ &
               unit_t("s", "min", minute), unit_t("s", "h", hour), unit_t("s", "d", 24.0_rk*hour), &
      unit_t("pa", "kpa", 1.0e3_rk), unit_t("pa", "mpa", 1.0e6_rk), unit_t("pa", "gpa", 1.0e9_rk), &
                            unit_t("pa", "bar", 1.0e5_rk), unit_t("pa", "psi", 6894.757293168_rk), &
          unit_t("m", "mm", 1.0e-3_rk), unit_t("m", "cm", 1.0e-2_rk), unit_t("m", "km", 1.0e3_rk), &
                     unit_t("pa m^1/2", "mpa_sqrtm", 1.0e6_rk), unit_t("m2", "md", 9.869233e-16_rk)]

   type(unit_t), parameter :: rates(*) = [ &
                 unit_t("m2/s", "m3_s", 1.0_rk, .true.), unit_t("m2/s", "l_s", 1.0e-3_rk, .true.), &
     unit_t("m2/s", "m3_min", 1.0_rk/minute, .true.), unit_t("m2/s", "m3_h", 1.0_rk/hour, .true.), &
                              unit_t("m2/s", "l_min", 1.0e-3_rk/minute, .true.), &
     unit_t("m2/s", "bbl_min", barrel/minute, .true.), unit_t("m2/s", "bpm", barrel/minute, .true.)]

contains

   !> Whether a name is that of a parameter with the ending of a unit: its own in SI, or another.
   !! The endings of rates may have `_per_` for `_`.
   pure subroutine find_unit(name, parameter, unit, found)
      character(len=*), intent(in) :: name  !< in lower case
      type(parameter_t), intent(in) :: parameter
      type(unit_t), intent(out) :: unit
      logical, intent(out) :: found
      type(unit_t) :: known(size(others) + size(rates))
      character(len=len(name)) :: ending
      integer :: k

      found = .false.
      if (index(name, trim(parameter%name)//"_") /= 1) return
      ending = name(len_trim(parameter%name) + 2:)
      k = index(ending, "_per_")
      if (k > 0) ending = ending(:k)//ending(k + 5:)
      found = ending == si_ending(parameter)
      if (found) return
      known = [others, rates]
      do k = 1, size(known)
         found = known(k)%ending == ending .and. known(k)%of == lower_case(trim(parameter%unit))
         if (.not. found) cycle
         unit = known(k)
         return
      end do
   end subroutine find_unit

   !> Unit of a parameter as the ending of a name: m2/s is m2_s.
   pure function si_ending(parameter) result(ending)
      type(parameter_t), intent(in) :: parameter
      character(len=len(parameter%unit)) :: ending
      integer :: k

      ending = lower_case(parameter%unit)
      do k = 1, len_trim(ending)
         if (scan(ending(k:k), " /") > 0) ending(k:k) = "_"
      end do
   end function si_ending

   !> The parameter of a group whose name with the ending of a unit is given.
   pure subroutine find_with_unit(name, group, item, unit)
      character(len=*), intent(in) :: name  !< in lower case
      integer, intent(in) :: group  !< index into groups
      integer, intent(out) :: item  !< index into parameters; 0: none
      type(unit_t), intent(out) :: unit
      logical :: found

      do item = size(parameters), 1, -1
         if (parameters(item)%group /= groups(group)%name) cycle
         if (all(parameters(item)%kind /= [kind_real, kind_reals])) cycle
         call find_unit(name, parameters(item), unit, found)
         if (found) return
      end do
      item = 0
   end subroutine find_with_unit

   !> A parameter with its range in another unit, for values that are not yet converted.
   pure type(parameter_t) function in_unit(parameter, unit) result(scaled)
      type(parameter_t), intent(in) :: parameter
      type(unit_t), intent(in) :: unit

      scaled = parameter
      if (unit%ending /= "") scaled%unit = unit%ending(:len(scaled%unit))
      associate (range => scaled%range)
         if (abs(range%lowest) < huge(1.0_rk)) range%lowest = range%lowest/unit%factor
         if (abs(range%highest) < huge(1.0_rk)) range%highest = range%highest/unit%factor
      end associate
   end function in_unit

end module scene_units
