!> Growth as equilibrium (model.md section 5): at the end of a time step each tip has either not
!! advanced and K_eq <= K_IC, or advanced so far that K_eq = K_IC.
!!
!! Within a step the coarse level is solved from the state before with the tips where they are
!! tried to be, the windows give the intensities there, and each tip goes on until its excess
!! vanishes. A tip lies anywhere along the last straight piece of its path: the coarse mesh has a
!! cell for all of that piece, and its springs say how much of it is behind the tip (coarse_tips);
!! so the coarse mesh changes once per piece, and neither its matrix nor the fluid's volume jumps.
!! A piece begins in the direction in which K_II vanishes at its end (growth_path).
module twolevel_equilibrium
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use coarse_state, only: step_report_t
   use growth_company, only: lags_behind
   use growth_kinds, only: numbered
   use growth_network, only: total_length
   use growth_segment, only: segment_t
   use growth_targets, only: target_none
   use growth_tip, only: tip_t
   use mesh_types, only: network_t
   use simulation_doubt, only: doubtful
   use twolevel_doubt, only: improve_windows
   use twolevel_pieces, only: begin_pieces, can_join, comes_to, have_come, join_targets
   use twolevel_places, only: advances, place_tips
   use twolevel_probe, only: lesson_t, measure_rivals
   use twolevel_state, only: two_levels_t
   use twolevel_stepping, only: trial_t
   use twolevel_trust, only: estimate_coarse_errors
   use twolevel_wells, only: last_switch
   implicit none(type, external)
   private

   public :: accept_equilibrium, find_equilibrium, punctual, tolerance

   real(rk), parameter :: tolerance = 5.0e-3_rk  !< on K_eq/K_IC of growing tips [-]

   !> Excess of K_eq over K_IC, relative to that, beyond which no segment begins in a tried step:
   !! its direction would be that of a state that never is.
   real(rk), parameter :: excess_max = 0.2_rk

   !> A tip that lacks less than this of its toughness before a step begins to grow with it [-].
   real(rk), parameter :: onset_lack = 5.0e-3_rk

   !> A step that errs this much with the tips where they were cannot be taken, whatever they do
   !! [-].
   real(rk), parameter :: much = 4.0_rk

   !> A tip comes to a joint no earlier before the end of a step, and jumps in one no longer, than
   !! this share of the time since the wells were switched last [-].
   real(rk), parameter :: punctual = 5.0e-3_rk

   !> A tip with less than this share of its toughness in the first try of a step is not asked in
   !! the others, but for the last one.
   real(rk), parameter :: far = 0.7_rk

