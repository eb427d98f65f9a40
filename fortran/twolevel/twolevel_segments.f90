!> Straight path segments of tips: how new segments begin, and how the last ones end.
!!
!! A segment that reaches a fracture or a side of the body ends on it. The coarse mesh contains the
!! joint from then on, but the crack ends at its tip, anywhere on the segment (coarse_tips), and no
!! fluid flows to the joint. A tip has no intensities at the joint itself, so a small ligament
!! remains at the end of the segment; its length decreases with the increments. If K_eq still
!! exceeds the toughness there, the ligament breaks: the crack joins the fracture or side at once,
!! and fluid flows to the joint. The place and time of a joint are therefore those at which the rock
!! in between breaks, independent of the nodes of the mesh.
!!
!! A segment that would not be longer than such a ligament consists of the ligament alone: the tip
!! stays, and joins the target once K_eq exceeds the toughness.
module twolevel_segments
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_plane, only: norm2, point_distance, turned
   use base_timers, only: timers_t
   use base_tolerances, only: same_place
   use coarse_state, only: go_back
   use growth_front, only: front_state_t
   use growth_rules, only: growth_rules_t
   use growth_network, only: end_gain, end_place, extend, move_end, straighten_end
   use growth_segment, only: segment_t
   use growth_targets, only: find_beside, target_boundary, target_none
   use growth_tip, only: tip_t
   use mesh_types, only: network_t
   use twolevel_levels_state, only: levels_state_t
   use twolevel_state, only: two_levels_t
   implicit none(type, external)
   private

   public :: are_at_ligaments, begin_segments, can_join, join_targets, shared_excesses

   !> Ligament at the end of the last path segment, over the length of the segment: it breaks at
   !! once where K_eq exceeds the toughness before it [-].
   real(rk), parameter :: ligament = 0.05_rk

