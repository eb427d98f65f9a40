!> Fields from the unknowns: exact where displacement and pressure are linear, also at loaded
!! corners of the body, beside fractures, and where blocks of the body move against each other.
program test_coarse_fields
   use base_kinds, only: ik, rk
   use coarse_fields, only: cell_contents, cell_stresses, corner_tractions
   use coarse_matrix, only: matrix_t
   use coarse_nodes, only: nodal_fields, node_values
   use coarse_own_pressure, only: own_pressure
   use coarse_regions, only: regions_t
   use coarse_rock, only: rock_t
   use mesh_geometry, only: cell_area
   use mesh_types, only: mesh_t
   use sample_bodies, only: boxes, cell_centre, linear_unknowns, load_sides, mesh_square, &
                            porous_body, prepare, shake, straight_network
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: nothing(2, 2) = 0.0_rk
   type(checks_t) :: checks
   type(mesh_t) :: mesh
   type(scene_t) :: scene
   type(mesh_t) :: body

   call mesh_square(checks, straight_network(reshape([0.5_rk, 0.7_rk, 1.4_rk, 1.2_rk, 0.0_rk, &
                                                      1.5_rk, 0.8_rk, 1.5_rk], [2, 2, 2])), &
                    0.25_rk, 0.4_rk, body)
   call shake(body)
   call test_linear_displacement(body)
   call test_own_pressure(body)
   body = boxes(4_ik)
   call shake(body)
   call test_linear_displacement(body)
   call test_linear_pressure()
   call test_two_blocks()
   call test_four_blocks()
   call checks%finish()

