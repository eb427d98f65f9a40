!> Stream of bytes with named entries, for base_archive, which defines them.
!!
!! Extents of arrays are named in a text such as "2, cells": a number, or a name whose extent is
!! known (`set_extent`, not negative) or becomes known with the first array that has it. An array
!! with other extents is a fault. "?" after it: the array may be not allocated; "; 1:cells" or
!! "; 0:cells" at the end: its values are numbers of these elements, and 0 for none.
module base_stream
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_int64_t, c_loc, c_ptr, c_signed_char, &
                                                                             c_size_t
   use, intrinsic :: iso_fortran_env, only: int8
   use base_kinds, only: ik, lk
   implicit none(type, external)
   private

   public :: checksum, stream_t

   integer(lk), parameter :: least_entry = 10_lk  !< bytes of an entry without name and values

   !> Extent of all arrays whose entries have its name.
   type :: extent_t
      character(len=20) :: name = ""
      integer(lk) :: n = 0_lk
   end type extent_t

   !> Entries in the order in which they are stored and loaded.
   type :: stream_t
      logical :: is_loading = .false.
      integer(int8), allocatable :: bytes(:)
      integer(lk) :: length = 0_lk  !< bytes in use
      integer(lk) :: place = 0_lk  !< bytes loaded so far
      !> the first fault of loading; nothing is loaded after it
      character(len=:), allocatable :: fault
      type(extent_t), allocatable, private :: known(:)
   contains
      procedure :: begin_storing
      procedure :: begin_loading
      procedure :: enter
      procedure :: leave
      procedure :: count => visit_count
      procedure :: extent
      procedure :: set_extent
      procedure :: compare_extent
      procedure :: compare_range
      procedure :: agree
      procedure :: plain
      procedure :: append
      procedure :: head
      procedure :: fixed
      procedure :: move
      procedure :: set_fault
   end type stream_t

   interface
      !> CRC-32 of bytes that follow those with the checksum `before`, 0 at the beginning.
      function checksum(before, bytes, n_bytes) result(crc) bind(C, name="base_checksum")
         import :: c_int64_t, c_signed_char, c_size_t
         implicit none(type, external)
         integer(c_int64_t), value, intent(in) :: before
         ! allow(C071)
         integer(c_signed_char), intent(in) :: bytes(*)
         integer(c_size_t), value, intent(in) :: n_bytes
         integer(c_int64_t) :: crc
      end function checksum
   end interface

