!> Numbers as text: the fewest digits that read back as the same number, in every locale.
!!
!! The digits are those of the standard library of C++ (base_number_digits.cpp): Fortran's formatted
!! writes cannot find the fewest.
module base_number
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int
   use base_kinds, only: ik, lk, rk
   implicit none(type, external)
   private

   public :: brief_text, decimal_digits, exact_text, format_integer, format_real, integer_text
   public :: most_digits, number_width, place_text

   integer, parameter :: number_width = 28  !< longest text of a number
   integer, parameter :: most_digits = 17  !< that a double may need

   interface
      !> See base_number_digits.cpp.
      pure subroutine base_number_digits(x, n_digits, digits, power) bind(c)
         import :: c_char, c_double, c_int, most_digits
         implicit none(type, external)
         real(c_double), value, intent(in) :: x
         integer(c_int), value, intent(in) :: n_digits
         character(kind=c_char), intent(out) :: digits(most_digits)
         integer(c_int), intent(out) :: power
      end subroutine base_number_digits
   end interface

   !> Text of an integer of any kind.
   interface integer_text
      module procedure integer_text_ik
      module procedure integer_text_lk
   end interface integer_text

contains

   !> A short text that reads back as x; nan, inf and -inf for what is no number.
   pure subroutine format_real(x, text, length, n_digits)
      real(rk), intent(in) :: x  !< [any unit]
      character(len=number_width), intent(out) :: text
      integer, intent(out) :: length  !< characters used
      integer, intent(in), optional :: n_digits  !< as in decimal_digits
      character(len=most_digits) :: digits
      integer :: power

      text = ""
      if (ieee_is_nan(x)) then
         text = "nan"
         length = 3
      else if (abs(x) > huge(x)) then
         text = merge("-inf", "inf ", x < 0.0_rk)
         length = len_trim(text)
      else
         length = 0
         if (sign(1.0_rk, x) < 0.0_rk) call append(text, length, "-")
         call decimal_digits(x, digits, power, n_digits)
         call place_digits(digits, power, text, length)
      end if
   end subroutine format_real

   !> A real as files hold it: a text that reads back as x.
   pure function exact_text(x) result(text)
      real(rk), intent(in) :: x  !< [any unit]
      character(len=:), allocatable :: text
      character(len=number_width) :: buffer
      integer :: length

      call format_real(x, buffer, length)
      text = buffer(1:length)
   end function exact_text

   !> A real for people: rounded to a few significant digits.
   pure function brief_text(x, n_digits) result(text)
      real(rk), intent(in) :: x  !< [any unit]
      integer, intent(in) :: n_digits  !< significant digits, 1 to 17
      character(len=:), allocatable :: text
      character(len=number_width) :: buffer
      integer :: length

      call format_real(x, buffer, length, n_digits)
      if (length > 2) then
         if (buffer(length - 1:length) == ".0") length = length - 2
      end if
      text = buffer(1:length)
   end function brief_text

   !> A position as text, with four digits, or more where it is far from the origin.
   pure function place_text(xy) result(text)
      real(rk), intent(in) :: xy(2)  !< [m]
      character(len=:), allocatable :: text
      integer :: n

      n = 4 + max(0, int(log10(maxval(abs(xy)) + 1.0_rk)) - 2)
      text = "("//brief_text(xy(1), n)//", "//brief_text(xy(2), n)//") m"
   end function place_text

   !> The decimal digits d of a number, |x| = d.ddd * 10**power: as few as read back as x, or
   !! rounded. No zeros at the end; but the digit of 0 is 0.
   pure subroutine decimal_digits(x, digits, power, n_digits)
      real(rk), intent(in) :: x  !< finite [any unit]
      character(len=most_digits), intent(out) :: digits  !< blanks follow
      integer, intent(out) :: power
      integer, intent(in), optional :: n_digits  !< 1 to 17; default: as many as needed
      integer(c_int) :: n

      n = 0
      if (present(n_digits)) n = n_digits
      call base_number_digits(abs(x), n, digits, power)
   end subroutine decimal_digits

   !> Text of an integer.
   pure subroutine format_integer(n, text, length)
      integer(lk), intent(in) :: n
      character(len=number_width), intent(out) :: text
      integer, intent(out) :: length  !< characters used
      integer(lk) :: rest
      integer :: position
      character(len=number_width) :: reversed

      reversed = ""
      rest = n
      position = 0
      do  ! digits from the last to the first; a negative remainder has no overflow at -huge-1
         position = position + 1
         reversed(position:position) = achar(iachar("0") + int(abs(mod(rest, 10_lk))))
         rest = rest/10_lk
         if (rest == 0_lk) exit
      end do
      if (n < 0_lk) then
         position = position + 1
         reversed(position:position) = "-"
      end if
      length = position
      text = ""
      do position = 1, length
         text(position:position) = reversed(length + 1 - position:length + 1 - position)
      end do
   end subroutine format_integer

   pure function integer_text_lk(n) result(text)
      integer(lk), intent(in) :: n
      character(len=:), allocatable :: text
      character(len=number_width) :: buffer
      integer :: length

      call format_integer(n, buffer, length)
      text = buffer(1:length)
   end function integer_text_lk

   pure function integer_text_ik(n) result(text)
      integer(ik), intent(in) :: n
      character(len=:), allocatable :: text

      text = integer_text_lk(int(n, lk))
   end function integer_text_ik

   !> Write digits with a point, with an exponent where the number is below 1e-4 or not below 1e16.
   pure subroutine place_digits(digits, power, text, length)
      character(len=most_digits), intent(in) :: digits  !< blanks follow
      integer, intent(in) :: power  !< decimal exponent of the first one
      character(len=number_width), intent(inout) :: text
      integer, intent(inout) :: length
      integer :: n, exponent_size

      n = len_trim(digits)
      if (power >= 16 .or. power < -4) then
         call append(text, length, digits(1:1))
         if (n > 1) call append(text, length, "."//digits(2:n))
         call append(text, length, merge("e-", "e+", power < 0))
         exponent_size = abs(power)
         if (exponent_size >= 100) call append(text, length, achar(iachar("0") + exponent_size/100))
         call append(text, length, achar(iachar("0") + mod(exponent_size/10, 10)))
         call append(text, length, achar(iachar("0") + mod(exponent_size, 10)))
      else if (power < 0) then
         call append(text, length, "0."//repeat("0", -power - 1)//digits(1:n))
      else if (n <= power + 1) then
         call append(text, length, digits(1:n)//repeat("0", power + 1 - n)//".0")
      else
         call append(text, length, digits(1:power + 1)//"."//digits(power + 2:n))
      end if
   end subroutine place_digits

   !> Append a text after the first `length` characters.
   pure subroutine append(text, length, piece)
      character(len=number_width), intent(inout) :: text
      integer, intent(inout) :: length
      character(len=*), intent(in) :: piece

      text(length + 1:length + len(piece)) = piece
      length = length + len(piece)
   end subroutine append

end module base_number
