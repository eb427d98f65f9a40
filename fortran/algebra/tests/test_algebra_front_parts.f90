!> Parts of a tree of fronts: subtrees that share nothing and hold most of the work, and none where
!! they would not pay.
program test_algebra_front_parts
   use algebra_fronts, only: find_parts, parts_t
   use base_kinds, only: ik, rk
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks

   call divides_a_tree()
   call leaves_alone()
   call checks%finish()

contains

   !> A binary tree of seven generations in the order of elimination; the front of generation g has
   !! 100/g pivots and as many other unknowns, the root none.
   recursive pure subroutine grow(generation, n_children, n_pivots, n_rows)
      integer(ik), intent(in) :: generation
      integer(ik), allocatable, intent(inout) :: n_children(:), n_pivots(:), n_rows(:)
      integer(ik), parameter :: youngest = 7

      if (generation < youngest) then
         call grow(generation + 1, n_children, n_pivots, n_rows)
         call grow(generation + 1, n_children, n_pivots, n_rows)
      end if
      n_children = [n_children, merge(2_ik, 0_ik, generation < youngest)]
      n_pivots = [n_pivots, 100_ik/generation]
      n_rows = [n_rows, merge(0_ik, 100_ik/generation, generation == 1)]
   end subroutine grow

   subroutine make(n_children, n_pivots, n_rows)
      integer(ik), allocatable, intent(out) :: n_children(:), n_pivots(:), n_rows(:)

      allocate (n_children(0), n_pivots(0), n_rows(0))
      call grow(1_ik, n_children, n_pivots, n_rows)
   end subroutine make

   subroutine divides_a_tree()
      integer(ik), allocatable :: n_children(:), n_pivots(:), n_rows(:)
      type(parts_t) :: parts
      real(rk) :: inside
      integer(ik) :: i, k

      call make(n_children, n_pivots, n_rows)
      n_pivots = 200
      n_rows = min(n_rows, 50)
      call find_parts(n_children, n_pivots, n_rows, parts)
      call checks%is_true(size(parts%first) == 8, "the fourth generation")
      call checks%is_true(all(parts%first <= parts%last), "fronts in each")
      call checks%is_true(all(parts%first(2:) > parts%last(:size(parts%last) - 1)), &
                          "nothing in two of them")
      ! What a subtree leaves is one triangle: all its children are in it.
      do k = 1, size(parts%first)
         associate (part => n_children(parts%first(k):parts%last(k)))
            call checks%is_true(sum(part) == size(part) - 1, "a part is a whole subtree")
         end associate
      end do
      inside = 0.0_rk
      do k = 1, size(parts%first)
         do i = parts%first(k), parts%last(k)
            inside = inside + real(n_pivots(i), rk)*real(n_pivots(i) + n_rows(i), rk)**2
         end do
      end do
      call checks%is_true(inside > 0.9_rk*sum(real(n_pivots, rk) &
                                              *real(n_pivots + n_rows, rk)**2), &
                          "nearly all of the work is in parts")
   end subroutine divides_a_tree

   !> Small trees, chains, and parts that would leave more than they factorize.
   subroutine leaves_alone()
      integer(ik), allocatable :: n_children(:), n_pivots(:), n_rows(:)
      type(parts_t) :: parts
      integer(ik) :: i

      call make(n_children, n_pivots, n_rows)
      call find_parts(n_children, n_pivots/10, n_rows/10, parts)
      call checks%is_true(size(parts%first) == 0, "little work")
      call find_parts(n_children, n_pivots, 100*n_rows, parts)
      call checks%is_true(size(parts%first) == 0, "much that waits")
      call find_parts([0_ik, (1_ik, i=1, 99)], spread(500_ik, 1, 100), spread(10_ik, 1, 100), parts)
      call checks%is_true(size(parts%first) == 0, "a chain")
      call find_parts([integer(ik) ::], [integer(ik) ::], [integer(ik) ::], parts)
      call checks%is_true(size(parts%first) == 0, "nothing at all")
   end subroutine leaves_alone

end program test_algebra_front_parts
