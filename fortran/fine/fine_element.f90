!> The six-node triangle: straight edges, and either midside nodes in the middle or, at a crack tip,
!! at the quarter points of the two edges that meet there (Barsoum 1976; Henshell and Shaw 1975).
!!
!! Nodes 1 to 3 are the corners, node 3+k lies on edge k, which joins corners k and mod(k,3)+1.
!! With t = 1 - lambda of the tip's corner and w running along the opposite edge p(w), the
!! quarter-point element maps to x = x_tip + t**2 (p(w) - x_tip), so that displacements, polynomials
!! in t, hold the root of the distance from the tip along every ray.
!!
!! The eight-node quadrilateral with one side collapsed into the tip and its three nodes there tied
!! (Barsoum 1976) has the same six nodes and the same map. Summing the shape functions of the tied
!! nodes leaves those of the triangle and the bubble b = 4 t (1 - t) w (1 - w), which the node in
!! the middle of the opposite edge gets whole and the ends of that edge lose by halves: the part of
!! the displacement that goes with t is quadratic in w instead of linear.
module fine_element
   use base_kinds, only: ik, rk
   use fine_quadrature, only: collapsed_rule, triangle_rule_3
   implicit none(type, external)
   private

   public :: evaluate_element, shape_values, stiffness_matrix

