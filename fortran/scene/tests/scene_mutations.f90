!> Scene files with faults in them: each number stands for one mutated file, always the same.
module scene_mutations
   use base_kinds, only: lk, rk
   use base_texts, only: add_text, text_t
   use testing_files, only: file_text
   use testing_random, only: random_t
   implicit none(type, external)
   private

   public :: mutator_t

   character(len=1), parameter :: newline = achar(10)
   character(len=*), parameter :: digits = "0123456789"
   character(len=*), parameter :: of_words = digits//"abcdefghijklmnopqrstuvwxyz"// &
                                  "ABCDEFGHIJKLMNOPQRSTUVWXYZ_.+-&"

   ! Kinds of pieces, and what is done to one.
   integer, parameter :: of_bytes = 1, of_lines = 2, of_word = 3, of_number = 4, of_group = 5
   integer, parameter :: loses = 0, repeats = 1, exchanges = 2, replaces = 3

   ! How often a kind is taken, in 20: numbers and words lead past the syntax.
   integer, parameter :: kinds(20) = [of_bytes, of_bytes, of_bytes, &
                                      of_lines, of_lines, of_lines, of_lines, &
                                      of_word, of_word, of_word, &
                                      of_number, of_number, of_number, of_number, &
                                      of_number, of_number, of_number, of_number, &
                                      of_group, of_group]

   !&<
   character(len=24), parameter :: odd_numbers(*) = [character(len=24) :: &
      "0", "0.0", "-0.0", "-1", "1", "2", "1e-300", "4.9e-324", "1e-15", "1e15", "1e200", &
      "1.7976931348623157e308", "NaN", "nan", "Inf", "-Infinity", "1e999", "-1e999", "1e-999", &
      "2147483647", "2147483648", "-2147483649", "9223372036854775808", "1*", "0*1", "3*2.0", &
      "1d5", ".5", "5.", "0x10", "1e", "1,5", "'1'", ".true.", "1_8", "--1", "1e5.5"]
   !&>

   !> The files to mutate.
   type :: mutator_t
      type(text_t), allocatable, private :: sources(:)
   contains
      procedure :: load
      procedure :: mutated
   end type mutator_t

