!> Free tips of a network and their growth by one increment, for both levels: which tips grow, how
!! far, and in which direction.
!!
!! Each increment is one step of the growth law (growth_law). The tips first advance straight ahead
!! to predicted positions (growth_tip) and are evaluated there; their last segments are then rotated
!! until the direction criterion holds at the end of the increment.
module growth_front
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use base_tape, only: tape_t
   use base_timers, only: timers_t
   use base_tolerances, only: same_place, same_value
   use growth_increment, only: plan_increment, tips_at_onset
   use growth_law, only: new_tip
   use growth_network, only: end_gain, extend, move_end
   use growth_targets, only: find_target, target_none
   use growth_rules, only: foresight, growth_rules_t
   use growth_tip, only: tip_t
   use mesh_types, only: fracture_mesh_t, network_t
   implicit none(type, external)
   private

   public :: front_state_t, front_t

   !> State that growth changes: the network and the tips at its free ends.
   type :: front_state_t
      type(network_t) :: network  !< present network
      type(tip_t), allocatable :: tip(:)
   end type front_state_t

   !> Growth state together with the procedure that evaluates the tips.
   type, abstract, extends(front_state_t) :: front_t
      type(network_t) :: start  !< initial network, from the scene
      type(growth_rules_t) :: rules
      type(network_t) :: network_before  !< before the last increment
      type(tape_t) :: tape  !< decisions of the run
   contains
      procedure(evaluate_tips), deferred :: evaluate
      procedure :: find_tips
      procedure :: grow_tips
      procedure :: grow_by
      procedure :: has_gained
      procedure :: increments
      procedure :: strides
   end type front_t

   !> Share of the distance to the target at which the direction of the last path segment is
   !! evaluated [-].
   real(rk), parameter :: half_way = 0.5_rk

   !> Distance, in increments, below which a target is joined without an evaluation half way [-].
   real(rk), parameter :: no_room = 0.1_rk

   abstract interface
      !> Evaluate intensities, drives and rosette radii of all tips of the present network.
      subroutine evaluate_tips(self, timers, error)
         import :: error_t, front_t, timers_t
         implicit none(type, external)
         class(front_t), intent(inout) :: self
         type(timers_t), intent(inout) :: timers
         type(error_t), allocatable, intent(out) :: error
      end subroutine evaluate_tips
   end interface

