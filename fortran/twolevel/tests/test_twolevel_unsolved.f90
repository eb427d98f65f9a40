!> Messages of steps that are not solved.
program test_twolevel_unsolved
   use testing_checks, only: checks_t
   use base_kinds, only: ik, rk
   use base_texts, only: text_t
   use coarse_state, only: step_report_t
   use mesh_types, only: fracture_mesh_t, network_t
   use scene_types, only: injection_t
   use twolevel_unsolved, only: why_unsolved
   implicit none(type, external)

   type(checks_t) :: checks
   type(fracture_mesh_t) :: fracture
   type(network_t) :: network
   type(injection_t) :: wells(3)
   type(step_report_t) :: report
   real(rk) :: share(3, 3)

   ! Fracture 'long' has two cells, 'short' has one.
   fracture%n_cells = 3
   fracture%cell_fracture = [1_ik, 1_ik, 2_ik]
   fracture%cell_points = reshape([1_ik, 2_ik, 2_ik, 3_ik, 4_ik, 5_ik], [2, 3])
   fracture%point_xy = reshape([0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 2.0_rk, 0.0_rk, &
                                0.0_rk, 0.5_rk, 0.5_rk, 1.0_rk], [2, 5])
   network%names = [text_t("long"), text_t("short")]
   wells%name = [character(len=len(wells%name)) :: "a", "b", "c"]
   share = reshape([1.0_rk, 0.0_rk, 0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 0.5_rk, 0.5_rk, 0.0_rk], [3, 3])

   report%reason = "it did not converge"
   call says("it did not converge", [0.0_rk, 0.0_rk, 0.0_rk], "no place")
   report%cell = 2
   call says("it did not converge, on fracture 'long' at (1.5, 0) m", [0.0_rk, 0.0_rk, 0.0_rk], &
             "a place")
   report%is_drained = .true.
   report%reason = "a fracture cell has less fluid than is drawn from it"
   call says("fracture 'long' has less fluid at (1.5, 0) m than flows out of it there", &
             [1.0_rk, 2.0_rk, 0.0_rk], "no well draws")
   call says("fracture 'long' has less fluid at (1.5, 0) m than well 'b' extracts: give the "// &
             "well a pressure as its limit, or a smaller rate", [-5.0_rk, -2.0_rk, -3.0_rk], &
             "the well that draws most from the cell")
   call says("fracture 'long' has less fluid at (1.5, 0) m than well 'a' extracts: give the "// &
             "well a pressure as its limit, or a smaller rate", [-5.0_rk, 2.0_rk, 0.0_rk], &
             "the well that draws from the fracture")
   report%cell = 3
   call says("fracture 'short' has less fluid at (0.25, 0.75) m than flows out of it there", &
             [-5.0_rk, -2.0_rk, -3.0_rk], "wells in the other fracture")
   call checks%finish()

contains

   !> Compare a message with the expected one.
   subroutine says(words, rate, name)
      character(len=*), intent(in) :: words, name
      real(rk), intent(in) :: rate(3)  !< [m2/s]

      call checks%is_true(why_unsolved(report, network, fracture, wells, share, rate) == words, &
                          name//": "//why_unsolved(report, network, fracture, wells, share, rate))
   end subroutine says

end program test_twolevel_unsolved
