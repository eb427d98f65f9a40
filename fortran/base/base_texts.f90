!> Lists of strings of different lengths.
!!
!! Text in UTF-8, byte by byte.
module base_texts
   implicit none(type, external)
   private

   public :: add_once, add_text, is_printable, text_t, utf8_length

   !> A string of any length.
   type :: text_t
      character(len=:), allocatable :: text
   end type text_t

contains

   !> Add a string to a list.
   pure subroutine add_text(list, text)
      type(text_t), allocatable, intent(inout) :: list(:)
      character(len=*), intent(in) :: text
      type(text_t), allocatable :: longer(:)
      integer :: n

      n = 0
      if (allocated(list)) n = size(list)
      allocate (longer(n + 1))
      if (n > 0) longer(1:n) = list
      longer(n + 1)%text = text
      call move_alloc(longer, list)
   end subroutine add_text

   !> Add a string to a list that does not have it yet.
   subroutine add_once(list, text)
      type(text_t), allocatable, intent(inout) :: list(:)
      character(len=*), intent(in) :: text
      integer :: i

      if (allocated(list)) then
         do i = 1, size(list)
            if (list(i)%text == text) return
         end do
      end if
      call add_text(list, text)
   end subroutine add_once

   !> Every byte is printable ASCII or part of a UTF-8 character: no control characters (U+0080 to
   !! U+009F are some too), no ends of lines (U+2028, U+2029), nothing of another encoding.
   pure logical function is_printable(text)
      character(len=*), intent(in) :: text
      integer :: i, n_bytes

      is_printable = .false.
      i = 1
      do while (i <= len(text))
         n_bytes = utf8_length(text(i:))
         select case (n_bytes)
         case (0)
            return
         case (1)
            if (iachar(text(i:i)) < 32 .or. iachar(text(i:i)) == 127) return
         case (2)
            if (iachar(text(i:i)) == 194 .and. iachar(text(i + 1:i + 1)) < 160) return
         case (3)
            if (iachar(text(i:i)) == 226 .and. iachar(text(i + 1:i + 1)) == 128 .and. &
                any(iachar(text(i + 2:i + 2)) == [168, 169])) return
         case default  ! none of them is a control character
         end select
         i = i + n_bytes
      end do
      is_printable = .true.
   end function is_printable

   !> Bytes of the UTF-8 character (RFC 3629) that begins a text; 0 if none does.
   pure function utf8_length(text) result(n_bytes)
      character(len=*), intent(in) :: text  !< not empty
      integer :: n_bytes
      integer :: first, second, i

      first = iachar(text(1:1))
      select case (first)
      case (0:127)
         n_bytes = 1
      case (194:223)
         n_bytes = 2
      case (224:239)
         n_bytes = 3
      case (240:244)
         n_bytes = 4
      case default
         n_bytes = 0
      end select
      if (n_bytes > len(text)) n_bytes = 0
      do i = 2, n_bytes
         if (iand(iachar(text(i:i)), 192) /= 128) then
            n_bytes = 0
            return
         end if
      end do
      if (n_bytes > 2) then  ! overlong forms, surrogates, and code points above the last
         second = iachar(text(2:2))
         if (first == 224 .and. second < 160 .or. first == 237 .and. second > 159 .or. &
             first == 240 .and. second < 144 .or. first == 244 .and. second > 143) n_bytes = 0
      end if
   end function utf8_length

end module base_texts
