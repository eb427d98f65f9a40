!> Edges of a window on sides of the body: the conditions that the scene prescribes there.
module twolevel_window_sides
   use base_kinds, only: ik, rk
   use fine_boundary, only: add_point_force, add_side_springs, add_side_stress, &
                            add_side_traction, fine_boundary_t, free_boundary, mark_side, &
                            nearest_node
   use fine_mesh, only: fine_mesh_t
   use scene_outline, only: sides_of_scene
   use scene_sides, only: boundary_side_t
   use scene_types, only: point_load_t, restraint_t, scene_t
   implicit none(type, external)
   private

   public :: window_sides, window_sides_t

   !> Sides of a window, by their numbers in its mesh.
   type :: window_sides_t
      type(boundary_side_t), allocatable :: of(:)
      logical, allocatable :: on_body(:)  !< false: the coarse level prescribes the displacement
      type(restraint_t), allocatable :: restraints(:)  !< for the whole body; none in a part of it
      type(point_load_t), allocatable :: point_loads(:)  !< for the whole body; none in a part of it
   contains
      procedure :: change
      procedure :: held_edge
      procedure :: take_given
      procedure :: add_loads
      procedure :: add_springs
      procedure :: have_fronts
   end type window_sides_t

contains

   !> Sides of the whole body, or of a rectangle in it.
   pure function window_sides(scene, is_body, lower, upper) result(sides)
      type(scene_t), intent(in) :: scene
      logical, intent(in) :: is_body
      real(rk), intent(in) :: lower(2), upper(2)  !< corners of the rectangle [m]
      type(window_sides_t) :: sides

      sides%of = sides_of_scene(scene)
      allocate (sides%restraints(0), sides%point_loads(0))
      if (scene%has_points()) then
         sides%restraints = scene%restraints
         sides%point_loads = scene%point_loads
      end if
      if (is_body) then
         sides%on_body = spread(.true., 1, size(sides%of))
      else
         associate (d => scene%domain)
            sides%on_body = [lower(1) <= d%x_min, upper(1) >= d%x_max, &
                             lower(2) <= d%y_min, upper(2) >= d%y_max]
         end associate
      end if
   end function window_sides

   !> Whether a front of temperature may come in from a side of the body.
   pure logical function have_fronts(self)
      class(window_sides_t), intent(in) :: self

      have_fronts = any(self%on_body .and. (self%of%temperature_given .or. &
                                            abs(self%of%heat_flux) > 0.0_rk))
   end function have_fronts

   !> Update the conditions from the scene.
   pure subroutine change(self, scene)
      class(window_sides_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene

      self%of = sides_of_scene(scene)
   end subroutine change

   !> Displacements that are prescribed on the window's edge: all, or those of the scene where the
   !! edge lies on a side of the body.
   pure function held_edge(self, fine) result(boundary)
      class(window_sides_t), intent(in) :: self
      type(fine_mesh_t), intent(in) :: fine
      type(fine_boundary_t) :: boundary
      integer(ik) :: axis, node, side

      boundary = free_boundary(fine)
      do side = 1, size(self%on_body, kind=ik)
         do axis = 1, 2
            if (self%on_body(side) .and. .not. self%of(side)%displacement_given(axis)) then
               if (self%of(side)%spring(axis) > 0.0_rk) then
                  call mark_side(fine, side, axis, boundary%sprung)
               end if
            else
               call mark_side(fine, side, axis, boundary%prescribed)
            end if
         end do
      end do
      do side = 1, size(self%restraints, kind=ik)
         associate (point => self%restraints(side))
            node = nearest_node(fine, [point%x, point%y])
            boundary%prescribed(:, node) = boundary%prescribed(:, node) .or. &
                                           point%displacement_given
         end associate
      end do
   end function held_edge

   !> Replace the coarse displacements by those of the scene where it prescribes displacements on
   !! sides of the body.
   pure subroutine take_given(self, fine, edge)
      class(window_sides_t), intent(in) :: self
      type(fine_mesh_t), intent(in) :: fine
      real(rk), intent(inout) :: edge(:, :)  !< (2, n_nodes) [m]
      integer(ik) :: axis, face, k

      do face = 1, size(fine%boundary_sides, kind=ik)
         associate (side => fine%boundary_sides(face), &
                    nodes => [fine%boundary_faces(:, face), fine%boundary_middles(face)])
            if (.not. self%on_body(side)) cycle
            do axis = 1, 2
               if (.not. self%of(side)%displacement_given(axis)) cycle
               edge(axis, nodes) = self%of(side)%displacement(axis)
            end do
         end associate
      end do
      do k = 1, size(self%restraints, kind=ik)
         associate (point => self%restraints(k))
            associate (place => edge(:, nearest_node(fine, [point%x, point%y])))
               where (point%displacement_given) place = point%displacement
            end associate
         end associate
      end do
   end subroutine take_given

   !> Add the tractions and forces that the scene prescribes.
   pure subroutine add_loads(self, fine, force)
      class(window_sides_t), intent(in) :: self
      type(fine_mesh_t), intent(in) :: fine
      real(rk), intent(inout) :: force(:, :)  !< (2, n_nodes) [N/m]
      integer(ik) :: side

      do side = 1, size(self%on_body, kind=ik)
         if (.not. self%on_body(side)) cycle
         associate (given => self%of(side))
            call add_side_traction(fine, side, given%traction, force)
            if (.not. any(abs([given%normal_traction, given%shear_traction]) > 0.0_rk)) cycle
            call add_side_stress(fine, side, given%normal_traction, given%shear_traction, force)
         end associate
      end do
      do side = 1, size(self%point_loads, kind=ik)
         associate (load => self%point_loads(side))
            call add_point_force(fine, [load%x, load%y], load%force, force)
         end associate
      end do
   end subroutine add_loads

   !> Add the springs on sides of the body.
   pure subroutine add_springs(self, fine, stiffness)
      class(window_sides_t), intent(in) :: self
      type(fine_mesh_t), intent(in) :: fine
      real(rk), intent(inout) :: stiffness(:, :, :)  !< (12, 12, n_cells) [Pa]
      integer(ik) :: side

      do side = 1, size(self%on_body, kind=ik)
         if (self%on_body(side)) call add_side_springs(fine, side, self%of(side)%spring, stiffness)
      end do
   end subroutine add_springs

end module twolevel_window_sides
