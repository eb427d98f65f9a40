!> Expected magnitudes of the results of a scene with a fluid.
module twolevel_scales
   use base_kinds, only: pi, rk
   use coarse_in_situ, only: find_in_situ, in_situ_state_t
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: keep_above_zero, pressure_scale

contains

   !> Replace a toughness of 0, or next to it, by one that changes nothing that a run resolves: K_eq
   !! over it is a finite number, viscosity has its limit without toughness (coarse_tip_layer), and
   !! a tip that is shut lacks more of it than the tolerance of equilibrium.
   pure subroutine keep_above_zero(scene)
      type(scene_t), intent(inout) :: scene
      real(rk), parameter :: negligible = 2.0e-4_rk  ! share of K at the pressure of the loads
      real(rk), parameter :: strain = 1.0e-10_rk  ! where there are none
      real(rk) :: least
      integer :: i

      least = negligible*max(pressure_scale(scene), strain*scene%material%young) &
              *sqrt(0.5_rk*pi*longest_fracture(scene))
      scene%material%toughness = max(least, scene%material%toughness)
      do i = 1, size(scene%fractures)
         scene%fractures(i)%toughness = max(least, scene%fractures(i)%toughness)
      end do
      if (.not. allocated(scene%regions)) return
      do i = 1, size(scene%regions)
         scene%regions(i)%material%toughness = max(least, scene%regions(i)%material%toughness)
      end do
   end subroutine keep_above_zero

   !> Largest pressure expected in a scene [Pa]: that of its loads or of its initial state, stress
   !! in situ included, and with growth the pressure at which the longest fracture reaches its
   !! toughness; 0 without any of these.
   pure real(rk) function pressure_scale(scene) result(scale)
      type(scene_t), intent(in) :: scene
      real(rk), parameter :: half_pi = 0.5_rk*pi
      type(in_situ_state_t), allocatable :: in_situ
      real(rk) :: extent, longest
      integer :: i

      associate (d => scene%domain)
         extent = min(d%x_max - d%x_min, d%y_max - d%y_min)
      end associate
      scale = abs(scene%initial%pressure)
      do i = 1, size(scene%sides)
         associate (side => scene%sides(i))
            scale = max(scale, side%largest_stress(), &
                        scene%material%young*side%largest_displacement()/extent)
         end associate
      end do
      call find_in_situ(scene, scene%material%biot, in_situ)
      if (allocated(in_situ)) then
         associate (y => [scene%domain%y_min, scene%domain%y_max])
            scale = max(scale, maxval(abs(in_situ%pressure_at(y))), &
                        maxval(abs(in_situ%stress_at(y(1)))), maxval(abs(in_situ%stress_at(y(2)))))
         end associate
      end if
      longest = longest_fracture(scene)
      if (scene%growth%enabled .and. longest > 0.0_rk) then
         scale = max(scale, scene%material%toughness/sqrt(half_pi*longest))
      end if
   end function pressure_scale

   !> Length of the longest fracture [m].
   pure real(rk) function longest_fracture(scene) result(longest)
      type(scene_t), intent(in) :: scene
      integer :: i

      longest = 0.0_rk
      do i = 1, size(scene%fractures)
         longest = max(longest, scene%fractures(i)%length())
      end do
   end function longest_fracture

end module twolevel_scales
