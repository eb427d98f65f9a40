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
!!
!! Layers of fluid pressure thinner than a coarse cell: windows take the rock's own pressure
!! (coarse_own_pressure). Within sqrt(c t) of the faces the pressure is that of the fluid. Where
!! this distance is less than a cell there are two effects (docs/theory.md):
!!   - the tip is drained where the surrounding rock is not. K of the window is too large by up to a
!!     fifth of 1 - F times K, F = (1 - nu_u)/(1 - nu). K_II of the body as one window exceeds the
!!     exact one, sqrt(F) times that of undrained rock, by a part of this that does not depend on
!!     the size of the cells. The corrected K_II is without it (drained_excess);
!!   - the layer presses the faces together. Where the coarse level has the layer K_I contains this
!!     (twolevel_back_stress). Where it does not, the stated error does: a difference dp between
!!     fluid and rock since the time t lowers K_I by
!!     (1 + F)/2 sqrt(2) eta/Gamma(5/4) dp (c t)^(1/4), eta = alpha G/(lambda + 2 G).
module twolevel_coarse_errors
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use base_timers, only: phase_tips, timers_t
   use coarse_rock, only: rock_t
   use coarse_state, only: state_t
   use growth_front, only: front_state_t
   use growth_tip, only: tip_t
   use mesh_types, only: fracture_mesh_t, mesh_t
   use twolevel_correction, only: improve
   use twolevel_problem, only: coarse_problem_t
   use report_limits, only: judge, limit_k_to_grow, verdict_fine
   use report_watch, only: uncertainty
   use twolevel_state, only: two_levels_t
   use twolevel_window, only: window_t
   use twolevel_window_tip, only: window_tip_t
   use twolevel_windows, only: failure_t, first_failure, windows_t
   implicit none(type, external)
   private

   public :: drained_excess, estimate_coarse_errors, keep_body, layer_at_tip, layer_t
   public :: thin_layer_errors

   !> Data of the layer at the end of a fracture.
   type :: layer_t
      real(rk) :: cell = 0.0_rk  !< length of the coarse fracture cell at the tip [m]
      real(rk) :: diffusivity = 0.0_rk  !< c [m2/s]
      real(rk) :: drained_tip = 1.0_rk  !< F = (1 - nu_u)/(1 - nu) [-]
      real(rk) :: eta = 0.0_rk  !< poroelastic stress coefficient [-]
      !> pressure of the fluid minus the rock's own pressure at the faces [Pa]
      real(rk) :: jump = 0.0_rk
      logical :: is_known = .false.  !< the coarse level has the layer (coarse_layers)
   end type layer_t

   !> stated error, over the difference in the comparisons [-]
   real(rk), parameter :: safety = 1.8_rk
   !> weight of the comparison with linear interpolation [-]
   real(rk), parameter :: share_of_order = 0.5_rk
   real(rk), parameter :: share_of_pressure = 0.25_rk  !< weight of the comparison of pressures [-]
   !> Error of K at a drained tip in undrained rock, over 1 - F times K, and of K_I of layers, over
   !! itself: verification/sudden_pressure [-].
   real(rk), parameter :: share_of_drained_tip = 0.2_rk, share_of_layer = 0.15_rk
   !> Excess of K_II of the body as one window, over 1 - F times K_II, and how it falls with
   !! x = sqrt(c t) over the cell: 1/(1 + 2.5 x + 4 x**2). Within 0.03 in 13 bodies with other
   !! directions, rocks and cells [-].
   real(rk), parameter :: excess_of_drained = 0.16_rk, falls(2) = [2.5_rk, 4.0_rk]

   !> Relative change of the intensities within which the last comparison with the body still
   !! applies [-].
   real(rk), parameter :: like_before = 0.05_rk

   !> Change of the difference between window and body while the last comparison applies, over K:
   !! where the tip has not moved and where it has, over the relative change of K, and at most.
   !! With the difference before it is not exceeded in 97 % of 4,000 states of tips near their
   !! toughness and in 98 % of 3,500 others (D1, D4, four networks of 30 fractures, of which three
   !! were drawn afterwards) [-].
   real(rk), parameter :: of_still = 0.002_rk, of_moved = 0.01_rk, of_change = 0.2_rk, &
                          of_all = 0.03_rk

