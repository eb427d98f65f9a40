!> What the limits of a run watch in a body without fluid (simulation_limits).
module mechanics_limits
   use base_kinds, only: degrees, ik, rk
   use base_number, only: brief_text
   use mechanics_fields, only: fracture_jump
   use mechanics_state, only: loaded_body_t
   use mesh_geometry, only: fracture_cell_centre
   use simulation_limits, only: limit_angle, limit_contact, limit_jump, limit_strain
   use simulation_watch, only: worst_place
   implicit none(type, external)
   private

   public :: watch_body

contains

   !> Take note of a state in equilibrium, before it is accepted.
   subroutine watch_body(self)
      class(loaded_body_t), intent(inout) :: self
      character(len=:), allocatable :: when
      real(rk), allocatable :: jump(:, :), ratio(:), strain(:)
      integer(ik) :: i

      when = "load factor "//brief_text(self%factor, 6)
      associate (body => self%body, watch => self%watch, fracture => self%body%mesh%fracture)
         call watch%see(limit_contact, body%contact%residual, when)
         call watch%see(limit_angle, body%smallest_angle*degrees, when)
         strain = (maxval(body%displacement, dim=2) - minval(body%displacement, dim=2)) &
                  /(maxval(body%model%mesh%xy, dim=2) - minval(body%model%mesh%xy, dim=2))
         call watch%see(limit_strain, strain(worst_place(strain)), when)
         if (fracture%n_cells > 0) then
            jump = fracture_jump(body)
            ratio = norm2(jump, dim=1)/body%model%mesh%face_length
            i = worst_place(ratio)
            call watch%see(limit_jump, ratio(i), when, &
                           fracture_cell_centre(fracture, i))
         end if
         if (self%scene%growth%intensities) then
            call watch%see_tips(self%tip, self%scene%material%toughness, &
                                self%scene%growth%enabled, when)
         end if
      end associate
   end subroutine watch_body

end module mechanics_limits
