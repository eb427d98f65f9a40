!> Stresses that are smoother, and closer to the truth, than those of the elements.
!!
!! Superconvergent patch recovery (Zienkiewicz and Zhu 1992): around every corner node a full
!! quadratic is fitted to stresses in the elements of its patch. Patches are made of elements that
!! share nodes, so they never reach across a fracture, and are of one rock. Around a free tip the
!! singular part, which no polynomial can follow, is fitted first and kept apart (Rodenas and others
!! 2008): the polynomials hold what remains.
module fine_recovery
   use algebra_lapack, only: dpotrf, dpotrs
   use base_kinds, only: ik, rk
   use base_plane, only: norm2
   use fine_elasticity, only: elasticity_t
   use fine_mesh, only: fine_mesh_t
   use fine_model, only: fine_model_t
   use fine_patches, only: fit_quadratic, n_samples, n_terms, patch_of_site, quadratic_terms, &
                           samples_t, take_samples
   use fine_tip_field, only: singular_stress, tip_field_t
   implicit none(type, external)
   private

   public :: recover_by_patches, recovered_stress, recovery_t

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
            do i = 1, samples%around%length(fracture%tip_node(tip))
               cell = samples%around%at(fracture%tip_node(tip), i)
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
      rock = model%rocks%in_cell(samples%around%at(node, 1_ik))
      field%kolosov = rock%kolosov()
      field%shear_modulus = rock%shear_modulus()
      ! The unit of the intensities that makes all columns of one size.
      unit = sqrt(sqrt(sum(samples%area(samples%around%of(node)))))
      normal = 0.0_rk
      right = 0.0_rk
      do i = 1, samples%around%length(node)
         cell = samples%around%at(node, i)
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

end module fine_recovery
