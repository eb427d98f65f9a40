!> Slopes of the cubic law for Newton's iteration: the less steep of tangent and secant, and the
!! iteration on a crack that a flow opens, where the loss falls as the flow rises.
program test_coarse_fracture_flow
   use base_kinds, only: rk
   use coarse_fracture_flow, only: loss_slope
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: least = 1.0e-5_rk  !< least conducting aperture [m]
   real(rk), parameter :: before = 2.0e-6_rk  !< aperture where the step begins [m]
   real(rk), parameter :: stiffness = 1.0e11_rk  !< K of a crack [Pa/m]
   real(rk), parameter :: viscous = 1.0e-4_rk  !< C of the flow into it [Pa m2]
   type(checks_t) :: checks

   call test_slopes(1.0e6_rk)
   call test_slopes(-1.0e6_rk)
   call test_opening_crack()
   call checks%finish()

contains

   !> Where the loss is too large, along the slope it equals the drop at the aperture at which the
   !! cubic law makes them equal; where it is too small, the slope is the derivative.
   subroutine test_slopes(loss)
      real(rk), intent(in) :: loss  !< [Pa]
      real(rk), parameter :: shares(4) = [1.0e-3_rk, 0.5_rk, 2.0_rk, 1.0e3_rk]  ! drop over loss
      real(rk), parameter :: a = 3.0e-5_rk, below = 1.0e-5_rk  ! apertures [m]
      real(rk) :: derivative, drop, slope, wanted
      integer :: k

      derivative = -3.0_rk*loss/a
      do k = 1, size(shares)
         drop = shares(k)*loss
         slope = loss_slope(loss, drop, a, a, .false.)
         if (shares(k) < 1.0_rk) then
            wanted = a*shares(k)**(-1.0_rk/3.0_rk)
            call checks%is_close(a + (drop - loss)/slope, wanted, 1.0e-12_rk*wanted, "secant")
            slope = loss_slope(loss, drop, a, below, .true.)
            call checks%is_close(below + (drop - loss)/slope, wanted, 1.0e-12_rk*wanted, &
                                 "secant from below the least aperture")
         else
            call checks%is_close(slope, derivative, 1.0e-15_rk*abs(derivative), "tangent")
            call checks%is_close(loss_slope(loss, drop, a, a, .true.), derivative/shares(k), &
                                 1.0e-15_rk*abs(derivative), "flat")
            call checks%is_close(loss_slope(loss, drop, a, below, .false.), 0.0_rk, 0.0_rk, &
                                 "the least aperture is too wide")
         end if
         call checks%is_close(loss_slope(loss, -drop, a, a, .false.), 0.0_rk, 0.0_rk, "against it")
      end do
      slope = loss_slope(loss, loss*(1.0_rk - 1.0e-13_rk), a, a, .false.)
      call checks%is_close(slope, derivative, 1.0e-12_rk*abs(derivative), "secant at the solution")
   end subroutine test_slopes

   !> A crack that a flow from the pressure P opens in a step: C (a - a_before)/a^3 = P - K a. The
   !! left side rises to the least aperture and falls from there on. Where it stays below a third
   !! of the right side, the iteration with flat slopes leads to the solution; that with
   !! tangents and secants cycles for some P.
   subroutine test_opening_crack()
      integer, parameter :: n = 200
      real(rk) :: a, exact, pressure
      integer :: k, n_cycles, n_wide
      logical :: is_done

      n_cycles = 0
      n_wide = 0
      do k = 1, n
         pressure = 1.0e7_rk*10.0_rk**(-1.6_rk + 2.6_rk*k/n)
         exact = next_above(pressure)
         call iterate(pressure, .true., a, is_done)
         if (exact > least) then
            n_wide = n_wide + 1
            call iterate(pressure, .false., a, is_done)
            if (.not. is_done) n_cycles = n_cycles + 1
            call iterate(pressure, .true., a, is_done)
            if (off(pressure, least) > -2.0_rk/3.0_rk*(pressure - stiffness*least)) cycle
         end if
         call checks%is_true(is_done, "the iteration converges")
         call checks%is_close(a, exact, 1.0e-7_rk*exact, "to the next solution")
      end do
      print "(2(a,i4))", "beyond the least aperture:", n_wide, ", without flat slopes cycle:", &
         n_cycles
      call checks%is_true(n_cycles > 0 .and. n_wide < n, "all kinds occur")
   end subroutine test_opening_crack

   !> Loss less drop [Pa].
   pure real(rk) function off(pressure, a)
      real(rk), intent(in) :: pressure  !< P [Pa]
      real(rk), intent(in) :: a  !< [m]

      off = viscous*(a - before)/max(a, least)**3 - (pressure - stiffness*a)
   end function off

   subroutine iterate(pressure, is_flat, a, is_done)
      real(rk), intent(in) :: pressure  !< P [Pa]
      logical, intent(in) :: is_flat
      real(rk), intent(out) :: a  !< [m]
      logical, intent(out) :: is_done
      integer, parameter :: most = 500
      real(rk) :: slope, wide
      integer :: i

      a = before
      do i = 1, most
         is_done = abs(off(pressure, a)) <= 1.0e-11_rk*pressure
         if (is_done) return
         wide = max(a, least)
         slope = loss_slope(viscous*(a - before)/wide**3, pressure - stiffness*a, wide, a, is_flat)
         a = a - off(pressure, a)/(viscous/wide**3 + stiffness + slope)
      end do
   end subroutine iterate

   !> The solution next above the start, by short steps and bisection [m].
   real(rk) function next_above(pressure) result(low)
      real(rk), intent(in) :: pressure  !< P [Pa]
      real(rk) :: high, middle
      integer :: i

      low = before
      high = before
      do while (off(pressure, high) < 0.0_rk)
         low = high
         high = 1.001_rk*low
      end do
      do i = 1, 60
         middle = 0.5_rk*(low + high)
         if (off(pressure, middle) < 0.0_rk) then
            low = middle
         else
            high = middle
         end if
      end do
   end function next_above

end program test_coarse_fracture_flow
