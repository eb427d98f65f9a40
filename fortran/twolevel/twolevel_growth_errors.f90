!> Consequences of the errors of the intensities for growth.
!!
!! An error of K_eq is an error of the pressure at which the tip reaches its toughness, and of the
!! equilibrium position of a growing tip (model.md, section 5). Both are compared with the scales of
!! the scene: the pressure with that of the loads, the position with the length of the fracture.
!! K_IC is no such scale: K of a large fracture is many times K_IC.
module twolevel_growth_errors
   use base_kinds, only: pi, rk
   use growth_network, only: fracture_length
   use growth_segment, only: segment_t
   use growth_tip, only: tip_t
   use mesh_types, only: network_t
   use report_watch, only: doubtful, error_of_k
   implicit none(type, external)
   private

   public :: growth_error, growth_error_t, is_uncertain

   !> Consequences of the error of K_eq of one tip.
   type :: growth_error_t
      real(rk) :: pressure = 0.0_rk  !< error of the pressure at which the tip grows [Pa]
      real(rk) :: position = 0.0_rk  !< error of the position of the tip; 0 before its onset [m]
      !> the larger of the two errors, over the pressure of the loads and the length of the fracture
      !! [-]
      real(rk) :: relative = 0.0_rk
   end type growth_error_t

   !> Relative error above which windows are refined [-].
   real(rk), parameter :: acceptable = 0.01_rk

   !> d K_eq/d p, over sqrt(pi a) of a fracture of half-length a: 1 where the faces are open, less
   !! where they slip under friction [-].
   real(rk), parameter :: response = 0.5_rk

contains

   !> Consequences of the estimated error of K_eq of a tip.
   pure function growth_error(tip, segment, network, toughness, load_pressure) result(error)
      type(tip_t), intent(in) :: tip
      type(segment_t), intent(in) :: segment  !< last path segment of the tip
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      real(rk), intent(in) :: load_pressure  !< largest pressure expected from the loads [Pa]
      type(growth_error_t) :: error
      real(rk) :: length, off

      length = fracture_length(network, tip%fracture)
      off = error_of_k(tip)
      error%pressure = off*tip%drive%resistance/(response*sqrt(0.5_rk*pi*length))
      error%relative = error%pressure/load_pressure
      if (.not. (segment%is_open .or. segment%gain > 0.0_rk)) return
      error%position = off/tip%scale_of(toughness)/abs(segment%falling_slope())
      error%relative = max(error%relative, error%position/length)
   end function growth_error

   !> Whether a tip grows, or might grow within the error of its K_eq, and the error has
   !! considerable consequences.
   pure logical function is_uncertain(tip, segment, network, toughness, load_pressure)
      type(tip_t), intent(in) :: tip
      type(segment_t), intent(in) :: segment  !< last path segment of the tip
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      real(rk), intent(in) :: load_pressure  !< largest pressure expected from the loads [Pa]
      type(growth_error_t) :: error

      is_uncertain = doubtful(tip, toughness)
      if (.not. is_uncertain) return
      error = growth_error(tip, segment, network, toughness, load_pressure)
      is_uncertain = .not. error%relative <= acceptable
   end function is_uncertain

end module twolevel_growth_errors
