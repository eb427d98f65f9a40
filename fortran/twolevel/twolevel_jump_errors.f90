!> Estimated errors in space of slip and opening of the fracture cells: those by the sizes of the
!! cells (report_jump_errors), apart for the zones that slip and those that open, and what errors of
!! the pressure change: by 4/E' times sqrt(d1 d2) of opening per pressure, d1 and d2 the distances
!! from the ends of the zone, and of slip per pressure times friction.
!!
!! Faces that slide past a kink open there, in a length that cells do not resolve, and some at the
!! ends of a zone that slides. A closed joint has its largest differences of closure where it ends.
!! Faces in contact may move in part of what remains of the error of their traction, the difference
!! from the neighbours and the error of the pressure, beyond their distance from sliding or opening.
module twolevel_jump_errors
   use base_kinds, only: ik, rk
   use coarse_state, only: state_t
   use contact_law, only: state_open, state_slip, state_stick
   use mesh_types, only: fracture_mesh_t
   use report_jump_errors, only: by_crossings, finite_volumes, jump_errors_t, &
                                 relative_jump_errors, unevenness
   use scene_types, only: material_t
   use twolevel_problem, only: coarse_problem_t
   use twolevel_results, only: cell_states
   implicit none(type, external)
   private

   public :: jump_facts_t, jumps_in_space_t

   !> opening of faces that slide past a kink, over slip times sine, in the cells there and in the
   !! mean of them [-]
   real(rk), parameter :: past_kink = 0.35_rk, mean_past_kink = 0.06_rk
   !> opening over the error of slip of closed faces; error of tractions over differences from
   !! neighbours; share of what may move by it (chosen with five drawn states) [-]
   real(rk), parameter :: at_end = 0.03_rk, of_neighbours = 1.5_rk, of_loose = 0.3_rk

   !> What the errors need besides the state.
   type :: jump_facts_t
      real(rk) :: of_length = 0.0_rk  !< relative error of the length of growing fractures [-]
      real(rk) :: less = 0.0_rk  !< relative error of openings that is none at a given volume [-]
      !> share of the fluid that has leaked off: its error acts on the opening [-]
      real(rk) :: diffusing = 1.0_rk
      real(rk), allocatable :: of_pressure(:)  !< (cells) error in space of the pressure [Pa]
      real(rk), allocatable :: of_first(:)  !< (cells) its part of the first pressure [Pa]
   end type jump_facts_t

   !> (fracture cells)
   type :: jumps_in_space_t
      type(jump_errors_t) :: slip, opening  !< of their zones
      real(rk), allocatable :: n(:), t(:)  !< mean opening, magnitude of the mean slip [m]
      real(rk), allocatable :: error_n(:), error_t(:)  !< their errors [m]
      !> error of the uniform pressure that opens the faces like their openings [Pa]
      real(rk), allocatable :: net_error(:)
      real(rk) :: volume = 0.0_rk  !< error of the sum of openings [m2]
      real(rk) :: loosened = 0.0_rk  !< what faces in contact may open by more [m2]
      real(rk) :: slipped = 0.0_rk  !< error of the sum of slip [m2]
   contains
      procedure :: find
      procedure :: mean_share
   end type jumps_in_space_t

