!> The matrix of the coarse level: cells and fracture cells in blocks of three (see coarse_layout).
!!
!! Rows: balance of forces on a cell [N/m]; its fluid content, negated [m2]; force through an end of
!! a fracture cell, negated [N/m]; fluid that leaves the rock through a fracture face within the
!! step [m2]. The matrix is symmetric and quasi-definite: positive for displacements, negative for
!! pressures. It is kept as elastic - and - flow parts, so that a new time step needs no new
!! discretization: matrix = elastic + dt*flow.
module coarse_matrix
   use base_kinds, only: ik, rk
   use base_lists, only: lists_t
   implicit none(type, external)
   private

   public :: matrix_t

   !> Lower triangle in blocks, by rows; the diagonal block is the last one of its row.
   type :: matrix_t
      integer(ik) :: n_blocks = 0
      integer(ik) :: n_cells = 0
      type(lists_t) :: columns  !< of each row, from the first to the diagonal
      !> (3, 3, n_entries), an entry per item of columns, for unknowns [m], [m], [Pa] and rows
      !! [N/m], [N/m], [m2]
      real(rk), allocatable :: elastic(:, :, :)
      real(rk), allocatable :: flow(:)  !< (n_entries) of the pressures alone [m2/(Pa s)]
      !> (3, n_blocks) right-hand side of the boundary data [N/m], [N/m], [m2]
      real(rk), allocatable :: elastic_known(:, :)
      real(rk), allocatable :: flow_known(:)  !< (n_blocks) the same for the flow [m2/s]
      !> (n_cells) content per pressure at fixed traction [m2/Pa]
      real(rk), allocatable :: storage(:)
   contains
      procedure :: block_at
      procedure :: entry_at
      procedure :: elastic_forces
   end type matrix_t

contains

   !> One block for a time step, for rows [N/m], [N/m], [m2] and unknowns [m], [m], [Pa].
   pure function block_at(self, entry, dt) result(block)
      class(matrix_t), intent(in) :: self
      integer(ik), intent(in) :: entry
      real(rk), intent(in) :: dt  !< [s]
      real(rk) :: block(3, 3)

      block = self%elastic(:, :, entry)
      block(3, 3) = block(3, 3) + dt*self%flow(entry)
   end function block_at

   !> The number of the entry in a row and column, which must exist.
   pure integer(ik) function entry_at(self, row, col) result(entry)
      class(matrix_t), intent(in) :: self
      integer(ik), intent(in) :: row, col  !< blocks, col <= row

      entry = self%columns%first(row)
      do while (self%columns%item(entry) /= col)
         entry = entry + 1
      end do
   end function entry_at

   !> What the elastic part makes of unknowns: the left-hand side but for the flow.
   pure function elastic_forces(self, unknowns) result(force)
      class(matrix_t), intent(in) :: self
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), allocatable :: force(:, :)  !< (3, n_blocks) [N/m], [N/m], [m2]
      integer(ik) :: entry, i, j
      logical :: acts(self%n_blocks)

      allocate (force(3, self%n_blocks), source=0.0_rk)
      acts = any(abs(unknowns) > 0.0_rk, dim=1)
      do i = 1, self%n_blocks
         do entry = self%columns%first(i), self%columns%last(i)
            j = self%columns%item(entry)
            if (.not. (acts(i) .or. acts(j))) cycle
            associate (block => self%elastic(:, :, entry))
               force(:, i) = force(:, i) + matmul(block, unknowns(:, j))
               if (j /= i) force(:, j) = force(:, j) + matmul(unknowns(:, i), block)
            end associate
         end do
      end do
   end function elastic_forces

end module coarse_matrix
