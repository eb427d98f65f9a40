!> The CSV tables of a run, with the source of the value of each column of report_columns.
module report_tables
   use base_archive, only: archive_t
   use base_errors, only: error_t, keep_first
   use base_kinds, only: degrees, ik, rk
   use base_texts, only: text_t
   use contact_law, only: state_name
   use mesh_geometry, only: fracture_cell_centre
   use mesh_types, only: fracture_mesh_t
   use report_column, only: applies, column_t, well_count
   use report_columns, only: entry_columns, event_columns, fracture_columns, history_columns, &
                             probe_columns, slip_event_columns, tip_columns, well_columns
   use report_rows, only: entry_row_t, event_t, fracture_fields_t, history_row_t, probe_row_t, &
                          slip_event_t, tip_row_t, well_row_t
   use report_series, only: series_t
   use scene_types, only: name_length, scene_t
   implicit none(type, external)
   private

   public :: tables_t

   integer, parameter :: column_length = name_length + 17
   integer, parameter :: history = 1, tips = 2, fractures = 3, probes = 4, events = 5, &
                         slip_events = 6, wells = 7, entries = 8

   !> The tables; those that do not apply to the scene remain closed.
   type :: tables_t
      type(series_t), allocatable :: all(:)  !< unallocated: not yet opened
      type(text_t), allocatable, private :: probe_names(:)
      type(text_t), allocatable, private :: pressure_names(:)  !< columns of the wells' pressures
   contains
      procedure :: open => open_tables
      procedure :: history_rows
      procedure :: history_row
      procedure :: tip_row
      procedure :: fracture_rows
      procedure :: probe_row
      procedure :: event_row
      procedure :: slip_event_row
      procedure :: well_row
      procedure :: entry_row
      procedure :: flush => flush_tables
      procedure :: take_over
      procedure :: visit
      procedure :: visit_text
   end type tables_t

