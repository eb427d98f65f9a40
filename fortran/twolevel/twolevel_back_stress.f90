!> K_I of layers of fluid pressure that are thinner than the cells of a window's pressure.
!!
!! The pressure of a layer on the faces of a crack (coarse_layers) is not in the pore pressure of a
!! window, which is linear in the coarse cells (coarse_own_pressure). Its excess over that pressure,
!! w(n) at the distance n from a face, presses the faces together. With the weight function of a
!! pore pressure at the tip of a half-plane crack, eta/sqrt(2 pi) r^(-3/2) cos(3 theta/2), a strip
!! of the layer on both faces, from x_1 to x_2 behind the tip, has
!!   K_I = -2 eta/sqrt(2 pi) integral of w(n) (g(n, x_1) - g(n, x_2)) dn,
!!   g(n, x) = 2 Re (-x + i n)^(-1/2),   g(n, 0) = sqrt(2/n).
!! This leaves out the flow round the tip, by which a layer is thinner there, and by which the rock
!! at a drained tip deforms as drained rock. Both are independent of time as long as the layer is
!! thin compared with the crack, and so is their factor, for every profile: `round_tip` times
!! (1 + F)/2, F = (1 - nu_u)/(1 - nu) (docs/theory.md, "Pressure layers at tips").
module twolevel_back_stress
   use base_kinds, only: ik, pi, rk
   use coarse_layers, only: layers_t
   use coarse_layout, only: end_block, layer_block
   use coarse_rock, only: solid_t
   use coarse_state, only: state_t
   use coarse_tip_drainage, only: pressure_at, pressure_of_face
   use mesh_geometry, only: cell_area, face_length
   use mesh_types, only: mesh_t
   use twolevel_faces, only: coarse_values_t
   use twolevel_problem, only: coarse_problem_t
   implicit none(type, external)
   private

   public :: back_stress_of, diffusivity_at, weighted

   !> K_I of a layer that has diffused round the tip, over that of one which ends there [-].
   real(rk), parameter :: round_tip = 1.0_rk/sqrt(2.0_rk)

