!> Recovered stresses (verification/stress_recovery) of a smooth field or around a crack.
!!
!! Arguments: smooth or crack; number of boxes along the side, 4 triangles of a box each, in a crack
!! a multiple of 12.
program fine_recovery_errors
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use exact_fields, only: angle, solve_exact, true_errors
   use fine_error, only: energy_error_t, estimate_error
   use fine_model, only: fine_model_t
   use fine_recovery, only: recover_by_patches, recovery_t
   use mesh_types, only: mesh_t
   use sample_meshes, only: cracked_rectangle, rotate_mesh
   use verification_files, only: finish, integer_argument, stop_on, table_t, text_argument
   implicit none(type, external)

   type(mesh_t) :: mesh
   type(fine_model_t) :: model
   type(recovery_t) :: patches
   type(energy_error_t) :: estimate
   type(error_t), allocatable :: error
   type(table_t) :: table
   real(rk), allocatable :: displacement(:, :)
   real(rk) :: true
   integer(ik) :: n
   logical :: cracked

   cracked = text_argument(1) == "crack"
   n = integer_argument(2)
   if (cracked) then
      mesh = cracked_rectangle([-2.0_rk, 2.0_rk], [-2.0_rk, 2.0_rk], [n, n], n/2, n/4 + 1, 3*n/4)
      call rotate_mesh(mesh, angle, .false.)
   else
      mesh = cracked_rectangle([0.0_rk, 1.0_rk], [0.0_rk, 1.0_rk], [n, n], 1_ik, 1_ik, 0_ik)
   end if
   call solve_exact(mesh, cracked, model, displacement, error)
   call stop_on(error)
   call recover_by_patches(model, displacement, patches)
   call estimate_error(model, displacement, patches, estimate)
   true = norm2(true_errors(model, displacement, cracked))
   call table%open("recovery.csv", "elements,patches")
   call table%row([true, norm2(true_errors(model, displacement, cracked, patches))] &
                  /estimate%solution)
   call table%close()
   call table%open("effectivity.csv", "patches")
   call table%row([estimate%total/true])
   call table%close()
   call finish()

end program fine_recovery_errors
