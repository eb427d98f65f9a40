!> The state of a mechanics-only scene as files show it: its row of the history, fields, probes.
module app_mechanics_fields
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use contact_states, only: state_open, state_slip, state_stick
   use mechanics_fields, only: cell_displacement, cell_stress, fracture_jump, fracture_traction, &
                               point_state
   use mechanics_simulation, only: simulation_t
   use mesh_builder, only: locate
   use mesh_types, only: mesh_t, point_boundary, point_interior, point_tip
   use results_fields, only: fracture_fields_t, matrix_fields_t
   use results_rows, only: history_row_t
   use scene_types, only: fracture_t
   use tips_network, only: total_length
   implicit none(type, external)
   private

   public :: body_fields_t, fields_of, history_of, probe_values, touches

   !> Fields with the mesh that they live on.
   type :: body_fields_t
      real(rk) :: time = 0.0_rk  !< [s]
      type(mesh_t) :: mesh
      type(matrix_fields_t) :: matrix
      type(fracture_fields_t) :: fracture
   end type body_fields_t

contains

   !> The row of history.csv; its dt is left to the caller.
   function history_of(simulation) result(row)
      type(simulation_t), intent(in) :: simulation
      type(history_row_t) :: row
      real(rk), allocatable :: jump(:, :)
      integer(ik) :: i

      associate (body => simulation%body, fracture => simulation%body%mesh%fracture)
         row%time = simulation%time()
         row%load_factor = simulation%factor
         row%strain_energy = body%model%strain_energy(body%displacement)
         row%fracture_length = total_length(simulation%network)
         row%seismic_moment = simulation%seismic_moment()
         row%n_tips = fracture%n_tips
         row%n_intersections = count([(all(fracture%point_kind(i) /= &
                                           [point_interior, point_tip, point_boundary]), &
                                       i=1, fracture%n_points)])
         if (fracture%n_cells == 0) return
         jump = fracture_jump(body)
         row%max_opening = maxval(jump(1, :))
         row%max_slip = maxval(abs(jump(2, :)))
         row%fracture_volume = sum(jump(1, :)*body%model%mesh%face_length)
         associate (state => body%contact%state(3, :))
            row%n_stick = count(state == state_stick)
            row%n_slip = count(state == state_slip)
            row%n_open = count(state == state_open)
         end associate
         row%newton_iterations = body%contact%iterations
      end associate
   end function history_of

   !> Whether the faces of a fracture can touch; else they are open from the start.
   elemental logical function touches(fracture)
      type(fracture_t), intent(in) :: fracture

      touches = fracture%law /= "open"
   end function touches

   !> Displacement, stress, and what the fracture faces do.
   function fields_of(simulation) result(fields)
      type(simulation_t), intent(in) :: simulation
      type(body_fields_t) :: fields
      real(rk), allocatable :: pairs(:, :)

      associate (body => simulation%body, matrix => fields%matrix, fracture => fields%fracture)
         fields%time = simulation%time()
         fields%mesh = body%mesh
         matrix%displacement = cell_displacement(body)
         matrix%node_xy = body%model%mesh%xy
         matrix%cell_nodes = body%model%mesh%cell_nodes
         matrix%node_displacement = body%displacement
         matrix%stress = cell_stress(body)
         pairs = fracture_jump(body)
         fracture%jump_n = pairs(1, :)
         fracture%jump_t = pairs(2, :)
         pairs = fracture_traction(body)
         fracture%traction_n = pairs(1, :)
         fracture%traction_t = pairs(2, :)
         fracture%state = body%contact%state(3, :)
      end associate
   end function fields_of

   !> Displacement and stress at the probes.
   subroutine probe_values(simulation, displacement, stress, error)
      type(simulation_t), intent(in) :: simulation
      real(rk), allocatable, intent(out) :: displacement(:, :)  !< (2, probes) [m]
      real(rk), allocatable, intent(out) :: stress(:, :)  !< (3, probes) xx, yy, xy [Pa]
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: xy(:, :)
      integer(ik), allocatable :: cells(:)
      integer(ik) :: i, n

      n = size(simulation%scene%probes)
      allocate (xy(2, n), displacement(2, n), stress(3, n), cells(n))
      xy(1, :) = simulation%scene%probes%x
      xy(2, :) = simulation%scene%probes%y
      call locate(simulation%body%mesher, xy, cells, error)
      if (allocated(error)) return
      do i = 1, n
         call point_state(simulation%body, cells(i), xy(:, i), displacement(:, i), stress(:, i))
      end do
   end subroutine probe_values

end module app_mechanics_fields
