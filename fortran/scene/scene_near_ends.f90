!> Ends of fractures that almost touch another fracture or a side of the body, or that lie just past
!! one that they cross: hardly meant, where fractures grow.
module scene_near_ends
   use base_kinds, only: ik, rk
   use base_plane, only: meeting, nearest_share, point_distance
   use base_tolerances, only: same_place
   use scene_types, only: domain_t, fracture_t
   implicit none(type, external)
   private

   public :: near_end_t, near_ends

   !> An end, and what it is near to.
   type :: near_end_t
      integer :: fracture = 0  !< whose end it is
      integer :: other = 0  !< the fracture that it is near to, or 0 for a side
      integer :: side = 0  !< left, right, bottom, top
      real(rk) :: distance = 0.0_rk  !< [m]
      logical :: is_past = .false.  !< the fracture crosses the other one and ends behind it
   end type near_end_t

contains

   !> All ends that are nearer than that to something that they do not touch. Two ends that are near
   !! to each other are told once.
   pure function near_ends(fractures, domain, near) result(list)
      type(fracture_t), intent(in) :: fractures(:)
      type(domain_t), intent(in) :: domain  !< its sides count if it is a rectangle
      real(rk), intent(in) :: near  !< [m]
      type(near_end_t), allocatable :: list(:)
      real(rk) :: distance, last(2, 2), room(4)
      integer :: end, i, j, side
      logical :: is_at_end, is_past

      allocate (list(0))
      do i = 1, size(fractures)
         do end = 1, 2
            last = last_segment(fractures(i), end)
            room = [last(1, 1) - domain%x_min, domain%x_max - last(1, 1), &
                    last(2, 1) - domain%y_min, domain%y_max - last(2, 1)]
            do side = 1, merge(4, 0, domain%shape == "rectangle")
               if (is_near(room(side))) list = [list, near_end_t(i, 0, side, room(side))]
            end do
            do j = 1, size(fractures)
               if (j == i) cycle
               call look_at(last, fractures(j), distance, is_at_end, is_past)
               if (.not. is_near(distance)) cycle
               if (is_at_end .and. j < i .and. .not. is_past) cycle
               list = [list, near_end_t(i, j, 0, distance, is_past)]
            end do
         end do
      end do

   contains

      pure logical function is_near(distance)
         real(rk), intent(in) :: distance  !< [m]

         is_near = distance > same_place*fractures(i)%length() .and. distance < near
      end function is_near

   end function near_ends

   !> The segment that a fracture ends with, from its end inwards [m].
   pure function last_segment(fracture, end) result(ends)
      type(fracture_t), intent(in) :: fracture
      integer, intent(in) :: end  !< 1 or 2
      real(rk) :: ends(2, 2)
      integer :: first, next

      first = merge(1, size(fracture%x), end == 1)
      next = merge(2, size(fracture%x) - 1, end == 1)
      ends(:, 1) = [fracture%x(first), fracture%y(first)]
      ends(:, 2) = [fracture%x(next), fracture%y(next)]
   end function last_segment

   !> How near an end is to a fracture, or how far past it.
   pure subroutine look_at(last, other, distance, is_at_end, is_past)
      real(rk), intent(in) :: last(2, 2)  !< the segment with the end, which comes first [m]
      type(fracture_t), intent(in) :: other
      real(rk), intent(out) :: distance  !< [m]
      logical, intent(out) :: is_at_end  !< of the other one
      logical, intent(out) :: is_past
      real(rk) :: ends(2, 2), here, length, place, share(2)
      integer(ik) :: n, v

      distance = huge(1.0_rk)
      is_at_end = .false.
      is_past = .false.
      length = norm2(last(:, 2) - last(:, 1))
      n = size(other%x, kind=ik)
      do v = 1, n - 1
         ends = reshape([other%x(v), other%y(v), other%x(v + 1), other%y(v + 1)], [2, 2])
         here = point_distance(last(:, 1), ends)
         share = meeting(last, ends)
         if (all(share >= 0.0_rk .and. share <= 1.0_rk) .and. &
             here > same_place*length .and. share(1)*length < distance) then
            distance = share(1)*length
            is_past = .true.
            is_at_end = .false.
         else if (here < distance) then
            distance = here
            is_past = .false.
            place = nearest_share(last(:, 1), ends)
            is_at_end = (v == 1 .and. place <= 0.0_rk) .or. (v == n - 1 .and. place >= 1.0_rk)
         end if
      end do
   end subroutine look_at

end module scene_near_ends
