!> Heat in a simulation: the flows and temperatures of its wells, a step, and what is reported.
module twolevel_heat
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_time
   use coarse_layer_profiles, only: kept_faces_t
   use coarse_state, only: state_t
   use heat_errors, only: add_errors_at_wells, temperature_errors, well_errors
   use heat_field, only: new_field
   use heat_flows, only: set_flows
   use heat_links, only: external_t
   use heat_model, only: heat_model_t
   use heat_state, only: heat_state_t
   use heat_steps, only: advance_heat
   use heat_transfer, only: transfer_heat
   use mesh_types, only: mesh_map_t
   use report_rows, only: heat_row_t, summary_t, well_row_t
   use report_simulation, only: snapshot_t
   use scene_fluid_law, only: viscosity_ratio
   use scene_types, only: injection_t, scene_t
   use twolevel_levels_state, only: levels_state_t
   use twolevel_problem, only: coarse_problem_t
   use twolevel_stepping, only: first_step
   use twolevel_wells, only: rate
   implicit none(type, external)
   private

   public :: act, add_heat_fields, add_well_temperatures, carry_heat, follow_heat, heat_row
   public :: predict_heat, set_heat, settle_heat, settlings_max, warn_of_heat

   integer, parameter :: settlings_max = 3  !< tries that are repeated since they moved other heat

