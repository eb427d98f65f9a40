!> Where tips go from one try of a step to the next: alone, with those of their kind, or all as they
!! have to together.
module twolevel_moves
   use base_kinds, only: ik, rk
   use growth_company, only: lags_behind
   use growth_kinds, only: numbered
   use growth_tip, only: tip_t
   use twolevel_excess, only: excesses, shared_excesses, tolerance
   use twolevel_pieces, only: have_come
   use twolevel_state, only: two_levels_t
   implicit none(type, external)
   private

   public :: judge_tips, keep_together, part_company, several_kinds, tips_in_play

contains

   !> Let the tips on a segment go where their excess will probably vanish; others want a segment if
   !! they exceed the toughness. Tips of one kind take the largest of their excesses, and so go on
   !! equally far.
   subroutine judge_tips(self, kind, is_coupled, moves, wants)
      class(two_levels_t), intent(inout) :: self
      integer(ik), intent(in) :: kind(:)  !< of each tip, from 1
      logical, intent(in) :: is_coupled  !< the kinds move together
      logical, intent(out) :: moves(:), wants(:)  !< (tips)
      real(rk), dimension(size(self%tip)) :: alone, excess
      integer(ik) :: i

      alone = shared_excesses(self)
      do i = 1, size(self%tip, kind=ik)
         excess(i) = maxval(alone, mask=kind == kind(i))
      end do
      ! Nothing but a rest before them: it fails as soon as they are at the toughness, before others
      ! go on, for which they would wait else where all are at it alike.
      where (have_come(self)) excess = excess + 2.0_rk*tolerance
      call move_kinds(self, kind, excess, is_coupled, moves)
      wants = .not. (moves .or. excess <= tolerance .or. self%tip%arrested)
      where (self%now%segment%is_open) wants = wants .and. self%now%segment%is_complete()
   end subroutine judge_tips

   !> Tips on their way that exceed their toughness, or have advanced in the step.
   pure function tips_in_play(self) result(in_play)
      class(two_levels_t), intent(in) :: self
      logical :: in_play(size(self%tip))

      in_play = self%now%segment%is_open .and. (excesses(self) > -tolerance .or. &
                                               self%now%segment%reached > self%now%segment%lowest())
   end function tips_in_play

   !> Of tips that all exceed their toughness or may go back there are several kinds.
   pure logical function several_kinds(kind, in_play)
      integer(ik), intent(in) :: kind(:)  !< from 1
      logical, intent(in) :: in_play(:)

      several_kinds = any(in_play)
      if (several_kinds) several_kinds = minval(kind, mask=in_play) < maxval(kind, mask=in_play)
   end function several_kinds

   !> The first tip of each kind moves by its own secants, or as all of them have to together; those
   !! that are like it keep up with it.
   subroutine move_kinds(self, kind, excess, is_coupled, moves)
      class(two_levels_t), intent(inout) :: self
      integer(ik), intent(in) :: kind(:)  !< of each tip, from 1
      real(rk), intent(in) :: excess(:)  !< (tips) of K_eq over K_IC [-]
      logical, intent(in) :: is_coupled
      logical, intent(out) :: moves(:)
      integer(ik), allocatable :: leader(:), number(:), on_way(:)
      logical :: has_moved
      integer(ik) :: i, k

      moves = .false.
      call find_leaders(self, kind, on_way, number, leader)
      if (is_coupled) then
         call move_together(self, on_way, number, leader, excess(leader), moves)
      else
         do k = 1, size(leader, kind=ik)
            call self%now%segment(leader(k))%improve(excess(leader(k)), tolerance, moves(leader(k)))
         end do
      end if
      do k = 1, size(on_way, kind=ik)
         i = leader(number(k))
         if (on_way(k) == i) cycle
         call self%now%segment(on_way(k))%keep_up_with(self%now%segment(i), has_moved)
         moves(on_way(k)) = moves(i) .or. has_moved
      end do
   end subroutine move_kinds

   !> Those that are on their way, and the first one of each kind of them.
   pure subroutine find_leaders(self, kind, on_way, number, leader)
      class(two_levels_t), intent(in) :: self
      integer(ik), intent(in) :: kind(:)  !< of each tip, from 1
      integer(ik), allocatable, intent(out) :: on_way(:)  !< tips
      integer(ik), allocatable, intent(out) :: number(:)  !< of the kind of each of these, from 1
      integer(ik), allocatable, intent(out) :: leader(:)  !< (kinds) tips
      integer(ik) :: i, k

      on_way = pack([(i, i=1, size(self%tip, kind=ik))], self%now%segment%is_open)
      number = numbered(kind(on_way))
      leader = [(on_way(findloc(number, k, dim=1)), k=1, maxval([number, 0_ik]))]
   end subroutine find_leaders

   !> Tips of one kind begin a step, or a piece, equally far along: where the first of them does.
   pure subroutine keep_together(self, kind)
      class(two_levels_t), intent(inout) :: self
      integer(ik), intent(in) :: kind(:)  !< of each tip, from 1
      integer(ik), allocatable :: leader(:), number(:), on_way(:)
      logical :: has_moved
      integer(ik) :: k

      call find_leaders(self, kind, on_way, number, leader)
      do k = 1, size(on_way, kind=ik)
         associate (segment => self%now%segment(on_way(k)), &
                    first => self%now%segment(leader(number(k))))
            if (on_way(k) /= leader(number(k))) then
               call segment%go_to(segment%length*(first%reached/first%length), has_moved)
            end if
         end associate
      end do
   end subroutine keep_together

   !> The first tips of the kinds move together, unless all are at rest.
   subroutine move_together(self, on_way, number, leader, excess, moves)
      class(two_levels_t), intent(inout) :: self
      integer(ik), intent(in) :: on_way(:)  !< tips
      integer(ik), intent(in) :: number(:)  !< of the kind of each
      integer(ik), intent(in) :: leader(:)  !< (kinds) tips
      real(rk), intent(in) :: excess(:)  !< (kinds) of K_eq over K_IC [-]
      logical, intent(inout) :: moves(:)  !< (all tips)
      real(rk) :: to(size(leader))
      integer :: k

      associate (segment => self%now%segment)
         do k = 1, size(leader)
            call segment(leader(k))%learn(excess(k))
         end do
         if (all(segment(leader)%is_at_rest(excess, tolerance))) return
         to = segment(leader)%reached &
              + self%now%rivals%changes(on_way, number, excess, segment(leader))
         do k = 1, size(leader)
            call segment(leader(k))%go_to(to(k), moves(leader(k)))
         end do
      end associate
   end subroutine move_together

   !> Tips at rest that have gone along with their kind in the step, or want to, but lack their own
   !! toughness: each is a kind of its own from now on, and begins anew where it was. Not those that
   !! were on their way and at their toughness before the step: one mesh may throw them back. Nor
   !! those that lack no more than the first of their kind does: a first piece, which kinks, may
   !! throw all of them back.
   subroutine part_company(self, before, wants, kind, any_parted)
      class(two_levels_t), intent(inout) :: self
      type(tip_t), intent(in) :: before(:)  !< the tips before the step
      logical, intent(in) :: wants(:)  !< (tips) a new piece
      integer(ik), intent(inout) :: kind(:)  !< of each tip, from 1
      logical, intent(out) :: any_parted
      logical :: lags(size(kind))
      real(rk) :: first(size(kind))
      integer(ik) :: i

      first = [(min(0.0_rk, maxval(self%tip%drive%intensity/self%rules%toughness - 1.0_rk, &
                                   mask=kind == kind(i))), i=1, size(kind))]
      associate (segment => self%now%segment)
         lags = (wants .or. (segment%is_open .and. segment%reached > segment%lowest())) .and. &
                lacks(self%tip, first) .and. &
                (lacks(before, 0.0_rk) .or. .not. segment%gain > 0.0_rk)
      end associate
      any_parted = .false.
      do i = 1, size(kind, kind=ik)
         if (.not. lags(i) .or. count(kind == kind(i)) == 1) cycle
         kind(i) = maxval(kind) + 1
         call self%now%company%part(i)
         if (self%now%segment(i)%is_open) call self%now%segment(i)%restart()
         any_parted = .true.
      end do

   contains

      pure elemental logical function lacks(tip, first)
         type(tip_t), intent(in) :: tip
         real(rk), intent(in) :: first  !< what that of its kind lacks, as an excess [-]

         associate (k => tip%intensity, toughness => self%rules%toughness)
            lacks = lags_behind(tip%drive%intensity/toughness - 1.0_rk - first, &
                                max(k%k1_error, k%k2_error)/(toughness*tip%drive%resistance))
         end associate
      end function lacks

   end subroutine part_company

end module twolevel_moves
