!> The flow of a quantity that follows the gradient of a scalar: multi-point flux stencil around one
!! vertex, and quantities that follow from the fluxes. For the fluid the scalar is the pressure p
!! [Pa] and the flux the Darcy velocity q = -(K/mu) grad p [m/s]. The module does not depend on the
!! fluid; the comments give the units of that case.
!!
!! Mixed form, as for the stress (coarse_matrix): each face has a normal flux at each of its two
!! ends; around a vertex these couple only to each other and to the scalars of the cells there. The
!! scalar is continuous at a third of each face. On both sides of a fracture it has a separate
!! value, an unknown, at which the flux leaves the rock. Local system (coarse_elimination):
!!   B q = H p - given scalars on the boundary.
!!
!! Next to a face with a layer (coarse_layers) the scalar at the outer end of the layer takes the
!! place of that at the face, and the resistance of the layer is taken out of B.
module coarse_diffusion
   use base_kinds, only: ik, rk
   use coarse_elimination, only: fix_unknown, local_system_t, new_local_system, response_t
   use coarse_layout, only: end_of_block, fracture_cell_of_block
   use coarse_regions, only: regions_t
   use mesh_geometry, only: corner_geometry, face_length
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: boundary_outflow, cell_outflow, corner_gradient, region_fluxes, set_flux_equations

