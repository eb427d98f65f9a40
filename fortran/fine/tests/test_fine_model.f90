!> The fine problem against exact fields: patch tests, convergence, initial stress, refusals.
program test_fine_model
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use exact_cracks, only: uniform_field
   use fine_elasticity, only: elasticity_t, rocks_t
   use fine_element, only: evaluate_element, triangle_rule_7
   use fine_error, only: energy_error_t, estimate_error
   use fine_faces, only: loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_model, only: fine_model_t
   use fine_recovery, only: recover_by_patches, recovery_t
   use mesh_types, only: mesh_t
   use sample_meshes, only: cracked_rectangle
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(mesh_t) :: mesh

   call patch_test(.false.)
   call patch_test(.true.)
   call patch_of_two_rocks(1.0e-3_rk, [0.0_rk, 0.49_rk])
   call patch_of_two_rocks(3.0_rk, [0.3_rk, 0.2_rk])
   call patch_of_two_rocks(1.0e3_rk, [0.49_rk, 0.0_rk])
   call convergence()
   call initial_stress()
   call linear_pressure()
   call refusals()
   call checks%finish()

contains

   !> Uniform stress, carried across a crack by contact traction and fluid pressure on its faces,
   !! with quarter-point elements at both tips.
   subroutine patch_test(plane_stress)
      logical, intent(in) :: plane_stress
      real(rk), parameter :: stress(3) = [-3.0e6_rk, -5.0e6_rk, 1.5e6_rk], pressure = 2.0e6_rk
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      real(rk), allocatable :: displacement(:, :), exact(:, :)
      real(rk) :: found(2, 2), largest
      integer(ik) :: node, cell

      mesh = cracked_rectangle([-1.0_rk, 2.0_rk], [0.0_rk, 2.0_rk], [6_ik, 5_ik], 2_ik, 3_ik, 5_ik)
      call model%set_mesh(mesh, elasticity_t(4.0e10_rk, 0.2_rk, 0.8_rk, plane_stress), error)
      call model%prepare(loaded_everywhere(model%mesh), error)
      call checks%no_error(error, "patch test is set up")
      loads = no_loads(model%mesh)
      allocate (exact(2, model%mesh%n_nodes))
      do node = 1, model%mesh%n_nodes
         exact(:, node) = uniform_field(model%elasticity, stress, model%mesh%xy(:, node))
      end do
      loads%boundary_displacement = exact
      loads%fluid_pressure = pressure
      loads%traction(1, :) = stress(3)
      loads%traction(2, :) = stress(2) + pressure
      call model%solve(loads, displacement, error)
      call checks%no_error(error, "patch test is solved")
      call checks%is_close(maxval(abs(displacement - exact)), 0.0_rk, &
                           1.0e-12_rk*maxval(abs(exact)), "patch test")
      largest = 0.0_rk
      do cell = 1, model%mesh%n_cells
         found = model%elasticity%total_stress(model%displacement_gradient(displacement, cell, &
                                                                           [0.2_rk, 0.3_rk, &
                                                                            0.5_rk]), 0.0_rk)
         largest = max(largest, abs(found(1, 1) - stress(1)), abs(found(2, 2) - stress(2)), &
                       abs(found(1, 2) - stress(3)))
      end do
      call checks%is_close(largest, 0.0_rk, 1.0e-4_rk, "patch test: stress")
   end subroutine patch_test

   !> Two rocks with an interface that edges of the mesh follow: strains that differ by a (x) n,
   !! with one traction on it, and a pore pressure that acts on either by its own coefficient.
   subroutine patch_of_two_rocks(contrast, nu)
      real(rk), intent(in) :: contrast  !< of Young's moduli [-]
      real(rk), intent(in) :: nu(2)
      real(rk), parameter :: interface = -0.5_rk  ! x, left of the crack [m]
      real(rk), parameter :: pore_pressure = 2.0e6_rk, nothing = 0.0_rk
      type(elasticity_t) :: rock(2)
      type(rocks_t) :: rocks
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(recovery_t) :: recovery
      type(energy_error_t) :: estimate
      real(rk), allocatable :: displacement(:, :), exact(:, :)
      real(rk) :: found(2, 2), gradient(2, 2, 2), lack(2), largest, stress(2, 2, 2), total(2, 2)
      integer(ik) :: c, node
      integer :: side

      rock(1) = elasticity_t(4.0e10_rk, nu(1), 0.8_rk, .false.)
      rock(2) = elasticity_t(contrast*4.0e10_rk, nu(2), 0.5_rk, .false.)
      gradient(:, :, 1) = reshape([2.0e-4_rk, 5.0e-4_rk, -1.0e-4_rk, -3.0e-4_rk], [2, 2])
      total = rock(1)%total_stress(gradient(:, :, 1), pore_pressure) &
              - rock(2)%total_stress(gradient(:, :, 1), pore_pressure)
      lack(1) = total(1, 1)/(rock(2)%lame_lambda() + 2.0_rk*rock(2)%shear_modulus())
      lack(2) = total(2, 1)/rock(2)%shear_modulus()
      gradient(:, :, 2) = gradient(:, :, 1)
      gradient(:, 1, 2) = gradient(:, 1, 2) + lack
      do side = 1, 2
         stress(:, :, side) = rock(side)%total_stress(gradient(:, :, side), nothing)
      end do

      mesh = cracked_rectangle([-1.0_rk, 2.0_rk], [0.0_rk, 2.0_rk], [6_ik, 5_ik], 2_ik, 3_ik, 5_ik)
      rocks%elasticity = rock
      rocks%of_cell = [(merge(2_ik, 1_ik, sum(mesh%xy(1, mesh%cell_nodes(:, c)))/3.0_rk &
                              < interface), c=1, mesh%n_cells)]
      call model%set_mesh(mesh, rock(1), error, rocks=rocks)
      call checks%no_error(error, "two rocks")
      call model%prepare(loaded_everywhere(model%mesh), error)
      call checks%no_error(error, "two rocks are set up")
      allocate (exact(2, model%mesh%n_nodes))
      do node = 1, model%mesh%n_nodes
         associate (from => model%mesh%xy(:, node) - [interface, 0.0_rk])
            exact(:, node) = matmul(gradient(:, :, merge(2, 1, from(1) < 0.0_rk)), from)
         end associate
      end do
      loads = no_loads(model%mesh)
      loads%boundary_displacement = exact
      loads%pore_pressure = pore_pressure
      total = rock(1)%total_stress(gradient(:, :, 1), pore_pressure)
      loads%traction(1, :) = total(1, 2)
      loads%traction(2, :) = total(2, 2)
      call model%solve(loads, displacement, error)
      call checks%no_error(error, "two rocks are solved")
      call checks%is_close(maxval(abs(displacement - exact))/maxval(abs(exact)), 0.0_rk, &
                           1.0e-12_rk, "two rocks: displacement")
      largest = 0.0_rk
      do c = 1, model%mesh%n_cells
         side = int(rocks%of_cell(c))
         found = rock(side)%total_stress(model%displacement_gradient(displacement, c, &
                                                                     [0.2_rk, 0.3_rk, 0.5_rk]), &
                                         nothing)
         largest = max(largest, maxval(abs(found - stress(:, :, side))))
      end do
      call checks%is_close(largest/maxval(abs(stress)), 0.0_rk, 1.0e-10_rk, "two rocks: stress")
      ! Recovered stresses are those of either rock up to the interface, where they jump.
      call recover_by_patches(model, displacement, recovery)
      call estimate_error(model, displacement, recovery, estimate)
      call checks%is_close(estimate%relative, 0.0_rk, 1.0e-10_rk, "two rocks: no error")
   end subroutine patch_of_two_rocks

   !> Order 2 in energy, 3 in displacement for a smooth field: phi(z) = psi(z) = exp(z) in
   !! 2 mu (u + i v) = kappa phi - z conj(phi') - conj(psi) is in equilibrium (Muskhelishvili).
   subroutine convergence()
      integer(ik), parameter :: n_meshes = 3
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: energy(n_meshes), norm(n_meshes), points(3, 7), weights(7), values(6), &
                  gradients(2, 6)
      real(rk) :: area_coordinates(3), determinant, difference(2), gradient(2, 2), step(2), order
      real(rk), parameter :: delta = 1.0e-6_rk
      integer(ik) :: level, node, cell, point, j

      call triangle_rule_7(points, weights)
      do level = 1, n_meshes
         mesh = cracked_rectangle([0.0_rk, 1.0_rk], [0.0_rk, 1.0_rk], [2_ik, 2_ik]*2_ik**level, &
                                  1_ik, 1_ik, 0_ik)
         call model%set_mesh(mesh, elasticity_t(1.0_rk, 0.3_rk, 1.0_rk, .false.), error)
         call model%prepare(loaded_everywhere(model%mesh), error)
         loads = no_loads(model%mesh)
         do node = 1, model%mesh%n_nodes
            loads%boundary_displacement(:, node) = smooth(model%elasticity, model%mesh%xy(:, node))
         end do
         call model%solve(loads, displacement, error)
         call checks%no_error(error, "smooth field is solved")
         energy(level) = 0.0_rk
         norm(level) = 0.0_rk
         do cell = 1, model%mesh%n_cells
            associate (nodes => model%mesh%cell_nodes(:, cell))
               do point = 1, 7
                  call evaluate_element(model%mesh%xy(:, nodes), 0_ik, points(:, point), values, &
                                        gradients, &
                                        area_coordinates, determinant)
                  associate (place => matmul(model%mesh%xy(:, nodes), values))
                     difference = matmul(displacement(:, nodes), values) &
                                  - smooth(model%elasticity, place)
                     gradient = matmul(displacement(:, nodes), transpose(gradients))
                     do j = 1, 2
                        step = 0.0_rk
                        step(j) = delta
                        gradient(:, j) = gradient(:, j) - (smooth(model%elasticity, place + step) &
                                                           - smooth(model%elasticity, &
                                                                    place - step))/(2.0_rk*delta)
                     end do
                  end associate
                  norm(level) = norm(level) + weights(point)*determinant*sum(difference**2)
                  energy(level) = energy(level) + weights(point)*determinant &
                                  *0.5_rk*sum(model%elasticity%total_stress(gradient, &
                                                                            0.0_rk)*gradient)
               end do
            end associate
         end do
      end do
      do level = 2, n_meshes
         order = 0.5_rk*log(energy(level - 1)/energy(level))/log(2.0_rk)
         call checks%is_close(order, 2.0_rk, 0.05_rk, "order of convergence in energy")
         order = 0.5_rk*log(norm(level - 1)/norm(level))/log(2.0_rk)
         call checks%is_close(order, 3.0_rk, 0.1_rk, "order of convergence in displacement")
      end do
      print "(a,3es11.3,a,3es11.3)", "energy norm of the error:", sqrt(energy), "   L2 norm:", &
         sqrt(norm)
   end subroutine convergence

   pure function smooth(elasticity, xy) result(displacement)
      type(elasticity_t), intent(in) :: elasticity
      real(rk), intent(in) :: xy(2)
      real(rk) :: displacement(2)
      complex(rk) :: z, value

      z = cmplx(xy(1), xy(2), rk)
      value = (elasticity%kolosov()*exp(z) - z*conjg(exp(z)) &
               - conjg(exp(z)))/(2.0_rk*elasticity%shear_modulus())
      displacement = [real(value, rk), aimag(value)]
   end function smooth

   !> A uniform pore pressure in a fixed box, cracked and with the same fluid pressure times
   !! Biot's coefficient on its faces, moves nothing; the total stress is -biot*p.
   subroutine initial_stress()
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: stress(2, 2), gradient(2, 2)

      mesh = cracked_rectangle([-1.0_rk, 2.0_rk], [0.0_rk, 2.0_rk], [6_ik, 5_ik], 2_ik, 3_ik, 5_ik)
      call model%set_mesh(mesh, elasticity_t(4.0e10_rk, 0.2_rk, 0.8_rk, .false.), error)
      call model%prepare(loaded_everywhere(model%mesh), error)
      loads = no_loads(model%mesh)
      loads%pore_pressure = 7.0e6_rk
      loads%fluid_pressure = 0.8_rk*7.0e6_rk
      call model%solve(loads, displacement, error)
      call checks%no_error(error, "initial stress is solved")
      call checks%is_close(maxval(abs(displacement)), 0.0_rk, 1.0e-17_rk, &
                           "uniform pressure moves nothing")
      gradient = model%displacement_gradient(displacement, 3_ik, [0.2_rk, 0.3_rk, 0.5_rk])
      stress = model%elasticity%total_stress(gradient, 7.0e6_rk)
      call checks%is_close(stress(1, 1), -5.6e6_rk, 1.0e-3_rk, "total stress xx")
      call checks%is_close(stress(2, 2), -5.6e6_rk, 1.0e-3_rk, "total stress yy")
      call checks%is_close(stress(1, 2), 0.0_rk, 1.0e-3_rk, "total stress xy")
   end subroutine initial_stress

   !> p = p0 + g x between fixed walls: (lambda + 2 mu) u'' = biot g, so u = biot g x (x - L)/(2
   !! (lambda + 2 mu)), a quadratic that the elements hold exactly, with quarter-point elements
   !! too where they reproduce x.
   subroutine linear_pressure()
      real(rk), parameter :: slope = 3.0e6_rk
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      real(rk), allocatable :: displacement(:, :), exact(:, :)
      real(rk) :: modulus

      mesh = cracked_rectangle([0.0_rk, 2.0_rk], [0.0_rk, 1.0_rk], [6_ik, 4_ik], 1_ik, 1_ik, 0_ik)
      call model%set_mesh(mesh, elasticity_t(4.0e10_rk, 0.2_rk, 0.8_rk, .false.), error)
      call model%prepare(loaded_everywhere(model%mesh), error)
      loads = no_loads(model%mesh)
      loads%pore_pressure = 1.0e6_rk + slope*model%mesh%xy(1, :model%mesh%n_vertices)
      modulus = model%elasticity%lame_lambda() + 2.0_rk*model%elasticity%shear_modulus()
      allocate (exact(2, model%mesh%n_nodes), source=0.0_rk)
      exact(1, :) = 0.8_rk*slope*model%mesh%xy(1, :)*(model%mesh%xy(1, :) - 2.0_rk)/(2.0_rk*modulus)
      loads%boundary_displacement = exact
      call model%solve(loads, displacement, error)
      call checks%no_error(error, "linear pressure is solved")
      call checks%is_close(maxval(abs(displacement - exact)), 0.0_rk, &
                           1.0e-12_rk*maxval(abs(exact)), "linear pressure")
   end subroutine linear_pressure

   !> Wrong order of calls, and input that makes no sense.
   subroutine refusals()
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      real(rk), allocatable :: displacement(:, :)

      mesh = cracked_rectangle([0.0_rk, 1.0_rk], [0.0_rk, 1.0_rk], [4_ik, 4_ik], 2_ik, 2_ik, 3_ik)
      call model%prepare(loaded_everywhere(model%mesh), error)
      call checks%fails_with(error, "set_mesh", "prepare before set_mesh")
      call model%set_mesh(mesh, elasticity_t(0.0_rk, 0.2_rk, 1.0_rk, .false.), error)
      call checks%fails_with(error, "Young", "no stiffness")
      call model%set_mesh(mesh, elasticity_t(1.0_rk, 0.5_rk, 1.0_rk, .false.), error)
      call checks%fails_with(error, "Poisson", "incompressible")
      call model%set_mesh(mesh, elasticity_t(1.0_rk, 0.2_rk, 1.0_rk, .false.), error)
      loads = no_loads(model%mesh)
      call model%solve(loads, displacement, error)
      call checks%fails_with(error, "prepare", "solve before prepare")
      call model%prepare(loaded_everywhere(model%mesh), error)
      loads%fluid_pressure(1) = ieee_value(1.0_rk, ieee_quiet_nan)
      call model%solve(loads, displacement, error)
      call checks%fails_with(error, "not a finite number", "a pressure that is no number")
      loads = no_loads(model%mesh)
      deallocate (loads%jump)
      call model%solve(loads, displacement, error)
      call checks%fails_with(error, "incomplete", "loads without jumps")
      allocate (loads%jump(2, 3, 1), source=0.0_rk)
      call model%solve(loads, displacement, error)
      call checks%fails_with(error, "wrong array sizes", "loads of another mesh")
   end subroutine refusals

end program test_fine_model
