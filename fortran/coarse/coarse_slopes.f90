!> The derivatives of the equations on the fractures, in two parts: each equation contains a few
!! unknowns of its neighbours, and at most two of the forces or volumes with which the condensed
!! body responds, which depend on all jumps and face pressures:
!!   d residual_k = sum_j local_kj dx_j + sum_m weight_km d force_m
!! with force_m a function of q = q_per_x x(x_of_q). They are stored as short lists, for a full
!! matrix (coarse_full_step) or rows of a sparse one (coarse_sparse_step).
module coarse_slopes
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: slopes_t

   integer(ik), parameter :: forces_max = 2

   type :: slopes_t
      integer(ik) :: n = 0  !< equations
      integer(ik) :: n_local = 0  !< entries of the local part; several may have the same place
      integer(ik), allocatable :: row(:), col(:)  !< of each
      real(rk), allocatable :: value(:)  !< of each [-]
      integer(ik), allocatable :: force(:, :)  !< (2, n) numbers in q; 0: none
      !> (2, n) [1/m] of a force, [Pa/m2] of a volume
      real(rk), allocatable :: weight(:, :)
      integer(ik), allocatable :: x_of_q(:)  !< (6 n) the number of each unknown of q in x
      real(rk), allocatable :: q_per_x(:)  !< (6 n) their units [m/Pa], [-]
      integer(ik), allocatable :: first(:)  !< (n + 1) where those of each equation begin in
      integer(ik), allocatable :: local(:)  !< the numbers of the local entries; see by_row
   contains
      procedure :: clear
      procedure :: add
      procedure :: add_force
      procedure :: by_row
      procedure :: has_forces
      procedure :: apply
      procedure :: apply_transposed
   end type slopes_t

contains

   !> Begin with derivatives that are all zero.
   pure subroutine clear(self, n)
      class(slopes_t), intent(inout) :: self
      integer(ik), intent(in) :: n  !< equations

      if (self%n /= n .or. .not. allocated(self%row)) then
         if (allocated(self%row)) deallocate (self%row, self%col, self%value, self%force, &
                                              self%weight)
         allocate (self%row(16*n), self%col(16*n), self%value(16*n))
         allocate (self%force(forces_max, n), self%weight(forces_max, n))
         self%n = n
      end if
      self%n_local = 0
      self%force = 0
      self%weight = 0.0_rk
   end subroutine clear

   !> Add to the derivative of an equation by an unknown.
   pure subroutine add(self, row, col, value)
      class(slopes_t), intent(inout) :: self
      integer(ik), intent(in) :: row  !< the equation
      integer(ik), intent(in) :: col  !< the unknown
      real(rk), intent(in) :: value  !< [-]

      if (self%n_local == size(self%row)) then
         self%row = [self%row, self%row]
         self%col = [self%col, self%col]
         self%value = [self%value, self%value]
      end if
      self%n_local = self%n_local + 1
      self%row(self%n_local) = row
      self%col(self%n_local) = col
      self%value(self%n_local) = value
   end subroutine add

   !> Number the local entries equation by equation.
   pure subroutine by_row(self)
      class(slopes_t), intent(inout) :: self
      integer(ik) :: k, row
      integer(ik), allocatable :: next(:)

      if (allocated(self%first)) deallocate (self%first, self%local)
      allocate (self%first(self%n + 1), source=0_ik)
      do k = 1, self%n_local
         self%first(self%row(k) + 1) = self%first(self%row(k) + 1) + 1
      end do
      self%first(1) = 1
      do row = 1, self%n
         self%first(row + 1) = self%first(row) + self%first(row + 1)
      end do
      next = self%first(:self%n)
      allocate (self%local(self%n_local))
      do k = 1, self%n_local
         self%local(next(self%row(k))) = k
         next(self%row(k)) = next(self%row(k)) + 1
      end do
   end subroutine by_row

   !> An equation holds a force or volume now.
   pure logical function has_forces(self, row)
      class(slopes_t), intent(in) :: self
      integer(ik), intent(in) :: row  !< the equation

      has_forces = any(abs(self%weight(:, row)) > 0.0_rk)
   end function has_forces

   !> An equation holds a force or volume. Its place is kept with a weight of zero too: the pattern
   !! is to be the same in every state.
   pure subroutine add_force(self, row, force, weight)
      class(slopes_t), intent(inout) :: self
      integer(ik), intent(in) :: row  !< the equation
      integer(ik), intent(in) :: force  !< its number in q
      real(rk), intent(in) :: weight  !< [1/m] of a force, [Pa/m2] of a volume
      integer(ik) :: m

      m = merge(1_ik, 2_ik, self%force(1, row) == 0)
      self%force(m, row) = force
      self%weight(m, row) = weight
   end subroutine add_force

   !> The product with unknowns and the forces that belong to them.
   pure subroutine apply(self, x, force, y)
      class(slopes_t), intent(in) :: self
      real(rk), intent(in) :: x(:)  !< (n) [Pa]
      real(rk), intent(in) :: force(:)  !< (6 n) [N/m], [m2]
      real(rk), intent(out) :: y(:)  !< (n) [Pa]
      integer(ik) :: k, m, row

      y = 0.0_rk
      do k = 1, self%n_local
         y(self%row(k)) = y(self%row(k)) + self%value(k)*x(self%col(k))
      end do
      do row = 1, self%n
         do m = 1, forces_max
            associate (i => self%force(m, row))
               if (i > 0) y(row) = y(row) + self%weight(m, row)*force(i)
            end associate
         end do
      end do
   end subroutine apply

   !> The product of the transpose.
   pure subroutine apply_transposed(self, y, x, force)
      class(slopes_t), intent(in) :: self
      real(rk), intent(in) :: y(:)  !< (n)
      real(rk), intent(out) :: x(:), force(:)  !< (n) of local entries, (6 n) of the forces
      integer(ik) :: k, m, row

      x = 0.0_rk
      force = 0.0_rk
      do k = 1, self%n_local
         x(self%col(k)) = x(self%col(k)) + self%value(k)*y(self%row(k))
      end do
      do row = 1, self%n
         do m = 1, forces_max
            associate (i => self%force(m, row))
               if (i > 0) force(i) = force(i) + self%weight(m, row)*y(row)
            end associate
         end do
      end do
   end subroutine apply_transposed

end module coarse_slopes
