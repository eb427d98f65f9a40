!> The rock around wells in the rock, where regions of other rock are near: annuli for the rings of
!! the wells (coarse_well_rings), and places where the mesh has smaller cells.
!!
!! Annuli have the mean pressures along circles of the steady flow from the wall of the well, or
!! from a circle as large as its cell, to a circle farther away: by finite volumes in polar
!! coordinates.
module twolevel_rock_around
   use algebra_lapack, only: dgesv
   use base_errors, only: error_t
   use base_kinds, only: ik, pi, rk
   use coarse_rock, only: new_rock, rock_t, solid_t
   use coarse_well_rings, only: annuli_t, new_well_rings, rock_differs_to
   use coarse_wells, only: rock_wells_t
   use mesh_builder, only: locate, mesh_spec_t, mesher_t
   use mesh_geometry, only: cell_area, cell_centre
   use mesh_types, only: mesh_t
   use scene_region_outline, only: rock_places_t
   use scene_types, only: fluid_t, injection_t, material_t, scene_t
   implicit none(type, external)
   private

   integer, parameter :: n_circles = 64, n_sectors = 48

   public :: place_rings, refine_at_wells

contains

   !> Rings of all wells in the rock.
   subroutine place_rings(scene, mesher, mesh, cells, rock, rock_wells, error)
      type(scene_t), intent(in) :: scene
      type(mesher_t), intent(in) :: mesher
      type(mesh_t), intent(in) :: mesh
      integer(ik), intent(in) :: cells(:)  !< (wells) in which they lie; 0: not in the rock
      type(rock_t), intent(in) :: rock
      type(rock_wells_t), intent(inout) :: rock_wells
      type(error_t), allocatable, intent(out) :: error
      type(annuli_t) :: around, meshed
      ! Of the logarithm of the cell's radius, by powers of half that of the ratio of
      ! permeabilities: bound of 48 measured ones, ratios of 3 to 100.
      real(rk), parameter :: by_tensor(2) = [0.04_rk, 0.13_rk]
      real(rk) :: area, by_outline, mean, radius
      integer(ik) :: k, w

      rock_wells%ring_number = pack([(w, w=1, size(cells, kind=ik))], cells > 0)
      rock_wells%ring_flow = spread(0.0_rk, 1, size(rock_wells%ring_number))
      if (allocated(rock_wells%rings)) deallocate (rock_wells%rings)
      allocate (rock_wells%rings(size(rock_wells%ring_number)))
      do k = 1, size(rock_wells%rings, kind=ik)
         w = rock_wells%ring_number(k)
         area = cell_area(mesh, cells(w))
         call find_annuli(scene, scene%injections(w), mesher, rock, cells(w), sqrt(area/pi), &
                          cell_centre(mesh, cells(w)), around, meshed, &
                          by_outline, error)
         if (allocated(error)) return
         ! Stretched to isotropic rock without a change of areas, the wall is an ellipse and acts
         ! like a circle of the mean of its half-axes; the radius of the cell depends on its edges.
         mean = rock%mean_over_mobility(cells(w))
         radius = scene%injections(w)%radius*sqrt(0.5_rk*(1.0_rk + mean))
         rock_wells%rings(k) = new_well_rings(radius, area, around, meshed)
         rock_wells%rings(k)%error = rock_wells%rings(k)%error + by_outline &
                                     + sum(by_tensor*acosh(mean)**[1, 3]) &
                                     /log(max(2.0_rk, sqrt(area)/radius))
      end do
   end subroutine place_rings

   !> The rock around a well, up to four radii of its cell. Beyond, both chains have the same.
   subroutine find_annuli(scene, well, mesher, rock, cell, radius, middle, around, meshed, &
                          by_outline, error)
      type(scene_t), intent(in) :: scene
      type(injection_t), intent(in) :: well
      type(mesher_t), intent(in) :: mesher
      type(rock_t), intent(in) :: rock
      integer(ik), intent(in) :: cell  !< of the well
      real(rk), intent(in) :: radius  !< of a circle as large as the cell [m]
      real(rk), intent(in) :: middle(2)  !< of the cell [m]
      type(annuli_t), intent(out) :: around, meshed  !< the rock, and as the cells have it
      !> Relative error of the resistance where an outline cuts the cell or is near [-].
      real(rk), intent(out) :: by_outline
      type(error_t), allocatable, intent(out) :: error
      real(rk), parameter :: edge_of_cell = 2.7_rk  ! of a triangle as large as a circle
      ! measured for contrasts of 10 and 100: far from an outline and in cells that it cuts
      real(rk), parameter :: of_contrast(2) = [0.03_rk, 0.04_rk]
      real(rk), dimension(n_sectors, n_circles) :: along, outwards, storage
      real(rk), allocatable :: constants(:, :)
      real(rk) :: distance, end, far, xy(2, n_sectors)
      type(rock_places_t) :: places
      type(solid_t) :: solid
      integer(ik) :: at(n_sectors)
      integer :: i, k

      call places%set(scene)
      solid = rock%solid_at(cell)
      around = annuli_t(spread(0.0_rk, 1, 0), [rock%mobility_at(cell)], [solid%uniaxial_storage()])
      meshed = around
      by_outline = 0.0_rk
      if (size(places%outline) == 0) return
      end = rock_differs_to*max(radius, well%radius)
      distance = places%distance([well%x, well%y], spread(.true., 1, size(places%outline)))
      allocate (constants(2, 0:size(places%outline)))
      constants(:, 0) = constants_of(scene%material, scene%fluid)
      do i = 1, size(places%outline)
         constants(:, i) = constants_of(scene%regions(i)%material, scene%fluid)
      end do
      associate (far_off => distance/(edge_of_cell*radius))
         by_outline = log(maxval(constants(1, :))/minval(constants(1, :))) &
                      *sum(of_contrast/(1.0_rk + [far_off, far_off**2]))
      end associate
      if (distance > end) return
      do i = 1, n_circles
         xy = circle([well%x, well%y], well%radius*(end/well%radius)**((i - 0.5_rk)/n_circles))
         at = [(places%region_at(xy(:, k)), k=1, n_sectors)]
         outwards(:, i) = constants(1, at)
         storage(:, i) = constants(2, at)
      end do
      far = sum(outwards(:, n_circles))/n_sectors
      around = annuli_of(well%radius, end, outwards, outwards, storage)
      around%mobility(n_circles + 2) = far
      ! The cell has its well in the middle.
      do i = 1, n_circles
         xy = circle(middle, radius*(end/radius)**((i - 0.5_rk)/n_circles))
         call locate(mesher, xy, at, error)
         if (allocated(error)) return
         where (at == 0) at = cell  ! outside
         do k = 1, n_sectors
            associate (angle => 2.0_rk*pi*(k - 0.5_rk)/n_sectors)
               outwards(k, i) = 1.0_rk/resistivity(rock, at(k), angle)
               along(k, i) = 1.0_rk/resistivity(rock, at(k), angle + 0.5_rk*pi)
            end associate
            solid = rock%solid_at(at(k))
            storage(k, i) = solid%uniaxial_storage()
         end do
      end do
      meshed = annuli_of(radius, end, outwards, along, storage)
      solid = rock%solid_at(cell)
      meshed = annuli_t([radius, meshed%edge], [rock%mobility_at(cell), meshed%mobility], &
                        [solid%uniaxial_storage(), meshed%storage])
      meshed%mobility(n_circles + 3) = far
      meshed%storage(n_circles + 3) = around%storage(n_circles + 2)
   end subroutine find_annuli

   !> Places on a circle.
   pure function circle(middle, radius) result(xy)
      real(rk), intent(in) :: middle(2), radius  !< [m]
      real(rk) :: xy(2, n_sectors)
      integer :: k

      xy = reshape([(middle + radius*[cos(2.0_rk*pi*(k - 0.5_rk)/n_sectors), &
                                      sin(2.0_rk*pi*(k - 0.5_rk)/n_sectors)], k=1, n_sectors)], &
                   [2, n_sectors])
   end function circle

   !> Annuli with the mean pressures of the steady flow between two circles, which have one pressure
   !! each. Pressures of a circle follow from those of the one within: p_(i+1) = T_i p_i.
   function annuli_of(start, end, outwards, along, storage) result(annuli)
      real(rk), intent(in) :: start, end  !< radii [m]
      !> (n_sectors, n_circles) K/mu outwards and along circles [m2/(Pa s)], S* [1/Pa]
      real(rk), intent(in), dimension(:, :) :: outwards, along, storage
      type(annuli_t) :: annuli
      real(rk), parameter :: angle = 2.0_rk*pi/n_sectors
      real(rk) :: matrix(n_sectors, n_sectors), passed(n_sectors, n_sectors, n_circles)
      real(rk) :: flow, from(n_sectors), means(0:n_circles + 1), p(n_sectors), step, to(n_sectors)
      integer :: i, info, k, next, pivots(n_sectors)

      step = log(end/start)/n_circles
      do i = n_circles, 1, -1
         from = between(i - 1)
         to = between(i)
         matrix = 0.0_rk
         if (i < n_circles) matrix = -spread(to, 2, n_sectors)*passed(:, :, i + 1)
         do k = 1, n_sectors
            next = mod(k, n_sectors) + 1
            matrix(k, k) = matrix(k, k) + from(k) + to(k)
            associate (m => 2.0_rk*step/angle/(1.0_rk/along(k, i) + 1.0_rk/along(next, i)))
               matrix([k, next], k) = matrix([k, next], k) + [m, -m]
               matrix([k, next], next) = matrix([k, next], next) + [-m, m]
            end associate
            passed(:, k, i) = 0.0_rk
            passed(k, k, i) = from(k)
         end do
         call dgesv(n_sectors, n_sectors, matrix, n_sectors, pivots, passed(:, :, i), n_sectors, &
                    info)
      end do
      p = 1.0_rk
      means(0) = 1.0_rk
      do i = 1, n_circles
         p = matmul(passed(:, :, i), p)
         if (i == 1) flow = sum(between(0)*(1.0_rk - p))
         means(i) = sum(p)/n_sectors
      end do
      means(n_circles + 1) = 0.0_rk
      annuli%edge = [(start*exp((i - 0.5_rk)*step), i=1, n_circles), end]
      annuli%storage = sum(storage, dim=1)/n_sectors
      annuli%storage = annuli%storage([1, (i, i=1, n_circles), n_circles])
      annuli%mobility = [flow*step/(2.0_rk*pi)/(means(:n_circles) - means(1:)), 0.0_rk]
      annuli%mobility([1, n_circles + 1]) = 0.5_rk*annuli%mobility([1, n_circles + 1])

   contains

      !> Conductances from a circle to the next one.
      pure function between(circle) result(conductance)
         integer, intent(in) :: circle  !< 0: the inner one
         real(rk) :: conductance(n_sectors)

         conductance = 0.0_rk
         if (circle > 0) conductance = 0.5_rk*step/outwards(:, circle)
         if (circle < n_circles) conductance = conductance + 0.5_rk*step/outwards(:, circle + 1)
         conductance = angle/conductance
      end function between

   end function annuli_of

   !> Resistivity of a cell in a direction [Pa s/m2].
   pure real(rk) function resistivity(rock, cell, angle)
      type(rock_t), intent(in) :: rock
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: angle  !< [rad]

      associate (along => [cos(angle), sin(angle)], &
                 r => rock%resistivity(:, :, min(int(cell), size(rock%resistivity, 3))))
         resistivity = dot_product(along, matmul(r, along))
      end associate
   end function resistivity

   !> K/mu and S* of a rock [m2/(Pa s)], [1/Pa].
   pure function constants_of(material, fluid) result(constants)
      type(material_t), intent(in) :: material
      type(fluid_t), intent(in) :: fluid
      real(rk) :: constants(2)
      type(rock_t) :: rock
      type(solid_t) :: solid

      rock = new_rock(material, fluid)
      solid = rock%solid_at(1_ik)
      constants = [rock%mobility_at(1_ik), solid%uniaxial_storage()]
   end function constants_of

   !> Smaller cells at wells in the rock that are near other rock, so that the mesh follows its
   !! outline; the cell of a well with a pressure is to be wider than the well.
   pure subroutine refine_at_wells(scene, spec)
      type(scene_t), intent(in) :: scene
      type(mesh_spec_t), intent(inout) :: spec
      !> size over the distance of other rock; least size over the radius of the well [-]
      real(rk), parameter :: share = 0.2_rk, least(2) = [2.0_rk, 16.0_rk]
      real(rk), parameter :: around = 1.5_rk  ! radius over the distance, or half of it in cells [-]
      type(rock_places_t) :: places
      real(rk) :: distance, size_there
      integer :: w

      call places%set(scene)
      if (size(places%outline) == 0 .or. .not. scene%has_wells()) return
      do w = 1, size(scene%injections)
         associate (well => scene%injections(w))
            if (well%fracture > 0) cycle
            distance = places%distance([well%x, well%y], spread(.true., 1, size(places%outline)))
            size_there = max(share*distance, well%radius*least(merge(2, 1, &
                                                                 & allocated(well%pressure))))
            call spec%refine(reshape([well%x, well%y], [2, 1]), size_there, &
                             around*max(distance, 2.0_rk*size_there))
         end associate
      end do
   end subroutine refine_at_wells

end module twolevel_rock_around
