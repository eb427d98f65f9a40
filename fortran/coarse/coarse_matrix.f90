!> The matrix of the coarse level: cells and fracture cells in blocks of three (see coarse_layout).
!!
!! Rows: balance of forces on a cell [N/m]; its fluid content, negated [m2]; force through an end of
!! a fracture cell, negated [N/m]; fluid that leaves the rock through a fracture face within the
!! step [m2]. The matrix is symmetric and quasi-definite: positive for displacements, negative for
!! pressures. It is kept as elastic - and - flow parts, so that a new time step needs no new
!! discretization: matrix = elastic + dt*flow. Layers (coarse_layers) add terms that are found for
!! each time step; the block of a layer has three pressures.
module coarse_matrix
   use base_kinds, only: ik, rk
   use base_lists, only: lists_t
   implicit none(type, external)
   private

   public :: matrix_t

   !> Lower triangle in blocks, by rows; the diagonal block is the last one of its row.
   type :: matrix_t
      integer(ik) :: n_blocks = 0
      integer(ik) :: n_cells = 0  !< blocks before those of the fractures: cells and layers
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
      ! With layers; else unallocated:
      !> (n_entries) which of the following belongs to an entry, 0: none
      integer(ik), allocatable :: of_layers(:)
      real(rk), allocatable :: layer_flow(:, :, :)  !< (3, 3, ..) part of the flow [m2/(Pa s)]
      real(rk), allocatable :: layer_terms(:, :, :)  !< (3, 3, ..) for one time step [m2/Pa]
      real(rk), allocatable :: layer_known(:, :)  !< (2, n_layers) as flow_known [m2/s]
   contains
      procedure :: block_at
      procedure :: add_layer_term
      procedure :: is_pressure
      procedure :: is_difference
      procedure :: entry_at
      procedure :: elastic_forces
      procedure :: pressure_forces
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
      if (.not. allocated(self%of_layers)) return
      associate (k => self%of_layers(entry))
         if (k > 0) block = block + dt*self%layer_flow(:, :, k) + self%layer_terms(:, :, k)
      end associate
   end function block_at

   !> Add a term between two unknowns to those of the layers, or to their flow [m2/(Pa s)]; terms
   !! above the diagonal blocks are left out.
   pure subroutine add_layer_term(self, row, col, term, is_flow)
      class(matrix_t), intent(inout) :: self
      integer(ik), intent(in) :: row, col  !< numbers of the unknowns
      real(rk), intent(in) :: term  !< [m2/Pa]
      logical, intent(in) :: is_flow
      integer(ik) :: at(3)

      associate (i => (row + 2)/3, j => (col + 2)/3)
         if (j > i) return
         at = [row - 3*i + 3, col - 3*j + 3, self%of_layers(self%entry_at(i, j))]
      end associate
      if (is_flow) then
         self%layer_flow(at(1), at(2), at(3)) = self%layer_flow(at(1), at(2), at(3)) + term
      else
         self%layer_terms(at(1), at(2), at(3)) = self%layer_terms(at(1), at(2), at(3)) + term
      end if
   end subroutine add_layer_term

   !> Which unknowns are pressures.
   pure function is_pressure(self)
      class(matrix_t), intent(in) :: self
      logical :: is_pressure(3*self%n_blocks)
      integer(ik) :: i

      is_pressure = [(modulo(i, 3_ik) == 0, i=1, 3*self%n_blocks)]
      if (.not. allocated(self%layer_known)) return
      is_pressure(3*(self%n_cells - size(self%layer_known, 2, kind=ik)) + 1:3*self%n_cells) = .true.
   end function is_pressure

   !> Which unknowns are differences of pressures.
   pure function is_difference(self)
      class(matrix_t), intent(in) :: self
      logical :: is_difference(3*self%n_blocks)

      is_difference = .false.
      if (.not. allocated(self%layer_known)) return
      is_difference(3*(self%n_cells - size(self%layer_known, 2)) + 2:3*self%n_cells:3) = .true.
   end function is_difference

   !> The number of the entry in a row and column, which must exist.
   pure integer(ik) function entry_at(self, row, col) result(entry)
      class(matrix_t), intent(in) :: self
      integer(ik), intent(in) :: row, col  !< blocks, col <= row

      entry = self%columns%first(row)
      do while (self%columns%item(entry) /= col)
         entry = entry + 1
      end do
   end function entry_at

   !> What the elastic part makes of pressures, the displacements being zero.
   pure function pressure_forces(self, pressure) result(force)
      class(matrix_t), intent(in) :: self
      real(rk), intent(in) :: pressure(:)  !< (n_blocks) [Pa]
      real(rk), allocatable :: force(:, :)  !< (3, n_blocks) [N/m], [N/m], [m2]
      integer(ik) :: entry, i, j

      allocate (force(3, self%n_blocks), source=0.0_rk)
      do i = 1, self%n_blocks
         do entry = self%columns%first(i), self%columns%last(i)
            j = self%columns%item(entry)
            associate (block => self%elastic(:, :, entry))
               force(:, i) = force(:, i) + block(:, 3)*pressure(j)
               if (j /= i) force(:, j) = force(:, j) + block(3, :)*pressure(i)
            end associate
         end do
      end do
   end function pressure_forces

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
