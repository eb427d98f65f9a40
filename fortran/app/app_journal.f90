!> What a running scene tells its files: rows, fields and events, taken from the simulation.
module app_journal
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: phase_output, timers_t
   use contact_states, only: state_open, state_slip, state_stick
   use coarse_fields, only: cell_stresses
   use coarse_state, only: step_report_t
   use mesh_builder, only: locate
   use output_fields, only: fracture_fields_t, history_row_t, intersection_fields_t, &
                            matrix_fields_t, tip_row_t
   use output_progress, only: progress_t, progress_values_t
   use output_record, only: run_record_t
   use output_run, only: run_output_t
   use output_tables, only: event_arrest, event_growth, event_opening, event_remesh, &
                            event_slip_onset
   use tips_growth, only: growth_drive_t
   use tips_types, only: intensity_t
   use tips_network, only: total_length
   use twolevel_simulation, only: simulation_t
   implicit none(type, external)
   private

   public :: cell_state, journal_t

   !> Files, record and progress line of a run, and what is summed up over its steps.
   type :: journal_t
      type(run_output_t) :: files
      type(run_record_t) :: record
      type(progress_t) :: progress
      real(rk) :: seismic_moment = 0.0_rk  !< per metre of thickness [N m]
      real(rk) :: mass_error = 0.0_rk  !< of all steps [m2]
      real(rk) :: fields_time = -huge(1.0_rk)  !< of the last written fields [s]
      logical, allocatable :: has_slipped(:), has_opened(:)  !< (fractures)
   contains
      procedure :: open => open_journal
      procedure :: step_done
      procedure :: tips_done
      procedure :: growth_done
      procedure :: write_last_state
      procedure :: count_unknowns
   end type journal_t

