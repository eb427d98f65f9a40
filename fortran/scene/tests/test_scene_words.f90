!> Numbers as texts are exact and short; likeness of words; what a name may be.
program test_scene_words
   use testing_checks, only: checks_t
   use base_kinds, only: lk, rk
   use scene_words, only: edit_distance, is_identifier, lower_case, real_text, rounded_text
   implicit none(type, external)
   type(checks_t) :: checks

   call check_real_text()
   call check_words()
   call checks%finish()

contains

   subroutine check_real_text()
      real(rk) :: value, again
      integer(lk) :: bits
      integer :: i, status
      logical :: exact
      character(len=:), allocatable :: text

      call checks%is_true(real_text(0.0_rk) == "0.0", "zero")
      call checks%is_true(real_text(-0.0_rk) == "-0.0", "negative zero keeps its sign")
      call checks%is_true(real_text(0.1_rk) == "0.1", "0.1")
      call checks%is_true(real_text(-20.0e6_rk) == "-2.0e7", "-2.0e7")
      call checks%is_true(real_text(97200.0_rk) == "97200.0", "97200.0")
      call checks%is_true(real_text(1234567.0_rk) == "1234567.0", "1234567.0")
      call checks%is_true(real_text(0.00125_rk) == "0.00125", "0.00125")
      call checks%is_true(real_text(5.0e-20_rk) == "5.0e-20", "5.0e-20")
      call checks%is_true(real_text(1.0_rk/3.0_rk) == "0.3333333333333333", "a third in 16 digits")
      call checks%is_true(real_text(huge(1.0_rk)) == "1.7976931348623157e308", "the largest number")
      call checks%is_true(real_text(5.0e-324_rk) == "5.0e-324", "the smallest subnormal number")

      call checks%is_true(rounded_text(2.0_rk/3.0_rk) == "0.6667", "four digits")

      ! Pseudo-random bit patterns (xorshift; Marsaglia 2003) cover all magnitudes and signs.
      bits = 1_lk
      exact = .true.
      do i = 1, 20000
         bits = ieor(bits, ishft(bits, 13))
         bits = ieor(bits, ishft(bits, -7))
         bits = ieor(bits, ishft(bits, 17))
         value = transfer(bits, value)
         if (.not. abs(value) <= huge(value)) cycle
         text = real_text(value)
         read (text, *, iostat=status) again
         exact = exact .and. status == 0 .and. transfer(again, 0_lk) == bits
      end do
      call checks%is_true(exact, "20000 random numbers read back to the same bits")
   end subroutine check_real_text

   subroutine check_words()
      call checks%is_true(lower_case("X_Min9") == "x_min9", "lower case")
      call checks%is_true(edit_distance("kitten", "sitting") == 3, "kitten to sitting")
      call checks%is_true(edit_distance("yuong", "young") == 1, "a swap is one edit")
      call checks%is_true(edit_distance("", "abc") == 3, "from nothing")
      call checks%is_true(edit_distance("same", "same") == 0, "equal words")
      call checks%is_true(is_identifier("f-1_a.b"), "a good name")
      call checks%is_true(.not. is_identifier(""), "no empty name")
      call checks%is_true(.not. is_identifier("../up"), "no path in a name")
      call checks%is_true(.not. is_identifier(".hidden"), "no leading point")
      call checks%is_true(.not. is_identifier("a b"), "no blank in a name")
   end subroutine check_words

end program test_scene_words
