!> Growth as equilibrium in a body without a fluid (model.md section 5): from one accepted state to
!! the next, each tip has either not advanced and K_eq <= K_IC, or advanced so far that K_eq = K_IC.
!!
!! Length is controlled: one of the tips at their toughness advances to the end of its segment, the
!! load factor is the one that the longer network bears (mechanics_balance), and the other tips
!! advance as far as K_eq = K_IC requires at that load (growth_competition). The load may fall on
!! the way: a load that rises again leads to the same networks.
module mechanics_equilibrium
   use base_archive, only: archive_t
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use growth_competition, only: broyden_update, matrix_of_groups, means, numbered, &
                                 values_of_groups, &
                                 preference
   use growth_control, only: fitted, joined_groups, length_control_t
   use growth_tip, only: tip_t
   use mechanics_balance, only: balance_load, needed_intensity, share_misfit, tolerance
   use mechanics_state, only: loaded_body_t, together
   use mechanics_tries, only: least, run_loosely, tries_t
   implicit none(type, external)
   private

   public :: increment_t

   !> Fraction of its new path segment by which a tip is set back to find the dependence of the
   !! intensities on its advance [-].
   real(rk), parameter :: probe = 0.4_rk

   !> Smallest 1 - K_eq/K_IC at which no equilibrium was found; the errors of the intensities and of
   !! their slopes are below it [-].
   real(rk), parameter :: far_off = 0.05_rk

   !> Growth after which the matrix of tip interaction is computed again [increments].
   real(rk), parameter :: valid_for = 8.0_rk

   !> One increment of growth, and the results of it that the next one uses.
   type :: increment_t
      logical :: has_grown = .false.
      logical :: holds = .false.  !< K_eq = K_IC at the present load
      logical :: is_loose = .false.  !< K_eq > K_IC at every load factor
      logical :: prefers_one = .false.  !< growth of one tip of the group alone is stable
      real(rk) :: preference = 0.0_rk  !< gain of K_eq of a leading tip per increment, over K_IC [-]
      real(rk) :: misfit = 0.0_rk  !< largest 1 - K_eq/K_IC of a tip that has advanced [-]
      real(rk) :: advance_sum = 0.0_rk  !< sum of the advances of all tips [m]
      type(tries_t), private :: tries
      integer(ik), allocatable :: group(:)  !< tips that were at their toughness together
      ! The matrix of tip interaction and the state for which it was computed.
      integer(ik), allocatable, private :: known_group(:)
      real(rk), allocatable, private :: matrix(:, :)  !< dK_i/da_j [Pa m^-1/2]
      real(rk), private :: known_since = 0.0_rk  !< growth since then [increments]
      real(rk), private :: started = 0.0_rk  !< load factor of the state before the increment [-]
      logical, private :: was_loose = .false.  !< is_loose of the previous increment
      real(rk), allocatable, private :: pace(:)  !< (tips) previous advance over the largest [-]
   contains
      procedure :: take
      procedure :: end_paths
      procedure :: visit
   end type increment_t

   !> Search for the advances of a group of tips.
   type :: group_search_t
      integer(ik), allocatable :: tip(:)  !< tips of the group
      integer(ik), allocatable :: tip_group(:)  !< (tip) tip group of equal advances, from 1
      type(tip_t), allocatable :: begun(:)  !< (all tips) tips at the ends of new segments
      logical :: is_placed = .false.  !< the tips have been evaluated there
      real(rk), allocatable :: remaining(:)  !< (tip) distance to the end of its segment [m]
      real(rk), allocatable :: advance(:)  !< (tip) [m]
      real(rk) :: share = 1.0_rk  !< fraction of the advances that the load limit permits [-]
      real(rk), allocatable :: lack(:)  !< (tip) K_IC - K_eq [Pa m^1/2]
      real(rk), allocatable :: slope(:)  !< (all tips) dK_eq/df [Pa m^1/2]
      real(rk), allocatable :: placed(:)  !< (tip) advance in the last evaluation [m]
      real(rk), allocatable :: intensity(:)  !< (tip) K_eq in the last evaluation [Pa m^1/2]
      type(length_control_t) :: control
   contains
      procedure :: misses
   end type group_search_t

