!> A state as fields on the three dimensions: what a level hands to the files.
!!
!! Arrays that are not allocated are left out of the files; a run without fluid has no pressure.
module results_fields
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: fracture_fields_t, intersection_fields_t, matrix_fields_t

   !> State of the matrix cells.
   type :: matrix_fields_t
      real(rk), allocatable :: displacement(:, :)  !< (2, n_cells) [m]
      real(rk), allocatable :: stress(:, :)  !< (3, n_cells) total: xx, yy, xy [Pa]
      real(rk), allocatable :: pressure(:)  !< (n_cells) [Pa]
      real(rk), allocatable :: permeability(:, :)  !< (3, n_cells) xx, yy, xy [m2]; or the scene's
      !> (n_cells) Poisson's ratio and Biot's coefficient, or those of the scene [-]
      real(rk), allocatable :: poisson(:), biot(:)
      real(rk), allocatable :: node_displacement(:, :)  !< (2, n_nodes) [m]
      ! Of finite elements: their own nodes.
      real(rk), allocatable :: node_xy(:, :)  !< (2, n_nodes) [m]
      integer(ik), allocatable :: cell_nodes(:, :)  !< (6, n_cells) corners, then nodes on edges
   end type matrix_fields_t

   !> State of the fracture cells. Normal n and tangent tau as in mesh_types.
   type :: fracture_fields_t
      real(rk), allocatable :: aperture(:)  !< (n_cells) [m]
      real(rk), allocatable :: jump_n(:)  !< (n_cells) opening [m]
      real(rk), allocatable :: jump_t(:)  !< (n_cells) slip along tau [m]
      real(rk), allocatable :: traction_n(:)  !< (n_cells) of contact, compression < 0 [Pa]
      real(rk), allocatable :: traction_t(:)  !< (n_cells) [Pa]
      real(rk), allocatable :: pressure(:)  !< (n_cells) [Pa]
      real(rk), allocatable :: void(:)  !< (n_cells) part of the aperture that vapour fills [m]
      real(rk), allocatable :: flow(:)  !< (n_cells) of fluid along tau [m2/s]
      integer(ik), allocatable :: state(:)  !< (n_cells) of contact_states
   end type fracture_fields_t

   !> State of the intersections.
   type :: intersection_fields_t
      integer(ik), allocatable :: point(:)  !< (n) fracture point of each
      real(rk), allocatable :: pressure(:)  !< (n) [Pa]
   end type intersection_fields_t

end module results_fields
