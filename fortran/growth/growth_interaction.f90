!> The tip interaction matrix: the derivatives of the intensities with respect to the positions of
!! all tips, with the fluid volume of the time step fixed. It is measured tip by tip and improved by
!! Broyden updates in each try. It shows whether tips that grow together could separate, and gives
!! their equilibrium positions.
!!
!! Tip groups: tips that have advanced equally far and differ only by the errors of their meshes.
!! Without groups, rounding in the meshes would determine which of them runs ahead.
module growth_interaction
   use base_kinds, only: ik, rk
   use growth_competition, only: broyden_update, likes, matrix_of_groups, numbered, preference
   use growth_segment, only: segment_t
   implicit none(type, external)
   private

   public :: group_tip_t, tip_groups_t, could_separate, lags_behind, interaction_t

   !> Growth of a tip, in lengths of its path segment, after which its column is measured again [-].
   real(rk), parameter :: holds_for = 8.0_rk

   !> Weight of the last measurement in the running mean: each measurement has an error of some per
   !! cent of K_IC per increment [-].
   real(rk), parameter :: fresh = 0.5_rk

   !> Share of the path segment that a tip must have advanced for its column to be measured [-].
   real(rk), parameter :: half_way = 0.5_rk

   !> Error of the predicted excess above which a try leads to a Broyden update: smaller ones may be
   !! errors of the meshes [-].
   real(rk), parameter :: noticeable = 0.01_rk

   !> Tip interaction matrix, and which of its columns have been measured.
   type :: interaction_t
      !> (tips, tips) running mean of d(K_eq,i/K_IC)/da_j [1/m]
      real(rk), allocatable :: measured(:, :)
      !> (tips, tips) last measurement with Broyden updates [1/m]
      real(rk), allocatable :: matrix(:, :)
      logical, allocatable :: is_known(:)  !< (tips) columns that have been measured
      real(rk), allocatable :: known_at(:)  !< (tips) growth of each tip at its last measurement [m]
   contains
      procedure :: begin
      procedure :: columns_to_measure
      procedure :: store_column
      procedure :: update
      procedure :: preference_of
      procedure :: matrix_for
   end type interaction_t

   !> What decides whether tips are equal.
   type :: group_tip_t
      real(rk) :: drive = 0.0_rk  !< excess over the toughness [-]
      real(rk) :: off = 0.0_rk  !< estimated error of the excess [-]
      real(rk) :: gain = 0.0_rk  !< growth [m]
      real(rk) :: increment = 0.0_rk  !< largest length of a path segment [m]
      real(rk) :: segment = 0.0_rk  !< length of the present path segment [m]
      real(rk) :: length = 0.0_rk  !< of the fracture before growth [m]
      logical :: is_arrested = .false.
   end type group_tip_t

   !> Difference of growth within which tips have advanced equally far, in path segments [-].
   real(rk), parameter :: same_gain = 0.02_rk

   !> Difference of lengths of fractures within which they are equal [-].
   real(rk), parameter :: same_length = 1.0e-4_rk

   !> Difference of K_eq within which tips are equal, over the larger of K_eq and K_IC: the error of
   !! the intensities [-].
   real(rk), parameter :: same_drive = 0.01_rk

   !> Lack of toughness, error included, beyond which tips are alone [-].
   real(rk), parameter :: far = 0.5_rk

   !> The same for tips of one group, for means of the excess over the last segments of the paths:
   !! the meshes make their paths differ, which changes the intensities by more than their errors,
   !! with alternating sign [-].
   real(rk), parameter :: same_mean = 0.03_rk

   !> Growth over which the excess is averaged, in increments [-].
   real(rk), parameter :: memory = 2.0_rk

   !> Change of K_eq/K_IC per increment of lead above which tips could separate. It is measured with
   !! a lead of two fifths of an increment (twolevel_probe), which then changes K_eq/K_IC by twice
   !! `same_drive` [-].
   real(rk), parameter :: could_separate = 5.0_rk*same_drive

   !> Deficit of K_eq/K_IC up to which a stopped tip stays in its group: new path segments and their
   !! meshes reduce K_eq by some per cent [-].
   real(rk), parameter :: by_chance = 0.1_rk

   !> Groups of tips that advance equally.
   type :: tip_groups_t
      integer(ik), allocatable :: kind(:)  !< (tips) number of the group, from 1
      real(rk), allocatable :: usual(:)  !< (tips) mean excess over the last increments [-]
      logical, allocatable :: is_alone(:)  !< (tips) has fallen behind its group, and stays alone
   contains
      procedure :: find_groups
      procedure :: remove_tip
      procedure :: differ_by_chance
      procedure :: accept
   end type tip_groups_t

