!> Both levels of a scene with a fluid at one time: their state, and separately coarse mesh, model
!! and windows. A step begins from this state, and rejected tries restore it.
module twolevel_state
   use base_archive, only: archive_t
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_number, only: brief_text
   use base_timers, only: phase_tips, timers_t
   use growth_network, only: increments_in
   use mesh_geometry, only: cell_area
   use coarse_state, only: state_t, step_report_t
   use mesh_types, only: mesh_t, network_t
   use scene_types, only: scene_t
   use report_rows, only: history_row_t, probe_row_t
   use report_restart, only: restartable_t
   use report_simulation, only: snapshot_t
   use twolevel_field_errors, only: add_rock_errors, find_fracture_errors
   use twolevel_heat, only: act, add_heat_fields, heat_row, predict_heat
   use twolevel_heat_errors, only: blurred_t
   use twolevel_levels_state, only: checkpoint_t, levels_state_t
   use twolevel_notes, only: notes_t, states_errors
   use twolevel_pace, only: pace_t
   use twolevel_place_errors, only: add_well_places, note_probes
   use twolevel_places, only: end_at_tips, place_tips
   use twolevel_problem, only: coarse_problem_t, discard
   use twolevel_results, only: history_of_levels, probes_of_levels, shared_displacement_error, &
                               snapshot_of_levels
   use twolevel_setup, only: pressure_scale
   use twolevel_tips, only: find_tip_intensities
   use twolevel_schedule, only: follow_sides, last_switch
   use twolevel_stepping, only: step_scale, stepper_t
   use twolevel_stimulation, only: stimulation_t
   use twolevel_value_errors, only: value_errors_t
   use twolevel_wells, only: rate
   use twolevel_unsolved, only: why_unsolved
   use twolevel_well_rows, only: well_results_t
   use twolevel_windows, only: windows_t
   implicit none(type, external)
   private

   public :: two_levels_t

   !> share of the longest step: within this time no fluid moves noticeably [-]
   real(rk), parameter :: undrained_share = 1.0e-6_rk

   ! Names of the feature of intersections in the log.
   character(len=*), parameter :: meeting = "intersections: flow from fracture to fracture "// &
                                  "or out of the body"
   character(len=*), parameter :: at_end = "the scene's end time"  !< reason of the end
   character(len=*), parameter :: not_meeting = "intersections: fractures do not meet"

   !> The last step.
   type :: last_step_t
      real(rk) :: dt = 0.0_rk  !< length [s]
      !> it began or ended at a switch of a well
      logical :: is_after_switch = .false., ends_at_switch = .false.
      logical :: is_unstable = .false.  !< tips grew without equilibrium
      type(step_report_t) :: report
      character(len=:), allocatable :: why_cut  !< reason of the last cut
      !> (tips) positions on their segments in equilibrium before windows were refined, from which
      !! the same step is tried again [m]
      real(rk), allocatable :: places(:)
      integer :: refined = 0  !< times that windows were refined and the step was tried again
   end type last_step_t

   !> Simulation of a scene with a fluid on both levels; `network` is the fine network, which is
   !! ahead of the coarse one. A step changes tips, network and `now`; a rejected try is undone by
   !! `put_back` and nowhere else.
   type, extends(restartable_t) :: two_levels_t
      type(levels_state_t) :: now
      type(checkpoint_t) :: last  !< state at the start of the step
      type(state_t) :: before  !< coarse part of `last`, on the present mesh
      ! Not part of the state
      type(coarse_problem_t), allocatable :: problem
      !> problem of `last`, where a try has a new mesh
      type(coarse_problem_t), allocatable :: kept_problem
      type(windows_t) :: windows
      type(windows_t) :: reference  !< the body as one window, with which the windows are compared
      real(rk) :: load_pressure = 0.0_rk  !< largest pressure expected from the loads [Pa]
      !> largest number of coarse fracture cells for this comparison
      integer(ik) :: reference_most = 800
      logical :: has_begun = .false.  !< the first state has been requested
      logical :: is_initial = .false.  !< the present state is the one before the first step
      type(last_step_t) :: step
      type(stepper_t) :: stepper
      type(pace_t) :: pace  !< of a replay
      ! Results of all steps so far
      type(notes_t) :: notes  !< event log of growth in equilibrium
      type(stimulation_t) :: stimulation
      type(well_results_t) :: well_results
      type(value_errors_t) :: value_errors  !< of the accepted state
      type(blurred_t) :: blurred  !< the accepted step with blurred temperatures
      real(rk) :: seismic_moment = 0.0_rk  !< per metre of thickness [N m]
      !> unknowns of the windows when they were last compared with those of the body
      integer(ik) :: compared_unknowns = 0
   contains
      procedure :: begin
      procedure :: next_state
      procedure :: grow
      procedure :: present_network
      procedure :: history
      procedure :: probes
      procedure :: snapshot
      procedure :: time
      procedure :: last_state
      procedure :: begin_step
      procedure :: remember
      procedure :: put_back
      procedure :: present_state
      procedure :: follow_trend
      procedure :: equilibrate
      procedure :: rest_wells
      procedure :: try_step
      procedure :: step_error
      procedure :: errs
      procedure :: book_step
      procedure :: evaluate
      procedure :: has_reference
      procedure :: count_unknowns
      procedure :: grow_coarse
      procedure :: remesh_coarse
      procedure :: prepare
      procedure :: visit
      procedure :: take_over
      procedure :: judge_mesh
   end type two_levels_t

   ! In the submodules twolevel_adaption, twolevel_remeshing, twolevel_restart, twolevel_steps,
   ! twolevel_simulation and twolevel_switch
   interface
      module subroutine prepare(self, scene)
         implicit none(type, external)
         class(two_levels_t), intent(inout) :: self
         type(scene_t), intent(in) :: scene
      end subroutine prepare

      module subroutine visit(self, archive, timers, error)
         implicit none(type, external)
         class(two_levels_t), intent(inout) :: self
         type(archive_t), intent(inout) :: archive
         type(timers_t), intent(inout) :: timers
         type(error_t), allocatable, intent(out) :: error
      end subroutine visit

      module subroutine take_over(self, scene, error)
         implicit none(type, external)
         class(two_levels_t), intent(inout) :: self
         type(scene_t), intent(in) :: scene
         type(error_t), allocatable, intent(out) :: error
      end subroutine take_over

      !> Extend the coarse network by the growth of the tips, if it has reached the threshold, or if
      !! no growth follows.
      module subroutine grow_coarse(self, grew, timers, error)
         implicit none(type, external)
         class(two_levels_t), intent(inout) :: self
         logical, intent(out) :: grew
         type(timers_t), intent(inout) :: timers
         type(error_t), allocatable, intent(out) :: error
      end subroutine grow_coarse

      !> Remesh the coarse network around the points where it has changed, and transfer the state.
      module subroutine remesh_coarse(self, centres, timers, error)
         implicit none(type, external)
         class(two_levels_t), intent(inout) :: self
         real(rk), intent(in) :: centres(:, :)  !< (2, n) [m]
         type(timers_t), intent(inout) :: timers
         type(error_t), allocatable, intent(out) :: error
      end subroutine remesh_coarse

      !> Estimate the error of the response to the wells on the coarse mesh before the first step;
      !! sizes are allocated where another mesh is needed, or is worthwhile because it is coarser.
      module subroutine judge_mesh(self, may_coarsen, sizes, timers, error)
         implicit none(type, external)
         class(two_levels_t), intent(inout) :: self
         logical, intent(in) :: may_coarsen
         real(rk), allocatable, intent(out) :: sizes(:)  !< (n_cells) of the cells of another [m]
         type(timers_t), intent(inout) :: timers
         type(error_t), allocatable, intent(out) :: error
      end subroutine judge_mesh

      !> Mesh both levels, without load.
      module subroutine begin(self, scene, timers, error)
         implicit none(type, external)
         class(two_levels_t), intent(inout) :: self
         type(scene_t), intent(in) :: scene
         type(timers_t), intent(inout) :: timers
         type(error_t), allocatable, intent(out) :: error
      end subroutine begin

      !> Compute the initial state first, if the scene requires fractures in equilibrium; then one
      !! time step per call. After an error the last accepted state is restored.
      module subroutine next_state(self, timers, error)
         implicit none(type, external)
         class(two_levels_t), intent(inout) :: self
         type(timers_t), intent(inout) :: timers
         type(error_t), allocatable, intent(out) :: error
      end subroutine next_state

      !> Evaluate the tips, and let them grow until none grows or the coarse mesh has to be updated.
      module subroutine grow(self, timers, error)
         implicit none(type, external)
         class(two_levels_t), intent(inout) :: self
         type(timers_t), intent(inout) :: timers
         type(error_t), allocatable, intent(out) :: error
      end subroutine grow
   end interface

