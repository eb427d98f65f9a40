!> What wells do, well by well: rows of wells.csv.
module twolevel_well_rows
   use base_kinds, only: ik, rk
   use coarse_wells, only: well_index
   use mesh_geometry, only: cell_area
   use report_rows, only: well_row_t
   use twolevel_state, only: two_levels_t
   use twolevel_wells, only: between_cells, rate
   implicit none(type, external)
   private

   public :: well_books_t, well_flows, well_pressures

   !> Sums and first values, (wells).
   type :: well_books_t
      real(rk), allocatable, private :: injected(:)  !< at their heads so far [m2]
      real(rk), allocatable, private :: first_pressure(:)  !< [Pa]
   contains
      procedure :: begin
      procedure :: book
   end type well_books_t

contains

   !> The state before the first step.
   subroutine begin(self, levels)
      class(well_books_t), intent(out) :: self
      class(two_levels_t), intent(in) :: levels
      integer(ik) :: w

      associate (n => size(levels%scene%injections, kind=ik))
         allocate (self%injected(n), source=0.0_rk)
         self%first_pressure = [(pressure_at(levels, w, 0.0_rk), w=1, n)]
      end associate
   end subroutine begin

   !> The state after a step of length dt; dt = 0: there has been none.
   subroutine book(self, levels, dt, rows)
      class(well_books_t), intent(inout) :: self
      class(two_levels_t), intent(in) :: levels
      real(rk), intent(in) :: dt  !< [s]
      type(well_row_t), allocatable, intent(out) :: rows(:)
      integer(ik) :: w

      associate (wells => levels%scene%injections)
         allocate (rows(size(wells)))
         do w = 1, size(wells, kind=ik)
            associate (row => rows(w))
               row%time = levels%state%time
               row%name = trim(wells(w)%name)
               row%stage = 0
               if (dt > 0.0_rk) then
                  row%stage = wells(w)%stage_at(row%time - 0.5_rk*dt)
                  row%flow = rate(wells(w), row%time - dt, dt)
               end if
               if (row%stage > 0 .and. allocated(wells(w)%rate)) then
                  row%asked = wells(w)%rate(row%stage)
               end if
               row%rate = row%flow
               row%control = "rate"
               call set_controlled(levels, w, row)
               if (row%stage == 0) row%control = "shut"
               row%pressure = pressure_at(levels, w, row%flow)
               if (.not. wells(w)%is_controlled()) row%head_pressure = row%pressure &
                  & + (wells(w)%friction + wells(w)%turbulence*abs(row%flow))*row%flow
               self%injected(w) = self%injected(w) + dt*row%rate
               row%injected = self%injected(w)
               associate (rise => row%pressure - self%first_pressure(w))
                  if (abs(rise*row%flow) > 0.0_rk) row%injectivity = row%flow/rise
               end associate
            end associate
         end do
      end associate
   end subroutine book

   !> What has flowed out of each well into fracture or rock in the step that led to the present
   !! state [m2/s]; nothing before the first one.
   pure function well_flows(levels) result(flow)
      class(two_levels_t), intent(in) :: levels
      real(rk) :: flow(size(levels%scene%injections))

      flow = 0.0_rk
      associate (before => levels%before%time, now => levels%state%time)
         if (.not. now > before) return
         flow = rate(levels%scene%injections, before, now - before)
      end associate
      if (levels%model%wells%n_all > 0) flow(levels%model%wells%number) = levels%state%well_flow
   end function well_flows

   !> The pressure where each well meets fracture or rock [Pa]; in a fracture that feeds all of its
   !! cells, their mean.
   pure function well_pressures(levels) result(pressure)
      class(two_levels_t), intent(in) :: levels
      real(rk) :: pressure(size(levels%scene%injections))
      real(rk) :: flow(size(pressure))
      integer(ik) :: w

      if (size(pressure) == 1 .and. all(levels%scene%injections%fracture > 0)) then
         pressure = levels%well_pressure()
      else
         flow = well_flows(levels)
         pressure = [(pressure_at(levels, w, flow(w)), w=1, size(flow, kind=ik))]
      end if
   end function well_pressures

   !> What is an unknown of wells whose rate depends on pressures.
   pure subroutine set_controlled(levels, w, row)
      class(two_levels_t), intent(in) :: levels
      integer(ik), intent(in) :: w
      type(well_row_t), intent(inout) :: row
      integer :: k

      if (levels%model%wells%n_all == 0) return
      k = findloc(levels%model%wells%number, w, dim=1)
      if (k == 0) return
      row%flow = levels%state%well_flow(k)
      row%rate = levels%state%well_rate(k)
      row%head_pressure = levels%state%well_head(k) + levels%well_in_situ(w)
      associate (well => levels%scene%injections(w))
         if (allocated(well%pressure)) row%control = "pressure"
         if (allocated(well%pressure) .and. allocated(well%rate)) row%control = &
            & trim(merge("limit", "rate ", levels%at_limit(k)))
      end associate
   end subroutine set_controlled

   !> The pressure where a well meets fracture or rock [Pa]: that of the cells or the joint that it
   !! feeds, by their shares, and what the flow loses from there to the middle of its cell.
   pure real(rk) function pressure_at(levels, w, flow) result(pressure)
      class(two_levels_t), intent(in) :: levels
      integer(ik), intent(in) :: w
      real(rk), intent(in) :: flow  !< [m2/s]
      logical :: between(size(levels%scene%injections))
      integer(ik) :: cell

      associate (state => levels%state, model => levels%model, well => levels%scene%injections(w))
         if (well%fracture == 0) then
            cell = levels%rock_cell(w)
            pressure = levels%well_in_situ(w) + state%unknowns(3, cell) &
                       + flow/well_index(well%radius, cell_area(levels%mesh, cell), &
                                         model%rock%mobility_at(cell))
            return
         end if
         pressure = levels%well_in_situ(w) &
                    + dot_product(levels%share(:, w), state%pressure) &
                    + dot_product(levels%joint_share(:, w), state%joint_pressure)
         between = between_cells(levels%scene%injections, levels%share)
         if (.not. between(w)) return
         ! Not the lengths of the condensed matrix: before the first step there may be none.
         associate (length => levels%mesh%fracture%cell_s(2, :) - levels%mesh%fracture%cell_s(1, :))
            pressure = pressure + flow*6.0_rk*model%settings%viscosity &
                       *sum(levels%share(:, w)**2*length/state%aperture**3*levels%thickness())
         end associate
      end associate
   end function pressure_at

end module twolevel_well_rows
