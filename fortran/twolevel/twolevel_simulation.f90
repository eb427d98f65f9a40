!> What a run calls: time steps, with growth of the tips in each step, and the results of a state.
submodule(twolevel_state) twolevel_simulation
   use base_errors, only: error_t
   use base_kinds, only: rk
   use base_number, only: brief_text
   use base_timers, only: timers_t
   use base_tolerances, only: same_time
   use report_rows, only: history_row_t
   use scene_sizes, only: sizes_text
   use twolevel_refinement, only: find_refinements, refine_windows, note_uncertain_tips
   use twolevel_limits, only: watch_mesh, watch_windows
   use twolevel_notes, only: note_excess, states_errors
   use twolevel_results, only: history_of_levels, probes_of_levels, snapshot_of_levels
   use twolevel_stepping, only: refinement_t
   use twolevel_coarse_errors, only: estimate_coarse_errors
   use twolevel_places, only: end_at_tips
   implicit none(type, external)

contains

   module subroutine begin(self, scene, timers, error)
      class(two_levels_t), intent(inout) :: self
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
      if (self%scene%growth%enabled) self%summary%growth_jumps = 0
      call watch_mesh(self%watch, self%problem, self%now%coarse%time, error)
      if (.not. allocated(error)) call note_features(self)
   end subroutine begin

   !> Report the features that the scene uses, and those that it does not use.
   subroutine note_features(self)
      class(two_levels_t), intent(inout) :: self

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

   module subroutine grow(self, timers, error)
      class(two_levels_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      logical :: may_grow

      may_grow = self%scene%growth%enabled .and. .not. self%is_initial .and. .not. self%owes_state
      self%owes_state = .false.
      if (self%scene%growth%intensities) then
         if (may_grow .and. self%scene%growth%in_equilibrium()) then
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
            if (self%scene%growth%in_equilibrium()) then
               call note_uncertain_tips(self, self%notes%is_uncertain)
               call self%notes%note_onsets(self%tip, self%now%segment, toughness, time, &
                                           self%chronicle)
               if (self%is_initial) call note_excess(self%tip, toughness, time, self%chronicle)
            end if
            call watch_windows(self%watch, self%scene, self%tip, time, may_grow)
         end associate
         call self%count_unknowns()
         call self%heed_limits(error)
         if (allocated(error)) return
      end if
      if (may_grow .and. self%scene%growth%in_equilibrium()) then
         call self%notes%note_separation(self%tip, self%now, self%rules%toughness, &
                                         self%increments(), self%chronicle)
      end if
      if (self%now%coarse%time >= self%scene%time%end*(1.0_rk - same_time)) then
         if (.not. allocated(self%ending)) self%ending = "the scene's end time"
         self%owes_state = .false.
      end if
   end subroutine grow

   !> Evaluate the intensities in a state without growth, with refined windows where growth after it
   !! requires this.
   subroutine evaluate_tips(self, timers, error)
      class(two_levels_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(refinement_t), allocatable :: refinements(:)

      do
         call self%evaluate(timers, error)
         if (allocated(error)) return
         call estimate_coarse_errors(self, timers, error)
         if (allocated(error) .or. .not. self%scene%growth%in_equilibrium()) return
         call find_refinements(self, self%now%coarse%time, refinements)
         if (size(refinements) == 0) return
         call refine_windows(self, refinements)
      end do
   end subroutine evaluate_tips

   !> Report the growth of the last step.
   subroutine note_equilibrium(self, error)
      class(two_levels_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      call self%note_tips(grew_in_step=.true.)
      call self%note_growth()
      call self%end_at_gain()
      if (any(self%tip%advance > 0.0_rk)) self%chronicle%has_new_network = .true.
      if (.not. self%shows_growth) return
      call self%note_mesh(self%problem%mesh)
      call watch_mesh(self%watch, self%problem, self%now%coarse%time, error)
   end subroutine note_equilibrium

   !> Grow by increments. If the last one changes the coarse mesh, the state on the new mesh has
   !! still to be computed.
   subroutine follow_tips(self, timers, error)
      class(two_levels_t), intent(inout) :: self
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

   module subroutine present_network(self, network, mesh)
      class(two_levels_t), intent(in) :: self
      type(network_t), intent(out) :: network
      type(mesh_t), intent(out) :: mesh

      network = self%now%coarse_network
      mesh = self%problem%mesh
      if (.not. self%scene%growth%in_equilibrium()) return
      network = self%network
      call end_at_tips(self%scene, self%front_state_t, mesh%fracture)
   end subroutine present_network

   module function history(self) result(row)
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
      row%length_error = -1.0_rk
      row%well_pressure_error = -1.0_rk
      if (.not. states_errors(self%scene%growth)) return
      row%length_error = self%now%stated_errors%length
      row%well_pressure_error = self%now%stated_errors%pressure
   end function history

   module subroutine probes(self, row, error)
      class(two_levels_t), intent(inout) :: self
      type(probe_row_t), intent(out) :: row
      type(error_t), allocatable, intent(out) :: error

      call probes_of_levels(self%scene%probes, self%problem, self%now%coarse, row, error)
   end subroutine probes

   module subroutine snapshot(self, fields)
      class(two_levels_t), intent(in) :: self
      type(snapshot_t), allocatable, intent(out) :: fields

      if (allocated(self%now%coarse%tractions)) then
         fields = snapshot_of_levels(self%scene, self%problem, self%now%coarse)
      end if
   end subroutine snapshot

   pure module function time(self)
      class(two_levels_t), intent(in) :: self
      real(rk) :: time

      time = self%now%coarse%time
   end function time

   pure module function last_state(self) result(words)
      class(two_levels_t), intent(in) :: self
      character(len=:), allocatable :: words

      words = brief_text(self%now%coarse%time, 6)//" s"
   end function last_state

end submodule twolevel_simulation
