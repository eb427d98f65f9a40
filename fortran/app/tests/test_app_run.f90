!> Runs from start to end: steps that meet the wells' times, steps that are cut, runs that fail with
!! their reason and the last good state on disk.
program test_app_run
   use app_run, only: run_scene
   use base_errors, only: error_t
   use base_kinds, only: rk
   use report_simulation, only: simulation_t
   use sample_scenes, only: add_fracture, squeezed_body
   use scene_namelist, only: resolve_defaults
   use scene_types, only: injection_t, scene_t
   use testing_checks, only: checks_t
   use testing_files, only: file_exists, file_text
   implicit none(type, external)

   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(scene_t) :: scene

   call test_switches()
   call test_failure()
   call checks%finish()

contains

   !> A sticking fracture with a well that runs from 90 s to 170 s; steps of 60 s.
   function well_scene(name) result(scene)
      character(len=*), intent(in) :: name
      type(scene_t) :: scene

      scene = squeezed_body(20.0e6_rk, 20.0e6_rk)
      scene%name = name
      scene%growth%intensities = .false.
      scene%output%vtu = .false.
      scene%time%end = 240.0_rk
      call add_fracture(scene, "f", [0.8_rk, 1.2_rk], [0.9_rk, 1.1_rk], 1.0_rk, 0.0_rk)
      scene%injections = [injection_t(fracture=1, rate=[1.0e-9_rk], start=90.0_rk, end=170.0_rk)]
      call resolve_defaults(scene)
   end function well_scene

   subroutine run(scene, error)
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      class(simulation_t), allocatable :: simulation
      logical :: refused, was_interrupted

      call run_scene(scene, "", directory(scene), .true., simulation, refused, &
                     was_interrupted, error)
      call checks%is_true(.not. refused, trim(scene%name)//": it begins")
      call checks%is_true(.not. was_interrupted, trim(scene%name)//": nobody interrupts it")
   end subroutine run

   pure function directory(scene) result(path)
      type(scene_t), intent(in) :: scene
      character(len=:), allocatable :: path

      path = "test_app_run.out/"//trim(scene%name)
   end function directory

   !> The first two columns of history.csv: times and steps.
   subroutine read_times(scene, times, steps)
      type(scene_t), intent(in) :: scene
      real(rk), allocatable, intent(out) :: times(:), steps(:)
      character(len=1000) :: line
      integer :: status, unit
      real(rk) :: values(2)

      allocate (times(0), steps(0))
      open (newunit=unit, file=directory(scene)//"/history.csv", action="read", status="old", &
            iostat=status)
      call checks%is_true(status == 0, "history.csv is there")
      if (status /= 0) return
      read (unit, "(a)", iostat=status) line
      do while (status == 0)
         read (unit, "(a)", iostat=status) line
         if (status /= 0) exit
         read (line, *) values
         times = [times, values(1)]
         steps = [steps, values(2)]
      end do
      close (unit)
   end subroutine read_times

   !> Steps end where a well starts or ends, and start again from there.
   subroutine test_switches()
      real(rk), allocatable :: steps(:), times(:)
      real(rk), parameter :: expected(7) = [0.0_rk, 60.0_rk, 90.0_rk, 150.0_rk, 170.0_rk, &
                                            230.0_rk, 240.0_rk]

      scene = well_scene("switches")
      call run(scene, error)
      call checks%no_error(error, "switches")
      call read_times(scene, times, steps)
      call checks%is_true(size(times) == 7, "number of steps")
      if (size(times) /= 7) return
      call checks%is_close(maxval(abs(times - expected)), 0.0_rk, 1.0e-9_rk, "times")
      call checks%is_close(maxval(abs(steps(2:) - (expected(2:) - expected(:6)))), 0.0_rk, &
                           1.0e-9_rk, "steps")
      call checks%is_true(index(file_text(directory(scene)//"/run.json"), '"finished"') > 0, &
                          "status: finished")
   end subroutine test_switches

   !> One Newton iteration is enough while nothing changes its state. When the well would open the
   !! fracture the step is cut to a tenth, and then the run gives up.
   subroutine test_failure()
      real(rk), allocatable :: steps(:), times(:)
      character(len=:), allocatable :: events, record

      scene = well_scene("failure")
      scene%discretization%newton_max = 1
      scene%time%smallest_factor = 0.1_rk
      scene%injections(1)%rate = [1.0e-5_rk]
      call run(scene, error)
      call checks%fails_with(error, "even with a time step of", "the run fails")
      call read_times(scene, times, steps)
      call checks%is_true(size(times) == 3, "steps before the well starts")
      if (size(times) == 3) call checks%is_close(times(3), 90.0_rk, 1.0e-9_rk, "the last good time")
      record = file_text(directory(scene)//"/run.json")
      call checks%is_true(index(record, '"failed"') > 0, "status: failed")
      call checks%is_true(index(record, "did not converge") > 0, "the reason is on record")
      call checks%is_true(index(record, "after 90 s: ") > 0, "and when it was")
      call checks%is_true(file_exists(directory(scene)//"/fractures.csv"), &
                          "the last state is on disk")
      ! 60 s, cut to 30 s, 15 s, 7.5 s, and then below 6 s.
      events = file_text(directory(scene)//"/events.csv")
      call checks%is_true(occurrences(events, "step_cut") == 4, "four cuts")
   end subroutine test_failure

   !> How often a word occurs.
   pure function occurrences(text, word) result(n)
      character(len=*), intent(in) :: text, word
      integer :: at, n, step

      n = 0
      at = 1
      do
         step = index(text(at:), word)
         if (step == 0) exit
         n = n + 1
         at = at + step + len(word) - 1
      end do
   end function occurrences

end program test_app_run
