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

   !> Add the errors by wells in the rock, whose fluid lies at the centre of their cell, off by d.
   !! Displacements: those of a strain nucleus, u = m/(2 pi r), m = alpha V/(S' (lambda + 2 G)) for
   !! the volume V, change by d m/(2 pi r^2), and as much by its image in a side, r at most the
   !! distance of that. Pressures: those of a source that supplies V in the time t,
   !! p = Q mu/(4 pi K) E1(r^2/(4 c t)), change by d Q mu/(2 pi K r) exp(-r^2/(4 c t)), and so by
   !! its image, which is farther from the probe than the well and the side. r is the distance of
   !! the nearer of both places.
   subroutine add_well_places(scene, problem, injected, time, row)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: injected(:)  !< (wells) so far [m2]
      real(rk), intent(in) :: time  !< since the start [s]
      type(probe_row_t), intent(inout) :: row
      real(rk) :: apart, off, side, size_of_cell, source, strength
      integer :: i, w

      if (.not. time > 0.0_rk) return
      do w = 1, size(scene%injections)
         if (problem%rock_cell(w) == 0) cycle
         associate (well => [scene%injections(w)%x, scene%injections(w)%y], mesh => problem%mesh, &
                    cell => problem%rock_cell(w), rock => problem%model%rock, solid => &
                    problem%model%rock%solid_at(problem%rock_cell(w)))
            off = norm2(well - cell_centre(mesh, cell))
            size_of_cell = sqrt(cell_area(mesh, cell))
            strength = solid%biot*abs(injected(w))/(solid%uniaxial_storage() &
                                                    *(solid%lame + 2.0_rk*solid%shear))
            source = abs(injected(w))/(2.0_rk*pi*time*rock%mobility_at(cell))
            side = max(size_of_cell, min(minval(well - minval(mesh%xy, dim=2)), &
                                         minval(maxval(mesh%xy, dim=2) - well)))
            do i = 1, size(scene%probes)
               apart = max(size_of_cell, &
                           norm2([scene%probes(i)%x, scene%probes(i)%y] - well) - off)
               row%displacement_error(i) = row%displacement_error(i) &
                                           + off*strength/(pi*min(apart, side)**2)
               row%pressure_error(i) = row%pressure_error(i) + off*source &
                                       *(1.0_rk/apart + 1.0_rk/max(apart, side)) &
                                       *exp(-apart**2/(4.0_rk*rock%diffusivity_at(cell)*time))
            end do
         end associate
      end do
   end subroutine add_well_places

end module twolevel_place_errors
