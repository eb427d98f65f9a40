!> The growth law of a tip: whether it grows, in which direction, and how far.
module growth_law
   use base_kinds, only: rk
   implicit none(type, external)
   private

   public :: advances, carry_over, energy_release_rate, equivalent_intensity, growth_drive
   public :: growth_drive_t, in_grains, kink_angle, kinked_intensities, new_tip

   !> share of the rosette radius; shorter advances are carried over [-]
   real(rk), parameter :: smallest_advance = 0.4_rk

   !> Crack driving forces at a tip.
   type :: growth_drive_t
      real(rk) :: angle = 0.0_rk  !< kink angle, anticlockwise positive [rad]
      real(rk) :: intensity = 0.0_rk  !< K_eq at that angle [Pa m^1/2]
      real(rk) :: energy = 0.0_rk  !< G at that angle [J/m2]
      !> K_IC of the rock at the tip over K_IC of the scene; `intensity` is divided by this ratio,
      !! so that all tips are compared with the K_IC of the scene [-]
      real(rk) :: resistance = 1.0_rk
      real(rk) :: crack_modulus = 0.0_rk  !< E' of the rock around the tip [Pa]
   end type growth_drive_t

contains

   !> Angle of the largest tangential stress (Erdogan and Sih 1963), in a form without division by
   !! quantities that vanish with k2, and whose squares neither over- nor underflow. Zero where both
   !! intensities vanish.
   elemental real(rk) function kink_angle(k1, k2)
      real(rk), intent(in) :: k1, k2  !< [Pa m^1/2]

      kink_angle = 2.0_rk*atan2(-2.0_rk*k2, k1 + hypot(k1, sqrt(8.0_rk)*k2))
   end function kink_angle

   !> Tangential stress at an angle times sqrt(2 pi r) [Pa m^1/2].
   elemental real(rk) function equivalent_intensity(k1, k2, angle)
      real(rk), intent(in) :: k1, k2  !< [Pa m^1/2]
      real(rk), intent(in) :: angle  !< [rad]

      equivalent_intensity = cos(0.5_rk*angle)*(k1*cos(0.5_rk*angle)**2 - 1.5_rk*k2*sin(angle))
   end function equivalent_intensity

   !> Intensities of a vanishingly short kink, to first order in its angle (Cotterell and Rice
   !! 1980).
   elemental subroutine kinked_intensities(k1, k2, angle, kinked_1, kinked_2)
      real(rk), intent(in) :: k1, k2  !< [Pa m^1/2]
      real(rk), intent(in) :: angle  !< [rad]
      real(rk), intent(out) :: kinked_1, kinked_2  !< [Pa m^1/2]
      real(rk) :: half, triple

      half = 0.5_rk*angle
      triple = 1.5_rk*angle
      kinked_1 = 0.25_rk*((3.0_rk*cos(half) + cos(triple))*k1 - 3.0_rk*(sin(half) + sin(triple))*k2)
      kinked_2 = 0.25_rk*((sin(half) + sin(triple))*k1 + (cos(half) + 3.0_rk*cos(triple))*k2)
   end subroutine kinked_intensities

   !> Energy release rate of a kink at an angle [J/m2].
   elemental real(rk) function energy_release_rate(k1, k2, angle, crack_modulus)
      real(rk), intent(in) :: k1, k2  !< [Pa m^1/2]
      real(rk), intent(in) :: angle  !< [rad]
      real(rk), intent(in) :: crack_modulus  !< E' [Pa]
      real(rk) :: kinked_1, kinked_2

      call kinked_intensities(k1, k2, angle, kinked_1, kinked_2)
      energy_release_rate = (kinked_1**2 + kinked_2**2)/crack_modulus
   end function energy_release_rate

   !> Driving forces at a tip. A negative k1 means overlapping faces, or a numerical error at closed
   !! faces, and counts as zero.
   elemental function growth_drive(k1, k2, crack_modulus) result(drive)
      real(rk), intent(in) :: k1, k2  !< [Pa m^1/2]
      real(rk), intent(in) :: crack_modulus  !< E' [Pa]
      type(growth_drive_t) :: drive
      real(rk) :: opening

      opening = max(k1, 0.0_rk)
      drive%crack_modulus = crack_modulus
      drive%angle = kink_angle(opening, k2)
      drive%intensity = equivalent_intensity(opening, k2, drive%angle)
      drive%energy = energy_release_rate(opening, k2, drive%angle, crack_modulus)
   end function growth_drive

   !> Advance of each tip [m]: l_max*(G/max G)**exponent where it grows, else 0 (Paris-type law of
   !! Renshaw and Pollard 1994).
   pure function advances(energy, grows, increment, exponent) result(advance)
      real(rk), intent(in) :: energy(:)  !< G of each tip [J/m2]
      logical, intent(in) :: grows(size(energy))
      real(rk), intent(in) :: increment  !< l_max [m]
      real(rk), intent(in) :: exponent  !< [-]
      real(rk) :: advance(size(energy))
      real(rk) :: largest

      largest = maxval(energy, mask=grows)
      advance = 0.0_rk
      where (grows .and. energy > 0.0_rk) advance = increment*(energy/largest)**exponent
   end function advances

   !> Add the advance carried over from earlier increments; a sum too short for the mesh around the
   !! tip is carried over again.
   elemental subroutine carry_over(advance, carried, rosette_radius, applied, left)
      real(rk), intent(in) :: advance  !< advance by the growth law [m]
      real(rk), intent(in) :: carried  !< carried over from earlier increments [m]
      real(rk), intent(in) :: rosette_radius  !< [m]
      real(rk), intent(out) :: applied  !< the whole sum, or 0 [m]
      real(rk), intent(out) :: left  !< to carry over [m]

      applied = advance + carried
      left = 0.0_rk
      if (applied < smallest_advance*rosette_radius) then
         left = applied
         applied = 0.0_rk
      end if
   end subroutine carry_over

   !> Value rounded to a multiple of 1e-7 units. Meshes for tips that differ in their last bits may
   !! differ in topology, with intensities that differ by their discretization errors. The rounding
   !! of kinks and advances is far below these errors; with it, responses that are equal except for
   !! rounding errors lead to equal tips.
   elemental real(rk) function in_grains(value, unit)
      real(rk), intent(in) :: value, unit  !< of the same dimension
      real(rk), parameter :: grain = 1.0e-7_rk

      in_grains = grain*unit*anint(value/(grain*unit))
   end function in_grains

   !> Position of a tip after an increment [m].
   pure function new_tip(tip, direction, angle, advance) result(xy)
      real(rk), intent(in) :: tip(2)  !< [m]
      real(rk), intent(in) :: direction(2)  !< unit vector, ahead of the tip [-]
      real(rk), intent(in) :: angle  !< kink angle, anticlockwise [rad]
      real(rk), intent(in) :: advance  !< [m]
      real(rk) :: xy(2)

      xy = tip + advance*(cos(angle)*direction + sin(angle)*[-direction(2), direction(1)])
   end function new_tip

end module growth_law
