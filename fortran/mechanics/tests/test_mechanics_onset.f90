!> Onsets on straight lines through two states, against closed forms.
program test_mechanics_onset
   use base_kinds, only: rk
   use mechanics_programme, only: predicted_onset, reading_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   real(rk), parameter :: round_off = 4.0e-15_rk
   type(checks_t) :: checks

   call opening()
   call sliding()
   call out_of_reach()
   call checks%finish()

contains

   !> A state of two tips.
   function state(factor, k1, k2) result(reading)
      real(rk), intent(in) :: factor, k1(2), k2(2)
      type(reading_t) :: reading

      reading%factor = factor
      allocate (reading%k1, source=k1)
      allocate (reading%k2, source=k2)
   end function state

   !> Pure opening: K_eq is K_I; the second tip comes first.
   subroutine opening()
      real(rk) :: found

      found = predicted_onset(state(1.0_rk, [1.0_rk, 0.5_rk], [0.0_rk, 0.0_rk]), &
                              state(2.0_rk, [2.0_rk, 3.5_rk], [0.0_rk, 0.0_rk]), &
                              1.0_rk, 10.0_rk, 5.0_rk)
      call checks%is_close(found, 2.5_rk, 10.0_rk*round_off, "opening: 0.5 + 3 (f - 1) = 5")
   end subroutine opening

   !> Pure sliding, in either sense: K_eq is 2/sqrt(3) |K_II|; a closed tip does not count.
   subroutine sliding()
      real(rk) :: found

      found = predicted_onset(state(0.0_rk, [0.0_rk, -9.0_rk], [0.0_rk, 0.0_rk]), &
                              state(1.0_rk, [0.0_rk, -9.0_rk], [-1.0_rk, 0.0_rk]), &
                              0.0_rk, 4.0_rk, 2.0_rk)
      call checks%is_close(found, sqrt(3.0_rk), 10.0_rk*round_off, "sliding")
   end subroutine sliding

   !> No onset between the limits: their middle.
   subroutine out_of_reach()
      type(reading_t) :: a, b

      a = state(1.0_rk, [1.0_rk, 0.0_rk], [0.0_rk, 0.0_rk])
      b = state(2.0_rk, [2.0_rk, 0.0_rk], [0.0_rk, 0.0_rk])
      call checks%is_close(predicted_onset(a, b, 1.0_rk, 3.0_rk, 5.0_rk), 2.0_rk, 0.0_rk, &
                           "beyond the upper limit")
      call checks%is_close(predicted_onset(a, b, 6.0_rk, 8.0_rk, 5.0_rk), 7.0_rk, 0.0_rk, &
                           "before the lower limit")
   end subroutine out_of_reach

end program test_mechanics_onset
