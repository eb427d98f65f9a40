!> Elimination of the fronts of a matrix one after another, with subtrees in parallel on threads:
!! the numerical part of the multifrontal method (`algebra_multifrontal`).
!!
!! A front is a small dense matrix: the sum of its elements and the Schur complements of its
!! children. Its pivots are eliminated, and its Schur complement is kept on a stack for its parent.
module algebra_elimination
   use, intrinsic :: iso_fortran_env, only: int64
   use algebra_blocks, only: is_in_team
   use algebra_front_kernels, only: add_matrix, add_triangle, clear, eliminate, eliminate_signed, &
                                    push
   use algebra_fronts, only: fronts_t, parts_t
   use base_kinds, only: ik, rk
   use base_lists, only: lists_t
   implicit none(type, external)
   private

   public :: element_matrices_t, eliminate_again, eliminate_fronts, factors_t, pivots_of, size_of, &
             sum_up_kept, workspace_t

   !> Where the matrices of the elements come from.
   type, abstract :: element_matrices_t
   contains
      procedure(give_matrix), deferred :: give
   end type element_matrices_t

   abstract interface
      !> The matrix of an element, whose unknowns are those of its blocks one after another.
      pure subroutine give_matrix(self, element, n, matrix)
         import :: element_matrices_t, ik, rk
         implicit none(type, external)
         class(element_matrices_t), intent(in) :: self
         integer(ik), intent(in) :: element
         integer(ik), intent(in) :: n  !< unknowns of the element
         real(rk), intent(out) :: matrix(n, n)  !< the lower triangle at least
      end subroutine give_matrix
   end interface

   !> What a front has left.
   type :: remainder_t
      real(rk), allocatable :: triangle(:)  !< lower triangle column by column
   end type remainder_t

   !> The columns of the factor, front by front.
   type :: factors_t
      type(fronts_t) :: fronts
      type(parts_t) :: parts  !< fronts that are eliminated side by side
      type(parts_t) :: lasting  !< those that elements that change do not belong to
      type(remainder_t), allocatable :: left(:)  !< (fronts) by the roots of the lasting parts
      type(lists_t) :: unknowns  !< numbers of the unknowns of each element
      integer(ik) :: n = 0  !< unknowns
      integer(int64), allocatable :: first_entry(:)  !< (fronts + 1) in `factor`
      real(rk), allocatable :: factor(:)  !< the columns of the fronts' pivots
      real(rk), allocatable :: schur(:, :)  !< Schur complement of the kept unknowns
      !> (n) signs of the pivots in the order of elimination; not allocated: all are positive
      real(rk), allocatable :: signs(:)
   end type factors_t

   !> Whole matrices and what waits for its parent.
   type :: workspace_t
      real(rk), allocatable :: front(:)
      real(rk), allocatable :: stack(:)  !< lower triangles column by column
      integer(int64) :: top = 0  !< the last entry in use
      integer(ik), allocatable :: waiting(:)  !< fronts on the stack
      integer(ik) :: n_waiting = 0
      integer(ik), allocatable :: place(:)  !< (unknowns) in the present front
      integer(ik), allocatable :: places(:)  !< the same of an element or of what a child has left
      real(rk), allocatable :: matrix(:)  !< of an element
   end type workspace_t

