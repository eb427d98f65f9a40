!> Discretization of Biot's equations: multi-point stress stencil around one vertex, and the matrix
!! as the sum over all vertices. The flow is that of coarse_diffusion.
!!
!! Multi-point stress approximation with weakly symmetric stress (Nordbotten 2016; Keilegavlen and
!! Nordbotten 2017), in its mixed form on triangles: each face has, at each of its two ends,
!! its own traction [Pa]; around a vertex these are found from the displacements and pressures of
!! the cells there, so that the displacement is continuous at a third of each face, and that the
!! stress is symmetric in the mean over the vertex (a rotation is the multiplier). With the corners'
!! areas as weights this is a lumped mixed method (Wheeler and Yotov 2006; Ambartsumyan, Khattatov,
!! Nordbotten and Yotov 2020): the matrix is symmetric, and stable for nearly incompressible rock.
!!
!! The pressure enters the stress-strain relation itself, eps = A (sigma + alpha p I), and the fluid
!! content takes its volume change from the same tractions: these are the stabilizing terms, for
!! vanishing permeability and time steps.
!!
!! The local system (coarse_elimination) is
!!   A t + C r + G d = given displacements,  C^T t = 0
!! with tractions t, rotations r and the unknowns d (displacements, jumps, pressures) around the
!! vertex. The rotations times 2 G are the unknowns, of the size of a traction, so that pivots stay
!! comparable: G of one of the cells that share the rotation.
!!
!! Where rocks of several stiffnesses meet at a vertex each has a rotation of its own
!! (coarse_regions). With tractions given on both sides of an interface that ends on the boundary,
!! two of them can ask the same of the traction on the interface; one of them is left out then.
module coarse_stencils
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_lists, only: inverted, lists_t
   use base_plane, only: norm2
   use coarse_diffusion, only: set_flux_equations
   use coarse_elimination, only: eliminate, fix_unknown, local_system_t, new_local_system, &
                                 response_t, share_t
   use coarse_in_situ, only: in_situ_state_t
   use coarse_layout, only: at_component, bulk_count, end_block, end_of_block, &
                            fracture_cell_of_block, layer_block
   use coarse_matrix, only: matrix_t
   use coarse_regions, only: find_regions, fracture_end_region, regions_t, traction_face
   use coarse_rock, only: rock_t, solid_t
   use mesh_geometry, only: cell_area, corner_geometry, face_length, outward_normal
   use mesh_types, only: mesh_t
   use scene_sides, only: boundary_side_t
   implicit none(type, external)
   private

   public :: discretize, renew_sides

   !> Contributions of one vertex.
   type :: stencil_t
      type(share_t) :: elastic, flow
      integer(ik) :: info = 0  !< not 0: none, since cells are degenerate
   end type stencil_t

   !> Vertices whose stencils are found one after another by one thread, and those that are kept
   !! until they are added, in the order of the vertices whatever the threads do.
   integer(ik), parameter :: slice = 64, batch = 8*slice

