!> Stress intensity factors from the displacements of the crack faces next to the tip.
module tips_displacement
   use base_kinds, only: ik, pi, rk
   use fine_elasticity, only: elasticity_t
   use fine_mesh, only: fine_mesh_t
   use tips_types, only: tip_frame_t
   implicit none(type, external)
   private

   public :: displacement_correlation

contains

   !> Kuang and Chen (1993): with the jump A*sqrt(r) + B*r**(3/2) behind the tip, its values at the
   !! quarter point h/4 and at the end h of the element leave 3*A*sqrt(h) = 8 [u](h/4) - [u](h), and
   !! in a plain element those at h/2 and h leave A*sqrt(h) = 2*sqrt(2) [u](h/2) - [u](h).
   pure subroutine displacement_correlation(fine, elasticity, displacement, frame, k1, k2)
      type(fine_mesh_t), intent(in) :: fine
      type(elasticity_t), intent(in) :: elasticity
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(tip_frame_t), intent(in) :: frame
      real(rk), intent(out) :: k1, k2  !< [Pa m^1/2]
      real(rk) :: near(2), far(2), combination(2), factor
      integer(ik) :: far_end

      far_end = 3 - fine%face_at_tip(frame%face)
      associate (nodes => fine%face_nodes(:, :, frame%face))
         near = displacement(:, nodes(3, 2)) - displacement(:, nodes(3, 1))
         far = displacement(:, nodes(far_end, 2)) - displacement(:, nodes(far_end, 1))
      end associate
      if (fine%face_tip(frame%face) > 0) then
         combination = 8.0_rk*near - far
      else
         combination = 3.0_rk*(2.0_rk*sqrt(2.0_rk)*near - far)
      end if
      factor = elasticity%shear_modulus()/(3.0_rk*(1.0_rk + elasticity%kolosov())) &
               *sqrt(2.0_rk*pi/fine%face_length(frame%face))
      ! Upper minus lower face in the tip's axes.
      combination = frame%upper*matmul(frame%axes, combination)
      k1 = factor*combination(2)
      k2 = factor*combination(1)
   end subroutine displacement_correlation

end module tips_displacement
