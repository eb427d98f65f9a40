!> Corrections of fracture cells at tips, where finite volumes do not resolve the jumps; radiation
!! damping.
!!
!! Toward a tip the jump falls with the square root of the distance; in a fracture cell it is
!! linear. A crack then slips and opens as if it were longer or shorter by a share of its tip cells
!! that does not decrease with their size, and the error is of first order. That share depends on
!! the mode and on Poisson's ratio nu, hardly on the mesh: -0.19 + 0.42 nu for opening and 0.11 +
!! 0.42 nu for slip, each within 0.03. Springs between the faces of the tip cells remove it. They
!! also let a tip lie anywhere in its cell, so that the mesh is not changed for each small advance:
!! the softer the springs, the farther the tip.
!!
!! Their stiffness follows from the closed form of one crack in an infinite body under uniform
!! pressure, and under uniform shear without friction: means over cracks of 20 cells at 20, 45 and
!! 70 degrees, for nu from 0 to 0.48 (docs/theory.md; verification/tip_cells has other sizes, angles
!! and loads). At an opening tip at the end of its cell it is negative, a quarter of the stiffness
!! that would make the body unstable. Rock between a tip and another fracture is more compliant, and
!! a quarter may be enough for instability: where they share a triangle, or the nodes of one, no
!! spring is negative.
!!
!! The same holds for leak-off: its flux rises toward a tip with one over the square root of the
!! distance, is uniform in a cell, and a crack leaks as if it were shorter by 0.22 of a cell at each
!! end. A resistance between the tip cells' fluid and the rock, a negative one where the tip is at
!! the end of its cell, reduces this to 0.02, or 0.05 where the tip is within its cell
!! (verification/strip_leak_off).
!!
!! Radiation damping (Rice 1993): faces that slip at the velocity V radiate shear waves, which
!! reduce the shear traction by eta V, eta = G/(2 c_s) with the velocity of shear waves c_s. So slip
!! without a quasi-static equilibrium has a velocity, and an end.
!!
!! In a step of length dt it is a spring of eta/dt on the slip, relative to the slip before.
module coarse_tips
   use base_kinds, only: ik, rk
   use coarse_condensed, only: condensed_t
   use coarse_rock, only: mean_solid, rock_t, solid_t
   use coarse_state, only: fracture_cells_t
   use mesh_types, only: fracture_mesh_t, mesh_t
   implicit none(type, external)
   private

   public :: crack_ends_t, dampers, free_ends, jumps_of, place_tips, tip_springs

   !> Ends of cracks: tips of the mesh, or points behind them if the last cells are closed. A crack
   !! may also end before a joint that the mesh contains.
   type :: crack_ends_t
      integer(ik), allocatable :: cell(:)  !< fracture cell that the fracture ends with
      integer(ik), allocatable :: inwards(:)  !< 1 or -1: from a cell to the next one behind it
      real(rk), allocatable :: ahead(:)  !< closed length of the mesh beyond each [m]
      !> Of coarse_tip_layer; unallocated: viscosity has no effect at any tip [1/m^(1/2)]
      real(rk), allocatable :: viscous(:)
   end type crack_ends_t

   real(rk), parameter :: least = 1.0e-3_rk  !< least share of the tip cell behind the tip [-]

   !> Resistances to leak-off as the stiffnesses of the springs below: at the end of the cell, in
   !! the cell, times the rock's mobility [-].
   real(rk), parameter :: leak_at_end = -0.173_rk, leak_within = 0.65_rk

