!> Numbers as text: few digits that read back as the same number, in every locale.
!!
!! A double scaled by a power of ten to 17 digits before the point is held in quadruple precision,
!! whose 113 bits leave 56 for the rest. 15 digits are tried first, then 16: they do if they lie
!! closer to the number than half the way to its neighbours; 17 always do (Steele & White 1990
!! explain the interval; any decimal of up to 15 digits survives a double, so no shorter length
!! needs trying, but for subnormals). At powers of two and exact ties a digit more than needed may
!! be written. Formatted writes take five times as long, and their last digits are noise to the
!! reader.
module base_number
   use base_kinds, only: ik, lk, rk
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   implicit none(type, external)
   private

   public :: brief_text, format_integer, format_real, integer_text, number_width, real_text
   public :: rounded, shortest_digits

   integer, parameter :: number_width = 28  !< longest text of a number
   integer, parameter :: qk = selected_real_kind(33)  !< quadruple precision
   integer, parameter :: n_exact = 47  !< 5**47 < 2**113: powers of ten are exact up to here
   integer, parameter :: exponents(0:n_exact) = [ &
      & 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, &
      & 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, &
      & 32, 33, 34, 35, 36, 37, 38, 39, 40, 41, 42, 43, 44, 45, 46, 47]
   real(qk), parameter :: tens(0:n_exact) = 10.0_qk**exponents
   integer(lk), parameter :: ten_16 = 10_lk**16
   integer(lk), parameter :: ten_17 = 10_lk**17

   !> Text of an integer of any kind.
   interface integer_text
      module procedure integer_text_ik
      module procedure integer_text_lk
   end interface integer_text

