!> Dense operations in blocks of columns that threads share. The blocks do not depend on the number
!! of threads, and so do not the results.
module algebra_blocks
   use algebra_lapack, only: dgemm, dgetrf, dlaswp, dsyrk, dtrsm
   use base_kinds, only: ik, rk
!$ use omp_lib, only: omp_get_level
   implicit none(type, external)
   private

   public :: factorize_lu, is_in_team, subtract_square

   !> Columns of a block of each operation: fewer cost more of the libraries' time.
   integer(ik), parameter :: lu_columns = 128, square_columns = 256

contains

   !> Whether a team of threads, of one or more, shares the tasks that are made here.
   logical function is_in_team()

      is_in_team = .true.
!$    is_in_team = omp_get_level() > 0
   end function is_in_team

   !> Replace a matrix by its factors L and U with row interchanges, as dgetrf does.
   recursive subroutine factorize_lu(n, matrix, pivots, info)
      integer(ik), intent(in) :: n
      real(rk), intent(inout) :: matrix(n, n)
      integer(ik), intent(out) :: pivots(n)
      integer(ik), intent(out) :: info  !< a pivot that is 0; 0: none
      integer(ik) :: after, at, first, k, m

      if (.not. is_in_team()) then
         !$omp parallel if(n > 3*lu_columns)
         !$omp single
         call factorize_lu(n, matrix, pivots, info)
         !$omp end single
         !$omp end parallel
         return
      end if
      info = 0
      do first = 1, n, lu_columns
         m = min(lu_columns, n - first + 1)
         after = first + m
         call dgetrf(n - first + 1, m, matrix(first, first), n, pivots(first), at)
         if (at > 0 .and. info == 0) info = first - 1 + at
         pivots(first:after - 1) = pivots(first:after - 1) + first - 1
         if (first > 1) call dlaswp(first - 1, matrix, n, first, after - 1, pivots, 1_ik)
         !$omp taskloop grainsize(1) default(shared) private(k)
         do at = after, n, lu_columns
            k = min(lu_columns, n - at + 1)
            call dlaswp(k, matrix(1, at), n, first, after - 1, pivots, 1_ik)
            call dtrsm("L", "L", "N", "U", m, k, 1.0_rk, matrix(first, first), n, &
                       matrix(first, at), n)
            call dgemm("N", "N", n - after + 1, k, m, -1.0_rk, matrix(after, first), n, &
                       matrix(first, at), n, 1.0_rk, matrix(after, at), n)
         end do
         !$omp end taskloop
      end do
   end subroutine factorize_lu

   !> Subtract A A' from the lower triangle of the last rows of a matrix, whose first columns below
   !! the pivots are A.
   recursive subroutine subtract_square(n, n_pivots, matrix)
      integer(ik), intent(in) :: n, n_pivots
      real(rk), intent(inout) :: matrix(n, n)
      integer(ik) :: at, below, k

      if (.not. is_in_team()) then
         !$omp parallel if(n - n_pivots > square_columns)
         !$omp single
         call subtract_square(n, n_pivots, matrix)
         !$omp end single
         !$omp end parallel
         return
      end if
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
   end subroutine subtract_square

end module algebra_blocks
