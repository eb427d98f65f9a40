!> What comes from the C++ mesh library: meshes and maps; indices become Fortran's.
module mesh_c_outputs
   use base_errors, only: error_t
   use base_kinds, only: ik
   use mesh_c_binding, only: cm_arrays_t, cm_copy, cm_counts_t, cm_map_copy, cm_map_sizes, cm_sizes
   use mesh_faults, only: raise_library_error
   use mesh_types, only: mesh_map_t, mesh_t
   use, intrinsic :: iso_c_binding, only: c_loc, c_ptr
   implicit none(type, external)
   private

   public :: copy_map, copy_mesh

contains

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

end module mesh_c_outputs
