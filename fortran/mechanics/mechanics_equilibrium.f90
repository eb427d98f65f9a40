!> Growth as equilibrium in a body without a fluid (model.md section 5): from one accepted state to
!! the next, each tip has either not advanced and K_eq <= K_IC, or advanced so far that K_eq = K_IC.
!!
!! Length is controlled: one tip of those at their toughness goes to the end of its piece, the load
!! factor is that which the longer network bears (mechanics_balance), and the other tips go as far
!! as they have to for K_eq = K_IC at that load (growth_competition). The load may fall on the way:
!! a load that rises again gets to the same networks.
module mechanics_equilibrium
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use base_tolerances, only: same_place
   use growth_competition, only: learn_from_trial, preference
   use growth_control, only: better_advances, fitted, joined_groups
   use growth_kinds, only: likes, matrix_of_kinds, means, numbered, of_kinds
   use growth_network, only: end_gain, extend, move_end
   use growth_segment, only: segment_t
   use growth_tip, only: tip_t
   use mechanics_balance, only: balance_load
   use mechanics_state, only: loaded_body_t
   use mesh_types, only: network_t
   implicit none(type, external)
   private

   public :: increment_t, together

   !> Share of the toughness that tips may lack to begin an increment together with the first: about
   !! the error of the intensities, so that equal tips stay equal.
   real(rk), parameter :: together = 2.0e-3_rk

   real(rk), parameter :: tolerance = 5.0e-3_rk  !< on 1 - K_eq/K_IC of tips that have advanced [-]

   !> Shares of a new piece: what the mesh around a tip can hold at least; from where on the piece
   !! may end at an accepted state, so that none is left that is too short; how far a tip is set
   !! back to see how the intensities depend on its place.
   real(rk), parameter :: least = 0.05_rk, whole = 0.5_rk, probe = 0.4_rk

   !> What has been learnt about competing tips holds for so many increments.
   real(rk), parameter :: learnt_for = 8.0_rk

   !> One increment of growth, and what the next one can use of it.
   type :: increment_t
      type(segment_t), allocatable :: segment(:)  !< (tips)
      logical :: has_grown = .false.
      logical :: holds = .false.  !< tips are at their toughness still, at the present load
      logical :: is_loose = .false.  !< no load factor holds them: K_eq > K_IC
      logical :: prefers_one = .false.  !< that one of the tips grow alone, in this group
      real(rk) :: preference = 0.0_rk  !< that of the group, per increment, over K_IC [-]
      real(rk) :: misfit = 0.0_rk  !< largest 1 - K_eq/K_IC of a tip that has advanced [-]
      real(rk) :: advance_sum = 0.0_rk  !< of all tips [m]
      integer(ik), allocatable :: group(:)  !< tips that were at their toughness together
      ! What the matrix of growth_competition was found for, and since when.
      integer(ik), allocatable, private :: known_group(:)
      real(rk), allocatable, private :: matrix(:, :)  !< dK_i/da_j [Pa m^-1/2]
      real(rk), private :: known_since = 0.0_rk  !< increments ago
      real(rk), private :: started = 0.0_rk  !< load factor of the state before [-]
      real(rk), allocatable, private :: pace(:)  !< (tips) the last advance over the largest [-]
      ! The state before, from which each try begins.
      type(network_t), private :: network
      type(tip_t), allocatable, private :: tip(:)
      type(segment_t), allocatable, private :: segment_before(:)
      integer(ik), allocatable, private :: alike(:)  !< (tips) the first one that is like each
   contains
      procedure :: take
   end type increment_t

