!> The poroelastic rock of the cells: constants in the form that the discretization uses.
!!
!! Stiffness and storage of a body with regions. A cell within one region has the constants of
!! the region. In a cell cut by outlines, stress and pressure are assumed uniform, as in the mixed
!! scheme, and the resulting strain and fluid content are means over the cell's area:
!!   eps = <A> sigma + <b> p I,  content = <b> tr sigma + <s> p,
!! with the compliance A = (sigma - nu tr sigma I)/(2 G), b = alpha/(2 (lambda + G)) and s = S +
!! alpha^2/(lambda + G). This is the result of exact integration of the scheme: the complementary
!! energy of the true body for a stress that is uniform in each cell. It is positive definite as
!! those of the rocks are. Layers in series are exact; layers in parallel are too soft in the cut
!! cells.
!!
!! A rise theta of the temperature above the initial one gives the stress -K_dr b_s theta I, which
!! is that of a pressure p_T = K_dr b_s theta/alpha in the stress-strain relation, and lowers the
!! fluid content by b_m theta, b_m = phi b_f + (alpha - phi) b_s. Rock with alpha = 0 has no
!! storage, which scenes are refused for.
module coarse_rock
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_value
   use mesh_types, only: mesh_t
   use scene_fluid_law, only: bulk_modulus, storage
   use scene_types, only: fluid_t, material_t
   implicit none(type, external)
   private

   public :: any_differ, make_room, mean_mobility, mean_solid, new_rock, number_stiffnesses
   public :: resistivity_of, rock_t, set_solid, shear_beside, solid_t

   !> Isotropic elastic, anisotropic permeable rock; two-dimensional constants. Arrays have one item
   !! for uniform rock, else one per cell: that of cell c is at min(c, size).
   type :: rock_t
      real(rk), allocatable :: shear(:)  !< shear modulus G [Pa]
      real(rk), allocatable :: lame(:)  !< first Lame constant, reduced for plane stress [Pa]
      real(rk), allocatable :: biot(:)  !< alpha of the stress in the plane [-]
      real(rk), allocatable :: storage(:)  !< S at fixed strain in the plane [1/Pa]
      real(rk), allocatable :: heat_stress(:)  !< K_dr b_s in the plane [Pa/K]
      real(rk), allocatable :: heat_content(:)  !< b_m in the plane [1/K]
      !> (cells) rise above the initial one that acts now; unallocated: no thermal stress [K]
      real(rk), allocatable :: temperature(:)
      !> Rocks of one stiffness have one number: across an outline between two of them, the rotation
      !! is discontinuous (coarse_regions).
      integer(ik), allocatable :: stiffness(:)
      real(rk) :: mobility = 0.0_rk  !< mean of K/mu of the scene's rock [m2/(Pa s)]
      ! (.., 1) of a uniform rock, (.., n_cells) where regions differ (coarse_permeability):
      real(rk), allocatable :: permeability(:, :)  !< (3, ..) K_xx, K_yy, K_xy [m2]
      real(rk), allocatable :: resistivity(:, :, :)  !< (2, 2, ..) inverse of K/mu [Pa s/m2]
      !> Largest ratio of the permeabilities along and across layers in a cell cut by outlines of
      !! regions, and this cell; 0: no cell is cut.
      real(rk) :: most_layered = 0.0_rk
      integer(ik) :: most_layered_cell = 0
   contains
      procedure :: mobility_at
      procedure :: mean_over_mobility
      procedure :: diffusivity_at
      procedure :: solid_at
      procedure :: heat_pressure
      procedure :: with_heat
   end type rock_t

   !> Poroelastic constants without those of flow, as in rock_t.
   type :: solid_t
      real(rk) :: shear = 0.0_rk  !< [Pa]
      real(rk) :: lame = 0.0_rk  !< [Pa]
      real(rk) :: biot = 0.0_rk  !< [-]
      real(rk) :: storage = 0.0_rk  !< [1/Pa]
      real(rk) :: heat_stress = 0.0_rk  !< [Pa/K]
      real(rk) :: heat_content = 0.0_rk  !< [1/K]
      integer(ik) :: stiffness = 0  !< as in rock_t
   contains
      procedure :: crack_modulus
      procedure :: poisson
      procedure :: storage_at_stress
      procedure :: content_per_heat
      procedure :: uniaxial_storage
   end type solid_t

   real(rk), parameter :: nothing = 1.0e-9_rk  !< share of a cell that is rounding [-]

