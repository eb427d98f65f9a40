!> Bodies of which no other start is known, for the test below.
module one_start
   use base_kinds, only: ik, rk
   use contact_pairs, only: contact_pairs_t
   implicit none(type, external)
   private

   public :: one_start_t

   type, extends(contact_pairs_t) :: one_start_t
      logical :: is_asked = .false.  !< for another start
   contains
      procedure :: restart
   end type one_start_t

contains

   !> There is none.
   subroutine restart(self, x, has_start)
      class(one_start_t), intent(inout) :: self
      real(rk), intent(inout) :: x(:)  !< [Pa]; stays
      logical, intent(out) :: has_start

      self%is_asked = size(x) > 0
      has_start = .false.
   end subroutine restart

end module one_start

!> The iteration and its way out of cycles: hundreds of bodies of random stiffness with random
!! loads, friction, dilation and history, each solution held against the law of contact itself.
!!
!! The bodies are far worse than elastic ones: their stiffness is any positive definite matrix,
!! opening and slip are coupled as strongly as that allows. Reference: the law as it is stated
!! (docs/theory.md), written out here independently.
program test_contact_newton
   use base_kinds, only: ik, rk
   use contact_law, only: contact_law_t
   use contact_newton, only: iterate, iteration_report_t, iteration_settings_t, outcome_converged
   use contact_pairs, only: contact_pairs_t
   use one_start, only: one_start_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: stiffness = 3.0e12_rk  !< c [Pa/m]
   integer(ik), parameter :: any_body = 1, crack = 2  !< kinds of stiffness matrices
   type(checks_t) :: checks

   call fix_seed()
   call many("no friction, any body", any_body, 400, [0.0_rk, 0.0_rk], 0.0_rk, .false.)
   call many("no friction, crack", crack, 200, [0.0_rk, 0.0_rk], 0.0_rk, .false.)
   call many("friction, any body", any_body, 400, [0.0_rk, 1.0_rk], 0.0_rk, .false.)
   call many("friction and history, any body", any_body, 400, [0.0_rk, 1.0_rk], 0.0_rk, .true.)
   call many("rough, any body", any_body, 400, [1.0_rk, 10.0_rk], 0.0_rk, .true.)
   call many("rough, crack", crack, 200, [1.0_rk, 10.0_rk], 0.0_rk, .true.)
   call many("dilation, any body", any_body, 400, [0.5_rk, 1.5_rk], 0.5_rk, .false.)
   call many("dilation, crack", crack, 200, [0.2_rk, 1.0_rk], 0.2_rk, .false.)
   call held_closed()
   call shortened()
   call floating_block()
   call many_joints("joints, any body", any_body, 400)
   call many_joints("joints, crack", crack, 200)
   call many_bonds("bonds, any body", any_body, 200)
   call many_bonds("bonds, crack", crack, 200)
   call many_within_strength("friction weakens, any body", any_body, 100, 0.0_rk)
   call many_within_strength("bonds wear, crack", crack, 100, 4.0e6_rk)
   call one_beyond_strength()
   call checks%finish()

