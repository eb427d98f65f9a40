!> Input of the C++ mesh library: specifications and networks, with indices from 0.
!!
!! Output of the C++ mesh library: meshes and maps, converted to indices from 1.
module mesh_c_arrays
   use, intrinsic :: iso_c_binding, only: c_loc, c_ptr
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use mesh_c_binding, only: cm_arrays_t, cm_copy, cm_counts_t, cm_map_copy, cm_map_sizes, &
                             cm_network_t, cm_sizes, cm_spec_t
   use mesh_faults, only: raise_library_error
   use mesh_types, only: mesh_map_t, mesh_t, network_t
   implicit none(type, external)
   private

   public :: c_network_arrays_t, copy_map, copy_mesh, corner_share, mesh_spec_t, prepare_network
   public :: prepare_spec

   !> Size of finite elements at corners, where fractures meet or turn, over that along fractures:
   !! the stress has a weak singularity there, which causes a first-order error of K of tips
   !! nearby [-].
   real(rk), parameter :: corner_share = 1.0_rk/32.0_rk

   !> What to mesh: a rectangle or a polygon with the fractures in it.
   type :: mesh_spec_t
      real(rk) :: x_min = 0.0_rk, x_max = 0.0_rk  !< [m]
      real(rk) :: y_min = 0.0_rk, y_max = 0.0_rk  !< [m]
      real(rk) :: size_fracture = 0.0_rk  !< cells at the fractures [m]
      real(rk) :: size_boundary = 0.0_rk  !< cells far from them [m]
      logical :: is_window = .false.  !< fractures may be cut by the edges
      integer(ik) :: rosette_sectors = 0  !< elements around each free tip; 0: no rosettes
      real(rk) :: rosette_radius = 0.0_rk  !< [m]; less where something is near
      !> (2, n) corners of a polygon, counter-clockwise [m]; not allocated: the rectangle
      real(rk), allocatable :: corners(:, :)
      !> (n) side number (1 or more) of the edge from each corner to the next one
      integer(ik), allocatable :: edge_side(:)
      !> (2, n) places that become nodes: on the boundary, inside, on fractures [m]
      real(rk), allocatable :: fixed_points(:, :)
      !> (2, n_fractures) rosette radius at start and end [m]; 0: rosette_radius
      real(rk), allocatable :: end_radius(:, :)
      integer(ik), allocatable :: guide_count(:)  !< points of each guide
      !> (2, n) lines that cells follow where there is room, one after the other [m]
      real(rk), allocatable :: guides(:, :)
      real(rk) :: joint_size = 0.0_rk  !< cells where fractures meet [m]; 0: size_fracture
      !> (2, n) places away from which cells grow along fractures, too [m]; they do not if absent
      real(rk), allocatable :: foci(:, :)
      real(rk) :: focus_slope = 0.0_rk  !< growth of sizes per distance from the nearest of them [-]
      real(rk) :: focus_size = 0.0_rk  !< largest size along fractures that this leads to [m]
      logical :: is_rough = .false.  !< faster triangles, which gmsh does not smooth
      real(rk) :: ring_slope = 0.0_rk  !< growth of sizes around rosettes [-]; 0: usual
      !> (n_fractures) size along each fracture [m]; 0: size_fracture, which is the smallest of all
      real(rk), allocatable :: own_size(:)
      !> (4, n) places with smaller cells: x, y, their size, and how far around they have it [m]
      real(rk), allocatable :: refined(:, :)
   contains
      procedure :: refine
   end type mesh_spec_t

   !> What a network of C points to; it must outlive the call and be a target.
   type :: c_network_arrays_t
      integer(ik), allocatable :: first(:)  !< (n+1) from 0
      real(rk), allocatable :: xy(:, :)  !< (2, n_vertices) [m]
      real(rk), allocatable :: s_start(:)  !< (n) [m]
   end type c_network_arrays_t

