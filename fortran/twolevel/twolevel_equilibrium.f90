!> Growth as equilibrium (model.md section 5): at the end of a time step each tip has either not
!! advanced and K_eq <= K_IC, or advanced so far that K_eq = K_IC.
!!
!! Within a step the coarse level is solved from the state before with the tips where they are
!! tried to be, the windows give the intensities there, and each tip goes on until its excess
!! vanishes. A tip lies anywhere along the last straight piece of its path: the coarse mesh has a
!! cell for all of that piece, and its springs say how much of it is behind the tip (coarse_tips);
!! so the coarse mesh changes once per piece, and neither its matrix nor the fluid's volume jumps.
!! A piece begins in the direction in which K_II vanishes at its end (growth_path).
module twolevel_equilibrium
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use coarse_state, only: go_back, step_report_t
   use growth_company, only: company_t
   use growth_network, only: total_length
   use growth_rivals, only: rivals_t
   use growth_segment, only: segment_t
   use growth_targets, only: target_none
   use growth_tip, only: tip_t
   use mesh_types, only: network_t
   use simulation_doubt, only: doubtful
   use twolevel_certainty, only: certainty_t
   use twolevel_doubt, only: improve_windows
   use twolevel_excess, only: arrivals, at_joints, excesses, first_onset, onset, tolerance
   use twolevel_moves, only: judge_tips, keep_together, part_company, several_kinds, tips_in_play
   use twolevel_pieces, only: begin_pieces, can_join, join_targets
   use twolevel_places, only: advances, place_tips
   use twolevel_probe, only: lesson_t, measure_rivals
   use twolevel_state, only: two_levels_t
   use twolevel_stepping, only: trial_t
   use twolevel_trust, only: estimate_coarse_errors
   use twolevel_well_limits, only: share_before_switch
   use twolevel_schedule, only: last_switch
   implicit none(type, external)
   private

   public :: accept_equilibrium, find_equilibrium, punctual

   !> Excess of K_eq over K_IC, relative to that, beyond which no segment begins in a tried step:
   !! its direction would be that of a state that never is.
   real(rk), parameter :: excess_max = 0.2_rk

   !> A step that errs this much with the tips where they were cannot be taken, whatever they do
   !! [-].
   real(rk), parameter :: much = 4.0_rk

   !> A tip comes to a joint no earlier before the end of a step, and jumps in one no longer, than
   !! this share of the time since the wells were switched last [-].
   real(rk), parameter :: punctual = 5.0e-3_rk

   !> A tip with less than this share of its toughness in the first try of a step is not asked in
   !! the others, but for the last one.
   real(rk), parameter :: far = 0.7_rk

   !> A step that is being tried.
   type :: search_t
      real(rk) :: dt = 0.0_rk  !< [s]
      logical :: is_last = .false.  !< its error in time is not judged
      logical :: may_jump = .false.  !< tips may go on from piece to piece in it
      ! Before it
      type(tip_t), allocatable :: tip(:)
      type(segment_t), allocatable :: segment(:)
      type(network_t) :: network
      type(certainty_t) :: certainty
      type(company_t) :: company
      type(rivals_t) :: rivals
      logical :: was_undrained = .false.
      ! Of its tries
      real(rk), allocatable :: unmoved(:)  !< (tips) K_eq of the first one [Pa m^1/2]
      integer(ik), allocatable :: kind(:)  !< (tips) from 1: those of one go equally far
      logical, allocatable :: has_begun(:)  !< (tips) a new piece
      type(lesson_t) :: lesson
      logical :: is_over = .false.  !< there is no more to be tried
      logical :: is_found = .false.  !< the state is an equilibrium
   end type search_t

