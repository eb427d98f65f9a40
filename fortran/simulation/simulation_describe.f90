!> docs/limits.md, written from the tables of limits and of doubts.
module simulation_describe
   use base_number, only: brief_text
   use base_kinds, only: rk
   use scene_plausible, only: doubt_t, doubts
   use simulation_limits, only: limit_t, limits, never
   implicit none(type, external)
   private

   public :: describe_limits

   !&<
   character(len=*), parameter :: introduction(*) = [character(len=128) :: &
      "# Limits of a run", &
      "", &
      "This page is written by `wingcrack-solver --describe-limits` from the tables of the", &
      "program; a test compares them.", &
      "", &
      "At each accepted state a run monitors the quantities below. If one exceeds its warning", &
   "limit, the run continues and reports it: in run.log at the first occurrence, and at the end", &
      "in the list `warnings` of run.json and on the terminal. One sentence per quantity has the", &
      "first value with its time and location, the number of states beyond the limit, and the", &
   "worst value. If one exceeds its stop limit, or is not a number, the state is not accepted:", &
      "the run ends with status 1, and the last good state is on disk. Quantities of tips are", &
      "known only after the state is accepted, and end the run there.", &
      "", &
      "## Monitored quantities", &
      "", &
      "The smallest angle has lower limits, all others upper limits.", &
      ""]

   character(len=*), parameter :: budget(*) = [character(len=128) :: &
      "", &
      "## Origin of the limits", &
      "", &
      "The error of a result has contributions from the model, from mesh and step, and from the", &
      "solution of the equations. With the meshes of `inputs/` the mesh contributes about 1 %", &
   "(docs/verification.md). Each other contribution is limited to a small part of that without", &
      "a warning, and a run stops if a single contribution makes the results useless.", &
      "", &
   "* **Solution of the equations**: forward error bound, mass error, contact residual. In the", &
      "  scenes of `inputs/` they are at most 5e-10, 3e-12 and 9e-11. A warning comes three", &
      "  decades or more below 1 %: the scene is badly scaled, but results are still good. Steps", &
      "  of a scene with a fluid are cut before their contact residual reaches its limit. The", &
   "  forward error bound is that of jumps and pressures in one step, from the condition number", &
      "  of the matrix. In one sealed body with known pressure, the error of the pressure was", &
      "  0.2 to 0.3 of it after one step. Errors accumulate: after three to five steps the slip", &
      "  was wrong by 6e-5, 4e-4 and 9e-4 at bounds of 1e-5, 1e-4 and 3e-4. So a run stops at", &
      "  1e-3; the measured error of the mass may stop it before. Flows round loops of wide", &
      "  fractures are less accurate than other quantities and have a separate limit.", &
      "* **Small strains**: jump, strain, pressure over Young's modulus. The error of the linear", &
      "  equations is about the strain itself: 1 to 2 % of strain corresponds to 1 to 2 % of", &
      "  error. The coupling of the two faces assumes small jumps: at half a cell, traction and", &
      "  pressure act at wrong positions by as much as the mesh resolves. The equations remain", &
      "  solvable, so only values that no rock has stop a run.", &
   "* **Cubic law**: it is valid for fractures that are thin compared with their length, which", &
      "  is smaller than the body; an aperture of a tenth of the body is invalid.", &
      "* **Pressure over the load**: a fracture opens at about the compression across it, and", &
      "  grows at slightly more. Ten times as much is due to too large steps or rates, or to a", &
      "  confined fluid.", &
      "* **Smallest angle**: errors grow with one over its sine; the mesher gives 20 degrees and", &
      "  more where fractures leave enough space.", &
      "* **Stress intensity factors**: on good meshes the two methods differ by 1 to 2 % and the", &
      "  estimated errors are below 1 %. The growth criterion compares K_eq with K_IC, so errors", &
      "  and excess are relative to K_IC: at 5 % the onset is uncertain by as much. After growth", &
      "  in a state no tip should exceed K_IC; 2 % is the tolerance of the alternation of fluid", &
      "  and growth. A larger excess means that growth lags behind the load, and that times and", &
      "  pressures of growth depend on the step.", &
      "* **Error in time**: of each step separately. Automatic steps satisfy the tolerance of", &
      "  &time. For prescribed steps there is a warning if the estimate is half of the range so", &
   "  far; it is some times too large where a well has just begun. There is no estimate in the", &
      "  first step after the start, or after a switch of a well.", &
      "* **Shortest step**: with a fluid a step is never cut to less than a 64th of", &
      "  `smallest_factor` times `step`, or times `end` without it; it is shorter only where a", &
      "  stage, a schedule or the scene ends. A step of this length is accepted for any time", &
   "  error if its equations are solved; otherwise the run ends. It also ends without progress", &
   "  in time: after 300 cut steps, none of them longer than 100 times `smallest_factor` times", &
      "  `step` or `end`, and in which no tip grew.", &
      "", &
      "## Plausibility checks", &
      "", &
   "`check` prints, and `run` lists first among the warnings, values that can be simulated but", &
      "are probably unintended: values out of the usual range, as with wrong units, and", &
      "inconsistent values.", &
      "", &
      "| group | name | unit | condition | reason |", &
      "|---|---|---|---|---|"]
   !&>

contains

   !> Write the page to an open unit.
   subroutine describe_limits(unit)
      integer, intent(in) :: unit  !< connected for formatted writing
      type(limit_t) :: l
      type(doubt_t) :: d
      integer :: i

      write (unit, "(a)") (trim(introduction(i)), i=1, size(introduction))
      write (unit, "(a)") "| quantity | unit | runs | warning | stop | meaning | remedy |", &
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

end module simulation_describe
