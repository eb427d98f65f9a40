!> Points where growing tips meet fractures and the boundary.
program test_growth_targets
   use base_kinds, only: ik, rk
   use growth_targets, only: find_ahead, find_beside, find_target, target_boundary, target_none
   use mesh_types, only: network_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   real(rk), parameter :: reach = 0.1_rk, round_off = 1.0e-14_rk
   type(checks_t) :: checks
   type(network_t) :: network
   real(rk), allocatable :: corners(:, :)

   ! Fracture 1 grows; fracture 2 is the polyline (2, -1), (2, 1), (3, 1); the body [-4, 4]^2.
   network%first = [1_ik, 3_ik, 6_ik]
   network%xy = reshape([0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 2.0_rk, -1.0_rk, 2.0_rk, 1.0_rk, 3.0_rk, &
                         1.0_rk], [2, 5])
   network%s_start = [0.0_rk, 0.0_rk]
   corners = reshape([-4.0_rk, -4.0_rk, 4.0_rk, -4.0_rk, 4.0_rk, 4.0_rk, -4.0_rk, 4.0_rk], [2, 4])
   call meets([1.0_rk, 0.0_rk], [1.5_rk, 0.0_rk], target_none, [1.5_rk, 0.0_rk], "far away")
   call meets([1.0_rk, 0.0_rk], [1.89_rk, 0.2_rk], target_none, [1.89_rk, 0.2_rk], "out of reach")
   call meets([1.0_rk, 0.0_rk], [1.91_rk, 0.2_rk], 2_ik, [2.0_rk, 0.2_rk], "within reach")
   call meets([1.5_rk, 0.0_rk], [2.5_rk, 0.5_rk], 2_ik, [2.0_rk, 0.25_rk], "across")
   call meets([1.0_rk, 1.5_rk], [2.6_rk, -0.1_rk], 2_ik, [2.0_rk, 0.5_rk], "the first crossing")
   call meets([1.0_rk, 0.0_rk], [1.95_rk, 0.99_rk], 2_ik, [2.0_rk, 1.0_rk], "a vertex")
   call meets([-3.0_rk, 0.0_rk], [-3.95_rk, 0.3_rk], target_boundary, [-4.0_rk, 0.3_rk], &
              "the boundary")
   call meets([-3.0_rk, 0.0_rk], [-5.0_rk, 0.0_rk], target_boundary, [-4.0_rk, 0.0_rk], &
              "out of the body")

   call meets([-3.95_rk, 0.0_rk], [-4.05_rk, 2.0_rk], target_boundary, [-4.0_rk, 0.0_rk], &
              "out of the body at 3 degrees: to the nearest place")
   call meets([-3.95_rk, 0.0_rk], [-4.05_rk, 0.9_rk], target_boundary, [-4.0_rk, 0.45_rk], &
              "out of the body at 6 degrees")

   ! A hook (0, 0), (1, 0), (1, 0.5), (0.5, 0.5) that turns back to its first segment.
   network%first = [1_ik, 5_ik]
   network%xy = reshape([0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 1.0_rk, 0.5_rk, 0.5_rk, 0.5_rk], [2, 4])
   network%s_start = [0.0_rk]
   call meets([0.5_rk, 0.5_rk], [0.45_rk, 0.4_rk], target_none, [0.45_rk, 0.4_rk], "a hook")
   call meets([0.5_rk, 0.5_rk], [0.3_rk, 0.05_rk], 1_ik, [0.3_rk, 0.0_rk], "near itself")
   call meets([0.5_rk, 0.5_rk], [0.5_rk, -0.1_rk], 1_ik, [0.5_rk, 0.0_rk], "across itself")
   call meets([0.5_rk, 0.5_rk], [0.47_rk, 0.52_rk], target_none, [0.47_rk, 0.52_rk], &
              "a short segment behind which it has come")
   network%xy(:, 4) = [0.97_rk, 0.53_rk]
   call meets([0.97_rk, 0.53_rk], [0.93_rk, 0.55_rk], target_none, [0.93_rk, 0.55_rk], &
              "near the segment before the last, which it leaves")

   call look_ahead()
   call look_beside()
   call joints_nearby()
   call checks%finish()

