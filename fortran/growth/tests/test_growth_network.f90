!> Growing networks: vertices at both ends, arc lengths, growth of ends, straight ends.
program test_growth_network
   use base_kinds, only: ik, rk
   use growth_network, only: end_direction, end_gain, end_vertices, extend, network_of_scene, &
                             straighten_end, total_length
   use mesh_types, only: network_t
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks

   call test_scene()
   call test_extend()
   call test_straighten()
   call checks%finish()

contains

   !> Two fractures: a right angle with legs of 3 m and 4 m, and a segment of 1 m above it.
   function sample_scene() result(scene)
      type(scene_t) :: scene

      allocate (scene%fractures(2))
      scene%fractures(1)%x = [0.0_rk, 3.0_rk, 3.0_rk]
      scene%fractures(1)%y = [0.0_rk, 0.0_rk, 4.0_rk]
      scene%fractures(2)%x = [0.0_rk, 1.0_rk]
      scene%fractures(2)%y = [2.0_rk, 2.0_rk]
   end function sample_scene

   subroutine test_scene()
      type(network_t) :: network
      type(scene_t) :: empty

      network = network_of_scene(sample_scene())
      call checks%is_true(all(network%first == [1_ik, 4_ik, 6_ik]), "first vertices")
      call checks%is_close(maxval(abs(network%xy - reshape([0.0_rk, 0.0_rk, 3.0_rk, 0.0_rk, &
                                                            3.0_rk, 4.0_rk, 0.0_rk, 2.0_rk, &
                                                            1.0_rk, 2.0_rk], [2, 5]))), 0.0_rk, &
                           0.0_rk, "vertices")
      call checks%is_close(maxval(abs(network%s_start)), 0.0_rk, 0.0_rk, "arc lengths from 0")
      call checks%is_close(total_length(network), 8.0_rk, 1.0e-15_rk, "length of all")
      network = network_of_scene(empty)
      call checks%is_true(size(network%first) == 1 .and. size(network%xy, 2) == 0, "no fractures")
      call checks%is_close(total_length(network), 0.0_rk, 0.0_rk, "no length")
   end subroutine test_scene

   !> Growth at both ends of both fractures: order of the vertices, arc lengths, and growth of each
   !! end.
   subroutine test_extend()
      type(network_t) :: network, start

      start = network_of_scene(sample_scene())
      network = start
      call extend(network, 1_ik, 1_ik, [-0.3_rk, 0.4_rk])
      call extend(network, 1_ik, 2_ik, [3.0_rk, 4.25_rk])
      call extend(network, 1_ik, 1_ik, [-0.3_rk, 0.6_rk])
      call extend(network, 2_ik, 2_ik, [1.6_rk, 2.8_rk])
      call extend(network, 2_ik, 1_ik, [-0.125_rk, 2.0_rk])
      call checks%is_true(all(network%first == [1_ik, 7_ik, 11_ik]), "first vertices after growth")
      call checks%is_close(maxval(abs(network%xy - reshape([-0.3_rk, 0.6_rk, -0.3_rk, 0.4_rk, &
                                                            0.0_rk, 0.0_rk, 3.0_rk, 0.0_rk, &
                                                            3.0_rk, 4.0_rk, 3.0_rk, 4.25_rk, &
                                                            -0.125_rk, 2.0_rk, 0.0_rk, 2.0_rk, &
                                                            1.0_rk, 2.0_rk, 1.6_rk, 2.8_rk], &
                                                           [2, 10]))), 0.0_rk, 0.0_rk, &
                           "vertices after growth")
      call checks%is_close(network%s_start(1), -0.7_rk, 1.0e-15_rk, "arc length of the new start")
      call checks%is_close(network%s_start(2), -0.125_rk, 1.0e-15_rk, "the same of the other one")
      call checks%is_close(total_length(network), 8.0_rk + 0.7_rk + 0.25_rk + 1.0_rk + 0.125_rk, &
                           1.0e-14_rk, "length after growth")
      call checks%is_close(end_gain(network, start, 1_ik, 1_ik), 0.7_rk, 1.0e-15_rk, &
                           "gain 1, start")
      call checks%is_close(end_gain(network, start, 1_ik, 2_ik), 0.25_rk, 1.0e-14_rk, "gain 1, end")
      call checks%is_close(end_gain(network, start, 2_ik, 1_ik), 0.125_rk, 1.0e-15_rk, &
                           "gain 2, start")
      call checks%is_close(end_gain(network, start, 2_ik, 2_ik), 1.0_rk, 1.0e-15_rk, "gain 2, end")
   end subroutine test_extend

   !> Vertices added at both ends of a fracture are counted, and replaced by straight segments: the
   !! other lengths and the arc lengths of the old vertices stay.
   subroutine test_straighten()
      type(network_t) :: network, start

      start = network_of_scene(sample_scene())
      network = start
      call extend(network, 1_ik, 1_ik, [-0.3_rk, 0.4_rk])
      call extend(network, 1_ik, 1_ik, [-0.6_rk, 0.0_rk])
      call extend(network, 1_ik, 2_ik, [3.3_rk, 4.4_rk])
      call extend(network, 1_ik, 2_ik, [3.0_rk, 4.8_rk])
      call extend(network, 2_ik, 2_ik, [1.6_rk, 2.8_rk])
      call checks%is_true(end_vertices(network, start, 1_ik, 1_ik) == 2, "two at the start")
      call checks%is_true(end_vertices(network, start, 1_ik, 2_ik) == 2, "two at the end")
      call checks%is_true(end_vertices(network, start, 2_ik, 1_ik) == 0, "none")
      call checks%is_true(end_vertices(network, start, 2_ik, 2_ik) == 1, "one")
      call checks%is_close(norm2(end_direction(network, 1_ik, 1_ik) - [-0.6_rk, -0.8_rk]), 0.0_rk, &
                           1.0e-15_rk, "direction of the start")
      call straighten_end(network, 1_ik, 1_ik, 1_ik)
      call straighten_end(network, 1_ik, 2_ik, 1_ik)
      call checks%is_true(all(network%first == [1_ik, 6_ik, 9_ik]), "first vertices")
      call checks%is_close(maxval(abs(network%xy - reshape([-0.6_rk, 0.0_rk, 0.0_rk, 0.0_rk, &
                                                            3.0_rk, 0.0_rk, 3.0_rk, 4.0_rk, &
                                                            3.0_rk, 4.8_rk, 0.0_rk, 2.0_rk, &
                                                            1.0_rk, 2.0_rk, 1.6_rk, 2.8_rk], &
                                                           [2, 8]))), 0.0_rk, 0.0_rk, "vertices")
      call checks%is_close(network%s_start(1), -0.6_rk, 1.0e-15_rk, "arc length of the start")
      call checks%is_close(end_gain(network, start, 1_ik, 1_ik), 0.6_rk, 1.0e-15_rk, "gain, start")
      call checks%is_close(end_gain(network, start, 1_ik, 2_ik), 0.8_rk, 1.0e-14_rk, "gain, end")
      call checks%is_close(norm2(end_direction(network, 1_ik, 2_ik) - [0.0_rk, 1.0_rk]), 0.0_rk, &
                           1.0e-15_rk, "direction of the end")
   end subroutine test_straighten

end program test_growth_network
