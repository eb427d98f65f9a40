!> A layer next to a face as a chain of volumes in series, graded from the face inwards: diffusion
!! in one dimension on distances much shorter than a cell.
!!
!! The quantity follows the gradient of a scalar, as in coarse_diffusion: for the fluid the scalar
!! is the pressure and `conductivity` the mobility K/mu; the comments give those units. Volumes lie
!! between edges that grow by a constant ratio. The nodes lie at the geometric means of the edges,
!! the first one in the middle of its volume: this is worth twice the number of nodes (compare the
!! spectrally matched grids of Druskin and Knizhnerman; Ingerman et al. 2000).
!!
!! In a step of length dt the inner nodes 1 .. n = N - 1 take m implicit steps of length h = dt/m,
!!   T p_k = C p_(k-1) - mu v/m + h g_0 p_0k e_1 + h g_n p_end,k e_n,
!! with C the storage, T = C + h times the conductances, p_0 the scalar at the face, p_end that of
!! node N, and mu a content per volume that all volumes receive alike in the step (coarse_layers).
!! The scalars at both ends change linearly in the step (a prescribed one is that after it). With
!! m = 4 the flow into a thin layer has a fourth of the error of m = 1. But where the whole chain
!! follows its ends within the step, the scalar at a face that stores little would oscillate from
!! step to step; with m = 1 it does not. The result is the mean of both, weighted by the length of
!! the step: symmetric, without negative coefficients, and with the balance of each.
!!
!! The elimination of the inner nodes:
!!   p = rho - gamma mu + alpha p_0 + beta p_end after the step,
!! and the same for the means over the step, which determine the flow in it.
module coarse_chain
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: chain_t, new_chain, node_count

   integer, parameter :: parts(2) = [1, 4]  !< m of the two schemes

   !> Implicit steps of the inner nodes in a step of the chain.
   type :: scheme_t
      integer :: parts = 1  !< m
      real(rk) :: share = 1.0_rk  !< weight in the mean of the schemes [-]
      real(rk), allocatable :: pivot(:), factor(:)  !< (N - 1) of the elimination; pivots inverted
   end type scheme_t

   type :: chain_t
      integer(ik) :: n = 0  !< nodes N, at least 2
      real(rk), allocatable :: place(:)  !< (N) distance of the nodes from the face [m]
      real(rk), allocatable :: volume(:)  !< (N) [m2]
      !> (0:N-1) between the face and node 1, then between nodes [m2/(Pa s)]
      real(rk), allocatable :: conductance(:)
      real(rk) :: storage = 0.0_rk  !< content per volume and scalar [1/Pa]
      ! Of the last step length:
      real(rk) :: dt = -1.0_rk  !< [s]
      type(scheme_t) :: scheme(2)
      real(rk), allocatable :: alpha(:), beta(:)  !< (N - 1) [-]
      real(rk), allocatable :: gamma(:)  !< (N - 1) [Pa]
      !> mean over the step, of the scalars at the ends by those after it [-]
      real(rk) :: mean_weight = 1.0_rk
      !> mean coefficients: of the first inner node for p_0 and p_end, of the last for p_end [-]
      real(rk) :: near_face(2) = 0.0_rk, near_end = 0.0_rk
      real(rk) :: mean_gamma(2) = 0.0_rk  !< of the first and the last inner node [Pa]
   contains
      procedure :: prepare
      procedure :: stored
      procedure :: inner
      procedure :: uptake_error
   end type chain_t

