!> Fractures that a window of the body need not have: they stick everywhere, have never moved, are
!! far from slip, and lie far from what moves. Rock with such a fracture deforms as rock without it.
!! In a map most fractures are still, and with them most elements of a window are spared.
module twolevel_still_fractures
   use base_kinds, only: ik, rk
   use base_plane, only: norm2, point_distance
   use coarse_held_cells, only: is_far_from_slip
   use coarse_state, only: state_t
   use contact_law, only: contact_law_t, state_stick
   use growth_front, only: front_state_t
   use mesh_types, only: mesh_t
   use scene_types, only: scene_t
   use twolevel_problem, only: coarse_problem_t
   use twolevel_window_tip, only: window_tip_t
   implicit none(type, external)
   private

   public :: find_needed

contains

   !> Fractures that the body as window needs, by their tips: they keep it.
   pure subroutine find_needed(scene, front, problem, state, seen)
      type(scene_t), intent(in) :: scene
      type(front_state_t), intent(in) :: front
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(window_tip_t), intent(inout) :: seen(:)  !< (tips)
      real(rk), parameter :: surroundings = 10.0_rk  ! over the cells of the tip's fracture [-]
      logical :: is_still(size(front%network%first) - 1)
      real(rk) :: place(2, size(seen)), reach(size(seen))
      integer(ik), allocatable :: foci(:)
      integer(ik) :: i

      if (all(seen%is_needed)) return
      is_still = .false.
      if (scene%discretization%face_condition == "contact" .and. allocated(state%traction) &
          .and. allocated(state%contact)) then
         do i = 1, size(seen, kind=ik)
            place(:, i) = front%tip(i)%xy
            reach(i) = surroundings*scene%cell_size_of(seen(i)%fracture)
         end do
         foci = pack([(i, i=1, size(seen, kind=ik))], seen%has_focus)
         is_still = still_fractures(problem%mesh, problem%values%law, state, &
                                    size(is_still, kind=ik), place(:, foci), reach(foci))
      end if
      seen%is_needed = seen%is_needed .or. .not. is_still(seen%fracture)
   end subroutine find_needed

   !> Fractures that are still by the coarse level.
   pure function still_fractures(coarse, law, state, n, place, reach) result(is_still)
      type(mesh_t), intent(in) :: coarse
      type(contact_law_t), intent(in) :: law(:)  !< (fracture cells)
      type(state_t), intent(in) :: state
      integer(ik), intent(in) :: n  !< number of fractures
      real(rk), intent(in) :: place(:, :)  !< (2, k) places around which none is still [m]
      real(rk), intent(in) :: reach(:)  !< (k) distance from them up to which none is [m]
      logical :: is_still(n)
      real(rk), parameter :: rounding = 1.0e-12_rk  ! of a jump, over the largest jump
      real(rk), parameter :: gap = 2.0_rk  ! from what moves, over the larger of two cells [-]
      logical :: moves(coarse%fracture%n_cells)
      real(rk) :: centre(2, coarse%fracture%n_cells), size_of(coarse%fracture%n_cells)
      integer(ik) :: i, j

      moves = .not. is_far_from_slip(law, state%traction(1, :, :), state%traction(2, :, :)) .or. &
              any(state%contact /= state_stick, dim=1)
      is_still = .true.
      associate (fracture => coarse%fracture, least => rounding*maxval(abs(state%jump)))
         do j = 1, fracture%n_cells
            moves(j) = moves(j) .or. any(abs(state%jump(:, :, j)) > least)
            associate (ends => fracture%point_xy(:, fracture%cell_points(:, j)))
               centre(:, j) = 0.5_rk*sum(ends, dim=2)
               size_of(j) = norm2(ends(:, 2) - ends(:, 1))
               do i = 1, size(place, 2, kind=ik)
                  moves(j) = moves(j) .or. point_distance(place(:, i), ends) <= reach(i)
               end do
            end associate
            if (moves(j)) is_still(fracture%cell_fracture(j)) = .false.
         end do
         do j = 1, fracture%n_cells
            if (.not. is_still(fracture%cell_fracture(j))) cycle
            do i = 1, fracture%n_cells
               if (moves(i) .and. norm2(centre(:, i) - centre(:, j)) <= &
                   (gap + 1.0_rk)*max(size_of(i), size_of(j))) exit
            end do
            if (i <= fracture%n_cells) is_still(fracture%cell_fracture(j)) = .false.
         end do
      end associate
   end function still_fractures

end module twolevel_still_fractures
