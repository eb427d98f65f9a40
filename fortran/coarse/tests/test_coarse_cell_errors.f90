!> Estimated errors of the cells: nothing where displacement and pressure are linear, also next to
!! fractures; of first order, and no less than the true ones, where they are smooth; sizes that
!! bring the error to a given one.
program test_coarse_cell_errors
   use base_kinds, only: ik, pi, rk
   use coarse_cell_errors, only: cell_errors, rock_fields, rock_fields_t, sizes_for
   use coarse_fields, only: corner_tractions
   use coarse_matrix, only: matrix_t
   use coarse_regions, only: regions_t
   use coarse_rock, only: rock_t
   use mesh_geometry, only: cell_area
   use mesh_types, only: mesh_t
   use sample_bodies, only: boxes, cell_centre, linear_unknowns, load_sides, mesh_square, &
                            porous_body, prepare, shake, straight_network
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: dt = 1.0e6_rk, moved = 1.0e-5_rk, pressed = 1.0e6_rk
   type(checks_t) :: checks
   type(scene_t) :: scene
   type(mesh_t) :: body

   call test_linear()
   call test_smooth()
   call test_sizes()
   call checks%finish()

contains

   !> Estimated squares of the errors of given unknowns, and the fields.
   subroutine evaluate(scene, mesh, unknowns, rock, fields, squares, energy)
      type(scene_t), intent(in) :: scene
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: unknowns(:, :)
      type(rock_t), intent(out) :: rock
      type(rock_fields_t), intent(out) :: fields
      real(rk), intent(out) :: squares(:), energy
      type(rock_fields_t) :: nothing
      type(regions_t) :: regions
      type(matrix_t) :: matrix
      real(rk), allocatable :: tractions(:)

      call prepare(checks, mesh, scene, rock, regions, matrix)
      call corner_tractions(regions, unknowns, tractions)
      call rock_fields(mesh, rock, regions, unknowns, tractions, fields)
      nothing = fields
      nothing%nodal = 0.0_rk
      nothing%strain = 0.0_rk
      nothing%slope = 0.0_rk
      call cell_errors(mesh, rock, nothing, fields, dt, squares, energy)
   end subroutine evaluate

   !> Uniform stress, and linear pressure without flow through bottom and top.
   subroutine test_linear()
      type(rock_t) :: rock
      type(rock_fields_t) :: fields
      real(rk), parameter :: gradient(2, 2) = reshape([2.0e-4_rk, 9.0e-4_rk, -1.0e-4_rk, &
                                                       -3.0e-4_rk], [2, 2])
      real(rk) :: energy, shear, trace
      real(rk), allocatable :: squares(:)

      call mesh_square(checks, straight_network(reshape([0.5_rk, 0.7_rk, 1.4_rk, 1.2_rk], &
                                                        [2, 2, 1])), 0.25_rk, 0.4_rk, body)
      scene = porous_body()
      shear = scene%material%young/(2.0_rk*(1.0_rk + scene%material%poisson))
      trace = 2.0_rk*shear*scene%material%poisson/(1.0_rk - 2.0_rk*scene%material%poisson) &
              *(gradient(1, 1) + gradient(2, 2))
      call load_sides(scene, [2.0_rk*shear*gradient(1, 1) + trace, &
                              2.0_rk*shear*gradient(2, 2) + trace, &
                              shear*(gradient(1, 2) + gradient(2, 1))])
      allocate (squares(body%n_cells))
      call evaluate(scene, body, linear_unknowns(body, [0.0_rk, 0.0_rk], gradient, 0.0_rk, &
                                                 [0.0_rk, 0.0_rk]), rock, fields, squares, energy)
      call checks%is_true(energy > 0.0_rk, "uniform stress has an energy")
      call checks%is_close(sum(squares), 0.0_rk, 1.0e-20_rk*energy, "uniform stress: no error")
      body = boxes(4_ik)
      call shake(body)
      scene = porous_body()
      scene%material%biot = 0.0_rk
      scene%sides([1, 2])%pressure_given = .true.
      scene%sides([1, 2])%pressure = [3.0e6_rk, 1.0e6_rk]
      deallocate (squares)
      allocate (squares(body%n_cells))
      call evaluate(scene, body, linear_unknowns(body, [0.0_rk, 0.0_rk], 0.0_rk*gradient, &
                                                 3.0e6_rk, [-1.0e6_rk, 0.0_rk]), rock, fields, &
                    squares, energy)
      call checks%is_close(energy, 2.0_rk*dt*1.0e12_rk*scene%material%permeability_xx &
                           /scene%fluid%viscosity, 1.0e-10_rk*energy, "work of a uniform flow")
      call checks%is_close(sum(squares), 0.0_rk, 1.0e-20_rk*energy, "uniform flow: no error")
   end subroutine test_linear

   !> u_x = sin(pi x/2)**2 sin(pi y/2)**2 and p = cos(pi x/2) cos(pi y/2), which need no forces or
   !! fluxes on sides that are held. Expected: estimate and error of first order (4 +- 15 % between
   !! meshes, of squares), the estimate 1 to 3 times the error.
   subroutine test_smooth()
      type(rock_t) :: rock
      type(rock_fields_t) :: fields
      real(rk) :: energy, estimate(3), true(3)
      real(rk), allocatable :: squares(:), unknowns(:, :)
      integer(ik) :: c, k

      scene = porous_body()
      do k = 1, 4
         scene%sides(k)%displacement_given = .true.
      end do
      do k = 1, 3
         body = boxes(8_ik*2_ik**(k - 1))
         allocate (unknowns(3, body%n_cells), squares(body%n_cells))
         do c = 1, body%n_cells
            unknowns(:, c) = exact(cell_centre(body, c))
         end do
         call evaluate(scene, body, unknowns, rock, fields, squares, energy)
         estimate(k) = sum(squares)
         true(k) = true_error(scene, fields)
         deallocate (unknowns, squares)
      end do
      do k = 2, 3
         call checks%is_close(estimate(k - 1)/estimate(k), 4.0_rk, 0.6_rk, "order of the estimate")
         call checks%is_close(true(k - 1)/true(k), 4.0_rk, 0.6_rk, "order of the error")
      end do
      call checks%is_true(all(estimate >= true), "the estimate covers the error")
      call checks%is_true(all(estimate <= 9.0_rk*true), "by a factor of at most 3")
   end subroutine test_smooth

   !> Displacement [m] and pressure [Pa].
   pure function exact(x) result(values)
      real(rk), intent(in) :: x(2)  !< [m]
      real(rk) :: values(3)

      associate (a => 0.5_rk*pi*x)
         values = [moved*(sin(a(1))*sin(a(2)))**2, 0.0_rk, pressed*cos(a(1))*cos(a(2))]
      end associate
   end function exact

   !> Squared error of strains and slopes of the pressure at the middles of the corners' quarters.
   function true_error(scene, fields) result(square)
      type(scene_t), intent(in) :: scene
      type(rock_fields_t), intent(in) :: fields
      real(rk) :: square
      real(rk) :: difference(2, 2), flow(2), place(2), slope(2), strain(2, 2), lame, shear
      integer(ik) :: c, k

      associate (e => scene%material%young, nu => scene%material%poisson)
         shear = e/(2.0_rk*(1.0_rk + nu))
         lame = 2.0_rk*shear*nu/(1.0_rk - 2.0_rk*nu)
      end associate
      square = 0.0_rk
      do c = 1, body%n_cells
         do k = 1, 3
            ! The middle of the quarter with the corner, two middles of edges and the centre.
            place = (7.0_rk*body%xy(:, body%cell_nodes(k, c)) + 15.0_rk*cell_centre(body, c)) &
                    /22.0_rk
            associate (a => 0.5_rk*pi*place)
               strain = 0.0_rk
               strain(1, 1) = 0.5_rk*pi*moved*sin(2.0_rk*a(1))*sin(a(2))**2
               strain(1, 2) = 0.25_rk*pi*moved*sin(2.0_rk*a(2))*sin(a(1))**2
               strain(2, 1) = strain(1, 2)
               slope = -0.5_rk*pi*pressed*[sin(a(1))*cos(a(2)), cos(a(1))*sin(a(2))]
            end associate
            difference = 0.5_rk*(fields%strain(:, :, k, c) + transpose(fields%strain(:, :, k, c))) &
                         - strain
            flow = fields%slope(:, k, c) - slope
            square = square + cell_area(body, c)/6.0_rk &
                     *(2.0_rk*shear*sum(difference**2) &
                       + lame*(difference(1, 1) + difference(2, 2))**2 &
                       + dt*scene%material%permeability_xx/scene%fluid%viscosity*sum(flow**2))
         end do
      end do
   end function true_error

   !> With squares that are of fourth order in the size of cells, 1/change**2 cells replace each.
   subroutine test_sizes()
      real(rk), parameter :: squares(3) = [1.0_rk, 2.0_rk, 3.0_rk], total = 1.0_rk
      real(rk) :: change(3), cells(3)

      change = sizes_for(squares, total)
      cells = 1.0_rk/change**2
      call checks%is_close(sum(squares*change**4*cells), total, 1.0e-14_rk, "wanted error")
      call checks%is_close(maxval(squares*change**4) - minval(squares*change**4), 0.0_rk, &
                           1.0e-14_rk, "the same in each cell")
      call checks%is_close(minval(sizes_for([0.0_rk, 1.0e9_rk], total)), 0.25_rk, 1.0e-14_rk, &
                           "cells shrink to a quarter at most")
      call checks%is_close(maxval(sizes_for([0.0_rk, 1.0e-9_rk], total)), 4.0_rk, 1.0e-14_rk, &
                           "and grow by a factor of four at most")
   end subroutine test_sizes

end program test_coarse_cell_errors
