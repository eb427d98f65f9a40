!> Stress intensity factors by the interaction integral in domain form (Stern, Becker and Dunham
!! 1976; Yau, Wang and Corten 1980; Shih and Asaro 1988), with loaded faces, body force, in-situ
!! stress, and the pore pressure as initial stress.
!!
!! In the tip's axes, with the auxiliary field (hat) of unit intensity, total stress s,
!! displacement u, strain e, outward normal m, and a weight q that is 1 at the tip and 0 at the
!! domain's edge:
!!    P_j = s_ij hat u_i,1 + hat s_ij u_i,1 - hat s_kl e_kl delta_1j
!!    M = int P_j q,j dA + int P_j,j q dA - int_faces P_j m_j q ds = 2 K/E'.
!! Since div s = -b, div hat s = 0 and s = C e + s0 with the initial stress s0 (that in situ less
!! biot p I), P_j,j = s0_kl hat e_kl,1 - b_i hat u_i,1. On straight faces through the tip m_1 = 0
!! and hat s m = 0, so that P_j m_j leaves the actual traction t = s m of both sides:
!!    M = int P_j q,j dA + int (s0_kl hat e_kl,1 - b_i hat u_i,1) q dA
!!        - int_faces t_i hat u_i,1 q ds.
!! A uniform stress adds nothing to these three together; so the in-situ stress at the tip is taken
!! off s, s0 and t, which would otherwise lose digits where it is large.
!!
!! M is linear in what the loads and the solution give. On one mesh its coefficients stay: that of
!! the displacement gradient is
!!    C (hat u,1 (x) q') + (hat s q') (x) e_1 - q,1 hat s,
!! that of the initial stress is the symmetric part of hat u,1 (x) q', and q hat e,1.
module fine_tip_interaction
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use fine_element, only: gauss_rule, line_shapes, tip_rule_size
   use fine_loads, only: fine_loads_t
   use fine_model, only: fine_model_t
   use fine_tip_domain, only: domain_weight, element_rule, face_traction, in_situ_stress, &
                              is_joint, joint_deviation, reference_angle, traction_source
   use fine_tip_field, only: auxiliary_field, auxiliary_field_t, root_of_place
   use fine_tip_types, only: tip_frame_t
   implicit none(type, external)
   private

   public :: interaction_integrals, interactions_t, tip_probe_t

   integer(ik), parameter :: joint_points = 8  !< Gauss points of a cell of a joint

   !> The integrals of both modes on some domains about a tip of one mesh.
   type :: interactions_t
      type(tip_frame_t) :: frame
      integer(ik), allocatable :: node(:)  !< mesh nodes in the largest domain
      !> (2, modes, domains, nodes) coefficients of 2 K/E' [m^1/2] in x and y: of displacements
      !! [m^-1/2],
      real(rk), allocatable :: by_displacement(:, :, :, :)
      !> (xx yy xy, modes, domains, nodes) of the initial stress there, zero at midside nodes,
      real(rk), allocatable :: by_stress(:, :, :, :)
      integer(ik), allocatable :: cell(:)  !< elements in the largest domain
      !> (corners, modes, domains, elements) of a pressure that is linear in each element,
      real(rk), allocatable :: by_heat(:, :, :, :)
      real(rk), allocatable :: by_body_force(:, :, :)  !< (2, modes, domains) of the body force,
      integer(ik), allocatable :: face(:)  !< fracture cells in the largest domain
      !> (2, modes, domains, faces) and of their tractions, in the tip's axes.
      real(rk), allocatable :: by_traction(:, :, :, :)
      integer(ik), allocatable :: joint(:)  !< faces whose traction varies within the cell
      !> (2, modes, domains, points, joints) of their tractions at points, less that of the middle
      real(rk), allocatable :: by_deviation(:, :, :, :, :)
      real(rk), allocatable :: place(:, :)  !< (points, joints) parameter of these points [-]
   contains
      procedure :: by_joints
      procedure :: intensities
      procedure :: extraction_forces
   end type interactions_t

   !> What the intensities of a tip are found by on one mesh, whatever its loads and solution.
   type :: tip_probe_t
      type(tip_frame_t) :: frame
      real(rk) :: radius = 0.0_rk, radius_inner = 0.0_rk  !< of the two domains [m]
      type(interactions_t) :: interactions  !< on these
   end type tip_probe_t

