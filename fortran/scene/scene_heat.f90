!> What a scene says about heat besides the properties of materials, sides and wells.
module scene_heat
   use base_kinds, only: rk
   implicit none(type, external)
   private

   public :: heat_t

   !> Temperature before the first step, and the accuracy of heat.
   type :: heat_t
      real(rk) :: temperature = 0.0_rk  !< at y_datum [K]
      real(rk) :: temperature_per_y = 0.0_rk  !< [K/m]
      real(rk) :: y_datum = 0.0_rk  !< [m]
      real(rk) :: tolerance = 1.0e-3_rk  !< of a substep in time, relative [-]
   end type heat_t

end module scene_heat
