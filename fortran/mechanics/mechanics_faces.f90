!> Conditions of the body from the scene: the contact law and prescribed slip of the fracture faces,
!! and supports and loads: prescribed displacements, tractions, forces, gravity, the stress in
!! situ and temperatures.
!!
!! New faces, due to growth, have the contact law of their fracture. Next to a prescribed slip,
!! which is defined for the initial fracture, they touch without friction, and they may open even if
!! the fracture is held closed. A pressure on the faces acts on all of them.
module mechanics_faces
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use base_tolerances, only: same_place
   use fine_boundary, only: add_point_force, add_side_stress, add_side_traction, fine_boundary_t, &
                            free_boundary, mark_side, nearest_node
   use fine_element, only: collapsed_rule
   use fine_faces, only: face_conditions_t, face_contact, loaded_everywhere
   use fine_loads, only: add_in_situ_tractions, fine_loads_t, no_loads, set_in_situ_stress
   use fine_mesh, only: fine_mesh_t
   use growth_network, only: fracture_length
   use mesh_types, only: network_t
   use report_scene, only: law_of_fracture
   use scene_outline, only: sides_of_scene
   use scene_heat, only: temperature_t
   use scene_sides, only: boundary_side_t
   use scene_types, only: fracture_t, in_situ_t, scene_t
   implicit none(type, external)
   private

   public :: body_loads, face_conditions, prescribe_slip, held_boundary

