!> Data of the equations of one time step on the fractures: unknowns and units, the condensed body
!! and its forces, the last state. The equations are those of contact (coarse_newton) and of the
!! fluid (coarse_fracture_flow).
!!
!! All unknowns x and equations are scaled to Pa: jumps by a stiffness, flows and volumes by a unit.
module coarse_fractures
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use coarse_condensed, only: condensed_t
   use coarse_joints, only: joints_t
   use coarse_layout, only: fracture_layout_t
   use coarse_slopes, only: slopes_t
   use coarse_state, only: fracture_cells_t, state_t
   use coarse_wells, only: wells_t
   use contact_newton, only: contact_system_t
   use scene_fluid_law, only: fluid_law_t
   implicit none(type, external)
   private

   public :: cell_fluid_t, conducting_aperture, flow_paths_t, fracture_system_t, most_of_rock
   public :: newton_settings_t, prepare

   !> Settings of the iteration, and constants of fluid and rock.
   type :: newton_settings_t
      real(rk) :: tolerance = 1.0e-9_rk  !< residuals relative to the largest stress [-]
      integer(ik) :: iterations_max = 30
      real(rk) :: viscosity = 0.0_rk  !< [Pa s]
      real(rk) :: mobility = 0.0_rk  !< of the rock, mean of K/mu [m2/(Pa s)]
      real(rk) :: compressibility = 0.0_rk  !< c_p [1/Pa]
      real(rk) :: young = 0.0_rk  !< [Pa]
      real(rk) :: vapour_pressure = -huge(1.0_rk)  !< least pressure of the fluid [Pa]
      real(rk) :: damping = 0.0_rk  !< eta of radiation damping [Pa s/m]
      !> initial state: no exchange, p_F = (p+ + p-)/2 but not below vapour, no fluid balance
      logical :: equilibrate = .false.
      !> unknowns from which those of faces are eliminated first; of fewer it costs milliseconds
      integer(ik) :: many = 1000
      type(fluid_law_t), allocatable :: fluid_law  !< pressure dependence, if any
   end type newton_settings_t

   !> Settings of a step, and where fluid flows along fractures.
   type :: flow_paths_t
      type(newton_settings_t) :: settings
      integer(ik), allocatable :: connections(:, :)  !< (2, m) neighbouring cells of one fracture
      type(joints_t) :: joints  !< intersections and outlets of fractures
      type(wells_t) :: wells  !< wells whose rate depends on pressures; set by the caller
   contains
      procedure :: into_joints
   end type flow_paths_t

   !> Equations of one step in scaled unknowns. Their data are referenced, not copied, and must
   !! outlive them. Contact points are the start and the end of each cell in turn.
   type, abstract, extends(contact_system_t) :: fracture_system_t
      type(condensed_t), pointer :: condensed => null()
      type(fracture_cells_t), pointer :: cells => null()
      type(flow_paths_t), pointer :: paths => null()  !< of this step
      real(rk), pointer :: g(:) => null()  !< (6 n) load on the condensed system [N/m], [m2]
      type(state_t), pointer :: before => null()  !< at the last accepted time
      type(fracture_layout_t) :: layout  !< of x
      real(rk) :: dt = 0.0_rk  !< [s]
      real(rk) :: unit = 0.0_rk  !< fluid volumes are divided by it [m2/Pa]
      real(rk), allocatable :: lowest(:)  !< (n) vapour pressure less that in situ [Pa]
      real(rk) :: load_stress = 0.0_rk  !< traction of the faces without jumps and fluid [Pa]
      real(rk), allocatable :: q(:)  !< (6 n) unknowns of the condensed system [m], [Pa]
      real(rk), allocatable :: force(:)  !< (6 n) condensed forces S q - g [N/m], volumes [m2]
      logical :: has_failed = .false.  !< whether a solution with the factors of the body has failed
      type(slopes_t) :: slopes  !< derivatives of the residuals where last evaluated
      logical :: is_flat = .false.  !< of the slopes by apertures (coarse_fracture_flow)
      real(rk), allocatable :: start(:)  !< unknowns where the step starts [Pa]
      !> (2, n) of the volume through side +, - by the pressure there; where a tip needs it [m2/Pa]
      real(rk), allocatable :: volume_slope(:, :)
      !> Share of the rock's pressure in that of the fluid, in the initial state; the remaining
      !! share is that of held_pressure
      real(rk) :: share_of_rock = 1.0_rk
      real(rk), allocatable :: held_pressure(:)  !< (n) with a share below 1 [Pa]
      !> Replace the contact equations by zero tractions
      logical :: is_without_contact = .false.
   contains
      procedure :: at_point
      procedure :: find_forces
      procedure :: size_of_terms
      procedure :: is_balanced
      procedure :: opening
      procedure :: fluid_at
      procedure :: unknown_of_fluid
      procedure :: in_situ_at
      procedure :: viscosity_at
      procedure :: find_thickness
   end type fracture_system_t

   !> Fluid of a cell as a function of its unknown: the unknown is the pressure, or, below the
   !! vapour pressure p_v, the pressure is p_v and the difference gives the width of the void filled
   !! by vapour. In the initial state, which has no fluid balance, there is no void.
   type :: cell_fluid_t
      real(rk) :: pressure = 0.0_rk  !< [Pa]
      real(rk) :: pressure_slope = 1.0_rk  !< by the unknown [-]
      real(rk) :: void = 0.0_rk  !< [m]
      real(rk) :: void_slope = 0.0_rk  !< by the unknown [m/Pa]
   end type cell_fluid_t

   !> Largest reduction of the rock's resistance to leak-off at a tip, as a share of this resistance
   !! [-].
   real(rk), parameter :: most_of_rock = 0.8_rk

