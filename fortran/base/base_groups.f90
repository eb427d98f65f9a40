!> Members that are joined pair by pair fall into groups (union-find; Tarjan 1975).
module base_groups
   use base_kinds, only: ik
   implicit none(type, external)
   private

   public :: groups_t, single_groups

   !> Groups of the members 1 .. n. Every member points to one of its group that is not larger, so
   !! that the smallest member stands for the group.
   type :: groups_t
      integer(ik), allocatable, private :: pointer_of(:)  !< (n) its own number: stands for a group
   contains
      procedure :: join
      procedure :: count_groups
      procedure :: numbers
   end type groups_t

contains

   !> Every member is its own group.
   pure function single_groups(n) result(groups)
      integer(ik), intent(in) :: n  !< members
      type(groups_t) :: groups
      integer(ik) :: member

      allocate (groups%pointer_of(n))
      do member = 1, n
         groups%pointer_of(member) = member
      end do
   end function single_groups

   !> Make one group of those of two members.
   pure subroutine join(self, a, b, were_joined)
      class(groups_t), intent(inout) :: self
      integer(ik), intent(in) :: a, b  !< members
      logical, intent(out), optional :: were_joined  !< they were in one group already
      integer(ik) :: roots(2)

      call find(self, a, roots(1))
      call find(self, b, roots(2))
      self%pointer_of(maxval(roots)) = minval(roots)
      if (present(were_joined)) were_joined = roots(1) == roots(2)
   end subroutine join

   !> The representative of a group, with path halving.
   pure subroutine find(groups, member, root)
      type(groups_t), intent(inout) :: groups
      integer(ik), intent(in) :: member
      integer(ik), intent(out) :: root

      associate (pointer_of => groups%pointer_of)
         root = member
         do while (pointer_of(root) /= root)
            pointer_of(root) = pointer_of(pointer_of(root))
            root = pointer_of(root)
         end do
      end associate
   end subroutine find

   !> How many groups there are.
   pure integer(ik) function count_groups(self)
      class(groups_t), intent(in) :: self
      integer(ik) :: member

      count_groups = count([(self%pointer_of(member) == member, &
                             member=1, size(self%pointer_of, kind=ik))], kind=ik)
   end function count_groups

   !> The group of each member, numbered 1, 2, .. in the order of their smallest members.
   pure function numbers(self) result(number)
      class(groups_t), intent(in) :: self
      integer(ik), allocatable :: number(:)
      integer(ik) :: member, n

      allocate (number(size(self%pointer_of)))
      n = 0
      do member = 1, size(number, kind=ik)
         if (self%pointer_of(member) == member) then
            n = n + 1
            number(member) = n
         else  ! a smaller member, whose number is known
            number(member) = number(self%pointer_of(member))
         end if
      end do
   end function numbers

end module base_groups
