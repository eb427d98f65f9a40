!> Unknowns that are eliminated from a full matrix: each is linked to a few others by an equation
!! that contains only these,
!!   step(unknown) = rest + sum_k share_k step(partner_k)
!! and is eliminated together with its equation. In networks most unknowns are linked: where faces
!! stick the jumps do not change, those that slip open with their slip alone, in rock that conducts
!! far less than the fractures the pressures of the faces are those of the fluid, and along a
!! fracture each pressure of the fluid follows from the one before and the flow between.
!!
!! The links are in the order of elimination: partners are eliminated later, or remain.
module algebra_links
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: equations_together, links_t, new_links

   !> Equations from which links are eliminated together, as a block.
   integer(ik), parameter :: equations_together = 64

   type :: links_t
      integer(ik) :: n = 0  !< links
      integer(ik), allocatable :: unknown(:)  !< (n) of each link
      integer(ik), allocatable :: first(:)  !< (n + 1) where its partners begin
      integer(ik), allocatable :: partner(:)
      real(rk), allocatable :: share(:)  !< of each partner [-]
      integer(ik), allocatable :: equation(:, :)  !< (2, n) that the rest follows from; 0: none
      real(rk), allocatable :: factor(:, :)  !< (2, n) rest = sum of factor * residual [-]
      real(rk), allocatable :: rest(:)  !< (n) [Pa]
      logical, allocatable :: is_linked(:)  !< (unknowns)
      logical, allocatable :: is_used(:)  !< (equations)
   contains
      procedure :: link
      procedure :: link_pair
      procedure :: kept_unknowns
      procedure :: kept_equations
      procedure :: that_count
      procedure :: take_residual
      procedure :: reduce
      procedure :: complete
   end type links_t