contains

   !> Number of nodes for a thickness and the thickness of the first volume.
   elemental integer(ik) function node_count(thickness, first)
      real(rk), intent(in) :: thickness  !< of the layer [m]
      real(rk), intent(in) :: first  !< thickness of the first volume [m]

      node_count = 7
      if (first < thickness/200.0_rk) node_count = 10
      if (first < thickness/5000.0_rk) node_count = 14
   end function node_count

   !> A chain on a face.
   pure function new_chain(thickness, first, length, conductivity, storage, times_finer) &
      & result(chain)
      real(rk), intent(in) :: thickness  !< of the layer [m]
      real(rk), intent(in) :: first  !< thickness of the first volume; the chain may be coarser [m]
      real(rk), intent(in) :: length  !< of the face [m]
      real(rk), intent(in) :: conductivity  !< [m2/(Pa s)]
      real(rk), intent(in) :: storage  !< [1/Pa]
      integer(ik), intent(in), optional :: times_finer  !< more nodes by this factor
      type(chain_t) :: chain
      real(rk), allocatable :: edge(:)
      real(rk) :: ratio, step
      integer(ik) :: i, n

      n = node_count(thickness, first)
      if (present(times_finer)) n = n*times_finer
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
      real(rk) :: high, low, series
      integer(ik) :: i, k

      low = 1.0_rk
      high = max(2.0_rk, total)
      do k = 1, halvings
         ratio = 0.5_rk*(low + high)
         series = 1.0_rk
         do i = 2, n
            series = 1.0_rk + ratio*series
         end do
         if (series > total) then
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
      real(rk) :: blend
      integer :: k

      self%dt = dt
      ! c dt over the squares of the thickness of the chain and of its first volume; storage over
      ! conductance at the face is half the square of the latter over c.
      associate (over_all => dt/(self%storage*sum(self%volume)*sum(1.0_rk/self%conductance)), &
                 of_first => 2.0_rk*self%storage*self%volume(1)/(self%conductance(0)*dt))
         blend = 1.0_rk/(1.0_rk + over_all + of_first)
      end associate
      self%scheme%parts = parts
      self%scheme%share = [1.0_rk - blend, blend]
      self%alpha = spread(0.0_rk, 1, int(self%n) - 1)
      self%beta = self%alpha
      self%gamma = self%alpha
      self%mean_weight = 0.0_rk
      self%near_face = 0.0_rk
      self%near_end = 0.0_rk
      self%mean_gamma = 0.0_rk
      do k = 1, size(parts)
         call factorize(self, self%scheme(k))
         call add_response(self, self%scheme(k))
      end do
   end subroutine prepare

   !> Factors of T.
   pure subroutine factorize(self, scheme)
      class(chain_t), intent(inout) :: self
      type(scheme_t), intent(inout) :: scheme
      real(rk) :: h, left
      integer(ik) :: i, m

      m = self%n - 1
      h = self%dt/scheme%parts
      scheme%pivot = self%storage*self%volume(:m)
      if (.not. allocated(scheme%factor)) allocate (scheme%factor(m))
      scheme%factor(1) = 0.0_rk
      ! Pivots less the conductance outwards are sums of positive terms: no digits are lost.
      left = scheme%pivot(1) + h*self%conductance(0)
      scheme%pivot(1) = left + h*self%conductance(1)
      do i = 2, m
         scheme%factor(i) = h*self%conductance(i - 1)/scheme%pivot(i - 1)
         left = scheme%pivot(i) + scheme%factor(i)*left
         scheme%pivot(i) = left + h*self%conductance(i)
      end do
      scheme%pivot = 1.0_rk/scheme%pivot
   end subroutine factorize

   !> Add the share of a scheme in the coefficients.
   pure subroutine add_response(self, scheme)
      class(chain_t), intent(inout) :: self
      type(scheme_t), intent(in) :: scheme
      real(rk) :: first(3), h, last(3), response(self%n - 1, 3)
      integer(ik) :: i, m
      integer :: k

      m = self%n - 1
      h = self%dt/scheme%parts
      response = 0.0_rk
      first = 0.0_rk
      last = 0.0_rk
      do k = 1, scheme%parts
         do i = 1, 3
            response(:, i) = self%storage*self%volume(:m)*response(:, i)
         end do
         response(1, 1) = response(1, 1) + h*self%conductance(0)*k/scheme%parts
         response(m, 2) = response(m, 2) + h*self%conductance(m)*k/scheme%parts
         response(:, 3) = response(:, 3) + self%volume(:m)/scheme%parts
         do i = 1, 3
            call solve(scheme, response(:, i))
         end do
         first = first + response(1, :)/scheme%parts
         last = last + response(m, :)/scheme%parts
      end do
      associate (share => scheme%share)
         self%alpha = self%alpha + share*response(:, 1)
         self%beta = self%beta + share*response(:, 2)
         self%gamma = self%gamma + share*response(:, 3)
         self%mean_weight = self%mean_weight + share*0.5_rk*(1.0_rk + 1.0_rk/scheme%parts)
         self%near_face = self%near_face + share*first(:2)
         self%near_end = self%near_end + share*last(2)
         self%mean_gamma = self%mean_gamma + share*[first(3), last(3)]
      end associate
   end subroutine add_response

   !> Solve T p = b in place.
   pure subroutine solve(scheme, p)
      type(scheme_t), intent(in) :: scheme
      real(rk), intent(inout) :: p(:)  !< (N - 1) b [m2], then [Pa]
      integer(ik) :: i, m

      m = size(p, kind=ik)
      do i = 2, m
         p(i) = p(i) + scheme%factor(i)*p(i - 1)
      end do
      p(m) = p(m)*scheme%pivot(m)
      do i = m - 1, 1, -1
         p(i) = p(i)*scheme%pivot(i) + scheme%factor(i + 1)*p(i + 1)
      end do
   end subroutine solve

   !> rho: the scalars after the step that follow from those before it alone, and their means over
   !! the step next to both ends.
   pure subroutine stored(self, before, ends, rho, means)
      class(chain_t), intent(in) :: self
      real(rk), intent(in) :: before(:)  !< (N - 1) scalars before the step [Pa]
      real(rk), intent(in) :: ends(2)  !< p_0 and that of node N before the step [Pa]
      real(rk), intent(out) :: rho(:)  !< (N - 1) [Pa]
      real(rk), intent(out) :: means(2)  !< of the first and the last inner node [Pa]
      real(rk) :: from_ends(2), p(size(before))
      integer :: i, k, m

      m = size(before)
      rho = 0.0_rk
      means = 0.0_rk
      do i = 1, size(self%scheme)
         associate (scheme => self%scheme(i), parts => self%scheme(i)%parts)
            p = before
            do k = 1, parts
               p = self%storage*self%volume(:m)*p
               if (k < parts) then
                  from_ends = real(parts - k, rk)/parts**2*self%dt*self%conductance([0, m])*ends
                  p(1) = p(1) + from_ends(1)
                  p(m) = p(m) + from_ends(2)
               end if
               call solve(scheme, p)
               means = means + scheme%share/parts*p([1, m])
            end do
            rho = rho + scheme%share*p
         end associate
      end do
   end subroutine stored

   !> The inner nodes after the step.
   pure function inner(self, rho, mu, at_face, at_end) result(p)
      class(chain_t), intent(in) :: self
      real(rk), intent(in) :: rho(:)  !< of `stored` [Pa]
      real(rk), intent(in) :: mu  !< content per volume [-]
      real(rk), intent(in) :: at_face, at_end  !< p_0 and that of node N [Pa]
      real(rk) :: p(size(rho))  !< [Pa]

      p = rho - self%gamma*mu + self%alpha*at_face + self%beta*at_end
   end function inner

   !> Relative error of what the rock takes up through the face within a time. The response of an
   !! infinite body to a change exp(s t) at its face, s = 1/time, is compared with that of the chain
   !! with the rest of such a body, whose own response is that of cells and has a relative error,
   !! `of_rest` times 1/(1 + c time/(4 l)**2), l the thickness of the chain [-].
   pure real(rk) function uptake_error(self, time, of_rest) result(error)
      class(chain_t), intent(in) :: self
      real(rk), intent(in) :: time  !< [s]
      real(rk), intent(in) :: of_rest  !< [-]
      real(rk) :: exact, off, response(2), resistance, thickness
      integer(ik) :: i

      thickness = 2.0_rk*self%place(1)*sum(self%volume)/self%volume(1)
      resistance = 1.0_rk/(self%conductance(0)*self%place(1))  ! per length
      associate (s => 1.0_rk/time, c_over_s => time*self%conductance(0)*self%place(1) &
                 /(self%storage*self%volume(1)/(2.0_rk*self%place(1))))
         exact = 1.0_rk/(resistance*sqrt(c_over_s))
         off = of_rest/(1.0_rk + c_over_s/(4.0_rk*thickness)**2)
         response = exact*[1.0_rk, 1.0_rk + off]
         response = 1.0_rk/(1.0_rk/response + resistance*(thickness - self%place(self%n)))
         do i = self%n, 1, -1
            response = response + s*self%storage*self%volume(i)
            response = 1.0_rk/(1.0_rk/response + 1.0_rk/self%conductance(i - 1))
         end do
      end associate
      error = abs(response(1)/exact - 1.0_rk) + abs(response(2) - response(1))/exact
   end function uptake_error

end module coarse_chain
