!> docs/limits.md, written from the tables of limits and of doubts.
module report_doubts
   use base_kinds, only: rk
   use base_number, only: brief_text
   use report_limits, only: limit_t, limits, never
   use scene_plausible, only: doubt_t, doubts
   implicit none(type, external)
   private

   public :: describe_limits

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

end module report_doubts
