!> Estimated errors of the fields of a state with a fluid: those of its quantities
!! (twolevel_value_errors), and in each cell the difference from what its neighbours give.
!!
!! The flow along a fracture is the sum of what is taken up beyond a cell: the relative error of
!! leak-off acts on what leaks off in a cell; uptakes that scatter by s from cell to cell add up
!! like a random walk between the ends, 2 s sqrt(n x (1 - x)) after the share x of n cells. In the
!! last cell before an end the flow falls to zero within the cell, anywhere: it is nothing, or what
!! the flows of the cells before it lead to. What flows round the tips comes from the whole
!! fracture; cells do not resolve it where sqrt(c t) is less than their length. The stress on a
!! fracture has an error in proportion to its change since the start, and in closed fractures so
!! has the pressure.
!!
!! K follows the load of the faces. A uniform error of the fluid's pressure in a zone of length L
!! that slips is one of K_II of the friction times sqrt(pi L/2) times it, by the share of the cells
!! that are in contact; errors in time of slip and opening are relative errors of K. The net
!! pressure of an open fracture follows from the compliance of its faces and has no term here but
!! that of the first pressure, at which the fracture opens on its own. A joint that closes has the
!! relative error that the pressure causes in its closure, by the law of its faces. Faces at a tip
!! that have slipped and now stick with less than the friction hold a rest of the slip before them.
!! A cell does not resolve how this rest s is distributed: K_II changes by half of what it is if it
!! is uniform, sqrt(8 h/pi) s. Closed faces that slide with dilation have K_I = tan(psi) |K_II|,
!! with its whole error.
module twolevel_field_errors
   use base_kinds, only: ik, pi, rk
   use coarse_state, only: state_t
   use contact_law, only: state_open, state_slip
   use growth_tip, only: tip_t
   use report_jump_errors, only: jump_errors_t, unevenness
   use report_rows, only: fracture_fields_t, matrix_fields_t
   use scene_types, only: scene_t
   use twolevel_jump_errors, only: jumps_in_space_t
   use twolevel_pressure_errors, only: fracture_means, have_given_pressure, largest_of, least, &
                                       round_tips, skempton, stress_means
   use twolevel_problem, only: coarse_problem_t
   use twolevel_results, only: cell_states
   use twolevel_value_errors, only: of_solution, value_errors_t
   use twolevel_well_losses, only: entry_flows, unresolved_in_cells, uptake
   implicit none(type, external)
   private

   public :: add_rock_errors, find_fracture_errors, load_errors

   !> errors of flows, over the difference from the neighbours and the largest one of a fracture [-]
   real(rk), parameter :: of_neighbours = 1.2_rk, of_largest = 0.04_rk
   !> error of the stress that acts on a fracture, over its change since the start [-]
   real(rk), parameter :: of_stress = 0.025_rk
   real(rk), parameter :: by_flow = 0.25_rk  !< the same, over the relative error of the flow [-]

