!> Which tips grow as one: those that have come equally far, and that nothing but the errors of
!! their meshes tells from each other. Else the last bits of the meshes would decide which of them
!! runs ahead where nothing else does.
module growth_company
   use base_kinds, only: ik, rk
   use growth_kinds, only: likes, numbered
   use growth_rivals, only: rivals_t
   implicit none(type, external)
   private

   public :: company_t, could_part, lags_behind

   !> Share of an increment within which tips have come equally far [-].
   real(rk), parameter :: same_gain = 0.02_rk

   !> Errors of the intensities that do not tell tips from each other, over K_IC [-].
   real(rk), parameter :: same_drive = 0.01_rk

   !> The same for tips that have grown equally far so far, of what each had in the mean over the
   !! last pieces of its path: their paths differ by what their meshes do, which changes their
   !! intensities by more than the errors of these, now one way and now the other [-].
   real(rk), parameter :: in_company = 0.03_rk

   !> Increments over which that mean reaches back [-].
   real(rk), parameter :: memory = 2.0_rk

   !> Tips could part where a lead of one increment changes K_eq/K_IC by more than this: that is
   !! measured with a lead of two fifths (twolevel_probe), which has to be worth twice what does not
   !! tell tips from each other [-].
   real(rk), parameter :: could_part = 5.0_rk*same_drive

   !> What a tip in company may lack of its toughness where it comes to rest: new pieces and their
   !! meshes throw it back by some per cent [-].
   real(rk), parameter :: by_chance = 0.1_rk

   !> Tips on their way, and the company that they have kept so far.
   type :: company_t
      integer(ik), allocatable :: kind(:)  !< (tips) those of one have gone equally far
      real(rk), allocatable :: usual(:)  !< (tips) mean of K_eq/K_IC on the way
      logical, allocatable :: is_alone(:)  !< (tips) has lagged behind its company
   contains
      procedure :: find_kinds
      procedure :: part
      procedure :: accept
   end type company_t

contains

   !> The kinds of the tips, from 1, in an accepted state. Tips of one kind shall go on equally far.
   subroutine find_kinds(self, drive, off, gain, is_arrested, increment, rivals, kind)
      class(company_t), intent(inout) :: self
      real(rk), intent(in) :: drive(:)  !< K_eq/K_IC of the tips [-]
      real(rk), intent(in) :: off(:)  !< how well that is known [-]
      real(rk), intent(in) :: gain(:)  !< how far they have come [m]
      logical, intent(in) :: is_arrested(:)
      real(rk), intent(in) :: increment  !< [m]
      type(rivals_t), intent(in) :: rivals
      integer(ik), intent(out) :: kind(:)
      logical :: alike(size(drive), size(drive))
      real(rk) :: apart, least
      integer(ik) :: i, j

      if (.not. allocated(self%usual)) self%usual = drive
      if (.not. allocated(self%is_alone)) allocate (self%is_alone(size(drive)), source=.false.)
      where (.not. gain > 0.0_rk) self%usual = drive
      do j = 1, size(drive, kind=ik)
         do i = 1, size(drive, kind=ik)
            apart = abs(drive(i) - drive(j))
            least = same_drive
            if (keep_company(self, i, j, gain(i), rivals, increment)) then
               apart = abs(self%usual(i) - self%usual(j))
               least = in_company
            end if
            alike(i, j) = apart <= max(least, hypot(off(i), off(j))) .and. &
                          abs(gain(i) - gain(j)) <= same_gain*increment .and. &
                          .not. (is_arrested(i) .or. is_arrested(j)) .and. &
                          .not. any(self%is_alone([i, j]))
         end do
      end do
      kind = numbered(likes(alike))
      self%kind = kind
   end subroutine find_kinds

   !> Two tips have grown, equally far, and neither would run ahead if it got a lead: what parts
   !! them then is chance.
   pure logical function keep_company(self, i, j, gain, rivals, increment)
      class(company_t), intent(in) :: self
      integer(ik), intent(in) :: i, j
      real(rk), intent(in) :: gain  !< of the first [m]
      type(rivals_t), intent(in) :: rivals
      real(rk), intent(in) :: increment  !< [m]

      keep_company = .false.
      if (.not. allocated(self%kind) .or. i == j) return
      if (self%kind(i) /= self%kind(j) .or. .not. gain > 0.0_rk) return
      keep_company = rivals%preference_of([i, j])*increment <= could_part
   end function keep_company

   !> A tip that has come to rest lacks so much of its toughness that it has not got there by
   !! itself: it has no share in what drives those that it has been like so far.
   elemental logical function lags_behind(excess, off)
      real(rk), intent(in) :: excess  !< of K_eq over K_IC [-]
      real(rk), intent(in) :: off  !< how well that is known [-]

      lags_behind = excess < -max(by_chance, off)
   end function lags_behind

   !> A tip has lagged behind: it is like no other from now on.
   pure subroutine part(self, tip)
      class(company_t), intent(inout) :: self
      integer(ik), intent(in) :: tip

      self%is_alone(tip) = .true.
   end subroutine part

   !> A step is accepted.
   subroutine accept(self, drive, advance, increment)
      class(company_t), intent(inout) :: self
      real(rk), intent(in) :: drive(:)  !< K_eq/K_IC of the tips [-]
      real(rk), intent(in) :: advance(:)  !< of them in the step [m]
      real(rk), intent(in) :: increment  !< [m]

      self%usual = self%usual + min(1.0_rk, advance/(memory*increment))*(drive - self%usual)
   end subroutine accept

end module growth_company
