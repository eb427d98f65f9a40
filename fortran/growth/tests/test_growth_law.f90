!> Growth law against closed values (catalogue 2.1, 2.3, 2.4).
program test_growth_law
   use base_kinds, only: degree => radians, ik, pi, rk
   use growth_law, only: advances, carry_over, energy_release_rate, equivalent_intensity, &
                         growth_drive, growth_drive_t, kink_angle, kinked_intensities, new_tip
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks

   call angles()
   call maximum()
   call cotterell_rice()
   call energy()
   call steps()
   call checks%finish()

contains

   !> Values that are exact: tan(angle/2) = -2 K_II/(K_I + sqrt(K_I**2 + 8 K_II**2)).
   subroutine angles()
      type(growth_drive_t) :: drive

      call checks%is_close(kink_angle(1.0_rk, 0.0_rk), 0.0_rk, 0.0_rk, "mode I goes straight on")
      call checks%is_close(kink_angle(0.0_rk, 1.0_rk), -acos(1.0_rk/3.0_rk), 1.0e-12_rk, &
                           "mode II: 70.53 degrees")
      call checks%is_close(kink_angle(0.0_rk, -1.0_rk), acos(1.0_rk/3.0_rk), 1.0e-12_rk, &
                           "mode II, other sign")
      call checks%is_close(kink_angle(1.0_rk, 1.0_rk), -2.0_rk*atan(0.5_rk), 1.0e-12_rk, &
                           "K_I = K_II: 53.13 degrees")
      call checks%is_close(kink_angle(-1.0_rk, 1.0_rk), -0.5_rk*pi, 1.0e-12_rk, &
                           "K_I = -K_II: 90 degrees")
      call checks%is_close(kink_angle(1.0_rk, 1.0e-9_rk)/degree, -1.14591559e-07_rk, 1.0e-15_rk, &
                           "vanishing K_II")
      call checks%is_close(kink_angle(1.0_rk, 0.5_rk)/degree, -40.20781872_rk, 1.0e-8_rk, &
                           "K_II = K_I/2")
      call checks%is_close(kink_angle(-2.0_rk, 1.0_rk)/degree, -107.5879538_rk, 1.0e-7_rk, &
                           "K_I = -2 K_II")
      call checks%is_close(kink_angle(-1.0_rk, 0.0_rk), 0.0_rk, 0.0_rk, &
                           "a closed tip without shear")
      call checks%is_close(kink_angle(0.0_rk, 0.0_rk), 0.0_rk, 0.0_rk, "an unloaded tip")
      call checks%is_close(equivalent_intensity(0.0_rk, 1.0_rk, kink_angle(0.0_rk, 1.0_rk)), &
                           2.0_rk/sqrt(3.0_rk), &
                           1.0e-12_rk, "K_eq of mode II")
      call checks%is_close(equivalent_intensity(1.0_rk, 1.0_rk, kink_angle(1.0_rk, 1.0_rk)), &
                           0.8_rk*sqrt(5.0_rk), &
                           1.0e-12_rk, "K_eq of K_I = K_II")
      call checks%is_close(equivalent_intensity(1.0_rk, 0.1_rk, kink_angle(1.0_rk, 0.1_rk)), &
                           1.014746528_rk, 1.0e-9_rk, &
                           "K_eq of K_II = K_I/10")
      drive = growth_drive(-3.0_rk, 1.0_rk, 2.0_rk)
      call checks%is_close(drive%angle, -acos(1.0_rk/3.0_rk), 1.0e-12_rk, &
                           "a negative K_I counts as zero")
      call checks%is_close(drive%intensity, 2.0_rk/sqrt(3.0_rk), 1.0e-12_rk, "and so for K_eq")
      call checks%is_close(drive%energy, 2.0_rk/3.0_rk, 1.0e-12_rk, "and for G")
      drive = growth_drive(-3.0_rk, 0.0_rk, 2.0_rk)
      call checks%is_close(abs(drive%angle) + drive%intensity + drive%energy, 0.0_rk, 0.0_rk, &
                           "nothing drives a closed tip")
   end subroutine angles

   !> No other angle has a larger tangential stress.
   subroutine maximum()
      real(rk) :: k1, k2, best
      integer(ik) :: i, j

      do i = 0, 8
         k1 = cos(0.25_rk*pi*(i - 4)*0.5_rk)
         k2 = sin(0.25_rk*pi*(i - 4)*0.5_rk)
         best = equivalent_intensity(k1, k2, kink_angle(k1, k2))
         call checks%is_true(all([(equivalent_intensity(k1, k2, j*degree) <= best + 1.0e-15_rk, &
                                   j=-179, 179)]), &
                             "the angle is the best")
      end do
   end subroutine maximum

   !> Catalogue 1.7, columns C11 to C22.
   subroutine cotterell_rice()
      real(rk) :: along(2), across(2)

      call kinked_intensities(1.0_rk, 0.0_rk, 45.0_rk*degree, along(1), along(2))
      call kinked_intensities(0.0_rk, 1.0_rk, 45.0_rk*degree, across(1), across(2))
      call checks%is_close(along(1), 0.7885805075_rk, 1.0e-10_rk, "C11")
      call checks%is_close(across(1), -0.9799222237_rk, 1.0e-10_rk, "C12")
      call checks%is_close(along(2), 0.3266407412_rk, 1.0e-10_rk, "C21")
      call checks%is_close(across(2), 0.5179824574_rk, 1.0e-10_rk, "C22")
   end subroutine cotterell_rice

   !> Catalogue 2.3: E = 40 GPa, nu = 0.2, plane strain.
   subroutine energy()
      real(rk), parameter :: modulus = 40.0e9_rk/0.96_rk
      real(rk) :: angle, kinked(2)

      angle = kink_angle(1.0e6_rk, 0.4e6_rk)
      call checks%is_close(energy_release_rate(1.0e6_rk, 0.4e6_rk, angle, modulus), &
                           34.31372706_rk, 1.0e-8_rk, "G of the kink")
      call checks%is_close(energy_release_rate(1.0e6_rk, 0.4e6_rk, 0.0_rk, modulus), 27.84_rk, &
                           1.0e-12_rk, "G straight ahead")
      call kinked_intensities(1.0e6_rk, 0.4e6_rk, angle, kinked(1), kinked(2))
      call checks%is_close(kinked(2), 0.0_rk, 1.0e-9_rk, "no shear on the kink")
      call checks%is_close(kinked(1), equivalent_intensity(1.0e6_rk, 0.4e6_rk, angle), 1.0e-8_rk, &
                           "K_I of the kink is K_eq")
   end subroutine energy

   !> Catalogue 2.4; advances that are too short are carried over.
   subroutine steps()
      real(rk) :: advance(3), applied, kept, left, tip(2)

      advance = advances([10.0_rk, 5.0_rk, 1.0_rk], [.true., .true., .true.], 0.01_rk, 0.35_rk)
      call checks%is_close(advance(1), 0.01_rk, 1.0e-15_rk, "advance of the strongest tip")
      call checks%is_close(advance(2), 0.007845840979_rk, 1.0e-12_rk, "advance of the second")
      call checks%is_close(advance(3), 0.004466835922_rk, 1.0e-12_rk, "advance of the third")
      advance = advances([10.0_rk, 5.0_rk, 1.0_rk], [.false., .true., .true.], 0.01_rk, 0.35_rk)
      call checks%is_close(advance(1), 0.0_rk, 0.0_rk, "a tip below toughness stays")
      call checks%is_close(advance(2), 0.01_rk, 1.0e-15_rk, "the strongest of those that grow")
      advance = advances([10.0_rk, 5.0_rk, 1.0_rk], [.false., .false., .false.], 0.01_rk, 0.35_rk)
      call checks%is_close(maxval(advance), 0.0_rk, 0.0_rk, "no tip grows")

      call carry_over(0.3_rk, 0.0_rk, 1.0_rk, applied, kept)
      call checks%is_close(applied, 0.0_rk, 0.0_rk, "too short to be meshed")
      call checks%is_close(kept, 0.3_rk, 0.0_rk, "but not lost")
      call carry_over(0.2_rk, kept, 1.0_rk, applied, left)
      call checks%is_close(applied, 0.5_rk, 1.0e-15_rk, "added to the next one")
      call checks%is_close(left, 0.0_rk, 0.0_rk, "and used up")

      tip = new_tip([1.0_rk, 2.0_rk], [0.0_rk, 1.0_rk], 0.5_rk*pi, 0.1_rk)
      call checks%is_close(tip(1), 0.9_rk, 1.0e-15_rk, "an anticlockwise kink goes to the left: x")
      call checks%is_close(tip(2), 2.0_rk, 1.0e-15_rk, "an anticlockwise kink goes to the left: y")
   end subroutine steps

end program test_growth_law
