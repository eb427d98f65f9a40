!> Interaction regions: the cells, faces and unknowns around each vertex of the mesh.
!!
!! A region is a vertex of the unsplit mesh: it joins all nodes at this point, one for each sector
!! between fractures. Across a fracture the traction is continuous and the displacement jumps; the
!! jump is an unknown at each end of a fracture cell (at the third points of the face), so that it
!! varies linearly along the cell. Each node has a separate rotation. A node at which rocks of
!! several stiffnesses meet has one rotation for each of them: on their interface the shear strain
!! jumps, and with it the rotation, while the displacement is continuous.
module coarse_regions
   use base_groups, only: groups_t, single_groups
   use base_kinds, only: ik, rk
   use base_lists, only: inverted, lists_t
   use base_plane, only: norm2
   use coarse_elimination, only: response_t
   use coarse_layout, only: at_component, block_count, end_block, end_of_block, &
                            fracture_cell_of_block, layer_block
   use mesh_geometry, only: corner_geometry, split_by_kind
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: find_regions, fracture_end_region, regions_t, traction_face

   !> Nodes, faces and blocks around each vertex (a list per region), and the responses of tractions
   !! and fluxes to the unknowns, whose blocks are those of coarse_layout.
   type :: regions_t
      integer(ik) :: n_regions = 0
      integer(ik) :: n_blocks = 0
      integer(ik), allocatable :: region_of_node(:)  !< (n_nodes)
      !> (3, n_blocks) regions that a block belongs to; for the two of a fracture the third is 0
      integer(ik), allocatable :: regions_of_block(:, :)
      !> (corner, n_cells) the rotation of a cell's corner: the number of its node, or, of a second
      !! stiffness there, one beyond those
      integer(ik), allocatable :: rotation_of_corner(:, :)
      logical, allocatable :: has_interface(:)  !< (n_regions) rocks of several stiffnesses meet
      type(lists_t) :: nodes  !< by the number of their rotation; the first is a node of the mesh
      type(lists_t) :: faces  !< that carry a traction: of a fracture, the + side stands for both
      type(lists_t) :: flow_faces  !< that carry a flux: both sides of a fracture
      type(lists_t) :: blocks  !< cells first
      !> With layers (coarse_layers), else unallocated: numbers of what the stencils of flow see,
      !! first one for each block; in the block of a layer the scalars at the start (1) and the end
      !! (2) of its face stand for the unknowns, their mean and half their difference
      type(lists_t), allocatable :: scalars
      integer(ik) :: layer_blocks(2) = 0  !< the first and the last block of layers
      integer(ik), allocatable :: cell_count(:)  !< (n_regions) how many of the blocks are cells
      !> (n_regions) x, y of the tractions [Pa] on the faces, then rotations [-] of the nodes
      type(response_t), allocatable :: traction(:)
      type(response_t), allocatable :: flux(:)  !< (n_regions) fluxes [m/s] through the flow faces
      !> (3, corner, n_cells) where, in the packed tractions of at_traction, those on the faces
      !! after and before a corner begin, and where the rotation of its node stands
      integer(ik), allocatable :: at_corner(:, :, :)
      !> (2, 2, corner, n_cells) what these two tractions build the stress there from (component,
      !! face), turned where they count as those of the other side [-]
      real(rk), allocatable :: lever(:, :, :, :)
   contains
      procedure :: traction_count
      procedure :: at_traction
      procedure :: at_rotation
      procedure :: scalar_count
      procedure :: scalars_of
   end type regions_t

