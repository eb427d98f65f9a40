!> Changes of the tip positions from one try of a step to the next: of single tips, of tip groups,
!! or of all tips together.
module twolevel_moves
   use base_kinds, only: ik, rk
   use growth_advances, only: advances_t
   use growth_competition, only: numbered
   use growth_rivals, only: company_t, lags_behind, rivals_t
   use growth_segment, only: segment_t, sliver
   use growth_tip, only: tip_t
   use twolevel_excess, only: tolerance
   implicit none(type, external)
   private

   public :: is_in_play, judge_tips, keep_together, part_company

contains

   !> Let the tips on a segment go where their excess will probably vanish; others want a segment if
   !! they exceed the toughness. Tips of one kind take the largest of their excesses, and so go on
   !! equally far.
   subroutine judge_tips(segments, rivals, alone, has_come, is_arrested, kind, search, moves, wants)
      type(segment_t), intent(inout) :: segments(:)  !< (tips)
      type(rivals_t), intent(in) :: rivals
      real(rk), intent(in) :: alone(:)  !< (tips) their own excesses of K_eq over K_IC [-]
      logical, intent(in) :: has_come(:)  !< (tips) nothing but a rest lies before it
      logical, intent(in) :: is_arrested(:)
      integer(ik), intent(in) :: kind(:)  !< of each tip, from 1
      type(advances_t), intent(inout) :: search  !< for the places of the tips on segments
      logical, intent(out) :: moves(:), wants(:)  !< (tips)
      real(rk) :: excess(size(kind))
      integer(ik) :: i

      excess = [(maxval(alone, mask=kind == kind(i)), i=1, size(kind))]
      ! Nothing but a rest before them: it fails as soon as they are at the toughness, before others
      ! go on, for which they would wait else where all are at it alike.
      where (has_come) excess = excess + 2.0_rk*tolerance
      call move_kinds(segments, rivals, kind, excess, search, moves)
      wants = .not. (moves .or. excess <= tolerance .or. is_arrested)
      where (segments%is_open) wants = wants .and. segments%is_complete()
   end subroutine judge_tips

   !> A tip on its way exceeds its toughness, or has advanced in the step.
   elemental logical function is_in_play(segment, excess)
      type(segment_t), intent(in) :: segment
      real(rk), intent(in) :: excess  !< of K_eq over K_IC [-]

      is_in_play = segment%is_open .and. (excess > -tolerance .or. &
                                          segment%reached > segment%lowest())
   end function is_in_play

   !> The kinds move to where equilibrium is sought next; tips of one kind go equally far.
   subroutine move_kinds(segments, rivals, kind, excess, search, moves)
      type(segment_t), intent(inout) :: segments(:)  !< (tips)
      type(rivals_t), intent(in) :: rivals
      integer(ik), intent(in) :: kind(:)  !< of each tip, from 1
      real(rk), intent(in) :: excess(:)  !< (tips) of K_eq over K_IC [-]
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
                           rivals%matrix_for(on_way, number, first), sliver*first%length)
      end if
      call search%improve(excess(leader), tolerance, has_moved)
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
   end subroutine move_kinds

   !> Those that are on their way, and the first one of each kind of them.
   pure subroutine find_leaders(segments, kind, on_way, number, leader)
      type(segment_t), intent(in) :: segments(:)  !< (tips)
      integer(ik), intent(in) :: kind(:)  !< of each tip, from 1
      integer(ik), allocatable, intent(out) :: on_way(:)  !< tips
      integer(ik), allocatable, intent(out) :: number(:)  !< of the kind of each of these, from 1
      integer(ik), allocatable, intent(out) :: leader(:)  !< (kinds) tips
      integer(ik) :: i, k

      on_way = pack([(i, i=1, size(segments, kind=ik))], segments%is_open)
      number = numbered(kind(on_way))
      leader = [(on_way(findloc(number, k, dim=1)), k=1, maxval([number, 0_ik]))]
   end subroutine find_leaders

   !> Tips of one kind begin a step, or a piece, equally far along: where the first of them does.
   pure subroutine keep_together(segments, kind)
      type(segment_t), intent(inout) :: segments(:)  !< (tips)
      integer(ik), intent(in) :: kind(:)  !< of each tip, from 1
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

   !> Tips at rest that have gone along with their kind in the step, or want to, but lack their own
   !! toughness: each is a kind of its own from now on, and begins anew where it was. Not those that
   !! were on their way and at their toughness before the step: one mesh may throw them back. Nor
   !! those that lack no more than the first of their kind does: a first piece, which kinks, may
   !! throw all of them back.
   subroutine part_company(segments, company, tips, before, toughness, wants, kind, any_parted)
      type(segment_t), intent(inout) :: segments(:)  !< (tips)
      type(company_t), intent(inout) :: company
      type(tip_t), intent(in) :: tips(:)
      type(tip_t), intent(in) :: before(:)  !< the tips before the step
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      logical, intent(in) :: wants(:)  !< (tips) a new piece
      integer(ik), intent(inout) :: kind(:)  !< of each tip, from 1
      logical, intent(out) :: any_parted
      logical :: lags(size(kind))
      real(rk) :: first(size(kind))
      integer(ik) :: i

      first = [(min(0.0_rk, maxval(tips%excess(toughness), mask=kind == kind(i))), i=1, size(kind))]
      lags = (wants .or. (segments%is_open .and. segments%reached > segments%lowest())) .and. &
             lacks(tips, first) .and. (lacks(before, 0.0_rk) .or. .not. segments%gain > 0.0_rk)
      any_parted = .false.
      do i = 1, size(kind, kind=ik)
         if (.not. lags(i) .or. count(kind == kind(i)) == 1) cycle
         kind(i) = maxval(kind) + 1
         call company%part(i)
         if (segments(i)%is_open) call segments(i)%restart()
         any_parted = .true.
      end do

   contains

      pure elemental logical function lacks(tip, first)
         type(tip_t), intent(in) :: tip
         real(rk), intent(in) :: first  !< what that of its kind lacks, as an excess [-]

         lacks = lags_behind(tip%excess(toughness) - first, tip%relative_error(toughness))
      end function lacks

   end subroutine part_company

end module twolevel_moves
