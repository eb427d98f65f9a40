!> Writing of a scene as understood, every default written out.
module scene_write
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik
   use base_number, only: integer_text
   use scene_exchange, only: scene_to_sheet
   use scene_parameters, only: applies, groups, kind_integer, kind_logical, kind_real, kind_reals, &
                               kind_wholes, parameter_t, parameters
   use scene_sheet, only: sheet_t
   use scene_types, only: scene_t
   use scene_values, only: value_t
   use scene_words, only: real_text
   use, intrinsic :: iso_fortran_env, only: int64
   implicit none(type, external)
   private

   public :: write_scene

contains

   !> Write a scene file. Reading it gives the same scene, bit for bit.
   subroutine write_scene(path, scene, error)
      character(len=*), intent(in) :: path
      type(scene_t), intent(in) :: scene  !< as read_scene gives it
      type(error_t), allocatable, intent(out) :: error
      character(len=256) :: reason
      type(sheet_t) :: sheet
      integer :: unit, status, i, item
      integer(int64) :: n_bytes, n_bytes_there

      call scene_to_sheet(scene, sheet)
      n_bytes = 0_int64
      reason = ""
      open (newunit=unit, file=path, action="write", status="replace", iostat=status, iomsg=reason)
      if (status /= 0) then
         call raise_error(error, "", trim(path)//": cannot be written: "//trim(reason))
         return
      end if
      call put("! The scene as understood, every default written out: running it again gives "// &
               "the same run.")
      call put("! SI units; docs/input.md tells what each name means.")
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
      if (status == 0) then
         close (unit, iostat=status, iomsg=reason)
         inquire (file=path, size=n_bytes_there)
         if (status == 0 .and. n_bytes_there /= n_bytes) then
            status = 1  ! gfortran closes without a word what a full disk cut
            reason = "not all bytes were taken, the disk may be full"
         end if
      else
         close (unit, status="delete")
      end if
      if (status /= 0) call raise_error(error, "", trim(path)//": cannot be written: "// &
                                        trim(reason))

   contains

      !> One line, unless a line before it failed.
      subroutine put(line)
         character(len=*), intent(in) :: line
         integer :: status_now

         if (status /= 0) return
         write (unit, "(a)", iostat=status_now, iomsg=reason) line
         if (status_now /= 0) status = status_now
         n_bytes = n_bytes + len(line, kind=int64) + 1_int64  ! and the line's end
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

   end subroutine write_scene

   !> A single value as a scene file gives it.
   pure function value_text(parameter, value) result(text)
      type(parameter_t), intent(in) :: parameter
      type(value_t), intent(in) :: value
      character(len=:), allocatable :: text

      select case (parameter%kind)
      case (kind_real)
         text = real_text(value%reals(1))
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
