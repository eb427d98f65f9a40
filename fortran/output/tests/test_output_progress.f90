!> Tests of output_progress: what the line says, and that it says nothing where nobody looks.
program test_output_progress
   use testing_checks, only: checks_t
   use base_kinds, only: rk
   use output_progress, only: progress_line, progress_t, progress_values_t
   implicit none(type, external)

   type(checks_t) :: checks
   type(progress_t) :: progress
   type(progress_values_t) :: values
   character(len=:), allocatable :: line

   values = progress_values_t(1234.5678_rk, 5000.0_rk, 12, 4, 60, 30, 10, 1.23456_rk)
   line = progress_line(values)
   call checks%is_true(trim(line) == &
      & "24%  t 1234.6 s  step 12  Newton 4  stick 60 slip 30 open 10  L 1.235 m", trim(line))
   call checks%is_true(len(line) == 79, "the line covers the one before and fits a terminal")
   values%time = 4999.9999_rk
   call checks%is_true(index(progress_line(values), "99%  t 5000 s") == 1, "100% only at the end")
   values%time = 5000.0_rk
   call checks%is_true(index(progress_line(values), "100%  t 5000 s") == 1, "done")

   values%is_load = .true.
   values%load_factor = 0.74512_rk
   values%n_tips = 6
   call checks%is_true(trim(progress_line(values)) == "100%  load 0.74512  step 12  tips 6  "// &
      & "stick 60 slip 30 open 10  L 1.235 m", "mechanics only: "//progress_line(values))

   ! A quiet run shows nothing, on a terminal too.
   call progress%begin(quiet=.true.)
   call progress%show(values)
   call progress%clear()
   call checks%finish()
end program test_output_progress
