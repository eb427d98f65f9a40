!> How far the intensities of the windows can be trusted: the coarse level's part of their errors.
!!
!! A window takes the displacement on its edge and the rock's pressure from the coarse level. Three
!! comparisons show what is wrong with them:
!!   - Inside the windows, on the fractures and in the rock, these know better than the coarse
!!     level, which gets what they found as a defect correction (Hackbusch 1984), all windows at
!!     once. What that changes in K counts as it is.
!!   - Between the coarse level's cells the displacement is interpolated so that quadratic fields
!!     are exact (window_t%curved_edge). What K differs by with linear interpolation, one order
!!     lower, counts by half.
!!   - The pressure is linear in each cell. What K differs by with that of the cells' middles counts
!!     by a quarter: slip presses and draws on the rock around a tip, and layers that are thinner
!!     than a cell show there. At a fast well (C2 at 1e-6 m2/s, cells of 10 and 5 mm) the errors are
!!     0.4 and 0.1 times that.
!! This costs a substitution in the factors of the coarse level and three solutions of each window,
!! whose mesh and factors stay.
!!
!! What passes by itself, and no window could mend, is no reason not to grow (simulation_doubt): it
!! is stated and warned of.
!!
!! What the coarse level gets wrong outside of all windows, and the fractures' pressure, is not
!! seen. The safety factor is the smallest, in tenths, with which 95 % of the stated errors hold in
!! 62 arrangements (verification/trust_in_k); in 31 others 96 % do.
module twolevel_trust
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_timers, only: phase_tips, timers_t
   use coarse_fields, only: corner_tractions, curved_displacement
   use coarse_layout, only: block_count, end_block
   use mesh_types, only: mesh_t
   use twolevel_faces, only: coarse_jumps
   use twolevel_state, only: two_levels_t
   use twolevel_window, only: window_t
   use twolevel_window_tip, only: window_tip_t
   implicit none(type, external)
   private

   public :: estimate_coarse_errors

   real(rk), parameter :: safety = 1.8_rk  !< error over what the comparisons show [-]
   real(rk), parameter :: share_of_order = 0.5_rk  !< that the second comparison counts by [-]
   real(rk), parameter :: share_of_pressure = 0.25_rk  !< that the third one counts by [-]

