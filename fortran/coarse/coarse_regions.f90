!> Interaction regions: the cells, faces and unknowns around each vertex of the mesh.
!!
!! A region is a vertex of the unsplit mesh: it joins all nodes at this point, one for each sector
!! between fractures. Across a fracture the traction is continuous and the displacement jumps; the
!! jump is an unknown at each end of a fracture cell (at the third points of the face), so that it
!! varies linearly along the cell. Each node has a separate rotation. A node at which rocks of
!! several stiffnesses meet has one rotation for each of them: on their interface the shear strain
!! jumps, and with it the rotation, while the displacement is continuous.
!!
!! Poroelastic constants of the rock in the form that the discretization uses.
module coarse_regions
   use base_groups, only: groups_t, single_groups
   use base_kinds, only: ik, rk
   use base_lists, only: inverted, lists_t
   use coarse_elimination, only: response_t
   use coarse_layout, only: block_count, end_block
   use mesh_geometry, only: corner_geometry
   use mesh_types, only: mesh_t
   use scene_fluid_law, only: storage
   use scene_types, only: fluid_t, material_t
   implicit none(type, external)
   private

   public :: find_regions, fracture_end_region, mean_mobility, new_rock, regions_t, resistivity_of
   public :: rock_t, traction_face

   !> What meets around each vertex (a list per region); and how tractions and fluxes there follow
   !! from the unknowns, whose blocks are those of coarse_layout.
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
   end type regions_t

   !> Isotropic elastic, anisotropic permeable rock; two-dimensional constants. The lists hold one
   !! item if the rock is uniform, else one per cell: what cell c has is at min(c, size).
   type :: rock_t
      real(rk), allocatable :: shear(:)  !< shear modulus G [Pa]
      real(rk), allocatable :: lame(:)  !< first Lame constant, reduced for plane stress [Pa]
      real(rk), allocatable :: biot(:)  !< alpha of the stress in the plane [-]
      real(rk), allocatable :: storage(:)  !< S at fixed strain in the plane [1/Pa]
      !> Rocks of one stiffness have one number: across an outline between two of them, the rotation
      !! jumps (coarse_regions).
      integer(ik), allocatable :: stiffness(:)
      real(rk) :: mobility = 0.0_rk  !< mean of K/mu of the scene's rock [m2/(Pa s)]
      ! (.., 1) of a uniform rock, (.., n_cells) where regions differ (coarse_permeability):
      real(rk), allocatable :: permeability(:, :)  !< (3, ..) K_xx, K_yy, K_xy [m2]
      real(rk), allocatable :: resistivity(:, :, :)  !< (2, 2, ..) inverse of K/mu [Pa s/m2]
      !> How much better a cell that outlines of regions cut conducts along them than across, at the
      !! most, and which one; 0: no cell is cut.
      real(rk) :: most_layered = 0.0_rk
      integer(ik) :: most_layered_cell = 0
   contains
      procedure :: mobility_at
   end type rock_t

