!> The line of three nodes, with its inner node in the middle and at either quarter point.
program test_fine_line
   use base_kinds, only: ik, rk
   use fine_element, only: gauss_rule, line_parameter, line_resultants, line_shapes, line_slopes, &
                           node_within
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: round_off = 8.0_rk*epsilon(1.0_rk)
   type(checks_t) :: checks
   integer(ik) :: tip_end

   call check_shapes()
   do tip_end = 0, 2
      call check_places(tip_end)
      call check_resultants(tip_end)
   end do
   call checks%finish()

contains

   subroutine same(values, expected, name)
      real(rk), intent(in) :: values(3), expected(3)
      character(len=*), intent(in) :: name

      call checks%is_close(maxval(abs(values - expected)), 0.0_rk, round_off, name)
   end subroutine same

   !> One at the own node, and exact for quadratics; slopes are the differences of quadratics.
   subroutine check_shapes()
      real(rk) :: x, nodal(3)

      call same(line_shapes(0.0_rk), [1.0_rk, 0.0_rk, 0.0_rk], "at the start")
      call same(line_shapes(1.0_rk), [0.0_rk, 1.0_rk, 0.0_rk], "at the end")
      call same(line_shapes(0.5_rk), [0.0_rk, 0.0_rk, 1.0_rk], "at the node within")
      x = 0.3_rk
      nodal = [2.0_rk, 5.0_rk, 2.75_rk]  ! 2 + 3 x**2
      call checks%is_close(dot_product(line_shapes(x), nodal), 2.27_rk, round_off, "a quadratic")
      call checks%is_close(dot_product(line_slopes(x), nodal), 1.8_rk, round_off, "its slope")
      call checks%is_close(sum(line_slopes(x)), 0.0_rk, round_off, "a constant has no slope")
   end subroutine check_shapes

   !> The node within has the parameter 1/2; places that shapes interpolate are those asked for.
   subroutine check_places(tip)
      integer(ik), intent(in) :: tip
      real(rk) :: share, nodal(3)
      integer :: k

      call checks%is_close(line_parameter(node_within(tip), tip), 0.5_rk, round_off, "node within")
      nodal = [0.0_rk, 1.0_rk, node_within(tip)]
      do k = 0, 8
         share = 0.125_rk*k
         call checks%is_close(dot_product(line_shapes(line_parameter(share, tip)), nodal), share, &
                              round_off, "the place of a parameter")
      end do
   end subroutine check_places

   !> Against Gauss points, exact here: quadratics times the slope of the place.
   subroutine check_resultants(tip)
      integer(ik), intent(in) :: tip
      real(rk) :: x(3), weights(3), nodal(3), share(3)
      integer :: k

      call gauss_rule(3_ik, x, weights)
      nodal = [0.0_rk, 1.0_rk, node_within(tip)]
      share = 0.0_rk
      do k = 1, 3
         share = share + weights(k)*dot_product(line_slopes(x(k)), nodal)*line_shapes(x(k))
      end do
      call same(line_resultants(tip), share, "integrals of the shape functions")
   end subroutine check_resultants

end program test_fine_line
