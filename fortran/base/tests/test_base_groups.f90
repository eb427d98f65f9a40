!> Groups of members joined in various orders.
program test_base_groups
   use base_groups, only: groups_t, single_groups
   use base_kinds, only: ik
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks
   type(groups_t) :: groups
   logical :: were_joined

   groups = single_groups(6_ik)
   call checks%is_true(groups%count_groups() == 6, "six alone")
   call numbers_are([1, 2, 3, 4, 5, 6], "numbers of six alone")
   call groups%join(5_ik, 6_ik, were_joined)
   call checks%is_true(.not. were_joined, "5 and 6 were apart")
   call groups%join(3_ik, 5_ik)
   call groups%join(2_ik, 4_ik)
   call numbers_are([1, 2, 3, 2, 3, 3], "numbered by their smallest members")
   call groups%join(6_ik, 3_ik, were_joined)
   call checks%is_true(were_joined, "6 and 3 were joined by way of 5")
   call groups%join(1_ik, 1_ik, were_joined)
   call checks%is_true(were_joined, "every member is joined with itself")
   call checks%is_true(groups%count_groups() == 3, "three groups")
   call groups%join(6_ik, 4_ik)
   call groups%join(4_ik, 1_ik)
   call checks%is_true(groups%count_groups() == 1, "one group")
   call numbers_are([1, 1, 1, 1, 1, 1], "all in one")

   groups = single_groups(0_ik)
   call checks%is_true(groups%count_groups() == 0, "nobody")
   call checks%is_true(size(groups%numbers()) == 0, "no numbers")

   call join_in_chains(1000_ik)
   call checks%finish()

contains

   subroutine numbers_are(expected, name)
      integer, intent(in) :: expected(:)
      character(len=*), intent(in) :: name

      call checks%is_true(all(groups%numbers() == expected), name)
   end subroutine numbers_are

   !> Even with even, odd with odd, from the last to the first: the longest ways there are.
   subroutine join_in_chains(n)
      integer(ik), intent(in) :: n
      integer(ik) :: member

      groups = single_groups(n)
      do member = n - 2, 1, -1
         call groups%join(member, member + 2)
      end do
      call checks%is_true(groups%count_groups() == 2, "even and odd")
      call numbers_are([(2 - mod(member, 2), member=1, n)], "numbers of even and odd")
      call groups%join(n - 1, n)
      call checks%is_true(groups%count_groups() == 1, "even with odd")
   end subroutine join_in_chains

end program test_base_groups
