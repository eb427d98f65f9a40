!> Accumulated time-step error of a scalar: the errors of the steps (twolevel_trend) add up with
!! their signs.
module twolevel_course
   use base_kinds, only: rk
   implicit none(type, external)
   private

   public :: course_t

   !> The last value, and how it changes.
   type :: course_t
      logical :: is_followed = .false.  !< there is a last value
      real(rk) :: value = 0.0_rk
      real(rk) :: rate = 0.0_rk  !< in the last step [1/s]
      real(rk) :: error = 0.0_rk  !< of all steps together, with its sign
      real(rk) :: step = 0.0_rk  !< the last one [s]
   contains
      procedure :: follow
   end type course_t

contains

   !> A step h after one of length h_b errs by h/(h + h_b) (change - h (rate before)); the first one
   !! has none to compare with. With a step of 0 the value is that of a new start.
   elemental subroutine follow(self, step, value)
      class(course_t), intent(inout) :: self
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

end module twolevel_course
