!> What ends the tries of a step, and what goes on at the ends of path segments (model.md section
!! 5): tips join their targets, stop at their gain, or begin new segments, unless the step goes too
!! far.
module twolevel_search
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use growth_advances, only: advances_t
   use growth_targets, only: target_none
   use twolevel_moves, only: arrivals, at_joints, excess_max, keep_together, onset, overshoots, &
                             set_out, tolerance
   use twolevel_places, only: advances
   use twolevel_probe, only: previous_try_t
   use twolevel_refinement, only: again_max, find_refinements, is_uncertain
   use twolevel_segments, only: begin_segments, join_targets
   use twolevel_state, only: two_levels_t
   use twolevel_stepping, only: trial_t
   implicit none(type, external)
   private

   public :: begin_early, begin_wanted, join, search_t, see_overshoot, stop_gained

   !> New segments that a tip may begin in a step without a jump. The step control aims at one and a
   !! half at most; a step that is a little longer need not be tried again.
   integer, parameter :: segments_max = 2

   !> State of the tries of a step.
   type :: search_t
      real(rk) :: dt = 0.0_rk  !< [s]
      real(rk) :: moment = 0.0_rk  !< step within which the time of a jump does not matter [s]
      logical :: is_last = .false.  !< last try: the time error is not checked
      logical :: may_jump = .false.  !< tips may advance by several segments in the step
      ! Data of the tries
      real(rk), allocatable :: unmoved(:)  !< (tips) excess in the first try [-]
      integer(ik), allocatable :: kind(:)  !< (tips) number of the tip group, from 1
      integer, allocatable :: begun(:)  !< (tips) number of new segments that the tip has begun
      type(previous_try_t) :: previous_try
      type(advances_t) :: advances  !< search for the positions of the tips on their segments
      integer :: settlings = 0  !< tries with the flows of the last one, which moved other heat
      logical :: is_over = .false.  !< the tries have ended
   contains
      procedure :: see_error
   end type search_t

