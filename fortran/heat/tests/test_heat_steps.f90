!> Heat against closed forms: a half-space cooled at its face, heat carried through rock, heat that
!! fluid takes along a network; uniform temperatures, balances and bounds.
!!
!! Tolerances, written before the first run: 1 % of the range of temperature, of which the space has
!! some 0.7 % (layers, see test_coarse_layers) and the time 0.3 % (tolerance of &heat); balances
!! 1e-10.
program test_heat_steps
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_lists, only: inverted
   use base_timers, only: timers_t
   use coarse_fields, only: cell_stresses
   use coarse_model, only: coarse_model_t, new_state
   use coarse_state, only: state_t, step_report_t
   use contact_law, only: contact_law_t
   use heat_field, only: heat_field_t, moments, new_field
   use heat_flows, only: set_flows
   use heat_links, only: external_t
   use heat_model, only: heat_model_t
   use heat_state, only: heat_state_t
   use heat_steps, only: advance_heat
   use mesh_geometry, only: cell_area
   use mesh_types, only: mesh_t
   use sample_bodies, only: boxes, load_sides, mesh_square, porous_body, shake, straight_network, &
                            uniform_cells
   use scene_heat, only: heat_t
   use scene_types, only: initial_t, material_t, scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: minute = 60.0_rk, years = 365.25_rk*86400.0_rk
   real(rk), parameter :: capacity = 2.2e6_rk, of_fluid = 4.2e6_rk  ! [J/(m3 K)]
   !> Two fractures from side to side that cross; no tips.
   real(rk), parameter :: across(2, 2, 2) = reshape([0.0_rk, 0.75_rk, 2.0_rk, 1.25_rk, &
                                                     0.0_rk, 1.25_rk, 2.0_rk, 0.75_rk], [2, 2, 2])
   type(external_t), parameter :: none(0) = [external_t ::]
   type(checks_t) :: checks

   call cooled_face()
   call carried_through_rock()
   call network(.true.)
   call network(.false.)
   call steady_tips()
   call steady_past_fracture()
   call regions_in_series(1.0_rk)
   call regions_in_series(1.0e-3_rk)
   call thermal_stress(0.0_rk, .false.)
   call thermal_stress(0.3_rk, .false.)
   call thermal_stress(0.0_rk, .true.)
   call checks%finish()

