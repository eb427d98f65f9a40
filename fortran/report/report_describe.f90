!> The table of names as JSON, for `wingcrack-solver --describe json`: the names of scene files, the
!! contents of a run's files, limits and plausibility checks. The pages of docs/ and the Python
!! packages read this text from post/wingcrack/names.json.
module report_describe
   use base_kinds, only: rk
   use report_column, only: column_t
   use report_columns, only: entry_columns, event_columns, fracture_columns, history_columns, &
                             probe_columns, slip_event_columns, tip_columns, well_columns
   use report_json, only: json_t
   use report_keys, only: fracture_fields, intersection_fields, matrix_fields, network_keys, &
                          record_keys, window_fields
   use report_limits, only: limits
   use report_words, only: contact_words, end_words, event_words, joint_words, slip_words, &
                           status_words, well_words, word_t
   use scene_parameter_table, only: parameters
   use scene_parameters, only: choice_name, choice_value, group_t, groups, in_fluid, in_mechanics, &
                               parameter_t
   use scene_plausible, only: doubts
   implicit none(type, external)
   private

   public :: description

   ! Contents of the files in whole sentences. The texts keep their own layout.
   !&<
   character(len=*), parameter :: about_history = &
      "A row per accepted time step, after that of the initial state if it was in equilibrium; "// &
      "without a fluid a row at the end of each step of the load programme and at each onset "// &
      "of growth. Growth follows its step: it appears in the next row, also if it ends the "// &
      "run. With a fluid, a step may contain several increments of growth, which the windows "// &
      "around the tips follow: tips.csv has a row for each, and the next row of history.csv "// &
      "follows when the mesh of the body has been updated. Fluid is conserved: up to the mass "// &
      "error, the injected and prefilled volume is the sum of fracture_fluid_m2, "// &
      "rock_fluid_m2, outflow_m2 and rock_outflow_m2, and leak-off is the sum of rock_fluid_m2 "// &
      "and rock_outflow_m2."
   character(len=*), parameter :: about_tips = &
      "With growth or stress intensity factors: a row per free tip and state, or per tip and "// &
      "increment of growth. If any tip grows, the rows of all tips contain the values before "// &
      "the increment. A tip that has joined a target, or was joined, has no further rows."
   character(len=*), parameter :: about_fractures = &
      "With fractures: a row per fracture cell and written state. These are the times given by "// &
      "`interval` of `&output`, without a fluid the ends of the steps of the load programme; "// &
      "the first state on each mesh that was updated after growth, without a fluid each onset "// &
      "of growth; and the end of the run."
   character(len=*), parameter :: about_probes = &
      "With probes: a row per row of history.csv. `NAME` stands for the name of a probe; all "// &
      "columns except the time repeat for each probe."
   character(len=*), parameter :: about_slip_events = &
      "With a fluid and fractures: a row per slip event, after its end. In a step, a patch is "// &
      "a sequence of adjacent cells of one fracture that slip, in contact or open. Patches of "// &
      "successive steps belong to one event if they have faces in common; events that meet "// &
      "merge. An event ends when no cell of it slips any more, or when its largest slip rate "// &
      "passes `seismic_slip_rate` of `&output`: faster slip is a separate event, from "// &
      "nucleation to arrest. Events with a mean slip below `stimulated_jump` of `&output` are "// &
      "omitted, and slip of the initial equilibrium is no event. Without `radiation_damping` "// &
      "the simulation is quasi-static: slip lasts as long as the injection drives it, the rate "// &
      "of a jump is that of the step that contains it, and moment and magnitude include all "// &
      "slip, seismic or not. `sudden_share` is the part due to unstable growth, which is "// &
      "instantaneous. The sum of the moments is the increase of seismic_moment_nm of "// &
      "history.csv since the first state, times `out_of_plane_length`, except for the omitted "// &
      "events."
   character(len=*), parameter :: about_matrix = &
      "Fields of the rock in the states of fractures.csv, unless the scene disables VTU files. "// &
      "The number of states of growth is limited by `growth_states` of `&output`; run.json has "// &
      "a warning if it is exceeded. There are values of the triangles, and the displacement of "// &
      "their nodes. Without a fluid the triangles have six nodes. Every array has its unit as "// &
      "VTK's key `UNITS_LABEL`. The field data `TimeValue` of each file is its time_s or "// &
      "load_factor, and `history_row` the number of the row of history.csv. In the .pvd files "// &
      "times increase from file to file, as ParaView requires: states with the same load "// &
      "factor differ in the last digit, and those of a decreasing load are in the order of "// &
      "their load factor; with `factors` of `&load` the time is history_row."
   character(len=*), parameter :: about_fracture_fields = &
      "Fields of the fracture cells. The names of fractures 1, 2 and so on are in "// &
      "network.json: VTU files contain only numbers, for compatibility with simple readers "// &
      "(meshio)."
   !&>

   !> Names of the kinds of parameters, kind_real to kind_names.
   character(len=*), parameter :: kind_words(9) = [character(len=21) :: "number", &
                                                     "list of numbers", "whole number", "logical", &
                                                                         "text", "name", "choice", &
                                                                          "list of whole numbers", &
                                                                                    "list of names"]

   !> Scenes in which a name without a default is required, need_never to need_choice.
   character(len=*), parameter :: need_words(0:4) = [character(len=15) :: "", "always", &
                                                                     "with &fluid", "with growth", &
                                                                                  "with its choice"]

