!> The domain of an integral about a tip. It ends before anything that the integral could not pass:
!! a kink, another fracture, the far end of the straight piece, the outer boundary, other rock.
module tips_domain
   use base_kinds, only: ik, rk
   use base_plane, only: point_distance
   use base_tolerances, only: same_direction, same_place
   use fine_elasticity, only: is_same, rocks_t
   use fine_loads, only: fine_loads_t
   use fine_mesh, only: fine_mesh_t
   use fine_quadrature, only: collapsed_rule, triangle_rule_7
   use tips_types, only: tip_frame_t
   implicit none(type, external)
   private

   public :: domain_weight, element_rule, largest_radius, reference_angle, rosette_size
   public :: rule_size, in_situ_stress

   integer(ik), parameter :: rule_t = 4, rule_w = 5, rule_size = rule_t*rule_w  !< points at most

contains

   !> The weight q at the nodes: 1 near the tip, 0 from the domain's radius on.
   pure function domain_weight(fine, frame, radius, plateau) result(q)
      type(fine_mesh_t), intent(in) :: fine
      type(tip_frame_t), intent(in) :: frame
      real(rk), intent(in) :: radius  !< [m]
      real(rk), intent(in) :: plateau  !< share of the radius within which q = 1 [-]
      real(rk) :: q(fine%n_nodes)
      real(rk) :: distance
      integer(ik) :: node

      do node = 1, fine%n_nodes
         distance = norm2(fine%xy(:, node) - frame%origin)/radius
         q(node) = max(0.0_rk, min(1.0_rk, (1.0_rk - distance)/(1.0_rk - plateau)))
         if (distance > 1.0_rk - same_place) q(node) = 0.0_rk
      end do
   end function domain_weight

   !> Points for an element of the domain: next to the tip in t and w about it, which makes the
   !! integrands polynomials.
   pure subroutine element_rule(fine, frame, cell, n_points, points, weights)
      type(fine_mesh_t), intent(in) :: fine
      type(tip_frame_t), intent(in) :: frame
      integer(ik), intent(in) :: cell
      integer(ik), intent(out) :: n_points
      real(rk), intent(out) :: points(3, rule_size), weights(rule_size)  !< [-]
      integer(ik) :: corner

      corner = findloc(fine%cell_nodes(1:3, cell), frame%node, dim=1)
      if (corner > 0) then
         n_points = rule_size
         call collapsed_rule(corner, rule_t, rule_w, points, weights)
      else
         n_points = 7
         call triangle_rule_7(points(:, 1:7), weights(1:7))
      end if
   end subroutine element_rule

   !> In-situ stress at the tip, in its axes [Pa].
   pure function in_situ_stress(loads, frame) result(stress)
      type(fine_loads_t), intent(in) :: loads
      type(tip_frame_t), intent(in) :: frame
      real(rk) :: stress(2, 2)

      associate (given => loads%initial_stress(:, frame%node))
         stress = reshape([given(1), given(3), given(3), given(2)], [2, 2])
      end associate
      stress = matmul(frame%axes, matmul(stress, transpose(frame%axes)))
   end function in_situ_stress

   !> How far a domain may reach [m].
   pure real(rk) function largest_radius(fine, frame, rocks)
      type(fine_mesh_t), intent(in) :: fine
      type(tip_frame_t), intent(in) :: frame
      type(rocks_t), intent(in) :: rocks
      real(rk) :: place(2, 2), straight_length
      integer(ik) :: cell, face, k

      largest_radius = huge(1.0_rk)
      straight_length = 0.0_rk
      do cell = 1, fine%fracture%n_cells
         place = in_tip_axes(fine%face_nodes(1:2, 1, cell))
         if (fine%fracture%cell_fracture(cell) == frame%fracture &
             .and. all(abs(place(2, :)) <= same_direction*maxval(abs(place)))) then
            straight_length = max(straight_length, maxval(abs(place(1, :))))
         else
            largest_radius = min(largest_radius, point_distance([0.0_rk, 0.0_rk], place))
         end if
      end do
      largest_radius = min(largest_radius, straight_length)
      do face = 1, size(fine%boundary_faces, 2)
         place = in_tip_axes(fine%boundary_faces(:, face))
         largest_radius = min(largest_radius, point_distance([0.0_rk, 0.0_rk], place))
      end do
      do cell = 1, merge(fine%n_cells, 0_ik, size(rocks%of_cell) > 1)
         if (is_same(rocks%in_cell(cell), frame%rock)) cycle
         do k = 1, 3
            place = in_tip_axes(fine%cell_nodes([k, mod(k, 3_ik) + 1_ik], cell))
            largest_radius = min(largest_radius, point_distance([0.0_rk, 0.0_rk], place))
         end do
      end do

   contains

      !> Places of two nodes.
      pure function in_tip_axes(nodes) result(place)
         integer(ik), intent(in) :: nodes(2)
         real(rk) :: place(2, 2)
         integer(ik) :: k

         do k = 1, 2
            place(:, k) = matmul(frame%axes, fine%xy(:, nodes(k)) - frame%origin)
         end do
      end function in_tip_axes

   end function largest_radius

   !> Largest distance of the corners of the elements around a tip from it [m].
   pure real(rk) function rosette_size(fine, frame)
      type(fine_mesh_t), intent(in) :: fine
      type(tip_frame_t), intent(in) :: frame
      real(rk) :: corner(2)
      integer(ik) :: cell, k

      rosette_size = 0.0_rk
      do cell = 1, fine%n_cells
         if (.not. any(fine%cell_nodes(1:3, cell) == frame%node)) cycle
         do k = 1, 3
            corner = fine%xy(:, fine%cell_nodes(k, cell))
            rosette_size = max(rosette_size, norm2(corner - frame%origin))
         end do
      end do
   end function rosette_size

   !> A polar angle near to those of an element, continued across the line behind the crack where
   !! the crack itself has turned away from it. A node within the domain and off the line has a
   !! sure angle; an element all of whose nodes within the domain are on the line lies on one side
   !! of it.
   pure real(rk) function reference_angle(fine, frame, cell, q)
      type(fine_mesh_t), intent(in) :: fine
      type(tip_frame_t), intent(in) :: frame
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: q(:)  !< (n_nodes) [-]
      real(rk) :: place(2)
      integer(ik) :: k

      do k = 1, 6
         if (.not. q(fine%cell_nodes(k, cell)) > 0.0_rk) cycle
         place = matmul(frame%axes, fine%xy(:, fine%cell_nodes(k, cell)) - frame%origin)
         if (abs(place(2)) > same_direction*norm2(place)) then
            reference_angle = atan2(place(2), place(1))
            return
         end if
      end do
      place = sum(fine%xy(:, fine%cell_nodes(1:3, cell)), dim=2)/3.0_rk
      place = matmul(frame%axes, place - frame%origin)
      reference_angle = atan2(place(2), place(1))
   end function reference_angle

end module tips_domain
