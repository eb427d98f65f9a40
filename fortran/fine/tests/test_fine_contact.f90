!> Contact on node pairs against fields that fulfil its law exactly, and against cracks that are
!! closed, slip, or are open in part.
program test_fine_contact
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use contact_law, only: contact_law_t, state_open, state_slip, state_stick
   use exact_cracks, only: bent_crack, centre_crack, uniform_field
   use fine_boundary, only: fine_boundary_t, free_boundary, mark_side
   use fine_contact, only: contact_t, new_contact
   use fine_elasticity, only: elasticity_t
   use fine_faces, only: face_conditions_t, face_contact, face_law_t, loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_model, only: fine_model_t
   use mesh_types, only: mesh_t
   use sample_meshes, only: cracked_rectangle, rotate_mesh
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(mesh_t) :: mesh
   type(elasticity_t), parameter :: rock = elasticity_t(4.0e10_rk, 0.2_rk, 0.8_rk, .false.)
   real(rk), parameter :: pressure = 1.0e6_rk, slip = 3.0e-5_rk
   real(rk), parameter :: angle = 0.4_rk  ! of the cut with the x axis [rad]
   real(rk), parameter :: tau(2) = [cos(angle), sin(angle)], n(2) = [-sin(angle), cos(angle)]

   ! Stress across the cut (s_nn, s_tn); its contact part is s_nn + pressure.
   call block("slip", face_law_t(contact_law_t(0.375_rk, 0.0_rk)), [-5.0e6_rk, 1.5e6_rk], &
              [slip, 0.0_rk], 0.0_rk, state_slip)
   call block("slip the other way", face_law_t(contact_law_t(0.375_rk, 0.0_rk)), &
              [-5.0e6_rk, -1.5e6_rk], [-slip, 0.0_rk], 0.0_rk, state_slip)
   call block("dilation", face_law_t(contact_law_t(0.375_rk, 0.15_rk)), [-5.0e6_rk, 1.5e6_rk], &
              [slip, 0.15_rk*slip], 0.0_rk, state_slip)
   call block("frictionless", face_law_t(), [-5.0e6_rk, 0.0_rk], [slip, 0.0_rk], 0.0_rk, state_slip)
   call block("stick with history", face_law_t(contact_law_t(0.5_rk, 0.15_rk)), &
              [-5.0e6_rk, 1.5e6_rk], [slip, 0.15_rk*slip], slip, state_stick)
   call block("open", face_law_t(contact_law_t(0.5_rk, 0.15_rk)), [-pressure, 0.0_rk], &
              [slip, slip], 0.0_rk, state_open)
   call block("given slip", face_law_t(contact_law_t(), slip_given=.true.), [-5.0e6_rk, 4.5e6_rk], &
              [slip, 0.0_rk], 0.0_rk, state_slip)
   call block("given slip, closed", &
              face_law_t(contact_law_t(bilateral=.true.), slip_given=.true.), &
              [4.0e6_rk, 4.5e6_rk], [slip, 0.0_rk], 0.0_rk, state_slip)
   ! Friction drives this slip, so one the other way would do as well: it goes on as it began.
   call block("closed under tension", face_law_t(contact_law_t(0.5_rk, bilateral=.true.)), &
              [2.0e6_rk, -0.5_rk*(2.0e6_rk + pressure)], [slip, 0.0_rk], -0.5_rk*slip, state_slip)
   call frictional_crack()
   call history()
   call partly_open()
   call resting_block()
   call checks%finish()

