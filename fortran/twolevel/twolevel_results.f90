!> Output of the state of both levels: the row of the history, fields, probes.
module twolevel_results
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_plane, only: barycentric
   use coarse_fields, only: cell_stress, cell_stresses
   use coarse_layer_profiles, only: find_pressure
   use coarse_state, only: state_t
   use coarse_nodes, only: nodal_fields, node_values
   use contact_law, only: state_open, state_slip, state_stick
   use growth_front, only: front_state_t
   use growth_network, only: fracture_length, total_length
   use mesh_geometry, only: cell_area
   use mesh_types, only: fracture_mesh_t, point_boundary, point_interior, point_tip
   use mesh_builder, only: locate
   use report_rows, only: history_row_t, matrix_fields_t, probe_row_t
   use scene_types, only: probe_t, scene_t
   use report_simulation, only: snapshot_t
   use twolevel_levels_state, only: levels_state_t
   use twolevel_places, only: end_at_tips
   use twolevel_problem, only: cell_heights, coarse_problem_t
   use twolevel_well_losses, only: entry_flows
   use twolevel_well_rows, only: well_flows, well_pressures
   implicit none(type, external)
   private

   public :: cell_state, cell_states, history_of_levels, probes_of_levels, slip_potency
   public :: shared_displacement_error, snapshot_of_levels

