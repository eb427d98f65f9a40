!> The matrix of the coarse level: cells and fracture cells in blocks of three (see coarse_layout).
!!
!! Rows: balance of forces on a cell [N/m]; its fluid content, negated [m2]; force through an end of
!! a fracture cell, negated [N/m]; fluid that leaves the rock through a fracture face within the
!! step [m2]. The matrix is symmetric and quasi-definite: positive for displacements, negative for
!! pressures. It is kept as elastic - and - flow parts, so that a new time step needs no new
!! discretization: matrix = elastic + dt*flow.
module coarse_matrix
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_lists, only: lists_t
   use coarse_diffusion, only: find_flux_stencil
   use coarse_elimination, only: local_system_t, share_t
   use coarse_in_situ, only: in_situ_state_t
   use coarse_layout, only: at_component
   use coarse_regions, only: find_regions, regions_t
   use coarse_rock, only: rock_t
   use coarse_stress, only: find_stress_stencil
   use mesh_geometry, only: cell_area
   use mesh_types, only: mesh_t
   use scene_sides, only: boundary_side_t
   implicit none(type, external)
   private

   public :: discretize, matrix_t, renew_sides

   !> Lower triangle in blocks, by rows; the diagonal block is the last one of its row.
   type :: matrix_t
      integer(ik) :: n_blocks = 0
      integer(ik) :: n_cells = 0
      type(lists_t) :: columns  !< of each row, from the first to the diagonal
      !> (3, 3, n_entries), an entry per item of columns, for unknowns [m], [m], [Pa] and rows
      !! [N/m], [N/m], [m2]
      real(rk), allocatable :: elastic(:, :, :)
      real(rk), allocatable :: flow(:)  !< (n_entries) of the pressures alone [m2/(Pa s)]
      !> (3, n_blocks) right-hand side of the boundary data [N/m], [N/m], [m2]
      real(rk), allocatable :: elastic_known(:, :)
      real(rk), allocatable :: flow_known(:)  !< (n_blocks) the same for the flow [m2/s]
      !> (n_cells) content per pressure at fixed traction [m2/Pa]
      real(rk), allocatable :: storage(:)
   contains
      procedure :: elastic_forces
   end type matrix_t

   !> What one vertex adds.
   type :: stencil_t
      type(share_t) :: elastic, flow
      integer(ik) :: info = 0  !< not 0: it has none (degenerate cells)
   end type stencil_t

   !> Vertices whose stencils are found one after another by one thread, and those that are kept
   !! until they are added, in the order of the vertices whatever the threads do.
   integer(ik), parameter :: slice = 64, batch = 8*slice

