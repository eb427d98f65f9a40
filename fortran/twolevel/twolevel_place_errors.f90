!> Estimated errors of the entries of wells and of the probes, from those of the quantities of a run
!! (twolevel_value_errors).
module twolevel_place_errors
   use base_kinds, only: pi, rk
   use base_plane, only: norm2
   use mesh_geometry, only: cell_area, cell_centre
   use report_rows, only: entry_row_t, probe_row_t
   use scene_types, only: scene_t
   use twolevel_errors, only: stated_errors_t
   use twolevel_followed, only: followed_step_t
   use twolevel_pressure_errors, only: least
   use twolevel_problem, only: coarse_problem_t
   use twolevel_value_errors, only: of_solution, step_facts_t, value_errors_t
   implicit none(type, external)
   private

   public :: add_well_places, note_entries, note_probes

   !> least error of a probe, over the range, and of its displacement [-]
   real(rk), parameter :: of_range = 0.001_rk, of_displacement = 4.0e-4_rk

contains

   !> Errors of the entries of wells after a step.
   subroutine note_entries(self, rows, stated, facts)
      type(value_errors_t), intent(inout) :: self
      type(entry_row_t), intent(inout) :: rows(:)
      type(stated_errors_t), intent(in) :: stated
      type(step_facts_t), intent(in) :: facts
      real(rk) :: by_length
      integer :: e

      by_length = merge(abs(stated%slope)*max(0.0_rk, stated%length), 0.0_rk, facts%has_estimate)
      call self%entries%follow(self%step, [rows%pressure, rows%flow])
      do e = 1, size(rows)
         associate (row => rows(e), error => rows(e)%error, time => self%entries%error)
            error%pressure = time(e) + self%of_pressure*abs(row%pressure - self%entries%first(e)) &
                             + by_length + of_solution*abs(row%pressure)
            error%flow = time(size(rows) + e) + max(self%of_pressure, self%of_flow)*abs(row%flow)
            if (abs(row%share) > 0.0_rk) error%share = error%flow*abs(row%share/row%flow)
         end associate
      end do
   end subroutine note_entries

   !> Errors of the probes: add those in time, and of the fractures' effect, to those of the cells.
   subroutine note_probes(self, time, rise, row)
      type(value_errors_t), intent(inout) :: self
      real(rk), intent(in) :: time  !< [s]
      real(rk), intent(in) :: rise  !< range of the pressures of the run so far [Pa]
      type(probe_row_t), intent(inout) :: row
      type(followed_step_t) :: whole
      real(rk), allocatable :: values(:, :)
      real(rk) :: added(6)
      integer :: i

      allocate (values(6, size(row%pressure)))
      values(1, :) = row%pressure
      values(2:3, :) = row%displacement
      values(4:, :) = row%stress
      if (.not. allocated(self%probes%value)) call self%probes%begin(time, [values])
      whole = self%step
      whole%left = 1.0_rk
      call self%probes%follow(whole, [values])
      do i = 1, size(row%pressure)
         associate (p => self%probes, at => 6*(i - 1))
            added = p%error(at + 1:at + 6) + (least + self%of_length) &
                    *abs(p%value(at + 1:at + 6) - p%first(at + 1:at + 6))
         end associate
         row%pressure_error(i) = row%pressure_error(i) + added(1) + of_range*rise
         row%displacement_error(i) = row%displacement_error(i) + maxval(added(2:3)) &
                                     + of_displacement*maxval(abs(row%displacement(:, i)))
         row%stress_error(i) = row%stress_error(i) + maxval(added(4:)) &
                               + of_range*maxval(abs(row%stress(:, i)))
      end do
   end subroutine note_probes

   !> Add the error of displacements by wells in the rock, whose fluid lies at the centre of their
   !! cell instead: that of a strain nucleus, u = m/(2 pi r), m = alpha V/(S' (lambda + 2 G)) for
   !! the volume V, which is displaced by d: d m/(2 pi r^2), and as much by its image in a side,
   !! r at most the distance of that.
   subroutine add_well_places(scene, problem, injected, row)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: injected(:)  !< (wells) so far [m2]
      type(probe_row_t), intent(inout) :: row
      real(rk) :: off, r, strength
      integer :: i, w

      do w = 1, size(scene%injections)
         if (problem%rock_cell(w) == 0) cycle
         associate (well => [scene%injections(w)%x, scene%injections(w)%y], mesh => problem%mesh, &
                    cell => problem%rock_cell(w), solid => problem%model%rock%solid_at( &
                    problem%rock_cell(w)))
            off = norm2(well - cell_centre(mesh, cell))
            strength = solid%biot*abs(injected(w))/(solid%uniaxial_storage() &
                                                    *(solid%lame + 2.0_rk*solid%shear))
            do i = 1, size(scene%probes)
               r = min(norm2([scene%probes(i)%x, scene%probes(i)%y] - well), &
                       minval(well - minval(mesh%xy, dim=2)), minval(maxval(mesh%xy, dim=2) - well))
               row%displacement_error(i) = row%displacement_error(i) &
                                           + off*strength/(pi*max(r**2, cell_area(mesh, cell)))
            end do
         end associate
      end do
   end subroutine add_well_places

end module twolevel_place_errors
