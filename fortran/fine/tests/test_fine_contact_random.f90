!> Contact on random networks of fractures under random loads that follow each other: no solution
!! may fail, and each fulfils the law of contact, written out here again, to 1e-8 of the largest
!! traction. Friction from none to 2, with dilation and without, T and X joints, kinks, fractures
!! that end on the boundary.
program test_fine_contact_random
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use contact_law, only: contact_law_t, state_open, state_stick
   use fine_boundary, only: add_side_traction, fine_boundary_t, free_boundary, nearest_node
   use fine_contact, only: contact_t, new_contact
   use fine_elasticity, only: elasticity_t
   use fine_faces, only: face_conditions_t, face_contact, face_law_t, loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_model, only: fine_model_t
   use mesh_builder, only: build_mesh, mesh_spec_t, mesher_t
   use mesh_types, only: mesh_t, network_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   integer(ik), parameter :: n_bodies = 6, n_loads = 6, n_laws = 6
   integer(ik), parameter :: left = 1, right = 2, bottom = 3, top = 4
   real(rk), parameter :: half = 3.0_rk  !< of the square body [m]
   real(rk), parameter :: size_fracture = 0.15_rk  !< [m]
   real(rk), parameter :: clearance = 0.3_rk  !< between fractures that do not meet [m]
   type(contact_law_t), parameter :: laws(n_laws) = &
                                     [contact_law_t(0.0_rk), contact_law_t(0.3_rk), &
                                      contact_law_t(0.6_rk, 0.1_rk), contact_law_t(1.0_rk), &
                                      contact_law_t(1.5_rk, 0.3_rk), contact_law_t(2.0_rk)]
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(fine_model_t) :: model
   integer(ik) :: seen(0:2) = 0, n_solved = 0, n_failed = 0, n_iterations = 0, n_most = 0
   integer(ik) :: n_restarted = 0, n_pairs_most = 0
   real(rk) :: worst = 0.0_rk
   integer(ik) :: body, law

   call fix_seed()
   do body = 1, n_bodies
      call set_body()
      do law = 1, n_laws
         call load_body(laws(law))
      end do
   end do
   print "(i0,a,i0,a,f5.1,a,i0,a,i0,a,es8.1)", n_solved, " solved, ", n_failed, &
      " failed, iterations ", real(n_iterations, rk)/n_solved, ", most ", n_most, &
      ", restarted ", n_restarted, ", departure ", worst
   print "(a,i0,a,3(1x,i0))", "at most ", n_pairs_most, " pairs; stick, slip, open:", seen
   call checks%is_true(n_solved == n_bodies*n_laws*n_loads, "all were tried")
   call checks%is_true(n_failed == 0, "none failed")
   call checks%is_close(worst, 0.0_rk, 1.0e-8_rk, "the law is fulfilled")
   call checks%is_true(all(seen > 0), "every state occurs")
   call checks%finish()

