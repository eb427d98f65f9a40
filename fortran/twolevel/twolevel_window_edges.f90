!> Admissible edges of a window: elements are of poor quality where an edge passes close to a vertex
!! of a fracture, or where a fracture crosses it at a small angle, near a corner or near another
!! fracture.
module twolevel_window_edges
   use base_kinds, only: ik, pi, rk
   use mesh_types, only: network_t
   implicit none(type, external)
   private

   public :: clear_edges

   !> Least gap between fractures on the edge, over the clearance of vertices: smaller gaps lead to
   !! small elements; the mesher accepts about a tenth of this [-].
   real(rk), parameter :: narrow = 0.1_rk

   !> Distance, over the least gap, within which a crossing counts as at the corner [-].
   real(rk), parameter :: at_it = 1.0e-9_rk

contains

   !> Move edges outwards until they are admissible.
   pure subroutine clear_edges(network, clearance, lower, upper)
      type(network_t), intent(in) :: network
      real(rk), intent(in) :: clearance  !< [m]
      real(rk), intent(inout) :: lower(2), upper(2)  !< corners [m]
      integer(ik) :: axis
      logical :: has_moved

      has_moved = .true.
      do while (has_moved)  ! moving an edge moves two corners
         has_moved = .false.
         do axis = 1, 2
            do while (is_in_the_way(network, axis, lower(axis), clearance, lower, upper))
               lower(axis) = lower(axis) - clearance
               has_moved = .true.
            end do
            do while (is_in_the_way(network, axis, upper(axis), clearance, lower, upper))
               upper(axis) = upper(axis) + clearance
               has_moved = .true.
            end do
         end do
      end do
   end subroutine clear_edges

   !> Whether an edge is inadmissible.
   pure logical function is_in_the_way(network, axis, edge, clearance, lower, upper)
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: axis  !< axis normal to the edge
      real(rk), intent(in) :: edge  !< coordinate of the edge along this axis [m]
      real(rk), intent(in) :: clearance  !< clearance from vertices [m]
      real(rk), intent(in) :: lower(2), upper(2)  !< corners [m]

      is_in_the_way = any(abs(network%xy(axis, :) - edge) < clearance)
      if (.not. is_in_the_way) is_in_the_way = is_cut_aslant(network, axis, edge)
      if (.not. is_in_the_way) then
         associate (along => 3 - axis)
            is_in_the_way = is_cut_closely(network, axis, edge, narrow*clearance, &
                                           lower(along), upper(along))
         end associate
      end if
   end function is_in_the_way

   !> Whether a fracture crosses an edge so near to a corner, or to another crossing, that no
   !! element of good quality fits between. Crossings within a window's width beyond the corners
   !! count: the edge may become longer.
   pure logical function is_cut_closely(network, axis, edge, gap, from, to)
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: axis  !< axis normal to the edge
      real(rk), intent(in) :: edge  !< coordinate of the edge along this axis [m]
      real(rk), intent(in) :: gap  !< least gap between crossings [m]
      real(rk), intent(in) :: from, to  !< corners along the edge [m]
      real(rk) :: place(size(network%xy, 2)), share
      integer(ik) :: f, i, n, v

      n = 0
      do f = 1, size(network%first, kind=ik) - 1
         do v = network%first(f), network%first(f + 1) - 2
            associate (a => network%xy(:, v), b => network%xy(:, v + 1))
               if ((a(axis) - edge)*(b(axis) - edge) >= 0.0_rk) cycle
               share = (edge - a(axis))/(b(axis) - a(axis))
               n = n + 1
               place(n) = a(3 - axis) + share*(b(3 - axis) - a(3 - axis))
               if (place(n) < 2.0_rk*from - to .or. place(n) > 2.0_rk*to - from) n = n - 1
            end associate
         end do
      end do
      is_cut_closely = any(is_beside(place(:n) - from) .or. is_beside(place(:n) - to))
      do i = 2, n
         is_cut_closely = is_cut_closely .or. any(abs(place(:i - 1) - place(i)) < gap)
      end do

   contains

      !> Near a corner, but not at the corner.
      elemental logical function is_beside(distance)
         real(rk), intent(in) :: distance  !< [m]

         is_beside = abs(distance) < gap .and. abs(distance) > at_it*gap
      end function is_beside

   end function is_cut_closely

   !> Whether a segment of a fracture crosses the line of an edge at a small angle.
   pure logical function is_cut_aslant(network, axis, edge)
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: axis  !< axis normal to the edge
      real(rk), intent(in) :: edge  !< coordinate of the edge along this axis [m]
      real(rk), parameter :: shallow = tan(5.0_rk*pi/180.0_rk)
      integer(ik) :: f, v

      is_cut_aslant = .false.
      do f = 1, size(network%first, kind=ik) - 1
         do v = network%first(f), network%first(f + 1) - 2
            associate (a => network%xy(:, v), b => network%xy(:, v + 1))
              is_cut_aslant = is_cut_aslant .or. ((a(axis) - edge)*(b(axis) - edge) < 0.0_rk .and. &
                                                   abs(b(axis) - a(axis)) < shallow &
                                                   *abs(b(3 - axis) - a(3 - axis)))
            end associate
         end do
      end do
   end function is_cut_aslant

end module twolevel_window_edges
