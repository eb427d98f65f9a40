!> Transfers single values, the body, its rock, supports and loads between the groups of a sheet and
!! the components of a scene, in both directions.
module scene_exchange_values
   use base_kinds, only: ik, lk, radians, rk
   use scene_heat, only: temperature_t
   use scene_sheet, only: parameter_index, record_t
   use scene_sides, only: boundary_side_t, of_inflow, of_normal_traction, of_pressure, &
                          of_shear_traction, of_x_displacement, of_x_traction, of_y_displacement, &
                          of_y_traction, side_course_t, side_quantities
   use scene_types, only: boundary_part_t, domain_t, material_t, name_length, point_load_t, &
                          region_t, restraint_t
   use scene_values, only: value_t
   implicit none(type, external)
   private

   public :: exchange, exchange_domain, exchange_material, exchange_part, exchange_point_load
   public :: exchange_region, exchange_restraint, exchange_side, exchange_temperature, exchange_word
   public :: set_names, set_text, to_degrees

   !> Copy one value: if record%reading, from the sheet, where it is set, into the scene's
   !! component; else from the component into the sheet. A component that equals `nothing`, or a
   !! list that is not allocated, is not set in the sheet.
   interface exchange
      module procedure exchange_real
      module procedure exchange_reals
      module procedure exchange_wholes
      module procedure exchange_integer
      module procedure exchange_logical
      module procedure exchange_text
   end interface exchange

