!> Fracture cells that are held: they stick, have no jump, and are far from slip. As long as they
!! stay below the bound of friction their jumps are zero and need not be unknowns, and the solution
!! is that of the law. In a map most cells are still, and the jumps decide what the factors cost.
module coarse_held_cells
   use base_kinds, only: ik, rk
   use coarse_condensed, only: condensed_t
   use coarse_state, only: state_t
   use coarse_tips, only: crack_ends_t
   use contact_law, only: contact_law_t, state_stick
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: choose_held, find_released, is_far_from_slip, is_near_slip, widen

   !> Share of the bound of friction below which a cell may be held, and above which one that is
   !! held is released [-].
   real(rk), parameter :: safe = 0.9_rk, near_slip = 0.99_rk

   !> Cells on either side of one near slip that are not held.
   integer(ik), parameter :: margin = 2

   !> Share of the cells below which holding them is not worth it, and growth of their number from
   !! which on they are chosen again [-].
   real(rk), parameter :: worth = 0.25_rk, more = 1.5_rk

contains

   !> Choose the cells to be held by the last state: those that stick, have no jump and are far from
   !! slip; none with intact rock ahead of a tip.
   pure subroutine choose_held(mesh, law, ends, state, condensed)
      type(mesh_t), intent(in) :: mesh
      type(contact_law_t), intent(in) :: law(:)  !< (fracture cells)
      type(crack_ends_t), intent(in) :: ends
      type(state_t), intent(in) :: state
      type(condensed_t), intent(inout) :: condensed  !< full
      logical :: held(mesh%fracture%n_cells)

      if (.not. condensed%is_full .or. condensed%factors%needs_exchanges) return
      held = is_far_from_slip(law, state%traction(1, :, :), state%traction(2, :, :))
      held = held .and. all(state%contact == state_stick, dim=1) .and. &
             .not. any(any(abs(state%jump) > 0.0_rk, dim=1), dim=1)
      held(pack(ends%cell, ends%ahead > 0.0_rk)) = .false.
      call widen(mesh%fracture%cell_fracture, held)
      if (count(held) < worth*size(held)) return
      if (allocated(condensed%held)) then
         if (count(held) <= more*count(condensed%held)) return
      end if
      call condensed%hold(held)
   end subroutine choose_held

   !> Find held cells that a solution has brought near slip, with those around them.
   pure subroutine find_released(mesh, law, state, held, released)
      type(mesh_t), intent(in) :: mesh
      type(contact_law_t), intent(in) :: law(:)  !< (fracture cells)
      type(state_t), intent(in) :: state
      logical, intent(in) :: held(:)  !< (fracture cells)
      logical, intent(out) :: released(:)  !< (fracture cells)
      integer(ik) :: i

      do i = 1, size(held, kind=ik)
         released(i) = held(i) .and. any(is_near_slip(law(i), state%traction(1, :, i), &
                                                      state%traction(2, :, i)))
      end do
      if (.not. any(released)) return
      released = .not. released
      call widen(mesh%fracture%cell_fracture, released)
      released = .not. released
   end subroutine find_released

   !> Whether both ends of cells are far from slip.
   pure function is_far_from_slip(law, normal, shear) result(is_far)
      type(contact_law_t), intent(in) :: law(:)  !< (fracture cells)
      real(rk), intent(in) :: normal(:, :), shear(:, :)  !< (2, fracture cells) [Pa]
      logical :: is_far(size(law))

      is_far = all(normal < 0.0_rk .and. &
                   abs(shear) < safe*spread(law%friction, 1, 2)*abs(normal), dim=1)
      is_far = is_far .and. .not. (law%compliance > 0.0_rk .or. law%bilateral .or. law%is_bonded())
   end function is_far_from_slip

   !> Whether a traction is near the bound of friction.
   elemental logical function is_near_slip(law, normal, shear)
      type(contact_law_t), intent(in) :: law
      real(rk), intent(in) :: normal, shear  !< [Pa]

      is_near_slip = .not. (normal < 0.0_rk .and. &
                            abs(shear) <= near_slip*law%friction*abs(normal))
   end function is_near_slip

   !> Cells next to one that may slip, on its fracture, may slip.
   pure subroutine widen(fracture_of, sticks)
      integer(ik), intent(in) :: fracture_of(:)  !< (fracture cells)
      logical, intent(inout) :: sticks(:)  !< (fracture cells)
      logical :: may_slip(size(sticks))
      integer(ik) :: j, k

      may_slip = .not. sticks
      do j = 1, size(sticks, kind=ik)
         if (.not. may_slip(j)) cycle
         do k = max(1_ik, j - margin), min(size(sticks, kind=ik), j + margin)
            if (fracture_of(k) == fracture_of(j)) sticks(k) = .false.
         end do
      end do
   end subroutine widen

end module coarse_held_cells
