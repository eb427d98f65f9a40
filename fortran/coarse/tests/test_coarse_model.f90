!> The coarse level against exact states: uniform stress and pressure, linear pressure, a sticking
!! fracture, a slipping one, one at the pressure of vapour, fluid mass.
program test_coarse_model
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_timers, only: timers_t
   use coarse_fields, only: cell_stresses
   use coarse_model, only: coarse_model_t
   use coarse_nodes, only: nodal_fields
   use coarse_state, only: state_t, step_report_t
   use contact_law, only: contact_law_t, state_slip, state_stick
   use mesh_types, only: mesh_t
   use sample_bodies, only: advance, equilibrate, hold, new_square, porous_body, straight_network
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: undrained_pressure = 6902061.032_rk  !< catalogue 4.0 [Pa]
   !> at (2, 2) [m]
   real(rk), parameter :: undrained_u(2) = [-0.6412206423e-3_rk, -0.04122064228e-3_rk]
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(timers_t) :: timers
   type(step_report_t) :: report
   type(mesh_t) :: mesh
   type(scene_t) :: scene

   call undrained_square()
   call linear_pressure()
   call sticking_fracture()
   call slipping_fracture()
   call closed_at_vapour_pressure()
   call open_at_vapour_pressure()
   call injection_conserves_mass()
   call checks%finish()

