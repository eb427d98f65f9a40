!> Rings around a well in the rock against closed forms: the exponential integral once the flow has
!! left the well far behind, the wall of the well as a plane before; the chain that stands for the
!! cell; the steady difference; a pulse; superposition by resistance and left-over.
program test_coarse_well_rings
   use base_kinds, only: pi, rk
   use coarse_well_rings, only: annuli_t, new_well_rings, ring_count, well_rings_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: radius = 0.01_rk  !< [m]
   real(rk), parameter :: area = 0.25_rk  !< of the cell [m2]
   real(rk), parameter :: mobility = 1.0e-15_rk, storage = 5.0e-11_rk
   real(rk), parameter :: diffusivity = mobility/storage
   real(rk), parameter :: flow = 1.0e-9_rk  !< [m2/s]
   type(checks_t) :: checks
   type(annuli_t) :: uniform
   type(well_rings_t) :: rings

   uniform = annuli_t(spread(0.0_rk, 1, 0), [mobility], [storage])
   rings = new_well_rings(radius, area, uniform, uniform)
   call test_constant_flow()
   call test_steady()
   call test_superposition()
   call test_other_rock()
   call checks%finish()

contains

   !> Steps that grow by a fourth. Error allowed: 1 % by the rings, 1 % by the steps.
   subroutine test_constant_flow()
      real(rk), parameter :: unit = flow/(2.0_rk*pi*mobility)  ! [Pa]
      real(rk) :: dt, largest(2), p(ring_count), rise, time, width

      p = 0.0_rk
      largest = 0.0_rk
      time = 0.0_rk
      dt = 1.0e-5_rk*radius**2/diffusivity
      do
         call rings%take_in(dt, flow, p)
         time = time + dt
         width = sqrt(diffusivity*time)
         if (width > 300.0_rk*radius) exit
         rise = rings%near%inlet*flow + p(1)
         if (width > 0.01_rk*radius .and. width < 0.03_rk*radius) then
            ! A plane wall, and the next term of its curvature
            associate (plane => 2.0_rk/sqrt(pi) - 0.5_rk*width/radius)
               largest(1) = max(largest(1), abs(rise/(unit*(width/radius)*plane) - 1.0_rk))
            end associate
         else if (width > 6.0_rk*radius) then
            largest(2) = max(largest(2), abs(rise/(0.5_rk*unit*exponential_integral( &
                                                   0.25_rk*(radius/width)**2)) - 1.0_rk))
         end if
         dt = 1.25_rk*dt
      end do
      call checks%is_close(largest(1), 0.0_rk, 0.02_rk, "thin layer on the wall")
      call checks%is_close(largest(2), 0.0_rk, 0.02_rk, "line source")
   end subroutine test_constant_flow

   !> E_1(x) for x < 1: its series.
   pure real(rk) function exponential_integral(x) result(e)
      real(rk), intent(in) :: x
      real(rk), parameter :: euler = 0.57721566490153286_rk
      real(rk) :: term
      integer :: k

      e = -euler - log(x)
      term = -1.0_rk
      do k = 1, 30
         term = -term*x/k
         e = e + term/k
      end do
   end function exponential_integral

   !> The difference in the steady state, and no loss of it by long steps.
   subroutine test_steady()
      real(rk), parameter :: exact = log(0.151_rk*sqrt(area)/radius)/(2.0_rk*pi*mobility)
      real(rk) :: p(ring_count)
      integer :: k

      p = 0.0_rk
      do k = 1, 40
         call rings%take_in(1.0e2_rk*3.0_rk**k, flow, p)
      end do
      call checks%is_close(rings%beyond_cell(flow, p)/(flow*exact), 1.0_rk, 1.0e-6_rk, &
                           "steady difference")
      call checks%is_close(rings%resistance(1.0e25_rk)/exact, 1.0_rk, 1.0e-6_rk, &
                           "resistance to a long step")
   end subroutine test_steady

   !> A step is the sum of what is left and of the resistance times the flow; all resistances are
   !! positive.
   subroutine test_superposition()
      real(rk) :: before(ring_count), dt, p(ring_count)
      integer :: k

      before = 0.0_rk
      call rings%take_in(1.0e3_rk, flow, before)
      do k = -6, 12
         dt = 10.0_rk**k
         p = before
         call rings%take_in(dt, 3.0_rk*flow, p)
         call checks%is_close((rings%left_over(dt, before) + 3.0_rk*flow*rings%resistance(dt)) &
                              /rings%beyond_cell(3.0_rk*flow, p), 1.0_rk, 1.0e-10_rk, &
                              "superposition")
         call checks%is_true(rings%resistance(dt) > 0.0_rk, "positive resistance")
      end do
   end subroutine test_superposition

   !> Around the well a disc smaller than the cell, of other rock, which the cell does not have:
   !! resistances in series; in all, what the cell has lies beyond.
   subroutine test_other_rock()
      real(rk), parameter :: edge = 0.05_rk, ratio = 0.1_rk
      type(annuli_t) :: disc
      type(well_rings_t) :: around
      real(rk) :: exact

      disc = annuli_t([edge], mobility*[ratio, 1.0_rk], storage*[2.0_rk, 1.0_rk])
      call checks%is_close(disc%loss(radius, 1.0_rk), (log(edge/radius)/ratio - log(edge)) &
                           /(2.0_rk*pi*mobility), 1.0e-9_rk/mobility, "resistances in series")
      call checks%is_close(disc%content(radius, 1.0_rk)/(pi*storage), 1.0_rk + edge**2 &
                           - 2.0_rk*radius**2, 1.0e-12_rk, "content")
      around = new_well_rings(radius, area, disc, uniform)
      exact = (log(edge/radius)/ratio + log(0.151_rk*sqrt(area)/edge))/(2.0_rk*pi*mobility)
      call checks%is_close(around%resistance(1.0e25_rk)/exact, 1.0_rk, 1.0e-6_rk, &
                           "steady difference with other rock at the well")
      call checks%is_close(around%error, 0.0_rk, 1.0e-9_rk, &
                           "the mesh has the rock around the cell")
   end subroutine test_other_rock

end program test_coarse_well_rings
