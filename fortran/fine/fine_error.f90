!> Error estimates of a solution in the energy norm, and element sizes for a prescribed error.
!!
!! The error of an element is estimated by the energy of the difference between its stress and the
!! recovered one (Zienkiewicz and Zhu 1987, 1992), the energy norm of a stress being the root of
!! int s C^-1 s dA.
!!
!! The error of stress intensity factors from that of the whole solution.
!!
!! K is a linear function of the displacement (fine_tip_interaction), z the displacement that its
!! nodal forces cause in the same body. The error of K is then a(e_u, e_z), the energy of the error
!! of the solution in the strain of that of z (Becker and Rannacher 2001); both are estimated by
!! recovered stresses.
module fine_error
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_plane, only: norm2, triangle_area
   use fine_elasticity, only: elasticity_t
   use fine_element, only: tip_rule, tip_rule_size
   use fine_faces, only: face_loaded
   use fine_mesh, only: fine_mesh_t
   use fine_model, only: fine_model_t
   use fine_recovery, only: recover_by_patches, recovered_stress, recovery_t
   use fine_tip_interaction, only: tip_probe_t
   use fine_tip_types, only: complete_errors, intensity_t
   implicit none(type, external)
   private

   public :: correct_intensity, energy_error_t, estimate_error, has_dual, wanted_sizes

   !> 2 m of wanted_sizes: sizes that grow by 0.3 per distance, as the mesh library makes them, put
   !! 2 pi/(0.3**2 sqrt(3)/4) = 161 elements around a tip for every factor e in distance.
   real(rk), parameter :: tip_elements = 322.0_rk

   !> Errors in the energy norm.
   type :: energy_error_t
      real(rk), allocatable :: element(:)  !< (n_cells) [(J/m)^1/2]
      logical, allocatable :: left_out(:)  !< (n_cells) with no error and no energy, size as it is
      real(rk) :: total = 0.0_rk  !< root of the sum of their squares [(J/m)^1/2]
      real(rk) :: solution = 0.0_rk  !< energy norm of the solution [(J/m)^1/2]
      real(rk) :: relative = 0.0_rk  !< total over the norm of solution and error together [-]
   end type energy_error_t

