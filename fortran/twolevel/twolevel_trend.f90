!> Rates of change of a state, and the time error of a step.
!!
!! Backward Euler with a step h has the error h**2/2 times the second derivative, which follows from
!! the rate of the step and the rate of the step before, of length h_b: the error of each step is
!! h/(h + h_b) (change - h (rate before)). Its mean over the rock, and over the fractures, is
!! compared with the range of the quantity so far: of the pressure, and likewise of slip and
!! opening. The mean is used because each cell that a tip passes, or where contact changes, has a
!! jump however short the step is.
!!
!! Where tips run through a segment in one step and wait in the next, rates differ from step to step
!! however short the steps are. In a step in which no tip begins a segment the rates of the last
!! such step count too, if they give the smaller error.
module twolevel_trend
   use base_kinds, only: ik, rk
   use coarse_state, only: state_t
   use mesh_types, only: mesh_map_t
   implicit none(type, external)
   private

   public :: rates_t, trend_t

   !> Least range of a quantity, over the range that the loads would cause [-].
   real(rk), parameter :: least = 1.0e-2_rk

   !> Rates of a step of length `dt`.
   type :: rates_t
      real(rk) :: dt = 0.0_rk  !< [s]
      real(rk), allocatable :: rock(:)  !< (cells) rate of the pressure [Pa/s]
      real(rk), allocatable :: fracture(:)  !< (fracture cells) rate of the pressure [Pa/s]
      !> (2, fracture cells) rates of mean opening and slip [m/s]
      real(rk), allocatable :: jump(:, :)
      logical, allocatable :: knows_rock(:), knows_fracture(:)
   end type rates_t

   !> Rates of accepted steps, and ranges of the quantities.
   type :: trend_t
      type(rates_t) :: last  !< of the last step
      !> of the last step in which no tip began a segment, if that is an earlier one
      type(rates_t), allocatable :: quiet
      real(rk) :: pressure(2) = 0.0_rk  !< lowest and highest so far [Pa]
      real(rk) :: jumps(2) = 0.0_rk  !< lowest and highest so far [m]
      real(rk) :: least_pressure = 0.0_rk  !< least range of the pressure [Pa]
      real(rk) :: least_jump = 0.0_rk  !< least range of the jumps [m]
   contains
      procedure :: begin
      procedure :: is_known
      procedure :: pressure_rise
      procedure :: step_error
      procedure :: volume_error
      procedure :: accept
      procedure :: transfer
   end type trend_t

