!> Run a scene from start to end, whichever way it is simulated.
module app_run
   use app_journal, only: journal_t
   use app_interrupts, only: interrupted
   use app_simulations, only: allocate_simulation
   use app_version, only: version
   use app_warnings, only: show_warnings
   use base_errors, only: error_t, keep_first
   use base_kinds, only: rk
   use base_texts, only: text_t
   use base_timers, only: listener_t, phase_output, timers_t
   use growth_network, only: total_length
   use output_closing, only: closing_lines
   use output_record, only: run_record_t, status_failed, status_finished, status_stopped
   use scene_types, only: scene_t
   use simulation_types, only: simulation_t
   use, intrinsic :: iso_fortran_env, only: output_unit
   implicit none(type, external)
   private

   public :: run_scene

   !> Hears of long work: shows it, and ends it as the user wants.
   type, extends(listener_t) :: follower_t
      type(journal_t), pointer :: journal => null()
   contains
      procedure :: hear
   end type follower_t

contains

   !> Work goes on, unless a signal has come.
   subroutine hear(self, ends)
      class(follower_t), intent(inout) :: self
      logical, intent(out) :: ends

      ends = interrupted()
      if (.not. ends) call self%journal%show_work()
   end subroutine hear

   !> Run a scene to its end. `refused`: the directory is a wrong choice, and nothing was written.
  subroutine run_scene(scene, source, directory, quiet, simulation, refused, was_interrupted, error)
      type(scene_t), intent(in) :: scene
      character(len=*), intent(in) :: source  !< path of the scene's file; empty: no file
      character(len=*), intent(in) :: directory
      logical, intent(in) :: quiet
      class(simulation_t), allocatable, intent(out) :: simulation  !< as it is at its end
      logical, intent(out) :: refused, was_interrupted
      type(error_t), allocatable, intent(out) :: error
      type(journal_t), target :: journal
      type(follower_t), target :: follower
      type(run_record_t) :: record
      type(timers_t) :: timers
      type(error_t), allocatable :: trouble
      logical :: is_meshed

      was_interrupted = .false.
      call allocate_simulation(scene, simulation)
      call timers%begin()
      call journal%files%open(directory, source, refused, error)
      if (allocated(error)) return

      call simulation%begin(scene, timers, error)
      is_meshed = .not. allocated(error)
      if (is_meshed .or. .not. journal%files%keeps_earlier_run) then
         call timers%start(phase_output)
         call journal%files%begin(scene, trouble)
         call timers%stop(phase_output)
         call keep_first(trouble, error)
      end if
      if (.not. allocated(error)) then
         call journal%begin(quiet, simulation)
         follower%journal => journal
         timers%listener => follower
         call march(simulation, journal, timers, error)
         call write_last_state(simulation, journal, timers, trouble)
         call keep_first(trouble, error)
      end if

      was_interrupted = .not. (allocated(error) .or. allocated(simulation%ending))
      call simulation%tell_limits()
      record%summary_t = simulation%summary
      record%scene = trim(scene%name)
      record%version = version
      if (allocated(error)) then
         record%status = status_failed
         record%reason = error%message
      else if (was_interrupted) then
         record%status = status_stopped
         record%reason = "interrupted"
      else
         record%status = status_finished
         record%reason = simulation%ending
      end if
      call journal%files%log(record%status//": "//record%reason//origin_text(error))
      call journal%files%close(record, timers, trouble)
      call keep_first(trouble, error)
      if (quiet) return
      call show_warnings(record%warnings, output_unit)
      if (is_meshed) call say_closing(simulation, record, timers%wall_seconds(), directory)
   end subroutine run_scene

   !> Write everything up to the last good state but run.json, which tells whether that went well.
   subroutine write_last_state(simulation, journal, timers, error)
      class(simulation_t), intent(inout) :: simulation
      type(journal_t), intent(inout) :: journal
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(error_t), allocatable :: trouble

      call journal%progress%clear()
      call timers%start(phase_output)
      call simulation%end_slip()
      call journal%write_chronicle(simulation)
      call journal%write_fields(simulation, error)
      call journal%files%flush(trouble)
      call keep_first(trouble, error)
      call timers%stop(phase_output)
   end subroutine write_last_state

   !> Where an error comes from, for the log.
   pure function origin_text(error) result(text)
      type(error_t), allocatable, intent(in) :: error
      character(len=:), allocatable :: text

      text = ""
      if (.not. allocated(error)) return
      if (len(error%origin) > 0) text = " (in "//error%origin//")"
   end function origin_text

   !> Say what the run was.
   subroutine say_closing(simulation, record, seconds, directory)
      class(simulation_t), intent(in) :: simulation
      type(run_record_t), intent(in) :: record
      real(rk), intent(in) :: seconds  !< wall time of the run [s]
      character(len=*), intent(in) :: directory
      type(text_t), allocatable :: lines(:)
      real(rk) :: length
      integer :: i

      length = total_length(simulation%network)
      lines = closing_lines(record, simulation%last_state(), length, &
                            length - total_length(simulation%start), seconds, directory)
      do i = 1, size(lines)
         write (output_unit, "(a)") lines(i)%text
      end do
   end subroutine say_closing

   !> From state to state until the scene is over, something fails or the user interrupts.
   subroutine march(simulation, journal, timers, error)
      class(simulation_t), intent(inout) :: simulation
      type(journal_t), intent(inout) :: journal
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      do
         if (interrupted()) return
         call simulation%next_state(timers, error)
         if (.not. allocated(error)) then
            call timers%start(phase_output)
            call journal%write_state(simulation, error)
            call timers%stop(phase_output)
            if (allocated(error)) return
            call simulation%grow(timers, error)
         end if
         if (allocated(error)) then
            if (error%is_interruption) then
               deallocate (error)
               return
            end if
            error%message = "after "//simulation%last_state()//": "//error%message
            return
         end if
         call timers%start(phase_output)
         call journal%write_chronicle(simulation)
         call timers%stop(phase_output)
         if (simulation%is_over()) return
      end do
   end subroutine march

end module app_run
