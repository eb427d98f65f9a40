!> Small operations on words: case, likeness, and numbers written so that they read back exactly.
module scene_words
   use base_kinds, only: ik, lk, rk
   implicit none(type, external)
   private

   public :: edit_distance, integer_text, is_identifier, is_utf8, lower_case, real_text, &
             rounded_text

contains

   !> ASCII letters in lower case, all else unchanged.
   pure function lower_case(word) result(lower)
      character(len=*), intent(in) :: word
      character(len=len(word)) :: lower
      integer :: i, code

      lower = word
      do i = 1, len(word)
         code = iachar(word(i:i))
         if (code >= iachar("A") .and. code <= iachar("Z")) lower(i:i) = achar(code + 32)
      end do
   end function lower_case

   !> Insertions, deletions, replacements and swaps of neighbours that turn a into b
   !> (optimal string alignment; Damerau 1964).
   pure integer function edit_distance(a, b) result(distance)
      character(len=*), intent(in) :: a, b
      integer :: d(-1:len(a), -1:len(b))
      integer :: i, j, cost

      d = len(a) + len(b)
      d(0:, 0) = [(i, i=0, len(a))]
      d(0, 0:) = [(j, j=0, len(b))]
      do j = 1, len(b)
         do i = 1, len(a)
            cost = merge(0, 1, a(i:i) == b(j:j))
            d(i, j) = min(d(i - 1, j) + 1, d(i, j - 1) + 1, d(i - 1, j - 1) + cost)
            if (i > 1 .and. j > 1) then
               if (a(i:i) == b(j - 1:j - 1) .and. a(i - 1:i - 1) == b(j:j)) then
                  d(i, j) = min(d(i, j), d(i - 2, j - 2) + 1)
               end if
            end if
         end do
      end do
      distance = d(len(a), len(b))
   end function edit_distance

   !> Letters, digits, `_`, `-` and `.`, beginning with a letter or a digit: safe as a file name and
   !> as part of a column name.
   pure logical function is_identifier(word)
      character(len=*), intent(in) :: word
      character(len=*), parameter :: alphanumeric = "abcdefghijklmnopqrstuvwxyz"// &
                                     "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"

      is_identifier = len(word) > 0 .and. verify(word, alphanumeric//"_-.") == 0
      if (is_identifier) is_identifier = index(alphanumeric, word(1:1)) > 0
   end function is_identifier

   !> Every byte is printable ASCII or part of a UTF-8 sequence of the right length.
   pure logical function is_utf8(word)
      character(len=*), intent(in) :: word
      integer :: i, code, n_following

      is_utf8 = .false.
      n_following = 0
      do i = 1, len(word)
         code = ichar(word(i:i))
         if (n_following > 0) then
            if (code < 128 .or. code > 191) return
            n_following = n_following - 1
         else
            select case (code)
            case (32:126)
               n_following = 0
            case (194:223)
               n_following = 1
            case (224:239)
               n_following = 2
            case (240:244)
               n_following = 3
            case default
               return
            end select
         end if
      end do
      is_utf8 = n_following == 0
   end function is_utf8

   !> An integer without blanks.
   pure function integer_text(value) result(text)
      integer(ik), intent(in) :: value
      character(len=:), allocatable :: text
      character(len=16) :: buffer

      write (buffer, "(i0)") value
      text = trim(buffer)
   end function integer_text

   !> The shortest decimal text that reads back to the same bits, as `0.25`, `97200.0` or `4.0e-10`.
   pure function real_text(value) result(text)
      real(rk), intent(in) :: value  !< finite
      character(len=:), allocatable :: text
      character(len=17), parameter :: zeros = repeat("0", 17)
      character(len=32) :: buffer, style
      character(len=:), allocatable :: digits, sign
      real(rk) :: again
      integer :: n_digits, exponent, status, mark

      do n_digits = 1, 17  ! 17 digits determine any 64-bit number (IEEE 754)
         write (style, "(a,i0,a)") "(es32.", n_digits - 1, "e3)"
         write (buffer, style) value
         read (buffer, "(f32.0)", iostat=status) again
         if (status == 0 .and. transfer(again, 0_lk) == transfer(value, 0_lk)) exit
      end do

      buffer = adjustl(buffer)
      mark = scan(buffer, "E")
      if (mark == 0) then  ! an infinity or NaN, which no scene holds
         text = trim(buffer)
         return
      end if
      read (buffer(mark + 1:), *) exponent
      sign = ""
      if (buffer(1:1) == "-") then
         sign = "-"
         buffer = buffer(2:)
         mark = mark - 1
      end if
      digits = buffer(1:1)//buffer(3:mark - 1)
      digits = digits(1:max(1, verify(digits, "0", back=.true.)))

      if (exponent >= 0 .and. exponent <= 6) then
         digits = digits//zeros(1:max(0, exponent + 2 - len(digits)))
         text = sign//digits(1:exponent + 1)//"."//digits(exponent + 2:)
      else if (exponent < 0 .and. exponent >= -3) then
         text = sign//"0."//zeros(1:-exponent - 1)//digits
      else
         if (len(digits) == 1) digits = digits//"0"
         text = sign//digits(1:1)//"."//digits(2:)//"e"//integer_text(int(exponent, ik))
      end if
   end function real_text

   !> A computed number for a message, to four digits.
   pure function rounded_text(value) result(text)
      real(rk), intent(in) :: value
      character(len=:), allocatable :: text
      character(len=32) :: buffer
      real(rk) :: rounded

      write (buffer, "(es32.3e3)") value
      read (buffer, "(f32.0)") rounded
      text = real_text(rounded)
   end function rounded_text

end module scene_words
