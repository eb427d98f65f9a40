!> Errors of temperatures that fluid carries along fractures. Where a front is thinner than the
!! cells behind the layers, these take up heat too early or too late: uncertain is what the mean of
!! a cell differs from the value at its place (heat_errors), and 2.5 times as much of the flow into
!! them (a row of cells in one dimension: 2 to 4 times). The share is that of the heat in the cells
!! at a fracture cell, or of what they lack to its temperature, whichever is less. What the fluid
!! loses in the cell is wrong by this share. Farther on the error decays as the rise of the
!! temperature does: d' = -(h/f) d + share (h/f) T, with the flow f and the exchange h with rock at
!! rest. What flows less than the rock conducts carries nothing: f/(f + lambda) of both counts.
module heat_carried_errors
   use base_kinds, only: ik, rk
   use heat_links, only: find_direction
   use heat_model, only: heat_model_t
   use heat_state, only: heat_state_t
   implicit none(type, external)
   private

   public :: carried_errors

contains

   !> Errors of fracture cells and joints.
   pure function carried_errors(heat, state, wrong) result(error)
      class(heat_model_t), intent(in) :: heat
      type(heat_state_t), intent(in) :: state
      real(rk), intent(in) :: wrong(:)  !< (cells) of their temperatures [K]
      real(rk) :: error(heat%first_cell:heat%n)  !< [K]
      real(rk), parameter :: steady = 1.0e-3_rk  !< change of a sweep, of the largest error [-]
      real(rk), dimension(heat%first_cell:heat%n) :: decay, drop, flow, mixed
      real(rk) :: into(heat%first_cell:heat%n), last(heat%first_cell:heat%n)
      integer(ik), allocatable :: along(:)  ! links between fracture cells and joints
      real(rk) :: conducted  ! [W/(m K)]
      integer(ik) :: k, next, own, sweep, u

      error = 0.0_rk
      if (.not. allocated(heat%externals)) return
      flow = 0.0_rk
      mixed = 0.0_rk
      along = [integer(ik) ::]
      do k = 1, size(heat%links, kind=ik)
         call find_direction(heat%links(k), own, next)
         if (own == 0 .or. next < heat%first_cell) cycle
         flow(next) = flow(next) + abs(heat%links(k)%flow)
         mixed(next) = mixed(next) + abs(heat%links(k)%flow)*state%temperature(own)
         if (own >= heat%first_cell) along = [along, k]
      end do
      do k = 1, size(heat%externals, kind=ik)
         associate (external => heat%externals(k), u => heat%externals(k)%unknown)
            if (u < heat%first_cell .or. .not. external%flow > 0.0_rk) cycle
            flow(u) = flow(u) + external%flow
            mixed(u) = mixed(u) + external%flow*external%temperature
         end associate
      end do
      drop = 0.0_rk
      associate (now => state%temperature(heat%first_cell:), &
                 before => heat%initial(heat%first_cell:))
         where (flow > 0.0_rk) drop = abs(mixed/flow - now)
         decay = abs(now - before)/max(abs(now - before) + drop, tiny(1.0_rk))
      end associate
      do u = heat%first_cell, heat%first_joint - 1
         associate (f => heat%mesh%fracture%cell_faces(1, u - heat%first_cell + 1))
            conducted = heat%rock%mobility_at(heat%mesh%face_cells(1, f))
         end associate
         drop(u) = drop(u)*flow(u)/(flow(u) + conducted)
         decay(u) = decay(u)*flow(u)/(flow(u) + conducted)
      end do
      drop = drop*wrong_shares(heat, state, wrong)
      error = drop
      do sweep = 1, heat%n - heat%first_cell + 1  ! as many as the longest path has cells
         last = error
         into = 0.0_rk
         do k = 1, size(along, kind=ik)
            call find_direction(heat%links(along(k)), own, next)
            into(next) = into(next) + abs(heat%links(along(k))%flow)*error(own)
         end do
         where (flow > 0.0_rk) error = drop + decay*into/flow
         if (all(abs(error - last) <= steady*maxval(error))) exit
      end do
   end function carried_errors

   !> The share of the heat that each fracture cell exchanges which is uncertain; 0 of joints.
   pure function wrong_shares(heat, state, wrong) result(share)
      class(heat_model_t), intent(in) :: heat
      type(heat_state_t), intent(in) :: state
      real(rk), intent(in) :: wrong(:)  !< (cells) of their temperatures [K]
      real(rk) :: share(heat%first_cell:heat%n)  !< [-]
      real(rk), parameter :: times = 2.5_rk  !< share of the flow over that of the content [-]
      real(rk) :: at_nodes(3, heat%mesh%n_nodes), of_cells(3, heat%mesh%n_cells)
      integer(ik) :: c, i, k

      associate (mesh => heat%mesh, rise => state%temperature - heat%initial)
         of_cells(1, :) = heat%of_cells(state%capacity)
         of_cells(2, :) = heat%of_cells(state%capacity*rise)
         of_cells(3, :) = state%capacity(:mesh%n_cells)*wrong
         at_nodes = 0.0_rk
         do c = 1, mesh%n_cells
            associate (nodes => mesh%cell_nodes(:, c))
               at_nodes(:, nodes) = at_nodes(:, nodes) + spread(of_cells(:, c), 2, 3)
            end associate
         end do
         share = 0.0_rk
         do i = 1, mesh%fracture%n_cells
            associate (nodes => [mesh%face_nodes(:, mesh%fracture%cell_faces(:, i))], &
                       u => heat%first_cell - 1 + i)
               associate (around => [(sum(at_nodes(k, nodes)), k=1, 3)])
                  share(u) = min(1.0_rk, times*around(3)/max( &
                                 min(abs(around(2)), abs(around(1)*rise(u) - around(2))), &
                                 tiny(1.0_rk)))
               end associate
            end associate
         end do
      end associate
   end function wrong_shares

end module heat_carried_errors