contains

   !> Try a step: state and tips at its end. A tip that would go on for more than one new piece
   !! goes too far, unless it may jump: the step is so short that it does not matter when in it that
   !! happens, or it is the last try, in which nothing but growth happens until that arrests.
   !! Nothing is accepted yet; a step that does not show an equilibrium leaves the state before. So
   !! does one in which a tip would grow, or might, whose intensities are not known well enough: its
   !! window is a better one then.
   subroutine find_equilibrium(self, dt, is_last, may_jump, timers, report, trial, error)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      logical, intent(in) :: is_last  !< its error in time is not judged; tips may jump
      logical, intent(in) :: may_jump
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(trial_t), intent(out) :: trial
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: tries_max = 25, jump_tries_max = 1000
      integer, parameter :: coupled_tries_max = 10  ! then what is known of the tips misleads
      real(rk) :: unmoved(size(self%tip))  ! K_eq of the first try [Pa m^1/2]
      logical, dimension(size(self%tip)) :: has_begun, in_play, joins, moves, wants
      integer(ik) :: kind(size(self%tip))
      logical :: any_exceeds, any_parted, has_measured, is_coupled
      type(lesson_t) :: lesson
      type(tip_t) :: tip(size(self%tip))
      type(segment_t) :: segment(size(self%tip))
      type(network_t) :: network
      integer :: k, most
      logical :: was_undrained

      was_undrained = self%undrained
      tip = self%tip
      segment = self%segment
      network = self%network
      call self%company%find_kinds(tip%drive%intensity/self%rules%toughness, &
                                   max(tip%intensity%k1_error, tip%intensity%k2_error) &
                                   /self%rules%toughness, segment%gain, tip%arrested, &
                                   self%rules%increment, self%rivals, kind)
      has_begun = .false.
      self%before = self%state
      call self%segment%restart()
      call self%certainty%begin_step()
      most = tries_max
      if (may_jump) most = jump_tries_max
      do k = 1, most
         call place_tips(self)
         call self%try_step(dt, timers, report, error)
         if (allocated(error)) exit
         trial%converged = report%converged
         if (.not. trial%converged) then
            trial%reason = report%reason
            exit
         end if
         if (k == 1 .and. .not. is_last) then
            trial%time_error = self%step_error(dt)
            if (self%errs(trial%time_error/much)) exit
         end if
         call self%evaluate(timers, error)
         if (allocated(error)) exit
         call self%certainty%see_try(total_length(self%network), &
                                     self%well_pressure())
         if (k == 1) then
            unmoved = self%tip%drive%intensity
            if (.not. is_last) trial%onset = first_onset(self, tip%drive%intensity)
            if (trial%onset < 1.0_rk) exit
         end if
         if (k == 1) self%asked = are_asked(self)
         in_play = tips_in_play(self)
         call lesson%tell(self)
         call measure_rivals(self, in_play, dt, timers, has_measured, error)
         if (allocated(error)) exit
         call lesson%begin(self)
         is_coupled = k <= coupled_tries_max
         if (is_coupled) is_coupled = several_kinds(kind, in_play)
         call judge_tips(self, kind, is_coupled, moves, wants)
         if (.not. (any(moves) .or. has_measured)) then
            call part_company(self, tip, wants, kind, any_parted)
            if (any_parted) then
               self%state = self%before
               cycle
            end if
            ! Not while others are on their way: they may go back.
            if (.not. may_jump) trial%onset = first_onset(self, tip%drive%intensity)
            if (trial%onset < 1.0_rk) exit
            joins = wants .and. can_join(self)
            wants = wants .and. self%tip%heads_for == target_none
            if (.not. (trial%has_joined .or. trial%jumps)) trial%time_error = self%step_error(dt)
            if (any(joins)) then
               ! The error in time is that up to the joint: what follows is a jump.
               if (.not. may_jump) then
                  trial%goes_too_far = any(joins .and. has_begun)
                  trial%arrival = minval(arrivals(self, tip%drive%intensity), mask=joins)
                  trial%is_late = (1.0_rk - trial%arrival)*dt > punctual &
                                  *(self%before%time - last_switch(self%scene, self%before%time))
                  if (trial%goes_too_far .or. trial%is_late .or. self%errs(trial%time_error)) exit
               end if
               call join_targets(self, joins)
               trial%has_joined = .true.
               self%state = self%before
               lesson = lesson_t()
               cycle
            end if
            if (.not. any(wants)) then
               call ask_others(self, any_exceeds, timers, error)
               if (allocated(error)) exit
               if (any_exceeds) then
                  self%state = self%before
                  cycle
               end if
               trial%advance = maxval([0.0_rk, advances(self)])/self%rules%increment
               if (.not. is_last .and. self%errs(trial%time_error)) exit
               call estimate_coarse_errors(self, timers, error)
               if (allocated(error)) exit
               call improve_windows(self, self%before%time, trial%needs_windows, error)
               if (allocated(error) .or. trial%needs_windows) exit
               return
            end if
            if (any(wants .and. doubtful(self%tip, self%rules%toughness))) then
               call improve_windows(self, self%before%time, trial%needs_windows, error)
               exit
            end if
            trial%jumps = trial%jumps .or. &
                          any(wants .and. (has_begun .or. excesses(self) > excess_max))
            trial%goes_too_far = trial%jumps .and. .not. may_jump
            if (trial%jumps) trial%time_error = 0.0_rk  ! what jumps has no rates
            if (trial%goes_too_far) then
               trial%was_beyond = any(wants .and. tip%drive%intensity/self%rules%toughness &
                                      > 1.0_rk + excess_max)
               ! From where they come to the toughness on, not from the start of the step.
               trial%onset = onset(tip%drive%intensity/self%rules%toughness, &
                                   unmoved/self%rules%toughness, wants)
               exit
            end if
            call begin_pieces(self, wants, timers, error)
            if (allocated(error)) exit
            ! Not those that have come to something already: nothing lies between.
            has_begun = has_begun .or. (wants .and. .not. self%segment%stays())
            lesson = lesson_t()  ! of other pieces
         end if
         self%state = self%before
      end do
      trial%goes_too_far = trial%goes_too_far .or. k > most
      if (allocated(self%asked)) deallocate (self%asked)
      ! The cells that segments were begun with stay, closed, for the next try.
      self%state = self%before
      self%tip = tip
      self%segment = segment
      self%network = network
      self%values_are_current = .false.
      if (allocated(error) .or. .not. trial%needs_windows) return
      ! Onsets are looked for from what tips had before the step, and errors known from there; on a
      ! mesh that the step has made that state has no tractions.
      self%undrained = was_undrained
      if (.not. allocated(self%state%tractions)) return
      call self%evaluate(timers, error)
      if (.not. allocated(error)) call estimate_coarse_errors(self, timers, error)
   end subroutine find_equilibrium

   !> Tips that may grow in a step, as its first try shows: those that are on their way or not far
   !! from their toughness, known as well as that is.
   pure function are_asked(self) result(asked)
      class(two_levels_t), intent(in) :: self
      logical :: asked(size(self%tip))

      associate (k => self%tip%intensity)
         asked = self%segment%is_open .or. self%tip%drive%intensity &
                 + max(k%k1_error, k%k2_error) > far*self%rules%toughness
      end associate
   end function are_asked

   !> Evaluate the tips that the tries of a step have not asked for. From now on all are asked.
   subroutine ask_others(self, any_exceeds, timers, error)
      class(two_levels_t), intent(inout) :: self
      logical, intent(out) :: any_exceeds  !< its toughness
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      logical :: others(size(self%tip))

      any_exceeds = .false.
      if (.not. allocated(self%asked)) return
      others = .not. self%asked .and. self%tip%is_free
      self%asked = others
      if (any(others)) call self%evaluate(timers, error)
      deallocate (self%asked)
      if (.not. allocated(error)) any_exceeds = any(others .and. excesses(self) > tolerance)
   end subroutine ask_others

   !> The tried state is accepted.
   subroutine accept_equilibrium(self)
      class(two_levels_t), intent(inout) :: self

      self%tip%advance = advances(self)
      where (self%segment%accepted > 0.0_rk) self%tip%kink = 0.0_rk  ! they went straight on
      self%segment%gain = self%segment%gain + self%tip%advance
      call self%company%accept(self%tip%drive%intensity/self%rules%toughness, self%tip%advance, &
                               self%rules%increment)
      call self%segment%accept()
   end subroutine accept_equilibrium

   !> Share of the step after which the first tip that has not grown before begins to, as tried [-].
   pure real(rk) function first_onset(self, before)
      class(two_levels_t), intent(in) :: self
      real(rk), intent(in) :: before(:)  !< K_eq of the tips at the start of the step [Pa m^1/2]

      first_onset = onset(before/self%rules%toughness, &
                          self%tip%drive%intensity/self%rules%toughness, &
                          .not. (self%tip%arrested .or. self%segment%gain > 0.0_rk))
   end function first_onset

   !> Share of the step after which the first tip that counts reaches the toughness; 1 where none
   !! begins to grow, or where it does so at the end of the step.
   pure function onset(before, after, counts)
      real(rk), intent(in) :: before(:), after(:)  !< K_eq/K_IC of the tips [-]
      logical, intent(in) :: counts(:)
      real(rk) :: onset
      integer :: i

      onset = 1.0_rk
      do i = 1, size(before)
         if (.not. counts(i) .or. before(i) > 1.0_rk - onset_lack) cycle
         if (after(i) <= 1.0_rk + tolerance) cycle
         onset = min(onset, (1.0_rk - before(i))/(after(i) - before(i)))
      end do
   end function onset

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
      where (self%segment%is_open) wants = wants .and. self%segment%is_complete()
   end subroutine judge_tips

   !> Tips at rest that have gone along with their kind in the step, or want to, but lack their own
   !! toughness: each is a kind of its own from now on, and begins anew where it was. Not those that
   !! were on their way and at their toughness before the step: one mesh may throw them back.
   subroutine part_company(self, before, wants, kind, any_parted)
      class(two_levels_t), intent(inout) :: self
      type(tip_t), intent(in) :: before(:)  !< the tips before the step
      logical, intent(in) :: wants(:)  !< (tips) a new piece
      integer(ik), intent(inout) :: kind(:)  !< of each tip, from 1
      logical, intent(out) :: any_parted
      logical :: lags(size(kind))
      integer(ik) :: i

      associate (segment => self%segment)
         lags = (wants .or. (segment%is_open .and. segment%reached > segment%lowest())) .and. &
                lacks(self%tip) .and. (lacks(before) .or. .not. segment%gain > 0.0_rk)
      end associate
      any_parted = .false.
      do i = 1, size(kind, kind=ik)
         if (.not. lags(i) .or. count(kind == kind(i)) == 1) cycle
         kind(i) = maxval(kind) + 1
         call self%company%part(i)
         if (self%segment(i)%is_open) call self%segment(i)%restart()
         any_parted = .true.
      end do

   contains

      pure elemental logical function lacks(tip)
         type(tip_t), intent(in) :: tip

         associate (k => tip%intensity, toughness => self%rules%toughness)
            lacks = lags_behind(tip%drive%intensity/toughness - 1.0_rk, &
                                max(k%k1_error, k%k2_error)/toughness)
         end associate
      end function lacks

   end subroutine part_company

   !> Of K_eq over K_IC; a tip that another one comes to leaves its own to that [-].
   pure function shared_excesses(self) result(excess)
      class(two_levels_t), intent(in) :: self
      real(rk) :: excess(size(self%tip))
      integer(ik) :: i, j

      excess = excesses(self)
      do j = 1, size(excess, kind=ik)
         do i = 1, size(excess, kind=ik)
            if (.not. comes_to(self, i, j)) cycle
            excess(i) = max(excess(i), excess(j))
            excess(j) = -1.0_rk
            exit
         end do
      end do
   end function shared_excesses

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
      integer(ik) :: i, k

      moves = .false.
      on_way = pack([(i, i=1, size(self%tip, kind=ik))], self%segment%is_open)
      number = numbered(kind(on_way))
      leader = [(on_way(findloc(number, k, dim=1)), k=1, maxval([number, 0_ik]))]
      if (is_coupled) then
         call move_together(self, on_way, number, leader, excess(leader), moves)
      else
         do k = 1, size(leader, kind=ik)
            call self%segment(leader(k))%improve(excess(leader(k)), tolerance, moves(leader(k)))
         end do
      end if
      do k = 1, size(on_way, kind=ik)
         i = leader(number(k))
         if (on_way(k) == i) cycle
         call self%segment(on_way(k))%keep_up_with(self%segment(i))
         moves(on_way(k)) = moves(i)
      end do
   end subroutine move_kinds

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

      associate (segment => self%segment)
         do k = 1, size(leader)
            call segment(leader(k))%learn(excess(k))
         end do
         if (all(segment(leader)%is_at_rest(excess, tolerance))) return
         to = segment(leader)%reached &
              + self%rivals%changes(on_way, number, excess, segment(leader))
         do k = 1, size(leader)
            call segment(leader(k))%go_to(to(k), moves(leader(k)))
         end do
      end associate
   end subroutine move_together

   !> Shares of the step after which tips at the ends of their pieces have probably come there, and
   !! exceed their toughness noticeably: they would have gone on until their excess vanishes [-].
   !! Tips that have nothing left to go along exceed it when their intensity has risen so far.
   pure function arrivals(self, before) result(share)
      class(two_levels_t), intent(in) :: self
      real(rk), intent(in) :: before(:)  !< (tips) K_eq at the start of the step [Pa m^1/2]
      real(rk) :: share(size(self%tip))
      real(rk), dimension(size(self%tip)) :: beyond, room, rise

      room = self%segment%length - self%segment%accepted
      beyond = max(0.0_rk, excesses(self))/abs(self%segment%steep(self%segment%slope))
      share = room/max(room + beyond, tiny(1.0_rk))
      share = share + (1.0_rk - share)*min(1.0_rk, 2.0_rk*tolerance/max(excesses(self), tolerance))
      rise = (self%tip%drive%intensity - before)/self%rules%toughness
      where (self%segment%stays() .and. rise > 0.0_rk)
         share = 1.0_rk - max(0.0_rk, min(1.0_rk, (excesses(self) - 2.0_rk*tolerance)/rise))
      end where
   end function arrivals

   !> Of K_eq over K_IC [-].
   pure function excesses(self) result(excess)
      class(two_levels_t), intent(in) :: self
      real(rk) :: excess(size(self%tip))

      excess = self%tip%drive%intensity/self%rules%toughness - 1.0_rk
   end function excesses

   !> Tips on their way that exceed their toughness, or have advanced in the step.
   pure function tips_in_play(self) result(in_play)
      class(two_levels_t), intent(in) :: self
      logical :: in_play(size(self%tip))

      in_play = self%segment%is_open .and. (excesses(self) > -tolerance .or. &
                                            self%segment%reached > self%segment%lowest())
   end function tips_in_play

end module twolevel_equilibrium
