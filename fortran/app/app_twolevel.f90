!> A scene with fluid on both levels: time steps, and growth of the tips in each of them.
module app_twolevel
   use app_journal, only: journal_t
   use app_mode, only: mode_t
   use app_twolevel_fields, only: add_slip_moment, cell_states, count_unknowns, fields_of, &
                                  history_of, probe_values
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_number, only: brief_text
   use base_timers, only: phase_output, timers_t
   use coarse_fields, only: cell_stresses
   use coarse_state, only: step_report_t
   use results_fields, only: fracture_fields_t, intersection_fields_t, matrix_fields_t
   use results_rows, only: history_row_t
   use output_progress, only: progress_values_t
   use output_tables, only: event_step_cut
   use scene_types, only: scene_t
   use twolevel_simulation, only: simulation_t
   implicit none(type, external)
   private

   public :: twolevel_mode_t

   !> relative change of pressure at new tips in a short step
   real(rk), parameter :: settled = 0.01_rk

   !> The scene, its last step, and how the next one is chosen.
   type, extends(mode_t) :: twolevel_mode_t
      private
      type(simulation_t) :: simulation
      logical :: is_initial = .false.  !< the present state is the one before the first step
      real(rk) :: dt = 0.0_rk  !< of the last step [s]
      real(rk), allocatable :: slip_before(:, :)  !< (2, fracture cells) [u]_tau before it [m]
      type(step_report_t) :: report  !< of it
      real(rk) :: next_dt = 0.0_rk  !< to try [s]
      logical :: is_short = .false.  !< after growth, until the pressure at the new tips has settled
      real(rk), allocatable :: pressure(:)  !< of the new cells after the last short step [Pa]
      real(rk) :: seismic_moment = 0.0_rk  !< of all steps, per metre of thickness [N m]
      real(rk) :: mass_error = 0.0_rk  !< of all steps [m2]
   contains
      procedure :: begin
      procedure :: tell_start
      procedure :: next_state
      procedure :: tell_state
      procedure :: grow
      procedure :: tell_end
      procedure :: last_state
   end type twolevel_mode_t

