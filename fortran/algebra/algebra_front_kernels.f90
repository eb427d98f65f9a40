!> What is done with the numbers of one front: matrices and triangles added at their places, what is
!! left put on a stack, and the front's part of the substitutions.
module algebra_front_kernels
   use, intrinsic :: iso_fortran_env, only: int64
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: add_matrix, add_triangle, backwards, clear, forwards, push

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

   !> Put what is left of a front on the stack.
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
      real(rk), intent(out) :: part(n)  !< room
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
      real(rk), intent(out) :: part(n)  !< room
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

end module algebra_front_kernels
