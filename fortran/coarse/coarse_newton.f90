!> One time step of the fractures: the iteration of contact_newton on the equations of a step, and
!! the conditions for accepting its result.
!!
!! The equations are contact at both ends of every cell, and the fluid (coarse_fracture_flow,
!! coarse_well_flow, coarse_fluid_law). Their unknowns are those of fracture_layout_t.
module coarse_newton
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use base_kinds, only: ik, rk
   use coarse_condensed, only: condensed_t
   use coarse_fluid_law, only: add_fluid_law
   use coarse_fracture_flow, only: fill_balance, fill_branch, fill_equilibrium, fill_exchange, &
                                   fill_flow, fill_joint
   use coarse_fractures, only: cell_fluid_t, flow_paths_t, fracture_system_t, prepare
   use coarse_full_step, only: find_full_step, kinds_t, reduced_t
   use coarse_joints, only: flows_in_loops, unknown_flow
   use coarse_pivoting, only: pivot_fractures
   use coarse_sparse_step, only: sparse_step_t
   use coarse_state, only: fracture_cells_t, state_t, step_report_t
   use coarse_well_flow, only: fill_well, find_entry_flows, find_well
   use contact_newton, only: iterate, iteration_report_t, iteration_settings_t, outcome_converged, &
                             outcome_not_a_number, outcome_singular, step_quality_t
   use contact_point, only: contact_equations, contact_equations_t, contact_residual
   implicit none(type, external)
   private

   public :: equations_t, fracture_problem_t, solve_fractures

   !> Data of the equations of the fractures of one mesh, from step to step.
   type, extends(flow_paths_t) :: fracture_problem_t
      type(condensed_t) :: condensed
      type(sparse_step_t) :: factors  !< of the linear step unless the condensed matrix is full
      type(reduced_t) :: reduced  !< the same if it is
      type(fracture_cells_t) :: cells  !< set by the caller for each mesh
   end type fracture_problem_t

   !> The equations of one step.
   type, extends(fracture_system_t) :: equations_t
      type(sparse_step_t), pointer :: factors => null()  !< needed unless the matrix is full
      type(kinds_t) :: kinds  !< unknowns by their meaning; see find_kinds
      type(reduced_t), pointer :: reduced => null()  !< needed if the matrix is full
   contains
      procedure :: evaluate
      procedure :: find_step
      procedure :: restart
   end type equations_t

   !> Length of a step, over that of the last one, from which on slower methods are tried where the
   !! iteration fails: a step cut to half mostly converges in a few iterations [-].
   real(rk), parameter :: share_to_persevere = 0.3_rk

   integer(ik), parameter :: brief = 15  !< iterations from a guess: most take five

   real(rk), parameter :: contact_residual_max = 1.0e-8_rk  !< of an accepted step, relative