contains

   !> Grow by one increment, from a state whose tips have been evaluated. If the full increment
   !! needs more than the limit of the load, the tips advance as far as that load drives them.
   subroutine take(self, body, limit, timers, error)
      class(increment_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      real(rk), intent(in) :: limit  !< the largest load factor [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: most_cuts = 3
      integer :: cut
      integer(ik), allocatable :: group(:)

      if (.not. allocated(self%pace)) allocate (self%pace(size(body%tip)), source=1.0_rk)
      call body%accept()
      call body%body%remember()
      body%is_trying = .true.
      call self%tries%begin(body)
      self%started = body%factor
      self%was_loose = self%is_loose
      self%has_grown = .false.
      ! Shorter path segments may lead to an equilibrium where longer ones do not.
      do cut = 0, most_cuts
         self%tries%longest = body%rules%increment/2.0_rk**cut
         call try_segments(self, body, limit, group, timers, error)
         if (allocated(error) .or. self%misfit <= far_off) exit
      end do
      body%is_trying = .false.
      body%meshed_vertices = size(body%network%xy, 2)
      if (allocated(error)) return
      self%group = group
      self%has_grown = size(group) > 0
      if (.not. self%has_grown) self%holds = .false.
      call self%tries%finish(body)
      self%advance_sum = sum(body%tip%advance)
      if (self%has_grown) then
         self%pace = body%tip%advance/maxval(body%tip%advance)
         self%known_since = self%known_since + maxval(body%tip%advance)/body%rules%increment
      end if
   end subroutine take

   !> End all path segments: tips need not continue straight.
   pure subroutine end_paths(self)
      class(increment_t), intent(inout) :: self

      if (allocated(self%tries%segment)) self%tries%segment%is_open = .false.
      if (allocated(self%known_group)) deallocate (self%known_group)
   end subroutine end_paths

   !> Let the tips with K_eq = K_IC advance along path segments of the present length.
   subroutine try_segments(self, body, limit, group, timers, error)
      class(increment_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      real(rk), intent(in) :: limit  !< the largest load factor [-]
      integer(ik), allocatable, intent(out) :: group(:)  !< tips that have advanced
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: attempt, attempts
      logical :: has_joined, is_done

      self%misfit = 0.0_rk
      call self%tries%find_tip_groups(body)
      call self%tries%go_back(body)
      group = self%tries%with_tip_groups(leading_tips(body, together))
      attempts = 3_ik*size(body%tip, kind=ik)
      do attempt = 1, attempts
         is_done = .false.
         call self%tries%go_back(body)
         if (size(group) == 0) exit
         call self%tries%begin_segments(body, group, timers, error)
         if (allocated(error)) exit
         has_joined = any(body%tip(group)%joined)
         if (has_joined .and. .not. all(body%tip(group)%joined)) then
            group = pack(group, body%tip(group)%joined)  ! these join first
            cycle
         else if (.not. all(self%tries%segment(group)%is_open)) then
            ! Another tip has joined this one, which is no tip any more.
            body%tip(pack(group,.not. self%tries%segment(group)%is_open))%arrested = .true.
            self%tries%tip_before%arrested = self%tries%tip_before%arrested .or. body%tip%arrested
            group = pack(group, self%tries%segment(group)%is_open)
            cycle
         end if
         if (has_joined) then
            call find_load(self, body, limit, timers, error)
            is_done = .true.
         else if (is_driven(self, body, group)) then
            call run_loosely(self%tries, body, group, timers, error)
            if (.not. allocated(error)) call find_load(self, body, limit, timers, error)
            self%misfit = 1.0_rk - maxval(body%tip(group)%drive%intensity)/body%rules%toughness
            is_done = .true.
         else
            call find_advances(self, body, limit, attempt == attempts, group, timers, is_done, &
                               error)
         end if
         if (allocated(error) .or. is_done) exit
      end do
   end subroutine try_segments

   !> Find the load of the present network. It stays where K_eq < K_IC, as after a joint.
   subroutine find_load(self, body, limit, timers, error)
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
   end subroutine find_load

   !> Find the advances of the tips of a group.
   subroutine find_advances(self, body, limit, is_last, group, timers, is_done, error)
      class(increment_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      real(rk), intent(in) :: limit  !< the largest load factor [-]
      logical, intent(in) :: is_last  !< no other group is tried
      integer(ik), allocatable, intent(inout) :: group(:)  !< tips
      type(timers_t), intent(inout) :: timers
      logical, intent(out) :: is_done  !< .false.: the reduced group has to be tried
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: tries = 15
      type(group_search_t) :: search
      logical :: has_moved, is_over
      integer :: try

      is_done = .false.
      call begin_search(self, body, group, search)
      if (size(group) == 1) self%prefers_one = .false.
      if (size(group) > 1 .and. .not. knows(self, group)) then
         call probe_group(self, body, search, limit, timers, error)
         if (allocated(error)) return
         if (.not. self%prefers_one .and. search%misses(body)) then
            search%advance = search%remaining
            call correct(self, body, search, has_moved)
         end if
      end if
      do try = 1, tries
         call respond(self, body, search, limit, try > 1, timers, error)
         if (allocated(error)) return
         if (.not. self%holds) then
            call reduce_share(body, search, is_over)
            if (is_over) exit
            cycle
         else if (search%share < 1.0_rk) then
            exit
         end if
         if (.not. is_last) then
            call judge_group(self, body, search, group)
            if (size(group) /= size(search%tip)) return
         end if
         associate (lack => means(search%tip_group, search%lack))
            if (maxval(merge(lack, 0.0_rk, search%advance > 0.0_rk)) &
                <= tolerance*body%rules%toughness) exit
            if (self%prefers_one .and. .not. is_last) then
               group = pack(group, lack <= tolerance*body%rules%toughness)
               return
            end if
         end associate
         call correct(self, body, search, has_moved)
         if (.not. has_moved) exit
      end do
      self%misfit = maxval(merge(search%lack, 0.0_rk, search%advance > 0.0_rk)) &
                    /body%rules%toughness
      is_done = .true.
      call self%tries%keep_paths(body, group, search%share*search%advance)
   end subroutine find_advances

   !> Begin with advances proportional to the previous ones; one tip reaches the end of its segment.
   subroutine begin_search(self, body, group, search)
      class(increment_t), intent(in) :: self
      class(loaded_body_t), intent(in) :: body
      integer(ik), intent(in) :: group(:)  !< tips
      type(group_search_t), intent(out) :: search

      search%tip = group
      search%tip_group = numbered(self%tries%tip_group(group))
      search%begun = body%tip
      search%remaining = self%tries%remaining_lengths(group)
      search%is_placed = all(.not. self%tries%segment_before(group)%is_open)
      search%advance = fitted(merge(self%pace(group), 1.0_rk, self%pace(group) > 0.0_rk), &
                              search%remaining, self%tries%segment(group)%accepted, &
                              least*body%rules%increment)
      allocate (search%slope(size(body%tip)))
   end subroutine begin_search

   !> K_IC - K_eq of a tip of the group exceeds the tolerance.
   pure logical function misses(self, body)
      class(group_search_t), intent(in) :: self
      class(loaded_body_t), intent(in) :: body

      misses = maxval(means(self%tip_group, self%lack)) > tolerance*body%rules%toughness
   end function misses

   !> Evaluate the tips at their advances, and balance the load.
   subroutine respond(self, body, search, limit, updates_matrix, timers, error)
      class(increment_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      type(group_search_t), intent(inout) :: search
      real(rk), intent(in) :: limit  !< the largest load factor [-]
      !> the matrix is updated, at the load of the last evaluation
      logical, intent(in) :: updates_matrix
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      associate (group => search%tip)
         if (.not. (search%is_placed .and. all(search%advance >= search%remaining))) then
            call self%tries%place(body, group, search%share*search%advance, search%begun)
            call body%evaluate(timers, error)
            if (allocated(error)) return
         end if
         search%is_placed = .false.
         if (updates_matrix .and. size(group) > 1) then
            call broyden_update(self%matrix, search%share*search%advance - search%placed, &
                                body%tip(group)%drive%intensity - search%intensity)
         end if
         call balance_load(body, self%started, limit, timers, self%holds, self%is_loose, &
                           search%slope, error)
         if (allocated(error)) return
         call share_misfit(body, pack(group, search%advance > 0.0_rk), limit, search%slope, &
                           timers, error)
         if (allocated(error)) return
         search%intensity = body%tip(group)%drive%intensity
         search%lack = needed_intensity(body) - search%intensity
         search%placed = search%share*search%advance
      end associate
   end subroutine respond

   !> Halve the advances, since the limit of the load does not drive the tips so far, unless K_eq of
   !! a tip is nearly K_IC or the advances are too short for the mesh.
   pure subroutine reduce_share(body, search, is_over)
      class(loaded_body_t), intent(in) :: body
      type(group_search_t), intent(inout) :: search
      logical, intent(out) :: is_over

      is_over = body%largest_excess() >= -tolerance
      if (is_over) return
      search%share = 0.5_rk*search%share
      is_over = search%share*maxval(search%advance) < least*body%rules%increment
   end subroutine reduce_share

   !> If K_eq < K_IC for all tips of a group, the tips with the largest K_eq join the group. Tips
   !! that differ from the others of their tip group form groups of their own.
   subroutine judge_group(self, body, search, group)
      class(increment_t), intent(inout) :: self
      class(loaded_body_t), intent(in) :: body
      type(group_search_t), intent(inout) :: search
      integer(ik), allocatable, intent(inout) :: group(:)  !< tips; others if it has changed
      logical :: differs(size(search%lack))

      if (minval(search%lack) > tolerance*body%rules%toughness) then
         group = joined_groups(group, self%tries%with_tip_groups(leading_tips(body, together)))
         return
      end if
      differs = abs(search%lack - means(search%tip_group, search%lack)) &
                > tolerance*body%rules%toughness
      if (.not. any(differs)) return
      call self%tries%split_groups(group, differs)
      search%tip_group = numbered(self%tries%tip_group(group))
      search%control = length_control_t()
   end subroutine judge_group

   !> The matrix of tip interaction is that of this group and still valid.
   pure logical function knows(self, group)
      class(increment_t), intent(in) :: self
      integer(ik), intent(in) :: group(:)  !< tips

      knows = .false.
      if (.not. allocated(self%known_group)) return
      if (size(group) /= size(self%known_group)) return
      knows = all(group == self%known_group) .and. self%known_since < valid_for
   end function knows

   !> Find the matrix of tip interaction of a group, dK_i/da_j: from the ends of the segments one
   !! tip after the other is set back.
   subroutine probe_group(self, body, search, limit, timers, error)
      class(increment_t), intent(inout) :: self
      class(loaded_body_t), intent(inout) :: body
      type(group_search_t), intent(inout) :: search
      real(rk), intent(in) :: limit  !< the largest load factor [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: advance(size(search%tip)), intensity(size(search%tip))
      integer :: j

      associate (group => search%tip, remaining => search%remaining, tip_group => search%tip_group)
         if (.not. search%is_placed) then
            call self%tries%place(body, group, remaining, search%begun)
            call body%evaluate(timers, error)
            if (allocated(error)) return
         end if
         search%is_placed = .false.
         call balance_load(body, self%started, limit, timers, self%holds, self%is_loose, &
                           search%slope, error)
         if (allocated(error)) return
         intensity = body%tip(group)%drive%intensity
         search%lack = needed_intensity(body) - intensity
         self%known_group = group
         self%known_since = 0.0_rk
         if (allocated(self%matrix)) deallocate (self%matrix)
         allocate (self%matrix(size(group), size(group)))
         do j = 1, size(group)
            advance = remaining
            advance(j) = (1.0_rk - probe)*remaining(j)
            call self%tries%place(body, group, advance, search%begun)
            call body%evaluate(timers, error)
            if (allocated(error)) return
            self%matrix(:, j) = (intensity - body%tip(group)%drive%intensity)/(probe*remaining(j))
         end do
         self%preference = preference(self%matrix, search%slope(group))*body%rules%increment &
                           /body%rules%toughness
         ! Tip groups do not grow together where the difference is within the error of K.
         self%prefers_one = preference(matrix_of_groups(tip_group, self%matrix), &
                                       values_of_groups(tip_group, means(tip_group, &
                                                                         search%slope(group)))) &
                            *body%rules%increment > -2.0_rk*together*body%rules%toughness
      end associate
   end subroutine probe_group

   !> Improve the advances; one of the tips reaches the end of its segment.
   subroutine correct(self, body, search, has_moved)
      class(increment_t), intent(in) :: self
      class(loaded_body_t), intent(in) :: body
      type(group_search_t), intent(inout) :: search
      logical, intent(out) :: has_moved
      real(rk), dimension(maxval(search%tip_group)) :: advance, excess, shortest, slope

      associate (needed => needed_intensity(body), tip_group => search%tip_group, &
                 accepted => self%tries%segment(search%tip)%accepted)
         advance = values_of_groups(tip_group, search%advance)
         excess = values_of_groups(tip_group, means(tip_group, -search%lack))/needed
         slope = values_of_groups(tip_group, means(tip_group, search%slope(search%tip)))/needed
         shortest = values_of_groups(tip_group, max(0.0_rk, least*body%rules%increment - accepted))
         search%control%tolerance = tolerance
         call search%control%improve(excess, matrix_of_groups(tip_group, self%matrix)/needed, &
                                     slope, values_of_groups(tip_group, search%remaining), &
                                     shortest, advance, has_moved)
         search%advance = advance(tip_group)
      end associate
   end subroutine correct

   !> K_eq exceeded K_IC in the previous state at every load, so that the tips advance without an
   !! equilibrium. Under a dead load no other load has been tried.
   pure logical function is_driven(self, body, group)
      class(increment_t), intent(in) :: self
      class(loaded_body_t), intent(in) :: body
      integer(ik), intent(in) :: group(:)  !< tips

      is_driven = (self%was_loose .or. body%scene%load%control /= "dead") .and. &
                  maxval(self%tries%tip_before(group)%drive%intensity) &
                  > (1.0_rk + tolerance)*body%rules%toughness
   end function is_driven

   !> Tips whose K_eq is at least (1 - share) times the largest.
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

   !> Store or load what the next increment uses.
   subroutine visit(self, archive)
      class(increment_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive

      call archive%enter("increment")
      call archive%item("has_grown", self%has_grown)
      call archive%item("holds", self%holds)
      call archive%item("is_loose", self%is_loose)
      call archive%item("prefers_one", self%prefers_one)
      call archive%item("preference", self%preference)
      call archive%item("misfit", self%misfit)
      call archive%item("advance_sum", self%advance_sum)
      call self%tries%visit(archive)
      call archive%list("group", self%group, "group ?")
      call archive%list("known_group", self%known_group, "known_group ?")
      call archive%list("matrix", self%matrix, "known_group, known_group ?")
      call archive%item("known_since", self%known_since)
      call archive%item("started", self%started)
      call archive%item("was_loose", self%was_loose)
      call archive%list("pace", self%pace, "tips ?")
      call archive%leave()
   end subroutine visit

end module mechanics_equilibrium
