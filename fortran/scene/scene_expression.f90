!> Named values of a scene file, and plain arithmetic with them: numbers, names, + - * / ^ and
!! brackets. A name must be defined before it is used, so that none can depend on itself.
module scene_expression
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use base_kinds, only: ik, rk
   use base_number, only: integer_text
   use scene_words, only: lower_case
   implicit none(type, external)
   private

   public :: constant_t, evaluate

   integer, parameter :: longest_name = 64
   integer, parameter :: most_brackets = 50
   integer, parameter :: longest_expression = 10000  !< characters

   !> A named value.
   type :: constant_t
      character(len=longest_name) :: name = ""  !< in lower case
      real(rk) :: value = 0.0_rk
      integer(ik) :: line = 0
   end type constant_t

   !> An expression while it is read.
   type :: reading_t
      character(len=:), allocatable :: text  !< in lower case, with a blank at its end
      integer :: position = 1
      integer :: depth = 0  !< of brackets and signs
      character(len=:), allocatable :: fault  !< what is wrong; unallocated: nothing so far
   end type reading_t

contains

   !> The value of an expression.
   pure subroutine evaluate(expression, constants, value, fault)
      character(len=*), intent(in) :: expression
      type(constant_t), intent(in) :: constants(:)
      real(rk), intent(out) :: value
      character(len=:), allocatable, intent(out) :: fault  !< what is wrong; unallocated: good
      type(reading_t) :: reading

      value = 0.0_rk
      if (len(expression) > longest_expression) then
         fault = "it has more than "//integer_text(int(longest_expression, ik))//" characters"
         return
      end if
      reading%text = lower_case(expression)//" "
      call read_sum(reading, constants, value)
      if (.not. allocated(reading%fault) .and. next(reading) /= " ") then
         reading%fault = "'"//next(reading)//"' stands where an operator or the end must stand"
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

   !> Go on behind a character that was the next one.
   pure subroutine take(reading)
      type(reading_t), intent(inout) :: reading

      reading%position = reading%position + verify(reading%text(reading%position:), " ")
   end subroutine take

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
         reading%fault = "it ends where a number or a name must stand"
      case default
         reading%fault = "'"//next(reading)//"' stands where a number or a name must stand"
      end select
   end subroutine read_operand

   pure subroutine go_down(reading)
      type(reading_t), intent(inout) :: reading

      reading%depth = reading%depth + 1
      if (reading%depth > most_brackets) reading%fault = "it is nested too deeply"
   end subroutine go_down

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

   pure subroutine read_name(reading, constants, value)
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
      do k = 1, size(constants)
         if (constants(k)%name /= name) cycle
         value = constants(k)%value
         return
      end do
      reading%fault = "there is no value '"//name//"' of &define before it"
   end subroutine read_name

end module scene_expression
