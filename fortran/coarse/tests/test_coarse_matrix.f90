!> The coarse matrix on cells of irregular shape: exact for uniform stress and for linear pressure,
!! the same as the tractions and fluxes that it stands for, symmetric and quasi-definite.
program test_coarse_matrix
   use algebra_lapack, only: dpotrf
   use base_kinds, only: ik, rk
   use coarse_diffusion, only: cell_outflow
   use coarse_fields, only: cell_contents, corner_tractions
   use coarse_matrix, only: matrix_t
   use coarse_regions, only: regions_t, traction_face
   use coarse_rock, only: rock_t
   use mesh_geometry, only: cell_area, corner_geometry
   use mesh_types, only: mesh_t
   use sample_bodies, only: action, dense_matrix, hold, linear_unknowns, load_sides, mesh_square, &
                            porous_body, prepare, scattered, shake, straight_network
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: nothing(2, 2) = 0.0_rk
   !> One fracture inside, one with an end on the boundary.
   real(rk), parameter :: lines(2, 2, 2) = reshape([0.5_rk, 0.7_rk, 1.4_rk, 1.2_rk, &
                                                    0.0_rk, 1.5_rk, 0.8_rk, 1.5_rk], [2, 2, 2])
   type(checks_t) :: checks
   type(scene_t) :: scene
   type(mesh_t) :: mesh
   integer(ik) :: cell

   call mesh_square(checks, straight_network(lines), 0.25_rk, 0.4_rk, mesh)
   call shake(mesh)
   call checks%is_true(all([(cell_area(mesh, cell), cell=1, mesh%n_cells)] > 0.0_rk), "cells")
   call test_uniform_strain(.false.)
   call test_uniform_strain(.true.)
   call test_rigid_motion()
   call test_clamped_pressure()
   call test_linear_pressure()
   call test_closed_sides()
   call test_tractions_behind_matrix()
   call test_fluxes_behind_matrix()
   call test_quasi_definite(0.2_rk)
   call test_quasi_definite(0.49999_rk)
   call checks%finish()

