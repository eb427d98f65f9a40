!> Connected parts of a small network, by hand; intervals on fractures.
!!
!!         6
!!         |           9 --- 10     13
!!   1 -2- 3 -4- 5     |             \
!!         |           11             14 -- 15
!!         7 - 8
!!
!! Fractures: 1 2 3 4 5, crossed at 3 by 6 3 7, on whose end 7 the fracture 7 8 begins (V); separate
!! from these 10 9, which meets 9 11 in a V; and 13 14 15 alone.
program test_twolevel_reach
   use base_kinds, only: ik, rk
   use mesh_types, only: fracture_mesh_t, point_corner, point_interior, point_joint_x, point_tip
   use testing_checks, only: checks_t
   use twolevel_reach, only: cluster_count, connections_per_branch, reached_cells, intervals_t
   implicit none(type, external)

   integer, parameter :: n_cells = 11, n_points = 15
   integer(ik), parameter :: points(2, n_cells) = reshape( &
                             [1_ik, 2_ik, 2_ik, 3_ik, 3_ik, 4_ik, 4_ik, 5_ik, 6_ik, 3_ik, &
                              3_ik, 7_ik, 7_ik, 8_ik, 10_ik, 9_ik, 9_ik, 11_ik, 13_ik, 14_ik, &
                              14_ik, 15_ik], [2, n_cells])
   type(checks_t) :: checks
   type(fracture_mesh_t) :: network

   call make_network()
   call test_reach()
   call test_connections()
   call test_stretches()
   call checks%finish()

contains

   subroutine make_network()
      integer(ik) :: cell, p

      network%n_cells = n_cells
      network%n_points = n_points
      network%cell_fracture = [1_ik, 1_ik, 1_ik, 1_ik, 2_ik, 2_ik, 3_ik, 4_ik, 5_ik, 6_ik, 6_ik]
      network%cell_points = points
      network%point_kind = spread(point_tip, 1, n_points)
      network%point_kind([2, 4, 12, 14]) = point_interior  ! 12 is not used
      network%point_kind(3) = point_joint_x
      network%point_kind([7, 9]) = point_corner
      allocate (network%point_cells%first(n_points + 1), source=1_ik)
      allocate (network%point_cells%item(0))
      do p = 1, n_points
         network%point_cells%item = [network%point_cells%item, &
                                     pack([(cell, cell=1, n_cells)], any(points == p, dim=1))]
         network%point_cells%first(p + 1) = size(network%point_cells%item) + 1
      end do
   end subroutine make_network

   !> From cell 1 the crossing and the fracture that begins at its end; not across a cell that does
   !! not conduct.
   subroutine test_reach()
      logical :: expected(n_cells), passes(n_cells), starts(n_cells)

      starts = .false.
      starts(1) = .true.
      passes = .true.
      expected = .false.
      expected(:7) = .true.
      call checks%is_true(all(reached_cells(network, starts, passes) .eqv. expected), &
                          "through crossing and corner")
      passes(6) = .false.
      expected(6:7) = .false.
      call checks%is_true(all(reached_cells(network, starts, passes) .eqv. expected), &
                          "not through what does not pass")
      passes(1) = .false.
      call checks%is_true(.not. any(reached_cells(network, starts, passes)), &
                          "nor from what does not")
      starts(11) = .true.
      expected = .false.
      expected(10:11) = .true.
      call checks%is_true(all(reached_cells(network, starts, passes) .eqv. expected), &
                          "from two places")
   end subroutine test_reach

   !> Three groups. Branches: 1-3, 3-5, 6-3, 3-7-8, 10-9-11, 13-15: 6 with 8 free ends and 4
   !! connected ones, C_B = 4/6.
   subroutine test_connections()
      type(fracture_mesh_t) :: none

      call checks%is_true(cluster_count(network) == 3, "groups")
      call checks%is_close(connections_per_branch(network), 4.0_rk/6.0_rk, 1.0e-15_rk, "C_B")
      call checks%is_true(cluster_count(none) == 0, "no group without fractures")
      call checks%is_close(connections_per_branch(none), 0.0_rk, 0.0_rk, "and nothing connected")
   end subroutine test_connections

   !> Intervals are merged with those that they meet, on the same fracture.
   subroutine test_stretches()
      type(intervals_t) :: stretches

      call stretches%clear()
      call checks%is_close(stretches%length(), 0.0_rk, 0.0_rk, "none")
      call stretches%add(1_ik, [0.0_rk, 1.0_rk])
      call stretches%add(1_ik, [3.0_rk, 4.0_rk])
      call stretches%add(2_ik, [0.5_rk, 3.5_rk])
      call stretches%add(1_ik, [2.0_rk, 2.0_rk])
      call checks%is_true(size(stretches%fracture) == 3, "three, and none without length")
      call checks%is_close(stretches%length(), 5.0_rk, 1.0e-15_rk, "length of three")
      call stretches%add(1_ik, [1.0_rk, 3.25_rk])
      call checks%is_true(size(stretches%fracture) == 2, "one between two makes them one")
      call checks%is_close(stretches%length(), 7.0_rk, 1.0e-15_rk, "with the length of all")
    call checks%is_true(stretches%covers(1_ik, 2.0_rk) .and. .not. stretches%covers(2_ik, 0.2_rk), &
                          "what they cover")
   end subroutine test_stretches

end program test_twolevel_reach
