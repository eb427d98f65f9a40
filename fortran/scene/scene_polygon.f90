!> Whether a polygon, given by its corners, holds a point.
module scene_polygon
   use base_kinds, only: ik, rk
   use base_plane, only: point_distance, triangle_area
   use base_tolerances, only: same_place
   implicit none(type, external)
   private

   public :: holds_point

contains

   !> A point lies inside or, up to rounding, on the boundary.
   pure logical function holds_point(x, y, point)
      real(rk), intent(in) :: x(:), y(:)  !< corners [m]
      real(rk), intent(in) :: point(2)  !< [m]
      real(rk) :: extent, edge(2, 2)
      integer(ik) :: n, k, next
      logical :: is_inside

      n = size(x, kind=ik)
      extent = max(maxval(x) - minval(x), maxval(y) - minval(y))
      holds_point = .true.
      is_inside = .false.
      do k = 1, n
         next = mod(k, n) + 1_ik
         edge = reshape([x(k), y(k), x(next), y(next)], [2, 2])
         if (point_distance(point, edge) <= same_place*extent) return
         ! A ray to the right meets the outline an odd number of times (Shimrat 1962).
         if ((edge(2, 1) > point(2)) .eqv. (edge(2, 2) > point(2))) cycle
         if ((triangle_area(reshape([edge(:, 1), edge(:, 2), point], [2, 3])) > 0.0_rk) .eqv. &
             edge(2, 2) > edge(2, 1)) is_inside = .not. is_inside
      end do
      holds_point = is_inside
   end function holds_point

end module scene_polygon
