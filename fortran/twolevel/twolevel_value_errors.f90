!> Estimated errors of the published quantities of a run with a fluid: in time (twolevel_followed)
!! and in space; no further solution is needed. In space:
!!
!! - Slip, opening and their sums: twolevel_jump_errors.
!! - Pressures in fractures, relative to the changes of all stages: where the fluid leaks off, the
!!   error of the layers next to the faces, by its share of the fluid; of what opens the fractures,
!!   half of the relative error of the volume; and the error of the first pressure. Wells in the
!!   rock: twolevel_pressure_errors. A given pressure has none.
!! - Fluid volumes: the errors of leak-off and of what the fractures hold. Where all rates are
!!   prescribed, their sum is exact, and each is at most the error of the other. The volume of the
!!   fractures has that before the first step besides. A produced volume may be nothing where it is
!!   less than the error of the net volume.
!! Growing fractures: the relative error of the length.
module twolevel_value_errors
   use base_kinds, only: ik, rk
   use coarse_state, only: state_t
   use contact_law, only: state_open
   use report_jump_errors, only: error_of_largest, finite_volumes
   use report_rows, only: history_errors_t, history_row_t, well_row_t
   use scene_types, only: scene_t
   use twolevel_errors, only: stated_errors_t
   use twolevel_followed, only: followed_step_t, followed_t
   use twolevel_jump_errors, only: jump_facts_t, jumps_in_space_t
   use twolevel_pressure_errors, only: fracture_means, has_one_free, have_given_pressure, &
                                       held_at_first, largest_of, leaking_share, least, &
                                       mean_in_rock, mean_pressure, of_connected, &
                                       of_first_pressure, of_layers, of_steps, of_well_in_rock, &
                                       share_round_tips, stress_means, &
                                       undrained_share
   use twolevel_problem, only: coarse_problem_t
   use twolevel_results, only: cell_states
   use twolevel_well_losses, only: by_wells_in_cells, lost_to_sides, unresolved_at
   use twolevel_well_rows, only: well_pressures
   implicit none(type, external)
   private

   public :: of_solution, step_facts_t, value_errors_t

   ! Positions of the quantities of a row that are followed.
   integer, parameter :: injected = 1, produced = 2, leakoff = 3, outflow = 4, fracture_fluid = 5, &
                         rock_fluid = 6, rock_outflow = 7, volume = 8, slip = 9, opening = 10, &
                         moment = 11, slip_rate = 12, pressure = 13, in_rock = 14, n_followed = 14

   !> relative error of pressures by the solver: the limit of its forward error bound [-]
   real(rk), parameter :: of_solution = 1.0e-6_rk
   !> error of a fracture's compliance, over the relative error of its volume [-]
   real(rk), parameter :: of_compliance = 0.5_rk

   !> What the errors of a step need besides its row.
   type :: step_facts_t
      logical :: is_jump = .false.  !< the step consists of unstable growth
      logical :: is_growing = .false.  !< tips have grown in the step, in equilibrium
      logical :: is_first = .false.  !< wells or sides were switched at its start
      real(rk) :: since_switch = 0.0_rk  !< time since the wells were switched [s]
      logical :: has_given_rates = .true.  !< a well has a rate, or there is none
      logical :: has_estimate = .false.  !< errors of lengths are estimated
      real(rk) :: mass_error = 0.0_rk  !< error of the balance so far [m2]
   end type step_facts_t

   !> Errors of the last accepted state, and what was followed.
   type :: value_errors_t
      type(history_errors_t) :: row
      real(rk) :: of_pressure = 0.0_rk  !< relative error in space of the pressure in fractures [-]
      real(rk) :: diffusing = 1.0_rk  !< share of the fluid that has leaked off [-]
      real(rk) :: of_flow = 0.0_rk  !< the same of a flow that is not prescribed [-]
      real(rk) :: of_drive = 0.0_rk  !< the same, by the first pressure of the rock [-]
      real(rk) :: of_held = 0.0_rk  !< in space, of the volume of the fractures [m2]
      real(rk) :: of_length = 0.0_rk  !< relative error of the length of growing fractures [-]
      real(rk) :: of_slip = 0.0_rk, of_opening = 0.0_rk  !< in time, relative to the largest [-]
      real(rk), allocatable :: of_wells(:)  !< of the wells' pressures [Pa]
      real(rk), allocatable :: of_flows(:)  !< of their flows [m2/s]
      logical, allocatable :: flows(:)  !< (wells) the well has a flow
      real(rk), allocatable :: risen(:)  !< largest changes of the wells' pressures so far [Pa]
      real(rk) :: of_rock = 0.0_rk  !< relative error in space of wells in the rock [-]
      type(followed_step_t) :: step  !< last step
      real(rk) :: start = 0.0_rk  !< time of the first state [s]
      real(rk), allocatable :: of_first(:, :)  !< (fractures, 2) of_first_pressure [Pa]
      logical, allocatable :: opened(:)  !< (fractures) cells were open at the first pressure
      real(rk), allocatable :: first_stress(:, :)  !< (2, fractures) stress_means at the start [Pa]
      real(rk) :: held = 0.0_rk  !< fluid in fractures per change of pressure and length [m/Pa]
      real(rk) :: gross = 0.0_rk  !< magnitudes of the leak-off of all cells so far [m2]
      real(rk), allocatable :: of_given(:)  !< (fractures) missing at wells with a pressure [Pa]
      !> (fractures) of the place where the pressure is that of the rock, by leak-off [Pa]
      real(rk), allocatable :: of_place(:)
      real(rk) :: of_start = 0.0_rk  !< of the fractures' volume before the first step [m2]
      type(followed_t) :: quantities
      type(followed_t) :: fractures  !< mean pressure of each
      type(followed_t) :: wells  !< pressure, flow, volume of each
      type(followed_t) :: entries  !< pressure, flow of each
      type(followed_t) :: probes  !< pressure, displacement, stress of each
   contains
      procedure :: begin
      procedure :: note_state
      procedure :: note_wells
      procedure :: undrained
      procedure :: first_pressure
      procedure :: in_space
      procedure :: jumps_of
      procedure :: given_volume
      procedure :: pressure_error
      procedure :: time_share
   end type value_errors_t

