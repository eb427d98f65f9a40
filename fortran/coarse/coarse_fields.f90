!> Fields derived from the unknowns: fluid content, stress, strain.
module coarse_fields
   use base_kinds, only: ik, rk
   use coarse_matrix, only: matrix_t
   use coarse_regions, only: regions_t
   use coarse_rock, only: rock_t
   use mesh_geometry, only: cell_area
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: cell_contents, cell_stress, cell_stresses, corner_gradients, corner_tractions
   public :: displacement_gradients

contains

   !> Tractions and rotations of all regions, packed as regions%at_traction says.
   subroutine corner_tractions(regions, unknowns, tractions)
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), allocatable, intent(out) :: tractions(:)  !< [Pa], rotations [-]
      integer(ik) :: r

      allocate (tractions(regions%traction_count()))
      !$omp parallel do
      do r = 1, regions%n_regions
         associate (first => regions%at_traction(r), next => regions%at_traction(r + 1))
            call find_tractions(regions, r, unknowns, tractions(first:next - 1))
         end associate
      end do
      !$omp end parallel do
   end subroutine corner_tractions

   !> Those of one region.
   pure subroutine find_tractions(regions, region, unknowns, tractions)
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), intent(out) :: tractions(:)  !< [Pa], rotations [-]
      real(rk) :: d(3*regions%blocks%length(region))
      integer(ik) :: b

      do b = 1, regions%blocks%length(region)
         d(3*b - 2:3*b) = unknowns(:, regions%blocks%at(region, b))
      end do
      call regions%traction(region)%apply(d, tractions)
   end subroutine find_tractions

   !> Fluid content of each cell [m2]: storage and volume change (docs/theory.md).
   subroutine cell_contents(mesh, rock, regions, matrix, unknowns, tractions, content)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      type(matrix_t), intent(in) :: matrix
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      real(rk), intent(out) :: content(:)  !< (n_cells) above the initial state [m2]
      integer(ik) :: c

      !$omp parallel do
      do c = 1, mesh%n_cells
         associate (solid => rock%solid_at(c))
            content(c) = matrix%storage(c)*unknowns(3, c) &
                         + solid%biot*cell_area(mesh, c)*mean_trace(regions, tractions, c) &
                         /(2.0_rk*(solid%lame + solid%shear))
            if (allocated(rock%temperature)) content(c) = content(c) &
               & + solid%content_per_heat()*rock%temperature(c)*cell_area(mesh, c)
         end associate
      end do
      !$omp end parallel do
   end subroutine cell_contents

   !> Sum of the normal stresses in a cell, mean over its corners [Pa].
   pure real(rk) function mean_trace(regions, tractions, cell)
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      integer(ik), intent(in) :: cell
      integer(ik) :: at, j, k

      mean_trace = 0.0_rk
      do k = 1, 3
         do j = 1, 2
            at = regions%at_corner(j, k, cell)
            mean_trace = mean_trace + dot_product(regions%lever(:, j, k, cell), &
                                                  tractions(at:at + 1))
         end do
      end do
      mean_trace = mean_trace/3.0_rk
   end function mean_trace

   !> Total stress in each cell: mean over its corners, symmetric part.
   subroutine cell_stresses(mesh, regions, tractions, stresses)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      real(rk), intent(out) :: stresses(:, :)  !< (3, n_cells) xx, yy, xy [Pa]
      integer(ik) :: c

      do c = 1, mesh%n_cells
         stresses(:, c) = cell_stress(regions, tractions, c)
      end do
   end subroutine cell_stresses

   !> The same in one cell.
   pure function cell_stress(regions, tractions, cell) result(mean)
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      integer(ik), intent(in) :: cell
      real(rk) :: mean(3)  !< xx, yy, xy [Pa]
      integer(ik) :: k
      real(rk) :: stress(2, 2), rotation

      mean = 0.0_rk
      do k = 1, 3
         call corner_stress(regions, tractions, cell, k, stress, rotation)
         mean = mean + [stress(1, 1), stress(2, 2), 0.5_rk*(stress(1, 2) + stress(2, 1))]/3.0_rk
      end do
   end function cell_stress

   !> Gradients of the displacement at the corners of all cells, d u_i / d x_j.
   subroutine displacement_gradients(mesh, rock, regions, unknowns, tractions, gradients)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      real(rk), allocatable, intent(out) :: gradients(:, :, :, :)  !< (2, 2, corner, n_cells) [-]
      integer(ik) :: c

      allocate (gradients(2, 2, 3, mesh%n_cells))
      !$omp parallel do
      do c = 1, mesh%n_cells
         call corner_gradients(mesh, rock, regions, unknowns, tractions, c, gradients(:, :, :, c))
      end do
      !$omp end parallel do
   end subroutine displacement_gradients

   !> Gradients of the displacement at the corners of a cell, d u_i / d x_j.
   pure subroutine corner_gradients(mesh, rock, regions, unknowns, tractions, cell, gradient)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      integer(ik), intent(in) :: cell
      real(rk), intent(out) :: gradient(2, 2, 3)  !< [-]
      real(rk) :: rotation(3)
      integer(ik) :: k
      logical :: free(3)

      do k = 1, 3
         call corner_strain(rock, regions, unknowns, tractions, cell, k, gradient(:, :, k), &
                            rotation(k))
         free(k) = rotation_is_free(regions, regions%region_of_node(mesh%cell_nodes(k, cell)))
      end do
      ! A corner with prescribed tractions has no rotation: that of the cell's other corners counts.
      if (any(free) .and. .not. all(free)) then
         rotation = merge(sum(rotation, mask=.not. free)/real(count(.not. free), rk), rotation, &
                          free)
      end if
      gradient(2, 1, :) = gradient(2, 1, :) + rotation
      gradient(1, 2, :) = gradient(1, 2, :) - rotation
   end subroutine corner_gradients

   !> Strain (without rotation) at a corner: eps = A (sigma + (alpha p + K_dr b_s theta) I), and the
   !! vertex' rotation.
   pure subroutine corner_strain(rock, regions, unknowns, tractions, cell, k, strain, rotation)
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      integer(ik), intent(in) :: cell, k
      real(rk), intent(out) :: strain(2, 2), rotation  !< [-]
      real(rk) :: stress(2, 2), nu
      integer(ik) :: at, i

      at = min(cell, size(rock%shear, kind=ik))
      call corner_stress(regions, tractions, cell, k, stress, rotation)
      do i = 1, 2
         stress(i, i) = stress(i, i) + rock%biot(at)*unknowns(3, cell)
         if (allocated(rock%temperature)) stress(i, i) = stress(i, i) &
            & + rock%heat_stress(at)*rock%temperature(cell)
      end do
      nu = rock%lame(at)/(2.0_rk*(rock%lame(at) + rock%shear(at)))
      strain = stress
      do i = 1, 2
         strain(i, i) = strain(i, i) - nu*(stress(1, 1) + stress(2, 2))
      end do
      strain = strain/(2.0_rk*rock%shear(at))
   end subroutine corner_strain

   !> Total stress at a corner of a cell, and the rotation there.
   pure subroutine corner_stress(regions, tractions, cell, k, stress, rotation)
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      integer(ik), intent(in) :: cell, k
      real(rk), intent(out) :: stress(2, 2)  !< not symmetric by itself [Pa]
      real(rk), intent(out) :: rotation  !< [-]
      integer(ik) :: at, i, j

      stress = 0.0_rk
      do j = 1, 2
         at = regions%at_corner(j, k, cell)
         do i = 1, 2
            stress(:, i) = stress(:, i) + regions%lever(i, j, k, cell)*tractions(at:at + 1)
         end do
      end do
      rotation = tractions(regions%at_corner(3, k, cell))
   end subroutine corner_stress

   !> Whether the tractions of a region are all given, so that its rotation means nothing.
   pure function rotation_is_free(regions, r) result(is_free)
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: r
      logical :: is_free

      is_free = regions%faces%length(r) == 2
      if (is_free) then
         associate (response => regions%traction(r)%matrix)
            is_free = .not. any(abs(response(:size(response, 1) - 1, :)) > 0.0_rk)
         end associate
      end if
   end function rotation_is_free

end module coarse_fields