contains

   !> Start without any measurement.
   subroutine begin(self, n)
      class(interaction_t), intent(out) :: self
      integer, intent(in) :: n  !< number of tips

      allocate (self%matrix(n, n), self%measured(n, n), self%known_at(n), source=0.0_rk)
      allocate (self%is_known(n), source=.false.)
   end subroutine begin

   !> Tips of a group whose columns are to be measured. Near the start of a path segment nothing is
   !! measured: there the kink and the shortest advance that the mesh resolves determine the
   !! intensities.
   pure function columns_to_measure(self, group, segment) result(columns)
      class(interaction_t), intent(in) :: self
      integer(ik), intent(in) :: group(:)  !< tip numbers
      type(segment_t), intent(in) :: segment(:)  !< (tips)
      integer(ik), allocatable :: columns(:)

      columns = pack(group, segment(group)%reached >= half_way*segment(group)%length .and. &
                     (.not. self%is_known(group) .or. segment(group)%gain &
                      - self%known_at(group) > holds_for*segment(group)%length))
   end function columns_to_measure

   !> Store the measurement of a column: one tip has been moved, the other tips have not. Rows of
   !! tips that have not been evaluated keep their values.
   pure subroutine store_column(self, tip, moved, before, after, is_evaluated, segment)
      class(interaction_t), intent(inout) :: self
      integer(ik), intent(in) :: tip
      real(rk), intent(in) :: moved  !< displacement of the tip [m]
      real(rk), intent(in) :: before(:), after(:)  !< (tips) excess of K_eq over K_IC [-]
      logical, intent(in) :: is_evaluated(:)  !< (tips)
      type(segment_t), intent(in) :: segment  !< path segment of the tip
      real(rk) :: share

      share = merge(fresh, 1.0_rk, self%is_known(tip))
      where (is_evaluated)
         self%matrix(:, tip) = (after - before)/moved
         self%measured(:, tip) = share*self%matrix(:, tip) + (1.0_rk - share)*self%measured(:, tip)
      end where
      self%is_known(tip) = .true.
      self%known_at(tip) = segment%gain
   end subroutine store_column

   !> Broyden update from a try in which tips have been moved. Rows of tips that have not been
   !! evaluated keep their values.
   pure subroutine update(self, moved, change, is_evaluated)
      class(interaction_t), intent(inout) :: self
      real(rk), intent(in) :: moved(:)  !< (tips) displacements [m]
      real(rk), intent(in) :: change(:)  !< (tips) change of K_eq over K_IC [-]
      logical, intent(in) :: is_evaluated(:)  !< (tips)
      real(rk), allocatable :: matrix(:, :)
      real(rk) :: outcome(size(change))
      integer(ik), allocatable :: known(:)
      integer(ik) :: i

      if (any(abs(moved) > 0.0_rk .and. .not. self%is_known)) return
      outcome = matmul(self%matrix, moved)
      if (.not. any(is_evaluated .and. abs(change - outcome) > noticeable)) return
      where (is_evaluated) outcome = change
      known = pack([(i, i=1, size(moved, kind=ik))], self%is_known)
      matrix = self%matrix(known, known)
      call broyden_update(matrix, moved(known), outcome(known))
      self%matrix(known, known) = matrix
   end subroutine update

   !> Largest change of K_eq/K_IC per length by which one tip leads the others of a group [1/m].
   !! Negative: equal growth is stable.
   pure real(rk) function preference_of(self, group)
      class(interaction_t), intent(in) :: self
      integer(ik), intent(in) :: group(:)  !< tip numbers

      preference_of = -huge(1.0_rk)
      if (.not. all(self%is_known(group))) return
      preference_of = preference(self%measured(group, group), spread(1.0_rk, 1, size(group)))
   end function preference_of

   !> Interaction matrix of the groups of tips, with the slopes that the last search has found.
   !! Without a measurement the diagonal term is a usual slope.
   pure function matrix_for(self, group, kind, segment) result(matrix)
      class(interaction_t), intent(in) :: self
      integer(ik), intent(in) :: group(:)  !< tip numbers
      integer(ik), intent(in) :: kind(:)  !< group of each tip, from 1
      type(segment_t), intent(in) :: segment(:)  !< (groups)
      real(rk) :: matrix(size(segment), size(segment))  !< d(K_eq,k/K_IC)/da_l [1/m]
      !> bounds of a slope that a search has found, over the measured one [-]
      real(rk), parameter :: flattest = 0.25_rk, steepest = 2.0_rk
      integer :: k

      matrix = matrix_of_groups(kind, self%matrix(group, group))
      do k = 1, size(segment)
         if (.not. all(pack(self%is_known(group), kind == k))) then
            matrix(k, k) = segment(k)%falling_slope()
         else if (segment(k)%slope < 0.0_rk .and. matrix(k, k) < 0.0_rk) then
            matrix(k, :) = max(flattest, min(steepest, segment(k)%slope/matrix(k, k)))*matrix(k, :)
         end if
      end do
   end function matrix_for

   !> Groups of equal tips in an accepted state, numbered from 1. Tips of one group advance equally,
   !! by equal shares of their segments: their increments are equal, and so were the lengths of
   !! their fractures before they grew. In a network tips of unlike fractures are equal by chance,
   !! and so are many tips far below their toughness, as those without load: these are alone.
   subroutine find_groups(self, tip, interaction, kind)
      class(tip_groups_t), intent(inout) :: self
      type(group_tip_t), intent(in) :: tip(:)
      type(interaction_t), intent(in) :: interaction
      integer(ik), intent(out) :: kind(:)  !< (tips)
      logical :: alike(size(tip), size(tip))
      real(rk) :: apart, least
      integer(ik) :: i, j

      if (.not. allocated(self%usual)) self%usual = tip%drive
      if (.not. allocated(self%is_alone)) allocate (self%is_alone(size(tip)), source=.false.)
      where (.not. tip%gain > 0.0_rk) self%usual = tip%drive
      do j = 1, size(tip, kind=ik)
         do i = 1, size(tip, kind=ik)
            apart = abs(tip(i)%drive - tip(j)%drive)
            least = same_drive*larger(tip(i)%drive, tip(j)%drive)
            if (stay_together(self, i, j, tip(i)%gain, interaction, &
                              min(tip(i)%increment, tip(j)%increment))) then
               apart = abs(self%usual(i) - self%usual(j))
               least = same_mean*larger(self%usual(i), self%usual(j))
            end if
            alike(i, j) = apart <= max(least, hypot(tip(i)%off, tip(j)%off)) .and. &
                          may_be_equal(tip(i), tip(j)) .and. .not. any(self%is_alone([i, j]))
         end do
      end do
      kind = numbered(likes(alike))
      self%kind = kind
   end subroutine find_groups

   !> Whether two tips have equal fractures and have grown equally, near their toughness.
   pure logical function may_be_equal(one, other)
      type(group_tip_t), intent(in) :: one, other

      associate (shorter => min(one%increment, other%increment))
         may_be_equal = max(one%drive + one%off, other%drive + other%off) > -far .and. &
                        abs(one%gain - other%gain) <= same_gain*min(one%segment, other%segment) &
                        .and. abs(one%increment - other%increment) <= same_gain*shorter .and. &
                        abs(one%length - other%length) <= same_length*one%length .and. &
                        .not. (one%is_arrested .or. other%is_arrested)
      end associate
   end function may_be_equal

   !> Whether two tips of one group have grown, and equal growth of the two is stable: only
   !! numerical errors could separate them.
   pure logical function stay_together(self, i, j, gain, interaction, increment)
      class(tip_groups_t), intent(in) :: self
      integer(ik), intent(in) :: i, j
      real(rk), intent(in) :: gain  !< growth of the first tip [m]
      type(interaction_t), intent(in) :: interaction
      real(rk), intent(in) :: increment  !< [m]

      stay_together = .false.
      if (.not. allocated(self%kind) .or. i == j) return
      if (self%kind(i) /= self%kind(j) .or. .not. gain > 0.0_rk) return
      stay_together = interaction%preference_of([i, j])*increment <= could_separate
   end function stay_together

   !> Whether a stopped tip is so far below its toughness that it no longer belongs to its group.
   elemental logical function lags_behind(excess, off)
      real(rk), intent(in) :: excess  !< of K_eq over K_IC [-]
      real(rk), intent(in) :: off  !< estimated error of the excess [-]

      lags_behind = excess < -max(by_chance, off)
   end function lags_behind

   !> Remove a tip from its group for the rest of the run.
   pure subroutine remove_tip(self, tip)
      class(tip_groups_t), intent(inout) :: self
      integer(ik), intent(in) :: tip

      self%is_alone(tip) = .true.
   end subroutine remove_tip

   !> Whether K_eq of two tips of one group that have just separated are equal within their errors,
   !! so that only these have separated them.
   pure logical function differ_by_chance(self, i, j, drive, off)
      class(tip_groups_t), intent(in) :: self
      integer(ik), intent(in) :: i, j
      real(rk), intent(in) :: drive(:)  !< excess of each tip over its toughness [-]
      real(rk), intent(in) :: off(:)  !< estimated error of the excess [-]

      associate (both => hypot(off(i), off(j)))
         differ_by_chance = abs(drive(i) - drive(j)) &
                            <= max(by_chance*larger(drive(i), drive(j)), both) .and. &
                            abs(self%usual(i) - self%usual(j)) &
                            <= max(same_mean*larger(self%usual(i), self%usual(j)), both)
      end associate
   end function differ_by_chance

   !> The larger of two K_eq and of K_IC, over the scale of the excess [-].
   elemental real(rk) function larger(one, other)
      real(rk), intent(in) :: one, other  !< excesses over the toughness [-]

      larger = 1.0_rk + max(0.0_rk, one, other)
   end function larger

   !> Update the mean excess after an accepted step.
   subroutine accept(self, drive, advance, increment)
      class(tip_groups_t), intent(inout) :: self
      real(rk), intent(in) :: drive(:)  !< excess of each tip over its toughness [-]
      real(rk), intent(in) :: advance(:)  !< of them in the step [m]
      real(rk), intent(in) :: increment(:)  !< of them [m]

      self%usual = self%usual + min(1.0_rk, advance/(memory*increment))*(drive - self%usual)
   end subroutine accept

end module growth_interaction
