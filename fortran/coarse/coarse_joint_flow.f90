!> The fluid at the joints of fractures: fills the rows of its equations in the system of one time
!! step.
!!
!! The flow of each branch, from the middle of its last cell to the joint, follows the cubic law
!! with the aperture of that cell; the flows into a joint and what a well feeds there add up to
!! nothing, for a joint has no volume (coarse_joints):
!!   q = a^3/(12 mu) (p_F - p_J)/(l/2),   sum q + Q = 0   or, at an outlet,   p_J = p of the side
module coarse_joint_flow
   use base_kinds, only: ik, rk
   use coarse_fracture_flow, only: conducting_aperture
   use coarse_fractures, only: cell_fluid_t, fracture_system_t
   implicit none(type, external)
   private

   public :: fill_branch, fill_joint

   integer(ik), parameter :: both(2) = [1_ik, 2_ik]  !< ends of a cell

contains

   !> Balance of joint j, without the flows of its branches; its equation is that of p_J.
   pure subroutine fill_joint(j, x, eq)
      integer(ik), intent(in) :: j
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(inout) :: eq
      integer(ik) :: row

      row = eq%layout%at_joint(j)
      if (eq%joints%is_outlet(j)) then
         eq%residual(row) = x(row) - eq%joints%side_pressure(j)
         eq%jacobian(row, row) = 1.0_rk
      else
         eq%residual(row) = -eq%dt*eq%joints%injection(j)/eq%unit
      end if
   end subroutine fill_joint

   !> Flow of branch b into its joint, and its part in the balances of the cell and, unless that is
   !! an outlet, of the joint, whose balance must be there already.
   pure subroutine fill_branch(b, x, eq)
      integer(ik), intent(in) :: b
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(inout) :: eq
      real(rk) :: aperture, length, resistance, slope
      type(cell_fluid_t) :: fluid
      integer(ik) :: at, cell, joint, jumps(2), row

      row = eq%layout%at_branch(b)
      cell = eq%joints%cell(b)
      at = eq%layout%at_pressure(cell)
      joint = eq%layout%at_joint(eq%joints%joint(b))
      jumps = eq%layout%at_jump(cell, both)
      fluid = eq%fluid_at(x, cell)
      associate (cells => eq%cells)
         length = 0.5_rk*cells%share(cell)*eq%condensed%length(cell)
         call conducting_aperture(cells%residual_aperture(cell), cells%roughness(cell), &
                                  eq%opening(x, cell)/cells%share(cell), aperture, slope)
         slope = slope/cells%share(cell)
      end associate
      resistance = 12.0_rk*eq%settings%viscosity*length/aperture**3*eq%unit/eq%dt
      eq%residual(row) = x(joint) - fluid%pressure + resistance*x(row)
      eq%jacobian(row, row) = resistance
      eq%jacobian(joint, row) = 1.0_rk
      eq%jacobian(at, row) = -fluid%pressure_slope
      eq%jacobian(jumps, row) = -1.5_rk*resistance*x(row)/aperture*slope/eq%stiffness
      eq%residual(at) = eq%residual(at) + x(row)
      eq%jacobian(row, at) = eq%jacobian(row, at) + 1.0_rk
      if (eq%joints%is_outlet(eq%joints%joint(b))) return
      eq%residual(joint) = eq%residual(joint) - x(row)
      eq%jacobian(row, joint) = -1.0_rk
   end subroutine fill_branch

end module coarse_joint_flow
