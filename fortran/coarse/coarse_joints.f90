!> The joints of a mesh: points where fluid flows from one fracture into others, or out of the body.
!!
!! A joint is a fracture point at which cells meet otherwise than one after the other along a
!! fracture: T, X, V, several fractures through one point, the ends of several on one place of the
!! boundary. An outlet is an end on a side with a prescribed pressure. Each has a separate pressure,
!! and each cell that reaches it a flow into it (coarse_fracture_flow).
!!
!! A joint has no fluid volume: the cells around it reach to the point itself, so their volumes,
!! aperture times length, contain the few square millimetres there already; a volume a*a would count
!! them twice.
!!
!! Flows round loops of fractures. The outflow at one end of an edge is the inflow at the other, so
!! the balances do not determine it: the pressure differences along the loop do, and in wide
!! fractures these are below the rounding of the pressures. Such a flow changes no balance and
!! hardly a pressure; only the flow itself is uncertain. (The condition of the equations does not
!! include flows.)
module coarse_joints
   use base_groups, only: groups_t, single_groups
   use base_kinds, only: ik, rk
   use base_lists, only: lists_t
   use base_plane, only: norm2
   use coarse_slopes, only: slopes_t
   use mesh_types, only: fracture_mesh_t, mesh_t, point_boundary, point_interior, point_tip
   use scene_sides, only: boundary_side_t
   implicit none(type, external)
   private

   public :: find_joints, flows_in_loops, joints_t, renew_outlets, unknown_flow

   !> Joints and outlets of one mesh. A branch is a cell that reaches one of them; its flow is
   !! positive into it.
   type :: joints_t
      integer(ik) :: n = 0  !< joints and outlets
      integer(ik), allocatable :: point(:)  !< (n) fracture point
      logical, allocatable :: is_outlet(:)  !< (n) its pressure is that of the side
      integer(ik), allocatable :: side(:)  !< (n) of outlets, in a corner one of two
      real(rk), allocatable :: side_pressure(:)  !< (n) of outlets [Pa]
      !> (n) in situ, beyond which pressures count (coarse_in_situ); unallocated: 0 [Pa]
      real(rk), allocatable :: pressure_in_situ(:)
      real(rk), allocatable :: injection(:)  !< (n) Q into the joint now [m2/s]
      type(lists_t) :: branches  !< (n lists) numbers of the branches of each
      integer(ik), allocatable :: cell(:)  !< (branches) fracture cell
      integer(ik), allocatable :: joint(:)  !< (branches) where it goes
      integer(ik), allocatable :: end(:)  !< (branches) 1: the cell's start is there, 2: its end
      !> (branches) the cell beyond the joint in which the fracture, or in a V the way, goes on; 0:
      !! none
      integer(ik), allocatable :: beyond(:)
      !> (branches) length of the way of the flow to the joint over half of the cell, shorter where
      !! much leaks off on it (coarse_well_ways) [-]
      real(rk), allocatable :: way(:)
      real(rk), allocatable :: way_error(:)  !< (branches) of the flow by that, relative [-]
      !> (branches) pressure that acts with that of the side, as other ways are right for its
      !! changes at other times [Pa]
      real(rk), allocatable :: excess(:)
      !> (branches) volume that flows by the changes of the side, without regard to signs [m2]
      real(rk), allocatable :: gross(:)
      !> (branches) no flow, since the crack has not reached the joint
      logical, allocatable :: is_shut(:)
   contains
      procedure :: shut_only
      procedure :: branch_count
      procedure :: mean_pressure
      procedure :: outflow
   end type joints_t

