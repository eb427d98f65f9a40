!> The bytes of files that a scene names, or is.
!!
!! A scene may come from anybody, and names any file of this machine. So nothing that a file holds
!! goes into a message before the file has the form of a scene or of its table.
module scene_files
   use base_kinds, only: lk
   implicit none(type, external)
   private

   public :: load_file

   integer(lk), parameter :: largest_file = 4000000_lk  !< [byte]; more is no scene, and no table
   integer(lk), parameter :: largest_scene = 10000000_lk  !< [byte] of all its files

contains

   !> Read a whole file. What has no size, as a pipe or a device, is not opened: it may never end.
   subroutine load_file(path, n_read, source, fault)
      character(len=*), intent(in) :: path
      integer(lk), intent(inout) :: n_read  !< [byte] of all files of the scene so far
      character(len=:), allocatable, intent(out) :: source  !< its bytes
      character(len=:), allocatable, intent(out) :: fault  !< what it is instead
      character(len=256) :: reason
      integer(lk) :: n_bytes
      integer :: unit, status
      logical :: is_folder

      inquire (file=path, size=n_bytes)
      inquire (file=path//"/.", exist=is_folder)
      if (n_bytes < 0 .or. is_folder) then
         fault = "no file that can be read"
      else if (n_bytes == 0) then
         fault = "empty, a pipe or a device, but must be a file with text"
      else if (n_bytes > largest_file) then
         fault = "larger than the 4 MB that a file of a scene may have"
      else if (n_read + n_bytes > largest_scene) then
         fault = "one more file than the 10 MB that all files of a scene may have together"
      end if
      if (allocated(fault)) return
      open (newunit=unit, file=path, action="read", status="old", access="stream", &
            form="unformatted", iostat=status)
      if (status /= 0) then
         fault = "no file that can be read"
         return
      end if
      allocate (character(len=n_bytes) :: source)
      read (unit, iostat=status, iomsg=reason) source
      n_read = n_read + n_bytes
      if (status /= 0) fault = "a file that cannot be read: "//trim(reason)
      close (unit)
   end subroutine load_file

end module scene_files
