!> Tests of report_files: a name belongs to a whole file or to none, also when writing fails.
program test_report_files
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   use base_errors, only: error_t
   use report_files, only: make_directory, remove_file, rename_file, whole_file_t, write_text_file
   use testing_checks, only: checks_t
   use testing_files, only: file_exists, file_text
   implicit none(type, external)

   interface
      !> POSIX symlink.
      function c_symlink(target_path, link_path) result(status) bind(C, name="symlink")
         import :: c_char, c_int
         implicit none(type, external)
         ! allow(C071)
         character(kind=c_char), intent(in) :: target_path(*)
         ! allow(C071)
         character(kind=c_char), intent(in) :: link_path(*)
         integer(c_int) :: status
      end function c_symlink
   end interface

   character(len=*), parameter :: top = "test_report_files.out"
   character(len=*), parameter :: path = top//"/a/b/file.txt"
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(whole_file_t) :: file
   logical :: was_there
   integer :: i

   call make_directory(top//"/a/b", error)
   call checks%no_error(error, "nested directories are made")
   call make_directory(top//"/a/b/", error)
   call checks%no_error(error, "a directory that exists is fine")
   call write_text_file(path, "old", error)
   call checks%no_error(error, "a file is written")
   call checks%is_true(file_text(path) == "old", "it holds the text")
   call make_directory(path, error)
   call checks%fails_with(error, "file.txt", "a file in the way of a directory is refused")
   call write_text_file(top//"/missing/file.txt", "text", error)
   call checks%fails_with(error, "missing/file.txt", "a missing directory is refused")
   call checks%is_true(.not. file_exists(top//"/missing"), "and nothing appears")

   ! While a file is written, and if the process dies then, its name belongs to the old text.
   call file%open(path)
   do i = 1, 100000
      call file%put("new text ")
   end do
   call checks%is_true(file_text(path) == "old", "the old text stays until the new one is whole")
   call checks%is_true(file_exists(path//".part"), "the new text waits aside")
   call file%commit(error)
   call checks%no_error(error, "the new text is put in place")
   call checks%is_true(file_text(path) == repeat("new text ", 100000), "the new text is whole")
   call checks%is_true(.not. file_exists(path//".part"), "nothing is left aside")

   ! A full disk: the text aside goes to a device that takes nothing.
   if (file_exists("/dev/full")) then
      if (c_symlink("/dev/full"//c_null_char, path//".part"//c_null_char) == 0) then
         call write_text_file(path, repeat("x", 1000000), error)
         call checks%fails_with(error, path, "a full disk is reported")
         call checks%is_true(file_text(path) == repeat("new text ", 100000), "the old text stays")
      end if
      call remove_file(path//".part", was_there)
      if (c_symlink("/dev/full"//c_null_char, path//".part"//c_null_char) == 0) then
         call write_text_file(path, "short", error)
         call checks%fails_with(error, path, "a full disk is reported for a buffered text too")
      end if
   end if

   call rename_file(path, top//"/a/moved.txt", error)
   call checks%no_error(error, "a file is renamed")
   call rename_file(path, top//"/a/moved.txt", error)
   call checks%fails_with(error, "rename", "a missing file cannot be renamed")
   call remove_file(top//"/a/moved.txt", was_there)
   call checks%is_true(was_there, "a file is removed")
   call checks%is_true(.not. file_exists(top//"/a/moved.txt"), "and gone")
   call remove_file(top//"/a/moved.txt", was_there)
   call checks%is_true(.not. was_there, "a missing file was not there")
   call checks%finish()
end program test_report_files
