!> Closed solutions for a straight crack of half-length a in an infinite plane (Muskhelishvili
!! 1953).
module exact_cracks
   use base_kinds, only: rk
   use fine_elasticity, only: elasticity_t
   implicit none(type, external)
   private

   public :: bent_crack, centre_crack, uniform_field

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
      root = crack_root(z, half_length, above)
      root_conjugate = conjg(root)
      factor = 0.5_rk*cmplx(normal, -shear, rk)
      value = elasticity%kolosov()*factor*(root - z) - factor*(root_conjugate - conjg(z))
      if (abs(root) > 0.0_rk) value = value - (z - conjg(z))*conjg(factor*(z/root - 1.0_rk))
      value = value/(2.0_rk*elasticity%shear_modulus())
      displacement = [real(value, rk), aimag(value)]
   end function centre_crack

   !> Displacement [m] of a body bent by s_yy = slope*x with a crack on |x| < a, y = 0 that can open
   !! but not overlap: it opens on -a/3 < x < a, where its faces part smoothly, and K_I is
   !! slope*(2a/3)*sqrt(pi*2a/3) at x = a, 0 at the other end (superposition of Muskhelishvili's
   !! solutions for a crack from -a/3 to a under uniform and linear traction, so that the intensity
   !! vanishes at its left end). Plane strain.
   pure function bent_crack(elasticity, half_length, slope, xy, above) result(displacement)
      type(elasticity_t), intent(in) :: elasticity
      real(rk), intent(in) :: half_length  !< a [m]
      real(rk), intent(in) :: slope  !< [Pa/m]
      real(rk), intent(in) :: xy(2)  !< [m]
      logical, intent(in) :: above  !< which face is meant where the point lies on the crack
      real(rk) :: displacement(2)
      complex(rk) :: z, root, phi, phi_slope, value
      real(rk) :: half_open, ratio, centred(2)

      half_open = 2.0_rk*half_length/3.0_rk
      centred = xy - [half_length/3.0_rk, 0.0_rk]
      displacement = centre_crack(elasticity, half_open, slope*half_length/3.0_rk, 0.0_rk, &
                                  centred, above)
      ! Linear part: phi = slope/4 (z root - z**2), z and root about the open part.
      z = cmplx(centred(1), centred(2), rk)
      root = crack_root(z, half_open, above)
      phi = 0.25_rk*slope*(z*root - z**2)
      value = elasticity%kolosov()*phi - 0.25_rk*slope*(conjg(z)*conjg(root) - conjg(z)**2)
      if (abs(root) > 0.0_rk) then
         phi_slope = 0.5_rk*slope*((z**2 - 0.5_rk*half_open**2)/root - z)
         value = value - (z - conjg(z))*conjg(phi_slope)
      end if
      value = value/(2.0_rk*elasticity%shear_modulus())
      ! Bending without a crack.
      ratio = elasticity%poisson/(1.0_rk - elasticity%poisson)
      displacement = displacement + [real(value, rk), aimag(value)] &
                     + slope/elasticity%crack_modulus() &
                     *[-0.5_rk*(ratio*xy(1)**2 + xy(2)**2), xy(1)*xy(2)]
   end function bent_crack

   !> sqrt(z**2 - a**2), cut along the crack, about z far away.
   pure complex(rk) function crack_root(z, half_length, above)
      complex(rk), intent(in) :: z  !< [m]
      real(rk), intent(in) :: half_length  !< a [m]
      logical, intent(in) :: above

      if (.not. abs(aimag(z)) > 1.0e-12_rk*half_length .and. abs(real(z, rk)) < half_length) then
         crack_root = cmplx(0.0_rk, sqrt(half_length**2 - real(z, rk)**2), rk)
         if (.not. above) crack_root = -crack_root
      else
         crack_root = sqrt(z - half_length)*sqrt(z + half_length)  ! cuts cancel left of it
      end if
   end function crack_root

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
