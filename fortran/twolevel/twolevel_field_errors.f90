!> Estimated errors of the fields of a state with a fluid: those of its quantities
!! (twolevel_value_errors), and in each cell the difference from what its neighbours give.
module twolevel_field_errors
   use base_kinds, only: ik, rk
   use coarse_fields, only: cell_stress
   use coarse_state, only: state_t
   use contact_law, only: state_open
   use mesh_types, only: fracture_mesh_t
   use report_jump_errors, only: jump_errors_t, unevenness
   use report_rows, only: fracture_errors_t, fracture_fields_t, intersection_fields_t, &
                          matrix_fields_t
   use scene_types, only: scene_t
   use twolevel_jump_errors, only: jumps_in_space_t
   use twolevel_pressure_errors, only: least
   use twolevel_problem, only: coarse_problem_t
   use twolevel_value_errors, only: of_solution, value_errors_t
   implicit none(type, external)
   private

   public :: add_rock_errors, find_fracture_errors, note_joint_errors

   !> errors of flows, over the difference from the neighbours and the largest one of a fracture [-]
   real(rk), parameter :: of_neighbours = 1.2_rk, of_largest = 0.04_rk
   !> error of pressures by that of the resistance to flow, over their range in a fracture [-]
   real(rk), parameter :: of_drop = 0.06_rk

contains

   !> Largest value on the fracture of each cell.
   pure function largest_of(fracture, values) result(largest)
      type(fracture_mesh_t), intent(in) :: fracture
      real(rk), intent(in) :: values(:)
      real(rk) :: largest(size(values))
      integer(ik) :: f

      do f = 1, maxval([0_ik, fracture%cell_fracture])
         where (fracture%cell_fracture == f) largest = maxval(values, &
                                                              mask=fracture%cell_fracture == f)
      end do
   end function largest_of

   !> Errors of the fields of the fracture cells.
   subroutine find_fracture_errors(scene, problem, state, errors, fields)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(value_errors_t), intent(in) :: errors
      type(fracture_fields_t), intent(inout) :: fields
      type(jumps_in_space_t) :: jumps
      real(rk) :: of_pressure

      of_pressure = errors%pressure_error()
      call errors%jumps_of(scene, problem, state, jumps)
      associate (fracture => problem%mesh%fracture, e => fields%error)
         e%jump_n = jumps%error_n + errors%of_opening*abs(fields%jump_n)
         e%jump_t = jumps%error_t + errors%of_slip*abs(fields%jump_t)
         e%pressure = of_pressure + 0.5_rk*unevenness(fracture, fields%pressure) &
                      + of_solution*abs(fields%pressure) &
                      + of_drop*(largest_of(fracture, fields%pressure) &
                                 + largest_of(fracture, -fields%pressure))
         e%flow = of_neighbours*unevenness(fracture, fields%flow) &
                  + (errors%of_flow + errors%time_share())*abs(fields%flow) &
                  + of_largest*largest_of(fracture, abs(fields%flow))
      end associate
      call note_tractions(scene, problem, state, jumps%slip, fields)
   end subroutine find_fracture_errors

   !> Errors of the tractions: differences between neighbours and between the ends of a cell, the
   !! traction that the error of the jump is equal to, and in contact that of the pressure.
   subroutine note_tractions(scene, problem, state, jumps, fields)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(jump_errors_t), intent(in) :: jumps
      type(fracture_fields_t), intent(inout) :: fields
      real(rk) :: by_jump(size(state%pressure)), modulus

      modulus = scene%material%young/(1.0_rk - scene%material%poisson**2)
      by_jump = 0.0_rk
      where (jumps%reach > 0.0_rk)
         by_jump = jumps%of_slip*0.25_rk*modulus/jumps%reach
      end where
      associate (e => fields%error, fracture => problem%mesh%fracture, t => state%traction, &
                 friction => problem%model%cells%law%friction)
         e%traction_n = max(unevenness(fracture, fields%traction_n), &
                            0.5_rk*abs(t(1, 2, :) - t(1, 1, :))) &
                        + by_jump*hypot(fields%jump_n, fields%jump_t) + e%pressure
         e%traction_t = max(unevenness(fracture, fields%traction_t), &
                            0.5_rk*abs(t(2, 2, :) - t(2, 1, :))) &
                        + by_jump*hypot(fields%jump_n, fields%jump_t) + friction*e%pressure
         where (fields%state == state_open)
            e%traction_n = 0.0_rk
            e%traction_t = 0.0_rk
         end where
      end associate
   end subroutine note_tractions

   !> Errors of the pressures of joints.
   pure subroutine note_joint_errors(errors, fields)
      type(value_errors_t), intent(in) :: errors
      type(intersection_fields_t), intent(inout) :: fields

      fields%pressure_error = spread(errors%pressure_error(), 1, size(fields%pressure))
   end subroutine note_joint_errors

   !> Add the errors of time and of the fractures to those of each cell of the rock.
   pure subroutine add_rock_errors(scene, problem, state, errors, fields)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(value_errors_t), intent(in) :: errors
      type(matrix_fields_t), intent(inout) :: fields
      real(rk) :: share, start

      if (.not. allocated(fields%pressure_error)) return
      start = scene%initial%pressure
      if (allocated(problem%model%in_situ)) start = 0.0_rk
      share = least + errors%of_length + errors%time_share()
      fields%pressure_error = fields%pressure_error &
                              + share*abs(state%unknowns(3, :problem%mesh%n_cells) - start)
      fields%displacement_error = fields%displacement_error &
                                  + share*maxval(abs(fields%displacement), dim=1)
   end subroutine add_rock_errors

end module twolevel_field_errors
