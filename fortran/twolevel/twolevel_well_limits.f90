!> Times at which wells reach or leave the pressure that limits their rate; steps end at these
!! times.
!!
!! Within a step such a well flows at its rate, or at the rate that its pressure limit allows,
!! whichever is less (coarse_well_flow). A step in which this changes is tried once more with the
!! previous control of the well: the share of the step at which the control changes then follows
!! from the quantity that passes its limit.
module twolevel_well_limits
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_number, only: brief_text, integer_text
   use base_timers, only: timers_t
   use base_tolerances, only: same_time
   use coarse_state, only: go_back, state_t, step_report_t
   use coarse_wells, only: control_limited, control_pressure, control_rate, wells_t
   use report_rows, only: event_well
   use scene_types, only: injection_t
   use twolevel_state, only: two_levels_t
   use twolevel_schedule, only: last_switch
   implicit none(type, external)
   private

   public :: note_wells, share_before_switch

   !> Share of a step at its start or end within which a switch needs no cut of the step [-].
   real(rk), parameter :: negligible = 0.01_rk

contains

   !> (controlled wells) Whether each well is limited by its pressure in the present state.
   pure function are_at_limit(wells, now) result(at_limit)
      type(wells_t), intent(in) :: wells
      type(state_t), intent(in) :: now
      logical :: at_limit(wells%n_all)
      integer(ik) :: w

      at_limit = [(wells%is_at_limit(w, now%well_rate(w), now%well_head(w)), w=1, wells%n_all)]
   end function are_at_limit

   !> (controlled wells) Whether each well was limited before a step of length dt; none at the start
   !! of a stage.
   pure function were_at_limit(injections, wells, at_limit, time, dt) result(were)
      type(injection_t), intent(in) :: injections(:)
      type(wells_t), intent(in) :: wells
      logical, intent(in) :: at_limit(:)  !< (controlled wells) before the step
      real(rk), intent(in) :: time  !< start of the step [s]
      real(rk), intent(in) :: dt  !< [s]
      logical :: were(wells%n_all)
      integer(ik) :: w

      associate (number => wells%number)
         were = [(at_limit(w) .and. injections(number(w))%stage_at(time + 0.5_rk*dt) &
                  == injections(number(w))%stage_at(time*(1.0_rk - same_time)), w=1, size(were))]
      end associate
   end function were_at_limit

   !> Share of a tried step after which the first well reaches or leaves its limit; 1 if none does,
   !! or if this is near an end of the step, or the step is short compared with the time since the
   !! wells were switched.
   subroutine share_before_switch(self, dt, punctual, share, timers, error)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: punctual  !< share of the time since the last switch [-]
      real(rk), intent(out) :: share  !< [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      logical, dimension(self%problem%model%wells%n_all) :: changes, were
      real(rk) :: later
      integer(ik) :: w

      share = 1.0_rk
      if (size(changes) == 0) return
      were = were_at_limit(self%scene%injections, self%problem%model%wells, self%now%at_limit, &
                           self%before%time, dt)
      changes = are_at_limit(self%problem%model%wells, self%now%coarse) .neqv. were
      changes = changes .and. self%problem%model%wells%control == control_limited
      do w = 1, size(changes, kind=ik)
         if (.not. changes(w)) cycle
         call find_share(self, w, were(w), dt, later, timers, error)
         if (allocated(error)) return
         share = min(share, later)
      end do
      if (share < negligible .or. share > 1.0_rk - negligible .or. (1.0_rk - share)*dt <= &
          punctual*(self%before%time - last_switch(self%scene, self%before%time))) share = 1.0_rk
   end subroutine share_before_switch

   !> Report the wells after an accepted step of length dt: stages that have begun, and limits that
   !! wells have reached or left in the step.
   subroutine note_wells(self, dt, any_changed)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      logical, intent(out) :: any_changed  !< a well has reached or left a limit
      logical :: at_limit(self%problem%model%wells%n_all)
      character(len=:), allocatable :: words
      integer(ik) :: stage, stage_before, w

      do w = 1, size(self%scene%injections, kind=ik)
         associate (well => self%scene%injections(w))
            stage = well%stage_at(self%now%coarse%time - 0.5_rk*dt)
            stage_before = 0
            associate (before => self%before%time)
               if (before > 0.0_rk) stage_before = well%stage_at(before*(1.0_rk - same_time))
               if (stage == stage_before .or. (stage == 1 .and. .not. before > 0.0_rk)) cycle
               call self%chronicle%add_event(before, event_well, what_begins(well, stage))
            end associate
            if (self%problem%model%wells%n_all == 0) cycle
            where (self%problem%model%wells%number == w) self%now%at_limit = .false.
            where (self%problem%model%wells%flow_number() == w) self%now%given = 0.0_rk
         end associate
      end do
      any_changed = .false.
      if (self%problem%model%wells%n_all == 0) return
      at_limit = are_at_limit(self%problem%model%wells, self%now%coarse)
      do w = 1, size(at_limit, kind=ik)
         if (at_limit(w) .eqv. self%now%at_limit(w)) cycle
         any_changed = .true.
         associate (wells => self%problem%model%wells)
            where (wells%flow_number() == wells%number(w)) self%now%given = 0.0_rk
         end associate
         words = " has returned to its rate"
         if (at_limit(w)) words = " has reached its pressure limit"
         associate (well => self%scene%injections(self%problem%model%wells%number(w)))
            call self%chronicle%add_event(self%now%coarse%time, event_well, trim(well%name)//words)
         end associate
      end do
      self%now%at_limit = at_limit
   end subroutine note_wells

   !> Description of a stage of a well, as text.
   pure function what_begins(well, stage) result(words)
      type(injection_t), intent(in) :: well
      integer(ik), intent(in) :: stage  !< 0: the well is shut
      character(len=:), allocatable :: words

      words = trim(well%name)//" is shut"
      if (stage == 0) return
      words = trim(well%name)//" begins stage "//integer_text(stage)//":"
      if (allocated(well%rate)) words = words//" "//brief_text(well%rate(stage), 4)//" m2/s"
      if (allocated(well%rate) .and. allocated(well%pressure)) words = words//" up to"
      if (allocated(well%pressure)) words = words//" "//brief_text(well%pressure(stage), 4)//" Pa"
   end function what_begins

   !> Find the share of the step after which the control of a well changes: try the step with the
   !! previous control, on a copy of the state.
   subroutine find_share(self, w, was_at_limit, dt, share, timers, error)
      class(two_levels_t), intent(inout) :: self
      integer(ik), intent(in) :: w  !< controlled well
      logical, intent(in) :: was_at_limit
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(out) :: share  !< [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(state_t) :: held
      integer(ik) :: control(self%problem%model%wells%n_all)
      type(step_report_t) :: report

      share = 0.0_rk
      if (.not. was_at_limit .and. is_beyond(self%problem%model%wells, self%before, w)) return
      held = self%now%coarse
      control = 0
      control(w) = merge(control_pressure, control_rate, was_at_limit)
      associate (before => self%before, problem => self%problem, wells => self%problem%model%wells)
         call go_back(held, before)
         call problem%advance(self%scene, dt, held, timers, report, error, &
                              control=control)
         share = 0.5_rk
         if (.not. allocated(error) .and. report%converged) then
            if (was_at_limit) then
               share = part(before%well_rate(w), wells%rate(w), held%well_rate(w))
            else
               share = part(head_at_rate(wells, before, w), wells%pressure(w), held%well_head(w))
               ! Right after a switch pressures rise with the square root of time.
               if (.not. before%time > last_switch(self%scene, before%time)) share = share**2
            end if
         end if
         call problem%ask(self%scene, before%time, dt)
      end associate
   end subroutine find_share

   !> Whether a well that begins to flow at its rate is at its limit at once, or beyond it.
   pure logical function is_beyond(wells, before, w)
      type(wells_t), intent(in) :: wells
      type(state_t), intent(in) :: before
      integer(ik), intent(in) :: w  !< controlled well

      is_beyond = wells%is_at_limit(w, 0.0_rk, head_at_rate(wells, before, w))
   end function is_beyond

   !> Head pressure of a well that has just begun to flow at its rate: the losses act at once,
   !! unless the storage of the well takes the fluid [Pa].
   pure real(rk) function head_at_rate(wells, before, w) result(head)
      type(wells_t), intent(in) :: wells
      type(state_t), intent(in) :: before
      integer(ik), intent(in) :: w  !< controlled well

      head = before%well_head(w)
      if (wells%storage(w) > 0.0_rk) return
      head = head - wells%resistance(w, before%well_flow(w))*before%well_flow(w) &
             + wells%resistance(w, wells%rate(w))*wells%rate(w)
   end function head_at_rate

   !> Share of a change from one value to another at which a bound is passed [-].
   pure real(rk) function part(from, bound, to)
      real(rk), intent(in) :: from, bound, to  !< [the same unit]

      part = 1.0_rk
      if (abs(to - from) > 0.0_rk) part = min(1.0_rk, max(0.0_rk, (bound - from)/(to - from)))
   end function part

end module twolevel_well_limits