contains

   !> A block cut through along a line, under a stress that is uniform and a jump that is uniform:
   !! with displacements given all around, contact inside must reproduce both.
   subroutine block(name, law, across, jump, slip_before, state)
      character(len=*), intent(in) :: name
      type(face_law_t), intent(in) :: law
      real(rk), intent(in) :: across(2)  !< s_nn, s_tn [Pa]
      real(rk), intent(in) :: jump(2)  !< tau, n [m]
      real(rk), intent(in) :: slip_before  !< [m]
      integer(ik), intent(in) :: state
      real(rk), parameter :: along = -3.0e6_rk
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: conditions
      type(contact_t) :: contact
      real(rk), allocatable :: displacement(:, :), exact(:, :)
      real(rk) :: stress(3)
      integer(ik) :: cell, k

      stress = along*[tau(1)**2, tau(2)**2, tau(1)*tau(2)] &
               + across(1)*[n(1)**2, n(2)**2, n(1)*n(2)] &
               + across(2)*[2.0_rk*n(1)*tau(1), 2.0_rk*n(2)*tau(2), n(1)*tau(2) + n(2)*tau(1)]
      mesh = cracked_rectangle([-1.0_rk, 1.0_rk], [-1.0_rk, 1.0_rk], [5_ik, 4_ik], 2_ik, 1_ik, 5_ik)
      call rotate_mesh(mesh, angle, .false.)
      call model%set_mesh(mesh, rock, error)
      allocate (exact(2, model%mesh%n_nodes))
      do k = 1, model%mesh%n_nodes
         exact(:, k) = uniform_field(rock, stress, model%mesh%xy(:, k))
      end do
      do cell = 1, model%mesh%n_cells
         associate (nodes => model%mesh%cell_nodes(:, cell))
            if (dot_product(n, sum(model%mesh%xy(:, nodes(1:3)), dim=2)) < 0.0_rk) cycle
            do k = 1, 6
               exact(:, nodes(k)) = uniform_field(rock, stress, model%mesh%xy(:, nodes(k))) &
                                    + jump(1)*tau + jump(2)*n
            end do
         end associate
      end do
      conditions = loaded_everywhere(model%mesh)
      conditions%condition = face_contact
      conditions%law = law
      call model%prepare(conditions, error)
      call checks%no_error(error, name//" is set up")
      loads = no_loads(model%mesh)
      loads%boundary_displacement = exact
      loads%fluid_pressure = pressure
      loads%jump(1, :, :) = jump(1)
      loads%traction = 9.0e6_rk  ! without meaning under contact
      contact = new_contact(model%mesh)
      contact%slip_before = slip_before
      call model%solve(loads, displacement, error, contact)
      call checks%no_error(error, name//" is solved")
      call checks%is_close(maxval(abs(displacement - exact))/maxval(abs(exact)), 0.0_rk, &
                           1.0e-11_rk, name)
      call checks%is_true(all(contact%state(:, 2:4) == state), name//": state")
      call checks%is_close(maxval(abs(contact%traction(1, :, 2:4) - across(2))), 0.0_rk, &
                           1.0e-2_rk, name//": shear traction")
      call checks%is_close(maxval(abs(contact%traction(2, :, 2:4) - across(1) - pressure)), &
                           0.0_rk, 1.0e-2_rk, name//": normal traction")
      call checks%is_close(max(maxval(abs(contact%jump(1, :, 2:4) - jump(1))), &
                               maxval(abs(contact%jump(2, :, 2:4) - jump(2)))), &
                           0.0_rk, 1.0e-11_rk*maxval(abs(exact)), name//": jump")
      call checks%is_true(contact%iterations <= 10, name//": iterations")
      call checks%is_close(contact%residual, 0.0_rk, 1.0e-9_rk, name//": law fulfilled")
   end subroutine block

   !> A crack in a plate, turned by 45 degrees, whose edges carry the exact displacement.
   subroutine set_crack(model, boxes)
      type(fine_model_t), intent(inout) :: model
      integer(ik), intent(in) :: boxes  !< on the half crack
      type(error_t), allocatable :: error

      associate (b => boxes)
         mesh = cracked_rectangle([-2.0_rk, 2.0_rk], [-2.0_rk, 2.0_rk], [4*b, 4*b], 2*b, b + 1, 3*b)
      end associate
      call rotate_mesh(mesh, 0.25_rk*pi, .false.)
      call model%set_mesh(mesh, rock, error)
      call checks%no_error(error, "cracked plate is numbered")
   end subroutine set_crack

   !> Edge displacements of the uniform stress (-20, -10) MPa, and of a crack at 45 degrees that
   !! sheds the given shear stress.
   subroutine load_crack(model, factor, shed, loads)
      type(fine_model_t), intent(in) :: model
      real(rk), intent(in) :: factor  !< of the remote stress
      real(rk), intent(in) :: shed  !< [Pa]
      type(fine_loads_t), intent(out) :: loads
      real(rk) :: rotation(2, 2), remote(3), crack(2)
      integer(ik) :: node

      remote = factor*[-20.0e6_rk, -10.0e6_rk, 0.0_rk]
      rotation = reshape([1.0_rk, 1.0_rk, -1.0_rk, 1.0_rk], [2, 2])*sqrt(0.5_rk)
      loads = no_loads(model%mesh)
      do node = 1, model%mesh%n_nodes
         associate (xy => model%mesh%xy(:, node))
            crack = centre_crack(rock, 1.0_rk, 0.0_rk, shed, matmul(transpose(rotation), xy), &
                                 .true.)
            loads%boundary_displacement(:, node) = uniform_field(rock, remote, xy) &
                                                   + matmul(rotation, crack)
         end associate
      end do
   end subroutine load_crack

   !> Catalogue 3.1: shear stress 5 MPa, pressure 6.8 MPa, friction 0.5: slip
   !! 4 (0.9 MPa)/E' sqrt(a**2 - x**2) at the contact pressure 8.2 MPa; with friction 0.7 it sticks.
   subroutine frictional_crack()
      real(rk), parameter :: shed = 0.9e6_rk
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: conditions
      type(contact_t) :: contact
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: difference, whole, exact, weight
      integer(ik) :: cell, k

      call set_crack(model, 8_ik)
      conditions = loaded_everywhere(model%mesh)
      conditions%condition = face_contact
      conditions%law%contact%friction = 0.5_rk
      call model%prepare(conditions, error)
      call load_crack(model, 1.0_rk, shed, loads)
      loads%fluid_pressure = 6.8e6_rk
      contact = new_contact(model%mesh)
      call model%solve(loads, displacement, error, contact)
      call checks%no_error(error, "frictional crack is solved")
      difference = 0.0_rk
      whole = 0.0_rk
      do cell = 1, model%mesh%fracture%n_cells
         do k = 1, 3
            weight = model%mesh%face_length(cell)*merge(4.0_rk, 1.0_rk, k == 3)/6.0_rk
            exact = 4.0_rk*shed/rock%crack_modulus() &
                    *sqrt(max(0.0_rk, 1.0_rk - (model%mesh%face_s(k, cell) - 1.0_rk)**2))
            difference = difference + weight*(contact%jump(1, k, cell) - exact)**2
            whole = whole + weight*exact**2
         end do
      end do
      print "(a,f8.4,a,i3)", "slip profile: error in % (L2)", 100.0_rk*sqrt(difference/whole), &
         ", iterations", contact%iterations
      call checks%is_close(sqrt(difference/whole), 0.0_rk, 0.01_rk, "slip profile")
      call checks%is_true(contact%iterations <= 10, "frictional crack: iterations")
      call checks%is_close(contact%residual, 0.0_rk, 1.0e-9_rk, "frictional crack: law fulfilled")
      call checks%is_close(maxval(abs(contact%jump(2, :, :))), 0.0_rk, 1.0e-12_rk*sqrt(whole), &
                           "frictional crack is closed")
      call checks%is_close(maxval(abs(contact%traction(2, :, 2:15) + 8.2e6_rk)), 0.0_rk, &
                           1.0e-2_rk*8.2e6_rk, "frictional crack: contact pressure")

      conditions%law%contact%friction = 0.7_rk
      call model%prepare(conditions, error)
      call load_crack(model, 1.0_rk, 0.0_rk, loads)
      loads%fluid_pressure = 6.8e6_rk
      contact = new_contact(model%mesh)
      call model%solve(loads, displacement, error, contact)
      call checks%no_error(error, "sticking crack is solved")
      call checks%is_close(maxval(abs(contact%jump)), 0.0_rk, &
                           1.0e-13_rk*maxval(abs(displacement)), "a crack below its limit sticks")
      call checks%is_close(maxval(abs(contact%traction(1, :, 2:15) - 5.0e6_rk)), 0.0_rk, &
                           1.0e-2_rk, "sticking crack: shear traction")
   end subroutine frictional_crack

   !> Load, then take half of the load away: friction now opposes the return, and where the limit
   !! is not reached the other way the slip stays as it is. Slip with friction is not elastic.
   subroutine history()
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: conditions
      type(contact_t) :: contact
      real(rk), allocatable :: displacement(:, :), slipped(:, :)

      call set_crack(model, 4_ik)
      conditions = loaded_everywhere(model%mesh)
      conditions%condition = face_contact
      conditions%law%contact%friction = 0.3_rk
      call model%prepare(conditions, error)
      ! Shear 5 MPa, limit 4.5 MPa.
      call load_crack(model, 1.0_rk, 0.5e6_rk, loads)
      contact = new_contact(model%mesh)
      call model%solve(loads, displacement, error, contact)
      call checks%is_true(all(contact%state(3, :) == state_slip), "history: slips under the load")
      call contact%accept()
      slipped = contact%jump(1, :, :)
      ! Shear 2.5 MPa less the 0.5 MPa that the locked slip sheds; limit 2.25 MPa.
      call load_crack(model, 0.5_rk, 0.5e6_rk, loads)
      call model%solve(loads, displacement, error, contact)
      call checks%no_error(error, "history is solved")
      call checks%is_true(all(contact%state(3, :) == state_stick), "history: sticks at half of it")
      call checks%is_close(maxval(abs(contact%jump(1, :, :) - slipped)), 0.0_rk, &
                           1.0e-13_rk*maxval(abs(displacement)), "history: slip stays")
      call checks%is_close(maxval(abs(contact%traction(1, 3, 3:6) - 2.0e6_rk)), 0.0_rk, &
                           0.02_rk*2.0e6_rk, "history: locked slip has shed its stress")
   end subroutine history

   !> Bending: the crack opens from -a/3 on, where the tractions fade and the faces part smoothly.
   subroutine partly_open()
      real(rk), parameter :: slope = 1.0e6_rk, bound = -1.0_rk/3.0_rk
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: conditions
      type(contact_t) :: contact
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: exact(2), opposite(2), whole, difference, place, size_h, weight
      integer(ik) :: cell, k, node, wrong

      mesh = cracked_rectangle([-2.0_rk, 2.0_rk], [-2.0_rk, 2.0_rk], [48_ik, 48_ik], 24_ik, &
                               13_ik, 36_ik)
      size_h = 4.0_rk/48.0_rk
      call model%set_mesh(mesh, rock, error)
      conditions = loaded_everywhere(model%mesh)
      conditions%condition = face_contact
      call model%prepare(conditions, error)
      loads = no_loads(model%mesh)
      do node = 1, model%mesh%n_nodes
         loads%boundary_displacement(:, node) = bent_crack(rock, 1.0_rk, slope, &
                                                           model%mesh%xy(:, node), .true.)
      end do
      contact = new_contact(model%mesh)
      call model%solve(loads, displacement, error, contact)
      call checks%no_error(error, "bent crack is solved")
      whole = 0.0_rk
      difference = 0.0_rk
      wrong = 0
      do cell = 1, model%mesh%fracture%n_cells
         do k = 1, 3
            node = model%mesh%face_nodes(k, 1, cell)
            if (node == model%mesh%face_nodes(k, 2, cell)) cycle
            exact = bent_crack(rock, 1.0_rk, slope, model%mesh%xy(:, node), .true.)
            opposite = bent_crack(rock, 1.0_rk, slope, model%mesh%xy(:, node), .false.)
            weight = merge(4.0_rk, 1.0_rk, k == 3)
            whole = whole + weight*(exact(2) - opposite(2))**2
            difference = difference + weight*(contact%jump(2, k, cell) - exact(2) + opposite(2))**2
            place = model%mesh%xy(1, node)
            if (abs(place - bound) < size_h) cycle
            if ((contact%state(k, cell) == state_open) .neqv. place > bound) wrong = wrong + 1
         end do
      end do
      print "(a,f8.4,a,i3)", "bent crack: error of the opening in % (L2)", &
         100.0_rk*sqrt(difference/whole), ", iterations", contact%iterations
      call checks%is_close(sqrt(difference/whole), 0.0_rk, 0.005_rk, "bent crack: opening")
      call checks%is_true(wrong == 0, "bent crack: open where it should be")
      call checks%is_true(contact%iterations <= 10, "bent crack: iterations")
      call checks%is_close(contact%residual, 0.0_rk, 1.0e-9_rk, "bent crack: law fulfilled")
   end subroutine partly_open

   !> The upper half of a body that is cut through rests on the lower one under its weight. With
   !! friction it is at rest; pulled upwards, nothing holds it, and that is said.
   subroutine resting_block()
      real(rk), parameter :: weight = 26000.0_rk
      type(fine_model_t) :: model
      type(fine_boundary_t) :: boundary
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: conditions
      type(contact_t) :: contact
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: carried
      integer(ik) :: cell

      mesh = cracked_rectangle([0.0_rk, 3.0_rk], [0.0_rk, 2.0_rk], [6_ik, 4_ik], 2_ik, 1_ik, 6_ik)
      call model%set_mesh(mesh, rock, error)
      boundary = free_boundary(model%mesh)
      call mark_side(model%mesh, 3_ik, 1_ik, boundary%prescribed)
      call mark_side(model%mesh, 3_ik, 2_ik, boundary%prescribed)
      conditions = loaded_everywhere(model%mesh)
      conditions%condition = face_contact
      conditions%law%contact%friction = 0.5_rk
      call model%prepare(conditions, error, boundary)
      call checks%no_error(error, "resting block is set up")
      loads = no_loads(model%mesh)
      loads%body_force = [0.0_rk, -weight]
      contact = new_contact(model%mesh)
      call model%solve(loads, displacement, error, contact)
      call checks%no_error(error, "resting block is solved")
      carried = 0.0_rk
      do cell = 1, model%mesh%fracture%n_cells
         carried = carried - model%mesh%face_length(cell) &
                   *dot_product([1.0_rk, 1.0_rk, 4.0_rk]/6.0_rk, contact%traction(2, :, cell))
      end do
      call checks%is_close(carried/(3.0_rk*weight), 1.0_rk, 1.0e-11_rk, "weight carried")
      call checks%is_close(contact%residual, 0.0_rk, 1.0e-9_rk, "resting block: law fulfilled")

      loads%body_force = [0.0_rk, weight]
      call model%solve(loads, displacement, error, contact)
      call checks%fails_with(error, "only contact holds the part at (", &
                             "a block that is lifted off has a place")
   end subroutine resting_block

end program test_fine_contact