contains

   !> A body with heat, supported, at a temperature of 100 K.
   pure type(scene_t) function hot_body(conductivity) result(scene)
      real(rk), intent(in) :: conductivity  !< [W/(m K)]

      scene = porous_body()
      scene%sides(1)%displacement_given(1) = .true.
      scene%sides(3)%displacement_given(2) = .true.
      scene%material%heat_capacity = capacity
      scene%material%heat_conductivity = conductivity
      scene%fluid%heat_capacity = of_fluid
      allocate (scene%heat)
      scene%heat = heat_t(temperature=100.0_rk)
   end function hot_body

   !> The square as n by n boxes, without fractures, in a state without flow.
   subroutine start_boxes(scene, n, mesh, model, state, as_drawn)
      type(scene_t), intent(in) :: scene
      integer(ik), intent(in) :: n
      type(mesh_t), intent(out) :: mesh
      type(coarse_model_t), intent(inout) :: model
      type(state_t), intent(out) :: state
      logical, intent(in), optional :: as_drawn  !< the nodes are not moved
      type(timers_t) :: timers
      type(error_t), allocatable :: error

      mesh = boxes(n)
      if (.not. present(as_drawn)) call shake(mesh)
      associate (no => mesh%fracture)
         allocate (no%cell_s(2, 0), no%cell_fracture(0), no%tip_point(0))
         allocate (no%tip_node(0), no%tip_fracture(0), no%tip_end(0))
         no%point_cells = inverted(no%cell_points, 0_ik)
      end associate
      model%cells = uniform_cells(mesh, contact_law_t(), 1.0e-4_rk)
      call model%set_mesh(mesh, scene, timers, error)
      call checks%no_error(error, "discretization")
      call new_state(mesh, model%cells, initial_t(), model, state)
   end subroutine start_boxes

   !> Discretize heat, and the state before the first step.
   subroutine start_heat(scene, mesh, model, state, first, heat, now)
      type(scene_t), intent(in) :: scene
      type(mesh_t), intent(in) :: mesh
      type(coarse_model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      real(rk), intent(in) :: first  !< [s]
      type(heat_model_t), intent(inout) :: heat
      type(heat_state_t), intent(out) :: now
      type(error_t), allocatable :: error

      call heat%set_mesh(mesh, scene, model%connections, model%joints, first, error)
      call checks%no_error(error, "heat on the mesh")
      call heat%begin(state%aperture, mesh%fracture%cell_s(2, :) - mesh%fracture%cell_s(1, :), &
                      first, 0, now)
   end subroutine start_heat

   !> Integrals of the temperature that acts within cells, and of that times x, by its moments.
   subroutine integrate(heat, now, content, moment)
      type(heat_model_t), intent(in) :: heat
      type(heat_state_t), intent(in) :: now
      real(rk), intent(out) :: content, moment  !< [K m2], [K m3]
      type(heat_field_t) :: field
      real(rk) :: of_cell(3)
      integer(ik) :: c

      field = new_field(heat, now%temperature, heat%cell_means(now))
      content = 0.0_rk
      moment = 0.0_rk
      associate (mesh => heat%mesh)
         do c = 1, mesh%n_cells
            associate (xy => mesh%xy(:, mesh%cell_nodes(:, c)))
               of_cell = cell_area(mesh, c)*moments(heat, field, xy, c)
               content = content + sum(of_cell)
               moment = moment + dot_product(of_cell, xy(1, :))
            end associate
         end do
      end associate
   end subroutine integrate

   !> The left side is cooled by 50 K: T = 50 erfc(x/(2 sqrt(D t))), and the heat that has left is 2
   !! C 50 sqrt(D t/pi) per area. Cells of 0.1 m and this conductivity are as those of 8 m in a body
   !! of 160 m of granite, a 20th of its edge as by default. From 1e6 s to two years the front
   !! passes from the layers to the cells. The cells behind it are not compared before the front is
   !! several cells wide.
   subroutine cooled_face()
      type(scene_t) :: scene
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      type(heat_model_t) :: heat
      type(heat_state_t) :: now
      type(error_t), allocatable :: error
      real(rk), parameter :: conductivity = 2.6_rk*(0.1_rk/8.0_rk)**2, cold = 50.0_rk
      real(rk), parameter :: times(7) = [minute, 3600.0_rk, 1.0e6_rk, 0.25_rk*years, years, &
                                         2.0_rk*years, 10.0_rk*years]
      real(rk), parameter :: tolerance = 0.01_rk
      real(rk), allocatable :: error_at(:)
      real(rk) :: content, depth, reached, time
      integer(ik) :: c
      integer :: k

      scene = hot_body(conductivity)
      scene%sides(1)%temperature_given = .true.
      scene%sides(1)%temperature = 100.0_rk - cold
      call start_boxes(scene, 20_ik, mesh, model, state)
      call start_heat(scene, mesh, model, state, 1.0_rk, heat, now)
      call set_flows(heat, mesh, model, state, none)
      time = 0.0_rk
      do k = 1, size(times)
         call advance_heat(heat, times(k) - time, now, error)
         call checks%no_error(error, "cooled face")
         time = times(k)
         reached = 2.0_rk*sqrt(conductivity/capacity*time)
         ! On 2 m of the side.
         call checks%is_close(now%stored/(-2.0_rk*cold*capacity*reached/sqrt(pi)), 1.0_rk, &
                              tolerance, "heat that has left")
         error_at = abs(now%temperature/cold + erfc(heat%place(1, :)/reached))
         call checks%is_close(maxval(error_at(mesh%n_cells + 1:)), 0.0_rk, tolerance, &
                              "temperatures of layers")
         call integrate(heat, now, content, depth)
         call checks%is_close(content/(-2.0_rk*cold*reached/sqrt(pi)), 1.0_rk, tolerance, &
                              "temperature within cells")
         call checks%is_close((depth/content - 0.25_rk*sqrt(pi)*reached)/max(reached, 0.1_rk), &
                              0.0_rk, 0.05_rk, "mean depth of the front")
      end do
      call checks%is_close(maxval(error_at(:mesh%n_cells), &
                                  [(all(heat%layers%cells /= c), c=1, mesh%n_cells)]), &
                           0.0_rk, tolerance, "temperatures of cells after ten years")
      call checks%is_close(now%balance_error(), 0.0_rk, 1.0e-10_rk, "balance")
      call checks%is_close(now%beyond_range/cold, 0.0_rk, 1.0e-3_rk, "bounds on shaken boxes")
   end subroutine cooled_face

   !> Ogata and Banks (1961): fluid of another temperature enters at the left and leaves at the
   !! right, v = C_f u/C,
   !!   2 T = erfc((x - v t)/(2 sqrt(D t))) + exp(v x/D) erfc((x + v t)/(2 sqrt(D t))).
   !! v is 1e-6 and D 1e-6 m/s as in the reference row: T = 0.713792 at x = 1, 0.364976 at x = 2 m.
   subroutine carried_through_rock()
      type(scene_t) :: scene
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      type(heat_model_t) :: heat
      type(heat_state_t) :: now
      type(step_report_t) :: report
      type(timers_t) :: timers
      type(error_t), allocatable :: error
      real(rk), parameter :: v = 1.0e-6_rk, d = 1.0e-6_rk, time = 1.5e5_rk
      real(rk) :: mobility, worst
      integer :: i

      call checks%is_close(ogata_banks(1.0_rk, 1.0e6_rk, v, d), 0.713792_rk, 1.0e-6_rk, &
                           "row of the references")
      call checks%is_close(ogata_banks(2.0_rk, 1.0e6_rk, v, d), 0.364976_rk, 1.0e-6_rk, &
                           "second row of the references")
      scene = hot_body(d*capacity)
      mobility = scene%material%permeability_xx/scene%fluid%viscosity
      scene%sides(:2)%pressure_given = .true.
      scene%sides(1)%pressure = v*capacity/of_fluid*2.0_rk/mobility
      scene%sides(1)%temperature_given = .true.
      scene%sides(1)%temperature = 101.0_rk
      call start_boxes(scene, 20_ik, mesh, model, state)
      call model%advance(mesh, 1.0e20_rk, state, timers, report, error)
      call checks%no_error(error, "steady flow")
      call start_heat(scene, mesh, model, state, 10.0_rk, heat, now)
      call set_flows(heat, mesh, model, state, none)
      call advance_heat(heat, time, now, error)
      call checks%no_error(error, "carried through rock")
      worst = 0.0_rk
      do i = 1, int(heat%n)
         worst = max(worst, abs(now%temperature(i) - ogata_banks(heat%place(1, i), time, v, d)))
      end do
      call checks%is_close(worst, 0.0_rk, 0.01_rk, "Ogata and Banks")
      call checks%is_close(now%balance_error(), 0.0_rk, 1.0e-10_rk, "balance with flow")
   end subroutine carried_through_rock

   elemental real(rk) function ogata_banks(x, t, v, d)
      real(rk), intent(in) :: x, t  !< [m], [s]
      real(rk), intent(in) :: v, d  !< [m/s], [m2/s]

      ogata_banks = 0.5_rk*(erfc((x - v*t)/(2.0_rk*sqrt(d*t))) &
                            + exp(v*x/d)*erfc((x + v*t)/(2.0_rk*sqrt(d*t))))
   end function ogata_banks

   !> Fluid that enters at one side and from wells flows through crossing fractures and rock. At the
   !! temperature of the body nothing changes, to the last bit; colder, temperatures stay between
   !! both, and no heat is made.
   subroutine network(is_cold)
      logical, intent(in) :: is_cold
      type(scene_t) :: scene
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      type(heat_model_t) :: heat
      type(heat_state_t) :: now
      type(step_report_t) :: report
      type(timers_t) :: timers
      type(error_t), allocatable :: error
      real(rk), parameter :: dt(3) = [1.0_rk, 1.0e3_rk, 1.0e6_rk]  ! [s]
      integer :: k

      scene = hot_body(2.6_rk)
      scene%material%permeability_xx = 1.0e-14_rk
      scene%material%permeability_yy = 1.0e-14_rk
      call load_sides(scene, [-20.0e6_rk, -20.0e6_rk, 0.0_rk])
      scene%sides(2)%pressure_given = .true.
      scene%sides(1)%inflow = 1.0e-7_rk
      scene%sides(1)%temperature_given = .true.
      scene%sides(1)%temperature = merge(30.0_rk, 100.0_rk, is_cold)
      call mesh_square(checks, straight_network(across), 0.2_rk, 0.3_rk, mesh)
      model%cells = uniform_cells(mesh, contact_law_t(friction=2.0_rk), 1.0e-4_rk)
      model%first_step = 1.0e-2_rk
      call model%set_mesh(mesh, scene, timers, error)
      call checks%no_error(error, "discretization of the network")
      call new_state(mesh, model%cells, initial_t(), model, state)
      model%cells%injection(1) = 1.0e-5_rk
      call start_heat(scene, mesh, model, state, 1.0_rk, heat, now)
      do k = 1, size(dt)
         call model%advance(mesh, dt(k), state, timers, report, error)
         call checks%no_error(error, "flow in the network")
         call set_flows(heat, mesh, model, state, &
                        [external_t(heat%first_cell, flow=of_fluid*1.0e-5_rk, &
                                    temperature=merge(-70.0_rk, 0.0_rk, is_cold))])
         call advance_heat(heat, dt(k), now, error)
         call checks%no_error(error, "heat in the network")
      end do
      if (is_cold) then
         call checks%is_true(minval(now%temperature) < -60.0_rk, "the network cools")
         call checks%is_close(now%balance_error(), 0.0_rk, 1.0e-10_rk, "balance of the network")
         call checks%is_close(now%beyond_range, 0.0_rk, 0.07_rk, "bounds of the network")
      else
         call checks%is_true(.not. any(abs(now%temperature) > 0.0_rk), "nothing changes")
      end if
      call checks%is_true(all(now%capacity > 0.0_rk), "capacities remain")
   end subroutine network

   !> Steady flow from a fracture with two tips: what flows into each part of the body flows out of
   !! it, and its capacity remains.
   subroutine steady_tips()
      type(scene_t) :: scene
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      type(heat_model_t) :: heat
      type(heat_state_t) :: now
      type(step_report_t) :: report
      type(timers_t) :: timers
      type(error_t), allocatable :: error
      real(rk), parameter :: line(2, 2, 1) = reshape([0.6_rk, 0.9_rk, 1.3_rk, 1.1_rk], [2, 2, 1])
      real(rk), parameter :: rate = 1.0e-9_rk, long = 1.0e4_rk  ! [m2/s], [s]
      real(rk), allocatable :: before(:)

      scene = hot_body(2.6_rk)
      call load_sides(scene, [-20.0e6_rk, -20.0e6_rk, 0.0_rk])
      scene%sides(:)%pressure_given = .true.
      call mesh_square(checks, straight_network(line), 0.1_rk, 0.3_rk, mesh)
      model%cells = uniform_cells(mesh, contact_law_t(friction=2.0_rk), 1.0e-4_rk)
      model%first_step = 1.0_rk
      call model%set_mesh(mesh, scene, timers, error)
      call checks%no_error(error, "discretization of a fracture")
      call checks%is_true(model%layers%n > 0, "layers of pressure")
      call new_state(mesh, model%cells, initial_t(), model, state)
      model%cells%injection(1) = rate
      call model%advance(mesh, 1.0e20_rk, state, timers, report, error)
      call checks%no_error(error, "steady flow from a fracture")
      call start_heat(scene, mesh, model, state, 1.0_rk, heat, now)
      before = now%capacity
      call set_flows(heat, mesh, model, state, &
                     [external_t(heat%first_cell, flow=of_fluid*rate, temperature=-70.0_rk)])
      call advance_heat(heat, long, now, error)
      call checks%no_error(error, "heat from a fracture")
      call checks%is_close(maxval(abs(now%capacity - before)), 0.0_rk, &
                           1.0e-6_rk*of_fluid*rate*long, "capacity in steady flow")
      call checks%is_close(now%balance_error(), 0.0_rk, 1.0e-10_rk, "balance in steady flow")
   end subroutine steady_tips

   !> Steady conduction past an inclined fracture at rest: linear. With layers whose temperature is
   !! uniform along their faces the cells at its ends are off by 4 % of the range along it.
   subroutine steady_past_fracture()
      type(scene_t) :: scene
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      type(heat_model_t) :: heat
      type(heat_state_t) :: now
      type(timers_t) :: timers
      type(error_t), allocatable :: error
      real(rk), parameter :: line(2, 2, 1) = reshape([0.6_rk, 0.7_rk, 1.3_rk, 1.3_rk], [2, 2, 1])
      integer :: k

      scene = hot_body(2.0_rk)
      call load_sides(scene, [-20.0e6_rk, -20.0e6_rk, 0.0_rk])
      scene%sides(3:4)%temperature_given = .true.
      scene%sides(3)%temperature = 100.0_rk
      scene%sides(4)%temperature = 0.0_rk
      call mesh_square(checks, straight_network(line), 0.1_rk, 0.3_rk, mesh)
      model%cells = uniform_cells(mesh, contact_law_t(friction=2.0_rk), 1.0e-4_rk)
      call model%set_mesh(mesh, scene, timers, error)
      call new_state(mesh, model%cells, initial_t(), model, state)
      call start_heat(scene, mesh, model, state, 1.0_rk, heat, now)
      call set_flows(heat, mesh, model, state, none)
      do k = 1, 3
         call advance_heat(heat, 1.0e9_rk, now, error)
      end do
      call checks%no_error(error, "conduction past a fracture")
      call checks%is_close(maxval(abs(now%temperature + 50.0_rk*heat%place(2, :))), 0.0_rk, &
                           1.0e-6_rk, "linear temperature past a fracture")
      call checks%is_close(now%balance_error(), 0.0_rk, 1.0e-10_rk, "its balance")
   end subroutine steady_past_fracture

   !> Steady conduction between two sides: linear in one rock, to rounding, also in the layers, and
   !! through a body whose right half conducts a thousandth.
   subroutine regions_in_series(ratio)
      real(rk), intent(in) :: ratio
      type(scene_t) :: scene
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      type(heat_model_t) :: heat
      type(heat_state_t) :: now
      type(error_t), allocatable :: error

      scene = hot_body(2.0_rk)
      scene%domain%x_max = 2.0_rk
      scene%domain%y_max = 2.0_rk
      allocate (scene%regions(1))
      scene%regions(1)%material = scene%material
      scene%regions(1)%material%heat_conductivity = ratio*2.0_rk
      scene%regions(1)%shape = "half_plane"
      scene%regions(1)%x = [1.0_rk, 1.0_rk]
      scene%regions(1)%y = [2.0_rk, 0.0_rk]
      scene%sides(:2)%temperature_given = .true.
      scene%sides(1)%temperature = 100.0_rk
      scene%sides(2)%temperature = 200.0_rk
      call start_boxes(scene, 10_ik, mesh, model, state)
      call start_heat(scene, mesh, model, state, 1.0_rk, heat, now)
      call set_flows(heat, mesh, model, state, none)
      call advance_heat(heat, 1.0e12_rk, now, error)
      call checks%no_error(error, "regions in series")
      if (ratio < 1.0_rk) then
         call checks%is_true(all(pack(now%temperature, heat%place(1, :) < 0.8_rk) < 0.5_rk), &
                             "the drop lies in the right half")
      else
         call checks%is_true(any(heat%layers%extended), "layers that reach farther")
         call checks%is_close(maxval(abs(now%temperature - 50.0_rk*heat%place(1, :))), 0.0_rk, &
                              1.0e-8_rk, "linear temperature")
      end if
   end subroutine regions_in_series

   !> A temperature that rises without flow, uniform in a body (free and in plane stress, or held at
   !! its sides) or in each of two layers that differ in all constants:
   !!   plane stress and free: p = (b_m - alpha b_s) theta/(S + alpha^2/K),
   !!   held: p = (b_m - alpha beta/M) theta/(S + alpha^2/M), beta = K b_s, M = K + 4/3 G,
   !!   sigma_xx = -2 G/M (alpha p + beta theta), sigma_yy = 0.
   !! Exact in the scheme, so to rounding (1e-9).
   subroutine thermal_stress(contrast, is_free)
      real(rk), intent(in) :: contrast  !< the rock below is softer by this share; 0: one rock [-]
      logical, intent(in) :: is_free
      type(scene_t) :: scene
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      type(timers_t) :: timers
      type(step_report_t) :: report
      type(error_t), allocatable :: error
      real(rk), parameter :: rise = -40.0_rk
      real(rk), allocatable :: pressure(:), sideways(:), stress(:, :)
      real(rk) :: values(2)
      integer(ik) :: c

      scene = hot_body(2.0_rk)
      scene%domain%x_max = 2.0_rk
      scene%domain%y_max = 2.0_rk
      scene%material%heat_expansion = 3.0e-5_rk
      scene%fluid%heat_expansion = 4.0e-4_rk
      scene%material%plane_stress = is_free
      scene%sides(2)%displacement_given(1) = .not. is_free
      if (contrast > 0.0_rk) then
         allocate (scene%regions(1))
         scene%regions(1)%shape = "half_plane"
         scene%regions(1)%x = [2.0_rk, 0.0_rk]
         scene%regions(1)%y = [1.0_rk, 1.0_rk]
         scene%regions(1)%material = scene%material
         associate (below => scene%regions(1)%material)
            below%young = (1.0_rk - contrast)*below%young
            below%biot = (1.0_rk - contrast)*below%biot
            below%heat_expansion = 0.5_rk*below%heat_expansion
         end associate
         call start_boxes(scene, 4_ik, mesh, model, state, as_drawn=.true.)
      else
         call start_boxes(scene, 4_ik, mesh, model, state)
      end if
      model%rock%temperature = spread(rise, 1, int(mesh%n_cells))
      call model%advance(mesh, 1.0e-9_rk, state, timers, report, error)
      call checks%no_error(error, "thermal stress")
      call checks%is_true(report%converged, "thermal stress: converged")
      allocate (pressure(mesh%n_cells), sideways(mesh%n_cells), stress(3, mesh%n_cells))
      do c = 1, mesh%n_cells
         values = expected(scene, scene%material, rise)
         if (contrast > 0.0_rk .and. sum(mesh%xy(2, mesh%cell_nodes(:, c))) < 3.0_rk) then
            values = expected(scene, scene%regions(1)%material, rise)
         end if
         pressure(c) = values(1)
         sideways(c) = values(2)
      end do
      call cell_stresses(mesh, model%regions, state%tractions, stress)
      associate (scale => maxval(abs(pressure)) + maxval(abs(sideways)))
         call checks%is_close(maxval(abs(state%unknowns(3, :mesh%n_cells) - pressure)), 0.0_rk, &
                              1.0e-9_rk*scale, "pressure of a rise")
         call checks%is_close(maxval(abs(stress(1, :) - sideways)), 0.0_rk, 1.0e-9_rk*scale, &
                              "stress along the layers")
         call checks%is_close(maxval(abs(stress(2:, :))), 0.0_rk, 1.0e-9_rk*scale, "no others")
      end associate
      call checks%is_close(maxval(abs(state%content)), 0.0_rk, 1.0e-15_rk, "fluid stays")
   end subroutine thermal_stress

   !> Pressure [Pa], and stress along the layers [Pa].
   pure function expected(scene, m, rise) result(values)
      type(scene_t), intent(in) :: scene
      type(material_t), intent(in) :: m
      real(rk), intent(in) :: rise  !< [K]
      real(rk) :: values(2)
      real(rk) :: bulk, content, modulus, shear, stored

      bulk = m%young/(3.0_rk*(1.0_rk - 2.0_rk*m%poisson))
      shear = m%young/(2.0_rk*(1.0_rk + m%poisson))
      stored = m%porosity*scene%fluid%compressibility + (m%biot - m%porosity)/bulk
      content = m%porosity*scene%fluid%heat_expansion + (m%biot - m%porosity)*m%heat_expansion
      modulus = merge(bulk, bulk + 4.0_rk/3.0_rk*shear, m%plane_stress)
      values(1) = (content - m%biot*bulk*m%heat_expansion/modulus)*rise &
                  /(stored + m%biot**2/modulus)
      values(2) = -2.0_rk*shear/modulus*(m%biot*values(1) + bulk*m%heat_expansion*rise)
      if (m%plane_stress) values(2) = 0.0_rk
   end function expected

end program test_heat_steps
