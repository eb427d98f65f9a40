!> Meshes for the other components, made by the C++ library.
!!
!! Whether a body and its fractures can be meshed, checked by the C++ library without meshing.
module mesh_builder
   use, intrinsic :: iso_c_binding, only: c_associated, c_loc, c_null_ptr, c_ptr
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use mesh_c_arrays, only: c_network_arrays_t, copy_map, copy_mesh, corner_share, mesh_spec_t, &
                            prepare_network, prepare_spec
   use mesh_c_binding, only: cm_check, cm_create, cm_create_sized, cm_destroy, cm_grow, &
                             cm_joint_t, cm_locate, cm_move_tips, cm_network_t, cm_quality, &
                             cm_remesh, cm_spec_t
   use mesh_faults, only: fault_t, last_fault, raise_library_error
   use mesh_types, only: mesh_map_t, mesh_t, network_t
   implicit none(type, external)
   private

   public :: build_mesh, build_mesh_sized, check_mesh_input, corner_share, grow_mesh, joint_t
   public :: locate, mesh_quality, mesh_spec_t, mesher_t, move_tips, remesh, transfer_mesher

   !> Owns a mesh of the C++ library. It cannot be copied: assigning one leaves the left side
   !! empty; use transfer_mesher to move one.
   type :: mesher_t
      type(c_ptr) :: handle = c_null_ptr
   contains
      procedure, private :: assign_nothing
      generic :: assignment(=) => assign_nothing
      final :: destroy_mesher
   end type mesher_t

   !> A place inside the body where fractures meet.
   type :: joint_t
      integer(ik) :: fractures(2) = 0  !< twice the same one that meets itself
      real(rk) :: xy(2) = 0.0_rk  !< [m]
   end type joint_t

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
      type(c_network_arrays_t), target :: arrays
      integer :: status

      call destroy_mesher(mesher)
      kept = spec
      call prepare_network(network, arrays, c_network, error)
      if (.not. allocated(error)) call prepare_spec(kept, c_network%n_fractures, c_spec, error)
      if (allocated(error)) return
      ! gmsh seeds and draws the random numbers of the C library, as METIS does (algebra_ordering).
      !$omp critical (c_random_numbers)
      status = cm_create(c_spec, c_network, mesher%handle)
      !$omp end critical (c_random_numbers)
      call finish(status, "build_mesh", network, mesher, mesh, error)
   end subroutine build_mesh

   !> A new mesh of the same body whose cells have about the sizes that are wanted in the cells of
   !! an old one, where they lie, graded smoothly and up to spec%size_boundary. Fractures may have
   !! grown; their cells follow the sizes. The old mesher stays as it is.
   subroutine build_mesh_sized(spec, network, mesher_old, cell_size, mesher_new, mesh, error)
      type(mesh_spec_t), intent(in) :: spec
      type(network_t), intent(in) :: network
      type(mesher_t), intent(in) :: mesher_old
      real(rk), intent(in) :: cell_size(:)  !< (old n_cells) length of edges [m]
      type(mesher_t), intent(inout) :: mesher_new  !< what it held before is released
      type(mesh_t), intent(out) :: mesh
      type(error_t), allocatable, intent(out) :: error
      type(cm_spec_t) :: c_spec
      type(cm_network_t) :: c_network
      type(mesh_spec_t), target :: kept
      type(c_network_arrays_t), target :: arrays
      integer :: status

      kept = spec
      call begin_from(mesher_old, network, mesher_new, arrays, c_network, error)
      if (.not. allocated(error)) call prepare_spec(kept, c_network%n_fractures, c_spec, error)
      if (allocated(error)) return
      status = cm_create_sized(c_spec, c_network, mesher_old%handle, ubound(cell_size, 1), &
                               cell_size, mesher_new%handle)
      call finish(status, "build_mesh_sized", network, mesher_new, mesh, error)
   end subroutine build_mesh_sized

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
      type(c_network_arrays_t), target :: arrays
      integer :: status

      call begin_from(mesher_old, network, mesher_new, arrays, c_network, error)
      if (allocated(error)) return
      status = cm_remesh(mesher_old%handle, c_network, int(ubound(centres, 2), ik), centres, &
                         radius, size, mesher_new%handle)
      call finish(status, "remesh", network, mesher_new, mesh, error)
      if (.not. allocated(error)) call copy_map(mesher_new%handle, mesh, map, error)
   end subroutine remesh

   !> A mesh of a grown network for a body with rosettes, new only in patches around the ends
   !! that have grown; sizes and new rosettes are those of a new mesh. An error says that this does
   !! not go: make a new mesh then. The old mesher stays as it is.
   subroutine grow_mesh(mesher_old, network, end_radius, mesher_new, mesh, error)
      type(mesher_t), intent(in) :: mesher_old
      type(network_t), intent(in) :: network  !< the old one, vertices added at its ends
      real(rk), intent(in), target, contiguous :: end_radius(:, :)  !< as in mesh_spec_t [m]
      type(mesher_t), intent(inout) :: mesher_new  !< what it held before is released
      type(mesh_t), intent(out) :: mesh
      type(error_t), allocatable, intent(out) :: error
      type(cm_network_t) :: c_network
      type(c_network_arrays_t), target :: arrays

      call begin_from(mesher_old, network, mesher_new, arrays, c_network, error)
      if (allocated(error)) return
      if (ubound(end_radius, 1) /= 2 .or. ubound(end_radius, 2) /= c_network%n_fractures) then
         call raise_error(error, "grow_mesh", "every fracture has two rosette radii")
         return
      end if
      call finish(cm_grow(mesher_old%handle, c_network, c_loc(end_radius), mesher_new%handle), &
                  "grow_mesh", network, mesher_new, mesh, error)
   end subroutine grow_mesh

   !> The cells of an old mesh, whose nodes have moved along with the ends of fractures that lie
   !! elsewhere in the network. An error says that this does not go: make a new mesh then. The old
   !! mesher stays as it is.
   subroutine move_tips(mesher_old, network, reach, mesher_new, mesh, error)
      type(mesher_t), intent(in) :: mesher_old
      type(network_t), intent(in) :: network  !< the old one but for its ends
      !> How far from the last piece of a fracture nodes move, over its length in the old mesh [-].
      real(rk), intent(in) :: reach
      type(mesher_t), intent(inout) :: mesher_new  !< what it held before is released
      type(mesh_t), intent(out) :: mesh
      type(error_t), allocatable, intent(out) :: error
      type(cm_network_t) :: c_network
      type(c_network_arrays_t), target :: arrays

      call begin_from(mesher_old, network, mesher_new, arrays, c_network, error)
      if (allocated(error)) return
      call finish(cm_move_tips(mesher_old%handle, c_network, reach, mesher_new%handle), &
                  "move_tips", network, mesher_new, mesh, error)
   end subroutine move_tips

   !> Release a mesh, and prepare another network to mesh in its place from an old mesh.
   subroutine begin_from(mesher_old, network, mesher_new, arrays, c_network, error)
      type(mesher_t), intent(in) :: mesher_old
      type(network_t), intent(in) :: network
      type(mesher_t), intent(inout) :: mesher_new
      type(c_network_arrays_t), intent(out), target :: arrays  !< that c_network points to
      type(cm_network_t), intent(out) :: c_network
      type(error_t), allocatable, intent(out) :: error

      call destroy_mesher(mesher_new)
      if (c_associated(mesher_old%handle)) then
         call prepare_network(network, arrays, c_network, error)
      else
         call raise_error(error, "mesh_builder", "there is no old mesh; build one first")
      end if
   end subroutine begin_from

   !> Copy the mesh that the library has made, or raise its error.
   subroutine finish(status, origin, network, mesher, mesh, error)
      integer, intent(in) :: status  !< of the library's call; 0: done
      character(len=*), intent(in) :: origin  !< procedure for the log
      type(network_t), intent(in) :: network
      type(mesher_t), intent(in) :: mesher
      type(mesh_t), intent(out) :: mesh
      type(error_t), allocatable, intent(out) :: error

      if (status == 0) then
         call copy_mesh(mesher%handle, mesh, error)
      else
         call raise_library_error(error, origin, network)
      end if
   end subroutine finish

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

   !> The smallest angle of a mesh and the cell that has it.
   subroutine mesh_quality(mesher, smallest_angle, worst_cell, error)
      type(mesher_t), intent(in) :: mesher
      real(rk), intent(out) :: smallest_angle  !< [rad]
      integer(ik), intent(out) :: worst_cell
      type(error_t), allocatable, intent(out) :: error

      smallest_angle = 0.0_rk
      worst_cell = 0
      if (.not. c_associated(mesher%handle)) then
         call raise_error(error, "mesh_quality", "there is no mesh; build one first")
      else if (cm_quality(mesher%handle, smallest_angle, worst_cell) /= 0) then
         call raise_library_error(error, "mesh_quality")
      else
         worst_cell = worst_cell + 1
      end if
   end subroutine mesh_quality

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

   !> Judge what build_mesh would mesh, by the same code.
   subroutine check_mesh_input(spec, network, joints, fault, n_cells)
      type(mesh_spec_t), intent(in) :: spec
      type(network_t), intent(in) :: network
      type(joint_t), allocatable, intent(out) :: joints(:)  !< none if there is a fault
      type(fault_t), allocatable, intent(out) :: fault  !< unallocated: it can be meshed
      real(rk), intent(out) :: n_cells(2)  !< expected cells, fracture cells; 0 if there is a fault
      type(error_t), allocatable :: error
      type(cm_spec_t) :: c_spec
      type(cm_network_t) :: c_network
      type(mesh_spec_t), target :: kept
      type(c_network_arrays_t), target :: arrays
      type(cm_joint_t), allocatable :: found(:)
      integer(ik) :: i, n

      n_cells = 0.0_rk
      kept = spec
      allocate (joints(0), found(0))
      call prepare_network(network, arrays, c_network, error)
      if (.not. allocated(error)) call prepare_spec(kept, c_network%n_fractures, c_spec, error)
      if (allocated(error)) then
         fault = fault_t(reason=error%message)
         allocate (fault%culprits(0))
         return
      end if
      if (cm_check(c_spec, c_network, 0_ik, found, n, n_cells) /= 0) then
         fault = last_fault()
         return
      end if
      if (n == 0) return
      deallocate (found, joints)
      allocate (found(n), joints(n))
      if (cm_check(c_spec, c_network, n, found, n) /= 0) then
         fault = last_fault()
         return
      end if
      do i = 1, n
         joints(i) = joint_t(fractures=found(i)%fracture + 1, xy=[found(i)%x, found(i)%y])
      end do
   end subroutine check_mesh_input

end module mesh_builder
