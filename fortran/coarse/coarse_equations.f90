!> The equations of one time step on the fractures: contact at both ends of every cell, and the
!! fluid (coarse_fracture_flow, coarse_fracture_flow, coarse_well_flow, coarse_fluid_law). Their
!! unknowns are those of fracture_layout_t.
!!
!! Another start for the iteration on the fractures where that finds no initial state: contact by
!! complementary pivoting (contact_pivoting), in turns with the pressure of the fluid.
!!
!! In the initial state the fluid has the rock's pressure. Rock between faces that are close to each
!! other answers to their jumps with so much pressure that pivoting is without a guarantee. With the
!! pressure of the fluid held it has one, as the stiffness of a body that neither gains nor loses
!! fluid is symmetric and positive definite. So both are found in turns.
module coarse_equations
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use algebra_lapack, only: dgetrf, dgetrs
   use base_kinds, only: ik, rk
   use coarse_fluid_law, only: add_fluid_law
   use coarse_fracture_flow, only: fill_balance, fill_branch, fill_equilibrium, fill_exchange, &
                                   fill_flow, fill_joint
   use coarse_fractures, only: cell_fluid_t, fracture_system_t
   use coarse_full_step, only: full_slopes
   use coarse_well_flow, only: fill_well
   use contact_law, only: contact_equations, contact_law_t
   use contact_pivoting, only: pivot_to_solution
   implicit none(type, external)
   private

   public :: equations_t

   !> The whole system.
   type, extends(fracture_system_t) :: equations_t
   contains
      procedure :: evaluate
      procedure :: restart
   end type equations_t

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

   !> Residuals [Pa] and their derivatives at x.
   subroutine evaluate(self, x)
      class(equations_t), intent(inout) :: self
      real(rk), intent(in) :: x(:)  !< [Pa]
      real(rk) :: pressure
      integer(ik) :: end, i, k

      call self%find_forces(x)
      call self%slopes%clear(self%layout%count())
      pressure = 0.0_rk
      do i = 1, self%layout%n_cells
         do end = 1, 2
            call fill_contact(i, end, x, self)
         end do
         if (self%settings%equilibrate) then
            call fill_equilibrium(i, x, self)
         else
            call fill_exchange(i, x, self)
            call fill_balance(i, x, self)
         end if
         pressure = max(pressure, abs(x(self%layout%at_pressure(i))))
      end do
      do k = 1, self%layout%n_flows
         call fill_flow(k, x, self)
      end do
      do k = 1, self%layout%n_joints
         call fill_joint(k, x, self)
      end do
      do k = 1, self%layout%n_branches
         call fill_branch(k, x, self)
      end do
      do k = 1, self%layout%n_wells
         call fill_well(k, x, self)
      end do
      if (allocated(self%settings%fluid_law) .and. .not. self%settings%equilibrate) then
         call add_fluid_law(x, self%settings%fluid_law, self)
      end if
      self%stress_scale = max(maxval(abs(self%traction)), pressure, self%load_stress, 1.0_rk)
      if (self%has_failed) self%residual = ieee_value(1.0_rk, ieee_quiet_nan)
   end subroutine evaluate

   !> Contact by pivoting, from where the step started.
   subroutine restart(self, x, has_start)
      class(equations_t), intent(inout) :: self
      real(rk), intent(inout) :: x(:)  !< [Pa]
      logical, intent(out) :: has_start
      real(rk) :: found(size(x))

      found = self%start
      call pivot_fractures(self, found, has_start)
      if (has_start) x = found
   end subroutine restart

   !> The two contact equations at one end of cell i.
   pure subroutine fill_contact(i, end, x, eq)
      integer(ik), intent(in) :: i
      integer(ik), intent(in) :: end  !< 1 start, 2 end
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(equations_t), intent(inout) :: eq
      real(rk) :: by_traction(2, 2), by_jump(2, 2), half_length
      type(cell_fluid_t) :: fluid
      integer(ik) :: at, k, m, point, row

      half_length = 0.5_rk*eq%condensed%length(i)
      at = eq%condensed%layout%at_jump(i, end)
      row = eq%layout%at_jump(i, end)
      fluid = eq%fluid_at(x, i)
      point = 2*(i - 1) + end
      eq%traction(:, end, i) = [fluid%pressure, 0.0_rk] - eq%force(at:at + 1)/half_length
      call contact_equations(eq%law_at(i, end), eq%stiffness, eq%traction(:, end, i), &
                             eq%q(at:at + 1), eq%before%jump(2, end, i), eq%way(point), &
                             eq%state(point), eq%residual(row:row + 1), by_traction, by_jump)
      if (eq%is_without_contact) then
         eq%residual(row:row + 1) = eq%traction(:, end, i)
         by_traction = reshape([1.0_rk, 0.0_rk, 0.0_rk, 1.0_rk], [2, 2])
         by_jump = 0.0_rk
      end if
      do k = 1, 2
         associate (slopes => eq%slopes, equation => row + k - 1)
            do m = 1, 2
               call slopes%add_force(equation, at + m - 1, -by_traction(k, m)/half_length)
               call slopes%add(equation, row + m - 1, by_jump(k, m)/eq%stiffness)
            end do
            call slopes%add(equation, eq%layout%at_pressure(i), &
                            by_traction(k, 1)*fluid%pressure_slope)
         end associate
      end do
   end subroutine fill_contact

   !> Unknowns of an initial state that nearly fulfil the law of contact and the equilibrium.
   subroutine pivot_fractures(eq, x, has_start)
      class(fracture_system_t), intent(inout) :: eq
      real(rk), intent(inout) :: x(:)  !< where the iteration started [Pa]; replaced if solved
      logical, intent(out) :: has_start
      integer(ik), parameter :: turns = 60
      real(rk), parameter :: settled = 1.0e-3_rk  ! of the largest stress: Newton's method goes on
      real(rk) :: change(eq%layout%n_cells)
      integer(ik) :: faces(2, eq%layout%n_cells), fluid(eq%layout%n_cells), i, k
      type(condensed_jumps_t) :: body

      has_start = eq%settings%equilibrate .and. eq%condensed%is_full &
                  .and. 2*eq%layout%n_cells <= most_points
      if (.not. has_start) return
      fluid = eq%layout%at_pressure([(i, i=1, eq%layout%n_cells)])
      faces = reshape([(eq%layout%at_face_pressure(i, [1_ik, 2_ik]), i=1, eq%layout%n_cells)], &
                      shape(faces))
      do k = 1, turns
         call condense(eq, x, fluid, body, has_start)
         if (has_start) call pivot(eq, body, x, has_start)
         if (.not. has_start) return
         change = 0.5_rk*(x(faces(1, :)) + x(faces(2, :))) - x(fluid)
         x(fluid) = x(fluid) + change
         if (maxval(abs(change)) <= settled*eq%stress_scale) exit
      end do
      eq%way = 0
   end subroutine pivot_fractures

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
      call full_slopes(eq%condensed%stiffness, eq%slopes, eq%x_of_q, eq%q_per_x, jacobian)
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
      type(contact_law_t) :: law(2*eq%layout%n_cells)
      real(rk) :: found(4*eq%layout%n_cells), share(2*eq%layout%n_cells)  ! of the mean length [-]
      real(rk) :: load(size(found)), stiffness(size(found), size(found))
      integer(ik) :: end, i, n

      n = 2*eq%layout%n_cells
      law = [((eq%law_at(i, end), end=1, 2), i=1, eq%layout%n_cells)]
      share = [((eq%condensed%length(i), end=1, 2), i=1, eq%layout%n_cells)]
      share = share*n/sum(share)
      found = x(body%jumps)
      load = body%traction - matmul(found, body%slope)
      do i = 1, 2*n
         stiffness(:, i) = -share((i + 1)/2)*body%slope(:, i)
         load(i) = share((i + 1)/2)*load(i)
      end do
      call pivot_to_solution(stiffness, load, law, eq%stiffness*law%compliance/share, &
                             spread(.false., 1, n), &
                             eq%stiffness*reshape(eq%before%jump(2, :, :), [n]), &
                             spread(0.0_rk, 1, n), found, is_solved)
      if (.not. is_solved) return
      x(body%others) = x(body%others) + matmul(body%response(:, :2*n), found - x(body%jumps)) &
                       + body%response(:, 2*n + 1)
      x(body%jumps) = found
   end subroutine pivot

end module coarse_equations
