!> Fields that follow from the unknowns: fluid content, stress, strain, values at the nodes.
module coarse_fields
   use base_kinds, only: ik, rk
   use coarse_diffusion, only: corner_gradient
   use coarse_geometry, only: cell_area, corner_geometry
   use coarse_matrix, only: matrix_t
   use coarse_regions, only: regions_t, traction_face
   use coarse_rock, only: rock_t
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: cell_contents, cell_stress, cell_stresses, corner_tractions, curved_displacement
   public :: nodal_values, node_values

contains

   !> Tractions and rotations of all regions, packed as regions%at_traction says.
   subroutine corner_tractions(regions, unknowns, tractions)
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), allocatable, intent(out) :: tractions(:)  !< [Pa], rotations [-]
      real(rk), allocatable :: d(:)
      integer(ik) :: r

      allocate (tractions(regions%traction_count()))
      do r = 1, regions%n_regions
         d = [unknowns(:, regions%blocks%of(r))]
         call regions%traction(r)%apply(d, tractions(regions%at_traction(r): &
                                                     regions%at_traction(r + 1) - 1))
      end do
   end subroutine corner_tractions

   !> Fluid content of each cell [m2]: storage and volume change (docs/theory.md).
   subroutine cell_contents(mesh, rock, regions, matrix, unknowns, tractions, content)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      type(matrix_t), intent(in) :: matrix
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      real(rk), intent(out) :: content(:)  !< (n_cells) above the initial state [m2]
      integer(ik) :: at, c, k
      real(rk) :: stress(2, 2), rotation, area

      do c = 1, mesh%n_cells
         content(c) = matrix%storage(c)*unknowns(3, c)
         area = cell_area(mesh, c)
         at = min(c, size(rock%shear, kind=ik))
         do k = 1, 3
            call corner_stress(mesh, regions, tractions, c, k, stress, rotation)
            content(c) = content(c) + rock%biot(at)*area/3.0_rk*(stress(1, 1) + stress(2, 2)) &
                         /(2.0_rk*(rock%lame(at) + rock%shear(at)))
         end do
      end do
   end subroutine cell_contents

   !> Total stress in each cell: mean over its corners, symmetric part.
   subroutine cell_stresses(mesh, regions, tractions, stresses)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      real(rk), intent(out) :: stresses(:, :)  !< (3, n_cells) xx, yy, xy [Pa]
      integer(ik) :: c

      do c = 1, mesh%n_cells
         stresses(:, c) = cell_stress(mesh, regions, tractions, c)
      end do
   end subroutine cell_stresses

   !> The same in one cell.
   pure function cell_stress(mesh, regions, tractions, cell) result(mean)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      integer(ik), intent(in) :: cell
      real(rk) :: mean(3)  !< xx, yy, xy [Pa]
      integer(ik) :: k
      real(rk) :: stress(2, 2), rotation

      mean = 0.0_rk
      do k = 1, 3
         call corner_stress(mesh, regions, tractions, cell, k, stress, rotation)
         mean = mean + [stress(1, 1), stress(2, 2), 0.5_rk*(stress(1, 2) + stress(2, 1))]/3.0_rk
      end do
   end function cell_stress

   !> Displacement and pressure at the mesh's nodes: mean of what the cells around extrapolate.
   subroutine nodal_values(mesh, rock, regions, unknowns, tractions, values)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      real(rk), intent(out) :: values(:, :)  !< (3, n_nodes) [m], [m], [Pa]
      integer(ik) :: c, k, v
      real(rk) :: gradient(2, 2, 3), value(3)
      real(rk), allocatable :: weight(:)

      allocate (weight(mesh%n_nodes), source=0.0_rk)
      values = 0.0_rk
      do c = 1, mesh%n_cells
         call corner_gradients(mesh, rock, regions, unknowns, tractions, c, gradient)
         do k = 1, 3
            v = mesh%cell_nodes(k, c)
            call extrapolate(mesh, rock, regions, unknowns, c, k, gradient(:, :, k), value)
            values(:, v) = values(:, v) + value
            weight(v) = weight(v) + 1.0_rk
         end do
      end do
      do v = 1, mesh%n_nodes
         values(:, v) = values(:, v)/weight(v)
      end do
   end subroutine nodal_values

   !> The same at one node.
   pure function node_values(mesh, rock, regions, unknowns, tractions, node) result(mean)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      integer(ik), intent(in) :: node
      real(rk) :: mean(3)  !< [m], [m], [Pa]
      integer(ik) :: c, cell, k, n, region
      real(rk) :: gradient(2, 2, 3), value(3)

      mean = 0.0_rk
      n = 0
      region = regions%region_of_node(node)
      do c = 1, regions%cell_count(region)
         cell = regions%blocks%at(region, c)
         k = findloc(mesh%cell_nodes(:, cell), node, dim=1)
         if (k == 0) cycle  ! on another side of a fracture
         call corner_gradients(mesh, rock, regions, unknowns, tractions, cell, gradient)
         call extrapolate(mesh, rock, regions, unknowns, cell, k, gradient(:, :, k), value)
         mean = mean + value
         n = n + 1
      end do
      mean = mean/n
   end function node_values

   !> Displacement and pressure at a corner, from those of the cell and its gradients.
   pure subroutine extrapolate(mesh, rock, regions, unknowns, cell, k, gradient, value)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      integer(ik), intent(in) :: cell, k
      real(rk), intent(in) :: gradient(2, 2)  !< of the displacement at the corner [-]
      real(rk), intent(out) :: value(3)  !< [m], [m], [Pa]
      real(rk) :: offset(2), pressure_gradient(2)

      offset = mesh%xy(:, mesh%cell_nodes(k, cell)) - cell_centre(mesh, cell)
      call corner_gradient(mesh, rock%resistivity, regions, regions%flux, unknowns(3, :), cell, k, &
                           pressure_gradient)
      value(1:2) = unknowns(1:2, cell) + matmul(gradient, offset)
      value(3) = unknowns(3, cell) + dot_product(pressure_gradient, offset)
   end subroutine extrapolate

   !> Displacement at the mesh's nodes, and its gradient there, for an interpolation that is exact
   !! for quadratic fields: from a cell's centre to a node with the mean of the gradients of both.
   subroutine curved_displacement(mesh, rock, regions, unknowns, tractions, values, gradients)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      real(rk), intent(out) :: values(:, :)  !< (2, n_nodes) [m]
      real(rk), intent(out) :: gradients(:, :, :)  !< (2, 2, n_nodes) d u_i / d x_j [-]
      integer(ik) :: c, k, v
      real(rk) :: gradient(2, 2, 3), at_centre(2, 2)
      real(rk), allocatable :: weight(:)

      allocate (weight(mesh%n_nodes), source=0.0_rk)
      values = 0.0_rk
      gradients = 0.0_rk
      do c = 1, mesh%n_cells
         call corner_gradients(mesh, rock, regions, unknowns, tractions, c, gradient)
         at_centre = sum(gradient, dim=3)/3.0_rk
         do k = 1, 3
            v = mesh%cell_nodes(k, c)
            values(:, v) = values(:, v) + unknowns(1:2, c) &
                           + matmul(0.5_rk*(gradient(:, :, k) + at_centre), &
                                    mesh%xy(:, v) - cell_centre(mesh, c))
            gradients(:, :, v) = gradients(:, :, v) + gradient(:, :, k)
            weight(v) = weight(v) + 1.0_rk
         end do
      end do
      do v = 1, mesh%n_nodes
         values(:, v) = values(:, v)/weight(v)
         gradients(:, :, v) = gradients(:, :, v)/weight(v)
      end do
   end subroutine curved_displacement

   pure function cell_centre(mesh, cell) result(centre)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell
      real(rk) :: centre(2)  !< [m]

      centre = sum(mesh%xy(:, mesh%cell_nodes(:, cell)), dim=2)/3.0_rk
   end function cell_centre

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
         call corner_strain(mesh, rock, regions, unknowns, tractions, cell, k, &
                            gradient(:, :, k), rotation(k))
         free(k) = rotation_is_free(regions, regions%region_of_node(mesh%cell_nodes(k, cell)))
      end do
      ! A loaded corner of the body knows no rotation: take the cell's other corners'.
      if (any(free) .and. .not. all(free)) then
         rotation = merge(sum(rotation, mask=.not. free)/real(count(.not. free), rk), rotation, &
                          free)
      end if
      gradient(2, 1, :) = gradient(2, 1, :) + rotation
      gradient(1, 2, :) = gradient(1, 2, :) - rotation
   end subroutine corner_gradients

   !> Strain (without rotation) at a corner: eps = A (sigma + alpha p I), and the vertex' rotation.
   pure subroutine corner_strain(mesh, rock, regions, unknowns, tractions, cell, k, strain, &
                                 rotation)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      integer(ik), intent(in) :: cell, k
      real(rk), intent(out) :: strain(2, 2), rotation  !< [-]
      real(rk) :: stress(2, 2), nu
      integer(ik) :: at, i

      at = min(cell, size(rock%shear, kind=ik))
      call corner_stress(mesh, regions, tractions, cell, k, stress, rotation)
      do i = 1, 2
         stress(i, i) = stress(i, i) + rock%biot(at)*unknowns(3, cell)
      end do
      nu = rock%lame(at)/(2.0_rk*(rock%lame(at) + rock%shear(at)))
      strain = stress
      do i = 1, 2
         strain(i, i) = strain(i, i) - nu*(stress(1, 1) + stress(2, 2))
      end do
      strain = strain/(2.0_rk*rock%shear(at))
   end subroutine corner_strain

   !> Total stress at a corner of a cell, and the rotation there.
   pure subroutine corner_stress(mesh, regions, tractions, cell, k, stress, rotation)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      integer(ik), intent(in) :: cell, k
      real(rk), intent(out) :: stress(2, 2)  !< not symmetric by itself [Pa]
      real(rk), intent(out) :: rotation  !< [-]
      integer(ik) :: at, faces(2), i, j
      real(rk) :: sign_out(2), length(2), lever(2, 2), area

      call corner_geometry(mesh, cell, k, faces, sign_out, length, lever, area)
      stress = 0.0_rk
      do j = 1, 2
         call traction_face(mesh, faces(j), sign_out(j))
         at = regions%at_corner(j, k, cell)
         do i = 1, 2
            stress(:, i) = stress(:, i) + sign_out(j)*lever(i, j)*tractions(at:at + 1)
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
            is_free = .not. any(abs(response(:, :size(response, 2) - 1)) > 0.0_rk)
         end associate
      end if
   end function rotation_is_free

end module coarse_fields
