!> Recovered stresses and estimated errors against exact fields.
program test_fine_error
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use exact_fields, only: angle, rock, solve_exact, true_errors
   use fine_error, only: energy_error_t, estimate_error, wanted_sizes
   use fine_faces, only: loaded_everywhere
   use fine_loads, only: fine_loads_t, no_loads
   use fine_model, only: fine_model_t
   use fine_recovery, only: recover_by_patches, recovery_t
   use mesh_types, only: mesh_t
   use sample_meshes, only: cracked_rectangle, rotate_mesh
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks
   type(error_t), allocatable :: error
   type(mesh_t) :: mesh

   call exact_in_the_elements()
   call smooth_field()
   call crack()
   call sizes()
   call checks%finish()

contains

   !> The exact problem, solved.
   subroutine solved(mesh, cracked, model, displacement)
      type(mesh_t), intent(in) :: mesh
      logical, intent(in) :: cracked
      type(fine_model_t), intent(inout) :: model
      real(rk), allocatable, intent(out) :: displacement(:, :)

      call solve_exact(mesh, cracked, model, displacement, error)
      call checks%no_error(error, "body is solved")
   end subroutine solved

   !> A displacement that the elements hold has no error, and none is estimated.
   subroutine exact_in_the_elements()
      type(fine_model_t) :: model
      type(fine_loads_t) :: loads
      type(recovery_t) :: recovery
      type(energy_error_t) :: estimate
      real(rk), allocatable :: displacement(:, :)

      mesh = cracked_rectangle([0.0_rk, 2.0_rk], [0.0_rk, 1.0_rk], [5_ik, 3_ik], 1_ik, 1_ik, 0_ik)
      call model%set_mesh(mesh, rock, error)
      call model%prepare(loaded_everywhere(model%mesh), error)
      loads = no_loads(model%mesh)
      ! Pure bending, s_xx = E' y.
      loads%boundary_displacement(1, :) = model%mesh%xy(1, :)*model%mesh%xy(2, :)
      loads%boundary_displacement(2, :) = -0.5_rk*(model%mesh%xy(1, :)**2 &
                                                   + rock%poisson/(1.0_rk - rock%poisson) &
                                                   *model%mesh%xy(2, :)**2)
      call model%solve(loads, displacement, error)
      call recover_by_patches(model, displacement, recovery)
      call estimate_error(model, displacement, recovery, estimate)
      call checks%is_close(estimate%relative, 0.0_rk, 1.0e-11_rk, "bending has no error")
   end subroutine exact_in_the_elements

   !> The effectivity index, estimated over true error, tends to one.
   subroutine smooth_field()
      type(fine_model_t) :: model
      type(recovery_t) :: recovery
      type(energy_error_t) :: estimate
      real(rk), allocatable :: displacement(:, :)
      real(rk) :: effectivity, before, total, recovered, coarser
      integer(ik) :: level

      before = 1.0_rk
      coarser = 0.0_rk
      do level = 2, 4
         mesh = cracked_rectangle([0.0_rk, 1.0_rk], [0.0_rk, 1.0_rk], [1_ik, 1_ik]*2_ik**level, &
                                  1_ik, 1_ik, 0_ik)
         call solved(mesh, .false., model, displacement)
         total = norm2(true_errors(model, displacement, .false.))
         call recover_by_patches(model, displacement, recovery)
         call estimate_error(model, displacement, recovery, estimate)
         effectivity = estimate%total/total
         print "(a,es10.2,a,f8.4)", "smooth: true error", total/estimate%solution, &
            ", effectivity", effectivity
         call checks%is_true(effectivity > 0.8_rk .and. effectivity < 1.25_rk, &
                             "smooth field: effectivity")
         call checks%is_true(abs(effectivity - 1.0_rk) < before, "smooth field: it gets better")
         before = abs(effectivity - 1.0_rk)
         recovered = norm2(true_errors(model, displacement, .false., recovery))
         print "(2(a,f8.4))", "smooth: error of the recovered stress over that of the elements", &
            recovered/total, ", order", log(max(coarser, recovered)/recovered)/log(2.0_rk)
         call checks%is_true(recovered < total, "smooth field: recovered stresses are nearer")
         if (level > 2) then
            call checks%is_true(recovered < 0.25_rk*coarser, &
                                "smooth field: recovered stresses converge faster than order 2")
         end if
         coarser = recovered
      end do
      call checks%is_close(effectivity, 1.0_rk, 0.05_rk, "smooth field: finest mesh")
   end subroutine smooth_field

   !> A crack with quarter-point elements at both tips.
   subroutine crack()
      type(fine_model_t) :: model
      type(recovery_t) :: recovery
      type(energy_error_t) :: estimate
      real(rk), allocatable :: displacement(:, :), true(:)
      real(rk) :: effectivity, local
      logical, allocatable :: at_tip(:)
      integer(ik) :: level, b, tip

      do level = 0, 2
         b = 3_ik*2_ik**level
         mesh = cracked_rectangle([-2.0_rk, 2.0_rk], [-2.0_rk, 2.0_rk], [4*b, 4*b], 2*b, b + 1, 3*b)
         call rotate_mesh(mesh, angle, .false.)
         call solved(mesh, .true., model, displacement)
         true = true_errors(model, displacement, .true.)
         at_tip = model%mesh%tip_corner > 0
         call recover_by_patches(model, displacement, recovery)
         call estimate_error(model, displacement, recovery, estimate)
         effectivity = estimate%total/norm2(true)
         local = norm2(pack(estimate%element, at_tip))/norm2(pack(true, at_tip))
         print "(a,es10.2,3(a,f8.4))", "crack: true error", norm2(true)/estimate%solution, &
            ", at the tips", norm2(pack(true, at_tip))/norm2(true), ", effectivity", effectivity, &
            ", at the tips", local
         call checks%is_true(effectivity > 0.8_rk .and. effectivity < 1.25_rk, &
                             "crack: effectivity")
         ! K = sqrt(pi) at both ends; an error of it would only make the rest of the stress rougher.
         do tip = 1, 2
            call checks%is_close(recovery%tips(tip)%intensity(1), sqrt(pi), 0.04_rk, &
                                 "crack: K_I of the fitted field")
            call checks%is_close(recovery%tips(tip)%intensity(2), 0.0_rk, 0.01_rk, &
                                 "crack: K_II of the fitted field")
         end do
      end do
   end subroutine crack

   !> Sizes for a quarter of the error are half as large where the error is spread evenly. Around a
   !! tip the radius follows the squared error of all its elements, and no size wanted is that of
   !! the tip itself.
   subroutine sizes()
      type(fine_model_t) :: model
      type(recovery_t) :: recovery
      type(energy_error_t) :: estimate, rest
      real(rk), parameter :: share = 0.1_rk, of_rosette = 322.0_rk*share**2
      real(rk), allocatable :: displacement(:, :), wanted(:), shrinkage(:)
      real(rk) :: now, allowed
      logical, allocatable :: is_tip(:)

      call solved(cracked_rectangle([0.0_rk, 1.0_rk], [0.0_rk, 1.0_rk], [8_ik, 8_ik], 1_ik, 1_ik, &
                                    0_ik), .false., model, displacement)
      call recover_by_patches(model, displacement, recovery)
      call estimate_error(model, displacement, recovery, estimate)
      estimate%element = estimate%total/sqrt(real(size(estimate%element), rk))
      call wanted_sizes(model%mesh, estimate, 0.25_rk*estimate%relative, wanted, shrinkage)
      now = sqrt(4.0_rk/256.0_rk/sqrt(3.0_rk))  ! 256 elements of equal area
      call checks%is_close(maxval(abs(wanted/now - 0.5_rk)), 0.0_rk, 1.0e-3_rk, "wanted sizes")
      call checks%is_true(size(shrinkage) == 0, "no tip, no rosette")
      call estimate_error(model, displacement, recovery, estimate, &
                          model%mesh%xy(1, model%mesh%cell_nodes(1, :)) < 0.5_rk)
      call wanted_sizes(model%mesh, estimate, 0.25_rk*estimate%relative, wanted, shrinkage)
      call checks%is_close(maxval(abs(wanted/now - 1.0_rk), estimate%left_out), 0.0_rk, 1.0e-9_rk, &
                           "elements that are left out keep their size")
      call checks%is_true(.not. any(estimate%left_out .and. estimate%element > 0.0_rk), &
                          "elements that are left out have no error")
      call estimate_error(model, displacement, recovery, rest,.not. estimate%left_out)
      call checks%is_close((estimate%solution**2 + rest%solution**2) &
                           /(2.0_rk*model%strain_energy(displacement)), 1.0_rk, 1.0e-12_rk, &
                           "elements that are left out have no energy")

      call solved(cracked_rectangle([-2.0_rk, 2.0_rk], [-2.0_rk, 2.0_rk], [16_ik, 16_ik], 8_ik, &
                                    5_ik, 12_ik), .true., model, displacement)
      is_tip = model%mesh%tip_corner > 0
      deallocate (estimate%element, estimate%left_out)
      allocate (estimate%element(model%mesh%n_cells), source=1.0_rk)
      allocate (estimate%left_out(model%mesh%n_cells), source=.false.)
      where (is_tip) estimate%element = 2.0_rk
      estimate%total = norm2(estimate%element)
      estimate%solution = 99.0_rk*estimate%total
      ! The error if all elements but those of the rosettes had the share.
      allowed = sqrt(count(.not. is_tip)*share**(4.0_rk/3.0_rk) + 2.0_rk*of_rosette)
      call wanted_sizes(model%mesh, estimate, &
                        allowed/hypot(estimate%solution, estimate%total), wanted, shrinkage)
      now = 4.0_rk*count(is_tip)/2.0_rk  ! squared error of a rosette
      call checks%is_close(maxval(abs(shrinkage*now/of_rosette - 1.0_rk)), 0.0_rk, 1.0e-9_rk, &
                           "wanted radii")
      call checks%is_close(minval(wanted, is_tip)/maxval(wanted, is_tip), 1.0_rk, 1.0e-9_rk, &
                           "sizes at the tips are all the same")
      call checks%is_close(minval(wanted, is_tip)/minval(wanted,.not. is_tip), 1.0_rk, 1.0e-9_rk, &
                           "sizes at the tips are those of the elements around")
   end subroutine sizes

end program test_fine_error
