!> A scene: the problem as the user states it, in SI units, after reading and checking.
module scene_types
   use base_kinds, only: ik, rk
   use scene_sides, only: boundary_side_t
   implicit none(type, external)
   private

   public :: adaptive_t, boundary_part_t, discretization_t, domain_t, fluid_t
   public :: fracture_t, growth_t, in_situ_t
   public :: initial_t
   public :: injection_t, load_t, material_t, output_t, point_load_t, probe_t, region_t, restraint_t
   public :: scene_t, time_t
   public :: name_length

   integer, parameter :: name_length = 64

   !> The body: a rectangle, or a disc or polygon, which a rectangle bounds then.
   type :: domain_t
      character(len=name_length) :: shape = "rectangle"  !< or "disc", "polygon"
      real(rk) :: x_min = 0.0_rk, x_max = 0.0_rk  !< [m]
      real(rk) :: y_min = 0.0_rk, y_max = 0.0_rk  !< [m]
      real(rk) :: x_centre = 0.0_rk, y_centre = 0.0_rk, radius = 0.0_rk  !< of a disc [m]
      real(rk), allocatable :: x(:), y(:)  !< corners of a polygon, either way round [m]
   end type domain_t

   !> Rock.
   type :: material_t
      real(rk) :: young = 0.0_rk  !< Young's modulus [Pa]
      real(rk) :: poisson = 0.0_rk  !< Poisson's ratio [-]
      real(rk) :: biot = 0.0_rk  !< Biot's coefficient [-]
      real(rk) :: porosity = 0.0_rk  !< [-]
      real(rk) :: permeability_xx = 0.0_rk  !< [m2]
      real(rk) :: permeability_yy = 0.0_rk  !< [m2]
      real(rk) :: permeability_xy = 0.0_rk  !< [m2]
      real(rk) :: density = 0.0_rk  !< with the fluid in its pores [kg/m3]
      real(rk) :: toughness = huge(1.0_rk)  !< K_IC [Pa m^1/2]
      real(rk) :: radiation_damping = 0.0_rk  !< eta = G/(2 c_s) [Pa s/m]
      logical :: plane_stress = .false.
      character(len=name_length) :: storage = "thesis"  !< (alpha - phi)/K_dr; or "textbook"
   end type material_t

   !> A part of the body with rock of its own.
   type :: region_t
      character(len=name_length) :: name = ""
      character(len=name_length) :: shape = "polygon"  !< or "half_plane", "band", "parabola"
      !> corners of a polygon, two points of the line that has the half-plane on its left, or the
      !! first curve of a band [m]
      real(rk), allocatable :: x(:), y(:)
      real(rk), allocatable :: x_other(:), y_other(:)  !< second curve of a band [m]
      !> one or two parabolas x = x_vertex + curvature (y - y_vertex)^2: right of it, between them
      real(rk), allocatable :: x_vertex(:), y_vertex(:)  !< [m]
      real(rk), allocatable :: curvature(:)  !< [1/m]
      !> That of the scene but for what the region gives itself.
      type(material_t) :: material
   end type region_t

   !> Pore and fracture fluid.
   type :: fluid_t
      real(rk) :: compressibility = 0.0_rk  !< c_p [1/Pa]
      real(rk) :: viscosity = 0.0_rk  !< mu [Pa s]
      real(rk) :: density = 0.0_rk  !< 0: without weight [kg/m3]
      real(rk) :: vapour_pressure = -huge(1.0_rk)  !< least pressure in fractures [Pa]
      ! In fractures, as functions of pressure (scene_fluid_law):
      character(len=name_length) :: viscosity_law = "constant"  !< or "exponential", "table"
      real(rk) :: viscosity_exponent = 0.0_rk  !< d ln mu/dp [1/Pa]
      character(len=name_length) :: density_law = "linear"  !< or "exponential", "table"
      real(rk) :: reference_pressure = -huge(1.0_rk)  !< at which mu and c_p are as given [Pa]
      real(rk), allocatable :: table_pressure(:)  !< rising [Pa]
      real(rk), allocatable :: table_viscosity(:)  !< [Pa s]
      real(rk), allocatable :: table_density(:)  !< [kg/m3]
   end type fluid_t

   !> One fracture and its law.
   type :: fracture_t
      character(len=name_length) :: name = ""
      real(rk), allocatable :: x(:), y(:)  !< vertices [m]
      character(len=name_length) :: law = "friction"  !< or "frictionless", "slip", "open"
      real(rk) :: slip = 0.0_rk  !< of the law "slip", at load factor 1 [m]
      real(rk) :: slip_taper = 0.0_rk  !< over which the slip rises from a free end [m]
      real(rk) :: friction = 0.0_rk  !< mu_s [-]
      real(rk) :: friction_residual = 0.0_rk  !< mu_r after the slip that weakens it [-]
      real(rk) :: weakening_slip = 0.0_rk  !< D_c; 0: friction does not weaken [m]
      real(rk) :: dilation = 0.0_rk  !< psi [rad]
      real(rk) :: dilation_slip = huge(1.0_rk)  !< at which dilation ends [m]
      real(rk) :: normal_stiffness = 0.0_rk  !< k_ni; 0: closed faces are rigid [Pa/m]
      real(rk) :: closure = 0.0_rk  !< d_max [m]
      real(rk) :: cohesion = 0.0_rk  !< of a bond that weakening_slip breaks [Pa]
      real(rk) :: tensile_strength = 0.0_rk  !< of a bond that opening_weakening breaks [Pa]
      real(rk) :: opening_weakening = 0.0_rk  !< W_c [m]
      real(rk) :: toughness = huge(1.0_rk)  !< K_IC of its tips; huge: that of the rock [Pa m^1/2]
      real(rk) :: skin = 0.0_rk  !< pressure over flux between its fluid and the rock [Pa s/m]
      logical :: held_closed = .false.  !< the faces slide but do not part; mechanics only
      real(rk) :: face_pressure = 0.0_rk  !< on the faces, at load factor 1; mechanics only [Pa]
      real(rk) :: aperture = 0.0_rk  !< residual aperture a0 [m]
      ! 0: those of the scene (cell_size_of, window_of, increment_of)
      real(rk) :: cell_size = 0.0_rk  !< of coarse cells, or elements, along it [m]
      real(rk) :: window = 0.0_rk  !< edge of the windows of its tips [m]
      real(rk) :: increment = 0.0_rk  !< longest advance of its tips [m]
   contains
      procedure :: length => fracture_length
   end type fracture_t

   !> A part of the boundary of a polygon or a disc.
   type, extends(boundary_side_t) :: boundary_part_t
      character(len=name_length) :: name = ""
      !> of a polygon; edge k runs from corner k to the next one, as the file gives them
      integer(ik), allocatable :: edges(:)
      logical :: whole_rim = .false.  !< of a disc: all of it, else an arc
      real(rk) :: arc(2) = 0.0_rk  !< counter-clockwise from one angle to the other [rad]
   end type boundary_part_t

   !> A point of the body that is held, per component.
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

   !> Meshes that follow the error.
   type :: adaptive_t
      logical :: enabled = .false.
      real(rk) :: tolerance = 0.01_rk  !< error in the energy norm over the norm [-]
      integer(ik) :: passes = 4  !< meshes at most after the first
   end type adaptive_t

   !> Stress before the load, linear in y.
   type :: in_situ_t
      real(rk) :: stress(3) = 0.0_rk  !< xx, yy, xy at the datum [Pa]
      real(rk) :: per_y(2) = 0.0_rk  !< xx, yy: rise per metre upwards [Pa/m]
      real(rk) :: y_datum = 0.0_rk  !< [m]
   end type in_situ_t

   !> How the load of a mechanics-only scene changes: up or down, or to and fro.
   type :: load_t
      real(rk) :: from = 0.0_rk, to = 1.0_rk  !< factor of all loads [-]
      !> Through which it is led in turn, the last of them then being `to`; unallocated: straight
      !! from the one to the other [-]
      real(rk), allocatable :: factors(:)
      integer(ik) :: steps = 1  !< equal ones, to each of the factors
      !> "length": growth in equilibrium takes it down; "dead": it never falls by itself
      character(len=name_length) :: control = ""
   end type load_t

   !> A well: fluid injected into a fracture or into the rock, or drawn from it, in stages.
   type :: injection_t
      character(len=name_length) :: name = ""
      integer(ik) :: fracture = 0  !< index into scene%fractures; 0: in the rock
      !> Into the cell nearest to (x, y), else spread over the fracture as it is at the start.
      logical :: at_point = .false.
      real(rk) :: x = 0.0_rk, y = 0.0_rk  !< [m]
      real(rk) :: start = 0.0_rk, end = huge(1.0_rk)  !< [s]
      real(rk), allocatable :: time(:)  !< when stages begin; unallocated: one, from start [s]
      !> (stages) Q per metre of thickness, over the whole well; unallocated: what pressure makes of
      !! it [m2/s]
      real(rk), allocatable :: rate(:)
      !> (stages) at the well's head, which it has, or beside a rate does not pass; unallocated: no
      !! limit [Pa]
      real(rk), allocatable :: pressure(:)
      real(rk) :: storage = 0.0_rk  !< fluid that the well holds per pressure [m2/Pa]
      real(rk) :: friction = 0.0_rk  !< pressure that the flow to the fracture loses [Pa s/m2]
      real(rk) :: turbulence = 0.0_rk  !< the same for the flow's square [Pa s2/m4]
      real(rk) :: radius = 0.0_rk  !< of a well in the rock [m]
   contains
      procedure :: stage_count
      procedure :: stage_at
      procedure :: stage_start
      procedure :: is_controlled
   end type injection_t

   !> State before the first step.
   type :: initial_t
      character(len=name_length) :: fracture_pressure = "equilibrated"  !< or "undrained"
      real(rk) :: pressure = 0.0_rk  !< pore pressure before the load acts [Pa]
   end type initial_t

   !> Time steps.
   type :: time_t
      real(rk) :: end = 0.0_rk  !< [s]
      real(rk) :: step = 0.0_rk  !< regular or longest step; 0: none is given [s]
      real(rk) :: tolerance = 0.0_rk  !< on the error of a step; 0: every step is `step` [-]
      real(rk) :: share_after_growth = 0.01_rk  !< of the longest step, right after growth [-]
      real(rk) :: smallest_factor = 0.0_rk  !< of the longest step; below it a run ends [-]
   contains
      procedure :: longest
   end type time_t

   !> Meshes and solvers of both levels.
   type :: discretization_t
      real(rk) :: size_fracture = 0.0_rk  !< dH: cells at fractures without an own size [m]
      real(rk) :: size_boundary = 0.0_rk  !< coarse cells far from them [m]
      real(rk) :: window = 0.0_rk  !< l: edge of the fine-level window; 0 if it is the body [m]
      logical :: window_is_body = .false.  !< all tips are in one window, the whole body
      real(rk) :: fine_ratio = 0.5_rk  !< eps_m = dh/dH [-]
      integer(ik) :: rosette_sectors = 12  !< elements around a tip
      real(rk) :: rosette_radius = 0.0_rk  !< mechanics only [m]
      character(len=name_length) :: element = "quarter_point"  !< at tips; or "collapsed", "plain"
      character(len=name_length) :: face_condition = "contact"  !< or "jump", "traction"
      integer(ik) :: newton_max = 30  !< iterations before a step is cut
      real(rk) :: newton_tolerance = 1.0e-9_rk  !< relative residual
      character(len=name_length) :: condensation = "auto"  !< or "full", "sparse"
      logical :: chosen = .false.  !< the scene leaves some of the sizes open (scene_sizes)
   end type discretization_t

   !> Fracture growth.
   type :: growth_t
      logical :: enabled = .false.
      logical :: intensities = .false.  !< compute stress intensity factors (always with growth)
      character(len=name_length) :: law = "equilibrium"  !< "equilibrium" or "paris"
      real(rk) :: increment = 0.0_rk  !< l_max [m]
      real(rk) :: exponent = 0.35_rk  !< of the Paris-type law [-]
      real(rk) :: threshold = 0.5_rk  !< eps_p: growth is handed over at eps_p*dH [-]
      real(rk) :: new_aperture = 1.0e-5_rk  !< residual aperture of new fracture cells [m]
      character(len=name_length) :: new_volume = "conserved"  !< "conserved" or "prefilled"
      real(rk) :: stop_gain = huge(1.0_rk)  !< growth of an end at which a run ends [m]
   end type growth_t

   !> A point where the matrix state is recorded.
   type :: probe_t
      character(len=name_length) :: name = ""
      real(rk) :: x = 0.0_rk, y = 0.0_rk  !< [m]
   end type probe_t

   !> What is written, and how often.
   type :: output_t
      logical :: vtu = .true.
      real(rk) :: interval = 0.0_rk  !< between written fields [s]
      integer(ik) :: growth_states = 200  !< of which VTU files are written beside these
      !> slip or opening that stimulates faces, and mean slip that makes an event, at least [m]
      real(rk) :: stimulated_jump = 1.0e-6_rk
      real(rk) :: out_of_plane_length = 1.0_rk  !< of slip events [m]
      real(rk) :: seismic_slip_rate = 1.0e-3_rk  !< from which they are seismic [m/s]
   end type output_t

   !> The whole problem.
   type :: scene_t
      character(len=name_length) :: name = ""
      character(len=256) :: title = ""
      type(domain_t) :: domain
      type(material_t) :: material
      !> in order: where they overlap the later one counts; unallocated: uniform rock
      type(region_t), allocatable :: regions(:)
      type(fluid_t) :: fluid
      type(fracture_t), allocatable :: fractures(:)
      type(boundary_side_t) :: sides(4)  !< of a rectangle: left, right, bottom, top
      type(boundary_part_t), allocatable :: parts(:)  !< of the boundary of another body
      type(restraint_t), allocatable :: restraints(:)
      type(point_load_t), allocatable :: point_loads(:)
      type(load_t) :: load
      type(adaptive_t) :: adaptive
      type(in_situ_t) :: in_situ
      real(rk) :: gravity(2) = 0.0_rk  !< acceleration [m/s2]
      type(injection_t), allocatable :: injections(:)
      type(initial_t) :: initial
      type(time_t) :: time
      type(discretization_t) :: discretization
      type(growth_t) :: growth
      type(probe_t), allocatable :: probes(:)
      type(output_t) :: output
   contains
      procedure :: has_fluid
      procedure :: has_fractures
      procedure :: has_wells
      procedure :: has_points
      procedure :: cell_size_of
      procedure :: smallest_cell
      procedure :: rosette_radius_of
      procedure :: window_of
      procedure :: increment_of
   end type scene_t

