!> Transfer from the coarse mesh before an increment of growth to the mesh after it.
!!
!! The fluid content of the rock is transferred by overlapping areas, which conserves the fluid. Old
!! fracture cells keep their state. Where a joint has divided cells or moved a node between two
!! cells, the jumps are those of the old cells at the same place, linear along each cell, and the
!! fluid is that of the parts. A new fracture cell is closed, without slip, at the pressure of the
!! nearest old cell. Its residual aperture is the roughness of its faces, which conducts fluid but
!! has a negligible volume ("conserved"), or it is open and filled with fluid from the start
!! ("prefilled").
!!
!! Growth passed to the coarse level: one straight segment per tip, once the segment is long enough
!! for a cell of the coarse mesh.
module twolevel_transfer
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_value
   use coarse_layout, only: block_count, end_block
   use coarse_state, only: fracture_cells_t, state_t
   use growth_network, only: end_direction, end_gain, end_vertices, extend, straighten_end
   use growth_tip, only: tip_t
   use mesh_geometry, only: cell_area
   use mesh_types, only: fracture_mesh_t, mesh_map_t, mesh_t, network_t
   use twolevel_overlaps, only: fracture_overlaps, overlaps_t
   implicit none(type, external)
   private

   public :: hand_over, transfer_cells, transfer_state

