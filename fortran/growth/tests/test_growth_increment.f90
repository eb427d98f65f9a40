!> One increment of growth of many tips.
program test_growth_increment
   use base_kinds, only: ik, rk
   use growth_increment, only: plan_increment, tips_at_onset
   use growth_network, only: move_end
   use growth_tip, only: tip_t
   use mesh_types, only: network_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: exact = 1.0e-14_rk
   type(checks_t) :: checks

   call test_onset()
   call test_plan()
   call test_move_end()
   call checks%finish()

contains

   !> Four tips that point along x, driven by 1, 2, 4 and 8 J/m2 and intensities of 1 to 4.
   function four_tips() result(tips)
      type(tip_t) :: tips(4)
      integer(ik) :: i

      do i = 1, 4
         tips(i)%xy = [real(i, rk), 0.0_rk]
         tips(i)%direction = [1.0_rk, 0.0_rk]
         tips(i)%drive%intensity = real(i, rk)
         tips(i)%drive%energy = 2.0_rk**(i - 1)
         tips(i)%advance = 7.0_rk
         tips(i)%rosette_radius = 0.2_rk
      end do
      tips(4)%arrested = .true.
   end function four_tips

   !> An arrested tip does not grow, whatever its driving force; other tips grow along only where
   !! one grows.
   subroutine test_onset()
      logical, parameter :: at_three(4) = [.false., .false., .true., .false.]
      logical, parameter :: along(4) = [.false., .true., .true., .false.]
      type(tip_t) :: tips(4)

      tips = four_tips()
      call checks%is_true(all(tips_at_onset(tips, 3.0_rk, 0.1_rk) .eqv. at_three), &
                          "at its toughness")
      call checks%is_true(all(tips_at_onset(tips, 3.0_rk, 0.4_rk) .eqv. along), "and nearly there")
      call checks%is_true(.not. any(tips_at_onset(tips, 3.5_rk, 0.5_rk)), "none at a larger one")
   end subroutine test_onset

   !> The tip with the largest energy release rate advances by l_max, another tip by (G/max
   !! G)**exponent of l_max; advances too short for the mesh are carried over until their sum is
   !! long enough.
   subroutine test_plan()
      type(tip_t) :: tips(4)
      real(rk) :: advance(4)
      logical, parameter :: grows(4) = [.true., .true., .true., .false.]

      tips = four_tips()
      call tips%begin_increment()
      call checks%is_close(maxval(tips%advance), 0.0_rk, 0.0_rk, "nothing has grown yet")
      call checks%is_close(tips(3)%drive_before%energy, 4.0_rk, 0.0_rk, "drive before")
      ! A quarter of 0.2 m for the first tip: below 0.4 of a radius of 0.2 m.
      call plan_increment(tips, grows, spread(0.2_rk, 1, size(tips)), 1.0_rk, advance)
      call checks%is_close(maxval(abs(advance - [0.0_rk, 0.1_rk, 0.2_rk, 0.0_rk])), 0.0_rk, exact, &
                           "advances as the energies")
      call checks%is_close(tips(1)%carried, 0.05_rk, exact, "carried over")
      call plan_increment(tips, grows, spread(0.2_rk, 1, size(tips)), 1.0_rk, advance)
      call checks%is_close(advance(1), 0.1_rk, exact, "two short advances make one")
      call checks%is_close(tips(1)%carried, 0.0_rk, 0.0_rk, "nothing left")
      call plan_increment(tips, grows .and. .false., spread(0.2_rk, 1, size(tips)), 1.0_rk, advance)
      call checks%is_close(maxval(advance), 0.0_rk, 0.0_rk, "none at its toughness")
   end subroutine test_plan

   !> Both ends of the second of two fractures.
   subroutine test_move_end()
      type(network_t) :: network

      network%first = [1_ik, 3_ik, 6_ik]
      network%s_start = [0.0_rk, 0.0_rk]
      network%xy = reshape([0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 0.0_rk, 1.0_rk, 1.0_rk, 1.0_rk, &
                            2.0_rk, 1.0_rk], [2, 5])
      call move_end(network, 2_ik, 1_ik, [-1.0_rk, 3.0_rk])
      call move_end(network, 2_ik, 2_ik, [4.0_rk, 5.0_rk])
      call checks%is_close(norm2(network%xy(:, 3) - [-1.0_rk, 3.0_rk]), 0.0_rk, 0.0_rk, "start")
      call checks%is_close(norm2(network%xy(:, 5) - [4.0_rk, 5.0_rk]), 0.0_rk, 0.0_rk, "end")
      call checks%is_close(norm2(network%xy(:, 4) - [1.0_rk, 1.0_rk]), 0.0_rk, 0.0_rk, "between")
      ! The first segment had a length of 1, and has sqrt(8): the arc length of the vertex after it
      ! stays.
      call checks%is_close(network%s_start(2), 1.0_rk - sqrt(8.0_rk), exact, "arc length")
   end subroutine test_move_end

end program test_growth_increment
