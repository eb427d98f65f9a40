!> The equilibrium load of a network: the factor at which the largest K_eq of its tips is K_IC; and
!! a load that distributes the differences between K_eq and K_IC over the growing tips.
module mechanics_balance
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use base_tolerances, only: same_value
   use mechanics_programme, only: predicted_onset, reading_t
   use mechanics_state, only: loaded_body_t
   implicit none(type, external)
   private

   public :: at_jump, balance_load, needed_intensity, share_misfit, tolerance

   !> Width of a bracket over its load factor at which it contains a jump of K and no root [-].
   real(rk), parameter :: at_jump = 1.0e-13_rk

   !> The search for a load: a bracket of load factors, and the last evaluation.
   type :: search_t
      real(rk) :: started = 0.0_rk, limit = 0.0_rk  !< arguments of balance_load [-]
      logical :: has_low = .false., has_high = .false.
      type(reading_t) :: low  !< end of the bracket at which all K_eq < K_IC
      type(reading_t) :: high  !< end of the bracket at which a K_eq >= K_IC
      type(reading_t) :: last  !< previous evaluation
      real(rk) :: largest = 0.0_rk  !< largest K_eq of the previous evaluation [Pa m^1/2]
   contains
      procedure :: narrow
      procedure :: is_at_jump
      procedure :: step
   end type search_t

   real(rk), parameter :: tolerance = 5.0e-3_rk  !< on 1 - K_eq/K_IC of tips that have advanced [-]

