!> A tip before its onset of growth: the rate of its intensity, and the error of the onset time that
!! follows from the rate.
module twolevel_onset
   use base_kinds, only: rk
   use twolevel_course, only: course_t
   implicit none(type, external)
   private

   public :: approach_t

   !> The last accepted state of a tip, and the error of its intensity by the steps in time.
   type :: approach_t
      logical :: is_over = .false.  !< the tip has grown
      real(rk) :: time = 0.0_rk  !< [s]
      logical :: has_come = .false.  !< K_eq has reached the toughness
      real(rk) :: onset = 0.0_rk  !< when it first did [s]
      type(course_t) :: drive  !< K_eq [Pa m^1/2]
      real(rk) :: drive_error = 0.0_rk  !< of that, as estimated [Pa m^1/2]
   contains
      procedure :: follow
      procedure :: onset_before
      procedure :: uncertainty
   end type approach_t

contains

   !> Take note of an accepted state.
   elemental subroutine follow(self, time, drive, drive_error, toughness)
      class(approach_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      real(rk), intent(in) :: drive  !< K_eq [Pa m^1/2]
      real(rk), intent(in) :: drive_error  !< by the meshes, as estimated [Pa m^1/2]
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]
      real(rk) :: step

      step = time - self%time
      ! What a finite increment needs, and a new mesh around the tip, may hold it back after that.
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

   !> When K_eq has reached the toughness [s]: in a followed state, else at the rate of the last
   !! one, at the latest where the tip is found to have grown.
   elemental real(rk) function onset_before(self, time, toughness)
      class(approach_t), intent(in) :: self
      real(rk), intent(in) :: time  !< of the first state in which it has [s]
      real(rk), intent(in) :: toughness  !< [Pa m^1/2]

      onset_before = self%onset
      if (self%has_come .or. .not. self%drive%rate > 0.0_rk) return
      onset_before = min(time, self%time + (toughness - self%drive%value)/self%drive%rate)
   end function onset_before

   !> How far the time of the onset may be off [s]: what K_eq may be off, over its rate. Huge where
   !! it does not rise.
   elemental real(rk) function uncertainty(self, tolerance)
      class(approach_t), intent(in) :: self
      real(rk), intent(in) :: tolerance  !< on K_eq of growing tips [Pa m^1/2]

      uncertainty = huge(1.0_rk)
      if (self%drive%rate > 0.0_rk) then
         uncertainty = (abs(self%drive%error) + self%drive_error + tolerance)/self%drive%rate
      end if
   end function uncertainty

end module twolevel_onset
