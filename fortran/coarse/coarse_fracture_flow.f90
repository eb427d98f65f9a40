!> The equations of the fluid in the fractures, in the system of one time step.
!!
!! Fluid mass of a cell of length l, with the volumes V of fluid that left the rock within the step
!! (theory.md):
!!   l (m - m_before + m c_p (p_F - p_F,before)) - V+ - V- - dt Q + flows out - flows in = 0
!! with m the aperture less the void filled by vapour. Flow between neighbours by the cubic law,
!! exchange with the rock through half the aperture. The flow is a separate unknown because the
!! pressure difference that drives it along an open fracture is far below the rounding of the
!! pressures.
!!
!! Flow into a closed crack opens it. The conducting aperture between two cells is therefore that
!! between their middles, where the crack has its mean opening: with the aperture of the cell ahead
!! alone there would be no inflow, and the aperture of each single cell delays the front by a
!! fraction of a cell.
!!
!! The slope of a flow's equation by the opening is not always the derivative (`loss_slope`): where
!! fractures open or close, resistances ~ 1/a^3 may become negative in the linear equation, and
!! Newton's iteration cycles. Where the fluid that flows into a cell in the step opens it several
!! times, the loss falls as the flow rises, and the derivative may point away from the solution.
!!
!! The equations of the fluid at the joints of fractures, in the system of one time step.
!!
!! The flow of each branch, from the middle of its last cell to the joint, follows the cubic law
!! with the aperture of that cell. Where the fracture continues beyond the joint, the opening is
!! that between the two middles, as inside a fracture: a fracture that another one crosses conducts
!! as it does alone. The flows into a joint and the rate of a well there add up to zero, since a
!! joint has no volume (coarse_joints):
!!   q = a^3/(12 mu) (p_F - p_J)/(l/2),   sum q + Q = 0   or, at an outlet,   p_J = p of the side
!! where l/2 and p_J are corrected for what leaks off within the cell (coarse_well_ways).
!! A branch is shut, q = 0, before its crack reaches the joint. Where all are shut, the joint has
!! the pressure of the first.
module coarse_fracture_flow
   use base_kinds, only: ik, rk
   use coarse_fractures, only: cell_fluid_t, conducting_aperture, fracture_system_t, most_of_rock
   use coarse_tip_layer, only: opening_shape, pressure_shape, volume_shape
   implicit none(type, external)
   private

   public :: fill_balance, fill_branch, fill_equilibrium, fill_exchange, fill_flow, fill_joint
   public :: loss_slope

   integer(ik), parameter :: both(2) = [1_ik, 2_ik]  !< ends or sides of a cell

