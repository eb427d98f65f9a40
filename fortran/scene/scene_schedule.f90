!> Tables in CSV files that stand for lists of a scene file: the stages of a well, the course of a
!! side.
!!
!! The first row names the columns: a name of the group and its unit, as `time_s`, `rate_m2_s`,
!! `pressure_pa`. Rows that begin with # are comments. What a table says becomes values of the
!! group, so that all that follows, scene.nml as well, knows of lists alone.
module scene_schedule
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, lk, rk
   use base_number, only: integer_text
   use base_texts, only: text_t
   use scene_parameters, only: groups, kind_reals, parameter_t, parameters
   use scene_sheet, only: parameter_index, refuse, sheet_t
   use scene_tokens, only: token_list_t, tokenize
   use scene_values, only: read_value, shortened, value_t
   use scene_words, only: lower_case
   implicit none(type, external)
   private

   public :: load_schedules

   !> What the first time of a table says besides.
   character(len=*), parameter :: start = "start"

   integer(lk), parameter :: largest_file = 4000000_lk  !< [byte]; more is no table

contains

   !> Take over all tables that a sheet names.
   subroutine load_schedules(sheet, error)
      type(sheet_t), intent(inout) :: sheet
      type(error_t), allocatable, intent(out) :: error
      type(value_t) :: file
      integer :: i

      do i = 1, sheet%length
         if (parameter_index(sheet%records(i)%group, "schedule") == 0) cycle
         file = sheet%records(i)%value("schedule")
         if (.not. file%is_set) cycle
         call load_table(sheet, i, path_beside(sheet%path, file%text), file%line, error)
         if (allocated(error)) return
         associate (record => sheet%records(i))
            record%values(parameter_index(record%group, "schedule"))%is_set = .false.
         end associate
      end do
   end subroutine load_schedules

   !> What the table says, and when it begins, must not stand in the scene file as well.
   pure subroutine refuse_both(sheet, record, names, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      character(len=*), intent(in) :: names(:)
      type(error_t), allocatable, intent(out) :: error
      integer :: k

      do k = 1, size(names)
         if (parameter_index(sheet%records(record)%group, trim(names(k))) == 0) cycle
         if (.not. sheet%records(record)%is_given(trim(names(k)))) cycle
         call refuse(error, sheet, record, trim(names(k)), "is given beside schedule, whose "// &
                     "table says it, but must be given once")
         return
      end do
   end subroutine refuse_both

   !> A path as seen from the folder of a scene file.
   pure function path_beside(scene_path, path) result(whole)
      character(len=*), intent(in) :: scene_path, path
      character(len=:), allocatable :: whole

      whole = path
      if (index(path, "/") == 1) return
      whole = scene_path(:index(scene_path, "/", back=.true.))//path
   end function path_beside

   !> Read a table into a group.
   subroutine load_table(sheet, record, path, line, error)
      type(sheet_t), intent(inout) :: sheet
      integer, intent(in) :: record
      character(len=*), intent(in) :: path
      integer(ik), intent(in) :: line  !< where the scene file names the table
      type(error_t), allocatable, intent(out) :: error
      type(text_t), allocatable :: cells(:), rows(:)
      integer, allocatable :: item(:)
      type(value_t) :: value
      character(len=:), allocatable :: reason
      integer :: k, n, row

      call read_rows(sheet, record, path, rows, error)
      if (allocated(error)) return
      n = 0
      do row = 1, size(rows)
         if (is_comment(rows(row)%text)) cycle
         cells = split(rows(row)%text)
         if (.not. allocated(item)) then
            call find_columns(cells, sheet%records(record)%group, item, reason)
            if (.not. allocated(reason)) then
               call refuse_both(sheet, record, [character(len=20) :: &
                                                parameters(item)%name, start], error)
               if (allocated(error)) return
            end if
         else if (size(cells) /= size(item)) then
           reason = "the row has "//integer_text(size(cells, kind=ik))//" values but must have "// &
                     integer_text(size(item, kind=ik))//", one per column"
         else
            n = n + 1
            do k = 1, size(item)
               call read_cell(cells(k)%text, parameters(item(k)), value, reason)
               if (allocated(reason)) exit
               call append(sheet%records(record)%values(item(k)), value%reals(1), n, line)
            end do
         end if
         if (.not. allocated(reason)) cycle
         call raise_error(error, "", path//":"//integer_text(int(row, ik))//": "//reason// &
                          " (see docs/input.md)")
         return
      end do
      if (n == 0) call refuse(error, sheet, record, "schedule", "is '"//path//"', a table "// &
                              "without rows, but must have a row per stage below the names of "// &
                              "its columns")
   end subroutine load_table

   !> The rows of a file, without line ends.
   subroutine read_rows(sheet, record, path, rows, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      character(len=*), intent(in) :: path
      type(text_t), allocatable, intent(out) :: rows(:)
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: source
      integer(lk) :: n_bytes
      integer :: first, last, unit, status
      logical :: exists

      inquire (file=path, exist=exists)
      status = 1
      if (exists) open (newunit=unit, file=path, action="read", status="old", access="stream", &
         & form="unformatted", iostat=status)
      if (status /= 0) then
         call refuse(error, sheet, record, "schedule", "is '"//path//"', which is no file that "// &
                     "can be read")
         return
      end if
      inquire (unit=unit, size=n_bytes)
      n_bytes = min(n_bytes, largest_file)
      allocate (character(len=n_bytes) :: source)
      read (unit, iostat=status) source
      close (unit)
      allocate (rows(count([(source(first:first) == new_line("a"), first=1, len(source))]) + 1))
      first = 1
      do status = 1, size(rows)
         last = index(source(first:), new_line("a")) + first - 2
         if (last < first - 1) last = len(source)
         rows(status)%text = source(first:last)
         first = last + 2
         last = len(rows(status)%text)
         if (last == 0) cycle
         if (rows(status)%text(last:) == achar(13)) rows(status)%text = rows(status)%text(:last - 1)
      end do
   end subroutine read_rows

   !> Empty, or begins with #.
   pure logical function is_comment(row)
      character(len=*), intent(in) :: row

      is_comment = row == ""
      if (.not. is_comment) is_comment = index(adjustl(row), "#") == 1
   end function is_comment

   !> What stands between commas, without blanks around it.
   pure function split(row) result(cells)
      character(len=*), intent(in) :: row
      type(text_t), allocatable :: cells(:)
      integer :: first, k, last

      allocate (cells(count([(row(k:k) == ",", k=1, len(row))]) + 1))
      first = 1
      do k = 1, size(cells)
         last = index(row(first:), ",") + first - 2
         if (k == size(cells)) last = len(row)
         cells(k)%text = trim(adjustl(row(first:last)))
         first = last + 2
      end do
   end function split

   !> The parameters that columns are named after; times are among them.
   pure subroutine find_columns(names, group, item, reason)
      type(text_t), intent(in) :: names(:)
      integer, intent(in) :: group
      integer, allocatable, intent(out) :: item(:)
      character(len=:), allocatable, intent(out) :: reason  !< unallocated: they are good
      character(len=:), allocatable :: known
      integer :: k, m

      known = ""
      do m = 1, size(parameters)
         if (is_column(parameters(m), group)) known = known//", "//column_name(parameters(m))
      end do
      allocate (item(size(names)), source=0)
      do k = 1, size(names)
         do m = 1, size(parameters)
            if (.not. is_column(parameters(m), group)) cycle
            if (column_name(parameters(m)) == lower_case(names(k)%text)) item(k) = m
         end do
         if (item(k) == 0) then
            reason = "the column '"//shortened(names(k)%text)//"' must be one of "//known(3:)
         else if (any(item(:k - 1) == item(k))) then
            reason = "the column '"//names(k)%text//"' is given twice"
         end if
         if (allocated(reason)) return
      end do
      if (.not. any(parameters(item)%name == "time")) reason = "the column time_s is missing"
   end subroutine find_columns

   !> A list of this group, which a table may hold.
   pure logical function is_column(parameter, group)
      type(parameter_t), intent(in) :: parameter
      integer, intent(in) :: group

      is_column = parameter%group == groups(group)%name .and. parameter%kind == kind_reals
   end function is_column

   !> Name and unit: `rate` [m2/s] is `rate_m2_s`.
   pure function column_name(parameter) result(name)
      type(parameter_t), intent(in) :: parameter
      character(len=:), allocatable :: name
      integer :: k

      name = trim(parameter%name)//"_"//lower_case(trim(parameter%unit))
      do k = 1, len(name)
         if (scan(name(k:k), " /") > 0) name(k:k) = "_"
      end do
   end function column_name

   pure subroutine read_cell(cell, parameter, value, reason)
      character(len=*), intent(in) :: cell
      type(parameter_t), intent(in) :: parameter
      type(value_t), intent(out) :: value
      character(len=:), allocatable, intent(out) :: reason  !< unallocated: it is good
      type(token_list_t) :: tokens
      character(len=:), allocatable :: fault
      integer(ik) :: fault_line

      call tokenize(cell, tokens, fault, fault_line)
      if (allocated(fault)) then
         reason = fault
      else if (tokens%length < 2) then
         reason = "has no value"
      else
         call read_value(parameter, cell, tokens%items(:tokens%length - 1), value, reason)
         if (.not. allocated(reason)) then
            if (size(value%reals) > 1) reason = "has several values"
         end if
      end if
      if (allocated(reason)) reason = column_name(parameter)//" "//reason
   end subroutine read_cell

   !> Make a number the n-th of a list.
   pure subroutine append(value, number, n, line)
      type(value_t), intent(inout) :: value
      real(rk), intent(in) :: number  !< [unit of the name]
      integer, intent(in) :: n
      integer(ik), intent(in) :: line

      if (n == 1) then
         value%is_set = .true.
         value%line = line
         value%reals = [number]
      else
         value%reals = [value%reals, number]
      end if
   end subroutine append

end module scene_schedule
