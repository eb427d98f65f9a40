!> Springs, tractions along and across the sides, inflow, points that are held and loaded; other
!! values on the sides are those of a matrix that is made again.
program test_coarse_sides
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use coarse_loads, only: add_point_forces, hold_points
   use coarse_matrix, only: matrix_t
   use coarse_regions, only: regions_t
   use coarse_rock, only: rock_t
   use coarse_stencils, only: renew_sides
   use mesh_types, only: mesh_t
   use sample_bodies, only: action, boxes, hold, linear_unknowns, porous_body, prepare, shake
   use scene_types, only: point_load_t, restraint_t, scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: nothing(2, 2) = 0.0_rk
   type(checks_t) :: checks
   type(scene_t) :: scene
   type(mesh_t) :: mesh

   mesh = boxes(5_ik)
   call shake(mesh)
   call test_springs()
   call test_shear()
   call test_inflow()
   call test_other_values()
   call test_points()
   call checks%finish()

contains

   !> Stress of a strain without shear: xx, yy [Pa].
   pure function stress_of(scene, strain) result(stress)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: strain(2)
      real(rk) :: stress(2)

      associate (e => scene%material%young, nu => scene%material%poisson)
         stress = e/(1.0_rk + nu)*(strain + nu/(1.0_rk - 2.0_rk*nu)*sum(strain))
      end associate
   end function stress_of

   !> Uniform strain between rollers and springs, against which tractions press: exact.
   subroutine test_springs()
      type(rock_t) :: rock
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      real(rk), parameter :: strain(2) = [2.0e-4_rk, -3.0e-4_rk], spring(2) = [3.0e10_rk, 5.0e9_rk]
      real(rk) :: gradient(2, 2), stress(2)
      real(rk), allocatable :: rows(:, :)

      scene = porous_body()
      gradient = reshape([strain(1), 0.0_rk, 0.0_rk, strain(2)], [2, 2])
      stress = stress_of(scene, strain)
      call hold(scene)
      scene%sides(2)%spring(1) = spring(1)
      scene%sides(2)%traction(1) = stress(1) + spring(1)*2.0_rk*strain(1)
      scene%sides(4)%spring(2) = spring(2)
      scene%sides(4)%normal_traction = stress(2) + spring(2)*2.0_rk*strain(2)
      call prepare(checks, mesh, scene, rock, regions, matrix)
      rows = action(matrix, 0.0_rk, linear_unknowns(mesh, [0.0_rk, 0.0_rk], gradient, 0.0_rk, &
                                                    [0.0_rk, 0.0_rk]))
      call checks%is_close(maxval(abs(rows(1:2, :))), 0.0_rk, 1.0e-12_rk*maxval(abs(stress)), &
                           "springs: equilibrium")
   end subroutine test_springs

   !> Pure shear by tractions along the sides, with the body on their left.
   subroutine test_shear()
      type(rock_t) :: rock
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      real(rk), parameter :: shear = 3.0e6_rk
      real(rk) :: gradient(2, 2)
      real(rk), allocatable :: rows(:, :)

      scene = porous_body()
      ! On the left the normal points back and the way down, and so on.
      scene%sides%shear_traction = shear*[1.0_rk, 1.0_rk, -1.0_rk, -1.0_rk]
      call prepare(checks, mesh, scene, rock, regions, matrix)
      gradient = 0.0_rk
      gradient(1, 2) = shear/rock%shear(1)
      rows = action(matrix, 0.0_rk, linear_unknowns(mesh, [0.0_rk, 0.0_rk], gradient, 0.0_rk, &
                                                    [0.0_rk, 0.0_rk]))
      call checks%is_close(maxval(abs(rows(1:2, :))), 0.0_rk, 1.0e-12_rk*shear, &
                           "shear along the sides: equilibrium")
   end subroutine test_shear

   !> Fluid comes in on the right and leaves on the left, where the pressure is given: a linear
   !! pressure, and no cell gains any.
   subroutine test_inflow()
      type(rock_t) :: rock
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      real(rk), parameter :: inflow = 2.0e-9_rk, pressure = 3.0e6_rk
      real(rk), allocatable :: rows(:, :)
      real(rk) :: slope

      scene = porous_body()
      scene%sides(1)%pressure_given = .true.
      scene%sides(1)%pressure = pressure
      scene%sides(2)%inflow = inflow
      slope = inflow*scene%fluid%viscosity/scene%material%permeability_xx
      call prepare(checks, mesh, scene, rock, regions, matrix)
      matrix%elastic = 0.0_rk
      rows = action(matrix, 1.0_rk, linear_unknowns(mesh, [0.0_rk, 0.0_rk], nothing, pressure, &
                                                    [slope, 0.0_rk]))
      call checks%is_close(maxval(abs(rows(3, :))), 0.0_rk, 1.0e-12_rk*inflow, "inflow: balance")
   end subroutine test_inflow

   !> What is known of the sides, and how tractions and fluxes answer to it.
   subroutine test_other_values()
      type(rock_t) :: rock
      type(regions_t) :: anew, regions
      type(matrix_t) :: matrix, other
      type(error_t), allocatable :: error
      integer(ik) :: r, wrong

      scene = porous_body()
      scene%sides(1)%displacement_given = .true.
      scene%sides(3)%pressure_given = .true.
      scene%sides(2)%spring(1) = 1.0e10_rk
      call prepare(checks, mesh, scene, rock, regions, matrix)
      scene%sides(1)%displacement = [1.0e-4_rk, -2.0e-4_rk]
      scene%sides(2)%traction = [-1.0e7_rk, 3.0e6_rk]
      scene%sides(3)%pressure = 2.0e6_rk
      scene%sides(4)%inflow = 1.0e-9_rk
      scene%sides(4)%normal_traction = -4.0e6_rk
      call renew_sides(mesh, rock, scene%sides, regions, matrix, error)
      call checks%no_error(error, "other values")
      call prepare(checks, mesh, scene, rock, anew, other)
      call checks%is_close(maxval(abs(matrix%elastic_known - other%elastic_known)), 0.0_rk, &
                           0.0_rk, "other values: forces")
      call checks%is_close(maxval(abs(matrix%flow_known - other%flow_known)), 0.0_rk, 0.0_rk, &
                           "other values: flows")
      wrong = 0
      do r = 1, regions%n_regions
         if (any(abs(regions%traction(r)%matrix - anew%traction(r)%matrix) > 0.0_rk) .or. &
             any(abs(regions%flux(r)%matrix - anew%flux(r)%matrix) > 0.0_rk)) wrong = wrong + 1
      end do
      call checks%is_true(wrong == 0, "other values: tractions and fluxes")
   end subroutine test_other_values

   !> Cells around a node share a force; one in which a point lies has all of it; what holds a point
   !! bears what its displacement lacks of the given one.
   subroutine test_points()
      type(rock_t) :: rock
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      real(rk) :: force(2, mesh%n_cells)
      real(rk), allocatable :: rows(:, :)
      integer(ik) :: node
      real(rk), parameter :: move(2) = [1.0e-4_rk, 3.0e-4_rk]

      scene = porous_body()
      node = 15_ik  ! inside
      associate (place => mesh%xy(:, node), &
                 middle => sum(mesh%xy(:, mesh%cell_nodes(:, 7)), dim=2)/3.0_rk)
         scene%point_loads = [point_load_t(place(1), place(2), [2.0_rk, 3.0_rk]), &
                              point_load_t(middle(1), middle(2), [0.0_rk, 5.0_rk])]
         scene%restraints = [restraint_t(place(1), place(2), [.true., .false.], [move(1), 0.0_rk])]
      end associate
      force = 0.0_rk
      call add_point_forces(scene, mesh, force)
      call checks%is_close(sum(force(1, :)), 2.0_rk, 1.0e-14_rk, "forces: all of them, x")
      call checks%is_close(sum(force(2, :)), 8.0_rk, 1.0e-14_rk, "forces: all of them, y")
     call checks%is_true(count(force(1, :) > 0.0_rk) == count(any(mesh%cell_nodes == node, dim=1)) &
                          .and. force(2, 7) >= 5.0_rk, "forces: on the cells there")
      call prepare(checks, mesh, scene, rock, regions, matrix)
      force = 0.0_rk
      call hold_points(scene, mesh, matrix, force)
      rows = action(matrix, 0.0_rk, linear_unknowns(mesh, move, nothing, 0.0_rk, [0.0_rk, 0.0_rk]))
      call checks%is_close(maxval(abs(rows(1:2, :) - force)), 0.0_rk, &
                           1.0e-12_rk*maxval(abs(force)), "a held point that is where it is held")
      rows = action(matrix, 0.0_rk, linear_unknowns(mesh, [0.0_rk, move(2)], nothing, 0.0_rk, &
                                                    [0.0_rk, 0.0_rk]))
      call checks%is_true(maxval(abs(rows(1, :) - force(1, :))) > 0.1_rk*maxval(force), &
                          "a held point that is not")
      call checks%is_close(maxval(abs(rows(2, :))), 0.0_rk, 1.0e-12_rk*maxval(abs(force)), &
                           "a component that is free")
   end subroutine test_points

end program test_coarse_sides
