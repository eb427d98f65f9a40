!> Path of a tip: moves, and the search for the direction in which the path continues straight.
program test_growth_path
   use base_kinds, only: rk
   use growth_law, only: kink_angle
   use growth_tip, only: path_t, tip_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: degree = 0.0174532925199433_rk
   type(checks_t) :: checks

   call moves()
   call keeps_the_first_kink()
   call is_shortened()
   call finds_direction(-5.0_rk, "steep")
   call finds_direction(-1.0_rk, "as the criterion foretells")
   call finds_direction(-0.3_rk, "mild")
   call finds_direction(-40.0_rk, "saturated")
   call foresees()
   call test_excess()
   call test_noise()
   call checks%finish()

contains

   !> K_eq is compared with the toughness at the tip, here twice that of the scene, or with the
   !! least scale where that is larger.
   subroutine test_excess()
      type(tip_t) :: tip

      tip%drive%intensity = 1.1e6_rk
      tip%intensity%k2_error = 2.0e4_rk
      tip%drive%resistance = 2.0_rk
      call checks%is_close(tip%excess(1.0e6_rk), 0.1_rk, 1.0e-12_rk, "over the toughness")
      call checks%is_close(tip%relative_error(1.0e6_rk), 0.01_rk, 1.0e-12_rk, "error over that")
      tip%least_scale = 4.0e5_rk
      call checks%is_close(tip%excess(1.0e6_rk), 0.1_rk, 1.0e-12_rk, "a scale below the toughness")
      call checks%is_close(tip%excess(1.0e5_rk), 5.0_rk, 1.0e-12_rk, "above the toughness")
      call checks%is_close(tip%excess(0.0_rk), 5.5_rk, 1.0e-12_rk, "no toughness")
      call checks%is_close(tip%relative_error(0.0_rk), 0.05_rk, 1.0e-12_rk, "its error")
      tip%intensity%k2_error = 1.65e6_rk
      call checks%is_close(tip%excess(0.0_rk), 2.75_rk, 1.0e-12_rk, "half of it is certain")
      tip%intensity%k2_error = 2.2e6_rk
      call checks%is_close(tip%excess(0.0_rk), 0.0_rk, 1.0e-12_rk, "nothing is certain")
      call checks%is_close(tip%excess(2.0e6_rk), -0.45_rk, 1.0e-12_rk, "below the toughness")
   end subroutine test_excess

   !> A path goes straight ahead where K_I and K_II do not exceed their errors, and as they foretell
   !! where the errors are no more than half of them.
   subroutine test_noise()
      type(tip_t) :: tip
      real(rk) :: kink(3)
      integer :: k

      tip%has_wing = .true.
      tip%intensity%k1 = 6.0e5_rk
      tip%intensity%k2 = -8.0e5_rk
      tip%drive%angle = 0.9_rk
      tip%drive%intensity = 1.0e6_rk
      do k = 1, 3
         tip%intensity%k1_error = 5.0e5_rk*k
         call tip%predict_path(0.1_rk, kink(k))
      end do
      call checks%is_close(kink(1), 0.45_rk, 1.0e-6_rk, "half of the criterion's angle")
      call checks%is_close(kink(2), 0.0_rk, 1.0e-15_rk, "as large as its error")
      call checks%is_close(kink(3), 0.0_rk, 1.0e-15_rk, "smaller than its error")
      tip%intensity%k1_error = 7.5e5_rk
      call tip%predict_path(0.1_rk, kink(1))
      call checks%is_close(kink(1), 0.225_rk, 1.0e-6_rk, "in between")
   end subroutine test_noise

   !> A tip that has grown before and advances by 0.1 m, first by a prescribed kink.
   subroutine start(path, kink, has_wing)
      type(path_t), intent(out) :: path
      real(rk), intent(in) :: kink  !< [rad]
      logical, intent(in) :: has_wing

      path%xy = [1.0_rk, 2.0_rk]
      path%direction = [0.0_rk, 1.0_rk]
      path%has_wing = has_wing
      call path%move([1.0_rk, 2.0_rk] + 0.1_rk*[-sin(kink), cos(kink)], kink)
   end subroutine start

   subroutine moves()
      type(path_t) :: path

      call start(path, 30.0_rk*degree, .true.)
      call checks%is_close(path%advance, 0.1_rk, 1.0e-15_rk, "advance")
      call checks%is_close(path%direction(1), -0.5_rk, 1.0e-14_rk, "direction")
      call checks%is_close(path%heading(2), 1.0_rk, 0.0_rk, "heading before")
   end subroutine moves

   subroutine keeps_the_first_kink()
      type(path_t) :: path
      logical :: has_turned

      call start(path, 70.0_rk*degree, .false.)
      call path%correct(-30.0_rk*degree, -0.25_rk, has_turned)
      call checks%is_true(.not. has_turned, "the first kink is the criterion's")
   end subroutine keeps_the_first_kink

   !> Three quarters of an advance are taken back in its direction; the kink stays.
   subroutine is_shortened()
      type(path_t) :: path

      call start(path, 30.0_rk*degree, .true.)
      call path%shorten(2)
      call checks%is_close(path%advance, 0.025_rk, 1.0e-15_rk, "a quarter of the advance")
      call checks%is_close(path%xy(2) - path%origin(2), 0.025_rk*cos(30.0_rk*degree), 1.0e-14_rk, &
                           "in the same direction")
      call path%commit(0.0_rk, 0.025_rk)
      call checks%is_close(path%stride, 0.025_rk, 0.0_rk, "length of the segment")
   end subroutine is_shortened

   !> -K_II at the new end is slope*(kink - right) for a K_I of 1, so the criterion's angle
   !! saturates at pure sliding: the search must end within two degrees of that angle or half a
   !! degree of the right kink.
   subroutine finds_direction(slope, name)
      real(rk), intent(in) :: slope  !< d drive / d kink [-]
      character(len=*), intent(in) :: name
      real(rk), parameter :: right = -3.0_rk*degree
      type(path_t) :: path
      real(rk) :: drive, angle
      logical :: has_turned
      integer :: tries

      call start(path, 20.0_rk*degree, .true.)
      do tries = 0, 8
         drive = 0.5_rk*slope*(path%kink - right)
         angle = kink_angle(1.0_rk, -drive)
         call path%correct(angle, drive, has_turned)
         if (.not. has_turned) exit
      end do
      call checks%is_true(tries <= 8, name//": found in eight tries")
      call checks%is_true(abs(angle) <= 2.01_rk*degree .or. abs(path%kink - right) <= 0.5_rk &
                          *degree, name//": goes on straight")
      call checks%is_close(norm2(path%xy - path%origin), 0.1_rk, 1.0e-14_rk, name//": length kept")
   end subroutine finds_direction

   !> On a path of constant curvature, with -K_II decreasing by `slope` per kink, the data of the
   !! first increments predict the directions of later ones without a correction.
   subroutine foresees()
      real(rk), parameter :: turn = 6.0_rk*degree, slope = 2.5_rk
      type(path_t) :: path
      real(rk) :: drive, kink, left
      logical :: has_turned
      integer :: increment, tries, corrections

      path%direction = [1.0_rk, 0.0_rk]
      path%has_wing = .true.
      left = 0.0_rk  ! error of the direction of the last increment [rad]
      do increment = 1, 6
         drive = slope*left
         call path%predict(kink_angle(1.0_rk, -drive), drive, 1.0_rk, 0.1_rk, kink)
         call path%move(path%xy + 0.1_rk*(cos(kink)*path%direction &
                                          + sin(kink)*[-path%direction(2), path%direction(1)]), &
                        kink)
         corrections = 0
         do tries = 1, 8
            drive = slope*(left + turn - path%kink)
            call path%correct(kink_angle(1.0_rk, -drive), drive, has_turned)
            if (.not. has_turned) exit
            corrections = corrections + 1
         end do
         left = left + turn - path%kink
         call path%commit(slope*left, 0.1_rk)
         if (increment == 1) call checks%is_true(corrections > 0, "the first has to be corrected")
         if (increment < 3) cycle
         call checks%is_true(corrections == 0, "later ones are foreseen")
         call checks%is_close(path%kink, turn, 0.2_rk*degree, "as the path turns")
      end do
   end subroutine foresees

end program test_growth_path
