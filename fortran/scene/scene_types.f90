!> A scene: the problem stated by the user, in SI units, after reading and checking.
module scene_types
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use scene_heat, only: heat_t, temperature_t
   use scene_sides, only: boundary_side_t
   implicit none(type, external)
   private

   public :: adaptive_t, boundary_part_t, discretization_t, domain_t, entry_t, fluid_t, fracture_t
   public :: growth_t, in_situ_t, initial_t, injection_t, load_t, material_t, output_t
   public :: point_load_t, probe_t, region_t, restraint_t, scene_t, time_t, name_length, no_limit

   integer, parameter :: name_length = 64
   real(rk), parameter :: no_limit = 1.0e30_rk  !< pressure of a stage without a limit [Pa]

   !> The body: a rectangle, or a disc or polygon with x_min to y_max as its bounding rectangle.
   type :: domain_t
      character(len=name_length) :: shape = "rectangle"  !< or "disc", "polygon"
      real(rk) :: x_min = 0.0_rk, x_max = 0.0_rk  !< [m]
      real(rk) :: y_min = 0.0_rk, y_max = 0.0_rk  !< [m]
      !> centre, radius of a disc [m]
      real(rk) :: x_centre = 0.0_rk, y_centre = 0.0_rk, radius = 0.0_rk
      real(rk), allocatable :: x(:), y(:)  !< corners of a polygon in either orientation [m]
   end type domain_t

   !> Rock.
   type :: material_t
      real(rk) :: young = 0.0_rk  !< Young's modulus [Pa]
      real(rk) :: poisson = 0.0_rk  !< Poisson's ratio [-]
      real(rk) :: biot = 0.0_rk  !< Biot's coefficient [-]
      real(rk) :: porosity = 0.0_rk  !< [-]
      real(rk) :: permeability_xx = 0.0_rk, permeability_yy = 0.0_rk  !< [m2]
      real(rk) :: permeability_xy = 0.0_rk  !< [m2]
      real(rk) :: density = 0.0_rk  !< density with the pore fluid [kg/m3]
      real(rk) :: heat_capacity = 0.0_rk  !< with the pore fluid [J/(m3 K)]
      real(rk) :: heat_conductivity = 0.0_rk  !< [W/(m K)]
      real(rk) :: heat_expansion = 0.0_rk  !< of the solid's volume, b_s [1/K]
      real(rk) :: toughness = huge(1.0_rk)  !< K_IC [Pa m^1/2]
      real(rk) :: radiation_damping = 0.0_rk  !< eta = G/(2 c_s) [Pa s/m]
      logical :: plane_stress = .false.
      character(len=name_length) :: storage = "thesis"  !< (alpha - phi)/K_dr; or "textbook"
   end type material_t

   !> A part of the body with its own rock.
   type :: region_t
      character(len=name_length) :: name = ""
      character(len=name_length) :: shape = "polygon"  !< or "half_plane", "band", "parabola"
      !> corners of a polygon, two points of the line that has the half-plane on its left, or the
      !! first curve of a band [m]
      real(rk), allocatable :: x(:), y(:)
      real(rk), allocatable :: x_other(:), y_other(:)  !< second curve of a band [m]
      !> parabolas x = x_vertex + curvature (y - y_vertex)^2: the part right of one or between two
      real(rk), allocatable :: x_vertex(:), y_vertex(:)  !< [m]
      real(rk), allocatable :: curvature(:)  !< [1/m]
      !> rock; properties that the region does not give are the scene's
      type(material_t) :: material
   end type region_t

   !> Pore and fracture fluid.
   type :: fluid_t
      real(rk) :: compressibility = 0.0_rk  !< c_p [1/Pa]
      real(rk) :: viscosity = 0.0_rk  !< mu [Pa s]
      real(rk) :: density = 0.0_rk  !< density; 0: no weight [kg/m3]
      real(rk) :: heat_capacity = 0.0_rk  !< at the reference density [J/(m3 K)]
      real(rk) :: heat_expansion = 0.0_rk  !< of its volume, b_f [1/K]
      real(rk) :: vapour_pressure = -huge(1.0_rk)  !< lowest pressure in fractures [Pa]
      ! In fractures, as functions of pressure (scene_fluid_law):
      character(len=name_length) :: viscosity_law = "constant"  !< or "exponential", "table"
      real(rk) :: viscosity_exponent = 0.0_rk  !< d ln mu/dp [1/Pa]
      character(len=name_length) :: density_law = "linear"  !< or "exponential", "table"
      real(rk) :: reference_pressure = -huge(1.0_rk)  !< pressure of the given mu and c_p [Pa]
      real(rk), allocatable :: table_pressure(:)  !< increasing pressures [Pa]
      real(rk), allocatable :: table_viscosity(:)  !< [Pa s]
      real(rk), allocatable :: table_density(:)  !< [kg/m3]
      real(rk), allocatable :: table_temperature(:)  !< increasing, with viscosity_at [K]
      real(rk), allocatable :: viscosity_at(:)  !< viscosities at these temperatures [Pa s]
   end type fluid_t

   !> One fracture and its law.
   type :: fracture_t
      character(len=name_length) :: name = ""
      real(rk), allocatable :: x(:), y(:)  !< vertices [m]
      character(len=name_length) :: law = "friction"  !< or "frictionless", "slip", "open"
      real(rk) :: slip = 0.0_rk  !< prescribed slip of the law "slip", at load factor 1 [m]
      real(rk) :: slip_taper = 0.0_rk  !< length over which the slip increases from a free end [m]
      real(rk) :: friction = 0.0_rk  !< mu_s [-]
      real(rk) :: friction_residual = 0.0_rk  !< mu_r after weakening_slip [-]
      real(rk) :: weakening_slip = 0.0_rk  !< D_c; 0: no weakening of friction [m]
      real(rk) :: dilation = 0.0_rk  !< psi [rad]
      real(rk) :: dilation_slip = huge(1.0_rk)  !< slip at the end of dilation [m]
      real(rk) :: normal_stiffness = 0.0_rk  !< k_ni; 0: closed faces are rigid [Pa/m]
      real(rk) :: closure = 0.0_rk  !< d_max [m]
      real(rk) :: cohesion = 0.0_rk  !< shear strength of a bond, which weakening_slip breaks [Pa]
      real(rk) :: tensile_strength = 0.0_rk  !< tensile strength of the same bond [Pa]
      real(rk) :: opening_weakening = 0.0_rk  !< opening W_c that breaks the bond [m]
      real(rk) :: toughness = huge(1.0_rk)  !< K_IC of its tips; huge: that of the rock [Pa m^1/2]
      real(rk) :: skin = 0.0_rk  !< pressure difference to the rock over flux [Pa s/m]
      logical :: held_closed = .false.  !< the faces slide but do not separate; mechanics only
      !> pressure on the faces at load factor 1; mechanics only [Pa]
      real(rk) :: face_pressure = 0.0_rk
      real(rk) :: aperture = 0.0_rk  !< residual aperture a0 [m]
      ! 0: those of the scene (cell_size_of, window_of, increment_of)
      real(rk) :: cell_size = 0.0_rk  !< size of coarse cells, or elements, along it [m]
      real(rk) :: window = 0.0_rk  !< edge of the windows of its tips [m]
      real(rk) :: increment = 0.0_rk  !< largest advance of its tips [m]
   contains
      procedure :: length => fracture_length
   end type fracture_t

   !> A part of the boundary of a polygon or a disc.
   type, extends(boundary_side_t) :: boundary_part_t
      character(len=name_length) :: name = ""
      !> edges of a polygon; edge k connects corner k of the file and the next one
      integer(ik), allocatable :: edges(:)
      logical :: whole_rim = .false.  !< the whole rim of a disc, and not an arc
      real(rk) :: arc(2) = 0.0_rk  !< angles of an arc, counter-clockwise from the first [rad]
   end type boundary_part_t

   !> A point of the body with prescribed displacement, per component.
   type :: restraint_t
      real(rk) :: x = 0.0_rk, y = 0.0_rk  !< [m]
      logical :: displacement_given(2) = .false.  !< x, y
      real(rk) :: displacement(2) = 0.0_rk  !< [m]
   end type restraint_t

   !> A force at a point of the body.
   type :: point_load_t
      real(rk) :: x = 0.0_rk, y = 0.0_rk  !< [m]
      real(rk) :: force(2) = 0.0_rk  !< [N/m]
   end type point_load_t

   !> Adaptive meshes.
   type :: adaptive_t
      logical :: enabled = .false.
      real(rk) :: tolerance = 0.0_rk  !< target error in the energy norm over the norm [-]
      integer(ik) :: passes = 4  !< largest number of meshes after the first
   end type adaptive_t

   !> Stress before loading, linear in y.
   type :: in_situ_t
      real(rk) :: stress(3) = 0.0_rk  !< xx, yy, xy at the datum [Pa]
      real(rk) :: per_y(2) = 0.0_rk  !< xx, yy: increase per metre upwards [Pa/m]
      real(rk) :: y_datum = 0.0_rk  !< level of the given stresses and pressures [m]
   end type in_situ_t

   !> Load programme of a mechanics-only scene.
   type :: load_t
      real(rk) :: from = 0.0_rk, to = 1.0_rk  !< first and last load factor [-]
      !> successive load factors of a load cycle, of which `to` is the last; unallocated: none [-]
      real(rk), allocatable :: factors(:)
      integer(ik) :: steps = 1  !< number of equal steps to each of the factors
      !> "length": the load may decrease in equilibrium growth; "dead": it does not
      character(len=name_length) :: control = ""
   end type load_t

   !> An entry of a well: where it meets a fracture.
   type :: entry_t
      integer(ik) :: fracture = 0  !< index into scene%fractures
      real(rk) :: x = 0.0_rk, y = 0.0_rk  !< point of injection [m]
      real(rk) :: loss = 0.0_rk  !< pressure loss per flow squared [Pa s2/m4]
   end type entry_t

   !> A well: injection into fractures or into the rock, or production, in stages.
   type :: injection_t
      character(len=name_length) :: name = ""
      !> Several entries, or one with a loss; unallocated: one without. Fracture and point of the
      !! well are those of the first.
      type(entry_t), allocatable :: entries(:)
      integer(ik) :: fracture = 0  !< index into scene%fractures; 0: in the rock
      !> in the cell nearest to (x, y), and not the whole initial fracture
      logical :: at_point = .false.
      real(rk) :: x = 0.0_rk, y = 0.0_rk  !< point of injection [m]
      ! Distances of the point in the file from the nearest fracture, where it is placed, and from
      ! the next one elsewhere:
      real(rk) :: moved = 0.0_rk, next_distance = huge(1.0_rk)  !< [m]
      real(rk) :: start = 0.0_rk, end = huge(1.0_rk)  !< [s]
      !> (stages) start times; unallocated: one stage from start [s]
      real(rk), allocatable :: time(:)
      !> (stages) rate Q of the whole well per metre of thickness; unallocated: pressure control
      !! [m2/s]
      real(rk), allocatable :: rate(:)
      !> (stages) pressure at the well head, with a rate its limit; unallocated: no limit [Pa]
      real(rk), allocatable :: pressure(:)
      real(rk), allocatable :: temperature(:)  !< (stages, or 1) of what it injects [K]
      real(rk) :: storage = 0.0_rk  !< wellbore storage: stored volume per pressure [m2/Pa]
      real(rk) :: friction = 0.0_rk  !< pressure loss to the fracture per flow [Pa s/m2]
      real(rk) :: turbulence = 0.0_rk  !< pressure loss per flow squared [Pa s2/m4]
      real(rk) :: radius = 0.0_rk  !< radius of a well in the rock [m]
   contains
      procedure :: stage_count
      procedure :: stage_at
      procedure :: stage_start
      procedure :: is_controlled
      procedure :: has_given_flow
      procedure :: entry_count
   end type injection_t

   !> State before the first step.
   type :: initial_t
      character(len=name_length) :: fracture_pressure = "equilibrated"  !< or "undrained"
      real(rk) :: pressure = 0.0_rk  !< pore pressure before loading [Pa]
   end type initial_t

   !> Time steps.
   type :: time_t
      real(rk) :: end = 0.0_rk  !< [s]
      real(rk) :: step = 0.0_rk  !< regular or longest step; 0: not given [s]
      real(rk) :: tolerance = 0.0_rk  !< tolerance of the step error; 0: every step is `step` [-]
      real(rk) :: first = 0.0_rk  !< first step with a tolerance; 0: the default [s]
      real(rk) :: share_after_growth = 0.01_rk  !< first step after growth over the longest step [-]
      !> smallest step over the longest, at which a run ends [-]
      real(rk) :: smallest_factor = 0.0_rk
      character(len=256) :: replay = ""  !< folder of the run whose decisions are taken; empty: none
   end type time_t

   !> Default of the first step, over the time of the scene: so short that little happens [-].
   real(rk), parameter, public :: first_share = 1.0e-7_rk

   !> Meshes and solvers of both levels.
   type :: discretization_t
      real(rk) :: size_fracture = 0.0_rk  !< dH: size of cells at fractures without a cell_size [m]
      real(rk) :: size_boundary = 0.0_rk  !< size of cells far from the fractures [m]
      real(rk) :: window = 0.0_rk  !< l: edge of a window; 0 if the window is the body [m]
      logical :: window_is_body = .false.  !< the whole body is the only window
      real(rk) :: fine_ratio = 0.5_rk  !< eps_m = dh/dH [-]
      integer(ik) :: rosette_sectors = 12  !< number of elements around a tip
      real(rk) :: rosette_radius = 0.0_rk  !< size of the elements around a tip; mechanics only [m]
      character(len=name_length) :: element = "quarter_point"  !< at tips; or "collapsed", "plain"
      character(len=name_length) :: face_condition = "contact"  !< or "jump", "traction"
      integer(ik) :: newton_max = 30  !< largest number of iterations before a step is cut
      real(rk) :: newton_tolerance = 1.0e-9_rk  !< relative residual
      character(len=name_length) :: condensation = "auto"  !< or "full", "sparse"
      !> "auto": layers thinner than a cell are resolved; or "off"
      character(len=name_length) :: layers = "auto"
      logical :: chosen = .false.  !< the scene leaves some of the sizes open (scene_sizes)
   end type discretization_t

   !> Fracture growth.
   type :: growth_t
      logical :: enabled = .false.
      logical :: enabled_assumed = .false.  !< the default, where other names of growth are given
      logical :: was_enabled = .false.  !< growth was switched off at a restart; not in the file
      !> stress intensity factors are computed (always with growth)
      logical :: intensities = .false.
      character(len=name_length) :: law = "equilibrium"  !< "equilibrium" or "paris"
      real(rk) :: increment = 0.0_rk  !< l_max [m]
      !> "constant", or "by_length": they grow with fractures that have become longer; "auto"
      character(len=name_length) :: increments = "auto"
      real(rk) :: exponent = 0.35_rk  !< exponent of the Paris-type law [-]
      !> eps_p: growth over dH at which the coarse mesh is updated [-]
      real(rk) :: threshold = 0.5_rk
      real(rk) :: new_aperture = 1.0e-5_rk  !< residual aperture of new fracture cells [m]
      character(len=name_length) :: new_volume = "conserved"  !< "conserved" or "prefilled"
      real(rk) :: stop_gain = huge(1.0_rk)  !< growth of an end at which the run ends [m]
   contains
      procedure :: in_equilibrium
      procedure :: leaves_partial_cells
   end type growth_t

   !> A point where the matrix state is recorded.
   type :: probe_t
      character(len=name_length) :: name = ""
      real(rk) :: x = 0.0_rk, y = 0.0_rk  !< [m]
   end type probe_t

   !> Output.
   type :: output_t
      logical :: vtu = .true.  !< VTU files are written
      logical :: windows = .false.  !< with the meshes of the windows
      real(rk) :: interval = 0.0_rk  !< time between written fields [s]
      !> largest number of additional states of growth with VTU files
      integer(ik) :: growth_states = 200
      !> smallest slip or opening of stimulated faces, and mean slip of an event [m]
      real(rk) :: stimulated_jump = 1.0e-6_rk
      real(rk) :: out_of_plane_length = 1.0_rk  !< out-of-plane length of slip events [m]
      real(rk) :: seismic_slip_rate = 1.0e-3_rk  !< smallest slip rate of seismic events [m/s]
      real(rk) :: checkpoint = 600.0_rk  !< wall time between checkpoints; 0: none [s]
      !> accepted states between checkpoints; 0: the wall time decides
      integer(ik) :: checkpoint_states = 0
   end type output_t

   !> The whole problem.
   type :: scene_t
      character(len=name_length) :: name = ""
      character(len=256) :: title = ""
      real(rk) :: thickness = 1.0_rk  !< of the body, out of the plane [m]
      !> it is the default, and rates of the file are volumes per time
      logical :: thickness_assumed = .false.
      type(domain_t) :: domain
      type(material_t) :: material
      !> regions in the order of the file: the later of two that overlap applies; unallocated: none
      type(region_t), allocatable :: regions(:)
      type(fluid_t) :: fluid
      type(fracture_t), allocatable :: fractures(:)
      type(boundary_side_t) :: sides(4)  !< left, right, bottom, top of a rectangle
      type(boundary_part_t), allocatable :: parts(:)  !< parts of the boundary of a disc or polygon
      type(restraint_t), allocatable :: restraints(:)
      type(point_load_t), allocatable :: point_loads(:)
      type(load_t) :: load
      type(adaptive_t) :: adaptive
      type(in_situ_t) :: in_situ
      real(rk) :: gravity(2) = 0.0_rk  !< acceleration [m/s2]
      type(injection_t), allocatable :: injections(:)
      type(initial_t) :: initial
      type(heat_t), allocatable :: heat  !< unallocated: none
      type(temperature_t), allocatable :: temperature  !< without a fluid; unallocated: no change
      type(time_t) :: time
      type(discretization_t) :: discretization
      type(growth_t) :: growth
      type(probe_t), allocatable :: probes(:)
      type(output_t) :: output
   contains
      procedure :: has_fluid
      procedure :: has_fractures
      procedure :: has_wells
      procedure :: has_entries
      procedure :: has_points
      procedure :: n_parts
      procedure :: cell_size_of
      procedure :: smallest_cell
      procedure :: rosette_radius_of
      procedure :: window_of
      procedure :: increment_of
   end type scene_t

