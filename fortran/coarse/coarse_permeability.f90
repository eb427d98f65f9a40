!> The permeability of cells in a body with regions.
!!
!! The mesh follows the outlines of regions where it can (mesh_spec_t%guides), not near
!! fractures and what has grown. A cell within one region has its permeability; a cell that outlines
!! cut has that of layers as thick as the parts of the cell, which lie as the
!! outline does there: the pressure gradient along the layers and the flux across them are the same
!! in all, so for two of them with shares f and 1 - f and the normal n (Milton 2002)
!!   K = f K1 + (1 - f) K2 - f (1 - f) (dK n)(dK n)^T/(n . ((1 - f) K1 + f K2) n),  dK = K1 - K2:
!! the mean along, the harmonic mean across. It is symmetric and positive definite as K1 and K2 are.
!! Its inverse follows from theirs in the same way with along and across exchanged; so found, it
!! stays definite where the two rocks differ by 1e12 (scene_check_regions allows no more).
!! Multi-point fluxes do not bear what is as anisotropic as that. Nor does it help: a cell whose
!! faces lie askew to its layers lets nothing flow along them, for what seals the next face, and
!! the mean across, hold every direction. So above the ratio that fluxes bear the more a cell would
!! conduct along its layers the less it does, down to what it conducts across (`bearable`).
!!
!! In a cell an outline counts as a straight line with its mean direction there, placed such that
!! the region has its share of the cell. Each line cuts the region's part off what later regions
!! have left, so regions that share an outline leave nothing between them.
module coarse_permeability
   use base_kinds, only: ik, rk
   use base_plane, only: barycentric, left_part, norm2, polygon_area, triangle_area, turned_left
   use coarse_rock, only: any_differ, make_room, mean_mobility, new_rock, number_stiffnesses, &
                          resistivity_of, rock_t, set_solid, solid_t
   use mesh_geometry, only: cell_area
   use mesh_types, only: mesh_t
   use scene_check_permeability, only: most_anisotropic
   use scene_region_outline, only: is_inside, outline_t, region_outline
   use scene_types, only: domain_t, fluid_t, region_t
   implicit none(type, external)
   private

   public :: bearable, conduction_t, layered, mean_of_regions, place_regions
   public :: relative_resistance, share_of_cell

   !> Permeability and resistivity of a rock, each xx, yy, xy.
   type :: conduction_t
      real(rk) :: permeability(3) = 0.0_rk  !< [m2]
      real(rk) :: resistivity(3) = 0.0_rk  !< [Pa s/m2]
      !> Of a cell with several rocks: ratio of the permeabilities along and across the layers,
      !! before the limit of `bearable`.
      real(rk) :: layering = 0.0_rk
   end type conduction_t

   real(rk), parameter :: nothing = 1.0e-9_rk  !< share of a cell that is rounding [-]