contains

   !> Add places with smaller cells, which grow from there, or from a radius around each.
   pure subroutine refine(self, places, size, radius)
      class(mesh_spec_t), intent(inout) :: self
      real(rk), intent(in) :: places(:, :)  !< (2, n) [m]
      real(rk), intent(in) :: size  !< of the cells [m]
      real(rk), intent(in), optional :: radius  !< [m]
      real(rk) :: around
      integer :: i

      around = 0.0_rk
      if (present(radius)) around = radius
      if (.not. allocated(self%refined)) allocate (self%refined(4, 0))
      self%refined = reshape([self%refined, [(places(:, i), size, around, &
                                              i=1, ubound(places, 2))]], &
                             [4, ubound(self%refined, 2) + ubound(places, 2)])
   end subroutine refine

   !> The specification as C sees it; the structure points to its arrays.
   subroutine prepare_spec(spec, n_fractures, c_spec, error)
      type(mesh_spec_t), intent(in), target :: spec
      integer(ik), intent(in) :: n_fractures
      type(cm_spec_t), intent(out) :: c_spec
      type(error_t), allocatable, intent(out) :: error

      c_spec%x_min = spec%x_min
      c_spec%x_max = spec%x_max
      c_spec%y_min = spec%y_min
      c_spec%y_max = spec%y_max
      c_spec%size_fracture = spec%size_fracture
      c_spec%size_boundary = spec%size_boundary
      c_spec%is_window = merge(1_ik, 0_ik, spec%is_window)
      c_spec%rosette_sectors = spec%rosette_sectors
      c_spec%rosette_radius = spec%rosette_radius
      c_spec%joint_size = spec%joint_size
      c_spec%ring_slope = spec%ring_slope
      if (allocated(spec%refined)) then
         c_spec%n_refined = ubound(spec%refined, 2)
         if (c_spec%n_refined > 0) c_spec%refined = c_loc(spec%refined)
      end if
      c_spec%is_rough = merge(1_ik, 0_ik, spec%is_rough)
      if (allocated(spec%foci)) then
         c_spec%n_foci = ubound(spec%foci, 2)
         if (c_spec%n_foci > 0) c_spec%foci = c_loc(spec%foci)
         c_spec%focus_slope = spec%focus_slope
         c_spec%focus_size = spec%focus_size
      end if
      if (allocated(spec%corners)) then
         if (.not. allocated(spec%edge_side)) then
            call raise_error(error, "mesh_builder", "the edges of the polygon have no sides")
            return
         end if
         if (ubound(spec%corners, 1) /= 2 .or. &
             ubound(spec%corners, 2) /= ubound(spec%edge_side, 1)) then
            call raise_error(error, "mesh_builder", "corners and sides do not fit each other")
            return
         end if
         c_spec%n_corners = ubound(spec%corners, 2)
         c_spec%corners = c_loc(spec%corners)
         c_spec%edge_side = c_loc(spec%edge_side)
      end if
      if (allocated(spec%fixed_points)) then
         if (ubound(spec%fixed_points, 1) /= 2) then
            call raise_error(error, "mesh_builder", "a fixed point has an x and a y")
            return
         end if
         c_spec%n_fixed = ubound(spec%fixed_points, 2)
         if (c_spec%n_fixed > 0) c_spec%fixed = c_loc(spec%fixed_points)
      end if
      if (allocated(spec%end_radius)) then
         if (ubound(spec%end_radius, 1) /= 2 .or. ubound(spec%end_radius, 2) /= n_fractures) then
            call raise_error(error, "mesh_builder", "every fracture has two rosette radii")
            return
         end if
         if (n_fractures > 0) c_spec%end_radius = c_loc(spec%end_radius)
      end if
      if (allocated(spec%own_size)) then
         if (ubound(spec%own_size, 1) /= n_fractures) then
            call raise_error(error, "mesh_builder", "every fracture has one size")
            return
         end if
         if (n_fractures > 0) c_spec%own_size = c_loc(spec%own_size)
      end if
      if (allocated(spec%guides)) then
         c_spec%n_guides = ubound(spec%guide_count, 1)
         c_spec%guide_count = c_loc(spec%guide_count)
         c_spec%guide_xy = c_loc(spec%guides)
      end if
   end subroutine prepare_spec

   !> The network as C sees it; the arrays keep what the structure points to.
   subroutine prepare_network(network, arrays, c_network, error)
      type(network_t), intent(in) :: network
      type(c_network_arrays_t), intent(out), target :: arrays
      type(cm_network_t), intent(out) :: c_network
      type(error_t), allocatable, intent(out) :: error
      integer :: n

      if (allocated(network%first)) then
         arrays%first = network%first - 1
         arrays%xy = network%xy
         arrays%s_start = network%s_start
      else
         allocate (arrays%first(1), source=0_ik)
         allocate (arrays%xy(2, 0), arrays%s_start(0))
      end if
      associate (first => arrays%first, xy => arrays%xy)
         n = ubound(first, 1) - 1
         if (n < 0 .or. ubound(xy, 1) /= 2 .or. ubound(arrays%s_start, 1) /= n) then
            call raise_error(error, "mesh_builder", &
                             "the arrays of the network do not fit each other")
            return
         end if
         if (first(1) /= 0 .or. first(n + 1) /= ubound(xy, 2) .or. any(first(2:) < first(:n))) then
            call raise_error(error, "mesh_builder", "the vertices of the network are not in order")
            return
         end if
      end associate
      c_network%n_fractures = n
      c_network%first = c_loc(arrays%first)
      if (n > 0) then
         c_network%xy = c_loc(arrays%xy)
         c_network%s_start = c_loc(arrays%s_start)
      end if
   end subroutine prepare_network

   !> Take the mesh over from C++.
   subroutine copy_mesh(handle, mesh, error)
      type(c_ptr), intent(in) :: handle  !< of the library
      type(mesh_t), intent(out), target :: mesh
      type(error_t), allocatable, intent(out) :: error
      type(cm_counts_t) :: counts
      type(cm_arrays_t) :: arrays

      if (cm_sizes(handle, counts) /= 0) then
         call raise_library_error(error, "copy_mesh")
         return
      end if
      call allocate_mesh(counts, mesh)
      call point_to_matrix(mesh, arrays)
      call point_to_fractures(mesh, arrays)
      if (cm_copy(handle, arrays) /= 0) then
         call raise_library_error(error, "copy_mesh")
         return
      end if
      mesh%cell_nodes = mesh%cell_nodes + 1
      mesh%cell_faces = mesh%cell_faces + 1
      mesh%face_nodes = mesh%face_nodes + 1
      mesh%face_cells = mesh%face_cells + 1
      mesh%face_fracture_cell = mesh%face_fracture_cell + 1
      associate (f => mesh%fracture)
         f%cell_fracture = f%cell_fracture + 1
         f%cell_points = f%cell_points + 1
         f%cell_faces = f%cell_faces + 1
         f%point_cells%first = f%point_cells%first + 1
         f%point_cells%item = f%point_cells%item + 1
         f%tip_point = f%tip_point + 1
         f%tip_node = f%tip_node + 1
         f%tip_fracture = f%tip_fracture + 1
      end associate
   end subroutine copy_mesh

   !> Where C++ puts nodes, cells and faces.
   subroutine point_to_matrix(mesh, arrays)
      type(mesh_t), intent(in), target :: mesh
      type(cm_arrays_t), intent(inout) :: arrays

      arrays%xy = c_loc(mesh%xy)
      arrays%cell_nodes = c_loc(mesh%cell_nodes)
      arrays%cell_faces = c_loc(mesh%cell_faces)
      arrays%face_nodes = c_loc(mesh%face_nodes)
      arrays%face_cells = c_loc(mesh%face_cells)
      arrays%face_side = c_loc(mesh%face_side)
      arrays%face_fracture_cell = c_loc(mesh%face_fracture_cell)
   end subroutine point_to_matrix

   !> Where C++ puts fracture cells, points and tips; an empty array has no address.
   subroutine point_to_fractures(mesh, arrays)
      type(mesh_t), intent(in), target :: mesh
      type(cm_arrays_t), intent(inout) :: arrays

      arrays%point_first = c_loc(mesh%fracture%point_cells%first)
      if (mesh%fracture%n_cells > 0) then
         arrays%fcell_fracture = c_loc(mesh%fracture%cell_fracture)
         arrays%fcell_points = c_loc(mesh%fracture%cell_points)
         arrays%fcell_faces = c_loc(mesh%fracture%cell_faces)
         arrays%fcell_s = c_loc(mesh%fracture%cell_s)
         arrays%point_xy = c_loc(mesh%fracture%point_xy)
         arrays%point_kind = c_loc(mesh%fracture%point_kind)
         arrays%point_cells = c_loc(mesh%fracture%point_cells%item)
      end if
      if (mesh%fracture%n_tips > 0) then
         arrays%tip_point = c_loc(mesh%fracture%tip_point)
         arrays%tip_node = c_loc(mesh%fracture%tip_node)
         arrays%tip_fracture = c_loc(mesh%fracture%tip_fracture)
         arrays%tip_end = c_loc(mesh%fracture%tip_end)
         arrays%tip_direction = c_loc(mesh%fracture%tip_direction)
         arrays%tip_radius = c_loc(mesh%fracture%tip_radius)
      end if
   end subroutine point_to_fractures

   !> Allocate the arrays of a mesh.
   subroutine allocate_mesh(counts, mesh)
      type(cm_counts_t), intent(in) :: counts
      type(mesh_t), intent(inout) :: mesh

      mesh%n_nodes = counts%n_nodes
      mesh%n_cells = counts%n_cells
      mesh%n_faces = counts%n_faces
      allocate (mesh%xy(2, counts%n_nodes))
      allocate (mesh%cell_nodes(3, counts%n_cells), mesh%cell_faces(3, counts%n_cells))
      allocate (mesh%face_nodes(2, counts%n_faces), mesh%face_cells(2, counts%n_faces))
      allocate (mesh%face_side(counts%n_faces), mesh%face_fracture_cell(counts%n_faces))
      associate (f => mesh%fracture, n => counts%n_fracture_cells)
         f%n_cells = n
         f%n_points = counts%n_fracture_points
         f%n_tips = counts%n_tips
         allocate (f%cell_fracture(n), f%cell_points(2, n), f%cell_faces(2, n), f%cell_s(2, n))
         allocate (f%point_xy(2, f%n_points), f%point_kind(f%n_points))
         allocate (f%point_cells%first(f%n_points + 1), f%point_cells%item(counts%n_point_cells))
         allocate (f%tip_point(f%n_tips), f%tip_node(f%n_tips), f%tip_fracture(f%n_tips))
         allocate (f%tip_end(f%n_tips), f%tip_direction(2, f%n_tips), f%tip_radius(f%n_tips))
      end associate
   end subroutine allocate_mesh

   !> Take over how the new mesh covers the old one.
   subroutine copy_map(handle, mesh, map, error)
      type(c_ptr), intent(in) :: handle  !< of the library
      type(mesh_t), intent(in) :: mesh
      type(mesh_map_t), intent(out) :: map
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: n_overlaps

      if (cm_map_sizes(handle, n_overlaps) /= 0) then
         call raise_library_error(error, "copy_map")
         return
      end if
      allocate (map%cell_old(mesh%n_cells), map%overlap_first(mesh%n_cells + 1))
      allocate (map%overlap_cell(n_overlaps), map%overlap_area(n_overlaps))
      allocate (map%fracture_cell_old(mesh%fracture%n_cells))
      if (cm_map_copy(handle, map%cell_old, map%overlap_first, map%overlap_cell, &
                      map%overlap_area, map%fracture_cell_old) /= 0) then
         call raise_library_error(error, "copy_map")
         return
      end if
      map%cell_old = map%cell_old + 1
      map%overlap_first = map%overlap_first + 1
      map%overlap_cell = map%overlap_cell + 1
      map%fracture_cell_old = map%fracture_cell_old + 1
   end subroutine copy_map

end module mesh_c_arrays
