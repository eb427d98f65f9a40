!> The position of a window in the coarse mesh, and the coarse values that it takes: the pressure at
!! its vertices, the displacement on its edge.
!!
!! Admissible edges of a window: elements are of poor quality where an edge passes close to a vertex
!! of a fracture, or where a fracture crosses it at a small angle, near a corner or near another
!! fracture.
module twolevel_window_map
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_plane, only: barycentric
   use coarse_tip_drainage, only: drained_tip_t, pressure_at
   use fine_mesh, only: fine_mesh_t
   use mesh_builder, only: locate, mesher_t
   use mesh_types, only: mesh_t, network_t
   implicit none(type, external)
   private

   public :: clear_edges, window_map_t

   !> Least gap between fractures on the edge, over the clearance of vertices: smaller gaps lead to
   !! small elements; the mesher accepts about a tenth of this [-].
   real(rk), parameter :: narrow = 0.1_rk

   !> Distance, over the least gap, within which a crossing counts as at the corner [-].
   real(rk), parameter :: at_it = 1.0e-9_rk

   !> Map for the vertices and the nodes on the edge.
   type :: window_map_t
      !> (n_nodes) coarse cell that contains the node; 0 at other nodes
      integer(ik), allocatable :: coarse_cell(:)
      real(rk), allocatable :: weight(:, :)  !< (3, n_nodes) weights of the nodes of the coarse cell
      real(rk), allocatable :: temperature(:)  !< acting ones that the loads are for [K]
   contains
      procedure :: find
      procedure :: pressure
      procedure :: curved_edge
   end type window_map_t