contains

   !> The same numbers in every run.
   subroutine fix_seed()
      integer, allocatable :: seed(:)
      integer :: i, n

      call random_seed(size=n)
      seed = [(7919 + 104729*i, i=1, n)]
      call random_seed(put=seed)
   end subroutine fix_seed

   real(rk) function between(low, high)
      real(rk), intent(in) :: low, high
      real(rk) :: number

      call random_number(number)
      between = low + number*(high - low)
   end function between

   !> A body with three to six fractures: some with a kink, some that end on or cross another, some
   !! that end on the boundary.
   subroutine set_body()
      integer(ik), parameter :: tries = 400
      type(network_t) :: network
      type(mesh_spec_t) :: spec
      type(mesher_t) :: mesher
      type(mesh_t) :: mesh
      real(rk) :: line(2, 3), angle
      integer(ik) :: k, n_points

      network%first = [1_ik]
      allocate (network%xy(2, 0), network%s_start(0))
      do k = 1, tries
         if (size(network%s_start) == 6) exit
         n_points = merge(3, 2, between(0.0_rk, 1.0_rk) < 0.3_rk)
         line(:, 1) = [between(-2.3_rk, 2.3_rk), between(-2.3_rk, 2.3_rk)]
         if (mod(k, 9_ik) == 0) line(:, 1) = [-half, between(-2.0_rk, 2.0_rk)]
         if (mod(k, 3_ik) == 1 .and. size(network%xy, 2) > 1) then  ! on the first fracture
            line(:, 1) = network%xy(:, 1) + between(0.3_rk, 0.7_rk) &
                         *(network%xy(:, 2) - network%xy(:, 1))
         end if
         angle = between(-1.5_rk, 1.5_rk)
         if (line(1, 1) > 0.0_rk) angle = angle + pi
         line(:, 2) = line(:, 1) + between(0.9_rk, 2.6_rk)*[cos(angle), sin(angle)]
         angle = angle + sign(between(0.2_rk, 1.0_rk), between(-1.0_rk, 1.0_rk))
         line(:, 3) = line(:, 2) + between(0.6_rk, 1.5_rk)*[cos(angle), sin(angle)]
         if (maxval(abs(line(:, 2:n_points))) > half - clearance) cycle
         if (.not. fits(line(:, :n_points), network)) cycle
         network%xy = reshape([network%xy, line(:, :n_points)], &
                              [2, size(network%xy, 2) + int(n_points)])
         network%first = [network%first, int(size(network%xy, 2), ik) + 1_ik]
         network%s_start = [network%s_start, 0.0_rk]
      end do
      call checks%is_true(size(network%s_start) >= 3, "the body has fractures")
      spec%x_min = -half
      spec%x_max = half
      spec%y_min = -half
      spec%y_max = half
      spec%size_fracture = size_fracture
      spec%size_boundary = 1.0_rk
      spec%rosette_sectors = 8
      spec%rosette_radius = size_fracture
      call build_mesh(spec, network, mesher, mesh, error)
      call checks%no_error(error, "the body is meshed")
      if (allocated(error)) return
      call model%set_mesh(mesh, elasticity_t(70.0e9_rk, 0.21_rk, 0.0_rk, .false.), error)
      call checks%no_error(error, "the body is numbered")
   end subroutine set_body

   !> A line keeps clear of the others, or meets them at a large angle and away from ends: one at
   !! most, the boundary counted, so that no piece is cut out of the body.
   logical function fits(line, network)
      real(rk), intent(in) :: line(:, :)
      type(network_t), intent(in) :: network
      integer(ik) :: f, i, k, n_met

      fits = .false.
      n_met = merge(1, 0, abs(line(1, 1) + half) < 1.0e-9_rk)
      do f = 1, size(network%s_start, kind=ik)
         do k = network%first(f), network%first(f + 1) - 2
            do i = 1, size(line, 2) - 1
               if (.not. pair_fits(line(:, i:i + 1), network%xy(:, k:k + 1), n_met)) return
            end do
         end do
         if (n_met > 1) return
      end do
      fits = .true.
   end function fits

   !> Two pieces are apart, or cross, or the first starts on the second.
   logical function pair_fits(a, b, n_met)
      real(rk), intent(in) :: a(2, 2), b(2, 2)  !< (x y, start end) [m]
      integer(ik), intent(inout) :: n_met
      real(rk) :: along_a(2), along_b(2), apart(2), s, t, cross

      along_a = a(:, 2) - a(:, 1)
      along_b = b(:, 2) - b(:, 1)
      apart = b(:, 1) - a(:, 1)
      cross = along_a(1)*along_b(2) - along_a(2)*along_b(1)
      s = (apart(1)*along_b(2) - apart(2)*along_b(1))/cross*norm2(along_a)
      t = (apart(1)*along_a(2) - apart(2)*along_a(1))/cross*norm2(along_b)
      pair_fits = .false.
      if (abs(cross) < 0.5_rk*norm2(along_a)*norm2(along_b)) then
         pair_fits = min(distance(a(:, 1), b), distance(a(:, 2), b), distance(b(:, 1), a), &
                         distance(b(:, 2), a)) > clearance
      else if (t > clearance .and. t < norm2(along_b) - clearance .and. &
               ((s > clearance .and. s < norm2(along_a) - clearance) .or. &
                abs(s) < 1.0e-12_rk)) then
         pair_fits = .true.
         n_met = n_met + 1
      else
         pair_fits = min(distance(a(:, 1), b), distance(a(:, 2), b), distance(b(:, 1), a), &
                         distance(b(:, 2), a)) > clearance &
                     .and. .not. (s >= 0.0_rk .and. s <= norm2(along_a) .and. t >= 0.0_rk &
                                  .and. t <= norm2(along_b))
      end if
   end function pair_fits

   !> From a point to a piece [m].
   pure real(rk) function distance(point, piece)
      real(rk), intent(in) :: point(2), piece(2, 2)
      real(rk) :: along(2), share

      along = piece(:, 2) - piece(:, 1)
      share = dot_product(point - piece(:, 1), along)/dot_product(along, along)
      share = min(1.0_rk, max(0.0_rk, share))
      distance = norm2(point - piece(:, 1) - share*along)
   end function distance

   !> Loads of random stresses, one after the other.
   subroutine load_body(law)
      type(contact_law_t), intent(in) :: law
      type(fine_loads_t) :: loads
      type(fine_boundary_t) :: boundary
      type(face_conditions_t) :: conditions
      type(contact_t) :: contact
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: stress(3)
      integer(ik) :: state, step

      conditions = loaded_everywhere(model%mesh)
      conditions%condition = face_contact
      conditions%law = face_law_t(law)
      boundary = free_boundary(model%mesh)
      boundary%prescribed(:, nearest_node(model%mesh, [-half, -half])) = .true.
      boundary%prescribed(2, nearest_node(model%mesh, [half, -half])) = .true.
      call model%prepare(conditions, error, boundary)
      call checks%no_error(error, "the body is set up")
      if (allocated(error)) return
      n_pairs_most = max(n_pairs_most, model%contact_problem%n)
      contact = new_contact(model%mesh)
      do step = 1, n_loads
         stress = 1.0e7_rk*[between(-1.0_rk, 0.5_rk), between(-1.0_rk, 0.5_rk), &
                            between(-1.0_rk, 1.0_rk)]
         loads = no_loads(model%mesh)
         call add_side_traction(model%mesh, left, -stress([1, 3]), loads%force)
         call add_side_traction(model%mesh, right, stress([1, 3]), loads%force)
         call add_side_traction(model%mesh, bottom, -stress([3, 2]), loads%force)
         call add_side_traction(model%mesh, top, stress([3, 2]), loads%force)
         if (mod(step, 3_ik) == 0) loads%fluid_pressure = between(0.0_rk, 1.0e7_rk)
         n_solved = n_solved + 1
         call model%solve(loads, displacement, error, contact)
         if (allocated(error)) then
            n_failed = n_failed + 1
            cycle
         end if
         n_iterations = n_iterations + contact%iterations
         n_most = max(n_most, contact%iterations)
         if (contact%was_restarted) n_restarted = n_restarted + 1
         worst = max(worst, departure(law, maxval(abs(stress)), loads, displacement, &
                                      contact))
         do state = state_stick, state_open
            seen(state) = seen(state) + count(contact%state == state)
         end do
         call contact%accept()
      end do
   end subroutine load_body

   !> The largest violation of the law at the middle of any cell, over the largest traction on the
   !! faces as they are or as if they were none; jumps from the displacements, tractions from the
   !! elements on side +.
   real(rk) function departure(law, remote, loads, displacement, contact)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: remote  !< largest stress without the fractures [Pa]
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)
      type(contact_t), intent(in) :: contact
      real(rk), parameter :: share = 2.0_rk/3.0_rk  ! of a middle node, with quarter points or not
      real(rk), parameter :: stiffness = 70.0e9_rk/size_fracture
      real(rk) :: jump(2), tau(2), normal(2), force(2, 6), traction(2), largest
      real(rk) :: opening, pressure, shear, slip, bound
      integer(ik) :: cell, k

      departure = 0.0_rk
      largest = remote
      do cell = 1, model%mesh%fracture%n_cells
         tau = model%mesh%face_tangent(:, cell)
         normal = [-tau(2), tau(1)]
         associate (middle => model%mesh%face_nodes(3, :, cell), &
                    element => model%mesh%face_cells(1, cell))
            jump = displacement(:, middle(2)) - displacement(:, middle(1))
            k = findloc(model%mesh%cell_nodes(:, element), middle(1), dim=1)
            force = model%element_forces(displacement, element)
            traction = force(:, k)/(share*model%mesh%face_length(cell)) &
                       + loads%fluid_pressure(cell)*normal
         end associate
         pressure = -dot_product(normal, traction)
         shear = dot_product(tau, traction)
         opening = stiffness*(dot_product(normal, jump) - law%dilation*abs(dot_product(tau, jump)))
         slip = stiffness*(dot_product(tau, jump) - contact%slip_before(3, cell))
         bound = law%friction*max(pressure, 0.0_rk)
         largest = max(largest, norm2(traction))
         departure = max(departure, -opening, -pressure, min(abs(opening), abs(pressure)), &
                         abs(shear) - bound, min(abs(slip), abs(shear - sign(bound, slip))))
      end do
      if (.not. sum(abs(displacement)) <= huge(1.0_rk)) departure = huge(1.0_rk)
      departure = departure/largest
   end function departure

end program test_fine_contact_random
