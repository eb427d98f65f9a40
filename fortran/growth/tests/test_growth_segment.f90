!> A tip on the last segment of its path: it goes where its excess vanishes, from either side.
program test_growth_segment
   use base_kinds, only: rk
   use growth_segment, only: segment_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks

   call test_bounds()
   call test_rest()
   call test_guesses()
   call checks%finish()

contains

   !> With a ligament at the end of its segment, a tip reaches the end before the ligament, and
   !! breaks it at once.
   subroutine test_rest()
      type(segment_t) :: segment
      logical :: has_moved

      call segment%open_segment([1.0_rk, 0.0_rk], [0.0_rk, 1.0_rk], 0.2_rk)
      call segment%exclude_ligament(0.1_rk)
      call segment%go_to(0.2_rk, has_moved)
      call checks%is_true(has_moved, "goes on")
      call checks%is_true(segment%is_complete(), "all but the rest")
      call checks%is_close(norm2(segment%place() - [1.0_rk, 0.18_rk]), 0.0_rk, 1.0e-15_rk, &
                           "before the rest")
      call segment%finish([1.0_rk, 0.2_rk])
      call checks%is_close(segment%reached, 0.2_rk, 1.0e-15_rk, "the rest as well")
      call checks%is_true(.not. segment%is_open, "nothing is left of it")
   end subroutine test_rest

   !> A step begins at the position that the speed of the last step predicts, and a segment where
   !! the excess left at the end of the previous one vanishes; neither beyond the ends of the
   !! segment, and only if these are known.
   subroutine test_guesses()
      type(segment_t) :: segment
      logical :: has_moved

      call segment%open_segment([0.0_rk, 0.0_rk], [1.0_rk, 0.0_rk], 1.0_rk)
      associate (least => segment%lowest())
         call segment%keep_pace(10.0_rk)
         call checks%is_close(segment%reached, least, 0.0_rk, "no speed is known")
         call segment%set_out(0.2_rk)
         call checks%is_close(segment%reached, least, 0.0_rk, "no slope is known")
      end associate
      call segment%go_to(0.3_rk, has_moved)
      segment%slope = -0.2_rk
      call segment%accept()
      call segment%pace(0.3_rk, 2.0_rk, is_driven=.true.)
      call segment%keep_pace(1.0_rk)
      call checks%is_close(segment%reached, 0.45_rk, 1.0e-15_rk, "as fast as before")
      call segment%keep_pace(10.0_rk)
      call checks%is_close(segment%reached, 1.0_rk, 0.0_rk, "no farther than the piece")
      call checks%is_close(segment%farther(10.0_rk, 0.7_rk), 0.8_rk, 1.0e-15_rk, "it would go on")
    call checks%is_close(segment%farther(1.0_rk, 0.7_rk), -0.55_rk, 1.0e-15_rk, "does not reach it")
      call segment%set_out_to(0.8_rk)
      call checks%is_close(segment%reached, 0.8_rk, 0.0_rk, "that far")
      call segment%set_out_to(-0.55_rk)
      call checks%is_close(segment%reached, 0.3_rk, 0.0_rk, "not behind the accepted position")
      call segment%pace(-0.1_rk, 1.0_rk, is_driven=.true.)
      call segment%keep_pace(1.0_rk)
      call checks%is_close(segment%reached, 0.3_rk, 1.0e-15_rk, "never back")
      call segment%pace(0.3_rk, 2.0_rk, is_driven=.false.)
      call segment%keep_pace(1.0_rk)
      call checks%is_close(segment%reached, 0.3_rk, 1.0e-15_rk, "not driven there: no speed")
      call segment%open_segment([1.0_rk, 0.0_rk], [0.0_rk, 1.0_rk], 1.0_rk)
      call segment%set_out(0.1_rk)
      call checks%is_close(segment%reached, 0.5_rk, 1.0e-15_rk, "where the excess vanishes")
      call checks%is_close(segment%falling_slope(), -0.2_rk, 0.0_rk, "slope as known")
      segment%slope = 0.3_rk
      call checks%is_close(segment%falling_slope(), -0.1_rk, 0.0_rk, "slope that does not fall")
   end subroutine test_guesses

   !> Below the toughness a tip retreats no farther than its accepted position; far above it, the
   !! tip reaches the end of its segment, which is then complete.
   subroutine test_bounds()
      type(segment_t) :: segment, twin
      logical :: has_moved

      call segment%open_segment([0.0_rk, 0.0_rk], [1.0_rk, 0.0_rk], 0.01_rk)
      call segment%go_to(0.004_rk, has_moved)
      call checks%is_true(has_moved, "goes on")
      call segment%accept()
      call segment%go_to(0.001_rk, has_moved)
      call checks%is_close(segment%reached, segment%accepted, 0.0_rk, "never back")
      call segment%go_to(1.0_rk, has_moved)
      call segment%go_to(1.0_rk, has_moved)
      call checks%is_true(segment%is_complete() .and. .not. has_moved, "complete")
      twin = segment_t(is_open=.true., length=2.0_rk*segment%length)
      call twin%keep_up_with(segment, has_moved)
      call checks%is_true(has_moved, "has to go to be as far along")
      call checks%is_close(twin%reached, 2.0_rk*segment%reached, 0.0_rk, "as far along")
      call checks%is_true(twin%is_complete(), "and at its end as well")
      call twin%accept()
      twin%is_open = .true.
      call twin%keep_up_with(segment_t(is_open=.true., length=1.0_rk, reached=0.2_rk), has_moved)
      call checks%is_true(.not. has_moved, "stays where it is")
      call checks%is_close(twin%reached, twin%length, 0.0_rk, "never back")
      call segment%accept()
      call checks%is_true(.not. segment%is_open, "over")
      call checks%is_close(segment%reached, segment%length, 0.0_rk, "all behind the tip")
   end subroutine test_bounds

end program test_growth_segment