contains

   !> Whether tips grow in equilibrium; else by the growth law at the ends of steps.
   pure logical function in_equilibrium(self)
      class(growth_t), intent(in) :: self

      in_equilibrium = self%enabled .and. self%law == "equilibrium"
   end function in_equilibrium

   !> Tips are, or were, in equilibrium: the last cells of the coarse mesh extend beyond them.
   pure logical function leaves_partial_cells(self)
      class(growth_t), intent(in) :: self

      leaves_partial_cells = (self%enabled .or. self%was_enabled) .and. self%law == "equilibrium"
   end function leaves_partial_cells

   !> The scene has a fluid; otherwise it is mechanics only.
   pure logical function has_fluid(self)
      class(scene_t), intent(in) :: self

      has_fluid = self%fluid%viscosity > 0.0_rk
   end function has_fluid

   !> The scene has fractures.
   pure logical function has_fractures(self)
      class(scene_t), intent(in) :: self

      has_fractures = allocated(self%fractures)
      if (has_fractures) has_fractures = size(self%fractures) > 0
   end function has_fractures

   !> The scene has wells.
   pure logical function has_wells(self)
      class(scene_t), intent(in) :: self

      has_wells = allocated(self%injections)
      if (has_wells) has_wells = size(self%injections) > 0
   end function has_wells

   !> Wells of the scene have entries.
   pure logical function has_entries(self)
      class(scene_t), intent(in) :: self
      integer :: w

      has_entries = self%has_wells()
      if (has_entries) has_entries = any([(allocated(self%injections(w)%entries), &
                                           w=1, size(self%injections))])
   end function has_entries

   !> The scene has restraints or point loads.
   pure logical function has_points(self)
      class(scene_t), intent(in) :: self

      has_points = allocated(self%restraints) .and. allocated(self%point_loads)
      if (has_points) has_points = size(self%restraints) + size(self%point_loads) > 0
   end function has_points

   !> Number of parts of the boundary that the scene names; 0 for a rectangle.
   pure integer function n_parts(self)
      class(scene_t), intent(in) :: self

      n_parts = 0
      if (allocated(self%parts)) n_parts = size(self%parts)
   end function n_parts

   !> Size of coarse cells, or elements, along a fracture [m].
   pure real(rk) function cell_size_of(self, fracture) result(size)
      class(scene_t), intent(in) :: self
      integer(ik), intent(in) :: fracture

      size = self%fractures(fracture)%cell_size
      if (.not. size > 0.0_rk) size = self%discretization%size_fracture
   end function cell_size_of

   !> Size of the elements around the tips of a fracture, in proportion to those along it [m].
   !! Mechanics only.
   pure real(rk) function rosette_radius_of(self, fracture) result(radius)
      class(scene_t), intent(in) :: self
      integer(ik), intent(in) :: fracture

      radius = self%discretization%rosette_radius &
               *(self%cell_size_of(fracture)/self%discretization%size_fracture)
   end function rosette_radius_of

   !> Smallest size of cells, or elements, along fractures [m].
   pure real(rk) function smallest_cell(self) result(size)
      class(scene_t), intent(in) :: self
      integer(ik) :: i

      size = minval([(self%cell_size_of(i), i=1, ubound(self%fractures, 1))])
   end function smallest_cell

   !> Edge of the windows of a fracture's tips [m].
   pure real(rk) function window_of(self, fracture) result(edge)
      class(scene_t), intent(in) :: self
      integer(ik), intent(in) :: fracture

      edge = self%fractures(fracture)%window
      if (.not. edge > 0.0_rk) edge = self%discretization%window
   end function window_of

   !> Longest advance of a fracture's tips [m].
   pure real(rk) function increment_of(self, fracture) result(increment)
      class(scene_t), intent(in) :: self
      integer(ik), intent(in) :: fracture

      increment = 0.0_rk
      if (allocated(self%fractures)) increment = self%fractures(fracture)%increment
      if (.not. increment > 0.0_rk) increment = self%growth%increment
   end function increment_of

   !> Number of stages, at least 1.
   pure integer(ik) function stage_count(self)
      class(injection_t), intent(in) :: self

      stage_count = 1
      if (allocated(self%time)) stage_count = size(self%time, kind=ik)
   end function stage_count

   !> Start time of a stage [s].
   pure real(rk) function stage_start(self, stage)
      class(injection_t), intent(in) :: self
      integer(ik), intent(in) :: stage

      stage_start = self%start
      if (allocated(self%time)) stage_start = self%time(stage)
   end function stage_start

   !> Number of the stage at a time; 0: the well is shut, before its start or after its end.
   pure integer(ik) function stage_at(self, time) result(stage)
      class(injection_t), intent(in) :: self
      real(rk), intent(in) :: time  !< [s]

      stage = 0
      if (time >= self%end) return
      do stage = self%stage_count(), 1, -1
         if (time >= self%stage_start(stage)) return
      end do
   end function stage_at

   !> The flow into a fracture depends on pressures, rather than being the rate of the scene.
   elemental logical function is_controlled(self)
      class(injection_t), intent(in) :: self

      is_controlled = allocated(self%entries) .or. .not. self%has_given_flow()
   end function is_controlled

   !> The flow out of the whole well is the rate of the scene.
   elemental logical function has_given_flow(self)
      class(injection_t), intent(in) :: self

      has_given_flow = .not. (allocated(self%pressure) .or. self%storage > 0.0_rk)
   end function has_given_flow

   !> Number of entries, at least 1.
   elemental integer(ik) function entry_count(self)
      class(injection_t), intent(in) :: self

      entry_count = 1
      if (allocated(self%entries)) entry_count = size(self%entries, kind=ik)
   end function entry_count

   !> Length of the polyline, as far as both lists of coordinates reach [m].
   pure real(rk) function fracture_length(self) result(length)
      class(fracture_t), intent(in) :: self
      integer :: k

      length = sum([(norm2([self%x(k + 1) - self%x(k), self%y(k + 1) - self%y(k)]), &
                     k=1, min(size(self%x), size(self%y)) - 1)])
   end function fracture_length

end module scene_types
