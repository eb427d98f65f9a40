!> Tests of report_series: CSV by RFC 4180, written when flushed, whole.
program test_report_series
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use report_files, only: make_directory, remove_file
   use report_series, only: series_t
   use testing_checks, only: checks_t
   use testing_files, only: file_exists, file_text
   implicit none(type, external)

   character(len=*), parameter :: nl = achar(10)
   character(len=*), parameter :: folder = "test_report_series.out"
   character(len=*), parameter :: path = folder//"/table.csv"
   character(len=*), parameter :: start = "time_s,kind,""odd, name"""//nl//"0.5,slip,3"//nl
   type(checks_t) :: checks
   type(series_t) :: table, closed
   type(error_t), allocatable :: error
   logical :: was_there

   call make_directory(folder, error)
   call remove_file(path, was_there)
   call table%open(path, [character(len=9) :: "time_s", "absent", "kind", "odd, name"], &
                   [.true., .false., .true., .true.])
   call put_row(0.5_rk, "slip")
   call checks%is_true(.not. file_exists(path), "nothing is written before a flush")
   call table%flush(error)
   call checks%no_error(error, "flush")
   call checks%is_true(file_text(path) == start, "header and first row, without what is left out")

   call put_row(1.0_rk, 'a "b", c')
   call table%put("time_s", 1.0e6_rk)
   call table%put("absent")
   call table%put("kind")
   call table%put("odd, name", 0.1_rk)
   call table%end_row()
   call checks%is_true(file_text(path) == start, "rows wait for a flush")
   call table%flush(error)
   call checks%no_error(error, "flush again")
   call checks%is_true(file_text(path) == start//'1.0,"a ""b"", c",3'//nl//"1000000.0,,0.1"//nl, &
      & "quotes are doubled, a missing value is empty, reals are short")
   call checks%is_true(table%n_rows == 3, "rows are counted")

   call remove_file(path, was_there)
   call table%flush(error)
   call checks%is_true(.not. file_exists(path), "an unchanged table is not written again")

   call table%put("time_s", 2.0_rk)
   call table%end_row()
   call table%flush(error)
   call checks%fails_with(error, "row 4 ends in place of absent", "a short row is refused")
   call table%open(path, ["time_s", "kind  "], [.true., .true.])
   call table%put("kind", "slip")
   call table%flush(error)
   call checks%fails_with(error, "row 1 has kind in place of time_s", "another order is refused")
   call table%open(path, ["time_s"], [.true.])
   call table%put("time_s", 2.0_rk)
   call table%put("time_s", 2.0_rk)
   call table%flush(error)
   call checks%fails_with(error, "row 1 goes on with time_s in place of its end", &
                          "a long row is refused")

   call closed%flush(error)
   call checks%no_error(error, "a table that was never opened has nothing to write")
   call checks%finish()

contains

   subroutine put_row(time, kind)
      real(rk), intent(in) :: time  !< [s]
      character(len=*), intent(in) :: kind

      call table%put("time_s", time)
      call table%put("absent", 7.0_rk)
      call table%put("kind", kind)
      call table%put("odd, name", 3_ik)
      call table%end_row()
   end subroutine put_row

end program test_report_series
