!> Sides of the body that stand on springs, as part of the stiffness of the elements there.
module fine_springs
   use base_kinds, only: ik, rk
   use fine_mesh, only: fine_mesh_t
   implicit none(type, external)
   private

   public :: add_side_springs

contains

   !> Springs along one side, each component by itself: the traction -k u on the side gives the
   !! element of each face its k N_i N_j, integrated along the face; for its ends and its middle
   !! exactly length/30 (4 -1 2; -1 4 2; 2 2 16).
   pure subroutine add_side_springs(fine, side, spring, stiffness)
      type(fine_mesh_t), intent(in) :: fine
      integer(ik), intent(in) :: side  !< as mesh_t%face_side numbers them
      real(rk), intent(in) :: spring(2)  !< x, y: traction over displacement [Pa/m]
      real(rk), intent(inout) :: stiffness(:, :, :)  !< (12, 12, n_cells) [Pa]
      real(rk), parameter :: shares(3, 3) = reshape([4.0_rk, -1.0_rk, 2.0_rk, &
                                                     -1.0_rk, 4.0_rk, 2.0_rk, &
                                                     2.0_rk, 2.0_rk, 16.0_rk], [3, 3])/30.0_rk
      integer(ik) :: axis, cell, corner(3), element(fine%n_nodes), face, i, j, nodes(3)

      if (.not. any(spring > 0.0_rk)) return
      element = 0
      do cell = 1, fine%n_cells
         element(fine%cell_nodes(4:, cell)) = cell
      end do
      do face = 1, size(fine%boundary_sides, kind=ik)
         if (fine%boundary_sides(face) /= side) cycle
         nodes = [fine%boundary_faces(:, face), fine%boundary_middles(face)]
         cell = element(nodes(3))
         do i = 1, 3
            corner(i) = findloc(fine%cell_nodes(:, cell), nodes(i), dim=1, kind=ik)
         end do
         associate (length => norm2(fine%xy(:, nodes(2)) - fine%xy(:, nodes(1))))
            do axis = 1, 2
               do j = 1, 3
                  do i = 1, 3
                     associate (entry => stiffness(2*corner(i) - 2 + axis, &
                                                   2*corner(j) - 2 + axis, cell))
                        entry = entry + spring(axis)*length*shares(i, j)
                     end associate
                  end do
               end do
            end do
         end associate
      end do
   end subroutine add_side_springs

end module fine_springs
