!> Results of the wells, one row of wells.csv per well, and of their entries.
module twolevel_well_rows
   use base_archive, only: archive_t
   use base_kinds, only: ik, rk
   use coarse_state, only: state_t
   use report_rows, only: entry_row_t, well_row_t
   use scene_types, only: scene_t
   use twolevel_problem, only: coarse_problem_t
   use twolevel_wells, only: rate
   implicit none(type, external)
   private

   public :: entry_rows, well_results_t, well_flows, well_pressures

   !> (wells) Sums, and values of the first state.
   type :: well_results_t
      real(rk), allocatable :: injected(:)  !< injected at their heads so far [m2]
      real(rk), allocatable, private :: first_pressure(:)  !< pressure before the first step [Pa]
   contains
      procedure :: begin
      procedure :: add
      procedure :: book
      procedure :: visit
   end type well_results_t

contains

   !> Begin with the state before the first step.
   subroutine begin(self, scene, problem, state)
      class(well_results_t), intent(out) :: self
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      integer(ik) :: w

      associate (n => size(scene%injections, kind=ik))
         allocate (self%injected(n), source=0.0_rk)
         self%first_pressure = [(pressure_at(problem, state, w, 0.0_rk), w=1, n)]
      end associate
   end subroutine begin

   !> Add wells at rest after those so far.
   subroutine add(self, scene, problem, state)
      class(well_results_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      integer(ik) :: w

      associate (first => size(self%injected, kind=ik) + 1, last => size(scene%injections, kind=ik))
         self%first_pressure = [self%first_pressure, &
                                (pressure_at(problem, state, w, 0.0_rk), w=first, last)]
         self%injected = [self%injected, (0.0_rk, w=first, last)]
      end associate
   end subroutine add

   !> Rows of the state after a step of length dt; dt = 0: before the first step.
   subroutine book(self, scene, problem, state, at_limit, dt, rows)
      class(well_results_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      logical, intent(in) :: at_limit(:)  !< (controlled wells)
      real(rk), intent(in) :: dt  !< [s]
      type(well_row_t), allocatable, intent(out) :: rows(:)
      integer(ik) :: w

      associate (wells => scene%injections)
         allocate (rows(size(wells)))
         do w = 1, size(wells, kind=ik)
            associate (row => rows(w))
               row%time = state%time
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
               call set_controlled(scene, problem, state, at_limit, w, row)
               if (row%stage == 0) row%control = "shut"
               row%pressure = pressure_at(problem, state, w, row%flow)
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

   !> Flow out of each well into fracture or rock in the step to the present state; 0 before the
   !! first step [m2/s].
   pure function well_flows(scene, problem, since, state) result(flow)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: since  !< start of the step [s]
      type(state_t), intent(in) :: state
      real(rk) :: flow(size(scene%injections))

      flow = 0.0_rk
      if (.not. state%time > since) return
      flow = rate(scene%injections, since, state%time - since)
      associate (wells => problem%model%wells)
         if (wells%n_all > 0) flow(wells%number) = state%well_flow(:wells%n_all)
      end associate
   end function well_flows

   !> Pressure where each well meets fracture or rock; for a well that supplies all cells of a
   !! fracture, their mean [Pa].
   pure function well_pressures(scene, problem, since, state) result(pressure)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: since  !< start of the step [s]
      type(state_t), intent(in) :: state
      real(rk) :: pressure(size(scene%injections))
      real(rk) :: flow(size(pressure))
      integer(ik) :: w

      flow = well_flows(scene, problem, since, state)
      pressure = [(pressure_at(problem, state, w, flow(w)), w=1, size(flow, kind=ik))]
   end function well_pressures

   !> Fill in the columns that are unknowns, for a well whose rate depends on pressures.
   pure subroutine set_controlled(scene, problem, state, at_limit, w, row)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      logical, intent(in) :: at_limit(:)  !< (controlled wells)
      integer(ik), intent(in) :: w
      type(well_row_t), intent(inout) :: row
      integer :: k

      if (problem%model%wells%n_all == 0) return
      k = findloc(problem%model%wells%number, w, dim=1)
      if (k == 0) return
      row%flow = state%well_flow(k)
      row%rate = state%well_rate(k)
      row%head_pressure = state%well_head(k) + problem%well_in_situ(w)
      associate (well => scene%injections(w))
         if (allocated(well%pressure)) row%control = "pressure"
         if (allocated(well%pressure) .and. allocated(well%rate)) row%control = &
            & trim(merge("limit", "rate ", at_limit(k)))
      end associate
   end subroutine set_controlled

   !> Pressure where a well meets fracture or rock; with entries that in the well before their
   !! losses, at the depth of the first [Pa].
   pure real(rk) function pressure_at(problem, state, w, flow) result(pressure)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      integer(ik), intent(in) :: w
      real(rk), intent(in) :: flow  !< [m2/s]
      real(rk) :: lost, slope
      integer(ik) :: entry, k

      entry = findloc(problem%well_of, w, dim=1, kind=ik)
      if (problem%entries(entry)%fracture == 0) then
         pressure = problem%entry_in_situ(entry) + state%unknowns(3, problem%rock_cell(w)) &
                    + problem%model%rock_wells%beyond_cell(w, flow, state%rings)
      else if (allocated(problem%entries(entry)%entries)) then
         k = findloc(problem%model%wells%number, w, dim=1, kind=ik)
         call problem%model%wells%lost(k, flow, lost, slope)
         pressure = problem%well_in_situ(w) + state%well_head(k) - lost
      else
         pressure = problem%entry_pressure(state, entry, flow)
      end if
   end function pressure_at

   !> Rows of the entries of a state, without their errors.
   pure function entry_rows(problem, state) result(rows)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(entry_row_t), allocatable :: rows(:)
      integer(ik) :: e, entry, w

      allocate (rows(problem%model%wells%n_entries))
      associate (wells => problem%model%wells)
         do e = 1, wells%n_entries
            w = wells%of_entry(e)
            rows(e)%entry = count(wells%of_entry(:e) == w, kind=ik)
            entry = findloc(problem%well_of, wells%number(w), dim=1, kind=ik) + rows(e)%entry - 1
            associate (row => rows(e))
               row%time = state%time
               row%name = trim(problem%entries(entry)%name)
               row%fracture = problem%entries(entry)%fracture
               row%flow = state%well_flow(wells%n_all + e)
               if (abs(state%well_flow(w)) > 0.0_rk) row%share = row%flow/state%well_flow(w)
               row%pressure = problem%entry_pressure(state, entry, row%flow)
            end associate
         end do
      end associate
   end function entry_rows

   !> Store or load all components.
   subroutine visit(self, archive)
      class(well_results_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive

      call archive%list("injected", self%injected, "all_wells")
      call archive%list("first_pressure", self%first_pressure, "all_wells")
   end subroutine visit

end module twolevel_well_rows
