!> Semismooth Newton iteration on equations that contain the contact law: one iteration for bodies
!! condensed onto their fractures on both levels.
!!
!! A system provides its residuals and the contact state of each point, and solves its linearized
!! equations for a step; the storage of the derivatives depends on the system (contact_dense: a full
!! matrix). All unknowns and residuals are scaled to stresses. The iteration has converged when the
!! residuals are small and no point has changed its state.
!!
!! Such an iteration may cycle between states (the primal-dual active set is monotone for M-matrices
!! only, and the condensed stiffness of a body is none; Hintermueller, Ito and Kunisch 2003). After
!! a cycle, a singular matrix or too many iterations the system may provide another initial guess,
!! once; some systems have a slower method that always leads to a solution (contact_pairs). If that
!! is one of many, as for a part that floats, the system counts as singular.
!!
!! Friction that weakens and bonds that break (contact_law) allow several solutions: faces within
!! their strength stick, but after slip they would be too weak to stick. The required solution is
!! the one that a rising load reaches from the last accepted state. So such a system is first solved
!! with its strength before the step; if no face has slipped or opened, that is the solution.
!! Otherwise the strength is reduced permanently by the slip and opening found, repeatedly until it
!! is constant, or until Newton's method converges from there. Where the strength falls faster than
!! the body unloads, that leads to the next stable solution.
!!
!! If the iteration still cycles, its steps are shortened. Where states change the residuals keep
!! their magnitudes (open to closed both are min(-f_n, c ([u]_n - g)), up to the sign), so their
!! norm is a continuous function, and a step is halved until it falls; at last from the initial
!! guess, in large systems first.
module contact_newton
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use base_tolerances, only: same_value
   use contact_law, only: contact_law_t
   implicit none(type, external)
   private

   public :: contact_system_t, iterate, iterate_from, iteration_report_t, iteration_settings_t
   public :: step_quality_t, outcome_converged, outcome_not_a_number, outcome_singular

   integer(ik), parameter :: outcome_converged = 0
   integer(ik), parameter :: outcome_stuck = 1  !< cycled, or took too many iterations
   integer(ik), parameter :: outcome_singular = 2  !< a matrix was singular
   integer(ik), parameter :: outcome_not_a_number = 3  !< a residual was not a number

   !> Quality of a linear step.
   type :: step_quality_t
      logical :: is_singular = .false.  !< there is no step
      !> Condition number of the matrix, its equations scaled (estimated; 0: not asked for) [-]
      real(rk) :: condition = 0.0_rk
      !> Relative residual of the scaled equations after the step; 0 for a direct solution [-]
      real(rk) :: rest = 0.0_rk
   end type step_quality_t

   !> Equations for the iteration.
   type, abstract :: contact_system_t
      real(rk), allocatable :: residual(:)  !< (n) where last evaluated [Pa]
      real(rk) :: stress_scale = 0.0_rk  !< residuals are relative to it [Pa]
      logical :: is_propped = .false.  !< what only contact holds is held, since a restart
      ! Contact points, each with two unknowns, [u]_n and [u]_tau times the stiffness:
      real(rk) :: stiffness = 0.0_rk  !< c of the contact law [Pa/m]
      type(contact_law_t), allocatable :: law(:)  !< (points)
      real(rk), allocatable :: slip_before(:)  !< (points) [u]_tau at the last accepted state [m]
      real(rk), allocatable :: traction(:, :)  !< (2, points) f_n, f_tau where last evaluated [Pa]
      integer(ik), allocatable :: slip_sign(:)  !< (points) of the last iteration: -1, 0, 1
      integer(ik), allocatable :: state(:)  !< (points) of contact_law
      !> (points) at the start of the step, and with the remaining strength
      type(contact_law_t), allocatable, private :: law_before(:), law_held(:)
   contains
      procedure(evaluate_system), deferred :: evaluate
      procedure(find_linear_step), deferred :: find_step
      procedure(sum_terms), deferred :: size_of_terms
      procedure :: is_balanced
      procedure :: obeys_law
      procedure :: restart
      procedure :: end_restart
      procedure :: at_point
   end type contact_system_t

   type :: iteration_settings_t
      real(rk) :: tolerance = 1.0e-10_rk  !< of residuals, relative to the stress scale [-]
      !> Limit before a restart, after it, and for damped steps separately
      integer(ik) :: iterations_max = 30
      logical :: with_condition = .false.  !< estimate the condition of the matrices
      !> Accept residuals of the size of the rounding errors of their terms. Only for bodies without
      !! free parts: a part in rigid motion has terms of any size.
      logical :: allows_rounding = .false.
      !> Try slower methods after a cycle; else the caller has a better initial guess.
      logical :: perseveres = .true.
   end type iteration_settings_t

   type :: iteration_report_t
      integer(ik) :: outcome = outcome_stuck
      integer(ik) :: iterations = 0
      logical :: was_restarted = .false.
      real(rk) :: condition = 0.0_rk  !< of the last matrix, see step_quality_t [-]
      real(rk) :: error_bound = 0.0_rk  !< what it gives for the solution's relative error [-]
   end type iteration_report_t

   !> State of an iteration.
   type :: course_t
      integer(ik), allocatable :: before(:)  !< states one iteration ago
      real(rk) :: worst = 0.0_rk  !< residual now [Pa]
      real(rk) :: left = 0.0_rk  !< what the last step left of its equations [-]
      logical :: was_small = .false.  !< the residual, one iteration ago
      logical :: has_begun = .false.  !< a step has been made
   end type course_t

   abstract interface
      !> Residuals, derivatives, states and stress scale at x.
      subroutine evaluate_system(self, x)
         import :: contact_system_t, rk
         implicit none(type, external)
         class(contact_system_t), intent(inout) :: self
         real(rk), intent(in) :: x(:)  !< (n) [Pa]
      end subroutine evaluate_system

      !> The step that makes the linearized residuals zero, from where the system was last
      !! evaluated. Residuals and derivatives may be used up: the next evaluation makes new ones.
      subroutine find_linear_step(self, with_condition, step, quality)
         import :: contact_system_t, rk, step_quality_t
         implicit none(type, external)
         class(contact_system_t), intent(inout) :: self
         logical, intent(in) :: with_condition  !< estimate the condition of the matrix
         real(rk), intent(out) :: step(:)  !< (n) [Pa]; undefined without one
         type(step_quality_t), intent(out) :: quality
      end subroutine find_linear_step

      !> The sum of the sizes of the terms that a residual consists of, |d residual/d x_j| |x_j|
      !! over all j, where last evaluated.
      pure function sum_terms(self, x, row) result(total)
         import :: contact_system_t, ik, rk
         implicit none(type, external)
         class(contact_system_t), intent(in) :: self
         real(rk), intent(in) :: x(:)  !< (n) [Pa]
         integer(ik), intent(in) :: row  !< number of the residual
         real(rk) :: total  !< [Pa]
      end function sum_terms
   end interface

   !> What a step leaves of its equations may make this error; more asks for another step [-].
   real(rk), parameter :: well_solved = 1.0e-7_rk

   !> Estimates of the condition are too small by a factor of three at most, but for matrices made
   !! to mislead them (Higham 1988) [-].
   real(rk), parameter :: estimate_off_by = 3.0_rk

