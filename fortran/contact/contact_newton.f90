!> Semismooth Newton iteration on equations that hold the law of contact: one iteration for bodies
!! condensed onto their fractures on both levels.
!!
!! A system knows its residuals, their derivatives and the contact state of each point; all
!! unknowns and residuals are scaled to stresses. The iteration has converged when the residuals
!! are small and no point has changed its state.
!!
!! Such an iteration may cycle between states (the primal-dual active set is monotone for
!! M-matrices only, and the condensed stiffness of a body is none; Hintermueller, Ito and Kunisch
!! 2003). A cycle, a singular matrix or too many iterations make it ask the system for another
!! start, once; a system may know a slower way that always leads to a solution (contact_pairs). If
!! that is one of many, as for a piece that floats, the system counts as singular.
module contact_newton
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_value
   use algebra_lapack, only: dgecon, dgetrf, dgetrs
   implicit none(type, external)
   private

   public :: contact_system_t, iterate, iteration_report_t, iteration_settings_t
   public :: outcome_converged, outcome_not_a_number, outcome_singular, outcome_stuck

   integer(ik), parameter :: outcome_converged = 0
   integer(ik), parameter :: outcome_stuck = 1  !< cycled, or took too many iterations
   integer(ik), parameter :: outcome_singular = 2  !< a matrix was singular
   integer(ik), parameter :: outcome_not_a_number = 3  !< a residual was not a number

   !> Equations for the iteration.
   type, abstract :: contact_system_t
      real(rk), allocatable :: residual(:)  !< (n) [Pa]
      real(rk), allocatable :: jacobian(:, :)  !< (n, n) an equation per column [-]
      real(rk) :: stress_scale = 0.0_rk  !< residuals are relative to it [Pa]
      ! Points where the law of contact holds.
      integer(ik), allocatable :: way(:)  !< of slip in the last iteration: -1, 0, 1
      integer(ik), allocatable :: state(:)  !< of contact_states
   contains
      procedure(evaluate_system), deferred :: evaluate
      procedure :: obeys_law
      procedure :: restart
      procedure :: end_restart
   end type contact_system_t

   type :: iteration_settings_t
      real(rk) :: tolerance = 1.0e-10_rk  !< of residuals, relative to the stress scale [-]
      integer(ik) :: iterations_max = 30  !< before another start is tried, and after it
      logical :: with_condition = .false.  !< estimate the condition of the matrices
      !> Residuals as large as the rounding of their terms are small too. Only where no part can
      !! move freely: one that flies off has terms of any size.
      logical :: allows_rounding = .false.
   end type iteration_settings_t

   type :: iteration_report_t
      integer(ik) :: outcome = outcome_stuck
      integer(ik) :: iterations = 0
      logical :: was_restarted = .false.
      !> Condition number of the last matrix, scaled (1-norm of its transpose, estimated), and the
      !! bound that it gives for the relative error of the solution [-]
      real(rk) :: condition = 0.0_rk, error_bound = 0.0_rk
   end type iteration_report_t

   abstract interface
      !> Residuals, derivatives, states and stress scale at x.
      subroutine evaluate_system(self, x)
         import :: contact_system_t, rk
         implicit none(type, external)
         class(contact_system_t), intent(inout) :: self
         real(rk), intent(in) :: x(:)  !< [Pa]
      end subroutine evaluate_system
   end interface

