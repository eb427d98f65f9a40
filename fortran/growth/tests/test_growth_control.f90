!> Tips in length control: small groups with solutions by hand.
program test_growth_control
   use base_kinds, only: ik, rk
   use growth_control, only: fitted, joined_groups, length_control_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks

   call test_linear()
   call test_fit()
   call checks%finish()

contains

   !> K_1 = f - 2 a_1, K_2 = f - 4 a_2 - 0.4, K_IC = 1, segments of 1 m: tip 1 reaches its end at f
   !! = 3, and tip 2 advances by 0.4 m. With K_2 = f - 4 a_2 - 2.5 tip 2 needs f = 3.5 and stays.
   subroutine test_linear()
      real(rk) :: advance(2)

      call solve([2.0_rk, 4.0_rk], [0.0_rk, -0.4_rk], [1.0_rk, 1.0_rk], [1.0_rk, 1.0_rk], advance)
      call checks%is_close(maxval(abs(advance - [1.0_rk, 0.4_rk])), 0.0_rk, 2.0e-3_rk, "goes back")
      call solve([2.0_rk, 4.0_rk], [0.0_rk, -0.4_rk], [1.0_rk, 1.0_rk], [1.0_rk, 0.0_rk], advance)
      call checks%is_close(maxval(abs(advance - [1.0_rk, 0.4_rk])), 0.0_rk, 2.0e-3_rk, "goes on")
      call solve([2.0_rk, 4.0_rk], [0.0_rk, -2.5_rk], [1.0_rk, 1.0_rk], [1.0_rk, 1.0_rk], advance)
      call checks%is_close(maxval(abs(advance - [1.0_rk, 0.0_rk])), 0.0_rk, 0.0_rk, "stays behind")
      ! Tip 2 is ahead: K_2 = f + 1 - 4 a_2 reaches its end at f = 4, tip 1 at f = 3 before: tip 1
      ! leads, and tip 2 advances by 0.75 m. On a segment of 0.5 m tip 2 leads, at f = 2; tip 1
      ! advances by 0.5 m.
      call solve([2.0_rk, 4.0_rk], [0.0_rk, 1.0_rk], [1.0_rk, 1.0_rk], [0.0_rk, 1.0_rk], advance)
      call checks%is_close(maxval(abs(advance - [1.0_rk, 0.75_rk])), 0.0_rk, 2.0e-3_rk, "leader")
      call solve([2.0_rk, 4.0_rk], [0.0_rk, 1.0_rk], [1.0_rk, 0.5_rk], [1.0_rk, 0.0_rk], advance)
      call checks%is_close(maxval(abs(advance - [0.5_rk, 0.5_rk])), 0.0_rk, 2.0e-3_rk, &
                           "another leader")
   end subroutine test_linear

   !> Length control of tips with K_i = f + offset_i - fall_i a_i and K_IC = 1.
   subroutine solve(fall, offset, room, start, advance)
      real(rk), intent(in) :: fall(2), offset(2), room(2), start(2)
      real(rk), intent(out) :: advance(2)
      type(length_control_t) :: control
      real(rk) :: excess(2), matrix(2, 2)
      logical :: has_moved
      integer :: try

      advance = start
      matrix = reshape([-0.5_rk*fall(1), 0.0_rk, 0.0_rk, -1.5_rk*fall(2)], [2, 2])  ! poor estimate
      control%tolerance = 5.0e-3_rk
      do try = 1, 15
         excess = offset - fall*advance
         excess = excess - maxval(excess)  ! the load is such that no tip exceeds its toughness
         call control%improve(excess, matrix, [1.0_rk, 1.0_rk], room, [0.0_rk, 0.0_rk], &
                              advance, has_moved)
         if (.not. has_moved) exit
      end do
      call checks%is_true(.not. has_moved, "length control ends")
   end subroutine solve

   !> The first tip reaches the end of its segment, and no advance is too short.
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
