!> A free tip of a growing network, for both levels.
!!
!! The end of a fracture that grows, and the direction in which its path continues straight.
!!
!! A tip kinks by the angle of the largest tangential stress. Under a strong stress along the crack
!! this angle is right only for steps shorter than about (K_I/T)^2 (T: the stress parallel to the
!! crack less the one across it; Cotterell and Rice 1980): longer explicit steps overshoot to both
!! sides, with increasing amplitude. So each step except the first kink of a fracture's end is
!! corrected until the kink angle at the new tip vanishes, that is, until the criterion holds at
!! the end of the step (backward Euler for the path; local symmetry).
module growth_tip
   use base_kinds, only: ik, rk
   use fine_tip_types, only: intensity_t
   use growth_law, only: growth_drive_t, in_grains, new_tip
   use growth_targets, only: target_none
   implicit none(type, external)
   private

   public :: path_t, tip_t

   !> A free tip on its way. The drive is -K_II: it has the sign of the kink angle of the criterion
   !! and is nearly linear in the kink, also where the angle saturates: at closed faces, and under a
   !! strong stress along the crack.
   type :: path_t
      real(rk) :: xy(2) = 0.0_rk  !< where it is [m]
      real(rk) :: direction(2) = 0.0_rk  !< unit vector ahead
      real(rk) :: carried = 0.0_rk  !< growth too short for the mesh, kept [m]
      real(rk) :: advance = 0.0_rk  !< of the last increment; 0: did not grow [m]
      real(rk) :: kink = 0.0_rk  !< of that advance, anticlockwise [rad]
      real(rk) :: origin(2) = 0.0_rk, heading(2) = 0.0_rk  !< tip and direction before it
      logical :: has_wing = .false.  !< has grown before
      ! The last two tries of `correct` [rad], [Pa sqrt(m)].
      real(rk), private :: tried_kink(2) = 0.0_rk, tried_drive(2) = 0.0_rk
      integer, private :: tries = 0
      logical, private :: is_bracketed = .false.  !< they lie on either side of the right kink
      ! What the increments so far have taught, for the next one.
      real(rk), private :: falls = 0.0_rk  !< -d drive/d kink over the strength; 0: unknown [1/rad]
      real(rk), private :: strength = 0.0_rk  !< K_eq at the start of the increment [Pa sqrt(m)]
      real(rk), private :: start_drive = 0.0_rk  !< there [Pa sqrt(m)]
      real(rk), private :: curvature = 0.0_rk  !< of the path [rad/m]
   contains
      procedure :: foresee
      procedure :: move
      procedure :: correct
      procedure :: settle
   end type path_t

   !> A free tip: its way, what drives it, and what has stopped it.
   type, extends(path_t) :: tip_t
      integer(ik) :: fracture = 0  !< in the network
      integer(ik) :: end = 0  !< 1: start of the polyline, 2: its end
      logical :: arrested = .false.  !< it will not grow again
      integer(ik) :: target = target_none  !< what has arrested it: a fracture, or of growth_targets
      logical :: joined = .false.  !< it has joined that; else it has stopped short of it
      integer(ik) :: heads_for = target_none  !< what the last piece of its path ends on
      logical :: is_free = .true.  !< it is the end of a crack still; no joint has been made at it
      logical :: is_shut = .false.  !< the faces behind it stick: K = 0, without evaluation
      logical :: is_carried = .false.  !< its intensities are those of an earlier state
      ! Before the last increment of any tip.
      logical, private :: was_arrested = .false., was_free = .true.
      real(rk) :: rosette_radius = 0.0_rk  !< of the mesh around it [m]
      !> With viscous fluid: what K would have to be without viscosity for the same opening at a
      !! distance of a coarse cell, over the toughness [-]
      real(rk) :: viscous_rise = 1.0_rk
      type(intensity_t) :: intensity  !< at the present tip
      type(growth_drive_t) :: drive
      !> A small share of the K that the loads may bring about at the tip: a toughness below is no
      !! scale for K_eq [Pa m^1/2]
      real(rk) :: least_scale = 0.0_rk
      type(intensity_t) :: intensity_before  !< before the last increment of any tip
      type(growth_drive_t) :: drive_before
   contains
      procedure :: begin_increment
      procedure :: resist
      procedure :: cease
      procedure :: has_just_stopped
      procedure :: scale_of
      procedure :: excess
      procedure :: relative_error
      procedure :: has_state
      procedure :: is_loaded
      procedure :: shut
      procedure :: carry
   end type tip_t

   !> By how much a kink by the criterion's angle changes that angle, where nothing is known yet: as
   !! much for a short step under no stress along the crack, more with common steps and stresses.
   real(rk), parameter :: usual_answer = 2.0_rk
   real(rk), parameter :: radian = 1.0_rk  !< the unit of kinks [rad]
   !> Kinks so near to each other tell nothing about the slope between them [rad].
   real(rk), parameter :: too_near = 0.003_rk