contains

   !> Nothing is linked yet.
   pure function new_links(n) result(links)
      integer(ik), intent(in) :: n  !< unknowns, and equations
      type(links_t) :: links

      allocate (links%unknown(n), links%first(n + 1), links%rest(n))
      allocate (links%equation(2, n), source=0_ik)
      allocate (links%factor(2, n), source=0.0_rk)
      allocate (links%partner(8*n), links%share(8*n))
      allocate (links%is_linked(n), links%is_used(n), source=.false.)
      links%first(1) = 1
   end function new_links

   !> Add a link; its unknown and its equation must still be there, and so must its partners.
   pure subroutine link(self, unknown, equation, factor, partner, share)
      class(links_t), intent(inout) :: self
      integer(ik), intent(in) :: unknown
      !> The first leaves with the unknown; of a second one only the residual counts. 0: none.
      integer(ik), intent(in) :: equation(2)
      real(rk), intent(in) :: factor(2)  !< of their residuals [-]
      integer(ik), intent(in) :: partner(:)
      real(rk), intent(in) :: share(:)  !< [-]
      integer(ik) :: begin

      self%n = self%n + 1
      begin = self%first(self%n)
      if (begin + size(partner) > size(self%partner)) then
         self%partner = [self%partner, self%partner]
         self%share = [self%share, self%share]
      end if
      self%unknown(self%n) = unknown
      self%equation(:, self%n) = equation
      self%factor(:, self%n) = factor
      self%first(self%n + 1) = begin + size(partner, kind=ik)
      self%partner(begin:self%first(self%n + 1) - 1) = partner
      self%share(begin:self%first(self%n + 1) - 1) = share
      self%is_linked(unknown) = .true.
      self%is_used(equation(1)) = .true.
   end subroutine link

   !> Link an unknown and the next one, as far as the two equations of these numbers hold no others.
   pure subroutine link_pair(self, at, own, is_own)
      class(links_t), intent(inout) :: self
      integer(ik), intent(in) :: at  !< the first one's number
      real(rk), intent(in) :: own(2, 2)  !< (equation, unknown) derivatives [-]
      logical, intent(in) :: is_own(2)  !< the equation holds no other unknown
      integer(ik), parameter :: none(0) = [integer(ik) ::]
      real(rk), parameter :: nothing(0) = [real(rk) ::]
      real(rk) :: determinant

      if (.not. is_own(1) .or. .not. abs(own(1, 1)) > 0.0_rk) return
      if (is_own(2)) then
         determinant = own(1, 1)*own(2, 2) - own(1, 2)*own(2, 1)
         if (.not. abs(determinant) > 0.0_rk) return
         call self%link(at, [at, at + 1], [-own(2, 2), own(1, 2)]/determinant, none, nothing)
         call self%link(at + 1, [at + 1, at], [-own(1, 1), own(2, 1)]/determinant, none, nothing)
      else
         call self%link(at, [at, 0_ik], [-1.0_rk/own(1, 1), 0.0_rk], [at + 1], &
                        [-own(1, 2)/own(1, 1)])
      end if
   end subroutine link_pair

   !> Unknowns that are not linked.
   pure function kept_unknowns(self) result(numbers)
      class(links_t), intent(in) :: self
      integer(ik), allocatable :: numbers(:)
      integer(ik) :: i

      numbers = pack([(i, i=1, size(self%is_linked, kind=ik))],.not. self%is_linked)
   end function kept_unknowns

   !> Equations that are not used by links.
   pure function kept_equations(self) result(numbers)
      class(links_t), intent(in) :: self
      integer(ik), allocatable :: numbers(:)
      integer(ik) :: i

      numbers = pack([(i, i=1, size(self%is_used, kind=ik))],.not. self%is_used)
   end function kept_equations

   !> Unknowns whose derivatives count: all but those that are linked to nothing and do not change.
   pure function that_count(self) result(counts)
      class(links_t), intent(in) :: self
      logical :: counts(size(self%is_linked))
      integer(ik) :: k

      counts = .true.
      do k = 1, self%n
         counts(self%unknown(k)) = self%first(k + 1) > self%first(k) .or. abs(self%rest(k)) > 0.0_rk
      end do
   end function that_count

   !> Set the constant parts of the links from the residuals of their equations.
   pure subroutine take_residual(self, residual)
      class(links_t), intent(inout) :: self
      real(rk), intent(in) :: residual(:)  !< (equations) [Pa]
      integer(ik) :: k, m

      do k = 1, self%n
         self%rest(k) = 0.0_rk
         do m = 1, 2
            if (self%equation(m, k) == 0) cycle
            self%rest(k) = self%rest(k) + self%factor(m, k)*residual(self%equation(m, k))
         end do
      end do
   end subroutine take_residual

   !> Eliminate the linked unknowns from equations.
   pure subroutine reduce(self, rows, residual)
      class(links_t), intent(in) :: self
      real(rk), intent(inout) :: rows(:, :)  !< (equations, unknowns) derivatives [-]
      real(rk), intent(inout) :: residual(:)  !< (equations) [Pa]
      integer(ik) :: j, k

      do k = 1, self%n
         associate (own => rows(:, self%unknown(k)))
            if (.not. any(abs(own) > 0.0_rk)) cycle
            residual = residual + own*self%rest(k)
            do j = self%first(k), self%first(k + 1) - 1
               rows(:, self%partner(j)) = rows(:, self%partner(j)) + own*self%share(j)
            end do
         end associate
      end do
   end subroutine reduce

   !> The linked unknowns from those that stay.
   pure subroutine complete(self, step)
      class(links_t), intent(in) :: self
      real(rk), intent(inout) :: step(:)  !< (unknowns) [Pa]
      integer(ik) :: j, k

      do k = self%n, 1, -1
         associate (own => step(self%unknown(k)))
            own = self%rest(k)
            do j = self%first(k), self%first(k + 1) - 1
               own = own + self%share(j)*step(self%partner(j))
            end do
         end associate
      end do
   end subroutine complete

end module algebra_links
