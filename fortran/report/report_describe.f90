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

   character(len=*), parameter :: nl = new_line("a")

   !&<
   character(len=*), parameter :: introduction(*) = [character(len=128) :: &
      "# Files of a run", &
      "", &
      "This page is written by `wingcrack-solver --describe-output` from the table that defines", &
      "the output; tests compare it with the code and with the files of real runs.", &
      "", &
      "Released names do not change; new ones may be added. In addition to the files below, a", &
      "run writes `scene.nml`, the scene with all defaults ([input.md](input.md)), and the", &
      "event log `run.log`, whose lines begin with the wall time.", &
      "", &
      "## Conventions", &
      "", &
      "* All numbers are in SI units, angles in degrees; a column's name ends with its unit.", &
      "* Stress and traction are positive in tension, fluid pressure is positive. Stress is", &
      "  total, not effective.", &
      "* The direction of a fracture is that of its vertices in the scene. The jump is the", &
      "  displacement of the left side minus that of the right side: the normal part is positive", &
      "  in opening, the tangential part if the left side moves in the fracture's direction.", &
      "  Contact traction has the same axes: its normal part is negative in compression.", &
      "* The body has unit thickness. Volumes are in m2, that is m3 per metre of thickness;", &
      "  energy (J/m) and seismic moment (N m/m) are per metre of thickness too.", &
      "* Fractures and tips are numbered from 1.", &
      "* A scene with `&fluid` is a run with a fluid; one without is mechanics only. The column", &
      "  `in runs` below states in which of them a column, key or field is written.", &
      "* Without a fluid there is no time. `load_factor`, the factor on the loads of the scene,", &
      "  replaces it in all tables, in network.json and as the time of the VTU files.", &
      "* Rows of the other tables correspond to those of history.csv with the same `time_s` or", &
      "  `load_factor`. Growth can proceed at constant load; `history_row` distinguishes such", &
      "  states.", &
      "* Files are complete at any time: they are written under another name and renamed, the", &
      "  tables every few seconds during a run, run.json last.", &
      "", &
      "## Reading", &
      "", &
      "The tables are CSV with a header, comma separators, decimal points, and quotes where", &
      "needed. Numbers have enough digits to be read back as the same double.", &
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
      "In ParaView open `matrix.pvd`, `fractures.pvd` and `intersections.pvd`, which list the", &
      "times with their files in `vtu/`. Tensors have the component order of ParaView, and Warp", &
      "By Vector displays `displacement`. In Python, `pyvista.read` reads each VTU file."]
   !&>

