!> The journal: rows of tips of which some have grown, and events that are told once.
program test_app_journal
   use app_journal, only: journal_t
   use testing_files, only: file_text
   use testing_checks, only: checks_t
   use base_errors, only: error_t
   use base_kinds, only: rk
   use sample_scenes, only: add_fracture, squeezed_body
   use scene_types, only: scene_t
   use tips_state, only: tip_state_t
   implicit none(type, external)

   type(checks_t) :: checks

   call test_rows_of_tips()
   call test_arrest_is_told_once()
   call checks%finish()

contains

   subroutine open_journal(journal, scene, name)
      type(journal_t), intent(inout) :: journal
      type(scene_t), intent(out) :: scene
      character(len=*), intent(in) :: name
      type(error_t), allocatable :: error

      scene = squeezed_body(20.0e6_rk, 20.0e6_rk)
      scene%name = name
      call add_fracture(scene, "f", [0.8_rk, 1.2_rk], [0.9_rk, 1.1_rk], 1.0_rk, 0.0_rk)
      call journal%open("test_app_journal.out/"//name, .true., scene, error)
      call checks%no_error(error, name//": open")
   end subroutine open_journal

   !> One of two tips has grown by 0.1 m: both rows tell of the state before.
   subroutine test_rows_of_tips()
      type(journal_t) :: journal
      type(scene_t) :: scene
      type(error_t), allocatable :: error
      type(tip_state_t) :: tips(2)
      character(len=:), allocatable :: text

      call open_journal(journal, scene, "tips")
      tips%fracture = 1
      tips(1)%xy = [2.0_rk, 3.0_rk]
      call tips(1)%move([2.1_rk, 3.0_rk], 0.0_rk)
      tips(2)%xy = [4.0_rk, 5.0_rk]
      tips%intensity_before%k1 = [16.0_rk, 17.0_rk]
      tips%intensity%k1 = [26.0_rk, 27.0_rk]
      call journal%tips_done(0.5_rk, tips)
      tips%advance = 0.0_rk
      call journal%tips_done(0.5_rk, tips)
      call journal%files%flush(error)
      call checks%no_error(error, "tips: flush")
      text = file_text("test_app_journal.out/tips/tips.csv")
      call checks%is_true(index(text, "0.5,1,1,2.0,3.0,16.0,") > 0, "grown: where it was")
      call checks%is_true(index(text, "0.5,2,1,4.0,5.0,17.0,") > 0, "beside it: as it was")
      call checks%is_true(index(text, "0.5,1,1,2.1,3.0,26.0,") > 0, "then: where it is")
      call checks%is_true(index(text, "0.5,2,1,4.0,5.0,27.0,") > 0, "beside it: as it is")
   end subroutine test_rows_of_tips

   !> A tip stays arrested; one event and one warning tell of it.
   subroutine test_arrest_is_told_once()
      type(journal_t) :: journal
      type(scene_t) :: scene
      type(error_t), allocatable :: error
      type(tip_state_t) :: tips(1)
      character(len=:), allocatable :: text

      call open_journal(journal, scene, "arrest")
      tips%fracture = 1
      tips(1)%arrest_reason = "next to the outer boundary"
      call journal%growth_done(1.0_rk, scene, tips)
      call journal%growth_done(2.0_rk, scene, tips)
      call journal%files%flush(error)
      call checks%no_error(error, "arrest: flush")
      text = file_text("test_app_journal.out/arrest/events.csv")
      call checks%is_true(index(text, "1.0,arrest") > 0, "the tip stops")
      call checks%is_true(index(text, "2.0,arrest") == 0, "and does not stop again")
   end subroutine test_arrest_is_told_once

end program test_app_journal
