!> Growth passed to the coarse level, and the direction of growth in a small scene.
program test_twolevel_handover
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use coarse_state, only: step_report_t
   use growth_law, only: new_tip
   use growth_network, only: end_gain, extend, total_length
   use growth_tip, only: tip_t
   use mesh_types, only: network_t
   use sample_bodies, only: straight_network
   use sample_scenes, only: add_fracture, squeezed_body
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   use twolevel_state, only: two_levels_t
   use twolevel_transfer, only: hand_over
   implicit none(type, external)

   real(rk), parameter :: increment = 0.03_rk  !< l_max [m]
   !> Fracture 1 with two tips that grow here, fracture 2 above it.
   real(rk), parameter :: lines(2, 2, 2) = reshape([0.51_rk, 1.0_rk, 1.51_rk, 1.0_rk, 0.51_rk, &
                                                    1.51_rk, 1.51_rk, 1.51_rk], [2, 2, 2])
   type(checks_t) :: checks

   call test_hand_over()
   call test_threshold()
   call test_correction()
   call checks%finish()

contains

   !> Two fractures, and the tips of the first.
   subroutine start(network, tips)
      type(network_t), intent(out) :: network
      type(tip_t), intent(out) :: tips(2)
      integer :: end

      network = straight_network(lines)
      do end = 1, 2
         tips(end)%fracture = 1
         tips(end)%end = end
         tips(end)%xy = lines(:, end, 1)
         tips(end)%direction = [2.0_rk*end - 3.0_rk, 0.0_rk]
      end do
   end subroutine start

   subroutine grow(network, tip, kink, advance)
      type(network_t), intent(inout) :: network
      type(tip_t), intent(inout) :: tip
      real(rk), intent(in) :: kink  !< anticlockwise [rad]
      real(rk), intent(in) :: advance  !< [m]
      real(rk) :: to(2)

      to = new_tip(tip%xy, tip%direction, kink, advance)
      call extend(network, tip%fracture, tip%end, to)
      call tip%move(to, kink)
   end subroutine grow

   subroutine is_at(xy, expected, name)
      real(rk), intent(in) :: xy(2), expected(2)
      character(len=*), intent(in) :: name

      call checks%is_close(maxval(abs(xy - expected)), 0.0_rk, 1.0e-13_rk, name)
   end subroutine is_at

   !> Both ends grow by two kinked increments: the coarse level gets one segment for each end, and
   !! the fine network becomes the same, arc lengths included.
   subroutine test_hand_over()
      type(network_t) :: network, coarse
      type(tip_t) :: tips(2)
      real(rk), allocatable :: centres(:, :)
      real(rk) :: gain
      integer :: k
      logical :: is_straightened

      call start(network, tips)
      coarse = network
      do k = 1, 2
         call grow(network, tips(1), 0.3_rk*(3 - 2*k), increment)
         call grow(network, tips(2), 0.6_rk, increment)
      end do
      call hand_over(1.9_rk*increment, network, tips, coarse, centres, is_straightened)
      call checks%is_true(size(centres, 2) == 2, "both ends")
      call checks%is_true(is_straightened, "the fine network is another one")
      call is_at(centres(:, 1), tips(1)%xy, "place of change 1")
      call is_at(centres(:, 2), tips(2)%xy, "place of change 2")
      call compare(network, coarse)
      call checks%is_true(all(coarse%first == [1_ik, 5_ik, 7_ik]), "one vertex for each end")
      ! Tip 1 has turned by 0.3 and back: the directions of its segments differ by 0.3. Tip 2 has
      ! turned twice.
      gain = 2.0_rk*increment*cos(0.15_rk)
      call checks%is_close(coarse%s_start(1), -gain, 1.0e-14_rk, "arc length of the new start")
      call checks%is_close(end_gain(coarse, straight_network(lines), 1_ik, 1_ik), gain, &
                           1.0e-14_rk, "gain of the start")
      call checks%is_close(end_gain(coarse, straight_network(lines), 1_ik, 2_ik), &
                           2.0_rk*increment*cos(0.3_rk), 1.0e-14_rk, "gain of the end")
      call is_at(tips(1)%direction, -[cos(0.15_rk), sin(0.15_rk)], "direction of the start")
      call is_at(tips(2)%direction, [cos(0.9_rk), sin(0.9_rk)], "direction of the end")
      ! Further growth.
      do k = 1, 2
         call grow(network, tips(k), 0.0_rk, 2.0_rk*increment)
      end do
      call hand_over(2.0_rk*increment, network, tips, coarse, centres, is_straightened)
      call checks%is_true(.not. is_straightened, "one segment each is straight")
      call compare(network, coarse)
      call checks%is_close(coarse%s_start(1), -gain - 2.0_rk*increment, 1.0e-14_rk, &
                           "arc length again")
   end subroutine test_hand_over

   !> Two networks are equal within rounding of arc lengths.
   subroutine compare(a, b)
      type(network_t), intent(in) :: a, b

      call checks%is_true(size(a%xy, 2) == size(b%xy, 2), "as many vertices")
      if (size(a%xy, 2) /= size(b%xy, 2)) return
      call checks%is_true(all(a%first == b%first), "vertices of each fracture")
      call checks%is_close(maxval(abs(a%xy - b%xy)), 0.0_rk, 0.0_rk, "places of vertices")
      call checks%is_close(maxval(abs(a%s_start - b%s_start)), 0.0_rk, 1.0e-14_rk, "arc lengths")
      call checks%is_close(total_length(a), total_length(b), 1.0e-14_rk, "lengths")
   end subroutine compare

   !> No growth is passed on below the threshold; at the threshold a tip with at least half of it is
   !! included, a tip with less stays pending.
   subroutine test_threshold()
      type(network_t) :: network, coarse
      type(tip_t) :: tips(2)
      real(rk), allocatable :: centres(:, :)
      logical :: is_straightened
      real(rk), parameter :: less = 0.48_rk  ! share of the increment [-]

      call start(network, tips)
      coarse = network
      call grow(network, tips(1), 0.0_rk, increment)
      call grow(network, tips(2), 0.0_rk, less*increment)
      call hand_over(1.001_rk*increment, network, tips, coarse, centres, is_straightened)
      call checks%is_true(size(centres, 2) == 0, "below the threshold")
      call checks%is_close(total_length(coarse), 2.0_rk, 0.0_rk, "the coarse network waits")
      call hand_over(increment, network, tips, coarse, centres, is_straightened)
      call checks%is_true(size(centres, 2) == 1, "at the threshold: one tip")
      call checks%is_close(total_length(coarse), 2.0_rk + increment, 1.0e-15_rk, "its growth")
      call checks%is_close(total_length(network), 2.0_rk + increment*(1.0_rk + less), 1.0e-15_rk, &
                           "the fine network is ahead")
      call grow(network, tips(2), 0.0_rk, increment)
      call hand_over(increment, network, tips, coarse, centres, is_straightened)
      call checks%is_true(size(centres, 2) == 1, "then the other one")
      call compare(network, coarse)
   end subroutine test_threshold

   !> Wings of a sliding fracture: the first kink is that of the criterion; later increments end
   !! where the criterion leads straight on, within two degrees.
   subroutine test_correction()
      type(scene_t) :: scene
      type(two_levels_t), save :: simulation
      type(timers_t) :: timers
      type(step_report_t) :: report
      type(error_t), allocatable :: error
      integer :: i, k
      logical :: any_grew

      scene = squeezed_body(20.0e6_rk, 4.0e6_rk)
      scene%material%toughness = 0.3e6_rk
      scene%growth%enabled = .true.
      scene%growth%increment = increment
      call add_fracture(scene, "slider", [0.8_rk, 1.2_rk], [0.85_rk, 1.15_rk], 0.2_rk, 0.0_rk)
      call simulation%begin(scene, timers, error)
      call checks%no_error(error, "begin")
      call simulation%equilibrate(timers, report, error)
      call simulation%evaluate(timers, error)
      call checks%no_error(error, "tips")
      do k = 1, 3
         call simulation%grow_tips(any_grew, timers, error)
         call checks%no_error(error, "growth")
         call checks%is_true(any_grew, "the slider grows wings")
         do i = 1, 2
            associate (tip => simulation%tip(i), network => simulation%network)
               call checks%is_close(tip%advance, increment, 0.02_rk*increment, "advance of a wing")
               if (k == 1) then
                  call checks%is_close(tip%kink, tip%drive_before%angle, 1.0e-7_rk, "first kink")
               else
                  call checks%is_close(tip%drive%angle, 0.0_rk, 0.0350001_rk, "straight on")
               end if
               call is_at(network%xy(:, merge(network%first(1), network%first(2) - 1, &
                                              tip%end == 1)), tip%xy, "tip in the network")
            end associate
         end do
      end do
   end subroutine test_correction

end program test_twolevel_handover
