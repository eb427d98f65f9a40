!> Pairs of nodes in contact on an elastic body that is condensed onto their jumps.
!!
!! The condensed equilibrium is S w - g = -L f: w are the jumps ([u]_n, [u]_tau pair by pair), g the
!! load, and L f the nodal contact forces on side +, with nodal lengths L > 0. The contact law at
!! every pair closes the system.
module contact_pairs
   use algebra_links, only: equations_together, links_t, new_links
   use base_kinds, only: ik, rk
   use contact_dense, only: solve_by_parts, solve_full
   use contact_newton, only: contact_system_t, step_quality_t
   use contact_pivoting, only: pivot_to_solution, slips_t
   use contact_point, only: contact_equations, contact_equations_t, contact_residual
   implicit none(type, external)
   private

   public :: contact_pairs_t

   !> The pairs, their history and their load.
   type, extends(contact_system_t) :: contact_pairs_t
      integer(ik) :: n = 0  !< pairs in contact
      real(rk), allocatable :: condensed(:, :)  !< S (2 n, 2 n), an equation per column [Pa]
      logical, allocatable :: is_symmetric(:)  !< (2 n) equations of S: among them it is symmetric
      real(rk), allocatable :: length(:)  !< L (n) [m]
      logical, allocatable :: slip_given(:)  !< (n) [u]_tau is given; friction plays no part
      real(rk), allocatable :: load(:)  !< g (2 n) [N/m]
      real(rk), allocatable :: given(:)  !< (n) [u]_tau where it is given [m]
      ! Derivatives of the law's equations, (equation, n tau, n) where last evaluated.
      real(rk), allocatable :: by_traction(:, :, :)  !< [-]
      real(rk), allocatable :: by_jump(:, :, :)  !< [Pa/m]
      !> Added to S in the derivatives, after a restart: a part that only contact holds, and that no
      !! load moves, stays where it is [Pa]
      real(rk) :: spring = 0.0_rk
   contains
      procedure :: evaluate
      procedure :: find_step
      procedure :: size_of_terms
      procedure :: law_residual
      procedure :: obeys_law
      procedure :: restart
      procedure :: end_restart
   end type contact_pairs_t

