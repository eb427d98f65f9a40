!> Which rock is where: the regions of a scene by place.
module scene_rock_places
   use base_kinds, only: ik, rk
   use base_plane, only: point_distance, triangle_area
   use scene_region_outline, only: region_outline
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: is_inside, outline_t, rock_places_t, toughness_ahead

   !> Corners of a region, counter-clockwise [m].
   type :: outline_t
      real(rk), allocatable :: corners(:, :)
   end type outline_t

   !> The outlines of the regions of a scene, in its order; none of a uniform rock.
   type :: rock_places_t
      type(outline_t), allocatable :: outline(:)
   contains
      procedure :: set
      procedure :: region_at
      procedure :: distance
   end type rock_places_t

contains

   !> Take the regions of a scene.
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

   !> The region that counts at a point; 0: none, the rock of the scene.
   pure integer(ik) function region_at(self, point)
      class(rock_places_t), intent(in) :: self
      real(rk), intent(in) :: point(2)  !< [m]

      do region_at = size(self%outline, kind=ik), 1, -1
         if (is_inside(self%outline(region_at)%corners, point)) return
      end do
   end function region_at

   !> From a point to the nearest outline of the regions that count; huge if there is none [m].
   pure real(rk) function distance(self, point, counts)
      class(rock_places_t), intent(in) :: self
      real(rk), intent(in) :: point(2)  !< [m]
      logical, intent(in) :: counts(:)  !< (regions)
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

   !> K_IC of the rock that a tip grows in [Pa m^1/2]. From one rock to the next it changes linearly
   !! over the last piece of the way there, so that there is an equilibrium: a tip that tougher
   !! rock holds stands within that piece before it.
   pure real(rk) function toughness_ahead(places, scene, xy, direction, reach) result(toughness)
      type(rock_places_t), intent(in) :: places
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: xy(2)  !< the tip [m]
      real(rk), intent(in) :: direction(2)  !< unit vector ahead [-]
      real(rk), intent(in) :: reach  !< of that piece [m]
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

      pure real(rk) function at(share)
         real(rk), intent(in) :: share  !< of the reach [-]
         integer(ik) :: region

         region = places%region_at(xy + share*reach*direction)
         if (region == 0) then
            at = scene%material%toughness
         else
            at = scene%regions(region)%material%toughness
         end if
      end function at

   end function toughness_ahead

   !> A ray to the right from a point inside meets the outline an odd number of times (Shimrat
   !! 1962); the point is not on the outline.
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

end module scene_rock_places
