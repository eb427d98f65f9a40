!> The weight of the cells that no stress in situ carries: of the rock with what fills its pores,
!! less what the rise of the stress with depth holds, and of regions what their density adds.
module coarse_weight
   use base_kinds, only: ik, rk
   use coarse_in_situ, only: in_situ_state_t, weight_of_scene
   use coarse_permeability, only: mean_of_regions
   use mesh_geometry, only: cell_area
   use mesh_types, only: mesh_t
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: find_weight

contains

   !> Force on each cell; none if there is no weight.
   pure subroutine find_weight(mesh, scene, in_situ, weight)
      type(mesh_t), intent(in) :: mesh
      type(scene_t), intent(in) :: scene
      type(in_situ_state_t), allocatable, intent(in) :: in_situ
      real(rk), allocatable, intent(out) :: weight(:, :)  !< (2, n_cells) [N/m]
      real(rk) :: density(mesh%n_cells), force(2)  ! [kg/m3], [N/m3]
      integer(ik) :: c
      logical :: has_layers

      force = weight_of_scene(scene)
      if (allocated(in_situ)) force(2) = force(2) + in_situ%stress_per_y(2)
      has_layers = .false.
      if (allocated(scene%regions)) then
         has_layers = any(abs(scene%regions%material%density - scene%material%density) > 0.0_rk)
      end if
      if (.not. (any(abs(force) > 0.0_rk) .or. has_layers)) return
      allocate (weight(2, mesh%n_cells))
      do c = 1, mesh%n_cells
         weight(:, c) = cell_area(mesh, c)*force
      end do
      if (.not. has_layers) return
      density = mean_of_regions(mesh, scene%regions, scene%domain, &
                                [scene%material%density, scene%regions%material%density])
      do c = 1, mesh%n_cells
         weight(:, c) = weight(:, c) + cell_area(mesh, c)*(density(c) - scene%material%density) &
                        *scene%gravity
      end do
   end subroutine find_weight

end module coarse_weight
