!> A crack on the coarse level is as long as it is, wherever its tips are in their cells: volume of
!! opening and of slip against the closed forms of one crack in an infinite body, 2 pi s a^2/E' for
!! the stress s that it releases; and what leaks off from it, against that of a strip of one
!! pressure.
program test_coarse_tips
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_timers, only: timers_t
   use coarse_model, only: coarse_model_t, new_state
   use coarse_state, only: state_t, step_report_t
   use coarse_tips, only: tip_springs
   use contact_law, only: contact_law_t
   use mesh_types, only: mesh_t
   use sample_bodies, only: advance, equilibrate, hold, load_sides, mesh_square, porous_body, &
                            set_permeability, straight_network, uniform_cells
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: a = 0.05_rk  !< half-length of the mesh's crack [m]
   integer(ik), parameter :: n_cells = 20
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(timers_t) :: timers
   type(step_report_t) :: report
   type(scene_t) :: scene

   call test_lengths(.true., 0.2_rk)
   call test_lengths(.true., 0.45_rk)
   call test_lengths(.false., 0.2_rk)
   call test_lengths(.false., 0.45_rk)
   call test_leak_off()
   call test_beside_another()
   call checks%finish()

contains

   !> The mesh goes on beyond both tips by up to more than a cell.
   subroutine test_lengths(opens, poisson)
      logical, intent(in) :: opens  !< else slips
      real(rk), intent(in) :: poisson
      real(rk), parameter :: ahead(7) = [0.0_rk, 0.1_rk, 0.35_rk, 0.6_rk, 0.9_rk, 1.0_rk, 1.4_rk]
      real(rk), parameter :: stress = 5.0e6_rk  ! released [Pa]
      real(rk), parameter :: cell = 2.0_rk*a/n_cells  ! [m]
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk) :: half_length, modulus, volume
      integer(ik) :: component
      integer :: k

      ! The fluid keeps its pressure: hardly porous rock, a very compressible fluid.
      scene = porous_body()
      scene%material%biot = 1.0e-6_rk
      scene%material%porosity = 1.0e-6_rk
      scene%material%poisson = poisson
      scene%fluid%compressibility = 1.0e-3_rk
      if (opens) then
         scene%initial%pressure = stress
      else  ! frictionless, at 45 degrees
         call load_sides(scene, [-4.0_rk*stress, -2.0_rk*stress, 0.0_rk])
      end if
      call hold(scene)
      if (.not. opens) scene%initial%pressure = 0.1_rk*stress
      call mesh_square(checks, straight_network(reshape(1.0_rk + a*sqrt(0.5_rk)*[-1, -1, 1, 1], &
                                                        [2, 2, 1])), cell, 0.2_rk, mesh)
      call checks%is_true(mesh%fracture%n_cells == n_cells, "cells along the crack")
      model%cells = uniform_cells(mesh, contact_law_t(), 1.0e-3_rk)
      call model%set_mesh(mesh, scene, timers, error)
      call checks%no_error(error, "discretization")
      component = merge(1_ik, 2_ik, opens)
      modulus = scene%material%young/(1.0_rk - poisson**2)
      do k = 1, size(ahead)
         model%ends%ahead = ahead(k)*cell
         call new_state(mesh, model%cells, scene%initial, model, state)
         call equilibrate(checks, model, mesh, 1.0_rk, state, report, "a crack")
         volume = abs(sum(0.5_rk*sum(state%jump(component, :, :), dim=1)*model%condensed%length))
         half_length = sqrt(volume*modulus/(2.0_rk*pi*stress))
         ! In cells; 0.03 is what meshes differ by, 0.02 the body's size and the fit.
         call checks%is_close(half_length/cell, a/cell - ahead(k), 0.05_rk, "half-length in cells")
         print "(a,l2,2(a,f5.2),a,f7.3)", "opens", opens, ", nu ", poisson, ", ahead ", ahead(k), &
            ", off by", half_length/cell - a/cell + ahead(k)
      end do
   end subroutine test_lengths

   !> Steady flow from a crack to the sides of a square, whose pressure is 0. The flow is
   !! 2 pi K/mu p / ln(2 R/a), with the conformal radius R of the square, 1.0787052 of its
   !! half-side.
   subroutine test_leak_off()
      real(rk), parameter :: ahead(7) = [0.0_rk, 0.1_rk, 0.35_rk, 0.6_rk, 0.9_rk, 1.0_rk, 1.4_rk]
      real(rk), parameter :: a = 0.1_rk, cell = 2.0_rk*a/10.0_rk, radius = 1.0787052023767587_rk
      real(rk), parameter :: stress = -1.0e6_rk  ! keeps it closed [Pa]
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk) :: half_length, rate
      integer :: k

      scene = porous_body()
      call set_permeability(scene, 1.0e-15_rk)
      call load_sides(scene, [stress, stress, 0.0_rk])
      call hold(scene)
      scene%sides%pressure_given = .true.
      call mesh_square(checks, straight_network(reshape(1.0_rk + a*sqrt(0.5_rk)*[-1, -1, 1, 1], &
                                                        [2, 2, 1])), cell, 0.04_rk, mesh)
      model%cells = uniform_cells(mesh, contact_law_t(), 1.0e-3_rk)
      rate = 1.0e-8_rk  ! [m2/s]
      model%cells%injection(5) = rate
      call model%set_mesh(mesh, scene, timers, error)
      call checks%no_error(error, "discretization")
      do k = 1, size(ahead)
         model%ends%ahead = ahead(k)*cell
         call new_state(mesh, model%cells, scene%initial, model, state)
         call advance(checks, model, mesh, 1.0e9_rk, state, report, "a crack")
         half_length = 2.0_rk*radius/exp(2.0_rk*pi*model%rock%mobility*state%pressure(5)/rate)
         ! In cells, as above.
         call checks%is_close(half_length/cell, a/cell - ahead(k), 0.05_rk, "length that leaks")
         print "(2(a,f7.3))", "leak-off, ahead ", ahead(k), ", off by", &
            half_length/cell - a/cell + ahead(k)
      end do
   end subroutine test_leak_off

   !> Tips of two cracks side by side, and of a third one away from them: only those of the third
   !! have springs that are negative.
   subroutine test_beside_another()
      real(rk), parameter :: gap = 0.01_rk*a
      real(rk), parameter :: ends(2, 2, 3) = reshape([ &
                                                     0.6_rk - a, 1.0_rk, 0.6_rk + a, 1.0_rk, &
                                                     0.6_rk - a, 1.0_rk + gap, &
                                                     0.6_rk + a, 1.0_rk + gap, &
                                                     1.4_rk - a, 1.0_rk, 1.4_rk + a, 1.0_rk], &
                                                     [2, 2, 3])
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk), allocatable :: spring(:)
      real(rk) :: lowest
      integer(ik) :: at, cell, k, tip

      scene = porous_body()
      call hold(scene)
      call mesh_square(checks, straight_network(ends), 0.02_rk, 0.3_rk, mesh)
      model%cells = uniform_cells(mesh, contact_law_t(friction=0.5_rk, dilation=0.0_rk), 1.0e-4_rk)
      call model%set_mesh(mesh, scene, timers, error)
      call checks%no_error(error, "discretization of three cracks")
      call new_state(mesh, model%cells, scene%initial, model, state)
      call equilibrate(checks, model, mesh, 1.0_rk, state, report, "three cracks")
      spring = tip_springs(model%ends, model%rock, mesh, model%condensed)
      call checks%is_true(mesh%fracture%n_tips == 6, "six tips")
      do tip = 1, mesh%fracture%n_tips
         cell = model%ends%cell(tip)
         lowest = huge(1.0_rk)
         do k = 1, 2
            at = model%condensed%layout%at_jump(cell, k)
            lowest = min(lowest, minval(spring(at:at + 1)))
         end do
         call checks%is_true((lowest < 0.0_rk) .eqv. mesh%fracture%tip_fracture(tip) == 3, &
                             "springs are negative only where no other crack is near")
      end do
   end subroutine test_beside_another

end program test_coarse_tips
