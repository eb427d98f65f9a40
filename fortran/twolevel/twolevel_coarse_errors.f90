!> Error estimates of the intensities of the windows: the contribution of the coarse level.
!!
!! A window takes the displacement on its edge and the pressure of the rock from the coarse level.
!!   - The error of the edge follows from a comparison with the whole body as one window for all
!!     tips, which takes nothing on its edge: the difference of K, and the error of K there, which
!!     is that of its elements alone. No factor of safety is therefore needed. The comparison costs
!!     about as much as the windows, and is repeated where tips have moved or K has changed and
!!     their growth could not be judged without it.
!!   - The rock's pressure is linear in each cell. A quarter of the change of K with the pressures
!!     of the cells' middles counts as error: slip changes the pressure of the rock around a tip,
!!     and layers that are thinner than a cell appear there. At a fast well (C2 at 1e-6 m2/s, cells
!!     of 10 and 5 mm) the errors are 0.4 and 0.1 times that change.
!!
!! The fine level's contact is solved as a full system, which is too large for a body with very many
!! fracture cells. There two other comparisons replace the first:
!!   - With the edge of a coarse level that is corrected by the windows (twolevel_correction). The
!!     change of K counts in full.
!!   - Between the coarse level's cells the displacement is interpolated so that quadratic fields
!!     are exact (window_t%curved_edge). Half of the change of K with linear interpolation, one
!!     order lower, counts as error.
!! Their safety factor is the smallest one, in tenths, with which 95 % of the stated errors were
!! upper bounds in 62 arrangements of one or two cracks and windows as large as these; in networks
!! and smaller windows 54 to 62 % are (verification/windows_of_scenes).
!!
!! An error that no window refinement can reduce and that decreases with time does not prevent
!! growth (report_watch): the error is stated, with a warning. Errors of the coarse level in the
!! pressure of the fractures are not included.
module twolevel_coarse_errors
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use base_timers, only: phase_tips, timers_t
   use coarse_state, only: state_t
   use growth_front, only: front_state_t
   use growth_tip, only: tip_t
   use mesh_types, only: fracture_mesh_t
  use twolevel_body_comparison, only: admissible_change, compare_tip, is_new, keep_comparison, shown
   use twolevel_correction, only: improve
   use twolevel_drained_tips, only: drained_excess, layer_at_tip, layer_t, thin_layer_errors
   use twolevel_problem, only: coarse_problem_t
   use report_limits, only: judge, limit_k_to_grow, verdict_fine
   use report_watch, only: uncertainty
   use twolevel_state, only: two_levels_t
   use twolevel_window, only: window_t
   use twolevel_window_tip, only: window_tip_t
   use twolevel_windows, only: failure_t, first_failure, windows_t
   implicit none(type, external)
   private

   public :: estimate_coarse_errors

   !> stated error, over the difference in the comparisons [-]
   real(rk), parameter :: safety = 1.8_rk
   !> weight of the comparison with linear interpolation [-]
   real(rk), parameter :: share_of_order = 0.5_rk
   real(rk), parameter :: share_of_pressure = 0.25_rk  !< weight of the comparison of pressures [-]
