!> Semismooth Newton iteration on the fractures: when it has converged, and what is accepted. The
!! equations are those of coarse_equations.
module coarse_newton
   use base_kinds, only: ik, rk
   use base_lapack, only: dgecon, dgetrf, dgetrs
   use coarse_condensed, only: condensed_t
   use coarse_equations, only: equations_t, evaluate, newton_settings_t, per_cell, prepare
   use coarse_state, only: fracture_cells_t, state_t, step_report_t
   use contact_law, only: contact_residual
   implicit none(type, external)
   private

   public :: solve_fractures

   real(rk), parameter :: contact_residual_max = 1.0e-8_rk  !< of an accepted step, relative

contains

   !> One time step of the fractures, the rock condensed. `state` holds the state before and is
   !! replaced only if the iteration converges.
   subroutine solve_fractures(condensed, cells, connections, settings, dt, g, state, q, report)
      type(condensed_t), intent(in) :: condensed
      type(fracture_cells_t), intent(in) :: cells
      integer(ik), intent(in) :: connections(:, :)  !< (2, m) fracture cells that exchange fluid
      type(newton_settings_t), intent(in) :: settings
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: g(:)  !< (6 n) load on the condensed system
      type(state_t), intent(inout) :: state
      real(rk), intent(out) :: q(:)  !< (6 n) unknowns of the condensed system
      type(step_report_t), intent(out) :: report

      type(equations_t) :: eq
      real(rk), allocatable :: x(:), step(:), traction(:, :, :)
      real(rk) :: load, worst
      integer(ik), allocatable :: contact(:, :), before(:, :), way(:, :)
      integer(ik) :: i, n, n_all

      n = condensed%n
      n_all = per_cell*n + size(connections, 2)
      call prepare(condensed, settings, dt, n_all, eq)
      allocate (x(n_all), source=0.0_rk)
      allocate (step(n_all), traction(2, 2, n), contact(2, n))
      allocate (way(2, n), source=0_ik)
      before = state%contact
      do i = 1, n
         x(7*i - 6:7*i - 5) = state%jump(:, 1, i)*eq%stiffness
         x(7*i - 3:7*i - 2) = state%jump(:, 2, i)*eq%stiffness
         x([7*i - 4, 7*i - 1, 7*i]) = state%pressure(i)
      end do

      load = stress_without_jumps(condensed, g)

      do
         call evaluate(condensed, cells, connections, settings, g, state, x, eq, q, traction, way, &
                       contact)
         report%stress_scale = max(maxval(abs(traction)), maxval(abs(x(7:per_cell*n:7))), load, &
                                   1.0_rk)
         worst = maxval(abs(eq%residual))/report%stress_scale
         if (.not. worst <= huge(1.0_rk)) then
            report%reason = "the Newton iteration on the fractures met a value that is not a number"
            return
         end if
         report%converged = all(contact == before)
         if (report%converged .and. worst > settings%tolerance) report%converged = &
            is_rounding(eq, x, settings%tolerance*report%stress_scale)
         if (report%converged .or. report%iterations >= settings%iterations_max) exit
         before = contact
         call newton_step(eq, step, report)
         if (allocated(report%reason)) return
         x = x + step
         report%iterations = report%iterations + 1
      end do
      if (.not. report%converged) then
         report%reason = "the Newton iteration on the fractures did not converge"
         return
      end if
      call accept(condensed, cells, dt, eq, x, q, traction, contact, state, report)
   end subroutine solve_fractures

   !> Solve for the step; equations are scaled to a largest coefficient of one. The report keeps the
   !! condition number (1-norm of the transposed matrix, estimated), and the bound that it gives for
   !! the relative error of the solution.
   subroutine newton_step(eq, step, report)
      type(equations_t), intent(inout) :: eq
      real(rk), intent(out) :: step(:)
      type(step_report_t), intent(inout) :: report

      real(rk) :: inverse_condition, norm, rhs(size(step), 1), scale, work(4*size(step))
      integer(ik) :: info, iwork(size(step)), n, pivots(size(step)), row

      n = size(step, kind=ik)
      norm = 0.0_rk
      do row = 1, n
         scale = maxval(abs(eq%jacobian(:, row)))
         if (scale > 0.0_rk) then
            eq%jacobian(:, row) = eq%jacobian(:, row)/scale
            eq%residual(row) = eq%residual(row)/scale
         end if
         norm = max(norm, sum(abs(eq%jacobian(:, row))))
      end do
      rhs(:, 1) = -eq%residual
      call dgetrf(n, n, eq%jacobian, n, pivots, info)
      if (info /= 0) then
         report%reason = "the Newton matrix on the fractures is singular"
         return
      end if
      call dgetrs("T", n, 1_ik, eq%jacobian, n, pivots, rhs, n, info)
      call dgecon("1", n, eq%jacobian, n, norm, inverse_condition, work, iwork, info)
      step = rhs(:, 1)
      report%condition = 1.0_rk/max(inverse_condition, tiny(1.0_rk))
      report%error_bound = min(1.0_rk, report%condition*epsilon(1.0_rk))
   end subroutine newton_step

   !> Whether every residual is either below the tolerance or no more than the rounding errors of
   !! the terms it is the sum of: where rock conducts well, those of the fluid balance are larger
   !! than any fixed tolerance.
   pure function is_rounding(eq, x, tolerance) result(is_small)
      type(equations_t), intent(in) :: eq
      real(rk), intent(in) :: x(:)
      real(rk), intent(in) :: tolerance  !< [Pa]
      logical :: is_small

      integer(ik) :: row

      is_small = .true.
      do row = 1, size(x)
         if (abs(eq%residual(row)) <= tolerance) cycle
         is_small = abs(eq%residual(row)) <= 8.0_rk*epsilon(1.0_rk) &
                    *dot_product(abs(eq%jacobian(:, row)), abs(x))
         if (.not. is_small) return
      end do
   end function is_rounding

   !> The largest traction on the fractures if they had neither jumps nor fluid [Pa]: open faces
   !! without fluid carry none, and yet rounding errors are relative to what has been released
   !! there.
   pure function stress_without_jumps(condensed, g) result(stress)
      type(condensed_t), intent(in) :: condensed
      real(rk), intent(in) :: g(:)  !< (6 n)
      real(rk) :: stress

      integer(ik) :: i

      stress = 0.0_rk
      do i = 1, condensed%n
         stress = max(stress, maxval(abs(g(6*i - [5, 4, 2, 1])))/(0.5_rk*condensed%length(i)))
      end do
   end function stress_without_jumps

   !> Check the solution against the law itself and make it the state.
   subroutine accept(condensed, cells, dt, eq, x, q, traction, contact, state, report)
      type(condensed_t), intent(in) :: condensed
      type(fracture_cells_t), intent(in) :: cells
      real(rk), intent(in) :: dt
      type(equations_t), intent(in) :: eq
      real(rk), intent(in) :: x(:), q(:), traction(:, :, :)
      integer(ik), intent(in) :: contact(:, :)
      type(state_t), intent(inout) :: state
      type(step_report_t), intent(inout) :: report

      real(rk) :: aperture(condensed%n)
      integer(ik) :: at, end, i, n

      n = condensed%n
      aperture = cells%residual_aperture + 0.5_rk*(q(1:6*n:6) + q(4:6*n:6))
      if (.not. all(aperture > 0.0_rk)) then
         report%converged = .false.
         report%reason = "a fracture cell has an aperture that is not positive"
         return
      end if
      do i = 1, n
         do end = 1, 2
            at = 6*i - 5 + 3*(end - 1)
            report%contact_residual = max(report%contact_residual, contact_residual(cells%law(i), &
                           eq%stiffness, traction(:, end, i), q(at:at + 1), state%jump(2, end, i)) &
                                          /report%stress_scale)
         end do
      end do
      if (.not. report%contact_residual <= contact_residual_max) then
         report%converged = .false.
         report%reason = "the law of contact is not fulfilled on some fracture cell"
         return
      end if
      do i = 1, n
         state%jump(:, 1, i) = q(6*i - 5:6*i - 4)
         state%jump(:, 2, i) = q(6*i - 2:6*i - 1)
         state%leakoff(i) = -(eq%force(6*i - 3) + eq%force(6*i))/(dt*condensed%length(i))
      end do
      state%traction = traction
      state%pressure = x(7:per_cell*n:7)
      state%aperture = aperture
      state%contact = contact
   end subroutine accept

end module coarse_newton
