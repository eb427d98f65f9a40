!> A window of tips and the one of the last accepted state: meshed again where tips have grown, or
!! its mesh moved with them.
module twolevel_window_slot
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use growth_tip, only: tip_t
   use mesh_builder, only: mesher_t, transfer_mesher
   use mesh_types, only: network_t
   use scene_types, only: scene_t
   use twolevel_window, only: window_t
   use twolevel_window_tip, only: window_tip_t
   use twolevel_windows_state, only: window_history_t
   implicit none(type, external)
   private

   public :: renew, slot_t

   !> A window, and its copy.
   type :: slot_t
      type(window_t), allocatable :: window
      !> window of the last accepted state, if the window has been meshed since
      type(window_t), allocatable :: kept
   contains
      procedure :: accept
      procedure :: put_back
   end type slot_t

contains

   !> The window becomes that of the accepted state.
   subroutine accept(self)
      class(slot_t), intent(inout) :: self

      if (.not. allocated(self%kept)) return
      if (self%window%follows_other) then
         if (self%kept%has_moved) then
            call transfer_mesher(self%kept%as_made, self%window%as_made)
         else
            call transfer_mesher(self%kept%mesher, self%window%as_made)
         end if
         self%window%follows_other = .false.
      end if
      deallocate (self%kept)
   end subroutine accept

   !> Restore the window of the accepted state.
   subroutine put_back(self)
      class(slot_t), intent(inout) :: self

      if (.not. allocated(self%kept)) return
      call self%kept%model%take_order(self%window%model)
      deallocate (self%window)
      call move_alloc(self%kept, self%window)
   end subroutine put_back

   !> Mesh a window again, or move its mesh with the tips if nothing else has changed in it.
   subroutine renew(slot, scene, network, tips, is_beside_body, seen, history, error)
      type(slot_t), intent(inout) :: slot
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      type(tip_t), intent(in) :: tips(:)
      logical, intent(in) :: is_beside_body
      type(window_tip_t), intent(in) :: seen(:)  !< (tips)
      type(window_history_t), intent(inout) :: history
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: i
      logical :: follows

      call history%leave_mesh(slot%window%model%mesh)
      ! Also where it is to be meshed again: the contact of the accepted state is on this mesh.
      if (slot%window%model%mesh%n_nodes > 0 .and. .not. allocated(slot%kept)) then
         call move_alloc(slot%window, slot%kept)
         allocate (slot%window)
         call slot%window%take_plan(slot%kept)
      end if
      associate (window => slot%window)
         follows = allocated(window%made) .and. .not. window%is_too_coarse(seen)
         if (follows) follows = all(tips%is_free .eqv. window%made%is_free)
         if (follows) call follow_tips(slot, scene, network, seen, follows, error)
         if (.not. (follows .or. allocated(error))) then
            call window%build(scene, network, seen, is_beside_body, error)
         end if
         if (allocated(error)) return
         if (any(tips(window%serves)%is_free .and. window%at == 0 .and. &
                 window%has_fracture(tips(window%serves)%fracture))) then
            call raise_error(error, "evaluate", "a window does not contain its tip")
            return
         end if
         window%made%is_projected = .false.
         window%made%is_free = tips%is_free
         window%made%place = reshape([(tips(i)%xy, i=1, size(tips))], [2, size(tips)])
      end associate
   end subroutine renew

   !> Move the original mesh with the tips; it is in the window, or in its copy.
   subroutine follow_tips(slot, scene, network, seen, is_done, error)
      type(slot_t), intent(inout) :: slot
      type(scene_t), intent(in) :: scene
      type(network_t), intent(in) :: network
      type(window_tip_t), intent(in) :: seen(:)  !< (tips)
      logical, intent(out) :: is_done
      type(error_t), allocatable, intent(out) :: error
      type(mesher_t) :: as_made

      associate (window => slot%window)
         if (.not. window%follows_other) then
            if (.not. window%has_moved) call transfer_mesher(window%mesher, window%as_made)
            call transfer_mesher(window%as_made, as_made)
            call window%follow(scene, network, seen, as_made, is_done, error)
            call transfer_mesher(as_made, window%as_made)
         else if (slot%kept%has_moved) then
            call window%follow(scene, network, seen, slot%kept%as_made, is_done, error)
         else
            call window%follow(scene, network, seen, slot%kept%mesher, is_done, error)
         end if
      end associate
   end subroutine follow_tips

end module twolevel_window_slot
