!> Monitors the limits of a run: which were exceeded, when and where first, and by how much; also
!! tips whose intensities are not accurate enough for growth.
!!
!! Growth in equilibrium depends on whether K_eq reaches K_IC. If K_eq of a tip may reach K_IC,
!! within the error of its intensities, that error must be below a fraction of K_IC (report_limits).
module report_watch
   use base_archive, only: archive_t
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_number, only: brief_text, integer_text, place_text
   use base_texts, only: add_text, text_t
   use growth_tip, only: tip_t
   use report_limits, only: judge, limit_k_error, limit_k_methods, limit_k_to_grow, limits, &
                            verdict_fine, verdict_stop
   implicit none(type, external)
   private

   public :: doubtful, error_of_k, see_doubt, uncertainty, watch_t, worst_place

   integer, parameter :: digits = 4  !< digits of numbers in sentences

   !> Record of a limit that was exceeded.
   type :: record_t
      integer(ik) :: states = 0  !< number of states in which it was exceeded
      real(rk) :: first = 0.0_rk, worst = 0.0_rk  !< first and worst value, in the limit's unit
      character(len=:), allocatable :: first_at, worst_at  !< time and place of these, in words
   end type record_t

   !> All limits of one run.
   type :: watch_t
      type(record_t), private :: records(size(limits))
      integer, private :: stopped_by = 0  !< index of the limit that stops the run; 0: none
      type(text_t), allocatable :: news(:)  !< sentences about limits exceeded for the first time
   contains
      procedure :: see
      procedure :: see_tips
      procedure :: stop_run
      procedure :: sentences
      procedure :: visit
   end type watch_t

   !> Largest derivative of K_eq with respect to an intensity: with respect to K_II at K_I = 0 [-].
   real(rk), parameter :: steepest = 2.0_rk/sqrt(3.0_rk)

