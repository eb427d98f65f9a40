!> Interaction regions: which cells, faces and unknowns meet around each vertex of the mesh.
!!
!! A region is a vertex of the unsplit mesh: it joins all nodes that lie there, one for each sector
!! between fractures. Across a fracture the traction is continuous and the displacement jumps; the
!! jump is an unknown at each end of a fracture cell (at the third points of the face), so that it
!! varies linearly along the cell. Each node has a rotation of its own.
module coarse_regions
   use base_kinds, only: ik, rk
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: corner_geometry, face_length, find_regions, fracture_end_region, regions_t
   public :: traction_face, traction_position

   !> Around each vertex; and how tractions and fluxes there follow from the unknowns.
   !!
   !! Unknowns come in blocks of three: first (u_x, u_y, p) per cell, then two blocks per fracture
   !! cell i, n_cells + 2i - 1 = (jump x, y at its start, p on side +) and n_cells + 2i = (jump x, y
   !! at its end, p on side -).
   type :: regions_t
      integer(ik) :: n_regions = 0
      integer(ik) :: n_blocks = 0
      integer(ik), allocatable :: region_of_node(:)  !< (n_nodes)
      integer(ik), allocatable :: node_first(:)  !< (n_regions+1) into nodes
      integer(ik), allocatable :: nodes(:)
      integer(ik), allocatable :: face_first(:)  !< (n_regions+1) into faces
      integer(ik), allocatable :: faces(:)  !< of a fracture, the + side stands for both
      integer(ik), allocatable :: flow_first(:)  !< (n_regions+1) into flow_faces
      integer(ik), allocatable :: flow_faces(:)  !< both sides of a fracture
      integer(ik), allocatable :: block_first(:)  !< (n_regions+1) into blocks
      integer(ik), allocatable :: blocks(:)  !< cells first
      integer(ik), allocatable :: cell_count(:)  !< (n_regions) how many of the blocks are cells
      integer(ik), allocatable :: traction_first(:)  !< (n_regions+1) into traction
      !> Per region (2 n_faces + n_nodes, 3 n_blocks + 1): tractions [Pa], then rotations [-], per
      !! unit of each unknown; the last column holds what the boundary data alone give.
      real(rk), allocatable :: traction(:)
      integer(ik), allocatable :: flux_first(:)  !< (n_regions+1) into flux
      !> per region (n_flow_faces, n_blocks + 1): fluxes [m/s], likewise
      real(rk), allocatable :: flux(:)
   end type regions_t

