!> Directories, and files that appear whole: written aside as NAME.part, then renamed.
module output_files
   use base_errors, only: error_t, raise_error
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   use, intrinsic :: iso_fortran_env, only: int32, int64, int8, real64
   implicit none(type, external)
   private

   public :: make_directory, remove_file, rename_file, whole_file_t, write_text_file

   !> A file that gets its name when it is complete. The first failure is kept; `commit` reports it.
   type :: whole_file_t
      private
      character(len=:), allocatable :: path
      character(len=:), allocatable :: fault
      integer :: unit = 0
      logical :: is_open = .false.
      integer(int64) :: n_bytes = 0_int64  !< that were put
   contains
      procedure :: open => open_aside
      procedure :: commit
      procedure, private :: put_text
      procedure, private :: put_int8
      procedure, private :: put_int32
      procedure, private :: put_int64
      procedure, private :: put_real64
      generic :: put => put_text, put_int8, put_int32, put_int64, put_real64
   end type whole_file_t

   interface
      !> POSIX mkdir.
      function c_mkdir(path, mode) result(status) bind(C, name="mkdir")
         import :: c_char, c_int
         implicit none(type, external)
         ! allow(C071)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value, intent(in) :: mode
         integer(c_int) :: status
      end function c_mkdir

      !> Rename, replacing what has the new name, in one step that no reader sees half done.
      function c_rename(old_path, new_path) result(status) bind(C, name="rename")
         import :: c_char, c_int
         implicit none(type, external)
         ! allow(C071)
         character(kind=c_char), intent(in) :: old_path(*)
         ! allow(C071)
         character(kind=c_char), intent(in) :: new_path(*)
         integer(c_int) :: status
      end function c_rename

      !> Remove a file.
      function c_remove(path) result(status) bind(C, name="remove")
         import :: c_char, c_int
         implicit none(type, external)
         ! allow(C071)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int) :: status
      end function c_remove
   end interface

contains

   !> Make a directory and those above it; one that exists is fine.
   subroutine make_directory(path, error)
      character(len=*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      integer(c_int), parameter :: mode = int(o'777', c_int)  ! less the user's umask
      integer(c_int) :: status
      integer :: i
      logical :: is_there

      do i = 2, len_trim(path)
         if (path(i:i) == "/") status = c_mkdir(path(1:i - 1)//c_null_char, mode)
      end do
      status = c_mkdir(trim(path)//c_null_char, mode)
      if (status == 0) return
      inquire (file=trim(path)//"/.", exist=is_there)
      if (.not. is_there) then
         call raise_error(error, "", "cannot make the directory "//trim(path)// &
                          ": check that you may write there and that no file has this name")
      end if
   end subroutine make_directory

   !> Give a file a new name; a file that has it is replaced.
   subroutine rename_file(old_path, new_path, error)
      character(len=*), intent(in) :: old_path
      character(len=*), intent(in) :: new_path
      type(error_t), allocatable, intent(out) :: error

      if (c_rename(old_path//c_null_char, new_path//c_null_char) /= 0) then
         call raise_error(error, "", "cannot rename "//old_path//" to "//new_path)
      end if
   end subroutine rename_file

   !> Remove a file if it is there.
   subroutine remove_file(path, was_there)
      character(len=*), intent(in) :: path
      logical, intent(out) :: was_there

      was_there = c_remove(path//c_null_char) == 0
   end subroutine remove_file

   !> Write a text as a whole file.
   subroutine write_text_file(path, text, error)
      character(len=*), intent(in) :: path
      character(len=*), intent(in) :: text
      type(error_t), allocatable, intent(out) :: error
      type(whole_file_t) :: file

      call file%open(path)
      call file%put(text)
      call file%commit(error)
   end subroutine write_text_file

   !> Begin to write; the file has its name only after `commit`.
   subroutine open_aside(self, path)
      class(whole_file_t), intent(out) :: self
      character(len=*), intent(in) :: path
      character(len=256) :: message
      integer :: status

      self%path = path
      open (newunit=self%unit, file=path//".part", access="stream", form="unformatted", &
            action="write", status="replace", iostat=status, iomsg=message)
      self%is_open = status == 0
      call keep_fault(self, status, message)
   end subroutine open_aside

   !> Complete the file and give it its name; after a failure nothing is left but what was there
   !! before.
   subroutine commit(self, error)
      class(whole_file_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      character(len=256) :: message
      integer :: status
      integer(int64) :: n_bytes
      logical :: was_there

      if (self%is_open) then
         close (self%unit, iostat=status, iomsg=message)
         call keep_fault(self, status, message)
      end if
      if (.not. allocated(self%fault)) then  ! gfortran closes without a word what a full disk cut
         inquire (file=self%path//".part", size=n_bytes)
         if (n_bytes /= self%n_bytes) self%fault = "not all bytes were taken, the disk may be full"
      end if
      self%is_open = .false.
      if (allocated(self%fault)) then
         call remove_file(self%path//".part", was_there)
         call raise_error(error, "", "cannot write "//self%path//": "//self%fault)
      else
         call rename_file(self%path//".part", self%path, error)
      end if
   end subroutine commit

   subroutine put_text(self, text)
      class(whole_file_t), intent(inout) :: self
      character(len=*), intent(in) :: text
      character(len=256) :: message
      integer :: status

      if (allocated(self%fault)) return
      write (self%unit, iostat=status, iomsg=message) text
      call count_bytes(self, len(text, kind=int64), status, message)
   end subroutine put_text

   subroutine put_int8(self, values)
      class(whole_file_t), intent(inout) :: self
      integer(int8), intent(in) :: values(:)
      character(len=256) :: message
      integer :: status

      if (allocated(self%fault)) return
      write (self%unit, iostat=status, iomsg=message) values
      call count_bytes(self, size(values, kind=int64), status, message)
   end subroutine put_int8

   subroutine put_int32(self, values)
      class(whole_file_t), intent(inout) :: self
      integer(int32), intent(in) :: values(:)
      character(len=256) :: message
      integer :: status

      if (allocated(self%fault)) return
      write (self%unit, iostat=status, iomsg=message) values
      call count_bytes(self, 4_int64*size(values, kind=int64), status, message)
   end subroutine put_int32

   subroutine put_int64(self, value)
      class(whole_file_t), intent(inout) :: self
      integer(int64), intent(in) :: value
      character(len=256) :: message
      integer :: status

      if (allocated(self%fault)) return
      write (self%unit, iostat=status, iomsg=message) value
      call count_bytes(self, 8_int64, status, message)
   end subroutine put_int64

   subroutine put_real64(self, values)
      class(whole_file_t), intent(inout) :: self
      real(real64), intent(in) :: values(:)
      character(len=256) :: message
      integer :: status

      if (allocated(self%fault)) return
      write (self%unit, iostat=status, iomsg=message) values
      call count_bytes(self, 8_int64*size(values, kind=int64), status, message)
   end subroutine put_real64

   !> Count what was put, or keep the failure.
   subroutine count_bytes(self, n_bytes, status, message)
      class(whole_file_t), intent(inout) :: self
      integer(int64), intent(in) :: n_bytes
      integer, intent(in) :: status
      character(len=*), intent(in) :: message

      self%n_bytes = self%n_bytes + n_bytes
      call keep_fault(self, status, message)
   end subroutine count_bytes

   !> Keep the first failure.
   subroutine keep_fault(self, status, message)
      class(whole_file_t), intent(inout) :: self
      integer, intent(in) :: status
      character(len=*), intent(in) :: message

      if (status /= 0 .and. .not. allocated(self%fault)) self%fault = trim(message)
   end subroutine keep_fault

end module output_files
