!> The contents of a scene file: its groups in order, each with its values and lines.
module scene_sheet
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, lk
   use base_number, only: integer_text
   use scene_expression, only: constant_t
   use scene_parameter_table, only: parameters
   use scene_parameters, only: choice_name, choice_value, groups
   use scene_values, only: value_t
   implicit none(type, external)
   private

   public :: record_t, sheet_t, add_record, empty_record, group_index, line_text, parameter_index
   public :: path_from, path_of, place, refuse

   !> One group.
   type :: record_t
      integer :: group = 0  !< index into groups
      integer(ik) :: line = 0  !< line of `&group`; 0: not in the file, all values are defaults
      character(len=:), allocatable :: path  !< path of its file, which may be an included one
      type(value_t), allocatable :: values(:)  !< values, with the indices of `parameters`
      logical :: reading = .false.  !< values go to a scene; otherwise they come from it
   contains
      procedure :: value => value_of
      procedure :: is_set
      procedure :: is_given
      procedure :: suits
   end type record_t

   !> A whole file.
   type :: sheet_t
      character(len=:), allocatable :: path
      type(record_t), allocatable :: records(:)
      integer :: length = 0  !< records in use
      type(constant_t), allocatable :: constants(:)  !< named values of &define, in their order
      integer :: n_included = 0  !< included files, each as often as it is included
      integer(lk) :: n_bytes = 0_lk  !< size of all its files, with tables [byte]
   contains
      procedure :: find
      procedure :: has
      procedure :: has_one
   end type sheet_t

