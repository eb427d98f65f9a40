!> Equilibrium of tips against closed forms, without a mesh.
program test_growth_advances
   use testing_checks, only: checks_t
   use testing_random, only: random_t
   use base_kinds, only: lk, rk
   use growth_advances, only: advances_t, in_equilibrium
   implicit none(type, external)

   real(rk), parameter :: tolerance = 5.0e-3_rk

   abstract interface
      !> K_eq/K_IC - 1 of all tips.
      pure function excess_at(place) result(excess)
         import :: rk
         implicit none(type, external)
         real(rk), intent(in) :: place(:)
         real(rk) :: excess(size(place))
      end function excess_at
   end interface

   !> Random problem: excess = constant - slope a - curve a^2/2 + coupling tanh(bend a)/bend.
   type :: problem_t
      real(rk), allocatable :: constant(:), slope(:), curve(:), coupling(:, :)
      real(rk) :: bend = 1.0_rk
   end type problem_t

   type(checks_t) :: checks

   call test_cantilever()
   call test_collinear()
   call test_parallel()
   call test_unstable()
   call test_drop()
   call test_suction()
   call test_shapes()
   call test_moving()
   call test_random_problems()
   call test_order()
   call test_retreat()
   call test_steep_guess()
   call test_noise()
   call test_plateau()
   call test_end_of_segment()
   call checks%finish()

