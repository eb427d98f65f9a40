!> Errors in time of published quantities, from their values after each step.
!!
!! A step of length h after one of length h_b has the error h/(h + h_b) |change - h (rate before)|
!! (twolevel_trend). In the first step after a switch the rate jumps, and the error is that of
!! backward Euler for a diffusing quantity, 13 % of the change beyond the rate before.
!!
!! An error in time shifts the quantity in time: later it changes by what the rate has changed. So
!! an accumulated error falls with the rate, at most by half in a step, since a rate may vanish at a
!! maximum. Errors are added without their signs.
module twolevel_followed
   use base_kinds, only: rk
   implicit none(type, external)
   private

   public :: followed_t

   real(rk), parameter :: after_switch = 0.13_rk  !< least weight of the error of a step [-]
   real(rk), parameter :: forget = 0.5_rk  !< least factor on the largest rate per step [-]

   !> Quantities, each in its unit.
   type :: followed_t
      real(rk) :: time = 0.0_rk  !< of the last values [s]
      real(rk) :: step = 0.0_rk  !< length of the last step; 0: no rate is known [s]
      real(rk), allocatable :: first(:)  !< values at the start
      real(rk), allocatable :: value(:)  !< last values
      real(rk), allocatable :: rate(:)  !< rates in the last step [1/s]
      real(rk), allocatable :: largest(:)  !< decaying largest magnitudes of the rates [1/s]
      real(rk), allocatable :: of_step(:)  !< errors of the last step
      real(rk), allocatable :: error(:)  !< accumulated errors
   contains
      procedure :: begin
      procedure :: follow
   end type followed_t

contains

   !> Begin with the values before the first step.
   subroutine begin(self, time, values)
      class(followed_t), intent(out) :: self
      real(rk), intent(in) :: time  !< [s]
      real(rk), intent(in) :: values(:)

      self%time = time
      self%first = values
      self%value = values
      allocate (self%rate(size(values)), self%largest(size(values)), self%of_step(size(values)), &
                self%error(size(values)), source=0.0_rk)
   end subroutine begin

   !> Add the error of a step to the given values. A jump has no rate, and no error in time.
   subroutine follow(self, time, values, is_jump)
      class(followed_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< after the step [s]
      real(rk), intent(in) :: values(:)
      logical, intent(in) :: is_jump  !< the step consists of unstable growth
      real(rk) :: rate(size(values)), step

      if (.not. allocated(self%value)) call self%begin(time, values)
      step = time - self%time
      if (.not. step > 0.0_rk) return
      self%time = time
      rate = (values - self%value)/step
      self%value = values
      self%of_step = 0.0_rk
      if (is_jump) return
      self%of_step = max(step/(step + self%step), after_switch)*step*abs(rate - self%rate)
      if (.not. self%step > 0.0_rk) self%of_step = after_switch*step*abs(rate)
      associate (largest => max(abs(rate), forget*self%largest))
         where (self%largest > 0.0_rk) self%error = self%error*min(1.0_rk, largest/self%largest)
         self%largest = largest
      end associate
      self%error = self%error + self%of_step
      self%rate = rate
      self%step = step
   end subroutine follow

end module twolevel_followed
