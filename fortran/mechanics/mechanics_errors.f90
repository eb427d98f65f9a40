!> Estimated errors of the published quantities of a body without a fluid, without a further
!! solution: slip, opening and their sums by the sizes of the cells (report_jump_errors), stresses
!! by their differences between adjacent elements, displacements by those of the stresses; energy by
!! that of the fractures, and with &adaptive by the estimate in the energy norm.
module mechanics_errors
   use base_kinds, only: ik, pi, rk
   use mechanics_body, only: body_t
   use mechanics_fields, only: point_state
   use mesh_geometry, only: cell_area
   use report_jump_errors, only: finite_elements, jump_errors_t, relative_jump_errors, unevenness
   use report_rows, only: fracture_fields_t, history_row_t, matrix_fields_t
   use scene_types, only: material_t
   implicit none(type, external)
   private

   public :: find_fracture_errors, find_point_errors, find_rock_errors, note_row

   real(rk), parameter :: least = 1.0e-3_rk  !< relative error of fields in the rock [-]

contains

   !> Errors of a row of history.csv.
   pure subroutine note_row(rock, body, jump, row)
      type(material_t), intent(in) :: rock
      type(body_t), intent(in) :: body
      real(rk), intent(in) :: jump(:, :)  !< (2, fracture cells) opening, slip [m]
      type(history_row_t), intent(inout) :: row
      type(jump_errors_t) :: errors
      integer(ik) :: at(2)
      real(rk) :: share, weight(size(jump, 2))

      errors = relative_jump_errors(body%mesh%fracture, moving(jump), finite_elements)
      at = [maxloc(jump(1, :), kind=ik), maxloc(abs(jump(2, :)), kind=ik)]
      associate (length => body%model%mesh%face_length, error => row%error)
         error%max_opening = errors%share(at(1))*abs(row%max_opening)
         error%max_slip = errors%share(at(2))*row%max_slip
         error%fracture_volume = sum(length*errors%of_sum*abs(jump(1, :)))
         weight = length*abs(jump(2, :))
         share = maxval(errors%share(at))
         if (sum(weight) > 0.0_rk) then
            error%seismic_moment = row%seismic_moment*sum(weight*errors%of_sum)/sum(weight)
         end if
         ! Of an open crack of the same opening: pi/16 E' w**2.
         error%strain_energy = share*pi/16.0_rk*modulus_of(rock)*(row%max_opening**2 &
                                                                  + row%max_slip**2)
         error%strain_energy = error%strain_energy + body%estimate%total**2
      end associate
   end subroutine note_row

   !> E' [Pa].
   pure real(rk) function modulus_of(rock) result(modulus)
      type(material_t), intent(in) :: rock

      modulus = rock%young
      if (.not. rock%plane_stress) modulus = modulus/(1.0_rk - rock%poisson**2)
   end function modulus_of

   !> Faces of each cell have moved.
   pure function moving(jump) result(moves)
      real(rk), intent(in) :: jump(:, :)  !< (2, fracture cells) [m]
      logical :: moves(size(jump, 2))
      real(rk), parameter :: rounding = 1.0e-9_rk

      moves = maxval(abs(jump), dim=1) > rounding*maxval(abs(jump))
   end function moving

   !> Errors of the fields of the fracture cells.
   pure subroutine find_fracture_errors(rock, body, fields)
      type(material_t), intent(in) :: rock
      type(body_t), intent(in) :: body
      type(fracture_fields_t), intent(inout) :: fields
      type(jump_errors_t) :: jumps
      real(rk) :: by_jump(size(fields%jump_n))

      associate (jump => reshape([fields%jump_n, fields%jump_t], [2, size(fields%jump_n)], &
                                 order=[2, 1]))
         jumps = relative_jump_errors(body%mesh%fracture, moving(jump), finite_elements)
      end associate
      by_jump = 0.0_rk
      where (jumps%reach > 0.0_rk) by_jump = jumps%share*0.25_rk*modulus_of(rock)/jumps%reach
      associate (e => fields%error)
         e%jump_n = jumps%share*abs(fields%jump_n)
         e%jump_t = jumps%share*abs(fields%jump_t)
         ! The tractions of contact err less than those that the errors of the jumps are equal to.
         e%traction_n = 0.3_rk*by_jump*hypot(fields%jump_n, fields%jump_t) &
                        + unevenness(body%mesh%fracture, fields%traction_n)
         e%traction_t = 0.15_rk*by_jump*hypot(fields%jump_n, fields%jump_t) &
                        + unevenness(body%mesh%fracture, fields%traction_t)
      end associate
   end subroutine find_fracture_errors

   !> Errors of displacement and stress at a point of an element: the stress that the neighbours
   !! extrapolate to it.
   subroutine find_point_errors(rock, body, cell, xy, displacement, stress)
      type(material_t), intent(in) :: rock
      type(body_t), intent(in) :: body
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: xy(2)  !< [m]
      real(rk), intent(out) :: displacement  !< [m]
      real(rk), intent(out) :: stress  !< [Pa]
      real(rk) :: moved(2), of_cell(3), of_other(3), unused(2)
      integer(ik) :: k, other

      call point_state(body, cell, xy, moved, of_cell)
      stress = 0.0_rk
      do k = 1, 3
         other = sum(body%mesh%face_cells(:, body%mesh%cell_faces(k, cell))) - cell
         if (other == 0) cycle
         if (body%model%mesh%tip_corner(other) > 0) cycle
         call point_state(body, other, xy, unused, of_other)
         stress = max(stress, maxval(abs(of_other - of_cell)))
      end do
      displacement = stress/rock%young*sqrt(cell_area(body%mesh, cell)) + least*maxval(abs(moved))
      stress = stress + least*maxval(abs(of_cell))
   end subroutine find_point_errors

   !> Errors of the fields of the elements: the difference of the stress from the mean of the
   !! neighbours.
   subroutine find_rock_errors(rock, body, fields)
      type(material_t), intent(in) :: rock
      type(body_t), intent(in) :: body
      type(matrix_fields_t), intent(inout) :: fields
      real(rk) :: mean(3)
      integer(ik) :: cell, k, n, other

      associate (n => body%mesh%n_cells)
         allocate (fields%stress_error(n), fields%displacement_error(n))
      end associate
      do cell = 1, body%mesh%n_cells
         mean = 0.0_rk
         n = 0
         do k = 1, 3
            other = sum(body%mesh%face_cells(:, body%mesh%cell_faces(k, cell))) - cell
            if (other == 0) cycle
            mean = mean + fields%stress(:, other)
            n = n + 1
         end do
         associate (stress => fields%stress(:, cell))
            fields%stress_error(cell) = least*maxval(abs(stress))
            if (n > 0) fields%stress_error(cell) = fields%stress_error(cell) &
                                                 & + maxval(abs(stress - mean/n))
         end associate
         fields%displacement_error(cell) = fields%stress_error(cell)/rock%young &
                                           *sqrt(cell_area(body%mesh, cell)) &
                                           + least*maxval(abs(fields%displacement(:, cell)))
      end do
   end subroutine find_rock_errors

end module mechanics_errors
