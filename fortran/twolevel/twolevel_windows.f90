!> The windows of all tips: built where the network has changed, and evaluated for intensities.
!!
!! Each tip has a separate window, or the body is one window for all tips. Tips whose windows would
!! have to be nearly as large as the body share one window, the body.
!!
!! Windows are evaluated in parallel on the available threads; the results do not depend on their
!! number.
module twolevel_windows
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use coarse_state, only: fracture_cells_t, state_t
   use growth_law, only: growth_drive
   use growth_tip, only: tip_t
   use mesh_builder, only: mesher_t
   use mesh_types, only: mesh_t
   use scene_types, only: scene_t
   use report_rows, only: window_fields_t
   use report_scene, only: has_other_toughness, relative_toughness
   use fine_tip_types, only: intensity_t
   use growth_front, only: front_state_t
   use twolevel_back_stress, only: back_stress_of
   use twolevel_problem, only: coarse_problem_t
   use twolevel_still_fractures, only: find_needed
   use twolevel_window, only: window_t
   use twolevel_window_heat, only: heat_error, warm_window
   use twolevel_window_slot, only: by_size, has_to_be_meshed, renew, slot_t
   use twolevel_window_tip, only: window_tip_t
   use twolevel_windows_state, only: window_history_t, windows_state_t
   implicit none(type, external)
   private

   public :: failure_t, first_failure, windows_t

   !> Number of tips up to which all are in the focus of the body as window, and lack of toughness,
   !! error included, beyond which other tips are not [-].
   integer, parameter :: few = 8
   real(rk), parameter :: far = 0.5_rk

   !> Error in the evaluation of a window.
   type :: failure_t
      type(error_t), allocatable :: error
   end type failure_t

   !> The windows, separate from the state; their history is in windows_state_t.
   type :: windows_t
      type(slot_t), allocatable :: slot(:)
      integer(ik), allocatable :: window_of(:)  !< (tips) number of the window
      !> (tips) K_IC of the rock at each tip over K_IC of the scene [-]
      real(rk), allocatable :: resistance(:)
      logical :: is_beside_body = .false.  !< the windows are compared with the body as one window
   contains
      procedure :: begin
      procedure :: begin_step
      procedure :: put_back
      procedure :: evaluate
      procedure :: prepare
      procedure :: network_changed
      procedure :: coarse_changed
      procedure :: intensity_of
      procedure :: is_active
      procedure :: served_with
      procedure :: has_mesh
      procedure :: has_to_mesh
      procedure :: mesh_again
      procedure :: take_body
      procedure :: share_body
      procedure :: all_in_body
      procedure :: n_unknowns
      procedure :: meshes
   end type windows_t

