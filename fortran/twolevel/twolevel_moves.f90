!> Changes of the tip positions from one try of a step to the next: of single tips, of tip groups,
!! or of all tips together; and the share of a step after which tips reach their toughness or a
!! target.
module twolevel_moves
   use base_kinds, only: ik, rk
   use growth_advances, only: advances_t
   use growth_competition, only: numbered
   use growth_interaction, only: interaction_t, lags_behind, tip_groups_t
   use growth_segment, only: segment_t, sliver
   use growth_tip, only: tip_t
   implicit none(type, external)
   private

   public :: arrivals, at_joints, driven_t, excess_max, first_onset, is_in_play, judge_tips
   public :: keep_together, onset, overshoots, separate_tips, set_out, tolerance

   real(rk), parameter :: tolerance = 5.0e-3_rk  !< tolerance of K_eq/K_IC of growing tips [-]

   !> Admissible excess of a tip that reaches a target [-].
   real(rk), parameter :: at_joints = 2.0_rk*tolerance

   !> Deficit of K_eq/K_IC before a step below which a tip begins to grow at the start of the step
   !! [-].
   real(rk), parameter :: onset_lack = 5.0e-3_rk

   !> Lack or excess of toughness at which a search that has stalled ends, over the error of K_eq,
   !! and the largest lack [-].
   real(rk), parameter :: share_of_error = 0.5_rk, slack_max = 0.1_rk

   !> Excess K_eq/K_IC - 1 up to which a segment begins in a tried step, and that up to which it
   !! does where the excess vanishes within the next segment by its slope: the direction of the
   !! segment would otherwise be that of a state that does not occur. Where K_IC is far below the K
   !! that the loads may bring about, the second one is a share of that K, as the least scales of
   !! tips are [-].
   real(rk), parameter :: excess_max = 0.2_rk, steep_excess_max = 1.0_rk, least_scales = 5.0_rk

   !> Position from which the search on a new segment starts, over the length of the segment: the
   !! mesh of its full length can be moved there, but not much farther back [-].
   real(rk), parameter :: first_place = 0.4_rk

   !> What drives one tip.
   type :: driven_t
      real(rk) :: excess = 0.0_rk  !< of K_eq over K_IC [-]
      real(rk) :: error = 0.0_rk  !< estimated error of the excess [-]
      logical :: is_at_ligament = .false.  !< only a ligament is left ahead of the tip
   end type driven_t

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

   !> Move the tips on open segments to where their excess is predicted to vanish; other tips begin
   !! a segment if they exceed the toughness. Tips of one group take the largest of their excesses,
   !! and so advance equally.
   subroutine judge_tips(segments, interaction, alone, kind, search, moves, wants)
      type(segment_t), intent(inout) :: segments(:)  !< (tips)
      type(interaction_t), intent(in) :: interaction
      type(driven_t), intent(in) :: alone(:)  !< (tips) each without its group
      integer(ik), intent(in) :: kind(:)  !< (tips) number of the group, from 1
      !> search for the positions of the tips on their segments
      type(advances_t), intent(inout) :: search
      logical, intent(out) :: moves(:), wants(:)  !< (tips)
      type(driven_t) :: group(size(kind))
      integer(ik) :: i

      do i = 1, size(kind, kind=ik)
         group(i) = driven_t(maxval(alone%excess, mask=kind == kind(i)), &
                             minval(alone%error, mask=kind == kind(i)), alone(i)%is_at_ligament)
      end do
      ! Only the ligament is left: it breaks as soon as K_eq reaches K_IC, before other tips
      ! advance. Without the increment, equal tips would all wait.
      where (group%is_at_ligament) group%excess = group%excess + 2.0_rk*tolerance
      call move_groups(segments, interaction, kind, group, search, moves)
      wants = .not. (moves .or. group%excess <= tolerance)
      where (segments%is_open) wants = wants .and. segments%is_complete()
   end subroutine judge_tips

   !> Whether a tip on an open segment exceeds its toughness, or has advanced in the step.
   elemental logical function is_in_play(segment, excess)
      type(segment_t), intent(in) :: segment
      real(rk), intent(in) :: excess  !< excess of K_eq over K_IC [-]

      is_in_play = segment%is_open .and. (excess > -tolerance .or. &
                                          segment%reached > segment%lowest())
   end function is_in_play

   !> Move the tip groups to the next iterate of the search for equilibrium; tips of one group
   !! advance equally.
   subroutine move_groups(segments, interaction, kind, group, search, moves)
      type(segment_t), intent(inout) :: segments(:)  !< (tips)
      type(interaction_t), intent(in) :: interaction
      integer(ik), intent(in) :: kind(:)  !< (tips) number of the group, from 1
      type(driven_t), intent(in) :: group(:)  !< (tips) what drives their groups
      type(advances_t), intent(inout) :: search
      logical, intent(out) :: moves(:)
      integer(ik), allocatable :: leader(:), number(:), on_way(:)
      type(segment_t), allocatable :: first(:)
      logical :: has_moved
      integer(ik) :: i, k

      moves = .false.
      call find_leaders(segments, kind, on_way, number, leader)
      if (size(leader) == 0) return
      if (search%evaluations == 0) then
         first = segments(leader)
         call search%begin(first%lowest(), first%length, first%reached, &
                           interaction%matrix_for(on_way, number, first), sliver*first%length)
      end if
      search%slack = min(slack_max, share_of_error*group(leader)%error)
      call search%improve(group(leader)%excess, tolerance, has_moved)
      do k = 1, size(leader, kind=ik)
         associate (segment => segments(leader(k)))
            if (search%matrix(k, k) < 0.0_rk) segment%slope = search%matrix(k, k)
            moves(leader(k)) = abs(search%place(k) - segment%reached) > 0.0_rk
            segment%reached = search%place(k)
         end associate
      end do
      do k = 1, size(on_way, kind=ik)
         i = leader(number(k))
         if (on_way(k) == i) cycle
         call segments(on_way(k))%keep_up_with(segments(i), has_moved)
         moves(on_way(k)) = moves(i) .or. has_moved
      end do
   end subroutine move_groups

   !> Tips on open segments, and the first tip of each group of these tips.
   pure subroutine find_leaders(segments, kind, on_way, number, leader)
      type(segment_t), intent(in) :: segments(:)  !< (tips)
      integer(ik), intent(in) :: kind(:)  !< (tips) number of the group, from 1
      integer(ik), allocatable, intent(out) :: on_way(:)  !< numbers of the tips on open segments
      !> (these tips) number of the group, from 1
      integer(ik), allocatable, intent(out) :: number(:)
      integer(ik), allocatable, intent(out) :: leader(:)  !< (groups) number of the first tip
      integer(ik) :: i, k

      on_way = pack([(i, i=1, size(segments, kind=ik))], segments%is_open)
      number = numbered(kind(on_way))
      leader = [(on_way(findloc(number, k, dim=1)), k=1, maxval([number, 0_ik]))]
   end subroutine find_leaders

   !> Put all tips of a group at the position of the first one along their segments, at the start of
   !! a step or segment.
   pure subroutine keep_together(segments, kind)
      type(segment_t), intent(inout) :: segments(:)  !< (tips)
      integer(ik), intent(in) :: kind(:)  !< (tips) number of the group, from 1
      integer(ik), allocatable :: leader(:), number(:), on_way(:)
      logical :: has_moved
      integer(ik) :: k

      call find_leaders(segments, kind, on_way, number, leader)
      do k = 1, size(on_way, kind=ik)
         associate (segment => segments(on_way(k)), first => segments(leader(number(k))))
            if (on_way(k) /= leader(number(k))) then
               call segment%go_to(segment%length*(first%reached/first%length), has_moved)
            end if
         end associate
      end do
   end subroutine keep_together

   !> Remove tips from their group that have advanced with the group in the step, or are to begin a
   !! segment with it, but are below their toughness by more than the group's first tip: each is
   !! alone from now on, and returns to its position at the start of the step. Tips that grew at
   !! their toughness in the last step stay: a single mesh may reduce their K_eq.
   !! So do tips that are no farther below their toughness than the first of their group: a first
   !! segment, which kinks, may reduce K_eq of all of them.
   subroutine separate_tips(segments, groups, tips, before, toughness, wants, kind, any_parted)
      type(segment_t), intent(inout) :: segments(:)  !< (tips)
      type(tip_groups_t), intent(inout) :: groups
      type(tip_t), intent(in) :: tips(:)
      type(tip_t), intent(in) :: before(:)  !< tips before the step
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      logical, intent(in) :: wants(:)  !< (tips) the tip is to begin a new segment
      integer(ik), intent(inout) :: kind(:)  !< (tips) number of the group, from 1
      logical, intent(out) :: any_parted
      logical :: lags(size(kind))
      real(rk) :: first(size(kind))
      integer(ik) :: i

      first = [(min(0.0_rk, maxval(tips%excess(toughness), mask=kind == kind(i))), i=1, size(kind))]
      lags = (wants .or. (segments%is_open .and. segments%reached > segments%lowest())) .and. &
             lacks(tips, first) .and. (lacks(before, 0.0_rk) .or. &
                                       .not. (segments%gain > 0.0_rk .and. before%advance > 0.0_rk))
      any_parted = .false.
      do i = 1, size(kind, kind=ik)
         if (.not. lags(i) .or. count(kind == kind(i)) == 1) cycle
         kind(i) = maxval(kind) + 1
         call groups%remove_tip(i)
         if (segments(i)%is_open) call segments(i)%restart()
         any_parted = .true.
      end do

   contains

      pure elemental logical function lacks(tip, first)
         type(tip_t), intent(in) :: tip
         real(rk), intent(in) :: first  !< excess of the first tip of the group, at most 0 [-]

         lacks = lags_behind(tip%excess(toughness) - first, tip%relative_error(toughness))
      end function lacks

   end subroutine separate_tips

   !> Whether a tip at the end of its segment exceeds its toughness by so much that it would go too
   !! far, or that the direction of the next segment would be wrong.
   elemental logical function overshoots(tip, segment, toughness, increment)
      type(tip_t), intent(in) :: tip
      type(segment_t), intent(in) :: segment
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      real(rk), intent(in) :: increment  !< length of the next segment [m]

      associate (excess => tip%excess(toughness), &
                 of_loads => least_scales*tip%least_scale/tip%scale_of(toughness))
         overshoots = excess > excess_max
         if (overshoots .and. excess <= max(steep_excess_max, of_loads)) then
            overshoots = .not. excess < -segment%slope*increment
         end if
      end associate
   end function overshoots

   !> Put a tip on its new segment where the search is to start: at the end where tips may jump, as
   !! they mostly do by more than a segment, before a target if they exceed their toughness by far;
   !! else where its excess is predicted to vanish, but not so near the start that the mesh of the
   !! whole segment cannot be moved there.
   pure subroutine set_out(segment, excess, may_jump, is_whole)
      type(segment_t), intent(inout) :: segment
      real(rk), intent(in) :: excess  !< K_eq/K_IC - 1 at the start of the segment [-]
      logical, intent(in) :: may_jump
      logical, intent(in) :: is_whole  !< the segment does not end before a target
      logical :: has_moved

      if (.not. segment%is_open) return
      if (.not. may_jump) call segment%set_out(excess)
      if (.not. (is_whole .or. (may_jump .and. excess > excess_max))) return
      call segment%go_to(merge(segment%length, max(segment%reached, first_place*segment%length), &
                               may_jump), has_moved)
   end subroutine set_out

end module twolevel_moves
