!> Errors of intensities by the coarse level: zero where both levels are exact; the windows' jumps
!! projected onto the coarse level; interpolation that is exact for quadratic fields.
program test_twolevel_coarse_errors
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use coarse_layout, only: end_block
   use sample_scenes, only: add_fracture, evaluate_initial_state, squeezed_body
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   use twolevel_coarse_errors, only: estimate_coarse_errors
   use twolevel_drained_tips, only: layer_at_tip, layer_t
   use twolevel_faces, only: coarse_jumps, coarse_values_t
   use twolevel_state, only: two_levels_t
   implicit none(type, external)

   real(rk), parameter :: ends_x(2) = [0.8_rk, 1.2_rk], ends_y(2) = [0.9_rk, 1.1_rk]
   type(checks_t) :: checks
   type(timers_t) :: timers

   call test_uniform_stress()
   call test_balance()
   call test_linear_jump()
   call test_root_jump()
   call test_curved_edge()
   call test_pressure_in_cells()
   call test_layer_at_tip()
   call checks%finish()

contains

   !> One fracture in its initial state, its windows evaluated.
   subroutine start(friction, simulation)
      real(rk), intent(in) :: friction
      type(two_levels_t), intent(inout) :: simulation
      type(scene_t) :: scene
      type(error_t), allocatable :: error

      scene = squeezed_body(20.0e6_rk, 10.0e6_rk)
      call add_fracture(scene, "f", ends_x, ends_y, friction, 0.0_rk)
      call evaluate_initial_state(scene, simulation, timers, error)
      call checks%no_error(error, "initial state")
      simulation%now%segment%gain = tiny(1.0_rk)  ! tips that have grown are evaluated, also closed
      call simulation%evaluate(timers, error)
      call checks%no_error(error, "tips")
      call checks%is_true(all(simulation%tip%is_loaded()), "both in windows")
   end subroutine start

   !> A sticking fracture in uniform stress: both levels are exact, so the correction is zero.
   subroutine test_uniform_stress()
      type(two_levels_t), save :: simulation
      type(error_t), allocatable :: error
      integer :: i

      call start(5.0_rk, simulation)
      call estimate_coarse_errors(simulation, timers, error)
      call checks%no_error(error, "estimate")
      do i = 1, size(simulation%tip)
         associate (seen => simulation%now%windows%tip(i), tip => simulation%tip(i))
            ! A millionth of 10 MPa*sqrt(pi*0.2 m).
            call checks%is_true(all(abs(seen%lacking) <= 8.0_rk), "nothing is lacking")
            call checks%is_true(all(seen%uncertain <= 32.0_rk), "nothing is uncertain")
            call checks%is_true(max(tip%intensity%k1_error, tip%intensity%k2_error) <= 40.0_rk, &
                                "a tip that sticks is certain")
         end associate
      end do
   end subroutine test_uniform_stress

   !> The forces on the cells of a state in equilibrium are those of the boundary; where the faces
   !! slip, the estimate is no more than a few per cent, and is included in the tips' errors.
   subroutine test_balance()
      type(two_levels_t), save :: simulation
      type(error_t), allocatable :: error
      real(rk), allocatable :: force(:, :)
      integer :: i

      call start(0.1_rk, simulation)
      force = simulation%problem%model%matrix%elastic_forces(simulation%now%coarse%unknowns) &
              - simulation%problem%model%matrix%elastic_known
      associate (n => simulation%problem%mesh%n_cells)
         ! 20 MPa on a cell's side of 1 cm are 2e5 N/m.
         call checks%is_close(maxval(abs(force(:2, :n))), 0.0_rk, 1.0e-3_rk, "balance of forces")
      end associate
      call estimate_coarse_errors(simulation, timers, error)
      call checks%no_error(error, "estimate")
      do i = 1, size(simulation%tip)
         associate (seen => simulation%now%windows%tip(i), now => simulation%tip(i)%intensity)
            call checks%is_true(seen%uncertain(2) > 0.0_rk, "the coarse level has a part")
            call checks%is_true(seen%uncertain(2) < 0.05_rk*abs(now%k2), "a small one")
            call checks%is_close(now%k2_error, seen%found%k2_error + seen%uncertain(2), &
                                 1.0_rk, "both parts add up")
            call checks%is_close(now%k2_corrected, now%k2 + seen%lacking(2), 1.0_rk, &
                                 "what is lacking")
            call checks%is_close(now%k1_error, 0.0_rk, 1.0_rk, "closed faces have no K_I")
         end associate
      end do
      call simulation%evaluate(timers, error)
      call checks%no_error(error, "the same state again")
      call checks%is_true(all(simulation%tip%intensity%k2_error >= &
                              simulation%now%windows%tip%uncertain(2)), "the estimate stays")
   end subroutine test_balance

   !> A jump that is linear along the fracture equals the coarse jump at its third points, in all
   !! cells that lie completely in the window.
   subroutine test_linear_jump()
      type(two_levels_t), save :: simulation
      real(rk), allocatable :: found(:, :, :)
      real(rk) :: s, worst
      integer(ik) :: cell, end, n

      call start(5.0_rk, simulation)
      found = jumps_of(simulation, .false.)
      worst = 0.0_rk
      n = 0
      associate (fracture => simulation%problem%mesh%fracture)
         do cell = 1, fracture%n_cells
            if (fracture%cell_s(1, cell) < entry_of(simulation)) cycle
            if (cell == fracture%n_cells) cycle  ! the node at the tip has no jump
            n = n + 1
            do end = 1, 2
               s = fracture%cell_s(1, cell) &
                   + end*(fracture%cell_s(2, cell) - fracture%cell_s(1, cell))/3.0_rk
               worst = max(worst, maxval(abs(found(:, end, cell) &
                                             - [2.0_rk + s, 1.0_rk - 3.0_rk*s])))
            end do
         end do
      end associate
      call checks%is_true(n > 1, "cells lie in the window")
      call checks%is_close(worst, 0.0_rk, 1.0e-12_rk, "a linear jump")
   end subroutine test_linear_jump

   !> A jump proportional to the square root of the distance d from the tip: its integral over the
   !! last cells, where the quarter-point element is exact, is 2/3 d^(3/2), and its first moment 2/5
   !! d^(5/2).
   subroutine test_root_jump()
      type(two_levels_t), save :: simulation
      real(rk), allocatable :: found(:, :, :)
      real(rk) :: first_moment, length, mean
      integer(ik) :: last

      call start(5.0_rk, simulation)
      found = jumps_of(simulation, .true.)
      associate (fracture => simulation%problem%mesh%fracture)
         last = fracture%n_cells
         length = fracture%cell_s(2, last) - fracture%cell_s(1, last)
         mean = 2.0_rk/3.0_rk*sqrt(length)
         first_moment = sqrt(length)*(1.0_rk/3.0_rk - 2.0_rk/5.0_rk)  ! about the middle of the cell
      end associate
      ! Elements behind the rosette approximate the root by a quadratic.
      call checks%is_close(0.5_rk*sum(found(1, :, last)), mean, 2.0e-3_rk*mean, "mean of the root")
      call checks%is_close(found(1, 2, last) - found(1, 1, last), 4.0_rk*first_moment, &
                           1.0e-2_rk*mean, "its slope")
   end subroutine test_root_jump

   !> Coarse jumps of the second window for a jump in its displacement on side -: linear in s, or
   !! the square root of the distance from the tip.
   function jumps_of(simulation, is_root) result(found)
      type(two_levels_t), intent(in) :: simulation
      logical, intent(in) :: is_root
      real(rk), allocatable :: displacement(:, :), found(:, :, :)
      real(rk) :: jump(2), s, tip
      integer(ik) :: i, k

      associate (fine => simulation%windows%slot(2)%window%model%mesh)
         allocate (displacement(2, fine%n_nodes), source=0.0_rk)
         tip = simulation%problem%mesh%fracture%cell_s(2, simulation%problem%mesh%fracture%n_cells)
         do i = 1, fine%fracture%n_cells
            do k = 1, 3
               s = fine%face_s(k, i)
               jump = [2.0_rk + s, 1.0_rk - 3.0_rk*s]
               if (is_root) jump = sqrt(max(0.0_rk, tip - s))
               associate (tau => fine%face_tangent(:, i))
                  displacement(:, fine%face_nodes(k, 2, i)) = jump(1)*[-tau(2), tau(1)] &
                                                              + jump(2)*tau
               end associate
            end do
         end do
         found = coarse_jumps(fine, displacement, simulation%problem%mesh)
      end associate
   end function jumps_of

   !> Point where the fracture enters the second window [m].
   pure real(rk) function entry_of(simulation)
      type(two_levels_t), intent(in) :: simulation

      entry_of = minval(simulation%windows%slot(2)%window%model%mesh%face_s)
   end function entry_of

   !> A quadratic displacement, prescribed by its values and gradients at the coarse nodes.
   subroutine test_curved_edge()
      type(two_levels_t), save :: simulation
      real(rk), allocatable :: edge(:, :), gradient(:, :, :), values(:, :)
      real(rk) :: worst
      integer(ik) :: v

      call start(5.0_rk, simulation)
      associate (mesh => simulation%problem%mesh, window => simulation%windows%slot(1)%window)
         allocate (values(2, mesh%n_nodes), gradient(2, 2, mesh%n_nodes))
         do v = 1, mesh%n_nodes
            values(:, v) = quadratic(mesh%xy(:, v))
            associate (x => mesh%xy(1, v), y => mesh%xy(2, v))
               gradient(:, 1, v) = [2.0_rk*x - y, -3.0_rk*y]
               gradient(:, 2, v) = [-x, 4.0_rk*y - 3.0_rk*x + 1.0_rk]
            end associate
         end do
         edge = window%curved_edge(mesh, values, gradient)
         worst = 0.0_rk
         do v = 1, window%model%mesh%n_nodes
            if (.not. window%model%mesh%on_boundary(v)) cycle
            worst = max(worst, maxval(abs(edge(:, v) - quadratic(window%model%mesh%xy(:, v)))))
         end do
      end associate
      call checks%is_close(worst, 0.0_rk, 1.0e-12_rk, "a quadratic field on the edge")
   end subroutine test_curved_edge

   pure function quadratic(xy) result(u)
      real(rk), intent(in) :: xy(2)
      real(rk) :: u(2)

      u = [xy(1)**2 - xy(1)*xy(2), 2.0_rk*xy(2)**2 - 3.0_rk*xy(1)*xy(2) + xy(2)]
   end function quadratic

   !> Errors by the coarse resolution of the rock's pressure: zero where the pressure is uniform;
   !! else K depends on the gradient linearly while all of the fracture slips, and changes twice as
   !! much for twice the gradient.
   subroutine test_pressure_in_cells()
      real(rk), parameter :: uniform = 3.0e6_rk, gradient = 2.0e7_rk  ! [Pa], [Pa/m]
      type(two_levels_t), save :: simulation
      real(rk) :: once(2, 2), twice(2, 2), none(2, 2), k(2)

      call start(0.1_rk, simulation)
      none = passing_of(simulation, uniform, 0.0_rk)
      k = [simulation%tip(1)%intensity%k2, simulation%tip(2)%intensity%k2]
      call checks%is_close(maxval(abs(none)), 0.0_rk, 1.0e-6_rk*maxval(abs(k)), "uniform pressure")
      once = passing_of(simulation, uniform, gradient)
      twice = passing_of(simulation, uniform, 2.0_rk*gradient)
      call checks%is_true(minval(once(2, :)) > 1.0e-4_rk*maxval(abs(k)), "a gradient is seen")
      call checks%is_close(maxval(abs(twice - 2.0_rk*once)), 0.0_rk, 0.02_rk*maxval(twice), &
                           "twice the gradient")
   end subroutine test_pressure_in_cells

   !> Constants of the layer at a tip, from Poisson's ratios in place of Lame's constants, and the
   !! jump of pressure there.
   subroutine test_layer_at_tip()
      real(rk), parameter :: rock = 3.0e6_rk, beyond = 7.0e6_rk  ! [Pa]
      type(two_levels_t), save :: simulation
      type(layer_t) :: layer
      real(rk) :: bulk, bulk_undrained, shear, storage, undrained
      type(coarse_values_t) :: own
      integer(ik) :: end

      call start(0.1_rk, simulation)
      associate (m => simulation%scene%material, fluid => simulation%scene%fluid)
         bulk = m%young/(3.0_rk*(1.0_rk - 2.0_rk*m%poisson))
         shear = m%young/(2.0_rk*(1.0_rk + m%poisson))
         storage = m%porosity*fluid%compressibility + (m%biot - m%porosity)/bulk
         bulk_undrained = bulk + m%biot**2/storage
         undrained = (3.0_rk*bulk_undrained - 2.0_rk*shear)/(6.0_rk*bulk_undrained + 2.0_rk*shear)
         own%nodal = spread(spread(rock, 1, 3), 2, int(simulation%problem%mesh%n_nodes))
         allocate (own%drained(0))
         simulation%now%coarse%pressure = rock + beyond
         do end = 1, 2
            layer = layer_at_tip(simulation%problem%mesh, simulation%problem%model%rock, &
                                 simulation%now%coarse, own, &
                                 1_ik, end)
            call checks%is_close(layer%drained_tip, (1.0_rk - undrained)/(1.0_rk - m%poisson), &
                                 1.0e-12_rk, "drained tip")
            call checks%is_close(layer%eta, m%biot*(1.0_rk - 2.0_rk*m%poisson) &
                                 /(2.0_rk*(1.0_rk - m%poisson)), 1.0e-12_rk, "eta")
            call checks%is_close(layer%jump, beyond, 1.0e-9_rk*beyond, "jump of pressure")
            call checks%is_close(layer%diffusivity*fluid%viscosity/m%permeability_xx &
                                 *(storage + m%biot**2/(bulk + 4.0_rk/3.0_rk*shear)), 1.0_rk, &
                                 1.0e-12_rk, "diffusivity")
         end do
      end associate
   end subroutine test_layer_at_tip

   !> This part of the stated errors with a pressure in the rock that increases linearly along x.
   function passing_of(simulation, uniform, gradient) result(passing)
      type(two_levels_t), intent(inout) :: simulation
      real(rk), intent(in) :: uniform  !< at x = 1 m [Pa]
      real(rk), intent(in) :: gradient  !< [Pa/m]
      real(rk) :: passing(2, 2)  !< (2, tips) errors of K_I and K_II [Pa m^1/2]
      type(error_t), allocatable :: error
      real(rk) :: x
      integer(ik) :: c
      integer :: i

      associate (mesh => simulation%problem%mesh, pressure => simulation%now%coarse%unknowns(3, :))
         pressure = uniform
         do c = 1, mesh%n_cells
            x = sum(mesh%xy(1, mesh%cell_nodes(:, c)))/3.0_rk
            pressure(c) = uniform + gradient*(x - 1.0_rk)
         end do
         do c = 1, mesh%fracture%n_cells
            x = 0.5_rk*sum(mesh%xy(1, mesh%face_nodes(:, mesh%fracture%cell_faces(1, c))))
            simulation%now%coarse%pressure(c) = uniform + gradient*(x - 1.0_rk)
            do i = 1, 2
               x = mesh%xy(1, mesh%face_nodes(i, mesh%fracture%cell_faces(1, c)))
               pressure(end_block(mesh, c, int(i, ik))) = uniform + gradient*(x - 1.0_rk)
            end do
         end do
      end associate
      simulation%now%undrained = .false.
      simulation%now%coarse%time = 1.0e15_rk  ! layers at faces are wider than cells
      call simulation%evaluate(timers, error)
      call checks%no_error(error, "tips")
      call estimate_coarse_errors(simulation, timers, error)
      call checks%no_error(error, "estimate")
      do i = 1, 2
         passing(:, i) = simulation%now%windows%tip(i)%passing
      end do
   end function passing_of

end program test_twolevel_coarse_errors
