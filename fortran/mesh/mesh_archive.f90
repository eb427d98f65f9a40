!> Networks and meshes in an archive (base_archive). A mesh is stored as the library has it, with
!! its numbering, and is not made again.
module mesh_archive
   use, intrinsic :: iso_c_binding, only: c_associated
   use, intrinsic :: iso_fortran_env, only: int8
   use base_archive, only: archive_t
   use base_errors, only: error_t
   use base_kinds, only: lk
   use base_lists, only: lists_t
   use mesh_builder, only: mesher_t
   use mesh_c_arrays, only: copy_mesh
   use mesh_c_binding, only: cm_destroy, cm_load, cm_store
   use mesh_types, only: fracture_mesh_t, mesh_t, network_t
   implicit none(type, external)
   private

   public :: visit_fracture_mesh, visit_lists, visit_mesh, visit_mesher, visit_mesher_and_mesh
   public :: visit_network

contains

   subroutine visit_lists(archive, name, lists)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(lists_t), intent(inout) :: lists

      call archive%enter(name)
      call archive%list("first", lists%first)
      call archive%list("item", lists%item)
      call archive%leave()
   end subroutine visit_lists

   subroutine visit_network(archive, name, network)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(network_t), intent(inout) :: network

      call archive%enter(name)
      call archive%list("first", network%first)
      call archive%list("xy", network%xy)
      call archive%list("s_start", network%s_start)
      call archive%texts("names", network%names)
      call archive%leave()
   end subroutine visit_network

   subroutine visit_fracture_mesh(archive, name, mesh)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(fracture_mesh_t), intent(inout) :: mesh

      call archive%enter(name)
      call archive%item("n_cells", mesh%n_cells)
      call archive%item("n_points", mesh%n_points)
      call archive%item("n_tips", mesh%n_tips)
      call archive%list("cell_fracture", mesh%cell_fracture)
      call archive%list("cell_points", mesh%cell_points)
      call archive%list("cell_faces", mesh%cell_faces)
      call archive%list("cell_s", mesh%cell_s)
      call archive%list("point_xy", mesh%point_xy)
      call archive%list("point_kind", mesh%point_kind)
      call visit_lists(archive, "point_cells", mesh%point_cells)
      call archive%list("tip_point", mesh%tip_point)
      call archive%list("tip_node", mesh%tip_node)
      call archive%list("tip_fracture", mesh%tip_fracture)
      call archive%list("tip_end", mesh%tip_end)
      call archive%list("tip_direction", mesh%tip_direction)
      call archive%list("tip_radius", mesh%tip_radius)
      call archive%leave()
   end subroutine visit_fracture_mesh

   !> A mesh without one of the library.
   subroutine visit_mesh(archive, name, mesh)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(mesh_t), intent(inout) :: mesh

      call archive%enter(name)
      call archive%item("n_nodes", mesh%n_nodes)
      call archive%item("n_cells", mesh%n_cells)
      call archive%item("n_faces", mesh%n_faces)
      call archive%list("xy", mesh%xy)
      call archive%list("cell_nodes", mesh%cell_nodes)
      call archive%list("cell_faces", mesh%cell_faces)
      call archive%list("face_nodes", mesh%face_nodes)
      call archive%list("face_cells", mesh%face_cells)
      call archive%list("face_side", mesh%face_side)
      call archive%list("face_fracture_cell", mesh%face_fracture_cell)
      call visit_fracture_mesh(archive, "fracture", mesh%fracture)
      call archive%item("n_layers", mesh%n_layers)
      call archive%list("layer_face", mesh%layer_face)
      call archive%list("face_layer", mesh%face_layer)
      call archive%list("cell_layer", mesh%cell_layer)
      call archive%leave()
   end subroutine visit_mesh

   !> The mesh of the library; none if there is none.
   subroutine visit_mesher(archive, name, mesher)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(mesher_t), intent(inout) :: mesher
      integer(int8), allocatable :: bytes(:)
      integer(int8) :: no_bytes(1)
      integer(lk) :: n

      if (.not. archive%is_loading .and. c_associated(mesher%handle)) then
         if (cm_store(mesher%handle, 0_lk, no_bytes, n) == 0) then
            allocate (bytes(n))
            if (cm_store(mesher%handle, n, bytes, n) /= 0) deallocate (bytes)
         end if
      end if
      call archive%list(name, bytes)
      if (.not. archive%is_loading) return
      if (c_associated(mesher%handle)) call cm_destroy(mesher%handle)
      if (.not. allocated(bytes)) return
      if (cm_load(size(bytes, kind=lk), bytes, mesher%handle) /= 0) call archive%set_fault(name)
   end subroutine visit_mesher

   !> The mesh of the library and its arrays; those of the fractures may have been changed since.
   subroutine visit_mesher_and_mesh(archive, name, mesher, mesh)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(mesher_t), intent(inout) :: mesher
      type(mesh_t), intent(inout) :: mesh
      type(error_t), allocatable :: error

      call archive%enter(name)
      call visit_mesher(archive, "mesher", mesher)
      if (archive%is_loading .and. c_associated(mesher%handle)) then
         call copy_mesh(mesher%handle, mesh, error)
         if (allocated(error)) call archive%set_fault(name)
      end if
      call visit_fracture_mesh(archive, "fracture", mesh%fracture)
      call archive%leave()
   end subroutine visit_mesher_and_mesh

end module mesh_archive
