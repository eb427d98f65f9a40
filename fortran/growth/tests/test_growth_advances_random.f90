!> Equilibrium of many tips: random problems.
program test_growth_advances_random
   use testing_checks, only: checks_t
   use testing_random, only: random_t
   use base_kinds, only: lk, rk
   use growth_advances, only: advances_t, in_equilibrium
   implicit none(type, external)

   real(rk), parameter :: tolerance = 5.0e-3_rk

   !> Random problem: excess = constant - slope a - curve a^2/2 + coupling tanh(bend a)/bend.
   type :: problem_t
      real(rk), allocatable :: constant(:), slope(:), curve(:), coupling(:, :)
      real(rk) :: bend = 1.0_rk
   end type problem_t

   type(checks_t) :: checks

   call test_random_problems()
   call test_order()
   call checks%finish()

contains

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

end program test_growth_advances_random
