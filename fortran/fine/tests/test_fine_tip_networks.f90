!> Stress intensity factors of cracks that see each other or are kinked, in a window so large that
!! its edges may carry the uniform remote strain (catalogue 1.2, 1.8), and of a crossing that is
!! held together.
program test_fine_tip_networks
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use exact_cracks, only: uniform_field
   use fine_elasticity, only: elasticity_t
   use fine_faces, only: face_conditions_t, face_jump, loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_model, only: fine_model_t
   use fine_tip_intensity, only: intensity_of_tip
   use fine_tip_types, only: intensity_t
   use mesh_builder, only: build_mesh, mesh_spec_t, mesher_t
   use mesh_types, only: mesh_t, network_t
   use sample_meshes, only: cracked_rectangle
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(mesher_t) :: mesher
   real(rk), parameter :: tolerance = 0.002_rk  ! half of it is what the window's size leaves
   type(elasticity_t), parameter :: rock = elasticity_t(4.0e10_rk, 0.2_rk, 1.0_rk, .false.)

   call collinear()
   call kinked(30.0_rk, 0.5_rk, [0.0_rk, 1.0e6_rk, 0.0_rk], &
               [0.885564212_rk, 0.4894949268_rk, 1.098351152_rk, -0.02872004775_rk])
   call kinked(30.0_rk, 0.1_rk, [0.0_rk, 1.0e6_rk, 0.0_rk], &
               [0.8595468206_rk, 0.3601425494_rk, 1.02095704_rk, -0.008992354988_rk])
   call kinked(70.5288_rk, 0.3_rk, [0.0_rk, 0.0_rk, 1.0e6_rk], &
               [-1.086233605_rk, -0.05605287735_rk, -0.03944285304_rk, 1.104433988_rk])
   call crossing()
   call kink_behind()
   call checks%finish()

