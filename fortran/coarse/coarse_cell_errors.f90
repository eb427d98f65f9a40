!> Estimated errors of the cells in the energy norm, without a further solution.
!!
!! The mixed scheme has tractions sigma_h and fluxes q_h in equilibrium. With the nodal means u*, p*
!! of what the cells extrapolate, linear in each cell, the differences sigma_h - (C eps(u*) - alpha
!! p I) and q_h + (K/mu) grad p* bound the errors (Prager and Synge 1947):
!!   e_c**2 = 1/2 int d : C : d + dt/2 int g . (K/mu) g,  d = A sigma' - eps(u*), g = gradients'
!! difference. For the response to a well at a constant rate in one step of length dt this is also
!! the error of the well's work, p V/2, and of its pressure: the scheme is symmetric, so that the
!! response is its own dual solution. Cells with a layer (coarse_layers) have no error of the flow,
!! which is one-dimensional there.
module coarse_cell_errors
   use base_kinds, only: ik, rk
   use coarse_diffusion, only: corner_gradient, region_fluxes
   use coarse_fields, only: corner_gradients
   use coarse_layout, only: layer_block
   use coarse_nodes, only: nodal_fields
   use coarse_regions, only: regions_t
   use coarse_rock, only: rock_t
   use mesh_geometry, only: cell_area, cell_centre
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: cell_errors, rock_fields, rock_fields_t, sizes_for

   !> Fields of the rock in a state.
   type :: rock_fields_t
      real(rk), allocatable :: nodal(:, :)  !< (3, n_nodes) displacement [m], pressure [Pa]
      real(rk), allocatable :: strain(:, :, :, :)  !< (2, 2, corner, n_cells) with rotation [-]
      real(rk), allocatable :: slope(:, :, :)  !< (2, corner, n_cells) of the pressure [Pa/m]
   end type rock_fields_t

