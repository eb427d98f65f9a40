!> Whether fractures have cut the body to pieces.
module mechanics_pieces
   use base_groups, only: groups_t, single_groups
   use base_kinds, only: ik
   use mesh_types, only: fracture_mesh_t, point_boundary
   implicit none(type, external)
   private

   public :: cuts_through

contains

   !> Fractures, with the outer boundary as one more, form a ring: they cut a piece off the body.
   !! Without a mesh nothing is known to.
   pure logical function cuts_through(fracture)
      type(fracture_mesh_t), intent(in) :: fracture
      type(groups_t) :: groups
      integer(ik) :: cell, i, outer
      logical :: were_joined

      cuts_through = .false.
      if (.not. allocated(fracture%cell_points)) return
      groups = single_groups(fracture%n_points)
      outer = findloc(fracture%point_kind, point_boundary, dim=1)
      do i = 1, fracture%n_points
         if (fracture%point_kind(i) == point_boundary) call groups%join(outer, i)
      end do
      do cell = 1, fracture%n_cells
         associate (ends => fracture%cell_points(:, cell))
            call groups%join(ends(1), ends(2), were_joined)
         end associate
         cuts_through = cuts_through .or. were_joined
      end do
   end function cuts_through

end module mechanics_pieces
