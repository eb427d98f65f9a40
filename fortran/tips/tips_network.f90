!> The fracture network as it grows: polylines that get vertices at their ends.
module tips_network
   use base_kinds, only: ik, rk
   use mesh_types, only: network_t
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: end_gain, extend, fracture_length, move_end, network_of_scene, other_distance
   public :: same_network, total_length

contains

   !> The scene's fractures.
   pure function network_of_scene(scene) result(network)
      type(scene_t), intent(in) :: scene
      type(network_t) :: network

      integer(ik) :: f, n

      n = 0
      if (allocated(scene%fractures)) n = size(scene%fractures)
      allocate (network%first(n + 1), network%s_start(n))
      network%s_start = 0.0_rk
      network%first(1) = 1
      do f = 1, n
         network%first(f + 1) = network%first(f) + size(scene%fractures(f)%x)
      end do
      allocate (network%xy(2, network%first(n + 1) - 1))
      do f = 1, n
         network%xy(1, network%first(f):network%first(f + 1) - 1) = scene%fractures(f)%x
         network%xy(2, network%first(f):network%first(f + 1) - 1) = scene%fractures(f)%y
      end do
   end function network_of_scene

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
      integer(ik), intent(in) :: end  !< 1: its first vertex, 2: its last
      real(rk), intent(in) :: xy(2)  !< where to [m]
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

   pure function same_network(a, b) result(same)
      type(network_t), intent(in) :: a, b
      logical :: same

      same = size(a%xy, 2) == size(b%xy, 2)
      if (same) same = all(a%first == b%first)
   end function same_network

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

   !> By how much one end of a fracture has grown since the start [m].
   pure function end_gain(network, start, fracture, end) result(gain)
      type(network_t), intent(in) :: network, start
      integer(ik), intent(in) :: fracture, end
      real(rk) :: gain

      gain = -network%s_start(fracture)
      if (end == 2) gain = fracture_length(network, fracture) - fracture_length(start, fracture) &
                           - gain
   end function end_gain

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

   !> Distance from a new segment to all other fractures, and which one is nearest [m].
   pure subroutine other_distance(network, fracture, from, to, distance, nearest)
      type(network_t), intent(in) :: network
      integer(ik), intent(in) :: fracture  !< the one that the segment belongs to
      real(rk), intent(in) :: from(2), to(2)
      real(rk), intent(out) :: distance
      integer(ik), intent(out) :: nearest  !< 0: there is no other

      real(rk) :: d
      integer(ik) :: f, v

      distance = huge(1.0_rk)
      nearest = 0
      do f = 1, size(network%first) - 1
         if (f == fracture) cycle
         do v = network%first(f), network%first(f + 1) - 2
            d = segment_distance(from, to, network%xy(:, v), network%xy(:, v + 1))
            if (d < distance) then
               distance = d
               nearest = f
            end if
         end do
      end do
   end subroutine other_distance

   !> Distance between two segments [m]; 0 where they cross.
   pure function segment_distance(a, b, c, d) result(distance)
      real(rk), intent(in) :: a(2), b(2), c(2), d(2)
      real(rk) :: distance

      if (cross(b - a, c - a)*cross(b - a, d - a) < 0.0_rk .and. &
          cross(d - c, a - c)*cross(d - c, b - c) < 0.0_rk) then
         distance = 0.0_rk
      else
         distance = min(point_distance(a, c, d), point_distance(b, c, d), point_distance(c, a, b), &
                        point_distance(d, a, b))
      end if
   end function segment_distance

   pure function cross(u, v) result(z)
      real(rk), intent(in) :: u(2), v(2)
      real(rk) :: z

      z = u(1)*v(2) - u(2)*v(1)
   end function cross

   pure function point_distance(p, a, b) result(distance)
      real(rk), intent(in) :: p(2), a(2), b(2)
      real(rk) :: distance

      real(rk) :: t

      t = dot_product(p - a, b - a)/dot_product(b - a, b - a)
      distance = norm2(p - a - min(1.0_rk, max(0.0_rk, t))*(b - a))
   end function point_distance

end module tips_network
