!> The six-node triangle against exact fields and integrals.
program test_fine_element
   use base_kinds, only: ik, rk
   use fine_element, only: collapsed_rule, evaluate_element, shape_values, stiffness_matrix
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks
   real(rk), parameter :: corners(2, 3) = reshape([0.3_rk, -0.2_rk, 1.4_rk, 0.1_rk, 0.5_rk, &
                                                   0.9_rk], [2, 3])
   integer(ik) :: corner
   logical :: collapsed

   do corner = 0, 3
      collapsed = .false.
      call check_shapes(corner)
      call check_stiffness(corner)
      if (corner == 0) cycle
      call check_root_field(corner)
      collapsed = .true.
      call check_shapes(corner)
      call check_stiffness(corner)
      call check_root_field(corner)
      call check_serendipity(corner)
   end do
   call checks%finish()

contains

   !> Nodes of the triangle, moved to the quarter points of the edges at a tip.
   pure function element_nodes(tip_corner) result(xy)
      integer(ik), intent(in) :: tip_corner
      real(rk) :: xy(2, 6)
      real(rk) :: share
      integer(ik) :: k, next

      xy(:, 1:3) = corners
      do k = 1, 3
         next = mod(k, 3) + 1
         share = 0.5_rk
         if (tip_corner == k) share = 0.25_rk
         if (tip_corner == next) share = 0.75_rk
         xy(:, 3 + k) = (1.0_rk - share)*corners(:, k) + share*corners(:, next)
      end do
   end function element_nodes

   !> Shape functions are 1 at their node, 0 at the others; x and its gradient are reproduced.
   subroutine check_shapes(tip_corner)
      integer(ik), intent(in) :: tip_corner
      real(rk), parameter :: nodes(3, 6) = reshape([1.0_rk, 0.0_rk, 0.0_rk, 0.0_rk, 1.0_rk, &
                                                    0.0_rk, &
                                                    0.0_rk, 0.0_rk, 1.0_rk, 0.5_rk, 0.5_rk, &
                                                    0.0_rk, &
                                                    0.0_rk, 0.5_rk, 0.5_rk, 0.5_rk, 0.0_rk, &
                                                    0.5_rk], [3, 6])
      real(rk) :: xy(2, 6), values(6), gradients(2, 6), area_coordinates(3), determinant, &
                  identity(2, 2)
      integer(ik) :: k, j

      do k = 1, 6
         values = shape_values(nodes(:, k))
         do j = 1, 6
            call checks%is_close(values(j), merge(1.0_rk, 0.0_rk, j == k), 1.0e-15_rk, &
                                 "shape function at a node")
         end do
      end do
      xy = element_nodes(tip_corner)
      call evaluate_element(xy, tip_corner, [0.23_rk, 0.41_rk, 0.36_rk], values, gradients, &
                            area_coordinates, determinant, collapsed)
      identity = matmul(xy, transpose(gradients))
      call checks%is_close(identity(1, 1), 1.0_rk, 1.0e-14_rk, "dx/dx")
      call checks%is_close(identity(1, 2), 0.0_rk, 1.0e-14_rk, "dx/dy")
      call checks%is_close(identity(2, 1), 0.0_rk, 1.0e-14_rk, "dy/dx")
      call checks%is_close(identity(2, 2), 1.0_rk, 1.0e-14_rk, "dy/dy")
      call checks%is_close(norm2(matmul(xy, values) - matmul(corners, area_coordinates)), 0.0_rk, &
                           1.0e-15_rk, &
                           "area coordinates give the place")
   end subroutine check_shapes

   !> The rule in use is exact: twelve times as many points change nothing. No force for rigid
   !! motions.
   subroutine check_stiffness(tip_corner)
      integer(ik), intent(in) :: tip_corner
      real(rk), parameter :: lambda = 1.3_rk, mu = 0.7_rk
      integer(ik), parameter :: n = 8
      real(rk) :: stiffness(12, 12), reference(12, 12), xy(2, 6), points(3, n*n), weights(n*n)
      real(rk) :: values(6), gradients(2, 6), area_coordinates(3), determinant, strain(3, 12), &
                  elastic(3, 3)
      real(rk) :: motion(12, 3)
      integer(ik) :: point, k

      xy = element_nodes(tip_corner)
      call stiffness_matrix(xy, tip_corner, lambda, mu, stiffness, collapsed)
      elastic = 0.0_rk
      elastic(1:2, 1:2) = lambda
      elastic(1, 1) = lambda + 2.0_rk*mu
      elastic(2, 2) = lambda + 2.0_rk*mu
      elastic(3, 3) = mu
      call collapsed_rule(max(1_ik, tip_corner), n, n, points, weights)
      reference = 0.0_rk
      do point = 1, n*n
         call evaluate_element(xy, tip_corner, points(:, point), values, gradients, &
                               area_coordinates, determinant, collapsed)
         strain = 0.0_rk
         do k = 1, 6
            strain(1, 2*k - 1) = gradients(1, k)
            strain(2, 2*k) = gradients(2, k)
            strain(3, 2*k - 1:2*k) = [gradients(2, k), gradients(1, k)]
         end do
         reference = reference + weights(point)*determinant*matmul(transpose(strain), &
                                                                   matmul(elastic, strain))
      end do
      call checks%is_close(maxval(abs(stiffness - reference)), 0.0_rk, &
                           2.0e-14_rk*maxval(abs(reference)), &
                           "stiffness is integrated exactly")

      motion = 0.0_rk
      motion(1 :: 2, 1) = 1.0_rk
      motion(2 :: 2, 2) = 1.0_rk
      motion(1 :: 2, 3) = -xy(2, :)
      motion(2 :: 2, 3) = xy(1, :)
      call checks%is_close(maxval(abs(matmul(stiffness, motion))), 0.0_rk, 2.0e-14_rk, &
                           "rigid motions cost no force")
      call checks%is_close(maxval(abs(stiffness - transpose(stiffness))), 0.0_rk, 1.0e-14_rk, &
                           "stiffness is symmetric")
   end subroutine check_stiffness

   !> a + b*sqrt(r) + c*r along every ray from the tip is reproduced, with its derivative.
   subroutine check_root_field(tip_corner)
      integer(ik), intent(in) :: tip_corner
      real(rk) :: xy(2, 6), values(6), gradients(2, 6), area_coordinates(3), determinant
      real(rk) :: nodal(6), place(2), distance, lambda(3), t
      integer(ik) :: i, k, next

      xy = element_nodes(tip_corner)
      do k = 1, 6
         nodal(k) = field(norm2(xy(:, k) - corners(:, tip_corner)))
      end do
      next = mod(tip_corner, 3) + 1
      do i = 1, 9
         t = 0.1_rk*i
         lambda = 0.0_rk
         lambda(tip_corner) = 1.0_rk - t
         lambda(next) = t
         call evaluate_element(xy, tip_corner, lambda, values, gradients, area_coordinates, &
                               determinant, collapsed)
         place = matmul(xy, values) - corners(:, tip_corner)
         distance = norm2(place)
         call checks%is_close(dot_product(values, nodal), field(distance), 1.0e-14_rk, &
                              "root field along the edge")
         call checks%is_close(dot_product(matmul(gradients, nodal), place/distance), &
                              1.0_rk/sqrt(distance) - 0.6_rk, 1.0e-12_rk, &
                              "its slope along the edge")
      end do
   end subroutine check_root_field

   !> The collapsed quadrilateral's shape functions are those of the eight-node serendipity element,
   !! the three at the tip added up (xi = 2 t - 1, eta = 2 w - 1).
   subroutine check_serendipity(tip_corner)
      integer(ik), intent(in) :: tip_corner
      real(rk), parameter :: t = 0.35_rk, w = 0.8_rk
      real(rk), parameter :: xi = 2.0_rk*t - 1.0_rk, eta = 2.0_rk*w - 1.0_rk
      real(rk) :: values(6), gradients(2, 6), area_coordinates(3), determinant, lambda(3)
      real(rk) :: expected(6)
      integer(ik) :: first, second

      first = mod(tip_corner, 3) + 1
      second = mod(first, 3) + 1
      lambda(tip_corner) = 1.0_rk - t
      lambda(first) = t*(1.0_rk - w)
      lambda(second) = t*w
      call evaluate_element(element_nodes(tip_corner), tip_corner, lambda, values, gradients, &
                            area_coordinates, determinant, .true.)
      expected(tip_corner) = corner_function(xi, eta, -1.0_rk, -1.0_rk) &
                             + corner_function(xi, eta, -1.0_rk, 1.0_rk) &
                             + 0.5_rk*(1.0_rk - xi)*(1.0_rk - eta**2)
      expected(first) = corner_function(xi, eta, 1.0_rk, -1.0_rk)
      expected(second) = corner_function(xi, eta, 1.0_rk, 1.0_rk)
      expected(3 + tip_corner) = 0.5_rk*(1.0_rk - xi**2)*(1.0_rk - eta)
      expected(3 + first) = 0.5_rk*(1.0_rk + xi)*(1.0_rk - eta**2)
      expected(3 + second) = 0.5_rk*(1.0_rk - xi**2)*(1.0_rk + eta)
      call checks%is_close(maxval(abs(values - expected)), 0.0_rk, 1.0e-15_rk, &
                           "eight-node quadrilateral")
   end subroutine check_serendipity

   !> Serendipity function of the corner at (xi_node, eta_node).
   pure real(rk) function corner_function(xi, eta, xi_node, eta_node)
      real(rk), intent(in) :: xi, eta, xi_node, eta_node

      corner_function = 0.25_rk*(1.0_rk + xi*xi_node)*(1.0_rk + eta*eta_node) &
                        *(xi*xi_node + eta*eta_node - 1.0_rk)
   end function corner_function

   pure real(rk) function field(r)
      real(rk), intent(in) :: r

      field = 0.4_rk + 2.0_rk*sqrt(r) - 0.6_rk*r
   end function field

end program test_fine_element
