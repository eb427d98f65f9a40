!> Values at the nodes of the mesh, from those of the cells around each node.
module coarse_nodes
   use base_kinds, only: ik, rk
   use coarse_diffusion, only: corner_gradient, region_fluxes
   use coarse_fields, only: corner_gradients, displacement_gradients
   use coarse_layout, only: layer_block
   use coarse_regions, only: regions_t
   use coarse_rock, only: rock_t
   use mesh_geometry, only: cell_centre
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: nodal_fields, node_values

contains

   !> Fields at the mesh's nodes. `values`: displacement and pressure, the mean of what the cells
   !! around a node extrapolate. `curved` and `gradients`: displacement and its gradient for an
   !! interpolation that is exact for quadratic fields; from a cell's centre to a node with the mean
   !! of the gradients at both.
   subroutine nodal_fields(mesh, rock, regions, unknowns, tractions, values, curved, gradients)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      real(rk), intent(out), optional :: values(:, :)  !< (3, n_nodes) [m], [m], [Pa]
      real(rk), intent(out), optional :: curved(:, :)  !< (2, n_nodes) with `gradients` [m]
      !> (2, 2, n_nodes) d u_i / d x_j [-]
      real(rk), intent(out), optional :: gradients(:, :, :)
      real(rk), allocatable :: at_corners(:, :, :, :)

      call displacement_gradients(mesh, rock, regions, unknowns, tractions, at_corners)
      if (present(values)) then
         call extrapolate_to_nodes(mesh, rock, regions, unknowns, at_corners, values)
      end if
      if (present(curved)) call curve_to_nodes(mesh, unknowns, at_corners, curved, gradients)
   end subroutine nodal_fields

   !> Mean of the extrapolations to each node, from the cells of one region on its side of a
   !! fracture.
   subroutine extrapolate_to_nodes(mesh, rock, regions, unknowns, at_corners, values)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), intent(in) :: at_corners(:, :, :, :)  !< of displacement_gradients [-]
      real(rk), intent(out) :: values(:, :)  !< (3, n_nodes) [m], [m], [Pa]
      real(rk), allocatable :: scalars(:), weight(:)
      integer(ik) :: r, v

      values = 0.0_rk
      scalars = regions%scalars_of(unknowns)
      allocate (weight(mesh%n_nodes), source=0.0_rk)
      !$omp parallel do
      do r = 1, regions%n_regions
         call extrapolate_around(mesh, rock, regions, unknowns, scalars, at_corners, r, values, &
                                 weight)
      end do
      !$omp end parallel do
      do v = 1, mesh%n_nodes
         values(:, v) = values(:, v)/weight(v)
      end do
   end subroutine extrapolate_to_nodes

   !> Add up what the cells of one region give at its nodes.
   pure subroutine extrapolate_around(mesh, rock, regions, unknowns, scalars, at_corners, region, &
                                      values, weight)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), intent(in) :: scalars(:)  !< of regions%scalars_of [Pa]
      real(rk), intent(in) :: at_corners(:, :, :, :)  !< of displacement_gradients [-]
      integer(ik), intent(in) :: region
      real(rk), intent(inout) :: values(:, :)  !< (3, n_nodes) [m], [m], [Pa]
      real(rk), intent(inout) :: weight(:)  !< (n_nodes) their number [-]
      real(rk) :: flux(regions%flow_faces%length(region)), pressure_gradient(2), value(3)
      integer(ik) :: c, cell, k, v

      call region_fluxes(regions, regions%flux, scalars, region, flux)
      do c = 1, regions%cell_count(region)
         cell = regions%blocks%at(region, c)
         do k = 1, 2
            if (regions%regions_of_block(k, cell) == region) exit
         end do
         v = mesh%cell_nodes(k, cell)
         call corner_gradient(mesh, rock%resistivity, regions, flux, cell, k, pressure_gradient)
         call extrapolate(mesh, unknowns, cell, k, at_corners(:, :, k, cell), pressure_gradient, &
                          value)
         values(:, v) = values(:, v) + value
         weight(v) = weight(v) + 1.0_rk
      end do
   end subroutine extrapolate_around

   !> Displacement at the nodes for an interpolation that is exact for quadratic fields, and its
   !! gradient.
   pure subroutine curve_to_nodes(mesh, unknowns, at_corners, values, gradients)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), intent(in) :: at_corners(:, :, :, :)  !< of displacement_gradients [-]
      real(rk), intent(out) :: values(:, :)  !< (2, n_nodes) [m]
      real(rk), intent(out) :: gradients(:, :, :)  !< (2, 2, n_nodes) [-]
      real(rk) :: at_centre(2, 2), between(2, 2), centre(2), offset(2)
      real(rk), allocatable :: weight(:)
      integer(ik) :: c, k, v

      allocate (weight(mesh%n_nodes), source=0.0_rk)
      values = 0.0_rk
      gradients = 0.0_rk
      do c = 1, mesh%n_cells
         at_centre = sum(at_corners(:, :, :, c), dim=3)/3.0_rk
         centre = cell_centre(mesh, c)
         do k = 1, 3
            v = mesh%cell_nodes(k, c)
            between = 0.5_rk*(at_corners(:, :, k, c) + at_centre)
            offset = mesh%xy(:, v) - centre
            values(:, v) = values(:, v) + unknowns(1:2, c) + matmul(between, offset)
            gradients(:, :, v) = gradients(:, :, v) + at_corners(:, :, k, c)
            weight(v) = weight(v) + 1.0_rk
         end do
      end do
      do v = 1, mesh%n_nodes
         values(:, v) = values(:, v)/weight(v)
         gradients(:, :, v) = gradients(:, :, v)/weight(v)
      end do
   end subroutine curve_to_nodes

   !> Displacement and pressure at one node, as nodal_fields finds them.
   pure function node_values(mesh, rock, regions, unknowns, tractions, node) result(mean)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      integer(ik), intent(in) :: node
      real(rk) :: mean(3)  !< [m], [m], [Pa]
      real(rk) :: flux(regions%flow_faces%length(regions%region_of_node(node)))
      real(rk) :: gradient(2, 2, 3), pressure_gradient(2), value(3)
      integer(ik) :: c, cell, k, n, region

      mean = 0.0_rk
      n = 0
      region = regions%region_of_node(node)
      call region_fluxes(regions, regions%flux, regions%scalars_of(unknowns), region, flux)
      do c = 1, regions%cell_count(region)
         cell = regions%blocks%at(region, c)
         k = findloc(mesh%cell_nodes(:, cell), node, dim=1)
         if (k == 0) cycle  ! on another side of a fracture
         call corner_gradients(mesh, rock, regions, unknowns, tractions, cell, gradient)
         call corner_gradient(mesh, rock%resistivity, regions, flux, cell, k, pressure_gradient)
         call extrapolate(mesh, unknowns, cell, k, gradient(:, :, k), pressure_gradient, value)
         if (mesh%n_layers > 0) then
            ! The gradient is that of the rest of the cell.
            if (mesh%cell_layer(cell) > 0) value(3) = value(3) - unknowns(3, cell) &
                                             + unknowns(3, layer_block(mesh, mesh%cell_layer(cell)))
         end if
         mean = mean + value
         n = n + 1
      end do
      mean = mean/n
   end function node_values

   !> Displacement and pressure at a corner, from those of the cell and its gradients.
   pure subroutine extrapolate(mesh, unknowns, cell, k, gradient, pressure_gradient, value)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      integer(ik), intent(in) :: cell, k  !< corner k of the cell
      real(rk), intent(in) :: gradient(2, 2)  !< of the displacement at the corner [-]
      real(rk), intent(in) :: pressure_gradient(2)  !< [Pa/m]
      real(rk), intent(out) :: value(3)  !< [m], [m], [Pa]
      real(rk) :: offset(2)

      offset = mesh%xy(:, mesh%cell_nodes(k, cell)) - cell_centre(mesh, cell)
      value(1:2) = unknowns(1:2, cell) + matmul(gradient, offset)
      value(3) = unknowns(3, cell) + dot_product(pressure_gradient, offset)
   end subroutine extrapolate

end module coarse_nodes
