!> Growth that no load factor holds: loads that do not change with it drive the tips on.
module mechanics_loose
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use growth_tip, only: tip_t
   use mechanics_misfit, only: tolerance
   use mechanics_state, only: loaded_body_t
   use mechanics_tries, only: least, tries_t
   implicit none(type, external)
   private

   public :: run_loosely

contains

   !> What no load held goes on at the same load as far as that drives it: to the ends of its pieces
   !! or until K_eq has fallen to K_IC.
   subroutine run_loosely(tries, body, group, timers, error)
      type(tries_t), intent(inout) :: tries
      class(loaded_body_t), intent(inout) :: body
      integer(ik), intent(in) :: group(:)  !< tips
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: most_tries = 30
      type(tip_t) :: begun(size(body%tip))
      real(rk) :: excess, excess_high, excess_low, high, low, lowest, room(size(group)), share
      logical :: is_placed
      integer :: try

      begun = body%tip
      room = tries%rooms(group)
      is_placed = all(.not. tries%segment_before(group)%is_open)
      associate (shortest => least*body%rules%increment - tries%segment_before(group)%accepted)
         lowest = maxval(max(shortest, 0.0_rk)/room)
      end associate
      low = 0.0_rk
      excess_low = maxval(tries%tip_before(group)%drive%intensity)/body%rules%toughness - 1.0_rk
      high = 1.0_rk
      excess_high = 0.0_rk
      share = 1.0_rk
      do try = 1, most_tries
         if (.not. (is_placed .and. try == 1)) then
            call tries%place(body, group, share*room, begun)
            call body%evaluate(timers, error)
            if (allocated(error)) return
         end if
         excess = maxval(body%tip(group)%drive%intensity)/body%rules%toughness - 1.0_rk
         if (try == 1 .and. excess >= 0.0_rk) exit
         if (abs(excess) <= 0.5_rk*tolerance) exit
         if (excess > 0.0_rk) then
            low = share
            excess_low = excess
         else
            high = share
            excess_high = excess
         end if
         if (high <= lowest) exit
         share = low + (high - low)*merge(0.5_rk, excess_low/(excess_low - excess_high), &
                                          mod(try, 3) == 0)
         share = max(share, lowest)
      end do
      call tries%keep_paths(body, group, share*room)
   end subroutine run_loosely

end module mechanics_loose
