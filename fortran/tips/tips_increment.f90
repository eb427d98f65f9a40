!> One increment of growth of many tips, on whichever level they were evaluated: which of them grow,
!! how far each, and where to.
module tips_increment
   use base_kinds, only: ik, rk
   use tips_growth, only: advances, carry_over, new_tip
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

   !> Where the tips that grow shall be: each in the direction of its kink, as far as its energy
   !! release rate beside the largest says (model.md section 5). Advances too short for the mesh
   !! are kept for the next increment, and their tips do not grow in this one.
   pure subroutine plan_increment(tips, increment, exponent, rosette_radius, grows, to)
      class(tip_state_t), intent(inout) :: tips(:)
      real(rk), intent(in) :: increment  !< l_max [m]
      real(rk), intent(in) :: exponent  !< of the growth law [-]
      real(rk), intent(in) :: rosette_radius(:)  !< of the mesh around each tip [m]
      logical, intent(inout) :: grows(:)  !< those at their toughness; then those that do grow
      real(rk), intent(out) :: to(2, size(tips))  !< [m]; where they are, if they do not grow
      real(rk) :: applied, energy(size(tips)), left, wanted(size(tips))
      integer(ik) :: i

      do i = 1, size(tips, kind=ik)
         to(:, i) = tips(i)%xy
         energy(i) = tips(i)%drive%energy
      end do
      if (.not. any(grows)) return
      wanted = advances(energy, grows, increment, exponent)
      do i = 1, size(tips, kind=ik)
         if (.not. grows(i)) cycle
         associate (tip => tips(i))
            call carry_over(wanted(i), tip%carried, rosette_radius(i), applied, left)
            tip%carried = left
            grows(i) = applied > 0.0_rk
            if (grows(i)) to(:, i) = new_tip(tip%xy, tip%direction, tip%drive%angle, applied)
         end associate
      end do
   end subroutine plan_increment

end module tips_increment
