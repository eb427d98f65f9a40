!> Unknowns that a linear step leaves out of its matrix.
!!
!! The two jumps of a point hold each other where its equations contain no force: a point that
!! sticks does not move, and one that slips opens with its slip alone. Such equations are solved
!! point by point and leave the matrix to the other unknowns. In networks, most of whose faces
!! stick, that matrix is small.
module contact_ties
   use base_kinds, only: ik, rk
   use contact_dense, only: solve_by_parts, solve_full
   use contact_newton, only: step_quality_t
   implicit none(type, external)
   private

   public :: new_ties, ties_t

   !> The step of each unknown: of its own, or
   !!   step = rest + share * step of the partner
   type :: ties_t
      logical, allocatable :: is_tied(:)
      integer(ik), allocatable :: partner(:)  !< 0: none
      real(rk), allocatable :: share(:)  !< [-]
      real(rk), allocatable :: rest(:)  !< [Pa]
   contains
      procedure :: tie
      procedure :: kept
      procedure :: reduce
      procedure :: find_step
   end type ties_t

contains

   !> Nothing is tied yet.
   pure function new_ties(n) result(ties)
      integer(ik), intent(in) :: n  !< number of unknowns
      type(ties_t) :: ties

      allocate (ties%is_tied(n), source=.false.)
      allocate (ties%partner(n), source=0_ik)
      allocate (ties%share(n), ties%rest(n), source=0.0_rk)
   end function new_ties

   !> Tie the jumps of a point, as far as its equations hold no others.
   pure subroutine tie(self, at, own, is_own, residual)
      class(ties_t), intent(inout) :: self
      integer(ik), intent(in) :: at  !< the number of [u]_n; [u]_tau follows it
      real(rk), intent(in) :: own(2, 2)  !< (equation, jump) derivatives [-]
      logical, intent(in) :: is_own(2)  !< the equation holds no other unknown
      real(rk), intent(in) :: residual(2)  !< [Pa]
      real(rk) :: determinant

      if (.not. is_own(1) .or. .not. abs(own(1, 1)) > 0.0_rk) return
      if (is_own(2)) then
         determinant = own(1, 1)*own(2, 2) - own(1, 2)*own(2, 1)
         if (.not. abs(determinant) > 0.0_rk) return
         self%is_tied(at:at + 1) = .true.
         self%rest(at) = (own(1, 2)*residual(2) - own(2, 2)*residual(1))/determinant
         self%rest(at + 1) = (own(2, 1)*residual(1) - own(1, 1)*residual(2))/determinant
      else
         self%is_tied(at) = .true.
         self%partner(at) = at + 1
         self%share(at) = -own(1, 2)/own(1, 1)
         self%rest(at) = -residual(1)/own(1, 1)
      end if
   end subroutine tie

   !> The unknowns that are left.
   pure function kept(self) result(numbers)
      class(ties_t), intent(in) :: self
      integer(ik), allocatable :: numbers(:)
      integer(ik) :: i

      numbers = pack([(i, i=1, size(self%is_tied, kind=ik))],.not. self%is_tied)
   end function kept

   !> Take the tied unknowns out of an equation.
   pure subroutine reduce(self, row, residual)
      class(ties_t), intent(in) :: self
      real(rk), intent(inout) :: row(:)  !< derivatives by all unknowns [-]
      real(rk), intent(inout) :: residual  !< [Pa]
      integer(ik) :: i

      do i = 1, size(row, kind=ik)
         if (.not. self%is_tied(i)) cycle
         residual = residual + row(i)*self%rest(i)
         if (self%partner(i) == 0) cycle
         row(self%partner(i)) = row(self%partner(i)) + row(i)*self%share(i)
      end do
   end subroutine reduce

   !> The step of all unknowns from the equations of those that are kept, which are used up.
   subroutine find_step(self, matrix, residual, with_condition, step, quality, left_out, factor)
      class(ties_t), intent(in) :: self
      real(rk), intent(inout), contiguous :: matrix(:, :)  !< an equation per column [-]
      real(rk), intent(inout) :: residual(:)  !< (kept) [Pa]
      logical, intent(in) :: with_condition
      real(rk), intent(out) :: step(:)  !< (all) [Pa]
      type(step_quality_t), intent(out) :: quality
      logical, intent(in), optional :: left_out(:)  !< (all) of the condition, see solve_full
      !> (kept) where the condition is not asked for: see solve_by_parts
      real(rk), intent(in), optional :: factor(:)
      real(rk) :: solution(size(residual))
      integer(ik) :: i, kept(size(residual))
      logical :: is_solved

      kept = self%kept()
      is_solved = .false.
      if (present(factor) .and. .not. with_condition) then
         if (is_worth(factor)) then
            call solve_by_parts(matrix, residual, factor, solution, quality, is_solved)
         end if
      end if
      if (is_solved) then
         continue
      else if (present(left_out)) then
         call solve_full(matrix, residual, with_condition, solution, quality, left_out(kept))
      else
         call solve_full(matrix, residual, with_condition, solution, quality)
      end if
      if (quality%is_singular) return
      step = self%rest
      step(kept) = solution
      do i = 1, size(step, kind=ik)
         if (self%partner(i) > 0) step(i) = step(i) + self%share(i)*step(self%partner(i))
      end do
   end subroutine find_step

   !> Whether enough equations have a factor for being solved apart.
   pure logical function is_worth(factor)
      real(rk), intent(in) :: factor(:)  !< see solve_by_parts
      integer(ik), parameter :: many = 32
      integer(ik) :: n

      n = count(abs(factor) > 0.0_rk, kind=ik)
      is_worth = n >= many .and. 2*n >= size(factor)
   end function is_worth

end module contact_ties
