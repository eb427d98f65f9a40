!> A free tip as a growing scene knows it, whichever level evaluates it.
module tips_state
   use base_kinds, only: ik
   use tips_growth, only: growth_drive_t
   use tips_path, only: path_t
   use tips_types, only: intensity_t
   implicit none(type, external)
   private

   public :: tip_state_t

   !> A free tip: its way, what drives it, and what has stopped it.
   type, extends(path_t) :: tip_state_t
      integer(ik) :: fracture = 0  !< in the network
      integer(ik) :: end = 0  !< 1: start of the polyline, 2: its end
      logical :: arrested = .false.  !< it will not grow again
      character(len=:), allocatable :: joint  !< what it has joined, for events; allocated once
      character(len=:), allocatable :: arrest_reason  !< what has stopped it short; allocated once
      type(intensity_t) :: intensity  !< at the present tip
      type(growth_drive_t) :: drive
      type(intensity_t) :: intensity_before  !< before the last increment of any tip
      type(growth_drive_t) :: drive_before
   end type tip_state_t

end module tips_state
