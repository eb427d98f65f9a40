!> Symmetric positive definite systems that are sums of small dense matrices, such as those of
!! finite elements, by the multifrontal method (Duff and Reid 1983): the matrix as a whole is never
!! formed.
!! With a sign given for each unknown also quasi-definite ones, [K B; B^T -C] with definite K and C:
!! they have factors A = L S L^T, S the signs, in any order without exchange (Vanderbei 1995). The
!! caller has to check the growth of rounding errors.
!! On request condensed onto a few unknowns, which need not be definite.
!! Where only some elements change, as around a tip that moves, what does not depend on them stays.
!!
!! Systems have no common data, so that several can be factorized at the same time; in a large one
!! subtrees of fronts are eliminated in parallel (`algebra_elimination`), with the same bits for any
!! number of threads.
module algebra_multifrontal
   use, intrinsic :: iso_fortran_env, only: int64
   use algebra_elimination, only: element_matrices_t, eliminate_again, eliminate_fronts, &
                                  factors_t, pivots_of, size_of, sum_up_kept, workspace_t
   use algebra_front_kernels, only: backwards, forwards
   use algebra_fronts, only: find_fronts, find_parts, lasting_parts, parts_t
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_lists, only: lists_t
   implicit none(type, external)
   private

   public :: element_matrices_t, multifrontal_t

   !> One matrix with its factors.
   type, extends(factors_t) :: multifrontal_t
      private
      real(rk), allocatable :: eliminated(:)  !< (n) what `condense` leaves for `expand`
      logical :: is_factorized = .false.
   contains
      procedure :: analyse
      procedure :: factorize
      procedure :: solve
      procedure :: get_schur
      procedure :: condense
      procedure :: expand
   end type multifrontal_t

contains

   !> Order the unknowns and find the fronts.
   subroutine analyse(self, first_unknown, elements, error, kept, order, is_negative, changes)
      class(multifrontal_t), intent(inout) :: self
      !> (blocks + 1) Unknowns that occur in the same elements follow each other and are a block.
      integer(ik), intent(in) :: first_unknown(:)
      type(lists_t), intent(in) :: elements  !< the blocks of each
      type(error_t), allocatable, intent(out) :: error
      integer(ik), intent(in), optional :: kept(:)  !< unknowns to condense onto: whole blocks
      !> (blocks) one after another, the kept ones last; where it is absent an order is found
      integer(ik), intent(in), optional :: order(:)
      logical, intent(in), optional :: is_negative(:)  !< (unknowns) those with negative pivots
      !> (elements) those whose matrices change; not with a given order
      logical, intent(in), optional :: changes(:)
      integer(ik), parameter :: none(0) = [integer(ik) ::]
      integer(ik), allocatable :: n_pivots(:), n_rows(:)
      integer(ik) :: b, e, i, k, n, u

      self%is_factorized = .false.
      self%n = first_unknown(size(first_unknown)) - 1
      if (present(kept)) then
         call find_fronts(first_unknown, elements, kept, self%fronts, error, order, changes)
      else
         call find_fronts(first_unknown, elements, none, self%fronts, error, order, changes)
      end if
      if (allocated(error)) return
      self%lasting = parts_t()
      if (present(changes)) self%lasting = lasting_parts(self%fronts)
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

   !> Factorize.
   subroutine factorize(self, matrices, error, others_are_same)
      class(multifrontal_t), intent(inout) :: self
      class(element_matrices_t), intent(in) :: matrices
      type(error_t), allocatable, intent(out) :: error
      !> Since the last factorization only the elements that change have changed.
      logical, intent(in), optional :: others_are_same
      type(workspace_t) :: work
      integer(ik) :: n_kept, wrong
      logical :: again

      again = self%is_factorized
      if (again) again = present(others_are_same) .and. allocated(self%lasting%last)
      if (again) again = others_are_same
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
      if (again) then
         call eliminate_again(self, matrices, work, wrong)
      else
         if (allocated(self%left)) deallocate (self%left)
         if (allocated(self%lasting%last)) allocate (self%left(self%fronts%n))
         call eliminate_fronts(self, matrices, work, wrong)
      end if
      if (wrong > 0) then
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

   !> y := L^-1 y; at the kept unknowns the condensed right-hand side.
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
