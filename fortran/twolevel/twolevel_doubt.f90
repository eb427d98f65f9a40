!> A tip whose intensities are not known does not grow on them: its window is improved first, and
!! where that does not help the run stops.
!!
!! Which part of the stated error is the larger one decides how: the window's own asks for smaller
!! elements, the coarse level's, which comes in over the edge, for an edge farther away, and in the
!! end for none: the body, which tips share. A window stays as good as it was made, and goes along
!! with its tip.
module twolevel_doubt
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_number, only: brief_text
   use report_rows, only: event_window
   use report_watch, only: doubtful, stop_on_doubt, uncertainty
   use twolevel_state, only: two_levels_t
   implicit none(type, external)
   private

   public :: improve_windows

contains

   !> Improve the windows of doubtful tips, which are to be evaluated again then. An error if one of
   !! them cannot be improved any more.
   subroutine improve_windows(self, time, any_improved, error)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< of the last accepted state [s]
      logical, intent(out) :: any_improved
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: what
      integer(ik) :: i

      any_improved = .false.
      do i = 1, size(self%tip, kind=ik)
         associate (tip => self%tip(i), toughness => self%rules%toughness)
            if (.not. doubtful(tip, toughness)) cycle
            call improve_window(self, i, what)
            if (.not. allocated(what)) then
               call stop_on_doubt(self%watch, tip, toughness, &
                                  self%scene%fractures(tip%fracture)%name, &
                                  brief_text(self%state%time, 6)//" s")
               call self%heed_limits(error)
               return
            end if
            any_improved = .true.
            call self%chronicle%add_event(time, event_window, what//": K known to "// &
                                          brief_text(uncertainty(tip, toughness), 3)// &
                                          " % of K_IC before", tip%fracture, tip%xy)
         end associate
      end do
   end subroutine improve_windows

   !> Smaller elements or a larger window, next time it is meshed; in words, if that is possible.
   subroutine improve_window(self, tip, what)
      class(two_levels_t), intent(inout) :: self
      integer(ik), intent(in) :: tip  !< the doubtful one
      character(len=:), allocatable, intent(out) :: what
      real(rk), parameter :: worth_it = 0.2_rk  !< share of the larger part of the error
      !> Beyond this [%] it is not the edge alone, and a window that differs from the body by the
      !> edge alone would have nothing that says so.
      real(rk), parameter :: far_off = 25.0_rk
      logical :: is_finer, takes_body

      takes_body = .false.
      associate (seen => self%windows%tip(tip), &
                 window => self%windows%window(self%windows%window_of(tip)))
         ! What cannot be done leaves the other, if that is worth it. Where the window holds the
         ! body, it differs from that by the elements alone.
         is_finer = seen%of_elements >= seen%of_edge
         if (is_finer .and. .not. seen%can_be_finer()) then
            is_finer = .not. seen%of_edge > worth_it*seen%of_elements
         else if (.not. window%can_be_larger()) then
            is_finer = .true.
         end if
         if (is_finer) then
            if (.not. seen%can_be_finer()) return
            seen%times_finer = seen%times_finer + 1
            what = "smaller elements at the tip"
            if (seen%times_finer > 1) then
               what = "elements of "//brief_text(seen%element_size(self%scene), 3)//" m"
            end if
            if (.not. self%scene%discretization%window_is_body) then
               self%reference%tip(tip)%times_finer = seen%times_finer
               call self%reference%make_anew(tip)
            end if
         else
            if (.not. window%can_be_larger()) return
            takes_body = costs_as_body(self, 2.0_rk*window%edge_length(self%scene)) .and. &
                         uncertainty(self%tip(tip), self%rules%toughness) < far_off
            if (takes_body) then
               what = "the body as its window"
            else
               window%times_larger = window%times_larger + 1
               what = "a window of "//brief_text(window%edge_length(self%scene), 3)//" m"
            end if
         end if
      end associate
      if (takes_body) then
         call self%windows%take_body(tip)
      else
         call self%windows%make_anew(tip)
      end if
   end subroutine improve_window

   !> A window of this size would cost about as much as the body, where that can be one.
   pure logical function costs_as_body(self, edge)
      class(two_levels_t), intent(in) :: self
      real(rk), intent(in) :: edge  !< [m]
      real(rk), parameter :: large = 0.3_rk  ! share of the body's shorter side

      associate (domain => self%scene%domain)
         costs_as_body = edge > large*min(domain%x_max - domain%x_min, domain%y_max - domain%y_min)
      end associate
      costs_as_body = costs_as_body .and. self%mesh%fracture%n_cells <= self%reference_most
   end function costs_as_body

end module twolevel_doubt