contains

   !> Estimate what the coarse level makes wrong in the intensities that were evaluated last.
   subroutine estimate_coarse_errors(self, timers, error)
      class(two_levels_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      if (.not. any(self%tip%is_free)) return
      call timers%start(phase_tips)
      call estimate(self, error)
      call timers%stop(phase_tips)
   end subroutine estimate_coarse_errors

   subroutine estimate(self, error)
      class(two_levels_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: displacement(2, self%mesh%n_nodes), gradient(2, 2, self%mesh%n_nodes)
      real(rk) :: straight(2, 2, self%mesh%n_nodes)
      real(rk), dimension(2, size(self%tip)) :: better, rough, worse
      integer(ik) :: i, w

      ! The whole body takes nothing on its edge.
      if (.not. all(self%windows%window%is_body)) then
         call improve(self, displacement, gradient, error)
         if (allocated(error)) return
      end if
      straight = 0.0_rk
      associate (tips => self%windows%tip, scene => self%scene, mesh => self%mesh, &
                 linear => self%coarse_values%nodal(:2, :))
         do i = 1, size(tips, kind=ik)
            better(:, i) = [tips(i)%found%k1, tips(i)%found%k2]
         end do
         worse = better
         rough = better
         do w = 1, size(self%windows%window, kind=ik)
            if (.not. self%windows%is_asked(w, self%tip)) cycle
            associate (window => self%windows%window(w))
               if (.not. window%is_body) then
                  call window%intensities_with(tips, better, error, &
                                               edge=window%curved_edge(scene, mesh, displacement, &
                                                                       gradient))
                  if (allocated(error)) return
                  call window%intensities_with(tips, worse, error, &
                                               edge=window%curved_edge(scene, mesh, linear, &
                                                                       straight))
                  if (allocated(error)) return
               end if
               if (.not. window%undrained) then
                  call window%intensities_with(tips, rough, error, &
                                               pressure=self%state%unknowns(3, :))
                  if (allocated(error)) return
               end if
            end associate
         end do
         do i = 1, size(tips, kind=ik)
            if (.not. self%tip(i)%is_free) cycle
            call judge(self, self%windows%window(self%windows%window_of(i)), better(:, i), &
                       worse(:, i), rough(:, i), tips(i))
            self%tip(i)%intensity = self%windows%intensity_of(i)
         end do
      end associate
   end subroutine estimate

   !> What the comparisons say of a tip.
   pure subroutine judge(self, window, better, worse, rough, tip)
      class(two_levels_t), intent(in) :: self
      type(window_t), intent(in) :: window  !< the tip's
      real(rk), intent(in), dimension(2) :: better, worse, rough  !< [Pa m^1/2]
      type(window_tip_t), intent(inout) :: tip
      real(rk), parameter :: none(2) = 0.0_rk

      associate (found => [tip%found%k1, tip%found%k2], closed => tip%found%closed)
         tip%lacking = better - found
         tip%uncertain = safety*shown(better - found, share_of_order*(worse - found), closed)
         tip%passing = safety*shown(share_of_pressure*(rough - found), none, closed)
         if (.not. holds_a_cell(self, window, tip)) then
            tip%uncertain = norm2(found)
            if (closed) tip%uncertain(1) = abs(found(1))
         end if
      end associate
   end subroutine judge

   !> A whole fracture cell lies in the window. In one that is smaller there is nothing that the
   !! coarse level could be compared with, and it knows nothing of the tip itself.
   pure logical function holds_a_cell(self, window, tip)
      class(two_levels_t), intent(in) :: self
      type(window_t), intent(in) :: window
      type(window_tip_t), intent(in) :: tip
      integer(ik) :: cell

      holds_a_cell = .false.
      associate (fracture => self%mesh%fracture)
         do cell = 1, fracture%n_cells
            if (fracture%cell_fracture(cell) /= tip%fracture) cycle
            holds_a_cell = window%holds(fracture%point_xy(:, fracture%cell_points(:, cell)))
            if (holds_a_cell) return
         end do
      end associate
   end function holds_a_cell

   !> What two comparisons show of the errors of K_I and K_II. What acts on one mode acts on both:
   !! that it hardly changes one of them is chance, unless the law of contact closes the tip.
   pure function shown(one, other, is_closed) result(difference)
      real(rk), intent(in), dimension(2) :: one, other  !< [Pa m^1/2]
      logical, intent(in) :: is_closed
      real(rk) :: difference(2)  !< [Pa m^1/2]

      difference = hypot(norm2(one), norm2(other))
      if (is_closed) difference(1) = hypot(one(1), other(1))
   end function shown

   !> What the coarse displacement at the nodes would be if the coarse level agreed with the
   !! windows inside of them: jumps on the fractures are theirs, and cells all of whose neighbours
   !! lie in the same window get the forces that make the windows' displacements fulfil their
   !! equations.
   subroutine improve(self, displacement, gradient, error)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(out) :: displacement(:, :)  !< (2, n_nodes) [m]
      real(rk), intent(out) :: gradient(:, :, :)  !< (2, 2, n_nodes) [-]
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: difference(:, :), force(:, :), g(:), q(:), tractions(:)
      real(rk), allocatable :: unknowns(:, :)
      integer(ik), allocatable :: speaker(:)

      associate (model => self%model)
         speaker = speakers(self)
         allocate (q(model%condensed%layout%count()), g(model%condensed%layout%count()))
         call find_differences(self, speaker, difference, q, error)
         if (allocated(error)) return
         force = model%matrix%elastic_forces(difference)
         force(3, :) = 0.0_rk
         where (spread(.not. is_within(self, speaker), 1, 3)) force = 0.0_rk
         call model%condensed%condense(force, g, error)
         if (allocated(error)) return
         allocate (unknowns, mold=force)
         call model%condensed%expand(q, force, unknowns, error)
         if (allocated(error)) return
         unknowns = unknowns + self%state%unknowns
         call corner_tractions(model%regions, unknowns, tractions)
         call curved_displacement(self%mesh, model%rock, model%regions, unknowns, tractions, &
                                  displacement, gradient)
      end associate
   end subroutine improve

   !> The window that speaks for each block of the coarse level, 0 for none: that whose tip is
   !! nearest, of those that hold the centre of the cell, or the whole fracture cell.
   pure function speakers(self) result(speaker)
      class(two_levels_t), intent(in) :: self
      integer(ik), allocatable :: speaker(:)  !< (blocks)
      integer(ik) :: cell

      associate (mesh => self%mesh, fracture => self%mesh%fracture)
         allocate (speaker(block_count(mesh)))
         do cell = 1, mesh%n_cells
            speaker(cell) = nearest_window(self, spread(centre_of(mesh, cell), 2, 2))
         end do
         do cell = 1, fracture%n_cells
            speaker(end_block(mesh, cell, [1_ik, 2_ik])) = &
               nearest_window(self, fracture%point_xy(:, fracture%cell_points(:, cell)))
         end do
      end associate
   end function speakers

   pure function centre_of(mesh, cell) result(centre)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell
      real(rk) :: centre(2)  !< [m]

      centre = sum(mesh%xy(:, mesh%cell_nodes(:, cell)), dim=2)/3.0_rk
   end function centre_of

   !> Of the windows that hold both points, the one whose tip is nearest, else 0.
   pure function nearest_window(self, points) result(nearest)
      class(two_levels_t), intent(in) :: self
      real(rk), intent(in) :: points(2, 2)  !< xy in columns [m]
      integer(ik) :: nearest
      real(rk) :: distance, shortest
      integer(ik) :: i

      nearest = 0
      shortest = huge(1.0_rk)
      do i = 1, size(self%tip, kind=ik)
         if (.not. self%tip(i)%is_free) cycle
         associate (w => self%windows%window_of(i))
            if (.not. self%windows%window(w)%holds(points)) cycle
            distance = norm2(0.5_rk*sum(points, dim=2) - self%tip(i)%xy)
            if (distance >= shortest) cycle
            shortest = distance
            nearest = w
         end associate
      end do
   end function nearest_window

   !> Cells whose equations know nothing but what one window speaks for.
   pure function is_within(self, speaker) result(within)
      class(two_levels_t), intent(in) :: self
      integer(ik), intent(in) :: speaker(:)  !< (blocks)
      logical, allocatable :: within(:)  !< (blocks)
      integer(ik) :: i, k

      within = speaker > 0
      within(self%mesh%n_cells + 1:) = .false.
      associate (columns => self%model%matrix%columns)
         do i = 1, size(speaker, kind=ik)
            do k = columns%first(i), columns%last(i)
               associate (j => columns%item(k))
                  if (speaker(i) == speaker(j)) cycle
                  within([i, j]) = .false.
               end associate
            end do
         end do
      end associate
   end function is_within

   !> What the windows find where they speak, less what the coarse level has there; no pressures.
   subroutine find_differences(self, speaker, difference, q, error)
      class(two_levels_t), intent(in) :: self
      integer(ik), intent(in) :: speaker(:)  !< (blocks)
      real(rk), allocatable, intent(out) :: difference(:, :)  !< (3, blocks) [m]
      real(rk), intent(out) :: q(:)  !< that of the jumps, as in coarse_condensed [m]
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: displacement(:, :), jump(:, :, :), xy(:, :)
      integer(ik), allocatable :: cells(:)
      integer(ik) :: cell, end, i, w

      allocate (difference, mold=self%state%unknowns)
      difference = 0.0_rk
      q = 0.0_rk
      associate (mesh => self%mesh, state => self%state, condensed => self%model%condensed)
         do w = 1, size(self%windows%window, kind=ik)
            if (.not. self%windows%is_asked(w, self%tip)) cycle
            associate (window => self%windows%window(w))
               cells = pack([(i, i=1, mesh%n_cells)], speaker(:mesh%n_cells) == w)
               xy = reshape([(centre_of(mesh, cells(i)), i=1, size(cells))], [2, size(cells)])
               displacement = xy
               call window%displacement_at(xy, displacement, error)
               if (allocated(error)) return
               difference(:2, cells) = displacement - state%unknowns(:2, cells)
               jump = coarse_jumps(window%model%mesh, window%displacement, mesh)
            end associate
            do cell = 1, mesh%fracture%n_cells
               do end = 1, 2
                  associate (block => end_block(mesh, cell, end), n => condensed%normal(:, cell), &
                             d => jump(:, end, cell) - state%jump(:, end, cell), &
                             at => condensed%layout%at_jump(cell, end))
                     if (speaker(block) /= w) cycle
                     q(at:at + 1) = d
                     difference(:2, block) = [n(1)*d(1) + n(2)*d(2), n(2)*d(1) - n(1)*d(2)]
                  end associate
               end do
            end do
         end do
      end associate
   end subroutine find_differences

end module twolevel_trust
