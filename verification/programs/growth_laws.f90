!> Kink angles, equivalent intensities, energy release and increments (verification/kink_angles),
!! for the rows of the catalogue's tables 2.1, 2.3 and 2.4.
program growth_laws
   use base_kinds, only: degree => radians, ik, rk
   use growth_law, only: advances, energy_release_rate, equivalent_intensity, kink_angle
   use verification_files, only: finish, table_t
   implicit none(type, external)

   real(rk), parameter :: k1(14) = [1.0_rk, 1.0_rk, 1.0_rk, 1.0_rk, 1.0_rk, 1.0_rk, 0.5_rk, &
                                    0.2_rk, 0.0_rk, 0.0_rk, 1.0_rk, -0.2_rk, -1.0_rk, -2.0_rk]
   real(rk), parameter :: k2(14) = [0.0_rk, 1.0e-9_rk, 0.1_rk, 0.25_rk, 0.5_rk, 1.0_rk, 1.0_rk, &
                                    1.0_rk, 1.0_rk, -1.0_rk, -0.5_rk, 1.0_rk, 1.0_rk, 1.0_rk]
   real(rk), parameter :: crack_modulus = 4.0e10_rk/(1.0_rk - 0.2_rk**2)  ! E' of table 2.3 [Pa]
   type(table_t) :: table
   real(rk) :: angle, length(3)
   integer(ik) :: i

   call table%open("angles.csv", "row,k1,k2,angle_deg,k_equivalent")
   do i = 1, size(k1, kind=ik)
      angle = kink_angle(k1(i), k2(i))
call table%row([real(i, rk), k1(i), k2(i), angle/degree, equivalent_intensity(k1(i), k2(i), angle)])
   end do
   call table%close()
   length = advances([10.0_rk, 5.0_rk, 1.0_rk], spread(.true., 1, 3), 0.01_rk, 0.35_rk)
   call table%open("laws.csv", "advance_1_m,advance_2_m,advance_3_m,energy_j_m2")
   angle = kink_angle(1.0e6_rk, 4.0e5_rk)
   call table%row([length, energy_release_rate(1.0e6_rk, 4.0e5_rk, angle, crack_modulus)])
   call table%close()
   call finish()

end program growth_laws