contains

   !> Begin with the state before the first step.
   subroutine begin(self, scene, problem, state)
      class(value_errors_t), intent(out) :: self
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk) :: values(n_followed)
      integer(ik) :: f

      values = 0.0_rk
      values(in_rock) = mean_in_rock(problem, state)
      if (problem%mesh%fracture%n_cells > 0) then
         values(volume) = problem%fracture_volume(state)
         values(slip) = maxval(abs(state%jump(2, :, :)))
         values(opening) = maxval(state%jump(1, :, :))
         values(pressure) = mean_pressure(problem, state)
      end if
      call self%quantities%begin(state%time, values)
      self%start = state%time
      self%of_first = of_first_pressure(scene, problem, state)
      self%opened = [(any(problem%mesh%fracture%cell_fracture == f .and. &
                          cell_states(state) == state_open), f=1, size(scene%fractures, kind=ik))]
      self%first_stress = stress_means(scene, problem, state)
      call self%fractures%begin(state%time, fracture_means(scene, problem, &
                                                           problem%fracture_pressure(state)))
      call self%wells%begin(state%time, [well_pressures(scene, problem, state%time, state), &
                                         spread(0.0_rk, 1, 2*size(scene%injections))])
   end subroutine begin

   !> Errors of the row of an accepted state.
   subroutine note_state(self, scene, problem, state, row, stated, facts)
      class(value_errors_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(history_row_t), intent(in) :: row
      type(stated_errors_t), intent(in) :: stated
      type(step_facts_t), intent(in) :: facts
      type(jumps_in_space_t) :: jumps
      real(rk) :: fluid, layers, opened, values(n_followed)

      values = [row%injected, row%produced, row%leakoff, row%outflow, row%fracture_fluid, &
                row%rock_fluid, row%rock_outflow, row%fracture_volume, row%max_slip, &
                row%max_opening, row%seismic_moment, row%max_slip_rate, 0.0_rk, &
                mean_in_rock(problem, state)]
      fluid = max(abs(row%leakoff) + abs(row%fracture_fluid), tiny(1.0_rk))
      self%diffusing = 1.0_rk
      if (problem%mesh%fracture%n_cells > 0) then
         values(pressure) = mean_pressure(problem, state)
         self%diffusing = abs(row%leakoff)/fluid
      end if
      self%gross = self%gross + max(0.0_rk, row%time - self%quantities%time) &
                   *sum((problem%mesh%fracture%cell_s(2, :) - problem%mesh%fracture%cell_s(1, :)) &
                        *abs(state%leakoff))
      self%step = followed_step_t(row%time, facts%is_jump, facts%is_growing, facts%is_first, &
                                  self%diffusing)
      call self%quantities%follow(self%step, values)
      self%step%left = 1.0_rk - self%diffusing*(1.0_rk - of_steps(problem))
      if (all(scene%injections%has_given_flow() .and. scene%injections%fracture > 0)) then
         associate (rates => self%quantities%rate([leakoff, fracture_fluid]))
            self%step%left = of_steps(problem)*leaking_share(rates, self%diffusing)
         end associate
         self%step%diffusing = 1.0_rk
      end if
      call self%fractures%follow(self%step, fracture_means(scene, problem, &
                                                           problem%fracture_pressure(state)))
      self%row = history_errors_t()
      self%of_length = 0.0_rk
      if (facts%has_estimate .and. row%fracture_length > 0.0_rk) then
         self%of_length = max(0.0_rk, stated%length)/row%fracture_length
      end if
      self%of_rock = of_well_in_rock(scene, problem, facts%since_switch)
      ! Layers are as old as their stage.
      layers = max(of_layers(problem, facts%since_switch, scene%growth%enabled), &
                   of_layers(problem, row%time - self%start, scene%growth%enabled))
      if (problem%mesh%fracture%n_cells > 0) then
         associate (s => problem%mesh%fracture%cell_s, changes => self%quantities%changes())
            self%held = abs(row%fracture_fluid)/max(changes(pressure)*sum(s(2, :) - s(1, :)), &
                                                    tiny(1.0_rk))
            call self%jumps_of(scene, problem, state, jumps)
            opened = abs(row%fracture_volume - self%quantities%first(volume))
            self%of_flow = self%diffusing*layers + of_compliance*min(1.0_rk, opened/fluid) &
                           *jumps%mean_share(s(2, :) - s(1, :))
         end associate
         self%of_drive = max(0.0_rk, maxval(min(1.0_rk, self%undrained(scene, problem) &
                                                /max(self%fractures%changes(), tiny(1.0_rk))), &
                                            mask=have_given_pressure(scene)))
         self%of_pressure = merge(self%of_flow, 0.0_rk, facts%has_given_rates)
         call self%jumps_of(scene, problem, state, jumps)
         if (self%quantities%n_steps == 0) self%of_start = jumps%volume
         call note_jumps(self, problem, jumps, row)
      end if
      self%of_place = (layers + share_round_tips(problem, row%time - self%start)) &
                      *(largest_of(scene, problem, state%pressure) &
                        + largest_of(scene, problem, -state%pressure)) &
                      + merge(0.0_rk, by_wells_in_cells(problem, state, size(scene%fractures)), &
                              have_given_pressure(scene))
      call note_fluid(self, scene, problem, state, row, facts, layers)
      call note_rest(self, problem, row, stated, facts)
   end subroutine note_state

   !> Errors of slip, opening, volume and moment.
   subroutine note_jumps(self, problem, jumps, row)
      class(value_errors_t), intent(inout) :: self
      type(coarse_problem_t), intent(in) :: problem
      type(jumps_in_space_t), intent(in) :: jumps
      type(history_row_t), intent(in) :: row
      ! Cells slip in turn as their zone grows; what slips after the most has slipped is little.
      real(rk), parameter :: of_slip_rate = 0.3_rk, of_late_slip = 0.1_rk

      associate (fracture => problem%mesh%fracture, time => self%quantities%error, &
                 since_start => max(row%time - self%start, tiny(1.0_rk)))
         ! At a kink the faces may open by all of their slip.
         self%row%max_opening = time(opening) &
                                + max(error_of_largest(fracture, jumps%n, jumps%error_n), &
                                      maxval(jumps%slip%kink*jumps%t) - row%max_opening)
         self%row%max_slip = time(slip) + error_of_largest(fracture, jumps%t, jumps%error_t)
         self%of_held = jumps%volume
         self%row%fracture_volume = time(volume) + jumps%volume + jumps%loosened
         self%row%seismic_moment = time(moment) + problem%model%rock%shear(1)*jumps%slipped
         ! Where faces open, cells slide by a share of what they open.
         self%row%max_slip_rate = self%quantities%of_step(slip_rate) &
                                  + max(of_slip_rate*row%max_slip_rate, of_late_slip &
                                        *sqrt(row%max_slip*row%max_slip_rate/since_start)) &
                                  + jumps%slip%of_slip(maxloc(jumps%n, dim=1)) &
                                  *abs(self%quantities%rate(opening))
         self%of_opening = 0.0_rk
         if (row%max_opening > 0.0_rk) self%of_opening = time(opening)/row%max_opening
         self%of_slip = 0.0_rk
         if (row%max_slip > 0.0_rk) self%of_slip = time(slip)/row%max_slip
      end associate
   end subroutine note_jumps

   !> Errors in space of slip and opening of a state.
   subroutine jumps_of(self, scene, problem, state, jumps)
      class(value_errors_t), intent(in) :: self
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(jumps_in_space_t), intent(out) :: jumps

      call jumps%find(scene%material, problem, state, &
                      jump_facts_t(self%of_length, self%given_volume(), self%diffusing, &
                                   self%in_space(scene, problem), &
                                   self%first_pressure(scene, problem)))
   end subroutine jumps_of

   !> Errors of the fluid volumes.
   subroutine note_fluid(self, scene, problem, state, row, facts, layers)
      class(value_errors_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(history_row_t), intent(in) :: row
      type(step_facts_t), intent(in) :: facts
      real(rk), intent(in) :: layers  !< relative error of leak-off by layers [-]
      real(rk), parameter :: half = 0.5_rk  ! of the first pressure, where both begin, and of others
      real(rk) :: drive, first, held, leak

      associate (time => self%quantities%error, error => self%row, lost => abs(facts%mass_error), &
                 changes => self%quantities%changes())
         error%outflow = time(outflow) + max(least, self%of_flow)*abs(row%outflow) + lost
         associate (joints => problem%model%joints)
            if (joints%n > 0) error%outflow = error%outflow + maxval(joints%way_error) &
                                              *max(abs(row%outflow), sum(joints%gross)) &
                                              + lost_to_sides(problem, state) &
                                              *(abs(row%injected) + abs(row%produced))
         end associate
         error%rock_outflow = time(rock_outflow) + max(least, layers)*abs(row%rock_outflow) + lost
         first = held_at_first(scene, problem, state, sum(self%of_first, dim=2))
         associate (share => maxval(sum(self%of_first, dim=2))/max(changes(pressure), tiny(1.0_rk)))
            if (share < 1.0_rk) first = min(first, half*share*abs(row%fracture_fluid))
         end associate
         ! What an open fracture holds at first leaks off until its faces touch.
         drive = max(self%of_drive, maxval(min(1.0_rk, sum(self%of_first, dim=2) &
                                               /max(self%fractures%changes(), tiny(1.0_rk))), &
                                           mask=self%opened))
         leak = time(leakoff) + (layers + self%of_length + drive + half*self%of_pressure) &
                *max(self%gross, abs(row%leakoff)) + first + lost
         held = held_at_first(scene, problem, state, self%of_place)
         held = held + time(fracture_fluid) + max(self%of_held, self%of_start - self%of_held) &
                + max(0.2_rk*least, self%of_pressure)*abs(row%fracture_fluid) + first + lost
         error%leakoff = leak
         error%fracture_fluid = held
         if (.not. all(scene%injections%has_given_flow())) then
            error%injected = time(injected) + lost + max(self%of_held, &
                                         & (self%of_flow + self%of_drive)*abs(row%injected))
            ! The balance has the only flow that is not given.
            if (has_one_free(scene)) error%injected = leak + held + error%outflow
            error%produced = time(produced) + (self%of_flow + self%of_drive)*abs(row%produced) &
                             + min(row%produced, error%injected) + lost
         else
            error%leakoff = min(leak, held + error%outflow)
            error%fracture_fluid = min(held, leak + error%outflow)
            error%fracture_volume = min(error%fracture_volume, error%fracture_fluid &
                                   + self%of_pressure*abs(row%fracture_fluid - row%fracture_volume &
                                                               + self%quantities%first(volume)) &
                                        + self%of_start)
            error%injected = lost
            error%produced = lost
         end if
         if (problem%mesh%fracture%n_cells == 0) error%leakoff = 0.0_rk
         ! What leaves the rock follows what leaks off, of which it is a share at most.
         error%rock_outflow = error%rock_outflow + error%leakoff &
                              *min(1.0_rk, abs(row%rock_outflow) &
                                   /max(abs(row%leakoff), tiny(1.0_rk)))
         error%rock_fluid = error%leakoff + error%rock_outflow &
                            + merge(error%injected, 0.0_rk, any(scene%injections%fracture == 0))
      end associate
   end subroutine note_fluid

   !> Errors of rates and lengths.
   subroutine note_rest(self, problem, row, stated, facts)
      class(value_errors_t), intent(inout) :: self
      type(coarse_problem_t), intent(in) :: problem
      type(history_row_t), intent(in) :: row
      type(stated_errors_t), intent(in) :: stated
      type(step_facts_t), intent(in) :: facts
      real(rk) :: grown, longest

      grown = merge(max(0.0_rk, stated%length), 0.0_rk, facts%has_estimate)
      associate (error => self%row, fracture => problem%mesh%fracture)
         if (fracture%n_cells == 0) return
         longest = maxval(fracture%cell_s(2, :) - fracture%cell_s(1, :))
         error%connected_length = grown
         if (.not. max(row%stimulated_length, row%max_slip, error%max_slip) > 0.0_rk) return
         error%stimulated_length = grown + 2.0_rk*longest + row%doubtful_length
         error%connected_stimulated = error%stimulated_length
      end associate
   end subroutine note_rest

   !> Relative error of openings that is none where the volume of the fluid is given: then the error
   !! of the compliance is one of the pressure [-].
   pure real(rk) function given_volume(self)
      class(value_errors_t), intent(in) :: self
      real(rk), parameter :: most = 0.8_rk  ! of the error that does not depend on the place

      given_volume = 0.0_rk
      if (self%of_pressure > 0.0_rk) given_volume = most*(1.0_rk - self%diffusing) &
                                                    *finite_volumes%rest
   end function given_volume

   !> Errors of the fractures' first pressures that remain [Pa].
   function undrained(self, scene, problem) result(error)
      class(value_errors_t), intent(in) :: self
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      real(rk) :: error(size(scene%fractures))

      error = of_connected(problem, sum(self%of_first &
                                        *undrained_share(scene, problem, self%quantities%time &
                                                         - self%start, self%held), dim=2))
   end function undrained

   !> Remaining error of the first pressure in each fracture cell; none at a given pressure [Pa].
   function first_pressure(self, scene, problem) result(error)
      class(value_errors_t), intent(in) :: self
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      real(rk), allocatable :: error(:)

      error = merge(0.0_rk, self%undrained(scene, problem), have_given_pressure(scene))
      error = error(problem%mesh%fracture%cell_fracture)
   end function first_pressure

   !> Error in space of the pressure of each fracture cell by flow, and of the first pressure [Pa].
   function in_space(self, scene, problem) result(error)
      class(value_errors_t), intent(in) :: self
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      real(rk), allocatable :: error(:)

      error = merge(0.0_rk, self%of_flow*self%fractures%changes(), have_given_pressure(scene))
      error = error(problem%mesh%fracture%cell_fracture) + self%first_pressure(scene, problem)
   end function in_space

   !> Error of the mean pressure in the fractures, in time and space [Pa].
   pure real(rk) function pressure_error(self)
      class(value_errors_t), intent(in) :: self

      pressure_error = 0.0_rk
      if (.not. allocated(self%quantities%error)) return
      associate (changes => self%quantities%changes(), time => self%quantities%error)
         pressure_error = time(pressure) + self%of_pressure*changes(pressure)
      end associate
   end function pressure_error

   !> Relative error in time of pressures in the rock [-].
   pure real(rk) function time_share(self) result(share)
      class(value_errors_t), intent(in) :: self
      integer, parameter :: both(2) = [pressure, in_rock]
      integer :: i

      share = 0.0_rk
      if (.not. allocated(self%quantities%error)) return
      associate (q => self%quantities)
         do i = 1, 2
            associate (change => abs(q%value(both(i)) - q%first(both(i))))
               if (change > 0.0_rk) share = max(share, q%error(both(i))/change)
            end associate
         end do
      end associate
      share = min(1.0_rk, share)
   end function time_share

   !> Errors of the wells after a step; also those of rate and injectivity of the row.
   subroutine note_wells(self, scene, problem, state, rows, stated, facts)
      class(value_errors_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(well_row_t), intent(inout) :: rows(:)
      type(stated_errors_t), intent(in) :: stated
      type(step_facts_t), intent(in) :: facts
      type(jumps_in_space_t) :: jumps
      real(rk), dimension(size(scene%fractures)) :: first, net
      real(rk) :: by_length, changes(3*size(rows)), drop, flow, missing, part, share, taken(2)
      integer(ik) :: w
      logical :: keeps(size(rows))

      if (size(rows) == 0) return
      keeps = [(rows(w)%control == "pressure", w=1, size(rows, kind=ik))]
      call self%wells%follow(self%step, [rows%pressure, rows%flow, rows%injected])
      by_length = merge(abs(stated%slope)*max(0.0_rk, stated%length), 0.0_rk, facts%has_estimate)
      changes = self%wells%changes()
      first = self%undrained(scene, problem)
      net = 0.0_rk
      if (problem%mesh%fracture%n_cells > 0) then
         call self%jumps_of(scene, problem, state, jumps)
         net = merge(0.0_rk, fracture_means(scene, problem, jumps%net_error), &
                     have_given_pressure(scene))
      end if
      self%of_given = 0.0_rk*first
      do w = 1, size(rows, kind=ik)
         associate (row => rows(w), n => size(rows), time => self%wells%error, &
                    error => rows(w)%error, well => scene%injections(w))
            share = merge(self%of_rock + self%of_flow + self%of_length, self%of_pressure, &
                          well%fracture == 0)
            missing = unresolved_at(problem, state, findloc(problem%well_of, w, dim=1, kind=ik), &
                                    rows%flow)
            error%pressure = share*changes(w)
            if (well%fracture > 0) error%pressure = max(error%pressure + first(well%fracture), &
                                                        net(well%fracture))
            error%pressure = error%pressure + time(w)
            if (well%fracture > 0) then
               ! Where another well keeps its pressure, errors are those of the difference.
               drop = minval(abs(row%pressure - rows%pressure), &
                             mask=keeps .and. scene%injections%fracture == well%fracture)
               if (drop < changes(w)) error%pressure = error%pressure*drop/changes(w)
               error%pressure = error%pressure + self%of_place(well%fracture)
            end if
            error%pressure = error%pressure + by_length + missing + of_solution*abs(row%pressure)
            if (.not. well%has_given_flow()) then
               if (well%fracture > 0) self%of_given(well%fracture) = max(missing, &
                                                                       self%of_given(well%fracture))
               ! A well that keeps the pressure that it had is driven by others, or by sides.
               part = merge(changes(w), max(missing, maxval(changes(:n))), changes(w) > 0.0_rk)
               part = missing/max(part, tiny(1.0_rk))
               flow = max(share, self%of_flow) + self%of_drive + part
               ! Errors are those of what the fractures and the rock take up.
               taken = abs([row%flow, row%injected])
               if (has_one_free(scene)) taken = abs([sum(rows%flow), sum(rows%injected)])
               error%injected = time(2*n + w) + flow*taken(2)
               if (has_one_free(scene)) then
                  error%injected = self%row%injected + part*taken(2)
               else
                  error%injected = max(error%injected, self%of_held)
               end if
               ! A flow like 1/sqrt(t) has three times the relative error in time of its volume.
               error%flow = time(n + w)
               if (taken(2) > 0.0_rk) error%flow = max(error%flow, &
                  & 3.0_rk*taken(1)*time(2*n + w)/taken(2))
               error%flow = error%flow + flow*taken(1)
               error%rate = error%flow
            end if
            error%head_pressure = error%pressure &
                                  + (well%friction + 2.0_rk*well%turbulence*abs(row%flow)) &
                                  *error%flow
            if (row%control == "pressure" .or. row%control == "limit") then
               error%pressure = min(error%pressure, error%head_pressure - error%pressure)
               error%head_pressure = 0.0_rk
            else
               error%rate = 0.0_rk
            end if
            associate (rise => abs(row%pressure - self%wells%first(w)))
               if (rise > 0.0_rk .and. abs(row%flow) > 0.0_rk) error%injectivity = &
                  & abs(row%injectivity)*(error%pressure/rise + error%flow/abs(row%flow))
            end associate
         end associate
      end do
      where (scene%injections%fracture > 0 .and. rows%error%head_pressure > 0.0_rk)
         rows%error%pressure = rows%error%pressure + self%of_given(max(1, &
                                                                    & scene%injections%fracture))
         rows%error%head_pressure = rows%error%head_pressure &
                                    + self%of_given(max(1, scene%injections%fracture))
      end where
      self%of_wells = rows%error%pressure
      self%of_flows = rows%error%flow
      if (.not. all(scene%injections%has_given_flow())) then
         self%row%injected = sum(rows%error%injected) + abs(facts%mass_error)
         self%row%produced = sum(rows%error%injected, mask=rows%injected < 0.0_rk) &
                             + abs(facts%mass_error)
      end if
      self%flows = abs(rows%flow) > 0.0_rk
      if (.not. allocated(self%risen)) self%risen = 0.0_rk*self%of_wells
      self%risen = max(self%risen, abs(rows%pressure - self%wells%first(:size(rows))))
      self%row%injection_rate = sum(rows%error%flow)
      if (size(rows) == 1) self%row%injectivity = rows(1)%error%injectivity
   end subroutine note_wells

end module twolevel_value_errors
