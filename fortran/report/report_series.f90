!> Tables as CSV (RFC 4180): rows are kept in memory, and the file is written completely.
module report_series
   use base_archive, only: archive_t
   use base_buffer, only: newline, text_buffer_t
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, lk, rk
   use base_number, only: format_integer, format_real, integer_text, number_width
   use base_texts, only: text_t
   use report_files, only: write_text_file
   implicit none(type, external)
   private

   public :: series_t

   !> One table. A row is `put` value by value with the names of its columns, in their order, then
   !! ended. Values of columns that are not written are put too, and ignored.
   type :: series_t
      integer(lk) :: n_rows = 0_lk
      character(len=:), allocatable :: path
      type(text_buffer_t), private :: buffer
      type(text_t), allocatable, private :: names(:)  !< names of the columns
      logical, allocatable, private :: is_written(:)  !< (columns)
      !> (columns) written of rows before a restart that left it out, and empty in other rows
      logical, allocatable, private :: is_past(:)
      integer, private :: column = 0  !< number of values in the row so far
      character(len=:), allocatable, private :: fault  !< message about the first wrong row
      integer(lk), private :: written = -1_lk  !< length of the file
   contains
      procedure :: open => open_series
      procedure :: take_over
      procedure, private :: put_real
      procedure, private :: put_integer
      procedure, private :: put_text
      generic :: put => put_real, put_integer, put_text
      procedure :: end_row
      procedure :: is_open
      procedure :: flush => flush_series
      procedure :: visit
      procedure :: visit_text
   end type series_t

