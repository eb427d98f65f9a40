!> The field of unit intensity against the polar formulas of Williams (1957) and against
!! differences.
program test_fine_tip_field
   use base_kinds, only: ik, pi, rk
   use fine_tip_field, only: auxiliary_field, auxiliary_field_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks
   real(rk), parameter :: mu = 0.8_rk, kappa = 1.9_rk
   real(rk), parameter :: angles(5) = [-3.1_rk, -1.2_rk, 0.0_rk, 0.7_rk, 2.9_rk], step = 1.0e-5_rk
   integer(ik) :: i, mode

   do mode = 1, 2
      do i = 1, size(angles)
         call compare(mode, 1.3_rk, angles(i))
      end do
      call faces(mode)
   end do
   call checks%finish()

contains

   !> Displacement of the crack-tip field.
   pure function williams(mode, x, y) result(u)
      integer(ik), intent(in) :: mode
      real(rk), intent(in) :: x, y
      real(rk) :: u(2), half, scale, c

      half = 0.5_rk*atan2(y, x)
      c = cos(2.0_rk*half)
      scale = sqrt(hypot(x, y)/(2.0_rk*pi))/(2.0_rk*mu)
      if (mode == 1) then
         u = scale*[cos(half)*(kappa - c), sin(half)*(kappa - c)]
      else
         u = scale*[sin(half)*(kappa + 2.0_rk + c), -cos(half)*(kappa - 2.0_rk + c)]
      end if
   end function williams

   subroutine compare(mode, r, angle)
      integer(ik), intent(in) :: mode
      real(rk), intent(in) :: r, angle
      type(auxiliary_field_t) :: field, right, left
      real(rk) :: x, y, gradient(2, 2), stress(2, 2), difference(2, 2), lambda, trace

      x = r*cos(angle)
      y = r*sin(angle)
      field = auxiliary_field(mode, root(x, y), kappa, mu)
      gradient(:, 1) = (williams(mode, x + step, y) - williams(mode, x - step, y))/(2.0_rk*step)
      gradient(:, 2) = (williams(mode, x, y + step) - williams(mode, x, y - step))/(2.0_rk*step)
      lambda = mu*(3.0_rk - kappa)/(kappa - 1.0_rk)
      trace = gradient(1, 1) + gradient(2, 2)
      stress = mu*(gradient + transpose(gradient))
      stress(1, 1) = stress(1, 1) + lambda*trace
      stress(2, 2) = stress(2, 2) + lambda*trace
      call checks%is_close(norm2(field%slope - gradient(:, 1)), 0.0_rk, 1.0e-9_rk, "slope")
      call checks%is_close(norm2(field%stress - stress), 0.0_rk, 1.0e-9_rk, "stress")
      right = auxiliary_field(mode, root(x + step, y), kappa, mu)
      left = auxiliary_field(mode, root(x - step, y), kappa, mu)
      difference = (strain(right) - strain(left))/(2.0_rk*step)
      call checks%is_close(norm2(field%strain_slope - difference), 0.0_rk, 1.0e-9_rk, &
                           "slope of the strain")
   end subroutine compare

   !> From the stress, by Hooke's law.
   pure function strain(field)
      type(auxiliary_field_t), intent(in) :: field
      real(rk) :: strain(2, 2), lambda, mean

      lambda = mu*(3.0_rk - kappa)/(kappa - 1.0_rk)
      mean = lambda/(2.0_rk*(lambda + mu))*(field%stress(1, 1) + field%stress(2, 2))
      strain = field%stress
      strain(1, 1) = strain(1, 1) - mean
      strain(2, 2) = strain(2, 2) - mean
      strain = strain/(2.0_rk*mu)
   end function strain

   pure complex(rk) function root(x, y)
      real(rk), intent(in) :: x, y

      root = sqrt(hypot(x, y))*exp(cmplx(0.0_rk, 0.5_rk*atan2(y, x), rk))
   end function root

   !> No traction on the faces; unit intensity ahead.
   subroutine faces(mode)
      integer(ik), intent(in) :: mode
      type(auxiliary_field_t) :: field
      integer(ik) :: side

      do side = -1, 1, 2
         field = auxiliary_field(mode, cmplx(0.0_rk, side*sqrt(0.6_rk), rk), kappa, mu)
         call checks%is_close(norm2(field%stress(:, 2)), 0.0_rk, 1.0e-15_rk, "free faces")
      end do
      field = auxiliary_field(mode, cmplx(sqrt(0.6_rk), 0.0_rk, rk), kappa, mu)
      call checks%is_close(field%stress(3 - mode, 2)*sqrt(2.0_rk*pi*0.6_rk), 1.0_rk, 1.0e-14_rk, &
                           "unit intensity ahead")
   end subroutine faces

end program test_fine_tip_field
