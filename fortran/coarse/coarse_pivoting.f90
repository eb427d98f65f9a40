!> An alternative initial guess for the iteration on the fractures where it finds no initial state:
!! contact by complementary pivoting (contact_pivoting) at a fixed fluid pressure, which is then
!! released gradually.
!!
!! In the initial state the fluid has the rock's pressure. Rock between faces that are close to each
!! other responds to their jumps with so much pressure that pivoting is not guaranteed to end, and
!! that alternating between pivoting and pressure diverges. With a fixed fluid pressure pivoting is
!! guaranteed to end, since the undrained stiffness of the body is symmetric and positive definite.
!! From there the share of the rock in the fluid's pressure rises to one, and Newton's method
!! follows the state; a rise that fails is halved. Where this path turns back (rock between faces
!! yields abruptly), the fluid pressure is fixed at its present value, and the share rises from zero
!! again: the rock that yields then does not draw fluid from the whole body.
module coarse_pivoting
   use algebra_lapack, only: dgetrf, dgetrs
   use base_kinds, only: ik, rk
   use coarse_fractures, only: fracture_system_t
   use coarse_full_step, only: full_slopes
   use contact_newton, only: iterate_from, iteration_report_t, iteration_settings_t, &
                             outcome_converged
   use contact_pivoting, only: pivot_to_solution, slips_t
   implicit none(type, external)
   private

   public :: pivot_fractures

   integer(ik), parameter :: most_points = 300  !< the time goes with the third power of them

   !> Jumps and what depends on them, around x.
   type :: condensed_jumps_t
      integer(ik), allocatable :: jumps(:), others(:)  !< n and tau point by point; all else
      !> (others, jumps + 1) change by that of each jump [-], and with none [Pa]
      real(rk), allocatable :: response(:, :)
      real(rk), allocatable :: slope(:, :)  !< (jump, traction) [-]
      real(rk), allocatable :: traction(:)  !< with jumps as they are [Pa]
   end type condensed_jumps_t

