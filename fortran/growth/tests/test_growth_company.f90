!> Tip groups: tips that differ only by numerical errors advance equally; tips with real differences
!! separate.
program test_growth_company
   use base_kinds, only: ik, rk
   use growth_rivals, only: company_t, could_part, lags_behind, rivals_t
   use growth_segment, only: segment_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks
   real(rk), parameter :: increment = 5.0e-3_rk
   real(rk), parameter :: known(2) = 0.0_rk
   logical, parameter :: neither(2) = .false.

   call test_before_growth()
   call test_chance()
   call test_difference()
   call test_rivals()
   call test_lag()
   call test_parting()
   call checks%finish()

contains

   !> Stopped tips are equal if their difference is within their errors.
   subroutine test_before_growth()
      call checks%is_true(are_one(0.99_rk, 0.995_rk, 0.0_rk), "half a per cent")
      call checks%is_true(.not. are_one(0.99_rk, 0.96_rk, 0.0_rk), "three per cent")
      call checks%is_true(are_one(0.99_rk, 0.96_rk, 0.025_rk), "three, known to two and a half")
      call checks%is_true(.not. are_one(0.99_rk, 0.99_rk, 0.0_rk, gain=[0.0_rk, increment]), &
                          "not equally far")
   end subroutine test_before_growth

   !> In a group, errors of the meshes reduce K_eq of one and the other tip alternately by six per
   !! cent.
   subroutine test_chance()
      type(company_t) :: company
      type(rivals_t) :: rivals
      integer(ik) :: kind(2)
      real(rk) :: drive(2), gain
      integer :: i

      call rivals%begin(2)
      drive = 1.0_rk
      gain = 0.0_rk
      do i = 1, 100
 call company%find_kinds(drive, known, [gain, gain], neither, spread(increment, 1, 2), rivals, kind)
         call checks%is_true(kind(1) == kind(2), "by chance")
         drive = [1.0_rk, 0.94_rk]
         if (mod(i, 2) == 0) drive = drive([2, 1])
         call company%accept(drive, spread(0.4_rk*increment, 1, 2), spread(increment, 1, 2))
         gain = gain + 0.4_rk*increment
      end do
      ! The very first moment of a piece says little.
     call company%accept([1.0_rk, 0.7_rk], spread(0.05_rk*increment, 1, 2), spread(increment, 1, 2))
 call company%find_kinds(drive, known, [gain, gain], neither, spread(increment, 1, 2), rivals, kind)
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
      real(rk), parameter :: worth(2) = [0.9_rk, 1.1_rk]*could_part/increment
      integer, parameter :: steps(2) = [101, 1]
      integer :: k

      do k = 1, 2
         call checks%is_true(steps_in_company(0.02_rk, worth(k)) == steps(k), "rivals")
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
      type(company_t) :: company
      type(rivals_t) :: rivals
      integer(ik) :: kind(3)
      real(rk) :: same(3)

      call rivals%begin(3)
      same = 1.0_rk
      call company%find_kinds(same, 0.0_rk*same, 0.0_rk*same, same < 0.0_rk, &
                              spread(increment, 1, size(same)), rivals, kind)
      call checks%is_true(all(kind == 1), "all alike")
      call company%part(2_ik)
      call company%accept(same, 0.0_rk*same, spread(increment, 1, size(same)))
      call company%find_kinds(same, 0.0_rk*same, 0.0_rk*same, same < 0.0_rk, &
                              spread(increment, 1, size(same)), rivals, kind)
      call checks%is_true(all(kind == [1, 2, 1]), "all but one")
   end subroutine test_parting

   !> Whether two tips that have not grown yet, or have grown by `gain`, are one group.
   logical function are_one(one, other, off, gain)
      real(rk), intent(in) :: one, other, off  !< [-]
      real(rk), intent(in), optional :: gain(2)  !< [m]
      type(company_t) :: company
      type(rivals_t) :: rivals
      integer(ik) :: kind(2)
      real(rk) :: come(2)

      call rivals%begin(2)
      come = 0.0_rk
      if (present(gain)) come = gain
      call company%find_kinds([one, other], [off, off], come, neither, &
                              spread(increment, 1, 2), rivals, kind)
      are_one = kind(1) == kind(2)
   end function are_one

   !> Number of steps of a fifth of an increment for which two tips, one of which has a deficit of a
   !! share of K_IC, stay one group; 101 at most.
   integer function steps_in_company(lack, lead) result(steps)
      real(rk), intent(in) :: lack  !< [-]
      real(rk), intent(in), optional :: lead  !< change of K_eq/K_IC per length of a lead [1/m]
      type(company_t) :: company
      type(rivals_t) :: rivals
      type(segment_t) :: segment
      integer(ik) :: kind(2)
      real(rk) :: drive(2), gain
      real(rk), parameter :: moved = 0.2_rk*increment

      call rivals%begin(2)
      if (present(lead)) then
         call rivals%note(1_ik, 1.0_rk, [0.0_rk, 0.0_rk], [0.0_rk, -lead], segment)
         call rivals%note(2_ik, 1.0_rk, [0.0_rk, 0.0_rk], [-lead, 0.0_rk], segment)
      end if
      drive = 1.0_rk
      gain = 0.0_rk
      do steps = 0, 100
 call company%find_kinds(drive, known, [gain, gain], neither, spread(increment, 1, 2), rivals, kind)
         if (kind(1) /= kind(2)) return
         drive = [1.0_rk, 1.0_rk - lack]
         call company%accept(drive, [moved, moved], spread(increment, 1, 2))
         gain = gain + moved
      end do
   end function steps_in_company

end program test_growth_company
