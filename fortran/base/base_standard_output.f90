!> Standard output that tells when it did not take a text: gfortran's own units are silent about a
!! full disk.
module base_standard_output
   use base_errors, only: error_t, raise_error
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_long
   implicit none(type, external)
   private

   public :: write_standard_output

   interface
      function c_write(text, n) result(status) bind(C, name="base_write_standard_output")
         import :: c_char, c_int, c_long
         implicit none(type, external)
         ! allow(C071)
         character(kind=c_char), intent(in) :: text(*)
         integer(c_long), value, intent(in) :: n
         integer(c_int) :: status
      end function c_write

      function c_error_words(number, words, n) result(length) bind(C, name="base_error_words")
         import :: c_char, c_int
         implicit none(type, external)
         integer(c_int), value, intent(in) :: number
         ! allow(C071)
         character(kind=c_char), intent(out) :: words(*)
         integer(c_int), value, intent(in) :: n
         integer(c_int) :: length
      end function c_error_words
   end interface

contains

   !> Write all of a text.
   subroutine write_standard_output(text, error)
      character(len=*), intent(in) :: text
      type(error_t), allocatable, intent(out) :: error
      character(len=100) :: words
      integer(c_int) :: status, length

      status = c_write(text, len(text, kind=c_long))
      if (status == 0) return
      length = c_error_words(status, words, len(words, kind=c_int))
      call raise_error(error, "", "cannot write to standard output: "//words(:length))
   end subroutine write_standard_output

end module base_standard_output
