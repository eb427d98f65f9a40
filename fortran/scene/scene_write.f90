!> Writes a scene with all defaults.
module scene_write
   use base_buffer, only: newline, text_buffer_t
   use base_kinds, only: ik
   use base_number, only: integer_text
   use scene_exchange, only: scene_to_sheet
   use scene_parameter_table, only: parameters
   use scene_parameters, only: applies, groups, kind_integer, kind_logical, kind_names, kind_real, &
                               kind_reals, kind_wholes, parameter_t
   use scene_sheet, only: sheet_t
   use scene_types, only: scene_t
   use scene_values, only: value_t
   use scene_words, only: real_text
   implicit none(type, external)
   private

   public :: scene_text

contains

   !> The text of a scene file with all values of a scene. Reading it gives the same scene, bit for
   !! bit.
   function scene_text(scene) result(text)
      type(scene_t), intent(in) :: scene  !< from read_scene
      character(len=:), allocatable :: text
      type(sheet_t) :: sheet
      type(text_buffer_t) :: lines
      integer :: i, item

      call scene_to_sheet(scene, sheet)
      call lines%append("! The scene with all defaults; it reproduces the run."//newline)
      call lines%append("! SI units; docs/input.md describes each name."//newline)
      do i = 1, sheet%length
         call lines%append(newline)
         call lines%append("&"//trim(groups(sheet%records(i)%group)%name)//newline)
         do item = lbound(sheet%records(i)%values, 1), ubound(sheet%records(i)%values, 1)
            associate (parameter => parameters(item), value => sheet%records(i)%values(item))
               if (.not. applies(parameter%scenes, scene%has_fluid())) cycle
               if (parameter%only_with /= "") then
                  if (.not. sheet%has_one(parameter%only_with)) cycle
               end if
               if (value%is_set) then
                  call put_value(lines, parameter, value)
               else if (parameter%absent == "") then  ! a default that this group does not take
                  call lines%append("  ! "//trim(parameter%name)//": does not apply"//newline)
               else
                  call lines%append("  ! "//trim(parameter%name)//": "// &
                                    trim(parameter%absent)//newline)
               end if
            end associate
         end do
         call lines%append("/"//newline)
      end do
      text = lines%text()
   end function scene_text

   !> Add `name = value`, with the unit as a comment; a list follows on separate lines.
   subroutine put_value(lines, parameter, value)
      type(text_buffer_t), intent(inout) :: lines
      type(parameter_t), intent(in) :: parameter
      type(value_t), intent(in) :: value
      character(len=:), allocatable :: line, unit
      integer :: k

      unit = ""
      if (parameter%unit /= "-") unit = "  ! ["//trim(parameter%unit)//"]"
      if (all(parameter%kind /= [kind_reals, kind_wholes]) .or. is_single(parameter, value)) then
         call lines%append("  "//trim(parameter%name)//" = "//value_text(parameter, value)//unit// &
                           newline)
         return
      end if
      call lines%append("  "//trim(parameter%name)//" ="//unit//newline)
      line = "   "
      do k = 1, size(value%reals)
         if (parameter%kind == kind_reals) then
            line = line//" "//real_text(value%reals(k))
         else
            line = line//" "//integer_text(nint(value%reals(k), ik))
         end if
         if (k == size(value%reals) .or. len(line) > 70) then
            call lines%append(line//newline)
            line = "   "
         end if
      end do
   end subroutine put_value

   !> A single value in the form of a scene file.
   pure function value_text(parameter, value) result(text)
      type(parameter_t), intent(in) :: parameter
      type(value_t), intent(in) :: value
      character(len=:), allocatable :: text
      integer :: k

      select case (parameter%kind)
      case (kind_real, kind_reals)
         if (allocated(value%text)) then  ! a word in its place
            text = quoted(value%text)
         else
            text = real_text(value%reals(1))
         end if
      case (kind_integer)
         text = integer_text(value%whole)
      case (kind_logical)
         text = trim(merge(".true. ", ".false.", value%flag))
      case (kind_names)
         text = quoted(trim(value%names(1)))
         do k = 2, size(value%names)
            text = text//", "//quoted(trim(value%names(k)))
         end do
      case default
         text = quoted(value%text)
      end select
   end function value_text

   !> A list by entries of a well that has one.
   pure logical function is_single(parameter, value)
      type(parameter_t), intent(in) :: parameter
      type(value_t), intent(in) :: value

      is_single = parameter%per_entry
      if (is_single) is_single = size(value%reals) == 1
   end function is_single

   !> A text in single quotes; quotes within it are doubled.
   pure function quoted(text) result(with_quotes)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: with_quotes
      integer :: i

      with_quotes = "'"
      do i = 1, len(text)
         with_quotes = with_quotes//text(i:i)
         if (text(i:i) == "'") with_quotes = with_quotes//"'"
      end do
      with_quotes = with_quotes//"'"
   end function quoted

end module scene_write
