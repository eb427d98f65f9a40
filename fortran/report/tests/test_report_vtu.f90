!> Tests of report_vtu: the bytes in the file are the numbers given, where the header says.
program test_report_vtu
   use, intrinsic :: iso_fortran_env, only: int64, int8
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use report_files, only: make_directory
   use report_vtu, only: vtk_triangle, vtu_grid_t
   use testing_checks, only: checks_t
   use testing_files, only: file_exists, file_text
   implicit none(type, external)

   character(len=*), parameter :: folder = "test_report_vtu.out"
   character(len=*), parameter :: path = folder//"/grid.vtu"
   real(rk), parameter :: xy(2, 4) = reshape([0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 1.0_rk, 0.1_rk, &
      & 0.0_rk, 1.0_rk/3.0_rk], [2, 4])
   integer(ik), parameter :: cells(3, 2) = reshape([1_ik, 2_ik, 3_ik, 1_ik, 3_ik, 4_ik], [3, 2])
   real(rk), parameter :: pressure(2) = [1.0e7_rk/3.0_rk, -tiny(1.0_rk)]
   real(rk), parameter :: jump(2, 2) = reshape([0.1_rk, 0.2_rk, 0.3_rk, 0.4_rk], [2, 2])
   integer(ik), parameter :: state(2) = [2_ik, 0_ik]
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(vtu_grid_t) :: grid
   character(len=:), allocatable :: text
   integer :: i, first, found

   call make_directory(folder, error)
   call grid%begin(xy, cells, vtk_triangle, 12.5_rk)
   call grid%add("pressure", pressure)
   call grid%add("jump", jump, [character(len=10) :: "normal", "tangential"])
   call grid%add("state", state)
   call grid%write(path, error)
   call checks%no_error(error, "the file is written")
   call checks%is_true(.not. file_exists(path//".part"), "nothing is left aside")
   text = file_text(path)

   call has('NumberOfPoints="4" NumberOfCells="2"')
   call has('Name="TimeValue" NumberOfTuples="1" format="ascii">12.5<')
   call has('header_type="UInt64"')
   call has('Name="jump" NumberOfComponents="2" ComponentName0="normal" '// &
      & 'ComponentName1="tangential" format="appended"')
   call same_reals("Points", [(xy(:, i), 0.0_rk, i=1, 4)])
   call same_integers("connectivity", [0_ik, 1_ik, 2_ik, 0_ik, 2_ik, 3_ik])
   call same_integers("offsets", [3_ik, 6_ik])
   call checks%is_true(all(transfer(block_of("types"), [integer(int8) ::]) == 5_int8), "types")
   call same_reals("pressure", pressure)
   call same_reals("jump", [jump])
   call same_integers("state", state)
   call checks%is_true(index(text, achar(10)//"  </AppendedData>"//achar(10)//"</VTKFile>") > 0, &
      & "the file ends as XML")

   ! More fields than the room first made for them.
   do i = 1, 20
      call grid%add("more", pressure)
   end do
   call grid%write(path, error)
   call checks%no_error(error, "many fields")
   text = file_text(path)
   first = 1
   do i = 1, 20
      found = index(text(first:), 'Name="more"')
      call checks%is_true(found > 0, "a field more")
      first = first + found
   end do

   call grid%write(folder//"/missing/grid.vtu", error)
   call checks%fails_with(error, "missing/grid.vtu", "a missing directory is reported")
   call checks%finish()

contains

   !> The header has these words.
   subroutine has(words)
      character(len=*), intent(in) :: words

      call checks%is_true(index(text, words) > 0, words)
   end subroutine has

   !> Bytes of an array, found by its name and the offset in the header, without the size before
   !! them.
   function block_of(name) result(bytes)
      character(len=*), intent(in) :: name
      character(len=:), allocatable :: bytes
      integer :: first, last, offset, status
      integer(int64) :: n_bytes

      bytes = ""
      first = index(text, 'Name="'//name//'"')
      if (first == 0) return
      first = first + index(text(first:), 'offset="') + 7
      last = first + index(text(first:), '"') - 2
      read (text(first:last), *, iostat=status) offset
      if (status /= 0) return
      first = index(text, '<AppendedData encoding="raw">')
      first = first + index(text(first:), "_") + offset
      n_bytes = transfer(text(first:first + 7), n_bytes)
      bytes = text(first + 8:first + 7 + int(n_bytes))
   end function block_of

   subroutine same_reals(name, expected)
      character(len=*), intent(in) :: name
      real(rk), intent(in) :: expected(:)
      real(rk), allocatable :: values(:)

      allocate (values, source=transfer(block_of(name), [real(rk) ::]))
      call checks%is_true(size(values) == size(expected), name//" has all values")
      if (size(values) /= size(expected)) return
      call checks%is_close(maxval(abs(values - expected)), 0.0_rk, 0.0_rk, name)
   end subroutine same_reals

   subroutine same_integers(name, expected)
      character(len=*), intent(in) :: name
      integer(ik), intent(in) :: expected(:)
      integer(ik), allocatable :: values(:)

      allocate (values, source=transfer(block_of(name), [integer(ik) ::]))
      call checks%is_true(size(values) == size(expected), name//" has all values")
      if (size(values) /= size(expected)) return
      call checks%is_true(all(values == expected), name)
   end subroutine same_integers

end program test_report_vtu
