!> What the test programs need to look at files.
!!
!! Whether a page of docs/ that the program writes is still what the program would write.
module testing_files
   use testing_checks, only: checks_t
   implicit none(type, external)
   private

   public :: check_page, file_exists, file_text

contains

   !> A file of this name is there.
   logical function file_exists(path)
      character(len=*), intent(in) :: path

      inquire (file=path, exist=file_exists)
   end function file_exists

   !> All bytes of a file; nothing if it cannot be read.
   function file_text(path) result(text)
      character(len=*), intent(in) :: path
      character(len=:), allocatable :: text
      integer :: unit, status, n_bytes

      text = ""
      open (newunit=unit, file=path, access="stream", form="unformatted", action="read", &
            status="old", iostat=status)
      if (status /= 0) return
      inquire (unit, size=n_bytes)
      if (n_bytes > 0) then
         deallocate (text)
         allocate (character(len=n_bytes) :: text)
         read (unit, iostat=status) text
         if (status /= 0) text = ""
      end if
      close (unit)
   end function file_text

   !> Compare line by line. CTest hands over the source tree in the environment.
   subroutine check_page(checks, code, name)
      type(checks_t), intent(inout) :: checks
      integer, intent(in) :: code  !< unit of the page from the code, at its beginning
      character(len=*), intent(in) :: name  !< of the page in the source tree
      character(len=1024) :: from_code, from_page, source
      character(len=8) :: number
      integer :: page, code_status, page_status, line

      call get_environment_variable("WINGCRACK_SOURCE", source)
      open (newunit=page, file=trim(source)//"/"//name, action="read", status="old", &
            iostat=page_status)
      call checks%is_true(page_status == 0, name//" exists")
      line = 0
      do while (page_status == 0)
         read (code, "(a)", iostat=code_status) from_code
         read (page, "(a)", iostat=page_status) from_page
         line = line + 1
         write (number, "(i0)") line
         call checks%is_true((code_status == 0) .eqv. (page_status == 0), &
                             name//" is as long as the page from the code; line "//trim(number))
         if (code_status /= 0 .or. page_status /= 0) exit
         call checks%is_true(from_code == from_page, name//", line "//trim(number)//": "// &
                             trim(from_page))
      end do
      call checks%is_true(line > 60, "the page is whole")
   end subroutine check_page

end module testing_files
