!> Plane geometry in whole numbers, where every result is exact, and where it degenerates.
program test_base_plane
   use base_kinds, only: pi, rk
   use base_plane, only: barycentric, cross, crosses, meeting, nearest_place, nearest_share, &
                         norm2, point_distance, polygon_area, triangle_area, turned, turned_left
   use testing_checks, only: checks_t
   implicit none(type, external)

   !> Far from the origin: whole numbers up to here, and their differences, are exact.
   real(rk), parameter :: far = 2.0_rk**40
   real(rk), parameter :: none = 0.0_rk
   type(checks_t) :: checks

   call check_vectors()
   call check_lengths()
   call check_nearest(0.0_rk)
   call check_nearest(far)
   call check_segments(0.0_rk)
   call check_segments(far)
   call check_areas(0.0_rk)
   call check_areas(far)
   call checks%finish()

contains

   !> The same digits in units that differ by a power of 2, up to the range of numbers.
   subroutine check_lengths()
      real(rk), parameter :: v(2) = [0.3_rk, -1.7_rk]
      integer :: power

      call checks%is_close(norm2([3.0_rk, 4.0_rk]), 5.0_rk, 0.0_rk, "3, 4, 5")
      call checks%is_close(norm2([0.0_rk, 0.0_rk]), 0.0_rk, 0.0_rk, "no length")
      do power = -1000, 1000, 8
         call checks%is_close(scale(norm2(scale(v, power)), -power), norm2(v), &
                              2.0_rk*epsilon(1.0_rk), "any unit")
         if (abs(power) > 460) cycle
         call checks%is_close(scale(norm2(scale(v, power)), -power), norm2(v), 0.0_rk, &
                              "the same digits")
      end do
   end subroutine check_lengths

   subroutine same(value, expected, name)
      real(rk), intent(in) :: value(2), expected(2)
      character(len=*), intent(in) :: name

      call checks%is_close(value(1), expected(1), none, name//", first")
      call checks%is_close(value(2), expected(2), none, name//", second")
   end subroutine same

   subroutine check_vectors()
      real(rk) :: v(2)

      call checks%is_close(cross([2.0_rk, 1.0_rk], [1.0_rk, 3.0_rk]), 5.0_rk, none, "to the left")
      call checks%is_close(cross([1.0_rk, 3.0_rk], [2.0_rk, 1.0_rk]), -5.0_rk, none, "to the right")
      call checks%is_close(cross([1.0_rk, 3.0_rk], [-2.0_rk, -6.0_rk]), 0.0_rk, none, "parallel")
      call same(turned_left([3.0_rk, 4.0_rk]), [-4.0_rk, 3.0_rk], "a right angle")
      v = turned([2.0_rk, 0.0_rk], pi/3.0_rk)
      call checks%is_close(v(1), 1.0_rk, 4.0_rk*epsilon(1.0_rk), "cosine of 60 degrees")
      call checks%is_close(v(2), sqrt(3.0_rk), 4.0_rk*epsilon(1.0_rk), "sine of 60 degrees")
      call same(turned([3.0_rk, 4.0_rk], 0.0_rk), [3.0_rk, 4.0_rk], "not turned")
   end subroutine check_vectors

   !> The segment (0, 0) (8, 0), and one that is a point.
   subroutine check_nearest(shift)
      real(rk), intent(in) :: shift
      real(rk) :: ends(2, 2), dot(2, 2)

      ends = reshape([0, 0, 8, 0], [2, 2]) + shift
      call checks%is_close(nearest_share([2.0_rk, 5.0_rk] + shift, ends), 0.25_rk, none, "share")
      call same(nearest_place([2.0_rk, 5.0_rk] + shift, ends), [2.0_rk, 0.0_rk] + shift, "within")
      call same(nearest_place([-3.0_rk, 4.0_rk] + shift, ends), [0.0_rk, 0.0_rk] + shift, "before")
      call same(nearest_place([9.0_rk, 1.0_rk] + shift, ends), [8.0_rk, 0.0_rk] + shift, "behind")
      call checks%is_close(point_distance([2.0_rk, -5.0_rk] + shift, ends), 5.0_rk, none, "beside")
      call checks%is_close(point_distance([-3.0_rk, 4.0_rk] + shift, ends), 5.0_rk, none, "off 1")
      call checks%is_close(point_distance([12.0_rk, 3.0_rk] + shift, ends), 5.0_rk, none, "off 2")
      call checks%is_close(point_distance([8.0_rk, 0.0_rk] + shift, ends), 0.0_rk, none, "on end 2")
      call checks%is_close(point_distance([3.0_rk, 0.0_rk] + shift, ends), 0.0_rk, none, "on it")

      dot = reshape([1, 2, 1, 2], [2, 2]) + shift
      call checks%is_close(nearest_share([4.0_rk, 6.0_rk] + shift, dot), 0.0_rk, none, "of a point")
      call same(nearest_place([4.0_rk, 6.0_rk] + shift, dot), [1.0_rk, 2.0_rk] + shift, "a point")
      call checks%is_close(point_distance([4.0_rk, 6.0_rk] + shift, dot), 5.0_rk, none, "3, 4, 5")
   end subroutine check_nearest

   !> Segments beside the one from (0, 0) to (8, 0).
   subroutine check_segments(shift)
      real(rk), intent(in) :: shift

      call pair("crossing", [2, -1, 2, 3], [0.25_rk, 0.25_rk], .true., shift)
      call pair("slanting", [0, 2, 4, -2], [0.25_rk, 0.5_rk], .true., shift)
      call pair("short of it", [4, 6, 4, 2], [0.5_rk, 1.5_rk], .false., shift)
      call pair("off its end", [11, 4, 15, 5], [-0.625_rk, -4.0_rk], .false., shift)
      call pair("touching within", [6, 0, 9, 4], [0.75_rk, 0.0_rk], .true., shift)
      call pair("touching ends", [8, 0, 9, 4], [1.0_rk, 0.0_rk], .true., shift)
      call pair("parallel", [2, 3, 20, 3], [-1.0_rk, -1.0_rk], .false., shift)
      call pair("on one line", [12, 0, 9, 0], [-1.0_rk, -1.0_rk], .false., shift)
      call pair("overlapping", [4, 0, 12, 0], [-1.0_rk, -1.0_rk], .false., shift)
      call pair("within the other", [2, 0, 3, 0], [-1.0_rk, -1.0_rk], .false., shift)
      call pair("a point off it", [11, 4, 11, 4], [-1.0_rk, -1.0_rk], .false., shift)
      call pair("a point on it", [3, 0, 3, 0], [-1.0_rk, -1.0_rk], .false., shift)
   end subroutine check_segments

   subroutine pair(name, ends, share, do_cross, shift)
      character(len=*), intent(in) :: name
      integer, intent(in) :: ends(4)  !< x y of both
      real(rk), intent(in) :: share(2)  !< of both segments where their lines meet
      logical, intent(in) :: do_cross
      real(rk), intent(in) :: shift
      real(rk) :: base(2, 2), other(2, 2)

      base = reshape([0, 0, 8, 0], [2, 2]) + shift
      other = reshape(ends, [2, 2]) + shift
      call same(meeting(base, other), share, name//": meeting")
      call same(meeting(other, base), share([2, 1]), name//": meeting, exchanged")
      call checks%is_true(crosses(base, other) .eqv. do_cross, name//": crossing")
      call checks%is_true(crosses(other, base) .eqv. do_cross, name//": crossing, exchanged")
   end subroutine pair

   subroutine check_areas(shift)
      real(rk), intent(in) :: shift
      real(rk) :: corners(2, 3), hook(2, 6), weight(3)

      corners = reshape([1.0_rk, 1.0_rk, 5.0_rk, 1.0_rk, 1.0_rk, 9.0_rk], [2, 3]) + shift
      call checks%is_close(triangle_area(corners), 16.0_rk, none, "counter-clockwise")
      call checks%is_close(triangle_area(corners(:, [2, 1, 3])), -16.0_rk, none, "clockwise")
      weight = barycentric(corners, [2.0_rk, 5.0_rk] + shift)
      call same(weight(1:2), [0.25_rk, 0.25_rk], "weights")
      call checks%is_close(weight(3), 0.5_rk, none, "last weight")
      weight = barycentric(corners, [5.0_rk, 9.0_rk] + shift)
      call same(weight(1:2), [-1.0_rk, 1.0_rk], "weights outside")
      weight = barycentric(corners, corners(:, 3))
      call same(weight(1:2), [0.0_rk, 0.0_rk], "at a corner")

      ! An L: a square of 4 by 4 without its upper right quarter.
      hook = reshape([0.0_rk, 0.0_rk, 4.0_rk, 0.0_rk, 4.0_rk, 2.0_rk, 2.0_rk, 2.0_rk, &
                      2.0_rk, 4.0_rk, 0.0_rk, 4.0_rk], [2, 6]) + shift
      call checks%is_close(polygon_area(hook), 12.0_rk, none, "re-entrant corner")
      call checks%is_close(polygon_area(hook(:, 6:1:-1)), -12.0_rk, none, "the other way round")
      call checks%is_close(polygon_area(hook(:, [3, 4, 5, 6, 1, 2])), 12.0_rk, none, "from another")
      call checks%is_close(polygon_area(hook(:, 1:2)), 0.0_rk, none, "two corners")
   end subroutine check_areas

end program test_base_plane
