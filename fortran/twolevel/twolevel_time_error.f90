!> Accumulated time-step error of a scalar: the errors of the steps (twolevel_trend) add up with
!! their signs.
module twolevel_time_error
   use base_kinds, only: rk
   implicit none(type, external)
   private

   public :: accumulated_error_t

   !> Last value of the scalar, its rate, and the accumulated error.
   type :: accumulated_error_t
      logical :: is_followed = .false.  !< a last value exists
      real(rk) :: value = 0.0_rk
      real(rk) :: rate = 0.0_rk  !< rate in the last step [1/s]
      real(rk) :: error = 0.0_rk  !< accumulated error of all steps, with its sign
      real(rk) :: step = 0.0_rk  !< length of the last step [s]
   contains
      procedure :: follow
   end type accumulated_error_t

contains

   !> Add the error of a step. A step h after one of length h_b has the error h/(h + h_b) (change -
   !! h (rate before)); the first step has no error estimate. A step of length 0 sets the value at a
   !! new start.
   elemental subroutine follow(self, step, value)
      class(accumulated_error_t), intent(inout) :: self
      real(rk), intent(in) :: step  !< [s]
      real(rk), intent(in) :: value

      if (self%is_followed .and. step > 0.0_rk) then
         if (self%step > 0.0_rk) then
            self%error = self%error + step/(step + self%step) &
                         *(value - self%value - step*self%rate)
         end if
         self%rate = (value - self%value)/step
         self%step = step
      end if
      self%is_followed = .true.
      self%value = value
   end subroutine follow

end module twolevel_time_error
