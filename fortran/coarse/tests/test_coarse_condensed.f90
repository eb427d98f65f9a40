!> The rock condensed onto its fractures: the same solution as that of the whole system, for any
!! tractions and fluxes on the fractures, for several time steps, and without fractures.
program test_coarse_condensed
   use algebra_lapack, only: dgesv
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use coarse_condensed, only: condensed_t
   use coarse_layout, only: condensed_layout_t
   use coarse_matrix, only: matrix_t
   use coarse_regions, only: regions_t
   use coarse_rock, only: rock_t
   use mesh_types, only: mesh_t
   use sample_bodies, only: dense_matrix, hold, mesh_square, porous_body, prepare, scattered, &
                            shake, straight_network
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(mesh_t) :: mesh

   call test_with_fractures()
   call test_without_fracture()
   call test_without_full_matrix()
   call test_nearly_incompressible()
   call checks%finish()

contains

   subroutine drained(mesh, rock, matrix)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(out) :: rock
      type(matrix_t), intent(out) :: matrix
      type(regions_t) :: regions
      type(scene_t) :: scene

      scene = porous_body()
      call hold(scene)
      scene%sides(4)%traction = [2.0e6_rk, -10.0e6_rk]
      scene%sides(2)%pressure_given = .true.
      scene%sides(2)%pressure = 2.0e6_rk
      call prepare(checks, mesh, scene, rock, regions, matrix)
   end subroutine drained

   !> The whole system by Gauss elimination, scaled by its diagonal.
   subroutine solve_whole(matrix, dt, rhs, unknowns)
      type(matrix_t), intent(in) :: matrix
      real(rk), intent(in) :: dt
      real(rk), intent(in) :: rhs(:, :)
      real(rk), allocatable, intent(out) :: unknowns(:, :)
      real(rk), allocatable :: full(:, :), scale(:), x(:, :)
      integer(ik) :: i, info, n
      integer(ik), allocatable :: pivots(:)

      n = size(rhs)
      allocate (full, source=dense_matrix(matrix, dt))
      allocate (scale, source=[(1.0_rk/sqrt(abs(full(i, i))), i=1, n)])
      full = full*spread(scale, 1, n)*spread(scale, 2, n)
      allocate (x, source=reshape(reshape(rhs, [n])*scale, [n, 1_ik]))
      allocate (pivots(n))
      call dgesv(n, 1_ik, full, n, pivots, x, n, info)
      call checks%is_true(info == 0, "the whole system can be solved")
      allocate (unknowns, source=reshape(x(:, 1)*scale, shape(rhs)))
   end subroutine solve_whole

   !> Right-hand side with the boundary's part and loads without any pattern.
   function some_load(matrix, dt) result(rhs)
      type(matrix_t), intent(in) :: matrix
      real(rk), intent(in) :: dt
      real(rk), allocatable :: rhs(:, :)

      allocate (rhs, source=reshape(scattered(3*matrix%n_blocks), [3_ik, matrix%n_blocks]))
      rhs(1:2, :) = 1.0e5_rk*rhs(1:2, :)
      rhs(3, :) = 1.0e-6_rk*rhs(3, :)
      rhs(:, matrix%n_cells + 1:) = 0.0_rk
      rhs = rhs + matrix%elastic_known
      rhs(3, :) = rhs(3, :) + dt*matrix%flow_known
   end function some_load

   subroutine compare(unknowns, expected, n_cells, name)
      real(rk), intent(in) :: unknowns(:, :), expected(:, :)
      integer(ik), intent(in) :: n_cells
      character(len=*), intent(in) :: name

      call checks%is_close(maxval(abs(unknowns(1:2, :) - expected(1:2, :))), 0.0_rk, &
                           1.0e-10_rk*maxval(abs(expected(1:2, :))), name//": displacements, jumps")
      call checks%is_close(maxval(abs(unknowns(3, :n_cells) - expected(3, :n_cells))), 0.0_rk, &
                           1.0e-10_rk*maxval(abs(expected(3, :))), name//": pressures")
      if (size(unknowns, 2) > n_cells) call checks%is_close( &
         maxval(abs(unknowns(3, n_cells + 1:) - expected(3, n_cells + 1:))), 0.0_rk, &
         1.0e-8_rk*maxval(abs(expected(3, :))), name//": pressures at fractures")
   end subroutine compare

   !> Forces and fluxes r on the fractures: S q = g + r, then all unknowns from q.
   subroutine test_with_fractures()
      type(rock_t) :: rock
      type(matrix_t) :: matrix
      type(condensed_t) :: condensed
      real(rk), parameter :: lines(2, 2, 2) = reshape([0.5_rk, 0.7_rk, 1.4_rk, 1.2_rk, 1.7_rk, &
                                                       1.6_rk, 0.7_rk, 1.5_rk], [2, 2, 2])
      real(rk), parameter :: steps(4) = [1.0_rk, 1800.0_rk, 1.0e8_rk, 1800.0_rk]
      real(rk), allocatable :: expected(:, :), g(:), q(:, :), r(:, :), rhs(:, :), stiffness(:, :)
      real(rk), allocatable :: unknowns(:, :)
      type(condensed_layout_t) :: layout
      integer(ik), allocatable :: pivots(:)
      integer(ik) :: i, info, k, n

      call mesh_square(checks, straight_network(lines), 0.25_rk, 0.4_rk, mesh)
      call shake(mesh)
      call drained(mesh, rock, matrix)
      layout = condensed_layout_t(mesh%fracture%n_cells)
      n = layout%count()
      allocate (g(n), q(n, 1), pivots(n), unknowns(3, matrix%n_blocks))
      allocate (r, source=reshape(scattered(n), [3_ik, n/3]))
      r(1:2, :) = 1.0e5_rk*r(1:2, :)
      r(3, :) = 1.0e-8_rk*r(3, :)
      do k = 1, size(steps)
         call condensed%factorize(mesh, matrix, steps(k), error)
         call checks%no_error(error, "factorization")
         call checks%is_close(condensed%dt, steps(k), 0.0_rk, "time step on record")
         call checks%is_true(condensed%factors%by_fronts, "no pivots are exchanged")
         call checks%is_true(condensed%n == mesh%fracture%n_cells, "number of fracture cells")
         rhs = some_load(matrix, steps(k))
         call condensed%condense(rhs, g, error)
         call checks%no_error(error, "condensation")
         stiffness = condensed%stiffness%entry
         call checks%is_close(maxval(abs(stiffness - transpose(stiffness))), 0.0_rk, &
                              1.0e-12_rk*maxval(abs(stiffness)), &
                              "the condensed matrix is symmetric")
         q(:, 1) = g + in_frames(mesh, r)
         call solve_condensed(stiffness, q, pivots, info)
         call checks%is_true(info == 0, "the condensed system can be solved")
         call condensed%expand(q(:, 1), rhs, unknowns, error)
         call checks%no_error(error, "expansion")
         rhs(:, matrix%n_cells + 1:) = rhs(:, matrix%n_cells + 1:) + r
         call solve_whole(matrix, steps(k), rhs, expected)
         call compare(unknowns, expected, mesh%n_cells, "with fractures")
         call checks%is_close(maxval(abs(q(:, 1) - in_frames(mesh, &
                                                             unknowns(:, matrix%n_cells &
                                                                      + 1:)))), 0.0_rk, &
                              1.0e-12_rk*maxval(abs(q)), "q in axes")
      end do
      do i = 1, mesh%fracture%n_cells
         associate (points => mesh%fracture%point_xy(:, mesh%fracture%cell_points(:, i)))
            call checks%is_close(condensed%length(i), norm2(points(:, 2) - points(:, 1)), &
                                 1.0e-15_rk, "length of a fracture cell")
            call checks%is_close(dot_product(condensed%normal(:, i), points(:, 2) &
                                             - points(:, 1)), 0.0_rk, 1.0e-15_rk, &
                                 "normal of a fracture cell")
         end associate
      end do
   end subroutine test_with_fractures

   subroutine solve_condensed(stiffness, x, pivots, info)
      real(rk), intent(inout) :: stiffness(:, :), x(:, :)
      integer(ik), intent(out) :: pivots(:)
      integer(ik), intent(out) :: info
      real(rk), allocatable :: scale(:)
      integer(ik) :: i, n

      n = size(x, 1)
      allocate (scale, source=[(1.0_rk/sqrt(abs(stiffness(i, i))), i=1, n)])
      stiffness = stiffness*spread(scale, 1, n)*spread(scale, 2, n)
      x(:, 1) = x(:, 1)*scale
      call dgesv(n, 1_ik, stiffness, n, pivots, x, n, info)
      x(:, 1) = x(:, 1)*scale
   end subroutine solve_condensed

   !> Components x, y of each block become normal (side + to side -) and tangential (n turned by -90
   !! degrees); the third stays.
   function in_frames(mesh, blocks) result(v)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: blocks(:, :)  !< (3, 2 n)
      real(rk), allocatable :: v(:)
      integer(ik) :: b
      real(rk) :: normal(2), tangent(2)

      allocate (v(size(blocks)))
      do b = 1, size(blocks, 2)
         associate (points => mesh%fracture%point_xy(:, mesh%fracture%cell_points(:, (b + 1)/2)))
            tangent = (points(:, 2) - points(:, 1))/norm2(points(:, 2) - points(:, 1))
            normal = [-tangent(2), tangent(1)]
            v(3*b - 2:3*b) = [dot_product(normal, blocks(1:2, b)), &
                              dot_product(tangent, blocks(1:2, b)), blocks(3, b)]
         end associate
      end do
   end function in_frames

   !> Without fractures there is nothing to condense onto: expand solves the whole system.
   subroutine test_without_fracture()
      type(rock_t) :: rock
      type(matrix_t) :: matrix
      type(condensed_t) :: condensed
      real(rk), allocatable :: expected(:, :), rhs(:, :), unknowns(:, :)
      real(rk) :: none(2, 2, 0), empty(0)
      integer(ik) :: k

      call mesh_square(checks, straight_network(none), 0.3_rk, 0.3_rk, mesh)
      call shake(mesh)
      call drained(mesh, rock, matrix)
      allocate (unknowns(3, matrix%n_blocks))
      do k = 1, 2
         call condensed%factorize(mesh, matrix, 100.0_rk**k, error)
         call checks%no_error(error, "factorization without fracture")
         rhs = some_load(matrix, 100.0_rk**k)
         call condensed%condense(rhs, empty, error)
         call checks%no_error(error, "nothing to condense")
         call condensed%expand(empty, rhs, unknowns, error)
         call checks%no_error(error, "solution without fracture")
         call solve_whole(matrix, 100.0_rk**k, rhs, expected)
         call compare(unknowns, expected, mesh%n_cells, "without fracture")
      end do
   end subroutine test_without_fracture

   !> The same forces, loads and unknowns where S is not formed.
   subroutine test_without_full_matrix()
      type(rock_t) :: rock
      type(matrix_t) :: matrix
      type(condensed_t) :: full, sparse
      real(rk), parameter :: lines(2, 2, 2) = reshape([0.5_rk, 0.7_rk, 1.4_rk, 1.2_rk, 1.4_rk, &
                                                       0.6_rk, 0.7_rk, 1.5_rk], [2, 2, 2])
      real(rk), parameter :: steps(2) = [1.0_rk, 1.0e6_rk]
      real(rk), allocatable :: expected(:), force(:), q(:), rhs(:, :), spring(:)
      real(rk), allocatable :: all_expected(:, :), unknowns(:, :)
      integer(ik), allocatable :: faces(:)
      integer(ik) :: i, k, n

      call mesh_square(checks, straight_network(lines), 0.25_rk, 0.4_rk, mesh)
      call drained(mesh, rock, matrix)
      sparse%is_full = .false.
      do k = 1, size(steps)
         call full%factorize(mesh, matrix, steps(k), error)
         call sparse%factorize(mesh, matrix, steps(k), error)
         call checks%no_error(error, "factorization without its fractures")
         n = full%layout%count()
         q = scattered(n)
         q(3 :: 3) = 1.0e9_rk*q(3 :: 3)
         spring = 1.0e9_rk*abs(scattered(n))
         spring(3 :: 3) = 0.0_rk
         call full%support(spring)
         call sparse%support(spring)
         expected = spread(0.0_rk, 1, n)
         force = expected
         call full%find_forces(q, expected, error)
         call sparse%find_forces(q, force, error)
         call checks%no_error(error, "forces")
         call compare_kinds(force, expected, "forces", "volumes")
         rhs = some_load(matrix, steps(k))
         call full%condense(rhs, expected, error)
         call sparse%condense(rhs, force, error)
         call checks%no_error(error, "load")
         call compare_kinds(force, expected, "loads", "volumes of the load")
         allocate (unknowns(3, matrix%n_blocks), all_expected(3, matrix%n_blocks))
         call full%expand(q, rhs, all_expected, error)
         call sparse%expand(q, rhs, unknowns, error)
         call checks%no_error(error, "all unknowns")
         call compare_kinds(reshape(unknowns, [size(unknowns)]), &
                            reshape(all_expected, [size(unknowns)]), "displacements", "pressures")
         deallocate (unknowns, all_expected)
         faces = [(3*i, i=1, n/3)]
         expected = spread(0.0_rk, 1, size(faces))
         force = expected
         call full%find_volume_slopes(faces, expected, error)
         call sparse%find_volume_slopes(faces(:3), force(:3), error)
         call sparse%find_volume_slopes(faces, force, error)
         call checks%no_error(error, "slopes of volumes")
         call checks%is_close(maxval(abs(force/expected - 1.0_rk)), 0.0_rk, 1.0e-9_rk, &
                              "slopes of volumes")
      end do
   end subroutine test_without_full_matrix

   !> Cells that hardly store fluid or let it pass leave next to nothing on the diagonal of the
   !! pressures, and eliminating these first would lose all digits: the run must go on with
   !! exchanges of pivots, for good, as if it had never tried without. What is well posed is then
   !! solved as well as ever.
   subroutine test_nearly_incompressible()
      type(rock_t) :: rock
      type(matrix_t) :: matrix
      type(condensed_t) :: condensed, exchanging
      real(rk), parameter :: parts(3) = [0.0_rk, 1.0e-14_rk, 1.0_rk]
      real(rk), parameter :: steps(3) = [1.0e-20_rk, 1.0e-20_rk, 100.0_rk]
      real(rk) :: none(2, 2, 0), empty(0)
      real(rk), allocatable :: expected(:, :), rhs(:, :), storing(:), unknowns(:, :)
      integer(ik) :: k

      call mesh_square(checks, straight_network(none), 0.3_rk, 0.3_rk, mesh)
      call shake(mesh)
      call drained(mesh, rock, matrix)
      storing = matrix%elastic(3, 3, :)
      allocate (unknowns(3, matrix%n_blocks), expected(3, matrix%n_blocks))
      exchanging%factors%needs_exchanges = .true.
      do k = 1, size(parts)
         matrix%elastic(3, 3, :) = parts(k)*storing
         call condensed%factorize(mesh, matrix, steps(k), error)
         call checks%no_error(error, "factorization of what is incompressible")
    call checks%is_true(condensed%factors%needs_exchanges .and. .not. condensed%factors%by_fronts, &
                             "pivots are exchanged, from now on")
         rhs = some_load(matrix, steps(k))
         call condensed%expand(empty, rhs, unknowns, error)
         call checks%no_error(error, "solution of what is incompressible")
         call exchanging%factorize(mesh, matrix, steps(k), error)
         call exchanging%expand(empty, rhs, expected, error)
         call checks%is_true(all(abs(unknowns - expected) <= 0.0_rk), "as with exchanges at once")
      end do
      call solve_whole(matrix, steps(3), rhs, expected)
      call compare(unknowns, expected, mesh%n_cells, "after what was incompressible")
   end subroutine test_nearly_incompressible

   !> Two of three numbers are of the first kind, one of the second.
   subroutine compare_kinds(found, expected, first, second)
      real(rk), intent(in) :: found(:), expected(:)
      character(len=*), intent(in) :: first, second
      real(rk) :: scale
      integer(ik) :: a

      scale = max(maxval(abs(expected(1 :: 3))), maxval(abs(expected(2 :: 3))))
      do a = 1, 2
         call checks%is_close(maxval(abs(found(a :: 3) - expected(a :: 3))), 0.0_rk, &
                              1.0e-9_rk*scale, first)
      end do
      scale = maxval(abs(expected(3 :: 3)))
      call checks%is_close(maxval(abs(found(3 :: 3) - expected(3 :: 3))), 0.0_rk, &
                           1.0e-9_rk*scale, second)
   end subroutine compare_kinds

end program test_coarse_condensed
