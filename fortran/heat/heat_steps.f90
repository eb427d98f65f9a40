!> Heat in a step of the coarse level, whose flows are constant in the step: backward Euler in
!! substeps.
!!
!! The capacity H of an unknown follows the fluid that it takes in, dH/dt = - sum of f, so that
!! uniform temperatures stay uniform and no fluid is made of heat. In a substep
!!   H_1 T_1 - H_0 T_0 + dt sum (a T_1 - b T_1') = 0
!! over the links of heat_links, with the multi-point fluxes of conduction. The unknown is the
!! change of T in the substep, and its right-hand side contains differences of temperatures only:
!! what does not change is exact. The limited temperatures at the ends of fracture cells are
!! iterated on the right-hand side. The matrix is an M-matrix, which keeps temperatures between
!! those before and outside, as far as the multi-point fluxes are (no obtuse or cut cells).
!!
!! Length of substeps: the change of the rate from one substep to the next shows their error,
!! relative to the heat that has moved since the start.
module heat_steps
   use algebra_mumps, only: mumps_unsymmetric
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use coarse_diffusion, only: boundary_outflow
   use heat_links, only: coefficients, external_t, limited, link_t
   use heat_model, only: heat_model_t
   use heat_state, only: heat_state_t
   implicit none(type, external)
   private

   public :: advance_heat

   !> A substep in which the system is solved.
   type :: substep_t
      real(rk) :: dt = 0.0_rk  !< [s]
      real(rk), allocatable :: capacity(:)  !< (unknowns) after it [J/(m K)]
      real(rk), allocatable :: diagonal(:)  !< (unknowns) of the matrix [J/(m K)]
      real(rk), allocatable :: rhs(:)  !< (unknowns) without the limited terms [J/m]
      real(rk), allocatable :: temperature(:)  !< (unknowns) after it [K]
   end type substep_t

   real(rk), parameter :: most = 2.0_rk, least = 0.2_rk  !< change of the length of substeps [-]

contains

   !> Advance the temperatures by a step of the coarse level, with the flows of set_flows.
   subroutine advance_heat(heat, dt, state, error)
      class(heat_model_t), intent(inout) :: heat
      real(rk), intent(in) :: dt  !< [s]
      type(heat_state_t), intent(inout) :: state
      type(error_t), allocatable, intent(out) :: error
      type(substep_t) :: substep
      real(rk), allocatable :: produced(:, :)  ! (2, wells) capacity [J/(m K)] and heat [J/m]
      real(rk) :: left, ratio, shortest
      real(rk), parameter :: tiny_step = 1.0e-7_rk

      allocate (produced(2, size(state%well_temperature)), source=0.0_rk)
      call widen_range(heat, state)
      left = dt
      shortest = tiny_step*dt
      do while (left > 0.0_rk)
         substep%dt = min(max(state%next, shortest), left)
         if (left - substep%dt < 0.5_rk*substep%dt) substep%dt = merge(left, 0.5_rk*left, &
            & substep%dt >= left)
         call solve(heat, state, substep, error)
         if (allocated(error)) return
         ratio = heat%heat%tolerance/max(step_error(heat, state, substep), tiny(1.0_rk))
         if (ratio < 0.5_rk .and. substep%dt > 2.0_rk*shortest) then
            state%next = substep%dt*max(least, 0.9_rk*sqrt(ratio))
            cycle
         end if
         left = left - substep%dt
         if (.not. left > epsilon(1.0_rk)*dt) left = 0.0_rk
         ! A substep that the end of the step has shortened does not shorten the next one.
         state%next = max(substep%dt*min(most, 0.9_rk*sqrt(ratio)), &
                          merge(state%next, 0.0_rk, left <= 0.0_rk .and. ratio > 1.0_rk))
         call book(heat, substep, produced, state)
         call accept(heat, substep, state)
      end do
      call set_well_temperatures(heat, produced, state)
   end subroutine advance_heat

   !> Solve for the temperatures after a substep.
   subroutine solve(heat, state, substep, error)
      class(heat_model_t), intent(inout) :: heat
      type(heat_state_t), intent(in) :: state
      type(substep_t), intent(inout) :: substep
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: iterations = 25
      real(rk), parameter :: converged = 1.0e-12_rk  ! change of the limited terms
      real(rk), allocatable :: limited_before(:), values(:), x(:, :)
      integer :: k

      call assemble(heat, state, substep, values)
      call factorize(heat, substep, values, error)
      if (allocated(error)) return
      allocate (x(heat%n, 1))
      substep%temperature = state%temperature
      do k = 1, iterations
         associate (limited => limited_terms(heat, substep)/substep%diagonal)
            if (k > 1) then
               if (all(abs(limited - limited_before) <= converged*(state%range(2) &
                                                                   - state%range(1)))) return
            end if
            x(:, 1) = substep%rhs/substep%diagonal + limited
            limited_before = limited
         end associate
         call heat%matrix%solve(x, error)
         if (allocated(error)) return
         substep%temperature = state%temperature + x(:, 1)
         if (.not. any(heat%links%is_limited)) return
      end do
   end subroutine solve

   !> Matrix, in the order of `factorize`, and right-hand side of a substep.
   subroutine assemble(heat, state, substep, values)
      class(heat_model_t), intent(in) :: heat
      type(heat_state_t), intent(in) :: state
      type(substep_t), intent(inout) :: substep
      real(rk), allocatable, intent(out) :: values(:)
      real(rk) :: ab(2)
      integer(ik) :: at, k

      substep%capacity = state%capacity
      substep%rhs = -substep%dt*heat%known
      allocate (values(heat%n + size(heat%conduction) + 4*size(heat%links)), source=0.0_rk)
      at = heat%n
      associate (dt => substep%dt, before => state%temperature, diagonal => values(:heat%n))
         do k = 1, size(heat%conduction, kind=ik)
            values(at + k) = -dt*heat%conduction(k)
            substep%rhs(heat%row(k)) = substep%rhs(heat%row(k)) &
                                       + dt*heat%conduction(k)*before(heat%col(k))
         end do
         at = at + size(heat%conduction, kind=ik)
         do k = 1, size(heat%links, kind=ik)
            associate (link => heat%links(k))
               if (link%ends(1) == 0) cycle
               ab = dt*coefficients(link%conductance, link%flow, link%conducts)
               values(at + 4*k - 3:at + 4*k) = [ab(1), -ab(2), ab(2), -ab(1)]
               substep%capacity(link%ends) = substep%capacity(link%ends) &
                                             + dt*link%flow*[-1.0_rk, 1.0_rk]
               substep%rhs(link%ends) = substep%rhs(link%ends) &
                                        + (before(link%ends(1)) - before(link%ends(2))) &
                                        *[-ab(2), ab(1)]
            end associate
         end do
         do k = 1, size(heat%externals, kind=ik)
            associate (external => heat%externals(k), i => heat%externals(k)%unknown)
               ab = dt*coefficients(external%conductance, external%flow, .true.)
               diagonal(i) = diagonal(i) + ab(2)
               substep%capacity(i) = substep%capacity(i) + dt*external%flow
               substep%rhs(i) = substep%rhs(i) + ab(1)*(external%temperature - before(i))
            end associate
         end do
         ! Flows of another step, as for a step to come, may take out more fluid than there is.
         substep%capacity = max(substep%capacity, 0.0_rk)
         diagonal = diagonal + substep%capacity
      end associate
   end subroutine assemble

   !> Factorize the matrix with its rows scaled by their diagonals.
   subroutine factorize(heat, substep, values, error)
      class(heat_model_t), intent(inout) :: heat
      type(substep_t), intent(inout) :: substep
      real(rk), intent(inout) :: values(:)
      type(error_t), allocatable, intent(out) :: error
      integer(ik), allocatable :: col(:), row(:)
      integer(ik) :: i, k

      allocate (row(size(values)), col(size(values)))
      row(:heat%n) = [(i, i=1, heat%n)]
      col(:heat%n) = row(:heat%n)
      row(heat%n + 1:heat%n + size(heat%row)) = heat%row
      col(heat%n + 1:heat%n + size(heat%row)) = heat%col
      i = heat%n + size(heat%row, kind=ik)
      do k = 1, size(heat%links, kind=ik)
         associate (ends => max(heat%links(k)%ends, 1_ik))
            row(i + 1:i + 4) = ends([1, 1, 2, 2])
            col(i + 1:i + 4) = ends([1, 2, 2, 1])
         end associate
         i = i + 4
      end do
      substep%diagonal = spread(0.0_rk, 1, int(heat%n))
      do k = 1, size(values, kind=ik)
         if (row(k) == col(k)) substep%diagonal(row(k)) = substep%diagonal(row(k)) + values(k)
      end do
      values = values/substep%diagonal(row)
      if (.not. heat%matrix%active) then
         call heat%matrix%analyse(heat%n, row, col, mumps_unsymmetric, error)
         if (allocated(error)) return
      end if
      call heat%matrix%factorize(values, error)
   end subroutine factorize

   !> What the limited temperatures add to the upwind flow along fractures [J/m].
   pure function limited_terms(heat, substep) result(added)
      class(heat_model_t), intent(in) :: heat
      type(substep_t), intent(in) :: substep
      real(rk) :: added(heat%n)
      real(rk) :: ahead, beyond(2, heat%n), into(2, heat%n), passed
      integer(ik) :: k, next, own

      added = 0.0_rk
      if (.not. any(heat%links%is_limited)) return
      into = 0.0_rk
      beyond = 0.0_rk
      do k = 1, size(heat%links, kind=ik)
         associate (link => heat%links(k), temperature => substep%temperature)
            if (.not. link%is_limited) cycle
            call find_direction(link, own, next)
            into(:, next) = into(:, next) + abs(link%flow)*[1.0_rk, temperature(own)]
            beyond(:, own) = beyond(:, own) + abs(link%flow)*[1.0_rk, temperature(next)]
         end associate
      end do
      do k = 1, size(heat%externals, kind=ik)
         associate (external => heat%externals(k))
            if (external%unknown < heat%first_cell .or. external%flow < 0.0_rk) cycle
            into(:, external%unknown) = into(:, external%unknown) &
                                        + external%flow*[1.0_rk, external%temperature]
         end associate
      end do
      do k = 1, size(heat%links, kind=ik)
         associate (link => heat%links(k))
            if (.not. link%is_limited) cycle
            call find_direction(link, own, next)
            if (own >= heat%first_joint .or. .not. into(1, own) > 0.0_rk) cycle
            associate (before => into(2, own)/into(1, own), here => substep%temperature(own))
               ahead = substep%temperature(next)
               if (next >= heat%first_joint) then
                  ! The cells behind the joint; at an outlet the temperature goes on as before.
                  ahead = 2.0_rk*here - before
                  if (beyond(1, next) > 0.0_rk) ahead = beyond(2, next)/beyond(1, next)
               end if
               passed = substep%dt*abs(link%flow)*limited(before, here, ahead)
            end associate
            added([own, next]) = added([own, next]) + passed*[-1.0_rk, 1.0_rk]
         end associate
      end do
   end function limited_terms

   !> The unknown that a link takes fluid from, and the other one.
   pure subroutine find_direction(link, own, next)
      type(link_t), intent(in) :: link
      integer(ik), intent(out) :: own, next

      own = link%ends(merge(1, 2, link%flow >= 0.0_rk))
      next = sum(link%ends) - own
   end subroutine find_direction

   !> Error of a substep relative to the heat that has moved since the start [-].
   pure real(rk) function step_error(heat, state, substep) result(error)
      class(heat_model_t), intent(in) :: heat
      type(heat_state_t), intent(in) :: state
      type(substep_t), intent(in) :: substep
      real(rk) :: moved

      error = 0.0_rk
      if (.not. allocated(state%rate)) return
      moved = sum(substep%capacity*abs(substep%temperature - heat%initial))
      if (.not. moved > 0.0_rk) return
      error = sum(substep%capacity*abs(substep%temperature - state%temperature &
                                       - substep%dt*state%rate)) &
              /moved*substep%dt/(substep%dt + state%last)
   end function step_error

   !> Add the heat that a substep has moved.
   subroutine book(heat, substep, produced, state)
      class(heat_model_t), intent(in) :: heat
      type(substep_t), intent(in) :: substep
      real(rk), intent(inout) :: produced(:, :)  !< (2, wells) [J/(m K)], [J/m]
      type(heat_state_t), intent(inout) :: state
      real(rk) :: ab(2), by_sides, by_wells, passed
      integer(ik) :: k

      by_wells = 0.0_rk
      by_sides = -substep%dt*boundary_outflow(heat%mesh, heat%regions, heat%regions%flux, &
                                              heat%scalars(substep%temperature))
      if (allocated(heat%heat%source_power)) then
         by_sides = by_sides + substep%dt*sum(heat%heat%source_power)
      end if
      state%moved = state%moved + abs(by_sides)
      do k = 1, size(heat%externals, kind=ik)
         associate (external => heat%externals(k), &
                    inside => substep%temperature(heat%externals(k)%unknown))
            ab = substep%dt*coefficients(external%conductance, external%flow, .true.)
            passed = ab(1)*external%temperature - ab(2)*inside
            state%moved = state%moved + abs(passed)
            if (external%well == 0) then
               by_sides = by_sides + passed
            else
               by_wells = by_wells + passed
               if (external%flow > 0.0_rk) cycle
               associate (of_well => produced(:, external%well))
                  of_well = of_well + ab(2)*[1.0_rk, inside]
               end associate
            end if
         end associate
      end do
      state%moved = max(state%moved, &
                        sum(substep%capacity*abs(substep%temperature - heat%initial)))
      state%by_wells = state%by_wells + by_wells
      state%by_sides = state%by_sides + by_sides
      state%stored = state%stored &
                     + sum(substep%capacity*(substep%temperature - state%temperature) &
                           + (substep%capacity - state%capacity)*state%temperature)
   end subroutine book

   !> Make a substep the present state.
   pure subroutine accept(heat, substep, state)
      class(heat_model_t), intent(in) :: heat
      type(substep_t), intent(in) :: substep
      type(heat_state_t), intent(inout) :: state
      real(rk) :: rate(heat%n)

      rate = (substep%temperature - state%temperature)/substep%dt
      if (allocated(state%rate)) state%bend = (rate - state%rate)/(substep%dt + state%last)
      state%rate = rate
      state%last = substep%dt
      state%temperature = substep%temperature
      state%capacity = substep%capacity
      if (any(abs(heat%sides%heat_flux) > 0.0_rk) .or. allocated(heat%heat%source_power)) return
      state%beyond_range = max(state%beyond_range, state%range(1) - minval(state%temperature), &
                               maxval(state%temperature) - state%range(2))
   end subroutine accept

   !> Widen the range of temperatures by those that act from outside in a step.
   pure subroutine widen_range(heat, state)
      class(heat_model_t), intent(in) :: heat
      type(heat_state_t), intent(inout) :: state
      integer(ik) :: k

      do k = 1, size(heat%externals, kind=ik)
         associate (external => heat%externals(k))
            if (.not. (external%flow > 0.0_rk .or. external%conductance > 0.0_rk)) cycle
            state%range = [min(state%range(1), external%temperature), &
                           max(state%range(2), external%temperature)]
         end associate
      end do
      do k = 1, size(heat%sides, kind=ik)
         if (.not. heat%sides(k)%temperature_given) cycle
         state%range = [min(state%range(1), heat%sides(k)%temperature), &
                        max(state%range(2), heat%sides(k)%temperature)]
      end do
   end subroutine widen_range

   !> Temperatures of the wells: of what they take out in the step, else of what they supply.
   pure subroutine set_well_temperatures(heat, produced, state)
      class(heat_model_t), intent(in) :: heat
      real(rk), intent(in) :: produced(:, :)  !< (2, wells) [J/(m K)], [J/m]
      type(heat_state_t), intent(inout) :: state
      integer(ik) :: k

      do k = 1, size(heat%externals, kind=ik)
         associate (external => heat%externals(k))
            if (external%well > 0) state%well_temperature(external%well) = external%temperature
         end associate
      end do
      where (produced(1, :) > 0.0_rk) state%well_temperature = produced(2, :)/produced(1, :)
   end subroutine set_well_temperatures

end module heat_steps
