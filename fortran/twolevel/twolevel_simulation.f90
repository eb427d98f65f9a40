!> The start of a simulation, and the growth of its tips between steps.
submodule(twolevel_state) twolevel_simulation
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_timers, only: phase_mesh, phase_remesh, timers_t
   use base_tolerances, only: same_time
   use coarse_model, only: new_state
   use growth_network, only: fracture_length, network_of_scene
   use mesh_builder, only: build_mesh, build_mesh_sized
   use scene_sizes, only: sizes_text
   use scene_types, only: scene_t
   use twolevel_coarse_errors, only: estimate_coarse_errors
   use twolevel_field_errors, only: load_errors
   use twolevel_heat, only: set_heat
   use twolevel_limits, only: watch_mesh, watch_windows
   use twolevel_notes, only: note_excess
   use twolevel_stepping, only: refinement_t
   use twolevel_refinement, only: find_refinements, keep_refinements, &
                                  note_uncertain_tips, refine_windows
   use twolevel_schedule, only: follow_sides
   use twolevel_setup, only: choose_first_step, coarse_spec, first_cells, keep_above_zero, &
                             pressure_scale, rest_joints, rules_of_scene
   use twolevel_wells, only: entries_of, share_wells
   implicit none(type, external)

   ! Names of features that are not used, in the log.
   character(len=*), parameter :: no_growth = "remeshing and transfer: growth off"
   character(len=*), parameter :: no_wells = "no injection"

