!> The traction that the fracture faces carry, as the interaction integral needs it.
module tips_faces
   use base_kinds, only: ik, rk
   use fine_faces, only: face_jump, face_loaded, face_slip
   use fine_loads, only: fine_loads_t
   use fine_model, only: fine_model_t
   implicit none(type, external)
   private

   public :: face_tractions

contains

   !> Total traction on side + of a fracture cell (f - p n; side - carries the opposite), in x and y.
   !!
   !! On a loaded cell it is the given one. Where the jump is given it is found from the stresses of the
   !! solution, as the mean of both sides. On a slipping cell the given work f_tau + dilation*(f_n - p)
   !! holds and the normal part is found. In a quarter-point element the stress along an edge is a/t + b with
   !! t = sqrt(r/length); faces carry no singular traction, so a is an error of discretization and is left out.
   pure function face_tractions(model, loads, displacement, cell, position) result(traction)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      integer(ik), intent(in) :: cell  !< fracture cell
      real(rk), intent(in) :: position(:)  !< reference coordinates from start (0) to end (1)
      real(rk) :: traction(2, size(position))  !< [Pa]
      real(rk), parameter :: near = 0.4_rk, far = 0.8_rk  ! two places that separate a/t from b
      real(rk) :: tau(2), n(2), work, at_near(2), at_far(2), normal_part
      integer(ik) :: i

      tau = model%mesh%face_tangent(:, cell)
      n = [-tau(2), tau(1)]
      if (model%conditions%condition(cell) == face_loaded) then
         traction = spread(loads%traction(1, cell)*tau + (loads%traction(2, cell) - loads%fluid_pressure(cell))*n, &
                           2, size(position))
         return
      end if

      if (model%mesh%face_tip(cell) > 0) then
         at_near = recovered(model, loads, displacement, cell, from_tip(near))
         at_far = recovered(model, loads, displacement, cell, from_tip(far))
         traction = spread((far*at_far - near*at_near)/(far - near), 2, size(position))
      else
         do i = 1, size(position)
            traction(:, i) = recovered(model, loads, displacement, cell, position(i))
         end do
      end if

      if (model%conditions%condition(cell) == face_slip) then
         associate (dilation => model%conditions%dilation(cell))
            work = loads%traction(1, cell) + dilation*(loads%traction(2, cell) - loads%fluid_pressure(cell))
            do i = 1, size(position)
               normal_part = dot_product(n, traction(:, i))
               traction(:, i) = (work - dilation*normal_part)*tau + normal_part*n
            end do
         end associate
      end if

   contains

      !> Reference coordinate of a place t from the tip.
      pure real(rk) function from_tip(t)
         real(rk), intent(in) :: t

         from_tip = merge(t, 1.0_rk - t, model%mesh%face_tip(cell) == 1)
      end function from_tip

   end function face_tractions

   !> Mean of the tractions that the stresses of both elements give.
   pure function recovered(model, loads, displacement, cell, position) result(traction)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: position
      real(rk) :: traction(2)
      real(rk) :: lambda(3), gradient(2, 2), pressure, tau(2), ends(2), along
      integer(ik) :: side, k, element

      tau = model%mesh%face_tangent(:, cell)
      traction = 0.0_rk
      do side = 1, 2
         element = model%mesh%face_cells(side, cell)
         associate (face => model%mesh%face_nodes(:, side, cell), nodes => model%mesh%cell_nodes(:, element))
            lambda = 0.0_rk
            do k = 1, 3
               if (nodes(k) == face(1)) lambda(k) = 1.0_rk - position
               if (nodes(k) == face(2)) lambda(k) = position
            end do
            gradient = model%displacement_gradient(displacement, element, lambda)
            ! Pressure is linear in space; along a quarter-point edge space goes with the square.
            along = position
            if (model%mesh%face_tip(cell) == 1) along = position**2
            if (model%mesh%face_tip(cell) == 2) along = 1.0_rk - (1.0_rk - position)**2
            ends = loads%pore_pressure(face(1:2))
            pressure = (1.0_rk - along)*ends(1) + along*ends(2)
         end associate
         traction = traction + 0.5_rk*matmul(model%elasticity%total_stress(gradient, pressure), [-tau(2), tau(1)])
      end do
   end function recovered

end module tips_faces