contains

   !> Stress, fluid content and values at the nodes from given unknowns.
   subroutine evaluate(scene, mesh, unknowns, stresses, content, values)
      type(scene_t), intent(in) :: scene
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: unknowns(:, :)
      real(rk), allocatable, intent(out) :: stresses(:, :), content(:), values(:, :)
      type(rock_t) :: rock
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      real(rk), allocatable :: tractions(:)
      real(rk) :: worst
      integer(ik) :: v

      call prepare(checks, mesh, scene, rock, regions, matrix)
      allocate (stresses(3, mesh%n_cells), content(mesh%n_cells), values(3, mesh%n_nodes))
      call corner_tractions(regions, unknowns, tractions)
      call cell_stresses(mesh, regions, tractions, stresses)
      call cell_contents(mesh, rock, regions, matrix, unknowns, tractions, content)
      call nodal_fields(mesh, rock, regions, unknowns, tractions, values)
      worst = 0.0_rk
      do v = 1, mesh%n_nodes
         worst = max(worst, maxval(abs(node_values(mesh, rock, regions, unknowns, tractions, v) &
                                       - values(:, v))/(1.0e-15_rk + abs(values(:, v)))))
      end do
      call checks%is_close(worst, 0.0_rk, 1.0e-13_rk, "the same at each node by itself")
   end subroutine evaluate

   !> Any uniform strain, rotation and pressure. At a corner of the body with one cell whose
   !! tractions are all given, the rotation has to come from elsewhere.
   subroutine test_linear_displacement(mesh)
      type(mesh_t), intent(in) :: mesh
      real(rk), parameter :: gradient(2, 2) = reshape([2.0e-4_rk, 9.0e-4_rk, -1.0e-4_rk, &
                                                       -3.0e-4_rk], [2, 2])
      real(rk), parameter :: translation(2) = [0.1e-3_rk, -0.2e-3_rk], pressure = 7.0e6_rk
      real(rk), allocatable :: content(:), stresses(:, :), values(:, :)
      real(rk) :: bulk, shear, storage, stress(3), trace, worst
      integer(ik) :: c, v

      scene = porous_body()
      associate (e => scene%material%young, nu => scene%material%poisson)
         shear = e/(2.0_rk*(1.0_rk + nu))
         bulk = e/(3.0_rk*(1.0_rk - 2.0_rk*nu))
      end associate
      storage = scene%material%porosity*scene%fluid%compressibility &
                + (scene%material%biot - scene%material%porosity)/bulk
      trace = gradient(1, 1) + gradient(2, 2)
      stress(:2) = 2.0_rk*shear*([gradient(1, 1), gradient(2, 2)] - trace/3.0_rk) + bulk*trace &
                   - scene%material%biot*pressure
      stress(3) = shear*(gradient(1, 2) + gradient(2, 1))
      call load_sides(scene, stress)
      call evaluate(scene, mesh, linear_unknowns(mesh, translation, gradient, pressure, &
                                                 [0.0_rk, 0.0_rk]), stresses, content, values)
      call checks%is_close(maxval(abs(stresses - spread(stress, 2, mesh%n_cells))), 0.0_rk, &
                           1.0e-12_rk*maxval(abs(stress)), "uniform stress")
      call checks%is_close(maxval([(abs(content(c) - cell_area(mesh, c)*(storage*pressure &
         + scene%material%biot*trace)), c=1, mesh%n_cells)]), 0.0_rk, 1.0e-17_rk, "uniform content")
      worst = maxval([(maxval(abs(values(1:2, v) - translation - matmul(gradient, &
                                                                        mesh%xy(:, v)))), v=1, &
                       mesh%n_nodes)])
      call checks%is_close(worst, 0.0_rk, 1.0e-15_rk, "linear displacement at all nodes")
      call checks%is_close(maxval(abs(values(3, :) - pressure)), 0.0_rk, 1.0e-12_rk*pressure, &
                           "uniform pressure at all nodes")
   end subroutine test_linear_displacement

   !> Pressure that falls from left to right: exact at all nodes, and no flow through bottom and
   !! top.
   !> The rock's own pressure is exact where it is linear, on both sides of fractures. A pressure of
   !! the fluid that the cells know nothing of does not come into it.
   subroutine test_own_pressure(mesh)
      type(mesh_t), intent(in) :: mesh
      real(rk), parameter :: rock = 3.0e6_rk, fluid = 10.0e6_rk, slope(2) = [2.0e6_rk, -1.0e6_rk]
      real(rk) :: exact(mesh%n_nodes), means(mesh%n_cells)
      integer(ik) :: c, v

      means = [(rock + dot_product(slope, cell_centre(mesh, c)), c=1, mesh%n_cells)]
      exact = [(rock + dot_product(slope, mesh%xy(:, v)), v=1, mesh%n_nodes)]
      call checks%is_close(maxval(abs(own_pressure(mesh, means, exact) - exact)), &
                           0.0_rk, 1.0e-11_rk*rock, "linear pressure")
      means = rock
      exact = rock
      exact(pack(mesh%face_nodes(1, :), mesh%face_fracture_cell > 0)) = fluid
      call checks%is_close(maxval(abs(own_pressure(mesh, means, exact) - rock)), &
                           0.0_rk, 1.0e-11_rk*rock, "no layer in the cells")
   end subroutine test_own_pressure

   subroutine test_linear_pressure()
      real(rk), allocatable :: content(:), stresses(:, :), values(:, :)
      real(rk) :: none(2, 2, 0)

      call mesh_square(checks, straight_network(none), 0.4_rk, 0.4_rk, mesh)
      call shake(mesh)
      scene = porous_body()
      scene%sides([1, 2])%pressure_given = .true.
      scene%sides([1, 2])%pressure = [3.0e6_rk, 1.0e6_rk]
      call evaluate(scene, mesh, linear_unknowns(mesh, [0.0_rk, 0.0_rk], nothing, 3.0e6_rk, &
                                                 [-1.0e6_rk, 0.0_rk]), stresses, content, values)
      call checks%is_close(maxval(abs(values(3, :) - 3.0e6_rk + 1.0e6_rk*mesh%xy(1, :))), &
                           0.0_rk, 1.0e-6_rk, "linear pressure at all nodes")
   end subroutine test_linear_pressure

   !> The jump that a fracture cell sees between two blocks that move by so much.
   subroutine set_jumps(mesh, unknowns)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(inout) :: unknowns(:, :)
      integer(ik) :: i

      do i = 1, mesh%fracture%n_cells
         associate (cells => mesh%face_cells(1, mesh%fracture%cell_faces(:, i)), &
                    at => mesh%n_cells + 2*i)
            unknowns(1, at - 1:at) = unknowns(1, cells(2)) - unknowns(1, cells(1))
            unknowns(2, at - 1:at) = unknowns(2, cells(2)) - unknowns(2, cells(1))
         end associate
      end do
   end subroutine set_jumps

   !> A cut through the whole body: its upper part slides and opens as one block.
   subroutine test_two_blocks()
      type(mesh_t) :: mesh
      real(rk), parameter :: block_motion(2, 2) = reshape([1.0e-3_rk, 0.4e-3_rk, -2.0e-3_rk, &
                                                           1.1e-3_rk], [2, 2])
      real(rk), allocatable :: content(:), stresses(:, :), unknowns(:, :), values(:, :)
      real(rk) :: worst
      integer(ik) :: c, part

      call mesh_square(checks, straight_network(reshape([0.0_rk, 0.6_rk, 2.0_rk, 1.4_rk], &
                                                        [2, 2, 1])), 0.25_rk, 0.4_rk, mesh)
      call shake(mesh)
      allocate (unknowns, source=linear_unknowns(mesh, [0.0_rk, 0.0_rk], nothing, 0.0_rk, &
                                                 [0.0_rk, 0.0_rk]))
      do c = 1, mesh%n_cells
         associate (x => cell_centre(mesh, c))
            unknowns(1:2, c) = block_motion(:, merge(2, 1, x(2) > 0.6_rk + 0.4_rk*x(1)))
         end associate
      end do
      call set_jumps(mesh, unknowns)
      call evaluate(porous_body(), mesh, unknowns, stresses, content, values)
      ! Compared with 1e-3*E = 4e7 Pa.
      call checks%is_close(maxval(abs(stresses)), 0.0_rk, 1.0e-4_rk, "two blocks: no stress")
      call checks%is_close(maxval(abs(content)), 0.0_rk, 1.0e-16_rk, "two blocks: no fluid")
      worst = 0.0_rk
      do c = 1, mesh%n_cells
         associate (x => cell_centre(mesh, c), at => values(1:2, mesh%cell_nodes(:, c)))
            part = merge(2, 1, x(2) > 0.6_rk + 0.4_rk*x(1))
            worst = max(worst, maxval(abs(at - spread(block_motion(:, part), 2, 3))))
         end associate
      end do
      call checks%is_close(worst, 0.0_rk, 1.0e-14_rk, "two blocks: nodes move with their block")
   end subroutine test_two_blocks

   !> Two cuts that cross: four blocks.
   subroutine test_four_blocks()
      real(rk), parameter :: lines(2, 2, 2) = reshape([0.0_rk, 1.0_rk, 2.0_rk, 1.0_rk, 0.7_rk, &
                                                       0.0_rk, 1.3_rk, 2.0_rk], [2, 2, 2])
      real(rk), allocatable :: content(:), stresses(:, :), unknowns(:, :), values(:, :)
      real(rk) :: worst
      integer(ik) :: c

      call mesh_square(checks, straight_network(lines), 0.25_rk, 0.4_rk, mesh)
      call shake(mesh)
      allocate (unknowns, source=linear_unknowns(mesh, [0.0_rk, 0.0_rk], nothing, 0.0_rk, &
                                                 [0.0_rk, 0.0_rk]))
      do c = 1, mesh%n_cells
         unknowns(1:2, c) = motion(mesh, c)
      end do
      call set_jumps(mesh, unknowns)
      call evaluate(porous_body(), mesh, unknowns, stresses, content, values)
      call checks%is_close(maxval(abs(stresses)), 0.0_rk, 1.0e-4_rk, "four blocks: no stress")
      worst = 0.0_rk
      do c = 1, mesh%n_cells
         worst = max(worst, maxval(abs(values(1:2, mesh%cell_nodes(:, c)) &
                                       - spread(motion(mesh, c), 2, 3))))
      end do
      call checks%is_close(worst, 0.0_rk, 1.0e-14_rk, "four blocks: nodes move with their block")
   end subroutine test_four_blocks

   !> How the block around a cell moves.
   pure function motion(mesh, cell) result(u)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell
      real(rk) :: u(2)

      associate (x => cell_centre(mesh, cell))
         u = 1.0e-3_rk*[merge(1.0_rk, -0.5_rk, x(2) > 1.0_rk), &
                        merge(0.3_rk, 2.0_rk, x(1) > 0.7_rk + 0.3_rk*x(2))]
         if (x(2) > 1.0_rk .and. x(1) > 0.7_rk + 0.3_rk*x(2)) u = u + [0.7e-3_rk, 0.9e-3_rk]
      end associate
   end function motion

end program test_coarse_fields