contains

   !> The coefficients of the integrals on the domains of the given radii about a tip.
   pure function interaction_integrals(model, frame, radii, plateau) result(self)
      type(fine_model_t), intent(in) :: model
      type(tip_frame_t), intent(in) :: frame
      !> where q has fallen to 0, at most largest_radius, the largest one first [m]
      real(rk), intent(in) :: radii(:)
      real(rk), intent(in) :: plateau  !< share of the radius within which q = 1 [-]
      type(interactions_t) :: self
      real(rk) :: q(size(radii), model%mesh%n_nodes)
      integer(ik) :: place(model%mesh%n_nodes)  ! among the nodes of the domain
      integer(ik) :: i, r

      do r = 1, size(radii, kind=ik)
         q(r, :) = domain_weight(model%mesh, frame, radii(r), plateau)
      end do
      associate (mesh => model%mesh)
         self%cell = pack([(i, i=1, mesh%n_cells)], &
                          [(any(q(1, mesh%cell_nodes(:, i)) > 0.0_rk), i=1, mesh%n_cells)])
         place = 0
         do i = 1, size(self%cell, kind=ik)
            place(mesh%cell_nodes(:, self%cell(i))) = 1
         end do
         self%frame = frame
         self%node = pack([(i, i=1, mesh%n_nodes)], place > 0)
         place(self%node) = [(i, i=1, size(self%node, kind=ik))]
         self%face = pack([(i, i=1, mesh%fracture%n_cells)], &
                          [(any(q(1, mesh%face_nodes(:, 1, i)) > 0.0_rk), &
                            i=1, mesh%fracture%n_cells)])
         associate (n => size(self%node), n_domains => size(radii))
            allocate (self%by_displacement(2, 2, n_domains, n), source=0.0_rk)
            allocate (self%by_stress(3, 2, n_domains, n), source=0.0_rk)
            allocate (self%by_heat(3, 2, n_domains, size(self%cell)))
            allocate (self%by_body_force(2, 2, n_domains), source=0.0_rk)
            allocate (self%by_traction(2, 2, n_domains, size(self%face)), source=0.0_rk)
         end associate
         do i = 1, size(self%cell, kind=ik)
            call add_cell(self, model, i, q, place)
         end do
      end associate
      self%joint = pack([(i, i=1, size(self%face, kind=ik))], &
                        [(is_joint(model, self%face(i)), i=1, size(self%face))])
      associate (n_joints => size(self%joint))
         allocate (self%by_deviation(2, 2, size(radii), joint_points, n_joints), source=0.0_rk)
         allocate (self%place(joint_points, n_joints), source=0.0_rk)
      end associate
      do i = 1, size(self%face, kind=ik)
         call set_face(self, model, i, q)
      end do
      do i = 1, size(self%joint, kind=ik)
         call weigh_points(self%frame, model, self%face(self%joint(i)), q, self%place(:, i), &
                           self%by_deviation(:, :, :, :, i))
      end do
   end function interaction_integrals

   !> One element's share.
   pure subroutine add_cell(self, model, i, q, place)
      type(interactions_t), intent(inout) :: self
      type(fine_model_t), intent(in) :: model
      integer(ik), intent(in) :: i  !< among the elements of the domain
      real(rk), intent(in) :: q(:, :)  !< (domains, n_nodes) [-]
      integer(ik), intent(in) :: place(:)  !< (n_nodes) among those of the domain
      real(rk) :: points(3, tip_rule_size), weights(tip_rule_size)
      real(rk) :: values(6), gradients(2, 6), area_coordinates(3), determinant
      real(rk) :: by_gradient(2, 2), by_initial(2, 2), outer(2, 2), q_slope(2), q_here
      ! In the tip's axes.
      real(rk), dimension(2, 6, 2, size(q, 1)) :: of_nodes
      real(rk), dimension(2, 2, 3, 2, size(q, 1)) :: of_corners
      real(rk) :: of_body(2, 2, size(q, 1)), q_nodes(6, size(q, 1))
      real(rk) :: xy(2), xy_nodes(2, 6), weight, reference, kolosov, shear_modulus
      complex(rk) :: root_z
      type(auxiliary_field_t) :: field
      integer(ik) :: c, mode, n_points, nodes(6), point, r

      associate (frame => self%frame, cell => self%cell(i))
         nodes = model%mesh%cell_nodes(:, cell)
         xy_nodes = model%mesh%xy(:, nodes)
         q_nodes = transpose(q(:, nodes))
         call element_rule(model%mesh, frame, cell, n_points, points, weights)
         reference = reference_angle(model%mesh, frame, cell, q(1, :))
         kolosov = frame%rock%kolosov()
         shear_modulus = frame%rock%shear_modulus()
         of_nodes = 0.0_rk
         of_corners = 0.0_rk
         of_body = 0.0_rk
         do point = 1, n_points
            call model%mesh%evaluate(cell, points(:, point), values, gradients, &
                                     area_coordinates, determinant)
            weight = weights(point)*determinant
            xy = matmul(frame%axes, matmul(xy_nodes, values) - frame%origin)
            gradients = matmul(frame%axes, gradients)
            root_z = root_of_place(xy, reference)
            do mode = 1, 2
               field = auxiliary_field(mode, root_z, kolosov, shear_modulus)
               do r = 1, size(q, 1, kind=ik)
                  q_slope = matmul(gradients, q_nodes(:, r))
                  q_here = dot_product(values, q_nodes(:, r))
                  outer(:, 1) = field%slope*q_slope(1)
                  outer(:, 2) = field%slope*q_slope(2)
                  by_gradient = frame%rock%total_stress(outer, 0.0_rk) - q_slope(1)*field%stress
                  by_gradient(:, 1) = by_gradient(:, 1) + matmul(field%stress, q_slope)
                  of_nodes(:, :, mode, r) = of_nodes(:, :, mode, r) &
                                            + matmul(weight*by_gradient, gradients)
                  by_initial = weight*(0.5_rk*(outer + transpose(outer)) &
                                       + q_here*field%strain_slope)
                  do c = 1, 3
                     of_corners(:, :, c, mode, r) = of_corners(:, :, c, mode, r) &
                                                    + area_coordinates(c)*by_initial
                  end do
                  of_body(:, mode, r) = of_body(:, mode, r) - weight*q_here*field%slope
               end do
            end do
         end do
         self%by_heat(:, :, :, i) = -frame%rock%biot &
                                    *(of_corners(1, 1, :, :, :) + of_corners(2, 2, :, :, :))
         call turn_back(self, place(nodes), of_nodes, of_corners, of_body)
      end associate
   end subroutine add_cell

   !> Add an element's share, from the tip's axes to x and y.
   pure subroutine turn_back(self, place, of_nodes, of_corners, of_body)
      type(interactions_t), intent(inout) :: self
      integer(ik), intent(in) :: place(6)  !< of its nodes among those of the domain
      real(rk), intent(in) :: of_nodes(:, :, :, :)  !< (2, nodes, modes, domains)
      real(rk), intent(in) :: of_corners(:, :, :, :, :)  !< (2, 2, corners, modes, domains)
      real(rk), intent(in) :: of_body(:, :, :)  !< (2, modes, domains)
      real(rk) :: by_initial(2, 2)
      integer(ik) :: c, mode, r

      associate (frame => self%frame)
         do r = 1, size(of_body, 3, kind=ik)
            do mode = 1, 2
               self%by_body_force(:, mode, r) = self%by_body_force(:, mode, r) &
                                                + matmul(of_body(:, mode, r), frame%axes)
               do c = 1, 6
                  associate (sum => self%by_displacement(:, mode, r, place(c)))
                     sum = sum + matmul(of_nodes(:, c, mode, r), frame%axes)
                  end associate
               end do
               do c = 1, 3
                  by_initial = matmul(transpose(frame%axes), &
                                      matmul(of_corners(:, :, c, mode, r), frame%axes))
                  associate (sum => self%by_stress(:, mode, r, place(c)))
                     sum = sum + [by_initial(1, 1), by_initial(2, 2), 2.0_rk*by_initial(1, 2)]
                  end associate
               end do
            end do
         end do
      end associate
   end subroutine turn_back

   !> One fracture cell's share: its traction on the difference of hat u,1 between the faces.
   pure subroutine set_face(self, model, i, q)
      type(interactions_t), intent(inout) :: self
      type(fine_model_t), intent(in) :: model
      integer(ik), intent(in) :: i  !< among those of the domain
      real(rk), intent(in) :: q(:, :)  !< (domains, n_nodes) [-]
      integer(ik), parameter :: n_points = 5
      real(rk) :: by_point(2, 2, size(q, 1), n_points), x(n_points)
      integer(ik) :: point

      call weigh_points(self%frame, model, self%face(i), q, x, by_point)
      do point = 1, n_points
         self%by_traction(:, :, :, i) = self%by_traction(:, :, :, i) + by_point(:, :, :, point)
      end do
   end subroutine set_face

   !> Coefficients of the tractions at Gauss points of a fracture cell.
   pure subroutine weigh_points(frame, model, cell, q, place, by_point)
      type(tip_frame_t), intent(in) :: frame
      type(fine_model_t), intent(in) :: model
      integer(ik), intent(in) :: cell  !< fracture cell
      real(rk), intent(in) :: q(:, :)  !< (domains, n_nodes) [-]
      real(rk), intent(out) :: place(:)  !< (points) parameter of the shape functions [-]
      real(rk), intent(out) :: by_point(:, :, :, :)  !< (2, modes, domains, points)
      real(rk) :: s(size(place)), weights(size(place)), ends(2, 2), distance, q_here, weight, x
      real(rk) :: kolosov, shear_modulus
      type(auxiliary_field_t) :: above, below
      integer(ik) :: point, mode, r

      call gauss_rule(size(place, kind=ik), s, weights)
      associate (nodes => model%mesh%face_nodes(:, 1, cell), &
                 length => model%mesh%face_length(cell), &
                 tip_end => model%mesh%face_at_tip(cell))
         kolosov = frame%rock%kolosov()
         shear_modulus = frame%rock%shear_modulus()
         ends = model%mesh%xy(:, nodes(1:2))
         do point = 1, size(place, kind=ik)
            x = s(point)
            weight = length*weights(point)
            distance = norm2((1.0_rk - x)*ends(:, 1) + x*ends(:, 2) - frame%origin)
            if (tip_end > 0) then
               ! r = length*t**2 takes the root out of the integrand; x follows t or t**2.
               distance = length*s(point)**2
               weight = 2.0_rk*weight*s(point)
               if (model%mesh%face_tip(cell) == 0) x = x**2
               if (tip_end == 2) x = 1.0_rk - x
            end if
            place(point) = x
            do mode = 1, 2
               above = auxiliary_field(mode, cmplx(0.0_rk, sqrt(distance), rk), kolosov, &
                                       shear_modulus)
               below = auxiliary_field(mode, cmplx(0.0_rk, -sqrt(distance), rk), kolosov, &
                                       shear_modulus)
               ! The traction is that on side +, the lower one where frame%upper > 0.
               do r = 1, size(q, 1, kind=ik)
                  q_here = dot_product(line_shapes(x), q(r, nodes))
                  by_point(:, mode, r, point) = weight*q_here*frame%upper &
                                                *(above%slope - below%slope)
               end do
            end do
         end do
      end associate
   end subroutine weigh_points

   !> Stress intensity factors from each domain.
   pure function intensities(self, model, loads, displacement) result(k)
      class(interactions_t), intent(in) :: self
      type(fine_model_t), intent(in) :: model  !< with the mesh that the integrals are for
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      real(rk), allocatable :: k(:, :)  !< (modes, domains) [Pa m^1/2]
      real(rk) :: initial(3), reference(2, 2), traction(2)
      integer(ik) :: i, mode, r

      allocate (k(2, size(self%by_body_force, 3)))
      associate (frame => self%frame)
         do r = 1, size(k, 2, kind=ik)
            k(:, r) = matmul(loads%body_force, self%by_body_force(:, :, r))
         end do
         do i = 1, size(self%node, kind=ik)
            initial = 0.0_rk
            if (self%node(i) <= model%mesh%n_vertices) then
               initial = loads%initial_stress(:, self%node(i)) &
                         - loads%initial_stress(:, frame%node)
               initial(:2) = initial(:2) - frame%rock%biot*loads%pore_pressure(self%node(i))
            end if
            do r = 1, size(k, 2, kind=ik)
               do mode = 1, 2
                  k(mode, r) = k(mode, r) &
                               + dot_product(self%by_displacement(:, mode, r, i), &
                                             displacement(:, self%node(i))) &
                               + dot_product(self%by_stress(:, mode, r, i), initial)
               end do
            end do
         end do
         if (allocated(loads%heat_pressure)) then
            do i = 1, size(self%cell, kind=ik)
               do r = 1, size(k, 2, kind=ik)
                  k(:, r) = k(:, r) + matmul(loads%heat_pressure(:, self%cell(i)), &
                                             self%by_heat(:, :, r, i))
               end do
            end do
         end if
         reference = in_situ_stress(loads, frame, frame%node)
         do i = 1, size(self%face, kind=ik)
            traction = matmul(frame%axes, &
                              face_traction(model, loads, displacement, &
                                            traction_source(model, frame, self%face(i)))) &
                       - frame%upper*reference(:, 2)
            do r = 1, size(k, 2, kind=ik)
               k(:, r) = k(:, r) + matmul(traction, self%by_traction(:, :, r, i))
            end do
         end do
         k = 0.5_rk*frame%rock%crack_modulus()*k
         if (size(self%joint) > 0) k = k + self%by_joints(model, loads, displacement)
      end associate
   end function intensities

   !> Share of the deviations of tractions from that of the middle of each cell of a joint.
   pure function by_joints(self, model, loads, displacement) result(k)
      class(interactions_t), intent(in) :: self
      type(fine_model_t), intent(in) :: model  !< with the mesh that the integrals are for
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      real(rk), allocatable :: k(:, :)  !< (modes, domains) [Pa m^1/2]
      real(rk) :: deviation(2)
      integer(ik) :: i, point, r

      allocate (k(2, size(self%by_body_force, 3)), source=0.0_rk)
      do i = 1, size(self%joint, kind=ik)
         do point = 1, joint_points
            deviation = matmul(self%frame%axes, &
                               joint_deviation(model, loads, displacement, &
                                               self%face(self%joint(i)), self%place(point, i)))
            do r = 1, size(k, 2, kind=ik)
               k(:, r) = k(:, r) + matmul(deviation, self%by_deviation(:, :, r, point, i))
            end do
         end do
      end do
      k = 0.5_rk*self%frame%rock%crack_modulus()*k
   end function by_joints

   !> dK/du of both modes for the first domain, on faces whose traction is given: the nodal forces
   !! whose work on a displacement is its share in K.
   pure function extraction_forces(self, n_nodes) result(force)
      class(interactions_t), intent(in) :: self
      integer(ik), intent(in) :: n_nodes  !< of the mesh
      real(rk), allocatable :: force(:, :, :)  !< (2, n_nodes, modes) [Pa m^1/2 per m]
      integer(ik) :: mode

      allocate (force(2, n_nodes, 2), source=0.0_rk)
      do mode = 1, 2
         force(:, self%node, mode) = 0.5_rk*self%frame%rock%crack_modulus() &
                                     *self%by_displacement(:, mode, 1, :)
      end do
   end function extraction_forces

end module fine_tip_interaction
