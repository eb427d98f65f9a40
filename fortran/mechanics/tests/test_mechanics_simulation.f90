!> The load programme: the onset of growth is found where linearity says, and never stepped over.
program test_mechanics_simulation
   use base_errors, only: error_t
   use base_kinds, only: pi, rk
   use base_timers, only: timers_t
   use mechanics_rise, only: rise
   use mechanics_simulation, only: mechanics_simulation_t
   use scene_namelist, only: resolve_defaults
   use scene_types, only: fracture_t, restraint_t, scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   real(rk), parameter :: exact = 1.0e-8_rk  !< of a factor found from linear responses
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(timers_t) :: timers

   call check_onset("open", -1.0_rk)
   call check_onset("open", 1.0_rk)
   call check_onset("frictionless", -1.0_rk)
   call check_tiny_onset()
   call check_growth()
   call check_patched_meshes()
   call check_share_done()
   call checks%finish()

contains

   !> A plate of 2 m with a crack of 0.4 m at 30 degrees, pulled or pressed in y.
   function plate(law, traction) result(scene)
      character(len=*), intent(in) :: law
      real(rk), intent(in) :: traction  !< on the top and bottom [Pa]
      type(scene_t) :: scene

      scene%domain%x_min = -1.0_rk
      scene%domain%x_max = 1.0_rk
      scene%domain%y_min = -1.0_rk
      scene%domain%y_max = 1.0_rk
      scene%material%young = 1.0e9_rk
      scene%material%poisson = 0.25_rk
      scene%material%toughness = 2.0_rk
      allocate (scene%fractures(1), scene%point_loads(0))
      scene%fractures(1) = fracture_t(name="f", law=law, x=0.2_rk*cos(0.5236_rk)*[-1, 1], &
                                      y=0.2_rk*sin(0.5236_rk)*[-1, 1])
      scene%restraints = [restraint_t(x=-1.0_rk, y=-1.0_rk, displacement_given=[.true., .true.]), &
                          restraint_t(x=1.0_rk, y=-1.0_rk, displacement_given=[.false., .true.])]
      scene%sides(3)%traction = [0.0_rk, -traction]
      scene%sides(4)%traction = [0.0_rk, traction]
      scene%discretization%size_fracture = 0.04_rk
      scene%discretization%size_boundary = 0.3_rk
      scene%growth%enabled = .true.
      scene%growth%law = "paris"
      scene%growth%intensities = .true.
      scene%load%to = 100.0_rk
      call resolve_defaults(scene)
   end function plate

   !> Where growth ends the scene, it is done as far as the end that has grown most has come.
   subroutine check_share_done()
      type(mechanics_simulation_t) :: simulation
      real(rk), parameter :: gains(2, 4) = reshape([0.0_rk, 0.0_rk, 0.3_rk, 0.0_rk, 0.3_rk, &
                                                    0.4_rk, 0.2_rk, 0.1_rk], [2, 4])  ! [m]
      real(rk) :: along(2)
      integer :: k

      call timers%begin()
      call simulation%begin(plate("open", 1.0_rk), timers, error)
      call checks%no_error(error, "share: begin")
      if (allocated(error)) return
      simulation%scene%growth%stop_gain = 0.5_rk
      along = [cos(0.5236_rk), sin(0.5236_rk)]
      do k = 1, size(gains, 2)
         simulation%network%s_start = -gains(1, k)
         simulation%network%xy(:, 1) = -(0.2_rk + gains(1, k))*along
         simulation%network%xy(:, 2) = (0.2_rk + gains(2, k))*along
         call checks%is_close(simulation%share_done(), maxval(gains(:, k))/0.5_rk, 1.0e-12_rk, &
                              "share of the gain")
      end do
   end subroutine check_share_done

   !> K_eq is proportional to the factor: its onset follows from any other factor.
   subroutine check_onset(law, traction)
      character(len=*), intent(in) :: law
      real(rk), intent(in) :: traction
      type(mechanics_simulation_t) :: simulation
      logical :: has_onset
      real(rk) :: per_factor, expected

      call timers%begin()
      call simulation%begin(plate(law, traction), timers, error)
      call checks%no_error(error, law//": begin")
      if (allocated(error)) return
      call rise(simulation, 0.1_rk, has_onset, timers, error)
      call checks%no_error(error, law//": a small load")
      if (allocated(error)) return
      call checks%is_true(.not. has_onset, law//": a small load does not make it grow")
      call checks%is_close(simulation%factor, 0.1_rk, 0.0_rk, law//": the load is reached")
      per_factor = maxval(simulation%tip%drive%intensity)/0.1_rk
      expected = simulation%scene%material%toughness/per_factor
      call rise(simulation, 0.999_rk*expected, has_onset, timers, error)
      call checks%is_true(.not. has_onset, law//": no onset below the onset")
      call rise(simulation, 10.0_rk*expected, has_onset, timers, error)
      call checks%no_error(error, law//": onset")
      call checks%is_true(has_onset, law//": the onset is found on the way")
      call checks%is_close(simulation%factor/expected, 1.0_rk, exact, law//": where it is")
   end subroutine check_onset

   !> The onset is found where it lies at a tiny share of the programme.
   subroutine check_tiny_onset()
      type(mechanics_simulation_t) :: usual, strong
      logical :: has_onset

      call timers%begin()
      call usual%begin(plate("open", 1.0_rk), timers, error)
      call rise(usual, 100.0_rk, has_onset, timers, error)
      call strong%begin(plate("open", 1.0e24_rk), timers, error)
      call checks%no_error(error, "tiny onset: begin")
      if (allocated(error)) return
      call rise(strong, 100.0_rk, has_onset, timers, error)
      call checks%no_error(error, "tiny onset")
      call checks%is_true(has_onset, "growth under a load of 1e24 Pa")
      call checks%is_close(strong%factor*1.0e24_rk/usual%factor, 1.0_rk, exact, "at its factor")
   end subroutine check_tiny_onset

   !> Both tips grow together, at a load that does not change, and the next rise starts there.
   subroutine check_growth()
      type(mechanics_simulation_t) :: simulation
      logical :: has_onset, any_grew
      real(rk) :: factor

      call timers%begin()
      call simulation%begin(plate("open", 1.0_rk), timers, error)
      call rise(simulation, 100.0_rk, has_onset, timers, error)
      factor = simulation%factor
      call simulation%grow_tips(any_grew, timers, error)
      call checks%no_error(error, "growth")
      if (allocated(error)) return
      call checks%is_true(any_grew .and. all(simulation%tip%advance > 0.039_rk), "both tips grow")
      call checks%is_close(simulation%factor, factor, 0.0_rk, "at the same load")
      call checks%is_close(norm2(sum(reshape([simulation%tip(1)%xy, simulation%tip(2)%xy], &
                                             [2, 2]), dim=2)), 0.0_rk, 1.0e-3_rk, &
                           "the wings mirror each other")
      call rise(simulation, 100.0_rk, has_onset, timers, error)
      call checks%is_true(has_onset, "in tension growth goes on")
      call checks%is_close(simulation%factor, factor, 0.0_rk, "without more load")
   end subroutine check_growth

   !> A central crack in tension grows straight on through meshes that are made around its tips
   !! only: K_I stays that of Tada's formula for a strip (1973; within 0.1 %), within its own
   !! estimated error.
   subroutine check_patched_meshes()
      type(mechanics_simulation_t) :: simulation
      real(rk), parameter :: formula = 1.0e-3_rk
      logical :: has_onset, any_grew
      real(rk) :: share, expected
      integer :: increment
      type(scene_t) :: scene

      scene = plate("open", 1.0_rk)
      scene%domain%y_min = -3.0_rk
      scene%domain%y_max = 3.0_rk
      scene%restraints = [restraint_t(x=-1.0_rk, y=-3.0_rk, displacement_given=[.true., .true.]), &
                          restraint_t(x=1.0_rk, y=-3.0_rk, displacement_given=[.false., .true.])]
      scene%fractures(1)%x = 0.3_rk*[-1, 1]
      scene%fractures(1)%y = [0.0_rk, 0.0_rk]
      call timers%begin()
      call simulation%begin(scene, timers, error)
      call checks%no_error(error, "patches: begin")
      if (allocated(error)) return
      do increment = 1, 6
         call rise(simulation, 100.0_rk, has_onset, timers, error)
         call checks%no_error(error, "patches: rise")
         if (allocated(error)) return
         associate (tip => simulation%tip(1), k1 => simulation%tip(1)%intensity%k1)
            share = abs(tip%xy(1))
            expected = simulation%factor*sqrt(pi*share)*sqrt(1.0_rk/cos(0.5_rk*pi*share)) &
                       *(1.0_rk - 0.025_rk*share**2 + 0.06_rk*share**4)
            call checks%is_close(k1/expected, 1.0_rk, &
                                 formula + abs(tip%intensity%k1_error/expected), &
                                 "patches: K_I of a strip")
         end associate
         call simulation%grow_tips(any_grew, timers, error)
         call checks%no_error(error, "patches: growth")
         if (allocated(error)) return
      end do
      call checks%is_true(simulation%body%whole_meshes == 1, "patches: one mesh of the whole body")
      call checks%is_true(simulation%body%patched_meshes >= 6, "patches: all others are patched")
   end subroutine check_patched_meshes

end program test_mechanics_simulation
