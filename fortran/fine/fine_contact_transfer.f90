!> What is kept of contact when the mesh changes.
module fine_contact_transfer
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_place
   use fine_contact, only: contact_t
   use fine_line, only: line_parameter, line_shapes
   use fine_mesh, only: fine_mesh_t
   implicit none(type, external)
   private

   public :: transfer_contact

contains

   !> Contact on a new mesh: where the old mesh had the fracture, jump and slip of its nodes,
   !! interpolated; elsewhere it stays as it is.
   pure subroutine transfer_contact(fine_old, old, fine_new, new)
      type(fine_mesh_t), intent(in) :: fine_old
      type(contact_t), intent(in) :: old
      type(fine_mesh_t), intent(in) :: fine_new
      type(contact_t), intent(inout) :: new
      real(rk) :: weight(3)
      integer(ik) :: cell, k, source

      do cell = 1, fine_new%fracture%n_cells
         do k = 1, 3
            call find(fine_new%fracture%cell_fracture(cell), fine_new%face_s(k, cell), source, &
                      weight)
            if (source == 0) cycle
            new%jump(:, k, cell) = matmul(old%jump(:, :, source), weight)
            new%slip_before(k, cell) = dot_product(old%slip_before(:, source), weight)
            new%slip_path(k, cell) = dot_product(old%slip_path(:, source), weight)
            new%opened(k, cell) = max(0.0_rk, dot_product(old%opened(:, source), weight))
         end do
      end do

   contains

      !> The old cell at an arc length of a fracture, and the shares of its nodes.
      pure subroutine find(f, s, source, weight)
         integer(ik), intent(in) :: f
         real(rk), intent(in) :: s  !< [m]
         integer(ik), intent(out) :: source  !< 0: none
         real(rk), intent(out) :: weight(3)  !< start, end, mid [-]
         real(rk) :: x
         integer(ik) :: i

         source = 0
         weight = 0.0_rk
         do i = 1, fine_old%fracture%n_cells
            if (fine_old%fracture%cell_fracture(i) /= f) cycle
            x = (s - fine_old%face_s(1, i))/(fine_old%face_s(2, i) - fine_old%face_s(1, i))
            if (x < -same_place .or. x > 1.0_rk + same_place) cycle
            source = i
            x = line_parameter(min(1.0_rk, max(0.0_rk, x)), fine_old%face_tip(i))
            weight = line_shapes(x)
            return
         end do
      end subroutine find

   end subroutine transfer_contact

end module fine_contact_transfer
