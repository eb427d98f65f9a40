!> A tip before its onset of growth: the rate of its intensity, and the error of the onset time that
!! follows from the rate.
module twolevel_onset
   use base_kinds, only: rk
   use twolevel_errors, only: accumulated_error_t
   implicit none(type, external)
   private

   public :: approach_t

   !> Last accepted state of a tip, and the time error of its intensity.
   type :: approach_t
      logical :: is_over = .false.  !< the tip has grown
      real(rk) :: time = 0.0_rk  !< [s]
      logical :: has_come = .false.  !< K_eq has reached the toughness
      real(rk) :: onset = 0.0_rk  !< time at which K_eq first reached the toughness [s]
      type(accumulated_error_t) :: drive  !< K_eq [Pa m^1/2]
      real(rk) :: drive_error = 0.0_rk  !< estimated discretization error of K_eq [Pa m^1/2]
   contains
      procedure :: follow
      procedure :: onset_before
      procedure :: uncertainty
      procedure :: early_growth
   end type approach_t

contains

   !> Store an accepted state.
   elemental subroutine follow(self, time, drive, drive_error, toughness)
      class(approach_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      real(rk), intent(in) :: drive  !< K_eq [Pa m^1/2]
      real(rk), intent(in) :: drive_error  !< estimated discretization error of K_eq [Pa m^1/2]
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      real(rk) :: step

      step = time - self%time
      ! Growth may begin later: a finite increment, and a new mesh around the tip, may require a
      ! larger K_eq.
      if (.not. self%has_come) then
         self%has_come = drive >= toughness
         self%onset = time
         if (self%has_come .and. self%drive%is_followed) then
            self%onset = self%time + step*(toughness - self%drive%value)/(drive - self%drive%value)
         end if
      end if
      call self%drive%follow(step, drive)
      self%time = time
      self%drive_error = drive_error
   end subroutine follow

   !> Time at which K_eq has reached the toughness: in an accepted state, else extrapolated with the
   !! last rate, but no later than `time` [s].
   elemental real(rk) function onset_before(self, time, toughness)
      class(approach_t), intent(in) :: self
      real(rk), intent(in) :: time  !< time of the first state in which the tip has grown [s]
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]

      onset_before = self%onset
      if (self%has_come .or. .not. self%drive%rate > 0.0_rk) return
      onset_before = min(time, self%time + (toughness - self%drive%value)/self%drive%rate)
   end function onset_before

   !> Error of the onset time: the error of K_eq over its rate; huge where K_eq does not increase
   !! [s].
   elemental real(rk) function uncertainty(self, tolerance)
      class(approach_t), intent(in) :: self
      real(rk), intent(in) :: tolerance  !< tolerance of K_eq of growing tips [Pa m^1/2]

      uncertainty = huge(1.0_rk)
      if (self%drive%rate > 0.0_rk) then
         uncertainty = (abs(self%drive%error) + self%drive_error + tolerance)/self%drive%rate
      end if
   end function uncertainty

   !> Growth of the tip that may not have begun: for as long after the onset as its time is
   !! uncertain [m].
   elemental real(rk) function early_growth(self, gain, time, tolerance)
      class(approach_t), intent(in) :: self
      real(rk), intent(in) :: gain  !< growth of the tip so far [m]
      real(rk), intent(in) :: time  !< [s]
      real(rk), intent(in) :: tolerance  !< tolerance of K_eq of growing tips [Pa m^1/2]

      early_growth = 0.0_rk
      associate (error => self%uncertainty(tolerance))
         if (error < huge(1.0_rk) .and. time < self%time + error) early_growth = gain
      end associate
   end function early_growth

end module twolevel_onset
