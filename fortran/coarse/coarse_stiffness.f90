!> The matrix S of the body condensed onto its fractures (coarse_condensed): forces and volumes by
!! jumps and face pressures, without the rows and columns of jumps that are held at zero.
module coarse_stiffness
   use algebra_lapack, only: symmetric_product
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: new_stiffness, stiffness_t

   !> S for q in [m], [Pa] and forces in [N/m], volumes in [m2].
   type :: stiffness_t
      real(rk), allocatable :: entry(:, :)  !< (kept, kept) symmetric
      integer(ik), allocatable :: kept(:)  !< numbers in q of the rows
      integer(ik), allocatable :: place(:)  !< (6 n) the row of each number in q; 0: held
      real(rk), allocatable, private :: body(:)  !< (kept) diagonal without springs
   contains
      procedure :: turn
      procedure :: support
      procedure :: diagonal
      procedure :: product => times
   end type stiffness_t

contains

   !> S from a symmetric matrix of scaled unknowns, which is given away.
   subroutine new_stiffness(matrix, kept, scale, stiffness)
      real(rk), allocatable, intent(inout) :: matrix(:, :)  !< (kept, kept) [-]
      integer(ik), intent(in) :: kept(:)  !< numbers in q, ascending
      real(rk), intent(in) :: scale(:)  !< (6 n) units of the unknowns [m], [Pa]
      type(stiffness_t), intent(out) :: stiffness
      integer(ik) :: i

      call move_alloc(matrix, stiffness%entry)
      stiffness%kept = kept
      allocate (stiffness%place(size(scale)), source=0_ik)
      stiffness%place(kept) = [(i, i=1, size(kept, kind=ik))]
      associate (s => scale(kept))
         do i = 1, size(kept, kind=ik)
            stiffness%entry(:, i) = stiffness%entry(:, i)/(s*s(i))
         end do
      end associate
      stiffness%body = stiffness%diagonal(kept)
   end subroutine new_stiffness

   !> Turn pairs of jumps and their forces from x, y to n, tau: tau is n turned by -90 degrees.
   pure subroutine turn(self, at, normal)
      class(stiffness_t), intent(inout) :: self
      integer(ik), intent(in) :: at(:)  !< (pairs) number in q of the first of each; some are held
      real(rk), intent(in) :: normal(:, :)  !< (2, pairs) [-]
      real(rk) :: first(size(self%kept)), n(2, size(at))
      integer(ik) :: i, k, row(size(at))

      k = 0
      do i = 1, size(at, kind=ik)
         if (self%place(at(i)) == 0) cycle
         k = k + 1
         row(k) = self%place(at(i))
         n(:, k) = normal(:, i)
      end do
      associate (entry => self%entry)
         do i = 1, size(entry, 2, kind=ik)
            call turn_pairs(row(:k), n(:, :k), entry(:, i))
         end do
         do i = 1, k
            first = entry(:, row(i))
            entry(:, row(i)) = n(1, i)*first + n(2, i)*entry(:, row(i) + 1)
            entry(:, row(i) + 1) = n(2, i)*first - n(1, i)*entry(:, row(i) + 1)
         end do
      end associate
      self%body = self%diagonal(self%kept)
   end subroutine turn

   !> Turn pairs of components.
   pure subroutine turn_pairs(row, n, v)
      integer(ik), intent(in) :: row(:)  !< of the first of each pair
      real(rk), intent(in) :: n(:, :)  !< (2, pairs) [-]
      real(rk), intent(inout) :: v(:)
      integer(ik) :: i

      do i = 1, size(row, kind=ik)
         v(row(i):row(i) + 1) = [n(1, i)*v(row(i)) + n(2, i)*v(row(i) + 1), &
                                 n(2, i)*v(row(i)) - n(1, i)*v(row(i) + 1)]
      end do
   end subroutine turn_pairs

   !> Replace the springs on the unknowns.
   pure subroutine support(self, spring)
      class(stiffness_t), intent(inout) :: self
      real(rk), intent(in) :: spring(:)  !< (6 n) [Pa]
      integer(ik) :: i

      do i = 1, size(self%kept, kind=ik)
         self%entry(i, i) = self%body(i) + spring(self%kept(i))
      end do
   end subroutine support

   !> Entry on the diagonal, of a number in q; 0 where it is held.
   elemental real(rk) function diagonal(self, at)
      class(stiffness_t), intent(in) :: self
      integer(ik), intent(in) :: at

      diagonal = 0.0_rk
      if (self%place(at) > 0) diagonal = self%entry(self%place(at), self%place(at))
   end function diagonal

   !> S q, 0 where jumps are held.
   function times(self, q) result(force)
      class(stiffness_t), intent(in) :: self
      real(rk), intent(in) :: q(:)  !< (6 n) [m], [Pa]
      real(rk) :: force(size(q))  !< [N/m], [m2]

      force = 0.0_rk
      force(self%kept) = symmetric_product(self%entry, q(self%kept))
   end function times

end module coarse_stiffness