contains

   pure subroutine exchange_real(record, name, component, nothing)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name
      real(rk), intent(inout) :: component  !< [unit of the name]
      real(rk), intent(in), optional :: nothing  !< value of an absent name [unit of the name]

      associate (value => record%values(parameter_index(record%group, name)))
         if (record%reading) then
            if (value%is_set .and. .not. allocated(value%text)) component = value%reals(1)
         else
            value%is_set = .true.
            if (present(nothing)) value%is_set = .not. same_bits(component, nothing)
            value%reals = [component]
         end if
      end associate
   end subroutine exchange_real

   pure subroutine exchange_reals(record, name, component)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name
      real(rk), allocatable, intent(inout) :: component(:)  !< [unit of the name]

      associate (value => record%values(parameter_index(record%group, name)))
         if (record%reading) then
            if (value%is_set) component = value%reals
         else if (allocated(component)) then
            value%is_set = .true.
            value%reals = component
         end if
      end associate
   end subroutine exchange_reals

   pure subroutine exchange_wholes(record, name, component)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name
      integer(ik), allocatable, intent(inout) :: component(:)

      associate (value => record%values(parameter_index(record%group, name)))
         if (record%reading) then
            if (value%is_set) component = nint(value%reals, ik)
         else if (allocated(component)) then
            value%is_set = .true.
            value%reals = real(component, rk)
         end if
      end associate
   end subroutine exchange_wholes

   pure subroutine exchange_integer(record, name, component)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name
      integer(ik), intent(inout) :: component

      associate (value => record%values(parameter_index(record%group, name)))
         if (record%reading) then
            if (value%is_set) component = value%whole
         else
            value%is_set = .true.
            value%whole = component
         end if
      end associate
   end subroutine exchange_integer

   pure subroutine exchange_logical(record, name, component)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name
      logical, intent(inout) :: component

      associate (value => record%values(parameter_index(record%group, name)))
         if (record%reading) then
            if (value%is_set) component = value%flag
         else
            value%is_set = .true.
            value%flag = component
         end if
      end associate
   end subroutine exchange_logical

   pure subroutine exchange_text(record, name, component)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name
      ! allow(C072)
      character(len=*), intent(inout) :: component
      type(value_t) :: value

      if (record%reading) then
         value = record%value(name)
         if (value%is_set) component = value%text
      else
         call set_text(record, name, trim(component))
      end if
   end subroutine exchange_text

   !> Copy whether a name has a word instead of a number.
   pure subroutine exchange_word(record, name, word, is_word)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name, word
      logical, intent(inout) :: is_word

      associate (value => record%values(parameter_index(record%group, name)))
         if (.not. record%reading) then
            if (is_word) call set_text(record, name, word)
         else if (value%is_set .and. allocated(value%text)) then
            is_word = value%text == word
         end if
      end associate
   end subroutine exchange_word

   !> Set a text in a sheet.
   pure subroutine set_text(record, name, text)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name, text

      associate (value => record%values(parameter_index(record%group, name)))
         value%is_set = .true.
         value%text = text
      end associate
   end subroutine set_text

   !> Set a list of names in a sheet.
   pure subroutine set_names(record, name, names)
      type(record_t), intent(inout) :: record
      character(len=*), intent(in) :: name
      character(len=name_length), intent(in) :: names(:)

      call set_text(record, name, trim(names(size(names))))
      record%values(parameter_index(record%group, name))%names = names
   end subroutine set_names

   !> The simplest angle in degrees from which the same bits in radians follow.
   pure real(rk) function to_degrees(angle) result(degrees)
      real(rk), intent(in) :: angle  !< [rad]
      character(len=32) :: style, buffer
      real(rk) :: candidate
      integer :: n_digits, neighbour

      degrees = angle/radians
      do n_digits = 1, 17
         write (style, "(a,i0,a)") "(es32.", n_digits - 1, "e3)"
         write (buffer, style) angle/radians
         read (buffer, "(f32.0)") candidate
         if (same_bits(candidate*radians, angle)) then
            degrees = candidate
            return
         end if
      end do
      do neighbour = -4, 4  ! the product may round away from the angle
         candidate = angle/radians + real(neighbour, rk)*spacing(angle/radians)
         if (same_bits(candidate*radians, angle)) degrees = candidate
      end do
   end function to_degrees

   !> Equality to the last bit.
   pure logical function same_bits(a, b)
      real(rk), intent(in) :: a, b  !< [any unit]

      same_bits = transfer(a, 0_lk) == transfer(b, 0_lk)
   end function same_bits

   !> Group &domain; the rectangle x_min to y_max bounds every shape.
   pure subroutine exchange_domain(record, domain)
      type(record_t), intent(inout) :: record
      type(domain_t), intent(inout) :: domain

      call exchange(record, "shape", domain%shape)
      select case (domain%shape)
      case ("disc")
         call exchange(record, "x_centre", domain%x_centre)
         call exchange(record, "y_centre", domain%y_centre)
         call exchange(record, "radius", domain%radius)
         domain%x_min = domain%x_centre - domain%radius
         domain%x_max = domain%x_centre + domain%radius
         domain%y_min = domain%y_centre - domain%radius
         domain%y_max = domain%y_centre + domain%radius
      case ("polygon")
         call exchange(record, "x", domain%x)
         call exchange(record, "y", domain%y)
         domain%x_min = minval(domain%x)
         domain%x_max = maxval(domain%x)
         domain%y_min = minval(domain%y)
         domain%y_max = maxval(domain%y)
      case default
         call exchange(record, "x_min", domain%x_min)
         call exchange(record, "x_max", domain%x_max)
         call exchange(record, "y_min", domain%y_min)
         call exchange(record, "y_max", domain%y_max)
      end select
   end subroutine exchange_domain

   !> Group &material.
   pure subroutine exchange_material(record, material)
      type(record_t), intent(inout) :: record
      type(material_t), intent(inout) :: material
      character(len=name_length) :: plane

      call exchange_rock(record, material)
      call exchange(record, "radiation_damping", material%radiation_damping)
      plane = merge("stress", "strain", material%plane_stress)
      call exchange(record, "plane", plane)
      material%plane_stress = plane == "stress"
      call exchange(record, "storage", material%storage)
   end subroutine exchange_material

   !> Group &region. What its rock does not give is that of &material, its value before.
   pure subroutine exchange_region(record, region)
      type(record_t), intent(inout) :: record
      type(region_t), intent(inout) :: region

      call exchange(record, "name", region%name)
      call exchange(record, "shape", region%shape)
      call exchange(record, "x", region%x)
      call exchange(record, "y", region%y)
      call exchange(record, "x_other", region%x_other)
      call exchange(record, "y_other", region%y_other)
      call exchange(record, "x_vertex", region%x_vertex)
      call exchange(record, "y_vertex", region%y_vertex)
      call exchange(record, "curvature", region%curvature)
      if (record%reading .and. (record%is_set("permeability") .or. &
                                record%is_set("permeability_xx"))) then
         region%material%permeability_xy = 0.0_rk  ! where the tensor given here has none
      end if
      call exchange_rock(record, region%material)
   end subroutine exchange_region

   !> The numbers of a rock that regions may have too; its permeability is isotropic or a tensor.
   pure subroutine exchange_rock(record, material)
      type(record_t), intent(inout) :: record
      type(material_t), intent(inout) :: material

      call exchange(record, "young", material%young)
      call exchange(record, "poisson", material%poisson)
      call exchange(record, "biot", material%biot)
      call exchange(record, "porosity", material%porosity)
      if (record%reading .and. record%is_set("permeability")) then
         call exchange(record, "permeability", material%permeability_xx)
         material%permeability_yy = material%permeability_xx
      end if
      call exchange(record, "permeability_xx", material%permeability_xx, nothing=0.0_rk)
      call exchange(record, "permeability_yy", material%permeability_yy, nothing=0.0_rk)
      call exchange(record, "permeability_xy", material%permeability_xy, nothing=0.0_rk)
      call exchange(record, "density", material%density, nothing=0.0_rk)
      call exchange(record, "heat_capacity", material%heat_capacity, nothing=0.0_rk)
      call exchange(record, "heat_conductivity", material%heat_conductivity, nothing=0.0_rk)
      call exchange(record, "heat_expansion", material%heat_expansion, nothing=0.0_rk)
      call exchange(record, "toughness", material%toughness, nothing=huge(1.0_rk))
   end subroutine exchange_rock

   !> Group &side of a polygon or a disc.
   pure subroutine exchange_part(record, part)
      type(record_t), intent(inout) :: record
      type(boundary_part_t), intent(inout) :: part
      real(rk) :: arc_deg(2)

      call exchange(record, "name", part%name)
      if (record%reading) part%whole_rim = .not. (record%is_set("edges") .or. &
                                                  record%is_set("arc_from_deg"))
      call exchange(record, "edges", part%edges)
      if (.not. (part%whole_rim .or. allocated(part%edges))) then
         arc_deg = [to_degrees(part%arc(1)), to_degrees(part%arc(2))]
         call exchange(record, "arc_from_deg", arc_deg(1))
         call exchange(record, "arc_to_deg", arc_deg(2))
         part%arc = arc_deg*radians
      end if
      call exchange_side(record, part%boundary_side_t)
   end subroutine exchange_part

   !> Group &side without its name.
   pure subroutine exchange_side(record, side)
      type(record_t), intent(inout) :: record
      type(boundary_side_t), intent(inout) :: side

      if (record%reading) then
         side%displacement_given = [record%is_set("x_displacement"), &
                                    record%is_set("y_displacement")]
         side%pressure_given = record%is_set("pressure")
      end if
      call exchange(record, "time", side%course%time)
      if (side%pressure_given) call exchange_value(record, of_pressure, side%pressure, &
                                                   side%course)
      if (record%reading) side%inflow_given = record%is_set("inflow")
      call exchange_value(record, of_inflow, side%inflow, side%course, &
                          nothing=merge(huge(1.0_rk), 0.0_rk, side%inflow_given))
      call exchange_value(record, of_normal_traction, side%normal_traction, side%course, &
                          nothing=0.0_rk)
      call exchange_value(record, of_shear_traction, side%shear_traction, side%course, &
                          nothing=0.0_rk)
      if (record%reading) side%temperature_given = record%is_set("temperature")
      if (side%temperature_given) call exchange(record, "temperature", side%temperature)
      call exchange(record, "heat_flux", side%heat_flux, nothing=0.0_rk)
      call exchange(record, "x_spring", side%spring(1), nothing=0.0_rk)
      call exchange(record, "y_spring", side%spring(2), nothing=0.0_rk)
      if (record%is_set("normal_traction") .or. record%is_set("shear_traction")) return
      if (side%displacement_given(1)) then
         call exchange_value(record, of_x_displacement, side%displacement(1), side%course)
      else
         call exchange_value(record, of_x_traction, side%traction(1), side%course)
      end if
      if (side%displacement_given(2)) then
         call exchange_value(record, of_y_displacement, side%displacement(2), side%course)
      else
         call exchange_value(record, of_y_traction, side%traction(2), side%course)
      end if
   end subroutine exchange_side

   !> A quantity of a side: one value, or one value per time.
   pure subroutine exchange_value(record, quantity, value, course, nothing)
      type(record_t), intent(inout) :: record
      integer, intent(in) :: quantity  !< index into side_quantities
      real(rk), intent(inout) :: value  !< [unit of the quantity]
      type(side_course_t), intent(inout) :: course
      real(rk), intent(in), optional :: nothing  !< value of an absent name [unit of the quantity]
      real(rk), allocatable :: list(:)
      character(len=:), allocatable :: name

      name = trim(side_quantities(quantity))
      if (.not. record%reading .and. allocated(course%values(quantity)%of)) then
         call exchange(record, name, course%values(quantity)%of)
         return
      end if
      call exchange(record, name, value, nothing)
      if (.not. record%reading) return
      call exchange(record, name, list)
      if (.not. allocated(list)) return
      if (size(list) > 1) call move_alloc(list, course%values(quantity)%of)
   end subroutine exchange_value

   !> Group &restraint.
   pure subroutine exchange_restraint(record, restraint)
      type(record_t), intent(inout) :: record
      type(restraint_t), intent(inout) :: restraint
      character(len=1), parameter :: axes(2) = ["x", "y"]
      integer :: axis

      call exchange(record, "x", restraint%x)
      call exchange(record, "y", restraint%y)
      do axis = 1, 2
         if (.not. restraint%displacement_given(axis)) cycle
         call exchange(record, axes(axis)//"_displacement", restraint%displacement(axis))
      end do
   end subroutine exchange_restraint

   !> Group &point_load.
   pure subroutine exchange_point_load(record, point_load)
      type(record_t), intent(inout) :: record
      type(point_load_t), intent(inout) :: point_load

      call exchange(record, "x", point_load%x)
      call exchange(record, "y", point_load%y)
      call exchange(record, "x_force", point_load%force(1))
      call exchange(record, "y_force", point_load%force(2))
   end subroutine exchange_point_load

   !> Group &temperature.
   pure subroutine exchange_temperature(record, temperature)
      type(record_t), intent(inout) :: record
      type(temperature_t), intent(inout) :: temperature
      real(rk) :: inward_deg

      inward_deg = to_degrees(temperature%face_inward)
      call exchange(record, "change", temperature%change)
      call exchange(record, "change_per_x", temperature%per_metre(1))
      call exchange(record, "change_per_y", temperature%per_metre(2))
      call exchange(record, "x_datum", temperature%datum(1))
      call exchange(record, "y_datum", temperature%datum(2))
      call exchange(record, "face_change", temperature%face_change, nothing=0.0_rk)
      call exchange(record, "face_depth", temperature%face_depth, nothing=0.0_rk)
      call exchange(record, "face_x", temperature%face(1))
      call exchange(record, "face_y", temperature%face(2))
      call exchange(record, "face_inward_deg", inward_deg)
      temperature%face_inward = inward_deg*radians
   end subroutine exchange_temperature

end module scene_exchange_values
