!> Advances of tips in equilibrium: the bounded nonlinear complementarity problem of model.md,
!! section 5,
!!
!!    lower <= a <= upper,   excess_i(a) = K_eq,i/K_IC - 1,
!!    excess_i <= 0 where a_i = lower_i,   = 0 between the bounds,   >= 0 where a_i = upper_i.
!!
!! The caller evaluates the tips at `place`, passes their excess to `improve`, and evaluates them at
!! the new `place` until `place` is constant. Each proposal solves the linear complementarity
!! problem of the matrix d(excess)/da within a trust region (growth_competition); Broyden updates
!! improve the matrix. A proposal is accepted if the norm of the natural residual (Facchinei and
!! Pang, Finite-Dimensional Variational Inequalities and Complementarity Problems, 2003, sections
!! 1.5 and 8.3) is below one of the last two; otherwise the trust region shrinks. A residual that
!! must always fall stops tips where K_eq hardly changes as they advance (Grippo, Lampariello and
!! Lucidi, SIAM J. Numer. Anal. 23, 1986). Where this does not converge, as at
!! jumps of K_eq, each tip advances from its lower bound until K_eq <= K_IC, and its position is
!! found by bisection. The farthest position with K_eq > K_IC never decreases, so that this search
!! ends. The search may leave a tip between its bounds with K_eq < K_IC: beyond a drop of K_eq, or
!! where other tips have grown past it.
!!
!! K of two meshes differs within its error. Where this error is many times the tolerance, no
!! position satisfies the tolerance reliably: proposals are rejected, or a bisection goes on to its
!! resolution. After two rejected proposals, or four evaluations, K_eq of a tip between its bounds
!! may be below K_IC by a given share of the error (`slack`), and above it by the same, up to twice
!! the tolerance.
module growth_advances
   use base_kinds, only: rk
   use base_plane, only: norm2
   use growth_competition, only: complementary_advances
   implicit none(type, external)
   private

   public :: advances_t, in_equilibrium

   !> Shortest change of a position, over the distance between its bounds [-]. The excess has been
   !! seen to change by 33 over a segment, so that this is worth 3e-3 of K_IC.
   real(rk), parameter :: resolution = 1.0e-4_rk

   !> Slope of the excess, times the distance between the bounds, below which no equilibrium of a
   !! tip between its bounds is expected [-].
   real(rk), parameter :: flat = 0.05_rk

   !> Largest excess of a tip between its bounds where a search that has stalled ends, and largest
   !! lack of one that stays at its upper bound, over the tolerance [-].
   real(rk), parameter :: most_over = 2.0_rk

   !> State of the iteration.
   type :: advances_t
      real(rk), allocatable :: place(:)  !< (tips) positions to be evaluated next [m]
      real(rk), allocatable :: matrix(:, :)  !< (tips, tips) d(excess)/da [1/m]
      integer :: evaluations = 0
      logical :: is_monotone = .false.  !< the monotone search has replaced the Newton steps
      real(rk), allocatable, private :: lower(:), upper(:)  !< [m]
      real(rk), allocatable, private :: length(:)  !< distance between the bounds [m]
      !> distance from the upper bound within which a tip is put onto the bound [m]
      real(rk), allocatable, private :: sliver(:)
      !> (tips) scale of the natural residual: the steepest fall of the excess so far [1/m]
      real(rk), allocatable, private :: scale(:)
      real(rk), allocatable, private :: best(:)  !< position accepted last [m]
      real(rk), allocatable, private :: excess(:)  !< value at `best` [-]
      ! Position and excess accepted before them.
      real(rk), allocatable, private :: best_before(:), excess_before(:)
      !> (tips) trust region, over the distance between the bounds [-]
      real(rk), allocatable, private :: radius(:)
      integer, private :: rejected = 0  !< number of proposals rejected in succession
      integer, private :: rejected_in_all = 0
      !> (tips) lack of toughness between the bounds at which a search that has stalled ends [-]
      real(rk), allocatable :: slack(:)
      ! Bracket of each tip in the monotone search.
      real(rk), allocatable, private :: near(:)  !< farthest position with K_eq > K_IC [m]
      !> nearest position beyond `near` with K_eq <= K_IC [m]
      real(rk), allocatable, private :: far(:)
      integer, private :: monotone_steps = 0
   contains
      procedure :: begin
      procedure :: improve
      procedure, private :: allowed
      procedure, private :: judge
      procedure, private :: update_matrix
      procedure, private :: propose
      procedure, private :: advance
   end type advances_t

