!> Tables as CSV (RFC 4180): rows gather in memory, and the file is written whole.
module output_series
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, lk, rk
   use base_number, only: integer_text
   use output_text, only: newline, text_buffer_t
   implicit none(type, external)
   private

   public :: series_t

   !> One table. A row is `put` value by value, then ended; or it is added as an array of reals.
   type :: series_t
      integer(lk) :: n_rows = 0_lk
      character(len=:), allocatable :: path
      type(text_buffer_t), private :: buffer
      integer, private :: n_columns = 0
      integer, private :: column = 0  !< values in the row so far
      integer(lk), private :: bad_row = 0_lk  !< first row with a wrong number of values
      integer, private :: written = -1  !< characters in the file
   contains
      procedure :: open => open_series
      procedure, private :: put_real
      procedure, private :: put_integer
      procedure, private :: put_text
      generic :: put => put_real, put_integer, put_text
      procedure :: put_nothing
      procedure :: end_row
      procedure :: add_row
      procedure :: is_open
      procedure :: flush => flush_series
   end type series_t

contains

   !> Begin a table; nothing is written yet.
   subroutine open_series(self, path, columns)
      class(series_t), intent(out) :: self
      character(len=*), intent(in) :: path
      character(len=*), intent(in) :: columns(:)  !< names with their units, in order
      integer :: i

      self%path = path
      self%n_columns = size(columns)
      do i = 1, size(columns)
         call self%put(trim(columns(i)))
      end do
      call self%buffer%append(newline)
      self%column = 0
   end subroutine open_series

   !> The table was opened; otherwise rows and flushes are for nobody.
   pure function is_open(self)
      class(series_t), intent(in) :: self
      logical :: is_open

      is_open = allocated(self%path)
   end function is_open

   subroutine put_real(self, value)
      class(series_t), intent(inout) :: self
      real(rk), intent(in) :: value

      call separate(self)
      call self%buffer%append_real(value)
   end subroutine put_real

   subroutine put_integer(self, value)
      class(series_t), intent(inout) :: self
      integer(ik), intent(in) :: value

      call separate(self)
      call self%buffer%append(integer_text(value))
   end subroutine put_integer

   subroutine put_text(self, value)
      class(series_t), intent(inout) :: self
      character(len=*), intent(in) :: value
      integer :: i

      call separate(self)
      if (scan(value, ',"'//achar(10)//achar(13)) == 0) then
         call self%buffer%append(value)
      else
         call self%buffer%append('"')
         do i = 1, len(value)
            if (value(i:i) == '"') call self%buffer%append('"')
            call self%buffer%append(value(i:i))
         end do
         call self%buffer%append('"')
      end if
   end subroutine put_text

   !> An empty value, where a quantity does not apply.
   subroutine put_nothing(self)
      class(series_t), intent(inout) :: self

      call separate(self)
   end subroutine put_nothing

   subroutine end_row(self)
      class(series_t), intent(inout) :: self

      self%n_rows = self%n_rows + 1_lk
      if (self%column /= self%n_columns .and. self%bad_row == 0_lk) self%bad_row = self%n_rows
      self%column = 0
      call self%buffer%append(newline)
   end subroutine end_row

   !> A row of numbers.
   subroutine add_row(self, values)
      class(series_t), intent(inout) :: self
      real(rk), intent(in) :: values(:)  !< one for each column
      integer :: i

      do i = 1, size(values)
         call self%put(values(i))
      end do
      call self%end_row()
   end subroutine add_row

   !> Write the whole table if it has changed since it was last written.
   subroutine flush_series(self, error)
      class(series_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      if (.not. self%is_open()) return
      if (self%bad_row > 0_lk) then
         call raise_error(error, "flush_series", self%path//": row "//integer_text(self%bad_row)// &
            & " does not have "//integer_text(int(self%n_columns, ik))//" values")
      else if (self%buffer%length /= self%written) then
         call self%buffer%write_file(self%path, error)
         if (.not. allocated(error)) self%written = self%buffer%length
      end if
   end subroutine flush_series

   !> A comma before every value but the first.
   subroutine separate(self)
      class(series_t), intent(inout) :: self

      if (self%column > 0) call self%buffer%append(",")
      self%column = self%column + 1
   end subroutine separate

end module output_series
