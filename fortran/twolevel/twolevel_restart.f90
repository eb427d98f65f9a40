!> The complete state of a simulation with a fluid in an archive (docs/architecture.md).
!!
!! Stored: all values that a step changes; the meshes of both levels as the library has them; what
!! decisions depend on (step control, Broyden updates, window slots, estimates of errors).
!! Made again, with the same bits: stencils, matrices and factors of the coarse level, and models of
!! windows, from the same meshes in the same order.
submodule(twolevel_state) twolevel_restart
   use base_kinds, only: lk
   use base_plane, only: norm2
   use base_tolerances, only: same_time
   use coarse_archive, only: visit_cells, visit_factors, visit_report, &
                             visit_step_values
   use growth_front, only: front_state_t
   use growth_network, only: end_place
   use mesh_archive, only: visit_mesher_and_mesh
   use report_restart, only: visit_simulation
   use twolevel_archive, only: visit_levels, visit_stepper, visit_value_errors, visit_values
   use twolevel_heat, only: act, heat_row, set_heat
   use twolevel_places, only: place_tips
   use twolevel_schedule, only: next_switch
   use twolevel_setup, only: keep_above_zero, rules_of_scene
   use twolevel_window_tip, only: window_tip_t
   implicit none(type, external)

contains

   module procedure prepare

   self%end_time = scene%time%end
   self%tape%is_recording = .true.
   call self%stepper%begin(scene%time)
   call self%set_scene(scene)
   call self%chronicle%clear()
   call keep_above_zero(self%scene)
   self%rules = rules_of_scene(self%scene)
   self%load_pressure = pressure_scale(self%scene)
   allocate (self%problem)
   end procedure prepare

   module procedure visit

   ! As the next step does at its beginning.
   if (.not. archive%is_loading) then
      call discard(self%kept_problem)
      if (self%scene%growth%intensities) then
         call self%windows%begin_step()
         call self%reference%begin_step()
      end if
   end if
   call visit_simulation(archive, self)
   call archive%item("growth_was_enabled", self%scene%growth%was_enabled)
   call visit_mesher_and_mesh(archive, "mesh", self%problem%mesher, self%problem%mesh)
   associate (mesh => self%problem%mesh)
      if (archive%is_loading .and. .not. allocated(archive%fault)) then
         if (mesh%n_cells == 0) then
            call archive%set_fault("mesh")
         else
            call archive%compare_range("mesh", mesh%face_side, "; 0:sides")
         end if
      end if
      call archive%set_extent("all_wells", size(self%scene%injections, kind=ik))
      call archive%set_extent("cells", mesh%n_cells)
      call archive%set_extent("nodes", mesh%n_nodes)
      call archive%set_extent("fcells", mesh%fracture%n_cells)
      call archive%set_extent("mesh_tips", mesh%fracture%n_tips)
   end associate
   call visit_levels(archive, "now", self%now)
   if (archive%is_loading) call check_places(archive, self%front_state_t, self%now)
   ! The next step begins with the present state: of the one before only its time is needed.
   call archive%item("before_time", self%before%time)
   if (allocated(self%scene%heat)) then
      call self%now%heat%visit(archive)
      call self%blurred%visit(archive)
   end if
   if (archive%is_loading .and. .not. allocated(archive%fault)) then
      call follow_sides(self%scene, self%now%coarse%time, self%before%time)
   end if
   call visit_problem(archive, self, timers, error)
   if (allocated(error) .or. allocated(archive%fault)) return
   call visit_windows(archive, "windows", self%windows, self%now%windows%tip, self, error)
   if (allocated(error) .or. allocated(archive%fault)) return
   call visit_windows(archive, "reference", self%reference, self%now%reference%tip, self, error)
   if (allocated(error) .or. allocated(archive%fault)) return
   call visit_control(archive, self)
   if (allocated(self%problem%heat)) self%summary%heat = heat_row(self%now%heat)
   if (archive%is_loading) call go_beyond_end(self)
   end procedure visit

   !> The tips are at the ends of the network, and where their segments say, which end in the last
   !! coarse cells.
   subroutine check_places(archive, front, now)
      type(archive_t), intent(inout) :: archive
      type(front_state_t), intent(in) :: front
      type(levels_state_t), intent(in) :: now
      real(rk), parameter :: rounding = 1.0e-9_rk
      real(rk) :: longest, place(2), scale
      logical :: fits
      integer(ik) :: i

      if (allocated(archive%fault) .or. .not. allocated(front%tip)) return
      fits = allocated(now%coarse_network%first)
      if (fits) fits = size(now%coarse_network%first) == size(front%network%first)
      if (.not. fits) then
         call archive%set_fault("coarse_network")
         return
      end if
      do i = 1, size(front%tip, kind=ik)
         associate (tip => front%tip(i), coarse => now%coarse_network)
            if (.not. tip%is_free) cycle
            place = end_place(front%network, tip%fracture, tip%end)
            scale = rounding*maxval(abs(place))
            if (allocated(now%segment)) then
               associate (segment => now%segment(i))
                  longest = norm2(end_place(coarse, tip%fracture, tip%end) - segment%start)
                  if (segment%is_open) place = segment%place()
                  if (segment%is_open .and. .not. (segment%length > 0.0_rk .and. segment%length &
                                                   <= (1.0_rk + rounding)*longest)) then
                     call archive%set_fault("segment")
                  end if
               end associate
            end if
            if (.not. norm2(place - tip%xy) <= scale) call archive%set_fault("tip")
         end associate
      end do
   end subroutine check_places

   !> A run that has ended at the end of its scene goes on if the scene ends later now; unless a
   !! stage ends there too, its last step does not count as one before a switch.
   subroutine go_beyond_end(self)
      class(two_levels_t), intent(inout) :: self

      if (.not. allocated(self%ending)) return
      associate (time => self%now%coarse%time)
         if (self%ending /= at_end .or. &
             .not. time < self%scene%time%end*(1.0_rk - same_time)) return
         deallocate (self%ending)
         self%step%ends_at_switch = next_switch(self%scene, self%before%time) &
                                    <= time*(1.0_rk + same_time)
      end associate
   end subroutine go_beyond_end

   !> Coarse mesh and fracture cells; the model is discretized and factorized again.
   subroutine visit_problem(archive, self, timers, error)
      type(archive_t), intent(inout) :: archive
      class(two_levels_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      call archive%enter("problem")
      associate (problem => self%problem, model => self%problem%model)
         call archive%item("first_step", model%first_step)
         call visit_cells(archive, "cells", model%cells)
         call archive%list("share", problem%share, "fcells, entries ?")
        if (archive%is_loading .and. .not. allocated(problem%share)) call archive%set_fault("share")
         if (allocated(archive%fault)) return
         if (archive%is_loading) then
            call model%set_mesh(problem%mesh, self%scene, timers, error)
            if (allocated(error)) return
            call problem%feed_wells(self%scene, error)
            if (.not. allocated(error)) call set_heat(self%scene, problem, error)
            if (allocated(error)) return
            associate (growth => self%scene%growth)
               if (growth%was_enabled .and. growth%leaves_partial_cells() .and. &
                   allocated(self%now%segment)) then
                  call place_tips(self%front_state_t, self%now%segment, problem)
               end if
            end associate
            if (allocated(self%problem%heat)) then
               call archive%compare_extent("heat", self%problem%heat%n)
            end if
            call archive%compare_extent("blocks", model%regions%n_blocks)
            call archive%compare_extent("corners", model%regions%traction_count())
            call archive%compare_extent("pairs", size(model%connections, 2, kind=ik))
            call archive%compare_extent("branches", model%joints%branch_count())
            call archive%compare_extent("joints", model%joints%n)
            call archive%compare_extent("wells", model%wells%n_all)
            call archive%compare_extent("rock_wells", model%rock_wells%n)
            if (allocated(archive%fault)) return
         end if
         call visit_step_values(archive, "step", model)
         if (archive%is_loading) call act(self%scene, problem, self%now%heat)
         call visit_factors(archive, "factors", model, problem%mesh, error)
         if (allocated(error)) return
         call visit_values(archive, "values", problem%values)
      end associate
      call archive%leave()
   end subroutine visit_problem

   !> Windows between two steps: each has the mesh of the accepted state.
   subroutine visit_windows(archive, name, windows, tips, self, error)
      type(archive_t), intent(inout) :: archive
      character(len=*), intent(in) :: name
      type(windows_t), intent(inout) :: windows
      type(window_tip_t), allocatable, intent(in) :: tips(:)
      class(two_levels_t), intent(in) :: self
      type(error_t), allocatable, intent(out) :: error
      integer(lk) :: n, w

      call archive%enter(name)
      call archive%extent("slot", windows%slot, n, "history_"//name//" ?")
      if (archive%is_loading .and. n >= 0_lk) allocate (windows%slot(n))
      call archive%list("window_of", windows%window_of, "tips ?")
      call archive%list("resistance", windows%resistance, "tips ?")
      call archive%agree(name, [allocated(windows%slot), allocated(windows%window_of), &
                                allocated(windows%resistance)])
      call archive%item("is_beside_body", windows%is_beside_body)
      if (archive%is_loading .and. allocated(windows%window_of)) then
         if (any(windows%window_of < 1 .or. windows%window_of > n)) call archive%set_fault(name)
      end if
      do w = 1_lk, n
         if (archive%is_loading) allocate (windows%slot(w)%window)
         call windows%slot(w)%window%visit(archive, self%scene, self%problem%mesher, &
                                           self%problem%mesh, self%problem%values, tips, error)
         if (allocated(error) .or. allocated(archive%fault)) return
      end do
      call archive%leave()
   end subroutine visit_windows

   !> Step control, and results of all steps so far.
   subroutine visit_control(archive, self)
      type(archive_t), intent(inout) :: archive
      class(two_levels_t), intent(inout) :: self

      call archive%enter("control")
      call archive%item("reference_most", self%reference_most)
      call archive%item("has_begun", self%has_begun)
      call archive%item("is_initial", self%is_initial)
      call archive%enter("last_step")
      call archive%item("dt", self%step%dt)
      call archive%item("is_after_switch", self%step%is_after_switch)
      call archive%item("ends_at_switch", self%step%ends_at_switch)
      call archive%item("refined", self%step%refined)
      call archive%item("is_unstable", self%step%is_unstable)
      call visit_report(archive, "report", self%step%report)
      call archive%list("why_cut", self%step%why_cut)
      call archive%list("places", self%step%places)
      call archive%leave()
      call archive%item("begins_stage", self%begins_stage)
      call visit_stepper(archive, "stepper", self%stepper)
      call self%pace%visit(archive)
      call self%notes%visit(archive)
      call self%stimulation%visit(archive)
      call self%well_results%visit(archive)
      call visit_value_errors(archive, "value_errors", self%value_errors)
      call archive%item("seismic_moment", self%seismic_moment)
      call archive%item("compared_unknowns", self%compared_unknowns)
      call archive%leave()
   end subroutine visit_control

end submodule twolevel_restart
