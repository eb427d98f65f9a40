!> Fluid in the fractures whose density or viscosity depends on its pressure: the terms that this
!! adds to the equations of a fluid with constant density and viscosity (coarse_fracture_flow).
!!
!! With r, m and mu_0 of scene_fluid_law, all volumes at the density of the reference pressure:
!!   balance of a cell   l (r a - r_before a_before) in place of l (a - a_before)
!!   flow                12 mu_0 L/a^3 q = m(p_1) - m(p_2) in place of p_1 - p_2
!! Pressures of the equations are relative to those in situ; the fluid law takes the total ones. A
!! fluid at rest has one pressure relative to that in situ, so the potentials of two places are
!! compared at one pressure in situ, the mean of the two: the weight of the fluid is that of its
!! density at the reference pressure. Flow across the faces of a fracture, over half an aperture,
!! keeps mu_0, since its resistance there is negligible.
module coarse_fluid_law
   use base_kinds, only: ik, rk
   use coarse_fractures, only: cell_fluid_t, flow_paths_t, fracture_system_t
   use coarse_state, only: fracture_cells_t, state_t
   use scene_fluid_law, only: fluid_law_t
   implicit none(type, external)
   private

   public :: add_fluid_law, add_fracture_balance

   integer(ik), parameter :: both(2) = [1_ik, 2_ik]  !< ends of a cell

