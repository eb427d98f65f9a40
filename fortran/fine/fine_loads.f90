!> Loads of the fine problem and their nodal forces.
!!
!! The stress of the rock before displacement, linear in y, as loads of the fine problem.
module fine_loads
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_plane, only: triangle_area
   use fine_elasticity, only: rocks_t
   use fine_element, only: collapsed_rule, line_resultants
   use fine_mesh, only: fine_mesh_t
   implicit none(type, external)
   private

   public :: add_face_forces, add_in_situ_tractions, add_volume_forces, check_loads, fine_loads_t
   public :: no_loads, set_in_situ_stress, volume_forces

   !> Values that may change from one solution to the next.
   type :: fine_loads_t
      real(rk), allocatable :: boundary_displacement(:, :)  !< (2, n_nodes) [m]; where prescribed
      real(rk), allocatable :: force(:, :)  !< (2, n_nodes) [N/m]
      real(rk) :: body_force(2) = 0.0_rk  !< uniform [N/m3]
      real(rk), allocatable :: initial_stress(:, :)  !< (xx yy xy, n_vertices) in situ [Pa]
      real(rk), allocatable :: pore_pressure(:)  !< (n_vertices) in the matrix [Pa]
      !> (corners, n_cells) pressures with the stress of the temperatures [Pa], or temperatures
      !! (fine_elasticity) [K], linear in each element; unallocated: no thermal stress
      real(rk), allocatable :: heat_pressure(:, :)
      real(rk), allocatable :: traction(:, :)  !< (2, fracture cells) contact f_tau, f_n [Pa]
      real(rk), allocatable :: fluid_pressure(:)  !< (fracture cells) [Pa]
      real(rk), allocatable :: jump(:, :, :)  !< (tau n, start end mid, fracture cell) [m]
   end type fine_loads_t