contains

   !> Open the files.
   subroutine open_journal(self, directory, quiet, simulation, error)
      class(journal_t), intent(inout) :: self
      character(len=*), intent(in) :: directory
      logical, intent(in) :: quiet
      type(simulation_t), intent(in) :: simulation
      type(error_t), allocatable, intent(out) :: error

      call self%files%open(directory, simulation%scene, error)
      if (allocated(error)) return
      call self%progress%begin(quiet)
      allocate (self%has_slipped(size(simulation%scene%fractures)), source=.false.)
      allocate (self%has_opened(size(simulation%scene%fractures)), source=.false.)
      call self%files%network_step(simulation%state%time, simulation%network, simulation%mesh)
   end subroutine open_journal

   !> An accepted step (dt = 0: the initial state): history, probes, events, and fields where they
   !! are due.
   subroutine step_done(self, simulation, dt, slip_before, report, timers, error)
      class(journal_t), intent(inout) :: self
      type(simulation_t), intent(inout) :: simulation
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: slip_before(:, :)  !< (2, fracture cells) [u]_tau before the step [m]
      type(step_report_t), intent(in) :: report
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      type(history_row_t) :: row
      real(rk), allocatable :: stresses(:, :)
      logical :: fields_due

      call timers%start(phase_output)
      call summarize(self, simulation, dt, slip_before, report, row)
      call self%files%history_row(row)
      call note_events(self, simulation)
      fields_due = self%files%fields_due(row%time)
      if (fields_due .or. size(simulation%scene%probes) > 0) then
         allocate (stresses(3, simulation%mesh%n_cells))
         call cell_stresses(simulation%mesh, simulation%model%regions, simulation%state%tractions, &
                            stresses)
         if (size(simulation%scene%probes) > 0) call write_probes(self, simulation, stresses, error)
         if (fields_due .and. .not. allocated(error)) then
            call write_fields(self, simulation, stresses, error)
         end if
      end if
      if (.not. allocated(error)) call self%files%tick(error)
      call self%progress%show(progress_values_t(time=row%time, time_end=simulation%scene%time%end, &
             step=self%record%steps, newton_iterations=row%newton_iterations, n_stick=row%n_stick, &
                         n_slip=row%n_slip, n_open=row%n_open, fracture_length=row%fracture_length))
      call timers%stop(phase_output)
   end subroutine step_done

   !> The row of history.csv, and the largest values for run.json.
   subroutine summarize(self, simulation, dt, slip_before, report, row)
      class(journal_t), intent(inout) :: self
      type(simulation_t), intent(in) :: simulation
      real(rk), intent(in) :: dt, slip_before(:, :)
      type(step_report_t), intent(in) :: report
      type(history_row_t), intent(out) :: row

      integer(ik) :: i
      real(rk) :: fluid  !< that the mass error is compared with [m2]
      logical, allocatable :: is_well(:)

      associate (state => simulation%state, length => simulation%model%condensed%length)
         row%time = state%time
         row%dt = dt
         row%newton_iterations = report%iterations
         row%injected = simulation%injected
         row%leakoff = simulation%leaked
         row%prefilled = simulation%prefilled
         row%fracture_length = total_length(simulation%tips%network)
         row%n_tips = size(simulation%tips%tip)
         self%mass_error = self%mass_error + report%mass_error
         if (simulation%mesh%fracture%n_cells > 0) then
            is_well = sum(simulation%share, dim=2) > 0.0_rk
            if (any(is_well)) row%well_pressure = sum(state%pressure, mask=is_well)/count(is_well)
            row%fracture_volume = sum(state%aperture*length)
            row%max_slip = maxval(abs(state%jump(2, :, :)))
            row%max_opening = maxval(state%jump(1, :, :))
            do i = 1, simulation%mesh%fracture%n_cells
               select case (cell_state(state%contact(:, i)))
               case (state_stick)
                  row%n_stick = row%n_stick + 1
               case (state_slip)
                  row%n_slip = row%n_slip + 1
               case default
                  row%n_open = row%n_open + 1
               end select
               self%seismic_moment = self%seismic_moment + simulation%model%rock%shear*0.5_rk &
                                     *length(i)*sum(abs(state%jump(2, :, i) - slip_before(:, i)))
            end do
         end if
         row%seismic_moment = self%seismic_moment
         fluid = max(abs(simulation%injected), row%fracture_volume)
         if (.not. fluid > 0.0_rk) fluid = max(sum(abs(state%content)), tiny(1.0_rk))
         row%mass_error_relative = abs(self%mass_error)/fluid
      end associate
      self%record%mass_error_relative = max(self%record%mass_error_relative, &
                                            row%mass_error_relative)
      self%record%contact_residual = max(self%record%contact_residual, report%contact_residual)
      self%record%condition_estimate = max(self%record%condition_estimate, report%condition)
      self%record%forward_error_bound = max(self%record%forward_error_bound, report%error_bound)
      self%record%newton_total = self%record%newton_total + report%iterations
      self%record%newton_max = max(self%record%newton_max, report%iterations)
      if (dt > 0.0_rk) self%record%steps = self%record%steps + 1
      self%record%cells = simulation%mesh%n_cells
      self%record%fracture_cells = simulation%mesh%fracture%n_cells
   end subroutine summarize

   !> One state for a cell from those of its two ends: open or stick where both are, else slip.
   pure function cell_state(ends) result(state)
      integer(ik), intent(in) :: ends(2)
      integer(ik) :: state

      state = merge(ends(1), state_slip, ends(1) == ends(2))
   end function cell_state

   !> First slip and first opening of each fracture.
   subroutine note_events(self, simulation)
      class(journal_t), intent(inout) :: self
      type(simulation_t), intent(in) :: simulation

      integer(ik) :: f, i, state
      real(rk) :: centre(2)

      associate (fracture => simulation%mesh%fracture)
         do i = 1, fracture%n_cells
            f = fracture%cell_fracture(i)
            state = cell_state(simulation%state%contact(:, i))
            centre = 0.5_rk*sum(fracture%point_xy(:, fracture%cell_points(:, i)), dim=2)
            if (state == state_slip .and. .not. self%has_slipped(f)) then
               self%has_slipped(f) = .true.
               call self%files%event_row(simulation%state%time, event_slip_onset, "first slip", f, &
                                         centre)
            else if (state == state_open .and. .not. self%has_opened(f)) then
               self%has_opened(f) = .true.
               call self%files%event_row(simulation%state%time, event_opening, "first opening", f, &
                                         centre)
            end if
         end do
      end associate
   end subroutine note_events

   !> Displacement, pressure and stress at the probes.
   subroutine write_probes(self, simulation, stresses, error)
      class(journal_t), intent(inout) :: self
      type(simulation_t), intent(inout) :: simulation
      real(rk), intent(in) :: stresses(:, :)
      type(error_t), allocatable, intent(out) :: error

      real(rk), allocatable :: xy(:, :), values(:, :), weight(:)
      integer(ik), allocatable :: cells(:)
      integer(ik) :: i, n

      n = size(simulation%scene%probes)
      allocate (xy(2, n), values(3, n), cells(n))
      xy(1, :) = simulation%scene%probes%x
      xy(2, :) = simulation%scene%probes%y
      call locate(simulation%mesher, xy, cells, error)
      if (allocated(error)) return
      call simulation%update_level()
      do i = 1, n
         associate (nodes => simulation%mesh%cell_nodes(:, cells(i)))
            weight = corner_weights(simulation%mesh%xy(:, nodes), xy(:, i))
            values(:, i) = matmul(simulation%level%nodal(:, nodes), weight)
         end associate
      end do
      call self%files%probe_row(simulation%state%time, values(:2, :), stresses(:, cells), &
                                values(3, :))
   end subroutine write_probes

   !> Barycentric coordinates.
   pure function corner_weights(corners, point) result(weight)
      real(rk), intent(in) :: corners(:, :), point(:)
      real(rk) :: weight(3)

      integer :: i

      do i = 1, 3
         associate (a => corners(:, mod(i, 3) + 1) - point, b => corners(:, mod(i + 1, 3) + 1) &
                    - point)
            weight(i) = a(1)*b(2) - a(2)*b(1)
         end associate
      end do
      weight = weight/sum(weight)
   end function corner_weights

   subroutine write_fields(self, simulation, stresses, error)
      class(journal_t), intent(inout) :: self
      type(simulation_t), intent(in) :: simulation
      real(rk), intent(in) :: stresses(:, :)
      type(error_t), allocatable, intent(out) :: error

      type(matrix_fields_t) :: matrix
      type(fracture_fields_t) :: fracture
      type(intersection_fields_t) :: none
      integer(ik) :: i, n

      n = simulation%mesh%n_cells
      associate (state => simulation%state)
         matrix%displacement = state%unknowns(:2, :n)
         matrix%pressure = state%unknowns(3, :n)
         matrix%stress = stresses
         fracture%aperture = state%aperture
         fracture%jump_n = 0.5_rk*sum(state%jump(1, :, :), dim=1)
         fracture%jump_t = 0.5_rk*sum(state%jump(2, :, :), dim=1)
         fracture%traction_n = 0.5_rk*sum(state%traction(1, :, :), dim=1)
         fracture%traction_t = 0.5_rk*sum(state%traction(2, :, :), dim=1)
         fracture%pressure = state%pressure
         fracture%state = [(cell_state(state%contact(:, i)), i=1, simulation%mesh%fracture%n_cells)]
         allocate (none%point(0), none%pressure(0))
         call self%files%write_fields(state%time, simulation%mesh, matrix, fracture, none, error)
         self%fields_time = state%time
      end associate
   end subroutine write_fields

   !> The fields at the end of a run, however it ended, unless they have just been written.
   subroutine write_last_state(self, simulation, timers, error)
      class(journal_t), intent(inout) :: self
      type(simulation_t), intent(in) :: simulation
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      real(rk), allocatable :: stresses(:, :)

      if (.not. simulation%state%time > self%fields_time) return
      if (.not. allocated(simulation%state%tractions)) return
      if (size(simulation%state%unknowns, 2) /= simulation%model%regions%n_blocks) return
      call timers%start(phase_output)
      allocate (stresses(3, simulation%mesh%n_cells))
      call cell_stresses(simulation%mesh, simulation%model%regions, simulation%state%tractions, &
                         stresses)
      call write_fields(self, simulation, stresses, error)
      call timers%stop(phase_output)
   end subroutine write_last_state

   !> A row of tips.csv for each tip: where it was before it grew, if it did.
   subroutine tips_done(self, simulation, timers)
      class(journal_t), intent(inout) :: self
      type(simulation_t), intent(in) :: simulation
      type(timers_t), intent(inout) :: timers

      integer(ik) :: i

      call timers%start(phase_output)
      do i = 1, size(simulation%tips%tip)
         associate (tip => simulation%tips%tip(i))
            if (tip%advance > 0.0_rk) then
               call add_row(tip%origin, tip%intensity_before, tip%drive_before, tip%kink, &
                            tip%advance)
            else
               call add_row(tip%xy, tip%intensity, tip%drive, tip%drive%angle, 0.0_rk)
            end if
         end associate
      end do
      call timers%stop(phase_output)

   contains

      subroutine add_row(xy, intensity, drive, angle, advance)
         real(rk), intent(in) :: xy(2)
         type(intensity_t), intent(in) :: intensity
         type(growth_drive_t), intent(in) :: drive
         real(rk), intent(in) :: angle, advance

         call self%files%tip_row(tip_row_t(time=simulation%state%time, tip=i, &
                fracture=simulation%tips%tip(i)%fracture, xy=xy, k1=intensity%k1, k2=intensity%k2, &
                k1_dc=intensity%k1_dc, k2_dc=intensity%k2_dc, keq=drive%intensity, g=drive%energy, &
                                           angle=angle, advance=advance, &
                                           k1_error=intensity%k1_error, &
                                           k2_error=intensity%k2_error, &
                                           g_domain=intensity%g_domain))
      end subroutine add_row

   end subroutine tips_done

   !> Events of the tips that have just grown, stopped, or been handed to the coarse level.
   subroutine growth_done(self, simulation, is_coarse)
      class(journal_t), intent(inout) :: self
      type(simulation_t), intent(in) :: simulation
      logical, intent(in) :: is_coarse  !< the coarse mesh has followed

      character(len=64) :: detail
      integer(ik) :: i

      if (is_coarse) then
         write (detail, "(i0,a,i0,a)") simulation%mesh%n_cells, " cells, ", &
            simulation%mesh%fracture%n_cells, " fracture cells"
         call self%files%event_row(simulation%state%time, event_remesh, trim(detail))
         call self%files%network_step(simulation%state%time, simulation%network, simulation%mesh)
         return
      end if
      do i = 1, size(simulation%tips%tip)
         associate (tip => simulation%tips%tip(i))
            if (tip%advance > 0.0_rk) then
               write (detail, "(a,es10.3,a,f7.2,a)") "advance ", tip%advance, " m, kink ", &
                  tip%kink*45.0_rk/atan(1.0_rk), " deg"
               call self%files%event_row(simulation%state%time, event_growth, trim(detail), &
                                         tip%fracture, tip%xy)
            else if (allocated(tip%arrest_reason)) then
               call self%record%warn("fracture "// &
                                     trim(simulation%scene%fractures(tip%fracture)%name)// &
                                     " stopped growing "//tip%arrest_reason)
               call self%files%event_row(simulation%state%time, event_arrest, tip%arrest_reason, &
                                         tip%fracture, tip%xy)
            end if
         end associate
      end do
   end subroutine growth_done

   !> Unknowns by block, for run.json.
   subroutine count_unknowns(self, simulation)
      class(journal_t), intent(inout) :: self
      type(simulation_t), intent(in) :: simulation

      integer(ik) :: i, n_fine

      associate (mesh => simulation%mesh)
         call self%record%count_dofs("displacement", 2*mesh%n_cells)
         call self%record%count_dofs("matrix_pressure", mesh%n_cells)
         call self%record%count_dofs("fracture_jump", 4*mesh%fracture%n_cells)
         call self%record%count_dofs("fracture_face_pressure", 2*mesh%fracture%n_cells)
         call self%record%count_dofs("fracture_pressure", mesh%fracture%n_cells)
         call self%record%count_dofs("fracture_flow", size(simulation%model%connections, 2))
      end associate
      n_fine = 0
      do i = 1, size(simulation%tips%window)
         if (simulation%tips%built(i)) n_fine = n_fine &
                                                + simulation%tips%window(i)%model%constraints%n_dofs
      end do
      call self%record%count_dofs("windows", n_fine)
   end subroutine count_unknowns

end module app_journal
