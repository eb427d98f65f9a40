!> Named values: what &define groups give, and expressions of them in the place of numbers.
module scene_constants
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_number, only: integer_text, number_width
   use scene_expression, only: constant_t, evaluate
   use scene_parameter_types, only: kind_real, kind_reals, parameter_t
   use scene_sheet, only: place, sheet_t
   use scene_tokens, only: begins_value, token_comma, token_end, token_group, token_list_t, &
                           token_slash, token_t, token_text, token_word, tokenize, unquoted
   use scene_values, only: read_value, shortened, value_t
   use scene_words, only: lower_case, real_text
   implicit none(type, external)
   private

   public :: is_constant_name, parse_constants, read_resolved

   integer, parameter :: most_constants = 1000

contains

   !> Values where texts stand for numbers: below a &define those are expressions.
   pure subroutine read_resolved(parameter, source, items, constants, value, reason)
      type(parameter_t), intent(in) :: parameter
      character(len=*), intent(in) :: source
      type(token_t), intent(in) :: items(:)
      type(constant_t), intent(in) :: constants(:)
      type(value_t), intent(inout) :: value
      character(len=:), allocatable, intent(out) :: reason
      character(len=:), allocatable :: resolved, fault
      type(token_list_t) :: tokens
      integer(ik) :: fault_line
      real(rk) :: number
      integer :: k, length

      if (size(constants) == 0 .or. .not. takes_expressions(parameter) .or. &
          all(items%kind /= token_text)) then
         call read_value(parameter, source, items, value, reason)
         return
      end if
      resolved = repeat(" ", sum(max(items%last - items%first, number_width) + 2))
      length = 0
      do k = 1, size(items)
         associate (piece => source(items(k)%first:items(k)%last))
            if (items(k)%kind /= token_text) then
               call add_word(resolved, length, piece)
               cycle
            end if
            call evaluate(unquoted(piece), constants, number, fault)
            if (allocated(fault)) then
               reason = "is "//shortened(piece)//", which is no expression: "//fault
               return
            end if
            call add_word(resolved, length, real_text(number))
         end associate
      end do
      call tokenize(resolved, tokens, fault, fault_line)
      call read_value(parameter, resolved, tokens%items(:tokens%length - 1), value, reason)
   end subroutine read_resolved

   !> Put a word and a blank behind the first characters of a text that has room for them.
   pure subroutine add_word(text, length, word)
      character(len=:), allocatable, intent(inout) :: text
      integer, intent(inout) :: length  !< characters in use
      character(len=*), intent(in) :: word

      text(length + 1:length + len(word)) = word
      length = length + len(word) + 1
   end subroutine add_word

   !> Numbers, unless a text may stand in their place.
   pure logical function takes_expressions(parameter)
      type(parameter_t), intent(in) :: parameter

      takes_expressions = any(parameter%kind == [kind_real, kind_reals]) .and. &
                          len_trim(parameter%choices) == 0
   end function takes_expressions

   !> What stands between `&define` and `/`: names and what they stand for, from top to bottom.
   pure subroutine parse_constants(source, tokens, next, sheet, error)
      character(len=*), intent(in) :: source
      type(token_list_t), intent(in) :: tokens
      integer, intent(inout) :: next
      type(sheet_t), intent(inout) :: sheet
      type(error_t), allocatable, intent(out) :: error
      type(constant_t) :: constant
      character(len=:), allocatable :: fault, name, word
      integer :: earlier

      do while (tokens%items(next)%kind /= token_slash)
         if (tokens%items(next)%kind == token_comma) then
            next = next + 1
            cycle
         end if
         constant%line = tokens%items(next)%line
         name = lower_case(source(tokens%items(next)%first:tokens%items(next)%last))
         if (any(tokens%items(next)%kind == [token_end, token_group])) then
            fault = "is not ended by '/' as it must be"
         else if (.not. begins_value(tokens%items(next)%kind, tokens%items(next + 1)%kind)) then
          fault = "'"//shortened(name)//"' stands where 'name = value' or the closing '/' must "// &
                    "stand"
         else if (.not. is_constant_name(name)) then
            fault = "'"//shortened(name)//"' is no name, which has letters, digits and '_', at "// &
                    "most 64, and begins with a letter"
         else if (all(tokens%items(next + 2)%kind /= [token_word, token_text])) then
            fault = name//" has no value"
         else
            earlier = findloc(sheet%constants%name == name, .true., dim=1)
            if (earlier > 0) fault = name//" is given twice, but must be given once"
            if (size(sheet%constants) == most_constants) fault = name//" is one more than the "// &
                                        integer_text(int(most_constants, ik))//" values that a "// &
                                                                 "scene may give names to"
         end if
         if (.not. allocated(fault)) then
            word = source(tokens%items(next + 2)%first:tokens%items(next + 2)%last)
            if (tokens%items(next + 2)%kind == token_text) word = unquoted(word)
            constant%name = name
            call evaluate(word, sheet%constants, constant%value, fault)
            if (allocated(fault)) fault = name//" is '"//shortened(word)// &
                                          "', which is no expression: "//fault
         end if
         if (allocated(fault)) then
            call raise_error(error, "", place(sheet, constant%line)//"&define: "//fault// &
                             " (see docs/input.md)")
            return
         end if
         sheet%constants = [sheet%constants, constant]
         next = next + 3
      end do
      next = next + 1
   end subroutine parse_constants

   !> Letters, digits and `_`, at most 64, beginning with a letter.
   pure logical function is_constant_name(word)
      character(len=*), intent(in) :: word  !< in lower case
      character(len=*), parameter :: letters = "abcdefghijklmnopqrstuvwxyz"

      is_constant_name = len(word) <= 64 .and. scan(word, letters) == 1 .and. &
                         verify(word, letters//"0123456789_") == 0
   end function is_constant_name

end module scene_constants
