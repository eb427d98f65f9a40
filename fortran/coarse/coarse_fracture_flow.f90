!> The fluid in the fractures: each fills the rows of its equations in the system of one time step.
!!
!! Fluid mass of a cell of length l, with the volumes V of fluid that left the rock within the step
!! (theory.md):
!!   l (a - a_before + a c_p (p_F - p_F,before)) - V+ - V- - dt Q + flows out - flows in = 0
!! Flow between neighbours by the cubic law, exchange with the rock through half the aperture. The
!! flow is a separate unknown because the pressure difference that drives it along an open
!! fracture is far below the rounding of the pressures.
module coarse_fracture_flow
   use base_kinds, only: ik, rk
   use coarse_fractures, only: fracture_system_t
   implicit none(type, external)
   private

   public :: fill_balance, fill_equilibrium, fill_exchange, fill_flow

   integer(ik), parameter :: both(2) = [1_ik, 2_ik]  !< ends or sides of a cell

contains

   !> Flux between the rock and cell i on both sides: lambda = (kappa/mu)(p - p_F)/(a/2), kappa =
   !! a^2/12. Its equations are those of p+ and p-.
   pure subroutine fill_exchange(i, x, eq)
      integer(ik), intent(in) :: i
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(inout) :: eq
      real(rk) :: aperture, conductance, slope, volume
      integer(ik) :: at, fluid, jumps(2), n, row, side

      n = size(eq%force_slope, 1)
      jumps = eq%layout%at_jump(i, both)
      fluid = eq%layout%at_pressure(i)
      call conducting_aperture(eq%cells%residual_aperture(i), eq%opening(x, i), aperture, slope)
      conductance = eq%dt*eq%condensed%length(i)*aperture/(6.0_rk*eq%settings%viscosity)
      do side = 1, 2
         row = eq%layout%at_face_pressure(i, side)
         at = eq%condensed%layout%at_face_pressure(i, side)
         volume = eq%force(at)
         eq%residual(row) = volume/conductance - (x(row) - x(fluid))
         eq%jacobian(:n, row) = eq%force_slope(:, at)/conductance
         eq%jacobian(jumps, row) = eq%jacobian(jumps, row) &
                                   - 0.5_rk*volume/(conductance*aperture)*slope/eq%stiffness
         eq%jacobian(row, row) = eq%jacobian(row, row) - 1.0_rk
         eq%jacobian(fluid, row) = eq%jacobian(fluid, row) + 1.0_rk
      end do
   end subroutine fill_exchange

   !> Fluid balance of cell i, without the flow along the fracture. Its equation is that of p_F.
   pure subroutine fill_balance(i, x, eq)
      integer(ik), intent(in) :: i
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(inout) :: eq
      real(rk) :: aperture, compression
      integer(ik) :: from_rock(2), jumps(2), n, row

      n = size(eq%force_slope, 1)
      row = eq%layout%at_pressure(i)
      jumps = eq%layout%at_jump(i, both)
      from_rock = eq%condensed%layout%at_face_pressure(i, both)
      associate (length => eq%condensed%length(i), compressibility => eq%settings%compressibility)
         aperture = eq%cells%residual_aperture(i) + eq%opening(x, i)
         compression = compressibility*(x(row) - eq%before%pressure(i))
         eq%residual(row) = (length*(aperture - eq%before%aperture(i) + aperture*compression) &
                             - eq%force(from_rock(1)) - eq%force(from_rock(2)) &
                             - eq%dt*eq%cells%injection(i))/eq%unit
         eq%jacobian(:n, row) = -(eq%force_slope(:, from_rock(1)) &
                                  + eq%force_slope(:, from_rock(2)))/eq%unit
         eq%jacobian(jumps, row) = eq%jacobian(jumps, row) &
                                   + 0.5_rk*length*(1.0_rk + compression)/(eq%stiffness*eq%unit)
         eq%jacobian(row, row) = eq%jacobian(row, row) + length*aperture*compressibility/eq%unit
      end associate
   end subroutine fill_balance

   !> Initial state, instead of exchange and balance: nothing flows, and cell i has the pressure of
   !! the rock around it.
   pure subroutine fill_equilibrium(i, x, eq)
      integer(ik), intent(in) :: i
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(inout) :: eq
      real(rk) :: conductance
      integer(ik) :: at, faces(2), fluid, side

      faces = eq%layout%at_face_pressure(i, both)
      do side = 1, 2
         at = eq%condensed%layout%at_face_pressure(i, side)
         associate (row => faces(side))
            conductance = abs(eq%force_slope(row, at))
            eq%residual(row) = eq%force(at)/conductance
            eq%jacobian(:size(eq%force_slope, 1), row) = eq%force_slope(:, at)/conductance
         end associate
      end do
      fluid = eq%layout%at_pressure(i)
      eq%residual(fluid) = x(fluid) - 0.5_rk*(x(faces(1)) + x(faces(2)))
      eq%jacobian(fluid, fluid) = 1.0_rk
      eq%jacobian(faces, fluid) = -0.5_rk
   end subroutine fill_equilibrium

   !> Flow from the first to the second cell of pair k: cubic law, two-point; and its part in the
   !! balances of both.
   pure subroutine fill_flow(k, x, eq)
      integer(ik), intent(in) :: k
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(inout) :: eq
      real(rk) :: aperture, resistance, slope
      integer(ik) :: end, first, i, row, second

      row = eq%layout%at_flow(k)
      first = eq%layout%at_pressure(eq%connections(1, k))
      second = eq%layout%at_pressure(eq%connections(2, k))
      eq%residual(row) = x(second) - x(first)
      do end = 1, 2
         i = eq%connections(end, k)
         call conducting_aperture(eq%cells%residual_aperture(i), eq%opening(x, i), aperture, slope)
         resistance = 6.0_rk*eq%settings%viscosity*eq%condensed%length(i)/aperture**3*eq%unit/eq%dt
         eq%residual(row) = eq%residual(row) + resistance*x(row)
         eq%jacobian(row, row) = eq%jacobian(row, row) + resistance
         eq%jacobian(eq%layout%at_jump(i, both), row) = -1.5_rk*resistance*x(row)/aperture*slope &
                                                        /eq%stiffness
      end do
      eq%jacobian(first, row) = -1.0_rk
      eq%jacobian(second, row) = 1.0_rk
      eq%residual(first) = eq%residual(first) + x(row)
      eq%residual(second) = eq%residual(second) - x(row)
      eq%jacobian(row, first) = 1.0_rk
      eq%jacobian(row, second) = -1.0_rk
   end subroutine fill_flow

   !> Aperture that conducts fluid; iterates with closed or overlapping faces keep a hundredth of
   !! a0.
   pure subroutine conducting_aperture(residual, opening, aperture, slope)
      real(rk), intent(in) :: residual  !< a0 [m]
      real(rk), intent(in) :: opening  !< [u]_n [m]
      real(rk), intent(out) :: aperture  !< [m]
      real(rk), intent(out) :: slope  !< its derivative by [u]_n [-]

      aperture = residual + opening
      slope = 1.0_rk
      if (.not. aperture > 0.01_rk*residual) then
         aperture = 0.01_rk*residual
         slope = 0.0_rk
      end if
   end subroutine conducting_aperture

end module coarse_fracture_flow
