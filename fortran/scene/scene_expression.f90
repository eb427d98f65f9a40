!> Divides the text of a scene file into tokens with their lines, and evaluates expressions:
!! numbers, named values, + - * / ^, brackets, sqrt, sin, cos and tan of radians, sind, cosd and
!! tand of degrees, and pi. A name must be defined before it is used, so no name can depend on
!! itself.
!!
!! The syntax is that of Fortran namelists: `&group`, `name = values`, `/`, comments from `!` to the
!! end of the line, texts in single or double quotes in which a doubled quote stands for one.
module scene_expression
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use base_kinds, only: ik, pi, radians, rk
   use base_number, only: integer_text
   use scene_words, only: lower_case
   implicit none(type, external)
   private

   public :: begins_value, constant_t, evaluate, token_comma, token_end, token_equals, token_group
   public :: token_list_t, token_slash, token_t, token_text, token_word, tokenize, unquoted

   integer, parameter :: longest_name = 64
   integer, parameter :: most_brackets = 50
   integer, parameter :: longest_expression = 10000  !< characters

   !> A named value.
   type :: constant_t
      character(len=longest_name) :: name = ""  !< in lower case
      real(rk) :: value = 0.0_rk
      integer(ik) :: line = 0
   end type constant_t

   !> An expression and the position reached in it.
   type :: reading_t
      character(len=:), allocatable :: text  !< in lower case, with a blank at its end
      integer :: position = 1
      integer :: depth = 0  !< nesting of brackets, signs and exponents
      character(len=:), allocatable :: fault  !< reason of a failure; unallocated: none so far
   end type reading_t

   integer, parameter :: token_group = 1  !< `&name`; the range holds the name alone
   integer, parameter :: token_word = 2  !< a name, a number or a logical
   integer, parameter :: token_text = 3  !< a quoted text, with its quotes
   integer, parameter :: token_equals = 4
   integer, parameter :: token_comma = 5
   integer, parameter :: token_slash = 6
   integer, parameter :: token_end = 7  !< after the last character

   !> The part source(first:last).
   type :: token_t
      integer :: kind = token_end
      integer :: first = 1, last = 0
      integer(ik) :: line = 0  !< line of its beginning, from 1
   end type token_t

   !> The tokens of one source; the last one is of the kind token_end.
   type :: token_list_t
      type(token_t), allocatable :: items(:)
      integer :: length = 0
   end type token_list_t

   character(len=1), parameter :: tab = achar(9), line_feed = achar(10), carriage_return = achar(13)

