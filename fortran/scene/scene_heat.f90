!> What a scene says about heat besides the properties of materials, sides and wells, and the
!! temperatures of scenes without a fluid.
module scene_heat
   use base_kinds, only: rk
   implicit none(type, external)
   private

   public :: heat_t, temperature_t

   !> Temperature before the first step, and the accuracy of heat.
   type :: heat_t
      real(rk) :: temperature = 0.0_rk  !< at y_datum [K]
      real(rk) :: temperature_per_y = 0.0_rk  !< [K/m]
      real(rk) :: y_datum = 0.0_rk  !< [m]
      real(rk) :: tolerance = 1.0e-3_rk  !< of a substep in time, relative [-]
      ! Sources of heat at points of the rock, as electric heaters; unallocated: none.
      real(rk), allocatable :: source_x(:), source_y(:)  !< [m]
      real(rk), allocatable :: source_power(:)  !< [W/m]
      real(rk) :: source_cell_size = 0.0_rk  !< of cells there; 0: no smaller ones [m]
   end type heat_t

   !> Change of temperature in a scene without a fluid, at load factor 1.
   type :: temperature_t
      real(rk) :: change = 0.0_rk  !< at x_datum, y_datum [K]
      real(rk) :: per_metre(2) = 0.0_rk  !< in x and y [K/m]
      real(rk) :: datum(2) = 0.0_rk  !< [m]
      real(rk) :: face_change = 0.0_rk  !< of a plane face of a half-space [K]
      real(rk) :: face(2) = 0.0_rk  !< a point of it [m]
      real(rk) :: face_inward = 0.0_rk  !< direction into the rock, from the x axis [rad]
      real(rk) :: face_depth = 0.0_rk  !< 2 sqrt(D t) of the front from it; 0: none [m]
   contains
      procedure :: at
   end type temperature_t

contains

   !> Change of temperature at a point: linear, and the front of a face that has changed at once.
   pure real(rk) function at(self, xy) result(change)
      class(temperature_t), intent(in) :: self
      real(rk), intent(in) :: xy(2)  !< [m]
      real(rk) :: distance

      change = self%change + dot_product(self%per_metre, xy - self%datum)
      if (.not. self%face_depth > 0.0_rk) return
      distance = dot_product(xy - self%face, [cos(self%face_inward), sin(self%face_inward)])
      change = change + self%face_change*erfc(max(0.0_rk, distance)/self%face_depth)
   end function at

end module scene_heat
