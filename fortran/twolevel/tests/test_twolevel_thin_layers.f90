!> Errors of intensities by layers thinner than a cell, against numbers of an independent model.
program test_twolevel_thin_layers
   use base_kinds, only: rk
   use testing_checks, only: checks_t
   use twolevel_drained_tips, only: drained_excess, layer_t, thin_layer_errors
   implicit none(type, external)

   type(checks_t) :: checks
   !> Rock of E = 40 GPa, nu = 0.2, alpha = 0.8 at k = 1e-19 m2 in contact with fluid at a pressure
   !! 7.24 MPa higher.
   type(layer_t), parameter :: layer = layer_t(cell=1.0e3_rk, diffusivity=6.172839506e-6_rk, &
                                               drained_tip=0.86_rk, eta=0.3_rk, jump=7.24e6_rk)
   real(rk), parameter :: k(2) = [3.0e6_rk, 1.0e6_rk], age = 800.0_rk
   !> The weight function of a half-plane crack times the pressure that diffuses from its faces,
   !! integrated in Python [Pa m^1/2].
   real(rk), parameter :: of_layer = 0.8983566782682296e6_rk
   !> (1 + F)/2: the rock at the tip deforms as drained rock [-].
   real(rk), parameter :: drained = 0.93_rk

   call test_thin_layer()
   call test_wide_layer()
   call checks%finish()

contains

   !> A layer far thinner than a cell counts in full where the coarse level does not have it, and
   !! by 0.15 of its back stress where it does; the drained tip by a fifth of 1 - F. K_I of closed
   !! tips is zero.
   subroutine test_thin_layer()
      real(rk), parameter :: back_stress = -1.0e5_rk  ! [Pa m^1/2]
      type(layer_t) :: known
      real(rk) :: errors(2)

      errors = thin_layer_errors(layer, k, .false., age, 0.0_rk)
      call checks%is_close(errors(1), 0.2_rk*0.14_rk*k(1) + drained*of_layer, 1.0e-6_rk*k(1), &
                           "K_I")
      call checks%is_close(errors(2), 0.2_rk*0.14_rk*k(2), 1.0e-6_rk*k(2), "K_II")
      errors = thin_layer_errors(layer, k, .true., age, 0.0_rk)
      call checks%is_close(errors(1), 0.0_rk, 0.0_rk, "K_I of a closed tip")
      known = layer
      known%is_known = .true.
      errors = thin_layer_errors(known, k, .false., age, back_stress)
      call checks%is_close(errors(1), 0.2_rk*0.14_rk*k(1) - 0.15_rk*back_stress, &
                           1.0e-6_rk*k(1), "K_I with a layer")
      call checks%is_close(drained_excess(layer, age), 0.16_rk*0.14_rk, 1.0e-5_rk, &
                           "K_II of a drained tip")
   end subroutine test_thin_layer

   !> A layer of ten cells is resolved.
   subroutine test_wide_layer()
      type(layer_t) :: resolved
      real(rk) :: errors(2)

      resolved = layer
      resolved%cell = 0.1_rk*sqrt(layer%diffusivity*age)
      errors = thin_layer_errors(resolved, k, .false., age, 0.0_rk)
      call checks%is_true(all(errors < 0.0025_rk*(0.2_rk*0.14_rk*k + drained*of_layer)), &
                          "a wide layer")
      call checks%is_true(drained_excess(resolved, age) < 0.0025_rk*0.16_rk*0.14_rk, &
                          "a tip in drained rock")
      resolved%cell = 0.0_rk
      call checks%is_close(drained_excess(resolved, age), 0.0_rk, 0.0_rk, "no fracture cells")
   end subroutine test_wide_layer

end program test_twolevel_thin_layers
