!> Length control: advances of a tip group and the load factor that belongs to them. One tip, the
!! leader, advances to the end of its segment at the load that keeps it at its toughness; the other
!! tips are in equilibrium at that load (growth_advances).
!!
!! With K_i + sum_j M_ij da_j + c_i df for small changes, the leader L eliminates the load factor:
!! the matrix of the other tips is M_ij - c_i/c_L M_Lj, and their excess at the leader's load is
!! excess_i - c_i/c_L excess_L.
module growth_control
   use base_kinds, only: ik, rk
   use growth_advances, only: advances_t
   implicit none(type, external)
   private

   public :: fitted, joined_groups, length_control_t

   !> State of the iteration for the advances of a group.
   type :: length_control_t
      real(rk) :: tolerance = 0.0_rk  !< tolerance of the excess [-]
      integer, private :: leader = 0  !< 0: not chosen yet
      integer, allocatable, private :: others(:)
      type(advances_t), private :: advances  !< search for the advances of `others`
   contains
      procedure :: improve
      procedure, private :: choose_leader
   end type length_control_t

contains

   !> Next estimate of the advances, from the excess at the present advances and a load at which no
   !! tip exceeds its toughness. The tips may be groups of equal tips. `has_moved` is false where
   !! all tips are in equilibrium within the tolerance.
   subroutine improve(self, excess, matrix, slope, room, shortest, advance, has_moved)
      class(length_control_t), intent(inout) :: self
      real(rk), intent(in) :: excess(:)  !< (tips) K_eq/K_IC - 1 [-]
      real(rk), intent(in) :: matrix(:, :)  !< first estimate of M, over K_IC [1/m]
      real(rk), intent(in) :: slope(:)  !< c, over K_IC [-]
      real(rk), intent(in) :: room(:)  !< distances to the ends of the segments [m]
      real(rk), intent(in) :: shortest(:)  !< shortest advances that the mesh resolves [m]
      real(rk), intent(inout) :: advance(:)  !< [m]
      logical, intent(out) :: has_moved
      real(rk), dimension(size(excess)) :: at_leader, before, share
      real(rk), allocatable :: reduced(:, :)
      integer :: i

      before = advance
      call self%choose_leader(excess, slope, room, advance)
      share = share_of_load(slope, self%leader)
      at_leader = excess - share*excess(self%leader)
      if (self%advances%evaluations == 0) then
         associate (others => self%others)
            reduced = matrix(others, others)
            do i = 1, size(others)
               reduced(i, :) = reduced(i, :) - share(others(i))*matrix(self%leader, others)
            end do
            call self%advances%begin(0.0_rk*room(others), room(others), advance(others), reduced)
         end associate
      end if
      call self%advances%improve(at_leader(self%others), self%tolerance, has_moved)
      if (.not. has_moved) return
      where (self%advances%place < shortest(self%others))
         self%advances%place = merge(shortest(self%others), 0.0_rk, &
                                     self%advances%place > 0.5_rk*shortest(self%others))
      end where
      advance(self%others) = self%advances%place
      has_moved = any(abs(advance - before) > 0.0_rk)
   end subroutine improve

   !> The leader is the tip that has reached the end of its segment; of several such tips, the one
   !! that needs the least load.
   subroutine choose_leader(self, excess, slope, room, advance)
      class(length_control_t), intent(inout) :: self
      real(rk), intent(in) :: excess(:), slope(:), room(:)
      real(rk), intent(inout) :: advance(:)
      integer :: i, leader

      leader = maxloc(excess/max(slope, tiny(1.0_rk)), mask=advance >= room, dim=1)
      if (leader == 0) leader = maxloc(advance/room, dim=1)
      if (leader == self%leader) return
      self%leader = leader
      advance(leader) = room(leader)
      self%others = pack([(i, i=1, size(excess))], [(i /= leader, i=1, size(excess))])
      self%advances = advances_t()
   end subroutine choose_leader

   !> c_i/c_L; 1 where the load does not drive the leader.
   pure function share_of_load(slope, leader) result(share)
      real(rk), intent(in) :: slope(:)
      integer, intent(in) :: leader
      real(rk) :: share(size(slope))

      share = 1.0_rk
      if (slope(leader) > 0.0_rk) share = slope/slope(leader)
   end function share_of_load

   !> Advances scaled so that the first tip reaches the end of its segment. Advances too short for
   !! the mesh, or so short that the intensities hardly change, are set to zero.
   pure function fitted(advance, room, accepted, shortest) result(fit)
      real(rk), intent(in) :: advance(:), room(:), accepted(:)  !< [m]
      real(rk), intent(in) :: shortest  !< shortest segment that the mesh resolves [m]
      real(rk) :: fit(size(advance))
      real(rk), parameter :: negligible = 1.0e-3_rk  ! share of `room` [-]

      fit = room
      if (.not. maxval(advance/room) > 0.0_rk) return
      fit = advance/maxval(advance/room)
      where (accepted + fit < shortest .or. fit < negligible*room) fit = 0.0_rk
      where (fit > 0.999_rk*room) fit = room
   end function fitted

   !> Union of two groups of tips, in ascending order.
   pure function joined_groups(a, b) result(group)
      integer(ik), intent(in) :: a(:), b(:)
      integer(ik), allocatable :: group(:)
      integer(ik) :: i

      group = pack([(i, i=1, max(maxval(a), maxval(b)))], &
                   [(any(a == i) .or. any(b == i), i=1, max(maxval(a), maxval(b)))])
   end function joined_groups

end module growth_control