contains

   !> Check a value of the present state against its limit.
   pure subroutine see(self, limit, value, when, xy)
      class(watch_t), intent(inout) :: self
      integer, intent(in) :: limit  !< index into the table of limits
      real(rk), intent(in) :: value  !< in the limit's unit
      character(len=*), intent(in) :: when  !< "3600 s", "load factor 0.5"
      real(rk), intent(in), optional :: xy(2)  !< position [m]
      character(len=:), allocatable :: at
      integer :: verdict
      logical :: is_worst

      verdict = judge(limit, value)
      if (verdict == verdict_fine) return
      at = "at "//when
      if (present(xy)) at = at//", "//place_text(xy)
      associate (record => self%records(limit))
         record%states = record%states + 1
         is_worst = .not. value <= record%worst
         if (limits(limit)%stop < limits(limit)%warning) is_worst = .not. value >= record%worst
         if (record%states == 1 .or. is_worst) then
            record%worst = value
            record%worst_at = at
         end if
         if (record%states == 1) then
            record%first = value
            record%first_at = at
            call add_text(self%news, sentence(limit, record))
         end if
      end associate
      if (verdict == verdict_stop .and. self%stopped_by == 0) self%stopped_by = limit
   end subroutine see

   !> Check the stress intensity factors of all tips against their limits.
   pure subroutine see_tips(self, tips, toughness, may_grow, when, least)
      class(watch_t), intent(inout) :: self
      type(tip_t), intent(in) :: tips(:)
      real(rk), intent(in) :: toughness  !< K_IC [Pa m^1/2]
      logical, intent(in) :: may_grow  !< the scene lets tips grow
      character(len=*), intent(in) :: when
      real(rk), intent(in), optional :: least  !< a smaller K is none [Pa m^1/2]
      real(rk) :: difference(size(tips)), errors(size(tips)), scale
      integer(ik) :: i

      if (all(tips%arrested)) return
      associate (k => tips%intensity)
         ! If the faces do not move next to the tip, K is 0, and round-off by correlation.
         difference = merge(0.0_rk, hypot(k%k1 - k%k1_dc, k%k2 - k%k2_dc), &
                            tips%arrested .or. hypot(k%k1, k%k2) <= 0.0_rk)
         errors = merge(0.0_rk, tips%relative_error(toughness), tips%arrested)
         scale = maxval(hypot(k%k1, k%k2), mask=.not. tips%arrested)
      end associate
      if (may_grow) scale = max(scale, toughness)
      if (present(least)) scale = max(scale, least)
      i = worst_place(difference)
      if (.not. difference(i) <= 0.0_rk) then
         call self%see(limit_k_methods, difference(i)/scale, when, tips(i)%xy)
      end if
      if (.not. may_grow) return
      i = worst_place(errors)
      call self%see(limit_k_error, errors(i), when, tips(i)%xy)
   end subroutine see_tips

   !> Raise an error if a limit stops the run.
   pure subroutine stop_run(self, error)
      class(watch_t), intent(in) :: self
      type(error_t), allocatable, intent(out) :: error

      if (self%stopped_by == 0) return
      call raise_error(error, "", "a limit of the run is exceeded: "// &
                       passed(self%stopped_by, self%records(self%stopped_by)%worst, &
                              limits(self%stopped_by)%stop)// &
                       " "//self%records(self%stopped_by)%worst_at//"; "// &
                       trim(limits(self%stopped_by)%remedy)//" (see docs/limits.md)")
   end subroutine stop_run

   !> A sentence for each limit that was exceeded in the run.
   pure function sentences(self) result(list)
      class(watch_t), intent(in) :: self
      type(text_t), allocatable :: list(:)
      integer :: i

      allocate (list(0))
      do i = 1, size(limits)
         if (self%records(i)%states > 0) call add_text(list, sentence(i, self%records(i)))
      end do
   end function sentences

   !> Sentence about a limit: the first value, the worst one of several, and the remedy.
   pure function sentence(limit, record) result(text)
      integer, intent(in) :: limit
      type(record_t), intent(in) :: record
      character(len=:), allocatable :: text

      text = passed(limit, record%first, limits(limit)%warning)//" "//record%first_at
      if (record%states > 1) then
         text = text//"; in "//integer_text(record%states)//" states, the worst "// &
                value_text(limit, record%worst)//" "//record%worst_at
      end if
      text = text//"; "//trim(limits(limit)%remedy)//" (see docs/limits.md)"
   end function sentence

   !> Clause about a value beyond a limit.
   pure function passed(limit, value, bound) result(text)
      integer, intent(in) :: limit
      real(rk), intent(in) :: value, bound  !< in the limit's unit
      character(len=:), allocatable :: text

      text = trim(limits(limit)%name)//" "//value_text(limit, value)// &
             merge(" below ", " above ", limits(limit)%stop < limits(limit)%warning)// &
             brief_text(bound, digits)
   end function passed

   !> A value with the limit's unit.
   pure function value_text(limit, value) result(text)
      integer, intent(in) :: limit
      real(rk), intent(in) :: value  !< in the limit's unit
      character(len=:), allocatable :: text

      text = brief_text(value, digits)
      if (limits(limit)%unit /= "-") text = text//" "//trim(limits(limit)%unit)
   end function value_text

   !> Index of the largest value, or of the first NaN.
   pure integer(ik) function worst_place(values) result(i)
      real(rk), intent(in) :: values(:)  !< at least one

      i = findloc(values <= huge(1.0_rk), .false., dim=1, kind=ik)
      if (i == 0) i = maxloc(values, dim=1, kind=ik)
   end function worst_place

   !> Estimated error of the intensities of a tip over K_IC, or over K_eq if that is larger: then
   !! the tip grows, and only its direction is uncertain [%].
   elemental real(rk) function uncertainty(tip, toughness)
      type(tip_t), intent(in) :: tip
      real(rk), intent(in) :: toughness  !< K_IC [Pa m^1/2]

      uncertainty = 100.0_rk*error_of_k(tip)/max(toughness*tip%viscous_rise, tip%drive%intensity)
   end function uncertainty

   !> Estimated error of the intensities without the part that decreases in the following steps [Pa
   !! m^1/2].
   elemental real(rk) function error_of_k(tip)
      type(tip_t), intent(in) :: tip

      associate (k => tip%intensity)
         error_of_k = (max(k%k1_error, k%k2_error) - k%passing_error)/tip%drive%resistance
      end associate
   end function error_of_k

   !> K_eq of a tip may reach K_IC within its error, and that error is too large for growth.
   elemental logical function doubtful(tip, toughness)
      type(tip_t), intent(in) :: tip
      real(rk), intent(in) :: toughness  !< K_IC [Pa m^1/2]

      doubtful = .not. tip%arrested .and. &
                 judge(limit_k_to_grow, uncertainty(tip, toughness)) /= verdict_fine
      if (doubtful) doubtful = .not. tip%drive%intensity + steepest*error_of_k(tip) < toughness
   end function doubtful

   !> Report a tip whose intensities are uncertain where it grows to the limit of the run.
   pure subroutine see_doubt(watch, tip, toughness, fracture, when)
      class(watch_t), intent(inout) :: watch
      type(tip_t), intent(in) :: tip
      real(rk), intent(in) :: toughness  !< K_IC [Pa m^1/2]
      character(len=*), intent(in) :: fracture  !< its name
      character(len=*), intent(in) :: when  !< "3600 s", "load factor 0.5"

      call watch%see(limit_k_to_grow, uncertainty(tip, toughness), when//", fracture "// &
                     trim(fracture)//", end "//integer_text(tip%end), tip%xy)
   end subroutine see_doubt

   !> Store or load all components.
   subroutine visit(self, archive)
      class(watch_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive
      integer :: i

      do i = 1, size(self%records)
         associate (record => self%records(i))
            call archive%item("states", record%states)
            call archive%item("first", record%first)
            call archive%item("worst", record%worst)
            call archive%list("first_at", record%first_at)
            call archive%list("worst_at", record%worst_at)
         end associate
      end do
      call archive%item("stopped_by", self%stopped_by)
      call archive%texts("news", self%news)
   end subroutine visit

end module report_watch
