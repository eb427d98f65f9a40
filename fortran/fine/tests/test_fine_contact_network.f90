!> Contact on a network with kinks, a T and an X joint and seven free tips: under a uniform stress
!! that the faces can carry, and under loads that change their direction from step to step, when the
!! law must hold at every pair, with its whole history.
program test_fine_contact_network
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use contact_law, only: contact_law_t, state_open, state_stick
   use contact_point, only: contact_residual
   use exact_cracks, only: uniform_field
   use exact_fields, only: reactions
   use fine_boundary, only: add_side_traction, clamped_boundary, fine_boundary_t, free_boundary, &
                            nearest_node
   use fine_contact, only: contact_t, new_contact
   use fine_elasticity, only: elasticity_t
   use fine_faces, only: face_conditions_t, face_contact, face_law_t, loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_mesh, only: tip_collapsed
   use fine_model, only: fine_model_t
   use mesh_builder, only: build_mesh, mesh_spec_t, mesher_t
   use mesh_types, only: mesh_t, network_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   integer(ik), parameter :: left = 1, right = 2, bottom = 3, top = 4
   real(rk), parameter :: half(2) = [3.5_rk, 2.5_rk]
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(fine_model_t) :: model
   type(fine_boundary_t) :: boundary
   integer(ik) :: seen(0:2) = 0

   call set_body()
   call uniform_stress(0.0_rk, 0.0_rk)
   call uniform_stress(0.6_rk, 1.5e6_rk)
   call history(0.0_rk, 0.0_rk)
   call history(0.3_rk, 0.0_rk)
   call history(0.6_rk, 0.1_rk)
   call checks%is_true(all(seen > 0), "network: every state occurs")
   call checks%finish()

