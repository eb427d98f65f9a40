!> Errors of steps from rates: exact where the second derivative is constant.
program test_twolevel_trend
   use base_kinds, only: ik, rk
   use coarse_state, only: state_t
   use mesh_types, only: mesh_map_t
   use testing_checks, only: checks_t
   use twolevel_trend, only: trend_t
   implicit none(type, external)

   real(rk), parameter :: area(2) = [1.0_rk, 3.0_rk], length(3) = [1.0_rk, 1.0_rk, 2.0_rk]
   real(rk), parameter :: round_off = 1.0e-12_rk
   type(checks_t) :: checks

   call test_parabola()
   call test_rest()
   call test_transfer()
   call checks%finish()

contains

   !> Pressures of 3 t**2 in the rock and the fractures, after a range of 100: the error of a step h
   !! is 3 h**2, whatever the previous step, and so is that of the mean of the jumps.
   subroutine test_parabola()
      type(trend_t) :: trend
      real(rk), parameter :: h = 0.5_rk
      real(rk) :: t

      call trend%begin(state_at(0.0_rk), at_rest=.true., pressure_scale=100.0_rk*100.0_rk, &
                       stiffness=1.0_rk, length=1.0_rk)
      call checks%is_true(.not. trend%is_known(), "no step yet")
      t = 1.0_rk
      call trend%accept(state_at(0.0_rk), state_at(t), t)
      call checks%is_true(trend%is_known(), "a step")
      ! Ranges are at least a hundredth of the range that the load would cause: 100.
      call checks%is_close(trend%step_error(state_at(t), state_at(t + h), h, area, length), &
                           3.0_rk*h**2/100.0_rk, round_off, "pressure")
      call trend%accept(jumped(0.0_rk), jumped(t), t)
      call checks%is_close(trend%step_error(jumped(t), jumped(t + h), h, area, length), &
                           3.0_rk*h**2/100.0_rk, round_off, "opening")
   end subroutine test_parabola

   !> At rest the whole change is the error, in the mean over the body; 0 without a rate.
   subroutine test_rest()
      type(trend_t) :: trend
      type(state_t) :: after

      call trend%begin(state_at(0.0_rk), at_rest=.true., pressure_scale=1.0_rk, &
                       stiffness=1.0_rk, length=1.0_rk)
      after = state_at(0.0_rk)
      after%unknowns(3, 1) = 8.0_rk
      call checks%is_close(trend%step_error(state_at(0.0_rk), after, 1.0_rk, area, length), &
                           0.25_rk, round_off, "a quarter of the body")
      after = state_at(0.0_rk)
      after%jump(2, :, 3) = 5.0_rk
      call checks%is_close(trend%step_error(state_at(0.0_rk), after, 1.0_rk, area, length), &
                           0.5_rk, round_off, "slip of half of the fractures")
      call trend%begin(state_at(0.0_rk), at_rest=.false., pressure_scale=1.0_rk, &
                       stiffness=1.0_rk, length=1.0_rk)
      call checks%is_close(trend%step_error(state_at(0.0_rk), after, 1.0_rk, area, length), &
                           0.0_rk, 0.0_rk, "nothing is known")
   end subroutine test_rest

   !> On a new mesh old cells keep their rates, whatever their numbers; new cells do not count.
   subroutine test_transfer()
      type(trend_t) :: trend
      type(mesh_map_t) :: map

      call trend%begin(state_at(0.0_rk), at_rest=.true., pressure_scale=1.0_rk, &
                       stiffness=1.0_rk, length=1.0_rk)
      call trend%accept(state_at(0.0_rk), state_at(1.0_rk), 1.0_rk)
      trend%rock = [1.0_rk, 2.0_rk]
      trend%fracture = [3.0_rk, 4.0_rk, 5.0_rk]
      trend%jump = reshape([6.0_rk, 7.0_rk, 8.0_rk, 9.0_rk, 10.0_rk, 11.0_rk], [2, 3])
      map%cell_old = [2_ik, 0_ik, 1_ik]
      map%fracture_cell_old = [0_ik, 3_ik, 1_ik, 2_ik]
      call trend%transfer(map)
      call checks%is_true(all(trend%knows_rock .eqv. [.true., .false., .true.]), "cells")
      call checks%is_true(all(trend%knows_fracture .eqv. [.false., .true., .true., .true.]), &
                          "fracture cells")
      call checks%is_close(maxval(abs(trend%rock - [2.0_rk, 0.0_rk, 1.0_rk])), 0.0_rk, 0.0_rk, &
                           "rates of cells")
      call checks%is_close(maxval(abs(trend%fracture - [0.0_rk, 5.0_rk, 3.0_rk, 4.0_rk])), &
                           0.0_rk, 0.0_rk, "rates of fracture cells")
      call checks%is_close(maxval(abs(trend%jump(2, :) - [0.0_rk, 11.0_rk, 7.0_rk, 9.0_rk])), &
                           0.0_rk, 0.0_rk, "rates of slip")
   end subroutine test_transfer

   !> Set all pressures at a time.
   pure function state_at(t) result(state)
      real(rk), intent(in) :: t
      type(state_t) :: state

      allocate (state%unknowns(3, 2), state%content(2), state%pressure(3), state%jump(2, 2, 3), &
                source=0.0_rk)
      state%unknowns(3, :) = 3.0_rk*t**2
      state%pressure = 3.0_rk*t**2
   end function state_at

   !> Set the jumps as well, with a mean of the same curvature, in a larger range.
   pure function jumped(t) result(state)
      real(rk), intent(in) :: t
      type(state_t) :: state

      state = state_at(t)
      state%jump(1, 1, :) = 2.0_rk*t**2
      state%jump(1, 2, :) = 4.0_rk*t**2
   end function jumped

end program test_twolevel_trend
