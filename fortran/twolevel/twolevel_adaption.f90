!> The coarse mesh of a scene with &adaptive: trial steps of the stages in which wells begin to
!! flow, from the state before the first step, and sizes with which the error of the response to
!! the wells is the same in each cell (coarse_cell_errors). The response is the difference from a
!! step with all wells shut.
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

   !> A trial step.
   type :: trial_step_t
      type(state_t) :: state
      type(rock_fields_t) :: fields
   end type trial_step_t

contains

   module procedure judge_mesh
   real(rk), parameter :: aim = 0.7_rk  ! error that is aimed at, over the tolerance [-]
   real(rk), parameter :: worth = 0.6_rk  ! cells after coarsening, at most, over those before
   type(levels_state_t) :: start
   real(rk), parameter :: most = 4.0_rk  ! times the present number of cells
   real(rk), parameter :: gain = 0.9_rk  ! error after refinement, at most, over that before
   real(rk) :: before, change(self%problem%mesh%n_cells), squares(self%problem%mesh%n_cells)
   logical :: is_known, is_refined
   integer(ik) :: c

   start = self%now
   call try_stages(self, squares, is_known, timers, error)
   self%now = start
   call follow_sides(self%scene, 0.0_rk, 0.0_rk)
   if (allocated(error)) return
   if (.not. is_known) then
      call self%chronicle%add_event(0.0_rk, event_remesh, "the mesh is not adapted: its "// &
                                    "trial steps are not solved")
      return
   end if
   before = self%summary%energy_error
   is_refined = before > self%scene%adaptive%tolerance
   self%summary%energy_error = sqrt(sum(squares))
   associate (mesh => self%problem%mesh, tolerance => self%scene%adaptive%tolerance, &
              found => self%summary%energy_error)
      call self%chronicle%add_event(0.0_rk, event_remesh, brief_text(real(mesh%n_cells, rk), 7) &
                                    //" cells, estimated error in the energy norm "// &
                                    brief_text(found, 3))
      if (is_refined .and. found > gain*before) return
      change = sizes_for(squares, (aim*tolerance)**2)
      sizes = [(sqrt(4.0_rk/sqrt(3.0_rk)*cell_area(mesh, c)), c=1, mesh%n_cells)]
      call limit_change(self%scene, mesh, sizes, change)
      change = change*max(1.0_rk, sqrt(sum(1.0_rk/change**2)/(most*mesh%n_cells)))
      if (found > tolerance .or. (may_coarsen .and. sum(1.0_rk/change**2) &
                                  < worth*mesh%n_cells)) then
         sizes = sizes*change
      else
         deallocate (sizes)
      end if
   end associate
   end procedure judge_mesh

   !> Cells on fractures grow to at most a fifth of the fracture's length, where they are smaller.
   pure subroutine limit_change(scene, mesh, sizes, change)
      type(scene_t), intent(in) :: scene
      type(mesh_t), intent(in) :: mesh
      real(rk), intent(in) :: sizes(:)  !< (n_cells) present ones [m]
      real(rk), intent(inout) :: change(:)  !< (n_cells) [-]
      real(rk), parameter :: share = 0.2_rk
      real(rk) :: length
      integer(ik) :: i

      do i = 1, mesh%fracture%n_cells
         length = scene%fractures(mesh%fracture%cell_fracture(i))%length()
         associate (cell => mesh%face_cells(1, mesh%fracture%cell_faces(:, i)))
            change(cell) = min(change(cell), max(1.0_rk, share*length/sizes(cell)))
         end associate
      end do
   end subroutine limit_change

   !> Squared errors of the cells over the work of the wells, the largest of all trial steps.
   subroutine try_stages(self, squares, is_known, timers, error)
      class(two_levels_t), intent(inout) :: self
      real(rk), intent(out) :: squares(:)  !< (n_cells) [-]
      logical, intent(out) :: is_known  !< a trial step is solved with and without wells
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(levels_state_t) :: start
      type(step_report_t) :: report
      real(rk) :: begins(size(self%scene%injections))  ! [s]
      integer(ik) :: k, w

      squares = 0.0_rk
      is_known = .false.
      if (self%scene%initial%fracture_pressure == "equilibrated") then
         call self%equilibrate(timers, report, error)
      else
         call self%try_step(undrained_share*step_scale(self%scene%time), timers, report, error)
      end if
      if (allocated(error) .or. .not. report%converged) return
      start = self%now
      do w = 1, size(self%scene%injections, kind=ik)
         begins(w) = self%scene%injections(w)%stage_start(1_ik)
         if (any(abs(begins(:w - 1) - begins(w)) <= 0.0_rk)) cycle
         if (begins(w) >= self%scene%time%end) cycle
         start%coarse%time = max(0.0_rk, begins(w))
         do k = 1, size(trial_ends, kind=ik)
            call try_wells(self, start, trial_ends(k)*(next_switch(self%scene, start%coarse%time) &
                                                       - start%coarse%time), squares, is_known, &
                           timers, error)
            if (allocated(error)) return
         end do
      end do
   end subroutine try_stages

   !> Add a trial step of length dt.
   subroutine try_wells(self, start, dt, squares, is_known, timers, error)
      class(two_levels_t), intent(inout) :: self
      type(levels_state_t), intent(in) :: start
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(inout) :: squares(:)  !< (n_cells) the largest so far [-]
      logical, intent(inout) :: is_known
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      type(injection_t) :: wells(size(self%scene%injections))
      type(trial_step_t) :: step(2)  ! without and with wells
      type(step_report_t) :: report
      real(rk) :: energy, these(size(squares)), work
      integer :: i

      wells = self%scene%injections
      do i = 1, 2
         self%now = start
         if (i == 1) self%scene%injections%end = start%coarse%time
         call self%try_step(dt, timers, report, error)
         self%scene%injections = wells
         if (allocated(error) .or. .not. report%converged) return
         step(i)%state = self%now%coarse
         associate (model => self%problem%model, now => self%now%coarse)
            call rock_fields(self%problem%mesh, model%rock, model%regions, now%unknowns, &
                             now%tractions, step(i)%fields)
         end associate
      end do
      is_known = .true.
      call cell_errors(self%problem%mesh, self%problem%model%rock, step(1)%fields, step(2)%fields, &
                       dt, these, energy)
      call add_fracture_flow(self%problem, step(1)%state, step(2)%state, dt, these)
      associate (without => step(1)%state, with => step(2)%state)
         work = 0.5_rk*dt*abs(dot_product(with%injection - without%injection, &
                                          with%pressure - without%pressure))
      end associate
      squares = max(squares, these/max(energy, work, tiny(work)))
   end subroutine try_wells

   !> Add the errors of the flow along fractures to the cells next to them: the flow of a cell
   !! changes linearly from one end to the other, the pressure at its ends is that of the mean flow.
   subroutine add_fracture_flow(problem, without, with, dt, squares)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: without, with
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(inout) :: squares(:)  !< (n_cells) [N m/m]
      real(rk) :: gain(size(with%pressure)), flow
      integer(ik) :: i, k

      gain = 0.0_rk  ! what flows into each cell along the fractures [m2/s]
      associate (pairs => problem%model%connections)
         do k = 1, size(pairs, 2, kind=ik)
            flow = with%flow(k) - without%flow(k)
            gain(pairs(1, k)) = gain(pairs(1, k)) - flow
            gain(pairs(2, k)) = gain(pairs(2, k)) + flow
         end do
      end associate
      associate (fracture => problem%mesh%fracture, length => problem%model%condensed%length)
         do i = 1, fracture%n_cells
            associate (cell => problem%mesh%face_cells(1, fracture%cell_faces(:, i)))
               squares(cell) = squares(cell) + 0.25_rk*dt*length(i)*gain(i)**2 &
                               *problem%model%settings%viscosity/with%aperture(i)**3
            end associate
         end do
      end associate
   end subroutine add_fracture_flow

end submodule twolevel_adaption
