!> MUMPS wrapper: known solutions, the Schur complement against dense elimination, singular
!! matrices.
program test_algebra_mumps
   use algebra_mumps, only: mumps_definite, mumps_indefinite, mumps_pord, mumps_t, mumps_unsymmetric
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks
   type(error_t), allocatable :: error

   call solves_a_chain()
   call condenses()
   call solves_unsymmetric()
   call refuses_singular()
   call checks%finish()

contains

   !> Second differences: -u'' = 2 on (0, 1) has the solution x(1-x) at the nodes, exactly.
   subroutine solves_a_chain()
      integer(ik), parameter :: n = 50
      type(mumps_t) :: solver
      integer(ik) :: row(2*n - 1), col(2*n - 1), i
      real(rk) :: values(2*n - 1), x(n, 2), h

      h = 1.0_rk/real(n + 1, rk)
      row(:n) = [(i, i=1, n)]
      col(:n) = row(:n)
      values(:n) = 2.0_rk/h**2
      row(n + 1:) = [(i + 1, i=1, n - 1)]
      col(n + 1:) = [(i, i=1, n - 1)]
      values(n + 1:) = -1.0_rk/h**2
      call solver%analyse(n, row, col, mumps_definite, error)
      call checks%no_error(error, "analyse")
      call solver%factorize(values, error)
      call checks%no_error(error, "factorize")
      x(:, 1) = 2.0_rk
      x(:, 2) = 4.0_rk
      call solver%solve(x, error)
      call checks%no_error(error, "solve")
      call checks%is_close(maxval(abs(x(:, 1) - [(i*h*(1.0_rk - i*h), i=1, n)])), 0.0_rk, &
                           1.0e-13_rk, "parabola")
      call checks%is_close(maxval(abs(x(:, 2) - 2.0_rk*x(:, 1))), 0.0_rk, 1.0e-13_rk, "two sides")
      call solver%factorize(2.0_rk*values, error)
      x(:, 1) = 4.0_rk
      call solver%solve(x(:, :1), error)
      call checks%is_close(x(n/2, 1), (n/2)*h*(1.0_rk - (n/2)*h), 1.0e-13_rk, "values replaced")
   end subroutine solves_a_chain

   !> [A B; B^T C] with A = [4 1; 1 -3], B = [1 2; 0 1], C = [2 1; 1 5]: S = C - B^T A^-1 B by hand.
   subroutine condenses()
      type(mumps_t) :: solver
      integer(ik), parameter :: row(9) = [1, 2, 2, 3, 4, 4, 3, 4, 4]
      integer(ik), parameter :: col(9) = [1, 1, 2, 1, 1, 2, 3, 3, 4]
      real(rk), parameter :: values(9) = [4.0_rk, 1.0_rk, -3.0_rk, 1.0_rk, 2.0_rk, 1.0_rk, 2.0_rk, &
                                          1.0_rk, 5.0_rk]
      real(rk) :: s(2, 2), expected(2, 2), reduced(2), x(4), y(2), rhs(4), det

      call solver%analyse(4_ik, row, col, mumps_indefinite, error, schur=[3_ik, 4_ik])
      call checks%no_error(error, "analyse with Schur")
      call solver%factorize(values, error)
      call checks%no_error(error, "factorize with Schur")
      call solver%get_schur(s)
      ! A^-1 = [3 1; 1 -4]/13; B^T A^-1 B = [3 7; 7 12]/13
      expected = reshape([2.0_rk - 3.0_rk/13.0_rk, 1.0_rk - 7.0_rk/13.0_rk, &
                          1.0_rk - 7.0_rk/13.0_rk, 5.0_rk - 12.0_rk/13.0_rk], [2, 2])
      call checks%is_close(maxval(abs(s - expected)), 0.0_rk, 1.0e-14_rk, "Schur complement")
      rhs = [1.0_rk, 2.0_rk, 3.0_rk, 4.0_rk]
      call solver%condense(rhs, reduced, error)
      call checks%no_error(error, "condense")
      ! 3 - [1 0].A^-1[1 2], 4 - [2 1].A^-1[1 2] with A^-1 [1 2] = [5, -7]/13
      call checks%is_close(reduced(1), 3.0_rk - 5.0_rk/13.0_rk, 1.0e-14_rk, "reduced side 1")
      call checks%is_close(reduced(2), 4.0_rk - 3.0_rk/13.0_rk, 1.0e-14_rk, "reduced side 2")
      det = s(1, 1)*s(2, 2) - s(1, 2)**2
      y = [s(2, 2)*reduced(1) - s(1, 2)*reduced(2), s(1, 1)*reduced(2) - s(1, 2)*reduced(1)]/det
      call solver%expand(y, x, error)
      call checks%no_error(error, "expand")
      call checks%is_close(4.0_rk*x(1) + x(2) + x(3) + 2.0_rk*x(4), 1.0_rk, 1.0e-13_rk, "row 1")
      call checks%is_close(x(1) - 3.0_rk*x(2) + x(4), 2.0_rk, 1.0e-13_rk, "row 2")
      call checks%is_close(x(1) + 2.0_rk*x(3) + x(4), 3.0_rk, 1.0e-13_rk, "row 3")
      call checks%is_close(2.0_rk*x(1) + x(2) + x(3) + 5.0_rk*x(4), 4.0_rk, 1.0e-13_rk, "row 4")
   end subroutine condenses

   !> A = [0 2 1; 1 1 0; 3 0 2], an entry of it in two parts; A [1 2 3] and A' [1 2 3].
   subroutine solves_unsymmetric()
      type(mumps_t) :: solver
      integer(ik), parameter :: row(7) = [1, 1, 2, 2, 3, 3, 3]
      integer(ik), parameter :: col(7) = [2, 3, 1, 2, 1, 3, 3]
      real(rk), parameter :: values(7) = [2.0_rk, 1.0_rk, 1.0_rk, 1.0_rk, 3.0_rk, 0.5_rk, 1.5_rk]
      real(rk), parameter :: expected(3) = [1.0_rk, 2.0_rk, 3.0_rk]
      integer(ik), allocatable :: col_kept(:), row_kept(:)
      real(rk), allocatable :: values_kept(:)
      real(rk) :: x(3, 1)

      solver%ordering = mumps_pord
      call solver%analyse(3_ik, row, col, mumps_unsymmetric, error)
      call checks%no_error(error, "analyse an unsymmetric matrix")
      call solver%factorize(values, error)
      call checks%no_error(error, "factorize an unsymmetric matrix")
      x(:, 1) = [7.0_rk, 3.0_rk, 9.0_rk]
      call solver%solve(x, error)
      call checks%is_close(maxval(abs(x(:, 1) - expected)), 0.0_rk, 1.0e-14_rk, "unsymmetric")
      x(:, 1) = [11.0_rk, 4.0_rk, 7.0_rk]
      call solver%solve(x, error, transposed=.true.)
      call checks%is_close(maxval(abs(x(:, 1) - expected)), 0.0_rk, 1.0e-14_rk, "transposed")
      x(:, 1) = [7.0_rk, 3.0_rk, 9.0_rk]
      call solver%solve(x, error)
      call checks%is_close(maxval(abs(x(:, 1) - expected)), 0.0_rk, 1.0e-14_rk, "and back again")
      call solver%get_entries(row_kept, col_kept, values_kept)
      call checks%is_true(all(row_kept == row) .and. all(col_kept == col), "pattern is kept")
      call checks%is_close(maxval(abs(values_kept - values)), 0.0_rk, 0.0_rk, "values are kept")
   end subroutine solves_unsymmetric

   subroutine refuses_singular()
      type(mumps_t) :: solver
      real(rk) :: nothing

      call solver%analyse(2_ik, [1_ik, 2_ik, 2_ik], [1_ik, 1_ik, 2_ik], mumps_indefinite, error)
      call solver%factorize([1.0_rk, 1.0_rk, 1.0_rk], error)
      call checks%fails_with(error, "singular", "singular matrix")
      nothing = 0.0_rk
      call solver%factorize([1.0_rk, nothing/nothing, 1.0_rk], error)
      call checks%fails_with(error, "finite", "NaN in the matrix")
   end subroutine refuses_singular

end program test_algebra_mumps