contains

   !> Unknowns of an initial state that nearly fulfil the law of contact and the equilibrium.
   subroutine pivot_fractures(eq, x, has_start)
      class(fracture_system_t), intent(inout) :: eq
      real(rk), intent(inout) :: x(:)  !< where the iteration started [Pa]; replaced if solved
      logical, intent(out) :: has_start
      integer(ik) :: fluid(eq%layout%n_cells), i
      type(condensed_jumps_t) :: body

      has_start = eq%paths%settings%equilibrate
      if (.not. has_start) return
      fluid = eq%layout%at_pressure([(i, i=1, eq%layout%n_cells)])
      eq%held_pressure = x(fluid)
      eq%share_of_rock = 0.0_rk
      if (eq%condensed%is_full .and. 2*eq%layout%n_cells <= most_points) then
         call condense(eq, x, fluid, body, has_start)
         if (has_start) call pivot(eq, body, x, has_start)
      end if
      eq%slip_sign = 0
      call let_free(eq, fluid, x, has_start)
      eq%share_of_rock = 1.0_rk
      eq%slip_sign = 0
   end subroutine pivot_fractures

   !> Let the share of the rock in the pressure of the fluid rise to one, from the state without.
   subroutine let_free(eq, fluid, x, has_start)
      class(fracture_system_t), intent(inout) :: eq
      integer(ik), intent(in) :: fluid(:)  !< unknowns that are its pressure
      real(rk), intent(inout) :: x(:)  !< near the state without a share [Pa]
      logical, intent(out) :: has_start  !< the state with a share of one is near
      real(rk), parameter :: first = 0.125_rk, longest = 0.25_rk, shortest = 1.0_rk/64.0_rk
      real(rk), parameter :: growth = 1.5_rk  ! of the steps, after each that succeeds
      integer(ik), parameter :: most_steps = 200
      type(iteration_settings_t) :: how
      type(iteration_report_t) :: report
      real(rk) :: reached, step, trial(size(x))
      integer(ik) :: k

      how = iteration_settings_t(tolerance=eq%paths%settings%tolerance, allows_rounding=.true., &
                                 iterations_max=eq%paths%settings%iterations_max)
      call iterate_from(eq, x, how, report)
      has_start = report%outcome == outcome_converged
      reached = 0.0_rk
      step = first
      do k = 1, most_steps
         if (.not. has_start .or. reached >= 1.0_rk) return
         eq%share_of_rock = min(1.0_rk, reached + step)
         eq%slip_sign = 0
         trial = x
         call iterate_from(eq, trial, how, report)
         if (report%outcome == outcome_converged) then
            x = trial
            reached = eq%share_of_rock
            step = min(longest, growth*step)
         else
            step = 0.5_rk*step
            if (step < shortest) then
               has_start = reached > 0.0_rk
               eq%held_pressure = x(fluid)
               reached = 0.0_rk
               step = first
            end if
         end if
      end do
      has_start = .false.
   end subroutine let_free

   !> Tractions as functions of the jumps alone, the pressures of the fluid held.
   subroutine condense(eq, x, held, body, is_regular)
      class(fracture_system_t), intent(inout) :: eq
      real(rk), intent(in) :: x(:)  !< [Pa]
      integer(ik), intent(in) :: held(:)  !< unknowns
      type(condensed_jumps_t), intent(out) :: body
      logical, intent(out) :: is_regular
      real(rk), allocatable :: jacobian(:, :), matrix(:, :)
      integer(ik), allocatable :: pivots(:)
      logical :: is_other(size(x))
      integer(ik) :: end, i, info, k, m, n

      eq%is_without_contact = .true.
      call eq%evaluate(x)
      eq%is_without_contact = .false.
      call full_slopes(eq%condensed%stiffness, eq%slopes, jacobian)
      body%jumps = [(((eq%layout%at_jump(i, end) + k, k=0, 1), end=1, 2), i=1, eq%layout%n_cells)]
      is_other = .true.
      is_other(body%jumps) = .false.
      is_other(held) = .false.
      body%others = pack([(i, i=1, size(x, kind=ik))], is_other)
      associate (jumps => body%jumps, others => body%others)
         m = size(others, kind=ik)
         n = size(jumps, kind=ik)
         matrix = jacobian(others, others)
         allocate (pivots(m), body%response(m, n + 1))
         body%response(:, :n) = -transpose(jacobian(jumps, others))
         body%response(:, n + 1) = -eq%residual(others)
         call dgetrf(m, m, matrix, m, pivots, info)
         is_regular = info == 0
         if (.not. is_regular) return
         call dgetrs("T", m, n + 1_ik, matrix, m, pivots, body%response, m, info)
         body%slope = jacobian(jumps, jumps) + matmul(transpose(body%response(:, :n)), &
                                                      jacobian(others, jumps))
         body%traction = eq%residual(jumps) + matmul(body%response(:, n + 1), &
                                                     jacobian(others, jumps))
      end associate
   end subroutine condense

   !> The jumps that fulfil the law, and what goes with them.
   subroutine pivot(eq, body, x, is_solved)
      class(fracture_system_t), intent(in) :: eq
      type(condensed_jumps_t), intent(in) :: body
      real(rk), intent(inout) :: x(:)  !< where the body was condensed [Pa]; replaced if solved
      logical, intent(out) :: is_solved
      real(rk) :: found(4*eq%layout%n_cells), share(2*eq%layout%n_cells)  ! of the mean length [-]
      real(rk) :: load(size(found)), stiffness(size(found), size(found))
      integer(ik) :: end, i, n

      n = 2*eq%layout%n_cells
      share = [((eq%condensed%length(i), end=1, 2), i=1, eq%layout%n_cells)]
      share = share*n/sum(share)
      found = x(body%jumps)
      load = body%traction - matmul(found, body%slope)
      do i = 1, 2*n
         stiffness(:, i) = -share((i + 1)/2)*body%slope(:, i)
         load(i) = share((i + 1)/2)*load(i)
      end do
      call pivot_to_solution(stiffness, load, eq%law, eq%stiffness*eq%law%compliance/share, &
                             slips_t(spread(.false., 1, n), eq%stiffness*eq%slip_before, &
                                     spread(0.0_rk, 1, n)), found, is_solved)
      if (.not. is_solved) return
      x(body%others) = x(body%others) + matmul(body%response(:, :2*n), found - x(body%jumps)) &
                       + body%response(:, 2*n + 1)
      x(body%jumps) = found
   end subroutine pivot

end module coarse_pivoting