contains

   !> A tip that runs along fracture 2 at a distance of 0.005 has reached it; at 0.015 it has not.
   subroutine look_beside()
      real(rk) :: at(2)
      integer(ik) :: target

      network%first = [1_ik, 3_ik, 5_ik]
      network%xy = reshape([0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 0.5_rk, 0.105_rk, 3.0_rk, 0.105_rk], &
                           [2, 4])
      network%s_start = [0.0_rk, 0.0_rk]
      call find_beside(network, corners, 1_ik, [1.0_rk, 0.0_rk], [1.5_rk, 0.1_rk], 0.01_rk, &
                       target, at)
      call checks%is_true(target == 2, "beside it")
      call checks%is_close(norm2(at - [1.5_rk, 0.105_rk]), 0.0_rk, round_off, "its nearest place")
      call find_beside(network, corners, 1_ik, [1.0_rk, 0.0_rk], [1.5_rk, 0.09_rk], 0.01_rk, &
                       target, at)
      call checks%is_true(target == target_none, "not beside it")
      call find_beside(network, corners, 1_ik, [3.0_rk, 0.0_rk], [3.995_rk, -1.0_rk], 0.01_rk, &
                       target, at)
      call checks%is_true(target == target_boundary, "beside a side")
   end subroutine look_beside

   !> A connection 0.004 away from the crossing of fractures 2 and 3 is moved there, and a
   !! connection as near to the end of fracture 4 on fracture 2, there.
   subroutine joints_nearby()
      real(rk) :: at(2)
      integer(ik) :: target

      network%first = [1_ik, 3_ik, 5_ik, 7_ik, 9_ik]
      network%xy = reshape([0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 2.0_rk, -1.0_rk, 2.0_rk, 1.0_rk, &
                            1.9_rk, 0.1_rk, 2.2_rk, 0.4_rk, 2.0_rk, -0.5_rk, 2.5_rk, -0.5_rk], &
                           [2, 8])
      network%s_start = spread(0.0_rk, 1, 4)
      call sees([1.0_rk, 0.196_rk], [1.5_rk, 0.0_rk], 3_ik, [2.0_rk, 0.2_rk], "a crossing nearby")
      ! At equal distances rounding decides between the two.
      call find_ahead(network, corners, 1_ik, [1.0_rk, -0.496_rk], [1.5_rk, 0.0_rk], 0.03_rk, &
                      target, at)
      call checks%is_close(norm2(at - [2.0_rk, -0.5_rk]), 0.0_rk, round_off, "a T nearby")
      call sees([1.0_rk, -0.3_rk], [1.5_rk, 0.0_rk], 2_ik, [2.0_rk, -0.3_rk], "no joint nearby")
   end subroutine joints_nearby

   !> Straight ahead only: fracture 2 is the polyline (2, -1), (2, 1), (3, 1), fracture 3 goes from
   !! (-2, 0) on to the left.
   subroutine look_ahead()
      network%first = [1_ik, 3_ik, 6_ik, 8_ik]
      network%xy = reshape([0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 2.0_rk, -1.0_rk, 2.0_rk, 1.0_rk, &
                            3.0_rk, 1.0_rk, -2.0_rk, 0.0_rk, -3.0_rk, 0.5_rk], [2, 7])
      network%s_start = [0.0_rk, 0.0_rk, 0.0_rk]
      call sees([1.0_rk, 0.0_rk], [0.9_rk, 0.0_rk], target_none, [1.9_rk, 0.0_rk], "too far")
      call sees([1.0_rk, 0.0_rk], [1.1_rk, 0.22_rk], 2_ik, [2.0_rk, 0.2_rk], "within reach")
      call sees([1.95_rk, 0.0_rk], [0.0_rk, 0.9_rk], target_none, [1.95_rk, 0.9_rk], &
                "beside it, however near")
      call sees([1.0_rk, 0.0_rk], [1.5_rk, 1.47_rk], 2_ik, [2.0_rk, 1.0_rk], "almost at a vertex")
      call sees([1.0_rk, 0.0_rk], [1.2_rk, -1.206_rk], 2_ik, [2.0_rk, -1.0_rk], "just past an end")
      call sees([1.0_rk, 0.0_rk], [1.2_rk, -1.3_rk], target_none, [2.2_rk, -1.3_rk], "past an end")
      call sees([0.0_rk, 0.0_rk], [-2.5_rk, 0.0_rk], 3_ik, [-2.0_rk, 0.0_rk], "tip to tip")
      call sees([1.0_rk, 0.0_rk], [0.0_rk, -5.0_rk], target_boundary, [1.0_rk, -4.0_rk], "a side")
      call sees([1.99_rk, 0.0_rk], [0.02_rk, 1.0_rk], 2_ik, [2.0_rk, 0.0_rk], &
                "at one degree: to the nearest place")
      ! A hook returns to its first segment, but not to those next to its tip.
      network%first = [1_ik, 5_ik]
      network%xy = reshape([0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk, 1.0_rk, 0.5_rk, 0.5_rk, 0.5_rk], [2, 4])
      network%s_start = [0.0_rk]
      call sees([0.5_rk, 0.5_rk], [0.0_rk, -1.0_rk], 1_ik, [0.5_rk, 0.0_rk], "itself")
      call sees([0.5_rk, 0.5_rk], [-0.4_rk, 0.0_rk], target_none, [0.1_rk, 0.5_rk], "away from it")
   end subroutine look_ahead

   subroutine sees(from, way, expected, place, name)
      real(rk), intent(in) :: from(2), way(2), place(2)
      integer(ik), intent(in) :: expected
      character(len=*), intent(in) :: name
      real(rk), parameter :: near = 0.03_rk
      integer(ik) :: found
      real(rk) :: at(2)

      call find_ahead(network, corners, 1_ik, from, way, near, found, at)
      call checks%is_true(found == expected, "ahead, "//name//": what")
      call checks%is_close(norm2(at - place), 0.0_rk, round_off, "ahead, "//name//": where")
   end subroutine sees

   subroutine meets(from, to, expected, place, name)
      real(rk), intent(in) :: from(2), to(2), place(2)
      integer(ik), intent(in) :: expected
      character(len=*), intent(in) :: name
      integer(ik) :: found
      real(rk) :: at(2)

      call find_target(network, corners, 1_ik, from, to, reach, found, at)
      call checks%is_true(found == expected, name//": what")
      call checks%is_close(norm2(at - place), 0.0_rk, round_off, name//": where")
   end subroutine meets

end program test_growth_targets
