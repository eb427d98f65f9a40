!> The outer boundary: prescribed displacements, and the forces of prescribed tractions.
!!
!! Every displacement component of every node is either prescribed or free. Where it is free, the
!! nodal force is prescribed: zero, unless a traction or a point force has been added.
!!
!! Sides of the body on springs, as part of the stiffness of the elements there.
module fine_boundary
   use base_errors, only: error_t, raise_error
   use base_groups, only: groups_t, single_groups
   use base_kinds, only: ik, rk
   use base_number, only: brief_text
   use base_plane, only: norm2
   use fine_mesh, only: fine_mesh_t
   implicit none(type, external)
   private

   public :: add_point_force, add_side_springs, add_side_stress
   public :: add_side_traction, check_boundary, check_support, clamped_boundary, find_loose
   public :: fine_boundary_t, free_boundary, mark_side, nearest_node

   !> What is given on the outer boundary, or anywhere else; the values belong to the loads.
   type :: fine_boundary_t
      logical, allocatable :: prescribed(:, :)  !< (2, n_nodes) displacement component given
      !> (2, n_nodes) component against which springs of the elements act (fine_boundary)
      logical, allocatable :: sprung(:, :)
   end type fine_boundary_t

contains

   !> All displacements given on the whole outer boundary, as on the edge of a window.
   pure function clamped_boundary(fine) result(boundary)
      type(fine_mesh_t), intent(in) :: fine
      type(fine_boundary_t) :: boundary

      allocate (boundary%prescribed(2, fine%n_nodes))
      boundary%prescribed(1, :) = fine%on_boundary
      boundary%prescribed(2, :) = fine%on_boundary
      allocate (boundary%sprung(2, fine%n_nodes), source=.false.)
   end function clamped_boundary

   !> No displacement prescribed: a free body.
   pure function free_boundary(fine) result(boundary)
      type(fine_mesh_t), intent(in) :: fine
      type(fine_boundary_t) :: boundary

      allocate (boundary%prescribed(2, fine%n_nodes), source=.false.)
      boundary%sprung = boundary%prescribed
   end function free_boundary

   !> Mark a displacement component of one side of the body: as prescribed, where 1 alone and 2
   !! alone are rollers and both are a clamp, or as sprung.
   pure subroutine mark_side(fine, side, component, is_marked)
      type(fine_mesh_t), intent(in) :: fine
      integer(ik), intent(in) :: side  !< as mesh_t%face_side numbers them
      integer(ik), intent(in) :: component  !< 1: u_x, 2: u_y
      logical, intent(inout) :: is_marked(:, :)  !< (2, n_nodes) of fine_boundary_t
      integer(ik) :: face

      do face = 1, size(fine%boundary_sides)
         if (fine%boundary_sides(face) /= side) cycle
         is_marked(component, fine%boundary_faces(:, face)) = .true.
         is_marked(component, fine%boundary_middles(face)) = .true.
      end do
   end subroutine mark_side

   !> Corner node of an element nearest to a point, for point forces and single-point restraints.
   pure integer(ik) function nearest_node(fine, xy)
      type(fine_mesh_t), intent(in) :: fine
      real(rk), intent(in) :: xy(2)  !< [m]
      real(rk) :: distance, shortest
      integer(ik) :: node

      nearest_node = 0
      shortest = huge(1.0_rk)
      do node = 1, fine%n_vertices
         distance = norm2(fine%xy(:, node) - xy)
         if (distance < shortest) then
            shortest = distance
            nearest_node = node
         end if
      end do
   end function nearest_node

   !> A uniform traction on one side of the body.
   pure subroutine add_side_traction(fine, side, traction, force)
      type(fine_mesh_t), intent(in) :: fine
      integer(ik), intent(in) :: side  !< as mesh_t%face_side numbers them
      real(rk), intent(in) :: traction(2)  !< t_x, t_y on the body [Pa]
      real(rk), intent(inout) :: force(:, :)  !< (2, n_nodes) [N/m]
      integer(ik) :: face

      do face = 1, size(fine%boundary_sides)
         if (fine%boundary_sides(face) == side) call add_face_traction(fine, face, traction, force)
      end do
   end subroutine add_side_traction

   !> Uniform tractions along the outward normal of a side and along the side itself, in the
   !! direction that has the body on its left.
   pure subroutine add_side_stress(fine, side, normal, shear, force)
      type(fine_mesh_t), intent(in) :: fine
      integer(ik), intent(in) :: side  !< as mesh_t%face_side numbers them
      real(rk), intent(in) :: normal, shear  !< [Pa]
      real(rk), intent(inout) :: force(:, :)  !< (2, n_nodes) [N/m]
      real(rk) :: tangent(2)
      integer(ik) :: face

      do face = 1, size(fine%boundary_sides)
         if (fine%boundary_sides(face) /= side) cycle
         ! The body lies on the left of its faces, so the outward normal is on their right.
         tangent = fine%xy(:, fine%boundary_faces(2, face)) &
                   - fine%xy(:, fine%boundary_faces(1, face))
         tangent = tangent/norm2(tangent)
         call add_face_traction(fine, face, normal*[tangent(2), -tangent(1)] + shear*tangent, force)
      end do
   end subroutine add_side_stress

   !> Shares 1/6, 1/6 and 4/6 of a uniform traction's resultant for the ends and the middle of a
   !! face: exact integrals of the shape functions.
   pure subroutine add_face_traction(fine, face, traction, force)
      type(fine_mesh_t), intent(in) :: fine
      integer(ik), intent(in) :: face  !< index in boundary_faces
      real(rk), intent(in) :: traction(2)  !< [Pa]
      real(rk), intent(inout) :: force(:, :)  !< (2, n_nodes) [N/m]
      real(rk) :: resultant(2)
      integer(ik) :: k

      associate (ends => fine%boundary_faces(:, face), middle => fine%boundary_middles(face))
         resultant = norm2(fine%xy(:, ends(2)) - fine%xy(:, ends(1)))*traction
         do k = 1, 2
            force(:, ends(k)) = force(:, ends(k)) + resultant/6.0_rk
         end do
         force(:, middle) = force(:, middle) + resultant/1.5_rk
      end associate
   end subroutine add_face_traction

   !> A concentrated force at the node nearest to a point.
   pure subroutine add_point_force(fine, xy, point_force, force)
      type(fine_mesh_t), intent(in) :: fine
      real(rk), intent(in) :: xy(2)  !< [m]
      real(rk), intent(in) :: point_force(2)  !< per unit thickness [N/m]
      real(rk), intent(inout) :: force(:, :)  !< (2, n_nodes) [N/m]
      integer(ik) :: node

      node = nearest_node(fine, xy)
      force(:, node) = force(:, node) + point_force
   end subroutine add_point_force

   !> Refuse a boundary that does not belong to the mesh.
   pure subroutine check_boundary(fine, boundary, error)
      type(fine_mesh_t), intent(in) :: fine
      type(fine_boundary_t), intent(in) :: boundary
      type(error_t), allocatable, intent(out) :: error
      character(len=*), parameter :: origin = "check_boundary"

      if (.not. allocated(boundary%prescribed)) then
         call raise_error(error, origin, "the boundary conditions have not been set")
      else if (any(shape(boundary%prescribed) /= [2_ik, fine%n_nodes])) then
         call raise_error(error, origin, "the boundary conditions belong to another mesh")
      end if
   end subroutine check_boundary

   !> Raise an error if the body or a part of it has a rigid-body motion that no prescribed
   !! displacements or springs exclude: the solution is not unique.
   pure subroutine check_support(fine, boundary, bonds, error)
      type(fine_mesh_t), intent(in) :: fine
      type(fine_boundary_t), intent(in) :: boundary
      integer(ik), intent(in) :: bonds(:, :)  !< (2, n) pairs of nodes
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: place

      call find_loose(fine, boundary, bonds, place)
      if (.not. allocated(place)) return
      call raise_error(error, "check_support", "the part of the body at "//place// &
                       " can move as a rigid body; prescribe more displacements or springs on "// &
                       "its boundary")
   end subroutine check_support

   !> Find a part of the body with a rigid-body motion that no prescribed displacements or springs
   !! exclude.
   !!
   !! Parts are groups of elements that share nodes; `bonds` joins the nodes that face conditions
   !! tie.
   pure subroutine find_loose(fine, boundary, bonds, place)
      type(fine_mesh_t), intent(in) :: fine
      type(fine_boundary_t), intent(in) :: boundary
      integer(ik), intent(in) :: bonds(:, :)  !< (2, n) pairs of nodes
      character(len=:), allocatable, intent(out) :: place  !< a point of it; unallocated: none
      type(groups_t) :: pieces
      integer(ik) :: piece(fine%n_nodes)
      real(rk), allocatable :: held(:, :, :)
      real(rk) :: centre(2), reach, row(3)
      integer(ik) :: cell, component, k, node

      pieces = single_groups(fine%n_nodes)
      do cell = 1, fine%n_cells
         do k = 2, 6
            call pieces%join(fine%cell_nodes(1, cell), fine%cell_nodes(k, cell))
         end do
      end do
      do k = 1, size(bonds, 2)
         call pieces%join(bonds(1, k), bonds(2, k))
      end do
      piece = pieces%numbers()

      ! Sums of the products of the three rigid motions' values, over the held components.
      centre = 0.5_rk*(maxval(fine%xy, dim=2) + minval(fine%xy, dim=2))
      reach = maxval(maxval(fine%xy, dim=2) - minval(fine%xy, dim=2))
      allocate (held(3, 3, pieces%count_groups()), source=0.0_rk)
      do node = 1, fine%n_nodes
         associate (sums => held(:, :, piece(node)), arm => (fine%xy(:, node) - centre)/reach)
            do component = 1, 2
               if (.not. (boundary%prescribed(component, node) &
                          .or. boundary%sprung(component, node))) cycle
               row = merge([1.0_rk, 0.0_rk, -arm(2)], [0.0_rk, 1.0_rk, arm(1)], component == 1)
               do k = 1, 3
                  sums(:, k) = sums(:, k) + row(k)*row
               end do
            end do
         end associate
      end do
      do k = 1, size(held, 3)
         if (is_definite(held(:, :, k))) cycle
         node = findloc(piece, k, dim=1)
         place = "("//brief_text(fine%xy(1, node), 6)//", "//brief_text(fine%xy(2, node), 6)//")"
         return
      end do
   end subroutine find_loose

   !> Whether a symmetric matrix is positive definite, by Cholesky's elimination.
   pure logical function is_definite(matrix)
      real(rk), intent(in) :: matrix(3, 3)  !< [-]
      real(rk), parameter :: smallest = 1.0e-10_rk  ! pivot over trace
      real(rk) :: rest(3, 3)
      integer(ik) :: i, j, k

      rest = matrix
      is_definite = .false.
      do k = 1, 3
         if (.not. rest(k, k) > smallest*(matrix(1, 1) + matrix(2, 2) + matrix(3, 3))) return
         do j = k + 1, 3
            do i = k + 1, 3
               rest(i, j) = rest(i, j) - rest(i, k)*rest(k, j)/rest(k, k)
            end do
         end do
      end do
      is_definite = .true.
   end function is_definite

   !> Springs along one side, each component by itself: the traction -k u on the side gives the
   !! element of each face its k N_i N_j, integrated along the face; for its ends and its middle
   !! exactly length/30 (4 -1 2; -1 4 2; 2 2 16).
   pure subroutine add_side_springs(fine, side, spring, stiffness)
      type(fine_mesh_t), intent(in) :: fine
      integer(ik), intent(in) :: side  !< as mesh_t%face_side numbers them
      real(rk), intent(in) :: spring(2)  !< x, y: traction over displacement [Pa/m]
      real(rk), intent(inout) :: stiffness(:, :, :)  !< (12, 12, n_cells) [Pa]
      real(rk), parameter :: shares(3, 3) = reshape([4.0_rk, -1.0_rk, 2.0_rk, &
                                                     -1.0_rk, 4.0_rk, 2.0_rk, &
                                                     2.0_rk, 2.0_rk, 16.0_rk], [3, 3])/30.0_rk
      integer(ik) :: axis, cell, corner(3), element(fine%n_nodes), face, i, j, nodes(3)

      if (.not. any(spring > 0.0_rk)) return
      element = 0
      do cell = 1, fine%n_cells
         element(fine%cell_nodes(4:, cell)) = cell
      end do
      do face = 1, size(fine%boundary_sides, kind=ik)
         if (fine%boundary_sides(face) /= side) cycle
         nodes = [fine%boundary_faces(:, face), fine%boundary_middles(face)]
         cell = element(nodes(3))
         do i = 1, 3
            corner(i) = findloc(fine%cell_nodes(:, cell), nodes(i), dim=1, kind=ik)
         end do
         associate (length => norm2(fine%xy(:, nodes(2)) - fine%xy(:, nodes(1))))
            do axis = 1, 2
               do j = 1, 3
                  do i = 1, 3
                     associate (entry => stiffness(2*corner(i) - 2 + axis, &
                                                   2*corner(j) - 2 + axis, cell))
                        entry = entry + spring(axis)*length*shares(i, j)
                     end associate
                  end do
               end do
            end do
         end associate
      end do
   end subroutine add_side_springs

end module fine_boundary
