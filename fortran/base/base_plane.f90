!> Geometry of points, vectors and straight segments in the plane.
!!
!! A segment is given by its ends, one in each column. One without length is its point. Lengths
!! may be in any unit, the same for all arguments; results are in that unit or its square.
!!
!! The part of a polygon on one side of a line.
module base_plane
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: barycentric, cross, crosses, left_part, meeting, nearest_place, nearest_share, norm2
   public :: point_distance, polygon_area, triangle_area, turned, turned_left

   !> The intrinsic of gfortran rounds numbers above 1 and below it in different ways: lengths and
   !! normals would depend on the unit of length.
   interface norm2
      module procedure magnitude
   end interface norm2

contains

   !> The length of a vector; the same digits in units that differ by a power of 2.
   pure real(rk) function magnitude(v)
      real(rk), intent(in) :: v(:)  !< [any unit]
      real(rk) :: largest

      magnitude = dot_product(v, v)
      if (magnitude > 1.0e-280_rk .and. magnitude < 1.0e280_rk) then
         magnitude = sqrt(magnitude)
      else
         ! Squares may be out of the range of numbers.
         largest = maxval(abs(v))
         magnitude = largest
         if (largest > 0.0_rk .and. largest <= huge(1.0_rk)) then
            magnitude = scale(sqrt(sum(scale(v, -exponent(largest))**2)), exponent(largest))
         end if
      end if
   end function magnitude

   !> The component of u x v out of the plane: positive if v points to the left of u.
   pure real(rk) function cross(u, v)
      real(rk), intent(in) :: u(2), v(2)  !< [any unit]

      cross = u(1)*v(2) - u(2)*v(1)
   end function cross

   !> A vector turned by a right angle, to its left.
   pure function turned_left(v) result(normal)
      real(rk), intent(in) :: v(2)  !< [any unit]
      real(rk) :: normal(2)

      normal = [-v(2), v(1)]
   end function turned_left

   !> A vector turned by an angle.
   pure function turned(v, angle) result(w)
      real(rk), intent(in) :: v(2)  !< [any unit]
      real(rk), intent(in) :: angle  !< counter-clockwise [rad]
      real(rk) :: w(2)

      w = cos(angle)*v + sin(angle)*turned_left(v)
   end function turned

   !> Where a segment is nearest to a point, as the share of the segment before it: 0 to 1.
   pure real(rk) function nearest_share(point, ends) result(share)
      real(rk), intent(in) :: point(2)  !< [m]
      real(rk), intent(in) :: ends(2, 2)  !< [m]
      real(rk) :: along(2)

      share = 0.0_rk
      along = ends(:, 2) - ends(:, 1)
      if (.not. any(abs(along) > 0.0_rk)) return
      share = dot_product(point - ends(:, 1), along)/dot_product(along, along)
      share = min(1.0_rk, max(0.0_rk, share))
   end function nearest_share

   !> The place on a segment nearest to a point.
   pure function nearest_place(point, ends) result(place)
      real(rk), intent(in) :: point(2)  !< [m]
      real(rk), intent(in) :: ends(2, 2)  !< [m]
      real(rk) :: place(2)

      place = ends(:, 1) + nearest_share(point, ends)*(ends(:, 2) - ends(:, 1))
   end function nearest_place

   !> Distance of a point from a segment [m].
   pure real(rk) function point_distance(point, ends) result(distance)
      real(rk), intent(in) :: point(2)  !< [m]
      real(rk), intent(in) :: ends(2, 2)  !< [m]

      distance = norm2(point - ends(:, 1) - nearest_share(point, ends)*(ends(:, 2) - ends(:, 1)))
   end function point_distance

   !> Where the lines through two segments meet, as shares of both; -1 if they are parallel.
   pure function meeting(first, second) result(share)
      real(rk), intent(in) :: first(2, 2), second(2, 2)  !< ends [m]
      real(rk) :: share(2)
      real(rk) :: along(2), side(2), between(2), determinant

      along = first(:, 2) - first(:, 1)
      side = second(:, 2) - second(:, 1)
      between = second(:, 1) - first(:, 1)
      determinant = cross(along, side)
      share = -1.0_rk
      if (abs(determinant) > 0.0_rk) then
         share = [cross(between, side), cross(between, along)]/determinant
      end if
   end function meeting

   !> Two segments cross or touch; parallel ones never do.
   pure logical function crosses(first, second)
      real(rk), intent(in) :: first(2, 2), second(2, 2)  !< ends [m]
      real(rk) :: share(2)

      share = meeting(first, second)
      crosses = all(share >= 0.0_rk .and. share <= 1.0_rk)
   end function crosses

   !> Barycentric coordinates: the weights, of sum 1, of a triangle's corners that give a point.
   pure function barycentric(corners, point) result(weight)
      real(rk), intent(in) :: corners(2, 3)  !< [m]
      real(rk), intent(in) :: point(2)  !< [m]
      real(rk) :: weight(3)
      real(rk) :: a(2), b(2), p(2)

      a = corners(:, 2) - corners(:, 1)
      b = corners(:, 3) - corners(:, 1)
      p = point - corners(:, 1)
      weight(2:3) = [cross(p, b), cross(a, p)]/cross(a, b)
      weight(1) = 1.0_rk - weight(2) - weight(3)
   end function barycentric

   !> Area of a triangle [m2], positive if its corners run counter-clockwise.
   pure real(rk) function triangle_area(corners) result(area)
      real(rk), intent(in) :: corners(2, 3)  !< [m]

      area = 0.5_rk*cross(corners(:, 2) - corners(:, 1), corners(:, 3) - corners(:, 1))
   end function triangle_area

   !> Area of a polygon [m2], positive if its corners run counter-clockwise. It is the sum of the
   !! areas of the triangles with the first corner, so that nothing is lost far from the origin.
   pure real(rk) function polygon_area(corners) result(area)
      real(rk), intent(in) :: corners(:, :)  !< (2, n) [m]
      integer(ik) :: k

      area = 0.0_rk
      do k = 2, size(corners, 2, kind=ik) - 1
         area = area + triangle_area(corners(:, [1_ik, k, k + 1]))
      end do
   end function polygon_area

   !> What of a polygon lies on the left of the line from one point to another (Sutherland and
   !! Hodgman 1974).
   !!
   !! Its area is right for every simple polygon. Where several parts remain of one, edges along the
   !! line join them, once forth and once back.
   pure function left_part(corners, line) result(part)
      real(rk), intent(in) :: corners(:, :)  !< (2, n) in their order [m]
      real(rk), intent(in) :: line(2, 2)  !< two points, one in each column [m]
      real(rk), allocatable :: part(:, :)  !< (2, m), m = 0 if nothing remains [m]
      real(rk) :: kept(2, 2*size(corners, 2)), here, there
      integer(ik) :: k, m, n, next

      n = size(corners, 2, kind=ik)
      m = 0
      do k = 1, n
         next = mod(k, n) + 1_ik
         here = cross(line(:, 2) - line(:, 1), corners(:, k) - line(:, 1))
         there = cross(line(:, 2) - line(:, 1), corners(:, next) - line(:, 1))
         if (here >= 0.0_rk) then
            m = m + 1
            kept(:, m) = corners(:, k)
         end if
         if ((here > 0.0_rk .and. there < 0.0_rk) .or. (here < 0.0_rk .and. there > 0.0_rk)) then
            m = m + 1
            kept(:, m) = corners(:, k) + here/(here - there)*(corners(:, next) - corners(:, k))
         end if
      end do
      part = kept(:, :m)
   end function left_part

end module base_plane
