!> Layers next to fractures: the steady state is that of the scheme without them, no fluid is made
!! or lost, the undrained response to a load is that of the cells, and the pressure of a closed
!! fracture that takes in fluid is that of the closed form.
program test_coarse_layers
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_lists, only: inverted
   use base_timers, only: timers_t
   use coarse_layout, only: layer_block
   use coarse_model, only: coarse_model_t, new_state
   use coarse_state, only: state_t, step_report_t
   use contact_law, only: contact_law_t
   use mesh_types, only: mesh_t
   use sample_bodies, only: boxes, hold, load_sides, mesh_square, porous_body, shake, &
                            straight_network, uniform_cells
   use scene_types, only: initial_t, scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   !> Two fractures from side to side that cross; no tips.
   real(rk), parameter :: across(2, 2, 2) = reshape([0.0_rk, 0.75_rk, 2.0_rk, 1.25_rk, &
                                                     0.0_rk, 1.25_rk, 2.0_rk, 0.75_rk], [2, 2, 2])
   real(rk), parameter :: first_step = 1.0e-2_rk  !< [s]
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(timers_t) :: timers
   type(step_report_t) :: report
   type(scene_t) :: scene

   call steady_state()
   call cell_with_two_layers()
   call undrained_response()
   call rate_into_fracture("full")
   call rate_into_fracture("sparse")
   call checks%finish()

