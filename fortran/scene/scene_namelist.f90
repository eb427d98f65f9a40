!> Reads a scene file. Defaults that depend on other values are resolved only here, so that
!! scene.nml shows the numbers used.
module scene_namelist
   use base_errors, only: error_t, raise_error
   use base_kinds, only: ik, rk
   use base_number, only: integer_text
   use scene_check, only: check_scene, check_sheet
   use scene_exchange, only: sheet_to_scene
   use scene_fluid_law, only: has_law
   use scene_parameter_table, only: parameters
   use scene_parameters, only: applies, choice_name, choice_value, groups, need_always, &
                               need_choice, need_fluid, need_growth
   use scene_parse, only: parse_scene
   use scene_schedule, only: load_schedules
   use scene_sheet, only: add_record, empty_record, group_index, parameter_index, refuse, sheet_t
   use scene_sides, only: normal_tractions
   use scene_sizes, only: choose_sizes
   use scene_types, only: first_share, injection_t, name_length, scene_t
   use scene_values, only: default_value, shortened, value_t
   use scene_words, only: is_identifier
   implicit none(type, external)
   private

   public :: read_scene, resolve_defaults

contains

   !> Read a scene, fill in its defaults and check it. On an error the scene must not be used.
   !! Whether the geometry can be meshed is checked by app_geometry.
   subroutine read_scene(path, scene, error, source)
      character(len=*), intent(in) :: path
      type(scene_t), intent(out) :: scene
      type(error_t), allocatable, intent(out) :: error
      type(sheet_t), intent(out), optional :: source  !< the file, for messages about its lines
      type(sheet_t) :: sheet
      logical :: assumed

      call parse_scene(path, sheet, error)
      if (.not. allocated(error)) call complete_sheet(sheet, error)
      if (.not. allocated(error)) call load_schedules(sheet, error)
      if (.not. allocated(error)) call divide_by_thickness(sheet, assumed)
      if (.not. allocated(error)) call check_sheet(sheet, error)
      if (allocated(error)) return
      call sheet_to_scene(sheet, scene)
      scene%thickness_assumed = assumed
      call resolve_defaults(scene)
      call check_scene(sheet, scene, error)
      if (present(source)) source = sheet
   end subroutine read_scene

   !> Fill in the defaults of a parsed sheet, and refuse groups that lack a required value.
   pure subroutine complete_sheet(sheet, error)
      type(sheet_t), intent(inout) :: sheet
      type(error_t), allocatable, intent(out) :: error
      type(value_t) :: enabled
      logical :: has_fluid, is_needed(0:need_choice)
      integer :: i, item

      has_fluid = sheet%has("fluid")
      do i = 1, size(groups)
         if (.not. (groups(i)%implied .and. applies(groups(i)%scenes, has_fluid))) cycle
         if (.not. sheet%has(trim(groups(i)%name))) call add_record(sheet, empty_record(i, 0_ik))
      end do
      do i = 1, sheet%length
         associate (values => sheet%records(i)%values)
            do item = lbound(values, 1), ubound(values, 1)
               if (values(item)%is_set) cycle
               if (applies(parameters(item)%scenes, has_fluid)) then
                  call default_value(parameters(item), values(item))
               end if
            end do
         end associate
      end do
      call name_by_file(sheet, error)
      if (.not. allocated(error)) call refuse_foreign(sheet, error)
      if (allocated(error)) return
      enabled = sheet%records(sheet%find("growth"))%value("enabled")
      is_needed = .false.
      is_needed(need_always) = .true.
      is_needed(need_fluid) = has_fluid
      is_needed(need_growth) = enabled%flag
      do i = 1, sheet%length
         call refuse_missing(sheet, i, is_needed, error)
         if (allocated(error)) return
      end do
   end subroutine complete_sheet

   !> Name a scene without a name after its file.
   pure subroutine name_by_file(sheet, error)
      type(sheet_t), intent(inout) :: sheet
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: stem
      integer :: dot, record

      record = sheet%find("scene")
      if (sheet%records(record)%is_set("name")) return
      stem = sheet%path(index(sheet%path, "/", back=.true.) + 1:)
      dot = index(stem, ".", back=.true.)
      if (dot > 1) stem = stem(1:dot - 1)
      if (len(stem) > name_length .or. .not. is_identifier(stem)) then
         call refuse(error, sheet, record, "name", "is missing, and '"//shortened(stem)// &
                     "', as the file is called, cannot serve for it: a name has at most 64 "// &
                     "letters, digits, '_', '-' and '.'")
         return
      end if
      associate (value => sheet%records(record)%values(parameter_index(group_index("scene"), &
                                                                       "name")))
         value%is_set = .true.
         value%text = stem
      end associate
   end subroutine name_by_file

   !> Volumes per time become rates per metre of thickness.
   pure subroutine divide_by_thickness(sheet, assumed)
      type(sheet_t), intent(inout) :: sheet
      logical, intent(out) :: assumed  !< a thickness that the file does not give
      type(value_t) :: thickness
      integer :: i, item

      thickness = sheet%records(sheet%find("scene"))%value("thickness")
      assumed = .false.
      do i = 1, sheet%length
         associate (values => sheet%records(i)%values)
            do item = lbound(values, 1), ubound(values, 1)
               if (.not. values(item)%per_thickness) cycle
               values(item)%reals = values(item)%reals/thickness%reals(1)
               values(item)%per_thickness = .false.
               assumed = .not. thickness%line > 0
            end do
         end associate
      end do
   end subroutine divide_by_thickness

   !> Refuse groups and names of scenes with a fluid in one without, and the reverse.
   pure subroutine refuse_foreign(sheet, error)
      type(sheet_t), intent(in) :: sheet
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: reason
      logical :: has_fluid
      integer :: i, item

      has_fluid = sheet%has("fluid")
      reason = "needs a fluid, but the group &fluid is missing"
      if (has_fluid) reason = "is for mechanics-only scenes, but this one has the group &fluid"
      do i = 1, sheet%length
         associate (record => sheet%records(i))
            if (.not. applies(groups(record%group)%scenes, has_fluid)) then
               call refuse(error, sheet, i, "", reason)
               return
            end if
            do item = lbound(record%values, 1), ubound(record%values, 1)
               if (record%values(item)%line == 0) cycle
               if (applies(parameters(item)%scenes, has_fluid)) cycle
               call refuse(error, sheet, i, trim(parameters(item)%name), reason)
               return
            end do
         end associate
      end do
   end subroutine refuse_foreign

   !> Refuse a group that lacks a value which this scene needs.
   pure subroutine refuse_missing(sheet, record, is_needed, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record  !< index into sheet%records
      logical, intent(in) :: is_needed(0:)  !< in this scene, by the need of a parameter
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: advice
      integer :: item

      associate (group => groups(sheet%records(record)%group), given => sheet%records(record))
         if (.not. applies(group%scenes, sheet%has("fluid"))) return
         do item = lbound(given%values, 1), ubound(given%values, 1)
            if (given%values(item)%is_set) cycle
            if (parameters(item)%need == need_choice) then
               if (.not. given%suits(item)) cycle
            else if (.not. is_needed(parameters(item)%need)) then
               cycle
            end if
            advice = ""
            if (parameters(item)%need == need_growth) advice = "; "//advice_on_growth(sheet)
            if (given%line == 0) then
               call raise_error(error, "", sheet%path//": group &"//trim(group%name)// &
                                " is missing, and with it "//described(item)//advice// &
                                " (see docs/input.md)")
            else
               call refuse(error, sheet, record, "", described(item)//", is missing"//advice)
            end if
            return
         end do
      end associate
   end subroutine refuse_missing

   !> What a scene without a toughness may begin with, and what else its growth lacks.
   pure function advice_on_growth(sheet) result(advice)
      type(sheet_t), intent(in) :: sheet
      character(len=:), allocatable :: advice
      type(value_t) :: damping

      advice = "rock has 0.5e6 to 2.5e6, so begin with toughness = 1.5e6"
      if (.not. sheet%has("fracture")) advice = advice//"; growth needs a &fracture too"
      damping = sheet%records(sheet%find("material"))%value("radiation_damping")
      if (.not. damping%line > 0) return
      if (damping%reals(1) > 0.0_rk) advice = advice//"; radiation_damping must be omitted with it"
   end function advice_on_growth

   !> Name, unit and reason of a needed parameter.
   pure function described(item) result(words)
      integer, intent(in) :: item  !< index into parameters
      character(len=:), allocatable :: words
      character(len=*), parameter :: reason(need_always:need_growth) = [character(len=31) :: &
                                                                        "which is always needed", &
                                                                "which a scene with &fluid needs", &
                                                                        "which growth needs"]

      associate (parameter => parameters(item))
         words = trim(parameter%name)
         if (parameter%unit /= "-") words = words//" ["//trim(parameter%unit)//"]"
         if (parameter%need == need_choice) then
            words = words//", which the "//choice_name(parameter)//" '"// &
                    choice_value(parameter)//"' needs"
         else
            words = words//", "//trim(reason(parameter%need))
         end if
      end associate
   end function described

   !> Set values that are not given to their defaults, which depend on other values.
   pure subroutine resolve_defaults(scene)
      type(scene_t), intent(inout) :: scene
      integer :: i

      if (.not. scene%has_fluid()) then  ! the load programme lasts one unit of time
         scene%time%end = 1.0_rk
         scene%time%step = 1.0_rk/real(scene%load%steps, rk)
      end if
      associate (load => scene%load)
         if (allocated(load%factors)) load%to = load%factors(size(load%factors))
         if (load%control == "") load%control = merge("dead  ", "length", allocated(load%factors))
      end associate
      associate (length => scene%output%out_of_plane_length)
         if (.not. length > 0.0_rk) length = scene%thickness
      end associate
      call choose_steps(scene)
      if (scene%has_fluid() .and. .not. scene%fluid%vapour_pressure > -huge(1.0_rk)) then
         if (is_pressed(scene)) scene%fluid%vapour_pressure = 0.0_rk
      end if
      if (scene%has_fluid() .and. has_law(scene%fluid)) then
         associate (reference => scene%fluid%reference_pressure)
            if (.not. reference > -huge(1.0_rk)) reference = scene%initial%pressure
         end associate
      end if
      call choose_sizes(scene)
      associate (d => scene%discretization)
         if (.not. scene%has_fluid()) then
            call default(d%rosette_radius, d%size_fracture)
            call default(d%rosette_radius, d%size_boundary)  ! without fractures
         end if
      end associate
      if (allocated(scene%injections)) call name_wells(scene%injections)
      do i = 1, size(scene%fractures)
         if (scene%fractures(i)%law /= "slip") cycle
         call default(scene%fractures(i)%slip_taper, 0.5_rk*scene%fractures(i)%length())
      end do
   end subroutine resolve_defaults

   !> Name wells without a name after their number. Wells with stages start with the first; a single
   !! rate or pressure is that of all stages.
   pure subroutine name_wells(wells)
      type(injection_t), intent(inout) :: wells(:)
      integer(ik) :: i

      do i = 1, size(wells, kind=ik)
         if (wells(i)%name == "") wells(i)%name = "well_"//integer_text(i)
         if (.not. allocated(wells(i)%time)) cycle
         wells(i)%start = wells(i)%time(1)
         call repeat_value(wells(i)%rate, size(wells(i)%time))
         call repeat_value(wells(i)%pressure, size(wells(i)%time))
         call repeat_value(wells(i)%temperature, size(wells(i)%time))
      end do
   end subroutine name_wells

   !> Extend a list of one value to n equal ones.
   pure subroutine repeat_value(list, n)
      real(rk), allocatable, intent(inout) :: list(:)  !< [any unit]
      integer, intent(in) :: n

      if (.not. allocated(list)) return
      if (size(list) == 1) list = spread(list(1), 1, n)
   end subroutine repeat_value

   !> Set the defaults of the tolerances, the smallest step and the interval of written fields,
   !! which without a step is a hundredth of the run.
   pure subroutine choose_steps(scene)
      type(scene_t), intent(inout) :: scene
      real(rk), parameter :: usual_tolerance = 0.01_rk
      logical :: is_free

      associate (time => scene%time)
         is_free = .not. time%step > 0.0_rk
         if (is_free .or. (scene%has_fluid() .and. scene%growth%enabled .and. &
                           scene%growth%law == "equilibrium")) then
            call default(time%tolerance, usual_tolerance)
         end if
         if (time%tolerance > 0.0_rk) call default(time%first, first_share*time%end)
         call default(time%smallest_factor, merge(1.0e-9_rk, 1.0e-6_rk, is_free))
         call default(scene%adaptive%tolerance, merge(0.5_rk, 0.01_rk, scene%has_fluid()))
         call default(scene%output%interval, merge(0.01_rk*time%end, time%step, is_free))
      end associate
   end subroutine choose_steps

   !> Stresses and pressures are those of a state in situ, and not changes of an unknown state: only
   !! then a pressure of 0 is vacuum.
   pure logical function is_pressed(scene)
      type(scene_t), intent(in) :: scene

      is_pressed = scene%initial%pressure > 0.0_rk .or. scene%fluid%density > 0.0_rk &
                   .or. any(scene%in_situ%stress(1:2) < 0.0_rk) &
                   .or. any(abs(scene%in_situ%per_y) > 0.0_rk)
      associate (side => scene%sides)
         is_pressed = is_pressed .or. any(normal_tractions(side) < 0.0_rk) &
                      .or. any(side%pressure_given .and. side%pressure > 0.0_rk)
      end associate
      if (.not. allocated(scene%parts)) return
      associate (side => scene%parts)
         is_pressed = is_pressed .or. any(side%normal_traction < 0.0_rk) &
                      .or. any(side%pressure_given .and. side%pressure > 0.0_rk)
      end associate
   end function is_pressed

   !> Set a value that is not positive, and so not given, to a default.
   pure subroutine default(value, otherwise)
      real(rk), intent(inout) :: value  !< [any unit]
      real(rk), intent(in) :: otherwise  !< [unit of value]

      if (.not. value > 0.0_rk) value = otherwise
   end subroutine default

end module scene_namelist
