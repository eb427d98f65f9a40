!> Fracture faces of a window: their conditions, loads and slip history, from the coarse level.
!!
!! The condition is one of
!!   "contact"   the contact law, which the window solves with the coarse level's fluid pressure
!!               and history of slip, on old and on new faces;
!!   "jump"      the coarse jump (Paper C);
!!   "traction"  the coarse contact traction.
!! With the last two, for comparison only, faces without coarse cells are open.
module twolevel_faces
   use base_kinds, only: ik, rk
   use coarse_state, only: state_t
   use coarse_tip_drainage, only: drained_tip_t
   use contact_law, only: contact_law_t
   use fine_contact, only: contact_t, new_contact
   use fine_element, only: gauss_rule, line_parameter, line_shapes
   use fine_faces, only: face_conditions_t, face_contact, face_jump, loaded_everywhere
   use fine_loads, only: fine_loads_t
   use fine_mesh, only: fine_mesh_t
   use mesh_types, only: mesh_t
   use twolevel_pressure, only: match_pressure, pressure_map_t
   implicit none(type, external)
   private

   public :: coarse_values_t, coarse_jumps, face_map_t, match_faces

   !> Coarse values that windows use.
   type :: coarse_values_t
      !> unknowns from which the following values are computed [m], [m], [Pa]
      real(rk), allocatable :: of(:, :)
      real(rk), allocatable :: nodal(:, :)  !< (3, n_nodes) u_x, u_y [m], p [Pa] at the mesh's nodes
      type(drained_tip_t), allocatable :: drained(:)  !< what this p at nodes does not contain
      !> Displacement and gradient for an interpolation that is exact for quadratic fields
      !! (nodal_fields)
      real(rk), allocatable :: displacement(:, :)  !< (2, n_nodes) [m]
      real(rk), allocatable :: gradient(:, :, :)  !< (2, 2, n_nodes) [-]
      type(contact_law_t), allocatable :: law(:)  !< (coarse fracture cells)
      logical, allocatable :: is_grown(:)  !< (coarse fracture cells) that filled as they opened
      !> (coarse fracture cells) of coarse_tip_layer where a tip lies in one, else 0 [1/m^(1/2)]
      real(rk), allocatable :: viscous(:)
      logical :: undrained = .false.  !< no fluid has moved since the load changed
   end type coarse_values_t

   !> Map from the fracture cells of a window to the coarse fracture cells.
   type :: face_map_t
      integer(ik), allocatable :: coarse_cell(:)  !< number of the nearest coarse cell
      !> the window's cell lies in the coarse cell; else it has grown beyond it
      logical, allocatable :: is_inside(:)
      !> (2, fracture cells) arc lengths of the ends of the coarse cell [m]
      real(rk), allocatable :: ends(:, :)
      type(pressure_map_t) :: pressure  !< map of the fluid pressure
   contains
      procedure :: conditions
      procedure :: load
      procedure :: history
   end type face_map_t

