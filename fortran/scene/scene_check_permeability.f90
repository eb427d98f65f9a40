!> Checks the permeability of the rock and of regions: isotropic, or a positive definite tensor.
module scene_check_permeability
   use base_errors, only: error_t
   use base_kinds, only: rk
   use scene_parameters, only: groups
   use scene_sheet, only: refuse, sheet_t
   use scene_types, only: material_t
   use scene_words, only: real_text
   implicit none(type, external)
   private

   public :: check_given_permeability, check_tensor

contains

   !> It is given as a scalar or as a tensor.
   pure subroutine check_given_permeability(sheet, error)
      type(sheet_t), intent(in) :: sheet
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, sheet%length
         select case (groups(sheet%records(i)%group)%name)
         case ("material")
            call check_record(sheet, i, sheet%has("fluid"), "a scene with &fluid", error)
         case ("region")
            call check_record(sheet, i, .true., "a region", error)
         case default
            cycle
         end select
         if (allocated(error)) return
      end do
   end subroutine check_given_permeability

   pure subroutine check_record(sheet, i, is_needed, who, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: i
      logical, intent(in) :: is_needed
      character(len=*), intent(in) :: who  !< needs it
      type(error_t), allocatable, intent(out) :: error
      logical :: scalar, xx, yy, xy

      scalar = sheet%records(i)%is_given("permeability")
      xx = sheet%records(i)%is_given("permeability_xx")
      yy = sheet%records(i)%is_given("permeability_yy")
      xy = sheet%records(i)%is_given("permeability_xy")
      if (scalar .and. (xx .or. yy .or. xy)) then
         call refuse(error, sheet, i, "permeability", "is given beside components of the "// &
                     "tensor but must be given alone or not at all")
      else if ((xx .neqv. yy) .or. (xy .and. .not. xx)) then
         call refuse(error, sheet, i, merge("permeability_yy", "permeability_xx", xx), &
                     "is missing but must be given with the other components of the tensor")
      else if (is_needed .and. .not. (scalar .or. xx)) then
         call refuse(error, sheet, i, "permeability", "[m2], which "//who//" needs, is missing")
      end if
   end subroutine check_record

   !> The tensor is positive definite.
   pure subroutine check_tensor(sheet, i, material, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: i  !< record
      type(material_t), intent(in) :: material
      type(error_t), allocatable, intent(out) :: error

      associate (m => material)
         if (abs(m%permeability_xy) < sqrt(m%permeability_xx)*sqrt(m%permeability_yy)) return
         call refuse(error, sheet, i, "permeability_xy", "is "//real_text(m%permeability_xy)// &
                     " but must be smaller than sqrt(permeability_xx permeability_yy), for the "// &
                     "tensor must be positive definite")
      end associate
   end subroutine check_tensor

end module scene_check_permeability
