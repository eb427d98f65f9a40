!> The load at which the next tip grows, foreseen from the intensities at two loads.
!!
!! Between changes of contact the intensities are linear in the load factor. The onset on the
!! straight lines through two states is then the onset itself; across such changes it is a guess.
module mechanics_onset
   use base_kinds, only: rk
   use growth_law, only: growth_drive, growth_drive_t
   implicit none(type, external)
   private

   public :: foreseen_onset, reading_t

   !> The free tips at a load.
   type :: reading_t
      real(rk) :: factor = 0.0_rk  !< of the load [-]
      real(rk), allocatable :: k1(:), k2(:)  !< (tips) [Pa sqrt(m)]
   end type reading_t

contains

   !> The factor between two limits at which the largest equivalent intensity, were the intensities
   !! linear in the factor, reaches the toughness. Where they would not do so in between, it is the
   !! middle.
   pure real(rk) function foreseen_onset(a, b, low, high, toughness) result(factor)
      type(reading_t), intent(in) :: a, b  !< at different factors
      real(rk), intent(in) :: low, high  !< limits, in this order on the way of the load [-]
      real(rk), intent(in) :: toughness  !< [Pa sqrt(m)]
      integer, parameter :: halvings = 200  ! more than there are digits: it ends by itself
      real(rk) :: below, above
      integer :: k

      factor = 0.5_rk*(low + high)
      if (excess(low) >= 0.0_rk .or. excess(high) <= 0.0_rk) return
      below = low
      above = high
      do k = 1, halvings
         factor = 0.5_rk*(below + above)
         if (.not. (factor > min(below, above) .and. factor < max(below, above))) exit
         if (excess(factor) < 0.0_rk) then
            below = factor
         else
            above = factor
         end if
      end do

   contains

      !> Of the intensities on the lines over the toughness [Pa sqrt(m)].
      pure real(rk) function excess(at)
         real(rk), intent(in) :: at  !< factor [-]
         type(growth_drive_t) :: drive(size(a%k1))
         real(rk) :: share

         share = (at - a%factor)/(b%factor - a%factor)
         drive = growth_drive(a%k1 + share*(b%k1 - a%k1), a%k2 + share*(b%k2 - a%k2), 1.0_rk)
         excess = maxval(drive%intensity) - toughness
      end function excess

   end function foreseen_onset

end module mechanics_onset
