!> A text buffer with spare capacity.
module base_buffer
   use base_archive, only: archive_t
   use base_kinds, only: lk, rk
   use base_number, only: format_real, number_width
   implicit none(type, external)
   private

   public :: newline, text_buffer_t

   character(len=*), parameter :: newline = achar(10)

   !> A long text, built by appending.
   type :: text_buffer_t
      integer(lk) :: length = 0_lk  !< characters in use
      character(len=:), allocatable, private :: storage
      integer(lk), private :: stored = 0_lk  !< length in the last archive
   contains
      procedure :: append
      procedure :: append_real
      procedure :: replace_last
      procedure :: text => buffer_text
      procedure :: visit => visit_length
      procedure :: visit_text
   end type text_buffer_t

contains

   !> Append a text.
   pure subroutine append(self, item)
      class(text_buffer_t), intent(inout) :: self
      character(len=*), intent(in) :: item
      character(len=:), allocatable :: larger
      integer(lk) :: length  ! afterwards

      length = self%length + len(item, kind=lk)
      if (.not. allocated(self%storage)) allocate (character(len=1024) :: self%storage)
      if (length > len(self%storage, kind=lk)) then
         allocate (character(len=2_lk*length) :: larger)
         larger(1:self%length) = self%storage(1:self%length)
         call move_alloc(larger, self%storage)
      end if
      self%storage(self%length + 1:length) = item
      self%length = length
   end subroutine append

   !> Append a number with as many digits as needed to read it back exactly.
   pure subroutine append_real(self, x)
      class(text_buffer_t), intent(inout) :: self
      real(rk), intent(in) :: x  !< [any unit]
      character(len=number_width) :: item
      integer :: length

      call format_real(x, item, length)
      call self%append(item(1:length))
   end subroutine append_real

   !> Replace the last character.
   pure subroutine replace_last(self, letter)
      class(text_buffer_t), intent(inout) :: self
      character(len=1), intent(in) :: letter

      if (self%length > 0) self%storage(self%length:self%length) = letter
   end subroutine replace_last

   !> The whole text.
   pure function buffer_text(self) result(text)
      class(text_buffer_t), intent(in) :: self
      character(len=:), allocatable :: text

      if (allocated(self%storage)) then
         text = self%storage(1:self%length)
      else
         text = ""
      end if
   end function buffer_text

   !> Store or load the length. The text so far does not change any more: it is in an archive of its
   !! own, which is made when it is written.
   subroutine visit_length(self, archive)
      class(text_buffer_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive

      call archive%item("length", self%length)
      if (archive%is_loading .and. self%length /= len(self%storage, kind=lk)) then
         call archive%set_fault("length")
      end if
      self%stored = self%length
   end subroutine visit_length

   !> Store the text as long as it was in the last archive, or load it.
   subroutine visit_text(self, archive)
      class(text_buffer_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive
      character(len=:), allocatable :: text

      if (.not. archive%is_loading .and. self%stored > 0_lk) text = self%storage(:self%stored)
      call archive%list("text", text)
      if (.not. archive%is_loading) return
      if (.not. allocated(text)) text = ""
      call move_alloc(text, self%storage)
   end subroutine visit_text

end module base_buffer
