!> The stress that the rock has before it is displaced, linear in y, as loads of the fine problem.
module fine_in_situ
   use base_kinds, only: ik, rk
   use fine_loads, only: fine_loads_t
   use fine_mesh, only: fine_mesh_t
   implicit none(type, external)
   private

   public :: add_in_situ_tractions, set_in_situ_stress

contains

   !> The stress in situ at the vertices.
   pure subroutine set_in_situ_stress(fine, stress, per_y, y_datum, loads)
      type(fine_mesh_t), intent(in) :: fine
      real(rk), intent(in) :: stress(3)  !< xx, yy, xy at the datum [Pa]
      real(rk), intent(in) :: per_y(2)  !< xx, yy: rise per metre upwards [Pa/m]
      real(rk), intent(in) :: y_datum  !< [m]
      type(fine_loads_t), intent(inout) :: loads
      integer(ik) :: node

      loads%initial_stress = spread(stress, 2, fine%n_vertices)
      do node = 1, fine%n_vertices
         loads%initial_stress(1:2, node) = loads%initial_stress(1:2, node) &
                                           + per_y*(fine%xy(2, node) - y_datum)
      end do
   end subroutine set_in_situ_stress

   !> The tractions on the outer boundary that hold the stress in situ in equilibrium. It is linear
   !! in y, and so are these along each face: their integrals with the shape functions give each
   !! end 1/6 of its own traction and the middle 1/3 of both.
   pure subroutine add_in_situ_tractions(fine, loads)
      type(fine_mesh_t), intent(in) :: fine
      type(fine_loads_t), intent(inout) :: loads
      real(rk) :: chord(2), share(2, 2)
      integer(ik) :: face, k, nodes(2)

      do face = 1, size(fine%boundary_sides, kind=ik)
         nodes = fine%boundary_faces(:, face)
         ! The body is on the left: the outward normal times the length is the chord turned right.
         chord = fine%xy(:, nodes(2)) - fine%xy(:, nodes(1))
         do k = 1, 2
            associate (stress => loads%initial_stress(:, nodes(k)))
               share(:, k) = [stress(1)*chord(2) - stress(3)*chord(1), &
                              stress(3)*chord(2) - stress(2)*chord(1)]/6.0_rk
            end associate
            loads%force(:, nodes(k)) = loads%force(:, nodes(k)) + share(:, k)
         end do
         associate (middle => fine%boundary_middles(face))
            loads%force(:, middle) = loads%force(:, middle) + 2.0_rk*sum(share, dim=2)
         end associate
      end do
   end subroutine add_in_situ_tractions

end module fine_in_situ
