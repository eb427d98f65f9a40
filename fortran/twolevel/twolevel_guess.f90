!> Transfer of the initial guess of the next try to a new coarse mesh. Without it the tries of a
!! step in which tips begin segments, above all those of a jump, would each begin from the state
!! before the step.
module twolevel_guess
   use base_kinds, only: ik, rk
   use coarse_layout, only: fracture_layout_t
   use coarse_state, only: guess_t
   use mesh_types, only: fracture_mesh_t
   use twolevel_overlaps, only: fracture_overlaps, overlaps_t
   implicit none(type, external)
   private

   public :: transfer_guess

contains

   !> Give the unknowns of cells, flows and wells that were there before their changes; new ones do
   !! not change, and neither do those of joints unless their number is the same.
   pure subroutine transfer_guess(before, after, pairs_before, pairs, old, new, guess)
      type(fracture_mesh_t), intent(in) :: before, after
      integer(ik), intent(in) :: pairs_before(:, :), pairs(:, :)  !< (2, flows) cells
      type(fracture_layout_t), intent(in) :: old, new
      type(guess_t), intent(inout) :: guess
      real(rk) :: change(new%count()), finer
      type(overlaps_t) :: overlaps
      integer(ik) :: cell, k, main(after%n_cells), of

      if (.not. guess%is_known(old%count())) then
         call guess%forget()
         return
      end if
      overlaps = fracture_overlaps(before, after)
      ! Jumps and flows are scaled with the mean length of the cells.
      finer = mean_length(before)/mean_length(after)
      change = 0.0_rk
      do cell = 1, after%n_cells
         main(cell) = overlaps%main(cell)
         if (main(cell) == 0) cycle
         associate (to => change(7*cell - 6:7*cell), from => guess%change(7*main(cell) - 6: &
                                                                          7*main(cell)))
            to = from
            to([1, 2, 4, 5]) = finer*from([1, 2, 4, 5])
         end associate
      end do
      do k = 1, size(pairs, 2, kind=ik)
         of = findloc(pairs_before(1, :) == main(pairs(1, k)) .and. &
                      pairs_before(2, :) == main(pairs(2, k)), .true., dim=1, kind=ik)
         if (of > 0) change(new%at_flow(k)) = finer**2*guess%change(old%at_flow(of))
      end do
      if (new%n_branches == old%n_branches .and. new%n_wells == old%n_wells .and. &
          new%n_joints == old%n_joints) then
         associate (n => new%n_branches + new%n_wells)
            change(new%at_branch(1_ik):new%at_branch(n)) = finer**2 &
                                                 *guess%change(old%at_branch(1_ik):old%at_branch(n))
            change(new%at_joint(1_ik):) = guess%change(old%at_joint(1_ik):)
         end associate
      end if
      guess%change = change
   end subroutine transfer_guess

   !> Mean length of the fracture cells [m].
   pure real(rk) function mean_length(fracture)
      type(fracture_mesh_t), intent(in) :: fracture

      mean_length = sum(fracture%cell_s(2, :) - fracture%cell_s(1, :))/fracture%n_cells
   end function mean_length

end module twolevel_guess
