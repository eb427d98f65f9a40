!> Both levels of a scene with a fluid at one time: their state, and separately coarse mesh, model
!! and windows. A step begins from this state, and rejected tries restore it.
module twolevel_state
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_tolerances, only: same_place
   use base_timers, only: phase_mesh, phase_remesh, phase_tips, phase_transfer, timers_t
   use mesh_geometry, only: cell_area
   use coarse_in_situ, only: in_situ_state_t
   use coarse_model, only: give_back, new_state, no_profiles, profiles_t, rest_fluid
   use coarse_state, only: fracture_cells_t, state_t, step_report_t
   use growth_front, only: growth_rules_t
   use growth_network, only: fracture_length, network_of_scene
   use mesh_builder, only: build_mesh, mesh_spec_t, remesh
   use mesh_types, only: fracture_mesh_t, mesh_map_t
   use scene_outline, only: outline_of_scene, outline_t
   use scene_types, only: scene_t
   use report_scene, only: follow_outlines, law_of_fracture, set_own_sizes, shape_body
   use report_simulation, only: simulation_t
   use twolevel_handover, only: hand_over
   use twolevel_levels_state, only: checkpoint_t, levels_state_t
   use twolevel_overlaps, only: fracture_overlaps, overlaps_t
   use twolevel_places, only: end_cell, shut_tips
   use twolevel_problem, only: coarse_problem_t, discard
   use twolevel_scales, only: pressure_scale
   use twolevel_schedule, only: follow_sides, last_switch
   use twolevel_stepping, only: first_step
   use twolevel_transfer, only: transfer_cells, transfer_state
   use twolevel_wells, only: rate, share_wells, transfer_shares
   use twolevel_unsolved, only: why_unsolved
   use twolevel_windows, only: windows_t
   implicit none(type, external)
   private

   public :: coarse_spec, two_levels_t

   !> share of the longest step: within this time no fluid moves noticeably [-]
   real(rk), parameter :: undrained_share = 1.0e-6_rk

   !> Relative deficit of K_eq within which tips grow along with the first: the two methods for the
   !! intensities differ by about as much [-].
   real(rk), parameter :: together = 0.01_rk

   !> Distance from the path within which ends and kinks of fractures lie on the path, in increments
   !! and in cells: no mesh of good quality fits between [-].
   real(rk), parameter :: near_way = 0.02_rk, near_in_mesh = 5.0e-3_rk

   !> Both levels; `network` is the fine network, which is ahead of the coarse one. A step changes
   !! tips, network and `now`; a rejected try is undone by `put_back` and nowhere else.
   type, abstract, extends(simulation_t) :: two_levels_t
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
   contains
      procedure :: mesh_levels
      procedure, private :: set_scales
      procedure :: begin_step
      procedure :: remember
      procedure :: put_back
      procedure :: present_state
      procedure :: follow_trend
      procedure :: equilibrate
      procedure :: try_step
      procedure :: step_error
      procedure :: errs
      procedure :: book_step
      procedure :: evaluate
      procedure :: has_reference
      procedure :: grow_coarse
      procedure :: remesh_coarse
   end type two_levels_t

