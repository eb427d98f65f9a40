!> A mechanics-only scene: the load rises in steps, and from one onset of growth to the next.
module app_mechanics
   use app_journal, only: journal_t
   use app_mechanics_fields, only: body_fields_t, fields_of, history_of, probe_values, touches
   use app_mode, only: mode_t
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_number, only: brief_text
   use base_timers, only: phase_output, timers_t
   use mechanics_simulation, only: simulation_t
   use results_fields, only: intersection_fields_t
   use results_rows, only: history_row_t
   use output_progress, only: progress_values_t
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: mechanics_mode_t

   !> The scene, and where its load programme stands.
   type, extends(mode_t) :: mechanics_mode_t
      private
      type(simulation_t) :: simulation
      integer(ik) :: step = 1  !< of the programme, that the load rises in
      logical :: has_onset = .false.  !< growth has stopped the rise
      real(rk) :: told_time = 0.0_rk  !< of the last row of history.csv [s]
      type(body_fields_t) :: good  !< of the last accepted state
      logical :: is_good = .false.  !< the present state is in equilibrium, not one on the way
   contains
      procedure :: begin
      procedure :: tell_start
      procedure :: next_state
      procedure :: tell_state
      procedure :: grow
      procedure :: tell_end
      procedure :: last_state
   end type mechanics_mode_t

