!> The stress intensity factors of the interaction integral as linear functions of the nodal
!! displacements.
!!
!! On faces whose traction is given, the integral (tips_interaction) is a constant plus
!!    2 K/E' = int (s_ij hat u_i,1 q,j + hat s_ij u_i,1 q,j - hat s_kl e_kl q,1) dA,  s = C e,
!! so that the displacement gradient g has the coefficients
!!    B = C (hat u,1 (x) q') + (hat s q') (x) e_1 - q,1 hat s.
module tips_extraction
   use base_kinds, only: ik, rk
   use fine_model, only: fine_model_t
   use fine_tip_field, only: auxiliary_field, auxiliary_field_t, root_of_place
   use tips_domain, only: domain_weight, element_rule, reference_angle, rule_size
   use tips_types, only: tip_frame_t
   implicit none(type, external)
   private

   public :: extraction_forces

contains

   !> dK/du of both modes: the nodal forces whose work on a displacement is its share in K.
   pure function extraction_forces(model, frame, radius, plateau) result(force)
      type(fine_model_t), intent(in) :: model
      type(tip_frame_t), intent(in) :: frame
      real(rk), intent(in) :: radius  !< as in interaction_integral [m]
      real(rk), intent(in) :: plateau  !< as in interaction_integral [-]
      real(rk), allocatable :: force(:, :, :)  !< (2, n_nodes, modes) [Pa m^1/2 per m]
      real(rk) :: q(model%mesh%n_nodes)
      integer(ik) :: cell

      allocate (force(2, model%mesh%n_nodes, 2), source=0.0_rk)
      q = domain_weight(model%mesh, frame, radius, plateau)
      do cell = 1, model%mesh%n_cells
         if (any(q(model%mesh%cell_nodes(:, cell)) > 0.0_rk)) then
            call add_cell(model, frame, cell, q, force)
         end if
      end do
      force = 0.5_rk*frame%rock%crack_modulus()*force
   end function extraction_forces

   !> One element's share.
   pure subroutine add_cell(model, frame, cell, q, force)
      type(fine_model_t), intent(in) :: model
      type(tip_frame_t), intent(in) :: frame
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: q(:)  !< (n_nodes) [-]
      real(rk), intent(inout) :: force(:, :, :)  !< (2, n_nodes, modes) d(2 K/E')/du [m^1/2 per m]
      real(rk) :: points(3, rule_size), weights(rule_size)
      real(rk) :: values(6), gradients(2, 6), area_coordinates(3), determinant
      real(rk) :: place(2), q_slope(2), coefficients(2, 2), outer(2, 2), reference
      complex(rk) :: root_z
      type(auxiliary_field_t) :: field
      integer(ik) :: point, n_points, mode, nodes(6), i

      nodes = model%mesh%cell_nodes(:, cell)
      call element_rule(model%mesh, frame, cell, n_points, points, weights)
      reference = reference_angle(model%mesh, frame, cell, q)
      do point = 1, n_points
         call model%mesh%evaluate(cell, points(:, point), values, gradients, area_coordinates, &
                                  determinant)
         place = matmul(frame%axes, matmul(model%mesh%xy(:, nodes), values) - frame%origin)
         gradients = matmul(frame%axes, gradients)
         q_slope = matmul(gradients, q(nodes))
         root_z = root_of_place(place, reference)
         do mode = 1, 2
            field = auxiliary_field(mode, root_z, frame%rock%kolosov(), &
                                    frame%rock%shear_modulus())
            do i = 1, 2
               outer(:, i) = field%slope*q_slope(i)
            end do
            coefficients = frame%rock%total_stress(outer, 0.0_rk) - q_slope(1)*field%stress
            coefficients(:, 1) = coefficients(:, 1) + matmul(field%stress, q_slope)
            force(:, nodes, mode) = force(:, nodes, mode) + weights(point)*determinant &
                                    *matmul(transpose(frame%axes), &
                                            matmul(coefficients, gradients))
         end do
      end do
   end subroutine add_cell

end module tips_extraction
