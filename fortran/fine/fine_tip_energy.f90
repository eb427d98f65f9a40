!> Energy release rate of a tip by the J-integral in domain form (Rice 1968; Li, Shih and Needleman
!! 1985), with loaded faces, body force, in-situ stress and pore pressure.
!!
!! With total stress s = C e + s0, the energy density W = e C e/2 + s0 e, and the weight q of the
!! domain,
!!    J = int (s_ij u_i,1 - W delta_1j) q,j dA - int (b_i u_i,1 + s0_ij,1 e_ij) q dA
!!        - int_faces t_i u_i,1 q ds,
!! as the divergence of s_ij u_i,1 - W delta_1j is -b_i u_i,1 - s0_ij,1 e_ij. The faces move by
!! their jump against each other: the last integral is that of the traction on side + times [u],1.
!! For straight extension J = G = (K_I**2 + K_II**2)/E'.
!!
!! Stress intensity factors from the displacements of the crack faces next to the tip.
module fine_tip_energy
   use base_kinds, only: ik, pi, rk
   use base_plane, only: triangle_area
   use fine_elasticity, only: elasticity_t
   use fine_element, only: gauss_rule, line_shapes, line_slopes, tip_rule_size
   use fine_loads, only: fine_loads_t
   use fine_mesh, only: fine_mesh_t
   use fine_model, only: fine_model_t
   use fine_tip_domain, only: domain_weight, element_rule, face_traction, in_situ_stress, &
                              is_joint, joint_deviation, traction_source
   use fine_tip_types, only: tip_frame_t
   implicit none(type, external)
   private

   public :: displacement_correlation, release_rate

