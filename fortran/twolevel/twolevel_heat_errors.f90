!> Errors by the mean temperatures of the cells: rock shrinks, and fluid is pressed out of its
!! pores, where the heat is, which may be a front far thinner than a cell. Each step is solved a
!! second time with temperatures that are blurred over one cell more, the heat being the same, from
!! the result of the second solution of the step before; on a new mesh from the state itself. What
!! this changes is of the size of what the first blurring, that over the cells, has changed: in a
!! row of equilateral triangles of the height h at a cooled face the first moves heat by h/3, the
!! second by .296 h. Twice this change is stated (verification/cooled_plate).
!!
!! Fluid that is pressed out at a drained face leaves at once, but in the model only as far as the
!! pressure of the mean temperature diffuses: up to that of the heat which the blurring moves out of
!! the cells at drained sides and fractures, twice, is not known to have left.
module twolevel_heat_errors
   use base_archive, only: archive_t
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use coarse_archive, only: visit_state
   use coarse_rock, only: shear_beside
   use coarse_state, only: state_t, step_report_t
   use mesh_geometry, only: cell_area
   use mesh_types, only: mesh_t
   use report_rows, only: fracture_fields_t, history_errors_t, probe_row_t, well_row_t
   use report_simulation, only: snapshot_t
   use scene_types, only: scene_t
   use twolevel_problem, only: coarse_problem_t
   use twolevel_results, only: probes_of_levels, snapshot_of_levels
   use twolevel_well_rows, only: well_flows, well_pressures
   implicit none(type, external)
   private

   public :: blurred, blurred_t

   !> The run with blurred temperatures.
   type :: blurred_t
      type(state_t), allocatable :: state  !< unallocated: temperatures do not act
      !> by which more has leaked off, and left through the boundary, than in the run itself [m2]
      real(rk) :: leaked = 0.0_rk, outflow = 0.0_rk
      real(rk), allocatable :: injected(:)  !< the same of what wells have injected [m2]
      !> fluid of the heat that lies wrong at fractures, and at drained sides [m2]
      real(rk) :: at_faces = 0.0_rk, at_sides = 0.0_rk
      logical :: is_unsolved = .false.  !< that of the last step, whose rows lack these errors
   contains
      procedure :: solve
      procedure :: visit
      procedure :: add_to_row
      procedure :: add_to_wells
      procedure :: add_to_fractures
      procedure :: add_to_probes
   end type blurred_t

   real(rk), parameter :: times = 2.0_rk  !< what is stated over the change [-]

