!> Simulation of a scene with a fluid: time steps, with growth of the tips in each step.
module twolevel_simulation
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use base_tolerances, only: same_time
   use coarse_rock, only: shear_beside
   use mesh_types, only: fracture_mesh_t, mesh_t, network_t
   use report_rows, only: history_row_t, probe_row_t, well_row_t
   use scene_sizes, only: sizes_text
   use scene_types, only: scene_t
   use report_simulation, only: snapshot_t
   use report_slip, only: slip_step_t
   use twolevel_refinement, only: find_refinements, refine_windows, note_uncertain_tips
   use twolevel_limits, only: watch_levels, watch_mesh, watch_windows
   use twolevel_notes, only: note_stated_errors, note_excess
   use twolevel_results, only: cell_states, count_unknowns, end_at_tips, history_of_levels, &
                               probes_of_levels, slip_potency, snapshot_of_levels
   use twolevel_steps, only: stepping_levels_t
   use twolevel_stepping, only: refinement_t
   use twolevel_stimulation, only: stimulation_t
   use twolevel_coarse_errors, only: estimate_coarse_errors
   use twolevel_well_rows, only: well_results_t
   use twolevel_window_total, only: limit_windows
   implicit none(type, external)
   private

   public :: twolevel_simulation_t

   ! Names of the feature in the log.
   character(len=*), parameter :: meeting = "intersections: flow from fracture to fracture "// &
                                  "or out of the body"
   character(len=*), parameter :: not_meeting = "intersections: fractures do not meet"

   !> Simulation of a scene.
   type, extends(stepping_levels_t) :: twolevel_simulation_t
      logical :: has_begun = .false.  !< the first state has been requested
      logical :: is_initial = .false.  !< the present state is the one before the first step
      type(stimulation_t) :: stimulation
      type(well_results_t) :: well_results
      !> seismic moment of all steps, per metre of thickness [N m]
      real(rk) :: seismic_moment = 0.0_rk
   contains
      procedure :: begin
      procedure :: next_state
      procedure :: grow
      procedure :: present_network
      procedure :: history
      procedure :: probes
      procedure :: snapshot
      procedure :: time
   end type twolevel_simulation_t

