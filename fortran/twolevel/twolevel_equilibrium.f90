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
   use base_tolerances, only: same_place
   use coarse_state, only: step_report_t
   use growth_network, only: end_gain, end_place, extend, move_end
   use growth_segment, only: segment_t
   use growth_tip, only: tip_t
   use mesh_types, only: network_t
   use simulation_doubt, only: doubtful
   use twolevel_doubt, only: improve_windows
   use twolevel_state, only: two_levels_t
   use twolevel_stepping, only: trial_t
   use twolevel_trust, only: estimate_coarse_errors
   implicit none(type, external)
   private

   public :: accept_equilibrium, find_equilibrium, tolerance

   real(rk), parameter :: tolerance = 5.0e-3_rk  !< on K_eq/K_IC of growing tips [-]

   !> Excess of K_eq over K_IC, relative to that, beyond which no segment begins in a tried step:
   !! its direction would be that of a state that never is.
   real(rk), parameter :: excess_max = 0.2_rk

   !> A tip that lacks less than this of its toughness before a step begins to grow with it [-].
   real(rk), parameter :: onset_lack = 5.0e-3_rk

   !> A step that errs this much with the tips where they were cannot be taken, whatever they do
   !! [-].
   real(rk), parameter :: much = 4.0_rk

contains

   !> Try a step: state and tips at its end. A tip that would go on for more than one new piece
   !! goes too far, unless the step is the last try: so short that nothing but growth happens in
   !! it, until that arrests. Nothing is accepted yet; a step that does not show an equilibrium
   !! leaves the state before. So does one in which a tip would grow, or might, whose intensities
   !! are not known well enough: its window is a better one then.
   subroutine find_equilibrium(self, dt, is_last, timers, report, trial, error)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      logical, intent(in) :: is_last
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      type(trial_t), intent(out) :: trial
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: tries_max = 25, unstable_tries_max = 1000
      logical :: alike(size(self%tip), size(self%tip))
      logical :: has_begun(size(self%tip)), moves(size(self%tip)), wants(size(self%tip))
      type(tip_t) :: tip(size(self%tip))
      type(segment_t) :: segment(size(self%tip))
      type(network_t) :: network
      integer :: k
      logical :: was_undrained

      was_undrained = self%undrained
      tip = self%tip
      segment = self%segment
      network = self%network
      alike = alike_tips(self)
      has_begun = .false.
      self%before = self%state
      call self%segment%restart()
      do k = 1, merge(unstable_tries_max, tries_max, is_last)
         call place_tips(self)
         call self%try_step(dt, timers, report, error)
         if (allocated(error)) exit
         trial%converged = report%converged
         if (.not. trial%converged) then
            trial%reason = report%reason
            exit
         end if
         if (k == 1 .and. .not. is_last) then
            trial%time_error = self%step_error(dt)
            if (self%errs(trial%time_error/much)) exit
         end if
         call self%evaluate(timers, error)
         if (allocated(error)) exit
         if (.not. is_last) then
            trial%onset = onset(tip%drive%intensity/self%rules%toughness, &
                                self%tip%drive%intensity/self%rules%toughness, &
                                self%tip%arrested .or. self%segment%gain > 0.0_rk)
            if (trial%onset < 1.0_rk) exit
         end if
         call judge_tips(self, alike, moves, wants)
         if (.not. any(moves)) then
            if (.not. any(wants)) then
               trial%time_error = self%step_error(dt)
               trial%advance = maxval([0.0_rk, advances(self)])/self%rules%increment
               if (.not. is_last .and. self%errs(trial%time_error)) exit
               call estimate_coarse_errors(self, timers, error)
               if (allocated(error)) exit
               call improve_windows(self, self%before%time, trial%needs_windows, error)
               if (allocated(error) .or. trial%needs_windows) exit
               return
            end if
            if (any(wants .and. doubtful(self%tip, self%rules%toughness))) then
               call improve_windows(self, self%before%time, trial%needs_windows, error)
               exit
            end if
            trial%goes_too_far = .not. is_last .and. any(wants .and. (has_begun .or. &
                             self%tip%drive%intensity > (1.0_rk + excess_max)*self%rules%toughness))
            if (trial%goes_too_far) exit
            has_begun = has_begun .or. wants
            call begin_segments(self, wants, timers, error)
            if (allocated(error)) exit
         end if
         self%state = self%before
      end do
      trial%goes_too_far = trial%goes_too_far .or. k > tries_max
      ! The cells that segments were begun with stay, closed, for the next try.
      self%state = self%before
      self%tip = tip
      self%segment = segment
      self%network = network
      self%values_are_current = .false.
      if (allocated(error) .or. .not. trial%needs_windows) return
      ! Onsets are looked for from what tips had before the step, and errors known from there; on a
      ! mesh that the step has made that state has no tractions.
      self%undrained = was_undrained
      if (.not. allocated(self%state%tractions)) return
      call self%evaluate(timers, error)
      if (.not. allocated(error)) call estimate_coarse_errors(self, timers, error)
   end subroutine find_equilibrium

   !> The tried state is accepted.
   subroutine accept_equilibrium(self)
      class(two_levels_t), intent(inout) :: self

      self%tip%advance = advances(self)
      where (self%segment%accepted > 0.0_rk) self%tip%kink = 0.0_rk  ! they went straight on
      self%segment%gain = self%segment%gain + self%tip%advance
      call self%segment%accept()
   end subroutine accept_equilibrium

   !> How far the tips are beyond the last accepted state [m].
   function advances(self)
      class(two_levels_t), intent(in) :: self
      real(rk) :: advances(size(self%tip))
      integer(ik) :: i

      do i = 1, size(self%tip, kind=ik)
         advances(i) = end_gain(self%network, self%start, self%tip(i)%fracture, self%tip(i)%end) &
                       - self%segment(i)%gain
      end do
   end function advances

   !> Share of the step after which the first tip reaches the toughness; 1 where none begins to
   !! grow, or where it does so at the end of the step. Tips that have grown before are not asked.
   pure function onset(before, after, has_grown)
      real(rk), intent(in) :: before(:), after(:)  !< K_eq/K_IC of the tips [-]
      logical, intent(in) :: has_grown(:)
      real(rk) :: onset
      integer :: i

      onset = 1.0_rk
      do i = 1, size(before)
         if (has_grown(i) .or. before(i) > 1.0_rk - onset_lack) cycle
         if (after(i) <= 1.0_rk + tolerance) cycle
         onset = min(onset, (1.0_rk - before(i))/(after(i) - before(i)))
      end do
   end function onset

   !> Put the tips of both levels where their segments say.
   subroutine place_tips(self)
      class(two_levels_t), intent(inout) :: self
      integer(ik) :: i, k

      associate (fracture => self%mesh%fracture)
         do i = 1, size(self%tip, kind=ik)
            associate (tip => self%tip(i), segment => self%segment(i))
               if (.not. segment%is_open) cycle
               tip%xy = segment%place()
               tip%direction = segment%direction
               call move_end(self%network, tip%fracture, tip%end, tip%xy)
            end associate
         end do
         do k = 1, fracture%n_tips
            i = findloc(self%tip%fracture == fracture%tip_fracture(k) .and. &
                        self%tip%end == fracture%tip_end(k), .true., dim=1)
            if (i == 0) cycle
            self%model%ahead(k) = norm2(fracture%point_xy(:, fracture%tip_point(k)) &
                                        - self%tip(i)%xy)
         end do
      end associate
   end subroutine place_tips

   !> Let the tips on a segment go where their excess will probably vanish; others want a segment if
   !! they exceed the toughness.
   subroutine judge_tips(self, alike, moves, wants)
      class(two_levels_t), intent(inout) :: self
      logical, intent(in) :: alike(:, :)  !< (tips, tips)
      logical, intent(out) :: moves(:), wants(:)  !< (tips)
      real(rk) :: excess(size(self%tip))
      integer(ik) :: i, leader

      moves = .false.
      wants = .false.
      excess = shared_excess(self%tip%drive%intensity/self%rules%toughness - 1.0_rk, alike)
      do i = 1, size(self%tip, kind=ik)
         associate (tip => self%tip(i), segment => self%segment(i))
            if (tip%arrested .and. .not. segment%is_open) cycle
            leader = findloc(alike(:, i), .true., dim=1)
            if (leader < i .and. segment%is_open .and. self%segment(leader)%is_open) then
               call segment%keep_up_with(self%segment(leader))
               moves(i) = moves(leader)
            else if (segment%is_open) then
               call segment%improve(excess(i), tolerance, moves(i))
            end if
            if (moves(i) .or. excess(i) <= tolerance .or. tip%arrested) cycle
            wants(i) = .not. segment%is_open
            if (segment%is_open) wants(i) = segment%is_complete()
         end associate
      end do
   end subroutine judge_tips

   !> Which tips are alike: they have come equally far, with intensities equal within what these may
   !! be off. Else the last bits of their meshes would decide which of them runs ahead where nothing
   !! else does.
   function alike_tips(self) result(alike)
      class(two_levels_t), intent(in) :: self
      logical :: alike(size(self%tip), size(self%tip))
      real(rk), parameter :: same_gain = 0.02_rk  ! of an increment
      real(rk), parameter :: least = 0.01_rk  ! that intensities may be off [-]
      real(rk) :: off(size(self%tip))
      integer(ik) :: i

      associate (drive => self%tip%drive%intensity, gain => self%segment%gain)
         off = max(0.5_rk*least*max(drive, self%rules%toughness), &
                   hypot(self%tip%intensity%k1_error, self%tip%intensity%k2_error))
         do i = 1, size(self%tip, kind=ik)
            alike(:, i) = abs(gain - gain(i)) <= same_gain*self%rules%increment
            alike(:, i) = alike(:, i) .and. abs(drive - drive(i)) <= off + off(i)
            alike(:, i) = alike(:, i) .and. .not. (self%tip%arrested .or. self%tip(i)%arrested)
            alike(i, i) = .true.
         end do
      end associate
   end function alike_tips

   !> Tips that are alike take the largest of their excesses, and so go on equally far.
   pure function shared_excess(excess, alike) result(shared)
      real(rk), intent(in) :: excess(:)  !< (tips) of K_eq over K_IC [-]
      logical, intent(in) :: alike(:, :)  !< (tips, tips)
      real(rk) :: shared(size(excess))
      integer :: i

      do i = 1, size(excess)
         shared(i) = maxval(excess, mask=alike(:, i))
      end do
   end function shared_excess

   !> New segments for tips, which stand at the ends of their paths: their directions are found in
   !! the tried state; then the coarse level, back in the state before the step, gets their cells.
   subroutine begin_segments(self, wants, timers, error)
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
         associate (tip => self%tip(i), segment => self%segment(i))
            to = end_place(self%coarse_network, tip%fracture, tip%end)
            is_new(i) = .not. norm2(to - tip%xy) > same_place*self%rules%increment
            if (is_new(i)) cycle
            ! An earlier try of this step has begun it, and its path has learned from that.
            tip = self%begun(i)
            call extend(self%network, tip%fracture, tip%end, to)
            call segment%open_segment(tip%origin, tip%direction, norm2(to - tip%origin))
         end associate
      end do
      if (.not. any(is_new)) then
         self%state = self%before
         return
      end if
      call self%grow_by(merge(self%rules%increment, 0.0_rk, is_new), any_grew, timers, error)
      if (allocated(error)) return
      allocate (centres(2, 0))
      do i = 1, size(self%tip, kind=ik)
         associate (tip => self%tip(i))
            if (.not. (is_new(i) .and. tip%advance > 0.0_rk)) cycle
            call self%segment(i)%open_segment(tip%origin, tip%direction, norm2(tip%xy - tip%origin))
            self%begun(i) = tip
            call extend(self%coarse_network, tip%fracture, tip%end, tip%xy)
            centres = reshape([centres, tip%xy], [2, size(centres, 2) + 1])
         end associate
      end do
      self%state = self%before
      if (size(centres, 2) == 0) return
      call self%remesh_coarse(centres, timers, error)
      self%before = self%state
      self%has_new_mesh = .true.
   end subroutine begin_segments

end module twolevel_equilibrium
