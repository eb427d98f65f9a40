!> docs/input.md is what the table of parameters says.
program test_scene_describe
   use testing_checks, only: checks_t
   use scene_describe, only: describe_input
   use scene_test_files, only: source_path
   implicit none(type, external)
   type(checks_t) :: checks
   character(len=1024) :: from_code, from_page
   character(len=8) :: number
   integer :: code, page, code_status, page_status, line

   open (newunit=code, status="scratch", action="readwrite")
   call describe_input(code)
   rewind (code)
   open (newunit=page, file=source_path("docs/input.md"), action="read", status="old", &
         iostat=page_status)
   call checks%is_true(page_status == 0, "docs/input.md exists")
   line = 0
   do while (page_status == 0)
      read (code, "(a)", iostat=code_status) from_code
      read (page, "(a)", iostat=page_status) from_page
      line = line + 1
      write (number, "(i0)") line
      call checks%is_true((code_status == 0) .eqv. (page_status == 0), &
                          "docs/input.md is as long as the page from the code; line "//trim(number))
      if (code_status /= 0 .or. page_status /= 0) exit
      call checks%is_true(from_code == from_page, "docs/input.md, line "//trim(number)//": "// &
                          trim(from_page))
   end do
   call checks%is_true(line > 100, "the page is whole")
   call checks%finish()
end program test_scene_describe
