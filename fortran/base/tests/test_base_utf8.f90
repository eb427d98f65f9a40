!> Characters of one to four bytes, and bytes that are none (RFC 3629).
program test_base_utf8
   use base_texts, only: is_printable, utf8_length
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks

   ! The first and the last character of each length.
   call length_is([0], 1)
   call length_is([127], 1)
   call length_is([194, 128], 2)
   call length_is([223, 191], 2)
   call length_is([224, 160, 128], 3)
   call length_is([239, 191, 191], 3)
   call length_is([240, 144, 128, 128], 4)
   call length_is([244, 143, 191, 191], 4)
   call length_is([195, 164, 33], 2)  ! what follows does not matter

   call length_is([128], 0)  ! the middle of a character
   call length_is([195], 0)  ! cut off
   call length_is([226, 130], 0)
   call length_is([195, 40], 0)
   call length_is([192, 128], 0)  ! overlong forms
   call length_is([224, 159, 191], 0)
   call length_is([240, 143, 191, 191], 0)
   call length_is([237, 160, 128], 0)  ! a surrogate
   call length_is([244, 144, 128, 128], 0)  ! past U+10FFFF
   call length_is([255], 0)

   call checks%is_true(is_printable(""), "nothing at all")
   call checks%is_true(is_printable("K"//bytes([195, 164])//"se"), "two-byte letter")
   call checks%is_true(.not. is_printable("K"//bytes([228])//"se"), "Latin-1 is not UTF-8")
   call checks%is_true(.not. is_printable("cut "//bytes([195])), "a cut letter")
   call checks%is_true(.not. is_printable(bytes([27])//"[31m"), "no control characters")
   call checks%is_true(.not. is_printable(bytes([127])), "no deletion")
   call checks%is_true(.not. is_printable(bytes([194, 155])//"31m"), "nor those of two bytes")
   call checks%is_true(is_printable(bytes([194, 160])), "a blank of two bytes")
   call checks%is_true(.not. is_printable("a"//bytes([226, 128, 168])), "no end of a line")
   call checks%is_true(.not. is_printable(bytes([226, 128, 169])//"b"), "nor of a paragraph")
   call checks%is_true(is_printable(bytes([226, 128, 148])), "a dash")
   call checks%finish()

contains

   subroutine length_is(codes, expected)
      integer, intent(in) :: codes(:), expected
      character(len=80) :: name

      write (name, "(*(i0,1x))") codes
      call checks%is_true(utf8_length(bytes(codes)) == expected, "length of "//trim(name))
   end subroutine length_is

   pure function bytes(codes) result(text)
      integer, intent(in) :: codes(:)
      character(len=size(codes)) :: text
      integer :: i

      do i = 1, size(codes)
         text(i:i) = char(codes(i))
      end do
   end function bytes

end program test_base_utf8
