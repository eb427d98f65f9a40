!> Tests of report_record: what is said when a run is over.
program test_report_closing
   use base_kinds, only: ik, rk
   use base_texts, only: text_t
   use report_record, only: closing_lines, run_record_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks
   type(run_record_t) :: record
   type(text_t), allocatable :: lines(:)

   record%status = "finished"
   record%reason = "the scene's end time"
   record%steps = 12
   lines = closing_lines(record, "18000 s", 0.0_rk, 0.0_rk, 3.2_rk, "out/a")
   call expect([character(len=100) :: "finished: the scene's end time", &
                "reached 18000 s in 12 steps, 3 s", "results in out/a"], "a body without fractures")

   record%steps = 1
   record%has_growth = .true.
   record%increments = 3
   record%keq_over_kic = 1.00004_rk
   call record%warn("something odd")  ! which the terminal has said before
   lines = closing_lines(record, "load factor 0.9", 0.25_rk, 0.05_rk, 600.0_rk, "b")
   call expect([character(len=100) :: "finished: the scene's end time", &
                "reached load factor 0.9 in 1 step and 3 increments of growth, 10 min", &
                "fractures are 0.25 m long, of which 0.05 m have grown", &
                "largest K_eq/K_IC 1", "results in b"], "growth")
   call checks%finish()

contains

   !> The lines are these.
   subroutine expect(wanted, name)
      character(len=*), intent(in) :: wanted(:)
      character(len=*), intent(in) :: name
      integer(ik) :: i

      call checks%is_true(size(lines) == size(wanted), name//": number of lines")
      do i = 1, min(size(lines), size(wanted))
         call checks%is_true(lines(i)%text == trim(wanted(i)), name//": "//lines(i)%text)
      end do
   end subroutine expect

end program test_report_closing
