!> What the test programs need: named checks that count failures and set the exit status.
module testing_checks
   use, intrinsic :: iso_fortran_env, only: error_unit
   use base_errors, only: error_t
   use base_kinds, only: rk
   implicit none(type, external)
   private

   public :: checks_t

   !> The checks of one test program.
   type :: checks_t
      integer :: n_passed = 0
      integer :: n_failed = 0
   contains
      procedure :: is_true
      procedure :: is_close
      procedure :: no_error
      procedure :: fails_with
      procedure :: fails_by
      procedure :: finish
   end type checks_t

contains

   !> A condition holds.
   subroutine is_true(self, condition, name)
      class(checks_t), intent(inout) :: self
      logical, intent(in) :: condition
      character(len=*), intent(in) :: name

      if (condition) then
         self%n_passed = self%n_passed + 1
      else
         self%n_failed = self%n_failed + 1
         write (error_unit, "(2a)") "FAILED: ", name
      end if
   end subroutine is_true

   !> |value - expected| <= tolerance; a NaN fails.
   subroutine is_close(self, value, expected, tolerance, name)
      class(checks_t), intent(inout) :: self
      real(rk), intent(in) :: value, expected
      real(rk), intent(in) :: tolerance  !< absolute, in the unit of value
      character(len=*), intent(in) :: name
      character(len=96) :: numbers

      if (.not. abs(value - expected) <= tolerance) then
         write (numbers, "(3(a,es22.14))") ": ", value, " /=", expected, " within", tolerance
         call self%is_true(.false., name//trim(numbers))
      else
         call self%is_true(.true., name)
      end if
   end subroutine is_close

   !> Nothing went wrong.
   subroutine no_error(self, error, name)
      class(checks_t), intent(inout) :: self
      type(error_t), allocatable, intent(in) :: error
      character(len=*), intent(in) :: name

      if (allocated(error)) then
         call self%is_true(.false., name//": "//error%message)
      else
         call self%is_true(.true., name)
      end if
   end subroutine no_error

   !> It was refused, and the message contains the given words.
   subroutine fails_with(self, error, words, name)
      class(checks_t), intent(inout) :: self
      type(error_t), allocatable, intent(in) :: error
      character(len=*), intent(in) :: words
      character(len=*), intent(in) :: name

      if (.not. allocated(error)) then
         call self%is_true(.false., name//": no error was raised")
      else
         call self%is_true(index(error%message, words) > 0, name//": "//error%message)
      end if
   end subroutine fails_with

   !> It was refused with this message.
   subroutine fails_by(self, error, message)
      class(checks_t), intent(inout) :: self
      type(error_t), allocatable, intent(in) :: error
      character(len=*), intent(in) :: message
      character(len=:), allocatable :: found

      found = "no error"
      if (allocated(error)) found = error%message
      call self%is_true(found == message, "got:  "//found//new_line("a")//"FAILED: want: "//message)
   end subroutine fails_by

   !> Print the count and stop with status 1 if a check failed.
   subroutine finish(self)
      class(checks_t), intent(in) :: self

      print "(i0,a,i0,a)", self%n_passed, " passed, ", self%n_failed, " failed"
      if (self%n_failed > 0 .or. self%n_passed == 0) error stop 1, quiet = .true.
   end subroutine finish

end module testing_checks
