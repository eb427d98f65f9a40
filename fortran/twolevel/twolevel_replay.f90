!> Steps that take their decisions from the record of another run (docs/theory.md): how windows are
!! refined, how far tips advance, in which direction path segments begin, which tips join their
!! targets. Pressures and contact are solved, and the length of the step is found (twolevel_pace).
submodule(twolevel_state:twolevel_steps) twolevel_replay
use report_rows, only: event_replay
implicit none(type, external)

contains

module procedure keep_try
type(refinement_t), allocatable :: none(:)
integer(ik) :: cells(3), recorded_cells(3)
real(rk) :: recorded(3), times(3)

allocate (none(0))
call keep_refinements(self%tape, none)
call self%pace%begin_try()
associate (fracture => self%problem%mesh%fracture, time => self%before%time, &
           dt => self%step%dt)
   cells = [self%problem%mesh%n_cells, fracture%n_cells, size(self%tip, kind=ik)]
   call self%tape%compare("cells", cells, recorded_cells)
   if (any(cells /= recorded_cells)) self%pace%why_not = "the mesh is another one"
   times = [time, time - last_switch(self%scene, time), dt]
   call self%tape%compare("times", times, recorded)
end associate
self%pace%since = times(2)
self%pace%recorded_since = recorded(2)
self%pace%recorded = recorded(3)
self%pace%recorded_end = recorded(1) + recorded(3)
call self%tape%keep("is_last", is_last)
call self%tape%keep("may_jump", may_jump)
end procedure keep_try

module procedure replay_step
logical :: ends_at_switch, is_found, is_last, may_jump
real(rk) :: left

if (self%tape%is_at_end()) then
   call leave_record(self, "it ends here")
   return
end if
call replay_refinements(self, timers, error)
if (allocated(error)) return
left = next_switch(self%scene, self%before%time) - self%before%time
self%pace%tries = 0
is_last = .false.
may_jump = .false.
self%step%dt = 0.0_rk
do
   call self%tape%rewind()
   call keep_try(self, is_last, may_jump)
   ends_at_switch = abs(self%pace%recorded_end - self%before%time - left) &
                    <= same_time*self%pace%recorded_end
   if (.not. self%step%dt > 0.0_rk) then
      self%step%dt = self%pace%recorded
      associate (since => self%pace%recorded_since)
         if (since > 0.0_rk) self%step%dt = self%step%dt*(self%pace%since/since)
      end associate
      if (ends_at_switch) self%step%dt = left
      call self%tape%rewind()
      cycle
   end if
   if (.not. (ends_at_switch .or. self%step%dt < left*(1.0_rk - same_time))) then
      self%pace%why_not = "a stage of a well, or the scene, ends before the recorded state"
   end if
   if (.not. allocated(self%pace%why_not)) then
      call try_length(self, is_last, may_jump, trial, timers, error)
      if (allocated(error)) return
   end if
   if (self%tape%fault()) then
      self%pace%why_not = "other tips advance"
   else if (.not. (trial%converged .or. allocated(self%pace%why_not))) then
      self%pace%why_not = trial%why_cut()
   end if
   if (ends_at_switch) self%pace%is_bound = .false.
   call self%pace%improve(self%step%dt, is_found)
   if (allocated(self%pace%why_not) .or. is_found) exit
   call self%put_back()
end do
if (allocated(self%pace%why_not)) call leave_record(self, self%pace%why_not)
end procedure replay_step

!> Refine windows as in the record.
subroutine replay_refinements(self, timers, error)
   class(two_levels_t), intent(inout) :: self
   type(timers_t), intent(inout) :: timers
   type(error_t), allocatable, intent(out) :: error
   type(refinement_t), allocatable :: refinements(:)

   do
      allocate (refinements(0))
      call keep_refinements(self%tape, refinements)
      call self%tape%rewind()
      if (size(refinements) == 0 .or. self%tape%fault()) return
      call try_better_windows(self, refinements, timers, error)
      if (allocated(error)) return
      deallocate (refinements)
   end do
end subroutine replay_refinements

!> Go on freely from the state at the start of the step.
subroutine leave_record(self, why)
   class(two_levels_t), intent(inout) :: self
   character(len=*), intent(in) :: why

   call self%put_back()
   call self%tape%rewind()
   self%tape%follows = .false.
   self%stepper%next = max(self%step%dt, self%pace%recorded)
   call self%chronicle%add_event(self%now%coarse%time, event_replay, "the replay has left "// &
                                 "the record: "//why)
   call self%summary%warn("the replay has left the record after "//self%last_state()//": "//why)
end subroutine leave_record

end submodule twolevel_replay
