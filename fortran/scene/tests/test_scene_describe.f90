!> docs/input.md is what the table of parameters says.
program test_scene_describe
   use scene_describe, only: describe_input
   use testing_checks, only: checks_t
   use testing_files, only: check_page
   implicit none(type, external)
   type(checks_t) :: checks
   integer :: code

   open (newunit=code, status="scratch", action="readwrite")
   call describe_input(code)
   rewind (code)
   call check_page(checks, code, "docs/input.md")
   call checks%finish()
end program test_scene_describe
