!> Tests of base_timers: what a phase is charged with, and what it is not.
program test_base_timers
   use base_kinds, only: rk
   use base_timers, only: phase_contact, phase_count, phase_names, phase_output, phase_solve, &
                          phase_tips, timers_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks
   type(timers_t) :: timers
   real(rk) :: outer, inner, before, after, total
   integer :: phase

   call checks%is_true(phase_names(phase_output) == "output", "names follow the phases")
   call checks%is_true(phase_names(phase_contact) == "contact", "names follow the phases")

   call timers%begin()
   call cpu_time(before)
   call timers%start(phase_contact)
   call burn(0.02_rk)
   call timers%start(phase_solve)  ! contact pauses
   call burn(0.06_rk)
   call timers%stop(phase_solve)
   call burn(0.02_rk)
   call timers%stop(phase_contact)
   call cpu_time(after)
   outer = timers%seconds(phase_contact)
   inner = timers%seconds(phase_solve)
   call checks%is_true(inner >= 0.06_rk, "the inner phase has its own time")
   call checks%is_true(outer >= 0.04_rk, "the outer phase has the time on both sides")
   call checks%is_true(outer + inner <= after - before, "nothing is counted twice")
   call checks%is_true(outer <= after - before - 0.06_rk, "the outer phase pauses")

   ! An early return leaves the inner phase running: stopping the outer one ends both.
   call timers%start(phase_tips)
   call timers%start(phase_solve)
   call timers%stop(phase_tips)
   inner = timers%seconds(phase_solve)
   call burn(0.02_rk)
   call checks%is_close(timers%seconds(phase_solve), inner, 0.0_rk, "nested phases end too")
   call timers%stop(phase_tips)
   call checks%is_close(timers%seconds(phase_solve), inner, 0.0_rk, "nothing to stop is harmless")

   ! A running phase can be read.
   call timers%start(phase_output)
   call burn(0.02_rk)
   call checks%is_true(timers%seconds(phase_output) >= 0.02_rk, "a running phase is read up to now")
   call timers%stop(phase_output)

   ! Deep nesting, of a phase in itself too.
   outer = timers%seconds(phase_tips)
   do phase = 1, 20
      call timers%start(phase_tips)
   end do
   call burn(0.02_rk)
   do phase = 1, 20
      call timers%stop(phase_tips)
   end do
   inner = timers%seconds(phase_tips)
   call checks%is_true(inner - outer >= 0.02_rk .and. inner - outer < 0.04_rk, &
      & "a phase in itself counts once")

   total = 0.0_rk
   do phase = 1, phase_count
      total = total + timers%seconds(phase)
   end do
   call checks%is_true(timers%cpu_seconds() >= total, "phases add up to at most the process")
   call checks%is_true(timers%wall_seconds() > 0.0_rk, "the wall clock runs")
   call checks%finish()

contains

   !> Keep the processor busy.
   subroutine burn(seconds)
      real(rk), intent(in) :: seconds  !< CPU time [s]
      real(rk) :: begun, now

      call cpu_time(begun)
      now = begun
      do while (now - begun < seconds)
         call cpu_time(now)
      end do
   end subroutine burn

end program test_base_timers
