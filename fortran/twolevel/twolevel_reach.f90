!> Connected parts of a fracture network: the graph of its cells, which meet in its points.
!!
!! The connectivity of a network follows from the ends of the branches between its points. B
!! branches have N free ends and, over all points where d >= 3 of them meet, sum(d) connected ones:
!! 2 B = N + sum(d). The mean number of connected ends of a branch,
!!   C_B = sum(d)/B,
!! goes from 0, isolated fractures, to 2 (Sanderson and Nixon 2015, The use of topology in fracture
!! network characterization, J. Struct. Geol. 72: C_B, there with d = 3 at Y and 4 at X).
!!
!! Parts of fractures are stated by arc lengths, which do not depend on the mesh.
module twolevel_reach
   use base_groups, only: groups_t, single_groups
   use base_kinds, only: ik, rk
   use mesh_types, only: fracture_mesh_t, point_tip
   implicit none(type, external)
   private

   public :: cluster_count, connections_per_branch, reached_cells, intervals_t

   !> Intervals of arc length on fractures, which neither touch nor overlap.
   type :: intervals_t
      integer(ik), allocatable :: fracture(:)
      real(rk), allocatable :: s(:, :)  !< (2, n) start and end [m]
   contains
      procedure :: clear
      procedure :: add
      procedure :: length
      procedure :: covers
   end type intervals_t

contains

   !> Cells that are connected with the start cells through cells that conduct.
   pure function reached_cells(fracture, starts, passes) result(reached)
      type(fracture_mesh_t), intent(in) :: fracture
      logical, intent(in) :: starts(:)  !< (cells) start cells; only those that conduct count
      logical, intent(in) :: passes(:)  !< (cells) cells that conduct
      logical :: reached(fracture%n_cells)
      logical :: is_reached(fracture%n_points)
      integer(ik), allocatable :: number(:)
      integer(ik) :: cell

      number = groups_of_points(fracture, passes)
      is_reached = .false.
      do cell = 1, fracture%n_cells
         if (.not. (starts(cell) .and. passes(cell))) cycle
         is_reached(number(fracture%cell_points(1, cell))) = .true.
      end do
      do cell = 1, fracture%n_cells
         reached(cell) = passes(cell) .and. is_reached(number(fracture%cell_points(1, cell)))
      end do
   end function reached_cells

   !> Number of connected groups of fractures.
   pure integer(ik) function cluster_count(fracture) result(n)
      type(fracture_mesh_t), intent(in) :: fracture
      logical :: all_pass(fracture%n_cells), is_met(fracture%n_points)
      integer(ik), allocatable :: number(:)
      integer(ik) :: cell

      all_pass = .true.
      number = groups_of_points(fracture, all_pass)
      is_met = .false.
      do cell = 1, fracture%n_cells
         is_met(number(fracture%cell_points(1, cell))) = .true.
      end do
      n = count(is_met, kind=ik)
   end function cluster_count

   !> Number of the group of each point; cells that conduct connect their points.
   pure function groups_of_points(fracture, passes) result(number)
      type(fracture_mesh_t), intent(in) :: fracture
      logical, intent(in) :: passes(:)  !< (cells) cells that conduct
      integer(ik), allocatable :: number(:)
      type(groups_t) :: groups
      integer(ik) :: cell

      groups = single_groups(fracture%n_points)
      do cell = 1, fracture%n_cells
         if (passes(cell)) call groups%join(fracture%cell_points(1, cell), &
                                            fracture%cell_points(2, cell))
      end do
      number = groups%numbers()
   end function groups_of_points

   !> Mean number of connected ends of a branch, C_B; 0 without branches [-].
   pure real(rk) function connections_per_branch(fracture) result(connections)
      type(fracture_mesh_t), intent(in) :: fracture
      integer(ik) :: connected, free, point

      connected = 0
      free = 0
      do point = 1, fracture%n_points
         if (fracture%point_kind(point) == point_tip) free = free + 1
         associate (n => fracture%point_cells%length(point))
            if (n >= 3) connected = connected + n
         end associate
      end do
      connections = 2.0_rk*real(connected, rk)/real(max(connected + free, 1_ik), rk)
   end function connections_per_branch

   !> Remove all intervals.
   pure subroutine clear(self)
      class(intervals_t), intent(inout) :: self

      self%fracture = [integer(ik) ::]
      self%s = reshape([real(rk) ::], [2, 0])
   end subroutine clear

   !> Add an interval, merged with the intervals that it touches or overlaps.
   pure subroutine add(self, fracture, s)
      class(intervals_t), intent(inout) :: self
      integer(ik), intent(in) :: fracture
      real(rk), intent(in) :: s(2)  !< start and end [m]; nothing is added unless start < end
      logical :: stays(size(self%fracture))
      real(rk) :: whole(2)
      integer(ik) :: i, n

      if (.not. s(1) < s(2)) return
      stays = self%fracture /= fracture .or. self%s(2, :) < s(1) .or. self%s(1, :) > s(2)
      whole = [min(s(1), minval(self%s(1, :), mask=.not. stays)), &
               max(s(2), maxval(self%s(2, :), mask=.not. stays))]
      n = count(stays)
      self%s = reshape([self%s(:, pack([(i, i=1, size(stays))], stays)), whole], [2, n + 1])
      self%fracture = [pack(self%fracture, stays), fracture]
   end subroutine add

   !> Total length [m].
   pure real(rk) function length(self)
      class(intervals_t), intent(in) :: self

      length = sum(self%s(2, :) - self%s(1, :))
   end function length

   !> Whether a point of a fracture lies in an interval.
   pure logical function covers(self, fracture, s)
      class(intervals_t), intent(in) :: self
      integer(ik), intent(in) :: fracture
      real(rk), intent(in) :: s  !< arc length [m]

      covers = any(self%fracture == fracture .and. self%s(1, :) <= s .and. s <= self%s(2, :))
   end function covers

end module twolevel_reach
