!> Simulation of a scene without a fluid: the load follows its programme in steps, and from one
!! onset of growth to the next.
module mechanics_simulation
   use base_archive, only: archive_t
   use base_errors, only: error_t
   use base_kinds, only: ik, lk, rk
   use base_number, only: brief_text, integer_text
   use base_timers, only: timers_t
   use mechanics_dead_load, only: dead_load_t
   use mechanics_equilibrium, only: increment_t
   use mechanics_programme, only: programme_t
   use mechanics_results, only: body_snapshot, history_of_body, probes_of_body, touches, watch_body
   use mechanics_rise, only: go_to_peak, rise
   use mechanics_state, only: loaded_body_t, together
   use mesh_archive, only: visit_mesh, visit_network
   use mesh_types, only: mesh_t, network_t
   use report_fields_archive, only: visit_snapshot
   use report_restart, only: visit_simulation
   use report_rows, only: event_bifurcation, event_growth_uncertain, history_row_t, probe_row_t
   use report_simulation, only: snapshot_t
   use report_watch, only: doubtful, see_doubt, uncertainty
   use scene_sizes, only: sizes_text
   use scene_types, only: scene_t
   implicit none(type, external)
   private

   public :: mechanics_simulation_t

   !> A scene without a fluid, with the position in its load programme.
   type, extends(loaded_body_t) :: mechanics_simulation_t
      type(programme_t) :: programme
      logical :: has_onset = .false.  !< growth has stopped the load
      real(rk) :: accepted_factor = 0.0_rk  !< load factor of the last accepted state [-]
      logical :: has_increment = .false.  !< growth in equilibrium has found the next state
      type(increment_t) :: increment
      type(dead_load_t) :: dead_load
      logical :: was_bifurcation = .false.  !< the last increment was a bifurcation
      logical, allocatable :: was_uncertain(:)  !< (tips) at the last onset
      type(network_t) :: shown_network  !< network of the accepted state
      type(mesh_t) :: shown_mesh  !< mesh of the accepted state
      type(snapshot_t), allocatable :: good  !< fields of the last accepted state
   contains
      procedure :: begin
      procedure :: next_state
      procedure :: grow
      procedure :: present_network
      procedure :: history
      procedure :: probes
      procedure :: snapshot
      procedure :: time
      procedure :: last_state
      procedure :: share_of_way
      procedure :: prepare
      procedure :: visit
   end type mechanics_simulation_t