contains

   !> Errors of a state.
   subroutine find(self, material, problem, state, facts)
      class(jumps_in_space_t), intent(out) :: self
      type(material_t), intent(in) :: material
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(jump_facts_t), intent(in) :: facts
      real(rk), dimension(size(state%pressure)) :: length, moved, n, opened, slid
      real(rk) :: compliance, loose(size(state%pressure), 2)
      logical :: is_open(size(state%pressure))

      self%n = 0.5_rk*sum(state%jump(1, :, :), dim=1)
      self%t = abs(0.5_rk*sum(state%jump(2, :, :), dim=1))
      n = max(0.0_rk, self%n)
      is_open = cell_states(state) == state_open
      moved = merge(hypot(n, self%t), n, is_open)
      compliance = 4.0_rk/material%young
      if (.not. material%plane_stress) compliance = compliance*(1.0_rk - material%poisson**2)
      associate (fracture => problem%mesh%fracture)
         length = fracture%cell_s(2, :) - fracture%cell_s(1, :)
         self%slip = relative_jump_errors(fracture, moves(self%t), finite_volumes)
         self%opening = relative_jump_errors(fracture, moves(n), finite_volumes)
         opened = compliance*self%opening%reach*(facts%diffusing*facts%of_pressure &
                                                 + (1.0_rk - facts%diffusing)*facts%of_first)
         where (.not. is_open) opened = 0.0_rk
         allocate (self%net_error(size(n)), source=0.0_rk)
         where (self%opening%reach > 0.0_rk)
            self%net_error = self%opening%of_sum*n/(compliance*self%opening%reach)
         end where
         slid = compliance*self%slip%reach*facts%of_pressure*problem%model%cells%law%friction
         where (cell_states(state) /= state_slip) slid = 0.0_rk
         self%error_t = (self%slip%of_slip + facts%of_length)*merge(moved, self%t, is_open) + slid &
                        + at_ends(fracture, moves(self%t), self%t) &
                        + by_crossings(fracture, moves(self%t), self%t, finite_volumes)
         self%error_n = (self%opening%share + facts%of_length - facts%less)*moved + opened &
                        + at_ends(fracture, moves(n), n) + past_kink*self%slip%kink*self%t
         opened = (self%opening%of_sum + facts%of_length)*n + opened &
                  + mean_past_kink*self%slip%kink*self%t
         where (self%n < 0.0_rk)
            self%error_n = self%error_n + unevenness(fracture, self%n) + finite_volumes%rest &
                           *abs(self%n)
            opened = opened + self%error_n
         end where
         loose = of_loose*compliance*may_move(problem, state, facts%of_pressure)
         where (.not. is_open) loose(:, 1) = loose(:, 1) + at_end*self%slip%of_slip*self%t
         self%error_t = self%error_t + loose(:, 2)
         self%error_n = self%error_n + loose(:, 1)
         self%loosened = sum(length*loose(:, 1))
         slid = slid + loose(:, 2)
         self%volume = sum(length*opened)
         self%slipped = sum(length*((self%slip%of_slip_sum + facts%of_length) &
                                    *merge(moved, self%t, is_open) + slid))
      end associate
   end subroutine find

   !> Mean relative error of the sums over zones, weighted by the jumps [-].
   pure real(rk) function mean_share(self, length) result(share)
      class(jumps_in_space_t), intent(in) :: self
      real(rk), intent(in) :: length(:)  !< (fracture cells) [m]

      associate (n => length*abs(self%n), t => length*self%t)
         share = sum(n*self%opening%of_sum + t*self%slip%of_sum)/max(sum(n + t), tiny(1.0_rk))
      end associate
   end function mean_share

   !> Faces of each cell have moved.
   pure function moves(jump)
      real(rk), intent(in) :: jump(:)  !< [m]
      logical :: moves(size(jump))
      real(rk), parameter :: rounding = 1.0e-9_rk

      moves = jump > rounding*maxval(jump)
   end function moves

   !> Tractions by which cells in contact may lack contact, and stick, times the reach of the zone
   !! that would move then (report_jump_errors) [Pa m].
   function may_move(problem, state, of_pressure) result(loose)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk), intent(in) :: of_pressure(:)  !< (cells) its error [Pa]
      real(rk) :: loose(size(of_pressure), 2)
      type(jump_errors_t) :: zone
      real(rk) :: error(size(of_pressure)), normal(size(of_pressure)), shear(size(of_pressure))
      integer :: i

      normal = -0.5_rk*sum(state%traction(1, :, :), dim=1)
      shear = 0.5_rk*sum(state%traction(2, :, :), dim=1)
      associate (fracture => problem%mesh%fracture, states => cell_states(state), &
                 friction => problem%model%cells%law%friction)
         error = of_neighbours*unevenness(fracture, normal) + of_pressure
         loose(:, 1) = merge(0.0_rk, max(0.0_rk, error - normal), states == state_open)
         error = friction*error + of_neighbours*unevenness(fracture, shear)
         loose(:, 2) = merge(max(0.0_rk, error - (friction*normal - abs(shear))), 0.0_rk, &
                             states == state_stick)
         do i = 1, 2
            zone = relative_jump_errors(fracture, loose(:, i) > 0.0_rk, finite_volumes)
            loose(:, i) = loose(:, i)*zone%reach
         end do
      end associate
   end function may_move

   !> Half of the jump next to a cell whose faces have not moved: the zone may end in it [m].
   pure function at_ends(fracture, moved, jump) result(error)
      type(fracture_mesh_t), intent(in) :: fracture
      logical, intent(in) :: moved(:)
      real(rk), intent(in) :: jump(:)  !< [m]
      real(rk) :: error(size(jump))
      integer(ik) :: i, k, next

      error = 0.0_rk
      do i = 1, fracture%n_cells
         if (moved(i)) cycle
         do k = -1, 1, 2
            next = i + k
            if (next < 1 .or. next > fracture%n_cells) cycle
            if (fracture%cell_fracture(next) /= fracture%cell_fracture(i)) cycle
            error(i) = max(error(i), 0.5_rk*abs(jump(next)))
         end do
      end do
   end function at_ends

end module twolevel_jump_errors
