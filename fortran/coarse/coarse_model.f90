!> The coarse level: Biot's equations in the rock, contact and flow in the fractures, one time step
!! at a time. The rock is discretized once per mesh and factorized once per length of the time step;
!! a step then costs one substitution and a few small Newton steps on the fractures.
module coarse_model
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_timers, only: phase_assemble, phase_contact, phase_discretize, phase_factorize, &
                          phase_solve, timers_t
   use base_tolerances, only: same_time
   use contact_law, only: state_stick
   use coarse_tips, only: crack_ends_t, dampers, free_ends, jumps_of, place_tips, tip_springs
   use coarse_diffusion, only: boundary_outflow, cell_outflow
   use coarse_fields, only: cell_contents, corner_tractions
   use coarse_fluid_law, only: add_fracture_balance
   use coarse_fractures, only: flow_paths_t, newton_settings_t
   use mesh_geometry, only: fracture_cell_centre
   use coarse_in_situ, only: find_in_situ, in_situ_state_t
   use coarse_layers, only: give_back, layers_t, no_profiles, place_layers, profiles_t
   use coarse_joints, only: find_joints, joints_t, renew_outlets
   use coarse_matrix, only: matrix_t
   use coarse_newton, only: fracture_problem_t, solve_fractures
   use coarse_loads, only: add_point_forces, find_weight, hold_points
   use coarse_regions, only: regions_t
   use coarse_permeability, only: place_regions, relative_resistance
   use coarse_rock, only: new_rock, rock_t, solid_t
   use coarse_wells, only: control_rate, rock_wells_t, wells_t
   use coarse_state, only: fracture_cells_t, go_back, state_t, step_report_t
   use coarse_stencils, only: discretize, renew_sides
   use mesh_types, only: mesh_t, point_interior
   use scene_fluid_law, only: has_law, new_fluid_law
   use scene_outline, only: sides_of_scene
   use scene_sides, only: boundary_side_t
   use scene_types, only: initial_t, scene_t
   implicit none(type, external)
   private

   public :: coarse_model_t, give_back, new_state, no_profiles, profiles_t, rest_fluid

   !> Discretized body on one mesh.
   type, extends(fracture_problem_t) :: coarse_model_t
      type(rock_t) :: rock
      type(boundary_side_t), allocatable :: sides(:)  !< pressures beyond those in situ
      type(in_situ_state_t), allocatable :: in_situ  !< beyond which pressures and stresses count
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      type(layers_t) :: layers
      real(rk) :: first_step = huge(1.0_rk)  !< shortest first step of the run, for layers [s]
      type(rock_wells_t) :: rock_wells  !< those of them in the rock
      !> (fracture cells) resistance of the adjacent rock over that of the scene's rock; allocated
      !! with regions [-]
      real(rk), allocatable :: rock_resistance(:)
      type(crack_ends_t) :: ends  !< of the cracks
      logical :: drained = .false.  !< fluid may cross the outer boundary
      !> (3, n_cells) body force x, y [N/m] and fluid [m2/s]; none if absent
      real(rk), allocatable :: source(:, :)
      !> (2, n_cells) forces not balanced by the stress in situ: weight, point loads [N/m]
      real(rk), allocatable :: weight(:, :)
   contains
      procedure :: set_mesh
      procedure :: change_sides
      procedure :: equilibrate
      procedure :: advance
      procedure :: release
   end type coarse_model_t