contains

   !> Nodes, faces and blocks around all vertices; room for the responses.
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
         region_of_rotation = region
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
      allocate (regions%traction(n), regions%flux(n))
   end subroutine find_regions

   !> Which corners of cells share a rotation: those at one node, and where several stiffnesses meet
   !! there, of one stiffness.
   pure subroutine number_rotations(mesh, stiffness, regions, region_of_rotation)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in), optional :: stiffness(:)  !< (n_cells), or 1 for all
      type(regions_t), intent(inout) :: regions
      integer(ik), allocatable, intent(inout) :: region_of_rotation(:)  !< those of nodes, at first
      integer(ik) :: c, k, last, n, node
      integer(ik), allocatable :: next(:), own(:), more(:)

      allocate (regions%has_interface(regions%n_regions), source=.false.)
      regions%rotation_of_corner = mesh%cell_nodes
      if (.not. present(stiffness)) return
      if (size(stiffness) < mesh%n_cells) return
      ! The rotations of a node as a chain, each with the stiffness that it is for.
      n = mesh%n_nodes
      allocate (next(n), own(n), source=-1_ik)
      do c = 1, mesh%n_cells
         do k = 1, 3
            node = mesh%cell_nodes(k, c)
            last = node
            if (own(node) < 0) own(node) = stiffness(c)
            do while (own(last) /= stiffness(c) .and. next(last) > 0)
               last = next(last)
            end do
            if (own(last) /= stiffness(c)) then
               if (n == size(next)) then
                  allocate (more(n), source=-1_ik)
                  next = [next, more]
                  own = [own, more]
                  deallocate (more)
               end if
               n = n + 1
               next(last) = n
               own(n) = stiffness(c)
               region_of_rotation = [region_of_rotation, regions%region_of_node(node)]
               regions%has_interface(regions%region_of_node(node)) = .true.
               last = n
            end if
            regions%rotation_of_corner(k, c) = last
         end do
      end do
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
      integer(ik) :: k

      associate (nodes => mesh%face_nodes(:, mesh%fracture%cell_faces(1, cell)), &
                 point => mesh%fracture%point_xy(:, mesh%fracture%cell_points(end, cell)))
         do k = 1, 2
            distance(k) = norm2(mesh%xy(:, nodes(k)) - point)
         end do
         region = regions%region_of_node(nodes(merge(1, 2, distance(1) < distance(2))))
      end associate
   end function fracture_end_region

   !> How many numbers the tractions and rotations of all regions are.
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

   !> Constants from the scene (docs/theory.md).
   pure function new_rock(material, fluid) result(rock)
      type(material_t), intent(in) :: material
      type(fluid_t), intent(in) :: fluid
      type(rock_t) :: rock

      real(rk) :: modulus

      allocate (rock%shear(1), rock%lame(1), rock%biot(1), rock%storage(1))
      allocate (rock%stiffness(1), source=0_ik)
      associate (e => material%young, nu => material%poisson)
         rock%shear = shear_of(material)
         rock%lame = e*nu/((1.0_rk + nu)*(1.0_rk - 2.0_rk*nu))
         if (material%plane_stress) rock%lame = e*nu/(1.0_rk - nu**2)
      end associate
      rock%biot = material%biot
      rock%storage = storage(material, fluid)
      if (material%plane_stress) then
         ! Without stress across the plane, strain follows there: e_zz = (alpha p - lambda (e_xx +
         ! e_yy))/(lambda + 2 G), lambda that of the solid.
       modulus = 2.0_rk*rock%shear(1)*(1.0_rk - material%poisson)/(1.0_rk - 2.0_rk*material%poisson)
         rock%biot = material%biot*2.0_rk*rock%shear/modulus
         rock%storage = rock%storage + material%biot**2/modulus
      end if
      allocate (rock%permeability(3, 1), rock%resistivity(2, 2, 1))
      rock%permeability(:, 1) = [material%permeability_xx, material%permeability_yy, &
                                 material%permeability_xy]
      rock%resistivity(:, :, 1) = resistivity_of(rock%permeability(:, 1), fluid%viscosity)
      rock%mobility = mean_mobility(rock%permeability(:, 1), fluid%viscosity)
   end function new_rock

   !> Shear modulus G [Pa].
   pure real(rk) function shear_of(material)
      type(material_t), intent(in) :: material

      shear_of = material%young/(2.0_rk*(1.0_rk + material%poisson))
   end function shear_of

   !> The mean of K/mu in a cell [m2/(Pa s)].
   pure real(rk) function mobility_at(self, cell)
      class(rock_t), intent(in) :: self
      integer(ik), intent(in) :: cell

      associate (r => self%resistivity(:, :, min(int(cell), size(self%resistivity, 3))))
         mobility_at = 1.0_rk/sqrt(r(1, 1)*r(2, 2) - r(1, 2)*r(2, 1))
      end associate
   end function mobility_at

   !> The inverse of K/mu.
   pure function resistivity_of(permeability, viscosity) result(resistivity)
      real(rk), intent(in) :: permeability(3)  !< K_xx, K_yy, K_xy [m2]
      real(rk), intent(in) :: viscosity  !< [Pa s]
      real(rk) :: resistivity(2, 2)  !< [Pa s/m2]
      real(rk) :: determinant

      determinant = permeability(1)*permeability(2) - permeability(3)**2
      resistivity(1, 1) = permeability(2)
      resistivity(2, 2) = permeability(1)
      resistivity(1, 2) = -permeability(3)
      resistivity(2, 1) = -permeability(3)
      resistivity = resistivity*(viscosity/determinant)
   end function resistivity_of

   !> The geometric mean of K/mu over directions [m2/(Pa s)].
   pure real(rk) function mean_mobility(permeability, viscosity) result(mobility)
      real(rk), intent(in) :: permeability(3)  !< K_xx, K_yy, K_xy [m2]
      real(rk), intent(in) :: viscosity  !< [Pa s]

      mobility = sqrt(permeability(1)*permeability(2) - permeability(3)**2)/viscosity
   end function mean_mobility

end module coarse_regions
