!> Lists of different lengths: the example of the module's header, and tables turned into lists.
program test_base_lists
   use base_kinds, only: ik
   use base_lists, only: inverted, lists_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   type(checks_t) :: checks

   call reads_lists()
   call inverts_cells()
   call inverts_with_gaps()
   call inverts_nothing()
   call checks%finish()

contains

   !> (7 2) () (5 9 1)
   subroutine reads_lists()
      type(lists_t) :: lists

      lists = lists_t(first=[1_ik, 3_ik, 3_ik, 6_ik], item=[7_ik, 2_ik, 5_ik, 9_ik, 1_ik])
      call checks%is_true(lists%length(1_ik) == 2, "a list of two")
      call checks%is_true(lists%length(2_ik) == 0, "an empty list")
      call checks%is_true(lists%last(2_ik) == 2, "an empty list ends before it begins")
      call checks%is_true(size(lists%of(2_ik)) == 0, "an empty list has no numbers")
      call checks%is_true(all(lists%of(3_ik) == [5_ik, 9_ik, 1_ik]), "the numbers of a list")
      call checks%is_true(lists%at(3_ik, 2_ik) == 9, "one number of a list")
      call checks%is_true(lists%place(3_ik, 1_ik) == 3, "the place of a number")
      call checks%is_true(lists%place(1_ik, 5_ik) == 0, "a number of another list is not found")
      call checks%is_true(lists%place(2_ik, 7_ik) == 0, "nothing is found in an empty list")
   end subroutine reads_lists

   !> Two triangles with a common edge: cells around each node.
   subroutine inverts_cells()
      type(lists_t) :: cells

      cells = inverted(reshape([1_ik, 2_ik, 3_ik, 3_ik, 2_ik, 4_ik], [3, 2]), 4_ik)
      call checks%is_true(all(cells%first == [1_ik, 2_ik, 4_ik, 6_ik, 7_ik]), "cells by node")
      call checks%is_true(all(cells%item == [1_ik, 1_ik, 2_ik, 1_ik, 2_ik, 2_ik]), &
                          "cells of each node in their order")
   end subroutine inverts_cells

   !> Zeros count for nobody, a number may stand nowhere, and twice in one column counts twice.
   subroutine inverts_with_gaps()
      type(lists_t) :: columns

      columns = inverted(reshape([3_ik, 0_ik, 0_ik, 0_ik, 1_ik, 1_ik], [2, 3]), 3_ik)
      call checks%is_true(all(columns%of(1_ik) == [3_ik, 3_ik]), "twice in a column")
      call checks%is_true(columns%length(2_ik) == 0, "a number that stands nowhere")
      call checks%is_true(all(columns%of(3_ik) == [1_ik]), "zeros are passed over")
      call checks%is_true(size(columns%item) == 3, "nothing else")
   end subroutine inverts_with_gaps

   subroutine inverts_nothing()
      type(lists_t) :: columns
      integer(ik) :: table(2, 0)

      columns = inverted(table, 0_ik)
      call checks%is_true(size(columns%first) == 1 .and. size(columns%item) == 0, "no lists")
   end subroutine inverts_nothing

end program test_base_lists
