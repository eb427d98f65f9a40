!> A window around a tip: a piece of the network on a fine mesh, loaded by the coarse level.
!!
!! The outer edge takes the coarse displacement, the rock the coarse pressure as initial stress. On
!! fracture faces that the coarse level knows, the condition is one of
!!   "contact"   the coarse level's contact state: open faces carry fluid pressure alone, slipping
!!   ones
!!               their friction with the opening tied to the slip, sticking ones keep the jump that
!!               the window found last (the coarse one if it has found none yet);
!!   "jump"      the coarse jump (Paper C);
!!   "traction"  the coarse contact traction.
!! Faces that only the fine level knows are open and carry the pressure of the coarse cell they grew
!! from.
module twolevel_window
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_plane, only: barycentric
   use contact_states, only: state_open, state_slip
   use coarse_rock, only: new_rock, rock_t
   use coarse_state, only: fracture_cells_t, state_t
   use fine_elasticity, only: elasticity_t
   use fine_faces, only: face_conditions_t, face_jump, face_loaded, face_slip, loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_model, only: fine_model_t
   use mesh_builder, only: build_mesh, locate, mesh_spec_t, mesher_t
   use mesh_types, only: mesh_t, network_t
   use scene_types, only: scene_t
   use tips_intensity, only: tip_intensity
   use tips_types, only: intensity_t
   use twolevel_jumps, only: jump_record_t, recall_jump, record_jumps
   implicit none(type, external)
   private

   public :: coarse_values_t, window_t

   !> growth of element size with distance from the fractures
   real(rk), parameter :: grading = 0.2_rk

   !> What a window takes from the coarse level.
   type :: coarse_values_t
      real(rk), allocatable :: nodal(:, :)  !< (3, n_nodes) u_x, u_y [m], p [Pa] at the mesh's nodes
      real(rk), allocatable :: dilation(:)  !< (coarse fracture cells) tan(psi) [-]
   end type coarse_values_t

   !> One window.
   type :: window_t
      integer(ik) :: fracture = 0  !< of the tip, in the network
      integer(ik) :: end = 0  !< of the tip, 1 or 2
      integer(ik) :: tip = 0  !< its number in the window's mesh
      real(rk) :: lower(2) = 0.0_rk, upper(2) = 0.0_rk  !< corners [m]
      type(mesh_t) :: mesh
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      real(rk), allocatable :: displacement(:, :)  !< of the last solution [m]
      type(jump_record_t) :: last_jump
      logical :: undrained = .false.  !< the model's constants are the undrained ones
      integer(ik), allocatable :: coarse_cell(:)  !< (n_nodes) coarse cell around each node
      real(rk), allocatable :: weight(:, :)  !< (3, n_nodes) of that cell's nodes
      !> (fracture cells) coarse fracture cell; negative: grown from it
      integer(ik), allocatable :: coarse_face(:)
      integer(ik), allocatable :: coarse_end(:)  !< (fracture cells) its nearer end
   contains
      procedure :: build
      procedure :: set_rock
      procedure :: project
      procedure :: intensity
   end type window_t