contains

   !> Move edges outwards until they are admissible.
   pure subroutine clear_edges(network, clearance, lower, upper)
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: clearance  !< [m]
      real(rk), intent(inout) :: lower(2), upper(2)  !< corners [m]
      integer(ik) :: axis
      logical :: has_moved

      has_moved = .true.
      do while (has_moved)  ! moving an edge moves two corners
         has_moved = .false.
         do axis = 1, 2
            do while (is_in_the_way(network, axis, lower(axis), clearance, lower, upper))
               lower(axis) = lower(axis) - clearance
               has_moved = .true.
            end do
            do while (is_in_the_way(network, axis, upper(axis), clearance, lower, upper))
               upper(axis) = upper(axis) + clearance
               has_moved = .true.
            end do
         end do
      end do
   end subroutine clear_edges

   !> Whether an edge is inadmissible.
   pure logical function is_in_the_way(network, axis, edge, clearance, lower, upper)
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: axis  !< axis normal to the edge
      real(rk), intent(in) :: edge  !< coordinate of the edge along this axis [m]
      real(rk), intent(in) :: clearance  !< clearance from vertices [m]
      real(rk), intent(in) :: lower(2), upper(2)  !< corners [m]

      is_in_the_way = any(abs(network%xy(axis, :) - edge) < clearance)
      if (.not. is_in_the_way) is_in_the_way = is_cut_aslant(network, axis, edge)
      if (.not. is_in_the_way) then
         associate (along => 3 - axis)
            is_in_the_way = is_cut_closely(network, axis, edge, narrow*clearance, &
                                           lower(along), upper(along))
         end associate
      end if
   end function is_in_the_way

   !> Whether a fracture crosses an edge so near to a corner, or to another crossing, that no
   !! element of good quality fits between. Crossings within a window's width beyond the corners
   !! count: the edge may become longer.
   pure logical function is_cut_closely(network, axis, edge, gap, from, to)
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: axis  !< axis normal to the edge
      real(rk), intent(in) :: edge  !< coordinate of the edge along this axis [m]
      real(rk), intent(in) :: gap  !< least gap between crossings [m]
      real(rk), intent(in) :: from, to  !< corners along the edge [m]
      real(rk) :: place(size(network%xy, 2)), share
      integer(ik) :: f, i, n, v

      n = 0
      do f = 1, size(network%first, kind=ik) - 1
         do v = network%first(f), network%first(f + 1) - 2
            associate (a => network%xy(:, v), b => network%xy(:, v + 1))
               if ((a(axis) - edge)*(b(axis) - edge) >= 0.0_rk) cycle
               share = (edge - a(axis))/(b(axis) - a(axis))
               n = n + 1
               place(n) = a(3 - axis) + share*(b(3 - axis) - a(3 - axis))
               if (place(n) < 2.0_rk*from - to .or. place(n) > 2.0_rk*to - from) n = n - 1
            end associate
         end do
      end do
      is_cut_closely = any(is_beside(place(:n) - from) .or. is_beside(place(:n) - to))
      do i = 2, n
         is_cut_closely = is_cut_closely .or. any(abs(place(:i - 1) - place(i)) < gap)
      end do

   contains

      !> Near a corner, but not at the corner.
      elemental logical function is_beside(distance)
         real(rk), intent(in) :: distance  !< [m]

         is_beside = abs(distance) < gap .and. abs(distance) > at_it*gap
      end function is_beside

   end function is_cut_closely

   !> Whether a segment of a fracture crosses the line of an edge at a small angle.
   pure logical function is_cut_aslant(network, axis, edge)
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: axis  !< axis normal to the edge
      real(rk), intent(in) :: edge  !< coordinate of the edge along this axis [m]
      real(rk), parameter :: shallow = tan(5.0_rk*pi/180.0_rk)
      integer(ik) :: f, v

      is_cut_aslant = .false.
      do f = 1, size(network%first, kind=ik) - 1
         do v = network%first(f), network%first(f + 1) - 2
            associate (a => network%xy(:, v), b => network%xy(:, v + 1))
              is_cut_aslant = is_cut_aslant .or. ((a(axis) - edge)*(b(axis) - edge) < 0.0_rk .and. &
                                                   abs(b(axis) - a(axis)) < shallow &
                                                   *abs(b(3 - axis) - a(3 - axis)))
            end associate
         end do
      end do
   end function is_cut_aslant

   !> Locate the nodes; required again whenever one of the two meshes has changed.
   subroutine find(self, fine, mesher, coarse, error)
      class(window_map_t), intent(inout) :: self
      type(fine_mesh_t), intent(in) :: fine
      type(mesher_t), intent(in) :: mesher  !< mesher of the coarse mesh
      type(mesh_t), intent(in) :: coarse
      type(error_t), allocatable, intent(out) :: error
      !> share of the distance to the element's centre [-]
      real(rk), parameter :: inwards = 1.0e-4_rk
      real(rk), allocatable :: inside(:, :)
      real(rk) :: centre(2), corners(2, 3)
      integer(ik), allocatable :: located(:), cells(:)
      integer(ik) :: c, k, v

      if (allocated(self%weight)) deallocate (self%weight, self%coarse_cell)
      if (allocated(self%temperature)) deallocate (self%temperature)
      allocate (inside(2, fine%n_nodes))
      allocate (self%weight(3, fine%n_nodes), source=0.0_rk)
      allocate (self%coarse_cell(fine%n_nodes), source=0_ik)
      ! A point on a fracture belongs to the side on which its element lies.
      do c = 1, fine%n_cells
         corners = fine%xy(:, fine%cell_nodes(:3, c))
         centre = sum(corners, dim=2)/3.0_rk
         do k = 1, 6
            v = fine%cell_nodes(k, c)
            inside(:, v) = (1.0_rk - inwards)*fine%xy(:, v) + inwards*centre
         end do
      end do
      located = pack([(v, v=1, fine%n_nodes)], [(v <= fine%n_vertices .or. fine%on_boundary(v), &
                                                 v=1, fine%n_nodes)])
      allocate (cells(size(located)))
      call locate(mesher, inside(:, located), cells, error)
      if (allocated(error)) return
      self%coarse_cell(located) = cells
      do k = 1, size(located, kind=ik)
         corners = coarse%xy(:, coarse%cell_nodes(:, cells(k)))
         self%weight(:, located(k)) = barycentric(corners, fine%xy(:, located(k)))
      end do
   end subroutine find

   !> Pressure of the rock at the vertices of the window [Pa].
   pure function pressure(self, n, coarse, nodal, drained)
      class(window_map_t), intent(in) :: self
      integer(ik), intent(in) :: n  !< vertices
      type(mesh_t), intent(in) :: coarse
      real(rk), intent(in) :: nodal(:)  !< (coarse nodes) [Pa]
      type(drained_tip_t), intent(in) :: drained(:)
      real(rk) :: pressure(n)
      integer(ik) :: v

      do v = 1, n
         pressure(v) = pressure_at(drained, coarse, nodal, self%coarse_cell(v), self%weight(:, v))
      end do
   end function pressure

   !> Displacements of the window's edge, quadratic in each coarse cell: linear interpolation, plus
   !! half of the terms with the gradients at the nodes. Zero at other nodes.
   pure function curved_edge(self, fine, coarse, displacement, gradient) result(edge)
      class(window_map_t), intent(in) :: self
      type(fine_mesh_t), intent(in) :: fine
      type(mesh_t), intent(in) :: coarse
      real(rk), intent(in) :: displacement(:, :)  !< (2, coarse nodes) [m]
      real(rk), intent(in) :: gradient(:, :, :)  !< (2, 2, coarse nodes) [-]
      real(rk), allocatable :: edge(:, :)  !< (2, n_nodes) [m]
      integer(ik) :: k, v

      allocate (edge(2, fine%n_nodes), source=0.0_rk)
      do v = 1, fine%n_nodes
         if (.not. fine%on_boundary(v)) cycle
         associate (nodes => coarse%cell_nodes(:, self%coarse_cell(v)))
            do k = 1, 3
               edge(:, v) = edge(:, v) + self%weight(k, v) &
                            *(displacement(:, nodes(k)) &
                              + 0.5_rk*matmul(gradient(:, :, nodes(k)), &
                                              fine%xy(:, v) - coarse%xy(:, nodes(k))))
            end do
         end associate
      end do
   end function curved_edge

end module twolevel_window_map
