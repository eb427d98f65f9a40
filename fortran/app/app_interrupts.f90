!> Signals that request the end of the program.
!!
!! Memory of the process and of the machine. If an allocation fails, the program ends with a
!! message.
module app_interrupts
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   implicit none(type, external)
   private

   public :: catch_interrupts, interrupt_status, interrupted, machine_memory, prepare_memory

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

   interface
      !> All memory of the machine [byte].
      function machine_memory() result(n_bytes) bind(C, name="app_machine_memory")
         import :: c_double
         implicit none(type, external)
         real(c_double) :: n_bytes
      end function machine_memory

      !> End the program if there is no memory for the smallest run. Else let BLAS take the buffer
      !! that it would later ask for again and again in vain, with one thread unless
      !! OPENBLAS_NUM_THREADS wants more; and keep freed memory for the next factorization.
      subroutine prepare_memory() bind(C, name="app_prepare_memory")
         implicit none(type, external)
      end subroutine prepare_memory
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
