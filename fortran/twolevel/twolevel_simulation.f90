!> A scene in progress: network, coarse mesh, model and state, tips, and the bookkeeping of fluid.
module twolevel_simulation
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_timers, only: phase_mesh, phase_remesh, phase_tips, phase_transfer, timers_t
   use contact_law, only: contact_law_t
   use coarse_fields, only: nodal_values
   use coarse_model, only: coarse_model_t, new_state
   use coarse_state, only: fracture_cells_t, state_t, step_report_t
   use mesh_builder, only: build_mesh, mesh_spec_t, mesher_t, remesh, transfer_mesher
   use mesh_types, only: mesh_map_t, mesh_t, network_t, point_boundary, point_interior, point_tip
   use scene_types, only: scene_t
   use tips_network, only: network_of_scene
   use twolevel_tips, only: find_tips, tips_t
   use twolevel_transfer, only: transfer_cells, transfer_state
   use twolevel_window, only: coarse_level_t
   implicit none(type, external)
   private

   public :: simulation_t

   real(rk), parameter :: undrained_share = 1.0e-6_rk  !< of a step: no fluid moves noticeably in it

   !> Everything that changes while a scene runs.
   type :: simulation_t
      type(scene_t) :: scene
      type(network_t) :: start  !< network of the scene
      type(network_t) :: network  !< as the coarse level has it
      type(mesher_t) :: mesher
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      type(tips_t) :: tips
      type(coarse_level_t) :: level
      logical :: level_is_current = .false.
      logical :: undrained = .false.  !< the state is the undrained response to the load
      real(rk), allocatable :: share(:, :)  !< (fracture cells, wells) of each well's rate
      integer(ik), allocatable :: grown(:)  !< fracture cells that the last growth added
      real(rk) :: injected = 0.0_rk  !< so far [m2]
      real(rk) :: leaked = 0.0_rk  !< from the fractures into the rock so far [m2]
      real(rk) :: prefilled = 0.0_rk  !< brought along by new fracture cells so far [m2]
   contains
      procedure :: begin
      procedure :: equilibrate
      procedure :: step
      procedure :: update_level
      procedure :: evaluate_tips
      procedure :: grow_tips
      procedure :: grow_coarse
      procedure :: rate
      procedure :: next_switch
   end type simulation_t

