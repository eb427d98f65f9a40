!> Discretization of Biot's equations: the stencils of stress (coarse_stress) and of flow
!! (coarse_diffusion) around each vertex, and the matrix as the sum over all vertices.
module coarse_stencils
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use coarse_diffusion, only: set_flux_equations
   use coarse_elimination, only: eliminate, local_system_t, share_t
   use coarse_in_situ, only: in_situ_state_t
   use coarse_layout, only: at_component
   use coarse_matrix, only: matrix_t
   use coarse_pattern, only: find_pattern
   use coarse_regions, only: find_regions, regions_t
   use coarse_rock, only: rock_t, solid_t
   use coarse_stress, only: divide_rotations, set_stress_equations
   use mesh_geometry, only: cell_area
   use mesh_types, only: mesh_t
   use scene_sides, only: boundary_side_t
   implicit none(type, external)
   private

   public :: discretize, renew_sides

   !> Contributions of one vertex.
   type :: stencil_t
      type(share_t) :: elastic, flow
      integer(ik) :: info = 0  !< not 0: none, since cells are degenerate
   end type stencil_t

   !> Vertices whose stencils are found one after another by one thread, and those that are kept
   !! until they are added, in the order of the vertices whatever the threads do.
   integer(ik), parameter :: slice = 64, batch = 8*slice

