!> The outer boundary of the body as a closed polygon.
module mechanics_outline
   use base_kinds, only: ik, rk
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: outline_of_scene, outline_t

   !> Counter-clockwise polygon.
   type :: outline_t
      real(rk), allocatable :: corners(:, :)  !< (2, n) [m]
      integer(ik), allocatable :: edge_side(:)  !< (n) side from each corner to the next
      real(rk), allocatable :: fixed_points(:, :)  !< (2, n) places that must be nodes [m]
   end type outline_t

contains

   !> The scene's body, with its restraints and point loads as fixed points.
   pure function outline_of_scene(scene) result(outline)
      type(scene_t), intent(in) :: scene
      type(outline_t) :: outline
      integer :: n

      n = size(scene%restraints)
      allocate (outline%fixed_points(2, n + size(scene%point_loads)))
      outline%fixed_points(1, :) = [scene%restraints%x, scene%point_loads%x]
      outline%fixed_points(2, :) = [scene%restraints%y, scene%point_loads%y]
      associate (d => scene%domain)
         if (d%shape == "disc") then
            outline%corners = circle(scene, outline%fixed_points)
            allocate (outline%edge_side(size(outline%corners, 2)), source=1_ik)
         else
            outline%corners = reshape([d%x_min, d%y_min, d%x_max, d%y_min, d%x_max, d%y_max, &
                                       d%x_min, d%y_max], [2, 4])
            outline%edge_side = [3_ik, 2_ik, 4_ik, 1_ik]
         end if
      end associate
   end function outline_of_scene

   !> Points on a circle: equally spaced ones, of which those next to a given point or to the end
   !! of a fracture on the circle give way to it.
   !!
   !! A polygon of n corners on the circle lacks 2/3 (pi/n)**2 of its area: 1e-4 with 256.
   pure function circle(scene, given) result(corners)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: given(:, :)  !< (2, n) of which some lie on the circle [m]
      real(rk), allocatable :: corners(:, :)
      real(rk), parameter :: pi = acos(-1.0_rk)
      real(rk), parameter :: on_circle = 1.0e-6_rk  ! distance over the radius
      integer, parameter :: fewest = 256
      real(rk), allocatable :: angle(:), fixed(:)
      real(rk) :: spacing, candidate
      integer :: i, k, n

      associate (d => scene%domain, size_boundary => scene%discretization%size_boundary)
         allocate (fixed(0))
         do i = 1, size(given, 2)
            call keep(given(:, i), fixed)
         end do
         do i = 1, size(scene%fractures)
            do k = 1, size(scene%fractures(i)%x)
               call keep([scene%fractures(i)%x(k), scene%fractures(i)%y(k)], fixed)
            end do
         end do
         n = max(fewest, ceiling(2.0_rk*pi*d%radius/size_boundary))
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

   contains

      !> Keep the angle of a point on the circle, once.
      pure subroutine keep(xy, fixed)
         real(rk), intent(in) :: xy(2)  !< [m]
         real(rk), allocatable, intent(inout) :: fixed(:)  !< angles so far [rad]
         real(rk) :: arm(2), place

         arm = xy - [scene%domain%x_centre, scene%domain%y_centre]
         if (abs(norm2(arm)/scene%domain%radius - 1.0_rk) > on_circle) return
         place = modulo(atan2(arm(2), arm(1)), 2.0_rk*pi)
         if (any(abs(turned(fixed - place)) < on_circle)) return
         fixed = [fixed, place]
      end subroutine keep

      !> An angle between -pi and pi.
      elemental real(rk) function turned(difference)
         real(rk), intent(in) :: difference

         turned = modulo(difference + pi, 2.0_rk*pi) - pi
      end function turned

   end function circle

   !> Ascending order, by insertion: nearly all are in order.
   pure subroutine sort(values)
      real(rk), intent(inout) :: values(:)
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

end module mechanics_outline
