!> The field of unit stress intensity, in the axes of the tip (Muskhelishvili's functions).
!!
!! With Phi(z) = Omega(z) = (K_I - i K_II)/(2 sqrt(2 pi z)), z = x + i y and ' = d/dz,
!!    s22 - i s12 = Phi(z) + Omega(conj z) + (z - conj z) conj(Phi'(z)),   s11 + s22 = 4 Re Phi(z),
!!    2 mu d(u1 + i u2)/dx1 = kappa Phi(z) - Omega(conj z) - (z - conj z) conj(Phi'(z)).
!! Derivatives along the crack have Phi', Omega' and Phi'' in the place of Phi, Omega and Phi'.
module fine_tip_field
   use base_kinds, only: ik, pi, rk
   use base_plane, only: norm2
   implicit none(type, external)
   private

   public :: auxiliary_field, auxiliary_field_t, root_of_place, singular_stress, tip_field_t

   !> The field at one point.
   type :: auxiliary_field_t
      real(rk) :: stress(2, 2)  !< [Pa per Pa m^1/2]
      real(rk) :: slope(2)  !< du/dx1 [1 per Pa m^1/2]
      real(rk) :: strain_slope(2, 2)  !< d(in-plane strain)/dx1 [1/m per Pa m^1/2]
   end type auxiliary_field_t

   !> The field of a tip in space.
   type :: tip_field_t
      real(rk) :: origin(2) = 0.0_rk  !< [m]
      real(rk) :: ahead(2) = 0.0_rk  !< unit vector
      real(rk) :: intensity(2) = 0.0_rk  !< K_I, K_II [Pa m^1/2]
      real(rk) :: kolosov = 0.0_rk  !< [-]
      real(rk) :: shear_modulus = 0.0_rk  !< [Pa]
   end type tip_field_t

contains

   !> Stress (xx yy xy) of a tip's field at a point [Pa]. The polar angle is continued from that of
   !! `same_side`, a point on the same side of the crack.
   pure function singular_stress(field, xy, same_side) result(stress)
      type(tip_field_t), intent(in) :: field
      real(rk), intent(in) :: xy(2), same_side(2)  !< [m]
      real(rk) :: stress(3)
      real(rk) :: axes(2, 2), place(2), near(2), tensor(2, 2)
      type(auxiliary_field_t) :: unit
      complex(rk) :: root_z
      integer(ik) :: mode

      axes(1, :) = field%ahead
      axes(2, :) = [-field%ahead(2), field%ahead(1)]
      place = matmul(axes, xy - field%origin)
      near = matmul(axes, same_side - field%origin)
      root_z = root_of_place(place, atan2(near(2), near(1)))
      tensor = 0.0_rk
      do mode = 1, 2
         unit = auxiliary_field(mode, root_z, field%kolosov, field%shear_modulus)
         tensor = tensor + field%intensity(mode)*unit%stress
      end do
      tensor = matmul(transpose(axes), matmul(tensor, axes))
      stress = [tensor(1, 1), tensor(2, 2), tensor(1, 2)]
   end function singular_stress

   !> The root of z = x + i y on the branch where the polar angle is nearest to a given one.
   pure complex(rk) function root_of_place(place, reference) result(root_z)
      real(rk), intent(in) :: place(2)  !< x, y [m]
      real(rk), intent(in) :: reference  !< [rad]
      real(rk) :: angle

      angle = atan2(place(2), place(1))
      angle = angle + 2.0_rk*pi*nint((reference - angle)/(2.0_rk*pi))
      root_z = sqrt(norm2(place))*exp(cmplx(0.0_rk, 0.5_rk*angle, rk))
   end function root_of_place

   !> The field of mode 1 or 2 at z = root_z**2. The branch of the root decides on which side of the
   !! crack a point lies: the upper face has root_z = i*sqrt(r), the lower one -i*sqrt(r).
   elemental function auxiliary_field(mode, root_z, kolosov, shear_modulus) result(field)
      integer(ik), intent(in) :: mode  !< 1 or 2
      complex(rk), intent(in) :: root_z  !< [m^1/2]
      real(rk), intent(in) :: kolosov  !< [-]
      real(rk), intent(in) :: shear_modulus  !< [Pa]
      type(auxiliary_field_t) :: field
      complex(rk) :: factor, phi, phi_slope, omega, omega_slope, bent, bent_slope, traction, slope
      real(rk) :: stress_slope(2, 2), mean

      factor = merge((1.0_rk, 0.0_rk), (0.0_rk, -1.0_rk), mode == 1)/(2.0_rk*sqrt(2.0_rk*pi))
      phi = factor/root_z
      phi_slope = -0.5_rk*phi/root_z**2
      omega = factor/conjg(root_z)
      omega_slope = -0.5_rk*omega/conjg(root_z**2)
      bent = cmplx(0.0_rk, 2.0_rk*aimag(root_z**2), rk)*conjg(phi_slope)
      bent_slope = -1.5_rk*bent/conjg(root_z**2)
      traction = phi + omega + bent
      slope = (kolosov*phi - omega - bent)/(2.0_rk*shear_modulus)
      field%stress(2, 2) = real(traction, rk)
      field%stress(1, 2) = -aimag(traction)
      field%stress(2, 1) = field%stress(1, 2)
      field%stress(1, 1) = 4.0_rk*real(phi, rk) - field%stress(2, 2)
      field%slope = [real(slope, rk), aimag(slope)]
      traction = phi_slope + omega_slope + bent_slope
      stress_slope(2, 2) = real(traction, rk)
      stress_slope(1, 2) = -aimag(traction)
      stress_slope(2, 1) = stress_slope(1, 2)
      stress_slope(1, 1) = 4.0_rk*real(phi_slope, rk) - stress_slope(2, 2)
      ! 2 mu strain = stress - lambda/(2 (lambda + mu)) trace, and that factor is (3 - kappa)/4.
      mean = 0.25_rk*(3.0_rk - kolosov)*(stress_slope(1, 1) + stress_slope(2, 2))
      field%strain_slope = stress_slope
      field%strain_slope(1, 1) = stress_slope(1, 1) - mean
      field%strain_slope(2, 2) = stress_slope(2, 2) - mean
      field%strain_slope = field%strain_slope/(2.0_rk*shear_modulus)
   end function auxiliary_field

end module fine_tip_field