contains

   !> The joints and outlets of a mesh.
   pure subroutine find_joints(mesh, sides, joints)
      type(mesh_t), intent(in) :: mesh
      type(boundary_side_t), intent(in) :: sides(:)
      type(joints_t), intent(out) :: joints
      logical, allocatable :: is_given(:)
      real(rk), allocatable :: given(:)
      integer(ik) :: b, k, n_branches, point
      integer(ik), allocatable :: side(:)

      allocate (is_given(mesh%fracture%n_points), given(mesh%fracture%n_points))
      allocate (side(mesh%fracture%n_points))
      call find_side_pressures(mesh, sides, side, given)
      is_given = side > 0
      associate (fracture => mesh%fracture)
         allocate (joints%point, source=pack([(point, point=1, fracture%n_points)], &
                                             [(is_joint(fracture%point_kind(point), &
                                                        fracture%point_cells%length(point), &
                                                        is_given(point)), &
                                               point=1, fracture%n_points)]))
         joints%n = size(joints%point, kind=ik)
         joints%is_outlet = is_given(joints%point)
         joints%side = side(joints%point)
         joints%side_pressure = given(joints%point)
         allocate (joints%injection(joints%n), source=0.0_rk)
         allocate (joints%branches%first(joints%n + 1), source=1_ik)
         do k = 1, joints%n
            joints%branches%first(k + 1) = joints%branches%first(k) &
                                           + fracture%point_cells%length(joints%point(k))
         end do
         n_branches = joints%branches%first(joints%n + 1) - 1
         allocate (joints%branches%item, source=[(b, b=1, n_branches)])
         allocate (joints%cell(n_branches), joints%joint(n_branches), joints%end(n_branches))
         do k = 1, joints%n
            associate (first => joints%branches%first(k), last => joints%branches%last(k))
               joints%cell(first:last) = fracture%point_cells%of(joints%point(k))
               joints%joint(first:last) = k
               do b = first, last
                  joints%end(b) = merge(1_ik, 2_ik, &
                                        fracture%cell_points(1, joints%cell(b)) == joints%point(k))
               end do
            end associate
         end do
         allocate (joints%is_shut(n_branches), source=.false.)
         allocate (joints%way(n_branches), source=1.0_rk)
         allocate (joints%way_error(n_branches), source=0.0_rk)
         allocate (joints%excess(n_branches), source=0.0_rk)
         allocate (joints%gross(n_branches), source=0.0_rk)
         allocate (joints%beyond(n_branches))
         do b = 1, n_branches
            joints%beyond(b) = cell_beyond(fracture, joints, b)
         end do
      end associate
   end subroutine find_joints

   !> Shut the branches at some ends of cells that cracks have not reached, and open all others.
   pure subroutine shut_only(self, cell, end)
      class(joints_t), intent(inout) :: self
      integer(ik), intent(in) :: cell(:)  !< fracture cells
      integer(ik), intent(in) :: end(:)  !< of each: 1 its start, 2 its end
      integer(ik) :: b

      do b = 1, self%branch_count()
         self%is_shut(b) = any(cell == self%cell(b) .and. end == self%end(b))
      end do
   end subroutine shut_only

   !> The cell in which the flow path continues beyond the joint of a branch; 0: none. Cells are
   !! stored along each fracture.
   pure integer(ik) function cell_beyond(fracture, joints, branch) result(cell)
      type(fracture_mesh_t), intent(in) :: fracture
      type(joints_t), intent(in) :: joints
      integer(ik), intent(in) :: branch
      integer(ik) :: b, j, step

      cell = 0
      j = joints%joint(branch)
      step = merge(-1_ik, 1_ik, joints%end(branch) == 1)
      do b = joints%branches%first(j), joints%branches%last(j)
         associate (own => joints%cell(branch), other => joints%cell(b))
            if (other - own == step .and. &
                fracture%cell_fracture(other) == fracture%cell_fracture(own)) cell = other
            if (joints%branches%length(j) == 2 .and. b /= branch) cell = other
         end associate
      end do
   end function cell_beyond

   !> Whether flow at a fracture point is not only that along one fracture.
   pure logical function is_joint(kind, n_cells, is_given)
      integer(ik), intent(in) :: kind  !< of the point
      integer(ik), intent(in) :: n_cells  !< that meet there
      logical, intent(in) :: is_given  !< it lies on a side with a pressure

      select case (kind)
      case (point_interior, point_tip)
         is_joint = .false.
      case (point_boundary)
         is_joint = is_given .or. n_cells > 1
      case default
         is_joint = .true.
      end select
   end function is_joint

   !> Update the pressures of the sides.
   pure subroutine renew_outlets(mesh, sides, joints)
      type(mesh_t), intent(in) :: mesh
      type(boundary_side_t), intent(in) :: sides(:)
      type(joints_t), intent(inout) :: joints
      integer(ik) :: side(mesh%fracture%n_points)
      real(rk) :: given(mesh%fracture%n_points)

      call find_side_pressures(mesh, sides, side, given)
      joints%side_pressure = given(joints%point)
   end subroutine renew_outlets

   !> Prescribed pressures of the sides at fracture points; in a corner the mean of two.
   pure subroutine find_side_pressures(mesh, sides, side, given)
      type(mesh_t), intent(in) :: mesh
      type(boundary_side_t), intent(in) :: sides(:)
      integer(ik), intent(out) :: side(:)  !< (fracture points) with a pressure; 0: none
      real(rk), intent(out) :: given(:)  !< (fracture points) [Pa]; 0 elsewhere
      integer(ik) :: around(size(side)), f, k, point
      integer(ik), allocatable :: point_of_node(:)

      given = 0.0_rk
      around = 0
      side = 0
      if (.not. any(sides%pressure_given)) return
      allocate (point_of_node(mesh%n_nodes), source=0_ik)
      do k = 1, mesh%fracture%n_cells
         call name_nodes(mesh, k, point_of_node)
      end do
      do f = 1, mesh%n_faces
         if (mesh%face_side(f) == 0) cycle
         if (.not. sides(mesh%face_side(f))%pressure_given) cycle
         do k = 1, 2
            point = point_of_node(mesh%face_nodes(k, f))
            if (point == 0) cycle
            if (mesh%fracture%point_kind(point) /= point_boundary) cycle
            given(point) = given(point) + sides(mesh%face_side(f))%pressure
            around(point) = around(point) + 1
            side(point) = mesh%face_side(f)
         end do
      end do
      given = given/max(around, 1_ik)
   end subroutine find_side_pressures

   !> Assign the nodes of both faces of a fracture cell to fracture points.
   pure subroutine name_nodes(mesh, cell, point_of_node)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell  !< fracture cell
      integer(ik), intent(inout) :: point_of_node(:)
      integer(ik) :: k, side
      real(rk) :: distance(2)

      associate (points => mesh%fracture%cell_points(:, cell))
         do side = 1, 2
            associate (nodes => mesh%face_nodes(:, mesh%fracture%cell_faces(side, cell)))
               do k = 1, 2
                  distance = norm2(mesh%fracture%point_xy(:, points) &
                                   - spread(mesh%xy(:, nodes(k)), 2, 2), dim=1)
                  point_of_node(nodes(k)) = points(minloc(distance, dim=1))
               end do
            end associate
         end do
      end associate
   end subroutine name_nodes

   !> Number of branches; a cell between two joints has two.
   pure integer(ik) function branch_count(self)
      class(joints_t), intent(in) :: self

      branch_count = 0
      if (allocated(self%cell)) branch_count = size(self%cell, kind=ik)
   end function branch_count

   !> The mean pressure of the cells around a joint; the side's at an outlet.
   pure real(rk) function mean_pressure(self, joint, pressure)
      class(joints_t), intent(in) :: self
      integer(ik), intent(in) :: joint
      real(rk), intent(in) :: pressure(:)  !< (fracture cells) [Pa]

      if (self%is_outlet(joint)) then
         mean_pressure = self%side_pressure(joint)
      else
         mean_pressure = sum(pressure(self%cell(self%branches%of(joint)))) &
                         /self%branches%length(joint)
      end if
   end function mean_pressure

   !> Outflow of the body through the ends of fractures [m2/s].
   pure real(rk) function outflow(self, flow, supplied)
      class(joints_t), intent(in) :: self
      real(rk), intent(in) :: flow(:)  !< (branches) into the joints [m2/s]
      real(rk), intent(in) :: supplied(:)  !< (joints) by wells [m2/s]

      outflow = 0.0_rk
      if (self%n > 0) outflow = sum(flow, mask=self%is_outlet(self%joint)) &
                                + sum(supplied, mask=self%is_outlet)
   end function outflow

   !> Whether flows belong to a network with a loop: those between pairs of cells, then those of the
   !! branches. All outlets count as one point, since the flow between two of them is as
   !! undetermined as in a loop.
   pure function flows_in_loops(n_cells, connections, joints) result(in_loop)
      integer(ik), intent(in) :: n_cells  !< fracture cells
      integer(ik), intent(in) :: connections(:, :)  !< (2, pairs) cells that exchange fluid
      type(joints_t), intent(in) :: joints
      logical, allocatable :: in_loop(:)  !< (pairs, then branches)
      type(groups_t) :: groups
      logical :: closes, has_loop(n_cells + joints%n + 1)
      integer(ik), allocatable :: closing(:), edge(:, :), number(:)
      integer(ik) :: b, k, outside

      outside = n_cells + joints%n + 1
      allocate (edge(2, size(connections, 2) + joints%branch_count()), closing(0))
      edge(:, :size(connections, 2)) = connections
      do b = 1, joints%branch_count()
         edge(:, size(connections, 2) + b) = [joints%cell(b), n_cells + joints%joint(b)]
         if (joints%is_outlet(joints%joint(b))) edge(2, size(connections, 2) + b) = outside
      end do
      groups = single_groups(outside)
      do k = 1, size(edge, 2, kind=ik)
         call groups%join(edge(1, k), edge(2, k), closes)
         if (closes) closing = [closing, k]
      end do
      number = groups%numbers()
      has_loop = .false.
      has_loop(number(edge(1, closing))) = .true.
      in_loop = has_loop(number(edge(1, :)))
   end function flows_in_loops

   !> The largest flow round a loop driven by an unknown pressure difference, in the unit of the
   !! flows [Pa].
   pure function unknown_flow(slopes, at_first, in_loop, difference) result(flow)
      type(slopes_t), intent(in) :: slopes
      integer(ik), intent(in) :: at_first  !< the number of the first flow
      logical, intent(in) :: in_loop(:)  !< (flows)
      real(rk), intent(in) :: difference  !< [Pa]
      real(rk) :: flow
      real(rk) :: resistance(size(in_loop))
      integer(ik) :: k

      resistance = 0.0_rk
      do k = 1, slopes%n_local
         associate (row => slopes%row(k), number => slopes%row(k) - at_first + 1)
            if (row /= slopes%col(k) .or. number < 1 .or. number > size(in_loop)) cycle
            resistance(number) = resistance(number) + slopes%value(k)
         end associate
      end do
      flow = 0.0_rk
      if (any(in_loop)) flow = difference/max(minval(resistance, mask=in_loop), tiny(1.0_rk))
   end function unknown_flow

end module coarse_joints
