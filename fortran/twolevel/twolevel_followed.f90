!> Errors in time of published quantities, from their values after each step.
!!
!! Backward Euler multiplies a mode that decays with exp(-l t) by exp(-l t + l**2 sum h**2/2) in
!! steps of length h: a quantity has the error sum h**2/2 times its second derivative, of all steps
!! since the load changed. The second derivative follows from the rates of the last two steps, of
!! lengths h and h_b: h/(h + h_b) |change - h (rate before)| is h**2/2 times it (twolevel_trend).
!! This is compared with the sum of these errors of the steps, which holds where the response is
!! not that of a linear system (contact). An error in time shifts a quantity in time, so that the
!! sum falls with the rate; at most by half in a step, since a rate may vanish at a maximum. Errors
!! are added without their signs.
!!
!! In the first step after a switch the rate jumps, and the error is that of backward Euler for a
!! diffusing quantity, 13 % of the change beyond the rate before; none where nothing diffuses. In
!! the second step the rate of the first one is a poor measure of the second derivative of such a
!! quantity: four times too large or more (exact for sqrt(t): 5 with equal steps).
module twolevel_followed
   use base_kinds, only: rk
   implicit none(type, external)
   private

   public :: followed_t, followed_step_t

   real(rk), parameter :: after_switch = 0.13_rk  !< least weight of the error of a step [-]
   real(rk), parameter :: in_second = 0.75_rk  !< by which that of the second is less [-]
   real(rk), parameter :: forget = 0.5_rk  !< least factor of rates and errors per step [-]

   !> A step.
   type :: followed_step_t
      real(rk) :: time = 0.0_rk  !< after it [s]
      logical :: is_jump = .false.  !< it consists of unstable growth, and has no rate
      logical :: is_growing = .false.  !< tips have grown in it, in equilibrium
      logical :: is_first = .false.  !< wells or sides were switched at its start
      real(rk) :: diffusing = 1.0_rk  !< share of the fluid that diffuses [-]
      real(rk) :: left = 1.0_rk  !< of the error of a step where chains divide it [-]
   end type followed_step_t

   !> Quantities, each in its unit.
   type :: followed_t
      real(rk) :: time = 0.0_rk  !< of the last values [s]
      real(rk) :: step = 0.0_rk  !< length of the last step; 0: no rate is known [s]
      integer :: n_steps = 0  !< steps since the switch
      real(rk) :: squares = 0.0_rk  !< sum of the squares of the steps since the switch [s2]
      real(rk), allocatable :: first(:)  !< values at the start
      !> values at the last switch, and the sum of the changes between switches up to then
      real(rk), allocatable :: turn(:), varied(:)
      real(rk), allocatable :: value(:)  !< last values
      real(rk), allocatable :: rate(:)  !< rates in the last step [1/s]
      real(rk), allocatable :: largest(:)  !< decaying largest magnitudes of the rates [1/s]
      real(rk), allocatable :: of_step(:)  !< errors of the last step
      real(rk), allocatable :: sum(:), linear(:)  !< the two estimates
      real(rk), allocatable :: error(:)  !< the larger of them
   contains
      procedure :: begin
      procedure :: add
      procedure :: follow
      procedure :: changes
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
      self%turn = values
      self%varied = 0.0_rk*values
      associate (n => size(values))
         allocate (self%rate(n), self%largest(n), self%of_step(n), source=0.0_rk)
         allocate (self%sum(n), self%linear(n), self%error(n), source=0.0_rk)
      end associate
   end subroutine begin

   !> Go on with more quantities, which begin now.
   subroutine add(self, is_old, values)
      class(followed_t), intent(inout) :: self
      logical, intent(in) :: is_old(:)  !< (quantities from now on) followed so far
      real(rk), intent(in) :: values(:)  !< of the others now
      type(followed_t) :: new

      call new%begin(self%time, values)
      self%first = unpack(self%first, is_old, new%first)
      self%turn = unpack(self%turn, is_old, new%turn)
      self%varied = unpack(self%varied, is_old, new%varied)
      self%value = unpack(self%value, is_old, new%value)
      self%rate = unpack(self%rate, is_old, new%rate)
      self%largest = unpack(self%largest, is_old, new%largest)
      self%of_step = unpack(self%of_step, is_old, new%of_step)
      self%sum = unpack(self%sum, is_old, new%sum)
      self%linear = unpack(self%linear, is_old, new%linear)
      self%error = unpack(self%error, is_old, new%error)
   end subroutine add

   !> Add the error of a step to the given values.
   subroutine follow(self, step, values)
      class(followed_t), intent(inout) :: self
      type(followed_step_t), intent(in) :: step
      real(rk), intent(in) :: values(:)
      real(rk) :: change(size(values)), rate(size(values))

      if (.not. allocated(self%value)) call self%begin(step%time, values)
      associate (dt => step%time - self%time)
         if (.not. dt > 0.0_rk) return
         rate = (values - self%value)/dt
         change = dt*abs(rate - self%rate)
         if (step%is_first) then
            self%varied = self%changes()
            self%turn = self%value
         end if
         self%value = values
         self%of_step = 0.0_rk
         if (step%is_first) then
            self%squares = 0.0_rk
            self%n_steps = 0
         end if
         if (.not. step%is_jump) then
            self%squares = self%squares + dt**2
            self%n_steps = self%n_steps + 1
            if (self%n_steps == 1) then
               self%of_step = after_switch*step%diffusing*change
            else if (self%step > 0.0_rk) then
               self%of_step = dt/(dt + self%step)*change
               if (self%n_steps == 2) self%of_step = self%of_step*(1.0_rk &
                                                                   - in_second*step%diffusing)
            end if
            self%of_step = step%left*self%of_step
            self%linear = forget*self%linear
            ! Growth changes rates at once; and where steps become short the rates say little about
            ! the time before.
            if (.not. step%is_growing) then
               self%linear = max(self%linear, min(self%squares/dt**2, real(self%n_steps, rk)) &
                                 *self%of_step)
            end if
            associate (largest => max(abs(rate), forget*self%largest))
               where (self%largest > 0.0_rk)
                  self%sum = self%sum*min(1.0_rk, largest/self%largest)
               end where
               self%largest = largest
            end associate
            self%sum = self%sum + self%of_step
            self%error = max(self%sum, self%linear)
            self%rate = rate
            self%step = dt
         end if
         self%time = step%time
      end associate
   end subroutine follow

   !> Sum of the magnitudes of the changes between switches: each stage adds a response, of which
   !! errors in space are a share.
   pure function changes(self)
      class(followed_t), intent(in) :: self
      real(rk) :: changes(size(self%value))

      changes = self%varied + abs(self%value - self%turn)
   end function changes

end module twolevel_followed
