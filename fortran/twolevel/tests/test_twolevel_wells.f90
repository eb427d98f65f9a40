!> Cells that a well supplies: the cell whose middle is nearest, half each of two that are equally
!! near, all of a fracture by their lengths; and the cells after a joint has divided them.
program test_twolevel_wells
   use base_kinds, only: ik, rk
   use mesh_types, only: fracture_mesh_t
   use scene_types, only: injection_t
   use testing_checks, only: checks_t
   use twolevel_wells, only: between_cells, share_wells, transfer_shares
   implicit none(type, external)

   type(checks_t) :: checks
   type(fracture_mesh_t) :: fracture
   type(injection_t) :: wells(3)
   real(rk), allocatable :: share(:, :)
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
   wells%at_point = [.true., .true., .false.]
   wells%x = [1.0_rk + 1.0e-12_rk, 2.6_rk, 0.0_rk]
   wells%y = 0.0_rk
   call share_wells(wells, fracture, share)
   call checks%is_close(maxval(abs(share(:, 1) - [0.5_rk, 0.5_rk, 0.0_rk])), 0.0_rk, 0.0_rk, &
                        "between two cells")
   call checks%is_close(maxval(abs(share(:, 2) - [0.0_rk, 0.0_rk, 1.0_rk])), 0.0_rk, 0.0_rk, &
                        "in a cell")
   call checks%is_close(maxval(abs(share(:, 3) - [0.25_rk, 0.25_rk, 0.5_rk])), 0.0_rk, &
                        1.0e-15_rk, "along a fracture")
   call checks%is_true(all(between_cells(wells, share) .eqv. [.true., .false., .false.]), &
                       "which stand between cells")
   call test_transfer()
   call checks%finish()

contains

   !> A joint divides the last cell at 2.5, and moves the node at 1 to 1.2: each well supplies the
   !! same cells, the well in the last cell the part that contains it.
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
      shares = transfer_shares(wells, fracture, after, share)
      call checks%is_close(maxval(abs(shares(:, 1) - [1.0_rk, 0.0_rk, 0.0_rk, 0.0_rk])), 0.0_rk, &
                           0.0_rk, "no longer between two cells")
      call checks%is_close(maxval(abs(shares(:, 2) - [0.0_rk, 0.0_rk, 0.0_rk, 1.0_rk])), 0.0_rk, &
                           0.0_rk, "in a part of a cell")
      call checks%is_close(maxval(abs(shares(:, 3) - [0.3_rk, 0.2_rk, 0.125_rk, 0.375_rk])), &
                           0.0_rk, 1.0e-15_rk, "along the fracture as before")
   end subroutine test_transfer

end program test_twolevel_wells
