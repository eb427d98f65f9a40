!> How far a solution is from the truth, in energy, and how fine a mesh would have to be.
!!
!! The error of an element is estimated by the energy of the difference between its stress and the
!! recovered one (Zienkiewicz and Zhu 1987, 1992), the energy norm of a stress being the root of
!! int s C^-1 s dA.
module fine_error
   use base_kinds, only: ik, rk
   use fine_elasticity, only: elasticity_t
   use fine_mesh, only: fine_mesh_t
   use fine_model, only: fine_model_t
   use fine_quadrature, only: collapsed_rule, triangle_rule_7
   use fine_recovery, only: recovered_stress, recovery_t
   implicit none(type, external)
   private

   public :: energy_error_t, estimate_error, wanted_sizes

   !> Errors in the energy norm.
   type :: energy_error_t
      real(rk), allocatable :: element(:)  !< (n_cells) [(J/m)^1/2]
      real(rk) :: total = 0.0_rk  !< root of the sum of their squares [(J/m)^1/2]
      real(rk) :: solution = 0.0_rk  !< energy norm of the solution [(J/m)^1/2]
      real(rk) :: relative = 0.0_rk  !< total over the norm of solution and error together [-]
   end type energy_error_t

contains

   !> Compare the stresses of the elements with the recovered ones.
   subroutine estimate_error(model, displacement, recovery, estimate)
      type(fine_model_t), intent(in) :: model
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(recovery_t), intent(in) :: recovery
      type(energy_error_t), intent(out) :: estimate
      integer(ik) :: cell

      allocate (estimate%element(model%mesh%n_cells))
      do cell = 1, model%mesh%n_cells
         estimate%element(cell) = sqrt(squared_error(model, displacement, recovery, cell))
      end do
      estimate%total = norm2(estimate%element)
      estimate%solution = sqrt(max(0.0_rk, 2.0_rk*model%strain_energy(displacement)))
      if (estimate%total > 0.0_rk) then
         estimate%relative = estimate%total/hypot(estimate%solution, estimate%total)
      end if
   end subroutine estimate_error

   !> Squared energy norm of the difference in one element [J/m].
   pure real(rk) function squared_error(model, displacement, recovery, cell)
      type(fine_model_t), intent(in) :: model
      real(rk), intent(in) :: displacement(:, :)
      type(recovery_t), intent(in) :: recovery
      integer(ik), intent(in) :: cell
      integer(ik), parameter :: n_t = 4, n_w = 5
      real(rk) :: points(3, n_t*n_w), weights(n_t*n_w)
      real(rk) :: values(6), gradients(2, 6), area_coordinates(3), determinant
      real(rk) :: stress(2, 2), difference(3)
      integer(ik) :: corner, n_points, point

      corner = 0
      if (recovery%tip_of_cell(cell) > 0) then
         corner = findloc(model%mesh%cell_nodes(1:3, cell), &
                          model%mesh%fracture%tip_node(recovery%tip_of_cell(cell)), dim=1)
      end if
      if (corner > 0) then
         n_points = n_t*n_w
         call collapsed_rule(corner, n_t, n_w, points, weights)
      else
         n_points = 7
         call triangle_rule_7(points(:, 1:7), weights(1:7))
      end if
      squared_error = 0.0_rk
      associate (nodes => model%mesh%cell_nodes(:, cell))
         do point = 1, n_points
            call model%mesh%evaluate(cell, points(:, point), values, gradients, &
                                     area_coordinates, determinant)
            stress = model%elasticity%total_stress(matmul(displacement(:, nodes), &
                                                          transpose(gradients)), 0.0_rk)
            difference = recovered_stress(model%mesh, recovery, cell, area_coordinates) &
                         - [stress(1, 1), stress(2, 2), stress(1, 2)]
            squared_error = squared_error + weights(point)*determinant &
                            *strain_product(model%elasticity, difference)
         end do
      end associate
   end function squared_error

   !> s C^-1 s of a stress xx, yy, xy [J/m3].
   pure real(rk) function strain_product(elasticity, stress)
      type(elasticity_t), intent(in) :: elasticity
      real(rk), intent(in) :: stress(3)  !< [Pa]
      real(rk) :: share

      associate (lambda => elasticity%lame_lambda(), mu => elasticity%shear_modulus())
         share = lambda/(2.0_rk*(lambda + mu))
         strain_product = (stress(1)**2 + stress(2)**2 + 2.0_rk*stress(3)**2 &
                           - share*(stress(1) + stress(2))**2)/(2.0_rk*mu)
      end associate
   end function strain_product

   !> Element sizes with which the mesh of fewest elements would reach a relative error, all
   !! elements having the same share in it (Li and Bettess 1995).
   !!
   !! The squared error of a region is proportional to h**(2 p), p = 2 where the solution is smooth.
   !! Equal shares total**2/n for n new elements then ask for h_new/h = (total/(sqrt(n) e))**(1/(p +
   !! 1)), and n is the sum of (h/h_new)**2. The elements around a tip are as many after refinement
   !! as before, and their squared error falls with h only, as the singular field keeps its shape:
   !! h_new/h = (total/(sqrt(n) e))**2.
   pure function wanted_sizes(fine, estimate, relative) result(sizes)
      type(fine_mesh_t), intent(in) :: fine
      type(energy_error_t), intent(in) :: estimate
      real(rk), intent(in) :: relative  !< wanted error over the norm of the solution [-]
      real(rk), allocatable :: sizes(:)  !< (n_cells) edge of an equilateral element [m]
      real(rk), parameter :: smooth_order = 2.0_rk  ! p of quadratic elements
      real(rk), parameter :: finest = 0.1_rk, coarsest = 4.0_rk  ! change of size at once
      real(rk) :: allowed, edge(2, 2), number, ratio
      logical :: at_tip(fine%n_cells), is_tip(fine%n_nodes)
      integer(ik) :: cell

      is_tip = .false.
      is_tip(fine%fracture%tip_node) = .true.
      do cell = 1, fine%n_cells
         at_tip(cell) = any(is_tip(fine%cell_nodes(1:3, cell)))
      end do
      allowed = relative*hypot(estimate%solution, estimate%total)
      number = sum((estimate%element/allowed)**(2.0_rk/(smooth_order + 1.0_rk)), &
                   mask=.not. at_tip)**((smooth_order + 1.0_rk)/smooth_order) + count(at_tip)
      number = max(1.0_rk, number)

      allocate (sizes(fine%n_cells))
      do cell = 1, fine%n_cells
         associate (nodes => fine%cell_nodes(:, cell))
            edge(:, 1) = fine%xy(:, nodes(2)) - fine%xy(:, nodes(1))
            edge(:, 2) = fine%xy(:, nodes(3)) - fine%xy(:, nodes(1))
         end associate
         ratio = coarsest
         if (estimate%element(cell) > 0.0_rk) then
            ratio = allowed/(sqrt(number)*estimate%element(cell))
            if (at_tip(cell)) then
               ratio = ratio**2
            else
               ratio = ratio**(1.0_rk/(smooth_order + 1.0_rk))
            end if
         end if
         sizes(cell) = max(finest, min(coarsest, ratio)) &
                       *sqrt(2.0_rk*(edge(1, 1)*edge(2, 2) - edge(2, 1)*edge(1, 2))/sqrt(3.0_rk))
      end do
   end function wanted_sizes

end module fine_error
