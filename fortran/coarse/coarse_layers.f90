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
   use base_lists, only: inverted, lists_t
   use coarse_chain, only: chain_t, new_chain
   use coarse_layout, only: at_component, end_block, layer_block
   use coarse_matrix, only: matrix_t
   use coarse_rock, only: rock_t, solid_t
   use mesh_geometry, only: cell_area, cell_centre, face_length
   use mesh_types, only: mesh_t
   use scene_sides, only: boundary_side_t
   implicit none(type, external)
   private

   public :: give_back, layers_t, no_profiles, place_layers, profiles_t

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
      real(rk), allocatable :: given(:)  !< (n) pressure at the face in the present step [Pa]
   contains
      procedure :: add_tip_flow
      procedure :: set_terms
      procedure :: set_given
      procedure :: add_load
      procedure :: update
      procedure :: begin
      procedure :: drained
      procedure :: on_sides
      procedure :: find_pressure
      procedure :: profiles
      procedure :: take_profiles
      procedure :: set_apart
   end type layers_t

   !> Pressures in the layers, for their transfer to another mesh.
   type :: profiles_t
      integer(ik), allocatable :: cell(:), face_of_cell(:), fracture_cell(:), side(:)
      integer(ik), allocatable :: n(:)  !< nodes
      real(rk), allocatable :: place(:, :)  !< distance of the nodes from the face [m]
      real(rk), allocatable :: value(:, :)  !< (nodes, and then that of the rest of the cell) [Pa]
      !> Content beyond that at the pressure of the rest of the cell, of layers that are kept [m2]
      real(rk), allocatable :: excess(:)
   end type profiles_t

   !> A layer is at most this part of the distance of the centre of the cell from the face, and
   !! those of m faces at most the other part over m [-].
   real(rk), parameter :: thickest = 0.8_rk, all_together = 1.35_rk
   !> Thickness of the first volume over sqrt(c dt) of the first step [-].
   real(rk), parameter :: first_volume = 0.5_rk
   !> What flows round a tip beyond the flow in one dimension, per side, over the mobility and the
   !! difference of pressure [-].
   real(rk), parameter :: round_tip = 0.3_rk
   !> No layer where sqrt(c dt) of the first step exceeds so many heights of the cell [-].
   real(rk), parameter :: wide = 2.0_rk

