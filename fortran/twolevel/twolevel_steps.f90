!> From one accepted state of both levels to the next: a time step is tried, cut as often as
!! necessary, and accepted.
module twolevel_steps
   use base_errors, only: error_t, raise_error
   use base_kinds, only: rk
   use base_number, only: brief_text
   use base_timers, only: timers_t
   use base_tolerances, only: same_time
   use coarse_state, only: step_report_t
   use report_rows, only: event_step_cut, event_unstable
   use report_limits, only: limit_time_error
   use twolevel_refinement, only: refine_windows
   use twolevel_equilibrium, only: accept_equilibrium, find_equilibrium, punctual
   use twolevel_notes, only: notes_t
   use twolevel_state, only: two_levels_t
   use twolevel_stepping, only: refinement_t, stepper_t, trial_t
   use twolevel_coarse_errors, only: estimate_coarse_errors
   use twolevel_well_limits, only: note_wells, share_before_switch
   use twolevel_schedule, only: last_switch, next_switch
   implicit none(type, external)
   private

   public :: stepping_levels_t

   !> Both levels with the control of the time steps.
   type, abstract, extends(two_levels_t) :: stepping_levels_t
      logical :: is_after_switch = .false.  !< the last step began at a switch of a well
      logical :: ends_at_switch = .false.  !< the last step ended at a switch of a well
      logical :: is_unstable = .false.  !< tips grew without equilibrium in the last step
      real(rk) :: dt = 0.0_rk  !< length of the last step [s]
      type(step_report_t) :: report  !< report of the last step
      type(stepper_t) :: stepper
      character(len=:), allocatable :: why_cut  !< reason of the last cut
      type(notes_t) :: notes  !< event log of growth in equilibrium
   contains
      procedure :: take_step
      procedure :: is_equilibrium
      procedure :: last_state
   end type stepping_levels_t

