!> Pressure of a well at a point of a line that takes up fluid, in cells of a tenth to ten times the
!! length in which it decays, at any place and next to a tip, against the exact one; and the decay
!! by leak-off against the response of the well.
program test_coarse_well_ways
   use base_kinds, only: rk
   use coarse_well_ways, only: decay_rate, way_with_uptake
   use testing_checks, only: checks_t
   implicit none(type, external)

   integer, parameter :: n = 400  !< cells, of the length and the resistance 1
   real(rk), parameter :: thetas(4) = [0.1_rk, 1.0_rk, 3.0_rk, 10.0_rk]
   real(rk), parameter :: places(4) = [0.0_rk, 0.1_rk, 0.3_rk, 0.5_rk]  !< behind a middle
   type(checks_t) :: checks
   real(rk) :: exact, p(n), source(n)
   integer :: i, k

   do i = 1, size(thetas)
      do k = 1, size(places)
         associate (theta => thetas(i), t => places(k), at => n/2)
            source = 0.0_rk
            source(at:at + 1) = [1.0_rk - t, t]
            p = pressures(theta, source)
            exact = 0.5_rk/theta
            call checks%is_close(dot_product(source, p) + way_with_uptake(t*(1.0_rk - t), theta, &
                                                                          .false.), &
                                 exact, 1.0e-12_rk*exact, "within the line")
            if (k == 1) cycle
            source = 0.0_rk
            source(n) = 1.0_rk
            p = pressures(theta, source)
            exact = (1.0_rk + exp(-2.0_rk*theta*(0.5_rk - t)))*0.5_rk/theta
            call checks%is_close(p(n) + 0.5_rk*way_with_uptake(2.0_rk*t, theta, .true.), exact, &
                                 1.0e-12_rk*exact, "next to a tip")
         end associate
      end do
   end do
   call test_decay()
   call checks%finish()

contains

   !> Pressures in a row of cells with ends that are shut.
   function pressures(theta, source) result(p)
      real(rk), intent(in) :: theta, source(n)
      real(rk) :: p(n)
      real(rk) :: diagonal(n)
      integer :: i

      diagonal = 2.0_rk + theta**2
      diagonal([1, n]) = 1.0_rk + theta**2
      p = source
      do i = 2, n
         diagonal(i) = diagonal(i) - 1.0_rk/diagonal(i - 1)
         p(i) = p(i) + p(i - 1)/diagonal(i - 1)
      end do
      p(n) = p(n)/diagonal(n)
      do i = n - 1, 1, -1
         p(i) = (p(i) + p(i + 1))/diagonal(i)
      end do
   end function pressures

   !> In Laplace's variable the pressure of a well is q/(2 s sqrt(T g)), g = 2 K/mu sqrt(s/c);
   !! its flow at a pressure is 2 p sqrt(T g)/s.
   subroutine test_decay()
      real(rk), parameter :: t = 2.0e-9_rk, k = 1.0e-13_rk, c = 1.0e-3_rk
      real(rk), parameter :: age = 5.0e3_rk, root = sqrt(t*2.0_rk*k/sqrt(c))

      call checks%is_close(2.0_rk*root*gamma(1.25_rk)/age**0.25_rk &
                           /(2.0_rk*t*decay_rate(t, k, c, age, .true.)), 1.0_rk, &
                           1.0e-3_rk, "leak-off, rate")
      call checks%is_close(2.0_rk*t*decay_rate(t, k, c, age, .false.)*age**0.25_rk &
                           *gamma(0.75_rk)/(2.0_rk*root), 1.0_rk, 1.0e-3_rk, "leak-off, pressure")
   end subroutine test_decay

end program test_coarse_well_ways
