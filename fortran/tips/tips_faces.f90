!> The traction that the fracture faces carry, as the interaction integral needs it.
module tips_faces
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_direction
   use fine_faces, only: face_contact, face_jump, face_loaded
   use fine_line, only: line_resultants
   use fine_loads, only: fine_loads_t, volume_forces
   use fine_model, only: fine_model_t
   use tips_types, only: tip_frame_t
   implicit none(type, external)
   private

   public :: face_traction, traction_source

contains

   !> Mean total traction on side + of a fracture cell (f - p n; side - carries the opposite), in x
   !! and y.
   !!
   !! On a loaded cell it is the given one. Where the jump, or a part of it, is tied, the traction
   !! is the force that the element on side + needs at the face's middle node over that node's
   !! share of the face. No other element touches that node, and such forces are far more accurate
   !! than stresses at the face.
   pure function face_traction(model, loads, displacement, cell) result(traction)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      integer(ik), intent(in) :: cell  !< fracture cell
      real(rk) :: traction(2)  !< [Pa]
      real(rk) :: tau(2), force(2, 6), share(3)
      integer(ik) :: k, element

      if (model%conditions%condition(cell) == face_loaded) then
         tau = model%mesh%face_tangent(:, cell)
         traction = loads%traction(1, cell)*tau &
                    + (loads%traction(2, cell) - loads%fluid_pressure(cell))*[-tau(2), tau(1)]
         return
      end if
      element = model%mesh%face_cells(1, cell)
      associate (nodes => model%mesh%cell_nodes(:, element), &
                 rock => model%rocks%in_cell(element))
         k = findloc(nodes, model%mesh%face_nodes(3, 1, cell), dim=1)
         force = model%element_forces(displacement, element) &
                 - volume_forces(model%mesh, element, rock%biot, loads)
      end associate
      share = line_resultants(model%mesh%face_tip(cell))
      traction = force(:, k)/(share(3)*model%mesh%face_length(cell))
   end function face_traction

   !> The cell whose traction stands for that of a cell near the tip.
   !!
   !! Where the slip is given, the stress concentration that it makes leaves an error of some per
   !! cent of itself in the forces on the first two cells, on any mesh; the traction itself is
   !! smooth there. So these take the value of the third, as far as it is a cell of the same kind
   !! on the same line.
   pure integer(ik) function traction_source(model, frame, cell)
      type(fine_model_t), intent(in) :: model
      type(tip_frame_t), intent(in) :: frame
      integer(ik), intent(in) :: cell  !< fracture cell on the straight piece at the tip
      integer(ik), parameter :: n_disturbed = 2
      integer(ik) :: inward, candidate

      traction_source = cell
      if (.not. has_given_slip(cell)) return
      inward = -nint(frame%upper)  ! cells are stored along the fracture
      do
         if (abs(traction_source - frame%face) >= n_disturbed) exit
         candidate = traction_source + inward
         if (candidate < 1 .or. candidate > model%mesh%fracture%n_cells) exit
         if (model%mesh%fracture%cell_fracture(candidate) /= frame%fracture) exit
         if (.not. has_given_slip(candidate)) exit
         if (norm2(model%mesh%face_tangent(:, candidate) &
                   - model%mesh%face_tangent(:, cell)) > same_direction) exit
         traction_source = candidate
      end do

   contains

      !> Whether the slip of a cell is given, with the opening or without.
      pure logical function has_given_slip(given)
         integer(ik), intent(in) :: given

         has_given_slip = model%conditions%condition(given) == face_jump &
                          .or. (model%conditions%condition(given) == face_contact &
                                .and. model%conditions%law(given)%slip_given)
      end function has_given_slip

   end function traction_source

end module tips_faces
