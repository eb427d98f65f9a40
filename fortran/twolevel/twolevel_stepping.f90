!> The length of time steps. A step is tried; its result determines whether the step is accepted, or
!! cut and tried again, and how long the next step is.
!!
!! A step is cut if its equations are not solved, if its time error exceeds the tolerance, or if
!! tips would grow too far. It is also cut to the time at which a tip begins to grow. With a
!! tolerance, steps are as long as the tolerance and the growth of the tips allow; without one they
!! are those of the scene. Lengths differ by factors of two where there is a choice, since each
!! length costs a factorization.
!!
!! The speed of growth is not known before a step that contains it: seconds per segment where the
!! wells supply the fluid, microseconds where fluid that was held back flows in, none where growth
!! is unstable. So each further cut of a step in which tips grow too far squares the remaining share
!! of the step: six cuts instead of thirty lead to the shortest step.
!!
!! The onset of growth of a tip, or its arrival at a joint, is found by linear interpolation between
!! the ends of the step. An intensity that changes as soon as the step begins, however short the
!! step is, leads to the same share repeatedly: after three such cuts of a step each cut squares the
!! share, and the sixth leads to a negligible share.
!!
!! The end of a step in which tips grew too far is remembered until they have passed it: steps
!! before it that bring little growth halve the time that is left, and do not cross it, since growth
!! that is about to become unstable gives no other notice.
!!
!! After a step whose equations were not solved, steps become longer slowly: what hinders the
!! iteration mostly lasts.
!!
!! No step is cut to less than a 64th of the shortest step; a step of this length is accepted with
!! any time error. A run ends if hundreds of steps in succession are cut to nearly this length.
!!
!! With growth by increments at the ends of steps (the law of the thesis) steps are short after
!! growth until the pressure at the new tips has settled.
module twolevel_stepping
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_value
   use scene_types, only: first_share, time_t
   implicit none(type, external)
   private

   public :: first_step, improve_by_body, improve_edge, improve_elements, refinement_t, stepper_t
   public :: step_scale, trial_t, withdraw_edge, withdraw_elements

   !> relative change of pressure at new tips in a short step
   real(rk), parameter :: settled = 0.01_rk

   !> Largest advance of a tip in a step, over the length of its segment [-].
   real(rk), parameter :: most = 1.5_rk

   ! Kinds of window refinement.
   integer, parameter :: improve_elements = 1  !< smaller elements
   integer, parameter :: improve_edge = 2  !< larger window
   integer, parameter :: improve_by_body = 3  !< body as window
   integer, parameter :: withdraw_elements = 4, withdraw_edge = 5  !< refinement without effect

   !> Refinement of the window of a tip.
   type :: refinement_t
      integer(ik) :: tip = 0
      integer :: kind = improve_elements
      real(rk) :: error = 0.0_rk  !< error of K_I and K_II before [Pa m^1/2]
   contains
      procedure :: changes_body
   end type refinement_t

   !> Result of a tried step.
   type :: trial_t
      logical :: converged = .false.  !< the equations are solved
      logical :: goes_too_far = .false.  !< tips would advance by more than one new segment
      logical :: jumps = .false.  !< tips advance by more than one new segment, and may
      logical :: was_beyond = .false.  !< one of these tips exceeded its toughness before the step
      logical :: has_joined = .false.  !< a tip has joined a target in the step
      real(rk) :: onset = 1.0_rk  !< share of the step in which no tip begins to grow [-]
      !> share of the step in which these tips would not go too far, by linear interpolation [-]
      real(rk) :: admissible = 1.0_rk
      logical :: is_late = .false.  !< a tip reaches a target long before the end of the step
      logical :: gains_all = .false.  !< a tip reaches the prescribed gain instead of a target
      real(rk) :: arrival = 1.0_rk  !< share of the step after which the tip does [-]
      real(rk) :: beyond = 0.0_rk  !< its excess at the end of the step, beyond what is aimed at [-]
      real(rk) :: moment = 0.0_rk  !< length of a step within which this time does not matter [s]
      real(rk) :: switch = 1.0_rk  !< share of the step after which a well reaches its limit [-]
      real(rk) :: time_error = 0.0_rk  !< relative time error [-]
      real(rk) :: advance = 0.0_rk  !< largest advance of a tip, over the length of a segment [-]
      character(len=:), allocatable :: reason  !< reason why the equations were not solved
      !> refinements of windows before the step is tried again; unallocated or empty: none
      type(refinement_t), allocatable :: refinements(:)
   contains
      procedure :: needs_windows
      procedure :: why_cut
   end type trial_t

   !> Smallest share to which a step is cut where a tip reaches a target early in the step [-].
   real(rk), parameter :: soonest = 0.05_rk

   !> Numbers of cuts of a step to an event within it: those by linear interpolation, and all.
   integer, parameter :: plain_cuts = 3, location_cuts = 6

   !> Shortest length to which steps are cut, over the shortest step of the scene [-].
   real(rk), parameter :: floor_share = 2.0_rk**(-6)

   !> A run ends after `most_in_vain` cut steps without growth, none of them longer than `headway`
   !! times the shortest step.
   integer, parameter :: most_in_vain = 300
   real(rk), parameter :: headway = 100.0_rk
   !> It also ends if so many steps without growth take no more than this share of the time to the
   !! next switch, as where fractures open and close in turn [-].
   integer, parameter :: many_steps = 500
   real(rk), parameter :: little = 0.005_rk

   integer, parameter :: most_powers = 2  !< a step is at most 4 times the last one

   !> Control of the step length.
   type :: stepper_t
      real(rk) :: next = 0.0_rk  !< next step to try [s]
      real(rk) :: longest = huge(1.0_rk)  !< [s]
      real(rk) :: shortest = 0.0_rk  !< shorter steps are too short [s]
      real(rk) :: after_growth = 0.0_rk  !< step after an increment of growth [s]
      real(rk) :: tolerance = 0.0_rk  !< tolerance of the time error of a step; 0: not checked [-]
      !> time left to the end of the last step in which tips advanced too far [s]
      real(rk) :: left_in_vain = huge(1.0_rk)
      integer :: halvings = 0  !< number of steps that have halved it
      !> longest next step, after one whose equations were not solved [s]
      real(rk) :: solvable = huge(1.0_rk)
      integer :: solved = 0  !< number of steps since
      !> length of a step within which the time of a jump does not matter [s]
      real(rk) :: moment = 0.0_rk
      integer :: in_vain = 0  !< cuts of the present step after which tips still advanced too far
      integer :: onset_cuts = 0  !< cuts of the present step to an onset of growth
      real(rk) :: onset = 0.0_rk  !< share of the present step at which its last such cut was [-]
      !> growth begins in the present step however short it is, because others grow at its start
      logical :: has_sudden_onset = .false.
      integer :: arrival_cuts = 0  !< cuts of the present step to the arrival at a target
      real(rk) :: late(2) = 0.0_rk  !< length [s] and excess [-] before the last such cut
      integer :: at_switches = 0  !< cuts of the present step at limits of wells
      !> time error of the present step before its last cut for this error [-]
      real(rk) :: error_before = huge(1.0_rk)
      integer :: without_headway = 0  !< number of such steps since the last longer one
      integer :: slow_steps = 0  !< steps without growth, up to many_steps, and
      real(rk) :: slow_time = 0.0_rk  !< the time that they took [s]
      logical :: was_cut = .false.  !< the present step has been cut
      logical :: is_short = .false.  !< after growth, until the pressure at the new tips has settled
      !> pressure of the new cells after the last short step [Pa]
      real(rk), allocatable :: pressure(:)
   contains
      procedure :: begin
      procedure :: step_to
      procedure :: expects_jump
      procedure :: takes
      procedure :: cut
      procedure :: step_done
      procedure :: is_stuck
      procedure :: is_slow
      procedure :: settle
      procedure :: network_grew
   end type stepper_t

