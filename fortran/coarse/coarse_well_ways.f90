!> Pressure of a well at a point of a fracture above that of the cells that it supplies, where fluid
!! leaks off on the way.
!!
!! In a line of conductance T = a^3/(12 mu), wave number k, Laplace's variable s, rock on both sides
!! takes up g = sum K/mu sqrt(k^2 + s/c), less with a skin. A flow q has the pressure
!! q/pi int dk/(T k^2 + g) at its place. Cells of the length l have 4 sin^2(k l/2)/l^2 for k^2,
!! up to k l = pi. With shares t and 1 - t in two cells, whose pressures the well has by the same
!! shares, there lacks, with R = l/T, k in 1/l and g in T/l^2,
!!   R q (f + t (1 - t) d),   d = 1/pi int_0^pi 4 sin^2(k/2)/(4 sin^2(k/2) + g)
!!   f = 1/pi int_0^inf 1/(k^2 + g) - 1/pi int_0^pi 1/(4 sin^2(k/2) + g)
!! which is t (1 - t) in short cells. Long ones stand for a well of the radius T/(2 K/mu) in the
!! rock, or in thin layers, g = theta^2, where f = theta/(8 w (w + 1)), d = 1 - theta/(2 w),
!! w^2 = 1 + theta^2/4. With the theta that has the same d the ends of lines are those of layers: a
!! tip is a mirror, a joint has the pressure that its other branches let it have. A side with a
!! pressure has an image of the opposite sign in the fracture and in the rock.
!!
!! At a constant rate the pressure of a well in thin layers is as if s were Gamma(5/4)^4/t, its flow
!! at a constant pressure as if it were 1/(Gamma(3/4)^4 t). What fractures store is not part of it:
!! cells follow a front within a cell in time no better than without.
module coarse_well_ways
   use base_kinds, only: pi, rk
   implicit none(type, external)
   private

   public :: effective_s, uptake_t

   !> What the rock takes up from a line, per pressure and length, and what wells in it lack.
   type :: uptake_t
      real(rk) :: conductance = 0.0_rk  !< T [m3/(Pa s)]
      real(rk) :: length = 0.0_rk  !< of cells [m]
      real(rk) :: mobility(2) = 0.0_rk  !< K/mu of the rock on each side [m2/(Pa s)]
      real(rk) :: diffusivity(2) = 1.0_rk  !< c there [m2/s]
      real(rk) :: skin = 0.0_rk  !< resistance of each face [Pa s/m]
      real(rk) :: at_middle = 0.0_rk, between = 1.0_rk  !< f, d [-]
      real(rk) :: to_side = 0.0_rk  !< pressure over R q next to a side with a pressure [-]
      real(rk) :: theta = 0.0_rk  !< of layers with the same d [-]
      !> Flow from a side with a pressure into a line that ends there, and into its cells, times R
      !! over this pressure [-].
      real(rk) :: into_line = 0.0_rk, into_cells = 0.0_rk
   contains
      procedure :: find
      procedure :: way
      procedure :: way_at_end
      procedure :: way_of_outlet
   end type uptake_t

