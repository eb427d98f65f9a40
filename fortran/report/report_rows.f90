!> The data of a run's files: rows of its tables, fields of a state, events, and the summary for
!! run.json. Arrays that are not allocated are omitted from the files; a run without a fluid has no
!! pressure.
module report_rows
   use base_kinds, only: ik, lk, rk
   use base_texts, only: add_once, add_text, text_t
   use fine_tip_types, only: intensity_t
   implicit none(type, external)
   private

   public :: chronicle_t, dof_block_t, event_t, event_arrest, event_bifurcation, event_growth
   public :: event_growth_jump, event_growth_uncertain, event_growth_onset, event_joint
   public :: event_opening, event_remesh, event_slip_onset, event_replay, event_step_cut
   public :: event_unstable, event_well, event_window, fracture_fields_t, fracture_errors_t
   public :: history_errors_t, history_row_t, intersection_fields_t, heat_row_t, matrix_fields_t
   public :: probe_row_t, slip_errors_t, slip_event_t, summary_t, tip_errors_t, tip_row_t
   public :: entry_errors_t, entry_row_t, well_errors_t, well_row_t, window_fields_t

   !> Fluid volumes per metre of thickness, from the start of the run on.
   type :: fluid_totals_t
      real(rk) :: injected = 0.0_rk  !< injected less produced [m2]
      real(rk) :: produced = 0.0_rk  !< produced by wells [m2]
      real(rk) :: leakoff = 0.0_rk  !< from the fractures into the rock [m2]
      real(rk) :: outflow = 0.0_rk  !< out of fractures that end on the boundary [m2]
      real(rk) :: prefilled = 0.0_rk  !< initial content of new fracture cells [m2]
      real(rk) :: fracture_fluid = 0.0_rk  !< gain of the fractures [m2]
      real(rk) :: rock_fluid = 0.0_rk  !< gain of the rock [m2]
      real(rk) :: rock_outflow = 0.0_rk  !< out of the rock through the boundary [m2]
      real(rk) :: mass_error_relative = 0.0_rk  !< error of their balance [-]
   end type fluid_totals_t

   !> Effects of a stimulation, with a fluid.
   type, extends(fluid_totals_t) :: stimulation_row_t
      real(rk) :: injection_rate = 0.0_rk  !< net rate of all wells in the step [m2/s]
      real(rk) :: injectivity = 0.0_rk  !< injectivity of the only well; 0: none [m2/s/Pa]
      real(rk) :: stimulated_length = 0.0_rk  !< [m]
      real(rk) :: doubtful_length = 0.0_rk  !< moved by about the least jump of that [m]
      real(rk) :: connected_length = 0.0_rk  !< length connected to the wells [m]
      real(rk) :: connected_stimulated = 0.0_rk  !< length that is both [m]
      integer(ik) :: n_clusters = 0  !< clusters of connected fractures
      real(rk) :: connections_per_branch = 0.0_rk  !< [-]
      real(rk) :: dimensionless_toughness = 0.0_rk  !< K_m of growth [-]
      real(rk) :: dimensionless_leakoff = 0.0_rk  !< C_m of growth [-]
   end type stimulation_row_t

   !> Estimated errors of an accepted step, in the units of its row.
   type :: history_errors_t
      real(rk) :: injected = 0.0_rk, produced = 0.0_rk, leakoff = 0.0_rk, outflow = 0.0_rk
      real(rk) :: fracture_fluid = 0.0_rk, rock_fluid = 0.0_rk, rock_outflow = 0.0_rk
      real(rk) :: fracture_volume = 0.0_rk
      real(rk) :: max_slip = 0.0_rk, max_opening = 0.0_rk, max_slip_rate = 0.0_rk
      real(rk) :: seismic_moment = 0.0_rk, strain_energy = 0.0_rk
      real(rk) :: injection_rate = 0.0_rk, injectivity = 0.0_rk
      real(rk) :: stimulated_length = 0.0_rk, connected_length = 0.0_rk
      real(rk) :: connected_stimulated = 0.0_rk
   end type history_errors_t

   !> Heat since the start, relative to the temperature of &heat.
   type :: heat_row_t
      real(rk) :: stored = 0.0_rk  !< increase in the body [J/m]
      real(rk) :: by_wells = 0.0_rk, by_sides = 0.0_rk  !< into the body [J/m]
      real(rk) :: error = -1.0_rk  !< of their balance, relative to the heat moved; -1: no heat [-]
      real(rk) :: beyond_range = 0.0_rk  !< temperature outside its bounds [K]
   end type heat_row_t

   !> An accepted time step, a row of history.csv.
   type, extends(stimulation_row_t) :: history_row_t
      real(rk) :: time = 0.0_rk  !< [s]; mechanics only: the load factor [-]
      real(rk) :: dt = 0.0_rk  !< [s]
      integer(ik) :: newton_iterations = 0
      real(rk), allocatable :: well_pressure(:)  !< (wells) pressure in the fracture or rock [Pa]
      real(rk) :: fracture_volume = 0.0_rk  !< [m2]
      real(rk) :: max_slip = 0.0_rk  !< [m]
      real(rk) :: max_opening = 0.0_rk  !< [m]
      real(rk) :: max_slip_rate = 0.0_rk  !< mean over the step; with a fluid [m/s]
      integer(ik) :: n_stick = 0
      integer(ik) :: n_slip = 0
      integer(ik) :: n_open = 0
      real(rk) :: fracture_length = 0.0_rk  !< [m]
      integer(ik) :: n_tips = 0
      integer(ik) :: n_intersections = 0
      integer(ik) :: n_unknowns = 0  !< of the body, with a fluid of the coarse level
      real(rk) :: seismic_moment = 0.0_rk  !< per metre of thickness, cumulative [N m]
      real(rk) :: length_error = 0.0_rk  !< estimated error of fracture_length; -1: none [m]
      real(rk) :: well_pressure_error = 0.0_rk  !< estimated error of well_pressure; -1: none [Pa]
      real(rk) :: strain_energy = 0.0_rk  !< without a fluid; per metre of thickness [J/m]
      type(history_errors_t) :: error
      type(heat_row_t) :: heat
   end type history_row_t

   !> Estimated errors of a slip event, in the units of its row.
   type :: slip_errors_t
      real(rk) :: time = 0.0_rk, place = 0.0_rk, area = 0.0_rk, mean_slip = 0.0_rk
      real(rk) :: moment = 0.0_rk, magnitude = 0.0_rk, mean_slip_rate = 0.0_rk
      real(rk) :: stress_drop = 0.0_rk
   end type slip_errors_t

   !> A slip event of a fracture, a row of slip_events.csv.
   type :: slip_event_t
      integer(ik) :: number = 0  !< from 1
      real(rk) :: time = 0.0_rk, end = 0.0_rk  !< times of beginning and end [s]
      integer(ik) :: fracture = 0
      real(rk) :: xy(2) = 0.0_rk  !< centre, weighted by the moment [m]
      real(rk) :: s(2) = 0.0_rk  !< arc lengths of the ends of its patch [m]
      real(rk) :: area = 0.0_rk  !< [m2]
      real(rk) :: mean_slip = 0.0_rk  !< [m]
      real(rk) :: moment = 0.0_rk  !< [N m]
      real(rk) :: largest_rate = 0.0_rk  !< largest moment rate, mean over a step [N m/s]
      logical :: is_seismic = .false.  !< the slip rate of a cell exceeds the threshold
      real(rk) :: onset_xy(2) = 0.0_rk  !< point of the largest slip rate in the first step [m]
      real(rk) :: largest_slip_rate = 0.0_rk  !< largest slip rate of a cell, mean over a step [m/s]
      real(rk) :: mean_slip_rate = 0.0_rk  !< mean over area and duration [m/s]
      real(rk) :: stress_drop = 0.0_rk  !< mean over the area [Pa]
      real(rk) :: magnitude = 0.0_rk  !< [-]
      real(rk) :: open_share = 0.0_rk  !< fraction of the moment on open faces [-]
      real(rk) :: sudden_share = 0.0_rk  !< fraction of the moment in unstable growth [-]
      character(len=5) :: ended_by = ""  !< word of report_words
      type(slip_errors_t) :: error
   end type slip_event_t

   !> Estimated errors of a well after a step, in the units of its row.
   type :: well_errors_t
      real(rk) :: rate = 0.0_rk, flow = 0.0_rk, pressure = 0.0_rk, head_pressure = 0.0_rk
      real(rk) :: injected = 0.0_rk, injectivity = 0.0_rk, temperature = 0.0_rk
   end type well_errors_t

   !> A well after a step, a row of wells.csv.
   type :: well_row_t
      real(rk) :: time = 0.0_rk  !< [s]
      character(len=:), allocatable :: name
      integer(ik) :: stage = 0  !< number of the stage; 0: shut
      character(len=:), allocatable :: control  !< one of the well_words of report_words
      real(rk) :: rate = 0.0_rk  !< rate at the well head, mean over the step [m2/s]
      real(rk) :: flow = 0.0_rk  !< flow into fracture or rock [m2/s]
      real(rk) :: pressure = 0.0_rk  !< pressure in the fracture or rock [Pa]
      real(rk) :: head_pressure = 0.0_rk  !< [Pa]
      real(rk) :: injected = 0.0_rk  !< injected at the well head so far [m2]
      real(rk) :: injectivity = 0.0_rk  !< flow over the pressure rise since the start [m2/s/Pa]
      real(rk) :: asked = 0.0_rk  !< prescribed rate of the stage; 0 without one [m2/s]
      type(well_errors_t) :: error
      real(rk) :: temperature = 0.0_rk  !< with heat [K]
   end type well_row_t

   !> Estimated errors of an entry after a step, in the units of its row.
   type :: entry_errors_t
      real(rk) :: flow = 0.0_rk, share = 0.0_rk, pressure = 0.0_rk
   end type entry_errors_t

   !> An entry of a well after a step, a row of entries.csv.
   type :: entry_row_t
      real(rk) :: time = 0.0_rk  !< [s]
      character(len=:), allocatable :: name  !< of the well
      integer(ik) :: entry = 0  !< its number in the well
      integer(ik) :: fracture = 0
      real(rk) :: flow = 0.0_rk  !< flow into the fracture [m2/s]
      real(rk) :: share = 0.0_rk  !< of the flow of the well; 0 where that is none [-]
      real(rk) :: pressure = 0.0_rk  !< in the fracture [Pa]
      type(entry_errors_t) :: error
   end type entry_row_t

   !> A state at the probes, a row of probes.csv.
   type :: probe_row_t
      real(rk), allocatable :: displacement(:, :)  !< (2, n_probes) [m]
      real(rk), allocatable :: stress(:, :)  !< (3, n_probes) total: xx, yy, xy [Pa]
      real(rk), allocatable :: pressure(:)  !< (n_probes) [Pa]; only with a fluid
      ! (n_probes) Estimated errors: of each component, and of the pressure
      real(rk), allocatable :: displacement_error(:), stress_error(:)  !< [m], [Pa]
      real(rk), allocatable :: pressure_error(:)  !< [Pa]
   end type probe_row_t

   !> Estimated errors of a tip, in the units of its row.
   type :: tip_errors_t
      real(rk) :: keq = 0.0_rk, g = 0.0_rk, angle = 0.0_rk
      real(rk) :: position = 0.0_rk  !< -1: none
   end type tip_errors_t

   !> A free tip after a step or an increment, a row of tips.csv.
   type :: tip_row_t
      real(rk) :: time = 0.0_rk  !< [s]; mechanics only: the load factor [-]
      integer(ik) :: tip = 0
      integer(ik) :: fracture = 0
      real(rk) :: xy(2) = 0.0_rk  !< [m]
      type(intensity_t) :: intensity
      real(rk) :: keq = 0.0_rk  !< equivalent intensity K_eq [Pa m^1/2]
      real(rk) :: g = 0.0_rk  !< energy release rate [J/m2]
      real(rk) :: angle = 0.0_rk  !< kink from the old direction, counter-clockwise [rad]
      real(rk) :: advance = 0.0_rk  !< length grown [m]
      real(rk) :: apparent_toughness = 0.0_rk  !< with the viscosity of the fluid [Pa m^1/2]
      type(tip_errors_t) :: error
   end type tip_row_t

   !> State of the matrix cells.
   type :: matrix_fields_t
      real(rk), allocatable :: displacement(:, :)  !< (2, n_cells) [m]
      real(rk), allocatable :: stress(:, :)  !< (3, n_cells) total: xx, yy, xy [Pa]
      real(rk), allocatable :: pressure(:)  !< (n_cells) [Pa]
      real(rk), allocatable :: temperature(:)  !< (n_cells) mean; with heat [K]
      real(rk), allocatable :: permeability(:, :)  !< (3, n_cells) xx, yy, xy [m2]; or the scene's
      !> (n_cells) Poisson's ratio and Biot's coefficient, or those of the scene [-]
      real(rk), allocatable :: poisson(:), biot(:)
      real(rk), allocatable :: node_displacement(:, :)  !< (2, n_nodes) [m]
      ! Nodes of finite elements:
      real(rk), allocatable :: node_xy(:, :)  !< (2, n_nodes) [m]
      integer(ik), allocatable :: cell_nodes(:, :)  !< (6, n_cells) corners, then nodes on edges
      ! (n_cells) Estimated errors: of each component, and of the pressure
      real(rk), allocatable :: displacement_error(:), stress_error(:)  !< [m], [Pa]
      real(rk), allocatable :: pressure_error(:)  !< [Pa]
      real(rk), allocatable :: temperature_error(:)  !< with heat [K]
   end type matrix_fields_t

   !> (n_cells) Estimated errors of the state of the fracture cells, in the units of the fields.
   type :: fracture_errors_t
      real(rk), allocatable :: jump_n(:), jump_t(:)  !< that of the aperture is that of jump_n
      real(rk), allocatable :: traction_n(:), traction_t(:)
      real(rk), allocatable :: pressure(:), flow(:)
      real(rk), allocatable :: temperature(:)  !< with heat
   end type fracture_errors_t

   !> State of the fracture cells. Normal n and tangent tau as in mesh_types.
   type :: fracture_fields_t
      real(rk), allocatable :: aperture(:)  !< (n_cells) [m]
      real(rk), allocatable :: jump_n(:)  !< (n_cells) opening [m]
      real(rk), allocatable :: jump_t(:)  !< (n_cells) slip along tau [m]
      real(rk), allocatable :: traction_n(:)  !< (n_cells) of contact, compression < 0 [Pa]
      real(rk), allocatable :: traction_t(:)  !< (n_cells) [Pa]
      real(rk), allocatable :: pressure(:)  !< (n_cells) [Pa]
      real(rk), allocatable :: void(:)  !< (n_cells) part of the aperture that vapour fills [m]
      real(rk), allocatable :: flow(:)  !< (n_cells) of fluid along tau [m2/s]
      real(rk), allocatable :: temperature(:)  !< (n_cells) with heat [K]
      integer(ik), allocatable :: state(:)  !< (n_cells) of contact_law
      type(fracture_errors_t) :: error
   end type fracture_fields_t

   !> State of the intersections.
   type :: intersection_fields_t
      integer(ik), allocatable :: point(:)  !< (n) fracture point of each
      real(rk), allocatable :: pressure(:)  !< (n) [Pa]
      real(rk), allocatable :: pressure_error(:)  !< (n) its estimated error [Pa]
   end type intersection_fields_t

   !> The meshes of all windows.
   type :: window_fields_t
      real(rk), allocatable :: xy(:, :)  !< (2, n_points) [m]
      integer(ik), allocatable :: cell_nodes(:, :)  !< (3, n_cells)
      integer(ik), allocatable :: tip(:)  !< (n_cells) number of the first tip that is evaluated
   end type window_fields_t

   !> Unknowns of one kind.
   type :: dof_block_t
      character(len=:), allocatable :: name
      integer(lk) :: n = 0_lk
   end type dof_block_t

   !> Summary of a run so far: sums, largest values and words.
   type :: summary_t
      integer(ik) :: steps = 0  !< accepted time steps
      integer(ik) :: cells = 0  !< matrix cells at the end
      integer(ik) :: fracture_cells = 0  !< at the end
      real(rk) :: mass_error_relative = 0.0_rk  !< largest of all steps [-]
      real(rk) :: keq_over_kic = 0.0_rk  !< largest of all tips and states; 0: omitted [-]
      real(rk) :: lowest_pressure = huge(1.0_rk)  !< lowest fluid pressure; huge: omitted [Pa]
      !> estimated errors of these two [-], [Pa]
      real(rk) :: extreme_error(2) = 0.0_rk
      real(rk) :: contact_residual = 0.0_rk  !< largest of all accepted steps, relative [-]
      real(rk) :: condition_estimate = 0.0_rk  !< largest of the Newton matrices; 0: omitted [-]
      !> bound of the relative error of their solutions [-]
      real(rk) :: forward_error_bound = 0.0_rk
      real(rk) :: smallest_angle = 0.0_rk  !< smallest angle of all meshes; 0: omitted [rad]
      type(heat_row_t) :: heat  !< of the last state
      real(rk) :: energy_error = 0.0_rk  !< relative estimate on the last mesh; 0: omitted [-]
      integer(ik) :: newton_total = 0  !< iterations in all steps
      integer(ik) :: newton_max = 0  !< largest number of iterations in one step
      integer(ik) :: step_cuts = 0
      !> steps in which tips grew without equilibrium; -1: omitted, with the longest
      integer(ik) :: growth_jumps = -1
      real(rk) :: longest_jump = 0.0_rk  !< longest advance of a tip in one of them [m]
      logical :: has_growth = .false.  !< the three following numbers are set
      integer(ik) :: increments = 0  !< increments of growth, of any number of tips at once
      integer(ik) :: meshes_whole = 0  !< meshes of the whole body
      integer(ik) :: meshes_patched = 0  !< meshes changed around growing tips only
      type(dof_block_t), allocatable :: dofs(:)
      type(text_t), allocatable :: used(:)
      type(text_t), allocatable :: left_out(:)
      type(text_t), allocatable :: warnings(:)
   contains
      procedure :: count_dofs
      procedure :: use_feature
      procedure :: leave_out_feature
      procedure :: use_after_all
      procedure :: note => note_feature
      procedure :: warn
      procedure :: add_newton
   end type summary_t

   ! Kinds of events.
   character(len=*), parameter :: event_slip_onset = "slip_onset"
   character(len=*), parameter :: event_opening = "opening"
   character(len=*), parameter :: event_growth = "growth"
   character(len=*), parameter :: event_growth_onset = "growth_onset"
   character(len=*), parameter :: event_joint = "joint"
   character(len=*), parameter :: event_arrest = "arrest"
   character(len=*), parameter :: event_step_cut = "step_cut"
   character(len=*), parameter :: event_unstable = "unstable_growth"
   character(len=*), parameter :: event_bifurcation = "bifurcation"
   character(len=*), parameter :: event_growth_jump = "growth_jump"
   character(len=*), parameter :: event_growth_uncertain = "growth_uncertain"
   character(len=*), parameter :: event_remesh = "remesh"
   character(len=*), parameter :: event_window = "window"
   character(len=*), parameter :: event_well = "well"
   character(len=*), parameter :: event_replay = "replay"

   !> A row of events.csv.
   type :: event_t
      real(rk) :: time = 0.0_rk  !< [s]
      character(len=:), allocatable :: kind  !< event_slip_onset .. event_step_cut
      character(len=:), allocatable :: detail  !< a few words with numbers and units
      integer(ik) :: fracture = 0  !< number of the fracture; 0: none
      logical :: has_place = .false.
      real(rk) :: xy(2) = 0.0_rk  !< [m]
   end type event_t

   !> Event log: events, rows of tables and lines of run.log since the files were last written.
   type :: chronicle_t
      type(event_t), allocatable :: events(:)
      type(tip_row_t), allocatable :: tips(:)
      type(well_row_t), allocatable :: wells(:)
      type(entry_row_t), allocatable :: entries(:)
      type(slip_event_t), allocatable :: slip_events(:)  !< slip events that have ended
      type(text_t), allocatable :: remarks(:)  !< lines of run.log
      logical :: has_new_network = .false.  !< the mesh was updated after growth
   contains
      procedure :: clear
      procedure :: add_event
      procedure :: add_remark
   end type chronicle_t

