!> Quantities that the limits of a run check in a scene with a fluid.
module twolevel_limits
   use base_errors, only: error_t
   use base_kinds, only: degrees, ik, rk
   use base_number, only: brief_text
   use coarse_state, only: state_t, step_report_t
   use growth_tip, only: tip_t
   use mesh_builder, only: mesh_quality
   use mesh_geometry, only: cell_centre, fracture_cell_centre
   use scene_fluid_law, only: viscosity_ratio
   use scene_types, only: scene_t
   use report_limits, only: limit_angle, limit_aperture, limit_contact, limit_forward_error, &
                            limit_fluid_in_rock, limit_initial_keq, limit_jump, limit_keq, &
                            limit_layering, limit_loop_flow, limit_mass, limit_pressure_load, &
                            limit_pressure_stiffness, limit_strain, limit_table
   use report_watch, only: watch_t, worst_place
   use twolevel_problem, only: coarse_problem_t
   use twolevel_setup, only: pressure_scale
   implicit none(type, external)
   private

   public :: watch_levels, watch_mesh, watch_windows

contains

   !> Check the limits in a converged step, before it is accepted.
   subroutine watch_levels(watch, scene, problem, state, report, mass_error, mass_error_relative)
      type(watch_t), intent(inout) :: watch
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(step_report_t), intent(in) :: report
      real(rk), intent(in) :: mass_error  !< accumulated error, including this step [m2]
      real(rk), intent(in) :: mass_error_relative  !< accumulated error, including this step [-]
      character(len=:), allocatable :: when
      real(rk) :: strain(2), lost, storable

      when = name_of(state%time)
      associate (d => scene%domain, n => problem%mesh%n_cells, u => state%unknowns)
         call watch%see(limit_forward_error, report%error_bound, when)
         call watch%see(limit_loop_flow, report%loop_flow_error, when)
         ! In a body without fractures the fluid may not flow at all; then the error is compared
         ! with the fluid volume that the pressure would store in the rock.
         lost = mass_error_relative
         storable = (d%x_max - d%x_min)*(d%y_max - d%y_min)*maxval(abs(u(3, :n))) &
                    /scene%material%young
         if (problem%mesh%fracture%n_cells == 0 .and. storable > 0.0_rk) then
            lost = min(lost, abs(mass_error)/storable)
         end if
         call watch%see(limit_mass, lost, when)
         call watch%see(limit_contact, report%contact_residual, when)
         strain = (maxval(u(:2, :n), dim=2) - minval(u(:2, :n), dim=2)) &
                  /[d%x_max - d%x_min, d%y_max - d%y_min]
         call watch%see(limit_strain, strain(worst_place(strain)), when)
      end associate
      call watch_pressure(watch, scene, problem, state, when)
      if (problem%mesh%fracture%n_cells > 0) then
         call watch_fractures(watch, scene, problem, state, when)
      end if
   end subroutine watch_levels

   !> Check the pressure in the rock and in the fractures.
   subroutine watch_pressure(watch, scene, problem, state, when)
      type(watch_t), intent(inout) :: watch
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      character(len=*), intent(in) :: when
      real(rk) :: pressure, scale, xy(2)
      integer(ik) :: i

      associate (mesh => problem%mesh, p => problem%rock_pressure(state))
         i = worst_place(abs(p))
         pressure = abs(p(i))
         xy = cell_centre(mesh, i)
      end associate
      if (problem%mesh%fracture%n_cells > 0) then
         associate (p => problem%fracture_pressure(state))
            i = worst_place(abs(p))
            if (.not. abs(p(i)) <= pressure) then
               pressure = abs(p(i))
               xy = fracture_cell_centre(problem%mesh%fracture, i)
            end if
         end associate
      end if
      if (allocated(problem%model%settings%fluid_law)) then
         call watch_fluid(watch, scene, problem, state, when)
      end if
      if (allocated(scene%fluid%table_temperature) .and. &
          allocated(problem%heat_after%temperature)) then
         associate (t => scene%heat%temperature + problem%heat%cell_means(problem%heat_after))
            associate (differs => abs(viscosity_ratio(scene%fluid, t) - 1.0_rk))
               i = worst_place(differs)
               call watch%see(limit_fluid_in_rock, differs(i), when, cell_centre(problem%mesh, i))
            end associate
         end associate
      end if
      call watch%see(limit_pressure_stiffness, pressure/scene%material%young, when, xy)
      scale = pressure_scale(scene)
      if (scale > 0.0_rk) call watch%see(limit_pressure_load, pressure/scale, when, xy)
   end subroutine watch_pressure

   !> Check pressures beyond the table of the fluid, and viscosity in the rock, which the law does
   !! not change.
   subroutine watch_fluid(watch, scene, problem, state, when)
      type(watch_t), intent(inout) :: watch
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      character(len=*), intent(in) :: when
      real(rk) :: beyond(problem%mesh%fracture%n_cells), differs(problem%mesh%n_cells)
      integer(ik) :: i

      associate (law => problem%model%settings%fluid_law, mesh => problem%mesh)
         differs = abs(law%thickness_at(problem%rock_pressure(state)) - 1.0_rk)
         i = worst_place(differs)
         call watch%see(limit_fluid_in_rock, differs(i), when, &
                        cell_centre(mesh, i))
      end associate
      if (.not. allocated(scene%fluid%table_pressure)) return
      if (problem%mesh%fracture%n_cells == 0) return
      associate (range => scene%fluid%table_pressure, &
                 p => problem%fracture_pressure(state))
         beyond = max(range(1) - p, p - range(size(range)), 0.0_rk)/(range(size(range)) - range(1))
         i = worst_place(beyond)
         call watch%see(limit_table, beyond(i), when, &
                        fracture_cell_centre(problem%mesh%fracture, i))
      end associate
   end subroutine watch_fluid

   !> Check aperture and jump of the fracture cells.
   subroutine watch_fractures(watch, scene, problem, state, when)
      type(watch_t), intent(inout) :: watch
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      character(len=*), intent(in) :: when
      real(rk) :: ratio(problem%mesh%fracture%n_cells)
      integer(ik) :: i

      associate (d => scene%domain, &
                 length => problem%model%condensed%length)
         i = worst_place(state%aperture)
         call watch%see(limit_aperture, &
                        state%aperture(i)/min(d%x_max - d%x_min, d%y_max - d%y_min), when, &
                        fracture_cell_centre(problem%mesh%fracture, i))
         ratio = maxval(norm2(state%jump, dim=1), dim=1)/length
         i = worst_place(ratio)
         call watch%see(limit_jump, ratio(i), when, fracture_cell_centre(problem%mesh%fracture, i))
      end associate
   end subroutine watch_fractures

   !> Check a new coarse mesh.
   subroutine watch_mesh(watch, problem, time, error)
      type(watch_t), intent(inout) :: watch
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: time  !< [s]
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: angle
      integer(ik) :: cell

      call mesh_quality(problem%mesher, angle, cell, error)
      if (allocated(error)) return
      call watch%see(limit_angle, angle*degrees, name_of(time), cell_centre(problem%mesh, cell))
      associate (rock => problem%model%rock)
         if (rock%most_layered_cell == 0) return
         call watch%see(limit_layering, rock%most_layered, name_of(time), &
                        cell_centre(problem%mesh, rock%most_layered_cell))
      end associate

   end subroutine watch_mesh

   !> Check the tips. None may exceed the toughness once growth in a state has ended, nor in the
   !! initial state.
   subroutine watch_windows(watch, scene, tips, time, growth_is_done, is_initial)
      type(watch_t), intent(inout) :: watch
      type(scene_t), intent(in) :: scene
      type(tip_t), intent(in) :: tips(:)
      real(rk), intent(in) :: time  !< [s]
      logical, intent(in) :: growth_is_done  !< false: tips do not grow in this state
      logical, intent(in) :: is_initial  !< tips are about to grow from the initial state
      character(len=:), allocatable :: when
      real(rk) :: excess(size(tips))
      integer(ik) :: i

      when = name_of(time)
      associate (toughness => scene%material%toughness, may_grow => scene%growth%enabled)
         call watch%see_tips(tips, toughness, may_grow, when)
         if (.not. (growth_is_done .or. is_initial) .or. all(tips%arrested)) return
         excess = merge(-1.0_rk, tips%excess(toughness), tips%arrested)
         i = worst_place(excess)
         associate (limit => merge(limit_initial_keq, limit_keq, is_initial))
            call watch%see(limit, 1.0_rk + excess(i), when, tips(i)%xy)
         end associate
      end associate
   end subroutine watch_windows

   pure function name_of(time) result(words)
      real(rk), intent(in) :: time  !< [s]
      character(len=:), allocatable :: words

      words = brief_text(time, 6)//" s"
   end function name_of

end module twolevel_limits