contains

   !> f, d and theta for Laplace's variable s.
   pure subroutine find(self, s, from_side)
      class(uptake_t), intent(inout) :: self
      real(rk), intent(in) :: s  !< [1/s]
      real(rk), intent(in) :: from_side  !< distance from a side with a pressure [l/2]
      integer, parameter :: n = 200  ! places of the midpoint rule, dense at k = 0
      real(rk) :: cell, decay, front, g, k, v, x
      integer :: i
      logical :: is_little

      self%at_middle = 0.0_rk
      self%between = 1.0_rk
      ! What differs from layers has no tail that oscillates.
      decay = sqrt(taken(pi))
      ! With little uptake, less what there is without: that is 0, and the rule leaves 1e-5 of it.
      is_little = decay < 1.0_rk
      self%to_side = 0.5_rk*(1.0_rk - exp(-decay*from_side))/decay
      front = s*self%length**2*sum(self%mobility/self%diffusivity)/sum(self%mobility)
      x = min(50.0_rk, 0.5_rk*sqrt(front))
      self%into_line = 0.0_rk
      self%into_cells = 0.0_rk
      do i = 1, n
         v = (i - 0.5_rk)/n
         k = pi*v**3
         cell = 4.0_rk*sin(0.5_rk*k)**2
         g = taken(k)
         if (is_little) then
            self%at_middle = self%at_middle + 3.0_rk*v**2/n*excess(k, cell)*g*(k**2 + cell + g) &
                             /((k**2 + g)*(cell + g))
         else
            self%at_middle = self%at_middle + 3.0_rk*v**2/n*(cell - k**2)/((k**2 + g)*(cell + g))
         end if
         self%between = self%between - 3.0_rk*v**2/n*g/(cell + g)
         self%to_side = self%to_side + v**2*unlike_layers(k)
         self%into_line = self%into_line + 6.0_rk*v**2/n*front/(k**2 + front)*g/(k**2 + g)
         ! The rock has part of the pressure by its front.
         self%into_cells = self%into_cells + 6.0_rk*v**2/n*g/(cell + g) &
                           *(1.0_rk - 0.25_rk*cell*cosh(x)/(sinh(x)**2 + 0.25_rk*cell))
         k = pi/v**3
         self%at_middle = self%at_middle + merge(-taken(k)/k**2, 1.0_rk, is_little) &
                          *3.0_rk/(n*v**4*(k**2 + taken(k)))
         self%to_side = self%to_side + unlike_layers(k)/v**4
         self%into_line = self%into_line + 6.0_rk/(n*v**4)*front/(k**2 + front) &
                          *taken(k)/(k**2 + taken(k))
      end do
      associate (d => min(1.0_rk, max(tiny(1.0_rk), self%between)))
         self%theta = 2.0_rk*(1.0_rk - d)/sqrt(d*(2.0_rk - d))
      end associate

   contains

      !> 1/cell - 1/k^2 for cell = 4 sin^2(k/2).
      pure real(rk) function excess(k, cell)
         real(rk), intent(in) :: k, cell
         real(rk), parameter :: small = 0.1_rk

         excess = 1.0_rk/12.0_rk + k**2/240.0_rk + k**4/6048.0_rk + k**6/172800.0_rk
         if (k > small) excess = 1.0_rk/cell - 1.0_rk/k**2
      end function excess

      !> What the pressure next to a side has for k.
      pure real(rk) function unlike_layers(k)
         real(rk), intent(in) :: k

         unlike_layers = 6.0_rk/n*sin(0.5_rk*k*from_side)**2 &
                         *(decay**2 - taken(k))/((k**2 + taken(k))*(k**2 + decay**2))
      end function unlike_layers

      !> g of k.
      pure real(rk) function taken(k)
         real(rk), intent(in) :: k
         real(rk) :: by_rock(2)

         by_rock = self%mobility*sqrt((k/self%length)**2 + s/self%diffusivity)
         taken = sum(by_rock/(1.0_rk + self%skin*by_rock))*self%length**2/self%conductance
      end function taken

   end subroutine find

   !> The pressure above that of the cells over R q, or for the half of R in the middle of a cell.
   elemental real(rk) function way(self, steady)
      class(uptake_t), intent(in) :: self
      real(rk), intent(in) :: steady  !< t (1 - t) [-]

      way = self%at_middle + steady*self%between
   end function way

   !> The same over the half of R, in half of a cell before an end of its line; and the share of the
   !! flow and of the pressure that the end has, as in a line without a source there.
   elemental subroutine way_at_end(self, offset, others, has_node, way, share)
      class(uptake_t), intent(in) :: self
      real(rk), intent(in) :: offset  !< distance from the middle over that of the end [-]
      !> what the other branches at the end take up by its pressure, over what this line does; 0 at
      !! tips, huge at outlets [-]
      real(rk), intent(in) :: others
      logical, intent(in) :: has_node  !< the end has a pressure
      real(rk), intent(out) :: way, share  !< [-]
      real(rk), parameter :: small = 1.0e-5_rk
      real(rk) :: at_node, in_cell, node, rate, tau, w

      share = merge(offset, 0.0_rk, has_node)
      way = offset*(1.0_rk - share)
      if (self%theta < small) return
      w = sqrt(1.0_rk + 0.25_rk*self%theta**2)
      ! Of layers: theta.
      rate = 1.0_rk/(2.0_rk*self%at_middle + 1.0_rk/(self%theta*w))
      way = (1.0_rk + (1.0_rk - others)/(1.0_rk + others)*exp(-rate*(1.0_rk - offset)))/rate
      tau = 1.0_rk - self%between
      in_cell = 2.0_rk*tau/self%between
      if (.not. has_node) then
         way = way - 2.0_rk/in_cell
         return
      end if
      share = max(tiny(1.0_rk), exp(-0.5_rk*rate*(1.0_rk - offset)) &
                  *(1.0_rk - exp(-rate*offset))/(1.0_rk - exp(-rate)))
      if (others > 0.5_rk*huge(1.0_rk)) then
         way = 2.0_rk*self%to_side - (1.0_rk - share)**2*self%between
         return
      end if
      ! Pressures over R of the cell and of the node, half of R apart.
      node = 2.0_rk*others*tau
      at_node = (share*in_cell + 2.0_rk)/(in_cell*node + 2.0_rk*(in_cell + node))
      in_cell = (1.0_rk - share + 2.0_rk*at_node)/(in_cell + 2.0_rk)
      way = way - 2.0_rk*((1.0_rk - share)*in_cell + share*at_node)
   end subroutine way_at_end

   !> Way from the middle of a cell to a side with a pressure at its end, over half of the cell: the
   !! flow into the cells is then that into the line, by Stehfest's sums over s. From these the
   !! flows at one s are up to 80 % different, where the front in the rock is wider than the way.
   pure subroutine way_of_outlet(self, time, way, error, flow, fall)
      class(uptake_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< since the side has the pressure [s]
      real(rk), intent(out) :: way  !< [-]
      real(rk), intent(out) :: error  !< of the flow, relative [-]
      real(rk), intent(out) :: flow  !< into the line, times R over twice the pressure [-]
      real(rk), intent(out) :: fall  !< its power of the time, 1/4 in layers to 1/2 in rock [-]
      integer, parameter :: weight(6) = [1, -49, 366, -858, 810, -270]
      real(rk), parameter :: small = 3.0e-3_rk  ! below, quadrature is less exact
      real(rk), parameter :: half = 0.5_rk  ! measured: .05 to .4 of the difference
      real(rk) :: flows(2), of_first, ratio(2)
      integer :: i

      flows = 0.0_rk
      do i = 1, size(weight)
         call self%find(i*log(2.0_rk)/time, 1.0_rk)
         flows = flows + weight(i)*[self%into_cells, self%into_line]/i
         if (i == 1) of_first = self%into_line
      end do
      fall = log(self%into_line/of_first)/log(real(size(weight), rk))
      call self%find(effective_s(time, .false.), 1.0_rk)
      if (self%theta < small) fall = 0.0_rk
      way = 1.0_rk
      error = 0.0_rk
      flow = 0.5_rk*self%into_line
      if (self%theta < small) return
      ratio = self%into_cells/self%into_line
      if (all(flows > 0.0_rk)) then
         ratio(1) = flows(1)/flows(2)
         flow = 0.5_rk*flows(2)
      end if
      error = half*abs(log(ratio(2)/ratio(1)))
      associate (of_cells => self%between/(1.0_rk - self%between))
         way = max(small, (1.0_rk + of_cells)*ratio(1) - of_cells)
      end associate
   end subroutine way_of_outlet

   !> s of a well at a constant rate or pressure, for a time [1/s].
   elemental real(rk) function effective_s(age, has_rate) result(s)
      real(rk), intent(in) :: age  !< [s]
      logical, intent(in) :: has_rate  !< else the well has a pressure

      s = merge(gamma(1.25_rk)**4, gamma(0.75_rk)**(-4), has_rate)/age
   end function effective_s

end module coarse_well_ways
