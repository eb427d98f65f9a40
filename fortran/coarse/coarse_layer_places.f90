!> Where layers of fluid pressure lie: the faces that have them, the chains on these, and the flow
!! round tips beyond that in one dimension (docs/theory.md).
module coarse_layer_places
   use base_kinds, only: ik, rk
   use base_lists, only: inverted, lists_t
   use base_plane, only: norm2
   use coarse_chain, only: new_chain
   use coarse_layers, only: layers_t
   use coarse_layout, only: at_component, end_block, layer_block
   use coarse_matrix, only: matrix_t
   use coarse_rock, only: rock_t, solid_t
   use mesh_geometry, only: cell_area, cell_centre, face_length
   use mesh_types, only: mesh_t
   use scene_sides, only: boundary_side_t
   implicit none(type, external)
   private

   public :: add_tip_flow, cell_ahead, place_layers, tip_conductance

   !> A layer is at most this part of the distance of the centre of the cell from the face, and
   !! those of m faces at most the other part over m [-].
   real(rk), parameter :: thickest = 0.75_rk, all_together = 1.35_rk
   !> Thickness of the first volume over sqrt(c dt) of the first step [-].
   real(rk), parameter :: first_volume = 0.5_rk
   !> What flows round a tip beyond the flow in one dimension, per side, over the mobility and the
   !! difference of pressure [-].
   real(rk), parameter :: round_tip = 0.3_rk
   !> No layer where sqrt(c dt) of the first step exceeds so many heights of the cell [-].
   real(rk), parameter :: wide = 2.0_rk

