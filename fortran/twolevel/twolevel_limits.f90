!> What the limits of a run watch in a scene with a fluid (report_limits).
module twolevel_limits
   use base_errors, only: error_t
   use base_kinds, only: degrees, ik, rk
   use base_number, only: brief_text
   use coarse_state, only: step_report_t
   use mesh_builder, only: mesh_quality
   use mesh_geometry, only: cell_centre, fracture_cell_centre
   use report_limits, only: limit_angle, limit_aperture, limit_contact, limit_fluid_in_rock, &
                            limit_forward_error, limit_jump, limit_keq, limit_layering, &
                            limit_loop_flow, limit_mass, limit_pressure_load, &
                            limit_pressure_stiffness, limit_strain, limit_table
   use report_watch, only: worst_place
   use twolevel_scales, only: pressure_scale
   use twolevel_state, only: two_levels_t
   implicit none(type, external)
   private

   public :: watch_levels, watch_mesh, watch_windows

contains

   !> Take note of a converged step, before it is accepted.
   subroutine watch_levels(self, report, mass_error, mass_error_relative)
      class(two_levels_t), intent(inout) :: self
      type(step_report_t), intent(in) :: report
      real(rk), intent(in) :: mass_error  !< of all steps, with this one [m2]
      real(rk), intent(in) :: mass_error_relative  !< of all steps, with this one [-]
      character(len=:), allocatable :: when
      real(rk) :: strain(2), lost, storable

      when = present_time(self)
      associate (watch => self%watch, d => self%scene%domain, n => self%mesh%n_cells, &
                 u => self%state%unknowns)
         call watch%see(limit_forward_error, report%error_bound, when)
         call watch%see(limit_loop_flow, report%loop_flow_error, when)
         ! A body without fractures may keep all its fluid where it is, and nothing has flown that
         ! the error could be compared with but what the pressure would store in the rock.
         lost = mass_error_relative
         storable = (d%x_max - d%x_min)*(d%y_max - d%y_min)*maxval(abs(u(3, :n))) &
                    /self%scene%material%young
         if (self%mesh%fracture%n_cells == 0 .and. storable > 0.0_rk) then
            lost = min(lost, abs(mass_error)/storable)
         end if
         call watch%see(limit_mass, lost, when)
         call watch%see(limit_contact, report%contact_residual, when)
         strain = (maxval(u(:2, :n), dim=2) - minval(u(:2, :n), dim=2)) &
                  /[d%x_max - d%x_min, d%y_max - d%y_min]
         call watch%see(limit_strain, strain(worst_place(strain)), when)
      end associate
      call watch_pressure(self, when)
      if (self%mesh%fracture%n_cells > 0) call watch_fractures(self, when)
   end subroutine watch_levels

   !> Pressure in the rock and in the fractures.
   subroutine watch_pressure(self, when)
      class(two_levels_t), intent(inout) :: self
      character(len=*), intent(in) :: when
      real(rk) :: pressure, scale, xy(2)
      integer(ik) :: i

      associate (mesh => self%mesh, p => self%rock_pressure())
         i = worst_place(abs(p))
         pressure = abs(p(i))
         xy = cell_centre(mesh, i)
      end associate
      if (self%mesh%fracture%n_cells > 0) then
         associate (p => self%fracture_pressure())
            i = worst_place(abs(p))
            if (.not. abs(p(i)) <= pressure) then
               pressure = abs(p(i))
               xy = fracture_cell_centre(self%mesh%fracture, i)
            end if
         end associate
      end if
      if (allocated(self%model%settings%fluid_law)) call watch_fluid(self, when)
      call self%watch%see(limit_pressure_stiffness, pressure/self%scene%material%young, when, xy)
      scale = pressure_scale(self%scene)
      if (scale > 0.0_rk) call self%watch%see(limit_pressure_load, pressure/scale, when, xy)
   end subroutine watch_pressure

   !> Where the fluid is not what its law says: beyond a table, and in the rock.
   subroutine watch_fluid(self, when)
      class(two_levels_t), intent(inout) :: self
      character(len=*), intent(in) :: when
      real(rk) :: beyond(self%mesh%fracture%n_cells), differs(self%mesh%n_cells)
      integer(ik) :: i

      associate (law => self%model%settings%fluid_law, mesh => self%mesh)
         differs = abs(law%thickness_at(self%rock_pressure()) - 1.0_rk)
         i = worst_place(differs)
         call self%watch%see(limit_fluid_in_rock, differs(i), when, &
                             cell_centre(mesh, i))
      end associate
      if (.not. allocated(self%scene%fluid%table_pressure)) return
      if (self%mesh%fracture%n_cells == 0) return
      associate (range => self%scene%fluid%table_pressure, p => self%fracture_pressure())
         beyond = max(range(1) - p, p - range(size(range)), 0.0_rk)/(range(size(range)) - range(1))
         i = worst_place(beyond)
         call self%watch%see(limit_table, beyond(i), when, &
                             fracture_cell_centre(self%mesh%fracture, i))
      end associate
   end subroutine watch_fluid

   !> Aperture and jump of the fracture cells.
   subroutine watch_fractures(self, when)
      class(two_levels_t), intent(inout) :: self
      character(len=*), intent(in) :: when
      real(rk) :: ratio(self%mesh%fracture%n_cells)
      integer(ik) :: i

      associate (d => self%scene%domain, state => self%state, &
                 length => self%model%condensed%length)
         i = worst_place(state%aperture)
         call self%watch%see(limit_aperture, &
                             state%aperture(i)/min(d%x_max - d%x_min, d%y_max - d%y_min), when, &
                             fracture_cell_centre(self%mesh%fracture, i))
         ratio = maxval(norm2(state%jump, dim=1), dim=1)/length
         i = worst_place(ratio)
         call self%watch%see(limit_jump, ratio(i), when, &
                             fracture_cell_centre(self%mesh%fracture, i))
      end associate
   end subroutine watch_fractures

   !> Take note of a new coarse mesh.
   subroutine watch_mesh(self, error)
      class(two_levels_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: angle
      integer(ik) :: cell

      call mesh_quality(self%mesher, angle, cell, error)
      if (allocated(error)) return
      call self%watch%see(limit_angle, angle*degrees, present_time(self), cell_centre(self%mesh, &
                                                                                      cell))
      associate (rock => self%model%rock)
         if (rock%most_layered_cell == 0) return
         call self%watch%see(limit_layering, rock%most_layered, present_time(self), &
                             cell_centre(self%mesh, rock%most_layered_cell))
      end associate

   end subroutine watch_mesh

   !> Take note of the tips. None shall exceed the toughness once growth in a state is done.
   subroutine watch_windows(self, growth_is_done)
      class(two_levels_t), intent(inout) :: self
      logical, intent(in) :: growth_is_done  !< else tips must not grow in this state
      character(len=:), allocatable :: when
      real(rk) :: drive(size(self%tip))
      integer(ik) :: i

      when = present_time(self)
      associate (toughness => self%scene%material%toughness, may_grow => self%scene%growth%enabled)
         call self%watch%see_tips(self%tip, toughness, may_grow, when)
         if (.not. growth_is_done .or. all(self%tip%arrested)) return
         drive = merge(0.0_rk, self%tip%drive%intensity, self%tip%arrested)
         i = worst_place(drive)
         call self%watch%see(limit_keq, drive(i)/toughness, when, self%tip(i)%xy)
      end associate
   end subroutine watch_windows

   pure function present_time(self) result(words)
      class(two_levels_t), intent(in) :: self
      character(len=:), allocatable :: words

      words = brief_text(self%state%time, 6)//" s"
   end function present_time

end module twolevel_limits
