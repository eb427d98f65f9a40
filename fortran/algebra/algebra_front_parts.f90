!> Which fronts may be eliminated side by side: subtrees that share nothing, chosen by the work in
!! them and not by the number of threads, so that sums are formed in the same order for any number.
module algebra_front_parts
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: find_parts, parts_t

   !> Each part is a subtree: fronts from the first one to the last one, its root. Rising.
   type :: parts_t
      integer(ik), allocatable :: first(:)
      integer(ik), allocatable :: last(:)
   end type parts_t

   real(rk), parameter :: least_work = 2.0e7_rk  !< below it starting threads costs more [flop]
   real(rk), parameter :: largest_share = 0.2_rk  !< of the work in one part; larger ones are split
   real(rk), parameter :: least_share = 0.01_rk  !< smaller ones are left with the rest
   !> What parts leave waits until all of them are done: at most this share of the factors' entries.
   real(rk), parameter :: waiting_share = 0.1_rk

contains

   !> Find them. There are none where they would not pay.
   pure subroutine find_parts(n_children, n_pivots, n_rows, parts)
      integer(ik), intent(in) :: n_children(:)  !< (fronts) in the order of their elimination
      integer(ik), intent(in) :: n_pivots(:)  !< (fronts)
      integer(ik), intent(in) :: n_rows(:)  !< (fronts) unknowns that are left
      type(parts_t), intent(out) :: parts
      integer(ik), allocatable :: first(:), parent(:)
      real(rk), allocatable :: work(:)
      logical, allocatable :: is_part(:)
      real(rk) :: total
      integer(ik) :: i, n

      allocate (parts%first(0), parts%last(0))
      n = size(n_children, kind=ik)
      call sum_up_work(n_children, n_pivots, n_rows, first, parent, work)
      total = sum(work, mask=parent == 0)
      if (total < least_work) return
      allocate (is_part(n))
      do i = 1, n
         is_part(i) = work(i) <= largest_share*total .and. work(i) >= least_share*total
         if (is_part(i) .and. parent(i) > 0) then
            is_part(i) = work(parent(i)) > largest_share*total
         end if
      end do
      if (count(is_part) < 2) return
      if (sum(0.5_rk*real(n_rows, rk)**2, mask=is_part) > waiting_share &
          *sum(real(n_pivots, rk)*(n_pivots + n_rows))) return
      parts%last = pack([(i, i=1, n)], is_part)
      parts%first = first(parts%last)
   end subroutine find_parts

   !> The work of each subtree, its first front and the parent of its root.
   pure subroutine sum_up_work(n_children, n_pivots, n_rows, first, parent, work)
      integer(ik), intent(in) :: n_children(:), n_pivots(:), n_rows(:)
      integer(ik), allocatable, intent(out) :: first(:)
      integer(ik), allocatable, intent(out) :: parent(:)  !< 0: none
      real(rk), allocatable, intent(out) :: work(:)  !< [flop]
      integer(ik) :: child, i, k, n_waiting
      integer(ik) :: waiting(size(n_children))

      allocate (first(size(n_children)), work(size(n_children)))
      allocate (parent(size(n_children)), source=0_ik)
      n_waiting = 0
      do i = 1, size(n_children, kind=ik)
         first(i) = i
         work(i) = real(n_pivots(i), rk)*real(n_pivots(i) + n_rows(i), rk)**2
         do k = 1, n_children(i)
            child = waiting(n_waiting)
            n_waiting = n_waiting - 1
            first(i) = min(first(i), first(child))
            work(i) = work(i) + work(child)
            parent(child) = i
         end do
         n_waiting = n_waiting + 1
         waiting(n_waiting) = i
      end do
   end subroutine sum_up_work

end module algebra_front_parts
