!> Stress samples in the elements, and polynomials fitted to those around a node. A node at which
!! rocks meet has separate samples for each rock, since stresses jump across an interface.
module fine_patches
   use algebra_lapack, only: dpotrf, dpotrs
   use base_kinds, only: ik, rk
   use base_lists, only: inverted, lists_t
   use base_plane, only: triangle_area
   use fine_elasticity, only: rocks_t
   use fine_element, only: triangle_rule_3
   use fine_model, only: fine_model_t
   use mesh_geometry, only: split_by_kind
   implicit none(type, external)
   private

   public :: fit_quadratic, n_samples, n_terms, patch_of_site, quadratic_terms, samples_t
   public :: take_samples

   integer(ik), parameter :: n_samples = 3  !< points in an element
   integer(ik), parameter :: n_terms = 6  !< of a full quadratic
   integer(ik), parameter :: smallest_patch = 4  ! elements: 12 points for 6 terms

   !> Elastic stresses at points of all elements, and the neighbours of each element.
   type :: samples_t
      real(rk), allocatable :: xy(:, :, :)  !< (2, n_samples, n_cells) [m]
      real(rk), allocatable :: stress(:, :, :)  !< (xx yy xy, n_samples, n_cells) [Pa]
      real(rk), allocatable :: centre(:, :)  !< (2, n_cells) [m]
      real(rk), allocatable :: area(:)  !< (n_cells) [m2]
      !> (3, n_cells) the site of each corner of an element: its node, or, for a second rock there,
      !! a number beyond those
      integer(ik), allocatable :: site(:, :)
      integer(ik), allocatable :: node(:)  !< (sites) where each is
      type(lists_t) :: around  !< elements around each site
      integer(ik), allocatable :: neighbours(:, :)  !< (3, n_cells) across each edge, 0: none
   end type samples_t

contains

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
      integer(ik) :: cell, k

      samples%site = cell_nodes(:3, :)
      samples%node = [(k, k=1, n_vertices)]
      if (size(rocks%of_cell) == 1) return
      call split_by_kind([(rocks%index_of(cell), cell=1, size(cell_nodes, 2, kind=ik))], &
                         samples%site, samples%node)
   end subroutine find_sites

   !> Elements around every site, and across every edge: the elements that share its middle
   !! node.
   pure subroutine find_neighbours(n_nodes, cell_nodes, rocks, samples)
      integer(ik), intent(in) :: n_nodes
      integer(ik), intent(in) :: cell_nodes(:, :)  !< (6, n_cells)
      type(rocks_t), intent(in) :: rocks
      type(samples_t), intent(inout) :: samples
      integer(ik), allocatable :: first_cell(:), first_edge(:)
      integer(ik) :: cell, k, middle, n_cells

      n_cells = size(cell_nodes, 2)
      samples%around = inverted(samples%site, size(samples%node, kind=ik))
      allocate (samples%neighbours(3, n_cells), source=0_ik)
      allocate (first_cell(n_nodes), first_edge(n_nodes), source=0_ik)
      do cell = 1, n_cells
         do k = 1, 3
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

      patch = samples%around%of(site)
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

   !> Least-squares fit of quadratics to values at points. If the points do not determine a
   !! quadratic, it is reduced to a linear function, or to the mean.
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

end module fine_patches
