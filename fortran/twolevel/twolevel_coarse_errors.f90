!> Error estimates of the intensities of the windows: the contribution of the coarse level.
!!
!! A window takes the displacement on its edge and the pressure of the rock from the coarse level.
!!   - The error of the edge follows from a comparison with the whole body as one window for all
!!     tips, which takes nothing on its edge: the difference of K, and the error of K there, which
!!     is that of its elements alone. No factor of safety is therefore needed. The comparison costs
!!     about as much as the windows, and is repeated once per path segment.
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
   use base_timers, only: phase_tips, timers_t
   use growth_tip, only: tip_t
   use twolevel_correction, only: improve
   use twolevel_state, only: two_levels_t
   use twolevel_thin_layers, only: layer_at_tip, layer_t, thin_layer_errors
   use twolevel_window, only: window_t
   use twolevel_window_tip, only: window_tip_t
   use twolevel_windows, only: failure_t, first_failure
   implicit none(type, external)
   private

   public :: estimate_coarse_errors

   !> stated error, over the difference in the comparisons [-]
   real(rk), parameter :: safety = 1.8_rk
   !> weight of the comparison with linear interpolation [-]
   real(rk), parameter :: share_of_order = 0.5_rk
   real(rk), parameter :: share_of_pressure = 0.25_rk  !< weight of the comparison of pressures [-]

   !> Relative change of the intensities within which the last comparison with the body still
   !! applies [-].
   real(rk), parameter :: like_before = 0.05_rk

   !> Change of the difference between window and body while the last comparison applies, over the
   !! estimated error of the elements: not exceeded in 97 and 93 of 100 states of wings (C2, K_I and
   !! K_II); a factor of 1 is not exceeded in 96 and 86 [-].
   real(rk), parameter :: of_other_mesh = 2.0_rk

