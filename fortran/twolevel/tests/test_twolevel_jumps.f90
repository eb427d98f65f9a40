!> Growth by jumps: the error of the time of a jump, and its part in the error of the position.
program test_twolevel_jumps
   use base_kinds, only: rk
   use growth_tip, only: tip_t
   use report_rows, only: chronicle_t, event_growth_jump, summary_t
   use testing_checks, only: checks_t
   use twolevel_jumps, only: jumps_t
   implicit none(type, external)

   real(rk), parameter :: toughness = 1.0e6_rk  ! [Pa m^1/2]
   real(rk), parameter :: position_error(2) = 3.0e-3_rk  ! [m]

   type(checks_t) :: checks

   call test_rest()
   call test_speed()
   call test_next()
   call test_time()
   call checks%finish()

contains

   !> K_eq of a tip at rest, with an error of K_I.
   subroutine set(tip, share, error, advance)
      type(tip_t), intent(inout) :: tip(:)
      real(rk), intent(in) :: share  !< K_eq over the toughness [-]
      real(rk), intent(in) :: error  !< over the toughness [-]
      real(rk), intent(in) :: advance  !< [m]

      tip%drive%intensity = share*toughness
      tip%drive%resistance = 1.0_rk
      tip%intensity%k1_error = error*toughness
      tip%intensity%k2_error = 0.0_rk
      tip%advance = advance
      tip%fracture = 1
   end subroutine set

   !> A jump of one of two tips by 0.1 m.
   subroutine jump(jumps, tip, is_known, chronicle, summary)
      type(jumps_t), intent(inout) :: jumps
      type(tip_t), intent(inout) :: tip(2)
      logical, intent(in) :: is_known  !< the error of its time is
      type(chronicle_t), intent(inout) :: chronicle
      type(summary_t), intent(inout) :: summary
      real(rk) :: by_time(2), error(2)
      real(rk), parameter :: from(2, 2) = reshape([1.0_rk, 2.0_rk, 3.0_rk, 2.0_rk], [2, 2])

      tip(1)%advance = 0.1_rk
      tip(2)%advance = 0.0_rk
      call jumps%note(tip, from, toughness, [3.0e6_rk, 2.0e6_rk], 10.0_rk, chronicle, summary)
      call set(tip, 0.8_rk, 0.05_rk, 0.0_rk)
      tip(1)%advance = 0.1_rk
      call jumps%follow(tip, toughness, position_error, 1.0e-3_rk, 10.0_rk, error, by_time)
      call checks%is_close(error(1), merge(0.1_rk, 0.0_rk, is_known), 1.0e-15_rk, &
                           "right after the jump")
      call checks%is_close(error(2), 0.0_rk, 0.0_rk, "the other tip")
   end subroutine jump

   !> K_eq rises by a tenth of the toughness per second; its error of 0.05 and the tolerance of
   !! growth are worth more than half a second, during which the jump may not have happened.
   subroutine test_rest()
      type(chronicle_t) :: chronicle
      type(jumps_t) :: jumps
      type(summary_t) :: summary
      type(tip_t) :: tip(2)
      real(rk) :: by_time(2), error(2)
      integer :: second

      summary%growth_jumps = 0
      call chronicle%clear()
      call jumps%begin(2)
      do second = 1, 9
         call set(tip, 0.1_rk*second, 0.05_rk, 0.0_rk)
         call jumps%follow(tip, toughness, position_error, 1.0_rk, real(second, rk), error, by_time)
         call checks%is_close(maxval(error), 0.0_rk, 0.0_rk, "no jump so far")
      end do
      call jump(jumps, tip, .true., chronicle, summary)
      call checks%is_true(size(chronicle%events) == 1, "one event")
      call checks%is_true(chronicle%events(1)%kind == event_growth_jump, "kind")
      call checks%is_close(chronicle%events(1)%xy(1), 1.0_rk, 0.0_rk, "where it begins")
      call checks%is_true(summary%growth_jumps == 1, "one jump")
      call checks%is_close(summary%longest_jump, 0.1_rk, 0.0_rk, "longest jump")
      call set(tip, 0.8_rk, 0.05_rk, 0.0_rk)
      call jumps%follow(tip, toughness, position_error, 0.45_rk, 10.45_rk, error, by_time)
      call checks%is_close(error(1), 0.1_rk, 0.0_rk, "0.45 s later")
      call jumps%follow(tip, toughness, position_error, 0.15_rk, 10.6_rk, error, by_time)
      call checks%is_close(error(1), 0.0_rk, 0.0_rk, "0.6 s later")
      call jumps%follow(tip, toughness, position_error, 0.1_rk, 10.7_rk, error, by_time, &
                        load_errors=reshape(0.2_rk*toughness*[1, 0, 1, 0], [2, 2]))
      call checks%is_close(error(1), 0.1_rk, 0.0_rk, "it may jump again by its load")
   end subroutine test_rest

   !> A tip that grows by 1 mm/s, known to 3 mm, jumps: the time is known to 3 s.
   subroutine test_speed()
      type(chronicle_t) :: chronicle
      type(jumps_t) :: jumps
      type(summary_t) :: summary
      type(tip_t) :: tip(2)
      real(rk) :: by_time(2), error(2)

      call chronicle%clear()
      call jumps%begin(2)
      call set(tip, 1.0_rk, 0.01_rk, 2.0e-3_rk)
      call jumps%follow(tip, toughness, position_error, 2.0_rk, 2.0_rk, error, by_time)
      call jump(jumps, tip, .true., chronicle, summary)
      call set(tip, 0.8_rk, 0.05_rk, 0.0_rk)
      call jumps%follow(tip, toughness, position_error, 2.9_rk, 12.9_rk, error, by_time)
      call checks%is_close(error(1), 0.1_rk, 0.0_rk, "2.9 s later")
      call jumps%follow(tip, toughness, position_error, 0.2_rk, 13.1_rk, error, by_time)
      call checks%is_close(error(1), 0.0_rk, 0.0_rk, "3.1 s later")
   end subroutine test_speed

   !> A tip that grows by 2 mm in each of eleven steps of a second, and rests in the next one, in
   !! which K_eq rises by a hundredth of the toughness: its error of 0.02 and the tolerance of
   !! growth, 0.005, are worth 2.5 s. In the half of it there was a quarter of a second of growth.
   subroutine test_time()
      type(jumps_t) :: jumps
      type(tip_t) :: tip(2)
      real(rk) :: by_time(2), error(2)
      integer :: second

      call jumps%begin(2)
      do second = 1, 11
         call set(tip, 0.99_rk, 0.02_rk, 2.0e-3_rk)
         tip(2)%advance = 0.0_rk
         call jumps%follow(tip, toughness, position_error, 1.0_rk, real(second, rk), error, by_time)
         call checks%is_close(maxval(by_time), 0.0_rk, 0.0_rk, "no rate is known")
      end do
      call set(tip, 1.0_rk, 0.02_rk, 0.0_rk)
      call jumps%follow(tip, toughness, position_error, 1.0_rk, 12.0_rk, error, by_time)
      call checks%is_close(by_time(1), 0.5e-3_rk, 1.0e-12_rk, "at rest")
      call checks%is_close(by_time(2), 0.0_rk, 0.0_rk, "the other tip has not grown")
   end subroutine test_time

   !> As soon as K_eq equals K_IC within its error again, the next jump may have happened.
   subroutine test_next()
      type(chronicle_t) :: chronicle
      type(jumps_t) :: jumps
      type(summary_t) :: summary
      type(tip_t) :: tip(2)
      real(rk) :: by_time(2), error(2)

      call chronicle%clear()
      call jumps%begin(2)
      call set(tip, 0.5_rk, 0.05_rk, 0.0_rk)
      call jumps%follow(tip, toughness, position_error, 1.0_rk, 1.0_rk, error, by_time)
      call jump(jumps, tip, .false., chronicle, summary)
      call set(tip, 0.94_rk, 0.05_rk, 0.0_rk)
      call jumps%follow(tip, toughness, position_error, 1.0_rk, 11.0_rk, error, by_time)
      call checks%is_close(error(1), 0.0_rk, 0.0_rk, "below K_IC")
      call set(tip, 0.96_rk, 0.05_rk, 0.0_rk)
      call jumps%follow(tip, toughness, position_error, 1.0_rk, 12.0_rk, error, by_time)
      call checks%is_close(error(1), 0.1_rk, 0.0_rk, "K_IC within the error")
      call checks%is_close(error(2), 0.0_rk, 0.0_rk, "the other tip has not jumped")
   end subroutine test_next

end program test_twolevel_jumps
