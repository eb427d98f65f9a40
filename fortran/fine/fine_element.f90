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
!!
!! Rules of numerical integration on the unit interval and on the reference triangle.
!!
!! Triangle rules give barycentric coordinates, and weights that add up to one half, the area of the
!! reference triangle, so that an integral is the sum of weight * Jacobian determinant * value.
!!
!! The line of three nodes that an edge of a six-node triangle is: start, end, and one within.
!!
!! Its shape functions are quadratic in a parameter x, 0 at the start and 1 at the end. The node
!! within is at x = 1/2 and in the middle of the edge, where x is the share of the length from the
!! start. At a crack tip it lies at the quarter point, and the share of the length from the tip is
!! x**2, x counted from there (Barsoum 1976; Henshell and Shaw 1975). `tip_end` says which end is
!! such a tip: 1 or 2, or 0 for none.
module fine_element
   use base_kinds, only: ik, pi, rk
   implicit none(type, external)
   private

   public :: collapsed_rule, evaluate_element, gauss_rule, line_parameter, line_resultants
   public :: line_shapes, line_slopes, node_within, shape_values, stiffness_matrix, triangle_rule_3
   public :: tip_rule, tip_rule_size, triangle_rule_7

   !> Points of tip_rule: from a tip to the opposite edge, along that edge, and together at most.
   integer(ik), parameter :: tip_rule_t = 4, tip_rule_w = 5, tip_rule_size = tip_rule_t*tip_rule_w

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

   !> Gauss and Legendre's rule on [0, 1], exact up to degree 2n-1.
   pure subroutine gauss_rule(n, points, weights)
      integer(ik), intent(in) :: n
      real(rk), intent(out) :: points(n), weights(n)  !< weights add up to 1 [-]
      real(rk) :: x, step, p, p_before, p_next, slope
      integer(ik) :: i, k, iteration

      do i = 1, n
         x = -cos(pi*(i - 0.25_rk)/(n + 0.5_rk))  ! close enough for Newton to converge to root i
         do iteration = 1, 20
            p_before = 1.0_rk
            p = x
            do k = 2, n
               p_next = ((2*k - 1)*x*p - (k - 1)*p_before)/k
               p_before = p
               p = p_next
            end do
            slope = n*(x*p - p_before)/(x**2 - 1.0_rk)
            step = p/slope
            x = x - step
            if (abs(step) < 4.0_rk*epsilon(1.0_rk)) exit
         end do
         points(i) = 0.5_rk*(1.0_rk + x)
         weights(i) = 1.0_rk/((1.0_rk - x**2)*slope**2)
      end do
   end subroutine gauss_rule

   !> Three points inside, exact for quadratics (Strang and Fix).
   pure subroutine triangle_rule_3(points, weights)
      real(rk), intent(out) :: points(3, 3)  !< (barycentric coordinate, point) [-]
      real(rk), intent(out) :: weights(3)  !< their sum is 1/2 [-]
      integer(ik) :: k

      points = 1.0_rk/6.0_rk
      do k = 1, 3
         points(k, k) = 2.0_rk/3.0_rk
      end do
      weights = 1.0_rk/6.0_rk
   end subroutine triangle_rule_3

   !> Seven points, exact up to degree 5 (Radon).
   pure subroutine triangle_rule_7(points, weights)
      real(rk), intent(out) :: points(3, 7)  !< (barycentric coordinate, point) [-]
      real(rk), intent(out) :: weights(7)  !< their sum is 1/2 [-]
      real(rk), parameter :: root = sqrt(15.0_rk)
      real(rk) :: a(2), w(2)
      integer(ik) :: group, k, point

      points(:, 1) = 1.0_rk/3.0_rk
      weights(1) = 9.0_rk/80.0_rk
      a = [(6.0_rk - root)/21.0_rk, (6.0_rk + root)/21.0_rk]
      w = [(155.0_rk - root)/2400.0_rk, (155.0_rk + root)/2400.0_rk]
      do group = 1, 2
         do k = 1, 3
            point = 3*group - 2 + k
            points(:, point) = a(group)
            points(k, point) = 1.0_rk - 2.0_rk*a(group)
            weights(point) = w(group)
         end do
      end do
   end subroutine triangle_rule_7

   !> Gauss points in polar-like coordinates about one corner: t runs from that corner to the
   !! opposite edge, w along that edge. What is a polynomial in t and w, as all fields of a
   !! quarter-point element are, is integrated exactly.
   pure subroutine collapsed_rule(corner, n_t, n_w, points, weights)
      integer(ik), intent(in) :: corner  !< 1, 2 or 3
      integer(ik), intent(in) :: n_t, n_w  !< points in each direction
      real(rk), intent(out) :: points(3, n_t*n_w)  !< (barycentric coordinate, point) [-]
      real(rk), intent(out) :: weights(n_t*n_w)  !< their sum is 1/2 [-]
      real(rk) :: t(n_t), w(n_w), weight_t(n_t), weight_w(n_w)
      integer(ik) :: i, j, point

      call gauss_rule(n_t, t, weight_t)
      call gauss_rule(n_w, w, weight_w)
      point = 0
      do j = 1, n_w
         do i = 1, n_t
            point = point + 1
            points(corner, point) = 1.0_rk - t(i)
            points(mod(corner, 3) + 1, point) = t(i)*(1.0_rk - w(j))
            points(mod(corner + 1, 3) + 1, point) = t(i)*w(j)
            weights(point) = weight_t(i)*weight_w(j)*t(i)
         end do
      end do
   end subroutine collapsed_rule

   !> Points for fields that are singular at a corner, or smooth: collapsed about that corner, or of
   !! degree 5.
   pure subroutine tip_rule(corner, n_points, points, weights)
      integer(ik), intent(in) :: corner  !< at a tip; 0: none is
      integer(ik), intent(out) :: n_points
      real(rk), intent(out) :: points(3, tip_rule_size), weights(tip_rule_size)  !< [-]

      if (corner > 0) then
         n_points = tip_rule_size
         call collapsed_rule(corner, tip_rule_t, tip_rule_w, points, weights)
      else
         n_points = 7
         call triangle_rule_7(points(:, 1:7), weights(1:7))
      end if
   end subroutine tip_rule

   !> The shape functions of start, end and the node within.
   pure function line_shapes(x) result(shapes)
      real(rk), intent(in) :: x  !< parameter, 0 to 1 [-]
      real(rk) :: shapes(3)

      shapes = [(1.0_rk - x)*(1.0_rk - 2.0_rk*x), x*(2.0_rk*x - 1.0_rk), 4.0_rk*x*(1.0_rk - x)]
   end function line_shapes

   !> Their derivatives by the parameter.
   pure function line_slopes(x) result(slopes)
      real(rk), intent(in) :: x  !< parameter, 0 to 1 [-]
      real(rk) :: slopes(3)

      slopes = [4.0_rk*x - 3.0_rk, 4.0_rk*x - 1.0_rk, 4.0_rk - 8.0_rk*x]
   end function line_slopes

   !> The parameter of a place on the line.
   pure real(rk) function line_parameter(share, tip_end) result(x)
      real(rk), intent(in) :: share  !< of the length from the start, 0 to 1 [-]
      integer(ik), intent(in) :: tip_end

      x = share
      if (tip_end == 1) x = sqrt(share)
      if (tip_end == 2) x = 1.0_rk - sqrt(1.0_rk - share)
   end function line_parameter

   !> Where the node within lies: its share of the length from the start.
   pure real(rk) function node_within(tip_end) result(share)
      integer(ik), intent(in) :: tip_end

      share = 0.5_rk
      if (tip_end == 1) share = 0.25_rk
      if (tip_end == 2) share = 0.75_rk
   end function node_within

   !> The integrals of the shape functions along the line, over its length: the nodes' shares in the
   !! resultant of a uniform load. A tip has none.
   pure function line_resultants(tip_end) result(share)
      integer(ik), intent(in) :: tip_end
      real(rk) :: share(3)

      share = [1.0_rk, 1.0_rk, 4.0_rk]/6.0_rk
      if (tip_end == 1) share(1:2) = [0.0_rk, 1.0_rk]/3.0_rk
      if (tip_end == 2) share(1:2) = [1.0_rk, 0.0_rk]/3.0_rk
   end function line_resultants

end module fine_element
