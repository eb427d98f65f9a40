!> Growth by jumps: tips that advance without equilibrium until they arrest.
!!
!! The time of a jump has an error: that of K_eq over the rate of K_eq where the tip was at rest, or
!! that of its position over its speed where it grew in equilibrium. Until this time has passed
!! after a jump, it may not yet have happened; and a tip at rest that has jumped before may jump
!! again as soon as K_eq equals K_IC within its error, by the load of the faces too. In both cases
!! the length of the jump is part of the error of the position.
!!
!! A tip that grows in equilibrium rests now and then, as K_eq falls along a path segment and rises
!! with the next one by up to 1 % of K_IC. The slope within a segment is steeper than that over
!! many, by which an error of K_eq changes the position. The rate of K_eq at rest shows the latter:
!! the error of K_eq over that rate is one of the time, and what the tip has grown within half of it
!! one of the position. Near the end of stable growth the tips grow faster, and so does this error:
!! then a jump may be ahead.
module twolevel_jumps
   use, intrinsic :: iso_c_binding, only: c_loc
   use base_archive, only: archive_t
   use base_kinds, only: ik, lk, rk
   use base_number, only: brief_text
   use growth_tip, only: tip_t
   use report_rows, only: chronicle_t, event_growth_jump, summary_t
   use twolevel_moves, only: tolerance
   use twolevel_onset, only: approach_t
   implicit none(type, external)
   private

   public :: jumps_t

   integer, parameter :: memory = 100  !< states in which the growth is remembered

   !> Last jump of each tip, and the present rest.
   type :: jumps_t
      real(rk), allocatable, private :: length(:)  !< (tips) of the last jump, 0: none [m]
      real(rk), allocatable, private :: remaining(:)  !< (tips) error of its time that is left [s]
      type(approach_t), allocatable, private :: rest(:)  !< (tips) K_eq since the last growth
      real(rk), allocatable, private :: speed(:)  !< (tips) in equilibrium in the last step [m/s]
      real(rk), allocatable, private :: late(:)  !< (tips) error of the position over the speed [s]
      logical, allocatable, private :: jumps(:)  !< (tips) the tip has jumped in this step
      !> (tips) mean rate of K_eq at rest, over the scale of K_IC; 0: not known [1/s]
      real(rk), allocatable, private :: rate(:)
      ! The last states, the latest one first:
      real(rk), private :: times(memory) = -huge(1.0_rk)  !< [s]
      real(rk), allocatable, private :: grown(:, :)  !< (tips, states) growth [m]
   contains
      procedure :: begin
      procedure :: note
      procedure :: follow
      procedure :: visit
   end type jumps_t

