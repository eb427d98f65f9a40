!> Rules of integration against the integrals of monomials.
program test_fine_quadrature
   use base_kinds, only: ik, rk
   use fine_element, only: collapsed_rule, gauss_rule, triangle_rule_3, triangle_rule_7
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks
   real(rk) :: points_3(3, 3), weights_3(3), points_7(3, 7), weights_7(7), points_c(3, 12), &
               weights_c(12)
   integer(ik) :: corner

   call check_gauss(1_ik)
   call check_gauss(2_ik)
   call check_gauss(5_ik)
   call check_gauss(8_ik)
   call triangle_rule_3(points_3, weights_3)
   call check_triangle("3 points", points_3, weights_3, 2_ik)
   call triangle_rule_7(points_7, weights_7)
   call check_triangle("7 points", points_7, weights_7, 5_ik)
   do corner = 1, 3
      call collapsed_rule(corner, 4_ik, 3_ik, points_c, weights_c)  ! degree 5 along w decides
      call check_triangle("collapsed", points_c, weights_c, 5_ik)
   end do
   call checks%finish()

contains

   !> n points integrate x**k on [0, 1] to 1/(k+1) up to k = 2n-1, and not beyond.
   subroutine check_gauss(n)
      integer(ik), intent(in) :: n
      real(rk) :: points(n), weights(n)
      integer(ik) :: k
      character(len=48) :: name

      call gauss_rule(n, points, weights)
      do k = 0, 2*n - 1
         write (name, "(2(a,i0))") "Gauss rule, points ", n, ", degree ", k
         call checks%is_close(sum(weights*points**k), 1.0_rk/(k + 1), 4.0e-15_rk, trim(name))
      end do
      call checks%is_true(abs(sum(weights*points**(2*n)) - 1.0_rk/(2*n + 1)) > 1.0e-12_rk, &
                          "Gauss rule is not exact beyond its degree")
   end subroutine check_gauss

   !> The integral of a**i b**j c**k over the reference triangle is i! j! k!/(i+j+k+2)!.
   subroutine check_triangle(name, points, weights, degree)
      character(len=*), intent(in) :: name
      real(rk), intent(in) :: points(:, :), weights(:)
      integer(ik), intent(in) :: degree
      integer(ik) :: i, j, k

      do i = 0, degree
         do j = 0, degree - i
            k = degree - i - j
            call checks%is_close(sum(weights*points(1, :)**i*points(2, :)**j*points(3, :)**k), &
                                 gamma(i + 1.0_rk)*gamma(j + 1.0_rk)*gamma(k + 1.0_rk) &
                                 /gamma(degree + 3.0_rk), 1.0e-15_rk, name)
         end do
      end do
   end subroutine check_triangle

end program test_fine_quadrature
