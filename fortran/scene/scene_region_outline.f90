!> The outlines of regions as polygons, whatever the scene gives them by.
!!
!! A half-plane and a region bounded by parabolas end some way outside of the body; a parabola is a
!! polyline of short pieces, off by less than 1e-5 of the body's height for a curvature of one over
!! that height.
module scene_region_outline
   use base_clip, only: left_part
   use base_kinds, only: ik, rk
   use base_plane, only: polygon_area
   use scene_types, only: domain_t, region_t
   implicit none(type, external)
   private

   public :: body_part, region_outline

contains

   !> The corners of a region, counter-clockwise, none of them twice in a row.
   pure function region_outline(region, domain) result(corners)
      type(region_t), intent(in) :: region
      type(domain_t), intent(in) :: domain
      real(rk), allocatable :: corners(:, :)  !< (2, n) [m]
      real(rk) :: line(2, 2)

      select case (region%shape)
      case ("half_plane")
         line = transpose(reshape([region%x, region%y], [2, 2]))
         corners = left_part(box(domain, 1.0_rk), line)
      case ("band")
         corners = joined(region%x, region%y, region%x_other, region%y_other)
      case ("parabola")
         corners = between_parabolas(region, domain)
      case default
         corners = pairs(region%x, region%y)
      end select
      corners = without_repeats(corners)
      if (polygon_area(corners) < 0.0_rk) corners = corners(:, size(corners, 2):1:-1)
   end function region_outline

   !> What of a region lies in the body: a rectangle.
   pure function body_part(region, domain) result(corners)
      type(region_t), intent(in) :: region
      type(domain_t), intent(in) :: domain
      real(rk), allocatable :: corners(:, :)  !< (2, n) [m]
      real(rk) :: sides(2, 4)
      integer(ik) :: k

      corners = region_outline(region, domain)
      sides = box(domain, 0.0_rk)
      do k = 1, 4
         corners = left_part(corners, sides(:, [k, mod(k, 4_ik) + 1_ik]))
      end do
   end function body_part

   !> The body's rectangle, larger by a share of its extent on each side.
   pure function box(domain, margin) result(corners)
      type(domain_t), intent(in) :: domain
      real(rk), intent(in) :: margin  !< [-]
      real(rk) :: corners(2, 4)  !< counter-clockwise [m]
      real(rk) :: x(2), y(2)

      x = [domain%x_min, domain%x_max] + margin*(domain%x_max - domain%x_min)*[-1.0_rk, 1.0_rk]
      y = [domain%y_min, domain%y_max] + margin*(domain%y_max - domain%y_min)*[-1.0_rk, 1.0_rk]
      corners(1, :) = x([1, 2, 2, 1])
      corners(2, :) = y([1, 1, 2, 2])
   end function box

   !> Between two parabolas, or one and a line outside of the body, on its right.
   pure function between_parabolas(region, domain) result(corners)
      type(region_t), intent(in) :: region
      type(domain_t), intent(in) :: domain
      real(rk), allocatable :: corners(:, :)  !< [m]
      integer(ik), parameter :: pieces = 256
      real(rk), parameter :: margin = 0.01_rk
      real(rk) :: x(0:pieces, 2), y(0:pieces), height, width
      integer(ik) :: k

      height = domain%y_max - domain%y_min
      width = domain%x_max - domain%x_min
      y = [(domain%y_min + height*((1.0_rk + 2.0_rk*margin)*real(k, rk)/real(pieces, rk) &
                                   - margin), k=0, pieces)]
      do k = 1, size(region%x_vertex, kind=ik)
         x(:, k) = region%x_vertex(k) + region%curvature(k)*(y - region%y_vertex(k))**2
      end do
      if (size(region%x_vertex) == 1) x(:, 2) = max(domain%x_max, maxval(x(:, 1))) + width
      corners = joined(x(:, 1), y, x(:, 2), y)
   end function between_parabolas

   !> Along one curve and back along another.
   pure function joined(x, y, x_other, y_other) result(corners)
      real(rk), intent(in) :: x(:), y(:), x_other(:), y_other(:)  !< [m]
      real(rk), allocatable :: corners(:, :)
      integer :: n

      n = size(x_other)
      corners = pairs([x, x_other(n:1:-1)], [y, y_other(n:1:-1)])
   end function joined

   pure function pairs(x, y) result(corners)
      real(rk), intent(in) :: x(:), y(:)  !< [m]
      real(rk) :: corners(2, size(x))

      corners(1, :) = x
      corners(2, :) = y
   end function pairs

   !> Corners on the one before are left out, and the last one on the first.
   pure function without_repeats(corners) result(kept)
      real(rk), intent(in) :: corners(:, :)
      real(rk), allocatable :: kept(:, :)
      logical :: differs(size(corners, 2))
      integer :: k, n

      n = size(corners, 2)
      do k = 1, n
         differs(k) = any(abs(corners(:, k) - corners(:, modulo(k - 2, n) + 1)) > 0.0_rk)
      end do
      kept = corners(:, pack([(k, k=1, n)], differs))
   end function without_repeats

end module scene_region_outline
