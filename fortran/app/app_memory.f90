!> Memory of the process and of the machine. Where a request for memory fails, the program ends with
!! a sentence.
module app_memory
   use, intrinsic :: iso_c_binding, only: c_double
   implicit none(type, external)
   private

   public :: machine_memory, prepare_memory

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

end module app_memory