contains

   !> The six shape functions.
   pure function shape_values(lambda) result(values)
      real(rk), intent(in) :: lambda(3)  !< barycentric coordinates of the reference triangle [-]
      real(rk) :: values(6)
      integer(ik) :: k

      do k = 1, 3
         values(k) = lambda(k)*(2.0_rk*lambda(k) - 1.0_rk)
         values(3 + k) = 4.0_rk*lambda(k)*lambda(mod(k, 3) + 1)
      end do
   end function shape_values

   !> Derivatives of the shape functions by lambda(2) and lambda(3), where lambda(1) follows.
   pure function shape_derivatives(lambda) result(derivatives)
      real(rk), intent(in) :: lambda(3)  !< barycentric coordinates [-]
      real(rk) :: derivatives(2, 6)
      real(rk) :: by_lambda(3, 6)
      integer(ik) :: k, next

      by_lambda = 0.0_rk
      do k = 1, 3
         next = mod(k, 3) + 1
         by_lambda(k, k) = 4.0_rk*lambda(k) - 1.0_rk
         by_lambda(k, 3 + k) = 4.0_rk*lambda(next)
         by_lambda(next, 3 + k) = 4.0_rk*lambda(k)
      end do
      derivatives(1, :) = by_lambda(2, :) - by_lambda(1, :)
      derivatives(2, :) = by_lambda(3, :) - by_lambda(1, :)
   end function shape_derivatives

   !> Everything that integrals need at one point of an element.
   pure subroutine evaluate_element(xy, tip_corner, lambda, values, gradients, area_coordinates, &
                                    determinant, collapsed)
      real(rk), intent(in) :: xy(2, 6)  !< nodes [m]
      integer(ik), intent(in) :: tip_corner  !< corner at a tip, 0 for an ordinary element
      real(rk), intent(in) :: lambda(3)  !< barycentric coordinates of the reference triangle [-]
      real(rk), intent(out) :: values(6)  !< shape functions [-]
      real(rk), intent(out) :: gradients(2, 6)  !< their gradients [1/m]
      real(rk), intent(out) :: area_coordinates(3)  !< barycentric, in space: linear in x [-]
      real(rk), intent(out) :: determinant  !< of the Jacobian [m2]
      logical, intent(in), optional :: collapsed  !< quadrilateral at the tip; default: triangle
      real(rk) :: derivatives(2, 6), jacobian(2, 2), inverse(2, 2), t

      values = shape_values(lambda)
      derivatives = shape_derivatives(lambda)
      if (present(collapsed) .and. tip_corner > 0) then
         if (collapsed) call add_bubble(tip_corner, lambda, values, derivatives)
      end if
      jacobian = matmul(derivatives, transpose(xy))
      determinant = jacobian(1, 1)*jacobian(2, 2) - jacobian(1, 2)*jacobian(2, 1)
      inverse(1, :) = [jacobian(2, 2), -jacobian(1, 2)]
      inverse(2, :) = [-jacobian(2, 1), jacobian(1, 1)]
      gradients = matmul(inverse/determinant, derivatives)
      area_coordinates = lambda
      if (tip_corner > 0) then
         t = 1.0_rk - lambda(tip_corner)
         area_coordinates = t*lambda
         area_coordinates(tip_corner) = 1.0_rk - t**2
      end if
   end subroutine evaluate_element

   !> What makes a collapsed quadrilateral of a triangle: b = 4 l_0 l_1 l_2/(l_1 + l_2), with the
   !! barycentric coordinate l_0 of the tip and those of the ends of the opposite edge.
   pure subroutine add_bubble(tip_corner, lambda, values, derivatives)
      integer(ik), intent(in) :: tip_corner
      real(rk), intent(in) :: lambda(3)  !< barycentric coordinates [-]
      real(rk), intent(inout) :: values(6), derivatives(2, 6)  !< of the shape functions [-]
      real(rk) :: bubble, by_lambda(3), slope(2), t, share
      integer(ik) :: first, second, k

      first = mod(tip_corner, 3) + 1
      second = mod(first, 3) + 1
      t = lambda(first) + lambda(second)
      if (.not. t > 0.0_rk) return
      bubble = 4.0_rk*lambda(tip_corner)*lambda(first)*lambda(second)/t
      by_lambda(tip_corner) = 4.0_rk*lambda(first)*lambda(second)/t
      by_lambda(first) = 4.0_rk*lambda(tip_corner)*(lambda(second)/t)**2
      by_lambda(second) = 4.0_rk*lambda(tip_corner)*(lambda(first)/t)**2
      slope = [by_lambda(2) - by_lambda(1), by_lambda(3) - by_lambda(1)]
      do k = 1, 6
         share = 0.0_rk
         if (k == first .or. k == second) share = -0.5_rk
         if (k == 3 + first) share = 1.0_rk
         values(k) = values(k) + share*bubble
         derivatives(:, k) = derivatives(:, k) + share*slope
      end do
   end subroutine add_bubble

   !> Stiffness matrix of an element, unit thickness; unknowns u_x, u_y of node 1, then of 2, ...
   !!
   !! Three points are exact for an ordinary element. In a quarter-point element strain times t is a
   !! polynomial of degree 1 in t and 2 in w, and the area element is proportional to t**3 dt dw; so
   !! the integrand has degrees 3 and 4, for which 2 by 3 collapsed Gauss points are exact.
   pure subroutine stiffness_matrix(xy, tip_corner, lame_lambda, shear_modulus, stiffness, &
                                    collapsed)
      real(rk), intent(in) :: xy(2, 6)  !< nodes [m]
      integer(ik), intent(in) :: tip_corner  !< corner at a tip, 0 for an ordinary element
      real(rk), intent(in) :: lame_lambda, shear_modulus  !< [Pa]
      real(rk), intent(out) :: stiffness(12, 12)  !< [Pa]
      logical, intent(in), optional :: collapsed  !< quadrilateral at the tip; default: triangle
      integer(ik), parameter :: n_t = 2, n_w = 3
      real(rk) :: points(3, n_t*n_w), weights(n_t*n_w)
      real(rk) :: values(6), gradients(2, 6), area_coordinates(3), determinant, weight, uniaxial
      real(rk) :: products(6, 6, 2, 2)  ! integrals of dN_a/dx_i dN_b/dx_j
      integer(ik) :: n_points, point, a, b, i, j

      if (tip_corner > 0) then
         n_points = n_t*n_w
         call collapsed_rule(tip_corner, n_t, n_w, points, weights)
      else
         n_points = 3
         call triangle_rule_3(points(:, 1:3), weights(1:3))
      end if

      products = 0.0_rk
      do point = 1, n_points
         call evaluate_element(xy, tip_corner, points(:, point), values, gradients, &
                               area_coordinates, determinant, collapsed)
         weight = weights(point)*determinant
         do j = 1, 2
            do i = 1, 2
               do b = 1, 6
                  products(:, b, i, j) = products(:, b, i, j) &
                                         + (weight*gradients(j, b))*gradients(i, :)
               end do
            end do
         end do
      end do

      uniaxial = lame_lambda + 2.0_rk*shear_modulus
      do b = 1, 6
         do a = 1, 6
            associate (p => products(a, b, :, :))
               stiffness(2*a - 1, 2*b - 1) = uniaxial*p(1, 1) + shear_modulus*p(2, 2)
               stiffness(2*a, 2*b) = uniaxial*p(2, 2) + shear_modulus*p(1, 1)
               stiffness(2*a - 1, 2*b) = lame_lambda*p(1, 2) + shear_modulus*p(2, 1)
               stiffness(2*a, 2*b - 1) = lame_lambda*p(2, 1) + shear_modulus*p(1, 2)
            end associate
         end do
      end do
   end subroutine stiffness_matrix

end module fine_element
