!> Flows round loops of fractures: where there are loops, outlets included, and what is not known of
!> their flows.
program test_coarse_loops
   use base_kinds, only: ik, rk
   use coarse_joints, only: flows_in_loops, joints_t, unknown_flow
   use coarse_slopes, only: slopes_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   !> A ring of three cells and a chain of three.
   integer(ik), parameter :: pairs(2, 5) = reshape([1, 2, 2, 3, 3, 1, 4, 5, 5, 6], [2, 5])
   type(checks_t) :: checks
   logical, allocatable :: in_loop(:)

   in_loop = flows_in_loops(6_ik, pairs, branches(.false.))
   call checks%is_true(all(in_loop .eqv. [.true., .true., .true., .false., .false., .false., &
                                          .false.]), "the ring alone")
   in_loop = flows_in_loops(6_ik, pairs, branches(.true.))
   call checks%is_true(all(in_loop), "between two outlets too")
   call test_unknown()
   call checks%finish()

contains

   !> Both ends of the chain reach a joint each, or an outlet.
   pure function branches(are_outlets) result(joints)
      logical, intent(in) :: are_outlets
      type(joints_t) :: joints

      joints%n = 2
      joints%is_outlet = [are_outlets, are_outlets]
      joints%cell = [4_ik, 6_ik]
      joints%joint = [1_ik, 2_ik]
      joints%branches%first = [1_ik, 2_ik, 3_ik]
   end function branches

   !> Of flows 11 to 13 with resistances 2, 0.5 and 0.1 the first two are in a loop: 1 Pa drives 2.
   subroutine test_unknown()
      type(slopes_t) :: slopes
      logical, parameter :: in_loop(3) = [.true., .true., .false.]

      call slopes%clear(13_ik)
      call slopes%add(11_ik, 11_ik, 1.5_rk)
      call slopes%add(11_ik, 3_ik, -1.0_rk)
      call slopes%add(11_ik, 11_ik, 0.5_rk)  ! both cells have a part
      call slopes%add(12_ik, 12_ik, 0.5_rk)
      call slopes%add(13_ik, 13_ik, 0.1_rk)
      call slopes%add(3_ik, 3_ik, 1.0e-6_rk)
      call checks%is_close(unknown_flow(slopes, 11_ik, in_loop, 1.0_rk), 2.0_rk, 1.0e-12_rk, &
                           "by the least resistance")
      call checks%is_close(unknown_flow(slopes, 11_ik,.not. (in_loop .or. .true.), 1.0_rk), &
                           0.0_rk, 0.0_rk, "no loop")
   end subroutine test_unknown

end program test_coarse_loops
