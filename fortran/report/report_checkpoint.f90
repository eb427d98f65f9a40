!> Checkpoints: the complete state of a run between two accepted states, in two files of its folder,
!! the newest one and the one before it.
!!
!! A file has a head of 32 bytes, a text of 16 characters, the number of bytes that follow the head
!! (int64) and their checksum (CRC-32, int64), and then the entries of an archive (base_archive):
!! the group `about` (version of this format and of the program, name and time of the state, the
!! scene as in scene.nml), the group `texts` (tables, collections, network and log so far), and the
!! state. docs/output.md describes it, and post/wingcrack/runs reads it.
module report_checkpoint
   use, intrinsic :: iso_c_binding, only: c_size_t
   use, intrinsic :: iso_fortran_env, only: int8
   use base_archive, only: archive_t
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, lk, rk
   use base_number, only: brief_text
   use base_stream, only: checksum
   use report_files, only: read_bytes, rename_file, whole_file_t
   implicit none(type, external)
   private

   public :: about_t, read_checkpoint, write_checkpoint

   character(len=*), parameter :: magic = "wingcrack state"//achar(10)
   integer(ik), parameter :: format_version = 15
   integer(lk), parameter :: head_size = 32_lk

   character(len=*), parameter :: newest = "checkpoint.bin", complete = "checkpoint_new.bin"
   character(len=*), parameter :: before = "checkpoint_old.bin"

   !> What a checkpoint holds.
   type :: about_t
      integer(ik) :: format = format_version
      character(len=:), allocatable :: version  !< of the program
      character(len=:), allocatable :: state  !< "3600 s", "load factor 0.5"
      real(rk) :: time = 0.0_rk  !< [s], or load factor [-]
      character(len=:), allocatable :: scene  !< text of the scene with all values
   contains
      procedure :: visit
   end type about_t

contains

   subroutine visit(self, archive)
      class(about_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive

      call archive%enter("about")
      call archive%item("format", self%format)
      call archive%list("version", self%version)
      call archive%list("state", self%state)
      call archive%item("time", self%time)
      call archive%list("scene", self%scene)
      call archive%leave()
   end subroutine visit

   !> Write a checkpoint aside; then it takes the place of the newest one, which becomes the one
   !! before it.
   subroutine write_checkpoint(directory, head, state, error)
      character(len=*), intent(in) :: directory
      type(archive_t), intent(in) :: head  !< groups about and texts
      type(archive_t), intent(in) :: state
      type(error_t), allocatable, intent(out) :: error
      type(whole_file_t) :: file
      integer(lk) :: crc
      logical :: exists

      crc = checksum(0_lk, head%bytes, int(head%length, c_size_t))
      crc = checksum(crc, state%bytes, int(state%length, c_size_t))
      call file%open(directory//"/"//complete)
      call file%put(magic)
      call file%put(head%length + state%length)
      call file%put(crc)
      call file%put(head%bytes(:head%length))
      call file%put(state%bytes(:state%length))
      call file%commit(error)
      if (allocated(error)) return
      inquire (file=directory//"/"//newest, exist=exists)
      if (exists) call rename_file(directory//"/"//newest, directory//"/"//before, error)
      if (.not. allocated(error)) call rename_file(directory//"/"//complete, &
                                                   directory//"/"//newest, error)
   end subroutine write_checkpoint

   !> Read the newest checkpoint of a folder that can be used. `remark` says which ones cannot.
   subroutine read_checkpoint(directory, version, about, archive, remark, error)
      character(len=*), intent(in) :: directory
      character(len=*), intent(in) :: version  !< of the program
      type(about_t), intent(out) :: about
      type(archive_t), intent(out) :: archive  !< to be loaded after the group about
      character(len=:), allocatable, intent(out) :: remark
      type(error_t), allocatable, intent(out) :: error
      character(len=len(complete)), parameter :: names(3) = [character(len=len(complete)) :: &
                                                             complete, newest, before]
      character(len=:), allocatable :: path, reason
      integer :: i
      logical :: exists

      remark = ""
      do i = 1, size(names)
         path = directory//"/"//trim(names(i))
         inquire (file=path, exist=exists)
         if (.not. exists) cycle
         call read_one(path, version, about, archive, reason)
         if (.not. allocated(reason)) then
            if (len(remark) > 0) remark = remark//"; "//path//" is used, of "//about%state
            return
         end if
         if (len(remark) > 0) remark = remark//"; "
         remark = remark//path//" "//reason
      end do
      if (len(remark) == 0) remark = directory//" has no checkpoint: runs with &output "// &
                                     "checkpoint = 0, and those that ended before their first "// &
                                     "state, have none"
      call raise_error(error, "", remark)
   end subroutine read_checkpoint

   !> Read one checkpoint; `reason`: why it cannot be used.
   subroutine read_one(path, version, about, archive, reason)
      character(len=*), intent(in) :: path
      character(len=*), intent(in) :: version
      type(about_t), intent(out) :: about
      type(archive_t), intent(out) :: archive
      character(len=:), allocatable, intent(out) :: reason
      integer(int8), allocatable :: bytes(:)
      integer(lk) :: crc, n

      call read_bytes(path, bytes)
      if (.not. allocated(bytes)) then
         reason = "cannot be read"
         return
      end if
      n = size(bytes, kind=lk) - head_size
      reason = "is damaged"
      if (n < 0_lk) return
      if (transfer(bytes(:len(magic)), magic) /= magic) then
         reason = "is no checkpoint"
         return
      end if
      if (transfer(bytes(17:24), n) /= n) return
      crc = checksum(0_lk, bytes(head_size + 1:), int(n, c_size_t))
      if (transfer(bytes(25:32), crc) /= crc) return
      deallocate (reason)
      archive%bytes = bytes(head_size + 1:)
      archive%length = n
      call archive%begin_loading()
      call about%visit(archive)
      if (allocated(archive%fault)) then
         reason = "has another format"
      else if (about%format /= format_version) then
         reason = "has another format, number "//brief_text(real(about%format, rk), 3)
      else if (about%version /= version) then
         reason = "is of version "//about%version//" of the program, and this one is "//version
      end if
   end subroutine read_one

end module report_checkpoint
