!> Symmetric positive definite systems that are sums of small dense matrices, such as those of
!! finite elements, by the multifrontal method (Duff and Reid 1983): the matrix as a whole is never
!! formed.
!! With a sign given for each unknown also quasi-definite ones, [K B; B^T -C] with definite K and C:
!! they have factors A = L S L^T, S the signs, in any order without exchange (Vanderbei 1995). How
!! far rounding grows the caller has to judge.
!! On request condensed onto a few unknowns, which need not be definite.
!!
!! A front is a small dense matrix: its elements and what its children have left are added up, its
!! pivots eliminated, and what is left waits on a stack for its parent. Nothing is shared between
!! systems, so that several can be factorized at the same time; in a large one subtrees of fronts
!! are eliminated side by side, with the same bits for any number of threads.
module algebra_multifrontal
   use, intrinsic :: iso_fortran_env, only: int64
   use algebra_front_kernels, only: add_matrix, add_triangle, backwards, clear, forwards, push
   use algebra_front_parts, only: find_parts, parts_t
   use algebra_fronts, only: find_fronts, fronts_t
   use algebra_partial_cholesky, only: eliminate, eliminate_signed
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_lists, only: lists_t
   !$ use omp_lib, only: omp_get_num_threads
   implicit none(type, external)
   private

   public :: element_matrices_t, multifrontal_t

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

   !> One matrix with its factors.
   type :: multifrontal_t
      private
      type(fronts_t) :: fronts
      type(parts_t) :: parts  !< fronts that are eliminated side by side
      type(lists_t) :: unknowns  !< numbers of the unknowns of each element
      integer(ik) :: n = 0  !< unknowns
      integer(int64), allocatable :: first_entry(:)  !< (fronts + 1) in `factor`
      real(rk), allocatable :: factor(:)  !< the columns of the fronts' pivots
      real(rk), allocatable :: schur(:, :)
      real(rk), allocatable :: eliminated(:)  !< (n) what `condense` leaves for `expand`
      !> (n) signs of the pivots in the order of elimination; not allocated: all are positive
      real(rk), allocatable :: signs(:)
      logical :: is_factorized = .false.
   contains
      procedure :: analyse
      procedure :: factorize
      procedure :: solve
      procedure :: get_schur
      procedure :: condense
      procedure :: expand
   end type multifrontal_t

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

   !> Order the unknowns and find the fronts.
   subroutine analyse(self, first_unknown, elements, error, kept, order, is_negative)
      class(multifrontal_t), intent(inout) :: self
      !> (blocks + 1) Unknowns that occur in the same elements follow each other and are a block.
      integer(ik), intent(in) :: first_unknown(:)
      type(lists_t), intent(in) :: elements  !< the blocks of each
      type(error_t), allocatable, intent(out) :: error
      integer(ik), intent(in), optional :: kept(:)  !< unknowns to condense onto: whole blocks
      !> (blocks) one after another, the kept ones last; where it is absent an order is found
      integer(ik), intent(in), optional :: order(:)
      logical, intent(in), optional :: is_negative(:)  !< (unknowns) those with negative pivots
      integer(ik), parameter :: none(0) = [integer(ik) ::]
      integer(ik), allocatable :: n_pivots(:), n_rows(:)
      integer(ik) :: b, e, i, k, n, u

      self%is_factorized = .false.
      self%n = first_unknown(size(first_unknown)) - 1
      if (present(kept)) then
         call find_fronts(first_unknown, elements, kept, self%fronts, error, order)
      else
         call find_fronts(first_unknown, elements, none, self%fronts, error, order)
      end if
      if (allocated(error)) return
      if (allocated(self%signs)) deallocate (self%signs)
      if (present(is_negative)) then
         allocate (self%signs(self%n))
         self%signs(self%fronts%number) = merge(-1.0_rk, 1.0_rk, is_negative)
         self%signs(self%fronts%n_free + 1:) = 1.0_rk
      end if
      n = 0
      do k = 1, size(elements%item, kind=ik)
         b = elements%item(k)
         n = n + first_unknown(b + 1) - first_unknown(b)
      end do
      if (allocated(self%unknowns%first)) deallocate (self%unknowns%first, self%unknowns%item)
      allocate (self%unknowns%first(size(elements%first)), self%unknowns%item(n))
      n = 0
      do e = 1, size(elements%first, kind=ik) - 1
         self%unknowns%first(e) = n + 1
         do k = elements%first(e), elements%last(e)
            b = elements%item(k)
            do u = first_unknown(b), first_unknown(b + 1) - 1
               n = n + 1
               self%unknowns%item(n) = self%fronts%number(u)
            end do
         end do
      end do
      self%unknowns%first(size(elements%first)) = n + 1

      if (allocated(self%first_entry)) deallocate (self%first_entry)
      allocate (self%first_entry(self%fronts%n + 1))
      self%first_entry(1) = 1
      do i = 1, self%fronts%n
         self%first_entry(i + 1) = self%first_entry(i) &
                                   + int(pivots_of(self, i), int64)*size_of(self, i)
      end do
      n_pivots = [(pivots_of(self, i), i=1, self%fronts%n)]
      n_rows = [(self%fronts%rows%length(i), i=1, self%fronts%n)]
      call find_parts(self%fronts%n_children, n_pivots, n_rows, self%parts)
   end subroutine analyse

   !> How many unknowns front i eliminates.
   pure integer(ik) function pivots_of(self, i)
      class(multifrontal_t), intent(in) :: self
      integer(ik), intent(in) :: i

      pivots_of = self%fronts%first_pivot(i + 1) - self%fronts%first_pivot(i)
   end function pivots_of

   !> How many unknowns front i has.
   pure integer(ik) function size_of(self, i)
      class(multifrontal_t), intent(in) :: self
      integer(ik), intent(in) :: i

      size_of = pivots_of(self, i) + self%fronts%rows%length(i)
   end function size_of

   !> Factorize.
   subroutine factorize(self, matrices, error)
      class(multifrontal_t), intent(inout) :: self
      class(element_matrices_t), intent(in) :: matrices
      type(error_t), allocatable, intent(out) :: error
      type(workspace_t), allocatable :: part(:)
      type(workspace_t) :: work
      integer(ik), allocatable :: wrong(:)
      integer(ik) :: n_kept
      logical :: inside  !< a team of threads: windows are evaluated side by side

      self%is_factorized = .false.
      if (.not. allocated(self%first_entry)) then
         call raise_error(error, "multifrontal_t%factorize", "the matrix has not been analysed")
         return
      end if
      if (allocated(self%factor)) then
         if (size(self%factor, kind=int64) /= self%first_entry(self%fronts%n + 1) - 1) then
            deallocate (self%factor)
         end if
      end if
      if (.not. allocated(self%factor)) then
         allocate (self%factor(self%first_entry(self%fronts%n + 1) - 1))
      end if
      allocate (part(size(self%parts%first)), wrong(size(self%parts%first)))
      inside = .false.
      !$ inside = omp_get_num_threads() > 1
      if (inside) then  ! threads that have nothing else to do take their share
         call eliminate_parts(self, matrices, part, wrong)
      else
         !$omp parallel if(size(part) > 1)
         !$omp single
         call eliminate_parts(self, matrices, part, wrong)
         !$omp end single
         !$omp end parallel
      end if
      if (all(wrong == 0)) call eliminate_rest(self, matrices, part, work, wrong)
      if (any(wrong > 0)) then
         call raise_error(error, "multifrontal_t%factorize", "the matrix is singular, "// &
                          "indefinite (or not quasi-definite), or has an entry that is not "// &
                          "a finite number")
         return
      end if

      deallocate (work%front)  ! it may be as large as what follows
      n_kept = self%n - self%fronts%n_free
      if (allocated(self%schur)) deallocate (self%schur)
      allocate (self%schur(n_kept, n_kept), source=0.0_rk)
      if (n_kept > 0) call sum_up_kept(self, matrices, work)
      if (.not. sum(abs(self%schur)) <= huge(1.0_rk)) then
         call raise_error(error, "multifrontal_t%factorize", &
                          "the matrix has an entry that is not a finite number")
         return
      end if
      self%is_factorized = .true.
   end subroutine factorize

   !> Eliminate the fronts of all parts, each as a task of its own for the team of threads.
   subroutine eliminate_parts(self, matrices, part, wrong)
      class(multifrontal_t), intent(inout) :: self
      class(element_matrices_t), intent(in) :: matrices
      type(workspace_t), intent(inout) :: part(:)
      integer(ik), intent(inout) :: wrong(:)  !< (parts) place of a pivot of the wrong sign; 0: none
      integer(ik) :: k

      !$omp taskloop grainsize(1) default(shared)
      do k = 1, size(part, kind=ik)
         call eliminate_part(self, matrices, k, part(k), wrong(k))
      end do
      !$omp end taskloop
   end subroutine eliminate_parts

   !> Eliminate the fronts of a part: only what its root leaves stays in the workspace.
   subroutine eliminate_part(self, matrices, k, work, wrong)
      class(multifrontal_t), intent(inout) :: self
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
   subroutine eliminate_rest(self, matrices, part, work, wrong)
      class(multifrontal_t), intent(inout) :: self
      class(element_matrices_t), intent(in) :: matrices
      type(workspace_t), intent(inout) :: part(:)  !< emptied
      type(workspace_t), intent(out) :: work
      integer(ik), allocatable, intent(out) :: wrong(:)
      integer(ik) :: i, k

      allocate (wrong(1), source=0_ik)
      call prepare(self, 1, self%fronts%n, self%parts, work)
      i = 0
      k = 1
      do while (i < self%fronts%n)
         i = i + 1
         if (k <= size(part)) then
            if (i == self%parts%first(k)) then
               i = self%parts%last(k)
               work%stack(work%top + 1:work%top + part(k)%top) = part(k)%stack
               work%top = work%top + part(k)%top
               work%n_waiting = work%n_waiting + 1
               work%waiting(work%n_waiting) = i
               deallocate (part(k)%stack)
               k = k + 1
               cycle
            end if
         end if
         call eliminate_front(self, matrices, i, work, wrong(1))
         if (wrong(1) > 0) return
      end do
   end subroutine eliminate_rest

   !> Room for the largest front and the highest stack in a range of fronts, of which what is in
   !! parts has been eliminated before.
   pure subroutine prepare(self, first, last, parts, work)
      type(multifrontal_t), intent(in) :: self
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
      type(multifrontal_t), intent(in) :: self
      integer(ik), intent(in) :: i
      integer(int64) :: n

      n = self%fronts%rows%length(i)
      triangle_of = (n*(n + 1))/2
   end function triangle_of

   !> Add up a front, eliminate its pivots, and put what is left on the stack.
   subroutine eliminate_front(self, matrices, i, work, place)
      type(multifrontal_t), intent(inout) :: self
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
         work%n_waiting = work%n_waiting + 1
         work%waiting(work%n_waiting) = i
      end associate
   end subroutine eliminate_front

   !> Add the elements of front i to its matrix.
   pure subroutine add_elements(self, matrices, i, place, places, matrix, n, front)
      type(multifrontal_t), intent(in) :: self
      class(element_matrices_t), intent(in) :: matrices
      integer(ik), intent(in) :: i
      integer(ik), intent(in) :: place(:)  !< (unknowns) in the front
      integer(ik), intent(inout) :: places(:)  !< room for the places of an element
      real(rk), intent(inout) :: matrix(:)  !< room for its matrix
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
      type(multifrontal_t), intent(in) :: self
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

   !> What is left at the end: the Schur complement.
   pure subroutine sum_up_kept(self, matrices, work)
      type(multifrontal_t), intent(inout) :: self
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

   !> The Schur complement, full and symmetric. It is handed over, not kept: once per factorization.
   subroutine get_schur(self, schur)
      class(multifrontal_t), intent(inout) :: self
      real(rk), allocatable, intent(out) :: schur(:, :)  !< (kept, kept)

      call move_alloc(self%schur, schur)
   end subroutine get_schur

   !> Solve for a right-hand side, where no unknowns are kept.
   subroutine solve(self, x, error)
      class(multifrontal_t), intent(in) :: self
      real(rk), intent(inout) :: x(:)  !< (n) the right-hand side, then the solution
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: y(self%n)

      call check_factors(self, size(x, kind=ik), error)
      if (allocated(error)) return
      y(self%fronts%number) = x
      call substitute_forwards(self, y)
      if (allocated(self%signs)) y = self%signs*y
      call substitute_backwards(self, y)
      x = y(self%fronts%number)
   end subroutine solve

   !> Forward elimination: the right-hand side of the condensed system. What else follows from it is
   !! kept until `expand`.
   subroutine condense(self, rhs, reduced, error)
      class(multifrontal_t), intent(inout) :: self
      real(rk), intent(in) :: rhs(:)  !< (n) entries of the kept unknowns included
      real(rk), intent(out) :: reduced(:)  !< (kept)
      type(error_t), allocatable, intent(out) :: error

      call check_factors(self, size(rhs, kind=ik), error)
      if (allocated(error)) return
      if (.not. allocated(self%eliminated)) allocate (self%eliminated(self%n))
      if (size(self%eliminated) /= self%n) then
         deallocate (self%eliminated)
         allocate (self%eliminated(self%n))
      end if
      self%eliminated(self%fronts%number) = rhs
      call substitute_forwards(self, self%eliminated)
      reduced = self%eliminated(self%fronts%n_free + 1:)
      if (allocated(self%signs)) self%eliminated = self%signs*self%eliminated
   end subroutine condense

   !> Back substitution after `condense`: all unknowns from the kept ones.
   subroutine expand(self, condensed, x, error)
      class(multifrontal_t), intent(in) :: self
      real(rk), intent(in) :: condensed(:)  !< (kept)
      real(rk), intent(out) :: x(:)  !< (n)
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: y(self%n)

      call check_factors(self, size(x, kind=ik), error)
      if (allocated(error)) return
      y = self%eliminated
      y(self%fronts%n_free + 1:) = condensed
      call substitute_backwards(self, y)
      x = y(self%fronts%number)
   end subroutine expand

   pure subroutine check_factors(self, n, error)
      class(multifrontal_t), intent(in) :: self
      integer(ik), intent(in) :: n  !< unknowns that are given
      type(error_t), allocatable, intent(out) :: error

      if (self%is_factorized .and. n == self%n) return
      call raise_error(error, "multifrontal_t", "the matrix has not been factorized for so many"// &
                       " unknowns")
   end subroutine check_factors

   !> y := L^-1 y; at the kept unknowns what is left of the right-hand side.
   pure subroutine substitute_forwards(self, y)
      class(multifrontal_t), intent(in) :: self
      real(rk), intent(inout) :: y(:)  !< (n) in the order of elimination
      real(rk) :: part(self%n)
      integer(ik) :: i

      do i = 1, self%fronts%n
         associate (rows => self%fronts%rows, first => self%fronts%first_pivot(i))
            call forwards(size_of(self, i), pivots_of(self, i), &
                          self%factor(self%first_entry(i):self%first_entry(i + 1) - 1), &
                          rows%item(rows%first(i):rows%last(i)), first, y, part)
         end associate
      end do
   end subroutine substitute_forwards

   !> y := L'^-1 y, where the kept unknowns have their values.
   pure subroutine substitute_backwards(self, y)
      class(multifrontal_t), intent(in) :: self
      real(rk), intent(inout) :: y(:)  !< (n) in the order of elimination
      real(rk) :: part(self%n)
      integer(ik) :: i

      do i = self%fronts%n, 1, -1
         associate (rows => self%fronts%rows, first => self%fronts%first_pivot(i))
            call backwards(size_of(self, i), pivots_of(self, i), &
                           self%factor(self%first_entry(i):self%first_entry(i + 1) - 1), &
                           rows%item(rows%first(i):rows%last(i)), first, y, part)
         end associate
      end do
   end subroutine substitute_backwards

end module algebra_multifrontal