contains

   !> Error of the stress on each closed fracture cell: a share of the mean change on its fracture
   !! [Pa].
   function stress_error(scene, problem, state, errors) result(error)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(value_errors_t), intent(in) :: errors
      real(rk), allocatable :: error(:)

      error = of_stress*norm2(stress_means(scene, problem, state) - errors%first_stress, dim=1)
      error = merge(0.0_rk, error(problem%mesh%fracture%cell_fracture), &
                    cell_states(state) == state_open)
   end function stress_error

   !> Error of the pressure of each fracture cell, in time and space: by flow, and by the compliance
   !! of the faces, which is that of the pressure beyond closure [Pa].
   function cell_pressure_errors(scene, problem, state, errors, jumps) result(error)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(value_errors_t), intent(in) :: errors
      type(jumps_in_space_t), intent(in) :: jumps
      real(rk), allocatable :: error(:)
      logical :: own(problem%mesh%fracture%n_cells)
      integer(ik) :: f

      error = errors%in_space(scene, problem)
      if (errors%quantities%n_steps == 0) return  ! the pressure of the initial state is given
      associate (of_fracture => problem%mesh%fracture%cell_fracture, &
                 has_given => have_given_pressure(scene))
         associate (by_stress => skempton(problem)*stress_error(scene, problem, state, errors))
            error = error + merge(0.0_rk, by_stress, has_given(of_fracture))
         end associate
         do f = 1, size(has_given, kind=ik)
            own = of_fracture == f
            if (has_given(f) .or. .not. any(own)) cycle
            where (own) error = max(error, sum(jumps%net_error, mask=own)/count(own))
         end do
         error = error + errors%fractures%error(of_fracture)
      end associate
   end function cell_pressure_errors

   !> Errors of the fields of the fracture cells.
   subroutine find_fracture_errors(scene, problem, state, errors, fields)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(value_errors_t), intent(in) :: errors
      type(fracture_fields_t), intent(inout) :: fields
      type(jumps_in_space_t) :: jumps
      real(rk), dimension(problem%mesh%fracture%n_cells) :: around, length, smooth, tips, uneven
      real(rk), dimension(size(scene%fractures)) :: drop, largest, resistance
      real(rk) :: ends(2), leaks, whole
      logical :: own(size(length))
      integer(ik) :: f
      integer :: inner(2)

      call errors%jumps_of(scene, problem, state, jumps)
      associate (fracture => problem%mesh%fracture, e => fields%error)
         length = fracture%cell_s(2, :) - fracture%cell_s(1, :)
         e%jump_n = jumps%error_n + errors%of_opening*abs(fields%jump_n)
         e%jump_t = jumps%error_t + errors%of_slip*abs(fields%jump_t)
         e%pressure = cell_pressure_errors(scene, problem, state, errors, jumps) &
                      + unresolved_in_cells(problem, state) + of_solution*abs(fields%pressure) &
                      + 0.5_rk*merge(0.0_rk, unevenness(fracture, fields%pressure), &
                                     any(problem%path > 0.0_rk, dim=2))
         ! Wells at points supply known flows.
         smooth = fields%flow - matmul(max(0.0_rk, problem%ahead), entry_flows(problem, state))
         e%flow = of_neighbours*unevenness(fracture, smooth)
         around = round_tips(problem, state%time - errors%start)
         uneven = length*unevenness(fracture, uptake(problem, state)/length)
         do f = 1, maxval(fracture%cell_fracture)
            own = fracture%cell_fracture == f
            associate (first => findloc(own, .true., dim=1), s => fracture%cell_s, &
                       last => findloc(own, .true., dim=1, back=.true.), q => smooth)
               if (first == 0) cycle
               inner = [min(first + 1, last), max(last - 1, first)]
               e%flow(first) = max(e%flow(first), abs(q(first)), &
                                   abs(3.0_rk*q(first) - q(inner(1))))
               e%flow(last) = max(e%flow(last), abs(q(last)), abs(3.0_rk*q(last) - q(inner(2))))
               whole = sum(length, mask=own)
               leaks = sum(length*abs(state%leakoff), mask=own)/whole
               ends = [s(1, first), s(2, last)]
               tips = min(around, 0.5_rk*whole)*abs(s(1, :) + s(2, :) - sum(ends))/whole
               where (own) e%flow = e%flow + leaks*(errors%of_flow*length + tips)
               where (own) e%flow = e%flow + 2.0_rk*sum(uneven, mask=own) &
                                    *sqrt(max(0.0_rk, (0.5_rk*(s(1, :) + s(2, :)) - ends(1)) &
                                              *(ends(2) - 0.5_rk*(s(1, :) + s(2, :)))) &
                                          /count(own))/whole
            end associate
         end do
         largest = largest_of(scene, problem, abs(smooth))
         e%flow = e%flow + (errors%of_flow + errors%time_share())*abs(smooth) &
                  + of_largest*largest(fracture%cell_fracture)
         if (allocated(errors%of_flows)) then
            e%flow = e%flow + matmul(abs(problem%ahead), errors%of_flows(problem%well_of))
            e%pressure = e%pressure + errors%of_given(fracture%cell_fracture)
         end if
         ! Half of the fluid of the ends passes the others.
         drop = fracture_means(scene, problem, abs(fields%flow))
         drop = fracture_means(scene, problem, e%flow)/max(tiny(1.0_rk), drop)
         resistance = 3.0_rk*fracture_means(scene, problem, e%jump_n/fields%aperture)
         drop = max(min(1.0_rk, resistance), by_flow*min(1.0_rk, drop)) &
                *(largest_of(scene, problem, fields%pressure) &
                  + largest_of(scene, problem, -fields%pressure))
         e%pressure = e%pressure + errors%of_place(fracture%cell_fracture) &
                      + drop(fracture%cell_fracture)
         drop = errors%fractures%changes()
         e%flow = e%flow + abs(smooth)*min(1.0_rk, e%pressure/max(tiny(1.0_rk), &
                                                                & drop(fracture%cell_fracture)))
      end associate
      call note_tractions(scene, problem, state, jumps%slip, &
                          stress_error(scene, problem, state, errors), fields)
   end subroutine find_fracture_errors

   !> Errors of the tractions: differences between neighbours and between the ends of a cell, the
   !! traction that the error of the jump is equal to, and in contact that of the pressure. Faces
   !! that slip have the friction of their normal traction. Where contact ends is known to one cell:
   !! open faces next to it may have half of its traction.
   subroutine note_tractions(scene, problem, state, jumps, of_stress, fields)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(jump_errors_t), intent(in) :: jumps
      real(rk), intent(in) :: of_stress(:)  !< (cells) [Pa]
      type(fracture_fields_t), intent(inout) :: fields
      real(rk) :: by_jump(size(state%pressure)), modulus

      modulus = scene%material%young/(1.0_rk - scene%material%poisson**2)
      by_jump = 0.0_rk
      where (jumps%reach > 0.0_rk)
         by_jump = jumps%of_slip*0.25_rk*modulus/jumps%reach
      end where
      associate (e => fields%error, fracture => problem%mesh%fracture, t => state%traction, &
                 friction => problem%model%cells%law%friction)
         by_jump = by_jump*hypot(fields%jump_n, fields%jump_t) + of_stress
         e%traction_n = scatter(fields%traction_n, t(1, :, :)) + by_jump + e%pressure
         e%traction_t = scatter(fields%traction_t, t(2, :, :)) + by_jump - 0.5_rk*of_stress &
                        + friction*e%pressure
         where (fields%state == state_slip) e%traction_t = friction*e%traction_n
         where (fields%state == state_open)
            e%traction_n = unevenness(fracture, fields%traction_n)
            e%traction_t = unevenness(fracture, fields%traction_t)
         end where
      end associate

   contains

      !> Differences from neighbours and between the ends of a cell; at least the mean of the
      !! fracture, as neighbours may have the same error.
      pure function scatter(means, at_ends) result(difference)
         real(rk), intent(in) :: means(:), at_ends(:, :)  !< (cells), (2, cells) [Pa]
         real(rk) :: difference(size(means))

         associate (fracture => problem%mesh%fracture)
            difference = max(unevenness(fracture, means), 0.5_rk*abs(at_ends(2, :) - at_ends(1, :)))
            associate (mean => fracture_means(scene, problem, difference))
               difference = max(difference, 0.5_rk*mean(fracture%cell_fracture))
            end associate
         end associate
      end function scatter

   end subroutine note_tractions

   !> Errors of K_I and K_II of the tips by those of the load of the faces [Pa m^1/2].
   function load_errors(scene, problem, state, errors, tips) result(of_k)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(value_errors_t), intent(in) :: errors
      type(tip_t), intent(in) :: tips(:)
      real(rk) :: of_k(2, size(tips))
      type(jumps_in_space_t) :: jumps
      real(rk), dimension(problem%mesh%fracture%n_cells) :: first, of_pressure, rest
      logical, dimension(size(rest)) :: own, slides
      integer(ik) :: at, i

      of_k = 0.0_rk
      if (size(of_pressure) == 0) return
      call errors%jumps_of(scene, problem, state, jumps)
      of_pressure = cell_pressure_errors(scene, problem, state, errors, jumps)
      first = errors%first_pressure(scene, problem)
      slides = cell_states(state) == state_slip
      associate (fracture => problem%mesh%fracture, friction => problem%model%cells%law%friction, &
                 t => state%traction)
         rest = max(0.0_rk, -friction*0.5_rk*sum(t(1, :, :), dim=1) &
                    - 0.5_rk*abs(sum(t(2, :, :), dim=1)))
         do i = 1, size(tips, kind=ik)
            at = findloc(fracture%cell_fracture, tips(i)%fracture, dim=1, back=tips(i)%end == 2)
            if (at == 0) cycle
            associate (k => tips(i)%intensity, half => 0.5_rk*(fracture%cell_s(2, at) &
                                                               - fracture%cell_s(1, at)))
               of_k(:, i) = abs([k%k1, k%k2])*[errors%of_opening + of_closure(at), errors%of_slip]
               if (jumps%n(at) > 0.0_rk .and. .not. k%closed) then
                  of_k(1, i) = of_k(1, i) + first(at)*root(jumps%opening%reach(at), half)
               end if
               own = fracture%cell_fracture == tips(i)%fracture .and. jumps%slip%reach > 0.0_rk
               of_k(2, i) = of_k(2, i) + friction(at)*of_pressure(at) &
                            *root(jumps%slip%reach(at), half) &
                            *count(own .and. slides)/max(1, count(own))
               if (abs(k%k2) > 0.0_rk .and. jumps%t(at) > 0.0_rk) then
                  of_k(2, i) = of_k(2, i) + sqrt(4.0_rk*half/pi)*rest(at)
               end if
               if (k%closed .and. abs(k%k2) > 0.0_rk) then
                  of_k(1, i) = max(of_k(1, i), abs(k%k1/k%k2)*(k%k2_error + of_k(2, i)) &
                                   - k%k1_error)
               end if
            end associate
         end do
      end associate

   contains

      !> Relative error of K_I by the closure of a joint: the fracture of a cell [-].
      pure real(rk) function of_closure(cell) result(share)
         integer(ik), intent(in) :: cell
         real(rk), dimension(size(rest)) :: closed, length, slope

         share = 0.0_rk
         associate (fracture => problem%mesh%fracture, law => problem%model%cells%law)
            if (jumps%n(cell) > 0.0_rk .or. .not. law(cell)%compliance > 0.0_rk) return
            length = merge(fracture%cell_s(2, :) - fracture%cell_s(1, :), 0.0_rk, &
                           fracture%cell_fracture == fracture%cell_fracture(cell))
            call law%closure(-0.5_rk*sum(state%traction(1, :, :), dim=1), closed, slope)
            share = sum(length*slope*of_pressure)/max(sum(length*abs(jumps%n)), tiny(1.0_rk))
         end associate
      end function of_closure

      !> sqrt(pi L/2) of a zone of length L, from the reach of its last cell [m^1/2].
      elemental real(rk) function root(reach, half)
         real(rk), intent(in) :: reach  !< [m]
         real(rk), intent(in) :: half  !< half of the cell's length [m]

         root = 0.0_rk
         if (reach > 0.0_rk .and. half > 0.0_rk) root = sqrt(0.5_rk*pi*(reach**2/half + half))
      end function root

   end function load_errors

   !> Add the errors of time and of the fractures to those of each cell of the rock.
   pure subroutine add_rock_errors(scene, problem, state, errors, fields)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(value_errors_t), intent(in) :: errors
      type(matrix_fields_t), intent(inout) :: fields
      real(rk) :: share, start

      if (.not. allocated(fields%pressure_error)) return
      start = scene%initial%pressure
      if (allocated(problem%model%in_situ)) start = 0.0_rk
      share = least + errors%of_length + errors%time_share()
      fields%pressure_error = fields%pressure_error &
                              + share*abs(state%unknowns(3, :problem%mesh%n_cells) - start)
      fields%displacement_error = fields%displacement_error &
                                  + share*maxval(abs(fields%displacement), dim=1)
   end subroutine add_rock_errors

end module twolevel_field_errors
