!> The equations of one time step on the fractures: contact at both ends of every cell, and the
!! fluid (coarse_fracture_flow, coarse_joint_flow, coarse_well_flow, coarse_fluid_law). Their
!! unknowns are those of fracture_layout_t.
module coarse_equations
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use base_kinds, only: ik, rk
   use coarse_fluid_law, only: add_fluid_law
   use coarse_fracture_flow, only: fill_balance, fill_equilibrium, fill_exchange, fill_flow
   use coarse_joint_flow, only: fill_branch, fill_joint
   use coarse_pivoting, only: pivot_fractures
   use coarse_well_flow, only: fill_well
   use coarse_fractures, only: cell_fluid_t, fracture_system_t
   use contact_law, only: contact_equations
   implicit none(type, external)
   private

   public :: equations_t

   !> The whole system.
   type, extends(fracture_system_t) :: equations_t
   contains
      procedure :: evaluate
      procedure :: restart
   end type equations_t

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

end module coarse_equations
