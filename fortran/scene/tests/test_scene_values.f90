!> Which words are numbers, logicals and texts, and which are refused.
program test_scene_values
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use base_kinds, only: ik, rk
   use scene_expression, only: token_list_t, tokenize
   use scene_parameters, only: kind_choice, kind_integer, kind_logical, kind_name, kind_real, &
                               kind_reals, kind_text, parameter_t
   use scene_values, only: read_value, value_t
   use scene_words, only: holds, in_words, interval_t, poisson_range, positive, share
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks

   call check_numbers()
   call check_lists()
   call check_others()
   call check_intervals()
   call checks%finish()

contains

   subroutine check_numbers()
      call accepts_real("1", 1.0_rk)
      call accepts_real("-1.5", -1.5_rk)
      call accepts_real("+.5", 0.5_rk)
      call accepts_real("5.", 5.0_rk)
      call accepts_real("2.0e-3", 0.002_rk)
      call accepts_real("1D6", 1.0e6_rk)
      call accepts_real("1d+06", 1.0e6_rk)
      call accepts_real("0.1", 0.1_rk)
      call accepts_real("1*2.5", 2.5_rk)
      call accepts_real("2.5,", 2.5_rk)
      call refuses(kind_real, "NaN", "is NaN but must be a finite number")
      call refuses(kind_real, "Infinity", "is Infinity but must be a finite number")
      call refuses(kind_real, "1e999", "is 1e999 but must be a finite number")
      call refuses(kind_real, "1.7976931348623157e308", "is too large")
      call refuses(kind_real, "40GPa", "is 40GPa but must be a finite number")
      call refuses(kind_real, "1.0.0", "must be a finite number")
      call refuses(kind_real, "1e", "must be a finite number")
      call refuses(kind_real, "e5", "must be a finite number")
      call refuses(kind_real, "1e1.5", "must be a finite number")
      call refuses(kind_real, ".", "must be a finite number")
      call refuses(kind_real, "-", "must be a finite number")
      call refuses(kind_real, "1+5", "must be a finite number")
      call refuses(kind_real, "'1.0'", "is '1.0' but must be a finite number")
      call refuses(kind_real, "1.0 2.0", "has 2 values but must be one number")
      call refuses(kind_real, "2*1.0", "has 2 values but must be one number")
      call refuses(kind_real, "0*1.0", "is 0*1.0 but must be a finite number")
      call refuses(kind_real, "", "has no value")
      call refuses(kind_real, ",", "has no value")
      call refuses(kind_real, ", 1.0", "lacks a value before a comma")
      call refuses(kind_integer, "12.0", "is 12.0 but must be a whole number")
      call refuses(kind_integer, "99999999999", "must be a whole number")
   end subroutine check_numbers

   subroutine check_lists()
      type(value_t) :: value
      character(len=:), allocatable :: reason

      call read_word(kind_reals, "1.0, 2*3.0 4", value, reason)
      call checks%is_true(size(value%reals) == 4, "length of a list")
      call checks%is_true(all(abs(value%reals - [1.0_rk, 3.0_rk, 3.0_rk, 4.0_rk]) <= 0.0_rk), &
                          "a list")
      call read_word(kind_reals, "50*1.0 50*2.0", value, reason)
      call checks%is_close(sum(value%reals), 150.0_rk, 0.0_rk, &
                           "a list longer than its first buffer")
      call refuses(kind_reals, "1.0,,2.0", "lacks a value before a comma")
      call refuses(kind_reals, "1.0 two", "is two but must be a finite number")
      call refuses(kind_reals, "999999999999*0.0", "has more than 100000 values")
   end subroutine check_lists

   subroutine check_others()
      type(value_t) :: value
      character(len=:), allocatable :: reason

      call read_word(kind_integer, "+7", value, reason)
      call checks%is_true(value%whole == 7_ik .and. .not. allocated(reason), "whole number")
      call read_word(kind_logical, ".TRUE.", value, reason)
      call checks%is_true(value%flag .and. .not. allocated(reason), "true")
      call read_word(kind_logical, "f", value, reason)
      call checks%is_true(.not. value%flag .and. .not. allocated(reason), "false")
      call refuses(kind_logical, "yes", "is yes but must be .true. or .false.")
      call refuses(kind_logical, "1", "is 1 but must be .true. or .false.")
      call read_word(kind_text, '"it''s"', value, reason)
      call checks%is_true(value%text == "it's", "text")
      call refuses(kind_text, "word", "is word but must be a text in quotes")
      call refuses(kind_text, "'a"//achar(9)//"b'", "is 'a?b' but must be a text")
      call refuses(kind_text, "'"//repeat("x", 257)//"'", "must be a text in quotes of at most 256")
      call refuses(kind_name, "'a b'", "is 'a b' but must be a text in quotes of at most 64")
      call refuses(kind_name, "''", "is '' but must be a text in quotes of at most 64")
      call refuses(kind_choice, "'c'", "is 'c' but must be 'a', 'bb' or 'ccc'")
      call refuses(kind_choice, "'a|bb'", "is 'a|bb' but must be")
      call refuses(kind_choice, "''", "is '' but must be")
   end subroutine check_others

   subroutine check_intervals()
      call checks%is_true(holds(share, 1.0_rk) .and. .not. holds(share, 0.0_rk), &
                          "ends of an interval")
      call checks%is_true(.not. holds(poisson_range, 0.5_rk), "Poisson's ratio stays below a half")
      call checks%is_true(.not. holds(interval_t(), ieee_value(0.0_rk, ieee_quiet_nan)), &
                          "NaN is in no interval")
      call checks%is_true(in_words(positive, whole=.false.) == "greater than 0.0", &
                          "an open interval in words")
      call checks%is_true(in_words(poisson_range, whole=.false.) == "greater than -1.0 and "// &
                          "less than 0.5", "a bounded interval in words")
      call checks%is_true(in_words(interval_t(1.0_rk, 9.0_rk), whole=.true.) == "at least 1 "// &
                          "and at most 9", "an interval of whole numbers")
   end subroutine check_intervals

   subroutine accepts_real(word, expected)
      character(len=*), intent(in) :: word
      real(rk), intent(in) :: expected
      type(value_t) :: value
      character(len=:), allocatable :: reason

      call read_word(kind_real, word, value, reason)
      if (allocated(reason)) then
         call checks%is_true(.false., word//" "//reason)
      else
         call checks%is_close(value%reals(1), expected, 0.0_rk, word)
      end if
   end subroutine accepts_real

   subroutine refuses(kind, word, words)
      integer, intent(in) :: kind
      character(len=*), intent(in) :: word, words
      type(value_t) :: value
      character(len=:), allocatable :: reason

      call read_word(kind, word, value, reason)
      if (.not. allocated(reason)) reason = "accepted"
      call checks%is_true(index(reason, words) > 0, "refusal of <"//word//">: "//reason)
   end subroutine refuses

   subroutine read_word(kind, word, value, reason)
      integer, intent(in) :: kind
      character(len=*), intent(in) :: word
      type(value_t), intent(out) :: value
      character(len=:), allocatable, intent(out) :: reason
      type(token_list_t) :: tokens
      character(len=:), allocatable :: fault
      integer(ik) :: fault_line

      call tokenize(word, tokens, fault, fault_line)
      call read_value(parameter_t("group", "name", kind, choices="a|bb|ccc"), word, &
                      tokens%items(1:tokens%length - 1), value, reason)
   end subroutine read_word

end program test_scene_values
