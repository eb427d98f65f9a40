!> Archive of values: the same procedure stores a value or loads it, so that a type is stored and
!! loaded by one list of its components (`visit`), in which none can be forgotten on one side only.
!!
!! An archive is a sequence of entries. Each begins with its head: length of the name (int32), name,
!! kind of the values (two characters), rank (int32), extents (int64 each), then come the values, as
!! they are in memory, the first index fastest. The rank is -1 for an array that is not allocated.
!!
!!   kind   values
!!   r8     real, 8 bytes          i4, i8  integer, 4 and 8 bytes
!!   l4     logical, 4 bytes       c1      characters
!!   b1     bytes of values of a type that has neither pointers nor allocatable components
!!   n8     number of the elements that follow, each as entries; -1: not allocated
!!   g0     begin of a group of entries with this name; an empty name ends the group
!!
!! Extents of an array that is loaded are compared with those that its entry names (base_stream).
module base_archive
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_loc, c_ptr
   use, intrinsic :: iso_fortran_env, only: int8
   use base_kinds, only: ik, lk, rk
   use base_stream, only: stream_t
   use base_texts, only: text_t
   implicit none(type, external)
   private

   public :: archive_t

   !> Values in the order in which they are stored and loaded.
   type, extends(stream_t) :: archive_t
   contains
      procedure :: texts
      procedure, private :: item_real, item_integer, item_long, item_logical, item_text
      generic :: item => item_real, item_integer, item_long, item_logical, item_text
      procedure, private :: list_real, list_integer, list_logical, list_byte, list_text
      generic :: list => list_real, list_integer, list_logical, list_byte, list_text
   end type archive_t