contains

   !> How many unknowns front i eliminates.
   pure integer(ik) function pivots_of(self, i)
      class(factors_t), intent(in) :: self
      integer(ik), intent(in) :: i

      pivots_of = self%fronts%first_pivot(i + 1) - self%fronts%first_pivot(i)
   end function pivots_of

   !> How many unknowns front i has.
   pure integer(ik) function size_of(self, i)
      class(factors_t), intent(in) :: self
      integer(ik), intent(in) :: i

      size_of = pivots_of(self, i) + self%fronts%rows%length(i)
   end function size_of

   !> Eliminate all fronts. What they leave for the kept unknowns stays in the workspace.
   recursive subroutine eliminate_fronts(self, matrices, work, wrong)
      class(factors_t), intent(inout) :: self  !< `factor` has its size
      class(element_matrices_t), intent(in) :: matrices
      type(workspace_t), intent(out) :: work
      integer(ik), intent(out) :: wrong  !< place of a pivot of the wrong sign in its front; 0: none
      type(workspace_t) :: part(size(self%parts%first))
      integer(ik) :: k, wrong_in(size(self%parts%first))

      if (.not. is_in_team()) then
         !$omp parallel if(size(part) > 1)
         !$omp single
         call eliminate_fronts(self, matrices, work, wrong)
         !$omp end single
         !$omp end parallel
         return
      end if
      !$omp taskloop grainsize(1) default(shared)
      do k = 1, size(part, kind=ik)
         call eliminate_part(self, matrices, k, part(k), wrong_in(k))
      end do
      !$omp end taskloop
      wrong = maxval([0_ik, wrong_in])
      if (wrong == 0) call eliminate_rest(self, matrices, self%parts, part, work, wrong)
   end subroutine eliminate_fronts

   !> Eliminate only the fronts of the elements that change, and those above.
   subroutine eliminate_again(self, matrices, work, wrong)
      class(factors_t), intent(inout) :: self
      class(element_matrices_t), intent(in) :: matrices
      type(workspace_t), intent(out) :: work
      integer(ik), intent(out) :: wrong  !< place of a pivot of the wrong sign in its front; 0: none
      type(workspace_t) :: part(size(self%lasting%last))
      integer :: k

      do k = 1, size(part)
         part(k)%stack = self%left(self%lasting%last(k))%triangle
         part(k)%top = size(part(k)%stack, kind=int64)
      end do
      call eliminate_rest(self, matrices, self%lasting, part, work, wrong)
   end subroutine eliminate_again

   !> Eliminate the fronts of a part: only what its root leaves stays in the workspace.
   subroutine eliminate_part(self, matrices, k, work, wrong)
      class(factors_t), intent(inout) :: self
      class(element_matrices_t), intent(in) :: matrices
      integer(ik), intent(in) :: k
      type(workspace_t), intent(out) :: work
      integer(ik), intent(out) :: wrong  !< place of a pivot of the wrong sign; 0: none
      type(parts_t) :: none
      integer(ik) :: i

      allocate (none%first(0), none%last(0))
      call prepare(self, self%parts%first(k), self%parts%last(k), none, work)
      do i = self%parts%first(k), self%parts%last(k)
         call eliminate_front(self, matrices, i, work, wrong)
         if (wrong > 0) return
      end do
      deallocate (work%front, work%place, work%places, work%matrix)
      work%stack = work%stack(:work%top)
   end subroutine eliminate_part

   !> Eliminate the fronts that are in no part, after these.
   subroutine eliminate_rest(self, matrices, parts, part, work, wrong)
      class(factors_t), intent(inout) :: self
      class(element_matrices_t), intent(in) :: matrices
      type(parts_t), intent(in) :: parts
      type(workspace_t), intent(inout) :: part(:)  !< what they leave; emptied
      type(workspace_t), intent(out) :: work
      integer(ik), intent(out) :: wrong  !< place of a pivot of the wrong sign; 0: none
      integer(ik) :: i, k

      wrong = 0
      call prepare(self, 1, self%fronts%n, parts, work)
      i = 0
      k = 1
      do while (i < self%fronts%n)
         i = i + 1
         if (k <= size(part)) then
            if (i == parts%first(k)) then
               i = parts%last(k)
               work%stack(work%top + 1:work%top + part(k)%top) = part(k)%stack
               work%top = work%top + part(k)%top
               work%n_waiting = work%n_waiting + 1
               work%waiting(work%n_waiting) = i
               deallocate (part(k)%stack)
               k = k + 1
               cycle
            end if
         end if
         call eliminate_front(self, matrices, i, work, wrong)
         if (wrong > 0) return
      end do
   end subroutine eliminate_rest

   !> Room for the largest front and the highest stack in a range of fronts, of which what is in
   !! parts has been eliminated before.
   pure subroutine prepare(self, first, last, parts, work)
      class(factors_t), intent(in) :: self
      integer(ik), intent(in) :: first, last
      type(parts_t), intent(in) :: parts
      type(workspace_t), intent(out) :: work
      integer(int64) :: highest, largest
      integer(ik) :: e, i, k, largest_element, next
      logical :: is_done

      allocate (work%place(self%n), work%waiting(last - first + 1))
      highest = 0
      largest = 0
      largest_element = 0
      do e = 1, size(self%unknowns%first, kind=ik) - 1
         largest_element = max(largest_element, self%unknowns%length(e))
      end do
      i = first - 1
      next = 1
      do while (i < last)
         i = i + 1
         if (next <= size(parts%first)) then
            is_done = i == parts%first(next)
         else
            is_done = .false.
         end if
         if (is_done) then
            i = parts%last(next)
            next = next + 1
         else
            largest = max(largest, int(size_of(self, i), int64)**2)
            do k = 1, self%fronts%n_children(i)
               work%top = work%top - triangle_of(self, work%waiting(work%n_waiting))
               work%n_waiting = work%n_waiting - 1
            end do
         end if
         work%top = work%top + triangle_of(self, i)
         work%n_waiting = work%n_waiting + 1
         work%waiting(work%n_waiting) = i
         highest = max(highest, work%top)
      end do
      work%top = 0
      work%n_waiting = 0
      allocate (work%front(largest), work%stack(highest))
      allocate (work%places(self%n), work%matrix(largest_element**2))
   end subroutine prepare

   !> How many entries what front i leaves has.
   pure integer(int64) function triangle_of(self, i)
      class(factors_t), intent(in) :: self
      integer(ik), intent(in) :: i
      integer(int64) :: n

      n = self%fronts%rows%length(i)
      triangle_of = (n*(n + 1))/2
   end function triangle_of

   !> Add up a front, eliminate its pivots, and put its Schur complement on the stack.
   subroutine eliminate_front(self, matrices, i, work, place)
      class(factors_t), intent(inout) :: self
      class(element_matrices_t), intent(in) :: matrices
      integer(ik), intent(in) :: i
      type(workspace_t), intent(inout) :: work
      integer(ik), intent(out) :: place  !< of a pivot of the wrong sign; 0: none
      integer(ik) :: child, k, m, n, n_pivots

      n_pivots = pivots_of(self, i)
      n = size_of(self, i)
      associate (fronts => self%fronts)
         call clear(n, work%front)
         do k = 1, n_pivots
            work%place(fronts%first_pivot(i) + k - 1) = k
         end do
         do k = 1, n - n_pivots
            work%place(fronts%rows%at(i, k)) = n_pivots + k
         end do
         call add_elements(self, matrices, i, work%place, work%places, work%matrix, n, work%front)
         do child = 1, fronts%n_children(i)
            call pop(self, work, m)
            if (m == 0) cycle
            call add_triangle(m, work%places, work%stack(work%top + 1), n, work%front)
         end do
         if (allocated(self%signs)) then
            call eliminate_signed(work%front, n, self%signs(fronts%first_pivot(i): &
                                                            fronts%first_pivot(i + 1) - 1), place)
         else
            call eliminate(work%front, n, n_pivots, place)
         end if
         if (place > 0) return
         self%factor(self%first_entry(i):self%first_entry(i + 1) - 1) &
            = work%front(:int(n, int64)*n_pivots)
         call push(work%front, n, n_pivots, work%stack, work%top)
         if (allocated(self%left)) then
            if (fronts%is_lasting(i)) self%left(i)%triangle &
               = work%stack(work%top - triangle_of(self, i) + 1:work%top)
         end if
         work%n_waiting = work%n_waiting + 1
         work%waiting(work%n_waiting) = i
      end associate
   end subroutine eliminate_front

   !> Add the elements of front i to its matrix.
   pure subroutine add_elements(self, matrices, i, place, places, matrix, n, front)
      class(factors_t), intent(in) :: self
      class(element_matrices_t), intent(in) :: matrices
      integer(ik), intent(in) :: i
      integer(ik), intent(in) :: place(:)  !< (unknowns) in the front
      integer(ik), intent(inout) :: places(:)  !< workspace: places of an element
      real(rk), intent(inout) :: matrix(:)  !< workspace: its matrix
      integer(ik), intent(in) :: n
      real(rk), intent(inout) :: front(n, n)
      integer(ik) :: e, j, k, m

      do k = self%fronts%elements%first(i), self%fronts%elements%last(i)
         e = self%fronts%elements%item(k)
         m = self%unknowns%length(e)
         do j = 1, m
            places(j) = place(self%unknowns%at(e, j))
         end do
         call matrices%give(e, m, matrix)
         call add_matrix(m, places, matrix, n, front)
      end do
   end subroutine add_elements

   !> Take what a front has left from the top of the stack: its entries stay right above the new
   !! top, their places in the present front are in work%places.
   pure subroutine pop(self, work, m)
      class(factors_t), intent(in) :: self
      type(workspace_t), intent(inout) :: work
      integer(ik), intent(out) :: m  !< unknowns of the front that are left
      integer(ik) :: child, k

      child = work%waiting(work%n_waiting)
      work%n_waiting = work%n_waiting - 1
      work%top = work%top - triangle_of(self, child)
      m = self%fronts%rows%length(child)
      do k = 1, m
         work%places(k) = work%place(self%fronts%rows%at(child, k))
      end do
   end subroutine pop

   !> The Schur complement of the kept unknowns.
   pure subroutine sum_up_kept(self, matrices, work)
      class(factors_t), intent(inout) :: self
      class(element_matrices_t), intent(in) :: matrices
      type(workspace_t), intent(inout) :: work
      integer(ik) :: i, j, m, n

      n = self%n - self%fronts%n_free
      work%place(self%fronts%n_free + 1:) = [(i, i=1, n)]
      call add_elements(self, matrices, self%fronts%n + 1_ik, work%place, work%places, &
                        work%matrix, n, self%schur)
      do while (work%n_waiting > 0)
         call pop(self, work, m)
         if (m == 0) cycle
         call add_triangle(m, work%places, work%stack(work%top + 1), n, self%schur)
      end do
      do j = 2, n
         self%schur(:j - 1, j) = self%schur(j, :j - 1)
      end do
   end subroutine sum_up_kept

end module algebra_elimination
