!> Dense operations in blocks of columns that threads share. The blocks do not depend on the number
!! of threads, and so do not the results.
module algebra_blocks
   use algebra_lapack, only: dgemm, dgetrf, dlaswp, dsyrk, dtrsm
   use base_kinds, only: ik, rk
!$ use omp_lib, only: omp_get_num_threads
   implicit none(type, external)
   private

   public :: factorize_lu, is_in_team, subtract_square

   !> Columns of a block of each operation: fewer cost more of the libraries' time.
   integer(ik), parameter :: lu_columns = 128, square_columns = 256

contains

   !> Whether this is called by one thread of a team. Its tasks are shared with those that have
   !! nothing else to do then; elsewhere they need a team.
   logical function is_in_team()

      is_in_team = .false.
!$    is_in_team = omp_get_num_threads() > 1
   end function is_in_team

   !> Replace a matrix by its factors L and U with row interchanges, as dgetrf does.
   subroutine factorize_lu(n, matrix, pivots, info)
      integer(ik), intent(in) :: n
      real(rk), intent(inout) :: matrix(n, n)
      integer(ik), intent(out) :: pivots(n)
      integer(ik), intent(out) :: info  !< a pivot that is 0; 0: none
      integer(ik) :: at, first, m

      info = 0
      do first = 1, n, lu_columns
         m = min(lu_columns, n - first + 1)
         call dgetrf(n - first + 1, m, matrix(first, first), n, pivots(first), at)
         if (at > 0 .and. info == 0) info = first - 1 + at
         pivots(first:first + m - 1) = pivots(first:first + m - 1) + first - 1
         if (first > 1) call dlaswp(first - 1, matrix, n, first, first + m - 1, pivots, 1_ik)
         if (first + m > n) exit
         if (is_in_team()) then
            call update_columns(n, matrix, first, m, pivots)
         else
            !$omp parallel if(n - first - m > 2*lu_columns)
            !$omp single
            call update_columns(n, matrix, first, m, pivots)
            !$omp end single
            !$omp end parallel
         end if
      end do
   end subroutine factorize_lu

   !> Eliminate the pivots of m columns from the columns after them.
   subroutine update_columns(n, matrix, first, m, pivots)
      integer(ik), intent(in) :: n
      real(rk), intent(inout) :: matrix(n, n)
      integer(ik), intent(in) :: first, m
      integer(ik), intent(in) :: pivots(n)
      integer(ik) :: at, k

      !$omp taskloop grainsize(1) default(shared) private(k)
      do at = first + m, n, lu_columns
         k = min(lu_columns, n - at + 1)
         call dlaswp(k, matrix(1, at), n, first, first + m - 1, pivots, 1_ik)
         call dtrsm("L", "L", "N", "U", m, k, 1.0_rk, matrix(first, first), n, matrix(first, at), n)
         call dgemm("N", "N", n - first - m + 1, k, m, -1.0_rk, matrix(first + m, first), n, &
                    matrix(first, at), n, 1.0_rk, matrix(first + m, at), n)
      end do
      !$omp end taskloop
   end subroutine update_columns

   !> Subtract A A' from the lower triangle of the last rows of a matrix, whose first columns below
   !! the pivots are A.
   subroutine subtract_square(n, n_pivots, matrix)
      integer(ik), intent(in) :: n, n_pivots
      real(rk), intent(inout) :: matrix(n, n)

      if (is_in_team()) then
         call subtract_blocks(n, n_pivots, matrix)
      else
         !$omp parallel if(n - n_pivots > square_columns)
         !$omp single
         call subtract_blocks(n, n_pivots, matrix)
         !$omp end single
         !$omp end parallel
      end if
   end subroutine subtract_square

   subroutine subtract_blocks(n, n_pivots, matrix)
      integer(ik), intent(in) :: n, n_pivots
      real(rk), intent(inout) :: matrix(n, n)
      integer(ik) :: at, below, k

      !$omp taskloop grainsize(1) default(shared) private(below, k)
      do at = n_pivots + 1, n, square_columns
         k = min(square_columns, n - at + 1)
         below = at + k
         call dsyrk("L", "N", k, n_pivots, -1.0_rk, matrix(at, 1), n, 1.0_rk, matrix(at, at), n)
         if (below <= n) then
            call dgemm("N", "T", n - below + 1, k, n_pivots, -1.0_rk, matrix(below, 1), n, &
                       matrix(at, 1), n, 1.0_rk, matrix(below, at), n)
         end if
      end do
      !$omp end taskloop
   end subroutine subtract_blocks

end module algebra_blocks
