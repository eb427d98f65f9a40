!> Run a scene from start to end, whichever way it is simulated.
module app_run
   use app_journal, only: journal_t
   use app_mechanics, only: mechanics_mode_t
   use app_mode, only: mode_t
   use app_process, only: interrupted
   use app_twolevel, only: twolevel_mode_t
   use base_errors, only: error_t
   use base_timers, only: phase_output, timers_t
   use output_record, only: status_failed, status_finished, status_stopped
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: run_scene

contains

   !> Run a scene to its end. `refused` tells that it could not even begin, and nothing was written.
   subroutine run_scene(scene, directory, version, quiet, refused, was_interrupted, error)
      type(scene_t), intent(in) :: scene
      character(len=*), intent(in) :: directory, version
      logical, intent(in) :: quiet
      logical, intent(out) :: refused, was_interrupted
      type(error_t), allocatable, intent(out) :: error
      class(mode_t), allocatable :: mode
      type(journal_t) :: journal
      type(timers_t) :: timers
      type(error_t), allocatable :: trouble

      was_interrupted = .false.
      if (scene%has_fluid()) then
         allocate (twolevel_mode_t :: mode)
      else
         allocate (mechanics_mode_t :: mode)
      end if
      call timers%begin()
      call mode%begin(scene, timers, error)
      refused = allocated(error)
      if (refused) return
      call timers%start(phase_output)
      call journal%open(directory, quiet, scene, error)
      if (.not. allocated(error)) call mode%tell_start(journal)
      call timers%stop(phase_output)
      if (allocated(error)) return
      journal%record%scene = trim(scene%name)
      journal%record%version = version

      call march(mode, journal, timers, error)
      if (allocated(error)) then
         journal%record%status = status_failed
         journal%record%reason = error%message
      else if (allocated(mode%ending)) then
         journal%record%status = status_finished
         journal%record%reason = mode%ending
      else
         was_interrupted = .true.
         journal%record%status = status_stopped
         journal%record%reason = "interrupted"
      end if
      call journal%progress%clear()
      call timers%start(phase_output)
      call mode%tell_end(journal, trouble)
      call timers%stop(phase_output)
      if (allocated(trouble) .and. .not. allocated(error)) then
         journal%record%status = status_failed
         journal%record%reason = trouble%message
         call move_alloc(trouble, error)
      end if
      call journal%files%log(journal%record%status//": "//journal%record%reason)
      call journal%files%close(journal%record, timers, trouble)
      if (allocated(trouble) .and. .not. allocated(error)) call move_alloc(trouble, error)
   end subroutine run_scene

   !> From state to state until the scene is over, something fails or the user interrupts.
   subroutine march(mode, journal, timers, error)
      class(mode_t), intent(inout) :: mode
      type(journal_t), intent(inout) :: journal
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      do
         call mode%next_state(journal, timers, error)
         if (.not. allocated(error)) then
            call timers%start(phase_output)
            call mode%tell_state(journal, error)
            call timers%stop(phase_output)
            if (allocated(error)) return
            call mode%grow(journal, timers, error)
         end if
         if (allocated(error)) then
            error%message = "after "//mode%last_state()//": "//error%message
            return
         end if
         if (allocated(mode%ending)) return
         if (interrupted()) return
      end do
   end subroutine march

end module app_run
