!> The stiffness and storage of cells in a body with regions.
!!
!! A cell within one region has the constants of the region. In a cell cut by outlines, stress and
!! pressure are assumed uniform, as in the mixed scheme, and the resulting strain and fluid content
!! are means over the cell's area:
!!   eps = <A> sigma + <b> p I,  content = <b> tr sigma + <s> p,
!! with the compliance A = (sigma - nu tr sigma I)/(2 G), b = alpha/(2 (lambda + G)) and s = S +
!! alpha^2/(lambda + G). This is the result of exact integration of the scheme: the complementary
!! energy of the true body for a stress that is uniform in each cell. It is positive definite as
!! those of the rocks are. Layers in series are exact; layers in parallel are too soft in the cut
!! cells.
module coarse_solid
   use base_kinds, only: ik, rk
   use base_tolerances, only: same_value
   use coarse_regions, only: rock_t
   use mesh_types, only: mesh_t
   implicit none(type, external)
   private

   public :: any_differ, make_room, mean_solid, number_stiffnesses, set_solid, shear_beside
   public :: solid_of, solid_t

   !> Poroelastic constants without those of flow, as in rock_t.
   type :: solid_t
      real(rk) :: shear = 0.0_rk  !< [Pa]
      real(rk) :: lame = 0.0_rk  !< [Pa]
      real(rk) :: biot = 0.0_rk  !< [-]
      real(rk) :: storage = 0.0_rk  !< [1/Pa]
      integer(ik) :: stiffness = 0  !< as in rock_t
   contains
      procedure :: crack_modulus
      procedure :: poisson
   end type solid_t

   real(rk), parameter :: nothing = 1.0e-9_rk  !< share of a cell that is rounding [-]

contains

   !> What cell 1 has, or all.
   pure type(solid_t) function solid_of(rock, cell) result(solid)
      type(rock_t), intent(in) :: rock
      integer(ik), intent(in), optional :: cell
      integer(ik) :: at

      at = 1
      if (present(cell)) at = min(cell, size(rock%shear, kind=ik))
      solid = solid_t(shear=rock%shear(at), lame=rock%lame(at), biot=rock%biot(at), &
                      storage=rock%storage(at), stiffness=rock%stiffness(at))
   end function solid_of

   !> Number the rocks such that those of one stiffness have one number.
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

   !> Regions have other stiffness or storage than the rock around.
   pure logical function any_differ(solid)
      type(solid_t), intent(in) :: solid(:)

      any_differ = any(solid%stiffness /= solid(1)%stiffness) .or. &
                   any(abs(solid%biot - solid(1)%biot) > 0.0_rk) .or. &
                   any(abs(solid%storage - solid(1)%storage) > 0.0_rk)
   end function any_differ

   !> Let each cell have constants of its own.
   pure subroutine make_room(n_cells, rock)
      integer(ik), intent(in) :: n_cells
      type(rock_t), intent(inout) :: rock

      deallocate (rock%shear, rock%lame, rock%biot, rock%storage, rock%stiffness)
      allocate (rock%shear(n_cells), rock%lame(n_cells), rock%biot(n_cells), &
                rock%storage(n_cells), rock%stiffness(n_cells))
   end subroutine make_room

   !> The constants of a cell from its parts.
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
      rock%stiffness(cell) = own%stiffness
   end subroutine set_solid

   !> The mean of what stress and pressure make of strain and content.
   pure type(solid_t) function mixed(part, solid) result(mean)
      real(rk), intent(in) :: part(:)  !< [-]
      type(solid_t), intent(in) :: solid(:)
      real(rk) :: by_pressure, content, nu, softness

      softness = sum(part/(2.0_rk*solid%shear))
      nu = sum(part*solid%poisson()/(2.0_rk*solid%shear))/softness
      by_pressure = sum(part*solid%biot/(2.0_rk*(solid%lame + solid%shear)))
      content = sum(part*(solid%storage + solid%biot**2/(solid%lame + solid%shear)))
      mean%shear = 0.5_rk/softness
      mean%lame = 2.0_rk*mean%shear*nu/(1.0_rk - 2.0_rk*nu)
      mean%biot = 2.0_rk*(mean%lame + mean%shear)*by_pressure
      mean%storage = content - mean%biot**2/(mean%lame + mean%shear)
      mean%stiffness = solid(maxloc(part, dim=1))%stiffness
   end function mixed

   !> Some cells in equal parts.
   pure type(solid_t) function mean_solid(rock, cells) result(mean)
      type(rock_t), intent(in) :: rock
      integer(ik), intent(in) :: cells(:)
      type(solid_t) :: solid(size(cells))
      integer(ik) :: i

      mean = solid_of(rock)
      if (size(rock%shear) == 1) return
      do i = 1, size(cells, kind=ik)
         solid(i) = solid_of(rock, cells(i))
      end do
      mean = solid(1)
      if (any(solid%stiffness /= mean%stiffness) .or. &
          any(abs(solid%shear - mean%shear) > 0.0_rk)) then
         mean = mixed(spread(1.0_rk/size(cells), 1, size(cells)), solid)
      end if
   end function mean_solid

   !> The shear modulus beside each fracture cell, of both sides as mean_solid has it [Pa].
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

end module coarse_solid