contains

   !> The condition of every fracture cell.
   pure function face_conditions(scene, start, fine) result(conditions)
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: start  !< the scene's network
      type(fine_mesh_t), intent(in) :: fine
      type(face_conditions_t) :: conditions
      integer(ik) :: cell
      logical :: is_old

      conditions = loaded_everywhere(fine)
      do cell = 1, fine%fracture%n_cells
         associate (f => fine%fracture%cell_fracture(cell), law => conditions%law(cell))
            if (scene%fractures(f)%law == "open") cycle
            is_old = was_there(start, f, fine%fracture%cell_s(:, cell))
            law%contact = law_of_fracture(scene%fractures(f))
            if (.not. is_old) law%contact = law%contact%as_grown()
            law%contact%bilateral = scene%fractures(f)%held_closed .and. is_old
            law%slip_given = scene%fractures(f)%law == "slip" .and. is_old
            conditions%condition(cell) = face_contact
         end associate
      end do
   end function face_conditions

   !> The pressure on the faces of every fracture cell at load factor 1 [Pa].
   pure function face_pressure(scene, fine) result(pressure)
      type(scene_t), intent(in) :: scene
      type(fine_mesh_t), intent(in) :: fine
      real(rk) :: pressure(fine%fracture%n_cells)

      pressure = scene%fractures(fine%fracture%cell_fracture(:fine%fracture%n_cells))%face_pressure
   end function face_pressure

   !> A cell belongs to the initial fracture.
   pure logical function was_there(start, f, s)
      type(network_t), intent(in) :: start
      integer(ik), intent(in) :: f
      real(rk), intent(in) :: s(2)  !< arc length of the cell's ends [m]

      associate (length => fracture_length(start, f))
         was_there = minval(s) > -same_place*length .and. maxval(s) < (1.0_rk + same_place)*length
      end associate
   end function was_there

   !> Set the prescribed slip of the nodes of fracture cells at load factor 1.
   pure subroutine prescribe_slip(scene, start, network, fine, jump)
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: start, network  !< initial and grown network
      type(fine_mesh_t), intent(in) :: fine
      real(rk), intent(inout) :: jump(:, :, :)  !< (tau n, start end mid, fracture cells) [m]
      logical :: is_free(2)
      real(rk) :: length
      integer(ik) :: cell, f, k

      do cell = 1, fine%fracture%n_cells
         f = fine%fracture%cell_fracture(cell)
         if (scene%fractures(f)%law /= "slip") cycle
         length = fracture_length(start, f)
         if (.not. was_there(start, f, fine%fracture%cell_s(:, cell))) cycle
         is_free = [.not. network%s_start(f) < 0.0_rk, &
                    .not. fracture_length(network, f) + network%s_start(f) > &
                    (1.0_rk + same_place)*length]
         do k = 1, 3
            jump(1, k, cell) = tapered_slip(scene%fractures(f), length, is_free, &
                                            fine%face_s(k, cell))
         end do
      end do
      call turn_at_kinks(scene, start, fine, jump)
   end subroutine prescribe_slip

   !> Where a prescribed slip d meets a wing, the common node has the mean of both directions as its
   !! tangent (fine_faces): prescribed is the component of d along it. The component across, an
   !! opening of the wing, follows from contact.
   pure subroutine turn_at_kinks(scene, start, fine, jump)
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: start
      type(fine_mesh_t), intent(in) :: fine
      real(rk), intent(inout) :: jump(:, :, :)  !< (tau n, start end mid, fracture cells) [m]
      real(rk) :: tangent(2), along
      integer(ik) :: cell

      do cell = 1, fine%fracture%n_cells - 1  ! cells are stored along each fracture
         associate (f => fine%fracture%cell_fracture, s => fine%fracture%cell_s)
            if (f(cell) /= f(cell + 1) .or. scene%fractures(f(cell))%law /= "slip") cycle
            if (was_there(start, f(cell), s(:, cell)) .eqv. &
                was_there(start, f(cell), s(:, cell + 1))) cycle
         end associate
         tangent = fine%face_tangent(:, cell) + fine%face_tangent(:, cell + 1)
         tangent = tangent/norm2(tangent)
         if (abs(jump(1, 2, cell)) > 0.0_rk) then  ! the slip is on this cell
            along = jump(1, 2, cell)*dot_product(tangent, fine%face_tangent(:, cell))
         else
            along = jump(1, 1, cell + 1)*dot_product(tangent, fine%face_tangent(:, cell + 1))
         end if
         jump(1, 2, cell) = along
         jump(1, 1, cell + 1) = along
      end do
   end subroutine turn_at_kinks

   !> Prescribed slip at an arc length for load factor 1 [m]. It increases from an end without
   !! growth as a quarter of an ellipse; an end with a wing slips like the middle.
   pure real(rk) function tapered_slip(fracture, length, is_free, s) result(slip)
      type(fracture_t), intent(in) :: fracture
      real(rk), intent(in) :: length  !< [m]
      logical, intent(in) :: is_free(2)  !< start, end
      real(rk), intent(in) :: s  !< [m]
      real(rk) :: inwards(2)
      integer :: i

      slip = fracture%slip
      inwards = max(0.0_rk, [s, length - s])/fracture%slip_taper
      do i = 1, 2
         if (.not. is_free(i) .or. inwards(i) >= 1.0_rk) cycle
         slip = slip*sqrt(inwards(i)*(2.0_rk - inwards(i)))
      end do
   end function tapered_slip

   !> Prescribed displacements and springs.
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
               call mark_side(fine, side, axis, boundary%prescribed)
            else if (sides(side)%spring(axis) > 0.0_rk) then
               call mark_side(fine, side, axis, boundary%sprung)
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
      if (allocated(scene%temperature)) then
         loads%heat_pressure = factor*linear_parts(fine, scene%temperature)
      end if
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

   !> Temperatures at the corners of each element, of the linear field with the same integrals
   !! against linear functions: a front may be thinner than the elements.
   pure function linear_parts(fine, temperature) result(corner)
      type(fine_mesh_t), intent(in) :: fine
      type(temperature_t), intent(in) :: temperature  !< at load factor 1
      real(rk) :: corner(3, fine%n_cells)  !< [K]
      integer(ik), parameter :: n = 4  ! points in each direction of a part
      integer, parameter :: most = 24  ! parts of an edge
      real(rk) :: edge, lambda(3), moment(3), points(3, n*n), weights(n*n), xy(2, 3)
      integer(ik) :: c, i, j, point
      integer :: parts

      call collapsed_rule(1_ik, n, n, points, weights)
      do c = 1, fine%n_cells
         xy = fine%xy(:, fine%cell_nodes(:3, c))
         parts = 1
         if (temperature%face_depth > 0.0_rk) then
            edge = sqrt(maxval(sum((xy - cshift(xy, 1, 2))**2, dim=1)))
            parts = int(min(real(most, rk), 1.0_rk + 2.0_rk*edge/temperature%face_depth))
         end if
         moment = 0.0_rk
         do i = 0, parts - 1
            do j = 0, 2*(parts - 1 - i)
               do point = 1, n*n
                  lambda = part_place(points(:, point), i, j, parts)
                  moment = moment + weights(point)*lambda*temperature%at(matmul(xy, lambda))
               end do
            end do
         end do
         moment = 2.0_rk*moment/parts**2
         corner(:, c) = 12.0_rk*moment - 3.0_rk*sum(moment)
      end do
   end function linear_parts

   !> A point of one of the equal parts of a triangle: of a row i, the first of which lies along the
   !! side opposite to corner 3, and of its parts j, every second one of which is turned.
   pure function part_place(of_part, i, j, parts) result(lambda)
      real(rk), intent(in) :: of_part(3)  !< area coordinates in the part [-]
      integer(ik), intent(in) :: i, j
      integer, intent(in) :: parts  !< of an edge
      real(rk) :: lambda(3)  !< [-]

      lambda(2) = real(j/2, rk)
      lambda(3) = real(i, rk)
      if (mod(j, 2_ik) == 0) then
         lambda(2:) = lambda(2:) + of_part(2:)
      else
         lambda(2:) = lambda(2:) + 1.0_rk - of_part(2:)
      end if
      lambda(2:) = lambda(2:)/parts
      lambda(1) = 1.0_rk - lambda(2) - lambda(3)
   end function part_place

   !> Add the stress in situ, and the tractions on the outer boundary that balance it.
   pure subroutine add_in_situ(in_situ, fine, loads)
      type(in_situ_t), intent(in) :: in_situ
      type(fine_mesh_t), intent(in) :: fine
      type(fine_loads_t), intent(inout) :: loads

      if (.not. (any(abs(in_situ%stress) > 0.0_rk) .or. any(abs(in_situ%per_y) > 0.0_rk))) return
      call set_in_situ_stress(fine, in_situ%stress, in_situ%per_y, in_situ%y_datum, loads)
      call add_in_situ_tractions(fine, loads)
   end subroutine add_in_situ

end module mechanics_faces
