!> Parameters of growth, and what follows from them for a tip: the length of new path segments, and
!! how far the tip looks ahead.
module growth_rules
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_value
   use growth_targets, only: find_ahead
   use growth_tip, only: tip_t
   use mesh_types, only: network_t
   implicit none(type, external)
   private

   public :: foresight, growth_rules_t

   !> Parameters of growth.
   type :: growth_rules_t
      real(rk) :: toughness = 0.0_rk  !< K_IC [Pa m^1/2]
      real(rk) :: increment = 0.0_rk  !< l_max, the smallest of all fractures [m]
      real(rk), allocatable :: own_increment(:)  !< (fractures) [m]; unallocated: all the same
      !> Shortest new segment of a path, over the increment, and its length: longer ones are halved
      !! where they are too long for their direction [-], [m]
      real(rk) :: shortest = 1.0_rk, shortest_length = 0.0_rk
      real(rk) :: stop_gain = huge(1.0_rk)  !< growth of an end at which nothing goes on [m]
      real(rk) :: exponent = 0.0_rk  !< of the energy release rate in the law of advances [-]
      !> share of the toughness that a tip may lack to grow along with one at its onset [-]
      real(rk) :: together = 0.0_rk
      real(rk) :: reach = 0.0_rk  !< distance at which a tip counts as having reached a target [m]
      logical :: joins = .false.  !< a tip joins its target; else the tip stops before the target
      !> The path ends on the target straight ahead, however near: the direction of the last path
      !! segment is evaluated half way to the target. With `joins` the tip reaches the target in the
      !! same increment; else the caller makes the connection.
      logical :: heads = .false.
      real(rk) :: near = 0.0_rk  !< ends and kinks that near to its way lie on it [m]
      real(rk), allocatable :: own_near(:)  !< (fractures) [m]; unallocated: all the same
      real(rk), allocatable :: outline(:, :)  !< (2, n) corners of the body, in order [m]
   contains
      procedure :: increment_of
      procedure :: near_of
      procedure :: look_ahead
      procedure :: halvings
   end type growth_rules_t

   !> Distance to which targets ahead of a tip are found, in lengths of a new segment: the last path
   !! segment is up to 1.5 of these long, and no shorter than the remaining half [-].
   real(rk), parameter :: foresight = 1.5_rk

contains

   !> l_max of the tips of a fracture [m].
   elemental real(rk) function increment_of(self, fracture) result(increment)
      class(growth_rules_t), intent(in) :: self
      integer(ik), intent(in) :: fracture

      increment = self%increment
      if (allocated(self%own_increment)) increment = self%own_increment(fracture)
   end function increment_of

   !> Ends and kinks that near to the way of a fracture's tip lie on it [m].
   elemental real(rk) function near_of(self, fracture) result(near)
      class(growth_rules_t), intent(in) :: self
      integer(ik), intent(in) :: fracture

      near = self%near
      if (allocated(self%own_near)) near = self%own_near(fracture)
   end function near_of

   !> How often a new segment is to be halved where the path turns; 0: it is not too long. It is too
   !! long where K_eq at its end is far below the toughness, so that the tip will reach this end
   !! under other loads, or the end is shut, and any direction satisfies the criterion there. So is
   !! the first segment of a fracture's end, whose direction is not corrected, if it should turn
   !! farther at its end. K_eq is taken to fall with the root of the length, as that of a wing which
   !! sliding opens. A shut end says nothing of that: two at most.
   pure integer function halvings(self, tip)
      class(growth_rules_t), intent(in) :: self
      type(tip_t), intent(in) :: tip
      real(rk), parameter :: turns = 0.1_rk  ! first kink [rad]
      real(rk), parameter :: turns_farther = 0.8_rk  ! kink angle of the criterion [rad]
      real(rk), parameter :: far = 0.5_rk  ! K_eq at the end, over that of growth [-]
      integer, parameter :: most_shut = 2
      logical :: is_too_long
      real(rk) :: least, length, wanted

      wanted = far*min(self%toughness, tip%drive_before%intensity)
      is_too_long = tip%drive%intensity <= wanted
      if (tip%has_wing) then
         is_too_long = is_too_long .and. abs(tip%drive_before%angle) > turns_farther
      else
         is_too_long = abs(tip%kink) > turns .and. &
                       (is_too_long .or. abs(tip%drive%angle) > turns_farther)
      end if
      halvings = 0
      if (.not. (is_too_long .and. tip%advance > 0.0_rk)) return
      least = (1.0_rk - same_value)*max(self%shortest_length, &
                                        self%shortest*self%increment_of(tip%fracture))
      length = tip%advance
      do while (0.5_rk*length > least)
         length = 0.5_rk*length
         halvings = halvings + 1
         if (.not. tip%drive%intensity > 0.0_rk .and. halvings == most_shut) exit
         if (tip%drive%intensity**2*tip%advance > wanted**2*0.5_rk*length) exit
      end do
   end function halvings

   !> Target straight ahead of a tip.
   pure subroutine look_ahead(self, network, fracture, from, direction, target, at, stride)
      class(growth_rules_t), intent(in) :: self
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: fracture  !< number of the growing fracture
      real(rk), intent(in) :: from(2)  !< [m]
      real(rk), intent(in) :: direction(2)  !< unit vector
      integer(ik), intent(out) :: target  !< fracture, or target_boundary or target_none
      real(rk), intent(out) :: at(2)  !< [m]
      !> length of the segment where no target lies ahead; default: the increment [m]
      real(rk), intent(in), optional :: stride
      real(rk) :: length

      length = self%increment_of(fracture)
      if (present(stride)) length = min(length, stride)
      call find_ahead(network, self%outline, fracture, from, foresight*length*direction, &
                      self%near_of(fracture), target, at)
   end subroutine look_ahead

end module growth_rules
