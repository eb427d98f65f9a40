!> What a mechanics-only scene tells its files: rows, fields and events.
module app_load_journal
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: phase_output, timers_t
   use mechanics_fields, only: cell_displacement, cell_stress, fracture_jump, fracture_traction, &
                               point_state
   use mechanics_simulation, only: simulation_t
   use mesh_builder, only: locate
   use contact_states, only: state_open, state_slip, state_stick
   use output_fields, only: fracture_fields_t, history_row_t, intersection_fields_t, &
                            matrix_fields_t, tip_row_t
   use output_progress, only: progress_t, progress_values_t
   use output_record, only: run_record_t
   use output_run, only: run_output_t
   use mesh_types, only: point_boundary, point_interior, point_tip
   use output_tables, only: event_growth, event_joint, event_opening, event_remesh, event_slip_onset
   use tips_growth, only: growth_drive_t
   use tips_network, only: total_length
   use tips_types, only: intensity_t
   implicit none(type, external)
   private

   public :: load_journal_t

   !> Files, record and progress line of a run.
   type :: load_journal_t
      type(run_output_t) :: files
      type(run_record_t) :: record
      type(progress_t) :: progress
      real(rk) :: time = 0.0_rk  !< of the last row of history.csv [s]
      real(rk) :: fields_time = -1.0_rk  !< when fields were last written [s]
      logical, allocatable :: has_slipped(:), has_opened(:)  !< (fractures)
   contains
      procedure :: open => open_journal
      procedure :: step_done
      procedure :: fields_done
      procedure :: tips_done
      procedure :: growth_done
   end type load_journal_t