contains

   !> The value of an expression.
   pure subroutine evaluate(expression, constants, value, fault)
      character(len=*), intent(in) :: expression
      type(constant_t), intent(in) :: constants(:)
      real(rk), intent(out) :: value  !< [any unit]
      character(len=:), allocatable, intent(out) :: fault  !< reason of a failure; unallocated: good
      type(reading_t) :: reading

      value = 0.0_rk
      if (len(expression) > longest_expression) then
         fault = "it has more than "//integer_text(int(longest_expression, ik))//" characters"
         return
      end if
      reading%text = lower_case(expression)//" "
      call read_sum(reading, constants, value)
      if (.not. allocated(reading%fault) .and. next(reading) /= " ") then
         reading%fault = "'"//next(reading)//"' stands where an operator or the end is expected"
      end if
      if (.not. allocated(reading%fault) .and. .not. ieee_is_finite(value)) then
         reading%fault = "the result is no finite number"
      end if
      if (allocated(reading%fault)) fault = reading%fault
   end subroutine evaluate

   !> The next character that is no blank; a blank at the end.
   pure character function next(reading)
      type(reading_t), intent(in) :: reading

      integer :: blanks

      blanks = verify(reading%text(reading%position:), " ") - 1
      next = " "
      if (blanks >= 0) next = reading%text(reading%position + blanks:)
   end function next

   !> Move the position behind the next character.
   pure subroutine take(reading)
      type(reading_t), intent(inout) :: reading

      reading%position = reading%position + verify(reading%text(reading%position:), " ")
   end subroutine take

   !> Products with + and - between them.
   pure recursive subroutine read_sum(reading, constants, value)
      type(reading_t), intent(inout) :: reading
      type(constant_t), intent(in) :: constants(:)
      real(rk), intent(out) :: value
      real(rk) :: other
      character :: operator

      call read_product(reading, constants, value)
      do while (.not. allocated(reading%fault))
         operator = next(reading)
         if (scan(operator, "+-") == 0) return
         call take(reading)
         call read_product(reading, constants, other)
         value = merge(value + other, value - other, operator == "+")
      end do
   end subroutine read_sum

   !> Signed powers with * and / between them.
   pure recursive subroutine read_product(reading, constants, value)
      type(reading_t), intent(inout) :: reading
      type(constant_t), intent(in) :: constants(:)
      real(rk), intent(out) :: value
      real(rk) :: other
      character :: operator

      call read_signed(reading, constants, value)
      do while (.not. allocated(reading%fault))
         operator = next(reading)
         if (scan(operator, "*/") == 0) return
         call take(reading)
         call read_signed(reading, constants, other)
         if (operator == "*") then
            value = value*other
         else if (abs(other) <= 0.0_rk) then
            if (.not. allocated(reading%fault)) reading%fault = "it divides by zero"
         else
            value = value/other
         end if
      end do
   end subroutine read_product

   !> A sign binds less than a power: -2^2 is -4.
   pure recursive subroutine read_signed(reading, constants, value)
      type(reading_t), intent(inout) :: reading
      type(constant_t), intent(in) :: constants(:)
      real(rk), intent(out) :: value
      character :: sign

      value = 0.0_rk
      sign = next(reading)
      if (scan(sign, "+-") == 0) then
         call read_power(reading, constants, value)
         return
      end if
      call take(reading)
      call go_down(reading)
      if (allocated(reading%fault)) return
      call read_signed(reading, constants, value)
      reading%depth = reading%depth - 1
      if (sign == "-") value = -value
   end subroutine read_signed

   !> Powers bind from the right: 2^3^2 is 2^9.
   pure recursive subroutine read_power(reading, constants, value)
      type(reading_t), intent(inout) :: reading
      type(constant_t), intent(in) :: constants(:)
      real(rk), intent(out) :: value
      real(rk) :: exponent

      call read_operand(reading, constants, value)
      if (allocated(reading%fault)) return
      if (next(reading) /= "^") return
      call take(reading)
      call go_down(reading)
      if (allocated(reading%fault)) return
      call read_signed(reading, constants, exponent)
      reading%depth = reading%depth - 1
      if (abs(exponent - anint(exponent)) > 0.0_rk .or. abs(exponent) > 1.0e6_rk) then
         value = value**exponent
      else
         value = value**nint(exponent)
      end if
   end subroutine read_power

   !> A number, a name or an expression in brackets.
   pure recursive subroutine read_operand(reading, constants, value)
      type(reading_t), intent(inout) :: reading
      type(constant_t), intent(in) :: constants(:)
      real(rk), intent(out) :: value

      value = 0.0_rk
      select case (next(reading))
      case ("(")
         call take(reading)
         call go_down(reading)
         if (allocated(reading%fault)) return
         call read_sum(reading, constants, value)
         reading%depth = reading%depth - 1
         if (allocated(reading%fault)) return
         if (next(reading) == ")") then
            call take(reading)
         else
            reading%fault = "a bracket is not closed"
         end if
      case ("0":"9", ".")
         call read_number(reading, value)
      case ("a":"z")
         call read_name(reading, constants, value)
      case (" ")
         reading%fault = "it ends where a number or a name is expected"
      case default
         reading%fault = "'"//next(reading)//"' stands where a number or a name is expected"
      end select
   end subroutine read_operand

   !> Count a bracket, sign or exponent, and refuse too many within each other.
   pure subroutine go_down(reading)
      type(reading_t), intent(inout) :: reading

      reading%depth = reading%depth + 1
      if (reading%depth > most_brackets) reading%fault = "it is nested too deeply"
   end subroutine go_down

   !> A number.
   pure subroutine read_number(reading, value)
      type(reading_t), intent(inout) :: reading
      real(rk), intent(out) :: value
      integer :: first, last, length, status

      value = 0.0_rk
      call take(reading)
      first = reading%position - 1
      length = verify(reading%text(first:), "0123456789.") - 1
      last = first + length - 1
      if (scan(reading%text(last + 1:last + 1), "ed") > 0) then
         length = 1
         if (scan(reading%text(last + 2:min(last + 2, len(reading%text))), "+-") == 1) length = 2
         last = last + length + verify(reading%text(last + length + 1:), "0123456789") - 1
      end if
      reading%position = last + 1
      read (reading%text(first:last), *, iostat=status) value
      if (status /= 0) reading%fault = "'"//reading%text(first:last)//"' is no number"
   end subroutine read_number

   !> The value of a name, or of a function of what follows in brackets.
   pure recursive subroutine read_name(reading, constants, value)
      type(reading_t), intent(inout) :: reading
      type(constant_t), intent(in) :: constants(:)
      real(rk), intent(out) :: value
      character(len=:), allocatable :: name
      integer :: first, k

      call take(reading)
      first = reading%position - 1
      k = verify(reading%text(first:), "abcdefghijklmnopqrstuvwxyz0123456789_") - 1
      name = reading%text(first:first + k - 1)
      reading%position = first + k
      value = 0.0_rk
      if (next(reading) == "(") then
         call read_operand(reading, constants, value)
         if (.not. allocated(reading%fault)) call apply_function(reading, name, value)
         return
      end if
      do k = 1, size(constants)
         if (constants(k)%name /= name) cycle
         value = constants(k)%value
         return
      end do
      if (name == "pi") then
         value = pi
      else
         reading%fault = "there is no value '"//name//"' of &define before it"
      end if
   end subroutine read_name

   !> Apply a function to a value.
   pure subroutine apply_function(reading, name, value)
      type(reading_t), intent(inout) :: reading
      character(len=*), intent(in) :: name
      real(rk), intent(inout) :: value

      select case (name)
      case ("sqrt")
         if (value < 0.0_rk) reading%fault = "the root of a negative number is none"
         value = sqrt(abs(value))
      case ("sin")
         value = sin(value)
      case ("cos")
         value = cos(value)
      case ("tan")
         value = tan(value)
      case ("sind")
         value = sin(value*radians)
      case ("cosd")
         value = cos(value*radians)
      case ("tand")
         value = tan(value*radians)
      case default
         reading%fault = "there is no function '"//name//"' (there are sqrt, sin, cos, tan of "// &
                         "radians, and sind, cosd, tand of degrees)"
      end select
   end subroutine apply_function

   !> Cut a source into tokens.
   pure subroutine tokenize(source, tokens, fault, fault_line)
      character(len=*), intent(in) :: source
      type(token_list_t), intent(out) :: tokens
      character(len=:), allocatable, intent(out) :: fault  !< reason of a failure; unallocated: good
      integer(ik), intent(out) :: fault_line  !< 0 without a fault
      integer, parameter :: marks(3) = [token_equals, token_comma, token_slash]
      integer :: kind, last, position
      integer(ik) :: line

      fault_line = 0
      line = 1
      position = 1
      if (len(source) >= 3) then  ! the byte-order mark of some editors
         if (source(1:3) == char(239)//char(187)//char(191)) position = 4
      end if
      allocate (tokens%items(64))
      do while (position <= len(source))
         select case (source(position:position))
         case (" ", tab, carriage_return)
            position = position + 1
         case (line_feed)
            line = line + 1
            position = position + 1
         case ("!")
            position = position + rest_of_line(source(position:))
         case ("=", ",", "/")
            kind = marks(index("=,/", source(position:position)))
            call append(tokens, token_t(kind, position, position, line))
            position = position + 1
         case ("&")
            last = position + word_length(source(position + 1:))
            call append(tokens, token_t(token_group, position + 1, last, line))
            position = last + 1
         case ("'", '"')
            last = position - 1 + text_length(source(position:))
            if (last < position) then
               fault = "a text in quotes is not closed on its line"
               exit
            end if
            call append(tokens, token_t(token_text, position, last, line))
            position = last + 1
         case default
            last = position - 1 + word_length(source(position:))
            if (last < position) then
               fault = "a character with code "//integer_text(ichar(source(position:position), &
                                                                    ik))// &
                       " is outside of quotes and comments, where only plain text is allowed"
               exit
            end if
            call append(tokens, token_t(token_word, position, last, line))
            position = last + 1
         end select
      end do
      if (allocated(fault)) fault_line = line
      call append(tokens, token_t(token_end, len(source) + 1, len(source), line))
   end subroutine tokenize

   !> The contents of a quoted text.
   pure function unquoted(quoted) result(text)
      character(len=*), intent(in) :: quoted  !< with its quotes
      character(len=:), allocatable :: text
      character(len=len(quoted)) :: buffer
      integer :: i, n

      i = 2
      n = 0
      do while (i < len(quoted))
         n = n + 1
         buffer(n:n) = quoted(i:i)
         if (quoted(i:i) == quoted(1:1)) i = i + 1  ! the second of a doubled quote
         i = i + 1
      end do
      text = buffer(1:n)
   end function unquoted

   !> Number of characters before the end of the line.
   pure integer function rest_of_line(source) result(length)
      character(len=*), intent(in) :: source

      length = index(source, line_feed) - 1
      if (length < 0) length = len(source)
   end function rest_of_line

   !> Length of the word at the beginning of a source; 0 if there is none.
   pure integer function word_length(source) result(length)
      character(len=*), intent(in) :: source
      integer :: i

      length = 0
      do i = 1, len(source)
         select case (source(i:i))
         case ("!", "&", "'", '"', "=", ",", "/")
            return
         case default
            if (ichar(source(i:i)) <= 32 .or. ichar(source(i:i)) >= 127) return
         end select
         length = i
      end do
   end function word_length

   !> Length of the quoted text at the beginning of a source, with both quotes; 0 if it is not
   !! closed on its line.
   pure integer function text_length(source) result(length)
      character(len=*), intent(in) :: source
      integer :: i

      length = 0
      i = 2
      do while (i <= len(source))
         if (source(i:i) == line_feed) return
         if (source(i:i) == source(1:1)) then
            if (i == len(source)) then
               length = i
               return
            else if (source(i + 1:i + 1) /= source(1:1)) then
               length = i
               return
            end if
            i = i + 1
         end if
         i = i + 1
      end do
   end function text_length

   !> Add a token to a list.
   pure subroutine append(tokens, token)
      type(token_list_t), intent(inout) :: tokens
      type(token_t), intent(in) :: token
      type(token_t), allocatable :: larger(:)

      if (tokens%length == size(tokens%items)) then
         allocate (larger(2*tokens%length))
         larger(1:tokens%length) = tokens%items
         call move_alloc(larger, tokens%items)
      end if
      tokens%length = tokens%length + 1
      tokens%items(tokens%length) = token
   end subroutine append

   !> A token and the next one are a word and `=`.
   pure logical function begins_value(kind, next_kind)
      integer, intent(in) :: kind, next_kind

      begins_value = kind == token_word .and. next_kind == token_equals
   end function begins_value

end module scene_expression