contains

   module procedure begin

   self%end_time = scene%time%end
   self%tape%is_recording = .true.
   call self%stepper%begin(scene%time)
   call mesh_levels(self, scene, timers, error)
   if (allocated(error)) return
   call self%catalogue%begin(scene%output%out_of_plane_length, &
                             scene%output%stimulated_jump, scene%output%seismic_slip_rate)
   call self%notes%begin(size(self%tip))
   if (self%scene%growth%enabled) self%summary%growth_jumps = 0
   call watch_mesh(self%watch, self%problem, self%now%coarse%time, error)
   if (.not. allocated(error)) call note_features(self)
   end procedure begin

   !> Mesh, discretize and set the state before the load.
   subroutine mesh_levels(self, scene, timers, error)
      class(two_levels_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call self%set_scene(scene)
      call keep_above_zero(self%scene)
      call follow_sides(self%scene, 0.0_rk, 0.0_rk)
      self%start = network_of_scene(scene)
      self%network = self%start
      self%now%coarse_network = self%start
      self%rules = rules_of_scene(self%scene)
      call mesh_coarse(self, timers, error)
      if (allocated(error)) return
      call set_scales(self)
      if (scene%growth%intensities) call begin_windows(self)
      allocate (self%now%grown(0), self%now%segment(size(self%tip)))
      call self%now%interaction%begin(size(self%tip))
      call self%follow_trend(at_rest=.false.)
      call set_heat(self%scene, self%problem, error)
   end subroutine mesh_levels

   !> Begin the windows of the tips, and the body as reference. It has elements as large as the
   !! coarse cells; at the tips, where this matters, they are those of the windows.
   subroutine begin_windows(self)
      class(two_levels_t), intent(inout) :: self

      associate (coarser => 1.0_rk/self%scene%discretization%fine_ratio, &
                 is_body => self%scene%discretization%window_is_body)
         call self%windows%begin(self%tip, is_body, merge(1.0_rk, coarser, is_body), &
                                 self%now%windows)
         if (.not. is_body) call self%reference%begin(self%tip, .true., coarser, &
                                                      self%now%reference)
      end associate
   end subroutine begin_windows

   !> Mesh the coarse level, with &adaptive again until the estimated error is small enough.
   subroutine mesh_coarse(self, timers, error)
      class(two_levels_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(coarse_problem_t), allocatable :: problem
      real(rk), allocatable :: sizes(:)
      integer(ik) :: pass

      allocate (self%problem)
      call timers%start(phase_mesh)
      call build_mesh(coarse_spec(self%scene), self%now%coarse_network, self%problem%mesher, &
                      self%problem%mesh, error)
      call timers%stop(phase_mesh)
      if (.not. allocated(error)) call set_coarse(self, timers, error)
      if (allocated(error) .or. .not. self%scene%adaptive%enabled) return
      do pass = 1, self%scene%adaptive%passes
         call self%judge_mesh(pass == 1, sizes, timers, error)
         if (allocated(error) .or. .not. allocated(sizes)) return
         allocate (problem)
         call timers%start(phase_remesh)
         call build_mesh_sized(coarse_spec(self%scene), self%now%coarse_network, &
                               self%problem%mesher, sizes, problem%mesher, problem%mesh, error)
         call timers%stop(phase_remesh)
         if (allocated(error)) return
         call discard(self%problem)
         call move_alloc(problem, self%problem)
         call set_coarse(self, timers, error)
         if (allocated(error)) return
      end do
      call self%judge_mesh(.false., sizes, timers, error)
   end subroutine mesh_coarse

   !> Discretize on the coarse mesh, and set the state before the load.
   subroutine set_coarse(self, timers, error)
      class(two_levels_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      associate (problem => self%problem, mesh => self%problem%mesh, now => self%now)
         call first_cells(self%scene, mesh%fracture, problem%model%cells)
         call share_wells(entries_of(self%scene%injections), mesh%fracture, problem%share)
         call choose_first_step(self%scene, problem%model%first_step)
         call problem%model%set_mesh(mesh, self%scene, timers, error)
         if (allocated(error)) return
         call problem%feed_wells(self%scene, error)
         if (allocated(error)) return
         if (allocated(problem%model%in_situ)) then
            call rest_joints(problem%model%in_situ, mesh%fracture, problem%model%cells)
         end if
         call new_state(mesh, problem%model%cells, self%scene%initial, problem%model, now%coarse)
         call self%rest_wells()
         call self%find_tips(mesh%fracture)
      end associate
   end subroutine set_coarse

   !> Set the pressure of the loads, and the least scale of K_eq of each tip: a share of K at this
   !! pressure in its fracture.
   pure subroutine set_scales(self)
      class(two_levels_t), intent(inout) :: self
      real(rk), parameter :: share = 0.01_rk
      integer(ik) :: i

      self%load_pressure = pressure_scale(self%scene)
      do i = 1, size(self%tip, kind=ik)
         associate (tip => self%tip(i))
            tip%least_scale = share*self%load_pressure &
                              *sqrt(0.5_rk*pi*fracture_length(self%network, tip%fracture))
         end associate
      end do
   end subroutine set_scales

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
         call summary%note(size(scene%injections) > 0, "injection", no_wells)
         call summary%note(scene%growth%intensities, "stress intensity factors", &
                           "no windows: intensities off")
         call summary%note(scene%growth%enabled, "growth", no_growth)
         if (scene%adaptive%enabled) call summary%use_feature("adaptive coarse mesh")
         call summary%note(scene%output%vtu, "VTU files", "VTU files: off")
         call summary%note(self%problem%model%drained, "flow across the outer boundary", &
                           "boundary flow: the body is sealed")
         call summary%note(self%problem%model%joints%n > 0, meeting, not_meeting)
         if (allocated(self%problem%model%in_situ)) then
            call summary%use_feature("stress in situ, hydrostatic")
         end if
         if (any(abs(scene%gravity) > 0.0_rk)) call summary%use_feature("gravity")
         if (allocated(self%problem%heat)) then
            call summary%use_feature("heat: conduction, and carried by the fluid")
            call summary%note(any(self%problem%model%rock%heat_stress > 0.0_rk), "thermal stress", &
                              "no thermal stress: heat_expansion is not given")
            call summary%note(allocated(scene%fluid%table_temperature), &
                              "viscosity by temperature in fractures; the rock keeps one", &
                              "viscosity by temperature: no table_temperature")
         end if
         if (scene%discretization%chosen) then
            call summary%use_feature("default sizes: "//sizes_text(scene))
         end if
      end associate
   end subroutine note_features

   module procedure grow
   logical :: may_grow

   may_grow = self%scene%growth%enabled .and. .not. self%is_initial .and. .not. self%owes_state
   self%owes_state = .false.
   if (self%scene%growth%intensities) then
      if (may_grow .and. self%scene%growth%in_equilibrium()) then
         call self%notes%note_separation(self%tip, self%now, self%rules%toughness, &
                                         self%increments(), self%chronicle)
         self%position_error = self%now%stated_errors%position
         call note_equilibrium(self, error)
      else
         call evaluate_tips(self, timers, error)
         if (allocated(error)) return
         if (may_grow) then
            call follow_tips(self, timers, error)
         else
            self%tip%advance = 0.0_rk
            call self%note_tips(load_errors=load_errors_of(self))
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
         call watch_windows(self%watch, self%scene, self%tip, time, may_grow, self%is_initial &
                            .and. self%scene%growth%enabled .and. &
                            self%scene%growth%in_equilibrium())
      end associate
      call self%count_unknowns()
      call self%heed_limits(error)
      if (allocated(error)) return
   end if
   if (self%now%coarse%time >= self%scene%time%end*(1.0_rk - same_time)) then
      if (.not. allocated(self%ending)) self%ending = at_end
      self%owes_state = .false.
   end if
   end procedure grow

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
         call keep_refinements(self%tape, refinements)
         if (size(refinements) == 0) return
         call refine_windows(self, refinements)
      end do
   end subroutine evaluate_tips

   !> Errors of K_I and K_II of the tips by those of the load of the faces [Pa m^1/2].
   function load_errors_of(self) result(of_k)
      class(two_levels_t), intent(in) :: self
      real(rk) :: of_k(2, size(self%tip))

      of_k = load_errors(self%scene, self%problem, self%now%coarse, self%value_errors, self%tip)
   end function load_errors_of

   !> Report the growth of the last step.
   subroutine note_equilibrium(self, error)
      class(two_levels_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      call self%note_tips(.true., load_errors_of(self))
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
         call self%note_tips(load_errors=load_errors_of(self))
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

end submodule twolevel_simulation