contains

   !> Evaluate until no tip moves.
   subroutine solve(respond, matrix, upper, advances)
      procedure(excess_at) :: respond
      real(rk), intent(in) :: matrix(:, :), upper(:)
      type(advances_t), intent(out) :: advances
      logical :: has_moved

      call advances%begin(0.0_rk*upper, upper, 0.0_rk*upper, matrix)
      do
         call advances%improve(respond(advances%place), tolerance, has_moved)
         if (.not. has_moved .or. advances%evaluations > 100) exit
      end do
   end subroutine solve

   !> A tip whose excess is negative everywhere ends exactly at its lower bound, whatever the digits
   !! of the bound are.
   subroutine test_retreat()
      real(rk), parameter :: lower(3) = [0.025_rk, 1.0_rk/3.0_rk, 0.7_rk/11.0_rk]
      type(advances_t) :: advances
      logical :: has_moved
      integer :: i

      do i = 1, size(lower)
         call advances%begin(lower(i:i), [0.5_rk], [0.4_rk], reshape([-0.2_rk], [1, 1]))
         do
            call advances%improve([-0.6_rk - advances%place(1)], tolerance, has_moved)
            if (.not. has_moved .or. advances%evaluations > 20) exit
         end do
         call checks%is_close(advances%place(1), lower(i), 0.0_rk, "at the lower bound")
         call checks%is_true(advances%evaluations == 2, "in two evaluations")
      end do
   end subroutine test_retreat

   !> With a guess of the slope that is far too steep the tip still leaves its lower bound.
   subroutine test_steep_guess()
      type(advances_t) :: advances
      logical :: has_moved

      call advances%begin([0.0_rk], [1.0_rk], [0.0_rk], reshape([-1.0e6_rk], [1, 1]))
      do
         call advances%improve([0.2_rk - advances%place(1)], tolerance, has_moved)
         if (.not. has_moved .or. advances%evaluations > 50) exit
      end do
      call checks%is_close(advances%place(1), 0.2_rk, tolerance, "in equilibrium")
   end subroutine test_steep_guess

   !> K of every mesh is off by up to 3 % of K_IC, six times the tolerance, within its stated error
   !! of 20 %. The search ends after a few evaluations, with K_eq at most three times the tolerance
   !! above K_IC and at most the slack below, and so at a place that is off by both and the noise.
   subroutine test_noise()
      real(rk), parameter :: slack = 0.05_rk, noise = 0.03_rk, slope = 2.3_rk
      integer, parameter :: problems = 500
      type(advances_t) :: advances
      type(random_t) :: random
      real(rk) :: excess(1)
      integer :: i, most, total
      logical :: has_moved

      call random%start(11_lk)
      total = 0
      most = 0
      do i = 1, problems
         call advances%begin([0.025_rk], [0.5_rk], [0.025_rk], reshape([-slope], [1, 1]))
         advances%slack = [slack]
         do
            excess = 0.2_rk - slope*advances%place &
                     + noise*(2.0_rk*real(random%below(1000), rk)/999.0_rk - 1.0_rk)
            call advances%improve(excess, tolerance, has_moved)
            if (.not. has_moved .or. advances%evaluations > 100) exit
         end do
         total = total + advances%evaluations
         most = max(most, advances%evaluations)
         call checks%is_true(excess(1) <= 3.0_rk*tolerance .and. excess(1) >= -slack, &
                             "noise: in equilibrium")
         call checks%is_close(advances%place(1), 0.2_rk/slope, (slack + noise)/slope, &
                              "noise: place")
      end do
      call checks%is_true(real(total, rk)/problems <= 5.0_rk, "noise: 5 evaluations on average")
      call checks%is_true(most <= 25, "noise: 25 evaluations at most")
   end subroutine test_noise

   !> Twelve tips that load each other, of which one has a K_eq that hardly changes over most of its
   !! segment, with a hump (K of such a tip in a network of 30 fractures): the others do not wait
   !! for it, nor does it stop where K_eq rises.
   subroutine test_plateau()
      integer, parameter :: n = 12
      type(advances_t) :: advances
      real(rk) :: matrix(n, n), excess(n)
      integer :: i, j

      do j = 1, n
         matrix(:, j) = [(merge(-0.1_rk*i, 0.01_rk, i == j), i=1, n)]
      end do
      call solve(with_plateau, matrix, spread(1.0_rk, 1, n), advances)
      excess = with_plateau(advances%place)
      call checks%is_true(all(in_equilibrium(advances%place, excess, spread(0.0_rk, 1, n), &
                                             spread(1.0_rk, 1, n), tolerance)), &
                          "plateau: in equilibrium")
      call checks%is_true(advances%place(1) > 0.75_rk, "plateau: beyond it")
      call checks%is_true(advances%evaluations <= 8, "plateau: few evaluations")
   end subroutine test_plateau

   pure function with_plateau(place) result(excess)
      real(rk), intent(in) :: place(:)
      real(rk) :: excess(size(place))
      integer :: i

      excess = [(0.03_rk*i - 0.1_rk*i*place(i) + 0.01_rk*(sum(place) - place(i)), i=1, size(place))]
      excess(1) = 0.015_rk + 0.004_rk*sin(12.0_rk*place(1)) &
                  - 0.2_rk*max(0.0_rk, place(1) - 0.7_rk) + 0.01_rk*(sum(place(2:)) - 3.6_rk)
   end function with_plateau

   !> A tip that would retreat from its upper bound by less than the distance at which it is put
   !! onto the bound is in equilibrium there, if little is missing.
   subroutine test_end_of_segment()
      type(advances_t) :: advances
      logical :: has_moved

      call advances%begin([0.0_rk], [0.1_rk], [0.1_rk], reshape([-1.0_rk], [1, 1]), &
                          sliver=[0.03_rk])
      call advances%improve([-0.008_rk], tolerance, has_moved)
      call checks%is_true(.not. has_moved, "end of a segment: stays")
      call advances%begin([0.0_rk], [0.1_rk], [0.1_rk], reshape([-1.0_rk], [1, 1]), &
                          sliver=[0.03_rk])
      call advances%improve([-0.012_rk], tolerance, has_moved)
      call checks%is_true(has_moved, "end of a segment: retreats")
   end subroutine test_end_of_segment

   !> Double cantilever beam of 1 m at a given opening: K falls as the length to the power of -2.
   subroutine test_cantilever()
      type(advances_t) :: advances

      call solve(cantilever, reshape([-2.4_rk], [1, 1]), [1.0_rk], advances)
      ! K_eq/K_IC = 1.2/(1 + a)^2, so a = sqrt(1.2) - 1; the tolerance is worth 2.8e-3 m there.
      call checks%is_close(advances%place(1), sqrt(1.2_rk) - 1.0_rk, 2.8e-3_rk, "cantilever")
      call checks%is_true(advances%evaluations <= 5, "cantilever: few evaluations")
   end subroutine test_cantilever

   pure function cantilever(place) result(excess)
      real(rk), intent(in) :: place(:)
      real(rk) :: excess(size(place))

      excess = 1.2_rk/(1.0_rk + place)**2 - 1.0_rk
   end function cantilever

   !> Two equal collinear cracks from .5 to 1.5 m on either side of the origin: inner and outer
   !! tips, under a stress that decreases as the square of the open length, grow inwards first.
   subroutine test_collinear()
      type(advances_t) :: advances
      real(rk), parameter :: upper(2) = [0.2_rk, 0.2_rk]
      real(rk) :: excess(2), matrix(2, 2)
      integer :: j

      do j = 1, 2
         matrix(:, j) = (collinear(1.0e-4_rk*[2 - j, j - 1]) - collinear([0.0_rk, 0.0_rk])) &
                        /1.0e-4_rk
      end do
      call solve(collinear, matrix, upper, advances)
      excess = collinear(advances%place)
      call checks%is_true(advances%place(1) > 0.01_rk, "inner tips grow")
      call checks%is_close(excess(1), 0.0_rk, tolerance, "inner tips at their toughness")
      call checks%is_close(advances%place(2), 0.0_rk, 0.0_rk, "outer tips stay")
      call checks%is_true(excess(2) < 0.0_rk, "outer tips below their toughness")
      call checks%is_true(advances%evaluations <= 6, "collinear cracks: few evaluations")
   end subroutine test_collinear

   !> Tada, Paris and Irwin, The Stress Analysis of Cracks Handbook, two equal collinear cracks:
   !! with E and K complete elliptic integrals of k, k^2 = 1 - b^2/a^2, cracks at b < |x| < a,
   !! K_I(a) = s sqrt(pi a) (1 - E/K)/k,   K_I(b) = s sqrt(pi b) (E/K - b^2/a^2)/(k b/a).
   pure function collinear(place) result(excess)
      real(rk), intent(in) :: place(:)  !< advances of inner and outer tips [m]
      real(rk) :: excess(size(place))
      real(rk) :: inner, k, outer, ratio, stress

      inner = 0.5_rk - place(1)
      outer = 1.5_rk + place(2)
      k = sqrt(1.0_rk - (inner/outer)**2)
      ratio = second_over_first(k)
      stress = 1.0_rk/(outer - inner)**2
      excess = stress/0.8_rk &
               *[sqrt(inner)*(ratio - (inner/outer)**2)/(k*inner/outer), &
                 sqrt(outer)*(1.0_rk - ratio)/k] - 1.0_rk
   end function collinear

   !> E(k)/K(k) by the arithmetic-geometric mean.
   pure real(rk) function second_over_first(k) result(ratio)
      real(rk), intent(in) :: k
      real(rk) :: a, b, c, next, power
      integer :: i

      a = 1.0_rk
      b = sqrt(1.0_rk - k**2)
      ratio = 1.0_rk - 0.5_rk*k**2
      power = 0.5_rk
      do i = 1, 12
         c = 0.5_rk*(a - b)
         next = 0.5_rk*(a + b)
         b = sqrt(a*b)
         a = next
         power = 2.0_rk*power
         ratio = ratio - 0.5_rk*power*c**2
      end do
   end function second_over_first

   !> K_eq of a tip that viscous fluid follows falls steeply with its position, and vanishes where
   !! suction closes its faces; ahead of that, slip of the closed faces brings it back. The search
   !! begins in the closed part, and does not end there, nor at the far end of the segment.
   subroutine test_suction()
      type(advances_t) :: advances
      real(rk), parameter :: upper(1) = [0.042_rk]
      logical :: has_moved

      call advances%begin([0.0_rk], upper, [0.0103_rk], reshape([-450.0_rk], [1, 1]))
      do
         call advances%improve(with_suction(advances%place), tolerance, has_moved)
         if (.not. has_moved .or. advances%evaluations > 100) exit
      end do
      call checks%is_close(advances%place(1), 0.0075_rk, 2.0e-5_rk, "suction: where it is open")
      call checks%is_true(advances%evaluations <= 20, "suction: number of evaluations")
   end subroutine test_suction

   pure function with_suction(place) result(excess)
      real(rk), intent(in) :: place(:)  !< [m]
      real(rk) :: excess(size(place))

      excess = max(-1.0_rk, 3.3_rk - 440.0_rk*place)
      where (place > 0.0102_rk) excess = min(0.96_rk, 0.4_rk + 900.0_rk*(place - 0.0103_rk))
   end function with_suction

   !> Parallel cracks of 1 and .98 m, 1 m apart, each of which shields the other as it becomes
   !! longer: the longer crack grows, the other stays.
   subroutine test_parallel()
      type(advances_t) :: advances
      real(rk) :: excess(2), matrix(2, 2)
      integer :: j

      do j = 1, 2
         matrix(:, j) = (parallel(1.0e-4_rk*[2 - j, j - 1]) - parallel([0.0_rk, 0.0_rk]))/1.0e-4_rk
      end do
      call solve(parallel, matrix, [0.5_rk, 0.5_rk], advances)
      excess = parallel(advances%place)
      call checks%is_true(advances%place(1) > 0.01_rk, "the longer one grows")
      call checks%is_close(excess(1), 0.0_rk, tolerance, "and is at its toughness")
      call checks%is_close(advances%place(2), 0.0_rk, 0.0_rk, "the shorter one stays")
      call checks%is_true(excess(2) < 0.0_rk, "and is below its toughness")
   end subroutine test_parallel

   pure function parallel(place) result(excess)
      real(rk), intent(in) :: place(:)
      real(rk) :: excess(size(place))
      real(rk) :: length(2)

      length = [1.0_rk, 0.98_rk] + place
      excess = 1.5_rk*sqrt(length)/(1.0_rk + 0.45_rk*length(2:1:-1)**4)/length - 1.0_rk
   end function parallel

   !> Where K increases with the length a tip goes to the end.
   subroutine test_unstable()
      type(advances_t) :: advances

      call solve(rising, reshape([0.5_rk], [1, 1]), [1.0_rk], advances)
      call checks%is_close(advances%place(1), 1.0_rk, 0.0_rk, "to its end")
      call checks%is_true(advances%evaluations <= 3, "at once")
   end subroutine test_unstable

   pure function rising(place) result(excess)
      real(rk), intent(in) :: place(:)
      real(rk) :: excess(size(place))

      excess = 1.02_rk*sqrt(1.0_rk + place) - 1.0_rk
   end function rising

   !> K decreases suddenly by a half at .3 m, as where a tip comes close to an open fracture: the
   !! tip stops beyond this point, since K_eq exceeds K_IC before it.
   subroutine test_drop()
      type(advances_t) :: advances
      real(rk) :: excess(1)

      call solve(dropping, reshape([-0.5_rk], [1, 1]), [1.0_rk], advances)
      excess = dropping(advances%place)
      call checks%is_true(excess(1) <= tolerance, "K_eq does not exceed K_IC")
      call checks%is_true(advances%place(1) >= 0.3_rk .and. advances%place(1) < 0.3005_rk, &
                          "beyond the drop")
      call checks%is_true(advances%evaluations <= 60, "after a bounded number of evaluations")
   end subroutine test_drop

   pure function dropping(place) result(excess)
      real(rk), intent(in) :: place(:)
      real(rk) :: excess(size(place))

      excess = merge(0.497_rk, -0.4_rk, place < 0.3_rk)
   end function dropping

   !> For any dependence of the excess of one tip on its position, the search ends at a position
   !! where K_eq does not exceed K_IC, except at the upper bound; nor is K_eq below K_IC, except
   !! next to a position where it exceeds K_IC, or at the lower bound.
   subroutine test_shapes()
      character(len=*), parameter :: name(9) = [character(len=16) :: &
                                                "monotone", "sudden", "noisy", "two roots", &
                                                "cycle of D4", "flat", "always above", &
                                                "always below", "steep"]
      real(rk), parameter :: start(3) = [0.05_rk, 0.3045_rk, 0.9_rk], &
                             slope(4) = [-0.5_rk, -0.02_rk, -40.0_rk, 0.5_rk]
      integer :: i, j, k, most, total

      most = 0
      total = 0
      do k = 1, size(name)
         do i = 1, size(start)
            do j = 1, size(slope)
               call search(trim(name(k)), k, start(i), slope(j), most, total)
            end do
         end do
      end do
      print "(a, i0, a, f0.1)", "one tip: evaluations at most ", most, ", mean ", &
         real(total, rk)/(size(name)*size(start)*size(slope))
      call checks%is_true(most <= 60, "in a bounded number of evaluations")
   end subroutine test_shapes

   !> One search up to 1 m from a position behind which the tip cannot retreat.
   subroutine search(name, number, start, slope, most, total)
      character(len=*), intent(in) :: name
      integer, intent(in) :: number  !< number of the function
      real(rk), intent(in) :: start  !< [m]
      real(rk), intent(in) :: slope  !< first estimate [1/m]
      integer, intent(inout) :: most, total  !< evaluations of one search, and of all so far
      real(rk), parameter :: near = 5.0e-4_rk  !< [m]
      type(advances_t) :: advances
      real(rk) :: left
      logical :: has_moved

      call advances%begin([start], [1.0_rk], [start], reshape([slope], [1, 1]))
      do
         call advances%improve([sample(number, advances%place(1))], tolerance, has_moved)
         if (.not. has_moved .or. advances%evaluations > 100) exit
      end do
      most = max(most, advances%evaluations)
      total = total + advances%evaluations
      associate (place => advances%place(1))
         left = sample(number, place)
         call checks%is_true(left <= tolerance .or. place >= 1.0_rk, name//": not beyond K_IC")
         call checks%is_true(left >= -tolerance .or. place <= start + near .or. &
                             sample(number, place - near) > 0.0_rk, name//": no farther")
      end associate
   end subroutine search

   !> Excesses that have occurred, or could occur [-].
   pure real(rk) function sample(number, s)
      integer, intent(in) :: number
      real(rk), intent(in) :: s  !< [m]
      ! Scene D4 at 194.226 s, where secants cycled through four tries: a tip between two others;
      ! positions over the length of its segment, 2 mm.
      real(rk), parameter :: at(4) = [0.3045_rk, 0.4875_rk, 0.638_rk, 0.907_rk], &
                             d4(4) = [0.0275_rk, 0.0192_rk, -0.0227_rk, -0.0343_rk]
      integer :: k

      select case (number)
      case (1)
         sample = sqrt(0.55_rk/s) - 1.0_rk
      case (2)
         sample = merge(0.497_rk, -0.3_rk, s < 0.61803_rk)
      case (3)
         sample = 0.5_rk*(0.7_rk - s) + 0.8_rk*tolerance*sin(1.0e4_rk*s)
      case (4)
         sample = (s - 0.4_rk)*(s - 0.8_rk)
      case (5)
         k = max(1, min(3, count(at <= s)))
         sample = d4(k) + (d4(k + 1) - d4(k))/(at(k + 1) - at(k))*(s - at(k))
      case (6)
         sample = 0.02_rk*tanh(300.0_rk*(0.65_rk - s))
      case (7)
         sample = 0.02_rk + 0.01_rk*sin(20.0_rk*s)
      case (8)
         sample = -0.02_rk - 0.01_rk*sin(20.0_rk*s)
      case default
         sample = 33.0_rk*(0.2008_rk - s)
      end select
   end function sample

   !> Where tips outside of the problem move, the excess at a position differs each time: the search
   !! ends nevertheless, and not where K_eq exceeds K_IC.
   subroutine test_moving()
      type(advances_t) :: advances
      logical :: has_moved
      real(rk) :: left
      integer :: period, try

      do period = 1, 5
         call advances%begin([0.05_rk], [1.0_rk], [0.05_rk], reshape([-0.5_rk], [1, 1]))
         do try = 1, 100
            left = merge(0.1_rk, -0.1_rk, modulo(try, period + 1) < period)
            if (period > 3) left = 0.1_rk*sin(real(try*period, rk)) + 0.02_rk
            call advances%improve([left], tolerance, has_moved)
            if (.not. has_moved) exit
         end do
         call checks%is_true(.not. has_moved, "moving: the search ends")
         call checks%is_true(left <= tolerance .or. advances%place(1) >= 1.0_rk, "moving: at rest")
      end do
   end subroutine test_moving

   !> 1,000 problems of 2 to 40 tips that promote or shield each other, or both, with slopes that
   !! differ by a factor of a hundred. None cycles.
   subroutine test_random_problems()
      integer, parameter :: problems = 1000
      type(problem_t) :: problem
      type(advances_t) :: advances
      type(random_t) :: random
      real(rk), allocatable :: zero(:), one(:)
      logical :: has_moved
      integer :: above, k, monotone, most, n, total

      total = 0
      most = 0
      above = 0
      monotone = 0
      call random%start(7_lk)
      do k = 1, problems
         n = 2 + random%below(39)
         call draw(problem, n, random)
         zero = spread(0.0_rk, 1, n)
         one = spread(1.0_rk, 1, n)
         call advances%begin(zero, one, zero, derivative_of(problem, zero))
         do
            call advances%improve(excess_of(problem, advances%place), tolerance, has_moved)
            if (.not. has_moved .or. advances%evaluations > 200) exit
         end do
         total = total + advances%evaluations
         most = max(most, advances%evaluations)
         if (advances%evaluations > 12) above = above + 1
         if (advances%is_monotone) then
            monotone = monotone + 1
            call checks%is_true(all(excess_of(problem, advances%place) <= tolerance .or. &
                                    advances%place >= one), "no tip exceeds its toughness")
         else
            call checks%is_true(all(in_equilibrium(advances%place, &
                                                   excess_of(problem, advances%place), zero, one, &
                                                   tolerance)), "equilibrium")
         end if
      end do
      print "(a, f0.2, 3(a, i0))", "evaluations: mean ", real(total, rk)/problems, ", most ", &
         most, ", problems with more than 12: ", above, ", monotone ", monotone
      call checks%is_true(total <= 5*problems, "5 evaluations on average")
      call checks%is_true(above <= problems/500 .and. most <= 40, "12 at most, but in one of 500")
   end subroutine test_random_problems

   !> Draw a problem on the unit interval.
   subroutine draw(self, n, random)
      type(problem_t), intent(out) :: self
      integer, intent(in) :: n  !< number of tips
      type(random_t), intent(inout) :: random
      integer :: i, j, kind

      allocate (self%constant(n), self%slope(n), self%curve(n), self%coupling(n, n))
      kind = random%below(3)
      do i = 1, n
         self%constant(i) = -0.2_rk + 0.5_rk*uniform(random)
         self%slope(i) = 10.0_rk**(-0.7_rk + 2.0_rk*uniform(random))
         self%curve(i) = self%slope(i)*(-0.4_rk + 1.4_rk*uniform(random))
         do j = 1, n
            self%coupling(i, j) = 2.0_rk*uniform(random) - 1.0_rk
         end do
         if (kind > 0) self%coupling(i, :) = abs(self%coupling(i, :))*(2*kind - 3)
         self%coupling(i, i) = 0.0_rk
         self%coupling(i, :) = 0.9_rk*uniform(random)*self%slope(i)*self%coupling(i, :) &
                               /sum(abs(self%coupling(i, :)))
      end do
      self%bend = 0.5_rk + 1.5_rk*uniform(random)
   end subroutine draw

   real(rk) function uniform(random)
      type(random_t), intent(inout) :: random
      integer, parameter :: n = 1000000

      uniform = real(random%below(n), rk)/n
   end function uniform

   pure function excess_of(self, place) result(excess)
      type(problem_t), intent(in) :: self
      real(rk), intent(in) :: place(:)
      real(rk) :: excess(size(place))

      excess = self%constant - self%slope*place - 0.5_rk*self%curve*place**2 &
               + matmul(self%coupling, tanh(self%bend*place)/self%bend)
   end function excess_of

   pure function derivative_of(self, place) result(matrix)
      type(problem_t), intent(in) :: self
      real(rk), intent(in) :: place(:)
      real(rk) :: matrix(size(place), size(place))
      integer :: j

      do j = 1, size(place)
         matrix(:, j) = self%coupling(:, j)/cosh(self%bend*place(j))**2
         matrix(j, j) = matrix(j, j) - self%slope(j) - self%curve(j)*place(j)
      end do
   end function derivative_of

   !> The order of the tips does not matter, nor the unit of length.
   subroutine test_order()
      integer, parameter :: n = 12
      real(rk), parameter :: unit = 1000.0_rk
      type(problem_t) :: problem
      type(advances_t) :: as_drawn, turned
      type(random_t) :: random
      real(rk) :: excess(n), one(n), zero(n)
      logical :: has_moved, moves_too
      integer :: k, try

      zero = 0.0_rk
      one = 1.0_rk
      do k = 1, 20
         call random%start(int(k, lk))
         call draw(problem, n, random)
         associate (matrix => derivative_of(problem, zero))
            call as_drawn%begin(zero, one, zero, matrix)
            call turned%begin(zero, unit*one, zero, matrix(n:1:-1, n:1:-1)/unit)
         end associate
         do try = 1, 100
            excess = excess_of(problem, as_drawn%place)
            call as_drawn%improve(excess, tolerance, has_moved)
            excess = excess_of(problem, turned%place(n:1:-1)/unit)
            call turned%improve(excess(n:1:-1), tolerance, moves_too)
            if (.not. (has_moved .and. moves_too)) exit
         end do
         call checks%is_true(has_moved .eqv. moves_too, "as many evaluations")
         call checks%is_close(maxval(abs(turned%place(n:1:-1)/unit - as_drawn%place)), 0.0_rk, &
                              1.0e-9_rk, "order and unit")
      end do
   end subroutine test_order

end program test_growth_advances
