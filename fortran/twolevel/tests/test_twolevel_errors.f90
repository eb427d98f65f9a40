!> Stated errors of length and pressure: exact for a crack whose K_eq/K_IC and pressure are linear
!! in its length, and for a pressure with a constant second derivative in time before growth.
program test_twolevel_errors
   use base_kinds, only: rk
   use testing_checks, only: checks_t
   use twolevel_errors, only: by_flow, stated_errors_t, tip_excess_t
   implicit none(type, external)

   type(checks_t) :: checks

   call test_growth()
   call test_bent()
   call test_viscous()
   call test_onset()
   call test_steps()
   call checks%finish()

contains

   !> K_eq/K_IC decreases by 5 per metre at either of two tips, the pressure by 1e6 Pa per metre of
   !! length. With an error of 1 % of K_eq the error of a tip is 2 mm, that of the pressure 4 kPa; a
   !! tenth of the cells of 10 mm adds 1 mm each and, with half of the fluid leaked off, half of
   !! that, and 1 % of the pressure rise of 3e6 Pa on 0.2 m. Layers and cells add .75 %.
   subroutine test_growth()
      type(stated_errors_t) :: stated_errors

      call stated_errors%begin_step()
      call stated_errors%see_try(0.19_rk, 3.01e6_rk, 2)
      call stated_errors%see_try(0.2_rk, 3.0e6_rk, 2)
      call stated_errors%see_try(0.201_rk, 2.0e6_rk, 1)  ! a joint opens
      call accept(stated_errors, [.true., .true.])
      call checks%is_close(stated_errors%length, 7.0e-3_rk, 1.0e-12_rk, "length")
      call checks%is_close(stated_errors%pressure, 7.0e3_rk + 0.0175_rk*3.0e6_rk, 1.0e-3_rk, &
                           "pressure")
      ! The error of a stopped tip stays.
      call accept(stated_errors, [.false., .false.])
      call checks%is_close(stated_errors%length, 7.0e-3_rk, 1.0e-12_rk, "length at rest")

   end subroutine test_growth

   subroutine accept(stated_errors, grows)
      type(stated_errors_t), intent(inout) :: stated_errors
      logical, intent(in) :: grows(2)

      call stated_errors%accept(1.0_rk, 3.0e6_rk, &
                                [tip_excess_t(grows(1), 0.01_rk, -5.0_rk, 0.01_rk), &
                                 tip_excess_t(grows(2), 0.01_rk, -5.0_rk, 0.01_rk)], &
                                0.2_rk, 3.0e6_rk, 0.5_rk, 10.0_rk)
   end subroutine accept

   !> Wings of 0.5 and 4 cells of 10 mm at 30 degrees to their fractures: half of a cell, and half
   !! of that.
   subroutine test_bent()
      type(stated_errors_t) :: stated_errors

      call stated_errors%accept(1.0_rk, 3.0e6_rk, [tip_excess_t(.true., 0.0_rk, -5.0_rk, 0.01_rk, &
                                                                0.005_rk, 0.5_rk), &
                                                   tip_excess_t(.true., 0.0_rk, -5.0_rk, 0.01_rk, &
                                                                0.04_rk, 0.5_rk)], &
                                0.2_rk, 3.0e6_rk, 0.0_rk, 10.0_rk)
      call checks%is_close(stated_errors%tip(1), 1.0e-3_rk + 5.0e-3_rk, 1.0e-12_rk, "short wing")
      call checks%is_close(stated_errors%tip(2), 1.0e-3_rk + 5.0e-3_rk*2.0_rk/4.0_rk, 1.0e-12_rk, &
                           "longer wing")
   end subroutine test_bent

   !> Where viscosity matters, steps of half a cell count by the square, short ones as usual.
   subroutine test_viscous()
      type(stated_errors_t) :: stated_errors

      call checks%is_close(by_flow(0.5_rk, 1.0_rk), 1.5_rk, 1.0e-12_rk, "half a cell")
      call checks%is_close(by_flow(0.01_rk, 2.0_rk), 0.75_rk, 1.0e-12_rk, "a short step")
      call stated_errors%accept(1.0_rk, 3.0e6_rk, [tip_excess_t(grows=.true., cell=0.01_rk, &
                                                                by_flow=0.02_rk)], 1.0_rk, 0.0_rk, &
                                0.0_rk, 1.0_rk)
      call checks%is_close(stated_errors%tip(1), 1.0e-3_rk + 0.02_rk, 1.0e-12_rk, "is added")
   end subroutine test_viscous

   !> A fracture of 20 m takes up 2 of 8 units of fluid after K_eq has first been equal to K_IC
   !! within its error, so a quarter of its length may be new. After growth it is not counted.
   subroutine test_onset()
      type(stated_errors_t) :: stated_errors

      stated_errors%position = [0.0_rk, 0.0_rk]
      call stated_errors%await_growth([.false., .false.], .false., 20.0_rk, 6.0_rk)
      call checks%is_close(stated_errors%length, 0.0_rk, 0.0_rk, "no tip may have grown")
      call stated_errors%await_growth([.true., .false.], .false., 20.0_rk, 8.0_rk)
      call checks%is_close(stated_errors%length, 5.0_rk, 1.0e-12_rk, "one may have grown")
      call checks%is_close(stated_errors%position(1), 5.0_rk, 1.0e-12_rk, "this tip")
      call checks%is_close(stated_errors%position(2), 0.0_rk, 0.0_rk, "the other tip")
      stated_errors%length = 0.0_rk
      call stated_errors%await_growth([.false., .false.], .false., 20.0_rk, 10.0_rk)
      call stated_errors%await_growth([.true., .false.], .false., 20.0_rk, 10.0_rk)
      call checks%is_close(stated_errors%length, 0.0_rk, 0.0_rk, "another start, no fluid since")
      call stated_errors%await_growth([.true., .false.], .true., 20.5_rk, 12.0_rk)
      call stated_errors%await_growth([.true., .false.], .false., 20.5_rk, 14.0_rk)
      call checks%is_close(stated_errors%length, 0.0_rk, 0.0_rk, "after growth")
   end subroutine test_onset

   !> p' = 2 t by backward Euler with the step h is h t too large at t; the error h**2 of the first
   !! step, which has no rate to compare with, is not known.
   subroutine test_steps()
      type(stated_errors_t) :: stated_errors
      real(rk), parameter :: h = 0.1_rk
      type(tip_excess_t) :: no_tips(0)
      real(rk) :: p
      integer :: n

      p = 0.0_rk
      call stated_errors%accept(0.0_rk, p, no_tips, 0.0_rk, 0.0_rk, 0.0_rk, 0.0_rk)
      do n = 1, 20
         p = p + h*2.0_rk*(n*h)
         call stated_errors%accept(h, p, no_tips, 0.0_rk, 0.0_rk, 0.0_rk, n*h)
      end do
      call checks%is_close(stated_errors%pressure, p - 4.0_rk - h**2, 1.0e-12_rk, &
                           "error of the steps")
      call checks%is_close(stated_errors%length, 0.0_rk, 0.0_rk, "nothing has grown")
   end subroutine test_steps

end program test_twolevel_errors
