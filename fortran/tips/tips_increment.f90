!> One increment of growth of many tips, on whichever level they were evaluated: which of them grow,
!! and how far each.
module tips_increment
   use base_kinds, only: ik, rk
   use tips_growth, only: advances, carry_over
   use tips_state, only: tip_state_t
   implicit none(type, external)
   private

   public :: begin_increment, plan_increment, reach

contains

   !> Nothing has grown yet, and all tips are as before the increment.
   pure subroutine begin_increment(tips)
      class(tip_state_t), intent(inout) :: tips(:)
      integer(ik) :: i

      do i = 1, size(tips, kind=ik)
         tips(i)%advance = 0.0_rk
         tips(i)%intensity_before = tips(i)%intensity
         tips(i)%drive_before = tips(i)%drive
      end do
   end subroutine begin_increment

   !> Whether the equivalent intensity of each tip reaches a value, and the tip is free to grow.
   pure function reach(tips, intensity) result(reaches)
      class(tip_state_t), intent(in) :: tips(:)
      real(rk), intent(in) :: intensity  !< [Pa m^1/2]
      logical :: reaches(size(tips))
      integer(ik) :: i

      do i = 1, size(tips, kind=ik)
         reaches(i) = tips(i)%drive%intensity >= intensity .and. .not. tips(i)%arrested
      end do
   end function reach

   !> How far each tip goes: as far as its energy release rate beside the largest says (model.md
   !! section 5). Advances too short for the mesh are kept for the next increment, and their tips do
   !! not grow in this one.
   pure subroutine plan_increment(tips, grows, increment, exponent, rosette_radius, advance)
      class(tip_state_t), intent(inout) :: tips(:)
      logical, intent(in) :: grows(:)  !< those at their toughness
      real(rk), intent(in) :: increment  !< l_max [m]
      real(rk), intent(in) :: exponent  !< of the growth law [-]
      real(rk), intent(in) :: rosette_radius(:)  !< of the mesh around each tip [m]
      real(rk), intent(out) :: advance(size(tips))  !< 0: does not grow now [m]
      real(rk) :: energy(size(tips)), left, wanted(size(tips))
      integer(ik) :: i

      advance = 0.0_rk
      if (.not. any(grows)) return
      do i = 1, size(tips, kind=ik)
         energy(i) = tips(i)%drive%energy
      end do
      wanted = advances(energy, grows, increment, exponent)
      do i = 1, size(tips, kind=ik)
         if (.not. grows(i)) cycle
         call carry_over(wanted(i), tips(i)%carried, rosette_radius(i), advance(i), left)
         tips(i)%carried = left
      end do
   end subroutine plan_increment

end module tips_increment
