!> Make a step the accepted state: what the run keeps of it. `commit_step` is the one place where
!! this happens.
submodule(twolevel_state:twolevel_steps) twolevel_commit
use base_kinds, only: rk
use coarse_rock, only: shear_beside
use mesh_types, only: fracture_mesh_t
use report_rows, only: entry_row_t, history_row_t, well_row_t
use report_limits, only: limit_depth, limit_well_error
use report_slip, only: slip_step_t
use twolevel_field_errors, only: load_errors
use twolevel_heat, only: add_well_temperatures, follow_heat, warn_of_heat
use twolevel_limits, only: watch_levels
use twolevel_notes, only: note_stated_errors, states_errors
use twolevel_place_errors, only: note_entries
use twolevel_places, only: end_at_tips
use twolevel_pressure_errors, only: unresolved_depth
use twolevel_results, only: cell_states, slip_potency
use twolevel_well_rows, only: entry_rows
use twolevel_schedule, only: last_switch
use twolevel_value_errors, only: step_facts_t
implicit none(type, external)

!> Share of the injected fluid that leaks off before layers matter [-].
real(rk), parameter :: leaking = 0.01_rk

contains

!> Make the state that was found the accepted one: sums over the run, limits, and the event log.
   !! An error if a limit stops the run.
module procedure commit_step
type(history_row_t) :: row
real(rk), allocatable :: pressure(:), of_load(:, :)

call book_change(self)
call follow_heat(self%scene, self%before, self%now%coarse, self%problem, self%now%heat, error)
if (allocated(error)) return
self%now%fluid%mass_error = self%now%fluid%mass_error + self%step%report%mass_error
row = self%history()
call watch_levels(self%watch, self%scene, self%problem, self%now%coarse, self%step%report, &
                  self%now%fluid%mass_error, row%mass_error_relative)
call self%heed_limits(error)
if (allocated(error)) return
self%shows_growth = self%now%has_new_mesh
self%now%has_new_mesh = .false.
if (.not. self%is_initial) then
   self%summary%steps = self%summary%steps + 1
   if (.not. (self%owes_state .or. self%scene%growth%in_equilibrium())) then
      pressure = self%problem%fracture_pressure(self%now%coarse)
      call self%stepper%settle(pressure(self%now%grown))
   end if
end if
if (states_errors(self%scene%growth)) then
   allocate (of_load(2, size(self%tip)), source=0.0_rk)
   if (self%scene%growth%enabled .and. .not. self%is_initial) of_load = &
      & load_errors(self%scene, self%problem, self%now%coarse, self%value_errors, self%tip)
   call note_stated_errors(self%scene, self%front_state_t, self%problem, of_load, &
                           self%step%dt, self%now, self%notes)
   self%position_error = self%now%stated_errors%position
end if
if (self%is_initial) call self%value_errors%begin(self%scene, self%problem, self%now%coarse)
call self%value_errors%note_state(self%scene, self%problem, self%now%coarse, row, &
                                  self%now%stated_errors, facts_of(self))
call self%blurred%solve(self%scene, self%problem, self%before, self%now%coarse, &
                        self%step%report, self%shows_growth)
if (self%blurred%is_unsolved) then
   call self%summary%warn("a step with blurred temperatures was not solved: errors after it "// &
                          "lack those by the mean temperatures of cells")
end if
call self%blurred%add_to_row(self%problem, self%before, self%now%coarse, self%value_errors%row)
call note_well_rows(self)
call watch_errors(self)
self%summary%heat = row%heat
if (allocated(self%problem%heat)) then
   call warn_of_heat(self%now%heat, self%summary)
end if
call note_state(self, row%mass_error_relative)
end procedure commit_step

!> What the errors of the last step need to know.
pure type(step_facts_t) function facts_of(self) result(facts)
   class(two_levels_t), intent(in) :: self
   integer :: w

   facts%is_jump = self%step%is_unstable
   facts%is_growing = any(self%tip%advance > 0.0_rk)
   facts%is_first = self%step%is_after_switch
   facts%since_switch = self%now%coarse%time - last_switch(self%scene, self%before%time)
   facts%has_estimate = states_errors(self%scene%growth)
   facts%has_given_rates = size(self%scene%injections) == 0
   do w = 1, size(self%scene%injections)
      associate (well => self%scene%injections(w))
         if (allocated(well%rate)) facts%has_given_rates = .true.
      end associate
   end do
   facts%mass_error = self%now%fluid%mass_error
end function facts_of

!> Check the depth of diffusion against the cells, and at the end of a stage the error of the
   !! pressure of the wells that flow over its largest change.
subroutine watch_errors(self)
   class(two_levels_t), intent(inout) :: self
   integer :: w

   if (self%is_initial) return
   associate (errors => self%value_errors, fluid => self%now%fluid)
      if (abs(fluid%leaked) > leaking*abs(fluid%injected)) then
         associate (facts => facts_of(self))
            call self%watch%see(limit_depth, unresolved_depth(self%problem, &
                                                              facts%since_switch), &
                                self%last_state())
         end associate
      end if
      if (.not. (self%step%ends_at_switch .and. allocated(errors%of_wells))) return
      do w = 1, size(errors%of_wells)
         if (.not. (errors%risen(w) > 0.0_rk .and. errors%flows(w))) cycle
         call self%watch%see(limit_well_error, errors%of_wells(w)/errors%risen(w), &
                             self%last_state())
      end do
   end associate
