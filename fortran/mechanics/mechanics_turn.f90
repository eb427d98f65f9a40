!> Loads that turn round: where slip is locked in, K_eq need not rise all the way to the end of a
!! piece of the programme. It may fall at first, from the toughness that the tips stood at, and it
!! may have its largest value on the way, where faces begin to slip back.
module mechanics_turn
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use base_tolerances, only: same_value
   use mechanics_state, only: loaded_body_t
   implicit none(type, external)
   private

   public :: go_to_peak, leave_turn

   integer(ik), parameter :: places = 8  !< on the way, at which the intensities are looked at

contains

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

end module mechanics_turn
