!> Flows of the entries of wells in fractures, and what the pressures of wells at points, and of the
!! cells around them, may lack.
module twolevel_well_losses
   use base_kinds, only: ik, pi, rk
   use coarse_state, only: state_t
   use contact_law, only: state_open
   use twolevel_problem, only: coarse_problem_t
   implicit none(type, external)
   private

   public :: by_wells_in_cells, entry_flows, lost_to_sides, unresolved_at, &
             unresolved_in_cells, uptake

contains

   !> Flows of the entries of the wells in fractures, in the step to a state [m2/s].
   pure function entry_flows(problem, state) result(flow)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk) :: flow(size(problem%entries))
      real(rk), allocatable :: at_places(:)
      integer(ik) :: k

      flow = problem%asked
      associate (wells => problem%model%wells)
         if (size(wells%entry) == 0) return
         at_places = wells%at_places(state%well_flow)
         do k = 1, size(wells%entry, kind=ik)
            if (wells%entry(k) > 0) flow(wells%entry(k)) = at_places(k)
         end do
      end associate
   end function entry_flows

   !> Loss of a flow in half of each fracture cell [Pa s/m2].
   pure function half_cells(problem, state) result(loss)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk) :: loss(size(state%pressure))

      associate (s => problem%mesh%fracture%cell_s)
         loss = 6.0_rk*problem%model%settings%viscosity*(s(2, :) - s(1, :))/state%aperture**3 &
                *problem%thickness(state)
      end associate
   end function half_cells

   !> Error of the pressure of fluid that holds fractures open and leaves them through closed ones:
   !! where they close is known to a cell, by whose whole loss the pressure may be wrong. Of flows
   !! that are a share of what the wells supply, that share [Pa].
   pure real(rk) function at_necks(problem, state) result(pressure)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk) :: loss(size(state%pressure)), supplied
      logical :: is_open(size(state%pressure))
      integer(ik) :: k, last

      pressure = 0.0_rk
      is_open = all(state%contact == state_open, dim=1)
      if (.not. any(is_open)) return
      loss = half_cells(problem, state)
      supplied = sum(max(0.0_rk, entry_flows(problem, state)))
      do k = 1, size(state%flow, kind=ik)
         associate (cells => problem%model%connections(:, k), flow => abs(state%flow(k)))
            last = cells(merge(2, 1, state%flow(k) > 0.0_rk))
            if (is_open(last) .or. .not. is_open(sum(cells) - last)) cycle
            pressure = max(pressure, &
                           2.0_rk*loss(last)*flow**2/max(supplied, flow, tiny(1.0_rk)))
         end associate
      end do
   end function at_necks

   !> What leaks off and is stored in each fracture cell [m2/s].
   pure function uptake(problem, state) result(taken)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk) :: taken(size(state%pressure))
      integer(ik) :: b, k

      taken = state%injection
      do k = 1, size(state%flow, kind=ik)
         associate (cells => problem%model%connections(:, k))
            taken(cells) = taken(cells) + [-1.0_rk, 1.0_rk]*state%flow(k)
         end associate
      end do
      do b = 1, problem%model%joints%branch_count()
         associate (cell => problem%model%joints%cell(b))
            taken(cell) = taken(cell) - state%branch_flow(b)
         end associate
      end do
   end function uptake

   !> Uptake u changes the pressure within each fracture cell by 12 mu u l/(8 a^3) at most, as wells
   !! with a steady flow would have it [Pa].
   pure function by_uptake(problem, state) result(pressure)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk) :: pressure(size(state%pressure))

      pressure = 0.25_rk*half_cells(problem, state)*abs(uptake(problem, state))
   end function by_uptake

   !> The same in cells with wells at points, at most the difference between cell and well [Pa].
   pure function unresolved_in_cells(problem, state) result(pressure)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk), dimension(size(state%pressure)) :: most, pressure
      real(rk) :: flow(size(problem%entries))
      integer(ik) :: e

      pressure = merge(at_necks(problem, state), 0.0_rk, all(state%contact == state_open, dim=1))
      if (.not. any(problem%path > 0.0_rk)) return
      most = by_uptake(problem, state)
      flow = entry_flows(problem, state)
      do e = 1, size(problem%entries, kind=ik)
         where (problem%path(:, e) > 0.0_rk) pressure = max(pressure, min(most, &
            & abs(problem%entry_pressure(state, e, flow(e)) - problem%fracture_pressure(state))))
      end do
   end function unresolved_in_cells

   !> Error of the mean pressure of each fracture by wells at points: between the middle of a cell
   !! and its end the flow of a well at the distance x from the end makes the mean of the cell
   !! differ from its middle by 12 mu q x^2/(2 l a^3), l the cell's length, at most by the
   !! difference between well and cell [Pa].
   pure function by_wells_in_cells(problem, state, n_fractures) result(error)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      integer, intent(in) :: n_fractures
      real(rk) :: error(n_fractures)
      real(rk), dimension(size(state%pressure)) :: differs, length, loss
      real(rk) :: flow(size(problem%entries))
      integer(ik) :: e, f

      error = 0.0_rk
      if (size(loss) == 0) return
      length = problem%mesh%fracture%cell_s(2, :) - problem%mesh%fracture%cell_s(1, :)
      loss = half_cells(problem, state)
      flow = entry_flows(problem, state)
      do e = 1, size(flow, kind=ik)
         f = problem%entries(e)%fracture
         if (f == 0 .or. .not. problem%entries(e)%at_point) cycle
         differs = abs(problem%entry_pressure(state, e, flow(e)) - problem%fracture_pressure(state))
         differs = min(differs, 0.25_rk*loss*abs(flow(e)) &
                       *max(0.0_rk, 2.0_rk*problem%share(:, e) - 1.0_rk)**2)
         error(f) = error(f) + sum(differs*length)/sum(length, &
                                          & mask=problem%mesh%fracture%cell_fracture == f)
      end do
   end function by_wells_in_cells

   !> The outlet next to an entry; 0: none.
   pure integer(ik) function outlet_of(problem, entry) result(joint)
      type(coarse_problem_t), intent(in) :: problem
      integer(ik), intent(in) :: entry

      joint = findloc(problem%joint_share(:, entry) > 0.0_rk, .true., dim=1, kind=ik)
      if (joint == 0) return
      if (.not. problem%model%joints%is_outlet(joint)) joint = 0
   end function outlet_of

   !> What wells next to sides with pressures lose to them may be wrong by this share of what they
   !! inject: three times what leak-off changes (measured), at most 2/pi T/(2 K/mu d) at the
   !! distance d from the side, which a line of little conductance T takes to it [-].
   pure real(rk) function lost_to_sides(problem, state) result(share)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk) :: loss(size(state%pressure)), rock
      integer(ik) :: cell, e, i, j

      share = 0.0_rk
      do e = 1, size(problem%entries, kind=ik)
         j = outlet_of(problem, e)
         if (j == 0) cycle
         cell = maxloc(problem%share(:, e), dim=1, kind=ik)
         associate (mesh => problem%mesh, offset => problem%steady(cell, e))
            associate (sides => mesh%face_cells(1, mesh%fracture%cell_faces(:, cell)))
               rock = sum([(problem%model%rock%mobility_at(sides(i)), i=1, 2)])
            end associate
            loss = half_cells(problem, state)*rock
            share = max(share, min(3.0_rk*abs(offset - problem%joint_share(j, e)), &
                                   2.0_rk/pi/max(tiny(1.0_rk), loss(cell)*(1.0_rk - offset))))
         end associate
      end do
   end function lost_to_sides

   !> What may be missing in the pressure of an entry at a point: a tenth of what the leak-off of
   !! its flow on the way changes, as coarse_well_ways has it; what other uptake changes, with
   !! stages of all; and twice the loss of the flows of other wells on its way to the
   !! same cells, as the others lack that of its flow too. Next to a side with a pressure, that of
   !! the side may decay on the way as that of a well does, or linearly [Pa].
   pure real(rk) function unresolved_at(problem, state, entry, flow) result(pressure)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      integer(ik), intent(in) :: entry  !< number among those of all wells
      real(rk), intent(in) :: flow(:)  !< (wells) [m2/s]
      real(rk), parameter :: of_ways = 0.1_rk  ! 1/lambda of different laws of uptake
      real(rk), dimension(size(state%pressure)) :: loss, most, steady
      integer(ik) :: e

      pressure = 0.0_rk
      if (problem%entries(entry)%fracture == 0) return
      if (any(problem%share(:, entry) > 0.0_rk .and. all(state%contact == state_open, dim=1))) then
         pressure = at_necks(problem, state)
      end if
      if (.not. problem%entries(entry)%at_point) return
      loss = half_cells(problem, state)
      most = by_uptake(problem, state)
      pressure = pressure + sum(problem%share(:, entry)*most)
      associate (j => outlet_of(problem, entry), &
                 cell => maxloc(problem%share(:, entry), dim=1, kind=ik))
         if (j > 0) pressure = pressure + abs(problem%steady(cell, entry) &
                                              - problem%joint_share(j, entry)) &
                               *abs(state%joint_pressure(j) - state%pressure(cell))
      end associate
      associate (own => abs(flow(problem%well_of(entry))), path => problem%path(:, entry), &
                 s => problem%mesh%fracture%cell_s)
         steady = problem%steady(:, entry)
         if (any(problem%joint_share(:, entry) > 0.0_rk)) steady = steady*(1.0_rk - steady)
         if (problem%entries(entry)%stage_count() == 1) then
            most = min(most, 0.25_rk*loss*abs(state%leakoff)*(s(2, :) - s(1, :)))
            pressure = pressure - own/max(sum(abs(flow)), tiny(1.0_rk)) &
                       *sum(problem%share(:, entry)*most) &
                       + of_ways*own*sum(loss*min(path, abs(path - steady)))
         end if
      end associate
      do e = 1, size(problem%entries, kind=ik)
         if (e == entry) cycle
         if (any((problem%path(:, e) > 0.0_rk) .neqv. (problem%path(:, entry) > 0.0_rk))) cycle
         associate (own => problem%joint_share(:, entry), other => problem%joint_share(:, e))
            if (any((own > 0.0_rk) .neqv. (other > 0.0_rk))) cycle
         end associate
         pressure = pressure + 2.0_rk*abs(flow(problem%well_of(e))) &
                    *sum(min(problem%path(:, e), problem%path(:, entry))*loss)
      end do
   end function unresolved_at

end module twolevel_well_losses
