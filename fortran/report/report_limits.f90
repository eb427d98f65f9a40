!> The limits of a run: what is watched at each accepted state, from which value on it is worth a
!! warning, and from which on the results are worth nothing and the run stops. The one table of
!! them; docs/limits.md is written from it, and says where the numbers come from.
!!
!! docs/limits.md, written from the tables of limits and of doubts.
module report_limits
   use base_kinds, only: rk
   use base_number, only: brief_text
   use scene_plausible, only: doubt_t, doubts
   implicit none(type, external)
   private

   public :: describe_limits, judge, limit_angle, limit_aperture, limit_contact
   public :: limit_fluid_in_rock, limit_forward_error, limit_jump, limit_k_error, limit_k_methods
   public :: limit_k_to_grow, limit_keq, limit_layering, limit_loop_flow, limit_mass
   public :: limit_pressure_load, limit_pressure_stiffness, limit_strain, limit_t, limit_table
   public :: limit_time_error, limits, verdict_fine, verdict_stop, verdict_warning

   integer, parameter :: verdict_fine = 0, verdict_warning = 1, verdict_stop = 2

   real(rk), parameter :: never = huge(1.0_rk)  !< the limit of what does not stop a run

   !> A quantity that is watched. Where the limit for a stop is the smaller one, small values are
   !! bad, else large ones.
   type :: limit_t
      character(len=56) :: name = ""
      character(len=8) :: unit = "-"
      character(len=16) :: runs = "always"  !< in which it is watched
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
                         limit_fluid_in_rock = 18

   character(len=*), parameter :: with_fluid = "with a fluid"
   character(len=*), parameter :: with_growth = "with growth"

   ! The table keeps its own layout.
   !&<
   type(limit_t), parameter :: limits(*) = [ &
      limit_t("forward error bound", "-", with_fluid, 1.0e-6_rk, 1.0e-3_rk, &
              "Bound of the rounding errors in the solution on the fractures, relative", &
              "look for values of the scene that lie too many decades apart"), &
      limit_t("mass error", "-", with_fluid, 1.0e-8_rk, 1.0e-3_rk, &
              "Fluid gained or lost by numerical error so far, over the injected fluid or the "// &
              "fractures' volume, or without these what the pressure would store in the rock", &
              "look for values of the scene that lie too many decades apart"), &
      limit_t("contact residual", "-", "always", 1.0e-8_rk, 1.0e-4_rk, &
              "How far the law of contact is missed, over the largest traction", &
              "give a smaller newton_tolerance"), &
      limit_t("aperture over the body's size", "-", with_fluid, 1.0e-2_rk, 1.0e-1_rk, &
              "Largest aperture of a fracture cell over the body's shorter side", &
              "look at the rates of the wells, how the body is held, and all units"), &
      limit_t("jump over its fracture cell's length", "-", "always", 0.5_rk, 1.0e4_rk, &
              "Largest opening or slip over the length of its fracture cell; the faces are "// &
              "coupled as if they had not moved", &
              "look at the loads, or give larger fracture cells: finer ones do not help"), &
      limit_t("strain of the body", "-", "always", 2.0e-2_rk, 1.0e2_rk, &
              "Difference between the largest and the smallest displacement over the body's "// &
              "size in that direction", &
              "look at the loads and at young: the equations are for small strains"), &
      limit_t("pressure over the load", "-", with_fluid, 1.0e1_rk, 1.0e4_rk, &
              "Largest fluid pressure, without its sign, over what can be expected: the "// &
              "largest load, initial pressure, or pressure that lets the longest fracture grow", &
              "look at the rates of the wells; shorten the step"), &
      limit_t("pressure over Young's modulus", "-", with_fluid, 1.0e-2_rk, 1.0_rk, &
              "Largest fluid pressure, without its sign, over Young's modulus", &
              "look at the rates of the wells and at young; shorten the step"), &
      limit_t("smallest angle of the mesh", "degree", "always", 10.0_rk, 0.1_rk, &
              "Smallest angle of all triangles", &
              "move fractures apart that run closely beside each other, or give smaller cells"), &
      limit_t("disagreement of the stress intensity factors", "-", "always", 0.1_rk, 10.0_rk, &
              "Difference of K by the interaction integral and by displacement correlation, "// &
              "over the largest K of all tips, or over K_IC if that is larger and tips may grow", &
              "give smaller cells around the tip"), &
      limit_t("estimated error of a stress intensity factor", "-", with_growth, 5.0e-2_rk, &
              10.0_rk, "Estimated error of K of a tip that may grow, over K_IC; with a fluid "// &
              "that of both levels", &
              "growth in this state is not certain: give smaller cells around the tip, or with "// &
              "a fluid a larger window"), &
      limit_t("error of K over K_IC where a tip would grow", "%", with_growth, 5.0_rk, 5.0_rk, &
              "Estimated error of K, over K_IC or K_eq if that is larger, of a tip whose K_eq "// &
              "is at K_IC within it; with a fluid after its window was improved; not with law "// &
              "= 'paris'", &
              "growth cannot be decided: give a smaller size_fracture, with a fluid a larger "// &
              "window, without one &adaptive"), &
      limit_t("K_eq over K_IC after growth", "-", "fluid and growth", 1.02_rk, 1.0e2_rk, &
              "Largest K_eq, over K_IC, of the tips that may grow, when growth in the state is "// &
              "done", &
              "shorten the step: growth lags behind the load"), &
      limit_t("error in time of a step", "-", with_fluid, 0.5_rk, never, &
              "Estimated error of a time step in the mean pressure, slip or opening, over the "// &
              "range that these have gone through", &
              "shorten the step, or leave it out: then the error decides about it"), &
      limit_t("contrast in a cell that an outline cuts", "-", "with &region", 1.0e3_rk, never, &
              "How much better rock conducts along the outline than across, in a cell with "// &
              "both; above it flow along is up to a quarter too small, and pressures may leave "// &
              "their bounds by a third", &
              "leave outlines room from fractures and each other (docs/theory.md), so that the "// &
              "mesh follows them"), &
      limit_t("flow round loops of fractures", "-", with_fluid, 1.0e-3_rk, never, &
              "What is not known of it, over the largest flow, or one that exchanges the "// &
              "fluid of a cell in the step: nothing but pressure differences below their "// &
              "rounding decides about it", &
              "such fractures are wide for the equations: shorter steps help, smaller apertures"), &
      limit_t("pressure beyond the fluid's table", "-", "with a table", 1.0e-3_rk, never, &
              "How far the pressure in a fracture lies outside of table_pressure, over its "// &
              "range; the fluid is as at the end of the table there", &
              "give the table of the fluid further pressures"), &
      limit_t("fluid of the rock beside its law", "-", "with a fluid law", 0.1_rk, never, &
              "How far viscosity over density at a pressure in the rock is from that at "// &
              "reference_pressure, relative: the rock takes the latter", &
              "give a reference_pressure in the middle of the rock's pressures, with the "// &
              "viscosity and compressibility there")]
   !&>

   !&<
   character(len=*), parameter :: introduction(*) = [character(len=128) :: &
      "# Limits of a run", &
      "", &
      "This page is written by `wingcrack-solver --describe-limits` from the tables that the", &
      "program follows; a test holds it against them.", &
      "", &
      "At each accepted state a run watches the quantities below. Where one passes its limit", &
      "for a warning, the run goes on and says so: in run.log when it first happens, at the end", &
      "in the list `warnings` of run.json and on the terminal. A sentence per quantity gives", &
      "the first value with its time and place, in how many states the limit was passed, and", &
      "the worst value. Where one passes its limit for a stop, or is not a number, the state is", &
      "not accepted: the run ends with status 1, and the last good state is on disk. Those of", &
      "tips are known after the state is accepted, and end the run there.", &
      "", &
      "## What is watched", &
      "", &
      "The smallest angle is watched from below, all others from above.", &
      ""]

   character(len=*), parameter :: budget(*) = [character(len=128) :: &
      "", &
      "## Where the limits come from", &
      "", &
      "The error of a result is that of the model, of the mesh and step, and of the solution of", &
   "the equations. With the meshes of `inputs/` the mesh gives about 1 % (docs/verification.md),", &
      "so the share of each other source is held to a small part of that without a warning,", &
      "and a run stops where a source alone exceeds what anybody could use.", &
      "", &
     "* **Solution of the equations**: forward error bound, mass error, contact residual. In the", &
      "  scenes of `inputs/` they are at most 5e-10, 3e-12 and 9e-11. A warning comes three", &
      "  decades or more below 1 %: something is badly scaled, but results are still good. Steps", &
      "  of a scene with a fluid are cut before their contact residual reaches its limit. The", &
      "  forward error bound is that of jumps and pressures, by the condition of the matrix, in", &
      "  one step. In one sealed body, whose pressure is known, the error of the pressure was", &
      "  0.2 to 0.3 of it after one step; errors add up, and after three to five steps the slip", &
      "  was wrong by 6e-5, 4e-4 and 9e-4 at bounds of 1e-5, 1e-4 and 3e-4. So a run stops at", &
      "  1e-3; the error of the mass, which is measured, may stop it before that. Flows round", &
      "  loops of wide fractures are known less well than all else: they have a limit of", &
      "  their own.", &
      "* **Small strains**: jump, strain, pressure over Young's modulus. What the linear", &
      "  equations leave out is about the strain itself, so 1 to 2 % of strain is worth 1 to 2 %", &
      "  of error. The faces of a fracture are coupled as if they had not moved: half a cell is", &
      "  where traction and pressure act at the wrong place by as much as the mesh can tell.", &
      "  As the equations stay solvable, only values that are nobody's rock stop a run.", &
      "* **Cubic law**: it is for fractures that are thin beside their length, and these are", &
      "  smaller than the body; a tenth of the body is no fracture.", &
      "* **Pressure over the load**: a fracture opens at about the compression across it, and", &
      "  grows at a little more. Ten times as much comes from steps too long or rates too large,", &
      "  or from a fluid that has nowhere to go.", &
      "* **Smallest angle**: errors grow with one over its sine; the mesher gives 20 degrees and", &
      "  more where the fractures leave it room.", &
     "* **Stress intensity factors**: on sound meshes the two methods differ by 1 to 2 % and the", &
      "  estimated errors are below 1 %. Growth asks whether K_eq reaches K_IC, so errors and", &
     "  excess are in shares of K_IC: at 5 % the onset is uncertain by as much. In a state whose", &
    "  growth is done no tip should exceed K_IC; 2 % is what fluid and growth, which take turns,", &
    "  may leave. More means that growth lags behind the load, and times and pressures of growth", &
      "  depend on the step.", &
      "* **Error in time**: of each step by itself. Steps that the program chooses are held to", &
     "  the tolerance of &time; those that a scene gives are warned of where the estimate, which", &
    "  is some times too large where a well has just begun, is half of what has happened so far.", &
      "  The first step after the start, or after a well's switch, has nothing to compare with.", &
      "* **Shortest step**: with a fluid a step is never cut to less than a 64th of", &
      "  `smallest_factor` times `step`, or times `end` without it; it is shorter only where a", &
      "  stage, a course or the scene ends. There it is taken whatever its error in time, if its", &
      "  equations are solved, else the run ends. It also ends when time makes no headway: after", &
   "  300 steps that were cut, none of them longer than 100 times `smallest_factor` times `step`", &
      "  or `end`, and in which no tip grew.", &
      "", &
      "## What is doubted", &
      "", &
      "`check` prints, and `run` puts first among the warnings, what can be simulated but is", &
      "hardly meant: values out of the usual range, as wrong units give, and values that do not", &
      "go together.", &
      "", &
      "| group | name | unit | doubted | why |", &
      "|---|---|---|---|---|"]
   !&>

