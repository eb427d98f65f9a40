!> Progress of a run: one line on a terminal, updated in place, and at intervals a line of the log,
!! which is also written to stderr if that is no terminal.
module report_progress
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: error_unit
   use base_kinds, only: ik, lk, rk
   use base_number, only: brief_text, integer_text
   implicit none(type, external)
   private

   public :: duration_text, progress_line, progress_t, progress_values_t

   integer, parameter :: line_width = 79  !< fits a terminal of 80 columns
   integer(c_int), parameter :: standard_error = 2_c_int  !< POSIX file descriptor of error_unit
   real(rk), parameter :: smallest_pause = 0.1_rk  !< shortest time between two updates [s]
   real(rk), parameter :: log_pause = 10.0_rk  !< time between two lines of the log [s]

   !> Values of the line.
   type :: progress_values_t
      real(rk) :: share = 0.0_rk  !< completed fraction of the run [-]
      real(rk) :: time = 0.0_rk  !< [s]; mechanics only: the load factor [-]
      integer(ik) :: step = 0
      integer(ik) :: n_stick = 0
      integer(ik) :: n_slip = 0
      integer(ik) :: n_open = 0
      real(rk) :: fracture_length = 0.0_rk  !< [m]
      real(rk), allocatable :: well_pressure(:)  !< (wells) [Pa]
      real(rk) :: keq_over_kic = 0.0_rk  !< largest of the present tips; 0: omitted [-]
      logical :: is_load = .false.  !< `time` is a load factor
      integer(ik) :: solutions = 0  !< number of tries for the next state so far
      logical :: is_slow = .false.  !< the next state takes long
   end type progress_values_t

   !> The progress line and its last update.
   type :: progress_t
      private
      logical :: is_quiet = .true.
      logical :: is_terminal = .false.
      logical :: has_line = .false.  !< the line is on the terminal
      integer(lk) :: first = 0_lk  !< clock at the beginning [ticks]
      integer(lk) :: last = 0_lk  !< clock at the last update [ticks]
      integer(lk) :: last_logged = 0_lk  !< clock at the last line of the log [ticks]
      integer(lk) :: last_state = 0_lk  !< clock when the present state was accepted [ticks]
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

   !> Begin; with quiet nothing is written to the terminal or to stderr.
   subroutine begin(self, quiet)
      class(progress_t), intent(out) :: self
      logical, intent(in) :: quiet
      integer(lk) :: rate

      call system_clock(self%first, rate)
      self%ticks_per_second = real(rate, rk)
      self%last_logged = self%first
      self%last_state = self%first
      self%is_quiet = quiet
      self%is_terminal = c_isatty(standard_error) == 1_c_int
   end subroutine begin

   !> Update the line, unless the last update was just before.
   subroutine show(self, values, log_line)
      class(progress_t), intent(inout) :: self
      type(progress_values_t), intent(in) :: values
      character(len=:), allocatable, intent(out) :: log_line  !< line for the log, if one is due
      integer(lk) :: now
      real(rk) :: elapsed  ! since the beginning [s]
      type(progress_values_t) :: shown

      call system_clock(now)
      elapsed = real(now - self%first, rk)/self%ticks_per_second
      if (values%solutions == 0) self%last_state = now
      shown = values
      shown%is_slow = real(now - self%last_state, rk)/self%ticks_per_second >= log_pause
      if (real(now - self%last_logged, rk)/self%ticks_per_second >= log_pause) then
         self%last_logged = now
         log_line = progress_line(shown, elapsed, huge(1))
         if (.not. (self%is_quiet .or. self%is_terminal)) then
            write (error_unit, "(a)") log_line
            flush (error_unit)
         end if
      end if
      if (self%is_quiet .or. .not. self%is_terminal) return
    if (self%has_line .and. real(now - self%last, rk)/self%ticks_per_second < smallest_pause) return
      self%last = now
      self%has_line = .true.
      write (error_unit, "(a)", advance="no") &
         achar(13)//padded(progress_line(shown, elapsed, line_width))
      flush (error_unit)
   end subroutine show

   !> Remove the line, so that other text can follow.
   subroutine clear(self)
      class(progress_t), intent(inout) :: self

      if (.not. self%has_line) return
      write (error_unit, "(a)", advance="no") achar(13)//padded("")//achar(13)
      flush (error_unit)
      self%has_line = .false.
   end subroutine clear

   !> The line: as many values as fit into the width, the most important first.
   pure function progress_line(values, elapsed, width) result(line)
      type(progress_values_t), intent(in) :: values
      real(rk), intent(in) :: elapsed  !< wall time so far [s]
      integer, intent(in) :: width  !< largest number of characters
      character(len=:), allocatable :: line
      real(rk) :: share
      integer(ik), parameter :: many = 50  ! solutions, which a step rarely needs
      real(rk), parameter :: first_guess = 0.01_rk  ! smallest share with a time left

      share = min(max(values%share, 0.0_rk), 1.0_rk)
      line = integer_text(int(100.0_rk*share, ik))//"%"
      if (values%is_load) then
         call add("load "//brief_text(values%time, 5))
      else
         call add("t "//brief_text(values%time, 5)//" s")
      end if
      call add("step "//integer_text(values%step))
      if (values%is_slow .or. values%solutions > many) then
         call add("next: "//integer_text(values%solutions)//" solutions")
      end if
      if (share >= first_guess .and. share < 1.0_rk) then
         call add(duration_text(elapsed*(1.0_rk - share)/share)//" left")
      end if
      if (allocated(values%well_pressure)) then
         if (size(values%well_pressure) > 0) call add(well_text(values%well_pressure))
      end if
      if (values%keq_over_kic > 0.0_rk) call add("K/K_IC "//brief_text(values%keq_over_kic, 3))
      call add("L "//brief_text(values%fracture_length, 4)//" m")
      call add("stick "//integer_text(values%n_stick)//" slip "//integer_text(values%n_slip)// &
               " open "//integer_text(values%n_open))

   contains

      !> Add a part of the line, if it fits.
      pure subroutine add(part)
         character(len=*), intent(in) :: part

         if (len(line) + 2 + len(part) <= width) line = line//"  "//part
      end subroutine add

   end function progress_line

   !> The pressures of all wells, or of more than three the lowest and the highest.
   pure function well_text(pressure) result(text)
      real(rk), intent(in) :: pressure(:)  !< at least one [Pa]
      character(len=:), allocatable :: text
      integer :: w

      if (size(pressure) > 3) then
         text = "wells "//megapascals(minval(pressure))//" to "//megapascals(maxval(pressure))
      else
         text = "well "//megapascals(pressure(1))
         do w = 2, size(pressure)
            text = text//", "//megapascals(pressure(w))
         end do
      end if
      text = text//" MPa"
   end function well_text

   !> A pressure in MPa.
   pure function megapascals(pressure) result(text)
      real(rk), intent(in) :: pressure  !< [Pa]
      character(len=:), allocatable :: text

      text = brief_text(1.0e-6_rk*pressure, 4)
   end function megapascals

   !> A duration in words: `8 s`, `12 min`, `3.5 h`.
   pure function duration_text(seconds) result(text)
      real(rk), intent(in) :: seconds  !< [s]
      character(len=:), allocatable :: text

      if (seconds < 90.0_rk) then
         text = integer_text(nint(seconds, ik))//" s"
      else if (seconds < 5400.0_rk) then
         text = integer_text(nint(seconds/60.0_rk, ik))//" min"
      else
         text = brief_text(seconds/3600.0_rk, 3)//" h"
      end if
   end function duration_text

   !> A text with blanks after it, so that it covers the previous line.
   pure function padded(text) result(line)
      character(len=*), intent(in) :: text
      character(len=line_width) :: line

      line = text
   end function padded

end module report_progress
