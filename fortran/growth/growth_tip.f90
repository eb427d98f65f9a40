!> A free tip of a growing network, for both levels: the position of a growing fracture end, the
!! straight continuation of the path, and the driving force.
!!
!!
!! A tip kinks by the angle of the largest tangential stress. With a large T-stress this angle is
!! right only for steps shorter than about (K_I/T)^2 (T: the stress parallel to the crack minus the
!! stress normal to the crack; Cotterell and Rice 1980): longer explicit steps overshoot to
!! alternate sides, with increasing amplitude. Each step except the first kink of a fracture's end
!! is therefore corrected until the kink angle at the new tip vanishes, that is, until the criterion
!! holds at the end of the step (backward Euler for the path; local symmetry).
module growth_tip
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use fine_tip_types, only: intensity_t
   use growth_law, only: growth_drive_t, in_grains, new_tip
   use growth_targets, only: target_none
   implicit none(type, external)
   private

   public :: path_t, tip_t

   !> Path of a free tip. The drive is -K_II, which has the sign of the kink angle of the criterion
   !! and is nearly linear in the kink, even where the kink angle saturates: at closed faces, and
   !! with a large T-stress.
   type :: path_t
      real(rk) :: xy(2) = 0.0_rk  !< position [m]
      real(rk) :: direction(2) = 0.0_rk  !< unit vector ahead
      real(rk) :: carried = 0.0_rk  !< advance too short for the mesh, carried over [m]
      real(rk) :: advance = 0.0_rk  !< advance in the last increment; 0: none [m]
      real(rk) :: kink = 0.0_rk  !< kink angle of the last increment, anticlockwise [rad]
      !> position [m] and unit vector before the last increment
      real(rk) :: origin(2) = 0.0_rk, heading(2) = 0.0_rk
      logical :: has_wing = .false.  !< the fracture end has grown before
      !> length of the last segment where no target lay ahead; huge: there is none [m]
      real(rk) :: stride = huge(1.0_rk)
      ! Last two iterates of `correct` [rad], [Pa sqrt(m)].
      real(rk), private :: tried_kink(2) = 0.0_rk, tried_drive(2) = 0.0_rk
      integer, private :: tries = 0
      logical, private :: is_bracketed = .false.  !< the iterates bracket the root
      ! Data of earlier increments, for the prediction of the next one.
      real(rk), private :: falls = 0.0_rk  !< -d(drive)/d(kink) over `strength`; 0: unknown [1/rad]
      real(rk), private :: strength = 0.0_rk  !< K_eq at the start of the increment [Pa sqrt(m)]
      real(rk), private :: start_drive = 0.0_rk  !< drive at the start of the increment [Pa sqrt(m)]
      real(rk), private :: curvature = 0.0_rk  !< curvature of the path [rad/m]
   contains
      procedure :: predict
      procedure :: move
      procedure :: shorten
      procedure :: correct
      procedure :: commit
   end type path_t

   !> A free tip: path, driving force, and target.
   type, extends(path_t) :: tip_t
      integer(ik) :: fracture = 0  !< in the network
      integer(ik) :: end = 0  !< 1: start of the polyline, 2: its end
      logical :: arrested = .false.  !< it will not grow again
      integer(ik) :: target = target_none  !< what has arrested it: a fracture, or of growth_targets
      logical :: joined = .false.  !< it has joined that; else it has stopped short of it
      integer(ik) :: path_target = target_none  !< what the last piece of its path ends on
      logical :: is_free = .true.  !< it is the end of a crack still; no joint has been made at it
      logical :: is_shut = .false.  !< the faces behind it stick: K = 0, without evaluation
      logical :: is_carried = .false.  !< its intensities are those of an earlier state
      ! Before the last increment of any tip.
      logical, private :: was_arrested = .false., was_free = .true.
      real(rk) :: rosette_radius = 0.0_rk  !< of the mesh around it [m]
      !> With viscous fluid: what K would have to be without viscosity for the same opening at a
      !! distance of a coarse cell, over the toughness [-]
      real(rk) :: viscous_rise = 1.0_rk
      !> age of a layer of fluid pressure at a tip that has moved; huge: that of its cell [s]
      real(rk) :: layer_age = huge(1.0_rk)
      type(intensity_t) :: intensity  !< at the present tip
      type(growth_drive_t) :: drive
      !> A small share of the K that the loads may bring about at the tip: a toughness below is no
      !! scale for K_eq [Pa m^1/2]
      real(rk) :: least_scale = 0.0_rk
      !> stress intensity factors before the last increment of any tip
      type(intensity_t) :: intensity_before
      type(growth_drive_t) :: drive_before
   contains
      procedure :: begin_increment
      procedure :: resist
      procedure :: deactivate
      procedure :: has_just_stopped
      procedure :: scale_of
      procedure :: excess
      procedure :: relative_error
      procedure :: certain_share
      procedure :: predict_path
      procedure :: has_state
      procedure :: is_loaded
      procedure :: is_viscous
      procedure :: has_viscous_layer
      procedure :: shut
      procedure :: carry
   end type tip_t

   !> Assumed change of the criterion's angle per kink by that angle, without data of earlier
   !! increments [-]. The exact value is 2 for a short step without T-stress, more for usual steps
   !! and stresses.
   real(rk), parameter :: usual_answer = 2.0_rk
   real(rk), parameter :: radian = 1.0_rk  !< unit of kink angles [rad]
   !> Difference of two kinks below which the slope between them is not used [rad].
   real(rk), parameter :: too_near = 0.003_rk

