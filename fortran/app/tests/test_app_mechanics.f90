!> Mechanics-only runs that end before their load programme: what they leave on disk.
program test_app_mechanics
   use app_run, only: run_scene
   use base_errors, only: error_t
   use base_kinds, only: rk
   use report_simulation, only: simulation_t
   use scene_namelist, only: resolve_defaults
   use scene_types, only: fracture_t, restraint_t, scene_t
   use testing_checks, only: checks_t
   use testing_files, only: file_text
   implicit none(type, external)

   type(checks_t) :: checks

   call test_broken_body()
   call checks%finish()

contains

   !> A strip under tension, held at one end, with a crack from one side to its middle.
   function strip() result(scene)
      type(scene_t) :: scene

      scene%name = "broken"
      scene%domain%x_max = 1.0_rk
      scene%domain%y_min = -1.0_rk
      scene%domain%y_max = 1.0_rk
      scene%material%young = 1.0e9_rk
      scene%material%poisson = 0.25_rk
      scene%material%toughness = 1.0e6_rk
      allocate (scene%fractures(1), scene%point_loads(0), scene%restraints(0))
      allocate (scene%injections(0), scene%probes(0))
      scene%fractures(1) = fracture_t(name="edge", law="open", x=[0.0_rk, 0.5_rk], &
                                      y=[0.0_rk, 0.0_rk])
      scene%restraints = [restraint_t(x=0.0_rk, y=-1.0_rk, displacement_given=[.true., .false.])]
      scene%sides(3)%displacement_given = [.false., .true.]
      scene%sides(4)%traction = [0.0_rk, 1.0e6_rk]
      scene%discretization%size_fracture = 0.1_rk
      scene%discretization%size_boundary = 0.3_rk
      scene%growth%enabled = .true.
      scene%growth%law = "paris"
      scene%growth%intensities = .true.
      scene%growth%increment = 0.2_rk
      scene%load%to = 10.0_rk
      scene%output%vtu = .false.
      call resolve_defaults(scene)
   end function strip

   !> Once the crack has cut the strip nothing is in equilibrium: the fields on disk are those
   !! before, and the last increment is in the table of the tips.
   subroutine test_broken_body()
      type(error_t), allocatable :: error
      class(simulation_t), allocatable :: simulation
      logical :: refused, was_interrupted
      character(len=:), allocatable :: directory
      real(rk) :: fields(7), tips(13), history(2)

      directory = "test_app_mechanics.out/broken"
      call run_scene(strip(), "", directory, .true., simulation, refused, was_interrupted, error)
      call checks%no_error(error, "the run")
      call checks%is_true(index(file_text(directory//"/run.json"), "has separated") > 0, &
                          "the reason is on record")
      history = last_row(directory//"/history.csv", 2)
      fields = last_row(directory//"/fractures.csv", 7)
      call checks%is_close(fields(1), history(1), 0.0_rk, "time of the last fields")
      call checks%is_true(fields(7) > 0.0_rk, "the crack is open there")
      tips = last_row(directory//"/tips.csv", 13)
      call checks%is_true(tips(13) > 0.0_rk, "the last increment is told")
      ! The path leaves the straight line by some 1e-3, and its length that in x by the square.
      call checks%is_close(tips(4) + tips(13), 1.0_rk, 1.0e-6_rk, "it ends at the other side")
   end subroutine test_broken_body

   !> The first numbers of a table's last row; an aperture that is left empty reads as 0.
   function last_row(path, n) result(values)
      character(len=*), intent(in) :: path
      integer, intent(in) :: n
      real(rk) :: values(n)
      character(len=1000) :: line, last
      integer :: status, unit

      values = -1.0_rk
      last = ""
      open (newunit=unit, file=path, action="read", status="old", iostat=status)
      call checks%is_true(status == 0, path//" is there")
      if (status /= 0) return
      do
         read (unit, "(a)", iostat=status) line
         if (status /= 0) exit
         last = line
      end do
      close (unit)
      read (last, *, iostat=status) values
      call checks%is_true(status == 0, path//": numbers")
   end function last_row

end program test_app_mechanics
