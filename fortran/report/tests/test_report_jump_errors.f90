!> Relative errors of jumps by the sizes of cells: zones, their ends, kinks.
program test_report_jump_errors
   use base_kinds, only: ik, rk
   use mesh_types, only: fracture_mesh_t, point_interior, point_joint_t, point_tip
   use report_jump_errors, only: finite_volumes, jump_errors_t, relative_jump_errors, unevenness
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks

   call test_crack()
   call test_zone()
   call test_kink()
   call test_crossing()
   call test_unevenness()
   call checks%finish()

contains

   !> A straight fracture along x of cells of length 1, from tip to tip.
   function straight(n) result(mesh)
      integer(ik), intent(in) :: n
      type(fracture_mesh_t) :: mesh
      integer(ik) :: i

      mesh%n_cells = n
      mesh%n_points = n + 1
      mesh%cell_fracture = [(1_ik, i=1, n)]
      mesh%cell_points = reshape([(i, i + 1_ik, i=1, n)], [2_ik, n])
      mesh%cell_s = reshape([(real(i - 1, rk), real(i, rk), i=1, n)], [2_ik, n])
      mesh%point_xy = reshape([(real(i - 1, rk), 0.0_rk, i=1, n + 1)], [2_ik, n + 1])
      mesh%point_kind = [point_tip, [(point_interior, i=2, n)], point_tip]
   end function straight

   !> All cells move: the share of a tip's cell over the distance of the nearer end; the reach is
   !! that of Sneddon's opening, sqrt(a**2 - x**2).
   subroutine test_crack()
      type(jump_errors_t) :: errors
      integer :: i

      errors = relative_jump_errors(straight(10_ik), spread(.true., 1, 10), finite_volumes)
      do i = 1, 10
         associate (d => min(i - 0.5_rk, 10.5_rk - i), x => i - 5.5_rk)
            call checks%is_close(errors%share(i), 0.005_rk + 0.075_rk/d, 1.0e-12_rk, "share")
            call checks%is_close(errors%reach(i), sqrt(25.0_rk - x**2), 1.0e-12_rk, "reach")
         end associate
      end do
      call checks%is_close(errors%of_sum(3), 0.005_rk + 0.075_rk/5.0_rk, 1.0e-12_rk, "sum")
      call checks%is_close(errors%of_slip(1), 0.002_rk + 0.15_rk, 1.0e-12_rk, "slip at the tip")
      call checks%is_close(errors%of_slip(2), 0.002_rk + 0.15_rk/3.0_rk**1.25_rk, 1.0e-12_rk, &
                           "slip next to it")
   end subroutine test_crack

   !> Cells 3 to 6 of 10 move: their ends are known to half a cell, the length of the zone to a
   !! sixth, and slip has its square. Cells that do not move have no reach.
   subroutine test_zone()
      type(jump_errors_t) :: errors
      logical :: moves(10)

      moves = .false.
      moves(3:6) = .true.
      errors = relative_jump_errors(straight(10_ik), moves, finite_volumes)
      call checks%is_close(errors%share(4), 0.005_rk + (1.0_rk + 1.0_rk/6.0_rk)**2 - 1.0_rk, &
                           1.0e-12_rk, "zone")
      call checks%is_close(errors%reach(1), 0.0_rk, 1.0e-15_rk, "at rest")
   end subroutine test_zone

   !> A right angle in the middle, and a joint at one end.
   subroutine test_kink()
      type(fracture_mesh_t) :: mesh
      type(jump_errors_t) :: errors
      integer :: i

      mesh = straight(10_ik)
      do i = 7, 11
         mesh%point_xy(:, i) = [5.0_rk, i - 6.0_rk]
      end do
      mesh%point_kind(11) = point_joint_t
      errors = relative_jump_errors(mesh, spread(.true., 1, 10), finite_volumes)
      associate (of_kink => 0.005_rk + 0.2_rk/5.0_rk)
         call checks%is_close(errors%share(3), of_kink + (0.075_rk + 0.03_rk)/2.5_rk, &
                              1.0e-12_rk, "kink")
         call checks%is_close(errors%share(10), of_kink + 0.15_rk/0.5_rk + 0.03_rk/4.5_rk, &
                              1.0e-12_rk, "joint")
      end associate
   end subroutine test_kink

   !> A cell of another fracture ends in the middle at a right angle: like a kink where it moves.
   subroutine test_crossing()
      type(fracture_mesh_t) :: mesh
      type(jump_errors_t) :: errors

      mesh = straight(10_ik)
      mesh%n_cells = 11
      mesh%n_points = 12
      mesh%cell_fracture = [mesh%cell_fracture, 2_ik]
      mesh%cell_points = reshape([mesh%cell_points, 6_ik, 12_ik], [2, 11])
      mesh%cell_s = reshape([mesh%cell_s, 0.0_rk, 1.0_rk], [2, 11])
      mesh%point_xy = reshape([mesh%point_xy, 5.0_rk, 1.0_rk], [2, 12])
      mesh%point_kind = [mesh%point_kind, point_tip]
      mesh%point_kind(6) = point_joint_t
      errors = relative_jump_errors(mesh, spread(.true., 1, 11), finite_volumes)
      call checks%is_close(errors%share(3), 0.005_rk + 0.2_rk/5.0_rk &
                           + (0.075_rk + 0.03_rk)/2.5_rk, 1.0e-12_rk, "crossing")
      call checks%is_close(errors%kink(5), 0.0_rk, 0.0_rk, "no kink")
      errors = relative_jump_errors(mesh, [spread(.true., 1, 10), .false.], finite_volumes)
      call checks%is_close(errors%share(3), 0.005_rk + 0.075_rk/2.5_rk, 1.0e-12_rk, "at rest")
   end subroutine test_crossing

   !> A linear profile has differences at its ends only.
   subroutine test_unevenness()
      real(rk) :: found(4)

      found = unevenness(straight(4_ik), [1.0_rk, 2.0_rk, 3.0_rk, 4.0_rk])
      call checks%is_close(found(2), 0.0_rk, 1.0e-15_rk, "within")
      call checks%is_close(found(4), 1.0_rk, 1.0e-15_rk, "at the end")
      found = unevenness(straight(4_ik), [0.0_rk, 1.0_rk, 0.0_rk, 1.0_rk])
      call checks%is_close(found(2), 1.0_rk, 1.0e-15_rk, "wavering")
   end subroutine test_unevenness

end program test_report_jump_errors
