!> How often new segments are halved.
program test_growth_rules
   use base_kinds, only: rk
   use growth_rules, only: growth_rules_t
   use growth_tip, only: tip_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: sliding = 1.23_rk  ! kink angle [rad]
   type(checks_t) :: checks
   type(growth_rules_t) :: rules

   rules%toughness = 2.0_rk
   rules%increment = 1.6_rk
   rules%shortest = 1.0_rk/16.0_rk
   call first_segments()
   call later_segments()
   call checks%finish()

contains

   !> K_eq is to be half of the toughness, and falls with the root of the length.
   subroutine first_segments()
      type(tip_t) :: tip

      tip%kink = sliding
      tip%advance = rules%increment
      tip%drive%angle = sliding
      tip%drive_before%intensity = 2.0_rk
      tip%drive%intensity = 0.9_rk
      call checks%is_true(rules%halvings(tip) == 1, "a little too long")
      tip%drive%intensity = 0.49_rk
      call checks%is_true(rules%halvings(tip) == 2, "a quarter is as long as it may be")
      tip%drive%intensity = 0.36_rk
      call checks%is_true(rules%halvings(tip) == 2, "an eighth is shorter than needed")
      tip%drive%intensity = 0.0_rk
      call checks%is_true(rules%halvings(tip) == 2, "shut: a quarter")
      tip%drive%intensity = 0.01_rk
      call checks%is_true(rules%halvings(tip) == 4, "hardly open: the shortest")
      tip%advance = rules%increment/8.0_rk
      call checks%is_true(rules%halvings(tip) == 1, "no shorter than the shortest")
      tip%advance = rules%increment/16.0_rk
      call checks%is_true(rules%halvings(tip) == 0, "the shortest is not halved")
      tip%advance = rules%increment
      tip%drive%intensity = 1.5_rk
      call checks%is_true(rules%halvings(tip) == 1, "it turns farther")
      tip%drive%angle = 0.3_rk
      call checks%is_true(rules%halvings(tip) == 0, "long enough")
   end subroutine first_segments

   !> A later segment counts where it turns far, and K_eq at its end is small.
   subroutine later_segments()
      type(tip_t) :: tip

      tip%has_wing = .true.
      tip%advance = rules%increment
      tip%drive_before%intensity = 2.0_rk
      tip%drive_before%angle = 0.3_rk
      tip%drive%intensity = 0.1_rk
      call checks%is_true(rules%halvings(tip) == 0, "hardly turned")
      tip%drive_before%angle = 0.9_rk
      call checks%is_true(rules%halvings(tip) == 4, "far too long")
   end subroutine later_segments

end program test_growth_rules