contains

   !> Whether tips grow in equilibrium; else by the growth law at the ends of steps.
   pure logical function is_equilibrium(self)
      class(stepping_levels_t), intent(in) :: self

      is_equilibrium = self%scene%growth%enabled .and. self%scene%growth%law == "equilibrium"
   end function is_equilibrium

   !> Take one step from the stored state, cut as often as necessary. Growth is unstable where tips
   !! find no equilibrium in a step that is short compared with the time since the wells were
   !! switched, or in the shortest step, whose time error is not checked: then the step consists of
   !! this growth alone, until its arrest.
   subroutine take_step(self, timers, error)
      class(stepping_levels_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(trial_t) :: trial
      logical :: is_last, is_too_short, is_unstable, may_jump
      real(rk) :: wanted

      if (self%stepper%is_stuck()) then
         call raise_error(error, "", "no progress in time: hundreds of steps were cut to about "// &
                          brief_text(self%dt, 4)//" s, the last because "//self%why_cut)
         return
      end if
      associate (time => self%now%coarse%time)
         self%dt = self%stepper%step_to(next_switch(self%scene, time) - time)
      end associate
      wanted = self%dt
      self%is_after_switch = self%ends_at_switch
      is_too_short = .false.
      is_last = .false.
      is_unstable = .false.
      may_jump = self%stepper%expects_jump() .and. is_moment(self)
      do
         call try_length(self, is_last, may_jump, trial, timers, error)
         if (allocated(error)) return
         if (trial%needs_windows()) then
            call try_better_windows(self, trial%refinements, timers, error)
            if (allocated(error)) return
            cycle
         end if
         if (self%stepper%takes(trial) .or. (is_last .and. solves(trial))) exit
         if (is_last .or. (is_too_short .and. .not. trial%converged)) then
            call raise_error(error, "", trial%why_cut()//", even with a time step of " &
                             //brief_text(self%dt, 4)//" s"//way_out(trial))
            return
         end if
         call self%put_back()
         is_last = is_too_short
         is_unstable = is_last .and. trial%goes_too_far
         if (.not. is_last) call cut_step(self, trial, is_too_short)
         may_jump = is_last .or. (trial%goes_too_far .and. is_moment(self))
      end do
      is_unstable = is_unstable .or. trial%jumps
      if (self%now%trend%is_known() .and. .not. (self%is_after_switch .or. is_unstable)) then
         call self%watch%see(limit_time_error, trial%time_error, self%last_state())
      end if
      call accept_step(self, trial, is_unstable)
      if (is_unstable .and. .not. self%stepper%tolerance > 0.0_rk) self%stepper%next = wanted
   end subroutine take_step

   !> Advice for the user where the equations are not solved in the shortest step.
   pure function way_out(trial) result(words)
      type(trial_t), intent(in) :: trial
      character(len=:), allocatable :: words

      words = ""
      if (.not. trial%converged) words = &
         ": fluid or sides may act faster; &time smallest_factor allows shorter steps"
   end function way_out

   !> Whether the present step is so short that the time of a jump within it does not matter.
   pure logical function is_moment(self)
      class(stepping_levels_t), intent(in) :: self

      is_moment = self%dt <= moment(self)
   end function is_moment

   !> Length of a step within which the time of a jump does not matter [s].
   pure real(rk) function moment(self)
      class(stepping_levels_t), intent(in) :: self

      associate (time => self%before%time)
         moment = punctual*(time - last_switch(self%scene, time))
      end associate
   end function moment

   !> Whether the equations are solved with the tips in equilibrium, whatever the time error.
   pure logical function solves(trial)
      type(trial_t), intent(in) :: trial

      solves = trial%converged .and. .not. trial%goes_too_far
   end function solves

   !> Refine windows and evaluate the tips again in the state at the start of the step, from which
   !! onsets are interpolated; before the first step this state has no tractions.
   subroutine try_better_windows(self, refinements, timers, error)
      class(stepping_levels_t), intent(inout) :: self
      type(refinement_t), intent(in) :: refinements(:)
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call self%put_back()
      call refine_windows(self, refinements)
      if (allocated(self%now%coarse%tractions)) then
         call self%evaluate(timers, error)
         if (.not. allocated(error)) call estimate_coarse_errors(self, timers, error)
         if (allocated(error)) return
      end if
      call self%remember()
   end subroutine try_better_windows

   !> Try a step of the present length. The last try is accepted if its equations are solved.
   subroutine try_length(self, is_last, may_jump, trial, timers, error)
      class(stepping_levels_t), intent(inout) :: self
      logical, intent(in) :: is_last, may_jump
      type(trial_t), intent(out) :: trial
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      if (self%is_equilibrium()) then
         call find_equilibrium(self, self%dt, is_last, may_jump, timers, self%report, trial, &
                               error)
         return
      end if
      call self%try_step(self%dt, timers, self%report, error)
      if (allocated(error)) return
      trial%converged = self%report%converged
      if (.not. trial%converged) then
         trial%reason = self%report%reason
         return
      end if
      trial%time_error = self%step_error(self%dt)
      if (.not. is_last) then
         call share_before_switch(self, self%dt, punctual, trial%switch, timers, error)
      end if
   end subroutine try_length

   !> Cut a rejected step.
   subroutine cut_step(self, trial, is_too_short)
      class(stepping_levels_t), intent(inout) :: self
      type(trial_t), intent(in) :: trial
      logical, intent(out) :: is_too_short

      call self%stepper%cut(trial, self%dt, is_too_short)
      self%why_cut = trial%why_cut()
      self%summary%step_cuts = self%summary%step_cuts + 1
      self%summary%newton_total = self%summary%newton_total + self%report%iterations
      call self%chronicle%add_event(self%now%coarse%time, event_step_cut, "step cut to " &
                                    //brief_text(self%dt, 4)//" s: "//self%why_cut)
   end subroutine cut_step

   !> Accept a tried step.
   subroutine accept_step(self, trial, is_unstable)
      class(stepping_levels_t), intent(inout) :: self
      type(trial_t), intent(in) :: trial
      logical, intent(in) :: is_unstable

      call note_wells(self, self%dt, self%ends_at_switch)
      self%ends_at_switch = self%ends_at_switch .or. next_switch(self%scene, self%before%time) &
                            <= self%now%coarse%time*(1.0_rk + same_time)
      call self%book_step(self%dt)
      self%is_unstable = is_unstable
      self%tip%advance = 0.0_rk
      if (self%is_equilibrium()) then
         ! The speed of the tips does not apply to the next step if cracks have joined, or without
         ! equilibrium.
         call accept_equilibrium(self, merge(0.0_rk, self%dt, is_unstable .or. trial%has_joined))
         call self%notes%note_competition(self%tip, self%now%interaction, self%increments(), &
                                          self%now%coarse%time, self%chronicle)
      end if
      self%stepper%moment = moment(self)
      call self%stepper%step_done(trial, self%dt)
      call self%now%trend%accept(self%before, self%now%coarse, self%dt)
      ! The rates of a step in which cracks have joined do not apply to the next step.
      if (trial%has_joined) call self%follow_trend(at_rest=.false.)
      if (.not. is_unstable) return
      call self%chronicle%add_event(self%now%coarse%time, event_unstable, "unstable growth of " &
                                    //brief_text(sum(self%tip%advance), 4)//" m in all")
      ! The rates of unstable growth do not apply to the next step.
      call self%follow_trend(at_rest=.false.)
   end subroutine accept_step

   !> Time of the last accepted state, as text.
   pure function last_state(self) result(words)
      class(stepping_levels_t), intent(in) :: self
      character(len=:), allocatable :: words

      words = brief_text(self%now%coarse%time, 6)//" s"
   end function last_state

end module twolevel_steps