contains

   !> Means of the cells blurred over those that share a node, without loss of heat in one rock.
   pure function blurred(mesh, means) result(values)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: means(:)  !< (cells) [K]
      real(rk) :: values(size(means))
      real(rk), dimension(mesh%n_nodes) :: area, nodal
      integer(ik) :: c

      area = 0.0_rk
      nodal = 0.0_rk
      do c = 1, mesh%n_cells
         associate (nodes => mesh%cell_nodes(:, c), of_cell => cell_area(mesh, c))
            area(nodes) = area(nodes) + of_cell
            nodal(nodes) = nodal(nodes) + of_cell*means(c)
         end associate
      end do
      nodal = nodal/max(area, tiny(1.0_rk))
      do c = 1, mesh%n_cells
         values(c) = sum(nodal(mesh%cell_nodes(:, c)))/3.0_rk
      end do
   end function blurred

   !> Solve an accepted step a second time; if it is not solved, the next one begins
   !! from the state itself.
   subroutine solve(self, scene, problem, before, state, report, is_new_mesh)
      class(blurred_t), intent(inout) :: self
      type(scene_t), intent(inout) :: scene
      type(coarse_problem_t), intent(inout) :: problem
      type(state_t), intent(in) :: before, state
      type(step_report_t), intent(in) :: report  !< of the step
      logical, intent(in) :: is_new_mesh
      type(timers_t) :: timers
      type(step_report_t) :: second
      type(error_t), allocatable :: error
      real(rk), allocatable :: means(:)

      self%is_unsolved = .false.
      if (.not. allocated(self%injected)) allocate (self%injected(0))
      if (size(self%injected) /= size(scene%injections)) then
         ! At the start, and after a restart with other wells.
         self%injected = spread(0.0_rk, 1, size(scene%injections))
         if (allocated(self%state)) deallocate (self%state)
      end if
      if (.not. (allocated(problem%model%rock%temperature) .and. state%time > before%time)) then
         if (allocated(self%state)) deallocate (self%state)
         return
      end if
      if (allocated(self%state)) then
         if (is_new_mesh .or. size(self%state%unknowns) /= size(before%unknowns)) then
            deallocate (self%state)
         end if
      end if
      if (.not. allocated(self%state)) self%state = before
      self%state%guess = state%guess  ! changes as in the step itself
      means = problem%model%rock%temperature
      problem%model%rock%temperature = blurred(problem%mesh, means)
      call find_pressed_out(problem, means, self%at_faces, self%at_sides)
      associate (dt => state%time - before%time)
         call problem%advance(scene, dt, self%state, timers, second, error)
         call move_alloc(means, problem%model%rock%temperature)
         self%is_unsolved = allocated(error)
         if (.not. self%is_unsolved) self%is_unsolved = .not. second%converged
         if (self%is_unsolved) then
            deallocate (self%state)
            return
         end if
         self%injected = self%injected + dt*(well_flows(scene, problem, before%time, self%state) &
                                             - well_flows(scene, problem, before%time, state))
         self%outflow = self%outflow + second%rock_outflow - report%rock_outflow
         if (problem%mesh%fracture%n_cells == 0) return
         associate (s => problem%mesh%fracture%cell_s)
            self%leaked = self%leaked + dt*sum((s(2, :) - s(1, :)) &
                                               *(self%state%leakoff - state%leakoff))
         end associate
      end associate
   end subroutine solve

   !> Fluid that the heat which the blurring moves, twice, presses out of the pores of the cells at
   !! fractures and at drained sides.
   pure subroutine find_pressed_out(problem, means, at_faces, at_sides)
      type(coarse_problem_t), intent(in) :: problem  !< with blurred temperatures
      real(rk), intent(in) :: means(:)  !< (cells) before [K]
      real(rk), intent(out) :: at_faces, at_sides  !< [m2]
      real(rk) :: fluid
      integer(ik) :: c, k

      at_faces = 0.0_rk
      at_sides = 0.0_rk
      associate (mesh => problem%mesh, model => problem%model)
         do c = 1, mesh%n_cells
            associate (solid => model%rock%solid_at(c))
               fluid = 2.0_rk*abs(solid%content_per_heat()*cell_area(mesh, c) &
                                  *(model%rock%temperature(c) - means(c)))
            end associate
            do k = 1, 3
               associate (f => mesh%cell_faces(k, c))
                  if (mesh%face_fracture_cell(f) > 0) at_faces = at_faces + fluid
                  if (mesh%face_side(f) == 0) cycle
                  if (model%sides(mesh%face_side(f))%pressure_given) at_sides = at_sides + fluid
               end associate
            end do
         end do
      end associate
   end subroutine find_pressed_out

   !> Store, or restore.
   subroutine visit(self, archive)
      class(blurred_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive
      logical :: is_known

      call archive%enter("blurred")
      call archive%item("leaked", self%leaked)
      call archive%item("outflow", self%outflow)
      call archive%list("injected", self%injected, "all_wells ?")
      call archive%item("at_faces", self%at_faces)
      call archive%item("at_sides", self%at_sides)
      is_known = allocated(self%state)
      call archive%item("is_known", is_known)
      if (is_known) then
         if (.not. allocated(self%state)) allocate (self%state)
         call visit_state(archive, "state", self%state)
      end if
      call archive%leave()
   end subroutine visit

   !> Add to the errors of a row.
   subroutine add_to_row(self, problem, before, state, error)
      class(blurred_t), intent(in) :: self
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: before, state
      type(history_errors_t), intent(inout) :: error
      real(rk), allocatable :: potency(:)

      if (.not. allocated(self%state)) return
      associate (outflow => times*abs(self%outflow) + self%at_sides, &
                 leaked => times*abs(self%leaked) + self%at_faces)
         error%rock_outflow = error%rock_outflow + outflow
         error%rock_fluid = error%rock_fluid + outflow + leaked
         if (problem%mesh%fracture%n_cells == 0) return
         error%leakoff = error%leakoff + leaked
         error%fracture_fluid = error%fracture_fluid + leaked
      end associate
      associate (other => self%state, dt => state%time - before%time, fracture => &
                 times*abs(problem%fracture_volume(self%state) - problem%fracture_volume(state)))
         error%fracture_volume = error%fracture_volume + fracture
         error%fracture_fluid = error%fracture_fluid + fracture
         error%max_slip = error%max_slip &
                          + times*maxval(abs(other%jump(2, :, :) - state%jump(2, :, :)))
         error%max_opening = error%max_opening &
                             + times*maxval(abs(other%jump(1, :, :) - state%jump(1, :, :)))
         error%max_slip_rate = error%max_slip_rate &
                               + times*abs(maxval(abs(other%jump(2, :, :) - other%slip_before)) &
                                           - maxval(abs(state%jump(2, :, :) &
                                                        - state%slip_before)))/dt
         potency = times*0.5_rk*problem%model%condensed%length &
                   *abs(sum(other%jump(2, :, :) - state%jump(2, :, :), dim=1))
         error%seismic_moment = error%seismic_moment &
                                + sum(shear_beside(problem%model%rock, problem%mesh)*potency)
      end associate
   end subroutine add_to_row

   !> Add to the errors of the wells, and to those of their sums.
   subroutine add_to_wells(self, scene, problem, since, state, rows, error)
      class(blurred_t), intent(in) :: self
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: since  !< start of the step [s]
      type(state_t), intent(in) :: state
      type(well_row_t), intent(inout) :: rows(:)
      type(history_errors_t), intent(inout) :: error
      real(rk), dimension(size(rows)) :: flow, injected, pressure

      if (.not. allocated(self%state)) return
      pressure = times*abs(well_pressures(scene, problem, since, self%state) &
                           - well_pressures(scene, problem, since, state))
      flow = times*abs(well_flows(scene, problem, since, self%state) &
                       - well_flows(scene, problem, since, state))
      injected = times*abs(self%injected)
      associate (of => rows%error)
         rows%error%pressure = of%pressure + pressure
         rows%error%head_pressure = of%head_pressure &
                                    + merge(pressure, 0.0_rk, of%head_pressure > 0.0_rk)
         rows%error%rate = of%rate + merge(flow, 0.0_rk, of%rate > 0.0_rk)
         rows%error%flow = of%flow + flow
         rows%error%injected = of%injected + injected
      end associate
      error%injection_rate = error%injection_rate + sum(flow)
      error%injected = error%injected + sum(injected)
      error%produced = error%produced + sum(injected, mask=rows%injected < 0.0_rk)
   end subroutine add_to_wells

   !> Add to the errors of the fracture cells.
   subroutine add_to_fractures(self, scene, problem, fields)
      class(blurred_t), intent(in) :: self
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(fracture_fields_t), intent(inout) :: fields
      type(snapshot_t) :: other

      if (.not. allocated(self%state)) return
      if (size(self%state%pressure) /= size(fields%pressure)) return
      other = snapshot_of_levels(scene, problem, self%state)
      associate (e => fields%error, o => other%fracture)
         e%jump_n = e%jump_n + times*abs(o%jump_n - fields%jump_n)
         e%jump_t = e%jump_t + times*abs(o%jump_t - fields%jump_t)
         e%traction_n = e%traction_n + times*abs(o%traction_n - fields%traction_n)
         e%traction_t = e%traction_t + times*abs(o%traction_t - fields%traction_t)
         e%pressure = e%pressure + times*abs(o%pressure - fields%pressure)
         e%flow = e%flow + times*abs(o%flow - fields%flow)
      end associate
   end subroutine add_to_fractures

   !> Add to the errors of the probes.
   subroutine add_to_probes(self, scene, problem, row)
      class(blurred_t), intent(in) :: self
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(probe_row_t), intent(inout) :: row
      type(probe_row_t) :: other
      type(error_t), allocatable :: error

      if (.not. allocated(self%state)) return
      call probes_of_levels(scene%probes, problem, self%state, other, error)
      if (allocated(error)) return
      row%pressure_error = row%pressure_error + times*abs(other%pressure - row%pressure)
      row%displacement_error = row%displacement_error &
                               + times*norm2(other%displacement - row%displacement, dim=1)
      row%stress_error = row%stress_error &
                         + times*maxval(abs(other%stress - row%stress), dim=1)
   end subroutine add_to_probes

end module twolevel_heat_errors
