!> Files that are always complete: written as NAME.part, then renamed; and the folder of a run. The
!! folder is not changed before the run has claimed it, and files of an earlier run remain until
!! they are replaced.
module report_files
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char, c_null_ptr, c_ptr, c_size_t
   use, intrinsic :: iso_fortran_env, only: int32, int64, int8, real64
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik
   use base_number, only: integer_text
   use base_texts, only: text_t
   implicit none(type, external)
   private

   public :: copy_file, make_directory, place_t, read_bytes, remove_file, rename_file
   public :: reserve_file, whole_file_t, write_text_file

   !> A file that gets its name when it is complete. `commit` reports the first failure.
   type :: whole_file_t
      character(len=:), allocatable :: path
      character(len=:), allocatable :: fault
      type(c_ptr) :: file = c_null_ptr
      logical :: is_open = .false.
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
      !> Functions of report_files.c; the status is 0 or the number of an error.
      function c_open(path, file) result(status) bind(C, name="output_open")
         import :: c_char, c_int, c_ptr
         implicit none(type, external)
         ! allow(C071)
         character(kind=c_char), intent(in) :: path(*)
         type(c_ptr), intent(out) :: file
         integer(c_int) :: status
      end function c_open

      function c_put(file, bytes, n_bytes) result(status) bind(C, name="output_put")
         import :: c_int, c_ptr, c_size_t
         implicit none(type, external)
         type(c_ptr), value, intent(in) :: file
         ! allow(C071)
         type(*), intent(in) :: bytes(*)
         integer(c_size_t), value, intent(in) :: n_bytes
         integer(c_int) :: status
      end function c_put

      function c_close(file) result(status) bind(C, name="output_close")
         import :: c_int, c_ptr
         implicit none(type, external)
         type(c_ptr), value, intent(in) :: file
         integer(c_int) :: status
      end function c_close

      subroutine c_reason(status, words, size) bind(C, name="output_reason")
         import :: c_char, c_int
         implicit none(type, external)
         integer(c_int), value, intent(in) :: status, size
         ! allow(C071, C072)
         character(kind=c_char), intent(out) :: words(*)
      end subroutine c_reason

      !> POSIX mkdir.
      function c_mkdir(path, mode) result(status) bind(C, name="mkdir")
         import :: c_char, c_int
         implicit none(type, external)
         ! allow(C071)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value, intent(in) :: mode
         integer(c_int) :: status
      end function c_mkdir

      !> Rename, replacing a file with the new name, in one step for all readers.
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

   character(len=*), parameter :: top_files(16) = [character(len=18) :: "scene.nml", "run.json", &
      & "history.csv", "tips.csv", "fractures.csv", "probes.csv", "network.json", "events.csv", &
      & "slip_events.csv", "wells.csv", "entries.csv", "run.log", &
      & "checkpoint.bin", "checkpoint_new.bin", "checkpoint_old.bin", "record.bin"]

   integer(c_int), parameter :: is_held = -1  !< by another run; as in report_files.c
   integer(c_int), parameter :: no_hold = -2

   !> The folder of a run, locked against other runs from `claim` to `release` or the end of the
   !! process.
   type :: place_t
      character(len=:), allocatable :: directory
      integer(c_int), private :: hold = no_hold
   contains
      procedure :: claim
      procedure :: has_results
      procedure :: clear
      procedure :: check
      procedure :: release
      procedure :: is_place_of
   end type place_t

   interface
      function c_same_file(a, b) result(answer) bind(C, name="output_same_file")
         import :: c_char, c_int
         implicit none(type, external)
         ! allow(C071)
         character(kind=c_char), intent(in) :: a(*)
         ! allow(C071)
         character(kind=c_char), intent(in) :: b(*)
         integer(c_int) :: answer
      end function c_same_file

      function c_hold_folder(path, holder) result(hold) bind(C, name="output_hold_folder")
         import :: c_char, c_int
         implicit none(type, external)
         ! allow(C071)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), intent(out) :: holder
         integer(c_int) :: hold
      end function c_hold_folder

      function c_is_folder(path, hold) result(answer) bind(C, name="output_is_folder")
         import :: c_char, c_int
         implicit none(type, external)
         ! allow(C071)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value, intent(in) :: hold
         integer(c_int) :: answer
      end function c_is_folder

      subroutine c_release_folder(hold) bind(C, name="output_release_folder")
         import :: c_int
         implicit none(type, external)
         integer(c_int), value, intent(in) :: hold
      end subroutine c_release_folder
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

   !> All bytes of a file; not allocated if it cannot be read.
   subroutine read_bytes(path, bytes)
      character(len=*), intent(in) :: path
      integer(int8), allocatable, intent(out) :: bytes(:)
      integer :: status, unit
      integer(int64) :: n

      open (newunit=unit, file=path, access="stream", form="unformatted", action="read", &
            status="old", iostat=status)
      if (status /= 0) return
      inquire (unit=unit, size=n)
      allocate (bytes(max(n, 0_int64)))
      read (unit, iostat=status) bytes
      if (status /= 0) deallocate (bytes)
      close (unit)
   end subroutine read_bytes

   !> Copy a file; one with the new name is replaced.
   subroutine copy_file(from, to, error)
      character(len=*), intent(in) :: from, to
      type(error_t), allocatable, intent(out) :: error
      type(whole_file_t) :: file
      integer(int8), allocatable :: bytes(:)

      call read_bytes(from, bytes)
      if (.not. allocated(bytes)) then
         call raise_error(error, "", "cannot read "//from)
         return
      end if
      call file%open(to)
      call file%put(bytes)
      call file%commit(error)
   end subroutine copy_file

   !> Reserve disk space for a file that will be written later, by a file NAME.part.
   subroutine reserve_file(path, n_bytes, error)
      character(len=*), intent(in) :: path
      integer, intent(in) :: n_bytes
      type(error_t), allocatable, intent(out) :: error
      type(whole_file_t) :: file

      call file%open(path)
      call file%put(repeat(" ", n_bytes))
      call end_writing(file, error)
   end subroutine reserve_file

   !> Begin a file, which gets its name by `commit`.
   subroutine open_aside(self, path)
      class(whole_file_t), intent(out) :: self
      character(len=*), intent(in) :: path
      integer(c_int) :: status

      self%path = path
      status = c_open(path//".part"//c_null_char, self%file)
      self%is_open = status == 0
      call keep_fault(self, status)
   end subroutine open_aside

   !> Complete the file and give it its name; after a failure an earlier file of this name remains.
   subroutine commit(self, error)
      class(whole_file_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      call end_writing(self, error)
      if (.not. allocated(error)) call rename_file(self%path//".part", self%path, error)
   end subroutine commit

   !> Complete NAME.part; after a failure it is removed.
   subroutine end_writing(self, error)
      class(whole_file_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      logical :: was_there

      if (self%is_open) call keep_fault(self, c_close(self%file))
      self%is_open = .false.
      if (.not. allocated(self%fault)) return
      call remove_file(self%path//".part", was_there)
      call raise_error(error, "", "cannot write "//self%path//": "//self%fault)
   end subroutine end_writing

   subroutine put_text(self, text)
      class(whole_file_t), intent(inout) :: self
      character(len=*), intent(in) :: text

      if (allocated(self%fault)) return
      call keep_fault(self, c_put(self%file, [text], len(text, c_size_t)))
   end subroutine put_text

   subroutine put_int8(self, values)
      class(whole_file_t), intent(inout) :: self
      integer(int8), intent(in) :: values(:)

      if (allocated(self%fault)) return
      call keep_fault(self, c_put(self%file, values, size(values, kind=c_size_t)))
   end subroutine put_int8

   subroutine put_int32(self, values)
      class(whole_file_t), intent(inout) :: self
      integer(int32), intent(in) :: values(:)

      if (allocated(self%fault)) return
      call keep_fault(self, c_put(self%file, values, 4*size(values, kind=c_size_t)))
   end subroutine put_int32

   subroutine put_int64(self, value)
      class(whole_file_t), intent(inout) :: self
      integer(int64), intent(in) :: value

      if (allocated(self%fault)) return
      call keep_fault(self, c_put(self%file, [value], 8_c_size_t))
   end subroutine put_int64

   subroutine put_real64(self, values)
      class(whole_file_t), intent(inout) :: self
      real(real64), intent(in) :: values(:)

      if (allocated(self%fault)) return
      call keep_fault(self, c_put(self%file, values, 8*size(values, kind=c_size_t)))
   end subroutine put_real64

   !> Keep the first failure.
   subroutine keep_fault(self, status)
      class(whole_file_t), intent(inout) :: self
      integer(c_int), intent(in) :: status  !< of report_files.c
      character(kind=c_char) :: words(100)
      integer :: i

      if (status == 0 .or. allocated(self%fault)) return
      call c_reason(status, words, size(words, kind=c_int))
      self%fault = ""
      do i = 1, findloc(words, c_null_char, dim=1) - 1
         self%fault = self%fault//words(i)
      end do
   end subroutine keep_fault

   !> Make the folder and lock it. `refused`: the folder cannot be used, and nothing was written.
   subroutine claim(self, directory, source, refused, error)
      class(place_t), intent(out) :: self
      character(len=*), intent(in) :: directory
      character(len=*), intent(in) :: source  !< path of the scene that is run; empty: no file
      logical, intent(out) :: refused
      type(error_t), allocatable, intent(out) :: error
      integer(c_int) :: holder
      integer :: i

      self%directory = trim(directory)
      refused = .false.
      do i = 1, size(top_files)
         if (source == "") exit
         refused = c_same_file(source//c_null_char, path_in(self, top_files(i))//c_null_char) /= 0
         if (refused) then
            call raise_error(error, "", "the run would replace "//source//" by its own "// &
                             trim(top_files(i))//": name another folder than "//self%directory// &
                             " with --out")
            return
         end if
      end do
      call make_directory(self%directory, error)
      if (allocated(error)) then
         refused = leads_through_file(self%directory)
         return
      end if
      self%hold = c_hold_folder(self%directory//c_null_char, holder)
      refused = self%hold == is_held
      if (refused) call raise_error(error, "", "another run"//process_text(holder)// &
                                    " writes into "//self%directory// &
                                    ": wait for its end, or name another folder with --out")
   end subroutine claim

   !> A path, or a beginning of it, is that of a file.
   function leads_through_file(path) result(answer)
      character(len=*), intent(in) :: path
      logical :: answer, exists, is_folder
      integer :: i

      answer = .false.
      do i = 1, len(path)
         if (i < len(path)) then
            if (path(i + 1:i + 1) /= "/") cycle
         end if
         inquire (file=path(:i), exist=exists)
         inquire (file=path(:i)//"/.", exist=is_folder)
         answer = answer .or. (exists .and. .not. is_folder)
      end do
   end function leads_through_file

   !> The number of a process in words, if it is known.
   pure function process_text(process) result(text)
      integer(c_int), intent(in) :: process
      character(len=:), allocatable :: text

      text = ""
      if (process > 0) text = " (process "//integer_text(int(process, ik))//")"
   end function process_text

   !> The folder contains files of a run.
   function has_results(self)
      class(place_t), intent(in) :: self
      logical :: has_results
      integer :: i

      do i = 1, size(top_files)
         inquire (file=path_in(self, top_files(i)), exist=has_results)
         if (has_results) return
      end do
   end function has_results

   !> Remove the files of an earlier run except scene.nml, which this run has written.
   subroutine clear(self)
      class(place_t), intent(in) :: self
      logical :: was_there
      integer :: i

      do i = 1, size(top_files)
         call remove_file(path_in(self, top_files(i))//".part", was_there)
         if (top_files(i) /= "scene.nml") call remove_file(path_in(self, top_files(i)), was_there)
      end do
   end subroutine clear

   !> Raise an error if the folder or written files have been removed or replaced.
   subroutine check(self, files, error)
      class(place_t), intent(in) :: self
      type(text_t), intent(in) :: files(:)  !< paths in the folder
      type(error_t), allocatable, intent(out) :: error
      logical :: exists
      integer :: i

      if (c_is_folder(self%directory//c_null_char, self%hold) == 0) then
         call raise_error(error, "", "the folder "//self%directory// &
                          " was removed or replaced during the run")
         return
      end if
      do i = 1, size(files)
         inquire (file=path_in(self, files(i)%text), exist=exists)
         if (exists) cycle
         call raise_error(error, "", path_in(self, files(i)%text)//" was removed during the run")
         return
      end do
   end subroutine check

   !> Both paths lead to this folder.
   function is_place_of(self, directory)
      class(place_t), intent(in) :: self
      character(len=*), intent(in) :: directory
      logical :: is_place_of

      is_place_of = c_same_file(self%directory//c_null_char, directory//c_null_char) /= 0
   end function is_place_of

   !> Unlock the folder.
   subroutine release(self)
      class(place_t), intent(inout) :: self

      if (self%hold >= 0_c_int) call c_release_folder(self%hold)
      self%hold = no_hold
   end subroutine release

   !> Path of a file in the folder.
   pure function path_in(place, name) result(path)
      class(place_t), intent(in) :: place
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: path

      path = place%directory//"/"//trim(name)
   end function path_in

end module report_files
