!> Vectors and tensors of a plane state with the components that ParaView wants.
module output_tensors
   use base_kinds, only: rk
   use mesh_types, only: mesh_t
   use results_fields, only: matrix_fields_t
   use scene_types, only: material_t
   implicit none(type, external)
   private

   public :: displacement_3d, permeability_tensor, stress_tensor, tensor_components

   !> Symmetric tensors in ParaView's order.
   character(len=2), parameter :: tensor_components(6) = ["XX", "YY", "ZZ", "XY", "YZ", "XZ"]

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
         if (allocated(fields%poisson)) then
            stress(3, :) = fields%poisson*(fields%stress(1, :) + fields%stress(2, :))
            if (allocated(fields%pressure)) then
               stress(3, :) = stress(3, :) &
                              - (1.0_rk - 2.0_rk*fields%poisson)*fields%biot*fields%pressure
            end if
         else
            stress(3, :) = of_one_rock()
         end if
      end if
      stress(4, :) = fields%stress(3, :)
      stress(5:6, :) = 0.0_rk

   contains

      pure function of_one_rock() result(zz)
         real(rk) :: zz(size(fields%stress, 2))

         zz = material%poisson*(fields%stress(1, :) + fields%stress(2, :))
         if (allocated(fields%pressure)) then
            zz = zz - (1.0_rk - 2.0_rk*material%poisson)*material%biot*fields%pressure
         end if
      end function of_one_rock

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

end module output_tensors