contains

   !> Whether x fulfils the law within a tolerance though states go on changing, as they do where a
   !! point lies between two. A system that cannot tell says no.
   logical function obeys_law(self, x, tolerance)
      class(contact_system_t), intent(in) :: self
      real(rk), intent(in) :: x(:)  !< where the system was last evaluated [Pa]
      real(rk), intent(in) :: tolerance  !< relative to the stress scale [-]

      obeys_law = size(x) == 0 .and. size(self%state) == 0 .and. tolerance > 0.0_rk
   end function obeys_law

   !> Another start, from which the iteration converges. A system that has none leaves x.
   subroutine restart(self, x, has_start)
      class(contact_system_t), intent(inout) :: self
      real(rk), intent(inout) :: x(:)  !< [Pa]
      logical, intent(out) :: has_start

      has_start = size(x) == 0 .and. size(self%state) == 0
   end subroutine restart

   !> Take back what `restart` may have changed in the derivatives. Here that is nothing.
   subroutine end_restart(self)
      class(contact_system_t), intent(inout) :: self

      self%stress_scale = max(self%stress_scale, 0.0_rk)
   end subroutine end_restart

   !> Solve the system, from the x and the states that it has at the start.
   subroutine iterate(system, x, settings, report)
      class(contact_system_t), intent(inout) :: system
      real(rk), intent(inout) :: x(:)  !< [Pa]
      type(iteration_settings_t), intent(in) :: settings
      type(iteration_report_t), intent(out) :: report
      integer(ik) :: first_outcome
      logical :: has_start

      call iterate_from(system, x, settings, report)
      first_outcome = report%outcome
      if (first_outcome /= outcome_stuck .and. first_outcome /= outcome_singular) return
      call system%restart(x, has_start)
      if (.not. has_start) return
      report%was_restarted = .true.
      call iterate_from(system, x, settings, report)
      if (report%outcome == outcome_converged) then
         if (is_loose(system, x)) report%outcome = outcome_singular
      else
         report%outcome = first_outcome
      end if
   end subroutine iterate

   !> Whether the solution found from another start is one of many: a part that only contact could
   !! hold is free to move.
   logical function is_loose(system, x)
      class(contact_system_t), intent(inout) :: system
      real(rk), intent(in) :: x(:)
      real(rk), parameter :: largest_condition = 1.0e12_rk
      type(iteration_report_t) :: report
      real(rk) :: step(size(x))

      call system%end_restart()
      call system%evaluate(x)
      call newton_step(system, step, .true., report)
      is_loose = report%outcome == outcome_singular
      if (.not. is_loose) is_loose = .not. report%condition <= largest_condition
   end function is_loose

   !> Iterate until convergence or failure. A start that is good enough is not accepted as it is: a
   !! state would not follow a load that changes by less than the tolerance, and the search for an
   !! onset of growth would not end.
   subroutine iterate_from(system, x, settings, report)
      class(contact_system_t), intent(inout) :: system
      real(rk), intent(inout) :: x(:)
      type(iteration_settings_t), intent(in) :: settings
      type(iteration_report_t), intent(inout) :: report
      integer(ik) :: before(size(system%state))
      integer(ik) :: seen(2*size(system%state), 0:settings%iterations_max)
      real(rk) :: seen_worst(0:settings%iterations_max), step(size(x)), worst
      integer(ik) :: k
      logical :: is_small, was_small

      before = system%state
      was_small = .false.
      do k = 0, settings%iterations_max
         call system%evaluate(x)
         worst = maxval(abs(system%residual))
         if (.not. worst <= huge(1.0_rk)) then
            report%outcome = outcome_not_a_number
            return
         end if
         report%outcome = outcome_stuck
         is_small = worst <= settings%tolerance*system%stress_scale
         if (all(system%state == before)) then
            if (.not. is_small .and. settings%allows_rounding) then
               is_small = is_rounding(system, x, settings%tolerance)
            end if
            if (is_small) report%outcome = outcome_converged
         else if (is_small .and. was_small) then
            if (system%obeys_law(x, settings%tolerance)) report%outcome = outcome_converged
         end if
         if (report%outcome == outcome_converged .or. k == settings%iterations_max) return
         was_small = is_small
         if (has_been(system, worst, seen(:, :k - 1), seen_worst(:k - 1))) return
         seen(:, k) = [system%state, system%way]
         seen_worst(k) = worst
         before = system%state
         call newton_step(system, step, settings%with_condition, report)
         if (report%outcome == outcome_singular) return
         x = x + step
         report%iterations = report%iterations + 1
      end do
   end subroutine iterate_from

   !> Whether the iteration has been here before: the same states and ways of slip, and the same
   !! residual.
   pure logical function has_been(system, worst, seen, seen_worst)
      class(contact_system_t), intent(in) :: system
      real(rk), intent(in) :: worst
      integer(ik), intent(in) :: seen(:, :)
      real(rk), intent(in) :: seen_worst(:)
      integer(ik) :: k, n

      n = size(system%state)
      has_been = .true.
      do k = 1, size(seen_worst)
         if (abs(worst - seen_worst(k)) > same_value*worst) cycle
         if (all(seen(:n, k) == system%state) .and. all(seen(n + 1:, k) == system%way)) return
      end do
      has_been = .false.
   end function has_been

   !> Solve for the step; equations are scaled to a largest coefficient of one.
   subroutine newton_step(system, step, with_condition, report)
      class(contact_system_t), intent(inout) :: system
      real(rk), intent(out) :: step(:)
      logical, intent(in) :: with_condition
      type(iteration_report_t), intent(inout) :: report
      real(rk) :: inverse_condition, norm, rhs(size(step), 1), scale
      real(rk), allocatable :: work(:)
      integer(ik) :: info, n, pivots(size(step)), row
      integer(ik), allocatable :: iwork(:)

      n = size(step, kind=ik)
      norm = 0.0_rk
      do row = 1, n
         scale = maxval(abs(system%jacobian(:, row)))
         if (scale > 0.0_rk) then
            system%jacobian(:, row) = system%jacobian(:, row)/scale
            system%residual(row) = system%residual(row)/scale
         end if
         if (with_condition) norm = max(norm, sum(abs(system%jacobian(:, row))))
      end do
      rhs(:, 1) = -system%residual
      call dgetrf(n, n, system%jacobian, n, pivots, info)
      if (info /= 0) then
         report%outcome = outcome_singular
         return
      end if
      call dgetrs("T", n, 1_ik, system%jacobian, n, pivots, rhs, n, info)
      step = rhs(:, 1)
      if (.not. with_condition) return
      allocate (work(4*n), iwork(n))
      call dgecon("1", n, system%jacobian, n, norm, inverse_condition, work, iwork, info)
      report%condition = 1.0_rk/max(inverse_condition, tiny(1.0_rk))
      report%error_bound = min(1.0_rk, report%condition*epsilon(1.0_rk))
   end subroutine newton_step

   !> Whether every residual is either below the tolerance or no more than the rounding errors of
   !! the terms it is the sum of: where rock conducts well, those of the fluid balance are larger
   !! than any fixed tolerance.
   pure function is_rounding(system, x, tolerance) result(is_small)
      class(contact_system_t), intent(in) :: system
      real(rk), intent(in) :: x(:)
      real(rk), intent(in) :: tolerance  !< relative to the stress scale [-]
      logical :: is_small
      integer(ik) :: row

      is_small = .true.
      do row = 1, size(x)
         if (abs(system%residual(row)) <= tolerance*system%stress_scale) cycle
         is_small = abs(system%residual(row)) <= 8.0_rk*epsilon(1.0_rk) &
                    *dot_product(abs(system%jacobian(:, row)), abs(x))
         if (.not. is_small) return
      end do
   end function is_rounding

end module contact_newton