contains

   !> What the elastic part makes of unknowns: the left-hand side but for the flow.
   pure function elastic_forces(self, unknowns) result(force)
      class(matrix_t), intent(in) :: self
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), allocatable :: force(:, :)  !< (3, n_blocks) [N/m], [N/m], [m2]
      integer(ik) :: entry, i, j
      logical :: acts(self%n_blocks)

      allocate (force(3, self%n_blocks), source=0.0_rk)
      acts = any(abs(unknowns) > 0.0_rk, dim=1)
      do i = 1, self%n_blocks
         do entry = self%columns%first(i), self%columns%last(i)
            j = self%columns%item(entry)
            if (.not. (acts(i) .or. acts(j))) cycle
            associate (block => self%elastic(:, :, entry))
               force(:, i) = force(:, i) + matmul(block, unknowns(:, j))
               if (j /= i) force(:, j) = force(:, j) + matmul(unknowns(:, i), block)
            end associate
         end do
      end do
   end function elastic_forces

   !> Discretize Biot's equations on the mesh: responses in the regions and the global matrix.
   subroutine discretize(mesh, rock, sides, regions, matrix, error, in_situ)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(boundary_side_t), intent(in) :: sides(:)
      type(regions_t), intent(out) :: regions
      type(matrix_t), intent(out) :: matrix
      type(error_t), allocatable, intent(out) :: error
      type(in_situ_state_t), intent(in), optional :: in_situ  !< beyond which the loads count
      type(stencil_t), allocatable :: stencil(:)
      integer(ik) :: at, c, first, i, k, n

      call find_regions(mesh, regions, rock%stiffness)
      call find_pattern(mesh, regions, matrix)
      allocate (stencil(min(batch, regions%n_regions)))
      do first = 1, regions%n_regions, batch
         n = min(batch, regions%n_regions - first + 1)
         !$omp parallel do
         do k = 1, n, slice
            call find_stencils(mesh, rock, sides, regions, first + k - 1, &
                               stencil(k:min(k + slice - 1, n)), in_situ)
         end do
         !$omp end parallel do
         do i = 1, n
            if (stencil(i)%info /= 0) then
               call refuse_place(mesh%xy(:, regions%nodes%at(first + i - 1, 1_ik)), error)
               return
            end if
            call add_region(regions, first + i - 1, stencil(i), matrix)
            call add_known(regions, first + i - 1, stencil(i), matrix)
         end do
      end do
      do c = 1, mesh%n_cells
         at = min(c, size(rock%shear, kind=ik))
         matrix%storage(c) = cell_area(mesh, c)*(rock%storage(at) + rock%biot(at)**2 &
                                                 /(rock%lame(at) + rock%shear(at)))
         associate (diagonal => matrix%columns%last(c))
            matrix%elastic(3, 3, diagonal) = matrix%elastic(3, 3, diagonal) - matrix%storage(c)
         end associate
      end do
   end subroutine discretize

   !> Take other values on the sides, of the same kinds: what is known around the vertices there.
   subroutine renew_sides(mesh, rock, sides, regions, matrix, error, in_situ)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(boundary_side_t), intent(in) :: sides(:)
      type(regions_t), intent(inout) :: regions
      type(matrix_t), intent(inout) :: matrix
      type(error_t), allocatable, intent(out) :: error
      type(in_situ_state_t), intent(in), optional :: in_situ  !< beyond which the loads count
      type(stencil_t) :: stencil(1)
      integer(ik) :: r

      matrix%elastic_known = 0.0_rk
      matrix%flow_known = 0.0_rk
      do r = 1, regions%n_regions
         associate (faces => regions%faces)
            if (.not. any(mesh%face_side(faces%item(faces%first(r):faces%last(r))) > 0)) cycle
         end associate
         call find_stencils(mesh, rock, sides, regions, r, stencil, in_situ)
         if (stencil(1)%info /= 0) then
            call refuse_place(mesh%xy(:, regions%nodes%at(r, 1_ik)), error)
            return
         end if
         call add_known(regions, r, stencil(1), matrix)
      end do
   end subroutine renew_sides

   !> Stress and flow around vertices that follow each other.
   subroutine find_stencils(mesh, rock, sides, regions, first, stencil, in_situ)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(boundary_side_t), intent(in) :: sides(:)
      type(regions_t), intent(inout) :: regions
      integer(ik), intent(in) :: first  !< region
      type(stencil_t), intent(out) :: stencil(:)
      type(in_situ_state_t), intent(in), optional :: in_situ
      type(local_system_t) :: local
      real(rk) :: given(size(sides))  ! [Pa] or [m/s]
      integer(ik) :: i

      given = merge(sides%pressure, -sides%inflow, sides%pressure_given)
      do i = 1, size(stencil, kind=ik)
         associate (r => first + i - 1, elastic => stencil(i)%elastic, flow => stencil(i)%flow, &
                    info => stencil(i)%info)
            call find_stress_stencil(mesh, rock, sides, regions, r, local, regions%traction(r), &
                                     elastic, info, in_situ)
            if (info == 0) then
               call find_flux_stencil(mesh, rock%resistivity, sides%pressure_given, given, &
                                      regions, r, local, regions%flux(r), flow, info)
            end if
         end associate
      end do
   end subroutine find_stencils

   !> The error of cells that no stencil can be found on.
   subroutine refuse_place(xy, error)
      real(rk), intent(in) :: xy(2)  !< [m]
      type(error_t), allocatable, intent(out) :: error
      character(len=80) :: place

      write (place, "(a,es12.5,a,es12.5,a)") "(", xy(1), ",", xy(2), ")"
      call raise_error(error, "coarse_matrix", "degenerate cells around the mesh node at "//place)
   end subroutine refuse_place

   !> Which blocks meet in some region.
   subroutine find_pattern(mesh, regions, matrix)
      type(mesh_t), intent(in) :: mesh
      type(regions_t), intent(in) :: regions
      type(matrix_t), intent(inout) :: matrix
      integer(ik), allocatable :: last_row(:), found(:)
      integer(ik) :: block, i, k, n, r, side

      matrix%n_blocks = regions%n_blocks
      matrix%n_cells = mesh%n_cells
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
               block = regions%blocks%item(k)
               if (block > i) cycle
               if (last_row(block) == i) cycle
               last_row(block) = i
               n = n + 1
               if (n + 1 > size(found)) found = [found, found]
               found(n) = block
            end do
         end do
         n = n + 1
         found(n) = i
      end do
      matrix%columns%first(matrix%n_blocks + 1) = n + 1
      matrix%columns%item = found(:n)
      allocate (matrix%elastic(3, 3, n), matrix%flow(n), source=0.0_rk)
      allocate (matrix%elastic_known(3, matrix%n_blocks), source=0.0_rk)
      allocate (matrix%flow_known(matrix%n_blocks), matrix%storage(mesh%n_cells), source=0.0_rk)
   end subroutine find_pattern

   !> Add the shares of one region.
   pure subroutine add_region(regions, region, stencil, matrix)
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(stencil_t), intent(in) :: stencil
      type(matrix_t), intent(inout) :: matrix
      integer(ik) :: a, at_a, at_b, b, col, entry, i, j, row

      do a = 1, regions%blocks%length(region)
         row = regions%blocks%at(region, a)
         at_a = at_component(a, 1) - 1
         do b = 1, regions%blocks%length(region)
            col = regions%blocks%at(region, b)
            if (col > row) cycle
            at_b = at_component(b, 1) - 1
            entry = matrix%columns%first(row)
            do while (matrix%columns%item(entry) /= col)
               entry = entry + 1
            end do
            do j = 1, 3
               do i = 1, 3
                  matrix%elastic(i, j, entry) = matrix%elastic(i, j, entry) &
                                                + stencil%elastic%matrix(at_a + i, at_b + j)
               end do
            end do
            matrix%flow(entry) = matrix%flow(entry) + stencil%flow%matrix(a, b)
         end do
      end do
   end subroutine add_region

   !> Add what the boundary data of one region give.
   pure subroutine add_known(regions, region, stencil, matrix)
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(stencil_t), intent(in) :: stencil
      type(matrix_t), intent(inout) :: matrix
      integer(ik) :: a, at, row

      do a = 1, regions%blocks%length(region)
         at = at_component(a, 1)
         row = regions%blocks%at(region, a)
         matrix%elastic_known(:, row) = matrix%elastic_known(:, row) &
                                        + stencil%elastic%known(at:at + 2)
         matrix%flow_known(row) = matrix%flow_known(row) + stencil%flow%known(a)
      end do
   end subroutine add_known

end module coarse_matrix