contains

   !> The equations of all pairs and their derivatives; x are the jumps times the stiffness. The
   !! stress scale is the largest traction, of the faces as they are or as if their jumps were none.
   subroutine evaluate(self, x)
      class(contact_pairs_t), intent(inout) :: self
      real(rk), intent(in) :: x(:)  !< (2 n) [Pa]
      real(rk) :: force(2*self%n), jump(2*self%n)
      type(contact_equations_t) :: found
      integer(ik) :: i, row

      if (.not. allocated(self%by_jump)) then
         allocate (self%by_traction(2, 2, self%n), self%by_jump(2, 2, self%n))
      end if
      jump = x/self%stiffness
      force = matmul(jump, self%condensed) - self%load
      self%stress_scale = 0.0_rk
      do i = 1, self%n
         row = 2*i - 1
         self%traction(:, i) = -force(row:row + 1)/self%length(i)
         call contact_equations(self%law(i), self%stiffness, self%traction(:, i), &
                                jump(row:row + 1), self%slip_before(i), self%slip_sign(i), found)
         self%state(i) = found%state
         self%residual(row:row + 1) = found%residual
         self%by_traction(:, :, i) = found%by_traction
         self%by_jump(:, :, i) = found%by_jump
         if (self%slip_given(i)) then
            self%residual(row + 1) = self%stiffness*(jump(row + 1) - self%given(i))
            self%by_traction(2, :, i) = 0.0_rk
            self%by_jump(2, :, i) = [0.0_rk, self%stiffness]
         end if
         self%stress_scale = max(self%stress_scale, maxval(abs(self%traction(:, i))), &
                                 maxval(abs(self%load(row:row + 1)))/self%length(i), &
                                 self%stiffness*abs(self%slip_before(i)), &
                                 self%stiffness*abs(self%given(i)))
      end do
   end subroutine evaluate

   !> The step, with only those jumps as unknowns of a matrix that forces decide.
   subroutine find_step(self, with_condition, step, quality)
      class(contact_pairs_t), intent(inout) :: self
      logical, intent(in) :: with_condition
      real(rk), intent(out) :: step(:)  !< (2 n) [Pa]
      type(step_quality_t), intent(out) :: quality
      type(links_t) :: links
      integer(ik), allocatable :: kept(:)
      real(rk), allocatable :: factor(:), matrix(:, :), rest(:), solution(:)
      real(rk) :: slopes(equations_together, 2*self%n)
      integer(ik) :: i, k, m
      logical :: is_solved

      links = new_links(2*self%n)
      do i = 1, self%n
         call links%link_pair(2*i - 1, self%by_jump(:, :, i)/self%stiffness, &
                              .not. any(abs(self%by_traction(:, :, i)) > 0.0_rk, dim=2))
      end do
      call links%take_residual(self%residual)
      kept = links%kept_unknowns()
      allocate (matrix(size(kept), size(kept)), solution(size(kept)))
      rest = self%residual(kept)
      factor = [(factor_of(self, kept(k)), k=1, size(kept))]
      do k = 1, size(kept, kind=ik), equations_together
         m = min(equations_together, size(kept, kind=ik) - k + 1)
         do i = 1, m
            call fill_row(self, kept(k + i - 1), slopes(i, :))
         end do
         call links%reduce(slopes(:m, :), rest(k:k + m - 1))
         matrix(:, k:k + m - 1) = transpose(slopes(:m, kept))
      end do
      do i = 1, links%first(links%n + 1) - 1  ! another unknown moves with it: not symmetric
         if (abs(links%share(i)) > 0.0_rk) where (kept == links%partner(i)) factor = 0.0_rk
      end do
      is_solved = .false.
      if (.not. with_condition .and. is_worth(factor)) then
         call solve_by_parts(matrix, rest, factor, solution, quality, is_solved)
      end if
      if (.not. is_solved) call solve_full(matrix, rest, with_condition, solution, quality)
      if (quality%is_singular) return
      step(kept) = solution
      call links%complete(step)
   end subroutine find_step

   !> Whether separate elimination of the equations with a factor is worthwhile.
   pure logical function is_worth(factor)
      real(rk), intent(in) :: factor(:)  !< see solve_by_parts
      integer(ik), parameter :: many = 32
      integer(ik) :: n

      n = count(abs(factor) > 0.0_rk, kind=ik)
      is_worth = n >= many .and. 2*n >= size(factor)
   end function is_worth

   !> The factor with which an equation that contains one traction alone becomes that of the
   !! symmetric S; otherwise 0.
   pure real(rk) function factor_of(self, equation)
      class(contact_pairs_t), intent(in) :: self
      integer(ik), intent(in) :: equation  !< n, tau pair by pair
      integer(ik) :: i, k

      i = (equation + 1)/2
      k = equation - 2*i + 2
      factor_of = 0.0_rk
      if (.not. allocated(self%is_symmetric)) return
      if (.not. self%is_symmetric(equation) .or. any(abs(self%by_jump(k, :, i)) > 0.0_rk) &
          .or. abs(self%by_traction(k, 3 - k, i)) > 0.0_rk &
          .or. .not. abs(self%by_traction(k, k, i)) > 0.0_rk) return
      factor_of = -self%length(i)*self%stiffness/self%by_traction(k, k, i)
   end function factor_of

   !> The derivatives of an equation, where last evaluated.
   pure subroutine fill_row(self, equation, slope)
      class(contact_pairs_t), intent(in) :: self
      integer(ik), intent(in) :: equation  !< n, tau pair by pair
      real(rk), intent(out) :: slope(:)  !< (2 n) [-]
      real(rk) :: share
      integer(ik) :: i, k, m, row

      i = (equation + 1)/2
      row = 2*i - 1
      k = equation - row + 1
      slope = 0.0_rk
      do m = 1, 2
         share = self%by_traction(k, m, i)/(self%length(i)*self%stiffness)
         if (.not. abs(share) > 0.0_rk) cycle
         slope = slope - share*self%condensed(:, row + m - 1)
         slope(row + m - 1) = slope(row + m - 1) - share*self%spring
      end do
      slope(row:row + 1) = slope(row:row + 1) + self%by_jump(k, :, i)/self%stiffness
   end subroutine fill_row

   !> The sum of the sizes of a residual's terms.
   pure function size_of_terms(self, x, row) result(total)
      class(contact_pairs_t), intent(in) :: self
      real(rk), intent(in) :: x(:)  !< (2 n) [Pa]
      integer(ik), intent(in) :: row  !< number of the residual
      real(rk) :: total  !< [Pa]
      real(rk) :: slope(2*self%n)

      call fill_row(self, row, slope)
      total = dot_product(abs(slope), abs(x))
   end function size_of_terms

   !> Violation of the contact law at the last evaluation, over the stress scale [-].
   pure real(rk) function law_residual(self, x) result(worst)
      class(contact_pairs_t), intent(in) :: self
      real(rk), intent(in) :: x(:)  !< (2 n) where last evaluated [Pa]
      real(rk) :: jump(2), traction(2)
      integer(ik) :: i

      worst = 0.0_rk
      do i = 1, self%n
         jump = x(2*i - 1:2*i)/self%stiffness
         traction = self%traction(:, i)
         if (self%slip_given(i)) then  ! no friction; the shear is that which the slip needs
            worst = max(worst, self%stiffness*abs(jump(2) - self%given(i)), &
                        contact_residual(self%law(i), self%stiffness, [traction(1), 0.0_rk], &
                                         jump, jump(2)))
         else
            worst = max(worst, contact_residual(self%law(i), self%stiffness, traction, jump, &
                                                self%slip_before(i)))
         end if
      end do
      worst = worst/max(self%stress_scale, tiny(1.0_rk))
   end function law_residual

   !> The law itself, whatever the states.
   logical function obeys_law(self, x, tolerance)
      class(contact_pairs_t), intent(in) :: self
      real(rk), intent(in) :: x(:)  !< (2 n) where last evaluated [Pa]
      real(rk), intent(in) :: tolerance  !< relative to the stress scale [-]

      obeys_law = self%law_residual(x) <= tolerance
   end function obeys_law

   !> Initial guess by complementary pivoting, on a foundation far softer than the body, which the
   !! iteration removes again. If pivoting fails, where it is not guaranteed: the faces without
   !! jumps, on the foundation.
   subroutine restart(self, x, has_start)
      class(contact_pairs_t), intent(inout) :: self
      real(rk), intent(inout) :: x(:)  !< (2 n) [Pa]
      logical, intent(out) :: has_start
      real(rk), parameter :: softness = 1.0e-7_rk
      real(rk) :: on_spring(2*self%n, 2*self%n), mean
      integer(ik) :: i

      on_spring = self%condensed
      self%is_propped = .true.
      self%spring = 0.0_rk
      do i = 1, 2*self%n
         self%spring = self%spring + softness*abs(self%condensed(i, i))/(2*self%n)
      end do
      do i = 1, 2*self%n
         on_spring(i, i) = on_spring(i, i) + self%spring
      end do
      mean = sum(self%length)/self%n
      call pivot_to_solution(on_spring/(self%stiffness*mean), self%load/mean, self%law, &
                             self%stiffness*self%law%compliance*mean/self%length, &
                             slips_t(self%slip_given, self%stiffness*self%slip_before, &
                                     self%stiffness*self%given), x, has_start)
      self%slip_sign = 0
      if (has_start) return
      x = 0.0_rk
      self%state = -1
      has_start = .true.
   end subroutine restart

   !> Remove the foundation.
   subroutine end_restart(self)
      class(contact_pairs_t), intent(inout) :: self

      self%is_propped = .false.
      self%spring = 0.0_rk
   end subroutine end_restart

end module contact_pairs
