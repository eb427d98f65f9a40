!> Signals that ask the program to end.
module app_interrupts
   use, intrinsic :: iso_c_binding, only: c_int
   implicit none(type, external)
   private

   public :: catch_interrupts, interrupt_status, interrupted

   interface
      !> From now on the first SIGINT or SIGTERM is noted, and a second one ends the program at
      !! once. A file that grows beyond the user's limit is an error of writing.
      subroutine catch_interrupts() bind(C, name="app_catch_interrupts")
         implicit none(type, external)
      end subroutine catch_interrupts

      function c_interrupted() result(number) bind(C, name="app_interrupted")
         import :: c_int
         implicit none(type, external)
         integer(c_int) :: number
      end function c_interrupted
   end interface

contains

   !> The user has asked the run to stop.
   logical function interrupted()
      interrupted = c_interrupted() /= 0
   end function interrupted

   !> Exit status of a run that has been asked to stop: 128 and the number of the signal.
   integer function interrupt_status() result(status)
      status = 128 + c_interrupted()
   end function interrupt_status

end module app_interrupts
