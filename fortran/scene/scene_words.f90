!> Operations on words: case, similarity, numbers in the form of scene files, which are read back
!! exactly; and ranges of allowed values with their description in words.
module scene_words
   use base_kinds, only: ik, rk
   use base_number, only: brief_text, decimal_digits, integer_text, most_digits
   implicit none(type, external)
   private

   public :: at_least_one, at_least_zero, below_one, biot_range, dilation_range, edit_distance
   public :: exponent_range, holds, in_words, interval_t, is_identifier, lower_case, nearest_word
   public :: newton_range, passes_range, poisson_range, porosity_range, positive, real_text
   public :: rosette_range, rounded_text, share, steps_range, tolerance_range

   integer, parameter :: longest_compared = 60  !< characters of a word that are compared

   !> Values between two bounds; a bound of +-huge is no bound.
   type :: interval_t
      real(rk) :: lowest = -huge(1.0_rk), highest = huge(1.0_rk)
      logical :: open_below = .false., open_above = .false.  !< the bound itself is not allowed
   end type interval_t

   type(interval_t), parameter :: positive = interval_t(lowest=0.0_rk, open_below=.true.)
   type(interval_t), parameter :: at_least_zero = interval_t(lowest=0.0_rk)
   type(interval_t), parameter :: at_least_one = interval_t(lowest=1.0_rk)
   type(interval_t), parameter :: below_one = interval_t(0.0_rk, 1.0_rk)
   type(interval_t), parameter :: share = interval_t(0.0_rk, 1.0_rk, .true., .false.)

   !> Range in which the drained bulk modulus is positive and finite.
   type(interval_t), parameter :: poisson_range = interval_t(-1.0_rk, 0.5_rk, .true., .true.)
   type(interval_t), parameter :: biot_range = interval_t(0.0_rk, 1.0_rk)
   type(interval_t), parameter :: porosity_range = interval_t(0.0_rk, 1.0_rk, .false., .true.)
   type(interval_t), parameter :: dilation_range = interval_t(0.0_rk, 45.0_rk)  !< [degree]

   !> With fewer than 6 sectors an element at the tip spans more than 60 degrees.
   type(interval_t), parameter :: rosette_range = interval_t(6.0_rk, 64.0_rk)
   type(interval_t), parameter :: steps_range = interval_t(1.0_rk, 100000.0_rk)
   !> Exponent of the viscosity; that of oils and brines is below 1e-7 1/Pa.
   type(interval_t), parameter :: exponent_range = interval_t(-1.0e-6_rk, 1.0e-6_rk)  !< [1/Pa]
   type(interval_t), parameter :: passes_range = interval_t(1.0_rk, 20.0_rk)
   type(interval_t), parameter :: newton_range = interval_t(1.0_rk, 1000.0_rk)

   !> From round-off to the largest residual of an accepted step.
   type(interval_t), parameter :: tolerance_range = interval_t(1.0e-14_rk, 1.0e-8_rk)

