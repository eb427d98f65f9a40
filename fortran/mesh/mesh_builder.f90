!> Meshes for the other rooms: the only place where C++ indices (from 0) become Fortran's (from 1).
module mesh_builder
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use mesh_c_binding, only: c_string_length, cm_arrays_t, cm_copy, cm_counts_t, cm_create, &
                             cm_destroy, cm_last_error, cm_locate, cm_map_copy, cm_map_sizes, &
                             cm_network_t, cm_remesh, cm_sizes, cm_spec_t
   use mesh_types, only: mesh_map_t, mesh_t, network_t
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_loc, c_null_ptr, &
                                                                             c_ptr
   implicit none(type, external)
   private

   public :: mesh_spec_t, mesher_t
   public :: build_mesh, locate, remesh, transfer_mesher

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
   end type mesh_spec_t

   !> Owns a mesh of the C++ library. It cannot be copied: assigning one leaves the left side
   !! empty; use transfer_mesher to move one.
   type :: mesher_t
      private
      type(c_ptr) :: handle = c_null_ptr
   contains
      procedure, private :: assign_nothing
      generic :: assignment(=) => assign_nothing
      final :: destroy_mesher
   end type mesher_t

contains

   !> Mesh a body and its fractures.
   subroutine build_mesh(spec, network, mesher, mesh, error)
      type(mesh_spec_t), intent(in) :: spec
      type(network_t), intent(in) :: network
      type(mesher_t), intent(inout) :: mesher  !< what it held before is released
      type(mesh_t), intent(out) :: mesh
      type(error_t), allocatable, intent(out) :: error
      type(cm_spec_t) :: c_spec
      type(cm_network_t) :: c_network
      type(mesh_spec_t), target :: kept
      integer(ik), allocatable, target :: first(:)
      real(rk), allocatable, target :: xy(:, :), s_start(:)

      call destroy_mesher(mesher)
      call prepare_network(network, first, xy, s_start, c_network, error)
      if (allocated(error)) return
      kept = spec
      call prepare_spec(kept, c_network%n_fractures, c_spec, error)
      if (allocated(error)) return
      if (cm_create(c_spec, c_network, mesher%handle) /= 0) then
         call raise_library_error(error, "build_mesh")
         return
      end if
      call copy_mesh(mesher, mesh, error)
   end subroutine build_mesh

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
   end subroutine prepare_spec

   !> A mesh that differs from an old one only near the given centres, where fractures have grown.
   !! The old mesher stays as it is.
   subroutine remesh(mesher_old, network, centres, radius, size, mesher_new, mesh, map, error)
      type(mesher_t), intent(in) :: mesher_old
      type(network_t), intent(in) :: network  !< the old one, vertices added at its ends
      real(rk), intent(in) :: centres(:, :)  !< (2, n) [m]
      real(rk), intent(in) :: radius  !< of the patches [m]; enlarged to hold new segments
      real(rk), intent(in) :: size  !< length of new fracture cells [m]
      type(mesher_t), intent(inout) :: mesher_new  !< what it held before is released
      type(mesh_t), intent(out) :: mesh
      type(mesh_map_t), intent(out) :: map
      type(error_t), allocatable, intent(out) :: error
      type(cm_network_t) :: c_network
      integer(ik), allocatable, target :: first(:)
      real(rk), allocatable, target :: xy(:, :), s_start(:)
      integer :: status

      call destroy_mesher(mesher_new)
      if (.not. c_associated(mesher_old%handle)) then
         call raise_error(error, "remesh", "there is no old mesh; build one first")
         return
      end if
      call prepare_network(network, first, xy, s_start, c_network, error)
      if (allocated(error)) return
      status = cm_remesh(mesher_old%handle, c_network, int(ubound(centres, 2), ik), centres, &
                         radius, size, mesher_new%handle)
      if (status /= 0) then
         call raise_library_error(error, "remesh")
         return
      end if
      call copy_mesh(mesher_new, mesh, error)
      if (allocated(error)) return
      call copy_map(mesher_new, mesh, map, error)
   end subroutine remesh

   !> The cell that holds each point; 0 outside.
   subroutine locate(mesher, xy, cells, error)
      type(mesher_t), intent(in) :: mesher
      real(rk), intent(in) :: xy(:, :)  !< (2, n) [m]
      integer(ik), intent(out) :: cells(:)  !< (n)
      type(error_t), allocatable, intent(out) :: error

      if (.not. c_associated(mesher%handle)) then
         cells = 0
         call raise_error(error, "locate", "there is no mesh; build one first")
      else if (cm_locate(mesher%handle, int(ubound(xy, 2), ik), xy, cells) /= 0) then
         cells = 0
         call raise_library_error(error, "locate")
      else
         cells = cells + 1
      end if
   end subroutine locate

   !> Move a mesh from one owner to another; what the other held before is released.
   subroutine transfer_mesher(from, to)
      type(mesher_t), intent(inout) :: from  !< empty afterwards
      type(mesher_t), intent(inout) :: to

      call destroy_mesher(to)
      to%handle = from%handle
      from%handle = c_null_ptr
   end subroutine transfer_mesher

   !> Copying a mesher would make two owners of one mesh: the copy is empty.
   subroutine assign_nothing(left, right)
      class(mesher_t), intent(inout) :: left
      type(mesher_t), intent(in) :: right

      if (c_associated(left%handle) .and. .not. c_associated(left%handle, right%handle)) then
         call cm_destroy(left%handle)
      end if
   end subroutine assign_nothing

   !> Release the mesh.
   subroutine destroy_mesher(self)
      type(mesher_t), intent(inout) :: self

      if (c_associated(self%handle)) call cm_destroy(self%handle)
   end subroutine destroy_mesher

   !> The network as C sees it; the arrays keep what the structure points to.
   subroutine prepare_network(network, first, xy, s_start, c_network, error)
      type(network_t), intent(in) :: network
      integer(ik), allocatable, target, intent(out) :: first(:)
      real(rk), allocatable, target, intent(out) :: xy(:, :), s_start(:)
      type(cm_network_t), intent(out) :: c_network
      type(error_t), allocatable, intent(out) :: error
      integer :: n

      if (allocated(network%first)) then
         first = network%first - 1
         xy = network%xy
         s_start = network%s_start
      else
         allocate (first(1), source=0_ik)
         allocate (xy(2, 0), s_start(0))
      end if
      n = ubound(first, 1) - 1
      if (n < 0 .or. ubound(xy, 1) /= 2 .or. ubound(s_start, 1) /= n) then
         call raise_error(error, "mesh_builder", "the arrays of the network do not fit each other")
         return
      end if
      if (first(1) /= 0 .or. first(n + 1) /= ubound(xy, 2) .or. any(first(2:) < first(:n))) then
         call raise_error(error, "mesh_builder", "the vertices of the network are not in order")
         return
      end if
      c_network%n_fractures = n
      c_network%first = c_loc(first)
      if (n > 0) then
         c_network%xy = c_loc(xy)
         c_network%s_start = c_loc(s_start)
      end if
   end subroutine prepare_network

   !> Take the mesh over from C++.
   subroutine copy_mesh(mesher, mesh, error)
      type(mesher_t), intent(in) :: mesher
      type(mesh_t), intent(out), target :: mesh
      type(error_t), allocatable, intent(out) :: error
      type(cm_counts_t) :: counts
      type(cm_arrays_t) :: arrays

      if (cm_sizes(mesher%handle, counts) /= 0) then
         call raise_library_error(error, "copy_mesh")
         return
      end if
      call allocate_mesh(counts, mesh)
      call point_to_matrix(mesh, arrays)
      call point_to_fractures(mesh, arrays)
      if (cm_copy(mesher%handle, arrays) /= 0) then
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
         f%point_first = f%point_first + 1
         f%point_cells = f%point_cells + 1
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

      arrays%point_first = c_loc(mesh%fracture%point_first)
      if (mesh%fracture%n_cells > 0) then
         arrays%fcell_fracture = c_loc(mesh%fracture%cell_fracture)
         arrays%fcell_points = c_loc(mesh%fracture%cell_points)
         arrays%fcell_faces = c_loc(mesh%fracture%cell_faces)
         arrays%fcell_s = c_loc(mesh%fracture%cell_s)
         arrays%point_xy = c_loc(mesh%fracture%point_xy)
         arrays%point_kind = c_loc(mesh%fracture%point_kind)
         arrays%point_cells = c_loc(mesh%fracture%point_cells)
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

   !> Make room.
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
         allocate (f%point_first(f%n_points + 1), f%point_cells(counts%n_point_cells))
         allocate (f%tip_point(f%n_tips), f%tip_node(f%n_tips), f%tip_fracture(f%n_tips))
         allocate (f%tip_end(f%n_tips), f%tip_direction(2, f%n_tips), f%tip_radius(f%n_tips))
      end associate
   end subroutine allocate_mesh

   !> Take over how the new mesh covers the old one.
   subroutine copy_map(mesher, mesh, map, error)
      type(mesher_t), intent(in) :: mesher
      type(mesh_t), intent(in) :: mesh
      type(mesh_map_t), intent(out) :: map
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: n_overlaps

      if (cm_map_sizes(mesher%handle, n_overlaps) /= 0) then
         call raise_library_error(error, "copy_map")
         return
      end if
      allocate (map%cell_old(mesh%n_cells), map%overlap_first(mesh%n_cells + 1))
      allocate (map%overlap_cell(n_overlaps), map%overlap_area(n_overlaps))
      allocate (map%fracture_cell_old(mesh%fracture%n_cells))
      if (cm_map_copy(mesher%handle, map%cell_old, map%overlap_first, map%overlap_cell, &
                      map%overlap_area, map%fracture_cell_old) /= 0) then
         call raise_library_error(error, "copy_map")
         return
      end if
      map%cell_old = map%cell_old + 1
      map%overlap_first = map%overlap_first + 1
      map%overlap_cell = map%overlap_cell + 1
      map%fracture_cell_old = map%fracture_cell_old + 1
   end subroutine copy_map

   !> Pass on what the library says.
   subroutine raise_library_error(error, origin)
      type(error_t), allocatable, intent(out) :: error
      character(len=*), intent(in) :: origin
      type(c_ptr) :: text
      character(kind=c_char), pointer :: characters(:)
      character(len=:), allocatable :: message
      integer :: i, n

      text = cm_last_error()
      n = int(c_string_length(text))
      call c_f_pointer(text, characters, [n])
      allocate (character(len=n) :: message)
      do i = 1, n
         message(i:i) = characters(i)
      end do
      call raise_error(error, origin, message)
   end subroutine raise_library_error

end module mesh_builder
