!> Rules of numerical integration on the unit interval and on the reference triangle.
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
module fine_quadrature
   use base_kinds, only: ik, pi, rk
   implicit none(type, external)
   private

   public :: collapsed_rule, gauss_rule, line_parameter, line_resultants, line_shapes, line_slopes
   public :: node_within, triangle_rule_3, triangle_rule_7

contains

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

end module fine_quadrature
