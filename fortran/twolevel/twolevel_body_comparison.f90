!> Intensities of a tip in its window compared with those in the whole body as one window, and what
!! this comparison says once the tip has moved or its intensities have changed
!! (twolevel_coarse_errors).
module twolevel_body_comparison
   use base_kinds, only: rk
   use base_plane, only: norm2
   use growth_tip, only: tip_t
   use twolevel_window_tip, only: window_tip_t
   implicit none(type, external)
   private

   public :: admissible_change, compare_tip, is_new, keep_body, keep_comparison, shown

   !> Relative change of the intensities within which the last comparison with the body still
   !! applies [-].
   real(rk), parameter :: like_before = 0.05_rk

   !> Change of the difference between window and body while the last comparison applies, over K:
   !! where the tip has not moved and where it has, over the relative change of K, and at most.
   !! With the difference before it is not exceeded in 97 % of 4,000 states of tips near their
   !! toughness and in 98 % of 3,500 others (D1, D4, four networks of 30 fractures, of which three
   !! were drawn afterwards) [-].
   real(rk), parameter :: of_still = 0.002_rk, of_moved = 0.01_rk, of_change = 0.2_rk, &
                          of_all = 0.03_rk

contains

   !> Whether a tip has not been compared with the body in its present window.
   pure logical function is_new(tip)
      type(window_tip_t), intent(in) :: tip

      is_new = .not. norm2(tip%compared) > 0.0_rk
   end function is_new

   !> Change of the intensities of a tip within which its last comparison with the body still
   !! applies: more where the tip is below its toughness, as long as it cannot have reached it
   !! [Pa m^1/2].
   pure real(rk) function admissible_change(tip, seen, toughness) result(change)
      type(tip_t), intent(in) :: tip
      type(window_tip_t), intent(in) :: seen  !< the tip in its window
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      real(rk), parameter :: far = 0.5_rk, small = 0.1_rk
      real(rk) :: lack  ! of toughness, error included [-]

      lack = -tip%excess(toughness) - tip%relative_error(toughness)
      change = max(like_before, min(lack, 1.0_rk))*norm2(seen%compared)
      if (lack < far) return
      change = max(norm2(seen%compared), small*toughness*tip%drive%resistance)
   end function admissible_change

   !> Errors of a tip from its K in the whole body.
   pure subroutine compare_tip(body, excess, tip)
      type(window_tip_t), intent(in) :: body
      real(rk), intent(in) :: excess  !< of K_II there [-]
      type(window_tip_t), intent(inout) :: tip
      real(rk) :: of_body(2), of_window(2)

      of_body = [body%found%k1_error, body%found%k2_error]
      of_window = [tip%found%k1_error, tip%found%k2_error]
      tip%compared = [tip%found%k1, tip%found%k2]
      tip%lacking = [body%found%k1, (1.0_rk - excess)*body%found%k2] - tip%compared
      tip%uncertain = shown(tip%lacking, tip%found%closed)
      tip%of_edge = maxval(tip%uncertain)
      tip%of_elements = max(maxval(of_body), maxval(of_window))
      tip%uncertain = tip%uncertain + max(0.0_rk, of_body - of_window)
   end subroutine compare_tip

   !> Compare a tip with its K in the body as it was found by the last comparison: its window is
   !! another one in the same state. Without a comparison that applies there will be a new one.
   pure subroutine keep_body(before, reference, tip)
      type(window_tip_t), intent(in) :: before  !< the tip in its window before
      type(window_tip_t), intent(in) :: reference  !< the tip in the body as one window
      type(window_tip_t), intent(inout) :: tip
      type(window_tip_t) :: body

      associate (found => [before%found%k1, before%found%k2])
         if (.not. norm2(found - before%compared) <= like_before*norm2(before%compared)) return
         body%found = reference%found
         body%found%k1 = found(1) + before%lacking(1)
         body%found%k2 = found(2) + before%lacking(2)
      end associate
      call compare_tip(body, 0.0_rk, tip)
   end subroutine keep_body

   !> Errors of a tip from the last comparison with the whole body, larger where its intensities
   !! have changed since.
   pure subroutine keep_comparison(xy, tip)
      real(rk), intent(in) :: xy(2)  !< its position [m]
      type(window_tip_t), intent(inout) :: tip
      real(rk) :: change, ratio

      associate (found => [tip%found%k1, tip%found%k2], before => norm2(tip%compared))
         if (is_new(tip)) then
            tip%uncertain = shown(found, tip%found%closed)
         else
            ratio = max(1.0_rk, norm2(found)/before)
            change = merge(of_moved, of_still, norm2(xy - tip%compared_at) > 0.0_rk) &
                     + of_change*norm2(found - tip%compared)/before
            tip%uncertain = shown(ratio*tip%lacking, tip%found%closed) &
                            + min(change, of_all)*shown(found, tip%found%closed)
         end if
      end associate
      tip%of_elements = max(tip%found%k1_error, tip%found%k2_error)
   end subroutine keep_comparison

   !> Errors of K_I and K_II from their differences. An error of one mode is an error of both: a
   !! small difference of a single mode is chance, unless the contact law closes the tip.
   pure function shown(difference, is_closed) result(error)
      real(rk), intent(in) :: difference(2)  !< [Pa m^1/2]
      logical, intent(in) :: is_closed
      real(rk) :: error(2)  !< [Pa m^1/2]

      error = norm2(difference)
      if (is_closed) error(1) = abs(difference(1))
   end function shown

end module twolevel_body_comparison
