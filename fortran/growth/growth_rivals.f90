!> The tip interaction matrix: the derivatives of the intensities with respect to the positions of
!! all tips, with the fluid volume of the time step fixed. It is measured tip by tip and improved by
!! Broyden updates in each try. It shows whether tips that grow together could separate, and gives
!! their equilibrium positions.
!!
!! Tip groups: tips that have advanced equally far and differ only by the errors of their meshes.
!! Without groups, rounding in the meshes would determine which of them runs ahead.
module growth_rivals
   use base_kinds, only: ik, rk
   use growth_competition, only: learn_from_trial, likes, matrix_of_kinds, numbered, preference
   use growth_segment, only: segment_t
   implicit none(type, external)
   private

   public :: company_t, could_part, lags_behind, rivals_t

   !> What has been measured for a tip holds until it has gone so many lengths of its piece on.
   real(rk), parameter :: holds_for = 8.0_rk

   !> Share of the last measurement of a tip in the mean with the earlier ones: each errs by some
   !! per cent of K_IC per increment.
   real(rk), parameter :: fresh = 0.5_rk

   !> Share of a piece that a tip has gone along where it is measured.
   real(rk), parameter :: half_way = 0.5_rk

   !> A try teaches where it errs by more than this from what was to be expected: less may be the
   !! errors of the meshes [-].
   real(rk), parameter :: noticeable = 0.01_rk

   !> What is known of the tips.
   type :: rivals_t
      real(rk), allocatable :: measured(:, :)  !< (tips, tips) mean of d(K_eq,i/K_IC)/da_j [1/m]
      real(rk), allocatable :: matrix(:, :)  !< as measured last, with what tries have taught
      logical, allocatable :: is_known(:)  !< (tips) columns of it
      real(rk), allocatable :: known_at(:)  !< (tips) gain of each then [m]
   contains
      procedure :: begin
      procedure :: has_to_ask
      procedure :: note
      procedure :: learn
      procedure :: preference_of
      procedure :: matrix_for
   end type rivals_t

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
      real(rk), allocatable :: usual(:)  !< (tips) mean of their excesses on the way [-]
      logical, allocatable :: is_alone(:)  !< (tips) has lagged behind its company
   contains
      procedure :: find_kinds
      procedure :: part
      procedure :: accept
   end type company_t

