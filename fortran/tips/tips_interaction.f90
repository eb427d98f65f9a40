!> Stress intensity factors by the interaction integral in domain form (Stern, Becker and Dunham
!! 1976; Yau, Wang and Corten 1980; Shih and Asaro 1988), with loaded faces and the pore pressure
!! as initial stress.
!!
!! In the tip's axes, with the auxiliary field (hat) of unit intensity, total stress s,
!! displacement u, strain e, outward normal m, and a weight q that is 1 at the tip and 0 at the
!! domain's edge:
!!    P_j = s_ij hat u_i,1 + hat s_ij u_i,1 - hat s_kl e_kl delta_1j
!!    M = int P_j q,j dA + int P_j,j q dA - int_faces P_j m_j q ds = 2 K/E'.
!! Since div s = div hat s = 0 and s = C e - biot p I, P_j,j = -biot p (tr hat e),1. On straight
!! faces through the tip m_1 = 0 and hat s m = 0, so that P_j m_j leaves the actual traction
!! t = s m of both sides:
!!    M = int P_j q,j dA - int biot p (tr hat e),1 q dA - int_faces t_i hat u_i,1 q ds.
!! The domain ends before anything for which this does not hold: a kink, another fracture, the far
!! end of the straight piece, the outer boundary.
module tips_interaction
   use base_kinds, only: ik, rk
   use fine_element, only: evaluate_element
   use fine_loads, only: fine_loads_t
   use fine_mesh, only: fine_mesh_t
   use fine_model, only: fine_model_t
   use fine_quadrature, only: collapsed_rule, gauss_rule, triangle_rule_7
   use tips_auxiliary, only: auxiliary_field, auxiliary_field_t
   use tips_faces, only: face_traction, traction_source
   use tips_types, only: tip_frame_t
   implicit none(type, external)
   private

   public :: interaction_integral, largest_radius, rosette_size

   real(rk), parameter :: pi = acos(-1.0_rk)
   real(rk), parameter :: on_line = 1.0e-9_rk  !< distance from the line over that from the tip

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
      real(rk), allocatable :: q(:)
      real(rk) :: distance, integral(2)
      integer(ik) :: cell, node

      allocate (q(model%mesh%n_nodes))
      do node = 1, model%mesh%n_nodes
         distance = norm2(model%mesh%xy(:, node) - frame%origin)/radius
         q(node) = max(0.0_rk, min(1.0_rk, (1.0_rk - distance)/(1.0_rk - plateau)))
         if (distance > 1.0_rk - on_line) q(node) = 0.0_rk
      end do

      integral = 0.0_rk
      do cell = 1, model%mesh%n_cells
         if (any(q(model%mesh%cell_nodes(:, cell)) > 0.0_rk)) then
            call add_cell(model, loads, displacement, frame, cell, q, integral)
         end if
      end do
      do cell = 1, model%mesh%fracture%n_cells
         if (any(q(model%mesh%face_nodes(:, 1, cell)) > 0.0_rk)) then
            call add_face(model, loads, displacement, frame, cell, q, integral)
         end if
      end do
      k1 = 0.5_rk*model%elasticity%crack_modulus()*integral(1)
      k2 = 0.5_rk*model%elasticity%crack_modulus()*integral(2)
   end subroutine interaction_integral

   !> One element's share.
   pure subroutine add_cell(model, loads, displacement, frame, cell, q, integral)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)
      type(tip_frame_t), intent(in) :: frame
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: q(:)  !< (n_nodes)
      real(rk), intent(inout) :: integral(2)
      integer(ik), parameter :: n_t = 4, n_w = 5
      real(rk) :: points(3, n_t*n_w), weights(n_t*n_w)
      real(rk) :: values(6), gradients(2, 6), area_coordinates(3), determinant
      real(rk) :: place(2), gradient(2, 2), stress(2, 2), q_slope(2), p(2)
      real(rk) :: pressure, initial, weight, angle, reference, kolosov, shear_modulus
      complex(rk) :: root_z
      type(auxiliary_field_t) :: field
      integer(ik) :: point, n_points, mode, nodes(6)

      nodes = model%mesh%cell_nodes(:, cell)
      if (any(nodes(1:3) == frame%node)) then
         n_points = n_t*n_w
         call collapsed_rule(model%mesh%tip_corner(cell), n_t, n_w, points, weights)
      else
         n_points = 7
         call triangle_rule_7(points(:, 1:7), weights(1:7))
      end if
      reference = reference_angle(model%mesh, frame, cell, q)
      kolosov = model%elasticity%kolosov()
      shear_modulus = model%elasticity%shear_modulus()

      do point = 1, n_points
         call evaluate_element(model%mesh%xy(:, nodes), model%mesh%tip_corner(cell), &
                               points(:, point), values, gradients, area_coordinates, determinant)
         weight = weights(point)*determinant
         ! All in the tip's axes.
         place = matmul(frame%axes, matmul(model%mesh%xy(:, nodes), values) - frame%origin)
         gradients = matmul(frame%axes, gradients)
         gradient = matmul(matmul(frame%axes, displacement(:, nodes)), transpose(gradients))
         q_slope = matmul(gradients, q(nodes))
         pressure = dot_product(area_coordinates, loads%pore_pressure(nodes(1:3)))
         stress = model%elasticity%total_stress(gradient, pressure)
         initial = model%elasticity%biot*pressure*dot_product(values, q(nodes))
         angle = atan2(place(2), place(1))
         angle = angle + 2.0_rk*pi*nint((reference - angle)/(2.0_rk*pi))
         root_z = sqrt(norm2(place))*exp(cmplx(0.0_rk, 0.5_rk*angle, rk))
         do mode = 1, 2
            field = auxiliary_field(mode, root_z, kolosov, shear_modulus)
            p = matmul(stress, field%slope) + matmul(field%stress, gradient(:, 1))
            p(1) = p(1) - sum(field%stress*gradient)
            integral(mode) = integral(mode) &
                             + weight*(dot_product(p, q_slope) - initial*field%dilation_slope)
         end do
      end do
   end subroutine add_cell

   !> A polar angle near to those of an element, continued across the line behind the crack where
   !! the crack itself has turned away from it. A node within the domain and off the line has a
   !! sure angle; an element all of whose nodes within the domain are on the line lies on one side
   !! of it.
   pure real(rk) function reference_angle(fine, frame, cell, q)
      type(fine_mesh_t), intent(in) :: fine
      type(tip_frame_t), intent(in) :: frame
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: q(:)
      real(rk) :: place(2)
      integer(ik) :: k

      do k = 1, 6
         if (.not. q(fine%cell_nodes(k, cell)) > 0.0_rk) cycle
         place = matmul(frame%axes, fine%xy(:, fine%cell_nodes(k, cell)) - frame%origin)
         if (abs(place(2)) > on_line*norm2(place)) then
            reference_angle = atan2(place(2), place(1))
            return
         end if
      end do
      place = sum(fine%xy(:, fine%cell_nodes(1:3, cell)), dim=2)/3.0_rk
      place = matmul(frame%axes, place - frame%origin)
      reference_angle = atan2(place(2), place(1))
   end function reference_angle

   !> One fracture cell's share: its traction on the difference of hat u,1 between the faces.
   pure subroutine add_face(model, loads, displacement, frame, cell, q, integral)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)
      type(tip_frame_t), intent(in) :: frame
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: q(:)  !< (n_nodes)
      real(rk), intent(inout) :: integral(2)
      integer(ik), parameter :: n_points = 5
      real(rk) :: s(n_points), weights(n_points), traction(2), ends(2, 2), r, q_here, weight
      real(rk) :: kolosov, shear_modulus, difference(2)
      type(auxiliary_field_t) :: above, below
      integer(ik) :: point, mode, source

      call gauss_rule(n_points, s, weights)
      source = traction_source(model, frame, cell)
      traction = matmul(frame%axes, face_traction(model, loads, displacement, source))
      kolosov = model%elasticity%kolosov()
      shear_modulus = model%elasticity%shear_modulus()
      associate (nodes => model%mesh%face_nodes(:, 1, cell), &
                 length => model%mesh%face_length(cell), tip_end => model%mesh%face_tip(cell))
         ends = model%mesh%xy(:, nodes(1:2))
         do point = 1, n_points
            associate (x => s(point))
               q_here = (1.0_rk - x)*(1.0_rk - 2.0_rk*x)*q(nodes(1)) &
                        + x*(2.0_rk*x - 1.0_rk)*q(nodes(2)) + 4.0_rk*x*(1.0_rk - x)*q(nodes(3))
               weight = length*weights(point)
               if (tip_end == 0) then
                  r = norm2((1.0_rk - x)*ends(:, 1) + x*ends(:, 2) - frame%origin)
               else
                  ! r = length*t**2 takes the root out of the integrand.
                  r = length*merge(x, 1.0_rk - x, tip_end == 1)**2
                  weight = 2.0_rk*weight*sqrt(r/length)
               end if
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

   !> How far a domain may reach [m].
   pure real(rk) function largest_radius(fine, frame)
      type(fine_mesh_t), intent(in) :: fine
      type(tip_frame_t), intent(in) :: frame
      real(rk) :: place(2, 2), straight_length
      integer(ik) :: cell, face

      largest_radius = huge(1.0_rk)
      straight_length = 0.0_rk
      do cell = 1, fine%fracture%n_cells
         place = in_tip_axes(fine%face_nodes(1:2, 1, cell))
         if (fine%fracture%cell_fracture(cell) == frame%fracture &
             .and. all(abs(place(2, :)) <= on_line*maxval(abs(place)))) then
            straight_length = max(straight_length, maxval(abs(place(1, :))))
         else
            largest_radius = min(largest_radius, distance_to_segment(place))
         end if
      end do
      largest_radius = min(largest_radius, straight_length)
      do face = 1, size(fine%boundary_faces, 2)
         place = in_tip_axes(fine%boundary_faces(:, face))
         largest_radius = min(largest_radius, distance_to_segment(place))
      end do

   contains

      !> Places of two nodes.
      pure function in_tip_axes(nodes) result(place)
         integer(ik), intent(in) :: nodes(2)
         real(rk) :: place(2, 2)
         integer(ik) :: k

         do k = 1, 2
            place(:, k) = matmul(frame%axes, fine%xy(:, nodes(k)) - frame%origin)
         end do
      end function in_tip_axes

   end function largest_radius

   !> Distance of the origin from a segment.
   pure real(rk) function distance_to_segment(ends)
      real(rk), intent(in) :: ends(2, 2)
      real(rk) :: along(2), share

      along = ends(:, 2) - ends(:, 1)
      share = min(1.0_rk, max(0.0_rk, -dot_product(ends(:, 1), along)/dot_product(along, along)))
      distance_to_segment = norm2(ends(:, 1) + share*along)
   end function distance_to_segment

   !> Largest distance of the corners of the elements around a tip from it [m].
   pure real(rk) function rosette_size(fine, frame)
      type(fine_mesh_t), intent(in) :: fine
      type(tip_frame_t), intent(in) :: frame
      real(rk) :: corner(2)
      integer(ik) :: cell, k

      rosette_size = 0.0_rk
      do cell = 1, fine%n_cells
         if (.not. any(fine%cell_nodes(1:3, cell) == frame%node)) cycle
         do k = 1, 3
            corner = fine%xy(:, fine%cell_nodes(k, cell))
            rosette_size = max(rosette_size, norm2(corner - frame%origin))
         end do
      end do
   end function rosette_size

end module tips_interaction
