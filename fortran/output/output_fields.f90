!> The state as it is handed to the files: fields on the three dimensions, and rows of the tables.
!!
!! Arrays that are not allocated are left out of the files; a run without fluid has no pressure.
module output_fields
   use base_kinds, only: ik, rk
   use mesh_types, only: mesh_t
   use scene_types, only: material_t
   implicit none(type, external)
   private

   public :: fracture_fields_t, history_row_t, intersection_fields_t, matrix_fields_t, tip_row_t
   public :: displacement_3d, permeability_tensor, stress_tensor, tensor_components

   !> Symmetric tensors in ParaView's order.
   character(len=2), parameter :: tensor_components(6) = ["XX", "YY", "ZZ", "XY", "YZ", "XZ"]

   !> State of the matrix cells.
   type :: matrix_fields_t
      real(rk), allocatable :: displacement(:, :)  !< (2, n_cells) [m]
      real(rk), allocatable :: stress(:, :)  !< (3, n_cells) total: xx, yy, xy [Pa]
      real(rk), allocatable :: pressure(:)  !< (n_cells) [Pa]
      real(rk), allocatable :: permeability(:, :)  !< (3, n_cells) xx, yy, xy [m2]; or the scene's
      ! Of finite elements: the nodes, and the displacement there besides that of the cells.
      real(rk), allocatable :: node_xy(:, :)  !< (2, n_nodes) [m]
      integer(ik), allocatable :: cell_nodes(:, :)  !< (6, n_cells) corners, then nodes on edges
      real(rk), allocatable :: node_displacement(:, :)  !< (2, n_nodes) [m]
   end type matrix_fields_t

   !> State of the fracture cells. Normal n and tangent tau as in mesh_types.
   type :: fracture_fields_t
      real(rk), allocatable :: aperture(:)  !< (n_cells) [m]
      real(rk), allocatable :: jump_n(:)  !< (n_cells) opening [m]
      real(rk), allocatable :: jump_t(:)  !< (n_cells) slip along tau [m]
      real(rk), allocatable :: traction_n(:)  !< (n_cells) of contact, compression < 0 [Pa]
      real(rk), allocatable :: traction_t(:)  !< (n_cells) [Pa]
      real(rk), allocatable :: pressure(:)  !< (n_cells) [Pa]
      integer(ik), allocatable :: state(:)  !< (n_cells) of contact_states
   end type fracture_fields_t

   !> State of the intersections.
   type :: intersection_fields_t
      integer(ik), allocatable :: point(:)  !< (n) fracture point of each
      real(rk), allocatable :: pressure(:)  !< (n) [Pa]
   end type intersection_fields_t

   !> An accepted time step, a row of history.csv.
   type :: history_row_t
      real(rk) :: time = 0.0_rk  !< [s]
      real(rk) :: dt = 0.0_rk  !< [s]
      integer(ik) :: newton_iterations = 0
      real(rk) :: well_pressure = 0.0_rk  !< mean over the injected cells [Pa]
      real(rk) :: injected = 0.0_rk  !< fluid injected so far [m2]
      real(rk) :: leakoff = 0.0_rk  !< fluid from the fractures into the matrix so far [m2]
      real(rk) :: prefilled = 0.0_rk  !< fluid that new cells brought along so far [m2]
      real(rk) :: fracture_volume = 0.0_rk  !< [m2]
      real(rk) :: mass_error_relative = 0.0_rk  !< [-]
      real(rk) :: max_slip = 0.0_rk  !< [m]
      real(rk) :: max_opening = 0.0_rk  !< [m]
      integer(ik) :: n_stick = 0
      integer(ik) :: n_slip = 0
      integer(ik) :: n_open = 0
      real(rk) :: fracture_length = 0.0_rk  !< [m]
      integer(ik) :: n_tips = 0
      integer(ik) :: n_intersections = 0
      real(rk) :: seismic_moment = 0.0_rk  !< per metre of thickness, cumulative [N m]
      ! Only in mechanics-only runs.
      real(rk) :: load_factor = 0.0_rk  !< [-]
      real(rk) :: strain_energy = 0.0_rk  !< per metre of thickness [J/m]
   end type history_row_t

   !> A free tip after a step or an increment, a row of tips.csv.
   type :: tip_row_t
      real(rk) :: time = 0.0_rk  !< [s]
      integer(ik) :: tip = 0
      integer(ik) :: fracture = 0
      real(rk) :: xy(2) = 0.0_rk  !< [m]
      real(rk) :: k1 = 0.0_rk  !< opening intensity, interaction integral [Pa m^1/2]
      real(rk) :: k2 = 0.0_rk  !< sliding intensity, interaction integral [Pa m^1/2]
      real(rk) :: k1_dc = 0.0_rk  !< by displacement correlation [Pa m^1/2]
      real(rk) :: k2_dc = 0.0_rk  !< by displacement correlation [Pa m^1/2]
      real(rk) :: keq = 0.0_rk  !< equivalent intensity [Pa m^1/2]
      real(rk) :: g = 0.0_rk  !< energy release rate [J/m2]
      real(rk) :: angle = 0.0_rk  !< kink from the old direction, counter-clockwise [rad]
      real(rk) :: advance = 0.0_rk  !< length grown [m]
      real(rk) :: k1_error = 0.0_rk, k2_error = 0.0_rk  !< estimated errors of k1, k2 [Pa m^1/2]
      real(rk) :: g_domain = 0.0_rk  !< energy release rate straight ahead, J-integral [J/m2]
      real(rk) :: g_error = 0.0_rk  !< its estimated error [J/m2]
      real(rk) :: k1_dc_error = 0.0_rk, k2_dc_error = 0.0_rk  !< those of k1_dc, k2_dc [Pa m^1/2]
      real(rk) :: k1_corrected = 0.0_rk, k2_corrected = 0.0_rk  !< with what they lack [Pa m^1/2]
   end type tip_row_t