contains

   !> Compare the stresses of the elements with the recovered ones. Elements may be left out, such
   !! as those near a point load, where the exact energy is infinite.
   subroutine estimate_error(model, displacement, recovery, estimate, left_out)
      type(fine_model_t), intent(in) :: model
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(recovery_t), intent(in) :: recovery
      type(energy_error_t), intent(out) :: estimate
      logical, intent(in), optional :: left_out(:)  !< (n_cells)
      real(rk) :: energy
      integer(ik) :: cell

      allocate (estimate%element(model%mesh%n_cells), source=0.0_rk)
      allocate (estimate%left_out(model%mesh%n_cells), source=.false.)
      if (present(left_out)) estimate%left_out = left_out
      energy = 0.0_rk
      do cell = 1, model%mesh%n_cells
         if (estimate%left_out(cell)) cycle
         energy = energy + sum(displacement(:, model%mesh%cell_nodes(:, cell)) &
                               *model%element_forces(displacement, cell))
         estimate%element(cell) = sqrt(product_in(model, displacement, recovery, &
                                                  displacement, recovery, cell))
      end do
      estimate%total = norm2(estimate%element)
      estimate%solution = sqrt(max(0.0_rk, energy))
      if (estimate%total > 0.0_rk) then
         estimate%relative = estimate%total/hypot(estimate%solution, estimate%total)
      end if
   end subroutine estimate_error

   !> Energy of the error of one solution in the strain of that of another on the same body [J/m].
   real(rk) function error_product(model, displacement, recovery, other, other_recovery) &
      result(product)
      type(fine_model_t), intent(in) :: model
      real(rk), intent(in) :: displacement(:, :), other(:, :)  !< (2, n_nodes) [m]
      type(recovery_t), intent(in) :: recovery, other_recovery
      integer(ik) :: cell

      product = 0.0_rk
      do cell = 1, model%mesh%n_cells
         product = product + product_in(model, displacement, recovery, other, other_recovery, cell)
      end do
   end function error_product

   !> Energy product of the differences between recovered and computed stress in one element [J/m].
   pure real(rk) function product_in(model, displacement, recovery, other, other_recovery, cell)
      type(fine_model_t), intent(in) :: model
      real(rk), intent(in) :: displacement(:, :), other(:, :)  !< (2, n_nodes) [m]
      type(recovery_t), intent(in) :: recovery, other_recovery
      integer(ik), intent(in) :: cell
      real(rk) :: points(3, tip_rule_size), weights(tip_rule_size)
      real(rk) :: values(6), gradients(2, 6), area_coordinates(3), determinant
      integer(ik) :: corner, n_points, point

      corner = 0
      if (recovery%tip_of_cell(cell) > 0) then
         corner = findloc(model%mesh%cell_nodes(1:3, cell), &
                          model%mesh%fracture%tip_node(recovery%tip_of_cell(cell)), dim=1)
      end if
      call tip_rule(corner, n_points, points, weights)
      product_in = 0.0_rk
      do point = 1, n_points
         call model%mesh%evaluate(cell, points(:, point), values, gradients, area_coordinates, &
                                  determinant)
         product_in = product_in + weights(point)*determinant &
                    *strain_product(model%rocks%in_cell(cell), difference(displacement, recovery), &
                                      difference(other, other_recovery))
      end do

   contains

      !> Recovered less computed stress, xx yy xy [Pa].
      pure function difference(field, recovered) result(stress_error)
         real(rk), intent(in) :: field(:, :)  !< (2, n_nodes) displacement [m]
         type(recovery_t), intent(in) :: recovered
         real(rk) :: stress_error(3)
         type(elasticity_t) :: rock
         real(rk) :: stress(2, 2)

         rock = model%rocks%in_cell(cell)
         stress = rock%total_stress(matmul(field(:, model%mesh%cell_nodes(:, cell)), &
                                           transpose(gradients)), 0.0_rk)
         stress_error = recovered_stress(model%mesh, recovered, cell, area_coordinates) &
                        - [stress(1, 1), stress(2, 2), stress(1, 2)]
      end function difference

   end function product_in

   !> s C^-1 t of two stresses xx, yy, xy [J/m3].
   pure real(rk) function strain_product(elasticity, stress, other)
      type(elasticity_t), intent(in) :: elasticity
      real(rk), intent(in) :: stress(3), other(3)  !< [Pa]
      real(rk) :: share

      associate (lambda => elasticity%lame_lambda(), mu => elasticity%shear_modulus())
         share = lambda/(2.0_rk*(lambda + mu))
         strain_product = (stress(1)*other(1) + stress(2)*other(2) + 2.0_rk*stress(3)*other(3) &
                           - share*(stress(1) + stress(2))*(other(1) + other(2)))/(2.0_rk*mu)
      end associate
   end function strain_product

   !> Element sizes with which the mesh of fewest elements would reach a relative error (Li and
   !! Bettess 1995), and radii of the rosettes.
   !!
   !! Where the solution is smooth, the squared error of a region is proportional to h**(2 p) with
   !! p = 2, and fewest elements do where each has the same squared error s**2:
   !! h_new/h = (s/e)**(1/(p + 1)), which makes n = sum (e/s)**(2/(p + 1)) elements of those there.
   !!
   !! The elements around a tip are as many after refinement as before, and their squared error
   !! falls with the radius only, as the singular field keeps its shape. A smaller rosette costs the
   !! elements that fill the room around it, m for a factor e. One more element elsewhere takes
   !! 2 s**2 off the squared error there, as that falls with n**(-p); so the best radius leaves
   !! 2 m s**2 to all elements of a rosette together. Then s follows from
   !! n s**2 + 2 m s**2 (tips) = (wanted error)**2.
   !!
   !! What will fill the room around a smaller rosette grows from it; the sizes wanted there are
   !! those of the elements next to it.
   pure subroutine wanted_sizes(fine, estimate, relative, sizes, shrinkage)
      type(fine_mesh_t), intent(in) :: fine
      type(energy_error_t), intent(in) :: estimate
      real(rk), intent(in) :: relative  !< wanted error over the norm of the solution [-]
      real(rk), allocatable, intent(out) :: sizes(:)  !< (n_cells) edge if equilateral [m]
      real(rk), allocatable, intent(out) :: shrinkage(:)  !< (n_tips) new radius over the old [-]
      real(rk), parameter :: smooth_order = 2.0_rk  ! p of quadratic elements
      real(rk), parameter :: finest = 0.1_rk, coarsest = 4.0_rk  ! change of size at once
      real(rk) :: share, here, allowed
      real(rk) :: element(fine%n_cells)  ! over the allowed error of all [-]
      integer(ik) :: tip_of_cell(fine%n_cells), cell, tip

      tip_of_cell = 0
      do tip = 1, fine%fracture%n_tips
        where (any(fine%cell_nodes(1:3, :) == fine%fracture%tip_node(tip), dim=1)) tip_of_cell = tip
      end do
      allowed = relative*hypot(estimate%solution, estimate%total)
      element = estimate%element/max(tiny(allowed), allowed)
      share = share_of_element(sum(element**(2.0_rk/(smooth_order + 1.0_rk)), &
                                   mask=tip_of_cell == 0), fine%fracture%n_tips)

      allocate (sizes(fine%n_cells), shrinkage(fine%fracture%n_tips))
      do tip = 1, fine%fracture%n_tips
         here = sum(element**2, mask=tip_of_cell == tip)
         shrinkage(tip) = within(tip_elements*share**2/max(tiny(share), here))
      end do
      do cell = 1, fine%n_cells
         sizes(cell) = size_of(cell)
         if (estimate%left_out(cell)) cycle
         sizes(cell) = sizes(cell)*within((share/max(tiny(share), element(cell))) &
                                          **(1.0_rk/(smooth_order + 1.0_rk)))
      end do
      call spread_to_tips(fine, tip_of_cell > 0, sizes)

   contains

      !> A change of size within the limits of one step; without error, sizes increase.
      pure real(rk) function within(change)
         real(rk), intent(in) :: change  !< new size over the old [-]

         within = coarsest
         if (change < coarsest) within = max(finest, change)
      end function within

      !> Edge of an equilateral element of the same area [m].
      pure real(rk) function size_of(cell)
         integer(ik), intent(in) :: cell

         size_of = sqrt(4.0_rk*triangle_area(fine%xy(:, fine%cell_nodes(1:3, cell)))/sqrt(3.0_rk))
      end function size_of

   end subroutine wanted_sizes

   !> The error s that each element may have, over what is allowed: n(s) s**2 + 2 m s**2 (tips) is
   !! 1, n(s) = sum s**(-2/3). The sum rises with s; by bisection.
   pure real(rk) function share_of_element(sum_of_powers, n_tips) result(share)
      real(rk), intent(in) :: sum_of_powers  !< of the errors**(2/3), tips left out [-]
      integer(ik), intent(in) :: n_tips
      integer, parameter :: halvings = 60
      real(rk) :: low, middle
      integer :: k

      low = 0.0_rk
      share = 1.0_rk
      do k = 1, halvings
         middle = 0.5_rk*(low + share)
         if (sum_of_powers*middle**(4.0_rk/3.0_rk) + tip_elements*n_tips*middle**2 > 1.0_rk) then
            share = middle
         else
            low = middle
         end if
      end do
   end function share_of_element

   !> Elements around a tip take the mean size wanted by the others at their corners.
   pure subroutine spread_to_tips(fine, at_tip, sizes)
      type(fine_mesh_t), intent(in) :: fine
      logical, intent(in) :: at_tip(:)  !< (n_cells)
      real(rk), intent(inout) :: sizes(:)  !< (n_cells) [m]
      real(rk) :: largest, total(fine%n_vertices)
      integer(ik) :: n_around(fine%n_vertices), cell

      largest = maxval(sizes)
      total = 0.0_rk
      n_around = 0
      do cell = 1, fine%n_cells
         if (at_tip(cell)) cycle
         associate (corners => fine%cell_nodes(1:3, cell))
            total(corners) = total(corners) + log(sizes(cell)/largest)
            n_around(corners) = n_around(corners) + 1
         end associate
      end do
      do cell = 1, fine%n_cells
         if (.not. at_tip(cell)) cycle
         associate (corners => fine%cell_nodes(1:3, cell))
            if (.not. any(n_around(corners) > 0)) cycle
            sizes(cell) = largest*exp(sum(total(corners))/sum(n_around(corners)))
         end associate
      end do
   end subroutine spread_to_tips

   !> Whether the displacement depends on the loads alone: no face touches another.
   pure logical function has_dual(model)
      type(fine_model_t), intent(in) :: model

      has_dual = all(model%conditions%condition == face_loaded)
   end function has_dual

   !> Add the estimated errors of K_I and K_II to the corrected values, and their magnitudes to the
   !! error estimates.
   subroutine correct_intensity(model, displacement, recovery, probe, intensity, error)
      type(fine_model_t), intent(inout) :: model
      real(rk), intent(in) :: displacement(:, :)  !< (2, n_nodes) [m]
      type(recovery_t), intent(in) :: recovery  !< of its stresses
      type(tip_probe_t), intent(in) :: probe  !< of the tip
      type(intensity_t), intent(inout) :: intensity  !< from tip_intensity
      type(error_t), allocatable, intent(out) :: error
      type(recovery_t) :: dual_recovery
      real(rk), allocatable :: force(:, :, :), dual(:, :)
      real(rk) :: missing(2)
      integer(ik) :: mode

      force = probe%interactions%extraction_forces(model%mesh%n_nodes)
      do mode = 1, 2
         call model%influence(force(:, :, mode), dual, error)
         if (allocated(error)) return
         call recover_by_patches(model, dual, dual_recovery)
         missing(mode) = error_product(model, displacement, recovery, dual, dual_recovery)
      end do
      intensity%k1_corrected = intensity%k1 + missing(1)
      intensity%k2_corrected = intensity%k2 + missing(2)
      intensity%k1_error = intensity%k1_error + abs(missing(1))
      intensity%k2_error = intensity%k2_error + abs(missing(2))
      call complete_errors(probe%frame%rock%crack_modulus(), intensity)
   end subroutine correct_intensity

end module fine_error
