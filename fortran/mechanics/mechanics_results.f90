!> Output of the state of a loaded body: the row of the history, fields, probes; and the quantities
!! checked by the limits of a run without a fluid (report_limits).
module mechanics_results
   use base_errors, only: error_t
   use base_kinds, only: degrees, ik, rk
   use base_number, only: brief_text
   use contact_law, only: state_open, state_slip, state_stick
   use growth_network, only: total_length
   use mechanics_errors, only: find_fracture_errors, find_point_errors, find_rock_errors, note_row
   use mechanics_fields, only: cell_displacement, cell_stress, fracture_jump, fracture_traction, &
                               point_state
   use mechanics_state, only: loaded_body_t
   use mesh_builder, only: locate
   use mesh_geometry, only: fracture_cell_centre
   use mesh_types, only: point_boundary, point_interior, point_tip
   use report_limits, only: limit_angle, limit_contact, limit_jump, limit_strain
   use report_rows, only: fracture_fields_t, history_row_t, probe_row_t
   use report_simulation, only: snapshot_t
   use report_watch, only: worst_place
   use scene_types, only: fracture_t
   implicit none(type, external)
   private

   public :: body_snapshot, history_of_body, probes_of_body, touches, watch_body

contains

   !> The row of history.csv.
   function history_of_body(simulation) result(row)
      class(loaded_body_t), intent(in) :: simulation
      type(history_row_t) :: row
      type(fracture_fields_t) :: fields
      integer(ik) :: i

      associate (body => simulation%body, fracture => simulation%body%mesh%fracture)
         row%time = simulation%time()
         row%strain_energy = body%model%strain_energy(body%displacement)
         row%fracture_length = total_length(simulation%network)
         row%seismic_moment = simulation%seismic_moment()
         row%n_unknowns = body%model%constraints%n_dofs
         row%n_tips = fracture%n_tips
         row%n_intersections = count([(all(fracture%point_kind(i) /= &
                                           [point_interior, point_tip, point_boundary]), &
                                       i=1, fracture%n_points)])
         if (fracture%n_cells == 0) return
         fields = fracture_fields(simulation)
         row%max_opening = maxval(fields%jump_n)
         row%max_slip = maxval(abs(fields%jump_t))
         row%fracture_volume = sum(fields%jump_n*body%model%mesh%face_length)
         associate (state => body%contact%state(3, :))
            row%n_stick = count(state == state_stick)
            row%n_slip = count(state == state_slip)
            row%n_open = count(state == state_open)
         end associate
         row%newton_iterations = body%contact%iterations
         call note_row(simulation%scene%material, body, fields, row)
      end associate
   end function history_of_body

   !> The faces of a fracture can touch; otherwise they are open from the start.
   elemental logical function touches(fracture)
      type(fracture_t), intent(in) :: fracture

      touches = fracture%law /= "open"
   end function touches

   !> Displacement, stress, and the jumps and tractions of the fracture faces.
   function body_snapshot(simulation) result(snapshot)
      class(loaded_body_t), intent(in) :: simulation
      type(snapshot_t) :: snapshot

      associate (body => simulation%body, matrix => snapshot%matrix)
         snapshot%time = simulation%time()
         snapshot%mesh = body%mesh
         matrix%displacement = cell_displacement(body)
         matrix%node_xy = body%model%mesh%xy
         matrix%cell_nodes = body%model%mesh%cell_nodes
         matrix%node_displacement = body%displacement
         matrix%stress = cell_stress(body)
         associate (rocks => body%model%rocks)
            if (size(rocks%of_cell) > 1) matrix%poisson = rocks%elasticity(rocks%of_cell)%poisson
         end associate
         snapshot%fracture = fracture_fields(simulation)
         if (simulation%scene%output%vtu) then
            call find_rock_errors(simulation%scene%material, body, matrix)
         end if
      end associate
   end function body_snapshot

   !> Jumps and tractions of the fracture faces, with their errors.
   function fracture_fields(simulation) result(fields)
      class(loaded_body_t), intent(in) :: simulation
      type(fracture_fields_t) :: fields
      real(rk), allocatable :: pairs(:, :)

      associate (body => simulation%body)
         pairs = fracture_jump(body)
         fields%jump_n = pairs(1, :)
         fields%jump_t = pairs(2, :)
         pairs = fracture_traction(body)
         fields%traction_n = pairs(1, :)
         fields%traction_t = pairs(2, :)
         fields%state = body%contact%state(3, :)
         if (size(fields%state) == 0) return
         associate (fractures => simulation%scene%fractures)
            call find_fracture_errors(simulation%scene%material, &
                                      fractures(body%mesh%fracture%cell_fracture)%friction, body, &
                                      fields)
         end associate
      end associate
   end function fracture_fields

   !> Displacement and stress at the probes.
   subroutine probes_of_body(simulation, row, error)
      class(loaded_body_t), intent(in) :: simulation
      type(probe_row_t), intent(out) :: row
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: xy(:, :)
      integer(ik), allocatable :: cells(:)
      integer(ik) :: i, n

      n = size(simulation%scene%probes)
      allocate (xy(2, n), row%displacement(2, n), row%stress(3, n), cells(n))
      allocate (row%displacement_error(n), row%stress_error(n))
      xy(1, :) = simulation%scene%probes%x
      xy(2, :) = simulation%scene%probes%y
      call locate(simulation%body%mesher, xy, cells, error)
      if (allocated(error)) return
      do i = 1, n
         call point_state(simulation%body, cells(i), xy(:, i), row%displacement(:, i), &
                          row%stress(:, i))
         call find_point_errors(simulation%scene%material, simulation%body, cells(i), xy(:, i), &
                                row%displacement_error(i), row%stress_error(i))
      end do
   end subroutine probes_of_body

   !> Check the limits of the run in a state of equilibrium, before it is accepted.
   subroutine watch_body(self)
      class(loaded_body_t), intent(inout) :: self
      character(len=:), allocatable :: when
      real(rk), allocatable :: jump(:, :), ratio(:), strain(:)
      integer(ik) :: i

      when = "load factor "//brief_text(self%factor, 6)
      associate (body => self%body, watch => self%watch, fracture => self%body%mesh%fracture)
         call watch%see(limit_contact, body%contact%residual, when)
         call watch%see(limit_angle, body%smallest_angle*degrees, when)
         strain = (maxval(body%displacement, dim=2) - minval(body%displacement, dim=2)) &
                  /(maxval(body%model%mesh%xy, dim=2) - minval(body%model%mesh%xy, dim=2))
         call watch%see(limit_strain, strain(worst_place(strain)), when)
         if (fracture%n_cells > 0) then
            jump = fracture_jump(body)
            ratio = norm2(jump, dim=1)/body%model%mesh%face_length
            i = worst_place(ratio)
            call watch%see(limit_jump, ratio(i), when, &
                           fracture_cell_centre(fracture, i))
         end if
         if (self%scene%growth%intensities) then
            call watch%see_tips(self%tip, self%scene%material%toughness, &
                                self%scene%growth%enabled, when, thermal_scale(self))
         end if
      end associate
   end subroutine watch_body

   !> A small share of the K of a crack under the thermal stress of held rock: in free rock changes
   !! of temperature may leave none [Pa m^1/2].
   pure real(rk) function thermal_scale(self) result(scale)
      class(loaded_body_t), intent(in) :: self
      real(rk), parameter :: share = 0.01_rk

      scale = 0.0_rk
      associate (body => self%body)
         if (.not. allocated(body%loads%heat_pressure)) return
         scale = share*maxval(body%model%rocks%elasticity%biot) &
                 *maxval(abs(body%loads%heat_pressure))*sqrt(sum(body%model%mesh%face_length))
      end associate
   end function thermal_scale

end module mechanics_results