contains

   !> Whether a value is fine, worth a warning or a reason to stop. What is not a number stops.
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

   !> Write the page to an open unit.
   subroutine describe_limits(unit)
      integer, intent(in) :: unit  !< connected for formatted writing
      type(limit_t) :: l
      type(doubt_t) :: d
      integer :: i

      write (unit, "(a)") (trim(introduction(i)), i=1, size(introduction))
      write (unit, "(a)") "| quantity | unit | watched | warning | stop | meaning | remedy |", &
         "|---|---|---|---|---|---|---|"
      do i = 1, size(limits)
         l = limits(i)
         write (unit, "(a)") "| "//trim(l%name)//" | "//trim(l%unit)//" | "//trim(l%runs)// &
            " | "//bound(l%warning)//" | "//bound(l%stop)//" | "//trim(l%meaning)//" | "// &
            trim(l%remedy)//" |"
      end do
      write (unit, "(a)") (trim(budget(i)), i=1, size(budget))
      do i = 1, size(doubts)
         d = doubts(i)
         write (unit, "(a)") "| `&"//trim(d%group)//"` | `"//trim(d%name)//"` | "// &
            trim(d%unit)//" | "//trim(d%doubtful)//" | "//trim(d%usual)//" |"
      end do
   end subroutine describe_limits

   pure function bound(value) result(text)
      real(rk), intent(in) :: value  !< a limit
      character(len=:), allocatable :: text

      text = "never"
      if (value < never) text = brief_text(value, 3)
   end function bound

end module report_limits
