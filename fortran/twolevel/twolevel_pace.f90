!> The time of a state of a replayed run. Tips are where they were in the recorded run, and the
!! length of the step is found so that K_eq/K_IC of the tips that decide about it is the recorded
!! one: those that join a target in the step, else those that advance, by the length of their
!! advances, else the one with the largest K_eq/K_IC, where this rises in the step. Other steps,
!! jumps among them, are as long as those of the record, in proportion to the time since the wells
!! were switched.
module twolevel_pace
   use base_archive, only: archive_t
   use base_kinds, only: pi, rk
   use base_number, only: brief_text
   use base_tape, only: tape_t
   implicit none(type, external)
   private

   public :: pace_t

   type :: pace_t
      real(rk) :: recorded = 0.0_rk  !< length of the recorded step [s]
      real(rk) :: recorded_end = 0.0_rk  !< and its end [s]
      real(rk) :: since = 0.0_rk  !< time since the last switch at the start of the step [s]
      real(rk) :: recorded_since = 0.0_rk  !< the same in the record [s]
      logical :: is_bound = .false.  !< the tips decide about the length of the step
      logical :: has_joined = .false.
      !> mean difference of K_eq/K_IC from the record [-]
      real(rk) :: misfit = 0.0_rk
      character(len=:), allocatable :: why_not  !< reason why the record does not apply
      integer :: tries = 0
      real(rk) :: rise = 0.2_rk  !< d misfit/d ln t in the last step [-]
      real(rk) :: last_dt = 0.0_rk, last_misfit = 0.0_rk  !< of the try before [s], [-]
   contains
      procedure :: visit
      procedure :: begin_try
      procedure :: see_joints
      procedure :: see_end
      procedure :: improve
   end type pace_t

   !> Largest differences from the record: of K_eq/K_IC [-], and of the direction ahead [rad].
   real(rk), parameter :: far = 0.1_rk, aside = 5.0_rk*pi/180.0_rk

   !> Least K_eq/K_IC of the largest one, and its least rise per relative time, for which a tip that
   !! does not advance decides about the length of a step [-].
   real(rk), parameter :: least_load = 0.1_rk, least_rise = 0.02_rk

   !> Relative change of the time at which the search ends [-].
   real(rk), parameter :: same_time = 1.0e-10_rk

   !> Misfit that is rounding, and the one at which a search that does not improve ends [-].
   real(rk), parameter :: rounding = 1.0e-14_rk, small = 1.0e-7_rk

