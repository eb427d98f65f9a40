!> The matrix equations condensed onto the fractures.
!!
!! Between two changes of the mesh or of the time step the rock is linear with constant
!! coefficients. It is factorized once and condensed onto the jumps and the pressures of the
!! fracture cells. The result is a dense relation between jumps, pressures, tractions and fluxes on
!! the fractures:
!!   S q - g = ( -l/2 (f_n - p_F), -l/2 f_tau at the start, dt l lambda+,
!!               -l/2 (f_n - p_F), -l/2 f_tau at the end,   dt l lambda- )
!!         q = ( [u]_n, [u]_tau at the start, p+, [u]_n, [u]_tau at the end, p- ),
!! six of each per fracture cell (condensed_layout_t), jumps and forces in n, tau of the cell.
!!
!! Cells that stick without a jump may be held (coarse_held_cells): their jumps are no unknowns, and
!! g and S q have zeros instead.
!!
!! For many fracture cells S is not formed: its size grows with the square of their number, and the
!! cost of its elimination with the cube. The rock is then factorized without its fractures, and S q
!! costs one solution with these factors (coarse_coupling).
module coarse_condensed
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use coarse_coupling, only: coupling_t, find_coupling
   use coarse_factors, only: coarse_factors_t
   use coarse_layout, only: condensed_layout_t
   use coarse_matrix, only: matrix_t
   use coarse_stiffness, only: new_stiffness, stiffness_t
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: condensed_t

   !> Factors of the matrix and the dense system on the fractures, for one mesh and one time step.
   type :: condensed_t
      real(rk) :: dt = -1.0_rk  !< the factorized time step [s]; negative: none
      integer(ik) :: factorizations = 0  !< number so far; identifies factors
      logical :: is_full = .true.  !< S is formed; to be chosen before the first factorization
      type(stiffness_t) :: stiffness  !< S, with springs; if full
      type(coupling_t) :: coupling  !< of the fractures with the rest; unless full
      !> (3 n_cells) response of the cells to the last q; unless full [m], [m], [Pa]
      real(rk), allocatable :: rock(:)
      !> (6 n) diagonal of S as far as it is known, else huge; unless full
      real(rk), allocatable :: diagonal(:)
      real(rk), allocatable :: spring(:)  !< (6 n) springs, added to the diagonal [Pa]
      real(rk), allocatable :: normal(:, :)  !< (2, n) from side + to side - [-]
      real(rk), allocatable :: length(:)  !< (n) [m]
      integer(ik) :: n = 0  !< fracture cells
      type(condensed_layout_t) :: layout  !< of q
      type(coarse_factors_t) :: factors
      logical, allocatable :: held(:)  !< (n) cells that are held; unallocated: none
      logical :: analysed = .false.  !< whether the pattern of the mesh has been analysed
   contains
      procedure :: forget
      procedure :: hold
      procedure :: holds
      procedure :: factorize
      procedure :: support
      procedure :: condense
      procedure :: expand
      procedure :: find_forces
      procedure :: find_reactions
      procedure :: find_volume_slopes
   end type condensed_t

