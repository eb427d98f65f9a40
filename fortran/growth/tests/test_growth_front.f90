!> Tips that grow together: which of them and how far, what stops or joins them, and the direction
!! found by the loop, in prescribed fields of intensities.
program test_growth_front
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use growth_rules, only: growth_rules_t
   use growth_law, only: growth_drive_t
   use growth_network, only: total_length
   use growth_targets, only: target_boundary
   use sample_fronts, only: sample_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: radius = 0.025_rk  !< of the rosettes [m]
   real(rk), parameter :: increment = 0.03_rk  !< l_max [m]
   !> Kinks and advances are multiples of 1e-7 rad and 1e-7 l_max; half of each, in 15 steps.
   real(rk), parameter :: grains = 15.0_rk*1.0e-7_rk*increment
   !> Fracture 1 with two tips that grow here, fracture 2 above it.
   real(rk), parameter :: lines(2, 2, 2) = reshape([0.51_rk, 1.0_rk, 1.51_rk, 1.0_rk, 0.51_rk, &
                                                    1.51_rk, 1.51_rk, 1.51_rk], [2, 2, 2])
   type(checks_t) :: checks

   call test_growth_law()
   call test_rounding()
   call test_joined_tip()
   call test_carried_growth()
   call test_arrest()
   call test_join()
   call test_path()
   call test_half_way()
   call test_last_increments()
   call test_joins_ahead()
   call test_shut_ends()
   call checks%finish()

