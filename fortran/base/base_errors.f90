!> Errors as an allocated value that is returned to the caller; only the program stops.
module base_errors
   implicit none(type, external)
   private

   public :: error_t, keep_first, raise_error

   !> A reason why the work could not be done; unallocated means success.
   type :: error_t
      character(len=:), allocatable :: message  !< for users
      character(len=:), allocatable :: origin  !< procedure that gave up; may be empty
      logical :: is_interruption = .false.  !< the user has asked the work to end: no failure
   end type error_t

contains

   !> Raise an error: what the user can do about it, and for the log where it happened.
   pure subroutine raise_error(error, origin, message)
      type(error_t), allocatable, intent(out) :: error
      character(len=*), intent(in) :: origin  !< procedure that gives up; may be empty
      character(len=*), intent(in) :: message  !< the offending value and the remedy

      allocate (error)
      error%message = message
      error%origin = origin
   end subroutine raise_error

   !> Of two errors the first counts.
   pure subroutine keep_first(trouble, error)
      type(error_t), allocatable, intent(inout) :: trouble  !< the later one; gone afterwards
      type(error_t), allocatable, intent(inout) :: error

      if (allocated(error)) then
         if (allocated(trouble)) deallocate (trouble)
      else
         call move_alloc(trouble, error)
      end if
   end subroutine keep_first

end module base_errors
