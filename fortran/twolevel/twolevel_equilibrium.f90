!> Growth as equilibrium (model.md section 5): at the end of a time step each tip has either not
!! advanced and K_eq <= K_IC, or advanced so far that K_eq = K_IC.
!!
!! Within a step the coarse level is solved from the state at the start of the step, with the tips
!! at trial positions. The windows give the intensities, and each tip advances until its excess
!! vanishes. A tip lies anywhere along the last straight segment of its path. The coarse mesh has a
!! cell for the whole segment, and tip springs represent the part of the segment behind the tip
!! (coarse_tips). The coarse mesh therefore changes once per segment, and neither its matrix nor the
!! fluid volume jumps. A segment begins in the direction in which K_II vanishes at its end
!! (growth_tip).
module twolevel_equilibrium
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use coarse_state, only: go_back, step_report_t
   use growth_advances, only: advances_t
   use growth_interaction, only: group_tip_t
   use growth_rules, only: growth_rules_t
   use growth_network, only: fracture_length, total_length
   use growth_segment, only: segment_t
   use growth_targets, only: target_none
   use growth_tip, only: tip_t
   use mesh_types, only: network_t
   use twolevel_coarse_errors, only: estimate_coarse_errors
   use twolevel_heat, only: settle_heat, settlings_max
   use twolevel_levels_state, only: levels_state_t
   use twolevel_search, only: begin_early, begin_wanted, join, search_t, see_overshoot, stop_gained
   use twolevel_segments, only: are_at_ligaments, can_join, shared_excesses
   use twolevel_places, only: advances, place_tips, tip_cell_lengths
   use twolevel_probe, only: evaluated, measure_interaction, previous_try_t
   use twolevel_state, only: two_levels_t
   use twolevel_stepping, only: trial_t
   use twolevel_tip_layers, only: close_tips, find_tip_layers
   use twolevel_moves, only: driven_t, first_onset, is_in_play, judge_tips, keep_together, &
                             separate_tips, tolerance
   use twolevel_refinement, only: again_max, find_refinements
   use twolevel_well_limits, only: share_before_switch
   use twolevel_schedule, only: last_switch
   implicit none(type, external)
   private

   public :: accept_equilibrium, find_equilibrium, punctual

   !> Time error of the first try, over the tolerance, above which a step is rejected before the
   !! tips move [-].
   real(rk), parameter :: much = 4.0_rk

   !> Largest time between the connection of a tip to its target and the end of the step, and
   !! largest step in which a tip may jump, over the time since the wells were switched last [-].
   real(rk), parameter :: punctual = 5.0e-3_rk

   !> A tip whose excess in the first try of a step is below the negative of this, error included,
   !! is evaluated again in the last try only [-].
   real(rk), parameter :: lack_of_far = 0.1_rk

   real(rk), parameter :: sharp = 0.15_rk  !< kinks behind which K_eq falls at once [rad]

