!> Corners of the fractures of a scene: places where they turn, meet or cross. The stress has a weak
!! singularity there, for which finite elements are small (corner_share in mesh_c_arrays). Corners
!! of paths that grow are left out: there are many of them, and but for the first turn they are
!! slight.
module report_corners
   use base_kinds, only: ik, rk
   use base_plane, only: meeting, norm2
   use base_tolerances, only: same_place
   use scene_types, only: fracture_t, scene_t
   implicit none(type, external)
   private

   public :: joints_of_scene, kinks_of_scene

contains

   !> Places where a fracture turns by more than 10 degrees [m].
   pure function kinks_of_scene(scene) result(places)
      type(scene_t), intent(in) :: scene
      real(rk), allocatable :: places(:, :)  !< (2, n)
      real(rk), parameter :: cosine = 0.985_rk
      real(rk) :: before(2), after(2), segment(2, 2), next(2, 2)
      integer(ik) :: f, i

      allocate (places(2, 0))
      if (.not. allocated(scene%fractures)) return
      do f = 1, size(scene%fractures, kind=ik)
         do i = 1, size(scene%fractures(f)%x, kind=ik) - 2
            segment = segment_of(scene%fractures(f), i)
            next = segment_of(scene%fractures(f), i + 1)
            before = segment(:, 2) - segment(:, 1)
            after = next(:, 2) - next(:, 1)
            if (dot_product(before, after) > cosine*norm2(before)*norm2(after)) cycle
            places = reshape([places, next(:, 1)], [2, size(places, 2) + 1])
         end do
      end do
   end function kinks_of_scene

   !> Places where fractures meet or cross, one of them with itself too [m].
   pure function joints_of_scene(scene) result(places)
      type(scene_t), intent(in) :: scene
      real(rk), allocatable :: places(:, :)  !< (2, n)
      real(rk) :: first(2, 2), second(2, 2), share(2)
      integer(ik) :: f, g, i, j

      allocate (places(2, 0))
      if (.not. allocated(scene%fractures)) return
      do f = 1, size(scene%fractures, kind=ik)
         do i = 1, size(scene%fractures(f)%x, kind=ik) - 1
            first = segment_of(scene%fractures(f), i)
            do g = f, size(scene%fractures, kind=ik)
               do j = 1, size(scene%fractures(g)%x, kind=ik) - 1
                  if (g == f .and. j < i + 2) cycle
                  second = segment_of(scene%fractures(g), j)
                  share = meeting(first, second)
                  if (any(share < -same_place .or. share > 1.0_rk + same_place)) cycle
                  places = reshape([places, first(:, 1) + share(1)*(first(:, 2) - first(:, 1))], &
                                   [2, size(places, 2) + 1])
               end do
            end do
         end do
      end do
   end function joints_of_scene

   !> Ends of a segment of a fracture [m].
   pure function segment_of(fracture, i) result(ends)
      type(fracture_t), intent(in) :: fracture
      integer(ik), intent(in) :: i  !< its number
      real(rk) :: ends(2, 2)

      ends = reshape([fracture%x(i), fracture%y(i), fracture%x(i + 1), fracture%y(i + 1)], [2, 2])
   end function segment_of

end module report_corners
