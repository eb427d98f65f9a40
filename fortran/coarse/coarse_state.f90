!> The state of the coarse level at one time, and the properties of its fracture cells.
!!
!! The initial guess of the iteration of a time step: the last state, with all unknowns extrapolated
!! by their change in the last converged step. This is the previous step, or a trial of the same
!! step with other tips or another length.
!!
!! A point that slips lies on the bound of friction when a step begins, and rounding would determine
!! whether it continues to slip: with the guess it does.
module coarse_state
   use base_kinds, only: ik, rk
   use contact_law, only: contact_law_t
   implicit none(type, external)
   private

   public :: fracture_cells_t, go_back, guess_t, state_t, step_report_t

   !> Properties of the fracture cells.
   type :: fracture_cells_t
      type(contact_law_t), allocatable :: law(:)  !< (n)
      real(rk), allocatable :: residual_aperture(:)  !< a0 [m]
      real(rk), allocatable :: roughness(:)  !< part of a0 that conducts fluid but holds none [m]
      real(rk), allocatable :: share(:)  !< of the cell's length behind the tip [-]
      logical, allocatable :: has_tip(:)  !< whether a tip lies in the cell
      !> (n) of coarse_tip_layer where a tip lies in the cell; 0: no effect of viscosity [1/m^(1/2)]
      real(rk), allocatable :: viscous(:)
      !> (n) resistance between fluid and rock on each side, times the rock's mobility [-]
      real(rk), allocatable :: leak_resistance(:)
      !> (2, n) whether the side has a layer (coarse_layers); unallocated: none has
      logical, allocatable :: has_layer(:, :)
      real(rk), allocatable :: skin(:)  !< (n) on each face; unallocated: none has any [Pa s/m]
      real(rk), allocatable :: injection(:)  !< Q prescribed for the present step [m2/s]
      !> (n) pressure in situ, to which pressures are relative (coarse_in_situ); unallocated: 0 [Pa]
      real(rk), allocatable :: pressure_in_situ(:)
      !> (n) viscosity at the cell's temperature over that of the scene; unallocated: 1 [-]
      real(rk), allocatable :: viscosity_ratio(:)
   end type fracture_cells_t

   real(rk), parameter :: farthest = 4.0_rk  !< extrapolation, over the last step's length [-]

   !> The change of the unknowns in the last converged step.
   type :: guess_t
      real(rk) :: dt = 0.0_rk  !< [s]
      real(rk), allocatable :: change(:)  !< of the unknowns in that time [Pa]
   contains
      procedure :: forget
      procedure :: remember
      procedure :: is_known
      procedure :: from
   end type guess_t

   !> Unknowns and history of the coarse level at one time.
   type :: state_t
      real(rk) :: time = 0.0_rk  !< [s]
      !> (3, n_blocks) in blocks as in coarse_layout [m], [m], [Pa]
      real(rk), allocatable :: unknowns(:, :)
      !> (nodes, layers) of the inner nodes of layers (coarse_layers); unallocated: none [Pa]
      real(rk), allocatable :: layer(:, :)
      real(rk), allocatable :: content(:)  !< (n_cells) fluid content above the initial state [m2]
      real(rk), allocatable :: tractions(:)  !< of coarse_fields' corner_tractions [Pa]
      ! Fracture cells; at their two ends where the law of contact is fulfilled:
      real(rk), allocatable :: jump(:, :, :)  !< (2, 2, n) [u]_n, [u]_tau [m] at start, end
      real(rk), allocatable :: slip_before(:, :)  !< (2, n) [u]_tau at the last accepted time [m]
      !> (2, n) slip path; unallocated: no law depends on history [m]
      real(rk), allocatable :: slip_path(:, :)
      !> (2, n) largest opening so far, and before the last step; allocated like slip_path [m]
      real(rk), allocatable :: opened(:, :), opened_before(:, :)
      !> (2, 2, n) contact traction f_n, f_tau [Pa] at start, end
      real(rk), allocatable :: traction(:, :, :)
      integer(ik), allocatable :: contact(:, :)  !< (2, n) state_stick, state_slip, state_open
      real(rk), allocatable :: pressure(:)  !< (n) p_F [Pa]
      !> (n) a [m]; below a0 only in new cells that are not filled yet
      real(rk), allocatable :: aperture(:)
      !> (n) part of a filled by vapour, at the vapour pressure [m]
      real(rk), allocatable :: void(:)
      ! Flow along the fractures, of the pairs and branches of the mesh:
      real(rk), allocatable :: flow(:)  !< (pairs) from the first cell to the second [m2/s]
      real(rk), allocatable :: branch_flow(:)  !< (branches) into the joints [m2/s]
      real(rk), allocatable :: joint_pressure(:)  !< (joints) [Pa]
      ! Wells whose flow is an unknown; unallocated: there are none.
      !> Into the fracture, of all entries together; then those of the entries [m2/s]
      real(rk), allocatable :: well_flow(:)
      real(rk), allocatable :: well_head(:)  !< pressure at the head [Pa]
      real(rk), allocatable :: well_rate(:)  !< into the well at its head, mean of the step [m2/s]
      integer(ik), allocatable :: rock_well_control(:)  !< of coarse_wells: of those in rock
      !> (ring_count, all wells in the rock) of coarse_well_rings; unallocated: there are none [Pa]
      real(rk), allocatable :: rings(:, :)
      real(rk), allocatable :: injection(:)  !< (n) of wells into the cells in the last step [m2/s]
      real(rk), allocatable :: leakoff(:)  !< (n) flux into the rock, both sides [m/s]
      type(guess_t) :: guess  !< extrapolation to the next step
   end type state_t

   !> Result of a step besides the state.
   type :: step_report_t
      integer(ik) :: iterations = 0
      logical :: converged = .false.
      real(rk) :: contact_residual = 0.0_rk  !< relative to the largest traction [-]
      real(rk) :: condition = 0.0_rk  !< of the last Newton matrix, estimated; 0 without one [-]
      real(rk) :: error_bound = 0.0_rk  !< of the relative error of its jumps and pressures [-]
      real(rk) :: loop_flow_error = 0.0_rk  !< of flows round loops of fractures, relative [-]
      real(rk) :: stress_scale = 0.0_rk  !< [Pa]
      real(rk) :: mass_error = 0.0_rk  !< [m2]
      real(rk) :: compressed = 0.0_rk  !< fluid in fractures by compression [m2]
      real(rk) :: rock_outflow = 0.0_rk  !< fluid out of the rock through the boundary [m2]
      character(len=:), allocatable :: reason  !< reason of a failure
      integer(ik) :: cell = 0  !< fracture cell of the failure; 0: none
      logical :: is_drained = .false.  !< fluid is extracted that the cell lacks
   end type step_report_t

