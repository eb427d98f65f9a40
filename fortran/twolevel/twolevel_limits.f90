!> What the limits of a run watch in a scene with a fluid (simulation_limits).
module twolevel_limits
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_number, only: brief_text
   use coarse_state, only: step_report_t
   use mesh_builder, only: mesh_quality
   use simulation_limits, only: limit_angle, limit_aperture, limit_contact, limit_forward_error, &
                                limit_fluid_in_rock, limit_jump, limit_keq, limit_layering, &
                                limit_loop_flow, limit_mass, limit_pressure_load, &
                                limit_pressure_stiffness, limit_strain, limit_table
   use simulation_watch, only: worst_place
   use twolevel_scales, only: pressure_scale
   use twolevel_state, only: two_levels_t
   implicit none(type, external)
   private

   public :: watch_levels, watch_mesh, watch_windows

contains

   !> Take note of a converged step, before it is accepted.
   subroutine watch_levels(self, report, mass_error_relative)
      class(two_levels_t), intent(inout) :: self
      type(step_report_t), intent(in) :: report
      real(rk), intent(in) :: mass_error_relative  !< of all steps, with this one [-]
      character(len=:), allocatable :: when
      real(rk) :: strain(2), lost, storable

      when = present_time(self)
      associate (watch => self%watch, d => self%scene%domain, n => self%problem%mesh%n_cells, &
                 u => self%now%coarse%unknowns)
         call watch%see(limit_forward_error, report%error_bound, when)
         call watch%see(limit_loop_flow, report%loop_flow_error, when)
         ! A body without fractures may keep all its fluid where it is, and nothing has flown that
         ! the error could be compared with but what the pressure would store in the rock.
         lost = mass_error_relative
         storable = (d%x_max - d%x_min)*(d%y_max - d%y_min)*maxval(abs(u(3, :n))) &
                    /self%scene%material%young
         if (self%problem%mesh%fracture%n_cells == 0 .and. storable > 0.0_rk) then
            lost = min(lost, abs(self%now%fluid%mass_error)/storable)
         end if
         call watch%see(limit_mass, lost, when)
         call watch%see(limit_contact, report%contact_residual, when)
         strain = (maxval(u(:2, :n), dim=2) - minval(u(:2, :n), dim=2)) &
                  /[d%x_max - d%x_min, d%y_max - d%y_min]
         call watch%see(limit_strain, strain(worst_place(strain)), when)
      end associate
      call watch_pressure(self, when)
      if (self%problem%mesh%fracture%n_cells > 0) call watch_fractures(self, when)
   end subroutine watch_levels

   !> Pressure in the rock and in the fractures.
   subroutine watch_pressure(self, when)
      class(two_levels_t), intent(inout) :: self
      character(len=*), intent(in) :: when
      real(rk) :: pressure, scale, xy(2)
      integer(ik) :: i

      associate (mesh => self%problem%mesh, p => self%problem%rock_pressure(self%now%coarse))
         i = worst_place(abs(p))
         pressure = abs(p(i))
         xy = sum(mesh%xy(:, mesh%cell_nodes(:, i)), dim=2)/3.0_rk
      end associate
      if (self%problem%mesh%fracture%n_cells > 0) then
         associate (p => self%problem%fracture_pressure(self%now%coarse))
            i = worst_place(abs(p))
            if (.not. abs(p(i)) <= pressure) then
               pressure = abs(p(i))
               xy = middle(self, i)
            end if
         end associate
      end if
      if (allocated(self%problem%model%settings%fluid_law)) call watch_fluid(self, when)
      call self%watch%see(limit_pressure_stiffness, pressure/self%scene%material%young, when, xy)
      scale = pressure_scale(self%scene)
      if (scale > 0.0_rk) call self%watch%see(limit_pressure_load, pressure/scale, when, xy)
   end subroutine watch_pressure

   !> Where the fluid is not what its law says: beyond a table, and in the rock.
   subroutine watch_fluid(self, when)
      class(two_levels_t), intent(inout) :: self
      character(len=*), intent(in) :: when
      real(rk) :: beyond(self%problem%mesh%fracture%n_cells), differs(self%problem%mesh%n_cells)
      integer(ik) :: i

      associate (law => self%problem%model%settings%fluid_law, mesh => self%problem%mesh)
         differs = abs(law%thickness_at(self%problem%rock_pressure(self%now%coarse)) - 1.0_rk)
         i = worst_place(differs)
         call self%watch%see(limit_fluid_in_rock, differs(i), when, &
                             sum(mesh%xy(:, mesh%cell_nodes(:, i)), dim=2)/3.0_rk)
      end associate
      if (.not. allocated(self%scene%fluid%table_pressure)) return
      if (self%problem%mesh%fracture%n_cells == 0) return
      associate (range => self%scene%fluid%table_pressure, &
                 p => self%problem%fracture_pressure(self%now%coarse))
         beyond = max(range(1) - p, p - range(size(range)), 0.0_rk)/(range(size(range)) - range(1))
         i = worst_place(beyond)
         call self%watch%see(limit_table, beyond(i), when, middle(self, i))
      end associate
   end subroutine watch_fluid

   !> Aperture and jump of the fracture cells.
   subroutine watch_fractures(self, when)
      class(two_levels_t), intent(inout) :: self
      character(len=*), intent(in) :: when
      real(rk) :: ratio(self%problem%mesh%fracture%n_cells)
      integer(ik) :: i

      associate (d => self%scene%domain, state => self%now%coarse, &
                 length => self%problem%model%condensed%length)
         i = worst_place(state%aperture)
         call self%watch%see(limit_aperture, &
                             state%aperture(i)/min(d%x_max - d%x_min, d%y_max - d%y_min), when, &
                             middle(self, i))
         ratio = maxval(norm2(state%jump, dim=1), dim=1)/length
         i = worst_place(ratio)
         call self%watch%see(limit_jump, ratio(i), when, middle(self, i))
      end associate
   end subroutine watch_fractures

   !> Take note of a new coarse mesh.
   subroutine watch_mesh(self, error)
      class(two_levels_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      real(rk), parameter :: degrees = 180.0_rk/acos(-1.0_rk)  ! per radian
      real(rk) :: angle
      integer(ik) :: cell

      call mesh_quality(self%problem%mesher, angle, cell, error)
      if (allocated(error)) return
      call self%watch%see(limit_angle, angle*degrees, present_time(self), middle_of(cell))
      associate (rock => self%problem%model%rock)
         if (rock%most_layered_cell == 0) return
         call self%watch%see(limit_layering, rock%most_layered, present_time(self), &
                             middle_of(rock%most_layered_cell))
      end associate

   contains

      !> Of a cell [m].
      pure function middle_of(cell) result(xy)
         integer(ik), intent(in) :: cell
         real(rk) :: xy(2)

         xy = sum(self%problem%mesh%xy(:, self%problem%mesh%cell_nodes(:, cell)), dim=2)/3.0_rk
      end function middle_of

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

   !> Of a fracture cell [m].
   pure function middle(self, cell) result(xy)
      class(two_levels_t), intent(in) :: self
      integer(ik), intent(in) :: cell
      real(rk) :: xy(2)

      associate (fracture => self%problem%mesh%fracture)
         xy = 0.5_rk*sum(fracture%point_xy(:, fracture%cell_points(:, cell)), dim=2)
      end associate
   end function middle

   pure function present_time(self) result(words)
      class(two_levels_t), intent(in) :: self
      character(len=:), allocatable :: words

      words = brief_text(self%now%coarse%time, 6)//" s"
   end function present_time

end module twolevel_limits
