!> Estimated errors of fracture length and well pressure while tips grow in equilibrium.
!!
!! The length of a crack in equilibrium follows from K_eq = K_IC at the fluid volume in the crack.
!! If K_eq has an error e K_IC, the error of the tip position is e divided by the slope of K_eq/K_IC
!! along the path, or that of the time times the speed (twolevel_jumps). The pressure error follows
!! from the derivative of the pressure with respect to the length. Both slopes come from the tries
!! of a step, at the fluid volume of the step. These errors do not accumulate, since each state is
!! in equilibrium. Before growth the time errors of the steps accumulate with their signs. Where
!! fluid leaks off, each of them decays like the pressure of a pulse that diffuses from the
!! fracture, with the root of the time since the wells were switched; what has accumulated before a
!! switch counts by magnitude after it. With layers a step counts by 0.3 of its error as far as
!! fluid leaks off: the layers divide it (coarse_chain), which leaves a fourth of the error in
!! closed forms.
!!
!! The error of the coarse cells is added: at each tip a crack opens, slips and leaks as if it were
!! longer or shorter by at most a tenth of the coarse cell at the tip (coarse_tips: 0.05 in each). A
!! relative error of the length along which fluid leaks off causes the same relative error of the
!! pressure rise. Where all fluid leaks off, a crack in equilibrium grows until the injected fluid
!! leaks off over the true length, so the tip positions have the same error again. The rock next to
!! the fractures, with its layers and cells, takes in up to 1.3 % too much or too little
!! (docs/theory.md).
!!
!! A wing that is bent from its fracture and short over its cells opens by the slip of the fracture:
!! its length has an error of up to a cell, which falls with one over the number of its cells
!! (measured at 45 degrees, wings of 1 to 5 cells against cells a quarter as large, with and
!! without leak-off: 0.9 to 0.3 cells; verification/reservoir_scale/stated_errors.py).
!!
!! Before the first growth a tip whose K_eq equals K_IC within its error may have grown. The fluid
!! that the fractures have taken up since then may be in new faces, at the mean opening of all:
!! this is the error of the length. For as long after the onset as its time is uncertain, the growth
!! of the tip is part of the error.
!!
!! Equal tips that have separated by chance: each of them may as well be where the other one is, so
!! its position has at least the error of the distance by which one is ahead.
!!
!! Where viscosity matters, a step that opens a part of a cell at the tip makes the crack too long:
!! by two to six times that part squared, in cells (KGD, docs/theory.md).
!!
!! Accumulated time-step error of a scalar: the errors of the steps (twolevel_trend) add up with
!! their signs.
module twolevel_errors
   use, intrinsic :: iso_c_binding, only: c_loc
   use base_archive, only: archive_t
   use base_kinds, only: lk, rk
   use base_tolerances, only: same_time
   implicit none(type, external)
   private

   public :: accumulated_error_t, by_flow, stated_errors_t, tip_excess_t

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

   !> error of a tip position, over the length of the coarse cell at the tip [-]
   real(rk), parameter :: share = 0.1_rk
   !> the same of a bent wing, times the number of its cells [-]
   real(rk), parameter :: share_of_bent = 2.0_rk
   !> error of the leak-off by layers and cells, over the leak-off [-]
   real(rk), parameter :: share_of_leakoff = 0.015_rk

   !> Error of K_eq of a tip in a step, and the data to convert it into an error of the position.
   type :: tip_excess_t
      logical :: grows = .false.  !< the tip has advanced in the step
      real(rk) :: error = 0.0_rk  !< error of K_eq, over K_IC [-]
      real(rk) :: slope = -1.0_rk  !< derivative of K_eq/K_IC along the path, < 0 [1/m]
      real(rk) :: cell = 0.0_rk  !< length of the coarse cell at the tip [m]
      real(rk) :: wing = 0.0_rk  !< distance of the tip from where it began to grow [m]
      real(rk) :: bend = 0.0_rk  !< sine of the angle of this wing with its fracture [-]
      real(rk) :: by_time = 0.0_rk  !< error of the position by that of the time [m]
      !> length of a jump (twolevel_jumps), or growth since the onset, that is uncertain in time [m]
      real(rk) :: jump = 0.0_rk
      real(rk) :: by_flow = 0.0_rk  !< error of the position by the flow in the step [m]
   end type tip_excess_t

   !> Estimated errors, and the data of the last tries and of the last step.
   type :: stated_errors_t
      real(rk) :: length = 0.0_rk  !< error of the length of all fractures [m]
      real(rk) :: pressure = 0.0_rk  !< error of the pressure at the wells [Pa]
      real(rk), allocatable :: tip(:)  !< (tips) errors of the positions in equilibrium [m]
      !> (tips) the same, with what jumps, leads and the time of the onset leave uncertain [m]
      real(rk), allocatable :: position(:)
      !> part of `length` by which leads exceed these errors [m]
      real(rk), private :: by_leads = 0.0_rk
      logical, private :: has_grown = .false.  !< a tip has grown
      logical, private :: may_have_grown = .false.  !< a tip may have, within the error of its K_eq
      !> volume of the fractures in the last state, and in the last one in which no tip may have
      !! grown [m2]
      real(rk), private :: volume = 0.0_rk, volume_then = 0.0_rk
      integer :: tries = 0  !< number of tries of the present step
      !> length [m], pressure [Pa] and number of free tips of the last two tries
      real(rk) :: tried(3, 2) = 0.0_rk
      real(rk) :: slope = 0.0_rk  !< derivative of the pressure with respect to the length [Pa/m]
      type(accumulated_error_t) :: time_error  !< time error of the pressure [Pa]
      logical :: has_layers = .false.  !< on fractures or sides (coarse_layers)
      real(rk) :: before_switch = 0.0_rk  !< its magnitude before the last switch of a well [Pa]
      real(rk) :: time = 0.0_rk  !< length of all steps [s]
   contains
      procedure :: begin_step
      procedure :: see_try
      procedure :: accept
      procedure :: add_leads
      procedure :: await_growth
      procedure :: visit
   end type stated_errors_t

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

   !> Begin the tries of a new step.
   elemental subroutine begin_step(self)
      class(stated_errors_t), intent(inout) :: self

      self%tries = 0
   end subroutine begin_step

   !> Update the derivative of the pressure from a try of the step. Where a joint opens, the
   !! pressure falls without a change of the length.
   elemental subroutine see_try(self, length, pressure, n_free)
      class(stated_errors_t), intent(inout) :: self
      real(rk), intent(in) :: length  !< length of the fractures in the try [m]
      real(rk), intent(in) :: pressure  !< pressure at the wells [Pa]
      integer, intent(in) :: n_free  !< number of free tips
      real(rk) :: change(3)

      self%tried(:, 1) = self%tried(:, 2)
      self%tried(:, 2) = [length, pressure, real(n_free, rk)]
      self%tries = self%tries + 1
      if (self%tries < 2) return
      change = self%tried(:, 2) - self%tried(:, 1)
      if (abs(change(3)) > 0.0_rk) return
      if (abs(change(1)) > sqrt(epsilon(1.0_rk))*length) self%slope = change(2)/change(1)
   end subroutine see_try

   !> Update the errors after an accepted step.
   pure subroutine accept(self, step, pressure, tips, length, rise, leaked, age)
      class(stated_errors_t), intent(inout) :: self
      real(rk), intent(in) :: step  !< length of the step [s]
      real(rk), intent(in) :: pressure  !< pressure at the wells [Pa]
      type(tip_excess_t), intent(in) :: tips(:)
      real(rk), intent(in) :: length  !< length of all fractures [m]
      !> difference of the highest and the lowest pressure of the run so far [Pa]
      real(rk), intent(in) :: rise
      real(rk), intent(in) :: leaked  !< share of the injected fluid that has leaked off [-]
      real(rk), intent(in) :: age  !< time since a well was switched [s]
      real(rk) :: before

      if (.not. allocated(self%tip)) allocate (self%tip(size(tips)), source=0.0_rk)
      where (tips%grows) self%tip = max(tips%error/abs(tips%slope), tips%by_time) &
                                    + share*tips%cell*(1.0_rk + leaked) + error_of_bend(tips) &
                                    + tips%by_flow
      self%position = self%tip + tips%jump
      self%length = sum(self%position)
      call age_time_error(self, step, leaked, age)
      before = self%time_error%error
      self%by_leads = 0.0_rk
      call self%time_error%follow(step, pressure)
      if (self%has_layers) then
         associate (error => self%time_error%error)
            error = error - 0.7_rk*leaked*(error - before)
         end associate
      end if
      if (any(tips%grows)) then
         self%time_error%error = 0.0_rk
         self%before_switch = 0.0_rk
      end if
      self%pressure = abs(self%slope)*self%length + abs(self%time_error%error) &
                      + self%before_switch + share_of_leakoff*leaked*rise
      if (length > 0.0_rk) self%pressure = self%pressure + share*sum(tips%cell)/length*rise
   end subroutine accept

   !> What a step leaves of the time errors of the steps before it.
   pure subroutine age_time_error(self, step, leaked, age)
      class(stated_errors_t), intent(inout) :: self
      real(rk), intent(in) :: step  !< [s]
      real(rk), intent(in) :: leaked  !< [-]
      real(rk), intent(in) :: age  !< time since a well was switched, at the end of the step [s]

      if (.not. step > 0.0_rk) return
      if (age <= step + same_time*(self%time + step)) then
         self%before_switch = self%before_switch + abs(self%time_error%error)
         self%time_error%error = 0.0_rk
      else
         self%time_error%error = self%time_error%error*(1.0_rk - step/age)**(0.5_rk*leaked)
      end if
      self%before_switch = self%before_switch &
                           *(self%time/(self%time + step))**(0.5_rk*leaked)
      self%time = self%time + step
   end subroutine age_time_error

   !> Add to the errors of an accepted state the growth that may have begun before.
   pure subroutine await_growth(self, may_have_grown, grows, length, volume)
      class(stated_errors_t), intent(inout) :: self
      logical, intent(in) :: may_have_grown(:)  !< (tips) K_eq equals K_IC within its error
      logical, intent(in) :: grows  !< a tip has grown in the step
      real(rk), intent(in) :: length  !< of all fractures [m]
      real(rk), intent(in) :: volume  !< of all fractures [m2]
      real(rk) :: by_onset

      self%has_grown = self%has_grown .or. grows
      if (any(may_have_grown) .and. .not. self%may_have_grown) self%volume_then = self%volume
      self%may_have_grown = any(may_have_grown)
      self%volume = volume
      if (self%has_grown .or. .not. self%may_have_grown) return
      if (.not. volume > self%volume_then) return
      by_onset = length*(1.0_rk - self%volume_then/volume)
      where (may_have_grown) self%position = self%position + by_onset
      self%length = self%length + by_onset
      self%pressure = self%pressure + abs(self%slope)*by_onset
   end subroutine await_growth

   !> Add to the errors of an accepted state what tips have separated by.
   pure subroutine add_leads(self, lead)
      class(stated_errors_t), intent(inout) :: self
      real(rk), intent(in) :: lead(:)  !< (tips) distance to an equal tip; 0: none has separated [m]
      real(rk) :: before

      before = self%by_leads
      self%position = max(self%position, lead)
      ! Of two tips one would have the length that the other one has: counted once.
      self%by_leads = 0.5_rk*sum(max(0.0_rk, lead - self%tip))
      self%length = self%length + (self%by_leads - before)
      self%pressure = self%pressure + abs(self%slope)*(self%by_leads - before)
   end subroutine add_leads

   !> Error of the position of a tip where viscosity matters, by the flow of a step into the cell
   !! that opens in it. The steps before have left theirs, so a shorter one counts as usual [m].
   elemental real(rk) function by_flow(advance, cell)
      real(rk), intent(in) :: advance  !< of the tip in the step [m]
      real(rk), intent(in) :: cell  !< its length [m]
      real(rk), parameter :: measured = 6.0_rk, usual = 0.25_rk  ! docs/theory.md

      by_flow = measured*max(advance, usual*cell)**2/cell
   end function by_flow

   !> Error of the position of a tip by the cells of its bent wing [m].
   elemental real(rk) function error_of_bend(tip) result(error)
      type(tip_excess_t), intent(in) :: tip

      error = 0.0_rk
      if (tip%wing > 0.0_rk) error = tip%bend*tip%cell*min(1.0_rk, share_of_bent*tip%cell/tip%wing)
   end function error_of_bend

   !> Store or load all components.
   subroutine visit(self, archive)
      class(stated_errors_t), intent(inout), target :: self
      type(archive_t), intent(inout) :: archive

      call archive%item("length", self%length)
      call archive%item("pressure", self%pressure)
      call archive%list("tip", self%tip, "tips ?")
      call archive%item("by_leads", self%by_leads)
      call archive%item("has_grown", self%has_grown)
      call archive%item("may_have_grown", self%may_have_grown)
      call archive%item("volume", self%volume)
      call archive%item("volume_then", self%volume_then)
      call archive%item("tries", self%tries)
      call archive%item("tried", self%tried)
      call archive%item("slope", self%slope)
      call archive%plain("time_error", c_loc(self%time_error), storage_size(self%time_error)/8_lk)
      call archive%item("has_layers", self%has_layers)
      call archive%item("before_switch", self%before_switch)
      call archive%item("time", self%time)
   end subroutine visit

end module twolevel_errors
