!> Converts the tokens after `name =` into a value of the required kind and range.
module scene_values
   use base_kinds, only: ik, rk
   use base_number, only: integer_text
   use base_texts, only: is_printable
   use scene_expression, only: token_comma, token_list_t, token_t, token_text, token_word, &
                               tokenize, unquoted
   use scene_parameters, only: kind_choice, kind_integer, kind_logical, kind_name, &
                 kind_names, kind_real, kind_reals, kind_text, kind_wholes, parameter_t, text_length
   use scene_types, only: name_length
   use scene_words, only: holds, in_words, is_identifier, lower_case
   implicit none(type, external)
   private

   public :: value_t, default_value, most_values, read_value, shortened

   !> The value of a parameter in one group of a file.
   type :: value_t
      logical :: is_set = .false.  !< by the file or by a default
      integer(ik) :: line = 0  !< line of the file; 0: not in the file
      real(rk), allocatable :: reals(:)
      logical :: per_thickness = .false.  !< reals must still be divided by the thickness
      integer(ik) :: whole = 0
      logical :: flag = .false.
      character(len=:), allocatable :: text  !< with several names the last
      character(len=name_length), allocatable :: names(:)
   end type value_t

   integer, parameter :: most_values = 100000  !< values of one name, also by repeat counts

contains

   !> Convert and check the tokens behind `name =`.
   pure subroutine read_value(parameter, source, tokens, value, reason)
      type(parameter_t), intent(in) :: parameter
      character(len=*), intent(in) :: source
      type(token_t), intent(in) :: tokens(:)  !< words, texts and commas
      type(value_t), intent(inout) :: value  !< its line does not change
      character(len=:), allocatable, intent(out) :: reason  !< why not; unallocated: good
      real(rk), allocatable :: numbers(:)
      character(len=name_length), allocatable :: names(:)
      character(len=:), allocatable :: word
      real(rk) :: number
      integer :: i, count, n

      value%is_set = .true.
      allocate (names(0))
      call check_commas(tokens, reason)
      if (allocated(reason)) return

      allocate (numbers(16))
      n = 0
      do i = 1, size(tokens)
         if (tokens(i)%kind == token_comma) cycle
         call split_repeat(source(tokens(i)%first:tokens(i)%last), tokens(i)%kind, word, count)
         if (n + count > most_values) then
            reason = "has more than "//integer_text(int(most_values, ik))//" values"
            return
         end if
         call read_item(parameter, word, tokens(i)%kind == token_text, value, number, reason)
         if (allocated(reason)) return
         if (any(parameter%kind == [kind_reals, kind_wholes])) then
            do while (n + count > size(numbers))
               numbers = [numbers, numbers]
            end do
            numbers(n + 1:n + count) = number
         else if (parameter%kind == kind_names) then
            names = [character(len=name_length) :: names, value%text]
         end if
         n = n + count
      end do
      if (any(parameter%kind == [kind_reals, kind_wholes])) then
         value%reals = numbers(1:n)
      else if (parameter%kind == kind_names) then
         value%names = names
      else if (n > 1) then
         reason = "has "//integer_text(int(n, ik))//" values but must be one "//noun(parameter)
      end if
   end subroutine read_value

   !> The value of a parameter that a file does not give.
   pure subroutine default_value(parameter, value)
      type(parameter_t), intent(in) :: parameter
      type(value_t), intent(out) :: value
      type(token_list_t) :: tokens
      character(len=:), allocatable :: fault
      integer(ik) :: fault_line

      if (parameter%default == "") return
      call tokenize(trim(parameter%default), tokens, fault, fault_line)
      call read_value(parameter, parameter%default, tokens%items(1:tokens%length - 1), value, fault)
   end subroutine default_value

   !> Values are separated by blanks or by one comma; one comma may follow the last.
   pure subroutine check_commas(tokens, reason)
      type(token_t), intent(in) :: tokens(:)
      character(len=:), allocatable, intent(out) :: reason
      logical :: after_value
      integer :: i

      if (all(tokens%kind == token_comma)) then
         reason = "has no value"
         return
      end if
      after_value = .false.
      do i = 1, size(tokens)
         if (tokens(i)%kind == token_comma .and. .not. after_value) then
            reason = "lacks a value before a comma"
            return
         end if
         after_value = tokens(i)%kind /= token_comma
      end do
   end subroutine check_commas

   !> Split `3*0.0` into its count and its value.
   pure subroutine split_repeat(item, token_kind, word, count)
      character(len=*), intent(in) :: item
      integer, intent(in) :: token_kind
      character(len=:), allocatable, intent(out) :: word
      integer, intent(out) :: count
      integer :: star, status

      count = 1
      word = item
      star = index(item, "*")
      if (token_kind /= token_word .or. star < 2) return
      if (verify(item(1:star - 1), "0123456789") /= 0) return
      read (item(1:star - 1), "(i20)", iostat=status) count
      if (status /= 0) count = huge(0) - most_values  ! too large an integer: refused by its size
      count = min(count, huge(0) - most_values)
      if (count >= 1) then
         word = item(star + 1:)
      else  ! 0*x: no value; the word with its star is refused as malformed
         count = 1
      end if
   end subroutine split_repeat

   !> Read one item; a number goes to `number` too.
   pure subroutine read_item(parameter, word, is_text, value, number, reason)
      type(parameter_t), intent(in) :: parameter
      character(len=*), intent(in) :: word  !< a text still has its quotes
      logical, intent(in) :: is_text
      type(value_t), intent(inout) :: value
      real(rk), intent(out) :: number  !< [unit of the name]
      character(len=:), allocatable, intent(out) :: reason
      logical :: good

      number = 0.0_rk
      select case (parameter%kind)
      case (kind_real, kind_reals)
         if (is_text .and. is_choice(parameter, unquoted(word))) then
            value%text = unquoted(word)
            return
         end if
         good = .not. is_text
         if (good) call read_real(word, number, good)
         if (good .and. .not. abs(number) < huge(number)) then
            reason = "is "//shortened(word)//", which is too large; omit the name for 'unlimited'"
            return
         end if
         if (good) good = holds(parameter%range, number)
         if (good) value%reals = [number]
      case (kind_integer, kind_wholes)
         good = .not. is_text
         if (good) call read_integer(word, value%whole, good)
         number = real(value%whole, rk)
         if (good) good = holds(parameter%range, number)
      case (kind_logical)
         good = .not. is_text
         if (good) call read_logical(word, value%flag, good)
      case default
         good = is_text
         if (good) then
            value%text = unquoted(word)
            call check_text(parameter, value%text, reason)
            if (allocated(reason)) return
         end if
      end select
      if (.not. good) reason = "is "//shortened(word)//" but must be "//wanted(parameter)
   end subroutine read_item

   !> A finite number as Fortran writes it: `-1`, `.5`, `2.0e-3`, `1d6`.
   pure subroutine read_real(word, number, good)
      character(len=*), intent(in) :: word
      real(rk), intent(inout) :: number  !< [any unit]
      logical, intent(out) :: good
      character(len=24) :: style
      integer :: mark, status

      mark = scan(word, "eEdD")
      if (mark == 0) mark = len(word) + 1
      good = is_decimal(word(1:mark - 1))
      if (mark <= len(word)) good = good .and. is_whole(word(mark + 1:))
      if (.not. good) return
      write (style, "(a,i0,a)") "(f", len(word), ".0)"
      read (word, style, iostat=status) number
      good = status == 0 .and. abs(number) <= huge(number)
      if (.not. abs(number) > 0.0_rk) number = 0.0_rk  ! not -0.0
   end subroutine read_real

   !> A whole number.
   pure subroutine read_integer(word, whole, good)
      character(len=*), intent(in) :: word
      integer(ik), intent(inout) :: whole
      logical, intent(out) :: good
      character(len=24) :: style
      integer :: status

      good = is_whole(word)
      if (.not. good) return
      write (style, "(a,i0,a)") "(i", len(word), ")"
      read (word, style, iostat=status) whole
      good = status == 0
   end subroutine read_integer

   !> A logical, in the forms of Fortran.
   pure subroutine read_logical(word, flag, good)
      character(len=*), intent(in) :: word
      logical, intent(inout) :: flag
      logical, intent(out) :: good

      good = .true.
      select case (lower_case(word))
      case (".true.", "true", ".t.", "t")
         flag = .true.
      case (".false.", "false", ".f.", "f")
         flag = .false.
      case default
         good = .false.
      end select
   end subroutine read_logical

   !> Length, characters and choice of a text.
   pure subroutine check_text(parameter, text, reason)
      type(parameter_t), intent(in) :: parameter
      character(len=*), intent(in) :: text
      character(len=:), allocatable, intent(out) :: reason  !< why not; unallocated: good
      logical :: good

      select case (parameter%kind)
      case (kind_choice)
         good = is_choice(parameter, text)
      case (kind_name, kind_names)
         good = len(text) <= name_length .and. is_identifier(text)
      case default
         good = len(text) <= text_length .and. is_printable(text)
      end select
      if (.not. good) reason = "is '"//shortened(text)//"' but must be "//wanted(parameter)
   end subroutine check_text

   !> A text is one of the parameter's choices.
   pure logical function is_choice(parameter, text)
      type(parameter_t), intent(in) :: parameter
      character(len=*), intent(in) :: text

      is_choice = index("|"//trim(parameter%choices)//"|", "|"//text//"|") > 0 .and. &
                  index(text, "|") == 0 .and. parameter%choices /= ""
   end function is_choice

   !> Description of the values that a parameter takes, for messages.
   pure function wanted(parameter) result(words)
      type(parameter_t), intent(in) :: parameter
      character(len=:), allocatable :: words

      select case (parameter%kind)
      case (kind_choice)
         words = "'"//with_or(trim(parameter%choices))//"'"
      case (kind_integer, kind_wholes)
         words = "a whole number "//in_words(parameter%range, whole=.true.)
      case (kind_logical)
         words = ".true. or .false."
      case (kind_name, kind_names)
         words = "a text in quotes of at most "//integer_text(int(name_length, ik))// &
                 " letters, digits, '_', '-' and '.', beginning with a letter or a digit"
      case (kind_text)
         words = "a text in quotes of at most "//integer_text(int(text_length, ik))// &
                 " characters in UTF-8"
      case default
         words = "a finite number like 4.0e10"
         if (in_words(parameter%range, whole=.false.) /= "") then
            words = "a finite number "//in_words(parameter%range, whole=.false.)
         end if
         if (parameter%unit /= "-") words = words//" ["//trim(parameter%unit)//"]"
         if (parameter%choices /= "") words = words//" or '"//with_or(trim(parameter%choices))//"'"
      end select
   end function wanted

   !> Noun for one value of a parameter, for messages.
   pure function noun(parameter) result(word)
      type(parameter_t), intent(in) :: parameter
      character(len=:), allocatable :: word

      select case (parameter%kind)
      case (kind_integer, kind_real)
         word = "number"
      case (kind_logical)
         word = "logical"
      case default
         word = "text"
      end select
   end function noun

   !> `a|b|c` as `a', 'b' or 'c`.
   pure function with_or(choices) result(words)
      character(len=*), intent(in) :: choices
      character(len=:), allocatable :: words
      integer :: bar

      words = choices
      bar = index(words, "|", back=.true.)
      if (bar > 0) words = words(1:bar - 1)//"' or '"//words(bar + 1:)
      bar = index(words, "|")
      do while (bar > 0)
         words = words(1:bar - 1)//"', '"//words(bar + 1:)
         bar = index(words, "|")
      end do
   end function with_or

   !> The beginning of a word for a message, safe to print on a terminal.
   pure function shortened(word) result(short)
      character(len=*), intent(in) :: word
      character(len=:), allocatable :: short
      integer, parameter :: longest = 60
      integer :: i

      short = word
      if (len(word) > longest) short = word(1:longest)//"..."
      if (is_printable(short)) return
      do i = 1, len(short)
         if (ichar(short(i:i)) < 32 .or. ichar(short(i:i)) > 126) short(i:i) = "?"
      end do
   end function shortened

   !> Digits with at most one point, with or without a sign.
   pure logical function is_decimal(word)
      character(len=*), intent(in) :: word
      integer :: first, point

      first = after_sign(word)
      point = index(word(first:), ".")
      if (point == 0) then
         is_decimal = is_whole(word)
      else
         is_decimal = len(word(first:)) > 1 .and. verify(word(first:first + point - 2), &
                                                         "0123456789") == 0 .and. &
                      verify(word(first + point:), "0123456789") == 0
      end if
   end function is_decimal

   !> Digits, with or without a sign.
   pure logical function is_whole(word)
      character(len=*), intent(in) :: word
      integer :: first

      first = after_sign(word)
      is_whole = first <= len(word) .and. verify(word(first:), "0123456789") == 0
   end function is_whole

   !> Position of the first character after a sign, if there is one.
   pure integer function after_sign(word) result(first)
      character(len=*), intent(in) :: word

      first = 1
      if (len(word) > 0) then
         if (scan(word(1:1), "+-") == 1) first = 2
      end if
   end function after_sign

end module scene_values