contains

   !> Discretize Biot's equations on the mesh: responses in the regions and the global matrix.
   subroutine discretize(mesh, rock, sides, regions, matrix, error, in_situ, &
                         relief)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(boundary_side_t), intent(in) :: sides(:)
      type(regions_t), intent(out) :: regions
      type(matrix_t), intent(out) :: matrix
      type(error_t), allocatable, intent(out) :: error
      type(in_situ_state_t), intent(in), optional :: in_situ  !< beyond which the loads count
      real(rk), intent(in), optional :: relief(:)  !< (layers) of coarse_layers [Pa s]
      type(stencil_t), allocatable :: stencil(:)
      type(solid_t) :: solid
      integer(ik) :: c, first, i, k, n

      call find_regions(mesh, regions, rock%stiffness)
      call find_pattern(mesh, regions, matrix)
      allocate (stencil(min(batch, regions%n_regions)))
      do first = 1, regions%n_regions, batch
         n = min(batch, regions%n_regions - first + 1)
         !$omp parallel do
         do k = 1, n, slice
            call find_stencils(mesh, rock, sides, regions, first + k - 1, &
                               stencil(k:min(k + slice - 1, n)), in_situ, relief)
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
         solid = rock%solid_at(c)
         matrix%storage(c) = cell_area(mesh, c)*solid%storage_at_stress()
         associate (diagonal => matrix%columns%last(c))
            matrix%elastic(3, 3, diagonal) = matrix%elastic(3, 3, diagonal) - matrix%storage(c)
         end associate
      end do
   end subroutine discretize

   !> Update the values of the boundary conditions in the right-hand side; their kinds remain.
   subroutine renew_sides(mesh, rock, sides, regions, matrix, error, in_situ, &
                          relief)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(boundary_side_t), intent(in) :: sides(:)
      type(regions_t), intent(inout) :: regions
      type(matrix_t), intent(inout) :: matrix
      type(error_t), allocatable, intent(out) :: error
      type(in_situ_state_t), intent(in), optional :: in_situ  !< beyond which the loads count
      real(rk), intent(in), optional :: relief(:)  !< (layers) of coarse_layers [Pa s]
      type(stencil_t) :: stencil(1)
      integer(ik) :: r

      matrix%elastic_known = 0.0_rk
      matrix%flow_known = 0.0_rk
      if (allocated(matrix%layer_known)) matrix%layer_known = 0.0_rk
      do r = 1, regions%n_regions
         associate (faces => regions%faces)
            if (.not. any(mesh%face_side(faces%item(faces%first(r):faces%last(r))) > 0)) cycle
         end associate
         call find_stencils(mesh, rock, sides, regions, r, stencil, in_situ, relief)
         if (stencil(1)%info /= 0) then
            call refuse_place(mesh%xy(:, regions%nodes%at(r, 1_ik)), error)
            return
         end if
         call add_known(regions, r, stencil(1), matrix)
      end do
   end subroutine renew_sides

   !> Stress and flow around vertices that follow each other.
   subroutine find_stencils(mesh, rock, sides, regions, first, stencil, in_situ, relief)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(boundary_side_t), intent(in) :: sides(:)
      type(regions_t), intent(inout) :: regions
      integer(ik), intent(in) :: first  !< region
      type(stencil_t), intent(out) :: stencil(:)
      type(in_situ_state_t), intent(in), optional :: in_situ
      real(rk), intent(in), optional :: relief(:)  !< (layers) [Pa s]
      type(local_system_t) :: local
      real(rk), allocatable :: doubled(:)
      real(rk) :: given(size(sides))  ! [Pa] or [m/s]
      integer(ik) :: i

      given = merge(sides%pressure, -sides%inflow, sides%pressure_given)
      do i = 1, size(stencil, kind=ik)
         associate (r => first + i - 1, elastic => stencil(i)%elastic, flow => stencil(i)%flow, &
                    info => stencil(i)%info)
            call set_stress_equations(mesh, rock, sides, regions, r, local, doubled, in_situ)
            call eliminate(local, regions%traction(r), elastic, info)
            if (info /= 0) cycle
            call divide_rotations(doubled, regions%traction(r))
            call set_flux_equations(mesh, rock%resistivity, sides%pressure_given, given, regions, &
                                    r, local, relief)
            call eliminate(local, regions%flux(r), flow, info)
         end associate
      end do
   end subroutine find_stencils

   !> Raise an error for degenerate cells around a node.
   subroutine refuse_place(xy, error)
      real(rk), intent(in) :: xy(2)  !< [m]
      type(error_t), allocatable, intent(out) :: error
      character(len=80) :: place

      write (place, "(a,es12.5,a,es12.5,a)") "(", xy(1), ",", xy(2), ")"
      call raise_error(error, "coarse_stencils", "degenerate cells around the mesh node at "//place)
   end subroutine refuse_place

   !> Add the contributions of one region to the matrix.
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
            entry = matrix%entry_at(row, col)
            do j = 1, 3
               do i = 1, 3
                  matrix%elastic(i, j, entry) = matrix%elastic(i, j, entry) &
                                                + stencil%elastic%matrix(at_a + i, at_b + j)
               end do
            end do
            if (.not. allocated(regions%scalars)) then
               matrix%flow(entry) = matrix%flow(entry) + stencil%flow%matrix(a, b)
            end if
         end do
      end do
      if (allocated(regions%scalars)) call add_layered_flow(regions, region, stencil, matrix)
   end subroutine add_region

   !> The flow where there are layers.
   pure subroutine add_layered_flow(regions, region, stencil, matrix)
      type(regions_t), intent(in) :: regions
      integer(ik), intent(in) :: region
      type(stencil_t), intent(in) :: stencil
      type(matrix_t), intent(inout) :: matrix
      integer(ik) :: a, b, entry, i, j
      integer(ik) :: col(2), row(2)
      real(rk) :: sign_col(2), sign_row(2)

      do b = 1, regions%scalars%length(region)
         call unknowns_of(regions%scalars%at(region, b), col, sign_col)
         do a = 1, regions%scalars%length(region)
            call unknowns_of(regions%scalars%at(region, a), row, sign_row)
            if ((col(1) + 2)/3 > (row(1) + 2)/3) cycle
            entry = matrix%entry_at((row(1) + 2)/3, (col(1) + 2)/3)
            if (matrix%of_layers(entry) > 0) then
               do j = 1, count(col > 0)
                  do i = 1, count(row > 0)
                     call matrix%add_layer_term(row(i), col(j), sign_row(i)*sign_col(j) &
                                                *stencil%flow%matrix(a, b), .true.)
                  end do
               end do
            else
               matrix%flow(entry) = matrix%flow(entry) + stencil%flow%matrix(a, b)
            end if
         end do
      end do
   end subroutine add_layered_flow

   !> The unknowns that add up to a scalar of the stencils of flow, with their signs.
   pure subroutine unknowns_of(scalar, number, sign)
      integer(ik), intent(in) :: scalar  !< of regions%scalars
      integer(ik), intent(out) :: number(2)  !< the second is 0 for a single one
      real(rk), intent(out) :: sign(2)

      number = [scalar, 0_ik]
      sign = 1.0_rk
      if (modulo(scalar, 3_ik) == 0) return
      ! At an end of a layer's face
      number = 3*((scalar + 2)/3) - [2_ik, 1_ik]
      if (modulo(scalar, 3_ik) == 2) sign(2) = -1.0_rk
   end subroutine unknowns_of

   !> Add the contributions of the boundary data of one region to the right-hand side.
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
         if (.not. allocated(regions%scalars)) then
            matrix%flow_known(row) = matrix%flow_known(row) + stencil%flow%known(a)
         end if
      end do
      if (.not. allocated(regions%scalars)) return
      do a = 1, regions%scalars%length(region)
         at = regions%scalars%at(region, a)
         row = (at + 2)/3
         if (modulo(at, 3_ik) == 0) then
            matrix%flow_known(row) = matrix%flow_known(row) + stencil%flow%known(a)
         else
            associate (known => matrix%layer_known(:, row - matrix%n_cells &
                                                   + size(matrix%layer_known, 2, kind=ik)))
               known = known + [1, 3 - 2*(at - 3*row + 3)]*stencil%flow%known(a)
            end associate
         end if
      end do
   end subroutine add_known

end module coarse_stencils
