!> The end of a fracture as it grows, and the direction in which it goes on straight.
!!
!! A tip kinks by the angle of the largest tangential stress. Under a strong stress along the crack
!! this angle is right only for steps shorter than about (K_I/T)^2 (T: the stress parallel to the
!! crack less the one across it; Cotterell and Rice 1980): longer explicit steps overshoot to and
!! fro, and the path meanders more and more. So each step but the first kink of a fracture's end is
!! corrected until the kink angle at the new tip vanishes, that is, until the criterion holds at
!! the end of the step (backward Euler for the path; local symmetry).
module tips_path
   use base_kinds, only: rk
   use tips_growth, only: new_tip
   implicit none(type, external)
   private

   public :: path_t

   !> A free tip on its way.
   type :: path_t
      real(rk) :: xy(2) = 0.0_rk  !< where it is [m]
      real(rk) :: direction(2) = 0.0_rk  !< unit vector ahead
      real(rk) :: carried = 0.0_rk  !< growth too short for the mesh, kept [m]
      real(rk) :: advance = 0.0_rk  !< of the last increment; 0: did not grow [m]
      real(rk) :: kink = 0.0_rk  !< of that advance, anticlockwise [rad]
      real(rk) :: origin(2) = 0.0_rk, heading(2) = 0.0_rk  !< tip and direction before it
      logical :: has_wing = .false.  !< has grown before
      real(rk) :: tried_kink(2) = 0.0_rk, tried_drive(2) = 0.0_rk  !< last tries of `correct` [rad]
      integer :: tries = 0
      logical :: is_bracketed = .false.  !< the two tries lie on either side of the right kink
   contains
      procedure :: move
      procedure :: correct
   end type path_t

contains

   !> Grow straight to a new place.
   pure subroutine move(self, to, kink)
      class(path_t), intent(inout) :: self
      real(rk), intent(in) :: to(2)  !< [m]
      real(rk), intent(in) :: kink  !< anticlockwise; that of the criterion [rad]

      self%origin = self%xy
      self%heading = self%direction
      self%advance = norm2(to - self%xy)
      self%direction = (to - self%xy)/self%advance
      self%xy = to
      self%kink = kink
      ! A guess for the first correction: going straight on would leave the drive about as it is.
      self%tried_kink = 0.0_rk
      self%tried_drive = kink
      self%tries = 0
      self%is_bracketed = .false.
   end subroutine move

   !> Turn the last advance so that the kink angle at its new end vanishes: one step of the Illinois
   !! method, which keeps the right direction between two tries (the drive angle saturates at
   !! pure sliding, where a secant would go astray).
   pure subroutine correct(self, drive_angle, has_turned)
      class(path_t), intent(inout) :: self
      real(rk), intent(in) :: drive_angle  !< kink angle of the criterion at the new end [rad]
      logical, intent(out) :: has_turned
      real(rk), parameter :: enough = 0.035_rk  ! two degrees
      real(rk), parameter :: narrow = 0.005_rk  ! bracket [rad]
      real(rk), parameter :: largest = 1.23_rk  ! pure sliding [rad]
      real(rk), parameter :: longest = 0.6_rk  ! step [rad]
      real(rk) :: kink, slope

      has_turned = .false.
      if (.not. (self%advance > 0.0_rk .and. self%has_wing)) return
      if (.not. abs(drive_angle) > enough) return
      if (self%is_bracketed .and. drive_angle*self%tried_drive(2) > 0.0_rk) then
         self%tried_drive(1) = 0.5_rk*self%tried_drive(1)
      else
         self%tried_kink(1) = self%tried_kink(2)
         self%tried_drive(1) = self%tried_drive(2)
      end if
      self%tried_kink(2) = self%kink
      self%tried_drive(2) = drive_angle
      self%tries = self%tries + 1
      ! The first try has only a guess beside it, which must not bound the search.
      self%is_bracketed = self%tries > 1 .and. self%tried_drive(1)*self%tried_drive(2) < 0.0_rk
      if (self%is_bracketed .and. abs(self%tried_kink(2) - self%tried_kink(1)) < narrow) return
      ! A drive that does not fall with the kink tells nothing: then turn as the criterion says.
      slope = -1.0_rk
      if (abs(self%tried_kink(2) - self%tried_kink(1)) > 0.0_rk) slope = (self%tried_drive(2) &
                                                                          - self%tried_drive(1)) &
                                                                         /(self%tried_kink(2) &
                                                                           - self%tried_kink(1))
      if (.not. slope < -0.1_rk) slope = -1.0_rk
      kink = self%kink - max(-longest, min(longest, drive_angle/slope))
      kink = min(largest, max(-largest, kink))
      if (.not. abs(kink - self%kink) > 0.0_rk) return
      self%xy = new_tip(self%origin, self%heading, kink, self%advance)
      self%direction = (self%xy - self%origin)/self%advance
      self%kink = kink
      has_turned = .true.
   end subroutine correct

end module tips_path
