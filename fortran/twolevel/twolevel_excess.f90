!> Excess of the tips over their toughness in a tried step, and the share of the step after which
!! they reach the toughness or a target.
module twolevel_excess
   use base_kinds, only: rk
   use growth_segment, only: segment_t
   use growth_tip, only: tip_t
   implicit none(type, external)
   private

   public :: arrivals, at_joints, first_onset, onset, tolerance

   real(rk), parameter :: tolerance = 5.0e-3_rk  !< tolerance of K_eq/K_IC of growing tips [-]

   !> Admissible excess of a tip that reaches a target [-].
   real(rk), parameter :: at_joints = 2.0_rk*tolerance

   !> Deficit of K_eq/K_IC before a step below which a tip begins to grow at the start of the step
   !! [-].
   real(rk), parameter :: onset_lack = 5.0e-3_rk

contains

   !> Share of the step after which a tip begins to grow for the first time, in the tried state [-].
   pure real(rk) function first_onset(before, tips, segments, toughness)
      type(tip_t), intent(in) :: before(:)  !< tips at the start of the step
      type(tip_t), intent(in) :: tips(:)
      type(segment_t), intent(in) :: segments(:)  !< (tips)
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]

      first_onset = onset(before%excess(toughness), tips%excess(toughness), &
                          .not. (tips%arrested .or. segments%gain > 0.0_rk))
   end function first_onset

   !> Share of the step after which the first of the tips that count reaches the toughness; 1 where
   !! none begins to grow, or one does at the end of the step.
   pure function onset(before, after, counts)
      real(rk), intent(in) :: before(:), after(:)  !< excesses of the tips [-]
      logical, intent(in) :: counts(:)
      real(rk) :: onset
      integer :: i

      onset = 1.0_rk
      do i = 1, size(before)
         if (.not. counts(i) .or. before(i) > -onset_lack) cycle
         if (after(i) <= tolerance) cycle
         onset = min(onset, -before(i)/(after(i) - before(i)))
      end do
   end function onset

   !> Estimated shares of the step after which tips at the ends of their segments have reached them
   !! and exceed their toughness by more than `allowed`: the tips would have advanced further until
   !! their excess vanishes [-]. Tips on a ligament exceed it when their intensity has risen so far.
   pure function arrivals(before, tips, segments, toughness, allowed) result(share)
      type(tip_t), intent(in) :: before(:)  !< tips at the start of the step
      type(tip_t), intent(in) :: tips(:)
      type(segment_t), intent(in) :: segments(:)  !< (tips)
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      real(rk), intent(in) :: allowed  !< excess of K_eq over K_IC [-]
      real(rk), dimension(size(tips)) :: beyond, excess, room, rise, share

      excess = tips%excess(toughness)
      room = segments%length - segments%accepted
      beyond = max(0.0_rk, excess)/abs(segments%falling_slope())
      share = room/max(room + beyond, tiny(1.0_rk))
      share = share + (1.0_rk - share)*min(1.0_rk, allowed/max(excess, tolerance))
      rise = excess - before%excess(toughness)
      where (segments%stays() .and. rise > 0.0_rk)
         share = 1.0_rk - max(0.0_rk, min(1.0_rk, (excess - allowed)/rise))
      end where
   end function arrivals

end module twolevel_excess
