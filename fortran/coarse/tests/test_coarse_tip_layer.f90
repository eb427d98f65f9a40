!> Opening and pressure behind a tip that a viscous fluid follows, against their exact limits: a
!! toughness K without viscosity, w = (K'/E') sqrt(d) and dp/dd = mu' V/w^2 with p as ln d; and
!! viscosity without toughness, w = B d^(2/3), for which elasticity on a half-infinite crack gives p
!! = E'/4 (2/3) cot(2 pi/3) B d^(-1/3) and lubrication dp/dd = mu' V/w^2.
program test_coarse_tip_layer
   use base_kinds, only: pi, rk
   use coarse_tip_layer, only: apparent_toughness, leaking_parameter, mean_pressure_shape, &
                               opening_shape, pressure_shape, viscous_parameter, volume_shape
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: d(*) = [1.0e-6_rk, 1.0e-3_rk, 0.04_rk, 0.5_rk, 3.0_rk]  !< [m]
   real(rk), parameter :: b(*) = [1.0e-9_rk, 1.0e-3_rk, 0.3_rk, 0.8_rk, 40.0_rk, 3.0e4_rk, &
                                  1.0e20_rk]  !< [1/m^(1/2)]
   type(checks_t) :: checks

   call test_toughness()
   call test_viscosity()
   call test_leakoff()
   call test_lubrication()
   call test_integrals()
   call checks%finish()