contains

   !> A body, drained at left and right or not, with fractures that take in fluid.
   subroutine start(scene, lines, size, has_layers, mesh, model, state)
      type(scene_t), intent(inout) :: scene
      real(rk), intent(in) :: lines(:, :, :)  !< ends of the fractures [m]
      real(rk), intent(in) :: size  !< of the cells at them [m]
      logical, intent(in) :: has_layers
      type(mesh_t), intent(out) :: mesh
      type(coarse_model_t), intent(inout) :: model
      type(state_t), intent(out) :: state
      type(timers_t) :: timers
      type(error_t), allocatable :: error

      call hold(scene)
      call mesh_square(checks, straight_network(lines), size, 0.3_rk, mesh)
      model%cells = uniform_cells(mesh, contact_law_t(friction=2.0_rk), 1.0e-4_rk)
      if (has_layers) model%first_step = first_step
      call model%set_mesh(mesh, scene, timers, error)
      call checks%no_error(error, "discretization")
      call new_state(mesh, model%cells, initial_t(), model, state)
   end subroutine start

   !> One step longer than all times of diffusion.
   subroutine steady_state()
      type(mesh_t) :: mesh(2)
      type(coarse_model_t) :: model(2)
      type(state_t) :: state(2)
      real(rk), parameter :: long = 1.0e12_rk  ! [s]
      real(rk) :: supply
      integer(ik) :: k, n

      do k = 1, 2
         scene = porous_body()
         call load_sides(scene, [-20.0e6_rk, -20.0e6_rk, 0.0_rk])
         scene%sides(2:3)%pressure_given = .true.
         scene%sides(2)%pressure = 1.0e6_rk
         call start(scene, across, 0.2_rk, k == 2, mesh(k), model(k), state(k))
         model(k)%cells%injection = 1.0e-10_rk
         supply = sum(model(k)%cells%injection)
         call model(k)%advance(mesh(k), long, state(k), timers, report, error)
         call checks%no_error(error, "steady step")
         call checks%is_true(report%converged, "converged")
      end do
      n = mesh(1)%n_cells
      call checks%is_true(model(1)%layers%n == 0, "no layers where they are off")
      call checks%is_true(any(model(2)%layers%fracture_cell == 0), "layers on drained sides")
      associate (p => state(1)%pressure)
         call checks%is_close(maxval(abs(state(2)%pressure - p))/maxval(p), 0.0_rk, 1.0e-6_rk, &
                              "steady pressure of the fractures")
      end associate
      call checks%is_close(sum(state(2)%leakoff*model(2)%condensed%length) &
                           /sum(state(1)%leakoff*model(1)%condensed%length), 1.0_rk, 1.0e-5_rk, &
                           "steady leak-off")
      call checks%is_close(report%mass_error/(long*supply), 0.0_rk, 1.0e-7_rk, &
                           "fluid made or lost in the steady state")
   end subroutine steady_state

   !> Drained sides that meet in a cell, which has two layers: its steady pressure, with a source in
   !! another cell, is that without layers; before, no fluid is made or lost.
   subroutine cell_with_two_layers()
      type(mesh_t) :: mesh(2)
      type(coarse_model_t) :: model(2)
      type(state_t) :: state(2)
      real(rk), parameter :: steps(4) = [1.0e-2_rk, 1.0_rk, 1.0e3_rk, 1.0e13_rk]  ! [s]
      real(rk), parameter :: supply = 1.0e-11_rk  ! [m2/s]
      integer(ik) :: i, k

      scene = porous_body()
      call hold(scene)
      scene%sides(2:3)%pressure_given = .true.
      scene%sides(2:3)%pressure = 1.0e3_rk
      do k = 1, 2
         mesh(k) = boxes(4_ik)
         call shake(mesh(k))
         associate (none => mesh(k)%fracture)
            allocate (none%cell_s(2, 0), none%cell_fracture(0), none%tip_point(0))
            allocate (none%tip_node(0), none%tip_fracture(0), none%tip_end(0))
            none%point_cells = inverted(none%cell_points, 0_ik)
         end associate
         model(k)%cells = uniform_cells(mesh(k), contact_law_t(), 1.0e-4_rk)
         if (k == 2) model(k)%first_step = first_step
         call model(k)%set_mesh(mesh(k), scene, timers, error)
         call checks%no_error(error, "discretization of boxes")
         call new_state(mesh(k), model(k)%cells, initial_t(), model(k), state(k))
         allocate (model(k)%source(3, mesh(k)%n_cells), source=0.0_rk)
         model(k)%source(3, 17) = supply
         do i = 1, size(steps)
            call model(k)%advance(mesh(k), steps(i), state(k), timers, report, error)
            call checks%no_error(error, "step of boxes")
            call checks%is_close(report%mass_error/max(abs(report%rock_outflow), supply*steps(i)), &
                                 0.0_rk, 1.0e-9_rk, "boxes: fluid made or lost")
         end do
      end do
      call checks%is_true(size(model(2)%layers%cells) < model(2)%layers%n, &
                          "a cell with several layers")
      associate (n => mesh(1)%n_cells)
         call checks%is_close(maxval(abs(state(2)%unknowns(3, :n) - state(1)%unknowns(3, :n))) &
                              /maxval(abs(state(1)%unknowns(3, :n))), 0.0_rk, 0.05_rk, &
                              "steady means of the cells")
         call checks%is_close(maxval(abs(state(2)%unknowns(3, 17:18) &
                                       /state(1)%unknowns(3, 17:18) - 1.0_rk)), 0.0_rk, 1.0e-6_rk, &
                              "steady pressure away from layers")
      end associate
   end subroutine cell_with_two_layers

   !> A load within no time: the pressure in the layers is that of the cells.
   subroutine undrained_response()
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk) :: difference, largest
      integer(ik) :: l

      scene = porous_body()
      call load_sides(scene, [-20.0e6_rk, -10.0e6_rk, 3.0e6_rk])
      call start(scene, across, 0.2_rk, .true., mesh, model, state)
      call model%equilibrate(mesh, 1.0e-9_rk, state, timers, report, error)
      call checks%no_error(error, "undrained step")
      largest = maxval(abs(state%unknowns(3, :mesh%n_cells)))
      difference = 0.0_rk
      do l = 1, model%layers%n
         associate (cell => state%unknowns(3, model%layers%cell(l)))
            difference = max(difference, &
                             maxval(abs(state%layer(:model%layers%chain(l)%n - 1, l) - cell)), &
                             abs(state%unknowns(1, layer_block(mesh, l)) - cell))
         end associate
      end do
      call checks%is_true(largest > 1.0e6_rk, "pressure by the load")
      call checks%is_close(difference/largest, 0.0_rk, 1.0e-6_rk, "undrained layers")
   end subroutine undrained_response

   !> A fracture from side to side takes in fluid at a constant rate: the closed form with storage,
   !! for layers of a hundredth to a third of a cell. Steps grow slowly.
   subroutine rate_into_fracture(condensation)
      character(len=*), intent(in) :: condensation
      real(rk), parameter :: line(2, 2, 1) = reshape([0.0_rk, 1.0_rk, 2.0_rk, 1.0_rk], [2, 2, 1])
      real(rk), parameter :: rate = 1.0e-9_rk  ! per length [m/s]
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk), allocatable :: undrained(:)
      real(rk) :: c, dt, exact, held, largest, mass_error, uniaxial, width

      scene = porous_body()
      scene%discretization%condensation = condensation
      scene%fluid%compressibility = 4.0e-10_rk
      call load_sides(scene, [-60.0e6_rk, -60.0e6_rk, 0.0_rk])
      scene%sides(2)%displacement_given(1) = .true.  ! strain across the fracture alone
      call start(scene, line, 0.25_rk, .true., mesh, model, state)
      call model%equilibrate(mesh, 1.0e-9_rk, state, timers, report, error)
      call checks%no_error(error, "undrained response to the load")
      undrained = state%pressure
      model%cells%injection = rate*model%condensed%length
      associate (m => scene%material)
         uniaxial = model%rock%storage(1) &
                    + model%rock%biot(1)**2/(model%rock%lame(1) + 2.0_rk*model%rock%shear(1))
      end associate
      c = model%rock%mobility/uniaxial
      held = 1.0e-4_rk*scene%fluid%compressibility
      dt = first_step
      largest = 0.0_rk
      mass_error = 0.0_rk
      do
         call model%advance(mesh, dt, state, timers, report, error)
         call checks%no_error(error, "step")
         if (allocated(error) .or. .not. report%converged) exit
         mass_error = mass_error + abs(report%mass_error)
         width = sqrt(c*state%time)
         if (width > 0.08_rk) exit
         dt = 1.15_rk*dt
         if (width < 2.0e-3_rk) cycle
         associate (s => 2.0_rk*uniaxial*sqrt(c)/held)
            exact = rate/(held*s**2)*(2.0_rk*s*sqrt(state%time/pi) - 1.0_rk &
                                      + erfc_scaled(s*sqrt(state%time)))
         end associate
         largest = max(largest, maxval(abs((state%pressure - undrained)/exact - 1.0_rk)))
      end do
      call checks%is_true(report%converged, condensation//": converged")
      call checks%is_close(largest, 0.0_rk, 0.03_rk, condensation//": pressure at a constant rate")
      call checks%is_close(mass_error/(rate*2.0_rk*state%time), 0.0_rk, 1.0e-9_rk, &
                           condensation//": fluid made or lost")
   end subroutine rate_into_fracture

end program test_coarse_layers