contains

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

      if (self%windows%all_in_body()) then
         do i = 1, size(self%tip, kind=ik)
            associate (seen => self%now%windows%tip(i))
               seen%of_elements = max(seen%found%k1_error, seen%found%k2_error)
            end associate
         end do
      else if (self%has_reference()) then
         call compare_with_body(self, error)
      else
         call compare_edges(self, error)
      end if
      if (.not. allocated(error)) call compare_pressures(self, error)
      if (allocated(error)) return
      do i = 1, size(self%tip, kind=ik)
         if (.not. self%tip(i)%is_loaded()) cycle
         self%tip(i)%intensity = self%windows%intensity_of(i, self%now%windows%tip(i))
      end do
   end subroutine estimate

   !> Compare the windows with the whole body as one window.
   subroutine compare_with_body(self, error)
      class(two_levels_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      type(tip_t) :: tips(size(self%tip))
      integer(ik) :: i

      if (.not. is_due(self)) then
         do i = 1, size(tips, kind=ik)
            if (self%tip(i)%is_loaded()) call keep_comparison(self%now%windows%tip(i))
         end do
         return
      end if
      tips = self%tip
      associate (now => self%now)
         call self%reference%evaluate(self%scene, self%network, tips, tips%is_loaded(), .false., &
                                      self%problem, now%coarse, now%undrained, now%reference, &
                                      error)
      end associate
      if (allocated(error)) return
      do i = 1, size(tips, kind=ik)
         if (.not. tips(i)%is_loaded()) cycle
         call compare_tip(self%now%reference%tip(i), self%now%windows%tip(i))
         self%now%windows%tip(i)%compared_at = tips(i)%xy
      end do
   end subroutine compare_with_body

   !> Whether the windows are to be compared with the body again: this requires no mesh, or a tip
   !! has advanced by the length of a segment since the last comparison, or its intensities have
   !! changed noticeably.
   pure logical function is_due(self)
      class(two_levels_t), intent(in) :: self
      integer(ik) :: i

      is_due = .not. self%reference%has_to_mesh(self%tip)
      do i = 1, size(self%tip, kind=ik)
         if (.not. self%tip(i)%is_loaded()) cycle
         associate (tip => self%now%windows%tip(i))
            is_due = is_due .or. norm2(self%tip(i)%xy - tip%compared_at) &
                     > self%rules%increment_of(self%tip(i)%fracture) &
                     .or. .not. norm2([tip%found%k1, tip%found%k2] - tip%compared) &
                     <= like_before*norm2(tip%compared)
         end associate
      end do
   end function is_due

   !> Errors of a tip from its K in the whole body.
   pure subroutine compare_tip(body, tip)
      type(window_tip_t), intent(in) :: body
      type(window_tip_t), intent(inout) :: tip
      real(rk) :: of_body(2), of_window(2)

      of_body = [body%found%k1_error, body%found%k2_error]
      of_window = [tip%found%k1_error, tip%found%k2_error]
      tip%compared = [tip%found%k1, tip%found%k2]
      tip%lacking = [body%found%k1, body%found%k2] - tip%compared
      tip%uncertain = shown(tip%lacking, tip%found%closed)
      tip%of_edge = maxval(tip%uncertain)
      tip%of_elements = max(maxval(of_body), maxval(of_window))
      tip%uncertain = tip%uncertain + max(0.0_rk, of_body - of_window)
   end subroutine compare_tip

   !> Errors of a tip from the last comparison with the whole body; the mesh is another one, with
   !! other errors.
   pure subroutine keep_comparison(tip)
      type(window_tip_t), intent(inout) :: tip

      associate (own => [tip%found%k1_error, tip%found%k2_error])
         tip%uncertain = shown(tip%lacking, tip%found%closed) + of_other_mesh*norm2(own)
         if (tip%found%closed) tip%uncertain(1) = abs(tip%lacking(1)) + of_other_mesh*own(1)
         tip%of_elements = maxval(own)
      end associate
   end subroutine keep_comparison

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
               call judge_edges(self, self%windows%slot(w)%window, better(:, i), worse(:, i), &
                                tips(i))
            end associate
         end do
      end associate
   end subroutine compare_edges

   !> Errors of a tip from its K with other edges.
   pure subroutine judge_edges(self, window, better, worse, tip)
      class(two_levels_t), intent(in) :: self
      type(window_t), intent(in) :: window  !< window of the tip
      real(rk), intent(in), dimension(2) :: better, worse  !< [Pa m^1/2]
      type(window_tip_t), intent(inout) :: tip

      associate (found => [tip%found%k1, tip%found%k2], closed => tip%found%closed)
         tip%lacking = better - found
         tip%uncertain = safety*hypot(shown(better - found, closed), &
                                      share_of_order*shown(worse - found, closed))
         if (.not. holds_a_cell(self, window, tip)) then
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
                          + errors_of_layer(self, i)
         end associate
      end do
   end subroutine compare_pressures

   !> Possible errors of the intensities of a tip by a layer of fluid pressure thinner than a coarse
   !! cell.
   pure function errors_of_layer(self, tip) result(errors)
      class(two_levels_t), intent(in) :: self
      integer(ik), intent(in) :: tip
      real(rk) :: errors(2)  !< errors of K_I and K_II [Pa m^1/2]
      type(layer_t) :: layer
      real(rk) :: age

      associate (of => self%tip(tip), found => self%now%windows%tip(tip)%found, &
                 time => self%now%coarse%time)
         layer = layer_at_tip(self%problem%mesh, self%problem%model%rock, self%now%coarse, &
                              self%problem%values%nodal(3, :), of%fracture, of%end)
         ! A tip that moves meets rock that the fluid has not reached.
         age = time
         if (of%advance > 0.0_rk) age = min(age, (time - self%before%time)*layer%cell/of%advance)
         errors = thin_layer_errors(layer, [found%k1, found%k2], found%closed, age)
      end associate
   end function errors_of_layer

   !> Whether the window contains a whole fracture cell. A window that contains no whole fracture
   !! cell gives no estimate, and its edge displacement does not resolve the tip.
   pure logical function holds_a_cell(self, window, tip)
      class(two_levels_t), intent(in) :: self
      type(window_t), intent(in) :: window
      type(window_tip_t), intent(in) :: tip
      integer(ik) :: cell

      holds_a_cell = .false.
      associate (fracture => self%problem%mesh%fracture)
         do cell = 1, fracture%n_cells
            if (fracture%cell_fracture(cell) /= tip%fracture) cycle
            holds_a_cell = window%holds(fracture%point_xy(:, fracture%cell_points(:, cell)))
            if (holds_a_cell) return
         end do
      end associate
   end function holds_a_cell

   !> Errors of K_I and K_II from their differences. An error of one mode is an error of both: a
   !! small difference of a single mode is chance, unless the contact law closes the tip.
   pure function shown(difference, is_closed) result(error)
      real(rk), intent(in) :: difference(2)  !< [Pa m^1/2]
      logical, intent(in) :: is_closed
      real(rk) :: error(2)  !< [Pa m^1/2]

      error = norm2(difference)
      if (is_closed) error(1) = abs(difference(1))
   end function shown

end module twolevel_coarse_errors
