!> Factors of the matrix of the coarse level for one time step: of the matrix condensed onto the
!! unknowns of the fractures, or of the cells alone.
!!
!! The matrix is quasi-definite: the rock's stiffness, minus the storage and conductance of its
!! pressures. So it has factors L S L^T with a sign for each unknown and no exchange of pivots, by
!! `algebra_multifrontal`. The growth of rounding errors is measured on a known solution; where it
!! is too large (a fluid or rock with hardly any storage), MUMPS, which exchanges pivots, is used
!! from then on. MUMPS also factorizes the cells alone, whose entries it keeps, and matrices shared
!! by ranks.
!!
!! Jumps that are known to be zero may be fixed: they are no part of the matrix then.
module coarse_factors
   use algebra_multifrontal, only: multifrontal_t
   use algebra_mumps, only: are_shared, mumps_indefinite, mumps_t
   use algebra_ordering, only: dissect, expand_order, neighbours_of
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_lists, only: lists_t
   use coarse_layout, only: at_component
   use coarse_matrix, only: matrix_t
   use coarse_rows, only: clear_fixed, find_rows, rows_t, times_scaled
   implicit none(type, external)
   private

   public :: coarse_factors_t

   type :: coarse_factors_t
      !> (3 n_blocks) unknown = scale * scaled unknown [m], [m], [Pa] block by block
      real(rk), allocatable :: scale(:)
      integer(ik) :: at_fractures = 1  !< where the fractures' begin among the unknowns
      logical :: by_fronts = .false.  !< no pivots are exchanged
      logical :: needs_exchanges = .false.  !< exchange pivots, also in the future
      integer(ik), allocatable :: kept(:)  !< unknowns to condense onto, from the first on fractures
      logical, private :: analysed = .false.
      type(mumps_t), private :: exchanging
      type(multifrontal_t), private :: fronts
      type(rows_t), private :: rows  !< the matrix as the fronts take it up
   contains
      procedure :: release
      procedure :: factorize
      procedure :: solve
      procedure :: condense
      procedure :: expand
      procedure :: get_entries
   end type coarse_factors_t

