!> The weight of the cells that no stress in situ balances: of the rock with the fluid in its pores,
!! less the weight balanced by the increase of the stress with depth, plus the weight that the
!! density of regions adds.
!!
!! Points of the body with loads or restraints, distributed over the cells around them.
module coarse_loads
   use base_kinds, only: ik, rk
   use base_plane, only: barycentric
   use coarse_in_situ, only: in_situ_state_t, weight_of_scene
   use coarse_matrix, only: matrix_t
   use coarse_permeability, only: mean_of_regions
   use mesh_geometry, only: cell_area, cell_centre
   use mesh_types, only: mesh_t
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: add_point_forces, find_weight, hold_points

   !> Stiffness of the springs at restrained points over Young's modulus of the rock [-]: without
   !! force in the restraint, as intended, the result does not depend on it.
   real(rk), parameter :: support = 1.0e3_rk

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

   !> Add the forces of the scene to those on the cells.
   pure subroutine add_point_forces(scene, mesh, force)
      type(scene_t), intent(in) :: scene
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(inout) :: force(:, :)  !< (2, n_cells) [N/m]
      integer(ik) :: i, k

      do i = 1, size(scene%point_loads, kind=ik)
         associate (load => scene%point_loads(i))
            associate (cells => cells_at(mesh, [load%x, load%y]))
               do k = 1, size(cells, kind=ik)
                  force(:, cells(k)) = force(:, cells(k)) + load%force/size(cells)
               end do
            end associate
         end associate
      end do
   end subroutine add_point_forces

   !> Hold the points that the scene restrains: each component by one spring between what is given
   !! and the displacement of the point, as the cells around it give it. So a point takes three
   !! motions from the body at most, and no strain.
   pure subroutine hold_points(scene, mesh, matrix, force)
      type(scene_t), intent(in) :: scene
      type(mesh_t), intent(in) :: mesh
      type(matrix_t), intent(inout) :: matrix
      real(rk), intent(inout) :: force(:, :)  !< (2, n_cells) [N/m]
      real(rk) :: spring  ! [Pa]
      real(rk), allocatable :: weight(:)
      integer(ik), allocatable :: cells(:)
      integer(ik) :: axis, i, k

      spring = support*scene%material%young
      do i = 1, size(scene%restraints, kind=ik)
         associate (point => scene%restraints(i))
            cells = cells_at(mesh, [point%x, point%y])
            weight = weights_at(mesh, cells, [point%x, point%y])
            do axis = 1, 2
               if (.not. point%displacement_given(axis)) cycle
               do k = 1, size(cells, kind=ik)
                  call add_products(matrix, axis, cells(k), spring*weight(k), cells, weight)
                  force(axis, cells(k)) = force(axis, cells(k)) &
                                          + spring*weight(k)*point%displacement(axis)
               end do
            end do
         end associate
      end do
   end subroutine hold_points

   !> Add a row of a spring between cells to the lower triangle. Cells around a vertex meet there.
   pure subroutine add_products(matrix, axis, row, factor, cells, weight)
      type(matrix_t), intent(inout) :: matrix
      integer(ik), intent(in) :: axis, row
      real(rk), intent(in) :: factor  !< [Pa]
      integer(ik), intent(in) :: cells(:)
      real(rk), intent(in) :: weight(:)  !< [-]
      integer(ik) :: entry, k

      do k = 1, size(cells, kind=ik)
         if (cells(k) > row) cycle
         entry = matrix%entry_at(row, cells(k))
         matrix%elastic(axis, axis, entry) = matrix%elastic(axis, axis, entry) + factor*weight(k)
      end do
   end subroutine add_products

   !> Weights of cells in the displacement of a point: exact for linear fields with at least three
   !! cells, with the least sum of squares; else equal.
   pure function weights_at(mesh, cells, xy) result(weight)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cells(:)
      real(rk), intent(in) :: xy(2)  !< [m]
      real(rk) :: weight(size(cells))
      real(rk), parameter :: flat = 1.0e-3_rk  ! centres nearly on a line
      real(rk) :: centre(2, size(cells)), determinant, mean(2), moment(2, 2), slope(2)
      integer(ik) :: k

      do k = 1, size(cells, kind=ik)
         centre(:, k) = cell_centre(mesh, cells(k)) - xy
      end do
      mean = sum(centre, dim=2)/size(cells)
      centre = centre - spread(mean, 2, size(cells))
      moment = matmul(centre, transpose(centre))
      determinant = moment(1, 1)*moment(2, 2) - moment(1, 2)**2
      weight = 1.0_rk/size(cells)
      if (.not. determinant > flat*(moment(1, 1) + moment(2, 2))**2) return
      slope = [moment(2, 2)*mean(1) - moment(1, 2)*mean(2), &
               moment(1, 1)*mean(2) - moment(1, 2)*mean(1)]/determinant
      weight = weight - matmul(slope, centre)
   end function weights_at

   !> The cells that have a corner at a point, else the one that the point lies in.
   pure function cells_at(mesh, xy) result(cells)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: xy(2)  !< [m]
      integer(ik), allocatable :: cells(:)
      real(rk), parameter :: at_corner = 1.0e-6_rk  ! share of the others in the point
      real(rk) :: weight(3), inside(mesh%n_cells)
      logical :: has_corner(mesh%n_cells)
      integer(ik) :: c

      do c = 1, mesh%n_cells
         weight = barycentric(mesh%xy(:, mesh%cell_nodes(:, c)), xy)
         inside(c) = minval(weight)
         has_corner(c) = all(weight > -at_corner) .and. any(weight > 1.0_rk - at_corner)
      end do
      cells = pack([(c, c=1, mesh%n_cells)], has_corner)
      if (size(cells) == 0) cells = [maxloc(inside, dim=1, kind=ik)]
   end function cells_at

end module coarse_loads