contains

   !> Begin a table; nothing is written yet.
   subroutine open_series(self, path, names, is_written)
      class(series_t), intent(out) :: self
      character(len=*), intent(in) :: path
      character(len=*), intent(in) :: names(:)  !< of the columns with their units, in order
      logical, intent(in) :: is_written(:)  !< .false.: the column is omitted
      integer :: i

      self%path = path
      allocate (self%names(size(names)))
      self%is_written = is_written
      allocate (self%is_past(size(names)), source=.false.)
      do i = 1, size(names)
         self%names(i)%text = trim(names(i))
         call self%put(trim(names(i)), trim(names(i)))
      end do
      call self%end_row()
      self%n_rows = 0_lk
   end subroutine open_series

   !> The table has been opened.
   pure logical function is_open(self)
      class(series_t), intent(in) :: self

      is_open = allocated(self%path)
   end function is_open

   !> Put a value, or an empty one where a quantity does not apply (absent).
   subroutine put_real(self, name, value)
      class(series_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      real(rk), intent(in), optional :: value  !< [unit of the name]
      character(len=number_width) :: item
      integer :: length

      length = 0
      if (present(value)) call format_real(value, item, length)
      call put_item(self, name, item(:length))
   end subroutine put_real

   subroutine put_integer(self, name, value)
      class(series_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer(ik), intent(in) :: value
      character(len=number_width) :: item
      integer :: length

      call format_integer(int(value, lk), item, length)
      call put_item(self, name, item(:length))
   end subroutine put_integer

   subroutine put_text(self, name, value)
      class(series_t), intent(inout) :: self
      character(len=*), intent(in) :: name
      character(len=*), intent(in) :: value
      character(len=:), allocatable :: item
      integer :: i

      item = value
      if (scan(value, ',"'//achar(10)//achar(13)) > 0) then
         item = '"'
         do i = 1, len(value)
            if (value(i:i) == '"') item = item//'"'
            item = item//value(i:i)
         end do
         item = item//'"'
      end if
      call put_item(self, name, item)
   end subroutine put_text

   !> End a row.
   subroutine end_row(self)
      class(series_t), intent(inout) :: self

      if (.not. self%is_open()) return
      if (self%column < size(self%names)) call keep_fault(self, "ends")
      self%n_rows = self%n_rows + 1_lk
      self%column = 0
      call self%buffer%replace_last(newline)  ! the comma behind the last value
   end subroutine end_row

   !> Store or load the rows; the table is open. It goes on with the columns that it has.
   subroutine visit(self, archive)
      class(series_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive
      character(len=:), allocatable :: head
      integer :: i

      if (.not. self%is_open()) return
      call archive%item("n_rows", self%n_rows)
      call self%buffer%visit(archive)
      if (.not. archive%is_loading .or. allocated(archive%fault)) return
      self%written = -1_lk
      head = self%buffer%text()
      head = ","//head(:max(1, index(head, newline)) - 1)//","
      call keep_columns(self, [(index(head, ","//self%names(i)%text//",") > 0, &
                                i=1, size(self%names))])
   end subroutine visit

   subroutine visit_text(self, archive)
      class(series_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive

      if (self%is_open()) call self%buffer%visit_text(archive)
   end subroutine visit_text

   !> Write these columns; in those that do not apply any more, values are omitted.
   pure subroutine keep_columns(self, is_written)
      class(series_t), intent(inout) :: self
      logical, intent(in) :: is_written(:)  !< (columns)

      self%is_past = is_written .and. .not. self%is_written
      self%is_written = is_written
   end subroutine keep_columns

   !> Begin with the rows of another table. Its columns are kept, and in those that it lacks its
   !! rows have no values. Texts with commas are in tables that always have the same columns.
   subroutine take_over(self, other)
      class(series_t), intent(inout) :: self
      type(series_t), intent(in) :: other
      type(text_t), allocatable :: names(:)
      character(len=:), allocatable :: text
      logical, allocatable :: was_written(:)
      integer :: first, last, column

      if (.not. (self%is_open() .and. other%is_open())) return
      names = pack(other%names, other%is_written)
      was_written = [(any([(names(first)%text == self%names(column)%text, &
                            first=1, size(names))]), column=1, size(self%names))]
      call keep_columns(self, was_written .or. self%is_written)
      self%buffer = other%buffer
      self%n_rows = other%n_rows
      if (all(was_written .eqv. self%is_written)) return
      self%buffer%length = 0_lk
      do column = 1, size(self%names)
         if (self%is_written(column)) call self%buffer%append(self%names(column)%text//",")
      end do
      call self%buffer%replace_last(newline)
      text = other%buffer%text()
      first = index(text, newline) + 1
      do while (first <= len(text))
         do column = 1, size(self%names)
            if (.not. self%is_written(column)) cycle
            if (was_written(column)) then
               last = first + scan(text(first:), ","//newline) - 2
               call self%buffer%append(text(first:last))
               first = last + 2
            end if
            call self%buffer%append(",")
         end do
         call self%buffer%replace_last(newline)
      end do
   end subroutine take_over

   !> Write the whole table if it has changed since it was last written. A row with a value that is
   !! missing, too much or under a wrong name is an error.
   subroutine flush_series(self, error)
      class(series_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      if (.not. self%is_open()) return
      if (allocated(self%fault)) then
         call raise_error(error, "flush_series", self%path//": "//self%fault)
      else if (self%buffer%length /= self%written) then
         call write_text_file(self%path, self%buffer%text(), error)
         if (.not. allocated(error)) self%written = self%buffer%length
      end if
   end subroutine flush_series

   !> Put a value as it stands in the file into its column, which must be the next one. A table that
   !! has not been opened takes no rows.
   subroutine put_item(self, name, item)
      class(series_t), intent(inout) :: self
      character(len=*), intent(in) :: name, item

      if (.not. self%is_open()) return
      if (self%column >= size(self%names)) then
         call keep_fault(self, "goes on with "//name)
      else if (self%names(self%column + 1)%text /= name) then
         call keep_fault(self, "has "//name)
      else
         self%column = self%column + 1
         if (self%is_past(self%column)) then
            call self%buffer%append(",")
         else if (self%is_written(self%column)) then
            call self%buffer%append(item//",")
         end if
      end if
   end subroutine put_item

   !> Keep the first fault.
   subroutine keep_fault(self, what)
      class(series_t), intent(inout) :: self
      character(len=*), intent(in) :: what  !< verb and object of the message
      character(len=:), allocatable :: expected

      if (allocated(self%fault)) return
      expected = "its end"
      if (self%column < size(self%names)) expected = self%names(self%column + 1)%text
      self%fault = "row "//integer_text(self%n_rows + 1_lk)//" "//what//" in place of "//expected
   end subroutine keep_fault

end module report_series
