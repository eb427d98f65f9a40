!> Fractures in the mesh of a window: each vertex of a path is a node of the mesh, and paths that
!! have grown have a vertex every few millimetres. Far from the tips of the window, where the
!! elements are larger than that, vertices that lie almost on a straight line are omitted.
!!
!! This changes neither joints nor the points where fractures cross the window's edge, and positions
!! along the fractures keep their arc lengths, which the coarse level uses. Whole fractures may be
!! left out (twolevel_still_fractures); the others keep their numbers.
module twolevel_window_path
   use base_kinds, only: ik, rk
   use base_plane, only: crosses, norm2, point_distance
   use mesh_builder, only: mesh_spec_t
   use mesh_types, only: fracture_mesh_t, mesh_t, network_t
   implicit none(type, external)
   private

   public :: near_ends, numbers_without, restore_fractures, straighten_far, without

   !> Largest distance of a removed vertex from the straight line, over the size of the elements
   !! there [-].
   real(rk), parameter :: straight = 0.005_rk

contains

   !> Remove the vertices that the window does not need.
   pure subroutine straighten_far(network, spec, is_body, is_needed, simple, kept)
      type(network_t), intent(in) :: network
      type(mesh_spec_t), intent(in) :: spec  !< with its foci and sizes
      logical, intent(in) :: is_body  !< the window has no edge that fractures cross
      logical, intent(in) :: is_needed(:)  !< (fractures) others are left out
      type(network_t), intent(out) :: simple
      !> (vertices of simple) their numbers in the network
      integer(ik), allocatable, intent(out) :: kept(:)
      logical :: keeps(size(network%xy, 2))
      integer(ik) :: f, last, v

      keeps = .true.
      do f = 1, size(network%first, kind=ik) - 1
         last = network%first(f)
         if (.not. is_needed(f)) keeps(last:network%first(f + 1) - 1) = .false.
         if (.not. is_needed(f)) cycle
         do v = last + 1, network%first(f + 1) - 2
            keeps(v) = .not. is_dispensable(network, spec, is_body, last, v)
            if (keeps(v)) last = v
         end do
      end do
      kept = pack([(v, v=1, size(keeps, kind=ik))], keeps)
      simple = without(network, kept)
   end subroutine straighten_far

   !> Cells with a corner so near to the last segment of a fracture's end.
   pure function near_ends(mesh, network, fracture, end, reach) result(is_near)
      type(mesh_t), intent(in) :: mesh
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: fracture(:), end(:)  !< the ends
      real(rk), intent(in) :: reach  !< over the length of the segment [-]
      logical :: is_near(mesh%n_cells)
      logical :: node_is_near(mesh%n_nodes)
      real(rk) :: piece(2, 2)
      integer(ik) :: c, i, last, v

      node_is_near = .false.
      do i = 1, size(fracture, kind=ik)
         last = network%first(fracture(i))
         if (end(i) == 2) last = network%first(fracture(i) + 1) - 2
         piece = network%xy(:, last:last + 1)
         do v = 1, mesh%n_nodes
            if (node_is_near(v)) cycle
            node_is_near(v) = point_distance(mesh%xy(:, v), piece) &
                              <= reach*norm2(piece(:, 2) - piece(:, 1))
         end do
      end do
      is_near = [(any(node_is_near(mesh%cell_nodes(:, c))), c=1, mesh%n_cells)]
   end function near_ends

   !> Network with a selection of its vertices, and of the fractures that have some of them.
   pure function without(network, kept) result(simple)
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: kept(:)  !< vertices to keep, in ascending order
      type(network_t) :: simple
      integer(ik) :: first(size(network%first)), f
      logical :: stays(size(network%first) - 1)

      first = [(1 + count(kept < network%first(f), kind=ik), f=1, size(first, kind=ik))]
      stays = numbers_without(network, kept) > 0
      simple%xy = network%xy(:, kept)
      simple%first = [pack(first(:size(stays)), stays), first(size(first))]
      simple%s_start = pack(network%s_start, stays)
      if (allocated(network%names)) simple%names = pack(network%names, stays)
   end function without

   !> Number of each fracture in a network without some vertices; 0 for one that it does not have.
   pure function numbers_without(network, kept) result(number)
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: kept(:)  !< vertices kept
      integer(ik) :: f, n, number(size(network%first) - 1)

      n = 0
      number = 0
      do f = 1, size(number, kind=ik)
         if (.not. any(kept >= network%first(f) .and. kept < network%first(f + 1))) cycle
         n = n + 1
         number(f) = n
      end do
   end function numbers_without

   !> Whether a straight line from the vertex `last` to the one after v is accurate enough.
   pure logical function is_dispensable(network, spec, is_body, last, v)
      type(network_t), intent(in) :: network
      type(mesh_spec_t), intent(in) :: spec
      logical, intent(in) :: is_body
      integer(ik), intent(in) :: last, v
      real(rk) :: chord(2, 2), element, from_focus, length
      integer(ik) :: i

      is_dispensable = .false.
      chord = network%xy(:, [last, v + 1])
      length = norm2(chord(:, 2) - chord(:, 1))
      from_focus = huge(1.0_rk)
      do i = 1, size(spec%foci, 2, kind=ik)
         from_focus = min(from_focus, point_distance(spec%foci(:, i), chord))
      end do
      element = min(spec%size_fracture + spec%focus_slope*from_focus, spec%focus_size)
      if (length > min(element, from_focus)) return
      do i = last + 1, v
         if (point_distance(network%xy(:, i), chord) > straight*element) return
      end do
      if (.not. is_body) then
         if (crosses_edge(spec, chord, straight*element)) return
      end if
      is_dispensable = .not. meets_other(network, last, v, chord, 2.0_rk*straight*element)
   end function is_dispensable

   !> Whether a line crosses the edge of the window, or comes near it.
   pure logical function crosses_edge(spec, line, near)
      type(mesh_spec_t), intent(in) :: spec
      real(rk), intent(in) :: line(2, 2)  !< ends [m]
      real(rk), intent(in) :: near  !< [m]
      real(rk) :: lower(2), upper(2)

      lower = [spec%x_min, spec%y_min]
      upper = [spec%x_max, spec%y_max]
      crosses_edge = .not. (all(minval(line, dim=2) > lower + near) .and. &
                            all(maxval(line, dim=2) < upper - near))
      if (.not. crosses_edge) return
      crosses_edge = .not. (any(maxval(line, dim=2) < lower - near) .or. &
                            any(minval(line, dim=2) > upper + near))
   end function crosses_edge

   !> Whether another fracture, or another part of the same one, crosses a line or comes near it.
   pure logical function meets_other(network, last, dropped, line, near)
      type(network_t), intent(in) :: network
      !> the line is from `last` to the vertex after `dropped`
      integer(ik), intent(in) :: last, dropped
      real(rk), intent(in) :: line(2, 2)  !< ends [m]
      real(rk), intent(in) :: near  !< [m]
      real(rk) :: lower(2), other(2, 2), upper(2)
      integer(ik) :: f, v

      meets_other = .true.
      lower = minval(line, dim=2) - near
      upper = maxval(line, dim=2) + near
      do f = 1, size(network%first, kind=ik) - 1
         do v = network%first(f), network%first(f + 1) - 2
            ! Segments that the line replaces, and their neighbours
            if (v >= last - 1 .and. v <= dropped + 1) cycle
            other = network%xy(:, v:v + 1)
            if (any(maxval(other, dim=2) < lower .or. minval(other, dim=2) > upper)) cycle
            if (crosses(line, other)) return
            if (min(point_distance(other(:, 1), line), point_distance(other(:, 2), line), &
                    point_distance(line(:, 1), other), point_distance(line(:, 2), other)) &
                < near) return
         end do
      end do
      meets_other = .false.
   end function meets_other

   !> Set the numbers of the fractures and the arc lengths of their cells to those of the whole
   !! network.
   pure subroutine restore_fractures(network, simple, kept, fractures)
      type(network_t), intent(in) :: network, simple
      integer(ik), intent(in) :: kept(:)  !< as from straighten_far
      type(fracture_mesh_t), intent(inout) :: fractures  !< in the mesh of `simple`
      real(rk) :: whole(size(network%xy, 2)), short(size(simple%xy, 2))
      integer(ik), allocatable :: whole_number(:)
      integer(ik) :: cell, end, v

      if (size(kept) == size(network%xy, 2)) return
      whole = arc_lengths(network)
      short = arc_lengths(simple)
      do cell = 1, fractures%n_cells
         associate (f => fractures%cell_fracture(cell), s => fractures%cell_s(:, cell))
            ! A cell lies between two vertices: the ones around its middle.
            do v = simple%first(f), simple%first(f + 1) - 3
               if (0.5_rk*sum(s) < short(v + 1)) exit
            end do
            do end = 1, 2
               s(end) = whole(kept(v)) + (s(end) - short(v)) &
                        *(whole(kept(v + 1)) - whole(kept(v)))/(short(v + 1) - short(v))
            end do
         end associate
      end do
      whole_number = pack([(v, v=1, size(network%first, kind=ik) - 1)], &
                          numbers_without(network, kept) > 0)
      fractures%cell_fracture = whole_number(fractures%cell_fracture)
      fractures%tip_fracture = whole_number(fractures%tip_fracture)
   end subroutine restore_fractures

   !> Arc lengths of all vertices [m].
   pure function arc_lengths(network) result(s)
      type(network_t), intent(in) :: network
      real(rk) :: s(size(network%xy, 2))
      integer(ik) :: f, v

      do f = 1, size(network%first, kind=ik) - 1
         s(network%first(f)) = network%s_start(f)
         do v = network%first(f) + 1, network%first(f + 1) - 1
            s(v) = s(v - 1) + norm2(network%xy(:, v) - network%xy(:, v - 1))
         end do
      end do
   end function arc_lengths

end module twolevel_window_path
