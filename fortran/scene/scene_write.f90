!> Writes a scene with all defaults.
module scene_write
   use base_kinds, only: ik
   use base_number, only: integer_text
   use scene_exchange, only: scene_to_sheet
   use scene_parameters, only: applies, groups, kind_integer, kind_logical, kind_real, &
                               kind_reals, kind_wholes, parameter_t, parameters
   use scene_sheet, only: sheet_t
   use scene_types, only: scene_t
   use scene_values, only: value_t
   use scene_words, only: real_text
   implicit none(type, external)
   private

   public :: scene_text

contains

   !> The text of a scene file. Reading it gives the same scene, bit for bit.
   function scene_text(scene) result(text)
      type(scene_t), intent(in) :: scene  !< as read_scene gives it
      character(len=:), allocatable :: text
      type(sheet_t) :: sheet
      integer :: i, item, length

      call scene_to_sheet(scene, sheet)
      allocate (character(len=4096) :: text)
      length = 0
      call put("! The scene with all defaults; it reproduces the run.")
      call put("! SI units; docs/input.md describes each name.")
      do i = 1, sheet%length
         call put("")
         call put("&"//trim(groups(sheet%records(i)%group)%name))
         do item = lbound(sheet%records(i)%values, 1), ubound(sheet%records(i)%values, 1)
            if (.not. applies(parameters(item)%scenes, scene%has_fluid())) cycle
            if (sheet%records(i)%values(item)%is_set) then
               call put_value(parameters(item), sheet%records(i)%values(item))
            else if (parameters(item)%absent == "") then  ! it has a default, but not here
               call put("  ! "//trim(parameters(item)%name)//": does not apply")
            else
               call put("  ! "//trim(parameters(item)%name)//": "//trim(parameters(item)%absent))
            end if
         end do
         call put("/")
      end do
      text = text(:length)

   contains

      !> One line. The text grows by doubling: polylines may have 100,000 points.
      subroutine put(line)
         character(len=*), intent(in) :: line
         character(len=:), allocatable :: longer

         if (length + len(line) + 1 > len(text)) then
            allocate (character(len=2*(length + len(line) + 1)) :: longer)
            longer(:length) = text(:length)
            call move_alloc(longer, text)
         end if
         text(length + 1:length + len(line) + 1) = line//new_line("a")
         length = length + len(line) + 1
      end subroutine put

      !> `name = value`, with the unit as a comment.
      subroutine put_value(parameter, value)
         type(parameter_t), intent(in) :: parameter
         type(value_t), intent(in) :: value
         character(len=:), allocatable :: unit_comment, line
         integer :: k

         unit_comment = ""
         if (parameter%unit /= "-") unit_comment = "  ! ["//trim(parameter%unit)//"]"
         if (any(parameter%kind == [kind_reals, kind_wholes])) then
            call put("  "//trim(parameter%name)//" ="//unit_comment)
            line = "   "
            do k = 1, size(value%reals)
               if (parameter%kind == kind_reals) then
                  line = line//" "//real_text(value%reals(k))
               else
                  line = line//" "//integer_text(nint(value%reals(k), ik))
               end if
               if (k == size(value%reals) .or. len(line) > 70) then
                  call put(line)
                  line = "   "
               end if
            end do
         else
            call put("  "//trim(parameter%name)//" = "//value_text(parameter, value)//unit_comment)
         end if
      end subroutine put_value

   end function scene_text

   !> A single value as a scene file gives it.
   pure function value_text(parameter, value) result(text)
      type(parameter_t), intent(in) :: parameter
      type(value_t), intent(in) :: value
      character(len=:), allocatable :: text

      select case (parameter%kind)
      case (kind_real)
         if (allocated(value%text)) then  ! a word in its place
            text = quoted(value%text)
         else
            text = real_text(value%reals(1))
         end if
      case (kind_integer)
         text = integer_text(value%whole)
      case (kind_logical)
         text = trim(merge(".true. ", ".false.", value%flag))
      case default
         text = quoted(value%text)
      end select
   end function value_text

   !> In single quotes, those within doubled.
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
