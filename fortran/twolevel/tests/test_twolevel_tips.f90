!> Tips: which of them grow and how far, what stops them, what the coarse level learns of it, and
!! the direction that a small scene's tips settle for.
program test_twolevel_tips
   use testing_checks, only: checks_t
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use coarse_state, only: step_report_t
   use mesh_types, only: network_t
   use sample_bodies, only: straight_network
   use sample_scenes, only: add_fracture, squeezed_body
   use scene_types, only: scene_t
   use tips_growth, only: growth_drive_t
   use tips_network, only: end_gain, total_length
   use twolevel_simulation, only: simulation_t
   use twolevel_tips, only: tips_t
   implicit none(type, external)

   real(rk), parameter :: radius = 0.025_rk  !< of the rosettes [m]
   real(rk), parameter :: increment = 0.03_rk  !< l_max [m]
   !> Fracture 1 with two tips that grow here, fracture 2 above it.
   real(rk), parameter :: lines(2, 2, 2) = reshape([0.51_rk, 1.0_rk, 1.51_rk, 1.0_rk, 0.51_rk, &
                                                    1.51_rk, 1.51_rk, 1.51_rk], [2, 2, 2])
   type(checks_t) :: checks

   call test_growth_law()
   call test_carried_growth()
   call test_arrest()
   call test_hand_over()
   call test_threshold()
   call test_correction()
   call checks%finish()

