!> Stated errors of temperatures: none of linear ones but that in time, and those of the half-space
!! cooled at its face hold in 95 % of the cells from fronts thinner than a cell to wide ones.
program test_heat_errors
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_lists, only: inverted
   use base_timers, only: timers_t
   use coarse_model, only: coarse_model_t, new_state
   use coarse_state, only: state_t
   use contact_law, only: contact_law_t
   use heat_errors, only: temperature_errors
   use heat_flows, only: set_flows
   use heat_links, only: external_t
   use heat_model, only: heat_model_t
   use heat_state, only: heat_state_t
   use heat_steps, only: advance_heat
   use mesh_types, only: mesh_t
   use sample_bodies, only: boxes, porous_body, shake, uniform_cells
   use scene_heat, only: heat_t
   use scene_types, only: initial_t, scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: cold = 50.0_rk  !< [K]
   real(rk), parameter :: nowhere(0) = [real(rk) ::]  !< wells
   type(external_t), parameter :: none(0) = [external_t ::]
   type(checks_t) :: checks
   type(scene_t) :: scene
   type(mesh_t) :: mesh
   type(coarse_model_t) :: model
   type(heat_model_t) :: heat
   type(heat_state_t) :: now
   type(state_t) :: state

   call start()
   call linear()
   call cooled_face()
   call checks%finish()

contains

   !> A square of 2 m as boxes of 0.1 m, without fractures or flow, whose left side is cooled.
   subroutine start()
      type(timers_t) :: timers
      type(error_t), allocatable :: error

      scene = porous_body()
      scene%sides(1)%displacement_given(1) = .true.
      scene%sides(3)%displacement_given(2) = .true.
      scene%material%heat_capacity = 2.2e6_rk
      scene%material%heat_conductivity = 2.2_rk
      scene%fluid%heat_capacity = 4.2e6_rk
      scene%heat = heat_t(temperature=100.0_rk)
      scene%sides(1)%temperature_given = .true.
      scene%sides(1)%temperature = 100.0_rk - cold
      mesh = boxes(20_ik)
      call shake(mesh)
      associate (no => mesh%fracture)
         allocate (no%cell_s(2, 0), no%cell_fracture(0), no%tip_point(0))
         allocate (no%tip_node(0), no%tip_fracture(0), no%tip_end(0))
         no%point_cells = inverted(no%cell_points, 0_ik)
      end associate
      model%cells = uniform_cells(mesh, contact_law_t(), 1.0e-4_rk)
      call model%set_mesh(mesh, scene, timers, error)
      call checks%no_error(error, "discretization")
      call new_state(mesh, model%cells, initial_t(), model, state)
      call heat%set_mesh(mesh, scene, model%connections, model%joints, 1.0_rk, error)
      call checks%no_error(error, "heat on the mesh")
   end subroutine start

   !> 30 K/m across cells of all shapes.
   subroutine linear()
      real(rk), dimension(heat%n) :: carried, error

      call heat%begin(nowhere, nowhere, 1.0_rk, 0, now)
      now%temperature = 30.0_rk*heat%place(1, :) - 10.0_rk*heat%place(2, :)
      associate (in_time => 2.5_rk*heat%heat%tolerance*abs(now%temperature))
         call temperature_errors(heat, now, 0.0_rk, nowhere, error, carried)
         call checks%is_close(maxval(abs(error - in_time)), 0.0_rk, 1.0e-10_rk, "linear")
      end associate
   end subroutine linear

   !> T = -50 erfc(x/(2 sqrt(D t))), in cells where that differs by a hundred-thousandth of 50 K.
   subroutine cooled_face()
      real(rk), parameter :: widths(6) = [0.003_rk, 0.03_rk, 0.1_rk, 0.2_rk, 0.4_rk, 0.6_rk]  ! [m]
      type(error_t), allocatable :: error
      real(rk) :: carried(heat%n), stated(heat%n)
      real(rk), allocatable :: off(:)
      real(rk) :: time
      integer(ik) :: held, seen
      integer :: k

      call heat%begin(nowhere, nowhere, 1.0_rk, 0, now)
      call set_flows(heat, mesh, model, state, none)
      time = 0.0_rk
      seen = 0
      held = 0
      do k = 1, size(widths)
         ! D is 1e-6 m2/s.
         call advance_heat(heat, 0.25e6_rk*widths(k)**2 - time, now, error)
         call checks%no_error(error, "cooled face")
         time = 0.25e6_rk*widths(k)**2
         associate (n => mesh%n_cells)
            call temperature_errors(heat, now, 0.0_rk, nowhere, stated, carried)
            off = abs(now%temperature(:n) + cold*erfc(heat%place(1, :n)/widths(k)))
            seen = seen + int(count(off > 1.0e-5_rk*cold), ik)
            held = held + int(count(off > 1.0e-5_rk*cold .and. off <= stated(:n)), ik)
         end associate
      end do
      call checks%is_true(seen > 1000 .and. held > 0.95_rk*real(seen, rk), "errors of cells hold")
   end subroutine cooled_face

end program test_heat_errors
