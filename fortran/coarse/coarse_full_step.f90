!> The linear step of the fractures' equations where the body is condensed onto them as a full
!! matrix.
module coarse_full_step
   use base_kinds, only: ik, rk
   use coarse_slopes, only: slopes_t
   use contact_dense, only: solve_full
   use contact_newton, only: step_quality_t
   implicit none(type, external)
   private

   public :: find_full_step, full_slopes

contains

   !> Solve for the step. The residual is used up.
   subroutine find_full_step(stiffness, slopes, x_of_q, q_per_x, residual, with_condition, step, &
                             quality)
      real(rk), intent(in) :: stiffness(:, :)  !< S of coarse_condensed, symmetric [Pa]
      type(slopes_t), intent(in) :: slopes
      integer(ik), intent(in) :: x_of_q(:)  !< the number of each unknown of q in x
      real(rk), intent(in) :: q_per_x(:)  !< their units [m/Pa], [-]
      real(rk), intent(inout) :: residual(:)  !< (n) [Pa]
      logical, intent(in) :: with_condition
      real(rk), intent(out) :: step(:)  !< (n) [Pa]
      type(step_quality_t), intent(out) :: quality
      real(rk), allocatable :: jacobian(:, :)

      call full_slopes(stiffness, slopes, x_of_q, q_per_x, jacobian)
      call solve_full(jacobian, residual, with_condition, step, quality)
   end subroutine find_full_step

   !> All derivatives as a full matrix.
   pure subroutine full_slopes(stiffness, slopes, x_of_q, q_per_x, jacobian)
      real(rk), intent(in) :: stiffness(:, :)  !< S of coarse_condensed, symmetric [Pa]
      type(slopes_t), intent(in) :: slopes
      integer(ik), intent(in) :: x_of_q(:)  !< the number of each unknown of q in x
      real(rk), intent(in) :: q_per_x(:)  !< their units [m/Pa], [-]
      real(rk), allocatable, intent(out) :: jacobian(:, :)  !< (n, n) an equation per column [-]
      integer(ik) :: k, m, row

      allocate (jacobian(slopes%n, slopes%n), source=0.0_rk)
      do row = 1, slopes%n
         do m = 1, size(slopes%force, 1)
            if (slopes%force(m, row) == 0 .or. .not. abs(slopes%weight(m, row)) > 0.0_rk) cycle
            jacobian(x_of_q, row) = jacobian(x_of_q, row) + slopes%weight(m, row)*q_per_x &
                                    *stiffness(:, slopes%force(m, row))
         end do
      end do
      do k = 1, slopes%n_local
         associate (entry => jacobian(slopes%col(k), slopes%row(k)))
            entry = entry + slopes%value(k)
         end associate
      end do
   end subroutine full_slopes

end module coarse_full_step
