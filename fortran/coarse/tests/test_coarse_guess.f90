!> Where an iteration begins: changes of the last step in proportion to time, but not too far, and
!! only for the same unknowns.
program test_coarse_guess
   use base_kinds, only: ik, rk
   use coarse_state, only: guess_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: start(2) = [10.0_rk, -4.0_rk], x(2) = [12.0_rk, -5.0_rk]
   type(checks_t) :: checks
   type(guess_t) :: guess

   call checks%is_true(.not. guess%is_known(2_ik), "nothing to go on from")
   call guess%remember(2.0_rk, start, x)
   call checks%is_true(guess%is_known(2_ik), "a step to go on from")
   call checks%is_true(.not. guess%is_known(3_ik), "not for other unknowns")
   call leads(start, 1.0_rk, [11.0_rk, -4.5_rk], "half of the step")
   call leads(x, 4.0_rk, [16.0_rk, -7.0_rk], "twice as long a step")
   call leads(x, 1.0e3_rk, [20.0_rk, -9.0_rk], "no farther than four steps")
   call guess%forget()
   call checks%is_true(.not. guess%is_known(2_ik), "forgotten")
   call checks%finish()

contains

   !> To where a step of length dt is guessed to lead.
   subroutine leads(from, dt, to, name)
      real(rk), intent(in) :: from(2)  !< [Pa]
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: to(2)  !< [Pa]
      character(len=*), intent(in) :: name

      call checks%is_close(maxval(abs(guess%from(from, dt) - to)), 0.0_rk, 0.0_rk, name)
   end subroutine leads

end program test_coarse_guess
