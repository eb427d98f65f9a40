!> Tests of base_number: the text is short, and reads back as the same number, bit for bit.
program test_base_number
   use, intrinsic :: ieee_arithmetic, only: ieee_negative_inf, ieee_positive_inf, ieee_quiet_nan, &
                                                                               ieee_value
   use base_kinds, only: ik, lk, pi, rk
   use base_number, only: brief_text, exact_text, integer_text, place_text
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks

   ! Texts as any shortest-digits printer gives them (IEEE 754 doubles).
   call same_text(0.0_rk, "0.0")
   call same_text(-0.0_rk, "-0.0")
   call same_text(1.0_rk, "1.0")
   call same_text(-2.5_rk, "-2.5")
   call same_text(0.1_rk, "0.1")
   call same_text(0.1_rk + 0.2_rk, "0.30000000000000004")
   call same_text(1.0_rk/3.0_rk, "0.3333333333333333")
   call same_text(2.0_rk/3.0_rk, "0.6666666666666666")
   call same_text(pi, "3.141592653589793")
   call same_text(1.0e-4_rk, "0.0001")
   call same_text(1.0e-5_rk, "1e-05")
   call same_text(1.25e-5_rk, "1.25e-05")
   call same_text(123456.0_rk, "123456.0")
   call same_text(1.0e15_rk, "1000000000000000.0")
   call same_text(1.0e16_rk, "1e+16")
   call same_text(9.999999999999999e22_rk, "1e+23")  ! half-way to the next: reads as the even one
   call same_text(1.0e22_rk, "1e+22")
   call same_text(9007199254740993.0_rk, "9007199254740992.0")  ! 2**53 + 1 is no double
   call same_text(0.99999999999999989_rk, "0.9999999999999999")  ! next below 1
   call same_text(huge(1.0_rk), "1.7976931348623157e+308")
   call same_text(tiny(1.0_rk), "2.2250738585072014e-308")
   call same_text(transfer(1_lk, 1.0_rk), "5e-324")  ! the smallest subnormal
   call same_text(scale(1.0_rk, -44), "5.684341886080802e-14")  ! 5.6843418860808015e-14
   call same_text(scale(1.0_rk, 1023), "8.98846567431158e+307")
   call same_text(1097718834198879.25_rk, "1097718834198879.2")  ! .3 is as near: the even digit
   call same_text(scale(1.0_rk, -25), "2.9802322387695312e-08")  ! and of 2.98023223876953125e-08
   call same_text(-5.0e-324_rk, "-5e-324")
   call same_text(ieee_value(1.0_rk, ieee_quiet_nan), "nan")
   call same_text(ieee_value(1.0_rk, ieee_positive_inf), "inf")
   call same_text(ieee_value(1.0_rk, ieee_negative_inf), "-inf")
   call read_back_random()
   call read_back_uneven()

   call checks%is_true(brief_text(12345.678_rk, 5) == "12346", "five digits")
   call checks%is_true(brief_text(0.0123456_rk, 3) == "0.0123", "three digits")
   call checks%is_true(brief_text(-9.9996_rk, 4) == "-10", "rounding up adds a digit")
   call checks%is_true(brief_text(0.0_rk, 3) == "0", "zero has no digits to round")
   call checks%is_true(place_text([12.34567_rk, -0.5_rk]) == "(12.35, -0.5) m", "a place")
   call checks%is_true(place_text([466003.217_rk, 6692123.41_rk]) == "(466003.22, 6692123.4) m", &
                       "a place far from the origin")
   call checks%is_true(brief_text(2.5_rk, 1) == "2", "a tie goes to the even digit")
   call checks%is_true(brief_text(1.0_rk/3.0_rk, 17) == "0.33333333333333331", "all digits")

   call checks%is_true(integer_text(0_ik) == "0", "integer 0")
   call checks%is_true(integer_text(-120_ik) == "-120", "integer -120")
   call checks%is_true(integer_text(huge(1_lk)) == "9223372036854775807", "largest integer")
   call checks%is_true(integer_text(-huge(1_lk) - 1_lk) == "-9223372036854775808", &
                       "smallest integer")
   call checks%finish()

contains

   subroutine same_text(x, expected)
      real(rk), intent(in) :: x
      character(len=*), intent(in) :: expected

      call checks%is_true(exact_text(x) == expected, expected//" is written as "//exact_text(x))
   end subroutine same_text

   !> Powers of two, whose neighbours are not at the same distance, down to the smallest subnormal.
   subroutine read_back_uneven()
      integer :: i, n_wrong, status
      real(rk) :: x, back
      character(len=:), allocatable :: text

      n_wrong = 0
      do i = -1074, 1023
         if (i >= -1022) then
            x = scale(1.0_rk, i)
         else
            x = transfer(ishft(1_lk, i + 1074), x)  ! subnormal
         end if
         text = exact_text(x)
         read (text, *, iostat=status) back
         if (status /= 0 .or. transfer(back, 1_lk) /= transfer(x, 1_lk)) n_wrong = n_wrong + 1
      end do
      call checks%is_true(n_wrong == 0, "all powers of two read back")
   end subroutine read_back_uneven

   !> Numbers with random bits (Marsaglia's xorshift) read back with the same bits.
   subroutine read_back_random()
      integer(lk) :: bits
      integer :: i, n_wrong, n_tried, status
      real(rk) :: x, back
      character(len=:), allocatable :: text

      bits = 88172645463325252_lk
      n_wrong = 0
      n_tried = 0
      do i = 1, 100000
         bits = ieor(bits, ishft(bits, 13))
         bits = ieor(bits, ishft(bits, -7))
         bits = ieor(bits, ishft(bits, 17))
         x = transfer(bits, x)
         if (mod(i, 4) == 0) x = scale(fraction(x), mod(i, 60) - 30)  ! sizes that occur
         if (.not. abs(x) <= huge(x)) cycle
         n_tried = n_tried + 1
         text = exact_text(x)
         read (text, *, iostat=status) back
         if (status /= 0 .or. transfer(back, bits) /= transfer(x, bits)) n_wrong = n_wrong + 1
         if (len(text) > 24) n_wrong = n_wrong + 1
      end do
      call checks%is_true(n_wrong == 0 .and. n_tried > 90000, "random numbers read back")
   end subroutine read_back_random

end program test_base_number