contains

   !> Choose the faces that get layers, number the layers in the mesh, and set up their chains.
   subroutine place_layers(mesh, rock, sides, first_step, layers)
      type(mesh_t), intent(inout) :: mesh
      type(rock_t), intent(in) :: rock
      type(boundary_side_t), intent(in) :: sides(:)
      real(rk), intent(in) :: first_step  !< [s]
      type(layers_t), intent(out) :: layers
      logical :: is_layered(3)
      integer(ik) :: c, f, k, l
      integer(ik), allocatable :: cell(:), face_of_cell(:)

      mesh%n_layers = 0
      if (allocated(mesh%layer_face)) deallocate (mesh%layer_face, mesh%face_layer, mesh%cell_layer)
      allocate (cell(0), face_of_cell(0))
      do c = 1, mesh%n_cells
         do k = 1, 3
            f = mesh%cell_faces(k, c)
            is_layered(k) = mesh%face_fracture_cell(f) > 0
            if (mesh%face_side(f) > 0) is_layered(k) = sides(mesh%face_side(f))%pressure_given
            if (.not. is_layered(k)) cycle
            associate (height => 2.0_rk*cell_area(mesh, c)/face_length(mesh, f))
               is_layered(k) = diffusivity(mesh, rock, c, f)*first_step <= (wide*height)**2
            end associate
         end do
         cell = [cell, spread(c, 1, count(is_layered))]
         face_of_cell = [face_of_cell, pack([1_ik, 2_ik, 3_ik], is_layered)]
      end do
      layers%n = size(cell, kind=ik)
      if (layers%n == 0) return
      allocate (mesh%face_layer(mesh%n_faces), mesh%cell_layer(mesh%n_cells), source=0_ik)
      mesh%n_layers = layers%n
      mesh%layer_face = [(mesh%cell_faces(face_of_cell(l), cell(l)), l=1, layers%n)]
      do l = layers%n, 1, -1
         mesh%face_layer(mesh%layer_face(l)) = l
         mesh%cell_layer(cell(l)) = l
      end do
      layers%cell = cell
      layers%face_of_cell = face_of_cell
      call set_up(mesh, rock, first_step, layers)
   end subroutine place_layers

   !> K/mu across a face [m2/(Pa s)].
   pure real(rk) function mobility_across(mesh, rock, cell, face)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      integer(ik), intent(in) :: cell, face
      real(rk) :: along(2)

      along = mesh%xy(:, mesh%face_nodes(2, face)) - mesh%xy(:, mesh%face_nodes(1, face))
      along = along/norm2(along)
      associate (r => rock%resistivity(:, :, min(cell, size(rock%resistivity, 3, kind=ik))))
         ! n . K n = t . R t/det R
         mobility_across = dot_product(along, matmul(r, along))/(r(1, 1)*r(2, 2) - r(1, 2)*r(2, 1))
      end associate
   end function mobility_across

   !> c across a face, at uniaxial strain [m2/s].
   pure real(rk) function diffusivity(mesh, rock, cell, face)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      integer(ik), intent(in) :: cell, face

      diffusivity = mobility_across(mesh, rock, cell, face)/uniaxial_storage(rock, cell)
   end function diffusivity

   !> S* [1/Pa].
   pure real(rk) function uniaxial_storage(rock, cell)
      type(rock_t), intent(in) :: rock
      integer(ik), intent(in) :: cell
      type(solid_t) :: solid

      solid = rock%solid_at(cell)
      uniaxial_storage = solid%storage + solid%biot**2/(solid%lame + 2.0_rk*solid%shear)
   end function uniaxial_storage

   !> The chains, their places among the unknowns, and the cells they lie in.
   subroutine set_up(mesh, rock, first_step, layers)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      real(rk), intent(in) :: first_step  !< [s]
      type(layers_t), intent(inout) :: layers
      real(rk) :: mobility, storage, thickness
      integer(ik) :: f, k, l, n
      integer(ik), allocatable :: place(:)

      n = layers%n
      allocate (layers%chain(n), layers%fracture_cell(n), layers%side(n), layers%at(3, n))
      allocate (layers%between(n), layers%relief(n), layers%given(n), source=0.0_rk)
      layers%cells = pack(layers%cell, [.true., layers%cell(2:) /= layers%cell(:n - 1)])
      allocate (place(n))
      k = 0
      do l = 1, n
         if (mesh%cell_layer(layers%cell(l)) == l) k = k + 1
         place(l) = k
      end do
      layers%of_cell = inverted(reshape(place, [1_ik, n]), size(layers%cells, kind=ik))
      allocate (layers%volume(size(layers%cells)), layers%storage(size(layers%cells)))
      allocate (layers%compliance(size(layers%cells)), source=0.0_rk)
      do k = 1, size(layers%cells, kind=ik)
         layers%volume(k) = cell_area(mesh, layers%cells(k))
         layers%storage(k) = uniaxial_storage(rock, layers%cells(k))
      end do
      layers%rest = layers%volume
      do l = 1, n
         f = mesh%layer_face(l)
         associate (c => layers%cell(l), length => face_length(mesh, f))
            layers%fracture_cell(l) = mesh%face_fracture_cell(f)
            layers%at(2:3, l) = at_component(layer_block(mesh, l), [1_ik, 2_ik])
            if (layers%fracture_cell(l) > 0) then
               layers%side(l) = findloc(mesh%fracture%cell_faces(:, layers%fracture_cell(l)), f, &
                                        dim=1)
               layers%at(1, l) = at_component(end_block(mesh, layers%fracture_cell(l), &
                                                        layers%side(l)), 3_ik)
            else
               layers%side(l) = mesh%face_side(f)
               layers%at(1, l) = 0
            end if
            mobility = mobility_across(mesh, rock, c, f)
            storage = layers%storage(place(l))
            thickness = min(thickest, all_together/layers%of_cell%length(place(l))) &
                        *2.0_rk/3.0_rk*layers%volume(place(l))/length
            layers%chain(l) = new_chain(thickness, &
                                        first_volume*sqrt(mobility/storage*first_step), length, &
                                        mobility, storage)
            associate (chain => layers%chain(l))
               layers%between(l) = mobility*length/chain%place(chain%n)
               layers%relief(l) = 0.5_rk*length*chain%place(chain%n)/mobility
               layers%rest(place(l)) = layers%rest(place(l)) - sum(chain%volume)
               layers%n_nodes = max(layers%n_nodes, chain%n)
            end associate
         end associate
      end do
      allocate (layers%rho(layers%n_nodes - 1, n), source=0.0_rk)
   end subroutine set_up

   !> Flow round tips: a conductance from the faces of a tip's cell with layers to the cell ahead.
   pure subroutine add_tip_flow(self, mesh, rock, matrix)
      class(layers_t), intent(in) :: self
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(matrix_t), intent(inout) :: matrix
      integer(ik) :: ahead, cell, side, tip
      real(rk) :: conductance

      if (self%n == 0) return
      associate (fracture => mesh%fracture)
         do tip = 1, fracture%n_tips
            cell = fracture%point_cells%at(fracture%tip_point(tip), 1_ik)
            ahead = cell_ahead(mesh, tip)
            do side = 1, 2
               if (mesh%face_layer(fracture%cell_faces(side, cell)) == 0) cycle
               conductance = round_tip*rock%mobility_at(ahead)
            call add(matrix, end_block(mesh, cell, side), end_block(mesh, cell, side), -conductance)
               call add(matrix, ahead, ahead, -conductance)
               call add(matrix, end_block(mesh, cell, side), ahead, conductance)
            end do
         end do
      end associate

   contains

      pure subroutine add(matrix, row, col, flow)
         type(matrix_t), intent(inout) :: matrix
         integer(ik), intent(in) :: row, col  !< blocks
         real(rk), intent(in) :: flow  !< [m2/(Pa s)]

         associate (entry => matrix%entry_at(row, col))
            matrix%flow(entry) = matrix%flow(entry) + flow
         end associate
      end subroutine add

   end subroutine add_tip_flow

   !> The cell at a tip whose centre lies most nearly ahead of it.
   pure integer(ik) function cell_ahead(mesh, tip) result(ahead)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: tip
      real(rk) :: along, most, offset(2)
      integer(ik) :: c

      ahead = 0
      most = -2.0_rk
      associate (node => mesh%fracture%tip_node(tip))
         do c = 1, mesh%n_cells
            if (.not. any(mesh%cell_nodes(:, c) == node)) cycle
            offset = cell_centre(mesh, c) - mesh%xy(:, node)
            along = dot_product(offset, mesh%fracture%tip_direction(:, tip))/norm2(offset)
            if (along > most) then
               most = along
               ahead = c
            end if
         end do
      end associate
   end function cell_ahead

   !> Numbers of the unknowns of a cell with layers: mean pressure, that of the rest, and those of
   !! its layers.
   pure function numbers_of(self, k, mesh_first) result(number)
      class(layers_t), intent(in) :: self
      integer(ik), intent(in) :: k  !< of the cells with layers
      integer(ik), intent(in) :: mesh_first  !< number of its first outer end
      integer(ik) :: number(2 + 3*self%of_cell%length(k))
      integer(ik) :: i

      number(1) = at_component(self%cells(k), 3_ik)
      number(2) = mesh_first + 2
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
      real(rk) :: across

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
            matrix(a, a) = self%dt*chain%conductance(0)*(1.0_rk - chain%alpha(1))
            across = -self%dt*chain%conductance(0)*chain%beta(1)
            matrix(a, a + 1) = across
            matrix(a + 1, a) = across
            matrix(a + 1, a + 1) = chain%storage*chain%volume(n) &
                                   + self%dt*chain%conductance(n - 1)*(1.0_rk - chain%beta(n - 1))
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
         number = numbers_of(self, k, self%at(2, self%of_cell%at(k, 1_ik)))
         allocate (terms(size(number), size(number)), of_mu(size(number)))
         call find_terms(self, k, terms, of_mu)
         do b = 1, size(number, kind=ik)
            do a = 1, size(number, kind=ik)
               if (number(a) == 0 .or. number(b) == 0) cycle
               call matrix%add_layer_term(number(a), number(b), -terms(a, b))
            end do
         end do
         do i = 2, self%of_cell%length(k)
            ! Only the first layer of a cell has an unknown for the rest of the cell.
            associate (unused => self%at(2, self%of_cell%at(k, i)) + 2)
               call matrix%add_layer_term(unused, unused, -1.0_rk)
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
      real(rk) :: known
      integer(ik) :: a, i, k, l

      p(1:size(unknowns)) => unknowns
      into(1:size(load)) => load
      do k = 1, size(self%cells, kind=ik)
         number = numbers_of(self, k, self%at(2, self%of_cell%at(k, 1_ik)))
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
               self%rho(:n - 1, l) = chain%stored(inner(:n - 1, l))
               known = known + dot_product(chain%volume(:n - 1), self%rho(:n - 1, l))
               rhs(a) = self%dt*chain%conductance(0)*self%rho(1, l)
               rhs(a + 1) = chain%storage*chain%volume(n)*p(number(a + 1)) &
                            + self%dt*chain%conductance(n - 1)*self%rho(n - 1, l)
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
      class(layers_t), intent(in) :: self
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
            associate (n => self%chain(l)%n)
               inner(:n - 1, l) = self%chain(l)%inner(self%rho(:n - 1, l), mu, at_face, at_end)
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
   pure real(rk) function drained(self, inner)
      class(layers_t), intent(in) :: self
      real(rk), intent(in) :: inner(:, :)  !< after the step [Pa]
      integer(ik) :: l

      drained = 0.0_rk
      do l = 1, self%n
         if (self%fracture_cell(l) > 0) cycle
         drained = drained + self%dt*self%chain(l)%conductance(0)*(inner(1, l) - self%given(l))
      end do
   end function drained

   !> The pressure at a point that lies before a face with a layer, not farther from it than the
   !! centre of its cell; elsewhere it is left as it is.
   pure subroutine find_pressure(self, mesh, unknowns, inner, xy, pressure)
      class(layers_t), intent(in) :: self
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks)
      real(rk), intent(in) :: inner(:, :)  !< (n_nodes - 1, n) [Pa]
      real(rk), intent(in) :: xy(2)  !< [m]
      real(rk), intent(inout) :: pressure  !< [Pa]
      real(rk) :: along(2), at_face, centre, distance, nearest, normal(2), offset(2), start(2)
      integer(ik) :: l

      nearest = huge(1.0_rk)
      do l = 1, self%n
         associate (ends => mesh%xy(:, mesh%face_nodes(:, mesh%layer_face(l))), &
                    cell => self%cell(l), chain => self%chain(l), n => self%chain(l)%n)
            start = ends(:, 1)
            along = (ends(:, 2) - start)/norm2(ends(:, 2) - start)
            normal = [-along(2), along(1)]
            offset = cell_centre(mesh, cell) - start
            if (dot_product(offset, normal) < 0.0_rk) normal = -normal
            centre = dot_product(offset, normal)
            offset = xy - start
            distance = dot_product(offset, normal)
            if (distance < 0.0_rk .or. distance > min(centre, nearest)) cycle
            if (dot_product(offset, along) < 0.0_rk) cycle
            if (dot_product(offset, along) > norm2(ends(:, 2) - start)) cycle
            nearest = distance
            at_face = self%given(l)
            if (self%at(1, l) > 0) at_face = unknowns(3, self%at(1, l)/3)
            pressure = between_nodes([0.0_rk, chain%place, centre], &
                                     [at_face, inner(:n - 1, l), &
                                      unknowns(1, layer_block(mesh, l)), &
                                      unknowns(3, layer_block(mesh, mesh%cell_layer(cell)))], &
                                     distance)
         end associate
      end do
   end subroutine find_pressure

   !> Linear interpolation between nodes.
   pure real(rk) function between_nodes(place, value, at) result(found)
      real(rk), intent(in) :: place(:)  !< [m]
      real(rk), intent(in) :: value(:)  !< [Pa]
      real(rk), intent(in) :: at  !< between the first and the last place [m]
      integer(ik) :: k
      real(rk) :: t

      k = max(1_ik, min(count(place <= at, kind=ik), size(place, kind=ik) - 1))
      t = (at - place(k))/(place(k + 1) - place(k))
      found = (1.0_rk - t)*value(k) + t*value(k + 1)
   end function between_nodes

   !> Those of a state without layers.
   pure type(profiles_t) function no_profiles() result(none)
      allocate (none%cell(0), none%face_of_cell(0), none%fracture_cell(0), none%side(0))
      allocate (none%excess(0))
   end function no_profiles

   !> The pressures in the layers of a state.
   pure function profiles(self, unknowns, inner) result(found)
      class(layers_t), intent(in) :: self
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks)
      real(rk), intent(in) :: inner(:, :)  !< (n_nodes - 1, n) [Pa]
      type(profiles_t) :: found
      integer(ik) :: k, l

      found%cell = self%cell
      found%face_of_cell = self%face_of_cell
      found%fracture_cell = self%fracture_cell
      found%side = self%side
      found%n = self%chain%n
      allocate (found%place(self%n_nodes, self%n), found%value(self%n_nodes + 1, self%n), &
                source=0.0_rk)
      do k = 1, size(self%cells, kind=ik)
         associate (first => (self%at(2, self%of_cell%at(k, 1_ik)) + 2)/3)
            do l = self%of_cell%first(k), self%of_cell%last(k)
               call take(self%of_cell%item(l), unknowns(3, first))
            end do
         end associate
      end do

   contains

      pure subroutine take(l, rest)
         integer(ik), intent(in) :: l
         real(rk), intent(in) :: rest  !< pressure of the rest of the cell [Pa]

         associate (n => self%chain(l)%n)
            found%place(:n, l) = self%chain(l)%place
            found%value(:n - 1, l) = inner(:n - 1, l)
            found%value(n, l) = unknowns(1, (self%at(2, l) + 2)/3)
            found%value(n + 1, l) = rest
         end associate
      end subroutine take

   end function profiles

   !> Take the excess of the layers at faces that are kept on another mesh out of their cells, which
   !! keep the pressure of their rest: it is not transferred by areas.
   pure subroutine set_apart(self, cell_old, fracture_cell_old, unknowns, content, found)
      class(layers_t), intent(in) :: self
      integer(ik), intent(in) :: cell_old(:)  !< (new cells) the same cell before; 0: none
      integer(ik), intent(in) :: fracture_cell_old(:)  !< the same fracture cell before; 0: none
      real(rk), intent(inout) :: unknowns(:, :)  !< (3, n_blocks)
      real(rk), intent(inout) :: content(:)  !< (n_cells) [m2]
      type(profiles_t), intent(inout) :: found  !< of `profiles`
      real(rk) :: excess
      integer(ik) :: i, k, l
      logical :: is_kept

      allocate (found%excess(self%n), source=0.0_rk)
      do k = 1, size(self%cells, kind=ik)
         do i = 1, self%of_cell%length(k)
            l = self%of_cell%at(k, i)
            if (self%fracture_cell(l) > 0) then
               is_kept = any(fracture_cell_old == self%fracture_cell(l))
            else
               is_kept = any(cell_old == self%cell(l))
            end if
            if (.not. is_kept) cycle
            associate (chain => self%chain(l), n => self%chain(l)%n, cell => self%cell(l))
               excess = dot_product(chain%volume, found%value(:n, l) - found%value(n + 1, l))
               found%excess(l) = self%storage(k)*excess
               content(cell) = content(cell) - found%excess(l)
               unknowns(3, cell) = unknowns(3, cell) - excess/self%volume(k)
            end associate
         end do
      end do
   end subroutine set_apart

   !> Give the layers of a new mesh those before at the same faces: the same pressures beyond that
   !! of the rest of the cell at the same distances from the face, and their content. Other layers
   !! have the pressure of their cell.
   subroutine take_profiles(self, before, mesh, cell_old, fracture_cell_old, unknowns, inner, &
                            content)
      class(layers_t), intent(in) :: self
      type(profiles_t), intent(in) :: before  !< set apart
      type(mesh_t), intent(in) :: mesh  !< new
      integer(ik), intent(in) :: cell_old(:)  !< (n_cells) the same cell before; 0: none
      integer(ik), intent(in) :: fracture_cell_old(:)  !< the same fracture cell before; 0: none
      real(rk), intent(inout) :: unknowns(:, :)  !< (3, n_blocks); those of the layers are set
      real(rk), allocatable, intent(out) :: inner(:, :)  !< (n_nodes - 1, n) [Pa]
      real(rk), intent(inout) :: content(:)  !< (n_cells) [m2]
      real(rk) :: value(self%n_nodes)
      real(rk) :: excess, rest
      logical :: is_taken(size(before%cell))
      integer(ik) :: i, k, l, old

      is_taken = .false.
      call self%begin(unknowns, inner)
      do k = 1, size(self%cells, kind=ik)
         excess = 0.0_rk
         rest = unknowns(3, self%cells(k))
         do i = 1, self%of_cell%length(k)
            l = self%of_cell%at(k, i)
            old = same_layer(l)
            if (old == 0) cycle
            is_taken(old) = .true.
            content(self%cells(k)) = content(self%cells(k)) + before%excess(old)
            associate (chain => self%chain(l), n => self%chain(l)%n, m => before%n(old))
               value(:n) = interpolated(before%place(:m, old), &
                                        before%value(:m + 1, old) - before%value(m + 1, old), &
                                        chain%place)
               excess = excess + dot_product(chain%volume, value(:n))
               inner(:n - 1, l) = rest + value(:n - 1)
               unknowns(1, (self%at(2, l) + 2)/3) = rest + value(n)
            end associate
         end do
         unknowns(3, self%cells(k)) = rest + excess/self%volume(k)
      end do
      call give_back(before, is_taken, mesh, fracture_cell_old, content)

   contains

      !> The layer at the same face before; 0: none.
      pure integer(ik) function same_layer(l)
         integer(ik), intent(in) :: l

         same_layer = 0
         if (self%fracture_cell(l) > 0) then
            if (fracture_cell_old(self%fracture_cell(l)) == 0) return
            same_layer = findloc(before%fracture_cell == fracture_cell_old(self%fracture_cell(l)) &
                                 .and. before%side == self%side(l), .true., dim=1)
         else if (cell_old(self%cell(l)) > 0) then
            same_layer = findloc(before%cell == cell_old(self%cell(l)) .and. &
                                 before%face_of_cell == self%face_of_cell(l), .true., dim=1)
         end if
      end function same_layer

   end subroutine take_profiles

   !> Give the content of layers whose face has none on the new mesh to the cell there.
   pure subroutine give_back(before, is_taken, mesh, fracture_cell_old, content)
      type(profiles_t), intent(in) :: before
      logical, intent(in) :: is_taken(:)  !< layers that the new mesh has
      type(mesh_t), intent(in) :: mesh  !< new
      integer(ik), intent(in) :: fracture_cell_old(:)  !< the same fracture cell before; 0: none
      real(rk), intent(inout) :: content(:)  !< (n_cells) [m2]
      integer(ik) :: at, old

      do old = 1, size(is_taken, kind=ik)
         if (is_taken(old) .or. .not. abs(before%excess(old)) > 0.0_rk) cycle
         at = findloc(fracture_cell_old, before%fracture_cell(old), dim=1)
         if (at == 0) cycle
         associate (cell => mesh%face_cells(1, mesh%fracture%cell_faces(before%side(old), at)))
            content(cell) = content(cell) + before%excess(old)
         end associate
      end do
   end subroutine give_back

   !> Linear interpolation between nodes; the first value holds up to the first node, the last one,
   !! of the rest of the cell, beyond the last node.
   pure function interpolated(place, value, at) result(found)
      real(rk), intent(in) :: place(:)  !< (n) [m]
      real(rk), intent(in) :: value(:)  !< (n + 1) [Pa]
      real(rk), intent(in) :: at(:)  !< [m]
      real(rk) :: found(size(at))  !< [Pa]
      real(rk), parameter :: same = 1.0e-12_rk  ! relative
      integer(ik) :: i, k
      real(rk) :: t

      do i = 1, size(at, kind=ik)
         k = count(place <= at(i)*(1.0_rk + same))
         if (k == 0) then
            found(i) = value(1)
         else if (k == size(place)) then
            found(i) = value(k)
            if (at(i) > place(k)*(1.0_rk + same)) found(i) = value(k + 1)
         else
            t = max(0.0_rk, at(i) - place(k))/(place(k + 1) - place(k))
            found(i) = (1.0_rk - t)*value(k) + t*value(k + 1)
         end if
      end do
   end function interpolated

end module coarse_layers
