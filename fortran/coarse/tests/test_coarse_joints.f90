!> Joints: which points are some; their equations against differences; a linear state passes through
!! every kind of them; flow through stars and outlets by the cubic law, with all fluid kept.
program test_coarse_joints
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use base_timers, only: timers_t
   use coarse_fields, only: cell_stresses
   use coarse_fractures, only: flow_paths_t, prepare
   use coarse_full_step, only: full_slopes
   use coarse_model, only: coarse_model_t
   use coarse_newton, only: equations_t
   use coarse_nodes, only: nodal_fields
   use coarse_state, only: state_t, step_report_t
   use contact_law, only: contact_law_t, state_stick
   use mesh_types, only: mesh_t, network_t
   use sample_bodies, only: new_square, advance, equilibrate, hold, load_sides, mesh_square, &
                            porous_body, scattered, set_permeability, straight_network
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: side_pressure = 2.0e6_rk  !< of the left side, where it has one [Pa]
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(timers_t) :: timers
   type(step_report_t) :: report
   type(scene_t) :: scene
   type(flow_paths_t), target :: paths  !< of the equations that are set up last

   call test_places()
   call test_slopes(.false.)
   call test_slopes(.true.)
   call test_linear_state()
   call test_sectors()
   call test_star()
   call test_outlet()
   call test_mass()
   call test_two_halves()
   call test_overdrawn()
   call checks%finish()