contains

   !> Constants from the scene (docs/theory.md).
   pure function new_rock(material, fluid) result(rock)
      type(material_t), intent(in) :: material
      type(fluid_t), intent(in) :: fluid
      type(rock_t) :: rock

      real(rk) :: modulus

      allocate (rock%shear(1), rock%lame(1), rock%biot(1), rock%storage(1))
      allocate (rock%stiffness(1), source=0_ik)
      associate (e => material%young, nu => material%poisson)
         rock%shear = e/(2.0_rk*(1.0_rk + nu))
         rock%lame = e*nu/((1.0_rk + nu)*(1.0_rk - 2.0_rk*nu))
         if (material%plane_stress) rock%lame = e*nu/(1.0_rk - nu**2)
      end associate
      rock%biot = material%biot
      rock%storage = storage(material, fluid)
      rock%heat_stress = [bulk_modulus(material)*material%heat_expansion]
      rock%heat_content = [material%porosity*fluid%heat_expansion &
                           + (material%biot - material%porosity)*material%heat_expansion]
      if (material%plane_stress) then
         ! Without stress across the plane, strain follows there: e_zz = (alpha p - lambda (e_xx +
         ! e_yy))/(lambda + 2 G), lambda that of the solid.
         associate (nu => material%poisson)
            modulus = 2.0_rk*rock%shear(1)*(1.0_rk - nu)/(1.0_rk - 2.0_rk*nu)
         end associate
         rock%biot = material%biot*2.0_rk*rock%shear/modulus
         rock%storage = rock%storage + material%biot**2/modulus
         rock%heat_content = rock%heat_content - material%biot*rock%heat_stress/modulus
         rock%heat_stress = rock%heat_stress*2.0_rk*rock%shear/modulus
      end if
      allocate (rock%permeability(3, 1), rock%resistivity(2, 2, 1))
      rock%permeability(:, 1) = [material%permeability_xx, material%permeability_yy, &
                                 material%permeability_xy]
      rock%resistivity(:, :, 1) = resistivity_of(rock%permeability(:, 1), fluid%viscosity)
      rock%mobility = mean_mobility(rock%permeability(:, 1), fluid%viscosity)
   end function new_rock

   !> The mean of K/mu in a cell [m2/(Pa s)].
   pure real(rk) function mobility_at(self, cell)
      class(rock_t), intent(in) :: self
      integer(ik), intent(in) :: cell

      associate (r => self%resistivity(:, :, min(int(cell), size(self%resistivity, 3))))
         mobility_at = 1.0_rk/sqrt(r(1, 1)*r(2, 2) - r(1, 2)*r(2, 1))
      end associate
   end function mobility_at

   !> Mean of the two principal K/mu over their geometric mean; 1 in isotropic rock [-].
   pure real(rk) function mean_over_mobility(self, cell) result(ratio)
      class(rock_t), intent(in) :: self
      integer(ik), intent(in) :: cell

      associate (r => self%resistivity(:, :, min(int(cell), size(self%resistivity, 3))))
         ratio = max(1.0_rk, 0.5_rk*(r(1, 1) + r(2, 2))*self%mobility_at(cell))
      end associate
   end function mean_over_mobility

   !> c at uniaxial strain [m2/s].
   pure real(rk) function diffusivity_at(self, cell)
      class(rock_t), intent(in) :: self
      integer(ik), intent(in) :: cell
      type(solid_t) :: solid

      solid = self%solid_at(cell)
      diffusivity_at = self%mobility_at(cell)/solid%uniaxial_storage()
   end function diffusivity_at

   !> The inverse of K/mu.
   pure function resistivity_of(permeability, viscosity) result(resistivity)
      real(rk), intent(in) :: permeability(3)  !< K_xx, K_yy, K_xy [m2]
      real(rk), intent(in) :: viscosity  !< [Pa s]
      real(rk) :: resistivity(2, 2)  !< [Pa s/m2]
      real(rk) :: determinant

      determinant = permeability(1)*permeability(2) - permeability(3)**2
      resistivity(1, 1) = permeability(2)
      resistivity(2, 2) = permeability(1)
      resistivity(1, 2) = -permeability(3)
      resistivity(2, 1) = -permeability(3)
      resistivity = resistivity*(viscosity/determinant)
   end function resistivity_of

   !> The geometric mean of K/mu over directions [m2/(Pa s)].
   pure real(rk) function mean_mobility(permeability, viscosity) result(mobility)
      real(rk), intent(in) :: permeability(3)  !< K_xx, K_yy, K_xy [m2]
      real(rk), intent(in) :: viscosity  !< [Pa s]

      mobility = sqrt(permeability(1)*permeability(2) - permeability(3)**2)/viscosity
   end function mean_mobility

   !> Poroelastic constants of a cell.
   pure type(solid_t) function solid_at(self, cell) result(solid)
      class(rock_t), intent(in) :: self
      integer(ik), intent(in) :: cell
      integer(ik) :: at

      at = min(cell, size(self%shear, kind=ik))
      solid = solid_t(shear=self%shear(at), lame=self%lame(at), biot=self%biot(at), &
                      storage=self%storage(at), heat_stress=self%heat_stress(at), &
                      heat_content=self%heat_content(at), stiffness=self%stiffness(at))
   end function solid_at

   !> The pressure p_T that has the stress of a rise of the temperature in a cell [Pa].
   pure real(rk) function heat_pressure(self, cell, temperature)
      class(rock_t), intent(in) :: self
      integer(ik), intent(in) :: cell
      real(rk), intent(in) :: temperature  !< [K]
      integer(ik) :: at

      at = min(cell, size(self%shear, kind=ik))
      heat_pressure = 0.0_rk
      if (self%heat_stress(at) > 0.0_rk) heat_pressure = self%heat_stress(at)*temperature &
                                                         /self%biot(at)
   end function heat_pressure

   !> The unknowns with p_T added to the pressures of the cells: what the stress follows from.
   pure function with_heat(self, unknowns) result(acting)
      class(rock_t), intent(in) :: self
      real(rk), intent(in) :: unknowns(:, :)  !< (3, n_blocks) [m], [m], [Pa]
      real(rk), allocatable :: acting(:, :)
      integer(ik) :: c

      acting = unknowns
      if (.not. allocated(self%temperature)) return
      do c = 1, size(self%temperature, kind=ik)
         acting(3, c) = acting(3, c) + self%heat_pressure(c, self%temperature(c))
      end do
   end function with_heat

   !> Number the rocks by stiffness.
   pure subroutine number_stiffnesses(solid)
      type(solid_t), intent(inout) :: solid(:)
      integer(ik) :: i, k

      do i = 1, size(solid, kind=ik)
         solid(i)%stiffness = i
         do k = 1, i - 1
            if (abs(solid(i)%shear - solid(k)%shear) > same_value*solid(k)%shear) cycle
            if (abs(solid(i)%lame - solid(k)%lame) > same_value*(solid(k)%shear &
                                                                 + abs(solid(k)%lame))) cycle
            solid(i)%stiffness = solid(k)%stiffness
            exit
         end do
      end do
   end subroutine number_stiffnesses

   !> Whether regions differ in stiffness or storage from the surrounding rock.
   pure logical function any_differ(solid)
      type(solid_t), intent(in) :: solid(:)

      any_differ = any(solid%stiffness /= solid(1)%stiffness) .or. &
                   any(abs(solid%biot - solid(1)%biot) > 0.0_rk) .or. &
                   any(abs(solid%storage - solid(1)%storage) > 0.0_rk) .or. &
                   any(abs(solid%heat_stress - solid(1)%heat_stress) > 0.0_rk) .or. &
                   any(abs(solid%heat_content - solid(1)%heat_content) > 0.0_rk)
   end function any_differ

   !> Allocate separate constants for each cell.
   pure subroutine make_room(n_cells, rock)
      integer(ik), intent(in) :: n_cells
      type(rock_t), intent(inout) :: rock

      deallocate (rock%shear, rock%lame, rock%biot, rock%storage, rock%stiffness)
      deallocate (rock%heat_stress, rock%heat_content)
      allocate (rock%shear(n_cells), rock%lame(n_cells), rock%biot(n_cells), &
                rock%storage(n_cells), rock%stiffness(n_cells), rock%heat_stress(n_cells), &
                rock%heat_content(n_cells))
   end subroutine make_room

   !> Set the constants of a cell from its parts.
   pure subroutine set_solid(part, solid, cell, rock)
      real(rk), intent(in) :: part(:)  !< area in each rock [m2]
      type(solid_t), intent(in) :: solid(:)  !< those rocks
      integer(ik), intent(in) :: cell
      type(rock_t), intent(inout) :: rock
      type(solid_t) :: own

      if (count(part > nothing*sum(part)) == 1) then
         own = solid(maxloc(part, dim=1))
      else
         own = mixed(part/sum(part), solid)
      end if
      rock%shear(cell) = own%shear
      rock%lame(cell) = own%lame
      rock%biot(cell) = own%biot
      rock%storage(cell) = own%storage
      rock%heat_stress(cell) = own%heat_stress
      rock%heat_content(cell) = own%heat_content
      rock%stiffness(cell) = own%stiffness
   end subroutine set_solid

   !> Constants of the mean strain and fluid content at uniform stress and pressure.
   pure type(solid_t) function mixed(part, solid) result(mean)
      real(rk), intent(in) :: part(:)  !< [-]
      type(solid_t), intent(in) :: solid(:)
      real(rk) :: by_pressure, content, nu, softness

      softness = sum(part/(2.0_rk*solid%shear))
      nu = sum(part*solid%poisson()/(2.0_rk*solid%shear))/softness
      by_pressure = sum(part*solid%biot/(2.0_rk*(solid%lame + solid%shear)))
      content = sum(part*solid%storage_at_stress())
      mean%shear = 0.5_rk/softness
      mean%lame = 2.0_rk*mean%shear*nu/(1.0_rk - 2.0_rk*nu)
      mean%biot = 2.0_rk*(mean%lame + mean%shear)*by_pressure
      mean%storage = content - mean%biot**2/(mean%lame + mean%shear)
      mean%heat_stress = 2.0_rk*(mean%lame + mean%shear) &
                         *sum(part*solid%heat_stress/(2.0_rk*(solid%lame + solid%shear)))
      mean%heat_content = mean%biot*mean%heat_stress/(mean%lame + mean%shear) &
                          - sum(part*solid%content_per_heat())
      mean%stiffness = solid(maxloc(part, dim=1))%stiffness
   end function mixed

   !> Mean rock of some cells in equal parts.
   pure type(solid_t) function mean_solid(rock, cells) result(mean)
      type(rock_t), intent(in) :: rock
      integer(ik), intent(in) :: cells(:)
      type(solid_t) :: solid(size(cells))
      integer(ik) :: i

      mean = rock%solid_at(1_ik)
      if (size(rock%shear) == 1) return
      do i = 1, size(cells, kind=ik)
         solid(i) = rock%solid_at(cells(i))
      end do
      mean = solid(1)
      if (any(solid%stiffness /= mean%stiffness) .or. &
          any(abs(solid%shear - mean%shear) > 0.0_rk)) then
         mean = mixed(spread(1.0_rk/size(cells), 1, size(cells)), solid)
      end if
   end function mean_solid

   !> Shear modulus of the rock on both sides of each fracture cell (mean_solid) [Pa].
   pure function shear_beside(rock, mesh) result(shear)
      type(rock_t), intent(in) :: rock
      type(mesh_t), intent(in) :: mesh
      real(rk) :: shear(mesh%fracture%n_cells)
      type(solid_t) :: beside
      integer(ik) :: i

      shear = rock%shear(1)
      if (size(rock%shear) == 1) return
      do i = 1, mesh%fracture%n_cells
         beside = mean_solid(rock, mesh%face_cells(1, mesh%fracture%cell_faces(:, i)))
         shear(i) = beside%shear
      end do
   end function shear_beside

   !> E', in plane strain E/(1 - nu^2) [Pa].
   elemental real(rk) function crack_modulus(self)
      class(solid_t), intent(in) :: self

      crack_modulus = 4.0_rk*self%shear*(self%lame + self%shear)/(self%lame + 2.0_rk*self%shear)
   end function crack_modulus

   !> Poisson's ratio of the two-dimensional constants, as in plane strain [-].
   elemental real(rk) function poisson(self)
      class(solid_t), intent(in) :: self

      poisson = self%lame/(2.0_rk*(self%lame + self%shear))
   end function poisson

   !> Fluid content per pressure at constant stress in the plane, S + alpha^2/(lambda + G) [1/Pa].
   elemental real(rk) function storage_at_stress(self)
      class(solid_t), intent(in) :: self

      storage_at_stress = self%storage + self%biot**2/(self%lame + self%shear)
   end function storage_at_stress

   !> Fluid content per rise of the temperature at constant stress in the plane [1/K].
   elemental real(rk) function content_per_heat(self)
      class(solid_t), intent(in) :: self

      content_per_heat = self%biot*self%heat_stress/(self%lame + self%shear) - self%heat_content
   end function content_per_heat

   !> Fluid content per pressure at constant stress in one direction and no strain in the others, as
   !! in layers and around wells, S + alpha^2/(lambda + 2 G) [1/Pa].
   elemental real(rk) function uniaxial_storage(self)
      class(solid_t), intent(in) :: self

      uniaxial_storage = self%storage + self%biot**2/(self%lame + 2.0_rk*self%shear)
   end function uniaxial_storage

end module coarse_rock
