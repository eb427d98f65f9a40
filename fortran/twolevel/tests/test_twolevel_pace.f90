!> The length of a replayed step is found where K_eq/K_IC of the tips is the recorded one.
program test_twolevel_pace
   use base_kinds, only: rk
   use base_tape, only: tape_t
   use testing_checks, only: checks_t
   use twolevel_pace, only: pace_t
   implicit none(type, external)

   type(checks_t) :: checks

   call finds_time_of_a_power_law()
   call gives_up_outside_of_range()
   call checks%finish()

contains

   !> K_eq rises with the sixth root of time: 1 % more toughness takes a factor 1.01**6 in time.
   subroutine finds_time_of_a_power_law()
      type(pace_t) :: pace
      real(rk) :: dt
      logical :: is_found
      integer :: k

      pace%since = 100.0_rk
      pace%recorded = 50.0_rk
      dt = 50.0_rk
      do k = 1, 10
         call try(pace, dt, 1.01_rk)
         call pace%improve(dt, is_found)
         if (is_found .or. allocated(pace%why_not)) exit
      end do
      call checks%is_true(is_found .and. k < 7, "the time is found in few tries")
      call checks%is_true(abs((100.0_rk + dt)/(150.0_rk*1.01_rk**6) - 1.0_rk) < 1.0e-8_rk, &
                          "it is that of the power law")
   end subroutine finds_time_of_a_power_law

   subroutine gives_up_outside_of_range()
      type(pace_t) :: pace
      real(rk) :: dt
      logical :: is_found
      integer :: k

      pace%since = 100.0_rk
      pace%recorded = 1.0_rk
      dt = 1.0_rk
      do k = 1, 20
         call try(pace, dt, 1.05_rk)
         call pace%improve(dt, is_found)
         if (is_found .or. allocated(pace%why_not)) exit
      end do
      call checks%is_true(allocated(pace%why_not), "a step far from the recorded one is not taken")
   end subroutine gives_up_outside_of_range

   !> A tip that advances, with K_eq/K_IC = 1 at 150 s and the recorded toughness.
   subroutine try(pace, dt, toughness)
      type(pace_t), intent(inout) :: pace
      real(rk), intent(in) :: dt, toughness
      type(tape_t) :: tape, record
      real(rk) :: excess(1)

      record%is_recording = .true.
      call record%begin()
      call pace%begin_try()
      call pace%see_end(record, [0.0_rk], [0.0_rk], [0.0_rk], [1.0_rk], [.true.], .false.)
      call tape%follow(record%bytes())
      call pace%begin_try()
      excess = ((pace%since + dt)/(pace%since + pace%recorded))**(1.0_rk/6.0_rk)/toughness - 1.0_rk
      call pace%see_end(tape, excess, [0.0_rk], [0.0_rk], [1.0_rk], [.true.], .false.)
   end subroutine try

end program test_twolevel_pace
