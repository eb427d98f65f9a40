!> Forces of an element's volume beside Gauss points of a rule that was not used for them.
program test_fine_loads
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use fine_element, only: collapsed_rule
   use fine_loads, only: fine_loads_t, no_loads, volume_forces
   use fine_mesh, only: build_fine_mesh, fine_mesh_t
   use mesh_types, only: mesh_t
   use sample_meshes, only: cracked_rectangle, rotate_mesh
   use testing_checks, only: checks_t
   implicit none(type, external)
   real(rk), parameter :: biot = 0.7_rk
   type(checks_t) :: checks
   type(mesh_t) :: mesh
   type(fine_mesh_t) :: fine
   type(fine_loads_t) :: loads
   type(error_t), allocatable :: error
   real(rk) :: by_points(2, 6), force(2, 6), worst(2)
   integer(ik) :: cell, v

   mesh = cracked_rectangle([0.0_rk, 4.0_rk], [0.0_rk, 3.0_rk], [4_ik, 3_ik], 1_ik, 2_ik, 3_ik)
   call rotate_mesh(mesh, 0.3_rk, .false.)
   call build_fine_mesh(mesh, fine, error)
   call checks%no_error(error, "a cracked mesh")
   loads = no_loads(fine)
   loads%body_force = [3.0_rk, -2.0_rk]
   do v = 1, fine%n_vertices
      loads%pore_pressure(v) = 1.0_rk + 2.0_rk*fine%xy(1, v) - 0.5_rk*fine%xy(2, v)
      loads%initial_stress(:, v) = [fine%xy(1, v), 4.0_rk - fine%xy(2, v), sum(fine%xy(:, v))]
   end do
   ! Half of the pressure acts as one in each element, as that of temperatures does.
   loads%pore_pressure = 0.5_rk*loads%pore_pressure
   allocate (loads%heat_pressure(3, fine%n_cells))
   do cell = 1, fine%n_cells
      loads%heat_pressure(:, cell) = loads%pore_pressure(fine%cell_nodes(:3, cell))
   end do
   worst = 0.0_rk
   do cell = 1, fine%n_cells
      force = volume_forces(fine, cell, biot, loads)
      call forces_by_points(cell, by_points)
      associate (kind => merge(2, 1, fine%tip_corner(cell) > 0))
         worst(kind) = max(worst(kind), maxval(abs(force - by_points))/maxval(abs(by_points)))
      end associate
   end do
   call checks%is_close(worst(1), 0.0_rk, 1.0e-13_rk, "forces of ordinary elements")
   call checks%is_close(worst(2), 0.0_rk, 1.0e-13_rk, "forces of elements at tips")
   call checks%finish()

contains

   !> The integrals of b N - s0 grad N by six by six points.
   subroutine forces_by_points(cell, force)
      integer(ik), intent(in) :: cell
      real(rk), intent(out) :: force(2, 6)
      integer(ik), parameter :: n = 6
      real(rk) :: points(3, n*n), weights(n*n), stress(3), place(2)
      real(rk) :: values(6), gradients(2, 6), area_coordinates(3), determinant, weight
      integer(ik) :: k, point

      force = 0.0_rk
      call collapsed_rule(max(1_ik, fine%tip_corner(cell)), n, n, points, weights)
      do point = 1, n*n
         call fine%evaluate(cell, points(:, point), values, gradients, area_coordinates, &
                            determinant)
         weight = weights(point)*determinant
         place = matmul(fine%xy(:, fine%cell_nodes(:, cell)), values)
         stress = [place(1), 4.0_rk - place(2), sum(place)]
         stress(:2) = stress(:2) - biot*(1.0_rk + 2.0_rk*place(1) - 0.5_rk*place(2))
         do k = 1, 6
            force(:, k) = force(:, k) + weight*(loads%body_force*values(k) &
                                                - [dot_product(stress([1, 3]), gradients(:, k)), &
                                                   dot_product(stress([3, 2]), gradients(:, k))])
         end do
      end do
   end subroutine forces_by_points

end program test_fine_loads
