!> Multi-point stress and flux stencils around one vertex.
!!
!! Multi-point stress and flux approximation with weakly symmetric stress (Nordbotten 2016;
!! Keilegavlen and Nordbotten 2017), in its mixed form on triangles: each face has, at each of its
!! two ends, a traction [Pa] and a normal flux [m/s] of its own; around a vertex these are found
!! from the displacements and pressures of the cells there, so that displacement and pressure are
!! continuous at a third of each face, and that the stress is symmetric in the mean over the vertex
!! (a rotation is the multiplier). With the corners' areas as weights this is a lumped mixed method
!! (Wheeler and Yotov 2006; Ambartsumyan, Khattatov, Nordbotten and Yotov 2020): the matrix is
!! symmetric, and stable for nearly incompressible rock and for vanishing permeability and time
!! steps.
!!
!! The pressure enters the stress-strain relation itself, eps = A (sigma + alpha p I), and the fluid
!! content takes its volume change from the same tractions: these are the stabilizing terms.
module coarse_stencil
   use base_kinds, only: ik, rk
   use algebra_lapack, only: dgesv
   use coarse_regions, only: corner_geometry, face_length, fracture_end_region, regions_t, &
                             traction_face
   use coarse_rock, only: rock_t
   use mesh_types, only: mesh_t
   use scene_types, only: boundary_side_t
   implicit none(type, external)
   private

   public :: region_matrix_t, solve_region

   !> Contribution of one region to the global matrix and right-hand side.
   type :: region_matrix_t
      !> (3 n_blocks, 3 n_blocks) independent of the time step
      real(rk), allocatable :: elastic(:, :)
      !> (n_blocks, n_blocks) to be multiplied by it; pressures only
      real(rk), allocatable :: flow(:, :)
      real(rk), allocatable :: elastic_known(:)  !< (3 n_blocks) from boundary data
      real(rk), allocatable :: flow_known(:)  !< (n_blocks) from boundary data
   end type region_matrix_t

   !> The local systems of one region,
   !!   A t + C r + G d = given displacements,  C^T t = 0      (tractions t, rotations r, unknowns
   !!   d)
   !!   B q = H p - given pressures                            (fluxes q).
   type :: local_t
      integer(ik) :: n_faces, n_flow, n_nodes, n_blocks
      real(rk), allocatable :: matrix(:, :)  !< [A C; C^T 0]
      real(rk), allocatable :: coupling(:, :)  !< G
      real(rk), allocatable :: response(:, :)  !< right-hand sides, then solutions: 3 n_blocks + 1
      real(rk), allocatable :: flow(:, :)  !< B
      real(rk), allocatable :: flow_coupling(:, :)  !< H
      real(rk), allocatable :: flow_response(:, :)
   end type local_t

