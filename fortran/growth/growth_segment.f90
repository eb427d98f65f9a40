!> The last straight segment of the path of a tip, and the position of the tip along it.
module growth_segment
   use base_kinds, only: rk
   implicit none(type, external)
   private

   public :: segment_t, sliver

   !> A piece of a path. The tip goes from its start to its end; then the next one begins.
   type :: segment_t
      logical :: is_open = .false.  !< the tip is on its way along it
      logical, private :: is_rest = .false.  !< the tip does not go along it by itself
      real(rk) :: start(2) = 0.0_rk  !< [m]
      real(rk) :: direction(2) = 0.0_rk  !< unit vector
      real(rk) :: length = 0.0_rk  !< [m]
      real(rk), private :: shortest = 0.0_rk  !< that the tip may go along it [m]
      real(rk) :: reached = 0.0_rk  !< how far the tip is [m]
      real(rk) :: accepted = 0.0_rk  !< how far it was in the last accepted state [m]
      real(rk) :: gain = 0.0_rk  !< of the whole path, in that state [m]
      real(rk) :: slope = 0.0_rk  !< of the excess along it; 0: unknown [1/m]
      real(rk), private :: speed = 0.0_rk  !< of the tip in the last step [m/s]
   contains
      procedure :: open_segment
      procedure :: leave_rest
      procedure :: stop_after
      procedure :: stay_at_start
      procedure :: stays
      procedure :: finish
      procedure :: place
      procedure :: is_complete
      procedure :: restart
      procedure :: set_out
      procedure :: keep_pace
      procedure :: pace
      procedure :: falling_slope
      procedure :: go_to
      procedure, private :: within
      procedure :: lowest
      procedure :: keep_up_with
      procedure :: accept
   end type segment_t

   !> Share of a segment that a tip moves by at least: next to another fracture its excess has been
   !! seen to fall by 33 K_IC per segment, so that a thousandth is worth 3 % of it.
   real(rk), parameter :: closest = 1.0e-4_rk

   !> Share of a segment that is not left for the next step.
   real(rk), parameter :: sliver = 0.03_rk

   !> Share of a segment that a tip goes along at least: what the mesh around it can hold.
   real(rk), parameter :: least = 0.05_rk

contains

   !> Begin a piece from where a tip is.
   pure subroutine open_segment(self, start, direction, length)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: start(2)  !< [m]
      real(rk), intent(in) :: direction(2)  !< unit vector
      real(rk), intent(in) :: length  !< [m]

      self%is_open = .true.
      self%is_rest = .false.
      self%start = start
      self%direction = direction
      self%length = length
      self%shortest = least*length
      self%reached = self%shortest
      self%accepted = 0.0_rk
   end subroutine open_segment

   !> The tip is to go along a share of the piece only.
   elemental subroutine leave_rest(self, rest)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: rest  !< share that it does not go along by itself [-]

      self%length = (1.0_rk - rest)*self%length
      self%shortest = least*self%length
      self%reached = self%shortest
   end subroutine leave_rest

   !> The tip is to go along no more than a length of the piece, but as far as it has to.
   elemental subroutine stop_after(self, length)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: length  !< [m]

      self%length = max(self%shortest, min(self%length, length))
   end subroutine stop_after

   !> The tip does not go along the piece at all by itself.
   elemental subroutine stay_at_start(self)
      class(segment_t), intent(inout) :: self

      self%is_open = .false.
      self%is_rest = .true.
      self%reached = 0.0_rk
      self%slope = 0.0_rk
   end subroutine stay_at_start

   !> The tip is at the start of a piece that it does not go along.
   elemental logical function stays(self)
      class(segment_t), intent(in) :: self

      stays = self%is_rest
   end function stays

   !> The tip is where the piece ends, and will not go on from there.
   pure subroutine finish(self, end)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: end(2)  !< [m]

      self%length = norm2(end - self%start)
      self%reached = self%length
      self%is_open = .false.
      self%is_rest = .false.
   end subroutine finish

   !> Where the tip is [m].
   pure function place(self) result(xy)
      class(segment_t), intent(in) :: self
      real(rk) :: xy(2)

      xy = self%start + self%reached*self%direction
   end function place

   !> The tip has come to the end of the piece.
   elemental logical function is_complete(self)
      class(segment_t), intent(in) :: self

      is_complete = self%reached >= self%length
   end function is_complete

   !> Back to the last accepted state, for another try of the step.
   elemental subroutine restart(self)
      class(segment_t), intent(inout) :: self

      self%reached = self%lowest()
   end subroutine restart

   !> Begin a piece where its excess will probably vanish, by what the piece before has shown.
   elemental subroutine set_out(self, excess)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: excess  !< K_eq/K_IC - 1 at the start of the piece [-]

      if (.not. (self%is_open .and. self%slope < 0.0_rk)) return
      self%reached = self%within(-excess/self%slope)
   end subroutine set_out

   !> Begin a step where the tip comes if it goes on as fast as in the last one.
   elemental subroutine keep_pace(self, dt)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< length of the step [s]

      if (self%is_open) self%reached = self%within(self%lowest() + self%speed*dt)
   end subroutine keep_pace

   !> What an accepted step says of the tip's speed: nothing where the tip lies at the start of a
   !! piece that it has not been driven to.
   elemental subroutine pace(self, advance, dt, is_driven)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: advance  !< [m]
      real(rk), intent(in) :: dt  !< [s]; 0: what comes next has nothing to do with it
      logical, intent(in) :: is_driven  !< it is at its toughness

      self%speed = 0.0_rk
      if (dt > 0.0_rk .and. is_driven) self%speed = max(0.0_rk, advance)/dt
   end subroutine pace

   !> Slope of the excess, or a usual one where it is not known to fall [1/m].
   elemental real(rk) function falling_slope(self) result(slope)
      class(segment_t), intent(in) :: self

      slope = min(self%slope, -0.1_rk/self%length)
      if (self%slope < -0.01_rk/self%length) slope = self%slope
   end function falling_slope

   !> Go to a place, or to what is nearest to it of where the tip may be.
   pure subroutine go_to(self, wanted, has_moved)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: wanted  !< from the start of the piece [m]
      logical, intent(out) :: has_moved
      real(rk) :: to

      to = self%within(wanted)
      has_moved = abs(to - self%reached) > closest*self%length
      if (has_moved) self%reached = to
   end subroutine go_to

   !> What is nearest to a place of where the tip may be [m].
   elemental real(rk) function within(self, wanted)
      class(segment_t), intent(in) :: self
      real(rk), intent(in) :: wanted  !< from the start of the piece [m]

      within = min(self%length, max(self%lowest(), wanted))
      if (within > (1.0_rk - sliver)*self%length) within = self%length
   end function within

   !> How far back the tip may go [m].
   elemental real(rk) function lowest(self)
      class(segment_t), intent(in) :: self

      lowest = max(self%accepted, self%shortest)
   end function lowest

   !> Be as far along as another one, but never behind the last accepted state, and know of the
   !! excess what that knows.
   pure subroutine keep_up_with(self, other, has_moved)
      class(segment_t), intent(inout) :: self
      type(segment_t), intent(in) :: other
      logical, intent(out) :: has_moved

      call self%go_to(self%length*(other%reached/other%length), has_moved)
      self%slope = other%slope*(other%length/self%length)
   end subroutine keep_up_with

   !> The present place is that of an accepted state.
   elemental subroutine accept(self)
      class(segment_t), intent(inout) :: self

      self%accepted = self%reached
      if (self%is_open .and. self%is_complete()) self%is_open = .false.
   end subroutine accept

end module growth_segment
