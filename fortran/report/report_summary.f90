!> What a run was, in numbers and words: what run.json holds but how it ended and what it cost.
module report_summary
   use base_kinds, only: ik, lk, rk
   use base_texts, only: add_once, text_t
   implicit none(type, external)
   private

   public :: dof_block_t, summary_t

   !> Unknowns of one kind.
   type :: dof_block_t
      character(len=:), allocatable :: name
      integer(lk) :: n = 0_lk
   end type dof_block_t

   !> Sums, largest values and words of a run so far.
   type :: summary_t
      integer(ik) :: steps = 0  !< accepted time steps
      integer(ik) :: cells = 0  !< matrix cells at the end
      integer(ik) :: fracture_cells = 0  !< at the end
      real(rk) :: mass_error_relative = 0.0_rk  !< largest of all steps [-]
      real(rk) :: keq_over_kic = 0.0_rk  !< largest of all tips and states; 0: left out [-]
      real(rk) :: lowest_pressure = huge(1.0_rk)  !< of the fluid; huge: left out [Pa]
      real(rk) :: contact_residual = 0.0_rk  !< largest of all accepted steps, relative [-]
      real(rk) :: condition_estimate = 0.0_rk  !< largest of the Newton matrices; 0: left out [-]
      !> of their solutions, relative; with the one above [-]
      real(rk) :: forward_error_bound = 0.0_rk
      real(rk) :: smallest_angle = 0.0_rk  !< of all meshes; 0: left out [rad]
      real(rk) :: energy_error = 0.0_rk  !< estimate on the last mesh, relative; 0: left out [-]
      integer(ik) :: newton_total = 0  !< iterations
      integer(ik) :: newton_max = 0  !< iterations in one step
      integer(ik) :: step_cuts = 0
      logical :: has_growth = .false.  !< the three below are known
      integer(ik) :: increments = 0  !< of growth, of any number of tips at once
      integer(ik) :: meshes_whole = 0  !< made of the whole body
      integer(ik) :: meshes_patched = 0  !< made anew around growing tips only
      type(dof_block_t), allocatable :: dofs(:)
      type(text_t), allocatable :: used(:)
      type(text_t), allocatable :: left_out(:)
      type(text_t), allocatable :: warnings(:)
   contains
      procedure :: count_dofs
      procedure :: use_feature
      procedure :: leave_out_feature
      procedure :: use_after_all
      procedure :: note => note_feature
      procedure :: warn
      procedure :: add_newton
   end type summary_t

contains

   !> Set the number of unknowns of a block, e.g. "displacement"; a later count replaces an earlier
   !! one.
   subroutine count_dofs(self, block_name, n)
      class(summary_t), intent(inout) :: self
      character(len=*), intent(in) :: block_name
      integer, intent(in) :: n
      type(dof_block_t), allocatable :: longer(:)
      integer :: i

      if (.not. allocated(self%dofs)) allocate (self%dofs(0))
      do i = 1, size(self%dofs)
         if (self%dofs(i)%name == block_name) then
            self%dofs(i)%n = int(n, lk)
            return
         end if
      end do
      allocate (longer(size(self%dofs) + 1))
      longer(1:size(self%dofs)) = self%dofs
      longer(size(longer))%name = block_name
      longer(size(longer))%n = int(n, lk)
      call move_alloc(longer, self%dofs)
   end subroutine count_dofs

   !> Add the iterations of an accepted step.
   pure subroutine add_newton(self, iterations)
      class(summary_t), intent(inout) :: self
      integer(ik), intent(in) :: iterations

      self%newton_total = self%newton_total + iterations
      self%newton_max = max(self%newton_max, iterations)
   end subroutine add_newton

   !> Note a feature that the run uses.
   subroutine use_feature(self, feature)
      class(summary_t), intent(inout) :: self
      character(len=*), intent(in) :: feature

      call add_once(self%used, feature)
   end subroutine use_feature

   !> Note a feature that the run leaves out.
   subroutine leave_out_feature(self, feature)
      class(summary_t), intent(inout) :: self
      character(len=*), intent(in) :: feature

      call add_once(self%left_out, feature)
   end subroutine leave_out_feature

   !> Note a feature that the run uses from now on, and has left out so far.
   subroutine use_after_all(self, feature, left_out)
      class(summary_t), intent(inout) :: self
      character(len=*), intent(in) :: feature
      character(len=*), intent(in) :: left_out  !< in words, as it was noted to be left out
      type(text_t), allocatable :: kept(:)
      integer :: i

      call self%use_feature(feature)
      if (.not. allocated(self%left_out)) return
      allocate (kept(0))
      do i = 1, size(self%left_out)
         if (self%left_out(i)%text /= left_out) kept = [kept, self%left_out(i)]
      end do
      call move_alloc(kept, self%left_out)
   end subroutine use_after_all

   !> Note a feature that the run uses or else leaves out.
   subroutine note_feature(self, is_used, used, left_out)
      class(summary_t), intent(inout) :: self
      logical, intent(in) :: is_used
      character(len=*), intent(in) :: used  !< in words, if it is used
      character(len=*), intent(in) :: left_out  !< and if it is not

      if (is_used) then
         call self%use_feature(used)
      else
         call self%leave_out_feature(left_out)
      end if
   end subroutine note_feature

   !> Note a warning; the same words are kept once.
   subroutine warn(self, warning)
      class(summary_t), intent(inout) :: self
      character(len=*), intent(in) :: warning

      call add_once(self%warnings, warning)
   end subroutine warn

end module report_summary
