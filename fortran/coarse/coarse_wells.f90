!> Wells whose rate depends on pressures: a pressure is prescribed, or limits a rate, or the well
!! itself stores fluid. Those in fractures have their flow into these as an unknown of the step
!! (coarse_well_flow), those in the rock are part of its matrix. Wells that inject at a prescribed
!! rate are not among them, but are sources of their cells.
!!
!! The well's pressure is that at its head, without the weight of its fluid: the pressure of
!! fracture or rock at the well, plus the pressure loss of the flow to this point.
!!
!! Wells in the rock whose rate depends on pressures. A well at p_w in a cell of the pressure p_c
!! supplies it with q = w (p_w - p_0 - p_c), with a well index w that depends on the length of the
!! step and includes the pressure loss in the well, and with what is left of the flow before, p_0
!! (coarse_well_rings). Under each control this is a source less a conductance times p_c, so it is
!! part of the matrix of the rock and no unknown:
!!   at a pressure P    q = w (P - p_0 - p_c)
!!   at a rate Q        q + C (p_w - p_w,before)/dt = Q with the storage C of the well
!! The control under a limit is tried: a step whose result contradicts it is repeated.
module coarse_wells
   use base_kinds, only: ik, pi, rk
   use base_tolerances, only: same_value
   use coarse_matrix, only: matrix_t
   use coarse_well_rings, only: well_rings_t
   implicit none(type, external)
   private

   public :: control_limited, control_pressure, control_rate, control_shut, rock_wells_t
   public :: slope_of_square, well_index, wells_t

   integer(ik), parameter :: control_shut = 0  !< nothing flows
   integer(ik), parameter :: control_rate = 1  !< into the well at its head
   integer(ik), parameter :: control_pressure = 2
   integer(ik), parameter :: control_limited = 3  !< a rate, as far as pressure allows

   type :: wells_t
      integer(ik) :: n = 0  !< in fractures
      integer(ik) :: n_all = 0  !< these first, then those in the rock
      integer(ik), allocatable :: number(:)  !< (n_all) among all wells of the scene
      ! Places with a flow: those of the n wells, of which none counts whose well has entries, then
      ! the entries.
      integer(ik) :: n_entries = 0
      integer(ik), allocatable :: of_entry(:)  !< (n_entries) the well of each, among the n
      real(rk), allocatable :: entry_loss(:)  !< (n_entries) R in the loss R |q| q [Pa s2/m4]
      real(rk), allocatable :: share(:, :)  !< (fracture cells, places) of its flow, into each [-]
      real(rk), allocatable :: joint_share(:, :)  !< (joints, places) [-]
      !> (fracture cells, places) pressure of the place above that of its cells, over the loss of
      !! its flow in half of each of them [-]
      real(rk), allocatable :: path(:, :)
      integer(ik), allocatable :: entry(:)  !< (places) among all entries; 0: those of its entries
      real(rk), allocatable :: storage(:)  !< (n_all) [m2/Pa]
      real(rk), allocatable :: friction(:)  !< (n_all) pressure lost per flow [Pa s/m2]
      real(rk), allocatable :: turbulence(:)  !< (n_all) and per its square [Pa s2/m4]
      !> (n_all) pressure in situ, to which pressures are relative; unallocated: 0 [Pa]
      real(rk), allocatable :: pressure_in_situ(:)
      ! In the present step:
      integer(ik), allocatable :: control(:)  !< (n_all)
      real(rk), allocatable :: rate(:)  !< (n_all) prescribed; negative: extraction [m2/s]
      real(rk), allocatable :: pressure(:)  !< (n_all) prescribed, or the limit [Pa]
   contains
      procedure :: lost
      procedure :: at_places
      procedure :: first_flows
      procedure :: allowed_flow
      procedure :: flow_number
      procedure :: first_entry
      procedure :: last_entry
      procedure :: entries_loss
      procedure :: resistance
      procedure :: is_at_limit
   end type wells_t

   !> Pressure-controlled wells in the rock, the last ones of wells_t.
   type :: rock_wells_t
      integer(ik) :: n = 0
      integer(ik), allocatable :: cell(:)  !< (n)
      real(rk), allocatable :: index(:)  !< (n) flow per p_w - p_0 - p_c [m2/(Pa s)]
      real(rk), allocatable :: left_over(:)  !< (n) p_0 [Pa]
      ! All wells in the rock:
      type(well_rings_t), allocatable :: rings(:)
      integer(ik), allocatable :: ring_number(:)  !< (rings) among all wells of the scene
      integer(ik), allocatable :: ring_of(:)  !< (n) ring of each pressure-controlled well
      real(rk), allocatable :: ring_flow(:)  !< (rings) prescribed in the present step [m2/s]
      real(rk), allocatable :: source(:)  !< (n) q of the step where p_c is 0 [m2/s]
      !> (n) decrease of q per p_c, part of the matrix [m2/(Pa s)]
      real(rk), allocatable :: conductance(:)
      real(rk), allocatable :: rock(:)  !< (n) entries of the matrix without wells [m2/(Pa s)]
      !> (n) control that is tried: control_shut, _rate or _pressure
      integer(ik), allocatable :: control(:)
   contains
      procedure :: beyond_cell
      procedure :: find_indices
      procedure :: update_rings
      procedure :: choose_controls
      procedure :: set_terms
      procedure :: take_place
      procedure :: find_flows
      procedure :: correct_controls
   end type rock_wells_t

