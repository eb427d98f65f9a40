!> The windows of all tips: built where the network has changed, and asked for intensities.
!!
!! Each tip has a window of its own, or the body is one window for all of them. Tips whose own
!! windows would have to be nearly as large as the body share one that is the body.
!!
!! Windows are evaluated side by side on as many threads as there are; each is what it is alone.
module twolevel_windows
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use coarse_state, only: state_t
   use fine_tip_types, only: intensity_t
   use growth_law, only: growth_drive
   use growth_tip, only: tip_t
   use mesh_builder, only: mesher_t
   use mesh_types, only: mesh_t, network_t
   use report_scene, only: has_other_toughness, relative_toughness
   use scene_types, only: scene_t
   use twolevel_window, only: coarse_values_t, window_t
   use twolevel_window_tip, only: window_tip_t
   implicit none(type, external)
   private

   public :: failure_t, first_failure, windows_t

   !> A tip that another one's window holds has moved where it has by more than this share of its
   !! distance to that: intensities change by a small part of it [-].
   real(rk), parameter :: noticeable = 1.0e-3_rk

   !> Why a window could not be evaluated, if so.
   type :: failure_t
      type(error_t), allocatable :: error
   end type failure_t

   !> The windows, and whether each is that of the present network and coarse mesh.
   type :: windows_t
      type(window_t), allocatable :: window(:)
      logical, allocatable :: built(:), projected(:)  !< (windows)
      logical, allocatable :: may_follow(:)  !< (windows) built, but tips have moved since
      integer(ik), allocatable :: window_of(:)  !< (tips)
      type(window_tip_t), allocatable :: tip(:)  !< what the windows know of the tips
      real(rk), allocatable :: built_for(:, :, :)  !< (2, tips, windows) places of the tips [m]
      !> (tips) K_IC of the rock that each grows in over that of the scene's [-]
      real(rk), allocatable :: resistance(:)
      logical, allocatable :: was_free(:, :)  !< (tips, windows) it had not joined anything then
   contains
      procedure :: begin
      procedure :: evaluate
      procedure :: accept
      procedure :: take_back
      procedure :: network_changed
      procedure :: coarse_changed
      procedure :: intensity_of
      procedure :: is_asked
      procedure :: has_to_mesh
      procedure :: make_anew
      procedure :: take_body
      procedure :: n_unknowns
   end type windows_t

