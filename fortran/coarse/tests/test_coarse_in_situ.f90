!> The state in situ on the coarse level: where it comes from in a scene, a body at rest under its
!! weight, a column that its weight compresses, and what the fluid of fractures bears at depth.
program test_coarse_in_situ
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use coarse_in_situ, only: find_in_situ, in_situ_state_t, weight_of_scene
   use coarse_model, only: coarse_model_t, new_state
   use coarse_state, only: fracture_cells_t, state_t, step_report_t
   use contact_law, only: contact_law_t, state_stick
   use mesh_builder, only: build_mesh, mesh_spec_t, mesher_t
   use mesh_types, only: mesh_t
   use sample_bodies, only: advance, hold, porous_body, set_permeability, straight_network
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: g = 9.81_rk  !< [m/s2]
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(step_report_t) :: report
   type(scene_t) :: scene
   type(timers_t) :: timers

   call check_states()
   call check_rest()
   call check_column()
   call check_vapour()
   call checks%finish()

contains

   !> 2 m by 2 m, 3 km deep.
   pure function basin() result(scene)
      type(scene_t) :: scene

      scene = porous_body()
      scene%material%density = 2500.0_rk
      scene%fluid%density = 1000.0_rk
      scene%gravity = [0.0_rk, -g]
      scene%in_situ%stress = [-2.0e6_rk, 0.0_rk, 1.0e6_rk]
      scene%in_situ%per_y = [18.0e3_rk, 2500.0_rk*g]
      scene%in_situ%y_datum = 3000.0_rk
      scene%initial%pressure = 1.0e5_rk
      call hold(scene)
   end function basin

   !> Which scenes have one, what it is, and what weight it carries.
   subroutine check_states()
      type(in_situ_state_t), allocatable :: state
      real(rk), parameter :: tight = 1.0e-9_rk  ! rounding of MPa [Pa]
      real(rk) :: traction(2)

      scene = porous_body()
      scene%initial%pressure = 1.0e6_rk
      scene%gravity(2) = -g
      scene%material%density = 2000.0_rk
      call find_in_situ(scene, 0.5_rk, state)
      call checks%is_true(.not. allocated(state), "weight of the rock alone is a load")
call checks%is_close(maxval(abs(weight_of_scene(scene) - [0.0_rk, -2000.0_rk*g])), 0.0_rk, 0.0_rk, &
                           "weight")
      scene%fluid%density = 1000.0_rk
      scene%in_situ%y_datum = 10.0_rk
      call find_in_situ(scene, 0.5_rk, state)
      call checks%is_true(allocated(state), "a fluid with weight")
      call checks%is_close(state%pressure_at(8.0_rk), 1.0e6_rk + 2000.0_rk*g, 1.0e-9_rk, &
                           "pressure below the datum")
      ! The skeleton bears no stress yet: sigma = -alpha p.
      call checks%is_close(maxval(abs(state%stress_at(8.0_rk) - [-0.5_rk, -0.5_rk, 0.0_rk] &
                                      *(1.0e6_rk + 2000.0_rk*g))), 0.0_rk, 1.0e-9_rk, &
                           "stress without strain")
      traction = state%side_traction([1.0_rk, 2.0_rk], [1.0_rk, 0.0_rk], 10.0_rk)
      call checks%is_close(maxval(abs(traction - [0.5e6_rk + 1.0_rk, 2.0_rk])), 0.0_rk, tight, &
                           "a total traction, beyond that stress")
      scene = basin()
      call find_in_situ(scene, 0.5_rk, state)
      call checks%is_close(maxval(abs(state%stress_at(2999.0_rk) &
                                      - [-2.018e6_rk, -2500.0_rk*g, 1.0e6_rk])), 0.0_rk, tight, &
                           "stress in situ")
      traction = state%side_traction([1.0_rk, 2.0_rk], [1.0_rk, 0.0_rk], 10.0_rk)
      call checks%is_close(maxval(abs(traction - [1.0_rk, 2.0_rk])), 0.0_rk, 0.0_rk, &
                           "tractions beside the stress in situ")
      scene%in_situ%per_y(2) = 2499.0_rk*g  ! rounded by the user