contains

   !> Store the state of the tip before an increment.
   elemental subroutine begin_increment(self)
      class(tip_t), intent(inout) :: self

      self%advance = 0.0_rk
      self%intensity_before = self%intensity
      self%drive_before = self%drive
      self%was_arrested = self%arrested
      self%was_free = self%is_free
   end subroutine begin_increment

   !> Scale K_eq by the toughness of the rock at the tip.
   elemental subroutine resist(self, resistance)
      class(tip_t), intent(inout) :: self
      real(rk), intent(in) :: resistance  !< K_IC at the tip over K_IC of the scene [-]

      self%drive%resistance = resistance
      self%drive%intensity = self%drive%intensity/resistance
   end subroutine resist

   !> Deactivate the tip and clear its intensities.
   elemental subroutine deactivate(self)
      class(tip_t), intent(inout) :: self

      self%arrested = .true.
      self%is_free = .false.
      self%intensity = intensity_t()
      self%drive = growth_drive_t()
   end subroutine deactivate

   !> Scale of the excess over the toughness, over the resistance as K_eq [Pa m^1/2].
   elemental real(rk) function scale_of(self, toughness)
      class(tip_t), intent(in) :: self
      real(rk), intent(in) :: toughness  !< K_IC of the scene's rock [Pa m^1/2]

      scale_of = max(toughness, self%least_scale/self%drive%resistance)
   end function scale_of

   !> K_eq minus K_IC, over the scale; in rock that is hardly tough only what is certain [-].
   elemental real(rk) function excess(self, toughness)
      class(tip_t), intent(in) :: self
      real(rk), intent(in) :: toughness  !< K_IC [Pa m^1/2]
      real(rk), parameter :: hardly = 0.1_rk  ! of the scale

      associate (scale => self%scale_of(toughness))
         excess = self%drive%intensity/scale - toughness/scale
         if (excess > 0.0_rk .and. toughness < hardly*scale) excess = excess*self%certain_share()
      end associate
   end function excess

   !> Estimated error of K_eq, over the scale [-].
   elemental real(rk) function relative_error(self, toughness)
      class(tip_t), intent(in) :: self
      real(rk), intent(in) :: toughness  !< K_IC [Pa m^1/2]

      relative_error = max(self%intensity%k1_error, self%intensity%k2_error) &
                       /(self%scale_of(toughness)*self%drive%resistance)
   end function relative_error

   !> Whether viscosity decides on the growth of a tip.
   elemental logical function is_viscous(self)
      class(tip_t), intent(in) :: self
      real(rk), parameter :: considerable = 1.2_rk

      is_viscous = self%viscous_rise > considerable
   end function is_viscous

   !> Whether viscosity matters for the growth of a tip.
   elemental logical function has_viscous_layer(self)
      class(tip_t), intent(in) :: self
      real(rk), parameter :: noticeable = 1.03_rk

      has_viscous_layer = self%viscous_rise > noticeable
   end function has_viscous_layer

   !> Weight of what K_I and K_II demand: 1 where they are known to half of their values; 0 where
   !! they do not exceed their errors, as at closed wings: the path goes straight ahead, and in rock
   !! that is hardly tough the tip stays [-].
   elemental real(rk) function certain_share(self)
      class(tip_t), intent(in) :: self
      real(rk) :: known

      associate (k => self%intensity)
         known = max(hypot(k%k1, k%k2), self%drive%intensity*self%drive%resistance)
         certain_share = 0.0_rk
         if (.not. known > 0.0_rk) return
         certain_share = max(0.0_rk, min(1.0_rk, 2.0_rk - 2.0_rk*hypot(k%k1_error, k%k2_error) &
                                         /known))
      end associate
   end function certain_share

   !> Predict the kink of the next increment from the present intensities.
   pure subroutine predict_path(self, advance, kink)
      class(tip_t), intent(inout) :: self
      real(rk), intent(in) :: advance  !< length of the increment [m]
      real(rk), intent(out) :: kink  !< anticlockwise [rad]

      associate (share => self%certain_share())
         call self%predict(share*self%drive%angle, -share*self%intensity%k2, &
                           self%drive%intensity, advance, kink)
      end associate
   end subroutine predict_path

   !> Whether the tip has stopped before a target in the last increment.
   elemental logical function has_just_stopped(self)
      class(tip_t), intent(in) :: self

      has_just_stopped = self%target /= target_none .and. .not. self%joined &
                         .and. .not. self%was_arrested
   end function has_just_stopped

   !> Whether the intensities of the tip are to be evaluated.
   elemental logical function is_loaded(self)
      class(tip_t), intent(in) :: self

      is_loaded = self%is_free .and. .not. (self%is_shut .or. self%is_carried)
   end function is_loaded

   !> Set the driving force to zero: the faces behind the tip stick, and have never moved.
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

   !> Predict the kink with which the drive vanishes at the end of the next increment: it cancels
   !! the remaining drive and continues the curvature of the last increment.
   pure subroutine predict(self, drive_angle, drive, strength, advance, kink)
      class(path_t), intent(inout) :: self
      real(rk), intent(in) :: drive_angle  !< kink angle of the criterion at the tip [rad]
      real(rk), intent(in) :: drive  !< -K_II at the tip [Pa sqrt(m)]
      real(rk), intent(in) :: strength  !< K_eq at the tip [Pa sqrt(m)]
      real(rk), intent(in) :: advance  !< length of the next increment [m]
      real(rk), intent(out) :: kink  !< anticlockwise [rad]
      real(rk), parameter :: most = 0.2_rk  ! limit of the curvature term [rad]

      self%start_drive = drive
      self%strength = strength
      kink = in_grains(drive_angle, radian)
      if (.not. self%has_wing) return
      kink = drive_angle/usual_answer
      if (self%falls > 0.0_rk) kink = drive/(self%falls*strength)
      kink = max(-abs(drive_angle), min(abs(drive_angle), kink)) &
             + max(-most, min(most, self%curvature*advance))
      kink = in_grains(kink, radian)
   end subroutine predict

   !> Advance straight to a new position.
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

   !> Halve the last advance, in the same direction.
   pure subroutine shorten(self, times)
      class(path_t), intent(inout) :: self
      integer, intent(in) :: times

      self%advance = 0.5_rk**times*self%advance
      self%xy = self%origin + self%advance*self%direction
      self%tries = 0
      self%is_bracketed = .false.
   end subroutine shorten

   !> Rotate the last advance so that the drive at its new end vanishes: one step of the Illinois
   !! method, which keeps a bracket of the root. The direction is accepted where the kink angle of
   !! the criterion is small, or where the slope of the drive shows that the error of the kink is
   !! small: at closed faces the angle of the criterion is never small.
   pure subroutine correct(self, drive_angle, drive, has_turned)
      class(path_t), intent(inout) :: self
      real(rk), intent(in) :: drive_angle  !< kink angle of the criterion at the new end [rad]
      real(rk), intent(in) :: drive  !< -K_II at the new end [Pa sqrt(m)]
      logical, intent(out) :: has_turned
      real(rk), parameter :: enough = 0.035_rk  ! two degrees
      real(rk), parameter :: narrow = 0.005_rk  ! bracket [rad]
      real(rk), parameter :: largest = 1.23_rk  ! pure sliding [rad]
      real(rk), parameter :: longest = 0.6_rk  ! step [rad]
      real(rk) :: kink, slope, usual_slope

      has_turned = .false.
      if (.not. (self%advance > 0.0_rk .and. self%has_wing)) return
      if (.not. abs(drive_angle) > enough) return
      call update_slope(self, drive)
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
      ! Where the drive does not fall with the kink, the slope of the criterion is used.
      if (.not. slope < 0.1_rk*usual_slope) slope = usual_slope
      kink = self%kink - max(-longest, min(longest, drive/slope))
      kink = in_grains(min(largest, max(-largest, kink)), radian)
      if (.not. abs(kink - self%kink) > 0.0_rk) return
      self%xy = new_tip(self%origin, self%heading, kink, self%advance)
      self%direction = (self%xy - self%origin)/self%advance
      self%kink = kink
      has_turned = .true.
   end subroutine correct

   !> Update the derivative of the drive with respect to the kink from the last two iterates.
   pure subroutine update_slope(self, drive)
      class(path_t), intent(inout) :: self
      real(rk), intent(in) :: drive  !< [Pa sqrt(m)]

      if (self%tries == 0 .or. .not. self%strength > 0.0_rk) return
      associate (between => self%kink - self%tried_kink(2))
         if (.not. abs(between) > too_near) return
         if ((drive - self%tried_drive(2))/between < 0.0_rk) then
            self%falls = (self%tried_drive(2) - drive)/(between*self%strength)
         end if
      end associate
   end subroutine update_slope

   !> Commit the last increment, and update the curvature.
   pure subroutine commit(self, drive, stride)
      class(path_t), intent(inout) :: self
      real(rk), intent(in) :: drive  !< -K_II at the new end [Pa sqrt(m)]
      real(rk), intent(in) :: stride  !< advance where no target lies ahead [m]

      if (.not. self%advance > 0.0_rk) return
      self%stride = stride
      if (self%has_wing) then
         call update_slope(self, drive)
         self%curvature = self%kink/self%advance
         if (self%falls > 0.0_rk) then
            self%curvature = (self%kink + (drive - self%start_drive) &
                              /(self%falls*self%strength))/self%advance
         end if
      end if
      self%has_wing = .true.
   end subroutine commit

end module growth_tip
