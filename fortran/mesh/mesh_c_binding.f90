!> Interfaces of the C++ mesh library (cpp_mesh/c_api.h): indices count from 0. Only this component
!! uses them.
module mesh_c_binding
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int32_t, c_int64_t, c_null_ptr, &
                                                                      c_ptr, c_signed_char, c_size_t
   implicit none(type, external)
   private

   public :: cm_arrays_t, cm_counts_t, cm_fault_t, cm_joint_t, cm_network_t, cm_spec_t, cm_check
   public :: cm_last_fault, cm_copy, cm_create, cm_create_sized, cm_destroy, cm_grow
   public :: cm_last_error, cm_locate, cm_load, cm_move_tips, cm_store, cm_map_copy, cm_map_sizes
   public :: cm_quality, cm_remesh, cm_sizes, c_string_length

   !> Fracture polylines.
   type, bind(C) :: cm_network_t
      integer(c_int32_t) :: n_fractures
      type(c_ptr) :: first = c_null_ptr
      type(c_ptr) :: xy = c_null_ptr
      type(c_ptr) :: s_start = c_null_ptr
   end type cm_network_t

   !> What to mesh.
   type, bind(C) :: cm_spec_t
      real(c_double) :: x_min, x_max, y_min, y_max
      real(c_double) :: size_fracture, size_boundary
      integer(c_int32_t) :: is_window
      integer(c_int32_t) :: rosette_sectors
      real(c_double) :: rosette_radius
      integer(c_int32_t) :: n_corners = 0
      type(c_ptr) :: corners = c_null_ptr
      type(c_ptr) :: edge_side = c_null_ptr
      integer(c_int32_t) :: n_fixed = 0
      type(c_ptr) :: fixed = c_null_ptr
      type(c_ptr) :: end_radius = c_null_ptr
      integer(c_int32_t) :: n_guides = 0
      type(c_ptr) :: guide_count = c_null_ptr
      type(c_ptr) :: guide_xy = c_null_ptr
      real(c_double) :: joint_size = 0.0_c_double
      integer(c_int32_t) :: n_foci = 0
      type(c_ptr) :: foci = c_null_ptr
      real(c_double) :: focus_slope = 0.0_c_double
      real(c_double) :: focus_size = 0.0_c_double
      integer(c_int32_t) :: is_rough = 0
      real(c_double) :: ring_slope = 0.0_c_double
      type(c_ptr) :: own_size = c_null_ptr
      integer(c_int32_t) :: n_refined = 0
      type(c_ptr) :: refined = c_null_ptr
   end type cm_spec_t

   !> Sizes of the arrays below.
   type, bind(C) :: cm_counts_t
      integer(c_int32_t) :: n_nodes, n_cells, n_faces
      integer(c_int32_t) :: n_fracture_cells, n_fracture_points, n_point_cells, n_tips
   end type cm_counts_t

   !> Arrays of the caller that cm_copy fills.
   type, bind(C) :: cm_arrays_t
      type(c_ptr) :: xy = c_null_ptr
      type(c_ptr) :: cell_nodes = c_null_ptr
      type(c_ptr) :: cell_faces = c_null_ptr
      type(c_ptr) :: face_nodes = c_null_ptr
      type(c_ptr) :: face_cells = c_null_ptr
      type(c_ptr) :: face_side = c_null_ptr
      type(c_ptr) :: face_fracture_cell = c_null_ptr
      type(c_ptr) :: fcell_fracture = c_null_ptr
      type(c_ptr) :: fcell_points = c_null_ptr
      type(c_ptr) :: fcell_faces = c_null_ptr
      type(c_ptr) :: fcell_s = c_null_ptr
      type(c_ptr) :: point_xy = c_null_ptr
      type(c_ptr) :: point_kind = c_null_ptr
      type(c_ptr) :: point_first = c_null_ptr
      type(c_ptr) :: point_cells = c_null_ptr
      type(c_ptr) :: tip_point = c_null_ptr
      type(c_ptr) :: tip_node = c_null_ptr
      type(c_ptr) :: tip_fracture = c_null_ptr
      type(c_ptr) :: tip_end = c_null_ptr
      type(c_ptr) :: tip_direction = c_null_ptr
      type(c_ptr) :: tip_radius = c_null_ptr
   end type cm_arrays_t

   !> Who is to blame for what the last call has refused.
   type, bind(C) :: cm_fault_t
      integer(c_int32_t) :: kind
      integer(c_int32_t) :: n_culprits
      integer(c_int32_t) :: culprit_kind(2)
      integer(c_int32_t) :: culprit(2)
      integer(c_int32_t) :: has_place
      real(c_double) :: x, y
      type(c_ptr) :: reason = c_null_ptr
   end type cm_fault_t

   !> Where fractures meet.
   type, bind(C) :: cm_joint_t
      integer(c_int32_t) :: fracture(2)
      real(c_double) :: x, y
   end type cm_joint_t

   interface
      subroutine cm_last_fault(fault) bind(C, name="cm_last_fault")
         import :: cm_fault_t
         implicit none(type, external)
         type(cm_fault_t), intent(out) :: fault
      end subroutine cm_last_fault

      function cm_check(spec, network, capacity, joints, n_joints, n_cells) result(status) &
         bind(C, name="cm_check")
         import :: c_double, c_int, c_int32_t, cm_joint_t, cm_network_t, cm_spec_t
         implicit none(type, external)
         type(cm_spec_t), intent(in) :: spec
         type(cm_network_t), intent(in) :: network
         integer(c_int32_t), value :: capacity
         type(cm_joint_t), intent(out) :: joints(capacity)
         integer(c_int32_t), intent(out) :: n_joints
         real(c_double), intent(out), optional :: n_cells(2)
         integer(c_int) :: status
      end function cm_check

      !> Why the last call of this thread failed, ended by a null character.
      function cm_last_error() result(text) bind(C, name="cm_last_error")
         import :: c_ptr
         implicit none(type, external)
         type(c_ptr) :: text
      end function cm_last_error

      function cm_create(spec, network, mesh) result(status) bind(C, name="cm_create")
         import :: c_int, c_ptr, cm_network_t, cm_spec_t
         implicit none(type, external)
         type(cm_spec_t), intent(in) :: spec
         type(cm_network_t), intent(in) :: network
         type(c_ptr), intent(out) :: mesh
         integer(c_int) :: status
      end function cm_create

      function cm_create_sized(spec, network, old_mesh, n_sizes, cell_size, mesh) &
         result(status) bind(C, name="cm_create_sized")
         import :: c_double, c_int, c_int32_t, c_ptr, cm_network_t, cm_spec_t
         implicit none(type, external)
         type(cm_spec_t), intent(in) :: spec
         type(cm_network_t), intent(in) :: network
         type(c_ptr), value :: old_mesh
         integer(c_int32_t), value :: n_sizes
         real(c_double), intent(in) :: cell_size(n_sizes)
         type(c_ptr), intent(out) :: mesh
         integer(c_int) :: status
      end function cm_create_sized

      function cm_quality(mesh, smallest_angle, worst_cell) result(status) &
         bind(C, name="cm_quality")
         import :: c_double, c_int, c_int32_t, c_ptr
         implicit none(type, external)
         type(c_ptr), value :: mesh
         real(c_double), intent(out) :: smallest_angle
         integer(c_int32_t), intent(out) :: worst_cell
         integer(c_int) :: status
      end function cm_quality

      function cm_remesh(old_mesh, network, n_centres, centres, radius, size, new_mesh) &
         result(status) bind(C, name="cm_remesh")
         import :: c_double, c_int, c_int32_t, c_ptr, cm_network_t
         implicit none(type, external)
         type(c_ptr), value :: old_mesh
         type(cm_network_t), intent(in) :: network
         integer(c_int32_t), value :: n_centres
         real(c_double), intent(in) :: centres(2, n_centres)
         real(c_double), value :: radius, size
         type(c_ptr), intent(out) :: new_mesh
         integer(c_int) :: status
      end function cm_remesh

      !> end_radius is (2, n_fractures) or null.
      function cm_grow(old_mesh, network, end_radius, new_mesh) result(status) &
         bind(C, name="cm_grow")
         import :: c_int, c_ptr, cm_network_t
         implicit none(type, external)
         type(c_ptr), value :: old_mesh
         type(cm_network_t), intent(in) :: network
         type(c_ptr), value :: end_radius
         type(c_ptr), intent(out) :: new_mesh
         integer(c_int) :: status
      end function cm_grow

      function cm_move_tips(old_mesh, network, reach, new_mesh) result(status) &
         bind(C, name="cm_move_tips")
         import :: c_double, c_int, c_ptr, cm_network_t
         implicit none(type, external)
         type(c_ptr), value :: old_mesh
         type(cm_network_t), intent(in) :: network
         real(c_double), value :: reach
         type(c_ptr), intent(out) :: new_mesh
         integer(c_int) :: status
      end function cm_move_tips

      function cm_sizes(mesh, counts) result(status) bind(C, name="cm_sizes")
         import :: c_int, c_ptr, cm_counts_t
         implicit none(type, external)
         type(c_ptr), value :: mesh
         type(cm_counts_t), intent(out) :: counts
         integer(c_int) :: status
      end function cm_sizes

      function cm_copy(mesh, arrays) result(status) bind(C, name="cm_copy")
         import :: c_int, c_ptr, cm_arrays_t
         implicit none(type, external)
         type(c_ptr), value :: mesh
         type(cm_arrays_t), intent(in) :: arrays
         integer(c_int) :: status
      end function cm_copy

      function cm_map_sizes(new_mesh, n_overlaps) result(status) bind(C, name="cm_map_sizes")
         import :: c_int, c_int32_t, c_ptr
         implicit none(type, external)
         type(c_ptr), value :: new_mesh
         integer(c_int32_t), intent(out) :: n_overlaps
         integer(c_int) :: status
      end function cm_map_sizes

      ! The caller has the sizes from cm_sizes and cm_map_sizes.
      ! allow(assumed-size)
      function cm_map_copy(new_mesh, cell_old, overlap_first, overlap_cell, overlap_area, &
                           fcell_old) result(status) bind(C, name="cm_map_copy")
         import :: c_double, c_int, c_int32_t, c_ptr
         implicit none(type, external)
         type(c_ptr), value :: new_mesh
         integer(c_int32_t), intent(out) :: cell_old(*), overlap_first(*), overlap_cell(*)
         real(c_double), intent(out) :: overlap_area(*)
         integer(c_int32_t), intent(out) :: fcell_old(*)
         integer(c_int) :: status
      end function cm_map_copy

      function cm_locate(mesh, n_points, xy, cells) result(status) bind(C, name="cm_locate")
         import :: c_double, c_int, c_int32_t, c_ptr
         implicit none(type, external)
         type(c_ptr), value :: mesh
         integer(c_int32_t), value :: n_points
         real(c_double), intent(in) :: xy(2, n_points)
         integer(c_int32_t), intent(out) :: cells(n_points)
         integer(c_int) :: status
      end function cm_locate

      function cm_store(mesh, capacity, bytes, n_bytes) result(status) bind(C, name="cm_store")
         import :: c_int, c_int64_t, c_ptr, c_signed_char
         implicit none(type, external)
         type(c_ptr), value :: mesh
         integer(c_int64_t), value :: capacity
         ! allow(C071)
         integer(c_signed_char), intent(inout) :: bytes(*)
         integer(c_int64_t), intent(out) :: n_bytes
         integer(c_int) :: status
      end function cm_store

      function cm_load(n_bytes, bytes, mesh) result(status) bind(C, name="cm_load")
         import :: c_int, c_int64_t, c_ptr, c_signed_char
         implicit none(type, external)
         integer(c_int64_t), value :: n_bytes
         ! allow(C071)
         integer(c_signed_char), intent(in) :: bytes(*)
         type(c_ptr), intent(inout) :: mesh
         integer(c_int) :: status
      end function cm_load

      subroutine cm_destroy(mesh) bind(C, name="cm_destroy")
         import :: c_ptr
         implicit none(type, external)
         type(c_ptr), intent(inout) :: mesh
      end subroutine cm_destroy

      !> strlen of the C library.
      function c_string_length(text) result(n) bind(C, name="strlen")
         import :: c_ptr, c_size_t
         implicit none(type, external)
         type(c_ptr), value :: text
         integer(c_size_t) :: n
      end function c_string_length
   end interface

end module mesh_c_binding