contains

   !> Solve under a remote stress with free faces.
   subroutine solve_free(network, half_width, size, radius, remote, model, loads, displacement)
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: half_width, size, radius, remote(3)
      type(fine_model_t), intent(inout) :: model
      type(fine_loads_t), intent(out) :: loads
      real(rk), allocatable, intent(out) :: displacement(:, :)
      type(mesh_t) :: mesh
      integer(ik) :: node

      call build_mesh(mesh_spec_t(-half_width, half_width, -half_width, half_width, size, &
                                  0.15_rk*half_width, .true., 12_ik, &
                                  radius), network, mesher, mesh, error)
      call checks%no_error(error, "network is meshed")
      call model%set_mesh(mesh, rock, error)
      call checks%no_error(error, "network is numbered")
      call model%prepare(loaded_everywhere(model%mesh), error)
      call checks%no_error(error, "network is set up")
      loads = no_loads(model%mesh)
      do node = 1, model%mesh%n_nodes
         loads%boundary_displacement(:, node) = uniform_field(rock, remote, model%mesh%xy(:, node))
      end do
      call model%solve(loads, displacement, error)
      call checks%no_error(error, "network is solved")
   end subroutine solve_free

   !> Compare the tip nearest to a place.
   subroutine compare(name, model, loads, displacement, place, k1, k2, scale)
      character(len=*), intent(in) :: name
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :), place(2)
      real(rk), intent(in) :: k1, k2  !< in units of scale [-]
      real(rk), intent(in) :: scale  !< [Pa m^1/2]
      type(intensity_t) :: intensity
      integer(ik) :: tip

      associate (tips => model%mesh%xy(:, model%mesh%fracture%tip_node))
         tip = minloc(norm2(tips - spread(place, 2, model%mesh%fracture%n_tips), dim=1), dim=1)
      end associate
      call intensity_of_tip(model, loads, displacement, tip, intensity, error)
      call checks%no_error(error, name)
      call checks%is_close(intensity%k1/scale, k1, tolerance*hypot(k1, k2), name//": K_I")
      call checks%is_close(intensity%k2/scale, k2, tolerance*hypot(k1, k2), name//": K_II")
      call checks%is_close(intensity%k1_dc/scale, k1, 0.016_rk*hypot(k1, k2), &
                           name//": K_I, displacements")
      call checks%is_close(intensity%k2_dc/scale, k2, 0.016_rk*hypot(k1, k2), &
                           name//": K_II, displacements")
      print "(a,t30,i5,a,f7.4,2(a,2f8.3))", name, model%mesh%n_cells, " cells, radius", &
         intensity%radius, &
         ", errors in %:", 100.0_rk*[intensity%k1/scale - k1, intensity%k2/scale - k2]/hypot(k1, &
                                                                                             k2), &
         "  displacement", 100.0_rk*[intensity%k1_dc/scale - k1, &
                                     intensity%k2_dc/scale - k2]/hypot(k1, k2)
   end subroutine compare

   !> Catalogue 1.2: two cracks of length a = 1 with a gap of 2 b = 0.4; tension and shear have the
   !! same factors.
   subroutine collinear()
      type(network_t) :: network
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: scale

      allocate (network%first, source=[1_ik, 3_ik, 5_ik])
      allocate (network%xy, source=reshape([-1.2_rk, 0.0_rk, -0.2_rk, 0.0_rk, 1.2_rk, 0.0_rk, &
                                            0.2_rk, 0.0_rk], [2, 4]))
      allocate (network%s_start(2), source=0.0_rk)
      call solve_free(network, 50.0_rk, 0.05_rk, 0.05_rk, [0.0_rk, 1.0e6_rk, 1.0e6_rk], model, &
                      loads, displacement)
      scale = 1.0e6_rk*sqrt(0.5_rk*pi)
      call compare("collinear, inner left", model, loads, displacement, [-0.2_rk, 0.0_rk], &
                   1.143453649_rk, 1.143453649_rk, scale)
      call compare("collinear, inner right", model, loads, displacement, [0.2_rk, 0.0_rk], &
                   1.143453649_rk, 1.143453649_rk, scale)
      call compare("collinear, outer left", model, loads, displacement, [-1.2_rk, 0.0_rk], &
                   1.060712234_rk, 1.060712234_rk, scale)
      call compare("collinear, outer right", model, loads, displacement, [1.2_rk, 0.0_rk], &
                   1.060712234_rk, 1.060712234_rk, scale)
   end subroutine collinear

   !> Catalogue 1.8: a main crack of half-length 1 and a branch at its right tip; the integral's
   !! domain ends at the kink.
   subroutine kinked(degrees, length, remote, exact)
      real(rk), intent(in) :: degrees, length, remote(3)
      real(rk), intent(in) :: exact(4)  !< K_I, K_II of branch and far tip over s sqrt(pi)
      type(network_t) :: network
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: branch(2), scale
      character(len=32) :: name

      branch = [1.0_rk, 0.0_rk] + length*[cos(degrees*pi/180.0_rk), sin(degrees*pi/180.0_rk)]
      allocate (network%first, source=[1_ik, 4_ik])
      allocate (network%xy, source=reshape([-1.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, branch(1), &
                                            branch(2)], [2, 3]))
      allocate (network%s_start(1), source=0.0_rk)
      call solve_free(network, 50.0_rk, 0.05_rk, 0.04_rk, remote, model, loads, displacement)
      scale = 1.0e6_rk*sqrt(pi)
      write (name, "(a,f4.1,a,f3.1)") "kink ", degrees, " deg, ", length
      call compare(trim(name)//", branch", model, loads, displacement, branch, exact(1), exact(2), &
                   scale)
      call compare(trim(name)//", far tip", model, loads, displacement, [-1.0_rk, 0.0_rk], &
                   exact(3), exact(4), scale)
   end subroutine kinked

   !> Two cracks that cross, a third that ends on one of them, with no jump and the tractions of
   !! the uniform stress (which the free copies at the joints need): no crack at all.
   subroutine crossing()
      real(rk), parameter :: remote(3) = [-3.0e6_rk, -5.0e6_rk, 1.5e6_rk]
      type(network_t) :: network
      type(mesh_t) :: mesh
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: conditions
      type(intensity_t) :: intensity
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: largest
      integer(ik) :: tip

      allocate (network%first, source=[1_ik, 3_ik, 5_ik, 7_ik])
      allocate (network%xy, source=reshape([-1.0_rk, -0.5_rk, 1.0_rk, 0.5_rk, -0.4_rk, 1.0_rk, &
                                            0.4_rk, -1.0_rk, &
                                            0.5_rk, 0.25_rk, 2.0_rk, -0.7_rk], [2, 6]))
      allocate (network%s_start(3), source=0.0_rk)
      call build_mesh(mesh_spec_t(-2.0_rk, 2.0_rk, -2.0_rk, 2.0_rk, 0.2_rk, 0.5_rk, .true., 12_ik, &
                                  0.1_rk), network, mesher, &
                      mesh, error)
      call checks%no_error(error, "crossing is meshed")
      call model%set_mesh(mesh, rock, error)
      call checks%no_error(error, "crossing is numbered")
      conditions = loaded_everywhere(model%mesh)
      conditions%condition = face_jump
      call model%prepare(conditions, error)
      call checks%no_error(error, "crossing is set up")
      loads = no_loads(model%mesh)
      call set_uniform(model, remote, loads)
      call model%solve(loads, displacement, error)
      call checks%no_error(error, "crossing is solved")
      largest = maxval(norm2(displacement - loads%boundary_displacement, dim=1))
      call checks%is_close(largest, 0.0_rk, 1.0e-11_rk*maxval(abs(displacement)), &
                           "a crossing held closed")
      do tip = 1, model%mesh%fracture%n_tips
         call intensity_of_tip(model, loads, displacement, tip, intensity, error)
         call checks%is_close(hypot(intensity%k1, intensity%k2)/5.0e6_rk, 0.0_rk, 2.0e-4_rk, &
                              "a crack held closed has no K")
         call checks%is_close(hypot(intensity%k1_dc, intensity%k2_dc)/5.0e6_rk, 0.0_rk, 1.0e-9_rk, &
                              "nor from displacements")
      end do
      call checks%is_true(model%mesh%fracture%n_tips == 4, "four free tips")
   end subroutine crossing

   !> A coarse mesh in which an element of the domain reaches behind a kink, across the prolongation
   !! of the tip's segment, where the angle of the auxiliary field has to be continued. Under a
   !! uniform stress, carried across the crack, K = 0 up to the error of integration.
   subroutine kink_behind()
      real(rk), parameter :: remote(3) = [1.0_rk, 2.0_rk, 0.7_rk], slope = -1.5_rk
      type(mesh_t) :: mesh
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(intensity_t) :: intensity
      real(rk), allocatable :: displacement(:, :)
      integer(ik) :: node

      ! The tip is at (2, 0), the kink at (1, 0).
      mesh = cracked_rectangle([-4.0_rk, 4.0_rk], [-4.0_rk, 4.0_rk], [8_ik, 8_ik], 4_ik, 3_ik, 6_ik)
      node = minloc((mesh%xy(1, :) - 1.0_rk)**2 + (mesh%xy(2, :) + 1.0_rk)**2, dim=1)
      mesh%xy(:, node) = [1.15_rk, -0.3_rk]
      call bend(slope, mesh%xy)
      call bend(slope, mesh%fracture%point_xy)
      call model%set_mesh(mesh, rock, error)
      call checks%no_error(error, "bent mesh")
      call model%prepare(loaded_everywhere(model%mesh), error)
      loads = no_loads(model%mesh)
      call set_uniform(model, remote, loads)
      call model%solve(loads, displacement, error)
      call checks%no_error(error, "bent mesh is solved")
      call intensity_of_tip(model, loads, displacement, 2_ik, intensity, error)
      call checks%is_close(intensity%radius, 1.0_rk, 1.0e-12_rk, "the domain ends at the kink")
      call checks%is_close(intensity%k1, 0.0_rk, 5.0e-4_rk, "no K_I beside a kink")
      call checks%is_close(intensity%k2, 0.0_rk, 5.0e-4_rk, "no K_II beside a kink")
   end subroutine kink_behind

   !> Shear what lies left of a kink at x = 1.
   subroutine bend(slope, xy)
      real(rk), intent(in) :: slope
      real(rk), intent(inout) :: xy(:, :)

      xy(2, :) = xy(2, :) + slope*min(0.0_rk, xy(1, :) - 1.0_rk)
   end subroutine bend

   !> Displacements and face tractions of a uniform stress.
   subroutine set_uniform(model, stress, loads)
      type(fine_model_t), intent(in) :: model
      real(rk), intent(in) :: stress(3)
      type(fine_loads_t), intent(inout) :: loads
      real(rk) :: total(2), tau(2), n(2)
      integer(ik) :: node, cell

      do node = 1, model%mesh%n_nodes
         loads%boundary_displacement(:, node) = uniform_field(rock, stress, model%mesh%xy(:, node))
      end do
      do cell = 1, model%mesh%fracture%n_cells
         tau = model%mesh%face_tangent(:, cell)
         n = [-tau(2), tau(1)]
         total = [stress(1)*n(1) + stress(3)*n(2), stress(3)*n(1) + stress(2)*n(2)]
         loads%traction(:, cell) = [dot_product(total, tau), dot_product(total, n)]
      end do
   end subroutine set_uniform

end program test_fine_tip_networks
