!> Pattern of the coarse matrix: blocks that share a stencil, and those that layers couple.
module coarse_pattern
   use base_kinds, only: ik, rk
   use base_lists, only: inverted, lists_t
   use coarse_layout, only: bulk_count, end_block, layer_block
   use coarse_matrix, only: matrix_t
   use coarse_regions, only: regions_t
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: find_pattern

contains

   !> Find the pattern of the matrix: blocks that share a region.
   subroutine find_pattern(mesh, regions, matrix)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      type(matrix_t), intent(inout) :: matrix
      integer(ik), allocatable :: last_row(:), found(:)
      integer(ik) :: i, k, n, r, side
      type(lists_t) :: coupled  ! blocks that layers couple

      matrix%n_blocks = regions%n_blocks
      matrix%n_cells = bulk_count(mesh)
      if (mesh%n_layers > 0) coupled = blocks_coupled(mesh, regions)
      allocate (matrix%columns%first(matrix%n_blocks + 1))
      allocate (last_row(matrix%n_blocks), source=0_ik)
      allocate (found(20*matrix%n_blocks))
      n = 0
      do i = 1, matrix%n_blocks
         matrix%columns%first(i) = n + 1
         last_row(i) = i
         do side = 1, 3
            r = regions%regions_of_block(side, i)
            if (r == 0) cycle
            do k = regions%blocks%first(r), regions%blocks%last(r)
               call note(regions%blocks%item(k))
            end do
         end do
         if (mesh%n_layers > 0) then
            do k = coupled%first(i), coupled%last(i)
               call note(coupled%item(k))
            end do
         end if
         n = n + 1
         found(n) = i
      end do
      matrix%columns%first(matrix%n_blocks + 1) = n + 1
      matrix%columns%item = found(:n)
      if (mesh%n_layers > 0) call number_layer_entries(mesh, coupled, matrix)
      allocate (matrix%elastic(3, 3, n), matrix%flow(n), source=0.0_rk)
      allocate (matrix%elastic_known(3, matrix%n_blocks), source=0.0_rk)
      allocate (matrix%flow_known(matrix%n_blocks), matrix%storage(mesh%n_cells), source=0.0_rk)

   contains

      !> Note a block of row i, unless it stands above the diagonal or is known.
      subroutine note(block)
         integer(ik), intent(in) :: block

         if (block > i) return
         if (last_row(block) == i) return
         last_row(block) = i
         n = n + 1
         if (n + 1 > size(found)) found = [found, found]
         found(n) = block
      end subroutine note

   end subroutine find_pattern

   !> Blocks of smaller number, or the same, that layers couple with each block: those of one cell
   !! and its layers, and those that share a stencil of flow.
   function blocks_coupled(mesh, regions) result(coupled)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      type(lists_t) :: coupled
      integer(ik), allocatable :: pair(:, :), block(:)
      integer(ik) :: c, k, l, n, r

      allocate (pair(2, 1000))
      n = 0
      do r = 1, regions%n_regions
         block = (regions%scalars%of(r) + 2)/3
         if (.not. any(block > mesh%n_cells .and. block <= bulk_count(mesh))) cycle
         call add_pairs(block)
      end do
      do c = 1, mesh%n_cells
         if (mesh%cell_layer(c) == 0) cycle
         block = [c]
         do k = 1, 3
            associate (f => mesh%cell_faces(k, c))
               l = mesh%face_layer(f)
               if (l == 0) cycle
               block = [block, layer_block(mesh, l)]
               associate (cell => mesh%face_fracture_cell(f))
                  if (cell == 0) cycle
                  block = [block, end_block(mesh, cell, findloc(mesh%fracture%cell_faces(:, cell), &
                                                                f, dim=1, kind=ik))]
               end associate
            end associate
         end do
         call add_pairs(block)
      end do
      coupled = inverted(pair(1:1, :n), regions%n_blocks)
      coupled%item = pair(2, coupled%item)

   contains

      !> Add all pairs of some blocks.
      subroutine add_pairs(blocks)
         integer(ik), intent(in) :: blocks(:)
         integer(ik) :: a, b

         do a = 1, size(blocks, kind=ik)
            do b = 1, size(blocks, kind=ik)
               if (blocks(b) > blocks(a)) cycle
               if (n == size(pair, 2)) call enlarge()
               n = n + 1
               pair(:, n) = [blocks(a), blocks(b)]
            end do
         end do
      end subroutine add_pairs

      subroutine enlarge()
         integer(ik), allocatable :: larger(:, :)

         allocate (larger(2, 2*n))
         larger(:, :n) = pair(:, :n)
         call move_alloc(larger, pair)
      end subroutine enlarge

   end function blocks_coupled

   !> Number the entries that layers add to.
   subroutine number_layer_entries(mesh, coupled, matrix)
      type(mesh_t), intent(in) :: mesh
      type(lists_t), intent(in) :: coupled
      type(matrix_t), intent(inout) :: matrix
      integer(ik) :: entry, i, k, n

      allocate (matrix%of_layers(size(matrix%columns%item)), source=0_ik)
      n = 0
      do i = 1, matrix%n_blocks
         do k = coupled%first(i), coupled%last(i)
            entry = matrix%entry_at(i, coupled%item(k))
            if (matrix%of_layers(entry) > 0) cycle
            n = n + 1
            matrix%of_layers(entry) = n
         end do
      end do
      allocate (matrix%layer_flow(3, 3, n), matrix%layer_terms(3, 3, n), source=0.0_rk)
      allocate (matrix%layer_known(2, mesh%n_layers), source=0.0_rk)
   end subroutine number_layer_entries

end module coarse_pattern
