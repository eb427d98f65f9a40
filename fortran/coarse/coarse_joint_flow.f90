!> The fluid at the joints of fractures: fills the rows of its equations in the system of one time
!! step.
!!
!! The flow of each branch, from the middle of its last cell to the joint, follows the cubic law
!! with the aperture of that cell, or where the fracture goes on beyond the joint with the opening
!! between the two middles, as inside a fracture (coarse_fracture_flow): a fracture that another one
!! crosses conducts as it does alone. The flows into a joint and what a well feeds there add up to
!! nothing, for a joint has no volume (coarse_joints):
!!   q = a^3/(12 mu) (p_F - p_J)/(l/2),   sum q + Q = 0   or, at an outlet,   p_J = p of the side
!! A branch is shut, q = 0, as long as its crack has not come to the joint. Where all are, the joint
!! has the pressure of the first.
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
      type(cell_fluid_t) :: fluid
      real(rk) :: slope(2)  ! by the pressures of the joint and of its first cell
      integer(ik) :: at, cell, row

      row = eq%layout%at_joint(j)
      cell = eq%joints%cell(eq%joints%branches%at(j, 1_ik))
      at = eq%layout%at_pressure(cell)
      slope = 0.0_rk
      if (all(eq%joints%is_shut(eq%joints%branches%of(j)))) then
         fluid = eq%fluid_at(x, cell)
         eq%residual(row) = x(row) - fluid%pressure
         slope = [1.0_rk, -fluid%pressure_slope]
      else if (eq%joints%is_outlet(j)) then
         eq%residual(row) = x(row) - eq%joints%side_pressure(j)
         slope(1) = 1.0_rk
      else
         eq%residual(row) = -eq%dt*eq%joints%injection(j)/eq%unit
      end if
      ! The places of the derivatives are the same in every state (coarse_slopes).
      call eq%slopes%add(row, row, slope(1))
      call eq%slopes%add(row, at, slope(2))
   end subroutine fill_joint

   !> Flow of branch b into its joint, and its part in the balances of the cell and, unless that is
   !! an outlet, of the joint, whose balance must be there already.
   pure subroutine fill_branch(b, x, eq)
      integer(ik), intent(in) :: b
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(inout) :: eq
      real(rk) :: aperture, by_jump(2), by_pressure(2), length, opening, resistance, slope
      real(rk) :: weight(2)
      type(cell_fluid_t) :: fluid
      integer(ik) :: at, cell, cells(2), end, joint, jumps(2), k, row
      logical :: ends_in_joint

      row = eq%layout%at_branch(b)
      cell = eq%joints%cell(b)
      at = eq%layout%at_pressure(cell)
      joint = eq%layout%at_joint(eq%joints%joint(b))
      call find_way(b, eq, length, cells, weight)
      if (eq%joints%is_shut(b)) then
         resistance = 1.0_rk
         by_pressure = 0.0_rk
         by_jump = 0.0_rk
         ends_in_joint = .false.
         eq%residual(row) = x(row)
      else
         fluid = eq%fluid_at(x, cell)
         opening = weight(1)*eq%opening(x, cells(1)) + weight(2)*eq%opening(x, cells(2))
         call conducting_aperture(eq%cells%residual_aperture(cell), eq%cells%roughness(cell), &
                                  opening, aperture, slope)
         resistance = 12.0_rk*eq%settings%viscosity*length/aperture**3*eq%unit/eq%dt
         by_pressure = [1.0_rk, -fluid%pressure_slope]
         by_jump = -1.5_rk*resistance*x(row)/aperture*slope*weight/eq%stiffness
         ends_in_joint = .not. eq%joints%is_outlet(eq%joints%joint(b))
         eq%residual(row) = x(joint) - fluid%pressure + resistance*x(row)
         eq%residual(at) = eq%residual(at) + x(row)
         if (ends_in_joint) eq%residual(joint) = eq%residual(joint) - x(row)
      end if
      ! The places of the derivatives are the same in every state (coarse_slopes).
      call eq%slopes%add(row, row, resistance)
      call eq%slopes%add(row, joint, by_pressure(1))
      call eq%slopes%add(row, at, by_pressure(2))
      do k = 1, 2
         jumps = eq%layout%at_jump(cells(k), both)
         do end = 1, 2
            call eq%slopes%add(row, jumps(end), by_jump(k))
         end do
      end do
      call eq%slopes%add(at, row, by_pressure(1))
      call eq%slopes%add(joint, row, merge(-1.0_rk, 0.0_rk, ends_in_joint))
   end subroutine fill_branch

   !> The way of the fluid from the middle of a branch's cell to the joint, as a length with the
   !! opening there, and that opening as a sum over the mean openings of two cells.
   pure subroutine find_way(b, eq, length, cells, weight)
      integer(ik), intent(in) :: b  !< branch
      class(fracture_system_t), intent(in) :: eq
      real(rk), intent(out) :: length  !< [m]
      integer(ik), intent(out) :: cells(2)  !< its own, and the one beyond or again its own
      real(rk), intent(out) :: weight(2)  !< [-]
      real(rk) :: reach(2)

      cells = eq%joints%cell(b)
      if (eq%joints%beyond(b) > 0) cells(2) = eq%joints%beyond(b)
      reach = eq%cells%share(cells)*eq%condensed%length(cells)
      length = 0.5_rk*reach(1)
      weight = reach(2:1:-1)/(sum(reach)*eq%cells%share(cells))
   end subroutine find_way

end module coarse_joint_flow
