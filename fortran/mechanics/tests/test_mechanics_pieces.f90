!> When fractures cut a body to pieces.
program test_mechanics_pieces
   use base_kinds, only: ik
   use mechanics_state, only: cuts_through
   use mesh_types, only: fracture_mesh_t, point_boundary, point_interior, point_tip
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks

   call checks%is_true(.not. cuts_through(chain([point_tip, point_interior, point_tip])), &
                       "a fracture inside does not cut")
   call checks%is_true(.not. cuts_through(chain([point_boundary, point_interior, point_tip])), &
                       "an edge crack does not cut")
   call checks%is_true(cuts_through(chain([point_boundary, point_interior, point_boundary])), &
                       "a fracture from edge to edge cuts")
   call check_ring()
   call checks%is_true(.not. cuts_through(fracture_mesh_t()), "no mesh, as where it cannot be made")
   call checks%finish()

contains

   !> Two cells between three points.
   function chain(kinds) result(fracture)
      integer(ik), intent(in) :: kinds(3)
      type(fracture_mesh_t) :: fracture

      fracture%n_cells = 2
      fracture%n_points = 3
      fracture%cell_points = reshape([1_ik, 2_ik, 2_ik, 3_ik], [2, 2])
      fracture%point_kind = kinds
   end function chain

   !> Three cells that enclose a piece.
   subroutine check_ring()
      type(fracture_mesh_t) :: fracture

      fracture%n_cells = 3
      fracture%n_points = 3
      fracture%cell_points = reshape([1_ik, 2_ik, 2_ik, 3_ik, 3_ik, 1_ik], [2, 3])
      fracture%point_kind = [point_interior, point_interior, point_interior]
      call checks%is_true(cuts_through(fracture), "a ring cuts a piece out")
   end subroutine check_ring

end program test_mechanics_pieces
