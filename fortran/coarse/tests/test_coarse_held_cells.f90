!> Cells that are held: the same solution as with all jumps as unknowns, also where slip spreads
!! over cells that were held before and with steps of several lengths.
program test_coarse_held_cells
   use base_errors, only: error_t
   use base_kinds, only: rk
   use base_timers, only: timers_t
   use coarse_model, only: coarse_model_t, new_state
   use coarse_state, only: state_t, step_report_t
   use contact_law, only: contact_law_t, state_slip
   use mesh_types, only: mesh_t
   use sample_bodies, only: hold, load_sides, mesh_square, porous_body, straight_network, &
                            uniform_cells
   use scene_types, only: initial_t, scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks

   call same_solution(with_dilation=.false.)
   call same_solution(with_dilation=.true.)
   call checks%finish()

contains

   !> Fluid is injected into one of three fractures: it slips, from the well outwards. One near it
   !! is brought closer to slip, a third one sticks.
   subroutine same_solution(with_dilation)
      logical, intent(in) :: with_dilation
      integer, parameter :: steps = 12
      type(mesh_t) :: mesh
      type(scene_t) :: scene
      type(coarse_model_t) :: model(2)
      type(state_t) :: state(2)
      type(timers_t) :: timers
      type(step_report_t) :: report
      type(error_t), allocatable :: error
      type(contact_law_t) :: law
      real(rk), parameter :: ends(2, 2, 3) = reshape([0.5_rk, 0.7_rk, 0.9_rk, 1.1_rk, &
                                                      0.95_rk, 0.95_rk, 1.3_rk, 1.3_rk, &
                                                      1.3_rk, 0.4_rk, 1.7_rk, 0.5_rk], [2, 2, 3])
      real(rk) :: dt, largest
      integer :: k, m, n_held(0:steps), n_slip
      logical :: held_one

      law = contact_law_t(friction=0.75_rk, dilation=merge(0.03_rk, 0.0_rk, with_dilation))
      scene = porous_body()
      call load_sides(scene, [-20.0e6_rk, -10.0e6_rk, 0.0_rk])
      call hold(scene)
      call mesh_square(checks, straight_network(ends), 0.03_rk, 0.2_rk, mesh)
      do m = 1, 2
         model(m)%cells = uniform_cells(mesh, law, 1.0e-4_rk)
         call model(m)%set_mesh(mesh, scene, timers, error)
         call checks%no_error(error, "discretization")
         model(m)%may_hold = m == 1
         call new_state(mesh, model(m)%cells, initial_t(), model(m), state(m))
         call model(m)%equilibrate(mesh, 1.0e-6_rk, state(m), timers, report, error)
         call checks%no_error(error, "equilibrium")
         model(m)%cells%injection(3) = 6.0e-9_rk
      end do
      n_held = 0
      dt = 100.0_rk
      do k = 1, steps
         if (modulo(k, 3) == 0) dt = 2.0_rk*dt
         do m = 1, 2
            call model(m)%advance(mesh, dt, state(m), timers, report, error)
            call checks%no_error(error, "step")
            call checks%is_true(report%converged, "step converges")
            call checks%is_close(report%mass_error, 0.0_rk, 1.0e-15_rk, "fluid mass")
         end do
         if (allocated(model(1)%condensed%held)) n_held(k) = count(model(1)%condensed%held)
         largest = maxval(abs(state(2)%jump))
         call checks%is_close(maxval(abs(state(1)%jump - state(2)%jump)), 0.0_rk, &
                              1.0e-9_rk*largest + 1.0e-16_rk, "jumps")
         call checks%is_close(maxval(abs(state(1)%traction - state(2)%traction)), 0.0_rk, 1.0_rk, &
                              "tractions, of 20 MPa")
         call checks%is_close(maxval(abs(state(1)%unknowns(3, :) - state(2)%unknowns(3, :))), &
                              0.0_rk, 1.0e-2_rk, "pressures")
         call checks%is_true(all(state(1)%contact == state(2)%contact), "states")
      end do
      n_slip = count(any(state(1)%contact == state_slip, dim=1))
      held_one = count(n_held > 0) > 0
      print "(a,13i4,a,i4,a,i4)", "held", n_held, " slip", n_slip, " of", mesh%fracture%n_cells
      call checks%is_true(held_one, "cells are held")
      call checks%is_true(n_held(steps) < maxval(n_held), "some are released")
      call checks%is_true(n_slip > 0, "some slip")
   end subroutine same_solution

end program test_coarse_held_cells