contains

   !> What is known from earlier steps.
   subroutine visit(self, archive)
      class(pace_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive

      call archive%item("rise", self%rise)
   end subroutine visit

   subroutine begin_try(self)
      class(pace_t), intent(inout) :: self

      self%is_bound = .false.
      self%has_joined = .false.
      self%misfit = 0.0_rk
      if (allocated(self%why_not)) deallocate (self%why_not)
   end subroutine begin_try

   !> Tips join their targets.
   subroutine see_joints(self, tape, excess, joins)
      class(pace_t), intent(inout) :: self
      type(tape_t), intent(inout) :: tape
      real(rk), intent(in) :: excess(:)  !< (tips) K_eq/K_IC - 1 [-]
      logical, intent(in) :: joins(:)  !< (tips)
      real(rk), dimension(size(excess)) :: recorded, present

      present = excess
      call tape%compare("at_joint", present, recorded)
      if (self%has_joined) return
      self%has_joined = .true.
      self%is_bound = .true.
      self%misfit = sum(excess - recorded, mask=joins)/real(count(joins), rk)
   end subroutine see_joints

   !> The end of a step.
   subroutine see_end(self, tape, excess, before, angle, advance, counts, jumps)
      class(pace_t), intent(inout) :: self
      type(tape_t), intent(inout) :: tape
      real(rk), intent(in) :: excess(:), before(:)  !< (tips) K_eq/K_IC - 1, now and before [-]
      real(rk), intent(in) :: angle(:)  !< (tips) kink angle of the criterion [rad]
      real(rk), intent(in) :: advance(:)  !< (tips) [m]
      logical, intent(in) :: counts(:)  !< (tips) the tip is loaded
      logical, intent(in) :: jumps  !< tips grow without equilibrium
      real(rk), dimension(size(excess)) :: recorded, recorded_angle, recorded_before, values
      logical :: goes_on(size(excess))
      integer :: k

      values = excess
      call tape%compare("excess", values, recorded)
      values = before
      call tape%compare("before", values, recorded_before)
      values = angle
      call tape%compare("angle", values, recorded_angle)
      if (size(excess) == 0) return
      goes_on = counts .and. advance > 0.0_rk
      if (any(counts .and. max(excess, recorded) > -far .and. abs(excess - recorded) > far)) then
         self%why_not = "K_eq/K_IC differs from the record by "//brief_text(maxval( &
                         abs(excess - recorded), mask=counts .and. max(excess, recorded) > -far), 3)
      else if (any(goes_on .and. abs(angle - recorded_angle) > aside)) then
         self%why_not = "the direction of a tip differs from the record by "//brief_text(maxval( &
                              abs(angle - recorded_angle), mask=goes_on)*180.0_rk/pi, 3)//" degrees"
      end if
      if (self%has_joined .or. jumps) return
      if (any(goes_on)) then
         self%is_bound = .true.
         self%misfit = sum(advance*(excess - recorded), mask=goes_on)/sum(advance, mask=goes_on)
      else if (any(counts)) then
         k = maxloc(recorded, dim=1, mask=counts)
         self%is_bound = 1.0_rk + recorded(k) > least_load .and. &
                         recorded(k) - recorded_before(k) > least_rise*(1.0_rk + recorded(k)) &
                         *self%recorded/(self%recorded_since + self%recorded)
         if (self%is_bound) self%misfit = excess(k) - recorded(k)
      end if
   end subroutine see_end

   !> Next length of the step to try, by the secant of the last two.
   subroutine improve(self, dt, is_found)
      class(pace_t), intent(inout) :: self
      real(rk), intent(inout) :: dt  !< [s]
      logical, intent(out) :: is_found
      integer, parameter :: tries_max = 15
      real(rk), parameter :: longest = 0.1_rk, shortest = 1.0e-6_rk  ! first change [-]
      real(rk), parameter :: most = 8.0_rk  ! change of the recorded length [-]
      real(rk) :: change, misfit_change

      is_found = .not. self%is_bound .or. abs(self%misfit) <= rounding .or. &
                 (self%tries > 3 .and. abs(self%misfit) <= small .and. &
                  abs(self%misfit) >= 0.1_rk*abs(self%last_misfit))
      if (is_found .or. allocated(self%why_not)) return
      self%tries = self%tries + 1
      misfit_change = self%misfit - self%last_misfit
      if (self%tries == 1 .or. .not. abs(misfit_change) > 0.0_rk) then
         change = min(longest*dt, abs(self%misfit)*(self%since + dt)/self%rise)
         change = -sign(max(shortest*dt, change), self%misfit)
      else
         change = -self%misfit*(dt - self%last_dt)/misfit_change
         self%rise = max(least_rise, abs(misfit_change/(dt - self%last_dt))*(self%since + dt))
         change = max(-0.8_rk*dt, min(4.0_rk*dt, change))
      end if
      is_found = self%tries > 1 .and. abs(change) <= same_time*(self%since + dt)
      if (is_found) return
      self%last_dt = dt
      self%last_misfit = self%misfit
      dt = dt + change
      if (self%tries > tries_max .or. dt > most*self%recorded .or. &
          dt < self%recorded/most) then
         self%why_not = "no step between an eighth and eight times the recorded one "// &
                        "leads to its K_eq/K_IC"
      end if
   end subroutine improve

end module twolevel_pace