contains

   !> A short text that reads back as x; nan, inf and -inf for what is no number.
   pure subroutine format_real(x, text, length)
      real(rk), intent(in) :: x
      character(len=number_width), intent(out) :: text
      integer, intent(out) :: length  !< characters used

      integer(lk) :: digits
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
         if (sign(1.0_rk, x) < 0.0_rk) then
            text(1:1) = "-"
            length = 1
         end if
         if (abs(x) > 0.0_rk) then
            call shortest_digits(abs(x), digits, power)
            call place_digits(digits, power, text, length)
         else
            text(length + 1:length + 3) = "0.0"
            length = length + 3
         end if
      end if
   end subroutine format_real

   !> Text of a real, see format_real.
   pure function real_text(x) result(text)
      real(rk), intent(in) :: x
      character(len=:), allocatable :: text
      character(len=number_width) :: buffer
      integer :: length

      call format_real(x, buffer, length)
      text = buffer(1:length)
   end function real_text

   !> A real for people: rounded to a few significant digits.
   pure function brief_text(x, n_digits) result(text)
      real(rk), intent(in) :: x
      integer, intent(in) :: n_digits  !< significant digits, 1 to 15
      character(len=:), allocatable :: text

      text = real_text(rounded(x, n_digits))
      if (len(text) > 2) then
         if (text(len(text) - 1:) == ".0") text = text(:len(text) - 2)
      end if
   end function brief_text

   !> The number next to x that has few digits; zeros, infinities and NaN stay as they are.
   pure function rounded(x, n_digits)
      real(rk), intent(in) :: x
      integer, intent(in) :: n_digits  !< significant digits, 1 to 15
      real(rk) :: rounded
      real(qk) :: unit

      rounded = x
      if (.not. (abs(x) > 0.0_rk .and. abs(x) <= huge(x))) return
      unit = times_ten(1.0_qk, floor(log10(abs(x))) + 1 - n_digits)
      rounded = real(anint(real(x, qk)/unit)*unit, rk)
   end function rounded

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

   !> 17 digits d of which the last ones may be zeros, such that x = d * 10**(power-16) reads back.
   pure subroutine shortest_digits(x, digits, power)
      real(rk), intent(in) :: x  !< above 0, finite
      integer(lk), intent(out) :: digits  !< 10**16 <= digits < 10**17
      integer, intent(out) :: power  !< decimal exponent of the first digit

      real(qk) :: scaled
      real(rk) :: rest, half_up, half_down
      integer(lk) :: whole, candidate, unit
      integer :: n_digits, fewest

      power = floor(log10(x))
      scaled = times_ten(real(x, qk), 16 - power)
      if (scaled >= real(ten_17, qk)) then  ! log10 was rounded across a power of ten
         power = power + 1
         scaled = times_ten(real(x, qk), 16 - power)
      else if (scaled < real(ten_16, qk)) then
         power = power - 1
         scaled = times_ten(real(x, qk), 16 - power)
      end if
      whole = int(scaled, lk)
      rest = real(scaled - real(whole, qk), rk)

      ! Half the way to both neighbours, in the unit of `digits`, less a margin for rounding here.
      if (x >= tiny(x)) then
         half_up = real(scaled, rk)*2.0_rk**(-54)/fraction(x)
      else
         half_up = real(scaled*(scale(1.0_qk, minexponent(x) - 54)/real(x, qk)), rk)
      end if
      half_up = half_up*(1.0_rk - 1.0e-12_rk)
      half_down = half_up
      if (fraction(x) <= 0.5_rk .and. x > tiny(x)) half_down = 0.5_rk*half_up  ! a power of two

      digits = whole + merge(1_lk, 0_lk, rest >= 0.5_rk)
      fewest = merge(15, 1, x >= tiny(x))  ! subnormals have fewer bits
      unit = 10_lk**(17 - fewest)
      do n_digits = fewest, 16
         candidate = (whole + unit/2_lk)/unit*unit
         if (real(candidate - whole, rk) - rest < half_up .and. &
            & rest - real(candidate - whole, rk) < half_down) then
            digits = candidate
            exit
         end if
         unit = unit/10_lk
      end do
      if (digits >= ten_17) then
         digits = digits/10_lk
         power = power + 1
      end if
   end subroutine shortest_digits

   !> x * 10**n, to a few units in the last of 113 bits.
   pure function times_ten(x, n) result(scaled)
      real(qk), intent(in) :: x
      integer, intent(in) :: n
      real(qk) :: scaled
      integer :: left

      scaled = x
      left = abs(n)
      do while (left > 0)
         if (n > 0) then
            scaled = scaled*tens(min(left, n_exact))
         else
            scaled = scaled/tens(min(left, n_exact))
         end if
         left = left - min(left, n_exact)
      end do
   end function times_ten

   !> Write digits with a point, with an exponent where the number is below 1e-4 or not below 1e16.
   pure subroutine place_digits(digits, power, text, length)
      integer(lk), intent(in) :: digits  !< 17 digits
      integer, intent(in) :: power  !< decimal exponent of the first one
      character(len=number_width), intent(inout) :: text
      integer, intent(inout) :: length

      character(len=17) :: mantissa
      integer(lk) :: rest
      integer :: i, n, exponent_size

      rest = digits
      do i = 17, 1, -1
         mantissa(i:i) = achar(iachar("0") + int(mod(rest, 10_lk)))
         rest = rest/10_lk
      end do
      n = verify(mantissa, "0", back=.true.)
      if (power >= 16 .or. power < -4) then
         call append(text, length, mantissa(1:1))
         if (n > 1) call append(text, length, "."//mantissa(2:n))
         call append(text, length, merge("e-", "e+", power < 0))
         exponent_size = abs(power)
         if (exponent_size >= 100) call append(text, length, achar(iachar("0") + exponent_size/100))
         call append(text, length, achar(iachar("0") + mod(exponent_size/10, 10)))
         call append(text, length, achar(iachar("0") + mod(exponent_size, 10)))
      else if (power < 0) then
         call append(text, length, "0."//repeat("0", -power - 1)//mantissa(1:n))
      else if (n <= power + 1) then
         call append(text, length, mantissa(1:power + 1)//".0")
      else
         call append(text, length, mantissa(1:power + 1)//"."//mantissa(power + 2:n))
      end if
   end subroutine place_digits

   !> Put a piece after the first `length` characters.
   pure subroutine append(text, length, piece)
      character(len=number_width), intent(inout) :: text
      integer, intent(inout) :: length
      character(len=*), intent(in) :: piece

      text(length + 1:length + len(piece)) = piece
      length = length + len(piece)
   end subroutine append

end module base_number
