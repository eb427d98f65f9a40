!> The straight pieces that the paths of tips consist of: how new ones begin, and how the last ones
!! end.
!!
!! A piece whose way comes to a fracture or to a side of the body ends on it. The coarse mesh has
!! the joint from then on, but the crack ends at its tip, wherever that is (coarse_tips), and
!! nothing flows to the joint. A tip has no intensities at the joint itself: a small rest of the
!! piece, which shrinks with the increments, is left. Where K_eq exceeds the toughness there still,
!! the rest fails: the crack joins what it has come to, at once, and fluid flows there. So a joint
!! is made where and when the rock in between has failed, wherever the nodes of the mesh are.
module twolevel_pieces
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_plane, only: point_distance
   use base_timers, only: timers_t
   use base_tolerances, only: same_place
   use growth_network, only: end_place, extend, move_end
   use growth_targets, only: target_boundary, target_none
   use twolevel_state, only: two_levels_t
   implicit none(type, external)
   private

   public :: begin_pieces, can_join, join_targets

   !> Share of the last piece that fails at once where the tip exceeds its toughness before it.
   real(rk), parameter :: rest = 0.05_rk

contains

   !> New pieces for tips, which stand at the ends of their paths: their directions are found in the
   !! tried state; then the coarse level, back in the state before the step, gets their cells.
   subroutine begin_pieces(self, wants, timers, error)
      class(two_levels_t), intent(inout) :: self
      logical, intent(in) :: wants(:)  !< (tips)
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: centres(:, :)
      real(rk) :: to(2)
      logical :: any_grew, is_new(size(self%tip))
      integer(ik) :: i

      self%segment%is_open = self%segment%is_open .and. .not. wants
      is_new = wants
      do i = 1, size(self%tip, kind=ik)
         if (.not. wants(i)) cycle
         associate (tip => self%tip(i))
            to = end_place(self%coarse_network, tip%fracture, tip%end)
            is_new(i) = .not. norm2(to - tip%xy) > same_place*self%rules%increment
            if (is_new(i)) cycle
            ! An earlier try of this step has begun it, and its path has learned from that.
            tip = self%begun(i)
            call extend(self%network, tip%fracture, tip%end, to)
            call open_piece(self, i, to)
         end associate
      end do
      if (.not. any(is_new)) then
         self%state = self%before
         return
      end if
      call self%grow_by(merge(self%rules%increment, 0.0_rk, is_new), any_grew, timers, error)
      if (allocated(error)) return
      is_new = is_new .and. self%tip%advance > 0.0_rk
      call end_pieces(self, is_new, centres)
      self%state = self%before
      if (size(centres, 2) == 0) return
      call self%remesh_coarse(centres, timers, error)
      self%before = self%state
      self%has_new_mesh = .true.
   end subroutine begin_pieces

   !> Where new pieces end, in the directions that have been found. Tips that head for each other
   !! meet half way.
   subroutine end_pieces(self, is_new, centres)
      class(two_levels_t), intent(inout) :: self
      logical, intent(in) :: is_new(:)  !< (tips)
      real(rk), allocatable, intent(out) :: centres(:, :)  !< (2, n) where the network changes [m]
      logical :: has_end(size(self%tip))
      real(rk) :: to(2, size(self%tip))
      integer(ik) :: i, j, target(size(self%tip))

      allocate (centres(2, 0))
      has_end = .false.
      do i = 1, size(self%tip, kind=ik)
         if (is_new(i)) call find_end(self, i, target(i), to(:, i))
      end do
      do i = 1, size(self%tip, kind=ik)
         do j = 1, i - 1
            if (.not. (is_new(i) .and. is_new(j))) cycle
            if (norm2(to(:, i) - self%tip(j)%origin) > self%rules%near .or. &
                norm2(to(:, j) - self%tip(i)%origin) > self%rules%near) cycle
            to(:, i) = 0.5_rk*(self%tip(i)%origin + self%tip(j)%origin)
            to(:, j) = to(:, i)
            has_end([i, j]) = .true.
         end do
      end do
      do i = 1, size(self%tip, kind=ik)
         if (.not. is_new(i)) cycle
         ! Pieces that have just been made may lie ahead of it.
         if (.not. has_end(i)) call find_end(self, i, target(i), to(:, i))
         associate (tip => self%tip(i))
            tip%heads_for = target(i)
            call open_piece(self, i, to(:, i))
            self%begun(i) = tip
            call extend(self%coarse_network, tip%fracture, tip%end, to(:, i))
         end associate
         centres = reshape([centres, to(:, i)], [2, size(centres, 2) + 1])
      end do
   end subroutine end_pieces

   !> Where the last piece of a tip ends, and on what.
   pure subroutine find_end(self, i, target, to)
      class(two_levels_t), intent(in) :: self
      integer(ik), intent(in) :: i  !< tip
      integer(ik), intent(out) :: target
      real(rk), intent(out) :: to(2)  !< [m]

      associate (tip => self%tip(i))
         call self%look_ahead(self%coarse_network, tip%fracture, tip%origin, tip%direction, &
                              target, to)
         if (target == target_none) to = tip%xy
      end associate
   end subroutine find_end

   !> Let a tip go along a piece from where its last one has ended.
   pure subroutine open_piece(self, i, to)
      class(two_levels_t), intent(inout) :: self
      integer(ik), intent(in) :: i  !< tip
      real(rk), intent(in) :: to(2)  !< where it ends [m]

      associate (tip => self%tip(i), segment => self%segment(i))
         if (tip%heads_for /= target_none) tip%direction = (to - tip%origin)/norm2(to - tip%origin)
         call segment%open_segment(tip%origin, tip%direction, norm2(to - tip%origin))
         if (tip%heads_for /= target_none) call segment%leave_rest(rest)
      end associate
   end subroutine open_piece

   !> Tips that have come so near to what they head for that only the rest has to fail, where that
   !! is broken itself.
   pure function can_join(self)
      class(two_levels_t), intent(in) :: self
      logical :: can_join(size(self%tip))
      integer(ik) :: i, j

      do i = 1, size(self%tip, kind=ik)
         associate (tip => self%tip(i))
            can_join(i) = tip%is_free .and. tip%heads_for /= target_none .and. &
                          (self%segment(i)%is_complete() .or. .not. self%segment(i)%is_open)
            if (.not. can_join(i) .or. tip%heads_for == target_boundary) cycle
            can_join(i) = is_broken(self, tip%heads_for, joint_of(self, i))
            do j = 1, size(self%tip, kind=ik)
               if (j /= i) can_join(i) = can_join(i) .or. meet(self, i, j)
            end do
         end associate
      end do
   end function can_join

   !> The place that a tip heads for [m].
   pure function joint_of(self, i) result(xy)
      class(two_levels_t), intent(in) :: self
      integer(ik), intent(in) :: i  !< tip
      real(rk) :: xy(2)

      xy = end_place(self%coarse_network, self%tip(i)%fracture, self%tip(i)%end)
   end function joint_of

   !> A place on the path of a fracture lies behind its tips.
   pure logical function is_broken(self, fracture, xy)
      class(two_levels_t), intent(in) :: self
      integer(ik), intent(in) :: fracture
      real(rk), intent(in) :: xy(2)  !< [m]
      integer(ik) :: v

      is_broken = .false.
      associate (network => self%network)
         do v = network%first(fracture), network%first(fracture + 1) - 2
            is_broken = is_broken .or. point_distance(xy, network%xy(:, v:v + 1)) &
                        <= same_place*self%rules%increment
         end do
      end associate
   end function is_broken

   !> Two tips head for one place and have both come near to it.
   pure logical function meet(self, i, j)
      class(two_levels_t), intent(in) :: self
      integer(ik), intent(in) :: i, j

      meet = all(self%tip([i, j])%is_free .and. self%tip([i, j])%heads_for /= target_none .and. &
                 (self%segment([i, j])%is_complete() .or. .not. self%segment([i, j])%is_open))
      if (meet) meet = norm2(joint_of(self, i) - joint_of(self, j)) &
                       <= same_place*self%rules%increment
   end function meet

   !> The rests of some pieces fail. What a tip comes to may be another one, which ends there too.
   subroutine join_targets(self, joins)
      class(two_levels_t), intent(inout) :: self
      logical, intent(in) :: joins(:)  !< (tips)
      real(rk) :: xy(2)
      integer(ik) :: i, j

      do i = 1, size(joins, kind=ik)
         if (.not. joins(i)) cycle
         xy = joint_of(self, i)
         do j = 1, size(joins, kind=ik)
            associate (tip => self%tip(j))
               if (j == i .or. meet(self, i, j)) then
                  call move_end(self%network, tip%fracture, tip%end, xy)
                  call self%segment(j)%finish(xy)
                  tip%xy = xy
                  tip%target = tip%heads_for
                  tip%joined = .true.
               else if (norm2(tip%xy - xy) > same_place*self%rules%increment) then
                  cycle
               end if
               call tip%cease()
               self%segment(j)%is_open = .false.
            end associate
         end do
      end do
   end subroutine join_targets

end module twolevel_pieces
