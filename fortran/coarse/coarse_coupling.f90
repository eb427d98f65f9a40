!> The equations of the fracture cells in the matrix of the coarse level as sparse rows, in the
!! directions n and tau of the fractures: the forces and volumes on the fractures, without
!! elimination of the rest of the body,
!!   force = C b + D q
!! with b the unknowns of the cells and q those on the fractures (coarse_layout); C' is the
!! contribution of the fractures to the equations of the cells.
module coarse_coupling
   use base_kinds, only: ik, rk
   use coarse_layout, only: at_component
   use coarse_matrix, only: matrix_t
   implicit none(type, external)
   private

   public :: coupling_t, find_coupling

   !> C and D, row by row; columns of q stand after those of b.
   type :: coupling_t
      integer(ik) :: n_bulk = 0  !< unknowns of the cells
      integer(ik), allocatable :: first(:)  !< (rows + 1) of each row's entries
      integer(ik), allocatable :: col(:)
      real(rk), allocatable :: value(:)  !< for [m], [Pa] and [N/m], [m2]
   contains
      procedure :: forces
      procedure :: bulk_load
      procedure :: diagonal
      procedure :: sizes
   end type coupling_t

contains

   !> Find C and D for a time step.
   subroutine find_coupling(matrix, normal, dt, coupling)
      type(matrix_t), intent(in) :: matrix
      real(rk), intent(in) :: normal(:, :)  !< (2, fracture cells) [-]
      real(rk), intent(in) :: dt  !< [s]
      type(coupling_t), intent(out) :: coupling
      real(rk) :: block(3, 3)
      integer(ik) :: entry, i, j
      integer(ik), allocatable :: next(:)

      coupling%n_bulk = 3*matrix%n_cells
      coupling%first = first_entries(matrix)
      next = coupling%first(:size(coupling%first) - 1)
      allocate (coupling%col(coupling%first(size(coupling%first)) - 1))
      allocate (coupling%value(size(coupling%col)))
      do i = matrix%n_cells + 1, matrix%n_blocks
         do entry = matrix%columns%first(i), matrix%columns%last(i)
            j = matrix%columns%item(entry)
            ! The diagonal block is complete; turns are symmetric.
            block = matmul(turn(i), matrix%block_at(entry, dt))
            if (j > matrix%n_cells) block = matmul(block, turn(j))
            call put(i, j, block)
            if (j > matrix%n_cells .and. j < i) call put(j, i, transpose(block))
         end do
      end do

   contains

      !> Add a block to the rows of a fracture's block.
      subroutine put(of, column, numbers)
         integer(ik), intent(in) :: of, column
         real(rk), intent(in) :: numbers(3, 3)
         integer(ik) :: a, c

         do a = 1, 3
            associate (at => next(at_component(of - matrix%n_cells, a)))
               coupling%col(at:at + 2) = [(at_component(column, c), c=1, 3)]
               coupling%value(at:at + 2) = numbers(a, :)
               at = at + 3
            end associate
         end do
      end subroutine put

      !> From x, y to n, tau of the fracture cell of a block, and back.
      pure function turn(of) result(to_normal)
         integer(ik), intent(in) :: of
         real(rk) :: to_normal(3, 3)

         associate (n => normal(:, (of - matrix%n_cells + 1)/2))
            to_normal(:, 1) = [n(1), n(2), 0.0_rk]
            to_normal(:, 2) = [n(2), -n(1), 0.0_rk]
            to_normal(:, 3) = [0.0_rk, 0.0_rk, 1.0_rk]
         end associate
      end function turn

   end subroutine find_coupling

   !> Where the entries of each row of C and D begin, and where those of the last one end.
   pure function first_entries(matrix) result(first)
      type(matrix_t), intent(in) :: matrix
      integer(ik), allocatable :: first(:)  !< (rows + 1)
      integer(ik), allocatable :: n_blocks(:)
      integer(ik) :: entry, i, j, n_rows

      allocate (n_blocks(matrix%n_cells + 1:matrix%n_blocks), source=0_ik)
      do i = matrix%n_cells + 1, matrix%n_blocks
         n_blocks(i) = n_blocks(i) + matrix%columns%length(i)
         do entry = matrix%columns%first(i), matrix%columns%last(i) - 1
            j = matrix%columns%item(entry)
            if (j > matrix%n_cells) n_blocks(j) = n_blocks(j) + 1
         end do
      end do
      n_rows = 3*(matrix%n_blocks - matrix%n_cells)
      allocate (first(n_rows + 1))
      first(1) = 1
      do i = 1, n_rows
         first(i + 1) = first(i) + 3*n_blocks(matrix%n_cells + (i + 2)/3)
      end do
   end function first_entries

   !> C b + D q.
   pure subroutine forces(self, b, q, force)
      class(coupling_t), intent(in) :: self
      real(rk), intent(in) :: b(:)  !< [m], [m], [Pa] cell by cell
      real(rk), intent(in) :: q(:)  !< [m], [Pa]
      real(rk), intent(out) :: force(:)  !< [N/m], [m2]
      integer(ik) :: k, row
      real(rk) :: total

      do row = 1, size(force)
         total = 0.0_rk
         do k = self%first(row), self%first(row + 1) - 1
            if (self%col(k) <= self%n_bulk) then
               total = total + self%value(k)*b(self%col(k))
            else
               total = total + self%value(k)*q(self%col(k) - self%n_bulk)
            end if
         end do
         force(row) = total
      end do
   end subroutine forces

   !> C' q: contribution of the fractures to the equations of the cells.
   pure subroutine bulk_load(self, q, load)
      class(coupling_t), intent(in) :: self
      real(rk), intent(in) :: q(:)  !< [m], [Pa]
      real(rk), intent(out) :: load(:)  !< [N/m], [m2] cell by cell
      integer(ik) :: k, row

      load = 0.0_rk
      do row = 1, size(q)
         if (.not. abs(q(row)) > 0.0_rk) cycle
         do k = self%first(row), self%first(row + 1) - 1
            if (self%col(k) <= self%n_bulk) then
               load(self%col(k)) = load(self%col(k)) + self%value(k)*q(row)
            end if
         end do
      end do
   end subroutine bulk_load

   !> An entry of D's diagonal.
   elemental real(rk) function diagonal(self, row)
      class(coupling_t), intent(in) :: self
      integer(ik), intent(in) :: row
      integer(ik) :: k

      diagonal = 0.0_rk
      do k = self%first(row), self%first(row + 1) - 1
         if (self%col(k) == self%n_bulk + row) diagonal = diagonal + self%value(k)
      end do
   end function diagonal

   !> Sum of the magnitudes of the terms of a force.
   pure real(rk) function sizes(self, b, q, row) result(total)
      class(coupling_t), intent(in) :: self
      real(rk), intent(in) :: b(:), q(:)
      integer(ik), intent(in) :: row
      integer(ik) :: k

      total = 0.0_rk
      do k = self%first(row), self%first(row + 1) - 1
         if (self%col(k) <= self%n_bulk) then
            total = total + abs(self%value(k)*b(self%col(k)))
         else
            total = total + abs(self%value(k)*q(self%col(k) - self%n_bulk))
         end if
      end do
   end function sizes

end module coarse_coupling