contains

   !> The free tips of a mesh.
   pure function free_ends(fracture) result(ends)
      type(fracture_mesh_t), intent(in) :: fracture
      type(crack_ends_t) :: ends
      integer(ik) :: tip

      allocate (ends%cell(fracture%n_tips))
      allocate (ends%ahead(fracture%n_tips), source=0.0_rk)
      do tip = 1, fracture%n_tips
         ends%cell(tip) = fracture%point_cells%at(fracture%tip_point(tip), 1_ik)
      end do
      ends%inwards = merge(1_ik, -1_ik, fracture%tip_end == 1)
   end function free_ends

   !> Fracture cells with nodes on another fracture, or on an edge to it: their jumps act on the
   !! same triangles.
   pure function lie_beside_another(mesh) result(is_beside)
      type(mesh_t), intent(in) :: mesh
      logical :: is_beside(mesh%fracture%n_cells)
      integer(ik), parameter :: several = -1
      integer(ik) :: fracture_of(mesh%n_nodes)  ! 0: none
      logical :: has_other(mesh%n_nodes)
      integer(ik) :: cell, k, node, side

      fracture_of = 0
      do cell = 1, mesh%fracture%n_cells
         associate (fracture => mesh%fracture%cell_fracture(cell))
            do side = 1, 2
               do k = 1, 2
                  node = mesh%face_nodes(k, mesh%fracture%cell_faces(side, cell))
                  if (fracture_of(node) == 0) fracture_of(node) = fracture
                  if (fracture_of(node) /= fracture) fracture_of(node) = several
               end do
            end do
         end associate
      end do
      has_other = fracture_of == several
      do cell = 1, mesh%n_cells
         associate (nodes => mesh%cell_nodes(:, cell))
            do k = 1, 3
               has_other(nodes(k)) = has_other(nodes(k)) &
                                     .or. any(fracture_of(nodes) /= 0 &
                                              .and. fracture_of(nodes) /= fracture_of(nodes(k)))
            end do
         end associate
      end do
      do cell = 1, mesh%fracture%n_cells
         associate (faces => mesh%fracture%cell_faces(:, cell))
            is_beside(cell) = any(has_other(mesh%face_nodes(:, faces(1)))) &
                              .or. any(has_other(mesh%face_nodes(:, faces(2))))
         end associate
      end do
   end function lie_beside_another

   !> Stiffness of the springs at tips for the unknowns of q.
   pure function tip_springs(ends, rock, mesh, condensed) result(spring)
      type(crack_ends_t), intent(in) :: ends
      type(rock_t), intent(in) :: rock
      type(mesh_t), intent(in) :: mesh
      type(condensed_t), intent(in) :: condensed
      real(rk) :: spring(condensed%layout%count())  !< [Pa]
      type(solid_t) :: solid
      real(rk) :: at_end(2), left, share
      integer(ik) :: cell, step, tip
      logical :: is_beside(mesh%fracture%n_cells)

      spring = 0.0_rk
      is_beside = lie_beside_another(mesh)
      do tip = 1, size(ends%cell, kind=ik)
         cell = ends%cell(tip)
         step = ends%inwards(tip)
         solid = beside(cell)
         at_end = in_tip_cell(solid)
         left = ends%ahead(tip)
         do while (left >= (1.0_rk - least)*condensed%length(cell))  ! the tip is farther back
            call add(cell, (1.0_rk/least - 1.0_rk)*within(solid))
            left = max(0.0_rk, left - condensed%length(cell))
            cell = cell + step
            solid = beside(cell)
            at_end = in_cell_behind(solid)
         end do
         share = 1.0_rk - left/condensed%length(cell)
         at_end = at_end + (1.0_rk/share - 1.0_rk)*within(solid)
         if (is_beside(cell)) at_end = max(0.0_rk, at_end)
         call add(cell, at_end)
         if (share < 1.0_rk) call add(cell + step, (1.0_rk - share)*in_cell_behind(solid))
      end do

   contains

      !> Mean rock of both sides of a fracture cell.
      pure function beside(cell) result(solid)
         integer(ik), intent(in) :: cell
         type(solid_t) :: solid

         solid = mean_solid(rock, mesh%face_cells(1, mesh%fracture%cell_faces(:, cell)))
      end function beside

      !> Springs at both ends of a cell.
      pure subroutine add(cell, stiffness)
         integer(ik), intent(in) :: cell
         real(rk), intent(in) :: stiffness(2)  !< n, tau [Pa]
         integer(ik) :: end

         do end = 1, 2
            associate (at => condensed%layout%at_jump(cell, end))
               spring(at:at + 1) = spring(at:at + 1) + stiffness
            end associate
         end do
      end subroutine add

   end function tip_springs

   !> Set the cells of the tips, the share of each cell behind them, and the correction of leak-off.
   pure subroutine place_tips(ends, length, cells)
      type(crack_ends_t), intent(in) :: ends
      real(rk), intent(in) :: length(:)  !< (cells) [m]
      type(fracture_cells_t), intent(inout) :: cells
      real(rk) :: left
      integer(ik) :: cell, step, tip

      cells%share = spread(1.0_rk, 1, size(length))
      cells%has_tip = spread(.false., 1, size(length))
      cells%viscous = spread(0.0_rk, 1, size(length))
      cells%leak_resistance = spread(0.0_rk, 1, size(length))
      do tip = 1, size(ends%cell, kind=ik)
         cell = ends%cell(tip)
         step = ends%inwards(tip)
         left = ends%ahead(tip)
         do while (left >= (1.0_rk - least)*length(cell))
            cells%share(cell) = least
            cells%leak_resistance(cell) = (1.0_rk/least - 1.0_rk)*leak_within
            left = max(0.0_rk, left - length(cell))
            cell = cell + step
         end do
         cells%share(cell) = 1.0_rk - left/length(cell)
         cells%has_tip(cell) = .true.
         if (allocated(ends%viscous)) cells%viscous(cell) = ends%viscous(tip)
         associate (share => cells%share(cell), leak => cells%leak_resistance)
            leak(cell) = leak_at_end + (1.0_rk/share - 1.0_rk)*leak_within
            if (share < 1.0_rk) leak(cell + step) = leak(cell + step) + (1.0_rk - share)*leak_at_end
         end associate
      end do
   end subroutine place_tips

   !> Stiffness at either end of a tip cell with the tip at its end [Pa].
   pure function in_tip_cell(solid) result(spring)
      type(solid_t), intent(in) :: solid
      real(rk) :: spring(2)  !< n, tau

      associate (nu => solid%poisson())
         spring = solid%crack_modulus()*[-0.0471_rk + nu*(0.095_rk + 0.038_rk*nu), &
                                         0.0201_rk + nu*(0.0627_rk + 0.0415_rk*nu)]
      end associate
   end function in_tip_cell

   !> Additional stiffness of a tip cell with the tip inside, per ratio of the lengths ahead of and
   !! behind the tip [Pa].
   pure function within(solid) result(spring)
      type(solid_t), intent(in) :: solid
      real(rk) :: spring(2)  !< n, tau

      associate (nu => solid%poisson())
         spring = solid%crack_modulus()*[0.156_rk - 0.03_rk*nu, 0.1752_rk - 0.104_rk*nu]
      end associate
   end function within

   !> Additional stiffness of the cell behind a tip at the start of its cell [Pa].
   pure function in_cell_behind(solid) result(spring)
      type(solid_t), intent(in) :: solid
      real(rk) :: spring(2)  !< n, tau

      associate (nu => solid%poisson())
         spring = solid%crack_modulus()*[0.0133_rk + 0.049_rk*nu, &
                                         0.0133_rk + nu*(0.064_rk + 0.021_rk*nu)]
      end associate
   end function in_cell_behind

   !> Springs on the slip of the ends of the fracture cells, zero on all else [Pa] (and for the
   !! pressures [m2/Pa]).
   pure function dampers(condensed, stiffness) result(spring)
      type(condensed_t), intent(in) :: condensed
      real(rk), intent(in) :: stiffness  !< eta/dt [Pa/m]
      real(rk) :: spring(condensed%layout%count())
      integer(ik) :: end, i

      spring = 0.0_rk
      do i = 1, condensed%n
         do end = 1, 2
            spring(condensed%layout%at_jump(i, end) + 1) = 0.5_rk*condensed%length(i)*stiffness
         end do
      end do
   end function dampers

   !> Jumps in the order of the condensed unknowns, zero in the places of the pressures [m].
   pure function jumps_of(condensed, jump) result(q)
      type(condensed_t), intent(in) :: condensed
      real(rk), intent(in) :: jump(:, :, :)  !< (2, 2, n) [u]_n, [u]_tau at start, end [m]
      real(rk) :: q(condensed%layout%count())
      integer(ik) :: at, end, i

      q = 0.0_rk
      do i = 1, condensed%n
         do end = 1, 2
            at = condensed%layout%at_jump(i, end)
            q(at:at + 1) = jump(:, end, i)
         end do
      end do
   end function jumps_of

end module coarse_tips
