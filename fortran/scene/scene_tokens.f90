!> Cuts the text of a scene file into tokens that know their line.
!>
!> The syntax is that of Fortran namelists: `&group`, `name = values`, `/`, comments from `!` to the
!> end of the line, texts in single or double quotes in which a doubled quote stands for one.
module scene_tokens
   use base_kinds, only: ik
   use base_number, only: integer_text
   implicit none(type, external)
   private

   public :: begins_value, token_t, token_list_t, tokenize, unquoted
   public :: token_comma, token_end, token_equals, token_group, token_slash, token_text, token_word

   integer, parameter :: token_group = 1  !< `&name`; the range holds the name alone
   integer, parameter :: token_word = 2  !< a name, a number or a logical
   integer, parameter :: token_text = 3  !< a quoted text, with its quotes
   integer, parameter :: token_equals = 4
   integer, parameter :: token_comma = 5
   integer, parameter :: token_slash = 6
   integer, parameter :: token_end = 7  !< after the last character

   !> A piece source(first:last).
   type :: token_t
      integer :: kind = token_end
      integer :: first = 1, last = 0
      integer(ik) :: line = 0  !< on which it begins, from 1
   end type token_t

   !> The tokens of one source; the last one is of the kind token_end.
   type :: token_list_t
      type(token_t), allocatable :: items(:)
      integer :: length = 0
   end type token_list_t

   character(len=1), parameter :: tab = achar(9), line_feed = achar(10), carriage_return = achar(13)

contains

   !> Cut a source into tokens.
   pure subroutine tokenize(source, tokens, fault, fault_line)
      character(len=*), intent(in) :: source
      type(token_list_t), intent(out) :: tokens
      character(len=:), allocatable, intent(out) :: fault  !< what is wrong; unallocated: good
      integer(ik), intent(out) :: fault_line
      integer :: position, last
      integer(ik) :: line

      fault_line = 0
      line = 1
      position = 1
      if (len(source) >= 3) then  ! the byte-order mark of some editors
         if (source(1:3) == char(239)//char(187)//char(191)) position = 4
      end if
      allocate (tokens%items(64))
      do while (position <= len(source))
         select case (source(position:position))
         case (" ", tab, carriage_return)
            position = position + 1
         case (line_feed)
            line = line + 1
            position = position + 1
         case ("!")
            position = position + rest_of_line(source(position:))
         case ("=")
            call append(tokens, token_t(token_equals, position, position, line))
            position = position + 1
         case (",")
            call append(tokens, token_t(token_comma, position, position, line))
            position = position + 1
         case ("/")
            call append(tokens, token_t(token_slash, position, position, line))
            position = position + 1
         case ("&")
            last = position + word_length(source(position + 1:))
            call append(tokens, token_t(token_group, position + 1, last, line))
            position = last + 1
         case ("'", '"')
            last = position - 1 + text_length(source(position:))
            if (last < position) then
               fault = "a text in quotes is not closed on its line"
               exit
            end if
            call append(tokens, token_t(token_text, position, last, line))
            position = last + 1
         case default
            last = position - 1 + word_length(source(position:))
            if (last < position) then
               fault = "a character with code "//integer_text(ichar(source(position:position), &
                                                                    ik))// &
                       " stands outside of quotes and comments, where only plain text may stand"
               exit
            end if
            call append(tokens, token_t(token_word, position, last, line))
            position = last + 1
         end select
      end do
      if (allocated(fault)) fault_line = line
      call append(tokens, token_t(token_end, len(source) + 1, len(source), line))
   end subroutine tokenize

   !> What a quoted text says.
   pure function unquoted(quoted) result(text)
      character(len=*), intent(in) :: quoted  !< with its quotes
      character(len=:), allocatable :: text
      character(len=len(quoted)) :: buffer
      integer :: i, n

      i = 2
      n = 0
      do while (i < len(quoted))
         n = n + 1
         buffer(n:n) = quoted(i:i)
         if (quoted(i:i) == quoted(1:1)) i = i + 1  ! the second of a doubled quote
         i = i + 1
      end do
      text = buffer(1:n)
   end function unquoted

   !> Characters up to the end of the line, which is not counted.
   pure integer function rest_of_line(source) result(length)
      character(len=*), intent(in) :: source

      length = index(source, line_feed) - 1
      if (length < 0) length = len(source)
   end function rest_of_line

   !> Characters of the word that begins here; 0 where none begins.
   pure integer function word_length(source) result(length)
      character(len=*), intent(in) :: source
      integer :: i

      length = 0
      do i = 1, len(source)
         select case (source(i:i))
         case ("!", "&", "'", '"', "=", ",", "/")
            return
         case default
            if (ichar(source(i:i)) <= 32 .or. ichar(source(i:i)) >= 127) return
         end select
         length = i
      end do
   end function word_length

   !> Characters of the quoted text that begins here, with both quotes; 0 if it is not closed.
   pure integer function text_length(source) result(length)
      character(len=*), intent(in) :: source
      integer :: i

      length = 0
      i = 2
      do while (i <= len(source))
         if (source(i:i) == line_feed) return
         if (source(i:i) == source(1:1)) then
            if (i == len(source)) then
               length = i
               return
            else if (source(i + 1:i + 1) /= source(1:1)) then
               length = i
               return
            end if
            i = i + 1
         end if
         i = i + 1
      end do
   end function text_length

   pure subroutine append(tokens, token)
      type(token_list_t), intent(inout) :: tokens
      type(token_t), intent(in) :: token
      type(token_t), allocatable :: larger(:)

      if (tokens%length == size(tokens%items)) then
         allocate (larger(2*tokens%length))
         larger(1:tokens%length) = tokens%items
         call move_alloc(larger, tokens%items)
      end if
      tokens%length = tokens%length + 1
      tokens%items(tokens%length) = token
   end subroutine append

   !> A word with `=` behind it; the last token, token_end, is never one.
   pure logical function begins_value(kind, next_kind)
      integer, intent(in) :: kind, next_kind

      begins_value = kind == token_word .and. next_kind == token_equals
   end function begins_value

end module scene_tokens