contains

   !> Set the units and all data that are constant within the step.
   subroutine prepare(condensed, cells, paths, dt, g, before, eq)
      type(condensed_t), intent(inout), target :: condensed
      type(fracture_cells_t), intent(in), target :: cells
      type(flow_paths_t), intent(in), target :: paths  !< of this step
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in), target :: g(:)  !< (6 n) load on the condensed system [N/m], [m2]
      type(state_t), intent(in), target :: before
      class(fracture_system_t), intent(out) :: eq
      real(rk) :: reference
      integer(ik) :: i, n, n_condensed

      n = condensed%n
      reference = sum(condensed%length)/real(n, rk)
      eq%condensed => condensed
      eq%cells => cells
      eq%paths => paths
      eq%g => g
      eq%before => before
      eq%layout = fracture_layout_t(n_cells=n, per_cell=7_ik, &
                                    n_flows=size(paths%connections, 2, kind=ik), &
                                    n_branches=paths%joints%branch_count(), &
                                    n_wells=paths%wells%n + paths%wells%n_entries, &
                                    n_joints=paths%joints%n)
      eq%dt = dt
      eq%stiffness = paths%settings%young/reference
      eq%unit = reference**2/paths%settings%young
      allocate (eq%lowest(n), source=paths%settings%vapour_pressure)
      if (allocated(cells%pressure_in_situ)) eq%lowest = eq%lowest - cells%pressure_in_situ
      eq%load_stress = stress_without_jumps(condensed, g)
      eq%state = reshape(before%contact, [2*n])
      eq%slip_before = reshape(before%jump(2, :, :), [2*n])
      allocate (eq%law, source=[(cells%law((i + 1)/2), i=1, 2*n)])
      if (allocated(before%slip_path)) then
         eq%law = eq%law%aged(reshape(before%slip_path, [2*n]), reshape(before%opened, [2*n]))
      end if
      allocate (eq%slip_sign(2*n), source=0_ik)
      n_condensed = condensed%layout%count()
      allocate (eq%q(n_condensed), eq%force(n_condensed), eq%traction(2, 2*n))
      allocate (eq%residual(eq%layout%count()))
      call link_unknowns(eq)
      call find_volume_slopes(eq)
   end subroutine prepare

   !> Find the unknowns of q among those of x, and their units.
   pure subroutine link_unknowns(eq)
      class(fracture_system_t), intent(inout) :: eq
      integer(ik) :: at, i, k

      associate (of_q => eq%condensed%layout, of_x => eq%layout, slopes => eq%slopes)
         allocate (slopes%x_of_q(of_q%count()))
         allocate (slopes%q_per_x(of_q%count()), source=1.0_rk)
         do i = 1, eq%condensed%n
            do k = 1, 2
               at = of_q%at_jump(i, k)
               slopes%x_of_q(at:at + 1) = of_x%at_jump(i, k) + [0_ik, 1_ik]
               slopes%q_per_x(at:at + 1) = 1.0_rk/eq%stiffness
               slopes%x_of_q(of_q%at_face_pressure(i, k)) = of_x%at_face_pressure(i, k)
            end do
         end do
      end associate
   end subroutine link_unknowns

   !> Derivatives of the leak-off of the faces by their pressures, which limit the correction of
   !! leak-off at tips; in the initial state for all faces, as units of the equations.
   !!
   !! With all other unknowns fixed, the derivative is larger than with the response of the rock,
   !! and known without a solution: where it does not limit the correction, the exact one does not
   !! either.
   subroutine find_volume_slopes(eq)
      class(fracture_system_t), intent(inout) :: eq
      type(error_t), allocatable :: error
      integer(ik), allocatable :: cells(:)
      real(rk), allocatable :: slope(:)
      integer(ik) :: i, side

      allocate (eq%volume_slope(2, eq%condensed%n))
      associate (condensed => eq%condensed, slopes => eq%volume_slope)
         do side = 1, 2
            cells = [(i, i=1, condensed%n)]
            associate (at => condensed%layout%at_face_pressure(cells, side))
               if (.not. condensed%is_full) then
                  slopes(side, :) = condensed%coupling%diagonal(at)
                  if (eq%paths%settings%equilibrate) cycle
                  cells = pack(cells, is_beyond(eq%cells%leak_resistance, &
                                                eq%paths%settings%mobility*eq%dt, slopes(side, :)))
               end if
            end associate
            allocate (slope(size(cells)))
            call condensed%find_volume_slopes(condensed%layout%at_face_pressure(cells, side), &
                                              slope, error)
            eq%has_failed = eq%has_failed .or. allocated(error)
            slopes(side, cells) = slope
            deallocate (slope)
         end do
      end associate
   end subroutine find_volume_slopes

   !> Whether the correction of leak-off at a tip exceeds the limit `most_of_rock`.
   elemental logical function is_beyond(leak_resistance, rock, slope)
      real(rk), intent(in) :: leak_resistance  !< times the rock's mobility [-]
      real(rk), intent(in) :: rock  !< mobility times the step [m2/Pa]
      real(rk), intent(in) :: slope  !< of the rock's volume by the pressure [m2/Pa]

      is_beyond = leak_resistance*abs(slope) < -most_of_rock*rock
   end function is_beyond

   !> Largest traction on the fractures without jumps and fluid [Pa]. Open faces without fluid carry
   !! none, but rounding errors are relative to the traction released there.
   pure function stress_without_jumps(condensed, g) result(stress)
      type(condensed_t), intent(in) :: condensed
      real(rk), intent(in) :: g(:)  !< (6 n) [N/m], [m2]
      real(rk) :: stress  !< [Pa]

      integer(ik) :: at, end, i

      stress = 0.0_rk
      do i = 1, condensed%n
         do end = 1, 2
            at = condensed%layout%at_jump(i, end)
            stress = max(stress, maxval(abs(g(at:at + 1)))/(0.5_rk*condensed%length(i)))
         end do
      end do
   end function stress_without_jumps

   !> Unknowns and forces of the condensed system at x.
   subroutine find_forces(self, x)
      class(fracture_system_t), intent(inout) :: self
      real(rk), intent(in) :: x(:)  !< [Pa]
      type(error_t), allocatable :: error

      self%q = x(self%slopes%x_of_q)*self%slopes%q_per_x
      call self%condensed%find_forces(self%q, self%force, error)
      self%has_failed = self%has_failed .or. allocated(error)
      self%force = self%force - self%g
   end subroutine find_forces

   !> The sum of the sizes of a residual's terms. Where the condensed matrix is not formed, forces
   !! are sums over the cells around.
   pure function size_of_terms(self, x, row) result(total)
      class(fracture_system_t), intent(in) :: self
      real(rk), intent(in) :: x(:)  !< [Pa]
      integer(ik), intent(in) :: row  !< number of the residual
      real(rk) :: total  !< [Pa]
      real(rk) :: slope(size(x))
      integer(ik) :: k, m

      slope = 0.0_rk
      associate (slopes => self%slopes, condensed => self%condensed)
         do k = 1, slopes%n_local
            if (slopes%row(k) == row) slope(slopes%col(k)) = slope(slopes%col(k)) + slopes%value(k)
         end do
         total = 0.0_rk
         do m = 1, size(slopes%force, 1)
            if (slopes%force(m, row) == 0) cycle
            if (condensed%is_full) then
               associate (stiffness => condensed%stiffness, force => slopes%force(m, row))
                  if (stiffness%place(force) == 0) cycle
                  associate (x => slopes%x_of_q(stiffness%kept), &
                             per_x => slopes%q_per_x(stiffness%kept))
                     slope(x) = slope(x) + slopes%weight(m, row)*per_x &
                                *stiffness%entry(:, stiffness%place(force))
                  end associate
               end associate
            else
               total = total + abs(slopes%weight(m, row)) &
                       *condensed%coupling%sizes(condensed%rock, self%q, slopes%force(m, row))
            end if
         end do
      end associate
      total = total + dot_product(abs(slope), abs(x))
   end function size_of_terms

   !> Whether the error of the fluid balance is negligible compared with the fluid that flows or is
   !! stored.
   logical function is_balanced(self)
      class(fracture_system_t), intent(in) :: self
      real(rk), parameter :: least = 1.0e-12_rk
      real(rk) :: balance, fluid
      integer(ik) :: at(2), i

      if (self%paths%settings%equilibrate) then
         is_balanced = .true.
         return
      end if
      balance = 0.0_rk
      fluid = 0.0_rk
      do i = 1, self%condensed%n
         at = self%condensed%layout%at_face_pressure(i, [1_ik, 2_ik])
         balance = balance + self%residual(self%layout%at_pressure(i))*self%unit
         fluid = fluid + self%condensed%length(i)*self%before%aperture(i) &
                 + self%dt*abs(self%cells%injection(i)) + sum(abs(self%force(at)))
      end do
      do i = 1, self%paths%joints%n
         ! The equations of outlets and of joints with only shut branches are not balances.
         if (self%paths%joints%is_outlet(i)) cycle
         if (all(self%paths%joints%is_shut(self%paths%joints%branches%of(i)))) cycle
         balance = balance + self%residual(self%layout%at_joint(i))*self%unit
         fluid = fluid + self%dt*abs(self%paths%joints%injection(i))
      end do
      do i = 1, self%paths%wells%n
         fluid = fluid + abs(self%paths%wells%rate(i))*self%dt
      end do
      is_balanced = abs(balance) <= least*fluid
   end function is_balanced

   !> The number of the unknown [u]_n of a point of contact.
   pure integer(ik) function at_point(self, point)
      class(fracture_system_t), intent(in) :: self
      integer(ik), intent(in) :: point

      at_point = self%layout%at_jump((point + 1)/2, 2 - mod(point, 2_ik))
   end function at_point

   !> What wells supply to the joints in the step to a state [m2/s].
   pure function into_joints(self, state) result(flow)
      class(flow_paths_t), intent(in) :: self
      type(state_t), intent(in) :: state
      real(rk) :: flow(self%joints%n)

      flow = self%joints%injection
      if (self%wells%n > 0 .and. self%joints%n > 0) then
         flow = flow + matmul(self%wells%joint_share, self%wells%at_places(state%well_flow))
      end if
   end function into_joints

   !> Opening of a cell, the mean of its ends' [u]_n.
   pure function opening(self, x, cell) result(mean)
      class(fracture_system_t), intent(in) :: self
      real(rk), intent(in) :: x(:)  !< [Pa]
      integer(ik), intent(in) :: cell
      real(rk) :: mean  !< [m]

      mean = 0.5_rk*(x(self%layout%at_jump(cell, 1)) + x(self%layout%at_jump(cell, 2))) &
             /self%stiffness
   end function opening

   !> Fluid of a cell at x.
   pure type(cell_fluid_t) function fluid_at(self, x, cell) result(fluid)
      class(fracture_system_t), intent(in) :: self
      real(rk), intent(in) :: x(:)  !< [Pa]
      integer(ik), intent(in) :: cell

      associate (lowest => self%lowest(cell))
         fluid%pressure = x(self%layout%at_pressure(cell))
         if (.not. fluid%pressure < lowest) return
         if (.not. self%paths%settings%equilibrate) then
            fluid%void_slope = -1.0_rk/self%stiffness
            fluid%void = (fluid%pressure - lowest)*fluid%void_slope
         end if
         fluid%pressure = lowest
         fluid%pressure_slope = 0.0_rk
      end associate
   end function fluid_at

   !> The unknown of a cell for a pressure and a void, inverse to fluid_at.
   pure real(rk) function unknown_of_fluid(self, cell, pressure, void) result(unknown)
      class(fracture_system_t), intent(in) :: self
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: pressure  !< [Pa]
      real(rk), intent(in) :: void  !< [m]

      unknown = pressure
      if (void > 0.0_rk) unknown = self%lowest(cell) - void*self%stiffness
   end function unknown_of_fluid

   !> Pressure in situ of a cell, to which pressures are relative [Pa].
   pure real(rk) function in_situ_at(self, cell) result(pressure)
      class(fracture_system_t), intent(in) :: self
      integer(ik), intent(in) :: cell

      pressure = 0.0_rk
      if (allocated(self%cells%pressure_in_situ)) pressure = self%cells%pressure_in_situ(cell)
   end function in_situ_at

   !> Viscosity in a cell, without its change by pressure [Pa s].
   pure real(rk) function viscosity_at(self, cell) result(viscosity)
      class(fracture_system_t), intent(in) :: self
      integer(ik), intent(in) :: cell

      viscosity = self%paths%settings%viscosity
      if (allocated(self%cells%viscosity_ratio)) then
         viscosity = viscosity*self%cells%viscosity_ratio(cell)
      end if
   end function viscosity_at

   !> mu/(mu_0 r) of the fluid law in a cell, for the flow between its middle and a well at its end,
   !! and the derivative by the unknown of the pressure.
   pure subroutine find_thickness(self, x, cell, thickness, slope)
      class(fracture_system_t), intent(in) :: self
      real(rk), intent(in) :: x(:)  !< [Pa]
      integer(ik), intent(in) :: cell
      real(rk), intent(out) :: thickness  !< [-]
      real(rk), intent(out) :: slope  !< [1/Pa]
      type(cell_fluid_t) :: fluid

      fluid = self%fluid_at(x, cell)
      associate (law => self%paths%settings%fluid_law, &
                 pressure => fluid%pressure + self%in_situ_at(cell))
         thickness = law%thickness_at(pressure)
         slope = law%thickness_slope(pressure)*fluid%pressure_slope
      end associate
   end subroutine find_thickness

   !> Hydraulic aperture. Roughness is the least aperture, and does not add to larger openings;
   !! overlapping faces in the iteration keep a hundredth of a0.
   pure subroutine conducting_aperture(residual, roughness, opening, aperture, slope)
      real(rk), intent(in) :: residual  !< a0 [m]
      real(rk), intent(in) :: roughness  !< the part of it that is one [m]
      real(rk), intent(in) :: opening  !< [u]_n [m]
      real(rk), intent(out) :: aperture  !< [m]
      real(rk), intent(out) :: slope  !< its derivative by [u]_n [-]
      real(rk) :: least

      aperture = residual - roughness + opening
      least = merge(residual, 0.01_rk*residual, roughness > 0.0_rk)
      slope = 1.0_rk
      if (.not. aperture > least) then
         aperture = least
         slope = 0.0_rk
      end if
   end subroutine conducting_aperture

end module coarse_fractures
