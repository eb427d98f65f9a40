!> The matrix of the coarse level: cells and fracture cells in blocks of three (see coarse_regions).
!!
!! Rows: balance of forces on a cell [N/m]; its fluid content, negated [m2]; force through an end of
!! a fracture cell, negated [N/m]; fluid that leaves the rock through a fracture face within the
!! step [m2]. The matrix is symmetric and quasi-definite: positive for displacements, negative for
!! pressures. It is kept as elastic - and - flow parts, so that a new time step needs no new
!! discretization: matrix = elastic + dt*flow.
module coarse_matrix
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use coarse_regions, only: find_regions, regions_t
   use coarse_rock, only: rock_t
   use coarse_stencil, only: region_matrix_t, solve_region
   use mesh_types, only: mesh_t
   use scene_types, only: boundary_side_t
   implicit none(type, external)
   private

   public :: cell_area, discretize, matrix_t

   !> Lower triangle in blocks, by rows; the diagonal block is the last one of its row.
   type :: matrix_t
      integer(ik) :: n_blocks = 0
      integer(ik) :: n_cells = 0
      integer(ik), allocatable :: row_first(:)  !< (n_blocks+1) into col
      integer(ik), allocatable :: col(:)
      real(rk), allocatable :: elastic(:, :, :)  !< (3, 3, n_entries)
      real(rk), allocatable :: flow(:)  !< (n_entries) of the pressures, per second
      !> (3, n_blocks) right-hand side of the boundary data
      real(rk), allocatable :: elastic_known(:, :)
      real(rk), allocatable :: flow_known(:)  !< (n_blocks) the same for the fluid, per second
      !> (n_cells) content per pressure at fixed traction [m2/Pa]
      real(rk), allocatable :: storage(:)
   end type matrix_t

contains

   !> Discretize Biot's equations on the mesh: responses in the regions and the global matrix.
   subroutine discretize(mesh, rock, sides, regions, matrix, error)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(boundary_side_t), intent(in) :: sides(:)
      type(regions_t), intent(out) :: regions
      type(matrix_t), intent(out) :: matrix
      type(error_t), allocatable, intent(out) :: error

      type(region_matrix_t) :: local
      integer(ik) :: c, info, r
      character(len=80) :: place

      call find_regions(mesh, regions)
      call find_pattern(mesh, regions, matrix)
      do r = 1, regions%n_regions
         call solve_region(mesh, rock, sides, r, regions, local, info)
         if (info /= 0) then
            associate (xy => mesh%xy(:, regions%nodes(regions%node_first(r))))
               write (place, "(a,es12.5,a,es12.5,a)") "(", xy(1), ",", xy(2), ")"
            end associate
            call raise_error(error, "coarse_matrix", "degenerate cells around the mesh node at "// &
                             place)
            return
         end if
         call add_region(regions, r, local, matrix)
      end do
      do c = 1, mesh%n_cells
         matrix%storage(c) = cell_area(mesh, c)*(rock%storage &
                                                 + rock%biot**2/(rock%lame + rock%shear))
         associate (diagonal => matrix%row_first(c + 1) - 1)
            matrix%elastic(3, 3, diagonal) = matrix%elastic(3, 3, diagonal) - matrix%storage(c)
         end associate
      end do
   end subroutine discretize

   !> Which blocks meet in some region.
   subroutine find_pattern(mesh, regions, matrix)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      type(matrix_t), intent(inout) :: matrix

      integer(ik), allocatable :: last_row(:), found(:)
      integer(ik) :: i, j, n, r, around(3), n_around

      matrix%n_blocks = regions%n_blocks
      matrix%n_cells = mesh%n_cells
      allocate (matrix%row_first(matrix%n_blocks + 1))
      allocate (last_row(matrix%n_blocks), source=0_ik)
      allocate (found(20*matrix%n_blocks))
      n = 0
      do i = 1, matrix%n_blocks
         matrix%row_first(i) = n + 1
         if (i <= mesh%n_cells) then
            around = regions%region_of_node(mesh%cell_nodes(:, i))
            n_around = 3
         else
            associate (face => mesh%fracture%cell_faces(1, (i - mesh%n_cells + 1)/2))
               around(:2) = regions%region_of_node(mesh%face_nodes(:, face))
            end associate
            n_around = 2
         end if
         last_row(i) = i
         do r = 1, n_around
            do j = regions%block_first(around(r)), regions%block_first(around(r) + 1) - 1
               if (regions%blocks(j) > i) cycle
               if (last_row(regions%blocks(j)) == i) cycle
               last_row(regions%blocks(j)) = i
               n = n + 1
               if (n + 1 > size(found)) found = [found, found]
               found(n) = regions%blocks(j)
            end do
         end do
         n = n + 1
         found(n) = i
      end do
      matrix%row_first(matrix%n_blocks + 1) = n + 1
      matrix%col = found(:n)
      allocate (matrix%elastic(3, 3, n), matrix%flow(n), source=0.0_rk)
      allocate (matrix%elastic_known(3, matrix%n_blocks), source=0.0_rk)
      allocate (matrix%flow_known(matrix%n_blocks), matrix%storage(mesh%n_cells), source=0.0_rk)
   end subroutine find_pattern

   subroutine add_region(regions, region, local, matrix)
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(region_matrix_t), intent(in) :: local
      type(matrix_t), intent(inout) :: matrix

      integer(ik) :: a, b, entry

      associate (blocks => regions%blocks(regions%block_first(region): &
                                          regions%block_first(region + 1) - 1))
         do a = 1, size(blocks)
            associate (row => blocks(a))
               do b = 1, size(blocks)
                  if (blocks(b) > row) cycle
                  do entry = matrix%row_first(row), matrix%row_first(row + 1) - 1
                     if (matrix%col(entry) == blocks(b)) exit
                  end do
                  matrix%elastic(:, :, entry) = matrix%elastic(:, :, entry) &
                                                + local%elastic(3*a - 2:3*a, 3*b - 2:3*b)
                  matrix%flow(entry) = matrix%flow(entry) + local%flow(a, b)
               end do
               matrix%elastic_known(:, row) = matrix%elastic_known(:, row) &
                                              + local%elastic_known(3*a - 2:3*a)
               matrix%flow_known(row) = matrix%flow_known(row) + local%flow_known(a)
            end associate
         end do
      end associate
   end subroutine add_region

   pure function cell_area(mesh, cell) result(area)
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cell
      real(rk) :: area  !< [m2]

      associate (a => mesh%xy(:, mesh%cell_nodes(1, cell)), &
                 b => mesh%xy(:, mesh%cell_nodes(2, cell)), &
                 c => mesh%xy(:, mesh%cell_nodes(3, cell)))
         area = 0.5_rk*((b(1) - a(1))*(c(2) - a(2)) - (b(2) - a(2))*(c(1) - a(1)))
      end associate
   end function cell_area

end module coarse_matrix
