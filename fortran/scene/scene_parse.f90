!> Reads a scene file into a sheet: checks syntax, names, kinds and ranges one by one. Named values
!! of &define groups, and expressions with them, may replace numbers.
module scene_parse
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_number, only: integer_text, number_width
   use base_texts, only: text_t
   use scene_expression, only: begins_value, constant_t, evaluate, token_comma, token_end, &
                               token_group, token_list_t, token_slash, token_t, token_text, &
                               token_word, tokenize, unquoted
   use scene_parameter_table, only: parameters
   use scene_parameters, only: groups, kind_real, kind_reals, parameter_t
   use scene_schedule, only: load_file
   use scene_sheet, only: add_record, empty_record, group_index, line_text, parameter_index, &
                          path_from, place, record_t, refuse, sheet_t
   use scene_units, only: find_with_unit, in_unit, unit_t
   use scene_values, only: read_value, shortened, value_t
   use scene_words, only: lower_case, nearest_word, real_text
   implicit none(type, external)
   private

   public :: parse_scene

   integer, parameter :: most_groups = 10000
   integer, parameter :: most_included = 1000  !< included files, each as often as it is included
   integer, parameter :: most_nested = 20  !< nesting of files that include each other

   integer, parameter :: most_constants = 1000

contains

   !> Read and parse a file.
   subroutine parse_scene(path, sheet, error)
      character(len=*), intent(in) :: path
      type(sheet_t), intent(out) :: sheet
      type(error_t), allocatable, intent(out) :: error
      logical :: exists

      sheet%path = trim(path)
      allocate (sheet%constants(0))
      inquire (file=sheet%path, exist=exists)
      if (.not. exists) then
         call raise_error(error, "", sheet%path//": there is no such scene file")
         return
      end if
      call parse_file([text_t ::], sheet, error)
   end subroutine parse_scene

   !> Add the groups of the file sheet%path, and of the files that it includes, to the sheet.
   recursive subroutine parse_file(parents, sheet, error)
      type(text_t), intent(in) :: parents(:)  !< paths of the including files, from the first
      type(sheet_t), intent(inout) :: sheet
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: source, fault
      type(token_list_t) :: tokens
      integer(ik) :: fault_line

      call load_file(sheet%path, sheet%n_bytes, source, fault)
      if (allocated(fault)) then
         call raise_error(error, "", sheet%path//": is "//fault)
         return
      end if
      call tokenize(source, tokens, fault, fault_line)
      if (.not. begins_as_scene(source, tokens, allocated(fault))) then
         call raise_error(error, "", sheet%path//": is no scene file, which begins with a "// &
                          "group, as &domain, or with include")
      else if (allocated(fault)) then
         call raise_error(error, "", sheet%path//":"//integer_text(fault_line)//": "//fault)
      else
         call parse_groups(source, tokens, parents, sheet, error)
      end if
   end subroutine parse_file

   !> The first token is the name of a group or an include, or there is none.
   pure logical function begins_as_scene(source, tokens, is_cut)
      character(len=*), intent(in) :: source
      type(token_list_t), intent(in) :: tokens
      logical, intent(in) :: is_cut  !< the list ends at a character that belongs to no token

      associate (token => tokens%items(1))
         select case (token%kind)
         case (token_group)
            begins_as_scene = is_constant_name(lower_case(source(token%first:token%last)))
         case (token_end)
            begins_as_scene = .not. is_cut
         case default
            begins_as_scene = is_include(source, token, tokens%items(2))
         end select
      end associate
   end function begins_as_scene

   !> Add the groups of the file of `include 'path'` between groups. The path is relative to the
   !! folder of the including file.
   recursive subroutine include_file(quoted, line, parents, sheet, error)
      character(len=*), intent(in) :: quoted  !< the path in its quotes
      integer(ik), intent(in) :: line
      type(text_t), intent(in) :: parents(:)
      type(sheet_t), intent(inout) :: sheet
      type(error_t), allocatable, intent(out) :: error
      type(text_t), allocatable :: chain(:)
      character(len=:), allocatable :: here
      logical :: exists
      integer :: k

      here = sheet%path
      chain = [parents, text_t(here)]
      sheet%path = path_from(here, unquoted(quoted))
      sheet%n_included = sheet%n_included + 1
      inquire (file=sheet%path, exist=exists)
      do k = 1, size(chain)
         if (chain(k)%text /= sheet%path) cycle
         call raise_error(error, "", here//":"//integer_text(line)//": include "//quoted// &
                          " is circular: that file includes this one")
         return
      end do
      if (size(chain) > most_nested) then
         call raise_error(error, "", here//":"//integer_text(line)//": include "//quoted// &
                          " is nested too deeply, in more than "// &
                          integer_text(int(most_nested, ik))//" files")
      else if (sheet%n_included > most_included) then
         call raise_error(error, "", here//":"//integer_text(line)//": include "//quoted// &
                          " is one more than the "//integer_text(int(most_included, ik))// &
                          " files that a scene may include")
      else if (.not. exists) then
         call raise_error(error, "", here//":"//integer_text(line)//": include "//quoted// &
                          ": there is no file "//sheet%path)
      else
         call parse_file(chain, sheet, error)
      end if
      if (.not. allocated(error)) sheet%path = here
   end subroutine include_file

   !> Add all groups of a file to the sheet.
   recursive subroutine parse_groups(source, tokens, parents, sheet, error)
      character(len=*), intent(in) :: source
      type(token_list_t), intent(in) :: tokens
      type(text_t), intent(in) :: parents(:)
      type(sheet_t), intent(inout) :: sheet
      type(error_t), allocatable, intent(out) :: error
      type(record_t) :: record
      integer :: next, group, earlier

      next = 1
      do while (tokens%items(next)%kind /= token_end)
         if (is_include(source, tokens%items(next), tokens%items(next + 1))) then
            associate (path => tokens%items(next + 1))
               call include_file(source(path%first:path%last), path%line, parents, sheet, error)
            end associate
            if (allocated(error)) return
            next = next + 2
            cycle
         end if
         associate (token => tokens%items(next))
            if (token%kind /= token_group) then
               call raise_error(error, "", place(sheet, token%line)//"text outside of a "// &
                                "group, where only comments are allowed")
               return
            end if
            if (lower_case(source(token%first:token%last)) == "define") then
               next = next + 1
               call parse_constants(source, tokens, next, sheet, error)
               if (allocated(error)) return
               cycle
            end if
            group = group_index(lower_case(source(token%first:token%last)))
            if (group == 0) then
               call raise_error(error, "", place(sheet, token%line)// &
                                unknown_group(source(token%first:token%last)))
               return
            end if
            earlier = 0
            if (.not. groups(group)%repeated) earlier = sheet%find(trim(groups(group)%name))
            record = empty_record(group, token%line)
            record%path = sheet%path
         end associate
         call add_record(sheet, record)
         if (sheet%length > most_groups) then
            call refuse(error, sheet, sheet%length, "", "is one more than the "// &
                        integer_text(int(most_groups, ik))//" groups that a scene may have")
            return
         else if (earlier > 0) then
            call refuse(error, sheet, sheet%length, "", "is given twice, first on "// &
                        line_text(sheet, earlier, sheet%records(earlier)%line, sheet%length)// &
                        ", but must be given once: put all its names there")
            return
         end if
         next = next + 1
         call parse_values(source, tokens, next, sheet, error)
         if (allocated(error)) return
      end do
   end subroutine parse_groups

   !> Read the values between `&group` and `/` into the last record.
   pure subroutine parse_values(source, tokens, next, sheet, error)
      character(len=*), intent(in) :: source
      type(token_list_t), intent(in) :: tokens
      integer, intent(inout) :: next
      type(sheet_t), intent(inout) :: sheet
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: reason, word
      integer :: first, item
      type(unit_t) :: unit

      associate (record => sheet%records(sheet%length), items => tokens%items)
         do while (items(next)%kind /= token_slash)
            word = source(items(next)%first:items(next)%last)
            if (items(next)%kind == token_end .or. items(next)%kind == token_group) then
               call refuse(error, sheet, sheet%length, "", "is not ended by '/' as it must be")
               return
            else if (.not. begins_value(items(next)%kind, items(next + 1)%kind)) then
               call raise_error(error, "", place(sheet, items(next)%line)//"&"// &
                                trim(groups(record%group)%name)//": '"//shortened(word)// &
                                "' stands where 'name = value' or the closing '/' is expected")
               return
            end if
            item = parameter_index(record%group, lower_case(word))
            unit = unit_t()
            if (item == 0) call find_with_unit(lower_case(word), record%group, item, unit)
            if (item == 0) then
               call raise_error(error, "", place(sheet, items(next)%line)// &
                                unknown_name(record%group, word))
               return
            else if (record%values(item)%line > 0) then
               call raise_error(error, "", place(sheet, items(next)%line)//"&"// &
                                trim(groups(record%group)%name)//": "// &
                                trim(parameters(item)%name)//" is given twice, first on line "// &
                                integer_text(record%values(item)%line)//", but must be given once")
               return
            end if
            record%values(item)%line = items(next)%line
            first = next + 2
            next = first
            do while (any(items(next)%kind == [token_word, token_text, token_comma]))
               if (begins_value(items(next)%kind, items(next + 1)%kind)) exit
               next = next + 1
            end do
            call read_resolved(in_unit(parameters(item), unit), source, items(first:next - 1), &
                               sheet%constants, record%values(item), reason)
            if (allocated(reason)) then
               call refuse(error, sheet, sheet%length, trim(parameters(item)%name), reason)
               return
            end if
            associate (value => record%values(item))
               value%per_thickness = unit%per_thickness
               if (allocated(value%reals)) value%reals = unit%factor*value%reals
            end associate
         end do
      end associate
      next = next + 1
   end subroutine parse_values

   !> A token and the next one are the word include and a text.
   pure logical function is_include(source, token, next)
      character(len=*), intent(in) :: source
      type(token_t), intent(in) :: token, next

      is_include = .false.
      if (token%kind /= token_word .or. next%kind /= token_text) return
      is_include = lower_case(source(token%first:token%last)) == "include"
   end function is_include

   !> Message for an unknown group.
   pure function unknown_group(word) result(message)
      character(len=*), intent(in) :: word
      character(len=:), allocatable :: message, likely

      likely = nearest_word(word, groups%name)
      message = "unknown group &"//shortened(word)
      if (likely /= "") message = message//", the nearest is &"//likely
      message = message//" (see docs/input.md)"
   end function unknown_group

   !> Message for an unknown name of a group.
   pure function unknown_name(group, word) result(message)
      integer, intent(in) :: group
      character(len=*), intent(in) :: word
      character(len=:), allocatable :: message, likely
      integer :: bracket, owner

      bracket = index(word//"(", "(")
      likely = nearest_word(word(:bracket - 1), &
                            pack(parameters%name, parameters%group == groups(group)%name))
      message = "&"//trim(groups(group)%name)//": unknown name "//shortened(word)
      owner = findloc(parameters%name == lower_case(word), .true., dim=1)
      if (owner > 0) then
         message = message//", which belongs to &"//trim(parameters(owner)%group)
         if (likely /= "") message = message//"; the nearest here is "//likely
      else if (likely /= "") then
         message = message//", the nearest is "//likely
      end if
      if (bracket <= len(word) .and. likely /= "") then
         message = message//", whose values are given as one list without indices"
      end if
      message = message//" (see docs/input.md)"
   end function unknown_name

   !> Read values; after a &define, texts instead of numbers are expressions.
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
         associate (item => source(items(k)%first:items(k)%last))
            if (items(k)%kind /= token_text) then
               call add_word(resolved, length, item)
               cycle
            end if
            call evaluate(unquoted(item), constants, number, fault)
            if (allocated(fault)) then
               reason = "is "//shortened(item)//", which is no expression: "//fault
               return
            end if
            call add_word(resolved, length, real_text(number))
         end associate
      end do
      call tokenize(resolved, tokens, fault, fault_line)
      call read_value(parameter, resolved, tokens%items(:tokens%length - 1), value, reason)
   end subroutine read_resolved

   !> Put a word and a blank after the first characters of a text of sufficient length.
   pure subroutine add_word(text, length, word)
      character(len=:), allocatable, intent(inout) :: text
      integer, intent(inout) :: length  !< characters in use
      character(len=*), intent(in) :: word

      text(length + 1:length + len(word)) = word
      length = length + len(word) + 1
   end subroutine add_word

   !> A parameter takes expressions: numbers for which no word is allowed.
   pure logical function takes_expressions(parameter)
      type(parameter_t), intent(in) :: parameter

      takes_expressions = any(parameter%kind == [kind_real, kind_reals]) .and. &
                          len_trim(parameter%choices) == 0
   end function takes_expressions

   !> Read the named values between `&define` and `/`.
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
            fault = "'"//shortened(name)//"' stands where 'name = value' or the closing '/' is "// &
                    "expected"
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

end module scene_parse
