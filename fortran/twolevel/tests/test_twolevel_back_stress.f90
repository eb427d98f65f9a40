!> The back stress of layers of fluid pressure: integrals with the weight function of a half-plane
!! crack, and a layer on the faces of a crack.
program test_twolevel_back_stress
   use base_kinds, only: rk
   use testing_checks, only: checks_t
   use twolevel_back_stress, only: weighted
   implicit none(type, external)

   type(checks_t) :: checks

   call test_one_long_strip()
   call test_strips()
   call checks%finish()

contains

   !> On a long strip from the tip on, a pressure that is linear in the distance has its half moment
   !! times the root of two. The strip ends far away: 1e-12 of it is missing.
   subroutine test_one_long_strip()
      real(rk), parameter :: thickness = 0.01_rk  ! [m]

      call checks%is_close(weighted([0.0_rk, 1.0e6_rk], [0.0_rk, 0.3_rk*thickness, thickness], &
                                    [1.0_rk, 0.7_rk, 0.0_rk]), &
                           sqrt(2.0_rk*thickness)*4.0_rk/3.0_rk, 1.0e-9_rk, "half moment")
   end subroutine test_one_long_strip

   !> Strips of finite length, against the same integrals with 400 points.
   subroutine test_strips()
      real(rk), parameter :: place(3) = [0.0_rk, 0.002_rk, 0.006_rk]  ! [m]
      real(rk), parameter :: pressure(3) = [5.0_rk, 3.0_rk, 0.0_rk]  ! [Pa]
      real(rk) :: near, far

      near = weighted([0.0_rk, 0.01_rk], place, pressure)
      far = weighted([0.01_rk, 0.03_rk], place, pressure)
      call checks%is_close(near, 0.673712865146_rk, 1.0e-6_rk, "at the tip")
      call checks%is_close(far, 0.020496054836_rk, 1.0e-6_rk, "behind it")
      call checks%is_close(weighted([0.0_rk, 0.03_rk], place, pressure), near + far, 1.0e-12_rk, &
                           "both")
   end subroutine test_strips

end program test_twolevel_back_stress
