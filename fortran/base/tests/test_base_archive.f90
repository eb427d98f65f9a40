!> Values that are stored and loaded again are the same, and archives with faults are refused.
program test_base_archive
   use, intrinsic :: iso_c_binding, only: c_loc, c_size_t
   use, intrinsic :: iso_fortran_env, only: int8
   use base_archive, only: archive_t
   use base_kinds, only: ik, lk, rk
   use base_stream, only: checksum
   use base_texts, only: text_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   type :: point_t
      real(rk) :: x = 0.0_rk
      logical :: is_free = .false.
      integer(ik) :: number = 0
   end type point_t

   !> Values of all kinds.
   type :: sample_t
      real(rk) :: scalar = 0.0_rk, pair(2) = 0.0_rk
      integer(ik) :: whole = 0
      integer(lk) :: long = 0_lk
      logical :: flag = .false.
      character(len=7) :: word = ""
      real(rk), allocatable :: line(:), plane(:, :), cube(:, :, :), missing(:), empty(:, :)
      integer(ik), allocatable :: numbers(:)
      logical, allocatable :: flags(:, :)
      character(len=:), allocatable :: text
      type(text_t), allocatable :: texts(:)
      type(point_t), allocatable :: points(:)
   end type sample_t

   type(checks_t) :: checks

   call returns_all()
   call refuses_other_entries()
   call refuses_short_archives()
   call knows_checksum()
   call checks%finish()

contains

   subroutine visit(archive, sample)
      type(archive_t), intent(inout) :: archive
      type(sample_t), intent(inout), target :: sample
      integer(lk) :: n

      call archive%enter("sample")
      call archive%item("scalar", sample%scalar)
      call archive%item("pair", sample%pair)
      call archive%item("whole", sample%whole)
      call archive%item("long", sample%long)
      call archive%item("flag", sample%flag)
      call archive%item("word", sample%word)
      call archive%list("line", sample%line)
      call archive%list("plane", sample%plane)
      call archive%list("cube", sample%cube)
      call archive%list("missing", sample%missing)
      call archive%list("empty", sample%empty)
      call archive%list("numbers", sample%numbers)
      call archive%list("flags", sample%flags)
      call archive%list("text", sample%text)
      call archive%texts("texts", sample%texts)
      n = -1_lk
      if (allocated(sample%points)) n = size(sample%points)
      call archive%count("points", n)
      if (archive%is_loading) then
         if (n >= 0_lk) allocate (sample%points(n))
      end if
      if (n > 0_lk) call archive%plain("points", c_loc(sample%points), &
                                       n*storage_size(sample%points)/8_lk)
      call archive%leave()
   end subroutine visit

   function filled() result(sample)
      type(sample_t) :: sample

      sample%scalar = 1.0_rk/3.0_rk
      sample%pair = [huge(1.0_rk), -tiny(1.0_rk)]
      sample%whole = -7
      sample%long = huge(1_lk)
      sample%flag = .true.
      sample%word = "a word"
      sample%line = [1.0_rk, 2.0_rk, 3.0_rk]
      sample%plane = reshape([1.0_rk, 2.0_rk, 3.0_rk, 4.0_rk, 5.0_rk, 6.0_rk], [2, 3])
      sample%cube = reshape([1.0_rk, 2.0_rk, 3.0_rk, 4.0_rk], [2, 1, 2])
      allocate (sample%empty(3, 0))
      sample%numbers = [3_ik, 1_ik]
      sample%flags = reshape([.true., .false., .true.], [1, 3])
      sample%text = "two words"
      sample%texts = [text_t("one"), text_t(""), text_t("three")]
      sample%points = [point_t(1.5_rk, .true., 4), point_t(-2.5_rk, .false., 9)]
   end function filled

   subroutine returns_all()
      type(archive_t) :: archive
      type(sample_t) :: a, b

      a = filled()
      call archive%begin_storing()
      call visit(archive, a)
      call archive%begin_loading()
      call visit(archive, b)
      call checks%is_true(.not. allocated(archive%fault), "all entries are found")
      call checks%is_true(archive%place == archive%length, "and nothing else")
      call checks%is_true(all(abs([a%scalar, a%pair] - [b%scalar, b%pair]) <= 0.0_rk), "reals")
      call checks%is_true(a%whole == b%whole .and. a%long == b%long, "integers")
      call checks%is_true(b%flag .and. b%word == "a word", "a logical and a word")
      call checks%is_true(all(abs(a%line - b%line) <= 0.0_rk), "a line")
      call checks%is_true(all(shape(b%plane) == [2, 3]), "the shape of a plane")
      call checks%is_true(all(abs(a%plane - b%plane) <= 0.0_rk), "a plane")
      call checks%is_true(all(abs(a%cube - b%cube) <= 0.0_rk), "a cube")
      call checks%is_true(.not. allocated(b%missing), "an array that is not allocated")
      call checks%is_true(all(shape(b%empty) == [3, 0]), "an empty array")
      call checks%is_true(all(a%numbers == b%numbers), "numbers")
      call checks%is_true(all(a%flags .eqv. b%flags), "flags")
      call checks%is_true(b%text == "two words", "a text")
      call checks%is_true(size(b%texts) == 3 .and. b%texts(3)%text == "three", "texts")
      call checks%is_true(all(b%points%number == [4, 9]) .and. b%points(1)%is_free, "a plain type")
   end subroutine returns_all

   !> Other names, kinds and sizes.
   subroutine refuses_other_entries()
      type(archive_t) :: archive
      real(rk) :: pair(2), triple(3)
      integer(ik) :: whole

      pair = [1.0_rk, 2.0_rk]
      triple = 0.0_rk
      whole = 0
      call archive%begin_storing()
      call archive%item("pair", pair)
      call archive%begin_loading()
      call archive%item("couple", pair)
      call checks%is_true(allocated(archive%fault), "another name")
      call archive%begin_loading()
      call archive%item("pair", whole)
      call checks%is_true(allocated(archive%fault), "another kind")
      call archive%begin_loading()
      call archive%item("pair", triple)
      call checks%is_true(allocated(archive%fault), "another size")
   end subroutine refuses_other_entries

   !> An archive cut after any byte.
   subroutine refuses_short_archives()
      type(archive_t) :: archive
      type(sample_t) :: sample
      integer(lk) :: n, whole
      logical :: all_refused

      sample = filled()
      call archive%begin_storing()
      call visit(archive, sample)
      whole = archive%length
      all_refused = .true.
      do n = 0_lk, whole - 1_lk
         archive%length = n
         call archive%begin_loading()
         call load_one(archive)
         all_refused = all_refused .and. allocated(archive%fault)
      end do
      call checks%is_true(all_refused, "an archive that ends early")
   end subroutine refuses_short_archives

   subroutine load_one(archive)
      type(archive_t), intent(inout) :: archive
      type(sample_t) :: sample

      call visit(archive, sample)
   end subroutine load_one

   !> The check value of CRC-32, and the same in two parts.
   subroutine knows_checksum()
      integer(int8), parameter :: digits(9) = [49_int8, 50_int8, 51_int8, 52_int8, 53_int8, &
                                               54_int8, 55_int8, 56_int8, 57_int8]
      integer(lk), parameter :: expected = int(z'CBF43926', lk)

      call checks%is_true(checksum(0_lk, digits, 9_c_size_t) == expected, "CRC-32 of 123456789")
      call checks%is_true(checksum(checksum(0_lk, digits, 4_c_size_t), digits(5:), 5_c_size_t) &
                          == expected, "the same in two parts")
   end subroutine knows_checksum

end program test_base_archive