contains

   !> Find the nearest coarse fracture cell on the same fracture for each fracture cell of the
   !! window.
   pure function match_faces(fine, coarse, is_grown) result(map)
      type(fine_mesh_t), intent(in) :: fine
      type(mesh_t), intent(in) :: coarse
      logical, intent(in) :: is_grown(:)  !< (coarse fracture cells)
      type(face_map_t) :: map
      integer(ik) :: i, j
      real(rk) :: distance, s, shortest

      associate (here => fine%fracture, there => coarse%fracture)
         allocate (map%coarse_cell(here%n_cells), source=0_ik)
         allocate (map%is_inside(here%n_cells), source=.false.)
         allocate (map%ends(2, here%n_cells), source=0.0_rk)
         do i = 1, here%n_cells
            s = 0.5_rk*sum(here%cell_s(:, i))
            shortest = huge(1.0_rk)
            do j = 1, there%n_cells
               if (there%cell_fracture(j) /= here%cell_fracture(i)) cycle
               distance = max(there%cell_s(1, j) - s, s - there%cell_s(2, j))
               if (distance >= shortest) cycle
               shortest = distance
               map%coarse_cell(i) = j
               map%is_inside(i) = distance <= 0.0_rk
               map%ends(:, i) = there%cell_s(:, j)
            end do
         end do
      end associate
      map%pressure = match_pressure(fine, coarse, is_grown)
   end function match_faces

   !> Conditions on the faces.
   pure function conditions(self, fine, name, law) result(found)
      class(face_map_t), intent(in) :: self
      type(fine_mesh_t), intent(in) :: fine
      character(len=*), intent(in) :: name  !< "contact", "jump" or "traction"
      type(contact_law_t), intent(in) :: law(:)  !< (coarse fracture cells)
      type(face_conditions_t) :: found
      integer(ik) :: i

      found = loaded_everywhere(fine)
      do i = 1, fine%fracture%n_cells
         select case (name)
         case ("contact")
            found%condition(i) = face_contact
            found%law(i)%contact = law(self%coarse_cell(i))
            if (.not. self%is_inside(i)) then
               found%law(i)%contact = found%law(i)%contact%as_grown()
            end if
         case ("jump")
            if (self%is_inside(i)) found%condition(i) = face_jump
         case default  ! "traction": loaded, as all faces are to begin with
            continue
         end select
      end do
   end function conditions

   !> Fluid pressure, and what the condition gives, from the state of the coarse level.
   pure subroutine load(self, fine, name, state, lowest, loads, in_situ, viscous)
      class(face_map_t), intent(in) :: self
      type(fine_mesh_t), intent(in) :: fine
      character(len=*), intent(in) :: name  !< "contact", "jump" or "traction"
      type(state_t), intent(in) :: state
      real(rk), intent(in) :: lowest  !< lowest pressure of the fluid [Pa]
      type(fine_loads_t), intent(inout) :: loads
      real(rk), intent(in), optional :: in_situ(:)  !< (faces) what pressures add to [Pa]
      real(rk), intent(in), optional :: viscous(:)  !< (coarse fracture cells) as on_faces has it
      integer(ik) :: i, k

      loads%fluid_pressure = self%pressure%on_faces(state%pressure, lowest, in_situ, viscous)
      do i = 1, fine%fracture%n_cells
         associate (j => self%coarse_cell(i))
            if (.not. self%is_inside(i)) cycle
            select case (name)
            case ("jump")
               do k = 1, 3
                  loads%jump(1, k, i) = at_node(self, i, fine%face_s(k, i), state%jump(2, :, j))
                  loads%jump(2, k, i) = at_node(self, i, fine%face_s(k, i), state%jump(1, :, j))
               end do
            case ("traction")
               k = merge(1, 2, sum(fine%face_s(:2, i)) < sum(self%ends(:, i)))
               loads%traction(:, i) = state%traction(2:1:-1, k, j)
            case default  ! "contact" finds its own
               continue
            end select
         end associate
      end do
   end subroutine load

   !> Contact state from the coarse level: its jumps as first guess, and its slip before the step.
   pure function history(self, fine, state) result(contact)
      class(face_map_t), intent(in) :: self
      type(fine_mesh_t), intent(in) :: fine
      type(state_t), intent(in) :: state
      type(contact_t) :: contact
      integer(ik) :: i, k

      contact = new_contact(fine)
      do i = 1, fine%fracture%n_cells
         if (.not. self%is_inside(i)) cycle
         associate (j => self%coarse_cell(i))
            do k = 1, 3
               associate (s => fine%face_s(k, i))
                  contact%jump(1, k, i) = at_node(self, i, s, state%jump(2, :, j))
                  contact%jump(2, k, i) = at_node(self, i, s, state%jump(1, :, j))
                  contact%slip_before(k, i) = at_node(self, i, s, state%slip_before(:, j))
                  if (allocated(state%slip_path)) then
                     contact%slip_path(k, i) = at_node(self, i, s, path_before(state, j))
                     contact%opened(k, i) = max(0.0_rk, &
                                                at_node(self, i, s, state%opened_before(:, j)))
                  end if
               end associate
            end do
         end associate
      end do
   end function history

   !> Slip path at the ends of a coarse cell before the last step [m].
   pure function path_before(state, cell) result(path)
      type(state_t), intent(in) :: state
      integer(ik), intent(in) :: cell
      real(rk) :: path(2)

      path = state%slip_path(:, cell) - abs(state%jump(2, :, cell) - state%slip_before(:, cell))
   end function path_before

   !> Jumps of the window projected onto the coarse fracture cells: linear in each cell, with the
   !! same mean and the same first moment.
   pure function coarse_jumps(fine, displacement, coarse) result(jump)
      type(fine_mesh_t), intent(in) :: fine
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(mesh_t), intent(in) :: coarse
      real(rk), allocatable :: jump(:, :, :)  !< layout of state_t [m]; 0 outside of the window
      integer(ik), parameter :: n_points = 3
      real(rk) :: at_nodes(2, 3), here(2), length, part(2), points(n_points), weights(n_points)
      real(rk) :: place, share, x
      integer(ik) :: i, j, k

      call gauss_rule(n_points, points, weights)
      allocate (jump(2, 2, coarse%fracture%n_cells), source=0.0_rk)
      do i = 1, fine%fracture%n_cells
         associate (tau => fine%face_tangent(:, i))
            do k = 1, 3
               here = displacement(:, fine%face_nodes(k, 2, i)) &
                      - displacement(:, fine%face_nodes(k, 1, i))
               at_nodes(:, k) = [tau(1)*here(2) - tau(2)*here(1), dot_product(tau, here)]
            end do
         end associate
         do j = 1, coarse%fracture%n_cells
            if (coarse%fracture%cell_fracture(j) /= fine%fracture%cell_fracture(i)) cycle
            associate (s => fine%face_s(:, i), ends => coarse%fracture%cell_s(:, j), &
                       tip_end => fine%face_tip(i))
               ! The part of the face that lies in the cell, as parameters on the face.
               part = (min(max(ends, s(1)), s(2)) - s(1))/(s(2) - s(1))
               if (.not. part(2) > part(1)) cycle
               part = [line_parameter(part(1), tip_end), line_parameter(part(2), tip_end)]
               ! length of the face, over that of the cell
               length = (s(2) - s(1))/(ends(2) - ends(1))
               do k = 1, n_points
                  x = part(1) + points(k)*(part(2) - part(1))
                  share = line_place(x, tip_end)
                  here = matmul(at_nodes, line_shapes(x)) &
                         *weights(k)*(part(2) - part(1))*line_stretch(x, tip_end)*length
                  ! Distance from the middle of the cell; the unknown jumps are those at +-1/6.
                  place = (s(1) + share*(s(2) - s(1)) - ends(1))/(ends(2) - ends(1)) - 0.5_rk
                  jump(:, 1, j) = jump(:, 1, j) + (1.0_rk - 2.0_rk*place)*here
                  jump(:, 2, j) = jump(:, 2, j) + (1.0_rk + 2.0_rk*place)*here
               end do
            end associate
         end do
      end do
   end function coarse_jumps

   !> Position along a face, over its length, at a parameter (fine_element).
   elemental real(rk) function line_place(x, tip_end) result(share)
      real(rk), intent(in) :: x  !< 0 to 1 [-]
      integer(ik), intent(in) :: tip_end

      share = x
      if (tip_end == 1) share = x**2
      if (tip_end == 2) share = 1.0_rk - (1.0_rk - x)**2
   end function line_place

   !> Derivative of line_place with respect to the parameter.
   elemental real(rk) function line_stretch(x, tip_end) result(stretch)
      real(rk), intent(in) :: x  !< 0 to 1 [-]
      integer(ik), intent(in) :: tip_end

      stretch = 1.0_rk
      if (tip_end == 1) stretch = 2.0_rk*x
      if (tip_end == 2) stretch = 2.0_rk*(1.0_rk - x)
   end function line_stretch

   !> Coarse jump at a node of a face, linear along the coarse cell; the unknown jumps are those at
   !! the third points.
   pure real(rk) function at_node(self, face, s, jump)
      class(face_map_t), intent(in) :: self
      integer(ik), intent(in) :: face
      real(rk), intent(in) :: s  !< arc length of the node [m]
      real(rk), intent(in) :: jump(2)  !< at the start and at the end of the coarse cell [m]
      real(rk) :: t

      associate (ends => self%ends(:, face))
         t = 3.0_rk*(s - ends(1))/(ends(2) - ends(1)) - 1.0_rk
      end associate
      at_node = (1.0_rk - t)*jump(1) + t*jump(2)
   end function at_node

end module twolevel_faces