contains

   !> Nothing is known of any tip.
   subroutine begin(self, n)
      class(rivals_t), intent(out) :: self
      integer, intent(in) :: n  !< tips

      allocate (self%matrix(n, n), self%measured(n, n), self%known_at(n), source=0.0_rk)
      allocate (self%is_known(n), source=.false.)
   end subroutine begin

   !> The tips of a group whose columns are to be measured: not near the start of a piece, where its
   !! kink and what the mesh can hold there decide.
   pure function has_to_ask(self, group, segment) result(asked)
      class(rivals_t), intent(in) :: self
      integer(ik), intent(in) :: group(:)  !< tips
      type(segment_t), intent(in) :: segment(:)  !< (tips)
      integer(ik), allocatable :: asked(:)

      asked = pack(group, segment(group)%reached >= half_way*segment(group)%length .and. &
                   (.not. self%is_known(group) .or. segment(group)%gain &
                    - self%known_at(group) > holds_for*segment(group)%length))
   end function has_to_ask

   !> A tip by itself has been moved, the others not.
   pure subroutine note(self, tip, moved, before, after, segment)
      class(rivals_t), intent(inout) :: self
      integer(ik), intent(in) :: tip
      real(rk), intent(in) :: moved  !< [m]
      real(rk), intent(in) :: before(:), after(:)  !< (tips) excess of K_eq over K_IC [-]
      type(segment_t), intent(in) :: segment  !< of that tip

      self%matrix(:, tip) = (after - before)/moved
      associate (share => merge(fresh, 1.0_rk, self%is_known(tip)))
         self%measured(:, tip) = share*self%matrix(:, tip) + (1.0_rk - share)*self%measured(:, tip)
      end associate
      self%is_known(tip) = .true.
      self%known_at(tip) = segment%gain
   end subroutine note

   !> Tips have been moved from where they were.
   pure subroutine learn(self, moved, outcome)
      class(rivals_t), intent(inout) :: self
      real(rk), intent(in) :: moved(:)  !< (tips) [m]
      real(rk), intent(in) :: outcome(:)  !< (tips) change of K_eq over K_IC [-]
      real(rk), allocatable :: matrix(:, :)
      integer(ik), allocatable :: known(:)
      integer(ik) :: i

      if (any(abs(moved) > 0.0_rk .and. .not. self%is_known)) return
      if (.not. any(abs(outcome - matmul(self%matrix, moved)) > noticeable)) return
      known = pack([(i, i=1, size(moved, kind=ik))], self%is_known)
      matrix = self%matrix(known, known)
      call learn_from_trial(matrix, moved(known), outcome(known))
      self%matrix(known, known) = matrix
   end subroutine learn

   !> How much the lead of one tip of a group over the others drives it on, at the most [1/m].
   !! Negative: they grow together.
   pure real(rk) function preference_of(self, group)
      class(rivals_t), intent(in) :: self
      integer(ik), intent(in) :: group(:)  !< tips

      preference_of = -huge(1.0_rk)
      if (.not. all(self%is_known(group))) return
      preference_of = preference(self%measured(group, group), spread(1.0_rk, 1, size(group)))
   end function preference_of

   !> Influence of the advances of kinds on the excess of each.
   pure function matrix_for(self, group, kind, segment) result(matrix)
      class(rivals_t), intent(in) :: self
      integer(ik), intent(in) :: group(:)  !< tips
      integer(ik), intent(in) :: kind(:)  !< of each, from 1
      type(segment_t), intent(in) :: segment(:)  !< (kinds)
      real(rk) :: matrix(size(segment), size(segment))  !< d(K_eq,k/K_IC)/da_l [1/m]
      integer :: k

      matrix = matrix_of_kinds(kind, self%matrix(group, group))
      do k = 1, size(segment)
         if (.not. all(pack(self%is_known(group), kind == k))) then
            matrix(k, k) = segment(k)%falling_slope()
         end if
      end do
   end function matrix_for

   !> The kinds of the tips, from 1, in an accepted state. Tips of one kind shall go on equally far.
   subroutine find_kinds(self, drive, off, gain, is_arrested, increment, rivals, kind)
      class(company_t), intent(inout) :: self
      real(rk), intent(in) :: drive(:)  !< excess of each tip over its toughness [-]
      real(rk), intent(in) :: off(:)  !< how well that is known [-]
      real(rk), intent(in) :: gain(:)  !< how far they have come [m]
      logical, intent(in) :: is_arrested(:)
      real(rk), intent(in) :: increment(:)  !< of the tips [m]
      type(rivals_t), intent(in) :: rivals
      integer(ik), intent(out) :: kind(:)
      logical :: alike(size(drive), size(drive))
      real(rk) :: apart, least, shorter
      integer(ik) :: i, j

      if (.not. allocated(self%usual)) self%usual = drive
      if (.not. allocated(self%is_alone)) allocate (self%is_alone(size(drive)), source=.false.)
      where (.not. gain > 0.0_rk) self%usual = drive
      do j = 1, size(drive, kind=ik)
         do i = 1, size(drive, kind=ik)
            apart = abs(drive(i) - drive(j))
            least = same_drive
            shorter = min(increment(i), increment(j))
            if (keep_company(self, i, j, gain(i), rivals, shorter)) then
               apart = abs(self%usual(i) - self%usual(j))
               least = in_company
            end if
            alike(i, j) = apart <= max(least, hypot(off(i), off(j))) .and. &
                          abs(gain(i) - gain(j)) <= same_gain*shorter .and. &
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
      real(rk), intent(in) :: drive(:)  !< excess of each tip over its toughness [-]
      real(rk), intent(in) :: advance(:)  !< of them in the step [m]
      real(rk), intent(in) :: increment(:)  !< of them [m]

      self%usual = self%usual + min(1.0_rk, advance/(memory*increment))*(drive - self%usual)
   end subroutine accept

end module growth_rivals
