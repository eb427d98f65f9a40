!> What the equations of one time step on the fractures are made of: the unknowns and their units,
!! the condensed body and its forces, the state before. The equations themselves are those of
!! contact (coarse_equations) and of the fluid (coarse_fracture_flow).
!!
!! All unknowns x and equations are scaled to Pa: jumps by a stiffness, flows and volumes by a unit.
module coarse_fractures
   use base_kinds, only: ik, rk
   use coarse_condensed, only: condensed_t
   use coarse_joints, only: joints_t
   use coarse_layout, only: fracture_layout, fracture_layout_t
   use coarse_state, only: fracture_cells_t, state_t
   use contact_dense, only: dense_system_t
   implicit none(type, external)
   private

   public :: cell_fluid_t, fracture_system_t, newton_settings_t, prepare

   !> What the iteration needs to know.
   type :: newton_settings_t
      real(rk) :: tolerance = 1.0e-9_rk  !< residuals relative to the largest stress [-]
      integer(ik) :: iterations_max = 30
      real(rk) :: viscosity = 0.0_rk  !< [Pa s]
      real(rk) :: mobility = 0.0_rk  !< of the rock, mean of K/mu [m2/(Pa s)]
      real(rk) :: compressibility = 0.0_rk  !< c_p [1/Pa]
      real(rk) :: young = 0.0_rk  !< [Pa]
      real(rk) :: vapour_pressure = -huge(1.0_rk)  !< that of the fluid is no less [Pa]
      !> initial state: no exchange, p_F = (p+ + p-)/2, no fluid balance
      logical :: equilibrate = .false.
   end type newton_settings_t

   !> One step's equations in scaled unknowns. What they are made of is referred to, not copied, and
   !! must outlive them. The points of contact are the starts and ends of the cells in turn.
   type, abstract, extends(dense_system_t) :: fracture_system_t
      type(condensed_t), pointer :: condensed => null()
      type(fracture_cells_t), pointer :: cells => null()
      integer(ik), pointer :: connections(:, :) => null()  !< (2, m) cells that exchange fluid
      type(joints_t), pointer :: joints => null()
      real(rk), pointer :: g(:) => null()  !< (6 n) load on the condensed system [N/m], [m2]
      type(state_t), pointer :: before => null()  !< at the last accepted time
      type(newton_settings_t) :: settings
      type(fracture_layout_t) :: layout  !< of x
      real(rk) :: dt = 0.0_rk  !< [s]
      real(rk) :: stiffness = 0.0_rk  !< jumps are multiplied by it [Pa/m]
      real(rk) :: unit = 0.0_rk  !< fluid volumes are divided by it [m2/Pa]
      real(rk) :: load_stress = 0.0_rk  !< traction of the faces without jumps and fluid [Pa]
      real(rk), allocatable :: q(:)  !< (6 n) unknowns of the condensed system [m], [Pa]
      real(rk), allocatable :: force(:)  !< (6 n) condensed forces S q - g [N/m], volumes [m2]
      !> (unknowns of the cells, 6 n) of the condensed forces [m], volumes [m2/Pa]
      real(rk), allocatable :: force_slope(:, :)
      real(rk), allocatable :: traction(:, :, :)  !< (2, 2, n) f_n, f_tau at start, end [Pa]
   contains
      procedure :: find_forces
      procedure :: is_balanced
      procedure :: opening
      procedure :: fluid_at
      procedure :: unknown_of_fluid
   end type fracture_system_t

   !> The fluid of a cell: it has the pressure that its unknown says, or where that is less than the
   !! vapour pressure it has this one, and the rest of the unknown says how wide the void is that
   !! vapour fills. So one of the two holds, p > p_v or a void, whatever the unknown.
   type :: cell_fluid_t
      real(rk) :: pressure = 0.0_rk  !< [Pa]
      real(rk) :: pressure_slope = 1.0_rk  !< by the unknown [-]
      real(rk) :: void = 0.0_rk  !< [m]
      real(rk) :: void_slope = 0.0_rk  !< by the unknown [m/Pa]
   end type cell_fluid_t

