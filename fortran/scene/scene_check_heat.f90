!> Checks that a scene with &heat has what heat needs and nothing that it does not cover, and that a
!! scene without it says nothing about heat.
module scene_check_heat
   use base_errors, only: error_t
   use base_kinds, only: rk
   use base_number, only: integer_text
   use scene_parameters, only: groups
   use scene_sheet, only: refuse, sheet_t
   use scene_types, only: injection_t, scene_t
   implicit none(type, external)
   private

   public :: check_given_heat, check_heat

contains

   !> Names that only heat uses are given with it, and required ones are there.
   pure subroutine check_given_heat(sheet, error)
      type(sheet_t), intent(in) :: sheet
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, sheet%length
         select case (groups(sheet%records(i)%group)%name)
         case ("material")
            call check_name(sheet, i, "heat_capacity", .true., error)
            if (.not. allocated(error)) call check_name(sheet, i, "heat_conductivity", .true., &
                                                        error)
         case ("fluid")
            call check_name(sheet, i, "heat_capacity", .true., error)
         case ("region")
            call check_name(sheet, i, "heat_capacity", .false., error)
            if (.not. allocated(error)) call check_name(sheet, i, "heat_conductivity", .false., &
                                                        error)
         case ("injection")
            call check_name(sheet, i, "temperature", .false., error)
         case ("side")
            call check_name(sheet, i, "temperature", .false., error)
            if (.not. allocated(error)) call check_name(sheet, i, "heat_flux", .false., error)
            if (allocated(error)) return
            if (sheet%records(i)%is_given("temperature") .and. &
                sheet%records(i)%is_given("heat_flux")) then
               call refuse(error, sheet, i, "heat_flux", "is given with temperature, but only "// &
                           "one of them can be prescribed")
            end if
         end select
         if (allocated(error)) return
      end do
   end subroutine check_given_heat

   !> A name is given with &heat only, or always with it.
   pure subroutine check_name(sheet, i, name, is_needed, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: i  !< index of the record
      character(len=*), intent(in) :: name
      logical, intent(in) :: is_needed
      type(error_t), allocatable, intent(out) :: error

      associate (is_set => sheet%records(i)%is_set(name), has_heat => sheet%has("heat"))
         if (is_set .and. .not. has_heat) then
            call refuse(error, sheet, i, name, "is given, but the scene has no group &heat")
         else if (is_needed .and. has_heat .and. .not. is_set) then
            call refuse(error, sheet, i, name, "is missing but must be given with &heat")
         end if
      end associate
   end subroutine check_name

   !> What heat does not cover yet, and temperatures of wells.
   pure subroutine check_heat(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i, record

      if (.not. allocated(scene%heat)) return
      if (scene%growth%enabled) then
         call refuse(error, sheet, sheet%find("heat"), "", "is given with growth, but heat is "// &
                     "not carried over to grown fractures yet; omit &heat or set enabled of "// &
                     "&growth to .false.")
         return
      end if
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