contains

   !> All loads, of the right size and zero.
   pure function no_loads(fine) result(loads)
      type(fine_mesh_t), intent(in) :: fine
      type(fine_loads_t) :: loads

      associate (n => fine%fracture%n_cells)
         allocate (loads%boundary_displacement(2, fine%n_nodes), source=0.0_rk)
         allocate (loads%force(2, fine%n_nodes), source=0.0_rk)
         allocate (loads%initial_stress(3, fine%n_vertices), source=0.0_rk)
         allocate (loads%pore_pressure(fine%n_vertices), source=0.0_rk)
         allocate (loads%traction(2, n), loads%jump(2, 3, n), source=0.0_rk)
         allocate (loads%fluid_pressure(n), source=0.0_rk)
      end associate
   end function no_loads

   !> Refuse loads of the wrong size and values that are not finite.
   pure subroutine check_loads(fine, loads, error)
      type(fine_mesh_t), intent(in) :: fine
      type(fine_loads_t), intent(in) :: loads
      type(error_t), allocatable, intent(out) :: error
      character(len=*), parameter :: origin = "check_loads"

      if (.not. (allocated(loads%boundary_displacement) .and. allocated(loads%force) &
                 .and. allocated(loads%initial_stress) .and. allocated(loads%pore_pressure) &
                 .and. allocated(loads%traction) .and. allocated(loads%fluid_pressure) &
                 .and. allocated(loads%jump))) then
         call raise_error(error, origin, "the loads are incomplete; start from no_loads(mesh)")
      else if (any(shape(loads%boundary_displacement) /= [2_ik, fine%n_nodes]) &
               .or. any(shape(loads%force) /= [2_ik, fine%n_nodes]) &
               .or. any(shape(loads%initial_stress) /= [3_ik, fine%n_vertices]) &
               .or. size(loads%pore_pressure) /= fine%n_vertices &
               .or. any(shape(loads%traction) /= [2_ik, fine%fracture%n_cells]) &
               .or. size(loads%fluid_pressure) /= fine%fracture%n_cells &
               .or. any(shape(loads%jump) /= [2_ik, 3_ik, fine%fracture%n_cells])) then
         call raise_error(error, origin, "the loads do not belong to this mesh: wrong array sizes")
      else if (.not. sum(abs(loads%boundary_displacement)) &
               + sum(abs(loads%jump)) <= huge(1.0_rk)) then
         call raise_error(error, origin, "a given displacement is not a finite number")
      else if (.not. sum(abs(loads%pore_pressure)) + sum(abs(loads%fluid_pressure)) &
               + sum(abs(loads%traction)) <= huge(1.0_rk)) then
         call raise_error(error, origin, "a pressure or traction is not a finite number")
      else if (.not. sum(abs(loads%force)) + sum(abs(loads%body_force)) &
               + sum(abs(loads%initial_stress)) <= huge(1.0_rk)) then
         call raise_error(error, origin, "a force or initial stress is not a finite number")
      end if
   end subroutine check_loads

   !> Contact traction and fluid pressure on both faces: f - p n acts on side +, its opposite on
   !! side -.
   pure subroutine add_face_forces(fine, traction, fluid_pressure, force)
      type(fine_mesh_t), intent(in) :: fine
      real(rk), intent(in) :: traction(:, :)  !< (2, fracture cells) f_tau, f_n [Pa]
      real(rk), intent(in) :: fluid_pressure(:)  !< (fracture cells) [Pa]
      real(rk), intent(inout) :: force(:, :)  !< (2, n_nodes) [N/m]
      real(rk) :: share(3), resultant(2), tau(2), normal_part
      integer(ik) :: cell, k

      do cell = 1, fine%fracture%n_cells
         tau = fine%face_tangent(:, cell)
         normal_part = traction(2, cell) - fluid_pressure(cell)
         resultant = fine%face_length(cell)*(traction(1, cell)*tau + normal_part*[-tau(2), tau(1)])
         share = line_resultants(fine%face_tip(cell))
         do k = 1, 3
            associate (plus => fine%face_nodes(k, 1, cell), minus => fine%face_nodes(k, 2, cell))
               force(:, plus) = force(:, plus) + share(k)*resultant
               force(:, minus) = force(:, minus) - share(k)*resultant
            end associate
         end do
      end do
   end subroutine add_face_forces

   !> Forces of pore pressure, initial stress and body force on all nodes.
   pure subroutine add_volume_forces(fine, rocks, loads, force)
      type(fine_mesh_t), intent(in) :: fine
      type(rocks_t), intent(in) :: rocks
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(inout) :: force(:, :)  !< (2, n_nodes) [N/m]
      real(rk) :: share(2, 6)
      integer(ik) :: cell, k, node
      logical :: is_everywhere, is_loaded

      is_everywhere = allocated(loads%heat_pressure) .or. any(abs(loads%body_force) > 0.0_rk)
      do cell = 1, fine%n_cells
         is_loaded = is_everywhere
         do k = 1, 3
            node = fine%cell_nodes(k, cell)
            if (is_loaded) exit
            is_loaded = abs(loads%pore_pressure(node)) > 0.0_rk &
                        .or. abs(loads%initial_stress(1, node)) > 0.0_rk &
                        .or. abs(loads%initial_stress(2, node)) > 0.0_rk &
                        .or. abs(loads%initial_stress(3, node)) > 0.0_rk
         end do
         if (.not. is_loaded) cycle
         share = volume_forces(fine, cell, rocks%elasticity(rocks%index_of(cell))%biot, loads)
         do k = 1, 6
            node = fine%cell_nodes(k, cell)
            force(1, node) = force(1, node) + share(1, k)
            force(2, node) = force(2, node) + share(2, k)
         end do
      end do
   end subroutine add_volume_forces

   !> Forces of one element's volume: the initial stress s0, of which pore pressure is the part
   !! -biot*p, linear in space, gives the integrals of -s0 grad N, so that no pressure gradient is
   !! formed; the body force b gives those of N b. Both are exact.
   pure function volume_forces(fine, cell, biot, loads) result(force)
      type(fine_mesh_t), intent(in) :: fine
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: biot  !< [-]
      type(fine_loads_t), intent(in) :: loads
      real(rk) :: force(2, 6)  !< [N/m]
      real(rk) :: corner(3, 3), xy(2, 3)
      integer(ik) :: k, node

      do k = 1, 3
         node = fine%cell_nodes(k, cell)
         xy(:, k) = fine%xy(:, node)
         corner(:, k) = loads%initial_stress(:, node)
         corner(1:2, k) = corner(1:2, k) - biot*loads%pore_pressure(node)
         if (allocated(loads%heat_pressure)) corner(1:2, k) = corner(1:2, k) &
         & - biot*loads%heat_pressure(k, cell)
      end do
      if (fine%tip_corner(cell) > 0) then
         force = forces_at_tip(fine, cell, corner, loads%body_force)
      else
         force = forces_of_ordinary(xy, corner, loads%body_force)
      end if
   end function volume_forces

   !> The same of an element with its middle nodes in the middle, in closed form. With area
   !! coordinates L and area A, the integrals of L_c grad N are A/3 grad L_k at its corner k = c and
   !! 0 at other corners, A/3 ((1 + d_ca) grad L_b + (1 + d_cb) grad L_a) between a and b.
   pure function forces_of_ordinary(xy, stress, body_force) result(force)
      real(rk), intent(in) :: xy(2, 3)  !< corners [m]
      real(rk), intent(in) :: stress(3, 3)  !< (xx yy xy, corners) [Pa]
      real(rk), intent(in) :: body_force(2)  !< [N/m3]
      real(rk) :: force(2, 6)  !< [N/m]
      real(rk) :: slope(2, 3)  ! 2 A grad L
      real(rk) :: all(3), of_body(2)
      integer(ik) :: a, b, c

      do a = 1, 3
         b = mod(a, 3_ik) + 1
         c = mod(b, 3_ik) + 1
         slope(1, a) = xy(2, b) - xy(2, c)
         slope(2, a) = xy(1, c) - xy(1, b)
      end do
      all = stress(:, 1) + stress(:, 2) + stress(:, 3)
      of_body = triangle_area(xy)/3.0_rk*body_force
      do a = 1, 3
         b = mod(a, 3_ik) + 1
         force(:, a) = -traction(stress(:, a), slope(:, a))/6.0_rk
         force(:, 3 + a) = -(traction(all + stress(:, a), slope(:, b)) &
                             + traction(all + stress(:, b), slope(:, a)))/6.0_rk + of_body
      end do
   end function forces_of_ordinary

   !> A stress times a vector.
   pure function traction(stress, vector)
      real(rk), intent(in) :: stress(3)  !< xx yy xy
      real(rk), intent(in) :: vector(2)
      real(rk) :: traction(2)

      traction(1) = stress(1)*vector(1) + stress(3)*vector(2)
      traction(2) = stress(3)*vector(1) + stress(2)*vector(2)
   end function traction

   !> The same of an element at a tip, by a rule that is exact there.
   pure function forces_at_tip(fine, cell, corner, body_force) result(force)
      type(fine_mesh_t), intent(in) :: fine
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: corner(3, 3)  !< stress (xx yy xy, corners) [Pa]
      real(rk), intent(in) :: body_force(2)  !< [N/m3]
      real(rk) :: force(2, 6)  !< [N/m]
      integer(ik), parameter :: n = 3  ! points in each direction
      real(rk) :: points(3, n*n), weights(n*n), stress(3), body(2)
      real(rk) :: values(6), gradients(2, 6), area_coordinates(3), determinant, weight
      integer(ik) :: k, point

      call collapsed_rule(fine%tip_corner(cell), n, n, points, weights)
      force = 0.0_rk
      do point = 1, n*n
         call fine%evaluate(cell, points(:, point), values, gradients, area_coordinates, &
                            determinant)
         weight = weights(point)*determinant
         stress = weight*matmul(corner, area_coordinates)
         body = weight*body_force
         do k = 1, 6
            force(1, k) = force(1, k) + body(1)*values(k) &
                          - stress(1)*gradients(1, k) - stress(3)*gradients(2, k)
            force(2, k) = force(2, k) + body(2)*values(k) &
                          - stress(3)*gradients(1, k) - stress(2)*gradients(2, k)
         end do
      end do
   end function forces_at_tip

   !> The stress in situ at the vertices.
   pure subroutine set_in_situ_stress(fine, stress, per_y, y_datum, loads)
      type(fine_mesh_t), intent(in) :: fine
      real(rk), intent(in) :: stress(3)  !< xx, yy, xy at the datum [Pa]
      real(rk), intent(in) :: per_y(2)  !< xx, yy: rise per metre upwards [Pa/m]
      real(rk), intent(in) :: y_datum  !< [m]
      type(fine_loads_t), intent(inout) :: loads
      integer(ik) :: node

      loads%initial_stress = spread(stress, 2, fine%n_vertices)
      do node = 1, fine%n_vertices
         loads%initial_stress(1:2, node) = loads%initial_stress(1:2, node) &
                                           + per_y*(fine%xy(2, node) - y_datum)
      end do
   end subroutine set_in_situ_stress

   !> The tractions on the outer boundary that hold the stress in situ in equilibrium. It is linear
   !! in y, and so are these along each face: their integrals with the shape functions give each
   !! end 1/6 of its own traction and the middle 1/3 of both.
   pure subroutine add_in_situ_tractions(fine, loads)
      type(fine_mesh_t), intent(in) :: fine
      type(fine_loads_t), intent(inout) :: loads
      real(rk) :: chord(2), share(2, 2)
      integer(ik) :: face, k, nodes(2)

      do face = 1, size(fine%boundary_sides, kind=ik)
         nodes = fine%boundary_faces(:, face)
         ! The body is on the left: the outward normal times the length is the chord turned right.
         chord = fine%xy(:, nodes(2)) - fine%xy(:, nodes(1))
         do k = 1, 2
            associate (stress => loads%initial_stress(:, nodes(k)))
               share(:, k) = [stress(1)*chord(2) - stress(3)*chord(1), &
                              stress(3)*chord(2) - stress(2)*chord(1)]/6.0_rk
            end associate
            loads%force(:, nodes(k)) = loads%force(:, nodes(k)) + share(:, k)
         end do
         associate (middle => fine%boundary_middles(face))
            loads%force(:, middle) = loads%force(:, middle) + 2.0_rk*sum(share, dim=2)
         end associate
      end do
   end subroutine add_in_situ_tractions

end module fine_loads
