!> Lengths of time steps: at switches, after cuts, by error and growth, and after increments.
program test_twolevel_stepping
   use base_kinds, only: rk
   use scene_types, only: injection_t, scene_t, time_t
   use testing_checks, only: checks_t
   use twolevel_schedule, only: next_switch
   use twolevel_stepping, only: step_scale, stepper_t, trial_t
   use twolevel_wells, only: rate
   implicit none(type, external)

   !> Steps of a prescribed length, and steps with small errors.
   type(time_t), parameter :: given = time_t(end=1.0e4_rk, step=100.0_rk, &
                                             share_after_growth=0.01_rk, smallest_factor=0.1_rk)
   type(time_t), parameter :: chosen = time_t(end=1.0e6_rk, tolerance=0.01_rk, &
                                              smallest_factor=1.0e-9_rk)
   type(checks_t) :: checks

   call test_switches()
   call test_first_step()
   call test_cuts()
   call test_error_in_time()
   call test_decay()
   call test_advance()
   call test_onset()
   call test_too_far()
   call test_approach()
   call test_unsolved()
   call test_sudden()
   call test_at_once()
   call test_headway()
   call test_limits_of_wells()
   call test_increments()
   call test_wells()
   call checks%finish()

contains

   !> A step ends at a switch; one that would nearly reach a switch ends there exactly.
   subroutine test_switches()
      type(stepper_t) :: stepper

      call stepper%begin(given)
      call checks%is_close(stepper%step_to(250.0_rk), 100.0_rk, 0.0_rk, "far from a switch")
      call checks%is_close(stepper%step_to(40.0_rk), 40.0_rk, 0.0_rk, "to the switch")
      call checks%is_close(stepper%step_to(100.0_rk + 1.0e-8_rk), 100.0_rk + 1.0e-8_rk, 0.0_rk, &
                           "no tiny step before it")
   end subroutine test_switches

   !> With the first step given no length follows from the end.
   subroutine test_first_step()
      type(stepper_t) :: stepper
      type(time_t) :: time
      integer :: i

      do i = 1, 2
         time = time_t(end=10.0_rk**(3*i), tolerance=0.01_rk, first=1.0e-3_rk, &
                       smallest_factor=1.0e-9_rk)
         call stepper%begin(time)
         call checks%is_close(stepper%step_to(10.0_rk), 1.0e-3_rk, 0.0_rk, "the first step")
         call checks%is_close(stepper%shortest, 1.0e-5_rk, 1.0e-20_rk, "the shortest one")
         call checks%is_close(step_scale(time), 1.0e4_rk, 1.0e-10_rk, "what lengths are shares of")
      end do
   end subroutine test_first_step

   !> Steps are halved, and doubled again once they are accepted, up to the regular one.
   subroutine test_cuts()
      type(stepper_t) :: stepper
      type(trial_t) :: failed, good
      real(rk) :: dt
      logical :: is_too_short

      failed%reason = "a reason"
      good%converged = .true.
      call stepper%begin(given)
      call checks%is_true(.not. stepper%takes(failed), "not without convergence")
      call checks%is_true(failed%why_cut() == "a reason", "the reason is told")
      dt = stepper%step_to(1.0e4_rk)
      call stepper%cut(failed, dt, is_too_short)
      call stepper%cut(failed, dt, is_too_short)
      call checks%is_close(dt, 25.0_rk, 0.0_rk, "cut twice")
      call checks%is_true(.not. is_too_short, "not too short")
      call stepper%step_done(good, dt)
      call checks%is_close(stepper%next, 50.0_rk, 0.0_rk, "doubled")
      call stepper%step_done(good, dt)
      call stepper%step_done(good, dt)
      call checks%is_close(stepper%next, 100.0_rk, 0.0_rk, "the regular step")
      dt = 15.0_rk
      call stepper%cut(failed, dt, is_too_short)
      call checks%is_true(is_too_short, "below a tenth of the regular step")
   end subroutine test_cuts

   !> The first step is very short; then the error, which is proportional to the square of the step,
   !! is between an eighth and the whole of the tolerance.
   subroutine test_error_in_time()
      type(stepper_t) :: stepper
      type(trial_t) :: trial
      real(rk) :: dt
      logical :: is_too_short
      integer :: k

      call stepper%begin(chosen)
      call checks%is_close(stepper%next, 0.1_rk, 1.0e-12_rk, "the first step")
      do k = 1, 40
         dt = stepper%step_to(huge(1.0_rk))
         trial = trial_t(converged=.true., time_error=0.01_rk*(dt/1000.0_rk)**2)
         if (stepper%takes(trial)) then
            call stepper%step_done(trial, dt)
         else
            call stepper%cut(trial, dt, is_too_short)
         end if
         call checks%is_true(stepper%next <= 4.0_rk*dt, "at most four times the last one")
      end do
      call checks%is_true(stepper%takes(trial), "error below the tolerance")
      call checks%is_close(trial%time_error, 0.0056_rk, 0.0044_rk, "and not far below")
      trial%time_error = 0.02_rk
      dt = 64.0_rk
      call checks%is_true(.not. stepper%takes(trial), "too large an error")
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_close(dt, 32.0_rk, 0.0_rk, "half as long")
      trial%time_error = 1.0_rk
      dt = 64.0_rk
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_close(dt, 4.0_rk, 0.0_rk, "as short as the error asks for")
   end subroutine test_error_in_time

   !> y' = -(y - 1)/tau over six decades of tau, by backward Euler with these steps: the error of
   !! the solution stays near the tolerance, and it takes some fifty steps.
   subroutine test_decay()
      type(stepper_t) :: stepper
      type(trial_t) :: trial
      real(rk) :: dt, dt_before, error, rate_before, tau, time, y, y_new
      logical :: is_too_short
      integer :: decade, steps

      do decade = -4, 2
         tau = 1.0e6_rk*10.0_rk**decade
         call stepper%begin(chosen)
         time = 0.0_rk
         y = 0.0_rk
         rate_before = 0.0_rk
         dt_before = 0.0_rk
         error = 0.0_rk
         steps = 0
         do while (time < chosen%end)
            dt = stepper%step_to(chosen%end - time)
            steps = steps + 1
            y_new = (y + dt/tau)/(1.0_rk + dt/tau)
            trial = trial_t(converged=.true., &
                            time_error=dt/(dt + dt_before)*abs(y_new - y - dt*rate_before))
            if (.not. stepper%takes(trial)) then
               call stepper%cut(trial, dt, is_too_short)
               cycle
            end if
            call stepper%step_done(trial, dt)
            time = time + dt
            rate_before = (y_new - y)/dt
            dt_before = dt
            y = y_new
            error = max(error, abs(y - (1.0_rk - exp(-time/tau))))
         end do
         call checks%is_true(error < 4.0_rk*chosen%tolerance, "error of a decay")
         call checks%is_true(steps < 100, "steps of a decay")
         print "(a,es8.1,a,f7.4,a,i0,a)", "decay in ", tau, " s: error ", error, " in ", steps, &
            " steps"
      end do
   end subroutine test_decay

   !> An event at the same share of a step however short the step is, as where an intensity changes
   !! just after the previous state, costs six cuts; an event at a fixed time is located.
   subroutine test_sudden()
      real(rk), parameter :: shares(4) = [0.02_rk, 0.594_rk, 0.9_rk, 0.995_rk], begun = 37.0_rk
      type(stepper_t) :: stepper
      type(trial_t) :: trial
      logical :: is_too_short
      real(rk) :: dt
      integer :: cuts, k

      do k = 1, size(shares)
         call stepper%begin(chosen)
         dt = 100.0_rk
         do cuts = 1, 50
            trial = trial_t(converged=.true., onset=shares(k))
            call stepper%cut(trial, dt, is_too_short)
            if (is_too_short) exit
         end do
         call checks%is_true(cuts <= 6, "an onset at once")
         call stepper%step_done(trial_t(converged=.true.), dt)
         dt = 100.0_rk
         do cuts = 0, 49
            trial = trial_t(converged=.true., is_late=.true., arrival=shares(k), moment=0.01_rk)
            if ((1.0_rk - shares(k))*dt <= trial%moment) exit
            call stepper%cut(trial, dt, is_too_short)
         end do
         call checks%is_true(cuts <= 6, "an arrival at once")
      end do
      ! K_eq/K_IC is 1/2 before the step, and increases with the square root of time from then on.
      call stepper%begin(chosen)
      dt = 100.0_rk
      do cuts = 0, 49
         associate (rise => 0.5_rk*sqrt(dt/begun))
            if (rise <= 0.505_rk) exit
            trial = trial_t(converged=.true., onset=0.5_rk/rise)
         end associate
         call stepper%cut(trial, dt, is_too_short)
      end do
      call checks%is_true(cuts <= 6, "an onset in the step")
      call checks%is_close(dt, begun, 0.021_rk*begun, "where it is")
   end subroutine test_sudden

   !> In equilibrium a tip advances by at most one and a half segments in a step.
   subroutine test_advance()
      type(stepper_t) :: stepper
      real(rk), parameter :: far = 1.8_rk, half = 1.0_rk

      call stepper%begin(chosen)
      call stepper%step_done(trial_t(converged=.true., advance=far), 40.0_rk)
      call checks%is_close(stepper%next, 20.0_rk, 0.0_rk, "too far: half the step")
      call stepper%step_done(trial_t(converged=.true., advance=half), 20.0_rk)
      call checks%is_close(stepper%next, 20.0_rk, 0.0_rk, "as it should be: the same")
      call stepper%step_done(trial_t(converged=.true.), 20.0_rk)
      call checks%is_close(stepper%next, 80.0_rk, 0.0_rk, "no growth: four times the step")
      call stepper%begin(given)
      stepper%next = 40.0_rk
      call stepper%step_done(trial_t(converged=.true., advance=far), 40.0_rk)
      call checks%is_close(stepper%next, 20.0_rk, 0.0_rk, "also where steps are given")
      call stepper%begin(chosen)
      stepper%moment = 100.0_rk
      call stepper%step_done(trial_t(converged=.true., advance=far), 10.0_rk)
      call checks%is_close(stepper%next, 40.0_rk, 0.0_rk, "as far as a tip runs in a moment")
      call stepper%step_done(trial_t(converged=.true., advance=far), 40.0_rk)
      call checks%is_close(stepper%next, 100.0_rk, 0.0_rk, "and no longer than this moment")
      call stepper%step_done(trial_t(converged=.true., advance=far), 80.0_rk)
      call checks%is_close(stepper%next, 80.0_rk, 0.0_rk, "a step nearly as long is kept")
      call stepper%step_done(trial_t(converged=.true., advance=far), 300.0_rk)
      call checks%is_close(stepper%next, 150.0_rk, 0.0_rk, "beyond it, segments count")
      call stepper%step_done(trial_t(converged=.true., advance=far, time_error=0.02_rk), 10.0_rk)
      call checks%is_close(stepper%next, 5.0_rk, 0.0_rk, "and the time error always")
   end subroutine test_advance

   !> What happens at the start of a step at once does not become less with the step: it is not cut
   !! again for the same time error; an onset that stays at the same share is caused by a jump.
   subroutine test_at_once()
      type(stepper_t) :: stepper
      type(trial_t) :: trial
      real(rk) :: dt
      logical :: is_too_short

      call stepper%begin(chosen)
      trial = trial_t(converged=.true., time_error=0.02_rk)
      dt = 64.0_rk
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_true(.not. is_too_short, "an error of time, as far as is known")
      trial%time_error = 0.0199_rk
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_true(is_too_short .and. dt > 1.0_rk, "not one of time")
      call stepper%step_done(trial, dt)
      dt = 64.0_rk
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_true(.not. is_too_short, "each step alone")
      trial%time_error = 0.014_rk
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_true(.not. is_too_short, "as the root of time: not at once")

      stepper%moment = 0.5_rk
      trial = trial_t(converged=.true., onset=0.55_rk)
      dt = 64.0_rk
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_true(.not. stepper%has_sudden_onset, "an onset within the step")
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_true(stepper%has_sudden_onset, "at the same share of a shorter one")
      call checks%is_close(dt, 0.5_rk, 0.0_rk, "in which tips may jump")
   end subroutine test_at_once

   !> A step ends where a tip begins to grow.
   subroutine test_onset()
      type(stepper_t) :: stepper
      type(trial_t) :: trial
      real(rk) :: dt
      logical :: is_too_short

      call stepper%begin(chosen)
      trial = trial_t(converged=.true., onset=0.3_rk)
      dt = 10.0_rk
      call checks%is_true(.not. stepper%takes(trial), "an onset within the step")
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_close(dt, 3.0_rk, 1.0e-14_rk, "the step to the onset")
      dt = 10.0_rk
      trial = trial_t(converged=.true., is_late=.true., arrival=0.4_rk)
      call checks%is_true(.not. stepper%takes(trial), "a joint early in the step")
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_close(dt, 4.0_rk, 1.0e-14_rk, "the step to the joint")
   end subroutine test_onset

   !> Unstable growth does not become shorter with the step: six cuts lead to the shortest step,
   !! 1e-9 of the scene's time, and not below half of it. Fast growth is not cut by more than the
   !! square of the required factor; the next step starts again without previous cuts.
   subroutine test_too_far()
      type(stepper_t) :: stepper
      type(trial_t) :: trial
      real(rk) :: dt
      logical :: is_too_short
      integer :: cuts

      trial = trial_t(converged=.true., goes_too_far=.true.)
      call stepper%begin(chosen)
      dt = 1.0e5_rk
      is_too_short = .false.
      cuts = 0
      do while (.not. is_too_short .and. cuts < 100)
         call stepper%cut(trial, dt, is_too_short)
         cuts = cuts + 1
      end do
      call checks%is_true(cuts <= 6, "few cuts where they do not help")
      call checks%is_close(dt, 0.5_rk*stepper%shortest, 1.0e-12_rk, "to half of the shortest step")
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_close(dt, 0.25_rk*stepper%shortest, 1.0e-12_rk, "halved if that is too long")
      call stepper%begin(chosen)
      dt = 1.0_rk
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_close(dt, 0.5_rk, 0.0_rk, "the first cut halves")
      call stepper%cut(trial, dt, is_too_short)
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_close(dt, 0.0625_rk, 0.0_rk, "the third leaves a sixteenth")
      call stepper%step_done(trial_t(converged=.true.), dt)
      dt = 1.0_rk
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_close(dt, 0.5_rk, 0.0_rk, "the next step is halved first")
      call stepper%step_done(trial_t(converged=.true.), dt)
      dt = 1.0_rk
      trial%admissible = 0.3_rk
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_close(dt, 0.3_rk, 1.0e-15_rk, "to where the tips do not go too far")
      trial%was_beyond = .true.
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_true(is_too_short, "at once where no time is needed to go too far")
      call checks%is_close(dt, 0.5_rk*stepper%shortest, 1.0e-12_rk, "and no farther")
   end subroutine test_too_far

   !> Steps after one in which tips grew too far halve the time to its end; after four of them the
   !! rest is taken in one step. Noticeable growth, or a jump, ends this.
   subroutine test_approach()
      type(stepper_t) :: stepper
      type(trial_t) :: too_far, little
      real(rk) :: dt, time
      logical :: is_too_short
      integer :: k

      too_far = trial_t(converged=.true., goes_too_far=.true.)
      little = trial_t(converged=.true., advance=0.01_rk)
      call stepper%begin(chosen)
      dt = 64.0_rk
      time = 0.0_rk
      call stepper%cut(too_far, dt, is_too_short)
      do k = 1, 6
         time = time + dt
         call stepper%step_done(little, dt)
         call checks%is_close(time, merge(64.0_rk, 64.0_rk - 32.0_rk*0.5_rk**(k - 1), k == 6), &
                              1.0e-12_rk, "half of what is left")
         dt = stepper%step_to(1.0e6_rk)
      end do
      call checks%is_close(dt, 8.0_rk, 1.0e-12_rk, "as usual beyond")
      dt = 64.0_rk
      call stepper%cut(too_far, dt, is_too_short)
      call stepper%step_done(trial_t(converged=.true., advance=0.6_rk), dt)
      call checks%is_close(stepper%next, 64.0_rk, 1.0e-12_rk, "growth limits steps by itself")
      dt = 64.0_rk
      call stepper%cut(too_far, dt, is_too_short)
      call stepper%step_done(trial_t(converged=.true., jumps=.true.), dt)
      call checks%is_close(stepper%next, 128.0_rk, 1.0e-12_rk, "the jump is over")
   end subroutine test_approach

   !> After a step that was not solved the next four become longer by the root of two at most.
   subroutine test_unsolved()
      type(stepper_t) :: stepper
      type(trial_t) :: failed
      real(rk) :: dt
      logical :: is_too_short
      integer :: k

      failed%reason = "a reason"
      call stepper%begin(chosen)
      dt = 64.0_rk
      call stepper%cut(failed, dt, is_too_short)
      call checks%is_close(dt, 32.0_rk, 0.0_rk, "half")
      do k = 1, 4
         call stepper%step_done(trial_t(converged=.true.), dt)
         call checks%is_close(stepper%next, 32.0_rk*sqrt(2.0_rk)**(k - 1), 1.0e-12_rk, "slowly")
         dt = stepper%next
      end do
      call stepper%step_done(trial_t(converged=.true.), dt)
      call checks%is_close(stepper%next, 4.0_rk*dt, 1.0e-12_rk, "as usual then")
   end subroutine test_unsolved

   !> Whatever the time errors, no step is shorter than a 64th of the shortest step, except up to a
   !! switch. Three hundred steps cut to this length count as no progress in time; a longer step, or
   !! growth, as progress.
   subroutine test_headway()
      type(stepper_t) :: stepper
      type(trial_t) :: trial
      real(rk) :: dt
      logical :: is_too_short
      integer :: k

      trial = trial_t(converged=.true., time_error=1.0e9_rk)
      call stepper%begin(chosen)
      do k = 1, 299
         dt = stepper%step_to(1.0e6_rk)
         do
            call stepper%cut(trial, dt, is_too_short)
            if (is_too_short) exit
         end do
         call stepper%step_done(trial, dt)
      end do
      call checks%is_close(dt, stepper%shortest/64.0_rk, 1.0e-12_rk, "they do not shrink for ever")
      call checks%is_true(.not. stepper%is_stuck(), "not stuck yet")
      call stepper%step_done(trial, dt)
      call checks%is_true(.not. stepper%is_stuck(), "a step that was not cut does not count")
      call stepper%cut(trial, dt, is_too_short)
      call stepper%step_done(trial, dt)
      call checks%is_true(stepper%is_stuck(), "no headway")
      call stepper%step_done(trial, 1.0_rk)
      call checks%is_true(.not. stepper%is_stuck(), "a longer step is headway")
      call stepper%begin(chosen)
      do k = 1, 500
         call checks%is_true(.not. stepper%is_slow(1.0e6_rk), "not slow yet")
         call stepper%step_done(trial_t(converged=.true.), 1.0_rk)
      end do
      call checks%is_true(stepper%is_slow(1.0e6_rk) .and. .not. stepper%is_slow(5.0e4_rk), "slow")
      call stepper%step_done(trial_t(converged=.true., advance=0.5_rk), 1.0_rk)
      call checks%is_true(.not. stepper%is_slow(1.0e6_rk), "growth is headway")
      dt = 1.0e-3_rk*stepper%shortest
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_close(dt, 1.0e-3_rk*stepper%shortest, 0.0_rk, "what is left to a switch stays")
      call stepper%step_done(trial, dt)
      call checks%is_close(stepper%next, stepper%shortest/64.0_rk, 1.0e-12_rk, "not beyond it")
   end subroutine test_headway

   !> A step ends where a well reaches its limit; where the limit is found at the end of the step
   !! repeatedly, the step is halved.
   subroutine test_limits_of_wells()
      type(stepper_t) :: stepper
      type(trial_t) :: trial
      real(rk) :: dt
      logical :: is_too_short
      integer :: k

      trial = trial_t(converged=.true., switch=0.9_rk)
      call stepper%begin(chosen)
      dt = 1000.0_rk
      do k = 1, 3
         call stepper%cut(trial, dt, is_too_short)
      end do
      call checks%is_close(dt, 729.0_rk, 1.0e-12_rk, "to where the limit is passed")
      call stepper%cut(trial, dt, is_too_short)
      call checks%is_close(dt, 364.5_rk, 1.0e-12_rk, "half, the fourth time")
   end subroutine test_limits_of_wells

   !> After an increment steps are short until the pressure of the new cells changes by no more than
   !! 1 %.
   subroutine test_increments()
      type(stepper_t) :: stepper

      call stepper%begin(given)
      call stepper%network_grew()
      call checks%is_close(stepper%next, 1.0_rk, 0.0_rk, "a hundredth")
      call step_after(stepper, [10.0e6_rk, 5.0e6_rk])
      call checks%is_true(stepper%is_short, "nothing to compare with")
      call step_after(stepper, [10.2e6_rk, 5.0e6_rk])
      call checks%is_true(stepper%is_short, "2 % of change")
      call checks%is_close(stepper%next, 1.0_rk, 0.0_rk, "short again")
      call step_after(stepper, [10.2e6_rk, 5.05e6_rk])
      call checks%is_true(.not. stepper%is_short, "settled")
      call checks%is_close(stepper%next, 100.0_rk, 0.0_rk, "back to the regular step")
   end subroutine test_increments

   !> A step of the scene after an increment.
   subroutine step_after(stepper, pressure)
      type(stepper_t), intent(inout) :: stepper
      real(rk), intent(in) :: pressure(:)  !< pressure of the new cells [Pa]

      call stepper%step_done(trial_t(converged=.true.), stepper%next)
      call stepper%settle(pressure)
   end subroutine step_after

   !> A well starts, stops, and flows at its mean rate in a step.
   subroutine test_wells()
      type(scene_t) :: scene

      scene%time%end = 100.0_rk
      scene%injections = [injection_t(rate=[1.0e-6_rk], start=10.0_rk, end=30.0_rk), &
                          injection_t(rate=[2.0e-6_rk], start=20.0_rk), &
                          injection_t(rate=[-3.0e-6_rk], start=0.0_rk, end=25.0_rk)]
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
      real(rk), intent(in) :: expected  !< rate of the first well [m2/s]
      character(len=*), intent(in) :: name

      call checks%is_close(rate(scene%injections(1), now, dt), expected, 0.0_rk, name)
   end subroutine rates_are

   subroutine switches_at(scene, now, next)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: now, next  !< [s]

      call checks%is_close(next_switch(scene, now), next, 0.0_rk, "next time of change")
   end subroutine switches_at

end program test_twolevel_stepping
