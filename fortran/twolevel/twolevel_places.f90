!> Where tips are along the last pieces of their paths, on both levels.
module twolevel_places
   use base_kinds, only: ik, rk
   use growth_network, only: end_gain, move_end
   use twolevel_state, only: two_levels_t
   implicit none(type, external)
   private

   public :: advances, place_tips, tip_cell_lengths

contains

   !> How far the tips are beyond the last accepted state [m].
   function advances(self)
      class(two_levels_t), intent(in) :: self
      real(rk) :: advances(size(self%tip))
      integer(ik) :: i

      do i = 1, size(self%tip, kind=ik)
         advances(i) = end_gain(self%network, self%start, self%tip(i)%fracture, self%tip(i)%end) &
                       - self%segment(i)%gain
      end do
   end function advances

   !> Put the tips of both levels where their segments say.
   subroutine place_tips(self)
      class(two_levels_t), intent(inout) :: self
      integer(ik) :: i, k

      associate (fracture => self%mesh%fracture)
         do i = 1, size(self%tip, kind=ik)
            associate (tip => self%tip(i), segment => self%segment(i))
               if (.not. segment%is_open) cycle
               tip%xy = segment%place()
               tip%direction = segment%direction
               call move_end(self%network, tip%fracture, tip%end, tip%xy)
            end associate
         end do
         do k = 1, fracture%n_tips
            i = findloc(self%tip%fracture == fracture%tip_fracture(k) .and. &
                        self%tip%end == fracture%tip_end(k), .true., dim=1)
            if (i == 0) cycle
            self%model%ahead(k) = norm2(fracture%point_xy(:, fracture%tip_point(k)) &
                                        - self%tip(i)%xy)
         end do
      end associate
   end subroutine place_tips

   !> Length of the coarse cell at each tip [m].
   pure function tip_cell_lengths(self) result(length)
      class(two_levels_t), intent(in) :: self
      real(rk) :: length(size(self%tip))
      integer(ik) :: i, k

      length = 0.0_rk
      associate (fracture => self%mesh%fracture)
         do k = 1, fracture%n_tips
            i = findloc(self%tip%fracture == fracture%tip_fracture(k) .and. &
                        self%tip%end == fracture%tip_end(k), .true., dim=1)
            if (i == 0) cycle
            associate (cells => fracture%point_cells%of(fracture%tip_point(k)))
               length(i) = self%model%condensed%length(cells(1))
            end associate
         end do
      end associate
   end function tip_cell_lengths

end module twolevel_places
