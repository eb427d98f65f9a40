!> Poroelastic constants of the rock in the form that the discretization uses.
module coarse_rock
   use base_kinds, only: ik, rk
   use scene_storage, only: storage
   use scene_types, only: fluid_t, material_t
   implicit none(type, external)
   private

   public :: mean_mobility, new_rock, resistivity_of, rock_t, shear_of

   !> Isotropic elastic, anisotropic permeable rock; two-dimensional constants. The lists hold one
   !! item if the rock is uniform, else one per cell: what cell c has is at min(c, size).
   type :: rock_t
      real(rk), allocatable :: shear(:)  !< shear modulus G [Pa]
      real(rk), allocatable :: lame(:)  !< first Lame constant, reduced for plane stress [Pa]
      real(rk), allocatable :: biot(:)  !< alpha of the stress in the plane [-]
      real(rk), allocatable :: storage(:)  !< S at fixed strain in the plane [1/Pa]
      !> Rocks of one stiffness have one number: across an outline between two of them, the rotation
      !! jumps (coarse_regions).
      integer(ik), allocatable :: stiffness(:)
      real(rk) :: mobility = 0.0_rk  !< mean of K/mu of the scene's rock [m2/(Pa s)]
      ! (.., 1) of a uniform rock, (.., n_cells) where regions differ (coarse_permeability):
      real(rk), allocatable :: permeability(:, :)  !< (3, ..) K_xx, K_yy, K_xy [m2]
      real(rk), allocatable :: resistivity(:, :, :)  !< (2, 2, ..) inverse of K/mu [Pa s/m2]
      !> How much better a cell that outlines of regions cut conducts along them than across, at the
      !! most, and which one; 0: no cell is cut.
      real(rk) :: most_layered = 0.0_rk
      integer(ik) :: most_layered_cell = 0
   contains
      procedure :: mobility_at
   end type rock_t

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
         rock%shear = shear_of(material)
         rock%lame = e*nu/((1.0_rk + nu)*(1.0_rk - 2.0_rk*nu))
         if (material%plane_stress) rock%lame = e*nu/(1.0_rk - nu**2)
      end associate
      rock%biot = material%biot
      rock%storage = storage(material, fluid)
      if (material%plane_stress) then
         ! Without stress across the plane, strain follows there: e_zz = (alpha p - lambda (e_xx +
         ! e_yy))/(lambda + 2 G), lambda that of the solid.
       modulus = 2.0_rk*rock%shear(1)*(1.0_rk - material%poisson)/(1.0_rk - 2.0_rk*material%poisson)
         rock%biot = material%biot*2.0_rk*rock%shear/modulus
         rock%storage = rock%storage + material%biot**2/modulus
      end if
      allocate (rock%permeability(3, 1), rock%resistivity(2, 2, 1))
      rock%permeability(:, 1) = [material%permeability_xx, material%permeability_yy, &
                                 material%permeability_xy]
      rock%resistivity(:, :, 1) = resistivity_of(rock%permeability(:, 1), fluid%viscosity)
      rock%mobility = mean_mobility(rock%permeability(:, 1), fluid%viscosity)
   end function new_rock

   !> Shear modulus G [Pa].
   pure real(rk) function shear_of(material)
      type(material_t), intent(in) :: material

      shear_of = material%young/(2.0_rk*(1.0_rk + material%poisson))
   end function shear_of

   !> The mean of K/mu in a cell [m2/(Pa s)].
   pure real(rk) function mobility_at(self, cell)
      class(rock_t), intent(in) :: self
      integer(ik), intent(in) :: cell

      associate (r => self%resistivity(:, :, min(int(cell), size(self%resistivity, 3))))
         mobility_at = 1.0_rk/sqrt(r(1, 1)*r(2, 2) - r(1, 2)*r(2, 1))
      end associate
   end function mobility_at

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

end module coarse_rock
