!> Whether the geometry of a scene can be simulated, before anything is meshed or written. The mesh
!! library judges; here its verdict becomes a sentence about the scene file.
module app_geometry
   use app_simulations, only: first_mesh
   use base_errors, only: error_t
   use base_kinds, only: ik
   use base_number, only: integer_text
   use growth_network, only: network_of_scene
   use scene_outline, only: scene_corner, scene_edge
   use mesh_check, only: check_mesh_input, joint_t
   use mesh_faults, only: culprit_corner, culprit_edge, culprit_fixed_point, culprit_fracture, &
                          culprit_t, fault_t, with_name
   use mesh_types, only: network_t
   use scene_sheet, only: line_text, refuse, sheet_t
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: check_geometry

contains

   !> Refuse a scene whose body or fractures cannot be meshed.
   subroutine check_geometry(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet  !< where the scene comes from
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      type(network_t) :: network
      type(joint_t), allocatable :: joints(:)
      type(fault_t), allocatable :: fault

      network = network_of_scene(scene)
      call check_mesh_input(first_mesh(scene, network), network, joints, fault)
      if (allocated(fault)) call blame(sheet, scene, fault, error)
   end subroutine check_geometry

   !> Put a fault into words, at the line of the first culprit.
   subroutine blame(sheet, scene, fault, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(fault_t), intent(in) :: fault
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: reason, name
      integer :: record, first_record, i

      reason = fault%reason
      first_record = sheet%find("domain")
      do i = 1, size(fault%culprits)
         call identify(sheet, scene, fault%culprits(i), record, name)
         if (i == 1) then
            first_record = record
         else if (all(record /= [first_record, sheet%find("domain")])) then
          name = name//" ("//line_text(sheet, record, sheet%records(record)%line, first_record)//")"
         end if
         reason = with_name(reason, "{"//integer_text(int(i, ik))//"}", name)
      end do
      call refuse(error, sheet, first_record, "", reason)
   end subroutine blame

   !> Which group of the file a culprit comes from, and what a sentence calls it.
   subroutine identify(sheet, scene, culprit, record, name)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(culprit_t), intent(in) :: culprit
      integer, intent(out) :: record
      character(len=:), allocatable, intent(out) :: name

      record = sheet%find("domain")
      select case (culprit%kind)
      case (culprit_fracture)
         record = sheet%find("fracture", int(culprit%number))
         name = "fracture '"//trim(scene%fractures(culprit%number)%name)//"'"
      case (culprit_corner)
         name = "a corner of the domain"
         if (scene%domain%shape == "polygon") then
            name = "corner "//integer_text(scene_corner(scene%domain, culprit%number))
         end if
      case (culprit_edge)
         name = "a side of the domain"
         if (scene%domain%shape == "polygon") then
            name = "edge "//integer_text(scene_edge(scene%domain, culprit%number))
         end if
      case (culprit_fixed_point)
         associate (n => size(scene%restraints))
            if (culprit%number <= n) then
               record = sheet%find("restraint", int(culprit%number))
               name = "the restraint"
            else
               record = sheet%find("point_load", int(culprit%number) - n)
               name = "the point load"
            end if
         end associate
      case default
         name = "something"
      end select
   end subroutine identify

end module app_geometry
