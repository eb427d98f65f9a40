!> Checks that a scene with &heat has what heat needs and nothing that it does not cover, and that a
!! scene without it says nothing about heat.
module scene_check_heat
   use base_errors, only: error_t
   use base_kinds, only: rk
   use base_number, only: integer_text
   use scene_parameter_table, only: parameters
   use scene_parameters, only: groups
   use scene_sheet, only: refuse, sheet_t
   use scene_types, only: injection_t, scene_t
   implicit none(type, external)
   private

   public :: check_given_heat, check_heat

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
                  if (record%values(item)%is_set .eqv. sheet%has(trim(rule%only_with))) cycle
                  if (record%values(item)%is_set) then
                     call refuse(error, sheet, i, trim(rule%name), "is given, but the scene "// &
                                 "has no group &"//trim(rule%only_with))
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

   !> Wells that may inject have a temperature, or one per stage.
   pure subroutine check_heat(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i, record

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
   end subroutine check_heat

   !> No fluid of the well can enter the body.
   pure logical function only_extracts(well)
      type(injection_t), intent(in) :: well

      only_extracts = .false.
      if (.not. allocated(well%rate) .or. allocated(well%entries)) return
      only_extracts = .not. (any(well%rate > 0.0_rk) .or. well%storage > 0.0_rk)
   end function only_extracts

end module scene_check_heat
