!> Networks and meshes in an archive (base_archive). A mesh is stored as the library has it, with
!! its numbering, and is not made again.
module mesh_archive
   use, intrinsic :: iso_c_binding, only: c_associated
   use, intrinsic :: iso_fortran_env, only: int8
   use base_archive, only: archive_t
   use base_errors, only: error_t
   use base_kinds, only: ik, lk, rk
   use base_lists, only: lists_t
   use mesh_builder, only: mesher_t
   use mesh_c_arrays, only: copy_mesh
   use mesh_c_binding, only: cm_destroy, cm_load, cm_store
   use mesh_types, only: fracture_mesh_t, mesh_t, network_t, point_interior
   implicit none(type, external)
   private

   public :: visit_fracture_mesh, visit_mesh, visit_mesher, visit_mesher_and_mesh, visit_network

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
      if (archive%is_loading .and. (allocated(network%first) .or. allocated(network%xy))) then
         if (.not. is_network(network)) call archive%set_fault(name)
      end if
      call archive%leave()
   end subroutine visit_network

   !> Whether the arrays fit each other, and every fracture has two points.
   pure logical function is_network(network)
      type(network_t), intent(in) :: network

      is_network = allocated(network%first) .and. allocated(network%xy) .and. &
                   allocated(network%s_start)
      if (.not. is_network) return
      associate (first => network%first, n => size(network%first) - 1)
         is_network = size(network%s_start) == n .and. size(network%xy, 1) == 2
         if (allocated(network%names)) is_network = is_network .and. size(network%names) == n
         if (.not. is_network .or. n < 0) return
         is_network = first(1) == 1 .and. first(n + 1) == size(network%xy, 2) + 1 .and. &
                      all(first(2:) >= first(:n) + 2)
      end associate
   end function is_network

   subroutine visit_fracture_mesh(archive, name, mesh)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(fracture_mesh_t), intent(inout) :: mesh

      call archive%enter(name)
      call archive%item("n_cells", mesh%n_cells)
      call archive%item("n_points", mesh%n_points)
      call archive%item("n_tips", mesh%n_tips)
      call archive%set_extent("own_cells", mesh%n_cells)
      call archive%set_extent("own_points", mesh%n_points)
      call archive%set_extent("own_tips", mesh%n_tips)
      call archive%list("cell_fracture", mesh%cell_fracture, "own_cells ?; 1:fractures")
      call archive%list("cell_points", mesh%cell_points, "2, own_cells ?; 1:own_points")
      call archive%list("cell_faces", mesh%cell_faces, "2, own_cells ?")
      call archive%list("cell_s", mesh%cell_s, "2, own_cells ?")
      call archive%list("point_xy", mesh%point_xy, "2, own_points ?")
      call archive%list("point_kind", mesh%point_kind, "own_points ?")
      call visit_lists(archive, "point_cells", mesh%point_cells)
      call archive%list("tip_point", mesh%tip_point, "own_tips ?; 1:own_points")
      call archive%list("tip_node", mesh%tip_node, "own_tips ?")
      call archive%list("tip_fracture", mesh%tip_fracture, "own_tips ?; 1:fractures")
      call archive%list("tip_end", mesh%tip_end, "own_tips ?")
      call archive%list("tip_direction", mesh%tip_direction, "2, own_tips ?")
      call archive%list("tip_radius", mesh%tip_radius, "own_tips ?")
      if (archive%is_loading .and. any([mesh%n_cells, mesh%n_points, mesh%n_tips] /= 0)) then
         if (.not. is_complete(mesh)) call archive%set_fault(name)
      end if
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
         else if (mesh%fracture%n_points > 0) then
            call archive%set_fault(name)
         end if
      end if
      call archive%leave()
   end subroutine visit_mesher_and_mesh

   !> Whether there are all arrays of the fractures, with indices of the mesh.
   pure logical function is_sound(mesh, f)
      type(mesh_t), intent(in) :: mesh
      type(fracture_mesh_t), intent(in) :: f
      integer(ik) :: i, k

      is_sound = is_complete(f)
      if (is_sound) is_sound = within([f%cell_faces], mesh%n_faces) .and. &
                               within(f%tip_node, mesh%n_nodes)
      do k = 1, 2
         if (is_sound) is_sound = all(mesh%face_fracture_cell(f%cell_faces(k, :)) &
                                      == [(i, i=1, f%n_cells)])
      end do
   end function is_sound

   !> Whether there are all arrays, and lists of cells at points that fit them.
   pure logical function is_complete(f)
      type(fracture_mesh_t), intent(in) :: f
      real(rk), parameter :: rounding = 1.0e-9_rk

      is_complete = all([f%n_cells, f%n_points, f%n_tips] >= 0) .and. &
                    allocated(f%cell_fracture) .and. allocated(f%cell_points) .and. &
                    allocated(f%cell_faces) .and. allocated(f%cell_s) .and. &
                    allocated(f%point_xy) .and. allocated(f%point_kind) .and. &
                    allocated(f%tip_point) .and. allocated(f%tip_node) .and. &
                    allocated(f%tip_fracture) .and. allocated(f%tip_end) .and. &
                    allocated(f%tip_direction) .and. allocated(f%tip_radius) .and. &
                    allocated(f%point_cells%first) .and. allocated(f%point_cells%item)
      if (.not. is_complete) return
      associate (first => f%point_cells%first, item => f%point_cells%item)
         is_complete = size(first) == f%n_points + 1 .and. within(f%tip_end, 2) .and. &
                       all(abs(f%cell_s) <= huge(f%cell_s)) .and. &
                       all(abs(norm2(f%tip_direction, 1) - 1.0_rk) <= rounding)
         if (is_complete) is_complete = all(f%point_kind /= point_interior .or. &
                                            first(2:) - first(:f%n_points) == 2)
         if (is_complete) is_complete = within(item, f%n_cells) .and. first(1) == 1 .and. &
                                        first(size(first)) == size(item) + 1 .and. &
                                        all(first(2:) >= first(:size(first) - 1))
      end associate
   end function is_complete

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
