!> Pressure of a well at a point of a line that takes up fluid, in cells of a tenth to ten times the
!! length in which it decays, at any place, next to tips, joints and outlets, against the exact one;
!! in long cells that of a well in the rock; and leak-off against the response of the well.
program test_coarse_well_ways
   use base_kinds, only: pi, rk
   use coarse_well_ways, only: effective_s, uptake_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   integer, parameter :: n = 400  !< cells, of the length and the resistance 1
   real(rk), parameter :: thetas(4) = [0.1_rk, 1.0_rk, 3.0_rk, 10.0_rk]
   real(rk), parameter :: places(4) = [0.0_rk, 0.1_rk, 0.3_rk, 0.5_rk]  !< behind a middle
   real(rk), parameter :: branches = 3.0_rk, within = 1.0e-4_rk
   type(checks_t) :: checks
   type(uptake_t) :: uptake
   real(rk) :: exact, way, share
   integer :: i, k

   do i = 1, size(thetas)
      do k = 1, size(places)
         uptake = layers(thetas(i), 1.0_rk - 2.0_rk*places(k))
         associate (theta => thetas(i), t => places(k))
            call checks%is_close(drop(theta, 0.0_rk, 0.5_rk, n/2, [1.0_rk - t, t]) &
                                 + uptake%way(t*(1.0_rk - t)), 0.5_rk/theta, &
                                 within/theta, "within the line")
            if (k == 1) cycle
            exact = exp(-2.0_rk*theta*(0.5_rk - t))
            call uptake%way_at_end(2.0_rk*t, 0.0_rk, .false., way, share)
            call checks%is_close(drop(theta, 0.0_rk, 0.5_rk, n, [1.0_rk, 0.0_rk]) + 0.5_rk*way, &
                                 (1.0_rk + exact)*0.5_rk/theta, within/theta, "next to a tip")
            call uptake%way_at_end(2.0_rk*t, branches, .true., way, share)
            call checks%is_close(drop(theta, branches, 0.5_rk, n, [1.0_rk - share, share]) &
                                 + 0.5_rk*way, (1.0_rk - 0.5_rk*exact)*0.5_rk/theta, &
                                 within/theta, "next to a joint of four branches")
            if (k == size(places)) cycle
            call uptake%way_at_end(2.0_rk*t, huge(1.0_rk), .true., way, share)
            call checks%is_close(drop(theta, 1.0e9_rk, 0.5_rk, n, [1.0_rk - share, share]) &
                                 + 0.5_rk*way, (1.0_rk - exact)*0.5_rk/theta, within/theta, &
                                 "next to an outlet")
         end associate
      end do
   end do
   call test_outlets()
   call test_rock()
   call test_leak_off()
   call checks%finish()

