!> JSON (RFC 8259) built member by member. A number that JSON cannot represent (NaN, infinity)
!! becomes null.
module report_json
   use base_buffer, only: newline, text_buffer_t
   use base_kinds, only: ik, lk, rk
   use base_number, only: integer_text
   use base_texts, only: text_t, utf8_length
   implicit none(type, external)
   private

   public :: escaped, json_t

   integer, parameter :: deepest = 16  !< largest nesting of objects and arrays

   !> A JSON text under construction. An element of an array has the key "".
   type :: json_t
      type(text_buffer_t) :: buffer
      integer :: depth = 0
      logical :: has_members(0:deepest) = .false.
      logical :: one_line = .false.  !< text from here on without line breaks
   contains
      procedure :: begin_object
      procedure :: end_object
      procedure :: begin_array
      procedure :: end_array
      procedure :: add_raw
      procedure, private :: add_real
      procedure, private :: add_integer
      procedure, private :: add_long
      procedure, private :: add_text
      procedure, private :: add_reals
      procedure, private :: add_integers
      procedure, private :: add_texts
      generic :: add => add_real, add_integer, add_long, add_text, add_reals, add_integers, &
         add_texts
      procedure :: text => json_text
   end type json_t

contains

   subroutine begin_object(self, key)
      class(json_t), intent(inout) :: self
      character(len=*), intent(in) :: key

      call begin_member(self, key)
      call open_bracket(self, "{")
   end subroutine begin_object

   subroutine end_object(self)
      class(json_t), intent(inout) :: self

      call close_bracket(self, "}")
   end subroutine end_object

   subroutine begin_array(self, key)
      class(json_t), intent(inout) :: self
      character(len=*), intent(in) :: key

      call begin_member(self, key)
      call open_bracket(self, "[")
   end subroutine begin_array

   subroutine end_array(self)
      class(json_t), intent(inout) :: self

      call close_bracket(self, "]")
   end subroutine end_array

   !> Add a value that is in the form of JSON.
   subroutine add_raw(self, key, value)
      class(json_t), intent(inout) :: self
      character(len=*), intent(in) :: key
      character(len=*), intent(in) :: value

      call begin_member(self, key)
      call self%buffer%append(value)
   end subroutine add_raw

   subroutine add_real(self, key, value)
      class(json_t), intent(inout) :: self
      character(len=*), intent(in) :: key
      real(rk), intent(in) :: value  !< [unit that the key names]

      call begin_member(self, key)
      call append_number(self, value)
   end subroutine add_real

   subroutine add_integer(self, key, value)
      class(json_t), intent(inout) :: self
      character(len=*), intent(in) :: key
      integer(ik), intent(in) :: value

      call self%add_raw(key, integer_text(value))
   end subroutine add_integer

   subroutine add_long(self, key, value)
      class(json_t), intent(inout) :: self
      character(len=*), intent(in) :: key
      integer(lk), intent(in) :: value

      call self%add_raw(key, integer_text(value))
   end subroutine add_long

   !> A text; null where there is none.
   subroutine add_text(self, key, value)
      class(json_t), intent(inout) :: self
      character(len=*), intent(in) :: key
      character(len=*), intent(in), optional :: value

      if (present(value)) then
         call self%add_raw(key, '"'//escaped(value)//'"')
      else
         call self%add_raw(key, "null")
      end if
   end subroutine add_text

   subroutine add_reals(self, key, values)
      class(json_t), intent(inout) :: self
      character(len=*), intent(in) :: key
      real(rk), intent(in) :: values(:)  !< [unit that the key names]
      integer :: i

      call begin_member(self, key)
      call self%buffer%append("[")
      do i = 1, size(values)
         if (i > 1) call self%buffer%append(", ")
         call append_number(self, values(i))
      end do
      call self%buffer%append("]")
   end subroutine add_reals

   subroutine add_integers(self, key, values)
      class(json_t), intent(inout) :: self
      character(len=*), intent(in) :: key
      integer(ik), intent(in) :: values(:)
      integer :: i

      call begin_member(self, key)
      call self%buffer%append("[")
      do i = 1, size(values)
         if (i > 1) call self%buffer%append(", ")
         call self%buffer%append(integer_text(values(i)))
      end do
      call self%buffer%append("]")
   end subroutine add_integers

   !> A list of texts, which is empty if it was never set.
   subroutine add_texts(self, key, values)
      class(json_t), intent(inout) :: self
      character(len=*), intent(in) :: key
      type(text_t), allocatable, intent(in) :: values(:)
      integer :: i, n

      n = 0
      if (allocated(values)) n = size(values)
      call self%begin_array(key)
      do i = 1, n
         call self%add("", values(i)%text)
      end do
      call self%end_array()
   end subroutine add_texts

   !> The JSON text so far.
   function json_text(self) result(text)
      class(json_t), intent(in) :: self
      character(len=:), allocatable :: text

      text = self%buffer%text()
   end function json_text

   !> A text in the form of JSON, without its quotes. Bytes that are not UTF-8 are read as Latin-1.
   pure function escaped(text) result(json)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: json
      character(len=6) :: code
      integer :: i, byte, n_bytes

      json = ""
      i = 1
      do while (i <= len(text))
         byte = iachar(text(i:i))
         n_bytes = 1
         select case (byte)
         case (8)
            json = json//"\b"
         case (9)
            json = json//"\t"
         case (10)
            json = json//"\n"
         case (12)
            json = json//"\f"
         case (13)
            json = json//"\r"
         case (34)
            json = json//'\"'
         case (92)
            json = json//"\\"
         case (32:33, 35:91, 93:126)
            json = json//text(i:i)
         case default
            n_bytes = utf8_length(text(i:))
            if (byte >= 128 .and. n_bytes > 0) then
               json = json//text(i:i + n_bytes - 1)
            else
               n_bytes = 1
               write (code, "(a,z4.4)") "\u", byte
               json = json//code
            end if
         end select
         i = i + n_bytes
      end do
   end function escaped

   !> Append comma, line break and key before a value.
   subroutine begin_member(self, key)
      class(json_t), intent(inout) :: self
      character(len=*), intent(in) :: key

      if (self%has_members(self%depth)) call self%buffer%append(",")
      if (self%depth > 0) call break_line(self, self%has_members(self%depth))
      self%has_members(self%depth) = .true.
      if (len(key) > 0) call self%buffer%append('"'//escaped(key)//'": ')
   end subroutine begin_member

   subroutine open_bracket(self, bracket)
      class(json_t), intent(inout) :: self
      character(len=1), intent(in) :: bracket

      call self%buffer%append(bracket)
      self%depth = self%depth + 1
      self%has_members(self%depth) = .false.
   end subroutine open_bracket

   subroutine close_bracket(self, bracket)
      class(json_t), intent(inout) :: self
      character(len=1), intent(in) :: bracket
      logical :: was_filled

      was_filled = self%has_members(self%depth)
      self%depth = self%depth - 1
      if (was_filled) call break_line(self, .false.)
      call self%buffer%append(bracket)
      if (self%depth == 0 .and. .not. self%one_line) call self%buffer%append(newline)
   end subroutine close_bracket

   !> Append an indented new line; on one line, a blank after a comma.
   subroutine break_line(self, after_comma)
      class(json_t), intent(inout) :: self
      logical, intent(in) :: after_comma

      if (.not. self%one_line) then
         call self%buffer%append(newline//repeat("  ", self%depth))
      else if (after_comma) then
         call self%buffer%append(" ")
      end if
   end subroutine break_line

   subroutine append_number(self, value)
      class(json_t), intent(inout) :: self
      real(rk), intent(in) :: value  !< [unit that the key names]

      if (abs(value) <= huge(value)) then
         call self%buffer%append_real(value)
      else  ! also NaN
         call self%buffer%append("null")
      end if
   end subroutine append_number

end module report_json
