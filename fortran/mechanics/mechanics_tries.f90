!> The tries of one increment of growth: tips, their path segments and their advances. Each try
!! begins from the state before the increment. Also growth without an equilibrium load factor,
!! driven by loads that do not change with the load factor.
module mechanics_tries
   use base_archive, only: archive_t
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use base_timers, only: timers_t
   use base_tolerances, only: same_place
   use growth_archive, only: visit_segments, visit_tips
   use growth_competition, only: likes
   use growth_network, only: end_gain, extend, move_end
   use growth_segment, only: segment_t
   use growth_tip, only: tip_t
   use mechanics_balance, only: tolerance
   use mechanics_state, only: loaded_body_t, together
   use mesh_archive, only: visit_network
   use mesh_types, only: network_t
   implicit none(type, external)
   private

   public :: least, run_loosely, tries_t

   !> Fractions of a new path segment: the smallest advance that a mesh can resolve; and the advance
   !! from which on the segment ends at an accepted state, so that its remainder is not too short
   !! [-].
   real(rk), parameter :: least = 0.05_rk, whole = 0.5_rk

   !> Tips on their path segments, and the state before the increment.
   type :: tries_t
      type(segment_t), allocatable :: segment(:)  !< (tips)
      type(segment_t), allocatable :: segment_before(:)  !< (tips)
      type(network_t) :: network_before
      type(tip_t), allocatable :: tip_before(:)
      real(rk) :: longest = 0.0_rk  !< largest advance [m]
      integer(ik), allocatable :: tip_group(:)  !< (tips) first tip of the tip group of each
   contains
      procedure :: begin
      procedure :: go_back
      procedure :: begin_segments
      procedure :: remaining_lengths
      procedure :: place
      procedure :: keep_paths
      procedure :: find_tip_groups
      procedure :: with_tip_groups
      procedure :: split_groups
      procedure :: finish
      procedure :: visit
   end type tries_t

