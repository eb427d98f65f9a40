!> Closed solutions for a straight crack of half-length a in an infinite plane (Muskhelishvili
!! 1953).
module exact_cracks
   use base_kinds, only: rk
   use fine_elasticity, only: elasticity_t
   implicit none(type, external)
   private

   public :: centre_crack, uniform_field

contains

   !> Displacement [m] at a point, crack on |x| < a, y = 0, remote stress zero, the faces loaded
   !! by the tractions that drop the normal stress by `normal` and the shear stress by `shear`:
   !! stress on the line of the crack -normal, -shear within it, K_I = normal sqrt(pi a), K_II =
   !! shear sqrt(pi a).
   pure function centre_crack(elasticity, half_length, normal, shear, xy, &
                              above) result(displacement)
      type(elasticity_t), intent(in) :: elasticity
      real(rk), intent(in) :: half_length  !< a [m]
      real(rk), intent(in) :: normal, shear  !< [Pa]
      real(rk), intent(in) :: xy(2)  !< [m]
      logical, intent(in) :: above  !< which face is meant where the point lies on the crack
      real(rk) :: displacement(2)
      complex(rk) :: z, root, root_conjugate, factor, value

      ! 2 mu (u + i v) = kappa phi(z) - omega(conj z) - (z - conj z) conj(phi'(z)), phi = omega =
      ! (normal - i shear)/2 (sqrt(z**2 - a**2) - z).
      z = cmplx(xy(1), xy(2), rk)
      root = crack_root(z, above)
      root_conjugate = conjg(root)
      factor = 0.5_rk*cmplx(normal, -shear, rk)
      value = elasticity%kolosov()*factor*(root - z) - factor*(root_conjugate - conjg(z))
      if (abs(root) > 0.0_rk) value = value - (z - conjg(z))*conjg(factor*(z/root - 1.0_rk))
      value = value/(2.0_rk*elasticity%shear_modulus())
      displacement = [real(value, rk), aimag(value)]

   contains

      !> sqrt(z**2 - a**2), cut along the crack, about z far away.
      pure complex(rk) function crack_root(z, above)
         complex(rk), intent(in) :: z
         logical, intent(in) :: above

         if (.not. abs(aimag(z)) > 1.0e-12_rk*half_length .and. abs(real(z, rk)) < half_length) then
            crack_root = cmplx(0.0_rk, sqrt(half_length**2 - real(z, rk)**2), rk)
            if (.not. above) crack_root = -crack_root
         else
            crack_root = sqrt(z - half_length)*sqrt(z + half_length)  ! cuts cancel left of it
         end if
      end function crack_root

   end function centre_crack

   !> Displacement of uniform strain under a uniform stress without rotation [m].
   pure function uniform_field(elasticity, stress, xy) result(displacement)
      type(elasticity_t), intent(in) :: elasticity
      real(rk), intent(in) :: stress(3)  !< s_xx, s_yy, s_xy [Pa], without pore pressure
      real(rk), intent(in) :: xy(2)  !< [m]
      real(rk) :: displacement(2)
      real(rk) :: strain(2, 2), mean, mu

      mu = elasticity%shear_modulus()
      mean = elasticity%lame_lambda()*(stress(1) &
                                       + stress(2))/(2.0_rk*(elasticity%lame_lambda() + mu))
      strain(1, 1) = (stress(1) - mean)/(2.0_rk*mu)
      strain(2, 2) = (stress(2) - mean)/(2.0_rk*mu)
      strain(1, 2) = stress(3)/(2.0_rk*mu)
      strain(2, 1) = strain(1, 2)
      displacement = matmul(strain, xy)
   end function uniform_field

end module exact_cracks
