!> Event log of tips that grow in equilibrium: onset of growth, tips above their toughness at the
!! start, errors of length and pressure, and competition of tips.
module twolevel_notes
   use, intrinsic :: iso_c_binding, only: c_loc
   use base_archive, only: archive_t
   use base_kinds, only: ik, lk, rk
   use base_number, only: brief_text, integer_text, place_text
   use base_plane, only: norm2
   use growth_interaction, only: could_separate, interaction_t
   use growth_front, only: front_state_t
   use growth_network, only: total_length
   use growth_segment, only: segment_t
   use growth_targets, only: target_none
   use growth_tip, only: tip_t
   use report_rows, only: chronicle_t, event_bifurcation, event_growth_onset, event_unstable
   use scene_types, only: fracture_t, growth_t, scene_t
   use twolevel_errors, only: by_flow, tip_excess_t
   use twolevel_jumps, only: jumps_t
   use twolevel_levels_state, only: levels_state_t
   use twolevel_moves, only: tolerance
   use twolevel_onset, only: approach_t
   use twolevel_places, only: tip_cell_lengths
   use twolevel_problem, only: coarse_problem_t
   use twolevel_schedule, only: last_switch
   implicit none(type, external)
   private

   public :: note_stated_errors, note_excess, notes_t, states_errors

   !> Events written so far, and the data for those to come.
   type :: notes_t
      !> (tips) data before the onset of growth
      type(approach_t), allocatable, private :: approach(:)
      !> (tips) considerable errors of growth have been stated
      logical, allocatable :: is_uncertain(:)
      logical, private :: was_bifurcation = .false.  !< tips competed in the last step with growth
      !> (tips, tips) whether the two tips have grown as members of one group, and have separated
      integer, allocatable, private :: relation(:, :)
      !> (tips) the tip has separated from a tip of its group
      logical, allocatable, private :: has_separated(:)
      type(jumps_t) :: jumps  !< growth without equilibrium
   contains
      procedure :: begin
      procedure :: note_onsets
      procedure :: note_competition
      procedure :: note_separation
      procedure :: visit
   end type notes_t

   ! Tips have not grown as members of one group, or have separated with another K_eq; they are
   ! members of one group; they have separated by chance.
   integer, parameter :: apart = 0, together = 1, separated = 2