contains

   !> Body of Paper C.
   function paper_c() result(scene)
      type(scene_t) :: scene

      scene = porous_body()
      call hold(scene, [-20.0e6_rk, -10.0e6_rk])
   end function paper_c

   !> The square with a fracture or without, before anything happens.
   subroutine start(scene, ends, sizes, friction, dilation, mesh, model, state)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: ends(:, :, :)  !< of the fracture [m]
      real(rk), intent(in) :: sizes(2)  !< of cells at the fracture and at the boundary [m]
      real(rk), intent(in) :: friction, dilation
      type(mesh_t), intent(out) :: mesh
      type(coarse_model_t), intent(inout) :: model
      type(state_t), intent(out) :: state

      call new_square(checks, scene, straight_network(ends), sizes, &
                      contact_law_t(friction=friction, dilation=dilation), 1.0e-3_rk, mesh, model, &
                      state)
   end subroutine start

   !> Displacement at the corner (2, 2), which belongs to one or two cells.
   function corner_displacement(mesh, model, state) result(u)
      type(mesh_t), intent(in) :: mesh
      type(coarse_model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      real(rk) :: u(2)
      real(rk), allocatable :: values(:, :)
      integer(ik) :: v

      allocate (values(3, mesh%n_nodes))
      call nodal_fields(mesh, model%rock, model%regions, state%unknowns, state%tractions, values)
      v = minloc(norm2(mesh%xy - 2.0_rk, dim=1), dim=1)
      u = values(1:2, v)
   end function corner_displacement

   !> Uniform undrained state: exact on any mesh.
   subroutine undrained_square()
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk), allocatable :: stresses(:, :)
      real(rk) :: none(2, 2, 0)

      scene = paper_c()
      call start(scene, none, [0.3_rk, 0.3_rk], 0.0_rk, 0.0_rk, mesh, model, state)
      call model%advance(mesh, 1800.0_rk, state, timers, report, error)
      call checks%no_error(error, "undrained step")
      call checks%is_close(maxval(abs(state%unknowns(3, :) - undrained_pressure)), 0.0_rk, &
                           1.0e-2_rk, "undrained pressure")
      call checks%is_close(maxval(abs(corner_displacement(mesh, model, state) - undrained_u)), &
                           0.0_rk, 1.0e-12_rk, "undrained displacement")
      allocate (stresses(3, mesh%n_cells))
      call cell_stresses(mesh, model%regions, state%tractions, stresses)
      call checks%is_close(maxval(abs(stresses(1, :) + 20.0e6_rk)), 0.0_rk, 1.0e-3_rk, "sigma_xx")
      call checks%is_close(maxval(abs(stresses(2, :) + 10.0e6_rk)), 0.0_rk, 1.0e-3_rk, "sigma_yy")
      call checks%is_close(maxval(abs(stresses(3, :))), 0.0_rk, 1.0e-3_rk, "sigma_xy")
      call checks%is_close(report%mass_error, 0.0_rk, 1.0e-16_rk, "fluid mass")
   end subroutine undrained_square

   !> Steady flow between two pressures with a full permeability tensor: the pressure is linear.
   subroutine linear_pressure()
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk), allocatable :: x(:)
      real(rk) :: none(2, 2, 0)
      integer(ik) :: c

      scene = paper_c()
      scene%material%permeability_xx = 5.0e-14_rk
      scene%material%permeability_yy = 2.0e-14_rk
      scene%sides(1)%pressure_given = .true.
      scene%sides(1)%pressure = 3.0e6_rk
      scene%sides(2)%pressure_given = .true.
      scene%sides(2)%pressure = 1.0e6_rk
      call start(scene, none, [0.3_rk, 0.3_rk], 0.0_rk, 0.0_rk, mesh, model, state)
      call model%advance(mesh, 1.0e15_rk, state, timers, report, error)
      call checks%no_error(error, "steady step")
      allocate (x(mesh%n_cells))
      do c = 1, mesh%n_cells
         x(c) = sum(mesh%xy(1, mesh%cell_nodes(:, c)))/3.0_rk
      end do
      call checks%is_close(maxval(abs(state%unknowns(3, :) - (3.0e6_rk - 1.0e6_rk*x))), 0.0_rk, &
                           1.0e-3_rk, "linear pressure")
   end subroutine linear_pressure

   !> A fracture with high friction in the uniform state changes nothing and carries the resolved
   !! stress.
   subroutine sticking_fracture()
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk), parameter :: at(2, 2, 1) = reshape([0.7_rk, 0.8_rk, 1.2_rk, 1.3_rk], [2, 2, 1])

      scene = paper_c()
      call start(scene, at, [0.1_rk, 0.3_rk], 5.0_rk, 0.0_rk, mesh, model, state)
      call equilibrate(checks, model, mesh, 1.0e-3_rk, state, report, "sticking step")
      call checks%is_true(all(state%contact == state_stick), "all stick")
      ! At 45 degrees: sigma_n = -15 MPa, shear (sigma_yy - sigma_xx)/2 = 5 MPa
      call checks%is_close(maxval(abs(state%pressure - undrained_pressure)), 0.0_rk, 1.0e-1_rk, &
                           "fracture pressure")
      call checks%is_close(maxval(abs(state%traction(1, :, :) - undrained_pressure + 15.0e6_rk)), &
                           0.0_rk, 1.0e-1_rk, "normal traction")
      call checks%is_close(maxval(abs(state%traction(2, :, :) - 5.0e6_rk)), 0.0_rk, 1.0e-1_rk, &
                           "shear traction")
      call checks%is_close(maxval(abs(state%jump)), 0.0_rk, 1.0e-15_rk, "no jump")
      call checks%is_close(maxval(abs(corner_displacement(mesh, model, state) - undrained_u)), &
                           0.0_rk, 1.0e-12_rk, "undrained displacement with a fracture")
   end subroutine sticking_fracture

   !> Closed frictional crack with dilation (catalogue 3.1, undrained elasticity): the slip
   !! converges with the cell size, and the tractions follow the law.
   subroutine slipping_fracture()
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk), parameter :: a = 0.05_rk, h = a/sqrt(2.0_rk), psi = tan(0.0174532925199433_rk)
      real(rk), parameter :: at(2, 2, 1) = &
                             reshape([1.0_rk - h, 1.0_rk - h, 1.0_rk + h, 1.0_rk + h], [2, 2, 1])
      real(rk) :: drop, slip, error_of(3), exact, modulus, x
      integer(ik) :: end, i, level, n

      scene = paper_c()
      drop = (5.0e6_rk - 0.5_rk*(15.0e6_rk - undrained_pressure))/(1.0_rk + 0.5_rk*psi)
      ! Undrained plane-strain modulus E_u/(1-nu_u^2) = 2G/(1-nu_u), nu_u = 0.3104329765 (catalogue
      ! 4.3)
      modulus = 2.0_rk*40.0e9_rk/2.4_rk/(1.0_rk - 0.3104329765_rk)
      slip = 4.0_rk*drop*a/modulus
      do level = 1, 3
         call start(scene, at, [0.02_rk, 0.2_rk]/2**(level - 1), 0.5_rk, psi, mesh, model, &
                    state)
         call equilibrate(checks, model, mesh, 1.0e-6_rk, state, report, "slipping step")
         call checks%is_true(all(state%contact == state_slip), "all slip")
         call checks%is_close(report%contact_residual, 0.0_rk, 1.0e-9_rk, "contact law")
         n = mesh%fracture%n_cells
         error_of(level) = 0.0_rk
         do i = 1, n
            do end = 1, 2
               ! The ends' values stand for the third points of the cell.
               x = a*(2.0_rk*(real(i - 1, rk) + real(end, rk)/3.0_rk)/real(n, rk) - 1.0_rk)
               exact = slip*sqrt(1.0_rk - (x/a)**2)
               error_of(level) = error_of(level) + (state%jump(2, end, i) - exact)**2*a/real(n, rk)
            end do
         end do
         error_of(level) = sqrt(error_of(level))/(slip*sqrt(4.0_rk*a/3.0_rk))
         call checks%is_close(sum(state%traction(1, :, :))/real(2*n, rk), &
              undrained_pressure - 15.0e6_rk - psi*drop, 2.0e4_rk, "contact pressure with dilation")
         call checks%is_close(maxval(abs(state%jump(1, :, :) - psi*state%jump(2, :, :))), 0.0_rk, &
                              1.0e-14_rk, "dilation")
      end do
      print "(a,3f9.5)", "slip, relative L2 error", error_of
      associate (order => log(error_of(1)/error_of(3))/log(4.0_rk))
         call checks%is_true(order > 0.5_rk .and. order < 1.2_rk, "slip: order between 1/2 and 1")
      end associate
   end subroutine slipping_fracture

   !> Undrained stretching draws the pressure of the rock below 0: a third of the load of Paper C in
   !! the mean, with the other sign. A fracture that stays closed has this pressure, or that of its
   !! vapour if it is larger, and the contact traction of the stress across it; it is full.
   subroutine closed_at_vapour_pressure()
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk), parameter :: at(2, 2, 1) = reshape([0.7_rk, 1.0_rk, 1.3_rk, 1.0_rk], [2, 2, 1])
      real(rk), parameter :: vapour(3) = [0.0_rk, -1.0e6_rk, -3.0e6_rk]
      real(rk), parameter :: rock = -undrained_pressure/3.0_rk
      real(rk) :: expected
      integer :: k

      scene = paper_c()
      scene%sides(2)%traction = [20.0e6_rk, 0.0_rk]
      do k = 1, size(vapour)
         scene%fluid%vapour_pressure = vapour(k)
         expected = max(rock, vapour(k))
         call start(scene, at, [0.1_rk, 0.3_rk], 0.5_rk, 0.0_rk, mesh, model, state)
         call equilibrate(checks, model, mesh, 1.0e-3_rk, state, report, &
                          "initial state above vapour")
         call checks%is_close(maxval(abs(state%pressure - expected)), 0.0_rk, 1.0e-1_rk, &
                              "fracture pressure, not below vapour")
         call checks%is_close(maxval(abs(state%traction(1, :, :) + 10.0e6_rk - expected)), &
                              0.0_rk, 1.0e-1_rk, "normal traction at it")
         call checks%is_close(maxval(abs(state%unknowns(3, :mesh%n_cells) - rock)), 0.0_rk, &
                              1.0e-1_rk, "the rock's pressure may be lower")
         call checks%is_close(maxval(abs(state%void)), 0.0_rk, 0.0_rk, "no void")
      end do
   end subroutine closed_at_vapour_pressure

   !> Stretched across, a fracture opens against the pressure of vapour: the volume of a crack under
   !! net tension s in undrained rock is 2 pi s a^2/E', whatever the pressure of the rock. The next
   !! step goes on from there.
   subroutine open_at_vapour_pressure()
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk), parameter :: a = 0.05_rk, tension = 1.0e6_rk
      real(rk), parameter :: at(2, 2, 1) = &
                             reshape([1.0_rk - a, 1.0_rk, 1.0_rk + a, 1.0_rk], [2, 2, 1])
      real(rk) :: exact, volume

      scene = paper_c()
      scene%sides(2)%traction = [20.0e6_rk, 0.0_rk]
      scene%sides(4)%traction = [0.0_rk, tension]
      scene%fluid%vapour_pressure = 0.0_rk
      call start(scene, at, [0.005_rk, 0.1_rk], 0.5_rk, 0.0_rk, mesh, model, state)
      call equilibrate(checks, model, mesh, 1.0e-6_rk, state, report, "open at vapour pressure")
      call checks%is_close(maxval(abs(state%pressure)), 0.0_rk, 1.0e-3_rk, "it has this pressure")
      exact = 2.0_rk*pi*tension*a**2*(1.0_rk - 0.3104329765_rk)/(2.0_rk*40.0e9_rk/2.4_rk)
      volume = sum(0.5_rk*sum(state%jump(1, :, :), dim=1)*model%condensed%length)
      ! 2 % of the cells (theory.md, tips), 1 % of the finite body
      call checks%is_close(volume, exact, 0.03_rk*exact, "volume against vapour pressure")
      call checks%is_close(maxval(abs(state%void)), 0.0_rk, 0.0_rk, "it is full")
      call advance(checks, model, mesh, 1.0e-6_rk, state, report, "the next step")
      call checks%is_close(report%mass_error, 0.0_rk, 1.0e-12_rk*exact, "fluid mass")
      call checks%is_true(all(state%pressure >= 0.0_rk), "still not below vapour")
   end subroutine open_at_vapour_pressure

   !> Ten steps of injection: fluid is neither made nor lost.
   subroutine injection_conserves_mass()
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk), parameter :: at(2, 2, 1) = reshape([0.9_rk, 0.95_rk, 1.1_rk, 1.05_rk], [2, 2, 1])
      real(rk), parameter :: dt = 1800.0_rk, rate = 5.0e-9_rk
      integer :: i

      scene = paper_c()
      call start(scene, at, [0.02_rk, 0.1_rk], 0.5_rk, 0.0175_rk, mesh, model, state)
      call model%equilibrate(mesh, 1.0e-6_rk, state, timers, report, error)
      model%cells%injection(1) = rate
      do i = 1, 10
         call advance(checks, model, mesh, dt, state, report, "injection step")
         call checks%is_close(report%mass_error, 0.0_rk, 1.0e-9_rk*rate*dt, &
                              "fluid mass in injection")
         call checks%is_close(report%contact_residual, 0.0_rk, 1.0e-8_rk, &
                              "contact law in injection")
         print "(a,i0,a,f9.4,a,i0,a,es9.2,a,es9.2)", "step ", i, " p_F [MPa]", &
            state%pressure(1)/1.0e6_rk, " iterations ", report%iterations, " mass", &
            report%mass_error, " slip", state%jump(2, 1, 5)
      end do
   end subroutine injection_conserves_mass

end program test_coarse_model
