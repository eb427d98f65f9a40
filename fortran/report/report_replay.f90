!> The record of a run, record.bin in its folder: all decisions between two accepted states
!! (base_tape), from which another run takes them.
!!
!! The file is a sequence of parts, each with the number of its bytes (int64), their checksum
!! (CRC-32, int64), and the bytes: the first one has the version of this format and that of the
!! program, each of the others the decisions up to one accepted state. The file is complete at any
!! time, and can be cut after any part.
module report_replay
   use, intrinsic :: iso_c_binding, only: c_size_t
   use, intrinsic :: iso_fortran_env, only: int8
   use base_archive, only: archive_t
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, lk
   use base_stream, only: checksum
   use report_files, only: read_bytes
   implicit none(type, external)
   private

   public :: first_part, part_of, read_record, record_name

   character(len=*), parameter :: record_name = "record.bin"
   integer(ik), parameter :: format_version = 1

contains

   !> A part of the file with these bytes.
   function part_of(bytes) result(text)
      integer(int8), intent(in) :: bytes(:)
      character(len=:), allocatable :: text
      integer(lk) :: head(2)

      head = [size(bytes, kind=lk), checksum(0_lk, bytes, size(bytes, kind=c_size_t))]
      allocate (character(len=16 + size(bytes)) :: text)
      text(:16) = transfer(head, text(:16))
      if (size(bytes) > 0) text(17:) = transfer(bytes, text(17:))
   end function part_of

   function first_part(version) result(text)
      character(len=*), intent(in) :: version  !< of the program
      character(len=:), allocatable :: text
      type(archive_t) :: archive
      character(len=:), allocatable :: program
      integer(ik) :: format

      format = format_version
      program = version
      call archive%begin_storing()
      call visit(archive, format, program)
      text = part_of(archive%bytes(:archive%length))
   end function first_part

   subroutine visit(archive, format, program)
      type(archive_t), intent(inout) :: archive
      integer(ik), intent(inout) :: format
      character(len=:), allocatable, intent(inout) :: program

      call archive%item("record", format)
      call archive%list("version", program)
   end subroutine visit

   !> Read the decisions of a run, up to the first part that is not whole.
   subroutine read_record(directory, version, record, error)
      character(len=*), intent(in) :: directory
      character(len=*), intent(in) :: version  !< of the program
      integer(int8), allocatable, intent(out) :: record(:)
      type(error_t), allocatable, intent(out) :: error
      integer(int8), allocatable :: bytes(:)
      character(len=:), allocatable :: program
      type(archive_t) :: archive
      integer(lk) :: at, head(2), length
      integer(ik) :: format

      call read_bytes(directory//"/"//record_name, bytes)
      if (.not. allocated(bytes)) then
         call raise_error(error, "", "&time replay: "//directory//" has no record ("// &
                          record_name//") that can be read")
         return
      end if
      at = 0_lk
      length = 0_lk
      do while (at + 16_lk <= size(bytes, kind=lk))
         head = transfer(bytes(at + 1:at + 16), head)
         if (head(1) < 0_lk .or. head(1) > size(bytes, kind=lk) - at - 16_lk) exit
         associate (part => bytes(at + 17:at + 16 + head(1)))
            if (checksum(0_lk, part, int(head(1), c_size_t)) /= head(2)) exit
            if (at == 0_lk) archive%bytes = part
            if (at > 0_lk) bytes(length + 1:length + head(1)) = part
         end associate
         if (at > 0_lk) length = length + head(1)
         at = at + 16_lk + head(1)
      end do
      format = 0
      if (allocated(archive%bytes)) then
         archive%length = size(archive%bytes, kind=lk)
         call archive%begin_loading()
         call visit(archive, format, program)
      end if
      if (format /= format_version) then
         call raise_error(error, "", "&time replay: "//directory//"/"//record_name// &
                          " is damaged, or no record of this format")
      else if (program /= version) then
         call raise_error(error, "", "&time replay: "//directory//"/"//record_name// &
                          " is of version "//program//" of the program, and this one is "//version)
      else
         record = bytes(:length)
      end if
   end subroutine read_record

end module report_replay
