!> Growth as equilibrium (model.md section 5): at the end of a time step each tip has either not
!! advanced and K_eq <= K_IC, or advanced so far that K_eq = K_IC.
!!
!! Within a step the coarse level is solved from the state before with the tips where they are
!! tried to be, the windows give the intensities there, and each tip goes on until its excess
!! vanishes. A tip lies anywhere along the last straight piece of its path: the coarse mesh has a cell for all
!! of that piece, and its springs say how much of it is behind the tip (coarse_tips); so the coarse
!! mesh changes once per piece, and neither its matrix nor the fluid's volume jumps. A piece begins
!! in the direction in which K_II vanishes at its end (growth_path).
module twolevel_equilibrium
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use base_tolerances, only: same_place
   use coarse_state, only: state_t, step_report_t
   use growth_network, only: end_gain, end_place, extend, move_end
   use growth_segment, only: segment_t
   use growth_tip, only: tip_t
   use mesh_types, only: network_t
   use twolevel_state, only: two_levels_t
   implicit none(type, external)
   private

   public :: accept_equilibrium, find_equilibrium

   real(rk), parameter :: tolerance = 5.0e-3_rk  !< on K_eq/K_IC of growing tips [-]

   !> Excess of K_eq over K_IC, relative to that, beyond which no segment begins in a tried step:
   !! its direction would be that of a state that never is.
   real(rk), parameter :: excess_max = 0.2_rk

contains

   !> Try a step: state and tips at its end. Where a tip would go on for more than one new piece,
   !! `is_too_long`, unless growth is `unstable`: so short a step that nothing but growth happens in
   !! it, until it arrests. Nothing is accepted yet; a report without convergence or a step that is
   !! too long leaves the state before.
   subroutine find_equilibrium(self, dt, is_unstable, timers, report, is_too_long, error)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      logical, intent(in) :: is_unstable
      type(timers_t), intent(inout) :: timers
      type(step_report_t), intent(out) :: report
      logical, intent(out) :: is_too_long
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: tries_max = 25, unstable_tries_max = 1000
      logical :: has_begun(size(self%tip)), moves(size(self%tip)), wants(size(self%tip))
      type(state_t) :: before
      type(tip_t) :: tip(size(self%tip))
      type(segment_t) :: segment(size(self%tip))
      type(network_t) :: network
      integer :: k

      tip = self%tip
      segment = self%segment
      network = self%network
      is_too_long = .false.
      has_begun = .false.
      before = self%state
      call self%segment%restart()
      do k = 1, merge(unstable_tries_max, tries_max, is_unstable)
         call place_tips(self)
         call self%try_step(dt, timers, report, error)
         if (allocated(error) .or. .not. report%converged) exit
         call self%evaluate(timers, error)
         if (allocated(error)) exit
         call judge_tips(self, moves, wants)
         if (.not. any(moves)) then
            if (.not. any(wants)) return
            is_too_long = .not. is_unstable .and. any(wants .and. (has_begun .or. &
                             self%tip%drive%intensity > (1.0_rk + excess_max)*self%rules%toughness))
            if (is_too_long) exit
            has_begun = has_begun .or. wants
            call begin_segments(self, wants, before, timers, error)
            if (allocated(error)) exit
            before = self%state
         end if
         self%state = before
      end do
      if (.not. allocated(error) .and. report%converged) is_too_long = .true.
      ! The cells that segments were begun with stay, closed, for the next try.
      self%state = before
      self%tip = tip
      self%segment = segment
      self%network = network
      self%values_are_current = .false.
   end subroutine find_equilibrium

   !> The tried state is accepted.
   subroutine accept_equilibrium(self)
      class(two_levels_t), intent(inout) :: self
      real(rk) :: gain
      integer(ik) :: i

      do i = 1, size(self%tip, kind=ik)
         associate (tip => self%tip(i), segment => self%segment(i))
            if (segment%accepted > 0.0_rk) tip%kink = 0.0_rk  ! it went straight on
            gain = end_gain(self%network, self%start, tip%fracture, tip%end)
            tip%advance = gain - segment%gain
            segment%gain = gain
         end associate
      end do
      call self%segment%accept()
   end subroutine accept_equilibrium

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
   subroutine judge_tips(self, moves, wants)
      class(two_levels_t), intent(inout) :: self
      logical, intent(out) :: moves(:), wants(:)  !< (tips)
      real(rk) :: excess
      integer(ik) :: i

      moves = .false.
      wants = .false.
      do i = 1, size(self%tip, kind=ik)
         associate (tip => self%tip(i), segment => self%segment(i))
            if (tip%arrested .and. .not. segment%is_open) cycle
            excess = tip%drive%intensity/self%rules%toughness - 1.0_rk
            if (segment%is_open) call segment%improve(excess, tolerance, moves(i))
            if (moves(i) .or. excess <= tolerance .or. tip%arrested) cycle
            wants(i) = .not. segment%is_open
            if (segment%is_open) wants(i) = segment%is_complete()
         end associate
      end do
   end subroutine judge_tips

   !> New segments for tips, which stand at the ends of their paths: their directions are found in
   !! the tried state; then the coarse level, back in the state before the step, gets their cells.
   subroutine begin_segments(self, wants, before, timers, error)
      class(two_levels_t), intent(inout) :: self
      logical, intent(in) :: wants(:)  !< (tips)
      type(state_t), intent(in) :: before
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
            ! An earlier try of this step has begun it.
            call extend(self%network, tip%fracture, tip%end, to)
            call segment%open_segment(tip%xy, (to - tip%xy)/norm2(to - tip%xy), norm2(to - tip%xy))
         end associate
      end do
      if (.not. any(is_new)) then
         self%state = before
         return
      end if
      call self%grow_by(merge(self%rules%increment, 0.0_rk, is_new), any_grew, timers, error)
      if (allocated(error)) return
      allocate (centres(2, 0))
      do i = 1, size(self%tip, kind=ik)
         associate (tip => self%tip(i))
            if (.not. (is_new(i) .and. tip%advance > 0.0_rk)) cycle
            call self%segment(i)%open_segment(tip%origin, tip%direction, norm2(tip%xy - tip%origin))
            call extend(self%coarse_network, tip%fracture, tip%end, tip%xy)
            centres = reshape([centres, tip%xy], [2, size(centres, 2) + 1])
         end associate
      end do
      self%state = before
      if (size(centres, 2) == 0) return
      call self%remesh_coarse(centres, timers, error)
      self%has_new_mesh = .true.
   end subroutine begin_segments

end module twolevel_equilibrium