contains

   !> Take up a file; an empty one, or one that cannot be read, is not taken.
   subroutine load(self, path, is_taken)
      class(mutator_t), intent(inout) :: self
      character(len=*), intent(in) :: path
      logical, intent(out) :: is_taken
      character(len=:), allocatable :: bytes

      bytes = file_text(path)
      is_taken = len(bytes) > 0
      if (is_taken) call add_text(self%sources, bytes)
   end subroutine load

   !> The mutated file of a number: one of the files with one to four changes.
   function mutated(self, number) result(bytes)
      class(mutator_t), intent(in) :: self
      integer(lk), intent(in) :: number  !< 0 or more
      character(len=:), allocatable :: bytes
      type(random_t) :: random
      integer :: change, n_changes, place

      call random%start(number)
      place = 1 + random%below(size(self%sources))
      bytes = self%sources(place)%text
      n_changes = max(1, random%below(7) - 2)  ! 1: four times in seven
      do change = 1, n_changes
         select case (random%below(30))
         case (0)
            place = random%below(len(bytes) + 1)
            bytes = bytes(:place)
         case (1)
            call insert_broken_text(random, bytes)
         case default
            place = 1 + random%below(size(self%sources))
            call change_piece(random, self%sources(place)%text, bytes)
         end select
      end do
   end function mutated

   !> Lose, repeat, exchange or replace a piece.
   subroutine change_piece(random, other, bytes)
      type(random_t), intent(inout) :: random
      character(len=*), intent(in) :: other  !< where a replacement comes from
      character(len=:), allocatable, intent(inout) :: bytes
      integer, allocatable :: pieces(:, :), others(:, :)
      integer :: kind, a, b, action

      kind = kinds(1 + random%below(size(kinds)))
      pieces = pieces_of(bytes, kind)
      if (size(pieces, 2) == 0) return
      a = 1 + random%below(size(pieces, 2))
      b = 1 + random%below(size(pieces, 2))
      action = random%below(4)
      if (random%below(4) > 0 .and. kind == of_number) action = replaces
      associate (first => pieces(1, a), last => pieces(2, a))
         select case (action)
         case (loses)
            bytes = bytes(:first - 1)//bytes(last + 1:)
         case (repeats)
            bytes = bytes(:last)//bytes(first:)
         case (exchanges)
            bytes = exchanged(bytes, pieces(:, min(a, b)), pieces(:, max(a, b)))
         case default
            select case (kind)
            case (of_bytes)
               bytes(first:first) = char(random%below(256))
            case (of_number)
               bytes = bytes(:first - 1)//odd_number(random, bytes(first:last))//bytes(last + 1:)
            case default
               others = pieces_of(other, kind)
               if (size(others, 2) == 0) return
               b = 1 + random%below(size(others, 2))
               bytes = bytes(:first - 1)//other(others(1, b):others(2, b))//bytes(last + 1:)
            end select
         end select
      end associate
   end subroutine change_piece

   !> Two pieces in each other's place; nothing changes where they are the same or overlap.
   pure function exchanged(bytes, early, late) result(text)
      character(len=*), intent(in) :: bytes
      integer, intent(in) :: early(2), late(2)
      character(len=:), allocatable :: text

      text = bytes
      if (early(2) >= late(1)) return
      text = bytes(:early(1) - 1)//bytes(late(1):late(2))//bytes(early(2) + 1:late(1) - 1)// &
             bytes(early(1):early(2))//bytes(late(2) + 1:)
   end function exchanged

   !> What stands for a number: one that the reading or the physics may not expect, or the same
   !! times something.
   function odd_number(random, word) result(text)
      type(random_t), intent(inout) :: random
      character(len=*), intent(in) :: word
      character(len=:), allocatable :: text
      character(len=32) :: digits_of
      real(rk) :: value
      integer :: item, status

      item = 1 + random%below(size(odd_numbers))
      text = trim(odd_numbers(item))
      if (random%below(2) == 0) return
      read (word, *, iostat=status) value
      if (status /= 0) return
      select case (random%below(4))
      case (0)
         value = -value
      case (1)
         value = value*10.0_rk**(random%below(25) - 12)
      case default
         value = value*0.01_rk*random%below(300)
      end select
      write (digits_of, "(es23.15e3)") value
      text = trim(adjustl(digits_of))
   end function odd_number

   !> Bytes that are no UTF-8, or no printable text, somewhere.
   subroutine insert_broken_text(random, bytes)
      type(random_t), intent(inout) :: random
      character(len=:), allocatable, intent(inout) :: bytes
      !&<
      character(len=*), parameter :: broken(*) = [character(len=4) :: &
         char(195), char(128), char(237)//char(160)//char(128), char(192)//char(175), &
         char(244)//char(144)//char(128)//char(128), char(255)//char(254), &
         char(239)//char(187)//char(191), char(0), char(27)//"[2J", char(194)//char(133), &
         char(13), char(226)//char(128)//char(168)]
      !&>
      integer :: item, place

      item = 1 + random%below(size(broken))
      place = random%below(len(bytes) + 1)
      bytes = bytes(:place)//trim(broken(item))//bytes(place + 1:)
   end subroutine insert_broken_text

   !> (2, n) first and last byte of all pieces of a kind.
   pure function pieces_of(bytes, kind) result(pieces)
      character(len=*), intent(in) :: bytes
      integer, intent(in) :: kind
      integer, allocatable :: pieces(:, :)
      integer :: first, last, n

      allocate (pieces(2, len(bytes)))
      n = 0
      last = 0
      do
         first = last + 1
         select case (kind)
         case (of_bytes)
            last = first
         case (of_lines)
            last = until(bytes, first, newline)
         case (of_group)
            first = last + max(1, index(bytes(last + 1:), "&"))
            last = until(bytes, first, "/")
         case default
            first = last + scan(bytes(last + 1:), of_words)
            if (first == last) exit
            last = first + verify(bytes(first:)//" ", of_words) - 2
         end select
         if (first > len(bytes)) exit
         if (kind == of_number) then
            if (verify(bytes(first:first), digits//"+-.") > 0) cycle
            if (scan(bytes(first:last), digits) == 0) cycle
         end if
         n = n + 1
         pieces(:, n) = [first, last]
      end do
      pieces = pieces(:, :n)
   end function pieces_of

   !> Where a byte stands next, or else the end.
   pure integer function until(bytes, first, byte)
      character(len=*), intent(in) :: bytes
      integer, intent(in) :: first
      character(len=1), intent(in) :: byte

      until = len(bytes)
      if (first > len(bytes)) return
      if (index(bytes(first:), byte) > 0) until = first - 1 + index(bytes(first:), byte)
   end function until

end module scene_mutations
