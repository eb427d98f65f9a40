!> Growth passed to the coarse level: one straight segment per tip, once the segment is long enough
!! for a cell of the coarse mesh.
module twolevel_handover
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_value
   use growth_network, only: end_direction, end_gain, end_vertices, extend, straighten_end
   use growth_tip, only: tip_t
   use mesh_types, only: network_t
   implicit none(type, external)
   private

   public :: hand_over

contains

   !> Extend the coarse network by the growth of the fine level, once the growth of a tip reaches
   !! the threshold, or a tip has joined a target. Tips with at least half of the threshold are
   !! included. The fine network gets the same straight segments.
   pure subroutine hand_over(threshold, network, tips, coarse, centres, is_straightened)
      real(rk), intent(in) :: threshold  !< eps_p dH [m]
      type(network_t), intent(inout) :: network  !< fine network
      type(tip_t), intent(inout) :: tips(:)
      type(network_t), intent(inout) :: coarse
      !> (2, n) points where the coarse network has changed [m]; n may be 0
      real(rk), allocatable, intent(out) :: centres(:, :)
      logical, intent(out) :: is_straightened  !< the fine network has changed as well
      real(rk) :: pending(size(tips))
      logical :: has_joined(size(tips))
      integer(ik) :: i, n

      is_straightened = .false.
      do i = 1, size(tips, kind=ik)
         pending(i) = end_gain(network, coarse, tips(i)%fracture, tips(i)%end)
      end do
      allocate (centres(2, 0))
      has_joined = tips%joined .and. pending > same_value*threshold
      if (.not. any(pending >= threshold*(1.0_rk - same_value) .or. has_joined)) return
      do i = 1, size(tips, kind=ik)
         associate (tip => tips(i))
            if (pending(i) < 0.5_rk*threshold .and. .not. has_joined(i)) cycle
            n = end_vertices(network, coarse, tip%fracture, tip%end)
            call extend(coarse, tip%fracture, tip%end, tip%xy)
            centres = reshape([centres, tip%xy], [2, size(centres, 2) + 1])
            if (n == 1) cycle
            call straighten_end(network, tip%fracture, tip%end, n - 1)
            tip%direction = end_direction(coarse, tip%fracture, tip%end)
            is_straightened = .true.
         end associate
      end do
   end subroutine hand_over

end module twolevel_handover
