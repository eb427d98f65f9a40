!> docs/output.md, written from the table of columns.
module report_describe
   use report_columns, only: column_t, contact_words, end_words, event_columns, event_words, &
                             fracture_columns, fracture_fields, history_columns, &
                             intersection_fields, joint_words, matrix_fields, network_keys, &
                             probe_columns, record_keys, slip_event_columns, slip_words, &
                             status_words, tip_columns, well_columns, well_words, word_t
   implicit none(type, external)
   private

   public :: describe_output

   !&<
   character(len=*), parameter :: introduction(*) = [character(len=128) :: &
      "# Files of a run", &
      "", &
      "This page is written by `wingcrack-solver --describe-output` from the table that the", &
      "writing follows; tests hold it against the code and against the files of real runs.", &
      "", &
      "Names stay once they are released; new ones may be added. Beside the files below, a run", &
      "writes `scene.nml`, the scene as understood ([input.md](input.md)), and `run.log`, lines", &
      "for people with the wall time before them.", &
      "", &
      "## Conventions", &
      "", &
      "* All numbers are in SI units, angles in degrees; a column's name ends with its unit.", &
      "* Stress and traction are positive in tension, fluid pressure is positive. Stress is", &
      "  total, not effective.", &
      "* A fracture has the direction of its vertices in the scene. Its jump is the displacement", &
      "  of its left side less that of its right side: the normal part is positive where it", &
      "  opens, the tangential part where the left side moves along the direction. The traction", &
      "  of contact has the same axes: its normal part is negative where the faces press.", &
      "* The body has unit thickness. Volumes are in m2, that is m3 per metre of thickness;", &
      "  energy (J/m) and seismic moment (N m/m) are per metre of thickness too.", &
      "* Fractures and tips are numbered from 1.", &
      "* A scene with `&fluid` is a run with a fluid, one without is mechanics only. The column", &
      "  `in runs` below says in which of them a column, key or field is written.", &
      "* Without a fluid there is no time: `load_factor`, the factor on the loads of the scene,", &
      "  stands in its place in all tables, in network.json and as the time of the VTU files.", &
      "* The rows of the other tables belong to those of history.csv that have the same `time_s`", &
      "  or `load_factor`. Growth can go on at the same load: `history_row` tells such states", &
      "  apart.", &
      "* Files are whole at any time: they are written aside and renamed, the tables every few", &
      "  seconds while a run goes on, run.json last.", &
      "", &
      "## Reading", &
      "", &
      "The tables are CSV with a header: commas, a point before the decimals, quotes where a", &
      "text needs them. Numbers have the digits that read back as the same double.", &
      "", &
      "```python", &
      "import json", &
      "import pandas", &
      "", &
      "history = pandas.read_csv(""out/onset/history.csv"")", &
      "history.plot(x=""time_s"", y=""well_pressure_pa"")", &
      "cells = pandas.read_csv(""out/onset/fractures.csv"")", &
      "last = cells[cells.history_row == len(history)]  # the state at the end", &
      "record = json.load(open(""out/onset/run.json""))  # null: not a number", &
      "```", &
      "", &
      "In ParaView open `matrix.pvd`, `fractures.pvd` and `intersections.pvd`; these list the", &
      "times with their files in `vtu/`. Tensors have the components that ParaView expects, and", &
      "Warp By Vector shows `displacement`. In Python, `pyvista.read` reads each VTU file."]
   !&>

