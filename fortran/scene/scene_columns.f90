!> Columns of the tables of a scene (scene_schedule): which parameter of the group each contains and
!! in which unit, by its header or by the names that `columns` of the group gives to headers.
module scene_columns
   use base_texts, only: text_t
   use scene_parameter_table, only: parameters
   use scene_parameters, only: groups, kind_reals, parameter_t
   use scene_sheet, only: parameter_index, sheet_t
   use scene_units, only: find_with_unit, unit_t
   use scene_values, only: shortened, value_t
   use scene_words, only: lower_case
   implicit none(type, external)
   private

   public :: column_name, column_t, find_columns, read_names, renamed_t, split

   !> What a column contains.
   type :: column_t
      integer :: item = 0  !< index into parameters; 0: remarks, which are not read
      type(unit_t) :: unit
   end type column_t

   !> Column with another header than its name.
   type :: renamed_t
      character(len=:), allocatable :: header
      character(len=:), allocatable :: name  !< with the ending of its unit
   end type renamed_t

   !> Headers of columns that are not read.
  character(len=*), parameter :: remarks(*) = [character(len=8) :: "remark", "remarks", "comment", &
                                                                        "comments", "note", "notes"]

contains

   !> Read the names that `columns` gives to headers: `HEADER=name [unit], ...`.
   pure subroutine read_names(sheet, record, renamed, reason)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      type(renamed_t), allocatable, intent(out) :: renamed(:)  !< unallocated: none
      character(len=:), allocatable, intent(out) :: reason  !< why not; unallocated: good
      character(len=:), allocatable :: unit
      type(text_t), allocatable :: parts(:)
      type(value_t) :: given
      integer :: equals, first, k, last

      if (parameter_index(sheet%records(record)%group, "columns") == 0) return
      given = sheet%records(record)%value("columns")
      if (.not. given%is_set) return
      parts = split(given%text, ",")
      allocate (renamed(size(parts)))
      do k = 1, size(parts)
         associate (part => parts(k)%text)
            equals = index(part, "=", back=.true.)
            first = index(part, "[", back=.true.)
            last = len_trim(part)
            if (equals < 2 .or. first < equals + 2 .or. part(last:last) /= "]") then
               reason = "has '"//shortened(part)//"' but must have HEADER=name [unit], with commas"
               return
            end if
            unit = lower_case(trim(adjustl(part(first + 1:last - 1))))
            do while (index(unit, "/") > 0)
               unit(index(unit, "/"):index(unit, "/")) = "_"
            end do
            renamed(k)%header = trim(adjustl(part(:equals - 1)))
            renamed(k)%name = lower_case(trim(adjustl(part(equals + 1:first - 1))))//"_"//unit
         end associate
      end do
   end subroutine read_names

   !> The cells between the separators, without surrounding blanks and double quotes.
   pure function split(row, mark) result(cells)
      character(len=*), intent(in) :: row
      character, intent(in) :: mark
      type(text_t), allocatable :: cells(:)
      integer :: first, k, last

      allocate (cells(count([(row(k:k) == mark, k=1, len(row))]) + 1))
      first = 1
      do k = 1, size(cells)
         last = index(row(first:), mark) + first - 2
         if (k == size(cells)) last = len(row)
         cells(k)%text = trim(adjustl(row(first:last)))
         first = last + 2
         last = len(cells(k)%text)
         if (last < 2) cycle
         if (cells(k)%text(1:1)//cells(k)%text(last:) /= '""') cycle
         cells(k)%text = cells(k)%text(2:last - 1)
      end do
   end function split

   !> Find the parameters of the columns, which must include the time.
   pure subroutine find_columns(headers, group, renamed, columns, reason)
      type(text_t), intent(in) :: headers(:)
      integer, intent(in) :: group
      type(renamed_t), allocatable, intent(in) :: renamed(:)
      type(column_t), allocatable, intent(out) :: columns(:)
      character(len=:), allocatable, intent(out) :: reason  !< why not; unallocated: good
      character(len=:), allocatable :: known, name
      integer :: k, m

      known = ""
      do m = 1, size(parameters)
         if (is_column(parameters(m), group)) known = known//", "//column_name(parameters(m))
      end do
      known = known(3:)//"; or in place of _s _min, _h or _d, of _pa _kpa, _mpa, _bar or _psi, "// &
              "of _m2_s _m3_s, _l_s, _l_min, _m3_h or _bbl_min; `columns` takes other headers"
      allocate (columns(size(headers)))
      do k = 1, size(headers)
         name = named(headers(k)%text, renamed)
         if (name == "") cycle
         call find_with_unit(name, group, columns(k)%item, columns(k)%unit)
         if (columns(k)%item == 0) cycle
         if (.not. is_column(parameters(columns(k)%item), group)) columns(k)%item = 0
      end do
      if (allocated(renamed)) call find_missing(headers, renamed, reason)
      if (allocated(reason)) return
      if (all(columns%item == 0)) then  ! possibly another file, whose contents must not be quoted
         reason = "the file is no table, whose first row has the names of its columns: "//known
         return
      end if
      do k = 1, size(headers)
         if (columns(k)%item == 0) then
            if (named(headers(k)%text, renamed) /= "") then
               reason = "the column '"//shortened(headers(k)%text)//"' must be one of "//known
            end if
         else if (any(columns(:k - 1)%item == columns(k)%item)) then
            reason = "the column '"//column_name(parameters(columns(k)%item))//"' is given twice"
         end if
         if (allocated(reason)) return
      end do
      if (.not. any(parameters(pack(columns%item, columns%item > 0))%name == "time")) then
         reason = "the column time_s is missing"
      end if
   end subroutine find_columns

   !> Name of a column by its header, in lower case; empty for one that is not read.
   pure function named(header, renamed) result(name)
      character(len=*), intent(in) :: header
      type(renamed_t), allocatable, intent(in) :: renamed(:)
      character(len=:), allocatable :: name
      integer :: k

      name = lower_case(header)
      if (.not. allocated(renamed)) then
         if (any(remarks == name)) name = ""
         return
      end if
      name = ""
      do k = 1, size(renamed)
         if (renamed(k)%header == header) name = renamed(k)%name
      end do
   end function named

   !> Refuse a header of `columns` that the table does not have.
   pure subroutine find_missing(headers, renamed, reason)
      type(text_t), intent(in) :: headers(:)
      type(renamed_t), intent(in) :: renamed(:)
      character(len=:), allocatable, intent(inout) :: reason
      integer :: k, m

      do k = 1, size(renamed)
         if (any([(headers(m)%text == renamed(k)%header, m=1, size(headers))])) cycle
         reason = "there is no column '"//shortened(renamed(k)%header)//"', which columns "// &
                  "names; there are"
         do m = 1, size(headers)
            reason = reason//trim(merge(",", " ", m > 1))//" '"//shortened(headers(m)%text)//"'"
         end do
         return
      end do
   end subroutine find_missing

   !> A parameter is a list of the group, and so a possible column of a table.
   pure logical function is_column(parameter, group)
      type(parameter_t), intent(in) :: parameter
      integer, intent(in) :: group

      is_column = parameter%group == groups(group)%name .and. parameter%kind == kind_reals &
                  .and. .not. parameter%per_entry
   end function is_column

   !> Column name of a parameter with its unit: `rate` [m2/s] is `rate_m2_s`.
   pure function column_name(parameter) result(name)
      type(parameter_t), intent(in) :: parameter
      character(len=:), allocatable :: name
      integer :: k

      name = trim(parameter%name)//"_"//lower_case(trim(parameter%unit))
      do k = 1, len(name)
         if (scan(name(k:k), " /") > 0) name(k:k) = "_"
      end do
   end function column_name

end module scene_columns
