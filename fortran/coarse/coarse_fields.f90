!> Fields that follow from the unknowns: fluid content, stress, strain, values at the nodes.
module coarse_fields
   use base_kinds, only: ik, rk
   use coarse_matrix, only: cell_area, matrix_t
   use coarse_regions, only: corner_geometry, face_length, regions_t, traction_face, &
                             traction_position
   use coarse_rock, only: rock_t
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: cell_contents, cell_outflow, cell_stresses, corner_tractions, nodal_values

contains

   !> Tractions [Pa] and rotations [-] of all regions, packed (see traction_position).
   subroutine corner_tractions(regions, unknowns, tractions)
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks)
      real(rk), allocatable, intent(out) :: tractions(:)

      real(rk), allocatable :: d(:)
      integer(ik) :: at, n, r

      allocate (tractions(2*size(regions%faces) + size(regions%nodes)))
      do r = 1, regions%n_regions
         at = traction_position(regions, r)
         n = 2*(regions%face_first(r + 1) - regions%face_first(r)) + regions%node_first(r + 1) &
             - regions%node_first(r)
         d = [unknowns(:, regions%blocks(regions%block_first(r):regions%block_first(r + 1) - 1))]
         call respond(n, size(d, kind=ik), regions%traction(regions%traction_first(r):), d, &
                      tractions(at:at + n - 1))
      end do
   end subroutine corner_tractions

   !> Fluid content of each cell [m2]: storage and volume change (model.md section 2).
   subroutine cell_contents(mesh, rock, regions, matrix, unknowns, tractions, content)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      type(matrix_t), intent(in) :: matrix
      real(rk), intent(in) :: unknowns(:, :), tractions(:)
      real(rk), intent(out) :: content(:)  !< (n_cells)

      integer(ik) :: c, k
      real(rk) :: stress(2, 2), rotation, area

      do c = 1, mesh%n_cells
         content(c) = matrix%storage(c)*unknowns(3, c)
         area = cell_area(mesh, c)
         do k = 1, 3
            call corner_stress(mesh, regions, tractions, c, k, stress, rotation)
            content(c) = content(c) + rock%biot*area/3.0_rk*(stress(1, 1) + stress(2, 2)) &
                         /(2.0_rk*(rock%lame + rock%shear))
         end do
      end do
   end subroutine cell_contents

   !> Fluid that leaves each cell through its faces [m2/s].
   subroutine cell_outflow(mesh, regions, unknowns, outflow)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)
      real(rk), intent(out) :: outflow(:)  !< (n_cells)

      real(rk), allocatable :: flux(:), pressures(:)
      integer(ik) :: f, j, n, r

      outflow = 0.0_rk
      do r = 1, regions%n_regions
         n = regions%flow_first(r + 1) - regions%flow_first(r)
         pressures = unknowns(3, regions%blocks(regions%block_first(r): &
                                                regions%block_first(r + 1) - 1))
         allocate (flux(n))
         call respond(n, size(pressures, kind=ik), regions%flux(regions%flux_first(r):), &
                      pressures, flux)
         do j = 1, n
            f = regions%flow_faces(regions%flow_first(r) + j - 1)
            associate (cells => mesh%face_cells(:, f), flow => 0.5_rk*face_length(mesh, f)*flux(j))
               outflow(cells(1)) = outflow(cells(1)) + flow
               if (cells(2) > 0) outflow(cells(2)) = outflow(cells(2)) - flow
            end associate
         end do
         deallocate (flux)
      end do
   end subroutine cell_outflow

   !> Total stress in each cell: mean over its corners, symmetric part.
   subroutine cell_stresses(mesh, regions, tractions, stresses)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: tractions(:)
      real(rk), intent(out) :: stresses(:, :)  !< (3, n_cells) xx, yy, xy [Pa]

      integer(ik) :: c, k
      real(rk) :: stress(2, 2), rotation

      stresses = 0.0_rk
      do c = 1, mesh%n_cells
         do k = 1, 3
            call corner_stress(mesh, regions, tractions, c, k, stress, rotation)
            stresses(:, c) = stresses(:, c) + [stress(1, 1), stress(2, 2), &
                                               0.5_rk*(stress(1, 2) + stress(2, 1))]/3.0_rk
         end do
      end do
   end subroutine cell_stresses

   !> Displacement and pressure at the mesh's nodes: mean of what the cells around extrapolate.
   subroutine nodal_values(mesh, rock, regions, unknowns, tractions, values)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :), tractions(:)
      real(rk), intent(out) :: values(:, :)  !< (3, n_nodes)

      integer(ik) :: c, k, v
      real(rk) :: gradient(2, 2, 3), rotation(3), offset(2), centre(2), pressure_gradient(2)
      real(rk), allocatable :: weight(:)
      logical :: free(3)

      allocate (weight(mesh%n_nodes), source=0.0_rk)
      values = 0.0_rk
      do c = 1, mesh%n_cells
         centre = sum(mesh%xy(:, mesh%cell_nodes(:, c)), dim=2)/3.0_rk
         do k = 1, 3
            call corner_strain(mesh, rock, regions, unknowns, tractions, c, k, gradient(:, :, k), &
                               rotation(k))
            free(k) = rotation_is_free(regions, regions%region_of_node(mesh%cell_nodes(k, c)))
         end do
         do k = 1, 3
            v = mesh%cell_nodes(k, c)
            offset = mesh%xy(:, v) - centre
            ! A loaded corner of the body knows no rotation of its own: take the cell's other
            ! corners'.
            if (free(k) .and. .not. all(free)) rotation(k) = sum(rotation, mask=.not. free) &
                                                             /real(count(.not. free), rk)
            gradient(2, 1, k) = gradient(2, 1, k) + rotation(k)
            gradient(1, 2, k) = gradient(1, 2, k) - rotation(k)
            call corner_pressure_gradient(mesh, rock, regions, unknowns, c, k, pressure_gradient)
            values(1:2, v) = values(1:2, v) + unknowns(1:2, c) + matmul(gradient(:, :, k), offset)
            values(3, v) = values(3, v) + unknowns(3, c) + dot_product(pressure_gradient, offset)
            weight(v) = weight(v) + 1.0_rk
         end do
      end do
      do v = 1, mesh%n_nodes
         values(:, v) = values(:, v)/weight(v)
      end do
   end subroutine nodal_values

   !> Strain (without rotation) at a corner: eps = A (sigma + alpha p I), and the vertex' rotation.
   pure subroutine corner_strain(mesh, rock, regions, unknowns, tractions, cell, k, strain, &
                                 rotation)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :), tractions(:)
      integer(ik), intent(in) :: cell, k
      real(rk), intent(out) :: strain(2, 2), rotation

      real(rk) :: stress(2, 2), nu
      integer(ik) :: i

      call corner_stress(mesh, regions, tractions, cell, k, stress, rotation)
      do i = 1, 2
         stress(i, i) = stress(i, i) + rock%biot*unknowns(3, cell)
      end do
      nu = rock%lame/(2.0_rk*(rock%lame + rock%shear))
      strain = stress
      do i = 1, 2
         strain(i, i) = strain(i, i) - nu*(stress(1, 1) + stress(2, 2))
      end do
      strain = strain/(2.0_rk*rock%shear)
   end subroutine corner_strain

   pure subroutine corner_stress(mesh, regions, tractions, cell, k, stress, rotation)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: tractions(:)
      integer(ik), intent(in) :: cell, k
      real(rk), intent(out) :: stress(2, 2)  !< not symmetric by itself
      real(rk), intent(out) :: rotation

      integer(ik) :: at, faces(2), i, j, r
      real(rk) :: sign_out(2), length(2), lever(2, 2), area

      r = regions%region_of_node(mesh%cell_nodes(k, cell))
      call corner_geometry(mesh, cell, k, faces, sign_out, length, lever, area)
      stress = 0.0_rk
      do j = 1, 2
         call traction_face(mesh, faces(j), sign_out(j))
         at = traction_position(regions, r) + 2*(findloc(regions%faces(regions%face_first(r): &
                                               regions%face_first(r + 1) - 1), faces(j), dim=1) - 1)
         do i = 1, 2
            stress(:, i) = stress(:, i) + sign_out(j)*lever(i, j)*tractions(at:at + 1)
         end do
      end do
      rotation = tractions(traction_position(regions, r) + 2*(regions%face_first(r + 1) &
                       - regions%face_first(r)) - 1 + findloc(regions%nodes(regions%node_first(r): &
                                   regions%node_first(r + 1) - 1), mesh%cell_nodes(k, cell), dim=1))
   end subroutine corner_stress

   pure subroutine corner_pressure_gradient(mesh, rock, regions, unknowns, cell, k, gradient)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)
      integer(ik), intent(in) :: cell, k
      real(rk), intent(out) :: gradient(2)  !< [Pa/m]

      integer(ik) :: faces(2), b, j, n, nb, r, row
      real(rk) :: sign_out(2), length(2), lever(2, 2), area, flux, velocity(2)

      r = regions%region_of_node(mesh%cell_nodes(k, cell))
      n = regions%flow_first(r + 1) - regions%flow_first(r)
      nb = regions%block_first(r + 1) - regions%block_first(r)
      call corner_geometry(mesh, cell, k, faces, sign_out, length, lever, area)
      velocity = 0.0_rk
      do j = 1, 2
         row = findloc(regions%flow_faces(regions%flow_first(r):regions%flow_first(r + 1) - 1), &
                       faces(j), dim=1)
         flux = regions%flux(regions%flux_first(r) + nb*n + row - 1)
         do b = 1, nb
            flux = flux + regions%flux(regions%flux_first(r) + (b - 1)*n + row - 1) &
                   *unknowns(3, regions%blocks(regions%block_first(r) + b - 1))
         end do
         velocity = velocity + sign_out(j)*lever(:, j)*flux
      end do
      gradient = -matmul(rock%resistivity, velocity)
   end subroutine corner_pressure_gradient

   !> Whether the tractions of a region are all given, so that its rotation means nothing.
   pure function rotation_is_free(regions, r) result(is_free)
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: r
      logical :: is_free

      integer(ik) :: n

      is_free = regions%face_first(r + 1) - regions%face_first(r) == 2
      if (is_free) then
         n = 5*3*(regions%block_first(r + 1) - regions%block_first(r))
         associate (response => regions%traction(regions%traction_first(r): &
                                                 regions%traction_first(r) + n - 1))
            is_free = .not. any(abs(response) > 0.0_rk)
         end associate
      end if
   end function rotation_is_free

   !> y = R(:, :n) d + R(:, n+1), R stored by columns.
   pure subroutine respond(m, n, r, d, y)
      integer(ik), intent(in) :: m, n
      real(rk), intent(in) :: r(m, n + 1)
      real(rk), intent(in) :: d(n)
      real(rk), intent(out) :: y(m)

      y = matmul(r(:, :n), d) + r(:, n + 1)
   end subroutine respond

end module coarse_fields
