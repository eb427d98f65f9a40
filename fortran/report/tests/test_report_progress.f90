!> Tests of report_progress: what the line says, and that it says nothing where nobody looks.
program test_report_progress
   use base_kinds, only: rk
   use report_progress, only: duration_text, progress_line, progress_t, progress_values_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks
   type(progress_t) :: progress
   type(progress_values_t) :: values
   character(len=:), allocatable :: line, log_line

   values = progress_values_t(0.24691_rk, 1234.5678_rk, 12, 60, 30, 10, 1.23456_rk, &
                              [12.3456e6_rk], 0.98765_rk)
   line = progress_line(values, 10.0_rk, 1000)
   call checks%is_true(line == "24%  t 1234.6 s  step 12  31 s left  well 12.35 MPa  "// &
                       "K/K_IC 0.988  L 1.235 m  stick 60 slip 30 open 10", line)
   line = progress_line(values, 10.0_rk, 79)
   call checks%is_true(line == "24%  t 1234.6 s  step 12  31 s left  well 12.35 MPa  "// &
                       "K/K_IC 0.988  L 1.235 m", "what fits a terminal: "//line)
   values%solutions = 7
   call checks%is_true(index(progress_line(values, 10.0_rk, 1000), "next") == 0, &
                       "solutions are not shown where the next state does not take long")
   values%is_slow = .true.
  call checks%is_true(index(progress_line(values, 10.0_rk, 79), "step 12  next: 7 solutions") > 0, &
                       "solutions of a step that takes long")
   values%solutions = 0
   values%is_slow = .false.
   values%well_pressure = [40.0e6_rk, 22.0e6_rk]
   line = progress_line(values, 10.0_rk, 65)
   call checks%is_true(line == "24%  t 1234.6 s  step 12  31 s left  well 40, 22 MPa  "// &
                       "L 1.235 m", line)
   values%well_pressure = 1.0e6_rk*[40.0_rk, 22.0_rk, 31.0_rk, 5.0_rk]
   line = progress_line(values, 10.0_rk, 65)
   call checks%is_true(line == "24%  t 1234.6 s  step 12  31 s left  wells 5 to 40 MPa  "// &
                       "L 1.235 m", line)
   values%well_pressure = [12.3456e6_rk]
   values%share = 0.99999_rk
   call checks%is_true(index(progress_line(values, 1.0_rk, 79), "99%  t") == 1, &
                       "100% only at the end")
   values%share = 1.0_rk
   call checks%is_true(index(progress_line(values, 1.0_rk, 79), "100%  t 1234.6 s  step 12  well") &
                       == 1, "done: nothing is left")
   values%share = 0.0_rk
   call checks%is_true(index(progress_line(values, 1.0_rk, 79), "0%  t 1234.6 s  step 12  well") &
                       == 1, "nobody knows yet how long it takes")

   values = progress_values_t(share=0.5_rk, time=0.74512_rk, step=12, n_open=10, &
                              fracture_length=1.5_rk, is_load=.true.)
   line = progress_line(values, 7200.0_rk, 79)
   call checks%is_true(line == "50%  load 0.74512  step 12  2 h left  L 1.5 m  "// &
                       "stick 0 slip 0 open 10", "mechanics only: "//line)
   call checks%is_true(duration_text(89.0_rk) == "89 s", "seconds")
   call checks%is_true(duration_text(600.0_rk) == "10 min", "minutes")

   ! A quiet run shows nothing, on a terminal too.
   call progress%begin(quiet=.true.)
   call progress%show(values, log_line)
   call checks%is_true(.not. allocated(log_line), "the log has no line so soon")
   call progress%clear()
   call checks%finish()
end program test_report_progress