contains

   !> Try a step: state and tips at its end. A tip that would go on for more than one new piece
   !! goes too far, unless it may jump: the step is so short that it does not matter when in it that
   !! happens, or it is the last try, in which nothing but growth happens until that arrests.
   !! Nothing is accepted yet; a step that does not show an equilibrium leaves the state before. So
   !! does one in which a tip would grow, or might, whose intensities are not known well enough: its
   !! window is a better one then.
   subroutine find_equilibrium(self, dt, is_last, may_jump, timers, report, trial, error)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      logical, intent(in) :: is_last  !< its error in time is not judged; tips may jump
      logical, intent(in) :: may_jump
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(trial_t), intent(out) :: trial
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: tries_max = 25, jump_tries_max = 1000
      logical :: any_moves, wants(size(self%tip))
      type(search_t) :: search
      integer :: k, most

      call begin_search(self, dt, is_last, may_jump, search)
      most = merge(jump_tries_max, tries_max, may_jump)
      do k = 1, most
         call find_state(self, search, k == 1, timers, report, trial, error)
         if (search%is_over .or. allocated(error)) exit
         call move_tips(self, search, k, timers, any_moves, wants, error)
         if (allocated(error)) exit
         if (.not. any_moves) call go_on(self, search, wants, timers, trial, error)
         if (search%is_over .or. allocated(error)) exit
         call go_back(self%state, self%before)
      end do
      if (search%is_found) return
      trial%goes_too_far = trial%goes_too_far .or. k > most
      call take_back(self, search)
      if (allocated(error) .or. .not. trial%needs_windows) return
      ! Onsets are looked for from what tips had before the step, and errors known from there; on a
      ! mesh that the step has made that state has no tractions.
      if (.not. allocated(self%state%tractions)) return
      call self%evaluate(timers, error)
      if (.not. allocated(error)) call estimate_coarse_errors(self, timers, error)
   end subroutine find_equilibrium

   !> Remember what is before the step.
   subroutine begin_search(self, dt, is_last, may_jump, search)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      logical, intent(in) :: is_last, may_jump
      type(search_t), intent(out) :: search

      search%dt = dt
      search%is_last = is_last
      search%may_jump = may_jump
      search%tip = self%tip
      search%segment = self%segment
      search%network = self%network
      search%was_undrained = self%undrained
      search%certainty = self%certainty
      search%company = self%company
      search%rivals = self%rivals
      allocate (search%kind(size(self%tip)))
      allocate (search%has_begun(size(self%tip)), source=.false.)
      associate (k => self%tip%intensity, toughness => self%rules%toughness)
         call self%company%find_kinds(self%tip%drive%intensity/toughness, &
                                      max(k%k1_error, k%k2_error) &
                                      /(toughness*self%tip%drive%resistance), self%segment%gain, &
                                      self%tip%arrested, self%rules%increment, self%rivals, &
                                      search%kind)
      end associate
      self%before = self%state
      call self%segment%restart()
      if (.not. may_jump) then
         call self%segment%keep_pace(dt)
         call keep_together(self, search%kind)
      end if
      call self%certainty%begin_step()
   end subroutine begin_search

   !> What was before the step is again. The cells that pieces were begun with stay, closed, for the
   !! next try.
   subroutine take_back(self, search)
      class(two_levels_t), intent(inout) :: self
      type(search_t), intent(in) :: search

      if (allocated(self%asked)) deallocate (self%asked)
      self%state = self%before
      self%tip = search%tip
      self%segment = search%segment
      self%network = search%network
      self%certainty = search%certainty
      self%company = search%company
      self%rivals = search%rivals
      self%undrained = search%was_undrained
      self%values_are_current = .false.
      call self%windows%take_back()
      call self%reference%take_back()
   end subroutine take_back

   !> The state and the intensities with the tips where they are tried to be.
   subroutine find_state(self, search, is_first, timers, report, trial, error)
      class(two_levels_t), intent(inout) :: self
      type(search_t), intent(inout) :: search
      logical, intent(in) :: is_first  !< try
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(trial_t), intent(inout) :: trial
      type(error_t), allocatable, intent(out) :: error

      call place_tips(self)
      call self%try_step(search%dt, timers, report, error)
      if (allocated(error)) return
      trial%converged = report%converged
      search%is_over = .not. trial%converged
      if (search%is_over) then
         trial%reason = report%reason
         return
      end if
      if (is_first .and. .not. search%is_last) then
         trial%time_error = self%step_error(search%dt)
         search%is_over = self%errs(trial%time_error/much)
         if (search%is_over) return
      end if
      call self%evaluate(timers, error)
      if (allocated(error)) return
      call self%certainty%see_try(total_length(self%network), self%well_pressure())
      if (.not. is_first) return
      search%unmoved = self%tip%drive%intensity
      if (.not. search%is_last) trial%onset = first_onset(self, search%tip%drive%intensity)
      search%is_over = trial%onset < 1.0_rk
      if (.not. search%is_over) self%asked = are_asked(self)
   end subroutine find_state

   !> Let the tips go where their excess will probably vanish.
   subroutine move_tips(self, search, try, timers, any_moves, wants, error)
      class(two_levels_t), intent(inout) :: self
      type(search_t), intent(inout) :: search
      integer, intent(in) :: try  !< its number
      type(timers_t), intent(inout) :: timers
      logical, intent(out) :: any_moves  !< or is to be asked anew where it is
      logical, intent(out) :: wants(:)  !< (tips) a new piece
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: coupled_tries_max = 10  ! then what is known of the tips misleads
      logical, dimension(size(self%tip)) :: in_play, moves
      logical :: is_coupled

      in_play = tips_in_play(self)
      call search%lesson%tell(self)
      call measure_rivals(self, in_play, search%dt, timers, any_moves, error)
      if (allocated(error)) return
      call search%lesson%begin(self)
      is_coupled = try <= coupled_tries_max
      if (is_coupled) is_coupled = several_kinds(search%kind, in_play)
      call judge_tips(self, search%kind, is_coupled, moves, wants)
      any_moves = any_moves .or. any(moves)
   end subroutine move_tips

   !> All tips are at rest, or at the ends of their pieces: some leave their kind, some join what
   !! they have come to, some begin new pieces; else the state is an equilibrium.
   subroutine go_on(self, search, wants, timers, trial, error)
      class(two_levels_t), intent(inout) :: self
      type(search_t), intent(inout) :: search
      logical, intent(inout) :: wants(:)  !< (tips) a new piece
      type(timers_t), intent(inout) :: timers
      type(trial_t), intent(inout) :: trial
      type(error_t), allocatable, intent(out) :: error
      logical :: any_parted, joins(size(self%tip))

      call part_company(self, search%tip, wants, search%kind, any_parted)
      if (any_parted) return
      ! Not while others are on their way: they may go back.
      if (.not. search%may_jump) trial%onset = first_onset(self, search%tip%drive%intensity)
      search%is_over = trial%onset < 1.0_rk
      if (search%is_over) return
      call stop_gained(self, search, wants, trial)
      if (search%is_over) return
      joins = wants .and. can_join(self)
      wants = wants .and. self%tip%heads_for == target_none
      if (.not. (trial%has_joined .or. trial%jumps)) then
         trial%time_error = self%step_error(search%dt)
      end if
      if (any(joins)) then
         call join(self, search, joins, trial)
      else if (any(wants)) then
         call begin_wanted(self, search, wants, timers, trial, error)
      else
         call conclude(self, search, timers, trial, error)
      end if
   end subroutine go_on

   !> Tips that have come as far as growth is wanted do not go on, unless that is too early in the
   !! step: then they would exceed their toughness by more than the tolerance, and the step is cut
   !! to where their excess vanishes.
   subroutine stop_gained(self, search, wants, trial)
      class(two_levels_t), intent(inout) :: self
      type(search_t), intent(inout) :: search
      logical, intent(inout) :: wants(:)  !< (tips) a new piece
      type(trial_t), intent(inout) :: trial
      logical :: stops(size(wants))

      stops = wants .and. self%has_gained()
      if (.not. any(stops)) return
      wants = wants .and. .not. stops
      if (search%may_jump) return
      trial%goes_too_far = any(stops .and. search%has_begun)
      stops = stops .and. excesses(self) > tolerance
      trial%gains_all = any(stops)
      if (trial%gains_all) then
         trial%arrival = minval(arrivals(self, search%tip%drive%intensity, 0.0_rk), mask=stops)
      end if
      trial%is_late = trial%gains_all
      search%is_over = trial%goes_too_far .or. trial%is_late
   end subroutine stop_gained

   !> Tips join what they have come to, unless that is too early in the step. The error in time is
   !! that up to the joint: what follows is a jump.
   subroutine join(self, search, joins, trial)
      class(two_levels_t), intent(inout) :: self
      type(search_t), intent(inout) :: search
      logical, intent(in) :: joins(:)  !< (tips)
      type(trial_t), intent(inout) :: trial

      if (.not. search%may_jump) then
         trial%goes_too_far = any(joins .and. search%has_begun)
         trial%arrival = minval(arrivals(self, search%tip%drive%intensity, at_joints), mask=joins)
         trial%moment = punctual*(self%before%time - last_switch(self%scene, self%before%time))
         trial%is_late = (1.0_rk - trial%arrival)*search%dt > trial%moment
         search%is_over = trial%goes_too_far .or. trial%is_late .or. self%errs(trial%time_error)
         if (search%is_over) return
      end if
      call join_targets(self, joins)
      trial%has_joined = .true.
      search%lesson = lesson_t()
   end subroutine join

   !> Tips begin new pieces, unless they have gone too far by that, or are not known well enough.
   subroutine begin_wanted(self, search, wants, timers, trial, error)
      class(two_levels_t), intent(inout) :: self
      type(search_t), intent(inout) :: search
      logical, intent(in) :: wants(:)  !< (tips)
      type(timers_t), intent(inout) :: timers
      type(trial_t), intent(inout) :: trial
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: excess(size(self%tip))
      integer :: i

      associate (toughness => self%rules%toughness, before => search%tip%drive%intensity)
         search%is_over = any(wants .and. doubtful(self%tip, toughness))
         if (search%is_over) then
            call improve_windows(self, self%before%time, trial%needs_windows, error)
            return
         end if
         if (any(wants .and. (search%has_begun .or. excesses(self) > excess_max))) then
            trial%jumps = .true.
            trial%time_error = 0.0_rk  ! what jumps has no rates
         end if
         trial%goes_too_far = trial%jumps .and. .not. search%may_jump
         search%is_over = trial%goes_too_far
         if (search%is_over) then
            trial%was_beyond = any(wants .and. before/toughness > 1.0_rk + excess_max)
            ! From where they come to the toughness on, not from the start of the step.
            trial%onset = onset(before/toughness, search%unmoved/toughness, wants)
            return
         end if
      end associate
      excess = [(maxval(excesses(self), mask=wants .and. search%kind == search%kind(i)), &
                 i=1, size(wants))]
      call begin_pieces(self, wants, timers, error)
      if (allocated(error)) return
      if (.not. search%may_jump) then
         do i = 1, size(wants)
            if (wants(i)) call self%segment(i)%set_out(excess(i))
         end do
         call keep_together(self, search%kind)
      end if
      ! Not those that have come to something already: nothing lies between.
      search%has_begun = search%has_begun .or. (wants .and. .not. self%segment%stays())
      search%lesson = lesson_t()  ! of other pieces
   end subroutine begin_wanted

   !> No tip is to go on. If that holds for those that have not been asked too, and all are known
   !! well enough, the state is an equilibrium.
   subroutine conclude(self, search, timers, trial, error)
      class(two_levels_t), intent(inout) :: self
      type(search_t), intent(inout) :: search
      type(timers_t), intent(inout) :: timers
      type(trial_t), intent(inout) :: trial
      type(error_t), allocatable, intent(out) :: error
      logical :: any_exceeds

      call ask_others(self, any_exceeds, timers, error)
      if (allocated(error) .or. any_exceeds) return
      search%is_over = .true.
      trial%advance = maxval([0.0_rk, advances(self)])/self%rules%increment
      if (.not. search%is_last) then
         if (self%errs(trial%time_error)) return
         call share_before_switch(self, search%dt, punctual, trial%switch, timers, error)
         if (allocated(error) .or. trial%switch < 1.0_rk) return
      end if
      call estimate_coarse_errors(self, timers, error)
      if (allocated(error)) return
      call improve_windows(self, self%before%time, trial%needs_windows, error)
      search%is_found = .not. (allocated(error) .or. trial%needs_windows)
   end subroutine conclude

   !> Tips that may grow in a step, as its first try shows: those that are on their way or not far
   !! from their toughness, known as well as that is.
   pure function are_asked(self) result(asked)
      class(two_levels_t), intent(in) :: self
      logical :: asked(size(self%tip))

      associate (k => self%tip%intensity)
         asked = self%segment%is_open .or. self%tip%drive%intensity &
                 + max(k%k1_error, k%k2_error)/self%tip%drive%resistance > far*self%rules%toughness
      end associate
   end function are_asked

   !> Evaluate the tips that the tries of a step have not asked for. From now on all are asked.
   subroutine ask_others(self, any_exceeds, timers, error)
      class(two_levels_t), intent(inout) :: self
      logical, intent(out) :: any_exceeds  !< its toughness
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      logical :: others(size(self%tip))

      any_exceeds = .false.
      if (.not. allocated(self%asked)) return
      others = .not. self%asked .and. self%tip%is_free
      self%asked = others
      if (any(others)) call self%evaluate(timers, error)
      deallocate (self%asked)
      if (.not. allocated(error)) any_exceeds = any(others .and. excesses(self) > tolerance)
   end subroutine ask_others

   !> The tried state is accepted.
   subroutine accept_equilibrium(self, dt)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< of the step [s]; 0: growth that says nothing of the next one

      self%tip%advance = advances(self)
      call self%segment%pace(self%tip%advance, dt, excesses(self) >= -tolerance)
      where (self%segment%accepted > 0.0_rk) self%tip%kink = 0.0_rk  ! they went straight on
      self%segment%gain = self%segment%gain + self%tip%advance
      call self%company%accept(self%tip%drive%intensity/self%rules%toughness, self%tip%advance, &
                               self%rules%increment)
      call self%segment%accept()
   end subroutine accept_equilibrium

end module twolevel_equilibrium