contains

   !> Nodes, faces and blocks around all vertices; the responses are allocated.
   subroutine find_regions(mesh, regions, stiffness)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(out) :: regions
      !> Which stiffness each cell has; default: all the same
      integer(ik), intent(in), optional :: stiffness(:)
      integer(ik), allocatable :: ends(:, :), region_of_rotation(:)
      integer(ik) :: c, end, f, i, n

      call join_nodes(mesh, regions)
      n = regions%n_regions
      regions%n_blocks = block_count(mesh)
      allocate (regions%cell_count(n), source=0_ik)
      allocate (regions%regions_of_block(3, regions%n_blocks), source=0_ik)
      associate (region => regions%region_of_node)
         do c = 1, mesh%n_cells
            associate (corners => region(mesh%cell_nodes(:, c)))
               regions%regions_of_block(:, c) = corners
               regions%cell_count(corners) = regions%cell_count(corners) + 1
            end associate
         end do
         do i = 1, mesh%fracture%n_cells
            do end = 1, 2
               regions%regions_of_block(:2, end_block(mesh, i, end)) = &
                  region(mesh%face_nodes(:, mesh%fracture%cell_faces(1, i)))
            end do
         end do
         regions%blocks = inverted(regions%regions_of_block, n)
         call number_rotations(mesh, stiffness, regions, region_of_rotation)
         regions%nodes = inverted(reshape(region_of_rotation, [1, size(region_of_rotation)]), n)

         allocate (ends(2, mesh%n_faces))
         do f = 1, mesh%n_faces
            ends(:, f) = region(mesh%face_nodes(:, f))
         end do
      end associate
      regions%flow_faces = inverted(ends, n)
      do i = 1, mesh%fracture%n_cells
         ends(:, mesh%fracture%cell_faces(2, i)) = 0
      end do
      regions%faces = inverted(ends, n)
      call find_corners(mesh, regions)
      if (mesh%n_layers > 0) call find_scalars(mesh, regions)
      allocate (regions%traction(n), regions%flux(n))
   end subroutine find_regions

   !> Numbers of the unknowns of flow around each vertex, where there are layers: next to a layer
   !! the pressure at its outer end instead of that at its face, and the pressure of the rest of its
   !! cell.
   subroutine find_scalars(mesh, regions)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(inout) :: regions
      type(lists_t) :: scalars
      integer(ik) :: b, f, j, n, r

      allocate (scalars%first(regions%n_regions + 1))
      allocate (scalars%item(size(regions%blocks%item) + 2*mesh%n_layers))
      n = 0
      do r = 1, regions%n_regions
         scalars%first(r) = n + 1
         do b = regions%blocks%first(r), regions%blocks%last(r)
            n = n + 1
            scalars%item(n) = of_block(regions%blocks%item(b), r)
         end do
         do j = 1, regions%flow_faces%length(r)
            f = regions%flow_faces%at(r, j)
            if (mesh%face_side(f) == 0 .or. mesh%face_layer(f) == 0) cycle
            n = n + 1
            scalars%item(n) = outer_end(f, r)
         end do
      end do
      scalars%first(regions%n_regions + 1) = n + 1
      scalars%item = scalars%item(:n)
      regions%scalars = scalars
      regions%layer_blocks = layer_block(mesh, [1_ik, mesh%n_layers])

   contains

      !> The unknown for a block.
      pure integer(ik) function of_block(block, region)
         integer(ik), intent(in) :: block, region

         of_block = at_component(block, 3_ik)
         if (block <= mesh%n_cells) then
            associate (layer => mesh%cell_layer(block))
               if (layer > 0) of_block = at_component(layer_block(mesh, layer), 3_ik)
            end associate
         else
            associate (face => mesh%fracture%cell_faces(end_of_block(mesh, block), &
                                                        fracture_cell_of_block(mesh, block)))
               if (mesh%face_layer(face) > 0) of_block = outer_end(face, region)
            end associate
         end if
      end function of_block

      !> The unknown at the outer end of a layer, at the end of its face at the vertex.
      pure integer(ik) function outer_end(face, region)
         integer(ik), intent(in) :: face, region

         outer_end = at_component(layer_block(mesh, mesh%face_layer(face)), &
                                  merge(1_ik, 2_ik, &
                                        regions%region_of_node(mesh%face_nodes(1, face)) == region))
      end function outer_end

   end subroutine find_scalars

   !> Which corners of cells share a rotation: those at one node, and where several stiffnesses meet
   !! there, of one stiffness.
   pure subroutine number_rotations(mesh, stiffness, regions, region_of_rotation)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in), optional :: stiffness(:)  !< (n_cells), or 1 for all
      type(regions_t), intent(inout) :: regions
      integer(ik), allocatable, intent(out) :: region_of_rotation(:)
      integer(ik), allocatable :: node(:)
      integer(ik) :: i

      node = [(i, i=1, mesh%n_nodes)]
      regions%rotation_of_corner = mesh%cell_nodes
      if (present(stiffness)) then
         if (size(stiffness) == mesh%n_cells) then
            call split_by_kind(stiffness, regions%rotation_of_corner, node)
         end if
      end if
      region_of_rotation = regions%region_of_node(node)
      allocate (regions%has_interface(regions%n_regions), source=.false.)
      regions%has_interface(region_of_rotation(mesh%n_nodes + 1:)) = .true.
   end subroutine number_rotations

   !> Where the tractions and rotations at all corners of cells stand.
   subroutine find_corners(mesh, regions)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(inout) :: regions
      integer(ik) :: c, faces(2), j, k, r
      real(rk) :: sign_out(2), length(2), lever(2, 2), area

      allocate (regions%at_corner(3, 3, mesh%n_cells), regions%lever(2, 2, 3, mesh%n_cells))
      do c = 1, mesh%n_cells
         do k = 1, 3
            r = regions%regions_of_block(k, c)
            call corner_geometry(mesh, c, k, faces, sign_out, length, lever, area)
            do j = 1, 2
               call traction_face(mesh, faces(j), sign_out(j))
               regions%at_corner(j, k, c) = regions%at_traction(r, faces(j))
               regions%lever(:, j, k, c) = sign_out(j)*lever(:, j)
            end do
            regions%at_corner(3, k, c) = regions%at_rotation(r, regions%rotation_of_corner(k, c))
         end do
      end do
   end subroutine find_corners

   !> Nodes on both sides of a fracture that lie at the same point belong to one region.
   subroutine join_nodes(mesh, regions)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(inout) :: regions
      type(groups_t) :: groups
      integer(ik) :: a, b, i

      groups = single_groups(mesh%n_nodes)
      do i = 1, mesh%fracture%n_cells
         associate (plus => mesh%face_nodes(:, mesh%fracture%cell_faces(1, i)), &
                    minus => mesh%face_nodes(:, mesh%fracture%cell_faces(2, i)))
            do a = 1, 2
               b = minloc(norm2(mesh%xy(:, minus) - spread(mesh%xy(:, plus(a)), 2, 2), dim=1), &
                          dim=1)
               call groups%join(plus(a), minus(b))
            end do
         end associate
      end do
      regions%region_of_node = groups%numbers()
      regions%n_regions = groups%count_groups()
   end subroutine join_nodes

   !> The face that carries the traction: of a fracture, the one on side +, with the sign turned on
   !! side -.
   pure subroutine traction_face(mesh, face, sign_out)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(inout) :: face  !< of a cell
      real(rk), intent(inout) :: sign_out  !< +1 where its normal leaves the cell, else -1 [-]
      integer(ik) :: i

      i = mesh%face_fracture_cell(face)
      if (i == 0) return
      if (mesh%fracture%cell_faces(2, i) == face) then
         face = mesh%fracture%cell_faces(1, i)
         sign_out = -sign_out
      end if
   end subroutine traction_face

   !> The region at the start (1) or the end (2) of a fracture cell.
   pure function fracture_end_region(mesh, regions, cell, end) result(region)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: cell  !< fracture cell
      integer(ik), intent(in) :: end  !< 1 start, 2 end
      integer(ik) :: region

      real(rk) :: distance(2)

      associate (nodes => mesh%face_nodes(:, mesh%fracture%cell_faces(1, cell)), &
                 point => mesh%fracture%point_xy(:, mesh%fracture%cell_points(end, cell)))
         distance = norm2(mesh%xy(:, nodes) - spread(point, 2, 2), dim=1)
         region = regions%region_of_node(nodes(minloc(distance, dim=1)))
      end associate
   end function fracture_end_region

   !> How many unknowns the stencil of flow around a vertex sees.
   pure integer(ik) function scalar_count(self, region)
      class(regions_t), intent(in) :: self
      integer(ik), intent(in) :: region

      if (allocated(self%scalars)) then
         scalar_count = self%scalars%length(region)
      else
         scalar_count = self%blocks%length(region)
      end if
   end function scalar_count

   !> The values among which the stencils of flow find those around a vertex: the pressures of the
   !! blocks, or with layers all unknowns.
   pure function scalars_of(self, unknowns) result(values)
      class(regions_t), intent(in) :: self
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), allocatable :: values(:)
      integer(ik) :: block

      if (allocated(self%scalars)) then
         values = reshape(unknowns, [size(unknowns)])
         do block = self%layer_blocks(1), self%layer_blocks(2)
            values(3*block - 2:3*block - 1) = unknowns(1, block) + [1, -1]*unknowns(2, block)
         end do
      else
         values = unknowns(3, :)
      end if
   end function scalars_of

   !> Number of tractions and rotations of all regions.
   pure integer(ik) function traction_count(self)
      class(regions_t), intent(in) :: self

      traction_count = self%at_traction(self%n_regions + 1) - 1
   end function traction_count

   !> Where the tractions of a region begin among those of all, which are packed region by region,
   !! each with x, y on its faces and then the rotations of its nodes; or where those on one of its
   !! faces do.
   pure integer(ik) function at_traction(self, region, face)
      class(regions_t), intent(in) :: self
      integer(ik), intent(in) :: region
      integer(ik), intent(in), optional :: face

      at_traction = 2*(self%faces%first(region) - 1) + self%nodes%first(region)
      if (present(face)) at_traction = at_traction + 2*(self%faces%place(region, face) - 1)
   end function at_traction

   !> Where a rotation stands among them.
   pure integer(ik) function at_rotation(self, region, rotation)
      class(regions_t), intent(in) :: self
      integer(ik), intent(in) :: region
      integer(ik), intent(in) :: rotation  !< one of the region's

      at_rotation = self%at_traction(region) + 2*self%faces%length(region) &
                    + self%nodes%place(region, rotation) - 1
   end function at_rotation

end module coarse_regions
