!> The equations of one time step on the fractures: contact, cubic law, exchange with the rock,
!! fluid mass.
!!
!! Unknowns per fracture cell: [u]_n, [u]_tau at its start, p+, [u]_n, [u]_tau at its end, p-, p_F;
!! and a flow per pair of neighbours along a fracture. The law of contact holds at both ends of a
!! cell. The flow is an unknown of its own because the pressure difference that drives it along an
!! open fracture is far below the rounding of the pressures. All unknowns and equations are scaled
!! to Pa.
module coarse_equations
   use base_kinds, only: ik, rk
   use coarse_condensed, only: condensed_t
   use coarse_state, only: fracture_cells_t, state_t
   use contact_law, only: contact_equations, contact_law_t
   use contact_newton, only: contact_system_t
   implicit none(type, external)
   private

   public :: equations_t, newton_settings_t, per_cell, prepare

   integer(ik), parameter :: per_cell = 7  !< unknowns of a cell

   !> What the iteration needs to know.
   type :: newton_settings_t
      real(rk) :: tolerance = 1.0e-9_rk  !< residuals relative to the largest stress [-]
      integer(ik) :: iterations_max = 30
      real(rk) :: viscosity = 0.0_rk  !< [Pa s]
      real(rk) :: compressibility = 0.0_rk  !< c_p [1/Pa]
      real(rk) :: young = 0.0_rk  !< [Pa]
      !> initial state: no exchange, p_F = (p+ + p-)/2, no fluid balance
      logical :: equilibrate = .false.
   end type newton_settings_t

   !> One step's equations in scaled unknowns. What they are made of is referred to, not copied, and
   !! must outlive them. The points of contact are the starts and ends of the cells in turn.
   type, extends(contact_system_t) :: equations_t
      type(condensed_t), pointer :: condensed => null()
      type(fracture_cells_t), pointer :: cells => null()
      integer(ik), pointer :: connections(:, :) => null()  !< (2, m) cells that exchange fluid
      real(rk), pointer :: g(:) => null()  !< (6 n) load on the condensed system
      type(state_t), pointer :: before => null()  !< at the last accepted time
      type(newton_settings_t) :: settings
      real(rk) :: dt = 0.0_rk  !< [s]
      real(rk) :: stiffness = 0.0_rk  !< jumps are multiplied by it [Pa/m]
      real(rk) :: unit = 0.0_rk  !< fluid volumes are divided by it [m2/Pa]
      real(rk) :: load_stress = 0.0_rk  !< traction of the faces without jumps and fluid [Pa]
      real(rk), allocatable :: force_slope(:, :)  !< (7 n, 6 n) of the condensed forces
      real(rk), allocatable :: force(:)  !< (6 n) condensed forces S q - g
      real(rk), allocatable :: q(:)  !< (6 n) unknowns of the condensed system
      real(rk), allocatable :: traction(:, :, :)  !< (2, 2, n) f_n, f_tau at start, end [Pa]
   contains
      procedure :: evaluate
   end type equations_t

