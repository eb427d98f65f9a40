!> Lists of whole numbers of different lengths, kept one after another in one array.
!!
!!   lists   (7 2)  ()  (5 9 1)
!!   item     7 2        5 9 1        first  1 3 3 6
!!
!! List i is item(first(i):first(i + 1) - 1). What goes along with the numbers, such as a
!! coefficient for each of them, stands in a separate array in the order of `item`.
module base_lists
   use base_kinds, only: ik
   implicit none(type, external)
   private

   public :: inverted, lists_t

   !> n lists. In loops ask for `at` and `place`, which allocate nothing; `of` makes a
   !! copy.
   type :: lists_t
      integer(ik), allocatable :: first(:)  !< (n + 1) where each list begins in item
      integer(ik), allocatable :: item(:)  !< the numbers of all lists
   contains
      procedure :: length
      procedure :: last
      procedure :: at
      procedure :: of
      procedure :: place
   end type lists_t

contains

   !> How many numbers list i holds.
   pure integer(ik) function length(self, i)
      class(lists_t), intent(in) :: self
      integer(ik), intent(in) :: i  !< list

      length = self%first(i + 1) - self%first(i)
   end function length

   !> Where list i ends in `item`; before its beginning if it is empty.
   pure integer(ik) function last(self, i)
      class(lists_t), intent(in) :: self
      integer(ik), intent(in) :: i  !< list

      last = self%first(i + 1) - 1
   end function last

   !> The k-th number of list i.
   pure integer(ik) function at(self, i, k)
      class(lists_t), intent(in) :: self
      integer(ik), intent(in) :: i  !< list
      integer(ik), intent(in) :: k  !< from 1 to its length

      at = self%item(self%first(i) + k - 1)
   end function at

   !> The numbers of list i.
   pure function of(self, i) result(items)
      class(lists_t), intent(in) :: self
      integer(ik), intent(in) :: i  !< list
      integer(ik), allocatable :: items(:)

      items = self%item(self%first(i):self%first(i + 1) - 1)
   end function of

   !> Which number of list i equals `item`: its place from 1 on; 0 if none does.
   pure integer(ik) function place(self, i, item)
      class(lists_t), intent(in) :: self
      integer(ik), intent(in) :: i  !< list
      integer(ik), intent(in) :: item  !< looked for

      place = findloc(self%item(self%first(i):self%first(i + 1) - 1), item, dim=1)
   end function place

   !> The lists of those columns of a table in which each number from 1 to n stands, in the order of
   !! the columns. From the nodes of each cell it makes the cells around each node. A number that
   !! stands in a column twice has it twice; zeros are passed over.
   pure function inverted(table, n) result(lists)
      integer(ik), intent(in) :: table(:, :)  !< numbers from 0 to n
      integer(ik), intent(in) :: n  !< lists
      type(lists_t) :: lists

      integer(ik), allocatable :: next(:)
      integer(ik) :: column, i, row

      allocate (lists%first(n + 1), source=0_ik)
      do column = 1, size(table, 2)
         do row = 1, size(table, 1)
            i = table(row, column)
            if (i > 0) lists%first(i + 1) = lists%first(i + 1) + 1
         end do
      end do
      lists%first(1) = 1
      do i = 1, n
         lists%first(i + 1) = lists%first(i + 1) + lists%first(i)
      end do
      allocate (lists%item(lists%last(n)))
      next = lists%first
      do column = 1, size(table, 2)
         do row = 1, size(table, 1)
            i = table(row, column)
            if (i == 0) cycle
            lists%item(next(i)) = column
            next(i) = next(i) + 1
         end do
      end do
   end function inverted

end module base_lists
