!> Lengths of time steps: at switches, after cuts, and after growth.
program test_twolevel_stepping
   use testing_checks, only: checks_t
   use base_kinds, only: rk
   use scene_types, only: injection_t, scene_t, time_t
   use twolevel_stepping, only: stepper_t
   use twolevel_wells, only: next_switch, rate
   implicit none(type, external)

   type(time_t), parameter :: time = time_t(end=1.0e4_rk, step=100.0_rk, &
                                            share_after_growth=0.01_rk, smallest_factor=0.1_rk)
   real(rk), parameter :: nothing_new(0) = [real(rk) ::]
   type(checks_t) :: checks

   call test_switches()
   call test_cuts()
   call test_growth()
   call test_equilibrium()
   call test_wells()
   call checks%finish()

contains

   !> A step ends at a switch; one that would all but reach it does so exactly.
   subroutine test_switches()
      type(stepper_t) :: stepper

      stepper%next = 100.0_rk
      call checks%is_close(stepper%step_to(250.0_rk), 100.0_rk, 0.0_rk, "far from a switch")
      call checks%is_close(stepper%step_to(40.0_rk), 40.0_rk, 0.0_rk, "to the switch")
      call checks%is_close(stepper%step_to(100.0_rk + 1.0e-8_rk), 100.0_rk + 1.0e-8_rk, 0.0_rk, &
                           "no tiny step before it")
   end subroutine test_switches

   !> Steps are halved, and doubled again once they are accepted, up to the regular one.
   subroutine test_cuts()
      type(stepper_t) :: stepper
      real(rk) :: dt
      logical :: is_too_short

      stepper%next = 100.0_rk
      dt = stepper%step_to(1.0e4_rk)
      call stepper%cut(time, dt, is_too_short)
      call stepper%cut(time, dt, is_too_short)
      call checks%is_close(dt, 25.0_rk, 0.0_rk, "cut twice")
      call checks%is_true(.not. is_too_short, "not too short")
      call stepper%step_done(time, nothing_new)
      call checks%is_close(stepper%next, 50.0_rk, 0.0_rk, "doubled")
      call stepper%step_done(time, nothing_new)
      call stepper%step_done(time, nothing_new)
      call checks%is_close(stepper%next, 100.0_rk, 0.0_rk, "the regular step")
      dt = 15.0_rk
      call stepper%cut(time, dt, is_too_short)
      call checks%is_true(is_too_short, "below a tenth of the regular step")
   end subroutine test_cuts

   !> In equilibrium a tip goes about half a segment in a step.
   subroutine test_equilibrium()
      type(stepper_t) :: stepper

      stepper%next = 40.0_rk
      call stepper%follow_growth(time, 0.9_rk)
      call checks%is_close(stepper%next, 20.0_rk, 0.0_rk, "too far: half the step")
      call stepper%follow_growth(time, 0.5_rk)
      call checks%is_close(stepper%next, 20.0_rk, 0.0_rk, "as it should be: the same")
      call stepper%follow_growth(time, 0.0_rk)
      call checks%is_close(stepper%next, 40.0_rk, 0.0_rk, "no growth: twice the step")
      call stepper%follow_growth(time, 0.1_rk)
      call stepper%follow_growth(time, 0.1_rk)
      call checks%is_close(stepper%next, 100.0_rk, 0.0_rk, "at most the regular step")
   end subroutine test_equilibrium

   !> After growth steps are short until the pressure of the new cells changes by 1 % at most.
   subroutine test_growth()
      type(stepper_t) :: stepper

      stepper%next = 100.0_rk
      call stepper%network_grew(time)
      call checks%is_close(stepper%next, 1.0_rk, 0.0_rk, "short after growth")
      call stepper%step_done(time, [1.0e6_rk, 2.0e6_rk])
      call checks%is_true(stepper%is_short, "nothing to compare with yet")
      call stepper%step_done(time, [1.5e6_rk, 2.0e6_rk])
      call checks%is_close(stepper%next, 1.0_rk, 0.0_rk, "not settled")
      call stepper%step_done(time, [1.51e6_rk, 2.0e6_rk])
      call checks%is_close(stepper%next, 100.0_rk, 0.0_rk, "settled")
   end subroutine test_growth

   !> A step has the rate of its middle; a well runs from its start to its end.
   subroutine test_wells()
      type(scene_t) :: scene

      scene%time%end = 100.0_rk
      scene%injections = [injection_t(rate=1.0e-6_rk, start=10.0_rk, end=30.0_rk), &
                          injection_t(rate=2.0e-6_rk, start=20.0_rk), &
                          injection_t(rate=-3.0e-6_rk, start=0.0_rk, end=25.0_rk)]
      call rates_are(scene, 0.0_rk, 10.0_rk, 0.0_rk, "before its start")
      call rates_are(scene, 10.0_rk, 1.0_rk, 1.0e-6_rk, "from its start")
      call rates_are(scene, 29.0_rk, 1.0_rk, 1.0e-6_rk, "to its end")
      call rates_are(scene, 30.0_rk, 1.0_rk, 0.0_rk, "after its end")
      call rates_are(scene, 0.0_rk, 10.000000001_rk, 0.0_rk, &
                     "a step that ends at its start but for rounding")
      call rates_are(scene, 29.999999999_rk, 5.0_rk, 0.0_rk, &
                     "a step that begins at its end but for rounding")
      call checks%is_close(rate(scene%injections(2), 1.0e9_rk, 1.0_rk), 2.0e-6_rk, 0.0_rk, &
                           "without end")
      call switches_at(scene, 0.0_rk, 10.0_rk)
      call switches_at(scene, 10.0_rk, 20.0_rk)
      call switches_at(scene, 20.0_rk, 25.0_rk)
      call switches_at(scene, 25.0_rk, 30.0_rk)
      call switches_at(scene, 29.9_rk, 30.0_rk)
      call switches_at(scene, 30.0_rk, 100.0_rk)
   end subroutine test_wells

   subroutine rates_are(scene, now, dt, expected, name)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: now, dt  !< [s]
      real(rk), intent(in) :: expected  !< of the first well [m2/s]
      character(len=*), intent(in) :: name

      call checks%is_close(rate(scene%injections(1), now, dt), expected, 0.0_rk, name)
   end subroutine rates_are

   subroutine switches_at(scene, now, next)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: now, next  !< [s]

      call checks%is_close(next_switch(scene, now), next, 0.0_rk, "next time of change")
   end subroutine switches_at

end program test_twolevel_stepping