contains

   !> Pressure loss in the well at a flow, and its derivative, for Newton's method.
   pure subroutine lost(self, well, flow, pressure, slope)
      class(wells_t), intent(in) :: self
      integer(ik), intent(in) :: well
      real(rk), intent(in) :: flow  !< into the fracture [m2/s]
      real(rk), intent(out) :: pressure  !< [Pa]
      real(rk), intent(out) :: slope  !< [Pa s/m2]

      pressure = (self%friction(well) + self%turbulence(well)*abs(flow))*flow
      slope = self%friction(well) + slope_of_square(self%turbulence(well), flow)
   end subroutine lost

   !> Resistance to a flow, losses of the well and of its entries over the flow [Pa s/m2].
   pure real(rk) function resistance(self, well, flow)
      class(wells_t), intent(in) :: self
      integer(ik), intent(in) :: well
      real(rk), intent(in) :: flow  !< into the fractures [m2/s]

      resistance = self%friction(well) + self%turbulence(well)*abs(flow)
      if (well <= self%n) resistance = resistance + self%entries_loss(well)*abs(flow)
   end function resistance

   !> Derivative of a loss R |q| q. As flows round a loop of wells and fractures depend on losses
   !! alone, it is not less than that where the loss is negligible.
   elemental real(rk) function slope_of_square(loss, flow) result(slope)
      real(rk), intent(in) :: loss  !< R [Pa s2/m4]
      real(rk), intent(in) :: flow  !< q [m2/s]
      real(rk), parameter :: negligible = 1.0e-6_rk  ! [Pa]

      slope = 2.0_rk*max(loss*abs(flow), sqrt(loss*negligible))
   end function slope_of_square

   !> The flows of the places among those of a state, whose wells in the rock stand before the
   !! entries.
   pure function at_places(self, well_flow) result(flow)
      class(wells_t), intent(in) :: self
      real(rk), intent(in) :: well_flow(:)  !< of state_t [m2/s]
      real(rk) :: flow(self%n + self%n_entries)  !< [m2/s]

      flow = [well_flow(:self%n), well_flow(self%n_all + 1:)]
   end function at_places

   !> The flows of the places from which the iteration of a step begins: those before it, and a
   !! change of the rate distributed by the losses of the entries; where nothing flows yet, the rate
   !! that is prescribed or that the losses allow at a prescribed pressure. Losses by the square of
   !! the flow have no derivative there, and Newton's method would begin as if there were none.
   pure function first_flows(self, well_flow, well_head, dt) result(flow)
      class(wells_t), intent(in) :: self
      real(rk), intent(in) :: well_flow(:)  !< of state_t [m2/s]
      real(rk), intent(in) :: well_head(:)  !< of state_t [Pa]
      real(rk), intent(in) :: dt  !< [s]
      real(rk) :: flow(self%n + self%n_entries)  !< [m2/s]
      real(rk) :: loss, rate
      logical :: follows
      integer(ik) :: w

      flow = self%at_places(well_flow)
      do w = 1, self%n
         loss = self%entries_loss(w)
         if (.not. (loss > 0.0_rk .or. self%turbulence(w) > 0.0_rk)) cycle
         rate = self%allowed_flow(w, well_head(w), dt)
         follows = self%control(w) == control_shut .or. (self%control(w) == control_rate &
                                                         .and. .not. self%storage(w) > 0.0_rk)
         associate (of_entries => flow(self%first_entry(w):self%last_entry(w)))
            if (any(abs(of_entries) > 0.0_rk) .and. .not. follows) cycle
            if (loss > 0.0_rk) then
               of_entries = of_entries + (rate - flow(w)) &
                            *sqrt(loss/pack(self%entry_loss, self%of_entry == w))
            end if
            flow(w) = rate
         end associate
      end do
   end function first_flows

   !> The prescribed rate of a well, or the flow that loses the rise of the head to the prescribed
   !! pressure, as far as the storage of the well lets the head rise in a step of length dt [m2/s].
   pure real(rk) function allowed_flow(self, well, head, dt) result(flow)
      class(wells_t), intent(in) :: self
      integer(ik), intent(in) :: well  !< among the n in fractures, with a loss by squares
      real(rk), intent(in) :: head  !< before the step [Pa]
      real(rk), intent(in) :: dt  !< [s]
      real(rk), parameter :: small = 1.0e-6_rk  ! rise that other wells may cause, over the pressure
      real(rk) :: change, direction, other, rise

      other = small*abs(head)
      if (allocated(self%pressure_in_situ)) other = small*abs(head + self%pressure_in_situ(well))
      associate (rate => self%rate(well), control => self%control(well), linear => &
                 self%friction(well), square => self%resistance(well, 1.0_rk) - self%friction(well))
         flow = merge(0.0_rk, rate, control == control_shut)
         change = rate
         if (control == control_pressure) change = self%pressure(well) - head
         direction = sign(1.0_rk, change)
         rise = merge(direction*(self%pressure(well) - head), huge(1.0_rk), &
                      control == control_pressure .or. control == control_limited)
         if (control /= control_pressure .and. self%storage(well) > 0.0_rk) then
            rise = min(rise, max(other, abs(rate)*dt/self%storage(well)))
         end if
         if (.not. rise < huge(1.0_rk)) return
         rise = max(0.0_rk, rise)
         flow = 2.0_rk*rise/max(tiny(1.0_rk), linear + sqrt(linear**2 + 4.0_rk*square*rise))
         if (control /= control_pressure) flow = min(abs(rate), flow)
         flow = direction*flow
      end associate
   end function allowed_flow

   !> The well of each flow of a state, among all wells of the scene.
   pure function flow_number(self) result(number)
      class(wells_t), intent(in) :: self
      integer(ik) :: number(self%n_all + self%n_entries)

      number(:self%n_all) = self%number
      if (self%n_entries > 0) number(self%n_all + 1:) = self%number(self%of_entry)
   end function flow_number

   !> Place of the first entry of a well; without entries that of the well itself.
   pure integer(ik) function first_entry(self, well)
      class(wells_t), intent(in) :: self
      integer(ik), intent(in) :: well  !< among the n in fractures

      first_entry = well
      if (self%n_entries == 0) return
      if (any(self%of_entry == well)) first_entry = self%n + findloc(self%of_entry, well, dim=1, &
                                                                     kind=ik)
   end function first_entry

   !> Place of its last entry.
   pure integer(ik) function last_entry(self, well)
      class(wells_t), intent(in) :: self
      integer(ik), intent(in) :: well  !< among the n in fractures

      last_entry = self%first_entry(well)
      if (last_entry > self%n) last_entry = last_entry + count(self%of_entry == well, kind=ik) - 1
   end function last_entry

   !> R of all entries of a well together, where the fractures have the same pressure: the flows are
   !! as 1/sqrt(R) [Pa s2/m4].
   pure real(rk) function entries_loss(self, well) result(loss)
      class(wells_t), intent(in) :: self
      integer(ik), intent(in) :: well

      loss = 0.0_rk
      if (self%n_entries == 0) return
      if (.not. any(self%of_entry == well)) return
      if (any(self%of_entry == well .and. .not. self%entry_loss > 0.0_rk)) return
      loss = 1.0_rk/sum(1.0_rk/sqrt(self%entry_loss), mask=self%of_entry == well)**2
   end function entries_loss

   !> Whether a limited well is at its pressure limit, with less than its rate.
   pure logical function is_at_limit(self, well, rate, head)
      class(wells_t), intent(in) :: self
      integer(ik), intent(in) :: well
      real(rk), intent(in) :: rate  !< into the well, at its head [m2/s]
      real(rk), intent(in) :: head  !< pressure there [Pa]
      real(rk), parameter :: rounding(2) = [1.0e-9_rk, 1.0e-6_rk]  ! of the rate, of the pressure
      real(rk) :: in_situ

      is_at_limit = .false.
      if (self%control(well) /= control_limited) return
      in_situ = 0.0_rk
      if (allocated(self%pressure_in_situ)) in_situ = self%pressure_in_situ(well)
      associate (limit => self%pressure(well))
         is_at_limit = rate/self%rate(well) < 1.0_rk - rounding(1) .and. &
                       sign(1.0_rk, self%rate(well))*(head - limit) &
                       >= -rounding(2)*max(abs(head + in_situ), abs(limit + in_situ))
      end associate
   end function is_at_limit

   !> Index of a well in a triangle: q mu/(2 pi K) ln(r_c/r_w) is p_w - p_c, where a well that the
   !! whole triangle stands for has the pressure p_c at r_c = 0.151 times the root of its area: the
   !! mean of 40 places in five meshes, all within 0.002 (verification/wells_in_rock) [m2/(Pa s)].
   elemental real(rk) function well_index(radius, area, mobility)
      real(rk), intent(in) :: radius  !< r_w [m]
      real(rk), intent(in) :: area  !< of the triangle [m2]
      real(rk), intent(in) :: mobility  !< K/mu [m2/(Pa s)]
      real(rk), parameter :: radius_of_cell = 0.151_rk

      well_index = 2.0_rk*pi*mobility/log(radius_of_cell*sqrt(area)/radius)
   end function well_index

   !> Pressure of a well less that of its cell; none before there are rings [Pa].
   pure real(rk) function beyond_cell(self, well, flow, pressure)
      class(rock_wells_t), intent(in) :: self
      integer(ik), intent(in) :: well  !< among all of the scene
      real(rk), intent(in) :: flow  !< of the step to the present state [m2/s]
      real(rk), allocatable, intent(in) :: pressure(:, :)  !< (ring_count, rings) [Pa]
      integer(ik) :: k

      beyond_cell = 0.0_rk
      if (.not. allocated(pressure)) return
      k = findloc(self%ring_number, well, dim=1, kind=ik)
      beyond_cell = self%rings(k)%beyond_cell(flow, pressure(:, k))
   end function beyond_cell

   !> Indices of the wells for a step, and what is left of the flow before it.
   pure subroutine find_indices(self, wells, dt, pressure)
      class(rock_wells_t), intent(inout) :: self
      type(wells_t), intent(in) :: wells
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: pressure(:, :)  !< (ring_count, rings) before the step [Pa]
      integer(ik) :: w

      do w = 1, self%n
         associate (rings => self%rings(self%ring_of(w)))
            ! The loss in the well is a resistance in series.
            self%index(w) = 1.0_rk/(rings%resistance(dt) + wells%friction(wells%n + w))
            self%left_over(w) = rings%left_over(dt, pressure(:, self%ring_of(w)))
         end associate
      end do
   end subroutine find_indices

   !> The rings of all wells after a step.
   pure subroutine update_rings(self, dt, flow, pressure)
      class(rock_wells_t), intent(in) :: self
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: flow(:)  !< (n) of the pressure-controlled wells [m2/s]
      real(rk), intent(inout) :: pressure(:, :)  !< (ring_count, rings) [Pa]
      real(rk) :: all(size(pressure, 2))
      integer :: k

      all = self%ring_flow
      if (self%n > 0) all(self%ring_of) = flow
      do k = 1, size(all)
         call self%rings(k)%take_in(dt, all(k), pressure(:, k))
      end do
   end subroutine update_rings

   !> The controls that are tried first: those prescribed, or under a limit those of the last step.
   pure subroutine choose_controls(self, wells, last)
      class(rock_wells_t), intent(inout) :: self
      type(wells_t), intent(in) :: wells
      integer(ik), intent(in) :: last(:)  !< (n) of the last step

      associate (control => wells%control(wells%n + 1:))
         self%control = merge(control, last, control /= control_limited)
      end associate
   end subroutine choose_controls

   !> Sources of a step of length dt, and conductances in the matrix.
   pure subroutine set_terms(self, wells, dt, head_before, matrix, any_changed)
      class(rock_wells_t), intent(inout) :: self
      type(wells_t), intent(in) :: wells
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: head_before(:)  !< (n) p_w before it [Pa]
      type(matrix_t), intent(inout) :: matrix
      logical, intent(out) :: any_changed  !< in the matrix
      real(rk) :: conductance, rate, stored
      integer(ik) :: at, w

      any_changed = .false.
      self%source = spread(0.0_rk, 1, int(self%n))
      if (.not. allocated(self%rock)) then
         self%rock = [(matrix%flow(matrix%columns%last(self%cell(w))), w=1, self%n)]
      end if
      do w = 1, self%n
         at = wells%n + w
         conductance = 0.0_rk
         if (wells%control(at) /= control_shut) then
            associate (index => self%index(w))
               if (self%control(w) == control_pressure) then
                  self%source(w) = index*(wells%pressure(at) - self%left_over(w))
                  conductance = index
               else
                  ! Under a limit nothing may flow.
                  rate = merge(wells%rate(at), 0.0_rk, self%control(w) == control_rate)
                  stored = wells%storage(at)/dt
                  self%source(w) = index*(rate + stored*(head_before(w) - self%left_over(w))) &
                                   /(stored + index)
                  conductance = index*stored/(stored + index)
               end if
            end associate
         end if
         if (.not. abs(conductance - self%conductance(w)) > 0.0_rk) cycle
         any_changed = .true.
         self%conductance(w) = conductance
      end do
      if (any_changed) call self%take_place(matrix)
   end subroutine set_terms

   !> Write the conductances into the matrix.
   pure subroutine take_place(self, matrix)
      class(rock_wells_t), intent(in) :: self
      type(matrix_t), intent(inout) :: matrix
      integer(ik) :: w

      if (.not. allocated(self%rock)) return
      do w = 1, self%n
         matrix%flow(matrix%columns%last(self%cell(w))) = &
            self%rock(w) - sum(self%conductance, mask=self%cell == self%cell(w))
      end do
   end subroutine take_place

   !> Flows, heads and rates at the pressures of the cells.
   pure subroutine find_flows(self, wells, dt, head_before, pressure, flow, head, rate)
      class(rock_wells_t), intent(in) :: self
      type(wells_t), intent(in) :: wells
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: head_before(:)  !< (n) p_w before the step [Pa]
      real(rk), intent(in) :: pressure(:)  !< (cells) [Pa]
      real(rk), intent(out) :: flow(:)  !< (n) q [m2/s]
      real(rk), intent(out) :: head(:)  !< (n) p_w [Pa]
      real(rk), intent(out) :: rate(:)  !< (n) into the well at its head [m2/s]

      flow = self%source - self%conductance*pressure(self%cell)
      head = pressure(self%cell) + self%left_over + flow/self%index
      rate = flow + wells%storage(wells%n + 1:)*(head - head_before)/dt
      ! Prescribed rates are exact.
      where (self%control == control_shut) rate = 0.0_rk
      where (self%control == control_rate) rate = wells%rate(wells%n + 1:)
   end subroutine find_flows

   !> Change the controls that the result of the step contradicts by more than rounding: all of them
   !! at once, or where that does not end the first one (Murty 1974).
   pure subroutine correct_controls(self, wells, head, rate, one_by_one, any_changed)
      class(rock_wells_t), intent(inout) :: self
      type(wells_t), intent(in) :: wells
      real(rk), intent(in) :: head(:), rate(:)  !< of find_flows [Pa], [m2/s]
      logical, intent(in) :: one_by_one
      logical, intent(out) :: any_changed
      integer(ik) :: at, before, w
      real(rk) :: beyond, share

      any_changed = .false.
      do w = 1, self%n
         at = wells%n + w
         if (wells%control(at) /= control_limited) cycle
         before = self%control(w)
         beyond = sign(1.0_rk, wells%rate(at))*(head(w) - wells%pressure(at)) &
                  /max(abs(head(w)), abs(wells%pressure(at)), tiny(1.0_rk))
         share = rate(w)/wells%rate(at)
         associate (control => self%control(w))
            select case (before)
            case (control_rate)
               if (beyond > same_value) control = control_pressure
            case (control_pressure)
               if (share > 1.0_rk + same_value) control = control_rate
               if (share < -same_value) control = control_shut
            case default
               if (beyond < -same_value) control = control_pressure
            end select
            any_changed = any_changed .or. control /= before
         end associate
         if (any_changed .and. one_by_one) return
      end do
   end subroutine correct_controls

end module coarse_wells
