!> Window refinement: the window of a tip that grows, or might grow within the error of K_eq, is
!! refined if the errors of K_eq lead to considerable errors of pressure or position. Where no
!! refinement is possible, growth continues, and the errors are stated with a warning and an event.
!!
!! The larger part of the error estimate determines the refinement. The error of the window itself
!! requires smaller elements. The error of the coarse level, which enters through the displacement
!! on the edge, requires a larger window, and finally the body as one window for all tips. A window
!! keeps its refined size and elements, and moves with its tip. A refinement that has not reduced
!! the error is taken back, and not followed by another one of its kind: the two levels then differ
!! by something else, such as the history of slip on faces of a new kink. The windows of the loaded
!! tips together are not enlarged beyond the area of the body.
!!
!! An error of K_eq is an error of the pressure at which the tip reaches its toughness, and of the
!! equilibrium position of a growing tip (model.md, section 5). Both are compared with the scales of
!! the scene: the pressure with that of the loads, the position with the length of the fracture.
!! K_IC is no such scale: K of a large fracture is many times K_IC.
module twolevel_refinement
   use base_kinds, only: ik, pi, rk
   use base_number, only: brief_text
   use base_tape, only: tape_t
   use growth_network, only: fracture_length
   use growth_segment, only: segment_t
   use growth_tip, only: tip_t
   use mesh_types, only: network_t
   use report_limits, only: limit_growth_error
   use report_rows, only: event_growth_uncertain, event_window
   use report_watch, only: doubtful, error_of_k, uncertainty
   use twolevel_state, only: two_levels_t
   use twolevel_stepping, only: improve_by_body, improve_edge, improve_elements, refinement_t, &
                                withdraw_edge, withdraw_elements
   use twolevel_window_tip, only: of_edge, of_elements, window_tip_t
   use twolevel_windows, only: windows_t
   implicit none(type, external)
   private

   public :: again_max, find_refinements, growth_error, growth_error_t, is_uncertain
   public :: keep_refinements, note_uncertain_tips, refine_windows

   !> Times that a step is tried again with refined windows. What remains is refined after the step.
   integer, parameter :: again_max = 1

   !> Largest number of refinements in a record.
   integer(ik), parameter :: most_refinements = 100000

   !> Consequences of the error of K_eq of one tip.
   type :: growth_error_t
      real(rk) :: pressure = 0.0_rk  !< error of the pressure at which the tip grows [Pa]
      real(rk) :: position = 0.0_rk  !< error of the position of the tip; 0 before its onset [m]
      !> the larger of the two errors, over the pressure of the loads and the length of the fracture
      !! [-]
      real(rk) :: relative = 0.0_rk
   end type growth_error_t

   !> Relative error above which windows are refined [-].
   real(rk), parameter :: acceptable = 0.01_rk

   !> d K_eq/d p, over sqrt(pi a) of a fracture of half-length a: 1 where the faces are open, less
   !! where they slip under friction [-].
   real(rk), parameter :: response = 0.5_rk

