!> Relative errors in space of the pressures of wells and fractures.
!!
!! - Where the fluid of a fracture leaks off: that of the layers next to the faces. Where chains
!!   resolve them (coarse_layers) it follows from the chain (coarse_chain, uptake_error), with 4 %
!!   for what the cells beyond it take up; at least 3 % while tips grow, as layers have all ages.
!!   Else by the distance sqrt(c t) of diffusion since the last switch over the size of a cell, z:
!!   sqrt(pi)/(2 z), and below 0.15/z**2 (measured: 0.07/z**2).
!! - The first pressure of a fracture, if it is that of the rock around it: the load has changed the
!!   latter from place to place, and a cell has its mean. Error: the mean difference of the
!!   fracture's cells from their neighbours, 1.5 times it where they are open, and twice that of the
!!   fracture's mean from the undrained pressure at its faces, which follows from their traction and
!!   stretch. It falls as the rock drains, 1/(1 + 16 c t/h**2), as far as the rock takes up what the
!!   fractures hold; the latter like a strip of the width of the cells on both sides.
!! - The pressure of a well in the rock: the radius at which the flow has the cell's pressure, 0.151
!!   times the root of the cell's area A, is known within 1.1 % (verification/wells_in_rock). As the
!!   pressure is proportional to the logarithm of the distance over the well's radius, its relative
!!   error is that over ln(1.5 sqrt(A)/r_w), and 0.45 A over the squared distance of a side
!!   (measured:
!!   2.6 to 4.2 % at 2 and 1.5 cells). Before, the rings around the well take in the flow
!!   (coarse_well_rings), within 2 %; once the cell is filled this falls with the squared distance
!!   of diffusion over A, the order of the cells.
module twolevel_pressure_errors
   use base_kinds, only: ik, pi, rk
   use base_plane, only: norm2
   use coarse_nodes, only: node_values
   use coarse_rock, only: solid_t
   use coarse_state, only: state_t
   use contact_law, only: state_open
   use mesh_geometry, only: cell_area, cell_centre, face_length
   use mesh_types, only: point_tip
   use report_jump_errors, only: unevenness
   use scene_types, only: scene_t
   use twolevel_problem, only: coarse_problem_t
   implicit none(type, external)
   private

   public :: fracture_means, has_one_free, have_given_pressure, held_at_first, largest_of, &
             leaking_share, least, mean_in_rock, mean_pressure, of_connected, &
             of_first_pressure, of_layers, of_steps, of_well_in_rock, round_tips, &
             share_round_tips, skempton, stress_means, undrained_share, unresolved_depth

   real(rk), parameter :: of_chain = 0.03_rk  !< relative error of layers of growing fractures [-]
   real(rk), parameter :: of_rest = 0.04_rk  !< of what the cells beyond a chain take up [-]
   real(rk), parameter :: least_flow = 4.0e-3_rk  !< of the flow round tips and along fractures [-]
   !> of the flow round tips that a mesh could miss at most: .1 to .28 with 2 to 20 cells [-]
   real(rk), parameter :: of_tips = 0.25_rk
   real(rk), parameter :: of_plain = 0.15_rk  !< times (cell/depth)**2, without layers [-]
   !> relative errors of a well in the rock: of the cell's radius; of the pressure by the rings [-]
   real(rk), parameter :: of_radius = 0.011_rk, of_rings = 0.02_rk
   !> the same by a side of the body, times the cell's area over its squared distance
   real(rk), parameter :: by_side = 0.45_rk
   !> of first pressures, over the differences of open cells, and over what is lacking at faces [-]
   real(rk), parameter :: of_open = 1.5_rk, of_lack = 2.0_rk
   real(rk), parameter :: least = 0.005_rk  !< least relative error in space of a change [-]

