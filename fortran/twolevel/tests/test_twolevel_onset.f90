!> Error of an onset time: exact for an intensity with a constant second derivative in time, solved
!! by backward Euler.
program test_twolevel_onset
   use base_kinds, only: rk
   use testing_checks, only: checks_t
   use twolevel_onset, only: approach_t
   implicit none(type, external)

   type(checks_t) :: checks

   call test_curved()
   call test_flat()
   call test_early_growth()
   call checks%finish()

contains

   !> dK/dt = 2 t by backward Euler leads to K = t**2 + h t in steps of h: too large by h t. The
   !! first step, which has no error estimate, contributes h**2.
   subroutine test_curved()
      type(approach_t) :: approach
      real(rk), parameter :: h = 0.1_rk, t = 2.0_rk
      real(rk) :: k
      integer :: n

      k = 0.0_rk
      call approach%follow(0.0_rk, k, 0.0_rk, 2.0_rk)
      do n = 1, 20
         k = k + h*2.0_rk*(n*h)
         call approach%follow(n*h, k, 0.01_rk, 2.0_rk)
      end do
      call checks%is_close(k - t**2, h*t, 1.0e-12_rk, "the error that there is")
      call checks%is_close(approach%drive%error, h*t - h**2, 1.0e-12_rk, "what is known of it")
      call checks%is_close(approach%uncertainty(0.03_rk), (h*t - h**2 + 0.04_rk)/(2.0_rk*t), &
                           1.0e-12_rk, "in time")
      ! K = 0.01 n (n + 1) passes 2 between n = 13 and 14, by linear interpolation.
      call checks%is_close(approach%onset, h*(13.0_rk + (2.0_rk - 1.82_rk)/0.28_rk), 1.0e-12_rk, &
                           "when the toughness was reached")
      call approach%follow(21*h, 1.9_rk, 0.01_rk, 2.0_rk)
      call checks%is_close(approach%onset, h*(13.0_rk + (2.0_rk - 1.82_rk)/0.28_rk), 1.0e-12_rk, &
                           "for the first time")
      ! A tip at 1.9 after an increase of 0.01 in a step of h, found to have grown: at this rate,
      ! but no later than this state.
      approach = approach_t()
      call approach%follow(0.0_rk, 1.89_rk, 0.0_rk, 2.0_rk)
      call approach%follow(h, 1.9_rk, 0.0_rk, 2.0_rk)
      call checks%is_close(approach%onset_before(100.0_rk*h, 2.0_rk), 11.0_rk*h, 1.0e-12_rk, &
                           "at the last rate")
      call checks%is_close(approach%onset_before(2.0_rk*h, 2.0_rk), 2.0_rk*h, 1.0e-12_rk, &
                           "no later than growth")
   end subroutine test_curved

   !> An intensity that does not increase gives no onset time.
   subroutine test_flat()
      type(approach_t) :: approach

      call approach%follow(0.0_rk, 1.0_rk, 0.0_rk, 2.0_rk)
      call approach%follow(1.0_rk, 1.0_rk, 0.0_rk, 2.0_rk)
      call checks%is_true(approach%uncertainty(0.01_rk) > 1.0e300_rk, "no rise")
   end subroutine test_flat

   !> K_eq rises by 0.1 per second and is known to 0.3, with a tolerance of 0.01: the onset is known
   !! to 3.1 s after the last state at 1 s, and so long the growth may not have begun.
   subroutine test_early_growth()
      type(approach_t) :: approach

      call approach%follow(0.0_rk, 1.8_rk, 0.0_rk, 2.0_rk)
      call approach%follow(1.0_rk, 1.9_rk, 0.3_rk, 2.0_rk)
      call checks%is_close(approach%early_growth(5.0_rk, 4.0_rk, 0.01_rk), 5.0_rk, 0.0_rk, "early")
      call checks%is_close(approach%early_growth(5.0_rk, 4.2_rk, 0.01_rk), 0.0_rk, 0.0_rk, "later")
      call approach%follow(2.0_rk, 1.9_rk, 0.3_rk, 2.0_rk)
      call checks%is_close(approach%early_growth(5.0_rk, 4.0_rk, 0.01_rk), 0.0_rk, 0.0_rk, &
                           "no rise, no estimate")
   end subroutine test_early_growth

end program test_twolevel_onset
