!> From a triangle mesh to six-node triangles, with quarter-point elements around the free tips.
module fine_mesh
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_plane, only: cross, norm2
   use base_tolerances, only: same_place
   use fine_element, only: evaluate_element, node_within
   use mesh_types, only: fracture_mesh_t, mesh_t
   implicit none(type, external)
   private

   public :: build_fine_mesh, fine_mesh_t, tip_collapsed, tip_plain, tip_quarter

   ! Elements around the free tips.
   integer(ik), parameter :: tip_quarter = 1  !< six-node triangles with quarter points
   integer(ik), parameter :: tip_collapsed = 2  !< collapsed eight-node quadrilaterals (Barsoum)
   integer(ik), parameter :: tip_plain = 3  !< like all others

   !> Six-node triangles. The first n_vertices nodes are those of the mesh they come from, in its
   !! order; node n_vertices + f lies on its face f. Both sides of a fracture have nodes of their
   !! own.
   type :: fine_mesh_t
      integer(ik) :: n_vertices = 0
      integer(ik) :: n_nodes = 0
      integer(ik) :: n_cells = 0
      real(rk), allocatable :: xy(:, :)  !< (2, n_nodes) [m]
      integer(ik), allocatable :: cell_nodes(:, :)  !< (6, n_cells) corners, then the node on face k
      integer(ik) :: tip_element = tip_quarter  !< tip_quarter, tip_collapsed or tip_plain
      integer(ik), allocatable :: tip_corner(:)  !< (n_cells) corner with quarter points, else 0
      logical, allocatable :: on_boundary(:)  !< (n_nodes) on the outer boundary
      !> (2, n) end nodes of the faces on the outer boundary, the body on their left
      integer(ik), allocatable :: boundary_faces(:, :)
      integer(ik), allocatable :: boundary_middles(:)  !< (n) the node between them
      integer(ik), allocatable :: boundary_sides(:)  !< (n) on which side of the body they lie
      integer(ik), allocatable :: face_nodes(:, :, :)  !< (start end mid, side + -, fracture cell)
      integer(ik), allocatable :: face_cells(:, :)  !< (2, fracture cells) element on side +, -
      integer(ik), allocatable :: face_at_tip(:)  !< (fracture cells) tip at start 1, end 2, none 0
      integer(ik), allocatable :: face_tip(:)  !< the same, but 0 without quarter points
      real(rk), allocatable :: face_s(:, :)  !< (3, fracture cells) start, end, mid [m]
      real(rk), allocatable :: face_tangent(:, :)  !< (2, fracture cells) unit vector tau
      real(rk), allocatable :: face_length(:)  !< (fracture cells) [m]
      type(fracture_mesh_t) :: fracture  !< as in the mesh this one comes from
   contains
      procedure :: evaluate
   end type fine_mesh_t

