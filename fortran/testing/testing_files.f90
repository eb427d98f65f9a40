!> What the test programs need to look at files.
module testing_files
   implicit none(type, external)
   private

   public :: file_exists, file_text

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

end module testing_files