contains

   !> Begin a step: accept contact in the windows as evaluated last.
   subroutine begin_step(self)
      class(two_levels_t), intent(inout) :: self

      if (self%scene%growth%intensities) then
         call self%now%windows%accept()
         call self%now%reference%accept()
      end if
      if (self%scene%growth%increments == "by_length") then
         self%rules%own_increment = increments_in(self%network, self%scene)
      end if
      call self%remember()
   end subroutine begin_step

   !> Store the present state as the start of the tries.
   subroutine remember(self)
      class(two_levels_t), intent(inout) :: self

      self%last = self%present_state()
      self%before = self%now%coarse
      call discard(self%kept_problem)
      if (.not. self%scene%growth%intensities) return
      call self%windows%begin_step()
      call self%reference%begin_step()
   end subroutine remember

   !> Undo a rejected try: restore the stored state, to the last bit.
   subroutine put_back(self)
      class(two_levels_t), intent(inout) :: self

      self%now = self%last%levels
      self%before = self%now%coarse
      if (self%scene%growth%intensities) then
         call self%windows%put_back()
         call self%reference%put_back()
      end if
      if (allocated(self%kept_problem)) then
         call discard(self%problem)
         call move_alloc(self%kept_problem, self%problem)
         call self%windows%coarse_changed()
         call self%reference%coarse_changed()
      end if
      self%front_state_t = self%last%front
      if (self%scene%growth%leaves_partial_cells() .and. allocated(self%now%segment)) then
         call place_tips(self%front_state_t, self%now%segment, self%problem)
      end if
      call act(self%scene, self%problem, self%now%heat)
      self%problem%heat_span = -1.0_rk  ! temperatures of a rejected try
   end subroutine put_back

   !> Copy of all quantities that a step changes.
   function present_state(self) result(state)
      class(two_levels_t), intent(in) :: self
      type(checkpoint_t) :: state

      state%front = self%front_state_t
      state%levels = self%now
   end function present_state

   !> Set the flow in the wells to zero.
   subroutine rest_wells(self)
      class(two_levels_t), intent(inout) :: self

      associate (wells => self%problem%model%wells)
         self%now%at_limit = spread(.false., 1, int(wells%n_all))
         self%now%given = spread(0.0_rk, 1, int(wells%n_all + wells%n_entries))
      end associate
      call self%problem%rest_wells(self%now%coarse)
   end subroutine rest_wells

   !> Begin the estimate of the time error: with zero rates at rest, else with those of the next
   !! step.
   subroutine follow_trend(self, at_rest)
      class(two_levels_t), intent(inout) :: self
      logical, intent(in) :: at_rest
      real(rk) :: length
      integer :: i

      length = sum([(self%scene%fractures(i)%length(), i=1, size(self%scene%fractures))])
      call self%now%trend%begin(self%now%coarse, at_rest, pressure_scale(self%scene), &
                                self%scene%material%young, length)
   end subroutine follow_trend

   !> Undrained response to the load with fractures in equilibrium with the rock (model.md section
   !! 9).
   subroutine equilibrate(self, timers, report, error)
      class(two_levels_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error

      self%now%undrained = .true.
      call self%problem%model%equilibrate(self%problem%mesh, &
                                          undrained_share*step_scale(self%scene%time), &
                                          self%now%coarse, timers, report, error)
      if (.not. allocated(error)) call explain(self, 0.0_rk, report)
      call self%rest_wells()
   end subroutine equilibrate

   !> Try one step of the coarse level. Nothing changes unless it converges.
   subroutine try_step(self, dt, timers, report, error)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error

      call predict_heat(self%scene, self%now%coarse, dt, self%problem, self%now%heat, error)
      if (allocated(error)) return
      call self%problem%advance(self%scene, dt, self%now%coarse, timers, report, error)
      if (allocated(error)) return
      call explain(self, dt, report)
      if (report%converged) self%now%undrained = .false.
   end subroutine try_step

   !> State the reason why a step is not solved, in the terms of the scene.
   subroutine explain(self, dt, report)
      class(two_levels_t), intent(in) :: self
      real(rk), intent(in) :: dt  !< [s]
      type(step_report_t), intent(inout) :: report

      if (report%converged) return
      report%reason = why_unsolved(report, self%now%coarse_network, &
                                   self%problem%mesh%fracture, self%problem%entries, &
                                   self%problem%share, rate(self%problem%entries, &
                                                            self%now%coarse%time, dt))
   end subroutine explain

   !> Relative time error of a step of length dt to the present state [-].
   function step_error(self, dt) result(error)
      class(two_levels_t), intent(in) :: self
      real(rk), intent(in) :: dt  !< [s]
      real(rk) :: error
      real(rk) :: area(self%problem%mesh%n_cells)
      integer(ik) :: c

      associate (trend => self%now%trend, model => self%problem%model)
         do c = 1, self%problem%mesh%n_cells
            area(c) = cell_area(self%problem%mesh, c)
         end do
         error = trend%step_error(self%before, self%now%coarse, dt, area, &
                                  model%condensed%length)
         ! The pressure that heat causes may be confined to a small part of the rock.
         if (allocated(model%rock%temperature)) then
            error = max(error, trend%step_error(self%before, self%now%coarse, dt, &
                                                area*abs(model%rock%temperature), &
                                                model%condensed%length))
         end if
         if (model%wells%n_all > 0 .and. trend%is_known()) then
            error = max(error, trend%volume_error(self%before%well_flow, &
                                                  self%now%coarse%well_flow, self%now%given, dt, &
                                                  least_volume(self, dt)))
         end if
         ! Rates jump where a well is switched: the length of the step before does not count.
         if (self%step%is_after_switch .and. trend%dt > dt) then
            error = 0.5_rk*(1.0_rk + trend%dt/dt)*error
         end if
      end associate
   end function step_error

   !> Least volume of a well for the relative error of its flow in a step of length dt: a small
   !! share of the largest volume of a well since the last switch, and more than the rounding error
   !! of the fluid volume [m2].
   pure real(rk) function least_volume(self, dt) result(least)
      class(two_levels_t), intent(in) :: self
      real(rk), intent(in) :: dt  !< [s]
      real(rk), parameter :: share = 0.01_rk, trace = 1.0e-10_rk
      real(rk) :: fluid, most

      associate (state => self%now%coarse, model => self%problem%model, since => &
                 self%before%time + dt - last_switch(self%scene, self%before%time))
         most = maxval([self%now%given + dt*abs(state%well_flow), &
                        since*abs(rate(self%scene%injections, self%before%time, dt))])
         fluid = sum(model%condensed%length*state%aperture) &
                 + self%now%trend%least_pressure*sum(model%matrix%storage)
      end associate
      least = max(share*most, trace*fluid)
   end function least_volume

   !> Whether the time error of a step exceeds the tolerance of the scene.
   pure logical function errs(self, error)
      class(two_levels_t), intent(in) :: self
      real(rk), intent(in) :: error  !< relative [-]

      associate (tolerance => self%scene%time%tolerance)
         errs = tolerance > 0.0_rk .and. error > tolerance
      end associate
   end function errs

   !> Add the fluid volumes of an accepted step.
   subroutine book_step(self, dt)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      real(rk) :: flow(size(self%scene%injections))

      associate (fluid => self%now%fluid, state => self%now%coarse, model => self%problem%model)
         ! The sources of the model are not used: they are those of its last try.
         flow = rate(self%scene%injections, self%before%time, dt)
         if (model%wells%n_all > 0) then
            flow(model%wells%number) = state%well_flow(:model%wells%n_all)
            self%now%given = self%now%given + dt*abs(state%well_flow)
         end if
         fluid%injected = fluid%injected + dt*sum(flow)
         fluid%produced = fluid%produced - dt*sum(min(flow, 0.0_rk))
         if (self%problem%mesh%fracture%n_cells == 0) return
         fluid%leaked = fluid%leaked + dt*sum(state%leakoff*model%condensed%length)
         if (model%joints%n == 0) return
         fluid%outflow = fluid%outflow + dt*model%joints%outflow(state%branch_flow, &
                                                                 model%into_joints(state))
      end associate
   end subroutine book_step

   !> Stress intensity factors of the active tips, in windows on the present network.
   subroutine evaluate(self, timers, error)
      class(two_levels_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call timers%heed(error)
      if (allocated(error)) return
      call follow_sides(self%scene, self%now%coarse%time, self%now%coarse%time)
      call timers%start(phase_tips)
      call find_tip_intensities(self%scene, self%has_reference(), self%front_state_t, &
                                self%problem, self%now, self%windows, error)
      call timers%stop(phase_tips)
   end subroutine evaluate

   !> The windows are compared with the whole body as one window.
   pure logical function has_reference(self)
      class(two_levels_t), intent(in) :: self

      has_reference = .not. self%windows%all_in_body() .and. &
                      self%problem%mesh%fracture%n_cells <= self%reference_most
   end function has_reference

   !> Numbers of unknowns by block, for run.json.
   subroutine count_unknowns(self)
      class(two_levels_t), intent(inout) :: self
      integer(ik) :: n_reference

      associate (mesh => self%problem%mesh, model => self%problem%model, summary => self%summary)
         call summary%count_dofs("displacement", 2*mesh%n_cells)
         call summary%count_dofs("matrix_pressure", mesh%n_cells)
         call summary%count_dofs("fracture_jump", 4*mesh%fracture%n_cells)
         call summary%count_dofs("fracture_face_pressure", 2*mesh%fracture%n_cells)
         call summary%count_dofs("fracture_pressure", mesh%fracture%n_cells)
         call summary%count_dofs("fracture_flow", size(model%connections, 2) &
                                 + model%joints%branch_count())
         if (model%joints%n > 0) call summary%count_dofs("intersection_pressure", model%joints%n)
         if (.not. self%scene%growth%intensities) return
         call summary%count_dofs("windows", self%windows%n_unknowns(self%tip))
         if (self%scene%discretization%window_is_body) return
         ! Where no tip may grow, the body is not compared with.
         n_reference = self%reference%n_unknowns(self%tip)
         if (n_reference > 0) call summary%count_dofs("windows_reference", n_reference)
      end associate
   end subroutine count_unknowns

   !> Network and coarse mesh; with growth in equilibrium the last cells end at the tips.
   subroutine present_network(self, network, mesh)
      class(two_levels_t), intent(in) :: self
      type(network_t), intent(out) :: network
      type(mesh_t), intent(out) :: mesh

      network = self%now%coarse_network
      mesh = self%problem%mesh
      if (.not. self%scene%growth%leaves_partial_cells()) return
      network = self%network
      call end_at_tips(self%scene, self%front_state_t, mesh%fracture)
   end subroutine present_network

   !> Row of history.csv of the accepted state.
   function history(self) result(row)
      class(two_levels_t), intent(in) :: self
      type(history_row_t) :: row

      row = history_of_levels(self%scene, self%front_state_t, self%problem, self%now, &
                              self%before%time)
      row%dt = merge(0.0_rk, self%step%dt, self%is_initial)
      row%newton_iterations = self%step%report%iterations
      row%seismic_moment = self%seismic_moment
      if (row%dt > 0.0_rk .and. self%problem%mesh%fracture%n_cells > 0) then
         associate (state => self%now%coarse)
            row%max_slip_rate = maxval(abs(state%jump(2, :, :) - state%slip_before))/row%dt
         end associate
      end if
      call self%stimulation%describe(self%scene, self%start, self%front_state_t, self%problem, &
                                     self%now%coarse, row)
      row%error = self%value_errors%row
      if (allocated(self%problem%heat)) row%heat = heat_row(self%now%heat)
      row%length_error = -1.0_rk
      row%well_pressure_error = -1.0_rk
      if (.not. states_errors(self%scene%growth)) return
      row%length_error = self%now%stated_errors%length
      row%well_pressure_error = self%now%stated_errors%pressure
      if (.not. allocated(self%value_errors%of_wells)) return
      associate (first => self%value_errors%undrained(self%scene, self%problem), &
                 largest => maxval(self%value_errors%of_wells))
         row%well_pressure_error = min(row%well_pressure_error + maxval([0.0_rk, first]), largest)
         ! The error of the steps is that of wells in fractures.
         if (any(self%scene%injections%fracture == 0)) row%well_pressure_error = largest
      end associate
   end function history

   !> Displacement, stress and pressure at the probes.
   subroutine probes(self, row, error)
      class(two_levels_t), intent(inout) :: self
      type(probe_row_t), intent(out) :: row
      type(error_t), allocatable, intent(out) :: error

      call probes_of_levels(self%scene%probes, self%problem, self%now%coarse, row, error)
      if (allocated(error)) return
      row%displacement_error = row%displacement_error &
                               + shared_displacement_error(self%problem, self%now%coarse)
      call note_probes(self%value_errors, self%time(), self%now%trend%pressure_rise(), row)
      call self%blurred%add_to_probes(self%scene, self%problem, row)
      if (allocated(self%well_results%injected)) then
         call add_well_places(self%scene, self%problem, self%well_results%injected, self%time(), &
                              row)
      end if
   end subroutine probes

   !> Fields of the last accepted state, if there is one.
   subroutine snapshot(self, fields)
      class(two_levels_t), intent(in) :: self
      type(snapshot_t), allocatable, intent(out) :: fields

      if (.not. allocated(self%now%coarse%tractions)) return
      fields = snapshot_of_levels(self%scene, self%problem, self%now%coarse)
      call add_rock_errors(self%scene, self%problem, self%now%coarse, self%value_errors, &
                           fields%matrix)
      if (self%problem%mesh%fracture%n_cells > 0) then
         call find_fracture_errors(self%scene, self%problem, self%now%coarse, self%value_errors, &
                                   fields%fracture)
         call self%blurred%add_to_fractures(self%scene, self%problem, fields%fracture)
      end if
      fields%intersection%pressure_error = spread(self%value_errors%pressure_error(), 1, &
                                                  size(fields%intersection%pressure))
      if (self%scene%output%windows .and. allocated(self%windows%slot)) then
         fields%windows = self%windows%meshes(self%tip)
         if (size(fields%windows%tip) == 0) deallocate (fields%windows)
      end if
      call add_heat_fields(self%problem, self%now%heat, self%time(), fields)
   end subroutine snapshot

   !> Time of the present state [s].
   pure function time(self)
      class(two_levels_t), intent(in) :: self
      real(rk) :: time

      time = self%now%coarse%time
   end function time

   !> Time of the last accepted state, as text.
   pure function last_state(self) result(words)
      class(two_levels_t), intent(in) :: self
      character(len=:), allocatable :: words

      words = brief_text(self%now%coarse%time, 6)//" s"
   end function last_state

end module twolevel_state
