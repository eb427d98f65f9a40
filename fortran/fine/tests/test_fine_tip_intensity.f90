!> Stress intensity factors of a straight crack in a window whose edges carry the displacement of
!! the exact solution for the infinite plane (catalogue 1.1, 3.1, 3.3, 3.6).
program test_fine_tip_intensity
   use base_errors, only: error_t
   use base_kinds, only: degree => radians, ik, pi, rk
   use exact_cracks, only: centre_crack, uniform_field
   use fine_elasticity, only: elasticity_t
   use fine_faces, only: face_conditions_t, face_jump, face_slip, loaded_everywhere
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
   real(rk), parameter :: half_length = 0.05_rk  ! a [m]
   type(elasticity_t), parameter :: rock = elasticity_t(4.0e10_rk, 0.2_rk, 1.0_rk, .false.)
   integer(ik) :: i
   character(len=32) :: name

   do i = 0, 3
      write (name, "(a,i0,a)") "tension at ", 15*i + 15*min(i, 1), " degrees"
      call free_crack(trim(name), (15*i + 15*min(i, 1))*degree, [0.0_rk, 1.0e6_rk, 0.0_rk], .false.)
   end do
   call free_crack("plane stress", 30.0_rk*degree, [0.0_rk, 1.0e6_rk, 0.0_rk], .true.)
   call free_crack("shear", -50.0_rk*degree, [0.2e6_rk, 0.0_rk, 1.0e6_rk], .false.)
   call pressurized()
   call frictional(0.0_rk, 0.3566994568e6_rk, 0.0_rk, 6.8e6_rk, 0.5_rk)
   call frictional(1.0_rk, 0.3536132854e6_rk, 0.006172342855e6_rk, 6.8e6_rk, 0.5_rk)
   call frictional(5.0_rk, 1.32902715e6_rk, 0.1162748091e6_rk, 12.0e6_rk, 0.5_rk)
   call given_jump()
   call uniform_pressure()
   call linear_pressure(.true.)
   call linear_pressure(.false.)
   call refusals()
   call checks%finish()

