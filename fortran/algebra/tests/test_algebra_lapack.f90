!> The declarations of LAPACK: systems whose solutions are whole numbers, and matrices it refuses;
!! dense operations in blocks.
program test_algebra_lapack
   use algebra_blocks, only: factorize_lu, subtract_square
   use algebra_lapack, only: dgesv, dgetrf, dgetrs, dlacn2, dpotrf, dpotrs, symmetric_product
   use base_kinds, only: ik, rk
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: tolerance = 1.0e-14_rk  !< relative to solutions of size 3
   type(checks_t) :: checks

   call general()
   call positive_definite()
   call refused()
   call estimated_norm()
   call products()
   call blocks()
   call checks%finish()

contains

   !> A = [0 2 1; 1 1 0; 3 0 2], whose zero asks for an exchange; solutions [1 2 3], [-1 0 2].
   subroutine general()
      real(rk), parameter :: a(3, 3) = reshape([0.0_rk, 1.0_rk, 3.0_rk, 2.0_rk, 1.0_rk, 0.0_rk, &
                                                1.0_rk, 0.0_rk, 2.0_rk], [3, 3])
      real(rk), parameter :: x(3, 2) = reshape([1.0_rk, 2.0_rk, 3.0_rk, -1.0_rk, 0.0_rk, 2.0_rk], &
                                               [3, 2])
      real(rk), parameter :: b(3, 2) = reshape([7.0_rk, 3.0_rk, 9.0_rk, 2.0_rk, -1.0_rk, 1.0_rk], &
                                               [3, 2])
      real(rk), parameter :: b_transposed(3) = [11.0_rk, 4.0_rk, 7.0_rk]
      real(rk) :: factors(3, 3), solution(3, 2)
      integer(ik) :: exchanges(3), info

      factors = a
      solution = b
      call dgesv(3_ik, 2_ik, factors, 3_ik, exchanges, solution, 3_ik, info)
      call checks%is_true(info == 0, "dgesv succeeds")
      call checks%is_close(maxval(abs(solution - x)), 0.0_rk, tolerance, "dgesv")
      call checks%is_true(exchanges(1) == 3, "the largest entry becomes the pivot")

      factors = a
      call dgetrf(3_ik, 3_ik, factors, 3_ik, exchanges, info)
      call checks%is_true(info == 0, "dgetrf succeeds")
      solution = b
      call dgetrs("N", 3_ik, 2_ik, factors, 3_ik, exchanges, solution, 3_ik, info)
      call checks%is_true(info == 0, "dgetrs succeeds")
      call checks%is_close(maxval(abs(solution - x)), 0.0_rk, tolerance, "dgetrs")
      solution(:, 1) = b_transposed
      call dgetrs("T", 3_ik, 1_ik, factors, 3_ik, exchanges, solution, 3_ik, info)
      call checks%is_close(maxval(abs(solution(:, 1) - x(:, 1))), 0.0_rk, tolerance, &
                           "dgetrs, transposed")
   end subroutine general

   !> A = L L' with L = [2 0 0; 1 3 0; -1 2 1]; the triangle that is not asked for may hold
   !! anything.
   subroutine positive_definite()
      real(rk), parameter :: other = huge(1.0_rk)
      real(rk), parameter :: lower(3, 3) = reshape([4.0_rk, 2.0_rk, -2.0_rk, other, 10.0_rk, &
                                                    5.0_rk, other, other, 6.0_rk], [3, 3])
      real(rk), parameter :: factor(6) = [2.0_rk, 1.0_rk, -1.0_rk, 3.0_rk, 2.0_rk, 1.0_rk]
      real(rk), parameter :: x(3) = [1.0_rk, 2.0_rk, 3.0_rk]
      real(rk), parameter :: b(3) = [2.0_rk, 37.0_rk, 26.0_rk]
      real(rk) :: a(3, 3), solution(3, 1)
      integer(ik) :: info

      a = lower
      call dpotrf("L", 3_ik, a, 3_ik, info)
      call checks%is_true(info == 0, "dpotrf succeeds")
      call checks%is_close(maxval(abs([a(:, 1), a(2:, 2), a(3, 3)] - factor)), 0.0_rk, tolerance, &
                           "dpotrf")
      solution(:, 1) = b
      call dpotrs("L", 3_ik, 1_ik, a, 3_ik, solution, 3_ik, info)
      call checks%is_true(info == 0, "dpotrs succeeds")
      call checks%is_close(maxval(abs(solution(:, 1) - x)), 0.0_rk, tolerance, "dpotrs")

      a = transpose(lower)
      call dpotrf("U", 3_ik, a, 3_ik, info)
      solution(:, 1) = b
      call dpotrs("U", 3_ik, 1_ik, a, 3_ik, solution, 3_ik, info)
      call checks%is_close(maxval(abs(solution(:, 1) - x)), 0.0_rk, tolerance, &
                           "dpotrs from the upper triangle")
   end subroutine positive_definite

   !> `info` names the pivot that fails.
   subroutine refused()
      real(rk) :: a(2, 2), b(2, 1)
      integer(ik) :: exchanges(2), info

      a = reshape([1.0_rk, 2.0_rk, 2.0_rk, 4.0_rk], [2, 2])
      b = 1.0_rk
      call dgesv(2_ik, 1_ik, a, 2_ik, exchanges, b, 2_ik, info)
      call checks%is_true(info == 2, "a singular matrix")
      a = reshape([1.0_rk, 2.0_rk, 2.0_rk, 1.0_rk], [2, 2])
      call dpotrf("L", 2_ik, a, 2_ik, info)
      call checks%is_true(info == 2, "an indefinite matrix")
   end subroutine refused

   !> The 1-norm of A = [0 -2 1; 1 1 0; 3 0 2] from its products: 4, by its first column.
   subroutine estimated_norm()
      real(rk), parameter :: a(3, 3) = reshape([0.0_rk, 1.0_rk, 3.0_rk, -2.0_rk, 1.0_rk, 0.0_rk, &
                                                1.0_rk, 0.0_rk, 2.0_rk], [3, 3])
      real(rk) :: norm, v(3), x(3)
      integer(ik) :: kase, save(3), signs(3)

      kase = 0
      do
         call dlacn2(3_ik, v, x, signs, norm, kase, save)
         if (kase == 0) exit
         if (kase == 1) x = matmul(a, x)
         if (kase == 2) x = matmul(x, a)
      end do
      call checks%is_close(norm, 4.0_rk, tolerance, "dlacn2")
   end subroutine estimated_norm

   !> The products of a symmetric matrix with vectors: row i of a matrix of ones on and next to the
   !! diagonal sums up three entries. They have the same bits wherever the arrays lie in memory, and
   !! only one triangle is read.
   subroutine products()
      integer(ik), parameter :: n = 131
      real(rk) :: store(n*n + 8), x_store(n + 8), x(n), y(n), first(n)
      integer(ik) :: i, shift

      x = [(sin(real(i, rk)), i=1, n)]
      do shift = 0, 7
         x_store(shift + 1:shift + n) = x
         call fill(store(shift + 1:shift + n*n))
         call multiply(store(shift + 1:shift + n*n), x_store(shift + 1:shift + n), y)
         if (shift == 0) first = y
         call checks%is_true(all(abs(y - first) <= 0.0_rk), "the same bits")
      end do
      y = y - x
      y(2:) = y(2:) - x(:n - 1)
      y(:n - 1) = y(:n - 1) - x(2:)
      call checks%is_close(maxval(abs(y)), 0.0_rk, tolerance, "symmetric product")
   end subroutine products

   pure subroutine fill(matrix)
      real(rk), intent(out) :: matrix(131, 131)
      integer(ik) :: i, j

      do j = 1, 131
         do i = 1, 131
            matrix(i, j) = merge(1.0_rk, 0.0_rk, i - j <= 1 .and. i >= j)
            if (i < j) matrix(i, j) = huge(1.0_rk)
         end do
      end do
   end subroutine fill

   subroutine multiply(matrix, x, y)
      real(rk), intent(in) :: matrix(131, 131), x(:)
      real(rk), intent(out) :: y(:)

      y = symmetric_product(matrix, x)
   end subroutine multiply

   !> Matrices of several blocks: a system with a known solution, one that is singular, and the
   !! square of the columns under the pivots.
   subroutine blocks()
      integer(ik), parameter :: n = 300, n_pivots = 40, lost = 200
      real(rk) :: a(n, n), factors(n, n), x(n), b(n, 1)
      integer(ik) :: exchanges(n), i, info, j

      a = reshape([((modulo(real(i*i*j + 7*i + 3*j*j, rk), 101.0_rk) - 50.0_rk, i=1, n), &
                    j=1, n)], [n, n])
      x = [(real(modulo(i, 7_ik) - 3, rk), i=1, n)]
      do i = 1, n  ! the largest terms above the diagonal ask for exchanges
         a(modulo(i, n) + 1, i) = a(modulo(i, n) + 1, i) + 5.0e3_rk
      end do
      factors = a
      call factorize_lu(n, factors, exchanges, info)
      call checks%is_true(info == 0, "blocks are factorized")
      b(:, 1) = matmul(a, x)
      call dgetrs("N", n, 1_ik, factors, n, exchanges, b, n, info)
      call checks%is_close(maxval(abs(b(:, 1) - x)), 0.0_rk, 1.0e-11_rk, "their solution")

      factors = 0.0_rk
      do i = 1, n
         factors(i, i) = merge(0.0_rk, 2.0_rk, i == lost)
      end do
      call factorize_lu(n, factors, exchanges, info)
      call checks%is_true(info == lost, "a pivot of zero in a later block")

      factors = a
      call subtract_square(n, n_pivots, factors)
      do i = n_pivots + 1, n
         b(i:, 1) = a(i:, i) - matmul(a(i:, :n_pivots), a(i, :n_pivots))
         call checks%is_close(maxval(abs(b(i:, 1) - factors(i:, i))), 0.0_rk, 1.0e-9_rk, &
                              "a square in blocks")
      end do
   end subroutine blocks

end program test_algebra_lapack
