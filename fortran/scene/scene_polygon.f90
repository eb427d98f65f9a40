!> Polygons given by their corners: whether they bound a body, and where points and segments lie.
module scene_polygon
   use base_kinds, only: ik, rk
   use base_number, only: integer_text
   implicit none(type, external)
   private

   public :: holds_point, leaves, lies_on, polygon_fault, signed_area

   real(rk), parameter :: round_off = 1.0e-9_rk  !< in points given on an edge, over the extent
   real(rk), parameter :: degree = acos(-1.0_rk)/180.0_rk  !< [rad]
   !> As sharp as a corner may be: the mesh library refuses sharper ones [rad].
   real(rk), parameter :: sharpest = 3.0_rk*degree

contains

   !> Why corners do not bound a body; empty: they do.
   pure function polygon_fault(x, y) result(reason)
      real(rk), intent(in) :: x(:), y(:)  !< [m]
      character(len=:), allocatable :: reason
      integer(ik) :: n, k, l

      reason = ""
      n = size(x, kind=ik)
      do k = 1, n
         do l = k + 1, n
            if (hypot(x(k) - x(l), y(k) - y(l)) > round_off*extent(x, y)) cycle
            reason = "give the corners "//integer_text(k)//" and "//integer_text(l)// &
                     " at the same place but must give every corner once"
            return
         end do
      end do
      do k = 1, n
         l = following(k, n)
         if (angle_at(x, y, l) >= sharpest) cycle
         reason = "turn back at corner "//integer_text(l)//", with less than 3 degrees between "// &
                  "its edges, but the edges must enclose an area"
         return
      end do
      do k = 1, n
         do l = k + 2, n
            if (k == 1 .and. l == n) cycle  ! neighbours
            if (.not. edges_meet(x, y, k, l)) cycle
            reason = "give the edges "//integer_text(k)//" and "//integer_text(l)//", which "// &
                     "meet, but edges may meet only at a corner that they share (edge k runs "// &
                     "from corner k to the next one)"
            return
         end do
      end do
   end function polygon_fault

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

   !> A segment between two points of the body leaves it in between, across a re-entrant corner or
   !! a notch: the pieces between its meetings with edges have their middles inside or not.
   pure logical function leaves(x, y, a, b)
      real(rk), intent(in) :: x(:), y(:)  !< corners [m]
      real(rk), intent(in) :: a(2), b(2)  !< [m]
      real(rk), allocatable :: cuts(:)
      real(rk) :: start(2), side(2), along(2), determinant, share(2), cut, next_cut
      integer(ik) :: n, k, l

      n = size(x, kind=ik)
      along = b - a
      allocate (cuts(0))
      do k = 1, n
         l = following(k, n)
         start = [x(k), y(k)]
         side = [x(l), y(l)] - start
         determinant = along(1)*side(2) - along(2)*side(1)
         if (abs(determinant) <= round_off*norm2(along)*norm2(side)) cycle  ! parallel
         share(1) = ((start(1) - a(1))*side(2) - (start(2) - a(2))*side(1))/determinant
         share(2) = ((start(1) - a(1))*along(2) - (start(2) - a(2))*along(1))/determinant
         if (all(share > -round_off .and. share < 1.0_rk + round_off)) cuts = [cuts, share(1)]
      end do
      leaves = .false.
      cut = 0.0_rk
      do
         next_cut = minval([1.0_rk, pack(cuts, cuts > cut + round_off)])
         if (.not. holds_point(x, y, a + 0.5_rk*(cut + next_cut)*along)) leaves = .true.
         if (leaves .or. next_cut >= 1.0_rk) return
         cut = next_cut
      end do
   end function leaves

   !> Two edges that share no corner touch or cross.
   pure logical function edges_meet(x, y, k, l)
      real(rk), intent(in) :: x(:), y(:)
      integer(ik), intent(in) :: k, l
      real(rk) :: a(2), b(2), c(2), d(2)
      integer(ik) :: n

      n = size(x, kind=ik)
      a = [x(k), y(k)]
      b = [x(k + 1), y(k + 1)]  ! k is never the last edge
      c = [x(l), y(l)]
      d = [x(following(l, n)), y(following(l, n))]
      edges_meet = ((twice_area(a, b, c) > 0.0_rk) .neqv. (twice_area(a, b, d) > 0.0_rk)) .and. &
                   ((twice_area(c, d, a) > 0.0_rk) .neqv. (twice_area(c, d, b) > 0.0_rk))
      edges_meet = edges_meet .or. lies_on(x, y, k, c) .or. lies_on(x, y, k, d) .or. &
                   lies_on(x, y, l, a) .or. lies_on(x, y, l, b)
   end function edges_meet

   !> Angle between the two edges at a corner, 0 to pi [rad].
   pure real(rk) function angle_at(x, y, corner)
      real(rk), intent(in) :: x(:), y(:)
      integer(ik), intent(in) :: corner
      real(rk) :: back(2), ahead(2)
      integer(ik) :: n, before, after

      n = size(x, kind=ik)
      before = corner - 1_ik
      if (before == 0) before = n
      after = following(corner, n)
      back = [x(before), y(before)] - [x(corner), y(corner)]
      ahead = [x(after), y(after)] - [x(corner), y(corner)]
      angle_at = atan2(abs(back(1)*ahead(2) - back(2)*ahead(1)), dot_product(back, ahead))
   end function angle_at

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