contains

   !> Set the number of unknowns of a block, e.g. "displacement"; a later count replaces an earlier
   !! one.
   subroutine count_dofs(self, block_name, n)
      class(summary_t), intent(inout) :: self
      character(len=*), intent(in) :: block_name
      integer, intent(in) :: n
      type(dof_block_t), allocatable :: longer(:)
      integer :: i

      if (.not. allocated(self%dofs)) allocate (self%dofs(0))
      do i = 1, size(self%dofs)
         if (self%dofs(i)%name == block_name) then
            self%dofs(i)%n = int(n, lk)
            return
         end if
      end do
      allocate (longer(size(self%dofs) + 1))
      longer(1:size(self%dofs)) = self%dofs
      longer(size(longer))%name = block_name
      longer(size(longer))%n = int(n, lk)
      call move_alloc(longer, self%dofs)
   end subroutine count_dofs

   !> Add the iterations of an accepted step.
   pure subroutine add_newton(self, iterations)
      class(summary_t), intent(inout) :: self
      integer(ik), intent(in) :: iterations

      self%newton_total = self%newton_total + iterations
      self%newton_max = max(self%newton_max, iterations)
   end subroutine add_newton

   !> Add a feature that the run uses.
   subroutine use_feature(self, feature)
      class(summary_t), intent(inout) :: self
      character(len=*), intent(in) :: feature

      call add_once(self%used, feature)
   end subroutine use_feature

   !> Add a feature that the run does not use.
   subroutine leave_out_feature(self, feature)
      class(summary_t), intent(inout) :: self
      character(len=*), intent(in) :: feature

      call add_once(self%left_out, feature)
   end subroutine leave_out_feature

   !> Add a feature that the run uses from now on, and remove the words for its absence.
   subroutine use_after_all(self, feature, left_out)
      class(summary_t), intent(inout) :: self
      character(len=*), intent(in) :: feature
      character(len=*), intent(in) :: left_out  !< words for its absence
      type(text_t), allocatable :: kept(:)
      integer :: i

      call self%use_feature(feature)
      if (.not. allocated(self%left_out)) return
      allocate (kept(0))
      do i = 1, size(self%left_out)
         if (self%left_out(i)%text /= left_out) kept = [kept, self%left_out(i)]
      end do
      call move_alloc(kept, self%left_out)
   end subroutine use_after_all

   !> Add a feature that the run uses, or the words for its absence.
   subroutine note_feature(self, is_used, used, left_out)
      class(summary_t), intent(inout) :: self
      logical, intent(in) :: is_used
      character(len=*), intent(in) :: used  !< words if it is used
      character(len=*), intent(in) :: left_out  !< words if it is not used

      if (is_used) then
         call self%use_feature(used)
      else
         call self%leave_out_feature(left_out)
      end if
   end subroutine note_feature

   !> Add a warning, unless it has been added before.
   subroutine warn(self, warning)
      class(summary_t), intent(inout) :: self
      character(len=*), intent(in) :: warning

      call add_once(self%warnings, warning)
   end subroutine warn

   !> Empty the log.
   pure subroutine clear(self)
      class(chronicle_t), intent(inout) :: self

      self%events = [event_t ::]
      self%tips = [tip_row_t ::]
      self%wells = [well_row_t ::]
      self%entries = [entry_row_t ::]
      self%slip_events = [slip_event_t ::]
      self%remarks = [text_t ::]
      self%has_new_network = .false.
   end subroutine clear

   !> Add an event.
   pure subroutine add_event(self, time, kind, detail, fracture, xy)
      class(chronicle_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      character(len=*), intent(in) :: kind, detail
      integer(ik), intent(in), optional :: fracture
      real(rk), intent(in), optional :: xy(2)  !< [m]
      type(event_t) :: event
      type(event_t), allocatable :: longer(:)

      event%time = time
      event%kind = kind
      event%detail = detail
      if (present(fracture)) event%fracture = fracture
      event%has_place = present(xy)
      if (present(xy)) event%xy = xy
      allocate (longer(size(self%events) + 1))
      longer(:size(self%events)) = self%events
      longer(size(longer)) = event
      call move_alloc(longer, self%events)
   end subroutine add_event

   !> Add a line for the log.
   pure subroutine add_remark(self, line)
      class(chronicle_t), intent(inout) :: self
      character(len=*), intent(in) :: line

      call add_text(self%remarks, line)
   end subroutine add_remark

end module report_rows
