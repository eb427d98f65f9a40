!> Points of the body that are loaded or held: the cells around them share it.
module coarse_points
   use base_kinds, only: ik, rk
   use base_plane, only: barycentric
   use coarse_matrix, only: matrix_t
   use mesh_types, only: mesh_t
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: add_point_forces, hold_points

   !> Force on a held point per its displacement, over Young's modulus of the rock [-]: where what
   !! holds it bears nothing, as it should, any value gives the same.
   real(rk), parameter :: support = 1.0e3_rk

contains

   !> Add the forces of the scene to those on the cells.
   pure subroutine add_point_forces(scene, mesh, force)
      type(scene_t), intent(in) :: scene
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(inout) :: force(:, :)  !< (2, n_cells) [N/m]
      integer(ik) :: i, k

      do i = 1, size(scene%point_loads, kind=ik)
         associate (load => scene%point_loads(i))
            associate (cells => cells_at(mesh, [load%x, load%y]))
               do k = 1, size(cells, kind=ik)
                  force(:, cells(k)) = force(:, cells(k)) + load%force/size(cells)
               end do
            end associate
         end associate
      end do
   end subroutine add_point_forces

   !> Hold the points that the scene restrains: springs against the displacement that is given.
   pure subroutine hold_points(scene, mesh, matrix, force)
      type(scene_t), intent(in) :: scene
      type(mesh_t), intent(in) :: mesh
      type(matrix_t), intent(inout) :: matrix
      real(rk), intent(inout) :: force(:, :)  !< (2, n_cells) [N/m]
      real(rk) :: spring  ! [Pa]
      integer(ik) :: axis, i, k

      do i = 1, size(scene%restraints, kind=ik)
         associate (point => scene%restraints(i))
            associate (cells => cells_at(mesh, [point%x, point%y]))
               spring = support*scene%material%young/size(cells)
               do k = 1, size(cells, kind=ik)
                  do axis = 1, 2
                     if (.not. point%displacement_given(axis)) cycle
                     associate (entry => matrix%elastic(axis, axis, &
                                                        matrix%columns%last(cells(k))), &
                                known => force(axis, cells(k)))
                        entry = entry + spring
                        known = known + spring*point%displacement(axis)
                     end associate
                  end do
               end do
            end associate
         end associate
      end do
   end subroutine hold_points

   !> The cells that have a corner at a point, else the one that the point lies in.
   pure function cells_at(mesh, xy) result(cells)
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: xy(2)  !< [m]
      integer(ik), allocatable :: cells(:)
      real(rk), parameter :: at_corner = 1.0e-6_rk  ! share of the others in the point
      real(rk) :: weight(3), inside(mesh%n_cells)
      logical :: has_corner(mesh%n_cells)
      integer(ik) :: c

      do c = 1, mesh%n_cells
         weight = barycentric(mesh%xy(:, mesh%cell_nodes(:, c)), xy)
         inside(c) = minval(weight)
         has_corner(c) = all(weight > -at_corner) .and. any(weight > 1.0_rk - at_corner)
      end do
      cells = pack([(c, c=1, mesh%n_cells)], has_corner)
      if (size(cells) == 0) cells = [maxloc(inside, dim=1, kind=ik)]
   end function cells_at

end module coarse_points