contains

   !> Relative error of the pressure and of the flux where fluid leaks off for a time [-].
   real(rk) function of_layers(problem, time, grows) result(error)
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: time  !< [s]
      logical, intent(in) :: grows  !< fractures may grow
      real(rk) :: ratio
      integer(ik) :: l, n

      error = 0.0_rk
      if (.not. time > 0.0_rk) return
      if (problem%model%layers%n > 0) then
         n = 0
         do l = 1, problem%model%layers%n
            if (problem%model%layers%fracture_cell(l) == 0) cycle
            n = n + 1
            error = error + problem%model%layers%chain(l)%uptake_error(time, of_rest)
         end do
         error = least_flow + error/max(1, n) + of_tips*share_round_tips(problem, time)
         if (grows) error = max(error, of_chain)
      else
         ratio = unresolved_depth(problem, time)
         error = max(least, min(0.5_rk*sqrt(pi)*ratio, of_plain*ratio**2))
      end if
   end function of_layers

   !> Remaining error in time of a step of the pressures at faces and wells, as the layers
   !! (coarse_chain) and the rings of wells (coarse_well_rings) take several steps within it. Layers
   !! take a fourth, as far as they are not wider than their chain [-].
   pure real(rk) function of_steps(problem) result(left)
      type(coarse_problem_t), intent(in) :: problem
      real(rk), parameter :: of_rings = 0.125_rk
      integer(ik) :: l

      left = 1.0_rk
      if (problem%mesh%fracture%n_cells == 0) left = of_rings
      associate (layers => problem%model%layers)
         if (layers%n == 0 .or. problem%mesh%fracture%n_cells == 0) return
         if (.not. layers%chain(1)%dt > 0.0_rk) return
         left = 1.0_rk - 0.75_rk*sum([(layers%chain(l)%scheme(2)%share, l=1, layers%n)])/layers%n
      end associate
   end function of_steps

   !> Share of the error in time of a pressure at given rates: it is that of leak-off alone, since
   !! the balance gives what the fractures hold. The shares of leak-off in the step and in all fluid
   !! measure it; the safety factor is for earlier steps with more leak-off [-].
   pure real(rk) function leaking_share(rates, of_all) result(share)
      real(rk), intent(in) :: rates(2)  !< of leak-off and of the fluid in fractures [m2/s]
      real(rk), intent(in) :: of_all  !< share of leak-off in the fluid so far [-]
      real(rk), parameter :: safety = 3.0_rk

      share = abs(rates(1))/max(sum(abs(rates)), tiny(1.0_rk))
      share = min(1.0_rk, safety*max(share, of_all))
   end function leaking_share

   !> Height of the cells next to the fractures over the distance of diffusion in a time, where no
   !! layer resolves it; 0 without fractures [-].
   real(rk) function unresolved_depth(problem, time) result(ratio)
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: time  !< [s]
      real(rk) :: depth, height
      integer(ik) :: cell, face, i, side

      ratio = 0.0_rk
      if (problem%model%layers%n > 0 .or. .not. time > 0.0_rk) return
      associate (mesh => problem%mesh, fracture => problem%mesh%fracture)
         do i = 1, fracture%n_cells
            do side = 1, 2
               face = fracture%cell_faces(side, i)
               cell = mesh%face_cells(1, face)
               height = 2.0_rk*cell_area(mesh, cell)/face_length(mesh, face)
               depth = sqrt(problem%model%rock%diffusivity_at(cell)*time)
               if (depth > 0.0_rk) ratio = ratio + 2.0_rk/3.0_rk*height/depth
            end do
         end do
         ratio = ratio/max(1, 2*fracture%n_cells)
      end associate
   end function unresolved_depth

   !> Relative error of the pressure of wells in the rock, a time after a switch; 0 without any [-].
   real(rk) function of_well_in_rock(scene, problem, time) result(error)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: time  !< [s]
      real(rk) :: area, filled
      integer :: w

      error = 0.0_rk
      if (.not. allocated(problem%rock_cell)) return
      do w = 1, size(problem%rock_cell)
         associate (cell => problem%rock_cell(w))
            if (cell == 0) cycle
            area = cell_area(problem%mesh, cell)
            filled = max(1.0_rk, problem%model%rock%diffusivity_at(cell)*time/area)
            associate (radius => scene%injections(w)%radius)
               error = max(error, of_rings/filled, by_side*area/distance_of_side(problem, cell)**2 &
                           + of_radius/log(max(2.0_rk, 1.5_rk*sqrt(area)/radius)) &
                           + problem%model%rock_wells%rings(count(problem%rock_cell(:w) &
                                                                  > 0))%error)
            end associate
         end associate
      end do
   end function of_well_in_rock

   !> Least distance of a cell from the middle of a face on the outer boundary [m].
   pure real(rk) function distance_of_side(problem, cell) result(distance)
      type(coarse_problem_t), intent(in) :: problem
      integer(ik), intent(in) :: cell
      integer(ik) :: f

      distance = huge(1.0_rk)
      associate (mesh => problem%mesh, middle => cell_centre(problem%mesh, cell))
         do f = 1, mesh%n_faces
            if (mesh%face_side(f) == 0) cycle
            distance = min(distance, norm2(0.5_rk*sum(mesh%xy(:, mesh%face_nodes(:, f)), dim=2) &
                                           - middle))
         end do
      end associate
   end function distance_of_side

   !> Mean pressure of the cells of the rock, less that in situ [Pa].
   pure real(rk) function mean_in_rock(problem, state)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state

      mean_in_rock = sum(state%unknowns(3, :problem%mesh%n_cells))/problem%mesh%n_cells
   end function mean_in_rock

   !> Mean pressure of the fractures [Pa].
   pure real(rk) function mean_pressure(problem, state)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk) :: length(problem%mesh%fracture%n_cells)

      length = problem%mesh%fracture%cell_s(2, :) - problem%mesh%fracture%cell_s(1, :)
      mean_pressure = sum(problem%fracture_pressure(state)*length)/sum(length)
   end function mean_pressure

   !> Means of the values of the cells of each fracture.
   pure function fracture_means(scene, problem, values) result(mean)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: values(:)  !< (fracture cells)
      real(rk) :: mean(size(scene%fractures))
      integer(ik) :: f

      mean = 0.0_rk
      associate (fracture => problem%mesh%fracture)
         do f = 1, size(mean, kind=ik)
            associate (own => merge(fracture%cell_s(2, :) - fracture%cell_s(1, :), 0.0_rk, &
                                    fracture%cell_fracture == f))
               if (any(own > 0.0_rk)) mean(f) = sum(values*own)/sum(own)
            end associate
         end do
      end associate
   end function fracture_means

   !> Largest of the values of the cells of each fracture.
   pure function largest_of(scene, problem, values) result(largest)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: values(:)  !< (fracture cells)
      real(rk) :: largest(size(scene%fractures))
      integer(ik) :: f

      do f = 1, size(largest, kind=ik)
         largest(f) = maxval(values, mask=problem%mesh%fracture%cell_fracture == f)
      end do
   end function largest_of

   !> Mean total normal traction and shear traction of each fracture [Pa].
   pure function stress_means(scene, problem, state) result(mean)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk) :: mean(2, size(scene%fractures))

      mean = 0.0_rk
      if (problem%mesh%fracture%n_cells == 0) return
      associate (t => 0.5_rk*sum(state%traction, dim=2))
         mean(1, :) = fracture_means(scene, problem, t(1, :) - state%pressure)
         mean(2, :) = fracture_means(scene, problem, t(2, :))
      end associate
   end function stress_means

   !> Undrained change of pressure over that of the mean stress in the plane, in the rock at each
   !! fracture cell [-].
   pure function skempton(problem) result(ratio)
      type(coarse_problem_t), intent(in) :: problem
      real(rk) :: ratio(problem%mesh%fracture%n_cells)
      type(solid_t) :: solid
      integer(ik) :: i

      do i = 1, size(ratio, kind=ik)
         solid = problem%model%rock%solid_at(problem%mesh%face_cells(1, &
                                             & problem%mesh%fracture%cell_faces(1, i)))
         ratio(i) = solid%biot/(solid%storage*(solid%lame + solid%shear) + solid%biot**2)
      end do
   end function skempton

   !> Length of fracture that takes in as much fluid as flows round a tip, as far as the cells do
   !! not resolve it: at a constant pressure half of sqrt(pi c t) (a strip in an infinite body) [m].
   pure function round_tips(problem, time) result(length)
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: time  !< [s]
      real(rk) :: length(problem%mesh%fracture%n_cells)
      real(rk) :: c
      integer(ik) :: i

      associate (fracture => problem%mesh%fracture)
         do i = 1, size(length, kind=ik)
            c = problem%model%rock%diffusivity_at( &
                & problem%mesh%face_cells(1, fracture%cell_faces(1, i)))
            length(i) = 0.5_rk*sqrt(pi*c*time)/(1.0_rk + 4.0_rk*c*time &
                                             & /(fracture%cell_s(2, i) - fracture%cell_s(1, i))**2)
         end do
      end associate
   end function round_tips

   !> Mean of these lengths at the tips over that of their fractures [-].
   pure real(rk) function share_round_tips(problem, time) result(share)
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: time  !< [s]
      real(rk), allocatable :: around(:)
      integer(ik) :: i

      around = round_tips(problem, time)
      share = 0.0_rk
      associate (fracture => problem%mesh%fracture)
         do i = 1, fracture%n_cells
            share = share + around(i)*count(fracture%point_kind(fracture%cell_points(:, i)) &
                                            == point_tip)
         end do
         share = min(1.0_rk, share/max(sum(fracture%cell_s(2, :) - fracture%cell_s(1, :)), &
                                       tiny(1.0_rk)))
      end associate
   end function share_round_tips

   !> Errors of the first pressure of each fracture: the mean difference of its cells from their
   !! neighbours, and twice that of their mean from the undrained pressure at the faces [Pa].
   function of_first_pressure(scene, problem, state) result(error)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk) :: error(size(scene%fractures), 2), start
      real(rk), dimension(problem%mesh%fracture%n_cells) :: lack, uneven

      start = merge(0.0_rk, scene%initial%pressure, allocated(problem%model%in_situ))
      lack = 0.0_rk
      if (allocated(state%tractions)) lack = undrained_at_faces(problem, state, start) &
                                             - state%pressure
      uneven = unevenness(problem%mesh%fracture, problem%fracture_pressure(state))
      uneven = uneven*merge(of_open, 1.0_rk, all(state%contact == state_open, dim=1))
      error(:, 1) = fracture_means(scene, problem, uneven)
      error(:, 2) = of_lack*abs(fracture_means(scene, problem, lack))
   end function of_first_pressure

   !> Undrained pressure at the faces of each fracture cell, the mean of both, of the rock with the
   !! cell's traction and the stretch of its faces: a change of -alpha/S times
   !! (d sigma_n + 2 G eps_t)/(lambda_u + 2 G). Jumps, which are zero at tips, have no mean stretch
   !! [Pa].
   function undrained_at_faces(problem, state, start) result(pressure)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk), intent(in) :: start  !< before the load [Pa]
      real(rk) :: pressure(problem%mesh%fracture%n_cells)
      real(rk) :: along(2), middle(2), stress, stretch, u(3)
      type(solid_t) :: solid
      integer(ik) :: i, k, side

      do i = 1, size(pressure, kind=ik)
         associate (mesh => problem%mesh, rock => problem%model%rock, &
                    faces => problem%mesh%fracture%cell_faces(:, i), &
                    ends => problem%mesh%fracture%point_xy(:, problem%mesh%fracture%cell_points(:, &
                                                                                             & i)))
            along = ends(:, 2) - ends(:, 1)
            middle = 0.5_rk*sum(ends, dim=2)
            stretch = 0.0_rk
            do side = 1, 2
               do k = 1, 2
                  associate (node => mesh%face_nodes(k, faces(side)))
                     u = node_values(mesh, rock, problem%model%regions, state%unknowns, &
                                     state%tractions, node)
                     stretch = stretch + sign(0.5_rk, dot_product(along, mesh%xy(:, node) &
                                                                  - middle)) &
                               *dot_product(u(:2), along)/dot_product(along, along)
                  end associate
               end do
            end do
            solid = rock%solid_at(mesh%face_cells(1, faces(1)))
            stress = 0.5_rk*sum(state%traction(1, :, i)) - state%pressure(i)
            if (allocated(problem%model%in_situ)) then
               associate (in_situ => problem%model%in_situ%stress_at(middle(2)))
                  stress = stress - (in_situ(1)*along(2)**2 + in_situ(2)*along(1)**2 &
                                     - 2.0_rk*in_situ(3)*product(along))/dot_product(along, along) &
                           - problem%model%in_situ%pressure_at(middle(2))
               end associate
            else
               stress = stress + solid%biot*start
            end if
            pressure(i) = start - solid%biot*(stress + 2.0_rk*solid%shear*stretch) &
                          /(solid%storage*(solid%lame + 2.0_rk*solid%shear) + solid%biot**2)
         end associate
      end do
   end function undrained_at_faces

   !> Errors of pressures with those of fractures that joints connect, which have the mean.
   pure function of_connected(problem, own) result(error)
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: own(:)  !< (fractures) [Pa]
      real(rk) :: error(size(own))
      real(rk) :: length(size(own))
      integer(ik) :: b, c, f, group(size(own))

      error = own
      associate (joints => problem%model%joints, fracture => problem%mesh%fracture)
         if (joints%branch_count() == 0) return
         length = [(sum(fracture%cell_s(2, :) - fracture%cell_s(1, :), &
                        mask=fracture%cell_fracture == f), f=1, size(own, kind=ik))]
         group = [(f, f=1, size(own, kind=ik))]
         do b = 1, joints%branch_count()
            do c = 1, b - 1
               if (joints%joint(c) /= joints%joint(b) .or. joints%is_outlet(joints%joint(b))) cycle
               if (joints%is_shut(b) .or. joints%is_shut(c)) cycle
               associate (first => group(fracture%cell_fracture(joints%cell(b))), &
                          second => group(fracture%cell_fracture(joints%cell(c))))
                  group = merge(min(first, second), group, group == max(first, second))
               end associate
            end do
         end do
         do f = 1, size(own, kind=ik)
            error(f) = max(own(f), sum(own*length, mask=group == group(f)) &
                           /max(sum(length, mask=group == group(f)), tiny(1.0_rk)))
         end do
      end associate
   end function of_connected

   !> What closed fractures and joints hold by these errors [m2].
   function held_at_first(scene, problem, state, of_first) result(held)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      real(rk), intent(in) :: of_first(:)  !< (fractures) [Pa]
      real(rk) :: held
      real(rk), dimension(problem%mesh%fracture%n_cells) :: closed, slope

      held = 0.0_rk
      if (size(closed) == 0) return
      associate (fracture => problem%mesh%fracture)
         call problem%model%cells%law%closure(-0.5_rk*sum(state%traction(1, :, :), dim=1), closed, &
                                              slope)
         held = sum((fracture%cell_s(2, :) - fracture%cell_s(1, :)) &
                    *(slope + scene%fluid%compressibility*state%aperture) &
                    *of_first(fracture%cell_fracture))
      end associate
   end function held_at_first

   !> Shares of these errors that are left after a time, as far as the rock takes up what the
   !! fractures hold: of what scatters from cell to cell, and of a strip as wide as the cells on
   !! both sides and as long as the fracture [-].
   function undrained_share(scene, problem, time, held) result(share)
      type(scene_t), intent(in) :: scene
      type(coarse_problem_t), intent(in) :: problem
      real(rk), intent(in) :: time  !< [s]
      real(rk), intent(in) :: held  !< in fractures, per change of pressure and length [m/Pa]
      real(rk) :: share(size(scene%fractures), 2)
      real(rk) :: left(problem%mesh%fracture%n_cells, 2), uptake(problem%mesh%fracture%n_cells)
      real(rk) :: depth, length, width
      integer(ik) :: cell, i

      associate (fracture => problem%mesh%fracture)
         do i = 1, fracture%n_cells
            cell = problem%mesh%face_cells(1, fracture%cell_faces(1, i))
            depth = 4.0_rk*sqrt(problem%model%rock%diffusivity_at(cell)*time)
            length = fracture%cell_s(2, i) - fracture%cell_s(1, i)
            width = 2.0_rk*cell_area(problem%mesh, cell)/length
            left(i, 1) = length**2/max(length**2 + depth**2, tiny(1.0_rk))
            length = maxval(fracture%cell_s(2, :), &
                            mask=fracture%cell_fracture == fracture%cell_fracture(i)) &
                     - minval(fracture%cell_s(1, :), &
                              mask=fracture%cell_fracture == fracture%cell_fracture(i))
            left(i, 2) = 1.0_rk
            if (depth > 0.0_rk) left(i, 2) = erf(width/depth)*erf(length/depth)
            uptake(i) = problem%model%rock%mobility_at(cell)*depth &
                        /(sqrt(pi)*problem%model%rock%diffusivity_at(cell))
         end do
      end associate
      do i = 1, 2
         left(:, i) = 1.0_rk - (1.0_rk - left(:, i))*uptake/max(uptake + held, tiny(1.0_rk))
         share(:, i) = fracture_means(scene, problem, left(:, i))
      end do
   end function undrained_share

   !> Whether all flows of wells are given but that of one in a fracture.
   pure logical function has_one_free(scene)
      type(scene_t), intent(in) :: scene

      associate (wells => scene%injections)
         has_one_free = count(.not. wells%has_given_flow()) == 1 .and. all(wells%fracture > 0)
      end associate
   end function has_one_free

   !> Whether a well keeps a pressure in each fracture.
   pure function have_given_pressure(scene) result(have)
      type(scene_t), intent(in) :: scene
      logical :: have(size(scene%fractures))
      integer :: w

      have = .false.
      do w = 1, size(scene%injections)
         associate (well => scene%injections(w))
            if (well%fracture == 0 .or. allocated(well%rate)) cycle
            if (allocated(well%pressure)) have(well%fracture) = .true.
         end associate
      end do
   end function have_given_pressure

end module twolevel_pressure_errors
