!> The last straight segment of the path of a tip, and the position of the tip along it.
module growth_segment
   use base_kinds, only: rk
   use base_plane, only: norm2
   implicit none(type, external)
   private

   public :: segment_t, sliver

   !> Path segment. The tip advances from its start to its end; then the next segment begins.
   type :: segment_t
      logical :: is_open = .false.  !< the tip is between the start and the end of the segment
      !> the whole segment is a ligament, which breaks at once at the toughness
      logical, private :: is_ligament = .false.
      real(rk) :: start(2) = 0.0_rk  !< [m]
      real(rk) :: direction(2) = 0.0_rk  !< unit vector
      real(rk) :: length = 0.0_rk  !< [m]
      real(rk), private :: shortest = 0.0_rk  !< shortest advance of the tip along the segment [m]
      real(rk) :: reached = 0.0_rk  !< distance of the tip from the start [m]
      real(rk) :: accepted = 0.0_rk  !< distance in the last accepted state [m]
      real(rk) :: gain = 0.0_rk  !< growth of the whole path in the last accepted state [m]
      real(rk) :: slope = 0.0_rk  !< derivative of the excess along the segment; 0: unknown [1/m]
      real(rk), private :: speed = 0.0_rk  !< speed of the tip in the last step [m/s]
   contains
      procedure :: open_segment
      procedure :: exclude_ligament
      procedure :: stop_after
      procedure :: stay_at_start
      procedure :: stays
      procedure :: finish
      procedure :: place
      procedure :: is_complete
      procedure :: restart
      procedure :: set_out
      procedure :: set_out_to
      procedure :: farther
      procedure :: keep_pace
      procedure :: pace
      procedure :: falling_slope
      procedure :: go_to
      procedure, private :: within
      procedure :: lowest
      procedure :: keep_up_with
      procedure :: accept
   end type segment_t

   !> Shortest displacement of a tip, over the length of the segment: next to another fracture the
   !! excess has been seen to fall by 33 K_IC per segment, so that a thousandth is worth 3 % of K_IC
   !! [-].
   real(rk), parameter :: closest = 1.0e-4_rk

   !> Distance from the end within which the tip is put onto the end, over the length of the segment
   !! [-].
   real(rk), parameter :: sliver = 0.03_rk

   !> Shortest advance that the mesh around the tip resolves, over the length of the segment [-].
   real(rk), parameter :: least = 0.05_rk

