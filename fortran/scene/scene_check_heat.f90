!> Checks that a scene with &heat has what heat needs and nothing that it does not cover, and that a
!! scene without it says nothing about heat.
module scene_check_heat
   use base_errors, only: error_t
   use base_kinds, only: rk
   use base_number, only: integer_text
   use scene_check_geometry, only: contains_point, point_text
   use scene_fluid_law, only: viscosity_ratio
   use scene_parameter_table, only: parameters
   use scene_parameters, only: groups
   use scene_sheet, only: refuse, sheet_t
   use scene_types, only: injection_t, scene_t
   use scene_words, only: real_text, rounded_text
   implicit none(type, external)
   private

   public :: check_given_heat, check_heat

   !> Largest relative difference of the viscosity from that of the table, for rounded values [-].
   real(rk), parameter :: rounding = 0.02_rk

contains

   !> Names that need a group of the scene are given with it only; with heat the required ones are
   !! there, and a side has either a temperature or a flux.
   pure subroutine check_given_heat(sheet, error)
      type(sheet_t), intent(in) :: sheet
      type(error_t), allocatable, intent(out) :: error
      integer :: i, item

      do i = 1, sheet%length
         associate (record => sheet%records(i))
            do item = lbound(record%values, 1), ubound(record%values, 1)
               associate (rule => parameters(item))
                  if (rule%only_with == "") cycle
                  if (record%values(item)%is_set .eqv. sheet%has_one(rule%only_with)) cycle
                  if (record%values(item)%is_set) then
                     call refuse(error, sheet, i, trim(rule%name), "is given, but the scene "// &
                                 "has no group &"//alternatives(rule%only_with))
                  else if (rule%absent == "no &heat") then
                     call refuse(error, sheet, i, trim(rule%name), "is missing but must be "// &
                                 "given with &"//trim(rule%only_with))
                  end if
               end associate
               if (allocated(error)) return
            end do
            if (groups(record%group)%name /= "side") cycle
            if (record%is_given("temperature") .and. record%is_given("heat_flux")) then
               call refuse(error, sheet, i, "heat_flux", "is given with temperature, but only "// &
                           "one of them can be prescribed")
               return
            end if
         end associate
      end do
   end subroutine check_given_heat

   !> Wells that may inject have a temperature, or one per stage; the fluid's table contains all
   !! temperatures.
   pure subroutine check_heat(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i, record

      if (allocated(scene%temperature)) call check_expansion(sheet, scene, error)
      if (.not. allocated(scene%heat)) return
      do i = 1, size(scene%injections)
         record = sheet%find("injection", i)
         associate (well => scene%injections(i))
            if (.not. allocated(well%temperature)) then
               if (only_extracts(well)) cycle
               call refuse(error, sheet, record, "temperature", "is missing, but with &heat "// &
                           "a well that may inject must have one")
            else if (size(well%temperature) /= well%stage_count()) then
               call refuse(error, sheet, record, "temperature", "has "// &
                           integer_text(size(well%temperature))//" values but must have one, "// &
                           "or one per stage, "//integer_text(int(well%stage_count())))
            end if
            if (allocated(error)) return
         end associate
      end do
      if (allocated(scene%heat%source_power)) then
         call check_sources(sheet, scene, error)
      else if (scene%heat%source_cell_size > 0.0_rk) then
         call refuse(error, sheet, sheet%find("heat"), "source_cell_size", "is given, but "// &
                     "there is no source_power")
      end if
      if (allocated(error)) return
      if (allocated(scene%fluid%table_temperature)) call check_table(sheet, scene, error)
   end subroutine check_heat

   !> Sources of heat have places in the body.
   pure subroutine check_sources(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      associate (x => scene%heat%source_x, y => scene%heat%source_y, n => size( &
                 scene%heat%source_power))
         if (size(x) /= n .or. size(y) /= n) then
            call refuse(error, sheet, sheet%find("heat"), "source_power", "has "// &
                        integer_text(n)//" values, but source_x and source_y must have as many")
            return
         end if
         do i = 1, n
            if (contains_point(scene%domain, x(i), y(i))) cycle
            call refuse(error, sheet, sheet%find("heat"), "source_x", "and source_y have "// &
                        point_text(x(i), y(i))//", which must lie in the body")
            return
         end do
      end associate
   end subroutine check_sources

   !> Names of groups, by `|`, in words.
   pure function alternatives(names) result(words)
      character(len=*), intent(in) :: names
      character(len=:), allocatable :: words
      integer :: bar

      bar = index(names, "|")
      words = trim(names)
      if (bar > 0) words = names(:bar - 1)//" or &"//trim(names(bar + 1:))
   end function alternatives

   !> A change of temperature acts on some rock.
   pure subroutine check_expansion(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: most

      most = scene%material%heat_expansion
      if (allocated(scene%regions)) then
         most = max(most, maxval(scene%regions%material%heat_expansion))
      end if
      if (most > 0.0_rk) return
      call refuse(error, sheet, sheet%find("material"), "heat_expansion", "is missing, but "// &
                  "&temperature takes one above 0 here or in a region")
   end subroutine check_expansion

   !> The temperatures of the fluid's table increase and contain those of the scene, and at that of
   !! &heat the viscosity of the rock is that of the table.
   pure subroutine check_table(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: range(2), viscosity
      integer :: i, k

      i = sheet%find("fluid")
      associate (heat => scene%heat, fluid => scene%fluid, t => scene%fluid%table_temperature)
         range = heat%temperature + heat%temperature_per_y &
                 *([scene%domain%y_min, scene%domain%y_max] - heat%y_datum)
         range = [minval(range), maxval(range)]
         associate (given => pack(scene%sides%temperature, scene%sides%temperature_given))
            range = [min(range(1), minval(given)), max(range(2), maxval(given))]
         end associate
         do k = 1, size(scene%injections)
            associate (given => scene%injections(k)%temperature)
               if (.not. allocated(scene%injections(k)%temperature)) cycle
               range = [min(range(1), minval(given)), max(range(2), maxval(given))]
            end associate
         end do
         if (size(fluid%viscosity_at) /= size(t)) then
            call refuse(error, sheet, i, "viscosity_at", "has "// &
                        integer_text(size(fluid%viscosity_at))//" values but must have one for "// &
                        "each table_temperature, "//integer_text(size(t)))
         else if (size(t) < 2 .or. .not. all(t(2:) > t(:size(t) - 1))) then
            call refuse(error, sheet, i, "table_temperature", "must have at least two values, "// &
                        "which increase")
         else if (range(1) < t(1) .or. range(2) > t(size(t))) then
            call refuse(error, sheet, i, "table_temperature", "reaches from "//real_text(t(1))// &
                        " to "//real_text(t(size(t)))//" but must contain the temperatures of "// &
                        "the scene, "//real_text(range(1))//" to "//real_text(range(2)))
         else
            viscosity = fluid%viscosity*viscosity_ratio(fluid, heat%temperature)
            if (abs(viscosity - fluid%viscosity) > rounding*viscosity) then
               call refuse(error, sheet, i, "viscosity", "is "//real_text(fluid%viscosity)// &
                           " but must be that of the table at the temperature of &heat, "// &
                           rounded_text(viscosity)//", which the rock takes")
            end if
         end if
      end associate
   end subroutine check_table

   !> No fluid of the well can enter the body.
   pure logical function only_extracts(well)
      type(injection_t), intent(in) :: well

      only_extracts = .false.
      if (.not. allocated(well%rate) .or. allocated(well%entries)) return
      only_extracts = .not. (any(well%rate > 0.0_rk) .or. well%storage > 0.0_rk)
   end function only_extracts

end module scene_check_heat
