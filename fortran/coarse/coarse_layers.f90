!> Layers of fluid pressure thinner than a cell, next to faces where the pressure is that of a
!! fracture or of a drained side of the body (docs/theory.md).
!!
!! On each such face a chain of graded volumes (coarse_chain) lies in series between the face and
!! the stencils of the cell. Its resistance is taken out of that of the stencils, its volume out of
!! that of the cell. At the outer end of the chain the stencils see, instead of the pressure at the
!! face, a pressure at each end of the face. Their mean is the pressure of the last node, so that
!! the chain carries the mean flux; their difference keeps the resistance that has been taken out.
!! The mean and half the difference are unknowns.
!!
!! A cell with layers keeps its equation for the mean pressure pbar. The volumes of its layers and
!! the rest of the cell, with pressures p_i, have w_i = p_i - pbar, sum v_i w_i = 0. In a thin layer
!! the total stress across it and the strain along it are those of the cell: the content of a volume
!! per area is that of the cell plus S* w_i, S* = S + alpha^2/(lambda + 2 G). The stencils of stress
!! contain pbar, those of flow the pressure of the rest.
!!
!! The multiplier mu of the constraint is the change, per area, of the content beyond S* pbar. It
!! and the inner nodes of the chains are eliminated for each step length; the remaining terms are
!! symmetric, and couple the pressures of one cell with each other.
module coarse_layers
   use base_kinds, only: ik, rk
   use base_lists, only: lists_t
   use coarse_chain, only: chain_t
   use coarse_layout, only: at_component
   use coarse_matrix, only: matrix_t
   use scene_sides, only: boundary_side_t
   implicit none(type, external)
   private

   public :: layers_t

   type :: layers_t
      integer(ik) :: n = 0
      integer(ik) :: n_nodes = 0  !< the most of a chain
      real(rk) :: dt = -1.0_rk  !< of the terms [s]
      type(chain_t), allocatable :: chain(:)  !< (n)
      integer(ik), allocatable :: cell(:)  !< (n)
      integer(ik), allocatable :: face_of_cell(:)  !< (n) which face of its cell
      integer(ik), allocatable :: fracture_cell(:)  !< (n) 0 on the outer boundary
      integer(ik), allocatable :: side(:)  !< (n) of the fracture cell 1 +, 2 -; or of the body
      !> (3, n) numbers of the unknowns: pressure at the face (0: given); mean and half difference
      !! at the outer end
      integer(ik), allocatable :: at(:, :)
      logical, allocatable :: extended(:)  !< (n) it is thicker than usual (coarse_layer_places)
      real(rk), allocatable :: between(:)  !< (n) between the ends of the face [m2/(Pa s)]
      !> (n) taken out of the resistance of each end in coarse_diffusion [Pa s]
      real(rk), allocatable :: relief(:)
      ! Cells with layers:
      integer(ik), allocatable :: cells(:)
      type(lists_t) :: of_cell  !< layers of each of them
      real(rk), allocatable :: volume(:), rest(:)  !< of the cell, without its layers [m2]
      real(rk), allocatable :: storage(:)  !< S* [1/Pa]
      real(rk), allocatable :: compliance(:)  !< of the inner nodes for mu [m2 Pa]
      real(rk), allocatable :: rho(:, :)  !< (n_nodes - 1, n) of the present step [Pa]
      real(rk), allocatable :: means(:, :)  !< (2, n) the same over the step, next to both ends [Pa]
      real(rk), allocatable :: first_mean(:)  !< (n) mean of the first node in the step [Pa]
      real(rk), allocatable :: given(:)  !< (n) pressure at the face in the present step [Pa]
   contains
      procedure :: set_terms
      procedure :: set_given
      procedure :: add_load
      procedure :: update
      procedure :: begin
      procedure :: drained
      procedure :: on_sides
   end type layers_t

