!> The equations of the coarse level on one mesh: mesh, model with its factors, and the cells of the
!! wells in fractures and rock. Also the total pressures of a state, whose pressures are relative to
!! the state in situ.
module twolevel_problem
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use base_tolerances, only: same_value
   use mesh_geometry, only: cell_area
   use coarse_model, only: coarse_model_t
   use coarse_nodes, only: nodal_fields
   use coarse_own_pressure, only: own_pressure
   use coarse_tip_drainage, only: drained_tips
   use coarse_well_rings, only: ring_count
   use coarse_wells, only: well_index
   use coarse_state, only: state_t, step_report_t
   use mesh_builder, only: locate, mesher_t
   use mesh_types, only: mesh_t
   use scene_types, only: injection_t, scene_t
   use heat_field, only: heat_field_t
   use heat_model, only: heat_model_t
   use heat_state, only: heat_state_t
   use twolevel_faces, only: coarse_values_t
   use twolevel_schedule, only: follow_sides
   use twolevel_rock_around, only: place_rings
   use twolevel_well_ways, only: find_outlet_ways, find_way
   use twolevel_wells, only: ask_wells, control_wells, entries_of, place_wells, &
                             places_of_cells, rate, &
                             wells_of_entries
   implicit none(type, external)
   private

   public :: cell_heights, coarse_problem_t, discard

   !> Coarse mesh, its model, and the wells on it.
   type :: coarse_problem_t
      type(mesher_t) :: mesher
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(injection_t), allocatable :: entries(:)  !< of all wells, as wells of one entry
      integer(ik), allocatable :: well_of(:)  !< (entries) number of the well
      real(rk), allocatable :: share(:, :)  !< (fracture cells, entries) of each entry's flow [-]
      real(rk), allocatable :: joint_share(:, :)  !< (joints, entries) of each entry's flow [-]
      !> (fracture cells, entries) of place_wells, and with what is taken up on the way; next to a
      !! joint the distance from the middle over that of the joint [-]
      real(rk), allocatable :: steady(:, :), path(:, :)
      !> (fracture cells, entries) 1: middle of the cell beyond a well at a point of its fracture,
      !! -1: before it, 0: neither
      real(rk), allocatable :: ahead(:, :)
      real(rk), allocatable :: asked(:)  !< (entries) prescribed flows of the last step [m2/s]
      !> (wells) cells of the wells in the rock; 0: other wells
      integer(ik), allocatable :: rock_cell(:)
      type(heat_model_t), allocatable :: heat  !< unallocated: the scene has none
      type(heat_field_t) :: heat_field  !< rise of the temperatures that acts in the present step
      ! Heat after the last step that was tried, start and end of this step [s], and its flows;
      ! unallocated: those on another mesh.
      type(heat_state_t) :: heat_after
      real(rk) :: heat_span(2) = -1.0_rk
      real(rk), allocatable :: heat_flows(:)  !< [W/(m K)]
      type(coarse_values_t) :: values  !< values of the state in which tips were evaluated last
   contains
      procedure :: feed_wells
      procedure :: rest_wells
      procedure :: ask
      procedure :: find_ways
      procedure :: advance
      procedure :: find_values
      procedure :: well_pressure
      procedure :: entry_pressure
      procedure :: well_in_situ
      procedure :: entry_in_situ
      procedure :: rock_pressure
      procedure :: fracture_pressure
      procedure :: fracture_volume
      procedure :: joint_pressure
      procedure :: thickness
   end type coarse_problem_t

