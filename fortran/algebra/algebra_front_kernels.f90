!> Operations on the numbers of one front: assembly of matrices and triangles, storage of Schur
!! complements on a stack, and the front's part of the substitutions.
!!
!! Cholesky elimination of the first unknowns of a dense symmetric matrix that is positive definite
!! or, with a sign for each pivot, quasi-definite (Vanderbei 1995): A = L S L^T, S the signs.
module algebra_front_kernels
   use, intrinsic :: iso_fortran_env, only: int64
   use algebra_blocks, only: is_in_team, subtract_square
   use algebra_lapack, only: dgemm, dpotrf, dtrsm
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: add_matrix, add_triangle, backwards, clear, eliminate, eliminate_signed, forwards, push

   integer(ik), parameter :: panel = 4  !< pivots that are taken together

   !> With fewer pivots or rows than these the plain loops are faster than the calls.
   integer(ik), parameter :: pivots_for_blas = 16, rows_for_blas = 160

   !> With fewer rows than these threads wait longer for each other than they save.
   integer(ik), parameter :: rows_for_threads = 500

   !> Columns that are taken together where signs stand between two factors.
   integer(ik), parameter :: columns_together = 64

contains

   !> Add the matrix of an element to a front.
   pure subroutine add_matrix(m, places, matrix, n, front)
      integer(ik), intent(in) :: m
      integer(ik), intent(in) :: places(m)
      real(rk), intent(in) :: matrix(m, m)
      integer(ik), intent(in) :: n
      real(rk), intent(inout) :: front(n, n)
      integer(ik) :: a, b, p, q

      do b = 1, m
         do a = b, m
            p = max(places(a), places(b))
            q = min(places(a), places(b))
            front(p, q) = front(p, q) + matrix(a, b)
         end do
      end do
   end subroutine add_matrix

   !> Add a triangle to a matrix at rising places.
   pure subroutine add_triangle(m, places, triangle, n, matrix)
      integer(ik), intent(in) :: m
      integer(ik), intent(in) :: places(m)
      real(rk), intent(in) :: triangle((m*(m + 1))/2)
      integer(ik), intent(in) :: n
      real(rk), intent(inout) :: matrix(n, n)
      integer(ik) :: a, at, b, p

      at = 0
      do b = 1, m
         p = places(b)
         do a = b, m
            matrix(places(a), p) = matrix(places(a), p) + triangle(at + a)
         end do
         at = at + m - b
      end do
   end subroutine add_triangle

   !> Put the Schur complement of a front on the stack.
   pure subroutine push(front, n, n_pivots, stack, top)
      integer(ik), intent(in) :: n, n_pivots
      real(rk), intent(in) :: front(n, n)
      real(rk), intent(inout) :: stack(:)
      integer(int64), intent(inout) :: top
      integer(ik) :: j

      do j = n_pivots + 1, n
         stack(top + 1:top + n - j + 1) = front(j:, j)
         top = top + n - j + 1
      end do
   end subroutine push

   !> An empty front: zeros in the lower triangle; nothing is read of the upper one.
   pure subroutine clear(n, front)
      integer(ik), intent(in) :: n
      real(rk), intent(inout) :: front(n, n)
      integer(ik) :: j

      do j = 1, n
         front(j:, j) = 0.0_rk
      end do
   end subroutine clear

   !> y := L^-1 y, the part of one front.
   pure subroutine forwards(n, n_pivots, factor, rows, first, y, part)
      integer(ik), intent(in) :: n, n_pivots
      real(rk), intent(in) :: factor(n, n_pivots)
      integer(ik), intent(in) :: rows(n - n_pivots)
      integer(ik), intent(in) :: first  !< pivot
      real(rk), intent(inout) :: y(:)
      real(rk), intent(out) :: part(n)  !< workspace
      integer(ik) :: j, k

      part(:n_pivots) = y(first:first + n_pivots - 1)
      part(n_pivots + 1:) = 0.0_rk
      do j = 1, n_pivots
         part(j) = part(j)/factor(j, j)
         do k = j + 1, n
            part(k) = part(k) - part(j)*factor(k, j)
         end do
      end do
      y(first:first + n_pivots - 1) = part(:n_pivots)
      do k = 1, n - n_pivots
         y(rows(k)) = y(rows(k)) + part(n_pivots + k)
      end do
   end subroutine forwards

   !> y := L'^-1 y, the part of one front.
   pure subroutine backwards(n, n_pivots, factor, rows, first, y, part)
      integer(ik), intent(in) :: n, n_pivots
      real(rk), intent(in) :: factor(n, n_pivots)
      integer(ik), intent(in) :: rows(n - n_pivots)
      integer(ik), intent(in) :: first  !< pivot
      real(rk), intent(inout) :: y(:)
      real(rk), intent(out) :: part(n)  !< workspace
      integer(ik) :: j

      part(:n_pivots) = y(first:first + n_pivots - 1)
      do j = 1, n - n_pivots
         part(n_pivots + j) = y(rows(j))
      end do
      do j = n_pivots, 1, -1
         part(j) = (part(j) - product_of(n - j, factor(min(j + 1, n), j), part(min(j + 1, n)))) &
                   /factor(j, j)
      end do
      y(first:first + n_pivots - 1) = part(:n_pivots)
   end subroutine backwards

   !> The sum of x y, in four sums that the processor forms at the same time.
   pure real(rk) function product_of(n, x, y)
      integer(ik), intent(in) :: n
      real(rk), intent(in) :: x(n), y(n)
      real(rk) :: sums(4)
      integer(ik) :: i

      sums = 0.0_rk
      do i = 1, n - 3, 4
         sums = sums + x(i:i + 3)*y(i:i + 3)
      end do
      product_of = sum(sums)
      do i = n - modulo(n, 4) + 1, n
         product_of = product_of + x(i)*y(i)
      end do
   end function product_of

   !> Replace the first columns of the lower triangle by those of the factor, and the rest by the
   !! Schur complement. The upper triangle is lost.
   subroutine eliminate(matrix, n, n_pivots, place)
      integer(ik), intent(in) :: n
      real(rk), intent(inout) :: matrix(n, n)
      integer(ik), intent(in) :: n_pivots
      integer(ik), intent(out) :: place  !< of the first pivot that is not positive; 0: none
      integer(ik) :: rest

      rest = n - n_pivots
      if (n_pivots < pivots_for_blas .or. n < rows_for_blas) then
         call eliminate_in_panels(matrix, n, n, spread(1.0_rk, 1, n_pivots), place)
         return
      end if
      call dpotrf("L", n_pivots, matrix, n, place)
      if (place /= 0 .or. rest == 0) return
      call dtrsm("R", "L", "T", "N", rest, n_pivots, 1.0_rk, matrix, n, &
                 matrix(n_pivots + 1, 1), n)
      call subtract_square(n, n_pivots, matrix)
   end subroutine eliminate

   !> The same for pivots of given signs. The diagonal of the factor is positive.
   recursive subroutine eliminate_signed(matrix, n, signs, place)
      integer(ik), intent(in) :: n
      real(rk), intent(inout) :: matrix(n, n)
      real(rk), intent(in) :: signs(:)  !< (pivots) 1 or -1
      integer(ik), intent(out) :: place  !< of the first pivot that has not its sign; 0: none
      integer(ik) :: first, k, m, n_pivots

      n_pivots = size(signs, kind=ik)
      if (n_pivots < pivots_for_blas .or. n < rows_for_blas) then
         call eliminate_in_panels(matrix, n, n, signs, place)
         return
      else if (.not. is_in_team()) then
         !$omp parallel if(n > rows_for_threads)
         !$omp single
         call eliminate_signed(matrix, n, signs, place)
         !$omp end single
         !$omp end parallel
         return
      end if
      do first = 1, n_pivots, columns_together
         m = min(columns_together, n_pivots - first + 1)
         associate (own => signs(first:first + m - 1), after => first + m)
            call eliminate_in_panels(matrix(first, first), n, m, own, place)
            if (place > 0) then
               place = first - 1 + place
               return
            end if
            if (after > n) exit
            call dtrsm("R", "L", "T", "N", n - after + 1, m, 1.0_rk, matrix(first, first), n, &
                       matrix(after, first), n)
            do k = 1, m
               if (own(k) < 0.0_rk) matrix(after:, first + k - 1) = -matrix(after:, first + k - 1)
            end do
            call subtract_signed(matrix, n, own, first)
         end associate
      end do
   end subroutine eliminate_signed

   !> Subtract from the lower triangle after some columns A their product A S A'.
   subroutine subtract_signed(matrix, n, signs, first)
      integer(ik), intent(in) :: n
      real(rk), intent(inout) :: matrix(n, n)
      real(rk), intent(in) :: signs(:)  !< S, of these columns
      integer(ik), intent(in) :: first  !< of these columns
      real(rk) :: opposite(size(signs), columns_together)
      integer(ik) :: at, k, m, n_together

      m = size(signs, kind=ik)
      !$omp taskloop grainsize(1) default(shared) private(k, n_together, opposite)
      do at = first + m, n, columns_together
         n_together = min(columns_together, n - at + 1)
         do k = 1, n_together
            opposite(:, k) = signs*matrix(at + k - 1, first:first + m - 1)
         end do
         call dgemm("N", "N", n - at + 1, n_together, m, -1.0_rk, matrix(at, first), n, &
                    opposite, m, 1.0_rk, matrix(at, at), n)
      end do
      !$omp end taskloop
   end subroutine subtract_signed

   !> The same in plain loops, a few pivots at a time.
   pure subroutine eliminate_in_panels(matrix, n_stored, n, signs, place)
      integer(ik), intent(in) :: n_stored  !< rows of the matrix that this one is part of
      integer(ik), intent(in) :: n
      ! A part of a larger matrix, whose last column ends early.
      ! allow(C071)
      real(rk), intent(inout) :: matrix(n_stored, *)
      real(rk), intent(in) :: signs(:)  !< (pivots)
      integer(ik), intent(out) :: place
      real(rk) :: factor(2, panel)
      integer(ik) :: first, j, k, last, n_pivots

      n_pivots = size(signs, kind=ik)
      place = 0
      do first = 1, n_pivots, panel
         last = min(first + panel - 1, n_pivots)
         do k = first, last
            if (.not. signs(k)*matrix(k, k) > 0.0_rk) then
               place = k
               return
            end if
            matrix(k, k) = sqrt(signs(k)*matrix(k, k))
            call divide(n - k, signs(k)*matrix(k, k), matrix(min(k + 1, n), k))
            do j = k + 1, last
               call subtract_one(n - j + 1, signs(k)*matrix(j, k), matrix(j, k), matrix(j, j))
            end do
         end do
         if (last - first + 1 < panel) then
            do k = first, last
               do j = last + 1, n
                  call subtract_one(n - j + 1, signs(k)*matrix(j, k), matrix(j, k), matrix(j, j))
               end do
            end do
         else
            do j = last + 1, n - 1, 2
               do k = first, last
                  factor(:, k - first + 1) = signs(k)*[matrix(j, k), matrix(j + 1, k)]
               end do
               call subtract_four_twice(n - j + 1, factor, &
                                        matrix(j, first), matrix(j, first + 1), &
                                        matrix(j, first + 2), matrix(j, first + 3), &
                                        matrix(j, j), matrix(j, j + 1))
            end do
            if (modulo(n - last, 2) == 1) then
               do k = first, last
                  call subtract_one(1, signs(k)*matrix(n, k), matrix(n, k), matrix(n, n))
               end do
            end if
         end if
      end do
   end subroutine eliminate_in_panels

   pure subroutine divide(n, divisor, column)
      integer(ik), intent(in) :: n
      real(rk), intent(in) :: divisor
      real(rk), intent(inout) :: column(n)

      column = column*(1.0_rk/divisor)
   end subroutine divide

   !> y - factor x
   pure subroutine subtract_one(n, factor, x, y)
      integer(ik), intent(in) :: n
      real(rk), intent(in) :: factor, x(n)
      real(rk), intent(inout) :: y(n)

      y = y - factor*x
   end subroutine subtract_one

   !> Four columns from each of two, where the numbers fit into the registers of the processor.
   pure subroutine subtract_four_twice(n, factor, x1, x2, x3, x4, y1, y2)
      integer(ik), intent(in) :: n
      real(rk), intent(in) :: factor(2, 4)
      real(rk), intent(in) :: x1(n), x2(n), x3(n), x4(n)
      real(rk), intent(inout) :: y1(n), y2(n)
      integer(ik) :: i

      do i = 1, n
         y1(i) = y1(i) - factor(1, 1)*x1(i) - factor(1, 2)*x2(i) - factor(1, 3)*x3(i) &
                 - factor(1, 4)*x4(i)
         y2(i) = y2(i) - factor(2, 1)*x1(i) - factor(2, 2)*x2(i) - factor(2, 3)*x3(i) &
                 - factor(2, 4)*x4(i)
      end do
   end subroutine subtract_four_twice

end module algebra_front_kernels
