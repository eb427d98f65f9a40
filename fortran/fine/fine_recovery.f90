!> Stresses that are smoother, and closer to the truth, than those of the elements.
!!
!! Superconvergent patch recovery (Zienkiewicz and Zhu 1992): around every corner node a full
!! quadratic is fitted to stresses in the elements of its patch. Patches are made of elements that
!! share nodes, so they never reach across a fracture, and are of one rock. Around a free tip the
!! singular part, which no polynomial can follow, is fitted first and kept apart (Rodenas and others
!! 2008): the polynomials hold what remains.
!!
!! Area averaging (Zienkiewicz and Zhu 1987), for comparison, takes the mean stress of the elements
!! around a node, weighted with their areas, instead of the fit.
!!
!! Stress samples in the elements, and polynomials fitted to those around a node. Where rocks meet
!! at a node each has samples of its own there, for stresses jump across an interface.
module fine_recovery
   use algebra_lapack, only: dpotrf, dpotrs
   use base_kinds, only: ik, rk
   use base_plane, only: triangle_area
   use fine_elasticity, only: elasticity_t, rocks_t
   use fine_mesh, only: fine_mesh_t
   use fine_model, only: fine_model_t
   use fine_quadrature, only: triangle_rule_3
   use fine_tip_field, only: singular_stress, tip_field_t
   implicit none(type, external)
   private

   public :: recover_by_averages, recover_by_patches, recovered_stress, recovery_t

   !> An elastic stress field on the mesh: a quadratic in every element, plus the singular field of
   !! the tip in the elements around it.
   type :: recovery_t
      type(tip_field_t), allocatable :: tips(:)  !< (n_tips)
      integer(ik), allocatable :: tip_of_cell(:)  !< (n_cells) whose field is apart, else 0
      integer(ik), allocatable :: site(:, :)  !< (3, n_cells) whose fits hold at its corners
      integer(ik), allocatable :: tip_of_site(:)  !< (sites) whose field the fit leaves out
      real(rk), allocatable :: same_side(:, :)  !< (2, sites) a point on its side [m]
      real(rk), allocatable :: coefficients(:, :, :)  !< (n_terms, xx yy xy, sites) fits [Pa]
      real(rk), allocatable :: scale(:)  !< (sites) their unit of length [m]
   end type recovery_t

   integer(ik), parameter :: n_samples = 3  !< points in an element
   integer(ik), parameter :: n_terms = 6  !< of a full quadratic
   integer(ik), parameter :: smallest_patch = 4  ! elements: 12 points for 6 terms

   !> Elastic stresses at points of all elements, and who is whose neighbour.
   type :: samples_t
      real(rk), allocatable :: xy(:, :, :)  !< (2, n_samples, n_cells) [m]
      real(rk), allocatable :: stress(:, :, :)  !< (xx yy xy, n_samples, n_cells) [Pa]
      real(rk), allocatable :: centre(:, :)  !< (2, n_cells) [m]
      real(rk), allocatable :: area(:)  !< (n_cells) [m2]
      !> (3, n_cells) the site of each corner of an element: its node, or, for a second rock there,
      !! a number beyond those
      integer(ik), allocatable :: site(:, :)
      integer(ik), allocatable :: node(:)  !< (sites) where each is
      integer(ik), allocatable :: first(:)  !< (sites+1) into cells
      integer(ik), allocatable :: cells(:)  !< elements around each site
      integer(ik), allocatable :: neighbours(:, :)  !< (3, n_cells) across each edge, 0: none
   end type samples_t