contains

   !> Solve one time step of the fractures, with the rock condensed. `state` is that before the step
   !! and is replaced only if the iteration converges.
   subroutine solve_fractures(problem, paths, dt, g, state, q, report)
      type(fracture_problem_t), intent(inout), target :: problem
      type(flow_paths_t), intent(in), target :: paths
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in), target :: g(:)  !< (6 n) load on the condensed system [N/m], [m2]
      type(state_t), intent(inout), target :: state
      real(rk), intent(out) :: q(:)  !< (6 n) unknowns of the condensed system [m], [Pa]
      type(step_report_t), intent(out) :: report
      type(equations_t) :: eq
      type(iteration_report_t) :: found
      type(iteration_settings_t) :: how
      real(rk), allocatable :: start(:), x(:)
      logical :: perseveres

      call prepare(problem%condensed, problem%cells, paths, dt, g, state, eq)
      eq%factors => problem%factors
      call problem%reduced%keep_for(problem%condensed%factorizations, state%time, dt)
      eq%reduced => problem%reduced
      how = iteration_settings_t(tolerance=paths%settings%tolerance, &
                                 iterations_max=paths%settings%iterations_max, &
                                 with_condition=.true., allows_rounding=.true.)
      call find_start(eq, state, start)
      eq%start = start
      perseveres = .true.
      if (state%guess%is_known(size(start, kind=ik)) .and. .not. paths%settings%equilibrate) then
         perseveres = .not. dt > share_to_persevere*state%guess%dt
         how%perseveres = .false.
         how%iterations_max = min(how%iterations_max, brief)
         call attempt(state%guess%from(start, dt))
         how%iterations_max = paths%settings%iterations_max
         eq%is_flat = .true.
         call attempt(start)
         eq%is_flat = .false.
         how%perseveres = .true.
      end if
      if (perseveres) call attempt(start)
      if (found%outcome == outcome_converged .and. .not. paths%settings%equilibrate) then
         call state%guess%remember(dt, start, x)
      end if
      q = eq%q
      report%stress_scale = eq%stress_scale
      report%iterations = found%iterations
      report%condition = found%condition
      report%error_bound = found%error_bound
      select case (found%outcome)
      case (outcome_converged)
         report%converged = .true.
      case (outcome_not_a_number)
         report%reason = "NaN in contact or flow of the fractures"
      case (outcome_singular)
         report%reason = "the equations of contact and flow on the fractures are singular"
         report%cell = worst_cell(eq, x)
      case default
         report%reason = "the iteration on contact and flow of the fractures did not converge"
         report%cell = worst_cell(eq, x)
      end select
      if (report%converged) call accept(eq, x, state, report)

   contains

      !> Iterate from a guess, unless the step is solved.
      subroutine attempt(from)
         real(rk), intent(in) :: from(:)  !< [Pa]
         integer(ik) :: spent

         if (found%outcome == outcome_converged) return
         spent = found%iterations
         found = iteration_report_t()
         x = from
         eq%state = reshape(state%contact, [size(eq%state)])
         eq%slip_sign = 0
         call iterate(eq, x, how, found)
         found%iterations = found%iterations + spent
      end subroutine attempt

   end subroutine solve_fractures

   !> The cell with the largest residual at x; 0: none.
   integer(ik) function worst_cell(eq, x) result(worst)
      type(equations_t), intent(inout) :: eq
      real(rk), intent(in) :: x(:)  !< [Pa]
      real(rk) :: largest, rest
      integer(ik) :: i, k

      worst = 0
      largest = 0.0_rk
      call eq%evaluate(x)
      do i = 1, eq%layout%n_cells
         rest = abs(eq%residual(eq%layout%at_pressure(i)))
         do k = 1, 2
            associate (at => eq%layout%at_jump(i, k))
               rest = max(rest, maxval(abs(eq%residual(at:at + 1))), &
                          abs(eq%residual(eq%layout%at_face_pressure(i, k))))
            end associate
         end do
         if (.not. rest > largest) cycle
         largest = rest
         worst = i
      end do
   end function worst_cell

   !> Initial guess: the last state without flow, the rock at the faces at the pressure of the
   !! fluid.
   pure subroutine find_start(eq, state, x)
      type(equations_t), intent(in) :: eq
      type(state_t), intent(in) :: state
      real(rk), allocatable, intent(out) :: x(:)  !< [Pa]
      integer(ik) :: at, i, k

      allocate (x(eq%layout%count()), source=0.0_rk)
      do i = 1, eq%layout%n_cells
         do k = 1, 2
            at = eq%layout%at_jump(i, k)
            x(at:at + 1) = state%jump(:, k, i)*eq%stiffness
            x(eq%layout%at_face_pressure(i, k)) = state%pressure(i)
         end do
         x(eq%layout%at_pressure(i)) = eq%unknown_of_fluid(i, state%pressure(i), state%void(i))
      end do
      if (eq%layout%n_wells > 0) x(eq%layout%at_well(1_ik):eq%layout%at_well(eq%layout%n_wells)) &
         & = eq%paths%wells%first_flows(state%well_flow, state%well_head, eq%dt)*eq%dt/eq%unit
      do i = 1, eq%layout%n_joints
         x(eq%layout%at_joint(i)) = eq%paths%joints%mean_pressure(i, state%pressure)
      end do
   end subroutine find_start

   !> Check the solution against the law itself and make it the state.
   subroutine accept(eq, x, state, report)
      type(equations_t), intent(in) :: eq
      real(rk), intent(in) :: x(:)  !< the solution [Pa]
      type(state_t), intent(inout) :: state
      type(step_report_t), intent(inout) :: report
      type(cell_fluid_t) :: fluid(eq%layout%n_cells)
      real(rk) :: aperture(eq%layout%n_cells), head
      integer(ik) :: i

      call check_fluid(eq, x, aperture, fluid, report)
      if (report%converged) call check_contact(eq, report)
      if (.not. report%converged) return
      call keep_contact(eq, state)
      associate (at => eq%condensed%layout, length => eq%condensed%length)
         do i = 1, eq%layout%n_cells
            state%leakoff(i) = -(eq%force(at%at_face_pressure(i, 1)) &
                                 + eq%force(at%at_face_pressure(i, 2)))/(eq%dt*length(i))
         end do
      end associate
      state%aperture = aperture
      state%pressure = fluid%pressure
      state%void = fluid%void
      report%loop_flow_error = loop_flow_error(eq, x, aperture, report)
      associate (layout => eq%layout, to_flow => eq%unit/eq%dt)
         state%flow = x(layout%at_flow([(i, i=1, layout%n_flows)]))*to_flow
         state%branch_flow = x(layout%at_branch([(i, i=1, layout%n_branches)]))*to_flow
         do i = 1, eq%paths%wells%n
            call find_well(i, x, eq, state%well_flow(i), head, state%well_rate(i))
            state%well_head(i) = head
            call find_entry_flows(i, x, eq, state%well_flow)
         end do
         state%joint_pressure = x(layout%at_joint([(i, i=1, layout%n_joints)]))
      end associate
   end subroutine accept

   !> Check that apertures are positive and that no more fluid is extracted than there is.
   subroutine check_fluid(eq, x, aperture, fluid, report)
      type(equations_t), intent(in) :: eq
      real(rk), intent(in) :: x(:)  !< the solution [Pa]
      real(rk), intent(out) :: aperture(:)  !< (cells) [m]
      type(cell_fluid_t), intent(out) :: fluid(:)  !< (cells)
      type(step_report_t), intent(inout) :: report
      integer(ik) :: i

      associate (cells => eq%cells, at => eq%condensed%layout)
         do i = 1, eq%layout%n_cells
            aperture(i) = cells%residual_aperture(i) &
                          + 0.5_rk*(eq%q(at%at_jump(i, 1)) + eq%q(at%at_jump(i, 2)))
            fluid(i) = eq%fluid_at(x, i)
         end do
         if (.not. all(aperture > 0.0_rk)) then
            report%reason = "a fracture cell has an aperture that is not positive"
            report%cell = minloc(aperture, dim=1, kind=ik)
         else if (any(fluid%void > aperture - cells%roughness)) then
            report%reason = "more fluid is extracted from a fracture cell than it contains"
            report%cell = maxloc(fluid%void - aperture + cells%roughness, dim=1, kind=ik)
            report%is_drained = .true.
         else if (is_overdrawn(eq, x)) then
            report%reason = "more fluid is extracted from an intersection than flows into it"
         end if
      end associate
      report%converged = .not. allocated(report%reason)
   end subroutine check_fluid

   !> Check the contact law at all points.
   subroutine check_contact(eq, report)
      type(equations_t), intent(in) :: eq
      type(step_report_t), intent(inout) :: report
      real(rk) :: residual(size(eq%law))
      integer(ik) :: at, i

      do i = 1, size(eq%law, kind=ik)
         at = eq%condensed%layout%at_jump((i + 1)/2, 2 - mod(i, 2_ik))
         residual(i) = contact_residual(eq%law(i), eq%stiffness, eq%traction(:, i), &
                                        eq%q(at:at + 1), eq%slip_before(i))
      end do
      report%contact_residual = maxval(residual)/report%stress_scale
      if (.not. report%contact_residual <= contact_residual_max) then
         report%converged = .false.
         report%reason = "the contact law is violated in a fracture cell"
         report%cell = (maxloc(residual, dim=1, kind=ik) + 1)/2
      end if
   end subroutine check_contact

   !> Store jumps, tractions, contact states and the history of the faces.
   subroutine keep_contact(eq, state)
      type(equations_t), intent(in) :: eq
      type(state_t), intent(inout) :: state
      integer(ik) :: at, end, i

      state%slip_before = state%jump(2, :, :)
      do i = 1, eq%layout%n_cells
         do end = 1, 2
            at = eq%condensed%layout%at_jump(i, end)
            ! What elimination leaves of jumps that are none is no opening, and no slip.
            state%jump(:, end, i) = merge(0.0_rk, eq%q(at:at + 1), abs(eq%q(at:at + 1)) &
                                          < epsilon(1.0_rk)*eq%stress_scale/eq%stiffness)
         end do
      end do
      if (allocated(state%slip_path)) then
         state%slip_path = state%slip_path + abs(state%jump(2, :, :) - state%slip_before)
         state%opened_before = state%opened
         do i = 1, eq%layout%n_cells
            do end = 1, 2
               state%opened(end, i) = max(state%opened(end, i), &
                                          eq%cells%law(i)%apart(eq%traction(:, 2*i - 2 + end), &
                                                                state%jump(:, end, i)))
            end do
         end do
      end if
      state%traction = reshape(eq%traction, shape(state%traction))
      state%contact = reshape(eq%state, shape(state%contact))
   end subroutine keep_contact

   !> Uncertainty of flows round loops, over the largest flow or the flow that exchanges the fluid
   !! of a cell in the step [-].
   pure function loop_flow_error(eq, x, aperture, report) result(error)
      type(equations_t), intent(in) :: eq
      real(rk), intent(in) :: x(:)  !< the solution [Pa]
      real(rk), intent(in) :: aperture(:)  !< (cells) [m]
      type(step_report_t), intent(in) :: report
      real(rk) :: error
      real(rk) :: largest, unsolved

      error = 0.0_rk
      if (eq%paths%settings%equilibrate .or. eq%layout%n_joints == 0) return
      if (.not. report%condition > 0.0_rk) return
      associate (flow => x(eq%layout%at_flow(1_ik):eq%layout%at_well(eq%layout%n_wells)), &
                 at_first => eq%layout%at_flow(1_ik))
         largest = max(maxval(abs(flow)), maxval(aperture*eq%condensed%length)/eq%unit)
         unsolved = report%error_bound/report%condition*report%stress_scale
         error = unknown_flow(eq%slopes, at_first, &
                              flows_in_loops(eq%layout%n_cells, eq%paths%connections, &
                                             eq%paths%joints), unsolved)/largest
      end associate
   end function loop_flow_error

   !> Whether a well lowers the pressure of a joint below that of vapour; a joint holds no fluid
   !! that could evaporate.
   pure logical function is_overdrawn(eq, x)
      type(equations_t), intent(in) :: eq
      real(rk), intent(in) :: x(:)  !< the solution [Pa]
      real(rk) :: lowest(eq%layout%n_joints)  ! [Pa]
      integer(ik) :: j

      is_overdrawn = .false.
      lowest = eq%paths%settings%vapour_pressure
      associate (joints => eq%paths%joints)
         if (allocated(joints%pressure_in_situ)) lowest = lowest - joints%pressure_in_situ
         do j = 1, eq%layout%n_joints
            if (joints%is_outlet(j)) cycle
            is_overdrawn = is_overdrawn .or. x(eq%layout%at_joint(j)) &
                           < lowest(j) - contact_residual_max*eq%stress_scale
         end do
      end associate
   end function is_overdrawn

   !> Residuals [Pa] and their derivatives at x.
   subroutine evaluate(self, x)
      class(equations_t), intent(inout) :: self
      real(rk), intent(in) :: x(:)  !< [Pa]
      real(rk) :: pressure
      integer(ik) :: end, i, k

      call self%find_forces(x)
      call self%slopes%clear(self%layout%count())
      self%residual = 0.0_rk
      pressure = 0.0_rk
      do i = 1, self%layout%n_cells
         do end = 1, 2
            call fill_contact(i, end, x, self)
         end do
         if (self%paths%settings%equilibrate) then
            call fill_equilibrium(i, x, self)
         else
            call fill_exchange(i, x, self)
            call fill_balance(i, x, self)
         end if
         pressure = max(pressure, abs(x(self%layout%at_pressure(i))))
      end do
      if (allocated(self%paths%settings%fluid_law) .and. .not. self%paths%settings%equilibrate) then
         call add_fluid_law(x, self%paths%settings%fluid_law, self)
      end if
      do k = 1, self%layout%n_flows
         call fill_flow(k, x, self)
      end do
      do k = 1, self%layout%n_joints
         call fill_joint(k, x, self)
      end do
      do k = 1, self%layout%n_branches
         call fill_branch(k, x, self)
      end do
      do k = 1, self%paths%wells%n
         call fill_well(k, x, self)
      end do
      self%stress_scale = max(maxval(abs(self%traction)), pressure, self%load_stress, 1.0_rk)
      if (self%has_failed) self%residual = ieee_value(1.0_rk, ieee_quiet_nan)
   end subroutine evaluate

   !> The linear step, by the full condensed matrix or with the factors of a sparse one.
   subroutine find_step(self, with_condition, step, quality)
      class(equations_t), intent(inout) :: self
      logical, intent(in) :: with_condition
      real(rk), intent(out) :: step(:)  !< [Pa]
      type(step_quality_t), intent(out) :: quality

      if (.not. allocated(self%kinds%is_flow)) call find_kinds(self)
      if (self%condensed%is_full) then
         call find_full_step(self%condensed%stiffness, self%slopes, self%kinds, self%residual, &
                             self%stress_scale, with_condition, self%reduced, step, quality)
      else
         call self%factors%find_step(self%condensed, self%slopes, self%kinds%is_flow, &
                                     self%residual, self%stress_scale, step, quality)
      end if
   end subroutine find_step

   !> Find the unknowns that may be eliminated from the full matrix first. Flows along a fracture
   !! are listed from its last cell to its first.
   pure subroutine find_kinds(eq)
      class(equations_t), intent(inout) :: eq
      integer(ik) :: end, flow_to(eq%layout%n_cells), i, k

      associate (layout => eq%layout, kinds => eq%kinds, n => eq%layout%n_cells)
         kinds%many = eq%paths%settings%many
         allocate (kinds%is_flow(layout%count()), source=.false.)
         kinds%is_flow(layout%at_flow(1_ik):layout%at_well(layout%n_wells)) = .true.
         kinds%jump = [((layout%at_jump(i, end), end=1, 2), i=1, n)]
         kinds%face = [((layout%at_face_pressure(i, end), end=1, 2), i=1, n)]
         kinds%fluid = layout%at_pressure([(i, i=1, n)])
         flow_to = 0
         do k = 1, layout%n_flows
            flow_to(maxval(eq%paths%connections(:, k))) = k
         end do
         kinds%flow = layout%at_flow(pack(flow_to(n:1:-1), flow_to(n:1:-1) > 0))
         kinds%end_of_flow = layout%at_pressure(pack([(i, i=n, 1, -1)], flow_to(n:1:-1) > 0))
      end associate
   end subroutine find_kinds

   !> Initial guess by pivoting, from the start of the step.
   subroutine restart(self, x, has_start)
      class(equations_t), intent(inout) :: self
      real(rk), intent(inout) :: x(:)  !< [Pa]
      logical, intent(out) :: has_start
      real(rk) :: found(size(x))

      found = self%start
      call pivot_fractures(self, found, has_start)
      if (has_start) x = found
   end subroutine restart

   !> The two contact equations at one end of cell i.
   pure subroutine fill_contact(i, end, x, eq)
      integer(ik), intent(in) :: i
      integer(ik), intent(in) :: end  !< 1 start, 2 end
      real(rk), intent(in) :: x(:)  !< [Pa]
      class(equations_t), intent(inout) :: eq
      real(rk) :: half_length
      type(contact_equations_t) :: found
      type(cell_fluid_t) :: fluid
      integer(ik) :: at, k, m, point, row

      half_length = 0.5_rk*eq%condensed%length(i)
      at = eq%condensed%layout%at_jump(i, end)
      row = eq%layout%at_jump(i, end)
      fluid = eq%fluid_at(x, i)
      point = 2*(i - 1) + end
      if (eq%condensed%holds(i)) then
         eq%traction(:, point) = eq%before%traction(:, end, i)
         eq%residual(row:row + 1) = x(row:row + 1)
         call eq%slopes%add(row, row, 1.0_rk)
         call eq%slopes%add(row + 1, row + 1, 1.0_rk)
         return
      end if
      eq%traction(:, point) = [fluid%pressure, 0.0_rk] - eq%force(at:at + 1)/half_length
      call contact_equations(eq%law(point), eq%stiffness, eq%traction(:, point), eq%q(at:at + 1), &
                             eq%slip_before(point), eq%slip_sign(point), found)
      eq%state(point) = found%state
      if (eq%is_without_contact) then
         found%residual = eq%traction(:, point)
         found%by_traction = reshape([1.0_rk, 0.0_rk, 0.0_rk, 1.0_rk], [2, 2])
         found%by_jump = 0.0_rk
      end if
      eq%residual(row:row + 1) = found%residual
      do k = 1, 2
         associate (slopes => eq%slopes, equation => row + k - 1)
            do m = 1, 2
               call slopes%add_force(equation, at + m - 1, -found%by_traction(k, m)/half_length)
               call slopes%add(equation, row + m - 1, found%by_jump(k, m)/eq%stiffness)
            end do
            call slopes%add(equation, eq%layout%at_pressure(i), &
                            found%by_traction(k, 1)*fluid%pressure_slope)
         end associate
      end do
   end subroutine fill_contact

end module coarse_newton
