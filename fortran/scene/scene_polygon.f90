!> Polygons given by their corners: their area, and whether they hold a point.
module scene_polygon
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: holds_point, signed_area

   real(rk), parameter :: round_off = 1.0e-9_rk  !< in points given on an edge, over the extent

contains

   !> Area, positive if the corners run counter-clockwise [m2].
   pure real(rk) function signed_area(x, y)
      real(rk), intent(in) :: x(:), y(:)  !< [m]
      integer :: n

      n = size(x)
      associate (u => x - x(1), v => y - y(1))
         signed_area = 0.5_rk*sum(u(:n - 1)*v(2:) - u(2:)*v(:n - 1))
      end associate
   end function signed_area

   !> A point lies inside or on the boundary.
   pure logical function holds_point(x, y, point)
      real(rk), intent(in) :: x(:), y(:)  !< corners [m]
      real(rk), intent(in) :: point(2)  !< [m]
      integer(ik) :: n, k, l
      logical :: is_inside

      n = size(x, kind=ik)
      holds_point = .true.
      is_inside = .false.
      do k = 1, n
         if (lies_on(x, y, k, point)) return
         ! A ray to the right meets the outline an odd number of times (Shimrat 1962).
         l = following(k, n)
         if ((y(k) > point(2)) .eqv. (y(l) > point(2))) cycle
         if ((twice_area([x(k), y(k)], [x(l), y(l)], point) > 0.0_rk) .eqv. y(l) > y(k)) then
            is_inside = .not. is_inside
         end if
      end do
      holds_point = is_inside
   end function holds_point

   !> A point lies on an edge, up to rounding.
   pure logical function lies_on(x, y, edge, point)
      real(rk), intent(in) :: x(:), y(:)  !< corners [m]
      integer(ik), intent(in) :: edge
      real(rk), intent(in) :: point(2)  !< [m]
      real(rk) :: start(2), along(2), share
      integer(ik) :: next

      next = following(edge, size(x, kind=ik))
      start = [x(edge), y(edge)]
      along = [x(next), y(next)] - start
      share = dot_product(point - start, along)/dot_product(along, along)
      share = min(1.0_rk, max(0.0_rk, share))
      lies_on = norm2(point - start - share*along) <= round_off*extent(x, y)
   end function lies_on

   !> Positive if a, b, c run counter-clockwise [m2].
   pure real(rk) function twice_area(a, b, c)
      real(rk), intent(in) :: a(2), b(2), c(2)

      twice_area = (b(1) - a(1))*(c(2) - a(2)) - (b(2) - a(2))*(c(1) - a(1))
   end function twice_area

   pure integer(ik) function following(corner, n)
      integer(ik), intent(in) :: corner, n

      following = mod(corner, n) + 1_ik
   end function following

   pure real(rk) function extent(x, y)
      real(rk), intent(in) :: x(:), y(:)

      extent = max(maxval(x) - minval(x), maxval(y) - minval(y))
   end function extent

end module scene_polygon