contains

   !> Open the tables of a scene.
   subroutine open_tables(self, directory, scene)
      class(tables_t), intent(out) :: self
      character(len=*), intent(in) :: directory
      type(scene_t), intent(in) :: scene

      allocate (self%all(entries))
      call open_history(self, directory//"/history.csv", scene)
      call add(events, "events", event_columns)
      if (scene%growth%enabled .or. scene%growth%intensities) call add(tips, "tips", tip_columns)
      if (scene%has_fractures()) then
         call add(fractures, "fractures", fracture_columns)
         if (scene%has_fluid()) call add(slip_events, "slip_events", slip_event_columns)
      end if
      if (scene%has_wells()) call add(wells, "wells", well_columns)
      if (scene%has_entries()) call add(entries, "entries", entry_columns)
      if (allocated(scene%probes)) then
         if (size(scene%probes) > 0) call open_probes(self, directory//"/probes.csv", scene)
      end if

   contains

      !> Open a table with those of its columns that apply to the scene.
      subroutine add(table, name, columns)
         integer, intent(in) :: table
         character(len=*), intent(in) :: name
         type(column_t), intent(in) :: columns(:)

         call self%all(table)%open(directory//"/"//name//".csv", columns%name, &
                                   applies(columns, scene))
      end subroutine add

   end subroutine open_tables

   !> Add an accepted step.
   subroutine history_row(self, row)
      class(tables_t), intent(inout) :: self
      type(history_row_t), intent(in) :: row
      real(rk) :: only
      integer :: w

      only = 0.0_rk
      if (size(self%pressure_names) == 1) only = row%well_pressure(1)
      associate (table => self%all(history))
         call table%put("time_s", row%time)
         call table%put("load_factor", row%time)
         call table%put("dt_s", row%dt)
         call table%put("newton_iterations", row%newton_iterations)
         call table%put("well_pressure_pa", only)
         do w = 1, size(self%pressure_names)
            call table%put(self%pressure_names(w)%text, row%well_pressure(w))
         end do
         call table%put("injected_m2", row%injected)
         call table%put("leakoff_m2", row%leakoff)
         call table%put("prefilled_m2", row%prefilled)
         call table%put("outflow_m2", row%outflow)
         call table%put("fracture_volume_m2", row%fracture_volume)
         call table%put("mass_error_relative", row%mass_error_relative)
         call table%put("max_slip_m", row%max_slip)
         call table%put("max_opening_m", row%max_opening)
         call table%put("n_stick", row%n_stick)
         call table%put("n_slip", row%n_slip)
         call table%put("n_open", row%n_open)
         call table%put("fracture_length_m", row%fracture_length)
         call table%put("n_tips", row%n_tips)
         call table%put("n_intersections", row%n_intersections)
         call table%put("seismic_moment_nm", row%seismic_moment)
         call table%put("fracture_length_error_m", row%length_error)
         call table%put("well_pressure_error_pa", row%well_pressure_error)
         call table%put("strain_energy_j", row%strain_energy)
         call table%put("injection_rate_m2_s", row%injection_rate)
         call table%put("injectivity_m2_s_pa", row%injectivity)
         call table%put("produced_m2", row%produced)
         call table%put("fracture_fluid_m2", row%fracture_fluid)
         call table%put("rock_fluid_m2", row%rock_fluid)
         call table%put("rock_outflow_m2", row%rock_outflow)
         call table%put("stimulated_length_m", row%stimulated_length)
         call table%put("connected_length_m", row%connected_length)
         call table%put("connected_stimulated_m", row%connected_stimulated)
         call table%put("n_clusters", row%n_clusters)
         call table%put("max_slip_rate_m_s", row%max_slip_rate)
         call table%put("connections_per_branch", row%connections_per_branch)
         call table%put("dimensionless_toughness", row%dimensionless_toughness)
         call table%put("dimensionless_leakoff", row%dimensionless_leakoff)
         call table%put("injected_error_m2", row%error%injected)
         call table%put("produced_error_m2", row%error%produced)
         call table%put("leakoff_error_m2", row%error%leakoff)
         call table%put("outflow_error_m2", row%error%outflow)
         call table%put("fracture_fluid_error_m2", row%error%fracture_fluid)
         call table%put("rock_fluid_error_m2", row%error%rock_fluid)
         call table%put("rock_outflow_error_m2", row%error%rock_outflow)
         call table%put("fracture_volume_error_m2", row%error%fracture_volume)
         call table%put("max_slip_error_m", row%error%max_slip)
         call table%put("max_opening_error_m", row%error%max_opening)
         call table%put("seismic_moment_error_nm", row%error%seismic_moment)
         call table%put("strain_energy_error_j", row%error%strain_energy)
         call table%put("injection_rate_error_m2_s", row%error%injection_rate)
         call table%put("injectivity_error_m2_s_pa", row%error%injectivity)
         call table%put("stimulated_length_error_m", row%error%stimulated_length)
         call table%put("connected_length_error_m", row%error%connected_length)
         call table%put("connected_stimulated_error_m", row%error%connected_stimulated)
         call table%put("max_slip_rate_error_m_s", row%error%max_slip_rate)
         call table%put("unknowns", row%n_unknowns)
         call table%put("heat_stored_j", row%heat%stored)
         call table%put("heat_by_wells_j", row%heat%by_wells)
         call table%put("heat_by_sides_j", row%heat%by_sides)
         call table%put("heat_error_relative", row%heat%error)
         call table%end_row()
      end associate
   end subroutine history_row

   !> Add a tip.
   subroutine tip_row(self, row)
      class(tables_t), intent(inout) :: self
      type(tip_row_t), intent(in) :: row

      associate (table => self%all(tips), k => row%intensity)
         call table%put("time_s", row%time)
         call table%put("load_factor", row%time)
         call table%put("tip", row%tip)
         call table%put("fracture", row%fracture)
         call table%put("x_m", row%xy(1))
         call table%put("y_m", row%xy(2))
         call table%put("k1_pa_sqrtm", k%k1)
         call table%put("k2_pa_sqrtm", k%k2)
         call table%put("k1_dc_pa_sqrtm", k%k1_dc)
         call table%put("k2_dc_pa_sqrtm", k%k2_dc)
         call table%put("keq_pa_sqrtm", row%keq)
         call table%put("g_j_m2", row%g)
         call table%put("angle_deg", row%angle*degrees)
         call table%put("advance_m", row%advance)
         call table%put("k1_error_pa_sqrtm", k%k1_error)
         call table%put("k2_error_pa_sqrtm", k%k2_error)
         call table%put("g_ahead_j_m2", k%g_domain)
         call table%put("g_ahead_error_j_m2", k%g_error)
         call table%put("k1_dc_error_pa_sqrtm", k%k1_dc_error)
         call table%put("k2_dc_error_pa_sqrtm", k%k2_dc_error)
         call table%put("k1_corrected_pa_sqrtm", k%k1_corrected)
         call table%put("k2_corrected_pa_sqrtm", k%k2_corrected)
         call table%put("apparent_toughness_pa_sqrtm", row%apparent_toughness)
         call table%put("history_row", self%history_rows())
         call table%put("keq_error_pa_sqrtm", row%error%keq)
         call table%put("g_error_j_m2", row%error%g)
         call table%put("angle_error_deg", row%error%angle*degrees)
         call table%put("position_error_m", row%error%position)
         call table%end_row()
      end associate
   end subroutine tip_row

   !> Add every fracture cell.
   subroutine fracture_rows(self, time, mesh, fields)
      class(tables_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s], or the load factor
      type(fracture_mesh_t), intent(in) :: mesh
      type(fracture_fields_t), intent(in) :: fields
      character(len=:), allocatable :: state
      real(rk) :: centre(2)
      integer(ik) :: cell

      state = ""
      associate (table => self%all(fractures), error => fields%error)
         do cell = 1, mesh%n_cells
            centre = fracture_cell_centre(mesh, cell)
            call table%put("time_s", time)
            call table%put("load_factor", time)
            call table%put("fracture", mesh%cell_fracture(cell))
            call table%put("s_m", 0.5_rk*sum(mesh%cell_s(:, cell)))
            call table%put("x_m", centre(1))
            call table%put("y_m", centre(2))
            call put_if_there(table, "aperture_m", fields%aperture, cell)
            call put_if_there(table, "jump_n_m", fields%jump_n, cell)
            call put_if_there(table, "jump_t_m", fields%jump_t, cell)
            call put_if_there(table, "traction_n_pa", fields%traction_n, cell)
            call put_if_there(table, "traction_t_pa", fields%traction_t, cell)
            call put_if_there(table, "pressure_pa", fields%pressure, cell)
            call put_if_there(table, "void_m", fields%void, cell)
            call put_if_there(table, "flow_m2_s", fields%flow, cell)
            if (allocated(fields%state)) state = state_name(fields%state(cell))
            call table%put("state", state)
            call table%put("history_row", self%history_rows())
            if (allocated(fields%aperture)) then
               call put_if_there(table, "aperture_error_m", error%jump_n, cell)
            else
               call table%put("aperture_error_m")
            end if
            call put_if_there(table, "jump_n_error_m", error%jump_n, cell)
            call put_if_there(table, "jump_t_error_m", error%jump_t, cell)
            call put_if_there(table, "traction_n_error_pa", error%traction_n, cell)
            call put_if_there(table, "traction_t_error_pa", error%traction_t, cell)
            call put_if_there(table, "pressure_error_pa", error%pressure, cell)
            call put_if_there(table, "flow_error_m2_s", error%flow, cell)
            call put_if_there(table, "temperature_k", fields%temperature, cell)
            call put_if_there(table, "temperature_error_k", error%temperature, cell)
            call table%end_row()
         end do
      end associate
   end subroutine fracture_rows

   !> Add the state at all probes.
   subroutine probe_row(self, time, row)
      class(tables_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s], or the load factor
      type(probe_row_t), intent(in) :: row
      integer(ik) :: i

      associate (table => self%all(probes))
         call table%put("time_s", time)
         call table%put("load_factor", time)
         do i = 1, size(row%displacement, 2, kind=ik)
            associate (name => self%probe_names(i)%text)
               call put_if_there(table, name//"_p_pa", row%pressure, i)
               call table%put(name//"_ux_m", row%displacement(1, i))
               call table%put(name//"_uy_m", row%displacement(2, i))
               call table%put(name//"_sxx_pa", row%stress(1, i))
               call table%put(name//"_syy_pa", row%stress(2, i))
               call table%put(name//"_sxy_pa", row%stress(3, i))
               call put_if_there(table, name//"_p_error_pa", row%pressure_error, i)
               call put_if_there(table, name//"_u_error_m", row%displacement_error, i)
               call put_if_there(table, name//"_s_error_pa", row%stress_error, i)
            end associate
         end do
         call table%end_row()
      end associate
   end subroutine probe_row

   !> Add an event. Values that do not apply are empty.
   subroutine event_row(self, event)
      class(tables_t), intent(inout) :: self
      type(event_t), intent(in) :: event

      associate (table => self%all(events))
         call table%put("time_s", event%time)
         call table%put("load_factor", event%time)
         call table%put("kind", event%kind)
         if (event%has_place) then
            call table%put("fracture", event%fracture)
            call table%put("x_m", event%xy(1))
            call table%put("y_m", event%xy(2))
         else
            call table%put("fracture")
            call table%put("x_m")
            call table%put("y_m")
         end if
         call table%put("detail", event%detail)
         call table%end_row()
      end associate
   end subroutine event_row

   !> Add a slip event that has ended.
   subroutine slip_event_row(self, event)
      class(tables_t), intent(inout) :: self
      type(slip_event_t), intent(in) :: event

      associate (table => self%all(slip_events))
         call table%put("event", event%number)
         call table%put("time_s", event%time)
         call table%put("end_s", event%end)
         call table%put("fracture", event%fracture)
         call table%put("x_m", event%xy(1))
         call table%put("y_m", event%xy(2))
         call table%put("s_from_m", event%s(1))
         call table%put("s_to_m", event%s(2))
         call table%put("area_m2", event%area)
         call table%put("mean_slip_m", event%mean_slip)
         call table%put("moment_nm", event%moment)
         call table%put("largest_moment_rate_nm_s", event%largest_rate)
         call table%put("magnitude", event%magnitude)
         call table%put("open_share", event%open_share)
         call table%put("sudden_share", event%sudden_share)
         call table%put("ended_by", trim(event%ended_by))
         call table%put("kind", trim(merge("seismic ", "aseismic", event%is_seismic)))
         call table%put("duration_s", event%end - event%time)
         call table%put("x_onset_m", event%onset_xy(1))
         call table%put("y_onset_m", event%onset_xy(2))
         call table%put("largest_slip_rate_m_s", event%largest_slip_rate)
         call table%put("mean_slip_rate_m_s", event%mean_slip_rate)
         call table%put("stress_drop_pa", event%stress_drop)
         call table%put("time_error_s", event%error%time)
         call table%put("place_error_m", event%error%place)
         call table%put("area_error_m2", event%error%area)
         call table%put("mean_slip_error_m", event%error%mean_slip)
         call table%put("moment_error_nm", event%error%moment)
         call table%put("magnitude_error", event%error%magnitude)
         call table%put("mean_slip_rate_error_m_s", event%error%mean_slip_rate)
         call table%put("stress_drop_error_pa", event%error%stress_drop)
         call table%end_row()
      end associate
   end subroutine slip_event_row

   !> Add a well after a step.
   subroutine well_row(self, row)
      class(tables_t), intent(inout) :: self
      type(well_row_t), intent(in) :: row

      associate (table => self%all(wells))
         call table%put("time_s", row%time)
         call table%put("well", row%name)
         call table%put("stage", row%stage)
         call table%put("control", row%control)
         call table%put("rate_m2_s", row%rate)
         call table%put("flow_m2_s", row%flow)
         call table%put("pressure_pa", row%pressure)
         call table%put("head_pressure_pa", row%head_pressure)
         call table%put("injected_m2", row%injected)
         call table%put("injectivity_m2_s_pa", row%injectivity)
         call table%put("asked_m2_s", row%asked)
         call table%put("rate_error_m2_s", row%error%rate)
         call table%put("flow_error_m2_s", row%error%flow)
         call table%put("pressure_error_pa", row%error%pressure)
         call table%put("head_pressure_error_pa", row%error%head_pressure)
         call table%put("injected_error_m2", row%error%injected)
         call table%put("injectivity_error_m2_s_pa", row%error%injectivity)
         call table%put("temperature_k", row%temperature)
         call table%put("temperature_error_k", row%error%temperature)
         call table%end_row()
      end associate
   end subroutine well_row

   !> Add an entry of a well after a step.
   subroutine entry_row(self, row)
      class(tables_t), intent(inout) :: self
      type(entry_row_t), intent(in) :: row

      associate (table => self%all(entries))
         call table%put("time_s", row%time)
         call table%put("well", row%name)
         call table%put("entry", row%entry)
         call table%put("fracture", row%fracture)
         call table%put("flow_m2_s", row%flow)
         call table%put("share", row%share)
         call table%put("pressure_pa", row%pressure)
         call table%put("flow_error_m2_s", row%error%flow)
         call table%put("share_error", row%error%share)
         call table%put("pressure_error_pa", row%error%pressure)
         call table%end_row()
      end associate
   end subroutine entry_row

   !> Write all tables that have changed, also after a failure of one; the error is the first.
   subroutine flush_tables(self, error)
      class(tables_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      type(error_t), allocatable :: trouble
      integer :: i

      if (.not. allocated(self%all)) return
      do i = 1, size(self%all)
         call self%all(i)%flush(trouble)
         call keep_first(trouble, error)
      end do
   end subroutine flush_tables

   !> Open history.csv, with a column of the pressure for each of several wells.
   subroutine open_history(self, path, scene)
      class(tables_t), intent(inout) :: self
      character(len=*), intent(in) :: path
      type(scene_t), intent(in) :: scene
      character(len=*), parameter :: behind = "_well_pressure_pa"
      character(len=column_length), allocatable :: names(:)
      logical, allocatable :: is_written(:)
      integer :: at, w

      allocate (self%pressure_names(well_count(scene)))
      at = findloc(history_columns%name, "NAME"//behind, dim=1)
      names = history_columns(:at - 1)%name
      do w = 1, size(self%pressure_names)
         self%pressure_names(w)%text = trim(scene%injections(w)%name)//behind
         names = [character(len=column_length) :: names, self%pressure_names(w)%text]
      end do
      is_written = applies(history_columns, scene)
      is_written = [is_written(:at - 1), spread(is_written(at), 1, size(self%pressure_names)), &
                    is_written(at + 1:)]
      call self%all(history)%open(path, [character(len=column_length) :: names, &
                                         history_columns(at + 1:)%name], is_written)
   end subroutine open_history

   !> Open probes.csv: the time or load factor, then the same columns for each probe.
   subroutine open_probes(self, path, scene)
      class(tables_t), intent(inout) :: self
      character(len=*), intent(in) :: path
      type(scene_t), intent(in) :: scene
      integer, parameter :: n_common = 2, n_each = size(probe_columns) - n_common
      character(len=column_length) :: names(n_common + n_each*size(scene%probes))
      integer :: i, k

      allocate (self%probe_names(size(scene%probes)))
      names(:n_common) = probe_columns(:n_common)%name
      do i = 1, size(scene%probes)
         self%probe_names(i)%text = trim(scene%probes(i)%name)
         do k = 1, n_each
            names(n_common + n_each*(i - 1) + k) = self%probe_names(i)%text// &
               & probe_columns(n_common + k)%name(len("NAME") + 1:)
         end do
      end do
      call self%all(probes)%open(path, names, [applies(probe_columns(:n_common), scene), &
         & (applies(probe_columns(n_common + 1:), scene), i=1, size(scene%probes))])
   end subroutine open_probes

   !> Put the value of a cell or a probe, or an empty value without the field.
   subroutine put_if_there(table, name, values, i)
      type(series_t), intent(inout) :: table
      character(len=*), intent(in) :: name  !< of the column
      real(rk), allocatable, intent(in) :: values(:)  !< in the unit of the name
      integer(ik), intent(in) :: i  !< cell or probe

      if (allocated(values)) then
         call table%put(name, values(i))
      else
         call table%put(name)
      end if
   end subroutine put_if_there

   !> Go on with the rows of the tables of a scene with other wells or growth.
   subroutine take_over(self, other)
      class(tables_t), intent(inout) :: self
      type(tables_t), intent(in) :: other
      integer :: i

      do i = 1, size(self%all)
         call self%all(i)%take_over(other%all(i))
      end do
   end subroutine take_over

   !> Rows of history.csv so far.
   pure integer(ik) function history_rows(self)
      class(tables_t), intent(in) :: self

      history_rows = int(self%all(history)%n_rows, ik)
   end function history_rows

   !> Store or load the tables.
   subroutine visit(self, archive)
      class(tables_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive
      integer :: i

      do i = 1, size(self%all)
         call self%all(i)%visit(archive)
      end do
   end subroutine visit

   !> Store or load their texts.
   subroutine visit_text(self, archive)
      class(tables_t), intent(inout) :: self
      type(archive_t), intent(inout) :: archive
      integer :: i

      do i = 1, size(self%all)
         call self%all(i)%visit_text(archive)
      end do
   end subroutine visit_text

end module report_tables
