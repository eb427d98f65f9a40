!> The position of a window in the coarse mesh, and the coarse values that it takes: the pressure at
!! its vertices, the displacement on its edge.
module twolevel_window_map
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_plane, only: barycentric
   use fine_mesh, only: fine_mesh_t
   use mesh_builder, only: locate, mesher_t
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: window_map_t

   !> Map for the vertices and the nodes on the edge.
   type :: window_map_t
      !> (n_nodes) coarse cell that contains the node; 0 at other nodes
      integer(ik), allocatable :: coarse_cell(:)
      real(rk), allocatable :: weight(:, :)  !< (3, n_nodes) weights of the nodes of the coarse cell
   contains
      procedure :: find
      procedure :: interpolate
      procedure :: curved_edge
   end type window_map_t

contains

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

   !> Interpolate values at the coarse nodes linearly to the first nodes of the window.
   pure subroutine interpolate(self, coarse, nodal, values)
      class(window_map_t), intent(in) :: self
      type(mesh_t), intent(in) :: coarse
      real(rk), intent(in) :: nodal(:)  !< (coarse nodes)
      real(rk), intent(out) :: values(:)  !< (vertices)
      integer(ik) :: v

      do v = 1, size(values, kind=ik)
         associate (nodes => coarse%cell_nodes(:, self%coarse_cell(v)))
            values(v) = dot_product(nodal(nodes), self%weight(:, v))
         end associate
      end do
   end subroutine interpolate

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