contains

   !> An X, a T, a V, and a fracture from the left side to the right one.
   function all_kinds() result(network)
      type(network_t) :: network
      real(rk), parameter :: ends(2, 2, 6) = reshape( &
                             [0.3_rk, 1.2_rk, 0.9_rk, 1.8_rk, 0.3_rk, 1.8_rk, 0.9_rk, 1.2_rk, &
                              0.0_rk, 0.4_rk, 2.0_rk, 0.4_rk, 1.0_rk, 0.4_rk, 1.2_rk, 0.9_rk, &
                              1.3_rk, 1.2_rk, 1.6_rk, 1.7_rk, 1.6_rk, 1.7_rk, 1.8_rk, 1.1_rk], &
                             [2, 2, 6])

      network = straight_network(ends)
   end function all_kinds

   !> `arms` straight fractures that begin at one point inside the square.
   function star(arms, turn) result(network)
      integer, intent(in) :: arms
      real(rk), intent(in) :: turn  !< of the first one from x [rad]
      type(network_t) :: network
      real(rk) :: ends(2, 2, arms), angle
      integer :: k

      do k = 1, arms
         angle = turn + 2.0_rk*pi*(k - 1)/arms
         ends(:, 1, k) = 1.0_rk
         ends(:, 2, k) = ends(:, 1, k) + 0.4_rk*[cos(angle), sin(angle)]
      end do
      network = straight_network(ends)
   end function star

   !> The square with a network, before anything happens.
   subroutine start(network, size, scene, law, aperture, mesh, model, state)
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: size  !< of the cells [m]
      type(scene_t), intent(in) :: scene
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: aperture  !< [m]
      type(mesh_t), intent(out) :: mesh
      type(coarse_model_t), intent(inout) :: model
      type(state_t), intent(out) :: state

      call new_square(checks, scene, network, [size, max(size, 0.4_rk)], law, aperture, mesh, &
                      model, state)
   end subroutine start

   !> Rock that is pressed together and lets nothing through.
   function tight_body() result(scene)
      type(scene_t) :: scene

      scene = porous_body()
      call hold(scene, [-60.0e6_rk, -60.0e6_rk])
      call set_permeability(scene, 1.0e-30_rk)
      scene%discretization%newton_tolerance = 1.0e-12_rk
   end function tight_body

   !> Joints are where cells meet otherwise than along one fracture; ends on a side are some only if
   !! it has a pressure.
   subroutine test_places()
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model, sealed
      type(state_t) :: state
      integer(ik) :: b

      scene = tight_body()
      call start(all_kinds(), 0.2_rk, scene, contact_law_t(), 1.0e-4_rk, mesh, sealed, state)
      call checks%is_true(sealed%joints%n == 3, "X, T and V")
      call checks%is_true(.not. any(sealed%joints%is_outlet), "sealed ends are no outlets")
      call checks%is_true(sealed%joints%branch_count() == 4 + 3 + 2, "their branches")
      scene%sides(1)%pressure_given = .true.
      scene%sides(1)%pressure = side_pressure
      call start(all_kinds(), 0.2_rk, scene, contact_law_t(), 1.0e-4_rk, mesh, model, state)
      call checks%is_true(model%joints%n == 4 .and. count(model%joints%is_outlet) == 1, &
                          "the end on the side with a pressure is an outlet")
      do b = 1, model%joints%branch_count()
         associate (joints => model%joints)
            call checks%is_true(mesh%fracture%cell_points(joints%end(b), joints%cell(b)) &
                                == joints%point(joints%joint(b)), "the end of a branch")
            if (.not. joints%is_outlet(joints%joint(b))) cycle
            call checks%is_close(mesh%fracture%point_xy(1, joints%point(joints%joint(b))), 0.0_rk, &
                                 1.0e-12_rk, "on the left side")
            call checks%is_close(state%joint_pressure(joints%joint(b)), side_pressure, &
                                 0.0_rk, "at its pressure")
         end associate
      end do
      call start(star(1, 0.3_rk), 0.2_rk, scene, contact_law_t(), 1.0e-4_rk, mesh, model, state)
      call checks%is_true(model%joints%n == 0, "a single fracture has none")
   end subroutine test_places

   !> All derivatives of the equations of joints and branches, and by their unknowns.
   subroutine test_slopes(with_shut)
      logical, intent(in) :: with_shut  !< the first branch of all joints, and all of the last one
      type(mesh_t) :: mesh
      type(coarse_model_t), target :: model
      type(state_t), target :: state
      type(equations_t) :: above, below, eq
      real(rk), parameter :: dt = 10.0_rk
      real(rk), allocatable :: jacobian(:, :), moved(:), x(:)
      real(rk), allocatable, target :: g(:)
      real(rk) :: step, worst
      integer(ik), allocatable :: flows(:), shut(:)
      integer(ik) :: i, k, row

      scene = tight_body()
      scene%sides(1)%pressure_given = .true.
      scene%sides(1)%pressure = side_pressure
      scene%fluid%viscosity = 2.0e4_rk
      call start(all_kinds(), 0.3_rk, scene, contact_law_t(), 1.0e-3_rk, mesh, model, state)
      model%joints%injection = 1.0e-7_rk
      if (with_shut) then
         associate (branches => model%joints%branches, n => model%joints%n)
            shut = [(branches%at(i, 1_ik), i=1, n), branches%of(n)]
            call model%joints%shut_only(model%joints%cell(shut), model%joints%end(shut))
            call checks%is_true(count(model%joints%is_shut) == n - 1 + branches%length(n), &
                                "shut branches")
         end associate
      end if
      model%cells%share = 0.8_rk
      call model%condensed%factorize(mesh, model%matrix, dt, error)
      call checks%no_error(error, "factorization")
      allocate (g(model%condensed%layout%count()), source=0.0_rk)
      paths = flow_paths_t(model%settings, model%connections, model%joints, model%wells)
      call prepare(model%condensed, model%cells, paths, dt, g, state, eq)
      x = 4.0e6_rk*scattered(eq%layout%count())
      x(eq%layout%at_flow(1_ik):) = 1.0e-3_rk*x(eq%layout%at_flow(1_ik):)
      below = eq
      above = eq
      call eq%evaluate(x)
      call full_slopes(model%condensed%stiffness, eq%slopes, jacobian)
      ! Where flows fulfil their equations, their slopes are the derivatives.
      flows = eq%layout%at_branch([(i, i=1, eq%layout%n_branches)])
      x(flows) = x(flows) - eq%residual(flows)/[(jacobian(flows(i), flows(i)), i=1, size(flows))]
      call eq%evaluate(x)
      call full_slopes(model%condensed%stiffness, eq%slopes, jacobian)
      worst = 0.0_rk
      do k = 1, size(x, kind=ik)
         step = 1.0e-4_rk*max(abs(x(k)), 1.0e6_rk)
         moved = x
         moved(k) = x(k) + step
         call above%evaluate(moved)
         moved(k) = x(k) - step
         call below%evaluate(moved)
         do row = eq%layout%at_branch(1_ik), size(x, kind=ik)
            worst = max(worst, abs((above%residual(row) - below%residual(row))/(2.0_rk*step) &
                                   - jacobian(k, row))/maxval(abs(jacobian(:, row))))
         end do
      end do
      call checks%is_close(worst, 0.0_rk, 1.0e-7_rk, "derivatives")
      ! What leaves the cells along branches arrives in the joints.
      moved = x
      moved(flows) = 0.0_rk
      call below%evaluate(moved)
      do k = 1, eq%layout%n_joints
         if (model%joints%is_outlet(k)) cycle
         associate (branches => model%joints%branches%of(k))
            call checks%is_close(eq%residual(eq%layout%at_joint(k)) &
                                 - below%residual(eq%layout%at_joint(k)), &
                                 -sum(x(eq%layout%at_branch(branches)), &
                                      mask=.not. model%joints%is_shut(branches)), 1.0e-6_rk, &
                                 "into the joint")
         end associate
      end do
   end subroutine test_slopes

   !> A body under uniform stress knows nothing of sticking fractures in it, however they meet.
   subroutine test_linear_state()
      integer :: arms
      type(network_t) :: network

      do arms = 2, 8
         call expect_uniform(star(arms, 0.37_rk), 0.2_rk)
         call expect_uniform(star(arms, 0.37_rk), 0.39_rk)
      end do
      network = all_kinds()
      call expect_uniform(network, 0.2_rk)
      call expect_uniform(network, 0.1_rk)
   end subroutine test_linear_state

   !> A sector between fractures that was a single cell could turn about the joint at no cost; the
   !! mesh gives each at least two, also at few degrees, at sides and at bends.
   subroutine test_sectors()
      type(mesh_t) :: mesh
      real(rk), parameter :: few_degrees(2, 2, 2) = reshape( &
                             [0.5_rk, 0.9_rk, 1.5_rk, 1.1_rk, 0.5_rk, 0.95_rk, 1.5_rk, 1.06_rk], &
                             [2, 2, 2])
      ! Each side of the triangle is one cell, and its inside one as well.
      real(rk), parameter :: triangle(2, 2, 3) = reshape( &
                             [1.0_rk, 1.0_rk, 1.1_rk, 1.0_rk, 1.1_rk, 1.0_rk, 1.05_rk, 1.08_rk, &
                              1.05_rk, 1.08_rk, 1.0_rk, 1.0_rk], [2, 2, 3])
      integer :: arms, k

      do arms = 2, 8
         do k = 0, 8
            call mesh_square(checks, star(arms, 5*k*pi/180.0_rk), 0.1_rk, 0.4_rk, mesh)
            call expect_two_cells(mesh)
         end do
      end do
      call mesh_square(checks, all_kinds(), 0.2_rk, 0.4_rk, mesh)
      call expect_two_cells(mesh)
      call mesh_square(checks, straight_network(few_degrees), 0.1_rk, 0.4_rk, mesh)
      call expect_two_cells(mesh)
      call mesh_square(checks, straight_network(triangle), 0.1_rk, 0.4_rk, mesh)
      call expect_two_cells(mesh)
      call expect_uniform(straight_network(triangle), 0.1_rk)
   end subroutine test_sectors

   !> Every node on a fracture, but for tips, has two cells or more on its side.
   subroutine expect_two_cells(mesh)
      type(mesh_t), intent(in) :: mesh
      integer(ik) :: around(mesh%n_nodes), c, i, side
      logical :: lies_on_fracture(mesh%n_nodes)

      around = 0
      do c = 1, mesh%n_cells
         around(mesh%cell_nodes(:, c)) = around(mesh%cell_nodes(:, c)) + 1
      end do
      lies_on_fracture = .false.
      do i = 1, mesh%fracture%n_cells
         do side = 1, 2
            lies_on_fracture(mesh%face_nodes(:, mesh%fracture%cell_faces(side, i))) = .true.
         end do
      end do
      call checks%is_true(all(around >= 2 .or. .not. lies_on_fracture), "two cells in each sector")
   end subroutine expect_two_cells

   subroutine expect_uniform(network, size)
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: size  !< of the cells [m]
      real(rk), parameter :: stress(3) = [-20.0e6_rk, -15.0e6_rk, 0.0_rk]
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk), allocatable :: stresses(:, :), values(:, :)
      real(rk) :: worst

      ! Without Poisson's effect u = (sigma_xx x, sigma_yy y)/E.
      scene = porous_body()
      scene%material%biot = 0.0_rk
      scene%material%poisson = 0.0_rk
      call load_sides(scene, stress)
      call hold(scene)
      call start(network, size, scene, contact_law_t(friction=5.0_rk), 1.0e-4_rk, mesh, model, &
                 state)
      call equilibrate(checks, model, mesh, 1.0e-3_rk, state, report, "a uniform state")
      if (.not. report%converged) return
      call checks%is_true(all(state%contact == state_stick), "all stick")
      call checks%is_close(maxval(abs(state%jump)), 0.0_rk, 0.0_rk, "no jump")
      allocate (stresses(3, mesh%n_cells), values(3, mesh%n_nodes))
      call cell_stresses(mesh, model%regions, state%tractions, stresses)
      worst = maxval(abs(stresses - spread(stress, 2, int(mesh%n_cells))))
      call checks%is_close(worst, 0.0_rk, 1.0e-12_rk*20.0e6_rk, "uniform stress")
      call nodal_fields(mesh, model%rock, model%regions, state%unknowns, state%tractions, values)
      values(:2, :) = values(:2, :) - mesh%xy*spread(stress(:2), 2, int(mesh%n_nodes))/40.0e9_rk
      worst = maxval(abs(values(:2, :)))
      call checks%is_close(worst, 0.0_rk, 1.0e-8_rk*1.0e-3_rk, "linear displacement at the nodes")
   end subroutine expect_uniform

   !> Steady flow from the joint of a star to the ends of its arms, which are drained at rates in
   !! the ratio 1 : 2 : ..: p_J - p = 12 mu Q_k s/a^3 along each.
   subroutine test_star()
      integer, parameter :: arms = 5
      real(rk), parameter :: aperture = 2.0e-5_rk, rate = 1.0e-8_rk
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk) :: drop, expected
      integer(ik) :: cells(2), i, k, step

      scene = tight_body()
      call start(star(arms, 0.37_rk), 0.1_rk, scene, contact_law_t(friction=5.0_rk), aperture, &
                 mesh, model, state)
      call model%equilibrate(mesh, 1.0_rk, state, timers, report, error)
      model%joints%injection = rate*sum([(k, k=1, arms)])
      do k = 1, arms
         model%cells%injection(maxloc(mesh%fracture%cell_s(2, :), dim=1, &
                                      mask=mesh%fracture%cell_fracture == k)) = -rate*k
      end do
      do step = 1, 3
         call advance(checks, model, mesh, 1.0e4_rk, state, report, "flow through a star")
      end do
      call checks%is_true(all(state%contact == state_stick), "the star stays closed")
      do i = 1, mesh%fracture%n_cells
         associate (s => 0.5_rk*sum(mesh%fracture%cell_s(:, i)))
            expected = 12.0_rk*scene%fluid%viscosity*rate*mesh%fracture%cell_fracture(i) &
                       /aperture**3*s
            drop = state%joint_pressure(1) - state%pressure(i)
            call checks%is_close(drop, expected, 1.0e-8_rk*expected, "pressure along an arm")
         end associate
      end do
      do i = 1, size(model%joints%cell, kind=ik)
         expected = -rate*mesh%fracture%cell_fracture(model%joints%cell(i))
         call checks%is_close(state%branch_flow(i), expected, 1.0e-10_rk*rate, "out of the joint")
      end do
      do k = 1, size(model%connections, 2, kind=ik)
         cells = model%connections(:, k)
         expected = rate*mesh%fracture%cell_fracture(cells(1))
         call checks%is_close(state%flow(k), expected, 1.0e-10_rk*rate, "along an arm")
      end do
   end subroutine test_star

   !> A fracture across the body between two sides whose pressures are given conducts by the cubic
   !! law; between sealed sides nothing flows.
   subroutine test_outlet()
      real(rk), parameter :: aperture = 3.0e-5_rk, dt = 1.0e6_rk
      real(rk), parameter :: line(2, 2, 1) = reshape([0.0_rk, 0.3_rk, 2.0_rk, 1.7_rk], [2, 2, 1])
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      real(rk) :: expected
      integer :: step

      scene = tight_body()
      scene%sides(1:2)%pressure_given = .true.
      scene%sides(1)%pressure = side_pressure
      call start(straight_network(line), 0.2_rk, scene, contact_law_t(friction=5.0_rk), aperture, &
                 mesh, model, state)
      do step = 1, 3
         call advance(checks, model, mesh, dt, state, report, "flow from side to side")
         call checks%is_close(report%mass_error, 0.0_rk, 1.0e-12_rk*dt*abs(state%flow(1)), &
                              "mass with flow through the sides")
      end do
      expected = aperture**3/(12.0_rk*scene%fluid%viscosity)*side_pressure/norm2(line(:, 2, 1) &
                                                                                 - line(:, 1, 1))
      call checks%is_close(maxval(abs(state%flow - expected)), 0.0_rk, 1.0e-9_rk*expected, &
                           "cubic law from side to side")
      ! Newton's tolerance, 1e-12, is relative to stresses 30 times the pressures.
      call checks%is_close(model%joints%outflow(state%branch_flow, model%into_joints(state)), &
                           0.0_rk, 1.0e-10_rk*expected, "what enters leaves")
   end subroutine test_outlet

   !> Injection into a cross whose arms slip and dilate: fluid is neither made nor lost, and the law
   !! of contact holds up to the joint.
   subroutine test_mass()
      real(rk), parameter :: rate = 2.0e-7_rk, dt = 600.0_rk
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      integer :: step

      scene = tight_body()
      call set_permeability(scene, 1.0e-19_rk)
      scene%sides(4)%traction(2) = -30.0e6_rk
      call start(star(4, 0.5_rk), 0.1_rk, scene, contact_law_t(friction=0.5_rk, dilation=0.05_rk), &
                 1.0e-4_rk, mesh, model, state)
      call equilibrate(checks, model, mesh, 1.0e-3_rk, state, report, "a loaded cross converges")
      model%joints%injection = rate
      do step = 1, 8
         call advance(checks, model, mesh, dt, state, report, "injection into a cross")
         call checks%is_close(report%mass_error, 0.0_rk, 1.0e-9_rk*rate*dt, "fluid of a cross")
         call checks%is_close(sum(state%branch_flow) + rate, 0.0_rk, 1.0e-9_rk*rate, &
                              "what is injected leaves the joint")
      end do
      call checks%is_true(any(state%contact /= state_stick), "the cross has moved")
   end subroutine test_mass

   !> A fracture drawn as two, end to end, is the same fracture: fluid opens it as it passes the
   !! joint.
   subroutine test_two_halves()
      real(rk), parameter :: whole(2, 2, 1) = reshape([0.6_rk, 0.9_rk, 1.4_rk, 1.1_rk], [2, 2, 1])
      real(rk), parameter :: halves(2, 2, 2) = reshape([0.6_rk, 0.9_rk, 1.0_rk, 1.0_rk, 1.0_rk, &
                                                        1.0_rk, 1.4_rk, 1.1_rk], [2, 2, 2])
      type(mesh_t) :: mesh, mesh_of_halves
      type(coarse_model_t) :: model, model_of_halves
      type(state_t) :: state, state_of_halves
      integer :: step

      scene = tight_body()
      scene%sides(2)%traction(1) = -2.0e6_rk
      scene%sides(4)%traction(2) = -1.0e6_rk
      scene%discretization%newton_tolerance = 1.0e-9_rk
      call start(straight_network(whole), 0.1_rk, scene, contact_law_t(friction=0.5_rk), &
                 1.0e-5_rk, mesh, model, state)
      call start(straight_network(halves), 0.1_rk, scene, contact_law_t(friction=0.5_rk), &
                 1.0e-5_rk, mesh_of_halves, model_of_halves, state_of_halves)
      call checks%is_true(mesh%n_cells == mesh_of_halves%n_cells, "the same mesh")
      model%cells%injection(2) = 1.0e-6_rk
      model_of_halves%cells%injection(2) = 1.0e-6_rk
      do step = 1, 10
         call advance(checks, model, mesh, 2.0_rk, state, report, "the whole converges")
         call model_of_halves%advance(mesh_of_halves, 2.0_rk, state_of_halves, timers, report, &
                                      error)
         call checks%is_true(report%converged, "the halves converge")
      end do
      associate (p => state%pressure, q => state_of_halves%pressure)
         call checks%is_close(maxval(abs(q - p)), 0.0_rk, 1.0e-7_rk*maxval(p), "pressures")
      end associate
      associate (a => state%aperture, b => state_of_halves%aperture)
         call checks%is_close(maxval(abs(b - a)), 0.0_rk, 1.0e-7_rk*maxval(a), "apertures")
         call checks%is_true(maxval(a) > 2.0e-5_rk, "the fluid has opened it")
      end associate
   end subroutine test_two_halves

   !> More than what flows to a joint cannot be drawn from it: the step is refused, and says why.
   subroutine test_overdrawn()
      type(mesh_t) :: mesh
      type(coarse_model_t) :: model
      type(state_t) :: state
      integer :: k

      scene = tight_body()
      scene%initial%pressure = 1.0e6_rk
      scene%fluid%vapour_pressure = 0.0_rk
      call start(star(3, 0.2_rk), 0.2_rk, scene, contact_law_t(friction=5.0_rk), 1.0e-6_rk, mesh, &
                 model, state)
      do k = 0, 1
         ! Over half a cell 12 mu q/a^3 (l/2) is 0.4 MPa, and then 4 MPa.
         model%joints%injection = -1.0e-8_rk*10**k
         call model%advance(mesh, 1.0e-9_rk, state, timers, report, error)
         call checks%no_error(error, "drawing from a joint")
         call checks%is_true(report%converged .eqv. k == 0, "no more than flows there")
      end do
      call checks%is_true(index(report%reason, "extracted from an intersection") > 0, "the reason")
   end subroutine test_overdrawn

end program test_coarse_joints