contains

   !> Mesh the body without load.
   subroutine begin(self, scene, timers, error)
      class(mechanics_simulation_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      self%start_time = scene%load%from
      self%end_time = scene%load%to
      self%accepted_factor = scene%load%from
      call self%programme%begin(scene%load)
      call self%take_scene(scene)
      self%meshed_vertices = size(self%network%xy, 2)
      call self%body%build(scene, self%start, self%network, timers, error)
      if (allocated(error)) return
      call self%find_tips(self%body%mesh%fracture)
      call note_features(self)
   end subroutine begin

   !> Add the features that the scene uses, and those that it does not, to the summary.
   subroutine note_features(self)
      class(mechanics_simulation_t), intent(inout) :: self

      associate (scene => self%scene, summary => self%summary)
         call summary%use_feature("elastic rock, finite elements on the whole body")
         call summary%leave_out_feature("pressure, flow and the coarse level: no fluid")
         call summary%note(size(scene%fractures) > 0, "fractures", "no fractures")
         call summary%note(scene%growth%intensities, "stress intensity factors", "intensities off")
         call summary%note(scene%growth%enabled, "growth", "remeshing: growth off")
         call summary%note(scene%adaptive%enabled, "adaptive meshes", "error estimates: off")
         call summary%note(scene%output%vtu, "VTU files", "VTU files: off")
         if (scene%discretization%chosen) then
            call summary%use_feature("default sizes: "//sizes_text(scene))
         end if
      end associate
   end subroutine note_features

   !> Change the load to the end of the programme's step, or to the next onset of growth. The state
   !! after an increment of growth in equilibrium is accepted at its load.
   subroutine next_state(self, timers, error)
      class(mechanics_simulation_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error

      if (.not. self%has_increment) then
         call begin_part(self)
         self%has_onset = .false.
         if (.not. self%owes_state) then
            call rise(self, self%programme%target(), self%has_onset, timers, error)
         end if
         if (allocated(error)) return
      end if
      call watch_body(self)
      call self%heed_limits(error)
      if (allocated(error)) return
      self%shows_growth = self%has_onset .or. self%owes_state .or. self%has_increment
      self%accepted_factor = self%factor
      call note_state(self)
   end subroutine next_state

   !> Take the bounds of the programme's part; where they change, the path segments of the tips end.
   subroutine begin_part(self)
      class(mechanics_simulation_t), intent(inout) :: self

      associate (bounds => self%programme%bounds())
         if (any(abs(bounds - self%bounds) > 0.0_rk)) call self%increment%end_paths()
         self%bounds = bounds
      end associate
   end subroutine begin_part

   !> Add an accepted state to the summary and the event log, and keep its fields.
   subroutine note_state(self)
      class(mechanics_simulation_t), intent(inout) :: self
      logical :: closes(size(self%scene%fractures))
      character(len=120) :: remark

      associate (body => self%body, summary => self%summary)
         summary%steps = summary%steps + 1
         summary%contact_residual = max(summary%contact_residual, body%contact%residual)
         summary%has_growth = self%scene%growth%enabled
         summary%meshes_whole = body%whole_meshes
         summary%meshes_patched = body%patched_meshes
         summary%cells = body%mesh%n_cells
         summary%fracture_cells = body%mesh%fracture%n_cells
         if (summary%smallest_angle > body%smallest_angle .or. &
             .not. summary%smallest_angle > 0.0_rk) summary%smallest_angle = body%smallest_angle
         summary%energy_error = body%estimate%relative
         call summary%count_dofs("displacement", body%model%constraints%n_dofs)
         call summary%add_newton(body%contact%iterations)
         closes = touches(self%scene%fractures)
         call self%note_contact(body%mesh%fracture, body%contact%state(3, :), &
                                closes .and. self%scene%fractures%friction > 0.0_rk, closes)
         if (self%scene%adaptive%enabled) then
            write (remark, "(a,es13.6,a,es9.2,a,i0,a)") "load factor ", self%factor, &
               ": estimated error in the energy norm ", body%estimate%relative, ", ", &
               body%mesh%n_cells, " elements"
            call self%chronicle%add_remark(trim(remark))
         end if
      end associate
      self%good = body_snapshot(self)
   end subroutine note_state

   !> Let the tips at their onset grow by one increment.
   subroutine grow(self, timers, error)
      class(mechanics_simulation_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      logical :: any_grew

      if (self%scene%growth%in_equilibrium()) then
         call grow_in_equilibrium(self, timers, error)
         return
      end if
      any_grew = .false.
      if (self%has_onset) then
         call self%grow_tips(any_grew, timers, error)
         if (self%is_cut) then  ! no equilibrium is left, and that is how the scene ends
            self%ending = "a part of the body has separated"//self%programme%not_reached()
            if (allocated(error)) deallocate (error)
         end if
         if (allocated(error)) return
      else
         self%tip%advance = 0.0_rk
         if (.not. self%owes_state) then
            call self%programme%advance(self%factor)
            if (self%programme%is_over()) self%ending = "the scene's last load factor"
         end if
         self%owes_state = .false.
      end if
      if (self%scene%growth%intensities) call self%note_tips()
      if (.not. any_grew) return
      call self%note_growth()
      call self%note_mesh(self%body%mesh)
      self%summary%increments = self%summary%increments + 1
      if (self%is_cut) return
      call self%end_at_gain()
      self%owes_state = allocated(self%ending)
   end subroutine grow

   !> Log the tips of the present state. Tips with K_eq = K_IC grow by an increment to the next
   !! state, which next_state accepts.
   subroutine grow_in_equilibrium(self, timers, error)
      class(mechanics_simulation_t), intent(inout) :: self
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: limit  ! of the load [-]

      if (self%has_increment) then
         call note_increment(self)
      else
         self%tip%advance = 0.0_rk
         call self%note_tips()
      end if
      self%has_increment = .false.
      self%shown_network = self%network
      self%shown_mesh = self%body%mesh
      if (.not. allocated(self%ending) .and. self%has_onset) then
         call note_uncertain(self, error)
         if (allocated(error)) return
         call self%dead_load%begin_increment(self)
         call find_limit(self, limit, timers, error)
         if (.not. allocated(error)) call self%increment%take(self, limit, timers, error)
         if (self%increment%has_grown .and. .not. allocated(error)) then
            call self%dead_load%end_increment(self, self%increment%is_loose, timers, error)
         end if
         if (self%is_cut) then  ! no equilibrium is left, and that is how the scene ends
            self%ending = "a part of the body has separated"//self%programme%not_reached()
            if (allocated(error)) deallocate (error)
            call self%note_growth()
            call self%note_mesh(self%body%mesh)
            self%summary%increments = self%summary%increments + 1
            self%shown_network = self%network
            self%shown_mesh = self%body%mesh
         end if
         if (allocated(error)) return
         self%has_increment = self%increment%has_grown .and. .not. self%is_cut
         self%has_onset = self%increment%holds
      end if
      if (.not. (self%has_increment .or. allocated(self%ending))) then
         call self%programme%advance(self%factor)
         if (self%programme%is_over()) self%ending = "the scene's last load factor"
      end if
      if (allocated(self%ending)) call self%dead_load%stop_growth(self)
   end subroutine grow_in_equilibrium

   !> Load factor up to which the load drives the tips: the end of the programme's part, or for
   !! loads that change direction that of the largest K_eq.
   subroutine find_limit(self, limit, timers, error)
      class(mechanics_simulation_t), intent(inout) :: self
      real(rk), intent(out) :: limit  !< [-]
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: begun

      limit = self%bounds(2)
      if (.not. self%turns) return
      begun = self%factor
      call self%accept()
      call go_to_peak(self, limit, timers, error)
      limit = self%factor
      if (.not. allocated(error)) call self%respond(begun, timers, error)
   end subroutine find_limit

   !> Report tips that grow, or might grow within the error of their intensities: to the limits of
   !! the run, which end it where K is not known at all, and as an event at the first such onset of
   !! each tip.
   subroutine note_uncertain(self, error)
      class(mechanics_simulation_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      logical :: is_uncertain(size(self%tip))
      integer(ik) :: i

      is_uncertain = doubtful(self%tip, self%rules%toughness)
      if (.not. allocated(self%was_uncertain)) then
         self%was_uncertain = spread(.false., 1, size(self%tip))
      end if
      do i = 1, size(self%tip, kind=ik)
         if (.not. is_uncertain(i)) cycle
         associate (tip => self%tip(i), toughness => self%rules%toughness)
            call see_doubt(self%watch, tip, toughness, self%scene%fractures(tip%fracture)%name, &
                           self%last_state())
            if (self%was_uncertain(i)) cycle
            call self%chronicle%add_event(self%time(), event_growth_uncertain, "K known to "// &
                                          brief_text(uncertainty(tip, toughness), 3)// &
                                          " % of K_IC or K_eq: load factor of growth known to "// &
                                          "as much", tip%fracture, tip%xy)
         end associate
      end do
      self%was_uncertain = is_uncertain
      call self%heed_limits(error)
   end subroutine note_uncertain

   !> Log the increment of growth that led to the present state.
   subroutine note_increment(self)
      class(mechanics_simulation_t), intent(inout) :: self

      call self%note_tips(grew_in_step=.true.)
      call self%note_growth()
      call self%note_mesh(self%body%mesh)
      call note_competition(self)
      call self%dead_load%note_end(self)
      self%summary%increments = self%summary%increments + 1
      call self%end_at_gain()
   end subroutine note_increment

   !> Log bifurcations, where one of several tips could lead, and states that miss the equilibrium.
   subroutine note_competition(self)
      class(mechanics_simulation_t), intent(inout) :: self
      real(rk), parameter :: largest_misfit = 1.0e-2_rk
      logical :: is_bifurcation

      associate (increment => self%increment)
         is_bifurcation = size(increment%group) > 1 .and. increment%preference > 2.0_rk*together
         if (is_bifurcation .and. .not. self%was_bifurcation) then
            call self%chronicle%add_event(self%time(), event_bifurcation, &
                                          integer_text(size(increment%group, kind=ik))// &
                                          " tips grow equally; a lead of one increment changes "// &
                                          "K_eq by "// &
                                          brief_text(100.0_rk*increment%preference, 3)//" %")
         end if
         self%was_bifurcation = is_bifurcation
         if (increment%misfit > largest_misfit) then
            call self%chronicle%add_remark("warning: K_eq of a growing tip is "// &
                                           brief_text(100.0_rk*increment%misfit, 3)// &
                                           " % below K_IC at load factor "// &
                                           brief_text(self%factor, 6))
            call self%summary%warn("some growing tips are more than 1 % below K_IC (see "// &
                                   "run.log); reduce increment")
         end if
      end associate
   end subroutine note_competition

   !> Network and mesh of the accepted state.
   subroutine present_network(self, network, mesh)
      class(mechanics_simulation_t), intent(in) :: self
      type(network_t), intent(out) :: network
      type(mesh_t), intent(out) :: mesh

      network = self%network
      mesh = self%body%mesh
      if (.not. (self%scene%growth%in_equilibrium() .and. allocated(self%shown_network%xy))) return
      network = self%shown_network
      mesh = self%shown_mesh
   end subroutine present_network

   !> The accepted state in a row of history.csv.
   function history(self) result(row)
      class(mechanics_simulation_t), intent(in) :: self
      type(history_row_t) :: row

      row = history_of_body(self)
   end function history

   !> Displacement and stress at the probes.
   subroutine probes(self, row, error)
      class(mechanics_simulation_t), intent(inout) :: self
      type(probe_row_t), intent(out) :: row
      type(error_t), allocatable, intent(out) :: error

      call probes_of_body(self, row, error)
   end subroutine probes

   !> Fields of the last accepted state.
   subroutine snapshot(self, fields)
      class(mechanics_simulation_t), intent(in) :: self
      type(snapshot_t), allocatable, intent(out) :: fields

      if (allocated(self%good)) fields = self%good
   end subroutine snapshot

   !> The accepted load factor, instead of a time [-].
   pure real(rk) function time(self)
      class(mechanics_simulation_t), intent(in) :: self

      time = self%accepted_factor
   end function time

   !> Completed fraction of the load programme [-].
   pure real(rk) function share_of_way(self) result(share)
      class(mechanics_simulation_t), intent(in) :: self

      share = self%programme%share_done(self%accepted_factor)
   end function share_of_way

   !> The last accepted load factor in words.
   pure function last_state(self) result(words)
      class(mechanics_simulation_t), intent(in) :: self
      character(len=:), allocatable :: words

      words = "load factor "//brief_text(self%accepted_factor, 6)
   end function last_state

   !> Set up for a scene, without meshes.
   subroutine prepare(self, scene)
      class(mechanics_simulation_t), intent(inout) :: self
      type(scene_t), intent(in) :: scene

      self%end_time = scene%load%to
      call self%programme%begin(scene%load)
      call self%take_scene(scene)
      call self%chronicle%clear()
   end subroutine prepare

   !> Store or load the complete state (docs/architecture.md).
   subroutine visit(self, archive, timers, error)
      class(mechanics_simulation_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive
      type(timers_t), intent(inout) :: timers
      type(error_t), allocatable, intent(out) :: error
      integer(lk) :: n

      call visit_simulation(archive, self)
      if (allocated(archive%fault)) return
      call self%body%visit(archive, self%scene, self%start, self%network, timers, error)
      if (allocated(error) .or. allocated(archive%fault)) return
      call archive%enter("loaded_body")
      call archive%item("is_cut", self%is_cut)
      call archive%item("meshed_vertices", self%meshed_vertices)
      call archive%item("is_trying", self%is_trying)
      call archive%item("factor", self%factor)
      call archive%item("bounds", self%bounds)
      call archive%item("accepted_moment", self%accepted_moment)
      call archive%leave()
      call self%programme%visit(archive)
      call archive%item("has_onset", self%has_onset)
      call archive%item("accepted_factor", self%accepted_factor)
      call archive%item("has_increment", self%has_increment)
      call self%increment%visit(archive)
      call self%dead_load%visit(archive)
      call archive%item("was_bifurcation", self%was_bifurcation)
      call archive%list("was_uncertain", self%was_uncertain, "tips ?")
      call visit_network(archive, "shown_network", self%shown_network)
      call visit_mesh(archive, "shown_mesh", self%shown_mesh)
      n = merge(1_lk, -1_lk, allocated(self%good))
      call archive%count("good", n)
      if (archive%is_loading .and. n > 0_lk) allocate (self%good)
      if (n > 0_lk) call visit_snapshot(archive, "good", self%good)
   end subroutine visit

end module mechanics_simulation