contains

   !> Open the files.
   subroutine open_journal(self, directory, quiet, simulation, error)
      class(load_journal_t), intent(inout) :: self
      character(len=*), intent(in) :: directory
      logical, intent(in) :: quiet
      type(simulation_t), intent(in) :: simulation
      type(error_t), allocatable, intent(out) :: error

      call self%files%open(directory, simulation%scene, error, has_fluid=.false.)
      if (allocated(error)) return
      call self%progress%begin(quiet)
      allocate (self%has_slipped(size(simulation%scene%fractures)), source=.false.)
      allocate (self%has_opened(size(simulation%scene%fractures)), source=.false.)
      call self%files%network_step(simulation%time(), simulation%network, simulation%body%mesh)
   end subroutine open_journal

   !> A load factor has been reached: history and probes.
   subroutine step_done(self, simulation, timers, error)
      class(load_journal_t), intent(inout) :: self
      type(simulation_t), intent(in) :: simulation
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(history_row_t) :: row
      real(rk), allocatable :: jump(:, :)
      integer(ik) :: i

      call timers%start(phase_output)
      associate (body => simulation%body)
         row%time = simulation%time()
         row%dt = row%time - self%time
         self%time = row%time
         row%load_factor = simulation%factor
         row%strain_energy = body%model%strain_energy(body%displacement)
         row%fracture_length = total_length(simulation%network)
         row%seismic_moment = simulation%seismic_moment()
         row%n_tips = body%mesh%fracture%n_tips
         row%n_intersections = count([(all(body%mesh%fracture%point_kind(i) /= &
                                           [point_interior, point_tip, point_boundary]), &
                                       i=1, body%mesh%fracture%n_points)])
         if (body%mesh%fracture%n_cells > 0) then
            jump = fracture_jump(body)
            row%max_opening = maxval(jump(1, :))
            row%max_slip = maxval(abs(jump(2, :)))
            row%fracture_volume = sum(jump(1, :)*body%model%mesh%face_length)
            associate (state => body%contact%state(3, :))
               row%n_stick = count(state == state_stick)
               row%n_slip = count(state == state_slip)
               row%n_open = count(state == state_open)
            end associate
            row%newton_iterations = body%contact%iterations
         end if
         call self%files%history_row(row)
         self%record%steps = self%record%steps + 1
         self%record%contact_residual = max(self%record%contact_residual, body%contact%residual)
         self%record%newton_total = self%record%newton_total + body%contact%iterations
         self%record%newton_max = max(self%record%newton_max, body%contact%iterations)
         self%record%cells = body%mesh%n_cells
         self%record%fracture_cells = body%mesh%fracture%n_cells
         call self%record%count_dofs("displacement", body%model%constraints%n_dofs)
      end associate
      call note_events(self, simulation)
      call log_error(self, simulation)
      call write_probes(self, simulation, error)
      if (.not. allocated(error)) call self%files%tick(error)
      call self%progress%show(progress_values_t(time=row%time, time_end=1.0_rk, &
                                                step=self%record%steps, n_open=row%n_open, &
                                                fracture_length=row%fracture_length))
      call timers%stop(phase_output)
   end subroutine step_done

   !> First slip against friction, and first opening, of each fracture whose faces touch.
   subroutine note_events(self, simulation)
      class(load_journal_t), intent(inout) :: self
      type(simulation_t), intent(in) :: simulation
      real(rk) :: centre(2)
      integer(ik) :: cell, f

      associate (fracture => simulation%body%mesh%fracture, &
                 state => simulation%body%contact%state(3, :))
         do cell = 1, fracture%n_cells
            f = fracture%cell_fracture(cell)
            if (simulation%scene%fractures(f)%law == "open") cycle
            centre = 0.5_rk*sum(fracture%point_xy(:, fracture%cell_points(:, cell)), dim=2)
            if (state(cell) == state_slip .and. .not. self%has_slipped(f) .and. &
                simulation%scene%fractures(f)%friction > 0.0_rk) then
               self%has_slipped(f) = .true.
               call self%files%event_row(simulation%time(), event_slip_onset, "first slip", f, &
                                         centre)
            else if (state(cell) == state_open .and. .not. self%has_opened(f)) then
               self%has_opened(f) = .true.
               call self%files%event_row(simulation%time(), event_opening, "first opening", f, &
                                         centre)
            end if
         end do
      end associate
   end subroutine note_events

   !> The estimated error of an adaptive mesh, into the log.
   subroutine log_error(self, simulation)
      class(load_journal_t), intent(inout) :: self
      type(simulation_t), intent(in) :: simulation
      character(len=120) :: line

      if (.not. simulation%scene%adaptive%enabled) return
      write (line, "(a,es13.6,a,es9.2,a,i0,a)") "load factor ", simulation%factor, &
         ": estimated error in the energy norm ", simulation%body%estimate%relative, ", ", &
         simulation%body%mesh%n_cells, " elements"
      call self%files%log(trim(line))
   end subroutine log_error

   !> Displacement and stress at the probes.
   subroutine write_probes(self, simulation, error)
      class(load_journal_t), intent(inout) :: self
      type(simulation_t), intent(in) :: simulation
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: xy(:, :), displacement(:, :), stress(:, :)
      integer(ik), allocatable :: cells(:)
      integer(ik) :: i, n

      n = size(simulation%scene%probes)
      if (n == 0) return
      allocate (xy(2, n), displacement(2, n), stress(3, n), cells(n))
      xy(1, :) = simulation%scene%probes%x
      xy(2, :) = simulation%scene%probes%y
      call locate(simulation%body%mesher, xy, cells, error)
      if (allocated(error)) return
      do i = 1, n
         call point_state(simulation%body, cells(i), xy(:, i), displacement(:, i), stress(:, i))
      end do
      call self%files%probe_row(simulation%time(), displacement, stress)
   end subroutine write_probes

   !> The fields, unless they have just been written.
   subroutine fields_done(self, simulation, timers, error)
      class(load_journal_t), intent(inout) :: self
      type(simulation_t), intent(in) :: simulation
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(matrix_fields_t) :: matrix
      type(fracture_fields_t) :: fracture
      type(intersection_fields_t) :: none
      real(rk), allocatable :: pairs(:, :)

      if (.not. simulation%time() > self%fields_time) return
      if (.not. allocated(simulation%body%displacement)) return
      call timers%start(phase_output)
      associate (body => simulation%body)
         matrix%displacement = cell_displacement(body)
         matrix%node_xy = body%model%mesh%xy
         matrix%cell_nodes = body%model%mesh%cell_nodes
         matrix%node_displacement = body%displacement
         matrix%stress = cell_stress(body)
         pairs = fracture_jump(body)
         fracture%jump_n = pairs(1, :)
         fracture%jump_t = pairs(2, :)
         pairs = fracture_traction(body)
         fracture%traction_n = pairs(1, :)
         fracture%traction_t = pairs(2, :)
         fracture%state = body%contact%state(3, :)
         call self%files%write_fields(simulation%time(), body%mesh, matrix, fracture, none, error)
      end associate
      self%fields_time = simulation%time()
      call timers%stop(phase_output)
   end subroutine fields_done

   !> A row of tips.csv for each tip: where it was before it grew, if it did.
   subroutine tips_done(self, simulation, timers)
      class(load_journal_t), intent(inout) :: self
      type(simulation_t), intent(in) :: simulation
      type(timers_t), intent(inout) :: timers
      integer(ik) :: i

      call timers%start(phase_output)
      do i = 1, size(simulation%tip)
         associate (tip => simulation%tip(i))
            if (tip%advance > 0.0_rk) then
               call add_row(tip%origin, tip%intensity_before, tip%drive_before, tip%kink, &
                            tip%advance)
            else if (any(simulation%tip%advance > 0.0_rk)) then
               call add_row(tip%xy, tip%intensity_before, tip%drive_before, &
                            tip%drive_before%angle, 0.0_rk)
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

         call self%files%tip_row(tip_row_t(time=simulation%time(), tip=i, &
                                           fracture=simulation%tip(i)%fracture, xy=xy, &
                                           k1=intensity%k1, k2=intensity%k2, &
                                           k1_dc=intensity%k1_dc, k2_dc=intensity%k2_dc, &
                                           keq=drive%intensity, g=drive%energy, angle=angle, &
                                           advance=advance, k1_error=intensity%k1_error, &
                                           k2_error=intensity%k2_error, &
                                           g_domain=intensity%g_domain))
      end subroutine add_row

   end subroutine tips_done

   !> Events of the tips that have just grown or stopped, and of the new mesh.
   subroutine growth_done(self, simulation)
      class(load_journal_t), intent(inout) :: self
      type(simulation_t), intent(in) :: simulation
      real(rk), parameter :: degrees = 180.0_rk/acos(-1.0_rk)  ! per radian
      character(len=64) :: detail
      integer(ik) :: i

      do i = 1, size(simulation%tip)
         associate (tip => simulation%tip(i))
            if (tip%advance > 0.0_rk) then
               write (detail, "(a,es10.3,a,f7.2,a)") "advance ", tip%advance, " m, kink ", &
                  tip%kink*degrees, " deg"
               call self%files%event_row(simulation%time(), event_growth, trim(detail), &
                                         tip%fracture, tip%xy)
               if (allocated(tip%joint)) then
                  call self%files%event_row(simulation%time(), event_joint, tip%joint, &
                                            tip%fracture, tip%xy)
               end if
            end if
         end associate
      end do
      if (.not. any(simulation%tip%advance > 0.0_rk)) return
      associate (mesh => simulation%body%mesh)
         write (detail, "(i0,a,i0,a)") mesh%n_cells, " cells, ", mesh%fracture%n_cells, &
            " fracture cells"
         call self%files%event_row(simulation%time(), event_remesh, trim(detail))
         call self%files%network_step(simulation%time(), simulation%network, mesh)
      end associate
   end subroutine growth_done

end module app_load_journal