contains

   !> Flux between the rock and cell i on both sides: lambda = (kappa/mu)(p - p_F)/(a/2), kappa =
   !! a^2/12, in series with the skin and, at a tip, with the correction of coarse_tips. The
   !! equations are those of p+ and p-.
   pure subroutine fill_exchange(i, x, eq)
      integer(ik), intent(in) :: i
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(inout) :: eq
      real(rk) :: aperture, conductance, resistance, skin, slope, volume
      type(cell_fluid_t) :: fluid
      integer(ik) :: at, end, jumps(2), row, side

      jumps = eq%layout%at_jump(i, both)
      fluid = eq%fluid_at(x, i)
      call conducting_aperture(eq%cells%residual_aperture(i), eq%cells%roughness(i), &
                               eq%opening(x, i)/eq%cells%share(i), aperture, slope)
      slope = slope/eq%cells%share(i)
      conductance = eq%dt*eq%cells%share(i)*eq%condensed%length(i)*aperture &
                    /(6.0_rk*eq%paths%settings%viscosity)
      skin = 0.0_rk
      if (allocated(eq%cells%skin)) then
         skin = eq%cells%skin(i)/(eq%dt*eq%cells%share(i)*eq%condensed%length(i))
      end if
      do side = 1, 2
         row = eq%layout%at_face_pressure(i, side)
         at = eq%condensed%layout%at_face_pressure(i, side)
         volume = eq%force(at)
         resistance = 1.0_rk/conductance &
                      + max(eq%cells%leak_resistance(i)/(eq%paths%settings%mobility*eq%dt), &
                            -most_of_rock/abs(eq%volume_slope(side, i))) + skin
         if (allocated(eq%cells%has_layer)) then
            if (eq%cells%has_layer(side, i)) then
               ! The part of the face behind the tip takes up its share.
               resistance = 1.0_rk/conductance + skin &
                            + (1.0_rk/eq%cells%share(i) - 1.0_rk)/abs(eq%volume_slope(side, i))
            end if
         end if
         eq%residual(row) = volume*resistance - (x(row) - fluid%pressure)
         call eq%slopes%add_force(row, at, resistance)
         do end = 1, 2
            call eq%slopes%add(row, jumps(end), &
                               -0.5_rk*volume/(conductance*aperture)*slope/eq%stiffness)
         end do
         call eq%slopes%add(row, row, -1.0_rk)
         call eq%slopes%add(row, eq%layout%at_pressure(i), fluid%pressure_slope)
      end do
   end subroutine fill_exchange

   !> Fluid balance of cell i, without the flow along the fracture. Its equation is that of p_F.
   pure subroutine fill_balance(i, x, eq)
      integer(ik), intent(in) :: i
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(inout) :: eq
      real(rk) :: compression, filled
      type(cell_fluid_t) :: fluid
      integer(ik) :: from_rock(2), jumps(2), k, row

      row = eq%layout%at_pressure(i)
      jumps = eq%layout%at_jump(i, both)
      from_rock = eq%condensed%layout%at_face_pressure(i, both)
      fluid = eq%fluid_at(x, i)
      associate (length => eq%condensed%length(i), before => eq%before, &
                 compressibility => eq%paths%settings%compressibility)
         filled = eq%cells%residual_aperture(i) + eq%opening(x, i) - fluid%void
         compression = compressibility*(fluid%pressure - before%pressure(i))
         eq%residual(row) = (length*(filled - (before%aperture(i) - before%void(i)) &
                                     + filled*compression) &
                             - eq%force(from_rock(1)) - eq%force(from_rock(2)) &
                             - eq%dt*eq%cells%injection(i))/eq%unit
         do k = 1, 2
            call eq%slopes%add_force(row, from_rock(k), -1.0_rk/eq%unit)
            call eq%slopes%add(row, jumps(k), &
                               0.5_rk*length*(1.0_rk + compression)/(eq%stiffness*eq%unit))
         end do
         call eq%slopes%add(row, row, length/eq%unit &
                            *(filled*compressibility*fluid%pressure_slope &
                              - fluid%void_slope*(1.0_rk + compression)))
      end associate
   end subroutine fill_balance

   !> Initial state, instead of exchange and balance: no flow, and cell i has the pressure of the
   !! adjacent rock, unless that is below the vapour pressure (fluid_at).
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
            conductance = abs(eq%volume_slope(side, i))
            eq%residual(row) = eq%force(at)/conductance
            call eq%slopes%add_force(row, at, 1.0_rk/conductance)
         end associate
      end do
      fluid = eq%layout%at_pressure(i)
      eq%residual(fluid) = x(fluid) - 0.5_rk*eq%share_of_rock*(x(faces(1)) + x(faces(2)))
      if (eq%share_of_rock < 1.0_rk) then
         eq%residual(fluid) = eq%residual(fluid) - (1.0_rk - eq%share_of_rock)*eq%held_pressure(i)
      end if
      call eq%slopes%add(fluid, fluid, 1.0_rk)
      do side = 1, 2
         call eq%slopes%add(fluid, faces(side), -0.5_rk*eq%share_of_rock)
      end do
   end subroutine fill_equilibrium

   !> Flow from the first to the second cell of pair k by the cubic law between their middles, and
   !! its terms in the balances of both. The residual has what a fluid law adds to the pressures.
   pure subroutine fill_flow(k, x, eq)
      integer(ik), intent(in) :: k
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(inout) :: eq
      type(cell_fluid_t) :: fluid(2)
      real(rk) :: aperture(2), drop, length(2), opening, resistance(2), slope(2), unused, weight(2)
      integer(ik) :: at(2), cells(2), end, jumps(2), m, other, row

      row = eq%layout%at_flow(k)
      cells = eq%paths%connections(:, k)
      at = eq%layout%at_pressure(cells)
      call find_way(cells, eq, length, weight)
      opening = 0.0_rk
      do end = 1, 2
         fluid(end) = eq%fluid_at(x, cells(end))
         opening = opening + weight(end)*eq%opening(x, cells(end))
      end do
      do end = 1, 2
         call conducting_aperture(eq%cells%residual_aperture(cells(end)), &
                                  eq%cells%roughness(cells(end)), opening, aperture(end), unused)
         resistance(end) = 12.0_rk*eq%viscosity_at(cells(end))*length(end)/aperture(end)**3 &
                           *eq%unit/eq%dt
      end do
      drop = fluid(1)%pressure - fluid(2)%pressure - eq%residual(row)
      eq%residual(row) = sum(resistance)*x(row) - drop
      slope = loss_slope(resistance*x(row), resistance/sum(resistance)*drop, aperture, &
                         eq%cells%residual_aperture(cells) - eq%cells%roughness(cells) + opening, &
                         eq%is_flat)
      do end = 1, 2
         call eq%slopes%add(row, row, resistance(end))
         do other = 1, 2
            jumps = eq%layout%at_jump(cells(other), both)
            do m = 1, 2
               call eq%slopes%add(row, jumps(m), 0.5_rk*slope(end)*weight(other)/eq%stiffness)
            end do
         end do
         associate (sign => real(2*end - 3, rk))
            call eq%slopes%add(row, at(end), sign*fluid(end)%pressure_slope)
            eq%residual(at(end)) = eq%residual(at(end)) - sign*x(row)
            call eq%slopes%add(at(end), row, -sign)
         end associate
      end do
   end subroutine fill_flow

   !> Slope by the opening of the loss of pressure R q of a flow, R ~ 1/a^3: the less steep one of
   !! the tangent and the secant to the aperture at which the loss equals the drop of pressure. At
   !! the solution both are the derivative. Where loss and drop have different signs no aperture
   !! makes them equal, and it is zero, as where the least aperture conducts and is too wide [Pa/m].
   elemental real(rk) function loss_slope(loss, drop, aperture, open, is_flat) result(slope)
      real(rk), intent(in) :: loss  !< R q [Pa]
      real(rk), intent(in) :: drop  !< of pressure along the flow [Pa]
      real(rk), intent(in) :: aperture  !< a, which conducts [m]
      real(rk), intent(in) :: open  !< less than a where the least aperture conducts [m]
      logical, intent(in) :: is_flat  !< the tangent is flatter, the less the loss is
      real(rk), parameter :: third = 1.0_rk/3.0_rk
      real(rk) :: a, b

      slope = 0.0_rk
      if (.not. (loss > 0.0_rk .eqv. drop > 0.0_rk)) return
      if (abs(loss) > abs(drop)) then
         a = abs(loss)**third
         b = abs(drop)**third
         if (open < aperture) then
            slope = -sign((abs(loss) - abs(drop))*b/(aperture*a - open*b), loss)
         else
            slope = -sign(b*(a**2 + a*b + b**2)/aperture, loss)
         end if
      else if (.not. open < aperture) then
         slope = -3.0_rk*loss/aperture
         if (is_flat .and. abs(loss) > 0.0_rk) slope = slope*(loss/drop)
      end if
   end function loss_slope

   !> Flow path from the middle of each of two neighbours to their common point: an equivalent
   !! length with the opening at this point, and this opening as a sum over the mean openings of
   !! both.
   !!
   !! In the cell of a grown tip, and in the one behind it, the opening is k sqrt(d), d the distance
   !! from the tip. Their volumes give k, 2/3 k d^(3/2) behind d. The tip advances at the speed V,
   !! and the flow through each section is V w, with the pressure gradient 12 mu V/(k^2 d): this is
   !! the flow V w at d_0, where the cells meet, through a length d_0 ln(d/d_0) with the opening at
   !! d_0. Where viscosity has an effect at the scale of the cells, the opening is that of
   !! coarse_tip_layer.
   pure subroutine find_way(cells, eq, length, weight)
      integer(ik), intent(in) :: cells(2)
      class(fracture_system_t), intent(in) :: eq
      real(rk), intent(out) :: length(2)  !< [m]
      real(rk), intent(out) :: weight(2)  !< [-]
      real(rk) :: behind, reach(2)
      integer(ik) :: tip

      reach = eq%cells%share(cells)*eq%condensed%length(cells)
      tip = findloc(eq%cells%has_tip(cells) .and. eq%cells%roughness(cells) > 0.0_rk, .true., dim=1)
      if (tip == 0) then
         length = 0.5_rk*reach
         weight = reach(2:1:-1)/(sum(reach)*eq%cells%share(cells))
      else
         behind = reach(3 - tip)
         length(tip) = reach(tip)*log(2.0_rk)
         length(3 - tip) = reach(tip)*log(1.0_rk + 0.5_rk*behind/reach(tip))
         weight = 1.5_rk*eq%condensed%length(cells)*sqrt(reach(tip)/sum(reach))/sum(reach)
         associate (b => eq%cells%viscous(cells(tip)), d => reach(tip))
            if (b > 0.0_rk) then
               length(tip) = pressure_shape(b, d) - pressure_shape(b, 0.5_rk*d)
               length(3 - tip) = pressure_shape(b, d + 0.5_rk*behind) - pressure_shape(b, d)
               length = length*opening_shape(b, d)**2
               weight = eq%condensed%length(cells)*opening_shape(b, d)/volume_shape(b, sum(reach))
            end if
         end associate
      end if
   end subroutine find_way

   !> Balance of joint j, without the flows of its branches; its equation is that of p_J.
   pure subroutine fill_joint(j, x, eq)
      integer(ik), intent(in) :: j
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(inout) :: eq
      type(cell_fluid_t) :: fluid
      real(rk) :: slope(2)  ! by the pressures of the joint and of its first cell
      integer(ik) :: at, cell, row

      row = eq%layout%at_joint(j)
      cell = eq%paths%joints%cell(eq%paths%joints%branches%at(j, 1_ik))
      at = eq%layout%at_pressure(cell)
      slope = 0.0_rk
      if (all(eq%paths%joints%is_shut(eq%paths%joints%branches%of(j)))) then
         fluid = eq%fluid_at(x, cell)
         eq%residual(row) = x(row) - fluid%pressure
         slope = [1.0_rk, -fluid%pressure_slope]
      else if (eq%paths%joints%is_outlet(j)) then
         eq%residual(row) = x(row) - eq%paths%joints%side_pressure(j)
         slope(1) = 1.0_rk
      else
         eq%residual(row) = -eq%dt*eq%paths%joints%injection(j)/eq%unit
      end if
      ! The places of the derivatives are the same in every state (coarse_slopes).
      call eq%slopes%add(row, row, slope(1))
      call eq%slopes%add(row, at, slope(2))
   end subroutine fill_joint

   !> Flow of branch b into its joint, and its terms in the balances of the cell and, except at an
   !! outlet, of the joint, which must be set already. The residual has what a fluid law adds.
   pure subroutine fill_branch(b, x, eq)
      integer(ik), intent(in) :: b
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(inout) :: eq
      real(rk) :: aperture, by_jump(2), by_pressure(2), drop, length, opening, resistance
      real(rk) :: unused, weight(2)
      type(cell_fluid_t) :: fluid
      integer(ik) :: at, cell, cells(2), end, joint, jumps(2), k, row
      logical :: ends_in_joint

      row = eq%layout%at_branch(b)
      cell = eq%paths%joints%cell(b)
      at = eq%layout%at_pressure(cell)
      joint = eq%layout%at_joint(eq%paths%joints%joint(b))
      call find_branch_way(b, eq, length, cells, weight)
      if (eq%paths%joints%is_shut(b)) then
         resistance = 1.0_rk
         by_pressure = 0.0_rk
         by_jump = 0.0_rk
         ends_in_joint = .false.
         eq%residual(row) = x(row)
      else
         fluid = eq%fluid_at(x, cell)
         opening = weight(1)*eq%opening(x, cells(1)) + weight(2)*eq%opening(x, cells(2))
         call conducting_aperture(eq%cells%residual_aperture(cell), eq%cells%roughness(cell), &
                                  opening, aperture, unused)
         resistance = 12.0_rk*eq%viscosity_at(cell)*length/aperture**3*eq%unit/eq%dt
         by_pressure = [1.0_rk, -fluid%pressure_slope]
         ends_in_joint = .not. eq%paths%joints%is_outlet(eq%paths%joints%joint(b))
         drop = fluid%pressure - x(joint) - eq%paths%joints%excess(b) - eq%residual(row)
         eq%residual(row) = resistance*x(row) - drop
         by_jump = 0.5_rk*loss_slope(resistance*x(row), drop, aperture, &
                                     eq%cells%residual_aperture(cell) - eq%cells%roughness(cell) &
                                     + opening, eq%is_flat)*weight/eq%stiffness
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

   !> Flow path from the middle of a branch's cell to the joint: its length, and the opening as a
   !! sum over the mean openings of two cells.
   pure subroutine find_branch_way(b, eq, length, cells, weight)
      integer(ik), intent(in) :: b  !< branch
      class(fracture_system_t), intent(in) :: eq
      real(rk), intent(out) :: length  !< [m]
      integer(ik), intent(out) :: cells(2)  !< the branch's, and that beyond the joint or the same
      real(rk), intent(out) :: weight(2)  !< [-]
      real(rk) :: reach(2)

      cells = eq%paths%joints%cell(b)
      if (eq%paths%joints%beyond(b) > 0) cells(2) = eq%paths%joints%beyond(b)
      reach = eq%cells%share(cells)*eq%condensed%length(cells)
      length = 0.5_rk*reach(1)*eq%paths%joints%way(b)
      weight = reach(2:1:-1)/(sum(reach)*eq%cells%share(cells))
   end subroutine find_branch_way

end module coarse_fracture_flow
