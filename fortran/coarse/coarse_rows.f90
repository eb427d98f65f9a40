!> The matrix equations as a sum of small dense matrices, for elimination by fronts: each block of
!! unknowns with what is eliminated after it. Such an element leaves no more than the elimination of
!! its block does, so that the fronts are those of the matrix.
module coarse_rows
   use algebra_multifrontal, only: element_matrices_t
   use base_kinds, only: ik, rk
   use base_lists, only: lists_t
   use coarse_layout, only: at_component
   use coarse_matrix, only: matrix_t
   implicit none(type, external)
   private

   public :: find_rows, rows_t, times_scaled

   !> Block rows of the matrix, scaled.
   type, extends(element_matrices_t) :: rows_t
      type(lists_t) :: blocks  !< of each row: its own, then those that are eliminated later
      integer(ik), allocatable :: entry(:)  !< of the matrix, one per item; negative: transposed
      type(matrix_t), pointer :: matrix => null()
      real(rk), pointer :: scale(:) => null()  !< (3 n_blocks) [m], [m], [Pa] block by block
      real(rk) :: dt = 0.0_rk  !< [s]
   contains
      procedure :: give
   end type rows_t

contains

   !> Divide the entries among the blocks: each belongs to the one that is eliminated first.
   pure subroutine find_rows(columns, place, rows)
      type(lists_t), intent(in) :: columns  !< of the lower triangle, row by row, the diagonal last
      integer(ik), intent(in) :: place(:)  !< (n_blocks) in the order of elimination
      type(rows_t), intent(inout) :: rows
      integer(ik), allocatable :: next(:)
      integer(ik) :: entry, first, i, j, n, second

      n = size(place, kind=ik)
      if (allocated(rows%entry)) deallocate (rows%blocks%first, rows%blocks%item, rows%entry)
      allocate (next(n), source=1_ik)
      do i = 1, n
         do entry = columns%first(i), columns%last(i) - 1
            j = columns%item(entry)
            first = merge(i, j, place(i) < place(j))
            next(first) = next(first) + 1
         end do
      end do
      allocate (rows%blocks%first(n + 1))
      rows%blocks%first(1) = 1
      do i = 1, n
         rows%blocks%first(i + 1) = rows%blocks%first(i) + next(i)
      end do
      allocate (rows%blocks%item(rows%blocks%first(n + 1) - 1))
      allocate (rows%entry(size(rows%blocks%item)))
      next = rows%blocks%first(:n)
      do i = 1, n
         rows%blocks%item(next(i)) = i
         rows%entry(next(i)) = columns%last(i)
         next(i) = next(i) + 1
      end do
      do i = 1, n
         do entry = columns%first(i), columns%last(i) - 1
            j = columns%item(entry)
            first = merge(i, j, place(i) < place(j))
            second = merge(j, i, place(i) < place(j))
            rows%blocks%item(next(first)) = second
            rows%entry(next(first)) = merge(entry, -entry, second == i)
            next(first) = next(first) + 1
         end do
      end do
   end subroutine find_rows

   !> The scaled entries of one block row.
   pure subroutine give(self, element, n, matrix)
      class(rows_t), intent(in) :: self
      integer(ik), intent(in) :: element, n
      real(rk), intent(out) :: matrix(n, n)
      real(rk) :: block(3, 3)
      integer(ik) :: a, at, b, k, own, row

      matrix(:, 4:) = 0.0_rk
      own = at_component(element, 1) - 1
      at = 0
      do k = self%blocks%first(element), self%blocks%last(element)
         block = block_of(self%matrix, abs(self%entry(k)), self%dt)
         if (self%entry(k) < 0) block = transpose(block)
         row = at_component(self%blocks%item(k), 1) - 1
         do b = 1, 3
            do a = 1, 3
               matrix(at + a, b) = block(a, b)*self%scale(row + a)*self%scale(own + b)
            end do
         end do
         at = at + 3
      end do
   end subroutine give

   !> One block of the matrix, for rows [N/m], [N/m], [m2] and unknowns [m], [m], [Pa].
   pure function block_of(matrix, entry, dt) result(block)
      type(matrix_t), intent(in) :: matrix
      integer(ik), intent(in) :: entry
      real(rk), intent(in) :: dt  !< [s]
      real(rk) :: block(3, 3)

      block = matrix%elastic(:, :, entry)
      block(3, 3) = block(3, 3) + dt*matrix%flow(entry)
   end function block_of

   !> The matrix, scaled as in its rows, times a vector.
   pure function times_scaled(rows, x) result(y)
      type(rows_t), intent(in) :: rows
      real(rk), intent(in) :: x(:)  !< (3 n_blocks) [-]
      real(rk) :: y(size(x))
      real(rk) :: block(3, 3), scaled(size(x))
      integer(ik) :: entry, i, j, k

      scaled = rows%scale*x
      y = 0.0_rk
      do i = 1, size(x, kind=ik)/3
         do k = rows%blocks%first(i), rows%blocks%last(i)
            entry = rows%entry(k)
            block = block_of(rows%matrix, abs(entry), rows%dt)
            if (entry < 0) block = transpose(block)
            j = rows%blocks%item(k)
            associate (own => at_component(i, 1), other => at_component(j, 1))
               y(other:other + 2) = y(other:other + 2) + matmul(block, scaled(own:own + 2))
               if (j /= i) y(own:own + 2) = y(own:own + 2) + matmul(scaled(other:other + 2), block)
            end associate
         end do
      end do
      y = rows%scale*y
   end function times_scaled

end module coarse_rows
