!> One line on a terminal that says how far the run is, renewed in place; elsewhere nothing.
module output_progress
   use base_kinds, only: ik, lk, rk
   use base_number, only: brief_text, integer_text
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: error_unit
   implicit none(type, external)
   private

   public :: progress_line, progress_t, progress_values_t

   integer, parameter :: line_width = 79  !< fits a terminal of 80 columns
   integer(c_int), parameter :: standard_error = 2_c_int  !< POSIX file descriptor of error_unit
   real(rk), parameter :: smallest_pause = 0.1_rk  !< between two renewals [s]

   !> What the line shows.
   type :: progress_values_t
      real(rk) :: time = 0.0_rk  !< [s]
      real(rk) :: time_end = 0.0_rk  !< [s]
      integer(ik) :: step = 0
      integer(ik) :: newton_iterations = 0  !< of the last step
      integer(ik) :: n_stick = 0
      integer(ik) :: n_slip = 0
      integer(ik) :: n_open = 0
      real(rk) :: fracture_length = 0.0_rk  !< [m]
      logical :: is_load = .false.  !< mechanics only: the load factor and the tips are shown
      real(rk) :: load_factor = 0.0_rk  !< [-]
      integer(ik) :: n_tips = 0
   end type progress_values_t

   !> The line and when it was last renewed.
   type :: progress_t
      private
      logical :: is_shown = .false.
      logical :: has_line = .false.  !< the cursor stands behind a line of ours
      integer(lk) :: last = 0_lk  !< clock ticks
      real(rk) :: ticks_per_second = 1.0_rk
   contains
      procedure :: begin
      procedure :: show
      procedure :: clear
   end type progress_t

   interface
      !> POSIX isatty: 1 for a terminal.
      function c_isatty(descriptor) result(answer) bind(C, name="isatty")
         import :: c_int
         implicit none(type, external)
         integer(c_int), value, intent(in) :: descriptor
         integer(c_int) :: answer
      end function c_isatty
   end interface

contains

   !> Begin; the line is shown on a terminal only, and not if it shall be quiet.
   subroutine begin(self, quiet)
      class(progress_t), intent(out) :: self
      logical, intent(in) :: quiet
      integer(lk) :: rate

      call system_clock(count_rate=rate)
      self%ticks_per_second = real(rate, rk)
      if (.not. quiet) self%is_shown = c_isatty(standard_error) == 1_c_int
   end subroutine begin

   !> Renew the line, unless that was done just now.
   subroutine show(self, values)
      class(progress_t), intent(inout) :: self
      type(progress_values_t), intent(in) :: values
      integer(lk) :: now
      real(rk) :: age  ! of the line [s]

      if (.not. self%is_shown) return
      call system_clock(now)
      age = real(now - self%last, rk)/self%ticks_per_second
      if (self%has_line .and. age < smallest_pause) return
      self%last = now
      self%has_line = .true.
      write (error_unit, "(a)", advance="no") achar(13)//progress_line(values)
      flush (error_unit)
   end subroutine show

   !> Take the line away, so that other text can follow.
   subroutine clear(self)
      class(progress_t), intent(inout) :: self

      if (.not. self%has_line) return
      write (error_unit, "(a)", advance="no") achar(13)//repeat(" ", line_width)//achar(13)
      flush (error_unit)
      self%has_line = .false.
   end subroutine clear

   !> The line, padded to its full width so that it covers the one before.
   pure function progress_line(values) result(line)
      type(progress_values_t), intent(in) :: values
      character(len=line_width) :: line
      character(len=:), allocatable :: place, more
      real(rk) :: share

      share = 0.0_rk
      if (values%time_end > 0.0_rk) share = 100.0_rk*min(values%time/values%time_end, 1.0_rk)
      place = "t "//brief_text(values%time, 5)//" s"
      more = "Newton "//integer_text(values%newton_iterations)
      if (values%is_load) then
         place = "load "//brief_text(values%load_factor, 5)
         more = "tips "//integer_text(values%n_tips)
      end if
      line = integer_text(int(share, ik))//"%  "//place//"  step "//integer_text(values%step)// &
             "  "//more//"  stick "//integer_text(values%n_stick)//" slip "// &
             integer_text(values%n_slip)//" open "//integer_text(values%n_open)//"  L "// &
             brief_text(values%fracture_length, 4)//" m"
   end function progress_line

end module output_progress