contains

   !> Numbers of the unknowns of a cell with layers: mean pressure, that of the rest, and those of
   !! its layers.
   pure function numbers_of(self, k) result(number)
      class(layers_t), intent(in) :: self
      integer(ik), intent(in) :: k  !< of the cells with layers
      integer(ik) :: number(2 + 3*self%of_cell%length(k))
      integer(ik) :: i

      number(1) = at_component(self%cells(k), 3_ik)
      number(2) = self%at(2, self%of_cell%at(k, 1_ik)) + 2
      do i = 1, self%of_cell%length(k)
         number(3*i:3*i + 2) = self%at(:, self%of_cell%at(k, i))
      end do
   end function numbers_of

   !> The terms of the layers of one cell, in the order of numbers_of, and their part from mu.
   pure subroutine find_terms(self, k, matrix, of_mu)
      class(layers_t), intent(in) :: self
      integer(ik), intent(in) :: k
      real(rk), intent(out) :: matrix(:, :)  !< [m2/Pa]
      real(rk), intent(out) :: of_mu(:)  !< mu per unknown, times the compliance [m2]
      integer(ik) :: a, b, i, l
      real(rk) :: across, weight

      matrix = 0.0_rk
      of_mu(1) = -self%volume(k)
      of_mu(2) = self%rest(k)
      matrix(1, 1) = -self%storage(k)*self%volume(k)
      matrix(2, 2) = self%storage(k)*self%rest(k)
      do i = 1, self%of_cell%length(k)
         l = self%of_cell%at(k, i)
         a = 3*i
         associate (chain => self%chain(l), n => self%chain(l)%n)
            of_mu(a) = dot_product(chain%volume(:n - 1), chain%alpha)
            of_mu(a + 1) = dot_product(chain%volume(:n - 1), chain%beta) + chain%volume(n)
            of_mu(a + 2) = 0.0_rk
            weight = chain%mean_weight
            matrix(a, a) = self%dt*chain%conductance(0)*(weight - chain%near_face(1))
            across = -self%dt*chain%conductance(0)*chain%near_face(2)
            matrix(a, a + 1) = across
            matrix(a + 1, a) = across
            matrix(a + 1, a + 1) = chain%storage*chain%volume(n) &
                                   + self%dt*chain%conductance(n - 1)*(weight - chain%near_end)
            matrix(a + 2, a + 2) = self%dt*self%between(l)
         end associate
      end do
      do b = 1, size(of_mu, kind=ik)
         matrix(:, b) = matrix(:, b) + of_mu*(of_mu(b)/self%compliance(k))
      end do
   end subroutine find_terms

   !> Set the terms of the layers in the matrix for a step length.
   subroutine set_terms(self, dt, matrix)
      class(layers_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      type(matrix_t), intent(inout) :: matrix
      integer(ik) :: a, b, i, k, l
      integer(ik), allocatable :: number(:)
      real(rk), allocatable :: terms(:, :), of_mu(:)

      if (self%n == 0) return
      self%dt = dt
      matrix%layer_terms = 0.0_rk
      do k = 1, size(self%cells, kind=ik)
         self%compliance(k) = 0.0_rk
         do i = 1, self%of_cell%length(k)
            l = self%of_cell%at(k, i)
            call self%chain(l)%prepare(dt)
            associate (chain => self%chain(l))
               self%compliance(k) = self%compliance(k) + dot_product(chain%volume(:chain%n - 1), &
                                                                     chain%gamma)
            end associate
         end do
         number = numbers_of(self, k)
         allocate (terms(size(number), size(number)), of_mu(size(number)))
         call find_terms(self, k, terms, of_mu)
         do b = 1, size(number, kind=ik)
            do a = 1, size(number, kind=ik)
               if (number(a) == 0 .or. number(b) == 0) cycle
               call matrix%add_layer_term(number(a), number(b), -terms(a, b), .false.)
            end do
         end do
         do i = 2, self%of_cell%length(k)
            ! Only the first layer of a cell has an unknown for the rest of the cell.
            associate (unused => self%at(2, self%of_cell%at(k, i)) + 2)
               call matrix%add_layer_term(unused, unused, -1.0_rk, .false.)
            end associate
         end do
         deallocate (terms, of_mu)
      end do
   end subroutine set_terms

   !> Set the pressures at the faces on the outer boundary.
   pure subroutine set_given(self, sides)
      class(layers_t), intent(inout) :: self
      type(boundary_side_t), intent(in) :: sides(:)
      integer(ik) :: l

      do l = 1, self%n
         if (self%fracture_cell(l) == 0) self%given(l) = sides(self%side(l))%pressure
      end do
   end subroutine set_given

   !> Add what the layers contain before a step to the right-hand side, which is negated.
   subroutine add_load(self, unknowns, inner, load)
      class(layers_t), intent(inout) :: self
      real(rk), intent(in), contiguous, target :: unknowns(:, :)  !< (3, n_blocks) before the step
      real(rk), intent(in) :: inner(:, :)  !< (n_nodes - 1, n) inner nodes before the step [Pa]
      real(rk), intent(inout), contiguous, target :: load(:, :)  !< (3, n_blocks) [N/m], [m2]
      real(rk), pointer :: p(:), into(:)
      real(rk), allocatable :: terms(:, :), of_mu(:), rhs(:)
      integer(ik), allocatable :: number(:)
      real(rk) :: ends(2), flow(2), known
      integer(ik) :: a, i, k, l

      p(1:size(unknowns)) => unknowns
      into(1:size(load)) => load
      do k = 1, size(self%cells, kind=ik)
         number = numbers_of(self, k)
         allocate (terms(size(number), size(number)), of_mu(size(number)), rhs(size(number)))
         call find_terms(self, k, terms, of_mu)
         rhs = 0.0_rk
         rhs(1) = -self%storage(k)*self%volume(k)*p(number(1))
         rhs(2) = self%storage(k)*self%rest(k)*p(number(2))
         known = 0.0_rk
         do i = 1, self%of_cell%length(k)
            l = self%of_cell%at(k, i)
            a = 3*i
            associate (chain => self%chain(l), n => self%chain(l)%n)
               ends = [self%given(l), p(number(a + 1))]
               if (number(a) > 0) ends(1) = p(number(a))
               call chain%stored(inner(:n - 1, l), ends, self%rho(:n - 1, l), self%means(:, l))
               known = known + dot_product(chain%volume(:n - 1), self%rho(:n - 1, l))
               flow = self%dt*chain%conductance([0_ik, n - 1]) &
                      *(self%means(:, l) - (1.0_rk - chain%mean_weight)*ends)
               rhs(a) = flow(1)
               rhs(a + 1) = chain%storage*chain%volume(n)*ends(2) + flow(2)
            end associate
         end do
         rhs = rhs - of_mu*(known/self%compliance(k))
         do i = 1, self%of_cell%length(k)
            if (number(3*i) > 0) cycle
            rhs = rhs - terms(:, 3*i)*self%given(self%of_cell%at(k, i))
         end do
         do a = 1, size(number, kind=ik)
            if (number(a) > 0) into(number(a)) = into(number(a)) - rhs(a)
         end do
         deallocate (terms, of_mu, rhs)
      end do
   end subroutine add_load

   !> The inner nodes after the step.
   pure subroutine update(self, unknowns, inner)
      class(layers_t), intent(inout) :: self
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) after the step
      real(rk), intent(inout) :: inner(:, :)  !< (n_nodes - 1, n) [Pa]
      integer(ik) :: i, k, l
      real(rk) :: at_end, at_face, mu
      real(rk), allocatable :: p(:)

      p = reshape(unknowns, [size(unknowns)])
      do k = 1, size(self%cells, kind=ik)
         mu = self%rest(k)*p(self%at(2, self%of_cell%at(k, 1_ik)) + 2) &
              - self%volume(k)*unknowns(3, self%cells(k))
         do i = 1, self%of_cell%length(k)
            l = self%of_cell%at(k, i)
            call find_ends(l, at_face, at_end)
            associate (chain => self%chain(l), n => self%chain(l)%n)
               mu = mu + dot_product(chain%volume(:n - 1), self%rho(:n - 1, l) &
                                     + chain%alpha*at_face + chain%beta*at_end) &
                    + chain%volume(n)*at_end
            end associate
         end do
         mu = mu/self%compliance(k)
         do i = 1, self%of_cell%length(k)
            l = self%of_cell%at(k, i)
            call find_ends(l, at_face, at_end)
            associate (chain => self%chain(l), n => self%chain(l)%n)
               inner(:n - 1, l) = chain%inner(self%rho(:n - 1, l), mu, at_face, at_end)
               self%first_mean(l) = self%means(1, l) - chain%mean_gamma(1)*mu &
                                    + dot_product(chain%near_face, [at_face, at_end])
            end associate
         end do
      end do

   contains

      !> The pressures at the face and of the last node.
      pure subroutine find_ends(l, at_face, at_end)
         integer(ik), intent(in) :: l
         real(rk), intent(out) :: at_face, at_end  !< [Pa]

         at_end = p(self%at(2, l))
         at_face = self%given(l)
         if (self%at(1, l) > 0) at_face = p(self%at(1, l))
      end subroutine find_ends

   end subroutine update

   !> The pressures of a state that is uniform in each cell: in the layers they are those of the
   !! cells.
   pure subroutine begin(self, unknowns, inner)
      class(layers_t), intent(in) :: self
      real(rk), intent(inout) :: unknowns(:, :)  !< (3, n_blocks)
      real(rk), allocatable, intent(out) :: inner(:, :)  !< (n_nodes - 1, n) [Pa]
      integer(ik) :: l

      allocate (inner(self%n_nodes - 1, self%n))
      do l = 1, self%n
         inner(:, l) = unknowns(3, self%cell(l))
         unknowns(:, (self%at(2, l) + 2)/3) = unknowns(3, self%cell(l))*[1.0_rk, 0.0_rk, 1.0_rk]
      end do
   end subroutine begin

   !> Which sides of the fracture cells have layers.
   pure function on_sides(self, n_cells) result(has_layer)
      class(layers_t), intent(in) :: self
      integer(ik), intent(in) :: n_cells  !< of the fractures
      logical :: has_layer(2, n_cells)
      integer(ik) :: l

      has_layer = .false.
      do l = 1, self%n
         if (self%fracture_cell(l) > 0) has_layer(self%side(l), self%fracture_cell(l)) = .true.
      end do
   end function on_sides

   !> Fluid that leaves the body through layers on its outer boundary in a step [m2].
   pure real(rk) function drained(self)
      class(layers_t), intent(in) :: self
      integer(ik) :: l

      drained = 0.0_rk
      do l = 1, self%n
         if (self%fracture_cell(l) > 0) cycle
         drained = drained + self%dt*self%chain(l)%conductance(0) &
                   *(self%first_mean(l) - self%given(l))
      end do
   end function drained

end module coarse_layers
