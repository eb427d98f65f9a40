!> The linear step of contact systems whose derivatives are a full matrix, as they are for a body
!! that is condensed onto its fractures: by Gauss elimination.
module contact_dense
   use algebra_lapack, only: dgecon, dgetrf, dgetrs
   use base_kinds, only: ik, rk
   use contact_newton, only: step_quality_t
   implicit none(type, external)
   private

   public :: solve_full

contains

   !> Solve for the step; equations are scaled to a largest coefficient of one. The condition is
   !! that of the scaled matrix in the 1-norm of its transpose. Matrix and residual are used up.
   subroutine solve_full(jacobian, residual, with_condition, step, quality)
      real(rk), intent(inout), contiguous :: jacobian(:, :)  !< (n, n) an equation per column [-]
      real(rk), intent(inout) :: residual(:)  !< (n) [Pa]
      logical, intent(in) :: with_condition
      real(rk), intent(out) :: step(:)  !< (n) [Pa]
      type(step_quality_t), intent(out) :: quality
      real(rk) :: inverse_condition, norm, rhs(size(step), 1), scale
      real(rk), allocatable :: work(:)
      integer(ik) :: info, n, pivots(size(step)), row
      integer(ik), allocatable :: iwork(:)

      n = size(step, kind=ik)
      if (n == 0) return
      norm = 0.0_rk
      do row = 1, n
         scale = maxval(abs(jacobian(:, row)))
         if (scale > 0.0_rk) then
            jacobian(:, row) = jacobian(:, row)/scale
            residual(row) = residual(row)/scale
         end if
         if (with_condition) norm = max(norm, sum(abs(jacobian(:, row))))
      end do
      rhs(:, 1) = -residual
      call dgetrf(n, n, jacobian, n, pivots, info)
      quality%is_singular = info /= 0
      if (quality%is_singular) return
      call dgetrs("T", n, 1_ik, jacobian, n, pivots, rhs, n, info)
      step = rhs(:, 1)
      if (.not. with_condition) return
      allocate (work(4*n), iwork(n))
      call dgecon("1", n, jacobian, n, norm, inverse_condition, work, iwork, info)
      quality%condition = 1.0_rk/max(inverse_condition, tiny(1.0_rk))
   end subroutine solve_full

end module contact_dense
