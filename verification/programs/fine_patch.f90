!> Patch test of the six-node triangles with quarter points (verification/patch_tests):
!! a uniform stress is carried across cracks by contact traction and fluid pressure on their faces.
!!
!! Arguments: element size [m], sectors of the rosettes. Errors are relative to the largest
!! displacement and to the stress.
program fine_patch
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use exact_cracks, only: uniform_field
   use fine_faces, only: face_conditions_t, face_jump, loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_model, only: fine_model_t
   use verification_cracks, only: line_stress, mesh_window, rock, set_remote
   use verification_files, only: finish, integer_argument, real_argument, stop_on, table_t
   use verification_meshes, only: network_of
   implicit none(type, external)

   real(rk), parameter :: stress(3) = [-3.0e6_rk, -5.0e6_rk, 1.5e6_rk]  ! xx, yy, xy [Pa]
   real(rk), parameter :: pressure = 2.0e6_rk  ! of the fluid in the cracks [Pa]
   type(fine_model_t) :: model
   type(fine_loads_t) :: loads
   type(face_conditions_t) :: conditions
   type(table_t) :: table
   real(rk) :: normal, shear, errors(4)
   integer(ik) :: cell

   ! A kinked crack with two tips, and one cut by the window's edge.
   call mesh_window(network_of([3_ik, 2_ik], &
                               reshape([-0.6_rk, -0.3_rk, 0.1_rk, -0.2_rk, 0.5_rk, 0.2_rk, &
                                        -0.2_rk, 0.5_rk, 1.5_rk, 0.9_rk], [2, 5])), &
                    1.0_rk, real_argument(1), 3.0_rk*real_argument(1), integer_argument(2), model)
   loads = no_loads(model%mesh)
   call set_remote(model, stress, loads)
   loads%fluid_pressure = pressure
   do cell = 1, model%mesh%fracture%n_cells
      associate (tau => model%mesh%face_tangent(:, cell))
         call line_stress(atan2(tau(2), tau(1)), stress, normal, shear)
      end associate
      loads%traction(:, cell) = [shear, normal + pressure]
   end do
   conditions = loaded_everywhere(model%mesh)
   call measure(errors(1), errors(2))
   conditions%condition = face_jump  ! held together
   call measure(errors(3), errors(4))
   call table%open("errors.csv", "loaded_displacement,loaded_stress,held_displacement,held_stress")
   call table%row(errors)
   call table%close()
   call finish()

contains

   subroutine measure(displacement_error, stress_error)
      real(rk), intent(out) :: displacement_error, stress_error
      type(error_t), allocatable :: error
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: exact(2), found(2, 2), largest
      integer(ik) :: c, node

      call model%prepare(conditions, error)
      call stop_on(error)
      call model%solve(loads, displacement, error)
      call stop_on(error)
      displacement_error = 0.0_rk
      largest = 0.0_rk
      do node = 1, model%mesh%n_nodes
         exact = uniform_field(rock, stress, model%mesh%xy(:, node))
         largest = max(largest, maxval(abs(exact)))
         displacement_error = max(displacement_error, maxval(abs(displacement(:, node) - exact)))
      end do
      displacement_error = displacement_error/largest
      stress_error = 0.0_rk
      do c = 1, model%mesh%n_cells
         found = rock%total_stress(model%displacement_gradient(displacement, c, &
                                                               [0.2_rk, 0.3_rk, 0.5_rk]), 0.0_rk)
      stress_error = max(stress_error, abs(found(1, 1) - stress(1)), abs(found(2, 2) - stress(2)), &
                            abs(found(1, 2) - stress(3)))
      end do
      stress_error = stress_error/maxval(abs(stress))
   end subroutine measure

end program fine_patch