contains

   !> Mesh both levels, without load.
   subroutine begin(self, scene, timers, error)
      class(twolevel_simulation_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      self%end_time = scene%time%end
      call self%stepper%begin(scene%time)
      call self%mesh_levels(scene, timers, error)
      if (allocated(error)) return
      call self%catalogue%begin(scene%output%out_of_plane_length, &
                                scene%output%stimulated_jump, scene%output%seismic_slip_rate)
      call self%notes%begin(size(self%tip))
      call watch_mesh(self%watch, self%problem, self%now%coarse%time, error)
      if (.not. allocated(error)) call note_features(self)
   end subroutine begin

   !> Report the features that the scene uses, and those that it does not use.
   subroutine note_features(self)
      class(twolevel_simulation_t), intent(inout) :: self

      associate (scene => self%scene, summary => self%summary)
         call summary%use_feature("poroelastic rock")
         call summary%note(allocated(scene%regions), "regions of other rock", &
                           "regions: uniform rock")
         call summary%note(self%problem%mesh%fracture%n_cells > 0, &
                           "fractures: contact, friction, flow", "no fractures")
         call summary%note(any(scene%fractures%dilation > 0.0_rk), "shear dilation", &
                           "dilation: psi = 0 everywhere")
         call summary%note(size(scene%injections) > 0, "injection", "no injection")
         call summary%note(scene%growth%intensities, "stress intensity factors", &
                           "no windows: intensities off")
         call summary%note(scene%growth%enabled, "growth", "remeshing and transfer: growth off")
         call summary%note(scene%output%vtu, "VTU files", "VTU files: off")
         call summary%note(self%problem%model%drained, "flow across the outer boundary", &
                           "boundary flow: the body is sealed")
         call summary%note(self%problem%model%joints%n > 0, meeting, not_meeting)
         if (allocated(self%problem%model%in_situ)) then
            call summary%use_feature("stress in situ, hydrostatic")
         end if
         if (any(abs(scene%gravity) > 0.0_rk)) call summary%use_feature("gravity")
         if (scene%discretization%chosen) then
            call summary%use_feature("default sizes: "//sizes_text(scene))
         end if
      end associate
   end subroutine note_features

   !> Compute the initial state first, if the scene requires fractures in equilibrium; then one time
   !! step per call. After an error the last accepted state is restored.
   subroutine next_state(self, timers, error)
      class(twolevel_simulation_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(history_row_t) :: row
      real(rk), allocatable :: pressure(:)
      logical :: is_first

      is_first = .not. self%has_begun
      self%is_initial = is_first .and. self%scene%initial%fracture_pressure == "equilibrated"
      self%has_begun = .true.
      if (self%scene%growth%enabled) then
         call limit_windows(self, timers, error)
         if (allocated(error)) return
      end if
      call self%begin_step()
      if (self%is_initial) then
         call find_initial_state(self, timers, error)
      else
         if (is_first) then
            call self%stimulation%begin(self%problem, self%now%coarse)
            call self%well_results%begin(self%scene, self%problem, self%now%coarse)
         end if
         call self%take_step(timers, error)
      end if
      if (.not. allocated(error)) then
         call book_change(self)
         self%now%fluid%mass_error = self%now%fluid%mass_error + self%report%mass_error
         row = self%history()
         call watch_levels(self%watch, self%scene, self%problem, self%now%coarse, self%report, &
                           self%now%fluid%mass_error, row%mass_error_relative)
         call self%heed_limits(error)
      end if
      if (allocated(error)) then
         call self%put_back()
         return
      end if
      self%shows_growth = self%now%has_new_mesh
      self%now%has_new_mesh = .false.
      if (.not. self%is_initial) then
         self%summary%steps = self%summary%steps + 1
         if (.not. (self%owes_state .or. self%is_equilibrium())) then
            pressure = self%problem%fracture_pressure(self%now%coarse)
            call self%stepper%settle(pressure(self%now%grown))
         end if
      end if
      call note_well_rows(self)
      call note_state(self, row%mass_error_relative)
   end subroutine next_state

   !> Add the last step to the stimulation, the slip catalogue and the seismic moment; the slip of
   !! the initial state is no event.
   subroutine book_change(self)
      class(twolevel_simulation_t), intent(inout) :: self
      type(fracture_mesh_t) :: fracture
      real(rk), parameter :: rounding = 1.0e-12_rk  ! relative rounding error of slip
      real(rk), allocatable :: potency(:), shear(:)

      if (self%is_initial) then
         call self%stimulation%begin(self%problem, self%now%coarse)
      else
         call self%stimulation%follow(self, self%report%compressed, self%report%rock_outflow)
      end if
      fracture = self%problem%mesh%fracture
      if (fracture%n_cells == 0) return
      call end_at_tips(self%scene, self%network, self%tip, fracture)
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
            call self%note_slip(fracture, slip_step_t(self%dt, potency, shear, &
                                                      cell_states(self%now%coarse), traction, &
                                                      self%is_unstable))
         end if
      end associate
   end subroutine book_change

   !> Find the state before the first step.
   subroutine find_initial_state(self, timers, error)
      class(twolevel_simulation_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call self%equilibrate(timers, self%report, error)
      if (allocated(error)) return
      self%report%mass_error = 0.0_rk
      call self%follow_trend(at_rest=.true.)
      if (self%report%converged) return
      call raise_error(error, "", "no initial equilibrium was found: "//self%report%reason// &
                       "; usual causes are fractures that nearly touch (separate or merge "// &
                       "them, or use &initial fracture_pressure = 'undrained') and friction "// &
                       "above 1")
   end subroutine find_initial_state

   !> Add the rows of the wells.
   subroutine note_well_rows(self)
      class(twolevel_simulation_t), intent(inout) :: self
      type(well_row_t), allocatable :: rows(:)

      if (size(self%scene%injections) == 0) return
      if (self%is_initial) call self%well_results%begin(self%scene, self%problem, self%now%coarse)
      call self%well_results%book(self%scene, self%problem, self%now%coarse, self%now%at_limit, &
                                  merge(0.0_rk, self%dt, self%is_initial), rows)
      self%chronicle%wells = [self%chronicle%wells, rows]
   end subroutine note_well_rows

   !> Update contact events and the extreme values of the run with an accepted state.
   subroutine note_state(self, mass_error_relative)
      class(twolevel_simulation_t), intent(inout) :: self
      real(rk), intent(in) :: mass_error_relative  !< accumulated error of all steps [-]
      logical :: always(size(self%scene%fractures))

      always = .true.
      associate (summary => self%summary, report => self%report)
         summary%contact_residual = max(summary%contact_residual, report%contact_residual)
         summary%condition_estimate = max(summary%condition_estimate, report%condition)
         summary%forward_error_bound = max(summary%forward_error_bound, report%error_bound)
         summary%mass_error_relative = max(summary%mass_error_relative, mass_error_relative)
         summary%lowest_pressure = min(summary%lowest_pressure, &
                                       minval(self%problem%rock_pressure(self%now%coarse)), &
                                       minval(self%problem%fracture_pressure(self%now%coarse)))
         summary%cells = self%problem%mesh%n_cells
         summary%fracture_cells = self%problem%mesh%fracture%n_cells
         if (any(self%tip%joined)) call summary%use_after_all(meeting, not_meeting)
         call summary%add_newton(report%iterations)
         call count_unknowns(self, summary)
         call self%note_contact(self%problem%mesh%fracture, cell_states(self%now%coarse), always, &
                                always)
      end associate
   end subroutine note_state

   !> Evaluate the tips, and let them grow until none grows or the coarse mesh has to be updated.
   subroutine grow(self, timers, error)
      class(twolevel_simulation_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      logical :: may_grow

      may_grow = self%scene%growth%enabled .and. .not. self%is_initial .and. .not. self%owes_state
      self%owes_state = .false.
      if (self%scene%growth%intensities) then
         if (may_grow .and. self%is_equilibrium()) then
            call note_equilibrium(self, error)
         else
            call evaluate_tips(self, timers, error)
            if (allocated(error)) return
            if (may_grow) then
               call follow_tips(self, timers, error)
            else
               self%tip%advance = 0.0_rk
               call self%note_tips()
            end if
         end if
         if (allocated(error)) return
         associate (toughness => self%rules%toughness, time => self%now%coarse%time)
            if (self%is_equilibrium()) then
               call note_uncertain_tips(self, self%notes%is_uncertain)
               call self%notes%note_onsets(self%tip, self%now%segment, toughness, time, &
                                           self%chronicle)
               if (self%is_initial) call note_excess(self%tip, toughness, time, self%chronicle)
            end if
            call watch_windows(self%watch, self%scene, self%tip, time, may_grow)
         end associate
         call count_unknowns(self, self%summary)
         call self%heed_limits(error)
         if (allocated(error)) return
      end if
      if (states_errors(self)) call note_stated_errors(self%scene, self%front_state_t, &
                                                       self%problem, &
                                                       self%dt, self%now)
      if (may_grow .and. self%is_equilibrium()) then
         call self%notes%note_separation(self%tip, self%now, self%increments(), self%chronicle)
      end if
      if (self%now%coarse%time >= self%scene%time%end*(1.0_rk - same_time)) then
         if (.not. allocated(self%ending)) self%ending = "the scene's end time"
         self%owes_state = .false.
      end if
   end subroutine grow

   !> Evaluate the intensities in a state without growth, with refined windows where growth after it
   !! requires this.
   subroutine evaluate_tips(self, timers, error)
      class(twolevel_simulation_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(refinement_t), allocatable :: refinements(:)

      do
         call self%evaluate(timers, error)
         if (allocated(error)) return
         call estimate_coarse_errors(self, timers, error)
         if (allocated(error) .or. .not. self%is_equilibrium()) return
         call find_refinements(self, self%now%coarse%time, refinements)
         if (size(refinements) == 0) return
         call refine_windows(self, refinements)
      end do
   end subroutine evaluate_tips

   !> Report the growth of the last step.
   subroutine note_equilibrium(self, error)
      class(twolevel_simulation_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      call self%note_tips(grew_in_step=.true.)
      call self%note_growth()
      call self%end_at_gain()
      if (any(self%tip%advance > 0.0_rk)) self%chronicle%has_new_network = .true.
      if (.not. self%shows_growth) return
      call self%note_mesh(self%problem%mesh)
      call watch_mesh(self%watch, self%problem, self%now%coarse%time, error)
   end subroutine note_equilibrium

   !> Whether errors of length and pressure are estimated: not with increments of prescribed length.
   pure logical function states_errors(self)
      class(twolevel_simulation_t), intent(in) :: self

      states_errors = self%is_equilibrium() .or. .not. self%scene%growth%enabled
   end function states_errors

   !> Grow by increments. If the last one changes the coarse mesh, the state on the new mesh has
   !! still to be computed.
   subroutine follow_tips(self, timers, error)
      class(twolevel_simulation_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      logical :: any_grew, coarse_grew

      do
         call self%grow_tips(any_grew, timers, error)
         if (allocated(error)) return
         call self%note_tips()
         call self%note_growth()
         if (.not. any_grew) return
         call self%grow_coarse(coarse_grew, timers, error)
         if (allocated(error)) return
         call self%end_at_gain()
         if (coarse_grew) then
            call self%note_mesh(self%problem%mesh)
            call watch_mesh(self%watch, self%problem, self%now%coarse%time, error)
            if (allocated(error)) return
            call self%stepper%network_grew()
         end if
         self%owes_state = allocated(self%ending) .and. self%stepper%is_short
         if (coarse_grew .or. allocated(self%ending)) return
      end do
   end subroutine follow_tips

   !> Network and coarse mesh; with growth in equilibrium the last cells end at the tips.
   subroutine present_network(self, network, mesh)
      class(twolevel_simulation_t), intent(in) :: self
      type(network_t), intent(out) :: network
      type(mesh_t), intent(out) :: mesh

      network = self%now%coarse_network
      mesh = self%problem%mesh
      if (.not. self%is_equilibrium()) return
      network = self%network
      call end_at_tips(self%scene, self%network, self%tip, mesh%fracture)
   end subroutine present_network

   !> Row of history.csv of the accepted state.
   function history(self) result(row)
      class(twolevel_simulation_t), intent(in) :: self
      type(history_row_t) :: row

      row = history_of_levels(self)
      row%dt = merge(0.0_rk, self%dt, self%is_initial)
      row%newton_iterations = self%report%iterations
      row%seismic_moment = self%seismic_moment
      if (row%dt > 0.0_rk .and. self%problem%mesh%fracture%n_cells > 0) then
         associate (state => self%now%coarse)
            row%max_slip_rate = maxval(abs(state%jump(2, :, :) - state%slip_before))/row%dt
         end associate
      end if
      call self%stimulation%describe(self, row)
      row%length_error = -1.0_rk
      row%well_pressure_error = -1.0_rk
      if (.not. states_errors(self)) return
      row%length_error = self%now%stated_errors%length
      row%well_pressure_error = self%now%stated_errors%pressure
   end function history

   !> Displacement, stress and pressure at the probes.
   subroutine probes(self, row, error)
      class(twolevel_simulation_t), intent(inout) :: self
      type(probe_row_t), intent(out) :: row
      type(error_t), allocatable, intent(out) :: error

      call probes_of_levels(self%scene%probes, self%problem, self%now%coarse, row, error)
   end subroutine probes

   !> Fields of the last accepted state, if there is one.
   subroutine snapshot(self, fields)
      class(twolevel_simulation_t), intent(in) :: self
      type(snapshot_t), allocatable, intent(out) :: fields

      if (allocated(self%now%coarse%tractions)) then
         fields = snapshot_of_levels(self%scene, self%problem, self%now%coarse)
      end if
   end subroutine snapshot

   !> Time of the present state [s].
   pure real(rk) function time(self)
      class(twolevel_simulation_t), intent(in) :: self

      time = self%now%coarse%time
   end function time

end module twolevel_simulation