contains

   !> Empty the archive, to store values; its memory is kept.
   subroutine begin_storing(self)
      class(stream_t), intent(inout) :: self

      self%is_loading = .false.
      self%length = 0_lk
      self%place = 0_lk
   end subroutine begin_storing

   !> Load values from the beginning.
   subroutine begin_loading(self)
      class(stream_t), intent(inout) :: self

      self%is_loading = .true.
      self%place = 0_lk
      if (allocated(self%fault)) deallocate (self%fault)
      if (allocated(self%known)) deallocate (self%known)
   end subroutine begin_loading

   !> Begin a group of entries.
   subroutine enter(self, name)
      class(stream_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer(lk) :: none(0)
      logical :: exists

      exists = .true.
      call self%head(name, "g0", none, exists)
   end subroutine enter

   !> End a group.
   subroutine leave(self)
      class(stream_t), intent(inout) :: self

      call self%enter("")
   end subroutine leave

   !> Number of the elements that follow; -1: they are not allocated.
   subroutine visit_count(self, name, n)
      class(stream_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer(lk), intent(inout), target :: n
      integer(lk) :: none(0)
      logical :: exists

      exists = .true.
      call self%head(name, "n8", none, exists)
      call self%move(c_loc(n), 8_lk)
      if (.not. self%is_loading) return
      if (n < -1_lk .or. n > (self%length - self%place)/least_entry) call self%set_fault(name)
      if (allocated(self%fault)) n = -1_lk
   end subroutine visit_count

   !> Number of the elements that follow, of an array of any type; -1: it is not allocated.
   subroutine extent(self, name, array, n, expected)
      class(stream_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      class(*), optional, intent(in) :: array(:)
      integer(lk), intent(out) :: n
      character(len=*), optional, intent(in) :: expected  !< name of its extent

      n = -1_lk
      if (present(array)) n = size(array, kind=lk)
      call self%count(name, n)
      if (.not. (self%is_loading .and. present(expected))) return
      if (n >= 0_lk) call compare_extents(self, name, [n], expected)
      if (n < 0_lk .and. index(expected, "?") == 0) call self%set_fault(name)
   end subroutine extent

   !> All arrays with this name of an extent have n elements from here on.
   subroutine set_extent(self, name, n)
      class(stream_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer(ik), intent(in) :: n

      if (.not. self%is_loading) return
      if (.not. allocated(self%known)) allocate (self%known(0))
      self%known = [extent_t(name, int(n, lk)), pack(self%known, self%known%name /= name)]
   end subroutine set_extent

   !> The extent of this name is n: a fault, unless it is, or has not been known.
   subroutine compare_extent(self, name, n)
      class(stream_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer(ik), intent(in) :: n

      if (self%is_loading) call compare_extents(self, name, [int(n, lk)], name)
   end subroutine compare_extent

   !> Compare the extents of an array with those that its entry names.
   subroutine compare_extents(self, name, n, expected)
      class(stream_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer(lk), intent(in) :: n(:)
      character(len=*), intent(in) :: expected
      character(len=20) :: names(size(n))
      integer(lk) :: number
      integer :: i, k, status

      read (expected(:scan(expected//";", ";") - 1), *) names
      do i = 1, size(n)
         read (names(i), *, iostat=status) number
         if (status == 0) then
            if (number /= n(i)) call self%set_fault(name)
            cycle
         end if
         if (.not. allocated(self%known)) allocate (self%known(0))
         k = findloc(self%known%name, names(i), 1)
         if (k > 0) then
            if (self%known(k)%n < 0_lk) k = 0
         end if
         if (k == 0) then
            call self%set_extent(trim(names(i)), int(n(i), ik))
         else if (self%known(k)%n /= n(i)) then
            call self%set_fault(name)
         end if
      end do
   end subroutine compare_extents

   !> Arrays of which all or none are allocated.
   subroutine agree(self, name, are_allocated)
      class(stream_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      logical, intent(in) :: are_allocated(:)

      if (any(are_allocated) .and. .not. all(are_allocated)) call self%set_fault(name)
   end subroutine agree

   !> Compare numbers of elements with the range at the end of the names of the extents.
   subroutine compare_range(self, name, values, expected)
      class(stream_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer(ik), intent(in) :: values(:)
      character(len=*), intent(in) :: expected
      integer :: at, k

      at = index(expected, ";")
      if (at == 0 .or. .not. allocated(self%known)) return
      k = findloc(self%known%name, expected(index(expected, ":") + 1:), 1)
      if (any(values < merge(0, 1, expected(at + 2:at + 2) == "0"))) call self%set_fault(name)
      if (k == 0) return
      if (any(values > self%known(k)%n)) call self%set_fault(name)
   end subroutine compare_range

   !> Values of a type without pointers and allocatable components.
   subroutine plain(self, name, address, n_bytes)
      class(stream_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      type(c_ptr), intent(in) :: address
      integer(lk), intent(in) :: n_bytes  !< of all values

      call self%fixed(name, "b1", [n_bytes])
      call self%move(address, n_bytes)
   end subroutine plain

   !> The head of values that exist already.
   subroutine fixed(self, name, kind, extents)
      class(stream_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      character(len=2), intent(in) :: kind
      integer(lk), intent(in) :: extents(:)
      integer(lk) :: found(size(extents))
      logical :: exists

      exists = .true.
      found = extents
      call self%head(name, kind, found, exists)
      if (any(found /= extents) .or. .not. exists) call self%set_fault(name)
   end subroutine fixed

   !> Append the bytes of another archive that is being stored.
   subroutine append(self, other)
      class(stream_t), intent(inout) :: self
      class(stream_t), intent(in) :: other

      call reserve(self, other%length)
      self%bytes(self%length + 1:self%length + other%length) = other%bytes(:other%length)
      self%length = self%length + other%length
   end subroutine append

   !> The head of an entry: stored, or loaded and compared.
   subroutine head(self, name, kind, extents, exists, expected)
      class(stream_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      character(len=2), intent(in) :: kind
      integer(lk), intent(inout) :: extents(:)
      logical, intent(inout) :: exists  !< .false.: an array that is not allocated
      character(len=*), optional, intent(in) :: expected  !< names of the extents
      integer(ik) :: ranks
      character(len=64) :: found_name
      character(len=2) :: found_kind

      if (self%is_loading) then
         found_name = name
         found_kind = kind
         call load_head(self, found_name, found_kind, ranks, extents)
         if (found_name /= name .or. found_kind /= kind .or. &
             .not. any(ranks == [-1_ik, size(extents, kind=ik)])) call self%set_fault(name)
         if (present(expected) .and. ranks >= 0_ik .and. .not. allocated(self%fault)) then
            call compare_extents(self, name, extents, expected)
         else if (present(expected)) then
            if (index(expected, "?") == 0) call self%set_fault(name)
         end if
         exists = ranks >= 0_ik .and. .not. allocated(self%fault)
         if (.not. exists) extents = 0_lk
         return
      end if
      call put_integer(self, len(name, ik))
      call put_text(self, name)
      call put_text(self, kind)
      call put_integer(self, merge(size(extents, kind=ik), -1_ik, exists))
      if (exists) call put_extents(self, extents)
   end subroutine head

   !> Load a head. After a fault nothing changes.
   subroutine load_head(self, name, kind, ranks, extents)
      class(stream_t), intent(inout) :: self
      ! allow(C072)
      character(len=*), intent(inout), target :: name
      character(len=2), intent(inout), target :: kind
      integer(ik), intent(out), target :: ranks
      integer(lk), intent(inout) :: extents(:)
      integer(ik), target :: length
      integer(lk), target :: n(size(extents))

      length = 0
      ranks = -1
      call self%move(c_loc(length), 4_lk)
      if (length < 0 .or. length > len(name)) then
         call self%set_fault(name)
         return
      end if
      if (.not. allocated(self%fault)) name = ""
      if (length > 0) call self%move(c_loc(name), int(length, lk))
      call self%move(c_loc(kind), 2_lk)
      call self%move(c_loc(ranks), 4_lk)
      if (ranks /= size(extents)) return
      n = 0_lk
      if (size(n) > 0) call self%move(c_loc(n), 8_lk*size(n, kind=lk))
      if (.not. has_room(self, kind, n)) then
         call self%set_fault(name)
         n = 0_lk
      end if
      extents = n
   end subroutine load_head

   !> Whether values of these extents are no more than the bytes that are left.
   pure logical function has_room(self, kind, extents)
      class(stream_t), intent(in) :: self
      character(len=2), intent(in) :: kind
      integer(lk), intent(in) :: extents(:)
      integer(lk) :: left
      integer :: i

      left = self%length - self%place
      if (any(kind == ["r8", "i8"])) left = left/8_lk
      if (any(kind == ["i4", "l4"])) left = left/4_lk
      has_room = all(extents >= 0_lk)
      if (.not. has_room .or. any(extents == 0_lk)) then
         has_room = has_room .and. all(extents <= self%length)
         return
      end if
      do i = 1, size(extents)
         left = left/extents(i)
      end do
      has_room = left >= 1_lk .or. size(extents) == 0
   end function has_room

   subroutine put_integer(self, value)
      class(stream_t), intent(inout) :: self
      integer(ik), intent(in) :: value
      integer(ik), target :: kept

      kept = value
      call self%move(c_loc(kept), 4_lk)
   end subroutine put_integer

   subroutine put_extents(self, values)
      class(stream_t), intent(inout) :: self
      integer(lk), intent(in) :: values(:)
      integer(lk), target :: kept(size(values))

      kept = values
      if (size(kept) > 0) call self%move(c_loc(kept), 8_lk*size(kept, kind=lk))
   end subroutine put_extents

   subroutine put_text(self, value)
      class(stream_t), intent(inout) :: self
      character(len=*), intent(in) :: value
      character(len=len(value)), target :: kept

      kept = value
      if (len(kept) > 0) call self%move(c_loc(kept), len(kept, lk))
   end subroutine put_text

   !> Copy bytes between values and the archive.
   subroutine move(self, address, n_bytes)
      class(stream_t), intent(inout) :: self
      type(c_ptr), intent(in) :: address
      integer(lk), intent(in) :: n_bytes
      integer(int8), pointer :: values(:)

      if (n_bytes == 0_lk .or. allocated(self%fault)) return
      call c_f_pointer(address, values, [n_bytes])
      if (self%is_loading) then
         if (n_bytes > self%length - self%place) then
            call self%set_fault("the end")
            return
         end if
         values = self%bytes(self%place + 1:self%place + n_bytes)
         self%place = self%place + n_bytes
      else
         call reserve(self, n_bytes)
         self%bytes(self%length + 1:self%length + n_bytes) = values
         self%length = self%length + n_bytes
      end if
   end subroutine move

   !> Enlarge the buffer for more bytes.
   subroutine reserve(self, n_bytes)
      class(stream_t), intent(inout) :: self
      integer(lk), intent(in) :: n_bytes
      integer(int8), allocatable :: larger(:)

      if (.not. allocated(self%bytes)) allocate (self%bytes(65536))
      if (self%length + n_bytes <= size(self%bytes, kind=lk)) return
      allocate (larger(self%length + n_bytes + size(self%bytes, kind=lk)/2_lk))
      larger(:self%length) = self%bytes(:self%length)
      call move_alloc(larger, self%bytes)
   end subroutine reserve

   !> Note the first fault of loading.
   subroutine set_fault(self, name)
      class(stream_t), intent(inout) :: self
      character(len=*), intent(in) :: name  !< of the entry

      if (.not. self%is_loading .or. allocated(self%fault)) return
      self%fault = "no "//trim(name)//" at its place"
   end subroutine set_fault

end module base_stream
