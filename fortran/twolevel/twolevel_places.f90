!> Where tips are along the last pieces of their paths, on both levels.
!!
!! The last cell of a fracture ends with its last piece, at a joint if that ends on something. As
!! long as its tip has not come to it, nothing flows there.
module twolevel_places
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_place
   use growth_network, only: end_gain, move_end
   use growth_tip, only: tip_t
   use mesh_types, only: fracture_mesh_t
   use twolevel_state, only: two_levels_t
   implicit none(type, external)
   private

   public :: advances, end_cell, place_tips, tip_cell_lengths

contains

   !> How far the tips are beyond the last accepted state [m].
   function advances(self)
      class(two_levels_t), intent(in) :: self
      real(rk) :: advances(size(self%tip))
      integer(ik) :: i

      do i = 1, size(self%tip, kind=ik)
         advances(i) = end_gain(self%network, self%start, self%tip(i)%fracture, self%tip(i)%end) &
                       - self%now%segment(i)%gain
      end do
      ! Rounding is left of tips that have not moved, where the other end of their fracture has.
      where (abs(advances) <= same_place*self%rules%increment) advances = 0.0_rk
   end function advances

   !> Put the tips of both levels where their segments say.
   subroutine place_tips(self)
      class(two_levels_t), intent(inout) :: self
      integer(ik), allocatable :: free(:)
      integer(ik) :: i, k

      associate (fracture => self%problem%mesh%fracture)
         do i = 1, size(self%tip, kind=ik)
            associate (tip => self%tip(i), segment => self%now%segment(i))
               if (.not. segment%is_open) cycle
               tip%xy = segment%place()
               tip%direction = segment%direction
               call move_end(self%network, tip%fracture, tip%end, tip%xy)
            end associate
         end do
         free = pack([(i, i=1, size(self%tip, kind=ik))], self%tip%is_free)
         associate (ends => self%problem%model%ends)
            ends%cell = [(end_cell(fracture, self%tip(free(k))), k=1, size(free))]
            ends%inwards = merge(1_ik, -1_ik, self%tip(free)%end == 1)
            ends%ahead = [(norm2(fracture%point_xy(:, fracture%cell_points(self%tip(free(k))%end, &
                                                                           ends%cell(k))) &
                                 - self%tip(free(k))%xy), k=1, size(free))]
            call self%problem%model%joints%shut_only(ends%cell, self%tip(free)%end)
         end associate
      end associate
   end subroutine place_tips

   !> The fracture cell that a fracture ends with at a tip; cells are stored along each fracture.
   pure integer(ik) function end_cell(fracture, tip)
      type(fracture_mesh_t), intent(in) :: fracture
      type(tip_t), intent(in) :: tip

      end_cell = findloc(fracture%cell_fracture, tip%fracture, dim=1, back=tip%end == 2)
   end function end_cell

   !> Length of the coarse cell at each tip [m]; 0 where there is none any more.
   pure function tip_cell_lengths(self) result(length)
      class(two_levels_t), intent(in) :: self
      real(rk) :: length(size(self%tip))
      integer(ik) :: i

      length = 0.0_rk
      do i = 1, size(self%tip, kind=ik)
         if (.not. self%tip(i)%is_free) cycle
         length(i) = self%problem%model%condensed%length(end_cell(self%problem%mesh%fracture, &
                                                                  self%tip(i)))
      end do
   end function tip_cell_lengths

end module twolevel_places
