!> Positions of tips along the last segments of their paths, on both levels.
!!
!! The last cell of a fracture ends with its last segment, at a joint if the segment ends on a
!! fracture or side. No fluid flows to the joint before the tip reaches it.
module twolevel_places
   use base_kinds, only: ik, rk
   use base_lists, only: lists_t
   use base_plane, only: norm2
   use base_tolerances, only: same_place
   use growth_front, only: front_state_t
   use growth_network, only: end_gain, end_place, fracture_length, move_end
   use growth_segment, only: segment_t
   use growth_tip, only: tip_t
   use mesh_types, only: fracture_mesh_t, network_t, point_interior, point_tip
   use scene_types, only: scene_t
   use twolevel_problem, only: coarse_problem_t
   implicit none(type, external)
   private

   public :: advances, end_at_tips, end_cell, place_tips, shut_tips, tip_cell_lengths

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
      call problem%model%place_ends(problem%mesh)
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

   !> With growth in equilibrium, end the last cells of the fractures at the tips: the cells of the
   !! coarse mesh extend beyond the tips, closed, and may end at a joint that the crack has not
   !! reached.
   pure subroutine end_at_tips(scene, front, fracture)
      type(scene_t), intent(in) :: scene
      type(front_state_t), intent(in) :: front
      type(fracture_mesh_t), intent(inout) :: fracture
      real(rk) :: first, last
      integer(ik) :: cell, end, i

      if (.not. scene%growth%leaves_partial_cells()) return
      do i = 1, size(front%tip, kind=ik)
         if (front%tip(i)%is_free) call detach_tip(front%tip(i), fracture)
      end do
      do cell = 1, fracture%n_cells
         associate (f => fracture%cell_fracture(cell))
            first = front%network%s_start(f)
            last = first + fracture_length(front%network, f)
            do end = 1, 2
               associate (s => fracture%cell_s(end, cell), &
                          point => fracture%cell_points(end, cell))
                  if (s < first) fracture%point_xy(:, point) = end_place(front%network, f, 1_ik)
                  if (s > last) fracture%point_xy(:, point) = end_place(front%network, f, 2_ik)
                  s = min(max(s, first), last)
               end associate
            end do
         end associate
      end do
   end subroutine end_at_tips

   !> Give a fracture whose last cell ends at a joint, but whose tip has not reached the joint, a
   !! separate tip point there, and remove its branch from the joint.
   pure subroutine detach_tip(tip, fracture)
      type(tip_t), intent(in) :: tip
      type(fracture_mesh_t), intent(inout) :: fracture
      integer(ik), allocatable :: cells(:)
      integer(ik) :: cell, k, point
      type(lists_t) :: point_cells

      cell = end_cell(fracture, tip)
      point = fracture%cell_points(tip%end, cell)
      if (fracture%point_kind(point) == point_tip) return
      cells = fracture%point_cells%of(point)
      cells = pack(cells, cells /= cell)
      associate (n => fracture%n_points, old => fracture%point_cells)
         point_cells%first = [old%first, old%first(n + 1)]
         point_cells%first(point + 1:n + 1) = point_cells%first(point + 1:n + 1) - 1
         point_cells%item = [old%item(:old%first(point) - 1), cells, &
                             old%item(old%first(point + 1):), cell]
         fracture%point_cells = point_cells
         fracture%point_xy = reshape([fracture%point_xy, tip%xy], [2_ik, n + 1])
         fracture%point_kind = [fracture%point_kind, point_tip]
         n = n + 1
      end associate
      fracture%cell_points(tip%end, cell) = fracture%n_points
      ! The remaining branches may not form a joint any more.
      associate (others => fracture%cell_fracture(cells))
         if (size(cells) == 0) fracture%point_kind(point) = point_interior
         if (size(cells) == 2) then
            if (others(1) == others(2) .and. abs(cells(2) - cells(1)) == 1) then
               fracture%point_kind(point) = point_interior
            end if
         end if
      end associate
      associate (n => fracture%n_tips)
         fracture%tip_point = [fracture%tip_point, fracture%n_points]
         fracture%tip_node = [fracture%tip_node, 0_ik]
         fracture%tip_fracture = [fracture%tip_fracture, tip%fracture]
         fracture%tip_end = [fracture%tip_end, tip%end]
         fracture%tip_direction = reshape([(fracture%tip_direction(:, k), k=1, n), tip%direction], &
                                          [2_ik, n + 1])
         fracture%tip_radius = [fracture%tip_radius, 0.0_rk]
         n = n + 1
      end associate
   end subroutine detach_tip

end module twolevel_places
