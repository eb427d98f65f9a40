!> Faces of a window that stick. As long as their traction stays below the bound of friction, their
!! jump is the one before the step: as a given jump it is no unknown of contact, and the solution is
!! that of the law. In a network most faces stick all the time, and the unknowns of contact decide
!! what a window of the whole body costs.
module twolevel_held_faces
   use base_kinds, only: ik, rk
   use coarse_held_cells, only: is_far_from_slip, is_near_slip, widen
   use coarse_state, only: state_t
   use contact_law, only: contact_law_t, state_stick
   use fine_contact, only: contact_t
   use fine_faces, only: face_law_t, faces_at_joints
   use fine_loads, only: fine_loads_t
   use fine_mesh, only: fine_mesh_t
   use fine_model, only: fine_model_t
   use fine_tip_domain, only: face_traction
   use mesh_types, only: mesh_t
   use twolevel_faces, only: face_map_t
   use twolevel_window_tip, only: window_tip_t
   implicit none(type, external)
   private

   public :: choose_held, hold_faces, release_faces

   !> Share of the faces below which holding them is not worth it [-].
   real(rk), parameter :: worth = 0.25_rk

contains

   !> Choose the faces to be held on a new mesh: those without slip so far that the coarse level has
   !! far from slip. None at the end of a fracture or at a joint, nor near a tip in focus, nor of
   !! a fracture that closes under pressure or is bonded.
   pure function choose_held(fine, map, coarse, law, state, slip_before, tips) result(held)
      type(fine_mesh_t), intent(in) :: fine
      type(face_map_t), intent(in) :: map
      type(mesh_t), intent(in) :: coarse
      type(contact_law_t), intent(in) :: law(:)  !< (coarse fracture cells)
      type(state_t), intent(in) :: state
      real(rk), intent(in) :: slip_before(:, :)  !< (3, fracture cells) [m]
      type(window_tip_t), intent(in) :: tips(:)  !< (tips of the network)
      logical :: held(fine%fracture%n_cells)
      real(rk), parameter :: negligible = 1.0e-9_rk  ! slip, over the largest [-]
      logical :: sticks(coarse%fracture%n_cells)
      integer(ik) :: i, last, t

      held = .false.
      if (.not. (allocated(state%traction) .and. allocated(state%contact))) return
      sticks = is_far_from_slip(law, state%traction(1, :, :), state%traction(2, :, :))
      sticks = sticks .and. all(state%contact == state_stick, dim=1)
      do t = 1, size(tips)
         if (.not. tips(t)%has_focus) cycle
         associate (of => coarse%fracture%cell_fracture)
            last = findloc(of, tips(t)%fracture, dim=1, back=tips(t)%end == 2)
            if (last > 0) sticks(last) = .false.
         end associate
      end do
      call widen(coarse%fracture%cell_fracture, sticks)
      held = map%is_inside .and. sticks(map%coarse_cell) .and. .not. faces_at_joints(fine) &
             .and. fine%face_at_tip == 0
      do i = 1, size(held)
         held(i) = held(i) .and. all(abs(slip_before(:, i)) <= negligible*maxval(abs(slip_before)))
      end do
      if (count(held) < worth*size(held)) held = .false.
   end function choose_held

   !> Give the jumps of held faces: those before the step.
   pure subroutine hold_faces(held, contact, law, loads)
      logical, intent(in) :: held(:)  !< (fracture cells)
      type(contact_t), intent(in) :: contact  !< with the slip before the step
      type(face_law_t), intent(in) :: law(:)  !< (fracture cells)
      type(fine_loads_t), intent(inout) :: loads
      real(rk) :: gap, slope
      integer(ik) :: i, k

      do i = 1, size(held)
         if (.not. held(i)) cycle
         do k = 1, 3
            associate (slip => contact%slip_before(k, i))
               call law(i)%contact%dilated(slip, sign(1.0_rk, slip), gap, slope)
               loads%jump(:, k, i) = [slip, gap]
            end associate
         end do
      end do
   end subroutine hold_faces

   !> Release held faces that a solution has brought near slip, with those around them.
   pure subroutine release_faces(model, loads, displacement, coarse, map, held, any_released)
      type(fine_model_t), intent(in) :: model
      type(fine_loads_t), intent(in) :: loads
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(mesh_t), intent(in) :: coarse
      type(face_map_t), intent(in) :: map
      logical, intent(inout) :: held(:)  !< (fracture cells)
      logical, intent(out) :: any_released
      logical :: sticks(coarse%fracture%n_cells)
      real(rk) :: normal, shear, traction(2)
      integer(ik) :: i

      sticks = .true.
      do i = 1, size(held)
         if (.not. held(i)) cycle
         traction = face_traction(model, loads, displacement, i)
         associate (tau => model%mesh%face_tangent(:, i))
            shear = dot_product(tau, traction)
            normal = tau(1)*traction(2) - tau(2)*traction(1) + loads%fluid_pressure(i)
         end associate
         if (.not. is_near_slip(model%conditions%law(i)%contact, normal, shear)) cycle
         sticks(map%coarse_cell(i)) = .false.
      end do
      any_released = .not. all(sticks)
      if (.not. any_released) return
      call widen(coarse%fracture%cell_fracture, sticks)
      held = held .and. sticks(map%coarse_cell)
   end subroutine release_faces

end module twolevel_held_faces
