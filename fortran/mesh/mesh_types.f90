!> A mesh: triangles that conform to the fractures and are split along them.
!!
!! Orientation: a fracture is a polyline; tau is its direction and n = tau turned by +90 degrees
!! points from side + (on the right) to side - (on the left). The jump is [u] = u(-) - u(+):
!! [u]_n > 0 opens.
module mesh_types
   use base_kinds, only: ik, rk
   use base_lists, only: lists_t
   use base_texts, only: text_t
   implicit none(type, external)
   private

   public :: fracture_mesh_t, mesh_map_t, mesh_t, network_t, side_count
   public :: point_boundary, point_corner, point_interior, point_joint_t, point_joint_x, point_tip

   ! Kinds of fracture points. A joint is where fracture cells of more than one fracture meet.
   integer(ik), parameter :: point_interior = 0  !< inside one polyline (a kink too)
   integer(ik), parameter :: point_tip = 1  !< free tip: a single node of the mesh
   integer(ik), parameter :: point_boundary = 2  !< end on the outer boundary or a window's edge
   integer(ik), parameter :: point_joint_t = 3  !< end of one fracture inside another
   integer(ik), parameter :: point_joint_x = 4  !< two fractures cross (or more cells meet)
   integer(ik), parameter :: point_corner = 5  !< ends of two fractures meet (V)

   !> Sides of a rectangle: 1 left, 2 right, 3 bottom, 4 top; a polygon has the sides given for it.
   integer(ik), parameter :: side_count = 4

   !> Fractures as polylines.
   type :: network_t
      integer(ik), allocatable :: first(:)  !< (n+1) fracture f: vertices first(f) .. first(f+1)-1
      real(rk), allocatable :: xy(:, :)  !< (2, n_vertices) [m]
      !> (n) arc length of the first vertex [m]; below 0 after growth there
      real(rk), allocatable :: s_start(:)
      type(text_t), allocatable :: names(:)  !< (n) for messages; may be left out
   end type network_t

   !> The fractures' own mesh, one dimension lower. Cells are stored along each fracture's
   !! direction.
   type :: fracture_mesh_t
      integer(ik) :: n_cells = 0
      integer(ik) :: n_points = 0
      integer(ik) :: n_tips = 0
      integer(ik), allocatable :: cell_fracture(:)  !< (n_cells) index in the network
      integer(ik), allocatable :: cell_points(:, :)  !< (2, n_cells) start, end along the fracture
      integer(ik), allocatable :: cell_faces(:, :)  !< (2, n_cells) mesh faces on side +, side -
      real(rk), allocatable :: cell_s(:, :)  !< (2, n_cells) arc length of start and end [m]
      real(rk), allocatable :: point_xy(:, :)  !< (2, n_points) [m]
      integer(ik), allocatable :: point_kind(:)  !< (n_points) point_interior .. point_corner
      type(lists_t) :: point_cells  !< fracture cells that meet at each point
      ! Free tips.
      integer(ik), allocatable :: tip_point(:)  !< (n_tips) fracture point
      integer(ik), allocatable :: tip_node(:)  !< (n_tips) mesh node
      integer(ik), allocatable :: tip_fracture(:)  !< (n_tips) index in the network
      integer(ik), allocatable :: tip_end(:)  !< (n_tips) 1: start of the polyline, 2: its end
      real(rk), allocatable :: tip_direction(:, :)  !< (2, n_tips) unit vector, ahead of the tip
      real(rk), allocatable :: tip_radius(:)  !< (n_tips) rosette radius [m]; 0: no rosette
   end type fracture_mesh_t

   !> Triangles, split along the fractures: both sides of a fracture have nodes and faces of their
   !! own, but a free tip is one node.
   type :: mesh_t
      integer(ik) :: n_nodes = 0
      integer(ik) :: n_cells = 0
      integer(ik) :: n_faces = 0
      real(rk), allocatable :: xy(:, :)  !< (2, n_nodes) [m]
      integer(ik), allocatable :: cell_nodes(:, :)  !< (3, n_cells) counter-clockwise
      integer(ik), allocatable :: cell_faces(:, :)  !< (3, n_cells) face k: nodes k and mod(k,3)+1
      integer(ik), allocatable :: face_nodes(:, :)  !< (2, n_faces)
      !> (2, n_faces); the second is 0 on boundary and fracture faces
      integer(ik), allocatable :: face_cells(:, :)
      integer(ik), allocatable :: face_side(:)  !< (n_faces) side of the outer boundary; 0 elsewhere
      integer(ik), allocatable :: face_fracture_cell(:)  !< (n_faces) fracture cell; 0 elsewhere
      type(fracture_mesh_t) :: fracture
      ! Faces next to which pressures are resolved within the cell (coarse_layers):
      integer(ik) :: n_layers = 0
      integer(ik), allocatable :: layer_face(:)  !< (n_layers); unallocated: none
      integer(ik), allocatable :: face_layer(:)  !< (n_faces) its layer; 0 elsewhere
      integer(ik), allocatable :: cell_layer(:)  !< (n_cells) the first layer of the cell, or 0
   end type mesh_t

   !> From an old mesh to a new one that differs in a patch only.
   type :: mesh_map_t
      !> (new n_cells) the same cell in the old mesh; 0 inside the patch
      integer(ik), allocatable :: cell_old(:)
      !> (new n_cells+1) into the two arrays below; empty if cell_old > 0
      integer(ik), allocatable :: overlap_first(:)
      integer(ik), allocatable :: overlap_cell(:)  !< old cells that a new cell covers
      real(rk), allocatable :: overlap_area(:)  !< [m2]; they add up to the new cell's area
      !> (new fracture n_cells) the same cell before; 0 for a new one
      integer(ik), allocatable :: fracture_cell_old(:)
   end type mesh_map_t

end module mesh_types