contains

   !> Nodes, faces and blocks around all vertices; room for the responses.
   subroutine find_regions(mesh, regions)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(out) :: regions

      integer(ik), allocatable :: owner(:), label(:)
      integer(ik) :: c, f, i, n, r

      call join_nodes(mesh, regions)
      n = regions%n_regions
      regions%n_blocks = mesh%n_cells + 2*mesh%fracture%n_cells
      associate (region => regions%region_of_node)
         call sort_into(region, [(i, i=1, mesh%n_nodes)], n, regions%node_first, regions%nodes)

         owner = [(region(mesh%cell_nodes(:, c)), c=1, mesh%n_cells)]
         allocate (regions%cell_count(n), source=0_ik)
         do i = 1, size(owner)
            regions%cell_count(owner(i)) = regions%cell_count(owner(i)) + 1
         end do
         label = [([c, c, c], c=1, mesh%n_cells)]
         do i = 1, mesh%fracture%n_cells
            associate (ends => region(mesh%face_nodes(:, mesh%fracture%cell_faces(1, i))), &
                       block => mesh%n_cells + 2*i)
               owner = [owner, ends, ends]
               label = [label, block - 1, block - 1, block, block]
            end associate
         end do
         call sort_into(owner, label, n, regions%block_first, regions%blocks)

         owner = [(region(mesh%face_nodes(:, f)), f=1, mesh%n_faces)]
         label = [([f, f], f=1, mesh%n_faces)]
         call sort_into(owner, label, n, regions%flow_first, regions%flow_faces)
         do i = 1, mesh%fracture%n_cells
            f = mesh%fracture%cell_faces(2, i)
            owner(2*f - 1:2*f) = 0
         end do
         label = pack(label, owner > 0)
         owner = pack(owner, owner > 0)
         call sort_into(owner, label, n, regions%face_first, regions%faces)
      end associate

      allocate (regions%traction_first(n + 1), regions%flux_first(n + 1))
      regions%traction_first(1) = 1
      regions%flux_first(1) = 1
      do r = 1, n
         associate (n_faces => regions%face_first(r + 1) - regions%face_first(r), &
                    n_nodes => regions%node_first(r + 1) - regions%node_first(r), &
                    n_flow => regions%flow_first(r + 1) - regions%flow_first(r), &
                    n_blocks => regions%block_first(r + 1) - regions%block_first(r))
            regions%traction_first(r + 1) = regions%traction_first(r) &
                                            + (2*n_faces + n_nodes)*(3*n_blocks + 1)
            regions%flux_first(r + 1) = regions%flux_first(r) + n_flow*(n_blocks + 1)
         end associate
      end do
      allocate (regions%traction(regions%traction_first(n + 1) - 1))
      allocate (regions%flux(regions%flux_first(n + 1) - 1))
   end subroutine find_regions

   !> Nodes on both sides of a fracture that lie at the same point belong to one region.
   subroutine join_nodes(mesh, regions)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(inout) :: regions

      integer(ik), allocatable :: leader(:)
      integer(ik) :: a, b, i, v

      leader = [(v, v=1, mesh%n_nodes)]
      do i = 1, mesh%fracture%n_cells
         associate (plus => mesh%face_nodes(:, mesh%fracture%cell_faces(1, i)), &
                    minus => mesh%face_nodes(:, mesh%fracture%cell_faces(2, i)))
            do a = 1, 2
               b = minloc(norm2(mesh%xy(:, minus) - spread(mesh%xy(:, plus(a)), 2, 2), dim=1), &
                          dim=1)
               call unite(plus(a), minus(b))
            end do
         end associate
      end do
      allocate (regions%region_of_node(mesh%n_nodes))
      regions%n_regions = 0
      do v = 1, mesh%n_nodes
         if (find(v) == v) then
            regions%n_regions = regions%n_regions + 1
            regions%region_of_node(v) = regions%n_regions
         else
            regions%region_of_node(v) = regions%region_of_node(find(v))
         end if
      end do

   contains

      !> The smallest node that v is united with.
      function find(node) result(root)
         integer(ik), intent(in) :: node
         integer(ik) :: root

         root = node
         do while (leader(root) /= root)
            root = leader(root)
         end do
      end function find

      subroutine unite(node_a, node_b)
         integer(ik), intent(in) :: node_a, node_b

         associate (root_a => find(node_a), root_b => find(node_b))
            leader(max(root_a, root_b)) = min(root_a, root_b)
         end associate
      end subroutine unite

   end subroutine join_nodes

   !> Items of each owner, in the order given.
   subroutine sort_into(owner, label, n_owners, first, items)
      integer(ik), intent(in) :: owner(:), label(:)
      integer(ik), intent(in) :: n_owners
      integer(ik), allocatable, intent(out) :: first(:)  !< (n_owners+1)
      integer(ik), allocatable, intent(out) :: items(:)

      integer(ik), allocatable :: position(:)
      integer(ik) :: i

      allocate (first(n_owners + 1), source=0_ik)
      allocate (items(size(owner)))
      do i = 1, size(owner)
         first(owner(i) + 1) = first(owner(i) + 1) + 1
      end do
      first(1) = 1
      do i = 1, n_owners
         first(i + 1) = first(i + 1) + first(i)
      end do
      position = first
      do i = 1, size(owner)
         items(position(owner(i))) = label(i)
         position(owner(i)) = position(owner(i)) + 1
      end do
   end subroutine sort_into

   !> Geometry of corner k of a cell: its two faces and the vectors that build a stress from
   !! tractions.
   !!
   !! sigma = sum_j sign_j t_j (x) lever_j, where t_j is the traction on face j for the face's own
   !! normal (out of its first cell).
   pure subroutine corner_geometry(mesh, cell, k, faces, sign_out, length, lever, area)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell, k
      integer(ik), intent(out) :: faces(2)  !< the faces after and before the corner
      real(rk), intent(out) :: sign_out(2)  !< +1 where the face's normal leaves this cell, else -1
      real(rk), intent(out) :: length(2)  !< [m]
      real(rk), intent(out) :: lever(2, 2)  !< (component, face)
      real(rk), intent(out) :: area  !< of the whole cell [m2]

      real(rk) :: after(2), before(2), origin(2)
      integer(ik) :: next, previous

      next = mod(k, 3_ik) + 1
      previous = mod(k + 1, 3_ik) + 1
      origin = mesh%xy(:, mesh%cell_nodes(k, cell))
      after = mesh%xy(:, mesh%cell_nodes(next, cell)) - origin
      before = mesh%xy(:, mesh%cell_nodes(previous, cell)) - origin
      area = 0.5_rk*(after(1)*before(2) - after(2)*before(1))
      faces = [mesh%cell_faces(k, cell), mesh%cell_faces(previous, cell)]
      sign_out = merge(1.0_rk, -1.0_rk, mesh%face_cells(1, faces) == cell)
      length = [norm2(after), norm2(before)]
      lever(:, 1) = before*(-length(1)/(2.0_rk*area))
      lever(:, 2) = after*(-length(2)/(2.0_rk*area))
   end subroutine corner_geometry

   !> The face that carries the traction: of a fracture, the one on side +, with the sign turned on
   !! side -.
   pure subroutine traction_face(mesh, face, sign_out)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(inout) :: face
      real(rk), intent(inout) :: sign_out

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
      integer(ik), intent(in) :: cell, end
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

   !> Where a region's tractions begin in the packed array of all tractions.
   pure function traction_position(regions, region) result(at)
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      integer(ik) :: at

      at = 2*(regions%face_first(region) - 1) + regions%node_first(region)
   end function traction_position

   pure function face_length(mesh, f) result(length)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: f
      real(rk) :: length  !< [m]

      length = norm2(mesh%xy(:, mesh%face_nodes(2, f)) - mesh%xy(:, mesh%face_nodes(1, f)))
   end function face_length

end module coarse_regions
