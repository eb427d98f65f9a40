!> What is noted of tips that grow in equilibrium: when each begins, which exceed their toughness
!! from the start, how well lengths and pressures are known, and where tips compete.
module twolevel_notes
   use base_kinds, only: ik, rk
   use base_number, only: brief_text, integer_text
   use growth_company, only: could_part
   use growth_network, only: total_length
   use results_chronicle, only: event_bifurcation, event_growth_onset, event_unstable
   use twolevel_excess, only: tolerance
   use twolevel_onset, only: approach_t
   use twolevel_places, only: tip_cell_lengths
   use twolevel_state, only: two_levels_t
   implicit none(type, external)
   private

   public :: note_certainty, note_excess, notes_t

   !> What has been noted so far.
   type :: notes_t
      type(approach_t), allocatable, private :: approach(:)  !< (tips) to their first growth
      logical, private :: was_bifurcation = .false.  !< in the last step with growth
   contains
      procedure :: begin
      procedure :: note_onsets
      procedure :: note_competition
   end type notes_t

contains

   !> No tip has grown.
   subroutine begin(self, n)
      class(notes_t), intent(out) :: self
      integer, intent(in) :: n  !< tips

      allocate (self%approach(n))
   end subroutine begin

   !> Tips have begun to grow when they reached K_IC; a first advance tells that they have.
   subroutine note_onsets(self, levels)
      class(notes_t), intent(inout) :: self
      class(two_levels_t), intent(inout) :: levels
      real(rk) :: error, onset
      character(len=:), allocatable :: how_well
      integer(ik) :: i

      do i = 1, size(levels%tip, kind=ik)
         associate (tip => levels%tip(i), approach => self%approach(i), &
                    toughness => levels%rules%toughness)
            if (approach%is_over) cycle
            approach%is_over = levels%now%segment(i)%gain > 0.0_rk
            if (approach%is_over) then
               error = approach%uncertainty(tolerance*toughness)
               onset = approach%onset_before(levels%now%coarse%time, toughness)
               how_well = "known to "//brief_text(error, 3)//" s"
               if (.not. error < huge(1.0_rk)) how_well = "K_eq was not rising: not known when"
               call levels%chronicle%add_event(onset, event_growth_onset, how_well, &
                                               tip%fracture, tip%origin)
            else
               call approach%follow(levels%now%coarse%time, tip%drive%intensity, &
                                    norm2([tip%intensity%k1_error, tip%intensity%k2_error]) &
                                    /tip%drive%resistance, &
                                    toughness)
            end if
         end associate
      end do
   end subroutine note_onsets

   !> The tips that the initial state leaves above their toughness. It is what the scene says, so
   !! nothing grows in it; what it bears too much is in no equilibrium and grows at once.
   subroutine note_excess(levels)
      class(two_levels_t), intent(inout) :: levels
      real(rk) :: share
      integer(ik) :: i

      do i = 1, size(levels%tip, kind=ik)
         associate (tip => levels%tip(i))
            share = tip%drive%intensity/levels%rules%toughness
            if (tip%arrested .or. .not. share > 1.0_rk + tolerance) cycle
            call levels%chronicle%add_event(levels%now%coarse%time, event_unstable, "K_eq is "// &
                                            brief_text(share, 4)//" K_IC in the initial "// &
                                            "state: growth is unstable from the start", &
                                            tip%fracture, tip%origin)
         end associate
      end do
   end subroutine note_excess

   !> Tips of which one could run ahead of the others.
   subroutine note_competition(self, levels)
      class(notes_t), intent(inout) :: self
      class(two_levels_t), intent(inout) :: levels
      real(rk) :: lead
      logical :: is_bifurcation
      integer(ik), allocatable :: group(:)
      integer(ik) :: i

      group = pack([(i, i=1, size(levels%tip, kind=ik))], levels%tip%advance > 0.0_rk)
      if (size(group) < 2) return
      lead = levels%now%rivals%preference_of(group)*levels%rules%increment
      is_bifurcation = lead > could_part
      if (is_bifurcation .and. .not. self%was_bifurcation) then
         call levels%chronicle%add_event(levels%now%coarse%time, event_bifurcation, &
                                         integer_text(size(group, kind=ik))// &
                                         " tips grow; a lead of one increment is worth "// &
                                         brief_text(100.0_rk*lead, 3)//" % of K")
      end if
      self%was_bifurcation = is_bifurcation
   end subroutine note_competition

   !> How well length and pressure are known in the state that a step of length dt has led to.
   subroutine note_certainty(levels, dt)
      class(two_levels_t), intent(inout) :: levels
      real(rk), intent(in) :: dt  !< [s]
      real(rk) :: leaked

      leaked = 0.0_rk
      associate (fluid => levels%now%fluid)
         if (fluid%injected > 0.0_rk) leaked = max(0.0_rk, min(1.0_rk, fluid%leaked/fluid%injected))
      end associate
      associate (tip => levels%tip, toughness => levels%rules%toughness, now => levels%now)
         call now%certainty%accept(dt, levels%problem%well_pressure(levels%scene, now%coarse), &
                                   tip%advance > 0.0_rk, tolerance + hypot( &
                                   tip%intensity%k1_error, tip%intensity%k2_error) &
                                   /(toughness*tip%drive%resistance), &
                                   now%segment%steep(now%segment%slope), &
                                   tip_cell_lengths(levels), total_length(levels%network), &
                                   now%trend%pressure_rise(), leaked)
      end associate
   end subroutine note_certainty

end module twolevel_notes
