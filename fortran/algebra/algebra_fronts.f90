!> Which unknowns of a sum of small dense matrices, such as those of finite elements, are eliminated
!! together, and in which order: the fronts of the multifrontal method (Duff and Reid 1983).
!!
!! Unknowns come in blocks that occur in the same elements (those of a node). A front assembles its
!! elements and the Schur complements of other fronts, its children. Of these unknowns those that
!! occur nowhere else are its pivots; the Schur complement of the others goes to its parent. Some
!! unknowns may be retained: they are never pivots, and their Schur complement remains at the end.
!!
!! Elements whose matrices will change, as those around a tip that moves: what belongs to them comes
!! after all others, so that a new elimination can begin with what these leave.
!!
!! Fronts that may be eliminated in parallel: subtrees without common unknowns, chosen by their work
!! and not by the number of threads, so that sums are formed in the same order for any number.
module algebra_fronts
   use algebra_ordering, only: minimum_degree
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_lists, only: lists_t
   implicit none(type, external)
   private

   public :: find_fronts, find_parts, fronts_t, lasting_parts, parts_t

   !> Fronts in the order in which they are eliminated: what the children of a front have left lies
   !! on top of a stack.
   type :: fronts_t
      integer(ik) :: n = 0  !< fronts
      integer(ik) :: n_free = 0  !< unknowns that are eliminated
      integer(ik), allocatable :: number(:)  !< (unknowns) of each in the order; the kept ones last
      integer(ik), allocatable :: first_pivot(:)  !< (n + 1) numbers where each front's pivots begin
      type(lists_t) :: rows  !< (n) numbers of each front's other unknowns, rising
      type(lists_t) :: elements  !< (n + 1) that each front takes up; those of kept unknowns alone
      integer(ik), allocatable :: n_children(:)  !< (n)
      !> (n) what the front leaves goes to one that belongs to changing elements, or remains, and
      !! neither itself nor what is below it does; not allocated: no element changes
      logical, allocatable :: is_lasting(:)
   end type fronts_t

   !> What the elimination of one block after another leaves. Blocks by their places in the order.
   type :: elimination_t
      type(lists_t) :: left  !< blocks that each one is connected to when it is eliminated
      integer(ik), allocatable :: parent(:)  !< the first of these; 0: none is eliminated later
      integer(ik), allocatable :: taker(:)  !< (elements) their first block; 0: none is eliminated
   end type elimination_t

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

   !> Find the fronts.
   subroutine find_fronts(first_unknown, elements, kept, fronts, error, given, changes)
      integer(ik), intent(in) :: first_unknown(:)  !< (blocks + 1) where each begins
      type(lists_t), intent(in) :: elements  !< their blocks
      integer(ik), intent(in) :: kept(:)  !< unknowns that are not eliminated: whole blocks
      type(fronts_t), intent(out) :: fronts
      type(error_t), allocatable, intent(out) :: error
      !> The blocks one after another, the kept ones last; where it is absent CAMD finds an order.
      integer(ik), intent(in), optional :: given(:)
      !> (elements) matrices that will change; not with a given order
      logical, intent(in), optional :: changes(:)
      type(elimination_t) :: elimination
      integer(ik), allocatable :: order(:), place(:)
      integer(ik), allocatable :: head(:)  ! the last block of the front that each one belongs to
      integer(ik), allocatable :: heads(:)  ! (fronts)
      integer(ik), allocatable :: group(:)  ! 0, perhaps 1 for changing elements, then kept blocks
      integer(ik) :: b, e, last_group, n_blocks, n_free, n_lasting

      n_blocks = size(first_unknown, kind=ik) - 1
      allocate (fronts%number(first_unknown(n_blocks + 1) - 1), source=0_ik)
      allocate (group(n_blocks), source=0_ik)
      if (present(changes)) then
         do e = 1, size(changes, kind=ik)
            if (changes(e)) group(elements%item(elements%first(e):elements%last(e))) = 1
         end do
      end if
      fronts%number(kept) = 1
      last_group = merge(2_ik, 1_ik, present(changes))
      group = [(merge(last_group, group(b), fronts%number(first_unknown(b)) > 0), b=1, n_blocks)]
      n_lasting = count(group == 0, kind=ik)
      if (present(given)) then
         order = given
      else
         call minimum_degree(later_neighbours(elements, n_blocks), group, order, error)
         if (allocated(error)) return
      end if
      allocate (place(n_blocks))
      do b = 1, n_blocks
         place(order(b)) = b
      end do
      n_free = n_blocks - count(group == last_group, kind=ik)
      call eliminate_blocks(elements, order, place, n_free, elimination)
      associate (sizes => first_unknown(order + 1) - first_unknown(order))
         call merge_blocks(elimination, sizes, n_lasting, head)
         call arrange_fronts(elimination, head, first_unknown, order, n_lasting, fronts, heads)
         if (.not. present(changes)) deallocate (fronts%is_lasting)
         fronts%n_free = fronts%first_pivot(fronts%n + 1) - 1
         fronts%number(kept) = fronts%n_free + [(b, b=1, size(kept, kind=ik))]
         call expand_rows(elimination, heads, first_unknown, order, fronts)
      end associate
   end subroutine find_fronts

   !> Of each block those with higher numbers that occur in the same elements, rising.
   pure function later_neighbours(elements, n_blocks) result(later)
      type(lists_t), intent(in) :: elements
      integer(ik), intent(in) :: n_blocks
      type(lists_t) :: later
      type(lists_t) :: around  ! the elements of each block
      type(lists_t) :: earlier
      integer(ik), allocatable :: seen(:)
      integer(ik) :: b, c, e, i, k, n

      around = turned(elements, n_blocks)
      allocate (earlier%first(n_blocks + 1), seen(n_blocks))
      n = 0
      do e = 1, size(elements%first, kind=ik) - 1
         n = n + (elements%length(e)*(elements%length(e) - 1))/2
      end do
      allocate (earlier%item(n))
      seen = 0
      n = 0
      do c = 1, n_blocks
         earlier%first(c) = n + 1
         do i = around%first(c), around%last(c)
            e = around%item(i)
            do k = elements%first(e), elements%last(e)
               b = elements%item(k)
               if (b >= c .or. seen(b) == c) cycle
               seen(b) = c
               n = n + 1
               earlier%item(n) = b
            end do
         end do
      end do
      earlier%first(n_blocks + 1) = n + 1
      later = turned(earlier, n_blocks)
   end function later_neighbours

   !> The lists in which each number from 1 to n stands, rising.
   pure function turned(lists, n)
      type(lists_t), intent(in) :: lists
      integer(ik), intent(in) :: n
      type(lists_t) :: turned
      integer(ik), allocatable :: next(:)
      integer(ik) :: i, k, list

      allocate (turned%first(n + 1), source=0_ik)
      do k = 1, lists%first(size(lists%first)) - 1
         i = lists%item(k) + 1
         turned%first(i) = turned%first(i) + 1
      end do
      turned%first(1) = 1
      do i = 1, n
         turned%first(i + 1) = turned%first(i + 1) + turned%first(i)
      end do
      allocate (turned%item(turned%first(n + 1) - 1))
      next = turned%first
      do list = 1, size(lists%first, kind=ik) - 1
         do k = lists%first(list), lists%last(list)
            i = lists%item(k)
            turned%item(next(i)) = list
            next(i) = next(i) + 1
         end do
      end do
   end function turned

   !> Follow the elimination: a block takes up the elements that hold it and nothing else has taken,
   !! and what the blocks have left whose parent it is.
   pure subroutine eliminate_blocks(elements, order, place, n_free, elimination)
      type(lists_t), intent(in) :: elements
      integer(ik), intent(in) :: order(:), place(:)  !< (blocks)
      integer(ik), intent(in) :: n_free  !< blocks that are eliminated: the first ones in the order
      type(elimination_t), intent(out) :: elimination
      type(lists_t) :: taken
      integer(ik), allocatable :: first_child(:), next_child(:), seen(:)
      integer(ik) :: child, e, i, k, n, p

      allocate (elimination%taker(size(elements%first) - 1), source=0_ik)
      do e = 1, size(elimination%taker, kind=ik)
         p = n_free + 1
         do k = elements%first(e), elements%last(e)
            p = min(p, place(elements%item(k)))
         end do
         if (p <= n_free) elimination%taker(e) = p
      end do
      taken = grouped(elimination%taker, n_free)
      allocate (elimination%parent(n_free), first_child(n_free), next_child(n_free), source=0_ik)
      allocate (seen(size(order)), source=0_ik)
      allocate (elimination%left%first(n_free + 1), elimination%left%item(64*n_free + size(order)))
      n = 0
      associate (left => elimination%left, parent => elimination%parent)
         do p = 1, n_free
            left%first(p) = n + 1
            if (size(left%item) < n + size(order)) call extend(left%item, n)
            do i = taken%first(p), taken%last(p)
               e = taken%item(i)
               do k = elements%first(e), elements%last(e)
                  call add(place(elements%item(k)), p, seen, left%item, n)
               end do
            end do
            child = first_child(p)
            do while (child > 0)
               do k = left%first(child), left%last(child)
                  call add((left%item(k)), p, seen, left%item, n)
               end do
               child = next_child(child)
            end do
            if (n < left%first(p)) cycle
            k = minval(left%item(left%first(p):n))
            if (k > n_free) cycle
            parent(p) = k
            next_child(p) = first_child(k)
            first_child(k) = p
         end do
         left%first(n_free + 1) = n + 1
      end associate

   end subroutine eliminate_blocks

   !> One more block that is connected to block p, unless it is among them or eliminated.
   pure subroutine add(q, p, seen, item, n)
      integer(ik), intent(in) :: q, p
      integer(ik), intent(inout) :: seen(:)  !< the last block that each one was connected to
      integer(ik), intent(inout) :: item(:)
      integer(ik), intent(inout) :: n  !< items in use

      if (q <= p .or. seen(q) == p) return
      seen(q) = p
      n = n + 1
      item(n) = q
   end subroutine add

   !> Space for twice as many numbers, the first n of which are kept.
   pure subroutine extend(item, n)
      integer(ik), allocatable, intent(inout) :: item(:)
      integer(ik), intent(in) :: n
      integer(ik), allocatable :: longer(:)

      allocate (longer(2*size(item)))
      longer(:n) = item(:n)
      call move_alloc(longer, item)
   end subroutine extend

   !> Lists 1 to n of the places of each value; other values are passed over.
   pure function grouped(values, n)
      integer(ik), intent(in) :: values(:)
      integer(ik), intent(in) :: n
      type(lists_t) :: grouped
      type(lists_t) :: singles
      integer(ik) :: i

      singles%first = [(i, i=1, size(values, kind=ik) + 1)]
      singles%item = merge(values, n + 1_ik, values > 0)
      grouped = turned(singles, n + 1_ik)
      grouped%first = grouped%first(:n + 1)
   end function grouped

   !> Unite blocks with their parents in one front where that leaves few zeros in the factors.
   pure subroutine merge_blocks(elimination, sizes, n_lasting, head)
      type(elimination_t), intent(in) :: elimination
      integer(ik), intent(in) :: sizes(:)  !< unknowns of each block, in the order
      integer(ik), intent(in) :: n_lasting  !< blocks that are not united with later ones
      integer(ik), allocatable, intent(out) :: head(:)
      integer(ik), allocatable :: n_pivots(:), n_rows(:), n_zeros(:)
      integer(ik) :: k, n_free, p, zeros

      n_free = size(elimination%parent, kind=ik)
      allocate (n_pivots(n_free), n_rows(n_free), n_zeros(n_free), head(n_free))
      n_zeros = 0
      head = [(p, p=1, n_free)]
      n_pivots = sizes(:n_free)
      do p = 1, n_free
         n_rows(p) = 0
         do k = elimination%left%first(p), elimination%left%last(p)
            n_rows(p) = n_rows(p) + sizes(elimination%left%item(k))
         end do
      end do
      ! A child comes before its parent, and all children of a block before the block itself has to
      ! decide.
      do p = 1, n_free
         k = elimination%parent(p)
         if (k == 0 .or. (p <= n_lasting .and. k > n_lasting)) cycle
         zeros = n_pivots(p)*(n_pivots(k) + n_rows(k) - n_rows(p))
         if (.not. is_worth(n_pivots(p), n_pivots(k), n_zeros(p) + n_zeros(k) + zeros, &
                            n_rows(k))) cycle
         head(p) = k
         n_pivots(k) = n_pivots(k) + n_pivots(p)
         n_zeros(k) = n_zeros(k) + n_zeros(p) + zeros
      end do
      do p = n_free, 1, -1
         head(p) = head(head(p))
      end do
   end subroutine merge_blocks

   !> Whether two fronts are better one: small ones cost more for themselves than for their numbers.
   pure logical function is_worth(n_below, n_above, zeros, n_rows)
      integer(ik), intent(in) :: n_below, n_above  !< pivots
      integer(ik), intent(in) :: zeros  !< in the columns of the common front
      integer(ik), intent(in) :: n_rows  !< that the front above leaves
      integer(ik) :: n
      real :: share

      n = n_below + n_above
      share = real(zeros)/real(n*(n_rows + n))
      is_worth = zeros == 0 .or. (n <= 16 .and. share < 0.3) .or. (n <= 48 .and. share < 0.1) &
                 .or. share < 0.03
   end function is_worth

   !> Number fronts and unknowns such that what belongs below a front comes right before it.
   pure subroutine arrange_fronts(elimination, head, first_unknown, order, n_lasting, fronts, heads)
      type(elimination_t), intent(in) :: elimination
      integer(ik), intent(in) :: head(:), first_unknown(:), order(:)
      integer(ik), intent(in) :: n_lasting  !< blocks before those of changing elements
      type(fronts_t), intent(inout) :: fronts
      integer(ik), allocatable, intent(out) :: heads(:)  !< (fronts) the last block of each
      integer(ik), allocatable :: above(:), front_of(:), sequence(:), taker(:), waiting(:)
      type(lists_t) :: below, members
      integer(ik) :: at, b, e, i, k, n, n_free, n_waiting, p

      n_free = size(head, kind=ik)
      allocate (above(n_free), source=0_ik)
      do p = 1, n_free
         if (head(p) /= p) cycle
         if (elimination%parent(p) > 0) above(p) = head(elimination%parent(p))
      end do
      below = grouped(above, n_free)
      members = grouped(head, n_free)

      ! From the roots downwards, to be read backwards.
      allocate (sequence(n_free), waiting(n_free))
      n_waiting = 0
      do p = 1, n_free
         if (head(p) /= p .or. above(p) > 0) cycle
         n_waiting = n_waiting + 1
         waiting(n_waiting) = p
      end do
      n = 0
      do while (n_waiting > 0)
         p = waiting(n_waiting)
         n_waiting = n_waiting - 1
         n = n + 1
         sequence(n) = p
         do k = below%first(p), below%last(p)
            n_waiting = n_waiting + 1
            waiting(n_waiting) = below%item(k)
         end do
      end do

      fronts%n = n
      allocate (fronts%first_pivot(n + 1), fronts%n_children(n), front_of(n_free))
      allocate (fronts%is_lasting(n))
      at = 1
      do i = 1, n
         p = sequence(n + 1 - i)
         fronts%first_pivot(i) = at
         fronts%n_children(i) = below%length(p)
         fronts%is_lasting(i) = p <= n_lasting .and. (above(p) == 0 .or. above(p) > n_lasting)
         do k = members%first(p), members%last(p)
            front_of(members%item(k)) = i
            b = order(members%item(k))
            do e = first_unknown(b), first_unknown(b + 1) - 1
               fronts%number(e) = at
               at = at + 1
            end do
         end do
      end do
      fronts%first_pivot(n + 1) = at
      taker = elimination%taker
      do e = 1, size(taker, kind=ik)
         if (taker(e) > 0) taker(e) = front_of(taker(e))
         if (taker(e) == 0) taker(e) = n + 1
      end do
      fronts%elements = grouped(taker, n + 1_ik)
      heads = sequence(n:1:-1)
   end subroutine arrange_fronts

   !> The rows of each front: the unknowns that its last block leaves.
   pure subroutine expand_rows(elimination, heads, first_unknown, order, fronts)
      type(elimination_t), intent(in) :: elimination
      integer(ik), intent(in) :: heads(:)  !< (fronts) their last blocks
      integer(ik), intent(in) :: first_unknown(:), order(:)
      type(fronts_t), intent(inout) :: fronts
      type(lists_t) :: unsorted
      integer(ik) :: b, i, k, n, u

      associate (left => elimination%left)
         n = 0
         do i = 1, fronts%n
            do k = left%first(heads(i)), left%last(heads(i))
               b = order(left%item(k))
               n = n + first_unknown(b + 1) - first_unknown(b)
            end do
         end do
         allocate (unsorted%first(fronts%n + 1), unsorted%item(n))
         n = 0
         do i = 1, fronts%n
            unsorted%first(i) = n + 1
            do k = left%first(heads(i)), left%last(heads(i))
               b = order(left%item(k))
               do u = first_unknown(b), first_unknown(b + 1) - 1
                  n = n + 1
                  unsorted%item(n) = fronts%number(u)
               end do
            end do
         end do
         unsorted%first(fronts%n + 1) = n + 1
      end associate
      ! Turned twice they are rising.
      fronts%rows = turned(turned(unsorted, size(fronts%number, kind=ik)), fronts%n)
   end subroutine expand_rows

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

   !> The subtrees whose roots are lasting.
   pure type(parts_t) function lasting_parts(fronts) result(parts)
      type(fronts_t), intent(in) :: fronts
      integer(ik) :: first(fronts%n), i, waiting(fronts%n), n_waiting

      n_waiting = 0
      do i = 1, fronts%n
         first(i) = i
         n_waiting = n_waiting - fronts%n_children(i)
         if (fronts%n_children(i) > 0) first(i) = first(waiting(n_waiting + 1))
         n_waiting = n_waiting + 1
         waiting(n_waiting) = i
      end do
      parts%last = pack([(i, i=1, fronts%n)], fronts%is_lasting)
      parts%first = first(parts%last)
   end function lasting_parts

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

end module algebra_fronts
