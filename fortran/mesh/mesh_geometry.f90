!> Lengths, areas and centres of the cells and faces of a mesh, and the corners of its cells.
module mesh_geometry
   use base_kinds, only: ik, rk
   use base_plane, only: norm2, triangle_area
   use mesh_types, only: fracture_mesh_t, mesh_t
   implicit none(type, external)
   private

   public :: cell_area, cell_centre, corner_geometry, face_length, fracture_cell_centre
   public :: outward_normal, split_by_kind

contains

   !> Geometry of corner k of a cell: its two faces and the vectors that build a stress from
   !! tractions.
   !!
   !! sigma = sum_j sign_j t_j (x) lever_j, where t_j is the traction on face j for the face's own
   !! normal (out of its first cell); likewise a flow vector from normal fluxes.
   pure subroutine corner_geometry(mesh, cell, k, faces, sign_out, length, lever, area)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell, k
      integer(ik), intent(out) :: faces(2)  !< the faces after and before the corner
      real(rk), intent(out) :: sign_out(2)  !< +1 where the normal leaves this cell, else -1 [-]
      real(rk), intent(out) :: length(2)  !< [m]
      real(rk), intent(out) :: lever(2, 2)  !< (component, face) [-]
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

   !> Length of a face.
   pure function face_length(mesh, f) result(length)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: f
      real(rk) :: length  !< [m]

      length = norm2(mesh%xy(:, mesh%face_nodes(2, f)) - mesh%xy(:, mesh%face_nodes(1, f)))
   end function face_length

   !> Unit vector out of the body on a face of its outer boundary [-].
   pure function outward_normal(mesh, f) result(normal)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: f
      real(rk) :: normal(2)
      real(rk) :: along(2), inward(2)

      associate (ends => mesh%xy(:, mesh%face_nodes(:, f)), &
                 corners => mesh%xy(:, mesh%cell_nodes(:, mesh%face_cells(1, f))))
         along = ends(:, 2) - ends(:, 1)
         inward = sum(corners, dim=2)/3.0_rk - ends(:, 1)
      end associate
      normal = [along(2), -along(1)]/norm2(along)
      if (dot_product(normal, inward) > 0.0_rk) normal = -normal
   end function outward_normal

   pure function cell_centre(mesh, cell) result(centre)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell
      real(rk) :: centre(2)  !< [m]

      associate (xy => mesh%xy, nodes => mesh%cell_nodes)
         centre = (xy(:, nodes(1, cell)) + xy(:, nodes(2, cell)) + xy(:, nodes(3, cell)))/3.0_rk
      end associate
   end function cell_centre

   pure function fracture_cell_centre(fracture, cell) result(centre)
      type(fracture_mesh_t), intent(in) :: fracture
      integer(ik), intent(in) :: cell
      real(rk) :: centre(2)  !< [m]

      centre = 0.5_rk*sum(fracture%point_xy(:, fracture%cell_points(:, cell)), dim=2)
   end function fracture_cell_centre

   !> Area of a cell.
   pure function cell_area(mesh, cell) result(area)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell
      real(rk) :: area  !< [m2]
      real(rk) :: corners(2, 3)

      corners = mesh%xy(:, mesh%cell_nodes(:, cell))
      area = triangle_area(corners)
   end function cell_area

   !> Give the corners of cells at a node separate numbers for each kind of cell there: the first
   !! kind keeps the number of the node, others are numbered after all nodes.
   pure subroutine split_by_kind(kind_of_cell, corner, node)
      integer(ik), intent(in) :: kind_of_cell(:)  !< (n_cells) positive
      integer(ik), intent(inout) :: corner(:, :)  !< (3, n_cells) nodes, then numbers
      integer(ik), allocatable, intent(inout) :: node(:)  !< of each number
      integer(ik), allocatable :: kind_of(:), next(:)
      integer(ik) :: c, k, n, number

      n = size(node, kind=ik)
      allocate (kind_of(n), next(n), source=0_ik)  ! the numbers at a node are a chain
      do c = 1, size(corner, 2, kind=ik)
         do k = 1, 3
            number = corner(k, c)
            if (kind_of(number) == 0) kind_of(number) = kind_of_cell(c)
            do while (kind_of(number) /= kind_of_cell(c))
               if (next(number) == 0) then
                  if (n == size(next)) then
                     next = [next, spread(0_ik, 1, int(n))]
                     kind_of = [kind_of, spread(0_ik, 1, int(n))]
                  end if
                  n = n + 1
                  next(number) = n
                  kind_of(n) = kind_of_cell(c)
                  node = [node, corner(k, c)]
               end if
               number = next(number)
            end do
            corner(k, c) = number
         end do
      end do
   end subroutine split_by_kind

end module mesh_geometry
