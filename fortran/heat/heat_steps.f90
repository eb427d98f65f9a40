!> Heat in a step of the coarse level, whose flows are constant in the step: substeps of two halves
!! of backward Euler, and a correction that makes them second order.
!!
!! The capacity H of an unknown follows the fluid that it takes in, dH/dt = - sum of f, so that
!! uniform temperatures stay uniform and no fluid is made of heat. In a half
!!   H_1 T_1 - H_0 T_0 + dt sum (a T_1 - b T_1') = 0
!! over the links of heat_links, with the multi-point fluxes of conduction. The unknown is the
!! change of T in the half, and its right-hand side contains differences of temperatures only:
!! what does not change is exact. Where the flows of a step take more fluid out of a fracture cell
!! than it has (the roughness of new cells is compressed but stores none), the rock next to it
!! supplies what is missing, and cells what is missing in a joint: H is never negative, and no heat
!! is lost. The limited temperatures at the ends of fracture cells are
!! iterated on the right-hand side. The matrix M is an M-matrix, which keeps temperatures between
!! those before and outside, as far as the multi-point fluxes are (no obtuse or cut cells).
!!
!! With the temperatures T_1, T_2 after the halves, those after the substep are T_2 - c,
!!   M c = H_2 (T_2 - T_1) - H_0 (T_1 - T_0):
!! second order, damps what is stiff (by (1 + y - y^2)/(1 + y)^3, y half a substep over the time of
!! a decay). If c would take a temperature out of its range, only a share of it counts everywhere.
!!
!! The heat that slopes along faces move (heat_slopes) is that at the beginning of each half, and
!! in c with the other sign: that in the middle of the substep. Where temperatures would leave their
!! range, the substep has none.
!!
!! One factorization, that of the second half, serves both halves and c. In the first half the
!! capacity that M has too much is iterated on the right-hand side. The heat r that the iteration
!! leaves over is taken from the second half and 2 r is added to that of c, so that both T_2 and c
!! conserve heat to rounding, however far it has come.
!!
!! Length of substeps: c shows the error of the halves, relative to the heat that has moved since
!! the start. Of the half-space cooled at its face a fifth of it is more than remains with c: 1e-4
!! of the heat at the default tolerance (test_heat_steps).
module heat_steps
   use algebra_mumps, only: mumps_minimum_fill, mumps_unsymmetric
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use coarse_diffusion, only: boundary_outflow
   use heat_links, only: coefficients, limited_terms
   use heat_model, only: heat_model_t
   use heat_state, only: heat_state_t
   implicit none(type, external)
   private

   public :: advance_heat

   !> A half of a substep, a step of backward Euler.
   type :: half_t
      real(rk) :: dt = 0.0_rk  !< [s]
      real(rk), allocatable :: capacity(:)  !< (unknowns) after it [J/(m K)]
      real(rk), allocatable :: temperature(:)  !< (unknowns) after it [K]
      real(rk), allocatable :: along(:)  !< (unknowns) heat by the slopes along faces [J/m]
   end type half_t

   real(rk), parameter :: beyond = 1.0e-7_rk  !< by which temperatures may leave their range [-]
   real(rk), parameter :: most = 2.0_rk, least = 0.2_rk  !< change of the length of substeps [-]

contains

   !> Advance the temperatures by a step of the coarse level, with the flows of set_flows.
   subroutine advance_heat(heat, dt, state, error)
      class(heat_model_t), intent(inout) :: heat
      real(rk), intent(in) :: dt  !< [s]
      type(heat_state_t), intent(inout) :: state
      type(error_t), allocatable, intent(out) :: error
      type(half_t) :: half(2)
      real(rk), allocatable :: after(:), correction(:)  ! (unknowns) [K]
      real(rk), allocatable :: produced(:, :)  ! (2, wells) capacity [J/(m K)] and heat [J/m]
      real(rk) :: left, ratio, share, shortest, substep
      real(rk), parameter :: tiny_step = 1.0e-7_rk

      allocate (produced(2, size(state%well_temperature)), source=0.0_rk)
      call widen_range(heat, state)
      call supply_missing(heat, dt, state%capacity)
      left = dt
      shortest = tiny_step*dt
      do while (left > 0.0_rk)
         substep = min(max(state%next, shortest), left)
         if (left - substep < 0.5_rk*substep) substep = merge(left, 0.5_rk*left, substep >= left)
         half%dt = 0.5_rk*substep
         call find(heat, state, half, correction, error)
         if (allocated(error)) return
         ratio = heat%heat%tolerance/max(step_error(heat, state, half(2), correction), &
                                         tiny(1.0_rk))
         if (ratio < 0.5_rk .and. substep > 2.0_rk*shortest) then
            state%next = substep*max(least, 0.9_rk*sqrt(ratio))
            cycle
         end if
         left = left - substep
         if (.not. left > epsilon(1.0_rk)*dt) left = 0.0_rk
         ! A substep that the end of the step has shortened does not shorten the next one.
         state%next = max(substep*min(most, 0.9_rk*sqrt(ratio)), &
                          merge(state%next, 0.0_rk, left <= 0.0_rk .and. ratio > 1.0_rk))
         share = share_in_range(heat, state, half(2)%temperature, correction)
         state%damped = state%damped + (1.0_rk - share)*substep**2
         after = half(2)%temperature - share*correction
         half(2)%along = half(2)%along + share*(half(2)%along - half(1)%along)
         ! Linear, so that of its time integral is the integral of what leaves the body.
         half(1)%temperature = 0.5_rk*((1.0_rk + share)*half(1)%temperature &
                                       + (1.0_rk - share)*half(2)%temperature - share*correction)
         half(2)%temperature = after
         call book(heat, substep, half, produced, state)
         call accept(heat, substep, half(2), state)
      end do
      call set_well_temperatures(heat, produced, state)
   end subroutine advance_heat

   !> Let the rock next to fracture cells, and cells at joints, supply the fluid that flows out of
   !! them in a step beyond what they have.
   pure subroutine supply_missing(heat, dt, capacity)
      class(heat_model_t), intent(inout) :: heat
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: capacity(:)  !< (unknowns) before the step [J/(m K)]
      real(rk) :: missing(heat%n)  ! [W/(m K)]
      integer(ik) :: c, f, k, l, side

      missing = -capacity/dt - gains(heat)
      do k = 1, size(heat%links, kind=ik)
         associate (link => heat%links(k), joint => heat%links(k)%ends(2))
            if (joint < heat%first_joint) cycle
            if (.not. missing(joint) > 0.0_rk) cycle
            link%flow = link%flow + missing(joint)
            missing(link%ends(1)) = missing(link%ends(1)) + missing(joint)
            missing(joint) = 0.0_rk
         end associate
      end do
      do c = heat%first_cell, heat%first_joint - 1
         if (.not. missing(c) > 0.0_rk) cycle
         do side = 1, 2
            f = heat%mesh%fracture%cell_faces(side, c - heat%first_cell + 1)
            heat%links(f)%flow = heat%links(f)%flow + 0.5_rk*missing(c)
            if (heat%layers%n == 0) cycle
            l = heat%mesh%face_layer(f)
            if (l == 0) cycle
            ! The links of a layer are numbered as its nodes.
            do k = heat%first_node(l), heat%last_node(l)
               associate (link => heat%links(heat%mesh%n_faces - heat%mesh%n_cells + k))
                  link%flow = link%flow + 0.5_rk*missing(c)
               end associate
            end do
         end do
      end do
   end subroutine supply_missing

   !> Gain of capacity by the flows [W/(m K)].
   pure function gains(heat) result(gain)
      class(heat_model_t), intent(in) :: heat
      real(rk) :: gain(heat%n)
      integer(ik) :: k

      gain = 0.0_rk
      do k = 1, size(heat%links, kind=ik)
         associate (link => heat%links(k))
            if (link%ends(1) > 0) gain(link%ends) = gain(link%ends) + link%flow*[-1.0_rk, 1.0_rk]
         end associate
      end do
      do k = 1, size(heat%externals, kind=ik)
         associate (external => heat%externals(k), i => heat%externals(k)%unknown)
            gain(i) = gain(i) + external%flow
         end associate
      end do
   end function gains

   !> Solve for the temperatures after each half of a substep, and for what those after it are too
   !! large.
   subroutine find(heat, state, half, correction, error)
      class(heat_model_t), intent(inout) :: heat
      type(heat_state_t), intent(in) :: state
      type(half_t), intent(inout) :: half(2)
      real(rk), allocatable, intent(out) :: correction(:)  !< (unknowns) [K]
      type(error_t), allocatable, intent(out) :: error
      real(rk), parameter :: converged = 1.0e-10_rk  ! change of iterated terms over the range
      real(rk) :: diagonal(heat%n), excess(heat%n)
      real(rk) :: nothing(heat%n), remainder(heat%n), rest(heat%n)
      integer :: k

      call factorize(heat, state%capacity, half, diagonal, error)
      if (allocated(error)) return
      excess = half(1)%capacity - state%capacity
      nothing = 0.0_rk
      do k = 1, 2
         half(1)%along = half(1)%dt*heat%along_faces(state%temperature)
         if (k == 2) half(1)%along = nothing
         call solve(heat, converged*(state%range(2) - state%range(1)), diagonal, &
                    state%temperature, excess, nothing, half(1), remainder, error)
         if (allocated(error)) return
         half(2)%along = half(2)%dt*heat%along_faces(half(1)%temperature)
         if (k == 2) half(2)%along = nothing
         call solve(heat, converged*(state%range(2) - state%range(1)), diagonal, &
                    half(1)%temperature, nothing, remainder, half(2), rest, error)
         if (allocated(error)) return
         ! Slopes of the beginning may take a front that has moved on out of its range.
         if (in_range(heat, state, half(1)) .and. in_range(heat, state, half(2))) exit
      end do
      correction = (half(2)%capacity*(half(2)%temperature - half(1)%temperature) &
                    - state%capacity*(half(1)%temperature - state%temperature) &
                    + 2.0_rk*(remainder - half(2)%along + half(1)%along))/diagonal
      call heat%matrix%solve(correction, error)
   end subroutine find

   !> Whether the temperatures after a half are in their range.
   pure logical function in_range(heat, state, half)
      class(heat_model_t), intent(in) :: heat
      type(heat_state_t), intent(in) :: state
      type(half_t), intent(in) :: half
      real(rk) :: slack

      slack = beyond*(state%range(2) - state%range(1))
      in_range = minval(half%temperature) >= state%range(1) - slack .and. &
                 maxval(half%temperature) <= state%range(2) + slack .or. has_sources(heat)
   end function in_range

   !> Solve for the temperatures after a half: the limited terms and the capacity that the matrix
   !! has too much are iterated.
   subroutine solve(heat, converged, diagonal, before, excess, taken, half, remainder, error)
      class(heat_model_t), intent(inout) :: heat
      real(rk), intent(in) :: converged  !< change of the iterated terms [K]
      real(rk), intent(in) :: diagonal(:)  !< (unknowns) of the matrix [J/(m K)]
      real(rk), intent(in) :: before(:)  !< (unknowns) [K]
      real(rk), intent(in) :: excess(:)  !< (unknowns) of capacity in the matrix [J/(m K)]
      real(rk), intent(in) :: taken(:)  !< (unknowns) heat [J/m]
      type(half_t), intent(inout) :: half
      real(rk), intent(out) :: remainder(:)  !< (unknowns) heat too much in the result [J/m]
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: iterations = 25
      real(rk), dimension(heat%n) :: added, change, last, rhs
      integer :: k

      rhs = supplied(heat, half%dt, before) + half%along - taken
      change = 0.0_rk
      last = huge(1.0_rk)
      do k = 1, iterations
         added = excess*change + half%dt &
                 *limited_terms(heat%links, heat%externals, heat%first_cell, heat%first_joint, &
                                before + change)
         if (all(abs(added - last) <= converged*diagonal)) exit
         remainder = excess*change
         last = added
         change = (rhs + added)/diagonal
         call heat%matrix%solve(change, error)
         if (allocated(error)) return
      end do
      remainder = remainder - excess*change
      half%temperature = before + change
   end subroutine solve

   !> The share of the correction that keeps temperatures in their range.
   pure real(rk) function share_in_range(heat, state, temperature, correction) result(share)
      class(heat_model_t), intent(in) :: heat
      type(heat_state_t), intent(in) :: state
      real(rk), intent(in) :: temperature(:), correction(:)  !< (unknowns) [K]
      integer(ik) :: i

      share = 1.0_rk
      if (has_sources(heat)) return
      associate (slack => beyond*(state%range(2) - state%range(1)))
         do i = 1, heat%n
            associate (t => temperature(i), c => correction(i))
               if (c > 0.0_rk) share = min(share, (max(t - state%range(1), 0.0_rk) + slack)/c)
               if (c < 0.0_rk) share = min(share, (max(state%range(2) - t, 0.0_rk) + slack)/(-c))
            end associate
         end do
      end associate
   end function share_in_range

   !> Whether heat is supplied, whose temperatures have no range.
   pure logical function has_sources(heat)
      class(heat_model_t), intent(in) :: heat

      has_sources = any(abs(heat%sides%heat_flux) > 0.0_rk) .or. allocated(heat%heat%source_power)
   end function has_sources

   !> Capacities after the halves, and the factors of the matrix of the second one, its rows scaled
   !! by their diagonals.
   subroutine factorize(heat, capacity, half, diagonal, error)
      class(heat_model_t), intent(inout) :: heat
      real(rk), intent(in) :: capacity(:)  !< (unknowns) before [J/(m K)]
      type(half_t), intent(inout) :: half(2)
      real(rk), intent(out) :: diagonal(:)  !< (unknowns) of the matrix [J/(m K)]
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: values(:)
      real(rk) :: ab(2), gain(heat%n)  ! (unknowns) of capacity in a half [J/(m K)]
      integer(ik) :: i, k

      if (.not. heat%matrix%active) then
         heat%matrix%ordering = mumps_minimum_fill  ! measured: a tenth faster
         call heat%matrix%analyse(heat%n, [(i, i=1, heat%n), heat%row, &
                                           (max(heat%links(k)%ends([1, 1, 2, 2]), 1_ik), &
                                            k=1, size(heat%links, kind=ik))], &
                                  [(i, i=1, heat%n), heat%col, &
                                   (max(heat%links(k)%ends([1, 2, 2, 1]), 1_ik), &
                                    k=1, size(heat%links, kind=ik))], mumps_unsymmetric, error)
         if (allocated(error)) return
      end if
      allocate (values(heat%matrix%id%nnz), source=0.0_rk)
      gain = half(2)%dt*gains(heat)
      associate (dt => half(2)%dt, links => values(heat%n + size(heat%row) + 1:))
         values(heat%n + 1:heat%n + size(heat%row)) = -dt*heat%conduction
         do k = 1, size(heat%links, kind=ik)
            associate (link => heat%links(k))
               if (link%ends(1) == 0) cycle
               ab = dt*coefficients(link%conductance, link%flow, link%conducts)
               links(4*k - 3:4*k) = [ab(1), -ab(2), ab(2), -ab(1)]
            end associate
         end do
         do k = 1, size(heat%externals, kind=ik)
            associate (external => heat%externals(k), i => heat%externals(k)%unknown)
               ab = dt*coefficients(external%conductance, external%flow, .true.)
               values(i) = values(i) + ab(2)
            end associate
         end do
      end associate
      ! Negative by rounding, or in a cell of rock.
      half(1)%capacity = max(capacity + gain, 0.0_rk)
      half(2)%capacity = max(half(1)%capacity + gain, 0.0_rk)
      values(:heat%n) = values(:heat%n) + half(2)%capacity
      diagonal = 0.0_rk
      associate (row => heat%matrix%id%irn, col => heat%matrix%id%jcn)
         do k = 1, size(values, kind=ik)
            if (row(k) == col(k)) diagonal(row(k)) = diagonal(row(k)) + values(k)
         end do
         values = values/diagonal(row)
      end associate
      call heat%matrix%factorize(values, error)
   end subroutine factorize

   !> Heat that flows into the unknowns at given temperatures, less that which uniform temperatures
   !! would bring with the fluid [J/m].
   pure function supplied(heat, dt, temperature) result(into)
      class(heat_model_t), intent(in) :: heat
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(in) :: temperature(:)  !< (unknowns) [K]
      real(rk) :: into(heat%n)
      real(rk) :: ab(2)
      integer(ik) :: k

      into = -heat%known
      do k = 1, size(heat%conduction, kind=ik)
         into(heat%row(k)) = into(heat%row(k)) + heat%conduction(k)*temperature(heat%col(k))
      end do
      do k = 1, size(heat%links, kind=ik)
         associate (link => heat%links(k))
            if (link%ends(1) == 0) cycle
            ab = coefficients(link%conductance, link%flow, link%conducts)
            into(link%ends) = into(link%ends) + (temperature(link%ends(1)) &
                                                 - temperature(link%ends(2)))*[-ab(2), ab(1)]
         end associate
      end do
      do k = 1, size(heat%externals, kind=ik)
         associate (external => heat%externals(k), i => heat%externals(k)%unknown)
            ab = coefficients(external%conductance, external%flow, .true.)
            into(i) = into(i) + ab(1)*(external%temperature - temperature(i))
         end associate
      end do
      into = dt*into
   end function supplied

   !> Error of a substep relative to the heat that has moved since the start, and at least to what
   !! rounding moves where the initial temperature is not uniform [-].
   pure real(rk) function step_error(heat, state, half, correction) result(error)
      class(heat_model_t), intent(in) :: heat
      type(heat_state_t), intent(in) :: state
      type(half_t), intent(in) :: half
      real(rk), intent(in) :: correction(:)  !< (unknowns) [K]
      real(rk), parameter :: remaining = 0.2_rk  ! of the correction
      real(rk), parameter :: rounding = 1.0e-9_rk  ! of the heat
      real(rk) :: moved

      error = 0.0_rk
      if (.not. allocated(state%rate)) return
      moved = max(sum(half%capacity*abs(half%temperature - heat%initial)), &
                  rounding*sum(half%capacity*abs(heat%initial)))
      if (.not. moved > 0.0_rk) return
      error = remaining*sum(half%capacity*abs(correction))/moved
   end function step_error

   !> Add the heat that a substep has moved.
   subroutine book(heat, dt, half, produced, state)
      class(heat_model_t), intent(in) :: heat
      real(rk), intent(in) :: dt  !< [s]
      type(half_t), intent(in) :: half(2)  !< mean temperatures, and those after it
      real(rk), intent(inout) :: produced(:, :)  !< (2, wells) [J/(m K)], [J/m]
      type(heat_state_t), intent(inout) :: state
      real(rk), parameter :: part = 1.0e-5_rk  ! of the heat, whose rounding would be seen
      real(rk) :: ab(2), by_sides, by_wells, passed
      integer(ik) :: k

      by_wells = 0.0_rk
      by_sides = -dt*boundary_outflow(heat%mesh, heat%regions, heat%regions%flux, &
                                      heat%scalars(half(1)%temperature)) &
                 + sum(half(1)%along) + sum(half(2)%along)
      if (allocated(heat%heat%source_power)) then
         by_sides = by_sides + dt*sum(heat%heat%source_power)
      end if
      state%moved = state%moved + abs(by_sides)
      do k = 1, size(heat%externals, kind=ik)
         associate (external => heat%externals(k), &
                    inside => half(1)%temperature(heat%externals(k)%unknown))
            ab = dt*coefficients(external%conductance, external%flow, .true.)
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
                        sum(half(2)%capacity*abs(half(2)%temperature - heat%initial)), &
                        part*sum(half(2)%capacity*abs(heat%initial)))
      state%by_wells = state%by_wells + by_wells
      state%by_sides = state%by_sides + by_sides
      state%stored = state%stored &
                     + sum(half(2)%capacity*(half(2)%temperature - state%temperature) &
                           + (half(2)%capacity - state%capacity)*state%temperature)
   end subroutine book

   !> Make a substep the present state.
   pure subroutine accept(heat, dt, half, state)
      class(heat_model_t), intent(in) :: heat
      real(rk), intent(in) :: dt  !< [s]
      type(half_t), intent(in) :: half
      type(heat_state_t), intent(inout) :: state
      real(rk) :: rate(heat%n)

      rate = (half%temperature - state%temperature)/dt
      if (allocated(state%rate)) state%bend = (rate - state%rate)/(dt + state%last)
      state%rate = rate
      state%last = dt
      state%temperature = half%temperature
      state%capacity = half%capacity
      if (has_sources(heat)) return
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