contains

   !> Write the page to an open unit.
   subroutine describe_output(unit)
      integer, intent(in) :: unit  !< connected for formatted writing
      integer :: i

      do i = 1, size(introduction)
         write (unit, "(a)") trim(introduction(i))
      end do
      call describe(unit, "history.csv", "A row per accepted time step, after that of the "// &
                    "initial state if it was in equilibrium; without a fluid a row at the end "// &
                    "of each step of the load programme and at each onset of growth. Growth "// &
                    "follows its step: it shows in the next row, also where that growth ends "// &
                    "the run. With a fluid, a "// &
                    "step may hold several increments of growth, which the windows around the "// &
                    "tips follow: tips.csv has a row of each, and the next row of history.csv "// &
                    "comes once the mesh of the body has followed. Fluid adds up: what was "// &
                    "injected and prefilled is, up to the mass error, fracture_fluid_m2, "// &
                    "rock_fluid_m2, outflow_m2 and rock_outflow_m2, and what leaked off is "// &
                    "rock_fluid_m2 and rock_outflow_m2.", history_columns)
      call describe(unit, "tips.csv", "With growth or stress intensity factors: a row per free "// &
                    "tip and state, or per tip and increment of growth. Where any tip grows, "// &
                    "the rows of all hold the values before that. A tip that "// &
                    "has joined something, or been joined, has no more rows.", tip_columns)
      call describe(unit, "fractures.csv", "With fractures: a row per fracture cell and "// &
                    "written state. These are the times that `interval` of `&output` asks for, "// &
                    "without a fluid the ends of the load programme's steps; the first state "// &
                    "on each mesh that has followed growth, without a fluid each onset of "// &
                    "growth; and the end of the run.", fracture_columns)
      call describe_words(unit, "state", contact_words)
      call describe(unit, "probes.csv", "With probes: a row per row of history.csv. `NAME` "// &
                    "stands for the name of a probe; all columns but the time repeat for each "// &
                    "probe.", probe_columns)
      call describe(unit, "events.csv", "A row per event.", event_columns)
      call describe_words(unit, "kind", event_words)
      call describe(unit, "slip_events.csv", &
                    "With a fluid and fractures: a row per slip event, once it is over."// &
                    " In a step, a patch is a row of cells of one fracture that slip, "// &
                    "in contact or open. Patches of steps that follow each other belong"// &
                    " to one event if they have faces in common; events that meet are "// &
                    "one from then on. An event is over when nothing of it slips any "// &
                    "more, or when its largest slip rate passes `seismic_slip_rate` of "// &
                    "`&output`: what slips faster is an event of its own, from its nucleation "// &
                    "to its arrest. Events of less mean slip than `stimulated_jump` of "// &
                    "`&output` are left out, and the slip of the initial equilibrium is none. "// &
                    "Without `radiation_damping` the simulation is quasi-static: slip lasts as "// &
                    "long as the injection drives it, what jumps has the rate of the step that "// &
                    "it falls into, and moment and magnitude are those of all of it, whether "// &
                    "or not it would be heard; what comes at once, by "// &
                    "unstable growth, is `sudden_share` of it. The moments add up to "// &
                    "what seismic_moment_nm of history.csv has gained since the first "// &
                    "state, times `out_of_plane_length`, but for the events left out.", &
                    slip_event_columns)
      call describe_words(unit, "ended_by", end_words)
      call describe_words(unit, "kind", slip_words)
      call describe(unit, "wells.csv", "With wells: a row per well and row of history.csv.", &
                    well_columns)
      call describe_words(unit, "control", well_words)
      call describe(unit, "run.json", "How the run went. A dot in a name leads into an object.", &
                    record_keys)
      call describe_words(unit, "status", status_words)
      call describe(unit, "network.json", "The fractures, their tips and joints. `[]` stands "// &
                    "for each item of a list.", network_keys)
      call describe_words(unit, "joints[].kind", joint_words)
      call describe(unit, "matrix.vtu", "Fields of the rock in the states of fractures.csv, "// &
                    "unless the scene turns VTU files off; of growth only as many as "// &
                    "`growth_states` of `&output` says, after which run.json has a warning. "// &
                    "There are values of the triangles, and the displacement of their nodes "// &
                    "too. Without a fluid these are six to a triangle. Every array has its "// &
                    "unit as VTK's key `UNITS_LABEL`. The field data `TimeValue` of each file "// &
                    "is its time_s or load_factor, and `history_row` the number of the row of "// &
                    "history.csv. In matrix.pvd and the others, times rise from file to file, "// &
                    "as ParaView needs it: states with the same load factor are told apart in "// &
                    "the last digit, and those of a falling load stand in the order of their "// &
                    "load factor; with `factors` of `&load` history_row stands there.", &
                    matrix_fields)
      call describe(unit, "fractures.vtu", "Fields of the fracture cells. The names of "// &
                    "fractures 1, 2 and so on are in network.json: VTU files hold numbers "// &
                    "alone, as plain readers (meshio) want them.", fracture_fields)
      call describe(unit, "intersections.vtu", "Fields of the points where fractures meet; "// &
                    "written only if there are any and a fluid.", intersection_fields)
   end subroutine describe_output

   !> A section of the page: a file, its rows and its columns, keys or fields.
   subroutine describe(unit, file, meaning, columns)
      integer, intent(in) :: unit
      character(len=*), intent(in) :: file
      character(len=*), intent(in) :: meaning  !< whole sentences
      type(column_t), intent(in) :: columns(:)
      integer :: i

      write (unit, "(a)") "", "## "//file, "", meaning, "", "| name | unit | in runs | meaning |", &
         "|---|---|---|---|"
      do i = 1, size(columns)
         write (unit, "(a)") "| `"//trim(columns(i)%name)//"` | "//trim(columns(i)%unit)//" | "// &
            trim(columns(i)%runs)//" | "//trim(columns(i)%meaning)//" |"
      end do
   end subroutine describe

   !> The words that the column or key above may hold.
   subroutine describe_words(unit, name, words)
      integer, intent(in) :: unit
      character(len=*), intent(in) :: name  !< of the column or key
      type(word_t), intent(in) :: words(:)
      integer :: i

      write (unit, "(a)") "", "`"//name//"` is one of these:", ""
      do i = 1, size(words)
         write (unit, "(a)") "* `"//trim(words(i)%word)//"`: "//trim(words(i)%meaning)
      end do
   end subroutine describe_words

end module report_describe