contains

   !> Release a problem.
   subroutine discard(problem)
      type(coarse_problem_t), allocatable, intent(inout) :: problem

      if (.not. allocated(problem)) return
      call problem%model%release()
      deallocate (problem)
   end subroutine discard

   !> Find the cells and joints that the wells supply on the present mesh.
   subroutine feed_wells(self, scene, error)
      class(coarse_problem_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: cell(1), w

      associate (wells => scene%injections)
         self%entries = entries_of(wells)
         self%well_of = wells_of_entries(wells)
         call place_wells(self%entries, self%mesh%fracture, self%model%joints, &
                          self%model%cells%roughness, self%share, self%joint_share, self%steady)
         self%path = self%steady
         self%ahead = places_of_cells(self%entries, self%mesh%fracture)
         if (.not. allocated(self%asked)) self%asked = spread(0.0_rk, 1, size(self%entries))
         call control_wells(wells, self%share, self%joint_share, self%path, self%model%wells)
         call part_twins(self, scene)
         if (allocated(self%model%in_situ)) then
            self%model%wells%pressure_in_situ = &
               [(self%well_in_situ(self%model%wells%number(w)), w=1, self%model%wells%n_all)]
         end if
         self%rock_cell = spread(0_ik, 1, size(wells))
         if (.not. any(wells%fracture == 0)) return
         if (allocated(self%model%source)) deallocate (self%model%source)
         allocate (self%model%source(3, self%mesh%n_cells), source=0.0_rk)
         do w = 1, size(wells, kind=ik)
            if (wells(w)%fracture > 0) cycle
            call locate(self%mesher, reshape([wells(w)%x, wells(w)%y], [2, 1]), cell, error)
            if (allocated(error)) return
            self%rock_cell(w) = cell(1)
         end do
         call place_rings(scene, self%mesher, self%mesh, self%rock_cell, self%model%rock, &
                          self%model%rock_wells, error)
         if (allocated(error)) return
         if (self%model%wells%n_all > self%model%wells%n) call place_rock_wells(self, scene, error)
      end associate
   end subroutine feed_wells

   !> Where several wells prescribe pressures at the same place without losses in the wells, their
   !! single flows are undetermined: each gets a loss of a thousandth of the resistance of half a
   !! cell.
   pure subroutine part_twins(self, scene)
      class(coarse_problem_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      real(rk), parameter :: share_of_half_cell = 1.0e-3_rk
      logical :: is_twin(self%model%wells%n)
      integer(ik) :: k, w

      associate (wells => self%model%wells, cells => self%model%cells, &
                 s => self%mesh%fracture%cell_s)
         is_twin = .false.
         do w = 1, wells%n
            if (any(wells%path(:, w) > same_value)) cycle
            if (wells%friction(w) + wells%turbulence(w) > 0.0_rk) cycle
            if (wells%first_entry(w) /= w) cycle
            do k = 1, wells%n
               if (k == w) cycle
               if (.not. all([allocated(scene%injections(wells%number(w))%pressure), &
                              allocated(scene%injections(wells%number(k))%pressure)])) cycle
               is_twin(w) = is_twin(w) .or. all(abs(wells%share(:, k) - wells%share(:, w)) &
                                                <= same_value) &
                            .and. all(abs(wells%joint_share(:, k) - wells%joint_share(:, w)) &
                                      <= same_value)
            end do
         end do
         if (.not. any(is_twin)) return
         where (is_twin) wells%friction(:wells%n) = share_of_half_cell*6.0_rk &
            & *self%model%settings%viscosity*sum((s(2, :) - s(1, :))/cells%residual_aperture**3) &
            & /size(s, 2)
      end associate
   end subroutine part_twins

   !> Cells and well indices of the wells in the rock whose rate depends on pressures.
   pure subroutine place_rock_wells(self, scene, error)
      class(coarse_problem_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: k

      associate (wells => self%model%wells, rock => self%model%rock_wells)
         rock%n = wells%n_all - wells%n
         rock%cell = self%rock_cell(wells%number(wells%n + 1:))
         rock%conductance = spread(0.0_rk, 1, int(rock%n))
         rock%index = [(well_index(scene%injections(wells%number(wells%n + k))%radius &
                                   *sqrt(0.5_rk + 0.5_rk*self%model%rock%mean_over_mobility( &
                                         & rock%cell(k))), &
                                   cell_area(self%mesh, rock%cell(k)), &
                                   self%model%rock%mobility_at(rock%cell(k))), k=1, rock%n)]
         if (.not. all(rock%index > 0.0_rk)) then
            call raise_error(error, "", "a well in the rock with a pressure control must be "// &
                             "narrower than its cell: use a smaller radius or larger cells")
            return
         end if
         rock%left_over = spread(0.0_rk, 1, int(rock%n))
         rock%ring_of = [(findloc(rock%ring_number, wells%number(wells%n + k), dim=1, kind=ik), &
                          k=1, rock%n)]
      end associate
   end subroutine place_rock_wells

   !> Set the flow in the wells to zero, and their head pressures to those of the cells and joints
   !! that they supply.
   pure subroutine rest_wells(self, state)
      class(coarse_problem_t), intent(in) :: self
      type(state_t), intent(inout) :: state
      real(rk), allocatable :: at_places(:)  ! [Pa]
      integer(ik) :: w

      if (allocated(self%model%rock_wells%rings)) then
         if (allocated(state%rings)) deallocate (state%rings)
         allocate (state%rings(ring_count, size(self%model%rock_wells%rings)), source=0.0_rk)
      end if
      associate (wells => self%model%wells)
         if (wells%n_all == 0) return
         state%well_flow = spread(0.0_rk, 1, int(wells%n_all + wells%n_entries))
         state%well_rate = state%well_flow(:wells%n_all)
         at_places = matmul(state%pressure, wells%share) + matmul(state%joint_pressure, &
                                                                  wells%joint_share)
         state%well_head = [(at_places(wells%first_entry(w)), w=1, wells%n), &
                            state%unknowns(3, self%rock_cell(wells%number(wells%n + 1:)))]
      end associate
   end subroutine rest_wells

   !> Set the rates and controls of the wells for a step of length dt that begins at a time.
   pure subroutine ask(self, scene, time, dt)
      class(coarse_problem_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: time, dt  !< [s]

      associate (rates => rate(scene%injections, time, dt))
         self%asked = rates(self%well_of)
         self%model%cells%injection = matmul(self%share, self%asked)
         if (self%model%joints%n > 0) then
            self%model%joints%injection = matmul(self%joint_share, self%asked)
         end if
         if (allocated(self%model%source)) call feed_rock(self, rates)
      end associate
      call ask_wells(scene%injections, time, dt, self%model%wells)
   end subroutine ask

   !> Advance a state by one step; the state changes only if the step converges.
   subroutine advance(self, scene, dt, state, timers, report, error, control)
      class(coarse_problem_t), intent(inout) :: self
      type(scene_t), intent(inout) :: scene  !< the values of its sides change with time
      real(rk), intent(in) :: dt  !< [s]
      type(state_t), intent(inout) :: state
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      !> (controlled wells) other controls, constants of coarse_wells; 0: that of the scene
      integer(ik), intent(in), optional :: control(:)

      if (any(self%model%sides%changes())) then
         call follow_sides(scene, state%time + dt, state%time)
         call self%model%change_sides(self%mesh, scene, timers, error)
         if (allocated(error)) return
      end if
      call self%find_ways(scene, state, dt)
      call self%ask(scene, state%time, dt)
      if (present(control)) then
         where (control > 0) self%model%wells%control = control
      end if
      call self%model%advance(self%mesh, dt, state, timers, report, error)
   end subroutine advance

   !> Ways of the wells at points of fractures, and to outlets, in the step after a state.
   pure subroutine find_ways(self, scene, state, dt)
      class(coarse_problem_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(state_t), intent(in) :: state
      real(rk), intent(in) :: dt  !< [s]
      real(rk), allocatable :: conductance(:)
      integer(ik) :: e, i

      if (self%mesh%fracture%n_cells == 0) return
      if (size(self%entries) + self%model%joints%n == 0) return
      conductance = state%aperture**3/(12.0_rk*self%model%settings%viscosity*self%thickness(state))
      do e = 1, size(self%entries, kind=ik)
         call find_way(self%entries(e), self%steady(:, e), self%model, self%mesh, conductance, &
                       state%time + dt, self%share(:, e), self%joint_share(:, e), &
                       self%path(:, e))
      end do
      do i = 1, size(self%model%wells%entry, kind=ik)
         e = self%model%wells%entry(i)
         if (e == 0) cycle
         self%model%wells%path(:, i) = self%path(:, e)
         self%model%wells%share(:, i) = self%share(:, e)
         self%model%wells%joint_share(:, i) = self%joint_share(:, e)
      end do
      if (self%model%joints%n == 0) return
      call find_outlet_ways(self%model, self%mesh, scene, conductance, state%time, dt, &
                            any(self%steady > 0.0_rk, dim=2))
   end subroutine find_ways

   !> Compute the values that windows use, unless they are those of this state already.
   subroutine find_values(self, state, undrained)
      class(coarse_problem_t), intent(inout) :: self
      type(state_t), intent(in) :: state
      logical, intent(in) :: undrained  !< no fluid has moved since the load changed

      if (allocated(self%values%of)) then
         if (all(abs(self%values%of - state%unknowns) <= 0.0_rk)) then
            self%values%undrained = undrained
            call take_tips(self, state)
            return
         end if
      end if
      self%values = coarse_values_t(of=state%unknowns, law=self%model%cells%law, &
                                    is_grown=self%model%cells%roughness > 0.0_rk, &
                                    undrained=undrained)
      associate (values => self%values, model => self%model, mesh => self%mesh, &
                 n => self%mesh%n_nodes)
         allocate (values%nodal(3, n), values%displacement(2, n), values%gradient(2, 2, n))
         call nodal_fields(mesh, model%rock, model%regions, state%unknowns, state%tractions, &
                           values%nodal, values%displacement, values%gradient)
         values%nodal(3, :) = own_pressure(mesh, state%unknowns(3, :mesh%n_cells), &
                                           values%nodal(3, :))
      end associate
      call take_tips(self, state)
   end subroutine find_values

   !> What depends on the places of the tips in their cells, and their parameters, which the model
   !! has once it has solved a step.
   subroutine take_tips(self, state)
      class(coarse_problem_t), intent(inout) :: self
      type(state_t), intent(in) :: state

      self%values%drained = drained_tips(self%mesh, self%values%nodal(3, :), state%pressure, &
                                         self%model%cells%share)
      self%values%viscous = spread(0.0_rk, 1, self%mesh%fracture%n_cells)
      if (.not. allocated(self%model%cells%viscous)) return
      if (size(self%model%cells%viscous) /= size(self%values%viscous)) return
      self%values%viscous = self%model%cells%viscous
   end subroutine take_tips

   !> Wells in the rock.
   pure subroutine feed_rock(self, rates)
      class(coarse_problem_t), intent(inout) :: self
      real(rk), intent(in) :: rates(:)  !< (wells) [m2/s]
      integer(ik) :: w

      self%model%source = 0.0_rk
      self%model%rock_wells%ring_flow = rates(self%model%rock_wells%ring_number)
      do w = 1, size(rates, kind=ik)
         if (self%rock_cell(w) == 0) cycle
         associate (fluid => self%model%source(3, self%rock_cell(w)))
            fluid = fluid + rates(w)
         end associate
      end do
   end subroutine feed_rock

   !> Mean pressure at the wells in fractures, at the rates of the step to this state; 0 without any
   !! [Pa].
   pure real(rk) function well_pressure(self, state)
      class(coarse_problem_t), intent(in) :: self
      type(state_t), intent(in) :: state
      real(rk) :: flow
      integer(ik) :: e, k

      well_pressure = 0.0_rk
      do e = 1, size(self%entries, kind=ik)
         if (self%entries(e)%fracture == 0) cycle
         k = maxloc(self%share(:, e), dim=1, kind=ik)
         flow = state%injection(k)/max(self%share(k, e), tiny(1.0_rk))
         well_pressure = well_pressure + self%entry_pressure(state, e, flow)
      end do
      well_pressure = well_pressure/max(1, count(self%entries%fracture > 0))
   end function well_pressure

   !> Pressure where an entry meets its fracture: that of the cells or the joint that it supplies,
   !! weighted by its shares, plus the loss of its flow over the way to them [Pa].
   pure real(rk) function entry_pressure(self, state, entry, flow) result(pressure)
      class(coarse_problem_t), intent(in) :: self
      type(state_t), intent(in) :: state
      integer(ik), intent(in) :: entry  !< number among those of all wells
      real(rk), intent(in) :: flow  !< [m2/s]

      associate (share => self%share(:, entry), path => self%path(:, entry), &
                 s => self%mesh%fracture%cell_s)
         pressure = self%entry_in_situ(entry) + dot_product(share, state%pressure) &
                    + dot_product(self%joint_share(:, entry), state%joint_pressure)
         ! Before the first step nothing flows.
         if (.not. (any(path > 0.0_rk) .and. abs(flow) > 0.0_rk)) return
         pressure = pressure + flow*6.0_rk*self%model%settings%viscosity &
                    *sum(path*(s(2, :) - s(1, :))/state%aperture**3*self%thickness(state))
      end associate
   end function entry_pressure

   !> Pressure in situ at a well, at its first entry [Pa].
   pure real(rk) function well_in_situ(self, well) result(pressure)
      class(coarse_problem_t), intent(in) :: self
      integer(ik), intent(in) :: well  !< number of the well in the scene

      pressure = self%entry_in_situ(findloc(self%well_of, well, dim=1, kind=ik))
   end function well_in_situ

   !> Pressure in situ at an entry: at its point, or the mean over the fracture that it supplies
   !! [Pa].
   pure real(rk) function entry_in_situ(self, entry) result(pressure)
      class(coarse_problem_t), intent(in) :: self
      integer(ik), intent(in) :: entry  !< number among those of all wells

      pressure = 0.0_rk
      if (.not. allocated(self%model%in_situ)) return
      associate (given => self%entries(entry))
         if (given%at_point .or. given%fracture == 0) then
            pressure = self%model%in_situ%pressure_at(given%y)
         else
            pressure = dot_product(self%share(:, entry), self%model%cells%pressure_in_situ)
         end if
      end associate
   end function entry_in_situ

   !> Total pressure in the cells; that of the state is relative to the state in situ [Pa].
   pure function rock_pressure(self, state) result(pressure)
      class(coarse_problem_t), intent(in) :: self
      type(state_t), intent(in) :: state
      real(rk) :: pressure(self%mesh%n_cells)

      pressure = state%unknowns(3, :self%mesh%n_cells)
      if (allocated(self%model%in_situ)) then
         pressure = pressure + self%model%in_situ%pressure_at(cell_heights(self%mesh))
      end if
   end function rock_pressure

   !> Total pressure in the fracture cells [Pa].
   pure function fracture_pressure(self, state) result(pressure)
      class(coarse_problem_t), intent(in) :: self
      type(state_t), intent(in) :: state
      real(rk) :: pressure(size(state%pressure))

      pressure = state%pressure
      if (allocated(self%model%cells%pressure_in_situ)) then
         pressure = pressure + self%model%cells%pressure_in_situ
      end if
   end function fracture_pressure

   !> Total pressure in the joints [Pa].
   pure function joint_pressure(self, state) result(pressure)
      class(coarse_problem_t), intent(in) :: self
      type(state_t), intent(in) :: state
      real(rk) :: pressure(size(state%joint_pressure))

      pressure = state%joint_pressure
      if (allocated(self%model%joints%pressure_in_situ)) then
         pressure = pressure + self%model%joints%pressure_in_situ
      end if
   end function joint_pressure

   !> Ratio of the viscosity in the fracture cells to that of the scene, where the viscosity depends
   !! on pressure or temperature [-].
   pure function thickness(self, state)
      class(coarse_problem_t), intent(in) :: self
      type(state_t), intent(in) :: state
      real(rk) :: thickness(size(state%pressure))

      thickness = 1.0_rk
      if (allocated(self%model%settings%fluid_law)) then
         thickness = self%model%settings%fluid_law%thickness_at(self%fracture_pressure(state))
      end if
      if (allocated(self%model%cells%viscosity_ratio)) then
         thickness = thickness*self%model%cells%viscosity_ratio
      end if
   end function thickness

   !> Heights y of the centres of the cells [m].
   pure function cell_heights(mesh) result(y)
      type(mesh_t), intent(in) :: mesh
      real(rk) :: y(mesh%n_cells)
      integer(ik) :: c

      y = [(sum(mesh%xy(2, mesh%cell_nodes(:, c)))/3.0_rk, c=1, mesh%n_cells)]
   end function cell_heights

   !> Fluid volume in the fractures, without compression of the fluid and without the roughness of
   !! new faces [m2].
   pure real(rk) function fracture_volume(self, state) result(volume)
      class(coarse_problem_t), intent(in) :: self
      type(state_t), intent(in) :: state

      associate (s => self%mesh%fracture%cell_s)
         volume = sum((state%aperture - state%void - self%model%cells%roughness) &
                      *(s(2, :) - s(1, :)))
      end associate
   end function fracture_volume

end module twolevel_problem
