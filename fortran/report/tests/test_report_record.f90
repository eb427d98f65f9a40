!> Tests of report_record: run.json has every name of the contract, in its place.
program test_report_record
   use base_errors, only: error_t
   use base_kinds, only: rk
   use base_timers, only: phase_count, phase_names, phase_solve, timers_t
   use report_files, only: make_directory
   use report_record, only: peak_memory_mb, run_record_t, status_failed
   use testing_checks, only: checks_t
   use testing_files, only: file_text
   implicit none(type, external)

   character(len=*), parameter :: folder = "test_report_record.out"
   character(len=*), parameter :: path = folder//"/run.json"
   character(len=*), parameter :: nl = achar(10)
   real(rk), allocatable :: ballast(:)
   real(rk) :: before
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(run_record_t) :: record
   type(timers_t) :: timers
   character(len=:), allocatable :: text
   integer :: i

   call timers%begin()
   call timers%start(phase_solve)
   record%scene = "C2"
   record%version = "0.1.0"
   record%status = status_failed
   record%reason = 'step below its limit at "t = 3 s"'
   record%steps = 21
   record%cells = 2300
   record%fracture_cells = 150
   record%mass_error_relative = 1.5e-12_rk
   record%contact_residual = 2.0e-10_rk
   record%newton_total = 80
   record%newton_max = 9
   record%step_cuts = 2
   call record%count_dofs("displacement", 1)
   call record%count_dofs("pressure", 2300)
   call record%count_dofs("displacement", 4600)
   call record%use_feature("growth")
   call record%leave_out_feature("intersections")
   call record%warn("coarse mesh")
   call record%warn("coarse mesh")
   call make_directory(folder, error)
   call record%write(path, timers, error)
   call checks%no_error(error, "run.json is written")
   text = file_text(path)

   call has('"scene": "C2",'//nl//'  "version": "0.1.0",'//nl//'  "status": "failed",'//nl// &
      & '  "reason": "step below its limit at \"t = 3 s\"",'//nl//'  "steps": 21,'//nl// &
      & '  "cells": 2300,'//nl)
   call has('"dofs": {'//nl//'    "displacement": 4600,'//nl//'    "pressure": 2300'//nl//"  },")
   call has('"used": ['//nl//'    "growth"'//nl//"  ],")
   call has('"left_out": ['//nl//'    "intersections"'//nl//"  ],")
   do i = 1, phase_count
      call has('"'//trim(phase_names(i))//'": ')
   end do
   call has('"cpu_s": ')
   call has('"wall_s": ')
   call has('"peak_memory_mb": ')
   call has('"mass_error_relative": 1.5e-12,')
   call has('"contact_residual": 2e-10,')
   call has('"newton_iterations": {'//nl//'    "total": 80,'//nl//'    "max": 9'//nl//"  },")
   call has('"step_cuts": 2,')
   call has('"warnings": ['//nl//'    "coarse mesh"'//nl//"  ]"//nl//"}"//nl)

   before = peak_memory_mb()
   allocate (ballast(8*1024*1024), source=1.0_rk)  ! 64 MB
   if (before > 0.0_rk) then  ! the system says
      call checks%is_true(peak_memory_mb() >= before + 60.0_rk*ballast(1), "memory taken is seen")
   end if
   deallocate (ballast)
   call checks%finish()

contains

   subroutine has(words)
      character(len=*), intent(in) :: words

      call checks%is_true(index(text, words) > 0, words)
   end subroutine has

end program test_report_record
