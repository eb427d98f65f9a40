!> Which cells a well feeds: the one whose middle is nearest, two that are equally near half each,
!! all of a fracture by their lengths.
program test_twolevel_wells
   use testing_checks, only: checks_t
   use base_kinds, only: ik, rk
   use mesh_types, only: fracture_mesh_t
   use scene_types, only: injection_t
   use twolevel_wells, only: between_cells, share_wells
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
   call checks%finish()

end program test_twolevel_wells
