!> A running simulation of a scene, with or without a fluid: from one accepted state to the next,
!! with growth of the tips in between; and the data for its files.
module report_simulation
   use base_errors, only: error_t
   use base_kinds, only: degrees, ik, rk
   use base_texts, only: text_t
   use base_timers, only: timers_t
   use contact_law, only: state_open, state_slip
   use fine_tip_types, only: complete_errors, intensity_t
   use growth_front, only: front_t
   use growth_law, only: growth_drive, growth_drive_t
   use growth_network, only: end_gain
   use growth_targets, only: target_boundary
   use growth_tip, only: tip_t
   use mesh_geometry, only: fracture_cell_centre
   use mesh_types, only: fracture_mesh_t, mesh_t, network_t
   use report_rows, only: chronicle_t, event_arrest, event_growth, event_joint, event_opening, &
                          event_remesh, event_slip_onset, fracture_fields_t, history_row_t, &
                          intersection_fields_t, matrix_fields_t, probe_row_t, summary_t, &
                          tip_errors_t, tip_row_t, window_fields_t
   use report_slip, only: slip_catalogue_t, slip_step_t
   use report_watch, only: watch_t
   use scene_plausible, only: doubts_of_scene
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: simulation_t, snapshot_t

   !> The fields of a state with their mesh.
   type :: snapshot_t
      real(rk) :: time = -huge(1.0_rk)  !< [s]; without a fluid the load factor [-]
      type(mesh_t) :: mesh
      type(matrix_fields_t) :: matrix
      type(fracture_fields_t) :: fracture
      type(intersection_fields_t) :: intersection
      type(window_fields_t), allocatable :: windows  !< unallocated: not requested
   end type snapshot_t

   !> A running simulation.
   type, abstract, extends(front_t) :: simulation_t
      type(scene_t) :: scene
      type(chronicle_t) :: chronicle  !< event log since the files were last written
      type(summary_t) :: summary  !< summary of the run so far
      type(watch_t) :: watch  !< limits of the run that were exceeded
      type(slip_catalogue_t) :: catalogue  !< slip events; with a fluid
      !> reason for the end of the run; unallocated before it
      character(len=:), allocatable :: ending
      logical :: owes_state = .false.  !< the run ends after one more state
      logical :: shows_growth = .false.  !< the present state belongs to an increment of growth
      real(rk) :: start_time = 0.0_rk  !< start of the scene, in the unit of time()
      real(rk) :: end_time = 0.0_rk  !< end of the scene, in the unit of time()
      logical, allocatable :: has_slipped(:), has_opened(:)  !< (fractures) logged slip or opening
      !> (tips) estimated errors of their positions; unallocated: none [m]
      real(rk), allocatable :: position_error(:)
   contains
      procedure(begin_scene), deferred :: begin
      procedure(go_on), deferred :: next_state
      procedure(go_on), deferred :: grow
      procedure(network_and_mesh), deferred :: present_network
      procedure(row_of_history), deferred :: history
      procedure(row_of_probes), deferred :: probes
      procedure(fields_of_state), deferred :: snapshot
      procedure(time_of_state), deferred :: time
      procedure(name_of_state), deferred :: last_state
      procedure :: set_scene
      procedure :: is_over
      procedure :: note_contact
      procedure :: note_slip
      procedure :: end_slip
      procedure :: note_tips
      procedure :: note_growth
      procedure :: note_mesh
      procedure :: end_at_gain
      procedure :: keq_over_kic
      procedure :: share_done
      procedure :: share_of_way
      procedure :: heed_limits
      procedure :: tell_limits
   end type simulation_t

   abstract interface
      !> Mesh and set up without load, and add the features of the scene to the summary.
      subroutine begin_scene(self, scene, timers, error)
         import :: error_t, scene_t, simulation_t, timers_t
         implicit none(type, external)
         class(simulation_t), intent(inout) :: self
         type(scene_t), intent(in) :: scene
         type(timers_t), intent(inout) :: timers
         type(error_t), allocatable, intent(out) :: error
      end subroutine begin_scene

      !> next_state: find the next accepted state. grow: let the tips grow in this state. Both set
      !! `ending` at the end of the scene, and add to event log and summary.
      subroutine go_on(self, timers, error)
         import :: error_t, simulation_t, timers_t
         implicit none(type, external)
         class(simulation_t), intent(inout) :: self
         type(timers_t), intent(inout) :: timers
         type(error_t), allocatable, intent(out) :: error
      end subroutine go_on

      !> The network and the mesh of the present state.
      subroutine network_and_mesh(self, network, mesh)
         import :: mesh_t, network_t, simulation_t
         implicit none(type, external)
         class(simulation_t), intent(in) :: self
         type(network_t), intent(out) :: network
         type(mesh_t), intent(out) :: mesh
      end subroutine network_and_mesh

      !> The row of history.csv of the accepted state.
      function row_of_history(self) result(row)
         import :: history_row_t, simulation_t
         implicit none(type, external)
         class(simulation_t), intent(in) :: self
         type(history_row_t) :: row
      end function row_of_history

      !> The row of probes.csv of the accepted state.
      subroutine row_of_probes(self, row, error)
         import :: error_t, probe_row_t, simulation_t
         implicit none(type, external)
         class(simulation_t), intent(inout) :: self
         type(probe_row_t), intent(out) :: row
         type(error_t), allocatable, intent(out) :: error
      end subroutine row_of_probes

      !> The fields of the last accepted state; not allocated if there is none.
      subroutine fields_of_state(self, fields)
         import :: simulation_t, snapshot_t
         implicit none(type, external)
         class(simulation_t), intent(in) :: self
         type(snapshot_t), allocatable, intent(out) :: fields
      end subroutine fields_of_state

      !> The time of the present state [s], or without a fluid its load factor [-].
      pure function time_of_state(self) result(time)
         import :: rk, simulation_t
         implicit none(type, external)
         class(simulation_t), intent(in) :: self
         real(rk) :: time
      end function time_of_state

      !> The last accepted state in words for messages: a time, a load factor.
      pure function name_of_state(self) result(words)
         import :: simulation_t
         implicit none(type, external)
         class(simulation_t), intent(in) :: self
         character(len=:), allocatable :: words
      end function name_of_state
   end interface

