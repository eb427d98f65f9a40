!> Whether fractures have cut the body to pieces.
module mechanics_pieces
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
      integer(ik) :: group(fracture%n_points), cell, i, outer, roots(2)

      cuts_through = .false.
      if (.not. allocated(fracture%cell_points)) return
      group = [(i, i=1, fracture%n_points)]
      outer = findloc(fracture%point_kind, point_boundary, dim=1)
      if (outer > 0) where (fracture%point_kind == point_boundary) group = outer
      do cell = 1, fracture%n_cells
         roots = group(fracture%cell_points(:, cell))
         if (roots(1) == roots(2)) cuts_through = .true.
         where (group == roots(2)) group = roots(1)
      end do
   end function cuts_through

end module mechanics_pieces
