!> Text that grows: a buffer with room to spare.
module output_text
   use base_errors, only: error_t
   use base_kinds, only: lk, rk
   use base_number, only: format_real, number_width
   use output_files, only: write_text_file
   implicit none(type, external)
   private

   public :: newline, text_buffer_t

   character(len=*), parameter :: newline = achar(10)

   !> A long text, built piece by piece.
   type :: text_buffer_t
      integer(lk) :: length = 0_lk  !< characters used
      character(len=:), allocatable, private :: storage
   contains
      procedure :: append
      procedure :: append_real
      procedure :: replace_last
      procedure :: text => buffer_text
      procedure :: write_file
   end type text_buffer_t

contains

   !> Add a piece at the end.
   pure subroutine append(self, piece)
      class(text_buffer_t), intent(inout) :: self
      character(len=*), intent(in) :: piece
      character(len=:), allocatable :: larger
      integer(lk) :: length  ! afterwards

      length = self%length + len(piece, kind=lk)
      if (.not. allocated(self%storage)) allocate (character(len=1024) :: self%storage)
      if (length > len(self%storage, kind=lk)) then
         allocate (character(len=2_lk*length) :: larger)
         larger(1:self%length) = self%storage(1:self%length)
         call move_alloc(larger, self%storage)
      end if
      self%storage(self%length + 1:length) = piece
      self%length = length
   end subroutine append

   !> Add a number at the end, with the digits that it needs.
   pure subroutine append_real(self, x)
      class(text_buffer_t), intent(inout) :: self
      real(rk), intent(in) :: x  !< [any unit]
      character(len=number_width) :: piece
      integer :: length

      call format_real(x, piece, length)
      call self%append(piece(1:length))
   end subroutine append_real

   !> Replace the last character.
   pure subroutine replace_last(self, letter)
      class(text_buffer_t), intent(inout) :: self
      character(len=1), intent(in) :: letter

      if (self%length > 0) self%storage(self%length:self%length) = letter
   end subroutine replace_last

   !> All that was added.
   pure function buffer_text(self) result(text)
      class(text_buffer_t), intent(in) :: self
      character(len=:), allocatable :: text

      if (allocated(self%storage)) then
         text = self%storage(1:self%length)
      else
         text = ""
      end if
   end function buffer_text

   !> Write all that was added as a whole file.
   subroutine write_file(self, path, error)
      class(text_buffer_t), intent(in) :: self
      character(len=*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error

      if (allocated(self%storage)) then
         call write_text_file(path, self%storage(1:self%length), error)
      else
         call write_text_file(path, "", error)
      end if
   end subroutine write_file

end module output_text
