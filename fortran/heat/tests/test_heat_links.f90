!> The heat flow between two temperatures is the exact one of conduction and advection in one
!! dimension, and the limited temperature is of second order and stays between its neighbours.
program test_heat_links
   use base_kinds, only: rk
   use heat_links, only: coefficients, limited
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks

   call exact_flow()
   call limits()
   call checks%finish()

contains

   !> T = (exp(f x/G) - 1)/(exp(f/G) - 1) on [0, 1] carries f T - G dT/dx = -f/(exp(f/G) - 1).
   subroutine exact_flow()
      real(rk), parameter :: peclet(6) = [-30.0_rk, -1.0_rk, -1.0e-3_rk, 1.0e-3_rk, 2.0_rk, &
                                          100.0_rk]
      real(rk) :: ab(2), exact
      integer :: k

      do k = 1, size(peclet)
         associate (f => 3.0_rk*peclet(k))
            ab = coefficients(3.0_rk, f, .true.)
            exact = -f/(exp(peclet(k)) - 1.0_rk)
            ! T_1 = 0, T_2 = 1
            call checks%is_close(-ab(2)/exact, 1.0_rk, 1.0e-9_rk, "flow between two points")
            call checks%is_close(ab(1) - ab(2), f, 1.0e-12_rk*max(abs(f), 1.0_rk), &
                                 "a uniform temperature is carried")
            call checks%is_true(all(ab >= 0.0_rk), "no negative coefficient")
            ab = coefficients(3.0_rk, f, .false.) + 3.0_rk - coefficients(3.0_rk, f, .true.)
            call checks%is_close(maxval(abs(ab)), 0.0_rk, 1.0e-12_rk, "without its conduction")
         end associate
      end do
      call checks%is_true(all(abs(coefficients(0.0_rk, -2.0_rk, .true.) - [0.0_rk, 2.0_rk]) &
                              <= 0.0_rk), "upwind without conduction")
   end subroutine exact_flow

   subroutine limits()
      call checks%is_close(limited(1.0_rk, 2.0_rk, 3.0_rk), 0.5_rk, 1.0e-15_rk, "the middle")
      call checks%is_close(limited(1.0_rk, 2.0_rk, 1.5_rk), 0.0_rk, 0.0_rk, "upwind at an extreme")
      call checks%is_true(limited(0.0_rk, 2.0_rk, 2.1_rk) <= 0.1_rk, "not beyond the next cell")
      call checks%is_close(limited(3.0_rk, 2.0_rk, 1.0_rk), -0.5_rk, 1.0e-15_rk, "falling")
   end subroutine limits

end program test_heat_links
