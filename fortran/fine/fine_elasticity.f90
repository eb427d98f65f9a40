!> Isotropic linear elasticity in the plane, with the constants of crack tip fields.
module fine_elasticity
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   implicit none(type, external)
   private

   public :: check_elasticity, elasticity_t, is_same, rocks_t

   !> An isotropic poroelastic solid: total stress = C : strain - biot * pore pressure * identity,
   !! where all tensors are those of the plane.
   type :: elasticity_t
      real(rk) :: young = 0.0_rk  !< Young's modulus [Pa]
      real(rk) :: poisson = 0.0_rk  !< Poisson's ratio [-]
      !> Biot's coefficient of the in-plane stress [-]; in bodies without a fluid K_dr b_s in the
      !! plane, with temperatures as heat_pressure of fine_loads [Pa/K]
      real(rk) :: biot = 0.0_rk
      logical :: plane_stress = .false.  !< else plane strain
   contains
      procedure :: shear_modulus
      procedure :: lame_lambda
      procedure :: kolosov
      procedure :: crack_modulus
      procedure :: total_stress
   end type elasticity_t

   !> The rocks of a body, and which one each element is of: (n_cells), or one item for all.
   type :: rocks_t
      type(elasticity_t), allocatable :: elasticity(:)
      integer(ik), allocatable :: of_cell(:)
   contains
      procedure :: index_of
      procedure :: in_cell
   end type rocks_t

contains

   !> The number of the rock of an element.
   pure integer(ik) function index_of(self, cell)
      class(rocks_t), intent(in) :: self
      integer(ik), intent(in) :: cell

      index_of = self%of_cell(min(cell, size(self%of_cell, kind=ik)))
   end function index_of

   !> The rock of an element.
   pure function in_cell(self, cell) result(elasticity)
      class(rocks_t), intent(in) :: self
      integer(ik), intent(in) :: cell
      type(elasticity_t) :: elasticity

      elasticity = self%elasticity(self%index_of(cell))
   end function in_cell

   !> Two rocks have the same constants.
   elemental logical function is_same(a, b)
      type(elasticity_t), intent(in) :: a, b

      is_same = .not. (abs(a%young - b%young) > 0.0_rk .or. abs(a%poisson - b%poisson) > 0.0_rk &
                       .or. abs(a%biot - b%biot) > 0.0_rk)
   end function is_same

   !> Refuse constants without a positive definite stiffness.
   pure subroutine check_elasticity(elasticity, error)
      type(elasticity_t), intent(in) :: elasticity
      type(error_t), allocatable, intent(out) :: error

      if (.not. (elasticity%young > 0.0_rk .and. elasticity%young <= huge(1.0_rk))) then
         call raise_error(error, "check_elasticity", "Young's modulus must be positive and finite")
      else if (.not. (elasticity%poisson > -1.0_rk .and. elasticity%poisson < 0.5_rk)) then
         call raise_error(error, "check_elasticity", "Poisson's ratio must lie between -1 and 0.5")
      else if (.not. abs(elasticity%biot) <= huge(1.0_rk)) then
         call raise_error(error, "check_elasticity", "Biot's coefficient is not a finite number")
      end if
   end subroutine check_elasticity

   !> Shear modulus [Pa].
   pure real(rk) function shear_modulus(self)
      class(elasticity_t), intent(in) :: self

      shear_modulus = self%young/(2.0_rk*(1.0_rk + self%poisson))
   end function shear_modulus

   !> The factor of the in-plane strain trace in the in-plane stress [Pa]; Lame's first constant in
   !! plane strain.
   pure real(rk) function lame_lambda(self)
      class(elasticity_t), intent(in) :: self

      associate (nu => self%poisson)
         if (self%plane_stress) then
            lame_lambda = self%young*nu/(1.0_rk - nu**2)
         else
            lame_lambda = self%young*nu/((1.0_rk + nu)*(1.0_rk - 2.0_rk*nu))
         end if
      end associate
   end function lame_lambda

   !> Kolosov's constant [-].
   pure real(rk) function kolosov(self)
      class(elasticity_t), intent(in) :: self

      if (self%plane_stress) then
         kolosov = (3.0_rk - self%poisson)/(1.0_rk + self%poisson)
      else
         kolosov = 3.0_rk - 4.0_rk*self%poisson
      end if
   end function kolosov

   !> E' of Irwin's relation G = K**2/E' [Pa].
   pure real(rk) function crack_modulus(self)
      class(elasticity_t), intent(in) :: self

      crack_modulus = self%young
      if (.not. self%plane_stress) crack_modulus = self%young/(1.0_rk - self%poisson**2)
   end function crack_modulus

   !> Total stress [Pa] from the displacement gradient and the pore pressure.
   pure function total_stress(self, gradient, pressure) result(stress)
      class(elasticity_t), intent(in) :: self
      real(rk), intent(in) :: gradient(2, 2)  !< d u_i / d x_j [-]
      real(rk), intent(in) :: pressure  !< [Pa]
      real(rk) :: stress(2, 2)
      real(rk) :: mean_part

      mean_part = self%lame_lambda()*(gradient(1, 1) + gradient(2, 2)) - self%biot*pressure
      stress = self%shear_modulus()*(gradient + transpose(gradient))
      stress(1, 1) = stress(1, 1) + mean_part
      stress(2, 2) = stress(2, 2) + mean_part
   end function total_stress

end module fine_elasticity
