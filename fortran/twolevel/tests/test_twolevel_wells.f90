!> Cells that a well supplies: those whose middles are on both sides of its point, that of a tip
!! alone, or a joint; all of a fracture by their lengths; and the cells after a joint has divided
!! them.
program test_twolevel_wells
   use base_kinds, only: ik, rk
   use coarse_joints, only: joints_t
   use mesh_types, only: fracture_mesh_t
   use scene_types, only: injection_t
   use testing_checks, only: checks_t
   use twolevel_wells, only: place_wells, share_wells, transfer_shares
   implicit none(type, external)

   real(rk), parameter :: nearly = 1.0e-9_rk  !< share of the cell at a joint
   type(checks_t) :: checks
   type(fracture_mesh_t) :: fracture
   type(injection_t) :: wells(5)
   type(joints_t) :: joints
   real(rk), allocatable :: joint_share(:, :), path(:, :), share(:, :)
   integer(ik) :: i

   ! Cells from 0 to 1, 1 to 2 and 2 to 4 along x.
   fracture%n_cells = 3
   fracture%n_points = 4
   fracture%point_xy = reshape([0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 2.0_rk, 0.0_rk, 4.0_rk, 0.0_rk], &
                               [2, 4])
   fracture%cell_points = reshape([(i, i + 1_ik, i=1, 3)], [2, 3])
   fracture%cell_s = reshape([0.0_rk, 1.0_rk, 1.0_rk, 2.0_rk, 2.0_rk, 4.0_rk], [2, 3])
   fracture%cell_fracture = [1_ik, 1_ik, 1_ik]
   wells%fracture = 1_ik
   wells%at_point = [.true., .true., .true., .true., .false.]
   wells%x = [1.0_rk + 1.0e-12_rk, 2.6_rk, 3.5_rk, 0.8_rk, 0.0_rk]
   wells%y = 0.0_rk
   call share_wells(wells, fracture, share)
   call checks%is_close(maxval(abs(share(:, 5) - [0.25_rk, 0.25_rk, 0.5_rk])), 0.0_rk, &
                        1.0e-15_rk, "along a fracture")
   call place(0.0_rk)
   call check(1_ik, [0.5_rk, 0.5_rk, 0.0_rk], [0.25_rk, 0.25_rk, 0.0_rk], "between two cells")
   associate (t => 0.4_rk/1.5_rk)
      call check(2_ik, [0.0_rk, t, 1.0_rk - t], t*(1.0_rk - t)*[0.0_rk, 1.0_rk, 1.0_rk], "nearer")
   end associate
   call check(3_ik, [0.0_rk, 0.0_rk, 1.0_rk], [0.0_rk, 0.0_rk, 0.5_rk], "towards a tip")
   call check(5_ik, [0.25_rk, 0.25_rk, 0.5_rk], [0.0_rk, 0.0_rk, 0.0_rk], "along a fracture")
   call place(1.0e-5_rk)
   call check(2_ik, [0.0_rk, 0.4_rk/1.5_rk, 1.1_rk/1.5_rk], &
              0.44_rk/1.5_rk**2*[0.0_rk, 1.0_rk, 1.0_rk], "not at the tip that grows")
   wells(2)%x = 1.8_rk
   call place(1.0e-5_rk)
   call check(2_ik, [0.0_rk, 1.0_rk, 0.0_rk], [0.0_rk, 0.6_rk, 0.0_rk], "before a tip that grows")
   joints%n = 1
   joints%point = [2_ik]
   joints%is_outlet = [.false.]
   call place(0.0_rk)
   call check(1_ik, [0.0_rk, nearly, 0.0_rk], [0.0_rk, 1.0_rk - nearly, 0.0_rk], "at a joint")
   call check(4_ik, [0.4_rk, 0.0_rk, 0.0_rk], [0.6_rk, 0.0_rk, 0.0_rk], "next to a joint")
   call checks%is_close(maxval(abs(joint_share(1, :) - [1.0_rk - nearly, 0.0_rk, 0.0_rk, 0.6_rk, &
                                                        0.0_rk])), 0.0_rk, 1.0e-15_rk, "joint")
   joints%point = [1_ik]
   joints%is_outlet = [.true.]
   wells(4)%x = 0.2_rk
   call place(0.0_rk)
   call check(4_ik, [0.4_rk, 0.0_rk, 0.0_rk], [0.6_rk, 0.0_rk, 0.0_rk], "next to an outlet")
   call share_wells(wells, fracture, share)
   call test_transfer()
   call checks%finish()

contains

   !> Place the wells while the last cell has a tip, grown with this roughness.
   subroutine place(roughness)
      real(rk), intent(in) :: roughness  !< [m]

      call place_wells(wells, fracture, joints, [0.0_rk, 0.0_rk, roughness], share, joint_share, &
                       path)
   end subroutine place

   subroutine check(w, of_share, of_path, what)
      integer(ik), intent(in) :: w
      real(rk), intent(in) :: of_share(3), of_path(3)
      character(*), intent(in) :: what

      call checks%is_close(maxval(abs(share(:, w) - of_share)), 0.0_rk, 1.0e-15_rk, what)
      call checks%is_close(maxval(abs(path(:, w) - of_path)), 0.0_rk, 1.0e-15_rk, what//": way")
   end subroutine check

   !> A joint divides the last cell at 2.5, and moves the node at 1 to 1.2: a well supplies the same
   !! part of the fracture.
   subroutine test_transfer()
      type(fracture_mesh_t) :: after
      real(rk), allocatable :: shares(:, :)

      after = fracture
      after%n_cells = 4
      after%n_points = 5
      after%point_xy = reshape([0.0_rk, 0.0_rk, 1.2_rk, 0.0_rk, 2.0_rk, 0.0_rk, 2.5_rk, 0.0_rk, &
                                4.0_rk, 0.0_rk], [2, 5])
      after%cell_points = reshape([(i, i + 1_ik, i=1, 4)], [2, 4])
      after%cell_s = reshape([0.0_rk, 1.2_rk, 1.2_rk, 2.0_rk, 2.0_rk, 2.5_rk, 2.5_rk, 4.0_rk], &
                             [2, 4])
      after%cell_fracture = [1_ik, 1_ik, 1_ik, 1_ik]
      shares = transfer_shares(fracture, after, share)
      call checks%is_close(maxval(abs(shares(:, 5) - [0.3_rk, 0.2_rk, 0.125_rk, 0.375_rk])), &
                           0.0_rk, 1.0e-15_rk, "along the fracture as before")
   end subroutine test_transfer

end program test_twolevel_wells