contains

   !> Start before any growth.
   subroutine begin(self, n)
      class(notes_t), intent(out) :: self
      integer, intent(in) :: n  !< tips

      allocate (self%approach(n))
      allocate (self%is_uncertain(n), self%has_separated(n), source=.false.)
      allocate (self%relation(n, n), source=apart)
      call self%jumps%begin(n)
   end subroutine begin

   !> Report the onset of growth: the time at which the tip reached K_IC, once the tip has advanced
   !! for the first time.
   subroutine note_onsets(self, tips, segments, toughness, time, chronicle)
      class(notes_t), intent(inout) :: self
      type(tip_t), intent(in) :: tips(:)
      type(segment_t), intent(in) :: segments(:)  !< (tips)
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      real(rk), intent(in) :: time  !< [s]
      type(chronicle_t), intent(inout) :: chronicle
      real(rk) :: error, onset
      character(len=:), allocatable :: how_well
      integer(ik) :: i

      do i = 1, size(tips, kind=ik)
         associate (tip => tips(i), approach => self%approach(i))
            if (approach%is_over) cycle
            approach%is_over = segments(i)%gain > 0.0_rk
            if (approach%is_over) then
               error = approach%uncertainty(tolerance*tip%scale_of(toughness))
               onset = approach%onset_before(time, toughness)
               how_well = "known to "//brief_text(error, 3)//" s"
               if (.not. error < huge(1.0_rk)) how_well = "K_eq was not increasing: time unknown"
               call chronicle%add_event(onset, event_growth_onset, how_well, tip%fracture, &
                                        tip%origin)
            else
               call approach%follow(time, tip%drive%intensity, &
                                    norm2([tip%intensity%k1_error, tip%intensity%k2_error]) &
                                    /tip%drive%resistance, toughness)
            end if
         end associate
      end do
   end subroutine note_onsets

   !> Report the tips above their toughness in the initial state. Tips do not grow in the state that
   !! the scene prescribes; above the toughness they are not in equilibrium, and grow in the first
   !! step.
   subroutine note_excess(tips, toughness, time, chronicle)
      type(tip_t), intent(in) :: tips(:)
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      real(rk), intent(in) :: time  !< [s]
      type(chronicle_t), intent(inout) :: chronicle
      real(rk) :: share
      integer(ik) :: i

      do i = 1, size(tips, kind=ik)
         if (tips(i)%arrested .or. .not. tips(i)%excess(toughness) > tolerance) cycle
         share = tips(i)%drive%intensity/toughness
         call chronicle%add_event(time, event_unstable, "K_eq is "//brief_text(share, 4)// &
                                  " K_IC in the initial state: growth is unstable from the "// &
                                  "start", tips(i)%fracture, tips(i)%origin)
      end do
   end subroutine note_excess

   !> Report tips of which one could run ahead of the others.
   subroutine note_competition(self, tips, interaction, increment, time, chronicle)
      class(notes_t), intent(inout) :: self
      type(tip_t), intent(in) :: tips(:)
      type(interaction_t), intent(in) :: interaction
      real(rk), intent(in) :: increment(:)  !< (tips) [m]
      real(rk), intent(in) :: time  !< [s]
      type(chronicle_t), intent(inout) :: chronicle
      real(rk) :: lead
      logical :: is_bifurcation
      integer(ik), allocatable :: group(:)
      integer(ik) :: i

      group = pack([(i, i=1, size(tips, kind=ik))], tips%advance > 0.0_rk)
      if (size(group) < 2) return
      lead = interaction%preference_of(group)*minval(increment(group))
      is_bifurcation = lead > could_separate
      if (is_bifurcation .and. .not. self%was_bifurcation) then
         call chronicle%add_event(time, event_bifurcation, integer_text(size(group, kind=ik))// &
                                  " tips grow; a lead of one increment changes K_eq by "// &
                                  brief_text(100.0_rk*lead, 3)//" %")
      end if
      self%was_bifurcation = is_bifurcation
   end subroutine note_competition

   !> Tips that have grown in one group and have separated with equal K_eq, once their gains differ
   !! noticeably: only errors have separated them, and it is chance which is ahead; the difference
   !! is part of the errors of their positions. Tips that have ended on a target have another reason
   !! to stay behind.
   subroutine note_separation(self, tips, now, toughness, increment, chronicle)
      class(notes_t), intent(inout) :: self
      type(tip_t), intent(in) :: tips(:)
      type(levels_state_t), intent(inout) :: now
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      real(rk), intent(in) :: increment(:)  !< (tips) [m]
      type(chronicle_t), intent(inout) :: chronicle
      ! noticeable difference of gains, over the shorter increment and over the larger gain
      real(rk), parameter :: least = 0.025_rk
      character(len=:), allocatable :: what
      real(rk) :: by, lead(size(tips))
      integer(ik) :: ahead, behind, i, j
      logical :: is_chance

      lead = 0.0_rk
      if (.not. (allocated(now%groups%kind) .and. allocated(now%stated_errors%tip))) return
      do j = 2, size(tips, kind=ik)
         do i = 1, j - 1
            associate (gain => now%segment([i, j])%gain, groups => now%groups, &
                       error => now%stated_errors%tip, shorter => minval(increment([i, j])))
               if (any(tips([i, j])%target /= target_none)) then
                  self%relation(i, j) = apart
               else if (groups%kind(i) == groups%kind(j) .and. all(gain > 0.0_rk)) then
                  self%relation(i, j) = together
               else if (self%relation(i, j) == together) then
                  ! A tip of another fracture that has fallen behind has other fluid.
                  is_chance = tips(i)%fracture == tips(j)%fracture .or. &
                              .not. any(groups%is_alone([i, j]))
                  if (is_chance) then
                     is_chance = groups%differ_by_chance(i, j, tips%excess(toughness), &
                                                         tips%relative_error(toughness))
                  end if
                  self%relation(i, j) = merge(separated, apart, is_chance)
               end if
               if (self%relation(i, j) /= separated) cycle
               by = abs(gain(1) - gain(2))
               lead([i, j]) = max(lead([i, j]), by)
               if (all(self%has_separated([i, j]))) cycle
               if (.not. by > least*max(shorter, maxval(gain))) cycle
               ahead = merge(i, j, gain(1) > gain(2))
               behind = merge(j, i, gain(1) > gain(2))
               what = "this tip is ahead of an equal one at "// &
                      place_text(tips(behind)%xy)//" by "//brief_text(by, 3)//" m, "// &
                      merge("more than", "less than", by > error(i) + error(j))// &
                      " their errors: which one is ahead is chance"
               call chronicle%add_event(now%coarse%time, event_bifurcation, what, &
                                        tips(ahead)%fracture, tips(ahead)%xy)
               self%has_separated([i, j]) = .true.
            end associate
         end do
      end do
      call now%stated_errors%add_leads(lead)
   end subroutine note_separation

   !> Whether errors of length and pressure are estimated: not with increments of prescribed length.
   pure logical function states_errors(growth)
      type(growth_t), intent(in) :: growth

      states_errors = growth%in_equilibrium() .or. .not. growth%enabled
   end function states_errors

   !> Update the estimated errors of length and pressure after a step of length dt.
   subroutine note_stated_errors(scene, front, problem, load_errors, dt, now, notes)
      type(scene_t), intent(in) :: scene
      type(front_state_t), intent(in) :: front
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: load_errors(:, :)  !< (2, tips) of K, by the load [Pa m^1/2]
      real(rk), intent(in) :: dt  !< [s]
      type(levels_state_t), intent(inout) :: now
      type(notes_t), intent(inout) :: notes
      real(rk), parameter :: noticeable = 1.01_rk  ! apparent toughness, over K_IC [-]
      type(tip_excess_t) :: tips(size(front%tip))
      real(rk) :: leaked, position_error(size(front%tip))
      integer(ik) :: i

      leaked = 0.0_rk
      associate (fluid => now%fluid)
         if (fluid%injected > 0.0_rk) leaked = max(0.0_rk, min(1.0_rk, fluid%leaked/fluid%injected))
      end associate
      associate (tip => front%tip, toughness => scene%material%toughness)
         tips%grows = tip%advance > 0.0_rk
         tips%error = tolerance + hypot(tip%intensity%k1_error, tip%intensity%k2_error) &
                      /(tip%scale_of(toughness)*tip%drive%resistance)
         tips%slope = now%segment%falling_slope()
         tips%cell = tip_cell_lengths(tip, problem)
         where (tip%viscous_rise > noticeable .and. tips%grows .and. tips%cell > 0.0_rk) &
            tips%by_flow = by_flow(tip%advance, tips%cell)
         position_error = 0.0_rk
         if (allocated(now%stated_errors%tip)) position_error = now%stated_errors%tip
         call notes%jumps%follow(tip, toughness, position_error, dt, now%coarse%time, tips%jump, &
                                 tips%by_time, load_errors)
         tips%jump = max(tips%jump, notes%approach%early_growth(now%segment%gain, now%coarse%time, &
                                                                tolerance*tip%scale_of(toughness)))
         do i = 1, size(tips, kind=ik)
            call find_wing(scene%fractures(tip(i)%fracture), tip(i), tips(i)%wing, tips(i)%bend)
         end do
         now%stated_errors%has_layers = problem%model%layers%n > 0
         call now%stated_errors%accept(dt, problem%well_pressure(now%coarse), tips, &
                                       total_length(front%network), now%trend%pressure_rise(), &
                                       leaked, now%coarse%time &
                                       - last_switch(scene, now%coarse%time - 0.5_rk*dt))
         if (.not. scene%growth%enabled) return
         call now%stated_errors%await_growth(tip%is_loaded() .and. tip%excess(toughness) &
                                             + tips%error >= 0.0_rk, any(tips%grows), &
                                             total_length(front%network), &
                                             sum(problem%model%condensed%length &
                                                 *now%coarse%aperture))
      end associate
   end subroutine note_stated_errors

   !> Distance of a tip from the end of the fracture that it has grown from, and the sine of the
   !! angle between this wing and the fracture; 1 where the wing turns back.
   pure subroutine find_wing(fracture, tip, length, bend)
      type(fracture_t), intent(in) :: fracture  !< as given in the scene
      type(tip_t), intent(in) :: tip
      real(rk), intent(out) :: length  !< [m]
      real(rk), intent(out) :: bend  !< [-]
      real(rk) :: along(2), wing(2)
      integer(ik) :: at, behind

      at = merge(1_ik, size(fracture%x, kind=ik), tip%end == 1)
      behind = at + merge(1_ik, -1_ik, tip%end == 1)
      associate (x => fracture%x, y => fracture%y)
         along = [x(at) - x(behind), y(at) - y(behind)]
         wing = tip%xy - [x(at), y(at)]
      end associate
      length = norm2(wing)
      bend = 0.0_rk
      if (.not. length > 0.0_rk) return
      bend = abs(along(1)*wing(2) - along(2)*wing(1))/(norm2(along)*length)
      if (dot_product(along, wing) < 0.0_rk) bend = 1.0_rk
   end subroutine find_wing

   !> Store or load all components.
   subroutine visit(self, archive)
      class(notes_t), intent(inout), target :: self
      type(archive_t), intent(inout) :: archive
      integer(lk) :: n

      call archive%extent("approach", self%approach, n, "tips ?")
      if (archive%is_loading) then
         if (allocated(self%approach)) deallocate (self%approach)
         if (n >= 0_lk) allocate (self%approach(n))
      end if
      if (n > 0_lk) call archive%plain("approach", c_loc(self%approach), &
         & n*storage_size(self%approach)/8_lk)
      call archive%list("is_uncertain", self%is_uncertain, "tips")
      call archive%item("was_bifurcation", self%was_bifurcation)
      call archive%list("relation", self%relation, "tips, tips")
      call archive%list("has_separated", self%has_separated, "tips")
      call self%jumps%visit(archive)
   end subroutine visit

end module twolevel_notes
