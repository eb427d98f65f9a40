!> Networks and meshes in an archive (base_archive). A mesh is stored as the library has it, with
!! its numbering, and is not made again.
module mesh_archive
   use, intrinsic :: iso_c_binding, only: c_associated
   use, intrinsic :: iso_fortran_env, only: int8
   use base_archive, only: archive_t
   use base_errors, only: error_t
   use base_kinds, only: ik, lk
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
      if (archive%is_loading .and. allocated(network%first) .and. allocated(network%xy)) then
         associate (first => network%first)
            if (size(first) < 1 .or. .not. within(first, size(network%xy, 2, kind=ik) + 1)) then
               call archive%set_fault(name)
            else if (any(first(2:) < first(:size(first) - 1)) .or. &
                     first(size(first)) /= size(network%xy, 2) + 1) then
               call archive%set_fault(name)
            end if
         end associate
      end if
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
      if (archive%is_loading .and. .not. allocated(archive%fault)) then
         if (c_associated(mesher%handle)) then
            if (.not. (is_sound(mesh, mesh%fracture) .and. has_indices(mesh))) then
               call archive%set_fault(name)
            end if
         end if
      end if
      call archive%leave()
   end subroutine visit_mesher_and_mesh

   !> Whether the arrays of the fractures have the lengths of the mesh, and its indices.
   pure logical function is_sound(mesh, f)
      type(mesh_t), intent(in) :: mesh
      type(fracture_mesh_t), intent(in) :: f

      is_sound = allocated(f%cell_fracture) .and. allocated(f%cell_points) .and. &
                 allocated(f%cell_faces) .and. allocated(f%cell_s) .and. allocated(f%point_xy) &
                 .and. allocated(f%point_kind) .and. allocated(f%tip_point) .and. &
                 allocated(f%tip_node) .and. allocated(f%tip_fracture) .and. &
                 allocated(f%tip_end) .and. allocated(f%tip_direction) .and. &
                 allocated(f%tip_radius) .and. allocated(f%point_cells%first) .and. &
                 allocated(f%point_cells%item)
      if (.not. is_sound) return
      is_sound = all([size(f%cell_fracture), size(f%cell_points), size(f%cell_faces), &
                      size(f%cell_s), size(f%point_xy), size(f%point_kind)] == &
                     [f%n_cells, 2*f%n_cells, 2*f%n_cells, 2*f%n_cells, 2*f%n_points, f%n_points]) &
                 .and. all([size(f%tip_point), size(f%tip_node), size(f%tip_fracture), &
                            size(f%tip_end), size(f%tip_direction), size(f%tip_radius)] == &
                           f%n_tips*[1, 1, 1, 1, 2, 1]) &
                 .and. size(f%point_cells%first) == f%n_points + 1
      if (.not. is_sound) return
      associate (first => f%point_cells%first)
         is_sound = within([f%cell_points], f%n_points) .and. &
                    within([f%cell_faces], mesh%n_faces) .and. within(f%tip_point, f%n_points) &
                    .and. within(f%tip_node, mesh%n_nodes) .and. within(f%tip_end, 2) .and. &
                    within([f%cell_fracture, f%tip_fracture], f%n_cells) .and. &
                    within(f%point_cells%item, f%n_cells) .and. &
                    first(1) == 1 .and. first(size(first)) == size(f%point_cells%item) + 1 .and. &
                    all(first(2:) >= first(:size(first) - 1))
      end associate
   end function is_sound

   !> Whether the arrays of cells and faces have indices of the mesh.
   pure logical function has_indices(mesh)
      type(mesh_t), intent(in) :: mesh

      has_indices = within([mesh%cell_nodes], mesh%n_nodes) .and. &
                    within([mesh%cell_faces], mesh%n_faces) .and. &
                    within([mesh%face_nodes], mesh%n_nodes) .and. &
                    within(mesh%face_cells(1, :), mesh%n_cells) .and. &
                    within(mesh%face_cells(2, :) + 1, mesh%n_cells + 1) .and. &
                    within(mesh%face_fracture_cell + 1, mesh%fracture%n_cells + 1) .and. &
                    all(mesh%face_side >= 0)
      if (has_indices .and. allocated(mesh%face_layer)) then
         has_indices = within(mesh%face_layer + 1, mesh%n_layers + 1)
      end if
   end function has_indices

   pure logical function within(indices, n)
      integer(ik), intent(in) :: indices(:), n

      within = all(indices >= 1 .and. indices <= n)
   end function within

end module mesh_archive