contains

   !> No step is longer [s].
   pure real(rk) function longest(self)
      class(time_t), intent(in) :: self

      longest = merge(self%step, self%end, self%step > 0.0_rk)
   end function longest

   !> Else it is mechanics only.
   pure logical function has_fluid(self)
      class(scene_t), intent(in) :: self

      has_fluid = self%fluid%viscosity > 0.0_rk
   end function has_fluid

   pure logical function has_fractures(self)
      class(scene_t), intent(in) :: self

      has_fractures = allocated(self%fractures)
      if (has_fractures) has_fractures = size(self%fractures) > 0
   end function has_fractures

   pure logical function has_wells(self)
      class(scene_t), intent(in) :: self

      has_wells = allocated(self%injections)
      if (has_wells) has_wells = size(self%injections) > 0
   end function has_wells

   !> Points of the body are held or loaded.
   pure logical function has_points(self)
      class(scene_t), intent(in) :: self

      has_points = allocated(self%restraints) .and. allocated(self%point_loads)
      if (has_points) has_points = size(self%restraints) + size(self%point_loads) > 0
   end function has_points

   !> Of coarse cells, or elements, along a fracture [m].
   pure real(rk) function cell_size_of(self, fracture) result(size)
      class(scene_t), intent(in) :: self
      integer(ik), intent(in) :: fracture

      size = self%fractures(fracture)%cell_size
      if (.not. size > 0.0_rk) size = self%discretization%size_fracture
   end function cell_size_of

   !> Of elements around the tips of a fracture, in proportion to those along it; mechanics only
   !! [m].
   pure real(rk) function rosette_radius_of(self, fracture) result(radius)
      class(scene_t), intent(in) :: self
      integer(ik), intent(in) :: fracture

      radius = self%discretization%rosette_radius
      associate (usual => self%discretization%size_fracture)
         if (self%fractures(fracture)%cell_size > 0.0_rk) then
            radius = radius*(self%fractures(fracture)%cell_size/usual)
         end if
      end associate
   end function rosette_radius_of

   !> The smallest of these [m].
   pure real(rk) function smallest_cell(self) result(size)
      class(scene_t), intent(in) :: self
      integer(ik) :: i

      size = huge(1.0_rk)
      do i = 1, ubound(self%fractures, 1)
         size = min(size, self%cell_size_of(i))
      end do
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

   pure integer(ik) function stage_count(self)
      class(injection_t), intent(in) :: self

      stage_count = 1
      if (allocated(self%time)) stage_count = size(self%time, kind=ik)
   end function stage_count

   !> When a stage begins [s].
   pure real(rk) function stage_start(self, stage)
      class(injection_t), intent(in) :: self
      integer(ik), intent(in) :: stage

      stage_start = self%start
      if (allocated(self%time)) stage_start = self%time(stage)
   end function stage_start

   !> The stage that a time belongs to; 0: the well is shut, before its start or after its end.
   pure integer(ik) function stage_at(self, time) result(stage)
      class(injection_t), intent(in) :: self
      real(rk), intent(in) :: time  !< [s]

      stage = 0
      if (time >= self%end) return
      do stage = self%stage_count(), 1, -1
         if (time >= self%stage_start(stage)) return
      end do
   end function stage_at

   !> What flows depends on pressures: its rate is not simply what the scene says.
   elemental logical function is_controlled(self)
      class(injection_t), intent(in) :: self

      is_controlled = allocated(self%pressure) .or. self%storage > 0.0_rk
   end function is_controlled

   !> Along the polyline, as far as it has both coordinates [m].
   pure real(rk) function fracture_length(self) result(length)
      class(fracture_t), intent(in) :: self
      integer :: k

      length = 0.0_rk
      do k = 1, min(size(self%x), size(self%y)) - 1
         length = length + norm2([self%x(k + 1) - self%x(k), self%y(k + 1) - self%y(k)])
      end do
   end function fracture_length

end module scene_types
