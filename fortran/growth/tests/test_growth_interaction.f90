!> Tip interaction without a mesh: intensities that are linear in the positions of the tips.
program test_growth_interaction
   use base_kinds, only: ik, rk
   use growth_interaction, only: interaction_t
   use growth_segment, only: segment_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   integer, parameter :: n = 4
   logical, parameter :: all_evaluated(n) = .true.
   integer(ik), parameter :: all_tips(n) = [1_ik, 2_ik, 3_ik, 4_ik]
   real(rk), parameter :: own = -0.6_rk, shadow = -0.9_rk  !< per length of a segment
   type(checks_t) :: checks

   call test_measure()
   call test_learning()
   call test_not_evaluated()
   call test_matrix()
   call checks%finish()

contains

   !> Two cracks with two tips each: tips of one crack do not interact, those of the other crack
   !! shield them.
   pure function truth() result(matrix)
      real(rk) :: matrix(n, n)
      integer :: i, j

      do j = 1, n
         do i = 1, n
            matrix(i, j) = merge(0.0_rk, 0.5_rk*shadow, (i - 1)/2 == (j - 1)/2)
         end do
         matrix(j, j) = own
      end do
   end function truth

   !> Tips half way along segments of one metre.
   pure function pieces() result(segment)
      type(segment_t) :: segment(n)
      integer :: i

      do i = 1, n
         call segment(i)%open_segment([0.0_rk, real(i, rk)], [1.0_rk, 0.0_rk], 1.0_rk)
         segment(i)%reached = 0.5_rk
         segment(i)%accepted = 0.2_rk
      end do
   end function pieces

   !> Measure all columns, one tip after the other; they stay known until the tips have advanced
   !! far.
   subroutine measure(interaction, segment)
      type(interaction_t), intent(out) :: interaction
      type(segment_t), intent(in) :: segment(n)
      real(rk) :: matrix(n, n), before(n)
      integer(ik) :: j

      call interaction%begin(n)
      matrix = truth()
      before = [0.1_rk, 0.2_rk, 0.3_rk, 0.4_rk]
      do j = 1, n
         call interaction%store_column(j, -0.4_rk, before, before - 0.4_rk*matrix(:, j), &
                                       all_evaluated, segment(j))
      end do
   end subroutine measure

   subroutine test_measure()
      type(interaction_t) :: interaction
      type(segment_t) :: segment(n)

      segment = pieces()
      call interaction%begin(n)
      call checks%is_true(size(interaction%columns_to_measure(all_tips, segment)) == n, &
                          "nothing is known")
      call checks%is_true(interaction%preference_of(all_tips) < 0.0_rk, "nor said")
      call measure(interaction, segment)
      call checks%is_close(maxval(abs(interaction%matrix - truth())), 0.0_rk, 1.0e-15_rk, &
                           "measured")
      call checks%is_true(size(interaction%columns_to_measure(all_tips, segment)) == 0, &
                          "all is known")
      segment(3)%gain = 10.0_rk
      call checks%is_true(all(interaction%columns_to_measure(all_tips, segment) == [3_ik]), &
                          "one has gone far")
      ! (1, 1, -1, -1): own - shadow; the tips of one crack against each other: own.
      call checks%is_close(interaction%preference_of(all_tips), own - shadow, 1.0e-13_rk, &
                           "one crack could run ahead")
      call checks%is_close(interaction%preference_of([1_ik, 2_ik]), own, 1.0e-13_rk, &
                           "the tips of one grow together")
   end subroutine test_measure

   !> A try whose prediction errs by less than the meshes changes nothing; after one that errs more
   !! the prediction is exact. The measured values stay.
   subroutine test_learning()
      type(interaction_t) :: interaction
      type(segment_t) :: segment(n)
      real(rk) :: moved(n), other(n, n)

      segment = pieces()
      call measure(interaction, segment)
      other = 2.0_rk*truth()
      moved = [0.01_rk, 0.0_rk, -0.01_rk, 0.0_rk]
      call interaction%update(moved, matmul(other, moved), all_evaluated)
      call checks%is_close(maxval(abs(interaction%matrix - truth())), 0.0_rk, 1.0e-15_rk, &
                           "too little")
      moved = [0.3_rk, 0.1_rk, -0.2_rk, 0.0_rk]
      call interaction%update(moved, matmul(other, moved), all_evaluated)
      call checks%is_close(maxval(abs(matmul(interaction%matrix - other, moved))), 0.0_rk, &
                           1.0e-14_rk, &
                           "learnt")
      call checks%is_close(maxval(abs(interaction%measured - truth())), 0.0_rk, 1.0e-15_rk, &
                           "measured")
   end subroutine test_learning

   !> Rows of tips that are not evaluated keep what was measured, whatever their stale excess says.
   subroutine test_not_evaluated()
      type(interaction_t) :: interaction
      type(segment_t) :: segment(n)
      real(rk) :: before(n), moved(n), matrix(n, n)
      logical, parameter :: evaluated(n) = [.true., .true., .false., .true.]

      segment = pieces()
      call measure(interaction, segment)
      matrix = truth()
      before = 0.0_rk
      call interaction%store_column(1_ik, -0.4_rk, before, -0.8_rk*merge(matrix(:, 1), 0.0_rk, &
                                                                         evaluated), evaluated, &
                                    segment(1))
      call checks%is_close(maxval(abs(interaction%matrix(:, 1) &
                                      - merge(2.0_rk, 1.0_rk, evaluated)*matrix(:, 1))), 0.0_rk, &
                           1.0e-14_rk, "the row of the third tip stays in a measurement")
      call measure(interaction, segment)
      moved = [0.3_rk, 0.1_rk, 0.0_rk, 0.0_rk]
      call interaction%update(moved, merge(2.0_rk*matmul(matrix, moved), 0.0_rk, evaluated), &
                              evaluated)
      call checks%is_close(maxval(abs(interaction%matrix(3, :) - matrix(3, :))), 0.0_rk, &
                           1.0e-14_rk, "and in an update")
      call checks%is_close(maxval(abs(matmul(interaction%matrix - 2.0_rk*matrix, moved)), &
                                  mask=evaluated), 0.0_rk, 1.0e-14_rk, "the others are updated")
   end subroutine test_not_evaluated

   !> Interaction of groups: the sum over their tips, times the slope that the last search has found
   !! over the measured one, within bounds; or the slope of a segment where a tip has not been
   !! measured.
   subroutine test_matrix()
      type(interaction_t) :: interaction
      type(segment_t) :: segment(n)
      real(rk) :: all_of_it(n, n), matrix(2, 2), single(1, 1)

      all_of_it = truth()
      segment = pieces()
      segment%slope = 0.0_rk
      call measure(interaction, segment)
      single = interaction%matrix_for(all_tips, spread(1_ik, 1, n), segment(1:1))
      call checks%is_close(single(1, 1), sum(all_of_it)/n, 1.0e-14_rk, "one kind")
      matrix = interaction%matrix_for(all_tips, [1_ik, 1_ik, 2_ik, 2_ik], segment([1, 3]))
      call checks%is_close(matrix(1, 2), sum(all_of_it(:2, 3:))/2, 1.0e-14_rk, "two kinds")
      segment%slope = [0.5_rk, 0.0_rk, 100.0_rk, 0.0_rk]*sum(all_of_it)/n
      single = interaction%matrix_for(all_tips, spread(1_ik, 1, n), segment(1:1))
      call checks%is_close(single(1, 1), 0.5_rk*sum(all_of_it)/n, 1.0e-14_rk, "half as steep")
      single = interaction%matrix_for(all_tips, spread(1_ik, 1, n), segment(3:3))
      call checks%is_close(single(1, 1), 2.0_rk*sum(all_of_it)/n, 1.0e-14_rk, "at most twice")
      segment%slope = -7.0_rk
      call interaction%begin(n)
      matrix = interaction%matrix_for(all_tips, [1_ik, 1_ik, 2_ik, 2_ik], segment([1, 3]))
      call checks%is_close(maxval(abs(matrix - reshape([-7.0_rk, 0.0_rk, 0.0_rk, -7.0_rk], &
                                                       [2, 2]))), 0.0_rk, 0.0_rk, "not measured")
   end subroutine test_matrix

end program test_growth_interaction
