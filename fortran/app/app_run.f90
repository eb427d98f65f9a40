!> Run a scene: the loop over time steps and growth.
module app_run
   use app_journal, only: journal_t
   use app_process, only: interrupted
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_timers, only: phase_output, timers_t
   use coarse_state, only: step_report_t
   use output_record, only: status_failed, status_finished, status_stopped
   use output_tables, only: event_step_cut
   use scene_types, only: scene_t
   use tips_network, only: end_gain
   use twolevel_simulation, only: simulation_t
   implicit none(type, external)
   private

   public :: run_scene

   !> relative change of pressure at new tips in a short step
   real(rk), parameter :: settled = 0.01_rk

   !> How the time step is chosen.
   type :: stepping_t
      real(rk) :: next = 0.0_rk  !< step to try [s]
      logical :: short = .false.  !< after growth, until the pressure at the new tips has settled
      real(rk), allocatable :: pressure(:)  !< of the new cells after the last short step [Pa]
   end type stepping_t

contains

   !> Run a scene to its end. `refused` tells that it could not even begin, and nothing was written.
   subroutine run_scene(scene, directory, version, quiet, refused, was_interrupted, error)
      type(scene_t), intent(in) :: scene
      character(len=*), intent(in) :: directory, version
      logical, intent(in) :: quiet
      logical, intent(out) :: refused, was_interrupted
      type(error_t), allocatable, intent(out) :: error

      type(simulation_t) :: simulation
      type(journal_t) :: journal
      type(timers_t) :: timers
      type(error_t), allocatable :: trouble

      was_interrupted = .false.
      call timers%begin()
      call simulation%begin(scene, timers, error)
      refused = allocated(error)
      if (refused) return
      call timers%start(phase_output)
      call journal%open(directory, quiet, simulation, error)
      call timers%stop(phase_output)
      if (allocated(error)) return
      journal%record%scene = trim(scene%name)
      journal%record%version = version
      call note_features(journal, scene, simulation)
      call march(simulation, journal, timers, error)
      if (allocated(error)) then
         journal%record%status = status_failed
         journal%record%reason = error%message
      else if (interrupted()) then
         was_interrupted = .true.
         journal%record%status = status_stopped
         journal%record%reason = "interrupted"
      else
         journal%record%status = status_finished
      end if
      call journal%progress%clear()
      call journal%write_last_state(simulation, timers, trouble)
      if (allocated(trouble) .and. .not. allocated(error)) call move_alloc(trouble, error)
      call journal%count_unknowns(simulation)
      call journal%files%log(journal%record%status//": "//journal%record%reason)
      call journal%files%close(journal%record, timers, trouble)
      if (allocated(trouble) .and. .not. allocated(error)) call move_alloc(trouble, error)
   end subroutine run_scene

   !> Steps until the end of the scene.
   subroutine march(simulation, journal, timers, error)
      type(simulation_t), intent(inout) :: simulation
      type(journal_t), intent(inout) :: journal
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      type(stepping_t) :: stepping
      type(step_report_t) :: report
      real(rk), allocatable :: slip_before(:, :)
      real(rk) :: dt
      logical :: is_done

      associate (scene => simulation%scene)
         if (scene%initial%fracture_pressure == "equilibrated") then
            slip_before = simulation%state%jump(2, :, :)
            call simulation%equilibrate(timers, report, error)
            if (.not. allocated(error) .and. .not. report%converged) then
               call raise_error(error, "", "the initial state was not found: "//report%reason)
            end if
            if (allocated(error)) return
            report%mass_error = 0.0_rk
            call journal%step_done(simulation, 0.0_rk, slip_before, report, timers, error)
            if (.not. allocated(error) .and. scene%growth%intensities) then
               call simulation%evaluate_tips(timers, error)
               call journal%tips_done(simulation, timers)
            end if
            if (allocated(error)) return
         end if

         stepping%next = scene%time%step
         do
            if (simulation%state%time >= scene%time%end*(1.0_rk - 1.0e-12_rk)) then
               journal%record%reason = "the scene's end time"
               return
            end if
            if (interrupted()) return
            call take_step(simulation, journal, stepping, timers, dt, slip_before, report, error)
            if (allocated(error)) return
            call journal%step_done(simulation, dt, slip_before, report, timers, error)
            if (allocated(error)) return
            call choose_step(simulation, stepping)
            if (.not. scene%growth%intensities) cycle
            call follow_tips(simulation, journal, stepping, timers, is_done, error)
            if (allocated(error)) return
            if (is_done) exit
         end do
         if (.not. stepping%short) return
         ! The last growth changed the coarse mesh: find the state on it, so that the fields show
         ! it.
         call take_step(simulation, journal, stepping, timers, dt, slip_before, report, error)
         if (.not. allocated(error)) then
            call journal%step_done(simulation, dt, slip_before, report, timers, error)
         end if
         if (.not. allocated(error)) call simulation%evaluate_tips(timers, error)
         if (allocated(error)) return
         simulation%tips%tip%advance = 0.0_rk
         call journal%tips_done(simulation, timers)
      end associate
   end subroutine march

   !> One accepted step, cut as often as it takes.
   subroutine take_step(simulation, journal, stepping, timers, dt, slip_before, report, error)
      type(simulation_t), intent(inout) :: simulation
      type(journal_t), intent(inout) :: journal
      type(stepping_t), intent(inout) :: stepping
      type(timers_t), intent(inout) :: timers
      real(rk), intent(out) :: dt  !< [s]
      real(rk), allocatable, intent(out) :: slip_before(:, :)  !< [m]
      type(step_report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error

      real(rk) :: left
      character(len=24) :: number

      left = simulation%next_switch() - simulation%state%time
      dt = min(stepping%next, left)
      ! No tiny step before a switch, and no more step sizes, thus factorizations, than needed.
      if (left < dt*(1.0_rk + 1.0e-9_rk)) dt = left
      slip_before = simulation%state%jump(2, :, :)
      do
         call simulation%step(dt, timers, report, error)
         if (allocated(error)) return
         if (report%converged) return
         dt = 0.5_rk*dt
         write (number, "(es10.3)") dt
         journal%record%step_cuts = journal%record%step_cuts + 1
         journal%record%newton_total = journal%record%newton_total + report%iterations
         call journal%files%event_row(simulation%state%time, event_step_cut, "step cut to " &
                                      //trim(adjustl(number))//" s: "//report%reason)
         if (dt < simulation%scene%time%smallest_factor*simulation%scene%time%step) then
            call raise_error(error, "", report%reason//", even with a time step of " &
                             //trim(adjustl(number))//" s")
            return
         end if
         stepping%next = dt
      end do
   end subroutine take_step

   !> The next step: short ones until the pressure at new tips has settled, and back from cuts by
   !! doubling.
   subroutine choose_step(simulation, stepping)
      type(simulation_t), intent(in) :: simulation
      type(stepping_t), intent(inout) :: stepping

      real(rk), allocatable :: pressure(:)

      associate (regular => simulation%scene%time%step)
         if (stepping%short) then
            pressure = simulation%state%pressure(simulation%grown)
            if (allocated(stepping%pressure)) then
               if (size(pressure) == size(stepping%pressure)) stepping%short = &
                  maxval(abs(pressure - stepping%pressure)) > settled*maxval(abs(pressure))
            end if
            stepping%pressure = pressure
            stepping%next = merge(simulation%scene%time%growth_factor*regular, regular, &
                                  stepping%short)
         else
            stepping%next = min(2.0_rk*stepping%next, regular)
         end if
      end associate
   end subroutine choose_step

   !> Evaluate the tips, let them grow until none does or the coarse level has to follow.
   subroutine follow_tips(simulation, journal, stepping, timers, is_done, error)
      type(simulation_t), intent(inout) :: simulation
      type(journal_t), intent(inout) :: journal
      type(stepping_t), intent(inout) :: stepping
      type(timers_t), intent(inout) :: timers
      logical, intent(out) :: is_done
      type(error_t), allocatable, intent(out) :: error

      real(rk) :: increment
      logical :: any_grew, coarse_grew

      is_done = .false.
      associate (scene => simulation%scene)
         increment = scene%growth%increment
         if (.not. increment > 0.0_rk) increment = scene%discretization%fine_ratio &
                                                   *scene%discretization%size_fracture
         call simulation%evaluate_tips(timers, error)
         do
            if (allocated(error)) return
            any_grew = .false.
            if (scene%growth%enabled) call simulation%grow_tips(increment, any_grew, timers, error)
            if (allocated(error)) return
            call journal%tips_done(simulation, timers)
            call journal%growth_done(simulation, .false.)
            if (.not. any_grew) return
            call simulation%grow_coarse(increment, coarse_grew, timers, error)
            if (allocated(error)) return
            call check_gain(simulation, journal, is_done)
            if (coarse_grew) then
               call journal%growth_done(simulation, .true.)
               stepping%short = .true.
               stepping%next = scene%time%growth_factor*scene%time%step
               if (allocated(stepping%pressure)) deallocate (stepping%pressure)
               return
            end if
            if (is_done) return
         end do
      end associate
   end subroutine follow_tips

   !> Whether a fracture's end has grown as far as the scene wants.
   subroutine check_gain(simulation, journal, is_done)
      type(simulation_t), intent(in) :: simulation
      type(journal_t), intent(inout) :: journal
      logical, intent(out) :: is_done

      integer(ik) :: i

      is_done = .false.
      do i = 1, size(simulation%tips%tip)
         associate (tip => simulation%tips%tip(i))
            if (end_gain(simulation%tips%network, simulation%start, tip%fracture, tip%end) &
                < simulation%scene%growth%stop_gain) cycle
            is_done = .true.
            journal%record%reason = "fracture " &
                      //trim(simulation%scene%fractures(tip%fracture)%name)//" has gained stop_gain"
         end associate
      end do
   end subroutine check_gain

   !> What the scene uses and what it does without.
   subroutine note_features(journal, scene, simulation)
      type(journal_t), intent(inout) :: journal
      type(scene_t), intent(in) :: scene
      type(simulation_t), intent(in) :: simulation

      call journal%record%use_feature("poroelastic rock")
      call note(simulation%mesh%fracture%n_cells > 0, "fractures: contact, friction, flow", &
                "no fractures")
      call note(any(scene%fractures%dilation > 0.0_rk), "shear dilation", &
                "dilation: psi = 0 everywhere")
      call note(size(scene%injections) > 0, "injection", "no injection")
      call note(scene%growth%intensities, "stress intensity factors", "no windows: intensities off")
      call note(scene%growth%enabled, "growth", "remeshing and transfer: growth off")
      call note(scene%output%vtu, "VTU files", "VTU files: not asked for")
      call note(any(scene%sides%pressure_given), "flow across the outer boundary", &
                "boundary flow: the body is sealed")
      call journal%record%leave_out_feature("intersections: fractures do not meet")

   contains

      subroutine note(has, used, left_out)
         logical, intent(in) :: has
         character(len=*), intent(in) :: used, left_out

         if (has) then
            call journal%record%use_feature(used)
         else
            call journal%record%leave_out_feature(left_out)
         end if
      end subroutine note

   end subroutine note_features

end module app_run
