!> Ranges of allowed values, and how to say them in words.
module scene_intervals
   use base_kinds, only: ik, rk
   use base_number, only: integer_text
   use scene_words, only: real_text
   implicit none(type, external)
   private

   public :: interval_t
   public :: holds, in_words
   public :: at_least_one, at_least_zero, below_one, biot_range, dilation_range, newton_range
   public :: poisson_range, porosity_range
   public :: positive, rosette_range, share, steps_range, tolerance_range
   public :: exponent_range, passes_range

   !> Values between two bounds; a bound at +-huge is none, for every value is finite.
   type :: interval_t
      real(rk) :: lowest = -huge(1.0_rk), highest = huge(1.0_rk)
      logical :: open_below = .false., open_above = .false.  !< the bound itself is not allowed
   end type interval_t

   type(interval_t), parameter :: positive = interval_t(lowest=0.0_rk, open_below=.true.)
   type(interval_t), parameter :: at_least_zero = interval_t(lowest=0.0_rk)
   type(interval_t), parameter :: at_least_one = interval_t(lowest=1.0_rk)
   type(interval_t), parameter :: below_one = interval_t(0.0_rk, 1.0_rk)
   type(interval_t), parameter :: share = interval_t(0.0_rk, 1.0_rk, .true., .false.)

   !> Within it the drained bulk modulus is positive and finite.
   type(interval_t), parameter :: poisson_range = interval_t(-1.0_rk, 0.5_rk, .true., .true.)
   type(interval_t), parameter :: biot_range = interval_t(0.0_rk, 1.0_rk)
   type(interval_t), parameter :: porosity_range = interval_t(0.0_rk, 1.0_rk, .false., .true.)
   type(interval_t), parameter :: dilation_range = interval_t(0.0_rk, 45.0_rk)  !< [degree]

   !> With fewer than 6 sectors an element at the tip spans more than 60 degrees.
   type(interval_t), parameter :: rosette_range = interval_t(6.0_rk, 64.0_rk)
   type(interval_t), parameter :: steps_range = interval_t(1.0_rk, 100000.0_rk)
   !> Of the viscosity: oils and brines are below 1e-7 1/Pa.
   type(interval_t), parameter :: exponent_range = interval_t(-1.0e-6_rk, 1.0e-6_rk)  !< [1/Pa]
   type(interval_t), parameter :: passes_range = interval_t(1.0_rk, 20.0_rk)
   type(interval_t), parameter :: newton_range = interval_t(1.0_rk, 1000.0_rk)

   !> Round-off ends below it; no step with a larger residual is ever accepted.
   type(interval_t), parameter :: tolerance_range = interval_t(1.0e-14_rk, 1.0e-8_rk)

contains

   !> A value lies within an interval; a NaN does not.
   pure logical function holds(interval, value)
      type(interval_t), intent(in) :: interval
      real(rk), intent(in) :: value  !< [any unit]

      holds = value >= interval%lowest .and. value <= interval%highest
      if (interval%open_below) holds = holds .and. value > interval%lowest
      if (interval%open_above) holds = holds .and. value < interval%highest
   end function holds

   !> For instance `at least 0.0 and less than 0.5`; empty for all finite numbers.
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

end module scene_intervals
