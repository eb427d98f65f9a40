!> What the programs of verification cases share: arguments, one table of results, run.json.
module verification_files
   use, intrinsic :: iso_fortran_env, only: error_unit
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: finish, integer_argument, number, real_argument, stop_on, table_t, text_argument

   !> A CSV file, written row by row.
   type :: table_t
      integer :: unit = -1
   contains
      procedure :: open => open_table
      procedure :: row
      procedure :: close => close_table
   end type table_t

contains

   !> Create the file with its first row.
   subroutine open_table(self, path, header)
      class(table_t), intent(inout) :: self
      character(len=*), intent(in) :: path, header

      open (newunit=self%unit, file=path, status="replace", action="write")
      write (self%unit, "(a)") header
   end subroutine open_table

   !> A row of numbers, with all their digits.
   subroutine row(self, values)
      class(table_t), intent(in) :: self
      real(rk), intent(in) :: values(:)
      integer :: i

      do i = 1, size(values)
         if (i > 1) write (self%unit, "(a)", advance="no") ","
         write (self%unit, "(a)", advance="no") number(values(i))
      end do
      write (self%unit, "()")
   end subroutine row

   subroutine close_table(self)
      class(table_t), intent(inout) :: self

      close (self%unit)
   end subroutine close_table

   !> Say in run.json that the program has come to its end, and how long it took.
   subroutine finish()
      type(table_t) :: file
      real(rk) :: seconds

      call cpu_time(seconds)
      call file%open("run.json", '{"status": "finished", "cpu_s": '//number(seconds)//"}")
      call file%close()
   end subroutine finish

   !> End with exit status 1 and the reason on stderr if there is an error.
   subroutine stop_on(error)
      type(error_t), allocatable, intent(in) :: error

      if (.not. allocated(error)) return
      write (error_unit, "(a)") error%message
      error stop 1
   end subroutine stop_on

   !> A number as text; not a finite number becomes nan or inf, which the judge refuses.
   function number(value) result(text)
      real(rk), intent(in) :: value
      character(len=:), allocatable :: text
      character(len=32) :: buffer

      write (buffer, "(es24.16e3)") value
      text = trim(adjustl(buffer))
   end function number

   !> Argument i of the command line.
   function text_argument(i) result(text)
      integer, intent(in) :: i
      character(len=:), allocatable :: text
      integer :: length

      if (command_argument_count() < i) then
         write (error_unit, "(a,i0,a)") "argument ", i, " is missing"
         error stop 2
      end if
      call get_command_argument(i, length=length)
      allocate (character(len=length) :: text)
      call get_command_argument(i, text)
   end function text_argument

   real(rk) function real_argument(i)
      integer, intent(in) :: i

      character(len=:), allocatable :: text

      text = text_argument(i)
      read (text, *) real_argument
   end function real_argument

   integer(ik) function integer_argument(i)
      integer, intent(in) :: i

      character(len=:), allocatable :: text

      text = text_argument(i)
      read (text, *) integer_argument
   end function integer_argument

end module verification_files
