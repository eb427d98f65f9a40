!> What may differ from the scene of a checkpoint at a restart. Both scenes are compared as texts of
!! scene.nml, which have every name of every group.
module app_changes
   use base_errors, only: error_t, raise_error
   use base_kinds, only: rk
   use base_number, only: brief_text
   use base_texts, only: add_text, text_t
   use scene_types, only: scene_t
   use scene_write, only: scene_text
   implicit none(type, external)
   private

   public :: check_changes

   !> Groups and names that may change; * stands for all names of a group.
   character(len=*), parameter :: free(*) = [character(len=30) :: "scene *", "time *", "output *", &
      & "injection start", "injection end", "injection time", "injection schedule", "side time", &
      & "side schedule", "growth stop_gain"]
   !> The same, where the name stays given, or not given: wells stay controlled as they are, and
   !! sides keep the kinds of their conditions.
   character(len=*), parameter :: free_values(*) = [character(len=30) :: "injection rate", &
      & "injection pressure", "side x_traction", "side y_traction", "side normal_traction", &
      & "side shear_traction", "side x_displacement", "side y_displacement", "side pressure", &
      & "side inflow"]

   !> The names of a scene with their values.
   type :: names_t
      type(text_t), allocatable :: group(:), name(:), value(:)
   end type names_t

contains

   !> An error that names the first difference that is not allowed. The scene takes over the first
   !! step of the checkpoint: by default it is a share of the end, which may differ.
   subroutine check_changes(before, scene, time, error)
      character(len=*), intent(in) :: before  !< text of the scene of the checkpoint
      type(scene_t), intent(inout) :: scene
      real(rk), intent(in) :: time  !< of the checkpoint [s]
      type(error_t), allocatable, intent(out) :: error
      type(names_t) :: new, old
      real(rk) :: first
      integer :: i, status

      old = names_in(before)
      new = names_in(scene_text(scene))
      do i = 1, min(size(old%name), size(new%name))
         associate (group => old%group(i)%text, name => old%name(i)%text)
            if (new%group(i)%text /= group .or. new%name(i)%text /= name) exit
            if (group//" "//name == "time first") then
               read (old%value(i)%text, *, iostat=status) first
               if (status == 0) scene%time%first = first
            end if
            if (may_change(group//" "//name, old%value(i)%text, new%value(i)%text)) cycle
            call refuse(name//" of &"//group//" from "//old%value(i)%text//" to "// &
                        new%value(i)%text, error)
            if (group//" "//name == "growth enabled") error%message = "a restart cannot switch "// &
               & "growth on or off: with it the last cells of fractures end at their tips; "// &
               & "enable it from the start, which changes little until a tip reaches its toughness"
            return
         end associate
      end do
      if (i <= max(size(old%name), size(new%name))) then
         call refuse("number of groups", error)
         if (well_count(new) /= well_count(old)) error%message = "a restart cannot change the "// &
            & "number of wells, for which tables have columns: give a well that comes later "// &
            & "from the start, with its start after the end; stages may change"
      end if
      if (allocated(error) .or. .not. scene%has_fluid()) return
      if (.not. scene%time%end < time) return
      call raise_error(error, "", "the checkpoint is of "//brief_text(time, 6)//" s, after the "// &
                       "end at "//brief_text(scene%time%end, 6)//" s")
   end subroutine check_changes

   pure integer function well_count(names)
      type(names_t), intent(in) :: names
      integer :: i

      well_count = count([(names%group(i)%text == "injection" .and. &
                           names%name(i)%text == "group", i=1, size(names%name))])
   end function well_count

   subroutine refuse(what, error)
      character(len=*), intent(in) :: what
      type(error_t), allocatable, intent(out) :: error

     call raise_error(error, "", "a restart cannot change the "//what//": it may change &time, "// &
                       "&output, stages of wells, values of sides in time, and stop_gain")
   end subroutine refuse

   pure logical function may_change(name, old, new)
      character(len=*), intent(in) :: name  !< with its group
      character(len=*), intent(in) :: old, new  !< values; with a ! the reason why there is none

      may_change = old == new .or. any(free == name) .or. any(free == name(:index(name, " "))//"*")
      if (.not. may_change) may_change = any(free_values == name) .and. &
                                         (index(old, "!") == 1 .eqv. index(new, "!") == 1)
   end function may_change

   !> All names in the text of a scene: "name = value", with values on the lines that follow, or
   !! "! name: reason".
   function names_in(text) result(names)
      character(len=*), intent(in) :: text
      type(names_t) :: names
      character(len=:), allocatable :: group, line
      integer :: at, first, last

      allocate (names%group(0), names%name(0), names%value(0))
      group = ""
      first = 1
      do while (first <= len(text))
         last = index(text(first:)//achar(10), achar(10)) + first - 2
         line = trim(adjustl(text(first:last)))
         first = last + 2
         if (len(line) == 0 .or. line == "/") cycle
         if (line(1:1) == "&") then
            group = line(2:)
            call add(names, group, "group", line)
            cycle
         end if
         if (group == "") cycle
         at = index(line, "=")
         if (line(1:1) == "!") at = index(line, ":")
         if (at > 0 .and. is_letter(line(verify(line, "! "):))) then
            call add(names, group, trim(line(verify(line, "! "):at - 1)), &
                     merge("! ", "  ", line(1:1) == "!")//line(at + 1:))
         else
            associate (value => names%value(size(names%value)))
               value%text = value%text//" "//line
            end associate
         end if
      end do
   end function names_in

   pure logical function is_letter(text)
      character(len=*), intent(in) :: text

      is_letter = verify(text(1:1), "abcdefghijklmnopqrstuvwxyz") == 0
   end function is_letter

   subroutine add(names, group, name, value)
      type(names_t), intent(inout) :: names
      character(len=*), intent(in) :: group, name, value

      call add_text(names%group, group)
      call add_text(names%name, name)
      call add_text(names%value, trim(adjustl(value)))
   end subroutine add

end module app_changes
