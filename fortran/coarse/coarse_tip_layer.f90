!> Opening and pressure behind the tip of a crack that a viscous fluid follows at the speed V.
!!
!! At the distance d behind the tip all fluid moves at the speed of the tip, so dp/dd = mu' V/w^2
!! with mu' = 12 mu. With the stress intensity factor at the toughness, K' = sqrt(32/pi) K_IC, the
!! opening without leak-off is (Garagash and Detournay 2000; closed form of Dontsov and Peirce 2015)
!!   w = (K'/E') sqrt(d) (1 + b sqrt(d))^(1/3),   b = 18 sqrt(3) E'^2 mu' V/K'^3
!! Near the tip this is the opening of a crack in a toughness-dominated state, far from it that of
!! one without toughness, w = 2^(1/3) 3^(5/6) (mu' V/E')^(1/3) d^(2/3). Both limits are exact. The
!! pressure follows in closed form: with y^3 = 1 + b sqrt(d),
!!   integral of dd/(d y^2) = 6 integral of dy/(y^3 - 1),
!! which is ln d near the tip and varies with d^(-1/3) far from it.
!!
!! With leak-off after Carter the flow is V w + 2 C' sqrt(V d). Where the second part dominates,
!! the opening without toughness is w = B d^(5/8) with B^4 = 256/15 (sqrt(2) + 1) 2 C' mu'
!! sqrt(V)/E' (Lenoach 1995). The form above is kept, with the b that has this limit at one
!! distance as well: with d there, y^3 = 1 + b_0 sqrt(d) (1 + r/y), b_0 without leak-off and r =
!! 2 C' E'/(K' sqrt(V)) times the ratio of the factors of both limits.
!!
!! b is the parameter of a tip, 0 where viscosity has no effect: then the procedures must not be
!! called, since their pressures are relative to that far from the tip.
module coarse_tip_layer
   use base_kinds, only: rk
   implicit none(type, external)
   private

   public :: apparent_toughness, leaking_parameter, mean_pressure_shape, opening_shape
   public :: pressure_shape, viscous_parameter, volume_shape

   real(rk), parameter :: pi = acos(-1.0_rk)

   !> Nodes and weights of Gauss' rule with eight points on -1 to 1.
   real(rk), parameter :: node(4) = [0.18343464249564980_rk, 0.52553240991632899_rk, &
                                     0.79666647741362674_rk, 0.96028985649753623_rk]
   real(rk), parameter :: weight(4) = [0.36268378337836198_rk, 0.31370664587788729_rk, &
                                       0.22238103445337447_rk, 0.10122853629037626_rk]

contains

   !> b of a tip [1/m^(1/2)].
   elemental real(rk) function viscous_parameter(viscosity, speed, modulus, toughness) result(b)
      real(rk), intent(in) :: viscosity  !< mu [Pa s]
      real(rk), intent(in) :: speed  !< V [m/s]
      real(rk), intent(in) :: modulus  !< E' [Pa]
      real(rk), intent(in) :: toughness  !< K_IC > 0 [Pa m^(1/2)]

      b = 18.0_rk*sqrt(3.0_rk)*modulus**2*12.0_rk*viscosity*max(0.0_rk, speed) &
          /(sqrt(32.0_rk/pi)*toughness)**3
   end function viscous_parameter

   !> b of a tip whose fluid leaks off [1/m^(1/2)].
   elemental real(rk) function leaking_parameter(without, coefficient, speed, modulus, toughness, &
                                                 d) result(b)
      real(rk), intent(in) :: without  !< b without leak-off [1/m^(1/2)]
      real(rk), intent(in) :: coefficient  !< C' [m/s^(1/2)]
      real(rk), intent(in) :: speed  !< V > 0 [m/s]
      real(rk), intent(in) :: modulus  !< E' [Pa]
      real(rk), intent(in) :: toughness  !< K_IC > 0 [Pa m^(1/2)]
      real(rk), intent(in) :: d  !< distance from the tip at which it has the limit [m]
      integer, parameter :: iterations = 20
      real(rk) :: flow, leaked, y
      integer :: i

      b = without
      if (.not. (without > 0.0_rk .and. coefficient > 0.0_rk)) return
      flow = without*sqrt(d)
      leaked = flow*2.0_rk*coefficient*modulus/(sqrt(32.0_rk/pi)*toughness*sqrt(speed)) &
               *256.0_rk/15.0_rk*(sqrt(2.0_rk) + 1.0_rk)/(18.0_rk*sqrt(3.0_rk))
      ! Newton for y^4 - (1 + flow) y - leaked = 0, convex, from above.
      y = (1.0_rk + flow)**(1.0_rk/3.0_rk) + leaked**0.25_rk
      do i = 1, iterations
         y = y - (y*(y**3 - 1.0_rk - flow) - leaked)/(4.0_rk*y**3 - 1.0_rk - flow)
      end do
      b = without*(1.0_rk + leaked/(flow*y))
   end function leaking_parameter

   !> Opening at a distance over K'/E' [m^(1/2)].
   elemental real(rk) function opening_shape(b, d)
      real(rk), intent(in) :: b  !< [1/m^(1/2)]
      real(rk), intent(in) :: d  !< from the tip [m]

      opening_shape = sqrt(d)*(1.0_rk + b*sqrt(d))**(1.0_rk/3.0_rk)
   end function opening_shape

   !> Toughness that a crack would have without viscosity with the same opening at a distance, over
   !! K_IC [-].
   elemental real(rk) function apparent_toughness(b, d)
      real(rk), intent(in) :: b  !< [1/m^(1/2)]
      real(rk), intent(in) :: d  !< from the tip [m]

      apparent_toughness = (1.0_rk + b*sqrt(d))**(1.0_rk/3.0_rk)
   end function apparent_toughness

   !> Integral of the opening from the tip to a distance, over K'/E' [m^(3/2)].
   elemental real(rk) function volume_shape(b, d) result(volume)
      real(rk), intent(in) :: b  !< [1/m^(1/2)]
      real(rk), intent(in) :: d  !< from the tip [m]
      real(rk) :: u, y
      integer :: i

      u = sqrt(d)
      if (b*u > 0.5_rk) then
         y = (1.0_rk + b*u)**(1.0_rk/3.0_rk)
         volume = 6.0_rk*(((y**3/10.0_rk - 2.0_rk/7.0_rk)*y**3 + 0.25_rk)*y**4 &
                          - 9.0_rk/140.0_rk)/b**3
      else
         volume = 0.0_rk
         do i = 1, size(node)
            volume = volume + weight(i)*(of(0.5_rk*(1.0_rk - node(i))) &
                                         + of(0.5_rk*(1.0_rk + node(i))))
         end do
         volume = volume*u**3
      end if

   contains

      !> 2 x^2 (1 + b u x)^(1/3), half of which is integrated with the weights of -1 to 1.
      pure real(rk) function of(x)
         real(rk), intent(in) :: x  !< root of the distance, over u [-]

         of = x**2*(1.0_rk + b*u*x)**(1.0_rk/3.0_rk)
      end function of

   end function volume_shape

   !> Pressure at a distance less that far from the tip, over mu' V (E'/K')^2 [-].
   elemental real(rk) function pressure_shape(b, d) result(shape)
      real(rk), intent(in) :: b  !< > 0 [1/m^(1/2)]
      real(rk), intent(in) :: d  !< from the tip > 0 [m]
      real(rk) :: x, y

      x = b*sqrt(d)
      y = (1.0_rk + x)**(1.0_rk/3.0_rk)
      if (y > 20.0_rk) then  ! integral of 6 (y^-3 + y^-6 + ...) from y to infinity
         shape = -(3.0_rk + (1.2_rk + (0.75_rk + 6.0_rk/11.0_rk/y**3)/y**3)/y**3)/y**2
      else
         shape = 2.0_rk*log(x) - 3.0_rk*log(y**2 + y + 1.0_rk) &
                 + 2.0_rk*sqrt(3.0_rk)*atan(sqrt(3.0_rk)/(2.0_rk*y + 1.0_rk))
      end if
   end function pressure_shape

   !> Mean of the pressure between two distances with the weight 1/sqrt(d), as pressure_shape [-].
   pure real(rk) function mean_pressure_shape(b, d) result(mean)
      real(rk), intent(in) :: b  !< > 0 [1/m^(1/2)]
      real(rk), intent(in) :: d(2)  !< [m]

      mean = (integral(sqrt(maxval(d))) - integral(sqrt(minval(d)))) &
             /(sqrt(maxval(d)) - sqrt(minval(d)))

   contains

      !> By the root of the distance, from the tip on.
      pure real(rk) function integral(u)
         real(rk), intent(in) :: u  !< [m^(1/2)]
         real(rk) :: y

         integral = 0.0_rk
         if (.not. u > 0.0_rk) return
         y = (1.0_rk + b*u)**(1.0_rk/3.0_rk)
         integral = u*(pressure_shape(b, u**2) - 6.0_rk/(y**2 + y + 1.0_rk))
      end function integral

   end function mean_pressure_shape

end module coarse_tip_layer