contains

   !> The equations of the fluxes of one region.
   pure subroutine set_flux_equations(mesh, resistivity, is_given, given, regions, region, local, &
                                      relief, offset)
      type(mesh_t), intent(in) :: mesh
      !> gradient = -resistivity flux: (2, 2, 1) the same everywhere, or (2, 2, n_cells) [Pa s/m2]
      real(rk), intent(in) :: resistivity(:, :, :)
      logical, intent(in) :: is_given(:)  !< (sides) the scalar is given, else the flux
      real(rk), intent(in) :: given(:)  !< (sides) its value [Pa], or the flux out of the body [m/s]
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(local_system_t), intent(inout) :: local
      !> (layers) resistance of the layers at each end of their faces [Pa s]
      real(rk), intent(in), optional :: relief(:)
      !> (2, cells) where their scalars are, from their centres [m]
      real(rk), intent(in), optional :: offset(:, :)
      integer(ik) :: m, n

      m = regions%scalar_count(region)
      n = regions%flow_faces%length(region)
      call new_local_system(n, m, local)
      call add_corners(mesh, resistivity, regions, region, local, offset)
      call add_fracture_faces(mesh, regions, region, local)
      if (present(relief)) call add_layers(mesh, regions, region, relief, local)
      local%equations(n + 1:n + m, :n) = local%coupling(:m, :n)
      call apply_sides(mesh, is_given, given, regions, region, local)
   end subroutine set_flux_equations

   !> Contributions of the corners of cells around the vertex.
   pure subroutine add_corners(mesh, resistivity, regions, region, local, offset)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: resistivity(:, :, :)  !< (2, 2, 1) or (2, 2, n_cells) [Pa s/m2]
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(local_system_t), intent(inout) :: local
      real(rk), intent(in), optional :: offset(:, :)
      integer(ik) :: at(2), c, cell, faces(2), i, j, k, kind
      real(rk) :: sign_out(2), length(2), lever(2, 2), area, from_centre(2), of_cell(2, 2), w

      do c = 1, regions%cell_count(region)
         cell = regions%blocks%at(region, c)
         kind = min(cell, size(resistivity, 3, kind=ik))
         k = findloc(regions%regions_of_block(:, cell), region, dim=1)
         call corner_geometry(mesh, cell, k, faces, sign_out, length, lever, area)
         do j = 1, 2
            at(j) = regions%flow_faces%place(region, faces(j))
         end do
         w = area/3.0_rk
         of_cell = resistivity(:, :, kind)
         if (present(offset)) from_centre = matmul(offset(:, cell), of_cell)
         do j = 1, 2
            do i = 1, 2
               local%equations(at(i), at(j)) = local%equations(at(i), at(j)) &
                                               + w*sign_out(i)*sign_out(j) &
                                               *dot_product(lever(:, i), &
                                                            matmul(of_cell, lever(:, j)))
            end do
            local%coupling(c, at(j)) = 0.5_rk*sign_out(j)*length(j)
            if (.not. present(offset)) cycle
            do i = 1, 2
               associate (drop => sign_out(i)*dot_product(from_centre, lever(:, i)))
                  local%equations(at(i), at(j)) = local%equations(at(i), at(j)) &
                                                  - local%coupling(c, at(j))*drop
               end associate
            end do
         end do
      end do
   end subroutine add_corners

   !> Scalars on the fracture faces, which are unknowns.
   pure subroutine add_fracture_faces(mesh, regions, region, local)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(local_system_t), intent(inout) :: local
      integer(ik) :: at, b, block, cell

      do b = regions%cell_count(region) + 1, regions%blocks%length(region)
         block = regions%blocks%at(region, b)
         cell = fracture_cell_of_block(mesh, block)
         at = regions%flow_faces%place(region, &
                                       mesh%fracture%cell_faces(end_of_block(mesh, block), cell))
         local%coupling(b, at) = -0.5_rk*face_length(mesh, mesh%fracture%cell_faces(1, cell))
      end do
   end subroutine add_fracture_faces

   !> Layers around the vertex: their resistance, and their scalars on the outer boundary.
   pure subroutine add_layers(mesh, regions, region, relief, local)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      real(rk), intent(in) :: relief(:)  !< [Pa s]
      type(local_system_t), intent(inout) :: local
      integer(ik) :: b, f, j

      if (mesh%n_layers == 0) return
      b = regions%blocks%length(region)
      do j = 1, regions%flow_faces%length(region)
         f = regions%flow_faces%at(region, j)
         associate (layer => mesh%face_layer(f))
            if (layer == 0) cycle
            local%equations(j, j) = local%equations(j, j) - relief(layer)
         end associate
         if (mesh%face_side(f) == 0) cycle
         b = b + 1
         local%coupling(b, j) = -0.5_rk*face_length(mesh, f)
      end do
   end subroutine add_layers

   !> Outer boundary: the scalar or the flux is prescribed.
   pure subroutine apply_sides(mesh, is_given, given, regions, region, local)
      type(mesh_t), intent(in) :: mesh
      logical, intent(in) :: is_given(:)  !< (sides)
      real(rk), intent(in) :: given(:)  !< (sides) [Pa] or [m/s]
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(local_system_t), intent(inout) :: local
      integer(ik) :: f, j, last

      last = local%last()
      do j = 1, regions%flow_faces%length(region)
         f = regions%flow_faces%at(region, j)
         associate (side => mesh%face_side(f))
            if (side == 0) cycle
            if (mesh%n_layers > 0) then
               if (mesh%face_layer(f) > 0) cycle
            end if
            if (is_given(side)) then
               local%equations(last, j) = local%equations(last, j) &
                                          - 0.5_rk*face_length(mesh, f)*given(side)
            else
               call fix_unknown(local, j, given(side))
            end if
         end associate
      end do
   end subroutine apply_sides

   !> Fluxes through the faces around one vertex.
   pure subroutine region_fluxes(regions, responses, scalars, region, flux)
      type(regions_t), intent(in) :: regions
      type(response_t), intent(in) :: responses(:)  !< (n_regions) of the fluxes [m/s]
      real(rk), intent(in) :: scalars(:)  !< of regions%scalars_of [Pa]
      integer(ik), intent(in) :: region
      real(rk), intent(out) :: flux(:)  !< (flow faces of the region) [m/s]
      real(rk) :: around(regions%scalar_count(region))
      integer(ik) :: b

      do b = 1, size(around, kind=ik)
         if (allocated(regions%scalars)) then
            around(b) = scalars(regions%scalars%at(region, b))
         else
            around(b) = scalars(regions%blocks%at(region, b))
         end if
      end do
      call responses(region)%apply(around, flux)
   end subroutine region_fluxes

   !> Outflow of each cell through its faces.
   subroutine cell_outflow(mesh, regions, responses, scalars, outflow)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      type(response_t), intent(in) :: responses(:)  !< (n_regions) of the fluxes [m/s]
      real(rk), intent(in) :: scalars(:)  !< of regions%scalars_of [Pa]
      real(rk), intent(out) :: outflow(:)  !< (n_cells) [m2/s]
      real(rk), allocatable :: flux(:)
      integer(ik) :: f, j, r

      outflow = 0.0_rk
      do r = 1, regions%n_regions
         allocate (flux(regions%flow_faces%length(r)))
         call region_fluxes(regions, responses, scalars, r, flux)
         do j = 1, size(flux)
            f = regions%flow_faces%at(r, j)
            associate (cells => mesh%face_cells(:, f), flow => 0.5_rk*face_length(mesh, f)*flux(j))
               outflow(cells(1)) = outflow(cells(1)) + flow
               if (cells(2) > 0) outflow(cells(2)) = outflow(cells(2)) - flow
            end associate
         end do
         deallocate (flux)
      end do
   end subroutine cell_outflow

   !> Outflow of the body through those faces of its outer boundary that have no layer.
   real(rk) function boundary_outflow(mesh, regions, responses, scalars) result(outflow)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      type(response_t), intent(in) :: responses(:)  !< (n_regions) of the fluxes [m/s]
      real(rk), intent(in) :: scalars(:)  !< of regions%scalars_of [Pa]
      real(rk), allocatable :: flux(:)
      integer(ik) :: f, j, r

      outflow = 0.0_rk
      do r = 1, regions%n_regions
         allocate (flux(regions%flow_faces%length(r)))
         call region_fluxes(regions, responses, scalars, r, flux)
         do j = 1, size(flux)
            f = regions%flow_faces%at(r, j)
            if (mesh%face_side(f) == 0) cycle
            if (mesh%n_layers > 0) then
               if (mesh%face_layer(f) > 0) cycle
            end if
            outflow = outflow + 0.5_rk*face_length(mesh, f)*flux(j)
         end do
         deallocate (flux)
      end do
   end function boundary_outflow

   !> Gradient of the scalar at corner k of a cell.
   pure subroutine corner_gradient(mesh, resistivity, regions, flux, cell, k, gradient)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: resistivity(:, :, :)  !< (2, 2, 1) or (2, 2, n_cells) [Pa s/m2]
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: flux(:)  !< of region_fluxes around the corner [m/s]
      integer(ik), intent(in) :: cell, k
      real(rk), intent(out) :: gradient(2)  !< [Pa/m]
      integer(ik) :: faces(2), j
      real(rk) :: sign_out(2), length(2), lever(2, 2), area, velocity(2), of_cell(2, 2)

      call corner_geometry(mesh, cell, k, faces, sign_out, length, lever, area)
      velocity = 0.0_rk
      do j = 1, 2
         associate (row => regions%flow_faces%place(regions%regions_of_block(k, cell), faces(j)))
            velocity = velocity + sign_out(j)*lever(:, j)*flux(row)
         end associate
      end do
      of_cell = resistivity(:, :, min(cell, size(resistivity, 3, kind=ik)))
      gradient = -matmul(of_cell, velocity)
   end subroutine corner_gradient

end module coarse_diffusion
