!> The outer boundary of the body as a closed polygon.
module scene_outline
   use base_kinds, only: ik, pi, rk
   use base_plane, only: norm2, polygon_area
   use scene_sides, only: boundary_side_t
   use scene_types, only: boundary_part_t, domain_t, scene_t
   implicit none(type, external)
   private

   public :: outline_of_scene, outline_t, scene_corner, scene_edge, sides_of_scene

   !> Counter-clockwise polygon.
   type :: outline_t
      real(rk), allocatable :: corners(:, :)  !< (2, n) [m]
      !> (n) side from each corner to the next, as sides_of_scene numbers them
      integer(ik), allocatable :: edge_side(:)
      real(rk), allocatable :: fixed_points(:, :)  !< (2, n_points) points that must be nodes [m]
   end type outline_t

contains

   !> The scene's body, with its restraints and point loads as fixed points.
   pure function outline_of_scene(scene) result(outline)
      type(scene_t), intent(in) :: scene
      type(outline_t) :: outline

      if (scene%has_points()) then
         outline%fixed_points = transpose(reshape([scene%restraints%x, scene%point_loads%x, &
                                                   scene%restraints%y, scene%point_loads%y], &
                                                  [size(scene%restraints) &
                                                   + size(scene%point_loads), 2]))
      else
         allocate (outline%fixed_points(2, 0))
      end if
      associate (d => scene%domain)
         select case (d%shape)
         case ("disc")
            outline%corners = circle(scene, outline%fixed_points)
            outline%edge_side = rim_sides(scene, outline%corners)
         case ("polygon")
            outline%corners = corners_of(d)
            outline%edge_side = polygon_sides(scene)
            if (runs_clockwise(d)) then  ! edge k ends where k + 1 began
               outline%corners = outline%corners(:, size(d%x):1:-1)
               outline%edge_side = cshift(outline%edge_side(size(d%x):1:-1), 1)
            end if
         case default
            outline%corners = reshape([d%x_min, d%y_min, d%x_max, d%y_min, d%x_max, d%y_max, &
                                       d%x_min, d%y_max], [2, 4])
            outline%edge_side = [3_ik, 2_ik, 4_ik, 1_ik]
         end select
      end associate
   end function outline_of_scene

   !> The outline of this body has its corners in the reverse order.
   pure logical function runs_clockwise(domain)
      type(domain_t), intent(in) :: domain

      runs_clockwise = domain%shape == "polygon"
      if (runs_clockwise) runs_clockwise = polygon_area(corners_of(domain)) < 0.0_rk
   end function runs_clockwise

   !> Corners of a polygon, as the scene gives them (2, n) [m].
   pure function corners_of(domain) result(corners)
      type(domain_t), intent(in) :: domain
      real(rk) :: corners(2, size(domain%x))

      corners(1, :) = domain%x
      corners(2, :) = domain%y
   end function corners_of

   !> Number in the scene of a corner of its polygon's outline.
   pure integer(ik) function scene_corner(domain, corner)
      type(domain_t), intent(in) :: domain
      integer(ik), intent(in) :: corner

      scene_corner = corner
      if (runs_clockwise(domain)) scene_corner = size(domain%x, kind=ik) + 1_ik - corner
   end function scene_corner

   !> Number in the scene of an edge of its polygon's outline.
   pure integer(ik) function scene_edge(domain, edge)
      type(domain_t), intent(in) :: domain
      integer(ik), intent(in) :: edge
      integer(ik) :: n

      scene_edge = edge
      n = size(domain%x, kind=ik)
      if (runs_clockwise(domain)) scene_edge = modulo(n - edge - 1_ik, n) + 1_ik
   end function scene_edge

   !> Conditions on each side of the body, by its number; the last side of a polygon or disc is the
   !! rest of the boundary, free of traction.
   pure function sides_of_scene(scene) result(sides)
      type(scene_t), intent(in) :: scene
      type(boundary_side_t), allocatable :: sides(:)
      integer :: i, n

      if (scene%domain%shape == "rectangle") then
         sides = scene%sides
         return
      end if
      n = scene%n_parts()
      allocate (sides(n + 1))
      do i = 1, n
         sides(i) = scene%parts(i)%boundary_side_t
      end do
   end function sides_of_scene

   !> Sides of a polygon's edges, in the scene's order.
   pure function polygon_sides(scene) result(edge_side)
      type(scene_t), intent(in) :: scene
      integer(ik), allocatable :: edge_side(:)
      integer(ik) :: i

      allocate (edge_side(size(scene%domain%x)), source=int(scene%n_parts() + 1, ik))
      do i = 1, scene%n_parts()
         edge_side(scene%parts(i)%edges) = i
      end do
   end function polygon_sides

   !> Sides of the edges between points on a circle.
   pure function rim_sides(scene, corners) result(edge_side)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: corners(:, :)  !< (2, n) [m]
      integer(ik), allocatable :: edge_side(:)
      real(rk) :: arm(2), angle
      integer(ik) :: i, k, n

      n = size(corners, 2, kind=ik)
      allocate (edge_side(n), source=int(scene%n_parts() + 1, ik))
      do k = 1, n
         arm = 0.5_rk*(corners(:, k) + corners(:, mod(k, n) + 1)) &
               - [scene%domain%x_centre, scene%domain%y_centre]
         angle = atan2(arm(2), arm(1))
         do i = 1, scene%n_parts()
            if (holds_angle(scene%parts(i), angle)) edge_side(k) = i
         end do
      end do
   end function rim_sides

   !> A part of a disc's rim contains an angle.
   pure logical function holds_angle(part, angle)
      type(boundary_part_t), intent(in) :: part
      real(rk), intent(in) :: angle  !< [rad]

      holds_angle = part%whole_rim .or. &
                    modulo(angle - part%arc(1), 2.0_rk*pi) < part%arc(2) - part%arc(1)
   end function holds_angle

   !> Points on the circle of a disc: fixed ones (fixed_angles), and equally spaced ones, without
   !! those next to a fixed one.
   !!
   !! A polygon of n corners on the circle lacks 2/3 (pi/n)**2 of its area: 1e-4 with 256, 2e-6 with
   !! 2000. More would be of no use, and each edge is compared with every other one.
   pure function circle(scene, given) result(corners)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: given(:, :)  !< (2, n) points, some of which lie on the circle [m]
      real(rk), allocatable :: corners(:, :)  !< (2, n_corners) [m]
      real(rk), parameter :: fewest = 256.0_rk, most = 2000.0_rk
      real(rk), allocatable :: angle(:), fixed(:)
      real(rk) :: candidate, spacing
      integer :: i, n

      associate (d => scene%domain, size_boundary => scene%discretization%size_boundary)
         fixed = fixed_angles(scene, given)
         n = ceiling(min(most, max(fewest, 2.0_rk*pi*d%radius/size_boundary)))
         spacing = 2.0_rk*pi/n
         angle = fixed
         do i = 0, n - 1
            candidate = i*spacing
            if (any(abs(turned(fixed - candidate)) < 0.6_rk*spacing)) cycle
            angle = [angle, candidate]
         end do
         call sort(angle)
         allocate (corners(2, size(angle)))
         corners(1, :) = d%x_centre + d%radius*cos(angle)
         corners(2, :) = d%y_centre + d%radius*sin(angle)
      end associate
   end function circle

   !> Angles of the given points, vertices of fractures and ends of arcs that lie on the circle,
   !! each of them once [rad].
   pure function fixed_angles(scene, given) result(angles)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: given(:, :)  !< (2, n) [m]
      real(rk), allocatable :: angles(:)
      integer :: i, k

      allocate (angles(0))
      do i = 1, size(given, 2)
         call add_angle(scene%domain, given(:, i), angles)
      end do
      do i = 1, size(scene%fractures)
         associate (fracture => scene%fractures(i))
            do k = 1, size(fracture%x)
               call add_angle(scene%domain, [fracture%x(k), fracture%y(k)], angles)
            end do
         end associate
      end do
      do i = 1, scene%n_parts()
         if (scene%parts(i)%whole_rim) cycle
         do k = 1, 2
            associate (d => scene%domain, place => scene%parts(i)%arc(k))
               call add_angle(d, [d%x_centre + d%radius*cos(place), &
                                  d%y_centre + d%radius*sin(place)], angles)
            end associate
         end do
      end do
   end function fixed_angles

   !> Add the angle of a point if it lies on the circle and is not among the angles so far.
   pure subroutine add_angle(domain, xy, angles)
      type(domain_t), intent(in) :: domain  !< a disc
      real(rk), intent(in) :: xy(2)  !< [m]
      real(rk), allocatable, intent(inout) :: angles(:)  !< [rad]
      real(rk), parameter :: on_circle = 1.0e-6_rk  ! distance over the radius
      real(rk) :: arm(2), angle

      arm = xy - [domain%x_centre, domain%y_centre]
      if (abs(norm2(arm)/domain%radius - 1.0_rk) > on_circle) return
      angle = modulo(atan2(arm(2), arm(1)), 2.0_rk*pi)
      if (.not. any(abs(turned(angles - angle)) < on_circle)) angles = [angles, angle]
   end subroutine add_angle

   !> The same angle between -pi and pi [rad].
   elemental real(rk) function turned(angle)
      real(rk), intent(in) :: angle  !< [rad]

      turned = modulo(angle + pi, 2.0_rk*pi) - pi
   end function turned

   !> Sort into ascending order, by insertion: nearly all values are in order.
   pure subroutine sort(values)
      real(rk), intent(inout) :: values(:)  !< angles [rad]
      real(rk) :: value
      integer :: i, k

      do i = 2, size(values)
         value = values(i)
         k = i - 1
         do while (k >= 1)
            if (values(k) <= value) exit
            values(k + 1) = values(k)
            k = k - 1
         end do
         values(k + 1) = value
      end do
   end subroutine sort

end module scene_outline