contains

   !> A segment that turns and is shut at its end is halved until it is not, or as short as it may
   !! be; the next one is at most twice as long. One that goes straight on keeps its length.
   subroutine test_shut_ends()
      call check_shut_end(1.0_rk, 0.3_rk, 0.0_rk, 0.25_rk, "until it is open at its end")
      call check_shut_end(1.0_rk, 0.3_rk, 0.5_rk, 0.5_rk, "to the shortest length")
      call check_shut_end(0.5_rk, 0.3_rk, 0.0_rk, 1.0_rk, "a path that turns less")
      call check_shut_end(1.0_rk, 1.1_rk, 0.0_rk, 1.0_rk, "open at its end")
   end subroutine test_shut_ends

   subroutine check_shut_end(angle, open_to, shortest, wanted, what)
      real(rk), intent(in) :: angle  !< of the criterion at the start [rad]
      real(rk), intent(in) :: open_to, shortest, wanted  !< over the increment [-]
      character(*), intent(in) :: what
      type(sample_t) :: front
      type(timers_t) :: timers
      type(error_t), allocatable :: error
      logical :: any_grew
      real(rk) :: strides(2)

      call start(front, .false.)
      front%rules%shortest = 1.0_rk/16.0_rk
      front%rules%shortest_length = shortest*increment
      front%open_to = open_to*increment
      front%tip(2)%has_wing = .true.
      front%tip(2)%drive = growth_drive_t(intensity=1.0e6_rk, energy=1.0_rk, angle=angle)
      call timers%begin()
      call front%grow_by([0.0_rk, increment], any_grew, timers, error)
      call checks%no_error(error, what)
      call checks%is_close(front%tip(2)%advance, wanted*increment, 1.0e-12_rk, what)
      strides = front%strides()
      call checks%is_close(strides(2), min(1.0_rk, 2.0_rk*wanted)*increment, 1.0e-12_rk, &
                           what//": the next one")
   end subroutine check_shut_end

   !> Two fractures in a square of 2 m; the tips of the first.
   subroutine start(front, joins)
      type(sample_t), intent(out) :: front
      logical, intent(in) :: joins
      integer :: end

      front%network%first = [1_ik, 3_ik, 5_ik]
      front%network%xy = reshape(lines, [2, 4])
      front%network%s_start = [0.0_rk, 0.0_rk]
      front%rules = growth_rules_t(toughness=1.0e6_rk, increment=increment, exponent=0.35_rk, &
                                   together=0.01_rk, reach=0.05_rk, joins=joins, &
                                   outline=reshape([0.0_rk, 0.0_rk, 2.0_rk, 0.0_rk, 2.0_rk, &
                                                    2.0_rk, 0.0_rk, 2.0_rk], [2, 4]))
      allocate (front%tip(2))
      do end = 1, 2
         front%tip(end)%fracture = 1
         front%tip(end)%end = end
         front%tip(end)%xy = lines(:, end, 1)
         front%tip(end)%direction = [2.0_rk*end - 3.0_rk, 0.0_rk]
         front%tip(end)%rosette_radius = radius
      end do
   end subroutine start

   subroutine grow(front, any_grew)
      type(sample_t), intent(inout) :: front
      logical, intent(out) :: any_grew
      type(timers_t) :: timers
      type(error_t), allocatable :: error

      call timers%begin()
      call front%grow_tips(any_grew, timers, error)
      call checks%no_error(error, "growth")
   end subroutine grow

   !> The tip with the largest energy release rate grows by l_max, another tip by l_max (G/max
   !! G)^0.35; each in the direction of its kink.
   subroutine test_growth_law()
      type(sample_t) :: front
      real(rk) :: advance
      logical :: any_grew

      call start(front, .false.)
      front%tip%drive = [growth_drive_t(intensity=0.98e6_rk, energy=40.0_rk, angle=0.3_rk), &
                         growth_drive_t(intensity=0.97e6_rk, energy=10.0_rk, angle=-0.5_rk)]
      call grow(front, any_grew)
      call checks%is_true(.not. any_grew, "nothing grows below the toughness")
      call checks%is_true(front%evaluations == 0, "nothing to evaluate")
      call checks%is_close(total_length(front%network), 2.0_rk, 0.0_rk, "no growth")
      front%tip(1)%drive%intensity = 1.0e6_rk
      call grow(front, any_grew)
      call checks%is_true(any_grew, "growth at the toughness")
      call checks%is_close(front%tip(2)%advance, 0.0_rk, 0.0_rk, "the weaker one stays")
      call checks%is_close(total_length(front%network), 2.0_rk + increment, 1.0e-15_rk, &
                           "one increment")

      call start(front, .false.)
      front%tip%drive = [growth_drive_t(intensity=2.0e6_rk, energy=40.0_rk, angle=0.3_rk), &
                         growth_drive_t(intensity=1.1e6_rk, energy=10.0_rk, angle=-0.5_rk)]
      advance = increment*0.25_rk**0.35_rk
      call grow(front, any_grew)
      call checks%is_true(any_grew, "both grow")
      call checks%is_close(front%tip(1)%advance, increment, 1.0e-15_rk, "the stronger tip: l_max")
      call checks%is_close(front%tip(2)%advance, advance, grains, "the weaker one: less")
      ! Anticlockwise from the direction of the tip.
      call is_at(front%tip(1)%xy, lines(:, 1, 1) - increment*[cos(0.3_rk), sin(0.3_rk)], "tip 1")
      call is_at(front%tip(2)%xy, lines(:, 2, 1) + advance*[cos(0.5_rk), -sin(0.5_rk)], "tip 2")
      call is_at(front%network%xy(:, 1), front%tip(1)%xy, "first vertex")
      call is_at(front%network%xy(:, 4), front%tip(2)%xy, "last vertex")
      call checks%is_true(all(front%network%first == [1_ik, 5_ik, 7_ik]), "vertices in order")
      call checks%is_close(front%network%s_start(1), -increment, 1.0e-15_rk, "arc length")
      call is_at(front%tip(1)%direction, -[cos(0.3_rk), sin(0.3_rk)], "direction of tip 1")
   end subroutine test_growth_law

   !> Tips that head for what lies ahead find their direction before it: half way to fracture 2, but
   !! an increment on where nothing is so near.
   subroutine test_half_way()
      type(sample_t) :: front
      type(timers_t) :: timers
      type(error_t), allocatable :: error
      real(rk), parameter :: gap = 0.04_rk
      logical :: any_grew
      integer :: k

      do k = 1, 2
         call start(front, .false.)
         front%rules%heads = .true.
         front%tip%has_wing = .true.
         ! 1.3 increments below fracture 2, whose tip 1 looks upwards.
         front%network%xy(2, :2) = lines(2, 1, 2) - merge(gap, 2.0_rk*gap, k == 1)
         front%tip(1)%xy = front%network%xy(:, 1)
         front%tip(2)%xy = front%network%xy(:, 2)
         front%tip%drive = growth_drive_t(intensity=2.0e6_rk, energy=40.0_rk)
         front%tip(1)%direction = [0.0_rk, 1.0_rk]
         call timers%begin()
         call front%grow_by([increment, 0.0_rk], any_grew, timers, error)
         call checks%no_error(error, "growth")
         call checks%is_close(front%tip(1)%advance, merge(0.5_rk*gap, increment, k == 1), &
                              1.0e-12_rk, "half way, or an increment")
         call checks%is_true(.not. front%tip(1)%arrested, "it is on its way")
      end do
   end subroutine test_half_way

   !> Growth is over at the given gain: the last increment ends there, and where less than 1.3 of
   !! one are left, they are halved.
   subroutine test_last_increments()
      type(sample_t) :: front
      type(timers_t) :: timers
      type(error_t), allocatable :: error
      real(rk), parameter :: wanted(4) = [0.4_rk, 1.2_rk, 2.0_rk, 2.5_rk]  ! increments
      real(rk), parameter :: steps(3, 4) = reshape([0.4_rk, 0.0_rk, 0.0_rk, 0.6_rk, 0.6_rk, &
                                                    0.0_rk, 1.0_rk, 1.0_rk, 0.0_rk, 1.0_rk, &
                                                    1.0_rk, 0.5_rk], [3, 4])
      logical :: any_grew
      integer :: i, k

      do k = 1, size(wanted)
         call start(front, .true.)
         front%start = front%network
         front%rules%stop_gain = wanted(k)*increment
         front%tip%drive = growth_drive_t(intensity=2.0e6_rk, energy=40.0_rk)
         call timers%begin()
         do i = 1, count(steps(:, k) > 0.0_rk)
            call checks%is_true(.not. any(front%has_gained()), "not yet")
            call front%grow_by([increment, 0.0_rk], any_grew, timers, error)
            call checks%no_error(error, "growth")
            call checks%is_close(front%tip(1)%advance, steps(i, k)*increment, grains, &
                                 "as far as it may")
         end do
         call checks%is_true(all(front%has_gained() .eqv. [.true., .false.]), "the first is there")
         call is_at(front%tip(1)%xy, lines(:, 1, 1) - [wanted(k)*increment, 0.0_rk], "the gain")
      end do
   end subroutine test_last_increments

   !> A tip that joins what lies ahead has its direction found half way to that, by tries there, and
   !! then goes straight on: no target is captured from the side, and no leap is on a direction of
   !! before. The criterion follows circles around the origin.
   subroutine test_joins_ahead()
      type(sample_t) :: front
      type(timers_t) :: timers
      type(error_t), allocatable :: error
      real(rk), parameter :: gap = 0.035_rk
      real(rk) :: along(2), middle(2)
      logical :: any_grew
      integer :: k

      do k = 1, 2
         call start(front, .true.)
         front%rules%heads = .true.
         front%turns = .true.
         front%tip%has_wing = .true.
         ! Upright, 1.3 or 2.6 increments ahead of tip 1 along the circle.
         front%network%xy(1, 3:4) = lines(1, 1, 1) - merge(gap, 2.0_rk*gap, k == 1)
         front%network%xy(2, 3:4) = [0.5_rk, 1.5_rk]
         front%tip(1)%direction = [-0.9_rk, 0.1_rk]/norm2([-0.9_rk, 0.1_rk])
         call timers%begin()
         call front%evaluate(timers, error)
         call front%grow_by([increment, 0.0_rk], any_grew, timers, error)
         call checks%no_error(error, "growth")
         call checks%is_true(front%tip(1)%joined .eqv. (k == 1), "it joins what is that near")
         if (k == 2) cycle
         call checks%is_close(front%tip(1)%xy(1), lines(1, 1, 1) - gap, 1.0e-12_rk, &
                              "on fracture 2")
         ! The direction is that of the circle half way, within what growth_tip asks for.
         middle = 0.5_rk*(front%tip(1)%origin + front%tip(1)%xy)
         along = [-middle(2), middle(1)]/norm2(middle)
         call checks%is_close(dot_product(front%tip(1)%direction, along), 1.0_rk, 1.0e-3_rk, &
                              "in the direction that is right half way")
         call checks%is_true(front%tip(1)%arrested, "no tip any more")
         call is_at(front%network%xy(:, 1), front%tip(1)%xy, "the network's end")
      end do
   end subroutine test_joins_ahead

   subroutine is_at(xy, expected, name)
      real(rk), intent(in) :: xy(2), expected(2)
      character(len=*), intent(in) :: name

      call checks%is_close(maxval(abs(xy - expected)), 0.0_rk, grains, name)
   end subroutine is_at

   !> Drives that differ by rounding only lead to the same tips, bit for bit.
   subroutine test_rounding()
      type(sample_t) :: front(2)
      logical :: any_grew
      integer :: i, k

      do i = 1, 2
         call start(front(i), .false.)
         associate (noise => 1.0_rk + real(i - 1, rk)*1.0e-12_rk)
            front(i)%tip(1)%drive = growth_drive_t(angle=0.3123_rk*noise, intensity=2.0e6_rk, &
                                                   energy=40.0_rk)
            front(i)%tip(2)%drive = growth_drive_t(angle=-0.5123_rk*noise, intensity=2.0e6_rk, &
                                                   energy=10.0_rk*noise)
         end associate
         call grow(front(i), any_grew)
      end do
      do k = 1, 2
         call checks%is_true(all(abs(front(1)%tip(k)%xy - front(2)%tip(k)%xy) <= 0.0_rk), &
                             "the same tip in spite of rounding")
      end do
   end subroutine test_rounding

   !> A tip that a joint has ended has a last state, the one before that, and none afterwards.
   subroutine test_joined_tip()
      type(sample_t) :: front

      call start(front, .true.)
      associate (tip => front%tip(1))
         call tip%begin_increment()
         tip%is_free = .false.
         call checks%is_true(tip%has_state(is_before=.true.), "the state before the joint")
         call checks%is_true(.not. tip%has_state(is_before=.false.), "no tip after the joint")
         call tip%begin_increment()
         call checks%is_true(.not. tip%has_state(is_before=.true.), "no tip in later increments")
      end associate
   end subroutine test_joined_tip

   !> An advance below 0.4 of the rosette's radius waits until there is enough of it.
   subroutine test_carried_growth()
      type(sample_t) :: front
      logical :: any_grew
      real(rk), parameter :: small = 0.3_rk*radius

      call start(front, .false.)
      front%rules%increment = small
      front%tip(1)%drive = growth_drive_t(intensity=2.0e6_rk, energy=40.0_rk)
      call grow(front, any_grew)
      call checks%is_true(.not. any_grew, "too short for the mesh")
      call checks%is_close(front%tip(1)%carried, small, grains, "kept")
      call checks%is_close(total_length(front%network), 2.0_rk, 0.0_rk, "the network waits")
      call grow(front, any_grew)
      call checks%is_true(any_grew, "enough together")
      call checks%is_close(front%tip(1)%carried, 0.0_rk, 0.0_rk, "nothing left")
      call checks%is_close(front%tip(1)%advance, 2.0_rk*small, 1.0e-15_rk, "nothing lost")
      call checks%is_close(total_length(front%network), 2.0_rk + 2.0_rk*small, 1.0e-15_rk, "length")
   end subroutine test_carried_growth

   !> Tip 1 goes left towards the boundary, tip 2 up towards the other fracture, as often as they
   !! grow; straight on after the first kink.
   subroutine grow_far(front)
      type(sample_t), intent(inout) :: front
      logical :: any_grew
      integer :: k

      front%tip%drive = [growth_drive_t(intensity=2.0e6_rk, energy=40.0_rk), &
                         growth_drive_t(intensity=2.0e6_rk, energy=40.0_rk, angle=acos(0.0_rk))]
      do k = 1, 40
         call grow(front, any_grew)
         front%tip(2)%drive%angle = 0.0_rk
         if (.not. any_grew) exit
      end do
      call checks%is_true(.not. any_grew .and. all(front%tip%arrested), "both are arrested")
   end subroutine grow_far

   !> Where tips do not join, they stop before the last increment that would bring them near.
   subroutine test_arrest()
      type(sample_t) :: front
      logical :: any_grew

      call start(front, .false.)
      call grow_far(front)
      ! To the left from x = 0.51 m in steps of 0.03 m, and up from y = 1 m towards y = 1.51 m, as
      ! long as 0.05 m are left.
      call is_at(front%tip(1)%xy, [0.51_rk - 15*increment, 1.0_rk], "before the boundary")
      call is_at(front%tip(2)%xy, [1.51_rk, 1.0_rk + 15*increment], "before the other fracture")
      call checks%is_true(.not. any(front%tip%joined), "nothing is joined")
      call checks%is_true(front%tip(1)%target == target_boundary, "reason: boundary")
      call checks%is_true(front%tip(2)%target == 2, "reason: fracture 2")
      call checks%is_close(total_length(front%network), 2.0_rk + 30*increment, 1.0e-14_rk, &
                           "no vertex was added in vain")
      call checks%is_true(all(front%tip%has_just_stopped()), "both have just stopped")
      call grow(front, any_grew)
      call checks%is_true(.not. any(front%tip%has_just_stopped()), "and not again")
   end subroutine test_arrest

   !> Where tips join, the last increment leads onto the target.
   subroutine test_join()
      type(sample_t) :: front

      call start(front, .true.)
      call grow_far(front)
      call is_at(front%tip(1)%xy, [0.0_rk, 1.0_rk], "on the boundary")
      call is_at(front%tip(2)%xy, [1.51_rk, 1.51_rk], "on the other fracture's end")
      call checks%is_true(all(front%tip%joined), "both have joined")
      call checks%is_close(total_length(front%network), 2.0_rk + 0.51_rk + 0.51_rk, 1.0e-14_rk, &
                           "no gap and no overlap")
   end subroutine test_join

   !> Each increment ends where the criterion leads straight on: along the tangent of the circle at
   !! its end. So by Pythagoras the square of the distance from the origin decreases by that of the
   !! increment, within the two degrees that the loop tolerates.
   subroutine test_path()
      type(sample_t) :: front
      type(timers_t) :: timers
      type(error_t), allocatable :: error
      logical :: any_grew
      real(rk), parameter :: two_degrees = 0.035_rk
      real(rk) :: expected, slack
      integer :: k

      call start(front, .true.)
      front%turns = .true.
      front%rules%outline = 10.0_rk*(front%rules%outline - 1.0_rk)
      front%network%first = [1_ik, 3_ik]
      front%network%xy = reshape([1.0_rk, -0.1_rk, 1.0_rk, 0.0_rk], [2, 2])
      front%tip = front%tip(2:2)
      front%tip(1)%xy = [1.0_rk, 0.0_rk]
      front%tip(1)%direction = [0.0_rk, 1.0_rk]
      front%tip(1)%has_wing = .true.
      call timers%begin()
      call front%evaluate(timers, error)
      slack = 0.0_rk
      do k = 1, 50
         call grow(front, any_grew)
         call checks%is_true(any_grew, "it grows")
         call checks%is_close(front%tip(1)%drive%angle, 0.0_rk, two_degrees, "straight on")
         expected = sqrt(1.0_rk - k*increment**2)
         slack = slack + increment*two_degrees
         call checks%is_close(norm2(front%tip(1)%xy), expected, slack, "distance from the origin")
      end do
      print "(a,es10.2)", "distance from the origin, error: ", norm2(front%tip(1)%xy) - expected
      call checks%is_true(front%evaluations <= 76, "half a correction for each increment at most")
   end subroutine test_path

end program test_growth_front
