!> The CSV tables of a run: their columns and what goes into them.
module output_tables
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use contact_states, only: state_name
   use mesh_types, only: fracture_mesh_t
   use results_fields, only: fracture_fields_t
   use results_rows, only: history_row_t, tip_row_t
   use output_series, only: series_t
   use scene_types, only: name_length, scene_t
   implicit none(type, external)
   private

   public :: tables_t

   integer, parameter :: column_length = name_length + 8
   real(rk), parameter :: degrees = 180.0_rk/acos(-1.0_rk)  !< per radian

   !> The tables; those that the scene has nothing for stay closed.
   type :: tables_t
      type(series_t) :: history
      type(series_t) :: tips
      type(series_t) :: fractures
      type(series_t) :: probes
      type(series_t) :: events
      logical, private :: has_fluid = .true.
   contains
      procedure :: open => open_tables
      procedure :: history_row
      procedure :: tip_row
      procedure :: fracture_rows
      procedure :: probe_row
      procedure :: event_row
      procedure :: flush => flush_tables
   end type tables_t

contains

   !> Open the tables of a scene.
   subroutine open_tables(self, directory, scene, has_fluid)
      class(tables_t), intent(out) :: self
      character(len=*), intent(in) :: directory
      type(scene_t), intent(in) :: scene
      logical, intent(in) :: has_fluid  !< else there are no columns for pressure and fluid

      self%has_fluid = has_fluid
      call open_history(self%history, directory, has_fluid)
      call self%events%open(directory//"/events.csv", [character(len=column_length) :: "time_s", &
         & "kind", "fracture", "x_m", "y_m", "detail"])
      if (allocated(scene%fractures)) then
         if (size(scene%fractures) > 0) call open_fractures(self%fractures, directory, has_fluid)
      end if
      if (scene%growth%enabled .or. scene%growth%intensities) then
         call self%tips%open(directory//"/tips.csv", [character(len=column_length) :: "time_s", &
            & "tip", "fracture", "x_m", "y_m", "k1_pa_sqrtm", "k2_pa_sqrtm", "k1_dc_pa_sqrtm", &
            & "k2_dc_pa_sqrtm", "keq_pa_sqrtm", "g_j_m2", "angle_deg", "advance_m", &
            & "k1_error_pa_sqrtm", "k2_error_pa_sqrtm", "g_ahead_j_m2", &
            & "g_ahead_error_j_m2", "k1_dc_error_pa_sqrtm", "k2_dc_error_pa_sqrtm", &
            & "k1_corrected_pa_sqrtm", "k2_corrected_pa_sqrtm"])
      end if
      if (allocated(scene%probes)) then
         if (size(scene%probes) > 0) call open_probes(self%probes, directory, scene, has_fluid)
      end if
   end subroutine open_tables

   !> Add an accepted step.
   subroutine history_row(self, row)
      class(tables_t), intent(inout) :: self
      type(history_row_t), intent(in) :: row

      associate (table => self%history)
         call table%put(row%time)
         call table%put(row%dt)
         call table%put(row%newton_iterations)
         if (self%has_fluid) then
            call table%put(row%well_pressure)
            call table%put(row%injected)
            call table%put(row%leakoff)
            call table%put(row%prefilled)
         end if
         call table%put(row%fracture_volume)
         if (self%has_fluid) call table%put(row%mass_error_relative)
         call table%put(row%max_slip)
         call table%put(row%max_opening)
         call table%put(row%n_stick)
         call table%put(row%n_slip)
         call table%put(row%n_open)
         call table%put(row%fracture_length)
         call table%put(row%n_tips)
         call table%put(row%n_intersections)
         call table%put(row%seismic_moment)
         if (.not. self%has_fluid) then
            call table%put(row%load_factor)
            call table%put(row%strain_energy)
         end if
         call table%end_row()
      end associate
   end subroutine history_row

   !> Add a tip.
   subroutine tip_row(self, row)
      class(tables_t), intent(inout) :: self
      type(tip_row_t), intent(in) :: row

      if (.not. self%tips%is_open()) return
      associate (table => self%tips)
         call table%put(row%time)
         call table%put(row%tip)
         call table%put(row%fracture)
         call table%put(row%xy(1))
         call table%put(row%xy(2))
         call table%put(row%k1)
         call table%put(row%k2)
         call table%put(row%k1_dc)
         call table%put(row%k2_dc)
         call table%put(row%keq)
         call table%put(row%g)
         call table%put(row%angle*degrees)
         call table%put(row%advance)
         call table%put(row%k1_error)
         call table%put(row%k2_error)
         call table%put(row%g_domain)
         call table%put(row%g_error)
         call table%put(row%k1_dc_error)
         call table%put(row%k2_dc_error)
         call table%put(row%k1_corrected)
         call table%put(row%k2_corrected)
         call table%end_row()
      end associate
   end subroutine tip_row

   !> Add every fracture cell.
   subroutine fracture_rows(self, time, mesh, fields)
      class(tables_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      type(fracture_mesh_t), intent(in) :: mesh
      type(fracture_fields_t), intent(in) :: fields
      real(rk) :: centre(2)
      integer(ik) :: cell

      if (.not. self%fractures%is_open()) return
      associate (table => self%fractures)
         do cell = 1, mesh%n_cells
            centre = 0.5_rk*(mesh%point_xy(:, mesh%cell_points(1, cell)) &
               & + mesh%point_xy(:, mesh%cell_points(2, cell)))
            call table%put(time)
            call table%put(mesh%cell_fracture(cell))
            call table%put(0.5_rk*sum(mesh%cell_s(:, cell)))
            call table%put(centre(1))
            call table%put(centre(2))
            call put_if_there(table, fields%aperture, cell)
            call put_if_there(table, fields%jump_n, cell)
            call put_if_there(table, fields%jump_t, cell)
            call put_if_there(table, fields%traction_n, cell)
            call put_if_there(table, fields%traction_t, cell)
            if (self%has_fluid) call put_if_there(table, fields%pressure, cell)
            if (allocated(fields%state)) then
               call table%put(state_name(fields%state(cell)))
            else
               call table%put_nothing()
            end if
            call table%end_row()
         end do
      end associate
   end subroutine fracture_rows

   !> Add the state at all probes.
   subroutine probe_row(self, time, displacement, stress, pressure)
      class(tables_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_probes) [m]
      real(rk), intent(in) :: stress(:, :)  !< (3, n_probes) total: xx, yy, xy [Pa]
      real(rk), intent(in), optional :: pressure(:)  !< (n_probes) [Pa]; needed in a run with fluid
      integer :: i, k

      if (.not. self%probes%is_open()) return
      associate (table => self%probes)
         call table%put(time)
         do i = 1, size(displacement, 2)
            if (present(pressure)) call table%put(pressure(i))
            do k = 1, 2
               call table%put(displacement(k, i))
            end do
            do k = 1, 3
               call table%put(stress(k, i))
            end do
         end do
         call table%end_row()
      end associate
   end subroutine probe_row

   !> Add an event. What does not apply to it is left empty.
   subroutine event_row(self, time, kind, detail, fracture, xy)
      class(tables_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      character(len=*), intent(in) :: kind  !< event_slip_onset .. event_remesh
      character(len=*), intent(in) :: detail  !< a few words with numbers and units
      integer(ik), intent(in), optional :: fracture
      real(rk), intent(in), optional :: xy(2)  !< [m]

      associate (table => self%events)
         call table%put(time)
         call table%put(kind)
         if (present(fracture)) then
            call table%put(fracture)
         else
            call table%put_nothing()
         end if
         if (present(xy)) then
            call table%put(xy(1))
            call table%put(xy(2))
         else
            call table%put_nothing()
            call table%put_nothing()
         end if
         call table%put(detail)
         call table%end_row()
      end associate
   end subroutine event_row

   !> Write all tables that have changed.
   subroutine flush_tables(self, error)
      class(tables_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      call self%history%flush(error)
      if (.not. allocated(error)) call self%tips%flush(error)
      if (.not. allocated(error)) call self%fractures%flush(error)
      if (.not. allocated(error)) call self%probes%flush(error)
      if (.not. allocated(error)) call self%events%flush(error)
   end subroutine flush_tables

   subroutine open_history(table, directory, has_fluid)
      type(series_t), intent(out) :: table
      character(len=*), intent(in) :: directory
      logical, intent(in) :: has_fluid
      character(len=column_length), allocatable :: columns(:)

      columns = [character(len=column_length) :: "time_s", "dt_s", "newton_iterations"]
      if (has_fluid) columns = [character(len=column_length) :: columns, "well_pressure_pa", &
         & "injected_m2", "leakoff_m2", "prefilled_m2"]
      columns = [character(len=column_length) :: columns, "fracture_volume_m2"]
      if (has_fluid) columns = [character(len=column_length) :: columns, "mass_error_relative"]
      columns = [character(len=column_length) :: columns, "max_slip_m", "max_opening_m", &
         & "n_stick", "n_slip", "n_open", "fracture_length_m", "n_tips", "n_intersections", &
         & "seismic_moment_nm"]
      if (.not. has_fluid) columns = [character(len=column_length) :: columns, "load_factor", &
         & "strain_energy_j"]
      call table%open(directory//"/history.csv", columns)
   end subroutine open_history

   subroutine open_fractures(table, directory, has_fluid)
      type(series_t), intent(out) :: table
      character(len=*), intent(in) :: directory
      logical, intent(in) :: has_fluid
      character(len=column_length), allocatable :: columns(:)

      columns = [character(len=column_length) :: "time_s", "fracture", "s_m", "x_m", "y_m", &
         & "aperture_m", "jump_n_m", "jump_t_m", "traction_n_pa", "traction_t_pa"]
      if (has_fluid) columns = [character(len=column_length) :: columns, "pressure_pa"]
      columns = [character(len=column_length) :: columns, "state"]
      call table%open(directory//"/fractures.csv", columns)
   end subroutine open_fractures

   subroutine open_probes(table, directory, scene, has_fluid)
      type(series_t), intent(out) :: table
      character(len=*), intent(in) :: directory
      type(scene_t), intent(in) :: scene
      logical, intent(in) :: has_fluid
      character(len=column_length), allocatable :: columns(:)
      character(len=:), allocatable :: name
      integer :: i

      columns = [character(len=column_length) :: "time_s"]
      do i = 1, size(scene%probes)
         name = trim(scene%probes(i)%name)
         if (has_fluid) columns = [character(len=column_length) :: columns, name//"_p_pa"]
         columns = [character(len=column_length) :: columns, name//"_ux_m", name//"_uy_m", &
            & name//"_sxx_pa", name//"_syy_pa", name//"_sxy_pa"]
      end do
      call table%open(directory//"/probes.csv", columns)
   end subroutine open_probes

   !> A cell's value, or nothing where the field is left out.
   subroutine put_if_there(table, values, cell)
      type(series_t), intent(inout) :: table
      real(rk), allocatable, intent(in) :: values(:)
      integer(ik), intent(in) :: cell

      if (allocated(values)) then
         call table%put(values(cell))
      else
         call table%put_nothing()
      end if
   end subroutine put_if_there

end module output_tables
