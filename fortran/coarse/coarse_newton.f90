!> One time step of the fractures: the iteration of contact_newton on the equations of
!! coarse_equations, and what of its outcome is accepted.
module coarse_newton
   use base_kinds, only: ik, rk
   use coarse_condensed, only: condensed_t
   use coarse_equations, only: equations_t
   use coarse_joints, only: joints_t
   use coarse_loops, only: flows_in_loops, unknown_flow
   use coarse_fractures, only: cell_fluid_t, newton_settings_t, prepare
   use coarse_sparse_step, only: sparse_step_t
   use coarse_well_flow, only: find_well
   use coarse_wells, only: wells_t
   use coarse_state, only: fracture_cells_t, state_t, step_report_t
   use contact_law, only: contact_residual
   use contact_newton, only: iterate, iteration_report_t, iteration_settings_t, &
                             outcome_converged, outcome_not_a_number, outcome_singular
   implicit none(type, external)
   private

   public :: solve_fractures

   real(rk), parameter :: contact_residual_max = 1.0e-8_rk  !< of an accepted step, relative

contains

   !> One time step of the fractures, the rock condensed. `state` holds the state before and is
   !! replaced only if the iteration converges.
   subroutine solve_fractures(condensed, factors, cells, connections, joints, wells, settings, dt, &
                              g, state, q, report)
      type(condensed_t), intent(inout), target :: condensed
      type(sparse_step_t), intent(inout), target :: factors  !< of linear steps so far
      type(fracture_cells_t), intent(in), target :: cells
      integer(ik), intent(in), target :: connections(:, :)  !< (2, m) cells that exchange fluid
      type(joints_t), intent(in), target :: joints
      type(wells_t), intent(in), target :: wells
      type(newton_settings_t), intent(in) :: settings
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in), target :: g(:)  !< (6 n) load on the condensed system [N/m], [m2]
      type(state_t), intent(inout), target :: state
      real(rk), intent(out) :: q(:)  !< (6 n) unknowns of the condensed system [m], [Pa]
      type(step_report_t), intent(out) :: report
      type(equations_t) :: eq
      type(iteration_report_t) :: found
      type(iteration_settings_t) :: how
      real(rk), allocatable :: start(:), x(:)
      integer(ik) :: spent

      call prepare(condensed, cells, connections, joints, wells, settings, dt, g, state, eq)
      eq%factors => factors
      how = iteration_settings_t(tolerance=settings%tolerance, &
                                 iterations_max=settings%iterations_max, with_condition=.true., &
                                 allows_rounding=.true.)
      call find_start(eq, state, start)
      x = start
      eq%start = start
      spent = 0
      if (state%guess%is_known(size(start, kind=ik)) .and. .not. settings%equilibrate) then
         x = state%guess%from(start, dt)
         how%perseveres = .false.
         call iterate(eq, x, how, found)
         how%perseveres = .true.
         if (found%outcome /= outcome_converged) then
            spent = found%iterations
            x = start
            eq%state = reshape(state%contact, [size(eq%state)])
            eq%way = 0
         end if
      end if
      if (found%outcome /= outcome_converged) call iterate(eq, x, how, found)
      found%iterations = found%iterations + spent
      if (found%outcome == outcome_converged .and. .not. settings%equilibrate) then
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
         report%reason = "contact and flow on the fractures met a value that is not a number"
      case (outcome_singular)
         report%reason = "contact and flow on the fractures do not follow from the loads"
      case default
         report%reason = "the iteration on contact and flow of the fractures did not converge"
      end select
      if (report%converged) call accept(condensed, cells, dt, eq, x, state, report)
   end subroutine solve_fractures

   !> The state before, the rock at the fractures having their pressure, without flow.
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
      do i = 1, eq%layout%n_wells
         x(eq%layout%at_well(i)) = state%well_flow(i)*eq%dt/eq%unit
      end do
      do i = 1, eq%layout%n_joints
         x(eq%layout%at_joint(i)) = eq%joints%mean_pressure(i, state%pressure)
      end do
   end subroutine find_start

   !> Check the solution against the law itself and make it the state.
   subroutine accept(condensed, cells, dt, eq, x, state, report)
      type(condensed_t), intent(in) :: condensed
      type(fracture_cells_t), intent(in) :: cells
      real(rk), intent(in) :: dt  !< [s]
      type(equations_t), intent(in) :: eq
      real(rk), intent(in) :: x(:)  !< the solution [Pa]
      type(state_t), intent(inout) :: state
      type(step_report_t), intent(inout) :: report
      type(cell_fluid_t) :: fluid(condensed%n)
      real(rk) :: aperture(condensed%n), head, residual
      integer(ik) :: at, end, i

      do i = 1, condensed%n
         aperture(i) = cells%residual_aperture(i) &
                       + 0.5_rk*(eq%q(condensed%layout%at_jump(i, 1)) &
                                 + eq%q(condensed%layout%at_jump(i, 2)))
      end do
      if (.not. all(aperture > 0.0_rk)) then
         report%converged = .false.
         report%reason = "a fracture cell has an aperture that is not positive"
         return
      end if
      do i = 1, condensed%n
         fluid(i) = eq%fluid_at(x, i)
      end do
      if (any(fluid%void > aperture - cells%roughness)) then
         report%converged = .false.
         report%reason = "a fracture cell has less fluid than is drawn from it"
         return
      end if
      if (is_overdrawn(eq, x)) then
         report%converged = .false.
         report%reason = "more fluid is drawn from where fractures meet than flows there"
         return
      end if
      do i = 1, condensed%n
         do end = 1, 2
            at = condensed%layout%at_jump(i, end)
            residual = contact_residual(eq%law_at(i, end), eq%stiffness, eq%traction(:, end, i), &
                                        eq%q(at:at + 1), state%jump(2, end, i))
            report%contact_residual = max(report%contact_residual, residual/report%stress_scale)
         end do
      end do
      if (.not. report%contact_residual <= contact_residual_max) then
         report%converged = .false.
         report%reason = "the law of contact is not fulfilled on some fracture cell"
         return
      end if
      state%slip_before = state%jump(2, :, :)
      do i = 1, condensed%n
         do end = 1, 2
            at = condensed%layout%at_jump(i, end)
            ! What elimination leaves of jumps that are none is no opening, and no slip.
            state%jump(:, end, i) = merge(0.0_rk, eq%q(at:at + 1), abs(eq%q(at:at + 1)) &
                                          < epsilon(1.0_rk)*eq%stress_scale/eq%stiffness)
         end do
         state%leakoff(i) = -(eq%force(condensed%layout%at_face_pressure(i, 1)) &
                              + eq%force(condensed%layout%at_face_pressure(i, 2))) &
                            /(dt*condensed%length(i))
      end do
      if (allocated(state%slip_path)) then
         state%slip_path = state%slip_path + abs(state%jump(2, :, :) - state%slip_before)
         state%opened_before = state%opened
         do i = 1, condensed%n
            do end = 1, 2
               state%opened(end, i) = max(state%opened(end, i), &
                                          cells%law(i)%apart(eq%traction(:, end, i), &
                                                             state%jump(:, end, i)))
            end do
         end do
      end if
      state%traction = eq%traction
      state%aperture = aperture
      state%pressure = fluid%pressure
      state%void = fluid%void
      state%contact = reshape(eq%state, shape(state%contact))
      report%loop_flow_error = loop_flow_error(eq, x, aperture, report)
      associate (layout => eq%layout, to_flow => eq%unit/dt)
         state%flow = x(layout%at_flow([(i, i=1, layout%n_flows)]))*to_flow
         state%branch_flow = x(layout%at_branch([(i, i=1, layout%n_branches)]))*to_flow
         do i = 1, layout%n_wells
            call find_well(i, x, eq, state%well_flow(i), head, state%well_rate(i))
            state%well_head(i) = head
         end do
         state%joint_pressure = x(layout%at_joint([(i, i=1, layout%n_joints)]))
      end associate
   end subroutine accept

   !> How little is known of flows round loops, over the largest flow, or one that exchanges the
   !! fluid of a cell in the step [-].
   pure function loop_flow_error(eq, x, aperture, report) result(error)
      type(equations_t), intent(in) :: eq
      real(rk), intent(in) :: x(:)  !< the solution [Pa]
      real(rk), intent(in) :: aperture(:)  !< (cells) [m]
      type(step_report_t), intent(in) :: report
      real(rk) :: error
      real(rk) :: largest, unsolved

      error = 0.0_rk
      if (eq%settings%equilibrate .or. eq%layout%n_joints == 0) return
      if (.not. report%condition > 0.0_rk) return
      associate (flow => pack(x, eq%is_flow), at_first => eq%layout%at_flow(1_ik))
         largest = max(maxval(abs(flow)), maxval(aperture*eq%condensed%length)/eq%unit)
         unsolved = report%error_bound/report%condition*report%stress_scale
         error = unknown_flow(eq%slopes, at_first, flows_in_loops(eq%layout%n_cells, &
                                                                  eq%connections, eq%joints), &
                              unsolved)/largest
      end associate
   end function loop_flow_error

   !> A joint, which holds no fluid that could become vapour, would have a pressure below that of
   !! vapour: only a well can draw it so low.
   pure logical function is_overdrawn(eq, x)
      type(equations_t), intent(in) :: eq
      real(rk), intent(in) :: x(:)  !< the solution [Pa]
      real(rk) :: lowest(eq%layout%n_joints)  ! [Pa]
      integer(ik) :: j

      is_overdrawn = .false.
      lowest = eq%settings%vapour_pressure
      if (allocated(eq%joints%pressure_in_situ)) lowest = lowest - eq%joints%pressure_in_situ
      do j = 1, eq%layout%n_joints
         if (eq%joints%is_outlet(j)) cycle
         is_overdrawn = is_overdrawn .or. x(eq%layout%at_joint(j)) &
                        < lowest(j) - contact_residual_max*eq%stress_scale
      end do
   end function is_overdrawn

end module coarse_newton
