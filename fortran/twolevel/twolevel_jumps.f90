!> The jumps that a window has found, kept for its next mesh and for the time when its faces stick.
module twolevel_jumps
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_place
   use fine_mesh, only: fine_mesh_t
   implicit none(type, external)
   private

   public :: jump_record_t, recall_jump, record_jumps

   !> Jumps along the fractures, at points in no particular order.
   type :: jump_record_t
      integer(ik), allocatable :: fracture(:)
      real(rk), allocatable :: s(:)  !< arc length [m]
      real(rk), allocatable :: jump(:, :)  !< (2, n) x, y: fractures kink [m]
   end type jump_record_t

contains

   !> Keep the solution's jumps for the time when the faces stick.
   pure subroutine record_jumps(fine, displacement, last)
      type(fine_mesh_t), intent(in) :: fine
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(jump_record_t), intent(out) :: last
      integer(ik) :: at, i, k, n

      n = 3*fine%fracture%n_cells
      allocate (last%fracture(n), last%s(n), last%jump(2, n))
      do i = 1, fine%fracture%n_cells
         do k = 1, 3
            at = 3*(i - 1) + k
            last%fracture(at) = fine%fracture%cell_fracture(i)
            last%s(at) = fine%face_s(k, i)
            last%jump(:, at) = displacement(:, fine%face_nodes(k, 2, i)) &
                               - displacement(:, fine%face_nodes(k, 1, i))
         end do
      end do
   end subroutine record_jumps

   !> The recorded jump at a point, linear between its neighbours; found = .false. beyond the
   !! record.
   pure subroutine recall_jump(last, fracture, s, jump, found)
      type(jump_record_t), intent(in) :: last
      integer(ik), intent(in) :: fracture
      real(rk), intent(in) :: s  !< [m]
      real(rk), intent(out) :: jump(2)  !< x, y [m]
      logical, intent(out) :: found
      integer(ik) :: above, below
      real(rk) :: slack, t

      found = .false.
      jump = 0.0_rk
      if (.not. allocated(last%s)) return
      slack = same_place*(maxval(last%s) - minval(last%s))
      below = maxloc(last%s, mask=last%fracture == fracture .and. last%s <= s + slack, dim=1)
      above = minloc(last%s, mask=last%fracture == fracture .and. last%s >= s - slack, dim=1)
      found = below > 0 .and. above > 0
      if (.not. found) return
      t = 0.0_rk
      if (last%s(above) - last%s(below) > slack) t = (s - last%s(below)) &
                                                     /(last%s(above) - last%s(below))
      jump = (1.0_rk - t)*last%jump(:, below) + t*last%jump(:, above)
   end subroutine recall_jump

end module twolevel_jumps
