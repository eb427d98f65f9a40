!> What may differ from the scene of a checkpoint at a restart. Both scenes are compared as texts of
!! scene.nml, which have every name of every group.
module app_changes
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_number, only: brief_text
   use base_texts, only: add_text, text_t
   use report_files, only: remove_file, write_text_file
   use scene_namelist, only: read_scene
   use scene_types, only: injection_t, scene_t
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

   !> An error that names the first difference that is not allowed. The scene takes over wells that
   !! it leaves out, closed, and the first step of the checkpoint, by default a share of the end.
   subroutine check_changes(text, directory, time, scene, stored, switched, error)
      character(len=*), intent(in) :: text  !< of the scene of the checkpoint
      character(len=*), intent(in) :: directory  !< of the run
      real(rk), intent(in) :: time  !< of the checkpoint [s]
      type(scene_t), intent(inout) :: scene
      type(scene_t), intent(out) :: stored  !< the same with the wells and growth of the checkpoint
      character(len=:), allocatable, intent(out) :: switched  !< these differences in words, or ""
      type(error_t), allocatable, intent(out) :: error
      type(scene_t) :: before

      switched = ""
      stored = scene
      if (scene_text(scene) /= text) then
         call read_text(text, directory//"/scene_before.part", before, error)
         if (allocated(error)) return
         if (before%has_fluid() .eqv. scene%has_fluid()) then
            call switch_growth(before, scene, stored, switched)
            if (scene%has_fluid()) call change_wells(before, time, scene, stored, switched)
         end if
      end if
      call compare(text, stored, time, error)
      scene%time%first = stored%time%first
   end subroutine check_changes

   !> Read a scene from its text, by way of a file.
   subroutine read_text(text, path, scene, error)
      character(len=*), intent(in) :: text
      character(len=*), intent(in) :: path
      type(scene_t), intent(out) :: scene
      type(error_t), allocatable, intent(out) :: error
      logical :: was_there

      call write_text_file(path, text, error)
      if (.not. allocated(error)) call read_scene(path, scene, error)
      call remove_file(path, was_there)
   end subroutine read_text

   !> Give the stored scene the growth of the one before, if growth is switched.
   subroutine switch_growth(before, scene, stored, switched)
      type(scene_t), intent(in) :: before
      type(scene_t), intent(inout) :: scene, stored
      character(len=:), allocatable, intent(inout) :: switched

      if (before%growth%enabled .eqv. scene%growth%enabled) return
      stored%growth = before%growth
      if (scene%growth%enabled) then
         switched = ", growth on"
         if (.not. before%material%toughness > 0.0_rk) then
            stored%material%toughness = before%material%toughness
         end if
         if (before%growth%intensities) return
         ! Windows did not exist.
         stored%discretization%window = before%discretization%window
         stored%discretization%window_is_body = before%discretization%window_is_body
         stored%discretization%fine_ratio = before%discretization%fine_ratio
      else
         switched = ", growth off"
         scene%growth = before%growth
         scene%growth%enabled = .false.
      end if
   end subroutine switch_growth

   !> Give the stored scene the wells of the one before, with the stages of the scene. Those that
   !! the scene leaves out are closed, and added ones stand behind them and begin now or later.
   subroutine change_wells(before, time, scene, stored, switched)
      type(scene_t), intent(in) :: before
      real(rk), intent(in) :: time  !< [s]
      type(scene_t), intent(inout) :: scene, stored
      character(len=:), allocatable, intent(inout) :: switched
      type(injection_t), allocatable :: wells(:)
      integer :: k, n, w

      if (.not. before%has_wells() .and. .not. scene%has_wells()) return
      allocate (wells(0))
      if (before%has_wells()) wells = before%injections
      n = size(wells)
      if (.not. allocated(scene%injections)) allocate (scene%injections(0))
      do w = 1, n
         k = findloc(scene%injections%name, wells(w)%name, dim=1)
         if (k > 0) wells(w) = scene%injections(k)
         if (k > 0) cycle
         switched = switched//", well "//trim(wells(w)%name)//" closed"
         call close_well(time, wells(w))
      end do
      do w = 1, size(scene%injections)
         if (any(wells(:n)%name == scene%injections(w)%name)) cycle
         switched = switched//", well "//trim(scene%injections(w)%name)//" added"
         wells = [wells, scene%injections(w)]
         associate (well => wells(size(wells)))
            well%start = max(well%start, time)
            if (allocated(well%time)) well%time = max(well%time, time)
         end associate
      end do
      stored%injections = wells(:n)
      scene%injections = wells
   end subroutine change_wells

   !> End a well, or if it has not begun keep it shut.
   pure subroutine close_well(time, well)
      real(rk), intent(in) :: time  !< [s]
      type(injection_t), intent(inout) :: well
      real(rk), parameter :: never = 1.0e30_rk  ! [s]
      integer :: n

      n = 1
      if (allocated(well%time)) then
         n = max(1, count(well%time < time))
         well%time = well%time(:n)
         if (allocated(well%rate)) well%rate = well%rate(:n)
         if (allocated(well%pressure)) well%pressure = well%pressure(:n)
         if (allocated(well%temperature)) then
            well%temperature = well%temperature(:min(n, size(well%temperature)))
         end if
      end if
      if (well%stage_start(1_ik) < time) then
         well%end = min(well%end, time)
      else
         well%start = never
         if (allocated(well%time)) well%time = [never]
         well%end = huge(1.0_rk)
      end if
   end subroutine close_well

   !> Compare the scene of a checkpoint with the one to go on with, which takes over its first step.
   subroutine compare(before, scene, time, error)
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
            return
         end associate
      end do
      if (i <= max(size(old%name), size(new%name))) then
         call refuse("number of groups", error)
      end if
      if (allocated(error) .or. .not. scene%has_fluid()) return
      if (.not. scene%time%end < time) return
      call raise_error(error, "", "the checkpoint is of "//brief_text(time, 6)//" s, after the "// &
                       "end at "//brief_text(scene%time%end, 6)//" s")
   end subroutine compare

   subroutine refuse(what, error)
      character(len=*), intent(in) :: what
      type(error_t), allocatable, intent(out) :: error

     call raise_error(error, "", "a restart cannot change the "//what//": it may change &time, "// &
                       "&output, wells and their stages, values of sides in time, and of "// &
                       "&growth enabled and stop_gain")
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
