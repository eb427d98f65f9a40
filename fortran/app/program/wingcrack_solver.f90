!> wingcrack-solver: reads a scene and runs it. The launcher `wingcrack` calls it.
program wingcrack_solver
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use algebra_mumps, only: begin_ranks
   use app_geometry, only: check_geometry
   use app_interrupts, only: catch_interrupts, interrupt_status, machine_memory, prepare_memory
   use app_run, only: run_scene
   use app_simulations, only: simulates_fluids
   use app_size, only: check_size, describe_scene
   use app_stress, only: stress_description
   use app_version, only: version
   use base_errors, only: error_t
   use base_kinds, only: rk
   use report_describe, only: description
   use report_simulation, only: simulation_t
   use scene_namelist, only: read_scene
   use scene_sheet, only: sheet_t
   use scene_types, only: scene_t
   implicit none(type, external)

   integer, parameter :: exit_failed = 1, exit_usage = 2, exit_environment = 3
   character(len=*), parameter :: usage = "usage: wingcrack-solver run SCENE.nml [--out DIR] "// &
                                  "[--quiet] | run [SCENE.nml] --restart DIR [--end T] "// &
                                  "[--out DIR] [--quiet] | check SCENE.nml .. [--stress] | "// &
                                  "name SCENE.nml | ranks SCENE.nml | "// &
                                  "--describe json | --version"
   !> Kept to the program's end: gfortran 12 loses memory when it deallocates by the dynamic type.
   class(simulation_t), allocatable :: simulation

   select case (argument(1))
   case ("run")
      call run()
   case ("check")
      call check()
   case ("name")
      call print_name()
   case ("ranks")
      call check_ranks()
   case ("--describe")
      if (argument(2) /= "json") call leave("--describe json is all there is; "//usage, exit_usage)
      write (output_unit, "(a)", advance="no") description(version)
   case ("--version")
      write (output_unit, "(2a)") "wingcrack ", version
   case ("--help")
      write (output_unit, "(a)") usage
   case default
      call leave(usage, exit_usage)
   end select

contains

   subroutine run()
      type(scene_t) :: scene
      real(rk) :: n_cells(2)
      type(error_t), allocatable :: error
      character(len=:), allocatable :: directory, origin, source, text
      real(rk) :: end_time
      logical :: quiet, refused, was_interrupted
      integer :: i, status

      quiet = .false.
      directory = ""
      origin = ""
      source = argument(2)
      end_time = 0.0_rk
      i = 3
      if (index(source, "--") == 1) then
         source = ""
         i = 2
      end if
      do while (i <= command_argument_count())
         select case (argument(i))
         case ("--quiet")
            quiet = .true.
         case ("--out")
            i = i + 1
            directory = argument(i)
            if (len(directory) == 0) call leave("--out needs a directory", exit_usage)
         case ("--restart")
            i = i + 1
            origin = argument(i)
            if (len(origin) == 0) call leave("--restart needs a directory", exit_usage)
         case ("--end")
            i = i + 1
            text = argument(i)
            read (text, *, iostat=status) end_time
            if (status /= 0 .or. .not. end_time > 0.0_rk) call leave("--end needs a time in "// &
                                                     "seconds, not '"//argument(i)//"'", exit_usage)
         case default
            call leave("unknown argument "//argument(i)//"; "//usage, exit_usage)
         end select
         i = i + 1
      end do
      if (end_time > 0.0_rk .and. origin == "") then
         call leave("--end belongs to --restart; otherwise the scene has the end", exit_usage)
      end if
      call catch_interrupts()
      call prepare_memory()
      call begin_ranks()
      if (origin == "") then
         call read_judged(source, scene, n_cells)
         if (len(directory) == 0) directory = "out/"//trim(scene%name)
         call run_scene(scene, source, directory, quiet, simulation, refused, was_interrupted, &
                        error)
      else
         if (source == "") source = origin//"/scene.nml"
         call read_judged(source, scene, n_cells)
         if (end_time > 0.0_rk) scene%time%end = end_time
         if (len(directory) == 0) directory = origin
         call run_scene(scene, "", directory, quiet, simulation, refused, was_interrupted, error, &
                        origin)
      end if
      if (allocated(error)) then
         if (refused) call leave(error%message, exit_usage)
         call leave(error%message, exit_failed)
      end if
      if (was_interrupted) call leave("interrupted; the last state is in "//directory, &
                                      interrupt_status())
   end subroutine run

   !> Describe scenes that can be run; the first fault ends the program.
   subroutine check()
      type(scene_t) :: scene
      real(rk) :: n_cells(2)
      logical :: tells_stress
      integer :: i, last

      last = command_argument_count()
      tells_stress = last > 2 .and. argument(last) == "--stress"
      if (tells_stress) last = last - 1
      do i = 2, max(last, 2)
         if (i > 2 .and. index(argument(i), "--") == 1) then
            call leave("unknown argument "//argument(i)//"; "//usage, exit_usage)
         end if
         call read_judged(argument(i), scene, n_cells)
         if (tells_stress) then
            write (output_unit, "(a)") stress_description(scene, n_cells)
         else
            call describe_scene(scene, n_cells, output_unit)
         end if
      end do
   end subroutine check

   !> Read and check a scene; a fault ends the program.
   subroutine read_judged(path, scene, n_cells)
      character(len=*), intent(in) :: path
      type(scene_t), intent(out) :: scene
      real(rk), intent(out) :: n_cells(2)  !< expected cells, fracture cells
      type(sheet_t) :: sheet
      type(error_t), allocatable :: error

      call read_scene(path, scene, error, sheet)
      if (.not. (allocated(error) .or. simulates_fluids())) then
         if (scene%has_fluid()) call leave("the scene has a fluid, and this program was built "// &
                                           "without the coarse level, which that takes", &
                                           exit_environment)
      end if
      if (.not. allocated(error)) call check_size(sheet, scene, machine_memory(), error)
      if (.not. allocated(error)) call check_geometry(sheet, scene, n_cells, error)
      if (.not. allocated(error)) call check_size(sheet, scene, machine_memory(), error, n_cells)
      if (allocated(error)) call leave(error%message, exit_usage)
   end subroutine read_judged

   !> Name of the scene, the last part of the default directory.
   subroutine print_name()
      type(scene_t) :: scene
      type(error_t), allocatable :: error

      call read_scene(argument(2), scene, error)
      if (allocated(error)) call leave(error%message, exit_usage)
      write (output_unit, "(a)") trim(scene%name)
   end subroutine print_name

   !> Several ranks can share the work: they solve with the matrix of a body with a fluid.
   subroutine check_ranks()
      type(scene_t) :: scene
      type(error_t), allocatable :: error

      call read_scene(argument(2), scene, error)
      if (allocated(error)) call leave(error%message, exit_usage)
      if (.not. scene%has_fluid()) then
         call leave("ranks share the matrices of a body with a fluid, and "//argument(2)// &
                    " has none: omit --ranks", exit_usage)
      end if
   end subroutine check_ranks

   !> A command-line argument; empty if there is none.
   function argument(i) result(text)
      integer, intent(in) :: i
      character(len=:), allocatable :: text
      integer :: length

      if (i > command_argument_count()) then
         text = ""
         return
      end if
      call get_command_argument(i, length=length)
      allocate (character(len=length) :: text)
      call get_command_argument(i, text)
   end function argument

   !> End the program; the reason is the last line on stderr.
   subroutine leave(reason, status)
      character(len=*), intent(in) :: reason
      integer, intent(in) :: status

      write (error_unit, "(2a)") "wingcrack: ", reason
      stop status, quiet = .true.
   end subroutine leave

end program wingcrack_solver
