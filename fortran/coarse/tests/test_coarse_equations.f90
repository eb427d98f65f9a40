!> The equations on the fractures: all derivatives against central differences, in states without
!! any pattern; flow along fractures takes from one cell what it gives to the next.
program test_coarse_equations
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use coarse_fractures, only: flow_paths_t, prepare
   use coarse_full_step, only: full_slopes, reduced_t
   use coarse_layout, only: fracture_layout_t
   use coarse_model, only: coarse_model_t, new_state
   use coarse_newton, only: equations_t
   use coarse_tip_layer, only: opening_shape, pressure_shape, volume_shape
   use coarse_state, only: state_t
   use coarse_wells, only: control_limited, control_pressure, control_rate, control_shut
   use contact_law, only: contact_law_t, state_open, state_stick
   use contact_newton, only: step_quality_t
   use mesh_types, only: mesh_t
   use sample_bodies, only: hold, mesh_square, porous_body, scattered, set_permeability, &
                            straight_network, uniform_cells
   use scene_fluid_law, only: new_fluid_law
   use scene_types, only: fluid_t, initial_t, scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: dt = 10.0_rk  !< [s]
   real(rk), parameter :: vapour_pressure = 5.0e6_rk  !< below it are some of some_unknowns [Pa]
   integer(ik), parameter :: both(2) = [1_ik, 2_ik]  !< sides
   type(reduced_t), target :: reduced  !< factors of the steps
   type(checks_t) :: checks
   type(flow_paths_t), target :: paths  !< of the equations that are set up last
   type(mesh_t) :: mesh
   type(coarse_model_t), target :: model
   type(state_t), target :: state
   real(rk), allocatable, target :: g(:)  !< load on the condensed system
   logical :: has_occurred(state_stick:state_open) = .false.

   call start()
   call compare_slopes(.false., 1)
   call compare_slopes(.false., 2)
   call compare_slopes(.true., 3)
   call checks%is_true(all(has_occurred), "cells stick, slip and are open")
   call test_fluid_laws()
   call test_viscosity_of_cells()
   call test_exchange_along_fractures()
   call test_moving_tip(0.0_rk)
   call test_moving_tip(7.0_rk)
   model%cells%viscous(mesh%fracture%n_cells) = 7.0_rk
   call compare_slopes(.false., 1)
   model%cells%viscous = 0.0_rk
   call add_laws()
   call compare_slopes(.false., 1)
   call compare_slopes(.true., 3)
   call checks%finish()

