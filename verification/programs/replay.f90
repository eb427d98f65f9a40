!> Runs that take their decisions from the record of another one (verification/replay), with another
!! number in their scene: differences of their results over the change.
!!
!! Argument: `onset` for scene C1 with another friction and permeability, against differences of
!! free runs, which take the same steps there; `wings` for scene C2 with another toughness, against
!! the slope of K_eq in a run with short steps and without growth.
!!
!! Writes gradients.csv, a row for each change, and summary.csv.
program replay
   use, intrinsic :: iso_fortran_env, only: int8
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use scene_namelist, only: read_scene
   use scene_types, only: scene_t
   use twolevel_state, only: two_levels_t
   use verification_files, only: finish, stop_on, table_t, text_argument
   implicit none(type, external)

   !> States of a run.
   type :: states_t
      real(rk), allocatable :: time(:), pressure(:)  !< [s], [Pa]
      real(rk), allocatable :: gain(:)  !< growth of all tips [m]
      real(rk), allocatable :: k2(:), keq(:)  !< of the first tip, and the largest [Pa m^1/2]
      integer(int8), allocatable :: record(:)
      logical :: has_left = .false.  !< the run has left the record
   end type states_t

   character(len=*), parameter :: file = "scene.nml"
   character(len=*), parameter :: body = &
      & "&scene name='c' / &domain x_min=0.0, x_max=2.0, y_min=0.0, y_max=2.0 /"//new_line("a")// &
      & "&material young=40.0e9, poisson=0.2, biot=0.8, porosity=0.01, permeability=5.0e-20, "// &
      & "toughness=0.7e6 /"//new_line("a")// &
      & "&fluid compressibility=4.0e-10, viscosity=1.0e-4 /"//new_line("a")// &
      & "&fracture name='f1', x=0.9646446609406726, 1.0353553390593274, "// &
      & "y=0.9646446609406726, 1.0353553390593274, friction=0.5, dilation_deg=1.0, "// &
      & "aperture=1.0e-3 /"//new_line("a")// &
      & "&side name='left', x_displacement=0.0 / &side name='bottom', y_displacement=0.0 /"// &
      & new_line("a")//"&side name='right', x_traction=-20.0e6 / "// &
      & "&side name='top', y_traction=-10.0e6 /"//new_line("a")// &
      & "&injection fracture='f1', rate=5.0e-9 / &initial fracture_pressure='equilibrated' /"// &
      & new_line("a")//"&coarse size_fracture=0.01, size_boundary=0.1 /"//new_line("a")// &
      & "&fine window=0.5, size_ratio=0.5 /"
   real(rk), parameter :: changes(*) = [1.0e-6_rk, 1.0e-4_rk, 1.0e-3_rk]
   type(error_t), allocatable :: error

   if (text_argument(1) == "onset") then
      call onset()
   else
      call wings()
   end if
   call finish()