contains

   !> Write the page to an open unit.
   subroutine describe_output(unit)
      integer, intent(in) :: unit  !< connected for formatted writing
      integer :: i

      do i = 1, size(introduction)
         write (unit, "(a)") trim(introduction(i))
      end do
      call describe(unit, "history.csv", &
                    "A row per accepted time step, after that of the initial state if"//nl// &
                    "it was in equilibrium; without a fluid a row at the end of each"//nl// &
                    "step of the load programme and at each onset of growth. Growth"//nl// &
                    "follows its step: it appears in the next row, also if it ends"//nl// &
                    "the run. With a fluid, a step may contain several increments of"//nl// &
                    "growth, which the windows around the tips follow: tips.csv has a"//nl// &
                    "row for each, and the next row of history.csv follows when the"//nl// &
                    "mesh of the body has been updated. Fluid is conserved: up to the"//nl// &
                    "mass error, the injected and prefilled volume is the sum of"//nl// &
                    "fracture_fluid_m2, rock_fluid_m2, outflow_m2 and"//nl// &
                    "rock_outflow_m2, and leak-off is the sum of rock_fluid_m2 and"//nl// &
                    "rock_outflow_m2.", history_columns)
      call describe(unit, "tips.csv", &
                    "With growth or stress intensity factors: a row per free tip and"//nl// &
                    "state, or per tip and increment of growth. If any tip grows, the"//nl// &
                    "rows of all tips contain the values before the increment. A tip"//nl// &
                    "that has joined a target, or was joined, has no further rows.", tip_columns)
      call describe(unit, "fractures.csv", &
                    "With fractures: a row per fracture cell and written state. These"//nl// &
                    "are the times given by `interval` of `&output`, without a fluid"//nl// &
                    "the ends of the steps of the load programme; the first state on"//nl// &
                    "each mesh that was updated after growth, without a fluid each"//nl// &
                    "onset of growth; and the end of the run.", fracture_columns)
      call describe_words(unit, "state", contact_words)
      call describe(unit, "probes.csv", &
                    "With probes: a row per row of history.csv. `NAME` stands for the"//nl// &
                    "name of a probe; all columns except the time repeat for each"//nl// &
                    "probe.", probe_columns)
      call describe(unit, "events.csv", "A row per event.", event_columns)
      call describe_words(unit, "kind", event_words)
      call describe(unit, "slip_events.csv", &
                    "With a fluid and fractures: a row per slip event, after its end."//nl// &
                    "In a step, a patch is a sequence of adjacent cells of one"//nl// &
                    "fracture that slip, in contact or open. Patches of successive"//nl// &
                    "steps belong to one event if they have faces in common; events"//nl// &
                    "that meet merge. An event ends when no cell of it slips any"//nl// &
                    "more, or when its largest slip rate passes `seismic_slip_rate`"//nl// &
                    "of `&output`: faster slip is a separate event, from nucleation"//nl// &
                    "to arrest. Events with a mean slip below `stimulated_jump` of"//nl// &
                    "`&output` are omitted, and slip of the initial equilibrium is no"//nl// &
                    "event. Without `radiation_damping` the simulation is"//nl// &
                    "quasi-static: slip lasts as long as the injection drives it, the"//nl// &
                    "rate of a jump is that of the step that contains it, and moment"//nl// &
                    "and magnitude include all slip, seismic or not. `sudden_share`"//nl// &
                    "is the part due to unstable growth, which is instantaneous. The"//nl// &
                    "sum of the moments is the increase of seismic_moment_nm of"//nl// &
                    "history.csv since the first state, times `out_of_plane_length`,"//nl// &
                    "except for the omitted events.", &
                    slip_event_columns)
      call describe_words(unit, "ended_by", end_words)
      call describe_words(unit, "kind", slip_words)
      call describe(unit, "wells.csv", "With wells: a row per well and row of history.csv.", &
                    well_columns)
      call describe_words(unit, "control", well_words)
      call describe(unit, "run.json", &
                    "Summary of the run. A dot in a name denotes an object.", &
                    record_keys)
      call describe_words(unit, "status", status_words)
      call describe(unit, "network.json", &
                    "The fractures, their tips and joints. `[]` stands for each item"//nl// &
                    "of a list.", network_keys)
      call describe_words(unit, "joints[].kind", joint_words)
      call describe(unit, "matrix.vtu", &
                    "Fields of the rock in the states of fractures.csv, unless the"//nl// &
                    "scene disables VTU files. The number of states of growth is"//nl// &
                    "limited by `growth_states` of `&output`; run.json has a warning"//nl// &
                    "if it is exceeded. There are values of the triangles, and the"//nl// &
                    "displacement of their nodes. Without a fluid the triangles have"//nl// &
                    "six nodes. Every array has its unit as VTK's key `UNITS_LABEL`."//nl// &
                    "The field data `TimeValue` of each file is its time_s or"//nl// &
                    "load_factor, and `history_row` the number of the row of"//nl// &
                    "history.csv. In the .pvd files times increase from file to file,"//nl// &
                    "as ParaView requires: states with the same load factor differ in"//nl// &
                    "the last digit, and those of a decreasing load are in the order"//nl// &
                    "of their load factor; with `factors` of `&load` the time is"//nl// &
                    "history_row.", &
                    matrix_fields)
      call describe(unit, "fractures.vtu", &
                    "Fields of the fracture cells. The names of fractures 1, 2 and so"//nl// &
                    "on are in network.json: VTU files contain only numbers, for"//nl// &
                    "compatibility with simple readers (meshio).", fracture_fields)
      call describe(unit, "intersections.vtu", &
                    "Fields of the intersections of fractures; written only with a"//nl// &
                    "fluid and if there are any.", intersection_fields)
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
