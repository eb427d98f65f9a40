!> A small system with equations of very different sizes.
module two_equations
   use base_kinds, only: rk
   use contact_dense, only: dense_system_t
   implicit none(type, external)
   private

   public :: two_equations_t

   !> x_1 + 3 x_2 = -4 and 1e12 (x_2 - x_1) = 4e12, or the second without x_1 and x_2.
   type, extends(dense_system_t) :: two_equations_t
      logical :: is_singular = .false.
   contains
      procedure :: evaluate
   end type two_equations_t

contains

   subroutine evaluate(self, x)
      class(two_equations_t), intent(inout) :: self
      real(rk), intent(in) :: x(:)  !< [Pa]
      real(rk), parameter :: large = 1.0e12_rk

      self%jacobian = reshape([1.0_rk, 3.0_rk, -large, large], [2, 2])  ! an equation per column
      self%residual = [x(1) + 3.0_rk*x(2) + 4.0_rk, large*(x(2) - x(1) - 4.0_rk)]
      if (.not. self%is_singular) return
      self%jacobian(:, 2) = 0.0_rk
      self%residual(2) = 1.0_rk
   end subroutine evaluate

end module two_equations

!> The linear step of a system with a full matrix: equations of very different sizes, the condition
!! of a matrix that is known, one that is singular; the sizes of terms.
program test_contact_dense
   use testing_checks, only: checks_t
   use base_kinds, only: rk
   use contact_newton, only: step_quality_t
   use two_equations, only: two_equations_t
   implicit none(type, external)

   type(checks_t) :: checks

   call finds_step()
   call notices_singular_matrix()
   call adds_sizes_of_terms()
   call checks%finish()

contains

   !> From (1, 1) to the solution (-4, 0). Scaled, the matrix is (1/3 1; -1 1) and its inverse
   !! (3 -3; 3 1)/4: the largest row sums 2 and 3/2 give the condition 3.
   subroutine finds_step()
      type(two_equations_t) :: system
      type(step_quality_t) :: quality
      real(rk) :: step(2)

      call system%evaluate([1.0_rk, 1.0_rk])
      call system%find_step(.false., step, quality)
      call checks%is_true(.not. quality%is_singular, "regular")
      call checks%is_close(step(1), -5.0_rk, 1.0e-14_rk, "first component of the step")
      call checks%is_close(step(2), -1.0_rk, 1.0e-14_rk, "second component of the step")
      call checks%is_close(quality%condition, 0.0_rk, 0.0_rk, "no condition unless asked for")
      call system%evaluate([1.0_rk, 1.0_rk])
      call system%find_step(.true., step, quality)
      call checks%is_close(step(1), -5.0_rk, 1.0e-14_rk, "the same step with the condition")
      call checks%is_close(quality%condition, 3.0_rk, 1.0e-14_rk, "condition of two equations")
   end subroutine finds_step

   subroutine notices_singular_matrix()
      type(two_equations_t) :: system
      type(step_quality_t) :: quality
      real(rk) :: step(2)

      system%is_singular = .true.
      call system%evaluate([1.0_rk, 1.0_rk])
      call system%find_step(.true., step, quality)
      call checks%is_true(quality%is_singular, "an equation without unknowns")
   end subroutine notices_singular_matrix

   subroutine adds_sizes_of_terms()
      type(two_equations_t) :: system
      real(rk), parameter :: x(2) = [2.0_rk, -5.0_rk]

      call system%evaluate(x)
      call checks%is_close(system%size_of_terms(x, 1), 17.0_rk, 0.0_rk, "2 + 15")
      call checks%is_close(system%size_of_terms(x, 2), 7.0e12_rk, 0.0_rk, "1e12 (2 + 5)")
   end subroutine adds_sizes_of_terms

end program test_contact_dense
