!> Stress intensity factors of cracks whose faces touch, and of cracks under in-situ stress and
!! weight, against closed solutions (catalogue 1.9, 3.1, 3.6).
program test_fine_tip_contact
   use base_errors, only: error_t
   use base_kinds, only: degree => radians, ik, pi, rk
   use contact_law, only: contact_law_t
   use exact_cracks, only: bent_crack, centre_crack, uniform_field
   use fine_boundary, only: add_side_traction, fine_boundary_t, free_boundary, nearest_node
   use fine_contact, only: contact_t, new_contact
   use fine_elasticity, only: elasticity_t
   use fine_faces, only: face_conditions_t, face_contact, face_law_t, loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_model, only: fine_model_t
   use fine_tip_intensity, only: intensity_of_tip
   use fine_tip_types, only: intensity_t
   use mesh_builder, only: build_mesh, mesh_spec_t, mesher_t
   use mesh_types, only: mesh_t, network_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   real(rk), parameter :: a = 0.05_rk  ! half-length [m]
   type(elasticity_t), parameter :: stiff_rock = elasticity_t(4.0e10_rk, 0.2_rk, 0.0_rk, .false.)
   type(elasticity_t) :: rock = stiff_rock
   logical :: in_situ
   integer(ik) :: i

   do i = 1, 2
      in_situ = i == 2
      ! Catalogue 3.1: pressure, angle of dilation, K_II, K_I.
      call frictional(6.8e6_rk, 0.0_rk, 0.3566994568e6_rk, 0.0_rk)
      call frictional(6.8e6_rk, 1.0_rk, 0.3536132854e6_rk, 0.006172342855e6_rk)
      call sticking()
   end do
   call nearly_incompressible(0.4999_rk)
   call partly_open()
   call given_slip()
   call weight(0.0_rk)
   call weight(0.6_rk)
   ! Catalogue 1.9, wings parallel to the largest compression: friction, l/c, K_I, K_II, slip.
   call winged(0.0_rk, 0.5_rk, 0.2401909095_rk, 0.2627686324_rk, 0.7280774183_rk)
   call winged(0.0_rk, 2.0_rk, 0.1414807077_rk, 0.1751071979_rk, 1.091376128_rk)
   call winged(0.3_rk, 0.2_rk, 0.219349968_rk, 0.2165947589_rk, 0.4326860425_rk)
   call checks%finish()