contains

   !> Forget the last step, since the unknowns have changed.
   pure subroutine forget(self)
      class(guess_t), intent(inout) :: self

      if (allocated(self%change)) deallocate (self%change)
   end subroutine forget

   !> Store the change of a converged step.
   pure subroutine remember(self, dt, start, x)
      class(guess_t), intent(inout) :: self
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: start(:), x(:)  !< unknowns before and after it [Pa]

      self%dt = dt
      self%change = x - start
   end subroutine remember

   !> Whether an extrapolation of n unknowns is possible.
   pure logical function is_known(self, n)
      class(guess_t), intent(in) :: self
      integer(ik), intent(in) :: n  !< unknowns

      is_known = allocated(self%change)
      if (is_known) is_known = size(self%change) == n
   end function is_known

   !> Extrapolate the unknowns over a step.
   pure function from(self, start, dt) result(x)
      class(guess_t), intent(in) :: self
      real(rk), intent(in) :: start(:)  !< [Pa]
      real(rk), intent(in) :: dt  !< [s]
      real(rk) :: x(size(start))  !< [Pa]

      x = start + min(dt/self%dt, farthest)*self%change
   end function from

   !> Restore the state before a step for another trial, except for the guess, which is that of the
   !! last trial.
   pure subroutine go_back(state, before)
      type(state_t), intent(inout) :: state
      type(state_t), intent(in) :: before
      type(guess_t) :: guess

      guess = state%guess
      state = before
      state%guess = guess
   end subroutine go_back

end module coarse_state
