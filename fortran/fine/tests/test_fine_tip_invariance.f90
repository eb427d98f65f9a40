!> Turning or mirroring the whole problem turns or mirrors the result, on a mesh that goes with it.
program test_fine_tip_invariance
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use exact_cracks, only: centre_crack
   use fine_elasticity, only: elasticity_t
   use fine_faces, only: face_conditions_t, face_slip, loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_model, only: fine_model_t
   use fine_tip_intensity, only: intensity_of_tip
   use fine_tip_types, only: intensity_t
   use mesh_types, only: mesh_t
   use sample_meshes, only: cracked_rectangle, rotate_mesh
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks
   type(intensity_t) :: reference(2), other(2)
   real(rk), parameter :: tolerance = 1.0e-10_rk
   integer(ik) :: tip, condition

   do condition = 1, 2
      call solve(0.0_rk, .false., condition == 2, reference)
      call checks%is_true(minval(abs([reference%k1, reference%k2])) > 0.01_rk, &
                          "there is something to compare")
      call solve(2.3_rk, .false., condition == 2, other)
      do tip = 1, 2
         call compare("turned", reference(tip), other(tip), 1.0_rk)
      end do
      call solve(-0.9_rk, .true., condition == 2, other)
      do tip = 1, 2
         call compare("mirrored", reference(tip), other(tip), -1.0_rk)
      end do
   end do
   call checks%finish()

contains

   !> A crack of half-length 1, off the centre of a 5 by 4 box, with pressures that vary in space.
   subroutine solve(angle, mirrored, slipping, intensity)
      real(rk), intent(in) :: angle
      logical, intent(in) :: mirrored, slipping
      type(intensity_t), intent(out) :: intensity(2)
      type(mesh_t) :: mesh
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(face_conditions_t) :: conditions
      type(error_t), allocatable :: error
      real(rk), allocatable :: displacement(:, :), original(:, :)
      real(rk) :: rotation(2, 2), crack(2)
      integer(ik) :: node, tip

      mesh = cracked_rectangle([-2.5_rk, 2.5_rk], [-1.75_rk, 2.25_rk], [20_ik, 16_ik], 7_ik, 7_ik, &
                               14_ik)
      call model%set_mesh(mesh, elasticity_t(1.0_rk, 0.3_rk, 0.7_rk, .false.), error)
      allocate (original, source=model%mesh%xy)
      call rotate_mesh(mesh, angle, mirrored)
      call model%set_mesh(mesh, elasticity_t(1.0_rk, 0.3_rk, 0.7_rk, .false.), error)
      call checks%no_error(error, "turned mesh")
      rotation = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])
      if (mirrored) rotation(:, 2) = -rotation(:, 2)

      conditions = loaded_everywhere(model%mesh)
      if (slipping) conditions%condition = face_slip
      ! A mirror exchanges the sides of the crack: the tangential parts change sign, the normal
      ! ones do not.
      conditions%dilation = merge(-0.2_rk, 0.2_rk, mirrored)
      call model%prepare(conditions, error)
      loads = no_loads(model%mesh)
      do node = 1, model%mesh%n_nodes
         crack = centre_crack(model%elasticity, 1.0_rk, 1.0_rk, 0.6_rk, original(:, node), .true.)
         loads%boundary_displacement(:, node) = matmul(rotation, crack)
      end do
      loads%pore_pressure = 0.4_rk + 0.3_rk*original(1, :model%mesh%n_vertices) &
                            - 0.2_rk*original(2, :model%mesh%n_vertices)
      loads%fluid_pressure = [(0.5_rk + 0.05_rk*tip, tip=1, model%mesh%fracture%n_cells)]
      loads%traction(1, :) = merge(-1.0_rk, 1.0_rk, mirrored)*0.3_rk
      loads%traction(2, :) = -0.7_rk
      call model%solve(loads, displacement, error)
      call checks%no_error(error, "turned problem is solved")
      do tip = 1, 2
         call intensity_of_tip(model, loads, displacement, tip, intensity(tip), error)
         call checks%no_error(error, "turned problem has intensities")
      end do
   end subroutine solve

   subroutine compare(name, one, two, sign_2)
      character(len=*), intent(in) :: name
      type(intensity_t), intent(in) :: one, two
      real(rk), intent(in) :: sign_2  !< of K_II

      call checks%is_close(two%k1, one%k1, tolerance, name//": K_I")
      call checks%is_close(two%k2, sign_2*one%k2, tolerance, name//": K_II")
      call checks%is_close(two%k1_inner, one%k1_inner, tolerance, name//": K_I, inner")
      call checks%is_close(two%k2_inner, sign_2*one%k2_inner, tolerance, name//": K_II, inner")
      call checks%is_close(two%k1_dc, one%k1_dc, tolerance, name//": K_I, displacements")
      call checks%is_close(two%k2_dc, sign_2*one%k2_dc, tolerance, name//": K_II, displacements")
   end subroutine compare

end program test_fine_tip_invariance
