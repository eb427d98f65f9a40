!> The coarse mesh of a scene with &adaptive: trial steps of the first stage of the wells, without
!! growth, and sizes of cells with which the error of their response is the same in each cell.
submodule(twolevel_state) twolevel_adaption
   use base_kinds, only: ik, rk
   use coarse_cell_errors, only: cell_errors, rock_fields, rock_fields_t, sizes_for
   use report_rows, only: event_remesh
   use scene_types, only: injection_t
   use twolevel_levels_state, only: levels_state_t
   use twolevel_schedule, only: next_switch
   implicit none(type, external)

   !> Ends of the trial steps over the length of the stage [-].
   real(rk), parameter :: trial_ends(2) = [1.0e-3_rk, 0.1_rk]

contains

   module subroutine judge_mesh(self, sizes, timers, error)
      class(two_levels_t), intent(inout) :: self
      real(rk), allocatable, intent(out) :: sizes(:)
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(levels_state_t) :: start
      real(rk) :: squares(self%problem%mesh%n_cells)
      real(rk), parameter :: coarsest = 4.0_rk, aim = 0.7_rk

      start = self%now
      call try_stage(self, squares, timers, error)
      self%now = start
      call follow_sides(self%scene, 0.0_rk, 0.0_rk)
      if (allocated(error)) return
      associate (tolerance => self%scene%adaptive%tolerance, n => self%problem%mesh%n_cells)
         call self%chronicle%add_event(self%now%coarse%time, event_remesh, "coarse mesh of " &
                                       //brief_text(real(n, rk), 6)//" cells, estimated error of " &
                                       //"the response to the wells "//brief_text(sum(squares), 3))
         if (sum(squares) <= tolerance) return
         sizes = sizes_for(self%problem%mesh, squares, aim*tolerance, coarsest)
      end associate
   end subroutine judge_mesh

   !> Squared errors of the cells over the work of the wells, the largest of all trial steps. The
   !! response to the wells is the difference from a step in which they are shut.
   subroutine try_stage(self, squares, timers, error)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(out) :: squares(:)  !< (n_cells) [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(levels_state_t) :: start
      type(rock_fields_t) :: fields(2)  ! without and with wells
      type(injection_t) :: wells(size(self%scene%injections))
      type(state_t) :: state(2)
      type(step_report_t) :: report
      real(rk) :: dt, energy, these(size(squares)), work
      integer(ik) :: i, k

      squares = 0.0_rk
      wells = self%scene%injections
      self%now%coarse%time = first_flow(self%scene)
      if (self%scene%initial%fracture_pressure == "equilibrated") then
         call self%equilibrate(timers, report, error)
      else
         call self%try_step(undrained_share*self%scene%time%longest(), timers, report, error)
      end if
      if (allocated(error) .or. .not. report%converged) return
      start = self%now
      do k = 1, size(trial_ends, kind=ik)
         dt = trial_ends(k)*(next_switch(self%scene, start%coarse%time) - start%coarse%time)
         do i = 1, 2
            self%now = start
            if (i == 1) self%scene%injections%end = start%coarse%time
            call self%try_step(dt, timers, report, error)
            self%scene%injections = wells
            if (allocated(error)) return
            if (.not. report%converged) exit
            state(i) = self%now%coarse
            associate (model => self%problem%model)
               call rock_fields(self%problem%mesh, model%rock, model%regions, state(i)%unknowns, &
                                state(i)%tractions, fields(i))
            end associate
         end do
         if (.not. report%converged) cycle
         call cell_errors(self%problem%mesh, self%problem%model%rock, fields(1), fields(2), dt, &
                          these, energy)
         work = 0.5_rk*dt*abs(dot_product(state(2)%injection - state(1)%injection, &
                                          state(2)%pressure - state(1)%pressure))
         squares = max(squares, these/max(energy, work, tiny(work)))
      end do
   end subroutine try_stage

   !> Time at which the first well begins to flow [s]; 0 without any.
   pure real(rk) function first_flow(scene) result(time)
      type(scene_t), intent(in) :: scene

      time = 0.0_rk
      if (size(scene%injections) > 0) time = max(0.0_rk, minval(scene%injections%start))
   end function first_flow

end submodule twolevel_adaption
