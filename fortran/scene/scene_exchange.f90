!> Transfers values between a sheet, the contents of a file, and a scene, which the program uses.
!!
!! One list serves both directions, so that reading and writing are always consistent.
module scene_exchange
   use base_kinds, only: ik, radians, rk
   use base_plane, only: nearest_place, norm2
   use base_tolerances, only: round_off
   use scene_exchange_values, only: exchange, exchange_domain, exchange_material, exchange_part, &
                                    exchange_point_load, exchange_region, exchange_restraint, &
                                    exchange_side, exchange_temperature, exchange_word, &
                                    set_names, set_text, to_degrees
   use scene_parameter_table, only: parameters
   use scene_parameters, only: applies, groups, side_names
   use scene_sheet, only: add_record, empty_record, record_t, sheet_t
   use scene_types, only: discretization_t, fluid_t, fracture_t, growth_t, injection_t, &
                          name_length, scene_t
   use scene_values, only: value_t
   implicit none(type, external)
   private

   public :: nearest_fracture, scene_to_sheet, sheet_to_scene

   character(len=*), parameter :: nearest_fracture = "nearest"  !< in place of a fracture's name

   real(rk), parameter :: unlimited = huge(1.0_rk)

contains

   !> Fill a scene from a sheet that has passed the checks of scene_parse.
   pure subroutine sheet_to_scene(sheet, scene)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(out) :: scene
      type(record_t) :: record
      type(value_t) :: value
      integer :: e, f, i, n(size(groups))

      allocate (scene%fractures(count_of(sheet, "fracture")))
      allocate (scene%injections(count_of(sheet, "injection")))
      allocate (scene%probes(count_of(sheet, "probe")))
      allocate (scene%restraints(count_of(sheet, "restraint")))
      allocate (scene%point_loads(count_of(sheet, "point_load")))
      value = sheet%records(sheet%find("domain"))%value("shape")
      allocate (scene%parts(merge(0, count_of(sheet, "side"), value%text == "rectangle")))
      if (sheet%has("region")) then
         record = sheet%records(sheet%find("material"))
         record%reading = .true.
         call exchange_group(record, scene, 1)
         allocate (scene%regions(count_of(sheet, "region")))
         scene%regions%material = scene%material
      end if
      n = 0
      do i = 1, sheet%length
         record = sheet%records(i)
         record%reading = .true.
         n(record%group) = n(record%group) + 1
         call exchange_group(record, scene, n(record%group))
      end do
      do i = 1, size(scene%injections)  ! fractures may follow the wells in the file
         value = sheet%records(sheet%find("injection", i))%value("fracture")
         if (.not. value%is_set) cycle
         associate (well => scene%injections(i))
            if (value%names(1) == nearest_fracture .and. well%at_point .and. &
                all(scene%fractures%name /= nearest_fracture)) then
               call place_at_nearest(scene%fractures, well)
            end if
            do e = size(value%names), 1, -1
               f = findloc(scene%fractures%name == value%names(e), .true., dim=1, back=.true.)
               if (f == 0) cycle
               well%fracture = int(f, ik)
               if (allocated(well%entries)) well%entries(e)%fracture = int(f, ik)
            end do
         end associate
      end do
      scene%growth%intensities = scene%growth%intensities .or. scene%growth%enabled
   end subroutine sheet_to_scene

   !> Place a well at the point of a fracture that is nearest to its own.
   pure subroutine place_at_nearest(fractures, well)
      type(fracture_t), intent(in) :: fractures(:)
      type(injection_t), intent(inout) :: well
      real(rk) :: distance(size(fractures)), place(2, size(fractures)), point(2)
      integer :: f, k

      point = [well%x, well%y]
      distance = huge(1.0_rk)
      do f = 1, size(fractures)
         associate (x => fractures(f)%x, y => fractures(f)%y)
            do k = 2, min(size(x), size(y))  ! unequal ones are refused later
               associate (near => nearest_place(point, reshape([x(k - 1), y(k - 1), x(k), y(k)], &
                                                               [2, 2])))
                  if (.not. norm2(near - point) < distance(f)) cycle
                  distance(f) = norm2(near - point)
                  place(:, f) = near
               end associate
            end do
         end associate
      end do
      f = minloc(distance, dim=1)
      well%fracture = int(f, ik)
      well%x = place(1, f)
      well%y = place(2, f)
      well%moved = distance(f)
      do k = 1, size(fractures)
         if (.not. norm2(place(:, k) - place(:, f)) > round_off*distance(f)) cycle
         well%next_distance = min(well%next_distance, distance(k))
      end do
      if (allocated(well%entries)) then
         well%entries%fracture = well%fracture
         well%entries%x = well%x
         well%entries%y = well%y
      end if
   end subroutine place_at_nearest

   !> A sheet with all values of a scene.
   pure subroutine scene_to_sheet(scene, sheet)
      type(scene_t), intent(in) :: scene
      type(sheet_t), intent(out) :: sheet
      type(scene_t) :: source
      type(record_t) :: record
      integer :: group, i

      source = scene  ! the argument of exchange_group is intent(inout)
      sheet%path = ""
      do group = 1, size(groups)
         if (.not. applies(groups(group)%scenes, source%has_fluid())) cycle
         do i = 1, count_in(scene, groups(group)%name)
            record = empty_record(group, 0_ik)
            call exchange_group(record, source, i)
            if (groups(group)%name == "fracture" .or. .not. groups(group)%repeated) then
               call drop_foreign(record, source%has_fluid())
            end if
            call add_record(sheet, record)
         end do
      end do
   end subroutine scene_to_sheet

   !> Number of groups of a name in a scene.
   pure integer function count_in(scene, group) result(n)
      type(scene_t), intent(in) :: scene
      character(len=*), intent(in) :: group

      n = 0
      select case (group)
      case ("fracture")
         n = size(scene%fractures)
      case ("region")
         if (allocated(scene%regions)) n = size(scene%regions)
      case ("side")
         n = merge(size(scene%sides), scene%n_parts(), scene%domain%shape == "rectangle")
      case ("restraint")
         if (allocated(scene%restraints)) n = size(scene%restraints)
      case ("point_load")
         if (allocated(scene%point_loads)) n = size(scene%point_loads)
      case ("injection")
         n = size(scene%injections)
      case ("probe")
         n = size(scene%probes)
      case ("fluid")
         n = merge(1, 0, scene%has_fluid())
      case ("heat")
         n = merge(1, 0, allocated(scene%heat))
      case ("temperature")
         n = merge(1, 0, allocated(scene%temperature))
      case default
         n = 1
      end select
   end function count_in

   !> Transfer the i-th group of a name.
   pure subroutine exchange_group(record, scene, i)
      type(record_t), intent(inout) :: record
      type(scene_t), intent(inout) :: scene
      integer, intent(in) :: i
      type(value_t) :: name
      character(len=name_length), allocatable :: names(:)
      integer :: side

      select case (groups(record%group)%name)
      case ("fracture")
         call exchange_fracture(record, scene%fractures(i))
      case ("region")
         call exchange_region(record, scene%regions(i))
      case ("side")
         if (scene%n_parts() > 0) then
            call exchange_part(record, scene%parts(i))
            return
         end if
         if (.not. record%reading) call set_text(record, "name", trim(side_names(i)))
         name = record%value("name")
         side = findloc(side_names == name%text, .true., dim=1)
         call exchange_side(record, scene%sides(side))
      case ("restraint")
         if (record%reading) scene%restraints(i)%displacement_given = &
            [record%is_set("x_displacement"), record%is_set("y_displacement")]
         call exchange_restraint(record, scene%restraints(i))
      case ("point_load")
         call exchange_point_load(record, scene%point_loads(i))
      case ("injection")
         associate (well => scene%injections(i))
            if (record%reading) well%at_point = record%is_set("x")
            if (.not. record%reading .and. well%fracture > 0) then
               names = [scene%fractures(well%fracture)%name]
               if (allocated(well%entries)) names = scene%fractures(well%entries%fracture)%name
               call set_names(record, "fracture", names)
            end if
            call exchange_injection(record, well)
         end associate
      case ("probe")
         call exchange(record, "name", scene%probes(i)%name)
         call exchange(record, "x", scene%probes(i)%x)
         call exchange(record, "y", scene%probes(i)%y)
      case default
         call exchange_single(record, scene)
      end select
   end subroutine exchange_group

   !> Unset the names that a scene with or without a fluid, or a group with its choices, must not
   !! give, and names whose partner (`with`) is not set.
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

   !> Transfer a group that a scene has once.
   pure subroutine exchange_single(record, scene)
      type(record_t), intent(inout) :: record
      type(scene_t), intent(inout) :: scene

      select case (groups(record%group)%name)
      case ("scene")
         call exchange(record, "name", scene%name)
         call exchange(record, "title", scene%title)
         call exchange(record, "thickness", scene%thickness)
      case ("domain")
         call exchange_domain(record, scene%domain)
      case ("material")
         call exchange_material(record, scene%material)
      case ("fluid")
         call exchange_fluid(record, scene%fluid)
      case ("initial")
         call exchange(record, "fracture_pressure", scene%initial%fracture_pressure)
         call exchange(record, "pressure", scene%initial%pressure)
      case ("heat")
         if (record%reading) allocate (scene%heat)
         call exchange(record, "temperature", scene%heat%temperature)
         call exchange(record, "temperature_per_y", scene%heat%temperature_per_y)
         call exchange(record, "y_datum", scene%heat%y_datum)
         call exchange(record, "tolerance", scene%heat%tolerance)
         call exchange(record, "source_x", scene%heat%source_x)
         call exchange(record, "source_y", scene%heat%source_y)
         call exchange(record, "source_power", scene%heat%source_power)
         call exchange(record, "source_cell_size", scene%heat%source_cell_size, nothing=0.0_rk)
      case ("temperature")
         if (record%reading) allocate (scene%temperature)
         call exchange_temperature(record, scene%temperature)
      case ("time")
         call exchange(record, "end", scene%time%end)
         call exchange(record, "step", scene%time%step, nothing=0.0_rk)
         call exchange(record, "tolerance", scene%time%tolerance)
         call exchange(record, "first", scene%time%first, nothing=0.0_rk)
         call exchange(record, "growth_factor", scene%time%share_after_growth)
         call exchange(record, "smallest_factor", scene%time%smallest_factor)
         call exchange(record, "replay", scene%time%replay)
      case ("adaptive")
         call exchange(record, "enabled", scene%adaptive%enabled)
         call exchange(record, "tolerance", scene%adaptive%tolerance)
         call exchange(record, "passes", scene%adaptive%passes)
      case ("in_situ")
         call exchange(record, "sxx", scene%in_situ%stress(1))
         call exchange(record, "syy", scene%in_situ%stress(2))
         call exchange(record, "sxy", scene%in_situ%stress(3))
         call exchange(record, "sxx_per_y", scene%in_situ%per_y(1))
         call exchange(record, "syy_per_y", scene%in_situ%per_y(2))
         call exchange(record, "y_datum", scene%in_situ%y_datum)
      case ("gravity")
         call exchange(record, "x", scene%gravity(1))
         call exchange(record, "y", scene%gravity(2))
      case ("load")
         call exchange(record, "from", scene%load%from)
         if (record%reading .or. .not. allocated(scene%load%factors)) then
            call exchange(record, "to", scene%load%to)
         end if
         call exchange(record, "factors", scene%load%factors)
         call exchange(record, "steps", scene%load%steps)
         call exchange(record, "control", scene%load%control)
      case ("coarse", "fe", "fine")
         call exchange_discretization(record, scene%discretization)
      case ("growth")
         call exchange_growth(record, scene%growth)
      case ("output")
         call exchange(record, "vtu", scene%output%vtu)
         call exchange(record, "windows", scene%output%windows)
         call exchange(record, "interval", scene%output%interval, nothing=0.0_rk)
         call exchange(record, "growth_states", scene%output%growth_states)
         call exchange(record, "stimulated_jump", scene%output%stimulated_jump)
         ! 0: that of the body, see resolve_defaults.
         if (record%reading) scene%output%out_of_plane_length = 0.0_rk
         call exchange(record, "out_of_plane_length", scene%output%out_of_plane_length)
         call exchange(record, "seismic_slip_rate", scene%output%seismic_slip_rate)
         call exchange(record, "checkpoint", scene%output%checkpoint)
         call exchange(record, "checkpoint_states", scene%output%checkpoint_states)
      case default  ! a repeated group, see exchange_group
      end select
   end subroutine exchange_single

   !> Group &fluid.
   pure subroutine exchange_fluid(record, fluid)
      type(record_t), intent(inout) :: record
      type(fluid_t), intent(inout) :: fluid

      call exchange(record, "compressibility", fluid%compressibility)
      call exchange(record, "viscosity", fluid%viscosity)
      call exchange(record, "density", fluid%density, nothing=0.0_rk)
      call exchange(record, "heat_capacity", fluid%heat_capacity, nothing=0.0_rk)
      call exchange(record, "heat_expansion", fluid%heat_expansion, nothing=0.0_rk)
      call exchange(record, "vapour_pressure", fluid%vapour_pressure, nothing=-unlimited)
      call exchange(record, "viscosity_law", fluid%viscosity_law)
      call exchange(record, "viscosity_exponent", fluid%viscosity_exponent)
      call exchange(record, "density_law", fluid%density_law)
      call exchange(record, "reference_pressure", fluid%reference_pressure, nothing=-unlimited)
      call exchange(record, "table_pressure", fluid%table_pressure)
      call exchange(record, "table_viscosity", fluid%table_viscosity)
      call exchange(record, "table_density", fluid%table_density)
      call exchange(record, "table_temperature", fluid%table_temperature)
      call exchange(record, "viscosity_at", fluid%viscosity_at)
   end subroutine exchange_fluid

   !> Group &fracture.
   pure subroutine exchange_fracture(record, fracture)
      type(record_t), intent(inout) :: record
      type(fracture_t), intent(inout) :: fracture
      real(rk) :: dilation_deg

      call exchange(record, "name", fracture%name)
      call exchange(record, "x", fracture%x)
      call exchange(record, "y", fracture%y)
      call exchange(record, "law", fracture%law)
      call exchange(record, "slip", fracture%slip)
      call exchange(record, "slip_taper", fracture%slip_taper, nothing=0.0_rk)
      call exchange(record, "friction", fracture%friction)
      call exchange(record, "friction_residual", fracture%friction_residual)
      call exchange(record, "weakening_slip", fracture%weakening_slip, nothing=0.0_rk)
      call exchange(record, "dilation_slip", fracture%dilation_slip, nothing=unlimited)
      call exchange(record, "normal_stiffness", fracture%normal_stiffness, nothing=0.0_rk)
      call exchange(record, "closure", fracture%closure, nothing=0.0_rk)
      call exchange(record, "cohesion", fracture%cohesion, nothing=0.0_rk)
      call exchange(record, "tensile_strength", fracture%tensile_strength, nothing=0.0_rk)
      call exchange(record, "opening_weakening", fracture%opening_weakening, nothing=0.0_rk)
      call exchange(record, "toughness", fracture%toughness, nothing=huge(1.0_rk))
      call exchange(record, "skin", fracture%skin, nothing=0.0_rk)
      dilation_deg = to_degrees(fracture%dilation)
      call exchange(record, "dilation_deg", dilation_deg)
      fracture%dilation = dilation_deg*radians
      call exchange(record, "held_closed", fracture%held_closed)
      call exchange(record, "face_pressure", fracture%face_pressure)
      call exchange(record, "aperture", fracture%aperture, nothing=0.0_rk)
      call exchange(record, "cell_size", fracture%cell_size, nothing=0.0_rk)
      call exchange(record, "window", fracture%window, nothing=0.0_rk)
      call exchange(record, "increment", fracture%increment, nothing=0.0_rk)
   end subroutine exchange_fracture

   !> Group &injection without the name of its fracture, for which the scene has an index.
   pure subroutine exchange_injection(record, injection)
      type(record_t), intent(inout) :: record
      type(injection_t), intent(inout) :: injection

      call exchange(record, "name", injection%name)
      call exchange(record, "time", injection%time)
      call exchange(record, "rate", injection%rate)
      call exchange(record, "pressure", injection%pressure)
      call exchange(record, "temperature", injection%temperature)
      if (record%reading .or. .not. allocated(injection%time)) then
         call exchange(record, "start", injection%start)
      end if
      call exchange(record, "end", injection%end, nothing=unlimited)
      call exchange(record, "storage", injection%storage)
      call exchange(record, "friction", injection%friction)
      call exchange(record, "turbulence", injection%turbulence)
      call exchange_entries(record, injection)
      if (injection%fracture == 0) call exchange(record, "radius", injection%radius)
   end subroutine exchange_injection

   !> Points and losses of the entries of a well, without their fractures.
   pure subroutine exchange_entries(record, injection)
      type(record_t), intent(inout) :: record
      type(injection_t), intent(inout) :: injection
      real(rk), allocatable :: loss(:), x(:), y(:)
      type(value_t) :: fracture
      integer :: n

      if (.not. record%reading) then
         x = [injection%x]
         y = [injection%y]
         if (allocated(injection%entries)) then
            x = injection%entries%x
            y = injection%entries%y
            if (any(injection%entries%loss > 0.0_rk)) loss = injection%entries%loss
         end if
      end if
      if (injection%at_point) then
         call exchange(record, "x", x)
         call exchange(record, "y", y)
      end if
      call exchange(record, "entry_loss", loss)
      if (.not. record%reading) return
      if (injection%at_point) then
         injection%x = x(1)
         injection%y = y(1)
      end if
      fracture = record%value("fracture")
      n = 1
      if (fracture%is_set) n = size(fracture%names)
      if (.not. allocated(loss)) loss = [0.0_rk]
      if (n == 1 .and. .not. loss(1) > 0.0_rk) return
      allocate (injection%entries(n))
      injection%entries%loss = loss(1)
      if (size(loss) == n) injection%entries%loss = loss
      if (.not. injection%at_point) return
      injection%entries%x = x
      injection%entries%y = y
   end subroutine exchange_entries

   !> Groups &coarse, &fe and &fine.
   pure subroutine exchange_discretization(record, discretization)
      type(record_t), intent(inout) :: record
      type(discretization_t), intent(inout) :: discretization

      select case (groups(record%group)%name)
      case ("coarse")
         call exchange(record, "size_fracture", discretization%size_fracture, nothing=0.0_rk)
         call exchange(record, "size_boundary", discretization%size_boundary)
         call exchange(record, "newton_max", discretization%newton_max)
         call exchange(record, "newton_tolerance", discretization%newton_tolerance)
         call exchange(record, "condensation", discretization%condensation)
         call exchange(record, "layers", discretization%layers)
      case ("fe")
         call exchange(record, "size_fracture", discretization%size_fracture, nothing=0.0_rk)
         call exchange(record, "size_boundary", discretization%size_boundary)
         call exchange(record, "rosette_radius", discretization%rosette_radius, nothing=0.0_rk)
         call exchange(record, "rosette_sectors", discretization%rosette_sectors)
         call exchange(record, "element", discretization%element)
      case default  ! fine
         call exchange(record, "window", discretization%window, nothing=0.0_rk)
         call exchange_word(record, "window", "body", discretization%window_is_body)
         call exchange(record, "size_ratio", discretization%fine_ratio)
         call exchange(record, "rosette_sectors", discretization%rosette_sectors)
         call exchange(record, "face_condition", discretization%face_condition)
      end select
   end subroutine exchange_discretization

   !> Group &growth.
   pure subroutine exchange_growth(record, growth)
      type(record_t), intent(inout) :: record
      type(growth_t), intent(inout) :: growth

      call exchange(record, "enabled", growth%enabled)
      if (record%reading) growth%enabled_assumed = record%line > 0 .and. &
                              .not. (record%is_given("enabled") .or. record%is_given("intensities"))
      call exchange(record, "intensities", growth%intensities)
      call exchange(record, "law", growth%law)
      call exchange(record, "increment", growth%increment, nothing=0.0_rk)
      call exchange(record, "increments", growth%increments)
      call exchange(record, "exponent", growth%exponent)
      call exchange(record, "threshold", growth%threshold)
      call exchange(record, "new_aperture", growth%new_aperture)
      call exchange(record, "new_volume", growth%new_volume)
      call exchange(record, "stop_gain", growth%stop_gain, nothing=unlimited)
   end subroutine exchange_growth

   !> Number of groups of a name in a sheet.
   pure integer function count_of(sheet, name) result(n)
      type(sheet_t), intent(in) :: sheet
      character(len=*), intent(in) :: name
      integer :: i

      n = count([(groups(sheet%records(i)%group)%name == name, i=1, sheet%length)])
   end function count_of

end module scene_exchange
