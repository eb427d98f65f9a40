!> The domain of an integral around a tip. It ends before any feature that would make the integral
!! depend on the path: a kink, another fracture, the far end of the straight segment, the outer
!! boundary, other rock.
!!
!! The traction on the fracture faces, for the interaction integral.
module fine_tip_domain
   use base_kinds, only: ik, rk
   use base_plane, only: norm2, point_distance, turned_left
   use base_tolerances, only: same_direction, same_place
   use fine_elasticity, only: is_same, rocks_t
   use fine_element, only: line_resultants, line_shapes, tip_rule, tip_rule_size
   use fine_faces, only: face_contact, face_jump, face_loaded
   use fine_loads, only: fine_loads_t, volume_forces
   use fine_mesh, only: fine_mesh_t
   use fine_model, only: fine_model_t
   use fine_tip_types, only: tip_frame_t
   implicit none(type, external)
   private

   public :: domain_weight, element_rule, face_traction, in_situ_stress, is_joint, joint_deviation
   public :: largest_radius, reference_angle, rosette_size, traction_source

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

      q = 0.0_rk
      do node = 1, fine%n_nodes
         if (maxval(abs(fine%xy(:, node) - frame%origin)) > radius) cycle  ! most of a mesh
         distance = norm2(fine%xy(:, node) - frame%origin)/radius
         if (distance > 1.0_rk - same_place) cycle
         q(node) = max(0.0_rk, min(1.0_rk, (1.0_rk - distance)/(1.0_rk - plateau)))
      end do
   end function domain_weight

   !> Points for an element of the domain: next to the tip in t and w about it, which makes the
   !! integrands polynomials.
   pure subroutine element_rule(fine, frame, cell, n_points, points, weights)
      type(fine_mesh_t), intent(in) :: fine
      type(tip_frame_t), intent(in) :: frame
      integer(ik), intent(in) :: cell
      integer(ik), intent(out) :: n_points
      real(rk), intent(out) :: points(3, tip_rule_size), weights(tip_rule_size)  !< [-]

      call tip_rule(findloc(fine%cell_nodes(1:3, cell), frame%node, dim=1, kind=ik), n_points, &
                    points, weights)
   end subroutine element_rule

   !> In-situ stress at a vertex, in the axes of a tip [Pa].
   pure function in_situ_stress(loads, frame, vertex) result(stress)
      type(fine_loads_t), intent(in) :: loads
      type(tip_frame_t), intent(in) :: frame
      integer(ik), intent(in) :: vertex
      real(rk) :: stress(2, 2)
      real(rk) :: on_axis(2, 2)
      integer(ik) :: i, j

      associate (given => loads%initial_stress(:, vertex), axes => frame%axes)
         on_axis(1, :) = given(1)*axes(:, 1) + given(3)*axes(:, 2)
         on_axis(2, :) = given(3)*axes(:, 1) + given(2)*axes(:, 2)
         do j = 1, 2
            do i = 1, 2
               stress(i, j) = axes(i, 1)*on_axis(1, j) + axes(i, 2)*on_axis(2, j)
            end do
         end do
      end associate
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

   !> Mean total traction on side + of a fracture cell (f - p n; side - carries the opposite), in x
   !! and y.
   !!
   !! On a loaded cell it is the given one. Where the jump, or a part of it, is tied, the traction
   !! is the force that the element on side + needs at the face's middle node over that node's
   !! share of the face. No other element touches that node, and such forces are far more accurate
   !! than stresses at the face.
   pure function face_traction(model, loads, displacement, cell) result(traction)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      integer(ik), intent(in) :: cell  !< fracture cell
      real(rk) :: traction(2)  !< [Pa]
      real(rk) :: tau(2), force(2, 6), share(3)
      integer(ik) :: k, element

      if (model%conditions%condition(cell) == face_loaded) then
         tau = model%mesh%face_tangent(:, cell)
         traction = loads%traction(1, cell)*tau &
                    + (loads%traction(2, cell) - loads%fluid_pressure(cell))*[-tau(2), tau(1)]
         return
      end if
      element = model%mesh%face_cells(1, cell)
      associate (nodes => model%mesh%cell_nodes(:, element), &
                 rock => model%rocks%in_cell(element))
         k = findloc(nodes, model%mesh%face_nodes(3, 1, cell), dim=1)
         force = model%element_forces(displacement, element) &
                 - volume_forces(model%mesh, element, rock%biot, loads)
      end associate
      share = line_resultants(model%mesh%face_tip(cell))
      traction = force(:, k)/(share(3)*model%mesh%face_length(cell))
   end function face_traction

   !> Whether the faces of a fracture cell close under pressure, so that their traction follows from
   !! their jump.
   pure logical function is_joint(model, cell)
      type(fine_model_t), intent(in) :: model
      integer(ik), intent(in) :: cell  !< fracture cell

      is_joint = model%conditions%condition(cell) == face_contact
      if (is_joint) is_joint = model%conditions%law(cell)%contact%compliance > 0.0_rk
   end function is_joint

   !> Traction on side + at a point of a joint, less that of its middle, in x and y: the law at the
   !! interpolated jump. The faces slide with friction where they do so in the middle.
   !!
   !! At the tip the jump is zero, so the joint bears the pressure that it had at rest, and half an
   !! element farther on often nothing: the traction of the middle alone leaves K several per cent
   !! too small.
   pure function joint_deviation(model, loads, displacement, cell, x) result(deviation)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      integer(ik), intent(in) :: cell  !< fracture cell of a joint
      real(rk), intent(in) :: x  !< parameter of the shape functions along it, 0 to 1 [-]
      real(rk) :: deviation(2)  !< [Pa]
      real(rk), parameter :: slides = 1.0e-6_rk  !< distance of the traction from friction [-]
      real(rk) :: axes(2, 2), jump(2, 3), traction(2), difference

      associate (plus => model%mesh%face_nodes(:, 1, cell), &
                 minus => model%mesh%face_nodes(:, 2, cell), &
                 tau => model%mesh%face_tangent(:, cell), &
                 law => model%conditions%law(cell)%contact)
         axes(1, :) = turned_left(tau)
         axes(2, :) = tau
         jump = matmul(axes, displacement(:, minus) - displacement(:, plus))
         difference = law%joint_pressure(jump(:, 3)) &
                      - law%joint_pressure(matmul(jump, line_shapes(x)))
         deviation = difference*axes(1, :)
         traction = matmul(axes, face_traction(model, loads, displacement, cell))
         traction(1) = traction(1) + loads%fluid_pressure(cell)
         if (.not. abs(traction(2)) >= (1.0_rk - slides)*law%friction*abs(traction(1))) return
         if (.not. traction(1) < 0.0_rk) return
         deviation = deviation + difference*traction(2)/traction(1)*tau
      end associate
   end function joint_deviation

   !> The cell whose traction stands for that of a cell near the tip.
   !!
   !! Where the slip is given, the stress concentration that it makes leaves an error of some per
   !! cent of itself in the forces on the first two cells, on any mesh; the traction itself is
   !! smooth there. So these take the value of the third, as far as it is a cell of the same kind
   !! on the same line.
   pure integer(ik) function traction_source(model, frame, cell)
      type(fine_model_t), intent(in) :: model
      type(tip_frame_t), intent(in) :: frame
      integer(ik), intent(in) :: cell  !< fracture cell on the straight piece at the tip
      integer(ik), parameter :: n_disturbed = 2
      integer(ik) :: inward, candidate

      traction_source = cell
      if (.not. has_given_slip(cell)) return
      inward = -nint(frame%upper)  ! cells are stored along the fracture
      do
         if (abs(traction_source - frame%face) >= n_disturbed) exit
         candidate = traction_source + inward
         if (candidate < 1 .or. candidate > model%mesh%fracture%n_cells) exit
         if (model%mesh%fracture%cell_fracture(candidate) /= frame%fracture) exit
         if (.not. has_given_slip(candidate)) exit
         if (norm2(model%mesh%face_tangent(:, candidate) &
                   - model%mesh%face_tangent(:, cell)) > same_direction) exit
         traction_source = candidate
      end do

   contains

      !> Whether the slip of a cell is given, with the opening or without.
      pure logical function has_given_slip(given)
         integer(ik), intent(in) :: given

         has_given_slip = model%conditions%condition(given) == face_jump &
                          .or. (model%conditions%condition(given) == face_contact &
                                .and. model%conditions%law(given)%slip_given)
      end function has_given_slip

   end function traction_source

end module fine_tip_domain
