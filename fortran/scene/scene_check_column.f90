!> Checks the weight of rock and fluid in a scene with a fluid against each other.
module scene_check_column
   use base_errors, only: error_t
   use base_kinds, only: rk
   use scene_sheet, only: refuse, sheet_t
   use scene_types, only: scene_t
   use scene_words, only: real_text, rounded_text
   implicit none(type, external)
   private

   public :: check_column

contains

   !> A fluid with a density has weight, along y, and the rock is no lighter than what fills it.
   pure subroutine check_column(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: least  ! [kg/m3]

      call check_layers(sheet, scene, error)
      if (allocated(error)) return
      associate (density => scene%fluid%density, rock => scene%material, gravity => scene%gravity)
         if (.not. density > 0.0_rk) return
         call check_regions(sheet, scene, error)
         if (allocated(error)) return
         least = rock%porosity*density
         if (.not. any(abs(gravity) > 0.0_rk)) then
            call refuse(error, sheet, sheet%find("fluid"), "density", "is "//real_text(density)// &
                        " but nothing gives the fluid weight; give &gravity y, on earth "// &
                        "-9.81, or leave the density out")
         else if (abs(gravity(1)) > 0.0_rk) then
            call refuse(error, sheet, sheet%find("gravity"), "x", "is "//real_text(gravity(1))// &
                        " but must be 0, for the pressure of a fluid with a density changes "// &
                        "with y alone")
         else if (.not. rock%density >= least) then
            call refuse(error, sheet, sheet%find("material"), "density", "is "// &
                        real_text(rock%density)//" but must be at least that of the fluid in "// &
                        "its pores, porosity times density of &fluid: "//rounded_text(least))
         end if
      end associate
   end subroutine check_column

   !> Rock of several densities has a weight that one gradient of stress does not carry, and that
   !! windows do not know; it is no lighter than what fills it.
   pure subroutine check_layers(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: reason
      integer :: i

      if (.not. allocated(scene%regions)) return
      do i = 1, size(scene%regions)
         associate (rock => scene%regions(i)%material, all => scene%material)
            if (.not. abs(rock%density - all%density) > 0.0_rk) cycle
            if (.not. any(abs(scene%gravity) > 0.0_rk)) then
               reason = "but nothing gives it weight; give &gravity, or leave the density out"
            else if (any(abs(scene%in_situ%per_y) > 0.0_rk)) then
               reason = "but must be that of &material, "//real_text(all%density)// &
                        ", beside a stress in situ that changes with y: one gradient does not "// &
                        "carry two weights; leave sxx_per_y and syy_per_y out, and the body "// &
                        "settles under its weight"
            else if (scene%growth%intensities) then
               reason = "but must be that of &material, "//real_text(all%density)// &
                        ", beside stress intensity factors and growth: windows have one weight"
            else if (.not. rock%density >= rock%porosity*scene%fluid%density) then
               reason = "but must be at least that of the fluid in its pores, porosity times "// &
                        "density of &fluid: "//rounded_text(rock%porosity*scene%fluid%density)
            else
               cycle
            end if
            call refuse(error, sheet, sheet%find("region", i), "density", "is "// &
                        real_text(rock%density)//" "//reason)
            return
         end associate
      end do
   end subroutine check_layers

   !> Without a stress in situ the fluid at rest presses on rock of one Biot coefficient.
   pure subroutine check_regions(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      if (.not. allocated(scene%regions)) return
      if (any(abs(scene%in_situ%stress) > 0.0_rk) .or. &
          any(abs(scene%in_situ%per_y) > 0.0_rk)) return
      do i = 1, size(scene%regions)
         if (.not. abs(scene%regions(i)%material%biot - scene%material%biot) > 0.0_rk) cycle
         call refuse(error, sheet, sheet%find("region", i), "biot", "is "// &
                     real_text(scene%regions(i)%material%biot)//" but must be that of "// &
                     "&material, "//real_text(scene%material%biot)//", where a fluid with a "// &
                     "density has no stress in situ beside it; give &in_situ")
         return
      end do
   end subroutine check_regions

end module scene_check_column