contains

   !> A word with its ASCII letters in lower case.
   pure function lower_case(word) result(lower)
      character(len=*), intent(in) :: word
      character(len=len(word)) :: lower
      integer :: i, code

      lower = word
      do i = 1, len(word)
         code = iachar(word(i:i))
         if (code >= iachar("A") .and. code <= iachar("Z")) lower(i:i) = achar(code + 32)
      end do
   end function lower_case

   !> Insertions, deletions, replacements and swaps of neighbours that turn a into b (optimal string
   !! alignment; Damerau 1964).
   pure integer function edit_distance(a, b) result(distance)
      character(len=*), intent(in) :: a, b
      integer :: d(-1:len(a), -1:len(b))
      integer :: i, j, cost

      d = len(a) + len(b)
      d(0:, 0) = [(i, i=0, len(a))]
      d(0, 0:) = [(j, j=0, len(b))]
      do j = 1, len(b)
         do i = 1, len(a)
            cost = merge(0, 1, a(i:i) == b(j:j))
            d(i, j) = min(d(i - 1, j) + 1, d(i, j - 1) + 1, d(i - 1, j - 1) + cost)
            if (i > 1 .and. j > 1) then
               if (a(i:i) == b(j - 1:j - 1) .and. a(i - 1:i - 1) == b(j:j)) then
                  d(i, j) = min(d(i, j), d(i - 2, j - 2) + 1)
               end if
            end if
         end do
      end do
      distance = d(len(a), len(b))
   end function edit_distance

   !> The candidate nearest to a word, empty if none is near; upper and lower case are equal. Words
   !! are near if their edit distance is at most one to three, by the length of the word, or if one
   !! begins with the other, as `dilation` and `dilation_deg`.
   pure function nearest_word(word, candidates) result(best)
      character(len=*), intent(in) :: word
      character(len=*), intent(in) :: candidates(:)
      character(len=:), allocatable :: best, candidate, given
      integer :: distance, least, i

      best = ""
      least = huge(0)
      given = lower_case(word(:min(len(word), longest_compared)))
      do i = 1, size(candidates)
         candidate = lower_case(trim(candidates(i)))
         distance = edit_distance(given, candidate)
         if (distance >= least) cycle
         if (distance > most_slips(len(given)) .and. .not. is_beginning(given, candidate)) cycle
         least = distance
         best = trim(candidates(i))
      end do
   end function nearest_word

   !> Largest edit distance of near words by the length of a word.
   pure integer function most_slips(length)
      integer, intent(in) :: length

      most_slips = min(max(1, length/3), 3, max(length - 1, 0))
   end function most_slips

   !> One of two words begins with the other, which has at least three letters.
   pure logical function is_beginning(a, b)
      character(len=*), intent(in) :: a, b
      integer, parameter :: shortest = 3
      integer :: n

      n = min(len(a), len(b))
      is_beginning = n >= shortest .and. a(:n) == b(:n)
   end function is_beginning

   !> A word consists of letters, digits, `_`, `-` and `.`, and begins with a letter or a digit:
   !! safe as a file name and as part of a column name.
   pure logical function is_identifier(word)
      character(len=*), intent(in) :: word
      character(len=*), parameter :: alphanumeric = "abcdefghijklmnopqrstuvwxyz"// &
                                     "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"

      is_identifier = len(word) > 0 .and. verify(word, alphanumeric//"_-.") == 0
      if (is_identifier) is_identifier = index(alphanumeric, word(1:1)) > 0
   end function is_identifier

   !> The shortest decimal text that reads back to the same bits, as `0.25`, `97200.0` or `4.0e-10`;
   !! inf or nan for a result that is no number.
   pure function real_text(value, n_digits) result(text)
      real(rk), intent(in) :: value  !< [any unit]
      integer, intent(in), optional :: n_digits  !< significant digits; default: all
      character(len=:), allocatable :: text
      character(len=most_digits), parameter :: zeros = repeat("0", most_digits)
      character(len=most_digits) :: all_digits
      character(len=:), allocatable :: digits
      integer :: exponent

      if (.not. abs(value) <= huge(value)) then
         text = brief_text(value, most_digits)
         return
      end if
      call decimal_digits(value, all_digits, exponent, n_digits)
      digits = trim(all_digits)
      if (exponent >= 0 .and. exponent <= 6) then
         digits = digits//zeros(1:max(0, exponent + 2 - len(digits)))
         text = digits(1:exponent + 1)//"."//digits(exponent + 2:)
      else if (exponent < 0 .and. exponent >= -3) then
         text = "0."//zeros(1:-exponent - 1)//digits
      else
         if (len(digits) == 1) digits = digits//"0"
         text = digits(1:1)//"."//digits(2:)//"e"//integer_text(int(exponent, ik))
      end if
      if (sign(1.0_rk, value) < 0.0_rk) text = "-"//text
   end function real_text

   !> A computed number for a message, rounded to four digits.
   pure function rounded_text(value) result(text)
      real(rk), intent(in) :: value  !< [any unit]
      character(len=:), allocatable :: text

      text = real_text(value, 4)
   end function rounded_text

   !> A value lies within an interval; a NaN does not.
   pure logical function holds(interval, value)
      type(interval_t), intent(in) :: interval
      real(rk), intent(in) :: value  !< [any unit]

      holds = value >= interval%lowest .and. value <= interval%highest
      if (interval%open_below) holds = holds .and. value > interval%lowest
      if (interval%open_above) holds = holds .and. value < interval%highest
   end function holds

   !> An interval in words, as `at least 0.0 and less than 0.5`; empty without bounds.
   pure function in_words(interval, whole) result(words)
      type(interval_t), intent(in) :: interval
      logical, intent(in) :: whole  !< the values are whole numbers
      character(len=:), allocatable :: words
      logical :: bounded_below, bounded_above

      bounded_below = interval%lowest > -huge(1.0_rk)
      bounded_above = interval%highest < huge(1.0_rk)
      words = ""
      if (bounded_below) then
         words = "at least "//bound_text(interval%lowest, whole)
         if (interval%open_below) words = "greater than "//bound_text(interval%lowest, whole)
      end if
      if (bounded_below .and. bounded_above) words = words//" and "
      if (bounded_above) then
         if (interval%open_above) then
            words = words//"less than "//bound_text(interval%highest, whole)
         else
            words = words//"at most "//bound_text(interval%highest, whole)
         end if
      end if
   end function in_words

   !> A bound as a real or whole number.
   pure function bound_text(bound, whole) result(text)
      real(rk), intent(in) :: bound  !< [any unit]
      logical, intent(in) :: whole
      character(len=:), allocatable :: text

      if (whole) then
         text = integer_text(nint(bound, ik))
      else
         text = real_text(bound)
      end if
   end function bound_text

end module scene_words
