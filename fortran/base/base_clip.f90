!> The part of a polygon on one side of a line.
module base_clip
   use base_kinds, only: ik, rk
   use base_plane, only: cross
   implicit none(type, external)
   private

   public :: left_part

contains

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

end module base_clip