contains

   !> The table of names as JSON.
   function description(version) result(text)
      character(len=*), intent(in) :: version  !< of the program
      character(len=:), allocatable :: text
      type(json_t) :: json
      integer :: i

      call json%begin_object("")
      call json%add("version", version)
      call json%begin_array("groups")
      do i = 1, size(groups)
         call put_group(json, groups(i))
      end do
      call json%end_array()
      call json%begin_array("files")
      call put_files(json)
      call json%end_array()
      call json%begin_array("words")
      call put_words(json, "fractures.csv", "state", contact_words)
      call put_words(json, "events.csv", "kind", event_words)
      call put_words(json, "slip_events.csv", "ended_by", end_words)
      call put_words(json, "slip_events.csv", "kind", slip_words)
      call put_words(json, "wells.csv", "control", well_words)
      call put_words(json, "run.json", "status", status_words)
      call put_words(json, "network.json", "joints[].kind", joint_words)
      call json%end_array()
      call json%begin_array("limits")
      do i = 1, size(limits)
         call begin_row(json, limits(i)%name, limits(i)%unit)
         call json%add("runs", trim(limits(i)%runs))
         call put_limit(json, "warning", limits(i)%warning)
         call put_limit(json, "stop", limits(i)%stop)
         call json%add("remedy", trim(limits(i)%remedy))
         call end_row(json, limits(i)%meaning)
      end do
      call json%end_array()
      call json%begin_array("checks")
      do i = 1, size(doubts)
         call begin_row(json, doubts(i)%name, doubts(i)%unit)
         call json%add("group", trim(doubts(i)%group))
         call json%add("condition", trim(doubts(i)%doubtful))
         call end_row(json, doubts(i)%usual)
      end do
      call json%end_array()
      call json%end_object()
      text = json%text()
   end function description

   !> A group with its names.
   subroutine put_group(json, group)
      type(json_t), intent(inout) :: json
      type(group_t), intent(in) :: group
      integer :: i

      call json%begin_object("")
      call json%add("name", trim(group%name))
      call put_logical(json, "repeated", group%repeated)
      call put_scenes(json, group%scenes)
      call json%add("meaning", trim(group%meaning))
      call json%begin_array("parameters")
      do i = 1, size(parameters)
         if (parameters(i)%group == group%name) call put_parameter(json, parameters(i))
      end do
      call json%end_array()
      call json%end_object()
   end subroutine put_group

   !> A name of a group, without the members that do not apply.
   subroutine put_parameter(json, parameter)
      type(json_t), intent(inout) :: json
      type(parameter_t), intent(in) :: parameter
      character(len=:), allocatable :: rest

      call begin_row(json, parameter%name, parameter%unit)
      call json%add("kind", trim(kind_words(parameter%kind)))
      call put_text(json, "default", parameter%default)
      call put_text(json, "required", need_words(parameter%need))
      call put_text(json, "absent", parameter%absent)
      call put_logical(json, "derived", parameter%derived)
      call put_scenes(json, parameter%scenes)
      associate (range => parameter%range)
         if (range%lowest > -huge(1.0_rk)) call json%add("minimum", range%lowest)
         if (range%highest < huge(1.0_rk)) call json%add("maximum", range%highest)
         call put_logical(json, "above_minimum", range%open_below)
         call put_logical(json, "below_maximum", range%open_above)
      end associate
      call put_text(json, "at_most", parameter%at_most)
      call put_text(json, "with", parameter%with)
      if (parameter%of /= "") then
         call json%begin_object("of")
         call json%add(choice_name(parameter), choice_value(parameter))
         call json%end_object()
      end if
      if (parameter%choices /= "") then
         call json%begin_array("choices")
         rest = trim(parameter%choices)//"|"
         do while (len(rest) > 0)
            call json%add("", rest(:index(rest, "|") - 1))
            rest = rest(index(rest, "|") + 1:)
         end do
         call json%end_array()
      end if
      call end_row(json, parameter%meaning)
   end subroutine put_parameter

   !> The files of a run.
   subroutine put_files(json)
      type(json_t), intent(inout) :: json

      call put_file(json, "history.csv", about_history, history_columns)
      call put_file(json, "tips.csv", about_tips, tip_columns)
      call put_file(json, "fractures.csv", about_fractures, fracture_columns)
      call put_file(json, "probes.csv", about_probes, probe_columns)
      call put_file(json, "events.csv", "A row per event.", event_columns)
      call put_file(json, "slip_events.csv", about_slip_events, slip_event_columns)
      call put_file(json, "wells.csv", &
                    "With wells: a row per well and row of history.csv.", well_columns)
      call put_file(json, "entries.csv", &
                    "With wells that have several entries, or a loss at one: a row per entry "// &
                    "and row of history.csv.", entry_columns)
      call put_file(json, "run.json", &
                    "Summary of the run. A dot in a name denotes an object.", record_keys)
      call put_file(json, "network.json", &
                    "The fractures, their tips and joints. `[]` stands for each item of a "// &
                    "list.", network_keys)
      call put_file(json, "matrix.vtu", about_matrix, matrix_fields)
      call put_file(json, "fractures.vtu", about_fracture_fields, fracture_fields)
      call put_file(json, "intersections.vtu", &
                    "Fields of the intersections of fractures; written only with a fluid and "// &
                    "if there are any.", intersection_fields)
      call put_file(json, "windows.vtu", &
                    "With windows of &output: the elements of all windows, as their corners.", &
                    window_fields)
   end subroutine put_files

   !> A file, its rows and its columns, keys or fields.
   subroutine put_file(json, file, meaning, columns)
      type(json_t), intent(inout) :: json
      character(len=*), intent(in) :: file
      character(len=*), intent(in) :: meaning  !< whole sentences
      type(column_t), intent(in) :: columns(:)
      integer :: i

      call json%begin_object("")
      call json%add("name", file)
      call json%add("meaning", meaning)
      call json%begin_array("columns")
      do i = 1, size(columns)
         call begin_row(json, columns(i)%name, columns(i)%unit)
         call json%add("runs", trim(columns(i)%runs))
         call json%add("error", trim(columns(i)%error))
         if (columns(i)%meaning == "") then
            call end_row(json, "Estimated error of "//without(columns(i)%name, "_error"))
         else
            call end_row(json, columns(i)%meaning)
         end if
      end do
      call json%end_array()
      call json%end_object()
   end subroutine put_file

   !> A text without the first of these parts of it.
   pure function without(text, part) result(rest)
      character(len=*), intent(in) :: text, part
      character(len=:), allocatable :: rest

      rest = text(:index(text, part) - 1)//text(index(text, part) + len(part):)
   end function without

   !> The possible words of a column or key of a file.
   subroutine put_words(json, file, name, words)
      type(json_t), intent(inout) :: json
      character(len=*), intent(in) :: file
      character(len=*), intent(in) :: name  !< of the column or key
      type(word_t), intent(in) :: words(:)
      integer :: i

      call json%begin_object("")
      call json%add("file", file)
      call json%add("name", name)
      call json%begin_object("words")
      do i = 1, size(words)
         call json%add(trim(words(i)%word), trim(words(i)%meaning))
      end do
      call json%end_object()
      call json%end_object()
   end subroutine put_words

   !> Begin a row of a table, which is one line of the text.
   subroutine begin_row(json, name, unit)
      type(json_t), intent(inout) :: json
      character(len=*), intent(in) :: name, unit

      call json%begin_object("")
      json%one_line = .true.
      call json%add("name", trim(name))
      call json%add("unit", trim(unit))
   end subroutine begin_row

   !> End a row of a table.
   subroutine end_row(json, meaning)
      type(json_t), intent(inout) :: json
      character(len=*), intent(in) :: meaning

      call json%add("meaning", trim(meaning))
      call json%end_object()
      json%one_line = .false.
   end subroutine end_row

   !> A text, unless it is empty.
   subroutine put_text(json, key, text)
      type(json_t), intent(inout) :: json
      character(len=*), intent(in) :: key, text

      if (text /= "") call json%add(key, trim(text))
   end subroutine put_text

   !> A logical, unless it is false.
   subroutine put_logical(json, key, value)
      type(json_t), intent(inout) :: json
      character(len=*), intent(in) :: key
      logical, intent(in) :: value

      if (value) call json%add_raw(key, "true")
   end subroutine put_logical

   !> The scenes that may have a group or a name, if not all.
   subroutine put_scenes(json, scenes)
      type(json_t), intent(inout) :: json
      integer, intent(in) :: scenes

      if (scenes == in_fluid) call json%add("scenes", "with &fluid")
      if (scenes == in_mechanics) call json%add("scenes", "without &fluid")
   end subroutine put_scenes

   !> A limit; null if it is never reached.
   subroutine put_limit(json, key, value)
      type(json_t), intent(inout) :: json
      character(len=*), intent(in) :: key
      real(rk), intent(in) :: value

      if (value < huge(1.0_rk)) then
         call json%add(key, value)
      else
         call json%add_raw(key, "null")
      end if
   end subroutine put_limit

end module report_describe