contains

   !> Try a step from the last stored state: find the state at its end, and the tip positions in
   !! equilibrium. A step in which a tip would begin more than two new segments goes too far,
   !! unless tips may jump: then the step is so short that the time of the jump within the step does
   !! not matter, or it is the last try, which consists of unstable growth until its arrest. Nothing
   !! is accepted here. A step in which the intensities of a tip that grows, or might grow, are not
   !! accurate enough returns refinements of the windows.
   subroutine find_equilibrium(self, dt, is_last, may_jump, timers, report, trial, error)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      logical, intent(in) :: is_last  !< last try: the time error is not checked; tips may jump
      logical, intent(in) :: may_jump  !< tips may advance by several segments in the step
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(trial_t), intent(out) :: trial
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: tries_max = 25, jump_tries_max = 1000
      logical :: any_moves, wants(size(self%tip))
      type(search_t) :: search
      integer :: k

      call begin_search(self%tip, self%rules, self%start, self%now, dt, is_last, may_jump, search)
      if (allocated(self%step%places)) then
         if (.not. may_jump) call self%now%segment%set_out_to(self%step%places)
         deallocate (self%step%places)
      end if
      search%moment = punctual*(self%before%time - last_switch(self%scene, self%before%time))
      do k = 1, jump_tries_max
         if (k > tries_max .and. .not. search%may_jump) exit
         call find_state(self, search, k == 1, timers, report, trial, error)
         if (search%is_over .or. allocated(error)) return
         call move_tips(self, search, timers, any_moves, wants, error)
         if (allocated(error)) return
         ! A tip that jumps does not wait until others are in equilibrium: it changes that.
         if (.not. any_moves .or. (search%may_jump .and. any(wants))) then
            call go_on(self, search, wants, timers, trial, error)
         else if (any(wants)) then
            call begin_early(self, search, wants, timers, trial, error)
         end if
         if (search%is_over .or. allocated(error)) return
         call go_back(self%now%coarse, self%before)
      end do
      trial%goes_too_far = .true.
   end subroutine find_equilibrium

   !> Put the tips at their predicted positions at the end of the step.
   subroutine begin_search(tips, rules, start, now, dt, is_last, may_jump, search)
      type(tip_t), intent(in) :: tips(:)
      type(growth_rules_t), intent(in) :: rules
      type(network_t), intent(in) :: start  !< before any growth
      type(levels_state_t), intent(inout) :: now
      real(rk), intent(in) :: dt  !< [s]
      logical, intent(in) :: is_last, may_jump
      type(search_t), intent(out) :: search

      search%dt = dt
      search%is_last = is_last
      search%may_jump = may_jump
      allocate (search%kind(size(tips)))
      allocate (search%begun(size(tips)), source=0)
      associate (toughness => rules%toughness, segment => now%segment)
         call now%groups%find_groups(group_tips(tips, rules, start, segment), now%interaction, &
                                     search%kind)
         call segment%restart()
         if (.not. may_jump) then
            call segment%keep_pace(dt)
            call keep_together(now%segment, search%kind)
         end if
      end associate
      call now%stated_errors%begin_step()
   end subroutine begin_search

   !> What decides which tips are equal.
   pure function group_tips(tips, rules, start, segments) result(equal)
      type(tip_t), intent(in) :: tips(:)
      type(growth_rules_t), intent(in) :: rules
      type(network_t), intent(in) :: start  !< before any growth
      type(segment_t), intent(in) :: segments(:)  !< (tips)
      type(group_tip_t) :: equal(size(tips))
      integer :: i

      equal%drive = tips%excess(rules%toughness)
      equal%off = tips%relative_error(rules%toughness)
      equal%gain = segments%gain
      equal%increment = rules%increment_of(tips%fracture)
      equal%segment = merge(min(segments%length, equal%increment), equal%increment, &
                            segments%is_open)
      equal%length = [(fracture_length(start, tips(i)%fracture), i=1, size(tips))]
      equal%is_arrested = tips%arrested
   end function group_tips

   !> Solve the coarse level and evaluate the intensities at the trial positions of the tips.
   subroutine find_state(self, search, is_first, timers, report, trial, error)
      class(two_levels_t), intent(inout) :: self
      type(search_t), intent(inout) :: search
      logical, intent(in) :: is_first  !< first try of the step
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(trial_t), intent(inout) :: trial
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: reached(size(self%tip))

      reached = self%now%segment%reached
      call self%tape%keep("reached", reached)
      self%now%segment%reached = reached
      call place_tips(self%front_state_t, self%now%segment, self%problem)
      call find_tip_layers(self, search%dt, search%may_jump)
      call solve_coarse(self, search%dt, timers, report, error)
      if (allocated(error)) return
      trial%converged = report%converged
      search%is_over = .not. trial%converged
      if (search%is_over) then
         trial%reason = report%reason
         return
      end if
      if (is_first .and. .not. search%is_last) then
         trial%time_error = self%step_error(search%dt)
         search%is_over = self%errs(trial%time_error/much)
         call self%tape%keep("over", search%is_over)
         if (search%is_over) return
      end if
      call self%evaluate(timers, error)
      if (allocated(error)) return
      call close_tips(self)
      call self%now%stated_errors%see_try(total_length(self%network), &
                                          self%problem%well_pressure(self%now%coarse), &
                                          count(self%tip%is_free))
      if (.not. is_first) return
      search%unmoved = self%tip%excess(self%rules%toughness)
      if (.not. (search%is_last .or. self%stepper%has_sudden_onset)) then
         trial%onset = first_onset(self%last%front%tip, self%tip, self%now%segment, &
                                   self%rules%toughness)
      end if
      search%is_over = trial%onset < 1.0_rk
      if (.not. (search%is_over .or. search%is_last .or. search%may_jump)) then
         call see_overshoot(self, search, trial)
      end if
      call self%tape%keep("over", search%is_over)
      if (search%is_over) return
      self%now%active = active_tips(self%tip, self%now%segment, self%rules%toughness, search%kind)
      call self%tape%keep("active", self%now%active)
   end subroutine find_state

   !> Solve the coarse level, and meanwhile, on another thread, mesh the windows of tips that have
   !! moved and factorize their matrices.
   subroutine solve_coarse(self, dt, timers, report, error)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      type(error_t), allocatable :: failure
      logical :: active(size(self%tip))

      ! The loads of sides that change with time are part of a new window.
      if (any(self%problem%model%sides%changes()) .or. &
          .not. self%windows%has_to_mesh(self%tip)) then
         call self%try_step(dt, timers, report, error)
         return
      end if
      active = .true.
      if (allocated(self%now%active)) active = self%now%active
      !$omp parallel
      !$omp master
      !$omp task default(shared)
      call self%windows%prepare(self%scene, self%front_state_t, active, self%problem%mesher, &
                                self%problem%mesh, self%problem%model%cells, self%now%windows, &
                                failure)
      !$omp end task
      call self%try_step(dt, timers, report, error)
      !$omp end master
      !$omp end parallel
      if (.not. allocated(error) .and. allocated(failure)) call move_alloc(failure, error)
   end subroutine solve_coarse

   !> Move the tips to where their excess is predicted to vanish.
   subroutine move_tips(self, search, timers, any_moves, wants, error)
      class(two_levels_t), intent(inout) :: self
      type(search_t), intent(inout) :: search
      type(timers_t), intent(inout) :: timers
      logical, intent(out) :: any_moves  !< a tip has moved, or is to be evaluated again
      logical, intent(out) :: wants(:)  !< (tips) the tip is to begin a new segment
      type(error_t), allocatable, intent(out) :: error
      logical, dimension(size(self%tip)) :: in_play, moves
      type(driven_t) :: driven(size(self%tip))

      in_play = is_in_play(self%now%segment, self%tip%excess(self%rules%toughness))
      call search%previous_try%update_interaction(self%now%segment, self%tip, &
                                                  self%rules%toughness, evaluated(self), &
                                                  self%now%interaction)
      call measure_interaction(self, in_play, search%dt, timers, any_moves, error)
      if (allocated(error)) return
      call search%previous_try%begin(self%now%segment, self%tip, self%rules%toughness)
      if (any_moves) search%advances = advances_t()  ! with the measured tip interaction
      driven%excess = shared_excesses(self%front_state_t, self%now, self%rules)
      driven%error = self%tip%relative_error(self%rules%toughness)
      driven%is_at_ligament = are_at_ligaments(self%front_state_t, self%now, self%rules)
      call judge_tips(self%now%segment, self%now%interaction, driven, search%kind, &
                      search%advances, moves, wants)
      wants = wants .and. .not. self%tip%arrested
      any_moves = any_moves .or. any(moves)
      call self%tape%keep("moves", any_moves)
      call self%tape%keep("wants", wants)
   end subroutine move_tips

   !> Continue when no tip moves within its segment: some tips leave their group, some join their
   !! targets, some begin new segments; else the state is an equilibrium.
   subroutine go_on(self, search, wants, timers, trial, error)
      class(two_levels_t), intent(inout) :: self
      type(search_t), intent(inout) :: search
      logical, intent(inout) :: wants(:)  !< (tips) the tip is to begin a new segment
      type(timers_t), intent(inout) :: timers
      type(trial_t), intent(inout) :: trial
      type(error_t), allocatable, intent(out) :: error
      logical :: any_parted, joins(size(self%tip))

      call separate_tips(self%now%segment, self%now%groups, self%tip, self%last%front%tip, &
                         self%rules%toughness, wants, search%kind, any_parted)
      call self%tape%keep("parted", any_parted)
      if (any_parted) search%advances = advances_t()
      if (any_parted) return
      ! Only now: while other tips still move, they may retreat.
      if (.not. (search%may_jump .or. self%stepper%has_sudden_onset)) then
         trial%onset = first_onset(self%last%front%tip, self%tip, self%now%segment, &
                                   self%rules%toughness)
      end if
      search%is_over = trial%onset < 1.0_rk
      call self%tape%keep("over", search%is_over)
      if (search%is_over) return
      call stop_gained(self, search, wants, trial)
      call self%tape%keep("over", search%is_over)
      if (search%is_over) return
      joins = wants .and. can_join(self%front_state_t, self%now, self%rules)
      wants = wants .and. self%tip%path_target == target_none
      call self%tape%keep("joins", joins)
      call self%tape%keep("wants", wants)
      if (.not. (trial%has_joined .or. trial%jumps)) call search%see_error(self, trial)
      if (any(joins)) then
         call join(self, search, joins, trial)
      else if (any(wants)) then
         call begin_wanted(self, search, wants, timers, trial, error)
      else
         call conclude(self, search, timers, trial, error)
      end if
   end subroutine go_on

   !> End the tries: no tip is to advance. If the tips that have not been evaluated do not exceed
   !! the toughness either, and all intensities are accurate enough, the state is an equilibrium.
   subroutine conclude(self, search, timers, trial, error)
      class(two_levels_t), intent(inout) :: self
      type(search_t), intent(inout) :: search
      type(timers_t), intent(inout) :: timers
      type(trial_t), intent(inout) :: trial
      type(error_t), allocatable, intent(out) :: error
      logical :: any_exceeds, is_settled

      call evaluate_others(self, any_exceeds, timers, error)
      if (allocated(error) .or. any_exceeds) return
      call settle_heat(self%scene, self%before, self%now%coarse, self%problem, self%now%heat, &
                       is_settled, error)
      if (allocated(error)) return
      if (.not. is_settled .and. search%settlings < settlings_max) then
         search%settlings = search%settlings + 1
         search%previous_try = previous_try_t()
         search%advances = advances_t()
         return
      end if
      search%is_over = .true.
      trial%advance = maxval([0.0_rk, advances(self%front_state_t, self%start, self%now%segment, &
                                               self%increments())/paces(self)])
      call self%pace%see_end(self%tape, self%tip%excess(self%rules%toughness), &
                             self%last%front%tip%excess(self%rules%toughness), &
                             self%tip%drive%angle, &
                             advances(self%front_state_t, self%start, self%now%segment, &
                                      self%increments()), self%tip%is_loaded(), &
                             trial%jumps .or. search%may_jump)
      if (.not. (search%is_last .or. self%tape%follows)) then
         if (self%errs(trial%time_error)) return
         call share_before_switch(self, search%dt, punctual, trial%switch, timers, error)
         if (allocated(error) .or. trial%switch < 1.0_rk) return
      end if
      call estimate_coarse_errors(self, timers, error)
      if (allocated(error) .or. self%tape%follows) return
      if (self%step%refined == again_max) return
      call find_refinements(self, self%before%time, trial%refinements)
   end subroutine conclude

   !> The advance of each tip that counts as one in a step: its segment, or where viscosity matters
   !! a part of its cell (docs/theory.md) [m].
   pure function paces(self)
      class(two_levels_t), intent(in) :: self
      real(rk) :: paces(size(self%tip))
      real(rk), parameter :: part = 0.175_rk

      associate (length => self%now%segment%length, increment => self%increments())
         paces = merge(min(length, increment), increment, length > 0.0_rk)
      end associate
      where (self%tip%has_viscous_layer() .and. self%tip%is_free) &
         paces = min(paces, part*tip_cell_lengths(self%tip, self%problem))
   end function paces

   !> Tips that may grow in a step, according to its first try: tips that have been placed ahead of
   !! their last accepted position, tips that are near their toughness within the error of their
   !! intensities, and the other tips of their groups.
   pure function active_tips(tips, segments, toughness, kind) result(active)
      type(tip_t), intent(in) :: tips(:)
      type(segment_t), intent(in) :: segments(:)  !< (tips)
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      integer(ik), intent(in) :: kind(:)  !< (tips) number of the group, from 1
      logical :: active(size(tips))
      integer(ik) :: i

      active = (segments%is_open .and. segments%reached > segments%lowest()) .or. &
               tips%excess(toughness) + tips%relative_error(toughness) > -lack_of_far
      active = [(any(active .and. kind == kind(i)), i=1, size(kind))]
   end function active_tips

   !> Evaluate the tips that the tries of a step have left out. All tips are evaluated from now on.
   subroutine evaluate_others(self, any_exceeds, timers, error)
      class(two_levels_t), intent(inout) :: self
      logical, intent(out) :: any_exceeds  !< one of these tips exceeds its toughness
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      logical :: others(size(self%tip))

      any_exceeds = .false.
      if (.not. allocated(self%now%active)) return
      others = .not. self%now%active .and. self%tip%is_free
      self%now%active = others
      if (any(others)) call self%evaluate(timers, error)
      deallocate (self%now%active)
      if (allocated(error)) return
      any_exceeds = any(others .and. self%tip%excess(self%rules%toughness) > tolerance)
      call self%tape%keep("exceeds", any_exceeds)
   end subroutine evaluate_others

   !> Accept the tried state.
   subroutine accept_equilibrium(self, dt)
      class(two_levels_t), intent(inout) :: self
      !> length of the step; 0: the speeds of the tips do not apply to the next step [s]
      real(rk), intent(in) :: dt

      self%tip%advance = advances(self%front_state_t, self%start, self%now%segment, &
                                  self%increments())
      where (self%now%segment%accepted > 0.0_rk) self%tip%kink = 0.0_rk  ! straight segments
      ! Behind a sharp kink a path begins by a jump: its length says nothing of the next step.
      associate (segment => self%now%segment)
         call segment%pace(self%tip%advance, dt, &
                           (self%tip%excess(self%rules%toughness) >= -tolerance .or. &
                            segment%reached > segment%lowest()) .and. abs(self%tip%kink) < sharp)
      end associate
      self%now%segment%gain = self%now%segment%gain + self%tip%advance
      call self%now%groups%accept(self%tip%excess(self%rules%toughness), &
                                  self%tip%advance, self%increments())
      call self%now%segment%accept()
   end subroutine accept_equilibrium

end module twolevel_equilibrium