contains

   !> Mesh both levels; nothing is loaded yet.
   subroutine begin(self, scene, timers, error)
      class(twolevel_mode_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call self%simulation%begin(scene, timers, error)
   end subroutine begin

   !> The first network, and what the scene uses and does without.
   subroutine tell_start(self, journal)
      class(twolevel_mode_t), intent(in) :: self
      type(journal_t), intent(inout) :: journal

      associate (simulation => self%simulation, scene => self%simulation%scene, &
                 record => journal%record)
         call journal%files%network_step(simulation%state%time, simulation%network, simulation%mesh)
         call record%use_feature("poroelastic rock")
         call record%note(simulation%mesh%fracture%n_cells > 0, &
                          "fractures: contact, friction, flow", "no fractures")
         call record%note(any(scene%fractures%dilation > 0.0_rk), "shear dilation", &
                          "dilation: psi = 0 everywhere")
         call record%note(size(scene%injections) > 0, "injection", "no injection")
         call record%note(scene%growth%intensities, "stress intensity factors", &
                          "no windows: intensities off")
         call record%note(scene%growth%enabled, "growth", "remeshing and transfer: growth off")
         call record%note(scene%output%vtu, "VTU files", "VTU files: not asked for")
         call record%note(any(scene%sides%pressure_given), "flow across the outer boundary", &
                          "boundary flow: the body is sealed")
         call record%leave_out_feature("intersections: fractures do not meet")
      end associate
   end subroutine tell_start

   !> The initial state first, if the scene wants fractures in equilibrium; then a time step.
   subroutine next_state(self, journal, timers, error)
      class(twolevel_mode_t), intent(inout) :: self
      type(journal_t), intent(inout) :: journal
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      associate (simulation => self%simulation, scene => self%simulation%scene)
         if (.not. self%next_dt > 0.0_rk) then  ! nothing has happened yet
            self%next_dt = scene%time%step
            self%is_initial = scene%initial%fracture_pressure == "equilibrated"
            if (self%is_initial) then
               self%slip_before = simulation%state%jump(2, :, :)
               call simulation%equilibrate(timers, self%report, error)
               if (allocated(error)) return
               self%report%mass_error = 0.0_rk
               if (.not. self%report%converged) then
                  call raise_error(error, "", "the initial state was not found: " &
                                   //self%report%reason)
               end if
               return
            end if
         end if
         self%is_initial = .false.
         call take_step(self, journal, timers, error)
         if (.not. allocated(error)) call choose_step(self)
      end associate
   end subroutine next_state

   !> One accepted step, cut as often as it takes.
   subroutine take_step(self, journal, timers, error)
      type(twolevel_mode_t), intent(inout) :: self
      type(journal_t), intent(inout) :: journal
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: left
      character(len=24) :: number

      associate (simulation => self%simulation, dt => self%dt)
         left = simulation%next_switch() - simulation%state%time
         dt = min(self%next_dt, left)
         ! No tiny step before a switch, and no more step sizes, thus factorizations, than needed.
         if (left < dt*(1.0_rk + 1.0e-9_rk)) dt = left
         self%slip_before = simulation%state%jump(2, :, :)
         do
            call simulation%step(dt, timers, self%report, error)
            if (allocated(error)) return
            if (self%report%converged) exit
            dt = 0.5_rk*dt
            write (number, "(es10.3)") dt
            journal%record%step_cuts = journal%record%step_cuts + 1
            journal%record%newton_total = journal%record%newton_total + self%report%iterations
            call journal%files%event_row(simulation%state%time, event_step_cut, "step cut to " &
                                         //trim(adjustl(number))//" s: "//self%report%reason)
            if (dt < simulation%scene%time%smallest_factor*simulation%scene%time%step) then
               call raise_error(error, "", self%report%reason//", even with a time step of " &
                                //trim(adjustl(number))//" s")
               return
            end if
            self%next_dt = dt
         end do
         journal%record%steps = journal%record%steps + 1
      end associate
   end subroutine take_step

   !> The next step: short ones until the pressure at new tips has settled, and back from cuts by
   !! doubling.
   subroutine choose_step(self)
      type(twolevel_mode_t), intent(inout) :: self
      real(rk), allocatable :: pressure(:)

      associate (time => self%simulation%scene%time)
         if (self%is_short) then
            pressure = self%simulation%state%pressure(self%simulation%grown)
            if (allocated(self%pressure)) then
               if (size(pressure) == size(self%pressure)) self%is_short = &
                  maxval(abs(pressure - self%pressure)) > settled*maxval(abs(pressure))
            end if
            self%pressure = pressure
            self%next_dt = merge(time%growth_factor*time%step, time%step, self%is_short)
         else
            self%next_dt = min(2.0_rk*self%next_dt, time%step)
         end if
      end associate
   end subroutine choose_step

   !> History, events and probes; fields where they are due.
   subroutine tell_state(self, journal, error)
      class(twolevel_mode_t), intent(inout) :: self
      type(journal_t), intent(inout) :: journal
      type(error_t), allocatable, intent(out) :: error
      type(history_row_t) :: row
      real(rk), allocatable :: stresses(:, :), probes(:, :)
      integer(ik), allocatable :: cells(:)
      logical, allocatable :: always(:)

      associate (simulation => self%simulation, record => journal%record, report => self%report)
         call add_slip_moment(simulation, self%slip_before, self%seismic_moment)
         self%mass_error = self%mass_error + report%mass_error
         row = history_of(simulation, self%mass_error)
         row%dt = merge(0.0_rk, self%dt, self%is_initial)
         row%newton_iterations = report%iterations
         row%seismic_moment = self%seismic_moment
         record%contact_residual = max(record%contact_residual, report%contact_residual)
         record%condition_estimate = max(record%condition_estimate, report%condition)
         record%forward_error_bound = max(record%forward_error_bound, report%error_bound)
         record%cells = simulation%mesh%n_cells
         record%fracture_cells = simulation%mesh%fracture%n_cells
         allocate (always(size(simulation%scene%fractures)), source=.true.)
         call journal%contact_events(row%time, simulation%mesh%fracture, cell_states(simulation), &
                                     always, always)
         if (size(simulation%scene%probes) > 0) then
            call probe_values(simulation, probes, cells, error)
            if (allocated(error)) return
            stresses = stresses_of(simulation)
            call journal%files%probe_row(row%time, probes(:2, :), stresses(:, cells), probes(3, :))
         end if
         if (journal%files%fields_due(row%time)) then
            if (.not. allocated(stresses)) stresses = stresses_of(simulation)
            call write_fields(simulation, journal, stresses, error)
            if (allocated(error)) return
         end if
         call journal%state_done(row, progress_values_t(time_end=simulation%scene%time%end), error)
      end associate
   end subroutine tell_state

   !> Evaluate the tips, and let them grow until none does or the coarse level has to follow.
   subroutine grow(self, journal, timers, error)
      class(twolevel_mode_t), intent(inout) :: self
      type(journal_t), intent(inout) :: journal
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      logical :: coarse_grew

      associate (simulation => self%simulation, scene => self%simulation%scene)
         coarse_grew = .false.
         if (scene%growth%intensities) then
            call simulation%evaluate_tips(timers, error)
            if (allocated(error)) return
            if (self%is_initial) then
               call tell_tips(self, journal, timers)
            else
               call follow_tips(self, journal, coarse_grew, timers, error)
               if (allocated(error)) return
            end if
         end if
         if (simulation%state%time >= scene%time%end*(1.0_rk - 1.0e-12_rk)) then
            if (.not. allocated(self%ending)) self%ending = "the scene's end time"
         else if (allocated(self%ending) .and. self%is_short) then
            ! The last growth changed the coarse mesh: find the state on it, so that the fields show
            ! it.
            call take_step(self, journal, timers, error)
            if (allocated(error)) return
            call timers%start(phase_output)
            call self%tell_state(journal, error)
            call timers%stop(phase_output)
            if (.not. allocated(error)) call simulation%evaluate_tips(timers, error)
            if (allocated(error)) return
            simulation%tips%tip%advance = 0.0_rk
            call tell_tips(self, journal, timers)
         end if
      end associate
   end subroutine grow

   !> Increment by increment.
   subroutine follow_tips(self, journal, coarse_grew, timers, error)
      type(twolevel_mode_t), intent(inout) :: self
      type(journal_t), intent(inout) :: journal
      logical, intent(out) :: coarse_grew
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: increment
      logical :: any_grew

      coarse_grew = .false.
      associate (simulation => self%simulation, scene => self%simulation%scene)
         increment = scene%growth%increment
         if (.not. increment > 0.0_rk) increment = scene%discretization%fine_ratio &
                                                   *scene%discretization%size_fracture
         do
            any_grew = .false.
            if (scene%growth%enabled) then
               call simulation%grow_tips(increment, any_grew, timers, error)
               if (allocated(error)) return
            end if
            call tell_tips(self, journal, timers)
            call journal%growth_done(simulation%state%time, scene, simulation%tips%tip)
            if (.not. any_grew) return
            call simulation%grow_coarse(increment, coarse_grew, timers, error)
            if (allocated(error)) return
            call self%end_at_gain(scene, simulation%start, simulation%tips%network, &
                                  simulation%tips%tip)
            if (coarse_grew) then
               call journal%mesh_done(simulation%state%time, simulation%network, simulation%mesh)
               self%is_short = .true.
               self%next_dt = scene%time%growth_factor*scene%time%step
               if (allocated(self%pressure)) deallocate (self%pressure)
            end if
            if (coarse_grew .or. allocated(self%ending)) return
         end do
      end associate
   end subroutine follow_tips

   subroutine tell_tips(self, journal, timers)
      type(twolevel_mode_t), intent(in) :: self
      type(journal_t), intent(inout) :: journal
      type(timers_t), intent(inout) :: timers

      call timers%start(phase_output)
      call journal%tips_done(self%simulation%state%time, self%simulation%tips%tip)
      call timers%stop(phase_output)
   end subroutine tell_tips

   !> Fields of the last good state, unless the coarse mesh is ahead of it; unknowns.
   subroutine tell_end(self, journal, error)
      class(twolevel_mode_t), intent(inout) :: self
      type(journal_t), intent(inout) :: journal
      type(error_t), allocatable, intent(out) :: error

      associate (simulation => self%simulation)
         call count_unknowns(simulation, journal%record)
         if (.not. simulation%state%time > journal%fields_time) return
         if (.not. allocated(simulation%state%tractions)) return
         if (size(simulation%state%unknowns, 2) /= simulation%model%regions%n_blocks) return
         call write_fields(simulation, journal, stresses_of(simulation), error)
      end associate
   end subroutine tell_end

   !> The time of the last good state.
   pure function last_state(self) result(words)
      class(twolevel_mode_t), intent(in) :: self
      character(len=:), allocatable :: words

      words = brief_text(self%simulation%state%time, 6)//" s"
   end function last_state

   !> Stress of each cell: xx, yy, xy [Pa].
   function stresses_of(simulation) result(stresses)
      type(simulation_t), intent(in) :: simulation
      real(rk) :: stresses(3, simulation%mesh%n_cells)

      call cell_stresses(simulation%mesh, simulation%model%regions, simulation%state%tractions, &
                         stresses)
   end function stresses_of

   subroutine write_fields(simulation, journal, stresses, error)
      type(simulation_t), intent(in) :: simulation
      type(journal_t), intent(inout) :: journal
      real(rk), intent(in) :: stresses(:, :)  !< (3, cells) [Pa]
      type(error_t), allocatable, intent(out) :: error
      type(matrix_fields_t) :: matrix
      type(fracture_fields_t) :: fracture
      type(intersection_fields_t) :: none

      call fields_of(simulation, matrix, fracture)
      matrix%stress = stresses
      allocate (none%point(0), none%pressure(0))
      call journal%files%write_fields(simulation%state%time, simulation%mesh, matrix, fracture, &
                                      none, error)
      journal%fields_time = simulation%state%time
   end subroutine write_fields

end module app_twolevel
