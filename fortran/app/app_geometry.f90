!> Checks that the geometry of a scene can be simulated, before meshing and output. The mesh library
!! checks the geometry; here its faults become sentences about the scene file.
module app_geometry
   use app_simulations, only: first_mesh
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_number, only: integer_text
   use base_plane, only: norm2, point_distance
   use growth_network, only: end_pieces, network_of_scene
   use mesh_builder, only: check_mesh_input, joint_t
   use mesh_faults, only: culprit_corner, culprit_edge, culprit_fixed_point, culprit_fracture, &
                          culprit_t, fault_t, with_name
   use mesh_types, only: network_t
   use report_scene, only: keep_off
   use scene_outline, only: outline_of_scene, outline_t, scene_corner, scene_edge
   use scene_sheet, only: line_text, refuse, sheet_t
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: check_geometry

contains

   !> Refuse a scene whose body or fractures cannot be meshed; expect so many cells otherwise.
   subroutine check_geometry(sheet, scene, n_cells, error)
      type(sheet_t), intent(in) :: sheet  !< file of the scene
      type(scene_t), intent(in) :: scene
      real(rk), intent(out) :: n_cells(2)  !< cells, fracture cells
      type(error_t), allocatable, intent(out) :: error
      type(network_t) :: network
      type(joint_t), allocatable :: joints(:)
      type(fault_t), allocatable :: fault

      network = network_of_scene(scene)
      call check_mesh_input(first_mesh(scene, network), network, joints, fault, n_cells)
      if (allocated(fault)) call refuse_fault(sheet, scene, fault, error)
      if (allocated(error) .or. .not. allocated(scene%regions)) return
      if (scene%growth%intensities) call check_interfaces(sheet, scene, network, joints, error)
   end subroutine check_geometry

   !> Refuse tips next to rock of another stiffness, which have no intensities.
   subroutine check_interfaces(sheet, scene, network, joints, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      type(joint_t), intent(in) :: joints(:)
      type(error_t), allocatable, intent(out) :: error
      type(error_t), allocatable :: too_near
      type(outline_t) :: outline
      real(rk) :: pieces(2, size(network%first) - 1), radius
      integer(ik) :: at, end, f

      outline = outline_of_scene(scene)
      pieces = end_pieces(network)
      do f = 1, size(network%first, kind=ik) - 1
         do end = 1, 2
            at = merge(network%first(f), network%first(f + 1) - 1, end == 1)
            if (.not. is_tip(network%xy(:, at))) cycle
            associate (choice => scene%discretization)
               radius = scene%rosette_radius_of(f)
               if (scene%has_fluid()) radius = min(choice%fine_ratio*scene%cell_size_of(f), &
                                                   0.5_rk*pieces(end, f))
            end associate
            call keep_off(network%xy(:, at), scene, radius, too_near)
            if (.not. allocated(too_near)) cycle
            call refuse(error, sheet, sheet%find("fracture", int(f)), "", &
                        "fracture '"//network%names(f)%text//"': "//too_near%message// &
                        "; move it, or omit intensities and growth")
            return
         end do
      end do

   contains

      !> An end is a tip unless it lies on the boundary or where fractures meet.
      pure logical function is_tip(xy)
         real(rk), intent(in) :: xy(2)  !< [m]
         real(rk), parameter :: same = 1.0e-6_rk  ! distance of equal points over the size of cells
         integer(ik) :: k, next

         is_tip = .false.
         associate (reach => same*scene%smallest_cell(), corners => outline%corners)
            do k = 1, size(joints, kind=ik)
               if (norm2(joints(k)%xy - xy) <= reach) return
            end do
            do k = 1, size(corners, 2, kind=ik)
               next = mod(k, size(corners, 2, kind=ik)) + 1
               if (point_distance(xy, corners(:, [k, next])) <= reach) return
            end do
         end associate
         is_tip = .true.
      end function is_tip

   end subroutine check_interfaces

   !> Raise an error about a fault, at the line of the first object concerned.
   subroutine refuse_fault(sheet, scene, fault, error)
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
   end subroutine refuse_fault

   !> Find the group of the file of an object concerned, and its name in a sentence.
   subroutine identify(sheet, scene, culprit, record, name)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(culprit_t), intent(in) :: culprit
      integer, intent(out) :: record  !< index into sheet%records
      character(len=:), allocatable, intent(out) :: name  !< name in a sentence

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
