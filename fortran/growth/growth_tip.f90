!> A free tip as a growing scene knows it, whichever level evaluates it.
module growth_tip
   use base_kinds, only: ik, rk
   use growth_law, only: growth_drive_t
   use growth_path, only: path_t
   use growth_targets, only: target_none
   use tips_types, only: intensity_t
   implicit none(type, external)
   private

   public :: tip_t

   !> A free tip: its way, what drives it, and what has stopped it.
   type, extends(path_t) :: tip_t
      integer(ik) :: fracture = 0  !< in the network
      integer(ik) :: end = 0  !< 1: start of the polyline, 2: its end
      logical :: arrested = .false.  !< it will not grow again
      integer(ik) :: target = target_none  !< what has arrested it: a fracture, or of growth_targets
      logical :: joined = .false.  !< it has joined that; else it has stopped short of it
      integer(ik) :: heads_for = target_none  !< what the last piece of its path ends on
      logical :: is_free = .true.  !< it is the end of a crack still; no joint has been made at it
      ! Before the last increment of any tip.
      logical, private :: was_arrested = .false., was_free = .true.
      real(rk) :: rosette_radius = 0.0_rk  !< of the mesh around it [m]
      type(intensity_t) :: intensity  !< at the present tip
      type(growth_drive_t) :: drive
      type(intensity_t) :: intensity_before  !< before the last increment of any tip
      type(growth_drive_t) :: drive_before
   contains
      procedure :: begin_increment
      procedure :: resist
      procedure :: cease
      procedure :: has_just_stopped
      procedure :: has_state
   end type tip_t

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

   !> In the last increment it has come to something that it does not join.
   elemental logical function has_just_stopped(self)
      class(tip_t), intent(in) :: self

      has_just_stopped = self%target /= target_none .and. .not. self%joined &
                         .and. .not. self%was_arrested
   end function has_just_stopped

   !> There is a tip to speak of: now, or before the last increment.
   elemental logical function has_state(self, is_before)
      class(tip_t), intent(in) :: self
      logical, intent(in) :: is_before

      has_state = merge(self%was_free, self%is_free, is_before)
   end function has_state

end module growth_tip
