!> The elements of the fine problem for the solver: the unknowns of each, and its matrix T' K T,
!! where T gives the nodal displacements from the unknowns (fine_faces).
module fine_elements
   use algebra_multifrontal, only: element_matrices_t
   use base_kinds, only: ik, rk
   use base_lists, only: lists_t
   use fine_faces, only: columns_max, constraints_t
   implicit none(type, external)
   private

   public :: pattern_of, pattern_t, tied_elements_t

   !> Unknowns of the elements in blocks.
   type :: pattern_t
      integer(ik), allocatable :: first_unknown(:)  !< (blocks + 1)
      type(lists_t) :: blocks  !< of each element
      integer(ik), allocatable :: kept(:)  !< unknowns to condense onto
      logical, allocatable :: changes(:)  !< (elements) near tips that move; empty: none is
   contains
      procedure :: is_same_as
   end type pattern_t

   !> Matrices of the elements of a body.
   type, extends(element_matrices_t) :: tied_elements_t
      integer(ik), pointer, contiguous :: cell_nodes(:, :) => null()  !< (6, n_cells)
      real(rk), pointer, contiguous :: stiffness(:, :, :) => null()  !< (12, 12, n_cells) [Pa]
      type(constraints_t), pointer :: constraints => null()
   contains
      procedure :: give
   end type tied_elements_t

contains

   !> The pattern of a mesh with its constraints.
   pure type(pattern_t) function pattern_of(cell_nodes, constraints, changes) result(pattern)
      integer(ik), intent(in) :: cell_nodes(:, :)  !< (6, n_cells)
      type(constraints_t), intent(in) :: constraints
      logical, intent(in) :: changes(:)  !< (elements) near tips that move; empty: none is

      call find_blocks(constraints, pattern%first_unknown)
      pattern%blocks = list_blocks(cell_nodes, constraints, pattern%first_unknown)
      pattern%kept = constraints%kept_dofs
      pattern%changes = changes
   end function pattern_of

   !> Whether two patterns are the same.
   pure logical function is_same_as(self, other)
      class(pattern_t), intent(in) :: self, other

      is_same_as = .false.
      if (.not. allocated(other%first_unknown)) return
      if (size(self%first_unknown) /= size(other%first_unknown)) return
      if (size(self%blocks%first) /= size(other%blocks%first)) return
      if (size(self%blocks%item) /= size(other%blocks%item)) return
      if (size(self%kept) /= size(other%kept)) return
      if (size(self%changes) /= size(other%changes)) return
      is_same_as = all(self%first_unknown == other%first_unknown) &
                   .and. all(self%blocks%first == other%blocks%first) &
                   .and. all(self%blocks%item == other%blocks%item) &
                   .and. all(self%kept == other%kept) &
                   .and. all(self%changes .eqv. other%changes)
   end function is_same_as

   !> Blocks of consecutive unknowns that move the same nodes, those in contact separate.
   pure subroutine find_blocks(constraints, first_unknown)
      type(constraints_t), intent(in) :: constraints
      integer(ik), allocatable, intent(out) :: first_unknown(:)  !< (blocks + 1)
      integer(ik) :: moved(4, constraints%n_dofs)  ! first node, last node, how many, in contact
      integer(ik) :: beginnings(constraints%n_dofs + 1)
      integer(ik) :: column, d, n, node

      moved = 0
      do node = 1, size(constraints%n_columns, kind=ik)
         do column = 1, constraints%n_columns(node)
            d = constraints%dof(column, node)
            if (moved(1, d) == 0) moved(1, d) = node
            moved(2, d) = node
            moved(3, d) = moved(3, d) + 1
         end do
      end do
      moved(4, constraints%contact_dofs) = 1
      n = 0
      do d = 1, constraints%n_dofs
         if (d > 1 .and. moved(3, d) <= 2) then
            if (all(moved(:, d) == moved(:, d - 1))) cycle
         end if
         n = n + 1
         beginnings(n) = d
      end do
      beginnings(n + 1) = constraints%n_dofs + 1
      first_unknown = beginnings(:n + 1)
   end subroutine find_blocks

   !> The blocks of each element, in the order of its nodes.
   pure function list_blocks(cell_nodes, constraints, first_unknown) result(elements)
      integer(ik), intent(in) :: cell_nodes(:, :)  !< (6, n_cells)
      type(constraints_t), intent(in) :: constraints
      integer(ik), intent(in) :: first_unknown(:)  !< (blocks + 1)
      type(lists_t) :: elements
      integer(ik) :: block_of(constraints%n_dofs)
      integer(ik) :: b, cell, column, k, n, node

      do b = 1, size(first_unknown, kind=ik) - 1
         block_of(first_unknown(b):first_unknown(b + 1) - 1) = b
      end do
      n = 0
      do cell = 1, size(cell_nodes, 2, kind=ik)
         n = n + sum(constraints%n_columns(cell_nodes(:, cell)))
      end do
      allocate (elements%first(size(cell_nodes, 2) + 1), elements%item(n))
      n = 0
      do cell = 1, size(cell_nodes, 2, kind=ik)
         elements%first(cell) = n + 1
         do k = 1, 6
            node = cell_nodes(k, cell)
            do column = 1, constraints%n_columns(node)
               b = block_of(constraints%dof(column, node))
               if (any(elements%item(elements%first(cell):n) == b)) cycle
               n = n + 1
               elements%item(n) = b
            end do
         end do
      end do
      elements%first(size(cell_nodes, 2) + 1) = n + 1
      elements%item = elements%item(:n)
   end function list_blocks

   !> T' K T of an element.
   pure subroutine give(self, element, n, matrix)
      class(tied_elements_t), intent(in) :: self
      integer(ik), intent(in) :: element
      integer(ik), intent(in) :: n  !< unknowns of the element
      real(rk), intent(out) :: matrix(n, n)  !< [Pa]

      associate (nodes => self%cell_nodes(:, element))
         if (n == 12 .and. all(self%constraints%n_columns(nodes) == 2)) then
            matrix = self%stiffness(:, :, element)
         else
            call tie(self%constraints, nodes, self%stiffness(:, :, element), n, matrix)
         end if
      end associate
   end subroutine give

   !> T' K T.
   pure subroutine tie(constraints, nodes, stiffness, n, matrix)
      type(constraints_t), intent(in) :: constraints
      integer(ik), intent(in) :: nodes(6)
      real(rk), intent(in) :: stiffness(12, 12)  !< [Pa]
      integer(ik), intent(in) :: n  !< unknowns of the element
      real(rk), intent(out) :: matrix(n, n)  !< [Pa]
      real(rk) :: ties(12, n)
      integer(ik) :: column, d, k, m, unknowns(6*columns_max)

      ties = 0.0_rk
      m = 0
      do k = 1, 6
         do column = 1, constraints%n_columns(nodes(k))
            d = findloc(unknowns(:m), constraints%dof(column, nodes(k)), dim=1, kind=ik)
            if (d == 0) then
               m = m + 1
               d = m
               unknowns(m) = constraints%dof(column, nodes(k))
            end if
            ties(2*k - 1:2*k, d) = ties(2*k - 1:2*k, d) + constraints%basis(:, column, nodes(k))
         end do
      end do
      matrix = matmul(transpose(ties), matmul(stiffness, ties))
   end subroutine tie

end module fine_elements
