!> The numbers that the regime of growth is known by, against values worked out by hand.
program test_scene_regime
   use base_kinds, only: pi, rk
   use scene_regime, only: dimensionless_leakoff, dimensionless_toughness, find_regime, regime_words
   use scene_types, only: fracture_t, injection_t, scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: rate = 1.0e-5_rk  !< [m2/s]
   type(checks_t) :: checks
   type(scene_t) :: scene

   call start()
   call test_toughness()
   call test_leakoff()
   call test_wells()
   call checks%finish()

contains

   !> E' = 32 GPa, and no storage but that of the fluid.
   subroutine start()
      scene%growth%enabled = .true.
      scene%material%young = 30.0e9_rk
      scene%material%poisson = 0.25_rk
      scene%material%toughness = 1.0e6_rk
      scene%material%biot = 0.0_rk
      scene%material%porosity = 0.1_rk
      scene%material%permeability_xx = 4.0e-18_rk
      scene%material%permeability_yy = 1.0e-18_rk
      scene%material%storage = "textbook"
      scene%fluid%viscosity = 1.0e-3_rk
      scene%fluid%compressibility = 5.0e-10_rk
      scene%initial%pressure = 1.0e6_rk
      scene%time%end = 100.0_rk
      scene%fractures = [fracture_t(name="a", x=[0.0_rk, 1.0_rk], y=[0.0_rk, 0.0_rk], &
                                    toughness=1.0e6_rk)]
      scene%injections = [injection_t(name="w", fracture=1, rate=[rate])]
   end subroutine start

   !> K_m = K'/(E'^3 mu' Q)^(1/4), and without a rate none.
   subroutine test_toughness()
      real(rk), parameter :: expected = 4.0_rk*sqrt(2.0_rk/pi)*1.0e6_rk &
                             /((32.0e9_rk)**3*12.0e-3_rk*rate)**0.25_rk

      call checks%is_close(dimensionless_toughness(scene, 1.0e6_rk, rate), expected, 1.0e-12_rk, &
                           "K_m")
      call checks%is_close(dimensionless_toughness(scene, 1.0e6_rk, -rate), 0.0_rk, 0.0_rk, &
                           "a well that draws")
      scene%material%plane_stress = .true.
      call checks%is_close(dimensionless_toughness(scene, 1.0e6_rk, rate), &
                           expected*(32.0_rk/30.0_rk)**0.75_rk, 1.0e-12_rk, "plane stress")
      scene%material%plane_stress = .false.
      call checks%is_true(regime_words(0.2_rk) /= regime_words(2.0_rk) .and. &
                          regime_words(2.0_rk) /= regime_words(4.0_rk), "three regimes")
   end subroutine test_toughness

   !> C_m = C' (E' t/(mu' Q^3))^(1/6) with the mean permeability; S = phi c + (alpha - phi)(1 -
   !! alpha)/K_b.
   subroutine test_leakoff()
      real(rk), parameter :: storage = 0.1_rk*5.0e-10_rk - 0.1_rk/20.0e9_rk  ! [1/Pa]
      real(rk) :: expected

      expected = 2.0_rk*3.0e6_rk*sqrt(2.0e-18_rk*storage/(pi*1.0e-3_rk)) &
                 *(32.0e9_rk*100.0_rk/(12.0e-3_rk*rate**3))**(1.0_rk/6.0_rk)
      call checks%is_close(dimensionless_leakoff(scene, 3.0e6_rk, rate, 100.0_rk)/expected, &
                           1.0_rk, 1.0e-12_rk, "C_m")
      call checks%is_close(dimensionless_leakoff(scene, -1.0_rk, rate, 100.0_rk), 0.0_rk, 0.0_rk, &
                           "fluid from the rock")
      call checks%is_close(dimensionless_leakoff(scene, 1.0_rk, rate, 0.0_rk), 0.0_rk, 0.0_rk, &
                           "at the start")
   end subroutine test_leakoff

   !> The well with the smallest K_m; its leak-off by the least compression.
   subroutine test_wells()
      real(rk) :: leakoff, toughness
      integer :: well

      call find_regime(scene, toughness, leakoff, well)
      call checks%is_true(well == 1, "the only one")
      call checks%is_close(leakoff, 0.0_rk, 0.0_rk, "rock without compression")
      scene%sides(1)%displacement_given(1) = .true.
      scene%sides(2)%traction(1) = -9.0e6_rk
      scene%sides(3)%traction(2) = 4.0e6_rk
      scene%sides(4)%normal_traction = -4.0e6_rk
      call expect_compression(4.0e6_rk, "sides")
      scene%in_situ%stress = [-8.0e6_rk, -5.0e6_rk, 0.0_rk]
      call expect_compression(5.0e6_rk, "in situ")
      scene%injections = [scene%injections, injection_t(name="v", fracture=1, rate=[2.0_rk*rate])]
      call find_regime(scene, toughness, leakoff, well)
      call checks%is_true(well == 2, "the one with more")
      call checks%is_close(toughness, dimensionless_toughness(scene, 1.0e6_rk, 2.0_rk*rate), &
                           0.0_rk, "its K_m")
      scene%growth%enabled = .false.
      call find_regime(scene, toughness, leakoff, well)
      call checks%is_true(well == 0, "no growth")
   end subroutine test_wells

   subroutine expect_compression(compression, what)
      real(rk), intent(in) :: compression  !< [Pa]
      character(len=*), intent(in) :: what
      real(rk) :: leakoff, toughness
      integer :: well

      call find_regime(scene, toughness, leakoff, well)
      call checks%is_close(leakoff, dimensionless_leakoff(scene, compression - 1.0e6_rk, rate, &
                                                          100.0_rk), 1.0e-12_rk*leakoff, what)
   end subroutine expect_compression

end program test_scene_regime