contains

   !> Eliminate the tractions, the rotations and the fluxes of one region.
   !!
   !! `info` is 0, or the local system could not be solved (degenerate cells).
   subroutine solve_region(mesh, rock, sides, region, regions, matrix, info)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(boundary_side_t), intent(in) :: sides(:)
      integer(ik), intent(in) :: region
      type(regions_t), intent(inout) :: regions  !< its response arrays are filled for this region
      type(region_matrix_t), intent(out) :: matrix
      integer(ik), intent(out) :: info

      type(local_t) :: local
      integer(ik), allocatable :: pivots(:)
      integer(ik) :: n, nb

      local%n_faces = regions%face_first(region + 1) - regions%face_first(region)
      local%n_flow = regions%flow_first(region + 1) - regions%flow_first(region)
      local%n_nodes = regions%node_first(region + 1) - regions%node_first(region)
      local%n_blocks = regions%block_first(region + 1) - regions%block_first(region)
      nb = local%n_blocks
      n = 2*local%n_faces + local%n_nodes
      allocate (local%matrix(n, n), local%coupling(n, 3*nb), source=0.0_rk)
      allocate (local%response(n, 3*nb + 1), source=0.0_rk)
      allocate (local%flow(local%n_flow, local%n_flow), local%flow_coupling(local%n_flow, nb), &
                source=0.0_rk)
      allocate (local%flow_response(local%n_flow, nb + 1), source=0.0_rk)
      call add_corners(mesh, rock, region, regions, local)
      call add_fracture_faces(mesh, region, regions, local)
      local%response(:, :3*nb) = -local%coupling
      local%flow_response(:, :nb) = local%flow_coupling
      call apply_sides(mesh, sides, region, regions, local)

      allocate (pivots(max(n, local%n_flow)))
      call dgesv(n, 3*nb + 1, local%matrix, n, pivots, local%response, n, info)
      if (info /= 0) return
      associate (rotations => local%response(2*local%n_faces + 1:, :))
         rotations = rotations/(2.0_rk*rock%shear)
      end associate
      call dgesv(local%n_flow, nb + 1, local%flow, local%n_flow, pivots, local%flow_response, &
                 local%n_flow, info)
      if (info /= 0) return
      matrix%elastic = -matmul(transpose(local%coupling), local%response(:, :3*nb))
      matrix%elastic_known = matmul(local%response(:, 3*nb + 1), local%coupling)
      matrix%flow = -matmul(transpose(local%flow_coupling), local%flow_response(:, :nb))
      matrix%flow_known = matmul(local%flow_response(:, nb + 1), local%flow_coupling)
      regions%traction(regions%traction_first(region):regions%traction_first(region + 1) - 1) = &
         reshape(local%response, [size(local%response)])
      regions%flux(regions%flux_first(region):regions%flux_first(region + 1) - 1) = &
         reshape(local%flow_response, [size(local%flow_response)])
   end subroutine solve_region

   !> What the cells' corners around the vertex give.
   subroutine add_corners(mesh, rock, region, regions, local)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      integer(ik), intent(in) :: region
      type(regions_t), intent(in) :: regions
      type(local_t), intent(inout) :: local

      integer(ik) :: at(2), c, cell, faces(2), flow_at(2), i, j, k, rotation
      real(rk) :: sign_out(2), sign_flow(2), length(2), lever(2, 2), area, nu, w

      nu = rock%lame/(2.0_rk*(rock%lame + rock%shear))
      do c = 1, regions%cell_count(region)
         cell = regions%blocks(regions%block_first(region) + c - 1)
         do k = 1, 3
            if (regions%region_of_node(mesh%cell_nodes(k, cell)) == region) exit
         end do
         rotation = 2*local%n_faces + findloc(regions%nodes(regions%node_first(region): &
                               regions%node_first(region + 1) - 1), mesh%cell_nodes(k, cell), dim=1)
         call corner_geometry(mesh, cell, k, faces, sign_flow, length, lever, area)
         sign_out = sign_flow
         do j = 1, 2
            flow_at(j) = findloc(regions%flow_faces(regions%flow_first(region): &
                                               regions%flow_first(region + 1) - 1), faces(j), dim=1)
            call traction_face(mesh, faces(j), sign_out(j))
            at(j) = findloc(regions%faces(regions%face_first(region): &
                                          regions%face_first(region + 1) - 1), faces(j), dim=1)
         end do
         do j = 1, 2
            do i = 1, 2
               w = area/3.0_rk
               call add_compliance(local%matrix, 2*at(i) - 1, 2*at(j) - 1, &
                        w*sign_out(i)*sign_out(j)/(2.0_rk*rock%shear), nu, lever(:, i), lever(:, j))
               local%flow(flow_at(i), flow_at(j)) = local%flow(flow_at(i), flow_at(j)) &
                                            + w*sign_flow(i)*sign_flow(j)*dot_product(lever(:, i), &
                                                              matmul(rock%resistivity, lever(:, j)))
            end do
            ! The rotation times 2G is the unknown, of the size of a traction: pivots stay
            ! comparable.
            w = sign_out(j)*area/(6.0_rk*rock%shear)
            call add_symmetric(local%matrix, 2*at(j) - 1, rotation, -w*lever(2, j))
            call add_symmetric(local%matrix, 2*at(j), rotation, w*lever(1, j))
            w = sign_out(j)*area/3.0_rk
            local%coupling(2*at(j) - 1, 3*c - 2) = 0.5_rk*sign_out(j)*length(j)
            local%coupling(2*at(j), 3*c - 1) = 0.5_rk*sign_out(j)*length(j)
            local%coupling(2*at(j) - 1:2*at(j), 3*c) = w*lever(:, j)*rock%biot &
                                                       /(2.0_rk*(rock%lame + rock%shear))
            local%flow_coupling(flow_at(j), c) = 0.5_rk*sign_flow(j)*length(j)
         end do
      end do
   end subroutine add_corners

   !> Jumps and pressures of the fracture faces, which are unknowns.
   subroutine add_fracture_faces(mesh, region, regions, local)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: region
      type(regions_t), intent(in) :: regions
      type(local_t), intent(inout) :: local

      integer(ik) :: at, b, cell, end, f
      real(rk) :: half_length

      do b = regions%cell_count(region) + 1, local%n_blocks
         cell = (regions%blocks(regions%block_first(region) + b - 1) - mesh%n_cells + 1)/2
         end = 2 - mod(regions%blocks(regions%block_first(region) + b - 1) - mesh%n_cells, 2_ik)
         f = mesh%fracture%cell_faces(1, cell)
         half_length = 0.5_rk*face_length(mesh, f)
         if (fracture_end_region(mesh, regions, cell, end) == region) then
            at = findloc(regions%faces(regions%face_first(region): &
                                       regions%face_first(region + 1) - 1), f, dim=1)
            local%coupling(2*at - 1, 3*b - 2) = half_length
            local%coupling(2*at, 3*b - 1) = half_length
         end if
         at = findloc(regions%flow_faces(regions%flow_first(region): &
                    regions%flow_first(region + 1) - 1), mesh%fracture%cell_faces(end, cell), dim=1)
         local%flow_coupling(at, b) = -half_length
      end do
   end subroutine add_fracture_faces

   !> A t_j (x) m_j : t_i (x) m_i for unit tractions, A the isotropic compliance.
   pure subroutine add_compliance(matrix, row, col, factor, nu, lever_i, lever_j)
      real(rk), intent(inout) :: matrix(:, :)
      integer(ik), intent(in) :: row, col
      real(rk), intent(in) :: factor  !< weight/(2G) [m2/Pa]
      real(rk), intent(in) :: nu  !< lambda/(2(lambda+G))
      real(rk), intent(in) :: lever_i(2), lever_j(2)

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
      real(rk), intent(inout) :: matrix(:, :)
      integer(ik), intent(in) :: row, col
      real(rk), intent(in) :: value

      matrix(row, col) = matrix(row, col) + value
      matrix(col, row) = matrix(col, row) + value
   end subroutine add_symmetric

   !> Outer boundary: a component is either displaced as given or loaded as given; likewise the
   !! fluid.
   subroutine apply_sides(mesh, sides, region, regions, local)
      type(mesh_t), intent(in) :: mesh
      type(boundary_side_t), intent(in) :: sides(:)
      integer(ik), intent(in) :: region
      type(regions_t), intent(in) :: regions
      type(local_t), intent(inout) :: local

      integer(ik) :: axis, f, j, last, n
      real(rk) :: half_length

      last = size(local%response, 2)
      do j = 1, local%n_faces
         f = regions%faces(regions%face_first(region) + j - 1)
         if (mesh%face_side(f) == 0) cycle
         half_length = 0.5_rk*face_length(mesh, f)
         associate (side => sides(mesh%face_side(f)))
            do axis = 1, 2
               n = 2*(j - 1) + axis
               if (side%displacement_given(axis)) then
                  local%response(n, last) = local%response(n, last) &
                                            + half_length*side%displacement(axis)
               else
                  local%response(:, last) = local%response(:, last) - local%matrix(:, n) &
                                            *side%traction(axis)
                  call fix_row(local%matrix, local%response, n, side%traction(axis))
               end if
            end do
         end associate
      end do
      ! Where all tractions are given, as in a loaded corner, the rotation is free and without
      ! effect.
      do n = 2*local%n_faces + 1, size(local%matrix, 1)
         if (.not. any(abs(local%matrix(n, :)) > 0.0_rk)) local%matrix(n, n) = 1.0_rk
      end do

      last = size(local%flow_response, 2)
      do j = 1, local%n_flow
         f = regions%flow_faces(regions%flow_first(region) + j - 1)
         if (mesh%face_side(f) == 0) cycle
         associate (side => sides(mesh%face_side(f)))
            if (side%pressure_given) then
               local%flow_response(j, last) = local%flow_response(j, last) &
                                              - 0.5_rk*face_length(mesh, f)*side%pressure
            else
               call fix_row(local%flow, local%flow_response, j, 0.0_rk)
            end if
         end associate
      end do
   end subroutine apply_sides

   !> Replace one equation by: unknown = value.
   pure subroutine fix_row(matrix, response, n, value)
      real(rk), intent(inout) :: matrix(:, :), response(:, :)
      integer(ik), intent(in) :: n
      real(rk), intent(in) :: value

      matrix(:, n) = 0.0_rk
      matrix(n, :) = 0.0_rk
      matrix(n, n) = 1.0_rk
      response(n, :) = 0.0_rk
      response(n, size(response, 2)) = value
   end subroutine fix_row

end module coarse_stencil
