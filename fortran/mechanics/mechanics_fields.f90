!> Output values of the finite-element state: of elements, fracture cells and points.
module mechanics_fields
   use base_kinds, only: ik, rk
   use base_plane, only: barycentric, turned_left
   use fine_elasticity, only: elasticity_t
   use fine_element, only: line_parameter, line_shapes, shape_values
   use fine_faces, only: face_contact
   use fine_tip_domain, only: face_traction
   use mechanics_body, only: body_t
   implicit none(type, external)
   private

   public :: cell_displacement, cell_stress, fracture_jump, fracture_traction, point_state

   real(rk), parameter :: third = 1.0_rk/3.0_rk

contains

   !> Displacement in the middle of each element [m].
   pure function cell_displacement(body) result(displacement)
      type(body_t), intent(in) :: body
      real(rk) :: displacement(2, body%mesh%n_cells)
      integer(ik) :: cell

      do cell = 1, body%mesh%n_cells
         displacement(:, cell) = matmul(body%displacement(:, body%model%mesh%cell_nodes(:, cell)), &
                                        shape_values(middle_of(body, cell)))
      end do
   end function cell_displacement

   !> Stress in the middle of each element: xx, yy, xy [Pa].
   pure function cell_stress(body) result(stress)
      type(body_t), intent(in) :: body
      real(rk) :: stress(3, body%mesh%n_cells)
      integer(ik) :: cell

      do cell = 1, body%mesh%n_cells
         stress(:, cell) = stress_at(body, cell, middle_of(body, cell), [third, third, third])
      end do
   end function cell_stress

   !> Jump in the middle of each fracture cell: opening and slip along tau [m].
   pure function fracture_jump(body) result(jump)
      type(body_t), intent(in) :: body
      real(rk) :: jump(2, body%mesh%fracture%n_cells)
      real(rk) :: vector(2), tau(2), share(3)
      integer(ik) :: cell

      do cell = 1, body%mesh%fracture%n_cells
         associate (nodes => body%model%mesh%face_nodes(:, :, cell))
            share = line_shapes(line_parameter(0.5_rk, body%model%mesh%face_tip(cell)))
            vector = matmul(body%displacement(:, nodes(:, 2)), share) &
                     - matmul(body%displacement(:, nodes(:, 1)), share)
         end associate
         tau = body%model%mesh%face_tangent(:, cell)
         jump(:, cell) = [dot_product(vector, turned_left(tau)), dot_product(vector, tau)]
      end do
   end function fracture_jump

   !> Traction at the node within each fracture cell: normal, and along tau [Pa].
   pure function fracture_traction(body) result(traction)
      type(body_t), intent(in) :: body
      real(rk) :: traction(2, body%mesh%fracture%n_cells)
      real(rk) :: vector(2), tau(2)
      integer(ik) :: cell

      do cell = 1, body%mesh%fracture%n_cells
         if (body%model%conditions%condition(cell) == face_contact) then
            traction(:, cell) = body%contact%traction([2, 1], 3, cell)
            cycle
         end if
         vector = face_traction(body%model, body%loads, body%displacement, cell)
         tau = body%model%mesh%face_tangent(:, cell)
         traction(:, cell) = [dot_product(vector, turned_left(tau)), dot_product(vector, tau)]
      end do
   end function fracture_traction

   !> Displacement and stress at a point of an element.
   pure subroutine point_state(body, cell, xy, displacement, stress)
      type(body_t), intent(in) :: body
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: xy(2)  !< [m]
      real(rk), intent(out) :: displacement(2)  !< [m]
      real(rk), intent(out) :: stress(3)  !< xx, yy, xy [Pa]
      real(rk) :: area_coordinates(3), lambda(3)

      associate (fine => body%model%mesh)
         area_coordinates = barycentric(fine%xy(:, fine%cell_nodes(1:3, cell)), xy)
         lambda = reference_place(area_coordinates, fine%tip_corner(cell))
         displacement = matmul(body%displacement(:, fine%cell_nodes(:, cell)), shape_values(lambda))
      end associate
      stress = stress_at(body, cell, lambda, area_coordinates)
   end subroutine point_state

   !> Reference coordinates of an element's middle.
   pure function middle_of(body, cell) result(lambda)
      type(body_t), intent(in) :: body
      integer(ik), intent(in) :: cell
      real(rk) :: lambda(3)

      lambda = reference_place([third, third, third], body%model%mesh%tip_corner(cell))
   end function middle_of

   !> Reference coordinates from area coordinates: a quarter-point element maps 1 - lambda of the
   !! tip's corner to its square.
   pure function reference_place(area_coordinates, tip_corner) result(lambda)
      real(rk), intent(in) :: area_coordinates(3)  !< [-]
      integer(ik), intent(in) :: tip_corner
      real(rk) :: lambda(3)
      real(rk) :: t

      lambda = area_coordinates
      if (tip_corner == 0) return
      t = sqrt(max(1.0_rk - area_coordinates(tip_corner), tiny(1.0_rk)))
      lambda = area_coordinates/t
      lambda(tip_corner) = 1.0_rk - t
   end function reference_place

   !> Stress with that in situ: xx, yy, xy [Pa].
   pure function stress_at(body, cell, lambda, area_coordinates) result(stress)
      type(body_t), intent(in) :: body
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: lambda(3), area_coordinates(3)  !< [-]
      real(rk) :: stress(3)
      type(elasticity_t) :: rock
      real(rk) :: temperature, tensor(2, 2)

      rock = body%model%rocks%in_cell(cell)
      temperature = 0.0_rk
      if (allocated(body%loads%heat_pressure)) then
         temperature = dot_product(body%loads%heat_pressure(:, cell), area_coordinates)
      end if
      tensor = rock%total_stress( &
               body%model%displacement_gradient(body%displacement, cell, lambda), temperature)
      stress = [tensor(1, 1), tensor(2, 2), tensor(1, 2)] &
               + matmul(body%loads%initial_stress(:, body%mesh%cell_nodes(:, cell)), &
                        area_coordinates)
   end function stress_at

end module mechanics_fields