contains

   !> Extend the coarse network by the growth of the fine level, once the growth of a tip reaches
   !! the threshold, or a tip has joined a target. Tips with at least half of the threshold are
   !! included. The fine network gets the same straight segments.
   pure subroutine hand_over(threshold, network, tips, coarse, centres, is_straightened)
      real(rk), intent(in) :: threshold  !< eps_p dH [m]
      type(network_t), intent(inout) :: network  !< fine network
      type(tip_t), intent(inout) :: tips(:)
      type(network_t), intent(inout) :: coarse
      !> (2, n) points where the coarse network has changed [m]; n may be 0
      real(rk), allocatable, intent(out) :: centres(:, :)
      logical, intent(out) :: is_straightened  !< the fine network has changed as well
      real(rk) :: pending(size(tips))
      logical :: has_joined(size(tips))
      integer(ik) :: i, n

      is_straightened = .false.
      do i = 1, size(tips, kind=ik)
         pending(i) = end_gain(network, coarse, tips(i)%fracture, tips(i)%end)
      end do
      allocate (centres(2, 0))
      has_joined = tips%joined .and. pending > same_value*threshold
      if (.not. any(pending >= threshold*(1.0_rk - same_value) .or. has_joined)) return
      do i = 1, size(tips, kind=ik)
         associate (tip => tips(i))
            if (pending(i) < 0.5_rk*threshold .and. .not. has_joined(i)) cycle
            n = end_vertices(network, coarse, tip%fracture, tip%end)
            call extend(coarse, tip%fracture, tip%end, tip%xy)
            centres = reshape([centres, tip%xy], [2, size(centres, 2) + 1])
            if (n == 1) cycle
            call straighten_end(network, tip%fracture, tip%end, n - 1)
            tip%direction = end_direction(coarse, tip%fracture, tip%end)
            is_straightened = .true.
         end associate
      end do
   end subroutine hand_over

   !> Properties of the fracture cells of the new mesh.
   pure subroutine transfer_cells(mesh_before, mesh, before, new_aperture, is_prefilled, after)
      type(mesh_t), intent(in) :: mesh_before, mesh
      type(fracture_cells_t), intent(in) :: before
      real(rk), intent(in) :: new_aperture  !< residual aperture of new cells [m]
      logical, intent(in) :: is_prefilled  !< new cells contain fluid from the start
      type(fracture_cells_t), intent(out) :: after
      type(overlaps_t) :: overlaps
      integer(ik) :: i, old

      overlaps = fracture_overlaps(mesh_before%fracture, mesh%fracture)
      allocate (after%law(mesh%fracture%n_cells), after%residual_aperture(mesh%fracture%n_cells))
      allocate (after%injection(mesh%fracture%n_cells), after%roughness(mesh%fracture%n_cells), &
                source=0.0_rk)
      if (allocated(before%skin)) allocate (after%skin(mesh%fracture%n_cells), source=0.0_rk)
      do i = 1, mesh%fracture%n_cells
         if (overlaps%is_new(i)) then
            associate (from => before%law(nearest_old(mesh_before%fracture, mesh%fracture, i)))
               after%law(i) = from%as_grown()
            end associate
            after%residual_aperture(i) = new_aperture
            if (.not. is_prefilled) after%roughness(i) = new_aperture
            cycle
         end if
         old = overlaps%main(i)
         after%law(i) = before%law(old)
         if (allocated(before%skin)) after%skin(i) = before%skin(old)
         after%residual_aperture(i) = before%residual_aperture(old)
         after%roughness(i) = before%roughness(old)
         if (overlaps%is_whole(i, mesh_before%fracture, mesh%fracture)) cycle
         if (allocated(before%skin)) after%skin(i) = overlaps%mean(i, before%skin)
         after%residual_aperture(i) = overlaps%mean(i, before%residual_aperture)
         after%roughness(i) = overlaps%mean(i, before%roughness)
      end do
   end subroutine transfer_cells

   !> Transfer the state to the new mesh. `prefilled` is the fluid volume contained in new cells
   !! [m2].
   subroutine transfer_state(map, mesh_before, mesh, cells, is_prefilled, before, after, prefilled)
      type(mesh_map_t), intent(in) :: map
      type(mesh_t), intent(in) :: mesh_before, mesh
      type(fracture_cells_t), intent(in) :: cells  !< cells of the new mesh
      logical, intent(in) :: is_prefilled
      type(state_t), intent(in) :: before
      type(state_t), intent(out) :: after
      real(rk), intent(out) :: prefilled  !< [m2]
      integer(ik), parameter :: both(2) = [1_ik, 2_ik]  ! ends of a fracture cell
      type(overlaps_t) :: overlaps
      integer(ik) :: i, n, old

      overlaps = fracture_overlaps(mesh_before%fracture, mesh%fracture)
      n = mesh%fracture%n_cells
      after%time = before%time
      if (allocated(before%well_flow)) then
         after%well_flow = before%well_flow
         after%well_head = before%well_head
         after%well_rate = before%well_rate
      end if
      call transfer_rock(map, mesh_before, mesh, before, after)
      if (allocated(before%rock_well_control)) after%rock_well_control = before%rock_well_control
      if (allocated(before%rings)) after%rings = before%rings
      allocate (after%jump(2, 2, n), after%traction(2, 2, n), after%leakoff(n), source=0.0_rk)
      allocate (after%slip_before(2, n), source=0.0_rk)
      if (allocated(before%slip_path)) then
         allocate (after%slip_path(2, n), after%opened(2, n), after%opened_before(2, n), &
                   source=0.0_rk)
      end if
      allocate (after%contact(2, n), source=0_ik)
      allocate (after%pressure(n), after%aperture(n))
      allocate (after%void(n), after%injection(n), source=0.0_rk)
      prefilled = 0.0_rk
      do i = 1, n
         if (overlaps%is_new(i)) then
            after%pressure(i) = before%pressure(nearest_old(mesh_before%fracture, &
                                                            mesh%fracture, i))
            after%unknowns(3, end_block(mesh, i, both)) = after%pressure(i)
            after%aperture(i) = cells%residual_aperture(i)
            if (is_prefilled) prefilled = prefilled + after%aperture(i) &
                                          *(mesh%fracture%cell_s(2, i) - mesh%fracture%cell_s(1, i))
            cycle
         end if
         old = overlaps%main(i)
         call keep_cell(old, before, i, after)
         after%unknowns(:, end_block(mesh, i, both)) = &
            before%unknowns(:, end_block(mesh_before, old, both))
         if (.not. overlaps%is_whole(i, mesh_before%fracture, mesh%fracture)) then
            call transfer_parts(overlaps, i, mesh_before%fracture, mesh%fracture, before, after)
         end if
      end do
   end subroutine transfer_state

   !> Transfer the cells of the rock by overlapping areas: fluid content as a sum, unknowns as
   !! means.
   subroutine transfer_rock(map, mesh_before, mesh, before, after)
      type(mesh_map_t), intent(in) :: map
      type(mesh_t), intent(in) :: mesh_before, mesh
      type(state_t), intent(in) :: before
      type(state_t), intent(inout) :: after
      real(rk) :: area
      integer(ik) :: c, k, old

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
   end subroutine transfer_rock

   !> Copy the state of a fracture cell.
   pure subroutine keep_cell(old, before, i, after)
      integer(ik), intent(in) :: old, i  !< number before and after
      type(state_t), intent(in) :: before
      type(state_t), intent(inout) :: after

      after%jump(:, :, i) = before%jump(:, :, old)
      after%slip_before(:, i) = before%slip_before(:, old)
      if (allocated(before%slip_path)) then
         after%slip_path(:, i) = before%slip_path(:, old)
         after%opened(:, i) = before%opened(:, old)
         after%opened_before(:, i) = before%opened_before(:, old)
      end if
      after%traction(:, :, i) = before%traction(:, :, old)
      after%contact(:, i) = before%contact(:, old)
      after%pressure(i) = before%pressure(old)
      after%aperture(i) = before%aperture(old)
      after%void(i) = before%void(old)
      after%leakoff(i) = before%leakoff(old)
      after%injection(i) = before%injection(old)
   end subroutine keep_cell

   !> Transfer the state to a cell that consists of parts of old cells, with their fluid volume and,
   !! since the pressure is the mean by volume, their mass.
   pure subroutine transfer_parts(overlaps, cell, fracture_before, fracture, before, after)
      type(overlaps_t), intent(in) :: overlaps
      integer(ik), intent(in) :: cell
      type(fracture_mesh_t), intent(in) :: fracture_before, fracture
      type(state_t), intent(in) :: before
      type(state_t), intent(inout) :: after
      real(rk) :: aperture, held, mass, part(2), s, volume, weight(2)
      integer(ik) :: end, k, old

      volume = 0.0_rk
      held = 0.0_rk
      mass = 0.0_rk
      do k = overlaps%first(cell), overlaps%first(cell + 1) - 1
         old = overlaps%old(k)
         associate (ends => fracture_before%cell_s(:, old), here => fracture%cell_s(:, cell))
            part = [max(ends(1), here(1)), min(ends(2), here(2))]
            weight = shares(0.5_rk*sum(part), ends)
         end associate
         aperture = before%aperture(old) + dot_product(weight - 0.5_rk, before%jump(1, :, old))
         volume = volume + overlaps%length(k)*aperture
         held = held + overlaps%length(k)*(aperture - before%void(old))
         mass = mass + overlaps%length(k)*(aperture - before%void(old))*before%pressure(old)
      end do
      associate (s => fracture%cell_s(:, cell))
         after%aperture(cell) = volume/(s(2) - s(1))
      end associate
      if (abs(held) > 0.0_rk) after%pressure(cell) = mass/held
      after%void(cell) = overlaps%mean(cell, before%void)
      after%leakoff(cell) = overlaps%mean(cell, before%leakoff)
      do end = 1, 2
         s = dot_product(fracture%cell_s(:, cell), merge([2.0_rk, 1.0_rk], [1.0_rk, 2.0_rk], &
                                                         end == 1))/3.0_rk
         do k = overlaps%first(cell), overlaps%first(cell + 1) - 1
            old = overlaps%old(k)
            associate (ends => fracture_before%cell_s(:, old))
               if (s > ends(2) .and. k < overlaps%first(cell + 1) - 1) cycle
               weight = shares(s, ends)
            end associate
            after%jump(:, end, cell) = matmul(before%jump(:, :, old), weight)
            after%slip_before(end, cell) = dot_product(before%slip_before(:, old), weight)
            if (allocated(before%slip_path)) then
               after%slip_path(end, cell) = dot_product(before%slip_path(:, old), weight)
               after%opened(end, cell) = dot_product(before%opened(:, old), weight)
               after%opened_before(end, cell) = dot_product(before%opened_before(:, old), weight)
            end if
            after%contact(end, cell) = before%contact(maxloc(weight, dim=1), old)
            exit
         end do
      end do
   end subroutine transfer_parts

   !> Weights of the jumps of a cell at a point: the jumps are those at the third points, and linear
   !! between [-].
   pure function shares(s, ends) result(weight)
      real(rk), intent(in) :: s  !< [m]
      real(rk), intent(in) :: ends(2)  !< ends of the cell [m]
      real(rk) :: weight(2)
      real(rk) :: t

      t = 3.0_rk*(s - ends(1))/(ends(2) - ends(1)) - 1.0_rk
      weight = [1.0_rk - t, t]
   end function shares

   !> Nearest old cell on the fracture of a new one.
   pure integer(ik) function nearest_old(before, after, cell)
      type(fracture_mesh_t), intent(in) :: before, after
      integer(ik), intent(in) :: cell

      nearest_old = minloc(abs(sum(before%cell_s, dim=1) - sum(after%cell_s(:, cell))), dim=1, &
                           mask=before%cell_fracture == after%cell_fracture(cell))
   end function nearest_old

end module twolevel_transfer
