!> Run a mechanics-only scene: the load rises in steps, and from one onset of growth to the next.
module app_load
   use app_load_journal, only: load_journal_t
   use app_process, only: interrupted
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: phase_output, timers_t
   use mechanics_simulation, only: simulation_t
   use output_record, only: status_failed, status_finished, status_stopped
   use scene_types, only: scene_t
   use tips_network, only: end_gain
   implicit none(type, external)
   private

   public :: run_load

contains

   !> Run a scene to its end. `refused` tells that it could not even begin, and nothing was
   !! written.
   subroutine run_load(scene, directory, version, quiet, refused, was_interrupted, error)
      type(scene_t), intent(in) :: scene
      character(len=*), intent(in) :: directory, version
      logical, intent(in) :: quiet
      logical, intent(out) :: refused, was_interrupted
      type(error_t), allocatable, intent(out) :: error
      type(simulation_t) :: simulation
      type(load_journal_t) :: journal
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
      call note_features(journal, scene)
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
      if (.not. allocated(error)) call journal%fields_done(simulation, timers, error)
      call journal%files%log(journal%record%status//": "//journal%record%reason)
      call journal%files%close(journal%record, timers, trouble)
      if (allocated(trouble) .and. .not. allocated(error)) call move_alloc(trouble, error)
   end subroutine run_load

   !> The load programme.
   subroutine march(simulation, journal, timers, error)
      type(simulation_t), intent(inout) :: simulation
      type(load_journal_t), intent(inout) :: journal
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: target
      integer(ik) :: step
      logical :: is_done

      associate (load => simulation%scene%load)
         do step = 1, load%steps
            target = load%from + (load%to - load%from)*real(step, rk)/real(load%steps, rk)
            if (step == load%steps) target = load%to
            call follow_growth(simulation, journal, target, timers, is_done, error)
            if (allocated(error) .or. is_done .or. interrupted()) return
            call journal%fields_done(simulation, timers, error)
            if (allocated(error)) return
         end do
         journal%record%reason = "the scene's last load factor"
      end associate
   end subroutine march

   !> Raise the load to a target, growing on the way.
   subroutine follow_growth(simulation, journal, target, timers, is_done, error)
      type(simulation_t), intent(inout) :: simulation
      type(load_journal_t), intent(inout) :: journal
      real(rk), intent(in) :: target  !< load factor [-]
      type(timers_t), intent(inout) :: timers
      logical, intent(out) :: is_done
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: increment
      logical :: has_onset, any_grew

      is_done = .false.
      increment = simulation%scene%growth%increment
      if (.not. increment > 0.0_rk) increment = simulation%scene%discretization%size_fracture
      do
         call simulation%rise(target, has_onset, timers, error)
         if (.not. allocated(error)) call journal%step_done(simulation, timers, error)
         if (allocated(error)) return
         if (has_onset) then
            call simulation%grow(increment, any_grew, timers, error)
            if (simulation%is_cut) then
               call end_broken(simulation, journal, error)
               is_done = .true.
            end if
            if (allocated(error) .or. is_done) return
         else
            simulation%tip%advance = 0.0_rk
         end if
         call journal%tips_done(simulation, timers)
         if (.not. has_onset) return
         call journal%growth_done(simulation)
         call check_gain(simulation, journal, is_done)
         if (is_done .or. interrupted()) return
      end do
   end subroutine follow_growth

   !> Fractures have cut the body: no equilibrium is left, and that is how the scene ends.
   subroutine end_broken(simulation, journal, error)
      type(simulation_t), intent(in) :: simulation
      type(load_journal_t), intent(inout) :: journal
      type(error_t), allocatable, intent(inout) :: error

      call journal%growth_done(simulation)
      journal%record%reason = "a piece of the body has come loose"
      if (allocated(error)) deallocate (error)
   end subroutine end_broken

   !> Whether a fracture's end has grown as far as the scene wants.
   subroutine check_gain(simulation, journal, is_done)
      type(simulation_t), intent(in) :: simulation
      type(load_journal_t), intent(inout) :: journal
      logical, intent(out) :: is_done
      integer(ik) :: i

      is_done = .false.
      do i = 1, size(simulation%tip)
         associate (tip => simulation%tip(i))
            if (end_gain(simulation%network, simulation%start, tip%fracture, tip%end) &
                < simulation%scene%growth%stop_gain) cycle
            is_done = .true.
            journal%record%reason = "fracture "// &
                                    trim(simulation%scene%fractures(tip%fracture)%name)// &
                                    " has gained stop_gain"
         end associate
      end do
   end subroutine check_gain

   !> What the scene uses and what it does without.
   subroutine note_features(journal, scene)
      type(load_journal_t), intent(inout) :: journal
      type(scene_t), intent(in) :: scene

      call journal%record%use_feature("elastic rock, finite elements on the whole body")
      call journal%record%leave_out_feature("pressure, flow and the coarse level: no fluid")
      call note(size(scene%fractures) > 0, "fractures", "no fractures")
      call note(scene%growth%intensities, "stress intensity factors", "intensities off")
      call note(scene%growth%enabled, "growth", "remeshing: growth off")
      call note(scene%adaptive%enabled, "meshes that follow the error", &
                "error estimates: not asked for")
      call note(scene%output%vtu, "VTU files", "VTU files: not asked for")

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

end module app_load
