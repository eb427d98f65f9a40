!> From one accepted state of both levels to the next: a time step is tried, cut as often as
!! necessary, and committed (twolevel_commit).
submodule(twolevel_state) twolevel_steps
   use base_errors, only: error_t, raise_error
   use base_kinds, only: rk
   use base_number, only: brief_text
   use base_timers, only: timers_t
   use base_tolerances, only: same_time
   use coarse_state, only: go_back
   use report_rows, only: event_step_cut, event_unstable
   use report_limits, only: limit_time_error
   use twolevel_body_comparison, only: keep_body
   use twolevel_coarse_errors, only: estimate_coarse_errors
   use twolevel_equilibrium, only: accept_equilibrium, find_equilibrium, punctual
   use twolevel_stepping, only: refinement_t, trial_t
   use twolevel_heat, only: settle_heat, settlings_max
   use twolevel_refinement, only: again_max, find_refinements, keep_refinements, refine_windows
   use twolevel_well_limits, only: note_wells, share_before_switch
   use twolevel_schedule, only: last_switch, next_switch
   use twolevel_window_tip, only: window_tip_t
   use twolevel_window_total, only: limit_windows
   implicit none(type, external)

   interface
      !> Make the state that was found the accepted one: sums over the run, limits, and the event
      !! log. An error if a limit stops the run.
      module subroutine commit_step(self, error)
         implicit none(type, external)
         class(two_levels_t), intent(inout) :: self
         type(error_t), allocatable, intent(out) :: error
      end subroutine commit_step

      !> Record how a step is tried, or take it from the record.
      module subroutine keep_try(self, is_last, may_jump)
         implicit none(type, external)
         class(two_levels_t), intent(inout) :: self
         logical, intent(inout) :: is_last, may_jump
      end subroutine keep_try

      !> Find the step that the record has next; where it does not apply, the step is to be found
      !! freely.
      module subroutine replay_step(self, trial, timers, error)
         implicit none(type, external)
         class(two_levels_t), intent(inout) :: self
         type(trial_t), intent(out) :: trial
         type(timers_t), intent(inout) :: timers
         type(error_t), allocatable, intent(out) :: error
      end subroutine replay_step
   end interface

