!> What a run was, in plain words, when it is over: the last lines on the terminal.
module output_closing
   use base_kinds, only: ik, rk
   use base_number, only: brief_text, integer_text
   use base_texts, only: add_text, text_t
   use output_progress, only: duration_text
   use output_record, only: run_record_t
   implicit none(type, external)
   private

   public :: closing_lines

contains

   !> The lines, one thought each. Warnings stand elsewhere (app_warnings).
   function closing_lines(record, last_state, length, gain, seconds, directory) result(lines)
      type(run_record_t), intent(in) :: record
      character(len=*), intent(in) :: last_state  !< a time or load factor in words
      real(rk), intent(in) :: length  !< of all fractures at the end [m]
      real(rk), intent(in) :: gain  !< of it grown in the run [m]
      real(rk), intent(in) :: seconds  !< wall time of the run [s]
      character(len=*), intent(in) :: directory  !< where the results are
      type(text_t), allocatable :: lines(:)
      character(len=:), allocatable :: line

      call add_text(lines, record%status//": "//record%reason)
      line = "reached "//last_state//" in "//counted(record%steps, "step")
      if (record%has_growth) line = line//" and "//counted(record%increments, "increment")// &
                                    " of growth"
      call add_text(lines, line//", "//duration_text(seconds))
      if (length > 0.0_rk) then
         line = "fractures are "//brief_text(length, 4)//" m long"
         if (gain > 0.0_rk) line = line//", of which "//brief_text(gain, 4)//" m have grown"
         if (.not. gain > 0.0_rk) line = line//"; nothing has grown"
         call add_text(lines, line)
      end if
      if (record%keq_over_kic > 0.0_rk) then
         call add_text(lines, "largest K_eq/K_IC "//brief_text(record%keq_over_kic, 4))
      end if
      call add_text(lines, "results in "//directory)
   end function closing_lines

   !> A number of things.
   pure function counted(n, thing) result(words)
      integer(ik), intent(in) :: n
      character(len=*), intent(in) :: thing  !< one of them
      character(len=:), allocatable :: words

      words = integer_text(n)//" "//thing
      if (n /= 1) words = words//"s"
   end function counted

end module output_closing