contains

   !> Consequences of the estimated error of K_eq of a tip.
   pure function growth_error(tip, segment, network, toughness, load_pressure) result(error)
      type(tip_t), intent(in) :: tip
      type(segment_t), intent(in) :: segment  !< last path segment of the tip
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      real(rk), intent(in) :: load_pressure  !< largest pressure expected from the loads [Pa]
      type(growth_error_t) :: error
      real(rk) :: length, off

      length = fracture_length(network, tip%fracture)
      off = error_of_k(tip)
      error%pressure = off*tip%drive%resistance/(response*sqrt(0.5_rk*pi*length))
      error%relative = error%pressure/load_pressure
      if (.not. (segment%is_open .or. segment%gain > 0.0_rk)) return
      error%position = off/tip%scale_of(toughness)/abs(segment%falling_slope())
      error%relative = max(error%relative, error%position/length)
   end function growth_error

   !> Whether a tip grows, or might grow within the error of its K_eq, and the error has
   !! considerable consequences.
   pure logical function is_uncertain(tip, segment, network, toughness, load_pressure)
      type(tip_t), intent(in) :: tip
      type(segment_t), intent(in) :: segment  !< last path segment of the tip
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      real(rk), intent(in) :: load_pressure  !< largest pressure expected from the loads [Pa]
      type(growth_error_t) :: error

      is_uncertain = doubtful(tip, toughness)
      if (.not. is_uncertain) return
      error = growth_error(tip, segment, network, toughness, load_pressure)
      is_uncertain = .not. error%relative <= acceptable
   end function is_uncertain

   !> Find refinements of the windows of uncertain tips; empty where none is possible. The tips are
   !! to be evaluated again with the refined windows.
   subroutine find_refinements(self, time, refinements)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< time of the last accepted state [s]
      type(refinement_t), allocatable, intent(out) :: refinements(:)
      type(refinement_t) :: refinement
      character(len=:), allocatable :: what
      integer(ik) :: i

      allocate (refinements(0))
      do i = 1, size(self%tip, kind=ik)
         associate (tip => self%tip(i), toughness => self%rules%toughness)
            if (.not. is_uncertain(tip, self%now%segment(i), self%network, toughness, &
                                   self%load_pressure)) cycle
            refinement%tip = i
            refinement%error = error_of_k(tip)
            call choose(self, i, refinement%error, refinement%kind, what)
            if (.not. allocated(what)) cycle
            refinements = [refinements, refinement]
            call self%chronicle%add_event(time, event_window, what//": K known to "// &
                                          brief_text(uncertainty(tip, toughness), 3)// &
                                          " % of K_IC before", tip%fracture, tip%xy)
         end associate
      end do
   end subroutine find_refinements

   !> Report the uncertain tips of an accepted state: a limit of the run, and an event at the first
   !! such state of each tip.
   subroutine note_uncertain_tips(self, is_noted)
      class(two_levels_t), intent(inout) :: self
      logical, intent(inout) :: is_noted(:)  !< (tips) the event has been written
      type(growth_error_t) :: error
      character(len=:), allocatable :: consequences
      integer(ik) :: i

      do i = 1, size(self%tip, kind=ik)
      associate (tip => self%tip(i), segment => self%now%segment(i), time => self%now%coarse%time, &
                    toughness => self%rules%toughness)
            if (.not. is_uncertain(tip, segment, self%network, toughness, self%load_pressure)) cycle
            error = growth_error(tip, segment, self%network, toughness, self%load_pressure)
            call self%watch%see(limit_growth_error, 100.0_rk*error%relative, &
                                brief_text(time, 6)//" s, fracture "// &
                                trim(self%scene%fractures(tip%fracture)%name), tip%xy)
            if (is_noted(i)) cycle
            is_noted(i) = .true.
            consequences = "K known to "//brief_text(uncertainty(tip, toughness), 3)// &
                           " % of K_IC or K_eq: pressure of growth known to "// &
                           brief_text(error%pressure, 3)//" Pa"
            if (error%position > 0.0_rk) consequences = consequences//", position to "// &
                                                        brief_text(error%position, 3)//" m"
            call self%chronicle%add_event(time, event_growth_uncertain, consequences, &
                                          tip%fracture, tip%xy)
         end associate
      end do
   end subroutine note_uncertain_tips

   !> Choose smaller elements or a larger window for a tip; `what` describes the refinement, and is
   !! unallocated if none is possible.
   subroutine choose(self, tip, error, kind, what)
      class(two_levels_t), intent(in) :: self
      integer(ik), intent(in) :: tip  !< number of the uncertain tip
      real(rk), intent(in) :: error  !< of its intensities [Pa m^1/2]
      integer, intent(out) :: kind
      character(len=:), allocatable, intent(out) :: what
      !> share of the larger part of the error for which the smaller one is reduced [-]
      real(rk), parameter :: worth_it = 0.2_rk
      !> Error [%] above which the body is not used as the window: a larger error is not due to the
      !! edge alone, and a window that differs from the body by the edge alone would not show the
      !! other part.
      real(rk), parameter :: far_off = 25.0_rk
      integer, parameter :: few = 8  ! tips
      type(window_tip_t) :: seen
      logical :: can_be_finer, can_be_larger, is_finer

      kind = improve_edge
      seen = self%now%windows%tip(tip)
      if (seen%can_withdraw(of_elements) .and. seen%is_futile(of_elements, error)) then
         kind = withdraw_elements
         what = "larger elements again, the smaller ones had no effect"
         return
      else if (seen%can_withdraw(of_edge) .and. seen%is_futile(of_edge, error)) then
         kind = withdraw_edge
         what = "a smaller window again, the larger one had no effect"
         return
      end if
      associate (window => self%windows%slot(self%windows%window_of(tip))%window)
         ! If one refinement is impossible, the other one is taken where it reduces the error
         ! noticeably. A window that contains the body differs from it by the elements alone.
         can_be_finer = seen%can_be_finer() .and. .not. seen%is_futile(of_elements, error)
         can_be_larger = window%can_be_larger() .and. .not. seen%is_futile(of_edge, error)
         is_finer = seen%of_elements >= seen%of_edge
         if (is_finer .and. .not. can_be_finer) then
            is_finer = .not. seen%of_edge > worth_it*seen%of_elements
         else if (.not. can_be_larger) then
            is_finer = .true.
         end if
         if (is_finer) then
            kind = improve_elements
            if (.not. can_be_finer) return
            seen%times_finer = seen%times_finer + 1
            what = "smaller elements at the tip"
            if (seen%times_finer > 1) then
               what = "elements of "//brief_text(seen%element_size(self%scene), 3)//" m"
            end if
         else if (can_be_larger) then
            what = "a window of "//brief_text(2.0_rk*window%edge_length(), 3)//" m"
            if (costs_as_body(self, 2.0_rk*window%edge_length()) .and. &
                uncertainty(self%tip(tip), self%rules%toughness) < far_off) then
               kind = improve_by_body
               what = "the body as its window"
               ! In a network it costs as much as the windows of all tips.
               if (count(self%tip%is_loaded()) > few) deallocate (what)
            else if (exceed_body(self, tip)) then
               deallocate (what)
            end if
         end if
      end associate
   end subroutine choose

   !> Refine the windows when they are meshed the next time.
   subroutine refine_windows(self, refinements)
      class(two_levels_t), intent(inout) :: self
      type(refinement_t), intent(in) :: refinements(:)
      integer :: k

      do k = 1, size(refinements)
         associate (i => refinements(k)%tip, windows => self%windows, &
                    seen => self%now%windows%tip(refinements(k)%tip))
            select case (refinements(k)%kind)
            case (improve_elements)
               call note_error(seen, of_elements, refinements(k)%error)
               call change_elements(self, i, 1)
            case (withdraw_elements)
               call withdraw(seen, of_elements)
               call change_elements(self, i, -1)
            case (improve_edge)
               call note_error(seen, of_edge, refinements(k)%error)
               call change_edge(windows, i, 1, seen)
            case (withdraw_edge)
               call withdraw(seen, of_edge)
               call change_edge(windows, i, -1, seen)
            case default
               call note_error(seen, of_edge, refinements(k)%error)
               seen%can_withdraw(of_edge) = .false.
               call windows%take_body(i, seen)
            end select
         end associate
      end do
   end subroutine refine_windows

   !> Record refinements, or take them from the record.
   subroutine keep_refinements(tape, refinements)
      type(tape_t), intent(inout) :: tape
      type(refinement_t), allocatable, intent(inout) :: refinements(:)
      integer(ik) :: i, n

      n = size(refinements, kind=ik)
      call tape%keep("refinements", n)
      if (n < 0 .or. n > most_refinements) return
      if (n /= size(refinements)) then
         deallocate (refinements)
         allocate (refinements(n))
      end if
      if (n == 0) return
      do i = 1, n
         call tape%keep("tip", refinements(i)%tip)
         call tape%keep("kind", refinements(i)%kind)
         call tape%keep("error", refinements(i)%error)
      end do
   end subroutine keep_refinements

   !> Store the error before a refinement, with which its effect is judged.
   pure subroutine note_error(seen, part, error)
      type(window_tip_t), intent(inout) :: seen
      integer, intent(in) :: part  !< of_elements or of_edge
      real(rk), intent(in) :: error  !< [Pa m^1/2]

      seen%refined_at(part) = error
      seen%can_withdraw(part) = .true.
      seen%was_withdrawn(part) = .false.
   end subroutine note_error

   !> Note that a refinement is taken back.
   pure subroutine withdraw(seen, part)
      type(window_tip_t), intent(inout) :: seen
      integer, intent(in) :: part  !< of_elements or of_edge

      seen%can_withdraw(part) = .false.
      seen%was_withdrawn(part) = .true.
   end subroutine withdraw

   !> Make the elements around a tip smaller or larger, in the reference too.
   subroutine change_elements(self, i, by)
      class(two_levels_t), intent(inout) :: self
      integer(ik), intent(in) :: i  !< tip
      integer, intent(in) :: by  !< halvings

      associate (seen => self%now%windows%tip(i))
         seen%times_finer = seen%times_finer + by
         call self%windows%mesh_again(i, seen)
         if (self%scene%discretization%window_is_body) return
         self%now%reference%tip(i)%times_finer = seen%times_finer
      end associate
      call self%reference%mesh_again(i, self%now%reference%tip(i))
   end subroutine change_elements

   !> Make the window of a tip larger or smaller.
   subroutine change_edge(windows, i, by, seen)
      type(windows_t), intent(inout) :: windows
      integer(ik), intent(in) :: i  !< tip
      integer, intent(in) :: by  !< doublings
      type(window_tip_t), intent(inout) :: seen  !< data of this tip

      associate (window => windows%slot(windows%window_of(i))%window)
         window%times_larger = window%times_larger + by
      end associate
      call windows%mesh_again(i, seen)
   end subroutine change_edge

   !> Whether the windows of the loaded tips together would be larger than the body if the window of
   !! a tip had twice its edge.
   pure logical function exceed_body(self, tip)
      class(two_levels_t), intent(in) :: self
      integer(ik), intent(in) :: tip
      real(rk) :: area, body(2)
      integer(ik) :: w

      associate (domain => self%scene%domain, windows => self%windows)
         body = [domain%x_max - domain%x_min, domain%y_max - domain%y_min]
         area = 0.0_rk
         do w = 1, size(windows%slot, kind=ik)
            if (.not. windows%is_active(w, self%tip)) cycle
            associate (edge => merge(2.0_rk, 1.0_rk, w == windows%window_of(tip)) &
                       *windows%slot(w)%window%edge_length())
               area = area + product(min(body, edge))
            end associate
         end do
      end associate
      exceed_body = area > product(body)
   end function exceed_body

   !> Whether a window of this size would cost about as much as the body, where the body can be the
   !! window.
   pure logical function costs_as_body(self, edge)
      class(two_levels_t), intent(in) :: self
      real(rk), intent(in) :: edge  !< [m]
      real(rk), parameter :: large = 0.3_rk  ! share of the body's shorter side [-]

      associate (domain => self%scene%domain)
         costs_as_body = edge > large*min(domain%x_max - domain%x_min, domain%y_max - domain%y_min)
      end associate
      costs_as_body = costs_as_body .and. self%problem%mesh%fracture%n_cells <= self%reference_most
   end function costs_as_body

end module twolevel_refinement
