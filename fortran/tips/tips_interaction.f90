!> Stress intensity factors by the interaction integral in domain form (Stern, Becker and Dunham
!! 1976; Yau, Wang and Corten 1980; Shih and Asaro 1988), with loaded faces, body force, in-situ
!! stress, and the pore pressure as initial stress.
!!
!! In the tip's axes, with the auxiliary field (hat) of unit intensity, total stress s,
!! displacement u, strain e, outward normal m, and a weight q that is 1 at the tip and 0 at the
!! domain's edge:
!!    P_j = s_ij hat u_i,1 + hat s_ij u_i,1 - hat s_kl e_kl delta_1j
!!    M = int P_j q,j dA + int P_j,j q dA - int_faces P_j m_j q ds = 2 K/E'.
!! Since div s = -b, div hat s = 0 and s = C e + s0 with the initial stress s0 (that in situ less
!! biot p I), P_j,j = s0_kl hat e_kl,1 - b_i hat u_i,1. On straight faces through the tip m_1 = 0
!! and hat s m = 0, so that P_j m_j leaves the actual traction t = s m of both sides:
!!    M = int P_j q,j dA + int (s0_kl hat e_kl,1 - b_i hat u_i,1) q dA
!!        - int_faces t_i hat u_i,1 q ds.
!! A uniform stress adds nothing to these three together; so the in-situ stress at the tip is taken
!! off s, s0 and t, which would otherwise lose digits where it is large.
module tips_interaction
   use base_kinds, only: ik, rk
   use fine_line, only: line_shapes
   use fine_loads, only: fine_loads_t
   use fine_mesh, only: fine_mesh_t
   use fine_model, only: fine_model_t
   use fine_quadrature, only: gauss_rule
   use fine_tip_field, only: auxiliary_field, auxiliary_field_t, root_of_place
   use tips_domain, only: domain_weight, element_rule, in_situ_stress, reference_angle, rule_size
   use tips_faces, only: face_traction, traction_source
   use tips_types, only: tip_frame_t
   implicit none(type, external)
   private

   public :: initial_stress, interaction_integral

