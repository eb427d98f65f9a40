!> The windows of all tips: built where the network has changed, and asked for intensities.
module twolevel_windows
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use coarse_state, only: state_t
   use growth_law, only: growth_drive
   use growth_tip, only: tip_t
   use mesh_builder, only: mesher_t
   use mesh_types, only: mesh_t, network_t
   use scene_types, only: scene_t
   use twolevel_window, only: coarse_values_t, window_t
   implicit none(type, external)
   private

   public :: windows_t

   !> A window for each tip, and whether it is that of the present network and coarse mesh.
   type :: windows_t
      type(window_t), allocatable :: window(:)
      logical, allocatable :: built(:), projected(:)
      real(rk), allocatable :: seen(:, :)  !< (2, tips) places of the tips that were seen last [m]
   contains
      procedure :: begin
      procedure :: evaluate
      procedure :: accept
      procedure :: network_changed
      procedure :: coarse_changed
      procedure :: n_unknowns
   end type windows_t

contains

   !> No window has been built.
   subroutine begin(self, tips)
      class(windows_t), intent(out) :: self
      type(tip_t), intent(in) :: tips(:)
      integer(ik) :: i

      allocate (self%window(size(tips)), self%seen(2, size(tips)))
      allocate (self%built(size(tips)), self%projected(size(tips)), source=.false.)
      do i = 1, size(tips, kind=ik)
         self%seen(:, i) = tips(i)%xy
      end do
   end subroutine begin

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
      integer(ik) :: i

      call see_tips(self, tips)
      do i = 1, size(tips, kind=ik)
         associate (tip => tips(i), window => self%window(i))
            if (.not. tip%is_free) then
               self%built(i) = .false.
               cycle
            end if
            if (.not. asked(i)) cycle
            if (.not. self%built(i)) then
               call window%build(scene, network, tip%fracture, tip%end, error)
               if (allocated(error)) return
               self%built(i) = .true.
               self%projected(i) = .false.
            end if
            if (.not. self%projected(i)) then
               call window%project(mesher, mesh, values, error)
               if (allocated(error)) return
               self%projected(i) = .true.
            end if
            if (window%undrained .neqv. undrained) then
               call window%set_rock(scene, undrained, error)
               if (allocated(error)) return
            end if
            call window%intensity(scene, mesh, values, state, tip%intensity, error)
            if (allocated(error)) return
            tip%rosette_radius = window%mesh%fracture%tip_radius(window%tip)
            tip%drive = growth_drive(tip%intensity%k1, tip%intensity%k2, &
                                     window%model%elasticity%crack_modulus())
         end associate
      end do
   end subroutine evaluate

   !> The state that was evaluated last has become history: its slip is what the next one starts
   !! from.
   pure subroutine accept(self)
      class(windows_t), intent(inout) :: self
      integer(ik) :: i

      if (.not. allocated(self%window)) return
      do i = 1, size(self%window, kind=ik)
         if (allocated(self%window(i)%contact)) call self%window(i)%contact%accept()
      end do
   end subroutine accept

   !> Windows that hold the last segment of a tip that has moved, as it was or as it is, must be
   !! meshed again.
   pure subroutine see_tips(self, tips)
      class(windows_t), intent(inout) :: self
      type(tip_t), intent(in) :: tips(:)
      integer(ik) :: i

      do i = 1, size(tips, kind=ik)
         associate (tip => tips(i), seen => self%seen(:, i))
            if (all(abs(tip%xy - seen) <= 0.0_rk)) cycle
            call forget(self, tip%origin, seen)
            call forget(self, tip%origin, tip%xy)
            seen = tip%xy
         end associate
      end do
   end subroutine see_tips

   !> Windows that hold a segment must be meshed again.
   pure subroutine forget(self, from, to)
      class(windows_t), intent(inout) :: self
      real(rk), intent(in) :: from(2), to(2)  !< [m]
      integer(ik) :: i

      do i = 1, size(self%window, kind=ik)
         if (.not. self%built(i)) cycle
         if (all(min(from, to) <= self%window(i)%upper) .and. &
             all(max(from, to) >= self%window(i)%lower)) self%built(i) = .false.
      end do
   end subroutine forget

   !> The network is another one now, not only at its tips.
   pure subroutine network_changed(self)
      class(windows_t), intent(inout) :: self

      self%built = .false.
   end subroutine network_changed

   !> The coarse mesh is another one now.
   pure subroutine coarse_changed(self)
      class(windows_t), intent(inout) :: self

      self%projected = .false.
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
