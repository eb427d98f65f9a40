!> The straight piece that the path of a tip ends with, and how far along it the tip is.
module growth_segment
   use base_kinds, only: rk
   implicit none(type, external)
   private

   public :: segment_t

   !> Between which places the excess vanishes, as the tries of a step have shown.
   type :: bracket_t
      real(rk) :: near = -1.0_rk  !< the tip exceeds its toughness here; negative: nowhere [m]
      real(rk) :: far = -1.0_rk  !< and is below it here; negative: nowhere [m]
      real(rk) :: width = huge(1.0_rk)  !< between them, when it was halved last [m]
      integer :: slow = 0  !< tries since
      integer :: tries = 0
   end type bracket_t

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
      ! Excess of the tip over its toughness, relative to that, at the last two tries of a step.
      real(rk), private :: tried(2) = 0.0_rk  !< [m]
      real(rk), private :: excess(2) = 0.0_rk  !< [-]
      integer, private :: tries = 0
      type(bracket_t), private :: bracket
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
      procedure, private :: forget_tries
      procedure :: set_out
      procedure :: keep_pace
      procedure :: pace
      procedure :: improve
      procedure :: learn
      procedure :: steep
      procedure :: go_to
      procedure, private :: narrow
      procedure, private :: next_place
      procedure, private :: within
      procedure :: is_at_rest
      procedure :: lowest
      procedure :: keep_up_with
      procedure :: accept
   end type segment_t

   !> Share of a segment that a tip moves by at least: next to another fracture its excess has been
   !! seen to fall by 33 K_IC per segment, so that a thousandth is worth 3 % of it.
   real(rk), parameter :: closest = 1.0e-4_rk

   !> Tries without a place on either side after which a tip goes to the ends of its way instead of
   !! where secants lead, and with both after which the way between them is halved instead.
   integer, parameter :: secants_max = 8, slow_max = 2

   !> Tries of a step after which a tip only goes on: what it finds changes, because others move.
   integer, parameter :: tries_max = 60

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
      call self%forget_tries()
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
      call self%forget_tries()
   end subroutine restart

   !> What the tries of a step have shown holds for no other one, but for the slope.
   elemental subroutine forget_tries(self)
      class(segment_t), intent(inout) :: self

      self%tries = 0
      self%bracket = bracket_t()
   end subroutine forget_tries

   !> Begin a piece where its excess will probably vanish, by what the piece before has shown.
   elemental subroutine set_out(self, excess)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: excess  !< K_eq/K_IC - 1 at the start of the piece [-]

      if (.not. (self%is_open .and. self%slope < 0.0_rk)) return
      self%reached = self%within(-excess/self%steep(self%slope))
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

   !> Go where the excess probably vanishes: back no farther than the last accepted state, and on no
   !! farther than the end of the piece. Secants find the place, held between a place where the tip
   !! exceeds its toughness and one beyond where it does not, once there are such. Where the excess
   !! falls suddenly, the tip comes to rest beyond that: it cannot where it exceeds its toughness.
   pure subroutine improve(self, excess, tolerance, has_moved)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: excess  !< K_eq/K_IC - 1 where the tip is [-]
      real(rk), intent(in) :: tolerance  !< on that [-]
      logical, intent(out) :: has_moved

      has_moved = .false.
      call self%learn(excess)
      if (abs(excess) <= tolerance) return
      call self%narrow(excess)
      call self%go_to(self%next_place(excess), has_moved)
   end subroutine improve

   !> The place of the tip becomes an end of the bracket.
   elemental subroutine narrow(self, excess)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: excess  !< K_eq/K_IC - 1 where the tip is [-]

      associate (bracket => self%bracket)
         bracket%tries = bracket%tries + 1
         ! An end that contradicts the present try is out of date: others have moved since.
         if (excess > 0.0_rk) then
            bracket%near = self%reached
            if (bracket%far <= bracket%near) bracket%far = -1.0_rk
         else
            bracket%far = self%reached
            if (bracket%near >= bracket%far) bracket%near = -1.0_rk
         end if
         bracket%slow = bracket%slow + 1
         if (min(bracket%near, bracket%far) < 0.0_rk) then
            bracket%width = huge(1.0_rk)
         else if (bracket%far - bracket%near <= 0.5_rk*bracket%width) then
            bracket%width = bracket%far - bracket%near
            bracket%slow = 0
         end if
      end associate
   end subroutine narrow

   !> Where the tip is tried to be next, within the bracket and so that this is halved time and
   !! again [m].
   elemental real(rk) function next_place(self, excess) result(to)
      class(segment_t), intent(in) :: self
      real(rk), intent(in) :: excess  !< K_eq/K_IC - 1 where the tip is [-]

      to = self%reached - excess/self%steep(self%slope)
      associate (bracket => self%bracket, least => 2.0_rk*closest*self%length)
         if (excess > 0.0_rk) to = max(to, self%reached + least)
         if (bracket%tries > tries_max) then
            to = merge(0.5_rk*(self%reached + self%length), self%reached, excess > 0.0_rk)
         else if (min(bracket%near, bracket%far) < 0.0_rk) then
            if (bracket%tries <= secants_max) return
            to = merge(0.5_rk*(self%reached + self%length), self%lowest(), excess > 0.0_rk)
         else if (bracket%far - bracket%near <= least) then
            to = bracket%far
         else
            if (to <= bracket%near .or. to >= bracket%far .or. bracket%slow >= slow_max) then
               to = 0.5_rk*(bracket%near + bracket%far)
            end if
         end if
      end associate
   end function next_place

   !> Keep the excess where the tip is, and how it changes along the piece.
   pure subroutine learn(self, excess)
      class(segment_t), intent(inout) :: self
      real(rk), intent(in) :: excess  !< K_eq/K_IC - 1 [-]
      real(rk) :: slope

      self%tried(1) = self%tried(2)
      self%excess(1) = self%excess(2)
      self%tried(2) = self%reached
      self%excess(2) = excess
      self%tries = self%tries + 1
      if (self%tries > 1 .and. abs(self%tried(2) - self%tried(1)) > 1.0e-3_rk*self%length) then
         slope = (self%excess(2) - self%excess(1))/(self%tried(2) - self%tried(1))
         if (slope < 0.0_rk) self%slope = slope
      end if
   end subroutine learn

   !> A slope of the excess, or a usual one where it does not fall enough for a tip to come to rest
   !! [1/m].
   elemental real(rk) function steep(self, slope)
      class(segment_t), intent(in) :: self
      real(rk), intent(in) :: slope  !< [1/m]

      steep = slope
      associate (usual => -0.5_rk/self%length)
         if (.not. slope < 0.02_rk*usual) steep = 0.2_rk*usual
      end associate
   end function steep

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
      if (within > 0.97_rk*self%length) within = self%length  ! no sliver is left for the next step
   end function within

   !> The tip is where it has to be, or as far as the piece lets it.
   elemental logical function is_at_rest(self, excess, tolerance)
      class(segment_t), intent(in) :: self
      real(rk), intent(in) :: excess, tolerance  !< of K_eq over K_IC [-]

      if (excess > tolerance) then
         is_at_rest = self%is_complete()
      else if (excess < -tolerance) then
         is_at_rest = self%reached <= self%lowest()
      else
         is_at_rest = .true.
      end if
   end function is_at_rest

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
      self%tried = self%length*(other%tried/other%length)
      self%excess = other%excess
      self%tries = other%tries
      self%slope = other%slope*(other%length/self%length)
   end subroutine keep_up_with

   !> The present place is that of an accepted state.
   elemental subroutine accept(self)
      class(segment_t), intent(inout) :: self

      self%accepted = self%reached
      call self%forget_tries()
      if (self%is_open .and. self%is_complete()) self%is_open = .false.
   end subroutine accept

end module growth_segment
