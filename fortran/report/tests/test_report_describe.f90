!> docs/output.md is what the table of columns says; its words are those that the files have.
program test_report_describe
   use base_kinds, only: ik
   use base_timers, only: phase_names
   use contact_law, only: state_name
   use report_columns, only: contact_words, event_words, record_keys, status_words
   use report_describe, only: describe_output
   use report_record, only: status_failed, status_finished, status_stopped
   use report_rows, only: event_arrest, event_bifurcation, event_growth, event_growth_onset, &
                          event_joint, event_opening, event_remesh, event_slip_onset, &
                          event_step_cut, event_unstable, event_well, event_window
   use testing_checks, only: checks_t
   use testing_files, only: check_page
   implicit none(type, external)
   type(checks_t) :: checks
   integer(ik) :: i
   integer :: code

   open (newunit=code, status="scratch", action="readwrite")
   call describe_output(code)
   rewind (code)
   call check_page(checks, code, "docs/output.md")
   do i = 1, size(contact_words, kind=ik)
      call checks%is_true(contact_words(i)%word == state_name(i - 1_ik), "the states of contact")
   end do
   call checks%is_true(all(event_words%word == [character(len=16) :: event_slip_onset, &
                                                event_opening, event_growth_onset, &
                                                event_growth, event_joint, &
                                                event_arrest, event_step_cut, &
                                                event_unstable, event_bifurcation, &
                                                event_remesh, event_well, event_window]), &
                       "the kinds of events")
   call checks%is_true(all(status_words%word == [character(len=10) :: status_finished, &
                                                 status_stopped, status_failed]), "how runs end")
   call checks%is_true(all(pack(record_keys%name, record_keys%name(1:9) == "timers_s.") &
                           == "timers_s."//phase_names), "the phases of the timers")
   call checks%finish()
end program test_report_describe
