!> The table of the limits of a run: quantities checked in each accepted state, with the value from
!! which on there is a warning, and that from which on results are invalid and the run stops.
!! docs/limits.md has the sources of the numbers.
module report_limits
   use base_kinds, only: rk
   implicit none(type, external)
   private

   public :: judge, limit_angle, limit_aperture, limit_contact, limit_fluid_in_rock
   public :: limit_growth_error, limit_forward_error, limit_jump, limit_k_error, limit_k_methods
   public :: limit_k_to_grow, limit_keq, limit_layering, limit_loop_flow, limit_mass
   public :: limit_pressure_load, limit_pressure_stiffness, limit_strain, limit_t, limit_table
   public :: limit_depth, limit_initial_keq, limit_time_error, limit_well_error, limits
   public :: verdict_fine, verdict_stop, verdict_warning

   integer, parameter :: verdict_fine = 0, verdict_warning = 1, verdict_stop = 2

   real(rk), parameter :: never = huge(1.0_rk)  !< limit of a quantity that does not stop a run

   !> A monitored quantity. If the limit of a stop is below that of a warning, small values are bad,
   !! otherwise large ones.
   type :: limit_t
      character(len=56) :: name = ""
      character(len=8) :: unit = "-"
      character(len=16) :: runs = "always"  !< runs in which it is monitored
      real(rk) :: warning = never
      real(rk) :: stop = never
      character(len=200) :: meaning = ""
      character(len=200) :: remedy = ""  !< a clause
   end type limit_t

   ! Indices into the table.
   integer, parameter :: limit_forward_error = 1, limit_mass = 2, limit_contact = 3, &
                         limit_aperture = 4, limit_jump = 5, limit_strain = 6, &
                         limit_pressure_load = 7, limit_pressure_stiffness = 8, &
                         limit_angle = 9, limit_k_methods = 10, limit_k_error = 11, &
                         limit_k_to_grow = 12, limit_keq = 13, limit_time_error = 14, &
                         limit_layering = 15, limit_loop_flow = 16, limit_table = 17, &
                         limit_fluid_in_rock = 18, limit_growth_error = 19, &
                         limit_depth = 20, limit_well_error = 21, limit_initial_keq = 22

   character(len=*), parameter :: with_fluid = "with a fluid"
   character(len=*), parameter :: with_growth = "with growth"

   ! The table keeps its own layout.
   !&<
   type(limit_t), parameter :: limits(*) = [ &
      limit_t("forward error bound", "-", with_fluid, 1.0e-6_rk, 1.0e-3_rk, &
         "Relative bound of rounding errors in the solution on the fractures", &
         "look for values of the scene that differ by too many decades"), &
      limit_t("mass error", "-", with_fluid, 1.0e-8_rk, 1.0e-3_rk, &
         "Numerical error of the fluid mass so far, relative to the injected volume or the "// &
         "fracture volume, or without these to the storage of the rock under its pressure", &
         "look for values of the scene that differ by too many decades"), &
      limit_t("contact residual", "-", "always", 1.0e-8_rk, 1.0e-4_rk, &
         "Residual of the contact law over the largest traction", "reduce newton_tolerance"), &
      limit_t("aperture over the body's size", "-", with_fluid, 1.0e-2_rk, 1.0e-1_rk, &
         "Largest aperture of a fracture cell over the body's shorter side", &
         "check well rates, boundary conditions and units"), &
      limit_t("jump over its fracture cell's length", "-", "always", 0.5_rk, 1.0e4_rk, &
         "Largest opening or slip over the length of its fracture cell; the coupling of the "// &
         "faces assumes small jumps", &
         "check the loads, or use larger fracture cells; smaller ones do not help"), &
      limit_t("strain of the body", "-", "always", 2.0e-2_rk, 1.0e2_rk, &
         "Difference between the largest and the smallest displacement over the body's size in "// &
         "that direction", "check the loads and young: the equations are for small strains"), &
      limit_t("pressure over the load", "-", with_fluid, 1.0e1_rk, 1.0e4_rk, &
         "Largest absolute fluid pressure over the expected one: the largest load, initial "// &
         "pressure, or pressure for growth of the longest fracture", &
         "check well rates; reduce the step"), &
      limit_t("pressure over Young's modulus", "-", with_fluid, 1.0e-2_rk, 1.0_rk, &
         "Largest absolute fluid pressure over Young's modulus", &
         "check well rates and young; reduce the step"), &
      limit_t("smallest angle of the mesh", "degree", "always", 10.0_rk, 0.1_rk, &
         "Smallest angle of all triangles", &
         "separate fractures that are nearly parallel and close, or use smaller cells"), &
      limit_t("disagreement of the stress intensity factors", "-", "always", 0.1_rk, 10.0_rk, &
         "Difference of K by the interaction integral and by displacement correlation, over "// &
         "the largest K of all tips, or over K_IC if that is larger and tips may grow, "// &
         "or 1 % of that by thermal stress", &
         "use smaller cells around the tip"), &
      limit_t("estimated error of a stress intensity factor", "-", with_growth, 5.0e-2_rk, &
         never, &
         "Estimated error of K of a tip that may grow, over K_IC; with a fluid that of both "// &
         "levels, and over a hundredth of the K of its loads where that is larger", &
         "growth in this state is uncertain: use smaller cells around the tip, or with a fluid "// &
         "a larger window"), &
      limit_t("error of K over K_IC where a tip would grow", "%", "without a fluid", 5.0_rk, &
         100.0_rk, &
         "Estimated error of K, over K_IC or K_eq if that is larger, of a tip whose K_eq "// &
         "equals K_IC within it, when tips may grow: the relative error of the load factor of "// &
         "growth; not with law = 'paris'", &
         "reduce size_fracture, or use &adaptive"), &
      limit_t("K_eq over K_IC after growth", "-", "fluid and growth", 1.02_rk, 1.0e2_rk, &
         "Largest K_eq, over K_IC, of tips that may grow, after growth in the state", &
         "reduce the step: growth lags behind the load"), &
      limit_t("error in time of a step", "-", with_fluid, 0.5_rk, never, &
         "Estimated time error of a step in the mean pressure, slip or opening, over their "// &
         "range so far", "reduce the step, or omit it: it is then chosen by its error"), &
      limit_t("contrast in a cell that an outline cuts", "-", "with &region", 1.0e3_rk, never, &
         "Ratio of the permeabilities along and across the outline in a cut cell; above the "// &
         "limit flow along is up to a quarter too small, and pressures may leave their bounds "// &
         "by a third", &
         "keep outlines away from fractures and each other (docs/theory.md), so that the mesh "// &
         "follows them"), &
      limit_t("flow round loops of fractures", "-", with_fluid, 1.0e-3_rk, never, &
         "Its uncertainty over the largest flow, or that which exchanges the fluid of a cell "// &
         "in the step: it depends on pressure differences below their rounding", &
         "these fractures are too wide for the equations: use shorter steps or smaller "// &
         "apertures"), &
      limit_t("pressure beyond the fluid's table", "-", "with a table", 1.0e-3_rk, never, &
         "Distance of the pressure in a fracture from the range of table_pressure, over that "// &
         "range; fluid properties are constant there", "extend the table of the fluid"), &
      limit_t("deviation of the fluid in rock from its law", "-", "with a law", 0.1_rk, never, &
         "Relative difference of viscosity over density at a pressure or temperature in the "// &
         "rock from that at reference_pressure and the temperature of &heat, which the rock uses", &
         "use a reference_pressure within the rock's pressures, with the viscosity and "// &
         "compressibility there; flow in rock of another temperature is wrong by this much"), &
      limit_t("error of growth by the error of K", "%", "fluid and growth", 5.0_rk, never, &
         "Estimated error, by that of K, of the pressure at which a tip grows over that of the "// &
         "loads, or of its position over the length of its fracture; not with law = 'paris'", &
         "use smaller size_fracture or a larger window"), &
      limit_t("cells over the depth of leak-off", "-", with_fluid, 1.0_rk, never, &
         "Distance of the cells' centres from the faces of fractures without layers, twice, "// &
         "over sqrt(c t), the depth that the fluid has reached since wells were switched", &
         "omit layers = 'off', or use smaller cells: pressures are too high, leak-off too small"), &
      limit_t("error of a well's pressure over its rise", "-", with_fluid, 0.3_rk, never, &
         "Estimated error of the pressure of a well over its largest rise so far, at the end "// &
         "of a stage or of the run; estimates are three times too large in the median", &
         "reduce the tolerance or the step of &time for errors in time, the cells for those in "// &
         "space"), &
      limit_t("K_eq over K_IC in the initial state", "-", "fluid and growth", 1.02_rk, never, &
         "Largest K_eq, over K_IC, of tips that may grow, before the first step: growth begins "// &
         "by a jump, in which pressures fall within microseconds", &
         "errors of pressure, slip and leak-off do not contain its course: reduce the loads or "// &
         "the initial pressure, or use a larger toughness")]
   !&>

contains

   !> Verdict on a value: verdict_fine, verdict_warning or verdict_stop. NaN stops.
   elemental integer function judge(limit, value) result(verdict)
      integer, intent(in) :: limit  !< index into the table
      real(rk), intent(in) :: value  !< in the limit's unit
      real(rk) :: warns, stops  ! the limits

      warns = limits(limit)%warning
      stops = limits(limit)%stop
      verdict = verdict_stop
      if (stops < warns) then
         if (value >= stops) verdict = verdict_warning
         if (value >= warns) verdict = verdict_fine
      else
         if (value <= stops) verdict = verdict_warning
         if (value <= warns) verdict = verdict_fine
      end if
   end function judge

end module report_limits
