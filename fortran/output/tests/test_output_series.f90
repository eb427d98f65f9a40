!> Tests of output_series: CSV by RFC 4180, written when flushed, whole.
program test_output_series
   use testing_files, only: file_exists, file_text
   use testing_checks, only: checks_t
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use output_files, only: make_directory, remove_file
   use output_series, only: series_t
   implicit none(type, external)

   character(len=*), parameter :: nl = achar(10)
   character(len=*), parameter :: folder = "test_output_series.out"
   character(len=*), parameter :: path = folder//"/table.csv"
   character(len=*), parameter :: start = "time_s,kind,""odd, name"""//nl//"0.5,slip,3"//nl
   type(checks_t) :: checks
   type(series_t) :: table, closed
   type(error_t), allocatable :: error
   logical :: was_there

   call make_directory(folder, error)
   call remove_file(path, was_there)
   call table%open(path, [character(len=9) :: "time_s", "kind", "odd, name"])
   call table%put(0.5_rk)
   call table%put("slip")
   call table%put(3_ik)
   call table%end_row()
   call checks%is_true(.not. file_exists(path), "nothing is written before a flush")
   call table%flush(error)
   call checks%no_error(error, "flush")
   call checks%is_true(file_text(path) == start, "header and first row")

   call table%put(1.0_rk)
   call table%put('a "b", c')
   call table%put_nothing()
   call table%end_row()
   call table%add_row([0.1_rk, 0.2_rk, 1.0e6_rk])
   call checks%is_true(file_text(path) == start, "rows wait for a flush")
   call table%flush(error)
   call checks%no_error(error, "flush again")
   call checks%is_true(file_text(path) == start//'1.0,"a ""b"", c",'//nl//"0.1,0.2,1000000.0"//nl, &
      & "quotes are doubled, a missing value is empty, reals are short")
   call checks%is_true(table%n_rows == 3, "rows are counted")

   call remove_file(path, was_there)
   call table%flush(error)
   call checks%is_true(.not. file_exists(path), "an unchanged table is not written again")
   call table%add_row([0.1_rk, 0.2_rk])
   call table%flush(error)
   call checks%fails_with(error, "row 4 does not have 3 values", "a short row is refused")

   call closed%flush(error)
   call checks%no_error(error, "a table that was never opened has nothing to write")
   call checks%finish()
end program test_output_series