contains

   !> Mesh, discretize and set the state before the load.
   subroutine begin(self, scene, timers, error)
      class(simulation_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      type(mesh_spec_t) :: spec

      self%scene = scene
      self%start = network_of_scene(scene)
      self%network = self%start
      spec = mesh_spec_t(x_min=scene%domain%x_min, x_max=scene%domain%x_max, &
                         y_min=scene%domain%y_min, y_max=scene%domain%y_max, &
                         size_fracture=scene%discretization%size_fracture, &
                         size_boundary=scene%discretization%size_boundary)
      if (size(self%start%first) == 1) spec%size_fracture = spec%size_boundary
      call timers%start(phase_mesh)
      call build_mesh(spec, self%network, self%mesher, self%mesh, error)
      call timers%stop(phase_mesh)
      if (allocated(error)) return
      call refuse_joints(self%mesh, error)
      if (allocated(error)) return
      call first_cells(self)
      call first_wells(self)
      call self%model%set_mesh(self%mesh, scene, timers, error)
      if (allocated(error)) return
      call new_state(self%mesh, self%model%cells, scene%initial%pressure, self%model, self%state)
      call find_tips(self%mesh, self%network, self%tips)
      allocate (self%grown(0))
   end subroutine begin

   !> There is no law yet for fluid at joints of fractures.
   subroutine refuse_joints(mesh, error)
      type(mesh_t), intent(in) :: mesh
      type(error_t), allocatable, intent(out) :: error

      character(len=96) :: text
      integer(ik) :: i

      do i = 1, mesh%fracture%n_points
         if (any(mesh%fracture%point_kind(i) == [point_interior, point_tip, point_boundary])) cycle
         write (text, "(a,es12.5,a,es12.5,a)") "fractures meet at (", &
            mesh%fracture%point_xy(1, i), ",", mesh%fracture%point_xy(2, i), "); this version"
         call raise_error(error, "", trim(text)//" simulates only fractures that do not touch "// &
                          "each other")
         return
      end do
   end subroutine refuse_joints

   subroutine first_cells(self)
      class(simulation_t), intent(inout) :: self

      integer(ik) :: i

      associate (fracture => self%mesh%fracture, cells => self%model%cells)
         allocate (cells%law(fracture%n_cells), cells%residual_aperture(fracture%n_cells))
         allocate (cells%injection(fracture%n_cells), source=0.0_rk)
         do i = 1, fracture%n_cells
            associate (given => self%scene%fractures(fracture%cell_fracture(i)))
               cells%law(i) = contact_law_t(friction=given%friction, dilation=tan(given%dilation))
               cells%residual_aperture(i) = given%aperture
            end associate
         end do
      end associate
   end subroutine first_cells

   !> Which cells each well feeds: the nearest one to its point, or all of its fracture.
   subroutine first_wells(self)
      class(simulation_t), intent(inout) :: self

      real(rk), allocatable :: distance(:)
      integer(ik) :: i, w, n_wells

      n_wells = 0
      if (allocated(self%scene%injections)) n_wells = size(self%scene%injections)
      associate (fracture => self%mesh%fracture)
         allocate (self%share(fracture%n_cells, n_wells), source=0.0_rk)
         allocate (distance(fracture%n_cells))
         do w = 1, n_wells
            associate (well => self%scene%injections(w))
               do i = 1, fracture%n_cells
                  distance(i) = huge(1.0_rk)
                  if (fracture%cell_fracture(i) /= well%fracture) cycle
                  self%share(i, w) = fracture%cell_s(2, i) - fracture%cell_s(1, i)
                  distance(i) = norm2(0.5_rk*sum(fracture%point_xy(:, fracture%cell_points(:, i)), &
                                                 dim=2) - [well%x, well%y])
               end do
               if (well%at_point) then
                  self%share(:, w) = 0.0_rk
                  self%share(minloc(distance, dim=1), w) = 1.0_rk
               end if
               self%share(:, w) = self%share(:, w)/sum(self%share(:, w))
            end associate
         end do
      end associate
   end subroutine first_wells

   !> Undrained response to the load with fractures in equilibrium with the rock (model.md section
   !! 9).
   subroutine equilibrate(self, timers, report, error)
      class(simulation_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error

      self%level_is_current = .false.
      self%undrained = .true.
      call self%model%equilibrate(self%mesh, undrained_share*self%scene%time%step, self%state, &
                                  timers, report, error)
   end subroutine equilibrate

   !> One step of the coarse level. Nothing changes unless it converges.
   subroutine step(self, dt, timers, report, error)
      class(simulation_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error

      integer(ik) :: w

      self%model%cells%injection = 0.0_rk
      do w = 1, size(self%share, 2)
         self%model%cells%injection = self%model%cells%injection + self%share(:, w)*self%rate(w, &
                                                                                self%state%time, dt)
      end do
      call self%model%advance(self%mesh, dt, self%state, timers, report, error)
      if (allocated(error) .or. .not. report%converged) return
      self%level_is_current = .false.
      self%undrained = .false.
      self%injected = self%injected + dt*sum(self%model%cells%injection)
      if (self%mesh%fracture%n_cells > 0) then
         self%leaked = self%leaked + dt*sum(self%state%leakoff*self%model%condensed%length)
      end if
   end subroutine step

   !> Rate of a well in the step that begins at a time; steps do not straddle its start or end.
   pure function rate(self, well, time, dt) result(q)
      class(simulation_t), intent(in) :: self
      integer(ik), intent(in) :: well
      real(rk), intent(in) :: time, dt  !< [s]
      real(rk) :: q  !< [m2/s]

      q = 0.0_rk
      associate (w => self%scene%injections(well))
         if (time + 0.5_rk*dt > w%start .and. time + 0.5_rk*dt < w%end) q = w%rate
      end associate
   end function rate

   !> The next time at which a well starts or ends, or the scene does [s].
   pure function next_switch(self) result(time)
      class(simulation_t), intent(in) :: self
      real(rk) :: time

      real(rk) :: now
      integer(ik) :: w

      time = self%scene%time%end
      now = self%state%time*(1.0_rk + 1.0e-12_rk)
      do w = 1, size(self%share, 2)
         associate (well => self%scene%injections(w))
            if (well%start > now) time = min(time, well%start)
            if (well%end > now) time = min(time, well%end)
         end associate
      end do
   end function next_switch

   !> Coarse values at the mesh's nodes, for windows and probes.
   subroutine update_level(self)
      class(simulation_t), intent(inout) :: self

      if (self%level_is_current) return
      if (allocated(self%level%nodal)) deallocate (self%level%nodal)
      allocate (self%level%nodal(3, self%mesh%n_nodes))
      call nodal_values(self%mesh, self%model%rock, self%model%regions, self%state%unknowns, &
                        self%state%tractions, self%level%nodal)
      self%level%dilation = self%model%cells%law%dilation
      self%level_is_current = .true.
   end subroutine update_level

   !> Stress intensity factors of all tips.
   subroutine evaluate_tips(self, timers, error)
      class(simulation_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call timers%start(phase_tips)
      call self%update_level()
      call self%tips%evaluate(self%scene, self%mesher, self%mesh, self%level, self%state, &
                              self%undrained, error)
      call timers%stop(phase_tips)
   end subroutine evaluate_tips

   !> Advance the tips that grow, in the direction in which they go on straight (twolevel_tips), and
   !! evaluate them there.
   subroutine grow_tips(self, increment, any_grew, timers, error)
      class(simulation_t), intent(inout) :: self
      real(rk), intent(in) :: increment  !< l_max [m]
      logical, intent(out) :: any_grew
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      integer, parameter :: corrections = 8
      integer :: k
      logical :: any_turned

      call self%tips%grow(self%scene, increment, any_grew)
      if (.not. any_grew) return
      call self%evaluate_tips(timers, error)
      do k = 1, corrections
         if (allocated(error)) return
         call self%tips%correct_tips(any_turned)
         if (.not. any_turned) exit
         call self%evaluate_tips(timers, error)
      end do
      where (self%tips%tip%advance > 0.0_rk) self%tips%tip%has_wing = .true.
   end subroutine grow_tips

   !> Let the coarse level follow what the tips have grown, if that has reached its threshold.
   subroutine grow_coarse(self, increment, grew, timers, error)
      class(simulation_t), intent(inout) :: self
      real(rk), intent(in) :: increment  !< l_max [m]
      logical, intent(out) :: grew
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      type(mesher_t) :: mesher
      type(mesh_t) :: mesh
      type(mesh_map_t) :: map
      type(state_t) :: state
      type(fracture_cells_t) :: cells
      real(rk), allocatable :: centres(:, :), share(:, :)
      real(rk) :: prefilled
      integer(ik) :: i

      associate (size_fracture => self%scene%discretization%size_fracture)
         call self%tips%hand_over(self%scene%growth%threshold*size_fracture, self%network, centres)
         grew = size(centres, 2) > 0
         if (.not. grew) return
         call timers%start(phase_remesh)
         call remesh(self%mesher, self%network, centres, max(5.0_rk*increment, &
                                                             3.0_rk*size_fracture), size_fracture, &
                     mesher, mesh, map, error)
         call timers%stop(phase_remesh)
      end associate
      if (allocated(error)) return
      call timers%start(phase_transfer)
      call transfer_cells(map, mesh, self%model%cells, self%scene%growth%new_aperture, cells)
      call transfer_state(map, self%mesh, mesh, cells, &
                          self%scene%growth%new_volume == "prefilled", self%state, state, prefilled)
      allocate (share(mesh%fracture%n_cells, size(self%share, 2)), source=0.0_rk)
      do i = 1, mesh%fracture%n_cells
         if (map%fracture_cell_old(i) > 0) share(i, :) = self%share(map%fracture_cell_old(i), :)
      end do
      self%grown = pack([(i, i=1, mesh%fracture%n_cells)], map%fracture_cell_old == 0)
      call transfer_mesher(mesher, self%mesher)
      self%mesh = mesh
      self%model%cells = cells
      self%state = state
      self%share = share
      self%prefilled = self%prefilled + prefilled
      self%level_is_current = .false.
      call self%tips%coarse_changed()
      call timers%stop(phase_transfer)
      call self%model%set_mesh(self%mesh, self%scene, timers, error)
   end subroutine grow_coarse

end module twolevel_simulation