contains

   !> Contact state of a cell from those of its two ends: open or stick where both are, else slip.
   pure function cell_state(ends) result(state)
      integer(ik), intent(in) :: ends(2)
      integer(ik) :: state

      state = merge(ends(1), state_slip, ends(1) == ends(2))
   end function cell_state

   !> Contact states of all fracture cells.
   pure function cell_states(state) result(states)
      type(state_t), intent(in) :: state
      integer(ik) :: states(size(state%contact, 2))
      integer(ik) :: i

      states = [(cell_state(state%contact(:, i)), i=1, size(states))]
   end function cell_states

   !> Row of history.csv; the caller adds the quantities of the step.
   function history_of_levels(scene, front, problem, now, since) result(row)
      type(scene_t), intent(in) :: scene
      type(front_state_t), intent(in) :: front
      type(coarse_problem_t), intent(in) :: problem
      type(levels_state_t), intent(in) :: now
      real(rk), intent(in) :: since  !< start of the last step [s]
      type(history_row_t) :: row
      type(fracture_mesh_t) :: fracture
      real(rk) :: fluid  ! reference volume of the mass error [m2]
      integer(ik), allocatable :: states(:)

      associate (state => now%coarse, totals => now%fluid)
         row%time = state%time
         row%injected = totals%injected
         row%produced = totals%produced
         row%well_pressure = well_pressures(scene, problem, since, state)
         row%injection_rate = sum(well_flows(scene, problem, since, state))
         row%leakoff = totals%leaked
         row%prefilled = totals%prefilled
         row%outflow = totals%outflow
         row%fracture_length = total_length(front%network)
         row%n_unknowns = unknowns_of(problem)
         row%n_tips = count(front%tip%is_free)
         if (problem%mesh%fracture%n_cells > 0) then
            fracture = problem%mesh%fracture
            call end_at_tips(scene, front, fracture)
            row%n_intersections = count(is_intersection(fracture))
            row%fracture_volume = problem%fracture_volume(state)
            row%max_slip = maxval(abs(state%jump(2, :, :)))
            row%max_opening = maxval(state%jump(1, :, :))
            states = cell_states(state)
            row%n_stick = count(states == state_stick)
            row%n_slip = count(states == state_slip)
            row%n_open = count(states == state_open)
         end if
         fluid = max(abs(totals%injected), row%fracture_volume)
         if (.not. fluid > 0.0_rk) fluid = max(content_in_situ(problem, state), tiny(1.0_rk))
         row%mass_error_relative = abs(totals%mass_error)/fluid
      end associate
   end function history_of_levels

   !> Unknowns of the coarse level, without the windows.
   pure integer(ik) function unknowns_of(problem) result(n)
      type(coarse_problem_t), intent(in) :: problem

      associate (mesh => problem%mesh, model => problem%model)
         n = 3*mesh%n_cells + 7*mesh%fracture%n_cells + size(model%connections, 2, ik) &
             + model%joints%branch_count() + model%joints%n
      end associate
   end function unknowns_of

   !> Fluid volume that the pressures, including those in situ, would store in unstrained rock [m2].
   pure real(rk) function content_in_situ(problem, state) result(content)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state

      content = sum(abs(state%content))
      if (.not. allocated(problem%model%in_situ)) return
      associate (model => problem%model)
         content = content + sum(model%matrix%storage &
                                 *abs(model%in_situ%pressure_at(cell_heights(problem%mesh))))
      end associate
   end function content_in_situ

   !> Magnitude of the slip of each fracture cell in the last step, times its length [m2].
   pure function slip_potency(length, state) result(potency)
      real(rk), intent(in) :: length(:)  !< (fracture cells) [m]
      type(state_t), intent(in) :: state
      real(rk) :: potency(size(length))

      potency = 0.5_rk*length*sum(abs(state%jump(2, :, :) - state%slip_before), dim=1)
   end function slip_potency

   !> Displacement, stress and pressure at points, interpolated in the cells that contain them.
   subroutine probes_of_levels(points, problem, state, row, error)
      type(probe_t), intent(in) :: points(:)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(probe_row_t), intent(out) :: row
      type(error_t), allocatable, intent(out) :: error
      real(rk), allocatable :: xy(:, :)
      real(rk) :: at_nodes(3, 3), value(3)
      integer(ik), allocatable :: cells(:)
      integer(ik) :: i, k, n

      n = size(points)
      allocate (xy(2, n), cells(n))
      allocate (row%displacement(2, n), row%pressure(n), row%stress(3, n))
      allocate (row%displacement_error(n), row%pressure_error(n), row%stress_error(n))
      xy(1, :) = points%x
      xy(2, :) = points%y
      call locate(problem%mesher, xy, cells, error)
      if (allocated(error)) return
      associate (mesh => problem%mesh, model => problem%model)
         do i = 1, n
            associate (nodes => mesh%cell_nodes(:, cells(i)))
               do k = 1, 3
                  at_nodes(:, k) = node_values(mesh, model%rock, model%regions, state%unknowns, &
                                               state%tractions, nodes(k))
               end do
               value = matmul(at_nodes, barycentric(mesh%xy(:, nodes), xy(:, i)))
            end associate
            row%displacement(:, i) = value(:2)
            row%pressure(i) = value(3)
            if (allocated(state%layer)) then
               call find_pressure(model%layers, [(k, k=1, model%layers%n)], mesh, &
                                  [integer(ik) ::], state%unknowns, state%layer, xy(:, i), &
                                  cells(i), at_nodes(3, :), row%pressure(i))
            end if
            row%stress(:, i) = cell_stress(model%regions, state%tractions, cells(i))
            call find_local_errors(problem, state, cells(i), sum(at_nodes, dim=2)/3.0_rk, &
                                   row%displacement_error(i), row%pressure_error(i), &
                                   row%stress_error(i))
            if (.not. allocated(model%in_situ)) cycle
            ! The state in situ is exact at the point itself.
            row%pressure(i) = row%pressure(i) + model%in_situ%pressure_at(xy(2, i))
            row%stress(:, i) = row%stress(:, i) + model%in_situ%stress_at(xy(2, i))
         end do
      end associate
   end subroutine probes_of_levels

   !> Errors of displacements that cells share, as what is not resolved in one moves the others: in
   !! the mean square over the body both are of one order: the root of that of the local errors is
   !! stated [m].
   function shared_displacement_error(problem, state) result(error)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk) :: area, error, square, whole
      real(rk) :: nodal(3, problem%mesh%n_nodes)
      integer(ik) :: c

      square = 0.0_rk
      whole = 0.0_rk
      associate (mesh => problem%mesh, model => problem%model)
         call nodal_fields(mesh, model%rock, model%regions, state%unknowns, state%tractions, nodal)
         do c = 1, mesh%n_cells
            area = cell_area(mesh, c)
            whole = whole + area
            square = square + area*maxval(abs(sum(nodal(:2, mesh%cell_nodes(:, c)), dim=2)/3.0_rk &
                                              - state%unknowns(:2, c)))**2
         end do
      end associate
      error = sqrt(square/whole)
   end function shared_displacement_error

   !> Errors of the values in one cell: the difference of its displacement and pressure from the
   !! mean of those at its nodes, and half the largest difference of its stress from those of its
   !! neighbours.
   pure subroutine find_local_errors(problem, state, cell, of_nodes, displacement, pressure, stress)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: of_nodes(3)  !< mean displacement [m] and pressure [Pa] of its nodes
      real(rk), intent(out) :: displacement  !< [m]
      real(rk), intent(out) :: pressure, stress  !< [Pa]
      integer(ik) :: k, other

      displacement = maxval(abs(of_nodes(:2) - state%unknowns(:2, cell)))
      pressure = abs(of_nodes(3) - state%unknowns(3, cell))
      stress = 0.0_rk
      associate (mesh => problem%mesh, regions => problem%model%regions)
         do k = 1, 3
            other = sum(mesh%face_cells(:, mesh%cell_faces(k, cell))) - cell
            if (other == 0) cycle
            stress = max(stress, 0.5_rk*maxval(abs(cell_stress(regions, state%tractions, other) &
                                                   - cell_stress(regions, state%tractions, cell))))
         end do
      end associate
   end subroutine find_local_errors

   !> Total stress of each cell: xx, yy, xy [Pa].
   function stresses_of(problem, state) result(stresses)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk) :: stresses(3, problem%mesh%n_cells)
      real(rk) :: y(problem%mesh%n_cells)
      integer(ik) :: c

      call cell_stresses(problem%mesh, problem%model%regions, state%tractions, stresses)
      if (.not. allocated(problem%model%in_situ)) return
      y = cell_heights(problem%mesh)
      do c = 1, problem%mesh%n_cells
         stresses(:, c) = stresses(:, c) + problem%model%in_situ%stress_at(y(c))
      end do
   end function stresses_of

   !> Displacement, pressure and stress, where the scene requires them, and the state of the
   !! fracture faces.
   function snapshot_of_levels(scene, problem, state) result(snapshot)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      type(snapshot_t) :: snapshot
      real(rk), allocatable :: pressure(:)
      integer(ik), allocatable :: shown(:)
      integer(ik) :: k

      snapshot%time = state%time
      snapshot%mesh%fracture = problem%mesh%fracture
      if (scene%output%vtu) then
         snapshot%mesh = problem%mesh
         snapshot%matrix = rock_fields(problem, state, allocated(scene%regions))
      end if
      associate (fracture => snapshot%fracture, joints => problem%model%joints)
         fracture%aperture = state%aperture
         fracture%jump_n = 0.5_rk*sum(state%jump(1, :, :), dim=1)
         fracture%jump_t = 0.5_rk*sum(state%jump(2, :, :), dim=1)
         fracture%traction_n = 0.5_rk*sum(state%traction(1, :, :), dim=1)
         fracture%traction_t = 0.5_rk*sum(state%traction(2, :, :), dim=1)
         fracture%pressure = problem%fracture_pressure(state)
         fracture%void = state%void
         fracture%state = cell_states(state)
         fracture%flow = fracture_flow(problem, state)
         ! Without joints that no crack has reached yet.
         shown = pack([(k, k=1, joints%n)], [(.not. any(joints%is_shut(joints%branches%of(k))), &
                                              k=1, joints%n)])
         snapshot%intersection%point = joints%point(shown)
         pressure = problem%joint_pressure(state)
         snapshot%intersection%pressure = pressure(shown)
      end associate
   end function snapshot_of_levels

   !> Displacement, pressure and stress in the rock.
   function rock_fields(problem, state, has_regions) result(fields)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      logical, intent(in) :: has_regions  !< the scene has regions of other rock
      type(matrix_fields_t) :: fields
      real(rk), allocatable :: nodal(:, :)
      integer(ik) :: c

      associate (mesh => problem%mesh, model => problem%model, rock => problem%model%rock)
         fields%displacement = state%unknowns(:2, :mesh%n_cells)
         allocate (nodal(3, mesh%n_nodes))
         call nodal_fields(mesh, rock, model%regions, state%unknowns, state%tractions, nodal)
         fields%node_displacement = nodal(:2, :)
         fields%pressure = problem%rock_pressure(state)
         fields%stress = stresses_of(problem, state)
         allocate (fields%displacement_error(mesh%n_cells), fields%pressure_error(mesh%n_cells), &
                   fields%stress_error(mesh%n_cells))
         do c = 1, mesh%n_cells
            call find_local_errors(problem, state, c, &
                                   sum(nodal(:, mesh%cell_nodes(:, c)), dim=2)/3.0_rk, &
                                   fields%displacement_error(c), fields%pressure_error(c), &
                                   fields%stress_error(c))
         end do
         fields%displacement_error = fields%displacement_error &
                                     + shared_displacement_error(problem, state)
         if (.not. has_regions) return
         fields%permeability = rock%permeability
         if (size(rock%shear) == 1) return
         fields%poisson = rock%lame/(2.0_rk*(rock%lame + rock%shear))
         fields%biot = rock%biot
      end associate
   end function rock_fields

   !> Flow along each fracture cell in its direction, at its middle: the mean of its two ends, and
   !! half of what wells supply between the middle and an end [m2/s].
   pure function fracture_flow(problem, state) result(flow)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk) :: flow(problem%mesh%fracture%n_cells)
      integer(ik) :: b, k

      flow = 0.5_rk*matmul(problem%share*problem%ahead, entry_flows(problem, state))
      associate (pairs => problem%model%connections, joints => problem%model%joints)
         do k = 1, size(pairs, 2, kind=ik)
            flow(pairs(:, k)) = flow(pairs(:, k)) + 0.5_rk*state%flow(k)
         end do
         do b = 1, joints%branch_count()
            flow(joints%cell(b)) = flow(joints%cell(b)) &
                                   + merge(-0.5_rk, 0.5_rk, joints%end(b) == 1)*state%branch_flow(b)
         end do
      end associate
   end function fracture_flow

   !> Whether each point is an intersection of fractures inside the body.
   pure function is_intersection(fracture)
      type(fracture_mesh_t), intent(in) :: fracture
      logical :: is_intersection(fracture%n_points)
      integer(ik) :: i

      is_intersection = [(all(fracture%point_kind(i) /= [point_interior, point_tip, &
                                                         point_boundary]), i=1, fracture%n_points)]
   end function is_intersection

end module twolevel_results