contains

   !> Layer at an end of a fracture; without effect if the fracture has no cells.
   pure function layer_at_tip(mesh, rock, state, own_pressure, fracture, end) result(layer)
      type(mesh_t), intent(in) :: mesh  !< coarse
      type(rock_t), intent(in) :: rock
      type(state_t), intent(in) :: state
      real(rk), intent(in) :: own_pressure(:)  !< (n_nodes) pressure of the rock [Pa]
      integer(ik), intent(in) :: fracture  !< number of the fracture in the network
      integer(ik), intent(in) :: end  !< 1: start of the polyline, 2: its end
      type(layer_t) :: layer
      integer(ik) :: at, cell, i, side
      real(rk) :: stiffness, undrained

      associate (here => mesh%fracture)
         if (end == 1) then
            at = minloc(here%cell_s(1, :), dim=1, mask=here%cell_fracture == fracture)
         else
            at = maxloc(here%cell_s(2, :), dim=1, mask=here%cell_fracture == fracture)
         end if
         if (at == 0) return
         layer%cell = here%cell_s(2, at) - here%cell_s(1, at)
         if (mesh%n_layers > 0) layer%is_known = any(mesh%face_layer(here%cell_faces(:, at)) > 0)
         cell = mesh%face_cells(1, here%cell_faces(1, at))
         layer%jump = state%pressure(at) &
           - 0.25_rk*sum([(own_pressure(mesh%face_nodes(:, here%cell_faces(side, at))), side=1, 2)])
      end associate
      i = min(cell, size(rock%shear, kind=ik))
      associate (g => rock%shear(i), lame => rock%lame(i), biot => rock%biot(i), &
                 storage => rock%storage(i))
         stiffness = lame + 2.0_rk*g
         undrained = lame + biot**2/storage
         layer%diffusivity = rock%mobility_at(cell)/(storage + biot**2/stiffness)
         layer%drained_tip = (undrained + 2.0_rk*g)/(undrained + g)*(lame + g)/stiffness
         layer%eta = biot*g/stiffness
      end associate
   end function layer_at_tip

   !> Possible errors of K_I and K_II by layers that the cells do not resolve [Pa m^1/2].
   pure function thin_layer_errors(layer, k, is_closed, age, back_stress) result(errors)
      type(layer_t), intent(in) :: layer
      real(rk), intent(in) :: k(2)  !< K_I, K_II [Pa m^1/2]
      logical, intent(in) :: is_closed  !< the faces touch at the tip: K_I = 0
      real(rk), intent(in) :: age  !< age of the layer [s]
      !> K_I of the layers, which is known where the coarse level has them [Pa m^1/2]
      real(rk), intent(in) :: back_stress
      real(rk) :: errors(2)
      real(rk) :: factor, unresolved

      errors = 0.0_rk
      if (.not. layer%cell > 0.0_rk) return
      unresolved = 1.0_rk/(1.0_rk + 4.0_rk*layer%diffusivity*age/layer%cell**2)
      errors = share_of_drained_tip*(1.0_rk - layer%drained_tip)*abs(k)*unresolved
      if (layer%is_known) then
         errors(1) = errors(1) + share_of_layer*abs(back_stress)
      else
         factor = 0.5_rk*(1.0_rk + layer%drained_tip)*sqrt(2.0_rk)*layer%eta/gamma(1.25_rk)
         errors(1) = errors(1) + factor*abs(layer%jump)*unresolved &
                     *min(layer%diffusivity*age, layer%cell**2)**0.25_rk
      end if
      if (is_closed) errors(1) = 0.0_rk
   end function thin_layer_errors

   !> Relative excess of K_II of the body as one window by a drained tip [-].
   pure real(rk) function drained_excess(layer, age) result(excess)
      type(layer_t), intent(in) :: layer
      real(rk), intent(in) :: age  !< [s]
      real(rk) :: x

      excess = 0.0_rk
      if (.not. layer%cell > 0.0_rk) return
      x = sqrt(layer%diffusivity*age)/layer%cell
      excess = excess_of_drained*(1.0_rk - layer%drained_tip)/(1.0_rk + x*(falls(1) + x*falls(2)))
   end function drained_excess

   !> The same of a tip in a state; none in an undrained response.
   pure real(rk) function excess_at(self, tip) result(excess)
      class(two_levels_t), intent(in) :: self
      type(tip_t), intent(in) :: tip

      excess = 0.0_rk
      if (self%now%undrained) return
      excess = drained_excess(layer_at_tip(self%problem%mesh, self%problem%model%rock, &
                                           self%now%coarse, self%problem%values%nodal(3, :), &
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

   !> Whether a tip has not been compared with the body in its present window.
   pure logical function is_new(tip)
      type(window_tip_t), intent(in) :: tip

      is_new = .not. norm2(tip%compared) > 0.0_rk
   end function is_new

   !> Change of the intensities of a tip within which its last comparison with the body still
   !! applies: more where the tip is below its toughness, as long as it cannot have reached it
   !! [Pa m^1/2].
   pure real(rk) function admissible_change(tip, seen, toughness) result(change)
      type(tip_t), intent(in) :: tip
      type(window_tip_t), intent(in) :: seen  !< the tip in its window
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      real(rk), parameter :: far = 0.5_rk, small = 0.1_rk
      real(rk) :: lack  ! of toughness, error included [-]

      lack = -tip%excess(toughness) - tip%relative_error(toughness)
      change = max(like_before, min(lack, 1.0_rk))*norm2(seen%compared)
      if (lack < far) return
      change = max(norm2(seen%compared), small*toughness*tip%drive%resistance)
   end function admissible_change

   !> Errors of a tip from its K in the whole body.
   pure subroutine compare_tip(body, excess, tip)
      type(window_tip_t), intent(in) :: body
      real(rk), intent(in) :: excess  !< of K_II there [-]
      type(window_tip_t), intent(inout) :: tip
      real(rk) :: of_body(2), of_window(2)

      of_body = [body%found%k1_error, body%found%k2_error]
      of_window = [tip%found%k1_error, tip%found%k2_error]
      tip%compared = [tip%found%k1, tip%found%k2]
      tip%lacking = [body%found%k1, (1.0_rk - excess)*body%found%k2] - tip%compared
      tip%uncertain = shown(tip%lacking, tip%found%closed)
      tip%of_edge = maxval(tip%uncertain)
      tip%of_elements = max(maxval(of_body), maxval(of_window))
      tip%uncertain = tip%uncertain + max(0.0_rk, of_body - of_window)
   end subroutine compare_tip

   !> Compare a tip with its K in the body as it was found by the last comparison: its window is
   !! another one in the same state. Without a comparison that applies there will be a new one.
   pure subroutine keep_body(before, reference, tip)
      type(window_tip_t), intent(in) :: before  !< the tip in its window before
      type(window_tip_t), intent(in) :: reference  !< the tip in the body as one window
      type(window_tip_t), intent(inout) :: tip
      type(window_tip_t) :: body

      associate (found => [before%found%k1, before%found%k2])
         if (.not. norm2(found - before%compared) <= like_before*norm2(before%compared)) return
         body%found = reference%found
         body%found%k1 = found(1) + before%lacking(1)
         body%found%k2 = found(2) + before%lacking(2)
      end associate
      call compare_tip(body, 0.0_rk, tip)
   end subroutine keep_body

   !> Errors of a tip from the last comparison with the whole body, larger where its intensities
   !! have changed since.
   pure subroutine keep_comparison(xy, tip)
      real(rk), intent(in) :: xy(2)  !< its position [m]
      type(window_tip_t), intent(inout) :: tip
      real(rk) :: change, ratio

      associate (found => [tip%found%k1, tip%found%k2], before => norm2(tip%compared))
         if (is_new(tip)) then
            tip%uncertain = shown(found, tip%found%closed)
         else
            ratio = max(1.0_rk, norm2(found)/before)
            change = merge(of_moved, of_still, norm2(xy - tip%compared_at) > 0.0_rk) &
                     + of_change*norm2(found - tip%compared)/before
            tip%uncertain = shown(ratio*tip%lacking, tip%found%closed) &
                            + min(change, of_all)*shown(found, tip%found%closed)
         end if
      end associate
      tip%of_elements = max(tip%found%k1_error, tip%found%k2_error)
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

      layer = layer_at_tip(problem%mesh, problem%model%rock, state, problem%values%nodal(3, :), &
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
