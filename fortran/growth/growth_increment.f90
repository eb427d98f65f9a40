!> An increment of growth: which tips grow, and how far.
module growth_increment
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_value
   use growth_law, only: advances, carry_over, in_grains
   use growth_tip, only: tip_t
   implicit none(type, external)
   private

   public :: plan_increment, tips_at_onset

contains

   !> Whether each tip grows: its equivalent intensity reaches the toughness. Where one tip does, so
   !! do the tips whose intensities differ from the toughness by less than their errors: equal wings
   !! would otherwise separate by numerical errors.
   pure function tips_at_onset(tips, toughness, together) result(grows)
      type(tip_t), intent(in) :: tips(:)
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      !> relative deficit of K_eq within which other tips grow along [-]
      real(rk), intent(in) :: together
      logical :: grows(size(tips))

      grows = tips%drive%intensity >= (1.0_rk - same_value)*toughness .and. .not. tips%arrested
      if (.not. any(grows)) return
      grows = tips%drive%intensity >= (1.0_rk - together)*toughness .and. .not. tips%arrested
   end function tips_at_onset

   !> Advance of each tip, by the ratio of its energy release rate to the largest (model.md section
   !! 5). Advances too short for the mesh are carried over to the next increment, and their tips do
   !! not grow in this one.
   pure subroutine plan_increment(tips, grows, increment, exponent, advance)
      type(tip_t), intent(inout) :: tips(:)
      logical, intent(in) :: grows(:)  !< those at their toughness
      real(rk), intent(in) :: increment(:)  !< (tips) l_max [m]
      real(rk), intent(in) :: exponent  !< of the growth law [-]
      real(rk), intent(out) :: advance(size(tips))  !< 0: does not grow now [m]
      real(rk) :: left, wanted(size(tips))
      integer(ik) :: i

      advance = 0.0_rk
      if (.not. any(grows)) return
      wanted = in_grains(increment*advances(tips%drive%energy, grows, 1.0_rk, exponent), increment)
      do i = 1, size(tips, kind=ik)
         if (.not. grows(i)) cycle
         call carry_over(wanted(i), tips(i)%carried, tips(i)%rosette_radius, advance(i), left)
         tips(i)%carried = left
      end do
   end subroutine plan_increment

end module growth_increment