contains

   !> The same numbers in every run.
   subroutine fix_seed()
      integer, allocatable :: seed(:)
      integer :: i, n

      call random_seed(size=n)
      seed = [(104729 + 7919*i, i=1, n)]
      call random_seed(put=seed)
   end subroutine fix_seed

   !> Numbers between -1 and 1.
   function random(n) result(numbers)
      integer(ik), intent(in) :: n
      real(rk) :: numbers(n)

      call random_number(numbers)
      numbers = 2.0_rk*numbers - 1.0_rk
   end function random

   !> Pairs without laws or loads on a body of a random stiffness.
   subroutine some_pairs(kind, n, pairs)
      integer(ik), intent(in) :: kind, n
      type(contact_pairs_t), intent(out) :: pairs
      real(rk) :: shape(2*n, 2*n), share(n)
      integer(ik) :: i, j

      pairs%n = n
      pairs%stiffness = stiffness
      call random_number(share)
      pairs%length = 0.01_rk*(0.2_rk + share)
      if (kind == any_body) then
         do i = 1, 2*n
            shape(:, i) = random(2*n)
         end do
         pairs%condensed = matmul(transpose(shape), shape)/n
         do i = 1, 2*n
            pairs%condensed(i, i) = pairs%condensed(i, i) + 1.0e-2_rk
         end do
      else  ! the kernel of a straight crack in constant elements, opening and slip a little coupled
         do j = 1, n
            do i = 1, n
               shape(2*i - 1, 2*j - 1) = 1.0_rk/(0.25_rk - real(i - j, rk)**2)
               shape(2*i, 2*j) = shape(2*i - 1, 2*j - 1)
               shape(2*i - 1, 2*j) = 1.5_rk*(i - j)/(1.0_rk + real(i - j, rk)**2)**2
               shape(2*i, 2*j - 1) = -shape(2*i - 1, 2*j)
            end do
         end do
         pairs%condensed = shape
      end if
      pairs%condensed = 0.01_rk*stiffness*pairs%condensed
      allocate (pairs%law(n), pairs%slip_given(n), pairs%slip_sign(n), pairs%state(n))
      allocate (pairs%load(2*n), pairs%residual(2*n))
      allocate (pairs%traction(2, n), pairs%slip_before(n), pairs%given(n))
      pairs%slip_given = .false.
      pairs%slip_before = 0.0_rk
      pairs%given = 0.0_rk
      pairs%slip_sign = 0
      pairs%state = -1
   end subroutine some_pairs

   !> Faces that loads leave within their strength stick, though they could not had they slipped,
   !! wherever the iteration begins.
   subroutine many_within_strength(name, kind, n_bodies, cohesion)
      character(len=*), intent(in) :: name
      integer(ik), intent(in) :: kind, n_bodies
      real(rk), intent(in) :: cohesion  !< of a bond, or 0 [Pa]
      integer(ik), parameter :: n_largest = 40
      real(rk), parameter :: pressure = 1.0e7_rk
      type(contact_pairs_t) :: pairs
      type(iteration_report_t) :: report
      real(rk) :: number(2), x(2*n_largest)
      integer(ik) :: body, i, n, n_stuck

      n_stuck = 0
      do body = 1, n_bodies
         n = 1 + mod(body*7_ik, n_largest)
         call some_pairs(kind, n, pairs)
         do i = 1, n
            call random_number(number)
            pairs%law(i) = contact_law_t(friction=0.6_rk, cohesion=cohesion)
            pairs%law(i)%weakening_slip = pressure/stiffness*10.0_rk**(2.0_rk*number(1) - 2.0_rk)
            pairs%law(i)%weakening = 0.5_rk/pairs%law(i)%weakening_slip
            pairs%law(i)%wear_by_slip = 1.0_rk/pairs%law(i)%weakening_slip
            pairs%load(2*i - 1:2*i) = [-pressure, (0.8_rk + 0.19_rk*number(2)) &
                                       *(0.6_rk*pressure + cohesion)]*pairs%length(i)
         end do
         x(:2*n) = 10.0_rk*pressure*random(2*n)
         call iterate(pairs, x(:2*n), iteration_settings_t(), report)
         if (report%outcome == outcome_converged .and. &
             maxval(abs(x(:2*n))) < 1.0e-6_rk*pressure) n_stuck = n_stuck + 1
      end do
      print "(a,t36,i0,a,i0)", name//", all stick", n_stuck, " of ", n_bodies
      call checks%is_true(n_stuck == n_bodies, name//": all stick")
   end subroutine many_within_strength

   !> One pair on a spring S: it slips by (tau - mu_s p)/(S/L - weakening p) where that is stable,
   !! and to the residual friction where it is not.
   subroutine one_beyond_strength()
      type(contact_pairs_t) :: pairs
      type(iteration_report_t) :: report
      real(rk), parameter :: pressure = 1.0e7_rk, shear = 6.3e6_rk, drop = 0.5_rk
      real(rk), parameter :: spring = 0.01_rk*stiffness  ! [Pa/m]
      ! What friction loses by slip, over the spring; and the slip, times the spring.
      real(rk), parameter :: loss(2) = [0.5_rk, 2.0_rk]
      real(rk), parameter :: slip(2) = [(shear - 0.6_rk*pressure)/0.5_rk, shear - 0.1_rk*pressure]
      real(rk) :: x(2)
      integer(ik) :: k

      do k = 1, 2
         call some_pairs(any_body, 1_ik, pairs)
         pairs%length = 1.0_rk
         pairs%condensed = reshape([spring, 0.0_rk, 0.0_rk, spring], [2, 2])
         pairs%law(1) = contact_law_t(friction=0.6_rk, weakening=loss(k)*spring/pressure)
         pairs%law(1)%weakening_slip = drop/pairs%law(1)%weakening
         pairs%load = [-pressure, shear]
         x = 0.0_rk
         call iterate(pairs, x, iteration_settings_t(), report)
         call checks%is_true(report%outcome == outcome_converged, "beyond its strength: solved")
         call checks%is_close(x(2)/stiffness*spring, slip(k), 1.0e-9_rk*slip(k), &
                              merge("slip that is stable  ", "slip that is unstable", k == 1))
      end do
   end subroutine one_beyond_strength

   !> Many bodies of a kind.
   subroutine many(name, kind, n_bodies, friction, dilation, with_history)
      character(len=*), intent(in) :: name
      integer(ik), intent(in) :: kind, n_bodies
      real(rk), intent(in) :: friction(2)  !< smallest, largest [-]
      real(rk), intent(in) :: dilation  !< largest [-]
      logical, intent(in) :: with_history
      integer(ik), parameter :: n_largest = 40
      type(contact_pairs_t) :: pairs
      type(iteration_report_t) :: report
      real(rk) :: x(2*n_largest), number(2), worst
      integer(ik) :: body, i, most, n, n_failed, n_restarted, total

      worst = 0.0_rk
      most = 0
      total = 0
      n_failed = 0
      n_restarted = 0
      do body = 1, n_bodies
         n = 1 + mod(body*7_ik, n_largest)
         call some_pairs(kind, n, pairs)
         do i = 1, n
            call random_number(number)
            pairs%law(i) = contact_law_t(friction=friction(1) + number(1)*(friction(2) &
                                                                           - friction(1)), &
                                         dilation=number(2)*dilation)
         end do
         if (with_history) pairs%slip_before = 1.0e-5_rk*random(n)
         pairs%load = 1.0e7_rk*0.01_rk*random(2*n)
         pairs%load(1 :: 2) = pairs%load(1 :: 2) - 0.3e7_rk*0.01_rk  ! more often pressed than not
         x(:2*n) = 0.0_rk
         call iterate(pairs, x(:2*n), iteration_settings_t(), report)
         if (report%outcome /= outcome_converged) n_failed = n_failed + 1
         if (report%was_restarted) n_restarted = n_restarted + 1
         total = total + report%iterations
         most = max(most, report%iterations)
         if (report%outcome == outcome_converged) worst = max(worst, departure(pairs, x(:2*n)))
      end do
      print "(a,t36,i0,a,f5.1,a,i0,a,i0,a,es8.1)", name, n_bodies, " solved, iterations ", &
         real(total, rk)/n_bodies, ", most ", most, ", restarted ", n_restarted, &
         ", departure ", worst
      call checks%is_true(n_failed == 0, name//": every iteration converges")
      call checks%is_close(worst, 0.0_rk, 1.0e-8_rk, name//": the law is fulfilled")
   end subroutine many

   !> Joints from a thousandth to a thousand times as stiff as the body, which close by far less
   !! than their load would to all but nothing of it; with friction and dilation.
   subroutine many_joints(name, kind, n_bodies)
      character(len=*), intent(in) :: name
      integer(ik), intent(in) :: kind, n_bodies
      integer(ik), parameter :: n_largest = 40
      type(contact_pairs_t) :: pairs
      type(iteration_report_t) :: report
      real(rk) :: number(4), worst, x(2*n_largest)
      integer(ik) :: body, i, most, n, n_failed, n_restarted, total

      worst = 0.0_rk
      most = 0
      total = 0
      n_failed = 0
      n_restarted = 0
      do body = 1, n_bodies
         n = 1 + mod(body*7_ik, n_largest)
         call some_pairs(kind, n, pairs)
         do i = 1, n
            call random_number(number)
            pairs%law(i) = contact_law_t(friction=0.2_rk + number(1), dilation=0.2_rk*number(2), &
                                         compliance=10.0_rk**(6.0_rk*number(3) - 3.0_rk) &
                                         /stiffness)
            pairs%law(i)%closure_end = 10.0_rk**(4.0_rk*number(4) - 3.0_rk) &
                                       /(1.0e7_rk*pairs%law(i)%compliance)
         end do
         pairs%load = 1.0e7_rk*0.01_rk*random(2*n)
         pairs%load(1 :: 2) = pairs%load(1 :: 2) - 0.3e7_rk*0.01_rk
         x(:2*n) = 0.0_rk
         call iterate(pairs, x(:2*n), iteration_settings_t(), report)
         if (report%outcome /= outcome_converged) n_failed = n_failed + 1
         if (report%was_restarted) n_restarted = n_restarted + 1
         total = total + report%iterations
         most = max(most, report%iterations)
         if (report%outcome == outcome_converged) worst = max(worst, departure(pairs, x(:2*n)))
      end do
      print "(a,t36,i0,a,f5.1,a,i0,a,i0,a,es8.1)", name, n_bodies, " solved, iterations ", &
         real(total, rk)/n_bodies, ", most ", most, ", restarted ", n_restarted, &
         ", departure ", worst
      call checks%is_true(n_failed == 0, name//": every iteration converges")
      call checks%is_close(worst, 0.0_rk, 1.0e-8_rk, name//": the law is fulfilled")
   end subroutine many_joints

   !> Bonds of about the strength of the load, from lengths over which the body can hold them to
   !! sudden ones. On a crack all are solved; on bodies where opening and slip are coupled as
   !! strongly as may be some points move to and fro while others break, and a few are given up.
   !! None is solved wrongly.
   subroutine many_bonds(name, kind, n_bodies)
      character(len=*), intent(in) :: name
      integer(ik), intent(in) :: kind, n_bodies
      integer(ik), parameter :: n_largest = 40
      type(contact_pairs_t) :: pairs
      type(iteration_report_t) :: report
      real(rk) :: number(4), worst, x(2*n_largest)
      integer(ik) :: body, i, most, n, n_failed, n_restarted, total

      worst = 0.0_rk
      most = 0
      total = 0
      n_failed = 0
      n_restarted = 0
      do body = 1, n_bodies
         n = 1 + mod(body*7_ik, n_largest)
         call some_pairs(kind, n, pairs)
         do i = 1, n
            call random_number(number)
            pairs%law(i) = contact_law_t(friction=0.2_rk + 0.8_rk*number(1), &
                                         tension=3.0e6_rk*number(2), cohesion=8.0e6_rk)
            pairs%law(i)%wear_by_slip = stiffness/8.0e6_rk*10.0_rk**(6.0_rk*number(3) - 3.0_rk)
            pairs%law(i)%wear_by_opening = stiffness/3.0e6_rk*10.0_rk**(6.0_rk*number(4) - 3.0_rk)
         end do
         pairs%load = 1.0e7_rk*0.01_rk*random(2*n)
         pairs%load(1 :: 2) = pairs%load(1 :: 2) - 0.3e7_rk*0.01_rk
         x(:2*n) = 0.0_rk
         call iterate(pairs, x(:2*n), iteration_settings_t(), report)
         if (report%outcome /= outcome_converged) n_failed = n_failed + 1
         if (report%was_restarted) n_restarted = n_restarted + 1
         total = total + report%iterations
         most = max(most, report%iterations)
         if (report%outcome == outcome_converged) worst = max(worst, pairs%law_residual(x(:2*n)))
      end do
      print "(a,t36,i0,a,f5.1,a,i0,a,i0,a,es8.1)", name, n_bodies, " solved, iterations ", &
         real(total, rk)/n_bodies, ", most ", most, ", restarted ", n_restarted, &
         ", departure ", worst
      print "(a,t36,i0)", name//", given up", n_failed
      call checks%is_true(n_failed == 0 .or. kind == any_body, name//": every one is solved")
      call checks%is_true(n_failed <= n_bodies/20, name//": nearly every one is solved")
      call checks%is_close(worst, 0.0_rk, 1.0e-8_rk, name//": the law is fulfilled")
   end subroutine many_bonds

   !> The largest violation of the law, over the largest traction, with the jumps or without.
   real(rk) function departure(pairs, x)
      type(contact_pairs_t), intent(in) :: pairs
      real(rk), intent(in) :: x(:)
      real(rk) :: traction(2, pairs%n), jump(2, pairs%n), largest, opening, pressure, shear, slip
      integer(ik) :: i

      jump = reshape(x/pairs%stiffness, [2_ik, pairs%n])
      traction = reshape(pairs%load - matmul(transpose(pairs%condensed), x/pairs%stiffness), &
                         [2_ik, pairs%n])/spread(pairs%length, 1, 2)
      largest = max(maxval(abs(traction)), maxval(abs(pairs%load(1 :: 2))/pairs%length), &
                    maxval(abs(pairs%load(2 :: 2))/pairs%length))
      departure = 0.0_rk
      do i = 1, pairs%n
         pressure = -traction(1, i)
         shear = traction(2, i)
         opening = jump(1, i) - pairs%law(i)%dilation*abs(jump(2, i))
         associate (soft => pairs%law(i)%compliance, end => pairs%law(i)%closure_end)
            if (soft > 0.0_rk) opening = opening + max(0.0_rk, pressure) &
                                         /(1.0_rk/soft + max(0.0_rk, pressure)*end)
            opening = opening/(1.0_rk/pairs%stiffness + soft)
         end associate
         slip = pairs%stiffness*(jump(2, i) - pairs%slip_before(i))
         associate (bound => pairs%law(i)%friction*max(pressure, 0.0_rk))
            if (pairs%law(i)%bilateral) then
               departure = max(departure, abs(opening))
            else
               departure = max(departure, -opening, -pressure)
               if (opening > 0.0_rk) departure = max(departure, min(opening, abs(pressure)))
            end if
            departure = max(departure, abs(shear) - bound)
            ! Where it slips, the shear is the bound, in the direction of the slip.
            departure = max(departure, min(abs(slip), abs(shear - sign(bound, slip))))
         end associate
      end do
      if (.not. sum(abs(traction)) + sum(abs(jump)) <= huge(1.0_rk)) departure = huge(1.0_rk)
      departure = departure/largest
   end function departure

   !> Very rough bodies that have no other start: of those that cycle, shortened steps solve most.
   !! Nothing makes sure of all; none is solved wrongly.
   subroutine shortened()
      integer(ik), parameter :: n = 40, n_bodies = 300
      real(rk), parameter :: share_solved = 0.6_rk  ! halving alone, without kinks: 0.3 of them
      type(one_start_t) :: pairs
      type(iteration_report_t) :: report
      real(rk) :: x(2*n), worst
      integer(ik) :: body, n_asked, n_solved

      worst = 0.0_rk
      n_asked = 0
      n_solved = 0
      do body = 1, n_bodies
         call some_pairs(any_body, n, pairs%contact_pairs_t)
         pairs%law%friction = 5.5_rk + 4.5_rk*random(n)
         pairs%load = 1.0e7_rk*0.01_rk*random(2*n)
         x = 1.0e8_rk*random(2*n)
         pairs%is_asked = .false.
         call iterate(pairs, x, iteration_settings_t(), report)
         if (pairs%is_asked) n_asked = n_asked + 1
         if (report%outcome /= outcome_converged) cycle
         if (pairs%is_asked) n_solved = n_solved + 1
         worst = max(worst, departure(pairs%contact_pairs_t, x))
      end do
      print "(a,t36,i0,a,i0,a,i0,a,es8.1)", "one start", n_bodies, " bodies, ", n_asked, &
         " cycle, solved by shortened steps ", n_solved, ", departure ", worst
      call checks%is_true(n_asked > 50, "one start: many cycle")
      call checks%is_true(n_solved >= share_solved*n_asked, "one start: most are solved")
      call checks%is_close(worst, 0.0_rk, 1.0e-8_rk, "one start: the law is fulfilled")
   end subroutine shortened

   !> Faces that cannot part, some of them with friction, some with a given slip.
   subroutine held_closed()
      integer(ik), parameter :: n = 12, n_bodies = 200
      type(contact_pairs_t) :: pairs
      type(iteration_report_t) :: report
      real(rk) :: worst, x(2*n)
      integer(ik) :: body, n_failed, n_restarted

      worst = 0.0_rk
      n_failed = 0
      n_restarted = 0
      do body = 1, n_bodies
         call some_pairs(crack, n, pairs)
         pairs%law%bilateral = .true.
         pairs%law(1:n:3)%bilateral = .false.
         pairs%law(1:n:2)%friction = 0.6_rk
         pairs%slip_given(n) = .true.
         pairs%law(n)%friction = 0.0_rk
         pairs%given(n) = 1.0e-6_rk
         pairs%load = 1.0e7_rk*0.01_rk*random(2*n)
         x = 0.0_rk
         call iterate(pairs, x, iteration_settings_t(), report)
         if (report%outcome /= outcome_converged) n_failed = n_failed + 1
         if (report%was_restarted) n_restarted = n_restarted + 1
         worst = max(worst, pairs%law_residual(x))
      end do
      print "(a,t36,i0,a,i0)", "held closed", n_bodies, " solved, restarted ", n_restarted
      call checks%is_true(n_failed == 0, "held closed: every iteration converges")
      call checks%is_close(worst, 0.0_rk, 1.0e-8_rk, "held closed: the law is fulfilled")
   end subroutine held_closed

   !> A part that only contact holds: pressed on, it is found though it starts off its support;
   !! drawn off, it is reported.
   subroutine floating_block()
      type(contact_pairs_t) :: pairs
      type(iteration_report_t) :: report
      real(rk) :: x(4)

      call some_pairs(any_body, 2_ik, pairs)
      ! Two pairs, a stiff bar between them that is free to move across both.
      pairs%condensed = 0.0_rk
      pairs%condensed([1, 3], 1) = 0.01_rk*stiffness*[1.0_rk, -1.0_rk]
      pairs%condensed([1, 3], 3) = 0.01_rk*stiffness*[-1.0_rk, 1.0_rk]
      pairs%condensed(2, 2) = 0.01_rk*stiffness
      pairs%condensed(4, 4) = 0.01_rk*stiffness
      pairs%length = 0.01_rk
      pairs%law%friction = 0.4_rk
      pairs%load = [-1.0e5_rk, 1.0e4_rk, 0.2e5_rk, 3.0e4_rk]
      x = [1.0e7_rk, 0.0_rk, 1.0e7_rk, 0.0_rk]
      call iterate(pairs, x, iteration_settings_t(), report)
      call checks%is_true(report%outcome == outcome_converged, "a pressed block is found")
      call checks%is_true(report%was_restarted, "a pressed block: from another start")
      call checks%is_close(departure(pairs, x), 0.0_rk, 1.0e-8_rk, "a pressed block: law")
      pairs%load = [1.0e5_rk, 1.0e4_rk, 0.2e5_rk, 3.0e4_rk]
      x = 0.0_rk
      call iterate(pairs, x, iteration_settings_t(), report)
      call checks%is_true(report%outcome /= outcome_converged, "a block drawn off is reported")
   end subroutine floating_block

end program test_contact_newton