contains

   !> Mesh a window around one end of a fracture.
   subroutine build(self, scene, network, fracture, end, error)
      class(window_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: fracture, end
      type(error_t), allocatable, intent(out) :: error
      type(mesh_spec_t) :: spec
      type(mesher_t) :: mesher
      real(rk) :: tip(2), half

      self%fracture = fracture
      self%end = end
      tip = network%xy(:, merge(network%first(fracture), network%first(fracture + 1) - 1, end == 1))
      half = 0.5_rk*scene%discretization%window
      self%lower = tip - half
      self%upper = tip + half
      call clear_edges(network, 0.3_rk*scene%discretization%fine_ratio &
                       *scene%discretization%size_fracture, self%lower, self%upper)
      self%lower = max(self%lower, [scene%domain%x_min, scene%domain%y_min])
      self%upper = min(self%upper, [scene%domain%x_max, scene%domain%y_max])
      spec%x_min = self%lower(1)
      spec%y_min = self%lower(2)
      spec%x_max = self%upper(1)
      spec%y_max = self%upper(2)
      spec%size_fracture = scene%discretization%fine_ratio*scene%discretization%size_fracture
      spec%size_boundary = spec%size_fracture + grading*norm2(self%upper - self%lower)/2.0_rk
      spec%is_window = .true.
      spec%rosette_sectors = scene%discretization%rosette_sectors
      spec%rosette_radius = spec%size_fracture
      call build_mesh(spec, network, mesher, self%mesh, error)
      if (allocated(error)) return
      call self%set_rock(scene, .false., error)
      if (allocated(error)) return
      self%tip = findloc(self%mesh%fracture%tip_fracture == fracture .and. &
                         self%mesh%fracture%tip_end == end, .true., dim=1)
      self%loads = no_loads(self%model%mesh)
   end subroutine build

   !> Move edges outwards that pass so near to a vertex of a fracture that no good element fits
   !! between.
   pure subroutine clear_edges(network, clearance, lower, upper)
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: clearance  !< [m]
      real(rk), intent(inout) :: lower(2), upper(2)  !< corners [m]
      integer(ik) :: axis

      do axis = 1, 2
         associate (at => network%xy(axis, :))
            do while (any(abs(at - lower(axis)) < clearance))
               lower(axis) = lower(axis) - clearance
            end do
            do while (any(abs(at - upper(axis)) < clearance))
               upper(axis) = upper(axis) + clearance
            end do
         end associate
      end do
   end subroutine clear_edges

   !> Elastic constants: drained, or undrained for the response to a load in which no fluid moves.
   !! There the pore pressure follows the strain, alpha p = alpha p_0 - alpha^2/S div u, and has the
   !! tip's own singularity, which no pressure handed down from the coarse level could show.
   subroutine set_rock(self, scene, undrained, error)
      class(window_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      logical, intent(in) :: undrained
      type(error_t), allocatable, intent(out) :: error
      type(elasticity_t) :: elasticity
      type(rock_t) :: rock
      real(rk) :: lame

      elasticity = elasticity_t(young=scene%material%young, poisson=scene%material%poisson, &
                                biot=scene%material%biot, plane_stress=scene%material%plane_stress)
      if (undrained) then
         rock = new_rock(scene%material, scene%fluid)
         lame = rock%lame + rock%biot**2/rock%storage
         elasticity%poisson = lame/(2.0_rk*(lame + rock%shear))
         if (scene%material%plane_stress) elasticity%poisson = lame/(lame + 2.0_rk*rock%shear)
         elasticity%young = 2.0_rk*rock%shear*(1.0_rk + elasticity%poisson)
      end if
      call self%model%set_mesh(self%mesh, elasticity, error)
      self%undrained = undrained
   end subroutine set_rock

   !> Find where the window lies in the coarse mesh: to be done again whenever that has changed.
   subroutine project(self, mesher, coarse, error)
      class(window_t), intent(inout) :: self
      type(mesher_t), intent(in) :: mesher  !< of the coarse mesh
      type(mesh_t), intent(in) :: coarse
      type(error_t), allocatable, intent(out) :: error
      real(rk), parameter :: inwards = 1.0e-4_rk  !< share of the way to the element's centre
      real(rk), allocatable :: inside(:, :)
      integer(ik) :: c, k, v

      associate (fine => self%model%mesh)
         if (allocated(self%weight)) deallocate (self%weight, self%coarse_cell)
         allocate (inside(2, fine%n_nodes), self%weight(3, fine%n_nodes), &
                   self%coarse_cell(fine%n_nodes))
         ! A point on a fracture belongs to the side of the element that it is looked at from.
         do c = 1, fine%n_cells
            do k = 1, 6
               v = fine%cell_nodes(k, c)
               inside(:, v) = (1.0_rk - inwards)*fine%xy(:, v) &
                              + inwards*sum(fine%xy(:, fine%cell_nodes(:3, c)), dim=2)/3.0_rk
            end do
         end do
         call locate(mesher, inside, self%coarse_cell, error)
         if (allocated(error)) return
         do v = 1, fine%n_nodes
            self%weight(:, v) = barycentric(coarse%xy(:, &
                                                      coarse%cell_nodes(:, self%coarse_cell(v))), &
                                            fine%xy(:, v))
         end do
      end associate
      call match_faces(self, coarse)
   end subroutine project

   !> Which coarse fracture cell, and which of its ends, lies nearest to each fracture cell of the
   !! window.
   subroutine match_faces(self, coarse)
      class(window_t), intent(inout) :: self
      type(mesh_t), intent(in) :: coarse
      integer(ik) :: i, j
      real(rk) :: distance, s, shortest

      associate (here => self%mesh%fracture, there => coarse%fracture)
         if (allocated(self%coarse_face)) deallocate (self%coarse_face, self%coarse_end)
         allocate (self%coarse_face(here%n_cells), self%coarse_end(here%n_cells), source=0_ik)
         do i = 1, here%n_cells
            s = 0.5_rk*sum(here%cell_s(:, i))
            shortest = huge(1.0_rk)
            do j = 1, there%n_cells
               if (there%cell_fracture(j) /= here%cell_fracture(i)) cycle
               distance = max(there%cell_s(1, j) - s, s - there%cell_s(2, j))
               if (distance >= shortest) cycle
               shortest = distance
               self%coarse_face(i) = merge(j, -j, distance <= 0.0_rk)
               self%coarse_end(i) = merge(1, 2, s < 0.5_rk*sum(there%cell_s(:, j)))
            end do
         end do
      end associate
   end subroutine match_faces

   !> Load the window with the state of the coarse level, solve, and evaluate its tip.
   subroutine intensity(self, scene, coarse, values, state, result, error)
      class(window_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(mesh_t), intent(in) :: coarse
      type(coarse_values_t), intent(in) :: values
      type(state_t), intent(in) :: state
      type(intensity_t), intent(out) :: result
      type(error_t), allocatable, intent(out) :: error
      type(face_conditions_t) :: conditions
      integer(ik) :: v

      associate (fine => self%model%mesh)
         do v = 1, fine%n_nodes
            if (v > fine%n_vertices .and. .not. fine%on_boundary(v)) cycle
            associate (nodes => coarse%cell_nodes(:, self%coarse_cell(v)))
               self%loads%boundary_displacement(:, v) = matmul(values%nodal(1:2, nodes), &
                                                               self%weight(:, v))
               if (v > fine%n_vertices) cycle
               self%loads%pore_pressure(v) = dot_product(values%nodal(3, nodes), self%weight(:, v))
            end associate
         end do
      end associate
      if (self%undrained) self%loads%pore_pressure = scene%initial%pressure
      call load_faces(self, scene%discretization%face_condition, coarse, values, state, conditions)
      if (.not. same_conditions(self%model, conditions)) then
         call self%model%prepare(conditions, error)
         if (allocated(error)) return
      end if
      call self%model%solve(self%loads, self%displacement, error)
      if (allocated(error)) return
      call record_jumps(self%model%mesh, self%displacement, self%last_jump)
      call tip_intensity(self%model, self%loads, self%displacement, self%tip, result, error)
   end subroutine intensity

   !> Conditions and loads on the fracture faces.
   subroutine load_faces(self, face_condition, coarse, values, state, conditions)
      class(window_t), intent(inout) :: self
      character(len=*), intent(in) :: face_condition  !< "contact", "jump" or "traction"
      type(mesh_t), intent(in) :: coarse
      type(coarse_values_t), intent(in) :: values
      type(state_t), intent(in) :: state
      type(face_conditions_t), intent(out) :: conditions
      integer(ik) :: contact, i, j, end

      conditions = loaded_everywhere(self%model%mesh)
      do i = 1, self%mesh%fracture%n_cells
         j = abs(self%coarse_face(i))
         end = self%coarse_end(i)
         self%loads%fluid_pressure(i) = state%pressure(j)
         self%loads%traction(:, i) = 0.0_rk
         self%loads%jump(:, :, i) = 0.0_rk
         if (self%coarse_face(i) < 0) cycle
         contact = state%contact(end, j)
         self%loads%traction(:, i) = [state%traction(2, end, j), state%traction(1, end, j)]
         select case (face_condition)
         case ("contact")
            if (contact == state_slip) then
               conditions%condition(i) = face_slip
               conditions%dilation(i) = sign(values%dilation(j), state%jump(2, end, j))
            else if (contact /= state_open) then
               conditions%condition(i) = face_jump
               call keep_jump(self, coarse, state, i, j)
            end if
         case ("jump")
            conditions%condition(i) = face_jump
            call interpolate_jump(self, coarse, state, i, j)
         case default  ! "traction": loaded, as all faces are to begin with
            conditions%condition(i) = face_loaded
         end select
      end do
   end subroutine load_faces

   !> The window's last jump on a sticking face, or the coarse one where there is none.
   subroutine keep_jump(self, coarse, state, i, j)
      class(window_t), intent(inout) :: self
      type(mesh_t), intent(in) :: coarse
      type(state_t), intent(in) :: state
      integer(ik), intent(in) :: i, j  !< fracture cell of the window, and of the coarse mesh
      real(rk) :: jump(2)
      integer(ik) :: k
      logical :: found

      do k = 1, 3
         call recall_jump(self%last_jump, self%mesh%fracture%cell_fracture(i), &
                          self%model%mesh%face_s(k, i), jump, found)
         if (.not. found) then
            call interpolate_jump(self, coarse, state, i, j)
            return
         end if
         associate (tau => self%model%mesh%face_tangent(:, i))
            self%loads%jump(:, k, i) = [dot_product(tau, jump), tau(1)*jump(2) - tau(2)*jump(1)]
         end associate
      end do
   end subroutine keep_jump

   !> The coarse jump, linear along its cell, at the window's nodes. Zero at the tip of the network.
   subroutine interpolate_jump(self, coarse, state, i, j)
      class(window_t), intent(inout) :: self
      type(mesh_t), intent(in) :: coarse
      type(state_t), intent(in) :: state
      integer(ik), intent(in) :: i, j  !< fracture cell of the window, and of the coarse mesh
      integer(ik) :: k
      real(rk) :: t

      associate (s => self%model%mesh%face_s(:, i), ends => coarse%fracture%cell_s(:, j))
         do k = 1, 3
            ! Jumps are known at the third points.
            t = 3.0_rk*(s(k) - ends(1))/(ends(2) - ends(1)) - 1.0_rk
            self%loads%jump(:, k, i) = (1.0_rk - t)*state%jump(2:1:-1, 1, j) &
                                       + t*state%jump(2:1:-1, 2, j)
         end do
      end associate
   end subroutine interpolate_jump

   pure function same_conditions(model, conditions) result(same)
      type(fine_model_t), intent(in) :: model
      type(face_conditions_t), intent(in) :: conditions
      logical :: same

      same = model%ready
      if (same) same = all(model%conditions%condition == conditions%condition)
      if (same) same = .not. any(abs(model%conditions%dilation - conditions%dilation) > 0.0_rk)
   end function same_conditions

end module twolevel_window
