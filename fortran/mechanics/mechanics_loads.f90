!> How the scene holds and loads the body: displacements that are given, tractions, forces, gravity
!! and the stress in situ.
module mechanics_loads
   use base_kinds, only: ik, rk
   use fine_boundary, only: add_point_force, add_side_stress, add_side_traction, fine_boundary_t, &
                            free_boundary, hold_side, nearest_node, stand_on_springs
   use fine_in_situ, only: add_in_situ_tractions, set_in_situ_stress
   use fine_loads, only: fine_loads_t, no_loads
   use fine_mesh, only: fine_mesh_t
   use mechanics_faces, only: face_pressure
   use scene_outline, only: sides_of_scene
   use scene_sides, only: boundary_side_t
   use scene_types, only: in_situ_t, scene_t
   implicit none(type, external)
   private

   public :: body_loads, held_boundary

contains

   !> Which displacements are given, and what stands on springs.
   pure function held_boundary(scene, fine) result(boundary)
      type(scene_t), intent(in) :: scene
      type(fine_mesh_t), intent(in) :: fine
      type(fine_boundary_t) :: boundary
      type(boundary_side_t), allocatable :: sides(:)
      integer(ik) :: side, axis, i, node

      sides = sides_of_scene(scene)
      boundary = free_boundary(fine)
      do side = 1, size(sides, kind=ik)
         do axis = 1, 2
            if (sides(side)%displacement_given(axis)) then
               call hold_side(fine, side, axis, boundary)
            else if (sides(side)%spring(axis) > 0.0_rk) then
               call stand_on_springs(fine, side, axis, boundary)
            end if
         end do
      end do
      do i = 1, size(scene%restraints)
         associate (point => scene%restraints(i))
            node = nearest_node(fine, [point%x, point%y])
            boundary%prescribed(:, node) = boundary%prescribed(:, node) .or. &
                                           point%displacement_given
         end associate
      end do
   end function held_boundary

   !> The loads of a scene at a load factor.
   pure function body_loads(scene, fine, factor) result(loads)
      type(scene_t), intent(in) :: scene
      type(fine_mesh_t), intent(in) :: fine
      real(rk), intent(in) :: factor  !< [-]
      type(fine_loads_t) :: loads
      type(boundary_side_t), allocatable :: sides(:)
      integer(ik) :: face, side, axis, i, node, nodes(3)

      sides = sides_of_scene(scene)
      loads = no_loads(fine)
      do face = 1, size(fine%boundary_sides, kind=ik)
         side = fine%boundary_sides(face)
         nodes = [fine%boundary_faces(:, face), fine%boundary_middles(face)]
         do axis = 1, 2
            if (.not. sides(side)%displacement_given(axis)) cycle
            loads%boundary_displacement(axis, nodes) = factor*sides(side)%displacement(axis)
         end do
      end do
      loads%fluid_pressure = factor*face_pressure(scene, fine)
      loads%body_force = scene%material%density*scene%gravity
      call add_in_situ(scene%in_situ, fine, loads)
      do side = 1, size(sides, kind=ik)
         associate (given => sides(side))
            if (any(abs(given%traction) > 0.0_rk)) then
               call add_side_traction(fine, side, factor*given%traction, loads%force)
            end if
            if (any(abs([given%normal_traction, given%shear_traction]) > 0.0_rk)) then
               call add_side_stress(fine, side, factor*given%normal_traction, &
                                    factor*given%shear_traction, loads%force)
            end if
         end associate
      end do
      do i = 1, size(scene%restraints)
         associate (point => scene%restraints(i))
            node = nearest_node(fine, [point%x, point%y])
            where (point%displacement_given)
               loads%boundary_displacement(:, node) = factor*point%displacement
            end where
         end associate
      end do
      do i = 1, size(scene%point_loads)
         associate (point => scene%point_loads(i))
            call add_point_force(fine, [point%x, point%y], factor*point%force, loads%force)
         end associate
      end do
   end function body_loads

   !> The stress in situ, and the tractions on the outer boundary that hold it in equilibrium.
   pure subroutine add_in_situ(in_situ, fine, loads)
      type(in_situ_t), intent(in) :: in_situ
      type(fine_mesh_t), intent(in) :: fine
      type(fine_loads_t), intent(inout) :: loads

      if (.not. (any(abs(in_situ%stress) > 0.0_rk) .or. any(abs(in_situ%per_y) > 0.0_rk))) return
      call set_in_situ_stress(fine, in_situ%stress, in_situ%per_y, in_situ%y_datum, loads)
      call add_in_situ_tractions(fine, loads)
   end subroutine add_in_situ

end module mechanics_loads