contains

   !> A window of edge 4a around a crack at an angle; 12 sectors, a/h = 10.
   subroutine window(angle, model)
      real(rk), intent(in) :: angle  !< of the crack with the x axis [rad]
      type(fine_model_t), intent(inout) :: model
      type(network_t) :: network
      real(rk) :: ends(2, 2)

      ends(:, 2) = a*[cos(angle), sin(angle)]
      ends(:, 1) = -ends(:, 2)
      network = network_t(first=[1_ik, 3_ik], xy=ends, s_start=[0.0_rk])
      call set_model(network, 2.0_rk*a, a/10.0_rk, 0.4_rk*a, .true., model)
   end subroutine window

   !> A square with the given network.
   subroutine set_model(network, half_width, size_fracture, size_boundary, is_window, model)
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: half_width, size_fracture, size_boundary  !< [m]
      logical, intent(in) :: is_window
      type(fine_model_t), intent(inout) :: model
      type(mesh_spec_t) :: spec
      type(mesher_t) :: mesher
      type(mesh_t) :: mesh
      type(error_t), allocatable :: error

      spec%x_min = -half_width
      spec%x_max = half_width
      spec%y_min = -half_width
      spec%y_max = half_width
      spec%size_fracture = size_fracture
      spec%size_boundary = size_boundary
      spec%is_window = is_window
      spec%rosette_sectors = 12
      spec%rosette_radius = size_fracture
      call build_mesh(spec, network, mesher, mesh, error)
      call checks%no_error(error, "body is meshed")
      call model%set_mesh(mesh, rock, error)
      call checks%no_error(error, "body is numbered")
   end subroutine set_model

   !> Uniform remote stress, on the edges or in situ, and the edge displacements of a crack that
   !! takes `normal` and `shear` off its line.
   subroutine set_loads(model, angle, remote, normal, shear, loads)
      type(fine_model_t), intent(in) :: model
      real(rk), intent(in) :: angle, remote(3), normal, shear
      type(fine_loads_t), intent(out) :: loads
      real(rk) :: rotation(2, 2), crack(2)
      integer(ik) :: node

      loads = no_loads(model%mesh)
      rotation = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])
      do node = 1, model%mesh%n_nodes
         associate (xy => model%mesh%xy(:, node))
            crack = matmul(rotation, centre_crack(rock, a, normal, shear, &
                                                  matmul(transpose(rotation), xy), .true.))
            if (.not. in_situ) crack = crack + uniform_field(rock, remote, xy)
            loads%boundary_displacement(:, node) = crack
         end associate
      end do
      if (in_situ) loads%initial_stress = spread(remote, 2, model%mesh%n_vertices)
   end subroutine set_loads

   !> Compare both tips; their intensities over the scale are the same by symmetry.
   subroutine compare(name, model, loads, displacement, k1, k2, scale, tolerance_1, tolerance_2)
      character(len=*), intent(in) :: name
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :), k1, k2, scale
      real(rk), intent(in) :: tolerance_1, tolerance_2
      type(intensity_t) :: intensity
      type(error_t), allocatable :: error
      integer(ik) :: tip

      do tip = 1, 2
         call intensity_of_tip(model, loads, displacement, tip, intensity, error)
         call checks%no_error(error, name//" has intensities")
         print "(a,t24,i5,a,i2,2(a,2f9.4),a,f9.4)", name, model%mesh%n_cells, " cells, tip", tip, &
            ", errors in %:", 100.0_rk*(intensity%k1 - k1)/scale, &
            100.0_rk*(intensity%k2 - k2)/scale, "  estimates", &
            100.0_rk*intensity%k1_error/scale, 100.0_rk*intensity%k2_error/scale, "  G", &
            100.0_rk*(intensity%g_domain*rock%crack_modulus() - k1**2 - k2**2)/scale**2
         call checks%is_close(intensity%k1/scale, k1/scale, tolerance_1, name//": K_I")
         call checks%is_close(intensity%k2/scale, k2/scale, tolerance_2, name//": K_II")
         call checks%is_close(intensity%g_domain*rock%crack_modulus()/scale**2, &
                              (k1**2 + k2**2)/scale**2, &
                              2.0_rk*max(tolerance_1, tolerance_2), name//": G")
      end do
   end subroutine compare

   !> Compression of 20 and 10 MPa, crack at 45 degrees, friction 0.5: what it solves for.
   subroutine solve_frictional(pressure, dilation, drop, model, loads, displacement, contact)
      real(rk), intent(in) :: pressure, dilation
      real(rk), intent(out) :: drop  !< of the shear traction [Pa]
      type(fine_model_t), intent(inout) :: model
      type(fine_loads_t), intent(out) :: loads
      real(rk), allocatable, intent(out) :: displacement(:, :)
      type(contact_t), intent(out) :: contact
      real(rk), parameter :: angle = 45.0_rk*degree, remote(3) = [-20.0e6_rk, -10.0e6_rk, 0.0_rk]
      real(rk), parameter :: normal = -15.0e6_rk, shear = 5.0e6_rk, friction = 0.5_rk
      type(face_conditions_t) :: conditions
      type(error_t), allocatable :: error

      drop = (shear - friction*(-normal - pressure))/(1.0_rk + friction*dilation)
      call window(angle, model)
      call set_loads(model, angle, remote, dilation*drop, drop, loads)
      loads%fluid_pressure = pressure
      conditions = loaded_everywhere(model%mesh)
      conditions%condition = face_contact
      conditions%law = face_law_t(contact_law_t(friction, dilation))
      call model%prepare(conditions, error)
      call checks%no_error(error, "frictional crack is set up")
      contact = new_contact(model%mesh)
      call model%solve(loads, displacement, error, contact)
      call checks%no_error(error, "frictional crack is solved")
   end subroutine solve_frictional

   !> Rock that hardly changes its volume: normal tractions between the faces are off, and so is
   !! friction. K_II is as far off as it says at most; and it says no more than the largest
   !! deviation on all the faces makes if it acts as far as four radii from the tip: mu df
   !! sqrt(2/pi) times the integral of r**(-1/2).
   subroutine nearly_incompressible(poisson)
      real(rk), intent(in) :: poisson
      real(rk), parameter :: pressure = 6.8e6_rk, k2 = 0.3566994568e6_rk  ! catalogue 3.1
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(contact_t) :: contact
      type(intensity_t) :: intensity
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: drop, most
      integer(ik) :: tip

      rock%poisson = poisson
      call solve_frictional(pressure, 0.0_rk, drop, model, loads, displacement, contact)
      associate (normal => contact%traction(2, :, :))  ! none where a cell ends at a tip
         most = maxval(abs(normal + 15.0e6_rk - pressure), mask=abs(normal) > 0.0_rk)
      end associate
      most = 0.5_rk*most*sqrt(2.0_rk/pi)*2.0_rk*sqrt(4.0_rk*a/10.0_rk)
      do tip = 1, 2
         call intensity_of_tip(model, loads, displacement, tip, intensity, error)
         call checks%no_error(error, "nearly incompressible: intensities")
         print "(a,3f9.4)", "nearly incompressible, error of K_II, estimate, bound in %:", &
            100.0_rk*[abs(intensity%k2 - k2), intensity%k2_error, most]/k2
         call checks%is_true(abs(intensity%k2 - k2) <= intensity%k2_error, "doubt is enough")
         call checks%is_true(intensity%k2_error <= most, "doubt is not too much")
      end do
      rock = stiff_rock
   end subroutine nearly_incompressible

   !> Catalogue 3.1, on windows with and without stress in situ.
   subroutine frictional(pressure, dilation_degrees, k2, k1)
      real(rk), intent(in) :: pressure, dilation_degrees, k2, k1
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(contact_t) :: contact
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: dilation, drop, difference, whole, exact, weight_of
      integer(ik) :: cell, k

      dilation = tan(dilation_degrees*degree)
      call solve_frictional(pressure, dilation, drop, model, loads, displacement, contact)
      call checks%is_true(contact%iterations <= 10, "frictional crack: iterations")
      ! K_I of closed faces follows from the law to round-off, whatever K_II is.
      call compare("friction", model, loads, displacement, k1, k2, k2, &
                   1.0e-6_rk + 2.0e-3_rk*dilation, 2.0e-3_rk)
      difference = 0.0_rk
      whole = 0.0_rk
      do cell = 1, model%mesh%fracture%n_cells
         do k = 1, 3
            weight_of = model%mesh%face_length(cell)*merge(4.0_rk, 1.0_rk, k == 3)
            exact = 4.0_rk*drop/rock%crack_modulus() &
                    *sqrt(max(0.0_rk, a**2 - (model%mesh%face_s(k, cell) - a)**2))
            difference = difference + weight_of*(contact%jump(1, k, cell) - exact)**2
            whole = whole + weight_of*exact**2
         end do
      end do
      call checks%is_close(sqrt(difference/whole), 0.0_rk, 2.0e-3_rk, "frictional crack: slip")
   end subroutine frictional

   !> Below the limit of friction nothing slips, and no intensity arises.
   subroutine sticking()
      real(rk), parameter :: angle = 45.0_rk*degree, remote(3) = [-20.0e6_rk, -10.0e6_rk, 0.0_rk]
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: conditions
      type(contact_t) :: contact
      real(rk), allocatable :: displacement(:, :)

      call window(angle, model)
      call set_loads(model, angle, remote, 0.0_rk, 0.0_rk, loads)
      conditions = loaded_everywhere(model%mesh)
      conditions%condition = face_contact
      conditions%law = face_law_t(contact_law_t(0.4_rk))
      call model%prepare(conditions, error)
      contact = new_contact(model%mesh)
      call model%solve(loads, displacement, error, contact)
      call checks%no_error(error, "sticking crack is solved")
      call checks%is_close(maxval(abs(contact%jump))*rock%young/(5.0e6_rk*a), 0.0_rk, 1.0e-12_rk, &
                           "sticking crack: no slip")
      call compare("stick", model, loads, displacement, 0.0_rk, 0.0_rk, 5.0e6_rk*sqrt(pi*a), &
                   1.0e-9_rk, 1.0e-9_rk)
   end subroutine sticking

   !> A bent body: the crack is open from -a/3 to a.
   subroutine partly_open()
      real(rk), parameter :: slope = 1.0e8_rk, half_open = 2.0_rk*a/3.0_rk
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: conditions
      type(contact_t) :: contact
      type(intensity_t) :: intensity
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: exact
      integer(ik) :: node

      call window(0.0_rk, model)
      loads = no_loads(model%mesh)
      do node = 1, model%mesh%n_nodes
         loads%boundary_displacement(:, node) = bent_crack(rock, a, slope, model%mesh%xy(:, node), &
                                                           .true.)
      end do
      conditions = loaded_everywhere(model%mesh)
      conditions%condition = face_contact
      call model%prepare(conditions, error)
      contact = new_contact(model%mesh)
      call model%solve(loads, displacement, error, contact)
      call checks%no_error(error, "bent crack is solved")
      call checks%is_true(contact%iterations <= 10, "bent crack: iterations")
      exact = slope*half_open*sqrt(pi*half_open)
      call intensity_of_tip(model, loads, displacement, 1_ik, intensity, error)
      call checks%no_error(error, "closed end has intensities")
      call checks%is_true(intensity%closed, "bent crack: left end is closed")
      call checks%is_close(intensity%k1/exact, 0.0_rk, 1.0e-9_rk, "bent crack: closed end")
      call intensity_of_tip(model, loads, displacement, 2_ik, intensity, error)
      print "(a,2f9.4,a,i3)", "bent crack: errors of K_I, K_II in %", &
         100.0_rk*(intensity%k1/exact - 1.0_rk), 100.0_rk*intensity%k2/exact, ", iterations", &
         contact%iterations
      call checks%is_true(.not. intensity%closed, "bent crack: right end is open")
      call checks%is_close(intensity%k1/exact, 1.0_rk, 3.0e-3_rk, "bent crack: K_I of the open end")
      call checks%is_close(intensity%k2/exact, 0.0_rk, 3.0e-3_rk, "bent crack: K_II")
   end subroutine partly_open

   !> Catalogue 3.6: slip u0 sqrt(1 - (x/a)**2) on closed faces gives K_II = E' u0 sqrt(pi a)/(4 a).
   subroutine given_slip()
      real(rk), parameter :: angle = -0.2_rk, largest = 1.0e-5_rk
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: conditions
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: stress, place
      integer(ik) :: cell, k

      in_situ = .false.
      stress = rock%crack_modulus()*largest/(4.0_rk*a)
      call window(angle, model)
      call set_loads(model, angle, [0.0_rk, 0.0_rk, 0.0_rk], 0.0_rk, stress, loads)
      conditions = loaded_everywhere(model%mesh)
      conditions%condition = face_contact
      conditions%law = face_law_t(contact_law_t(bilateral=.true.), slip_given=.true.)
      call model%prepare(conditions, error)
      do cell = 1, model%mesh%fracture%n_cells
         do k = 1, 3
            place = model%mesh%face_s(k, cell)/a - 1.0_rk
            loads%jump(1, k, cell) = largest*sqrt(max(0.0_rk, 1.0_rk - place**2))
         end do
      end do
      call model%solve(loads, displacement, error)
      call checks%no_error(error, "given slip is solved")
      call compare("given slip", model, loads, displacement, 0.0_rk, stress*sqrt(pi*a), &
                   stress*sqrt(pi*a), 1.0e-9_rk, 3.0e-3_rk)
   end subroutine given_slip

   !> In-situ stress s_yy = gamma*y in balance with the weight, and a free crack at an angle: its
   !! line carries linear tractions gamma*s*sin(angle)*cos(angle)*(cos, sin)(angle), which leave
   !! K = +-traction slope*a*sqrt(pi a)/2 at the ends.
   subroutine weight(angle)
      real(rk), intent(in) :: angle
      real(rk), parameter :: gamma = 26000.0_rk
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(intensity_t) :: intensity
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: slopes(2), scale, side, rotation(2, 2), place(2)
      complex(rk) :: z, root, factor, value
      integer(ik) :: node, tip

      call window(angle, model)
      call model%prepare(loaded_everywhere(model%mesh), error)
      loads = no_loads(model%mesh)
      loads%body_force = [0.0_rk, -gamma]
      loads%initial_stress(2, :) = gamma*model%mesh%xy(2, :model%mesh%n_vertices)
      slopes = gamma*sin(angle)*cos(angle)*[cos(angle), sin(angle)]  ! s_nn, s_tn
      rotation = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])
      factor = 0.25_rk*cmplx(slopes(1), -slopes(2), rk)
      do node = 1, model%mesh%n_nodes
         if (.not. model%mesh%on_boundary(node)) cycle
         place = matmul(transpose(rotation), model%mesh%xy(:, node))
         z = cmplx(place(1), place(2), rk)
         root = sqrt(z - a)*sqrt(z + a)
         value = rock%kolosov()*factor*(z*root - z**2) - factor*conjg(z*root - z**2) &
                 - (z - conjg(z))*conjg(2.0_rk*factor*((z**2 - 0.5_rk*a**2)/root - z))
         value = value/(2.0_rk*rock%shear_modulus())
         loads%boundary_displacement(:, node) = matmul(rotation, [real(value, rk), aimag(value)])
      end do
      call model%solve(loads, displacement, error)
      call checks%no_error(error, "weight is solved")
      scale = 0.5_rk*gamma*a*sqrt(pi*a)
      do tip = 1, 2
         call intensity_of_tip(model, loads, displacement, tip, intensity, error)
         side = merge(-1.0_rk, 1.0_rk, model%mesh%fracture%tip_end(tip) == 1)/gamma
         print "(a,2f9.4)", "weight: errors of K_I, K_II in %", &
            100.0_rk*(intensity%k1/scale - side*slopes(1)), &
            100.0_rk*(intensity%k2/scale - side*slopes(2))
         call checks%is_close(intensity%k1/scale, side*slopes(1), 1.0e-3_rk, "weight: K_I")
         call checks%is_close(intensity%k2/scale, side*slopes(2), 1.0e-3_rk, "weight: K_II")
         call checks%is_close(intensity%g_domain*rock%crack_modulus()/scale**2, &
                              sum(slopes**2)/gamma**2, 1.0e-3_rk, "weight: G")
      end do
   end subroutine weight

   !> Catalogue 1.9: a closed main crack of half-length c at 45 degrees to the compression S1 in x,
   !! and free wings along x. The catalogue keeps the main crack closed, under tension too. The
   !! body is 200 c wide and loaded by tractions.
   subroutine winged(friction, wing, k1, k2, slip)
      real(rk), intent(in) :: friction, wing  !< l/c
      real(rk), intent(in) :: k1, k2  !< over S1*sqrt(pi c)
      real(rk), intent(in) :: slip  !< at the centre, times E'/(4 S1 c)
      real(rk), parameter :: c = 1.0_rk, stress = 1.0e6_rk, half_width = 100.0_rk*c
      type(network_t) :: network
      type(fine_model_t) :: model
      type(fine_boundary_t) :: boundary
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: conditions
      type(contact_t) :: contact
      type(intensity_t) :: intensity
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: kink(2), vertices(2, 4), centre
      integer(ik) :: tip

      kink = c*sqrt(0.5_rk)
      vertices(:, 1) = -kink - [wing*c, 0.0_rk]
      vertices(:, 2) = -kink
      vertices(:, 3:4) = -vertices(:, [2, 1])
      network = network_t(first=[1_ik, 5_ik], xy=vertices, s_start=[0.0_rk])
      call set_model(network, half_width, 0.05_rk*c, 15.0_rk*c, .false., model)
      boundary = free_boundary(model%mesh)
      boundary%prescribed(:, nearest_node(model%mesh, [-half_width, -half_width])) = .true.
      boundary%prescribed(2, nearest_node(model%mesh, [half_width, -half_width])) = .true.
      loads = no_loads(model%mesh)
      call add_side_traction(model%mesh, 1_ik, [stress, 0.0_rk], loads%force)
      call add_side_traction(model%mesh, 2_ik, [-stress, 0.0_rk], loads%force)
      conditions = loaded_everywhere(model%mesh)
      where (abs(model%mesh%face_tangent(2, :)) > 0.1_rk)
         conditions%condition = face_contact
      end where
      conditions%law = face_law_t(contact_law_t(friction, bilateral=.true.))
      call model%prepare(conditions, error, boundary)
      call checks%no_error(error, "winged crack is set up")
      contact = new_contact(model%mesh)
      call model%solve(loads, displacement, error, contact)
      call checks%no_error(error, "winged crack is solved")
      call checks%is_true(contact%iterations <= 10, "winged crack: iterations")
      do tip = 1, 2
         call intensity_of_tip(model, loads, displacement, tip, intensity, error)
         associate (scale => stress*sqrt(pi*c))
            print "(a,i6,a,i3,a,f9.4,a,f9.5)", "winged crack", model%mesh%n_cells, " cells, ", &
               contact%iterations, " iterations, error of K_I in %", &
               100.0_rk*(intensity%k1/scale/k1 - 1.0_rk), ", of K_II", &
               abs(intensity%k2)/scale - k2
            call checks%is_close(intensity%k1/scale/k1, 1.0_rk, 5.0e-3_rk, "winged crack: K_I")
            call checks%is_close(abs(intensity%k2)/scale, k2, 2.0e-3_rk, "winged crack: K_II")
         end associate
      end do
      centre = maxval(abs(contact%jump(1, :, :)))*rock%crack_modulus()/(4.0_rk*stress*c)
      call checks%is_close(centre/slip, 1.0_rk, 5.0e-3_rk, "winged crack: slip")
   end subroutine winged

end program test_fine_tip_contact
