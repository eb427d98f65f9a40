!> Estimated errors of temperatures, by how far those of neighbours are from linear: the largest
!! bend, which is the distance of a value from the linear interpolation between its neighbours, of
!! a cell and its neighbours. Where fronts are thinner than a cell it is of the size of their
!! difference, linear temperatures have none. It is that of the temperatures or of their rise since
!! the start, whichever is less: initial gradients are exact. In rock it is several times as much
!! in the tail of a front, whose few parts have come through many cells (test_heat_errors). Where
!! fluid flows through rock, the fluxes of heat_links diffuse more than the rock conducts: a bend
!! has then lost G t/C of itself, with the sum G of what they conduct too much and the capacity C.
!! In time a front diffuses too, as far as the corrections of substeps do not count.
!!
!! In fractures that of the rock next to them counts too, beyond what layers resolve: a share where
!! the fracture cools the rock, and more than the difference of its cells where it follows the rock.
!! Where a well lies in a cell with a dead end behind it, fluid has lost heat to that part too:
!! temperatures lie as far behind. In that cell the fluid has the temperature of the well, but
!! behind it that of the rock, and next to it may lie heat of earlier stages.
module heat_errors
   use base_kinds, only: ik, rk
   use base_plane, only: barycentric, norm2
   use heat_carried_errors, only: carried_errors
   use heat_links, only: coefficients
   use heat_model, only: heat_model_t
   use heat_state, only: heat_state_t
   implicit none(type, external)
   private

   public :: add_errors_at_wells, temperature_errors, well_errors

   real(rk), parameter :: half = 0.6_rk  !< of a cell, and a fifth more (docs/sweeps.md) [-]
   real(rk), parameter :: of_rock = 0.15_rk  !< share of the error of rock that a fracture cools [-]
   real(rk), parameter :: ahead = 0.25_rk  !< by which a fracture is that cools rock, of differences
   real(rk), parameter :: following = 1.6_rk  !< error of one that follows it, over differences [-]
   real(rk), parameter :: in_tails = 6.0_rk  !< more, where neighbours differ by all of the rise [-]
   real(rk), parameter :: of_tolerance = 2.5_rk  !< error in time over tolerance and rise [-]
   real(rk), parameter :: at_wells = 4.0_rk  !< times what is not carried, in the cell of a well