contains

   !> Discretize Biot's equations on the mesh: responses in the regions and the global matrix.
   subroutine discretize(mesh, rock, sides, regions, matrix, error, in_situ, &
                         relief)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(boundary_side_t), intent(in) :: sides(:)
      type(regions_t), intent(out) :: regions
      type(matrix_t), intent(out) :: matrix
      type(error_t), allocatable, intent(out) :: error
      type(in_situ_state_t), intent(in), optional :: in_situ  !< beyond which the loads count
      real(rk), intent(in), optional :: relief(:)  !< (layers) of coarse_layers [Pa s]
      type(stencil_t), allocatable :: stencil(:)
      type(solid_t) :: solid
      integer(ik) :: c, first, i, k, n

      call find_regions(mesh, regions, rock%stiffness)
      call find_pattern(mesh, regions, matrix)
      allocate (stencil(min(batch, regions%n_regions)))
      do first = 1, regions%n_regions, batch
         n = min(batch, regions%n_regions - first + 1)
         !$omp parallel do
         do k = 1, n, slice
            call find_stencils(mesh, rock, sides, regions, first + k - 1, &
                               stencil(k:min(k + slice - 1, n)), in_situ, relief)
         end do
         !$omp end parallel do
         do i = 1, n
            if (stencil(i)%info /= 0) then
               call refuse_place(mesh%xy(:, regions%nodes%at(first + i - 1, 1_ik)), error)
               return
            end if
            call add_region(regions, first + i - 1, stencil(i), matrix)
            call add_known(regions, first + i - 1, stencil(i), matrix)
         end do
      end do
      do c = 1, mesh%n_cells
         solid = rock%solid_at(c)
         matrix%storage(c) = cell_area(mesh, c)*solid%storage_at_stress()
         associate (diagonal => matrix%columns%last(c))
            matrix%elastic(3, 3, diagonal) = matrix%elastic(3, 3, diagonal) - matrix%storage(c)
         end associate
      end do
   end subroutine discretize

   !> Update the values of the boundary conditions in the right-hand side; their kinds remain.
   subroutine renew_sides(mesh, rock, sides, regions, matrix, error, in_situ, &
                          relief)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(boundary_side_t), intent(in) :: sides(:)
      type(regions_t), intent(inout) :: regions
      type(matrix_t), intent(inout) :: matrix
      type(error_t), allocatable, intent(out) :: error
      type(in_situ_state_t), intent(in), optional :: in_situ  !< beyond which the loads count
      real(rk), intent(in), optional :: relief(:)  !< (layers) of coarse_layers [Pa s]
      type(stencil_t) :: stencil(1)
      integer(ik) :: r

      matrix%elastic_known = 0.0_rk
      matrix%flow_known = 0.0_rk
      if (allocated(matrix%layer_known)) matrix%layer_known = 0.0_rk
      do r = 1, regions%n_regions
         associate (faces => regions%faces)
            if (.not. any(mesh%face_side(faces%item(faces%first(r):faces%last(r))) > 0)) cycle
         end associate
         call find_stencils(mesh, rock, sides, regions, r, stencil, in_situ, relief)
         if (stencil(1)%info /= 0) then
            call refuse_place(mesh%xy(:, regions%nodes%at(r, 1_ik)), error)
            return
         end if
         call add_known(regions, r, stencil(1), matrix)
      end do
   end subroutine renew_sides

   !> Stress and flow around vertices that follow each other.
   subroutine find_stencils(mesh, rock, sides, regions, first, stencil, in_situ, relief)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(boundary_side_t), intent(in) :: sides(:)
      type(regions_t), intent(inout) :: regions
      integer(ik), intent(in) :: first  !< region
      type(stencil_t), intent(out) :: stencil(:)
      type(in_situ_state_t), intent(in), optional :: in_situ
      real(rk), intent(in), optional :: relief(:)  !< (layers) [Pa s]
      type(local_system_t) :: local
      real(rk), allocatable :: doubled(:)
      real(rk) :: given(size(sides))  ! [Pa] or [m/s]
      integer(ik) :: i

      given = merge(sides%pressure, -sides%inflow, sides%pressure_given)
      do i = 1, size(stencil, kind=ik)
         associate (r => first + i - 1, elastic => stencil(i)%elastic, flow => stencil(i)%flow, &
                    info => stencil(i)%info)
            call set_stress_equations(mesh, rock, sides, regions, r, local, doubled, in_situ)
            call eliminate(local, regions%traction(r), elastic, info)
            if (info /= 0) cycle
            call divide_rotations(doubled, regions%traction(r))
            call set_flux_equations(mesh, rock%resistivity, sides%pressure_given, given, regions, &
                                    r, local, relief)
            call eliminate(local, regions%flux(r), flow, info)
         end associate
      end do
   end subroutine find_stencils

   !> Raise an error for degenerate cells around a node.
   subroutine refuse_place(xy, error)
      real(rk), intent(in) :: xy(2)  !< [m]
      type(error_t), allocatable, intent(out) :: error
      character(len=80) :: place

      write (place, "(a,es12.5,a,es12.5,a)") "(", xy(1), ",", xy(2), ")"
      call raise_error(error, "coarse_stencils", "degenerate cells around the mesh node at "//place)
   end subroutine refuse_place

   !> Find the pattern of the matrix: blocks that share a region.
   subroutine find_pattern(mesh, regions, matrix)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      type(matrix_t), intent(inout) :: matrix
      integer(ik), allocatable :: last_row(:), found(:)
      integer(ik) :: block, i, k, n, r, side
      type(lists_t) :: coupled  ! blocks that layers couple

      matrix%n_blocks = regions%n_blocks
      matrix%n_cells = bulk_count(mesh)
      if (mesh%n_layers > 0) coupled = blocks_coupled(mesh, regions)
      allocate (matrix%columns%first(matrix%n_blocks + 1))
      allocate (last_row(matrix%n_blocks), source=0_ik)
      allocate (found(20*matrix%n_blocks))
      n = 0
      do i = 1, matrix%n_blocks
         matrix%columns%first(i) = n + 1
         last_row(i) = i
         do side = 1, 3
            r = regions%regions_of_block(side, i)
            if (r == 0) cycle
            do k = regions%blocks%first(r), regions%blocks%last(r)
               block = regions%blocks%item(k)
               if (block > i) cycle
               if (last_row(block) == i) cycle
               last_row(block) = i
               n = n + 1
               if (n + 1 > size(found)) found = [found, found]
               found(n) = block
            end do
         end do
         if (mesh%n_layers > 0) then
            do k = coupled%first(i), coupled%last(i)
               block = coupled%item(k)
               if (last_row(block) == i) cycle
               last_row(block) = i
               n = n + 1
               if (n + 1 > size(found)) found = [found, found]
               found(n) = block
            end do
         end if
         n = n + 1
         found(n) = i
      end do
      matrix%columns%first(matrix%n_blocks + 1) = n + 1
      matrix%columns%item = found(:n)
      if (mesh%n_layers > 0) call number_layer_entries(mesh, coupled, matrix)
      allocate (matrix%elastic(3, 3, n), matrix%flow(n), source=0.0_rk)
      allocate (matrix%elastic_known(3, matrix%n_blocks), source=0.0_rk)
      allocate (matrix%flow_known(matrix%n_blocks), matrix%storage(mesh%n_cells), source=0.0_rk)
   end subroutine find_pattern

   !> Blocks of smaller number, or the same, that layers couple with each block: those of one cell
   !! and its layers, and those that share a stencil of flow.
   function blocks_coupled(mesh, regions) result(coupled)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      type(lists_t) :: coupled
      integer(ik), allocatable :: pair(:, :), block(:)
      integer(ik) :: c, k, l, n, r

      allocate (pair(2, 1000))
      n = 0
      do r = 1, regions%n_regions
         block = (regions%scalars%of(r) + 2)/3
         if (.not. any(block > mesh%n_cells .and. block <= bulk_count(mesh))) cycle
         call add_pairs(block)
      end do
      do c = 1, mesh%n_cells
         if (mesh%cell_layer(c) == 0) cycle
         block = [c]
         do k = 1, 3
            associate (f => mesh%cell_faces(k, c))
               l = mesh%face_layer(f)
               if (l == 0) cycle
               block = [block, layer_block(mesh, l)]
               associate (cell => mesh%face_fracture_cell(f))
                  if (cell == 0) cycle
                  block = [block, end_block(mesh, cell, findloc(mesh%fracture%cell_faces(:, cell), &
                                                                f, dim=1, kind=ik))]
               end associate
            end associate
         end do
         call add_pairs(block)
      end do
      coupled = inverted(pair(1:1, :n), regions%n_blocks)
      coupled%item = pair(2, coupled%item)

   contains

      !> Add all pairs of some blocks.
      subroutine add_pairs(blocks)
         integer(ik), intent(in) :: blocks(:)
         integer(ik) :: a, b

         do a = 1, size(blocks, kind=ik)
            do b = 1, size(blocks, kind=ik)
               if (blocks(b) > blocks(a)) cycle
               if (n == size(pair, 2)) call enlarge()
               n = n + 1
               pair(:, n) = [blocks(a), blocks(b)]
            end do
         end do
      end subroutine add_pairs

      subroutine enlarge()
         integer(ik), allocatable :: larger(:, :)

         allocate (larger(2, 2*n))
         larger(:, :n) = pair(:, :n)
         call move_alloc(larger, pair)
      end subroutine enlarge

   end function blocks_coupled

   !> Number the entries that layers add to.
   subroutine number_layer_entries(mesh, coupled, matrix)
      type(mesh_t), intent(in) :: mesh
      type(lists_t), intent(in) :: coupled
      type(matrix_t), intent(inout) :: matrix
      integer(ik) :: entry, i, k, n

      allocate (matrix%of_layers(size(matrix%columns%item)), source=0_ik)
      n = 0
      do i = 1, matrix%n_blocks
         do k = coupled%first(i), coupled%last(i)
            entry = matrix%entry_at(i, coupled%item(k))
            if (matrix%of_layers(entry) > 0) cycle
            n = n + 1
            matrix%of_layers(entry) = n
         end do
      end do
      allocate (matrix%layer_flow(3, 3, n), matrix%layer_terms(3, 3, n), source=0.0_rk)
      allocate (matrix%layer_known(2, mesh%n_layers), source=0.0_rk)
   end subroutine number_layer_entries

   !> Add the contributions of one region to the matrix.
   pure subroutine add_region(regions, region, stencil, matrix)
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(stencil_t), intent(in) :: stencil
      type(matrix_t), intent(inout) :: matrix
      integer(ik) :: a, at_a, at_b, b, col, entry, i, j, row

      do a = 1, regions%blocks%length(region)
         row = regions%blocks%at(region, a)
         at_a = at_component(a, 1) - 1
         do b = 1, regions%blocks%length(region)
            col = regions%blocks%at(region, b)
            if (col > row) cycle
            at_b = at_component(b, 1) - 1
            entry = matrix%entry_at(row, col)
            do j = 1, 3
               do i = 1, 3
                  matrix%elastic(i, j, entry) = matrix%elastic(i, j, entry) &
                                                + stencil%elastic%matrix(at_a + i, at_b + j)
               end do
            end do
            if (.not. allocated(regions%scalars)) then
               matrix%flow(entry) = matrix%flow(entry) + stencil%flow%matrix(a, b)
            end if
         end do
      end do
      if (allocated(regions%scalars)) call add_layered_flow(regions, region, stencil, matrix)
   end subroutine add_region

   !> The flow where there are layers.
   pure subroutine add_layered_flow(regions, region, stencil, matrix)
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(stencil_t), intent(in) :: stencil
      type(matrix_t), intent(inout) :: matrix
      integer(ik) :: a, b, entry, i, j
      integer(ik) :: col(2), row(2)
      real(rk) :: sign_col(2), sign_row(2)

      do b = 1, regions%scalars%length(region)
         call unknowns_of(regions%scalars%at(region, b), col, sign_col)
         do a = 1, regions%scalars%length(region)
            call unknowns_of(regions%scalars%at(region, a), row, sign_row)
            if ((col(1) + 2)/3 > (row(1) + 2)/3) cycle
            entry = matrix%entry_at((row(1) + 2)/3, (col(1) + 2)/3)
            if (matrix%of_layers(entry) > 0) then
               do j = 1, count(col > 0)
                  do i = 1, count(row > 0)
                     call matrix%add_layer_flow(row(i), col(j), sign_row(i)*sign_col(j) &
                                                *stencil%flow%matrix(a, b))
                  end do
               end do
            else
               matrix%flow(entry) = matrix%flow(entry) + stencil%flow%matrix(a, b)
            end if
         end do
      end do
   end subroutine add_layered_flow

   !> The unknowns that add up to a scalar of the stencils of flow, with their signs.
   pure subroutine unknowns_of(scalar, number, sign)
      integer(ik), intent(in) :: scalar  !< of regions%scalars
      integer(ik), intent(out) :: number(2)  !< the second is 0 for a single one
      real(rk), intent(out) :: sign(2)

      number = [scalar, 0_ik]
      sign = 1.0_rk
      if (modulo(scalar, 3_ik) == 0) return
      ! At an end of a layer's face
      number = 3*((scalar + 2)/3) - [2_ik, 1_ik]
      if (modulo(scalar, 3_ik) == 2) sign(2) = -1.0_rk
   end subroutine unknowns_of

   !> Add the contributions of the boundary data of one region to the right-hand side.
   pure subroutine add_known(regions, region, stencil, matrix)
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(stencil_t), intent(in) :: stencil
      type(matrix_t), intent(inout) :: matrix
      integer(ik) :: a, at, row

      do a = 1, regions%blocks%length(region)
         at = at_component(a, 1)
         row = regions%blocks%at(region, a)
         matrix%elastic_known(:, row) = matrix%elastic_known(:, row) &
                                        + stencil%elastic%known(at:at + 2)
         if (.not. allocated(regions%scalars)) then
            matrix%flow_known(row) = matrix%flow_known(row) + stencil%flow%known(a)
         end if
      end do
      if (.not. allocated(regions%scalars)) return
      do a = 1, regions%scalars%length(region)
         at = regions%scalars%at(region, a)
         row = (at + 2)/3
         if (modulo(at, 3_ik) == 0) then
            matrix%flow_known(row) = matrix%flow_known(row) + stencil%flow%known(a)
         else
            associate (known => matrix%layer_known(:, row - matrix%n_cells &
                                                   + size(matrix%layer_known, 2, kind=ik)))
               known = known + [1, 3 - 2*(at - 3*row + 3)]*stencil%flow%known(a)
            end associate
         end if
      end do
   end subroutine add_known

   !> The equations of the tractions and the rotations of one region.
   pure subroutine set_stress_equations(mesh, rock, sides, regions, region, local, doubled, in_situ)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(boundary_side_t), intent(in) :: sides(:)
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(local_system_t), intent(inout) :: local
      real(rk), allocatable, intent(out) :: doubled(:)  !< factor of each rotation
      type(in_situ_state_t), intent(in), optional :: in_situ  !< beyond which the loads count
      integer(ik) :: m, n, n_tractions

      allocate (doubled(regions%nodes%length(region)))
      n_tractions = 2*regions%faces%length(region)
      n = n_tractions + regions%nodes%length(region)
      m = 3*regions%blocks%length(region)
      call new_local_system(n, m, local)
      call add_corners(mesh, rock, regions, region, local, doubled)
      call add_jumps(mesh, regions, region, local)
      local%equations(n + 1:n + m, :n) = -local%coupling(:m, :n)
      call apply_sides(mesh, sides, regions, region, local, in_situ)
      if (regions%has_interface(region)) call leave_out_repeated(n_tractions, local)
   end subroutine set_stress_equations

   !> Divide the rotations in the response of one region by their factors.
   pure subroutine divide_rotations(doubled, response)
      real(rk), intent(in) :: doubled(:)
      type(response_t), intent(inout) :: response  !< tractions x, y [Pa], then rotations [-]
      integer(ik) :: k, n_tractions

      n_tractions = size(response%matrix, 2, kind=ik) - size(doubled, kind=ik)
      do k = 1, size(doubled, kind=ik)
         associate (rotation => response%matrix(:, n_tractions + k))
            rotation = rotation/doubled(k)
         end associate
      end do
   end subroutine divide_rotations

   !> Contributions of the corners of cells around the vertex.
   pure subroutine add_corners(mesh, rock, regions, region, local, doubled)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(local_system_t), intent(inout) :: local
      real(rk), intent(out) :: doubled(:)  !< 2 G of each rotation [Pa]
      integer(ik) :: at(2), c, cell, faces(2), first, i, j, k, rotation
      real(rk) :: sign_out(2), length(2), lever(2, 2), area, w
      type(solid_t) :: solid

      first = 2*regions%faces%length(region)
      doubled = 0.0_rk
      do c = 1, regions%cell_count(region)
         cell = regions%blocks%at(region, c)
         k = findloc(regions%regions_of_block(:, cell), region, dim=1)
         solid = rock%solid_at(cell)
         rotation = first + regions%nodes%place(region, regions%rotation_of_corner(k, cell))
         if (.not. doubled(rotation - first) > 0.0_rk) then
            doubled(rotation - first) = 2.0_rk*solid%shear
         end if
         call corner_geometry(mesh, cell, k, faces, sign_out, length, lever, area)
         do j = 1, 2
            call traction_face(mesh, faces(j), sign_out(j))
            at(j) = 2*regions%faces%place(region, faces(j)) - 1
         end do
         do j = 1, 2
            do i = 1, 2
               w = area/3.0_rk*sign_out(i)*sign_out(j)/(2.0_rk*solid%shear)
               call add_compliance(local%equations, at(i), at(j), w, solid%poisson(), lever(:, i), &
                                   lever(:, j))
            end do
            w = sign_out(j)*area/(3.0_rk*doubled(rotation - first))
            call add_symmetric(local%equations, at(j), rotation, -w*lever(2, j))
            call add_symmetric(local%equations, at(j) + 1, rotation, w*lever(1, j))
            w = sign_out(j)*area/3.0_rk
            local%coupling(at_component(c, 1), at(j)) = 0.5_rk*sign_out(j)*length(j)
            local%coupling(at_component(c, 2), at(j) + 1) = 0.5_rk*sign_out(j)*length(j)
            local%coupling(at_component(c, 3), at(j):at(j) + 1) = &
               w*lever(:, j)*solid%biot/(2.0_rk*(solid%lame + solid%shear))
         end do
      end do
   end subroutine add_corners

   !> Fix rotations whose equations, in the unknown tractions, depend linearly on those of previous
   !! rotations.
   pure subroutine leave_out_repeated(n_tractions, local)
      integer(ik), intent(in) :: n_tractions
      type(local_system_t), intent(inout) :: local
      real(rk), parameter :: nothing = 1.0e-10_rk  !< what is left of a repeated row
      real(rk) :: rows(n_tractions, local%n - n_tractions), left(n_tractions)
      real(rk) :: whole
      integer(ik) :: i, k

      do k = 1, size(rows, 2, kind=ik)
         left = local%equations(:n_tractions, n_tractions + k)
         whole = norm2(left)
         rows(:, k) = 0.0_rk
         if (.not. whole > 0.0_rk) cycle
         do i = 1, k - 1
            left = left - dot_product(rows(:, i), left)*rows(:, i)
         end do
         if (norm2(left) > nothing*whole) then
            rows(:, k) = left/norm2(left)
         else
            call fix_unknown(local, n_tractions + k, 0.0_rk)
         end if
      end do
   end subroutine leave_out_repeated

   !> Jumps of the fracture cells, which are unknowns: each end's acts in the region where it lies.
   pure subroutine add_jumps(mesh, regions, region, local)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(local_system_t), intent(inout) :: local
      integer(ik) :: at, b, block, cell, f
      real(rk) :: half_length

      do b = regions%cell_count(region) + 1, regions%blocks%length(region)
         block = regions%blocks%at(region, b)
         cell = fracture_cell_of_block(mesh, block)
         if (fracture_end_region(mesh, regions, cell, end_of_block(mesh, block)) /= region) cycle
         f = mesh%fracture%cell_faces(1, cell)
         half_length = 0.5_rk*face_length(mesh, f)
         at = 2*regions%faces%place(region, f) - 1
         local%coupling(at_component(b, 1), at) = half_length
         local%coupling(at_component(b, 2), at + 1) = half_length
      end do
   end subroutine add_jumps

   !> A t_j (x) m_j : t_i (x) m_i for unit tractions, A the isotropic compliance.
   pure subroutine add_compliance(matrix, row, col, factor, nu, lever_i, lever_j)
      real(rk), intent(inout) :: matrix(:, :)  !< [m2/Pa]
      integer(ik), intent(in) :: row, col  !< of the x components
      real(rk), intent(in) :: factor  !< weight/(2G) [m2/Pa]
      real(rk), intent(in) :: nu  !< lambda/(2(lambda+G)) [-]
      real(rk), intent(in) :: lever_i(2), lever_j(2)  !< m_i, m_j [-]
      integer(ik) :: a, b

      do b = 1, 2
         do a = 1, 2
            matrix(row + a - 1, col + b - 1) = matrix(row + a - 1, col + b - 1) &
                                               - factor*nu*lever_i(a)*lever_j(b)
         end do
         matrix(row + b - 1, col + b - 1) = matrix(row + b - 1, col + b - 1) &
                                            + factor*dot_product(lever_i, lever_j)
      end do
   end subroutine add_compliance

   pure subroutine add_symmetric(matrix, row, col, value)
      real(rk), intent(inout) :: matrix(:, :)  !< [m2/Pa]
      integer(ik), intent(in) :: row, col
      real(rk), intent(in) :: value  !< [m2/Pa]

      matrix(row, col) = matrix(row, col) + value
      matrix(col, row) = matrix(col, row) + value
   end subroutine add_symmetric

   !> Outer boundary: each component has a prescribed displacement, a prescribed traction, or a
   !! spring.
   pure subroutine apply_sides(mesh, sides, regions, region, local, in_situ)
      type(mesh_t), intent(in) :: mesh
      type(boundary_side_t), intent(in) :: sides(:)
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(local_system_t), intent(inout) :: local
      type(in_situ_state_t), intent(in), optional :: in_situ
      real(rk) :: traction(2)
      integer(ik) :: axis, f, j, last, n

      last = local%last()
      do j = 1, regions%faces%length(region)
         f = regions%faces%at(region, j)
         if (mesh%face_side(f) == 0) cycle
         associate (side => sides(mesh%face_side(f)), half_length => 0.5_rk*face_length(mesh, f), &
                    outward => outward_normal(mesh, f))
            traction = side%traction + side%normal_traction*outward &
                       + side%shear_traction*[-outward(2), outward(1)]
            if (present(in_situ)) then
               traction = in_situ%side_traction(traction, outward, &
                                                mesh%xy(2, regions%nodes%at(region, 1_ik)))
            end if
            do axis = 1, 2
               n = 2*(j - 1) + axis
               if (side%displacement_given(axis)) then
                  local%equations(last, n) = local%equations(last, n) &
                                             + half_length*side%displacement(axis)
               else if (side%spring(axis) > 0.0_rk) then
                  ! The side moves by what the traction lacks of the given one, over the spring.
                  associate (give => half_length/side%spring(axis))
                     local%equations(n, n) = local%equations(n, n) + give
                     local%equations(last, n) = local%equations(last, n) + give*traction(axis)
                  end associate
               else
                  call fix_unknown(local, n, traction(axis))
               end if
            end do
         end associate
      end do
      ! Where all tractions are given, as in a loaded corner, the rotation is free and without
      ! effect.
      do n = 2*regions%faces%length(region) + 1, local%n
         if (.not. any(abs(local%equations(:local%n, n)) > 0.0_rk)) local%equations(n, n) = 1.0_rk
      end do
   end subroutine apply_sides

end module coarse_stencils