contains

   !> Time error of the step with the present growth. Where the time of a jump within the step does
   !! not matter, that of the first try remains, which has the growth that was expected.
   subroutine see_error(self, levels, trial)
      class(search_t), intent(in) :: self
      class(two_levels_t), intent(in) :: levels
      type(trial_t), intent(inout) :: trial

      if (self%dt <= self%moment) return
      trial%time_error = levels%step_error(self%dt)
   end subroutine see_error

   !> End the tries after the first one, where a tip would have to begin a segment but exceeds its
   !! toughness by so much that the growth of the others cannot change it: the step goes too far.
   subroutine see_overshoot(self, search, trial)
      class(two_levels_t), intent(in) :: self
      type(search_t), intent(inout) :: search
      type(trial_t), intent(inout) :: trial
      real(rk), parameter :: by_far = 2.0_rk*excess_max
      logical :: far(size(self%tip))

      far = self%tip%is_loaded() .and. search%unmoved > by_far .and. &
            .not. (self%now%segment%is_open .or. self%tip%arrested) .and. &
            is_on_way(self) .and. are_beyond(self)
      search%is_over = any(far)
      if (search%is_over) call reject_overshoot(self, search, far, trial)
   end subroutine see_overshoot

   !> Whether each tip goes on where its segment ends: not to a target, not at its gain, and its
   !! excess says how far.
   pure function is_on_way(self)
      class(two_levels_t), intent(in) :: self
      logical :: is_on_way(size(self%tip))

      is_on_way = self%tip%path_target == target_none .and. &
                  .not. (self%now%segment%stays() .or. self%has_gained() .or. self%tip%is_viscous())
   end function is_on_way

   !> Whether each tip exceeds its toughness by so much that the step goes too far.
   pure function are_beyond(self)
      class(two_levels_t), intent(in) :: self
      logical :: are_beyond(size(self%tip))

      are_beyond = overshoots(self%tip, self%now%segment, self%rules%toughness, self%strides())
   end function are_beyond

   !> Reject a step in which tips go too far, with the share of it in which they would not.
   pure subroutine reject_overshoot(self, search, far, trial)
      class(two_levels_t), intent(in) :: self
      type(search_t), intent(in) :: search
      logical, intent(in) :: far(:)  !< (tips)
      type(trial_t), intent(inout) :: trial
      real(rk), parameter :: aim = 0.75_rk*excess_max, many = 7.5_rk

      trial%goes_too_far = .true.
      associate (before => self%last%front%tip%excess(self%rules%toughness), &
                 after => search%unmoved)
         trial%was_beyond = any(far .and. before > excess_max)
         ! Onset at the time when the tips reach the toughness, not at the start of the step.
         trial%onset = onset(before, after, far)
         trial%admissible = minval([1.0_rk, pack((aim - before)/(after - before), &
                                                 far .and. after > aim .and. before < aim)])
         ! Growth that raises K_eq, or by which it falls so slowly that it would go on for more than
         ! `many` segments, is a jump, in a step of any length.
         if (any(far .and. search%begun > 0 .and. self%tip%excess(self%rules%toughness) &
                 > after*(1.0_rk - search%begun/many))) then
            trial%admissible = min(trial%admissible, search%moment/search%dt)
         end if
      end associate
   end subroutine reject_overshoot

   !> Begin new segments while other tips move, where tips exceed their toughness by so much that
   !! the others will not change it, or end the tries where a tip begins to grow within the step, or
   !! the step goes too far, in any case.
   subroutine begin_early(self, search, wants, timers, trial, error)
      class(two_levels_t), intent(inout) :: self
      type(search_t), intent(inout) :: search
      logical, intent(in) :: wants(:)  !< (tips) the tip is to begin a new segment
      type(timers_t), intent(inout) :: timers
      type(trial_t), intent(inout) :: trial
      type(error_t), allocatable, intent(out) :: error
      real(rk), parameter :: by_much = 10.0_rk*tolerance, by_far = 2.0_rk*excess_max
      logical, dimension(size(wants)) :: begins, far
      integer(ik) :: i

      associate (excess => self%tip%excess(self%rules%toughness))
         begins = wants .and. excess > by_much .and. is_on_way(self)
         far = begins .and. are_beyond(self)
         begins = begins .and. search%begun < segments_max .and. (excess > by_far .or. .not. far)
         if (.not. (search%may_jump .or. self%stepper%has_sudden_onset)) then
            trial%onset = onset(self%last%front%tip%excess(self%rules%toughness), excess, &
                                begins .and. excess > by_far .and. &
                                .not. self%now%segment%gain > 0.0_rk)
         end if
      end associate
      search%is_over = trial%onset < 1.0_rk
      call self%tape%keep("over", search%is_over)
      if (search%is_over) return
      begins = [(all(begins .or. search%kind /= search%kind(i)), i=1, size(wants))]
      call self%tape%keep("early", begins)
      if (.not. any(begins)) return
      call search%see_error(self, trial)
      call begin_wanted(self, search, begins, timers, trial, error)
   end subroutine begin_early

   !> Stop tips that have grown by the prescribed gain, unless they reach it too early in the step:
   !! then K_eq would exceed the toughness by more than the tolerance, and the step is cut to the
   !! time at which the excess vanishes. Where tips may jump, linear interpolation does not give
   !! this time: the step is halved, until the last try.
   subroutine stop_gained(self, search, wants, trial)
      class(two_levels_t), intent(inout) :: self
      type(search_t), intent(inout) :: search
      logical, intent(inout) :: wants(:)  !< (tips) the tip is to begin a new segment
      type(trial_t), intent(inout) :: trial
      logical :: stops(size(wants))

      stops = wants .and. self%has_gained()
      if (.not. any(stops)) return
      wants = wants .and. .not. stops
      trial%goes_too_far = any(stops .and. search%begun > 0) .and. .not. search%may_jump
      stops = stops .and. self%tip%excess(self%rules%toughness) > tolerance &
              .and. .not. search%is_last
      trial%gains_all = any(stops)
      if (trial%gains_all .and. search%may_jump) then
         trial%arrival = 0.5_rk
      else if (trial%gains_all) then
         trial%arrival = minval(arrivals(self%last%front%tip, self%tip, self%now%segment, &
                                         self%rules%toughness, 0.0_rk), mask=stops)
         trial%beyond = excess_beyond(self, stops, tolerance)
      end if
      trial%is_late = trial%gains_all
      search%is_over = trial%goes_too_far .or. trial%is_late
   end subroutine stop_gained

   !> Largest excess of these tips at their targets, beyond half of what is allowed [-].
   pure real(rk) function excess_beyond(self, tips, allowed)
      class(two_levels_t), intent(in) :: self
      logical, intent(in) :: tips(:)
      real(rk), intent(in) :: allowed  !< [-]

      excess_beyond = maxval(self%tip%excess(self%rules%toughness), mask=tips) - 0.5_rk*allowed
   end function excess_beyond

   !> Connect tips to their targets, unless they reach them too early in the step. The time error is
   !! that up to the connection, which is a jump.
   subroutine join(self, search, joins, trial)
      class(two_levels_t), intent(inout) :: self
      type(search_t), intent(inout) :: search
      logical, intent(in) :: joins(:)  !< (tips)
      type(trial_t), intent(inout) :: trial

      if (.not. search%may_jump) then
         trial%goes_too_far = any(joins .and. search%begun > 0)
         trial%arrival = minval(arrivals(self%last%front%tip, self%tip, self%now%segment, &
                                         self%rules%toughness, at_joints), mask=joins)
         trial%beyond = excess_beyond(self, joins, at_joints)
         trial%moment = search%moment
         trial%is_late = (1.0_rk - trial%arrival)*search%dt > trial%moment
         search%is_over = trial%goes_too_far .or. trial%is_late .or. self%errs(trial%time_error)
         call self%tape%keep("over", search%is_over)
         if (search%is_over) return
      end if
      call self%pace%see_joints(self%tape, self%tip%excess(self%rules%toughness), joins)
      call join_targets(self%front_state_t, self%now, self%rules, joins)
      trial%has_joined = .true.
      search%previous_try = previous_try_t()
      search%advances = advances_t()
   end subroutine join

   !> Begin new segments, unless the step goes too far, or the intensities are not accurate enough.
   subroutine begin_wanted(self, search, wants, timers, trial, error)
      class(two_levels_t), intent(inout) :: self
      type(search_t), intent(inout) :: search
      logical, intent(in) :: wants(:)  !< (tips)
      type(timers_t), intent(inout) :: timers
      type(trial_t), intent(inout) :: trial
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: beyond(size(self%tip)), excess(size(self%tip))
      integer(ik) :: i

      beyond = self%now%segment%farther(search%dt, advances(self%front_state_t, self%start, &
                                                            self%now%segment, self%increments()))
      associate (toughness => self%rules%toughness, far => are_beyond(self))
         if (self%step%refined < again_max .and. &
             any([(wants(i) .and. is_uncertain(self%tip(i), self%now%segment(i), self%network, &
                                           toughness, self%load_pressure), i=1, size(wants))])) then
            call find_refinements(self, self%before%time, trial%refinements)
            search%is_over = size(trial%refinements) > 0
         end if
         call self%tape%keep("over", search%is_over)
         if (search%is_over) return
         ! A tip that stays at the end of its segment for a part of the step is slower than it will
         ! be: where viscosity decides, its excess says little.
         if (any(wants .and. (search%begun >= segments_max .or. &
                              (far .and. .not. self%tip%is_viscous())))) then
            trial%jumps = .true.
            trial%time_error = 0.0_rk  ! jumps have no rates
            search%may_jump = search%may_jump .or. search%dt <= search%moment
         end if
         call self%tape%keep("jumps", trial%jumps)
         call self%tape%keep("may_jump", search%may_jump)
         ! Windows are refined after a jump, which is long work.
         if (trial%jumps .and. search%may_jump) self%step%refined = again_max
         search%is_over = trial%jumps .and. .not. search%may_jump
         if (search%is_over) then
            call reject_overshoot(self, search, wants, trial)
            return
         end if
      end associate
      excess = self%tip%excess(self%rules%toughness)
      excess = [(maxval(excess, mask=wants .and. search%kind == search%kind(i)), i=1, size(wants))]
      call begin_segments(self, wants, timers, error)
      if (allocated(error)) return
      do i = 1, size(wants)
         if (.not. wants(i)) cycle
         if ((beyond(i) > 0.0_rk .or. self%tip(i)%is_viscous()) .and. .not. search%may_jump) then
            call self%now%segment(i)%set_out_to(beyond(i))
         else
            call set_out(self%now%segment(i), excess(i), search%may_jump, &
                         self%tip(i)%path_target == target_none)
         end if
      end do
      if (.not. search%may_jump) call keep_together(self%now%segment, search%kind)
      ! Without the tips whose whole segment is a ligament.
      where (wants .and. .not. self%now%segment%stays()) search%begun = search%begun + 1
      search%previous_try = previous_try_t()  ! the segments have changed
      search%advances = advances_t()
   end subroutine begin_wanted

end module twolevel_search