contains

   !> The tip has not grown yet, and is as before the increment.
   elemental subroutine begin_increment(self)
      class(tip_t), intent(inout) :: self

      self%advance = 0.0_rk
      self%intensity_before = self%intensity
      self%drive_before = self%drive
      self%was_arrested = self%arrested
      self%was_free = self%is_free
   end subroutine begin_increment

   !> The rock has its own toughness: what drives the tip counts in terms of it.
   elemental subroutine resist(self, resistance)
      class(tip_t), intent(inout) :: self
      real(rk), intent(in) :: resistance  !< K_IC here over that of the scene's rock [-]

      self%drive%resistance = resistance
      self%drive%intensity = self%drive%intensity/resistance
   end subroutine resist

   !> There is no tip any more, and no intensities are.
   elemental subroutine cease(self)
      class(tip_t), intent(inout) :: self

      self%arrested = .true.
      self%is_free = .false.
      self%intensity = intensity_t()
      self%drive = growth_drive_t()
   end subroutine cease

   !> The intensity by which excesses over the toughness are judged [Pa m^1/2].
   elemental real(rk) function scale_of(self, toughness)
      class(tip_t), intent(in) :: self
      real(rk), intent(in) :: toughness  !< K_IC [Pa m^1/2]

      scale_of = max(toughness, self%least_scale)
   end function scale_of

   !> K_eq less K_IC, over the scale [-].
   elemental real(rk) function excess(self, toughness)
      class(tip_t), intent(in) :: self
      real(rk), intent(in) :: toughness  !< K_IC [Pa m^1/2]

      associate (scale => self%scale_of(toughness))
         excess = self%drive%intensity/scale - toughness/scale
      end associate
   end function excess

   !> Estimated error of K_eq, over the scale [-].
   elemental real(rk) function relative_error(self, toughness)
      class(tip_t), intent(in) :: self
      real(rk), intent(in) :: toughness  !< K_IC [Pa m^1/2]

      relative_error = max(self%intensity%k1_error, self%intensity%k2_error) &
                       /(self%scale_of(toughness)*self%drive%resistance)
   end function relative_error

   !> In the last increment it has come to something that it does not join.
   elemental logical function has_just_stopped(self)
      class(tip_t), intent(in) :: self

      has_just_stopped = self%target /= target_none .and. .not. self%joined &
                         .and. .not. self%was_arrested
   end function has_just_stopped

   !> A tip with intensities to be evaluated.
   elemental logical function is_loaded(self)
      class(tip_t), intent(in) :: self

      is_loaded = self%is_free .and. .not. (self%is_shut .or. self%is_carried)
   end function is_loaded

   !> The faces behind the tip stick, and have never moved: nothing drives it.
   elemental subroutine shut(self)
      class(tip_t), intent(inout) :: self
      real(rk) :: resistance

      self%is_shut = .true.
      self%intensity = intensity_t()
      resistance = self%drive%resistance
      self%drive = growth_drive_t(resistance=resistance, crack_modulus=self%drive%crack_modulus)
   end subroutine shut

   !> The intensities of an earlier state, whose errors grow by what they have changed since.
   elemental subroutine carry(self, intensity, change)
      class(tip_t), intent(inout) :: self
      type(intensity_t), intent(in) :: intensity  !< as evaluated then
      real(rk), intent(in) :: change  !< of both intensities since, relative [-]
      real(rk) :: added

      self%is_carried = .true.
      self%intensity = intensity
      added = change*hypot(intensity%k1, intensity%k2)
      self%intensity%k1_error = intensity%k1_error + added
      self%intensity%k2_error = intensity%k2_error + added
   end subroutine carry

   !> There is a tip to speak of: now, or before the last increment.
   elemental logical function has_state(self, is_before)
      class(tip_t), intent(in) :: self
      logical, intent(in) :: is_before

      has_state = merge(self%was_free, self%is_free, is_before)
   end function has_state

   !> The kink with which the drive will probably vanish at the end of the next increment: for what
   !! the last one has left, and with as much curvature again as it had.
   pure subroutine foresee(self, drive_angle, drive, strength, advance, kink)
      class(path_t), intent(inout) :: self
      real(rk), intent(in) :: drive_angle  !< kink angle of the criterion at the tip [rad]
      real(rk), intent(in) :: drive  !< -K_II there [Pa sqrt(m)]
      real(rk), intent(in) :: strength  !< K_eq there [Pa sqrt(m)]
      real(rk), intent(in) :: advance  !< of the next increment [m]
      real(rk), intent(out) :: kink  !< anticlockwise [rad]
      real(rk), parameter :: most = 0.2_rk  ! that curvature may add [rad]

      self%start_drive = drive
      self%strength = strength
      kink = in_grains(drive_angle, radian)
      if (.not. self%has_wing) return
      kink = drive_angle/usual_answer
      if (self%falls > 0.0_rk) kink = drive/(self%falls*strength)
      kink = max(-abs(drive_angle), min(abs(drive_angle), kink)) &
             + max(-most, min(most, self%curvature*advance))
      kink = in_grains(kink, radian)
   end subroutine foresee

   !> Grow straight to a new place.
   pure subroutine move(self, to, kink)
      class(path_t), intent(inout) :: self
      real(rk), intent(in) :: to(2)  !< [m]
      real(rk), intent(in) :: kink  !< anticlockwise [rad]

      self%origin = self%xy
      self%heading = self%direction
      self%advance = norm2(to - self%xy)
      self%direction = (to - self%xy)/self%advance
      self%xy = to
      self%kink = kink
      self%tries = 0
      self%is_bracketed = .false.
   end subroutine move

   !> Turn the last advance so that the drive at its new end vanishes: one step of the Illinois
   !! method, which keeps the right direction between two tries. The direction is right where the
   !! kink angle of the criterion is small, or where the slope of the drive says that the kink is
   !! known well enough: at closed faces that angle is never small.
   pure subroutine correct(self, drive_angle, drive, has_turned)
      class(path_t), intent(inout) :: self
      real(rk), intent(in) :: drive_angle  !< kink angle of the criterion at the new end [rad]
      real(rk), intent(in) :: drive  !< -K_II there [Pa sqrt(m)]
      logical, intent(out) :: has_turned
      real(rk), parameter :: enough = 0.035_rk  ! two degrees
      real(rk), parameter :: narrow = 0.005_rk  ! bracket [rad]
      real(rk), parameter :: largest = 1.23_rk  ! pure sliding [rad]
      real(rk), parameter :: longest = 0.6_rk  ! step [rad]
      real(rk) :: kink, slope, usual_slope

      has_turned = .false.
      if (.not. (self%advance > 0.0_rk .and. self%has_wing)) return
      if (.not. abs(drive_angle) > enough) return
      call learn(self, drive)
      if (self%is_bracketed .and. drive*self%tried_drive(2) > 0.0_rk) then
         self%tried_drive(1) = 0.5_rk*self%tried_drive(1)
      else
         self%tried_kink(1) = self%tried_kink(2)
         self%tried_drive(1) = self%tried_drive(2)
      end if
      self%tried_kink(2) = self%kink
      self%tried_drive(2) = drive
      self%tries = self%tries + 1
      usual_slope = -usual_answer*drive/drive_angle
      slope = usual_slope
      if (self%falls > 0.0_rk) then
         slope = -self%falls*self%strength
         if (abs(drive) <= -0.5_rk*narrow*slope) return
      end if
      if (self%tries > 1) then
         self%is_bracketed = self%tried_drive(1)*self%tried_drive(2) < 0.0_rk
         associate (between => self%tried_kink(2) - self%tried_kink(1))
            if (self%is_bracketed .and. abs(between) < narrow) return
            if (abs(between) > too_near) slope = (self%tried_drive(2) - self%tried_drive(1))/between
         end associate
      end if
      ! A drive that does not fall with the kink tells nothing: then turn as the criterion says.
      if (.not. slope < 0.1_rk*usual_slope) slope = usual_slope
      kink = self%kink - max(-longest, min(longest, drive/slope))
      kink = in_grains(min(largest, max(-largest, kink)), radian)
      if (.not. abs(kink - self%kink) > 0.0_rk) return
      self%xy = new_tip(self%origin, self%heading, kink, self%advance)
      self%direction = (self%xy - self%origin)/self%advance
      self%kink = kink
      has_turned = .true.
   end subroutine correct

   !> How the drive answers to the kink, from the present and the last try.
   pure subroutine learn(self, drive)
      class(path_t), intent(inout) :: self
      real(rk), intent(in) :: drive  !< [Pa sqrt(m)]

      if (self%tries == 0 .or. .not. self%strength > 0.0_rk) return
      associate (between => self%kink - self%tried_kink(2))
         if (.not. abs(between) > too_near) return
         if ((drive - self%tried_drive(2))/between < 0.0_rk) then
            self%falls = (self%tried_drive(2) - drive)/(between*self%strength)
         end if
      end associate
   end subroutine learn

   !> The last increment stays as it is: learn from it.
   pure subroutine settle(self, drive)
      class(path_t), intent(inout) :: self
      real(rk), intent(in) :: drive  !< -K_II at the new end [Pa sqrt(m)]

      if (.not. self%advance > 0.0_rk) return
      if (self%has_wing) then
         call learn(self, drive)
         self%curvature = self%kink/self%advance
         if (self%falls > 0.0_rk) then
            self%curvature = (self%kink + (drive - self%start_drive) &
                              /(self%falls*self%strength))/self%advance
         end if
      end if
      self%has_wing = .true.
   end subroutine settle

end module growth_tip
