!> Where the iteration of a time step begins: from the state before, all unknowns going on as they
!! did in the last step that was solved. That is the step before, or a try of the same step with
!! other tips or another length.
!!
!! A point that slips lies on the bound of friction when a step begins, and rounding would decide
!! whether it goes on: with a guess it does.
module coarse_guess
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: guess_t

   real(rk), parameter :: farthest = 4.0_rk  !< that is gone on, over the last step's length [-]

   !> What is remembered of the last solution.
   type :: guess_t
      real(rk) :: dt = 0.0_rk  !< [s]
      real(rk), allocatable :: change(:)  !< of the unknowns in that time [Pa]
   contains
      procedure :: forget
      procedure :: remember
      procedure :: is_known
      procedure :: from
   end type guess_t

contains

   !> The unknowns are others now.
   pure subroutine forget(self)
      class(guess_t), intent(inout) :: self

      if (allocated(self%change)) deallocate (self%change)
   end subroutine forget

   !> A step has been solved.
   pure subroutine remember(self, dt, start, x)
      class(guess_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: start(:), x(:)  !< unknowns before and after it [Pa]

      self%dt = dt
      self%change = x - start
   end subroutine remember

   !> There is a solution to go on from.
   pure logical function is_known(self, n)
      class(guess_t), intent(in) :: self
      integer(ik), intent(in) :: n  !< unknowns

      is_known = allocated(self%change)
      if (is_known) is_known = size(self%change) == n
   end function is_known

   !> The unknowns after a step from those before it.
   pure function from(self, start, dt) result(x)
      class(guess_t), intent(in) :: self
      real(rk), intent(in) :: start(:)  !< [Pa]
      real(rk), intent(in) :: dt  !< [s]
      real(rk) :: x(size(start))  !< [Pa]

      x = start + min(dt/self%dt, farthest)*self%change
   end function from

end module coarse_guess