contains

   !> Find the fields of a state.
   subroutine rock_fields(mesh, rock, regions, unknowns, tractions, fields)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(regions_t), intent(in) :: regions
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), intent(in) :: tractions(:)  !< of corner_tractions [Pa]
      type(rock_fields_t), intent(out) :: fields
      real(rk), allocatable :: flux(:), scalars(:)
      real(rk) :: at_centre, number(mesh%n_nodes)
      integer(ik) :: c, cell, k, r

      allocate (fields%nodal(3, mesh%n_nodes), fields%strain(2, 2, 3, mesh%n_cells))
      allocate (fields%slope(2, 3, mesh%n_cells), source=0.0_rk)
      call nodal_fields(mesh, rock, regions, unknowns, tractions, values=fields%nodal)
      scalars = regions%scalars_of(unknowns)
      do c = 1, mesh%n_cells
         call corner_gradients(mesh, rock, regions, unknowns, tractions, c, &
                               fields%strain(:, :, :, c))
      end do
      fields%nodal(3, :) = 0.0_rk
      number = 0.0_rk
      do r = 1, regions%n_regions
         flux = spread(0.0_rk, 1, int(regions%flow_faces%length(r)))
         call region_fluxes(regions, regions%flux, scalars, r, flux)
         do c = 1, regions%cell_count(r)
            cell = regions%blocks%at(r, c)
            k = findloc(regions%regions_of_block(:, cell), r, dim=1)
            call corner_gradient(mesh, rock%resistivity, regions, flux, cell, k, &
                                 fields%slope(:, k, cell))
            at_centre = unknowns(3, cell)
            if (mesh%n_layers > 0) then  ! the gradient is that of the rest of the cell
               if (mesh%cell_layer(cell) > 0) at_centre = unknowns(3, layer_block(mesh, &
                                                                             mesh%cell_layer(cell)))
            end if
            associate (v => mesh%cell_nodes(k, cell))
               number(v) = number(v) + 1.0_rk
               fields%nodal(3, v) = fields%nodal(3, v) + at_centre &
                                    + dot_product(fields%slope(:, k, cell), &
                                                  mesh%xy(:, v) - cell_centre(mesh, cell))
            end associate
         end do
      end do
      fields%nodal(3, :) = fields%nodal(3, :)/number
   end subroutine rock_fields

   !> Squared errors of the change from one state to another in a step of length dt, and its energy
   !! [N m/m].
   subroutine cell_errors(mesh, rock, before, after, dt, squares, energy)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      type(rock_fields_t), intent(in) :: before, after
      real(rk), intent(in) :: dt  !< [s]
      real(rk), intent(out) :: squares(:)  !< (n_cells)
      real(rk), intent(out) :: energy
      real(rk) :: change(3, 3), gradient(3, 2), slope(2), strain(2, 2), weight
      integer(ik) :: c, k
      logical :: has_layer

      squares = 0.0_rk
      energy = 0.0_rk
      do c = 1, mesh%n_cells
         associate (node => mesh%cell_nodes(:, c))
            change = after%nodal(:, node) - before%nodal(:, node)
            gradient = linear_gradient(mesh%xy(:, node), change)
         end associate
         weight = cell_area(mesh, c)/6.0_rk
         has_layer = .false.
         if (mesh%n_layers > 0) has_layer = mesh%cell_layer(c) > 0
         do k = 1, 3
            strain = after%strain(:, :, k, c) - before%strain(:, :, k, c)
            energy = energy + weight*strain_energy(rock, c, strain)
            squares(c) = squares(c) + weight*strain_energy(rock, c, strain - gradient(1:2, :))
            if (has_layer) cycle
            slope = after%slope(:, k, c) - before%slope(:, k, c)
            energy = energy + weight*dt*flow_power(rock, c, slope)
            squares(c) = squares(c) + weight*dt*flow_power(rock, c, slope - gradient(3, :))
         end do
      end do
   end subroutine cell_errors

   !> Twice the energy of a strain, per area [Pa].
   pure real(rk) function strain_energy(rock, cell, gradient) result(energy)
      type(rock_t), intent(in) :: rock
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: gradient(2, 2)  !< of the displacement [-]
      integer(ik) :: at

      at = min(cell, size(rock%shear, kind=ik))
      energy = rock%shear(at)*(2.0_rk*gradient(1, 1)**2 + 2.0_rk*gradient(2, 2)**2 &
                               + (gradient(1, 2) + gradient(2, 1))**2) &
               + rock%lame(at)*(gradient(1, 1) + gradient(2, 2))**2
   end function strain_energy

   !> Power of the flow that a gradient drives, per area [W/m3].
   pure real(rk) function flow_power(rock, cell, slope) result(power)
      type(rock_t), intent(in) :: rock
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: slope(2)  !< [Pa/m]

      associate (r => rock%resistivity(:, :, min(int(cell), size(rock%resistivity, 3))))
         power = (r(2, 2)*slope(1)**2 - (r(1, 2) + r(2, 1))*slope(1)*slope(2) &
                  + r(1, 1)*slope(2)**2)/(r(1, 1)*r(2, 2) - r(1, 2)*r(2, 1))
      end associate
   end function flow_power

   !> Gradients of values that are linear in a triangle.
   pure function linear_gradient(xy, values) result(gradient)
      real(rk), intent(in) :: xy(2, 3)  !< [m]
      real(rk), intent(in) :: values(3, 3)  !< (quantity, corner)
      real(rk) :: gradient(3, 2)
      real(rk) :: a(2), b(2)

      a = xy(:, 2) - xy(:, 1)
      b = xy(:, 3) - xy(:, 1)
      associate (along_a => values(:, 2) - values(:, 1), along_b => values(:, 3) - values(:, 1))
         gradient(:, 1) = along_a*b(2) - along_b*a(2)
         gradient(:, 2) = along_b*a(1) - along_a*b(1)
      end associate
      gradient = gradient/(a(1)*b(2) - a(2)*b(1))
   end function linear_gradient

   !> Changes of size with which all cells have the same error, and together the given one. The
   !! square of a cell's error is of fourth order in its size: stress and flux are of first order.
   pure function sizes_for(squares, total) result(change)
      real(rk), intent(in) :: squares(:)  !< (n_cells) squared errors [any unit]
      real(rk), intent(in) :: total  !< sum of the squares that is wanted [unit of squares]
      real(rk) :: change(size(squares))  !< size over the present one [-]
      real(rk), parameter :: finest = 0.25_rk, coarsest = 4.0_rk  ! change of size at once
      real(rk) :: root(size(squares)), share

      root = sqrt(squares)
      share = total/max(sum(root), tiny(total))
      change = max(finest, sqrt(share/max(root, share/coarsest**2)))
   end function sizes_for

end module coarse_cell_errors
