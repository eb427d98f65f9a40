!> The growing fracture network: polylines that gain vertices at their ends.
module growth_network
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use mesh_types, only: network_t
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: end_direction, end_gain, end_pieces, end_place, end_vertices, extend, fracture_length
   public :: increments_in, move_end, network_of_scene, straighten_end, total_length

contains

   !> Network of the scene's fractures.
   pure function network_of_scene(scene) result(network)
      type(scene_t), intent(in) :: scene
      type(network_t) :: network

      integer(ik) :: f, n

      n = 0
      if (allocated(scene%fractures)) n = size(scene%fractures)
      allocate (network%first(n + 1), network%s_start(n), network%names(n))
      network%s_start = 0.0_rk
      network%first(1) = 1
      do f = 1, n
         network%names(f)%text = trim(scene%fractures(f)%name)
         network%first(f + 1) = network%first(f) + size(scene%fractures(f)%x)
      end do
      allocate (network%xy(2, network%first(n + 1) - 1))
      do f = 1, n
         network%xy(1, network%first(f):network%first(f + 1) - 1) = scene%fractures(f)%x
         network%xy(2, network%first(f):network%first(f + 1) - 1) = scene%fractures(f)%y
      end do
   end function network_of_scene

   !> l_max of each fracture's tips; by length it grows with a fracture that has become twice as
   !! long [m].
   pure function increments_in(network, scene) result(increment)
      type(network_t), intent(in) :: network
      type(scene_t), intent(in) :: scene
      real(rk) :: increment(size(network%first) - 1)
      real(rk), parameter :: doubled = 2.0_rk
      integer(ik) :: f

      increment = [(scene%increment_of(f), f=1, size(increment, kind=ik))]
      if (scene%growth%increments /= "by_length") return
      increment = [(increment(f)*max(1.0_rk, fracture_length(network, f) &
                                     /(doubled*scene%fractures(f)%length())), &
                    f=1, size(increment, kind=ik))]
   end function increments_in

   !> Add a vertex at one end of a fracture.
   pure subroutine extend(network, fracture, end, xy)
      type(network_t), intent(inout) :: network
      integer(ik), intent(in) :: fracture
      integer(ik), intent(in) :: end  !< 1: before the first vertex, 2: after the last
      real(rk), intent(in) :: xy(2)  !< [m]

      real(rk), allocatable :: longer(:, :)
      integer(ik) :: at, n

      n = size(network%xy, 2)
      allocate (longer(2, n + 1))
      at = network%first(fracture)
      if (end == 2) at = network%first(fracture + 1)
      longer(:, :at - 1) = network%xy(:, :at - 1)
      longer(:, at) = xy
      longer(:, at + 1:) = network%xy(:, at:)
      if (end == 1) network%s_start(fracture) = network%s_start(fracture) &
                                                - norm2(network%xy(:, at) - xy)
      call move_alloc(longer, network%xy)
      network%first(fracture + 1:) = network%first(fracture + 1:) + 1
   end subroutine extend

   !> Move one end of a fracture; the arc lengths of its other vertices stay.
   pure subroutine move_end(network, fracture, end, xy)
      type(network_t), intent(inout) :: network
      integer(ik), intent(in) :: fracture
      integer(ik), intent(in) :: end  !< 1: first vertex, 2: last vertex
      real(rk), intent(in) :: xy(2)  !< new position [m]
      integer(ik) :: v

      v = network%first(fracture + 1) - 1
      if (end == 1) then
         v = network%first(fracture)
         network%s_start(fracture) = network%s_start(fracture) &
                                     + norm2(network%xy(:, v + 1) - network%xy(:, v)) &
                                     - norm2(network%xy(:, v + 1) - xy)
      end if
      network%xy(:, v) = xy
   end subroutine move_end

   !> Lengths of the first and last straight segments of the fractures [m].
   pure function end_pieces(network) result(length)
      type(network_t), intent(in) :: network
      real(rk) :: length(2, size(network%first) - 1)
      integer :: f

      do f = 1, size(network%first) - 1
         associate (first => network%first(f), last => network%first(f + 1) - 1)
            length(1, f) = norm2(network%xy(:, first + 1) - network%xy(:, first))
            length(2, f) = norm2(network%xy(:, last) - network%xy(:, last - 1))
         end associate
      end do
   end function end_pieces

   !> Length of all fractures [m].
   pure function total_length(network) result(length)
      type(network_t), intent(in) :: network
      real(rk) :: length

      integer(ik) :: f, v

      length = 0.0_rk
      do f = 1, size(network%first) - 1
         do v = network%first(f), network%first(f + 1) - 2
            length = length + norm2(network%xy(:, v + 1) - network%xy(:, v))
         end do
      end do
   end function total_length

   !> Growth of one end of a fracture since an earlier network [m].
   pure function end_gain(network, start, fracture, end) result(gain)
      type(network_t), intent(in) :: network, start
      integer(ik), intent(in) :: fracture, end
      real(rk) :: gain

      gain = start%s_start(fracture) - network%s_start(fracture)
      if (end == 2) gain = fracture_length(network, fracture) - fracture_length(start, fracture) &
                           - gain
   end function end_gain

   !> Number of vertices added at one end of a fracture since an earlier network.
   pure function end_vertices(network, start, fracture, end) result(n)
      type(network_t), intent(in) :: network, start
      integer(ik), intent(in) :: fracture
      integer(ik), intent(in) :: end  !< 1: before the first vertex, 2: after the last
      integer(ik) :: n
      integer(ik) :: last, step
      real(rk) :: end_before(2)

      end_before = start%xy(:, end_vertex(start, fracture, end))
      last = end_vertex(network, fracture, end)
      step = merge(1, -1, end == 1)
      do n = 0, network%first(fracture + 1) - network%first(fracture) - 1
         if (all(abs(network%xy(:, last + n*step) - end_before) <= 0.0_rk)) return
      end do
   end function end_vertices

   !> Position of one end of a fracture [m].
   pure function end_place(network, fracture, end) result(xy)
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: fracture
      integer(ik), intent(in) :: end  !< 1: at the first vertex, 2: at the last vertex
      real(rk) :: xy(2)

      xy = network%xy(:, end_vertex(network, fracture, end))
   end function end_place

   !> Number of the vertex at one end of a fracture.
   pure integer(ik) function end_vertex(network, fracture, end)
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: fracture
      integer(ik), intent(in) :: end  !< 1: first vertex, 2: last vertex

      end_vertex = merge(network%first(fracture), network%first(fracture + 1) - 1, end == 1)
   end function end_vertex

   !> Unit vector along the last segment at one end of a fracture, outwards.
   pure function end_direction(network, fracture, end) result(direction)
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: fracture
      integer(ik), intent(in) :: end  !< 1: at the first vertex, 2: at the last vertex
      real(rk) :: direction(2)
      integer(ik) :: tip

      tip = end_vertex(network, fracture, end)
      direction = network%xy(:, tip) - network%xy(:, merge(tip + 1, tip - 1, end == 1))
      direction = direction/norm2(direction)
   end function end_direction

   !> Replace the last segments at one end of a fracture by one straight segment; the arc lengths of
   !! the other vertices stay.
   pure subroutine straighten_end(network, fracture, end, dropped)
      type(network_t), intent(inout) :: network
      integer(ik), intent(in) :: fracture
      integer(ik), intent(in) :: end  !< 1: at the first vertex, 2: at the last vertex
      integer(ik), intent(in) :: dropped  !< number of vertices to remove, next to the end vertex
      real(rk), allocatable :: kept(:, :)
      integer(ik) :: at, k

      allocate (kept(2, size(network%xy, 2) - dropped))
      at = end_vertex(network, fracture, end)
      if (end == 2) at = at - dropped - 1  ! last vertex before the removed ones
      kept(:, :at) = network%xy(:, :at)
      kept(:, at + 1:) = network%xy(:, at + 1 + dropped:)
      if (end == 1) then
         network%s_start(fracture) = network%s_start(fracture) &
                                     - norm2(kept(:, at + 1) - kept(:, at))
         do k = at, at + dropped
            network%s_start(fracture) = network%s_start(fracture) &
                                        + norm2(network%xy(:, k + 1) - network%xy(:, k))
         end do
      end if
      network%first(fracture + 1:) = network%first(fracture + 1:) - dropped
      call move_alloc(kept, network%xy)
   end subroutine straighten_end

   !> Length of one fracture [m].
   pure function fracture_length(network, fracture) result(length)
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: fracture
      real(rk) :: length

      integer(ik) :: v

      length = 0.0_rk
      do v = network%first(fracture), network%first(fracture + 1) - 2
         length = length + norm2(network%xy(:, v + 1) - network%xy(:, v))
      end do
   end function fracture_length

end module growth_network
