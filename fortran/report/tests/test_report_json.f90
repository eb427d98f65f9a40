!> Tests of report_json: the escape rules of RFC 8259, and the shape of the text.
program test_report_json
   use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_quiet_nan, ieee_value
   use base_kinds, only: ik, lk, rk
   use base_texts, only: text_t
   use report_json, only: escaped, json_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   character(len=*), parameter :: nl = achar(10)
   type(checks_t) :: checks
   type(json_t) :: json, line
   real(rk) :: nan, infinity
   type(text_t), allocatable :: silence(:), words(:)

   call same(escaped('say "hi"'), 'say \"hi\"')
   call same(escaped("a\b"), "a\\b")
   call same(escaped("/"), "/")
   call same(escaped(achar(8)//achar(9)//achar(10)//achar(12)//achar(13)), "\b\t\n\f\r")
   call same(escaped(achar(0)//achar(1)//achar(31)), "\u0000\u0001\u001F")
   call same(escaped(achar(127)), "\u007F")
   ! UTF-8 stays: e acute (2 bytes), euro (3), a clef (4). Other bytes are read as Latin-1.
   call same(escaped(bytes([195, 169])), bytes([195, 169]))
   call same(escaped(bytes([226, 130, 172])), bytes([226, 130, 172]))
   call same(escaped(bytes([240, 157, 132, 158])), bytes([240, 157, 132, 158]))
   call same(escaped(bytes([233])//"x"), "\u00E9x")
   call same(escaped(bytes([195])), "\u00C3")  ! cut off
   call same(escaped(bytes([192, 128])), "\u00C0\u0080")  ! overlong
   call same(escaped(bytes([237, 160, 128])), "\u00ED\u00A0\u0080")  ! surrogate
   call same(escaped(bytes([244, 144, 128, 128])), "\u00F4\u0090\u0080\u0080")  ! past U+10FFFF

   nan = ieee_value(nan, ieee_quiet_nan)
   infinity = ieee_value(nan, ieee_positive_inf)
   call json%begin_object("")
   call json%add("name", "C""2")
   call json%add("steps", 12_ik)
   call json%add("ticks", -5000000000_lk)
   call json%add("x", [0.5_rk, nan, infinity])
   call json%add("n", [1_ik, 2_ik])
   call json%add("none", [integer(ik) ::])
   words = [text_t("a"), text_t("b")]
   call json%add("words", words)
   call json%add("silence", silence)
   call json%begin_object("inner")
   call json%add("y", nan)
   call json%end_object()
   call json%end_object()
   call same(json%text(), "{"//nl//'  "name": "C\"2",'//nl//'  "steps": 12,'//nl// &
      & '  "ticks": -5000000000,'//nl//'  "x": [0.5, null, null],'//nl//'  "n": [1, 2],'//nl// &
      & '  "none": [],'//nl//'  "words": ['//nl//'    "a",'//nl//'    "b"'//nl//"  ],"//nl// &
      & '  "silence": [],'//nl//'  "inner": {'//nl//'    "y": null'//nl//"  }"//nl//"}"//nl)

   line%one_line = .true.
   call line%begin_object("")
   call line%add("t", 1.0_rk)
   call line%begin_array("list")
   call line%begin_object("")
   call line%end_object()
   call line%begin_object("")
   call line%add("k", 3_ik)
   call line%end_object()
   call line%end_array()
   call line%add_raw("raw", "[true]")
   call line%end_object()
   call same(line%text(), '{"t": 1.0, "list": [{}, {"k": 3}], "raw": [true]}')
   call checks%finish()

contains

   subroutine same(text, expected)
      character(len=*), intent(in) :: text, expected

      call checks%is_true(len(text) == len(expected) .and. text == expected, &
         & expected//" is written as "//text)
   end subroutine same

   !> The string with these bytes.
   pure function bytes(codes) result(text)
      integer, intent(in) :: codes(:)
      character(len=size(codes)) :: text
      integer :: i

      do i = 1, size(codes)
         text(i:i) = achar(codes(i))
      end do
   end function bytes

end program test_report_json
