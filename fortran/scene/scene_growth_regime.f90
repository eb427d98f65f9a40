!> What decides about the growth of a fracture that a well feeds: the toughness of the rock or the
!! viscosity of the fluid.
!!
!! In plane strain, at a constant rate Q and without leak-off, that is the dimensionless toughness
!! K_m = K'/(E'^3 mu' Q)^(1/4), with K' = sqrt(32/pi) K_IC, E' = E/(1 - nu^2) and mu' = 12 mu
!! (Detournay 2004, International Journal of Geomechanics 4, 35). It does not change with time.
module scene_growth_regime
   use base_kinds, only: pi, rk
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: find_regime, regime_words

   real(rk), parameter, public :: least_verified = 1.0_rk  !< K_m, verification/kgd

contains

   !> The smallest K_m of the wells with a rate in a fracture, if the scene grows.
   pure subroutine find_regime(scene, dimensionless_toughness, well)
      type(scene_t), intent(in) :: scene
      real(rk), intent(out) :: dimensionless_toughness  !< [-]
      integer, intent(out) :: well  !< which one has it; 0: there is none
      real(rk) :: modulus, rate, toughness, value
      integer :: i

      dimensionless_toughness = huge(1.0_rk)
      well = 0
      if (.not. (scene%growth%enabled .and. scene%has_fluid() .and. &
                 allocated(scene%injections))) return
      modulus = scene%material%young
      if (.not. scene%material%plane_stress) modulus = modulus/(1.0_rk - scene%material%poisson**2)
      do i = 1, size(scene%injections)
         if (scene%injections(i)%fracture == 0 .or. .not. allocated(scene%injections(i)%rate)) cycle
         rate = maxval(scene%injections(i)%rate)
         if (.not. rate > 0.0_rk) cycle
         toughness = min(scene%material%toughness, &
                         scene%fractures(scene%injections(i)%fracture)%toughness)
         value = sqrt(32.0_rk/pi)*toughness &
                 /(modulus**3*12.0_rk*scene%fluid%viscosity*rate)**0.25_rk
         if (value >= dimensionless_toughness) cycle
         dimensionless_toughness = value
         well = i
      end do
   end subroutine find_regime

   !> What decides: viscosity up to a K_m of 1, toughness from 4 on.
   pure function regime_words(dimensionless_toughness) result(words)
      real(rk), intent(in) :: dimensionless_toughness  !< [-]
      character(len=:), allocatable :: words

      if (dimensionless_toughness > 3.99_rk) then
         words = "toughness decides about growth"
      else if (dimensionless_toughness > 1.01_rk) then
         words = "toughness and viscosity decide about growth"
      else
         words = "viscosity decides about growth"
      end if
   end function regime_words

end module scene_growth_regime
