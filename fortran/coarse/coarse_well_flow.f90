!> The equations of wells whose rate depends on pressures (coarse_wells), one per well, for its flow
!! q into the fracture. With r = q + C (p_w - p_w,before)/dt, the rate into the well at its head,
!!   at a rate Q          r = Q
!!   at a pressure P      p_w = P
!!   at Q as far as P     0 <= r <= Q, p_w <= P where r > 0, p_w >= P where r < Q: in one equation
!!                        max(r - Q, min(p_w - P, r)) = 0; in extraction with all signs changed
!!   shut                 q = 0
!! with the storage C and the pressure at the head p_w = p + (R + R2 |q|) q. p is that of the cells
!! or the joint that the well supplies, by their shares, and the loss of q over the way to their
!! middles. All terms rise with q, so that Newton's method on the active one ends.
!!
!! A well with entries into several fractures supplies no cell itself. Each entry e has its flow q_e
!! as an unknown, with a loss R_e, and all entries have the pressure of the well:
!!   q = sum q_e,   p_e + R_e |q_e| q_e = p_1 + R_1 |q_1| q_1,   p = p_1 + R_1 |q_1| q_1
!! The entries of a well that is shut exchange fluid (cross-flow). Pressures here are relative to
!! the state in situ, so that the fluid in the well has the weight of that in the fractures.
!!
!! Under a limit the terms are compared as shares, of the rate and of the pressure. Above the limit
!! the latter is much reduced: a well that exceeds its limit at its rate is tried at the limit next,
!! one that would flow backwards there is tried without flow. Below the limit it is much enlarged:
!! such a well has its rate, whatever the last iterate made of r. Without this scaling the size of r
!! depends on the step, and in short steps wells alternated between their rate and no flow without
!! end.
module coarse_well_flow
   use base_kinds, only: ik, rk
   use coarse_fractures, only: conducting_aperture, fracture_system_t
   use coarse_wells, only: control_limited, control_pressure, control_rate, control_shut, &
                           slope_of_square
   implicit none(type, external)
   private

   public :: fill_well, find_entry_flows, find_well

   integer(ik), parameter :: both(2) = [1_ik, 2_ik]  !< ends of a cell