end subroutine watch_errors

!> Add the last step to the stimulation, the slip catalogue and the seismic moment; the slip of
   !! the initial state is no event.
subroutine book_change(self)
   class(two_levels_t), intent(inout) :: self
   type(fracture_mesh_t) :: fracture
   real(rk), parameter :: rounding = 1.0e-12_rk  ! relative rounding error of slip
   real(rk), allocatable :: potency(:), shear(:)

   if (self%is_initial) then
      call self%stimulation%begin(self%problem, self%now%coarse)
   else
      call self%stimulation%follow(self%start, self%problem%mesh%fracture, self%now%coarse, &
                                   self%scene%output%stimulated_jump, &
                                   self%step%report%compressed, self%step%report%rock_outflow)
   end if
   fracture = self%problem%mesh%fracture
   if (fracture%n_cells == 0) return
   call end_at_tips(self%scene, self%front_state_t, fracture)
   potency = slip_potency(self%problem%model%condensed%length, self%now%coarse)
   ! Cells ahead of a tip are intact rock.
   where (.not. fracture%cell_s(2, :) > fracture%cell_s(1, :)) potency = 0.0_rk
   shear = shear_beside(self%problem%model%rock, self%problem%mesh)
   self%seismic_moment = self%seismic_moment + sum(shear*potency)
   associate (traction => 0.5_rk*sum(self%now%coarse%traction(2, :, :), dim=1), &
              largest => maxval(abs(self%now%coarse%jump(2, :, :))))
      ! Faces at the friction limit that do not move have slip within rounding errors.
      where (potency <= rounding*largest*self%problem%model%condensed%length) potency = 0.0_rk
      if (self%is_initial) then
         call self%catalogue%remember(fracture, traction)
      else
         call self%note_slip(fracture, slip_step_t(self%step%dt, potency, shear, &
                                                   cell_states(self%now%coarse), traction, &
                                                   self%step%is_unstable))
      end if
   end associate
end subroutine book_change

!> Add the rows of the wells.
subroutine note_well_rows(self)
   class(two_levels_t), intent(inout) :: self
   type(entry_row_t), allocatable :: entries(:)
   type(well_row_t), allocatable :: rows(:)

   if (self%is_initial) call self%well_results%begin(self%scene, self%problem, self%now%coarse)
   if (size(self%scene%injections) == 0) return
   call self%well_results%book(self%scene, self%problem, self%now%coarse, self%now%at_limit, &
                               merge(0.0_rk, self%step%dt, self%is_initial), rows)
   call self%value_errors%note_wells(self%scene, self%problem, self%now%coarse, rows, &
                                     self%now%stated_errors, facts_of(self))
   call self%blurred%add_to_wells(self%scene, self%problem, self%before%time, self%now%coarse, &
                                  rows, self%value_errors%row)
   self%value_errors%of_wells = rows%error%pressure
   call add_well_temperatures(self%problem, self%now%heat, self%now%coarse%time, rows)
   self%chronicle%wells = [self%chronicle%wells, rows]
   if (.not. self%scene%has_entries()) return
   entries = entry_rows(self%problem, self%now%coarse)
   call note_entries(self%value_errors, entries, self%now%stated_errors, facts_of(self))
   self%chronicle%entries = [self%chronicle%entries, entries]
end subroutine note_well_rows

!> Update contact events and the extreme values of the run with an accepted state.
subroutine note_state(self, mass_error_relative)
   class(two_levels_t), intent(inout) :: self
   real(rk), intent(in) :: mass_error_relative  !< accumulated error of all steps [-]
   logical :: always(size(self%scene%fractures))
   real(rk) :: lowest

   always = .true.
   associate (summary => self%summary, report => self%step%report)
      summary%contact_residual = max(summary%contact_residual, report%contact_residual)
      summary%condition_estimate = max(summary%condition_estimate, report%condition)
      summary%forward_error_bound = max(summary%forward_error_bound, report%error_bound)
      summary%mass_error_relative = max(summary%mass_error_relative, mass_error_relative)
      lowest = min(minval(self%problem%rock_pressure(self%now%coarse)), &
                   minval(self%problem%fracture_pressure(self%now%coarse)))
      if (lowest < summary%lowest_pressure) then
         summary%lowest_pressure = lowest
         summary%extreme_error(2) = self%value_errors%pressure_error()
      end if
      summary%cells = self%problem%mesh%n_cells
      summary%fracture_cells = self%problem%mesh%fracture%n_cells
      if (any(self%tip%joined)) call summary%use_after_all(meeting, not_meeting)
      call summary%add_newton(report%iterations)
      call self%count_unknowns()
      call self%note_contact(self%problem%mesh%fracture, cell_states(self%now%coarse), always, &
                             always)
   end associate
end subroutine note_state

end submodule twolevel_commit