contains

   !> Whether x fulfils the law within a tolerance although states change in every iteration, as at
   !! the limit between two states. Default: not known, so .false.
   logical function obeys_law(self, x, tolerance)
      class(contact_system_t), intent(in) :: self
      real(rk), intent(in) :: x(:)  !< where the system was last evaluated [Pa]
      real(rk), intent(in) :: tolerance  !< relative to the stress scale [-]

      obeys_law = .false.
   end function obeys_law

   !> Whether balances are satisfied accurately enough at the last evaluation; if not, a solution
   !! within the tolerance is improved by one more step.
   logical function is_balanced(self)
      class(contact_system_t), intent(in) :: self

      is_balanced = .true.
   end function is_balanced

   !> Another initial guess, from which the iteration converges. Default: there is none, x is
   !! unchanged.
   subroutine restart(self, x, has_start)
      class(contact_system_t), intent(inout) :: self
      real(rk), intent(inout) :: x(:)  !< [Pa]
      logical, intent(out) :: has_start

      has_start = .false.
   end subroutine restart

   !> Undo the changes of `restart` to the derivatives. Default: none.
   subroutine end_restart(self)
      class(contact_system_t), intent(inout) :: self
   end subroutine end_restart

   !> The number of the unknown [u]_n of a point; that of [u]_tau follows. Default: point by point.
   pure integer(ik) function at_point(self, point)
      class(contact_system_t), intent(in) :: self
      integer(ik), intent(in) :: point

      at_point = 2*point - 1
   end function at_point

   !> Reduce the constant strength to that at x, where the system was last evaluated.
   subroutine reduce_strength(system, x, tolerance, is_weaker)
      class(contact_system_t), intent(inout) :: system
      real(rk), intent(in) :: x(:)  !< [Pa]
      real(rk), intent(in) :: tolerance  !< relative to the stress scale [-]
      logical, intent(out) :: is_weaker  !< by more than the tolerance
      real(rk) :: jump(2), lost
      integer(ik) :: at, i

      is_weaker = .false.
      do i = 1, size(system%law_held, kind=ik)
         at = system%at_point(i)
         jump = x(at:at + 1)/system%stiffness
         call system%law_before(i)%weaken(system%law_held(i), system%traction(:, i), jump, &
                                          jump(2) - system%slip_before(i), lost)
         is_weaker = is_weaker .or. lost > tolerance*system%stress_scale
      end do
      system%law = system%law_held
   end subroutine reduce_strength

   !> Solve the system, from the x and the states that it has at the start.
   subroutine iterate(system, x, settings, report)
      class(contact_system_t), intent(inout) :: system
      real(rk), intent(inout) :: x(:)  !< [Pa]
      type(iteration_settings_t), intent(in) :: settings
      type(iteration_report_t), intent(out) :: report

      if (any(system%law%ages())) then
         call iterate_worn(system, x, settings, report)
      else
         call iterate_held(system, x, settings, report)
      end if
   end subroutine iterate

   !> Solve a system of constant strength.
   subroutine iterate_held(system, x, settings, report)
      class(contact_system_t), intent(inout) :: system
      real(rk), intent(inout) :: x(:)  !< [Pa]
      type(iteration_settings_t), intent(in) :: settings
      type(iteration_report_t), intent(inout) :: report
      ! Points above which shortened steps cost less than another initial guess by pivoting.
      integer, parameter :: large = 200
      real(rk), dimension(size(x)) :: last, start
      logical :: is_large

      start = x
      call iterate_from(system, x, settings, report)
      if (report%outcome /= outcome_stuck .and. report%outcome /= outcome_singular) return
      if (.not. settings%perseveres) return
      is_large = size(system%state) > large .and. report%outcome == outcome_stuck
      if (is_large) then
         last = x
         x = start
         call iterate_damped(system, x, settings, report)
         if (report%outcome == outcome_converged) return
         x = last
         report%outcome = outcome_stuck
      end if
      call persevere(system, x, settings, report)
      if (report%outcome /= outcome_stuck .or. report%was_restarted .or. is_large) return
      x = start
      call iterate_damped(system, x, settings, report)
   end subroutine iterate_held

   !> Solve a system whose strength falls within the step: repeatedly with constant strength, until
   !! it no longer falls.
   subroutine iterate_worn(system, x, settings, report)
      class(contact_system_t), intent(inout) :: system
      real(rk), intent(inout) :: x(:)  !< [Pa]
      type(iteration_settings_t), intent(in) :: settings
      type(iteration_report_t), intent(inout) :: report
      ! Near the stiffness at which a face is still held, the strength falls slowly.
      integer(ik), parameter :: rounds = 3000, iterations_of_trial = 8
      real(rk), parameter :: kept = 1.0e-8_rk  ! of the law, relative to the stress scale
      type(iteration_settings_t) :: briefly
      type(iteration_report_t) :: found
      real(rk) :: trial(size(x))
      integer(ik) :: k
      logical :: is_weaker

      briefly = settings
      briefly%iterations_max = min(settings%iterations_max, iterations_of_trial)
      ! Constant strength, that at the start of the step.
      system%law_before = system%law
      system%law%wears = .false.
      system%law_held = system%law
      do k = 1, rounds
         call iterate_held(system, x, settings, report)
         if (report%outcome /= outcome_converged) exit
         call reduce_strength(system, x, settings%tolerance, is_weaker)
         if (.not. is_weaker) exit
         system%law = system%law_before
         trial = x
         found%iterations = report%iterations
         call iterate_from(system, trial, briefly, found)
         report%iterations = found%iterations
         if (found%outcome == outcome_converged) then
            x = trial
            report = found
            return
         end if
         report%outcome = outcome_stuck
         call system%evaluate(x)
         call reduce_strength(system, x, settings%tolerance, is_weaker)
      end do
      system%law = system%law_before
      if (report%outcome /= outcome_converged) return
      ! The strength of a point that has moved back may have been reduced too far.
      call system%evaluate(x)
      if (.not. maxval(abs(system%residual)) <= kept*system%stress_scale) then
         report%outcome = outcome_stuck
      end if
   end subroutine iterate_worn

   !> Try the slower methods after a failure of the iteration from the last x.
   subroutine persevere(system, x, settings, report)
      class(contact_system_t), intent(inout) :: system
      real(rk), intent(inout) :: x(:)  !< [Pa]
      type(iteration_settings_t), intent(in) :: settings
      type(iteration_report_t), intent(inout) :: report
      integer(ik) :: first_outcome
      logical :: has_start

      first_outcome = report%outcome
      call system%restart(x, has_start)
      report%was_restarted = has_start
      if (has_start) call iterate_from(system, x, settings, report)
      if (report%outcome == outcome_stuck) call iterate_damped(system, x, settings, report)
      if (report%outcome /= outcome_converged) then
         report%outcome = first_outcome
      else if (has_start) then
         if (system%is_propped) then
            if (is_loose(system, x)) report%outcome = outcome_singular
         end if
      end if
   end subroutine persevere

   !> Whether the solution is not unique: a part held only by contact is free to move.
   logical function is_loose(system, x)
      class(contact_system_t), intent(inout) :: system
      real(rk), intent(in) :: x(:)  !< the solution [Pa]
      real(rk), parameter :: largest_condition = 1.0e12_rk
      type(step_quality_t) :: quality
      real(rk) :: step(size(x))

      call system%end_restart()
      call system%evaluate(x)
      call system%find_step(.true., step, quality)
      is_loose = quality%is_singular .or. .not. quality%condition <= largest_condition
   end function is_loose

   !> Iterate until convergence or failure. A sufficiently accurate initial guess is not accepted: a
   !! state would not follow a load that changes by less than the tolerance, and the search for an
   !! onset of growth would not end.
   subroutine iterate_from(system, x, settings, report)
      class(contact_system_t), intent(inout) :: system
      real(rk), intent(inout) :: x(:)  !< [Pa]
      type(iteration_settings_t), intent(in) :: settings
      type(iteration_report_t), intent(inout) :: report
      integer(ik) :: seen(2*size(system%state), 0:settings%iterations_max)
      real(rk) :: seen_worst(0:settings%iterations_max), step(size(x))
      type(course_t) :: course
      integer(ik) :: k

      course%before = system%state
      do k = 0, settings%iterations_max
         call system%evaluate(x)
         call judge(system, x, settings, course, report)
         if (report%outcome /= outcome_stuck .or. k == settings%iterations_max) return
         if (has_been(system, course%worst, seen(:, :k - 1), seen_worst(:k - 1))) return
         seen(:, k) = [system%state, system%slip_sign]
         seen_worst(k) = course%worst
         call find_next(system, settings, course, step, report)
         if (report%outcome == outcome_singular) return
         x = x + step
      end do
   end subroutine iterate_from

   !> The same with steps that are shortened until the norm of the residuals falls; without memory
   !! of the direction of slip, so that residuals are functions of x alone.
   subroutine iterate_damped(system, x, settings, report)
      class(contact_system_t), intent(inout) :: system
      real(rk), intent(inout) :: x(:)  !< [Pa]
      type(iteration_settings_t), intent(in) :: settings
      type(iteration_report_t), intent(inout) :: report
      real(rk), parameter :: shortest = 1.0_rk/64.0_rk
      real(rk), parameter :: least_fall = 1.0e-4_rk  ! of the norm, as a share of the length
      ! Where the norm has a kink, the direction may be that of its other side, and no length lets
      ! it fall. Of the lengths taken then, each differs from all before (the golden ratio), so that
      ! this cannot cycle.
      real(rk), parameter :: golden = 0.5_rk*(sqrt(5.0_rk) - 1.0_rk)
      real(rk) :: length, norm, step(size(x))
      type(course_t) :: course
      integer(ik) :: k, n_kinks

      n_kinks = 0
      course%before = system%state
      system%slip_sign = 0
      call system%evaluate(x)
      do k = 0, settings%iterations_max
         call judge(system, x, settings, course, report)
         if (report%outcome /= outcome_stuck .or. k == settings%iterations_max) return
         norm = norm2(system%residual)
         call find_next(system, settings, course, step, report)
         if (report%outcome == outcome_singular) return
         length = 1.0_rk
         do
            system%slip_sign = 0
            call system%evaluate(x + length*step)
            if (norm2(system%residual) <= (1.0_rk - least_fall*length)*norm) exit
            if (length <= shortest) then
               n_kinks = n_kinks + 1
               length = 1.0_rk - 0.9_rk*modulo(n_kinks*golden, 1.0_rk)
               system%slip_sign = 0
               call system%evaluate(x + length*step)
               exit
            end if
            length = 0.5_rk*length
         end do
         x = x + length*step
      end do
   end subroutine iterate_damped

   !> Test x, where the system was last evaluated, for convergence.
   subroutine judge(system, x, settings, course, report)
      class(contact_system_t), intent(inout) :: system
      real(rk), intent(in) :: x(:)  !< [Pa]
      type(iteration_settings_t), intent(in) :: settings
      type(course_t), intent(inout) :: course
      type(iteration_report_t), intent(inout) :: report
      logical :: is_end, is_small

      course%worst = maxval(abs(system%residual))
      if (.not. course%worst <= huge(1.0_rk)) then
         report%outcome = outcome_not_a_number
         return
      end if
      report%outcome = outcome_stuck
      is_small = course%worst <= settings%tolerance*system%stress_scale
      if (all(system%state == course%before) .and. course%has_begun) then
         if (is_small) then
            is_end = course%was_small
            if (.not. is_end) is_end = course%left*report%condition <= well_solved &
                                       .and. system%is_balanced()
         else
            is_end = settings%allows_rounding
            if (is_end) is_end = is_rounding(system, x, settings%tolerance)
         end if
         if (is_end) report%outcome = outcome_converged
      else if (is_small .and. course%was_small) then
         if (system%obeys_law(x, settings%tolerance)) report%outcome = outcome_converged
      end if
      course%was_small = is_small
   end subroutine judge

   !> The step from where the system was last evaluated.
   subroutine find_next(system, settings, course, step, report)
      class(contact_system_t), intent(inout) :: system
      type(iteration_settings_t), intent(in) :: settings
      type(course_t), intent(inout) :: course
      real(rk), intent(out) :: step(:)  !< [Pa]; undefined without one
      type(iteration_report_t), intent(inout) :: report
      type(step_quality_t) :: quality

      course%before = system%state
      course%has_begun = .true.
      call system%find_step(settings%with_condition, step, quality)
      if (quality%is_singular) then
         report%outcome = outcome_singular
         return
      end if
      course%left = quality%rest
      report%condition = quality%condition
      report%error_bound = min(1.0_rk, estimate_off_by*quality%condition &
                               *(epsilon(1.0_rk) + quality%rest))
      report%iterations = report%iterations + 1
   end subroutine find_next

   !> Whether the iteration cycles: the same states and directions of slip, and the same residual.
   pure logical function has_been(system, worst, seen, seen_worst)
      class(contact_system_t), intent(in) :: system
      real(rk), intent(in) :: worst  !< residual now [Pa]
      integer(ik), intent(in) :: seen(:, :)  !< (states then ways of all points, iterations)
      real(rk), intent(in) :: seen_worst(:)  !< (iterations) residuals then [Pa]
      integer(ik) :: k, n

      n = size(system%state)
      has_been = .true.
      do k = 1, size(seen_worst)
         if (abs(worst - seen_worst(k)) > same_value*worst) cycle
         if (all(seen(:n, k) == system%state) .and. all(seen(n + 1:, k) == system%slip_sign)) return
      end do
      has_been = .false.
   end function has_been

   !> Whether every residual is below the tolerance or below the rounding errors of its terms: in
   !! permeable rock, those of the fluid balance exceed any fixed tolerance.
   pure logical function is_rounding(system, x, tolerance) result(is_small)
      class(contact_system_t), intent(in) :: system
      real(rk), intent(in) :: x(:)  !< where the system was last evaluated [Pa]
      real(rk), intent(in) :: tolerance  !< relative to the stress scale [-]
      integer(ik) :: row

      is_small = .true.
      do row = 1, size(x)
         if (abs(system%residual(row)) <= tolerance*system%stress_scale) cycle
         is_small = abs(system%residual(row)) <= 8.0_rk*epsilon(1.0_rk)*system%size_of_terms(x, row)
         if (.not. is_small) return
      end do
   end function is_rounding

end module contact_newton