contains

   !> Begin with zero rates in a state of rest, or without known rates.
   subroutine begin(self, state, at_rest, pressure_scale, stiffness, length)
      class(trend_t), intent(out) :: self
      type(state_t), intent(in) :: state
      logical, intent(in) :: at_rest  !< false: the load acts from the first step on
      real(rk), intent(in) :: pressure_scale  !< pressure of the loads [Pa]
      real(rk), intent(in) :: stiffness  !< Young's modulus of the rock [Pa]
      real(rk), intent(in) :: length  !< length of the fractures [m]

      associate (n => size(state%content), m => size(state%pressure))
         associate (last => self%last)
            allocate (last%rock(n), last%fracture(m), last%jump(2, m), source=0.0_rk)
            allocate (last%knows_rock(n), last%knows_fracture(m), source=at_rest)
         end associate
      end associate
      self%least_pressure = least*pressure_scale
      self%least_jump = self%least_pressure*length/stiffness
      self%pressure = [huge(1.0_rk), -huge(1.0_rk)]
      if (at_rest) call see(self, state)
   end subroutine begin

   !> Whether the rates of a previous step are known.
   pure logical function is_known(self)
      class(trend_t), intent(in) :: self

      is_known = self%last%dt > 0.0_rk
   end function is_known

   !> Difference of the highest and the lowest pressure so far [Pa].
   pure real(rk) function pressure_rise(self)
      class(trend_t), intent(in) :: self

      pressure_rise = 0.0_rk
      if (self%pressure(2) > self%pressure(1)) pressure_rise = width(self%pressure)
   end function pressure_rise

   !> Time error of a step from `before` to `after`, relative to the ranges; 0 where no rate is
   !! known [-].
   pure real(rk) function step_error(self, before, after, dt, area, length, has_begun)
      class(trend_t), intent(in) :: self
      type(state_t), intent(in) :: before, after
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: area(:)  !< areas of the cells [m2]
      real(rk), intent(in) :: length(:)  !< lengths of the fracture cells [m]
      logical, intent(in) :: has_begun  !< a tip began a segment in the step
      type(trend_t) :: seen

      seen%pressure = self%pressure
      seen%jumps = self%jumps
      call see(seen, after)
      associate (pressure => max(self%least_pressure, width(seen%pressure)), &
                 jump => max(self%least_jump, width(seen%jumps)))
         step_error = error_by(self%last, before, after, dt, area, length, pressure, jump)
         if (allocated(self%quiet) .and. .not. has_begun) then
            step_error = min(step_error, error_by(self%quiet, before, after, dt, area, length, &
                                                  pressure, jump))
         end if
      end associate
   end function step_error

   !> The same by the rates of one step.
   pure real(rk) function error_by(rates, before, after, dt, area, length, pressure, jump)
      type(rates_t), intent(in) :: rates
      type(state_t), intent(in) :: before, after
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: area(:)  !< areas of the cells [m2]
      real(rk), intent(in) :: length(:)  !< lengths of the fracture cells [m]
      real(rk), intent(in) :: pressure, jump  !< ranges of the pressure [Pa] and the jumps [m]
      real(rk) :: error
      integer(ik) :: n

      n = size(rates%rock, kind=ik)
      error = max(average(after%unknowns(3, :n) - before%unknowns(3, :n) - dt*rates%rock, &
                          area, rates%knows_rock), &
                  average(after%pressure - before%pressure - dt*rates%fracture, &
                          length, rates%knows_fracture))
      error_by = relative(error, pressure)
      error = max(average(mean(after, 1) - mean(before, 1) - dt*rates%jump(1, :), &
                          length, rates%knows_fracture), &
                  average(mean(after, 2) - mean(before, 2) - dt*rates%jump(2, :), &
                          length, rates%knows_fracture))
      error_by = dt/(dt + rates%dt)*max(error_by, relative(error, jump))
   end function error_by

   !> Error of the fluid volume of wells in a step, relative to their volumes since the last switch
   !! [-]: in a step of length h after one of length h_b it is h/(h + h_b) h times the change of the
   !! flow.
   pure real(rk) function volume_error(self, before, after, given, dt, least)
      class(trend_t), intent(in) :: self
      real(rk), intent(in) :: before(:), after(:)  !< (wells) flow [m2/s]
      real(rk), intent(in) :: given(:)  !< (wells) volumes before the step [m2]
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: least  !< least volume of a well [m2]
      real(rk) :: all(size(given)), error(size(given))

      error = dt/(dt + self%last%dt)*dt*abs(after - before)
      all = max(least, given + dt*abs(after))
      volume_error = 0.0_rk
      if (any(all > 0.0_rk)) volume_error = maxval(error/all, mask=all > 0.0_rk)
   end function volume_error

   !> Update rates and ranges after an accepted step.
   pure subroutine accept(self, before, after, dt, has_begun)
      class(trend_t), intent(inout) :: self
      type(state_t), intent(in) :: before, after
      real(rk), intent(in) :: dt  !< [s]
      logical, intent(in) :: has_begun  !< a tip began a segment in the step
      integer(ik) :: n

      if (.not. has_begun) then
         if (allocated(self%quiet)) deallocate (self%quiet)
      else if (.not. allocated(self%quiet) .and. self%last%dt > 0.0_rk) then
         self%quiet = self%last
      end if
      associate (last => self%last)
         n = size(last%rock, kind=ik)
         last%rock = (after%unknowns(3, :n) - before%unknowns(3, :n))/dt
         last%fracture = (after%pressure - before%pressure)/dt
         last%jump(1, :) = (mean(after, 1) - mean(before, 1))/dt
         last%jump(2, :) = (mean(after, 2) - mean(before, 2))/dt
         last%knows_rock = .true.
         last%knows_fracture = .true.
         last%dt = dt
      end associate
      call see(self, after)
   end subroutine accept

   !> Transfer the rates to a new mesh; those of its new cells are not known.
   pure subroutine transfer(self, map)
      class(trend_t), intent(inout) :: self
      type(mesh_map_t), intent(in) :: map

      call transfer_rates(self%last, map)
      if (allocated(self%quiet)) call transfer_rates(self%quiet, map)
   end subroutine transfer

   !> The same for the rates of one step.
   pure subroutine transfer_rates(rates, map)
      type(rates_t), intent(inout) :: rates
      type(mesh_map_t), intent(in) :: map
      integer(ik) :: i

      associate (old => map%cell_old)
         rates%knows_rock = [(old(i) > 0, i=1, size(old, kind=ik))]
         rates%rock = [(merge(rates%rock(max(1_ik, old(i))), 0.0_rk, old(i) > 0), &
                        i=1, size(old, kind=ik))]
      end associate
      associate (old => map%fracture_cell_old)
         rates%knows_fracture = [(old(i) > 0, i=1, size(old, kind=ik))]
         rates%fracture = [(merge(rates%fracture(max(1_ik, old(i))), 0.0_rk, old(i) > 0), &
                            i=1, size(old, kind=ik))]
         rates%jump = reshape([(merge(rates%jump(:, max(1_ik, old(i))), 0.0_rk, old(i) > 0), &
                                i=1, size(old, kind=ik))], [2, size(old)])
      end associate
   end subroutine transfer_rates

   !> Extend the ranges by the values of a state.
   pure subroutine see(self, state)
      class(trend_t), intent(inout) :: self
      type(state_t), intent(in) :: state

      associate (rock => state%unknowns(3, :size(state%content)))
         self%pressure(1) = min(self%pressure(1), minval(rock), minval(state%pressure))
         self%pressure(2) = max(self%pressure(2), maxval(rock), maxval(state%pressure))
      end associate
      self%jumps(1) = min(self%jumps(1), minval(state%jump))
      self%jumps(2) = max(self%jumps(2), maxval(state%jump))
   end subroutine see

   !> Opening (1) or slip (2) of the fracture cells: means of their ends [m].
   pure function mean(state, component)
      type(state_t), intent(in) :: state
      integer, intent(in) :: component
      real(rk) :: mean(size(state%pressure))

      mean = 0.5_rk*sum(state%jump(component, :, :), dim=1)
   end function mean

   pure real(rk) function width(bounds)
      real(rk), intent(in) :: bounds(2)

      width = bounds(2) - bounds(1)
   end function width

   !> Mean magnitude of the values that count; 0 if none does.
   pure real(rk) function average(values, weight, counts)
      real(rk), intent(in) :: values(:), weight(:)
      logical, intent(in) :: counts(:)

      average = 0.0_rk
      if (any(counts)) average = sum(weight*abs(values), mask=counts)/sum(weight, mask=counts)
   end function average

   !> Error relative to a scale; 0 if both are zero.
   pure real(rk) function relative(error, scale)
      real(rk), intent(in) :: error, scale

      relative = 0.0_rk
      if (error > 0.0_rk) relative = error/max(scale, tiny(1.0_rk))
   end function relative

end module twolevel_trend
