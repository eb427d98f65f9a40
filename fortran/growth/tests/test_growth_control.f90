!> Tips in length control: small groups whose answers are written down by hand.
program test_growth_control
   use base_kinds, only: ik, rk
   use growth_competition, only: better_advances, fitted, joined_groups
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks

   call test_kinds()
   call test_fit()
   call checks%finish()

contains

   !> Tips 1 and 3 are alike, K = f - 2 a; tip 2 lies behind, K = f - 4 a - 0.4: at f = 3 and a = 1
   !! these are 1 and -1.4, K_IC = 1, and the lack of tip 2 is made up by going back 0.6.
   subroutine test_kinds()
      integer(ik), parameter :: kind(3) = [1_ik, 2_ik, 1_ik]
      real(rk) :: advance(3), matrix(3, 3)

      matrix = 0.0_rk
      matrix(1, [1, 3]) = -1.0_rk
      matrix(3, [1, 3]) = -1.0_rk
      matrix(2, 2) = -4.0_rk
      advance = 1.0_rk
      call better_advances(kind, [0.0_rk, 2.4_rk, 0.0_rk], matrix, spread(1.0_rk, 1, 3), &
                           spread(1.0_rk, 1, 3), 0.01_rk, advance)
      call checks%is_close(maxval(abs(advance - [1.0_rk, 0.4_rk, 1.0_rk])), 0.0_rk, 1.0e-14_rk, &
                           "one kind goes back")
      advance = [1.0_rk, 0.0_rk, 1.0_rk]
      call better_advances(kind, [0.0_rk, 2.4_rk, 0.0_rk], matrix, spread(1.0_rk, 1, 3), &
                           spread(1.0_rk, 1, 3), 0.01_rk, advance)
      call checks%is_close(maxval(abs(advance - [1.0_rk, 0.0_rk, 1.0_rk])), 0.0_rk, 1.0e-14_rk, &
                           "one that stays and is behind")
   end subroutine test_kinds

   !> The first tip comes to the end of its piece, and nothing is too short.
   subroutine test_fit()
      real(rk) :: fit(3)

      fit = fitted([0.2_rk, 0.1_rk, 0.001_rk], [0.4_rk, 0.4_rk, 0.4_rk], &
                   [0.0_rk, 0.1_rk, 0.0_rk], 0.02_rk)
      call checks%is_close(maxval(abs(fit - [0.4_rk, 0.2_rk, 0.0_rk])), 0.0_rk, 1.0e-15_rk, &
                           "in proportion")
      fit = fitted([0.4_rk, 1.0e-4_rk, 1.0e-3_rk], spread(0.4_rk, 1, 3), spread(0.1_rk, 1, 3), &
                   0.02_rk)
      call checks%is_close(maxval(abs(fit - [0.4_rk, 0.0_rk, 1.0e-3_rk])), 0.0_rk, 1.0e-15_rk, &
                           "on a piece that is open, less than a thousandth of it is none")
      fit = fitted([0.0_rk, 0.0_rk, 0.0_rk], [0.4_rk, 0.3_rk, 0.2_rk], spread(0.0_rk, 1, 3), &
                   0.02_rk)
      call checks%is_close(maxval(abs(fit - [0.4_rk, 0.3_rk, 0.2_rk])), 0.0_rk, 0.0_rk, &
                           "nothing is known")
      call checks%is_true(all(joined_groups([2_ik, 5_ik], [1_ik, 2_ik]) == [1_ik, 2_ik, 5_ik]), &
                          "two groups")
   end subroutine test_fit

end program test_growth_control