call checks%is_close(maxval(abs(weight_of_scene(scene) - [0.0_rk, -2499.0_rk*g])), 0.0_rk, 0.0_rk, &
                           "the weight is what the stress in situ carries")
   end subroutine check_states

   subroutine begin(scene, ends, size_fracture, friction, mesh, model, state)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: ends(:, :, :)  !< of straight fractures [m]
      real(rk), intent(in) :: size_fracture  !< and four times that far from them [m]
      real(rk), intent(in) :: friction
      type(mesh_t), intent(out) :: mesh
      type(coarse_model_t), intent(inout) :: model
      type(state_t), intent(out) :: state
      type(mesher_t) :: mesher
      type(error_t), allocatable :: error

      associate (d => scene%domain)
         call build_mesh(mesh_spec_t(x_min=d%x_min, x_max=d%x_max, y_min=d%y_min, y_max=d%y_max, &
                                     size_fracture=size_fracture, &
                                     size_boundary=4.0_rk*size_fracture), &
                         straight_network(ends), mesher, mesh, error)
      end associate
      call checks%no_error(error, "mesh")
      model%cells = fracture_cells_t()
      associate (n => mesh%fracture%n_cells)
         allocate (model%cells%law(n), source=contact_law_t(friction=friction))
         allocate (model%cells%residual_aperture(n), source=1.0e-4_rk)
         allocate (model%cells%roughness(n), model%cells%injection(n), source=0.0_rk)
      end associate
      call model%set_mesh(mesh, scene, timers, error)
      call checks%no_error(error, "discretization")
      call new_state(mesh, model%cells, scene%initial, model, state)
   end subroutine begin

   !> A crossing of two fractures and one at a drained side, in a body whose stress and pressure
   !! carry the weight: nothing moves or flows, to the last bit, and the contact tractions are those
   !! of the stress and the pressure at the ends of the cells.
   subroutine check_rest()
      real(rk), parameter :: ends(2, 2, 3) = reshape([0.4_rk, 0.5_rk, 1.2_rk, 1.3_rk, &
                                                      0.3_rk, 1.2_rk, 1.3_rk, 0.6_rk, &
                                                      1.6_rk, 1.0_rk, 2.0_rk, 1.5_rk], [2, 2, 3])
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk) :: along, across, n(2), stress(2, 2), worst, y
      integer(ik) :: cell, end, step

      scene = basin()
      scene%domain%x_max = 2.0_rk
      scene%domain%y_max = 2.0_rk
      scene%sides(2)%pressure_given = .true.
      scene%sides(2)%pressure = scene%initial%pressure
      call begin(scene, ends, 0.1_rk, 5.0_rk, mesh, model, state)
      call model%equilibrate(mesh, 1.0e-3_rk, state, timers, report, error)
      call checks%no_error(error, "initial state")
      do step = 1, 3
         call advance(checks, model, mesh, 10.0_rk**(2*step), state, report, "a step at rest")
      end do
      call checks%is_close(maxval(abs(state%unknowns)), 0.0_rk, 0.0_rk, "nothing moves")
      call checks%is_close(maxval(abs(state%jump)), 0.0_rk, 0.0_rk, "no jump")
      call checks%is_close(maxval(abs([state%flow, state%branch_flow, state%leakoff])), 0.0_rk, &
                           0.0_rk, "nothing flows")
      call checks%is_true(all(state%contact == state_stick), "all stick")
      call checks%is_close(report%mass_error, 0.0_rk, 0.0_rk, "no fluid is made")
      worst = 0.0_rk
      do cell = 1, mesh%fracture%n_cells
         n = model%condensed%normal(:, cell)
         do end = 1, 2
            y = mesh%fracture%point_xy(2, mesh%fracture%cell_points(end, cell))
            stress(:, 1) = [-2.0e6_rk + 18.0e3_rk*(y - 3000.0_rk), 1.0e6_rk]
            stress(:, 2) = [1.0e6_rk, 2500.0_rk*g*(y - 3000.0_rk)]
            across = dot_product(n, matmul(stress, n)) + 1.0e5_rk - 1000.0_rk*g*(y - 3000.0_rk)
            along = dot_product([n(2), -n(1)], matmul(stress, n))
            worst = max(worst, maxval(abs(state%traction(:, end, cell) - [across, along])))
         end do
      end do
      ! Of 75 MPa rounding leaves less.
      call checks%is_close(worst, 0.0_rk, 1.0e-6_rk, "contact tractions in situ")
   end subroutine check_rest

   !> A column of height H between rollers that its weight compresses, no stress in situ. With
   !! the oedometric modulus M and drained at its top, when all has flowed,
   !!   sigma_yy = -rho g (H - y), p = rho_f g (H - y), M u_y' = sigma_yy + alpha p.
   subroutine check_column()
      real(rk), parameter :: height = 100.0_rk
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk) :: exact, modulus, slope, worst(2), y
      integer(ik) :: c, level

      scene = basin()
      scene%in_situ%stress = 0.0_rk
      scene%in_situ%per_y = 0.0_rk
      scene%in_situ%y_datum = height
      scene%initial%pressure = 0.0_rk
      call set_permeability(scene, 1.0e-12_rk)
      scene%domain%x_max = 20.0_rk
      scene%domain%y_max = height
      scene%sides(1:2)%displacement_given(1) = .true.
      scene%sides(4)%pressure_given = .true.
      modulus = 40.0e9_rk*0.8_rk/(1.2_rk*0.6_rk)
      slope = (-2500.0_rk + 0.8_rk*1000.0_rk)*g/modulus
      do level = 1, 2
         call begin(scene, reshape([real(rk) ::], [2, 2, 0]), 2.5_rk/level, 0.0_rk, mesh, model, &
                    state)
         call model%equilibrate(mesh, 1.0e-3_rk, state, timers, report, error)
         call model%advance(mesh, 1.0e15_rk, state, timers, report, error)
         call checks%no_error(error, "a column under its weight")
         worst(level) = 0.0_rk
         do c = 1, mesh%n_cells
            y = sum(mesh%xy(2, mesh%cell_nodes(:, c)))/3.0_rk
            exact = slope*(height*y - 0.5_rk*y**2)
            worst(level) = max(worst(level), abs(state%unknowns(2, c) - exact))
         end do
         call checks%is_close(maxval(abs(state%unknowns(3, :))), 0.0_rk, 1.0e-3_rk, &
                              "its pressure is hydrostatic")
      end do
      worst = worst/abs(slope*0.5_rk*height**2)
      print "(a,2es10.2)", "settlement of a column, relative error", worst
      ! Second order in cells of a tenth of the height: (h/H)^2.
      call checks%is_true(worst(1) < 1.0e-2_rk, "settlement")
      call checks%is_true(worst(2) < 0.35_rk*worst(1), "settlement: second order")
   end subroutine check_column

   !> More fluid is drawn from an inclined fracture than its pressure gives: vapour collects at its
   !! upper end, whose pressure is that of vapour, 0 and not 0 beyond that in situ; the lower end is
   !! full, and its pressure higher, but by no more than the fluid above it weighs.
   subroutine check_vapour()
      real(rk), parameter :: ends(2, 2, 1) = reshape([0.7_rk, 0.8_rk, 1.3_rk, 1.2_rk], [2, 2, 1])
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk), allocatable :: pressure(:)

      scene = basin()
      scene%fluid%vapour_pressure = 0.0_rk
      scene%domain%x_max = 2.0_rk
      scene%domain%y_max = 2.0_rk
      call begin(scene, ends, 0.1_rk, 5.0_rk, mesh, model, state)
      model%cells%injection = -1.0e-6_rk
      call advance(checks, model, mesh, 0.3_rk, state, report, "fluid is drawn")
      pressure = state%pressure + model%cells%pressure_in_situ
      associate (n => mesh%fracture%n_cells)
         call checks%is_true(state%void(n) > 0.0_rk .and. .not. state%void(1) > 0.0_rk, &
                             "vapour above, none below")
         call checks%is_close(maxval(abs(pressure), mask=state%void > 0.0_rk), 0.0_rk, 1.0e-6_rk, &
                              "the pressure of vapour")
         call checks%is_true(pressure(1) > 0.0_rk .and. pressure(1) < 0.4_rk*1000.0_rk*g, &
                             "the pressure below it")
      end associate
   end subroutine check_vapour

end program test_coarse_in_situ
