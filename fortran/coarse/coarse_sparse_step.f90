!> The linear step of the fractures' equations where the body is not condensed onto them: cells and
!! fractures together as one sparse system,
!!   ( A    C'Q           ) (b)   (  0)
!!   ( W C  W D Q + local ) (x) = ( -r),   Q: q per x, W: weights of the forces (coarse_slopes)
!! that is not symmetric. A is constant for one length of the time step; only the rows of the
!! fractures change between iterations, often few of them. So the system is factorized once, and its
!! factors M are a preconditioner for the following iterations and steps: p = M^-1 (0, r) satisfies
!! the equations of the cells exactly, and conjugate residuals over such p (Eisenstat, Elman and
!! Schultz 1983; equivalent to GMRES) reduce the fractures' residuals to the tolerance, in about as
!! many solutions as there are contact points that have changed their state. Directions p are kept
!! with the factors: their products with the current rows cost no solution. Where too many points
!! have changed, or too many directions are needed, the current rows are factorized again.
!!
!! Error measures: the remaining residual (`rest` of step_quality_t), and the condition of the
!! condensed matrix with its equations scaled, estimated from products and solutions (Higham 1988).
!! It costs as much as a dozen solutions, and is found for the first matrix of a time step and then
!! at every tenth factorization: in between, and where old factors are used, it is that of an
!! earlier matrix.
module coarse_sparse_step
   use algebra_lapack, only: estimate_norm
   use algebra_mumps, only: mumps_pord, mumps_t, mumps_unsymmetric
   use base_archive, only: archive_t
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use coarse_condensed, only: condensed_t
   use coarse_slopes, only: slopes_t
   use coarse_sparse_matrix, only: assemble_rock, assemble_rows
   use contact_newton, only: step_quality_t
   implicit none(type, external)
   private

   public :: sparse_step_t

   integer(ik), parameter :: most_changes = 20  !< of contact, after which new factors cost less
   integer(ik), parameter :: most_directions = 12  !< of one step with old factors; as above
   integer(ik), parameter :: most_kept = 32  !< directions
   integer(ik), parameter :: estimate_every = 10  !< factorizations
   real(rk), parameter :: reduction = 1.0e-8_rk  !< of the residuals
   real(rk), parameter :: most = 1.0e-11_rk  !< of the stress scale, the largest tolerance
   real(rk), parameter :: least = 1.0e-13_rk  !< of the stress scale, the least tolerance

   type :: sparse_step_t
      private
      type(mumps_t) :: solver
      logical :: is_ready = .false.
      integer(ik) :: of = 0  !< the factorization of the rock that the factors hold
      integer(ik), allocatable :: row(:), col(:)  !< what has been analysed
      real(rk), allocatable :: values(:)  !< of the same
      integer(ik) :: n_rock = 0  !< so many of them are those of the cells' equations
      real(rk), allocatable :: col_scale(:)  !< (unknowns) unknown = scale * scaled unknown
      real(rk), allocatable :: row_scale(:)  !< (equations of the fractures) largest coefficient
      real(rk), allocatable :: row_factor(:)  !< (the same) what the factors' are multiplied by
      real(rk), allocatable :: weight(:, :)  !< of the forces in the factors' rows
      integer(ik) :: n_kept = 0
      real(rk), allocatable :: direction(:, :)  !< (unknowns, kept) p of the fractures
      real(rk), allocatable :: force(:, :)  !< (6 n, kept) forces of the directions
      real(rk), allocatable :: product(:, :)  !< (equations, kept) of scaled rows and directions
      real(rk) :: condition = 0.0_rk
      integer(ik) :: estimated_for = 0  !< factorization of the rock
      integer(ik) :: estimated_at = 0  !< factorization
      integer(ik), public :: factorizations = 0  !< so far
      integer(ik), public :: solutions = 0  !< so far, but for those of the estimates
   contains
      procedure :: find_step
      procedure :: release
      procedure :: visit
   end type sparse_step_t

contains

   !> Solve for the step.
   subroutine find_step(self, condensed, slopes, is_flow, residual, stress_scale, step, quality)
      class(sparse_step_t), intent(inout) :: self
      type(condensed_t), intent(inout) :: condensed
      type(slopes_t), intent(in) :: slopes
      logical, intent(in) :: is_flow(:)  !< (n) unknowns whose errors the condition leaves out
      real(rk), intent(in) :: residual(:)  !< (n) [Pa]
      real(rk), intent(in) :: stress_scale  !< [Pa]
      real(rk), intent(out) :: step(:)  !< (n) [Pa]
      type(step_quality_t), intent(out) :: quality
      real(rk), allocatable :: left(:)
      real(rk) :: enough
      logical :: is_done, is_new
      type(error_t), allocatable :: error

      is_new = needs_factors(self, condensed, slopes)
      if (is_new) call renew(self, condensed, slopes, is_flow, error)
      quality%is_singular = allocated(error)
      if (quality%is_singular) return
      enough = max(min(reduction*maxval(abs(residual)), most*stress_scale), least*stress_scale)
      step = 0.0_rk
      left = -residual
      call reduce(self, condensed, slopes, enough, step, left, is_done, error)
      if (.not. is_done .and. .not. is_new .and. .not. allocated(error)) then
         call renew(self, condensed, slopes, is_flow, error)
         if (.not. allocated(error)) then
            call reduce(self, condensed, slopes, enough, step, left, is_done, error)
         end if
      end if
      quality%is_singular = allocated(error)
      if (quality%is_singular) return
      quality%condition = self%condition
      quality%rest = maxval(abs(left)/self%row_scale)/stress_scale
   end subroutine find_step

   !> Whether there are no factors, those of another time step, or too many points have changed
   !! their state.
   pure logical function needs_factors(self, condensed, slopes)
      class(sparse_step_t), intent(in) :: self
      type(condensed_t), intent(in) :: condensed
      type(slopes_t), intent(in) :: slopes
      real(rk), parameter :: share = 0.5_rk  ! of a weight: no change of contact is less

      needs_factors = .not. self%is_ready .or. self%of /= condensed%factorizations
      if (.not. needs_factors) needs_factors = size(self%weight, 2) /= slopes%n
      if (.not. needs_factors) then
         needs_factors = count(abs(slopes%weight - self%weight) &
                               > share*max(abs(slopes%weight), abs(self%weight))) > most_changes
      end if
   end function needs_factors

   !> Conjugate residuals: improve the step along the known directions first, then along those that
   !! the factors give.
   subroutine reduce(self, condensed, slopes, enough, step, left, is_done, error)
      class(sparse_step_t), intent(inout) :: self
      type(condensed_t), intent(inout) :: condensed
      type(slopes_t), intent(in) :: slopes
      real(rk), intent(in) :: enough  !< largest residual [Pa]
      real(rk), intent(inout) :: step(:)  !< [Pa]
      real(rk), intent(inout) :: left(:)  !< minus the residuals after the step [Pa]
      logical, intent(out) :: is_done
      type(error_t), allocatable, intent(out) :: error
      real(rk), parameter :: independent = 1.0e-6_rk  ! least part of a known direction that is new
      integer(ik) :: k, known
      logical :: is_used

      known = self%n_kept
      self%n_kept = 0
      do k = 1, known
         self%direction(:, self%n_kept + 1) = self%direction(:, k)
         self%force(:, self%n_kept + 1) = self%force(:, k)
         call use_direction(self, condensed, slopes, independent, step, left, is_used)
      end do
      is_done = maxval(abs(left)) <= enough
      do k = 1, most_directions
         if (is_done .or. self%n_kept == most_kept) return
         call precondition(self, condensed, slopes, left, self%direction(:, self%n_kept + 1), &
                           self%force(:, self%n_kept + 1), error)
         if (allocated(error)) return
         call use_direction(self, condensed, slopes, 0.0_rk, step, left, is_used)
         if (.not. is_used) return
         is_done = maxval(abs(left)) <= enough
      end do
   end subroutine reduce

   !> Make the product of the direction after the kept ones orthogonal to theirs, improve the step
   !! along it, and keep it. The remaining residual follows from the product, not from the factors.
   subroutine use_direction(self, condensed, slopes, least_share, step, left, is_used)
      class(sparse_step_t), intent(inout) :: self
      type(condensed_t), intent(in) :: condensed
      type(slopes_t), intent(in) :: slopes
      real(rk), intent(in) :: least_share  !< of the product that must remain [-]
      real(rk), intent(inout) :: step(:), left(:)  !< as in `reduce` [Pa]
      logical, intent(out) :: is_used
      real(rk) :: before, share
      integer(ik) :: j, pass

      associate (place => self%n_kept + 1)
         associate (p => self%direction(:, place), f => self%force(:, place), &
                    product => self%product(:, place))
            call slopes%apply(p, f + condensed%spring*p(slopes%x_of_q)*slopes%q_per_x, product)
            product = product/self%row_scale
            before = norm2(product)
            do pass = 1, 2  ! twice because of rounding
               do j = 1, place - 1
                  share = dot_product(self%product(:, j), product)
                  product = product - share*self%product(:, j)
                  p = p - share*self%direction(:, j)
                  f = f - share*self%force(:, j)
               end do
            end do
            share = norm2(product)
            is_used = share > least_share*before .and. share > 0.0_rk
            if (.not. is_used) return
            product = product/share
            p = p/share
            f = f/share
            share = dot_product(product, left/self%row_scale)
            step = step + share*p
            left = left - share*product*self%row_scale
         end associate
      end associate
      self%n_kept = self%n_kept + 1
   end subroutine use_direction

   !> The unknowns of the fractures that the factors give for a right-hand side of their rows, and
   !! the forces that belong to them, without springs.
   subroutine precondition(self, condensed, slopes, rhs, x, force, error)
      class(sparse_step_t), intent(inout) :: self
      type(condensed_t), intent(in) :: condensed
      type(slopes_t), intent(in) :: slopes
      real(rk), intent(in) :: rhs(:)  !< [Pa]
      real(rk), intent(out) :: x(:)  !< [Pa]
      real(rk), intent(out) :: force(:)  !< [N/m], [m2]
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: all(:)
      integer(ik) :: n

      n = condensed%coupling%n_bulk
      allocate (all(n + size(x)), source=0.0_rk)
      all(n + 1:) = rhs*self%row_factor
      call self%solver%solve(all, error)
      self%solutions = self%solutions + 1
      all = all*self%col_scale
      x = all(n + 1:)
      call condensed%coupling%forces(all(:n), x(slopes%x_of_q)*slopes%q_per_x, force)
   end subroutine precondition

   !> Factorize the system with the present equations.
   subroutine renew(self, condensed, slopes, is_flow, error)
      class(sparse_step_t), intent(inout) :: self
      type(condensed_t), intent(inout) :: condensed
      type(slopes_t), intent(in) :: slopes
      logical, intent(in) :: is_flow(:)
      type(error_t), allocatable, intent(out) :: error
      integer(ik), allocatable :: col(:), row(:)
      real(rk), allocatable :: values(:)
      logical :: is_known

      call renew_rock(self, condensed, slopes, is_known)
      self%is_ready = .false.
      call assemble_rows(condensed, slopes, self%col_scale, self%row_scale, self%row_factor, row, &
                         col, values)
      associate (n => self%n_rock)
         if (is_known) is_known = size(self%row) == n + size(row)
         if (is_known) is_known = all(self%row(n + 1:) == row) .and. all(self%col(n + 1:) == col)
         if (is_known) then
            self%values(n + 1:) = values
         else
            self%row = [self%row(:n), row]
            self%col = [self%col(:n), col]
            self%values = [self%values(:n), values]
            self%solver%ordering = mumps_pord
            call self%solver%analyse(size(self%col_scale, kind=ik), self%row, self%col, &
                                     mumps_unsymmetric, error)
            if (allocated(error)) then
               deallocate (self%row, self%col, self%values)
               return
            end if
         end if
      end associate
      call self%solver%factorize(self%values, error)
      if (allocated(error)) return
      self%factorizations = self%factorizations + 1
      self%of = condensed%factorizations
      self%weight = slopes%weight
      self%n_kept = 0
      if (allocated(self%direction)) deallocate (self%direction, self%force, self%product)
      allocate (self%direction(slopes%n, most_kept), self%product(slopes%n, most_kept))
      allocate (self%force(size(slopes%x_of_q), most_kept))
      self%is_ready = .true.
      if (self%estimated_for == self%of .and. &
          self%factorizations < self%estimated_at + estimate_every) return
      call estimate_condition(self, condensed, slopes, is_flow, error)
   end subroutine renew

   !> Assemble the equations of the cells, if those of another factorization are stored.
   subroutine renew_rock(self, condensed, slopes, is_known)
      class(sparse_step_t), intent(inout) :: self
      type(condensed_t), intent(in) :: condensed
      type(slopes_t), intent(in) :: slopes
      logical, intent(out) :: is_known  !< their pattern is that of the last analysis
      integer(ik), allocatable :: col(:), row(:)
      real(rk), allocatable :: values(:)

      is_known = allocated(self%row)
      if (is_known) is_known = size(self%col_scale) == condensed%coupling%n_bulk + slopes%n
      if (is_known .and. self%of == condensed%factorizations) return
      call assemble_rock(condensed, slopes, self%col_scale, row, col, values)
      if (is_known) is_known = size(row) == self%n_rock
      if (is_known) is_known = all(self%row(:self%n_rock) == row)
      if (is_known) is_known = all(self%col(:self%n_rock) == col)
      if (is_known) then
         self%values(:size(values)) = values
      else
         call move_alloc(row, self%row)
         call move_alloc(col, self%col)
         call move_alloc(values, self%values)
         self%n_rock = size(self%row, kind=ik)
      end if
   end subroutine renew_rock

   !> The condition of the condensed matrix with its equations scaled, in the 1-norm of its
   !! transpose: the norms of both that matrix and its inverse, estimated; of the inverse without
   !! the rows of the flows (contact_dense).
   subroutine estimate_condition(self, condensed, slopes, is_flow, error)
      class(sparse_step_t), intent(inout) :: self
      type(condensed_t), intent(inout) :: condensed
      type(slopes_t), intent(in) :: slopes
      logical, intent(in) :: is_flow(:)
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: norm(2), v(slopes%n), x(slopes%n)
      integer(ik) :: kase, part, save(3), signs(slopes%n)

      self%estimated_for = self%of
      self%estimated_at = self%factorizations
      norm = 0.0_rk
      do part = 1, 2
         kase = 0
         do
            call estimate_norm(slopes%n, v, x, signs, norm(part), kase, save)
            if (kase == 0) exit
            if (part == 1) call multiply(self, condensed, slopes, kase == 1, x, error)
            if (part == 2) call solve(self, is_flow, kase == 1, x, error)
            if (allocated(error)) return
         end do
      end do
      self%condition = norm(1)*norm(2)
   end subroutine estimate_condition

   !> The product of the condensed matrix with scaled equations, or of its transpose, with x.
   subroutine multiply(self, condensed, slopes, transposed, x, error)
      class(sparse_step_t), intent(in) :: self
      type(condensed_t), intent(inout) :: condensed
      type(slopes_t), intent(in) :: slopes
      logical, intent(in) :: transposed
      real(rk), intent(inout) :: x(:)  !< (n) replaced by the product
      type(error_t), allocatable, intent(out) :: error
      real(rk), dimension(size(slopes%x_of_q)) :: force, moved
      real(rk) :: y(size(x))

      if (transposed) then
         y = x/self%row_scale
         call slopes%apply_transposed(y, x, moved)
         call condensed%find_forces(moved, force, error)
         x(slopes%x_of_q) = x(slopes%x_of_q) + force*slopes%q_per_x
      else
         call condensed%find_forces(x(slopes%x_of_q)*slopes%q_per_x, force, error)
         call slopes%apply(x, force, y)
         x = y/self%row_scale
      end if
   end subroutine multiply

   !> The product of the inverse of that matrix, or of the transpose, with x; without the rows of
   !! flows.
   subroutine solve(self, is_flow, transposed, x, error)
      class(sparse_step_t), intent(inout) :: self
      logical, intent(in) :: is_flow(:)  !< (n)
      logical, intent(in) :: transposed
      real(rk), intent(inout) :: x(:)  !< (n) replaced by the product
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: all(size(self%col_scale))
      integer(ik) :: n

      n = size(all) - size(x)
      all(:n) = 0.0_rk
      if (transposed) then
         all(n + 1:) = merge(0.0_rk, x*self%col_scale(n + 1:), is_flow)
         call self%solver%solve(all, error, transposed=.true.)
         x = all(n + 1:)*self%row_factor*self%row_scale
      else
         all(n + 1:) = x*self%row_factor*self%row_scale
         call self%solver%solve(all, error)
         x = merge(0.0_rk, all(n + 1:)*self%col_scale(n + 1:), is_flow)
      end if
   end subroutine solve

   !> Release all memory.
   subroutine release(self)
      class(sparse_step_t), intent(inout) :: self

      call self%solver%release()
      self%is_ready = .false.
      if (allocated(self%row)) deallocate (self%row, self%col, self%values)
      if (allocated(self%direction)) deallocate (self%direction, self%force, self%product)
   end subroutine release

   !> Store or load the equations that were factorized and the known directions; the factors are
   !! made again from these equations.
   subroutine visit(self, archive, n_bulk, error)
      class(sparse_step_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive
      integer(ik), intent(in) :: n_bulk  !< unknowns that are not of the fractures
      type(error_t), allocatable, intent(out) :: error

      call archive%item("is_ready", self%is_ready)
      call archive%item("of", self%of)
      call archive%item("n_rock", self%n_rock)
      call archive%item("n_kept", self%n_kept)
      call archive%item("condition", self%condition)
      call archive%item("estimated_for", self%estimated_for)
      call archive%item("estimated_at", self%estimated_at)
      call archive%item("factorizations", self%factorizations)
      call archive%item("solutions", self%solutions)
      call archive%set_extent("directions", most_kept)
      call archive%list("col_scale", self%col_scale, "sparse_unknowns ?")
      call archive%list("row", self%row, "sparse_entries ?; 1:sparse_unknowns")
      call archive%list("col", self%col, "sparse_entries ?; 1:sparse_unknowns")
      call archive%list("values", self%values, "sparse_entries ?")
      call archive%list("row_scale", self%row_scale, "slopes ?")
      call archive%list("row_factor", self%row_factor, "slopes ?")
      call archive%list("weight", self%weight, "2, slopes ?")
      call archive%list("direction", self%direction, "slopes, directions ?")
      call archive%list("force", self%force, "condensed, directions ?")
      call archive%list("product", self%product, "slopes, directions ?")
      if (.not. (archive%is_loading .and. self%is_ready) .or. allocated(archive%fault)) return
      self%is_ready = .false.
      if (allocated(self%row) .and. allocated(self%col) .and. allocated(self%values) .and. &
          allocated(self%col_scale) .and. allocated(self%row_scale) .and. &
          allocated(self%row_factor) .and. allocated(self%weight) .and. &
          allocated(self%direction) .and. allocated(self%force) .and. allocated(self%product)) then
         self%is_ready = size(self%col_scale) - size(self%row_scale) == n_bulk .and. &
                         min(self%n_rock, self%n_kept) >= 0 .and. &
                         self%n_rock <= size(self%row) .and. self%n_kept <= most_kept
      end if
      if (.not. self%is_ready) then
         call archive%set_fault("factors")
         return
      end if
      self%solver%ordering = mumps_pord
      call self%solver%analyse(size(self%col_scale, kind=ik), self%row, self%col, &
                               mumps_unsymmetric, error)
      if (.not. allocated(error)) call self%solver%factorize(self%values, error)
   end subroutine visit

end module coarse_sparse_step