contains

   !> Begin at a position with an estimate of the matrix.
   subroutine begin(self, lower, upper, place, matrix, sliver)
      class(advances_t), intent(out) :: self
      real(rk), intent(in) :: lower(:), upper(:)  !< (tips) bounds, lower <= upper [m]
      real(rk), intent(in) :: place(:)  !< (tips) position to be evaluated first [m]
      real(rk), intent(in) :: matrix(:, :)  !< (tips, tips) estimate of d(excess)/da [1/m]
      !> (tips) distance from the upper bound within which a tip is put onto the bound [m]
      real(rk), intent(in), optional :: sliver(:)
      integer :: i

      self%lower = lower
      self%upper = upper
      self%place = min(upper, max(lower, place))
      self%matrix = matrix
      self%length = max(upper - lower, epsilon(1.0_rk)*abs(upper), tiny(1.0_rk))
      self%sliver = resolution*self%length
      if (present(sliver)) self%sliver = max(self%sliver, sliver)
      allocate (self%radius(size(lower)), source=1.0_rk)
      self%scale = [(max(-matrix(i, i), flat/self%length(i)), i=1, size(lower))]
   end subroutine begin

   !> Process the excess at `place`, and set `place` to the position to be evaluated next.
   !! `has_moved` is false where the tips are in equilibrium at `place` within the tolerance.
   subroutine improve(self, excess, tolerance, has_moved)
      class(advances_t), intent(inout) :: self
      real(rk), intent(in) :: excess(:)  !< (tips) K_eq/K_IC - 1 at `place` [-]
      real(rk), intent(in) :: tolerance  !< tolerance of the excess [-]
      logical, intent(out) :: has_moved
      integer, parameter :: evaluations_max = 16, rejected_max = 5
      logical :: is_stuck

      self%evaluations = self%evaluations + 1
      if (self%evaluations > 1) call self%update_matrix(excess)
      if (.not. self%is_monotone) call self%judge(excess, tolerance)
      has_moved = .not. all(in_equilibrium(self%place, excess, self%lower, self%upper, tolerance, &
                                           self%allowed(tolerance)))
      if (.not. has_moved) return
      if (.not. self%is_monotone) then
         if (self%evaluations < evaluations_max .and. self%rejected < rejected_max) then
            call self%propose(has_moved, is_stuck)
            if (.not. is_stuck) return
         end if
         has_moved = .true.
         self%is_monotone = .true.
         self%near = self%lower
         self%far = spread(huge(1.0_rk), 1, size(self%lower))
         if (any(self%place > self%lower)) then
            self%place = self%lower
            return
         end if
         self%best = self%place
         self%excess = excess
         call self%advance(tolerance, has_moved)
      else
         self%best = self%place
         self%excess = excess
         call self%advance(tolerance, has_moved)
      end if
   end subroutine improve

   !> Lack of toughness between the bounds at which the search ends [-].
   pure function allowed(self, tolerance) result(lack)
      class(advances_t), intent(in) :: self
      real(rk), intent(in) :: tolerance  !< tolerance of the excess [-]
      integer, parameter :: stalled = 2, long = 4  ! rejected proposals, evaluations
      real(rk) :: lack(size(self%place))
      integer :: i

      ! A tip that would retreat by less than the sliver stays at its upper bound.
      lack = [(max(tolerance, min(-self%matrix(i, i)*self%sliver(i), most_over*tolerance)), &
               i=1, size(lack))]
      where (self%place < self%upper) lack = tolerance
      if (.not. allocated(self%slack)) return
      if (self%is_monotone .or. self%rejected_in_all >= stalled .or. self%evaluations > long) then
         lack = max(lack, self%slack)
      end if
   end function allowed

   !> Whether a tip satisfies its complementarity condition within the tolerance.
   elemental logical function in_equilibrium(place, excess, lower, upper, tolerance, slack)
      real(rk), intent(in) :: place, lower, upper  !< [m]
      real(rk), intent(in) :: excess, tolerance  !< [-]
      real(rk), intent(in), optional :: slack  !< lack between the bounds; default: tolerance [-]
      real(rk) :: lack

      lack = tolerance
      if (present(slack)) lack = slack
      if (excess > min(lack, most_over*tolerance)) then
         in_equilibrium = place >= upper
      else if (excess < -lack) then
         in_equilibrium = place <= lower
      else
         in_equilibrium = .true.
      end if
   end function in_equilibrium

   !> Accept the evaluated position if its residual is below that of one of the last two accepted
   !! positions. Tips that advance and still exceed their toughness, by hardly more than before,
   !! need not count: their equilibrium lies ahead. Else shrink the trust region of the others.
   pure subroutine judge(self, excess, tolerance)
      class(advances_t), intent(inout) :: self
      real(rk), intent(in) :: excess(:)  !< (tips) [-]
      real(rk), intent(in) :: tolerance  !< tolerance of the excess [-]
      real(rk), parameter :: level = 2.0_rk  ! change that does not count, over the tolerance
      real(rk), dimension(size(excess)) :: residual, at_best, before
      logical :: is_better, is_on_way(size(excess))
      integer :: i

      self%scale = max(self%scale, [(-self%matrix(i, i), i=1, size(excess))])
      is_better = .not. allocated(self%best)
      if (.not. is_better) then
         residual = residuals(self, self%place, excess, tolerance)
         at_best = residuals(self, self%best, self%excess, tolerance)
         before = at_best
         if (allocated(self%best_before)) then
            before = residuals(self, self%best_before, self%excess_before, tolerance)
         end if
         is_on_way = self%place > self%best .and. min(excess, self%excess) > 0.0_rk .and. &
                     excess < self%excess + level*tolerance
         is_better = norm2(residual) < max(norm2(at_best), norm2(before))
         if (norm2(residual) < 0.5_rk*norm2(at_best)) self%radius = min(1.0_rk, 2.0_rk*self%radius)
         where (is_on_way)
            residual = 0.0_rk
            at_best = 0.0_rk
            before = 0.0_rk
         end where
         is_better = is_better .or. norm2(residual) <= max(norm2(at_best), norm2(before))
      end if
      if (is_better) then
         if (allocated(self%best)) then
            self%best_before = self%best
            self%excess_before = self%excess
         end if
         self%best = self%place
         self%excess = excess
         self%rejected = 0
      else
         where (.not. is_on_way) self%radius = 0.5_rk*min(self%radius, maxval(abs(self%place &
                                                                          - self%best)/self%length))
         self%rejected = self%rejected + 1
         self%rejected_in_all = self%rejected_in_all + 1
      end if
   end subroutine judge

   !> What is missed of the complementarity conditions, beyond the tolerance: the excess, or the
   !! distance from a bound as an excess.
   pure function residuals(self, place, excess, tolerance) result(residual)
      type(advances_t), intent(in) :: self
      real(rk), intent(in) :: place(:)  !< (tips) [m]
      real(rk), intent(in) :: excess(:)  !< (tips) value there [-]
      real(rk), intent(in) :: tolerance  !< [-]
      real(rk) :: residual(size(place))

      residual = self%scale*abs(place - min(self%upper, max(self%lower, place + excess/self%scale)))
      residual = max(0.0_rk, residual - tolerance)
   end function residuals

   !> Update of the matrix: the smallest change, relative to its terms, with which it predicts the
   !! measured change of the excess. K_eq of a tip depends more on its own position than on those of
   !! others; Broyden's change, the smallest in absolute terms, does not know this.
   pure subroutine update_matrix(self, excess)
      class(advances_t), intent(inout) :: self
      real(rk), intent(in) :: excess(:)  !< (tips) excess at `place` [-]
      real(rk), parameter :: least = 0.05_rk  ! of the terms of a row, over the largest [-]
      real(rk) :: missed, moved(size(excess)), weight(size(excess))
      integer :: i

      ! The excess at nearly the same position shows nothing but the error of the mesh.
      if (.not. any(abs(self%place - self%best) > 0.5_rk*resolution*self%length)) return
      moved = self%place - self%best
      do i = 1, size(excess)
         associate (row => self%matrix(i, :))
            weight = abs(row)*self%length
            weight = max(weight, least*maxval(weight))**2*moved/self%length
            missed = excess(i) - self%excess(i) - dot_product(row, moved)
            if (dot_product(weight, moved) > 0.0_rk) then
               self%matrix(i, :) = row + missed*weight/dot_product(weight, moved)
            end if
         end associate
      end do
   end subroutine update_matrix

   !> Solve the linear problem within the trust region around the best position. Tips at an upper
   !! bound stay there if they would retreat by no more than `sliver`.
   subroutine propose(self, has_moved, is_stuck)
      class(advances_t), intent(inout) :: self
      logical, intent(out) :: has_moved
      !> the solution of the linear problem is shorter than the resolution, or leads to the place
      !! that has just been rejected
      logical, intent(out) :: is_stuck
      real(rk), dimension(size(self%best)) :: change, reach, to

      reach = self%radius*self%length
      call complementary_advances(self%excess, self%matrix, max(self%lower - self%best, -reach), &
                                  min(self%upper - self%best, reach), change)
      is_stuck = .not. any(abs(change) > resolution*self%length)
      has_moved = .false.
      if (is_stuck) return
      to = max(self%lower, self%best + change)
      where (to < self%lower + resolution*self%length) to = self%lower
      where (to > self%upper - self%sliver) to = self%upper
      has_moved = any(abs(to - self%place) > resolution*self%length)
      is_stuck = .not. has_moved
      if (has_moved) self%place = to
   end subroutine propose

   !> One step of the monotone search: tips with K_eq > K_IC advance, tips with K_eq < K_IC return
   !! into their brackets.
   pure subroutine advance(self, tolerance, has_moved)
      class(advances_t), intent(inout) :: self
      real(rk), intent(in) :: tolerance  !< tolerance of the excess [-]
      logical, intent(out) :: has_moved
      real(rk), parameter :: growth = 2.0_rk**0.25_rk  ! of the least step, per evaluation [-]
      real(rk) :: lack(size(self%place)), step, to
      integer :: i

      lack = self%allowed(tolerance)
      self%monotone_steps = self%monotone_steps + 1
      has_moved = .false.
      do i = 1, size(self%place)
         associate (place => self%place(i), near => self%near(i), far => self%far(i), &
                    excess => self%excess(i), length => self%length(i))
            if (in_equilibrium(place, excess, self%lower(i), self%upper(i), tolerance, &
                               lack(i))) cycle
            if (excess > 0.0_rk) then
               near = place
               if (far <= near) far = huge(1.0_rk)
            else
               far = place
            end if
            if (far <= self%upper(i)) then
               to = far
               if (far - near > 2.0_rk*resolution*length) to = 0.5_rk*(near + far)
            else
               ! Positions far ahead, where the excess may be flat, may have spoilt the matrix: the
               ! first steps are no longer than by the slope as estimated first.
               step = max(0.9_rk*excess/max(-self%matrix(i, i), 2.0_rk*flat/length, &
                                            self%scale(i)*0.25_rk**(self%monotone_steps - 1)), &
                          2.0_rk*resolution*length*growth**self%monotone_steps)
               to = min(self%upper(i), place + step)
            end if
            if (to > self%upper(i) - self%sliver(i)) to = self%upper(i)
            has_moved = has_moved .or. abs(to - place) > 0.0_rk
            place = to
         end associate
      end do
   end subroutine advance

end module growth_advances