contains

   !> K_I of the layers of a fracture at one of its tips, beyond that of the rock's own pressure
   !! [Pa m^1/2].
   pure real(rk) function back_stress_of(problem, state, fracture, end, age) result(k1)
      type(coarse_problem_t), intent(in) :: problem  !< with the values of the state
      type(state_t), intent(in) :: state
      integer(ik), intent(in) :: fracture  !< number of the fracture in the network
      integer(ik), intent(in) :: end  !< 1: start of the polyline, 2: its end
      real(rk), intent(in) :: age  !< of the layer at the tip, where its cell has an older one [s]
      integer(ik), allocatable :: cells(:)
      integer(ik) :: cell, i, k, layer, side
      real(rk), allocatable :: alone(:), excess(:), place(:)
      real(rk) :: behind(2), of_layers, young

      k1 = 0.0_rk
      of_layers = 0.0_rk
      associate (mesh => problem%mesh, layers => problem%model%layers)
         if (layers%n == 0 .or. problem%values%undrained) return
         cells = pack([(i, i=1, mesh%fracture%n_cells)], mesh%fracture%cell_fracture == fracture)
         if (end == 2) cells = cells(size(cells):1:-1)
         behind(2) = 0.0_rk
         do k = 1, size(cells, kind=ik)
            cell = cells(k)
            behind(1) = behind(2)
            behind(2) = behind(1) + problem%model%cells%share(cell) &
                        *(mesh%fracture%cell_s(2, cell) - mesh%fracture%cell_s(1, cell))
            if (.not. behind(2) > behind(1)) cycle
            do side = 1, 2
               layer = mesh%face_layer(mesh%fracture%cell_faces(side, cell))
               if (layer == 0) cycle
               place = place_of(mesh, layers, layer)
               call find_excess(mesh, layers, state, problem%values, layer, alone, excess)
               k1 = k1 - 0.5_rk*weighted(behind, place, excess)
               of_layers = of_layers - 0.5_rk*weighted(behind, place, alone)
            end do
         end do
         young = huge(1.0_rk)
         if (age < huge(age)) young = young_moment(problem, state, cells(1), age)
         if (young < -of_layers) then
            ! The window has the content of the layers as pressure of its cells.
            k1 = (k1 - of_layers)*without_tip(problem, cells(1)) &
                 - young*factor_at(problem, cells(1))
         else
            k1 = k1*factor_at(problem, cells(1))
         end if
      end associate
   end function back_stress_of

   !> Integral with the weight of a half-plane of layers of a given age and the pressure that those
   !! of a fracture cell have, dp erfc(n/(2 sqrt(c age))); huge unless that exceeds the rock's.
   pure real(rk) function young_moment(problem, state, cell, age) result(moment)
      type(coarse_problem_t), intent(in) :: problem
      type(state_t), intent(in) :: state
      integer(ik), intent(in) :: cell  !< fracture cell
      real(rk), intent(in) :: age  !< [s]
      real(rk), allocatable :: alone(:), excess(:)
      real(rk) :: pressure
      integer(ik) :: layer, side

      pressure = 0.0_rk
      associate (mesh => problem%mesh, layers => problem%model%layers)
         do side = 1, 2
            layer = mesh%face_layer(mesh%fracture%cell_faces(side, cell))
            if (layer == 0) cycle
            call find_excess(mesh, layers, state, problem%values, layer, alone, excess)
            pressure = pressure + 0.5_rk*alone(1)
         end do
      end associate
      moment = huge(1.0_rk)
      if (pressure > 0.0_rk) moment = 4.0_rk*gamma(0.75_rk)/sqrt(pi)*pressure &
                                      *(diffusivity_at(problem, cell)*age)**0.25_rk
   end function young_moment

   !> c of the rock at a fracture cell [m2/s].
   pure real(rk) function diffusivity_at(problem, fracture_cell) result(diffusivity)
      type(coarse_problem_t), intent(in) :: problem
      integer(ik), intent(in) :: fracture_cell

      diffusivity = problem%model%rock%diffusivity_at(problem%mesh%face_cells(1, &
                                              & problem%mesh%fracture%cell_faces(1, fracture_cell)))
   end function diffusivity_at

   !> 2 eta/sqrt(2 pi) of the rock at a fracture cell, with the effect of the tip [-].
   pure real(rk) function factor_at(problem, fracture_cell) result(factor)
      type(coarse_problem_t), intent(in) :: problem
      integer(ik), intent(in) :: fracture_cell
      type(solid_t) :: solid
      real(rk) :: drained_tip, stiffness, undrained

      solid = solid_beside(problem, fracture_cell)
      stiffness = solid%lame + 2.0_rk*solid%shear
      undrained = solid%lame + solid%biot**2/solid%storage
      drained_tip = (undrained + 2.0_rk*solid%shear)/(undrained + solid%shear) &
                    *(solid%lame + solid%shear)/stiffness
      factor = round_tip*0.5_rk*(1.0_rk + drained_tip) &
               *sqrt(2.0_rk/pi)*solid%biot*solid%shear/stiffness
   end function factor_at

   !> The same without the effect of the tip [-].
   pure real(rk) function without_tip(problem, fracture_cell) result(factor)
      type(coarse_problem_t), intent(in) :: problem
      integer(ik), intent(in) :: fracture_cell
      type(solid_t) :: solid

      solid = solid_beside(problem, fracture_cell)
      factor = sqrt(2.0_rk/pi)*solid%biot*solid%shear/(solid%lame + 2.0_rk*solid%shear)
   end function without_tip

   !> The rock at a fracture cell.
   pure type(solid_t) function solid_beside(problem, fracture_cell) result(solid)
      type(coarse_problem_t), intent(in) :: problem
      integer(ik), intent(in) :: fracture_cell
      integer(ik) :: face

      face = problem%mesh%fracture%cell_faces(1, fracture_cell)
      solid = problem%model%rock%solid_at(problem%mesh%face_cells(1, face))
   end function solid_beside

   !> Distances from the face: 0, the nodes of the layer, the centre of the cell and its far node
   !! [m].
   pure function place_of(mesh, layers, layer) result(place)
      type(mesh_t), intent(in) :: mesh
      type(layers_t), intent(in) :: layers
      integer(ik), intent(in) :: layer
      real(rk), allocatable :: place(:)
      real(rk) :: height

      height = 2.0_rk*cell_area(mesh, layers%cell(layer)) &
               /face_length(mesh, mesh%layer_face(layer))
      place = [0.0_rk, layers%chain(layer)%place, height/3.0_rk, height]
   end function place_of

   !> Pressure of the layer at these distances beyond that of windows [Pa].
   !!
   !! The cell at a tip also has the singular pressure of undrained rock there, which windows do not
   !! have: the fluid drains it (coarse_tip_drainage), and it vanishes on the faces. The layer is
   !! therefore that of a difference from the window's pressure, with the shape that it has. The
   !! window's pressure, from the means of cells, has the content of the layer distributed over the
   !! cell: the rest of the cell has less.
   pure subroutine find_excess(mesh, layers, state, values, layer, alone, excess)
      type(mesh_t), intent(in) :: mesh
      type(layers_t), intent(in) :: layers
      type(state_t), intent(in) :: state
      type(coarse_values_t), intent(in) :: values
      integer(ik), intent(in) :: layer
      !> pressure beyond that of the rest of the cell, and beyond that of windows [Pa]
      real(rk), allocatable, intent(out) :: alone(:), excess(:)
      real(rk), parameter :: at_most = 2.0_rk  ! times the pressures of the layer [-]
      real(rk), parameter :: thirds(3) = 1.0_rk/3.0_rk  ! weights of the nodes at the centre [-]
      real(rk), allocatable :: place(:)
      real(rk) :: at_centre, at_face, beyond, rest
      integer(ik) :: last

      associate (chain => layers%chain(layer), cell => layers%cell(layer), &
                 face => mesh%layer_face(layer), x => state%unknowns)
         last = size(state%layer, 1, kind=ik)
         at_face = pressure_of_face(values%drained, mesh, values%nodal(3, :), face)
         at_centre = pressure_at(values%drained, mesh, values%nodal(3, :), cell, thirds)
         rest = x(3, layer_block(mesh, mesh%cell_layer(cell)))
         beyond = rest - x(3, cell)
         place = place_of(mesh, layers, layer)
         excess = [x(3, end_block(mesh, layers%fracture_cell(layer), layers%side(layer))), &
                   state%layer(:min(last, chain%n - 1), layer), x(1, layer_block(mesh, layer)), &
                   rest] - rest
         if (abs(excess(1)) > 0.0_rk) then
            excess = max(0.0_rk, min(at_most, (excess(1) + x(3, cell) - at_centre)/excess(1))) &
                     *excess
         end if
         alone = [excess, 0.0_rk]
         excess = [excess + beyond, 0.0_rk]
         last = size(place, kind=ik) - 1
         excess(:last) = excess(:last) - (at_face - at_centre)*(1.0_rk - place(:last)/place(last))
      end associate
   end subroutine find_excess

   !> Integral of values that are linear between places with the weight of a strip.
   pure real(rk) function weighted(behind, place, value)
      real(rk), intent(in) :: behind(2)  !< where the strip begins and ends behind the tip [m]
      real(rk), intent(in) :: place(:)  !< distances from the face [m]
      real(rk), intent(in) :: value(:)
      !> Gauss's rule of four points on (0, 1)
      real(rk), parameter :: at(4) = 0.5_rk + 0.5_rk*[-0.861136311594052575_rk, &
                                                      -0.339981043584856265_rk, &
                                                      0.339981043584856265_rk, &
                                                      0.861136311594052575_rk]
      real(rk), parameter :: of(4) = 0.5_rk*[0.347854845137453857_rk, 0.652145154862546143_rk, &
                                             0.652145154862546143_rk, 0.347854845137453857_rk]
      real(rk) :: n, root(2)
      integer(ik) :: i, k

      weighted = 0.0_rk
      do i = 1, size(place, kind=ik) - 1
         ! The root of the distance as variable: the weight is singular at the face.
         root = sqrt(place(i:i + 1))
         do k = 1, size(at, kind=ik)
            n = (root(1) + at(k)*(root(2) - root(1)))**2
            weighted = weighted + of(k)*(root(2) - root(1))*2.0_rk*sqrt(n)*strip_weight(n, behind) &
                       *(value(i) + (n - place(i))/(place(i + 1) - place(i)) &
                         *(value(i + 1) - value(i)))
         end do
      end do
   end function weighted

   !> The weight of a pressure at a distance from the face, from one place behind the tip to
   !! another [m^(-1/2)].
   pure real(rk) function strip_weight(n, behind)
      real(rk), intent(in) :: n  !< [m]
      real(rk), intent(in) :: behind(2)  !< [m]

      strip_weight = 2.0_rk*(root_of(behind(1)) - root_of(behind(2)))

   contains

      !> Re (-x + i n)^(-1/2).
      pure real(rk) function root_of(x)
         real(rk), intent(in) :: x  !< [m]

         root_of = real(1.0_rk/sqrt(cmplx(-x, n, rk)))
      end function root_of

   end function strip_weight

end module twolevel_back_stress
