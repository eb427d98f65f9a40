!> A window of tips and the one of the last accepted state: meshed again where tips have grown, or
!! its mesh moved with them.
module twolevel_window_slot
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use base_tolerances, only: same_place
   use growth_tip, only: tip_t
   use mesh_builder, only: mesher_t, transfer_mesher
   use mesh_types, only: network_t
   use scene_types, only: scene_t
   use twolevel_window, only: window_t
   use twolevel_window_tip, only: window_tip_t
   use twolevel_windows_state, only: window_history_t
   implicit none(type, external)
   private

   public :: by_size, has_to_be_meshed, renew, slot_t

   !> Displacement of a tip in the window of another tip, over the distance of the two tips, above
   !! which this window is meshed again: intensities change by a small part of it [-].
   real(rk), parameter :: noticeable = 1.0e-3_rk

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

   !> Whether a window is to be meshed: there is no mesh, or its rectangle contains the last segment
   !! of a tip that has moved since, before or after the move.
   pure logical function has_to_be_meshed(window, tips) result(has_to)
      type(window_t), intent(in) :: window
      type(tip_t), intent(in) :: tips(:)
      integer(ik) :: i

      has_to = .not. allocated(window%made)
      do i = 1, size(tips, kind=ik)
         if (.not. has_to) has_to = has_moved(window, tips, i)
      end do
   end function has_to_be_meshed

   !> Whether a tip has moved noticeably in a window since its meshing.
   pure logical function has_moved(window, tips, i)
      type(window_t), intent(in) :: window
      type(tip_t), intent(in) :: tips(:)
      integer(ik), intent(in) :: i
      real(rk) :: apart, moved
      integer(ik) :: k

      associate (tip => tips(i), before => window%made%place(:, i))
         moved = norm2(tip%xy - before)
         has_moved = moved > same_place*norm2(tip%xy - tip%origin)
         if (has_moved) has_moved = overlaps(window, tip%origin, before) .or. &
                                    overlaps(window, tip%origin, tip%xy)
         if (.not. has_moved) return
         apart = huge(1.0_rk)
         do k = 1, size(window%serves, kind=ik)
            apart = min(apart, norm2(tip%xy - tips(window%serves(k))%xy))
         end do
         ! The ligament before a joint is short but matters.
         has_moved = any(window%serves == i) .or. moved > noticeable*apart .or. &
                     (tip%is_free .neqv. window%made%is_free(i))
      end associate
   end function has_moved

   !> Whether the bounding boxes of a segment and of a window overlap.
   pure logical function overlaps(window, from, to)
      type(window_t), intent(in) :: window
      real(rk), intent(in) :: from(2), to(2)  !< [m]

      overlaps = all(min(from, to) <= window%upper) .and. all(max(from, to) >= window%lower)
   end function overlaps

   !> Windows in the order of their mesh sizes, the largest first, so that threads end at about the
   !! same time.
   pure function by_size(slot) result(order)
      type(slot_t), intent(in) :: slot(:)
      integer(ik) :: order(size(slot))
      integer(ik) :: i, k

      do i = 1, size(slot, kind=ik)
         do k = i, 2, -1
            if (slot(order(k - 1))%window%mesh%n_cells >= slot(i)%window%mesh%n_cells) exit
            order(k) = order(k - 1)
         end do
         order(k) = i
      end do
   end function by_size

end module twolevel_window_slot