contains

   !> Index of a group by its name in lower case; 0 if there is none.
   pure integer function group_index(name) result(group)
      character(len=*), intent(in) :: name

      do group = size(groups), 1, -1
         if (groups(group)%name == name) return
      end do
      group = 0
   end function group_index

   !> Index of a parameter by its group and its name in lower case; 0 if there is none.
   pure integer function parameter_index(group, name) result(item)
      integer, intent(in) :: group
      character(len=*), intent(in) :: name

      do item = size(parameters), 1, -1
         if (parameters(item)%group /= groups(group)%name) cycle
         if (parameters(item)%name == name) return
      end do
      item = 0
   end function parameter_index

   !> A group in which no value is set.
   pure function empty_record(group, line) result(record)
      integer, intent(in) :: group
      integer(ik), intent(in) :: line
      type(record_t) :: record

      integer :: first, last

      record%group = group
      record%line = line
      first = findloc(parameters%group == groups(group)%name, .true., dim=1)
      last = findloc(parameters%group == groups(group)%name, .true., dim=1, back=.true.)
      allocate (record%values(first:last))
   end function empty_record

   !> Append a group.
   pure subroutine add_record(sheet, record)
      type(sheet_t), intent(inout) :: sheet
      type(record_t), intent(in) :: record
      type(record_t), allocatable :: larger(:)
      integer :: i

      if (.not. allocated(sheet%records)) allocate (sheet%records(16))
      if (sheet%length == size(sheet%records)) then
         allocate (larger(2*sheet%length))
         do i = 1, sheet%length
            larger(i)%group = sheet%records(i)%group
            larger(i)%line = sheet%records(i)%line
            call move_alloc(sheet%records(i)%path, larger(i)%path)
            call move_alloc(sheet%records(i)%values, larger(i)%values)
         end do
         call move_alloc(larger, sheet%records)
      end if
      sheet%length = sheet%length + 1
      sheet%records(sheet%length) = record
   end subroutine add_record

   !> The value of a parameter of this group.
   pure function value_of(self, name) result(value)
      class(record_t), intent(in) :: self
      character(len=*), intent(in) :: name
      type(value_t) :: value

      value = self%values(parameter_index(self%group, name))
   end function value_of

   !> A parameter has a value, given or by default.
   pure logical function is_set(self, name)
      class(record_t), intent(in) :: self
      character(len=*), intent(in) :: name

      is_set = self%values(parameter_index(self%group, name))%is_set
   end function is_set

   !> The file contains a value for a parameter.
   pure logical function is_given(self, name)
      class(record_t), intent(in) :: self
      character(len=*), intent(in) :: name

      is_given = self%values(parameter_index(self%group, name))%line > 0
   end function is_given

   !> A parameter belongs to the choice made in this group, or to every choice.
   pure logical function suits(self, item)
      class(record_t), intent(in) :: self
      integer, intent(in) :: item  !< index into parameters
      type(value_t) :: choice

      suits = parameters(item)%of == ""
      if (suits) return
      choice = self%value(choice_name(parameters(item)))
      suits = choice%text == choice_value(parameters(item))
   end function suits

   !> Index of the n-th group of a name in the records; 0 if there are fewer.
   pure integer function find(self, name, n) result(record)
      class(sheet_t), intent(in) :: self
      character(len=*), intent(in) :: name
      integer, intent(in), optional :: n  !< default 1
      integer :: group, seen, wanted

      wanted = 1
      if (present(n)) wanted = n
      group = group_index(name)
      seen = 0
      do record = 1, self%length
         if (self%records(record)%group == group) seen = seen + 1
         if (seen == wanted) return
      end do
      record = 0
   end function find

   !> The sheet has a group of this name.
   pure logical function has(self, name)
      class(sheet_t), intent(in) :: self
      character(len=*), intent(in) :: name

      has = self%find(name) > 0
   end function has

   !> There is a group of one of these names, by `|`.
   pure logical function has_one(self, names)
      class(sheet_t), intent(in) :: self
      character(len=*), intent(in) :: names
      integer :: bar

      bar = index(names, "|")
      has_one = self%has(trim(names(bar + 1:)))
      if (bar > 0 .and. .not. has_one) has_one = self%has(names(:bar - 1))
   end function has_one

   !> Path of the file that contains a group.
   pure function path_of(sheet, record) result(path)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record  !< index into sheet%records
      character(len=:), allocatable :: path

      path = sheet%path
      if (allocated(sheet%records(record)%path)) path = sheet%records(record)%path
   end function path_of

   !> A path relative to the folder of a scene file, or an absolute one, as it can be opened.
   pure function path_from(scene_path, path) result(whole)
      character(len=*), intent(in) :: scene_path, path
      character(len=:), allocatable :: whole

      whole = path
      if (index(path, "/") == 1) return
      whole = scene_path(:index(scene_path, "/", back=.true.))//path
   end function path_from

   !> "line 12", with the file if it is not that of another group.
   pure function line_text(sheet, record, line, other) result(text)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record  !< index into sheet%records
      integer(ik), intent(in) :: line
      integer, intent(in) :: other  !< index of the group with which the message begins
      character(len=:), allocatable :: text

      text = "line "//integer_text(line)
      if (path_of(sheet, record) /= path_of(sheet, other)) then
         text = text//" of "//path_of(sheet, record)
      end if
   end function line_text

   !> Raise an error about a parameter of a group: file, line, group, name, reason, and where to
   !! read about it.
   pure subroutine refuse(error, sheet, record, name, reason)
      type(error_t), allocatable, intent(out) :: error
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record  !< index into sheet%records
      character(len=*), intent(in) :: name  !< empty: about the group
      character(len=*), intent(in) :: reason  !< the fault and its remedy
      character(len=:), allocatable :: message
      integer(ik) :: line

      associate (group => sheet%records(record))
         line = group%line
         if (name /= "") then
            associate (item => parameter_index(group%group, name))
               if (group%values(item)%line > 0) line = group%values(item)%line
            end associate
         end if
         message = path_of(sheet, record)
         if (line > 0) message = message//":"//integer_text(line)
         message = message//": &"//trim(groups(group%group)%name)//": "
         if (name /= "") message = message//name//" "
         call raise_error(error, "", message//reason//" (see docs/input.md)")
      end associate
   end subroutine refuse

   !> File and line at the beginning of a message about the syntax.
   pure function place(sheet, line) result(words)
      type(sheet_t), intent(in) :: sheet
      integer(ik), intent(in) :: line
      character(len=:), allocatable :: words

      words = sheet%path//":"//integer_text(line)//": "
   end function place

end module scene_sheet
