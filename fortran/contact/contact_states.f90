!> The contact state of a fracture cell, in one numbering for all rooms and files.
module contact_states
   use base_kinds, only: ik
   implicit none(type, external)
   private

   public :: state_name, state_open, state_slip, state_stick

   integer(ik), parameter :: state_stick = 0  !< the faces touch and hold
   integer(ik), parameter :: state_slip = 1  !< the faces touch and slide
   integer(ik), parameter :: state_open = 2  !< the faces do not touch

contains

   !> The word for a contact state.
   pure function state_name(state) result(name)
      integer(ik), intent(in) :: state
      character(len=:), allocatable :: name

      select case (state)
      case (state_stick)
         name = "stick"
      case (state_slip)
         name = "slip"
      case (state_open)
         name = "open"
      case default
         name = "unknown"
      end select
   end function state_name

end module contact_states
