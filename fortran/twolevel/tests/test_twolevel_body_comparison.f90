!> Intensities in a window compared with those in the body: the comparison is exact where it is
!! made, and covers a window that is wrong by the same share after the tip has moved or the load
!! has risen.
program test_twolevel_body_comparison
   use base_kinds, only: rk
   use base_plane, only: norm2
   use testing_checks, only: checks_t
   use twolevel_body_comparison, only: compare_tip, is_new, keep_body, keep_comparison
   use twolevel_window_tip, only: window_tip_t
   implicit none(type, external)

   real(rk), parameter :: k(2) = [3.0e6_rk, -1.0e6_rk]  ! in the body [Pa m^1/2]
   real(rk), parameter :: off = 0.02_rk  ! relative error of the window
   real(rk), parameter :: here(2) = [1.0_rk, 2.0_rk], there(2) = [1.01_rk, 2.0_rk]  ! [m]
   type(checks_t) :: checks

   call test_comparison()
   call test_closed_tip()
   call test_kept()
   call test_other_window()
   call checks%finish()

contains

   !> A tip with intensities, and errors of its elements of a thousandth.
   pure function tip_with(intensities) result(tip)
      real(rk), intent(in) :: intensities(2)  !< [Pa m^1/2]
      type(window_tip_t) :: tip

      tip%found%k1 = intensities(1)
      tip%found%k2 = intensities(2)
      tip%found%k1_error = 1.0e-3_rk*norm2(intensities)
      tip%found%k2_error = tip%found%k1_error
   end function tip_with

   !> A tip in a window that is wrong by 2 %, compared with the body.
   pure function compared() result(tip)
      type(window_tip_t) :: tip

      tip = tip_with((1.0_rk + off)*k)
      call compare_tip(tip_with(k), 0.0_rk, tip)
      tip%compared_at = here
   end function compared

   subroutine test_comparison()
      type(window_tip_t) :: body, tip

      tip = tip_with((1.0_rk + off)*k)
      call checks%is_true(is_new(tip), "not compared yet")
      call keep_comparison(here, tip)
      call checks%is_true(all(tip%uncertain >= norm2(k)), "without a comparison K is not known")
      tip = compared()
      call checks%is_true(.not. is_new(tip), "compared")
      call checks%is_close(tip%found%k1 + tip%lacking(1), k(1), 1.0_rk, "K_I of the body")
      call checks%is_close(tip%found%k2 + tip%lacking(2), k(2), 1.0_rk, "K_II of the body")
     call checks%is_true(all(tip%uncertain >= 0.999_rk*off*norm2(k)), "the difference is the error")
      call checks%is_true(all(tip%uncertain <= 1.01_rk*off*norm2(k)), "and no more than that")

      body = tip_with(k)
      body%found%k1_error = 5.0e-3_rk*norm2(k)
      tip = tip_with(k)
      call compare_tip(body, 0.1_rk, tip)
      call checks%is_close(tip%lacking(2), -0.1_rk*k(2), 1.0_rk, "K_II without its excess")
      call checks%is_close(tip%uncertain(1) - norm2(tip%lacking), &
                           body%found%k1_error - tip%found%k1_error, 1.0_rk, &
                           "elements of the body that are less accurate than those of the window")
   end subroutine test_comparison

   !> A tip that is shut has K_I = 0: its error is that of K_I alone.
   subroutine test_closed_tip()
      type(window_tip_t) :: tip

      tip = tip_with([0.0_rk, (1.0_rk + off)*k(2)])
      tip%found%closed = .true.
      call compare_tip(tip_with([0.0_rk, k(2)]), 0.0_rk, tip)
      call checks%is_true(tip%uncertain(1) <= 1.0_rk, "K_I of a tip that is shut")
      call checks%is_close(tip%uncertain(2), off*abs(k(2)), 1.0e3_rk, "its K_II")
   end subroutine test_closed_tip

   !> K of the body is that of the window over 1 + 2 %: the kept error covers the rest, and is at
   !! most 3 % of K larger.
   subroutine test_kept()
      real(rk), parameter :: rise(5) = [1.0_rk, 1.04_rk, 1.3_rk, 2.0_rk, 0.5_rk]
      type(window_tip_t) :: tip
      real(rk) :: moved(2), true_error
      integer :: i, j

      do i = 1, size(rise)
         do j = 1, 2
            moved = merge(here, there, j == 1)
            tip = compared()
            tip%found%k1 = rise(i)*tip%found%k1
            tip%found%k2 = rise(i)*tip%found%k2
            call keep_comparison(moved, tip)
            true_error = off*rise(i)*norm2(k)
            call checks%is_true(all(tip%uncertain >= true_error), "kept: covered")
            call checks%is_true(all(tip%uncertain <= off*max(1.0_rk, rise(i))*norm2(k) &
                                    + 0.031_rk*rise(i)*norm2(k)), "kept: hardly larger")
         end do
      end do
      tip = compared()
      call keep_comparison(here, tip)
      call checks%is_true(all(tip%uncertain <= (off + 0.0025_rk)*norm2(k)), "the same state")
   end subroutine test_kept

   !> A larger window of the same state, wrong by .5 %: the body need not be solved again.
   subroutine test_other_window()
      type(window_tip_t) :: before, tip

      before = compared()
      tip = tip_with(1.005_rk*k)
      call keep_body(before, tip_with(k), tip)
      call checks%is_close(tip%found%k1 + tip%lacking(1), k(1), 1.0_rk, "other window: K_I")
      call checks%is_close(tip%found%k2 + tip%lacking(2), k(2), 1.0_rk, "other window: K_II")
      call checks%is_true(all(tip%uncertain <= 0.006_rk*norm2(k)), "other window: smaller error")
      before%found%k1 = 1.1_rk*before%found%k1
      tip = tip_with(k)
      call keep_body(before, tip_with(k), tip)
      call checks%is_true(is_new(tip), "the last comparison does not apply after such a change")
   end subroutine test_other_window

end program test_twolevel_body_comparison
