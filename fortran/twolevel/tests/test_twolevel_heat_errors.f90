!> Blurred temperatures: the heat is the same, uniform temperatures stay, none leaves the range of
!! those before, and the heat of one row of triangles at a side moves as in the closed form.
program test_twolevel_heat_errors
   use base_kinds, only: ik, rk
   use mesh_geometry, only: cell_area, cell_centre
   use mesh_types, only: mesh_t
   use testing_checks, only: checks_t
   use twolevel_heat_errors, only: blurred
   implicit none(type, external)

   integer(ik), parameter :: columns = 24, rows = 6
   type(checks_t) :: checks
   type(mesh_t) :: mesh
   real(rk) :: after(2*columns*rows), area(2*columns*rows), before(2*columns*rows), depth(2)
   integer(ik) :: c

   mesh = equilateral()
   area = [(cell_area(mesh, c), c=1, mesh%n_cells)]
   before = 7.0_rk
   call checks%is_close(maxval(abs(blurred(mesh, before) - 7.0_rk)), 0.0_rk, 1.0e-14_rk, "uniform")
   call random_number(before)
   after = blurred(mesh, before)
   call checks%is_close(sum(area*after), sum(area*before), 1.0e-12_rk*sum(area), "heat")
   call checks%is_true(all(after >= minval(before) .and. after <= maxval(before)), "range")

   ! The cells with a face on the lower side, away from the ends of the row.
   before = 0.0_rk
   do c = 1, mesh%n_cells
      associate (xy => cell_centre(mesh, c))
         if (xy(2) < 0.5_rk .and. abs(xy(1) - 0.5_rk*columns) < 8.0_rk) before(c) = 1.0_rk
      end associate
   end do
   depth = [moment(before), moment(blurred(mesh, before))]
   call checks%is_close(depth(1), 1.0_rk/3.0_rk, 1.0e-12_rk, "a third of the height")
   call checks%is_close(depth(2) - depth(1), 0.296_rk, 5.0e-3_rk, "farther by the blurring")
   call checks%finish()

contains

   !> Mean depth of the heat in the heights of triangles.
   real(rk) function moment(means)
      real(rk), intent(in) :: means(:)
      integer(ik) :: i
      real(rk) :: xy(2)

      moment = 0.0_rk
      do i = 1, mesh%n_cells
         xy = cell_centre(mesh, i)
         moment = moment + area(i)*means(i)*xy(2)
      end do
      moment = moment/sum(area*means)/(0.5_rk*sqrt(3.0_rk))
   end function moment

   !> Rows of equilateral triangles with sides of 1, shifted by half of one from row to row.
   function equilateral() result(lattice)
      type(mesh_t) :: lattice
      integer(ik) :: i, j, n

      lattice%n_nodes = (columns + 1)*(rows + 1)
      lattice%n_cells = 2*columns*rows
      allocate (lattice%xy(2, lattice%n_nodes), lattice%cell_nodes(3, lattice%n_cells))
      n = 0
      do j = 0, rows
         do i = 0, columns
            n = n + 1
            lattice%xy(:, n) = [i + 0.5_rk*modulo(j, 2_ik), 0.5_rk*sqrt(3.0_rk)*j]
         end do
      end do
      n = 0
      do j = 1, rows
         do i = 1, columns
            associate (a => (j - 1)*(columns + 1) + i, b => j*(columns + 1) + i)
               if (modulo(j, 2_ik) == 1) then
                  lattice%cell_nodes(:, n + 1) = [a, a + 1, b]
                  lattice%cell_nodes(:, n + 2) = [a + 1, b + 1, b]
               else
                  lattice%cell_nodes(:, n + 1) = [a, a + 1, b + 1]
                  lattice%cell_nodes(:, n + 2) = [a, b + 1, b]
               end if
            end associate
            n = n + 2
         end do
      end do
   end function equilateral

end program test_twolevel_heat_errors
