!> Small dense matrices whose sum is a system.
module sample_elements
   use algebra_multifrontal, only: element_matrices_t
   use base_kinds, only: ik, rk
   use base_lists, only: lists_t
   implicit none(type, external)
   private

   public :: chain, matrices_t

   !> Matrices one after another.
   type, extends(element_matrices_t) :: matrices_t
      type(lists_t) :: elements  !< blocks
      integer(ik), allocatable :: first_unknown(:)  !< (blocks + 1)
      integer(ik), allocatable :: first(:)  !< (elements + 1) entry
      real(rk), allocatable :: entry(:)
   contains
      procedure :: give
   end type matrices_t

contains

   !> The matrix of an element.
   pure subroutine give(self, element, n, matrix)
      class(matrices_t), intent(in) :: self
      integer(ik), intent(in) :: element, n
      real(rk), intent(out) :: matrix(n, n)

      matrix = reshape(self%entry(self%first(element):self%first(element + 1) - 1), [n, n])
   end subroutine give

   !> Springs between the neighbours in a chain of single unknowns, the ends held or free.
   pure function chain(n, stiffness, is_held) result(matrices)
      integer(ik), intent(in) :: n
      real(rk), intent(in) :: stiffness
      logical, intent(in) :: is_held
      type(matrices_t) :: matrices
      integer(ik) :: i

      matrices%first_unknown = [(i, i=1, n + 1)]
      matrices%elements%first = [(2*i - 1, i=1, n)]
      matrices%elements%item = [([i, i + 1_ik], i=1, n - 1)]
      matrices%first = [(4*i - 3, i=1, n)]
      matrices%entry = [(stiffness*[1.0_rk, -1.0_rk, -1.0_rk, 1.0_rk], i=1, n - 1)]
      if (.not. is_held) return
      matrices%elements%first = [matrices%elements%first, [2*n, 2*n + 1]]
      matrices%elements%item = [matrices%elements%item, [1_ik, n]]
      matrices%first = [matrices%first, [4*n - 2, 4*n - 1]]
      matrices%entry = [matrices%entry, [stiffness, stiffness]]
   end function chain

end module sample_elements