contains

   !> Begin new segments for tips at the ends of their paths: find the directions in the tried
   !! state, return the coarse level to the state before the step, and add the new cells to its
   !! mesh.
   subroutine begin_segments(self, wants, timers, error)
      class(two_levels_t), intent(inout) :: self
      logical, intent(in) :: wants(:)  !< (tips)
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: centres(:, :)
      real(rk) :: ahead(2, size(self%tip))
      type(tip_t) :: tip(size(self%tip))
      logical, dimension(size(self%tip)) :: is_new, is_near
      logical, allocatable :: active(:)
      logical :: any_grew
      integer(ik) :: i

      self%now%segment%is_open = self%now%segment%is_open .and. .not. wants
      is_new = wants
      is_near = .false.
      do i = 1, size(self%tip, kind=ik)
         if (.not. wants(i)) cycle
         ahead(:, i) = way_ahead(self%tip(i), self%rules%increment_of(self%tip(i)%fracture))
         is_near(i) = is_at_ligament(self%now%coarse_network, self%rules, self%tip(i)%fracture, &
                                     self%tip(i)%xy, ahead(:, i))
         call self%tape%keep("is_near", is_near(i))
      end do
      tip = self%tip
      ! Only the directions of these tips are to be found.
      if (allocated(self%now%active)) active = self%now%active
      self%now%active = is_new
      call self%grow_by(merge(self%strides(), 0.0_rk, is_new .and. .not. is_near), any_grew, &
                        timers, error)
      if (allocated(error)) return
      deallocate (self%now%active)
      if (allocated(active)) call move_alloc(active, self%now%active)
      do i = 1, size(self%tip, kind=ik)
         if (.not. is_new(i)) cycle
         if (is_near(i)) then
            self%tip(i)%origin = self%tip(i)%xy
         else if (self%tip(i)%advance > 0.0_rk) then
            ahead(:, i) = self%tip(i)%direction
         else
            is_new(i) = .false.
         end if
      end do
      do i = 1, size(self%tip, kind=ik)
         if (.not. wants(i)) cycle
         call self%tape%keep("is_new", is_new(i))
         if (is_new(i)) call self%tape%keep("ahead", ahead(:, i))
      end do
      call end_segments(self%front_state_t, self%now, self%rules, self%start, tip, ahead, is_new, &
                        centres)
      call go_back(self%now%coarse, self%before)
      if (size(centres, 2) == 0) return
      call self%remesh_coarse(centres, timers, error)
      self%before = self%now%coarse
   end subroutine begin_segments

   !> Direction of a tip by the criterion in the present state, before the direction of a new
   !! segment is corrected.
   pure function way_ahead(tip, increment) result(direction)
      type(tip_t), intent(in) :: tip
      real(rk), intent(in) :: increment  !< [m]
      real(rk) :: direction(2)  !< unit vector
      type(tip_t) :: ahead
      real(rk) :: kink

      ahead = tip
      call ahead%predict_path(increment, kink)
      direction = turned(tip%direction, kink)
   end function way_ahead

   !> Whether only a ligament is left ahead of each tip.
   pure function are_at_ligaments(front, now, rules)
      type(front_state_t), intent(in) :: front
      type(levels_state_t), intent(in) :: now
      type(growth_rules_t), intent(in) :: rules
      logical :: are_at_ligaments(size(front%tip))
      integer(ik) :: i

      do i = 1, size(front%tip, kind=ik)
         associate (tip => front%tip(i), segment => now%segment(i))
            are_at_ligaments(i) = segment%stays()
            if (are_at_ligaments(i) .or. .not. tip%is_free .or. segment%is_open .or. &
                tip%path_target /= target_none) cycle
            if (.not. tip%drive%intensity > 0.5_rk*rules%toughness) cycle  ! whatever it is
            are_at_ligaments(i) = is_at_ligament(now%coarse_network, rules, tip%fracture, tip%xy, &
                                                 way_ahead(tip, rules%increment_of(tip%fracture)))
         end associate
      end do
   end function are_at_ligaments

   !> Whether the target straight ahead of a tip is no farther than a ligament.
   pure logical function is_at_ligament(network, rules, fracture, from, direction)
      type(network_t), intent(in) :: network
      type(growth_rules_t), intent(in) :: rules
      integer(ik), intent(in) :: fracture
      real(rk), intent(in) :: from(2)  !< [m]
      real(rk), intent(in) :: direction(2)  !< unit vector
      real(rk) :: at(2)
      integer(ik) :: target

      call rules%look_ahead(network, fracture, from, direction, target, at)
      is_at_ligament = target /= target_none .and. norm2(at - from) &
                       <= ligament*rules%increment_of(fracture)
   end function is_at_ligament

   !> Find the ends of new segments in their directions. Tips that are each other's targets meet
   !! half way, or at one of the two tips if these are no farther apart than a ligament.
   subroutine end_segments(front, now, rules, start, before, ahead, is_new, centres)
      type(front_state_t), intent(inout) :: front
      type(levels_state_t), intent(inout) :: now
      type(growth_rules_t), intent(in) :: rules
      type(network_t), intent(in) :: start  !< initial network
      type(tip_t), intent(in) :: before(:)  !< tips before their new segments
      real(rk), intent(in) :: ahead(:, :)  !< (2, tips) directions of the segments, unit vectors
      logical, intent(inout) :: is_new(:)  !< (tips)
      !> (2, n) points where the network changes [m]
      real(rk), allocatable, intent(out) :: centres(:, :)
      logical :: has_end(size(front%tip))
      real(rk) :: to(2, size(front%tip))
      integer(ik) :: i, j, target(size(front%tip))

      allocate (centres(2, 0))
      has_end = .false.
      do i = 1, size(front%tip, kind=ik)
         if (is_new(i)) call find_end(now%coarse_network, rules, front%tip(i), ahead(:, i), &
                                      target(i), to(:, i))
      end do
      do i = 1, size(front%tip, kind=ik)
         do j = 1, i - 1
            if (.not. (is_new(i) .and. is_new(j))) cycle
     associate (a => front%tip(i)%origin, b => front%tip(j)%origin, f => front%tip([i, j])%fracture)
               if (norm2(to(:, i) - b) > rules%near_of(f(1)) .or. &
                   norm2(to(:, j) - a) > rules%near_of(f(2))) cycle
               if (norm2(a - b) <= ligament*minval(rules%increment_of(f))) then
                  to(:, i) = b
                  is_new(j) = .false.
                  call remove_segment(front, before(j), j)
               else
                  to(:, i) = 0.5_rk*(a + b)
                  to(:, j) = to(:, i)
                  has_end(j) = .true.
               end if
               has_end(i) = .true.
            end associate
         end do
      end do
      do i = 1, size(front%tip, kind=ik)
         if (.not. is_new(i)) cycle
         ! Segments created in this loop may lie ahead of the tip.
         if (.not. has_end(i)) call find_end(now%coarse_network, rules, front%tip(i), &
                                             ahead(:, i), target(i), to(:, i))
         if (target(i) /= target_none .and. &
             norm2(to(:, i) - front%tip(i)%origin) &
             <= ligament*rules%increment_of(front%tip(i)%fracture)) then
            call remove_segment(front, before(i), i)
            front%tip(i)%path_target = target(i)
            front%tip(i)%origin = front%tip(i)%xy
            associate (way => to(:, i) - front%tip(i)%xy)  ! all of it is a ligament
               call now%segment(i)%open_segment(front%tip(i)%xy, way/norm2(way), norm2(way))
            end associate
            call now%segment(i)%stay_at_start()
         else
            front%tip(i)%path_target = target(i)
            call begin_segment(front, start, rules, i, to(:, i), now%segment(i))
         end if
         call extend(now%coarse_network, front%tip(i)%fracture, front%tip(i)%end, to(:, i))
         centres = reshape([centres, to(:, i)], [2, size(centres, 2) + 1])
      end do
   end subroutine end_segments

   !> Remove the new segment of a tip.
   subroutine remove_segment(front, before, i)
      type(front_state_t), intent(inout) :: front
      type(tip_t), intent(in) :: before  !< the tip before its new segment
      integer(ik), intent(in) :: i  !< tip

      associate (tip => front%tip(i), network => front%network)
         if (norm2(tip%xy - before%xy) > 0.0_rk) then
            call move_end(network, tip%fracture, tip%end, before%xy)
            call straighten_end(network, tip%fracture, tip%end, 1_ik)
         end if
         tip = before
      end associate
   end subroutine remove_segment

   !> Find the end and the target of the last segment of a tip.
   pure subroutine find_end(network, rules, tip, direction, target, to)
      type(network_t), intent(in) :: network
      type(growth_rules_t), intent(in) :: rules
      type(tip_t), intent(in) :: tip
      real(rk), intent(in) :: direction(2)  !< unit vector
      integer(ik), intent(out) :: target
      real(rk), intent(out) :: to(2)  !< [m]

      call rules%look_ahead(network, tip%fracture, tip%origin, direction, target, to, &
                            tip%stride)
      if (target /= target_none) return
      call find_beside(network, rules%outline, tip%fracture, tip%origin, tip%xy, &
                       rules%near_of(tip%fracture), target, to)
   end subroutine find_end

   !> Open a new segment from the end of the last one.
   pure subroutine begin_segment(front, start, rules, i, to, segment)
      type(front_state_t), intent(inout) :: front
      type(network_t), intent(in) :: start  !< initial network
      type(growth_rules_t), intent(in) :: rules
      integer(ik), intent(in) :: i  !< tip
      real(rk), intent(in) :: to(2)  !< end of the segment [m]
      type(segment_t), intent(inout) :: segment
      real(rk) :: gain  ! growth up to the start of the segment [m]

      associate (tip => front%tip(i))
         if (tip%path_target /= target_none) then
            tip%direction = (to - tip%origin)/norm2(to - tip%origin)
         end if
         call segment%open_segment(tip%origin, tip%direction, norm2(to - tip%origin))
         if (tip%path_target /= target_none) call segment%exclude_ligament(ligament)
         gain = end_gain(front%network, start, tip%fracture, tip%end) &
                - norm2(tip%xy - tip%origin)
         call segment%stop_after(rules%stop_gain - gain)
      end associate
   end subroutine begin_segment

   !> Whether each tip can join its target: only the ligament is left, and the target is a broken
   !! part of its fracture, a side of the body, or a tip that can join as well.
   pure function can_join(front, now, rules)
      type(front_state_t), intent(in) :: front
      type(levels_state_t), intent(in) :: now
      type(growth_rules_t), intent(in) :: rules
      logical :: can_join(size(front%tip))
      integer(ik) :: i, j

      do i = 1, size(front%tip, kind=ik)
         associate (tip => front%tip(i))
            can_join(i) = tip%is_free .and. tip%path_target /= target_none .and. &
                          (now%segment(i)%is_complete() .or. .not. now%segment(i)%is_open)
            if (.not. can_join(i) .or. tip%path_target == target_boundary) cycle
            can_join(i) = is_broken(front%network, tip%path_target, joint_of(now, tip), &
                                    same_place*rules%increment)
            do j = 1, size(front%tip, kind=ik)
               if (j /= i) can_join(i) = can_join(i) .or. meet(front, now, rules, i, j)
            end do
         end associate
      end do
   end function can_join

   !> Excess of K_eq over K_IC. Where the target of tip i is another tip j that does not advance,
   !! tip i has the larger of the two excesses, and tip j -1 [-].
   pure function shared_excesses(front, now, rules) result(excess)
      type(front_state_t), intent(in) :: front
      type(levels_state_t), intent(in) :: now
      type(growth_rules_t), intent(in) :: rules
      real(rk) :: excess(size(front%tip))
      integer(ik) :: i, j

      excess = front%tip%excess(rules%toughness)
      do j = 1, size(excess, kind=ik)
         do i = 1, size(excess, kind=ik)
            if (.not. comes_to(front, now, rules, i, j)) cycle
            excess(i) = max(excess(i), excess(j))
            excess(j) = -1.0_rk
            exit
         end do
      end do
   end function shared_excesses

   !> Whether the target of tip i is another tip j that does not advance. They share one ligament:
   !! if it breaks from either side, tip i joins, since tip j has no segment of its own.
   pure logical function comes_to(front, now, rules, i, j)
      type(front_state_t), intent(in) :: front
      type(levels_state_t), intent(in) :: now
      type(growth_rules_t), intent(in) :: rules
      integer(ik), intent(in) :: i, j

      comes_to = i /= j .and. all(front%tip([i, j])%is_free) .and. .not. now%segment(j)%is_open
      if (.not. comes_to) return
      associate (same => same_place*rules%increment, at => joint_of(now, front%tip(i)))
         comes_to = norm2(at - front%tip(j)%xy) <= same .and. norm2(at - front%tip(i)%xy) > same
      end associate
   end function comes_to

   !> Position of the target of a tip [m].
   pure function joint_of(now, tip) result(xy)
      type(levels_state_t), intent(in) :: now
      type(tip_t), intent(in) :: tip
      real(rk) :: xy(2)

      xy = end_place(now%coarse_network, tip%fracture, tip%end)
   end function joint_of

   !> Whether a point on the path of a fracture lies behind its tips.
   pure logical function is_broken(network, fracture, xy, same)
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: fracture
      real(rk), intent(in) :: xy(2)  !< [m]
      real(rk), intent(in) :: same  !< distance of equal places [m]
      integer(ik) :: v

      is_broken = .false.
      do v = network%first(fracture), network%first(fracture + 1) - 2
         is_broken = is_broken .or. point_distance(xy, network%xy(:, v:v + 1)) <= same
      end do
   end function is_broken

   !> Whether two tips have the same target, and only ligaments are left before both.
   pure logical function meet(front, now, rules, i, j)
      type(front_state_t), intent(in) :: front
      type(levels_state_t), intent(in) :: now
      type(growth_rules_t), intent(in) :: rules
      integer(ik), intent(in) :: i, j

      associate (tip => front%tip([i, j]), segment => now%segment([i, j]))
         meet = all(tip%is_free .and. tip%path_target /= target_none .and. &
                    (segment%is_complete() .or. .not. segment%is_open))
      end associate
      if (meet) meet = norm2(joint_of(now, front%tip(i)) - joint_of(now, front%tip(j))) &
                       <= same_place*rules%increment
   end function meet

   !> Break the ligaments of tips and connect them to their targets. A target may be another tip,
   !! whose path ends there too.
   subroutine join_targets(front, now, rules, joins)
      type(front_state_t), intent(inout) :: front
      type(levels_state_t), intent(inout) :: now
      type(growth_rules_t), intent(in) :: rules
      logical, intent(in) :: joins(:)  !< (tips)
      real(rk) :: xy(2)
      integer(ik) :: i, j

      do i = 1, size(joins, kind=ik)
         if (.not. joins(i)) cycle
         xy = joint_of(now, front%tip(i))
         do j = 1, size(joins, kind=ik)
            associate (tip => front%tip(j))
               if (j == i .or. meet(front, now, rules, i, j)) then
                  if (norm2(tip%xy - now%segment(j)%start) > 0.0_rk) then
                     call move_end(front%network, tip%fracture, tip%end, xy)
                  else
                     call extend(front%network, tip%fracture, tip%end, xy)
                  end if
                  call now%segment(j)%finish(xy)
                  tip%xy = xy
                  tip%target = tip%path_target
                  tip%joined = .true.
               else if (norm2(tip%xy - xy) > same_place*rules%increment) then
                  cycle
               end if
               call tip%deactivate()
               now%segment(j)%is_open = .false.
            end associate
         end do
      end do
   end subroutine join_targets

end module twolevel_segments
