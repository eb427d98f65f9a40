!> Tables in CSV files that replace lists of a scene file: the stages of a well, the time-dependent
!! values of a side; and reading of whole files.
!!
!! The first row names the columns: a name of the group and its unit, as `time_s`, `rate_m2_s`,
!! `pressure_pa`, or another unit (scene_units). `columns` gives these names to other headers.
!! Columns of remarks are not read. An empty cell is no limit of pressure.
!! Columns are separated by commas, semicolons or tabs, as in the first row; unless they are
!! separated by commas, numbers may have a decimal comma, as spreadsheets write them in many
!! countries. Rows that begin with # are comments. The values of a table become values of the group,
!! so that all later steps, including scene.nml, use lists alone.
!!
!! A scene may have any author, and may name any file of this machine. So no contents of a file are
!! quoted in a message unless the file has the form of a scene or of its table.
module scene_schedule
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, lk, rk
   use base_number, only: integer_text
   use base_texts, only: text_t
   use scene_columns, only: column_name, column_t, find_columns, read_names, renamed_t, split
   use scene_expression, only: token_list_t, tokenize
   use scene_parameter_table, only: parameters
   use scene_parameters, only: parameter_t
   use scene_sheet, only: parameter_index, path_from, path_of, refuse, sheet_t
   use scene_types, only: no_limit
   use scene_values, only: most_values, read_value, value_t
   implicit none(type, external)
   private

   public :: load_file, load_schedules

   !> Mark at the beginning of a text in UTF-8 from some programs.
   character(len=*), parameter :: byte_order_mark = char(239)//char(187)//char(191)

   !> Name that the first time of a table replaces.
   character(len=*), parameter :: start = "start"

   !> What the absence of a parameter means whose cells may be empty.
   character(len=*), parameter :: unlimited = "no limit"

   integer(lk), parameter :: largest_file = 4000000_lk  !< size of a scene file or table [byte]
   integer(lk), parameter :: largest_scene = 10000000_lk  !< size of all files of a scene [byte]

