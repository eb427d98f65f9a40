!> Rates of change of a state, and the time error of a step.
!!
!! Backward Euler with a step h has the error h**2/2 times the second derivative, which follows from
!! the rate of the step and the rate of the step before, of length h_b: the error of each step is
!! h/(h + h_b) (change - h (rate before)). Its mean over the rock, and over the fractures, is
!! compared with the range of the quantity so far: of the pressure, and likewise of slip and
!! opening. The mean is used because each cell that a tip passes, or where contact changes, has a
!! jump however short the step is.
module twolevel_trend
   use base_kinds, only: ik, rk
   use coarse_state, only: state_t
   use mesh_types, only: mesh_map_t
   implicit none(type, external)
   private

   public :: trend_t

   !> Least range of a quantity, over the range that the loads would cause [-].
   real(rk), parameter :: least = 1.0e-2_rk

   !> Rates of the last accepted step, and ranges of the quantities.
   type :: trend_t
      real(rk) :: dt = 0.0_rk  !< length of that step [s]
      real(rk), allocatable :: rock(:)  !< (cells) rate of the pressure [Pa/s]
      real(rk), allocatable :: fracture(:)  !< (fracture cells) rate of the pressure [Pa/s]
      !> (2, fracture cells) rates of mean opening and slip [m/s]
      real(rk), allocatable :: jump(:, :)
      logical, allocatable :: knows_rock(:), knows_fracture(:)
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
         allocate (self%rock(n), self%fracture(m), self%jump(2, m), source=0.0_rk)
         allocate (self%knows_rock(n), self%knows_fracture(m), source=at_rest)
      end associate
      self%least_pressure = least*pressure_scale
      self%least_jump = self%least_pressure*length/stiffness
      self%pressure = [huge(1.0_rk), -huge(1.0_rk)]
      if (at_rest) call see(self, state)
   end subroutine begin

   !> Whether the rates of a previous step are known.
   pure logical function is_known(self)
      class(trend_t), intent(in) :: self

      is_known = self%dt > 0.0_rk
   end function is_known

   !> Difference of the highest and the lowest pressure so far [Pa].
   pure real(rk) function pressure_rise(self)
      class(trend_t), intent(in) :: self

      pressure_rise = 0.0_rk
      if (self%pressure(2) > self%pressure(1)) pressure_rise = width(self%pressure)
   end function pressure_rise

   !> Time error of a step from `before` to `after`, relative to the ranges; 0 where no rate is
   !! known [-].
   pure real(rk) function step_error(self, before, after, dt, area, length) result(error)
      class(trend_t), intent(in) :: self
      type(state_t), intent(in) :: before, after
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: area(:)  !< areas of the cells [m2]
      real(rk), intent(in) :: length(:)  !< lengths of the fracture cells [m]
      type(trend_t) :: seen
      real(rk) :: of_jumps, of_pressure
      integer(ik) :: n

      seen%pressure = self%pressure
      seen%jumps = self%jumps
      call see(seen, after)
      n = size(self%rock, kind=ik)
      of_pressure = max(average(after%unknowns(3, :n) - before%unknowns(3, :n) - dt*self%rock, &
                                area, self%knows_rock), &
                        average(after%pressure - before%pressure - dt*self%fracture, &
                                length, self%knows_fracture))
      of_jumps = max(average(mean(after, 1) - mean(before, 1) - dt*self%jump(1, :), &
                             length, self%knows_fracture), &
                     average(mean(after, 2) - mean(before, 2) - dt*self%jump(2, :), &
                             length, self%knows_fracture))
      error = dt/(dt + self%dt) &
              *max(relative(of_pressure, max(self%least_pressure, width(seen%pressure))), &
                   relative(of_jumps, max(self%least_jump, width(seen%jumps))))
   end function step_error

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

      error = dt/(dt + self%dt)*dt*abs(after - before)
      all = max(least, given + dt*abs(after))
      volume_error = 0.0_rk
      if (any(all > 0.0_rk)) volume_error = maxval(error/all, mask=all > 0.0_rk)
   end function volume_error

   !> Update rates and ranges after an accepted step.
   pure subroutine accept(self, before, after, dt)
      class(trend_t), intent(inout) :: self
      type(state_t), intent(in) :: before, after
      real(rk), intent(in) :: dt  !< [s]
      integer(ik) :: n

      n = size(self%rock, kind=ik)
      self%rock = (after%unknowns(3, :n) - before%unknowns(3, :n))/dt
      self%fracture = (after%pressure - before%pressure)/dt
      self%jump(1, :) = (mean(after, 1) - mean(before, 1))/dt
      self%jump(2, :) = (mean(after, 2) - mean(before, 2))/dt
      self%knows_rock = .true.
      self%knows_fracture = .true.
      self%dt = dt
      call see(self, after)
   end subroutine accept

   !> Transfer the rates to a new mesh; those of its new cells are not known.
   pure subroutine transfer(self, map)
      class(trend_t), intent(inout) :: self
      type(mesh_map_t), intent(in) :: map
      integer(ik) :: i

      associate (old => map%cell_old)
         self%knows_rock = [(old(i) > 0, i=1, size(old, kind=ik))]
         self%rock = [(merge(self%rock(max(1_ik, old(i))), 0.0_rk, old(i) > 0), &
                       i=1, size(old, kind=ik))]
      end associate
      associate (old => map%fracture_cell_old)
         self%knows_fracture = [(old(i) > 0, i=1, size(old, kind=ik))]
         self%fracture = [(merge(self%fracture(max(1_ik, old(i))), 0.0_rk, old(i) > 0), &
                           i=1, size(old, kind=ik))]
         self%jump = reshape([(merge(self%jump(:, max(1_ik, old(i))), 0.0_rk, old(i) > 0), &
                               i=1, size(old, kind=ik))], [2, size(old)])
      end associate
   end subroutine transfer

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
