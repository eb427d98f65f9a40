!> Evaluation of the tips in their windows; tips that change little keep their intensities.
module twolevel_tips
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use growth_front, only: front_state_t
   use growth_tip, only: tip_t
   use mesh_types, only: fracture_mesh_t
   use scene_types, only: scene_t
   use twolevel_levels_state, only: levels_state_t
   use twolevel_places, only: end_cell, shut_tips
   use twolevel_problem, only: coarse_problem_t
   use twolevel_windows, only: windows_t
   implicit none(type, external)
   private

   public :: find_tip_intensities

contains

   !> Stress intensity factors of the active tips, in windows on the present network.
   subroutine find_tip_intensities(scene, has_reference, front, problem, now, windows, error)
      type(scene_t), intent(in) :: scene
      logical, intent(in) :: has_reference  !< the windows are compared with the body as one window
      type(front_state_t), intent(inout) :: front
      type(coarse_problem_t), intent(inout) :: problem
      type(levels_state_t), intent(inout) :: now
      type(windows_t), intent(inout) :: windows
      type(error_t), allocatable, intent(out) :: error
      logical :: active(size(front%tip))
      integer(ik) :: i

      active = .true.
      if (allocated(now%active)) active = now%active
      associate (tips => front%tip, fracture => problem%mesh%fracture)
         tips%is_shut = .false.
         tips%is_carried = .false.
         if (fracture%n_cells > 0) then
            tips%is_shut = shut_tips(tips, now%segment, fracture, now%coarse%jump)
         end if
         call carry_intensities(scene, fracture, windows, tips, now)
         active = active .and. tips%is_loaded()
         call problem%find_values(now%coarse, now%undrained)
         windows%is_beside_body = has_reference
         call windows%evaluate(scene, front, active, problem, now%coarse, now%windows, error)
         do i = 1, size(tips, kind=ik)
            if (.not. tips(i)%is_shut) cycle
            call tips(i)%shut()
            now%windows%tip(i)%found = tips(i)%intensity
            call now%windows%tip(i)%forget_coarse_error()
         end do
         do i = 1, size(tips, kind=ik)
            if (.not. active(i)) cycle
            now%windows%tip(i)%jump_then = tip_jump(now, fracture, tips(i))
            now%windows%tip(i)%place_then = tips(i)%xy
         end do
      end associate
   end subroutine find_tip_intensities

   !> In a network, tips far below their toughness keep their intensities as long as the jump of the
   !! coarse cell behind them is nearly constant: K is proportional to the jump. The change of the
   !! jump since the last evaluation is part of their error.
   subroutine carry_intensities(scene, fracture, windows, tips, now)
      type(scene_t), intent(in) :: scene
      type(fracture_mesh_t), intent(in) :: fracture
      type(windows_t), intent(in) :: windows
      type(tip_t), intent(inout) :: tips(:)
      type(levels_state_t), intent(in) :: now
      integer, parameter :: few = 8  ! tips are all evaluated
      real(rk), parameter :: constant = 0.1_rk  ! change of a jump that carries an intensity [-]
      real(rk), parameter :: far = 0.5_rk  ! lack of toughness, error included [-]
      real(rk) :: change
      integer(ik) :: i

      if (.not. scene%growth%enabled .or. count(tips%is_loaded()) <= few) return
      associate (toughness => scene%material%toughness)
         do i = 1, size(tips, kind=ik)
            associate (tip => tips(i), seen => now%windows%tip(i))
               if (.not. tip%is_loaded() .or. norm2(tip%xy - seen%place_then) > 0.0_rk) cycle
               if (.not. windows%has_mesh(i)) cycle
               if (tip%excess(toughness) + tip%relative_error(toughness) > -far) cycle
               change = norm2(tip_jump(now, fracture, tip) - seen%jump_then)
               if (change > constant*norm2(seen%jump_then)) cycle
               change = change/max(norm2(seen%jump_then), tiny(1.0_rk))
               call tip%carry(windows%intensity_of(i, seen), change)
            end associate
         end do
      end associate
   end subroutine carry_intensities

   !> Mean opening and slip of the coarse cell behind a tip [m].
   pure function tip_jump(now, fracture, tip) result(jump)
      type(levels_state_t), intent(in) :: now
      type(fracture_mesh_t), intent(in) :: fracture
      type(tip_t), intent(in) :: tip
      real(rk) :: jump(2)

      jump = 0.5_rk*sum(now%coarse%jump(:, :, end_cell(fracture, tip)), dim=2)
   end function tip_jump

end module twolevel_tips
