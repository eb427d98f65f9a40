!> By how much K_eq of tips that grow may miss K_IC, and the load that shares it out.
module mechanics_misfit
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use mechanics_state, only: loaded_body_t
   implicit none(type, external)
   private

   public :: needed_intensity, share_misfit, together, tolerance

   !> Share of the toughness that tips may lack to begin an increment together with the first: about
   !! the error of the intensities, so that equal tips stay equal.
   real(rk), parameter :: together = 2.0e-3_rk

   real(rk), parameter :: tolerance = 5.0e-3_rk  !< on 1 - K_eq/K_IC of tips that have advanced [-]

contains

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

end module mechanics_misfit