contains

   !> Discretize on a mesh.
   subroutine set_mesh(self, mesh, scene, timers, error)
      class(coarse_model_t), intent(inout) :: self
      type(mesh_t), intent(inout) :: mesh  !< its layers are chosen
      type(scene_t), intent(in) :: scene
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call timers%start(phase_discretize)
      self%rock = new_rock(scene%material, scene%fluid)
      if (allocated(self%rock_resistance)) deallocate (self%rock_resistance)
      if (allocated(scene%regions)) then
         call place_regions(mesh, scene%regions, scene%domain, scene%fluid, self%rock)
         self%rock_resistance = relative_resistance(mesh, self%rock, scene%fluid%viscosity)
      end if
      call place_in_situ(self, mesh, scene)
      self%drained = any(self%sides%pressure_given .or. abs(self%sides%inflow) > 0.0_rk &
                         .or. self%sides%changes())
      associate (choice => scene%discretization, fluid => scene%fluid)
         self%settings = newton_settings_t(tolerance=choice%newton_tolerance, &
                                           iterations_max=choice%newton_max, &
                                           viscosity=fluid%viscosity, &
                                           mobility=self%rock%mobility, &
                                           compressibility=fluid%compressibility, &
                                           vapour_pressure=fluid%vapour_pressure, &
                                           damping=scene%material%radiation_damping, &
                                           young=scene%material%young)
         if (has_law(fluid)) then
            self%settings%fluid_law = new_fluid_law(fluid)
            ! A density law contains the compression.
            if (fluid%density_law /= "linear") self%settings%compressibility = 0.0_rk
         end if
      end associate
      if (self%first_step < huge(1.0_rk)) then
         call place_layers(mesh, self%rock, self%sides, self%first_step, self%layers)
      end if
      if (allocated(self%cells%has_layer)) deallocate (self%cells%has_layer)
      if (self%layers%n > 0) self%cells%has_layer = self%layers%on_sides(mesh%fracture%n_cells)
      call discretize(mesh, self%rock, self%sides, self%regions, self%matrix, error, self%in_situ, &
                      self%layers%relief)
      if (.not. allocated(error)) then
         call self%layers%add_tip_flow(mesh, self%rock, self%matrix)
         if (scene%has_points()) call hold_points(scene, mesh, self%matrix, self%weight)
         call find_connections(mesh, self%connections)
         call find_joints(mesh, self%sides, self%joints)
         if (allocated(self%in_situ)) then
            self%joints%pressure_in_situ = &
               self%in_situ%pressure_at(mesh%fracture%point_xy(2, self%joints%point))
         end if
      end if
      self%ends = free_ends(mesh%fracture)
      call self%condensed%forget(mesh, scene%discretization%condensation)
      call self%factors%release()
      call timers%stop(phase_discretize)
   end subroutine set_mesh

   !> Set the state in situ, if the scene has one, and the weight that it does not balance.
   subroutine place_in_situ(self, mesh, scene)
      class(coarse_model_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh
      type(scene_t), intent(in) :: scene
      real(rk) :: centre(2)
      real(rk), allocatable :: height(:)
      integer(ik) :: c

      call find_in_situ(scene, self%rock%biot(1), self%in_situ)
      call take_sides(self, scene)
      if (allocated(self%in_situ)) then
         allocate (height(mesh%fracture%n_cells))
         do c = 1, mesh%fracture%n_cells
            centre = fracture_cell_centre(mesh%fracture, c)
            height(c) = centre(2)
         end do
         self%cells%pressure_in_situ = self%in_situ%pressure_at(height)
      end if
      call find_weight(mesh, scene, self%in_situ, self%weight)
      if (scene%has_points() .and. .not. allocated(self%weight)) then
         allocate (self%weight(2, mesh%n_cells), source=0.0_rk)
      end if
      if (scene%has_points()) call add_point_forces(scene, mesh, self%weight)
   end subroutine place_in_situ

   !> Set the boundary conditions, relative to the state in situ.
   pure subroutine take_sides(self, scene)
      class(coarse_model_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene

      self%sides = sides_of_scene(scene)
      if (allocated(self%in_situ)) self%sides%pressure = self%sides%pressure - self%in_situ%pressure
   end subroutine take_sides

   !> Change the values of the boundary conditions; their kinds remain.
   subroutine change_sides(self, mesh, scene, timers, error)
      class(coarse_model_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh
      type(scene_t), intent(in) :: scene
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call timers%start(phase_assemble)
      call take_sides(self, scene)
     call renew_sides(mesh, self%rock, self%sides, self%regions, self%matrix, error, self%in_situ, &
                       self%layers%relief)
      if (self%joints%n > 0) call renew_outlets(mesh, self%sides, self%joints)
      call timers%stop(phase_assemble)
   end subroutine change_sides

   !> The state before anything happens: no displacement, uniform pressure.
   subroutine new_state(mesh, cells, initial, model, state)
      type(mesh_t), intent(in) :: mesh
      type(fracture_cells_t), intent(in) :: cells
      type(initial_t), intent(in) :: initial
      type(coarse_model_t), intent(in) :: model
      type(state_t), intent(out) :: state
      real(rk) :: pressure  ! [Pa]
      type(solid_t) :: solid
      integer(ik) :: c, n

      n = mesh%fracture%n_cells
      pressure = initial%pressure
      if (allocated(model%in_situ)) pressure = 0.0_rk
      allocate (state%unknowns(3, model%regions%n_blocks), source=0.0_rk)
      state%unknowns(3, :) = pressure
      allocate (state%content(mesh%n_cells))
      do c = 1, mesh%n_cells
         ! Content at zero strain: S p
         solid = model%rock%solid_at(c)
         state%content(c) = pressure*solid%storage*model%matrix%storage(c)/solid%storage_at_stress()
      end do
      allocate (state%jump(2, 2, n), state%traction(2, 2, n), state%leakoff(n), source=0.0_rk)
      allocate (state%slip_before(2, n), source=0.0_rk)
      if (any(cells%law%ages())) then
         allocate (state%slip_path(2, n), state%opened(2, n), state%opened_before(2, n), &
                   source=0.0_rk)
      end if
      state%unknowns(:2, :) = 0.0_rk
      if (model%layers%n > 0) call model%layers%begin(state%unknowns, state%layer)
      allocate (state%pressure(n), source=pressure)
      allocate (state%contact(2, n), source=state_stick)
      allocate (state%void(n), state%injection(n), source=0.0_rk)
      state%rock_well_control = spread(control_rate, 1, int(model%rock_wells%n))
      state%aperture = cells%residual_aperture
      call rest_fluid(model, state)
   end subroutine new_state

   !> Set all flows along the fractures to zero and the pressures of joints to those of the adjacent
   !! cells.
   subroutine rest_fluid(model, state)
      class(coarse_model_t), intent(in) :: model
      type(state_t), intent(inout) :: state
      integer(ik) :: j

      state%flow = spread(0.0_rk, 1, size(model%connections, 2))
      state%branch_flow = spread(0.0_rk, 1, int(model%joints%branch_count()))
      state%joint_pressure = [(model%joints%mean_pressure(j, state%pressure), j=1, model%joints%n)]
   end subroutine rest_fluid

   !> Undrained response to the load: the fractures have the pressure of the adjacent rock, and no
   !! fluid flows along them, through joints or wells.
   subroutine equilibrate(self, mesh, dt, state, timers, report, error)
      class(coarse_model_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: dt  !< a time in which no fluid moves noticeably [s]
      type(state_t), intent(inout) :: state
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      type(flow_paths_t) :: none
      real(rk) :: time

      call timers%heed(error)
      if (allocated(error)) return
      time = state%time
      none%settings = self%settings
      none%settings%equilibrate = .true.
      allocate (none%connections(2, 0))
      call solve_step(self, mesh, none, dt, state, timers, report, error)
      state%time = time
      if (report%converged) call rest_fluid(self, state)
   end subroutine equilibrate

   !> One backward Euler step. The state changes only if the step converges (report%converged); an
   !! error is raised where the equations cannot be solved at all.
   subroutine advance(self, mesh, dt, state, timers, report, error)
      class(coarse_model_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: dt  !< [s]
      type(state_t), intent(inout) :: state
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      type(flow_paths_t) :: paths

      call timers%heed(error)
      if (allocated(error)) return
      paths = self%flow_paths_t
      if (self%rock_wells%n > 0) then
         call advance_with_wells(self, mesh, paths, dt, state, timers, report, error)
      else
         call solve_step(self, mesh, paths, dt, state, timers, report, error)
      end if
   end subroutine advance

   !> A step with pressure-controlled wells in the rock, repeated until the results agree with the
   !! controls that have been tried.
   subroutine advance_with_wells(self, mesh, paths, dt, state, timers, report, error)
      class(coarse_model_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh
      type(flow_paths_t), intent(in) :: paths
      real(rk), intent(in) :: dt  !< [s]
      type(state_t), intent(inout) :: state
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      type(state_t) :: before
      logical :: any_changed
      integer(ik) :: first, k, last, most

      before = state
      first = self%wells%n + 1
      last = self%wells%n_all
      associate (wells => self%rock_wells, head_before => before%well_head(first:))
         call wells%choose_controls(self%wells, state%rock_well_control)
         most = 3*wells%n + 1
         do k = 1, 2*most + 30
            call wells%set_terms(self%wells, dt, head_before, self%matrix, any_changed)
            if (any_changed) self%condensed%dt = -1.0_rk
            call solve_step(self, mesh, paths, dt, state, timers, report, error)
            if (allocated(error) .or. .not. report%converged) return
            call wells%find_flows(self%wells, dt, head_before, state%unknowns(3, :mesh%n_cells), &
                                  state%well_flow(first:last), state%well_head(first:last), &
                                  state%well_rate(first:last))
            ! The balance contains the sources at a pressure of zero in the cells.
            report%mass_error = report%mass_error + dt*sum(wells%source &
                                                           - state%well_flow(first:last))
            call wells%correct_controls(self%wells, state%well_head(first:last), &
                                        state%well_rate(first:last), k > most, any_changed)
            if (.not. any_changed) exit
            call go_back(state, before)
         end do
         state%rock_well_control = wells%control
      end associate
      report%converged = .not. any_changed
      if (any_changed) report%reason = "no combination of well controls satisfies all well limits"
   end subroutine advance_with_wells

   !> Set the springs on the faces of the fractures: at tips, and dampers.
   subroutine support_faces(self, mesh, settings, dt)
      class(coarse_model_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh
      type(newton_settings_t), intent(in) :: settings  !< of the step
      real(rk), intent(in) :: dt  !< [s]
      real(rk), allocatable :: spring(:)

      spring = tip_springs(self%ends, self%rock, mesh, self%condensed)
      if (is_damped(settings)) then
         spring = spring + dampers(self%condensed, self%settings%damping/dt)
      end if
      call self%condensed%support(spring)
      call place_tips(self%ends, self%condensed%length, self%cells)
      if (allocated(self%rock_resistance)) then
         self%cells%leak_resistance = self%cells%leak_resistance*self%rock_resistance
      end if
   end subroutine support_faces

   !> Right-hand side of the body: loads, sources, stored fluid.
   subroutine find_load(self, mesh, wells, dt, content, load, fluid)
      class(coarse_model_t), intent(in) :: self
      type(mesh_t), intent(in) :: mesh
      type(wells_t), intent(in) :: wells  !< of the step
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: content(:)  !< (cells) of fluid before the step [m2]
      real(rk), allocatable, intent(out) :: load(:, :)  !< (3, n_blocks) [N/m], [m2]
      real(rk), allocatable, intent(out) :: fluid(:)  !< (cells) injected, if any [m2/s]
      integer(ik) :: w

      load = self%matrix%elastic_known
      load(3, :) = load(3, :) + dt*self%matrix%flow_known
      if (self%layers%n > 0) then
         associate (of_layers => load(:2, mesh%n_cells + 1:mesh%n_cells + self%layers%n))
            of_layers = of_layers + dt*self%matrix%layer_known
         end associate
      end if
      load(3, :mesh%n_cells) = load(3, :mesh%n_cells) - content
      if (allocated(self%source)) then
         fluid = self%source(3, :)
         if (wells%n_all > wells%n) then
            do w = 1, self%rock_wells%n
               associate (into => fluid(self%rock_wells%cell(w)))
                  into = into + self%rock_wells%source(w)
               end associate
            end do
         end if
         load(:2, :mesh%n_cells) = load(:2, :mesh%n_cells) + self%source(:2, :)
         load(3, :mesh%n_cells) = load(3, :mesh%n_cells) - dt*fluid
      end if
      if (allocated(self%weight)) then
         load(:2, :mesh%n_cells) = load(:2, :mesh%n_cells) + self%weight
      end if
   end subroutine find_load

   !> Add the loads of dampers and of a stress in situ on the faces.
   subroutine add_face_loads(self, mesh, settings, dt, jump, load)
      class(coarse_model_t), intent(in) :: self
      type(mesh_t), intent(in) :: mesh
      type(newton_settings_t), intent(in) :: settings  !< of the step
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: jump(:, :, :)  !< (2, 2, fracture cells) before the step [m]
      real(rk), intent(inout) :: load(:)  !< on the condensed system [N/m], [m2]

      if (mesh%fracture%n_cells > 0 .and. is_damped(settings)) then
         load = load + dampers(self%condensed, self%settings%damping/dt) &
                *jumps_of(self%condensed, jump)
      end if
      if (allocated(self%in_situ)) then
         call self%in_situ%add_contact_tractions(mesh%fracture, self%condensed%length, &
                                                 self%condensed%normal, self%condensed%layout, load)
      end if
   end subroutine add_face_loads

   !> Solve a step with the present sources and matrix.
   subroutine solve_step(self, mesh, paths, dt, state, timers, report, error)
      class(coarse_model_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh
      type(flow_paths_t), intent(in) :: paths
      real(rk), intent(in) :: dt  !< [s]
      type(state_t), intent(inout) :: state
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: fluid(:), rhs(:, :), g(:), q(:)
      type(state_t) :: before
      integer(ik) :: n

      n = mesh%fracture%n_cells
      if (.not. abs(self%condensed%dt - dt) <= same_time*dt) then
         call timers%start(phase_factorize)
         call self%layers%set_terms(dt, self%matrix)
         call self%condensed%factorize(mesh, self%matrix, dt, error)
         call timers%stop(phase_factorize)
         if (allocated(error)) return
      end if
      if (n > 0) call support_faces(self, mesh, paths%settings, dt)
      allocate (g(self%condensed%layout%count()), q(self%condensed%layout%count()))
      call timers%start(phase_assemble)
      call find_load(self, mesh, paths%wells, dt, state%content, rhs, fluid)
      if (self%layers%n > 0) then
         call self%layers%set_given(self%sides)
         call self%layers%add_load(state%unknowns, state%layer, rhs)
      end if
      call timers%stop(phase_assemble)
      call timers%start(phase_solve)
      call self%condensed%condense(rhs, g, error)
      call timers%stop(phase_solve)
      if (allocated(error)) return
      call add_face_loads(self, mesh, paths%settings, dt, state%jump, g)

      before = state
      report%converged = .true.
      if (n > 0) then
         call timers%start(phase_contact)
         call solve_fractures(self%fracture_problem_t, paths, dt, g, state, q, report)
         call timers%stop(phase_contact)
         if (.not. report%converged) return
         state%injection = self%cells%injection
         if (paths%wells%n > 0) then
            state%injection = state%injection + matmul(paths%wells%share, &
                                                       state%well_flow(:paths%wells%n))
         end if
      end if
      call timers%start(phase_solve)
      call self%condensed%expand(q, rhs, state%unknowns, error)
      call timers%stop(phase_solve)
      if (allocated(error)) return
      call timers%start(phase_assemble)
      if (self%layers%n > 0) call self%layers%update(state%unknowns, state%layer)
      call corner_tractions(self%regions, state%unknowns, state%tractions)
      call cell_contents(mesh, self%rock, self%regions, self%matrix, state%unknowns, &
                         state%tractions, state%content)
      state%time = state%time + dt
      call book_fluid(self, mesh, paths, fluid, dt, before, state, report)
      call timers%stop(phase_assemble)
      if (.not. sum(abs(state%unknowns)) <= huge(1.0_rk)) then
         call raise_error(error, "coarse_model", "the solution is not a finite number")
      end if
   end subroutine solve_step

   !> Whether slip radiates energy; not in the initial state, which takes no time.
   pure logical function is_damped(settings)
      type(newton_settings_t), intent(in) :: settings

      is_damped = settings%damping > 0.0_rk .and. .not. settings%equilibrate
   end function is_damped

   !> The fluid balance of the step: what is stored less what has been supplied, and the parts of
   !! it that are reported.
   subroutine book_fluid(self, mesh, paths, fluid, dt, before, after, report)
      class(coarse_model_t), intent(in) :: self
      type(mesh_t), intent(in) :: mesh
      type(flow_paths_t), intent(in) :: paths
      real(rk), allocatable, intent(in) :: fluid(:)  !< (n_cells) into the rock [m2/s]
      real(rk), intent(in) :: dt  !< [s]
      type(state_t), intent(in) :: before, after
      type(step_report_t), intent(inout) :: report
      real(rk), allocatable :: outflow(:)

      report%compressed = 0.0_rk
      report%rock_outflow = 0.0_rk
      associate (balance => report%mass_error)
         balance = sum(after%content - before%content)
         if (mesh%fracture%n_cells > 0) then
            call add_fracture_balance(paths, self%cells, self%condensed%length, dt, before, after, &
                                      report%compressed, balance)
         end if
         if (allocated(fluid)) balance = balance - dt*sum(fluid)
         if (self%drained .and. self%layers%n > 0) then
            report%rock_outflow = dt*boundary_outflow(mesh, self%regions, self%regions%flux, &
                                                      self%regions%scalars_of(after%unknowns)) &
                                  + self%layers%drained(after%layer)
            balance = balance + report%rock_outflow
         else if (self%drained) then
            allocate (outflow(mesh%n_cells))
            call cell_outflow(mesh, self%regions, self%regions%flux, after%unknowns(3, :), outflow)
            report%rock_outflow = dt*sum(outflow)
            if (mesh%fracture%n_cells > 0) then
               ! Fluid that crosses the faces of fractures remains in the body.
               report%rock_outflow = report%rock_outflow &
                                     + dt*sum(self%condensed%length*after%leakoff)
            end if
            balance = balance + report%rock_outflow
         end if
      end associate
   end subroutine book_fluid

   !> Free what gfortran 12 does not free by itself where the model is a component: arrays of the
   !! types that its components extend.
   subroutine release(self)
      class(coarse_model_t), intent(inout) :: self
      type(regions_t) :: none

      call self%condensed%factors%release()
      self%regions = none
   end subroutine release

   !> Pairs of fracture cells that exchange fluid along their fracture.
   subroutine find_connections(mesh, connections)
      type(mesh_t), intent(in) :: mesh
      integer(ik), allocatable, intent(out) :: connections(:, :)
      integer(ik), allocatable :: inside(:)
      integer(ik) :: i

      associate (fracture => mesh%fracture)
         inside = pack([(i, i=1, fracture%n_points)], fracture%point_kind == point_interior)
         allocate (connections(2, size(inside)))
         do i = 1, size(inside, kind=ik)
            connections(:, i) = fracture%point_cells%of(inside(i))
         end do
      end associate
   end subroutine find_connections

end module coarse_model
