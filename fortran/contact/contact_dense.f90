!> Contact systems whose derivatives are a full matrix, as they are for a body that is condensed
!! onto its fractures: the linear step by Gauss elimination.
module contact_dense
   use algebra_lapack, only: dgecon, dgetrf, dgetrs
   use base_kinds, only: ik, rk
   use contact_newton, only: contact_system_t, step_quality_t
   implicit none(type, external)
   private

   public :: dense_system_t

   !> `evaluate` fills the matrix along with the residuals.
   type, abstract, extends(contact_system_t) :: dense_system_t
      real(rk), allocatable :: jacobian(:, :)  !< (n, n) an equation per column [-]
   contains
      procedure :: find_step
      procedure :: size_of_terms
   end type dense_system_t

contains

   !> Solve for the step; equations are scaled to a largest coefficient of one. The condition is
   !! that of the scaled matrix in the 1-norm of its transpose.
   subroutine find_step(self, with_condition, step, quality)
      class(dense_system_t), intent(inout) :: self
      logical, intent(in) :: with_condition
      real(rk), intent(out) :: step(:)  !< (n) [Pa]
      type(step_quality_t), intent(out) :: quality
      real(rk) :: inverse_condition, norm, rhs(size(step), 1), scale
      real(rk), allocatable :: work(:)
      integer(ik) :: info, n, pivots(size(step)), row
      integer(ik), allocatable :: iwork(:)

      n = size(step, kind=ik)
      norm = 0.0_rk
      do row = 1, n
         scale = maxval(abs(self%jacobian(:, row)))
         if (scale > 0.0_rk) then
            self%jacobian(:, row) = self%jacobian(:, row)/scale
            self%residual(row) = self%residual(row)/scale
         end if
         if (with_condition) norm = max(norm, sum(abs(self%jacobian(:, row))))
      end do
      rhs(:, 1) = -self%residual
      call dgetrf(n, n, self%jacobian, n, pivots, info)
      quality%is_singular = info /= 0
      if (quality%is_singular) return
      call dgetrs("T", n, 1_ik, self%jacobian, n, pivots, rhs, n, info)
      step = rhs(:, 1)
      if (.not. with_condition) return
      allocate (work(4*n), iwork(n))
      call dgecon("1", n, self%jacobian, n, norm, inverse_condition, work, iwork, info)
      quality%condition = 1.0_rk/max(inverse_condition, tiny(1.0_rk))
   end subroutine find_step

   !> The sum of the sizes of a residual's terms.
   pure function size_of_terms(self, x, row) result(total)
      class(dense_system_t), intent(in) :: self
      real(rk), intent(in) :: x(:)  !< (n) [Pa]
      integer(ik), intent(in) :: row  !< number of the residual
      real(rk) :: total  !< [Pa]

      total = dot_product(abs(self%jacobian(:, row)), abs(x))
   end function size_of_terms

end module contact_dense