contains

   module procedure next_state
   type(trial_t) :: trial
   real(rk) :: wanted
   logical :: is_first

   is_first = .not. self%has_begun
   self%is_initial = is_first .and. self%scene%initial%fracture_pressure == "equilibrated"
   self%has_begun = .true.
   call self%begin_step()
   call self%tape%begin()
   if (self%scene%growth%enabled) then
      call limit_windows(self, timers, error)
      if (allocated(error)) return
   end if
   if (self%is_initial) then
      call find_initial_state(self, timers, error)
   else
      if (is_first) then
         call self%stimulation%begin(self%problem, self%now%coarse)
         call self%well_results%begin(self%scene, self%problem, self%now%coarse)
         call self%value_errors%begin(self%scene, self%problem, self%now%coarse)
      end if
      call find_step(self, trial, wanted, timers, error)
      if (.not. allocated(error)) call accept_step(self, trial, wanted)
   end if
   if (.not. allocated(error)) call commit_step(self, error)
   if (allocated(error)) call self%put_back()
   end procedure next_state

   !> Find a step from the stored state, from a record or freely.
   subroutine find_step(self, trial, wanted, timers, error)
      class(two_levels_t), intent(inout) :: self
      type(trial_t), intent(out) :: trial  !< of the step
      real(rk), intent(out) :: wanted  !< length of the step before it was cut or shortened [s]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      logical :: is_unstable

      wanted = self%stepper%next
      self%step%is_after_switch = self%step%ends_at_switch
      is_unstable = .false.
      if (self%tape%follows) call replay_step(self, trial, timers, error)
      if (allocated(error)) return
      if (.not. self%tape%follows) call search_step(self, trial, is_unstable, timers, error)
      if (allocated(error)) return
      is_unstable = is_unstable .or. trial%jumps
      call self%tape%keep("is_unstable", is_unstable)
      if (self%now%trend%is_known() .and. .not. (self%step%is_after_switch .or. is_unstable)) then
         call self%watch%see(limit_time_error, trial%time_error, self%last_state())
      end if
      self%step%is_unstable = is_unstable
   end subroutine find_step

   !> Find a step from the stored state, cut as often as necessary. Growth is unstable where tips
   !! find no equilibrium in a step that is short compared with the time since the wells were
   !! switched, or in the shortest step, whose time error is not checked: then the step consists of
   !! this growth alone, until its arrest.
   subroutine search_step(self, trial, is_unstable, timers, error)
      class(two_levels_t), intent(inout) :: self
      type(trial_t), intent(out) :: trial  !< of the step
      logical, intent(out) :: is_unstable
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      logical :: is_last, is_too_short, may_jump

      is_unstable = .false.
      if (self%stepper%is_stuck()) then
         call raise_error(error, "", "no progress in time: hundreds of steps were cut to about "// &
                          brief_text(self%step%dt, 4)//" s, the last because "//self%step%why_cut)
         return
      end if
      associate (left => next_switch(self%scene, self%now%coarse%time) - self%now%coarse%time)
         if (self%stepper%is_slow(left)) then
            call raise_error(error, "", "hardly any progress: "// &
                             brief_text(self%stepper%slow_time, 4)//" s in 500 steps, "// &
                             brief_text(left, 4)//" s to go: flow or contact changes within "// &
                             "shorter times, as where fractures open and close in turn; use a "// &
                             "smaller rate, or a larger tolerance of &time")
            return
         end if
         self%step%dt = self%stepper%step_to(left)
      end associate
      is_too_short = .false.
      is_last = .false.
      may_jump = self%stepper%expects_jump() .and. &
                 self%step%dt <= moment(self%scene, self%before%time)
      if (self%step%refined == again_max) then
         call find_refinements(self, self%before%time, trial%refinements)
         if (trial%needs_windows()) call try_better_windows(self, trial%refinements, timers, error)
         if (allocated(error)) return
      end if
      self%step%refined = 0
      do
         call self%tape%rewind()
         call keep_try(self, is_last, may_jump)
         call try_length(self, is_last, may_jump, trial, timers, error)
         if (allocated(error)) return
         if (trial%needs_windows()) then
            self%step%refined = self%step%refined + 1
            call try_better_windows(self, trial%refinements, timers, error)
            if (allocated(error)) return
            cycle
         end if
         ! The last try is accepted with any time error.
         if (self%stepper%takes(trial) .or. (is_last .and. trial%converged .and. &
                                             .not. trial%goes_too_far)) exit
         if (is_last .or. (is_too_short .and. .not. trial%converged)) then
            call raise_error(error, "", trial%why_cut()//", even with a time step of " &
                             //brief_text(self%step%dt, 4)//" s"//way_out(trial))
            return
         end if
         call self%put_back()
         is_last = is_too_short
         is_unstable = is_last .and. trial%goes_too_far
         if (.not. is_last) call cut_step(self, trial, is_too_short)
         if (is_too_short) then  ! the slower methods are needed at once (coarse_newton)
            call self%now%coarse%guess%forget()
            self%before = self%now%coarse
         end if
         ! In a step so short that the time of a jump within it does not matter.
         may_jump = is_last .or. (trial%goes_too_far .and. &
                                  self%step%dt <= moment(self%scene, self%before%time))
      end do
   end subroutine search_step

   !> Advice for the user where the equations are not solved in the shortest step.
   pure function way_out(trial) result(words)
      type(trial_t), intent(in) :: trial
      character(len=:), allocatable :: words

      words = ""
      if (.not. trial%converged) words = &
         ": fluid or sides may act faster; &time smallest_factor allows shorter steps"
   end function way_out

   !> Length of a step within which the time of a jump does not matter [s].
   pure real(rk) function moment(scene, since)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: since  !< start of the step [s]

      moment = punctual*(since - last_switch(scene, since))
   end function moment

   !> Refine windows and evaluate the tips again in the state at the start of the step, from which
   !! onsets are interpolated; before the first step this state has no tractions.
   subroutine try_better_windows(self, refinements, timers, error)
      class(two_levels_t), intent(inout) :: self
      type(refinement_t), allocatable, intent(inout) :: refinements(:)
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(window_tip_t) :: before(size(self%tip))
      integer :: k

      call self%tape%rewind()
      call keep_refinements(self%tape, refinements)
      call self%tape%mark()
      associate (now => self%now%segment, before => self%last%levels%segment)
         if (all(now%is_open .eqv. before%is_open) .and. &
             .not. any(abs(now%accepted - before%accepted) > 0.0_rk)) then
            self%step%places = now%reached
         end if
      end associate
      call self%put_back()
      before = self%now%windows%tip
      call refine_windows(self, refinements)
      if (allocated(self%now%coarse%tractions)) then
         call self%evaluate(timers, error)
         if (allocated(error)) return
         do k = 1, merge(size(refinements), 0, self%has_reference())
            associate (i => refinements(k)%tip, now => self%now)
               if (refinements(k)%changes_body() .or. .not. self%tip(i)%is_loaded()) cycle
               call keep_body(before(i), now%reference%tip(i), now%windows%tip(i))
            end associate
         end do
         call estimate_coarse_errors(self, timers, error)
         if (allocated(error)) return
      end if
      call self%remember()
   end subroutine try_better_windows

   !> Try a step of the present length. The last try is accepted if its equations are solved.
   subroutine try_length(self, is_last, may_jump, trial, timers, error)
      class(two_levels_t), intent(inout) :: self
      logical, intent(in) :: is_last, may_jump
      type(trial_t), intent(out) :: trial
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      logical :: is_settled
      integer :: k

      if (self%scene%growth%in_equilibrium()) then
     call find_equilibrium(self, self%step%dt, is_last, may_jump, timers, self%step%report, trial, &
                               error)
         return
      end if
      do k = 0, settlings_max
         if (k > 0) call go_back(self%now%coarse, self%before)
         call self%try_step(self%step%dt, timers, self%step%report, error)
         if (allocated(error)) return
         trial%converged = self%step%report%converged
         if (.not. trial%converged) then
            trial%reason = self%step%report%reason
            return
         end if
         call settle_heat(self%scene, self%before, self%now%coarse, self%problem, self%now%heat, &
                          is_settled, error)
         if (allocated(error)) return
         if (is_settled) exit
      end do
      trial%time_error = self%step_error(self%step%dt)
      if (.not. is_last) then
         call share_before_switch(self, self%step%dt, punctual, trial%switch, timers, error)
      end if
   end subroutine try_length

   !> Cut a rejected step.
   subroutine cut_step(self, trial, is_too_short)
      class(two_levels_t), intent(inout) :: self
      type(trial_t), intent(in) :: trial
      logical, intent(out) :: is_too_short

      call self%stepper%cut(trial, self%step%dt, is_too_short)
      self%step%why_cut = trial%why_cut()
      self%summary%step_cuts = self%summary%step_cuts + 1
      self%summary%newton_total = self%summary%newton_total + self%step%report%iterations
      call self%chronicle%add_event(self%now%coarse%time, event_step_cut, "step cut to " &
                                    //brief_text(self%step%dt, 4)//" s: "//self%step%why_cut)
   end subroutine cut_step

   !> Set the state and the control of the next step after a step.
   subroutine accept_step(self, trial, wanted)
      class(two_levels_t), intent(inout) :: self
      type(trial_t), intent(in) :: trial
      real(rk), intent(in) :: wanted  !< length of the step before it was cut or shortened [s]

      call note_wells(self, self%step%dt, self%step%ends_at_switch)
self%step%ends_at_switch = self%step%ends_at_switch .or. next_switch(self%scene, self%before%time) &
                                 <= self%now%coarse%time*(1.0_rk + same_time)
      self%begins_stage = self%step%ends_at_switch
      call self%book_step(self%step%dt)
      self%tip%advance = 0.0_rk
      if (self%scene%growth%in_equilibrium()) then
         ! The speed of the tips does not apply to the next step if cracks have joined, or without
         ! equilibrium.
         call accept_equilibrium(self, merge(0.0_rk, self%step%dt, &
                                             self%step%is_unstable .or. trial%has_joined))
         call self%notes%note_competition(self%tip, self%now%interaction, self%increments(), &
                                          self%now%coarse%time, self%chronicle)
      end if
      self%stepper%moment = moment(self%scene, self%before%time)
      call self%stepper%step_done(trial, self%step%dt)
      if (self%step%is_unstable .and. .not. self%stepper%tolerance > 0.0_rk) then
         self%stepper%next = wanted
      end if
      if (self%step%ends_at_switch) call shorten_for_wells(self)
      ! A step that the end has shortened does not shorten those of a run that goes on.
      if (.not. self%now%coarse%time < self%scene%time%end) self%stepper%next = &
         max(self%stepper%next, wanted)
      call self%now%trend%accept(self%before, self%now%coarse, self%step%dt)
      ! The rates of a step in which cracks have joined do not apply to the next step.
      if (trial%has_joined) call self%follow_trend(at_rest=.false.)
      if (.not. self%step%is_unstable) return
      call self%chronicle%add_event(self%now%coarse%time, event_unstable, "unstable growth of " &
                                    //brief_text(sum(self%tip%advance), 4)//" m in all")
      call note_jumps(self)
      ! The rates of unstable growth do not apply to the next step.
      call self%follow_trend(at_rest=.false.)
   end subroutine accept_step

   !> Begin a stage with a short step where wells lie in the rock: their pressures are not part of
   !! the time error.
   subroutine shorten_for_wells(self)
      class(two_levels_t), intent(inout) :: self
      real(rk), parameter :: share = 1.0e-4_rk  ! of the stage [-]

      if (.not. (allocated(self%now%coarse%rings) .and. self%stepper%tolerance > 0.0_rk)) return
      associate (now => self%now%coarse%time)
         if (.not. now < self%scene%time%end) return
         self%stepper%next = min(self%stepper%next, share*(next_switch(self%scene, now) - now))
      end associate
   end subroutine shorten_for_wells

   !> Report the tips that have advanced without equilibrium.
   subroutine note_jumps(self)
      class(two_levels_t), intent(inout) :: self
      real(rk) :: from(2, size(self%tip)), pressure(2)
      integer :: i

      do i = 1, size(self%tip)
         from(:, i) = self%last%front%tip(i)%xy
      end do
      pressure = [self%problem%well_pressure(self%before), &
                  self%problem%well_pressure(self%now%coarse)]
      call self%notes%jumps%note(self%tip, from, self%rules%toughness, pressure, &
                                 self%now%coarse%time, self%chronicle, self%summary)
   end subroutine note_jumps

   !> Find the state before the first step.
   subroutine find_initial_state(self, timers, error)
      class(two_levels_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call self%equilibrate(timers, self%step%report, error)
      if (allocated(error)) return
      self%step%report%mass_error = 0.0_rk
      call self%follow_trend(at_rest=.true.)
      if (self%step%report%converged) return
      call raise_error(error, "", "no initial equilibrium was found: "//self%step%report%reason// &
                       "; usual causes are fractures that nearly touch (separate or merge "// &
                       "them, or use &initial fracture_pressure = 'undrained') and friction "// &
                       "above 1")
   end subroutine find_initial_state

end submodule twolevel_steps
