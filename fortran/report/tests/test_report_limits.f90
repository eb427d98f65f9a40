!> Limits of a run: verdicts at, above and below them and for what is no number; what is kept of the
!> first and the worst value; tips that are doubtful.
program test_report_limits
   use, intrinsic :: ieee_arithmetic, only: ieee_positive_inf, ieee_quiet_nan, ieee_value
   use base_errors, only: error_t
   use base_kinds, only: rk
   use base_texts, only: text_t
   use growth_tip, only: tip_t
   use report_limits, only: judge, limit_angle, limit_forward_error, limit_mass, limit_t, limits, &
                            verdict_fine, verdict_stop, verdict_warning
   use report_watch, only: doubtful, see_doubt, uncertainty, watch_t, worst_place
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks
   type(error_t), allocatable :: error

   call test_verdicts()
   call test_watch()
   call test_tips()
   call test_doubt()
   call test_worst()
   call checks%finish()

contains

   !> A value at a limit has not passed it.
   subroutine test_verdicts()
      type(limit_t) :: l
      integer :: i

      do i = 1, size(limits)
         l = limits(i)
         associate (outwards => merge(1.001_rk, 0.999_rk, l%stop >= l%warning))
            call checks%is_true(judge(i, l%warning) == verdict_fine, trim(l%name)//": at warning")
            if (abs(l%stop - l%warning) > 0.0_rk) then  ! else nothing is only warned of
               call checks%is_true(judge(i, outwards*l%warning) == verdict_warning, &
                                   trim(l%name)//": past warning")
               call checks%is_true(judge(i, l%stop) == verdict_warning, trim(l%name)//": at stop")
            end if
            call checks%is_true(judge(i, outwards*l%stop) == verdict_stop, &
                                trim(l%name)//": past stop")
            call checks%is_true(judge(i, ieee_value(1.0_rk, ieee_quiet_nan)) == verdict_stop, &
                                trim(l%name)//": no number")
            call checks%is_true(len_trim(l%remedy) > 0 .and. len_trim(l%meaning) > 0, &
                                trim(l%name)//": in words")
         end associate
      end do
      call checks%is_true(judge(limit_mass, ieee_value(1.0_rk, ieee_positive_inf)) &
                          == verdict_stop, "infinite")
      call checks%is_true(judge(limit_mass, 0.0_rk) == verdict_fine, "nothing is fine")
      call checks%is_true(judge(limit_angle, 60.0_rk) == verdict_fine, "a large angle is fine")
   end subroutine test_verdicts

   !> The first value, the worst one, how often; then a stop.
   subroutine test_watch()
      type(watch_t) :: watch
      type(text_t), allocatable :: list(:)

      call watch%see(limit_forward_error, 1.0e-9_rk, "1 s")
      call watch%stop_run(error)
      call checks%no_error(error, "a fine state")
      list = watch%sentences()
      call checks%is_true(size(list) == 0 .and. .not. allocated(watch%news), "no warning")
      call watch%see(limit_forward_error, 2.0e-5_rk, "2 s", [0.5_rk, 1.5_rk])
      call checks%is_true(size(watch%news) == 1, "news")
      call watch%see(limit_forward_error, 3.0e-4_rk, "3 s")
      call watch%see(limit_forward_error, 1.0e-4_rk, "4 s")
      call watch%see(limit_angle, 5.0_rk, "5 s")
      call watch%see(limit_angle, 2.0_rk, "6 s")
      call watch%see(limit_angle, 3.0_rk, "7 s")
      call watch%stop_run(error)
      call checks%no_error(error, "warnings do not stop")
      call checks%is_true(size(watch%news) == 2, "only first ones are news")
      list = watch%sentences()
      call checks%is_true(size(list) == 2, "a sentence for each limit")
      call check_words(list(1)%text, "forward error bound 2e-05 above 1e-06 at 2 s, "// &
                       "(0.5, 1.5) m; in 3 states, the worst 0.0003 at 3 s; ")
      call check_words(list(2)%text, "smallest angle of the mesh 5 degree below 10 at 5 s; "// &
                       "in 3 states, the worst 2 degree at 6 s; ")
      call watch%see(limit_mass, ieee_value(1.0_rk, ieee_quiet_nan), "8 s")
      call watch%see(limit_forward_error, 0.6_rk, "8 s")
      call watch%stop_run(error)
      call checks%fails_with(error, "mass error nan above 0.001 at 8 s", "NaN stops")
   end subroutine test_watch

   subroutine check_words(text, words)
      character(len=*), intent(in) :: text, words

      call checks%is_true(index(text, words) == 1, text//" /= "//words)
   end subroutine check_words

   !> Tips that may not grow again, or whose faces do not move, are not judged.
   subroutine test_tips()
      type(watch_t) :: other, watch
      type(tip_t) :: sheared(2), tips(2)
      type(text_t), allocatable :: list(:)

      tips%intensity%k1 = 1.0e6_rk
      tips%intensity%k1_dc = 1.05e6_rk
      tips(2)%intensity%k1_error = 4.0e4_rk
      call watch%see_tips(tips, 1.0e6_rk, .true., "1 s")
      list = watch%sentences()
      call checks%is_true(size(list) == 0, "good tips")
      ! By both methods the same shear, of either sign; then the other sign by correlation.
      tips%intensity%k2 = [2.0e6_rk, -2.0e6_rk]
      tips%intensity%k2_dc = tips%intensity%k2
      call watch%see_tips(tips, 1.0e6_rk, .true., "1 s")
      list = watch%sentences()
      call checks%is_true(size(list) == 0, "good tips in shear")
      sheared = tips
      sheared%intensity%k1 = 1.5e6_rk
      sheared%intensity%k1_dc = 1.5e6_rk
      sheared(2)%intensity%k2_dc = 2.0e6_rk
      call other%see_tips(sheared, 1.0e6_rk, .true., "1 s")
      list = other%sentences()  ! 4 over hypot(1.5, 2)
      call checks%is_true(size(list) == 1, "one bad tip in shear")
      call checks%is_true(index(list(1)%text, " 1.6 above 0.1 at 1 s, (0, 0) m; ") > 0, &
                          list(1)%text)
      tips%intensity%k2 = 0.0_rk
      tips%intensity%k2_dc = 0.0_rk
      tips(1)%intensity%k1_dc = 2.0e6_rk
      tips(1)%intensity%k2_error = 3.0e5_rk
      tips(1)%arrested = .true.
      call watch%see_tips(tips, 1.0e6_rk, .true., "2 s")
      tips%arrested = .true.
      call watch%see_tips(tips, 1.0e6_rk, .true., "3 s")
      list = watch%sentences()
      call checks%is_true(size(list) == 0, "arrested tips")
      tips%arrested = .false.
      call watch%see_tips(tips, 1.0e6_rk, .true., "4 s")
      list = watch%sentences()
      call checks%is_true(size(list) == 2, "two warnings")
      if (size(list) /= 2) return
      call checks%is_true(index(list(1)%text, " 1 above 0.1 at 4 s, (0, 0) m; ") > 0, list(1)%text)
      call checks%is_true(index(list(2)%text, " 0.3 above 0.05 at 4 s, (0, 0) m; ") > 0, &
                          list(2)%text)
      tips%intensity%k1 = 0.0_rk
      tips%intensity%k1_error = 0.0_rk
      tips%intensity%k2_error = 0.0_rk
      call watch%see_tips(tips, 1.0e6_rk, .false., "5 s")
      list = watch%sentences()
      call checks%is_true(index(list(1)%text, "states") == 0, "faces that do not move")
   end subroutine test_tips

   !> What is not known to 5 % of K_IC is doubtful where K_eq reaches K_IC within it.
   subroutine test_doubt()
      type(watch_t) :: watch
      type(tip_t) :: tips(4)

      tips%drive%intensity = [0.93e6_rk, 0.95e6_rk, 1.0e6_rk, 3.0e6_rk]
      tips%intensity%k1_error = 0.06e6_rk
      tips%intensity%k2_error = 0.01e6_rk
      call checks%is_true(all(doubtful(tips, 1.0e6_rk) &
                              .eqv. [.false., .true., .true., .false.]), "within the error")
      tips(4)%intensity%k2_error = 0.16e6_rk
      call checks%is_true(doubtful(tips(4), 1.0e6_rk), "far above K_IC the share of K_eq counts")
      call checks%is_close(uncertainty(tips(4), 1.0e6_rk), 16.0_rk/3.0_rk, 1.0e-9_rk, "in per cent")
      tips%intensity%k1_error = 0.049e6_rk
      tips(4)%intensity%k2_error = 0.0_rk
      call checks%is_true(.not. any(doubtful(tips, 1.0e6_rk)), "known")
      tips(3)%intensity%k2_error = 0.2e6_rk
      tips(3)%end = 2
      call see_doubt(watch, tips(3), 1.0e6_rk, "f1  ", "8 s")
      call watch%stop_run(error)
      call checks%is_true(.not. allocated(error), "the load of growth is uncertain, and known")
      tips(3)%intensity%k2_error = 1.2e6_rk
      call see_doubt(watch, tips(3), 1.0e6_rk, "f1  ", "9 s")
      call watch%stop_run(error)
    call checks%fails_with(error, "error of K over K_IC where a tip would grow 120 % above 100 "// &
                             "at 9 s, fracture f1, end 2, (0, 0) m; ", "the run stops")
      tips%arrested = .true.
      call checks%is_true(.not. any(doubtful(tips, 1.0e6_rk)), "arrested tips do not grow")
   end subroutine test_doubt

   subroutine test_worst()
      real(rk) :: values(3)

      values = [1.0_rk, 3.0_rk, 2.0_rk]
      call checks%is_true(worst_place(values) == 2, "the largest")
      values(3) = ieee_value(1.0_rk, ieee_quiet_nan)
      call checks%is_true(worst_place(values) == 3, "no number")
   end subroutine test_worst

end program test_report_limits
