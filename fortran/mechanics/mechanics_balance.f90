!> The load that a network bears: the factor at which the largest K_eq of its tips is K_IC.
!!
!! The difference between K_eq and K_IC that is accepted at growing tips, and the load that
!! distributes it over them.
module mechanics_balance
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use base_tolerances, only: same_value
   use mechanics_programme, only: foreseen_onset, reading_t
   use mechanics_state, only: loaded_body_t
   implicit none(type, external)
   private

   public :: at_jump, balance_load, needed_intensity, share_misfit, tolerance

   !> Width of a bracket, over its place, that holds a jump of the intensity and not its root.
   real(rk), parameter :: at_jump = 1.0e-13_rk

   real(rk), parameter :: tolerance = 5.0e-3_rk  !< on 1 - K_eq/K_IC of tips that have advanced [-]

contains

   !> Take the load from the present factor, at which the tips have been evaluated, to that at which
   !! the next tip is at its toughness: up, no farther than a limit, or down, no farther than where
   !! the programme begins. `holds` is false where at the limit no tip is there yet. Where not even
   !! at the beginning the tips are held, growth is `loose`, and the load is where it started from.
   !!
   !! Intensities are linear in the factor between changes of contact, and proportional to it where
   !! all loads are: then the first or second try is the last.
   subroutine balance_load(self, started, limit, timers, holds, is_loose, slope, error)
      class(loaded_body_t), intent(inout) :: self
      real(rk), intent(in) :: started  !< the factor of the last accepted state [-]
      real(rk), intent(in) :: limit  !< the largest factor, on the way of the load [-]
      type(timers_t), intent(inout) :: timers
      logical, intent(out) :: holds
      logical, intent(out) :: is_loose  !< loads that do not change with the factor drive the tips
      real(rk), intent(out) :: slope(:)  !< (tips) dK_eq/df at that factor [Pa m^1/2]
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: tries = 60, guesses = 3
      type(reading_t) :: last, next, low, high
      real(rk) :: factor, k_last(size(self%tip))
      logical :: has_low, has_high
      integer :: k

      holds = .false.
      is_loose = .false.
      has_low = .false.
      has_high = .false.
      slope = self%tip%drive%intensity/nonzero(self%factor)
      if (all(self%tip%arrested)) return
      do k = 1, tries
         next = self%reading()
         holds = abs(self%largest_excess()) <= same_value
         if (holds) return
         if (self%largest_excess() < 0.0_rk) then
            if (is_at(limit)) return
            low = next
            has_low = .true.
         else
            if (is_at(self%bounds(1))) then
               call self%respond(started, timers, error)
               if (allocated(error)) return
               is_loose = self%largest_excess() >= 0.0_rk
               if (is_loose) then
                  holds = .true.
                  slope = self%tip%drive%intensity/nonzero(self%factor)
                  return
               end if
               next = self%reading()  ! K rises towards both ends: this is the place to rise from
               low = next
               has_low = .true.
               last = next
               call self%respond(limit, timers, error)
               if (allocated(error)) return
               cycle
            end if
            high = next
            has_high = .true.
         end if
         if (has_low .and. has_high) then
            if (abs(high%factor - low%factor) <= &
                at_jump*max(abs(low%factor), abs(high%factor))) then
               ! Where contact changes the intensity may jump past the toughness: just below that.
               if (self%largest_excess() > 0.0_rk) call self%respond(low%factor, timers, error)
               holds = .true.
               return
            end if
            factor = 0.5_rk*(low%factor + high%factor)
            if (mod(k, 4) /= 0) factor = foreseen_onset(last, next, low%factor, high%factor, &
                                                        self%scene%material%toughness)
         else if (k == 1) then
            factor = self%factor/(1.0_rk + max(-0.5_rk, self%largest_excess()))
         else if (k <= guesses) then
            factor = next%factor + (next%factor - last%factor)*extrapolation(last, next)
         else if (has_low) then
            factor = self%factor + 2.0_rk*(self%factor - started)
            if (.not. (factor - self%factor)*(limit - self%bounds(1)) > 0.0_rk &
                .or. k > 2*guesses) factor = limit
         else  ! in steps: K may rise again where the load has fallen far
            factor = self%bounds(1) + 0.7_rk*(self%factor - self%bounds(1))
            if (k > 10*guesses) factor = self%bounds(1)
         end if
         factor = within(factor, self%bounds(1), limit)
         last = next
         k_last = self%tip%drive%intensity
         call self%respond(factor, timers, error)
         if (allocated(error)) return
         slope = (self%tip%drive%intensity - k_last)/nonzero(self%factor - last%factor)
      end do
      call raise_error(error, "", "no load was found at which the growing tips are in equilibrium")

   contains

      pure logical function is_at(place)
         real(rk), intent(in) :: place  !< a factor [-]

         is_at = abs(self%factor - place) <= same_value*abs(limit - self%bounds(1))
      end function is_at

      !> How many times the last change of the factor again, for the excess to vanish.
      pure real(rk) function extrapolation(a, b)
         type(reading_t), intent(in) :: a, b
         real(rk) :: excess_a, excess_b
         real(rk), parameter :: most = 10.0_rk

         excess_a = maxval(k_last, mask=.not. self%tip%arrested) - self%scene%material%toughness
         excess_b = self%largest_excess()*self%scene%material%toughness
         extrapolation = 0.0_rk
         if (abs(b%factor - a%factor) > 0.0_rk) extrapolation = most
         if (abs(excess_a - excess_b) > 0.0_rk) then
            extrapolation = max(-most, min(most, excess_b/(excess_a - excess_b)))
         end if
      end function extrapolation

   end subroutine balance_load

   !> A divisor.
   elemental real(rk) function nonzero(value)
      real(rk), intent(in) :: value

      nonzero = sign(max(abs(value), tiny(1.0_rk)), value)
   end function nonzero

   !> The place between two limits, in either order, that is nearest to one.
   pure real(rk) function within(place, a, b)
      real(rk), intent(in) :: place, a, b

      within = min(max(place, min(a, b)), max(a, b))
   end function within

   !> What tips that grow have: K_IC, or where nothing holds them the largest K_eq [Pa m^1/2].
   pure real(rk) function needed_intensity(body)
      class(loaded_body_t), intent(in) :: body

      needed_intensity = body%rules%toughness
      if (body%largest_excess() > tolerance) then
         needed_intensity = needed_intensity*(1.0_rk + body%largest_excess())
      end if
   end function needed_intensity

   !> The largest K_eq is K_IC, and some of tips that have advanced lack more than the tolerance: a
   !! load farther along the programme at which the one is too large and the others too small, all
   !! within the tolerance, if there is one. Tips that hardly answer to the load would fix it by the
   !! errors of their K.
   subroutine share_misfit(body, grown, limit, slope, timers, error)
      class(loaded_body_t), intent(inout) :: body
      integer(ik), intent(in) :: grown(:)  !< tips that have advanced
      real(rk), intent(in) :: limit  !< the last factor of the programme [-]
      real(rk), intent(in) :: slope(:)  !< (tips) dK_eq/df [Pa m^1/2]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk), parameter :: part_of = 0.9_rk  ! of the tolerance
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
