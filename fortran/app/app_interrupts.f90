!> Signals that request the end of the program, and memory of the process and of the machine. If an
!! allocation fails, the program ends with a message.
module app_interrupts
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   implicit none(type, external)
   private

   public :: catch_interrupts, interrupt_status, interrupted, machine_memory, prepare_memory

   interface
      !> Record the first SIGINT or SIGTERM from now on; a second one ends the program at once. A
      !! file larger than the user's limit is an error of writing.
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

      !> End the program if there is not enough memory for the smallest run. Otherwise let BLAS
      !! allocate its buffer, with one thread unless OPENBLAS_NUM_THREADS is larger; later attempts
      !! without memory would not end. Freed memory is kept for the next factorization.
      subroutine prepare_memory() bind(C, name="app_prepare_memory")
         implicit none(type, external)
      end subroutine prepare_memory
   end interface

contains

   !> A signal has requested the end of the run.
   logical function interrupted()
      interrupted = c_interrupted() /= 0
   end function interrupted

   !> Exit status after a signal: 128 plus its number.
   integer function interrupt_status() result(status)
      status = 128 + c_interrupted()
   end function interrupt_status

end module app_interrupts