contains

   !> Choose the faces that get layers, number the layers in the mesh, and set up their chains.
   subroutine place_layers(mesh, rock, sides, first_step, layers, times_finer, last_place)
      type(mesh_t), intent(inout) :: mesh
      type(rock_t), intent(in) :: rock
      type(boundary_side_t), intent(in) :: sides(:)
      real(rk), intent(in) :: first_step  !< [s]
      type(layers_t), intent(out) :: layers
      integer(ik), intent(in), optional :: times_finer  !< of coarse_chain
      !> where the last node of an extended layer lies, over the distance of the centre [-]
      real(rk), intent(in), optional :: last_place
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
      call set_up(mesh, rock, first_step, layers, times_finer, last_place)
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
      uniaxial_storage = solid%uniaxial_storage()
   end function uniaxial_storage

   !> The chains, their places among the unknowns, and the cells they lie in.
   subroutine set_up(mesh, rock, first_step, layers, times_finer, last_place)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      real(rk), intent(in) :: first_step  !< [s]
      type(layers_t), intent(inout) :: layers
      integer(ik), intent(in), optional :: times_finer
      real(rk), intent(in), optional :: last_place
      real(rk) :: mobility, storage, thickness, to_centre
      integer(ik) :: f, k, l, n
      integer(ik), allocatable :: place(:)

      n = layers%n
      allocate (layers%chain(n), layers%fracture_cell(n), layers%side(n), layers%at(3, n))
      layers%extended = spread(.false., 1, int(n))
      if (present(last_place)) layers%extended = have_regular_cells(mesh, layers%cell)
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
            to_centre = 2.0_rk/3.0_rk*layers%volume(place(l))/length
            thickness = min(thickest, all_together/layers%of_cell%length(place(l)))*to_centre
            call set_chain()
            if (layers%extended(l)) then
               thickness = thickness*last_place*to_centre/layers%chain(l)%place(layers%chain(l)%n)
               call set_chain()
            end if
            associate (chain => layers%chain(l))
               layers%between(l) = mobility*length/chain%place(chain%n)
               layers%relief(l) = 0.5_rk*length*chain%place(chain%n)/mobility
               layers%rest(place(l)) = layers%rest(place(l)) - sum(chain%volume)
               layers%n_nodes = max(layers%n_nodes, chain%n)
            end associate
         end associate
      end do
      allocate (layers%rho(layers%n_nodes - 1, n), layers%means(2, n), layers%first_mean(n), &
                source=0.0_rk)

   contains

      subroutine set_chain()
         layers%chain(l) = new_chain(thickness, first_volume*sqrt(mobility/storage*first_step), &
                                     face_length(mesh, f), mobility, storage, times_finer)
      end subroutine set_chain

   end subroutine set_up

   !> Whether the corner opposite to a face of a cell lies before the face, or nearly so, and the
   !! angles at the face are not small.
   pure logical function is_regular(mesh, cell, face)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell, face
      real(rk), parameter :: farthest = 1.3_rk, slope = 0.5_rk
      real(rk) :: along(2), at(3)  ! corners along the face, over its length
      integer(ik) :: k

      associate (ends => mesh%xy(:, mesh%face_nodes(:, face)))
         along = (ends(:, 2) - ends(:, 1))/face_length(mesh, face)**2
         at = [(dot_product(mesh%xy(:, mesh%cell_nodes(k, cell)) - ends(:, 1), along), k=1, 3)]
      end associate
      associate (far => max(maxval(at), 1.0_rk - minval(at)), &
                 height => 2.0_rk*cell_area(mesh, cell)/face_length(mesh, face)**2)
         is_regular = far <= farthest .and. height >= slope*far
      end associate
   end function is_regular

   !> Whether the cells of layers are regular, have one layer, and do not lie at a face next to a
   !! bend, tip or corner of faces with layers, where temperatures would leave their range.
   pure function have_regular_cells(mesh, cell) result(are)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell(:)  !< (layers)
      logical :: are(size(cell))
      real(rk), parameter :: most = -0.7_rk  ! cosine of the angle at nodes that are no bends
      logical, dimension(mesh%n_nodes) :: is_bent, is_near
      integer(ik) :: i, l, node, number(mesh%n_cells)
      real(rk) :: along(2, 2)
      type(lists_t) :: at_node

      number = 0
      at_node = inverted(mesh%face_nodes(:, mesh%layer_face), mesh%n_nodes)
      do node = 1, mesh%n_nodes
         is_bent(node) = at_node%length(node) > 2
         if (at_node%length(node) /= 2) cycle
         do i = 1, 2
            associate (nodes => mesh%face_nodes(:, mesh%layer_face(at_node%at(node, i))))
               along(:, i) = mesh%xy(:, sum(nodes) - node) - mesh%xy(:, node)
            end associate
         end do
         is_bent(node) = dot_product(along(:, 1), along(:, 2)) &
                         > most*norm2(along(:, 1))*norm2(along(:, 2))
      end do
      is_near = is_bent
      do l = 1, mesh%n_layers
         number(cell(l)) = number(cell(l)) + 1
         associate (nodes => mesh%face_nodes(:, mesh%layer_face(l)))
            if (any(is_bent(nodes))) is_near(nodes) = .true.
         end associate
      end do
      do l = 1, mesh%n_layers
         are(l) = number(cell(l)) == 1 .and. is_regular(mesh, cell(l), mesh%layer_face(l)) &
                  .and. .not. any(is_near(mesh%face_nodes(:, mesh%layer_face(l))))
      end do
   end function have_regular_cells

   !> Flow round tips: a conductance from the faces of a tip's cell with layers to the cell ahead.
   pure subroutine add_tip_flow(layers, mesh, rock, matrix)
      type(layers_t), intent(in) :: layers
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(matrix_t), intent(inout) :: matrix
      integer(ik) :: ahead, cell, side, tip
      real(rk) :: conductance

      if (layers%n == 0) return
      associate (fracture => mesh%fracture)
         do tip = 1, fracture%n_tips
            cell = fracture%point_cells%at(fracture%tip_point(tip), 1_ik)
            ahead = cell_ahead(mesh, tip)
            do side = 1, 2
               if (mesh%face_layer(fracture%cell_faces(side, cell)) == 0) cycle
               conductance = tip_conductance(rock, ahead)
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

   !> Between each face of a tip's cell and the cell ahead [m2/(Pa s)].
   pure real(rk) function tip_conductance(rock, ahead) result(conductance)
      type(rock_t), intent(in) :: rock
      integer(ik), intent(in) :: ahead

      conductance = round_tip*rock%mobility_at(ahead)
   end function tip_conductance

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

end module coarse_layer_places
