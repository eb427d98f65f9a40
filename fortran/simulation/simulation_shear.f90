!> Shear tractions of fracture cells at one time, kept by arc length, so that they can be compared
!! with later ones on another mesh: by how much they have fallen where slip has been.
module simulation_shear
   use base_kinds, only: ik, rk
   use mesh_types, only: fracture_mesh_t
   implicit none(type, external)
   private

   public :: shear_t

   type :: shear_t
      integer(ik), allocatable :: fracture(:)  !< (cells)
      real(rk), allocatable :: s(:, :)  !< (2, cells) arc lengths of their ends [m]
      real(rk), allocatable :: traction(:)  !< (cells) f_tau [Pa]
   contains
      procedure :: keep
      procedure :: of_fracture
      procedure :: fall
   end type shear_t

contains

   !> The tractions of a state.
   pure subroutine keep(self, mesh, traction)
      class(shear_t), intent(inout) :: self
      type(fracture_mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: traction(:)  !< (cells) [Pa]

      self%fracture = mesh%cell_fracture
      self%s = mesh%cell_s
      self%traction = traction
   end subroutine keep

   !> Those of one fracture.
   pure function of_fracture(self, fracture) result(part)
      class(shear_t), intent(in) :: self
      integer(ik), intent(in) :: fracture
      type(shear_t) :: part
      integer(ik), allocatable :: cells(:)
      integer(ik) :: i

      cells = pack([(i, i=1, size(self%fracture))], self%fracture == fracture)
      part%fracture = self%fracture(cells)
      part%s = self%s(:, cells)
      part%traction = self%traction(cells)
   end function of_fracture

   !> How much less the faces bear at a later time, in the direction in which they did before, as
   !! the mean over a part of the fracture; cells that were not there before do not count [Pa].
   pure real(rk) function fall(self, later, s)
      class(shear_t), intent(in) :: self  !< of one fracture
      type(shear_t), intent(in) :: later
      real(rk), intent(in) :: s(2)  !< the part, as arc lengths [m]
      real(rk) :: length, middle, total
      integer(ik) :: cell, i

      total = 0.0_rk
      length = 0.0_rk
      if (size(self%fracture) > 0) then
         do i = 1, size(later%fracture, kind=ik)
            if (later%fracture(i) /= self%fracture(1)) cycle
            middle = 0.5_rk*sum(later%s(:, i))
            if (middle < s(1) .or. middle > s(2)) cycle
            cell = findloc(self%s(1, :) <= middle .and. middle <= self%s(2, :), .true., dim=1, &
                           kind=ik)
            if (cell == 0) cycle
            associate (part => later%s(2, i) - later%s(1, i), before => self%traction(cell))
               total = total + part*(abs(before) - sign(1.0_rk, before)*later%traction(i))
               length = length + part
            end associate
         end do
      end if
      fall = 0.0_rk
      if (length > 0.0_rk) fall = total/length
   end function fall

end module simulation_shear