contains

   !> First substep, which layers resolve: ten first steps, or a share of equal ones [s].
   pure real(rk) function first_substep(scene)
      type(scene_t), intent(in) :: scene
      real(rk), parameter :: longest = 1.0_rk, steps = 10.0_rk, share = 1.0e-4_rk

      associate (time => scene%time)
         first_substep = min(longest, merge(steps*first_step(time), share*time%step, &
                                            time%tolerance > 0.0_rk))
      end associate
   end function first_substep

   !> Discretize heat on the mesh of a problem.
   subroutine set_heat(scene, problem, error)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(inout) :: problem
      type(error_t), allocatable, intent(out) :: error

      if (.not. allocated(scene%heat)) return
      allocate (problem%heat)
      call problem%heat%set_mesh(problem%mesh, scene, problem%model%connections, &
                                 problem%model%joints, first_substep(scene), error)
      if (.not. allocated(error)) call set_viscosity(scene, problem%heat%initial, problem)
   end subroutine set_heat

   !> Advance heat by an accepted step of the coarse level; before the first one, begin.
   subroutine follow_heat(scene, before, after, problem, now, error)
      type(scene_t), intent(in) :: scene
      type(state_t), intent(in) :: before, after
      type(coarse_problem_t), intent(inout) :: problem
      type(heat_state_t), intent(inout) :: now
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: acting(:)
      real(rk) :: dt

      if (.not. allocated(problem%heat)) return
      dt = after%time - before%time
      if (dt > 0.0_rk) then
         call begin_heat(scene, before, problem, now)
      else
         call begin_heat(scene, after, problem, now)
      end if
      if (.not. dt > same_time*after%time) return
      if (allocated(now%acting)) acting = now%acting
      call advance(scene, before%time, after, problem, now, error)
      if (allocated(acting)) now%acting = acting
   end subroutine follow_heat

   !> Set the heat of the first state.
   subroutine begin_heat(scene, state, problem, now)
      type(scene_t), intent(in) :: scene
      type(state_t), intent(in) :: state
      type(coarse_problem_t), intent(in) :: problem
      type(heat_state_t), intent(inout) :: now

      if (allocated(now%temperature)) return
      associate (cell_s => problem%mesh%fracture%cell_s)
         call problem%heat%begin(state%aperture - state%void, cell_s(2, :) - cell_s(1, :), &
                                 first_substep(scene), size(scene%injections), now)
      end associate
   end subroutine begin_heat

   !> Let the temperatures act that the step to come ends with: those of a try of the same step, or
   !! extrapolated ones; else those with the flows of the last step.
   subroutine predict_heat(scene, state, dt, problem, now, error)
      type(scene_t), intent(in) :: scene
      type(state_t), intent(in) :: state  !< before the step
      real(rk), intent(in) :: dt  !< [s]
      type(coarse_problem_t), intent(inout) :: problem
      type(heat_state_t), intent(inout) :: now
      type(error_t), allocatable, intent(out) :: error
      type(heat_state_t) :: then
      type(state_t) :: after
      real(rk), allocatable :: rise(:)
      logical :: is_known

      if (.not. acts(scene, problem)) return
      is_known = all(abs(problem%heat_span - [state%time, state%time + dt]) <= 0.0_rk)
      if (.not. is_known) call extrapolate(problem%heat, dt, now, rise)
      if (.not. allocated(rise)) then
         if (.not. is_known) then
            after = state
            after%time = state%time + dt
            then = now
            call begin_heat(scene, state, problem, then)
            call advance(scene, state%time, after, problem, then, error)
            if (allocated(error)) return
         end if
         rise = problem%heat_after%temperature - problem%heat%initial
      end if
      call move_alloc(rise, now%acting)
      call act(scene, problem, now)
   end subroutine predict_heat

   !> Share of the heat that the temperatures which act may have wrong in a step. Where sources heat
   !! the rock, the pressure is that of the change of temperature in the step.
   pure real(rk) function slack(heat)
      type(heat_model_t), intent(in) :: heat

      slack = merge(5.0e-4_rk, 5.0e-3_rk, allocated(heat%heat%source_power))
   end function slack

   !> The rise after a step by the rates, if these hardly change: by their change in the last two
   !! substeps, if this moves a small share of the heat (measured: a quarter of it is wrong at
   !! most); where it is not known, if a substep may be as long as the step.
   pure subroutine extrapolate(heat, dt, now, rise)
      type(heat_model_t), intent(in) :: heat
      real(rk), intent(in) :: dt  !< [s]
      type(heat_state_t), intent(in) :: now
      real(rk), allocatable, intent(inout) :: rise(:)  !< unallocated if it is not to be found so
      real(rk), allocatable :: change(:)

      if (.not. allocated(now%rate)) return
      rise = now%temperature + dt*now%rate - heat%initial
      if (allocated(now%bend)) then
         change = dt*(dt + now%last)*now%bend
         if (0.25_rk*sum(now%capacity*abs(change)) <= slack(heat) &
             *sum(now%capacity*abs(now%temperature - heat%initial))) then
            rise = rise + change
         else
            deallocate (rise)
         end if
      else if (now%next < dt) then
         deallocate (rise)
      end if
   end subroutine extrapolate

   !> Compare the temperatures that acted in a try of a step with those that its flows give. Where
   !! these have moved other heat by more than a tolerance, the try is to be repeated with them.
   subroutine settle_heat(scene, before, after, problem, now, is_settled, error)
      type(scene_t), intent(in) :: scene
      type(state_t), intent(in) :: before, after
      type(coarse_problem_t), intent(inout) :: problem
      type(heat_state_t), intent(in) :: now  !< before the step
      logical, intent(out) :: is_settled
      type(error_t), allocatable, intent(out) :: error
      type(heat_state_t) :: then

      is_settled = .true.
      if (.not. acts(scene, problem)) return
      then = now
      call begin_heat(scene, before, problem, then)
      call advance(scene, before%time, after, problem, then, error)
      if (allocated(error)) return
      associate (rise => then%temperature - problem%heat%initial)
         is_settled = sum(then%capacity*abs(rise - now%acting)) &
                      <= slack(problem%heat)*sum(then%capacity*abs(rise))
      end associate
   end subroutine settle_heat

   !> Whether temperatures act on stress, fluid in the rock or viscosity.
   pure logical function acts(scene, problem)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem

      acts = allocated(problem%heat)
      if (acts) acts = expands(problem) .or. allocated(scene%fluid%table_temperature)
   end function acts

   !> Whether temperatures act on stress or fluid in the rock.
   pure logical function expands(problem)
      type(coarse_problem_t), intent(in) :: problem

      expands = any(abs([problem%model%rock%heat_stress, problem%model%rock%heat_content]) > 0.0_rk)
   end function expands

   !> Set the viscosity in the fracture cells.
   pure subroutine set_viscosity(scene, temperature, problem)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: temperature(:)  !< of the unknowns of heat, less that of &heat [K]
      type(coarse_problem_t), intent(inout) :: problem

      if (.not. allocated(scene%fluid%table_temperature)) return
      associate (heat => problem%heat)
         problem%model%cells%viscosity_ratio = &
            viscosity_ratio(scene%fluid, heat%heat%temperature &
                            + temperature(heat%first_cell:heat%first_joint - 1))
      end associate
   end subroutine set_viscosity

   !> Let the temperatures of a state act that acted when it was found.
   subroutine act(scene, problem, now)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(inout) :: problem
      type(heat_state_t), intent(in) :: now

      if (.not. allocated(now%acting)) then
         if (allocated(problem%model%rock%temperature)) deallocate (problem%model%rock%temperature)
         if (allocated(now%temperature)) call set_viscosity(scene, now%temperature, problem)
         return
      end if
      associate (heat => problem%heat)
         call set_viscosity(scene, heat%initial + now%acting, problem)
         if (.not. expands(problem)) return
         if (allocated(problem%model%rock%temperature) .and. &
             allocated(problem%heat_field%acting)) then
            if (all(abs(problem%heat_field%acting - now%acting) <= 0.0_rk)) return
         end if
         associate (capacity => heat%rock_capacity())
            problem%model%rock%temperature = heat%of_cells(capacity*now%acting(:size(capacity))) &
                                             /heat%of_cells(capacity)
         end associate
         problem%heat_field = new_field(heat, now%acting, problem%model%rock%temperature)
      end associate
   end subroutine act

   !> Advance heat by a step that ends with given flows, or take the result of the last call if it
   !! is the same step with the same flows.
   subroutine advance(scene, since, after, problem, now, error)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: since  !< start of the step [s]
      type(state_t), intent(in) :: after
      type(coarse_problem_t), intent(inout) :: problem
      type(heat_state_t), intent(inout) :: now
      type(error_t), allocatable, intent(out) :: error
      logical :: is_same

      associate (heat => problem%heat, span => [since, after%time])
         call set_flows(heat, problem%mesh, problem%model, after, &
                        well_flows(scene, problem, since, after))
         associate (flows => [heat%links%flow, heat%externals%flow])
            is_same = all(abs(problem%heat_span - span) <= 0.0_rk) .and. &
                      allocated(problem%heat_flows)
            if (is_same) is_same = size(problem%heat_flows) == size(flows)
            if (is_same) is_same = all(abs(problem%heat_flows - flows) <= 0.0_rk)
            if (.not. is_same) then
               call advance_heat(heat, after%time - since, now, error)
               if (allocated(error)) return
               problem%heat_span = span
               problem%heat_flows = flows
               problem%heat_after = now
            end if
         end associate
         now = problem%heat_after
      end associate
   end subroutine advance

   !> Transfer heat to a problem whose mesh has grown.
   subroutine carry_heat(scene, before, map, faces, problem, levels, error)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: before  !< on the mesh before
      type(mesh_map_t), intent(in) :: map
      type(kept_faces_t), intent(in) :: faces
      type(coarse_problem_t), intent(inout) :: problem
      type(levels_state_t), intent(inout) :: levels
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: filled(problem%mesh%fracture%n_cells)

      if (.not. allocated(scene%heat)) return
      call set_heat(scene, problem, error)
      if (allocated(error)) return
      filled = 0.0_rk
      associate (s => problem%mesh%fracture%cell_s, new => levels%grown)
         if (scene%growth%new_volume == "prefilled") then
            filled(new) = levels%coarse%aperture(new)*(s(2, new) - s(1, new))
         end if
      end associate
      if (allocated(levels%heat%temperature)) then
         call transfer_heat(before%heat, problem%heat, map, faces, filled, levels%heat)
         call set_viscosity(scene, levels%heat%temperature, problem)
      end if
      problem%heat_span = before%heat_span
      problem%heat_after = before%heat_after
      if (allocated(problem%heat_after%temperature)) then
         call transfer_heat(before%heat, problem%heat, map, faces, filled, problem%heat_after)
      end if
   end subroutine carry_heat

   !> What wells supply to fracture cells, joints and rock in a step.
   function well_flows(scene, problem, since, state) result(externals)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: since  !< start of the step [s]
      type(state_t), intent(in) :: state  !< after it
      type(external_t), allocatable :: externals(:)
      type(external_t) :: external
      integer(ik) :: e, i, j

      allocate (externals(0))
      do e = 1, size(problem%entries, kind=ik)
         external%well = problem%well_of(e)
         associate (well => scene%injections(external%well), &
                    flow => problem%heat%fluid_capacity*entry_flow(problem, e, since, state))
            external%temperature = temperature_of(well, 0.5_rk*(since + state%time)) &
                                   - problem%heat%heat%temperature
            if (well%fracture == 0) then
               call add(problem%rock_cell(external%well), flow)
               cycle
            end if
            do i = 1, size(problem%share, 1, kind=ik)
               call add(problem%heat%first_cell - 1 + i, flow*problem%share(i, e))
            end do
            do j = 1, size(problem%joint_share, 1, kind=ik)
               call add(problem%heat%first_joint - 1 + j, flow*problem%joint_share(j, e))
            end do
         end associate
      end do

   contains

      subroutine add(unknown, flow)
         integer(ik), intent(in) :: unknown
         real(rk), intent(in) :: flow  !< [W/(m K)]

         if (.not. abs(flow) > 0.0_rk) return
         external%unknown = unknown
         external%flow = flow
         externals = [externals, external]
      end subroutine add

   end function well_flows

   !> Flow of an entry into fracture or rock in a step [m2/s].
   pure real(rk) function entry_flow(problem, entry, since, state) result(flow)
      type(coarse_problem_t), intent(in) :: problem
      integer(ik), intent(in) :: entry  !< among those of all wells
      real(rk), intent(in) :: since  !< start of the step [s]
      type(state_t), intent(in) :: state  !< after it
      integer(ik) :: k

      associate (wells => problem%model%wells, w => problem%well_of(entry))
         flow = rate(problem%entries(entry), since, state%time - since)
         if (wells%n_all == 0) return
         k = findloc(wells%number, w, dim=1, kind=ik)
         if (k == 0) return
         flow = state%well_flow(k)
         if (k > wells%n) return
         if (wells%first_entry(k) == k) return
         k = wells%first_entry(k) - wells%n + entry - findloc(problem%well_of, w, dim=1, kind=ik)
         flow = state%well_flow(wells%n_all + k)
      end associate
   end function entry_flow

   !> Temperature of what a well supplies at a time; 0 for one that only extracts [K].
   pure real(rk) function temperature_of(well, time) result(temperature)
      type(injection_t), intent(in) :: well
      real(rk), intent(in) :: time  !< [s]
      integer(ik) :: stage

      temperature = 0.0_rk
      if (.not. allocated(well%temperature)) return
      do stage = well%stage_count(), 2, -1
         if (well%stage_start(stage) <= time) exit
      end do
      temperature = well%temperature(max(stage, 1_ik))
   end function temperature_of

   !> Warn where temperatures leave their range, as with multi-point fluxes on obtuse cells.
   subroutine warn_of_heat(state, summary)
      type(heat_state_t), intent(in) :: state
      type(summary_t), intent(inout) :: summary
      real(rk), parameter :: share = 0.01_rk  ! of the range

      associate (range => state%range(2) - state%range(1))
         if (state%beyond_range > share*range) then
            call summary%warn("temperatures leave the range of those given by more than a "// &
                              "hundredth of it (heat_beyond_range_k): smaller cells make this "// &
                              "less")
         end if
      end associate
   end subroutine warn_of_heat

   !> The columns of heat of history.csv.
   pure type(heat_row_t) function heat_row(state) result(row)
      type(heat_state_t), intent(in) :: state

      row = heat_row_t(state%stored, state%by_wells, state%by_sides, state%balance_error(), &
                       state%beyond_range)
   end function heat_row

   !> Add the temperatures to the fields of a state.
   pure subroutine add_heat_fields(problem, state, time, fields)
      type(coarse_problem_t), intent(in) :: problem
      type(heat_state_t), intent(in) :: state
      real(rk), intent(in) :: time  !< [s]
      type(snapshot_t), intent(inout) :: fields
      real(rk), allocatable :: behind(:)
      real(rk), dimension(:), allocatable :: carried, error

      if (.not. (allocated(problem%heat) .and. allocated(state%temperature))) return
      associate (heat => problem%heat, datum => problem%heat%heat%temperature)
         behind = behind_wells(problem)
         allocate (carried(heat%n), error(heat%n))
         call temperature_errors(heat, state, time, behind, error, carried)
         call add_errors_at_wells(heat, state, behind, carried, error)
         associate (first => heat%first_cell, last => heat%first_joint - 1)
            fields%fracture%temperature = datum + state%temperature(first:last)
            fields%fracture%error%temperature = error(first:last)
         end associate
         if (.not. allocated(fields%matrix%pressure)) return
         fields%matrix%temperature = datum + heat%cell_means(state)
         fields%matrix%temperature_error = error(:heat%mesh%n_cells)
      end associate
   end subroutine add_heat_fields

   !> Add the temperatures to the rows of the wells.
   pure subroutine add_well_temperatures(problem, state, time, rows)
      type(coarse_problem_t), intent(in) :: problem
      type(heat_state_t), intent(in) :: state
      real(rk), intent(in) :: time  !< [s]
      type(well_row_t), intent(inout) :: rows(:)
      real(rk), dimension(:), allocatable :: carried, error

      if (.not. allocated(problem%heat)) return
      allocate (carried(problem%heat%n), error(problem%heat%n))
      call temperature_errors(problem%heat, state, time, behind_wells(problem), error, carried)
      rows%temperature = problem%heat%heat%temperature + state%well_temperature
      rows%error%temperature = well_errors(problem%heat, state, error, carried)
   end subroutine add_well_temperatures

   !> The share of each fracture cell that lies behind a well at a point of it, at a dead end;
   !! -1 without such a well.
   pure function behind_wells(problem) result(behind)
      type(coarse_problem_t), intent(in) :: problem
      real(rk), allocatable :: behind(:)  !< (fracture cells) [-]
      integer(ik) :: e, i, k, point

      associate (fracture => problem%mesh%fracture, heat => problem%heat)
         allocate (behind(fracture%n_cells), source=-1.0_rk)
         do e = 1, size(problem%entries, kind=ik)
            if (.not. problem%entries(e)%at_point) cycle
            do i = 1, fracture%n_cells
               if (.not. problem%share(i, e) > 0.0_rk) cycle
               behind(i) = max(behind(i), 0.0_rk)
               do k = 1, 2
                  point = fracture%cell_points(k, i)
                  if (fracture%point_cells%length(point) > 1) cycle
                  if (any(problem%model%joints%point == point)) cycle
                  associate (well => problem%entries(e), end => fracture%point_xy(:, point), &
                             length => fracture%cell_s(2, i) - fracture%cell_s(1, i))
                     behind(i) = max(behind(i), norm2([well%x, well%y] - end)/length)
                  end associate
               end do
            end do
         end do
      end associate
   end function behind_wells

end module twolevel_heat
