!> The coarse level: Biot's equations in the rock, contact and flow in the fractures, discretized on
!! one mesh. Its time steps are in the submodule coarse_steps.
module coarse_model
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: phase_assemble, phase_discretize, timers_t
   use contact_law, only: state_stick
   use coarse_tips, only: crack_ends_t, free_ends, place_tips
   use coarse_fractures, only: newton_settings_t
   use mesh_geometry, only: fracture_cell_centre
   use coarse_in_situ, only: find_in_situ, in_situ_state_t
   use coarse_layers, only: layers_t
   use coarse_layer_places, only: add_tip_flow, place_layers
   use coarse_joints, only: find_joints, renew_outlets
   use coarse_matrix, only: matrix_t
   use coarse_newton, only: fracture_problem_t
   use coarse_loads, only: add_point_forces, find_weight, hold_points
   use coarse_regions, only: regions_t
   use coarse_permeability, only: place_regions, relative_resistance
   use coarse_rock, only: new_rock, rock_t, solid_t
   use coarse_wells, only: control_rate, rock_wells_t
   use coarse_state, only: fracture_cells_t, state_t, step_report_t
   use coarse_stencils, only: discretize, renew_sides
   use mesh_types, only: mesh_t, point_interior
   use scene_fluid_law, only: has_law, new_fluid_law
   use scene_outline, only: sides_of_scene
   use scene_sides, only: boundary_side_t
   use scene_types, only: initial_t, scene_t
   implicit none(type, external)
   private

   public :: coarse_model_t, new_state, rest_fluid

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
      logical :: may_hold = .false.  !< cells that stick may be held (coarse_held_cells)
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
      procedure :: place_ends
      procedure :: release
   end type coarse_model_t

   interface

      !> Undrained response to the load: the fractures have the pressure of the adjacent rock, and
      !! no fluid flows along them, through joints or wells.
      module subroutine equilibrate(self, mesh, dt, state, timers, report, error)
         implicit none(type, external)
         class(coarse_model_t), intent(inout) :: self
         type(mesh_t), intent(in) :: mesh
         real(rk), intent(in) :: dt  !< a time in which no fluid moves noticeably [s]
         type(state_t), intent(inout) :: state
         type(timers_t), intent(inout) :: timers
         type(step_report_t), intent(out) :: report
         type(error_t), allocatable, intent(out) :: error
      end subroutine equilibrate

      !> One backward Euler step. The state changes only if the step converges (report%converged);
      !! an error is raised where the equations cannot be solved at all.
      module subroutine advance(self, mesh, dt, state, timers, report, error)
         implicit none(type, external)
         class(coarse_model_t), intent(inout) :: self
         type(mesh_t), intent(in) :: mesh
         real(rk), intent(in) :: dt  !< [s]
         type(state_t), intent(inout) :: state
         type(timers_t), intent(inout) :: timers
         type(step_report_t), intent(out) :: report
         type(error_t), allocatable, intent(out) :: error
      end subroutine advance

   end interface

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
         ! The tries of growth need many elimination steps.
         self%may_hold = scene%growth%in_equilibrium()
         if (self%may_hold) self%settings%many = 200
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
         call add_tip_flow(self%layers, mesh, self%rock, self%matrix)
         if (scene%has_points()) call hold_points(scene, mesh, self%matrix, self%weight)
         call find_connections(mesh, self%connections)
         call find_joints(mesh, self%sides, self%joints)
         if (allocated(self%in_situ)) then
            self%joints%pressure_in_situ = &
               self%in_situ%pressure_at(mesh%fracture%point_xy(2, self%joints%point))
         end if
      end if
      self%ends = free_ends(mesh%fracture)
      call self%condensed%forget(mesh, scene%discretization%condensation, scene%growth%enabled)
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
      call renew_sides(mesh, self%rock, self%sides, self%regions, self%matrix, error, &
                       self%in_situ, self%layers%relief)
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

   !> Set the shares of the cells behind the ends of the cracks, and what depends on them; without
   !! effect on a mesh without equations.
   pure subroutine place_ends(self, mesh)
      class(coarse_model_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh

      if (mesh%fracture%n_cells == 0 .or. .not. allocated(self%condensed%length)) return
      if (size(self%condensed%length) /= mesh%fracture%n_cells) return
      call place_tips(self%ends, self%condensed%length, self%cells)
      if (allocated(self%rock_resistance)) then
         self%cells%leak_resistance = self%cells%leak_resistance*self%rock_resistance
      end if
   end subroutine place_ends

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
