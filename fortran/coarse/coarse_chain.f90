!> A layer next to a face as a chain of volumes in series, graded from the face inwards: diffusion
!! in one dimension on distances much shorter than a cell.
!!
!! The quantity follows the gradient of a scalar, as in coarse_diffusion: for the fluid the scalar
!! is the pressure and `conductivity` the mobility K/mu; the comments give those units. Volumes lie
!! between edges that grow by a constant ratio. The nodes lie at the geometric means of the edges,
!! the first one in the middle of its volume: this is worth twice the number of nodes (compare the
!! spectrally matched grids of Druskin and Knizhnerman; Ingerman et al. 2000).
!!
!! An implicit step of length dt is
!!   T p = s - mu v + dt g_0 p_0 e_1 + dt g_n p_end e_n
!! for the inner nodes 1 .. n = N - 1, with T the storage and dt times the conductances, s the
!! content before the step, p_0 the scalar at the face, p_end that of node N, and mu a content per
!! volume that all volumes receive alike (coarse_layers). `prepare` eliminates the inner nodes:
!!   p = rho - gamma mu + alpha p_0 + beta p_end.
module coarse_chain
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: chain_t, new_chain, node_count

   type :: chain_t
      integer(ik) :: n = 0  !< nodes N, at least 2
      real(rk), allocatable :: place(:)  !< (N) distance of the nodes from the face [m]
      real(rk), allocatable :: volume(:)  !< (N) [m2]
      !> (0:N-1) between the face and node 1, then between nodes [m2/(Pa s)]
      real(rk), allocatable :: conductance(:)
      real(rk) :: storage = 0.0_rk  !< content per volume and scalar [1/Pa]
      ! Of the last step length:
      real(rk) :: dt = -1.0_rk  !< [s]
      real(rk), allocatable :: alpha(:), beta(:)  !< (N - 1) [-]
      real(rk), allocatable :: gamma(:)  !< (N - 1) [Pa]
      real(rk), allocatable :: pivot(:), factor(:)  !< of the elimination
   contains
      procedure :: prepare
      procedure :: stored
      procedure :: inner
      procedure, private :: solve
   end type chain_t

contains

   !> Number of nodes for a thickness and the thickness of the first volume.
   elemental integer(ik) function node_count(thickness, first)
      real(rk), intent(in) :: thickness  !< of the layer [m]
      real(rk), intent(in) :: first  !< thickness of the first volume [m]

      node_count = 6
      if (first < thickness/200.0_rk) node_count = 8
      if (first < thickness/5000.0_rk) node_count = 10
   end function node_count

   !> A chain on a face.
   pure function new_chain(thickness, first, length, conductivity, storage) result(chain)
      real(rk), intent(in) :: thickness  !< of the layer [m]
      real(rk), intent(in) :: first  !< thickness of the first volume; the chain may be coarser [m]
      real(rk), intent(in) :: length  !< of the face [m]
      real(rk), intent(in) :: conductivity  !< [m2/(Pa s)]
      real(rk), intent(in) :: storage  !< [1/Pa]
      type(chain_t) :: chain
      real(rk), allocatable :: edge(:)
      real(rk) :: ratio, step
      integer(ik) :: i, n

      n = node_count(thickness, first)
      ratio = growth_ratio(thickness/min(first, thickness/n), n)
      allocate (edge(0:n))
      edge(0) = 0.0_rk
      step = 1.0_rk
      do i = 1, n
         edge(i) = edge(i - 1) + step
         step = step*ratio
      end do
      edge = edge*(thickness/edge(n))
      chain%n = n
      chain%storage = storage
      chain%volume = length*(edge(1:) - edge(:n - 1))
      chain%place = [0.5_rk*edge(1), sqrt(edge(1:n - 1)*edge(2:))]
      allocate (chain%conductance(0:n - 1))
      chain%conductance = length*conductivity/(chain%place - [0.0_rk, chain%place(:n - 1)])
   end function new_chain

   !> The ratio at which n terms of a geometric series that begins with 1 have a sum, at least n.
   pure real(rk) function growth_ratio(total, n) result(ratio)
      real(rk), intent(in) :: total  !< [-]
      integer(ik), intent(in) :: n
      integer, parameter :: halvings = 60
      real(rk) :: high, low
      integer(ik) :: i, k

      low = 1.0_rk
      high = max(2.0_rk, total)
      do k = 1, halvings
         ratio = 0.5_rk*(low + high)
         if (sum([(ratio**i, i=0, n - 1)]) > total) then
            high = ratio
         else
            low = ratio
         end if
      end do
   end function growth_ratio

   !> Eliminate the inner nodes for a step length.
   pure subroutine prepare(self, dt)
      class(chain_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      real(rk) :: unit(self%n - 1)
      integer(ik) :: i, m

      m = self%n - 1
      self%dt = dt
      self%pivot = self%storage*self%volume(:m) + dt*(self%conductance(:m - 1) &
                                                      + self%conductance(1:m))
      self%factor = spread(0.0_rk, 1, int(m))
      do i = 2, m
         self%factor(i) = -dt*self%conductance(i - 1)/self%pivot(i - 1)
         self%pivot(i) = self%pivot(i) + self%factor(i)*dt*self%conductance(i - 1)
      end do
      unit = 0.0_rk
      unit(1) = dt*self%conductance(0)
      self%alpha = self%solve(unit)
      unit = 0.0_rk
      unit(m) = dt*self%conductance(m)
      self%beta = self%solve(unit)
      self%gamma = self%solve(self%volume(:m))
   end subroutine prepare

   !> T^-1 b.
   pure function solve(self, b) result(p)
      class(chain_t), intent(in) :: self
      real(rk), intent(in) :: b(:)  !< (N - 1) [m2]
      real(rk) :: p(size(b))  !< [Pa]
      integer(ik) :: i, m

      m = size(b, kind=ik)
      p = b
      do i = 2, m
         p(i) = p(i) - self%factor(i)*p(i - 1)
      end do
      p(m) = p(m)/self%pivot(m)
      do i = m - 1, 1, -1
         p(i) = (p(i) + self%dt*self%conductance(i)*p(i + 1))/self%pivot(i)
      end do
   end function solve

   !> rho: what the content before the step alone gives.
   pure function stored(self, before) result(rho)
      class(chain_t), intent(in) :: self
      real(rk), intent(in) :: before(:)  !< (N - 1) scalars before the step [Pa]
      real(rk) :: rho(size(before))  !< [Pa]

      rho = self%solve(self%storage*self%volume(:size(before))*before)
   end function stored

   !> The inner nodes after the step.
   pure function inner(self, rho, mu, at_face, at_end) result(p)
      class(chain_t), intent(in) :: self
      real(rk), intent(in) :: rho(:)  !< of `stored` [Pa]
      real(rk), intent(in) :: mu  !< content per volume [-]
      real(rk), intent(in) :: at_face, at_end  !< p_0 and that of node N [Pa]
      real(rk) :: p(size(rho))  !< [Pa]

      p = rho - self%gamma*mu + self%alpha*at_face + self%beta*at_end
   end function inner

end module coarse_chain