contains

   !> Units, and the part of the derivatives that does not change within the step.
   subroutine prepare(condensed, cells, connections, settings, dt, g, before, eq)
      type(condensed_t), intent(in), target :: condensed
      type(fracture_cells_t), intent(in), target :: cells
      integer(ik), intent(in), target :: connections(:, :)
      type(newton_settings_t), intent(in) :: settings
      real(rk), intent(in) :: dt
      real(rk), intent(in), target :: g(:)
      type(state_t), intent(in), target :: before
      type(equations_t), intent(out) :: eq

      real(rk) :: reference
      integer(ik) :: i, n, n_all

      n = condensed%n
      n_all = per_cell*n + size(connections, 2)
      reference = sum(condensed%length)/real(n, rk)
      eq%condensed => condensed
      eq%cells => cells
      eq%connections => connections
      eq%g => g
      eq%before => before
      eq%settings = settings
      eq%dt = dt
      eq%stiffness = settings%young/reference
      eq%unit = reference**2/settings%young
      eq%load_stress = stress_without_jumps(condensed, g)
      eq%state = reshape(before%contact, [2*n])
      allocate (eq%way(2*n), source=0_ik)
      allocate (eq%q(6*n), eq%traction(2, 2, n))
      allocate (eq%residual(n_all), eq%jacobian(n_all, n_all))
      allocate (eq%force_slope(per_cell*n, 6*n), source=0.0_rk)
      do i = 1, n
         eq%force_slope(7*i - 6:7*i - 1, :) = condensed%stiffness(6*i - 5:6*i, :)
         eq%force_slope([7*i - 6, 7*i - 5, 7*i - 3, 7*i - 2], :) = &
            eq%force_slope([7*i - 6, 7*i - 5, 7*i - 3, 7*i - 2], :)/eq%stiffness
      end do
   end subroutine prepare

   !> The largest traction on the fractures if they had neither jumps nor fluid [Pa]: open faces
   !! without fluid carry none, and yet rounding errors are relative to what has been released
   !! there.
   pure function stress_without_jumps(condensed, g) result(stress)
      type(condensed_t), intent(in) :: condensed
      real(rk), intent(in) :: g(:)  !< (6 n)
      real(rk) :: stress

      integer(ik) :: i

      stress = 0.0_rk
      do i = 1, condensed%n
         stress = max(stress, maxval(abs(g(6*i - [5, 4, 2, 1])))/(0.5_rk*condensed%length(i)))
      end do
   end function stress_without_jumps

   !> Residuals [Pa] and their derivatives at x.
   subroutine evaluate(self, x)
      class(equations_t), intent(inout) :: self
      real(rk), intent(in) :: x(:)

      integer(ik) :: end, i, k

      associate (condensed => self%condensed, q => self%q)
         do i = 1, condensed%n
            q(6*i - 5:6*i) = x(7*i - 6:7*i - 1)
            q([6*i - 5, 6*i - 4, 6*i - 2, 6*i - 1]) = q([6*i - 5, 6*i - 4, 6*i - 2, 6*i - 1]) &
                                                      /self%stiffness
         end do
         self%force = matmul(condensed%stiffness, q) - self%g
         self%jacobian = 0.0_rk
         do i = 1, condensed%n
            do end = 1, 2
               call contact_rows(self%cells%law(i), i, end, 0.5_rk*condensed%length(i), &
                                 self%before%jump(2, end, i), x, self)
            end do
            if (self%settings%equilibrate) then
               call equilibrium_rows(i, x, self)
            else
               call exchange_rows(self%cells, self%settings, i, condensed%length(i), x, self)
               call balance_row(self%cells, self%settings, i, condensed%length(i), self%before, &
                                x, self)
            end if
         end do
         do k = 1, size(self%connections, 2)
            call flow_row(condensed, self%cells, self%connections(:, k), &
                          per_cell*condensed%n + k, self%settings, x, self)
         end do
         self%stress_scale = max(maxval(abs(self%traction)), &
                                 maxval(abs(x(7:per_cell*condensed%n:7))), self%load_stress, &
                                 1.0_rk)
      end associate
   end subroutine evaluate

   !> The two contact equations at one end of cell i.
   pure subroutine contact_rows(law, i, end, half_length, slip_before, x, eq)
      type(contact_law_t), intent(in) :: law
      integer(ik), intent(in) :: i, end
      real(rk), intent(in) :: half_length, slip_before, x(:)
      class(equations_t), intent(inout) :: eq

      real(rk) :: by_traction(2, 2), by_jump(2, 2)
      integer(ik) :: at, k, m, n, point, row

      n = size(eq%force_slope, 1)
      at = 6*i - 5 + 3*(end - 1)
      row = 7*i - 6 + 3*(end - 1)
      point = 2*(i - 1) + end
      eq%traction(:, end, i) = [x(7*i), 0.0_rk] - eq%force(at:at + 1)/half_length
      call contact_equations(law, eq%stiffness, eq%traction(:, end, i), eq%q(at:at + 1), &
                             slip_before, eq%way(point), eq%state(point), &
                             eq%residual(row:row + 1), by_traction, by_jump)
      do k = 1, 2
         associate (slope => eq%jacobian(:, row + k - 1))
            do m = 1, 2
               if (abs(by_traction(k, m)) > 0.0_rk) slope(:n) = slope(:n) &
                                       - by_traction(k, m)/half_length*eq%force_slope(:, at + m - 1)
            end do
            slope(7*i) = slope(7*i) + by_traction(k, 1)
            slope(row:row + 1) = slope(row:row + 1) + by_jump(k, :)/eq%stiffness
         end associate
      end do
   end subroutine contact_rows

   !> Opening of cell i, the mean of its ends' [u]_n [m].
   pure function opening(x, i, stiffness) result(mean)
      real(rk), intent(in) :: x(:)
      integer(ik), intent(in) :: i
      real(rk), intent(in) :: stiffness
      real(rk) :: mean

      mean = 0.5_rk*(x(7*i - 6) + x(7*i - 3))/stiffness
   end function opening

   !> Flux between the rock and the fracture on both sides: lambda = (kappa/mu)(p - p_F)/(a/2),
   !! kappa = a^2/12.
   pure subroutine exchange_rows(cells, settings, i, length, x, eq)
      type(fracture_cells_t), intent(in) :: cells
      type(newton_settings_t), intent(in) :: settings
      integer(ik), intent(in) :: i
      real(rk), intent(in) :: length, x(:)
      class(equations_t), intent(inout) :: eq

      real(rk) :: aperture, conductance, slope, volume
      integer(ik) :: n, row, side

      n = size(eq%force_slope, 1)
      call conducting_aperture(cells%residual_aperture(i), opening(x, i, eq%stiffness), aperture, &
                               slope)
      conductance = eq%dt*length*aperture/(6.0_rk*settings%viscosity)
      do side = 1, 2
         row = 7*i - 7 + 3*side
         volume = eq%force(6*i - 6 + 3*side)
         eq%residual(row) = volume/conductance - (x(row) - x(7*i))
         eq%jacobian(:n, row) = eq%force_slope(:, 6*i - 6 + 3*side)/conductance
         eq%jacobian([7*i - 6, 7*i - 3], row) = eq%jacobian([7*i - 6, 7*i - 3], row) &
                                           - 0.5_rk*volume/(conductance*aperture)*slope/eq%stiffness
         eq%jacobian(row, row) = eq%jacobian(row, row) - 1.0_rk
         eq%jacobian(7*i, row) = eq%jacobian(7*i, row) + 1.0_rk
      end do
   end subroutine exchange_rows

   !> Fluid balance of cell i (model.md section 3), without the flow along the fracture.
   pure subroutine balance_row(cells, settings, i, length, state, x, eq)
      type(fracture_cells_t), intent(in) :: cells
      type(newton_settings_t), intent(in) :: settings
      integer(ik), intent(in) :: i
      real(rk), intent(in) :: length, x(:)
      type(state_t), intent(in) :: state
      class(equations_t), intent(inout) :: eq

      real(rk) :: aperture, compression
      integer(ik) :: n, row

      n = size(eq%force_slope, 1)
      row = 7*i
      aperture = cells%residual_aperture(i) + opening(x, i, eq%stiffness)
      compression = settings%compressibility*(x(row) - state%pressure(i))
      eq%residual(row) = (length*(aperture - state%aperture(i) + aperture*compression) &
                          - eq%force(6*i - 3) - eq%force(6*i) - eq%dt*cells%injection(i))/eq%unit
      eq%jacobian(:n, row) = -(eq%force_slope(:, 6*i - 3) + eq%force_slope(:, 6*i))/eq%unit
      eq%jacobian([7*i - 6, 7*i - 3], row) = eq%jacobian([7*i - 6, 7*i - 3], row) &
                                       + 0.5_rk*length*(1.0_rk + compression)/(eq%stiffness*eq%unit)
      eq%jacobian(row, row) = eq%jacobian(row, row) &
                              + length*aperture*settings%compressibility/eq%unit
   end subroutine balance_row

   !> Initial state: nothing flows, and the fracture has the pressure of the rock around it.
   pure subroutine equilibrium_rows(i, x, eq)
      integer(ik), intent(in) :: i
      real(rk), intent(in) :: x(:)
      class(equations_t), intent(inout) :: eq

      real(rk) :: conductance
      integer(ik) :: at, row, side

      do side = 1, 2
         row = 7*i - 7 + 3*side
         at = 6*i - 6 + 3*side
         conductance = abs(eq%force_slope(row, at))
         eq%residual(row) = eq%force(at)/conductance
         eq%jacobian(:size(eq%force_slope, 1), row) = eq%force_slope(:, at)/conductance
      end do
      row = 7*i
      eq%residual(row) = x(row) - 0.5_rk*(x(row - 4) + x(row - 1))
      eq%jacobian(row, row) = 1.0_rk
      eq%jacobian([row - 4, row - 1], row) = -0.5_rk
   end subroutine equilibrium_rows

   !> Flow from the first to the second cell of a pair: cubic law, two-point.
   pure subroutine flow_row(condensed, cells, pair, row, settings, x, eq)
      type(condensed_t), intent(in) :: condensed
      type(fracture_cells_t), intent(in) :: cells
      integer(ik), intent(in) :: pair(2), row
      type(newton_settings_t), intent(in) :: settings
      real(rk), intent(in) :: x(:)
      class(equations_t), intent(inout) :: eq

      real(rk) :: aperture, resistance, slope
      integer(ik) :: k

      associate (first => 7*pair(1), second => 7*pair(2))
         eq%residual(row) = x(second) - x(first)
         do k = 1, 2
            associate (i => pair(k))
               call conducting_aperture(cells%residual_aperture(i), opening(x, i, eq%stiffness), &
                                        aperture, slope)
               resistance = 6.0_rk*settings%viscosity*condensed%length(i)/aperture**3*eq%unit/eq%dt
               eq%residual(row) = eq%residual(row) + resistance*x(row)
               eq%jacobian(row, row) = eq%jacobian(row, row) + resistance
               eq%jacobian([7*i - 6, 7*i - 3], row) = -1.5_rk*resistance*x(row)/aperture*slope &
                                                      /eq%stiffness
            end associate
         end do
         eq%jacobian(first, row) = -1.0_rk
         eq%jacobian(second, row) = 1.0_rk
         eq%residual(first) = eq%residual(first) + x(row)
         eq%residual(second) = eq%residual(second) - x(row)
         eq%jacobian(row, first) = 1.0_rk
         eq%jacobian(row, second) = -1.0_rk
      end associate
   end subroutine flow_row

   !> Aperture that conducts fluid; iterates with closed or overlapping faces keep a hundredth of
   !! a0.
   pure subroutine conducting_aperture(residual, opening, aperture, slope)
      real(rk), intent(in) :: residual, opening  !< a0, [u]_n [m]
      real(rk), intent(out) :: aperture, slope  !< [m], and its derivative by [u]_n

      aperture = residual + opening
      slope = 1.0_rk
      if (.not. aperture > 0.01_rk*residual) then
         aperture = 0.01_rk*residual
         slope = 0.0_rk
      end if
   end subroutine conducting_aperture

end module coarse_equations
