!> Competing tips: small systems with solutions by hand.
program test_growth_competition
   use base_kinds, only: rk
   use growth_competition, only: complementary_advances, broyden_update, preference
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks

   call test_learning()
   call test_preference()
   call test_complementarity()
   call test_runners()
   call checks%finish()

contains

   !> Trials along the axes give the matrix of a linear response.
   subroutine test_learning()
      real(rk) :: learnt(2, 2), true(2, 2)

      true = reshape([-3.0_rk, 0.5_rk, 1.0_rk, -2.0_rk], [2, 2])
      learnt = 0.0_rk
      call broyden_update(learnt, [0.1_rk, 0.0_rk], matmul(true, [0.1_rk, 0.0_rk]))
      call broyden_update(learnt, [0.0_rk, 0.2_rk], matmul(true, [0.0_rk, 0.2_rk]))
      call checks%is_close(maxval(abs(learnt - true)), 0.0_rk, 1.0e-14_rk, "two trials")
      call broyden_update(learnt, [0.0_rk, 0.0_rk], [1.0_rk, 1.0_rk])
      call checks%is_close(maxval(abs(learnt - true)), 0.0_rk, 1.0e-14_rk, "no change, no lesson")
   end subroutine test_learning

   !> Equal tips, M = [m -k; -k m]: a lead changes the intensities by m + k. For n tips the
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
      ! The load does work on the second tip alone: the advance of the first is free.
      matrix(:2, :2) = reshape([3.0_rk, 7.0_rk, 7.0_rk, -9.0_rk], [2, 2])
      call checks%is_close(preference(matrix(:2, :2), [0.0_rk, 1.0_rk]), 3.0_rk, 1.0e-13_rk, &
                           "where the load does no work")
      call checks%is_true(preference(matrix(:1, :1), [1.0_rk]) < 0.0_rk, "nobody to compete with")
   end subroutine test_preference

   !> Stable systems of many tips have one solution, which satisfies all conditions; the order of
   !! the tips does not matter.
   subroutine test_complementarity()
      integer, parameter :: n = 6
      real(rk), dimension(n) :: change, excess, left, lower, turned, upper
      real(rk) :: matrix(n, n)
      integer :: i, j, k

      do k = 1, 50
         do j = 1, n
            do i = 1, n
               matrix(i, j) = 0.3_rk*sin(real(7*i + 5*j + 3*k, rk))
            end do
            matrix(j, j) = -2.0_rk - 0.1_rk*j
            excess(j) = sin(real(11*j + k*k, rk))
            lower(j) = -0.1_rk*modulo(j + k, 3)
            upper(j) = 0.1_rk*(1 + modulo(j*k, 4))
         end do
         call complementary_advances(excess, matrix, lower, upper, change)
         left = excess + matmul(matrix, change)
         call checks%is_true(all(change >= lower .and. change <= upper), "within bounds")
         call checks%is_true(all(abs(left) <= 1.0e-9_rk .or. &
                                 (left < 0.0_rk .and. change <= lower) .or. &
                                 (left > 0.0_rk .and. change >= upper)), "all are at rest")
         call complementary_advances(excess(n:1:-1), matrix(n:1:-1, n:1:-1), lower(n:1:-1), &
                                     upper(n:1:-1), turned)
         call checks%is_close(maxval(abs(turned(n:1:-1) - change)), 0.0_rk, 1.0e-8_rk, &
                              "in any order")
      end do
   end subroutine test_complementarity

   !> Where equal growth is not stable, the leading tip advances and the other stays; two tips that
   !! promote each other advance to their bounds.
   subroutine test_runners()
      real(rk), parameter :: zero(2) = 0.0_rk, far(2) = 5.0_rk
      real(rk) :: change(2), shadow(2, 2)

      shadow = reshape([-1.0_rk, -2.0_rk, -2.0_rk, -1.0_rk], [2, 2])
      call complementary_advances([1.0_rk, 0.999_rk], shadow, zero, far, change)
      call checks%is_close(maxval(abs(change - [1.0_rk, 0.0_rk])), 0.0_rk, 1.0e-14_rk, "the first")
      call complementary_advances([0.999_rk, 1.0_rk], shadow, zero, far, change)
      call checks%is_close(maxval(abs(change - [0.0_rk, 1.0_rk])), 0.0_rk, 1.0e-14_rk, "the second")
      ! The second tip is hardly shielded, but shields: it advances until the first has returned.
      call complementary_advances([1.0_rk, 0.9_rk], &
                                  reshape([-1.0_rk, -0.5_rk, -4.0_rk, -1.0_rk], [2, 2]), zero, &
                                  far, change)
      call checks%is_close(maxval(abs(change - [0.0_rk, 0.9_rk])), 0.0_rk, 1.0e-14_rk, &
                           "the one that wins")
      call complementary_advances([1.0_rk, 0.5_rk], -shadow - reshape([2.0_rk, 0.0_rk, 0.0_rk, &
                                                                       2.0_rk], [2, 2]), zero, &
                                  far, change)
      call checks%is_close(maxval(abs(change - far)), 0.0_rk, 1.0e-14_rk, "both run away")
   end subroutine test_runners

end program test_growth_competition
