!> Checks the laws of a fluid whose density or viscosity follows its pressure.
module scene_check_fluid
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_number, only: integer_text
   use scene_fluid_law, only: fluid_law_t, has_law, new_fluid_law
   use scene_sheet, only: record_t, refuse, sheet_t
   use scene_types, only: fluid_t
   use scene_values, only: value_t
   use scene_words, only: real_text, rounded_text
   implicit none(type, external)
   private

   public :: check_fluid, check_given_fluid

   !> The rock has the values of the table at the reference pressure, but for rounding of both [-].
   real(rk), parameter :: rounding = 0.02_rk

contains

   !> A table has its pressures, and nothing is given that no law takes.
   pure subroutine check_given_fluid(sheet, error)
      type(sheet_t), intent(in) :: sheet
      type(error_t), allocatable, intent(out) :: error
      type(record_t) :: record
      type(value_t) :: density, viscosity
      logical :: is_table
      integer :: i

      if (.not. sheet%has("fluid")) return
      i = sheet%find("fluid")
      record = sheet%records(i)
      density = record%value("density_law")
      viscosity = record%value("viscosity_law")
      is_table = density%text == "table" .or. viscosity%text == "table"
      if (is_table .and. .not. record%is_set("table_pressure")) then
         call refuse(error, sheet, i, "table_pressure", "is missing but must be given with a table")
      else if (.not. is_table .and. record%is_set("table_pressure")) then
         call refuse(error, sheet, i, "table_pressure", "is given, but neither "// &
                     "viscosity_law nor density_law is 'table'")
      else if (density%text == "linear" .and. viscosity%text == "constant" .and. &
               record%is_set("reference_pressure")) then
         call refuse(error, sheet, i, "reference_pressure", "is given, but neither "// &
                     "viscosity_law nor density_law depends on it; leave it out")
      end if
   end subroutine check_given_fluid

   !> Tables rise, hold the reference pressure, and say of it what the rock takes.
   pure subroutine check_fluid(sheet, fluid, error)
      type(sheet_t), intent(in) :: sheet
      type(fluid_t), intent(in) :: fluid
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      if (.not. has_law(fluid)) return
      i = sheet%find("fluid")
      if (allocated(fluid%table_pressure)) then
         call check_pressures(sheet, i, fluid, error)
         if (.not. allocated(error) .and. fluid%viscosity_law == "table") then
            call check_length(sheet, i, "table_viscosity", fluid%table_viscosity, fluid, error)
         end if
         if (.not. allocated(error) .and. fluid%density_law == "table") then
            call check_length(sheet, i, "table_density", fluid%table_density, fluid, error)
            if (.not. allocated(error)) call check_density(sheet, i, fluid, error)
         end if
         if (.not. allocated(error)) call check_rock(sheet, i, fluid, error)
      end if
      if (allocated(error)) return
      if (fluid%density_law == "exponential" .and. .not. fluid%compressibility > 0.0_rk) then
         call refuse(error, sheet, i, "density_law", "is 'exponential', which takes a "// &
                     "compressibility that is positive, and not 0.0")
      end if
   end subroutine check_fluid

   pure subroutine check_pressures(sheet, i, fluid, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: i  !< record
      type(fluid_t), intent(in) :: fluid
      type(error_t), allocatable, intent(out) :: error
      integer :: n

      associate (p => fluid%table_pressure, reference => fluid%reference_pressure)
         n = size(p)
         if (n < 2) then
            call refuse(error, sheet, i, "table_pressure", "has 1 value but must have at least two")
         else if (.not. all(p(2:) > p(:n - 1))) then
            call refuse(error, sheet, i, "table_pressure", "must rise, and does not from "// &
                        real_text(p(falls(p)))//" to "//real_text(p(falls(p) + 1)))
         else if (reference < p(1) .or. reference > p(n)) then
            call refuse(error, sheet, i, "table_pressure", "reaches from "//real_text(p(1))// &
                        " to "//real_text(p(n))//" but must hold the reference_pressure, "// &
                        real_text(reference))
         end if
      end associate
   end subroutine check_pressures

   !> The first value that the next one does not exceed.
   pure integer function falls(list)
      real(rk), intent(in) :: list(:)  !< [any unit]

      falls = findloc(list(2:) > list(:size(list) - 1), .false., dim=1)
   end function falls

   pure subroutine check_length(sheet, i, name, list, fluid, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: i  !< record
      character(len=*), intent(in) :: name
      real(rk), intent(in) :: list(:)  !< [unit of the name]
      type(fluid_t), intent(in) :: fluid
      type(error_t), allocatable, intent(out) :: error

      if (size(list) == size(fluid%table_pressure)) return
      call refuse(error, sheet, i, name, "has "//integer_text(size(list, kind=ik))// &
                  merge(" value ", " values", size(list) == 1)//" but must have one for each "// &
                  "table_pressure, "//integer_text(size(fluid%table_pressure, kind=ik)))
   end subroutine check_length

   !> No liquid gets lighter under pressure.
   pure subroutine check_density(sheet, i, fluid, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: i  !< record
      type(fluid_t), intent(in) :: fluid
      type(error_t), allocatable, intent(out) :: error
      integer :: k

      associate (density => fluid%table_density)
         do k = 1, size(density) - 1
            if (density(k + 1) >= density(k)) cycle
            call refuse(error, sheet, i, "table_density", "must not fall, and does from "// &
                        real_text(density(k))//" to "//real_text(density(k + 1)))
            return
         end do
      end associate
   end subroutine check_density

   !> What the rock takes is what the tables say at the reference pressure: the viscosity there, and
   !! a compressibility between those of the pieces that meet there.
   pure subroutine check_rock(sheet, i, fluid, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: i  !< record
      type(fluid_t), intent(in) :: fluid
      type(error_t), allocatable, intent(out) :: error
      type(fluid_law_t) :: law
      real(rk) :: bounds(2), viscosity

      law = new_fluid_law(fluid)
      if (fluid%viscosity_law == "table") then
         viscosity = fluid%viscosity*law%thickness_at(fluid%reference_pressure)
         if (abs(viscosity - fluid%viscosity) > rounding*viscosity) then
            call refuse(error, sheet, i, "viscosity", "is "//real_text(fluid%viscosity)// &
                        " but must be that of the table at reference_pressure, "// &
                        rounded_text(viscosity)//", which the rock takes")
            return
         end if
      end if
      if (fluid%density_law /= "table") return
      bounds = law%compressibility(law%reference - 1:law%reference)
      ! Beyond an end of the table there is none.
      if (law%reference == 1) bounds(1) = bounds(2)
      if (law%reference == size(law%pressure)) bounds(2) = bounds(1)
      if (fluid%compressibility < (1.0_rk - rounding)*minval(bounds) .or. &
          fluid%compressibility > (1.0_rk + rounding)*maxval(bounds)) then
         call refuse(error, sheet, i, "compressibility", "is "// &
                     real_text(fluid%compressibility)//" but must be that of the table at "// &
                     "reference_pressure, "//rounded_text(0.5_rk*sum(bounds))// &
                     ", which the rock takes")
      end if
   end subroutine check_rock

end module scene_check_fluid
