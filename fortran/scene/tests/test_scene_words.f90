!> Numbers as texts are exact and short; likeness of words; what a name may be.
program test_scene_words
   use, intrinsic :: ieee_arithmetic, only: ieee_negative_inf, ieee_value
   use base_kinds, only: lk, rk
   use scene_words, only: edit_distance, is_identifier, lower_case, nearest_word, real_text, &
                          rounded_text
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks

   call check_real_text()
   call check_words()
   call check_nearest()
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
      call checks%is_true(real_text(ieee_value(0.0_rk, ieee_negative_inf)) == "-inf", "infinite")
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

   !> What is near is named, and nothing else.
   subroutine check_nearest()
      character(len=14), parameter :: names(*) = [character(len=14) :: "young", "poisson", "load", &
                                          "permeability", "dilation_deg", "friction", "x", "side", &
                                                            "size_fracture", "size_boundary", "end"]

      call checks%is_true(nearest_word("Yuong", names) == "young", "exchanged neighbours")
      call checks%is_true(nearest_word("sied", names) == "side", "exchanged at the end")
      call checks%is_true(nearest_word("dilation", names) == "dilation_deg", "the beginning")
      call checks%is_true(nearest_word("friction_coefficient", names) == "friction", "too long")
      call checks%is_true(nearest_word("end_time", names) == "end", "a unit or the like behind it")
      call checks%is_true(nearest_word("size_fractrue", names) == "size_fracture", &
                          "fewest slips win")
      call checks%is_true(nearest_word("permaebilty", names) == "permeability", "two slips")
      call checks%is_true(nearest_word("rokc", names) == "", "nothing near: no &load for &rokc")
      call checks%is_true(nearest_word("y", names) == "", "one letter is near none but itself")
      call checks%is_true(nearest_word("X", names) == "x", "itself in another case")
      call checks%is_true(nearest_word(repeat("young", 10000), names) == "young", "a long one")
      call checks%is_true(nearest_word("", names) == "", "no word")
   end subroutine check_nearest

end program test_scene_words
