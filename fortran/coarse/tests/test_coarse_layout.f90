!> Where unknowns stand: each number is taken once, in the order that the modules rely on.
program test_coarse_layout
   use base_kinds, only: ik
   use coarse_layout, only: at_component, block_count, condensed_layout_t, end_block, &
                            end_of_block, fracture_cell_of_block, fracture_layout_t
   use mesh_types, only: mesh_t
   use testing_checks, only: checks_t
   implicit none(type, external)

   integer(ik), parameter :: both(2) = [1_ik, 2_ik]  !< ends or sides
   type(checks_t) :: checks

   call test_condensed()
   call test_fractures()
   call test_blocks()
   call checks%finish()

contains

   !> The order that coarse_condensed states for q.
   subroutine test_condensed()
      type(condensed_layout_t) :: layout
      integer(ik) :: i, k
      integer(ik), allocatable :: found(:)

      layout = condensed_layout_t(3_ik)
      call checks%is_true(layout%count() == 18, "six numbers per cell")
      found = [integer(ik) ::]
      do i = 1, 3
         do k = 1, 2
            found = [found, layout%at_jump(i, k), layout%at_jump(i, k) + 1, &
                     layout%at_face_pressure(i, k)]
         end do
      end do
      call checks%is_true(all(found == [(i, i=1, 18)]), "jump at start, p+, jump at end, p-")
   end subroutine test_condensed

   !> Cells, then flows, then branches, wells and joints.
   subroutine test_fractures()
      type(fracture_layout_t) :: layout
      integer(ik) :: i, k
      integer(ik), allocatable :: found(:)

      layout = fracture_layout_t(3_ik, 7_ik, 2_ik, 4_ik, 2_ik, 1_ik)
      call checks%is_true(layout%cell_count() == 21, "seven numbers per cell")
      call checks%is_true(layout%count() == 30, "and one per flow, branch, well, joint")
      found = [integer(ik) ::]
      do i = 1, 3
         do k = 1, 2
            found = [found, layout%at_jump(i, k), layout%at_jump(i, k) + 1, &
                     layout%at_face_pressure(i, k)]
         end do
         found = [found, layout%at_pressure(i)]
      end do
      do k = 1, 2
         found = [found, layout%at_flow(k)]
      end do
      do k = 1, 4
         found = [found, layout%at_branch(k)]
      end do
      do k = 1, 2
         found = [found, layout%at_well(k)]
      end do
      found = [found, layout%at_joint(1_ik)]
 call checks%is_true(all(found == [(i, i=1, 30)]), "those of the cells as in q, p_F; flows; joints")
   end subroutine test_fractures

   !> Cells, then two blocks per fracture cell; three components each.
   subroutine test_blocks()
      type(mesh_t) :: mesh
      integer(ik) :: b, c, i, k

      mesh%n_cells = 5
      mesh%fracture%n_cells = 3
      call checks%is_true(block_count(mesh) == 11, "number of blocks")
      call checks%is_true(all(end_block(mesh, 1_ik, both) == [6, 7]), "blocks after those of cells")
      do i = 1, 3
         do k = 1, 2
            b = end_block(mesh, i, k)
            call checks%is_true(fracture_cell_of_block(mesh, b) == i, "the cell of a block")
            call checks%is_true(end_of_block(mesh, b) == k, "the end of a block")
         end do
      end do
      call checks%is_true(all([((at_component(b, c), c=1, 3), b=1, 4)] == [(i, i=1, 12)]), &
                          "components block by block")
   end subroutine test_blocks

end program test_coarse_layout
