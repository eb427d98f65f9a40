!> Carries values between a sheet, which is what a file says, and a scene, which the program uses.
!>
!> One list serves both directions, so that what is read and what is written cannot drift apart.
module scene_exchange
   use base_kinds, only: ik, radians, rk
   use scene_exchange_values, only: exchange, exchange_material, exchange_part, &
                                    exchange_point_load, exchange_region, exchange_restraint, &
                                    exchange_side, exchange_word, set_text, to_degrees
   use scene_parameters, only: applies, groups, parameters, side_names
   use scene_sheet, only: add_record, empty_record, record_t, sheet_t
   use scene_types, only: discretization_t, domain_t, fracture_t, growth_t, injection_t, probe_t, &
                          scene_t
   use scene_values, only: value_t
   implicit none(type, external)
   private

   public :: scene_to_sheet, sheet_to_scene

   real(rk), parameter :: unlimited = huge(1.0_rk)

contains

   !> Fill a scene from a sheet that has passed the checks of scene_parse.
   pure subroutine sheet_to_scene(sheet, scene)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(out) :: scene
      type(record_t) :: record
      type(value_t) :: value
      integer :: i, n_fractures, n_injections, n_parts, n_point_loads, n_probes, n_regions
      integer :: n_restraints, side
      logical :: is_rectangle

      allocate (scene%fractures(count_of(sheet, "fracture")))
      allocate (scene%injections(count_of(sheet, "injection")))
      allocate (scene%probes(count_of(sheet, "probe")))
      allocate (scene%restraints(count_of(sheet, "restraint")))
      allocate (scene%point_loads(count_of(sheet, "point_load")))
      if (sheet%has("region")) allocate (scene%regions(count_of(sheet, "region")))
      value = sheet%records(sheet%find("domain"))%value("shape")
      is_rectangle = value%text == "rectangle"
      allocate (scene%parts(merge(0, count_of(sheet, "side"), is_rectangle)))
      n_parts = 0
      n_fractures = 0
      n_injections = 0
      n_probes = 0
      n_regions = 0
      n_restraints = 0
      n_point_loads = 0
      do i = 1, sheet%length
         record = sheet%records(i)
         select case (groups(record%group)%name)
         case ("fracture")
            n_fractures = n_fractures + 1
            call exchange_fracture(record, scene%fractures(n_fractures), .true.)
         case ("region")
            n_regions = n_regions + 1
            call exchange_region(record, scene%regions(n_regions), .true.)
         case ("side")
            if (is_rectangle) then
               value = record%value("name")
               side = findloc(side_names == value%text, .true., dim=1)
               call exchange_side(record, scene%sides(side), .true.)
            else
               n_parts = n_parts + 1
               call exchange_part(record, scene%parts(n_parts), .true.)
            end if
         case ("restraint")
            n_restraints = n_restraints + 1
            associate (restraint => scene%restraints(n_restraints))
               restraint%displacement_given = [record%is_set("x_displacement"), &
                                               record%is_set("y_displacement")]
               call exchange_restraint(record, restraint, .true.)
            end associate
         case ("point_load")
            n_point_loads = n_point_loads + 1
            call exchange_point_load(record, scene%point_loads(n_point_loads), .true.)
         case ("injection")
            n_injections = n_injections + 1
            scene%injections(n_injections)%at_point = record%is_set("x")
            call exchange_injection(record, scene%injections(n_injections), .true.)
         case ("probe")
            n_probes = n_probes + 1
            call exchange_probe(record, scene%probes(n_probes), .true.)
         case default
            call exchange_single(record, scene, .true.)
         end select
      end do
      do i = 1, size(scene%injections)  ! the fractures may come after the wells
         value = sheet%records(sheet%find("injection", i))%value("fracture")
         if (.not. value%is_set) cycle
         do n_fractures = 1, size(scene%fractures)
            if (scene%fractures(n_fractures)%name == value%text) then
               scene%injections(i)%fracture = int(n_fractures, ik)
            end if
         end do
      end do
      scene%growth%intensities = scene%growth%intensities .or. scene%growth%enabled
   end subroutine sheet_to_scene

   !> A sheet that says all there is in a scene.
   pure subroutine scene_to_sheet(scene, sheet)
      type(scene_t), intent(in) :: scene
      type(sheet_t), intent(out) :: sheet
      type(scene_t) :: source
      type(record_t) :: record
      integer :: group, i

      source = scene  ! exchange takes what it may write to
      if (.not. allocated(source%restraints)) allocate (source%restraints(0))
      if (.not. allocated(source%point_loads)) allocate (source%point_loads(0))
      if (.not. allocated(source%parts)) allocate (source%parts(0))
      sheet%path = ""
      do group = 1, size(groups)
         if (.not. applies(groups(group)%scenes, source%has_fluid())) cycle
         select case (groups(group)%name)
         case ("fracture")
            do i = 1, size(source%fractures)
               record = empty_record(group, 0_ik)
               call exchange_fracture(record, source%fractures(i), .false.)
               call drop_foreign(record, source%has_fluid())
               call add_record(sheet, record)
            end do
         case ("region")
            if (.not. allocated(source%regions)) cycle
            do i = 1, size(source%regions)
               record = empty_record(group, 0_ik)
               call exchange_region(record, source%regions(i), .false.)
               call add_record(sheet, record)
            end do
         case ("side")
            do i = 1, size(source%parts)
               record = empty_record(group, 0_ik)
               call exchange_part(record, source%parts(i), .false.)
               call add_record(sheet, record)
            end do
            if (source%domain%shape /= "rectangle") cycle
            do i = 1, size(source%sides)
               record = empty_record(group, 0_ik)
               call set_text(record, "name", trim(side_names(i)))
               call exchange_side(record, source%sides(i), .false.)
               call add_record(sheet, record)
            end do
         case ("restraint")
            do i = 1, size(source%restraints)
               record = empty_record(group, 0_ik)
               call exchange_restraint(record, source%restraints(i), .false.)
               call add_record(sheet, record)
            end do
         case ("point_load")
            do i = 1, size(source%point_loads)
               record = empty_record(group, 0_ik)
               call exchange_point_load(record, source%point_loads(i), .false.)
               call add_record(sheet, record)
            end do
         case ("injection")
            do i = 1, size(source%injections)
               record = empty_record(group, 0_ik)
               if (source%injections(i)%fracture > 0) call set_text(record, "fracture", &
                  & trim(source%fractures(source%injections(i)%fracture)%name))
               call exchange_injection(record, source%injections(i), .false.)
               call add_record(sheet, record)
            end do
         case ("probe")
            do i = 1, size(source%probes)
               record = empty_record(group, 0_ik)
               call exchange_probe(record, source%probes(i), .false.)
               call add_record(sheet, record)
            end do
         case default
            if (groups(group)%name == "fluid" .and. .not. source%has_fluid()) cycle
            record = empty_record(group, 0_ik)
            call exchange_single(record, source, .false.)
            call drop_foreign(record, source%has_fluid())
            call add_record(sheet, record)
         end select
      end do
   end subroutine scene_to_sheet

   !> Leave out what a scene of this kind or a group with this choice must not give, and halves of
   !! pairs.
   pure subroutine drop_foreign(record, has_fluid)
      type(record_t), intent(inout) :: record
      logical, intent(in) :: has_fluid
      integer :: item

      do item = lbound(record%values, 1), ubound(record%values, 1)
         associate (rule => parameters(item), value => record%values(item))
            value%is_set = value%is_set .and. applies(rule%scenes, has_fluid) &
                           .and. record%suits(item)
            if (rule%with /= "") value%is_set = value%is_set .and. record%is_set(rule%with)
         end associate
      end do
   end subroutine drop_foreign

   !> The groups that a scene has once.
   pure subroutine exchange_single(record, scene, reading)
      type(record_t), intent(inout) :: record
      type(scene_t), intent(inout) :: scene
      logical, intent(in) :: reading

      select case (groups(record%group)%name)
      case ("scene")
         call exchange(record, "name", scene%name, reading)
         call exchange(record, "title", scene%title, reading)
      case ("domain")
         call exchange_domain(record, scene%domain, reading)
      case ("material")
         call exchange_material(record, scene%material, reading)
      case ("fluid")
         call exchange(record, "compressibility", scene%fluid%compressibility, reading)
         call exchange(record, "viscosity", scene%fluid%viscosity, reading)
         call exchange(record, "density", scene%fluid%density, reading, nothing=0.0_rk)
         call exchange(record, "vapour_pressure", scene%fluid%vapour_pressure, reading, &
                       nothing=-unlimited)
         call exchange(record, "viscosity_law", scene%fluid%viscosity_law, reading)
         call exchange(record, "viscosity_exponent", scene%fluid%viscosity_exponent, reading)
         call exchange(record, "density_law", scene%fluid%density_law, reading)
         call exchange(record, "reference_pressure", scene%fluid%reference_pressure, reading, &
                       nothing=-unlimited)
         call exchange_list(record, "table_pressure", scene%fluid%table_pressure, reading)
         call exchange_list(record, "table_viscosity", scene%fluid%table_viscosity, reading)
         call exchange_list(record, "table_density", scene%fluid%table_density, reading)
      case ("initial")
         call exchange(record, "fracture_pressure", scene%initial%fracture_pressure, reading)
         call exchange(record, "pressure", scene%initial%pressure, reading)
      case ("time")
         call exchange(record, "end", scene%time%end, reading)
         call exchange(record, "step", scene%time%step, reading, nothing=0.0_rk)
         call exchange(record, "tolerance", scene%time%tolerance, reading)
         call exchange(record, "growth_factor", scene%time%share_after_growth, reading)
         call exchange(record, "smallest_factor", scene%time%smallest_factor, reading)
      case ("adaptive")
         call exchange(record, "enabled", scene%adaptive%enabled, reading)
         call exchange(record, "tolerance", scene%adaptive%tolerance, reading)
         call exchange(record, "passes", scene%adaptive%passes, reading)
      case ("in_situ")
         call exchange(record, "sxx", scene%in_situ%stress(1), reading)
         call exchange(record, "syy", scene%in_situ%stress(2), reading)
         call exchange(record, "sxy", scene%in_situ%stress(3), reading)
         call exchange(record, "sxx_per_y", scene%in_situ%per_y(1), reading)
         call exchange(record, "syy_per_y", scene%in_situ%per_y(2), reading)
         call exchange(record, "y_datum", scene%in_situ%y_datum, reading)
      case ("gravity")
         call exchange(record, "x", scene%gravity(1), reading)
         call exchange(record, "y", scene%gravity(2), reading)
      case ("load")
         call exchange(record, "from", scene%load%from, reading)
         if (reading .or. .not. allocated(scene%load%factors)) then
            call exchange(record, "to", scene%load%to, reading)
         end if
         if (reading .or. allocated(scene%load%factors)) then
            call exchange(record, "factors", scene%load%factors, reading)
         end if
         call exchange(record, "steps", scene%load%steps, reading)
         call exchange(record, "control", scene%load%control, reading)
      case ("coarse", "fe", "fine")
         call exchange_discretization(record, scene%discretization, reading)
      case ("growth")
         call exchange_growth(record, scene%growth, reading)
      case ("output")
         call exchange(record, "vtu", scene%output%vtu, reading)
         call exchange(record, "interval", scene%output%interval, reading, nothing=0.0_rk)
         call exchange(record, "growth_states", scene%output%growth_states, reading)
         call exchange(record, "stimulated_jump", scene%output%stimulated_jump, reading)
         call exchange(record, "out_of_plane_length", scene%output%out_of_plane_length, reading)
         call exchange(record, "seismic_slip_rate", scene%output%seismic_slip_rate, reading)
      case default  ! the repeated groups
         return
      end select
   end subroutine exchange_single

   pure subroutine exchange_domain(record, domain, reading)
      type(record_t), intent(inout) :: record
      type(domain_t), intent(inout) :: domain
      logical, intent(in) :: reading

      call exchange(record, "shape", domain%shape, reading)
      select case (domain%shape)
      case ("disc")
         call exchange(record, "x_centre", domain%x_centre, reading)
         call exchange(record, "y_centre", domain%y_centre, reading)
         call exchange(record, "radius", domain%radius, reading)
         domain%x_min = domain%x_centre - domain%radius
         domain%x_max = domain%x_centre + domain%radius
         domain%y_min = domain%y_centre - domain%radius
         domain%y_max = domain%y_centre + domain%radius
      case ("polygon")
         call exchange(record, "x", domain%x, reading)
         call exchange(record, "y", domain%y, reading)
         domain%x_min = minval(domain%x)
         domain%x_max = maxval(domain%x)
         domain%y_min = minval(domain%y)
         domain%y_max = maxval(domain%y)
      case default
         call exchange(record, "x_min", domain%x_min, reading)
         call exchange(record, "x_max", domain%x_max, reading)
         call exchange(record, "y_min", domain%y_min, reading)
         call exchange(record, "y_max", domain%y_max, reading)
      end select
   end subroutine exchange_domain

   pure subroutine exchange_fracture(record, fracture, reading)
      type(record_t), intent(inout) :: record
      type(fracture_t), intent(inout) :: fracture
      logical, intent(in) :: reading
      real(rk) :: dilation_deg

      call exchange(record, "name", fracture%name, reading)
      call exchange(record, "x", fracture%x, reading)
      call exchange(record, "y", fracture%y, reading)
      call exchange(record, "law", fracture%law, reading)
      call exchange(record, "slip", fracture%slip, reading)
      call exchange(record, "slip_taper", fracture%slip_taper, reading, nothing=0.0_rk)
      call exchange(record, "friction", fracture%friction, reading)
      call exchange(record, "friction_residual", fracture%friction_residual, reading)
      call exchange(record, "weakening_slip", fracture%weakening_slip, reading, nothing=0.0_rk)
      call exchange(record, "dilation_slip", fracture%dilation_slip, reading, nothing=unlimited)
      call exchange(record, "normal_stiffness", fracture%normal_stiffness, reading, nothing=0.0_rk)
      call exchange(record, "closure", fracture%closure, reading, nothing=0.0_rk)
      call exchange(record, "cohesion", fracture%cohesion, reading, nothing=0.0_rk)
      call exchange(record, "tensile_strength", fracture%tensile_strength, reading, nothing=0.0_rk)
      call exchange(record, "opening_weakening", fracture%opening_weakening, reading, &
                    nothing=0.0_rk)
      call exchange(record, "toughness", fracture%toughness, reading, nothing=huge(1.0_rk))
      call exchange(record, "skin", fracture%skin, reading, nothing=0.0_rk)
      dilation_deg = to_degrees(fracture%dilation)
      call exchange(record, "dilation_deg", dilation_deg, reading)
      fracture%dilation = dilation_deg*radians
      call exchange(record, "held_closed", fracture%held_closed, reading)
      call exchange(record, "face_pressure", fracture%face_pressure, reading)
      call exchange(record, "aperture", fracture%aperture, reading, nothing=0.0_rk)
   end subroutine exchange_fracture

   !> Without the fracture, which the scene knows by index and the sheet by name.
   pure subroutine exchange_injection(record, injection, reading)
      type(record_t), intent(inout) :: record
      type(injection_t), intent(inout) :: injection
      logical, intent(in) :: reading

      call exchange(record, "name", injection%name, reading)
      call exchange_list(record, "time", injection%time, reading)
      call exchange_list(record, "rate", injection%rate, reading)
      call exchange_list(record, "pressure", injection%pressure, reading)
      if (reading .or. .not. allocated(injection%time)) then
         call exchange(record, "start", injection%start, reading)
      end if
      call exchange(record, "end", injection%end, reading, nothing=unlimited)
      call exchange(record, "storage", injection%storage, reading)
      call exchange(record, "friction", injection%friction, reading)
      call exchange(record, "turbulence", injection%turbulence, reading)
      if (injection%at_point) then
         call exchange(record, "x", injection%x, reading)
         call exchange(record, "y", injection%y, reading)
      end if
      if (injection%fracture == 0) call exchange(record, "radius", injection%radius, reading)
   end subroutine exchange_injection

   !> A list that may be absent.
   pure subroutine exchange_list(record, name, list, reading)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name
      real(rk), allocatable, intent(inout) :: list(:)  !< [unit of the name]
      logical, intent(in) :: reading

      if (reading .or. allocated(list)) call exchange(record, name, list, reading)
   end subroutine exchange_list

   pure subroutine exchange_discretization(record, discretization, reading)
      type(record_t), intent(inout) :: record
      type(discretization_t), intent(inout) :: discretization
      logical, intent(in) :: reading

      select case (groups(record%group)%name)
      case ("coarse")
         call exchange(record, "size_fracture", discretization%size_fracture, reading, &
                       nothing=0.0_rk)
         call exchange(record, "size_boundary", discretization%size_boundary, reading)
         call exchange(record, "newton_max", discretization%newton_max, reading)
         call exchange(record, "newton_tolerance", discretization%newton_tolerance, reading)
         call exchange(record, "condensation", discretization%condensation, reading)
      case ("fe")
         call exchange(record, "size_fracture", discretization%size_fracture, reading, &
                       nothing=0.0_rk)
         call exchange(record, "size_boundary", discretization%size_boundary, reading)
         call exchange(record, "rosette_radius", discretization%rosette_radius, reading, &
                       nothing=0.0_rk)
         call exchange(record, "rosette_sectors", discretization%rosette_sectors, reading)
         call exchange(record, "element", discretization%element, reading)
      case default  ! fine
         call exchange(record, "window", discretization%window, reading, nothing=0.0_rk)
         call exchange_word(record, "window", "body", discretization%window_is_body, reading)
         call exchange(record, "size_ratio", discretization%fine_ratio, reading)
         call exchange(record, "rosette_sectors", discretization%rosette_sectors, reading)
         call exchange(record, "face_condition", discretization%face_condition, reading)
      end select
   end subroutine exchange_discretization

   pure subroutine exchange_growth(record, growth, reading)
      type(record_t), intent(inout) :: record
      type(growth_t), intent(inout) :: growth
      logical, intent(in) :: reading

      call exchange(record, "enabled", growth%enabled, reading)
      call exchange(record, "intensities", growth%intensities, reading)
      call exchange(record, "law", growth%law, reading)
      call exchange(record, "increment", growth%increment, reading, nothing=0.0_rk)
      call exchange(record, "exponent", growth%exponent, reading)
      call exchange(record, "threshold", growth%threshold, reading)
      call exchange(record, "new_aperture", growth%new_aperture, reading)
      call exchange(record, "new_volume", growth%new_volume, reading)
      call exchange(record, "stop_gain", growth%stop_gain, reading, nothing=unlimited)
   end subroutine exchange_growth

   pure subroutine exchange_probe(record, probe, reading)
      type(record_t), intent(inout) :: record
      type(probe_t), intent(inout) :: probe
      logical, intent(in) :: reading

      call exchange(record, "name", probe%name, reading)
      call exchange(record, "x", probe%x, reading)
      call exchange(record, "y", probe%y, reading)
   end subroutine exchange_probe

   pure integer function count_of(sheet, name) result(n)
      type(sheet_t), intent(in) :: sheet
      character(len=*), intent(in) :: name
      integer :: i

      n = count([(groups(sheet%records(i)%group)%name == name, i=1, sheet%length)])
   end function count_of

end module scene_exchange
