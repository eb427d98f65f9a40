!> The windows of the tips that are evaluated in each try of a step are together not larger than the
!! body as one window: where they would have more unknowns, all tips take the body. This is decided
!! in accepted states, and again only when the windows have grown considerably, since it costs a
!! mesh of the body. Windows of tips far below their toughness do not count: they are evaluated once
!! per step, the body in each try.
module twolevel_window_total
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: phase_tips, timers_t
   use growth_tip, only: tip_t
   use report_rows, only: event_window
   use twolevel_coarse_errors, only: estimate_coarse_errors
   use twolevel_state, only: two_levels_t
   use twolevel_window, only: window_t
   implicit none(type, external)
   private

   public :: limit_windows

   !> Growth of the number of unknowns after which the body is meshed again for comparison [-].
   real(rk), parameter :: considerable = 1.25_rk

contains

   !> Replace the windows by the body where they have more unknowns, and evaluate the tips in it, at
   !! the beginning of a step: the slip of the accepted state is the history of this solution too.
   subroutine limit_windows(self, timers, error)
      class(two_levels_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      ! lack of toughness, error included, beyond which tips are evaluated once per step [-]
      real(rk), parameter :: far = 0.1_rk
      type(tip_t) :: tips(size(self%tip))
      integer(ik) :: n, n_body

      if (.not. self%scene%growth%intensities .or. .not. self%has_reference()) return
      tips = self%tip
      associate (toughness => self%rules%toughness)
         where (tips%excess(toughness) + tips%relative_error(toughness) < -far)
            tips%is_carried = .true.
         end where
      end associate
      n = self%windows%n_unknowns(tips)
      ! The reference has larger elements than the windows, and so fewer unknowns than the body.
      if (n <= max(self%reference%n_unknowns(self%tip), &
                   int(considerable*self%compared_unknowns, ik))) return
      self%compared_unknowns = n
      call timers%start(phase_tips)
      call count_unknowns(self, n_body, error)
      call timers%stop(phase_tips)
      if (allocated(error) .or. n <= n_body) return
      call self%windows%share_body(self%now%windows%tip)
      call self%chronicle%add_event(self%now%coarse%time, event_window, "the body as one "// &
                                    "window for all tips: fewer unknowns than in their windows")
      if (allocated(self%now%coarse%tractions)) then
         call self%evaluate(timers, error)
         if (.not. allocated(error)) call estimate_coarse_errors(self, timers, error)
      end if
      if (.not. allocated(error)) call self%begin_step()
   end subroutine limit_windows

   !> Number of unknowns of the body as one window for all tips, with elements as small as those of
   !! their windows.
   subroutine count_unknowns(self, n, error)
      class(two_levels_t), intent(in) :: self
      integer(ik), intent(out) :: n
      type(error_t), allocatable, intent(out) :: error
      type(window_t) :: body
      integer(ik) :: i

      n = 0
      body%is_body = .true.
      body%serves = [(i, i=1, size(self%tip, kind=ik))]
      call body%build(self%scene, self%network, self%now%windows%tip, .false., error)
      if (.not. allocated(error)) n = 2*body%model%mesh%n_nodes
   end subroutine count_unknowns

end module twolevel_window_total
