!> The outlines of regions as polygons, for all shapes of a scene, and the rock at each point.
!!
!! A half-plane and a region bounded by parabolas end outside of the body; a parabola is a polyline
!! of short segments, with an error below 1e-5 of the body's height for a curvature of one over that
!! height.
module scene_region_outline
   use base_kinds, only: ik, rk
   use base_plane, only: left_part, point_distance, polygon_area, triangle_area
   use scene_types, only: domain_t, region_t, scene_t
   implicit none(type, external)
   private

   public :: body_part, is_inside, outline_t, region_outline, rock_places_t, toughness_ahead

   !> Corners of a region, counter-clockwise [m].
   type :: outline_t
      real(rk), allocatable :: corners(:, :)
   end type outline_t

   !> The outlines of the regions of a scene.
   type :: rock_places_t
      type(outline_t), allocatable :: outline(:)  !< (regions) in the order of the scene
   contains
      procedure :: set
      procedure :: region_at
      procedure :: distance
   end type rock_places_t

contains

   !> The corners of a region, counter-clockwise, without successive equal ones.
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

   !> The part of a region in a rectangular body.
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

   !> The region between two parabolas, or between one and a line on the right of the body.
   pure function between_parabolas(region, domain) result(corners)
      type(region_t), intent(in) :: region
      type(domain_t), intent(in) :: domain
      real(rk), allocatable :: corners(:, :)  !< [m]
      integer(ik), parameter :: segments = 256
      real(rk), parameter :: margin = 0.01_rk
      real(rk) :: x(0:segments, 2), y(0:segments), height, width
      integer(ik) :: k

      height = domain%y_max - domain%y_min
      width = domain%x_max - domain%x_min
      y = [(domain%y_min + height*((1.0_rk + 2.0_rk*margin)*real(k, rk)/real(segments, rk) &
                                   - margin), k=0, segments)]
      do k = 1, size(region%x_vertex, kind=ik)
         x(:, k) = region%x_vertex(k) + region%curvature(k)*(y - region%y_vertex(k))**2
      end do
      if (size(region%x_vertex) == 1) x(:, 2) = max(domain%x_max, maxval(x(:, 1))) + width
      corners = joined(x(:, 1), y, x(:, 2), y)
   end function between_parabolas

   !> The corners along one curve and back along another.
   pure function joined(x, y, x_other, y_other) result(corners)
      real(rk), intent(in) :: x(:), y(:), x_other(:), y_other(:)  !< [m]
      real(rk), allocatable :: corners(:, :)
      integer :: n

      n = size(x_other)
      corners = pairs([x, x_other(n:1:-1)], [y, y_other(n:1:-1)])
   end function joined

   !> Points (2, n) from their coordinates.
   pure function pairs(x, y) result(corners)
      real(rk), intent(in) :: x(:), y(:)  !< [m]
      real(rk) :: corners(2, size(x))

      corners(1, :) = x
      corners(2, :) = y
   end function pairs

   !> The corners that differ from the one before.
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

   !> Set the outlines of the regions of a scene.
   pure subroutine set(self, scene)
      class(rock_places_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      integer :: i

      if (allocated(self%outline)) deallocate (self%outline)
      if (.not. allocated(scene%regions)) then
         allocate (self%outline(0))
         return
      end if
      allocate (self%outline(size(scene%regions)))
      do i = 1, size(scene%regions)
         self%outline(i)%corners = region_outline(scene%regions(i), scene%domain)
      end do
   end subroutine set

   !> Index of the region at a point, the last one of several; 0: none, the rock of the scene.
   pure integer(ik) function region_at(self, point)
      class(rock_places_t), intent(in) :: self
      real(rk), intent(in) :: point(2)  !< [m]

      do region_at = size(self%outline, kind=ik), 1, -1
         if (is_inside(self%outline(region_at)%corners, point)) return
      end do
   end function region_at

   !> Distance from a point to the nearest outline of some regions; huge if there is none [m].
   pure real(rk) function distance(self, point, counts)
      class(rock_places_t), intent(in) :: self
      real(rk), intent(in) :: point(2)  !< [m]
      logical, intent(in) :: counts(:)  !< (regions) the outline is included
      integer(ik) :: i, k, n

      distance = huge(1.0_rk)
      do i = 1, size(self%outline, kind=ik)
         if (.not. counts(i)) cycle
         associate (corners => self%outline(i)%corners)
            n = size(corners, 2, kind=ik)
            do k = 1, n
               distance = min(distance, point_distance(point, corners(:, [k, mod(k, n) + 1_ik])))
            end do
         end associate
      end do
   end function distance

   !> K_IC of the rock ahead of a tip [Pa m^1/2]. Before another rock K_IC changes linearly over a
   !! given length, so that there is an equilibrium: a tip that stops at tougher rock is within this
   !! length before it.
   pure real(rk) function toughness_ahead(places, scene, xy, direction, reach) result(toughness)
      type(rock_places_t), intent(in) :: places
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: xy(2)  !< the tip [m]
      real(rk), intent(in) :: direction(2)  !< unit vector ahead [-]
      real(rk), intent(in) :: reach  !< length of the linear change [m]
      integer, parameter :: halvings = 40
      real(rk) :: ahead, high, low, middle
      integer :: k

      toughness = at(0.0_rk)
      ahead = at(1.0_rk)
      if (.not. abs(ahead - toughness) > 0.0_rk) return
      low = 0.0_rk
      high = 1.0_rk
      do k = 1, halvings
         middle = 0.5_rk*(low + high)
         if (abs(at(middle) - toughness) > 0.0_rk) then
            high = middle
         else
            low = middle
         end if
      end do
      toughness = toughness + (ahead - toughness)*(1.0_rk - high)

   contains

      !> Toughness of the rock at a fraction of the reach ahead of the tip [Pa m^1/2].
      pure real(rk) function at(share)
         real(rk), intent(in) :: share  !< [-]
         integer(ik) :: region

         region = places%region_at(xy + share*reach*direction)
         if (region == 0) then
            at = scene%material%toughness
         else
            at = scene%regions(region)%material%toughness
         end if
      end function at

   end function toughness_ahead

   !> A point lies in a polygon, and not on its outline: a ray to the right meets the outline an odd
   !! number of times (Shimrat 1962).
   pure logical function is_inside(outline, point)
      real(rk), intent(in) :: outline(:, :), point(2)  !< [m]
      integer(ik) :: k, n, next

      n = size(outline, 2, kind=ik)
      is_inside = .false.
      do k = 1, n
         next = mod(k, n) + 1_ik
         associate (a => outline(:, k), b => outline(:, next))
            if ((a(2) > point(2)) .eqv. (b(2) > point(2))) cycle
            if ((triangle_area(reshape([a, b, point], [2, 3])) > 0.0_rk) .eqv. b(2) > a(2)) then
               is_inside = .not. is_inside
            end if
         end associate
      end do
   end function is_inside

end module scene_region_outline