contains

   !> Units, and the part of the derivatives that does not change within the step.
   subroutine prepare(condensed, cells, connections, joints, settings, dt, g, before, eq)
      type(condensed_t), intent(in), target :: condensed
      type(fracture_cells_t), intent(in), target :: cells
      integer(ik), intent(in), target :: connections(:, :)  !< (2, m) cells that exchange fluid
      type(joints_t), intent(in), target :: joints
      type(newton_settings_t), intent(in) :: settings
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in), target :: g(:)  !< (6 n) load on the condensed system [N/m], [m2]
      type(state_t), intent(in), target :: before
      class(fracture_system_t), intent(out) :: eq
      real(rk) :: reference
      integer(ik) :: n, n_all, n_condensed

      n = condensed%n
      reference = sum(condensed%length)/real(n, rk)
      eq%condensed => condensed
      eq%cells => cells
      eq%connections => connections
      eq%joints => joints
      eq%g => g
      eq%before => before
      eq%settings = settings
      eq%layout = fracture_layout(n, size(connections, 2, kind=ik), joints%branch_count(), joints%n)
      eq%dt = dt
      eq%stiffness = settings%young/reference
      eq%unit = reference**2/settings%young
      eq%load_stress = stress_without_jumps(condensed, g)
      eq%state = reshape(before%contact, [2*n])
      n_all = eq%layout%count()
      n_condensed = condensed%layout%count()
      allocate (eq%way(2*n), source=0_ik)
      allocate (eq%q(n_condensed), eq%traction(2, 2, n))
      allocate (eq%residual(n_all), eq%jacobian(n_all, n_all))
      call find_slopes(eq)
   end subroutine prepare

   !> Derivatives of the condensed forces by the unknowns of the cells.
   subroutine find_slopes(eq)
      class(fracture_system_t), intent(inout) :: eq
      integer(ik) :: at, from, i, k

      allocate (eq%force_slope(eq%layout%cell_count(), eq%condensed%layout%count()), source=0.0_rk)
      associate (slope => eq%force_slope, stiffness => eq%condensed%stiffness)
         do i = 1, eq%condensed%n
            do k = 1, 2
               at = eq%layout%at_jump(i, k)
               from = eq%condensed%layout%at_jump(i, k)
               slope(at:at + 1, :) = stiffness(from:from + 1, :)/eq%stiffness
               at = eq%layout%at_face_pressure(i, k)
               from = eq%condensed%layout%at_face_pressure(i, k)
               slope(at, :) = stiffness(from, :)
            end do
         end do
      end associate
   end subroutine find_slopes

   !> The largest traction on the fractures if they had neither jumps nor fluid [Pa]: open faces
   !! without fluid carry none, and yet rounding errors are relative to what has been released
   !! there.
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
      integer(ik) :: at, from, i, k

      associate (condensed => self%condensed)
         do i = 1, condensed%n
            do k = 1, 2
               at = condensed%layout%at_jump(i, k)
               from = self%layout%at_jump(i, k)
               self%q(at:at + 1) = x(from:from + 1)/self%stiffness
               self%q(condensed%layout%at_face_pressure(i, k)) = &
                  x(self%layout%at_face_pressure(i, k))
            end do
         end do
         self%force = matmul(condensed%stiffness, self%q) - self%g
      end associate
   end subroutine find_forces

   !> Fluid that the step makes or loses is nothing beside what flows in it and what is there.
   logical function is_balanced(self)
      class(fracture_system_t), intent(in) :: self
      real(rk), parameter :: least = 1.0e-12_rk
      real(rk) :: balance, fluid
      integer(ik) :: at(2), i

      if (self%settings%equilibrate) then
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
      is_balanced = abs(balance) <= least*fluid
   end function is_balanced

   !> Opening of a cell, the mean of its ends' [u]_n.
   pure function opening(self, x, cell) result(mean)
      class(fracture_system_t), intent(in) :: self
      real(rk), intent(in) :: x(:)  !< [Pa]
      integer(ik), intent(in) :: cell
      real(rk) :: mean  !< [m]

      mean = 0.5_rk*(x(self%layout%at_jump(cell, 1)) + x(self%layout%at_jump(cell, 2))) &
             /self%stiffness
   end function opening

   !> The fluid of a cell.
   pure type(cell_fluid_t) function fluid_at(self, x, cell) result(fluid)
      class(fracture_system_t), intent(in) :: self
      real(rk), intent(in) :: x(:)  !< [Pa]
      integer(ik), intent(in) :: cell

      associate (settings => self%settings)
         fluid%pressure = x(self%layout%at_pressure(cell))
         if (settings%equilibrate .or. .not. fluid%pressure < settings%vapour_pressure) return
         fluid%void_slope = -1.0_rk/self%stiffness
         fluid%void = (fluid%pressure - settings%vapour_pressure)*fluid%void_slope
         fluid%pressure = settings%vapour_pressure
         fluid%pressure_slope = 0.0_rk
      end associate
   end function fluid_at

   !> The unknown that says so.
   pure real(rk) function unknown_of_fluid(self, pressure, void) result(unknown)
      class(fracture_system_t), intent(in) :: self
      real(rk), intent(in) :: pressure  !< [Pa]
      real(rk), intent(in) :: void  !< [m]

      unknown = pressure
      if (void > 0.0_rk) unknown = self%settings%vapour_pressure - void*self%stiffness
   end function unknown_of_fluid

end module coarse_fractures