contains

   !> Mesh, discretize and set the state before the load.
   subroutine mesh_levels(self, scene, timers, error)
      class(two_levels_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call self%set_scene(scene)
      call follow_sides(self%scene, 0.0_rk, 0.0_rk)
      self%start = network_of_scene(scene)
      self%network = self%start
      self%now%coarse_network = self%start
      self%rules = rules_of_scene(scene)
      allocate (self%problem)
      associate (problem => self%problem, mesh => self%problem%mesh, now => self%now)
         call timers%start(phase_mesh)
         call build_mesh(coarse_spec(scene), now%coarse_network, problem%mesher, mesh, error)
         call timers%stop(phase_mesh)
         if (allocated(error)) return
         call first_cells(self%scene, mesh%fracture, problem%model%cells)
         call share_wells(self%scene%injections, mesh%fracture, problem%share)
         call choose_first_step(self%scene, problem)
         call problem%model%set_mesh(mesh, self%scene, timers, error)
         if (allocated(error)) return
         call problem%feed_wells(self%scene, error)
         if (allocated(error)) return
         if (allocated(problem%model%in_situ)) then
            call rest_joints(problem%model%in_situ, mesh%fracture, problem%model%cells)
         end if
         call new_state(mesh, problem%model%cells, scene%initial, problem%model, now%coarse)
         call rest_wells(self)
         call self%find_tips(mesh%fracture)
      end associate
      call self%set_scales()
      if (scene%growth%intensities) then
         ! The body as reference has elements as large as the coarse cells; at the tips, where this
         ! matters, they are those of the windows.
         associate (coarser => 1.0_rk/scene%discretization%fine_ratio, &
                    is_body => scene%discretization%window_is_body)
            call self%windows%begin(self%tip, is_body, merge(1.0_rk, coarser, is_body), &
                                    self%now%windows)
            if (.not. is_body) call self%reference%begin(self%tip, .true., coarser, &
                                                         self%now%reference)
         end associate
      end if
      allocate (self%now%grown(0), self%now%segment(size(self%tip)))
      call self%now%interaction%begin(size(self%tip))
      call self%follow_trend(at_rest=.false.)
   end subroutine mesh_levels

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

   !> Begin a step: accept contact in the windows as evaluated last.
   subroutine begin_step(self)
      class(two_levels_t), intent(inout) :: self

      if (self%scene%growth%intensities) then
         call self%now%windows%accept()
         call self%now%reference%accept()
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

      self%front_state_t = self%last%front
      self%now = self%last%levels
      self%before = self%now%coarse
      if (self%scene%growth%intensities) then
         call self%windows%put_back()
         call self%reference%put_back()
      end if
      if (.not. allocated(self%kept_problem)) return
      call discard(self%problem)
      call move_alloc(self%kept_problem, self%problem)
      call self%windows%coarse_changed()
      call self%reference%coarse_changed()
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

      associate (n => int(self%problem%model%wells%n_all))
         self%now%at_limit = spread(.false., 1, n)
         self%now%given = spread(0.0_rk, 1, n)
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

      length = 0.0_rk
      do i = 1, size(self%scene%fractures)
         length = length + self%scene%fractures(i)%length()
      end do
      call self%now%trend%begin(self%now%coarse, at_rest, pressure_scale(self%scene), &
                                self%scene%material%young, length)
   end subroutine follow_trend

   !> Parameters of growth: with increments of prescribed length tips join targets at once, in
   !! equilibrium once the ligament breaks.
   pure function rules_of_scene(scene) result(rules)
      type(scene_t), intent(in) :: scene
      type(growth_rules_t) :: rules
      type(outline_t) :: outline
      integer(ik) :: f, n

      outline = outline_of_scene(scene)
      rules = growth_rules_t(toughness=scene%material%toughness, &
                             increment=scene%growth%increment, &
                             stop_gain=scene%growth%stop_gain, exponent=scene%growth%exponent, &
                             together=together, &
                             joins=scene%growth%law /= "equilibrium", heads=.true., &
                             near=max(near_way*scene%growth%increment, &
                                      near_in_mesh*scene%discretization%size_fracture), &
                             outline=outline%corners)
      n = size(scene%fractures, kind=ik)
      if (all(.not. scene%fractures%increment > 0.0_rk) .and. &
          all(.not. scene%fractures%cell_size > 0.0_rk)) return
      rules%own_increment = [(scene%increment_of(f), f=1, n)]
      rules%increment = minval(rules%own_increment)
      rules%own_near = [(max(near_way*scene%increment_of(f), &
                             near_in_mesh*scene%cell_size_of(f)), f=1, n)]
   end function rules_of_scene

   !> Specification of the coarse mesh.
   pure function coarse_spec(scene) result(spec)
      type(scene_t), intent(in) :: scene
      type(mesh_spec_t) :: spec

      spec = mesh_spec_t(x_min=scene%domain%x_min, x_max=scene%domain%x_max, &
                         y_min=scene%domain%y_min, y_max=scene%domain%y_max, &
                         size_fracture=scene%discretization%size_fracture, &
                         size_boundary=scene%discretization%size_boundary)
      if (size(scene%fractures) == 0) spec%size_fracture = spec%size_boundary
      call set_own_sizes(scene, spec)
      call shape_body(scene, spec)
      if (allocated(scene%regions)) call follow_outlines(scene%regions, scene%domain, spec)
   end function coarse_spec

   !> Contact law and residual aperture of the fracture cells of the scene.
   pure subroutine first_cells(scene, fracture, cells)
      type(scene_t), intent(in) :: scene
      type(fracture_mesh_t), intent(in) :: fracture
      type(fracture_cells_t), intent(inout) :: cells
      integer(ik) :: i

      associate (n => fracture%n_cells)
         allocate (cells%law(n), cells%residual_aperture(n))
         allocate (cells%injection(n), cells%roughness(n), source=0.0_rk)
      end associate
      do i = 1, fracture%n_cells
         associate (given => scene%fractures(fracture%cell_fracture(i)))
            cells%law(i) = law_of_fracture(given)
            cells%residual_aperture(i) = given%aperture
         end associate
      end do
      if (any(scene%fractures%skin > 0.0_rk)) then
         cells%skin = scene%fractures(fracture%cell_fracture)%skin
      end if
   end subroutine first_cells

   !> Joints are closed under the stress in situ without a jump: subtract this closure.
   pure subroutine rest_joints(in_situ, fracture, cells)
      type(in_situ_state_t), intent(in) :: in_situ
      type(fracture_mesh_t), intent(in) :: fracture
      type(fracture_cells_t), intent(inout) :: cells
      real(rk) :: closed, slope
      integer(ik) :: i

      if (.not. in_situ%is_held) return
      do i = 1, fracture%n_cells
         if (.not. cells%law(i)%compliance > 0.0_rk) cycle
         call cells%law(i)%closure(in_situ%contact_pressure(fracture, i), closed, slope)
         cells%law(i)%closure_at_rest = closed
         cells%residual_aperture(i) = cells%residual_aperture(i) - closed
      end do
   end subroutine rest_joints

   !> Undrained response to the load with fractures in equilibrium with the rock (model.md section
   !! 9).
   subroutine equilibrate(self, timers, report, error)
      class(two_levels_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error

      self%now%undrained = .true.
      call self%problem%model%equilibrate(self%problem%mesh, &
                                          undrained_share*self%scene%time%longest(), &
                                          self%now%coarse, timers, report, error)
      if (.not. allocated(error)) call explain(self, 0.0_rk, report)
      call rest_wells(self)
   end subroutine equilibrate

   !> Try one step of the coarse level. Nothing changes unless it converges.
   subroutine try_step(self, dt, timers, report, error)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error

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
      associate (wells => self%scene%injections)
         report%reason = why_unsolved(report, self%now%coarse_network, &
                                      self%problem%mesh%fracture, wells, self%problem%share, &
                                      rate(wells, self%now%coarse%time, dt))
      end associate
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
         error = trend%step_error(self%before, self%now%coarse, dt, area, model%condensed%length)
         if (model%wells%n_all > 0 .and. trend%is_known()) then
            error = max(error, trend%volume_error(self%before%well_flow, &
                                                  self%now%coarse%well_flow, self%now%given, dt, &
                                                  least_volume(self, dt)))
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
            flow(model%wells%number) = state%well_flow
            self%now%given = self%now%given + dt*abs(state%well_flow)
         end if
         fluid%injected = fluid%injected + dt*sum(flow)
         fluid%produced = fluid%produced - dt*sum(min(flow, 0.0_rk))
         if (self%problem%mesh%fracture%n_cells == 0) return
         fluid%leaked = fluid%leaked + dt*sum(state%leakoff*model%condensed%length)
         if (model%joints%n == 0) return
         fluid%outflow = fluid%outflow + dt*model%joints%outflow(state%branch_flow)
      end associate
   end subroutine book_step

   !> Stress intensity factors of the active tips, in windows on the present network.
   subroutine evaluate(self, timers, error)
      class(two_levels_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      logical :: active(size(self%tip))
      integer(ik) :: i

      call timers%heed(error)
      if (allocated(error)) return
      active = .true.
      if (allocated(self%now%active)) active = self%now%active
      associate (now => self%now)
         call follow_sides(self%scene, now%coarse%time, now%coarse%time)
         call timers%start(phase_tips)
         self%tip%is_shut = .false.
         self%tip%is_carried = .false.
         if (self%problem%mesh%fracture%n_cells > 0) then
            self%tip%is_shut = shut_tips(self%tip, now%segment, self%problem%mesh%fracture, &
                                         now%coarse%jump)
         end if
         call carry_intensities(self)
         active = active .and. self%tip%is_loaded()
         call self%problem%find_values(now%coarse)
         call self%windows%evaluate(self%scene, self%network, self%tip, active, &
                                    self%has_reference(), self%problem, now%coarse, &
                                    now%undrained, now%windows, error)
         call timers%stop(phase_tips)
         do i = 1, size(self%tip, kind=ik)
            if (.not. self%tip(i)%is_shut) cycle
            call self%tip(i)%shut()
            now%windows%tip(i)%found = self%tip(i)%intensity
            call now%windows%tip(i)%forget_coarse_error()
         end do
         do i = 1, size(self%tip, kind=ik)
            if (.not. active(i)) cycle
            now%windows%tip(i)%jump_then = tip_jump(self, i)
            now%windows%tip(i)%place_then = self%tip(i)%xy
         end do
      end associate
   end subroutine evaluate

   !> In a network, tips far below their toughness keep their intensities as long as the jump of the
   !! coarse cell behind them is nearly constant: K is proportional to the jump. The change of the
   !! jump since the last evaluation is part of their error.
   subroutine carry_intensities(self)
      class(two_levels_t), intent(inout) :: self
      integer, parameter :: few = 8  ! tips are all evaluated
      real(rk), parameter :: constant = 0.1_rk  ! change of a jump that carries an intensity [-]
      real(rk), parameter :: far = 0.5_rk  ! lack of toughness, error included [-]
      real(rk) :: change
      integer(ik) :: i

      if (.not. self%scene%growth%enabled .or. count(self%tip%is_loaded()) <= few) return
      associate (toughness => self%rules%toughness)
         do i = 1, size(self%tip, kind=ik)
            associate (tip => self%tip(i), seen => self%now%windows%tip(i))
               if (.not. tip%is_loaded() .or. norm2(tip%xy - seen%place_then) > 0.0_rk) cycle
               if (.not. self%windows%has_mesh(i)) cycle
               if (tip%excess(toughness) + tip%relative_error(toughness) > -far) cycle
               change = norm2(tip_jump(self, i) - seen%jump_then)
               if (change > constant*norm2(seen%jump_then)) cycle
               change = change/max(norm2(seen%jump_then), tiny(1.0_rk))
               call tip%carry(self%windows%intensity_of(i, seen), change)
            end associate
         end do
      end associate
   end subroutine carry_intensities

   !> Mean opening and slip of the coarse cell behind a tip [m].
   pure function tip_jump(self, i) result(jump)
      class(two_levels_t), intent(in) :: self
      integer(ik), intent(in) :: i
      real(rk) :: jump(2)

      jump = 0.5_rk*sum(self%now%coarse%jump(:, :, end_cell(self%problem%mesh%fracture, &
                                                            self%tip(i))), dim=2)
   end function tip_jump

   !> The windows are held against the whole body as one window.
   pure logical function has_reference(self)
      class(two_levels_t), intent(in) :: self

      has_reference = .not. self%scene%discretization%window_is_body .and. &
                      self%problem%mesh%fracture%n_cells <= self%reference_most
   end function has_reference

   !> Extend the coarse network by the growth of the tips, if it has reached the threshold, or if no
   !! growth follows.
   subroutine grow_coarse(self, grew, timers, error)
      class(two_levels_t), intent(inout) :: self
      logical, intent(out) :: grew
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: centres(:, :)
      logical :: is_straightened
      real(rk) :: threshold

      threshold = self%scene%growth%threshold*self%scene%discretization%size_fracture
      if (any(self%has_gained())) threshold = same_place*self%rules%increment
      call hand_over(threshold, self%network, self%tip, self%now%coarse_network, centres, &
                     is_straightened)
      grew = size(centres, 2) > 0
      if (.not. grew) return
      if (is_straightened) then
         call self%windows%network_changed()
         call self%reference%network_changed()
      end if
      call self%remesh_coarse(centres, timers, error)
      call discard(self%kept_problem)
   end subroutine grow_coarse

   !> Remesh the coarse network around the points where it has changed, and transfer the state.
   subroutine remesh_coarse(self, centres, timers, error)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: centres(:, :)  !< (2, n) [m]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(coarse_problem_t), allocatable :: problem
      type(mesh_map_t) :: map
      type(profiles_t) :: profiles
      real(rk) :: radius
      integer(ik) :: i, k, nearest

      call timers%heed(error)
      if (allocated(error)) return
      allocate (problem)
      radius = 0.0_rk  ! the largest of those of the tips that have gone on
      do i = 1, size(centres, 2, kind=ik)
         nearest = minloc([(norm2(self%tip(k)%xy - centres(:, i)), k=1, size(self%tip))], dim=1)
         associate (f => self%tip(nearest)%fracture)
            radius = max(radius, 5.0_rk*self%rules%increment_of(f), &
                         3.0_rk*self%scene%cell_size_of(f))
         end associate
      end do
      call timers%start(phase_remesh)
      call remesh(self%problem%mesher, self%now%coarse_network, centres, radius, &
                  self%scene%smallest_cell(), problem%mesher, problem%mesh, map, error)
      call timers%stop(phase_remesh)
      if (allocated(error)) return
      call timers%start(phase_transfer)
      associate (layers => self%problem%model%layers, state => self%now%coarse)
         if (layers%n > 0) then
            profiles = layers%profiles(state%unknowns, state%layer)
            call layers%set_apart(map%cell_old, map%fracture_cell_old, state%unknowns, &
                                  state%content, profiles)
         else
            profiles = no_profiles()
         end if
      end associate
      call transfer_levels(self%scene, self%problem, map, problem, self%now)
      call timers%stop(phase_transfer)
      if (.not. allocated(self%kept_problem)) call move_alloc(self%problem, self%kept_problem)
      call discard(self%problem)
      call move_alloc(problem, self%problem)
      call self%windows%coarse_changed()
      call self%reference%coarse_changed()
      call choose_first_step(self%scene, self%problem)
      call self%problem%model%set_mesh(self%problem%mesh, self%scene, timers, error)
      if (allocated(error)) return
      call transfer_layers(self%problem, profiles, map, self%now%coarse)
      call self%problem%feed_wells(self%scene, error)
      if (allocated(error)) return
      call rest_fluid(self%problem%model, self%now%coarse)
      self%now%has_new_mesh = .true.
   end subroutine remesh_coarse

   !> Set the first step of the run, which determines where layers are resolved.
   subroutine choose_first_step(scene, problem)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(inout) :: problem

      if (scene%discretization%layers == "auto") problem%model%first_step = first_step(scene%time)
   end subroutine choose_first_step

   !> Transfer the pressures in layers to a new coarse mesh, after all else.
   subroutine transfer_layers(problem, profiles, map, state)
      type(coarse_problem_t), intent(in) :: problem  !< with the new mesh
      type(profiles_t), intent(in) :: profiles  !< before
      type(mesh_map_t), intent(in) :: map
      type(state_t), intent(inout) :: state

      associate (layers => problem%model%layers, mesh => problem%mesh)
         if (layers%n == 0) then
            call give_back(profiles, spread(.false., 1, size(profiles%cell)), mesh, &
                           map%fracture_cell_old, state%content)
            return
         end if
         call insert_layers(mesh%n_cells, layers%n, state%unknowns)
         call layers%take_profiles(profiles, mesh, map%cell_old, map%fracture_cell_old, &
                                   state%unknowns, state%layer, state%content)
      end associate
   end subroutine transfer_layers

   !> Insert the blocks of layers after those of the cells.
   pure subroutine insert_layers(n_cells, n_layers, unknowns)
      integer(ik), intent(in) :: n_cells, n_layers
      real(rk), allocatable, intent(inout) :: unknowns(:, :)  !< (3, blocks)
      real(rk), allocatable :: with_layers(:, :)

      allocate (with_layers(3, size(unknowns, 2) + n_layers), source=0.0_rk)
      with_layers(:, :n_cells) = unknowns(:, :n_cells)
      with_layers(:, n_cells + n_layers + 1:) = unknowns(:, n_cells + 1:)
      call move_alloc(with_layers, unknowns)
   end subroutine insert_layers

   !> Transfer cells, wells and state to a new coarse mesh.
   subroutine transfer_levels(scene, old, map, new, now)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: old
      type(mesh_map_t), intent(in) :: map
      type(coarse_problem_t), intent(inout) :: new
      type(levels_state_t), intent(inout) :: now
      type(state_t) :: state
      type(overlaps_t) :: overlaps
      real(rk) :: prefilled
      integer(ik) :: i
      logical :: is_prefilled

      is_prefilled = scene%growth%new_volume == "prefilled"
      call transfer_cells(old%mesh, new%mesh, old%model%cells, scene%growth%new_aperture, &
                          is_prefilled, new%model%cells)
      call transfer_state(map, old%mesh, new%mesh, new%model%cells, is_prefilled, now%coarse, &
                          state, prefilled)
      associate (before => old%mesh%fracture, after => new%mesh%fracture)
         new%share = transfer_shares(scene%injections, before, after, old%share)
         overlaps = fracture_overlaps(before, after)
         now%grown = pack([(i, i=1, after%n_cells)], overlaps%is_new([(i, i=1, after%n_cells)]))
      end associate
      now%coarse = state
      call now%trend%transfer(map)
      now%fluid%prefilled = now%fluid%prefilled + prefilled
   end subroutine transfer_levels

end module twolevel_state