contains

   !> The equation of a well, and its terms in the balances of the cells and joints that it
   !! supplies, which must be set already.
   pure subroutine fill_well(w, x, eq)
      integer(ik), intent(in) :: w
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(inout) :: eq
      real(rk) :: by_flow, flow, per_head, per_flow, residual, head
      integer(ik) :: row

      row = eq%layout%at_well(w)
      flow = x(row)*eq%unit/eq%dt
      call find_head(w, x, eq, head, by_flow)
      call find_residual(w, eq, flow, head, residual, per_flow, per_head)
      eq%residual(row) = residual
      ! The places of the derivatives are the same in every state (coarse_slopes).
      call eq%slopes%add(row, row, per_flow*eq%unit/eq%dt + per_head*by_flow)
      if (eq%paths%wells%first_entry(w) > eq%paths%wells%n) then
         call fill_entries(w, per_head, x, eq)
      else
         call add_place(w, row, per_head, .true., x, eq)
      end if
   end subroutine fill_well

   !> The equations of the entries of a well, and the first one's terms in the equation of the well.
   !! That of the first is the sum of the flows, that of another one the equality of pressures. In
   !! the initial state nothing flows.
   pure subroutine fill_entries(w, per_head, x, eq)
      integer(ik), intent(in) :: w
      real(rk), intent(in) :: per_head  !< derivative of the well's equation by its head [-]
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(inout) :: eq
      real(rk) :: by_first, by_flow, in_well, pressure, weight
      integer(ik) :: at_first, first, k, row

      first = eq%paths%wells%first_entry(w)
      at_first = eq%layout%at_well(first)
      weight = merge(0.0_rk, 1.0_rk, eq%paths%settings%equilibrate)
      call find_entry(first, x, eq, in_well, by_first)
      call eq%slopes%add(eq%layout%at_well(w), at_first, per_head*by_first)
      call add_place(first, eq%layout%at_well(w), per_head, .true., x, eq)
      eq%residual(at_first) = weight*x(eq%layout%at_well(w)) - x(at_first)
      call eq%slopes%add(at_first, eq%layout%at_well(w), weight)
      call eq%slopes%add(at_first, at_first, -1.0_rk)
      do k = first + 1, eq%paths%wells%last_entry(w)
         row = eq%layout%at_well(k)
         eq%residual(at_first) = eq%residual(at_first) - weight*x(row)
         call eq%slopes%add(at_first, row, -weight)
         call find_entry(k, x, eq, pressure, by_flow)
         eq%residual(row) = weight*(pressure - in_well) + (1.0_rk - weight)*x(row)
         call eq%slopes%add(row, row, weight*by_flow + 1.0_rk - weight)
         call add_place(k, row, weight, .true., x, eq)
         call eq%slopes%add(row, at_first, -weight*by_first)
         call add_place(first, row, -weight, .false., x, eq)
      end do
   end subroutine fill_entries

   !> Derivatives of an equation that contains the pressure of a place, other than those by its
   !! flow; and this flow in the balances of the cells and joints there, once.
   pure subroutine add_place(place, row, per_pressure, is_supplied, x, eq)
      integer(ik), intent(in) :: place
      integer(ik), intent(in) :: row  !< of the equation
      real(rk), intent(in) :: per_pressure  !< its derivative by that pressure [-]
      logical, intent(in) :: is_supplied
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(inout) :: eq
      integer(ik) :: at, flow, i, j

      flow = eq%layout%at_well(place)
      do i = 1, eq%layout%n_cells
         if (.not. eq%paths%wells%share(i, place) > 0.0_rk) cycle
         associate (share => eq%paths%wells%share(i, place))
            at = eq%layout%at_pressure(i)
            if (is_supplied) then
               eq%residual(at) = eq%residual(at) - share*x(flow)
               call eq%slopes%add(at, flow, -share)
            end if
            call eq%slopes%add(row, at, per_pressure*share)
            if (eq%paths%wells%path(i, place) > 0.0_rk) then
               call add_opening(place, row, i, x, per_pressure, eq)
            end if
         end associate
      end do
      do j = 1, eq%layout%n_joints
         if (.not. eq%paths%wells%joint_share(j, place) > 0.0_rk) cycle
         associate (share => eq%paths%wells%joint_share(j, place))
            at = eq%layout%at_joint(j)
            ! An outlet has the pressure of its side.
            if (is_supplied .and. .not. eq%paths%joints%is_outlet(j)) then
               eq%residual(at) = eq%residual(at) - share*x(flow)
               call eq%slopes%add(at, flow, -share)
            end if
            call eq%slopes%add(row, at, per_pressure*share)
         end associate
      end do
   end subroutine add_place

   !> The active condition: control_rate, control_pressure, or control_shut without flow into the
   !! well. Without storage the head follows from that of another flow by the losses: at the rate it
   !! would be beyond the limit, and without flow it would not.
   pure integer(ik) function condition_of(w, eq, flow, head) result(condition)
      integer(ik), intent(in) :: w
      class(fracture_system_t), intent(in) :: eq
      real(rk), intent(in) :: flow  !< [m2/s]
      real(rk), intent(in) :: head  !< [Pa]
      real(rk), parameter :: weight = 0.1_rk  ! of the pressure's share, which is 2 at most
      real(rk), parameter :: within = 1.0e3_rk  ! of it below the limit, where the rate is held
      real(rk) :: beyond(2), heads(2), share

      associate (wells => eq%paths%wells)
         condition = wells%control(w)
         if (condition /= control_limited) return
         share = (flow + wells%storage(w)*(head - eq%before%well_head(w))/eq%dt)/wells%rate(w)
         heads = head
         if (.not. wells%storage(w) > 0.0_rk) then
            heads = head - wells%resistance(w, flow)*flow
            heads(1) = heads(1) + wells%resistance(w, wells%rate(w))*wells%rate(w)
         end if
         beyond = weight*sign(1.0_rk, wells%rate(w))*(heads - wells%pressure(w)) &
                  /max(abs(heads), abs(wells%pressure(w)), tiny(1.0_rk))
         where (beyond < 0.0_rk) beyond = within*beyond
         condition = control_rate
         if (share - 1.0_rk < min(beyond(1), share)) then
            condition = merge(control_pressure, control_shut, beyond(2) < share)
         end if
      end associate
   end function condition_of

   !> Residual of the active condition, and its derivatives. In short steps the volume that flows in
   !! excess is negligible long before the loss of pressure that goes with it, hence the factor.
   pure subroutine find_residual(w, eq, flow, head, residual, per_flow, per_head)
      integer(ik), intent(in) :: w
      class(fracture_system_t), intent(in) :: eq
      real(rk), intent(in) :: flow  !< [m2/s]
      real(rk), intent(in) :: head  !< [Pa]
      real(rk), intent(out) :: residual  !< [Pa]
      real(rk), intent(out) :: per_flow  !< [Pa s/m2]
      real(rk), intent(out) :: per_head  !< [-]
      real(rk) :: factor, resistance, scale

      scale = eq%dt/eq%unit
      associate (wells => eq%paths%wells, condition => condition_of(w, eq, flow, head))
         per_head = wells%storage(w)/eq%unit
         resistance = wells%resistance(w, wells%rate(w))
         factor = 1.0_rk + resistance/(scale + per_head*resistance)
         scale = factor*scale
         per_head = factor*per_head
         per_flow = merge(0.0_rk, scale, condition == control_pressure)
         if (condition == control_pressure) per_head = 1.0_rk
         if (wells%control(w) == control_shut) per_head = 0.0_rk
         residual = per_flow*flow + per_head*(head - eq%before%well_head(w))
         select case (condition)
         case (control_pressure)
            residual = head - wells%pressure(w)
         case (control_rate)
            residual = residual - scale*wells%rate(w)
         case default
            continue
         end select
      end associate
   end subroutine find_residual

   !> Flow, head and rate of a well in a solution. Prescribed values are exact: flows of shut wells
   !! of the size of rounding errors would otherwise affect the time steps.
   pure subroutine find_well(w, x, eq, flow, head, rate)
      integer(ik), intent(in) :: w
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(in) :: eq
      real(rk), intent(out) :: flow  !< into the fracture [m2/s]
      real(rk), intent(out) :: head  !< pressure there [Pa]
      real(rk), intent(out) :: rate  !< into the well at its head, mean of the step [m2/s]
      real(rk) :: by_flow

      call find_head(w, x, eq, head, by_flow)
      flow = x(eq%layout%at_well(w))*eq%unit/eq%dt
      associate (wells => eq%paths%wells, rise => head - eq%before%well_head(w))
         select case (condition_of(w, eq, flow, head))
         case (control_rate)
            rate = wells%rate(w)
            if (.not. wells%storage(w) > 0.0_rk) flow = rate
         case (control_pressure)
            rate = flow + wells%storage(w)*rise/eq%dt
         case default
            rate = 0.0_rk
            if (wells%control(w) == control_shut .or. .not. wells%storage(w) > 0.0_rk) flow = 0.0_rk
         end select
      end associate
   end subroutine find_well

   !> Flows of the entries of a well in a solution. What rounding leaves of the sum of flows, which
   !! is prescribed, is distributed evenly.
   pure subroutine find_entry_flows(w, x, eq, flow)
      integer(ik), intent(in) :: w
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(in) :: eq
      real(rk), intent(inout) :: flow(:)  !< well_flow of state_t, with that of the well [m2/s]
      integer(ik) :: first, last

      first = eq%paths%wells%first_entry(w)
      last = eq%paths%wells%last_entry(w)
      if (first == w) return
      associate (of_entries => flow(eq%paths%wells%n_all - eq%paths%wells%n + first: &
                                    eq%paths%wells%n_all - eq%paths%wells%n + last))
         of_entries = x(eq%layout%at_well(first):eq%layout%at_well(last))*eq%unit/eq%dt
         of_entries = of_entries + (flow(w) - sum(of_entries))/size(of_entries)
      end associate
   end subroutine find_entry_flows

   !> The pressure at the well's head, and its derivative by the unknown of the well's flow.
   pure subroutine find_head(w, x, eq, head, by_flow)
      integer(ik), intent(in) :: w
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(in) :: eq
      real(rk), intent(out) :: head  !< [Pa]
      real(rk), intent(out) :: by_flow  !< [-]
      real(rk) :: in_well, unused
      integer(ik) :: first

      associate (per_x => eq%unit/eq%dt, flow => x(eq%layout%at_well(w))*eq%unit/eq%dt)
         call eq%paths%wells%lost(w, flow, head, by_flow)
         first = eq%paths%wells%first_entry(w)
         if (first == w) then
            call add_pressure(w, flow, x, eq, head, by_flow)
         else
            call find_entry(first, x, eq, in_well, unused)
            head = head + in_well
         end if
         by_flow = by_flow*per_x
      end associate
   end subroutine find_head

   !> Pressure in the well at an entry, and its derivative by the unknown of the entry's flow.
   pure subroutine find_entry(entry, x, eq, pressure, by_flow)
      integer(ik), intent(in) :: entry  !< its number among the places
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(in) :: eq
      real(rk), intent(out) :: pressure  !< [Pa]
      real(rk), intent(out) :: by_flow  !< [-]

      associate (flow => x(eq%layout%at_well(entry))*eq%unit/eq%dt, &
                 loss => eq%paths%wells%entry_loss(entry - eq%paths%wells%n))
         pressure = loss*abs(flow)*flow
         by_flow = slope_of_square(loss, flow)
         call add_pressure(entry, flow, x, eq, pressure, by_flow)
      end associate
      by_flow = by_flow*eq%unit/eq%dt
   end subroutine find_entry

   !> Add the pressure of a place: that of its cells or joint, with the loss of its flow over the
   !! way to them.
   pure subroutine add_pressure(place, flow, x, eq, pressure, by_flow)
      integer(ik), intent(in) :: place
      real(rk), intent(in) :: flow  !< [m2/s]
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(in) :: eq
      real(rk), intent(inout) :: pressure  !< [Pa]
      real(rk), intent(inout) :: by_flow  !< [Pa s/m2]
      real(rk) :: resistance, slope
      integer(ik) :: i, j

      do i = 1, eq%layout%n_cells
         associate (share => eq%paths%wells%share(i, place), path => eq%paths%wells%path(i, place))
            if (.not. share > 0.0_rk) cycle
            pressure = pressure + share*x(eq%layout%at_pressure(i))
            if (.not. path > 0.0_rk) cycle
            call half_cell(i, x, eq, resistance, slope)
            pressure = pressure + path*resistance*flow
            by_flow = by_flow + path*resistance
         end associate
      end do
      do j = 1, eq%layout%n_joints
         pressure = pressure + eq%paths%wells%joint_share(j, place)*x(eq%layout%at_joint(j))
      end do
   end subroutine add_pressure

   !> Resistance of half a cell, and its derivative by the opening.
   pure subroutine half_cell(i, x, eq, resistance, slope)
      integer(ik), intent(in) :: i
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(fracture_system_t), intent(in) :: eq
      real(rk), intent(out) :: resistance  !< [Pa s/m2]
      real(rk), intent(out) :: slope  !< [Pa s/m3]
      real(rk) :: aperture, thickness, unused

      call conducting_aperture(eq%cells%residual_aperture(i), eq%cells%roughness(i), &
                               eq%opening(x, i), aperture, slope)
      resistance = 6.0_rk*eq%viscosity_at(i)*eq%condensed%length(i)/aperture**3
      if (allocated(eq%paths%settings%fluid_law)) then
         call eq%find_thickness(x, i, thickness, unused)
         resistance = resistance*thickness
      end if
      slope = -3.0_rk*resistance/aperture*slope
   end subroutine half_cell

   !> Derivatives of the resistance of half a cell by its opening, and by its pressure with a fluid
   !! law.
   pure subroutine add_opening(place, row, i, x, per_pressure, eq)
      integer(ik), intent(in) :: place
      integer(ik), intent(in) :: row  !< of an equation
      integer(ik), intent(in) :: i  !< cell
      real(rk), intent(in) :: x(:)  !< [Pa]
      real(rk), intent(in) :: per_pressure  !< its derivative by the pressure of the place [-]
      class(fracture_system_t), intent(inout) :: eq
      real(rk) :: by_jump, resistance, slope
      real(rk) :: by_pressure, thickness
      integer(ik) :: end, jumps(2)

      jumps = eq%layout%at_jump(i, both)
      call half_cell(i, x, eq, resistance, slope)
      by_jump = 0.5_rk*eq%paths%wells%path(i, place)*slope*x(eq%layout%at_well(place)) &
                *eq%unit/eq%dt/eq%stiffness
      do end = 1, 2
         call eq%slopes%add(row, jumps(end), per_pressure*by_jump)
      end do
      if (.not. allocated(eq%paths%settings%fluid_law)) return
      call eq%find_thickness(x, i, thickness, by_pressure)
      by_pressure = eq%paths%wells%path(i, place)*resistance*by_pressure/thickness &
                    *x(eq%layout%at_well(place))*eq%unit/eq%dt
      call eq%slopes%add(row, eq%layout%at_pressure(i), per_pressure*by_pressure)
   end subroutine add_opening

end module coarse_well_flow