contains

   !> Begin without meshes. After the windows of the tips there is one more window, the body, which
   !! at first serves no tips.
   subroutine begin(self, tips, is_body, body_coarser, known)
      class(windows_t), intent(out) :: self
      type(tip_t), intent(in) :: tips(:)
      logical, intent(in) :: is_body  !< the body is one window for all tips
      !> size of elements of the body along fractures, over that of the scene [-]
      real(rk), intent(in) :: body_coarser
      type(windows_state_t), intent(out) :: known
      integer(ik) :: i, n_windows

      n_windows = size(tips, kind=ik) + 1
      if (is_body) n_windows = 1
      allocate (self%slot(n_windows), self%window_of(size(tips)))
      allocate (known%history(n_windows), known%tip(size(tips)))
      allocate (self%resistance(size(tips)), source=1.0_rk)
      do i = 1, size(tips, kind=ik)
         self%window_of(i) = merge(1_ik, i, is_body)
         known%tip(i)%fracture = tips(i)%fracture
         known%tip(i)%end = tips(i)%end
      end do
      known%tip%has_focus = size(tips) <= few
      known%tip%is_needed = size(tips) <= few
      do i = 1, n_windows
         allocate (self%slot(i)%window)
         associate (window => self%slot(i)%window)
            window%is_body = i == n_windows
            if (window%is_body) window%coarser = body_coarser
            window%serves = numbers_of(self%window_of == i)
         end associate
      end do
   end subroutine begin

   !> Begin a step: the windows are those of the accepted state.
   subroutine begin_step(self)
      class(windows_t), intent(inout) :: self
      integer(ik) :: w

      if (.not. allocated(self%slot)) return
      do w = 1, size(self%slot, kind=ik)
         call self%slot(w)%accept()
      end do
   end subroutine begin_step

   !> Undo a rejected try: restore the windows of the last accepted state.
   subroutine put_back(self)
      class(windows_t), intent(inout) :: self
      integer(ik) :: w

      if (.not. allocated(self%slot)) return
      do w = 1, size(self%slot, kind=ik)
         call self%slot(w)%put_back()
      end do
   end subroutine put_back

   !> Indices of the true elements.
   pure function numbers_of(mask) result(numbers)
      logical, intent(in) :: mask(:)
      integer(ik), allocatable :: numbers(:)
      integer(ik) :: i

      numbers = pack([(i, i=1, size(mask, kind=ik))], mask)
   end function numbers_of

   !> Evaluate intensities, drive and rosette radius of the active tips in a state of the coarse
   !! level.
   subroutine evaluate(self, scene, front, active, problem, state, known, error)
      class(windows_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(front_state_t), intent(inout) :: front
      logical, intent(in) :: active(:)  !< (tips) active tips
      type(coarse_problem_t), intent(in) :: problem  !< with the values of the state
      type(state_t), intent(in) :: state
      type(windows_state_t), intent(inout) :: known
      type(error_t), allocatable, intent(out) :: error
      logical :: is_due(size(self%slot))
      integer(ik) :: w

      call find_focus(front%tip, scene%material%toughness, known%tip)
      call find_needed(scene, front, problem, state, known%tip)
      is_due = [(any(active(self%slot(w)%window%serves)), w=1, size(self%slot))]
      call evaluate_windows(self, scene, front, is_due, problem, state, known, error)
      if (allocated(error)) return
      ! Tips that have come near their toughness, in the body as window.
      call find_focus(front%tip, scene%material%toughness, known%tip)
      call find_needed(scene, front, problem, state, known%tip)
      is_due = is_due .and. [(self%slot(w)%window%is_too_coarse(known%tip), w=1, size(self%slot))]
      if (.not. any(is_due)) return
      call evaluate_windows(self, scene, front, is_due, problem, state, known, error)
   end subroutine evaluate

   !> Focus of the body on tips near their toughness: they keep it.
   elemental subroutine find_focus(tip, toughness, seen)
      type(tip_t), intent(in) :: tip
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      type(window_tip_t), intent(inout) :: seen

      seen%has_focus = seen%has_focus .or. (tip%is_loaded() .and. tip%excess(toughness) &
                                            + tip%relative_error(toughness) > -far)
   end subroutine find_focus

   !> Evaluate windows, those with the largest meshes first.
   subroutine evaluate_windows(self, scene, front, is_due, problem, state, known, error)
      type(windows_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(front_state_t), intent(inout) :: front
      logical, intent(in) :: is_due(:)  !< (windows)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(windows_state_t), intent(inout) :: known
      type(error_t), allocatable, intent(out) :: error
      type(failure_t) :: failure(size(self%slot))
      integer(ik) :: i, w, largest_first(size(self%slot))

      if (has_other_toughness(scene)) then
         self%resistance = [(relative_toughness(scene, front%network, front%tip(i)%fracture, &
                                                front%tip(i)%end), i=1, size(front%tip))]
      end if
      largest_first = by_size(self%slot)
      !$omp parallel private(w)
      !$omp single
      do i = 1, size(self%slot, kind=ik)
         w = largest_first(i)
         if (.not. self%is_active(w, front%tip)) cycle
         if (.not. is_due(w)) cycle
         !$omp task firstprivate(w) default(shared)
         call evaluate_window(self, w, scene, front, problem, state, known, failure(w)%error)
         !$omp end task
      end do
      !$omp end single
      !$omp end parallel
      call first_failure(failure, error)
   end subroutine evaluate_windows

   !> Mesh the windows of tips that have moved, and factorize their matrices: what does not depend
   !! on the state of the coarse level, which may be solved at the same time.
   subroutine prepare(self, scene, front, active, mesher, mesh, cells, known, error)
      class(windows_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(front_state_t), intent(in) :: front
      logical, intent(in) :: active(:)  !< (tips) active tips
      type(mesher_t), intent(in) :: mesher  !< of the coarse mesh
      type(mesh_t), intent(in) :: mesh
      type(fracture_cells_t), intent(in) :: cells  !< of the coarse level
      type(windows_state_t), intent(inout) :: known
      type(error_t), allocatable, intent(out) :: error
      type(failure_t) :: failure(size(self%slot))
      integer(ik) :: w

      do w = 1, size(self%slot, kind=ik)
         associate (serves => self%slot(w)%window%serves)
            if (.not. any(active(serves) .and. front%tip(serves)%is_loaded())) cycle
         end associate
         if (.not. has_to_be_meshed(self%slot(w)%window, front%tip)) cycle
         !$omp task firstprivate(w) default(shared)
         call prepare_window(self%slot(w), scene, front, self%is_beside_body, mesher, mesh, cells, &
                             known%tip, known%history(w), failure(w)%error)
         !$omp end task
      end do
      !$omp taskwait
      call first_failure(failure, error)
   end subroutine prepare

   !> Mesh a window and factorize its matrix.
   subroutine prepare_window(slot, scene, front, is_beside_body, mesher, mesh, cells, seen, &
                             history, error)
      type(slot_t), intent(inout) :: slot
      type(scene_t), intent(in) :: scene
      type(front_state_t), intent(in) :: front
      logical, intent(in) :: is_beside_body
      type(mesher_t), intent(in) :: mesher  !< of the coarse mesh
      type(mesh_t), intent(in) :: mesh
      type(fracture_cells_t), intent(in) :: cells  !< of the coarse level
      type(window_tip_t), intent(in) :: seen(:)  !< (tips)
      type(window_history_t), intent(inout) :: history
      type(error_t), allocatable, intent(out) :: error

      call renew(slot, scene, front%network, front%tip, is_beside_body, seen, history, error)
      if (allocated(error)) return
      call slot%window%project(mesher, mesh, cells%roughness > 0.0_rk, error)
      if (allocated(error)) return
      ! Which faces are held on a new mesh depends on the state.
      if (slot%window%is_body .and. .not. allocated(slot%window%made%held)) return
      call slot%window%prepare_matrix(scene, cells%law, error)
   end subroutine prepare_window

   !> Error of the first window with an error.
   pure subroutine first_failure(failure, error)
      type(failure_t), intent(in) :: failure(:)  !< (windows)
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: w

      do w = 1, size(failure, kind=ik)
         if (.not. allocated(failure(w)%error)) cycle
         error = failure(w)%error
         return
      end do
   end subroutine first_failure

   !> Evaluate the tips of window w. No other window or tip changes: threads evaluate others.
   subroutine evaluate_window(self, w, scene, front, problem, state, known, error)
      type(windows_t), intent(inout) :: self
      integer(ik), intent(in) :: w
      type(scene_t), intent(in) :: scene
      type(front_state_t), intent(inout) :: front
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(windows_state_t), intent(inout) :: known
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: i

      if (has_to_be_meshed(self%slot(w)%window, front%tip) .or. &
          self%slot(w)%window%is_too_coarse(known%tip)) then
         call renew(self%slot(w), scene, front%network, front%tip, self%is_beside_body, known%tip, &
                    known%history(w), error)
         if (allocated(error)) return
      end if
      associate (window => self%slot(w)%window, undrained => problem%values%undrained, &
                 seen => known%tip)
         if (.not. window%made%is_projected) then
            call window%project(problem%mesher, problem%mesh, problem%values%is_grown, error)
            if (allocated(error)) return
         end if
         if ((window%undrained .neqv. undrained) .or. .not. allocated(window%model%stiffness)) then
            call window%set_rock(scene, undrained, error)
            if (allocated(error)) return
         end if
         call window%choose_tips(window%at > 0 .and. front%tip(window%serves)%is_loaded())
         call warm_window(problem, window%model%mesh, window%map, window%loads)
         call window%find_intensities(scene, problem%mesh, problem%values, state, seen, &
                                      known%history(w), error)
         if (allocated(error)) return
         do i = 1, size(window%serves, kind=ik)
            associate (t => window%serves(i), tip => front%tip(window%serves(i)))
               if (.not. window%served(i)%is_evaluated) cycle
               seen(t)%found%k1_error = seen(t)%found%k1_error &
                                        + heat_error(problem, tip%fracture, tip%end)
               seen(t)%back_stress = back_stress_of(problem, state, tip%fracture, tip%end, &
                                                    tip%layer_age)
               tip%intensity = seen(t)%with_coarse_error(window%crack_modulus(window%at(i)))
               tip%rosette_radius = window%mesh%fracture%tip_radius(window%at(i))
               tip%drive = growth_drive(tip%intensity%k1, tip%intensity%k2, &
                                        window%crack_modulus(window%at(i)))
               call tip%resist(self%resistance(t))
            end associate
         end do
      end associate
   end subroutine evaluate_window

   !> Intensities of a tip in the last solution of its window, with the errors of both levels.
   pure function intensity_of(self, tip, seen) result(intensity)
      class(windows_t), intent(in) :: self
      integer(ik), intent(in) :: tip
      type(window_tip_t), intent(in) :: seen  !< data of this tip
      type(intensity_t) :: intensity

      associate (window => self%slot(self%window_of(tip))%window)
         intensity = seen%with_coarse_error(window%crack_modulus(window%at(findloc( &
                                                                       window%serves, tip, dim=1))))
      end associate
   end function intensity_of

   !> Numbers of the tips that are evaluated in the same window as a tip, this tip included.
   pure function served_with(self, tip) result(numbers)
      class(windows_t), intent(in) :: self
      integer(ik), intent(in) :: tip
      integer(ik), allocatable :: numbers(:)

      numbers = self%slot(self%window_of(tip))%window%serves
   end function served_with

   !> The window of a tip has been meshed, and is not to be meshed again from the beginning.
   pure logical function has_mesh(self, tip)
      class(windows_t), intent(in) :: self
      integer(ik), intent(in) :: tip

      has_mesh = allocated(self%slot(self%window_of(tip))%window%made)
   end function has_mesh

   !> A window serves a tip with intensities to be evaluated.
   pure logical function is_active(self, window, tips)
      class(windows_t), intent(in) :: self
      integer(ik), intent(in) :: window
      type(tip_t), intent(in) :: tips(:)

      is_active = any(tips(self%slot(window)%window%serves)%is_loaded())
   end function is_active

   !> Whether some windows are to be meshed, or their meshes moved, for these tips.
   pure logical function has_to_mesh(self, tips)
      class(windows_t), intent(in) :: self
      type(tip_t), intent(in) :: tips(:)
      integer(ik) :: w

      has_to_mesh = .false.
      do w = 1, size(self%slot, kind=ik)
         if (self%is_active(w, tips) .and. .not. has_to_mesh) then
            has_to_mesh = has_to_be_meshed(self%slot(w)%window, tips)
         end if
      end do
   end function has_to_mesh

   !> Mark the window of a tip to be meshed again, refined.
   pure subroutine mesh_again(self, tip, seen)
      class(windows_t), intent(inout) :: self
      integer(ik), intent(in) :: tip
      type(window_tip_t), intent(inout) :: seen  !< data of this tip

      call forget_mesh(self%slot(self%window_of(tip))%window)
      call seen%forget_coarse_error()
   end subroutine mesh_again

   !> Discard the mesh of a window.
   pure subroutine forget_mesh(window)
      type(window_t), intent(inout) :: window

      if (allocated(window%made)) deallocate (window%made)
   end subroutine forget_mesh

   !> Evaluate a tip in the body from now on, not in a separate window.
   pure subroutine take_body(self, tip, seen)
      class(windows_t), intent(inout) :: self
      integer(ik), intent(in) :: tip
      type(window_tip_t), intent(inout) :: seen  !< data of this tip
      integer(ik) :: body, own

      own = self%window_of(tip)
      body = size(self%slot, kind=ik)
      self%window_of(tip) = body
      self%slot(own)%window%serves = numbers_of(self%window_of == own)
      self%slot(body)%window%serves = numbers_of(self%window_of == body)
      call forget_mesh(self%slot(own)%window)
      call self%mesh_again(tip, seen)
   end subroutine take_body

   !> Evaluate all tips in the body from now on, with elements as small as those of their windows.
   pure subroutine share_body(self, seen)
      class(windows_t), intent(inout) :: self
      type(window_tip_t), intent(inout) :: seen(:)  !< (tips)
      integer(ik) :: i

      self%slot(size(self%slot))%window%coarser = 1.0_rk
      do i = 1, size(seen, kind=ik)
         call self%take_body(i, seen(i))
      end do
   end subroutine share_body

   !> Whether all tips are evaluated in the body as one window.
   pure logical function all_in_body(self)
      class(windows_t), intent(in) :: self

      all_in_body = .false.
      if (allocated(self%slot)) all_in_body = all(self%window_of == size(self%slot))
   end function all_in_body

   !> Discard all meshes: the network has changed, not only at its tips.
   pure subroutine network_changed(self)
      class(windows_t), intent(inout) :: self
      integer(ik) :: w

      if (.not. allocated(self%slot)) return
      do w = 1, size(self%slot, kind=ik)
         call forget_mesh(self%slot(w)%window)
      end do
   end subroutine network_changed

   !> Mark the positions in the coarse mesh as unknown: the coarse mesh has changed.
   pure subroutine coarse_changed(self)
      class(windows_t), intent(inout) :: self
      integer(ik) :: w

      if (.not. allocated(self%slot)) return
      do w = 1, size(self%slot, kind=ik)
         if (allocated(self%slot(w)%window%made)) self%slot(w)%window%made%is_projected = .false.
      end do
   end subroutine coarse_changed

   !> Number of unknowns of all windows of free tips.
   pure integer(ik) function n_unknowns(self, tips)
      class(windows_t), intent(in) :: self
      type(tip_t), intent(in) :: tips(:)
      integer(ik) :: w

      n_unknowns = 0
      do w = 1, size(self%slot, kind=ik)
         associate (window => self%slot(w)%window)
            if (.not. allocated(window%made) .or. .not. self%is_active(w, tips)) cycle
            n_unknowns = n_unknowns + window%model%constraints%n_dofs
         end associate
      end do
   end function n_unknowns

   !> The elements of all windows with active tips, as triangles of their corners.
   pure function meshes(self, tips) result(all)
      class(windows_t), intent(in) :: self
      type(tip_t), intent(in) :: tips(:)
      type(window_fields_t) :: all
      integer(ik) :: w, before

      allocate (all%xy(2, 0), all%cell_nodes(3, 0), all%tip(0))
      do w = 1, size(self%slot, kind=ik)
         associate (window => self%slot(w)%window)
            if (.not. allocated(window%made) .or. .not. self%is_active(w, tips)) cycle
            associate (mesh => window%model%mesh)
               before = size(all%xy, 2, kind=ik)
               all%xy = reshape([all%xy, mesh%xy(:, :mesh%n_vertices)], &
                                [2_ik, before + mesh%n_vertices])
               all%tip = [all%tip, spread(window%serves(1), 1, mesh%n_cells)]
               all%cell_nodes = reshape([all%cell_nodes, before + mesh%cell_nodes(:3, :)], &
                                        [3, size(all%tip)])
            end associate
         end associate
      end do
   end function meshes

end module twolevel_windows
