!> How the intensities of tips depend on the places of all of them, where nothing but their places
!! changes: what a fluid gives in a time step is held. Measured tip by tip, learnt on with each try,
!! and used to say whether tips that grow together could part, and where they are at rest together.
module growth_rivals
   use base_kinds, only: ik, rk
   use growth_competition, only: complementary_advances, learn_from_trial, preference
   use growth_kinds, only: matrix_of_kinds
   use growth_segment, only: segment_t
   implicit none(type, external)
   private

   public :: rivals_t

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
      procedure :: changes
   end type rivals_t

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

   !> How far the kinds of a group should move, so that each is at rest.
   function changes(self, group, kind, excess, segment) result(change)
      class(rivals_t), intent(in) :: self
      integer(ik), intent(in) :: group(:)  !< tips
      integer(ik), intent(in) :: kind(:)  !< of each, from 1
      real(rk), intent(in) :: excess(:)  !< (kinds) of K_eq over K_IC [-]
      type(segment_t), intent(in) :: segment(:)  !< (kinds)
      real(rk) :: change(size(excess))  !< [m]
      real(rk) :: matrix(size(excess), size(excess))
      integer :: k

      matrix = matrix_of_kinds(kind, self%matrix(group, group))
      do k = 1, size(excess)
         ! Of what has not been measured, its secants know something.
         if (.not. all(pack(self%is_known(group), kind == k))) matrix(k, k) = segment(k)%slope
         matrix(k, k) = segment(k)%steep(matrix(k, k))
      end do
      call complementary_advances(excess, matrix, segment%lowest() - segment%reached, &
                                  segment%length - segment%reached, change)
   end function changes

end module growth_rivals
