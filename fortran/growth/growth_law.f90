!> The growth law of a tip: whether it grows, in which direction, and how far.
module growth_law
   use base_kinds, only: rk
   implicit none(type, external)
   private

   public :: advances, carry_over, energy_release_rate, equivalent_intensity, growth_drive
   public :: growth_drive_t, in_grains, kink_angle, kinked_intensities, new_tip

   real(rk), parameter :: smallest_advance = 0.4_rk  !< of the rosette radius; less is carried over

   !> What drives a tip.
   type :: growth_drive_t
      real(rk) :: angle = 0.0_rk  !< of the kink, anticlockwise positive [rad]
      real(rk) :: intensity = 0.0_rk  !< K_eq at that angle [Pa m^1/2]
      real(rk) :: energy = 0.0_rk  !< G at that angle [J/m2]
      !> K_IC of the rock that the tip grows in over that of the scene's rock, by which all tips are
      !! judged: the intensity is over this [-]
      real(rk) :: resistance = 1.0_rk
      real(rk) :: crack_modulus = 0.0_rk  !< E' of the rock around the tip [Pa]
   end type growth_drive_t

contains

   !> Angle at which the tangential stress is largest (Erdogan and Sih 1963), in a form that
   !! divides by nothing that vanishes with k2, and whose squares neither over- nor underflow. Zero
   !! where nothing drives the tip.
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

   !> G of a kink at the given angle [J/m2].
   elemental real(rk) function energy_release_rate(k1, k2, angle, crack_modulus)
      real(rk), intent(in) :: k1, k2  !< [Pa m^1/2]
      real(rk), intent(in) :: angle  !< [rad]
      real(rk), intent(in) :: crack_modulus  !< E' [Pa]
      real(rk) :: kinked_1, kinked_2

      call kinked_intensities(k1, k2, angle, kinked_1, kinked_2)
      energy_release_rate = (kinked_1**2 + kinked_2**2)/crack_modulus
   end function energy_release_rate

   !> Direction and strength of what drives a tip. A negative k1 means faces that overlap or a
   !! solver's error at closed ones, and counts as zero.
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

   !> An advance too short for the mesh around a tip is kept for the next time.
   elemental subroutine carry_over(advance, carried, rosette_radius, applied, left)
      real(rk), intent(in) :: advance  !< wanted now [m]
      real(rk), intent(in) :: carried  !< kept from before [m]
      real(rk), intent(in) :: rosette_radius  !< [m]
      real(rk), intent(out) :: applied  !< to grow by now: all or nothing [m]
      real(rk), intent(out) :: left  !< to keep [m]

      applied = advance + carried
      left = 0.0_rk
      if (applied < smallest_advance*rosette_radius) then
         left = applied
         applied = 0.0_rk
      end if
   end subroutine carry_over

   !> The nearest multiple of a grain. A mesh made for a tip that differs in its last bits may be
   !! quite another one, with intensities that differ by their errors. Kinks and advances in grains,
   !! far below these errors, let responses that are equal but for rounding grow to equal tips.
   elemental real(rk) function in_grains(value, unit)
      real(rk), intent(in) :: value, unit  !< of one kind; a grain is a ten-millionth of the unit
      real(rk), parameter :: grain = 1.0e-7_rk

      in_grains = grain*unit*anint(value/(grain*unit))
   end function in_grains

   !> Where a tip is after its growth [m].
   pure function new_tip(tip, direction, angle, advance) result(xy)
      real(rk), intent(in) :: tip(2)  !< [m]
      real(rk), intent(in) :: direction(2)  !< unit vector, ahead of the tip [-]
      real(rk), intent(in) :: angle  !< of the kink, anticlockwise [rad]
      real(rk), intent(in) :: advance  !< [m]
      real(rk) :: xy(2)

      xy = tip + advance*(cos(angle)*direction + sin(angle)*[-direction(2), direction(1)])
   end function new_tip

end module growth_law