contains

   !> Without viscosity.
   subroutine test_toughness()
      real(rk), parameter :: none = 1.0e-10_rk
      integer :: i

      call checks%is_close(viscous_parameter(1.0e-3_rk, -1.0_rk, 3.0e10_rk, 1.0e6_rk), 0.0_rk, &
                           0.0_rk, "a tip that goes back")
      do i = 1, size(d)
         call checks%is_close(opening_shape(0.0_rk, d(i)), sqrt(d(i)), 1.0e-15_rk*sqrt(d(i)), &
                              "opening, toughness")
         call checks%is_close(volume_shape(0.0_rk, d(i)), d(i)**1.5_rk/1.5_rk, &
                              1.0e-14_rk*d(i)**1.5_rk, "volume, toughness")
         call checks%is_close(apparent_toughness(0.0_rk, d(i)), 1.0_rk, 0.0_rk, "toughness")
         call checks%is_close(pressure_shape(none, 2.0_rk*d(i)) - pressure_shape(none, d(i)), &
                              log(2.0_rk), 1.0e-9_rk, "pressure, toughness")
         ! With the weight 1/sqrt(d), ln d has the mean ln d - 2 between 0 and d.
         call checks%is_close(mean_pressure_shape(none, [0.0_rk, d(i)]), &
                              pressure_shape(none, d(i)) - 2.0_rk, 1.0e-9_rk, "mean, toughness")
      end do
   end subroutine test_toughness

   !> Hardly any toughness: in SI units, with mu' V and E' of a gel in rock.
   subroutine test_viscosity()
      real(rk), parameter :: modulus = 3.2e10_rk, speed = 0.02_rk, toughness = 1.0e-3_rk, &
                             viscosity = 0.4_rk
      real(rk), parameter :: stress = 12.0_rk*viscosity*speed  ! mu' V [Pa m]
      real(rk) :: layer, opening, pressure, scale
      integer :: i

      scale = sqrt(32.0_rk/pi)*toughness/modulus
      layer = viscous_parameter(viscosity, speed, modulus, toughness)
      do i = 1, size(d)
         opening = scale*opening_shape(layer, d(i))
         call checks%is_close(opening/(2.0_rk**(1.0_rk/3.0_rk)*3.0_rk**(5.0_rk/6.0_rk) &
                                       *(stress/modulus)**(1.0_rk/3.0_rk) &
                                       *d(i)**(2.0_rk/3.0_rk)), 1.0_rk, 1.0e-9_rk, "opening")
         pressure = stress/scale**2*pressure_shape(layer, d(i))
         call checks%is_close(pressure/(modulus/6.0_rk/tan(2.0_rk*pi/3.0_rk)*opening/d(i)), &
                              1.0_rk, 1.0e-9_rk, "pressure, elasticity")
         call checks%is_close(scale*volume_shape(layer, d(i))/(0.6_rk*opening*d(i)), 1.0_rk, &
                              1.0e-9_rk, "volume")
         call checks%is_close(apparent_toughness(layer, d(i))*scale*sqrt(d(i))/opening, 1.0_rk, &
                              1.0e-14_rk, "apparent toughness")
      end do
   end subroutine test_viscosity

   !> All fluid leaks off: w = B d^(5/8), for which elasticity gives p = E'/4 (5/8) cot(5 pi/8) B
   !! d^(-3/8), and lubrication dp/dd = mu' 2 C' sqrt(V d)/w^3; and none leaks off.
   subroutine test_leakoff()
      real(rk), parameter :: coefficient = 1.0e9_rk, modulus = 3.2e10_rk, speed = 0.02_rk, &
                             toughness = 1.0e-3_rk, viscosity = 0.4_rk
      real(rk) :: opening, slope, without
      integer :: i

      without = viscous_parameter(viscosity, speed, modulus, toughness)
      do i = 1, size(d)
         opening = sqrt(32.0_rk/pi)*toughness/modulus &
                   *opening_shape(leaking_parameter(without, coefficient, speed, modulus, &
                                                    toughness, d(i)), d(i))
         slope = modulus/4.0_rk*(5.0_rk/8.0_rk)/tan(5.0_rk*pi/8.0_rk)*(-3.0_rk/8.0_rk)*opening &
                 /d(i)**2
         call checks%is_close(slope/(12.0_rk*viscosity*2.0_rk*coefficient*sqrt(speed*d(i)) &
                                     /opening**3), 1.0_rk, 1.0e-6_rk, "all leaks off")
         call checks%is_close(leaking_parameter(b(i), 0.0_rk, speed, modulus, toughness, d(i)), &
                              b(i), 0.0_rk, "none leaks off")
         call checks%is_close(leaking_parameter(b(i), 1.0e-12_rk, speed, modulus, 1.0e6_rk, d(i)) &
                              /b(i), 1.0_rk, 1.0e-5_rk, "hardly any")
      end do
   end subroutine test_leakoff

   !> dp/dd = mu' V/w^2 in between: the slope of the pressure by central differences.
   subroutine test_lubrication()
      real(rk), parameter :: small = 1.0e-4_rk
      real(rk) :: slope
      integer :: i, k

      do k = 1, size(b)
         do i = 1, size(d)
            slope = (pressure_shape(b(k), d(i)*(1.0_rk + small)) &
                     - pressure_shape(b(k), d(i)*(1.0_rk - small)))/(2.0_rk*small*d(i))
            call checks%is_close(slope*opening_shape(b(k), d(i))**2, 1.0_rk, 1.0e-7_rk, "slope")
         end do
      end do
   end subroutine test_lubrication

   !> Volume and mean pressure against the midpoint rule in the root of the distance.
   subroutine test_integrals()
      integer, parameter :: points = 20000
      real(rk) :: ends(2), mean, u(2), volume, x
      integer :: i, k, m

      do k = 1, size(b)
         do i = 2, size(d)
            ends = [d(i - 1), d(i)]
            u = sqrt(ends)
            mean = 0.0_rk
            volume = 0.0_rk
            do m = 1, points
               x = u(1) + (u(2) - u(1))*(m - 0.5_rk)/points
               mean = mean + pressure_shape(b(k), x**2)/points
               volume = volume + 2.0_rk*x*opening_shape(b(k), x**2)*(u(2) - u(1))/points
            end do
            call checks%is_close(mean_pressure_shape(b(k), ends)/mean, 1.0_rk, 1.0e-6_rk, &
                                 "mean pressure")
            call checks%is_close((volume_shape(b(k), ends(2)) - volume_shape(b(k), ends(1))) &
                                 /volume, 1.0_rk, 1.0e-7_rk, "volume")
         end do
      end do
   end subroutine test_integrals

end program test_coarse_tip_layer
