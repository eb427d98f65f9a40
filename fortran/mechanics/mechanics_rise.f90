!> The load changes to each onset of growth, up or down, and never exceeds it.
!!
!! Loads that change direction: where slip is locked in, K_eq need not rise over a whole part of the
!! load programme. It may fall at first, from the toughness that the tips have reached, and it may
!! have its largest value within the part, where faces begin to slip back.
module mechanics_rise
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use base_tolerances, only: same_value
   use mechanics_balance, only: at_jump
   use mechanics_programme, only: foreseen_onset, reading_t, strongest
   use mechanics_state, only: loaded_body_t
   implicit none(type, external)
   private

   public :: go_to_peak, rise

   integer(ik), parameter :: places = 8  !< on the way, at which the intensities are looked at

contains

   !> Take the load up or down to a factor, or to the onset of growth if that comes first.
   !!
   !! Without contact the intensities are linear in the factor. The equivalent intensity, the
   !! largest over all angles of linear functions, is then convex: where it is below the toughness
   !! at both ends of an interval, it is so within.
   subroutine rise(self, target, has_onset, timers, error)
      class(loaded_body_t), intent(inout) :: self
      real(rk), intent(in) :: target  !< [-]
      logical, intent(out) :: has_onset
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(reading_t) :: low, high
      real(rk) :: onset

      has_onset = .false.
      if (.not. allocated(self%body%displacement)) then
         low%factor = self%factor
         call self%adapt(strongest(self%scene%load, merge(target, low%factor, &
                                                          abs(target) >= abs(low%factor))), &
                         timers, error)
         if (allocated(error)) return
         call self%respond(low%factor, timers, error)
         if (allocated(error)) return
      end if
      call self%accept()
      if (.not. self%scene%growth%enabled) then
         call self%respond(target, timers, error)
         if (allocated(error) .or. .not. self%scene%growth%intensities) return
         call self%correct_intensities(timers, error)
         return
      end if
      has_onset = self%largest_excess() >= -same_value
      if (has_onset .and. self%turns) then
         call leave_turn(self, target, has_onset, timers, error)
         if (allocated(error) .or. self%largest_excess() >= -same_value) return
      end if
      if (has_onset) return
      low = self%reading()
      onset = proportional_onset(self)
      if (onset > min(low%factor, target) .and. onset < max(low%factor, target)) then
         call self%respond(onset, timers, error)
         if (allocated(error)) return
         has_onset = abs(self%largest_excess()) <= same_value
         if (has_onset) return
         if (self%largest_excess() < 0.0_rk) low = self%reading()
      end if
      if (.not. self%largest_excess() >= 0.0_rk) then
         call self%respond(target, timers, error)
         if (allocated(error)) return
         if (self%largest_excess() < -same_value .and. self%turns) then
            call look_between(self, low%factor, target, timers, error)
            if (allocated(error)) return
         end if
         if (self%largest_excess() < -same_value) return
      end if
      has_onset = .true.
      high = self%reading()
      call find_onset(self, low, high, timers, error)
   end subroutine rise

   !> Take the load back from a target, where no tip grows, to where one does since K_eq is largest
   !! on the way; if there is such a place.
   subroutine look_between(self, begun, target, timers, error)
      class(loaded_body_t), intent(inout) :: self
      real(rk), intent(in) :: begun, target  !< factors [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call self%respond(begun, timers, error)
      if (.not. allocated(error)) call go_to_peak(self, target, timers, error)
      if (allocated(error)) return
      if (self%largest_excess() < -same_value) call self%respond(target, timers, error)
   end subroutine look_between

   !> The load between one at which no tip grows and one at which some do, the present one.
   subroutine find_onset(self, low, high, timers, error)
      class(loaded_body_t), intent(inout) :: self
      type(reading_t), intent(inout) :: low, high
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: iterations = 60
      type(reading_t) :: last, next
      real(rk) :: width(0:iterations)
      integer :: k

      last = low
      next = high
      width = huge(1.0_rk)
      do k = 1, iterations
         if (abs(self%largest_excess()) <= same_value) return
         width(k) = abs(high%factor - low%factor)
         if (k > 3 .and. width(k) > 0.5_rk*width(max(k - 3, 0))) then
            next%factor = 0.5_rk*(low%factor + high%factor)  ! the lines lead nowhere
         else
            next%factor = foreseen_onset(last, next, low%factor, high%factor, &
                                         self%scene%material%toughness)
         end if
         last = self%reading()
         call self%respond(next%factor, timers, error)
         if (allocated(error)) return
         next = self%reading()
         if (self%largest_excess() < 0.0_rk) then
            low = next
         else
            high = next
         end if
         ! Where contact changes, the intensity may jump past the toughness: at this load.
         if (abs(high%factor - low%factor) <= at_jump*max(abs(low%factor), abs(high%factor))) then
            call self%respond(high%factor, timers, error)
            return
         end if
      end do
      call raise_error(error, "", "the load of the next onset of growth was not found")
   end subroutine find_onset

   !> The onset where all loads change in proportion: until contact changes, or locked-in slip is
   !! left, the intensities do so too. The present factor where that says nothing.
   pure real(rk) function proportional_onset(self) result(onset)
      class(loaded_body_t), intent(in) :: self

      onset = self%factor
      associate (scene => self%scene)
         if (any(abs([scene%material%density*scene%gravity, scene%in_situ%stress, &
                      scene%in_situ%per_y]) > 0.0_rk)) return
      end associate
      if (self%largest_excess() > -1.0_rk) onset = self%factor/(1.0_rk + self%largest_excess())
   end function proportional_onset

   !> Take the load to where, between the present factor and a target, K_eq is largest; where it
   !! stays far from the toughness, to about there.
   subroutine go_to_peak(body, target, timers, error)
      class(loaded_body_t), intent(inout) :: body
      real(rk), intent(in) :: target  !< [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk), parameter :: far = 0.2_rk  ! of the toughness
      integer, parameter :: halvings = 16  ! leave about a thousandth of the way
      real(rk) :: best, begun, excess, found, left, place, right
      integer(ik) :: at, k
      integer :: halving

      begun = body%factor
      best = body%largest_excess()
      at = 0
      do k = 1, places
         call body%respond(on_the_way(begun, target, k), timers, error)
         if (allocated(error)) return
         if (body%largest_excess() > best) at = k
         best = max(best, body%largest_excess())
      end do
      if (at == places) return
      found = on_the_way(begun, target, at)
      left = on_the_way(begun, target, max(0_ik, at - 1_ik))
      right = on_the_way(begun, target, at + 1_ik)
      do halving = 1, merge(halvings, 0, best > -far)
         associate (is_right => abs(right - found) > abs(found - left))
            place = 0.5_rk*(found + merge(right, left, is_right))
            call body%respond(place, timers, error)
            if (allocated(error)) return
            excess = body%largest_excess()
            if (excess > best) then
               if (is_right) left = found
               if (.not. is_right) right = found
               found = place
               best = excess
            else if (is_right) then
               right = place
            else
               left = place
            end if
         end associate
      end do
      call body%respond(found, timers, error)
   end subroutine go_to_peak

   !> Tips at their toughness do not grow while K_eq falls: go on towards a target until they are
   !! below it. If K_eq rises instead, there is an onset of growth: at the present factor, or on the
   !! way, from which it rises again.
   subroutine leave_turn(body, target, has_onset, timers, error)
      class(loaded_body_t), intent(inout) :: body
      real(rk), intent(in) :: target  !< [-]
      logical, intent(out) :: has_onset
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk), parameter :: beside = 1.0e-4_rk  ! share of the way
      real(rk) :: before, begun, last
      integer(ik) :: k

      has_onset = .true.
      begun = body%factor
      if (.not. abs(target - begun) > 0.0_rk) return
      do k = 0, places
         before = body%largest_excess()
         last = body%factor
         if (k == 0) then
            call body%respond(begun + beside*(target - begun), timers, error)
         else
            call body%respond(on_the_way(begun, target, k), timers, error)
         end if
         if (allocated(error)) return
         has_onset = .not. body%largest_excess() < before
         if (has_onset) then
            call body%respond(last, timers, error)
            return
         end if
         if (body%largest_excess() < -same_value) return
      end do
   end subroutine leave_turn

   !> The k-th place on the way.
   pure real(rk) function on_the_way(begun, target, k)
      real(rk), intent(in) :: begun, target  !< [-]
      integer(ik), intent(in) :: k

      on_the_way = begun + (target - begun)*real(k, rk)/real(places, rk)
      if (k == places) on_the_way = target
   end function on_the_way

end module mechanics_rise