contains

   !> Grow by one increment, from a state whose tips have been evaluated. Where the tips need more
   !! than the limit of the load they go as far as that drives them.
   subroutine take(self, body, limit, timers, error)
      class(increment_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      real(rk), intent(in) :: limit  !< the largest load factor [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: i, attempt, attempts
      logical :: is_done, has_joined
      integer(ik), allocatable :: group(:)

      if (.not. allocated(self%segment)) then
         allocate (self%segment(size(body%tip)), self%pace(size(body%tip)))
         self%pace = 1.0_rk
      end if
      call body%accept()
      call body%body%remember()
      body%is_trying = .true.
      self%network = body%network
      self%tip = body%tip
      self%segment_before = self%segment
      self%started = body%factor
      self%has_grown = .false.
      self%misfit = 0.0_rk
      self%alike = first_alike(self, body)
      group = with_their_like(self, leading_tips(body, together))
      attempts = 3_ik*size(body%tip, kind=ik)
      do attempt = 1, attempts
         is_done = .false.
         call go_back(self, body)
         if (size(group) == 0) exit
         call begin_pieces(self, body, group, timers, error)
         if (allocated(error)) exit
         has_joined = any(body%tip(group)%joined)
         if (has_joined .and. .not. all(body%tip(group)%joined)) then
            group = pack(group, body%tip(group)%joined)  ! these leap, the others wait
            cycle
         else if (.not. all(self%segment(group)%is_open)) then
            ! Something has come to a tip: there it ends.
            body%tip(pack(group,.not. self%segment(group)%is_open))%arrested = .true.
            self%tip%arrested = self%tip%arrested .or. body%tip%arrested
            group = pack(group, self%segment(group)%is_open)
            cycle
         end if
         if (has_joined) then
            call settle_load(self, body, limit, timers, error)
            is_done = .true.
         else
            call find_advances(self, body, limit, attempt == attempts, group, timers, is_done, &
                               error)
         end if
         if (allocated(error) .or. is_done) exit
      end do
      body%is_trying = .false.
      body%meshed_vertices = size(body%network%xy, 2)
      if (allocated(error)) return
      self%group = group
      self%has_grown = size(group) > 0
      if (.not. self%has_grown) self%holds = .false.
      do i = 1, size(body%tip, kind=ik)
         associate (tip => body%tip(i), segment => self%segment(i))
            tip%advance = end_gain(body%network, body%start, tip%fracture, tip%end) &
                          - end_gain(self%network, body%start, tip%fracture, tip%end)
            if (tip%advance < same_place*body%rules%increment) tip%advance = 0.0_rk
            if (self%segment_before(i)%is_open) tip%kink = 0.0_rk  ! it went straight on
            segment%accepted = segment%reached
            if (segment%reached >= whole*segment%length .or. tip%arrested) segment%is_open = .false.
         end associate
      end do
      self%advance_sum = sum(body%tip%advance)
      if (self%has_grown) then
         self%pace = body%tip%advance/maxval(body%tip%advance)
         self%known_since = self%known_since + maxval(body%tip%advance)/body%rules%increment
      end if
   end subroutine take

   !> The tips whose K_eq lacks at most a share of the largest.
   pure function leading_tips(body, share) result(group)
      class(loaded_body_t), intent(in) :: body
      real(rk), intent(in) :: share  !< [-]
      integer(ik), allocatable :: group(:)
      integer(ik) :: i
      logical :: leads(size(body%tip))

      leads = .not. body%tip%arrested .and. body%tip%drive%intensity > 0.0_rk
      if (any(leads)) leads = leads .and. body%tip%drive%intensity >= (1.0_rk - share) &
                              *maxval(body%tip%drive%intensity, mask=leads)
      group = pack([(i, i=1, size(body%tip, kind=ik))], leads)
   end function leading_tips

   !> Back to the network before; its tips know what drives them there.
   pure subroutine go_back(self, body)
      class(increment_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body

      body%network = self%network
      body%tip = self%tip
      self%segment = self%segment_before
   end subroutine go_back

   !> New pieces for the tips of a group that stand at the ends of theirs, in the direction in which
   !! the criterion holds at their ends. All tips are evaluated there.
   subroutine begin_pieces(self, body, group, timers, error)
      class(increment_t), intent(inout) :: self
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
         if (.not. self%segment(i)%is_open) advance(i) = body%rules%increment
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
   end subroutine begin_pieces

   !> The load at the present network. Where it has no need to fall, as after a joint, it stays.
   subroutine settle_load(self, body, limit, timers, error)
      class(increment_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      real(rk), intent(in) :: limit  !< the largest load factor [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: slope(size(body%tip))

      self%holds = .false.
      self%is_loose = .false.
      if (.not. body%largest_excess() >= 0.0_rk) return
      call balance_load(body, self%started, limit, timers, self%holds, self%is_loose, slope, &
                        error)
   end subroutine settle_load

   !> How far the tips of a group go. Not done: another group has to be tried.
   subroutine find_advances(self, body, limit, is_last, group, timers, is_done, error)
      class(increment_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      real(rk), intent(in) :: limit  !< the largest load factor [-]
      logical, intent(in) :: is_last  !< no other group is tried
      integer(ik), allocatable, intent(inout) :: group(:)  !< tips
      type(timers_t), intent(inout) :: timers
      logical, intent(out) :: is_done
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: tries = 15
      type(tip_t) :: begun(size(body%tip))
      integer(ik) :: kind(size(group))
      real(rk), dimension(size(group)) :: advance, before, intensity, lack, last_intensity, room
      real(rk) :: slope(size(body%tip)), share, share_held, share_missed, factor_before
      logical :: is_placed
      integer :: try

      is_done = .false.
      begun = body%tip
      kind = numbered(self%alike(group))
      room = self%segment(group)%length - self%segment(group)%accepted
      is_placed = all(.not. self%segment_before(group)%is_open)  ! at the ends of new pieces
      advance = fitted(merge(self%pace(group), 1.0_rk, self%pace(group) > 0.0_rk), room, &
                       self%segment(group)%accepted, least*body%rules%increment)
      share = 1.0_rk
      share_held = 0.0_rk
      share_missed = 1.0_rk
      if (size(group) == 1) self%prefers_one = .false.
      if (size(group) > 1 .and. .not. knows(self, group)) then
         call probe_group(self, body, group, begun, limit, is_placed, timers, lack, slope, error)
         if (allocated(error)) return
         is_placed = .false.
         if (.not. self%prefers_one .and. &
             maxval(means(kind, lack)) > tolerance*body%rules%toughness) then
            advance = room
            call correct(self, body, group, kind, lack, slope, room, advance)
         end if
      end if
      do try = 1, tries
         if (.not. (is_placed .and. all(advance >= room))) then
            call place(self, body, group, share*advance, begun)
            call body%evaluate(timers, error)
            if (allocated(error)) return
         end if
         is_placed = .false.
         factor_before = body%factor
         call balance_load(body, self%started, limit, timers, self%holds, self%is_loose, slope, &
                           error)
         if (allocated(error)) return
         intensity = body%tip(group)%drive%intensity
         lack = needed_intensity(body) - intensity
         if (try > 1 .and. size(group) > 1) then
            call learn_from_trial(self%matrix, share*advance - before, intensity - last_intensity &
                                  - slope(group)*(body%factor - factor_before))
         end if
         last_intensity = intensity
         before = share*advance
         if (.not. self%holds) then
            if (body%largest_excess() >= -tolerance) exit
            ! The limit of the load does not drive them so far.
            share_missed = share
            share = 0.5_rk*(share_held + share_missed)
            if (share*maxval(advance) < least*body%rules%increment) exit
            cycle
         else if (share < 1.0_rk) then
            exit
         end if
         if (.not. is_last) then
            if (minval(lack) > tolerance*body%rules%toughness) then
               ! Another tip is ahead of all of the group.
               group = joined_groups(group, with_their_like(self, leading_tips(body, together)))
               return
            else if (maxval(abs(lack - means(kind, lack))) > tolerance*body%rules%toughness) then
               self%alike = [(int(try, ik), try=1, size(body%tip))]  ! they are not alike
               return
            end if
         end if
         if (maxval(merge(means(kind, lack), 0.0_rk, advance > 0.0_rk)) &
             <= tolerance*body%rules%toughness) exit
         if (self%prefers_one .and. .not. is_last) then
            group = pack(group, means(kind, lack) <= tolerance*body%rules%toughness)
            return
         end if
         call correct(self, body, group, kind, lack, slope, room, advance)
         if (all(abs(advance - before) <= 1.0e-3_rk*room)) exit
      end do
      self%misfit = maxval(merge(lack, 0.0_rk, advance > 0.0_rk))/body%rules%toughness
      is_done = .true.
      call keep_paths(self, body, group, share*advance)
   end subroutine find_advances

   !> What tips that grow have: K_IC, or where nothing holds them the largest K_eq [Pa m^1/2].
   pure real(rk) function needed_intensity(body)
      class(loaded_body_t), intent(in) :: body

      needed_intensity = body%rules%toughness*(1.0_rk + max(0.0_rk, body%largest_excess()))
   end function needed_intensity

   !> What has been found for a group holds for it still.
   pure logical function knows(self, group)
      class(increment_t), intent(in) :: self
      integer(ik), intent(in) :: group(:)  !< tips

      knows = .false.
      if (.not. allocated(self%known_group)) return
      if (size(group) /= size(self%known_group)) return
      knows = all(group == self%known_group) .and. self%known_since < learnt_for
   end function knows

   !> How the intensities of a group depend on the places of its tips: from the ends of their pieces
   !! one after the other is set back.
   subroutine probe_group(self, body, group, begun, limit, is_placed, timers, lack, slope, error)
      class(increment_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      integer(ik), intent(in) :: group(:)  !< tips
      type(tip_t), intent(in) :: begun(:)  !< all tips, at the ends of new pieces
      real(rk), intent(in) :: limit  !< the largest load factor [-]
      logical, intent(in) :: is_placed  !< there they have been evaluated
      type(timers_t), intent(inout) :: timers
      real(rk), intent(out) :: lack(:)  !< (group) K_IC - K_eq at the ends of the pieces [Pa m^1/2]
      real(rk), intent(out) :: slope(:)  !< (tips) dK_eq/df there [Pa m^1/2]
      type(error_t), allocatable, intent(out) :: error
      real(rk), dimension(size(group)) :: advance, intensity, room
      integer(ik) :: kind(size(group))
      integer :: j

      room = self%segment(group)%length - self%segment(group)%accepted
      if (.not. is_placed) then
         call place(self, body, group, room, begun)
         call body%evaluate(timers, error)
         if (allocated(error)) return
      end if
      call balance_load(body, self%started, limit, timers, self%holds, self%is_loose, slope, &
                        error)
      if (allocated(error)) return
      intensity = body%tip(group)%drive%intensity
      lack = needed_intensity(body) - intensity
      self%known_group = group
      self%known_since = 0.0_rk
      if (allocated(self%matrix)) deallocate (self%matrix)
      allocate (self%matrix(size(group), size(group)))
      do j = 1, size(group)
         advance = room
         advance(j) = (1.0_rk - probe)*room(j)
         call place(self, body, group, advance, begun)
         call body%evaluate(timers, error)
         if (allocated(error)) return
         self%matrix(:, j) = (intensity - body%tip(group)%drive%intensity)/(probe*room(j))
      end do
      self%preference = preference(self%matrix, slope(group))*body%rules%increment &
                        /body%rules%toughness
      kind = numbered(self%alike(group))
      ! No kind of tips grows along with another where the error of the intensities decides.
      self%prefers_one = preference(matrix_of_kinds(kind, self%matrix), &
                                    of_kinds(kind, means(kind, slope(group)))) &
                         *body%rules%increment > -2.0_rk*together*body%rules%toughness
   end subroutine probe_group

   !> Put the tips of a group on their pieces. Those that do not advance have no new piece.
   pure subroutine place(self, body, group, advance, begun)
      class(increment_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      integer(ik), intent(in) :: group(:)  !< tips
      real(rk), intent(in) :: advance(:)  !< of the group [m]
      type(tip_t), intent(in) :: begun(:)  !< all tips, at the ends of new pieces
      integer(ik) :: k

      body%network = self%network
      do k = 1, size(group, kind=ik)
         associate (tip => body%tip(group(k)), segment => self%segment(group(k)))
            tip = begun(group(k))
            segment%reached = segment%accepted + advance(k)
            if (.not. segment%reached > 0.0_rk) then
               tip%xy = self%tip(group(k))%xy
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

   !> Tips that have not begun their new pieces after all stand as they stood.
   pure subroutine keep_paths(self, body, group, advance)
      class(increment_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      integer(ik), intent(in) :: group(:)  !< tips
      real(rk), intent(in) :: advance(:)  !< of the group [m]
      type(tip_t) :: stood
      integer(ik) :: i, k

      do k = 1, size(group, kind=ik)
         i = group(k)
         if (self%segment(i)%accepted + advance(k) > 0.0_rk) cycle
         stood = self%tip(i)
         stood%intensity = body%tip(i)%intensity
         stood%drive = body%tip(i)%drive
         stood%is_free = body%tip(i)%is_free
         stood%arrested = body%tip(i)%arrested
         body%tip(i) = stood
         self%segment(i) = self%segment_before(i)
      end do
   end subroutine keep_paths

   !> Better advances, with which one of the tips comes to the end of its piece.
   subroutine correct(self, body, group, kind, lack, slope, room, advance)
      class(increment_t), intent(in) :: self
      class(loaded_body_t), intent(in) :: body
      integer(ik), intent(in) :: group(:)  !< tips
      integer(ik), intent(in) :: kind(:)  !< of each, from 1
      real(rk), intent(in) :: lack(:)  !< of each, K_IC - K_eq [Pa m^1/2]
      real(rk), intent(in) :: slope(:)  !< (all tips) dK_eq/df [Pa m^1/2]
      real(rk), intent(in) :: room(:)  !< of each, to the end of the piece [m]
      real(rk), intent(inout) :: advance(:)  !< of each [m]

      call better_advances(kind, lack, self%matrix, slope(group), room, &
                           tolerance*needed_intensity(body), advance)
      advance = fitted(advance, room, self%segment(group)%accepted, least*body%rules%increment)
   end subroutine correct

   !> The first tip that is like each: those that have come equally far, and that the error of the
   !! intensities does not tell from each other.
   pure function first_alike(self, body) result(first)
      class(increment_t), intent(in) :: self
      class(loaded_body_t), intent(in) :: body
      integer(ik) :: first(size(body%tip))
      real(rk), parameter :: as_far = 1.0e-2_rk  ! difference over an increment
      logical :: alike(size(body%tip), size(body%tip))
      real(rk) :: gain(size(body%tip)), scale
      integer(ik) :: i

      do i = 1, size(body%tip, kind=ik)
         gain(i) = end_gain(self%network, body%start, self%tip(i)%fracture, self%tip(i)%end)
      end do
      associate (drive => self%tip%drive%intensity)
         scale = maxval(drive, mask=.not. self%tip%arrested)
         do i = 1, size(body%tip, kind=ik)
            alike(:, i) = abs(gain - gain(i)) <= as_far*body%rules%increment
            alike(:, i) = alike(:, i) .and. abs(drive - drive(i)) <= scale &
                          *merge(tolerance, together, min(gain, gain(i)) > 0.0_rk)
         end do
      end associate
      first = likes(alike)
   end function first_alike

   !> The tips of a group, and those that are like them.
   pure function with_their_like(self, group) result(larger)
      class(increment_t), intent(in) :: self
      integer(ik), intent(in) :: group(:)  !< tips
      integer(ik), allocatable :: larger(:)
      integer(ik) :: i

      larger = pack([(i, i=1, size(self%tip, kind=ik))], &
                    [(any(self%alike(group) == self%alike(i)) .and. .not. self%tip(i)%arrested, &
                      i=1, size(self%tip, kind=ik))])
   end function with_their_like

end module mechanics_equilibrium
