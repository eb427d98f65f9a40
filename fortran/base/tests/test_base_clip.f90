!> Polygons cut by a line, in whole numbers, where every result is exact.
program test_base_clip
   use base_kinds, only: rk
   use base_plane, only: left_part, polygon_area
   use testing_checks, only: checks_t
   implicit none(type, external)

   real(rk), parameter :: square(2, 4) = reshape([0, 0, 4, 0, 4, 4, 0, 4]*1.0_rk, [2, 4])
   !> A U: two legs of 1 x 3 on a floor of 3 x 1.
   real(rk), parameter :: u(2, 8) = reshape([0, 0, 3, 0, 3, 4, 2, 4, 2, 1, 1, 1, 1, 4, 0, 4] &
                                            *1.0_rk, [2, 8])
   real(rk), parameter :: none = 0.0_rk
   type(checks_t) :: checks

   call expect(square, [1, 0, 1, 4], 4.0_rk, "left of an upright line")
   call expect(square, [1, 4, 1, 0], 12.0_rk, "the other way")
   call expect(square, [0, 0, 4, 4], 8.0_rk, "through two corners")
   call expect(square, [0, 0, 4, 0], 16.0_rk, "above its lower edge")
   call expect(square, [4, 0, 0, 0], 0.0_rk, "below its lower edge")
   call expect(square, [-1, 0, -1, 4], 0.0_rk, "beside it")
   call expect(square, [5, 0, 5, 4], 16.0_rk, "all of it")
   call expect(u, [3, 2, 0, 2], 5.0_rk, "the floor of a U")
   call expect(u, [0, 2, 3, 2], 4.0_rk, "its two legs, joined along the line")
   call checks%is_true(size(left_part(square, reshape([-1, 0, -1, 4]*1.0_rk, [2, 2]))) == 0, &
                       "nothing is no corner")
   call checks%is_true(size(left_part(square(:, :0), reshape([-1, 0, -1, 4]*1.0_rk, [2, 2]))) == &
                       0, "nothing of nothing")
   call checks%finish()

contains

   !> The area that remains of a polygon, either way round.
   subroutine expect(corners, line, area, name)
      real(rk), intent(in) :: corners(:, :)
      integer, intent(in) :: line(4)  !< x, y of two points
      real(rk), intent(in) :: area
      character(len=*), intent(in) :: name
      real(rk) :: ends(2, 2)

      ends = reshape(line*1.0_rk, [2, 2])
      call checks%is_close(polygon_area(left_part(corners, ends)), area, none, name)
     call checks%is_close(polygon_area(left_part(corners(:, size(corners, 2):1:-1), ends)), -area, &
                           none, name//", clockwise")
   end subroutine expect

end program test_base_clip