contains

   !> Release the factors of a mesh.
   subroutine release(self)
      class(coarse_factors_t), intent(inout) :: self
      type(multifrontal_t) :: none

      call self%exchanging%release()
      self%fronts = none
      self%analysed = .false.
   end subroutine release

   !> Factorize for a time step. The pattern is analysed at the first call.
   subroutine factorize(self, matrix, dt, error, schur, fixed)
      class(coarse_factors_t), intent(inout) :: self
      type(matrix_t), intent(in) :: matrix
      real(rk), intent(in) :: dt  !< [s]
      type(error_t), allocatable, intent(out) :: error
      !> Scaled matrix condensed onto the unknowns of the fractures that are kept. Absent: the cells
      !! alone are factorized.
      real(rk), allocatable, intent(inout), optional :: schur(:, :)
      !> Blocks with jumps that are zero, at the first call. By MUMPS none are fixed.
      integer(ik), intent(in), optional :: fixed(:)

      call find_scale(matrix, dt, self%scale)
      if (.not. self%analysed) then
         self%at_fractures = at_component(matrix%n_cells + 1, 1)
         self%by_fronts = present(schur) .and. .not. self%needs_exchanges &
                          .and. are_shared(3*matrix%n_blocks) == 0
         call fix(self, matrix%n_blocks, fixed)
      end if
      if (self%by_fronts) then
         call factorize_by_fronts(self, matrix, dt, schur, error)
         if (allocated(error)) then
            deallocate (error)
            self%by_fronts = .false.
            self%needs_exchanges = .true.
            self%analysed = .false.
            call fix(self, matrix%n_blocks)
         end if
      end if
      if (.not. self%by_fronts) call factorize_by_mumps(self, matrix, dt, error, schur)
      if (.not. allocated(error)) self%analysed = .true.
   end subroutine factorize

   !> Set the jumps that are zero.
   pure subroutine fix(self, n_blocks, fixed)
      class(coarse_factors_t), intent(inout) :: self
      integer(ik), intent(in) :: n_blocks
      integer(ik), intent(in), optional :: fixed(:)  !< blocks
      logical :: is_kept(self%at_fractures:3*n_blocks)
      integer(ik) :: i

      associate (rows => self%rows)
         if (allocated(rows%is_fixed)) deallocate (rows%is_fixed)
         allocate (rows%is_fixed(n_blocks), source=.false.)
         rows%fixed = [integer(ik) ::]
         if (present(fixed)) rows%fixed = fixed
         rows%is_fixed(rows%fixed) = .true.
         is_kept = .true.
         is_kept(at_component(rows%fixed, 1)) = .false.
         is_kept(at_component(rows%fixed, 2)) = .false.
      end associate
      self%kept = pack([(i, i=1, size(is_kept, kind=ik))], is_kept)
   end subroutine fix

   !> Solve for scaled equations and unknowns, where nothing is condensed.
   subroutine solve(self, x, error)
      class(coarse_factors_t), intent(inout) :: self
      real(rk), intent(inout) :: x(:, :)  !< right-hand sides, then solutions
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: k

      if (self%by_fronts) then
         do k = 1, size(x, 2, kind=ik)
            call self%fronts%solve(x(:, k), error)
            if (allocated(error)) return
         end do
      else
         call self%exchanging%solve(x, error)
      end if
   end subroutine solve

   !> Forward elimination with the factors in use, for scaled equations; `rhs` may be changed.
   subroutine condense(self, rhs, reduced, error)
      class(coarse_factors_t), intent(inout) :: self
      real(rk), intent(inout), contiguous, target :: rhs(:)
      real(rk), intent(out) :: reduced(:)  !< zero for fixed jumps
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: on_kept(size(self%kept))

      if (self%by_fronts) then
         call clear_fixed(self%rows%fixed, rhs)
         call self%fronts%condense(rhs, on_kept, error)
         reduced = 0.0_rk
         reduced(self%kept) = on_kept
      else
         call self%exchanging%condense(rhs, reduced, error)
      end if
   end subroutine condense

   !> Back substitution after it, for scaled unknowns.
   subroutine expand(self, condensed, x, error)
      class(coarse_factors_t), intent(inout) :: self
      real(rk), intent(in) :: condensed(:)
      real(rk), intent(out), contiguous, target :: x(:)
      type(error_t), allocatable, intent(out) :: error

      if (self%by_fronts) then
         call self%fronts%expand(condensed(self%kept), x, error)
      else
         call self%exchanging%expand(condensed, x, error)
      end if
   end subroutine expand

   !> The scaled matrix of the cells alone, its lower triangle.
   subroutine get_entries(self, row, col, values)
      class(coarse_factors_t), intent(in) :: self
      integer(ik), allocatable, intent(out) :: row(:), col(:)
      real(rk), allocatable, intent(out) :: values(:)

      call self%exchanging%get_entries(row, col, values)
   end subroutine get_entries

   !> Factorize by MUMPS.
   subroutine factorize_by_mumps(self, matrix, dt, error, schur)
      class(coarse_factors_t), intent(inout) :: self
      type(matrix_t), intent(in) :: matrix
      real(rk), intent(in) :: dt  !< [s]
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable, intent(inout), optional :: schur(:, :)
      integer(ik), allocatable :: row(:), col(:), kept(:), place(:)
      real(rk), allocatable :: values(:)
      integer(ik) :: i, n, n_blocks

      n_blocks = merge(matrix%n_blocks, matrix%n_cells, present(schur))
      if (.not. self%analysed) then
         call triplet_pattern(matrix, n_blocks, row, col)
         n = 3*n_blocks
         kept = [(i, i=self%at_fractures, n)]
         call dissect(neighbours_of(matrix%columns, matrix%n_cells), place, error)
         if (allocated(error)) return
         place = expand_order(place, 3_ik, n_blocks)
         call self%exchanging%analyse(n, row, col, mumps_indefinite, error, schur=kept, place=place)
         if (allocated(error)) return
         deallocate (row, col, place)  ! of the size of the matrix: not to be there with the factors
         self%analysed = .true.
      end if
      call triplet_values(matrix, n_blocks, self%scale, dt, values)
      if (present(schur)) then
         n = 3*n_blocks - self%at_fractures + 1
         if (allocated(schur)) deallocate (schur)
         allocate (schur(n, n))
         call self%exchanging%factorize(values, error, schur)
      else
         call self%exchanging%factorize(values, error)
      end if
   end subroutine factorize_by_mumps

   !> Factorize by fronts, without exchange of pivots: an error is raised if this is not stable.
   subroutine factorize_by_fronts(self, matrix, dt, schur, error)
      class(coarse_factors_t), intent(inout), target :: self
      type(matrix_t), intent(in), target :: matrix
      real(rk), intent(in) :: dt  !< [s]
      real(rk), allocatable, intent(inout) :: schur(:, :)
      type(error_t), allocatable, intent(out) :: error
      integer(ik), allocatable :: place(:)
      integer(ik) :: i, n

      n = matrix%n_blocks
      if (.not. self%analysed) then
         call dissect(neighbours_of(matrix%columns, matrix%n_cells), place, error)
         if (allocated(error)) return
         place = [place, (i, i=matrix%n_cells + 1, n)]
         call find_rows(matrix%columns, place, self%rows)
         call analyse_fronts(self, matrix, place, error)
         if (allocated(error)) return
      end if
      self%rows%matrix => matrix
      self%rows%scale => self%scale
      self%rows%dt = dt
      call self%fronts%factorize(self%rows, error)
      if (.not. allocated(error)) then
         call self%fronts%get_schur(schur)
         call check_factors(self, schur, error)
      end if
      nullify (self%rows%matrix, self%rows%scale)
   end subroutine factorize_by_fronts

   !> Analyse the pattern, each block with its element: fixed jumps are blocks alone.
   subroutine analyse_fronts(self, matrix, place, error)
      class(coarse_factors_t), intent(inout) :: self
      type(matrix_t), intent(in) :: matrix
      integer(ik), intent(in) :: place(:)  !< (n_blocks) in the order of elimination
      type(error_t), allocatable, intent(out) :: error
      type(lists_t) :: elements
      integer(ik) :: i, n, n_items, order(size(place)), part(size(place) + 1)
      integer(ik), allocatable :: alone(:), first_unknown(:)

      n = size(place, kind=ik)
      order(place) = [(i, i=1, n)]
      associate (is_fixed => self%rows%is_fixed, fixed => self%rows%fixed, &
                 blocks => self%rows%blocks)
         part(1) = 1
         do i = 1, n
            part(i + 1) = part(i) + merge(2_ik, 1_ik, is_fixed(i))
         end do
         allocate (first_unknown(part(n + 1)))
         do i = 1, n
            first_unknown(part(i)) = at_component(i, 1)
            if (is_fixed(i)) first_unknown(part(i) + 1) = at_component(i, 3)
         end do
         first_unknown(part(n + 1)) = at_component(n + 1, 1)
         alone = part(fixed)
         n_items = size(blocks%item, kind=ik)
         elements%first = [blocks%first, (n_items + 1 + i, i=1, size(fixed, kind=ik))]
         elements%item = [part(blocks%item + 1) - 1, alone]
         order = part(order + 1) - 1
         call self%fronts%analyse(first_unknown, elements, error, &
                                  kept=self%at_fractures - 1 + self%kept, &
                                  order=[order(:matrix%n_cells), alone, &
                                         order(matrix%n_cells + 1:)], &
                                  is_negative=matrix%is_pressure())
      end associate
   end subroutine analyse_fronts

   !> Measure the growth of rounding errors on a known solution: an error is raised if the
   !! elimination is not stable. The known pressure is uniform: its accuracy is lost first where
   !! pressures diffuse so fast that flows hardly depend on the stored fluid; seen from the
   !! fractures, if the fluid taken up by the rock is not accurate.
   subroutine check_factors(self, schur, error)
      class(coarse_factors_t), intent(inout) :: self
      real(rk), intent(in) :: schur(:, :)
      type(error_t), allocatable, intent(out) :: error
      real(rk), parameter :: tolerance = 1.0e-10_rk
      real(rk), allocatable :: found(:), known(:), load(:), reduced(:), sizes(:)
      logical, allocatable :: is_pressure(:)
      real(rk) :: difference, lost, pressure
      integer(ik) :: i

      known = [(cos(real(i, rk)), i=1, size(self%scale))]
      is_pressure = self%rows%matrix%is_pressure()
      pressure = minval(self%scale, mask=is_pressure)
      where (is_pressure) known = pressure/self%scale
      where (self%rows%matrix%is_difference()) known = 0.0_rk
      call clear_fixed(self%rows%fixed, known)
      load = times_scaled(self%rows, known)
      call clear_fixed(self%rows%fixed, load)
      if (size(schur) == 0) then
         found = load
         call self%fronts%solve(found, error)
         if (allocated(error)) return
         difference = 0.0_rk
      else
         associate (kept => known(self%at_fractures - 1 + self%kept))
            allocate (reduced(size(kept)), found(size(known)))
            call self%fronts%condense(load, reduced, error)
            if (allocated(error)) return
            allocate (sizes, source=0.0_rk*kept)
            do i = 1, size(kept, kind=ik)
               reduced = reduced - schur(:, i)*kept(i)
               sizes = sizes + abs(schur(:, i)*kept(i))
            end do
            difference = maxval(abs(reduced)/sizes)
            lost = abs(sum(reduced*kept, mask=modulo(self%kept, 3_ik) == 0))
            if (.not. lost <= tolerance*sum(self%rows%matrix%storage)*pressure**2) then
               difference = huge(1.0_rk)
            end if
            call self%fronts%expand(kept, found, error)
            if (allocated(error)) return
         end associate
      end if
      found = abs(found - known)  ! scaled; pressures relative to their value
      where (is_pressure) found = found*self%scale/pressure
      difference = max(difference, maxval(found))
      if (difference <= tolerance) return
      call raise_error(error, "coarse_factors_t", "elimination without exchanges is not stable")
   end subroutine check_factors

   !> Find units in which the diagonal of the matrix is 1 or -1.
   pure subroutine find_scale(matrix, dt, scale)
      type(matrix_t), intent(in) :: matrix
      real(rk), intent(in) :: dt  !< [s]
      real(rk), allocatable, intent(out) :: scale(:)  !< (3 n_blocks) [m], [m], [Pa] block by block
      real(rk) :: block(3, 3), diagonal
      integer(ik) :: a, entry, i

      allocate (scale(3*matrix%n_blocks))
      do i = 1, matrix%n_blocks
         entry = matrix%columns%last(i)
         do a = 1, 3
            diagonal = matrix%elastic(a, a, entry)
            if (a == 3) diagonal = diagonal + dt*matrix%flow(entry)
            if (allocated(matrix%of_layers)) then
               if (matrix%of_layers(entry) > 0) then
                  block = matrix%block_at(entry, dt)
                  diagonal = block(a, a)
               end if
            end if
            scale(at_component(i, a)) = 1.0_rk
            if (abs(diagonal) > 0.0_rk) scale(at_component(i, a)) = 1.0_rk/sqrt(abs(diagonal))
         end do
      end do
   end subroutine find_scale

   !> Rows and columns of the lower triangle, entry by entry.
   subroutine triplet_pattern(matrix, n_blocks, row, col)
      type(matrix_t), intent(in) :: matrix
      integer(ik), intent(in) :: n_blocks  !< so many of them
      integer(ik), allocatable, intent(out) :: row(:), col(:)
      integer(ik) :: a, b, block, entry, i, n

      n = triplet_count(matrix, n_blocks)
      allocate (row(n), col(n))
      n = 0
      do i = 1, n_blocks
         do entry = matrix%columns%first(i), matrix%columns%last(i)
            block = matrix%columns%item(entry)
            do b = 1, 3
               do a = merge(b, 1_ik, block == i), 3
                  n = n + 1
                  row(n) = at_component(i, a)
                  col(n) = at_component(block, b)
               end do
            end do
         end do
      end do
   end subroutine triplet_pattern

   !> Entries of the lower triangle, for scaled unknowns and equations.
   subroutine triplet_values(matrix, n_blocks, scale, dt, values)
      type(matrix_t), intent(in) :: matrix
      integer(ik), intent(in) :: n_blocks  !< so many of them
      real(rk), intent(in) :: scale(:)  !< (3 n_blocks) [m], [m], [Pa] block by block
      real(rk), intent(in) :: dt  !< [s]
      real(rk), allocatable, intent(out) :: values(:)  !< [-]
      integer(ik) :: a, at_col, at_row, b, entry, i, n
      real(rk) :: block(3, 3)

      allocate (values(triplet_count(matrix, n_blocks)))
      n = 0
      do i = 1, n_blocks
         at_row = at_component(i, 1) - 1
         do entry = matrix%columns%first(i), matrix%columns%last(i)
            at_col = at_component(matrix%columns%item(entry), 1) - 1
            block = matrix%block_at(entry, dt)
            do b = 1, 3
               do a = merge(b, 1_ik, at_col == at_row), 3
                  n = n + 1
                  values(n) = block(a, b)*scale(at_row + a)*scale(at_col + b)
               end do
            end do
         end do
      end do
   end subroutine triplet_values

   !> Number of entries of the lower triangle: six in a diagonal block, nine in another.
   pure integer(ik) function triplet_count(matrix, n_blocks)
      type(matrix_t), intent(in) :: matrix
      integer(ik), intent(in) :: n_blocks  !< so many of them

      triplet_count = 9*(matrix%columns%last(n_blocks) - n_blocks) + 6*n_blocks
   end function triplet_count

end module coarse_factors