contains

   !> C1 at 21 h: gradients with friction and permeability.
   subroutine onset()
      type(states_t) :: base, plus, minus, follower
      type(scene_t) :: scene, changed
      type(table_t) :: table
      real(rk) :: free(2), taken(2)
      integer :: number

      call write_scene("&time end=75600.0, step=1800.0 / &growth intensities=.true. /")
      call read (scene)
      call run(scene, base)
      call run(scene, follower, base)
      call table%open("summary.csv", "of_itself,k2_gradient,k2_difference,"// &
                      "pressure_gradient,pressure_difference")
      do number = 1, 2
         call change(scene, number, 1.0e-3_rk, changed)
         call run(changed, plus)
         call change(scene, number, -1.0e-3_rk, changed)
         call run(changed, minus)
         free = (last(plus) - last(minus))/2.0e-3_rk
         call change(scene, number, 1.0e-4_rk, changed)
         call run(changed, plus, base)
         call change(scene, number, -1.0e-4_rk, changed)
         call run(changed, minus, base)
         taken = (last(plus) - last(minus))/2.0e-4_rk
         call table%row([difference(base, follower), taken(1), taken(1)/free(1) - 1.0_rk, &
                         taken(2), taken(2)/free(2) - 1.0_rk])
      end do
      call table%close()
   end subroutine onset

   !> C2: d ln t/d ln K_IC at onset and gains.
   subroutine wings()
      type(states_t) :: base, fine, follower, of(size(changes))
      type(scene_t) :: scene, changed
      type(table_t) :: table
      real(rk), allocatable :: gradient(:, :)
      real(rk) :: slope
      integer :: i, k, n, onset_state

      call write_scene("&time end=360000.0 / &growth enabled=.true., new_aperture=1.0e-5, "// &
                       "new_volume='conserved', stop_gain=0.01 /")
      call read (scene)
      call run(scene, base)
      call run(scene, follower, base)
      n = size(base%time)
      onset_state = findloc(base%gain > 0.0_rk, .true., dim=1) - 1
      allocate (gradient(n, size(changes)))
      do i = 1, size(changes)
         call change(scene, 3, changes(i), changed)
         call run(changed, of(i), base)
         k = min(n, size(of(i)%time))
         gradient(:, i) = 0.0_rk
         gradient(:k, i) = (of(i)%time(:k) - base%time(:k))/changes(i)
      end do

      call write_scene("&time end=200.0, tolerance=2.0e-4 / &growth enabled=.true., "// &
                       "new_aperture=1.0e-5, new_volume='conserved' /")
      call read (changed)
      changed%material%toughness = 2.0_rk*scene%material%toughness
      call run(changed, fine)
      k = findloc(fine%keq > scene%material%toughness, .true., dim=1)
      slope = log(fine%time(k)/fine%time(k - 1))/log(fine%keq(k)/fine%keq(k - 1))

      call table%open("gradients.csv", "time_s,gain_m,dlnt_1e6,dlnt_1e4,dlnt_1e3")
      do k = onset_state, n
         call table%row([base%time(k), base%gain(k), gradient(k, :)/base%time(k)])
      end do
      call table%close()
      call table%open("summary.csv", "of_itself,onset,onset_of_slope,worst_1e4,worst_1e3,left")
      associate (g => gradient(onset_state:, :))
         call table%row([difference(base, follower), gradient(onset_state, 1)/ &
                         base%time(onset_state), slope, maxval(abs(g(:, 2)/g(:, 1) - 1.0_rk)), &
                         maxval(abs(g(:, 3)/g(:, 1) - 1.0_rk)), &
                         real(count(of%has_left), rk)])
      end associate
      call table%close()
   end subroutine wings

   !> K_II of the first tip and well pressure at the end.
   pure function last(states)
      type(states_t), intent(in) :: states
      real(rk) :: last(2)

      last = [states%k2(size(states%k2)), states%pressure(size(states%pressure))]
   end function last

   !> Largest difference of two runs, in any number; 0: they are equal.
   pure real(rk) function difference(a, b)
      type(states_t), intent(in) :: a, b

      difference = huge(1.0_rk)
      if (size(a%time) /= size(b%time)) return
      difference = maxval(abs([a%time - b%time, a%pressure - b%pressure, a%gain - b%gain, &
                               a%k2 - b%k2, a%keq - b%keq]))
   end function difference

   !> A scene with friction (1), permeability (2) or toughness (3) times 1 + change.
   subroutine change(scene, number, by, changed)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: number
      real(rk), intent(in) :: by
      type(scene_t), intent(out) :: changed

      changed = scene
      select case (number)
      case (1)
         changed%fractures(1)%friction = (1.0_rk + by)*scene%fractures(1)%friction
      case (2)
         associate (rock => changed%material)
            rock%permeability_xx = (1.0_rk + by)*rock%permeability_xx
            rock%permeability_yy = (1.0_rk + by)*rock%permeability_yy
         end associate
      case default
         changed%material%toughness = (1.0_rk + by)*scene%material%toughness
      end select
   end subroutine change

   subroutine write_scene(rest)
      character(len=*), intent(in) :: rest
      integer :: unit

      open (newunit=unit, file=file, status="replace", action="write")
      write (unit, "(a)") body, rest
      close (unit)
   end subroutine write_scene

   subroutine read (scene)
      type(scene_t), intent(out) :: scene

      call read_scene(file, scene, error)
      call stop_on(error)
   end subroutine read

   !> Run a scene to its end, freely or by a record.
   subroutine run(scene, states, by)
      type(scene_t), intent(in) :: scene
      type(states_t), intent(out) :: states
      type(states_t), intent(in), optional :: by  !< the run whose decisions are taken
      type(two_levels_t), allocatable :: simulation
      type(timers_t) :: timers
      integer(ik) :: i

      allocate (simulation)
      allocate (states%time(0), states%pressure(0), states%gain(0), states%k2(0), states%keq(0), &
                states%record(0))
      call timers%begin()
      if (present(by)) call simulation%tape%follow(by%record)
      call simulation%begin(scene, timers, error)
      call stop_on(error)
      do while (.not. simulation%is_over())
         call simulation%next_state(timers, error)
         call stop_on(error)
         call simulation%grow(timers, error)
         call stop_on(error)
         states%record = [states%record, simulation%tape%bytes()]
         states%time = [states%time, simulation%time()]
         states%pressure = [states%pressure, &
                            simulation%problem%well_pressure(simulation%now%coarse)]
         states%gain = [states%gain, sum([(simulation%now%segment(i)%gain, &
                                           i=1, size(simulation%tip, kind=ik))])]
         states%k2 = [states%k2, simulation%tip(1)%intensity%k2]
         states%keq = [states%keq, maxval(simulation%tip%drive%intensity)]
         call simulation%chronicle%clear()
      end do
      states%has_left = present(by) .and. .not. simulation%tape%follows
   end subroutine run

end program replay
