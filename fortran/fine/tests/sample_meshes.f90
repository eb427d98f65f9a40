!> Regular meshes for the tests of the fine level, independent of the mesh generator.
module sample_meshes
   use base_kinds, only: ik, rk
   use mesh_types, only: mesh_t, point_boundary, point_interior, point_tip
   implicit none(type, external)
   private

   public :: cracked_rectangle, rotate_mesh

contains

   !> A rectangle of n(1) by n(2) boxes, each cut into four triangles by its diagonals, and one
   !! crack in x direction along the grid line on top of box row `row`, from the right end of box
   !! first-1 to that of box last; no crack if last < first. Ends on the outer boundary are split,
   !! others are tips.
   function cracked_rectangle(x_range, y_range, n, row, first, last) result(mesh)
      real(rk), intent(in) :: x_range(2), y_range(2)  !< [m]
      integer(ik), intent(in) :: n(2), row, first, last
      type(mesh_t) :: mesh
      integer(ik), allocatable :: grid(:, :), above(:)
      real(rk) :: step(2)
      integer(ik) :: i, j, cell, node, corner(4)

      step = [x_range(2) - x_range(1), y_range(2) - y_range(1)]/n
      allocate (grid(0:n(1), 0:n(2)), above(0:n(1)))
      allocate (mesh%xy(2, 2*(n(1) + 1)*(n(2) + 1) + n(1)), mesh%cell_nodes(3, 4*n(1)*n(2)))
      node = 0
      do j = 0, n(2)
         do i = 0, n(1)
            node = node + 1
            grid(i, j) = node
            mesh%xy(:, node) = [x_range(1), y_range(1)] + step*[i, j]
         end do
      end do
      above = grid(:, row)
      do i = 0, n(1)
         if (i < first - 1 .or. i > last .or. last < first) cycle
         if ((i == first - 1 .and. i > 0) .or. (i == last .and. i < n(1))) cycle
         node = node + 1
         above(i) = node
         mesh%xy(:, node) = mesh%xy(:, grid(i, row))
      end do
      cell = 0
      do j = 1, n(2)
         do i = 1, n(1)
            node = node + 1
            mesh%xy(:, node) = [x_range(1), y_range(1)] + step*[i - 0.5_rk, j - 0.5_rk]
            corner = [grid(i - 1, j - 1), grid(i, j - 1), grid(i, j), grid(i - 1, j)]
            if (j == row + 1) corner(1:2) = above(i - 1:i)
            mesh%cell_nodes(:, cell + 1) = [corner(1), corner(2), node]
            mesh%cell_nodes(:, cell + 2) = [corner(2), corner(3), node]
            mesh%cell_nodes(:, cell + 3) = [corner(3), corner(4), node]
            mesh%cell_nodes(:, cell + 4) = [corner(4), corner(1), node]
            cell = cell + 4
         end do
      end do
      mesh%n_nodes = node
      mesh%n_cells = cell
      mesh%xy = mesh%xy(:, :node)
      call find_faces(mesh, x_range, y_range)
      call add_crack(mesh, n(1), first, last, grid(:, row), above)
   end function cracked_rectangle

   !> Faces from cells, and the rectangle's sides.
   subroutine find_faces(mesh, x_range, y_range)
      type(mesh_t), intent(inout) :: mesh
      real(rk), intent(in) :: x_range(2), y_range(2)
      integer(ik), allocatable :: newest(:), older(:)
      real(rk) :: middle(2), tolerance
      integer(ik) :: cell, k, a, b, face

      allocate (mesh%cell_faces(3, mesh%n_cells), mesh%face_nodes(2, 3*mesh%n_cells))
      allocate (mesh%face_cells(2, 3*mesh%n_cells), older(3*mesh%n_cells), source=0_ik)
      allocate (newest(mesh%n_nodes), source=0_ik)
      do cell = 1, mesh%n_cells
         do k = 1, 3
            a = mesh%cell_nodes(k, cell)
            b = mesh%cell_nodes(mod(k, 3) + 1, cell)
            face = newest(min(a, b))
            do while (face > 0)
               if (maxval(mesh%face_nodes(:, face)) == max(a, b)) exit
               face = older(face)
            end do
            if (face == 0) then
               mesh%n_faces = mesh%n_faces + 1
               face = mesh%n_faces
               mesh%face_nodes(:, face) = [a, b]
               mesh%face_cells(1, face) = cell
               older(face) = newest(min(a, b))
               newest(min(a, b)) = face
            else
               mesh%face_cells(2, face) = cell
            end if
            mesh%cell_faces(k, cell) = face
         end do
      end do
      mesh%face_nodes = mesh%face_nodes(:, :mesh%n_faces)
      mesh%face_cells = mesh%face_cells(:, :mesh%n_faces)
      allocate (mesh%face_side(mesh%n_faces), mesh%face_fracture_cell(mesh%n_faces), source=0_ik)
      tolerance = 1.0e-9_rk*(x_range(2) - x_range(1))
      do face = 1, mesh%n_faces
         if (mesh%face_cells(2, face) > 0) cycle
         middle = 0.5_rk*sum(mesh%xy(:, mesh%face_nodes(:, face)), dim=2)
         if (abs(middle(1) - x_range(1)) < tolerance) mesh%face_side(face) = 1
         if (abs(middle(1) - x_range(2)) < tolerance) mesh%face_side(face) = 2
         if (abs(middle(2) - y_range(1)) < tolerance) mesh%face_side(face) = 3
         if (abs(middle(2) - y_range(2)) < tolerance) mesh%face_side(face) = 4
      end do
   end subroutine find_faces

   !> The fracture's own mesh.
   subroutine add_crack(mesh, n_boxes, first, last, below, above)
      type(mesh_t), intent(inout) :: mesh
      integer(ik), intent(in) :: n_boxes, first, last
      integer(ik), intent(in) :: below(0:), above(0:)  !< nodes of the grid line on sides + and -
      integer(ik) :: n, i, k, point, tip

      n = max(0_ik, last - first + 1)
      associate (fracture => mesh%fracture)
         fracture%n_cells = n
         fracture%n_points = merge(n + 1, 0_ik, n > 0)
         allocate (fracture%cell_fracture(n), source=1_ik)
         allocate (fracture%cell_points(2, n), fracture%cell_faces(2, n), fracture%cell_s(2, n))
         allocate (fracture%point_xy(2, fracture%n_points), fracture%point_kind(fracture%n_points))
         allocate (fracture%point_cells%first(fracture%n_points + 1))
         allocate (fracture%point_cells%item(2*n))
         k = 0
         do point = 1, fracture%n_points
            i = first - 2 + point
            fracture%point_xy(:, point) = mesh%xy(:, below(i))
            fracture%point_kind(point) = point_interior
            if (point == 1 .or. point == n + 1) then
               fracture%point_kind(point) = merge(point_boundary, point_tip, i == 0 &
                                                  .or. i == n_boxes)
            end if
            fracture%point_cells%first(point) = k + 1
            if (point > 1) fracture%point_cells%item(k + 1) = point - 1
            if (point > 1) k = k + 1
            if (point <= n) fracture%point_cells%item(k + 1) = point
            if (point <= n) k = k + 1
         end do
         fracture%point_cells%first(fracture%n_points + 1) = k + 1
         do k = 1, n
            i = first - 2 + k
            fracture%cell_points(:, k) = [k, k + 1]
            fracture%cell_s(:, k) = norm2(fracture%point_xy(:, k:k + 1) &
                                          - spread(fracture%point_xy(:, 1), 2, 2), dim=1)
            fracture%cell_faces(1, k) = face_between(mesh, below(i), below(i + 1), .false.)
            fracture%cell_faces(2, k) = face_between(mesh, above(i), above(i + 1), .true.)
            mesh%face_fracture_cell(fracture%cell_faces(:, k)) = k
         end do
         associate (kinds => fracture%point_kind)
            fracture%tip_point = pack([(point, point=1, fracture%n_points)], kinds == point_tip)
         end associate
         fracture%n_tips = size(fracture%tip_point)
         fracture%tip_node = below(first - 2 + fracture%tip_point)
         fracture%tip_end = merge(1_ik, 2_ik, fracture%tip_point == 1)
         allocate (fracture%tip_fracture(fracture%n_tips), source=1_ik)
         allocate (fracture%tip_direction(2, fracture%n_tips), &
                   fracture%tip_radius(fracture%n_tips), source=0.0_rk)
         do tip = 1, fracture%n_tips
            fracture%tip_direction(1, tip) = merge(-1.0_rk, 1.0_rk, fracture%tip_end(tip) == 1)
            fracture%tip_radius(tip) = fracture%cell_s(2, 1) - fracture%cell_s(1, 1)
         end do
      end associate
   end subroutine add_crack

   !> The boundary face between two nodes whose element lies above them, or below.
   integer(ik) function face_between(mesh, a, b, element_above)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: a, b
      logical, intent(in) :: element_above
      integer(ik) :: face
      real(rk) :: height

      face_between = 0
      do face = 1, mesh%n_faces
         if (mesh%face_cells(2, face) /= 0 .or. mesh%face_side(face) /= 0) cycle
         if (any(mesh%face_nodes(:, face) /= [a, b]) &
             .and. any(mesh%face_nodes(:, face) /= [b, a])) cycle
         height = sum(mesh%xy(2, mesh%cell_nodes(:, mesh%face_cells(1, face))))/3.0_rk &
                  - mesh%xy(2, a)
         if ((height > 0.0_rk) .eqv. element_above) face_between = face
      end do
   end function face_between

   !> Turn a mesh about the origin, mirrored in the x axis before if asked.
   subroutine rotate_mesh(mesh, angle, mirrored)
      type(mesh_t), intent(inout) :: mesh
      real(rk), intent(in) :: angle  !< anticlockwise [rad]
      logical, intent(in) :: mirrored
      real(rk) :: rotation(2, 2)

      rotation = reshape([cos(angle), sin(angle), -sin(angle), cos(angle)], [2, 2])
      if (mirrored) then
         ! Corners 2 and 3 change places to stay counter-clockwise; the sides of the fracture
         ! change too.
         rotation(:, 2) = -rotation(:, 2)
         mesh%cell_nodes = mesh%cell_nodes([1, 3, 2], :)
         mesh%cell_faces = mesh%cell_faces([3, 2, 1], :)
         mesh%fracture%cell_faces = mesh%fracture%cell_faces([2, 1], :)
      end if
      mesh%xy = matmul(rotation, mesh%xy)
      mesh%fracture%point_xy = matmul(rotation, mesh%fracture%point_xy)
      mesh%fracture%tip_direction = matmul(rotation, mesh%fracture%tip_direction)
   end subroutine rotate_mesh

end module sample_meshes
