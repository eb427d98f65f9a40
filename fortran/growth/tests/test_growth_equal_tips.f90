!> Tip groups: equal tips count as one, whatever their order.
program test_growth_equal_tips
   use base_kinds, only: ik, rk
   use growth_competition, only: likes, matrix_of_groups, means, numbered, values_of_groups
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks

   call test_likes()
   call test_values()
   call checks%finish()

contains

   !> Of six tips 2, 5, 4 form a chain, and 1 and 6 a pair that is marked for only one of them; any
   !! order of the tips leads to the same groups.
   subroutine test_likes()
      integer(ik), parameter :: expected(6) = [1_ik, 2_ik, 3_ik, 2_ik, 2_ik, 1_ik]
      logical :: alike(6, 6), turned(6, 6)
      integer(ik) :: first(6), order(6), shift
      integer :: i, j

      alike = .false.
      alike(5, 2) = .true.
      alike(4, 5) = .true.
      alike(1, 6) = .true.
      call checks%is_true(all(likes(alike) == expected), "chains and pairs")
      do shift = 1, 5
         order = [(1_ik + modulo(5_ik*int(i, ik) + shift, 6_ik), i=1, 6)]
         turned = alike(order, order)
         first = likes(turned)
         do j = 1, 6
            do i = 1, 6
               call checks%is_true((first(i) == first(j)) .eqv. &
                                   (expected(order(i)) == expected(order(j))), "in any order")
            end do
         end do
      end do
      call checks%is_true(all(numbered(expected) == [1_ik, 2_ik, 3_ik, 2_ik, 2_ik, 1_ik]), &
                          "numbers")
      call checks%is_true(all(numbered([7_ik, 3_ik, 7_ik, 9_ik]) == [1_ik, 2_ik, 1_ik, 3_ik]), &
                          "numbers of marks")
   end subroutine test_likes

   !> Two groups of three tips: changes of the group means if the first and third tip advance by
   !! one.
   subroutine test_values()
      integer(ik), parameter :: kind(3) = [1_ik, 2_ik, 1_ik]
      real(rk) :: matrix(3, 3), moved(3), reduced(2, 2)

      matrix = reshape([-3.0_rk, 1.0_rk, 0.5_rk, 2.0_rk, -5.0_rk, 4.0_rk, 0.25_rk, 1.5_rk, &
                        -2.0_rk], [3, 3])
      reduced = matrix_of_groups(kind, matrix)
      moved = means(kind, matmul(matrix, [1.0_rk, 0.0_rk, 1.0_rk]))
      call checks%is_close(maxval(abs(reduced(:, 1) - values_of_groups(kind, moved))), 0.0_rk, &
                           1.0e-15_rk, &
                           "a kind moves")
      moved = means(kind, matmul(matrix, [0.0_rk, 1.0_rk, 0.0_rk]))
      call checks%is_close(maxval(abs(reduced(:, 2) - values_of_groups(kind, moved))), 0.0_rk, &
                           1.0e-15_rk, &
                           "one alone moves")
   end subroutine test_values

end program test_growth_equal_tips
