!> A tip on the last piece of its path: it goes where its excess vanishes, on each side of it.
program test_growth_segment
   use base_kinds, only: rk
   use growth_segment, only: segment_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: tolerance = 1.0e-3_rk
   type(checks_t) :: checks

   call test_equilibrium()
   call test_bounds()
   call test_rest()
   call test_steep()
   call test_guesses()
   call test_searches()
   call test_moving()
   call checks%finish()

contains

   !> A tip that leaves a rest of its piece is at its end before, and finishes it at once.
   subroutine test_rest()
      type(segment_t) :: segment
      logical :: has_moved
      integer :: try

      call segment%open_segment([1.0_rk, 0.0_rk], [0.0_rk, 1.0_rk], 0.2_rk)
      call segment%leave_rest(0.1_rk)
      do try = 1, 50
         call segment%improve(5.0_rk, tolerance, has_moved)
         if (.not. has_moved) exit
      end do
      call checks%is_true(segment%is_complete(), "all but the rest")
      call checks%is_close(norm2(segment%place() - [1.0_rk, 0.18_rk]), 0.0_rk, 1.0e-15_rk, &
                           "before the rest")
      call segment%finish([1.0_rk, 0.2_rk])
      call checks%is_close(segment%reached, 0.2_rk, 1.0e-15_rk, "the rest as well")
      call checks%is_true(.not. segment%is_open, "nothing is left of it")
   end subroutine test_rest

   !> A step begins where the speed of the last one leads to, and a piece where the excess that is
   !! left at the end of the one before vanishes on it; neither beyond its ends, and only if known.
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
      call segment%improve(0.10_rk, tolerance, has_moved)
      call segment%go_to(0.3_rk, has_moved)
      call segment%learn(0.05_rk)
      call segment%accept()
      call segment%pace(0.3_rk, 2.0_rk, is_driven=.true.)
      call segment%keep_pace(1.0_rk)
      call checks%is_close(segment%reached, 0.45_rk, 1.0e-15_rk, "as fast as before")
      call segment%keep_pace(10.0_rk)
      call checks%is_close(segment%reached, 1.0_rk, 0.0_rk, "no farther than the piece")
      call segment%pace(-0.1_rk, 1.0_rk, is_driven=.true.)
      call segment%keep_pace(1.0_rk)
      call checks%is_close(segment%reached, 0.3_rk, 1.0e-15_rk, "never back")
      call segment%pace(0.3_rk, 2.0_rk, is_driven=.false.)
      call segment%keep_pace(1.0_rk)
      call checks%is_close(segment%reached, 0.3_rk, 1.0e-15_rk, "not driven there: no speed")
      associate (slope => segment%slope)
         call segment%open_segment([1.0_rk, 0.0_rk], [0.0_rk, 1.0_rk], 1.0_rk)
         call segment%set_out(-0.5_rk*slope)
         call checks%is_close(segment%reached, 0.5_rk, 1.0e-15_rk, "where the excess vanishes")
      end associate
   end subroutine test_guesses

   !> The excess falls along the piece, (s/s0)^(-1/2) - 1: the tip ends at s0, and remembers it.
   subroutine test_equilibrium()
      type(segment_t) :: segment
      real(rk), parameter :: wanted(3) = [0.3_rk, 0.55_rk, 0.8_rk]
      logical :: has_moved
      integer :: k, try

      call segment%open_segment([1.0_rk, 2.0_rk], [0.6_rk, 0.8_rk], 1.0_rk)
      do k = 1, size(wanted)
         call segment%restart()
         do try = 1, 12
            call segment%improve(excess(segment%reached, wanted(k)), tolerance, has_moved)
            if (.not. has_moved) exit
         end do
         call checks%is_close(excess(segment%reached, wanted(k)), 0.0_rk, 2.0_rk*tolerance, &
                              "equilibrium")
         call checks%is_true(try <= merge(12, 5, k == 1), "in few tries")
         call segment%accept()
      end do
      call checks%is_close(norm2(segment%place() - [1.0_rk, 2.0_rk] &
                                 - segment%reached*[0.6_rk, 0.8_rk]), 0.0_rk, 1.0e-15_rk, "place")
      call checks%is_close(segment%accepted, segment%reached, 0.0_rk, "accepted")
   end subroutine test_equilibrium

   !> Below the toughness a tip goes back no farther than it was; far above it, it comes to the end
   !! of its piece, which is then over.
   subroutine test_bounds()
      type(segment_t) :: segment, twin
      logical :: has_moved
      integer :: try

      call segment%open_segment([0.0_rk, 0.0_rk], [1.0_rk, 0.0_rk], 0.01_rk)
      call segment%improve(2.0_rk, tolerance, has_moved)
      call checks%is_true(has_moved, "goes on")
      call segment%accept()
      associate (before => segment%accepted)
         do try = 1, 5
            call segment%improve(-0.5_rk, tolerance, has_moved)
         end do
         call checks%is_close(segment%reached, before, 0.0_rk, "never back")
      end associate
      do try = 1, 50
         call segment%improve(5.0_rk, tolerance, has_moved)
         if (.not. has_moved) exit
      end do
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

   !> However the excess depends on the place, the search ends within 60 tries, and where it ends
   !! the tip does not exceed its toughness but for the tolerance, unless it is at the end of its
   !! piece; nor is it below but beside a place where it exceeds it, or where it cannot go back.
   subroutine test_searches()
     character(len=*), parameter :: name(8) = [character(len=16) :: "monotone", "sudden", "noisy", &
                                                     "two roots", "of D4", "flat", "always above", &
                                                                                     "always below"]
      real(rk), parameter :: start(3) = [0.05_rk, 0.3045_rk, 0.9_rk], &
                             slope(3) = [0.0_rk, -0.02_rk, -40.0_rk]
      integer :: i, j, k, most

      most = 0
      do k = 1, size(name)
         do i = 1, size(start)
            do j = 1, size(slope)
               call search(trim(name(k)), k, start(i), slope(j), most)
            end do
         end do
      end do
      call checks%is_true(most <= 30, "in few tries")
   end subroutine test_searches

   !> One search, along a piece of unit length from a place that the tip cannot go back from.
   subroutine search(name, number, start, slope, most)
      character(len=*), intent(in) :: name
      integer, intent(in) :: number  !< of the function
      real(rk), intent(in) :: start  !< [m]
      real(rk), intent(in) :: slope  !< as known before [1/m]
      integer, intent(inout) :: most  !< tries of one search so far
      real(rk), parameter :: near = 5.0e-4_rk  !< [m]
      type(segment_t) :: segment
      logical :: has_moved
      real(rk) :: left
      integer :: try

      call segment%open_segment([0.0_rk, 0.0_rk], [1.0_rk, 0.0_rk], 1.0_rk)
      segment%reached = start
      call segment%accept()
      call segment%restart()
      segment%slope = slope
      do try = 1, 60
         call segment%improve(sample(number, segment%reached), 5.0_rk*tolerance, has_moved)
         if (.not. has_moved) exit
      end do
      most = max(most, try)
      call checks%is_true(.not. has_moved, name//" ends")
      left = sample(number, segment%reached)
      call checks%is_true(left <= 5.0_rk*tolerance .or. segment%is_complete(), name//" is at rest")
     call checks%is_true(left >= -5.0_rk*tolerance .or. segment%reached <= segment%lowest() + near &
                          .or. sample(number, segment%reached - near) > 0.0_rk .or. &
                          segment%is_complete(), name//" is no farther than it has to")
   end subroutine search

   !> Excesses that have been met, or might be [-].
   pure real(rk) function sample(number, s)
      integer, intent(in) :: number
      real(rk), intent(in) :: s  !< [m]
      ! D4 at 194.226 s: a tip between two others, whose piece is 2 mm long.
      real(rk), parameter :: at(4) = [0.3045_rk, 0.4875_rk, 0.638_rk, 0.907_rk], &
                             d4(4) = [0.0275_rk, 0.0192_rk, -0.0227_rk, -0.0343_rk]
      integer :: k

      select case (number)
      case (1)
         sample = excess(s, 0.55_rk)
      case (2)
         sample = merge(0.497_rk, -0.3_rk, s < 0.61803_rk)
      case (3)
         sample = 0.5_rk*(0.7_rk - s) + 4.0_rk*tolerance*sin(1.0e4_rk*s)
      case (4)
         sample = (s - 0.4_rk)*(s - 0.8_rk)
      case (5)
         k = max(1, min(3, count(at <= s)))
         sample = d4(k) + (d4(k + 1) - d4(k))/(at(k + 1) - at(k))*(s - at(k))
      case (6)
         sample = 0.02_rk*tanh(300.0_rk*(0.65_rk - s))
      case (7)
         sample = 0.02_rk + 0.01_rk*sin(20.0_rk*s)
      case default
         sample = -0.02_rk - 0.01_rk*sin(20.0_rk*s)
      end select
   end function sample

   !> Where other tips move the excess is another one at each try; the tip comes to rest all the
   !! same, and not where it exceeds its toughness.
   subroutine test_moving()
      type(segment_t) :: segment
      logical :: has_moved
      real(rk) :: left
      integer :: period, try

      do period = 1, 5
         call segment%open_segment([0.0_rk, 0.0_rk], [1.0_rk, 0.0_rk], 1.0_rk)
         do try = 1, 80
            left = merge(0.1_rk, -0.1_rk, modulo(try, period + 1) < period)
            if (period > 3) left = 0.1_rk*sin(real(try*period, rk)) + 0.02_rk
            call segment%improve(left, 5.0_rk*tolerance, has_moved)
            if (.not. has_moved) exit
         end do
         call checks%is_true(.not. has_moved, "comes to rest")
         call checks%is_true(left <= 5.0_rk*tolerance .or. segment%is_complete(), "no farther")
      end do
   end subroutine test_moving

   !> Next to another fracture the excess falls by 33 along a piece: what is left of it is less than
   !! the tolerance all the same, not what a thousandth of the piece is worth.
   subroutine test_steep()
      type(segment_t) :: segment
      real(rk), parameter :: fall = 33.0_rk, known = 0.2_rk, wanted = 0.2008_rk
      logical :: has_moved
      integer :: try

      call segment%open_segment([0.0_rk, 0.0_rk], [1.0_rk, 0.0_rk], 1.0_rk)
      segment%slope = -fall
      segment%reached = known
      call segment%accept()
      call segment%restart()
      do try = 1, 12
         call segment%improve(fall*(wanted - segment%reached), 5.0_rk*tolerance, has_moved)
         if (.not. has_moved) exit
      end do
      call checks%is_true(abs(fall*(wanted - segment%reached)) <= 5.0_rk*tolerance, "at rest")
      call checks%is_true(try <= 3, "in few tries")
   end subroutine test_steep

   pure real(rk) function excess(s, s0)
      real(rk), intent(in) :: s, s0  !< [m]

      excess = sqrt(s0/s) - 1.0_rk
   end function excess

end program test_growth_segment
