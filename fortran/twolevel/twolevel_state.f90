!> Both levels of a scene with a fluid at one time: network, coarse mesh, model and state, windows
!! around the tips, and the bookkeeping of fluid.
module twolevel_state
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: phase_mesh, phase_remesh, phase_tips, phase_transfer, timers_t
   use base_tolerances, only: same_place
   use coarse_model, only: new_state, rest_fluid
   use coarse_nodes, only: nodal_fields
   use coarse_own_pressure, only: own_pressure
   use coarse_state, only: fracture_cells_t, state_t, step_report_t
   use growth_front, only: growth_rules_t, prepared_t
   use growth_network, only: network_of_scene
   use growth_rivals, only: company_t, rivals_t
   use growth_segment, only: segment_t
   use mesh_builder, only: build_mesh, mesh_spec_t, mesher_t, remesh, transfer_mesher
   use mesh_geometry, only: cell_area
   use mesh_types, only: mesh_map_t, mesh_t, network_t
   use report_scene, only: follow_outlines, law_of_fracture, shape_body
   use scene_outline, only: outline_of_scene, outline_t
   use scene_types, only: scene_t
   use twolevel_certainty, only: certainty_t
   use twolevel_fed, only: fed_level_t
   use twolevel_handover, only: hand_over
   use twolevel_overlaps, only: fracture_overlaps, overlaps_t
   use twolevel_scales, only: pressure_scale
   use twolevel_schedule, only: follow_sides, last_switch
   use twolevel_transfer, only: transfer_cells, transfer_state
   use twolevel_trend, only: trend_t
   use twolevel_unsolved, only: why_unsolved
   use twolevel_wells, only: rate, share_wells, transfer_shares
   use twolevel_window, only: coarse_values_t
   use twolevel_windows, only: windows_t
   implicit none(type, external)
   private

   public :: coarse_spec, remesh_coarse, two_levels_t

   real(rk), parameter :: undrained_share = 1.0e-6_rk  !< of a step: no fluid moves noticeably in it

   !> Share of the toughness that tips may lack to grow together with the first: the two methods for
   !! the intensities differ by about as much.
   real(rk), parameter :: together = 0.01_rk

   !> Ends and kinks lie on the way of a tip that passes them nearer than that, in increments and in
   !! cells: no mesh of good shape fits between.
   real(rk), parameter :: near_way = 0.02_rk, near_in_mesh = 5.0e-3_rk

   !> Both levels; `network` is that of the fine one, which is ahead of the coarse one.
   type, abstract, extends(fed_level_t) :: two_levels_t
      type(network_t) :: coarse_network
      type(state_t) :: before  !< the step that led there, on the same mesh
      type(trend_t) :: trend  !< rates of the last accepted step
      type(windows_t) :: windows
      type(windows_t) :: reference  !< the body as one window, against which these are held
      integer(ik) :: reference_most = 800  !< coarse fracture cells up to which they are
      !> (tips) those that are evaluated; unallocated: all. Tries of a step need no others.
      logical, allocatable :: asked(:)
      type(coarse_values_t) :: coarse_values
      logical :: values_are_current = .false.
      logical :: undrained = .false.  !< the state is the undrained response to the load
      integer(ik), allocatable :: grown(:)  !< fracture cells that the last growth added
      type(segment_t), allocatable :: segment(:)  !< (tips) that the paths end with
      type(prepared_t), allocatable :: prepared(:)  !< (tips) pieces that the coarse mesh has
      type(rivals_t) :: rivals  !< how the tips act on each other
      type(company_t) :: company  !< which of them grow as one
      type(certainty_t) :: certainty  !< how well lengths and pressures are known
      logical :: has_new_mesh = .false.  !< since the last accepted state
      real(rk) :: injected = 0.0_rk  !< so far, less what was produced [m2]
      real(rk) :: produced = 0.0_rk  !< that wells have drawn so far [m2]
      real(rk) :: leaked = 0.0_rk  !< from the fractures into the rock so far [m2]
      real(rk) :: outflow = 0.0_rk  !< through ends of fractures on the boundary so far [m2]
      real(rk) :: prefilled = 0.0_rk  !< brought along by new fracture cells so far [m2]
   contains
      procedure :: mesh_levels
      procedure :: follow_trend
      procedure :: equilibrate
      procedure :: try_step
      procedure :: step_error
      procedure :: errs
      procedure :: book_step
      procedure :: update_values
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
      self%coarse_network = self%start
      self%rules = rules_of_scene(scene)
      call timers%start(phase_mesh)
      call build_mesh(coarse_spec(scene), self%coarse_network, self%mesher, self%mesh, error)
      call timers%stop(phase_mesh)
      if (allocated(error)) return
      call first_cells(self)
      call share_wells(self%scene%injections, self%mesh%fracture, self%share)
      call self%model%set_mesh(self%mesh, self%scene, timers, error)
      if (allocated(error)) return
      call self%feed_wells(error)
      if (allocated(error)) return
      call rest_joints(self)
      call new_state(self%mesh, self%model%cells, scene%initial, self%model, self%state)
      call self%rest_wells()
      call self%find_tips(self%mesh%fracture)
      if (scene%growth%intensities) then
         ! The body beside windows has elements as large as the coarse cells: at the tips, where it
         ! matters, they are those of the windows.
         associate (fine => scene%discretization, is_body => scene%discretization%window_is_body)
            call self%windows%begin(self%tip, is_body, merge(1.0_rk, 1.0_rk/fine%fine_ratio, &
                                                             is_body))
            if (.not. is_body) call self%reference%begin(self%tip, .true., 1.0_rk/fine%fine_ratio)
         end associate
      end if
      allocate (self%grown(0), self%segment(size(self%tip)), self%prepared(size(self%tip)))
      call self%rivals%begin(size(self%tip))
      call self%follow_trend(at_rest=.false.)
   end subroutine mesh_levels

   !> Rates are known from now on: none at rest, else those of the next step.
   subroutine follow_trend(self, at_rest)
      class(two_levels_t), intent(inout) :: self
      logical, intent(in) :: at_rest
      real(rk) :: length
      integer :: i

      length = 0.0_rk
      do i = 1, size(self%scene%fractures)
         length = length + self%scene%fractures(i)%length()
      end do
      call self%trend%begin(self%state, at_rest, pressure_scale(self%scene), &
                            self%scene%material%young, length)
   end subroutine follow_trend

   !> How tips grow: they join what lies ahead of them, by the law of advances at once, as they come
   !! near to it.
   pure function rules_of_scene(scene) result(rules)
      type(scene_t), intent(in) :: scene
      type(growth_rules_t) :: rules
      type(outline_t) :: outline

      outline = outline_of_scene(scene)
      rules = growth_rules_t(toughness=scene%material%toughness, &
                             increment=scene%growth%increment, &
                             stop_gain=scene%growth%stop_gain, exponent=scene%growth%exponent, &
                             together=together, &
                             joins=scene%growth%law /= "equilibrium", heads=.true., &
                             near=max(near_way*scene%growth%increment, &
                                      near_in_mesh*scene%discretization%size_fracture), &
                             outline=outline%corners)
   end function rules_of_scene

   !> What to mesh.
   pure function coarse_spec(scene) result(spec)
      type(scene_t), intent(in) :: scene
      type(mesh_spec_t) :: spec

      spec = mesh_spec_t(x_min=scene%domain%x_min, x_max=scene%domain%x_max, &
                         y_min=scene%domain%y_min, y_max=scene%domain%y_max, &
                         size_fracture=scene%discretization%size_fracture, &
                         size_boundary=scene%discretization%size_boundary)
      if (size(scene%fractures) == 0) spec%size_fracture = spec%size_boundary
      call shape_body(scene, spec)
      if (allocated(scene%regions)) call follow_outlines(scene%regions, scene%domain, spec)
   end function coarse_spec

   !> Law and residual aperture of the scene's fracture cells.
   pure subroutine first_cells(self)
      class(two_levels_t), intent(inout) :: self
      integer(ik) :: i

      associate (fracture => self%mesh%fracture, cells => self%model%cells)
         allocate (cells%law(fracture%n_cells), cells%residual_aperture(fracture%n_cells))
         allocate (cells%injection(fracture%n_cells), cells%roughness(fracture%n_cells), &
                   source=0.0_rk)
         do i = 1, fracture%n_cells
            associate (given => self%scene%fractures(fracture%cell_fracture(i)))
               cells%law(i) = law_of_fracture(given)
               cells%residual_aperture(i) = given%aperture
            end associate
         end do
         if (any(self%scene%fractures%skin > 0.0_rk)) then
            cells%skin = self%scene%fractures(fracture%cell_fracture)%skin
         end if
      end associate
   end subroutine first_cells

   !> Joints fit each other under the stress in situ: what it closes them by is no jump.
   pure subroutine rest_joints(self)
      class(two_levels_t), intent(inout) :: self
      real(rk) :: closed, pressure, slope
      integer(ik) :: i

      if (.not. allocated(self%model%in_situ)) return
      if (.not. self%model%in_situ%is_held) return
      associate (cells => self%model%cells)
         do i = 1, self%mesh%fracture%n_cells
            if (.not. cells%law(i)%compliance > 0.0_rk) cycle
            pressure = self%model%in_situ%contact_pressure(self%mesh%fracture, i)
            call cells%law(i)%closure(pressure, closed, slope)
            cells%law(i)%closure_at_rest = closed
            cells%residual_aperture(i) = cells%residual_aperture(i) - closed
         end do
      end associate
   end subroutine rest_joints

   !> Undrained response to the load with fractures in equilibrium with the rock (model.md section
   !! 9).
   subroutine equilibrate(self, timers, report, error)
      class(two_levels_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error

      self%values_are_current = .false.
      self%undrained = .true.
     call self%model%equilibrate(self%mesh, undrained_share*self%scene%time%longest(), self%state, &
                                  timers, report, error)
      if (.not. allocated(error)) call explain(self, 0.0_rk, report)
      call self%rest_wells()
   end subroutine equilibrate

   !> One step of the coarse level, not yet accepted. Nothing changes unless it converges.
   subroutine try_step(self, dt, timers, report, error)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error

      if (any(self%model%sides%changes())) then
         call follow_sides(self%scene, self%state%time + dt, self%state%time)
         call self%model%change_sides(self%mesh, self%scene, timers, error)
         if (allocated(error)) return
      end if
      call self%ask(dt)
      call self%model%advance(self%mesh, dt, self%state, timers, report, error)
      if (.not. allocated(error)) call explain(self, dt, report)
      if (allocated(error) .or. .not. report%converged) return
      self%values_are_current = .false.
      self%undrained = .false.
   end subroutine try_step

   !> Put the reason why a step is not solved in the words of the scene.
   subroutine explain(self, dt, report)
      class(two_levels_t), intent(in) :: self
      real(rk), intent(in) :: dt  !< [s]
      type(step_report_t), intent(inout) :: report

      if (report%converged) return
      associate (wells => self%scene%injections)
         report%reason = why_unsolved(report, self%coarse_network, self%mesh%fracture, wells, &
                                      self%share, rate(wells, self%state%time, dt))
      end associate
   end subroutine explain

   !> Error in time of the state that a step of length dt has led to, relative [-].
   function step_error(self, dt) result(error)
      class(two_levels_t), intent(in) :: self
      real(rk), intent(in) :: dt  !< [s]
      real(rk) :: error
      real(rk) :: area(self%mesh%n_cells)
      integer(ik) :: c

      do c = 1, self%mesh%n_cells
         area(c) = cell_area(self%mesh, c)
      end do
      error = self%trend%step_error(self%before, self%state, dt, area, self%model%condensed%length)
      if (self%model%wells%n_all > 0 .and. self%trend%is_known()) then
         error = max(error, self%trend%volume_error(self%before%well_flow, self%state%well_flow, &
                                                    self%given, dt, least_volume(self, dt)))
      end if
   end function step_error

   !> What a well has given is taken for at least this, when its error in a step of length dt is
   !! judged: a small share of what the well that gives most has given since the last switch, and
   !! more than the rounding of the fluid that is there [m2].
   pure real(rk) function least_volume(self, dt) result(least)
      class(two_levels_t), intent(in) :: self
      real(rk), intent(in) :: dt  !< [s]
      real(rk), parameter :: share = 0.01_rk, trace = 1.0e-10_rk
      real(rk) :: fluid, most

      associate (state => self%state, wells => self%scene%injections, since => &
                 self%before%time + dt - last_switch(self%scene, self%before%time))
         most = maxval([self%given + dt*abs(state%well_flow), &
                        since*abs(rate(wells, self%before%time, dt))])
         fluid = sum(self%model%condensed%length*state%aperture) &
                 + self%trend%least_pressure*sum(self%model%matrix%storage)
      end associate
      least = max(share*most, trace*fluid)
   end function least_volume

   !> The error of a step is larger than the scene tolerates.
   pure logical function errs(self, error)
      class(two_levels_t), intent(in) :: self
      real(rk), intent(in) :: error  !< relative [-]

      associate (tolerance => self%scene%time%tolerance)
         errs = tolerance > 0.0_rk .and. error > tolerance
      end associate
   end function errs

   !> The fluid of an accepted step.
   subroutine book_step(self, dt)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      real(rk) :: flow(size(self%scene%injections))

      ! Not what the model has as its sources: that is from its last try.
      flow = rate(self%scene%injections, self%before%time, dt)
      if (self%model%wells%n_all > 0) then
         flow(self%model%wells%number) = self%state%well_flow
         self%given = self%given + dt*abs(self%state%well_flow)
      end if
      self%injected = self%injected + dt*sum(flow)
      self%produced = self%produced - dt*sum(min(flow, 0.0_rk))
      if (self%mesh%fracture%n_cells > 0) then
         self%leaked = self%leaked + dt*sum(self%state%leakoff*self%model%condensed%length)
         if (self%model%joints%n > 0) then
            self%outflow = self%outflow + dt*self%model%joints%outflow(self%state%branch_flow)
         end if
      end if
   end subroutine book_step

   !> Coarse values at the mesh's nodes, for windows and probes.
   subroutine update_values(self)
      class(two_levels_t), intent(inout) :: self

      if (self%values_are_current) return
      associate (values => self%coarse_values, model => self%model, state => self%state, &
                 n => self%mesh%n_nodes)
         if (allocated(values%nodal)) deallocate (values%nodal, values%displacement, &
                                                  values%gradient)
         allocate (values%nodal(3, n), values%displacement(2, n), values%gradient(2, 2, n))
         call nodal_fields(self%mesh, model%rock, model%regions, state%unknowns, state%tractions, &
                           values%nodal, values%displacement, values%gradient)
         values%nodal(3, :) = own_pressure(self%mesh, state%unknowns(3, :self%mesh%n_cells), &
                                           values%nodal(3, :), state%pressure)
         values%law = model%cells%law
         values%is_grown = model%cells%roughness > 0.0_rk
      end associate
      self%values_are_current = .true.
   end subroutine update_values

   !> Stress intensity factors of the tips asked for, in windows on the present network.
   subroutine evaluate(self, timers, error)
      class(two_levels_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      logical :: asked(size(self%tip))

      call timers%heed(error)
      if (allocated(error)) return
      asked = .true.
      if (allocated(self%asked)) asked = self%asked
      call follow_sides(self%scene, self%state%time, self%state%time)
      call timers%start(phase_tips)
      call self%update_values()
      self%windows%window%is_beside_body = self%has_reference()
      call self%windows%evaluate(self%scene, self%network, self%tip, asked, self%mesher, &
                                 self%mesh, self%coarse_values, self%state, self%undrained, error)
      call timers%stop(phase_tips)
   end subroutine evaluate

   !> The windows are held against the whole body as one window.
   pure logical function has_reference(self)
      class(two_levels_t), intent(in) :: self

      has_reference = .not. self%scene%discretization%window_is_body .and. &
                      self%mesh%fracture%n_cells <= self%reference_most
   end function has_reference

   !> Let the coarse level follow what the tips have grown, if that has reached its threshold, or if
   !! nothing is to grow after it.
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
      call hand_over(threshold, self%network, self%tip, self%coarse_network, centres, &
                     is_straightened)
      grew = size(centres, 2) > 0
      if (.not. grew) return
      if (is_straightened) then
         call self%windows%network_changed()
         call self%reference%network_changed()
      end if
      call self%remesh_coarse(centres, timers, error)
   end subroutine grow_coarse

   !> A mesh of the coarse network, new around the places where that has grown; the state goes
   !! along.
   subroutine remesh_coarse(self, centres, timers, error)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: centres(:, :)  !< (2, n) [m]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(mesher_t) :: mesher
      type(mesh_t) :: mesh
      type(mesh_map_t) :: map

      call timers%heed(error)
      if (allocated(error)) return
      associate (size_fracture => self%scene%discretization%size_fracture)
         call timers%start(phase_remesh)
         call remesh(self%mesher, self%coarse_network, centres, &
                     max(5.0_rk*self%rules%increment, 3.0_rk*size_fracture), size_fracture, &
                     mesher, mesh, map, error)
         call timers%stop(phase_remesh)
      end associate
      if (allocated(error)) return
      call timers%start(phase_transfer)
      call transfer_mesher(mesher, self%mesher)
      call transfer_levels(self, mesh, map)
      call timers%stop(phase_transfer)
      call self%model%set_mesh(self%mesh, self%scene, timers, error)
      if (allocated(error)) return
      call self%feed_wells(error)
      if (allocated(error)) return
      call rest_fluid(self%model, self%state)
   end subroutine remesh_coarse

   !> Carry cells, state and wells over to a new coarse mesh.
   subroutine transfer_levels(self, mesh, map)
      class(two_levels_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh  !< the new one
      type(mesh_map_t), intent(in) :: map
      type(state_t) :: state
      type(fracture_cells_t) :: cells
      type(overlaps_t) :: overlaps
      real(rk) :: prefilled
      integer(ik) :: i
      logical :: is_prefilled

      is_prefilled = self%scene%growth%new_volume == "prefilled"
      call transfer_cells(self%mesh, mesh, self%model%cells, self%scene%growth%new_aperture, &
                          is_prefilled, cells)
      call transfer_state(map, self%mesh, mesh, cells, is_prefilled, self%state, state, prefilled)
      self%share = transfer_shares(self%scene%injections, self%mesh%fracture, mesh%fracture, &
                                   self%share)
      overlaps = fracture_overlaps(self%mesh%fracture, mesh%fracture)
      self%grown = pack([(i, i=1, mesh%fracture%n_cells)], &
                        overlaps%is_new([(i, i=1, mesh%fracture%n_cells)]))
      self%mesh = mesh
      self%model%cells = cells
      self%state = state
      call self%trend%transfer(map)
      self%prefilled = self%prefilled + prefilled
      self%values_are_current = .false.
      call self%windows%coarse_changed()
      call self%reference%coarse_changed()
   end subroutine transfer_levels

end module twolevel_state
