!> post/wingcrack/names.json is the table of names; its words are those that the files have.
program test_report_describe
   use base_kinds, only: ik
   use base_timers, only: phase_names
   use contact_law, only: state_name
   use report_keys, only: record_keys
   use report_words, only: contact_words, event_words, status_words
   use report_describe, only: description
   use report_record, only: status_failed, status_finished, status_stopped
   use report_rows, only: event_arrest, event_bifurcation, event_growth, event_growth_onset, &
                          event_growth_jump, event_growth_uncertain, &
                          event_joint, event_opening, event_remesh, event_replay, &
                          event_slip_onset, event_step_cut, event_unstable, event_well, event_window
   use testing_checks, only: checks_t
   use testing_files, only: file_text
   implicit none(type, external)
   type(checks_t) :: checks
   integer(ik) :: i
   character(len=1024) :: source
   character(len=:), allocatable :: committed, described

   call get_environment_variable("WINGCRACK_SOURCE", source)
   committed = file_text(trim(source)//"/post/wingcrack/names.json")
   described = description("1.0")
   call checks%is_true(after_version(committed) == after_version(described), "names.json")
   call checks%is_true(len(described) > 60000, "the table is whole")
   do i = 1, size(contact_words, kind=ik)
      call checks%is_true(contact_words(i)%word == state_name(i - 1_ik), "the states of contact")
   end do
   call checks%is_true(all(event_words%word == [character(len=16) :: event_slip_onset, &
                                                event_opening, event_growth_onset, &
                                                event_growth, event_joint, &
                                                event_arrest, event_step_cut, &
                                                event_replay, event_unstable, &
                                                event_bifurcation, &
                                                event_remesh, event_well, &
                                                event_growth_jump, event_growth_uncertain, &
                                                event_window]), &
                       "the kinds of events")
   call checks%is_true(all(status_words%word == [character(len=10) :: status_finished, &
                                                 status_stopped, status_failed]), "how runs end")
   call checks%is_true(all(pack(record_keys%name, record_keys%name(1:9) == "timers_s.") &
                           == "timers_s."//phase_names), "the phases of the timers")
   call checks%finish()

contains

   !> What follows the version, which changes with each release.
   pure function after_version(text) result(rest)
      character(len=*), intent(in) :: text
      character(len=:), allocatable :: rest

      rest = text(index(text, """groups"""):)
   end function after_version

end program test_report_describe