contains

   !> Errors of cells, or with layers of what lies beyond them, of fracture cells and joints.
   pure subroutine temperature_errors(heat, state, time, behind, error, carried)
      class(heat_model_t), intent(in) :: heat
      type(heat_state_t), intent(in) :: state
      real(rk), intent(in) :: time  !< since the start [s]
      !> (fracture cells) share of the cell behind a well at a point of it; -1: no well
      real(rk), intent(in) :: behind(:)
      real(rk), intent(out) :: error(:)  !< (unknowns) 0 in nodes of layers [K]
      real(rk), intent(out) :: carried(:)  !< (unknowns) of it, by fluid along fractures [K]
      real(rk) :: bend(heat%n), rise(heat%n), step(heat%n)
      real(rk) :: excess(heat%n)  ! conductance beyond that of the rock [W/(m K)]
      integer(ik) :: near(3, heat%n), number(heat%n)
      real(rk) :: wrong(heat%mesh%n_cells)  ! [K]
      integer(ik) :: i, k, u

      rise = state%temperature - heat%initial
      near = 0
      number = 0
      step = 0.0_rk
      excess = 0.0_rk
      do k = 1, size(heat%links, kind=ik)
         associate (link => heat%links(k), a => heat%links(k)%ends(1), b => heat%links(k)%ends(2))
            if (a == 0 .or. .not. (link%is_limited .or. max(a, b) <= heat%mesh%n_cells)) cycle
            number([a, b]) = number([a, b]) + 1
            if (number(a) <= 3) near(number(a), a) = b
            if (number(b) <= 3) near(number(b), b) = a
            step([a, b]) = max(step([a, b]), min(abs(rise(a) - rise(b)), abs( &
                                                 state%temperature(a) - state%temperature(b))))
            if (max(a, b) > heat%mesh%n_cells) cycle
            excess([a, b]) = excess([a, b]) + 0.5_rk*sum(coefficients(link%conductance, link%flow, &
                                                                      link%conducts))
         end associate
      end do
      do u = 1, heat%n
         bend(u) = min(bend_of(state%temperature, u), bend_of(rise, u))
      end do
      do u = 1, heat%n
         error(u) = half*step(u)
         associate (around => [u, near(:min(number(u), 3_ik), u)])
            if (any(bend(around) >= 0.0_rk)) error(u) = maxval(bend(around))
         end associate
         if (u <= heat%mesh%n_cells) wrong(u) = within(u)
         if (u <= heat%mesh%n_cells .and. step(u) > 0.0_rk) then
            error(u) = min(step(u), error(u) &
                           *(1.0_rk + in_tails*step(u)/(abs(rise(u)) + step(u)) &
                             + excess(u)*time/state%capacity(u)))
         end if
      end do
      do i = 1, heat%mesh%fracture%n_cells
         associate (c => heat%first_cell - 1 + i, &
                    cells => heat%mesh%face_cells(1, heat%mesh%fracture%cell_faces(:, i)))
            error(c) = error(c) + half*max(maxval(behind), 0.0_rk)*step(c)
            if (abs(rise(c)) - maxval(abs(rise(cells))) > ahead*maxval(step(cells))) then
               error(c) = error(c) + of_rock*maxval(error(cells))
            else
               error(c) = error(c) + following*maxval(step(cells))
            end if
         end associate
      end do
      carried = 0.0_rk
      carried(heat%first_cell:) = carried_errors(heat, state, wrong)
      error = error + of_tolerance*heat%heat%tolerance*abs(rise)
      ! Twice the corrections, of about bend dt^2/2, that do not count (heat_steps).
      if (allocated(state%bend)) error = error + state%damped*abs(state%bend)
      error = error + carried

   contains

      !> By how much the mean of a cell is beyond the value at its place, of temperatures with the
      !! curvature of the bend along their gradient; at sides that of a cell between mirrored ones.
      pure real(rk) function within(c)
         integer(ik), intent(in) :: c
         real(rk), parameter :: mirrored = 0.25_rk
         real(rk) :: along(3), gradient(2), spread_of_cell, weight(3)

         within = mirrored*half*step(c)
         if (bend(c) < 0.0_rk) return
         associate (at => heat%place(:, near(:, c)), value => state%temperature(near(:, c)), &
                    corners => heat%mesh%xy(:, heat%mesh%cell_nodes(:, c)))
            gradient = matmul(reshape([at(2, 3) - at(2, 1), at(1, 1) - at(1, 3), &
                                       at(2, 1) - at(2, 2), at(1, 2) - at(1, 1)], [2, 2]), &
                              value(2:) - value(1))
            weight = barycentric(at, heat%place(:, c))
            along = matmul(gradient, at - spread(heat%place(:, c), 2, 3))
            weight = weight*along**2
            along = matmul(gradient, corners)
            spread_of_cell = (sum(along**2) - sum(along*cshift(along, 1)))/18.0_rk
         end associate
         if (sum(weight) > spread_of_cell) within = bend(c)*spread_of_cell/sum(weight)
      end function within

      !> Distance of a value from the linear interpolation between those of its neighbours; -1: they
      !! do not surround it.
      pure real(rk) function bend_of(value, u)
         real(rk), intent(in) :: value(:)  !< (unknowns) [K]
         integer(ik), intent(in) :: u
         real(rk), parameter :: outside = -0.2_rk
         real(rk) :: weight(3)

         bend_of = -1.0_rk
         weight = 0.0_rk
         associate (at => heat%place(:, max(near(:, u), 1_ik)))
            if (u <= heat%mesh%n_cells .and. number(u) == 3) then
               weight = barycentric(at, heat%place(:, u))
            else if (u >= heat%first_cell .and. number(u) == 2) then
               weight(:2) = norm2(at(:, [2, 1]) - spread(heat%place(:, u), 2, 2), dim=1)
               weight = weight/sum(weight)
            end if
         end associate
         if (.not. sum(weight) > 0.0_rk .or. minval(weight) < outside) return
         bend_of = abs(value(u) - dot_product(weight, value(max(near(:, u), 1_ik))))
      end function bend_of

   end subroutine temperature_errors

   !> Add the errors of fracture cells with wells at a point.
   pure subroutine add_errors_at_wells(heat, state, behind, carried, error)
      class(heat_model_t), intent(in) :: heat
      type(heat_state_t), intent(in) :: state
      real(rk), intent(in) :: behind(:), carried(:)  !< as in temperature_errors
      real(rk), intent(inout) :: error(:)  !< (unknowns) [K]
      integer(ik) :: i, k

      do i = 1, heat%mesh%fracture%n_cells
         if (behind(i) < 0.0_rk) cycle
         associate (c => heat%first_cell - 1 + i, t => state%temperature, &
                    cells => heat%mesh%face_cells(1, heat%mesh%fracture%cell_faces(:, i)))
            error(c) = max(at_wells*error(c) - (at_wells - 1.0_rk)*carried(c), &
                           behind(i)*maxval(abs(t(cells) - t(c))))
            if (.not. allocated(heat%externals)) cycle
            do k = 1, size(heat%externals, kind=ik)
               associate (external => heat%externals(k))
                  if (external%unknown /= c .or. .not. external%flow > 0.0_rk) cycle
                  error(c) = max(error(c), abs(external%temperature - t(c)))
               end associate
            end do
         end associate
      end do
   end subroutine add_errors_at_wells

   !> Errors of the temperatures of what wells take out: the largest of where they take it.
   pure function well_errors(heat, state, error, carried) result(of_wells)
      class(heat_model_t), intent(in) :: heat
      type(heat_state_t), intent(in) :: state
      real(rk), intent(in) :: error(:), carried(:)  !< as in temperature_errors [K]
      real(rk) :: of_wells(size(state%well_temperature))  !< [K]
      integer(ik) :: k

      of_wells = 0.0_rk
      if (.not. allocated(heat%externals)) return
      do k = 1, size(heat%externals, kind=ik)
         associate (w => heat%externals(k)%well, u => heat%externals(k)%unknown)
            if (w == 0 .or. heat%externals(k)%flow > 0.0_rk) cycle
            of_wells(w) = max(of_wells(w), at_wells*error(u) - (at_wells - 1.0_rk)*carried(u))
         end associate
      end do
   end function well_errors

end module heat_errors