contains

   !> Displacement with the z component that VTK wants.
   pure function displacement_3d(displacement) result(u)
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_cells or n_nodes) [m]
      real(rk) :: u(3, size(displacement, 2))

      u(1:2, :) = displacement
      u(3, :) = 0.0_rk
   end function displacement_3d

   !> Total stress as a symmetric tensor; zz follows from the plane state.
   !!
   !! Plane strain: effective stress obeys sigma'_zz = nu (sigma'_xx + sigma'_yy) with sigma' =
   !! sigma + alpha p, so that sigma_zz = nu (sigma_xx + sigma_yy) - (1 - 2 nu) alpha p. Plane
   !! stress: sigma_zz = 0.
   pure function stress_tensor(fields, material) result(stress)
      type(matrix_fields_t), intent(in) :: fields
      type(material_t), intent(in) :: material
      real(rk) :: stress(6, size(fields%stress, 2))  !< xx, yy, zz, xy, yz, xz [Pa]

      stress(1:2, :) = fields%stress(1:2, :)
      stress(3, :) = 0.0_rk
      if (.not. material%plane_stress) then
         stress(3, :) = material%poisson*(fields%stress(1, :) + fields%stress(2, :))
         if (allocated(fields%pressure)) then
            stress(3, :) = stress(3, :) &
               & - (1.0_rk - 2.0_rk*material%poisson)*material%biot*fields%pressure
         end if
      end if
      stress(4, :) = fields%stress(3, :)
      stress(5:6, :) = 0.0_rk
   end function stress_tensor

   !> Permeability as a symmetric tensor; out of the plane nothing flows and zz is 0.
   pure function permeability_tensor(fields, material, mesh) result(permeability)
      type(matrix_fields_t), intent(in) :: fields
      type(material_t), intent(in) :: material
      type(mesh_t), intent(in) :: mesh
      real(rk) :: permeability(6, mesh%n_cells)  !< xx, yy, zz, xy, yz, xz [m2]

      permeability = 0.0_rk
      if (allocated(fields%permeability)) then
         permeability(1:2, :) = fields%permeability(1:2, :)
         permeability(4, :) = fields%permeability(3, :)
      else
         permeability(1, :) = material%permeability_xx
         permeability(2, :) = material%permeability_yy
         permeability(4, :) = material%permeability_xy
      end if
   end function permeability_tensor

end module output_fields