contains

   !> Whether K in the body as one window is not that of before, or may be more accurate.
   pure logical function changes_body(self)
      class(refinement_t), intent(in) :: self

      changes_body = self%kind == improve_elements .or. self%kind == improve_by_body
   end function changes_body

   !> First step with a tolerance [s].
   pure real(rk) function first_step(time)
      type(time_t), intent(in) :: time

      first_step = merge(time%first, first_share*time%end, time%first > 0.0_rk)
      if (time%step > 0.0_rk) first_step = min(first_step, time%step)
   end function first_step

   !> The regular or longest step; without it the duration of which the first step is that share. It
   !! does not follow from the end where the first step is given, as in a run that is continued [s].
   pure real(rk) function step_scale(time)
      type(time_t), intent(in) :: time

      step_scale = merge(time%step, first_step(time)/first_share, time%step > 0.0_rk)
   end function step_scale

   !> Set the control from the time settings of the scene.
   subroutine begin(self, time)
      class(stepper_t), intent(out) :: self
      type(time_t), intent(in) :: time

      self%tolerance = time%tolerance
      self%shortest = time%smallest_factor*step_scale(time)
      if (time%step > 0.0_rk) self%longest = time%step
      self%after_growth = time%share_after_growth*step_scale(time)
      self%next = merge(first_step(time), self%longest, self%tolerance > 0.0_rk)
   end subroutine begin

   !> Length of the step to try; no step straddles a switch of the wells.
   pure real(rk) function step_to(self, left)
      class(stepper_t), intent(in) :: self
      real(rk), intent(in) :: left  !< time to the next switch [s]

      step_to = min(self%next, left)
      ! No very short step before a switch, and few different lengths, each of which costs a
      ! factorization.
      if (left < step_to*(1.0_rk + same_value)) step_to = left
   end function step_to

   !> Whether a tried step may be accepted.
   pure logical function takes(self, trial)
      class(stepper_t), intent(in) :: self
      type(trial_t), intent(in) :: trial

      takes = trial%converged .and. .not. trial%goes_too_far .and. .not. trial%onset < 1.0_rk
      takes = takes .and. .not. (trial%is_late .or. trial%switch < 1.0_rk)
      if (self%tolerance > 0.0_rk) takes = takes .and. trial%time_error <= self%tolerance
   end function takes

   !> Cut a rejected step, unless it becomes too short.
   pure subroutine cut(self, trial, dt, is_too_short)
      class(stepper_t), intent(inout) :: self
      type(trial_t), intent(in) :: trial
      real(rk), intent(inout) :: dt  !< [s]
      logical, intent(out) :: is_too_short
      real(rk), parameter :: steady = 0.95_rk  ! ratio of errors [-]
      real(rk), parameter :: nearer = 0.25_rk  ! least approach of the onset to the end [-]
      logical :: is_steady
      real(rk) :: share, least

      is_steady = .false.
      self%was_cut = .true.
      if (trial%converged .and. trial%goes_too_far) then
         self%left_in_vain = dt
         self%halvings = 0
      end if
      if (.not. trial%converged) then
         self%solvable = 0.5_rk*dt
         self%solved = 0
      end if
      least = min(dt, floor_share*self%shortest)
      if (trial%converged .and. trial%onset < 1.0_rk .and. self%onset_cuts > 0 .and. &
          trial%onset < self%onset + nearer*(1.0_rk - self%onset)) then
         self%has_sudden_onset = .true.
         self%left_in_vain = dt
         self%halvings = 0
         dt = max(min(dt, self%moment), min(dt, 0.5_rk*self%shortest))
      else if (trial%converged .and. trial%onset < 1.0_rk) then
         self%onset = trial%onset
         call cut_to(max(0.01_rk, trial%onset), 0.5_rk*self%shortest, self%onset_cuts, dt)
      else if (trial%converged .and. trial%switch < 1.0_rk) then
         ! A pressure that is nearly constant passes a limit long before linear interpolation
         ! predicts.
         share = trial%switch
         if (self%at_switches >= 3) share = min(share, 0.5_rk)
         dt = max(0.01_rk, share)*dt
         self%at_switches = self%at_switches + 1
      else if (trial%converged .and. trial%is_late .and. .not. trial%goes_too_far) then
         share = share_before_arrival(self, trial, dt)
         self%late = [dt, trial%beyond]
         call cut_to(max(soonest, share), max(trial%moment, 0.5_rk*self%shortest), &
                     self%arrival_cuts, dt)
      else if (trial%converged .and. .not. trial%goes_too_far) then
         dt = dt*2.0_rk**max(-6, min(-1, powers(self, trial)))
         ! What happens at the start of the step at once is no error of its length.
         is_steady = trial%time_error > steady*self%error_before
         self%error_before = trial%time_error
      else if (trial%converged) then
         ! Not below half the shortest step; to this length at once where the volume that flows in
         ! the step does not matter.
         share = 0.0_rk
         if (.not. trial%was_beyond) share = min(trial%admissible, next_share(self%in_vain))
         dt = max(min(0.5_rk*dt, 0.5_rk*self%shortest), share*dt)
         self%in_vain = self%in_vain + 1
      else
         dt = 0.5_rk*dt
      end if
      dt = max(dt, least)
      is_too_short = dt < self%shortest .or. is_steady
      self%next = dt
   end subroutine cut

   !> Share of a step after which a tip reaches its target: once the step has been cut for this
   !! reason, by linear interpolation between the excesses in steps of both lengths [-].
   pure real(rk) function share_before_arrival(self, trial, dt) result(share)
      class(stepper_t), intent(in) :: self
      type(trial_t), intent(in) :: trial
      real(rk), intent(in) :: dt  !< [s]
      real(rk), parameter :: least = 0.25_rk

      share = trial%arrival
      if (self%arrival_cuts == 0 .or. trial%beyond >= self%late(2)) return
      share = max(least, 1.0_rk - trial%beyond/(self%late(2) - trial%beyond) &
                  *(self%late(1)/dt - 1.0_rk))
   end function share_before_arrival

   !> Cut a step to the share after which an event happens; the last such cut leads to a length
   !! within which the time of the event does not matter.
   pure subroutine cut_to(share, least, cuts, dt)
      real(rk), intent(in) :: share  !< [-]
      real(rk), intent(in) :: least  !< [s]
      integer, intent(inout) :: cuts  !< cuts of the step for the same reason
      real(rk), intent(inout) :: dt  !< [s]

      cuts = cuts + 1
      if (cuts < location_cuts) then
         dt = share**2**max(0, cuts - plain_cuts)*dt
      else
         dt = min(share*dt, least)
      end if
   end subroutine cut_to

   !> Share of a step that a cut leaves, so that the share after n cuts is 2**(-2**(n-1)) [-].
   pure real(rk) function next_share(n)
      integer, intent(in) :: n  !< number of cuts before
      integer, parameter :: most_cuts = 6  ! the shortest step is reached

      next_share = 2.0_rk**(-2**max(0, min(n, most_cuts) - 1))
   end function next_share

   !> Set the next step after an accepted step of length dt.
   pure subroutine step_done(self, trial, dt)
      class(stepper_t), intent(inout) :: self
      type(trial_t), intent(in) :: trial
      real(rk), intent(in) :: dt  !< [s]
      integer :: power

      self%in_vain = 0
      self%onset_cuts = 0
      self%has_sudden_onset = .false.
      self%arrival_cuts = 0
      self%at_switches = 0
      self%error_before = huge(1.0_rk)
      if (self%tolerance > 0.0_rk) then
         power = max(-1, min(most_powers, powers(self, trial)))
         self%next = min(2.0_rk**power*dt, self%longest)
         ! Within a time that does not matter growth is a jump, however many segments it takes.
         self%next = max(self%next, least_step(self, trial, dt))
         call approach(self, trial, dt)
         call lengthen_slowly(self)
      else
         power = 1
         if (trial%advance > 0.0_rk) power = max(-1, min(1, powers(self, trial)))
         self%next = min(2.0_rk**power*self%next, self%longest)
      end if
      self%next = max(self%next, floor_share*self%shortest)
      if (dt > headway*self%shortest .or. trial%advance > 0.0_rk) then
         self%without_headway = 0
      else if (self%was_cut) then
         self%without_headway = self%without_headway + 1
      end if
      self%was_cut = .false.
      if (self%slow_steps == many_steps .or. trial%advance > 0.0_rk) then
         self%slow_steps = 0
         self%slow_time = 0.0_rk
      end if
      self%slow_steps = self%slow_steps + 1
      self%slow_time = self%slow_time + dt
   end subroutine step_done

   !> Length to which growth does not shorten the next step: the time of a jump within it does not
   !! matter. It grows with time, but a step that is nearly as long is kept [s].
   pure real(rk) function least_step(self, trial, dt)
      class(stepper_t), intent(in) :: self
      type(trial_t), intent(in) :: trial
      real(rk), intent(in) :: dt  !< [s]
      real(rk), parameter :: nearly = 0.75_rk

      least_step = min(self%moment, self%longest, dt*2.0_rk**min(most_powers, &
                                                                 powers_of_time(self, trial)))
      if (dt < least_step .and. dt >= nearly*least_step) least_step = dt
   end function least_step

   !> Limit the next step where a step in which tips advanced too far has been cut to this one: to
   !! half of the time that is left, and to all of it after several such steps, or where the time of
   !! a jump does not matter. With noticeable growth it is the length of a segment that limits steps
   !! (powers), and a jump is over.
   pure subroutine approach(self, trial, dt)
      class(stepper_t), intent(inout) :: self
      type(trial_t), intent(in) :: trial
      real(rk), intent(in) :: dt  !< [s]
      integer, parameter :: most_halvings = 4
      real(rk), parameter :: noticeable = 0.25_rk  ! advance, over the length of a segment [-]

      if (.not. self%left_in_vain < huge(1.0_rk)) return
      self%left_in_vain = self%left_in_vain - dt
      if (trial%jumps .or. trial%has_joined .or. trial%advance > noticeable .or. &
          self%left_in_vain <= same_value*dt) then
         self%left_in_vain = huge(1.0_rk)
         return
      end if
      self%halvings = self%halvings + 1
      self%next = min(self%next, merge(0.5_rk, 1.0_rk, self%halvings <= most_halvings .and. &
                                       self%left_in_vain > self%moment)*self%left_in_vain)
   end subroutine approach

   !> Limit the next step after one whose equations were not solved; after several steps it is free.
   pure subroutine lengthen_slowly(self)
      class(stepper_t), intent(inout) :: self
      integer, parameter :: several = 4
      real(rk), parameter :: longer = sqrt(2.0_rk)  ! than the step before [-]

      if (.not. self%solvable < huge(1.0_rk)) return
      self%next = min(self%next, self%solvable)
      self%solvable = longer*self%solvable
      self%solved = self%solved + 1
      if (self%solved >= several) self%solvable = huge(1.0_rk)
   end subroutine lengthen_slowly

   !> Whether the next step ends where tips have been found to advance too far.
   pure logical function expects_jump(self)
      class(stepper_t), intent(in) :: self

      expects_jump = self%left_in_vain < huge(1.0_rk) .and. &
                     self%next >= self%left_in_vain*(1.0_rk - same_value)
   end function expects_jump

   !> Whether steps have remained too short for progress in time.
   pure logical function is_stuck(self)
      class(stepper_t), intent(in) :: self

      is_stuck = self%without_headway >= most_in_vain
   end function is_stuck

   !> Whether steps with the error chosen hardly bring the run forward.
   pure logical function is_slow(self, left)
      class(stepper_t), intent(in) :: self
      real(rk), intent(in) :: left  !< time to the next switch [s]

      is_slow = self%tolerance > 0.0_rk .and. self%slow_steps == many_steps .and. &
                self%slow_time < little*left
   end function is_slow

   !> Power of two by which the next step should be longer than a step with this result.
   pure integer function powers(self, trial)
      class(stepper_t), intent(in) :: self
      type(trial_t), intent(in) :: trial

      powers = powers_of_time(self, trial)
      if (trial%advance > 0.0_rk) powers = min(powers, lower_power(most/trial%advance))
   end function powers

   !> The same by the time error alone.
   pure integer function powers_of_time(self, trial) result(powers)
      class(stepper_t), intent(in) :: self
      type(trial_t), intent(in) :: trial
      integer, parameter :: any_number = 60
      real(rk), parameter :: aim = 0.5_rk  ! share of the tolerance [-]

      powers = any_number
      if (self%tolerance > 0.0_rk .and. trial%time_error > 0.0_rk) then
         powers = min(powers, lower_power(sqrt(aim*self%tolerance/trial%time_error)))
      end if
   end function powers_of_time

   !> Exponent of the largest power of two that does not exceed a ratio.
   pure integer function lower_power(ratio)
      real(rk), intent(in) :: ratio  !< [-]
      integer, parameter :: largest = 60

      lower_power = floor(log(max(2.0_rk**(-largest), min(2.0_rk**largest, ratio)))/log(2.0_rk))
   end function lower_power

   !> After a step with growth by increments: return to long steps once the pressures of the new
   !! cells are constant.
   pure subroutine settle(self, pressure)
      class(stepper_t), intent(inout) :: self
      real(rk), intent(in) :: pressure(:)  !< pressure of the cells added by the last growth [Pa]

      if (.not. self%is_short) return
      if (allocated(self%pressure)) then
         if (size(pressure) == size(self%pressure)) self%is_short = &
            maxval(abs(pressure - self%pressure)) > settled*maxval(abs(pressure))
      end if
      self%pressure = pressure
      self%next = merge(self%after_growth, self%longest, self%is_short)
   end subroutine settle

   !> Take short steps after an increment of growth.
   pure subroutine network_grew(self)
      class(stepper_t), intent(inout) :: self

      self%is_short = .true.
      self%next = self%after_growth
      if (allocated(self%pressure)) deallocate (self%pressure)
   end subroutine network_grew

   !> Whether windows are to be refined before the step is tried again.
   pure logical function needs_windows(self)
      class(trial_t), intent(in) :: self

      needs_windows = allocated(self%refinements)
      if (needs_windows) needs_windows = size(self%refinements) > 0
   end function needs_windows

   !> Reason of a cut, as text.
   pure function why_cut(self) result(words)
      class(trial_t), intent(in) :: self
      character(len=:), allocatable :: words

      if (.not. self%converged) then
         words = self%reason
      else if (self%goes_too_far) then
         words = "growth finds no equilibrium within a segment"
      else if (self%onset < 1.0_rk) then
         words = "a tip begins to grow in it"
      else if (self%switch < 1.0_rk) then
         words = "a well reaches or leaves its limit in it"
      else if (self%is_late .and. self%gains_all) then
         words = "a tip reaches stop_gain in it"
      else if (self%is_late) then
         words = "a tip reaches a joint in it"
      else
         words = "its time error is too large"
      end if
   end function why_cut

end module twolevel_stepping
