!> Errors travel to the caller as an allocated value; only the program stops.
module base_errors
   implicit none(type, external)
   private

   public :: error_t, raise_error

   !> A reason why the work could not be done; unallocated means success.
   type :: error_t
      character(len=:), allocatable :: message
   end type error_t

contains

   !> Raise an error: where it happened, then what the user can do about it.
   pure subroutine raise_error(error, origin, message)
      type(error_t), allocatable, intent(out) :: error
      character(len=*), intent(in) :: origin  !< procedure that gives up; empty: written for users
      character(len=*), intent(in) :: message  !< the offending value and the remedy

      allocate (error)
      if (len(origin) > 0) then
         error%message = origin//": "//message
      else
         error%message = message
      end if
   end subroutine raise_error

end module base_errors