contains

   !> Recovery by patches.
   subroutine recover_by_patches(model, displacement, recovery)
      type(fine_model_t), intent(in) :: model
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(recovery_t), intent(out) :: recovery
      type(samples_t) :: samples
      integer(ik), allocatable :: patch(:)
      real(rk), allocatable :: xy(:, :), values(:, :)
      integer(ik) :: i, k, site

      call take_samples(model, displacement, samples)
      call find_tips(model, samples, recovery)
      do site = 1, size(samples%node, kind=ik)
         patch = patch_of_site(samples, site)
         if (allocated(xy)) deallocate (xy, values)
         allocate (xy(2, n_samples*size(patch)), values(3, n_samples*size(patch)))
         recovery%scale(site) = sqrt(sum(samples%area(patch)))
         do i = 1, size(patch)
            do k = 1, n_samples
               associate (at => n_samples*(i - 1) + k)
                  xy(:, at) = (samples%xy(:, k, patch(i)) - model%mesh%xy(:, samples%node(site))) &
                              /recovery%scale(site)
                  values(:, at) = smooth_part(samples, recovery, site, k, patch(i))
               end associate
            end do
         end do
         call fit_quadratic(xy, values, recovery%coefficients(:, :, site))
      end do
   end subroutine recover_by_patches

   !> Recovery by averages.
   subroutine recover_by_averages(model, displacement, recovery)
      type(fine_model_t), intent(in) :: model
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(recovery_t), intent(out) :: recovery
      type(samples_t) :: samples
      real(rk) :: area
      integer(ik) :: i, k, site

      call take_samples(model, displacement, samples)
      call find_tips(model, samples, recovery)
      recovery%scale = 1.0_rk
      do site = 1, size(samples%node, kind=ik)
         associate (mean => recovery%coefficients(1, :, site), &
                    cells => samples%cells(samples%first(site):samples%first(site + 1) - 1))
            area = sum(samples%area(cells))
            do i = 1, size(cells)
               do k = 1, n_samples
                  mean = mean + samples%area(cells(i))/(n_samples*area) &
                         *smooth_part(samples, recovery, site, k, cells(i))
               end do
            end do
         end associate
      end do
   end subroutine recover_by_averages

   !> The recovered stress (xx yy xy) at a point of an element [Pa]. In an element it is the
   !! quadratic through the values of the fits at the corners and the means of two fits at the
   !! middles of the edges.
   pure function recovered_stress(fine, recovery, cell, area_coordinates) result(stress)
      type(fine_mesh_t), intent(in) :: fine
      type(recovery_t), intent(in) :: recovery
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: area_coordinates(3)  !< barycentric coordinates in space [-]
      real(rk) :: stress(3)
      real(rk) :: corner(2, 3), here(2), middle(2), centre(2)
      integer(ik) :: k, next

      associate (nodes => fine%cell_nodes(1:3, cell), l => area_coordinates)
         corner = fine%xy(:, nodes)
         centre = sum(corner, dim=2)/3.0_rk
         stress = 0.0_rk
         do k = 1, 3
            next = mod(k, 3) + 1
            middle = 0.5_rk*(corner(:, k) + corner(:, next))
            stress = stress + l(k)*(2.0_rk*l(k) - 1.0_rk)*value_at(k, corner(:, k)) &
                     + 2.0_rk*l(k)*l(next)*(value_at(k, middle) &
                                            + value_at(next, middle))
         end do
         if (recovery%tip_of_cell(cell) > 0) then
            here = matmul(corner, l)
            stress = stress + singular_stress(recovery%tips(recovery%tip_of_cell(cell)), here, &
                                              centre)
         end if
      end associate

   contains

      !> The fit of a corner at a point: with the singular field of its tip, unless the element adds
      !! that.
      pure function value_at(corner_number, xy) result(value)
         integer(ik), intent(in) :: corner_number
         real(rk), intent(in) :: xy(2)  !< [m]
         real(rk) :: value(3)
         integer(ik) :: site

         site = recovery%site(corner_number, cell)
         value = matmul(quadratic_terms((xy - corner(:, corner_number))/recovery%scale(site)), &
                        recovery%coefficients(:, :, site))
         if (recovery%tip_of_site(site) > 0 .and. recovery%tip_of_cell(cell) == 0) then
            value = value + singular_stress(recovery%tips(recovery%tip_of_site(site)), xy, &
                                            recovery%same_side(:, site))
         end if
      end function value_at

   end function recovered_stress

   !> A sample without the singular field that the vertex' fit leaves out. Around the tip itself
   !! every element lies on one side.
   pure function smooth_part(samples, recovery, site, k, cell) result(stress)
      type(samples_t), intent(in) :: samples
      type(recovery_t), intent(in) :: recovery
      integer(ik), intent(in) :: site, k, cell
      real(rk) :: stress(3)

      stress = samples%stress(:, k, cell)
      associate (tip => recovery%tip_of_site(site))
         if (tip == 0) return
         if (recovery%tip_of_cell(cell) == tip) then
            stress = stress - singular_stress(recovery%tips(tip), samples%xy(:, k, cell), &
                                              samples%centre(:, cell))
         else
            stress = stress - singular_stress(recovery%tips(tip), samples%xy(:, k, cell), &
                                              recovery%same_side(:, site))
         end if
      end associate
   end function smooth_part

   !> The tips, and where their fields are kept apart: at the sites of the elements around a tip,
   !! and in these elements.
   subroutine find_tips(model, samples, recovery)
      type(fine_model_t), intent(in) :: model
      type(samples_t), intent(in) :: samples
      type(recovery_t), intent(inout) :: recovery
      integer(ik), allocatable :: n_same_side(:)
      integer(ik) :: cell, i, k, tip, site

      associate (fine => model%mesh, fracture => model%mesh%fracture)
         allocate (recovery%tips(fracture%n_tips), recovery%scale(size(samples%node)))
         allocate (recovery%coefficients(n_terms, 3, size(samples%node)), source=0.0_rk)
         allocate (recovery%same_side(2, size(samples%node)), source=0.0_rk)
         allocate (recovery%tip_of_cell(fine%n_cells), recovery%tip_of_site(size(samples%node)), &
                   source=0_ik)
         recovery%site = samples%site
         allocate (n_same_side(size(samples%node)), source=0_ik)
         do tip = 1, fracture%n_tips
            do i = samples%first(fracture%tip_node(tip)), &
               samples%first(fracture%tip_node(tip) + 1) - 1
               cell = samples%cells(i)
               recovery%tip_of_cell(cell) = tip
               do k = 1, 3
                  site = samples%site(k, cell)
                  recovery%tip_of_site(site) = tip
                  n_same_side(site) = n_same_side(site) + 1
                  recovery%same_side(:, site) = recovery%same_side(:, site) &
                                                + samples%centre(:, cell)
               end do
            end do
            call fit_tip(model, samples, tip, recovery%tips(tip))
         end do
         do site = 1, size(samples%node, kind=ik)
            if (n_same_side(site) == 0) cycle
            recovery%same_side(:, site) = recovery%same_side(:, site)/n_same_side(site)
         end do
      end associate
   end subroutine find_tips

   !> The singular field that, with a uniform stress, comes closest to the samples around a tip. The
   !! weight r makes up for the growth of the stress towards the tip.
   subroutine fit_tip(model, samples, tip, field)
      type(fine_model_t), intent(in) :: model
      type(samples_t), intent(in) :: samples
      integer(ik), intent(in) :: tip
      type(tip_field_t), intent(out) :: field
      integer(ik), parameter :: n_unknowns = 5
      real(rk) :: normal(n_unknowns, n_unknowns), right(n_unknowns, 1), columns(3, n_unknowns)
      type(elasticity_t) :: rock
      real(rk) :: weight, unit
      integer(ik) :: cell, i, info, k, mode, node

      node = model%mesh%fracture%tip_node(tip)
      field%origin = model%mesh%xy(:, node)
      field%ahead = model%mesh%fracture%tip_direction(:, tip)
      rock = model%rocks%in_cell(samples%cells(samples%first(node)))
      field%kolosov = rock%kolosov()
      field%shear_modulus = rock%shear_modulus()
      ! The unit of the intensities that makes all columns of one size.
      associate (around => samples%cells(samples%first(node):samples%first(node + 1) - 1))
         unit = sum(samples%area(around))**0.25_rk
      end associate
      normal = 0.0_rk
      right = 0.0_rk
      do i = samples%first(node), samples%first(node + 1) - 1
         cell = samples%cells(i)
         do k = 1, n_samples
            columns = 0.0_rk
            do mode = 1, 2
               field%intensity = 0.0_rk
               field%intensity(mode) = unit
               columns(:, mode) = singular_stress(field, samples%xy(:, k, cell), &
                                                  samples%centre(:, cell))
            end do
            columns(1, 3) = 1.0_rk
            columns(2, 4) = 1.0_rk
            columns(3, 5) = 1.0_rk
            weight = samples%area(cell)*norm2(samples%xy(:, k, cell) - field%origin)/unit**6
            normal = normal + weight*matmul(transpose(columns), columns)
            right(:, 1) = right(:, 1) + weight*matmul(samples%stress(:, k, cell), columns)
         end do
      end do
      field%intensity = 0.0_rk
      call dpotrf("U", n_unknowns, normal, n_unknowns, info)
      if (info /= 0) return
      call dpotrs("U", n_unknowns, 1_ik, normal, n_unknowns, right, n_unknowns, info)
      field%intensity = unit*right(1:2, 1)
   end subroutine fit_tip

   !> Stresses of the elements, without pore pressure and in-situ stress, at three points inside
   !! each.
   subroutine take_samples(model, displacement, samples)
      type(fine_model_t), intent(in) :: model
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(samples_t), intent(out) :: samples
      real(rk) :: points(3, n_samples), weights(n_samples), stress(2, 2)
      real(rk) :: values(6), gradients(2, 6), area_coordinates(3), determinant
      integer(ik) :: cell, k

      call triangle_rule_3(points, weights)
      associate (fine => model%mesh, n => model%mesh%n_cells)
         allocate (samples%xy(2, n_samples, n), samples%stress(3, n_samples, n))
         allocate (samples%area(n), samples%centre(2, n))
         do cell = 1, n
            associate (nodes => fine%cell_nodes(:, cell), rock => model%rocks%in_cell(cell))
               samples%area(cell) = triangle_area(fine%xy(:, nodes(1:3)))
               samples%centre(:, cell) = sum(fine%xy(:, nodes(1:3)), dim=2)/3.0_rk
               do k = 1, n_samples
                  call fine%evaluate(cell, points(:, k), values, gradients, area_coordinates, &
                                     determinant)
                  samples%xy(:, k, cell) = matmul(fine%xy(:, nodes), values)
                  stress = rock%total_stress(matmul(displacement(:, nodes), &
                                                    transpose(gradients)), 0.0_rk)
                  samples%stress(:, k, cell) = [stress(1, 1), stress(2, 2), stress(1, 2)]
               end do
            end associate
         end do
         call find_sites(fine%n_vertices, fine%cell_nodes, model%rocks, samples)
         call find_neighbours(fine%n_nodes, fine%cell_nodes, model%rocks, samples)
      end associate
   end subroutine take_samples

   !> The sites of the corners of all elements.
   pure subroutine find_sites(n_vertices, cell_nodes, rocks, samples)
      integer(ik), intent(in) :: n_vertices
      integer(ik), intent(in) :: cell_nodes(:, :)  !< (6, n_cells)
      type(rocks_t), intent(in) :: rocks
      type(samples_t), intent(inout) :: samples
      integer(ik), allocatable :: next(:), rock(:)
      integer(ik) :: cell, k, n, own, site

      samples%site = cell_nodes(:3, :)
      samples%node = [(k, k=1, n_vertices)]
      if (size(rocks%of_cell) == 1) return
      n = n_vertices
      allocate (next(4*n), rock(4*n), source=0_ik)  ! the sites of a node are a chain
      do cell = 1, size(cell_nodes, 2, kind=ik)
         own = rocks%index_of(cell)
         do k = 1, 3
            site = cell_nodes(k, cell)
            if (rock(site) == 0) rock(site) = own
            do while (rock(site) /= own)
               if (next(site) == 0) then
                  n = n + 1
                  if (n > size(next)) then
                     next = [next, spread(0_ik, 1, n)]
                     rock = [rock, spread(0_ik, 1, n)]
                  end if
                  next(site) = n
                  rock(n) = own
                  samples%node = [samples%node, cell_nodes(k, cell)]
               end if
               site = next(site)
            end do
            samples%site(k, cell) = site
         end do
      end do
   end subroutine find_sites

   !> Elements around every site, and across every edge: the elements that share its middle
   !! node.
   pure subroutine find_neighbours(n_nodes, cell_nodes, rocks, samples)
      integer(ik), intent(in) :: n_nodes
      integer(ik), intent(in) :: cell_nodes(:, :)  !< (6, n_cells)
      type(rocks_t), intent(in) :: rocks
      type(samples_t), intent(inout) :: samples
      integer(ik), allocatable :: filled(:), first_cell(:), first_edge(:)
      integer(ik) :: cell, k, middle, n_cells, n_sites, site

      n_cells = size(cell_nodes, 2)
      n_sites = size(samples%node)
      allocate (samples%cells(3*n_cells))
      allocate (samples%neighbours(3, n_cells), samples%first(n_sites + 1), source=0_ik)
      do cell = 1, n_cells
         do k = 1, 3
            site = samples%site(k, cell)
            samples%first(site + 1) = samples%first(site + 1) + 1
         end do
      end do
      samples%first(1) = 1
      do site = 1, n_sites
         samples%first(site + 1) = samples%first(site + 1) + samples%first(site)
      end do
      allocate (filled, source=samples%first)
      allocate (first_cell(n_nodes), first_edge(n_nodes), source=0_ik)
      do cell = 1, n_cells
         do k = 1, 3
            site = samples%site(k, cell)
            samples%cells(filled(site)) = cell
            filled(site) = filled(site) + 1
            middle = cell_nodes(3 + k, cell)
            if (first_cell(middle) == 0) then
               first_cell(middle) = cell
               first_edge(middle) = k
            else if (rocks%index_of(first_cell(middle)) == rocks%index_of(cell)) then
               samples%neighbours(k, cell) = first_cell(middle)
               samples%neighbours(first_edge(middle), first_cell(middle)) = cell
            end if
         end do
      end do
   end subroutine find_neighbours

   !> The elements around a site, with their neighbours where these are too few.
   pure function patch_of_site(samples, site) result(patch)
      type(samples_t), intent(in) :: samples
      integer(ik), intent(in) :: site
      integer(ik), allocatable :: patch(:)
      integer(ik), allocatable :: longer(:)
      integer(ik) :: i, k, next

      patch = samples%cells(samples%first(site):samples%first(site + 1) - 1)
      do while (size(patch) < min(smallest_patch, size(samples%area)))
         longer = patch
         do i = 1, size(patch)
            do k = 1, 3
               next = samples%neighbours(k, patch(i))
               if (next == 0) cycle
               if (any(longer == next)) cycle
               longer = [longer, next]
            end do
         end do
         if (size(longer) == size(patch)) exit
         call move_alloc(longer, patch)
      end do
   end function patch_of_site

   !> The terms of a quadratic.
   pure function quadratic_terms(xy) result(term)
      real(rk), intent(in) :: xy(2)  !< from the node, in units of the patch's size [-]
      real(rk) :: term(n_terms)

      term = [1.0_rk, xy(1), xy(2), xy(1)**2, xy(1)*xy(2), xy(2)**2]
   end function quadratic_terms

   !> The quadratics that come closest to values at points, by least squares. Where the points
   !! leave a quadratic undetermined it is reduced to a linear function, or to their mean.
   subroutine fit_quadratic(xy, values, coefficients)
      real(rk), intent(in) :: xy(:, :)  !< (2, n) from the node, in units of the patch's size [-]
      real(rk), intent(in) :: values(:, :)  !< (xx yy xy, n) [Pa]
      real(rk), intent(out) :: coefficients(n_terms, 3)  !< (term, xx yy xy) [Pa]
      integer(ik), parameter :: orders(3) = [6, 3, 1]  ! terms of a quadratic, a linear, a constant
      real(rk), parameter :: smallest = 1.0e-6_rk  ! pivot over its diagonal entry, both rooted
      real(rk) :: normal(n_terms, n_terms), right(n_terms, 3), term(n_terms), diagonal(n_terms)
      integer(ik) :: component, i, info, k, n, order

      normal = 0.0_rk
      right = 0.0_rk
      do i = 1, size(xy, 2)
         term = quadratic_terms(xy(:, i))
         do k = 1, n_terms
            normal(:, k) = normal(:, k) + term(k)*term
         end do
         do component = 1, 3
            right(:, component) = right(:, component) + values(component, i)*term
         end do
      end do
      coefficients = 0.0_rk
      do order = 1, size(orders)
         n = orders(order)
         block
            real(rk) :: factor(n, n)

            factor = normal(:n, :n)
            do k = 1, n
               diagonal(k) = factor(k, k)
            end do
            call dpotrf("U", n, factor, n, info)
            if (info /= 0) cycle
            do k = 1, n
               if (.not. factor(k, k) > smallest*sqrt(diagonal(k))) info = k
            end do
            if (info /= 0) cycle
            coefficients(:n, :) = right(:n, :)
            call dpotrs("U", n, 3_ik, factor, n, coefficients, n_terms, info)
            return
         end block
      end do
   end subroutine fit_quadratic

end module fine_recovery