contains

   !> Stress intensity factors from the domain of the given radius about a tip.
   pure subroutine interaction_integral(model, loads, displacement, frame, radius, plateau, k1, k2)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(tip_frame_t), intent(in) :: frame
      real(rk), intent(in) :: radius  !< where q has fallen to 0, at most largest_radius [m]
      real(rk), intent(in) :: plateau  !< share of the radius within which q = 1 [-]
      real(rk), intent(out) :: k1, k2  !< [Pa m^1/2]
      real(rk) :: q(model%mesh%n_nodes), reference_stress(2, 2), integral(2)
      integer(ik) :: cell

      q = domain_weight(model%mesh, frame, radius, plateau)
      reference_stress = in_situ_stress(loads, frame)
      integral = 0.0_rk
      do cell = 1, model%mesh%n_cells
         if (any(q(model%mesh%cell_nodes(:, cell)) > 0.0_rk)) then
            call add_cell(model, loads, displacement, frame, reference_stress, cell, q, integral)
         end if
      end do
      do cell = 1, model%mesh%fracture%n_cells
         if (any(q(model%mesh%face_nodes(:, 1, cell)) > 0.0_rk)) then
            call add_face(model, loads, displacement, frame, reference_stress, cell, q, integral)
         end if
      end do
      k1 = 0.5_rk*frame%rock%crack_modulus()*integral(1)
      k2 = 0.5_rk*frame%rock%crack_modulus()*integral(2)
   end subroutine interaction_integral

   !> In-situ stress less biot*p at a point of an element, in the tip's axes [Pa].
   pure function initial_stress(loads, biot, frame, corners, area_coordinates) result(stress)
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: biot  !< [-]
      type(tip_frame_t), intent(in) :: frame
      integer(ik), intent(in) :: corners(3)
      real(rk), intent(in) :: area_coordinates(3)  !< [-]
      real(rk) :: stress(2, 2)
      real(rk) :: given(3), pressure
      integer(ik) :: i

      given = matmul(loads%initial_stress(:, corners), area_coordinates)
      stress = reshape([given(1), given(3), given(3), given(2)], [2, 2])
      stress = matmul(frame%axes, matmul(stress, transpose(frame%axes)))
      pressure = dot_product(area_coordinates, loads%pore_pressure(corners))
      do i = 1, 2
         stress(i, i) = stress(i, i) - biot*pressure
      end do
   end function initial_stress

   !> One element's share.
   pure subroutine add_cell(model, loads, displacement, frame, reference_stress, cell, q, integral)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(tip_frame_t), intent(in) :: frame
      real(rk), intent(in) :: reference_stress(2, 2)  !< to take off, in the tip's axes [Pa]
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: q(:)  !< (n_nodes) [-]
      real(rk), intent(inout) :: integral(2)  !< 2 K/E' of both modes [m^1/2]
      real(rk) :: points(3, rule_size), weights(rule_size)
      real(rk) :: values(6), gradients(2, 6), area_coordinates(3), determinant
      real(rk) :: place(2), gradient(2, 2), stress(2, 2), initial(2, 2), q_slope(2), p(2), body(2)
      real(rk) :: q_here, weight, reference, kolosov, shear_modulus
      complex(rk) :: root_z
      type(auxiliary_field_t) :: field
      integer(ik) :: point, n_points, mode, nodes(6)

      nodes = model%mesh%cell_nodes(:, cell)
      call element_rule(model%mesh, frame, cell, n_points, points, weights)
      reference = reference_angle(model%mesh, frame, cell, q)
      kolosov = frame%rock%kolosov()
      shear_modulus = frame%rock%shear_modulus()
      body = matmul(frame%axes, loads%body_force)

      do point = 1, n_points
         call model%mesh%evaluate(cell, points(:, point), values, gradients, area_coordinates, &
                                  determinant)
         weight = weights(point)*determinant
         ! All in the tip's axes.
         place = matmul(frame%axes, matmul(model%mesh%xy(:, nodes), values) - frame%origin)
         gradients = matmul(frame%axes, gradients)
         gradient = matmul(matmul(frame%axes, displacement(:, nodes)), transpose(gradients))
         q_slope = matmul(gradients, q(nodes))
         initial = initial_stress(loads, frame%rock%biot, frame, nodes(1:3), &
                                  area_coordinates) - reference_stress
         stress = frame%rock%total_stress(gradient, 0.0_rk) + initial
         q_here = dot_product(values, q(nodes))
         root_z = root_of_place(place, reference)
         do mode = 1, 2
            field = auxiliary_field(mode, root_z, kolosov, shear_modulus)
            p = matmul(stress, field%slope) + matmul(field%stress, gradient(:, 1))
            p(1) = p(1) - sum(field%stress*gradient)
            integral(mode) = integral(mode) &
                             + weight*(dot_product(p, q_slope) &
                                       + q_here*(sum(initial*field%strain_slope) &
                                                 - dot_product(body, field%slope)))
         end do
      end do
   end subroutine add_cell

   !> One fracture cell's share: its traction on the difference of hat u,1 between the faces.
   pure subroutine add_face(model, loads, displacement, frame, reference_stress, cell, q, integral)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(tip_frame_t), intent(in) :: frame
      real(rk), intent(in) :: reference_stress(2, 2)  !< to take off, in the tip's axes [Pa]
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: q(:)  !< (n_nodes) [-]
      real(rk), intent(inout) :: integral(2)  !< 2 K/E' of both modes [m^1/2]
      integer(ik), parameter :: n_points = 5
      real(rk) :: s(n_points), weights(n_points), traction(2), ends(2, 2), r, x, q_here, weight
      real(rk) :: kolosov, shear_modulus, difference(2)
      type(auxiliary_field_t) :: above, below
      integer(ik) :: point, mode, source

      call gauss_rule(n_points, s, weights)
      source = traction_source(model, frame, cell)
      traction = matmul(frame%axes, face_traction(model, loads, displacement, source)) &
                 - frame%upper*reference_stress(:, 2)
      kolosov = frame%rock%kolosov()
      shear_modulus = frame%rock%shear_modulus()
      associate (nodes => model%mesh%face_nodes(:, 1, cell), &
                 length => model%mesh%face_length(cell), tip_end => model%mesh%face_at_tip(cell))
         ends = model%mesh%xy(:, nodes(1:2))
         do point = 1, n_points
            x = s(point)
            weight = length*weights(point)
            r = norm2((1.0_rk - x)*ends(:, 1) + x*ends(:, 2) - frame%origin)
            if (tip_end > 0) then
               ! r = length*t**2 takes the root out of the integrand; x follows t or t**2.
               r = length*s(point)**2
               weight = 2.0_rk*weight*s(point)
               if (model%mesh%face_tip(cell) == 0) x = x**2
               if (tip_end == 2) x = 1.0_rk - x
            end if
            associate (share => line_shapes(x))
               q_here = share(1)*q(nodes(1)) + share(2)*q(nodes(2)) + share(3)*q(nodes(3))
            end associate
            do mode = 1, 2
               above = auxiliary_field(mode, cmplx(0.0_rk, sqrt(r), rk), kolosov, shear_modulus)
               below = auxiliary_field(mode, cmplx(0.0_rk, -sqrt(r), rk), kolosov, shear_modulus)
               ! The traction is that on side +, the lower one where frame%upper > 0.
               difference = frame%upper*(above%slope - below%slope)
               integral(mode) = integral(mode) + weight*q_here*dot_product(traction, difference)
            end do
         end do
      end associate
   end subroutine add_face

end module tips_interaction
