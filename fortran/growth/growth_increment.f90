!> One increment of growth of many tips, on whichever level they were evaluated: which of them grow,
!! and how far each.
module growth_increment
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_value
   use growth_law, only: advances, carry_over, in_grains
   use growth_tip, only: tip_t
   implicit none(type, external)
   private

   public :: plan_increment, tips_at_onset

contains

   !> The tips that grow: those whose equivalent intensity reaches the toughness. Where one does,
   !! those grow along that the error of their intensities does not tell from it: wings of equal
   !! rank would otherwise drift apart by chance.
   pure function tips_at_onset(tips, toughness, together) result(grows)
      type(tip_t), intent(in) :: tips(:)
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      real(rk), intent(in) :: together  !< share of the toughness that a tip may lack [-]
      logical :: grows(size(tips))

      grows = tips%drive%intensity >= (1.0_rk - same_value)*toughness .and. .not. tips%arrested
      if (.not. any(grows)) return
      grows = tips%drive%intensity >= (1.0_rk - together)*toughness .and. .not. tips%arrested
   end function tips_at_onset

   !> How far each tip goes: as far as its energy release rate beside the largest says (model.md
   !! section 5). Advances too short for the mesh are kept for the next increment, and their tips do
   !! not grow in this one.
   pure subroutine plan_increment(tips, grows, increment, exponent, advance)
      type(tip_t), intent(inout) :: tips(:)
      logical, intent(in) :: grows(:)  !< those at their toughness
      real(rk), intent(in) :: increment  !< l_max [m]
      real(rk), intent(in) :: exponent  !< of the growth law [-]
      real(rk), intent(out) :: advance(size(tips))  !< 0: does not grow now [m]
      real(rk) :: left, wanted(size(tips))
      integer(ik) :: i

      advance = 0.0_rk
      if (.not. any(grows)) return
      wanted = in_grains(advances(tips%drive%energy, grows, increment, exponent), increment)
      do i = 1, size(tips, kind=ik)
         if (.not. grows(i)) cycle
         call carry_over(wanted(i), tips(i)%carried, tips(i)%rosette_radius, advance(i), left)
         tips(i)%carried = left
      end do
   end subroutine plan_increment

end module growth_increment