contains

   !> Number the nodes, place them, and check that no element is inverted.
   subroutine build_fine_mesh(mesh, fine, error, tip_element)
      type(mesh_t), intent(in) :: mesh
      type(fine_mesh_t), intent(out) :: fine
      type(error_t), allocatable, intent(out) :: error
      integer(ik), intent(in), optional :: tip_element  !< default: tip_quarter
      logical, allocatable :: has_quarter_points(:), is_tip(:)
      integer(ik) :: face, tip, tip_end, cell, k
      real(rk) :: within

      if (.not. sum(abs(mesh%xy)) <= huge(1.0_rk)) then
         call raise_error(error, "build_fine_mesh", "a node's coordinate is not a finite number")
         return
      end if
      allocate (is_tip(mesh%n_nodes), source=.false.)
      do tip = 1, mesh%fracture%n_tips
         is_tip(mesh%fracture%tip_node(tip)) = .true.
      end do
      if (present(tip_element)) fine%tip_element = tip_element
      if (fine%tip_element < tip_quarter .or. fine%tip_element > tip_plain) then
         call raise_error(error, "build_fine_mesh", "there is no such kind of element at tips")
         return
      end if
      has_quarter_points = is_tip .and. fine%tip_element /= tip_plain

      call place_nodes(mesh, has_quarter_points, fine, error)
      if (allocated(error)) return
      allocate (fine%cell_nodes(6, fine%n_cells))
      allocate (fine%tip_corner(fine%n_cells), source=0_ik)
      fine%cell_nodes(1:3, :) = mesh%cell_nodes(:, :fine%n_cells)
      fine%cell_nodes(4:6, :) = mesh%n_nodes + mesh%cell_faces(:, :fine%n_cells)
      do cell = 1, fine%n_cells
         do k = 1, 3
            if (has_quarter_points(mesh%cell_nodes(k, cell))) fine%tip_corner(cell) = k
         end do
      end do
      call check_cells(fine, error)
      if (allocated(error)) return

      call number_boundary_faces(mesh, fine)
      call number_fracture_faces(mesh, fine, error)
      if (allocated(error)) return
      allocate (fine%face_at_tip(fine%fracture%n_cells), source=0_ik)
      do face = 1, fine%fracture%n_cells
         do tip_end = 1, 2
            if (is_tip(fine%face_nodes(tip_end, 1, face))) fine%face_at_tip(face) = tip_end
         end do
      end do
      fine%face_tip = merge(0_ik, fine%face_at_tip, fine%tip_element == tip_plain)
      do face = 1, fine%fracture%n_cells
         fine%face_s(1:2, face) = mesh%fracture%cell_s(:, face)
         within = node_within(fine%face_tip(face))
         fine%face_s(3, face) = (1.0_rk - within)*fine%face_s(1, face) &
                                + within*fine%face_s(2, face)
      end do
   end subroutine build_fine_mesh

   !> Nodes at the corners and on the faces.
   pure subroutine place_nodes(mesh, has_quarter_points, fine, error)
      type(mesh_t), intent(in) :: mesh
      logical, intent(in) :: has_quarter_points(:)  !< (nodes of the mesh) on the faces around them
      type(fine_mesh_t), intent(inout) :: fine
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: ends(2, 2), within
      integer(ik) :: face, tip_end

      fine%n_vertices = mesh%n_nodes
      fine%n_nodes = mesh%n_nodes + mesh%n_faces
      fine%n_cells = mesh%n_cells
      allocate (fine%xy(2, fine%n_nodes))
      fine%xy(:, :mesh%n_nodes) = mesh%xy(:, :mesh%n_nodes)
      do face = 1, mesh%n_faces
         ends = mesh%xy(:, mesh%face_nodes(:, face))
         tip_end = 0
         if (all(has_quarter_points(mesh%face_nodes(:, face)))) then
            call raise_error(error, "build_fine_mesh", &
                             "one edge joins two tips: the mesh around them is too coarse")
            return
         else if (has_quarter_points(mesh%face_nodes(1, face))) then
            tip_end = 1
         else if (has_quarter_points(mesh%face_nodes(2, face))) then
            tip_end = 2
         end if
         within = node_within(tip_end)
         fine%xy(:, mesh%n_nodes + face) = (1.0_rk - within)*ends(:, 1) + within*ends(:, 2)
      end do
   end subroutine place_nodes

   !> Faces and nodes on the outer boundary.
   pure subroutine number_boundary_faces(mesh, fine)
      type(mesh_t), intent(in) :: mesh
      type(fine_mesh_t), intent(inout) :: fine
      integer(ik), allocatable :: outer(:)
      integer(ik) :: cell, face, k

      allocate (fine%on_boundary(fine%n_nodes), source=.false.)
      outer = pack([(face, face=1, mesh%n_faces)], mesh%face_side > 0)
      allocate (fine%boundary_faces(2, size(outer)))
      do face = 1, size(outer)
         cell = mesh%face_cells(1, outer(face))
         k = findloc(mesh%cell_faces(:, cell), outer(face), dim=1)
         fine%boundary_faces(:, face) = mesh%cell_nodes([k, mod(k, 3) + 1], cell)
      end do
      fine%boundary_middles = mesh%n_nodes + outer
      fine%boundary_sides = mesh%face_side(outer)
      do face = 1, mesh%n_faces
         if (mesh%face_side(face) == 0) cycle
         fine%on_boundary(mesh%face_nodes(:, face)) = .true.
         fine%on_boundary(mesh%n_nodes + face) = .true.
      end do
   end subroutine number_boundary_faces

   !> Everything that integrals need at one point of an element (see evaluate_element).
   pure subroutine evaluate(self, cell, lambda, values, gradients, area_coordinates, determinant)
      class(fine_mesh_t), intent(in) :: self
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: lambda(3)  !< barycentric coordinates of the reference triangle [-]
      real(rk), intent(out) :: values(6)  !< shape functions [-]
      real(rk), intent(out) :: gradients(2, 6)  !< their gradients [1/m]
      real(rk), intent(out) :: area_coordinates(3)  !< barycentric coordinates in space [-]
      real(rk), intent(out) :: determinant  !< of the Jacobian [m2]

      real(rk) :: xy(2, 6)

      xy = self%xy(:, self%cell_nodes(:, cell))
      call evaluate_element(xy, self%tip_corner(cell), lambda, values, gradients, &
                            area_coordinates, determinant, self%tip_element == tip_collapsed)
   end subroutine evaluate

   !> Every element must be counter-clockwise and not flat. The quarter-point map of a straight-
   !! edged triangle is one to one if the triangle is, so the corners decide.
   pure subroutine check_cells(fine, error)
      type(fine_mesh_t), intent(in) :: fine
      type(error_t), allocatable, intent(out) :: error
      real(rk), parameter :: flattest = 1.0e-10_rk  ! double area over squared longest edge
      real(rk) :: edge(2, 3), double_area, longest  ! squared
      integer(ik) :: cell
      character(len=80) :: place

      do cell = 1, fine%n_cells
         edge(:, 1) = fine%xy(:, fine%cell_nodes(2, cell)) - fine%xy(:, fine%cell_nodes(1, cell))
         edge(:, 2) = fine%xy(:, fine%cell_nodes(3, cell)) - fine%xy(:, fine%cell_nodes(2, cell))
         edge(:, 3) = -edge(:, 1) - edge(:, 2)
         double_area = cross(edge(:, 1), edge(:, 2))
         longest = max(sum(edge(:, 1)**2), sum(edge(:, 2)**2), sum(edge(:, 3)**2))
         if (double_area > flattest*longest) cycle
         write (place, "(a,i0,a,2(es12.5,a))") "element ", cell, " at (", &
            fine%xy(1, fine%cell_nodes(1, cell)), &
            ", ", fine%xy(2, fine%cell_nodes(1, cell)), ")"
         call raise_error(error, "build_fine_mesh", trim(place)//" is inverted or flat")
         return
      end do
   end subroutine check_cells

   !> Nodes and elements on both sides of every fracture cell, in the fracture's direction.
   subroutine number_fracture_faces(mesh, fine, error)
      type(mesh_t), intent(in) :: mesh
      type(fine_mesh_t), intent(inout) :: fine
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: chord(2), along(2), middle, places(2, 2)
      integer(ik) :: cell, side, face, ends(2)
      character(len=16) :: number

      fine%fracture = mesh%fracture
      associate (n => fine%fracture%n_cells)
         allocate (fine%face_nodes(3, 2, n), fine%face_cells(2, n), fine%face_s(3, n))
         allocate (fine%face_tangent(2, n), fine%face_length(n))
      end associate
      do cell = 1, fine%fracture%n_cells
         associate (points => fine%fracture%point_xy(:, fine%fracture%cell_points(:, cell)))
            chord = points(:, 2) - points(:, 1)
            middle = 0.5_rk*dot_product(chord, points(:, 1) + points(:, 2))
         end associate
         fine%face_length(cell) = norm2(chord)
         write (number, "(i0)") cell
         if (.not. fine%face_length(cell) > 0.0_rk) then
            call raise_error(error, "build_fine_mesh", &
                             "fracture cell "//trim(number)//" has no length")
            return
         end if
         fine%face_tangent(:, cell) = chord/fine%face_length(cell)
         do side = 1, 2
            face = mesh%fracture%cell_faces(side, cell)
            ends = mesh%face_nodes(:, face)
            along = matmul(chord, mesh%xy(:, ends)) - middle
            if (along(1) > along(2)) ends = ends([2, 1])
            fine%face_nodes(:, side, cell) = [ends, mesh%n_nodes + face]
            fine%face_cells(side, cell) = mesh%face_cells(1, face)
            places = fine%fracture%point_xy(:, fine%fracture%cell_points(:, cell))
            if (any(abs(mesh%xy(:, ends) - places) > same_place*fine%face_length(cell)) &
                .or. mesh%face_cells(2, face) /= 0) then
               call raise_error(error, "build_fine_mesh", &
                                "fracture cell "//trim(number)//" does not match its mesh faces")
               return
            end if
         end do
      end do
   end subroutine number_fracture_faces

end module fine_mesh
