!> Flows round loops of fractures. What goes out at one end of an edge comes in at the other, so
!! balances say nothing of it: the pressures' differences along the loop do, and in wide fractures
!! these are below the rounding of the pressures. Such a flow changes no balance and hardly a
!! pressure; it is only not known itself. (The condition of the equations leaves flows out.)
module coarse_loops
   use base_groups, only: groups_t, single_groups
   use base_kinds, only: ik, rk
   use coarse_joints, only: joints_t
   use coarse_slopes, only: slopes_t
   implicit none(type, external)
   private

   public :: flows_in_loops, unknown_flow

contains

   !> Which flows are in networks that hold a loop: those between pairs of cells, then those of the
   !! branches. All outlets are one place: between two of them flow is as free as in a loop.
   pure function flows_in_loops(n_cells, connections, joints) result(in_loop)
      integer(ik), intent(in) :: n_cells  !< fracture cells
      integer(ik), intent(in) :: connections(:, :)  !< (2, pairs) cells that exchange fluid
      type(joints_t), intent(in) :: joints
      logical, allocatable :: in_loop(:)  !< (pairs, then branches)
      type(groups_t) :: groups
      logical :: closes, has_loop(n_cells + joints%n + 1)
      integer(ik), allocatable :: closing(:), edge(:, :), number(:)
      integer(ik) :: b, k, outside

      outside = n_cells + joints%n + 1
      allocate (edge(2, size(connections, 2) + joints%branch_count()), closing(0))
      edge(:, :size(connections, 2)) = connections
      do b = 1, joints%branch_count()
         edge(:, size(connections, 2) + b) = [joints%cell(b), n_cells + joints%joint(b)]
         if (joints%is_outlet(joints%joint(b))) edge(2, size(connections, 2) + b) = outside
      end do
      groups = single_groups(outside)
      do k = 1, size(edge, 2, kind=ik)
         call groups%join(edge(1, k), edge(2, k), closes)
         if (closes) closing = [closing, k]
      end do
      number = groups%numbers()
      has_loop = .false.
      has_loop(number(edge(1, closing))) = .true.
      in_loop = has_loop(number(edge(1, :)))
   end function flows_in_loops

   !> The largest flow round a loop that a difference of pressures drives which is not known [Pa],
   !! in the unit of the flows.
   pure function unknown_flow(slopes, at_first, in_loop, difference) result(flow)
      type(slopes_t), intent(in) :: slopes
      integer(ik), intent(in) :: at_first  !< the number of the first flow
      logical, intent(in) :: in_loop(:)  !< (flows)
      real(rk), intent(in) :: difference  !< [Pa]
      real(rk) :: flow
      real(rk) :: resistance(size(in_loop))
      integer(ik) :: k

      resistance = 0.0_rk
      do k = 1, slopes%n_local
         associate (row => slopes%row(k), number => slopes%row(k) - at_first + 1)
            if (row /= slopes%col(k) .or. number < 1 .or. number > size(in_loop)) cycle
            resistance(number) = resistance(number) + slopes%value(k)
         end associate
      end do
      flow = 0.0_rk
      if (any(in_loop)) flow = difference/max(minval(resistance, mask=in_loop), tiny(1.0_rk))
   end function unknown_flow

end module coarse_loops
