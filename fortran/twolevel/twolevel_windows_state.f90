!> The state of windows, independent of their meshes: contact on their fractures, and properties of
!! their tips.
module twolevel_windows_state
   use base_kinds, only: ik
   use fine_contact, only: contact_t
   use fine_mesh, only: fine_mesh_t
   use twolevel_window_tip, only: window_tip_t
   implicit none(type, external)
   private

   public :: window_history_t, windows_state_t

   !> Contact in the last solution of a window; its slip is the history of the next solution.
   type :: window_history_t
      type(contact_t), allocatable :: contact
      !> mesh of the contact, where it is not that of the window
      type(fine_mesh_t), allocatable :: mesh
   contains
      procedure :: leave_mesh
   end type window_history_t

   !> State of several windows.
   type :: windows_state_t
      type(window_tip_t), allocatable :: tip(:)  !< (tips)
      type(window_history_t), allocatable :: history(:)  !< (windows)
   contains
      procedure :: accept
   end type windows_state_t

contains

   !> Keep this mesh for the contact: the window gets another mesh.
   pure subroutine leave_mesh(self, mesh)
      class(window_history_t), intent(inout) :: self
      type(fine_mesh_t), intent(in) :: mesh

      if (allocated(self%contact) .and. .not. allocated(self%mesh)) self%mesh = mesh
   end subroutine leave_mesh

   !> Accept the state that was evaluated last: its slip is the history of the next solution.
   pure subroutine accept(self)
      class(windows_state_t), intent(inout) :: self
      integer(ik) :: w

      if (.not. allocated(self%history)) return
      do w = 1, size(self%history, kind=ik)
         if (allocated(self%history(w)%contact)) call self%history(w)%contact%accept()
      end do
   end subroutine accept

end module twolevel_windows_state
