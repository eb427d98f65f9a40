!> The length of time steps: cut where a step does not converge, short after growth until the
!! pressure at the new tips has settled, and back by doubling.
module twolevel_stepping
   use base_kinds, only: rk
   use base_tolerances, only: same_value
   use scene_types, only: time_t
   implicit none(type, external)
   private

   public :: stepper_t

   !> relative change of pressure at new tips in a short step
   real(rk), parameter :: settled = 0.01_rk

   !> What decides about the next step.
   type :: stepper_t
      real(rk) :: next = 0.0_rk  !< to try [s]
      logical :: is_short = .false.  !< after growth, until the pressure at the new tips has settled
      real(rk), allocatable :: pressure(:)  !< of the new cells after the last short step [Pa]
   contains
      procedure :: step_to
      procedure :: cut
      procedure :: step_done
      procedure :: network_grew
      procedure :: follow_growth
   end type stepper_t

contains

   !> The step to try, so that none straddles a switch of the wells.
   pure real(rk) function step_to(self, left)
      class(stepper_t), intent(in) :: self
      real(rk), intent(in) :: left  !< time to the next switch [s]

      step_to = min(self%next, left)
      ! No tiny step before a switch, and no more step sizes, thus factorizations, than needed.
      if (left < step_to*(1.0_rk + same_value)) step_to = left
   end function step_to

   !> A step has not converged: try half of it, unless that is too short.
   pure subroutine cut(self, time, dt, is_too_short)
      class(stepper_t), intent(inout) :: self
      type(time_t), intent(in) :: time
      real(rk), intent(inout) :: dt  !< [s]
      logical, intent(out) :: is_too_short

      dt = 0.5_rk*dt
      is_too_short = dt < time%smallest_factor*time%step
      self%next = dt
   end subroutine cut

   !> A step has been accepted.
   pure subroutine step_done(self, time, pressure)
      class(stepper_t), intent(inout) :: self
      type(time_t), intent(in) :: time
      real(rk), intent(in) :: pressure(:)  !< of the cells that the last growth has added [Pa]

      if (.not. self%is_short) then
         self%next = min(2.0_rk*self%next, time%step)
         return
      end if
      if (allocated(self%pressure)) then
         if (size(pressure) == size(self%pressure)) self%is_short = &
            maxval(abs(pressure - self%pressure)) > settled*maxval(abs(pressure))
      end if
      self%pressure = pressure
      self%next = merge(time%share_after_growth*time%step, time%step, self%is_short)
   end subroutine step_done

   !> A step has been accepted in which a tip has advanced by a share of its segment: shorter or
   !! longer steps, so that it is about a half. Steps differ by factors of two: each size costs a
   !! factorization.
   pure subroutine follow_growth(self, time, share)
      class(stepper_t), intent(inout) :: self
      type(time_t), intent(in) :: time
      real(rk), intent(in) :: share  !< [-]
      real(rk), parameter :: most = 0.75_rk, least = 0.35_rk

      if (share > most) then
         self%next = 0.5_rk*self%next
      else if (share < least) then
         self%next = min(2.0_rk*self%next, time%step)
      end if
   end subroutine follow_growth

   !> Growth has added fracture cells.
   pure subroutine network_grew(self, time)
      class(stepper_t), intent(inout) :: self
      type(time_t), intent(in) :: time

      self%is_short = .true.
      self%next = time%share_after_growth*time%step
      if (allocated(self%pressure)) deallocate (self%pressure)
   end subroutine network_grew

end module twolevel_stepping