contains

   !> A body with two fractures; the tips of the first, as if windows had been built around them.
   subroutine start(scene, tips)
      type(scene_t), intent(out) :: scene
      type(tips_t), intent(out) :: tips
      integer :: end

      scene = squeezed_body(20.0e6_rk, 10.0e6_rk)
      scene%material%toughness = 1.0e6_rk
      call add_fracture(scene, "low", lines(1, :, 1), lines(2, :, 1), 0.5_rk, 0.0_rk)
      call add_fracture(scene, "high", lines(1, :, 2), lines(2, :, 2), 0.5_rk, 0.0_rk)
      tips%network = straight_network(lines)
      allocate (tips%tip(2), tips%window(2))
      allocate (tips%built(2), tips%projected(2), source=.false.)
      do end = 1, 2
         tips%tip(end)%fracture = 1
         tips%tip(end)%end = end
         tips%tip(end)%xy = lines(:, end, 1)
         tips%tip(end)%direction = [2.0_rk*end - 3.0_rk, 0.0_rk]
         tips%window(end)%tip = 1
         tips%window(end)%mesh%fracture%tip_radius = [radius]
      end do
   end subroutine start

   !> The tip with the largest energy release rate grows by l_max, another one by
   !! l_max (G/max G)^0.35; each in the direction of its own kink.
   subroutine test_growth_law()
      type(scene_t) :: scene
      type(tips_t) :: tips
      real(rk) :: advance
      logical :: any_grew

      call start(scene, tips)
      tips%tip%drive = [growth_drive_t(intensity=0.98e6_rk, energy=40.0_rk, angle=0.3_rk), &
                        growth_drive_t(intensity=0.97e6_rk, energy=10.0_rk, angle=-0.5_rk)]
      call tips%grow(scene, increment, any_grew)
      call checks%is_true(.not. any_grew, "nothing grows below the toughness")
      call checks%is_close(total_length(tips%network), 2.0_rk, 0.0_rk, "no growth")
      tips%tip(1)%drive%intensity = 1.0e6_rk
      call tips%grow(scene, increment, any_grew)
      call checks%is_true(any_grew, "growth at the toughness")
      call checks%is_close(tips%tip(2)%advance, 0.0_rk, 0.0_rk, "the weaker one stays")
      call checks%is_close(total_length(tips%network), 2.0_rk + increment, 1.0e-15_rk, &
                           "one increment")

      call start(scene, tips)
      tips%tip%drive = [growth_drive_t(intensity=2.0e6_rk, energy=40.0_rk, angle=0.3_rk), &
                        growth_drive_t(intensity=1.1e6_rk, energy=10.0_rk, angle=-0.5_rk)]
      advance = increment*0.25_rk**0.35_rk
      call tips%grow(scene, increment, any_grew)
      call checks%is_true(any_grew, "both grow")
      call checks%is_close(tips%tip(1)%advance, increment, 1.0e-15_rk, "the stronger tip: l_max")
      call checks%is_close(tips%tip(2)%advance, advance, 1.0e-15_rk, "the weaker one: less")
      ! Anticlockwise from the tip's own direction.
      call is_at(tips%tip(1)%xy, lines(:, 1, 1) - increment*[cos(0.3_rk), sin(0.3_rk)], "tip 1")
      call is_at(tips%tip(2)%xy, lines(:, 2, 1) + advance*[cos(0.5_rk), -sin(0.5_rk)], "tip 2")
      call is_at(tips%network%xy(:, 1), tips%tip(1)%xy, "first vertex")
      call is_at(tips%network%xy(:, 4), tips%tip(2)%xy, "last vertex")
      call checks%is_true(all(tips%network%first == [1_ik, 5_ik, 7_ik]), "vertices in order")
      call checks%is_close(tips%network%s_start(1), -increment, 1.0e-15_rk, "arc length")
      call is_near(tips%tip(1)%direction, -[cos(0.3_rk), sin(0.3_rk)], "direction of tip 1")
      call checks%is_true(all(tips%tip%pending_vertices == 1), "pending vertices")
      call checks%is_close(sum(tips%tip%pending), increment + advance, 1.0e-15_rk, "pending growth")
   end subroutine test_growth_law

   subroutine is_at(xy, expected, name)
      real(rk), intent(in) :: xy(2), expected(2)
      character(len=*), intent(in) :: name

      call checks%is_close(maxval(abs(xy - expected)), 0.0_rk, 1.0e-15_rk, name)
   end subroutine is_at

   !> An advance below 0.4 of the rosette's radius waits until there is enough of it.
   subroutine test_carried_growth()
      type(scene_t) :: scene
      type(tips_t) :: tips
      logical :: any_grew
      real(rk), parameter :: small = 0.3_rk*radius

      call start(scene, tips)
      tips%tip(1)%drive = growth_drive_t(intensity=2.0e6_rk, energy=40.0_rk)
      call tips%grow(scene, small, any_grew)
      call checks%is_true(.not. any_grew, "too short for the mesh")
      call checks%is_close(tips%tip(1)%carried, small, 0.0_rk, "kept")
      call checks%is_close(total_length(tips%network), 2.0_rk, 0.0_rk, "the network waits")
      call tips%grow(scene, small, any_grew)
      call checks%is_true(any_grew, "enough together")
      call checks%is_close(tips%tip(1)%carried, 0.0_rk, 0.0_rk, "nothing left")
      call checks%is_close(tips%tip(1)%advance, 2.0_rk*small, 1.0e-15_rk, "nothing lost")
      call checks%is_close(total_length(tips%network), 2.0_rk + 2.0_rk*small, 1.0e-15_rk, "length")
   end subroutine test_carried_growth

   !> A tip stops before it comes nearer to the boundary or to another fracture than a coarse cell.
   subroutine test_arrest()
      type(scene_t) :: scene
      type(tips_t) :: tips
      logical :: any_grew
      integer :: k

      call start(scene, tips)
      tips%tip%drive = [growth_drive_t(intensity=2.0e6_rk, energy=40.0_rk), &
                        growth_drive_t(intensity=2.0e6_rk, energy=40.0_rk, angle=acos(0.0_rk))]
      do k = 1, 40
         call tips%grow(scene, increment, any_grew)
         tips%tip(2)%drive%angle = 0.0_rk
         if (.not. any_grew) exit
      end do
      call checks%is_true(.not. any_grew .and. all(tips%tip%arrested), "both are arrested")
      ! To the left from x = 0.51 m in steps of 0.03 m, and up from y = 1 m towards y = 1.51 m, as
      ! long as 0.05 m are left.
      call is_near(tips%tip(1)%xy, [0.51_rk - 15*increment, 1.0_rk], "before the boundary")
      call is_near(tips%tip(2)%xy, [1.51_rk, 1.0_rk + 15*increment], "before the other fracture")
      if (allocated(tips%tip(1)%arrest_reason)) then
         call checks%is_true(index(tips%tip(1)%arrest_reason, "boundary") > 0, "reason: boundary")
      end if
      if (allocated(tips%tip(2)%arrest_reason)) then
         call checks%is_true(index(tips%tip(2)%arrest_reason, "high") > 0, &
                             "reason: fracture, by name")
      end if
      call checks%is_true(allocated(tips%tip(1)%arrest_reason) &
                          .and. allocated(tips%tip(2)%arrest_reason), "reasons are given")
      call checks%is_close(total_length(tips%network), 2.0_rk + 30*increment, 1.0e-14_rk, &
                           "no vertex was added in vain")
   end subroutine test_arrest

   subroutine is_near(xy, expected, name)
      real(rk), intent(in) :: xy(2), expected(2)
      character(len=*), intent(in) :: name

      call checks%is_close(maxval(abs(xy - expected)), 0.0_rk, 1.0e-13_rk, name)
   end subroutine is_near

   !> Both ends grow by two kinked increments: the coarse level gets one segment for each, and the
   !! fine network becomes the same, arc lengths included.
   subroutine test_hand_over()
      type(scene_t) :: scene
      type(tips_t) :: tips
      type(network_t) :: coarse
      real(rk), allocatable :: centres(:, :)
      real(rk) :: gain
      integer :: k
      logical :: any_grew

      call start(scene, tips)
      coarse = tips%network
      do k = 1, 2
         tips%tip%drive = [growth_drive_t(intensity=2.0e6_rk, energy=40.0_rk, &
                                          angle=0.3_rk*(3 - 2*k)), &
                           growth_drive_t(intensity=2.0e6_rk, energy=40.0_rk, angle=0.6_rk)]
         call tips%grow(scene, increment, any_grew)
      end do
      call tips%hand_over(2.0_rk*increment, coarse, centres)
      call checks%is_true(size(centres, 2) == 2, "both ends")
      call is_at(centres(:, 1), tips%tip(1)%xy, "place of change 1")
      call is_at(centres(:, 2), tips%tip(2)%xy, "place of change 2")
      call compare(tips%network, coarse)
      call checks%is_true(all(coarse%first == [1_ik, 5_ik, 7_ik]), "one vertex for each end")
      ! Tip 1 turned by 0.3 and back: its segments are 0.3 apart in direction. Tip 2 turned twice.
      gain = 2.0_rk*increment*cos(0.15_rk)
      call checks%is_close(coarse%s_start(1), -gain, 1.0e-14_rk, "arc length of the new start")
      call checks%is_close(end_gain(coarse, straight_network(lines), 1_ik, 1_ik), gain, &
                           1.0e-14_rk, "gain of the start")
      call checks%is_close(end_gain(coarse, straight_network(lines), 1_ik, 2_ik), &
                           2.0_rk*increment*cos(0.3_rk), 1.0e-14_rk, "gain of the end")
      call is_near(tips%tip(1)%direction, -[cos(0.15_rk), sin(0.15_rk)], "direction of the start")
      call is_near(tips%tip(2)%direction, [cos(0.9_rk), sin(0.9_rk)], "direction of the end")
      call checks%is_close(maxval(abs(tips%tip%pending)), 0.0_rk, 0.0_rk, "nothing pending")
      call checks%is_true(all(tips%tip%pending_vertices == 0), "no vertex pending")
      ! And on from there.
      tips%tip%drive = [growth_drive_t(intensity=2.0e6_rk, energy=40.0_rk), &
                        growth_drive_t(intensity=2.0e6_rk, energy=40.0_rk)]
      call tips%grow(scene, 2.0_rk*increment, any_grew)
      call tips%hand_over(2.0_rk*increment, coarse, centres)
      call compare(tips%network, coarse)
      call checks%is_close(coarse%s_start(1), -gain - 2.0_rk*increment, 1.0e-14_rk, &
                           "arc length again")
   end subroutine test_hand_over

   !> No difference between two networks but rounding of arc lengths.
   subroutine compare(a, b)
      type(network_t), intent(in) :: a, b

      call checks%is_true(size(a%xy, 2) == size(b%xy, 2), "as many vertices")
      if (size(a%xy, 2) /= size(b%xy, 2)) return
      call checks%is_true(all(a%first == b%first), "vertices of each fracture")
      call checks%is_close(maxval(abs(a%xy - b%xy)), 0.0_rk, 0.0_rk, "places of vertices")
      call checks%is_close(maxval(abs(a%s_start - b%s_start)), 0.0_rk, 1.0e-14_rk, "arc lengths")
   end subroutine compare

   !> Nothing is handed over below the threshold; then a tip with at least half of it goes along,
   !! one with less stays pending.
   subroutine test_threshold()
      type(scene_t) :: scene
      type(tips_t) :: tips
      type(network_t) :: coarse
      real(rk), allocatable :: centres(:, :)
      logical :: any_grew

      call start(scene, tips)
      coarse = tips%network
      tips%tip%drive = [growth_drive_t(intensity=2.0e6_rk, energy=40.0_rk), &
                        growth_drive_t(intensity=1.1e6_rk, energy=5.0_rk)]
      call tips%grow(scene, increment, any_grew)
      call tips%hand_over(1.001_rk*increment, coarse, centres)
      call checks%is_true(size(centres, 2) == 0, "below the threshold")
      call checks%is_close(total_length(coarse), 2.0_rk, 0.0_rk, "the coarse network waits")
      ! (1/8)^0.35 = 0.483: less than half.
      call tips%hand_over(increment, coarse, centres)
      call checks%is_true(size(centres, 2) == 1, "at the threshold: one tip")
      call checks%is_close(total_length(coarse), 2.0_rk + increment, 1.0e-15_rk, "its growth")
      call checks%is_close(tips%tip(2)%pending, increment*0.125_rk**0.35_rk, 1.0e-15_rk, &
                           "still pending")
      call checks%is_close(total_length(tips%network), 2.0_rk &
                           + increment*(1.0_rk + 0.125_rk**0.35_rk), 1.0e-15_rk, &
                           "the fine network is ahead")
      tips%tip(1)%drive%intensity = 0.0_rk
      call tips%grow(scene, increment, any_grew)
      call tips%hand_over(increment, coarse, centres)
      call checks%is_true(size(centres, 2) == 1, "then the other one")
      call compare_lengths(tips%network, coarse)
   end subroutine test_threshold

   subroutine compare_lengths(a, b)
      type(network_t), intent(in) :: a, b

      call checks%is_close(total_length(a), total_length(b), 1.0e-14_rk, "lengths")
      call compare(a, b)
   end subroutine compare_lengths

   !> Wings of a sliding fracture: the first kink is that of the criterion, later increments end
   !! where the criterion says straight on, within two degrees.
   subroutine test_correction()
      type(scene_t) :: scene
      type(simulation_t) :: simulation
      type(timers_t) :: timers
      type(step_report_t) :: report
      type(error_t), allocatable :: error
      integer :: i, k
      logical :: any_grew

      scene = squeezed_body(20.0e6_rk, 4.0e6_rk)
      scene%material%toughness = 0.3e6_rk
      scene%growth%enabled = .true.
      call add_fracture(scene, "slider", [0.8_rk, 1.2_rk], [0.85_rk, 1.15_rk], 0.2_rk, 0.0_rk)
      call simulation%begin(scene, timers, error)
      call checks%no_error(error, "begin")
      call simulation%equilibrate(timers, report, error)
      call simulation%evaluate_tips(timers, error)
      call checks%no_error(error, "tips")
      do k = 1, 3
         call simulation%grow_tips(increment, any_grew, timers, error)
         call checks%no_error(error, "growth")
         call checks%is_true(any_grew, "the slider grows wings")
         do i = 1, 2
            associate (tip => simulation%tips%tip(i))
               call checks%is_close(tip%advance, increment, 0.02_rk*increment, "advance of a wing")
               if (k == 1) then
                  call checks%is_close(tip%kink, tip%drive_before%angle, 1.0e-12_rk, "first kink")
               else
                  call checks%is_close(tip%drive%angle, 0.0_rk, 0.0350001_rk, "straight on")
               end if
               call is_near(simulation%tips%network%xy(:, &
                                                       merge(simulation%tips%network%first(1), &
                                                             simulation%tips%network%first(2) &
                                                             - 1, tip%end == 1)), tip%xy, &
                            "tip in the network")
            end associate
         end do
      end do
   end subroutine test_correction

end program test_twolevel_tips
