!> Changes of the load up to the next onset of growth, which is not passed.
!!
!! Loads that change direction: with locked-in slip K_eq need not increase over a whole part of the
!! load programme. It may decrease at first, from K_IC, and its largest value may be within the
!! part, where faces begin to slip back.
module mechanics_rise
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use base_tolerances, only: same_value
   use mechanics_balance, only: at_jump
   use mechanics_programme, only: predicted_onset, reading_t, strongest
   use mechanics_state, only: loaded_body_t
   implicit none(type, external)
   private

   public :: go_to_peak, rise

   integer(ik), parameter :: places = 8  !< number of loads at which a part is evaluated

contains

   !> Change the load up or down to a factor, or to the onset of growth if that is nearer.
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

   !> Look for an onset of growth between two loads at which K_eq < K_IC: at the largest K_eq.
   !! Without one the load is the target.
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

   !> Find the onset between a load at which K_eq < K_IC and the present one, at which K_eq > K_IC.
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
            next%factor = 0.5_rk*(low%factor + high%factor)  ! extrapolation does not converge
         else
            next%factor = predicted_onset(last, next, low%factor, high%factor, &
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

   !> Load factor of the onset if all loads and intensities are proportional to it: until contact
   !! changes, and without locked-in slip. The present factor if they are not.
   pure real(rk) function proportional_onset(self) result(onset)
      class(loaded_body_t), intent(in) :: self

      onset = self%factor
      associate (scene => self%scene)
         if (any(abs([scene%material%density*scene%gravity, scene%in_situ%stress, &
                      scene%in_situ%per_y]) > 0.0_rk)) return
      end associate
      if (self%largest_excess() > -1.0_rk) onset = self%factor/(1.0_rk + self%largest_excess())
   end function proportional_onset

   !> Change the load to that of the largest K_eq between the present factor and a target; where
   !! K_eq is far below K_IC, to about that load.
   subroutine go_to_peak(body, target, timers, error)
      class(loaded_body_t), intent(inout) :: body
      real(rk), intent(in) :: target  !< [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk), parameter :: far = 0.2_rk  ! of the toughness
      integer, parameter :: halvings = 16  ! to about a thousandth of the change of load
      real(rk) :: best, begun, excess, found, left, place, right
      integer(ik) :: at, k
      integer :: halving

      begun = body%factor
      best = body%largest_excess()
      at = 0
      do k = 1, places
         call body%respond(place_between(begun, target, k), timers, error)
         if (allocated(error)) return
         if (body%largest_excess() > best) at = k
         best = max(best, body%largest_excess())
      end do
      if (at == places) return
      found = place_between(begun, target, at)
      left = place_between(begun, target, max(0_ik, at - 1_ik))
      right = place_between(begun, target, at + 1_ik)
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

   !> Tips with K_eq = K_IC do not grow while K_eq decreases: change the load towards a target until
   !! K_eq < K_IC. If K_eq increases instead, at the present factor or later, there is an onset of
   !! growth.
   subroutine leave_turn(body, target, has_onset, timers, error)
      class(loaded_body_t), intent(inout) :: body
      real(rk), intent(in) :: target  !< [-]
      logical, intent(out) :: has_onset
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk), parameter :: small = 1.0e-4_rk  ! fraction of the change of load
      real(rk) :: before, begun, last
      integer(ik) :: k

      has_onset = .true.
      begun = body%factor
      if (.not. abs(target - begun) > 0.0_rk) return
      do k = 0, places
         before = body%largest_excess()
         last = body%factor
         if (k == 0) then
            call body%respond(begun + small*(target - begun), timers, error)
         else
            call body%respond(place_between(begun, target, k), timers, error)
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

   !> The k-th of `places` equally spaced loads up to a target [-].
   pure real(rk) function place_between(begun, target, k)
      real(rk), intent(in) :: begun, target  !< [-]
      integer(ik), intent(in) :: k

      place_between = begun + (target - begun)*real(k, rk)/real(places, rk)
      if (k == places) place_between = target
   end function place_between

end module mechanics_rise
