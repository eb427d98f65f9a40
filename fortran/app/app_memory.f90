!> Memory of the process.
module app_memory
   use base_errors, only: error_t, raise_error
   use base_kinds, only: lk, rk
   use, intrinsic :: iso_c_binding, only: c_int, c_int64_t
   implicit none(type, external)
   private

   public :: available_memory, prepare_memory

   !> Address space that the smallest run takes beyond what the libraries have: a buffer of OpenBLAS,
   !! the heap's head room, gmsh [byte].
   integer(c_int64_t), parameter :: least = 256_c_int64_t*2_c_int64_t**20

   interface
      function c_available_memory() result(n_bytes) bind(C, name="app_available_memory")
         import :: c_int64_t
         implicit none(type, external)
         integer(c_int64_t) :: n_bytes
      end function c_available_memory

      function c_has_address_space(n_bytes) result(answer) bind(C, name="app_has_address_space")
         import :: c_int, c_int64_t
         implicit none(type, external)
         integer(c_int64_t), value, intent(in) :: n_bytes
         integer(c_int) :: answer
      end function c_has_address_space

      subroutine c_take_blas_buffer() bind(C, name="app_take_blas_buffer")
         implicit none(type, external)
      end subroutine c_take_blas_buffer
   end interface

contains

   !> What the machine and the user's limit leave for this process [byte]; huge where the system does
   !! not say.
   function available_memory() result(n_bytes)
      real(rk) :: n_bytes
      integer(lk) :: available

      available = int(c_available_memory(), lk)
      n_bytes = merge(real(available, rk), huge(1.0_rk), available >= 0_lk)
   end function available_memory

   !> Judge whether there is memory for the smallest run, and let OpenBLAS take its buffer: later it
   !! would repeat a request that is refused for ever.
   subroutine prepare_memory(error)
      type(error_t), allocatable, intent(out) :: error

      if (c_has_address_space(least) == 0) then
         call raise_error(error, "", "there is not enough memory for a run: allow this process "// &
                          "at least 1 GB (ulimit -v)")
         return
      end if
      call c_take_blas_buffer()
   end subroutine prepare_memory

end module app_memory
