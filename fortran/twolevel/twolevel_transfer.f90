!> From the coarse mesh before growth to the one after it.
!!
!! The fluid content of the rock is carried over by overlapping areas, so that no fluid is made or
!! lost; old fracture cells keep their state as it is. A new fracture cell is closed, without slip,
!! at the pressure of the cell that it grew from. Its residual aperture is the roughness of its
!! faces, which conducts fluid but holds none that is worth counting ("conserved"), or it is open
!! and comes along filled ("prefilled").
module twolevel_transfer
   use base_kinds, only: ik, rk
   use coarse_geometry, only: cell_area
   use coarse_layout, only: block_count, end_block
   use coarse_state, only: fracture_cells_t, state_t
   use mesh_types, only: mesh_map_t, mesh_t
   implicit none(type, external)
   private

   public :: transfer_cells, transfer_state

contains

   !> Properties of the fracture cells of the new mesh.
   subroutine transfer_cells(map, mesh, before, new_aperture, is_prefilled, after)
      type(mesh_map_t), intent(in) :: map
      type(mesh_t), intent(in) :: mesh  !< the new one
      type(fracture_cells_t), intent(in) :: before
      real(rk), intent(in) :: new_aperture  !< residual aperture of new cells [m]
      logical, intent(in) :: is_prefilled  !< it holds fluid from the start
      type(fracture_cells_t), intent(out) :: after
      integer(ik) :: i, old

      allocate (after%law(mesh%fracture%n_cells), after%residual_aperture(mesh%fracture%n_cells))
      allocate (after%injection(mesh%fracture%n_cells), after%roughness(mesh%fracture%n_cells), &
                source=0.0_rk)
      do i = 1, mesh%fracture%n_cells
         old = map%fracture_cell_old(i)
         if (old > 0) then
            after%law(i) = before%law(old)
            after%residual_aperture(i) = before%residual_aperture(old)
            after%roughness(i) = before%roughness(old)
            after%injection(i) = before%injection(old)
         else
            after%law(i) = before%law(nearest_old(map, mesh, i))
            after%residual_aperture(i) = new_aperture
            if (.not. is_prefilled) after%roughness(i) = new_aperture
         end if
      end do
   end subroutine transfer_cells

   !> The state on the new mesh. `prefilled` is the volume of fluid that new cells bring along [m2].
   subroutine transfer_state(map, mesh_before, mesh, cells, is_prefilled, before, after, prefilled)
      type(mesh_map_t), intent(in) :: map
      type(mesh_t), intent(in) :: mesh_before, mesh
      type(fracture_cells_t), intent(in) :: cells  !< those of the new mesh
      logical, intent(in) :: is_prefilled
      type(state_t), intent(in) :: before
      type(state_t), intent(out) :: after
      real(rk), intent(out) :: prefilled  !< [m2]
      integer(ik), parameter :: both(2) = [1_ik, 2_ik]  ! ends of a fracture cell
      integer(ik) :: c, i, k, n, old
      real(rk) :: area

      n = mesh%fracture%n_cells
      after%time = before%time
      allocate (after%unknowns(3, block_count(mesh)), after%content(mesh%n_cells), source=0.0_rk)
      do c = 1, mesh%n_cells
         old = map%cell_old(c)
         if (old > 0) then
            after%content(c) = before%content(old)
            after%unknowns(:, c) = before%unknowns(:, old)
            cycle
         end if
         area = cell_area(mesh, c)
         do k = map%overlap_first(c), map%overlap_first(c + 1) - 1
            old = map%overlap_cell(k)
            after%content(c) = after%content(c) + before%content(old)*map%overlap_area(k) &
                               /cell_area(mesh_before, old)
            after%unknowns(:, c) = after%unknowns(:, c) + before%unknowns(:, old) &
                                   *map%overlap_area(k)/area
         end do
      end do

      allocate (after%jump(2, 2, n), after%traction(2, 2, n), after%leakoff(n), source=0.0_rk)
      allocate (after%slip_before(2, n), source=0.0_rk)
      allocate (after%contact(2, n), source=0_ik)
      allocate (after%pressure(n), after%aperture(n))
      allocate (after%void(n), source=0.0_rk)
      prefilled = 0.0_rk
      do i = 1, n
         old = map%fracture_cell_old(i)
         if (old > 0) then
            after%jump(:, :, i) = before%jump(:, :, old)
            after%slip_before(:, i) = before%slip_before(:, old)
            after%traction(:, :, i) = before%traction(:, :, old)
            after%contact(:, i) = before%contact(:, old)
            after%pressure(i) = before%pressure(old)
            after%aperture(i) = before%aperture(old)
            after%void(i) = before%void(old)
            after%leakoff(i) = before%leakoff(old)
            after%unknowns(:, end_block(mesh, i, both)) = &
               before%unknowns(:, end_block(mesh_before, old, both))
         else
            after%pressure(i) = before%pressure(nearest_old(map, mesh, i))
            after%unknowns(3, end_block(mesh, i, both)) = after%pressure(i)
            after%aperture(i) = cells%residual_aperture(i)
            if (is_prefilled) prefilled = prefilled + after%aperture(i) &
                                          *(mesh%fracture%cell_s(2, i) - mesh%fracture%cell_s(1, i))
         end if
      end do
   end subroutine transfer_state

   !> The old cell that is nearest to a new one along its fracture.
   pure function nearest_old(map, mesh, cell) result(old)
      type(mesh_map_t), intent(in) :: map
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell
      integer(ik) :: old

      real(rk) :: distance, shortest
      integer(ik) :: i

      shortest = huge(1.0_rk)
      old = 0
      do i = 1, mesh%fracture%n_cells
         if (map%fracture_cell_old(i) == 0) cycle
         if (mesh%fracture%cell_fracture(i) /= mesh%fracture%cell_fracture(cell)) cycle
         distance = abs(sum(mesh%fracture%cell_s(:, i)) - sum(mesh%fracture%cell_s(:, cell)))
         if (distance < shortest) then
            shortest = distance
            old = map%fracture_cell_old(i)
         end if
      end do
   end function nearest_old

end module twolevel_transfer