contains

   !> Mesh the body; nothing is loaded yet.
   subroutine begin(self, scene, timers, error)
      class(mechanics_mode_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call self%simulation%begin(scene, timers, error)
   end subroutine begin

   !> The first network, and what the scene uses and does without.
   subroutine tell_start(self, journal)
      class(mechanics_mode_t), intent(in) :: self
      type(journal_t), intent(inout) :: journal

      associate (simulation => self%simulation, scene => self%simulation%scene, &
                 record => journal%record)
         call journal%files%network_step(simulation%time(), simulation%network, &
                                         simulation%body%mesh)
         call record%use_feature("elastic rock, finite elements on the whole body")
         call record%leave_out_feature("pressure, flow and the coarse level: no fluid")
         call record%note(size(scene%fractures) > 0, "fractures", "no fractures")
         call record%note(scene%growth%intensities, "stress intensity factors", "intensities off")
         call record%note(scene%growth%enabled, "growth", "remeshing: growth off")
         call record%note(scene%adaptive%enabled, "meshes that follow the error", &
                          "error estimates: not asked for")
         call record%note(scene%output%vtu, "VTU files", "VTU files: not asked for")
         if (is_hard_for_tips(scene)) then
            call record%warn("Poisson's ratio is nearly 0.5: the elements around the tips are "// &
                             "too stiff, the stress intensity factors have errors up to 1 % "// &
                             "and far more by displacement correlation; with &adaptive "// &
                             "enabled = .true. the former are within 0.1 %")
         end if
      end associate
   end subroutine tell_start

   !> Rock so nearly incompressible that the elements around the tips are too stiff, on a mesh that
   !! does not follow the error (verification/extreme_cracks).
   pure logical function is_hard_for_tips(scene)
      type(scene_t), intent(in) :: scene
      real(rk), parameter :: nearly_incompressible = 0.49_rk

      is_hard_for_tips = scene%growth%intensities .and. .not. scene%adaptive%enabled .and. &
                         .not. scene%material%plane_stress .and. &
                         scene%material%poisson > nearly_incompressible
   end function is_hard_for_tips

   !> Raise the load to the end of the programme's step, or to the next onset of growth.
   subroutine next_state(self, journal, timers, error)
      class(mechanics_mode_t), intent(inout) :: self
      type(journal_t), intent(inout) :: journal
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: target

      associate (load => self%simulation%scene%load)
         target = load%from + (load%to - load%from)*real(self%step, rk)/real(load%steps, rk)
         if (self%step == load%steps) target = load%to
      end associate
      self%is_good = .false.
      call self%simulation%rise(target, self%has_onset, timers, error)
      if (allocated(error)) return
      self%is_good = .true.
      journal%record%steps = journal%record%steps + 1
   end subroutine next_state

   !> History, events and probes; fields at the end of a step of the programme.
   subroutine tell_state(self, journal, error)
      class(mechanics_mode_t), intent(inout) :: self
      type(journal_t), intent(inout) :: journal
      type(error_t), allocatable, intent(out) :: error
      type(history_row_t) :: row
      real(rk), allocatable :: displacement(:, :), stress(:, :)
      logical :: closes(size(self%simulation%scene%fractures))

      associate (simulation => self%simulation, body => self%simulation%body, &
                 record => journal%record)
         row = history_of(simulation)
         row%dt = row%time - self%told_time
         self%told_time = row%time
         record%contact_residual = max(record%contact_residual, body%contact%residual)
         record%has_growth = simulation%scene%growth%enabled
         record%meshes_whole = body%whole_meshes
         record%meshes_patched = body%patched_meshes
         record%cells = body%mesh%n_cells
         record%fracture_cells = body%mesh%fracture%n_cells
         if (record%smallest_angle > body%smallest_angle .or. &
             .not. record%smallest_angle > 0.0_rk) record%smallest_angle = body%smallest_angle
         record%energy_error = body%estimate%relative
         call record%count_dofs("displacement", body%model%constraints%n_dofs)
         closes = touches(simulation%scene%fractures)
         call journal%contact_events(row%time, body%mesh%fracture, body%contact%state(3, :), &
                                     closes .and. simulation%scene%fractures%friction > 0.0_rk, &
                                     closes)
         if (simulation%scene%adaptive%enabled) call log_error(simulation, journal)
         if (size(simulation%scene%probes) > 0) then
            call probe_values(simulation, displacement, stress, error)
            if (allocated(error)) return
            call journal%files%probe_row(row%time, displacement, stress)
         end if
         self%good = fields_of(simulation)
         if (.not. self%has_onset) call write_fields(journal, self%good, error)
      end associate
      if (allocated(error)) return
      call journal%state_done(row, progress_values_t(time_end=1.0_rk, is_load=.true., &
                                                     load_factor=row%load_factor, &
                                                     n_tips=row%n_tips), error)
   end subroutine tell_state

   !> The estimated error of an adaptive mesh, into the log.
   subroutine log_error(simulation, journal)
      type(simulation_t), intent(in) :: simulation
      type(journal_t), intent(inout) :: journal
      character(len=120) :: line

      write (line, "(a,es13.6,a,es9.2,a,i0,a)") "load factor ", simulation%factor, &
         ": estimated error in the energy norm ", simulation%body%estimate%relative, ", ", &
         simulation%body%mesh%n_cells, " elements"
      call journal%files%log(trim(line))
   end subroutine log_error

   !> Let the tips at their onset grow by one increment.
   subroutine grow(self, journal, timers, error)
      class(mechanics_mode_t), intent(inout) :: self
      type(journal_t), intent(inout) :: journal
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: increment
      logical :: any_grew

      any_grew = .false.
      associate (simulation => self%simulation, scene => self%simulation%scene)
         if (self%has_onset) then
            increment = scene%growth%increment
            if (.not. increment > 0.0_rk) increment = scene%discretization%size_fracture
            call simulation%grow(increment, any_grew, timers, error)
            self%is_good = .not. allocated(error)
            if (simulation%is_cut) then  ! no equilibrium is left, and that is how the scene ends
               self%ending = "a piece of the body has come loose"
               if (allocated(error)) deallocate (error)
            end if
            if (allocated(error)) return
         else
            simulation%tip%advance = 0.0_rk
            self%step = self%step + 1
            if (self%step > scene%load%steps) self%ending = "the scene's last load factor"
         end if
         call timers%start(phase_output)
         if (scene%growth%intensities) call journal%tips_done(simulation%time(), simulation%tip)
         call journal%growth_done(simulation%time(), scene, simulation%tip)
         if (any_grew) then
            call journal%mesh_done(simulation%time(), simulation%network, simulation%body%mesh)
            journal%record%increments = journal%record%increments + 1
         end if
         call timers%stop(phase_output)
         if (any_grew .and. .not. simulation%is_cut) then
            call self%end_at_gain(scene, simulation%start, simulation%network, simulation%tip)
         end if
      end associate
   end subroutine grow

   !> Fields of the present state, or of the last accepted one if there is none.
   subroutine tell_end(self, journal, error)
      class(mechanics_mode_t), intent(inout) :: self
      type(journal_t), intent(inout) :: journal
      type(error_t), allocatable, intent(out) :: error

      if (.not. allocated(self%good%matrix%displacement)) return
      if (self%is_good) self%good = fields_of(self%simulation)
      call write_fields(journal, self%good, error)
   end subroutine tell_end

   !> The load factor that was told last.
   pure function last_state(self) result(words)
      class(mechanics_mode_t), intent(in) :: self
      character(len=:), allocatable :: words

      associate (load => self%simulation%scene%load)
         words = "load factor "//brief_text(load%from + self%told_time*(load%to - load%from), 6)
      end associate
   end function last_state

   !> Fields, unless those of this time have been written.
   subroutine write_fields(journal, fields, error)
      type(journal_t), intent(inout) :: journal
      type(body_fields_t), intent(in) :: fields
      type(error_t), allocatable, intent(out) :: error
      type(intersection_fields_t) :: none

      if (.not. fields%time > journal%fields_time) return
      call journal%files%write_fields(fields%time, fields%mesh, fields%matrix, fields%fracture, &
                                      none, error)
      journal%fields_time = fields%time
   end subroutine write_fields

end module app_mechanics