contains

   !> Change the load from the present factor, at which the tips have been evaluated, to that at
   !! which the largest K_eq is K_IC: up to the limit, or down to the beginning of the programme.
   !! `holds` is false if K_eq < K_IC at the limit. If K_eq > K_IC even at the beginning, growth is
   !! `loose`, and the load is that of the last accepted state. An error: no such load was found.
   !!
   !! Intensities are linear in the factor between changes of contact, and proportional to it where
   !! all loads are: then the first or second evaluation is the last.
   subroutine balance_load(self, started, limit, timers, holds, is_loose, slope, error)
      class(loaded_body_t), intent(inout) :: self
      real(rk), intent(in) :: started  !< the factor of the last accepted state [-]
      real(rk), intent(in) :: limit  !< last factor in the direction of the load programme [-]
      type(timers_t), intent(inout) :: timers
      logical, intent(out) :: holds
      logical, intent(out) :: is_loose  !< loads that do not change with the factor drive the tips
      real(rk), intent(out) :: slope(:)  !< (tips) dK_eq/df at that factor [Pa m^1/2]
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: evaluations_max = 60
      type(search_t) :: search
      real(rk) :: k_last(size(self%tip))
      integer :: k

      holds = .false.
      is_loose = .false.
      slope = self%tip%drive%intensity/nonzero(self%factor)
      if (all(self%tip%arrested)) return
      search%started = started
      search%limit = limit
      do k = 1, evaluations_max
         holds = abs(self%largest_excess()) <= same_value
         if (holds) return
         if (self%largest_excess() < 0.0_rk .and. is_at(self, limit, limit)) return
         if (self%largest_excess() >= 0.0_rk .and. is_at(self, self%bounds(1), limit)) then
            call start_again(self, search, timers, is_loose, error)
            holds = is_loose
            if (is_loose) slope = self%tip%drive%intensity/nonzero(self%factor)
            if (allocated(error) .or. is_loose) return
            cycle
         end if
         call search%narrow(self)
         if (search%is_at_jump()) then
            ! Where contact changes, K may jump past the toughness: take the load below the jump.
            if (self%largest_excess() > 0.0_rk) call self%respond(search%low%factor, timers, error)
            holds = .true.
            return
         end if
         k_last = self%tip%drive%intensity
         call search%step(self, k, timers, error)
         if (allocated(error)) return
         slope = (self%tip%drive%intensity - k_last)/nonzero(self%factor - search%last%factor)
      end do
      call raise_error(error, "", "no load was found at which the growing tips are in equilibrium")
   end subroutine balance_load

   !> The present load factor equals another one, relative to the range of the programme.
   pure logical function is_at(self, factor, limit)
      class(loaded_body_t), intent(in) :: self
      real(rk), intent(in) :: factor, limit  !< [-]

      is_at = abs(self%factor - factor) <= same_value*abs(limit - self%bounds(1))
   end function is_at

   !> K_eq > K_IC at the beginning of the programme. If it is so at the load of the last accepted
   !! state too, there is no equilibrium; otherwise K increases towards both ends, and the search
   !! continues from there towards the limit.
   subroutine start_again(self, search, timers, is_loose, error)
      class(loaded_body_t), intent(inout) :: self
      type(search_t), intent(inout) :: search
      type(timers_t), intent(inout) :: timers
      logical, intent(out) :: is_loose
      type(error_t), allocatable, intent(out) :: error

      is_loose = .false.
      call self%respond(search%started, timers, error)
      if (allocated(error)) return
      is_loose = self%largest_excess() >= 0.0_rk
      if (is_loose) return
      search%low = self%reading()
      search%has_low = .true.
      search%last = search%low
      call self%respond(search%limit, timers, error)
   end subroutine start_again

   !> Make the present load an end of the bracket.
   subroutine narrow(self, body)
      class(search_t), intent(inout) :: self
      class(loaded_body_t), intent(in) :: body

      if (body%largest_excess() < 0.0_rk) then
         self%low = body%reading()
         self%has_low = .true.
      else
         self%high = body%reading()
         self%has_high = .true.
      end if
   end subroutine narrow

   !> The bracket is as narrow as rounding permits: it contains a jump of the intensity.
   pure logical function is_at_jump(self)
      class(search_t), intent(in) :: self

      is_at_jump = self%has_low .and. self%has_high
      if (is_at_jump) then
         associate (low => self%low%factor, high => self%high%factor)
            is_at_jump = abs(high - low) <= at_jump*max(abs(low), abs(high))
         end associate
      end if
   end function is_at_jump

   !> Evaluate the tips at the next factor.
   subroutine step(self, body, k, timers, error)
      class(search_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      integer, intent(in) :: k  !< evaluations so far
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(reading_t) :: next
      real(rk) :: factor

      next = body%reading()
      factor = within(next_factor(self, body, next, k), body%bounds(1), self%limit)
      self%last = next
      self%largest = maxval(body%tip%drive%intensity, mask=.not. body%tip%arrested)
      call body%respond(factor, timers, error)
   end subroutine step

   !> Load factor of the next evaluation, before it is limited [-].
   real(rk) function next_factor(search, body, next, k) result(factor)
      type(search_t), intent(in) :: search
      class(loaded_body_t), intent(in) :: body
      type(reading_t), intent(in) :: next  !< the present load
      integer, intent(in) :: k  !< evaluations so far
      integer, parameter :: guesses = 3

      associate (first => body%bounds(1), limit => search%limit, low => search%low%factor, &
                 high => search%high%factor)
         if (search%has_low .and. search%has_high) then
            factor = 0.5_rk*(low + high)
            if (mod(k, 4) /= 0) factor = predicted_onset(search%last, next, low, high, &
                                                         body%scene%material%toughness)
         else if (k == 1) then
            factor = body%factor/(1.0_rk + max(-0.5_rk, body%largest_excess()))
         else if (k <= guesses) then
            factor = next%factor &
                     + (next%factor - search%last%factor)*extrapolation(search, body, next)
         else if (search%has_low) then
            factor = body%factor + 2.0_rk*(body%factor - search%started)
            if (.not. (factor - body%factor)*(limit - first) > 0.0_rk .or. k > 2*guesses) then
               factor = limit
            end if
         else  ! in steps: K may rise again where the load has fallen far
            factor = first + 0.7_rk*(body%factor - first)
            if (k > 10*guesses) factor = first
         end if
      end associate
   end function next_factor

   !> Next change of the load factor over the last one, by linear extrapolation of the excess to
   !! zero [-].
   pure real(rk) function extrapolation(search, body, next)
      type(search_t), intent(in) :: search
      class(loaded_body_t), intent(in) :: body
      type(reading_t), intent(in) :: next
      real(rk), parameter :: most = 10.0_rk
      real(rk) :: before, excess

      before = search%largest - body%scene%material%toughness
      excess = body%largest_excess()*body%scene%material%toughness
      extrapolation = 0.0_rk
      if (abs(next%factor - search%last%factor) > 0.0_rk) extrapolation = most
      if (abs(before - excess) > 0.0_rk) then
         extrapolation = max(-most, min(most, excess/(before - excess)))
      end if
   end function extrapolation

   !> The value, or the smallest number of its sign if it is zero, for use as a divisor.
   elemental real(rk) function nonzero(value)
      real(rk), intent(in) :: value

      nonzero = sign(max(abs(value), tiny(1.0_rk)), value)
   end function nonzero

   !> The value nearest to a given one between two limits in either order.
   pure real(rk) function within(value, a, b)
      real(rk), intent(in) :: value, a, b  !< [-]

      within = min(max(value, min(a, b)), max(a, b))
   end function within

   !> K_eq of growing tips: K_IC, or without an equilibrium the largest K_eq [Pa m^1/2].
   pure real(rk) function needed_intensity(body)
      class(loaded_body_t), intent(in) :: body

      needed_intensity = body%rules%toughness
      if (body%largest_excess() > tolerance) then
         needed_intensity = needed_intensity*(1.0_rk + body%largest_excess())
      end if
   end function needed_intensity

   !> Where the largest K_eq is K_IC but that of some advanced tips is too small by more than the
   !! tolerance: change the load to one farther along the programme at which the first is too large
   !! and the others too small, all within the tolerance, if there is one. Otherwise tips with a
   !! small dK_eq/df would determine the load by the errors of their K.
   subroutine share_misfit(body, grown, limit, slope, timers, error)
      class(loaded_body_t), intent(inout) :: body
      integer(ik), intent(in) :: grown(:)  !< tips that have advanced
      real(rk), intent(in) :: limit  !< the last factor of the programme [-]
      real(rk), intent(in) :: slope(:)  !< (tips) dK_eq/df [Pa m^1/2]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk), parameter :: part_of = 0.9_rk  ! fraction of the tolerance
      real(rk) :: above, allowed, factor, lack(size(grown)), rate(size(slope)), rise, way

      allowed = part_of*tolerance*body%rules%toughness
      lack = needed_intensity(body) - body%tip(grown)%drive%intensity
      if (size(grown) == 0) return
      if (maxval(lack) <= tolerance*body%rules%toughness) return
      way = sign(1.0_rk, limit - body%bounds(1))
      rate = way*slope
      if (any(lack > allowed .and. .not. rate(grown) > 0.0_rk)) return
      rise = maxval((lack - allowed)/rate(grown), mask=lack > allowed)
      if (rise > way*(limit - body%factor)) return
      above = maxval(body%tip%drive%intensity + rise*rate, mask=.not. body%tip%arrested)
      if (above > body%rules%toughness + allowed) return
      factor = body%factor
      call body%respond(factor + way*rise, timers, error)
      if (allocated(error)) return
      if (body%largest_excess() > tolerance) call body%respond(factor, timers, error)
   end subroutine share_misfit

end module mechanics_balance