contains

   !> Two fractures with laws and apertures that differ from cell to cell.
   subroutine start()
      type(scene_t) :: scene
      type(timers_t) :: timers
      type(error_t), allocatable :: error
      real(rk), parameter :: lines(2, 2, 2) = reshape([0.5_rk, 0.7_rk, 1.4_rk, 1.2_rk, 1.7_rk, &
                                                       1.6_rk, 0.7_rk, 1.5_rk], [2, 2, 2])
      integer(ik) :: i

      scene = porous_body()
      call hold(scene)
      call set_permeability(scene, 1.0e-15_rk)
      call mesh_square(checks, straight_network(lines), 0.3_rk, 0.5_rk, mesh)
      model%cells = uniform_cells(mesh, contact_law_t(), 1.0e-4_rk)
      do i = 1, mesh%fracture%n_cells
         model%cells%law(i) = contact_law_t(friction=0.2_rk*mod(i, 4_ik), &
                                            dilation=0.05_rk*mod(i, 3_ik))
         model%cells%injection(i) = 1.0e-7_rk*i
         ! Every other cell is of a grown part; a tip lies in the last one.
         if (mod(i, 2_ik) == 0) model%cells%roughness(i) = 1.0e-5_rk*i
      end do
      ! So viscous that flow and exchange take some MPa in ten seconds.
      scene%fluid%viscosity = 2.0e4_rk
      call model%set_mesh(mesh, scene, timers, error)
      call checks%no_error(error, "discretization")
      call model%condensed%factorize(mesh, model%matrix, dt, error)
      call checks%no_error(error, "factorization")
      call new_state(mesh, model%cells, initial_t(pressure=5.0e6_rk), model, state)
      state%jump = 1.0e-5_rk*reshape(scattered(size(state%jump, kind=ik)), shape(state%jump))
      state%pressure = state%pressure + 1.0e6_rk*scattered(mesh%fracture%n_cells)
      state%void = 1.0e-6_rk*abs(scattered(mesh%fracture%n_cells))
      associate (n => mesh%fracture%n_cells)
         model%cells%roughness(n) = 1.0e-5_rk
         model%cells%share(n) = 0.4_rk
         model%cells%has_tip(n) = .true.
      end associate
      call add_wells()
   end subroutine start

   !> Wells of all kinds, with storage and losses, fed in by one cell, by all, and between two; the
   !! second and the third have entries of all these.
   subroutine add_wells()
      integer(ik), parameter :: n_wells = 5
      integer(ik) :: w

      associate (wells => model%wells, n => mesh%fracture%n_cells)
         wells%n = n_wells
         wells%n_all = n_wells
         wells%n_entries = 5
         wells%of_entry = [2_ik, 2_ik, 3_ik, 3_ik, 3_ik]
         wells%entry_loss = 1.0e16_rk*[0.0_rk, 1.0_rk, 2.0_rk, 0.0_rk, 3.0_rk]
         allocate (wells%share(n, n_wells + 5), source=0.0_rk)
         allocate (wells%joint_share(0, n_wells + 5))
         wells%share(1, 1) = 1.0_rk
         wells%share(2:3, 6) = 0.5_rk
         wells%share(:, 7) = 1.0_rk/n
         wells%share(4, 8) = 1.0_rk
         wells%share(5, 9) = 1.0_rk
         wells%share(1:2, 10) = 0.5_rk
         wells%share(3:4, 4) = 0.5_rk
         wells%share(5, 5) = 1.0_rk
         allocate (wells%path(n, n_wells + 5), source=0.0_rk)
         wells%path([2, 3], 6) = 0.25_rk
         wells%path(4, 8) = 0.7_rk
         wells%path([1, 2], 10) = 0.25_rk
         wells%path([3, 4], 4) = 0.25_rk
         wells%control = [control_rate, control_pressure, control_limited, control_limited, &
                          control_shut]
         wells%rate = 1.0e-6_rk*[1.0_rk, 0.0_rk, 2.0_rk, -1.0_rk, 0.0_rk]
         ! About the pressures of the cells, so that either side of a limit is compared.
         wells%pressure = 6.0e6_rk + 2.0e6_rk*scattered(n_wells)
         wells%storage = 1.0e-13_rk*[1.0_rk, 2.0_rk, 3.0_rk, 4.0_rk, 5.0_rk]
         wells%friction = 1.0e11_rk*[(real(w, rk), w=1, n_wells)]
         wells%turbulence = 1.0e16_rk*[(real(w, rk), w=1, n_wells)]
         state%well_flow = spread(0.0_rk, 1, int(n_wells + 5))
         state%well_head = spread(6.0e6_rk, 1, int(n_wells))
      end associate
   end subroutine add_wells

   !> Unknowns of the size that they have in rock under some 10 MPa.
   subroutine some_unknowns(variant, x)
      integer, intent(in) :: variant
      real(rk), allocatable, intent(out) :: x(:)
      real(rk), allocatable :: numbers(:)
      type(fracture_layout_t) :: layout
      integer(ik) :: i

      layout = layout_of_model()
      allocate (numbers, source=scattered(int(variant, ik)*layout%count()))
      x = numbers((variant - 1)*size(numbers)/variant + 1:)
      x = 4.0e6_rk*x
      do i = 1, layout%n_cells
         associate (at => [layout%at_face_pressure(i, both), layout%at_pressure(i)])
            x(at) = x(at) + 6.0e6_rk
         end associate
      end do
      ! Flows that the cubic law takes some MPa for.
      x(layout%at_flow(1_ik):) = 5.0e-5_rk*x(layout%at_flow(1_ik):)
      ! Losses of turbulent wells have a kink at no flow.
      associate (flow => x(layout%at_well(1_ik):layout%at_well(layout%n_wells)))
         flow = flow + sign(1.0e3_rk, flow)
      end associate
   end subroutine some_unknowns

   type(fracture_layout_t) function layout_of_model()
      layout_of_model = fracture_layout_t(mesh%fracture%n_cells, 7_ik, &
                                          size(model%connections, 2, kind=ik), &
                                          model%joints%branch_count(), &
                                          model%wells%n + model%wells%n_entries, model%joints%n)
   end function layout_of_model

   !> A load such that about as many cells stick, slip and are open: f_n about -6 MPa, and the trial
   !! shear f_tau + c d[u]_tau some MPa.
   subroutine choose_load(x, volume)
      real(rk), intent(in) :: x(:)
      real(rk), intent(in) :: volume  !< size of the volumes [m2]
      type(equations_t) :: eq
      real(rk), allocatable :: normal(:), shear(:)
      real(rk) :: slip
      integer(ik), allocatable :: contact(:, :)
      integer(ik) :: at, end, i

      associate (n => mesh%fracture%n_cells)
         ! In the rows of the fluid: volumes [m2], whose way into the fracture takes some MPa.
         g = volume*scattered(model%condensed%layout%count())
         call equations_at(x, .false., eq, contact)
         allocate (normal, source=-6.0e6_rk + 8.0e6_rk*scattered(2*n))
         allocate (shear, source=1.5e6_rk*scattered(4*n))
         do i = 1, n
            do end = 1, 2
               at = model%condensed%layout%at_jump(i, end)
               slip = x(eq%layout%at_jump(i, end) + 1) - eq%stiffness*state%jump(2, end, i)
               associate (half_length => 0.5_rk*model%condensed%length(i), k => 2*(i - 1) + end, &
                          fluid => x(eq%layout%at_pressure(i)))
                  g(at:at + 1) = g(at:at + 1) + eq%force(at:at + 1) &
                                 - half_length*[fluid - normal(k), slip - shear(2*n + k)]
               end associate
            end do
         end do
      end associate
   end subroutine choose_load

   subroutine equations_at(x, equilibrate, eq, contact)
      real(rk), intent(in) :: x(:)
      logical, intent(in) :: equilibrate
      type(equations_t), intent(out) :: eq
      integer(ik), allocatable, intent(out) :: contact(:, :)

      paths = flow_paths_t(model%settings, model%connections, model%joints, model%wells)
      paths%settings%equilibrate = equilibrate
      paths%settings%vapour_pressure = vapour_pressure
      call prepare(model%condensed, model%cells, paths, dt, g, state, eq)
      call eq%evaluate(x)
      contact = reshape(eq%state, [2_ik, mesh%fracture%n_cells])
   end subroutine equations_at

   !> A skin on every other cell, joints that close, bonds that have been worn a little, and cells
   !! that are both.
   subroutine add_laws()
      integer(ik) :: i

      associate (n => mesh%fracture%n_cells)
         model%cells%skin = [(1.0e10_rk*modulo(i, 2_ik), i=1, n)]
         do i = 1, n
            associate (law => model%cells%law(i))
               if (modulo(i, 3_ik) /= 0) then
                  law%compliance = 1.0e-12_rk*i
                  law%closure_end = 1.0e5_rk
               end if
               if (modulo(i, 3_ik) /= 1) then
                  law%tension = 2.0e6_rk
                  law%cohesion = 3.0e6_rk
                  law%wear_by_slip = 1.0e3_rk
                  law%wear_by_opening = 2.0e3_rk
               end if
            end associate
         end do
         allocate (state%slip_path(2, n), source=1.0e-5_rk)
         allocate (state%opened(2, n), source=2.0e-6_rk)
      end associate
   end subroutine add_laws

   !> Each column of the Jacobian, relative to the largest entry of its row. Where a difference
   !! would reach across a change of state it says nothing.
   subroutine compare_slopes(equilibrate, variant)
      logical, intent(in) :: equilibrate
      integer, intent(in) :: variant
      type(equations_t) :: above, below, eq
      real(rk), allocatable :: jacobian(:, :), moved(:), row_scale(:), x(:)
      real(rk) :: step, worst
      integer(ik), allocatable :: contact(:, :), contact_above(:, :), contact_below(:, :)
      integer(ik) :: k, n_compared

      call some_unknowns(variant, x)
      ! In equilibrium no volume passes, and none hides rounding errors.
      call choose_load(x, merge(0.0_rk, 2.0e-3_rk, equilibrate))
      call equations_at(x, equilibrate, eq, contact)
      call fulfil_flows(eq, x)
      call equations_at(x, equilibrate, eq, contact)
      do k = state_stick, state_open
         has_occurred(k) = has_occurred(k) .or. any(contact == k)
      end do
      call full_slopes(model%condensed%stiffness, eq%slopes, jacobian)
      allocate (row_scale, source=maxval(abs(jacobian), dim=1))
      worst = 0.0_rk
      n_compared = 0
      do k = 1, size(x)
         step = 1.0e-4_rk*max(abs(x(k)), 1.0e6_rk)
         moved = x
         moved(k) = x(k) + step
         call equations_at(moved, equilibrate, above, contact_above)
         moved(k) = x(k) - step
         call equations_at(moved, equilibrate, below, contact_below)
         if (any(contact_above /= contact) .or. any(contact_below /= contact)) cycle
         n_compared = n_compared + 1
         worst = max(worst, maxval(abs((above%residual - below%residual)/(2.0_rk*step) &
                                       - jacobian(k, :))/row_scale))
      end do
      call checks%is_close(worst, 0.0_rk, 1.0e-7_rk, "derivatives")
      call checks%is_true(n_compared > 0.9_rk*size(x), "nearly all columns were compared")
      call compare_step(eq, jacobian, row_scale)
   end subroutine compare_slopes

   !> Flows along fractures and to joints that fulfil their equations: there their slopes are the
   !! derivatives.
   subroutine fulfil_flows(eq, x)
      type(equations_t), intent(inout) :: eq
      real(rk), intent(inout) :: x(:)
      real(rk), allocatable :: jacobian(:, :)
      integer(ik) :: k

      call full_slopes(model%condensed%stiffness, eq%slopes, jacobian)
      do k = eq%layout%at_flow(1_ik), eq%layout%at_branch(eq%layout%n_branches)
         x(k) = x(k) - eq%residual(k)/jacobian(k, k)
      end do
   end subroutine fulfil_flows

   !> The linear step, most of whose unknowns leave the matrix before it is factorized: it fulfils
   !! all equations as they are. Rounding: some hundred terms of 1e-16 of the largest.
   subroutine compare_step(eq, jacobian, row_scale)
      type(equations_t), intent(inout) :: eq
      real(rk), intent(in) :: jacobian(:, :)  !< an equation per column
      real(rk), intent(in) :: row_scale(:)
      type(step_quality_t) :: quality
      real(rk) :: step(size(row_scale))

      eq%reduced => reduced
      call eq%find_step(.true., step, quality)
      call checks%is_true(.not. quality%is_singular, "there is a step")
      call checks%is_close(maxval(abs(matmul(step, jacobian) + eq%residual)/row_scale) &
                           /maxval(abs(step)), 0.0_rk, 1.0e-13_rk, "all equations of the step")
      call checks%is_true(quality%condition >= 1.0_rk, "with a condition")
   end subroutine compare_step

   !> Laws of viscosity and density that change by a factor within the pressures of the cells: all
   !! derivatives, and with pressures in situ. A table that samples an exponential law is that law.
   subroutine test_fluid_laws()
      type(fluid_t) :: fluid
      type(equations_t) :: by_law, by_table
      real(rk), allocatable :: x(:)
      integer(ik), allocatable :: contact(:, :)
      integer(ik) :: i

      fluid%viscosity = model%settings%viscosity
      fluid%compressibility = 3.0e-8_rk
      fluid%viscosity_law = "exponential"
      fluid%viscosity_exponent = 2.0e-7_rk
      fluid%density_law = "exponential"
      fluid%reference_pressure = 7.0e6_rk
      model%settings%compressibility = 0.0_rk
      model%settings%fluid_law = new_fluid_law(fluid)
      call compare_slopes(.false., 1)
      call compare_slopes(.false., 2)
      call compare_slopes(.true., 3)
      model%cells%pressure_in_situ = [(1.0e5_rk*i, i=1, mesh%fracture%n_cells)]
      call compare_slopes(.false., 2)
      call some_unknowns(2, x)
      call equations_at(x, .false., by_law, contact)
      fluid%table_pressure = [(1.0e6_rk*i, i=-30, 60, 3)]
      fluid%table_viscosity = fluid%viscosity &
                              *exp(fluid%viscosity_exponent*(fluid%table_pressure - 7.0e6_rk))
      fluid%table_density = 1.1e3_rk &
                            *exp(fluid%compressibility*(fluid%table_pressure - 7.0e6_rk))
      fluid%viscosity_law = "table"
      fluid%density_law = "table"
      model%settings%fluid_law = new_fluid_law(fluid)
      call equations_at(x, .false., by_table, contact)
      associate (scale => maxval(abs(by_law%residual)))
         call checks%is_close(maxval(abs(by_table%residual - by_law%residual)), 0.0_rk, &
                              1.0e-12_rk*scale, "a table of an exponential law")
      end associate
      deallocate (model%settings%fluid_law, model%cells%pressure_in_situ)
   end subroutine test_fluid_laws

   !> Viscosities of the cells: derivatives, and twice the viscosity in all of them is twice that of
   !! the fluid for the flow along fractures.
   subroutine test_viscosity_of_cells()
      type(equations_t) :: by_cells, by_fluid
      real(rk), allocatable :: x(:)
      integer(ik), allocatable :: contact(:, :)
      integer(ik) :: i, k

      model%cells%viscosity_ratio = [(0.3_rk*i, i=1, mesh%fracture%n_cells)]
      call compare_slopes(.false., 1)
      call some_unknowns(2, x)
      model%cells%viscosity_ratio = 2.0_rk
      call equations_at(x, .false., by_cells, contact)
      deallocate (model%cells%viscosity_ratio)
      model%settings%viscosity = 2.0_rk*model%settings%viscosity
      call equations_at(x, .false., by_fluid, contact)
      model%settings%viscosity = 0.5_rk*model%settings%viscosity
      associate (at => by_fluid%layout%at_flow([(k, k=1, by_fluid%layout%n_flows)]))
         call checks%is_close(maxval(abs(by_cells%residual(at) - by_fluid%residual(at))), 0.0_rk, &
                              0.0_rk, "flow at another viscosity")
      end associate
   end subroutine test_viscosity_of_cells

   !> What flows along a fracture leaves one balance and enters the next; the other ends are closed.
   subroutine test_exchange_along_fractures()
      type(equations_t) :: at_rest, flowing
      real(rk), allocatable :: change(:), x(:)
      integer(ik), allocatable :: balances(:), contact(:, :)
      type(fracture_layout_t) :: layout
      integer(ik) :: first, i, k

      layout = layout_of_model()
      call checks%is_true(layout%n_flows == layout%n_cells - 2, "two fractures, not connected")
      balances = [(layout%at_pressure(i), i=1, layout%n_cells)]
      call some_unknowns(1, x)
      x(layout%at_flow(1_ik):) = 0.0_rk
      call equations_at(x, .false., at_rest, contact)
      do k = 1, layout%n_flows
         x(layout%at_flow(1_ik):) = 0.0_rk
         x(layout%at_flow(k)) = 3.0e6_rk
         call equations_at(x, .false., flowing, contact)
         first = model%connections(1, k)
         change = flowing%residual - at_rest%residual
         call checks%is_close(change(layout%at_pressure(first)), 3.0e6_rk, 1.0e-6_rk*3.0e6_rk, &
                              "out of the first cell")
         call checks%is_close(sum(change(balances)), 0.0_rk, 1.0e-6_rk*3.0e6_rk, &
                              "nothing is lost on the way")
      end do
   end subroutine test_exchange_along_fractures

   !> Fluid that follows a tip: with the opening k sqrt(d) in both cells at the tip, and the flow V
   !! w through each section, the pressure falls by 12 mu V/k^2 per unit of ln d.
   subroutine test_moving_tip(b)
      real(rk), intent(in) :: b  !< of coarse_tip_layer; 0: viscosity has no effect [1/m^(1/2)]
      real(rk), parameter :: k = 1.0e-3_rk  ! [m^1/2]
      real(rk), parameter :: speed = 1.0e-9_rk  ! [m/s]
      type(equations_t) :: eq
      real(rk), allocatable :: x(:)
      real(rk) :: between(2), d(3), fall, opening(2), reach(2)
      integer(ik), allocatable :: contact(:, :)
      integer(ik) :: cells(2), end, i, pair

      pair = size(model%connections, 2, kind=ik)
      cells = model%connections(:, pair)
      call checks%is_true(cells(2) == mesh%fracture%n_cells, "the last cell is the second")
      model%cells%residual_aperture(cells) = 1.0e-6_rk
      model%cells%roughness(cells) = 1.0e-6_rk
      call some_unknowns(1, x)
      associate (length => model%condensed%length(cells), share => model%cells%share(cells))
         reach = share*length
         d = [sum(reach), reach(2), 0.0_rk]
         opening = k*(volume_shape(b, d(:2)) - volume_shape(b, d(2:)))/length
      end associate
      call equations_at(x, .false., eq, contact)
      do i = 1, 2
         do end = 1, 2
            x(eq%layout%at_jump(cells(i), end)) = eq%stiffness*opening(i)
         end do
      end do
      model%cells%viscous(cells(2)) = b
      x(eq%layout%at_flow(pair)) = speed*k*opening_shape(b, d(2))*dt/eq%unit
      between = [0.5_rk*reach(2), d(2) + 0.5_rk*reach(1)]
      if (b > 0.0_rk) then
         fall = pressure_shape(b, between(2)) - pressure_shape(b, between(1))
      else
         fall = log(between(2)/between(1))
      end if
      x(eq%layout%at_pressure(cells(1))) = 9.0e6_rk
      x(eq%layout%at_pressure(cells(2))) = 9.0e6_rk &
                                           - 12.0_rk*model%settings%viscosity*speed/k**2*fall
      call equations_at(x, .false., eq, contact)
      call checks%is_true(minval(x(eq%layout%at_pressure(cells))) > vapour_pressure + 1.0e6_rk, &
                          "above the vapour pressure")
      call checks%is_close(eq%residual(eq%layout%at_flow(pair)), 0.0_rk, 1.0_rk, &
                           "pressure along the way to a moving tip")
   end subroutine test_moving_tip

end program test_coarse_equations