contains

   !> No window has been built. After those of the tips there is one that is the body, for none.
   subroutine begin(self, tips, is_body, body_coarser)
      class(windows_t), intent(out) :: self
      type(tip_t), intent(in) :: tips(:)
      logical, intent(in) :: is_body  !< it is one window for all tips
      !> Elements of the body along fractures, over what the scene says [-]
      real(rk), intent(in) :: body_coarser
      integer(ik) :: i, n_windows

      n_windows = size(tips, kind=ik) + 1
      if (is_body) n_windows = 1
      allocate (self%window(n_windows), self%window_of(size(tips)))
      allocate (self%tip(size(tips)))
      allocate (self%resistance(size(tips)), source=1.0_rk)
      allocate (self%built_for(2, size(tips), n_windows), source=0.0_rk)
      allocate (self%was_free(size(tips), n_windows), source=.true.)
      allocate (self%built(n_windows), self%projected(n_windows), self%may_follow(n_windows), &
                source=.false.)
      do i = 1, size(tips, kind=ik)
         self%window_of(i) = merge(1_ik, i, is_body)
         self%tip(i)%fracture = tips(i)%fracture
         self%tip(i)%end = tips(i)%end
      end do
      do i = 1, n_windows
         self%window(i)%is_body = i == n_windows
         if (self%window(i)%is_body) self%window(i)%coarser = body_coarser
         self%window(i)%serves = numbers_of(self%window_of == i)
      end do
   end subroutine begin

   !> Which are true.
   pure function numbers_of(mask) result(numbers)
      logical, intent(in) :: mask(:)
      integer(ik), allocatable :: numbers(:)
      integer(ik) :: i

      numbers = pack([(i, i=1, size(mask, kind=ik))], mask)
   end function numbers_of

   !> Intensities, drive and rosette radius of every tip that is asked for, in the present state of
   !! the coarse level.
   subroutine evaluate(self, scene, network, tips, asked, mesher, mesh, values, state, undrained, &
                       error)
      class(windows_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network  !< of the fine level
      type(tip_t), intent(inout) :: tips(:)
      logical, intent(in) :: asked(:)  !< (tips)
      type(mesher_t), intent(in) :: mesher  !< of the coarse mesh
      type(mesh_t), intent(in) :: mesh  !< the coarse one
      type(coarse_values_t), intent(in) :: values
      type(state_t), intent(in) :: state
      logical, intent(in) :: undrained  !< no fluid has moved since the load changed
      type(error_t), allocatable, intent(out) :: error
      type(failure_t) :: failure(size(self%window))
      integer(ik) :: i, w, largest_first(size(self%window))

      call see_tips(self, tips)
      if (has_other_toughness(scene)) then
         self%resistance = [(relative_toughness(scene, network, tips(i)%fracture, tips(i)%end), &
                             i=1, size(tips))]
      end if
      largest_first = by_size(self%window)
      !$omp parallel private(w)
      !$omp single
      do i = 1, size(self%window, kind=ik)
         w = largest_first(i)
         if (self%is_asked(w, tips)) then
            if (.not. any(asked(self%window(w)%serves))) cycle
            !$omp task firstprivate(w) default(shared)
            call evaluate_window(self, w, scene, network, tips, mesher, mesh, values, state, &
                                 undrained, failure(w)%error)
            !$omp end task
         else
            self%built(w) = .false.
            self%may_follow(w) = .false.
         end if
      end do
      !$omp end single
      !$omp end parallel
      call first_failure(failure, error)
   end subroutine evaluate

   !> Windows by the sizes of the meshes that they have now, so that none of the largest is left for
   !! one thread at the end.
   pure function by_size(window) result(order)
      type(window_t), intent(in) :: window(:)
      integer(ik) :: order(size(window))
      integer(ik) :: i, k

      do i = 1, size(window, kind=ik)
         do k = i, 2, -1
            if (window(order(k - 1))%mesh%n_cells >= window(i)%mesh%n_cells) exit
            order(k) = order(k - 1)
         end do
         order(k) = i
      end do
   end function by_size

   !> The error of the first window that has one.
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

   !> The same for the tips of one window. It changes nothing of other windows or tips.
   subroutine evaluate_window(self, w, scene, network, tips, mesher, mesh, values, state, &
                              undrained, error)
      class(windows_t), intent(inout) :: self
      integer(ik), intent(in) :: w
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      type(tip_t), intent(inout) :: tips(:)
      type(mesher_t), intent(in) :: mesher
      type(mesh_t), intent(in) :: mesh
      type(coarse_values_t), intent(in) :: values
      type(state_t), intent(in) :: state
      logical, intent(in) :: undrained
      type(error_t), allocatable, intent(out) :: error

      associate (window => self%window(w))
         if (.not. self%built(w)) then
            call renew(self, w, scene, network, tips, error)
            if (allocated(error)) return
         end if
         if (.not. self%projected(w)) then
            call window%project(mesher, mesh, values, error)
            if (allocated(error)) return
            self%projected(w) = .true.
         end if
         if (window%undrained .neqv. undrained) then
            call window%set_rock(scene, undrained, error)
            if (allocated(error)) return
         end if
         call window%find_intensities(scene, mesh, values, state, self%tip, error)
         if (allocated(error)) return
         call tell(self, window, tips)
      end associate
   end subroutine evaluate_window

   !> Mesh a window anew, or let its mesh follow the tips if nothing else has changed in it.
   subroutine renew(self, w, scene, network, tips, error)
      class(windows_t), intent(inout) :: self
      integer(ik), intent(in) :: w  !< window
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      type(tip_t), intent(in) :: tips(:)
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: i
      logical :: follows

      associate (window => self%window(w))
         follows = self%may_follow(w) .and. all(tips%is_free .eqv. self%was_free(:, w))
         if (follows) call window%follow(scene, network, self%tip, follows, error)
         if (.not. (follows .or. allocated(error))) then
            call window%build(scene, network, self%tip, error)
         end if
         if (allocated(error)) return
         if (any(tips(window%serves)%is_free .and. self%tip(window%serves)%at == 0)) then
            call raise_error(error, "evaluate", "a window has not the tip that it is for")
            return
         end if
      end associate
      self%built(w) = .true.
      self%may_follow(w) = .true.
      self%projected(w) = .false.
      self%was_free(:, w) = tips%is_free
      do i = 1, size(tips, kind=ik)
         self%built_for(:, i, w) = tips(i)%xy
      end do
   end subroutine renew

   !> What a window has found, to the free tips that it serves.
   pure subroutine tell(self, window, tips)
      class(windows_t), intent(in) :: self
      type(window_t), intent(in) :: window
      type(tip_t), intent(inout) :: tips(:)
      integer(ik) :: i

      do i = 1, size(window%serves, kind=ik)
         associate (t => window%serves(i), tip => tips(window%serves(i)))
            if (.not. tip%is_free) cycle
            tip%intensity = self%intensity_of(t)
            tip%rosette_radius = window%mesh%fracture%tip_radius(self%tip(t)%at)
            tip%drive = growth_drive(tip%intensity%k1, tip%intensity%k2, &
                                     window%crack_modulus(self%tip(t)%at))
            call tip%resist(self%resistance(t))
         end associate
      end do
   end subroutine tell

   !> The intensities of a tip in the last solution of its window, with the errors of both levels.
   pure function intensity_of(self, tip) result(intensity)
      class(windows_t), intent(in) :: self
      integer(ik), intent(in) :: tip
      type(intensity_t) :: intensity

      associate (window => self%window(self%window_of(tip)))
         intensity = self%tip(tip)%with_coarse_error(window%crack_modulus(self%tip(tip)%at))
      end associate
   end function intensity_of

   !> A window serves a tip that is free.
   pure logical function is_asked(self, window, tips)
      class(windows_t), intent(in) :: self
      integer(ik), intent(in) :: window
      type(tip_t), intent(in) :: tips(:)

      is_asked = any(tips(self%window(window)%serves)%is_free)
   end function is_asked

   !> Meshes of some windows are those of other tips than these: to be made anew, or to be moved.
   pure logical function has_to_mesh(self, tips)
      class(windows_t), intent(in) :: self
      type(tip_t), intent(in) :: tips(:)
      integer(ik) :: i, w

      has_to_mesh = .false.
      do w = 1, size(self%window, kind=ik)
         if (.not. self%is_asked(w, tips)) cycle
         has_to_mesh = has_to_mesh .or. .not. self%built(w)
         if (has_to_mesh) return
         has_to_mesh = any([(has_moved(self, tips, i, w), i=1, size(tips, kind=ik))])
      end do
   end function has_to_mesh

   !> The state that was evaluated last has become history: its slip is what the next one starts
   !! from.
   pure subroutine accept(self)
      class(windows_t), intent(inout) :: self
      integer(ik) :: i

      if (.not. allocated(self%window)) return
      do i = 1, size(self%window, kind=ik)
         call self%window(i)%accept()
      end do
   end subroutine accept

   !> What has been evaluated since then was a try that is rejected.
   pure subroutine take_back(self)
      class(windows_t), intent(inout) :: self
      integer(ik) :: i

      if (.not. allocated(self%window)) return
      do i = 1, size(self%window, kind=ik)
         call self%window(i)%take_back()
      end do
   end subroutine take_back

   !> Windows that hold the last segment of a tip that has moved, as it was or as it is, must be
   !! meshed again.
   pure subroutine see_tips(self, tips)
      class(windows_t), intent(inout) :: self
      type(tip_t), intent(in) :: tips(:)
      integer(ik) :: i, w

      do w = 1, size(self%window, kind=ik)
         do i = 1, size(tips, kind=ik)
            if (self%built(w)) self%built(w) = .not. has_moved(self, tips, i, w)
         end do
      end do
   end subroutine see_tips

   !> A tip has moved noticeably in a window since that was meshed.
   pure logical function has_moved(self, tips, i, w)
      class(windows_t), intent(in) :: self
      type(tip_t), intent(in) :: tips(:)
      integer(ik), intent(in) :: i, w
      real(rk) :: apart, moved
      integer(ik) :: k

      associate (tip => tips(i), before => self%built_for(:, i, w), window => self%window(w))
         moved = norm2(tip%xy - before)
         has_moved = moved > 0.0_rk
         if (has_moved) has_moved = overlaps(window, tip%origin, before) .or. &
                                    overlaps(window, tip%origin, tip%xy)
         if (.not. has_moved) return
         apart = huge(1.0_rk)
         do k = 1, size(window%serves, kind=ik)
            apart = min(apart, norm2(tip%xy - tips(window%serves(k))%xy))
         end do
         ! The last stretch to a joint, there or back, is short but not small.
         has_moved = any(window%serves == i) .or. moved > noticeable*apart .or. &
                     (tip%is_free .neqv. self%was_free(i, w))
      end associate
   end function has_moved

   !> The box around a segment and that of a window have something in common.
   pure logical function overlaps(window, from, to)
      type(window_t), intent(in) :: window
      real(rk), intent(in) :: from(2), to(2)  !< [m]

      overlaps = all(min(from, to) <= window%upper) .and. all(max(from, to) >= window%lower)
   end function overlaps

   !> The window of a tip must be meshed again, for it is to be a better one.
   pure subroutine make_anew(self, tip)
      class(windows_t), intent(inout) :: self
      integer(ik), intent(in) :: tip

      self%built(self%window_of(tip)) = .false.
      self%may_follow(self%window_of(tip)) = .false.
      call self%tip(tip)%forget_coarse_error()
   end subroutine make_anew

   !> A tip is to be known from the body from now on, not from a window of its own.
   pure subroutine take_body(self, tip)
      class(windows_t), intent(inout) :: self
      integer(ik), intent(in) :: tip
      integer(ik) :: body, own

      own = self%window_of(tip)
      body = size(self%window, kind=ik)
      self%window_of(tip) = body
      self%window(own)%serves = numbers_of(self%window_of == own)
      self%window(body)%serves = numbers_of(self%window_of == body)
      self%built(own) = .false.
      call self%make_anew(tip)
   end subroutine take_body

   !> The network is another one now, not only at its tips.
   pure subroutine network_changed(self)
      class(windows_t), intent(inout) :: self

      if (.not. allocated(self%built)) return
      self%built = .false.
      self%may_follow = .false.
   end subroutine network_changed

   !> The coarse mesh is another one now.
   pure subroutine coarse_changed(self)
      class(windows_t), intent(inout) :: self

      if (allocated(self%projected)) self%projected = .false.
   end subroutine coarse_changed

   !> Number of unknowns of all windows.
   pure integer(ik) function n_unknowns(self)
      class(windows_t), intent(in) :: self
      integer(ik) :: i

      n_unknowns = 0
      do i = 1, size(self%window, kind=ik)
         if (self%built(i)) n_unknowns = n_unknowns + self%window(i)%model%constraints%n_dofs
      end do
   end function n_unknowns

end module twolevel_windows