contains

   !> Thin layers that take up theta**2 per pressure and length.
   type(uptake_t) function layers(theta, from_side)
      real(rk), intent(in) :: theta, from_side

      layers = uptake_t(conductance=1.0_rk, length=1.0_rk, mobility=theta**2*[1.0_rk, 3.0_rk] &
                        *1.0e-10_rk, diffusivity=[16.0_rk, 16.0_rk])
      call layers%find(layers%diffusivity(1)*(0.25e10_rk)**2, from_side)
   end function layers

   !> Pressure of a well that has shares of the flow 1 in a row of cells at i and behind it. Behind
   !! the last cell is a node, by half a cell, with other rows at it.
   real(rk) function drop(theta, others, half, i, share)
      real(rk), intent(in) :: theta, others, half, share(2)
      integer, intent(in) :: i
      real(rk) :: diagonal(n + 1), link(n + 1), p(n + 1)
      integer :: j

      link = -1.0_rk
      link(n) = -1.0_rk/half
      diagonal = 2.0_rk + theta**2
      diagonal(1) = 1.0_rk + theta**2
      diagonal(n:) = [1.0_rk + theta**2 - link(n), &
                      others*theta/sqrt(1.0_rk + 0.25_rk*theta**2) - link(n)]
      p = 0.0_rk
      p(i:i + 1) = share
      do j = 2, n + 1
         diagonal(j) = diagonal(j) - link(j - 1)**2/diagonal(j - 1)
         p(j) = p(j) - link(j - 1)*p(j - 1)/diagonal(j - 1)
      end do
      if (.not. diagonal(n + 1) > 0.0_rk) diagonal(n + 1) = huge(1.0_rk)
      p(n + 1) = p(n + 1)/diagonal(n + 1)
      do j = n, 1, -1
         p(j) = (p(j) - link(j)*p(j + 1))/diagonal(j)
      end do
      drop = sum(share*p(i:i + 1))
   end function drop

   !> The flow of a side with a pressure into layers; into a line and cells that hardly conduct and
   !! have the pressure of the rock behind its front; hardly any uptake; and the way itself.
   subroutine test_outlets()
      real(rk), parameter :: wide = 1.0e6_rk, apart(3) = [0.1_rk, 1.0_rk, 10.0_rk]
      real(rk) :: error, fall, flow

      do i = 1, size(thetas)
         uptake = layers(thetas(i), 1.0_rk)
         call checks%is_close(uptake%into_line, thetas(i), within*thetas(i), "flow into layers")
         call checks%is_close(drop(thetas(i), 0.0_rk, 0.5_rk, n, [0.0_rk, 1.0_rk]), &
                              1.0_rk/uptake%into_cells, within/thetas(i), "flow into cells")
      end do
      do i = 1, size(apart)
         uptake = uptake_t(conductance=1.0_rk, length=1.0_rk, mobility=[wide, 3.0_rk*wide])
         call uptake%find(apart(i)**2, 1.0_rk)
         call checks%is_close(uptake%into_line, apart(i), 1.0e-3_rk*apart(i), "behind a front")
         call checks%is_close(uptake%into_cells, 2.0_rk*(1.0_rk - exp(-0.5_rk*apart(i))), &
                              1.0e-3_rk, "cells behind a front")
      end do
      uptake = uptake_t(conductance=1.0_rk, length=1.0_rk, mobility=[1.0e-9_rk, 1.0e-9_rk])
      call uptake%way_of_outlet(1.0_rk, way, error, flow, fall)
      call checks%is_close(way, 1.0_rk, 1.0e-3_rk, "hardly any uptake")
      ! In layers the flow has the ratio of theta to that into cells of the same s; that in time, by
      ! which the way is found, is 2 % different (wells_in_rock has the flow in time).
      uptake = uptake_t(conductance=1.0_rk, length=1.0_rk, mobility=[1.0e-9_rk, 3.0e-9_rk], &
                        diffusivity=[1.0e-20_rk, 1.0e-20_rk])
      call uptake%way_of_outlet(1.0_rk, way, error, flow, fall)
      call uptake%find(effective_s(1.0_rk, .false.), 1.0_rk)
      exact = 1.0_rk/uptake%theta
      call checks%is_close(drop(uptake%theta, 0.0_rk, 0.5_rk*way, n, [0.0_rk, 1.0_rk]), exact, &
                           0.03_rk*exact, "way to an outlet")
      call checks%is_true(error < 0.1_rk, "its error")
      ! theta grows with the fourth root of s: the flow in time is exact.
      associate (s_of_theta => effective_s(1.0_rk, .false.))
         exact = 0.5_rk*uptake%theta/(s_of_theta**0.25_rk*gamma(0.75_rk))
      end associate
      call checks%is_close(flow, exact, 0.01_rk*exact, "flow into the line in time")
      call checks%is_close(fall, 0.25_rk, 1.0e-3_rk, "its power of the time")
      ! Where the rock's front is within the cell the way may be longer: cells of the rock lack it.
      do i = -8, 8
         do k = -8, 8
            uptake = uptake_t(conductance=10.0_rk**i, length=1.0_rk, mobility=[1.0_rk, 0.1_rk])
            call uptake%way_of_outlet(10.0_rk**k, way, error, flow, fall)
            call checks%is_true(way > 0.0_rk .and. way < 1.25_rk .and. error < 2.0_rk, "any line")
         end do
      end do
   end subroutine test_outlets

   !> Cells much longer than T/(2 K/mu), after a long time; and without rock on one side.
   subroutine test_rock()
      real(rk), parameter :: b = 1.0e4_rk

      uptake = uptake_t(conductance=2.0_rk, length=0.5_rk, mobility=[b, 3.0_rk*b])
      call uptake%find(1.0e-9_rk, 1.0_rk)
      call checks%is_close(pi*b*uptake%at_middle, log(1.0_rk + b/pi), 1.0e-3_rk, "in the rock")
      uptake%skin = 1.0e9_rk
      call uptake%find(1.0e-9_rk, 1.0_rk)
      call checks%is_close(uptake%way(0.2_rk), 0.2_rk, 1.0e-6_rk, "skin")
   end subroutine test_rock

   !> In Laplace's variable the pressure of a well is q/(2 s sqrt(T g)), g = 2 K/mu sqrt(s/c);
   !! its flow at a pressure is 2 p sqrt(T g)/s.
   subroutine test_leak_off()
      real(rk), parameter :: age = 5.0e3_rk

      call checks%is_close(effective_s(age, .true.)**0.25_rk, gamma(1.25_rk)/age**0.25_rk, &
                           1.0e-12_rk, "leak-off, rate")
      call checks%is_close(effective_s(age, .false.)**0.25_rk*age**0.25_rk*gamma(0.75_rk), 1.0_rk, &
                           1.0e-12_rk, "leak-off, pressure")
   end subroutine test_leak_off

end program test_coarse_well_ways