contains

   !> Keep the present state, whose tips have been evaluated, as the state before the increment.
   pure subroutine begin(self, body)
      class(tries_t), intent(inout) :: self
      class(loaded_body_t), intent(in) :: body

      if (.not. allocated(self%segment)) allocate (self%segment(size(body%tip)))
      self%network_before = body%network
      self%tip_before = body%tip
      self%segment_before = self%segment
   end subroutine begin

   !> Restore the network and the evaluated tips of the state before the increment.
   pure subroutine go_back(self, body)
      class(tries_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body

      body%network = self%network_before
      body%tip = self%tip_before
      self%segment = self%segment_before
   end subroutine go_back

   !> Begin new path segments of the tips of a group that are at the ends of theirs, in the
   !! direction in which the criterion holds at the ends of the new ones. All tips are evaluated
   !! there.
   subroutine begin_segments(self, body, group, timers, error)
      class(tries_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      integer(ik), intent(in) :: group(:)  !< tips
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: advance(size(body%tip))
      logical :: any_grew
      integer(ik) :: i, k

      advance = 0.0_rk
      do k = 1, size(group, kind=ik)
         i = group(k)
         if (.not. self%segment(i)%is_open) advance(i) = self%longest
      end do
      if (.not. any(advance > 0.0_rk)) return
      call body%grow_by(advance, any_grew, timers, error)
      if (allocated(error)) return
      do i = 1, size(body%tip, kind=ik)
         associate (tip => body%tip(i), segment => self%segment(i))
            if (.not. (advance(i) > 0.0_rk .and. tip%advance > 0.0_rk)) cycle
            call segment%open_segment(tip%origin, tip%direction, norm2(tip%xy - tip%origin))
            segment%reached = segment%length
         end associate
      end do
   end subroutine begin_segments

   !> Largest possible advances of the tips of a group on their segments.
   pure function remaining_lengths(self, group) result(remaining)
      class(tries_t), intent(in) :: self
      integer(ik), intent(in) :: group(:)  !< tips
      real(rk) :: remaining(size(group))  !< [m]

      remaining = min(self%longest, self%segment(group)%length - self%segment(group)%accepted)
   end function remaining_lengths

   !> Place the tips of a group on their path segments. Tips that do not advance have no new
   !! segment.
   pure subroutine place(self, body, group, advance, begun)
      class(tries_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      integer(ik), intent(in) :: group(:)  !< tips
      real(rk), intent(in) :: advance(:)  !< (group) [m]
      type(tip_t), intent(in) :: begun(:)  !< (all tips) tips at the ends of new segments
      integer(ik) :: k

      body%network = self%network_before
      do k = 1, size(group, kind=ik)
         associate (tip => body%tip(group(k)), segment => self%segment(group(k)))
            tip = begun(group(k))
            segment%reached = segment%accepted + advance(k)
            if (.not. segment%reached > 0.0_rk) then
               tip%xy = self%tip_before(group(k))%xy
               cycle
            end if
            tip%xy = segment%place()
            tip%direction = segment%direction
            if (segment%accepted > 0.0_rk) then
               call move_end(body%network, tip%fracture, tip%end, tip%xy)
            else
               call extend(body%network, tip%fracture, tip%end, tip%xy)
            end if
         end associate
      end do
   end subroutine place

   !> Restore the paths of tips that have not advanced on their new segments.
   pure subroutine keep_paths(self, body, group, advance)
      class(tries_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      integer(ik), intent(in) :: group(:)  !< tips
      real(rk), intent(in) :: advance(:)  !< (group) [m]
      type(tip_t) :: stood
      integer(ik) :: i, k

      do k = 1, size(group, kind=ik)
         i = group(k)
         if (self%segment(i)%accepted + advance(k) > 0.0_rk) cycle
         stood = self%tip_before(i)
         stood%intensity = body%tip(i)%intensity
         stood%drive = body%tip(i)%drive
         stood%is_free = body%tip(i)%is_free
         stood%arrested = body%tip(i)%arrested
         body%tip(i) = stood
         self%segment(i) = self%segment_before(i)
      end do
   end subroutine keep_paths

   !> Find the tip groups: tips of equal growth so far whose intensities differ by less than their
   !! errors.
   pure subroutine find_tip_groups(self, body)
      class(tries_t), intent(inout) :: self
      class(loaded_body_t), intent(in) :: body
      real(rk), parameter :: same_gain = 1.0e-2_rk  ! difference of growth over an increment
      logical :: alike(size(body%tip), size(body%tip))
      real(rk) :: gain(size(body%tip)), scale
      integer(ik) :: i

      do i = 1, size(body%tip, kind=ik)
         associate (tip => self%tip_before(i))
            gain(i) = end_gain(self%network_before, body%start, tip%fracture, tip%end)
         end associate
      end do
      associate (drive => self%tip_before%drive%intensity)
         scale = maxval(drive, mask=.not. self%tip_before%arrested)
         do i = 1, size(body%tip, kind=ik)
            alike(:, i) = abs(gain - gain(i)) <= same_gain*body%rules%increment
            alike(:, i) = alike(:, i) .and. abs(drive - drive(i)) <= scale &
                          *merge(tolerance, together, min(gain, gain(i)) > 0.0_rk)
         end do
      end associate
      self%tip_group = likes(alike)
   end subroutine find_tip_groups

   !> The given tips and all others of their tip groups.
   pure function with_tip_groups(self, group) result(larger)
      class(tries_t), intent(in) :: self
      integer(ik), intent(in) :: group(:)  !< tips
      integer(ik), allocatable :: larger(:)
      integer(ik) :: i

      associate (of => self%tip_group, n => size(self%tip_group, kind=ik))
         larger = pack([(i, i=1, n)],.not. self%tip_before%arrested .and. &
                       [(any(of(group) == of(i)), i=1, n)])
      end associate
   end function with_tip_groups

   !> Divide tip groups in which tips differ into single tips.
   pure subroutine split_groups(self, group, differs)
      class(tries_t), intent(inout) :: self
      integer(ik), intent(in) :: group(:)  !< tips
      logical, intent(in) :: differs(:)  !< (group) the tip differs from others of its tip group
      integer(ik), allocatable :: divided(:)
      integer(ik) :: i

      divided = self%tip_group(pack(group, differs))
      do i = 1, size(self%tip_group, kind=ik)
         if (any(divided == self%tip_group(i))) self%tip_group(i) = i
      end do
   end subroutine split_groups

   !> Accept the last try: set the advances of the tips and the state of their segments.
   subroutine finish(self, body)
      class(tries_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      real(rk) :: share
      integer(ik) :: i

      do i = 1, size(body%tip, kind=ik)
         associate (tip => body%tip(i), segment => self%segment(i))
            tip%advance = end_gain(body%network, body%start, tip%fracture, tip%end) &
                          - end_gain(self%network_before, body%start, tip%fracture, tip%end)
            if (tip%advance < same_place*body%rules%increment) tip%advance = 0.0_rk
            if (self%segment_before(i)%is_open) tip%kink = 0.0_rk  ! a straight continuation
            segment%accepted = segment%reached
            ! The last segment before the end of growth is not divided.
            share = whole
            if (end_gain(body%network, body%start, tip%fracture, tip%end) + segment%length &
                - segment%reached > (1.0_rk - same_place)*body%rules%stop_gain) share = 1.0_rk
            if (segment%reached >= share*segment%length .or. tip%arrested) segment%is_open = .false.
         end associate
      end do
   end subroutine finish

   !> Let the tips of a group, for which no load gives an equilibrium, advance at the same load to
   !! the ends of their segments or until K_eq has fallen to K_IC.
   subroutine run_loosely(tries, body, group, timers, error)
      type(tries_t), intent(inout) :: tries
      class(loaded_body_t), intent(inout) :: body
      integer(ik), intent(in) :: group(:)  !< tips
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: most_tries = 30
      type(tip_t) :: begun(size(body%tip))
      real(rk) :: excess, excess_high, excess_low, high, low, lowest, remaining(size(group)), share
      logical :: is_placed
      integer :: try

      begun = body%tip
      remaining = tries%remaining_lengths(group)
      is_placed = all(.not. tries%segment_before(group)%is_open)
      associate (shortest => least*body%rules%increment - tries%segment_before(group)%accepted)
         lowest = maxval(max(shortest, 0.0_rk)/remaining)
      end associate
      low = 0.0_rk
      excess_low = maxval(tries%tip_before(group)%drive%intensity)/body%rules%toughness - 1.0_rk
      high = 1.0_rk
      excess_high = 0.0_rk
      share = 1.0_rk
      do try = 1, most_tries
         if (.not. (is_placed .and. try == 1)) then
            call tries%place(body, group, share*remaining, begun)
            call body%evaluate(timers, error)
            if (allocated(error)) return
         end if
         excess = maxval(body%tip(group)%drive%intensity)/body%rules%toughness - 1.0_rk
         if (try == 1 .and. excess >= 0.0_rk) exit
         if (abs(excess) <= 0.5_rk*tolerance) exit
         if (excess > 0.0_rk) then
            low = share
            excess_low = excess
         else
            high = share
            excess_high = excess
         end if
         if (high <= lowest) exit
         share = low + (high - low)*merge(0.5_rk, excess_low/(excess_low - excess_high), &
                                          mod(try, 3) == 0)
         share = max(share, lowest)
      end do
      call tries%keep_paths(body, group, share*remaining)
   end subroutine run_loosely

   !> Store or load all components.
   subroutine visit(self, archive)
      class(tries_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive

      call visit_segments(archive, "segment", self%segment)
      call visit_segments(archive, "segment_before", self%segment_before)
      call visit_network(archive, "network_before", self%network_before)
      call visit_tips(archive, "tip_before", self%tip_before)
      call archive%item("longest", self%longest)
      call archive%list("tip_group", self%tip_group, "tips ?")
   end subroutine visit

end module mechanics_tries