contains

   !> Relative excess of K_II of the body as one window by a drained tip; none in an undrained
   !! response.
   pure real(rk) function excess_at(self, tip) result(excess)
      class(two_levels_t), intent(in) :: self
      type(tip_t), intent(in) :: tip

      excess = 0.0_rk
      if (self%now%undrained) return
      excess = drained_excess(layer_at_tip(self%problem%mesh, self%problem%model%rock, &
                                           self%now%coarse, self%problem%values, &
                                           tip%fracture, tip%end), self%now%coarse%time)
   end function excess_at

   !> Estimate the errors by the coarse level of the intensities that were evaluated last.
   subroutine estimate_coarse_errors(self, timers, error)
      class(two_levels_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      if (.not. any(self%tip%is_loaded())) return
      call timers%start(phase_tips)
      call estimate(self, error)
      call timers%stop(phase_tips)
   end subroutine estimate_coarse_errors

   subroutine estimate(self, error)
      class(two_levels_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: i

      call compare_pressures(self, error)
      if (allocated(error)) return
      if (self%windows%all_in_body()) then
         do i = 1, size(self%tip, kind=ik)
            associate (seen => self%now%windows%tip(i))
               seen%of_elements = max(seen%found%k1_error, seen%found%k2_error)
               seen%lacking(2) = -excess_at(self, self%tip(i))*seen%found%k2
            end associate
         end do
      else if (self%has_reference()) then
         call compare_with_body(self, error)
      else
         call compare_edges(self, error)
      end if
      if (allocated(error)) return
      do i = 1, size(self%tip, kind=ik)
         if (.not. self%tip(i)%is_loaded()) cycle
         self%now%windows%tip(i)%is_compared = .true.
         self%tip(i)%intensity = self%windows%intensity_of(i, self%now%windows%tip(i))
      end do
   end subroutine estimate

   !> Compare the windows with the whole body as one window.
   subroutine compare_with_body(self, error)
      class(two_levels_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      type(front_state_t) :: front
      type(window_tip_t) :: kept(size(self%tip))
      integer(ik) :: i

      kept = self%now%windows%tip
      do i = 1, size(self%tip, kind=ik)
         if (self%tip(i)%is_loaded()) call keep_comparison(self%tip(i)%xy, kept(i))
      end do
      if (.not. is_due(self, kept)) then
         self%now%windows%tip = kept
         return
      end if
      front = self%front_state_t
      call self%reference%evaluate(self%scene, front, front%tip%is_loaded(), self%problem, &
                                   self%now%coarse, self%now%reference, error)
      if (allocated(error)) return
      do i = 1, size(self%tip, kind=ik)
         if (.not. self%tip(i)%is_loaded()) cycle
         call compare_tip(self%now%reference%tip(i), excess_at(self, self%tip(i)), &
                          self%now%windows%tip(i))
         self%now%windows%tip(i)%compared_at = self%tip(i)%xy
      end do
   end subroutine compare_with_body

   !> Whether the windows are to be compared with the body again: this requires no mesh, or a tip
   !! has advanced by eight segments since the last comparison, or by two, or its intensities have
   !! changed noticeably, and without a new comparison it could not be judged whether it grows.
   !! Tips that have just begun to slip, with a small K, may wait for their first comparison.
   pure logical function is_due(self, kept)
      class(two_levels_t), intent(in) :: self
      type(window_tip_t), intent(in) :: kept(:)  !< (tips) with the errors of the last comparison
      real(rk), parameter :: segments(2) = [2.0_rk, 8.0_rk]
      type(tip_t) :: tip
      real(rk) :: advance  ! in segments
      logical :: is_like_before
      integer(ik) :: i

      is_due = .not. self%reference%has_to_mesh(self%tip)
      do i = 1, size(kept, kind=ik)
         if (is_due .or. .not. self%tip(i)%is_loaded()) cycle
         tip = self%tip(i)
         is_like_before = norm2([kept(i)%found%k1, kept(i)%found%k2] - kept(i)%compared) &
                          <= admissible_change(tip, kept(i), self%rules%toughness)
         if (is_new(kept(i))) then
            is_due = .not. (is_like_before .and. self%scene%growth%enabled)
            cycle
         end if
         advance = norm2(tip%xy - kept(i)%compared_at)/self%rules%increment_of(tip%fracture)
         is_due = advance > segments(2)
         if (is_due .or. (advance <= segments(1) .and. is_like_before)) cycle
         tip%intensity = self%windows%intensity_of(i, kept(i))
         is_due = judge(limit_k_to_grow, uncertainty(tip, self%rules%toughness)) /= verdict_fine
      end do
   end function is_due

   !> Compare the edges of the windows with more and less accurate ones.
   subroutine compare_edges(self, error)
      class(two_levels_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: displacement(2, self%problem%mesh%n_nodes)
      real(rk) :: gradient(2, 2, self%problem%mesh%n_nodes)
      real(rk) :: straight(2, 2, self%problem%mesh%n_nodes)
      real(rk), dimension(2, size(self%tip)) :: better, worse
      integer(ik) :: i, w

      call improve(self%windows, self%tip, self%problem, self%now%coarse, displacement, gradient, &
                   error)
      if (allocated(error)) return
      straight = 0.0_rk
      associate (tips => self%now%windows%tip, scene => self%scene, mesh => self%problem%mesh, &
                 linear => self%problem%values%nodal(:2, :))
         do w = 1, size(self%windows%slot, kind=ik)
            if (.not. self%windows%is_active(w, self%tip)) cycle
            associate (window => self%windows%slot(w)%window, &
                       history => self%now%windows%history(w))
               call window%intensities_with(history, better, error, &
                                            edge=window%curved_edge(mesh, displacement, &
                                                                    gradient))
               if (allocated(error)) return
               call window%intensities_with(history, worse, error, &
                                            edge=window%curved_edge(mesh, linear, straight))
               if (allocated(error)) return
            end associate
         end do
         do i = 1, size(tips, kind=ik)
            if (.not. self%tip(i)%is_loaded()) cycle
            associate (w => self%windows%window_of(i))
               call judge_edges(mesh%fracture, self%windows%slot(w)%window, better(:, i), &
                                worse(:, i), tips(i))
            end associate
         end do
      end associate
   end subroutine compare_edges

   !> Errors of a tip from its K with other edges.
   pure subroutine judge_edges(fracture, window, better, worse, tip)
      type(fracture_mesh_t), intent(in) :: fracture
      type(window_t), intent(in) :: window  !< window of the tip
      real(rk), intent(in), dimension(2) :: better, worse  !< [Pa m^1/2]
      type(window_tip_t), intent(inout) :: tip

      associate (found => [tip%found%k1, tip%found%k2], closed => tip%found%closed)
         tip%lacking = better - found
         tip%uncertain = safety*hypot(shown(better - found, closed), &
                                      share_of_order*shown(worse - found, closed))
         if (.not. holds_a_cell(fracture, window, tip)) then
            tip%uncertain = norm2(found)
            if (closed) tip%uncertain(1) = abs(found(1))
         end if
      end associate
      tip%of_edge = maxval(tip%uncertain)
      tip%of_elements = max(tip%found%k1_error, tip%found%k2_error)
   end subroutine judge_edges

   !> Compare with K at another interpolation of the pressure in the rock.
   subroutine compare_pressures(self, error)
      class(two_levels_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: rough(2, size(self%tip))
      type(failure_t) :: failure(size(self%windows%slot))
      integer(ik) :: i, w

      if (self%now%undrained) then
         do i = 1, size(self%tip, kind=ik)
            self%now%windows%tip(i)%passing = 0.0_rk
         end do
         return
      end if
      !$omp parallel do schedule(dynamic, 1)
      do w = 1, size(self%windows%slot, kind=ik)
         if (.not. self%windows%is_active(w, self%tip)) cycle
         call self%windows%slot(w)%window%intensities_with(self%now%windows%history(w), rough, &
                                                           failure(w)%error, pressure= &
                                                           self%now%coarse%unknowns(3, :))
      end do
      !$omp end parallel do
      call first_failure(failure, error)
      if (allocated(error)) return
      do i = 1, size(self%tip, kind=ik)
         if (.not. self%tip(i)%is_loaded()) cycle
         associate (tip => self%now%windows%tip(i))
            tip%passing = safety*share_of_pressure &
                          *shown(rough(:, i) - [tip%found%k1, tip%found%k2], tip%found%closed) &
                          + errors_of_layer(self%problem, self%now%coarse, self%before%time, &
                                            self%tip(i), tip)
         end associate
      end do
   end subroutine compare_pressures

   !> Possible errors of the intensities of a tip by a layer of fluid pressure thinner than a coarse
   !! cell.
   pure function errors_of_layer(problem, state, since, tip, seen) result(errors)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk), intent(in) :: since  !< start of the last step [s]
      type(tip_t), intent(in) :: tip
      type(window_tip_t), intent(in) :: seen  !< the tip in its window
      real(rk) :: errors(2)  !< errors of K_I and K_II [Pa m^1/2]
      type(layer_t) :: layer
      real(rk) :: age

      layer = layer_at_tip(problem%mesh, problem%model%rock, state, problem%values, &
                           tip%fracture, tip%end)
      ! A tip that moves meets rock that the fluid has not reached.
      age = state%time
      if (tip%advance > 0.0_rk) age = min(age, (state%time - since)*layer%cell/tip%advance)
      associate (found => seen%found)
         errors = thin_layer_errors(layer, [found%k1, found%k2], found%closed, age, &
                                    seen%back_stress)
      end associate
   end function errors_of_layer

   !> Whether the window contains a whole fracture cell. A window that contains no whole fracture
   !! cell gives no estimate, and its edge displacement does not resolve the tip.
   pure logical function holds_a_cell(fracture, window, tip)
      type(fracture_mesh_t), intent(in) :: fracture
      type(window_t), intent(in) :: window
      type(window_tip_t), intent(in) :: tip
      integer(ik) :: cell

      holds_a_cell = .false.
      do cell = 1, fracture%n_cells
         if (fracture%cell_fracture(cell) /= tip%fracture) cycle
         holds_a_cell = window%holds(fracture%point_xy(:, fracture%cell_points(:, cell)))
         if (holds_a_cell) return
      end do
   end function holds_a_cell

end module twolevel_coarse_errors
