!> Estimated errors of the published quantities of a body without a fluid, without a further
!! solution: slip, opening and their sums by the sizes of the cells (report_jump_errors), stresses
!! by their differences between adjacent elements, displacements by those of the stresses; energy by
!! that of the fractures, and with &adaptive by the estimate in the energy norm.
module mechanics_errors
   use base_kinds, only: ik, rk
   use contact_law, only: state_open, state_stick
   use mechanics_body, only: body_t
   use mechanics_fields, only: point_state
   use mesh_geometry, only: cell_area
   use report_jump_errors, only: closure_error, error_of_largest, finite_elements, jump_errors_t, &
                                 relative_jump_errors, unevenness
   use report_rows, only: fracture_fields_t, history_row_t, matrix_fields_t
   use scene_types, only: material_t
   implicit none(type, external)
   private

   public :: find_fracture_errors, find_point_errors, find_rock_errors, note_row

   real(rk), parameter :: least = 1.0e-3_rk  !< relative error of fields in the rock [-]
   real(rk), parameter :: rounding = 1.0e-9_rk  !< of a jump, over the largest one [-]
   !> errors of jumps over the largest one: of all, and of slip where a joint closes [-]
   real(rk), parameter :: of_largest = 0.0002_rk, of_joints = 0.005_rk
   !> relative errors of displacement and stress at a point [-]
   real(rk), parameter :: least_at_point(2) = [1.5e-5_rk, 1.0e-4_rk]
   !> shares of the difference from the neighbours at a point [-]
   real(rk), parameter :: of_neighbours(2) = [0.12_rk, 0.35_rk]

contains

   !> Errors of a row of history.csv.
   pure subroutine note_row(rock, body, fields, row)
      type(material_t), intent(in) :: rock
      type(body_t), intent(in) :: body
      type(fracture_fields_t), intent(in) :: fields  !< with their errors
      type(history_row_t), intent(inout) :: row
      type(jump_errors_t) :: slip, opening
      real(rk) :: weight(size(fields%jump_t))

      associate (length => body%model%mesh%face_length, error => row%error, e => fields%error, &
                 fracture => body%mesh%fracture, n => fields%jump_n, t => fields%jump_t)
         slip = relative_jump_errors(fracture, moving(t), finite_elements)
         opening = relative_jump_errors(fracture, moving(max(0.0_rk, n)), finite_elements)
         error%max_opening = error_of_largest(fracture, n, e%jump_n)
         error%max_slip = error_of_largest(fracture, abs(t), e%jump_t)
         error%fracture_volume = sum(length*merge(opening%of_sum*n, e%jump_n, n > 0.0_rk))
         weight = length*abs(t)
         if (sum(weight) > 0.0_rk) then
            error%seismic_moment = row%seismic_moment*sum(weight*slip%of_sum)/sum(weight)
         end if
         ! Of an open crack of the opening w: E'/8 w**2/sqrt(d1 d2) in each place.
         error%strain_energy = 0.125_rk*modulus_of(rock) &
                               *(sum(length*slip%share*t**2/slip%reach, &
                                     mask=slip%reach > 0.0_rk) &
                                 + sum(length*opening%share*n**2/opening%reach, &
                                       mask=opening%reach > 0.0_rk)) &
                               + sum(length*abs(fields%traction_n)*e%jump_n, mask=n < 0.0_rk) &
                               + body%estimate%total**2
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
      real(rk), intent(in) :: jump(:)  !< (fracture cells) [m]
      logical :: moves(size(jump))

      moves = abs(jump) > rounding*maxval(abs(jump))
   end function moving

   !> Errors of the fields of the fracture cells.
   pure subroutine find_fracture_errors(rock, friction, body, fields)
      type(material_t), intent(in) :: rock
      real(rk), intent(in) :: friction(:)  !< (fracture cells) [-]
      type(body_t), intent(in) :: body
      type(fracture_fields_t), intent(inout) :: fields
      type(jump_errors_t) :: slip, opening
      real(rk), dimension(size(fields%jump_n)) :: by_jump, moved, n

      associate (e => fields%error, fracture => body%mesh%fracture, t => fields%jump_t)
         n = max(0.0_rk, fields%jump_n)
         moved = hypot(n, t)
         slip = relative_jump_errors(fracture, moving(t), finite_elements)
         opening = relative_jump_errors(fracture, moving(n), finite_elements)
         by_jump = 0.0_rk
         where (slip%reach > 0.0_rk) by_jump = slip%share*0.25_rk*modulus_of(rock)/slip%reach
         ! The tractions of contact err less than those that the errors of the jumps are equal to.
         e%traction_n = 0.35_rk*by_jump*moved + unevenness(fracture, fields%traction_n)
         e%traction_t = 0.25_rk*by_jump*moved + unevenness(fracture, fields%traction_t)
         e%jump_t = slip%share*moved + of_largest*maxval(moved)
         where (fields%jump_n < -rounding*maxval(moved)) &
            e%jump_t = e%jump_t + of_joints*maxval(moved)
         where (.not. moved > 0.0_rk) e%jump_t = 0.0_rk
         ! Faces that stick may slip if the errors of their tractions exceed the rest of friction.
         where (fields%state == state_stick) e%jump_t = max(e%jump_t, 2.0_rk/modulus_of(rock) &
            & *(fracture%cell_s(2, :) - fracture%cell_s(1, :))*(abs(fields%traction_t) &
            & + e%traction_t + friction*(fields%traction_n + e%traction_n)))
         e%jump_n = opening%share*merge(moved, n, fields%state == state_open) &
                    + merge(of_largest*maxval(moved), 0.0_rk, n > 0.0_rk) &
                    + closure_error(fields%jump_n, fields%traction_n, e%traction_n)
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
      displacement = of_neighbours(1)*stress/rock%young*sqrt(cell_area(body%mesh, cell)) &
                     + least_at_point(1)*maxval(abs(moved))
      stress = of_neighbours(2)*stress + least_at_point(2)*maxval(abs(of_cell))
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
