!> Decisions of a computation in the order in which they are taken: recorded, or taken from the
!! record of another computation, or both. The same line of code does either, as in base_archive, so
!! that a replay takes the same way through the program as the recorded run.
module base_tape
   use, intrinsic :: iso_fortran_env, only: int8
   use base_archive, only: archive_t
   use base_kinds, only: ik, lk, rk
   implicit none(type, external)
   private

   public :: tape_t

   type :: tape_t
      logical :: is_recording = .false.
      logical :: follows = .false.  !< decisions are taken from a record
      type(archive_t), private :: own  !< decisions since `begin`
      type(archive_t), private :: taken  !< record that is followed
      ! Lengths up to the last mark
      integer(lk), private :: own_mark = 0_lk, taken_mark = 0_lk
   contains
      procedure :: begin
      procedure :: follow
      procedure :: visit
      procedure :: mark
      procedure :: rewind
      procedure :: bytes
      procedure :: is_at_end
      procedure :: fault
      procedure, private :: keep_logical, keep_integer, keep_real
      generic :: keep => keep_logical, keep_integer, keep_real
      procedure, private :: compare_logical, compare_integer, compare_real
      generic :: compare => compare_logical, compare_integer, compare_real
   end type tape_t

contains

   !> Begin the decisions of another state.
   subroutine begin(self)
      class(tape_t), intent(inout) :: self

      call self%own%begin_storing()
      call self%mark()
   end subroutine begin

   !> Follow a record from its beginning.
   subroutine follow(self, record)
      class(tape_t), intent(inout) :: self
      integer(int8), intent(in) :: record(:)

      self%taken%bytes = record
      self%taken%length = size(record, kind=lk)
      call self%taken%begin_loading()
      self%follows = .true.
      call self%mark()
   end subroutine follow

   !> Store or load how far the record has been followed; it has been given before loading.
   subroutine visit(self, archive)
      class(tape_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive

      call archive%enter("tape")
      call archive%item("follows", self%follows)
      call archive%item("place", self%taken%place)
      call archive%leave()
      if (archive%is_loading) self%taken%place = max(0_lk, min(self%taken%place, self%taken%length))
   end subroutine visit

   !> Mark the place to which `rewind` returns.
   subroutine mark(self)
      class(tape_t), intent(inout) :: self

      self%own_mark = self%own%length
      self%taken_mark = self%taken%place
   end subroutine mark

   !> Discard the decisions since the last mark.
   subroutine rewind (self)
      class(tape_t), intent(inout) :: self

      self%own%length = self%own_mark
      self%taken%place = self%taken_mark
   end subroutine rewind

   !> Decisions since `begin`.
   function bytes(self)
      class(tape_t), intent(in) :: self
      integer(int8), allocatable :: bytes(:)

      allocate (bytes(0))
      if (self%is_recording .and. self%own%length > 0_lk) bytes = self%own%bytes(:self%own%length)
   end function bytes

   !> Whether the record ends here.
   pure logical function is_at_end(self)
      class(tape_t), intent(in) :: self

      is_at_end = self%taken%place >= self%taken%length
   end function is_at_end

   !> Whether the record has other decisions than those that were asked for.
   pure logical function fault(self)
      class(tape_t), intent(in) :: self

      fault = allocated(self%taken%fault)
   end function fault

   !> Record a decision, or take it from the record.
   subroutine keep_logical(self, name, x)
      class(tape_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      logical, intent(inout), target, contiguous :: x(..)

      if (self%follows) call self%taken%item(name, x)
      if (self%is_recording) call self%own%item(name, x)
   end subroutine keep_logical

   subroutine keep_integer(self, name, x)
      class(tape_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer(ik), intent(inout), target, contiguous :: x(..)

      if (self%follows) call self%taken%item(name, x)
      if (self%is_recording) call self%own%item(name, x)
   end subroutine keep_integer

   subroutine keep_real(self, name, x)
      class(tape_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(rk), intent(inout), target, contiguous :: x(..)

      if (self%follows) call self%taken%item(name, x)
      if (self%is_recording) call self%own%item(name, x)
   end subroutine keep_real

   !> Record a value; `recorded` is that of the record, or the same.
   subroutine compare_logical(self, name, x, recorded)
      class(tape_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      logical, intent(inout) :: x
      logical, intent(out) :: recorded

      recorded = x
      if (self%follows) call self%taken%item(name, recorded)
      if (self%is_recording) call self%own%item(name, x)
   end subroutine compare_logical

   subroutine compare_integer(self, name, x, recorded)
      class(tape_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer(ik), intent(inout) :: x(:)
      integer(ik), intent(out) :: recorded(size(x))

      recorded = x
      if (self%follows) call self%taken%item(name, recorded)
      if (self%is_recording) call self%own%item(name, x)
   end subroutine compare_integer

   subroutine compare_real(self, name, x, recorded)
      class(tape_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(rk), intent(inout) :: x(:)
      real(rk), intent(out) :: recorded(size(x))

      recorded = x
      if (self%follows) call self%taken%item(name, recorded)
      if (self%is_recording) call self%own%item(name, x)
   end subroutine compare_real

end module base_tape
