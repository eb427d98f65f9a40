!> Positions of tips along the last segments of their paths, on both levels.
!!
!! The last cell of a fracture ends with its last segment, at a joint if the segment ends on a
!! fracture or side. No fluid flows to the joint before the tip reaches it.
module twolevel_places
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use base_tolerances, only: same_place
   use growth_front, only: front_state_t
   use growth_network, only: end_gain, move_end
   use growth_segment, only: segment_t
   use growth_tip, only: tip_t
   use mesh_types, only: fracture_mesh_t, network_t
   use twolevel_problem, only: coarse_problem_t
   implicit none(type, external)
   private

   public :: advances, end_cell, place_tips, shut_tips, tip_cell_lengths

contains

   !> Advances of the tips since the last accepted state [m].
   function advances(front, start, segments, increment)
      type(front_state_t), intent(in) :: front
      type(network_t), intent(in) :: start  !< initial network, from the scene
      type(segment_t), intent(in) :: segments(:)  !< (tips)
      real(rk), intent(in) :: increment(:)  !< (tips) [m]
      real(rk) :: advances(size(segments))
      integer(ik) :: i

      do i = 1, size(segments, kind=ik)
         advances(i) = end_gain(front%network, start, front%tip(i)%fracture, front%tip(i)%end) &
                       - segments(i)%gain
      end do
      ! Rounding errors remain for tips that have not moved if the other end of their fracture has.
      where (abs(advances) <= same_place*increment) advances = 0.0_rk
   end function advances

   !> Put the tips of both levels at their positions along their segments.
   subroutine place_tips(front, segments, problem)
      type(front_state_t), intent(inout) :: front
      type(segment_t), intent(in) :: segments(:)  !< (tips)
      type(coarse_problem_t), intent(inout) :: problem
      integer(ik), allocatable :: free(:)
      integer(ik) :: i, k

      do i = 1, size(segments, kind=ik)
         associate (tip => front%tip(i), segment => segments(i))
            if (.not. segment%is_open) cycle
            tip%xy = segment%place()
            tip%direction = segment%direction
            call move_end(front%network, tip%fracture, tip%end, tip%xy)
         end associate
      end do
      free = pack([(i, i=1, size(segments, kind=ik))], front%tip%is_free)
      associate (fracture => problem%mesh%fracture, ends => problem%model%ends, &
                 tips => front%tip(free))
         ends%cell = [(end_cell(fracture, tips(k)), k=1, size(free))]
         ends%inwards = merge(1_ik, -1_ik, tips%end == 1)
         ends%ahead = [(norm2(fracture%point_xy(:, fracture%cell_points(tips(k)%end, &
                                                                        ends%cell(k))) &
                              - tips(k)%xy), k=1, size(free))]
         if (allocated(ends%viscous)) then
            if (size(ends%viscous) /= size(free)) deallocate (ends%viscous)
         end if
         call problem%model%joints%shut_only(ends%cell, tips%end)
      end associate
   end subroutine place_tips

   !> Last cell of a fracture at a tip; cells are stored along each fracture.
   pure integer(ik) function end_cell(fracture, tip)
      type(fracture_mesh_t), intent(in) :: fracture
      type(tip_t), intent(in) :: tip

      end_cell = findloc(fracture%cell_fracture, tip%fracture, dim=1, back=tip%end == 2)
   end function end_cell

   !> Whether each tip is closed: its last two coarse cells have no jump, so the faces have stuck
   !! there since before the load, and K = 0. Tips that have grown never are.
   pure function shut_tips(tips, segments, fracture, jump) result(is_shut)
      type(tip_t), intent(in) :: tips(:)
      type(segment_t), intent(in) :: segments(:)  !< (tips)
      type(fracture_mesh_t), intent(in) :: fracture
      real(rk), intent(in) :: jump(:, :, :)  !< (2, 2, fracture cells) [m]
      logical :: is_shut(size(tips))
      ! rounding error of a jump, over the largest jump
      real(rk), parameter :: rounding = 1.0e-12_rk
      real(rk) :: least
      integer(ik) :: cell, i, next

      is_shut = .false.
      least = rounding*maxval(abs(jump))
      do i = 1, size(tips, kind=ik)
         if (.not. tips(i)%is_free .or. segments(i)%is_open .or. segments(i)%gain > 0.0_rk) cycle
         cell = end_cell(fracture, tips(i))
         next = cell + merge(1_ik, -1_ik, tips(i)%end == 1)
         if (next < 1 .or. next > fracture%n_cells) cycle
         if (fracture%cell_fracture(next) /= tips(i)%fracture) cycle
         is_shut(i) = all(abs(jump(:, :, [cell, next])) <= least)
      end do
   end function shut_tips

   !> Length of the coarse cell at each tip; 0 for tips that are not free [m].
   pure function tip_cell_lengths(tips, problem) result(length)
      type(tip_t), intent(in) :: tips(:)
      type(coarse_problem_t), intent(in) :: problem
      real(rk) :: length(size(tips))
      integer(ik) :: i

      length = 0.0_rk
      do i = 1, size(tips, kind=ik)
         if (.not. tips(i)%is_free) cycle
         length(i) = problem%model%condensed%length(end_cell(problem%mesh%fracture, tips(i)))
      end do
   end function tip_cell_lengths

end module twolevel_places
