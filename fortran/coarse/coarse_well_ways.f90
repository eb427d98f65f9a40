!> Pressure of a well at a point of a fracture above that of the cells that it supplies, where fluid
!! leaks off on the way.
!!
!! A line of conductance T = a^3/(12 mu) that takes up g p per length has the pressure
!! q lambda/(2 T) exp(-|x|/lambda) around a flow q, lambda^2 = T/g. Cells of the length l have
!! exp(-k |i|) R q/(2 sinh k) for it, R = l/T, theta = l/lambda, 2 sinh(k/2) = theta. With shares t
!! and 1 - t in two cells, whose pressures the well has by the same shares, there lacks
!!   R q f,   f = theta/(8 w (w + 1)) + t (1 - t) (1 - theta/(2 w)),   w^2 = 1 + theta^2/4
!! which is t (1 - t) in cells that are much shorter than lambda, and 1/(2 theta) in long ones. Next
!! to a tip, which is a mirror, the same with both images.
!!
!! Leak-off takes up 2 K/mu sqrt(k^2 + s/c) for the wave number k and Laplace's variable s; at a
!! constant rate the pressure of the well has 1/lambda^2 as if s were Gamma(5/4)^4/t, at a constant
!! pressure its flow as if it were 1/(Gamma(3/4)^4 t). What fractures store is not part of it: cells
!! follow a front within a cell in time no better than without.
module coarse_well_ways
   use base_kinds, only: rk
   implicit none(type, external)
   private

   public :: decay_rate, way_with_uptake

contains

   !> The pressure above that of the cells over the loss of the flow: in a cell, or with at_tip in
   !! half of the last cell.
   elemental real(rk) function way_with_uptake(steady, theta, at_tip) result(way)
      real(rk), intent(in) :: steady  !< without uptake [-]
      real(rk), intent(in) :: theta  !< length of the cells over lambda [-]
      logical, intent(in) :: at_tip  !< between the last middle and a tip
      real(rk), parameter :: small = 1.0e-6_rk
      real(rk) :: w

      way = steady
      if (theta < small) return
      w = sqrt(1.0_rk + 0.25_rk*theta**2)
      way = theta/(8.0_rk*w*(w + 1.0_rk)) + steady*(1.0_rk - 0.5_rk*theta/w)
      if (.not. at_tip) return
      way = ((1.0_rk + exp(-(1.0_rk - steady)*theta))*w - 2.0_rk - 0.5_rk*theta**2 + theta*w) &
            /(theta*w)
   end function way_with_uptake

   !> 1/lambda [1/m].
   elemental real(rk) function decay_rate(conductance, mobility, diffusivity, age, has_rate) &
      result(rate)
      real(rk), intent(in) :: conductance  !< T [m3/(Pa s)]
      real(rk), intent(in) :: mobility  !< K/mu of the rock [m2/(Pa s)]
      real(rk), intent(in) :: diffusivity  !< c [m2/s]
      real(rk), intent(in) :: age  !< time since the well began [s]
      logical, intent(in) :: has_rate  !< else the well has a pressure
      real(rk) :: b, s

      s = merge(gamma(1.25_rk)**4, gamma(0.75_rk)**(-4), has_rate)/age
      ! T y = 2 K/mu sqrt(y + s/c) for y = rate^2.
      b = 2.0_rk*(mobility/conductance)**2
      rate = sqrt(b + sqrt(b**2 + 2.0_rk*b*s/diffusivity))
   end function decay_rate

end module coarse_well_ways
