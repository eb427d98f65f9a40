!> One time step of the fractures: the iteration of contact_newton on the equations of
!! coarse_equations, and what of its outcome is accepted.
module coarse_newton
   use base_kinds, only: ik, rk
   use coarse_condensed, only: condensed_t
   use coarse_equations, only: equations_t, newton_settings_t, per_cell, prepare
   use coarse_state, only: fracture_cells_t, state_t, step_report_t
   use contact_law, only: contact_residual
   use contact_newton, only: iterate, iteration_report_t, iteration_settings_t, &
                             outcome_converged, outcome_not_a_number, outcome_singular
   implicit none(type, external)
   private

   public :: solve_fractures

   real(rk), parameter :: contact_residual_max = 1.0e-8_rk  !< of an accepted step, relative

contains

   !> One time step of the fractures, the rock condensed. `state` holds the state before and is
   !! replaced only if the iteration converges.
   subroutine solve_fractures(condensed, cells, connections, settings, dt, g, state, q, report)
      type(condensed_t), intent(in), target :: condensed
      type(fracture_cells_t), intent(in), target :: cells
      integer(ik), intent(in), target :: connections(:, :)  !< (2, m) cells that exchange fluid
      type(newton_settings_t), intent(in) :: settings
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in), target :: g(:)  !< (6 n) load on the condensed system
      type(state_t), intent(inout), target :: state
      real(rk), intent(out) :: q(:)  !< (6 n) unknowns of the condensed system
      type(step_report_t), intent(out) :: report

      type(equations_t) :: eq
      type(iteration_report_t) :: found
      real(rk), allocatable :: x(:)
      integer(ik) :: i

      call prepare(condensed, cells, connections, settings, dt, g, state, eq)
      allocate (x(size(eq%residual)), source=0.0_rk)
      do i = 1, condensed%n
         x(7*i - 6:7*i - 5) = state%jump(:, 1, i)*eq%stiffness
         x(7*i - 3:7*i - 2) = state%jump(:, 2, i)*eq%stiffness
         x([7*i - 4, 7*i - 1, 7*i]) = state%pressure(i)
      end do
      call iterate(eq, x, iteration_settings_t(tolerance=settings%tolerance, &
                                               iterations_max=settings%iterations_max, &
                                               with_condition=.true., &
                                               allows_rounding=.true.), found)
      q = eq%q
      report%stress_scale = eq%stress_scale
      report%iterations = found%iterations
      report%condition = found%condition
      report%error_bound = found%error_bound
      select case (found%outcome)
      case (outcome_converged)
         report%converged = .true.
      case (outcome_not_a_number)
         report%reason = "the Newton iteration on the fractures met a value that is not a number"
      case (outcome_singular)
         report%reason = "the Newton matrix on the fractures is singular"
      case default
         report%reason = "the Newton iteration on the fractures did not converge"
      end select
      if (report%converged) call accept(condensed, cells, dt, eq, x, state, report)
   end subroutine solve_fractures

   !> Check the solution against the law itself and make it the state.
   subroutine accept(condensed, cells, dt, eq, x, state, report)
      type(condensed_t), intent(in) :: condensed
      type(fracture_cells_t), intent(in) :: cells
      real(rk), intent(in) :: dt
      type(equations_t), intent(in) :: eq
      real(rk), intent(in) :: x(:)
      type(state_t), intent(inout) :: state
      type(step_report_t), intent(inout) :: report

      real(rk) :: aperture(condensed%n), residual
      integer(ik) :: at, end, i, n

      n = condensed%n
      aperture = cells%residual_aperture + 0.5_rk*(eq%q(1:6*n:6) + eq%q(4:6*n:6))
      if (.not. all(aperture > 0.0_rk)) then
         report%converged = .false.
         report%reason = "a fracture cell has an aperture that is not positive"
         return
      end if
      do i = 1, n
         do end = 1, 2
            at = 6*i - 5 + 3*(end - 1)
            residual = contact_residual(cells%law(i), eq%stiffness, eq%traction(:, end, i), &
                                        eq%q(at:at + 1), state%jump(2, end, i))
            report%contact_residual = max(report%contact_residual, residual/report%stress_scale)
         end do
      end do
      if (.not. report%contact_residual <= contact_residual_max) then
         report%converged = .false.
         report%reason = "the law of contact is not fulfilled on some fracture cell"
         return
      end if
      do i = 1, n
         state%jump(:, 1, i) = eq%q(6*i - 5:6*i - 4)
         state%jump(:, 2, i) = eq%q(6*i - 2:6*i - 1)
         state%leakoff(i) = -(eq%force(6*i - 3) + eq%force(6*i))/(dt*condensed%length(i))
      end do
      state%traction = eq%traction
      state%pressure = x(7:per_cell*n:7)
      state%aperture = aperture
      state%contact = reshape(eq%state, shape(state%contact))
   end subroutine accept

end module coarse_newton