contains

   subroutine set_body()
      type(network_t) :: network
      type(mesh_spec_t) :: spec
      type(mesher_t) :: mesher
      type(mesh_t) :: mesh

      ! The second fracture has a kink, the third ends on the first, which the fourth crosses.
      network = network_t(first=[1_ik, 3_ik, 6_ik, 8_ik, 10_ik], s_start=spread(0.0_rk, 1, 4), &
                          xy=reshape([-1.2_rk, 0.1_rk, 0.6_rk, 0.3_rk, &
                                      0.9_rk, -1.0_rk, 1.4_rk, -0.4_rk, 1.4_rk, 0.7_rk, &
                                      -0.7_rk, -1.1_rk, -0.3_rk, 0.2_rk, &
                                      0.1_rk, 0.9_rk, 0.2_rk, -0.5_rk], [2, 9]))
      spec%x_min = -half(1)
      spec%x_max = half(1)
      spec%y_min = -half(2)
      spec%y_max = half(2)
      spec%size_fracture = 0.1_rk
      spec%size_boundary = 0.8_rk
      spec%is_window = .true.
      spec%rosette_sectors = 12
      spec%rosette_radius = 0.1_rk
      call build_mesh(spec, network, mesher, mesh, error)
      call checks%no_error(error, "network is meshed")
      call model%set_mesh(mesh, elasticity_t(70.0e9_rk, 0.21_rk, 0.0_rk, .false.), error, &
                          tip_collapsed)
      call checks%no_error(error, "network is numbered")
      boundary = free_boundary(model%mesh)
      boundary%prescribed(:, nearest_node(model%mesh, -half)) = .true.
      boundary%prescribed(2, nearest_node(model%mesh, [half(1), -half(2)])) = .true.
   end subroutine set_body

   !> Closed faces that hold carry a uniform stress through the joints as if they were not there.
   subroutine uniform_stress(friction, shear)
      real(rk), intent(in) :: friction, shear  !< [-], [Pa]
      real(rk), parameter :: pressure = 5.0e6_rk
      type(fine_boundary_t) :: clamped
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: conditions
      type(contact_t) :: contact
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: exact(2, model%mesh%n_nodes), tau(2), normal(2), across(2), apart
      integer(ik) :: cell, k, node

      conditions = loaded_everywhere(model%mesh)
      conditions%condition = face_contact
      conditions%law = face_law_t(contact_law_t(friction))
      clamped = clamped_boundary(model%mesh)
      call model%prepare(conditions, error, clamped)
      associate (tied => model%constraints)
         call checks%is_true(size(tied%closing, 2) == 2 .and. &
                             size(tied%kept_dofs) == size(tied%contact_dofs), &
                             "one end at the T and one at the X have no law, and load jumps alone")
      end associate
      loads = no_loads(model%mesh)
      do node = 1, model%mesh%n_nodes
         exact(:, node) = uniform_field(model%elasticity, [-pressure, -pressure, shear], &
                                        model%mesh%xy(:, node))
      end do
      loads%boundary_displacement = exact
      contact = new_contact(model%mesh)
      call model%solve(loads, displacement, error, contact)
      call checks%no_error(error, "uniform stress is solved")
      call checks%is_close(maxval(abs(displacement - exact)), 0.0_rk, &
                           1.0e-12_rk*maxval(abs(exact)), "uniform stress: displacement")
      apart = 0.0_rk
      do cell = 1, model%mesh%fracture%n_cells
         tau = model%mesh%face_tangent(:, cell)
         normal = [-tau(2), tau(1)]
         across = -pressure*normal + shear*[normal(2), normal(1)]
         do k = 1, 3
            ! A kink has a frame of its own; a tip has no pair.
            if (model%constraints%face_pair(k, cell) == 0) cycle
            if (norm2(model%constraints%tangent(:, model%constraints%face_pair(k, cell)) - tau) &
                > 1.0e-9_rk) cycle
            apart = max(apart, abs(contact%traction(1, k, cell) - dot_product(across, tau)), &
                        abs(contact%traction(2, k, cell) - dot_product(across, normal)))
         end do
      end do
      call checks%is_close(apart, 0.0_rk, 1.0e-2_rk, "uniform stress: tractions")
   end subroutine uniform_stress

   !> Eight loads one after the other.
   subroutine history(friction, dilation)
      real(rk), intent(in) :: friction, dilation
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: conditions
      type(contact_t) :: contact
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: stress(3), direction
      integer(ik) :: state, step

      conditions = loaded_everywhere(model%mesh)
      conditions%condition = face_contact
      conditions%law = face_law_t(contact_law_t(friction, dilation))
      call model%prepare(conditions, error, boundary)
      call checks%no_error(error, "network is set up")
      contact = new_contact(model%mesh)
      do step = 1, 8
         ! Mean pressure from 7 MPa to -1 MPa and back, shear stress of 4 MPa that turns.
         direction = 1.3_rk*step
         stress = 4.0e6_rk*[cos(direction), -cos(direction), sin(direction)]
         stress(1:2) = stress(1:2) - 3.0e6_rk + 4.0e6_rk*sin(0.8_rk*step)
         loads = no_loads(model%mesh)
         call add_side_traction(model%mesh, left, -stress([1, 3]), loads%force)
         call add_side_traction(model%mesh, right, stress([1, 3]), loads%force)
         call add_side_traction(model%mesh, bottom, -stress([3, 2]), loads%force)
         call add_side_traction(model%mesh, top, stress([3, 2]), loads%force)
         call model%solve(loads, displacement, error, contact)
         call checks%no_error(error, "network is solved")
         if (allocated(error)) return
         call checks%is_true(contact%iterations <= 10, "network: iterations")
         call check_law(conditions%law(1)%contact, displacement, contact)
         call check_equilibrium(loads, displacement)
         do state = state_stick, state_open
            seen(state) = seen(state) + count(contact%state == state)
         end do
         call contact%accept()
      end do
   end subroutine history

   !> The law at the middle of every cell, with jumps from the displacements and tractions from the
   !! elements on both sides.
   subroutine check_law(law, displacement, contact)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: displacement(:, :)
      type(contact_t), intent(in) :: contact
      real(rk), parameter :: share = 2.0_rk/3.0_rk  ! of a middle node, with quarter points or not
      real(rk), parameter :: stiffness = 70.0e9_rk/0.1_rk
      real(rk) :: jump(2), tau(2), normal(2), force(2, 6), traction(2, 2), worst, apart, gap
      integer(ik) :: cell, element, k, side

      worst = 0.0_rk
      apart = 0.0_rk
      gap = 0.0_rk
      do cell = 1, model%mesh%fracture%n_cells
         tau = model%mesh%face_tangent(:, cell)
         normal = [-tau(2), tau(1)]
         associate (middle => model%mesh%face_nodes(3, :, cell))
            jump = displacement(:, middle(2)) - displacement(:, middle(1))
            do side = 1, 2
               element = model%mesh%face_cells(side, cell)
               k = findloc(model%mesh%cell_nodes(:, element), middle(side), dim=1)
               force = model%element_forces(displacement, element)
               traction(:, side) = force(:, k)/(share*model%mesh%face_length(cell))
            end do
         end associate
         apart = max(apart, norm2(traction(:, 1) + traction(:, 2)))
         ! beyond what the asperities make, which slip has lifted onto each other
         gap = max(gap, abs(contact%apart(3, cell) - dot_product(normal, jump) &
                            + law%dilation*abs(dot_product(tau, jump))))
         worst = max(worst, &
                     contact_residual(law, stiffness, &
                                      [dot_product(normal, traction(:, 1)), &
                                       dot_product(tau, traction(:, 1))], &
                                      [dot_product(normal, jump), dot_product(tau, jump)], &
                                      contact%slip_before(3, cell)))
      end do
      call checks%is_close(apart, 0.0_rk, 1.0e-2_rk, "network: equal and opposite tractions")
      call checks%is_close(worst, 0.0_rk, 1.0e-2_rk, "network: law fulfilled")
      call checks%is_close(gap, 0.0_rk, 1.0e-12_rk, "network: how far faces are apart [m]")
   end subroutine check_law

   !> What acts on the nodes besides the loads is contact, equal and opposite; so nothing is left
   !! at nodes away from the fractures, and nothing as a whole.
   subroutine check_equilibrium(loads, displacement)
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)
      real(rk) :: force(2, model%mesh%n_nodes)
      logical :: on_fracture(model%mesh%n_nodes)
      integer(ik) :: cell

      force = reactions(model, loads, displacement)
      on_fracture = .false.
      do cell = 1, model%mesh%fracture%n_cells
         on_fracture(pack(model%mesh%face_nodes(:, :, cell), .true.)) = .true.
      end do
      call checks%is_close(maxval(abs(force), mask=.not. spread(on_fracture, 1, 2)), 0.0_rk, &
                           1.0e-2_rk, "network: equilibrium")
      call checks%is_close(maxval(abs(sum(force, dim=2))), 0.0_rk, 1.0e-2_rk, &
                           "network: contact forces cancel")
   end subroutine check_equilibrium

end program test_fine_contact_network
