!> Tip interaction in scenes with a fluid: measured in a tried step by setting back one tip after
!! the other, and improved by Broyden updates in the tries that follow.
!!
!! The step begins from the previous state, so the fluid volume supplied by the wells is fixed. The
!! coarse level keeps mesh and factors, since tips lie anywhere in their cells (coarse_tips). A tip
!! costs one solution of the coarse level, two meshes of the windows that contain the tip, and one
!! solution of each window.
module twolevel_probe
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: timers_t
   use coarse_state, only: go_back, state_t, step_report_t
   use growth_interaction, only: interaction_t
   use growth_segment, only: segment_t
   use growth_tip, only: tip_t
   use twolevel_places, only: place_tips
   use twolevel_state, only: two_levels_t
   implicit none(type, external)
   private

   public :: evaluated, previous_try_t, measure_interaction

   !> Distance by which a tip is set back, over the length of its segment: the intensities of new
   !! meshes differ by some tenths of a per cent [-].
   real(rk), parameter :: probe = 0.4_rk

   !> Data of a try for the Broyden update in the next one.
   type :: previous_try_t
      real(rk), allocatable :: reached(:)  !< (tips) positions along their segments [m]
      real(rk), allocatable :: excess(:)  !< (tips) excesses over the toughness [-]
   contains
      procedure :: begin
      procedure :: update_interaction
   end type previous_try_t

contains

   !> Measure missing columns of the tip interaction matrix, if several tips are in play. If columns
   !! have been measured, the coarse level and the windows are to be evaluated again.
   subroutine measure_interaction(self, in_play, dt, timers, has_measured, error)
      class(two_levels_t), intent(inout) :: self
      logical, intent(in) :: in_play(:)  !< (tips)
      real(rk), intent(in) :: dt  !< [s]
      type(timers_t), intent(inout) :: timers
      logical, intent(out) :: has_measured
      type(error_t), allocatable, intent(out) :: error
      type(state_t) :: state
      type(tip_t) :: tip(size(self%tip))
      type(step_report_t) :: report
      real(rk) :: shift
      integer(ik), allocatable :: columns(:)
      logical :: is_column(size(self%tip))
      integer(ik) :: i, k

      allocate (columns(0))
      if (count(in_play) >= 2) then
         columns = self%now%interaction%columns_to_measure(pack([(i, i=1, size(self%tip, &
                                                                             kind=ik))], in_play), &
                                                           self%now%segment)
      end if
      is_column = [(any(columns == i), i=1, size(self%tip, kind=ik))]
      call self%tape%keep("probes", is_column)
      if (self%tape%follows) columns = pack([(i, i=1, size(self%tip, kind=ik))], is_column)
      has_measured = size(columns) > 0
      if (.not. has_measured) return
      state = self%now%coarse
      tip = self%tip
      do k = 1, size(columns, kind=ik)
         associate (segment => self%now%segment(columns(k)))
            shift = -probe*segment%length
            segment%reached = segment%reached + shift
            call place_tips(self%front_state_t, self%now%segment, self%problem)
            call go_back(self%now%coarse, self%before)
            call self%try_step(dt, timers, report, error)
            if (allocated(error)) return
            if (report%converged) then
               call self%evaluate(timers, error)
               if (allocated(error)) return
               call self%now%interaction%store_column(columns(k), shift, &
                                                      tip%excess(self%rules%toughness), &
                                                      self%tip%excess(self%rules%toughness), &
                                                      evaluated(self), segment)
            end if
            segment%reached = segment%reached - shift
         end associate
      end do
      call place_tips(self%front_state_t, self%now%segment, self%problem)
      self%tip = tip
      call go_back(self%now%coarse, state)
   end subroutine measure_interaction

   !> Tips that are evaluated in the tries of a step.
   pure function evaluated(self)
      class(two_levels_t), intent(in) :: self
      logical :: evaluated(size(self%tip))

      evaluated = .true.
      if (allocated(self%now%active)) evaluated = self%now%active
   end function evaluated

   !> Store a try.
   subroutine begin(self, segments, tips, toughness)
      class(previous_try_t), intent(out) :: self
      type(segment_t), intent(in) :: segments(:)  !< (tips)
      type(tip_t), intent(in) :: tips(:)
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]

      self%reached = segments%reached
      self%excess = tips%excess(toughness)
   end subroutine begin

   !> Broyden update of the tip interaction matrix with the changes since the last try.
   subroutine update_interaction(self, segments, tips, toughness, is_evaluated, interaction)
      class(previous_try_t), intent(in) :: self
      type(segment_t), intent(in) :: segments(:)  !< (tips)
      type(tip_t), intent(in) :: tips(:)
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      logical, intent(in) :: is_evaluated(:)  !< (tips)
      type(interaction_t), intent(inout) :: interaction

      if (.not. allocated(self%reached)) return
      call interaction%update(segments%reached - self%reached, &
                              tips%excess(toughness) - self%excess, is_evaluated)
   end subroutine update_interaction

end module twolevel_probe