contains

   !> Set the scene, and add the warnings of its plausibility checks.
   subroutine set_scene(self, scene)
      class(simulation_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(text_t), allocatable :: doubts(:)
      integer :: i

      self%scene = scene
      if (.not. allocated(self%scene%injections)) allocate (self%scene%injections(0))
      call self%chronicle%clear()
      doubts = doubts_of_scene(scene)
      do i = 1, size(doubts)
         call self%summary%warn(doubts(i)%text)
         call self%chronicle%add_remark("warning: "//doubts(i)%text)
      end do
      allocate (self%has_slipped(size(scene%fractures)), source=.false.)
      allocate (self%has_opened(size(scene%fractures)), source=.false.)
   end subroutine set_scene

   !> The run is at its end.
   pure logical function is_over(self)
      class(simulation_t), intent(in) :: self

      is_over = allocated(self%ending) .and. .not. self%owes_state
   end function is_over

   !> Add events of the first slip and the first opening of each fracture. Fractures with `slips` or
   !! `opens` false do so from the start, without an event.
   pure subroutine note_contact(self, fracture, state, slips, opens)
      class(simulation_t), intent(inout) :: self
      type(fracture_mesh_t), intent(in) :: fracture
      integer(ik), intent(in) :: state(:)  !< (fracture cells) of contact_law
      logical, intent(in) :: slips(:), opens(:)  !< (fractures)
      real(rk) :: centre(2)
      integer(ik) :: cell, f

      do cell = 1, fracture%n_cells
         f = fracture%cell_fracture(cell)
         centre = fracture_cell_centre(fracture, cell)
         if (state(cell) == state_slip .and. slips(f) .and. .not. self%has_slipped(f)) then
            self%has_slipped(f) = .true.
            call self%chronicle%add_event(self%time(), event_slip_onset, "first slip", f, centre)
         else if (state(cell) == state_open .and. opens(f) .and. .not. self%has_opened(f)) then
            self%has_opened(f) = .true.
            call self%chronicle%add_event(self%time(), event_opening, "first opening", f, centre)
         end if
      end do
   end subroutine note_contact

   !> Add the slip of the step that led to the present state to the slip events.
   pure subroutine note_slip(self, fracture, step)
      class(simulation_t), intent(inout) :: self
      type(fracture_mesh_t), intent(in) :: fracture
      type(slip_step_t), intent(in) :: step

      call self%catalogue%follow(self%time(), fracture, step)
      call list_events(self)
   end subroutine note_slip

   !> End the slip events that last to the end of the run.
   pure subroutine end_slip(self)
      class(simulation_t), intent(inout) :: self

      if (.not. allocated(self%catalogue%news)) return
      call self%catalogue%end_all()
      call list_events(self)
   end subroutine end_slip

   !> Move the slip events that have ended to the event log.
   pure subroutine list_events(self)
      class(simulation_t), intent(inout) :: self

      associate (news => self%catalogue%news)
         if (size(news) == 0) return
         self%chronicle%slip_events = [self%chronicle%slip_events, news]
         self%catalogue%news = news(:0)
      end associate
   end subroutine list_events

   !> Add a row per free tip to the event log. If any tip has just grown at this time, the rows have
   !! the values before that growth, unless the growth belongs to the step that led to the state.
   pure subroutine note_tips(self, grew_in_step, load_errors)
      class(simulation_t), intent(inout) :: self
      logical, intent(in), optional :: grew_in_step  !< default: no
      !> (2, tips) errors of K_I, K_II by those of the load of the faces; default: 0 [Pa m^1/2]
      real(rk), intent(in), optional :: load_errors(:, :)
      real(rk) :: added(2, size(self%tip))
      type(tip_row_t) :: row
      logical :: any_grew
      integer(ik) :: i

      any_grew = any(self%tip%advance > 0.0_rk)
      if (present(grew_in_step)) any_grew = any_grew .and. .not. grew_in_step
      added = 0.0_rk
      if (present(load_errors)) added = load_errors
      do i = 1, size(self%tip, kind=ik)
         if (.not. self%tip(i)%has_state(is_before=any_grew)) cycle
         row = row_of_tip(self%time(), i, self%tip(i), any_grew, added(:, i))
         row%apparent_toughness = self%tip(i)%viscous_rise*resistance_of(self%tip(i), any_grew) &
                                  *self%rules%toughness
         row%error%position = -1.0_rk
         if (allocated(self%position_error)) row%error%position = self%position_error(i)
         self%chronicle%tips = [self%chronicle%tips, row]
         associate (summary => self%summary, resistance => resistance_of(self%tip(i), any_grew))
            if (over_toughness(self%scene, row%keq/resistance) > summary%keq_over_kic) then
               summary%keq_over_kic = over_toughness(self%scene, row%keq/resistance)
               summary%extreme_error(1) = over_toughness(self%scene, row%error%keq/resistance)
            end if
         end associate
      end do
   end subroutine note_tips

   !> K_IC at a tip over that of the scene's rock [-].
   pure real(rk) function resistance_of(tip, is_before)
      type(tip_t), intent(in) :: tip
      logical, intent(in) :: is_before  !< before the last increment

      resistance_of = tip%drive%resistance
      if (is_before) resistance_of = tip%drive_before%resistance
   end function resistance_of

   !> The row of a tip, before the last increment or after it.
   pure function row_of_tip(time, i, tip, is_before, added) result(row)
      real(rk), intent(in) :: time  !< [s]
      integer(ik), intent(in) :: i  !< number of the tip
      type(tip_t), intent(in) :: tip
      logical, intent(in) :: is_before
      real(rk), intent(in) :: added(2)  !< to the errors of K_I, K_II [Pa m^1/2]
      type(tip_row_t) :: row
      type(tip_t) :: shown

      shown = tip
      if (is_before) then
         shown%intensity = tip%intensity_before
         shown%drive = tip%drive_before
      end if
      row%angle = shown%drive%angle
      if (is_before .and. tip%advance > 0.0_rk) then
         shown%xy = tip%origin
         row%angle = tip%kink
      end if
      row%time = time
      row%tip = i
      row%fracture = tip%fracture
      row%xy = shown%xy
      row%advance = tip%advance
      row%keq = shown%drive%intensity*shown%drive%resistance
      row%g = shown%drive%energy
      associate (intensity => shown%intensity)
         if (any(added > 0.0_rk)) then
            intensity%k1_error = intensity%k1_error + added(1)
            intensity%k2_error = intensity%k2_error + added(2)
            call complete_errors(shown%drive%crack_modulus, intensity)
         end if
         row%intensity = intensity
         call propagate(intensity, shown%drive%crack_modulus, row%error)
      end associate
   end function row_of_tip

   !> Errors of K_eq, of the energy release rate and of the kink from those of K_I and K_II: the
   !! largest differences at the four corners of their range.
   pure subroutine propagate(k, modulus, error)
      type(intensity_t), intent(in) :: k
      real(rk), intent(in) :: modulus  !< E' [Pa]
      type(tip_errors_t), intent(inout) :: error
      type(growth_drive_t) :: corner, middle
      integer :: i, j

      if (.not. modulus > 0.0_rk) return
      middle = growth_drive(k%k1, k%k2, modulus)
      do j = -1, 1, 2
         do i = -1, 1, 2
            corner = growth_drive(k%k1 + i*k%k1_error, k%k2 + j*k%k2_error, modulus)
            error%keq = max(error%keq, abs(corner%intensity - middle%intensity))
            error%g = max(error%g, abs(corner%energy - middle%energy))
            error%angle = max(error%angle, abs(corner%angle - middle%angle))
         end do
      end do
   end subroutine propagate

   !> Add events of the tips that have grown in the last increment, joined a target or stopped next
   !! to one.
   subroutine note_growth(self)
      class(simulation_t), intent(inout) :: self
      character(len=64) :: detail
      integer(ik) :: i

      do i = 1, size(self%tip, kind=ik)
         associate (tip => self%tip(i), chronicle => self%chronicle)
            if (tip%advance > 0.0_rk) then
               write (detail, "(a,es10.3,a,f7.2,a)") "advance ", tip%advance, " m, kink ", &
                  tip%kink*degrees, " deg"
               call chronicle%add_event(self%time(), event_growth, trim(detail), tip%fracture, &
                                        tip%xy)
               if (tip%joined) call chronicle%add_event(self%time(), event_joint, "joins " &
                                                        //target_name(self%scene, tip), &
                                                        tip%fracture, tip%xy)
            else if (tip%has_just_stopped()) then
               call self%summary%warn("fracture "//trim(self%scene%fractures(tip%fracture)%name) &
                                      //" stopped growing next to "//target_name(self%scene, tip))
               call chronicle%add_event(self%time(), event_arrest, "next to " &
                                        //target_name(self%scene, tip), tip%fracture, tip%xy)
            end if
         end associate
      end do
   end subroutine note_growth

   !> Target of a tip in words.
   pure function target_name(scene, tip) result(name)
      type(scene_t), intent(in) :: scene
      type(tip_t), intent(in) :: tip
      character(len=:), allocatable :: name

      if (tip%target == target_boundary) then
         name = "the outer boundary"
      else if (tip%target == tip%fracture) then
         name = "its own fracture"
      else
         name = "fracture "//trim(scene%fractures(tip%target)%name)
      end if
   end function target_name

   !> Add the event of a mesh updated after growth.
   subroutine note_mesh(self, mesh)
      class(simulation_t), intent(inout) :: self
      type(mesh_t), intent(in) :: mesh
      character(len=64) :: detail

      write (detail, "(i0,a,i0,a)") mesh%n_cells, " cells, ", mesh%fracture%n_cells, &
         " fracture cells"
      call self%chronicle%add_event(self%time(), event_remesh, trim(detail))
      self%chronicle%has_new_network = .true.
   end subroutine note_mesh

   !> Largest present K_eq of the tips over K_IC of the scene's rock; 0 without a K_IC [-].
   pure function keq_over_kic(self) result(ratio)
      class(simulation_t), intent(in) :: self
      real(rk) :: ratio
      integer(ik) :: i

      ratio = 0.0_rk
      if (.not. allocated(self%tip)) return
      do i = 1, size(self%tip, kind=ik)
         ratio = max(ratio, over_toughness(self%scene, self%tip(i)%drive%intensity))
      end do
   end function keq_over_kic

   !> K_eq over K_IC of the scene's rock; 0 without a K_IC [-].
   pure function over_toughness(scene, keq) result(ratio)
      type(scene_t), intent(in) :: scene
      real(rk), intent(in) :: keq  !< [Pa m^1/2]
      real(rk) :: ratio

      ratio = 0.0_rk
      if (scene%material%toughness < huge(1.0_rk)) ratio = keq/scene%material%toughness
   end function over_toughness

   !> Completed fraction of the run, by its end or by stop_gain [-].
   pure function share_done(self) result(share)
      class(simulation_t), intent(in) :: self
      real(rk) :: share
      integer(ik) :: i

      share = self%share_of_way()
      if (.not. allocated(self%tip)) return
      do i = 1, size(self%tip, kind=ik)
         associate (tip => self%tip(i))
            share = max(share, end_gain(self%network, self%start, tip%fracture, tip%end) &
                        /self%scene%growth%stop_gain)
         end associate
      end do
   end function share_done

   !> Completed fraction of the run, by its end [-].
   pure real(rk) function share_of_way(self) result(share)
      class(simulation_t), intent(in) :: self

      share = (self%time() - self%start_time)/(self%end_time - self%start_time)
   end function share_of_way

   !> Set `ending` if an end of a fracture has grown by stop_gain.
   pure subroutine end_at_gain(self)
      class(simulation_t), intent(inout) :: self
      integer(ik) :: i

      i = findloc(self%has_gained(), .true., dim=1)
      if (i == 0) return
      self%ending = "fracture "//trim(self%scene%fractures(self%tip(i)%fracture)%name)// &
                    " has gained stop_gain"
   end subroutine end_at_gain

   !> Log the limits that were exceeded for the first time. An error if a limit stops the run.
   pure subroutine heed_limits(self, error)
      class(simulation_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      if (allocated(self%watch%news)) then
         do i = 1, size(self%watch%news)
            call self%chronicle%add_remark("warning: "//self%watch%news(i)%text)
         end do
         deallocate (self%watch%news)
      end if
      call self%watch%stop_run(error)
   end subroutine heed_limits

   !> Add all limits that were exceeded to the summary, at the end of a run.
   subroutine tell_limits(self)
      class(simulation_t), intent(inout) :: self
      type(text_t), allocatable :: sentences(:)
      integer :: i

      sentences = self%watch%sentences()
      do i = 1, size(sentences)
         call self%summary%warn(sentences(i)%text)
      end do
   end subroutine tell_limits

end module report_simulation
