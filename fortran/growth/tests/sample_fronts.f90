!> Tips in prescribed fields of intensities.
module sample_fronts
   use base_errors, only: error_t
   use base_kinds, only: rk
   use base_timers, only: timers_t
   use growth_front, only: front_t
   use growth_law, only: growth_drive
   implicit none(type, external)
   private

   public :: sample_t

   !> Tips in a field: none, so that the drives stay as they were set, circles around the origin, or
   !! straight on.
   type, extends(front_t) :: sample_t
      logical :: turns = .false.  !< the criterion follows circles around the origin
      !> straight on up to this advance, shut beyond it; huge: not so [m]
      real(rk) :: open_to = huge(1.0_rk)
      integer :: evaluations = 0
   contains
      procedure :: evaluate
   end type sample_t

contains

   !> Set intensities whose kink angle leads into the direction of the circle at the tip.
   subroutine evaluate(self, timers, error)
      class(sample_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: along(2), off
      integer :: i

      self%evaluations = self%evaluations + 1
      call timers%start(1)
      if (allocated(error)) return
      if (self%turns) then
         do i = 1, size(self%tip)
            associate (tip => self%tip(i))
               along = [-tip%xy(2), tip%xy(1)]/norm2(tip%xy)
               off = asin(tip%direction(1)*along(2) - tip%direction(2)*along(1))
               tip%intensity%k1 = 2.0e6_rk
               tip%intensity%k2 = -0.5_rk*off*tip%intensity%k1
               tip%drive = growth_drive(tip%intensity%k1, tip%intensity%k2, 1.0e9_rk)
            end associate
         end do
      end if
      if (self%open_to < huge(1.0_rk)) then
         do i = 1, size(self%tip)
            associate (tip => self%tip(i))
               tip%intensity%k1 = merge(1.0e6_rk, 0.0_rk, tip%advance <= self%open_to)
               tip%intensity%k2 = 0.0_rk
               tip%drive = growth_drive(tip%intensity%k1, tip%intensity%k2, 1.0e9_rk)
            end associate
         end do
      end if
      call timers%stop(1)
   end subroutine evaluate

end module sample_fronts