contains

   !> Begin a segment at the position of a tip.
   pure subroutine open_segment(self, start, direction, length)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: start(2)  !< [m]
      real(rk), intent(in) :: direction(2)  !< unit vector
      real(rk), intent(in) :: length  !< [m]

      self%is_open = .true.
      self%is_ligament = .false.
      self%start = start
      self%direction = direction
      self%length = length
      self%shortest = least*length
      self%reached = self%shortest
      self%accepted = 0.0_rk
   end subroutine open_segment

   !> Exclude the ligament: the tip advances along the rest of the segment only.
   elemental subroutine exclude_ligament(self, ligament)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: ligament  !< ligament, over the length of the segment [-]

      self%length = (1.0_rk - ligament)*self%length
      self%shortest = least*self%length
      self%reached = self%shortest
   end subroutine exclude_ligament

   !> Limit the length of the segment, but not below the shortest advance.
   elemental subroutine stop_after(self, length)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: length  !< [m]

      self%length = max(self%shortest, min(self%length, length))
   end subroutine stop_after

   !> Keep the tip at the start: the whole segment is a ligament.
   elemental subroutine stay_at_start(self)
      class(segment_t), intent(inout) :: self

      self%is_open = .false.
      self%is_ligament = .true.
      self%reached = 0.0_rk
      self%slope = 0.0_rk
   end subroutine stay_at_start

   !> Whether the whole segment is a ligament.
   elemental logical function stays(self)
      class(segment_t), intent(in) :: self

      stays = self%is_ligament
   end function stays

   !> End the segment at the final position of the tip.
   pure subroutine finish(self, end)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: end(2)  !< [m]

      self%length = norm2(end - self%start)
      self%reached = self%length
      self%is_open = .false.
      self%is_ligament = .false.
   end subroutine finish

   !> Position of the tip [m].
   pure function place(self) result(xy)
      class(segment_t), intent(in) :: self
      real(rk) :: xy(2)

      xy = self%start + self%reached*self%direction
   end function place

   !> Whether the tip has reached the end of the segment.
   elemental logical function is_complete(self)
      class(segment_t), intent(in) :: self

      is_complete = self%reached >= self%length
   end function is_complete

   !> Return the tip to the last accepted state, for another try of the step.
   elemental subroutine restart(self)
      class(segment_t), intent(inout) :: self

      self%reached = self%lowest()
   end subroutine restart

   !> Put the tip where its excess is predicted to vanish, by the slope along the previous segment.
   elemental subroutine set_out(self, excess)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: excess  !< K_eq/K_IC - 1 at the start of the segment [-]

      if (.not. (self%is_open .and. self%slope < 0.0_rk)) return
      self%reached = self%within(-excess/self%slope)
   end subroutine set_out

   !> Distance by which the speed of the tip in the last step would take it farther in a step of
   !! length dt in which it has advanced so far [m].
   elemental real(rk) function farther(self, dt, advance)
      class(segment_t), intent(in) :: self
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: advance  !< [m]

      farther = self%speed*dt - advance
   end function farther

   !> Put the tip at a distance from the start of the segment, within the admissible range.
   elemental subroutine set_out_to(self, distance)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: distance  !< [m]

      if (self%is_open) self%reached = self%within(distance)
   end subroutine set_out_to

   !> Put the tip where its speed in the last step would take it.
   elemental subroutine keep_pace(self, dt)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< length of the step [s]

      if (self%is_open) self%reached = self%within(self%lowest() + self%speed*dt)
   end subroutine keep_pace

   !> Speed of the tip in an accepted step; 0 for a tip at the start of a segment that has not
   !! reached its toughness.
   elemental subroutine pace(self, advance, dt, is_driven)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: advance  !< [m]
      real(rk), intent(in) :: dt  !< length of the step; 0: the next step has other conditions [s]
      logical, intent(in) :: is_driven  !< the tip is at its toughness

      self%speed = 0.0_rk
      if (dt > 0.0_rk .and. is_driven) self%speed = max(0.0_rk, advance)/dt
   end subroutine pace

   !> Derivative of the excess along the segment, or a usual value where it is not known to be
   !! negative [1/m].
   elemental real(rk) function falling_slope(self) result(slope)
      class(segment_t), intent(in) :: self

      slope = min(self%slope, -0.1_rk/self%length)
      if (self%slope < -0.01_rk/self%length) slope = self%slope
   end function falling_slope

   !> Move the tip to a position, limited to the admissible range.
   pure subroutine go_to(self, wanted, has_moved)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: wanted  !< distance from the start of the segment [m]
      logical, intent(out) :: has_moved
      real(rk) :: to

      to = self%within(wanted)
      has_moved = abs(to - self%reached) > closest*self%length
      if (has_moved) self%reached = to
   end subroutine go_to

   !> Distance limited to the admissible range [m].
   elemental real(rk) function within(self, wanted)
      class(segment_t), intent(in) :: self
      real(rk), intent(in) :: wanted  !< distance from the start of the segment [m]

      within = min(self%length, max(self%lowest(), wanted))
      if (within > (1.0_rk - sliver)*self%length) within = self%length
   end function within

   !> Smallest admissible distance from the start [m].
   elemental real(rk) function lowest(self)
      class(segment_t), intent(in) :: self

      lowest = max(self%accepted, self%shortest)
   end function lowest

   !> Move the tip to the same share of its segment as another tip, but not behind the last
   !! accepted state, and take the slope of the other segment.
   pure subroutine keep_up_with(self, other, has_moved)
      class(segment_t), intent(inout) :: self
      type(segment_t), intent(in) :: other
      logical, intent(out) :: has_moved

      call self%go_to(self%length*(other%reached/other%length), has_moved)
      self%slope = other%slope*(other%length/self%length)
   end subroutine keep_up_with

   !> Accept the present position.
   elemental subroutine accept(self)
      class(segment_t), intent(inout) :: self

      self%accepted = self%reached
      if (self%is_open .and. self%is_complete()) self%is_open = .false.
   end subroutine accept

end module growth_segment