contains

   !> A window of edge 4a around a crack at an angle; 12 sectors, a/h = 10.
   subroutine window(angle, elasticity, model)
      real(rk), intent(in) :: angle  !< of the crack with the x axis [rad]
      type(elasticity_t), intent(in) :: elasticity
      type(fine_model_t), intent(inout) :: model
      type(network_t) :: network
      type(mesher_t) :: mesher
      type(mesh_t) :: mesh
      type(error_t), allocatable :: error

      associate (a => half_length, h => half_length/10.0_rk)
         allocate (network%first, source=[1_ik, 3_ik])
         allocate (network%xy, source=reshape(a*[-cos(angle), -sin(angle), cos(angle), &
                                                 sin(angle)], [2, 2]))
         allocate (network%s_start(1), source=0.0_rk)
         call build_mesh(mesh_spec_t(-2.0_rk*a, 2.0_rk*a, -2.0_rk*a, 2.0_rk*a, h, 4.0_rk*h, &
                                     .true., 12_ik, h), &
                         network, mesher, mesh, error)
      end associate
      call checks%no_error(error, "window is meshed")
      call model%set_mesh(mesh, elasticity, error)
      call checks%no_error(error, "window is numbered")
   end subroutine window

   !> Displacements of a uniform remote stress and a crack that takes `normal` and `shear` off its
   !! line. The outer boundary does not touch the crack, so it does not matter which side is meant
   !! on it.
   subroutine set_boundary(model, angle, remote, normal, shear, loads)
      type(fine_model_t), intent(in) :: model
      real(rk), intent(in) :: angle, remote(3), normal, shear
      type(fine_loads_t), intent(inout) :: loads
      real(rk) :: rotation(2, 2), crack(2)
      integer(ik) :: node

      rotation = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])
      do node = 1, model%mesh%n_nodes
         associate (xy => model%mesh%xy(:, node))
            crack = centre_crack(model%elasticity, half_length, normal, shear, &
                                 matmul(transpose(rotation), xy), .true.)
            loads%boundary_displacement(:, node) = uniform_field(model%elasticity, remote, xy) &
                                                   + matmul(rotation, crack)
         end associate
      end do
   end subroutine set_boundary

   !> Solve and compare both tips with the exact values; they are the same at both by symmetry.
   subroutine compare(name, model, conditions, loads, k1, k2, tolerance, tolerance_dc)
      character(len=*), intent(in) :: name
      type(fine_model_t), intent(inout) :: model
      type(face_conditions_t), intent(in) :: conditions
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: k1, k2  !< [Pa m^1/2]
      real(rk), intent(in) :: tolerance, tolerance_dc  !< shares of the total intensity [-]
      type(intensity_t) :: intensity
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: scale
      integer(ik) :: tip

      call model%prepare(conditions, error)
      call checks%no_error(error, name//" is set up")
      call model%solve(loads, displacement, error)
      call checks%no_error(error, name//" is solved")
      scale = hypot(k1, k2)
      do tip = 1, 2
         call intensity_of_tip(model, loads, displacement, tip, intensity, error)
         call checks%no_error(error, name//" has intensities")
         call checks%is_close(intensity%k1/scale, k1/scale, tolerance, name//": K_I")
         call checks%is_close(intensity%k2/scale, k2/scale, tolerance, name//": K_II")
         call checks%is_close(intensity%k1_inner/scale, k1/scale, tolerance, &
                              name//": K_I, inner domain")
         call checks%is_close(intensity%k2_inner/scale, k2/scale, tolerance, &
                              name//": K_II, inner domain")
         call checks%is_close(intensity%k1_dc/scale, k1/scale, tolerance_dc, &
                              name//": K_I, displacements")
         call checks%is_close(intensity%k2_dc/scale, k2/scale, tolerance_dc, &
                              name//": K_II, displacements")
         associate (g => intensity%g_domain*model%elasticity%crack_modulus()/scale**2)
            call checks%is_close(g, 1.0_rk, 2.0_rk*tolerance, name//": energy release rate")
            print "(a,t24,i5,a,i2,5(a,2f8.3))", name, model%mesh%n_cells, " cells, tip", tip, &
               ", errors in %:", &
               100.0_rk*(intensity%k1 - k1)/scale, 100.0_rk*(intensity%k2 - k2)/scale, "  inner", &
               100.0_rk*(intensity%k1_inner - k1)/scale, &
               100.0_rk*(intensity%k2_inner - k2)/scale, "  displacement", &
               100.0_rk*(intensity%k1_dc - k1)/scale, 100.0_rk*(intensity%k2_dc - k2)/scale, &
               "  estimated", 100.0_rk*intensity%k1_error/scale, &
               100.0_rk*intensity%k2_error/scale, "  G", 100.0_rk*(g - 1.0_rk)
         end associate
      end do
   end subroutine compare

   !> Catalogue 1.1: K_I = s_nn sqrt(pi a), K_II = s_nt sqrt(pi a) of the remote stress on the
   !! crack's line.
   subroutine free_crack(name, angle, remote, plane_stress)
      character(len=*), intent(in) :: name
      real(rk), intent(in) :: angle, remote(3)
      logical, intent(in) :: plane_stress
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      real(rk) :: normal, shear
      type(elasticity_t) :: elasticity

      elasticity = rock
      elasticity%plane_stress = plane_stress
      call line_stress(angle, remote, normal, shear)
      call window(angle, elasticity, model)
      loads = no_loads(model%mesh)
      call set_boundary(model, angle, remote, normal, shear, loads)
      call compare(name, model, loaded_everywhere(model%mesh), loads, normal*sqrt(pi*half_length), &
                   shear*sqrt(pi*half_length), 1.0e-3_rk, 0.016_rk)
      call estimates(name, model, loads, normal*sqrt(pi*half_length), shear*sqrt(pi*half_length))
   end subroutine free_crack

   !> The estimated errors bound the true ones, and are below 0.1 % themselves.
   subroutine estimates(name, model, loads, k1, k2)
      character(len=*), intent(in) :: name
      type(fine_model_t), intent(inout) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: k1, k2  !< [Pa m^1/2]
      type(intensity_t) :: intensity
      real(rk), allocatable :: displacement(:, :)
      integer(ik) :: tip

      call model%solve(loads, displacement, error)
      do tip = 1, 2
         call intensity_of_tip(model, loads, displacement, tip, intensity, error)
         call checks%is_true(abs(intensity%k1 - k1) <= intensity%k1_error .and. &
                             abs(intensity%k2 - k2) <= intensity%k2_error, name//": estimates")
        call checks%is_true(max(intensity%k1_error, intensity%k2_error) < 1.0e-3_rk*hypot(k1, k2), &
                             name//": estimates are small")
      end do
   end subroutine estimates

   !> Normal and shear stress on a line at an angle.
   pure subroutine line_stress(angle, stress, normal, shear)
      real(rk), intent(in) :: angle, stress(3)
      real(rk), intent(out) :: normal, shear

      normal = stress(1)*sin(angle)**2 + stress(2)*cos(angle)**2 &
               - 2.0_rk*stress(3)*sin(angle)*cos(angle)
      shear = (stress(2) - stress(1))*sin(angle)*cos(angle) &
              + stress(3)*(cos(angle)**2 - sin(angle)**2)
   end subroutine line_stress

   !> Sneddon's crack: no remote stress, K_I = p sqrt(pi a).
   subroutine pressurized()
      real(rk), parameter :: angle = 0.3_rk, pressure = 1.0e6_rk
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads

      call window(angle, rock, model)
      loads = no_loads(model%mesh)
      call set_boundary(model, angle, [0.0_rk, 0.0_rk, 0.0_rk], pressure, 0.0_rk, loads)
      loads%fluid_pressure = pressure
      call compare("fluid pressure", model, loaded_everywhere(model%mesh), loads, &
                   pressure*sqrt(pi*half_length), 0.0_rk, &
                   1.0e-3_rk, 0.016_rk)
   end subroutine pressurized

   !> Catalogue 3.1, 45 degrees, 20 and 10 MPa: slip with friction and dilation. Stress
   !! intensities as in the catalogue; there the sign of the slip is left open, here the shear
   !! stress on the crack is positive.
   subroutine frictional(dilation_degrees, k2, k1, pressure, friction)
      real(rk), intent(in) :: dilation_degrees, k2, k1, pressure, friction
      real(rk), parameter :: angle = 0.25_rk*pi, remote(3) = [-20.0e6_rk, -10.0e6_rk, 0.0_rk]
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: conditions
      real(rk) :: normal, shear, drop, dilation, contact

      dilation = tan(dilation_degrees*degree)
      call line_stress(angle, remote, normal, shear)
      drop = (shear - friction*(-normal - pressure))/(1.0_rk + friction*dilation)
      contact = -normal - pressure + dilation*drop
      call window(angle, rock, model)
      loads = no_loads(model%mesh)
      call set_boundary(model, angle, remote, dilation*drop, drop, loads)
      conditions = loaded_everywhere(model%mesh)
      conditions%condition = face_slip
      conditions%dilation = dilation
      loads%traction(1, :) = friction*contact
      loads%traction(2, :) = -contact
      loads%fluid_pressure = pressure
      call compare("friction and dilation", model, conditions, loads, k1, k2, 2.0e-3_rk, 0.016_rk)
   end subroutine frictional

   !> Catalogue 3.6: slip u0 sqrt(1 - (x/a)**2) gives K_II = E' u0 sqrt(pi a)/(4 a); here with an
   !! opening of half that size.
   subroutine given_jump()
      real(rk), parameter :: angle = -0.2_rk, largest = 1.0e-5_rk, opening = 0.5_rk
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: conditions
      real(rk) :: stress, place
      integer(ik) :: cell, k

      call window(angle, rock, model)
      stress = rock%crack_modulus()*largest/(4.0_rk*half_length)
      loads = no_loads(model%mesh)
      call set_boundary(model, angle, [0.0_rk, 0.0_rk, 0.0_rk], opening*stress, stress, loads)
      conditions = loaded_everywhere(model%mesh)
      conditions%condition = face_jump
      do cell = 1, model%mesh%fracture%n_cells
         do k = 1, 3
            place = model%mesh%face_s(k, cell)/half_length - 1.0_rk
            loads%jump(:, k, cell) = largest*sqrt(max(0.0_rk, 1.0_rk - place**2))*[1.0_rk, opening]
         end do
      end do
      call compare("given jump", model, conditions, loads, opening*stress*sqrt(pi*half_length), &
                   stress*sqrt(pi*half_length), 3.0e-3_rk, 1.0e-3_rk)
   end subroutine given_jump

   !> The same pressure everywhere, in the pores and on the faces, changes no intensity if Biot's
   !! coefficient is 1.
   subroutine uniform_pressure()
      real(rk), parameter :: angle = 0.5_rk, remote(3) = [-1.0e6_rk, 3.0e6_rk, 1.5e6_rk]
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      real(rk) :: normal, shear

      call window(angle, rock, model)
      call line_stress(angle, remote, normal, shear)
      loads = no_loads(model%mesh)
      call set_boundary(model, angle, remote, normal, shear, loads)
      loads%pore_pressure = 5.0e6_rk
      loads%fluid_pressure = 5.0e6_rk
      call compare("uniform pressure", model, loaded_everywhere(model%mesh), loads, &
                   normal*sqrt(pi*half_length), &
                   shear*sqrt(pi*half_length), 1.5e-3_rk, 0.016_rk)
   end subroutine uniform_pressure

   !> Pore pressure p = g x along the crack, or g y across it. The displacement gradient of the
   !! potential biot g x**3/(6 (lambda + 2 mu)) balances it with s_yy = -c x, c = 2 mu biot
   !! g/(lambda + 2 mu), and no other stress; freeing the faces of it leaves K_I = -c a sqrt(pi
   !! a)/2 at x = a and the opposite at x = -a. Across the crack the only stress is s_xx, and no
   !! intensity arises.
   subroutine linear_pressure(along)
      logical, intent(in) :: along
      real(rk), parameter :: gradient = 1.0e8_rk
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(intensity_t) :: intensity
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: c, modulus, scale, k1
      complex(rk) :: z, root, phi, slope, value
      integer(ik) :: node, tip

      call window(0.0_rk, rock, model)
      call model%prepare(loaded_everywhere(model%mesh), error)
      loads = no_loads(model%mesh)
      modulus = rock%lame_lambda() + 2.0_rk*rock%shear_modulus()
      c = 2.0_rk*rock%shear_modulus()*rock%biot*gradient/modulus
      do node = 1, model%mesh%n_nodes
         if (.not. model%mesh%on_boundary(node)) cycle
         associate (xy => model%mesh%xy(:, node), u => loads%boundary_displacement(:, node))
            if (along) then
               z = cmplx(xy(1), xy(2), rk)
               root = sqrt(z - half_length)*sqrt(z + half_length)
               phi = -0.25_rk*c*(z*root - z**2)
               slope = -0.5_rk*c*((z**2 - 0.5_rk*half_length**2)/root - z)
               value = (rock%kolosov()*phi - conjg(phi) &
                        - (z - conjg(z))*conjg(slope))/(2.0_rk*rock%shear_modulus())
               u = [rock%biot*gradient*xy(1)**2/(2.0_rk*modulus) + real(value, rk), aimag(value)]
            else
               u = [0.0_rk, rock%biot*gradient*xy(2)**2/(2.0_rk*modulus)]
            end if
         end associate
      end do
      ! Half of it in each element, as that of temperatures.
      loads%pore_pressure = 0.5_rk*gradient*model%mesh%xy(merge(1, 2, along), &
                                                          :model%mesh%n_vertices)
      allocate (loads%heat_pressure(3, model%mesh%n_cells))
      do node = 1, model%mesh%n_cells
         loads%heat_pressure(:, node) = loads%pore_pressure(model%mesh%cell_nodes(:3, node))
      end do
      call model%solve(loads, displacement, error)
      call checks%no_error(error, "linear pressure is solved")
      scale = 0.5_rk*c*half_length*sqrt(pi*half_length)
      do tip = 1, 2
         call intensity_of_tip(model, loads, displacement, tip, intensity, error)
         associate (side => model%mesh%fracture%tip_direction(1, tip))
            k1 = merge(-side, 0.0_rk, along)
         end associate
         call checks%is_close(intensity%k1/scale, k1, 2.0e-3_rk, "linear pressure: K_I")
         call checks%is_close(intensity%k2/scale, 0.0_rk, 2.0e-3_rk, "linear pressure: K_II")
         call checks%is_close(intensity%k1_inner/scale, k1, 2.0e-3_rk, &
                              "linear pressure: K_I, inner domain")
         call checks%is_close(intensity%k1_dc/scale, k1, 0.016_rk, &
                              "linear pressure: K_I, displacements")
         print "(a,t24,i5,a,i2,3(a,2f8.3))", "linear pressure", model%mesh%n_cells, &
            " cells, tip", tip, ", errors in %:", &
            100.0_rk*(intensity%k1/scale - k1), 100.0_rk*intensity%k2/scale, "  inner", &
            100.0_rk*(intensity%k1_inner/scale - k1), 100.0_rk*intensity%k2_inner/scale, &
            "  displacement", &
            100.0_rk*(intensity%k1_dc/scale - k1), 100.0_rk*intensity%k2_dc/scale
      end do
   end subroutine linear_pressure

   subroutine refusals()
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(intensity_t) :: intensity
      real(rk), allocatable :: displacement(:, :)

      call window(0.0_rk, rock, model)
      loads = no_loads(model%mesh)
      allocate (displacement(2, model%mesh%n_nodes), source=0.0_rk)
      call intensity_of_tip(model, loads, displacement, 3_ik, intensity, error)
      call checks%fails_with(error, "no tip number 3", "a tip that does not exist")
   end subroutine refusals

end program test_fine_tip_intensity
