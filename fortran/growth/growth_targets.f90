!> Targets of a growing tip: points where its path meets another fracture or the outer boundary.
module growth_targets
   use base_kinds, only: ik, pi, rk
   use base_plane, only: crosses, meeting, nearest_place, nearest_share, norm2, point_distance
   use base_tolerances, only: same_place
   use mesh_types, only: network_t
   implicit none(type, external)
   private

   public :: find_ahead, find_beside, find_target, target_boundary, target_none

   integer(ik), parameter :: target_none = 0
   integer(ik), parameter :: target_boundary = -1

   !> Distance, over `reach`, within which a connection is moved to an existing vertex [-].
   real(rk), parameter :: snap = 0.3_rk
   !> Sine of the smallest angle at which a segment may meet its target. A segment at a smaller
   !! angle ends at the nearest point of the target instead, because the mesh library rejects angles
   !! below 3 degrees.
   real(rk), parameter :: shallow = sin(5.0_rk*pi/180.0_rk)

contains

   !> Target of a new segment at the end of a fracture: the first intersection, or else the target
   !! nearest to the end of the segment.
   !!
   !! The fracture itself is a target where the new segment turns back to the fracture. Segments
   !! that end at the start of the new segment, or lie behind it, are not.
   pure subroutine find_target(network, corners, fracture, from, to, reach, target, at)
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: corners(:, :)  !< (2, n) corners of the body, in order [m]
      integer(ik), intent(in) :: fracture  !< number of the growing fracture
      real(rk), intent(in) :: from(2), to(2)  !< the new segment [m]
      real(rk), intent(in) :: reach  !< largest distance of a target from the end of the segment [m]
      integer(ik), intent(out) :: target  !< fracture, or target_boundary or target_none
      real(rk), intent(out) :: at(2)  !< point of connection [m]
      real(rk) :: best
      integer(ik) :: f, v, k, n

      target = target_none
      at = to
      best = huge(1.0_rk)
      do f = 1, size(network%first, kind=ik) - 1
         do v = network%first(f), network%first(f + 1) - 2
            if (f == fracture .and. is_behind(from, to, network%xy(:, v:v + 1))) cycle
            call try(from, to, network%xy(:, v:v + 1), reach, f, best, target, at)
         end do
      end do
      n = size(corners, 2, kind=ik)
      do k = 1, n
         call try(from, to, corners(:, [k, mod(k, n) + 1]), reach, target_boundary, best, &
                  target, at)
      end do
   end subroutine find_target

   !> First target on the straight continuation of a path. Fractures next to the path are not
   !! targets, except ends and kinks within a distance that a mesh cannot resolve. A connection
   !! within this distance of an existing vertex or crossing is moved there.
   pure subroutine find_ahead(network, corners, fracture, from, way, near, target, at)
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: corners(:, :)  !< (2, n) corners of the body, in order [m]
      integer(ik), intent(in) :: fracture  !< number of the growing fracture
      real(rk), intent(in) :: from(2)  !< position of the tip [m]
      real(rk), intent(in) :: way(2)  !< vector from the tip to the end of the search [m]
      real(rk), intent(in) :: near  !< distance within which ends and kinks lie on the path [m]
      integer(ik), intent(out) :: target  !< fracture, or target_boundary or target_none
      real(rk), intent(out) :: at(2)  !< point of connection [m]
      real(rk) :: best
      integer(ik) :: f, k, n, v

      target = target_none
      at = from + way
      best = huge(1.0_rk)
      do f = 1, size(network%first, kind=ik) - 1
         do v = network%first(f), network%first(f + 1) - 2
            associate (ends => network%xy(:, v:v + 1))
               if (f == fracture .and. point_distance(from, ends) <= same_place*norm2(way)) cycle
               call look_at(from, way, ends, near, f, best, target, at)
            end associate
         end do
      end do
      n = size(corners, 2, kind=ik)
      do k = 1, n
         call look_at(from, way, corners(:, [k, mod(k, n) + 1]), near, target_boundary, best, &
                      target, at)
      end do
      if (target /= target_none) call put_on_joint(network, from, near, at)
   end subroutine find_ahead

   !> Target next to the end of a segment, within a distance that a mesh cannot resolve.
   pure subroutine find_beside(network, corners, fracture, from, to, near, target, at)
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: corners(:, :)  !< (2, n) corners of the body, in order [m]
      integer(ik), intent(in) :: fracture  !< number of the growing fracture
      real(rk), intent(in) :: from(2), to(2)  !< the new segment [m]
      real(rk), intent(in) :: near  !< largest distance of a target from the end of the segment [m]
      integer(ik), intent(out) :: target  !< fracture, or target_boundary or target_none
      real(rk), intent(out) :: at(2)  !< point of connection [m]
      real(rk) :: least
      integer(ik) :: f, k, n, v

      target = target_none
      at = to
      least = near
      do f = 1, size(network%first, kind=ik) - 1
         do v = network%first(f), network%first(f + 1) - 2
            associate (ends => network%xy(:, v:v + 1))
               if (f == fracture .and. &
                   point_distance(from, ends) <= same_place*norm2(to - from)) cycle
               call keep_nearest(to, ends, f, least, target, at)
            end associate
         end do
      end do
      n = size(corners, 2, kind=ik)
      do k = 1, n
         call keep_nearest(to, corners(:, [k, mod(k, n) + 1]), target_boundary, least, target, at)
      end do
      if (target /= target_none) call put_on_joint(network, from, near, at)
   end subroutine find_beside

   !> Keep a segment as the target if it is the nearest so far.
   pure subroutine keep_nearest(to, ends, candidate, least, target, at)
      real(rk), intent(in) :: to(2), ends(2, 2)  !< [m]
      integer(ik), intent(in) :: candidate
      real(rk), intent(inout) :: least  !< distance of the nearest segment so far [m]
      integer(ik), intent(inout) :: target
      real(rk), intent(inout) :: at(2)  !< [m]

      if (.not. point_distance(to, ends) < least) return
      least = point_distance(to, ends)
      target = candidate
      at = nearest_place(to, ends)
   end subroutine keep_nearest

   !> Move a connection to the nearest vertex or crossing of the network within `near`.
   pure subroutine put_on_joint(network, from, near, at)
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: from(2)  !< position of the tip, where no connection is made [m]
      real(rk), intent(in) :: near  !< [m]
      real(rk), intent(inout) :: at(2)  !< [m]
      integer(ik), allocatable :: around(:)
      real(rk) :: least, place(2), share(2)
      integer(ik) :: f, i, k, v

      least = near
      place = at
      allocate (around(0))
      do f = 1, size(network%first, kind=ik) - 1
         do v = network%first(f), network%first(f + 1) - 1
            associate (vertex => network%xy(:, v))
               if (norm2(vertex - at) < least .and. norm2(vertex - from) > near) then
                  least = norm2(vertex - at)
                  place = vertex
               end if
            end associate
            if (v == network%first(f + 1) - 1) exit
            if (point_distance(at, network%xy(:, v:v + 1)) < near) around = [around, v]
         end do
      end do
      if (.not. least < near) then
         do i = 1, size(around, kind=ik)
            do k = 1, i - 1
               associate (a => network%xy(:, around(i):around(i) + 1), &
                          b => network%xy(:, around(k):around(k) + 1))
                  share = meeting(a, b)
                  if (.not. all(share >= 0.0_rk .and. share <= 1.0_rk)) cycle
                  associate (crossing => a(:, 1) + share(1)*(a(:, 2) - a(:, 1)))
                     if (.not. (norm2(crossing - at) < least .and. &
                                norm2(crossing - from) > near)) cycle
                     least = norm2(crossing - at)
                     place = crossing
                  end associate
               end associate
            end do
         end do
      end if
      at = place
   end subroutine put_on_joint

   !> Keep a segment as the target if the path reaches it first. A path that meets the segment at
   !! too small an angle ends at the nearest point of the segment instead.
   pure subroutine look_at(from, way, ends, near, candidate, best, target, at)
      real(rk), intent(in) :: from(2), way(2), ends(2, 2), near  !< [m]
      integer(ik), intent(in) :: candidate
      !> distance of the target so far, over the length of `way` [-]
      real(rk), intent(inout) :: best
      integer(ik), intent(inout) :: target
      real(rk), intent(inout) :: at(2)  !< [m]
      real(rk) :: line(2, 2), place(2), share(2)
      integer :: k

      line = reshape([from, from + way], [2, 2])
      share = meeting(line, ends)
      if (all(share >= 0.0_rk .and. share <= 1.0_rk) .and. share(1) < best) then
         place = ends(:, 1) + share(2)*(ends(:, 2) - ends(:, 1))
         associate (nearest => nearest_place(from, ends))
            if (norm2(nearest - from) < shallow*norm2(place - from)) place = nearest
         end associate
         do k = 1, 2
            if (norm2(place - ends(:, k)) < near) place = ends(:, k)
         end do
         best = share(1)
         target = candidate
         at = place
      end if
      do k = 1, 2
         if (.not. point_distance(ends(:, k), line) < near) cycle
         share(1) = nearest_share(ends(:, k), line)
         if (.not. (share(1) > 0.0_rk .and. share(1) < best)) cycle
         best = share(1)
         target = candidate
         at = ends(:, k)
      end do
   end subroutine look_at

   !> Whether a segment of the growing fracture ends at the start of the new segment, or lies behind
   !! it.
   pure logical function is_behind(from, to, ends)
      real(rk), intent(in) :: from(2), to(2)  !< the new segment [m]
      real(rk), intent(in) :: ends(2, 2)  !< ends of the old segment [m]
      real(rk) :: before, after

      before = norm2(nearest_place(from, ends) - from)
      after = norm2(nearest_place(to, ends) - to)
      is_behind = before <= same_place*norm2(to - from) .or. &
                  (after >= before .and. .not. crosses(reshape([from, to], [2, 2]), ends))
   end function is_behind

   !> Keep the candidate if its rank is lower. Intersections rank by their position along the
   !! segment, below 1; targets near the end of the segment rank after all of them.
   pure subroutine try(from, to, ends, reach, candidate, best, target, at)
      real(rk), intent(in) :: from(2), to(2), ends(2, 2), reach  !< [m]
      integer(ik), intent(in) :: candidate
      real(rk), intent(inout) :: best  !< rank of the present target [-]
      integer(ik), intent(inout) :: target
      real(rk), intent(inout) :: at(2)  !< [m]
      real(rk) :: place(2), share(2), rank
      integer :: k

      rank = huge(1.0_rk)
      share = meeting(reshape([from, to], [2, 2]), ends)
      if (all(share >= 0.0_rk .and. share <= 1.0_rk)) then
         rank = share(1)
         place = ends(:, 1) + share(2)*(ends(:, 2) - ends(:, 1))
      else
         place = nearest_place(to, ends)
         if (norm2(place - to) < reach) rank = 1.0_rk + norm2(place - to)/reach
      end if
      if (.not. rank < best) return
      best = rank
      target = candidate
      associate (near => nearest_place(from, ends))
         if (norm2(near - from) < shallow*norm2(place - from)) place = near
      end associate
      at = place
      do k = 1, 2
         if (norm2(place - ends(:, k)) < snap*reach) at = ends(:, k)
      end do
   end subroutine try

end module growth_targets
