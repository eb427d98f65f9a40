!> Whatever a file holds, reading it ends with a scene or with a message, never in a crash. The test
!! mutated_scenes reads the scenes of inputs/ with changed bytes.
program test_scene_fuzz
   use base_errors, only: error_t
   use scene_namelist, only: read_scene
   use scene_test_files, only: delete_file, put_bytes, source_path
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   use testing_files, only: file_text
   use testing_random, only: random_t
   implicit none(type, external)
   character(len=*), parameter :: path = "test_scene_fuzz.nml"
   type(checks_t) :: checks
   character(len=:), allocatable :: good
   type(random_t) :: random

   good = file_text(source_path("inputs/paper_c/onset.nml"))
   call cut_everywhere()
   call random_bytes()
   call random_pieces()
   call large_files()
   call delete_file(path)
   call checks%finish()

contains

   !> A file that ends early is refused, wherever it ends before its last group has begun.
   subroutine cut_everywhere()
      integer :: length, needed, n_refused

      needed = index(good, "&coarse") - 1  ! all that follows is optional
      n_refused = 0
      do length = 0, needed, 7
         if (refused(good(1:length))) n_refused = n_refused + 1
      end do
      call checks%is_true(n_refused == count([(.not. complete_at(length), length=0, needed, 7)]), &
                          "every cut within the required part is refused")
   end subroutine cut_everywhere

   !> Cut behind the last required group, at blanks or in a comment, a file is complete.
   logical function complete_at(length)
      integer, intent(in) :: length
      integer :: last_group

      last_group = index(good, "&time")
      complete_at = length > last_group
      if (complete_at) complete_at = index(good(last_group:length), "/") > 0
   end function complete_at

   subroutine random_bytes()
      character(len=400) :: bytes
      integer :: i, k, n_refused

      n_refused = 0
      do i = 1, 500
         do k = 1, len(bytes)
            bytes(k:k) = char(random%below(256))
         end do
         if (refused(bytes)) n_refused = n_refused + 1
      end do
      call checks%is_true(n_refused == 500, "random bytes are refused")
   end subroutine random_bytes

   !> Pieces of the syntax in any order reach deeper than bytes do.
   subroutine random_pieces()
      character(len=1), parameter :: quote = achar(39)
      !&<
      character(len=16), parameter :: pieces(*) = [character(len=16) :: &
         "&material", "&fracture", "&side", "&", "/", "=", ",", quote, quote//quote, &
         quote//"left"//quote, "name", "x", "y =", "young =", "1*", "3*1.0", "*", "1e400", &
         "-", ".", "NaN", "T", "! remark", "x(1)", "0*1"]
      !&>
      character(len=:), allocatable :: text
      integer :: i, k, piece, n_refused

      n_refused = 0
      do i = 1, 2000
         text = "&fracture"
         do k = 1, 12
            piece = 1 + random%below(size(pieces))
            text = text//" "//trim(pieces(piece))
            if (random%below(5) == 0) text = text//achar(10)
         end do
         if (refused(text)) n_refused = n_refused + 1
      end do
      call checks%is_true(n_refused == 2000, "random pieces are refused")
   end subroutine random_pieces

   subroutine large_files()
      call checks%is_true(refused(repeat("&probe/", 100000)), "a great many groups")
      call checks%is_true(refused("&"//repeat("a", 200000)), "a very long name")
      call checks%is_true(refused("&scene title = '"//repeat("a", 200000)//"' /"), &
                          "a very long text")
      call checks%is_true(refused("&fracture x = "//repeat("1,", 150000)//" /"), "a very long list")
      call checks%is_true(refused(repeat(" ", 4000001)), "too large a file")
      call checks%is_true(refused(repeat("/", 100000)), "slashes")
   end subroutine large_files

   logical function refused(bytes)
      character(len=*), intent(in) :: bytes
      type(scene_t) :: scene
      type(error_t), allocatable :: error

      call put_bytes(path, bytes)
      call read_scene(path, scene, error)
      refused = allocated(error)
      if (refused) refused = index(error%message, path) == 1
   end function refused

end program test_scene_fuzz
