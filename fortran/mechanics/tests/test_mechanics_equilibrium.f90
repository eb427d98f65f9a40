!> Growth as equilibrium: the load factor follows the closed form down as a crack grows, and does
!! not depend on where its search begins.
program test_mechanics_equilibrium
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_timers, only: timers_t
   use mechanics_balance, only: balance_load, share_misfit, tolerance
   use mechanics_simulation, only: mechanics_simulation_t
   use scene_namelist, only: resolve_defaults
   use scene_types, only: fracture_t, restraint_t, scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(timers_t) :: timers

   call check_strip("length")
   call check_strip("dead")
   call check_balance()
   call check_shared_misfit(0.065_rk, 1.0_rk, is_shared=.true.)
   call check_shared_misfit(0.065_rk, -1.0_rk, is_shared=.true.)
   call check_shared_misfit(0.2_rk, 1.0_rk, is_shared=.false.)
   call checks%finish()

contains

   !> A strip of width 2 m and height 6 m with a central crack of 0.6 m, pulled in y.
   function strip(control) result(scene)
      character(len=*), intent(in) :: control
      type(scene_t) :: scene

      scene%domain%x_min = -1.0_rk
      scene%domain%x_max = 1.0_rk
      scene%domain%y_min = -3.0_rk
      scene%domain%y_max = 3.0_rk
      scene%material%young = 1.0e9_rk
      scene%material%poisson = 0.25_rk
      scene%material%toughness = 2.0_rk
      allocate (scene%fractures(1), scene%point_loads(0))
      scene%fractures(1) = fracture_t(name="f", law="open", x=0.3_rk*[-1, 1], y=[0.0_rk, 0.0_rk])
      scene%restraints = [restraint_t(x=-1.0_rk, y=-3.0_rk, displacement_given=[.true., .true.]), &
                          restraint_t(x=1.0_rk, y=-3.0_rk, displacement_given=[.false., .true.])]
      scene%sides(3)%traction = [0.0_rk, -1.0_rk]
      scene%sides(4)%traction = [0.0_rk, 1.0_rk]
      scene%discretization%size_fracture = 0.04_rk
      scene%discretization%size_boundary = 0.3_rk
      scene%growth%enabled = .true.
      scene%growth%intensities = .true.
      scene%load%to = 100.0_rk
      scene%load%control = control
      call resolve_defaults(scene)
   end function strip

   !> K_I of the strip for a stress of 1 (Tada 1973, within 0.1 %).
   pure real(rk) function tada(a)
      real(rk), intent(in) :: a  !< half the length over half the width

      tada = sqrt(pi*a)*sqrt(1.0_rk/cos(0.5_rk*pi*a))*(1.0_rk - 0.025_rk*a**2 + 0.06_rk*a**4)
   end function tada

   !> Both tips advance by equal increments, at K_IC, while the factor falls as 1/K_I; or it stays,
   !! and K_eq rises instead.
   subroutine check_strip(control)
      character(len=*), intent(in) :: control
      type(mechanics_simulation_t) :: simulation
      real(rk), parameter :: formula = 3.0e-3_rk
      real(rk) :: a, first
      integer :: increment

      call timers%begin()
      call simulation%begin(strip(control), timers, error)
      call checks%no_error(error, control//": begin")
      if (allocated(error)) return
      first = 0.0_rk
      do increment = 0, 5
         call simulation%next_state(timers, error)
         call checks%no_error(error, control//": state")
         if (allocated(error)) return
         if (increment == 0) first = simulation%time()
         a = 0.3_rk + 0.04_rk*increment
         associate (tips => simulation%tip)
            call checks%is_close(abs(tips(1)%xy(1)), a, 1.0e-6_rk, control//": increments")
            call checks%is_close(tips(1)%xy(1) + tips(2)%xy(1), 0.0_rk, 1.0e-6_rk, &
                                 control//": both tips alike")
            if (control == "length") then
               call checks%is_close(simulation%time()*tada(a)/2.0_rk, 1.0_rk, formula, &
                                    "snap-back as the closed form has it")
               call checks%is_close(maxval(tips%drive%intensity), 2.0_rk, 1.0e-8_rk, "at K_IC")
            else
               call checks%is_close(simulation%time(), first, 0.0_rk, "a dead load stays")
               call checks%is_close(maxval(tips%drive%intensity)/(first*tada(a)), 1.0_rk, formula, &
                                    "and K rises")
            end if
         end associate
         call simulation%grow(timers, error)
         call checks%no_error(error, control//": growth")
         if (allocated(error)) return
      end do
   end subroutine check_strip

   !> From below and from above the same factor; none below the limit is said to be none.
   subroutine check_balance()
      type(mechanics_simulation_t) :: simulation
      real(rk), parameter :: starts(3) = [0.01_rk, 1.0_rk, 50.0_rk]
      real(rk) :: slope(2)
      logical :: holds, is_loose
      integer :: i

      call timers%begin()
      call simulation%begin(strip("length"), timers, error)
      call checks%no_error(error, "balance: begin")
      if (allocated(error)) return
      do i = 1, size(starts)
         call simulation%respond(starts(i), timers, error)
         call balance_load(simulation, starts(i), 100.0_rk, timers, holds, is_loose, slope, error)
         call checks%no_error(error, "balance")
         if (allocated(error)) return
         call checks%is_true(holds .and. .not. is_loose, "a factor holds the tips")
         call checks%is_close(simulation%largest_excess(), 0.0_rk, 1.0e-8_rk, "at K_IC")
         call checks%is_close(slope(1)*simulation%factor/2.0_rk, 1.0_rk, 1.0e-3_rk, "dK/df")
      end do
      call simulation%respond(0.01_rk, timers, error)
      call balance_load(simulation, 0.01_rk, 0.5_rk, timers, holds, is_loose, slope, error)
      call checks%is_true(.not. holds, "below the onset nothing is at its toughness")
      call checks%is_close(simulation%factor, 0.5_rk, 0.0_rk, "at the limit")
   end subroutine check_balance

   !> A crack off the middle of the strip: K of the tip that is nearer to a side is larger, and both
   !! are proportional to the load. With the larger one at K_IC the other lacks a share d. Where d
   !! is above the tolerance but below twice that, the load goes on, whichever way its programme
   !! goes, until 0.9 of the tolerance lack, unless the programme ends before; where it is above, no
   !! load helps.
   subroutine check_shared_misfit(off, way, is_shared)
      real(rk), intent(in) :: off  !< the middle [m]
      real(rk), intent(in) :: way  !< of the programme; the sides push where it is negative
      logical, intent(in) :: is_shared
      type(mechanics_simulation_t) :: simulation
      type(scene_t) :: scene
      real(rk) :: lack, slope(2)
      logical :: holds, is_loose

      scene = strip("length")
      scene%fractures(1)%x = scene%fractures(1)%x + off
      scene%sides(3)%traction = way*scene%sides(3)%traction
      scene%sides(4)%traction = way*scene%sides(4)%traction
      scene%load%to = way*scene%load%to
      call timers%begin()
      call simulation%begin(scene, timers, error)
      call checks%no_error(error, "off the middle: begin")
      if (allocated(error)) return
      call simulation%respond(way, timers, error)
      call balance_load(simulation, way, 100.0_rk*way, timers, holds, is_loose, slope, error)
      call checks%no_error(error, "off the middle: balance")
      if (allocated(error)) return
      lack = 1.0_rk - minval(simulation%tip%drive%intensity)/2.0_rk
      call checks%is_true(lack > tolerance .and. (lack < 1.8_rk*tolerance .eqv. is_shared), &
                          "the tips differ as the test wants it")
      associate (factor => simulation%factor)
         call share_misfit(simulation, [1_ik, 2_ik], factor, slope, timers, error)
         call checks%is_close(simulation%largest_excess(), 0.0_rk, 1.0e-8_rk, "not beyond its end")
      end associate
      call share_misfit(simulation, [1_ik, 2_ik], 100.0_rk*way, slope, timers, error)
      call checks%no_error(error, "shared misfit")
      if (allocated(error)) return
      associate (least => minval(simulation%tip%drive%intensity)/2.0_rk, &
                 excess => simulation%largest_excess())
         if (is_shared) then
            call checks%is_close(least, 1.0_rk - 0.9_rk*tolerance, 1.0e-6_rk, "what is lacking")
            call checks%is_close((1.0_rk + excess)/least, 1.0_rk/(1.0_rk - lack), 1.0e-9_rk, &
                                 "in proportion")
         else
            call checks%is_close(excess, 0.0_rk, 1.0e-8_rk, "the load stays")
         end if
      end associate
   end subroutine check_shared_misfit

end program test_mechanics_equilibrium