contains

   !> Force through half a fracture face, negated: -l/2 sigma n.
   subroutine check_fracture_rows(rows, stress, name)
      real(rk), intent(in) :: rows(:, :), stress(2, 2)
      character(len=*), intent(in) :: name
      real(rk) :: tangent(2), worst
      integer(ik) :: end, i

      worst = 0.0_rk
      do i = 1, mesh%fracture%n_cells
         associate (points => mesh%fracture%point_xy(:, mesh%fracture%cell_points(:, i)))
            tangent = points(:, 2) - points(:, 1)
         end associate
         do end = 1, 2
            worst = max(worst, maxval(abs(rows(1:2, mesh%n_cells + 2*(i - 1) + end) &
                                          + 0.5_rk*matmul(stress, [-tangent(2), tangent(1)]))))
         end do
      end do
      call checks%is_close(worst, 0.0_rk, 1.0e-13_rk*maxval(abs(stress)), name//": fracture")
   end subroutine check_fracture_rows

   !> Patch test: any uniform strain with any uniform pressure, in plane strain and plane stress.
   subroutine test_uniform_strain(plane_stress)
      logical, intent(in) :: plane_stress
      type(rock_t) :: rock
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      real(rk), parameter :: gradient(2, 2) = reshape([2.0e-4_rk, 5.0e-4_rk, -1.0e-4_rk, &
                                                       -3.0e-4_rk], [2, 2])
      real(rk), parameter :: pressure = 7.0e6_rk
      real(rk), allocatable :: rows(:, :)
      real(rk) :: density, lame, stress(2, 2), trace, worst
      integer(ik) :: c

      scene = porous_body()
      scene%material%plane_stress = plane_stress
      associate (e => scene%material%young, nu => scene%material%poisson, &
                 biot => scene%material%biot, strain => 0.5_rk*(gradient + transpose(gradient)))
         ! Hooke's law in space, with a third strain that is zero, or such that the third stress is.
         trace = strain(1, 1) + strain(2, 2)
         lame = e*nu/((1.0_rk + nu)*(1.0_rk - 2.0_rk*nu))
         if (plane_stress) then
            trace = trace + (biot*pressure - lame*trace)/(lame + e/(1.0_rk + nu))
         end if
         stress = e/(1.0_rk + nu)*strain
         stress(1, 1) = stress(1, 1) + lame*trace - biot*pressure
         stress(2, 2) = stress(2, 2) + lame*trace - biot*pressure
         density = (scene%material%porosity*scene%fluid%compressibility + (biot &
                     - scene%material%porosity)*3.0_rk*(1.0_rk - 2.0_rk*nu)/e)*pressure + biot*trace
      end associate
      call load_sides(scene, [stress(1, 1), stress(2, 2), stress(1, 2)])
      call prepare(checks, mesh, scene, rock, regions, matrix)
      rows = action(matrix, 0.0_rk, linear_unknowns(mesh, [0.1e-3_rk, -0.2e-3_rk], gradient, &
                                                    pressure, [0.0_rk, 0.0_rk]))
      call checks%is_close(maxval(abs(rows(1:2, :mesh%n_cells))), 0.0_rk, &
                           1.0e-12_rk*maxval(abs(stress)), "uniform strain: equilibrium")
      worst = 0.0_rk
      do c = 1, mesh%n_cells
         worst = max(worst, abs(rows(3, c) + cell_area(mesh, c)*density))
      end do
      call checks%is_close(worst, 0.0_rk, 1.0e-16_rk, "uniform strain: fluid content")
      call check_fracture_rows(rows, stress, "uniform strain")
      call checks%is_close(maxval(abs(rows(3, mesh%n_cells + 1:))), 0.0_rk, 0.0_rk, &
                           "fractures store no fluid here")
   end subroutine test_uniform_strain

   !> A free body that moves and turns feels nothing.
   subroutine test_rigid_motion()
      type(rock_t) :: rock
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      real(rk), parameter :: turn(2, 2) = reshape([0.0_rk, 1.0e-3_rk, -1.0e-3_rk, 0.0_rk], [2, 2])

      call prepare(checks, mesh, porous_body(), rock, regions, matrix)
      call checks%is_close(maxval(abs(matrix%elastic_known)), 0.0_rk, 0.0_rk, "free body: no load")
      associate (rows => action(matrix, 0.0_rk, linear_unknowns(mesh, [1.0e-3_rk, 2.0e-3_rk], &
                                                                nothing, 0.0_rk, [0.0_rk, 0.0_rk])))
         ! Compared with the force of a strain of the same size, 1e-3*E*h = 1e7 N/m.
         call checks%is_close(maxval(abs(rows(1:2, :))), 0.0_rk, 1.0e-6_rk, "translation: forces")
         call checks%is_close(maxval(abs(rows(3, :))), 0.0_rk, 1.0e-17_rk, "translation: content")
      end associate
      associate (rows => action(matrix, 0.0_rk, linear_unknowns(mesh, [0.0_rk, 0.0_rk], turn, &
                                                                0.0_rk, [0.0_rk, 0.0_rk])))
         call checks%is_close(maxval(abs(rows(1:2, :))), 0.0_rk, 1.0e-6_rk, "rotation: forces")
         call checks%is_close(maxval(abs(rows(3, :))), 0.0_rk, 1.0e-17_rk, "rotation: content")
      end associate
   end subroutine test_rigid_motion

   !> Uniform pressure in a clamped body moves nothing: sigma = -alpha p I, content S p.
   subroutine test_clamped_pressure()
      type(rock_t) :: rock
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      real(rk), parameter :: pressure = 5.0e6_rk
      real(rk), allocatable :: rows(:, :)
      integer(ik) :: c, i

      scene = porous_body()
      do i = 1, 4
         scene%sides(i)%displacement_given = .true.
      end do
      call prepare(checks, mesh, scene, rock, regions, matrix)
      rows = action(matrix, 0.0_rk, linear_unknowns(mesh, [0.0_rk, 0.0_rk], nothing, pressure, &
                                                    [0.0_rk, 0.0_rk]))
      call checks%is_close(maxval(abs(rows(1:2, :mesh%n_cells))), 0.0_rk, 1.0e-13_rk*pressure, &
                           "clamped body: equilibrium")
      call checks%is_close(maxval([(abs(rows(3, c) + cell_area(mesh, c)*rock%storage(1)*pressure), &
                                    c=1, mesh%n_cells)]), 0.0_rk, 1.0e-17_rk, &
                           "clamped body: content")
      call check_fracture_rows(rows, reshape([-1.0_rk, 0.0_rk, 0.0_rk, -1.0_rk], [2, 2]) &
                               *rock%biot(1)*pressure, "clamped body")
   end subroutine test_clamped_pressure

   !> Linear pressure in a rock with a full permeability tensor: no cell gains fluid, and fracture
   !! faces pass the exact flux, q n l with q = -(K/mu) grad p. The pressure does not vary along the
   !! fracture, where its faces have one value per cell; and no fluid moves in y direction, so that
   !! bottom and top are closed in truth. Cells at the closed left and right sides are left out.
   subroutine test_linear_pressure()
      type(mesh_t) :: body
      type(rock_t) :: rock
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      real(rk), parameter :: slope(2) = [-0.5e6_rk, 0.9e6_rk]
      real(rk), parameter :: tensor(2, 2) = reshape([3.0e-14_rk, 1.0e-14_rk, 1.0e-14_rk, &
                                                     5.0e-14_rk/9.0_rk], [2, 2])
      real(rk), allocatable :: outflow(:), rows(:, :), unknowns(:, :)
      real(rk) :: flux(2), tangent(2), through, worst
      integer(ik) :: i

      call mesh_square(checks, straight_network(lines(:, :, :1)), 0.25_rk, 0.4_rk, body)
      call shake(body)
      scene = porous_body()
      scene%material%permeability_xx = tensor(1, 1)
      scene%material%permeability_yy = tensor(2, 2)
      scene%material%permeability_xy = tensor(1, 2)
      flux = -matmul(tensor, slope)/scene%fluid%viscosity
      call prepare(checks, body, scene, rock, regions, matrix)
      unknowns = linear_unknowns(body, [0.0_rk, 0.0_rk], nothing, 3.0e6_rk, slope)
      matrix%elastic = 0.0_rk
      rows = action(matrix, 1.0_rk, unknowns)
      allocate (outflow(body%n_cells))
      call cell_outflow(body, regions, regions%flux, unknowns(3, :), outflow)
      worst = 0.0_rk
      do i = 1, body%n_cells
         associate (x => body%xy(1, body%cell_nodes(:, i)))
            if (any(x < 1.0e-9_rk .or. x > 2.0_rk - 1.0e-9_rk)) cycle
         end associate
         worst = max(worst, abs(outflow(i)))
      end do
      call checks%is_close(worst, 0.0_rk, 1.0e-13_rk*abs(flux(1)), "linear pressure: balance")
      worst = 0.0_rk
      do i = 1, body%fracture%n_cells
         associate (points => body%fracture%point_xy(:, body%fracture%cell_points(:, i)), &
                    at => body%n_cells + 2*i)
            tangent = points(:, 2) - points(:, 1)
            through = dot_product(flux, [-tangent(2), tangent(1)])
            ! Out of the rock on side +, into it on side -.
            worst = max(worst, abs(rows(3, at - 1) - through), abs(rows(3, at) + through))
         end associate
      end do
      call checks%is_close(worst, 0.0_rk, 1.0e-13_rk*abs(flux(1)), "linear pressure: flux")
   end subroutine test_linear_pressure

   !> Constant pressure drives no flow: rows of the flow matrix add up to zero, and with given
   !! pressures on the sides to what these give.
   subroutine test_closed_sides()
      type(rock_t) :: rock
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      real(rk), parameter :: pressure = 4.0e6_rk
      real(rk), allocatable :: ones(:, :), rows(:, :)

      scene = porous_body()
      call prepare(checks, mesh, scene, rock, regions, matrix)
      allocate (ones(3, matrix%n_blocks), source=0.0_rk)
      ones(3, :) = 1.0_rk
      matrix%elastic = 0.0_rk
      rows = action(matrix, 1.0_rk, ones)
      call checks%is_close(maxval(abs(rows(3, :))), 0.0_rk, 1.0e-13_rk*maxval(abs(matrix%flow)), &
                           "closed sides: row sums")
      scene%sides([1, 4])%pressure_given = .true.
      scene%sides([1, 4])%pressure = pressure
      call prepare(checks, mesh, scene, rock, regions, matrix)
      call checks%is_true(maxval(abs(matrix%flow_known)) > 0.0_rk, "given pressures act")
      matrix%elastic = 0.0_rk
      rows = action(matrix, 1.0_rk, pressure*ones)
      call checks%is_close(maxval(abs(rows(3, :))), 0.0_rk, &
                           1.0e-13_rk*pressure*maxval(abs(matrix%flow)), "given pressures: no flow")
   end subroutine test_closed_sides

   !> For any unknowns at all: the matrix, half of which is kept, gives the forces of the tractions
   !! around each cell and the content that follows from them.
   subroutine test_tractions_behind_matrix()
      type(rock_t) :: rock
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      real(rk), allocatable :: content(:), force(:, :), rows(:, :), tractions(:), unknowns(:, :)
      real(rk) :: area, length(2), lever(2, 2), scale, sign_out(2)
      integer(ik) :: at, c, faces(2), j, k, r

      scene = porous_body()
      scene%sides(1)%displacement_given = .true.
      scene%sides(1)%displacement = [1.0e-4_rk, -2.0e-4_rk]
      scene%sides(2)%traction = [-20.0e6_rk, 3.0e6_rk]
      scene%sides(3)%displacement_given(2) = .true.
      scene%sides(3)%displacement(2) = 1.0e-4_rk
      scene%sides(4)%traction = [3.0e6_rk, -10.0e6_rk]
      call prepare(checks, mesh, scene, rock, regions, matrix)
      allocate (unknowns(3, matrix%n_blocks), content(mesh%n_cells), force(2, mesh%n_cells))
      unknowns = reshape(scattered(3*matrix%n_blocks), [3_ik, matrix%n_blocks])
      unknowns(1:2, :) = 1.0e-4_rk*unknowns(1:2, :)
      unknowns(3, :) = 1.0e6_rk*unknowns(3, :)
      rows = action(matrix, 0.0_rk, unknowns)
      call corner_tractions(regions, unknowns, tractions)
      force = 0.0_rk
      do c = 1, mesh%n_cells
         do k = 1, 3
            call corner_geometry(mesh, c, k, faces, sign_out, length, lever, area)
            r = regions%region_of_node(mesh%cell_nodes(k, c))
            do j = 1, 2
               call traction_face(mesh, faces(j), sign_out(j))
               at = regions%at_traction(r, faces(j))
               force(:, c) = force(:, c) + sign_out(j)*0.5_rk*length(j)*tractions(at:at + 1)
            end do
         end do
      end do
      scale = maxval(abs(force))
      call checks%is_close(maxval(abs(rows(1:2, :mesh%n_cells) + force)), 0.0_rk, &
                           1.0e-11_rk*scale, "forces by the matrix and by tractions")
      call cell_contents(mesh, rock, regions, matrix, unknowns, tractions, content)
      call checks%is_close(maxval(abs(rows(3, :mesh%n_cells) + content)), 0.0_rk, &
                           1.0e-11_rk*maxval(abs(content)), &
                           "contents by the matrix and by tractions")
   end subroutine test_tractions_behind_matrix

   !> The same for the flow.
   subroutine test_fluxes_behind_matrix()
      type(rock_t) :: rock
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      real(rk), allocatable :: outflow(:), rows(:, :), unknowns(:, :)
      real(rk) :: into_fractures

      scene = porous_body()
      scene%material%permeability_xy = 2.0e-20_rk
      scene%sides([1, 4])%pressure_given = .true.
      scene%sides([1, 4])%pressure = [2.0e6_rk, 3.0e6_rk]
      call prepare(checks, mesh, scene, rock, regions, matrix)
      allocate (unknowns(3, matrix%n_blocks), outflow(mesh%n_cells), source=0.0_rk)
      unknowns(3, :) = 1.0e6_rk*scattered(matrix%n_blocks)
      matrix%elastic = 0.0_rk
      matrix%elastic_known = 0.0_rk
      rows = action(matrix, 1.0_rk, unknowns)
      call cell_outflow(mesh, regions, regions%flux, unknowns(3, :), outflow)
      call checks%is_close(maxval(abs(rows(3, :mesh%n_cells) + outflow)), 0.0_rk, &
                           1.0e-12_rk*maxval(abs(outflow)), "outflow by the matrix and by fluxes")
      ! Without open sides, what leaves the cells enters the fractures.
      call prepare(checks, mesh, porous_body(), rock, regions, matrix)
      call cell_outflow(mesh, regions, regions%flux, unknowns(3, :), outflow)
      matrix%elastic = 0.0_rk
      rows = action(matrix, 1.0_rk, unknowns)
      into_fractures = sum(rows(3, mesh%n_cells + 1:))
      call checks%is_close(sum(outflow), into_fractures, 1.0e-12_rk*sum(abs(outflow)), &
                           "what leaves the rock enters the fractures")
   end subroutine test_fluxes_behind_matrix

   !> Positive for displacements and jumps, negative for pressures, also near incompressibility
   !! (quasi-definite, Vanderbei 1995: then any order of elimination is stable without pivoting).
   subroutine test_quasi_definite(poisson)
      real(rk), intent(in) :: poisson
      type(rock_t) :: rock
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      real(rk), allocatable :: full(:, :), part(:, :)
      integer(ik), allocatable :: of_pressure(:), of_displacement(:)
      integer(ik) :: i, info

      scene = porous_body()
      scene%material%poisson = poisson
      call hold(scene)
      call prepare(checks, mesh, scene, rock, regions, matrix)
      allocate (full, source=dense_matrix(matrix, 1.0e-3_rk))
      allocate (of_pressure, source=[(3*i, i=1, matrix%n_blocks)])
      allocate (of_displacement, source=[([3*i - 2, 3*i - 1], i=1, matrix%n_blocks)])
      allocate (part, source=full(of_displacement, of_displacement))
      call dpotrf("L", size(part, 1), part, size(part, 1), info)
      call checks%is_true(info == 0, "displacement block is positive definite")
      deallocate (part)
      allocate (part, source=-full(of_pressure, of_pressure))
      call dpotrf("L", size(part, 1), part, size(part, 1), info)
      call checks%is_true(info == 0, "pressure block is negative definite")
   end subroutine test_quasi_definite

end program test_coarse_matrix
