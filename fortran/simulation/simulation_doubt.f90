!> Tips whose intensities are not known well enough to grow on them.
!!
!! Growth in equilibrium asks whether K_eq reaches K_IC. A tip of which that may be so, within what
!! its intensities may be off, has to know them to a share of K_IC (simulation_limits).
module simulation_doubt
   use base_kinds, only: rk
   use base_number, only: integer_text
   use growth_tip, only: tip_t
   use simulation_limits, only: judge, limit_k_to_grow, verdict_stop
   use simulation_watch, only: watch_t
   implicit none(type, external)
   private

   public :: doubtful, stop_on_doubt, uncertainty

   !> K_eq changes by at most so much with an intensity: with K_II, where there is no K_I.
   real(rk), parameter :: steepest = 2.0_rk/sqrt(3.0_rk)

contains

   !> What the intensities of a tip may be off, over the toughness, or over K_eq where that is far
   !! above it and there is no doubt that the tip grows, only where to [%].
   elemental real(rk) function uncertainty(tip, toughness)
      type(tip_t), intent(in) :: tip
      real(rk), intent(in) :: toughness  !< K_IC [Pa m^1/2]

      uncertainty = 100.0_rk*error_of_k(tip)/max(toughness, tip%drive%intensity)
   end function uncertainty

   !> What a better window could mend, and what does not pass by itself.
   elemental real(rk) function error_of_k(tip)
      type(tip_t), intent(in) :: tip

      associate (k => tip%intensity)
         error_of_k = (max(k%k1_error, k%k2_error) - k%passing_error)/tip%drive%resistance
      end associate
   end function error_of_k

   !> A tip would grow, or might, and its intensities are not known well enough for that.
   elemental logical function doubtful(tip, toughness)
      type(tip_t), intent(in) :: tip
      real(rk), intent(in) :: toughness  !< K_IC [Pa m^1/2]

      doubtful = .not. tip%arrested .and. &
                 judge(limit_k_to_grow, uncertainty(tip, toughness)) == verdict_stop
      if (doubtful) doubtful = .not. tip%drive%intensity + steepest*error_of_k(tip) < toughness
   end function doubtful

   !> A tip is doubtful and cannot be known better: a limit of the run is passed.
   pure subroutine stop_on_doubt(watch, tip, toughness, fracture, when)
      class(watch_t), intent(inout) :: watch
      type(tip_t), intent(in) :: tip
      real(rk), intent(in) :: toughness  !< K_IC [Pa m^1/2]
      character(len=*), intent(in) :: fracture  !< its name
      character(len=*), intent(in) :: when  !< "3600 s", "load factor 0.5"

      call watch%see(limit_k_to_grow, uncertainty(tip, toughness), when//", fracture "// &
                     trim(fracture)//", end "//integer_text(tip%end), tip%xy)
   end subroutine stop_on_doubt

end module simulation_doubt