contains

   !> To all equations of the fluid.
   pure subroutine add_fluid_law(x, law, eq)
      real(rk), intent(in) :: x(:)  !< [Pa]
      type(fluid_law_t), intent(in) :: law
      class(fracture_system_t), intent(inout) :: eq
      integer(ik) :: i

      if (law%changes_density) then
         do i = 1, eq%layout%n_cells
            call add_storage(i, x, law, eq)
         end do
      end if
      do i = 1, eq%layout%n_flows
         call add_flow(i, x, law, eq)
      end do
      do i = 1, eq%layout%n_branches
         call add_branch(i, x, law, eq)
      end do
   end subroutine add_fluid_law

   !> What cell i holds in addition to its volume, in the equation of p_F.
   pure subroutine add_storage(i, x, law, eq)
      integer(ik), intent(in) :: i
      real(rk), intent(in) :: x(:)  !< [Pa]
      type(fluid_law_t), intent(in) :: law
      class(fracture_system_t), intent(inout) :: eq
      type(cell_fluid_t) :: fluid
      real(rk) :: before, density, filled, in_situ, slope, unused
      integer(ik) :: jumps(2), k, row

      row = eq%layout%at_pressure(i)
      jumps = eq%layout%at_jump(i, both)
      fluid = eq%fluid_at(x, i)
      in_situ = eq%in_situ_at(i)
      call law%density_at(fluid%pressure + in_situ, density, slope)
      call law%density_at(eq%before%pressure(i) + in_situ, before, unused)
      associate (length => eq%condensed%length(i))
         filled = eq%cells%residual_aperture(i) + eq%opening(x, i) - fluid%void
         eq%residual(row) = eq%residual(row) &
                            + length*(filled*(density - 1.0_rk) &
                                      - (eq%before%aperture(i) - eq%before%void(i)) &
                                      *(before - 1.0_rk))/eq%unit
         do k = 1, 2
            call eq%slopes%add(row, jumps(k), &
                               0.5_rk*length*(density - 1.0_rk)/(eq%stiffness*eq%unit))
         end do
         call eq%slopes%add(row, row, length/eq%unit*(filled*slope*fluid%pressure_slope &
                                                      - fluid%void_slope*(density - 1.0_rk)))
      end associate
   end subroutine add_storage

   !> Potentials in place of pressures, in the equation of the flow between the cells of pair k.
   pure subroutine add_flow(k, x, law, eq)
      integer(ik), intent(in) :: k
      real(rk), intent(in) :: x(:)  !< [Pa]
      type(fluid_law_t), intent(in) :: law
      class(fracture_system_t), intent(inout) :: eq
      type(cell_fluid_t) :: fluid
      real(rk) :: beyond, in_situ, slope
      integer(ik) :: cells(2), end, row

      row = eq%layout%at_flow(k)
      cells = eq%paths%connections(:, k)
      in_situ = 0.5_rk*(eq%in_situ_at(cells(1)) + eq%in_situ_at(cells(2)))
      do end = 1, 2
         fluid = eq%fluid_at(x, cells(end))
         call find_beyond(law, in_situ, fluid%pressure, beyond, slope)
         associate (sign => real(2*end - 3, rk))
            eq%residual(row) = eq%residual(row) + sign*beyond
            call eq%slopes%add(row, eq%layout%at_pressure(cells(end)), &
                               sign*slope*fluid%pressure_slope)
         end associate
      end do
   end subroutine add_flow

   !> The same in the equation of the flow of branch b into its joint.
   pure subroutine add_branch(b, x, law, eq)
      integer(ik), intent(in) :: b
      real(rk), intent(in) :: x(:)  !< [Pa]
      type(fluid_law_t), intent(in) :: law
      class(fracture_system_t), intent(inout) :: eq
      type(cell_fluid_t) :: fluid
      real(rk) :: beyond(2), in_situ, slope(2)
      integer(ik) :: cell, joint, row

      row = eq%layout%at_branch(b)
      cell = eq%paths%joints%cell(b)
      joint = eq%layout%at_joint(eq%paths%joints%joint(b))
      fluid = eq%fluid_at(x, cell)
      beyond = 0.0_rk
      slope = 0.0_rk
      if (.not. eq%paths%joints%is_shut(b)) then
         in_situ = eq%in_situ_at(cell)
         if (allocated(eq%paths%joints%pressure_in_situ)) then
            in_situ = 0.5_rk*(in_situ + eq%paths%joints%pressure_in_situ(eq%paths%joints%joint(b)))
         end if
         call find_beyond(law, in_situ, x(joint), beyond(1), slope(1))
         call find_beyond(law, in_situ, fluid%pressure, beyond(2), slope(2))
      end if
      eq%residual(row) = eq%residual(row) + beyond(1) - beyond(2)
      ! The places of the derivatives are the same in every state (coarse_slopes).
      call eq%slopes%add(row, joint, slope(1))
      call eq%slopes%add(row, eq%layout%at_pressure(cell), -slope(2)*fluid%pressure_slope)
   end subroutine add_branch

   !> Potential less pressure, both beyond those in situ, and the derivative.
   pure subroutine find_beyond(law, in_situ, pressure, beyond, slope)
      type(fluid_law_t), intent(in) :: law
      real(rk), intent(in) :: in_situ, pressure  !< [Pa]
      real(rk), intent(out) :: beyond  !< [Pa]
      real(rk), intent(out) :: slope  !< [-]

      call law%potential_at(in_situ + pressure, beyond, slope)
      beyond = beyond - pressure
      slope = slope - 1.0_rk
   end subroutine find_beyond

   !> Add the fluid balance of the fractures for one step: what they store less what wells supply.
  pure subroutine add_fracture_balance(paths, cells, length, dt, before, after, compressed, balance)
      type(flow_paths_t), intent(in) :: paths
      type(fracture_cells_t), intent(in) :: cells
      real(rk), intent(in) :: length(:)  !< (cells) [m]
      real(rk), intent(in) :: dt  !< [s]
      type(state_t), intent(in) :: before, after
      real(rk), intent(out) :: compressed  !< fluid that pressure has added [m2]
      real(rk), intent(inout) :: balance  !< [m2]
      real(rk) :: filled(size(length))

      filled = after%aperture - after%void
      compressed = sum(length*filled*paths%settings%compressibility &
                       *(after%pressure - before%pressure))
      if (allocated(paths%settings%fluid_law)) then
         compressed = compressed + fluid_gained(paths%settings%fluid_law, cells, length, before, &
                                                after)
      end if
      filled = filled - (before%aperture - before%void)
      balance = balance + sum(length*filled) + compressed - dt*sum(after%injection)
      if (paths%joints%n == 0) return
      associate (supplied => paths%into_joints(after))
         balance = balance - dt*sum(supplied) + dt*paths%joints%outflow(after%branch_flow, supplied)
      end associate
   end subroutine add_fracture_balance

   !> What density has added to the fluid of the fractures, at that of the reference pressure [m2].
   pure real(rk) function fluid_gained(law, cells, length, before, after) result(gained)
      type(fluid_law_t), intent(in) :: law
      type(fracture_cells_t), intent(in) :: cells
      real(rk), intent(in) :: length(:)  !< (cells) [m]
      type(state_t), intent(in) :: before, after
      real(rk) :: density(2), in_situ, slope
      integer(ik) :: i

      gained = 0.0_rk
      if (.not. law%changes_density) return
      in_situ = 0.0_rk
      do i = 1, size(after%pressure, kind=ik)
         if (allocated(cells%pressure_in_situ)) in_situ = cells%pressure_in_situ(i)
         call law%density_at(before%pressure(i) + in_situ, density(1), slope)
         call law%density_at(after%pressure(i) + in_situ, density(2), slope)
         gained = gained + length(i)*((after%aperture(i) - after%void(i))*(density(2) - 1.0_rk) &
                                      - (before%aperture(i) - before%void(i))*(density(1) - 1.0_rk))
      end do
   end function fluid_gained

end module coarse_fluid_law
