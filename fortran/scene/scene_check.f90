!> Checks values against each other: first which names are given, also the relations between names
!! that the table of parameters defines, then the numbers.
module scene_check
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_tolerances, only: round_off
   use scene_check_entries, only: check_meetings
   use scene_check_fluid, only: check_fluid, check_given_fluid, check_given_wells, check_wells
   use scene_check_geometry, only: check_domain, check_fractures, check_least_size, check_probes
   use scene_check_heat, only: check_given_heat, check_heat
   use scene_check_mechanics, only: check_laws, check_load, check_restraints, check_support, &
                                    check_weight
   use scene_check_permeability, only: check_given_permeability, check_tensor
   use scene_check_regions, only: check_given_regions, check_regions
   use scene_check_sides, only: check_faces, check_parts, check_sides
   use scene_fluid_law, only: least_compressibility, skempton, storage
   use scene_parameter_table, only: parameters
   use scene_parameters, only: choice_name, choice_value, groups
   use scene_sheet, only: line_text, parameter_index, record_t, refuse, sheet_t
   use scene_types, only: scene_t
   use scene_values, only: value_t
   use scene_words, only: real_text, rounded_text
   implicit none(type, external)
   private

   public :: check_scene, check_sheet

contains

   !> Check which names are given together.
   pure subroutine check_sheet(sheet, error)
      type(sheet_t), intent(in) :: sheet
      type(error_t), allocatable, intent(out) :: error

      call check_names(sheet, error)
      if (.not. allocated(error)) call check_given_permeability(sheet, error)
      if (.not. allocated(error) .and. sheet%has("region")) call check_given_regions(sheet, error)
      if (.not. allocated(error)) call check_sides(sheet, error)
      if (.not. allocated(error)) call check_table(sheet, error)
      if (.not. allocated(error)) call check_given_wells(sheet, error)
      if (.not. allocated(error)) call check_given_fluid(sheet, error)
      if (.not. allocated(error)) call check_given_heat(sheet, error)
   end subroutine check_sheet

   !> Check the numbers of a scene against each other.
   pure subroutine check_scene(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet  !< the file of the scene, for messages about its lines
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error

      call check_domain(sheet, scene, error)
      if (.not. allocated(error)) call check_least_size(sheet, scene, error)
      if (.not. allocated(error)) call check_material(sheet, scene, error)
      if (.not. allocated(error) .and. allocated(scene%regions)) then
         call check_regions(sheet, scene, error)
      end if
      if (.not. allocated(error)) call check_parts(sheet, scene, error)
      if (.not. allocated(error)) call check_support(sheet, scene, error)
      if (scene%has_fluid()) then
         if (.not. allocated(error)) call check_weight(sheet, scene, error)
         if (.not. allocated(error)) call check_column(sheet, scene, error)
         if (.not. allocated(error)) call check_fluid(sheet, scene%fluid, error)
      else
         if (.not. allocated(error)) call check_load(sheet, scene, error)
         if (.not. allocated(error)) call check_weight(sheet, scene, error)
      end if
      if (.not. allocated(error)) call check_restraints(sheet, scene, error)
      if (.not. allocated(error)) call check_laws(sheet, scene, error)
      if (.not. allocated(error)) call check_faces(sheet, scene, error)
      if (.not. allocated(error)) call check_fractures(sheet, scene, error)
      if (.not. allocated(error)) call check_wells(sheet, scene, error)
      if (.not. allocated(error)) call check_heat(sheet, scene, error)
      if (.not. allocated(error)) call check_meetings(sheet, scene, error)
      if (.not. allocated(error)) call check_probes(sheet, scene, error)
      if (.not. allocated(error)) call check_levels(sheet, scene, error)
   end subroutine check_scene

   !> No two fractures, regions, sides, wells or probes have the same name.
   pure subroutine check_names(sheet, error)
      type(sheet_t), intent(in) :: sheet
      type(error_t), allocatable, intent(out) :: error
      integer :: i, item, j

      do i = 1, sheet%length
         select case (groups(sheet%records(i)%group)%name)
         case ("fracture", "region", "side", "probe", "injection")
            item = parameter_index(sheet%records(i)%group, "name")
         case default
            cycle
         end select
         associate (name => sheet%records(i)%values(item))
            if (.not. name%is_set) cycle  ! a well, named after its number
            do j = 1, i - 1
               if (sheet%records(j)%group /= sheet%records(i)%group) cycle
               if (.not. sheet%records(j)%values(item)%is_set) cycle
               if (name%text /= sheet%records(j)%values(item)%text) cycle
               call refuse(error, sheet, i, "name", "'"//name%text//"' is already taken on "// &
                           line_text(sheet, j, sheet%records(j)%values(item)%line, i)// &
                           " but must be unique")
               return
            end do
         end associate
      end do
   end subroutine check_names

   !> The storage coefficient is positive, the undrained pressure due to a load is not larger than
   !! the load, and the permeability is positive definite.
   pure subroutine check_material(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      if (.not. sheet%has("fluid")) return
      i = sheet%find("material")
      associate (m => scene%material, fluid => scene%fluid)
         if (m%biot < m%porosity) then
            call refuse(error, sheet, i, "biot", "is "//real_text(m%biot)// &
                        " but must be at least the porosity, "//real_text(m%porosity))
         else if (.not. storage(m, fluid) > 0.0_rk) then
            call refuse(error, sheet, i, "biot", "and porosity give no storage: phi c_p and "// &
                        "the part of the solid are both zero, but their sum must be positive")
         else if (.not. fluid%compressibility > 0.0_rk .and. &
                  skempton(m, fluid) > 1.0_rk + round_off) then
            call refuse(error, sheet, sheet%find("fluid"), "compressibility", "is 0.0, which "// &
                        "makes Skempton's coefficient B = alpha/(K S + alpha^2) of this rock "// &
                        rounded_text(skempton(m, fluid))//", but that must be at most 1; "// &
                        rounded_text(least_compressibility(m))//" 1/Pa would make it 1")
         else
            call check_tensor(sheet, i, m, error)
         end if
      end associate
   end subroutine check_material

   !> Without a fluid, loads grow until K_eq is K_IC; with a K_IC of 0 no load would do.
   pure subroutine check_toughness(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i, record

      record = 0
      do i = 1, size(scene%fractures)
         if (.not. scene%fractures(i)%toughness > 0.0_rk) record = sheet%find("fracture", i)
      end do
      if (allocated(scene%regions)) then
         do i = 1, size(scene%regions)
            if (.not. scene%regions(i)%material%toughness > 0.0_rk) record = sheet%find("region", i)
         end do
      end if
      if (.not. scene%material%toughness > 0.0_rk) record = sheet%find("material")
      if (record == 0) return
      call refuse(error, sheet, record, "toughness", "is 0 but must be positive in a scene "// &
                  "without &fluid, whose fractures would grow under any load")
   end subroutine check_toughness

   !> Fine level and growth are consistent with the fractures and the coarse level.
   pure subroutine check_levels(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: switch
      integer(ik) :: f

      if (.not. scene%growth%intensities) return
      switch = "intensities"
      if (scene%growth%enabled) switch = "enabled"
      if (size(scene%fractures) == 0) then
         call refuse(error, sheet, sheet%find("growth"), switch, &
                     "is .true. but must be .false., since the scene has no fracture")
         return
      end if
      if (.not. scene%has_fluid()) then
         if (scene%growth%enabled) call check_toughness(sheet, scene, error)
         return
      end if
      if (scene%material%radiation_damping > 0.0_rk) then
         call refuse(error, sheet, sheet%find("material"), "radiation_damping", "is "// &
                     real_text(scene%material%radiation_damping)//" but must be omitted with "// &
                     "stress intensity factors or growth: windows are quasi-static")
         return
      end if
      if (scene%discretization%window_is_body) return
      if (scene%domain%shape /= "rectangle") then
         call refuse(error, sheet, sheet%find("fine"), "window", "is "// &
                     real_text(scene%discretization%window)//" but must be 'body' where the "// &
                     "body is no rectangle: a square could reach beyond it")
         return
      else if (scene%has_points()) then
         call refuse(error, sheet, sheet%find("fine"), "window", "is "// &
                     real_text(scene%discretization%window)//" but must be 'body' with "// &
                     "restraints or point loads, which a square window does not include")
         return
      end if
      do f = 1, size(scene%fractures, kind=ik)
         call check_window(sheet, scene, f, error)
         if (allocated(error)) return
      end do
   end subroutine check_levels

   !> The windows of a fracture's tips are larger than their rosettes and increments.
   pure subroutine check_window(sheet, scene, f, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      integer(ik), intent(in) :: f  !< index of the fracture
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: fine_size, window
      integer :: record

      fine_size = scene%discretization%fine_ratio*scene%cell_size_of(f)
      window = scene%window_of(f)
      if (.not. window > 2.0_rk*fine_size) then  ! the rosette has this radius
         record = owner("fine", scene%fractures(f)%window)
         call refuse(error, sheet, record, "window", "is "//real_text(window)//" but must be "// &
                     "larger than twice the fine mesh size, "//rounded_text(fine_size)// &
                     "; omit it for the default, 5 lengths of the fracture")
      else if (scene%increment_of(f) > 0.5_rk*window) then
         record = owner("growth", scene%fractures(f)%increment)
         call refuse(error, sheet, record, "increment", "is "// &
                     real_text(scene%increment_of(f))//" but must be at most half the "// &
                     "window, "//rounded_text(0.5_rk*window)//"; omit it for the default, "// &
                     "the fine mesh size")
      end if

   contains

      !> The fracture's group if that gives the value.
      pure integer function owner(group, own) result(record)
         character(len=*), intent(in) :: group
         real(rk), intent(in) :: own  !< [m]

         record = sheet%find(group)
         if (own > 0.0_rk) record = sheet%find("fracture", int(f))
      end function owner

   end subroutine check_window

   !> Every name belongs to the choice of its group, is given with its partner, and is not above its
   !! upper bound.
   pure subroutine check_table(sheet, error)
      type(sheet_t), intent(in) :: sheet
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: reason
      integer :: i, item

      do i = 1, sheet%length
         associate (record => sheet%records(i))
            do item = lbound(record%values, 1), ubound(record%values, 1)
               call find_fault(record, item, reason)
               if (.not. allocated(reason)) cycle
               call refuse(error, sheet, i, trim(parameters(item)%name), reason)
               return
            end do
         end associate
      end do
   end subroutine check_table

   !> Find the fault of a name, given or not.
   pure subroutine find_fault(record, item, reason)
      type(record_t), intent(in) :: record
      integer, intent(in) :: item  !< index into parameters
      character(len=:), allocatable, intent(out) :: reason  !< unallocated: no fault
      type(value_t) :: bound, choice
      integer :: other

      associate (rule => parameters(item), value => record%values(item))
         if (value%line > 0 .and. .not. record%suits(item)) then
            choice = record%value(choice_name(rule))
            reason = "is given, but only the "//choice_name(rule)//" '"//choice_value(rule)// &
                     "' has it, and not '"//choice%text//"'"
            return
         end if
         if (rule%with /= "") then
            other = parameter_index(record%group, rule%with)
            if (value%line == 0 .and. record%values(other)%line > 0) then
               reason = "is missing but must be given with "//trim(rule%with)
            end if
         end if
         if (rule%at_most /= "" .and. value%is_set) then
            bound = record%value(trim(rule%at_most))
            if (.not. bound%is_set) return
            if (value%reals(1) <= bound%reals(1)) return
            reason = "is "//real_text(value%reals(1))//" but must be at most "// &
                     trim(rule%at_most)//", "//real_text(bound%reals(1))
         end if
      end associate
   end subroutine find_fault

   !> A fluid with a density has weight along y, and the rock is not lighter than the pore fluid.
   pure subroutine check_column(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      real(rk) :: least  ! smallest density of the rock [kg/m3]

      call check_layers(sheet, scene, error)
      if (allocated(error)) return
      associate (density => scene%fluid%density, rock => scene%material, gravity => scene%gravity)
         if (.not. density > 0.0_rk) return
         call check_region_weights(sheet, scene, error)
         if (allocated(error)) return
         least = rock%porosity*density
         if (.not. any(abs(gravity) > 0.0_rk)) then
            call refuse(error, sheet, sheet%find("fluid"), "density", "is "//real_text(density)// &
                        " but there is no gravity; give &gravity y, on earth -9.81, or omit "// &
                        "the density")
         else if (abs(gravity(1)) > 0.0_rk) then
            call refuse(error, sheet, sheet%find("gravity"), "x", "is "//real_text(gravity(1))// &
                        " but must be 0, since the pressure of a fluid with a density varies "// &
                        "only with y")
         else if (.not. rock%density >= least) then
            call refuse(error, sheet, sheet%find("material"), "density", "is "// &
                        real_text(rock%density)//" but must be at least that of the fluid in "// &
                        "its pores, porosity times density of &fluid: "//rounded_text(least))
         end if
      end associate
   end subroutine check_column

   !> Regions of another density need gravity and are heavier than their pore fluid; one gradient of
   !! stress in situ cannot balance several weights, and windows have a single density.
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
               reason = "but there is no gravity; give &gravity, or omit the density"
            else if (any(abs(scene%in_situ%per_y) > 0.0_rk)) then
               reason = "but must be that of &material, "//real_text(all%density)// &
                        ", with a stress in situ that varies with y: one gradient does not "// &
                        "balance two weights; omit sxx_per_y and syy_per_y, so that the body "// &
                        "settles under its weight"
            else if (scene%growth%intensities) then
               reason = "but must be that of &material, "//real_text(all%density)// &
                        ", with stress intensity factors or growth: windows have a single density"
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

   !> Without a stress in situ a fluid with a density requires a uniform Biot coefficient.
   pure subroutine check_region_weights(sheet, scene, error)
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
                     "&material, "//real_text(scene%material%biot)//", since a fluid with a "// &
                     "density requires a stress in situ here; give &in_situ")
         return
      end do
   end subroutine check_region_weights

end module scene_check
