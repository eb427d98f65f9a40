!> The error of stress intensity factors from that of the whole solution.
!!
!! K is a linear function of the displacement (tips_interaction), and z the displacement that its
!! nodal forces cause in the same body. The error of K is then a(e_u, e_z), the energy of the error
!! of the solution in the strain of that of z (Becker and Rannacher 2001); both are estimated by
!! recovered stresses.
module tips_dual
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use fine_error, only: error_product
   use fine_faces, only: face_loaded
   use fine_model, only: fine_model_t
   use fine_recovery, only: recover_by_patches, recovery_t
   use tips_intensity, only: complete_errors, tip_probe_t
   use tips_types, only: intensity_t
   implicit none(type, external)
   private

   public :: correct_intensity, has_dual

contains

   !> Whether the displacement depends on the loads alone: no face touches another.
   pure logical function has_dual(model)
      type(fine_model_t), intent(in) :: model

      has_dual = all(model%conditions%condition == face_loaded)
   end function has_dual

   !> Add what K_I and K_II lack to their corrected values, and its magnitude to their errors.
   subroutine correct_intensity(model, displacement, recovery, probe, intensity, error)
      type(fine_model_t), intent(inout) :: model
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(recovery_t), intent(in) :: recovery  !< of its stresses
      type(tip_probe_t), intent(in) :: probe  !< of the tip
      type(intensity_t), intent(inout) :: intensity  !< from tip_intensity
      type(error_t), allocatable, intent(out) :: error
      type(recovery_t) :: dual_recovery
      real(rk), allocatable :: force(:, :, :), dual(:, :)
      real(rk) :: missing(2)
      integer(ik) :: mode

      force = probe%interactions%extraction_forces(1_ik, model%mesh%n_nodes)
      do mode = 1, 2
         call model%influence(force(:, :, mode), dual, error)
         if (allocated(error)) return
         call recover_by_patches(model, dual, dual_recovery)
         missing(mode) = error_product(model, displacement, recovery, dual, dual_recovery)
      end do
      intensity%k1_corrected = intensity%k1 + missing(1)
      intensity%k2_corrected = intensity%k2 + missing(2)
      intensity%k1_error = intensity%k1_error + abs(missing(1))
      intensity%k2_error = intensity%k2_error + abs(missing(2))
      call complete_errors(probe%frame%rock%crack_modulus(), intensity)
   end subroutine correct_intensity

end module tips_dual