contains

   !> A list of texts.
   subroutine texts(self, name, list)
      class(archive_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      type(text_t), allocatable, intent(inout) :: list(:)
      integer(lk) :: i, n

      n = -1_lk
      if (allocated(list)) n = size(list, kind=lk)
      call self%count(name, n)
      if (self%is_loading) then
         if (allocated(list)) deallocate (list)
         if (n >= 0_lk) allocate (list(n))
      end if
      do i = 1_lk, n
         call self%list(name, list(i)%text)
      end do
   end subroutine texts

   subroutine item_real(self, name, x)
      class(archive_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(rk), intent(inout), target, contiguous :: x(..)

      call self%fixed(name, "r8", shape(x, lk))
      call self%move(c_loc(x), 8_lk*size(x, kind=lk))
   end subroutine item_real

   subroutine item_integer(self, name, x)
      class(archive_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer(ik), intent(inout), target, contiguous :: x(..)

      call self%fixed(name, "i4", shape(x, lk))
      call self%move(c_loc(x), 4_lk*size(x, kind=lk))
   end subroutine item_integer

   subroutine item_long(self, name, x)
      class(archive_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer(lk), intent(inout), target, contiguous :: x(..)

      call self%fixed(name, "i8", shape(x, lk))
      call self%move(c_loc(x), 8_lk*size(x, kind=lk))
   end subroutine item_long

   subroutine item_logical(self, name, x)
      class(archive_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      logical, intent(inout), target, contiguous :: x(..)

      call self%fixed(name, "l4", shape(x, lk))
      call self%move(c_loc(x), 4_lk*size(x, kind=lk))
      call check_logicals(self, name, c_loc(x), size(x, kind=lk))
   end subroutine item_logical

   subroutine item_text(self, name, x)
      class(archive_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      ! allow(C072)
      character(len=*), intent(inout), target :: x

      call self%fixed(name, "c1", [len(x, lk)])
      call self%move(c_loc(x), len(x, lk))
   end subroutine item_text

   subroutine list_real(self, name, x, extents)
      class(archive_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(rk), allocatable, intent(inout), target :: x(..)
      character(len=*), optional, intent(in) :: extents  !< of base_stream
      integer(lk) :: n(rank(x))
      logical :: exists

      exists = allocated(x)
      n = 0_lk
      if (exists) n = shape(x, lk)
      call self%head(name, "r8", n, exists, extents)
      if (self%is_loading) then
         select rank (x)
         rank (1)
            if (allocated(x)) deallocate (x)
            if (exists) allocate (x(n(1)))
         rank (2)
            if (allocated(x)) deallocate (x)
            if (exists) allocate (x(n(1), n(2)))
         rank (3)
            if (allocated(x)) deallocate (x)
            if (exists) allocate (x(n(1), n(2), n(3)))
         rank (4)
            if (allocated(x)) deallocate (x)
            if (exists) allocate (x(n(1), n(2), n(3), n(4)))
         end select
      end if
      if (exists) call self%move(c_loc(x), 8_lk*product(n))
   end subroutine list_real

   subroutine list_integer(self, name, x, extents)
      class(archive_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer(ik), allocatable, intent(inout), target :: x(..)
      character(len=*), optional, intent(in) :: extents  !< of base_stream
      integer(lk) :: n(rank(x))
      integer(ik), pointer :: values(:)
      logical :: exists

      exists = allocated(x)
      n = 0_lk
      if (exists) n = shape(x, lk)
      call self%head(name, "i4", n, exists, extents)
      if (self%is_loading) then
         select rank (x)
         rank (1)
            if (allocated(x)) deallocate (x)
            if (exists) allocate (x(n(1)))
         rank (2)
            if (allocated(x)) deallocate (x)
            if (exists) allocate (x(n(1), n(2)))
         rank (3)
            if (allocated(x)) deallocate (x)
            if (exists) allocate (x(n(1), n(2), n(3)))
         end select
      end if
      if (exists) call self%move(c_loc(x), 4_lk*product(n))
      if (.not. (self%is_loading .and. exists .and. present(extents))) return
      if (product(n) == 0_lk) return
      call c_f_pointer(c_loc(x), values, [product(n)])
      call self%compare_range(name, values, extents)
   end subroutine list_integer

   subroutine list_logical(self, name, x, extents)
      class(archive_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      logical, allocatable, intent(inout), target :: x(..)
      character(len=*), optional, intent(in) :: extents  !< of base_stream
      integer(lk) :: n(rank(x))
      logical :: exists

      exists = allocated(x)
      n = 0_lk
      if (exists) n = shape(x, lk)
      call self%head(name, "l4", n, exists, extents)
      if (self%is_loading) then
         select rank (x)
         rank (1)
            if (allocated(x)) deallocate (x)
            if (exists) allocate (x(n(1)))
         rank (2)
            if (allocated(x)) deallocate (x)
            if (exists) allocate (x(n(1), n(2)))
         end select
      end if
      if (.not. exists) return
      call self%move(c_loc(x), 4_lk*product(n))
      call check_logicals(self, name, c_loc(x), product(n))
   end subroutine list_logical

   !> Other values than those of .true. and .false. would be neither.
   subroutine check_logicals(self, name, address, n)
      class(archive_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      type(c_ptr), intent(in) :: address
      integer(lk), intent(in) :: n
      integer(ik), pointer :: values(:)

      if (.not. self%is_loading .or. n == 0_lk) return
      call c_f_pointer(address, values, [n])
      if (any(values /= 0_ik .and. values /= 1_ik)) call self%set_fault(name)
   end subroutine check_logicals

   subroutine list_byte(self, name, x, extents)
      class(archive_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer(int8), allocatable, intent(inout), target :: x(..)
      character(len=*), optional, intent(in) :: extents  !< of base_stream
      integer(lk) :: n(rank(x))
      logical :: exists

      exists = allocated(x)
      n = 0_lk
      if (exists) n = shape(x, lk)
      call self%head(name, "b1", n, exists, extents)
      if (self%is_loading) then
         select rank (x)
         rank (1)
            if (allocated(x)) deallocate (x)
            if (exists) allocate (x(n(1)))
         end select
      end if
      if (exists) call self%move(c_loc(x), 1_lk*product(n))
   end subroutine list_byte

   subroutine list_text(self, name, x)
      class(archive_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      character(len=:), allocatable, intent(inout), target :: x
      integer(lk) :: n(1)
      logical :: exists

      exists = allocated(x)
      n = 0_lk
      if (exists) n = len(x, lk)
      call self%head(name, "c1", n, exists)
      if (self%is_loading) then
         if (allocated(x)) deallocate (x)
         if (exists) allocate (character(len=n(1)) :: x)
      end if
      if (exists) call self%move(c_loc(x), n(1))
   end subroutine list_text

end module base_archive
