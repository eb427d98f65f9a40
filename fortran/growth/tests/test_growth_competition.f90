!> Tips that compete: small systems whose answers are written down by hand.
program test_growth_competition
   use testing_checks, only: checks_t
   use base_kinds, only: ik, rk
   use growth_competition, only: corrected_advances, learn_from_trial, preference
   implicit none(type, external)

   type(checks_t) :: checks

   call test_correction()
   call test_learning()
   call test_preference()
   call checks%finish()

contains

   !> Two tips: the first is given, the second and the load bring both to their toughness.
   subroutine test_correction()
      real(rk) :: change(2)

      ! K_1 = -2 a_1 + f, K_2 = -4 a_2 + f + 1 at a = 1: K_1 = f - 2, K_2 = f - 3, K_IC = 1, f = 3.
      call corrected_advances([0.0_rk, 1.0_rk], &
                              reshape([-2.0_rk, 0.0_rk, 0.0_rk, -4.0_rk], [2, 2]), &
                              [1.0_rk, 1.0_rk], 1_ik, change)
      call checks%is_close(change(1), 0.0_rk, 0.0_rk, "the leader is given")
      call checks%is_close(change(2), -0.25_rk, 1.0e-14_rk, "the other goes back")
      call corrected_advances([0.0_rk, 1.0_rk], reshape([0.0_rk, 0.0_rk, 0.0_rk, 0.0_rk], [2, 2]), &
                              [1.0_rk, 1.0_rk], 1_ik, change)
      call checks%is_close(sum(abs(change)), 0.0_rk, 0.0_rk, "nothing to tell them apart")
   end subroutine test_correction

   !> Trials along the axes give the matrix of a linear answer.
   subroutine test_learning()
      real(rk) :: learnt(2, 2), true(2, 2)

      true = reshape([-3.0_rk, 0.5_rk, 1.0_rk, -2.0_rk], [2, 2])
      learnt = 0.0_rk
      call learn_from_trial(learnt, [0.1_rk, 0.0_rk], matmul(true, [0.1_rk, 0.0_rk]))
      call learn_from_trial(learnt, [0.0_rk, 0.2_rk], matmul(true, [0.0_rk, 0.2_rk]))
      call checks%is_close(maxval(abs(learnt - true)), 0.0_rk, 1.0e-14_rk, "two trials")
      call learn_from_trial(learnt, [0.0_rk, 0.0_rk], [1.0_rk, 1.0_rk])
      call checks%is_close(maxval(abs(learnt - true)), 0.0_rk, 1.0e-14_rk, "no change, no lesson")
   end subroutine test_learning

   !> Equal tips, M = [m -k; -k m]: a lead changes the intensities by m + k. For n of them the
   !! eigenvalues on sum(da) = 0 are m + k, n - 1 times.
   subroutine test_preference()
      real(rk) :: matrix(4, 4)
      integer :: i, n

      do n = 2, 4
         matrix = -2.0_rk
         do i = 1, n
            matrix(i, i) = -1.0_rk
         end do
         call checks%is_close(preference(matrix(:n, :n), spread(5.0_rk, 1, n)), 1.0_rk, &
                              1.0e-13_rk, "one of equal tips could run ahead")
         matrix = matrix + 4.0_rk
         do i = 1, n
            matrix(i, i) = matrix(i, i) - 6.0_rk
         end do
         call checks%is_close(preference(matrix(:n, :n), spread(1.0_rk, 1, n)), -5.0_rk, &
                              1.0e-13_rk, "they grow together")
      end do
      ! The load works on the second tip alone: the first is left to itself.
      matrix(:2, :2) = reshape([3.0_rk, 7.0_rk, 7.0_rk, -9.0_rk], [2, 2])
      call checks%is_close(preference(matrix(:2, :2), [0.0_rk, 1.0_rk]), 3.0_rk, 1.0e-13_rk, &
                           "where the load does no work")
      call checks%is_true(preference(matrix(:1, :1), [1.0_rk]) < 0.0_rk, "nobody to compete with")
   end subroutine test_preference

end program test_growth_competition
