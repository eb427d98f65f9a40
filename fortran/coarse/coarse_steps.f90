!> Time steps of the coarse level. The matrix is factorized once per length of the step; a step
!! then costs one substitution and a few small Newton steps on the fractures.
submodule(coarse_model) coarse_steps
   use base_errors, only: raise_error
   use base_timers, only: phase_contact, phase_factorize, phase_solve
   use base_tolerances, only: same_time
   use coarse_diffusion, only: boundary_outflow, cell_outflow
   use coarse_fields, only: cell_contents, corner_tractions
   use coarse_fluid_law, only: add_fracture_balance
   use coarse_fractures, only: flow_paths_t
   use coarse_held_cells, only: choose_held, find_released
   use coarse_newton, only: solve_fractures
   use coarse_state, only: go_back
   use coarse_tips, only: dampers, jumps_of, tip_springs
   use coarse_rock, only: solid_t
   use coarse_wells, only: wells_t
   use mesh_geometry, only: cell_area
   implicit none(type, external)

contains

   module procedure equilibrate
   type(flow_paths_t) :: none
   real(rk) :: time

   call timers%heed(error)
   if (allocated(error)) return
   time = state%time
   none%settings = self%settings
   none%settings%equilibrate = .true.
   allocate (none%connections(2, 0))
   call solve_step(self, mesh, none, dt, state, timers, report, error)
   state%time = time
   if (report%converged) call rest_fluid(self, state)
   end procedure equilibrate

   module procedure advance
   type(flow_paths_t) :: paths

   call timers%heed(error)
   if (allocated(error)) return
   paths = self%flow_paths_t
   if (self%rock_wells%n > 0) then
      call self%rock_wells%find_indices(self%wells, dt, state%rings)
      call advance_with_wells(self, mesh, paths, dt, state, timers, report, error)
   else
      call solve_step(self, mesh, paths, dt, state, timers, report, error)
   end if
   if (allocated(error) .or. .not. report%converged) return
   if (.not. allocated(state%rings)) return
   if (self%rock_wells%n > 0) then
      call self%rock_wells%update_rings(dt, state%well_flow(self%wells%n + 1: &
                                                            self%wells%n_all), state%rings)
   else
      call self%rock_wells%update_rings(dt, [real(rk) ::], state%rings)
   end if
   end procedure advance

   !> A step with pressure-controlled wells in the rock, repeated until the results agree with the
   !! controls that have been tried.
   subroutine advance_with_wells(self, mesh, paths, dt, state, timers, report, error)
      class(coarse_model_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh
      type(flow_paths_t), intent(in) :: paths
      real(rk), intent(in) :: dt  !< [s]
      type(state_t), intent(inout) :: state
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      type(state_t) :: before
      logical :: any_changed
      integer(ik) :: first, k, last, most

      before = state
      first = self%wells%n + 1
      last = self%wells%n_all
      associate (wells => self%rock_wells, head_before => before%well_head(first:))
         call wells%choose_controls(self%wells, state%rock_well_control)
         most = 3*wells%n + 1
         do k = 1, 2*most + 30
            call wells%set_terms(self%wells, dt, head_before, self%matrix, any_changed)
            if (any_changed) self%condensed%dt = -1.0_rk
            call solve_step(self, mesh, paths, dt, state, timers, report, error)
            if (allocated(error) .or. .not. report%converged) return
            call wells%find_flows(self%wells, dt, head_before, state%unknowns(3, :mesh%n_cells), &
                                  state%well_flow(first:last), state%well_head(first:last), &
                                  state%well_rate(first:last))
            ! The balance contains the sources at a pressure of zero in the cells.
            report%mass_error = report%mass_error + dt*sum(wells%source &
                                                           - state%well_flow(first:last))
            call wells%correct_controls(self%wells, state%well_head(first:last), &
                                        state%well_rate(first:last), k > most, any_changed)
            if (.not. any_changed) exit
            call go_back(state, before)
         end do
         state%rock_well_control = wells%control
      end associate
      report%converged = .not. any_changed
      if (any_changed) report%reason = "no combination of well controls satisfies all well limits"
   end subroutine advance_with_wells

   !> Set the springs on the faces of the fractures: at tips, and dampers.
   subroutine support_faces(self, mesh, settings, dt)
      class(coarse_model_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh
      type(newton_settings_t), intent(in) :: settings  !< of the step
      real(rk), intent(in) :: dt  !< [s]
      real(rk), allocatable :: spring(:)

      spring = tip_springs(self%ends, self%rock, mesh, self%condensed)
      if (is_damped(settings)) then
         spring = spring + dampers(self%condensed, self%settings%damping/dt)
      end if
      call self%condensed%support(spring)
      call self%place_ends(mesh)
   end subroutine support_faces

   !> Right-hand side of the body: loads, sources, stored fluid.
   subroutine find_load(self, mesh, wells, dt, content, load, fluid)
      class(coarse_model_t), intent(in) :: self
      type(mesh_t), intent(in) :: mesh
      type(wells_t), intent(in) :: wells  !< of the step
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: content(:)  !< (cells) of fluid before the step [m2]
      real(rk), allocatable, intent(out) :: load(:, :)  !< (3, n_blocks) [N/m], [m2]
      real(rk), allocatable, intent(out) :: fluid(:)  !< (cells) injected, if any [m2/s]
      integer(ik) :: w

      load = self%matrix%elastic_known
      load(3, :) = load(3, :) + dt*self%matrix%flow_known
      if (self%layers%n > 0) then
         associate (of_layers => load(:2, mesh%n_cells + 1:mesh%n_cells + self%layers%n))
            of_layers = of_layers + dt*self%matrix%layer_known
         end associate
      end if
      load(3, :mesh%n_cells) = load(3, :mesh%n_cells) - content
      if (allocated(self%source)) then
         fluid = self%source(3, :)
         if (wells%n_all > wells%n) then
            do w = 1, self%rock_wells%n
               associate (into => fluid(self%rock_wells%cell(w)))
                  into = into + self%rock_wells%source(w)
               end associate
            end do
         end if
         load(:2, :mesh%n_cells) = load(:2, :mesh%n_cells) + self%source(:2, :)
         load(3, :mesh%n_cells) = load(3, :mesh%n_cells) - dt*fluid
      end if
      if (allocated(self%weight)) then
         load(:2, :mesh%n_cells) = load(:2, :mesh%n_cells) + self%weight
      end if
      if (allocated(self%rock%temperature)) call add_heat_load(self, mesh, load)
   end subroutine find_load

   !> Add the stress of the temperatures, and the fluid that they press out of the pores.
   subroutine add_heat_load(self, mesh, load)
      class(coarse_model_t), intent(in) :: self
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(inout) :: load(:, :)  !< (3, n_blocks) [N/m], [m2]
      real(rk), allocatable :: acting(:, :)
      type(solid_t) :: solid
      integer(ik) :: c

      allocate (acting, mold=load)
      acting = 0.0_rk
      acting = self%rock%with_heat(acting)
      load = load - self%matrix%pressure_forces(acting(3, :))
      do c = 1, mesh%n_cells
         solid = self%rock%solid_at(c)
         load(3, c) = load(3, c) - cell_area(mesh, c)*(solid%storage*acting(3, c) &
                                                       + solid%heat_content &
                                                       *self%rock%temperature(c))
      end do
   end subroutine add_heat_load

   !> Add the loads of dampers and of a stress in situ on the faces.
   subroutine add_face_loads(self, mesh, settings, dt, jump, load)
      class(coarse_model_t), intent(in) :: self
      type(mesh_t), intent(in) :: mesh
      type(newton_settings_t), intent(in) :: settings  !< of the step
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: jump(:, :, :)  !< (2, 2, fracture cells) before the step [m]
      real(rk), intent(inout) :: load(:)  !< on the condensed system [N/m], [m2]

      if (mesh%fracture%n_cells > 0 .and. is_damped(settings)) then
         load = load + dampers(self%condensed, self%settings%damping/dt) &
                *jumps_of(self%condensed, jump)
      end if
      if (allocated(self%in_situ)) then
         call self%in_situ%add_contact_tractions(mesh%fracture, self%condensed%length, &
                                                 self%condensed%normal, self%condensed%layout, load)
      end if
   end subroutine add_face_loads

   !> Solve a step with the present sources and matrix, again while cells that are held have to be
   !! released.
   subroutine solve_step(self, mesh, paths, dt, state, timers, report, error)
      class(coarse_model_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh
      type(flow_paths_t), intent(in) :: paths
      real(rk), intent(in) :: dt  !< [s]
      type(state_t), intent(inout) :: state
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      type(state_t) :: before
      logical :: released(mesh%fracture%n_cells)

      if (self%may_hold .and. .not. (paths%settings%equilibrate .or. is_factorized(self, dt))) then
         call choose_held(mesh, self%cells%law, self%ends, state, self%condensed)
      end if
      if (allocated(self%condensed%held)) before = state
      do
         call solve_held(self, mesh, paths, dt, state, timers, report, error)
         if (allocated(error) .or. .not. allocated(self%condensed%held)) return
         released = .true.
         if (report%converged) then
            call find_released(mesh, self%cells%law, state, self%condensed%held, released)
            if (.not. any(released)) return
         end if
         call self%condensed%hold(self%condensed%held .and. .not. released)
         if (.not. any(self%condensed%held)) deallocate (self%condensed%held)
         call go_back(state, before)
      end do
   end subroutine solve_step

   !> Whether the factors are those of a step length.
   pure logical function is_factorized(self, dt)
      class(coarse_model_t), intent(in) :: self
      real(rk), intent(in) :: dt  !< [s]

      is_factorized = abs(self%condensed%dt - dt) <= same_time*dt
   end function is_factorized

   !> Set the tractions of the cells that are held.
   subroutine set_reactions(self, rhs, g, state)
      class(coarse_model_t), intent(in) :: self
      real(rk), intent(in) :: rhs(:, :)  !< (3, n_blocks) [N/m], [N/m], [m2]
      real(rk), intent(in) :: g(:)  !< (6 n) load on the condensed system [N/m], [m2]
      type(state_t), intent(inout) :: state
      real(rk) :: force(size(g))
      integer(ik) :: end, i

      associate (condensed => self%condensed)
         call condensed%find_reactions(self%matrix, state%unknowns, rhs, g, force)
         do i = 1, condensed%n
            if (.not. condensed%held(i)) cycle
            do end = 1, 2
               associate (at => condensed%layout%at_jump(i, end))
                  state%traction(:, end, i) = [state%pressure(i), 0.0_rk] &
                                              - force(at:at + 1)/(0.5_rk*condensed%length(i))
               end associate
            end do
         end do
      end associate
   end subroutine set_reactions

   !> Solve a step where the jumps of cells that are held are zero.
   subroutine solve_held(self, mesh, paths, dt, state, timers, report, error)
      class(coarse_model_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh
      type(flow_paths_t), intent(in) :: paths
      real(rk), intent(in) :: dt  !< [s]
      type(state_t), intent(inout) :: state
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: fluid(:), rhs(:, :), g(:), q(:)
      type(state_t) :: before
      integer(ik) :: n

      n = mesh%fracture%n_cells
      if (.not. is_factorized(self, dt)) then
         call timers%start(phase_factorize)
         call self%layers%set_terms(dt, self%matrix)
         call self%condensed%factorize(mesh, self%matrix, dt, error)
         call timers%stop(phase_factorize)
         if (allocated(error)) return
      end if
      if (n > 0) call support_faces(self, mesh, paths%settings, dt)
      allocate (g(self%condensed%layout%count()), q(self%condensed%layout%count()))
      call timers%start(phase_assemble)
      call find_load(self, mesh, paths%wells, dt, state%content, rhs, fluid)
      if (self%layers%n > 0) then
         call self%layers%set_given(self%sides)
         call self%layers%add_load(state%unknowns, state%layer, rhs)
      end if
      call timers%stop(phase_assemble)
      call timers%start(phase_solve)
      call self%condensed%condense(rhs, g, error)
      call timers%stop(phase_solve)
      if (allocated(error)) return
      call add_face_loads(self, mesh, paths%settings, dt, state%jump, g)

      before = state
      report%converged = .true.
      if (n > 0) then
         call timers%start(phase_contact)
         call solve_fractures(self%fracture_problem_t, paths, dt, g, state, q, report)
         call timers%stop(phase_contact)
         if (.not. report%converged) return
         state%injection = self%cells%injection
         if (paths%wells%n > 0) then
            state%injection = state%injection + matmul(paths%wells%share, &
                                                       paths%wells%at_places(state%well_flow))
         end if
      end if
      call timers%start(phase_solve)
      call self%condensed%expand(q, rhs, state%unknowns, error)
      call timers%stop(phase_solve)
      if (allocated(error)) return
      if (allocated(self%condensed%held)) call set_reactions(self, rhs, g, state)
      call timers%start(phase_assemble)
      if (self%layers%n > 0) call self%layers%update(state%unknowns, state%layer)
      call corner_tractions(self%regions, self%rock%with_heat(state%unknowns), state%tractions)
      call cell_contents(mesh, self%rock, self%regions, self%matrix, state%unknowns, &
                         state%tractions, state%content)
      state%time = state%time + dt
      call book_fluid(self, mesh, paths, fluid, dt, before, state, report)
      call timers%stop(phase_assemble)
      if (.not. sum(abs(state%unknowns)) <= huge(1.0_rk)) then
         call raise_error(error, "coarse_model", "the solution is not a finite number")
      end if
   end subroutine solve_held

   !> Whether slip radiates energy; not in the initial state, which takes no time.
   pure logical function is_damped(settings)
      type(newton_settings_t), intent(in) :: settings

      is_damped = settings%damping > 0.0_rk .and. .not. settings%equilibrate
   end function is_damped

   !> The fluid balance of the step: what is stored less what has been supplied, and the parts of
   !! it that are reported.
   subroutine book_fluid(self, mesh, paths, fluid, dt, before, after, report)
      class(coarse_model_t), intent(in) :: self
      type(mesh_t), intent(in) :: mesh
      type(flow_paths_t), intent(in) :: paths
      real(rk), allocatable, intent(in) :: fluid(:)  !< (n_cells) into the rock [m2/s]
      real(rk), intent(in) :: dt  !< [s]
      type(state_t), intent(in) :: before, after
      type(step_report_t), intent(inout) :: report
      real(rk), allocatable :: outflow(:)

      report%compressed = 0.0_rk
      report%rock_outflow = 0.0_rk
      associate (balance => report%mass_error)
         balance = sum(after%content - before%content)
         if (mesh%fracture%n_cells > 0) then
            call add_fracture_balance(paths, self%cells, self%condensed%length, dt, before, after, &
                                      report%compressed, balance)
         end if
         if (allocated(fluid)) balance = balance - dt*sum(fluid)
         if (self%drained .and. self%layers%n > 0) then
            report%rock_outflow = dt*boundary_outflow(mesh, self%regions, self%regions%flux, &
                                                      self%regions%scalars_of(after%unknowns)) &
                                  + self%layers%drained()
            balance = balance + report%rock_outflow
         else if (self%drained) then
            allocate (outflow(mesh%n_cells))
            call cell_outflow(mesh, self%regions, self%regions%flux, after%unknowns(3, :), outflow)
            report%rock_outflow = dt*sum(outflow)
            if (mesh%fracture%n_cells > 0) then
               ! Fluid that crosses the faces of fractures remains in the body.
               report%rock_outflow = report%rock_outflow &
                                     + dt*sum(self%condensed%length*after%leakoff)
            end if
            balance = balance + report%rock_outflow
         end if
      end associate
   end subroutine book_fluid

end submodule coarse_steps