contains

   !> Replace the names `schedule` of a sheet by the lists in their tables.
   subroutine load_schedules(sheet, error)
      type(sheet_t), intent(inout) :: sheet
      type(error_t), allocatable, intent(out) :: error
      type(value_t) :: file
      integer :: i

      do i = 1, sheet%length
         if (parameter_index(sheet%records(i)%group, "schedule") == 0) cycle
         file = sheet%records(i)%value("schedule")
         if (.not. file%is_set) then
            call refuse_alone(sheet, i, error)
            if (allocated(error)) return
            cycle
         end if
         call load_table(sheet, i, path_from(path_of(sheet, i), file%text), file%line, error)
         if (allocated(error)) return
         associate (record => sheet%records(i))
            record%values(parameter_index(record%group, "schedule"))%is_set = .false.
            if (parameter_index(record%group, "columns") == 0) cycle
            record%values(parameter_index(record%group, "columns"))%is_set = .false.
         end associate
      end do
   end subroutine load_schedules

   !> Refuse names of columns without a table.
   pure subroutine refuse_alone(sheet, record, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      type(error_t), allocatable, intent(out) :: error

      if (parameter_index(sheet%records(record)%group, "columns") == 0) return
      if (.not. sheet%records(record)%is_given("columns")) return
     call refuse(error, sheet, record, "columns", "is given without schedule, whose columns it "// &
                  "names")
   end subroutine refuse_alone

   !> Refuse names in the scene file that are in the table too, and the start.
   pure subroutine refuse_both(sheet, record, names, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      character(len=*), intent(in) :: names(:)
      type(error_t), allocatable, intent(out) :: error
      integer :: k

      do k = 1, size(names)
         if (parameter_index(sheet%records(record)%group, trim(names(k))) == 0) cycle
         if (.not. sheet%records(record)%is_given(trim(names(k)))) cycle
         call refuse(error, sheet, record, trim(names(k)), "is given with schedule, whose "// &
                     "table contains it, but must be given once")
         return
      end do
   end subroutine refuse_both

   !> Read a table into a group.
   subroutine load_table(sheet, record, path, line, error)
      type(sheet_t), intent(inout) :: sheet
      integer, intent(in) :: record
      character(len=*), intent(in) :: path
      integer(ik), intent(in) :: line  !< line of the name `schedule`
      type(error_t), allocatable, intent(out) :: error
      type(text_t), allocatable :: cells(:), rows(:)
      type(column_t), allocatable :: columns(:)
      type(renamed_t), allocatable :: renamed(:)
      real(rk), allocatable :: numbers(:, :)
      character(len=:), allocatable :: reason
      character :: mark
      integer :: n, row

      call read_names(sheet, record, renamed, reason)
      if (allocated(reason)) then
         call refuse(error, sheet, record, "columns", reason)
         return
      end if
      call read_rows(sheet, record, path, rows, error)
      if (allocated(error)) return
      n = 0
      do row = 1, size(rows)
         if (is_comment(rows(row)%text)) cycle
         if (.not. allocated(columns)) mark = mark_of(rows(row)%text)
         cells = split(rows(row)%text, mark)
         if (.not. allocated(columns)) then
            call find_columns(cells, sheet%records(record)%group, renamed, columns, reason)
            allocate (numbers(min(size(rows) - row, most_values), size(columns)))
            if (.not. allocated(reason)) then
               call refuse_both(sheet, record, [character(len=20) :: parameters( &
                                               pack(columns%item, columns%item > 0))%name, start], &
                                error)
               if (allocated(error)) return
            end if
         else if (n == most_values) then
            reason = "the table has more than the "//integer_text(int(most_values, ik))// &
                     " rows that it may have"
         else
            n = n + 1
            call read_row(cells, mark, columns, numbers(n, :), reason)
            if (allocated(renamed) .and. .not. allocated(reason)) then
               if (repeats(columns, numbers(:n, :))) n = n - 1
            end if
         end if
         if (.not. allocated(reason)) cycle
         call raise_error(error, "", path//":"//integer_text(int(row, ik))//": "//reason// &
                          " (see docs/input.md)")
         return
      end do
      if (n == 0) then
         call refuse(error, sheet, record, "schedule", "is '"//path//"', a table without rows, "// &
                     "but must have a row per stage below the names of its columns")
         return
      end if
      call take_columns(columns, numbers(:n, :), line, sheet, record)
   end subroutine load_table

   !> Make the columns values of the group.
   pure subroutine take_columns(columns, numbers, line, sheet, record)
      type(column_t), intent(in) :: columns(:)
      real(rk), intent(in) :: numbers(:, :)  !< (rows, columns)
      integer(ik), intent(in) :: line
      type(sheet_t), intent(inout) :: sheet
      integer, intent(in) :: record
      integer :: k

      do k = 1, size(columns)
         if (columns(k)%item == 0) cycle
         associate (list => sheet%records(record)%values(columns(k)%item))
            list%is_set = .true.
            list%line = line
            list%reals = numbers(:, k)
            list%per_thickness = columns(k)%unit%per_thickness
         end associate
      end do
   end subroutine take_columns

   !> Whether the last row is that before, but for its time.
   pure logical function repeats(columns, numbers)
      type(column_t), intent(in) :: columns(:)
      real(rk), intent(in) :: numbers(:, :)  !< (rows, columns)
      integer :: k, n

      n = size(numbers, 1)
      repeats = n > 1
      if (n < 2) return
      do k = 1, size(columns)
         if (columns(k)%item == 0) cycle
         if (parameters(columns(k)%item)%name == "time") cycle
         if (abs(numbers(n, k) - numbers(n - 1, k)) > 0.0_rk) repeats = .false.
      end do
   end function repeats

   !> The numbers of a row, in the units of the parameters.
   pure subroutine read_row(cells, mark, columns, numbers, reason)
      type(text_t), intent(in) :: cells(:)
      character, intent(in) :: mark  !< separator of the columns
      type(column_t), intent(in) :: columns(:)
      real(rk), intent(out) :: numbers(:)  !< (columns) [unit of the parameter]
      character(len=:), allocatable, intent(out) :: reason  !< why not; unallocated: good
      character(len=:), allocatable :: cell
      type(value_t) :: value
      integer :: k

      numbers = 0.0_rk
      if (size(cells) /= size(columns)) then
         reason = "the row has "//integer_text(size(cells, kind=ik))//" values but must have "// &
                  integer_text(size(columns, kind=ik))//", one per column"
         if (mark == "," .and. size(cells) > size(columns)) then
            reason = reason//"; with decimal commas, columns must be separated by semicolons "// &
                     "or tabs"
         end if
         return
      end if
      do k = 1, size(columns)
         if (columns(k)%item == 0) cycle
         associate (parameter => parameters(columns(k)%item))
            cell = cells(k)%text
            if (cell == "" .and. parameter%absent == unlimited) then
               numbers(k) = no_limit
               cycle
            end if
            if (mark /= ",") cell = with_point(cell)
            call read_cell(cell, parameter, value, reason)
            if (allocated(reason)) return
            numbers(k) = columns(k)%unit%factor*value%reals(1)
         end associate
      end do
   end subroutine read_row

   !> The rows of a file, without line ends.
   subroutine read_rows(sheet, record, path, rows, error)
      type(sheet_t), intent(inout) :: sheet
      integer, intent(in) :: record
      character(len=*), intent(in) :: path
      type(text_t), allocatable, intent(out) :: rows(:)
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: fault, source
      integer :: first, last, row

      call load_file(path, sheet%n_bytes, source, fault)
      if (allocated(fault)) then
         call refuse(error, sheet, record, "schedule", "is '"//path//"', which is "//fault)
         return
      end if
      if (index(source, byte_order_mark) == 1) source = source(len(byte_order_mark) + 1:)
      allocate (rows(count([(source(first:first) == new_line("a"), first=1, len(source))]) + 1))
      first = 1
      do row = 1, size(rows)
         last = index(source(first:), new_line("a")) + first - 2
         if (last < first - 1) last = len(source)
         rows(row)%text = source(first:last)
         first = last + 2
         last = len(rows(row)%text)
         if (last == 0) cycle
         if (rows(row)%text(last:) == achar(13)) rows(row)%text = rows(row)%text(:last - 1)
      end do
   end subroutine read_rows

   !> Empty, or begins with #.
   pure logical function is_comment(row)
      character(len=*), intent(in) :: row

      is_comment = row == ""
      if (.not. is_comment) is_comment = index(adjustl(row), "#") == 1
   end function is_comment

   !> Separator of the columns: a tab or a semicolon if the row has one, otherwise a comma.
   pure character function mark_of(row) result(mark)
      character(len=*), intent(in) :: row

      mark = ","
      if (index(row, ";") > 0) mark = ";"
      if (index(row, achar(9)) > 0) mark = achar(9)
   end function mark_of

   !> A number with a point instead of its decimal comma, if it has exactly one comma.
   pure function with_point(cell) result(text)
      character(len=*), intent(in) :: cell
      character(len=len(cell)) :: text
      integer :: place

      text = cell
      place = index(cell, ",")
      if (place == 0 .or. place /= index(cell, ",", back=.true.)) return
      if (index(cell, ".") == 0) text(place:place) = "."
   end function with_point

   !> Read one number.
   pure subroutine read_cell(cell, parameter, value, reason)
      character(len=*), intent(in) :: cell
      type(parameter_t), intent(in) :: parameter
      type(value_t), intent(out) :: value
      character(len=:), allocatable, intent(out) :: reason  !< why not; unallocated: good
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

   !> Read a whole file. A pipe or a device, which has no size, is not opened: it may never end.
   subroutine load_file(path, n_read, source, fault)
      character(len=*), intent(in) :: path
      integer(lk), intent(inout) :: n_read  !< size of all files of the scene so far [byte]
      character(len=:), allocatable, intent(out) :: source  !< contents
      character(len=:), allocatable, intent(out) :: fault  !< why not; unallocated: good
      character(len=256) :: reason
      integer(lk) :: n_bytes
      integer :: unit, status
      logical :: is_folder

      inquire (file=path, size=n_bytes)
      inquire (file=path//"/.", exist=is_folder)
      if (n_bytes < 0 .or. is_folder) then
         fault = "no file that can be read"
      else if (n_bytes == 0) then
         fault = "empty, a pipe or a device, but must be a file with text"
      else if (n_bytes > largest_file) then
         fault = "larger than the 4 MB that a file of a scene may have"
      else if (n_read + n_bytes > largest_scene) then
         fault = "one more file than the 10 MB that all files of a scene may have together"
      end if
      if (allocated(fault)) return
      open (newunit=unit, file=path, action="read", status="old", access="stream", &
            form="unformatted", iostat=status)
      if (status /= 0) then
         fault = "no file that can be read"
         return
      end if
      allocate (character(len=n_bytes) :: source)
      read (unit, iostat=status, iomsg=reason) source
      n_read = n_read + n_bytes
      if (status /= 0) fault = "a file that cannot be read: "//trim(reason)
      close (unit)
   end subroutine load_file

end module scene_schedule
