!> Loads that fall: slip and its reversal at a closed crack with friction, onsets on the way down.
program test_mechanics_unloading
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_timers, only: timers_t
   use mechanics_rise, only: rise
   use mechanics_simulation, only: mechanics_simulation_t
   use scene_namelist, only: resolve_defaults
   use scene_types, only: fracture_t, restraint_t, scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   real(rk), parameter :: half_length = 0.2_rk  !< of the crack [m]
   real(rk), parameter :: half_width = 2.0_rk  !< of the body [m]
   real(rk), parameter :: young = 1.0e9_rk, poisson = 0.25_rk
   real(rk), parameter :: shear = 1.0e6_rk, pressure = 1.0e6_rk, friction = 0.3_rk
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(timers_t) :: timers
   type(scene_t) :: scene

   call check_reversal()
   call check_onset_down()
   call check_onset_against_stress()
   call checks%finish()

contains

   !> A square with a crack along x in its middle.
   function square(law) result(scene)
      character(len=*), intent(in) :: law
      type(scene_t) :: scene

      scene%domain%x_min = -half_width
      scene%domain%x_max = half_width
      scene%domain%y_min = -half_width
      scene%domain%y_max = half_width
      scene%material%young = young
      scene%material%poisson = poisson
      allocate (scene%fractures(1), scene%point_loads(0))
      scene%fractures(1) = fracture_t(name="f", law=law, x=half_length*[-1, 1], &
                                      y=[0.0_rk, 0.0_rk])
      scene%restraints = [restraint_t(x=-half_width, y=-half_width, &
                                      displacement_given=[.true., .true.]), &
                          restraint_t(x=half_width, y=-half_width, &
                                      displacement_given=[.false., .true.])]
      scene%discretization%size_fracture = 0.025_rk
      scene%discretization%size_boundary = 0.5_rk
      scene%growth%intensities = .true.
   end function square

   !> A crack under a constant pressure p and a shear f tau slips as an open one does under the
   !! excess tau - mu p: d = 4 (tau - mu p)/E' sqrt(a**2 - x**2) (Westergaard). While the load
   !! falls, its faces hold what they have slipped until the shear on them has turned round, by
   !! twice the friction; then they slip back as an open crack does under what the load has fallen
   !! beyond that.
   subroutine check_reversal()
      real(rk), parameter :: excess = shear - friction*pressure
      real(rk), parameter :: finite_body = 0.02_rk  ! the crack has a tenth of its width
      real(rk), parameter :: locked = 1.0e-6_rk  ! K_II counts the tractions, which change
      real(rk), parameter :: discrete = 1.0e-3_rk  ! the mesh, unlike the crack, has no symmetry
      type(mechanics_simulation_t) :: simulation
      real(rk), allocatable :: forward(:, :)
      real(rk) :: k2
      logical :: has_onset

      scene = square("friction")
      scene%fractures(1)%friction = friction
      scene%in_situ%stress = [-pressure, -pressure, 0.0_rk]
      scene%sides(1)%traction = [0.0_rk, -shear]
      scene%sides(2)%traction = [0.0_rk, shear]
      scene%sides(3)%traction = [-shear, 0.0_rk]
      scene%sides(4)%traction = [shear, 0.0_rk]
      scene%load%from = 1.0_rk
      scene%load%to = -1.0_rk
      call resolve_defaults(scene)
      call timers%begin()
      call simulation%begin(scene, timers, error)
      call checks%no_error(error, "reversal: begin")
      if (allocated(error)) return
      call rise(simulation, 1.0_rk, has_onset, timers, error)
      call checks%no_error(error, "reversal: loaded")
      if (allocated(error)) return
      forward = slip(simulation)
      k2 = simulation%tip(1)%intensity%k2
      call checks%is_close(maxval(abs(forward))*young/(1.0_rk - poisson**2) &
                           /(4.0_rk*excess*half_length), 1.0_rk, finite_body, "slip of the crack")
      call checks%is_close(abs(k2)/(excess*sqrt(pi*half_length)), 1.0_rk, finite_body, "its K_II")
      ! Twice the friction is 0.6 of the load.
      call go_on(simulation, forward, k2, 0.41_rk, 1.0_rk, locked, "the slip is locked in")
      call go_on(simulation, forward, k2, -0.2_rk, 1.0_rk - 0.6_rk/0.7_rk, discrete, "it goes back")
      call go_on(simulation, forward, k2, -1.0_rk, -1.0_rk, discrete, "all is reversed")
      call go_on(simulation, forward, k2, -0.41_rk, -1.0_rk, discrete, "locked in again")
      call go_on(simulation, forward, k2, 1.0_rk, 1.0_rk, discrete, "the loop is closed")

   end subroutine check_reversal

   !> Go on to a factor: slip and K_II are a share of those of the first loading.
   subroutine go_on(simulation, forward, k2, factor, share, tolerance, name)
      type(mechanics_simulation_t), intent(inout) :: simulation
      real(rk), intent(in) :: forward(:, :)  !< slip of the first loading [m]
      real(rk), intent(in) :: k2  !< of it [Pa sqrt(m)]
      real(rk), intent(in) :: factor, share, tolerance  !< [-]
      character(len=*), intent(in) :: name
      type(timers_t) :: timers
      type(error_t), allocatable :: error
      logical :: has_onset

      call timers%begin()
      call rise(simulation, factor, has_onset, timers, error)
      call checks%no_error(error, name)
      if (allocated(error)) return
      call checks%is_close(maxval(abs(slip(simulation) - share*forward))/maxval(abs(forward)), &
                           0.0_rk, tolerance, name)
      call checks%is_close(simulation%tip(1)%intensity%k2/k2, share, tolerance, name//": K_II")
   end subroutine go_on

   !> Slip of all nodes of the faces [m].
   pure function slip(simulation)
      type(mechanics_simulation_t), intent(in) :: simulation
      real(rk), allocatable :: slip(:, :)

      slip = simulation%body%contact%jump(1, :, :)
   end function slip

   !> Pressed by a load that goes from zero to below, an open crack grows where one that is pulled
   !! by a rising load does.
   subroutine check_onset_down()
      real(rk) :: onset(2)
      integer(ik) :: i

      do i = 1, 2
         scene = growing(sign(1.0_rk, 1.5_rk - real(i, rk)))
         scene%load%to = sign(1.0e9_rk, 1.5_rk - real(i, rk))
         onset(i) = onset_of(scene, "upwards and downwards")
      end do
      call checks%is_close(-onset(2)/onset(1), 1.0_rk, 1.0e-8_rk, "onset below zero")
   end subroutine check_onset_down

   !> A body under tension, of which a load takes as much away as it is large: as the load falls,
   !! the crack grows where the two leave what is enough without the stress in situ.
   subroutine check_onset_against_stress()
      real(rk) :: enough, onset, tension

      scene = growing(1.0_rk)
      scene%load%to = 1.0e9_rk
      enough = onset_of(scene, "without a stress in situ")
      tension = 3.0_rk*enough
      scene = growing(-1.0_rk)
      scene%in_situ%stress = [0.0_rk, tension, 0.0_rk]
      scene%load%from = tension
      scene%load%to = 0.0_rk
      onset = onset_of(scene, "against a stress in situ")
      call checks%is_close(onset/(tension - enough), 1.0_rk, 1.0e-6_rk, "onset of a falling load")
   end subroutine check_onset_against_stress

   !> The square with an open crack that grows, pulled in y.
   function growing(traction) result(scene)
      real(rk), intent(in) :: traction  !< at factor 1 [Pa]
      type(scene_t) :: scene

      scene = square("open")
      scene%material%toughness = 1.0e3_rk
      scene%growth%enabled = .true.
      scene%growth%law = "paris"
      scene%sides(3)%traction = [0.0_rk, -traction]
      scene%sides(4)%traction = [0.0_rk, traction]
   end function growing

   !> The load factor at which the first tip grows.
   real(rk) function onset_of(scene, name) result(onset)
      type(scene_t), intent(in) :: scene
      character(len=*), intent(in) :: name
      type(scene_t) :: whole
      type(mechanics_simulation_t) :: simulation
      logical :: has_onset

      onset = 0.0_rk
      whole = scene
      call resolve_defaults(whole)
      call timers%begin()
      call simulation%begin(whole, timers, error)
      call checks%no_error(error, name//": begin")
      if (allocated(error)) return
      call rise(simulation, scene%load%to, has_onset, timers, error)
      call checks%no_error(error, name)
      call checks%is_true(has_onset, name//": there is an onset")
      onset = simulation%factor
   end function onset_of

end program test_mechanics_unloading