contains

   !> Start before any growth.
   subroutine begin(self, n)
      class(jumps_t), intent(out) :: self
      integer, intent(in) :: n  !< tips

      allocate (self%length(n), self%remaining(n), self%speed(n), self%late(n), self%rate(n), &
                source=0.0_rk)
      allocate (self%grown(n, memory), source=0.0_rk)
      allocate (self%jumps(n), source=.false.)
      allocate (self%rest(n))
   end subroutine begin

   !> Report a step without equilibrium: the tips that have advanced in it, from where, how far, and
   !! the change of the well pressure.
   subroutine note(self, tips, from, toughness, pressure, time, chronicle, summary)
      class(jumps_t), intent(inout) :: self
      type(tip_t), intent(in) :: tips(:)
      real(rk), intent(in) :: from(:, :)  !< (2, tips) positions before the step [m]
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      real(rk), intent(in) :: pressure(2)  !< well pressure before and after the step [Pa]
      real(rk), intent(in) :: time  !< [s]
      type(chronicle_t), intent(inout) :: chronicle
      type(summary_t), intent(inout) :: summary
      character(len=:), allocatable :: certainty
      real(rk) :: error
      integer(ik) :: i

      if (.not. any(tips%advance > 0.0_rk)) return
      summary%growth_jumps = summary%growth_jumps + 1
      summary%longest_jump = max(summary%longest_jump, maxval(tips%advance))
      do i = 1, size(tips, kind=ik)
         associate (tip => tips(i))
            if (.not. tip%advance > 0.0_rk) cycle
            error = self%rest(i)%uncertainty(tolerance*tip%scale_of(toughness))
            if (self%speed(i) > 0.0_rk) error = self%late(i)
            certainty = "time known to "//brief_text(error, 3)//" s"
           if (.not. error < huge(1.0_rk)) certainty = "time error unknown: K_eq was not increasing"
            call chronicle%add_event(time, event_growth_jump, "grows by "// &
                                     brief_text(tip%advance, 4)//" m at once; well pressure "// &
                                     brief_text(pressure(1), 5)//" Pa before, "// &
                                     brief_text(pressure(2), 5)//" Pa after; "//certainty, &
                                     tip%fracture, from(:, i))
            self%jumps(i) = .true.
            self%length(i) = tip%advance
            self%remaining(i) = merge(error, 0.0_rk, error < huge(1.0_rk))
         end associate
      end do
   end subroutine note

   !> Take an accepted state at the end of a step of length dt; the errors of the positions by
   !! jumps, and by that of the time [m].
   pure subroutine follow(self, tips, toughness, position_error, dt, time, error, by_time, &
                          load_errors)
      class(jumps_t), intent(inout) :: self
      type(tip_t), intent(in) :: tips(:)
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      real(rk), intent(in) :: position_error(:)  !< (tips) without jumps [m]
      real(rk), intent(in) :: dt, time  !< [s]
      real(rk), intent(out) :: error(:), by_time(:)  !< (tips) [m]
      !> (2, tips) of K_I, K_II, by the load of the faces; default: 0 [Pa m^1/2]
      real(rk), intent(in), optional :: load_errors(:, :)
      real(rk), dimension(size(tips)) :: late, new, uncertainty
      logical :: rests(size(tips))

      rests = .not. tips%advance > 0.0_rk
      uncertainty = hypot(tips%intensity%k1_error, tips%intensity%k2_error)/tips%drive%resistance
      where (rests) self%remaining = max(0.0_rk, self%remaining - dt)
      where (.not. rests) self%rest = approach_t()
      self%speed = 0.0_rk
      if (dt > 0.0_rk) where (.not. (rests .or. self%jumps)) self%speed = tips%advance/dt
      self%jumps = .false.
      call self%rest%follow(time, tips%drive%intensity, uncertainty, toughness)
      new = self%rest%drive%rate/tips%scale_of(toughness)
      where (rests .and. new > 0.0_rk .and. self%grown(:, 1) > 0.0_rk)
         self%rate = merge(0.5_rk*(self%rate + new), new, self%rate > 0.0_rk)
      end where
      late = 0.0_rk
      where (self%rate > 0.0_rk) late = (tolerance + uncertainty/tips%scale_of(toughness))/self%rate
      where (self%speed > 0.0_rk) self%late = max(position_error/self%speed, late)
      self%times = [time, self%times(:memory - 1)]
      self%grown = reshape([self%grown(:, 1) + tips%advance, self%grown(:, :memory - 1)], &
                           shape(self%grown))
      by_time = self%grown(:, 1) - grown_before(self, time - 0.5_rk*late)
      error = 0.0_rk
      if (present(load_errors)) uncertainty = uncertainty + norm2(load_errors, dim=1) &
                                              /tips%drive%resistance
      where (self%remaining > 0.0_rk .or. &
             (rests .and. .not. tips%arrested .and. &
              tips%drive%intensity + uncertainty >= toughness)) error = self%length
   end subroutine follow

   !> Store or load all components.
   subroutine visit(self, archive)
      class(jumps_t), intent(inout), target :: self
      type(archive_t), intent(inout) :: archive
      integer(lk) :: n

      call archive%list("length", self%length, "tips")
      call archive%list("remaining", self%remaining, "tips")
      call archive%extent("rest", self%rest, n, "tips ?")
      if (archive%is_loading) then
         if (allocated(self%rest)) deallocate (self%rest)
         if (n >= 0_lk) allocate (self%rest(n))
      end if
      if (n > 0_lk) call archive%plain("rest", c_loc(self%rest), n*storage_size(self%rest)/8_lk)
      call archive%list("speed", self%speed, "tips")
      call archive%list("late", self%late, "tips")
      call archive%list("jumps", self%jumps, "tips")
      call archive%list("rate", self%rate, "tips")
      call archive%plain("times", c_loc(self%times), memory*storage_size(self%times)/8_lk)
      call archive%list("grown", self%grown, "tips, states")
   end subroutine visit

   !> Growth of each tip until its time, as far as it is remembered [m].
   pure function grown_before(self, time) result(grown)
      class(jumps_t), intent(in) :: self
      real(rk), intent(in) :: time(:)  !< (tips) [s]
      real(rk) :: grown(size(time))
      real(rk) :: share
      integer :: i, k

      do i = 1, size(time)
         k = count(self%times > time(i))
         if (k == 0 .or. k == memory) then
            grown(i) = self%grown(i, max(1, k))
         else
            share = (time(i) - self%times(k + 1))/(self%times(k) - self%times(k + 1))
            grown(i) = self%grown(i, k + 1) + share*(self%grown(i, k) - self%grown(i, k + 1))
         end if
      end do
   end function grown_before

end module twolevel_jumps