contains

   !> Set the rock of each cell of the mesh.
   pure subroutine place_regions(mesh, regions, domain, fluid, rock)
      type(mesh_t), intent(in) :: mesh
      type(region_t), intent(in) :: regions(:)
      type(domain_t), intent(in) :: domain
      type(fluid_t), intent(in) :: fluid
      type(rock_t), intent(inout) :: rock  !< uniform before
      type(outline_t) :: outlines(size(regions))
      type(conduction_t) :: at_cell, own(0:size(regions))  ! of the scene's rock first
      type(rock_t) :: own_rock
      type(solid_t) :: solid(0:size(regions))
      real(rk) :: along(2, size(regions)), part(0:size(regions))
      logical :: differ
      integer(ik) :: c
      integer :: i

      associate (viscosity => fluid%viscosity)
         own(0) = conduction(rock%permeability(:, 1), viscosity)
         solid(0) = rock%solid_at(1_ik)
         do i = 1, size(regions)
            outlines(i)%corners = region_outline(regions(i), domain)
            associate (m => regions(i)%material)
               own(i) = conduction([m%permeability_xx, m%permeability_yy, m%permeability_xy], &
                                   viscosity)
               own_rock = new_rock(m, fluid)
               solid(i) = own_rock%solid_at(1_ik)
            end associate
         end do
         call number_stiffnesses(solid)
         differ = any_differ(solid)
         if (differ) call make_room(mesh%n_cells, rock)
         deallocate (rock%permeability, rock%resistivity)
         allocate (rock%permeability(3, mesh%n_cells), rock%resistivity(2, 2, mesh%n_cells))
         do c = 1, mesh%n_cells
            call parts_of_cell(mesh%xy(:, mesh%cell_nodes(:, c)), outlines, part, along)
            if (differ) call set_solid(part, solid, c, rock)
            at_cell = mixed_conduction(part, cell_area(mesh, c), along, own, viscosity)
            rock%permeability(:, c) = at_cell%permeability
            rock%resistivity(:, :, c) = reshape(at_cell%resistivity([1, 3, 3, 2]), [2, 2])
            if (at_cell%layering > rock%most_layered) then
               rock%most_layered = at_cell%layering
               rock%most_layered_cell = c
            end if
         end do
      end associate
   end subroutine place_regions

   pure function conduction(permeability, viscosity)
      real(rk), intent(in) :: permeability(3)  !< xx, yy, xy [m2]
      real(rk), intent(in) :: viscosity  !< [Pa s]
      type(conduction_t) :: conduction
      real(rk) :: resistivity(2, 2)

      resistivity = resistivity_of(permeability, viscosity)
      conduction%permeability = permeability
      conduction%resistivity = [resistivity(1, 1), resistivity(2, 2), resistivity(1, 2)]
   end function conduction

   !> Mean over each cell of a property of the scene's rock and of each region.
   pure function mean_of_regions(mesh, regions, domain, values) result(mean)
      type(mesh_t), intent(in) :: mesh
      type(region_t), intent(in) :: regions(:)
      type(domain_t), intent(in) :: domain
      real(rk), intent(in) :: values(0:)  !< of the scene's rock first [any unit]
      real(rk) :: mean(mesh%n_cells)
      type(outline_t) :: outlines(size(regions))
      real(rk) :: along(2, size(regions)), part(0:size(regions))
      integer(ik) :: c
      integer :: i

      do i = 1, size(regions)
         outlines(i)%corners = region_outline(regions(i), domain)
      end do
      do c = 1, mesh%n_cells
         call parts_of_cell(mesh%xy(:, mesh%cell_nodes(:, c)), outlines, part, along)
         mean(c) = dot_product(part, values)/sum(part)
      end do
   end function mean_of_regions

   !> Resistance of the rock on both sides of each fracture cell over that of the scene's rock [-].
   pure function relative_resistance(mesh, rock, viscosity) result(ratio)
      type(mesh_t), intent(in) :: mesh
      type(rock_t), intent(in) :: rock
      real(rk), intent(in) :: viscosity  !< [Pa s]
      real(rk) :: ratio(mesh%fracture%n_cells)
      integer(ik) :: i, k
      real(rk) :: beside(2)

      do i = 1, mesh%fracture%n_cells
         do k = 1, 2
            associate (cell => mesh%face_cells(1, mesh%fracture%cell_faces(k, i)))
               beside(k) = mean_mobility(rock%permeability(:, cell), viscosity)
            end associate
         end do
         ratio(i) = 2.0_rk*rock%mobility/sum(beside)
      end do
   end function relative_resistance

   !> Areas of a cell in each region and in the surrounding rock; later regions have priority.
   pure subroutine parts_of_cell(cell, outlines, part, along)
      real(rk), intent(in) :: cell(2, 3)  !< corners, counter-clockwise [m]
      type(outline_t), intent(in) :: outlines(:)
      real(rk), intent(out) :: part(0:)  !< area in the rock around and in each region [m2]
      real(rk), intent(out) :: along(:, :)  !< directions of the outlines where they cut [-]
      real(rk), allocatable :: rest(:, :)
      real(rk) :: area, line(2, 2), share
      integer :: i

      area = triangle_area(cell)
      part = 0.0_rk
      along = 0.0_rk
      allocate (rest, source=cell)
      do i = size(outlines), 1, -1
         call share_of_cell(cell, outlines(i)%corners, share, line)
         if (share <= nothing) cycle
         along(:, i) = line(:, 2) - line(:, 1)
         if (share >= 1.0_rk - nothing) then
            part(i) = polygon_area(rest)
            rest = rest(:, :0)
            exit
         end if
         part(i) = polygon_area(left_part(rest, line))
         rest = left_part(rest, line(:, [2, 1]))
         if (polygon_area(rest) <= nothing*area) exit
      end do
      part(0) = polygon_area(rest)
   end subroutine parts_of_cell

   !> The conduction of a cell with several rocks.
   pure function mixed_conduction(part, area, along, own, viscosity) result(mixed)
      real(rk), intent(in) :: part(0:)  !< area in the rock around and in each region [m2]
      real(rk), intent(in) :: area  !< of the cell [m2]
      real(rk), intent(in) :: along(:, :)  !< directions of their outlines [-]
      type(conduction_t), intent(in) :: own(0:)  !< of the rock around, and of the regions
      real(rk), intent(in) :: viscosity  !< [Pa s]
      type(conduction_t) :: mixed
      real(rk) :: share
      logical :: is_mixed
      integer :: i

      mixed = own(0)
      is_mixed = .false.
      do i = 1, ubound(part, 1)
         if (part(i) <= nothing*area) cycle
         if (sum(part(:i - 1)) <= nothing*area) then
            mixed = own(i)
            cycle
         end if
         share = part(i)/sum(part(:i))
         mixed%permeability = layered(own(i)%permeability, mixed%permeability, share, &
                                      turned_left(along(:, i)))
         mixed%resistivity = layered(own(i)%resistivity, mixed%resistivity, share, along(:, i))
         is_mixed = .true.
      end do
      if (is_mixed) mixed = bearable(mixed, viscosity)
   end function mixed_conduction

   !> Limit the conduction along layers: if the ratio along and across exceeds `most_anisotropic`,
   !! it becomes most_anisotropic**2 over this ratio, at least 1.
   pure function bearable(layers, viscosity) result(limited)
      type(conduction_t), intent(in) :: layers
      real(rk), intent(in) :: viscosity  !< [Pa s]
      type(conduction_t) :: limited
      real(rk) :: across, along, angle, dyad(3), ratio, resistance

      limited = layers
      associate (k => layers%permeability, r => layers%resistivity)
         along = 0.5_rk*(k(1) + k(2)) + hypot(0.5_rk*(k(1) - k(2)), k(3))
         resistance = 0.5_rk*(r(1) + r(2)) + hypot(0.5_rk*(r(1) - r(2)), r(3))
         angle = 0.5_rk*atan2(2.0_rk*k(3), k(1) - k(2))
      end associate
      across = viscosity/resistance  ! in the permeability the other direction would hide it
      ratio = along/across
      limited%layering = ratio
      if (.not. ratio > most_anisotropic) return
      ratio = max(1.0_rk, most_anisotropic**2/ratio)
      dyad = [cos(angle)**2, sin(angle)**2, cos(angle)*sin(angle)]
      limited%permeability = across*([1.0_rk, 1.0_rk, 0.0_rk] + (ratio - 1.0_rk)*dyad)
      limited%resistivity = resistance*([1.0_rk, 1.0_rk, 0.0_rk] + (1.0_rk/ratio - 1.0_rk)*dyad)
   end function bearable

   !> Share of a cell in a region, and a line that cuts it off, with the region on its left.
   pure subroutine share_of_cell(cell, outline, share, line)
      real(rk), intent(in) :: cell(2, 3)  !< corners, counter-clockwise [m]
      real(rk), intent(in) :: outline(:, :)  !< corners of the region, counter-clockwise [m]
      real(rk), intent(out) :: share  !< [-]
      real(rk), intent(out) :: line(2, 2)  !< two points; of no meaning if share is 0 or 1 [m]
      real(rk), allocatable :: part(:, :)
      real(rk) :: along(2)
      integer(ik) :: k

      line = reshape([0.0_rk, 0.0_rk, 1.0_rk, 0.0_rk], [2, 2])
      if (.not. may_cut(outline, cell)) then
         share = merge(1.0_rk, 0.0_rk, is_inside(outline, sum(cell, dim=2)/3.0_rk))
         return
      end if
      allocate (part, source=outline)
      do k = 1, 3
         part = left_part(part, cell(:, [k, mod(k, 3_ik) + 1_ik]))
      end do
      share = min(1.0_rk, max(0.0_rk, polygon_area(part)/triangle_area(cell)))
      if (share <= nothing .or. share >= 1.0_rk - nothing) return
      along = mean_direction(cell, part)
      line(:, 1) = cut_off(cell, turned_left(along), share)
      line(:, 2) = line(:, 1) + along
   end subroutine share_of_cell

   !> Whether the bounding box of an edge of the outline overlaps that of the cell.
   pure logical function may_cut(outline, cell)
      real(rk), intent(in) :: outline(:, :), cell(2, 3)  !< [m]
      real(rk) :: high(2), low(2)
      integer(ik) :: k, n, next

      low = minval(cell, dim=2)
      high = maxval(cell, dim=2)
      n = size(outline, 2, kind=ik)
      may_cut = .true.
      do k = 1, n
         next = mod(k, n) + 1_ik
         if (all(max(outline(:, k), outline(:, next)) >= low .and. &
                 min(outline(:, k), outline(:, next)) <= high)) return
      end do
      may_cut = .false.
   end function may_cut

   !> Direction of the outline within a cell, the region on its left: the principal direction of the
   !! edges that do not lie on the cell's own, so that both sides of a thin region count equally.
   pure function mean_direction(cell, part) result(along)
      real(rk), intent(in) :: cell(2, 3)  !< [m]
      real(rk), intent(in) :: part(:, :)  !< what of the region lies in the cell [m]
      real(rk) :: along(2)
      real(rk), parameter :: on_edge = 1.0e-9_rk  ! barycentric
      real(rk) :: angle, edge(2), spread(2), total(2)
      integer(ik) :: k, n, next

      n = size(part, 2, kind=ik)
      spread = 0.0_rk
      total = 0.0_rk
      do k = 1, n
         next = mod(k, n) + 1_ik
         if (any(abs(barycentric(cell, part(:, k))) <= on_edge .and. &
                 abs(barycentric(cell, part(:, next))) <= on_edge)) cycle
         edge = part(:, next) - part(:, k)
         if (.not. norm2(edge) > 0.0_rk) cycle
         spread = spread + [edge(1)**2 - edge(2)**2, 2.0_rk*edge(1)*edge(2)]/norm2(edge)
         total = total + edge
      end do
      angle = 0.5_rk*atan2(spread(2), spread(1))
      along = [cos(angle), sin(angle)]
      if (dot_product(along, total) < 0.0_rk) along = -along
   end function mean_direction

   !> A point of the line across `normal` beyond which a share of a triangle lies.
   pure function cut_off(cell, normal, share) result(point)
      real(rk), intent(in) :: cell(2, 3)  !< [m]
      real(rk), intent(in) :: normal(2)  !< unit vector
      real(rk), intent(in) :: share  !< [-]
      real(rk) :: point(2)  !< [m]
      real(rk) :: height(3), low, middle, high, at

      height = matmul(normal, cell)
      low = minval(height)
      high = maxval(height)
      middle = sum(height) - low - high
      if ((1.0_rk - share)*(high - low) <= middle - low) then
         at = low + sqrt((1.0_rk - share)*(middle - low)*(high - low))
      else
         at = high - sqrt(share*(high - middle)*(high - low))
      end if
      point = at*normal
   end function cut_off

   !> Permeability of layers of two rocks with the normal `normal`; resistivity of layers along it.
   pure function layered(first, second, share, normal) result(mixed)
      real(rk), intent(in) :: first(3), second(3)  !< xx, yy, xy [m2] or [Pa s/m2]
      real(rk), intent(in) :: share  !< of the first [-]
      real(rk), intent(in) :: normal(2)  !< unit vector
      real(rk) :: mixed(3)  !< [m2] or [Pa s/m2]
      real(rk) :: jump(2), other(3)

      jump = applied(first - second, normal)
      other = (1.0_rk - share)*first + share*second
      mixed = share*first + (1.0_rk - share)*second &
              - share*(1.0_rk - share)/dot_product(normal, applied(other, normal)) &
              *[jump(1)**2, jump(2)**2, jump(1)*jump(2)]
   end function layered

   !> A symmetric tensor times a vector.
   pure function applied(tensor, vector) result(image)
      real(rk), intent(in) :: tensor(3)  !< xx, yy, xy
      real(rk), intent(in) :: vector(2)
      real(rk) :: image(2)

      image = [tensor(1)*vector(1) + tensor(3)*vector(2), tensor(3)*vector(1) + tensor(2)*vector(2)]
   end function applied

end module coarse_permeability
