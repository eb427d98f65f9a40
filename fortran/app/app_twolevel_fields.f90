!> The state of a scene with fluid as files show it: its row of the history, fields, probes.
module app_twolevel_fields
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use contact_states, only: state_open, state_slip, state_stick
   use mesh_builder, only: locate
   use results_fields, only: fracture_fields_t, matrix_fields_t
   use results_rows, only: history_row_t
   use output_record, only: run_record_t
   use tips_network, only: total_length
   use twolevel_simulation, only: simulation_t
   implicit none(type, external)
   private

   public :: add_slip_moment, cell_state, cell_states, count_unknowns, fields_of, history_of
   public :: probe_values

contains

   !> One state for a cell from those of its two ends: open or stick where both are, else slip.
   pure function cell_state(ends) result(state)
      integer(ik), intent(in) :: ends(2)
      integer(ik) :: state

      state = merge(ends(1), state_slip, ends(1) == ends(2))
   end function cell_state

   !> The contact states of all fracture cells.
   pure function cell_states(simulation) result(states)
      type(simulation_t), intent(in) :: simulation
      integer(ik) :: states(simulation%mesh%fracture%n_cells)
      integer(ik) :: i

      states = [(cell_state(simulation%state%contact(:, i)), i=1, size(states))]
   end function cell_states

   !> The row of history.csv; the caller adds what concerns the step.
   function history_of(simulation, mass_error) result(row)
      type(simulation_t), intent(in) :: simulation
      real(rk), intent(in) :: mass_error  !< of all steps so far [m2]
      type(history_row_t) :: row
      real(rk) :: fluid  ! that the mass error is compared with [m2]
      integer(ik), allocatable :: states(:)
      logical, allocatable :: is_well(:)

      associate (state => simulation%state)
         row%time = state%time
         row%injected = simulation%injected
         row%leakoff = simulation%leaked
         row%prefilled = simulation%prefilled
         row%fracture_length = total_length(simulation%tips%network)
         row%n_tips = size(simulation%tips%tip)
         if (simulation%mesh%fracture%n_cells > 0) then
            is_well = sum(simulation%share, dim=2) > 0.0_rk
            if (any(is_well)) row%well_pressure = sum(state%pressure, mask=is_well)/count(is_well)
            row%fracture_volume = sum(state%aperture*simulation%model%condensed%length)
            row%max_slip = maxval(abs(state%jump(2, :, :)))
            row%max_opening = maxval(state%jump(1, :, :))
            states = cell_states(simulation)
            row%n_stick = count(states == state_stick)
            row%n_slip = count(states == state_slip)
            row%n_open = count(states == state_open)
         end if
         fluid = max(abs(simulation%injected), row%fracture_volume)
         if (.not. fluid > 0.0_rk) fluid = max(sum(abs(state%content)), tiny(1.0_rk))
         row%mass_error_relative = abs(mass_error)/fluid
      end associate
   end function history_of

   !> Add the seismic moment of the slip since a state before.
   subroutine add_slip_moment(simulation, slip_before, moment)
      type(simulation_t), intent(in) :: simulation
      real(rk), intent(in) :: slip_before(:, :)  !< (2, fracture cells) [u]_tau [m]
      real(rk), intent(inout) :: moment  !< per metre of thickness [N m]
      integer(ik) :: i

      do i = 1, simulation%mesh%fracture%n_cells
         moment = moment + simulation%model%rock%shear*0.5_rk &
                  *simulation%model%condensed%length(i) &
                  *sum(abs(simulation%state%jump(2, :, i) - slip_before(:, i)))
      end do
   end subroutine add_slip_moment

   !> Displacement and pressure at the probes, and in which cells they lie.
   subroutine probe_values(simulation, values, cells, error)
      type(simulation_t), intent(inout) :: simulation
      real(rk), allocatable, intent(out) :: values(:, :)  !< (3, probes) [m], [Pa]
      integer(ik), allocatable, intent(out) :: cells(:)  !< (probes)
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: xy(:, :)
      integer(ik) :: i, n

      n = size(simulation%scene%probes)
      allocate (xy(2, n), values(3, n), cells(n))
      xy(1, :) = simulation%scene%probes%x
      xy(2, :) = simulation%scene%probes%y
      call locate(simulation%mesher, xy, cells, error)
      if (allocated(error)) return
      call simulation%update_level()
      do i = 1, n
         associate (nodes => simulation%mesh%cell_nodes(:, cells(i)))
            values(:, i) = matmul(simulation%level%nodal(:, nodes), &
                                  corner_weights(simulation%mesh%xy(:, nodes), xy(:, i)))
         end associate
      end do
   end subroutine probe_values

   !> Barycentric coordinates.
   pure function corner_weights(corners, point) result(weight)
      real(rk), intent(in) :: corners(:, :), point(:)
      real(rk) :: weight(3)
      integer :: i

      do i = 1, 3
         associate (a => corners(:, mod(i, 3) + 1) - point, &
                    b => corners(:, mod(i + 1, 3) + 1) - point)
            weight(i) = a(1)*b(2) - a(2)*b(1)
         end associate
      end do
      weight = weight/sum(weight)
   end function corner_weights

   !> Displacement and pressure, and what the fracture faces do; stress is left to the caller.
   subroutine fields_of(simulation, matrix, fracture)
      type(simulation_t), intent(in) :: simulation
      type(matrix_fields_t), intent(out) :: matrix
      type(fracture_fields_t), intent(out) :: fracture

      associate (state => simulation%state, n => simulation%mesh%n_cells)
         matrix%displacement = state%unknowns(:2, :n)
         matrix%pressure = state%unknowns(3, :n)
         fracture%aperture = state%aperture
         fracture%jump_n = 0.5_rk*sum(state%jump(1, :, :), dim=1)
         fracture%jump_t = 0.5_rk*sum(state%jump(2, :, :), dim=1)
         fracture%traction_n = 0.5_rk*sum(state%traction(1, :, :), dim=1)
         fracture%traction_t = 0.5_rk*sum(state%traction(2, :, :), dim=1)
         fracture%pressure = state%pressure
         fracture%state = cell_states(simulation)
      end associate
   end subroutine fields_of

   !> Unknowns by block, for run.json.
   subroutine count_unknowns(simulation, record)
      type(simulation_t), intent(in) :: simulation
      type(run_record_t), intent(inout) :: record
      integer(ik) :: i, n_fine

      associate (mesh => simulation%mesh)
         call record%count_dofs("displacement", 2*mesh%n_cells)
         call record%count_dofs("matrix_pressure", mesh%n_cells)
         call record%count_dofs("fracture_jump", 4*mesh%fracture%n_cells)
         call record%count_dofs("fracture_face_pressure", 2*mesh%fracture%n_cells)
         call record%count_dofs("fracture_pressure", mesh%fracture%n_cells)
         call record%count_dofs("fracture_flow", size(simulation%model%connections, 2))
      end associate
      n_fine = 0
      do i = 1, size(simulation%tips%window)
         if (simulation%tips%built(i)) n_fine = n_fine &
                                                + simulation%tips%window(i)%model%constraints%n_dofs
      end do
      call record%count_dofs("windows", n_fine)
   end subroutine count_unknowns

end module app_twolevel_fields
