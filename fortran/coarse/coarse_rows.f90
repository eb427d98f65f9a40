!> The matrix of the coarse level as a sum of small dense matrices, for elimination by fronts: each
!! block of unknowns with the unknowns eliminated after it. Such an element has no more entries than
!! the elimination of its block produces, so that the fronts are those of the matrix.
!!
!! Jumps that are known to be zero may be fixed: they are no part of the matrix then.
module coarse_rows
   use algebra_multifrontal, only: element_matrices_t
   use base_kinds, only: ik, rk
   use base_lists, only: inverted, lists_t
   use coarse_layout, only: at_component
   use coarse_matrix, only: matrix_t
   implicit none(type, external)
   private

   public :: clear_fixed, find_rows, rows_t, times_scaled

   !> Block rows of the matrix, scaled.
   type, extends(element_matrices_t) :: rows_t
      type(lists_t) :: blocks  !< of each row: its own, then those that are eliminated later
      integer(ik), allocatable :: entry(:)  !< of the matrix, one per item; negative: transposed
      type(matrix_t), pointer :: matrix => null()
      real(rk), pointer :: scale(:) => null()  !< (3 n_blocks) [m], [m], [Pa] block by block
      logical, allocatable :: is_fixed(:)  !< (n_blocks) jumps are no unknowns
      integer(ik), allocatable :: fixed(:)  !< those blocks
      real(rk) :: dt = 0.0_rk  !< [s]
   contains
      procedure :: give
   end type rows_t

contains

   !> Divide the entries among the blocks: each belongs to the block that is eliminated first, the
   !! diagonal entry before the others.
   pure subroutine find_rows(columns, place, rows)
      type(lists_t), intent(in) :: columns  !< of the lower triangle, row by row, the diagonal last
      integer(ik), intent(in) :: place(:)  !< (n_blocks) in the order of elimination
      type(rows_t), intent(inout) :: rows
      integer(ik), dimension(size(columns%item)) :: first, order, row
      logical :: is_diagonal(size(columns%item))
      integer(ik) :: i

      do i = 1, size(place, kind=ik)
         row(columns%first(i):columns%last(i)) = i
      end do
      associate (col => columns%item)
         is_diagonal = row == col
         order = [(i, i=1, size(order, kind=ik))]
         order = [pack(order, is_diagonal), pack(order,.not. is_diagonal)]
         first = merge(row, col, place(row) < place(col))
         rows%blocks = inverted(reshape(first(order), [1, size(order)]), size(place, kind=ik))
         order = order(rows%blocks%item)
         rows%blocks%item = row(order) + col(order) - first(order)
         rows%entry = merge(order, -order, rows%blocks%item == row(order))
      end associate
   end subroutine find_rows

   !> Set the entries of fixed jumps to zero.
   pure subroutine clear_fixed(fixed, values)
      integer(ik), intent(in) :: fixed(:)  !< blocks
      real(rk), intent(inout) :: values(:)  !< (3 per block)

      values(at_component(fixed, 1)) = 0.0_rk
      values(at_component(fixed, 2)) = 0.0_rk
   end subroutine clear_fixed

   !> The scaled entries of one block row, of fixed jumps the unit matrix.
   pure subroutine give(self, element, n, matrix)
      class(rows_t), intent(in) :: self
      integer(ik), intent(in) :: element, n
      real(rk), intent(out) :: matrix(n, n)
      real(rk) :: block(3, 3)
      integer(ik) :: a, at, b, first_col, first_row, k, own, row

      matrix = 0.0_rk
      if (element > size(self%is_fixed)) then
         do a = 1, n
            matrix(a, a) = 1.0_rk
         end do
         return
      end if
      first_col = merge(3_ik, 1_ik, self%is_fixed(element))
      own = at_component(element, 1) - 1
      at = 0
      do k = self%blocks%first(element), self%blocks%last(element)
         block = self%matrix%block_at(abs(self%entry(k)), self%dt)
         if (self%entry(k) < 0) block = transpose(block)
         row = at_component(self%blocks%item(k), 1) - 1
         first_row = merge(3_ik, 1_ik, self%is_fixed(self%blocks%item(k)))
         do b = first_col, 3
            do a = first_row, 3
               matrix(at + a - first_row + 1, b - first_col + 1) = block(a, b) &
                                                                   *self%scale(row + a) &
                                                                   *self%scale(own + b)
            end do
         end do
         at = at + 4 - first_row
      end do
   end subroutine give

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
            block = rows%matrix%block_at(abs(entry), rows%dt)
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