contains

   !> G of straight extension [J/m2].
   pure function release_rate(model, loads, displacement, frame, radius, plateau) result(g)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(tip_frame_t), intent(in) :: frame
      real(rk), intent(in) :: radius  !< of the domain [m]
      real(rk), intent(in) :: plateau  !< share of the radius within which q = 1 [-]
      real(rk) :: g
      real(rk) :: q(model%mesh%n_nodes), reference_stress(2, 2)
      logical :: is_within
      integer(ik) :: cell, k

      q = domain_weight(model%mesh, frame, radius, plateau)
      reference_stress = in_situ_stress(loads, frame, frame%node)
      g = 0.0_rk
      do cell = 1, model%mesh%n_cells
         is_within = .false.
         do k = 1, 6
            is_within = is_within .or. q(model%mesh%cell_nodes(k, cell)) > 0.0_rk
         end do
         if (.not. is_within) cycle
         g = g + cell_share(model, loads, displacement, frame, reference_stress, cell, q)
      end do
      do cell = 1, model%mesh%fracture%n_cells
         if (any(q(model%mesh%face_nodes(:, 1, cell)) > 0.0_rk)) then
            g = g + face_share(model, loads, displacement, frame, reference_stress, cell, q)
         end if
      end do
   end function release_rate

   !> The integrals over one element.
   pure real(rk) function cell_share(model, loads, displacement, frame, reference_stress, cell, q)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(tip_frame_t), intent(in) :: frame
      real(rk), intent(in) :: reference_stress(2, 2)  !< to take off, in the tip's axes [Pa]
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: q(:)  !< (n_nodes) [-]
      real(rk) :: points(3, tip_rule_size), weights(tip_rule_size)
      real(rk) :: values(6), gradients(2, 6), area_coordinates(3), determinant
      real(rk) :: gradient(2, 2), elastic(2, 2), initial(2, 2), slope(2, 2), q_slope(2), p(2)
      real(rk) :: body(2), density, corner(2, 2, 3), moved(2, 6), q_nodes(6), place(2, 3), along(2)
      integer(ik) :: i, k, n_points, node, point

      call element_rule(model%mesh, frame, cell, n_points, points, weights)
      ! All in the tip's axes.
      associate (axes => frame%axes)
         do k = 1, 6
            node = model%mesh%cell_nodes(k, cell)
            q_nodes(k) = q(node)
            moved(:, k) = axes(:, 1)*displacement(1, node) + axes(:, 2)*displacement(2, node)
            if (k > 3) cycle
            place(:, k) = axes(:, 1)*model%mesh%xy(1, node) + axes(:, 2)*model%mesh%xy(2, node)
            corner(:, :, k) = initial_stress(loads, frame, node, k, cell) - reference_stress
         end do
      end associate
      slope = slope_along(place, corner)
      body = matmul(frame%axes, loads%body_force)
      cell_share = 0.0_rk
      do point = 1, n_points
         call model%mesh%evaluate(cell, points(:, point), values, gradients, area_coordinates, &
                                  determinant)
         gradient = 0.0_rk
         q_slope = 0.0_rk
         do k = 1, 6
            along = frame%axes(:, 1)*gradients(1, k) + frame%axes(:, 2)*gradients(2, k)
            q_slope = q_slope + along*q_nodes(k)
            do i = 1, 2
               gradient(:, i) = gradient(:, i) + moved(:, k)*along(i)
            end do
         end do
         elastic = frame%rock%total_stress(gradient, 0.0_rk)
         initial = area_coordinates(1)*corner(:, :, 1) + area_coordinates(2)*corner(:, :, 2) &
                   + area_coordinates(3)*corner(:, :, 3)
         density = sum((0.5_rk*elastic + initial)*gradient)
         p = matmul(elastic + initial, gradient(:, 1)) - [density, 0.0_rk]
         cell_share = cell_share + weights(point)*determinant &
                      *(dot_product(p, q_slope) - dot_product(values, q_nodes) &
                        *(dot_product(body, gradient(:, 1)) + sum(slope*gradient)))
      end do
   end function cell_share

   !> In-situ stress less biot*p at a vertex, in the tip's axes [Pa].
   pure function initial_stress(loads, frame, vertex, k, cell) result(stress)
      type(fine_loads_t), intent(in) :: loads
      type(tip_frame_t), intent(in) :: frame
      integer(ik), intent(in) :: vertex
      integer(ik), intent(in) :: k, cell  !< it is corner k of this cell
      real(rk) :: stress(2, 2)
      integer(ik) :: i

      stress = in_situ_stress(loads, frame, vertex)
      do i = 1, 2
         stress(i, i) = stress(i, i) - frame%rock%biot*loads%pore_pressure(vertex)
         if (allocated(loads%heat_pressure)) stress(i, i) = stress(i, i) &
         & - frame%rock%biot*loads%heat_pressure(k, cell)
      end do
   end function initial_stress

   !> Derivative by the first coordinate of a stress that is linear in a triangle [Pa/m].
   pure function slope_along(place, corner) result(slope)
      real(rk), intent(in) :: place(2, 3)  !< of the corners [m]
      real(rk), intent(in) :: corner(2, 2, 3)  !< stress there [Pa]
      real(rk) :: slope(2, 2)
      integer(ik) :: k, next, last

      slope = 0.0_rk
      do k = 1, 3
         next = mod(k, 3_ik) + 1
         last = mod(next, 3_ik) + 1
         slope = slope + (place(2, next) - place(2, last))*corner(:, :, k)
      end do
      slope = slope/(2.0_rk*triangle_area(place))
   end function slope_along

   !> The traction of one fracture cell, constant but for joints, on the slope of its jump. In the
   !! parameter x of its shape functions the slope times ds is d[u]/dx dx, whether or not its middle
   !! node is at the quarter point.
   pure real(rk) function face_share(model, loads, displacement, frame, reference_stress, cell, q)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(tip_frame_t), intent(in) :: frame
      real(rk), intent(in) :: reference_stress(2, 2)  !< to take off, in the tip's axes [Pa]
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: q(:)  !< (n_nodes) [-]
      integer(ik), parameter :: n_points = 3  ! exact: q and the slope have degrees 2 and 1
      integer(ik), parameter :: n_joint = 8  ! for the traction of a joint
      real(rk) :: x(n_joint), weights(n_joint), mean(2), traction(2), jump(2, 3), q_here, slope(2)
      real(rk) :: along
      integer(ik) :: n, point

      n = merge(n_joint, n_points, is_joint(model, cell))
      call gauss_rule(n, x(:n), weights(:n))
      mean = matmul(frame%axes, face_traction(model, loads, displacement, &
                                              traction_source(model, frame, cell))) &
             - frame%upper*reference_stress(:, 2)
      face_share = 0.0_rk
      associate (plus => model%mesh%face_nodes(:, 1, cell), &
                 minus => model%mesh%face_nodes(:, 2, cell))
         jump = matmul(frame%axes, displacement(:, minus) - displacement(:, plus))
         along = sign(1.0_rk, dot_product(frame%axes(1, :), model%mesh%face_tangent(:, cell)))
         do point = 1, n
            traction = mean
            if (is_joint(model, cell)) then
               traction = mean + matmul(frame%axes, joint_deviation(model, loads, displacement, &
                                                                    cell, x(point)))
            end if
            associate (share => line_shapes(x(point)))
               q_here = share(1)*q(plus(1)) + share(2)*q(plus(2)) + share(3)*q(plus(3))
            end associate
            associate (by_x => line_slopes(x(point)))
               slope = by_x(1)*jump(:, 1) + by_x(2)*jump(:, 2) + by_x(3)*jump(:, 3)
            end associate
            ! The slope is along the cell, which may run against the first axis.
            face_share = face_share + weights(point)*q_here*dot_product(traction, slope)*along
         end do
      end associate
   end function face_share

   !> Kuang and Chen (1993): with the jump A*sqrt(r) + B*r**(3/2) behind the tip, its values at the
   !! quarter point h/4 and at the end h of the element leave 3*A*sqrt(h) = 8 [u](h/4) - [u](h), and
   !! in a plain element those at h/2 and h leave A*sqrt(h) = 2*sqrt(2) [u](h/2) - [u](h).
   pure subroutine displacement_correlation(fine, elasticity, displacement, frame, k1, k2)
      type(fine_mesh_t), intent(in) :: fine
      type(elasticity_t), intent(in) :: elasticity
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(tip_frame_t), intent(in) :: frame
      real(rk), intent(out) :: k1, k2  !< [Pa m^1/2]
      real(rk) :: near(2), far(2), combination(2), factor
      integer(ik) :: far_end

      far_end = 3 - fine%face_at_tip(frame%face)
      associate (nodes => fine%face_nodes(:, :, frame%face))
         near = displacement(:, nodes(3, 2)) - displacement(:, nodes(3, 1))
         far = displacement(:, nodes(far_end, 2)) - displacement(:, nodes(far_end, 1))
      end associate
      if (fine%face_tip(frame%face) > 0) then
         combination = 8.0_rk*near - far
      else
         combination = 3.0_rk*(2.0_rk*sqrt(2.0_rk)*near - far)
      end if
      factor = elasticity%shear_modulus()/(3.0_rk*(1.0_rk + elasticity%kolosov())) &
               *sqrt(2.0_rk*pi/fine%face_length(frame%face))
      ! Upper minus lower face in the tip's axes.
      combination = frame%upper*matmul(frame%axes, combination)
      k1 = factor*combination(2)
      k2 = factor*combination(1)
   end subroutine displacement_correlation

end module fine_tip_energy
