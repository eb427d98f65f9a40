!> The linear step of contact systems whose derivatives are a full matrix, as for a body condensed
!! onto its fractures: by Gaussian elimination, or by Cholesky elimination if most equations are
!! those of an elastic body, which takes half as long.
module contact_dense
   use algebra_blocks, only: factorize_lu
   use algebra_lapack, only: dgetrs, dpotrf, dpotrs, estimate_norm
   use base_kinds, only: ik, rk
   use contact_newton, only: step_quality_t
   implicit none(type, external)
   private

   public :: factorize_full, solve_by_parts, solve_factorized, solve_full

contains

   !> Solve for the step. Matrix and residual are used up.
   subroutine solve_full(jacobian, residual, with_condition, step, quality, left_out)
      real(rk), intent(inout), contiguous :: jacobian(:, :)  !< (n, n) an equation per column [-]
      real(rk), intent(inout) :: residual(:)  !< (n) [Pa]
      logical, intent(in) :: with_condition
      real(rk), intent(out) :: step(:)  !< (n) [Pa]
      type(step_quality_t), intent(out) :: quality
      logical, intent(in), optional :: left_out(:)  !< (n) unknowns
      real(rk) :: scale(size(step))
      integer(ik) :: pivots(size(step))

      call factorize_full(jacobian, with_condition, scale, pivots, quality, left_out)
      if (.not. quality%is_singular) call solve_factorized(jacobian, scale, pivots, residual, step)
   end subroutine solve_full

   !> Solve for the step, where some equations times a factor are those of a symmetric positive
   !! definite matrix: these first, then what they leave of the others. Where that matrix is not
   !! definite after all, nothing is solved.
   subroutine solve_by_parts(jacobian, residual, factor, step, quality, is_solved)
      real(rk), intent(in) :: jacobian(:, :)  !< (n, n) an equation per column [-]
      real(rk), intent(in) :: residual(:)  !< (n) [Pa]
      real(rk), intent(in) :: factor(:)  !< (n) of each equation; 0: it is not one of these
      real(rk), intent(out) :: step(:)  !< (n) [Pa]
      type(step_quality_t), intent(out) :: quality
      logical, intent(out) :: is_solved
      real(rk), allocatable :: matrix(:, :), others(:, :), rest(:), x(:, :)
      integer(ik), allocatable :: a(:), b(:)
      integer(ik) :: i, info, k, m, n_others

      a = pack([(i, i=1, size(factor, kind=ik))], abs(factor) > 0.0_rk)
      b = pack([(i, i=1, size(factor, kind=ik))],.not. abs(factor) > 0.0_rk)
      m = size(a, kind=ik)
      n_others = size(b, kind=ik)
      allocate (matrix(m, m), x(m, n_others + 1), others(n_others, n_others), rest(n_others))
      do i = 1, m
         matrix(i:, i) = factor(a(i))*jacobian(a(i:), a(i))
         x(i, :n_others) = factor(a(i))*jacobian(b, a(i))
         x(i, n_others + 1) = -factor(a(i))*residual(a(i))
      end do
      call dpotrf("L", m, matrix, m, info)
      is_solved = info == 0
      if (.not. is_solved) return
      call dpotrs("L", m, n_others + 1_ik, matrix, m, x, m, info)
      do k = 1, n_others
         rest(k) = residual(b(k)) + dot_product(jacobian(a, b(k)), x(:, n_others + 1))
         others(:, k) = jacobian(b, b(k)) - matmul(jacobian(a, b(k)), x(:, :n_others))
      end do
      call solve_full(others, rest, .false., step(:n_others), quality)
      if (quality%is_singular) return
      rest = step(:n_others)
      step(a) = x(:, n_others + 1) - matmul(x(:, :n_others), rest)
      step(b) = rest
   end subroutine solve_by_parts

   !> Factorize; equations are scaled to a largest coefficient of one. The condition is that of the
   !! scaled matrix in the 1-norm of its transpose: what a relative error of an equation makes of
   !! the unknowns. Some of these may be left out of it, as flows are: those that go round in a loop
   !! of open fractures are driven by less than the rounding of pressures, know little of
   !! themselves, and change nothing else.
   subroutine factorize_full(jacobian, with_condition, scale, pivots, quality, left_out)
      !> (n, n) an equation per column [-]; its factors afterwards
      real(rk), intent(inout), contiguous :: jacobian(:, :)
      logical, intent(in) :: with_condition
      real(rk), intent(out) :: scale(:)  !< (n) of the equations [-]
      integer(ik), intent(out) :: pivots(:)  !< (n)
      type(step_quality_t), intent(out) :: quality
      logical, intent(in), optional :: left_out(:)  !< (n) unknowns
      real(rk) :: norm
      integer(ik) :: info, n, row

      n = size(scale, kind=ik)
      if (n == 0) return
      norm = 0.0_rk
      do row = 1, n
         scale(row) = maxval(abs(jacobian(:, row)))
         if (scale(row) > 0.0_rk) then
            jacobian(:, row) = jacobian(:, row)/scale(row)
         else
            scale(row) = 1.0_rk
         end if
         if (with_condition) norm = max(norm, sum(abs(jacobian(:, row))))
      end do
      call factorize_lu(n, jacobian, pivots, info)
      quality%is_singular = info /= 0
      if (quality%is_singular) return
      if (with_condition) quality%condition = norm*norm_of_inverse(jacobian, pivots, left_out)
   end subroutine factorize_full

   !> The step from factors of factorize_full.
   subroutine solve_factorized(factors, scale, pivots, residual, step)
      real(rk), intent(in), contiguous :: factors(:, :)  !< (n, n)
      real(rk), intent(in) :: scale(:)  !< (n)
      integer(ik), intent(in) :: pivots(:)  !< (n)
      real(rk), intent(in) :: residual(:)  !< (n) [Pa]
      real(rk), intent(out) :: step(:)  !< (n) [Pa]
      real(rk) :: rhs(size(step), 1)
      integer(ik) :: info, n

      n = size(step, kind=ik)
      if (n == 0) return
      rhs(:, 1) = -residual/scale
      call dgetrs("T", n, 1_ik, factors, n, pivots, rhs, n, info)
      step = rhs(:, 1)
   end subroutine solve_factorized

   !> The 1-norm of the inverse of a matrix, estimated from its factors (Higham 1988); columns of
   !! the inverse may be left out.
   function norm_of_inverse(factors, pivots, left_out) result(norm)
      real(rk), intent(in), contiguous :: factors(:, :)  !< (n, n) of dgetrf
      integer(ik), intent(in) :: pivots(:)  !< (n) of dgetrf
      logical, intent(in), optional :: left_out(:)  !< (n)
      real(rk) :: norm
      real(rk), dimension(size(pivots)) :: v, x
      real(rk) :: rhs(size(pivots), 1)
      integer(ik) :: info, kase, n, save(3), signs(size(pivots))

      n = size(pivots, kind=ik)
      norm = 0.0_rk
      kase = 0
      do
         call estimate_norm(n, v, x, signs, norm, kase, save)
         if (kase == 0) exit
         if (kase == 1 .and. present(left_out)) where (left_out) x = 0.0_rk
         rhs(:, 1) = x
         call dgetrs(merge("N", "T", kase == 1), n, 1_ik, factors, n, pivots, rhs, n, info)
         x = rhs(:, 1)
         if (kase == 2 .and. present(left_out)) where (left_out) x = 0.0_rk
      end do
   end function norm_of_inverse

end module contact_dense