contains

   !> Set the tips to the free tips of a mesh.
   pure subroutine find_tips(self, fracture)
      class(front_t), intent(inout) :: self
      type(fracture_mesh_t), intent(in) :: fracture
      integer(ik) :: i

      if (allocated(self%tip)) deallocate (self%tip)
      allocate (self%tip(fracture%n_tips))
      do i = 1, fracture%n_tips
         self%tip(i)%fracture = fracture%tip_fracture(i)
         self%tip(i)%end = fracture%tip_end(i)
         self%tip(i)%xy = fracture%point_xy(:, fracture%tip_point(i))
         self%tip(i)%direction = fracture%tip_direction(:, i)
      end do
   end subroutine find_tips

   !> l_max of each tip [m].
   pure function increments(self)
      class(front_t), intent(in) :: self
      real(rk) :: increments(size(self%tip))

      increments = self%rules%increment_of(self%tip%fracture)
   end function increments

   !> Length of the next segment of each tip where no target lies ahead [m].
   pure function strides(self)
      class(front_t), intent(in) :: self
      real(rk) :: strides(size(self%tip))
      real(rk), parameter :: longer = 2.0_rk  ! than the last one [-]

      strides = min(self%increments(), longer*min(self%tip%stride, self%increments()))
   end function strides

   !> One increment of the evaluated tips at their onset, by the law of advances.
   subroutine grow_tips(self, any_grew, timers, error)
      class(front_t), intent(inout) :: self
      logical, intent(out) :: any_grew
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: advance(size(self%tip))

      call plan_increment(self%tip, tips_at_onset(self%tip, self%rules%toughness, &
                                                  self%rules%together), &
                          self%increments(), self%rules%exponent, advance)
      call self%grow_by(advance, any_grew, timers, error)
   end subroutine grow_tips

   !> Grow evaluated tips by prescribed advances, and evaluates all tips at the new positions. With
   !! `joins` no tip grows beyond the prescribed gain `stop_gain`.
   subroutine grow_by(self, wanted, any_grew, timers, error)
      class(front_t), intent(inout) :: self
      real(rk), intent(in) :: wanted(:)  !< (tips) advances; 0: the tip does not grow [m]
      logical, intent(out) :: any_grew
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: corrections = 12
      logical :: any_joined, any_turned
      real(rk) :: advance(size(wanted))
      integer(ik) :: i, k

      advance = wanted
      if (self%rules%joins) advance = up_to_stop(wanted, self%rules%stop_gain - gains(self))
      call advance_tips(self, advance, any_grew)
      call self%tape%keep("grew", any_grew)
      if (.not. any_grew) return
      call keep_positions(self)
      call self%evaluate(timers, error)
      do k = 1, corrections
         if (allocated(error)) return
         call turn_tips(self, advance, any_turned)
         call self%tape%keep("turned", any_turned)
         if (.not. any_turned) exit
         call keep_positions(self)
         call self%evaluate(timers, error)
      end do
      if (allocated(error)) return
      do i = 1, size(self%tip, kind=ik)
         call self%tip(i)%commit(-self%tip(i)%intensity%k2, advance(i))
      end do
      call join_tips(self, advance, any_joined)
      if (any_joined) call self%evaluate(timers, error)
   end subroutine grow_by

   !> Record the positions of the tips that grow, or take them from the record.
   subroutine keep_positions(self)
      class(front_t), intent(inout) :: self
      real(rk) :: values(6)
      integer(ik) :: i

      do i = 1, size(self%tip, kind=ik)
         associate (tip => self%tip(i))
            if (.not. tip%advance > 0.0_rk) cycle
            values = [tip%xy, tip%direction, tip%kink, tip%advance]
            call self%tape%keep("tip", values)
            if (.not. self%tape%follows) cycle
            tip%xy = values(1:2)
            tip%direction = values(3:4)
            tip%kink = values(5)
            tip%advance = values(6)
            call move_end(self%network, tip%fracture, tip%end, tip%xy)
         end associate
      end do
   end subroutine keep_positions

   !> Growth of each tip where `stop_gain` is prescribed; else 0 [m].
   pure function gains(self)
      class(front_t), intent(in) :: self
      real(rk) :: gains(size(self%tip))
      integer(ik) :: i

      gains = 0.0_rk
      if (.not. self%rules%stop_gain < huge(1.0_rk)) return
      do i = 1, size(self%tip, kind=ik)
         gains(i) = end_gain(self%network, self%start, self%tip(i)%fracture, self%tip(i)%end)
      end do
   end function gains

   !> Whether each tip has grown by `stop_gain`.
   pure function has_gained(self)
      class(front_t), intent(in) :: self
      logical :: has_gained(size(self%tip))

      has_gained = gains(self) >= self%rules%stop_gain - same_place*self%rules%increment
   end function has_gained

   !> Advance limited to the growth that is left, but never shorter than the mesh resolves. Where
   !! the advance would leave too little for another increment, half of what is left is taken.
   elemental real(rk) function up_to_stop(advance, left)
      real(rk), intent(in) :: advance  !< [m]
      real(rk), intent(in) :: left  !< [m]
      real(rk), parameter :: least = 0.05_rk, sliver = 0.3_rk  ! of an advance

      up_to_stop = advance
      if (abs(left - advance) <= same_place*advance .or. left > (1.0_rk + sliver)*advance) return
      up_to_stop = 0.0_rk
      if (left > 0.0_rk) up_to_stop = max(least*advance, merge(0.5_rk*left, left, left > advance))
   end function up_to_stop

   !> Move the tips to their predicted positions.
   subroutine advance_tips(self, advance, any_grew)
      class(front_t), intent(inout) :: self
      real(rk), intent(in) :: advance(:)  !< (tips) [m]
      logical, intent(out) :: any_grew
      real(rk) :: kink, to(2)
      integer(ik) :: i

      any_grew = .false.
      self%network_before = self%network
      call self%tip%begin_increment()
      do i = 1, size(self%tip, kind=ik)
         if (.not. advance(i) > 0.0_rk .or. self%tip(i)%arrested) cycle
         associate (tip => self%tip(i))
            call tip%predict_path(advance(i), kink)
            to = new_tip(tip%xy, tip%direction, kink, advance(i))
            if (self%rules%heads) then
               call stop_half_way(self, i, (tip%xy), advance(i), to)
               if (self%rules%joins .and. &
                   norm2(to - tip%xy) < half_way*no_room*self%rules%increment_of(tip%fracture)) then
                  call join_at_once(self, i, to)
               end if
            else
               call meet_target(self%rules, self%network, tip, (tip%xy), to)
            end if
            if (tip%arrested .and. .not. tip%joined) cycle
            ! another path has already reached this tip
            if (.not. norm2(to - tip%xy) > same_value*advance(i)) cycle
            call extend(self%network, tip%fracture, tip%end, to)
            call tip%move(to, kink)
            any_grew = .true.
         end associate
      end do
   end subroutine advance_tips

   !> Rotate the last segment of each tip whose direction does not yet satisfy the criterion; halve
   !! it where it is too long.
   subroutine turn_tips(self, advance, any_turned)
      class(front_t), intent(inout) :: self
      real(rk), intent(inout) :: advance(:)  !< (tips) advances where no target lies ahead [m]
      logical, intent(out) :: any_turned
      logical :: has_turned
      real(rk) :: to(2)
      integer :: halvings
      integer(ik) :: i

      any_turned = .false.
      do i = 1, size(self%tip, kind=ik)
         associate (tip => self%tip(i))
            if (tip%arrested) cycle
            halvings = self%rules%halvings(tip)
            if (halvings > 0) then
               call tip%shorten(halvings)
               advance(i) = tip%advance
               call move_end(self%network, tip%fracture, tip%end, tip%xy)
               any_turned = .true.
               cycle
            end if
            if (.not. tip%certain_share() > 0.0_rk) cycle
            call tip%correct(tip%drive%angle, -tip%intensity%k2, has_turned)
            if (.not. has_turned) cycle
            to = tip%xy
            if (self%rules%heads) then
               call stop_half_way(self, i, (tip%origin), advance(i), to)
            else if (self%rules%joins) then
               call meet_target(self%rules, self%network, tip, (tip%origin), to)
            end if
            tip%xy = to
            tip%advance = norm2(tip%xy - tip%origin)
            call move_end(self%network, tip%fracture, tip%end, tip%xy)
            any_turned = .true.
         end associate
      end do
   end subroutine turn_tips

   !> Shorten the advance of a tip with a target ahead to half the distance to the target. Where
   !! tips join in the same increment, the network before the increment counts, so that the order of
   !! the tips does not matter; if the target is the former position of another tip, the advance
   !! ends half way to the meeting point.
   pure subroutine stop_half_way(self, i, from, advance, to)
      class(front_t), intent(in) :: self
      integer(ik), intent(in) :: i  !< tip
      real(rk), intent(in) :: from(2)  !< [m]
      real(rk), intent(in) :: advance  !< advance where no target lies ahead [m]
      real(rk), intent(inout) :: to(2)  !< end of the advance [m]
      real(rk) :: at(2), direction(2), room
      integer(ik) :: target

      direction = (to - from)/norm2(to - from)
      associate (fracture => self%tip(i)%fracture)
         if (self%rules%joins) then
            call self%rules%look_ahead(self%network_before, fracture, from, direction, target, at)
         else
            call self%rules%look_ahead(self%network, fracture, from, direction, target, at, &
                                       advance)
         end if
      end associate
      room = advance
      if (target /= target_none) room = min(room, half_way*norm2(at - from))
      if (self%rules%joins .and. is_left(self, target, at)) room = half_way*room
      if (abs(room - norm2(to - from)) > same_value*advance) to = from + room*direction
   end subroutine stop_half_way

   !> Whether a point is the position of a tip of the fracture before the increment.
   pure logical function is_left(self, fracture, at)
      class(front_t), intent(in) :: self
      integer(ik), intent(in) :: fracture
      real(rk), intent(in) :: at(2)  !< [m]
      integer :: k

      is_left = .false.
      do k = 1, size(self%tip)
         if (self%tip(k)%fracture /= fracture .or. self%tip(k)%arrested) cycle
         is_left = is_left .or. &
                   norm2(place_before(self%tip(k)) - at) <= same_place*self%rules%increment
      end do
   end function is_left

   !> Position of a tip before the increment [m].
   pure function place_before(tip) result(xy)
      type(tip_t), intent(in) :: tip
      real(rk) :: xy(2)

      xy = merge(tip%origin, tip%xy, tip%advance > 0.0_rk)
   end function place_before

   !> Join a target that is too near for an evaluation half way. The tip is deactivated, and so is
   !! the other tip if the target is a tip.
   subroutine join_at_once(self, i, to)
      class(front_t), intent(inout) :: self
      integer(ik), intent(in) :: i  !< tip
      real(rk), intent(inout) :: to(2)  !< end of the advance [m]
      real(rk) :: at(2), from(2)
      integer(ik) :: target
      integer :: k

      from = self%tip(i)%xy
      call self%rules%look_ahead(self%network_before, self%tip(i)%fracture, from, &
                                 (to - from)/norm2(to - from), target, at)
      to = at
      self%tip(i)%target = target
      self%tip(i)%joined = .true.
      call self%tip(i)%deactivate()
      do k = 1, size(self%tip)
         if (norm2(self%tip(k)%xy - at) <= same_place*self%rules%increment) then
            call self%tip(k)%deactivate()
         end if
      end do
   end subroutine join_at_once

   !> Extend the tips whose directions were evaluated half way straight to their targets in the
   !! network before the increment, so that the order of the tips does not matter. Two tips that are
   !! each other's targets meet half way. A tip that has joined is deactivated, and so is the other
   !! tip if the target is a tip.
   subroutine join_tips(self, advance, any_joined)
      class(front_t), intent(inout) :: self
      real(rk), intent(in) :: advance(:)  !< (tips) advances where no target lies ahead [m]
      logical, intent(out) :: any_joined
      real(rk), dimension(2, size(self%tip)) :: at, middle
      integer(ik) :: i, k, target(size(self%tip))

      any_joined = .false.
      if (.not. (self%rules%heads .and. self%rules%joins)) return
      do i = 1, size(self%tip, kind=ik)
         call find_joint(self, i, advance(i), target(i), at(:, i))
      end do
      middle = at
      do i = 1, size(self%tip, kind=ik)
         if (target(i) == target_none) cycle
         do k = 1, size(self%tip, kind=ik)
            if (k == i .or. .not. comes_to(i, k)) cycle
            if (comes_to(k, i)) then
               middle(:, i) = 0.5_rk*(self%tip(i)%origin + self%tip(k)%origin)
            else
               call self%tip(k)%deactivate()
            end if
         end do
      end do
      do i = 1, size(self%tip, kind=ik)
         if (target(i) == target_none) cycle
         any_joined = .true.
         associate (tip => self%tip(i))
            tip%target = target(i)
            tip%joined = .true.
            call tip%deactivate()
            tip%xy = middle(:, i)
            tip%advance = norm2(tip%xy - tip%origin)
            call move_end(self%network, tip%fracture, tip%end, tip%xy)
         end associate
      end do

   contains

      !> Whether the target of one tip is the position of another tip before the increment.
      pure logical function comes_to(tip, other)
         integer(ik), intent(in) :: tip, other

         comes_to = target(tip) == self%tip(other)%fracture .and. &
                    norm2(at(:, tip) - place_before(self%tip(other))) &
                    <= same_place*self%rules%increment
      end function comes_to

   end subroutine join_tips

   !> Target of a tip that has grown, if it is no more than half an increment beyond the full
   !! advance.
   pure subroutine find_joint(self, i, advance, target, at)
      class(front_t), intent(in) :: self
      integer(ik), intent(in) :: i  !< tip
      real(rk), intent(in) :: advance  !< advance where no target lies ahead [m]
      integer(ik), intent(out) :: target  !< fracture, or target_boundary or target_none
      real(rk), intent(out) :: at(2)  !< [m]

      target = target_none
      at = 0.0_rk
      associate (tip => self%tip(i))
         if (.not. tip%advance > 0.0_rk .or. tip%arrested) return
         call self%rules%look_ahead(self%network_before, tip%fracture, tip%origin, tip%direction, &
                                    target, at)
         if (norm2(at - tip%origin) > advance &
             + (foresight - 1.0_rk)*self%rules%increment_of(tip%fracture)) then
            target = target_none
         end if
      end associate
   end subroutine find_joint

   !> End the path of a tip that crosses another fracture or the boundary, or comes near one: the
   !! tip joins the target, or stops at its position.
   pure subroutine meet_target(rules, network, tip, from, to)
      type(growth_rules_t), intent(in) :: rules
      type(network_t), intent(in) :: network
      type(tip_t), intent(inout) :: tip
      real(rk), intent(in) :: from(2)  !< [m]
      !> end of the advance; point of connection where the tip joins [m]
      real(rk), intent(inout) :: to(2)
      real(rk) :: at(2)
      integer(ik) :: target

      call find_target(network, rules%outline, tip%fracture, from, to, rules%reach, target, at)
      if (target == target_none) return
      tip%arrested = .true.
      tip%joined = rules%joins
      tip%target = target
      if (tip%joined) to = at
   end subroutine meet_target

end module growth_front
