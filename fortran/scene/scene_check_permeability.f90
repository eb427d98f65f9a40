!> Checks the permeability of the rock and of regions: isotropic, or a positive definite tensor
!! within the range of the multi-point flux approximation of the coarse level.
module scene_check_permeability
   use base_errors, only: error_t
   use base_kinds, only: rk
   use scene_parameters, only: groups
   use scene_sheet, only: refuse, sheet_t
   use scene_types, only: material_t
   use scene_words, only: real_text, rounded_text
   implicit none(type, external)
   private

   public :: anisotropy, check_given_permeability, check_tensor, most_anisotropic

   !> Largest ratio of the principal permeabilities [-]. The fluxes of the coarse level are exact
   !! for linear pressures, but on triangles they have no maximum principle: at a ratio of 100
   !! pressures left their bounds by 20 %, from 1e4 on they grew without a source to 1e10 Pa
   !! (verification/stability_joints).
   real(rk), parameter :: most_anisotropic = 1.0e3_rk

contains

   !> Permeabilities are given as a scalar or as a tensor.
   pure subroutine check_given_permeability(sheet, error)
      type(sheet_t), intent(in) :: sheet
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, sheet%length
         select case (groups(sheet%records(i)%group)%name)
         case ("material")
            call check_record(sheet, i, sheet%has("fluid"), "a scene with &fluid", error)
         case ("region")
            call check_record(sheet, i, .false., "a region", error)
         case default
            cycle
         end select
         if (allocated(error)) return
      end do
   end subroutine check_given_permeability

   !> The permeability of one group is given as a scalar or as a tensor.
   pure subroutine check_record(sheet, i, is_needed, who, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: i  !< index into sheet%records
      logical, intent(in) :: is_needed
      character(len=*), intent(in) :: who  !< subject of "needs" in the message
      type(error_t), allocatable, intent(out) :: error
      logical :: scalar, xx, yy, xy

      scalar = sheet%records(i)%is_given("permeability")
      xx = sheet%records(i)%is_given("permeability_xx")
      yy = sheet%records(i)%is_given("permeability_yy")
      xy = sheet%records(i)%is_given("permeability_xy")
      if (scalar .and. (xx .or. yy .or. xy)) then
         call refuse(error, sheet, i, "permeability", "is given with components of the "// &
                     "tensor, but only one of the two may be given")
      else if ((xx .neqv. yy) .or. (xy .and. .not. xx)) then
         call refuse(error, sheet, i, merge("permeability_yy", "permeability_xx", xx), &
                     "is missing but must be given with the other components of the tensor")
      else if (is_needed .and. .not. (scalar .or. xx)) then
         call refuse(error, sheet, i, "permeability", "[m2], which "//who//" needs, is missing")
      end if
   end subroutine check_record

   !> A permeability tensor is positive definite and not too anisotropic.
   pure subroutine check_tensor(sheet, i, material, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: i  !< record
      type(material_t), intent(in) :: material
      type(error_t), allocatable, intent(out) :: error

      associate (m => material)
         if (.not. abs(m%permeability_xy) < sqrt(m%permeability_xx)*sqrt(m%permeability_yy)) then
            call refuse(error, sheet, i, "permeability_xy", "is "//real_text(m%permeability_xy)// &
                        " but must be smaller than sqrt(permeability_xx permeability_yy), "// &
                        "since the tensor must be positive definite")
         else if (anisotropy(m) > most_anisotropic*(1.0_rk + 1.0e-9_rk)) then
            call refuse(error, sheet, i, "permeability_xx", "and the other components make "// &
             "the rock "//rounded_text(anisotropy(m))//" times more permeable in one direction "// &
                        "than across it, but the flux approximation is valid for a ratio of "// &
                        "at most "//rounded_text(most_anisotropic))
         end if
      end associate
   end subroutine check_tensor

   !> Largest principal permeability over the smallest [-].
   pure real(rk) function anisotropy(material)
      type(material_t), intent(in) :: material
      real(rk) :: half_trace, radius, xx, xy, yy

      associate (m => material)
         ! Over the largest component: products of permeabilities may be too small for a number.
         xx = m%permeability_xx/max(m%permeability_xx, m%permeability_yy)
         yy = m%permeability_yy/max(m%permeability_xx, m%permeability_yy)
         xy = m%permeability_xy/max(m%permeability_xx, m%permeability_yy)
      end associate
      half_trace = 0.5_rk*(xx + yy)
      radius = hypot(0.5_rk*(xx - yy), xy)
      anisotropy = (half_trace + radius)**2/max(xx*yy - xy**2, tiny(1.0_rk))
   end function anisotropy

end module scene_check_permeability
