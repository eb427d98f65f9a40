!> Fluid pressure on the faces of windows: linear between the middles of the coarse cells, and with
!! the logarithm of the distance near a tip that lies within its cell.
program test_twolevel_pressure
   use base_kinds, only: ik, rk
   use coarse_tip_layer, only: mean_pressure_shape, pressure_shape
   use fine_mesh, only: fine_mesh_t
   use mesh_types, only: mesh_t
   use testing_checks, only: checks_t
   use twolevel_pressure, only: match_pressure, pressure_map_t
   implicit none(type, external)

   integer(ik), parameter :: n = 10  !< coarse cells, from s = 0 to 1 m
   !> positions within the first and the last cell [m]
   real(rk), parameter :: tip(2) = [0.03_rk, 0.96_rk]
   type(checks_t) :: checks
   type(mesh_t) :: coarse
   type(fine_mesh_t) :: fine

   call make_meshes()
   call test_linear()
   call test_logarithm()
   call test_viscous()
   call test_limits()
   call test_other_tips()
   call test_reached_cell()
   call checks%finish()

contains

   !> One fracture; the window contains all of it in 93 cells.
   subroutine make_meshes()
      integer(ik), parameter :: n_fine = 93
      integer(ik) :: i

      coarse%fracture%n_cells = n
      allocate (coarse%fracture%cell_fracture(n), source=1_ik)
      coarse%fracture%cell_s = reshape([(0.1_rk*(i - 1), 0.1_rk*i, i=1, n)], [2_ik, n])
      fine%fracture%n_cells = n_fine
      allocate (fine%fracture%cell_fracture(n_fine), source=1_ik)
      fine%fracture%cell_s = reshape([(tip(1) + 0.01_rk*(i - 1), tip(1) + 0.01_rk*i, &
                                       i=1, n_fine)], [2_ik, n_fine])
      fine%face_s = fine%fracture%cell_s
      fine%fracture%n_tips = 2
      fine%fracture%tip_fracture = [1_ik, 1_ik]
      fine%fracture%tip_end = [1_ik, 2_ik]
   end subroutine make_meshes

   !> Middle of the part of a coarse cell that lies behind its tip [m].
   pure real(rk) function middle(j)
      integer(ik), intent(in) :: j

      middle = 0.5_rk*(max(coarse%fracture%cell_s(1, j), tip(1)) &
                       + min(coarse%fracture%cell_s(2, j), tip(2)))
   end function middle

   !> Far from the tips.
   subroutine test_linear()
      type(pressure_map_t) :: map
      real(rk) :: found(fine%fracture%n_cells), s
      integer(ik) :: i, j

      map = match_pressure(fine, coarse, spread(.true., 1, n))
      found = map%on_faces([(1.0e6_rk + 3.0e6_rk*middle(j), j=1, n)], 0.0_rk)
      do i = 1, fine%fracture%n_cells
         s = 0.5_rk*sum(fine%face_s(:, i))
         if (s < middle(2_ik) .or. s > middle(n - 1)) cycle
         call checks%is_close(found(i), 1.0e6_rk + 3.0e6_rk*s, 1.0e-6_rk, "linear")
      end do
   end subroutine test_linear

   !> A tip at the end of a cell, by rounding in the next one: pressures are finite, and those of a
   !! tip that lies before the end.
   subroutine test_reached_cell()
      type(pressure_map_t) :: map
      type(mesh_t) :: moved
      real(rk) :: before(fine%fracture%n_cells), found(fine%fracture%n_cells), last
      real(rk) :: pressure(n)
      integer(ik) :: i, k

      pressure = [(1.0e6_rk*i**2, i=1, n)]
      do k = -1, 1
         moved = coarse
         ! The last cell begins at the tip, within rounding of its coordinate.
         last = tip(2) + k*spacing(tip(2))
         moved%fracture%cell_s(2, n - 1) = last
         moved%fracture%cell_s(1, n) = last
         map = match_pressure(fine, moved, spread(.true., 1, n))
         found = map%on_faces(pressure, 0.0_rk)
         if (k == -1) before = found
         call checks%is_close(maxval(abs(found - before)), 0.0_rk, 1.0_rk, "a cell just reached")
      end do
   end subroutine test_reached_cell

   !> Near either tip: the mean of ln d with the weight 1/sqrt(d), by the midpoint rule in sqrt(d).
   subroutine test_logarithm()
      integer, parameter :: points = 20000
      type(pressure_map_t) :: map
      real(rk) :: d(2), found(fine%fracture%n_cells), mean, root
      integer(ik) :: end, i, j
      integer :: k

      map = match_pressure(fine, coarse, spread(.true., 1, n))
      do end = 1, 2
        found = map%on_faces([(1.0e7_rk + 1.0e6_rk*log(abs(middle(j) - tip(end))), j=1, n)], 0.0_rk)
         do i = 1, fine%fracture%n_cells
            d = abs(fine%face_s(:, i) - tip(end))
            if (0.5_rk*sum(d) > abs(middle(merge(2_ik, n - 1, end == 1)) - tip(end))) cycle
            mean = 0.0_rk
            do k = 1, points
               root = sqrt(minval(d)) + (sqrt(maxval(d)) - sqrt(minval(d)))*(k - 0.5_rk)/points
               mean = mean + 2.0_rk*log(root)/points
            end do
            call checks%is_close(found(i), 1.0e7_rk + 1.0e6_rk*mean, 200.0_rk, "logarithm")
         end do
      end do
   end subroutine test_logarithm

   !> Near a tip where viscosity has an effect at the scale of the cells: that pressure.
   subroutine test_viscous()
      real(rk), parameter :: b = 60.0_rk  ! [1/m^(1/2)]
      type(pressure_map_t) :: map
      real(rk) :: d(2), found(fine%fracture%n_cells), viscous(n)
      integer(ik) :: end, i, j

      map = match_pressure(fine, coarse, spread(.true., 1, n))
      do end = 1, 2
         viscous = 0.0_rk
         viscous(merge(1_ik, n, end == 1)) = b
         found = map%on_faces([(1.0e7_rk + 1.0e6_rk*pressure_shape(b, abs(middle(j) - tip(end))), &
                                j=1, n)], 0.0_rk, viscous=viscous)
         do i = 1, fine%fracture%n_cells
            d = abs(fine%face_s(:, i) - tip(end))
            if (0.5_rk*sum(d) > abs(middle(merge(2_ik, n - 1, end == 1)) - tip(end))) cycle
            call checks%is_close(found(i), 1.0e7_rk + 1.0e6_rk*mean_pressure_shape(b, d), &
                                 10.0_rk, "viscous")
         end do
      end do
   end subroutine test_viscous

   !> No pressure below what the fluid bears, and none that rises toward the tip beyond the last
   !! middle.
   subroutine test_limits()
      type(pressure_map_t) :: map
      real(rk) :: found(fine%fracture%n_cells)
      integer(ik) :: j

      map = match_pressure(fine, coarse, spread(.true., 1, n))
      found = map%on_faces([(1.0e6_rk*j, j=1, n)], 5.0e5_rk)
      call checks%is_close(minval(found), 5.0e5_rk, 0.0_rk, "lowest pressure")
      call checks%is_close(maxval(found), 1.0e6_rk*n, 1.0e-6_rk, "highest pressure")
   end subroutine test_limits

   !> In cells that growth has not added, or at a tip beyond the coarse fracture, the pressure of
   !! the last cell.
   subroutine test_other_tips()
      type(pressure_map_t) :: map
      type(fine_mesh_t) :: longer
      real(rk) :: found(fine%fracture%n_cells)
      integer(ik) :: j

      map = match_pressure(fine, coarse, spread(.false., 1, n))
      found = map%on_faces([(1.0e6_rk*(n - j), j=1, n)], -1.0e9_rk)
      call checks%is_close(minval(found), 0.0_rk, 0.0_rk, "a tip that has not grown")
      longer = fine
      longer%fracture%cell_s = longer%fracture%cell_s + 0.1_rk
      longer%face_s = longer%fracture%cell_s
      map = match_pressure(longer, coarse, spread(.true., 1, n))
      found = map%on_faces([(1.0e6_rk*(n - j), j=1, n)], -1.0e9_rk)
      call checks%is_close(minval(found), 0.0_rk, 0.0_rk, "a tip beyond the coarse fracture")
   end subroutine test_other_tips

end program test_twolevel_pressure
