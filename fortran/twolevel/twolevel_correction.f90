!> Correction of the coarse level by the windows: a defect correction (Hackbusch 1984).
!!
!! The windows are more accurate than the coarse level, on the fractures and in the rock. The
!! results of all windows are imposed on the coarse level together, which costs one substitution
!! with the existing factors.
module twolevel_correction
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use coarse_fields, only: corner_tractions
   use coarse_nodes, only: nodal_fields
   use coarse_layout, only: block_count, end_block, layer_block
   use coarse_state, only: state_t
   use growth_tip, only: tip_t
   use mesh_geometry, only: cell_centre
   use mesh_types, only: mesh_t
   use twolevel_faces, only: coarse_jumps
   use twolevel_problem, only: coarse_problem_t
   use twolevel_windows, only: windows_t
   implicit none(type, external)
   private

   public :: improve

contains

   !> Coarse displacement at the nodes, corrected so that the coarse level agrees with the windows
   !! inside of the windows: the jumps on the fractures are those of the windows, and cells all of
   !! whose neighbours lie in the same window get the forces with which the displacements of the
   !! windows satisfy the coarse equations.
   subroutine improve(windows, tips, problem, state, displacement, gradient, error)
      type(windows_t), intent(in) :: windows
      type(tip_t), intent(in) :: tips(:)
      type(coarse_problem_t), intent(inout) :: problem  !< with factors of its matrix
      type(state_t), intent(in) :: state
      real(rk), intent(out) :: displacement(:, :)  !< (2, n_nodes) [m]
      real(rk), intent(out) :: gradient(:, :, :)  !< (2, 2, n_nodes) [-]
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: difference(:, :), force(:, :), g(:), q(:), tractions(:)
      real(rk), allocatable :: unknowns(:, :)
      integer(ik), allocatable :: speaker(:)

      associate (model => problem%model)
         speaker = speakers(windows, tips, problem%mesh)
         allocate (q(model%condensed%layout%count()), g(model%condensed%layout%count()))
         call find_differences(windows, tips, problem, state, speaker, difference, q, error)
         if (allocated(error)) return
         force = model%matrix%elastic_forces(difference)
         force(3, :) = 0.0_rk
         where (spread(.not. is_within(problem, speaker), 1, 3)) force = 0.0_rk
         call model%condensed%condense(force, g, error)
         if (allocated(error)) return
         allocate (unknowns, mold=force)
         call model%condensed%expand(q, force, unknowns, error)
         if (allocated(error)) return
         unknowns = unknowns + state%unknowns
         call corner_tractions(model%regions, model%rock%with_heat(unknowns), tractions)
         call nodal_fields(problem%mesh, model%rock, model%regions, unknowns, tractions, &
                           curved=displacement, gradients=gradient)
      end associate
   end subroutine improve

   !> Window assigned to each block of the coarse level, 0 for none: of the windows that contain the
   !! centre of the cell, or the whole fracture cell, the one whose tip is nearest.
   pure function speakers(windows, tips, mesh) result(speaker)
      type(windows_t), intent(in) :: windows
      type(tip_t), intent(in) :: tips(:)
      type(mesh_t), intent(in) :: mesh
      integer(ik), allocatable :: speaker(:)  !< (blocks)
      integer(ik) :: cell, layer

      associate (fracture => mesh%fracture)
         allocate (speaker(block_count(mesh)))
         do cell = 1, mesh%n_cells
            speaker(cell) = nearest_window(windows, tips, spread(cell_centre(mesh, cell), 2, 2))
         end do
         do layer = 1, mesh%n_layers
            speaker(layer_block(mesh, layer)) = &
               speaker(mesh%face_cells(1, mesh%layer_face(layer)))
         end do
         do cell = 1, fracture%n_cells
            speaker(end_block(mesh, cell, [1_ik, 2_ik])) = &
               nearest_window(windows, tips, fracture%point_xy(:, fracture%cell_points(:, cell)))
         end do
      end associate
   end function speakers

   !> Of the windows that contain both points, the one whose tip is nearest, else 0.
   pure function nearest_window(windows, tips, points) result(nearest)
      type(windows_t), intent(in) :: windows
      type(tip_t), intent(in) :: tips(:)
      real(rk), intent(in) :: points(2, 2)  !< xy in columns [m]
      integer(ik) :: nearest
      real(rk) :: distance, shortest
      integer(ik) :: i

      nearest = 0
      shortest = huge(1.0_rk)
      do i = 1, size(tips, kind=ik)
         if (.not. tips(i)%is_loaded()) cycle
         associate (w => windows%window_of(i))
            if (.not. windows%slot(w)%window%holds(points)) cycle
            distance = norm2(0.5_rk*sum(points, dim=2) - tips(i)%xy)
            if (distance >= shortest) cycle
            shortest = distance
            nearest = w
         end associate
      end do
   end function nearest_window

   !> Cells whose equations contain only blocks that are assigned to the same window.
   pure function is_within(problem, speaker) result(within)
      type(coarse_problem_t), intent(in) :: problem
      integer(ik), intent(in) :: speaker(:)  !< (blocks)
      logical, allocatable :: within(:)  !< (blocks)
      integer(ik) :: i, k

      within = speaker > 0
      within(problem%mesh%n_cells + 1:) = .false.
      associate (columns => problem%model%matrix%columns)
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

   !> Differences of the windows' displacements and jumps from the coarse ones, in the blocks
   !! assigned to the windows; 0 for pressures.
   subroutine find_differences(windows, tips, problem, state, speaker, difference, q, error)
      type(windows_t), intent(in) :: windows
      type(tip_t), intent(in) :: tips(:)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      integer(ik), intent(in) :: speaker(:)  !< (blocks)
      real(rk), allocatable, intent(out) :: difference(:, :)  !< (3, blocks) [m]
      real(rk), intent(out) :: q(:)  !< difference of the jumps, as in coarse_condensed [m]
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: displacement(:, :), jump(:, :, :), xy(:, :)
      integer(ik), allocatable :: cells(:)
      integer(ik) :: cell, end, i, w

      allocate (difference, mold=state%unknowns)
      difference = 0.0_rk
      q = 0.0_rk
      associate (mesh => problem%mesh, condensed => problem%model%condensed)
         do w = 1, size(windows%slot, kind=ik)
            if (.not. windows%is_active(w, tips)) cycle
            associate (window => windows%slot(w)%window)
               cells = pack([(i, i=1, mesh%n_cells)], speaker(:mesh%n_cells) == w)
               xy = reshape([(cell_centre(mesh, cells(i)), i=1, size(cells))], [2, size(cells)])
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

end module twolevel_correction
