!> Tip groups: tips that differ only by numerical errors advance equally; tips with real differences
!! separate.
program test_growth_groups
   use base_kinds, only: ik, rk
 use growth_interaction, only: group_tip_t, tip_groups_t, could_separate, lags_behind, interaction_t
   use growth_segment, only: segment_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks
   real(rk), parameter :: increment = 5.0e-3_rk

   call test_before_growth()
   call test_chance()
   call test_difference()
   call test_rivals()
   call test_lag()
   call test_parting()
   call test_far()
   call test_increments()
   call test_separated()
   call checks%finish()

contains

   !> Stopped tips are equal if their difference is within their errors.
   subroutine test_before_growth()
      call checks%is_true(are_one(-0.01_rk, -0.005_rk, 0.0_rk), "half a per cent")
      call checks%is_true(.not. are_one(-0.01_rk, -0.04_rk, 0.0_rk), "three per cent")
      call checks%is_true(are_one(-0.01_rk, -0.04_rk, 0.025_rk), "three, known to two and a half")
      call checks%is_true(.not. are_one(-0.01_rk, -0.01_rk, 0.0_rk, gain=[0.0_rk, increment]), &
                          "not equally far")
      call checks%is_true(are_one(124.0_rk, 123.7_rk, 0.0_rk), "a quarter per cent of a large K_eq")
      call checks%is_true(.not. are_one(124.0_rk, 121.0_rk, 0.0_rk), "two and a half of it")
   end subroutine test_before_growth

   !> In a group, errors of the meshes reduce K_eq of one and the other tip alternately by six per
   !! cent.
   subroutine test_chance()
      type(tip_groups_t) :: groups
      type(interaction_t) :: interaction
      integer(ik) :: kind(2)
      real(rk) :: drive(2), gain
      integer :: i

      call interaction%begin(2)
      drive = 0.0_rk
      gain = 0.0_rk
      do i = 1, 100
         call groups%find_groups(tips_with(drive, gain), interaction, kind)
         call checks%is_true(kind(1) == kind(2), "by chance")
         drive = [0.0_rk, -0.06_rk]
         if (mod(i, 2) == 0) drive = drive([2, 1])
         call groups%accept(drive, spread(0.4_rk*increment, 1, 2), spread(increment, 1, 2))
         gain = gain + 0.4_rk*increment
      end do
      ! The very first moment of a piece says little.
      call groups%accept([0.0_rk, -0.3_rk], spread(0.05_rk*increment, 1, 2), &
                         spread(increment, 1, 2))
      call groups%find_groups(tips_with(drive, gain), interaction, kind)
      call checks%is_true(kind(1) == kind(2), "a moment")
   end subroutine test_chance

   !> One of two tips has a permanent deficit.
   subroutine test_difference()
      call checks%is_true(steps_in_company(0.02_rk) > 100, "2 % may be the meshes")
      call checks%is_true(steps_in_company(0.04_rk) <= 15, "4 % not over several increments")
      call checks%is_true(steps_in_company(0.20_rk) <= 3, "20 % soon")
   end subroutine test_difference

   !> Where a lead increases K_eq of a tip, only tips within their errors are equal.
   subroutine test_rivals()
      real(rk), parameter :: worth(2) = [0.9_rk, 1.1_rk]*could_separate/increment
      integer, parameter :: steps(2) = [101, 1]
      integer :: k

      do k = 1, 2
         call checks%is_true(steps_in_company(0.02_rk, worth(k)) == steps(k), "interaction")
      end do
   end subroutine test_rivals

   !> A tip stays in its group with a deficit within the errors of meshes, not with a third of K_IC;
   !! nor with a sixth, unless this is the error of its K_eq.
   subroutine test_lag()
      call checks%is_true(.not. lags_behind(-0.06_rk, 0.0_rk), "six per cent may be the meshes")
      call checks%is_true(lags_behind(-0.16_rk, 0.02_rk), "sixteen are not")
      call checks%is_true(.not. lags_behind(-0.16_rk, 0.2_rk), "sixteen, known to twenty")
      call checks%is_true(lags_behind(-0.73_rk, 0.2_rk), "nothing drives it")
      call checks%is_true(.not. lags_behind(0.3_rk, 0.0_rk), "beyond its toughness")
   end subroutine test_lag

   !> A tip that has separated stays alone, although it equals the others; these stay one group.
   subroutine test_parting()
      type(tip_groups_t) :: groups
      type(interaction_t) :: interaction
      integer(ik) :: kind(3)
      real(rk) :: same(3)

      call interaction%begin(3)
      same = 0.0_rk
      call groups%find_groups(tips_with(same), interaction, kind)
      call checks%is_true(all(kind == 1), "all alike")
      call groups%remove_tip(2_ik)
      call groups%accept(same, same, spread(increment, 1, size(same)))
      call groups%find_groups(tips_with(same), interaction, kind)
      call checks%is_true(all(kind == [1, 2, 1]), "all but one")
   end subroutine test_parting

   !> Tips far below their toughness are alone, however equal: those without load in a network.
   subroutine test_far()
      type(tip_groups_t) :: groups
      type(interaction_t) :: interaction
      integer(ik) :: kind(4)
      type(group_tip_t), allocatable :: tip(:)
      real(rk), parameter :: drive(4) = [-1.0_rk, -0.6_rk, -1.0_rk, -0.6_rk]

      call interaction%begin(4)
      call groups%find_groups(tips_with(drive), interaction, kind)
      call checks%is_true(all(kind == [1, 2, 3, 4]), "far below the toughness")
      tip = tips_with(drive)
      tip([2, 4])%off = 0.15_rk
      call groups%find_groups(tip, interaction, kind)
      call checks%is_true(all(kind == [1, 2, 3, 2]), "near it within the error")
   end subroutine test_far

   !> Tips of one group advance by equal shares of their segments: tips with other increments, or of
   !! fractures with other lengths, are not equal.
   subroutine test_increments()
      type(tip_groups_t) :: groups
      type(interaction_t) :: interaction
      integer(ik) :: kind(4)
      type(group_tip_t), allocatable :: tip(:)
      real(rk) :: same(4)

      call interaction%begin(4)
      same = 0.0_rk
      tip = tips_with(same)
      tip%increment = increment*[1.0_rk, 2.0_rk, 1.0_rk, 1.01_rk]
      call groups%find_groups(tip, interaction, kind)
      call checks%is_true(all(kind == [1, 2, 1, 1]), "other increments")
      tip = tips_with(same)
      tip%length = [1.0_rk, 1.0_rk, 1.01_rk, 1.00001_rk]
      call groups%find_groups(tip, interaction, kind)
      call checks%is_true(all(kind == [1, 1, 2, 1]), "other fractures")
      tip = tips_with(same)
      tip%gain = 0.01_rk*increment*[1.0_rk, 2.0_rk, 1.0_rk, 2.0_rk]
      call groups%find_groups(tip, interaction, kind)
      call checks%is_true(all(kind == 1), "equally far on whole segments")
      tip%segment = 0.25_rk*increment
      call groups%find_groups(tip, interaction, kind)
      call checks%is_true(all(kind == [1, 2, 1, 2]), "not on a quarter")
   end subroutine test_increments

   !> Tips that have separated by chance, and with a reason: K_eq of one has fallen, or was smaller
   !! over the last increments.
   subroutine test_separated()
      type(tip_groups_t) :: groups
      real(rk), parameter :: small(2) = 0.01_rk

      groups%usual = [0.0_rk, -0.02_rk]
      call checks%is_true(groups%differ_by_chance(1_ik, 2_ik, [0.0_rk, -0.08_rk], small), &
                          "errors of meshes")
      call checks%is_true(.not. groups%differ_by_chance(2_ik, 1_ik, [0.0_rk, -0.3_rk], small), &
                          "K_eq has fallen")
      call checks%is_true(groups%differ_by_chance(2_ik, 1_ik, [0.0_rk, -0.3_rk], 25.0_rk*small), &
                          "within its error")
      groups%usual = [-0.04_rk, 0.0_rk]
      call checks%is_true(.not. groups%differ_by_chance(1_ik, 2_ik, [0.0_rk, 0.0_rk], small), &
                          "smaller than that of the other one")
      call checks%is_true(groups%differ_by_chance(1_ik, 2_ik, [0.0_rk, 0.0_rk], 4.0_rk*small), &
                          "within the errors")
      groups%usual = [3.4_rk, 3.36_rk]
      call checks%is_true(groups%differ_by_chance(1_ik, 2_ik, [0.0_rk, 0.0_rk], small), &
                          "after large ones that differed by one per cent")
   end subroutine test_separated

   !> Tips of equal fractures that have grown equally.
   function tips_with(drive, gain) result(tip)
      real(rk), intent(in) :: drive(:)  !< excess over the toughness [-]
      real(rk), intent(in), optional :: gain  !< [m]
      type(group_tip_t), allocatable :: tip(:)

      allocate (tip(size(drive)))
      tip%drive = drive
      if (present(gain)) tip%gain = gain
      tip%increment = increment
      tip%segment = increment
      tip%length = 1.0_rk
   end function tips_with

   !> Whether two tips that have not grown yet, or have grown by `gain`, are one group.
   logical function are_one(one, other, off, gain)
      real(rk), intent(in) :: one, other, off  !< excesses and their error [-]
      real(rk), intent(in), optional :: gain(2)  !< [m]
      type(tip_groups_t) :: groups
      type(interaction_t) :: interaction
      type(group_tip_t), allocatable :: tip(:)
      integer(ik) :: kind(2)

      call interaction%begin(2)
      tip = tips_with([one, other])
      tip%off = off
      if (present(gain)) tip%gain = gain
      call groups%find_groups(tip, interaction, kind)
      are_one = kind(1) == kind(2)
   end function are_one

   !> Number of steps of a fifth of an increment for which two tips, one of which has a deficit of a
   !! share of K_IC, stay one group; 101 at most.
   integer function steps_in_company(lack, lead) result(steps)
      real(rk), intent(in) :: lack  !< [-]
      real(rk), intent(in), optional :: lead  !< change of K_eq/K_IC per length of a lead [1/m]
      type(tip_groups_t) :: groups
      type(interaction_t) :: interaction
      type(segment_t) :: segment
      integer(ik) :: kind(2)
      real(rk) :: drive(2), gain
      real(rk), parameter :: moved = 0.2_rk*increment

      call interaction%begin(2)
      if (present(lead)) then
         call interaction%store_column(1_ik, 1.0_rk, [0.0_rk, 0.0_rk], [0.0_rk, -lead], &
                                       [.true., .true.], segment)
         call interaction%store_column(2_ik, 1.0_rk, [0.0_rk, 0.0_rk], [-lead, 0.0_rk], &
                                       [.true., .true.], segment)
      end if
      drive = 0.0_rk
      gain = 0.0_rk
      do steps = 0, 100
         call groups%find_groups(tips_with(drive, gain), interaction, kind)
         if (kind(1) /= kind(2)) return
         drive = [0.0_rk, -lack]
         call groups%accept(drive, [moved, moved], spread(increment, 1, 2))
         gain = gain + moved
      end do
   end function steps_in_company

end program test_growth_groups