contains

   !> Begin with another mesh. By default S is formed where this costs less: forming it grows with
   !! the cube of the fracture cells, and is done once per step size; the sparse matrix, whose cost
   !! grows with the cells to the power 1.2, is factorized in each iteration on contact, and growth
   !! takes several trials of each step.
   subroutine forget(self, mesh, condensation, grows)
      class(condensed_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh
      character(len=*), intent(in) :: condensation  !< "auto", "full" or "sparse"
      logical, intent(in) :: grows
      ! Where both cost the same, with three iterations or more per step and with one. With 2000
      ! fracture cells S takes 1.2 GB, and what comes with it twice as much.
      real(rk), parameter :: cells_per_square = 90.0_rk, of_many = 30.0_rk
      integer(ik), parameter :: few = 800, few_that_grow = 2000

      call self%factors%release()
      if (allocated(self%held)) deallocate (self%held)
      associate (n => mesh%fracture%n_cells)
         self%is_full = real(n, rk)**2 <= mesh%n_cells*merge(cells_per_square, of_many, &
                                                             n <= merge(few_that_grow, few, grows))
         if (condensation /= "auto") self%is_full = condensation == "full"
         self%is_full = self%is_full .or. n == 0
      end associate
      self%analysed = .false.
      self%dt = -1.0_rk
   end subroutine forget

   !> Hold cells from the next factorization on.
   pure subroutine hold(self, held)
      class(condensed_t), intent(inout) :: self
      logical, intent(in) :: held(:)  !< (n)

      self%held = held
      self%analysed = .false.
      self%dt = -1.0_rk
   end subroutine hold

   !> Whether a cell is held.
   pure logical function holds(self, cell)
      class(condensed_t), intent(in) :: self
      integer(ik), intent(in) :: cell

      holds = allocated(self%held)
      if (holds) holds = self%held(cell)
   end function holds

   !> Factorize for a time step and condense.
   subroutine factorize(self, mesh, matrix, dt, error)
      class(condensed_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh
      type(matrix_t), intent(in) :: matrix
      real(rk), intent(in) :: dt  !< [s]
      type(error_t), allocatable, intent(out) :: error
      integer(ik), allocatable :: fixed(:)
      real(rk), allocatable :: schur(:, :)
      integer(ik) :: cell, end

      self%dt = -1.0_rk
      self%factorizations = self%factorizations + 1
      if (.not. self%analysed) then
         if (allocated(self%rock)) deallocate (self%rock)  ! of another mesh
         call self%factors%release()
         self%n = mesh%fracture%n_cells
         self%layout = condensed_layout_t(self%n)
         call find_frames(mesh, self%normal, self%length)
         self%analysed = .true.
      end if
      if (self%is_full) then
         fixed = pack([((2*cell - 2 + end, end=1, 2), cell=1, self%n)], &
                      [((self%holds(cell), end=1, 2), cell=1, self%n)])
         call self%factors%factorize(matrix, dt, error, schur, matrix%n_cells + fixed)
         if (allocated(error)) return
         if (allocated(self%held) .and. .not. self%factors%by_fronts) deallocate (self%held)
         associate (factors => self%factors, layout => self%layout)
            call new_stiffness(schur, factors%kept, factors%scale(factors%at_fractures:), &
                               self%stiffness)
            call self%stiffness%turn([((layout%at_jump(cell, end), end=1, 2), cell=1, self%n)], &
                                     self%normal(:, [((cell, end=1, 2), cell=1, self%n)]))
            self%spring = spread(0.0_rk, 1, layout%count())
         end associate
      else
         call self%factors%factorize(matrix, dt, error)
         if (allocated(error)) return
         call find_coupling(matrix, self%normal, dt, self%coupling)
         self%spring = spread(0.0_rk, 1, self%layout%count())
         self%diagonal = spread(huge(1.0_rk), 1, self%layout%count())
      end if
      self%dt = dt
   end subroutine factorize

   !> Load g on the fractures.
   subroutine condense(self, rhs, g, error)
      class(condensed_t), intent(inout) :: self
      !> (3, n_blocks) [N/m], [N/m], [m2], fracture cells without their tractions and fluxes
      real(rk), intent(in) :: rhs(:, :)
      real(rk), intent(out) :: g(:)  !< (6 n) [N/m], [N/m], [m2]
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: b(:), all(:)

      if (self%n == 0) return
      if (self%is_full) then
         all = reshape(rhs, [size(rhs)])*self%factors%scale
         call self%factors%condense(all, g, error)
         g = g/self%factors%scale(self%factors%at_fractures:)
         call turn(self, g)
      else
         all = reshape(rhs, [size(rhs)])
         b = all(:self%coupling%n_bulk)
         call solve_rock(self, b, error)
         call self%coupling%forces(b, spread(0.0_rk, 1, size(g)), g)
         associate (own => all(self%factors%at_fractures:))
            call turn(self, own)
            g = own - g
         end associate
      end if
   end subroutine condense

   !> All unknowns from q on the fractures, or, without fractures, from the right-hand side.
   subroutine expand(self, q, rhs, unknowns, error)
      class(condensed_t), intent(inout) :: self
      real(rk), intent(in) :: q(:)  !< (6 n) [m], [m], [Pa]
      real(rk), intent(in) :: rhs(:, :)  !< (3, n_blocks) [N/m], [N/m], [m2]
      real(rk), intent(out) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: x(size(rhs), 1)
      real(rk), allocatable :: b(:), jumps(:)

      x(:, 1) = reshape(rhs, [size(rhs)])
      if (self%n == 0) then
         x(:, 1) = x(:, 1)*self%factors%scale
         call self%factors%solve(x, error)
         unknowns = reshape(x(:, 1)*self%factors%scale, shape(unknowns))
         return
      end if
      jumps = q
      call turn(self, jumps)
      if (self%is_full) then
      call self%factors%expand(jumps/self%factors%scale(self%factors%at_fractures:), x(:, 1), error)
         x(:, 1) = x(:, 1)*self%factors%scale
      else
         allocate (b(self%coupling%n_bulk))
         call self%coupling%bulk_load(q, b)
         b = x(:size(b), 1) - b
         call solve_rock(self, b, error)
         x(:size(b), 1) = b
         x(self%factors%at_fractures:, 1) = jumps
      end if
      unknowns = reshape(x(:, 1), shape(unknowns))
   end subroutine expand

   !> S q.
   subroutine find_forces(self, q, force, error)
      class(condensed_t), intent(inout) :: self
      real(rk), intent(in) :: q(:)  !< (6 n) [m], [m], [Pa]
      real(rk), intent(out) :: force(:)  !< (6 n) [N/m], [N/m], [m2]
      type(error_t), allocatable, intent(out) :: error

      if (self%is_full) then
         force = self%stiffness%product(q)
      else
         if (.not. allocated(self%rock)) allocate (self%rock(self%coupling%n_bulk))
         call self%coupling%bulk_load(q, self%rock)
         call solve_rock(self, self%rock, error)
         self%rock = -self%rock
         call self%coupling%forces(self%rock, q, force)
         force = force + self%spring*q
      end if
   end subroutine find_forces

   !> Forces on the cells that are held, once all unknowns are known, in the order of q. They are
   !! those of the solution less the loads on the faces.
   subroutine find_reactions(self, matrix, unknowns, rhs, g, force)
      class(condensed_t), intent(in) :: self
      type(matrix_t), intent(in) :: matrix
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), intent(in) :: rhs(:, :)  !< (3, n_blocks) [N/m], [N/m], [m2]
      real(rk), intent(in) :: g(:)  !< (6 n) load on the condensed system [N/m], [m2]
      real(rk), intent(out) :: force(:)  !< (6 n), zero where nothing is held [N/m], [m2]
      real(rk) :: block(3, 3), own(3, 2*self%n)
      integer(ik) :: at, cell, end, i, j, k

      own = -rhs(:, matrix%n_cells + 1:)
      do i = 1, 2*self%n
         associate (columns => matrix%columns, row => matrix%n_cells + i)
            do k = columns%first(row), columns%last(row)
               block = matrix%block_at(k, self%dt)
               j = columns%item(k)
               own(:, i) = own(:, i) + matmul(block, unknowns(:, j))
               j = j - matrix%n_cells
               if (j > 0 .and. j /= i) own(:, j) = own(:, j) + matmul(unknowns(:, row), block)
            end do
         end associate
      end do
      force = reshape(own, [6*self%n])
      call turn(self, force)
      force = force - g
      do cell = 1, self%n
         if (self%holds(cell)) cycle
         do end = 1, 2
            at = self%layout%at_jump(cell, end)
            force(at:at + 1) = 0.0_rk
         end do
      end do
   end subroutine find_reactions

   !> Derivatives of the volumes of some faces by their own pressures: entries on the diagonal of S,
   !! without springs.
   subroutine find_volume_slopes(self, at, slope, error)
      class(condensed_t), intent(inout) :: self
      integer(ik), intent(in) :: at(:)  !< numbers in q
      real(rk), intent(out) :: slope(:)  !< [m2/Pa]
      type(error_t), allocatable, intent(out) :: error
      integer(ik), allocatable :: missing(:)

      if (self%is_full) then
         slope = self%stiffness%diagonal(at)
      else
         missing = pack(at,.not. self%diagonal(at) < huge(1.0_rk))
         call find_diagonal(self, missing, error)
         slope = self%diagonal(at)
      end if
   end subroutine find_volume_slopes

   !> Find entries on the diagonal of S, each by one solution with the factors of the rock.
   subroutine find_diagonal(self, at, error)
      class(condensed_t), intent(inout) :: self
      integer(ik), intent(in) :: at(:)  !< numbers in q
      type(error_t), allocatable, intent(out) :: error
      integer(ik), parameter :: together = 32  ! right-hand sides
      real(rk) :: q(self%layout%count())
      real(rk), allocatable :: answer(:, :), row(:, :)
      integer(ik) :: first, i, n

      q = 0.0_rk
      associate (scale => self%factors%scale(:self%coupling%n_bulk))
         do first = 1, size(at), together
            n = min(together, size(at, kind=ik) - first + 1)
            allocate (row(size(scale), n))
            do i = 1, n
               q(at(first + i - 1)) = 1.0_rk
               call self%coupling%bulk_load(q, row(:, i))
               q(at(first + i - 1)) = 0.0_rk
               row(:, i) = row(:, i)*scale
            end do
            answer = row
            call self%factors%solve(answer, error)
            if (allocated(error)) return
            do i = 1, n
               associate (place => at(first + i - 1))
                  self%diagonal(place) = self%coupling%diagonal(place) &
                                         - dot_product(row(:, i), answer(:, i))
               end associate
            end do
            deallocate (row)
         end do
      end associate
   end subroutine find_diagonal

   !> The unknowns of the cells, those on the fractures being zero, instead of the right-hand side.
   subroutine solve_rock(self, b, error)
      class(condensed_t), intent(inout) :: self
      real(rk), intent(inout) :: b(:)  !< from [N/m], [m2] to [m], [Pa] cell by cell
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: x(:, :)

      associate (scale => self%factors%scale(:size(b)))
         allocate (x(size(b), 1))
         x(:, 1) = b*scale
         call self%factors%solve(x, error)
         b = x(:, 1)*scale
      end associate
   end subroutine solve_rock

   !> Replace the springs on the unknowns of q.
   pure subroutine support(self, spring)
      class(condensed_t), intent(inout) :: self
      real(rk), intent(in) :: spring(:)  !< (6 n) [Pa]

      if (self%is_full) call self%stiffness%support(spring)
      self%spring = spring
   end subroutine support

   !> Turn jumps or forces from x, y to n, tau of their fracture cells, or back: tau is n turned by
   !! -90 degrees, and the turn is its own inverse.
   pure subroutine turn(self, v)
      class(condensed_t), intent(in) :: self
      real(rk), intent(inout) :: v(:)  !< (6 n) [m] or [N/m]; the pressures or volumes stay
      integer(ik) :: at, end, i

      do i = 1, self%n
         associate (n => self%normal(:, i))
            do end = 1, 2
               at = self%layout%at_jump(i, end)
               v(at:at + 1) = [n(1)*v(at) + n(2)*v(at + 1), n(2)*v(at) - n(1)*v(at + 1)]
            end do
         end associate
      end do
   end subroutine turn

   !> Normal (from side + to side -) and length of each fracture cell.
   subroutine find_frames(mesh, normal, length)
      type(mesh_t), intent(in) :: mesh
      real(rk), allocatable, intent(out) :: normal(:, :)  !< (2, n) [-]
      real(rk), allocatable, intent(out) :: length(:)  !< (n) [m]
      integer(ik) :: i
      real(rk) :: tangent(2)

      allocate (normal(2, mesh%fracture%n_cells), length(mesh%fracture%n_cells))
      do i = 1, mesh%fracture%n_cells
         associate (points => mesh%fracture%cell_points(:, i))
            tangent = mesh%fracture%point_xy(:, points(2)) - mesh%fracture%point_xy(:, points(1))
         end associate
         length(i) = norm2(tangent)
         normal(:, i) = [-tangent(2), tangent(1)]/length(i)
      end do
   end subroutine find_frames

end module coarse_condensed
