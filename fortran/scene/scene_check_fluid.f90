!> Checks the laws of density and viscosity of the fluid, and the wells of a scene.
module scene_check_fluid
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use base_number, only: integer_text
   use base_tolerances, only: same_place
   use scene_check_geometry, only: contains_point, distance_to, point_text
   use scene_exchange, only: nearest_fracture
   use scene_fluid_law, only: fluid_law_t, has_law, new_fluid_law
   use scene_parameters, only: groups
   use scene_sheet, only: group_index, parameter_index, record_t, refuse, sheet_t
   use scene_types, only: entry_t, fluid_t, injection_t, name_length, scene_t
   use scene_values, only: value_t
   use scene_words, only: nearest_word, real_text, rounded_text
   implicit none(type, external)
   private

   public :: check_fluid, check_given_fluid, check_given_wells, check_wells

   !> Largest relative difference of viscosity or compressibility from the table at the reference
   !! pressure, for rounded values [-].
   real(rk), parameter :: rounding = 0.02_rk

contains

   !> Pressures of a table are given exactly with a table, and a reference pressure only with a law.
   pure subroutine check_given_fluid(sheet, error)
      type(sheet_t), intent(in) :: sheet
      type(error_t), allocatable, intent(out) :: error
      type(record_t) :: record
      type(value_t) :: density, viscosity
      logical :: is_table
      integer :: i

      if (.not. sheet%has("fluid")) return
      i = sheet%find("fluid")
      record = sheet%records(i)
      density = record%value("density_law")
      viscosity = record%value("viscosity_law")
      is_table = density%text == "table" .or. viscosity%text == "table"
      if (is_table .and. .not. record%is_set("table_pressure")) then
         call refuse(error, sheet, i, "table_pressure", "is missing but must be given with a table")
      else if (.not. is_table .and. record%is_set("table_pressure")) then
         call refuse(error, sheet, i, "table_pressure", "is given, but neither "// &
                     "viscosity_law nor density_law is 'table'")
      else if (density%text == "linear" .and. viscosity%text == "constant" .and. &
               record%is_set("reference_pressure")) then
         call refuse(error, sheet, i, "reference_pressure", "is given, but neither "// &
                     "viscosity_law nor density_law depends on it; omit it")
      end if
   end subroutine check_given_fluid

   !> Pressures of a table increase and enclose the reference pressure, at which the values of the
   !! rock are those of the table.
   pure subroutine check_fluid(sheet, fluid, error)
      type(sheet_t), intent(in) :: sheet
      type(fluid_t), intent(in) :: fluid
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      if (.not. has_law(fluid)) return
      i = sheet%find("fluid")
      if (allocated(fluid%table_pressure)) then
         call check_pressures(sheet, i, fluid, error)
         if (.not. allocated(error) .and. fluid%viscosity_law == "table") then
            call check_length(sheet, i, "table_viscosity", fluid%table_viscosity, fluid, error)
         end if
         if (.not. allocated(error) .and. fluid%density_law == "table") then
            call check_length(sheet, i, "table_density", fluid%table_density, fluid, error)
            if (.not. allocated(error)) call check_density(sheet, i, fluid, error)
         end if
         if (.not. allocated(error)) call check_rock(sheet, i, fluid, error)
      end if
      if (allocated(error)) return
      if (fluid%density_law == "exponential" .and. .not. fluid%compressibility > 0.0_rk) then
         call refuse(error, sheet, i, "density_law", "is 'exponential', which takes a "// &
                     "compressibility that is positive, and not 0.0")
      end if
   end subroutine check_fluid

   !> The pressures of a table increase and enclose the reference pressure.
   pure subroutine check_pressures(sheet, i, fluid, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: i  !< record
      type(fluid_t), intent(in) :: fluid
      type(error_t), allocatable, intent(out) :: error
      integer :: n

      associate (p => fluid%table_pressure, reference => fluid%reference_pressure)
         n = size(p)
         if (n < 2) then
            call refuse(error, sheet, i, "table_pressure", "has 1 value but must have at least two")
         else if (.not. all(p(2:) > p(:n - 1))) then
            call refuse(error, sheet, i, "table_pressure", "must increase, but does not from "// &
                        real_text(p(falls(p)))//" to "//real_text(p(falls(p) + 1)))
         else if (reference < p(1) .or. reference > p(n)) then
            call refuse(error, sheet, i, "table_pressure", "reaches from "//real_text(p(1))// &
                        " to "//real_text(p(n))//" but must contain the reference_pressure, "// &
                        real_text(reference))
         end if
      end associate
   end subroutine check_pressures

   !> Index of the first value that is not below the next one.
   pure integer function falls(list)
      real(rk), intent(in) :: list(:)  !< [any unit]

      falls = findloc(list(2:) > list(:size(list) - 1), .false., dim=1)
   end function falls

   !> A list has a value per pressure of the table.
   pure subroutine check_length(sheet, i, name, list, fluid, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: i  !< record
      character(len=*), intent(in) :: name
      real(rk), intent(in) :: list(:)  !< [unit of the name]
      type(fluid_t), intent(in) :: fluid
      type(error_t), allocatable, intent(out) :: error

      if (size(list) == size(fluid%table_pressure)) return
      call refuse(error, sheet, i, name, "has "//integer_text(size(list, kind=ik))// &
                  merge(" value ", " values", size(list) == 1)//" but must have one for each "// &
                  "table_pressure, "//integer_text(size(fluid%table_pressure, kind=ik)))
   end subroutine check_length

   !> Densities do not decrease with pressure.
   pure subroutine check_density(sheet, i, fluid, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: i  !< record
      type(fluid_t), intent(in) :: fluid
      type(error_t), allocatable, intent(out) :: error
      integer :: k

      associate (density => fluid%table_density)
         do k = 1, size(density) - 1
            if (density(k + 1) >= density(k)) cycle
            call refuse(error, sheet, i, "table_density", "must not decrease, but does from "// &
                        real_text(density(k))//" to "//real_text(density(k + 1)))
            return
         end do
      end associate
   end subroutine check_density

   !> At the reference pressure, the viscosity of the rock is that of the table, and its
   !! compressibility is between those of the adjacent intervals of the table.
   pure subroutine check_rock(sheet, i, fluid, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: i  !< record
      type(fluid_t), intent(in) :: fluid
      type(error_t), allocatable, intent(out) :: error
      type(fluid_law_t) :: law
      real(rk) :: bounds(2), viscosity

      law = new_fluid_law(fluid)
      if (fluid%viscosity_law == "table") then
         viscosity = fluid%viscosity*law%thickness_at(fluid%reference_pressure)
         if (abs(viscosity - fluid%viscosity) > rounding*viscosity) then
            call refuse(error, sheet, i, "viscosity", "is "//real_text(fluid%viscosity)// &
                        " but must be that of the table at reference_pressure, "// &
                        rounded_text(viscosity)//", which the rock takes")
            return
         end if
      end if
      if (fluid%density_law /= "table") return
      bounds = law%compressibility(law%reference - 1:law%reference)
      ! Beyond an end of the table there is no interval.
      if (law%reference == 1) bounds(1) = bounds(2)
      if (law%reference == size(law%pressure)) bounds(2) = bounds(1)
      if (fluid%compressibility < (1.0_rk - rounding)*minval(bounds) .or. &
          fluid%compressibility > (1.0_rk + rounding)*maxval(bounds)) then
         call refuse(error, sheet, i, "compressibility", "is "// &
                     real_text(fluid%compressibility)//" but must be that of the table at "// &
                     "reference_pressure, "//rounded_text(0.5_rk*sum(bounds))// &
                     ", which the rock takes")
      end if
   end subroutine check_rock

   !> Each well has a fracture of the scene or a point, and a rate or a pressure.
   pure subroutine check_given_wells(sheet, error)
      type(sheet_t), intent(in) :: sheet
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      do i = 1, sheet%length
         associate (record => sheet%records(i))
            if (groups(record%group)%name /= "injection") cycle
            if (record%is_given("fracture")) then
               call check_target(sheet, i, error)
               if (.not. allocated(error)) call check_entries(sheet, i, error)
               if (allocated(error)) return
               if (record%is_given("radius")) then
                 call refuse(error, sheet, i, "radius", "is given, but only a well in the rock "// &
                              "has one, and this one is in a fracture")
               end if
            else if (.not. record%is_given("x")) then
             call refuse(error, sheet, i, "fracture", "is missing: a well needs a fracture, or "// &
                           "x and y in the rock")
            else
               call check_entries(sheet, i, error)
            end if
            if (allocated(error)) return
            if (.not. (record%is_set("rate") .or. record%is_set("pressure"))) then
               call refuse(error, sheet, i, "rate", "is missing: a well needs a rate, a "// &
                           "pressure, or both")
            else if (record%is_given("time") .and. record%is_given("start")) then
               call refuse(error, sheet, i, "start", "is given with time, whose first value "// &
                           "determines it, but must not be")
            end if
            if (allocated(error)) return
         end associate
      end do
   end subroutine check_given_wells

   !> Each entry of a well is in another fracture and has one value of each list; a well in the
   !! rock has no entries.
   pure subroutine check_entries(sheet, well, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: well  !< index into sheet%records
      type(error_t), allocatable, intent(out) :: error
      character(len=10), parameter :: lists(3) = [character(len=10) :: "x", "y", "entry_loss"]
      type(value_t) :: fracture, list
      character(len=:), allocatable :: right
      integer :: i, n

      n = 1
      fracture = sheet%records(well)%value("fracture")
      if (fracture%is_set) then
         n = size(fracture%names)
         do i = 2, n
            if (all(fracture%names(:i - 1) /= fracture%names(i))) cycle
            call refuse(error, sheet, well, "fracture", "names '"//trim(fracture%names(i))// &
                        "' twice, but the entries of a well must be in different fractures")
            return
         end do
      else if (sheet%records(well)%is_set("entry_loss")) then
        call refuse(error, sheet, well, "entry_loss", "is given, but a well in the rock has no "// &
                     "entries; use friction")
         return
      end if
      do i = 1, size(lists)
         list = sheet%records(well)%value(trim(lists(i)))
         if (.not. list%is_set) cycle
         if (size(list%reals) == n .or. (i == 3 .and. size(list%reals) == 1)) cycle
         right = "one"
         if (n > 1) right = "as many as fracture, "//integer_text(int(n, ik))
         call refuse(error, sheet, well, trim(lists(i)), "has "// &
                     integer_text(size(list%reals, kind=ik))//" values but must have "//right)
         return
      end do
   end subroutine check_entries

   !> The fractures of a well are some of the scene.
   pure subroutine check_target(sheet, well, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: well  !< index into sheet%records
      type(error_t), allocatable, intent(out) :: error
      type(value_t) :: wanted
      character(len=name_length), allocatable :: names(:)
      character(len=:), allocatable :: likely, name, reason
      integer :: e, group, i, item, n

      group = group_index("fracture")
      item = parameter_index(group, "name")
      allocate (names(count(sheet%records(:sheet%length)%group == group)))
      n = 0
      do i = 1, sheet%length
         if (sheet%records(i)%group /= group) cycle
         n = n + 1
         names(n) = sheet%records(i)%values(item)%text
      end do
      wanted = sheet%records(well)%value("fracture")
      do e = 1, size(wanted%names)
         if (any(names == wanted%names(e))) cycle
         if (wanted%names(e) == nearest_fracture .and. size(names) > 0) then
            if (size(wanted%names) == 1 .and. sheet%records(well)%is_set("x")) cycle
         call refuse(error, sheet, well, "fracture", "is '"//nearest_fracture//"', which needs "// &
                        "x and y, and must be the only one")
            return
         end if
         name = trim(wanted%names(e))
         reason = "is '"//name//"', which is no fracture of the scene"
         if (size(names) == 0) reason = "is '"//name//"', but the scene has no fracture"
         likely = nearest_word(name, names)
         if (likely /= "") reason = reason//"; the nearest is '"//likely//"'"
         call refuse(error, sheet, well, "fracture", reason)
         return
      end do
   end subroutine check_target

   !> Stages, pressures, positions and names of the wells.
   pure subroutine check_wells(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      integer :: i, record

      do i = 1, size(scene%injections)
         record = sheet%find("injection", i)
         call check_stages(sheet, record, scene%injections(i), error)
         if (.not. allocated(error)) call check_pressure(sheet, record, scene, i, error)
         if (.not. allocated(error)) call check_place(sheet, record, scene, i, error)
         if (.not. allocated(error) .and. any(scene%injections(:i - 1)%name &
                                              == scene%injections(i)%name)) then
            call refuse(error, sheet, record, "name", "is '"//trim(scene%injections(i)%name)// &
                        "', as another well is called, but must be unique")
         end if
         if (allocated(error)) return
      end do
      if (scene%adaptive%enabled .and. scene%has_fluid()) call check_adaptive(sheet, scene, error)
   end subroutine check_wells

   !> With a fluid, the mesh is adapted before the first step, to wells in fractures.
   pure subroutine check_adaptive(sheet, scene, error)
      type(sheet_t), intent(in) :: sheet
      type(scene_t), intent(in) :: scene
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: reason

      if (scene%growth%enabled) then
         reason = "the mesh is adapted to the fractures before they grow, and &growth is enabled"
      else if (size(scene%injections) == 0) then
         reason = "the mesh is adapted to the response to wells, and there is no &injection"
      else if (any(scene%injections%fracture == 0)) then
         reason = "the pressure of a well in the rock depends on the size of its cell"
      else
         return
      end if
      call refuse(error, sheet, sheet%find("adaptive"), "enabled", &
                  "is .true., but with &fluid "//reason)
   end subroutine check_adaptive

   !> Stages have as many rates and pressures as times, which increase, and end after the last
   !! start.
   pure subroutine check_stages(sheet, record, well, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      type(injection_t), intent(in) :: well
      type(error_t), allocatable, intent(out) :: error
      integer(ik) :: k, n
      character(len=:), allocatable :: last

      n = well%stage_count()
      if (allocated(well%rate)) call check_count(sheet, record, "rate", size(well%rate, kind=ik), &
                                                 n, error)
      if (allocated(well%pressure) .and. .not. allocated(error)) then
         call check_count(sheet, record, "pressure", size(well%pressure, kind=ik), n, error)
      end if
      if (allocated(error)) return
      do k = 2, n
         if (well%time(k) > well%time(k - 1)) cycle
         call refuse(error, sheet, record, "time", "decreases: stage "//integer_text(k)// &
                     " begins at "//real_text(well%time(k))//", but must begin after stage "// &
                     integer_text(k - 1_ik)//", "//real_text(well%time(k - 1)))
         return
      end do
      if (well%end > well%stage_start(n)) return
      last = "start, "
      if (n > 1) last = "the beginning of the last stage, "
      call refuse(error, sheet, record, "end", "is "//real_text(well%end)//" but must be after "// &
                  last//real_text(well%stage_start(n)))
   end subroutine check_stages

   !> The pressure of a well in a fracture is at least the vapour pressure.
   pure subroutine check_pressure(sheet, record, scene, i, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: i  !< well
      type(error_t), allocatable, intent(out) :: error

      associate (well => scene%injections(i), lowest => scene%fluid%vapour_pressure)
         if (well%fracture == 0 .or. .not. allocated(well%pressure)) return
         if (.not. any(well%pressure < lowest)) return
         call refuse(error, sheet, record, "pressure", "is "//real_text(minval(well%pressure))// &
                     " but must be at least the vapour pressure, "//real_text(lowest))
      end associate
   end subroutine check_pressure

   !> A list has one value for all stages, or one per stage.
   pure subroutine check_count(sheet, record, name, given, stages, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      character(len=*), intent(in) :: name
      integer(ik), intent(in) :: given, stages
      type(error_t), allocatable, intent(out) :: error
      character(len=:), allocatable :: right

      if (given == stages) return
      right = "one"
      if (stages > 1) right = "as many as time, "//integer_text(stages)
      call refuse(error, sheet, record, name, "has "//integer_text(given)// &
                  " values but must have "//right)
   end subroutine check_count

   !> The point of a well lies within a cell size of its fracture, or in the body.
   pure subroutine check_place(sheet, record, scene, i, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: i  !< well
      type(error_t), allocatable, intent(out) :: error
      type(entry_t), allocatable :: entries(:)
      real(rk) :: distance
      integer :: e

      associate (well => scene%injections(i))
         if (.not. well%at_point) return
         if (well%fracture == 0) then
            if (.not. contains_point(scene%domain, well%x, well%y)) then
               call refuse(error, sheet, record, "x", "and y are "//point_text(well%x, well%y)// &
                           " but must lie within the domain")
            else if (well%is_controlled()) then
               call check_radius(sheet, record, scene, well, error)
            end if
            return
         end if
         entries = [entry_t(well%fracture, well%x, well%y)]
         if (allocated(well%entries)) entries = well%entries
      end associate
      do e = 1, size(entries)
         associate (entry => entries(e), size => scene%cell_size_of(entries(e)%fracture))
            if (any(abs(entries(:e - 1)%x - entry%x) + abs(entries(:e - 1)%y - entry%y) &
                    <= same_place*size)) then
               call refuse(error, sheet, record, "x", "and y are "//point_text(entry%x, &
                                    entry%y)//" for two entries, which must be at different points")
               return
            end if
            distance = distance_to(scene%fractures(entry%fracture), entry%x, entry%y)
            if (distance <= size) cycle
            call refuse(error, sheet, record, "x", "and y are "// &
                        point_text(entry%x, entry%y)//", "//rounded_text(distance)// &
                        " m away from fracture '"//trim(scene%fractures(entry%fracture)%name)// &
                        "', but must be within size_fracture, "//real_text(size)//" m")
            return
         end associate
      end do
   end subroutine check_place

   !> A well in the rock with pressure control is thin compared with its cell, and its pressure loss
   !! is linear (coarse_wells).
   pure subroutine check_radius(sheet, record, scene, well, error)
      type(sheet_t), intent(in) :: sheet
      integer, intent(in) :: record
      type(scene_t), intent(in) :: scene
      type(injection_t), intent(in) :: well
      type(error_t), allocatable, intent(out) :: error
      real(rk), parameter :: share = 0.05_rk  ! largest radius over the cell size
      real(rk) :: size

      size = scene%discretization%size_boundary
      if (scene%has_fractures()) size = scene%smallest_cell()
      if (well%turbulence > 0.0_rk) then
        call refuse(error, sheet, record, "turbulence", "is given, but a well in the rock with "// &
                     "a pressure control must not have it")
      else if (well%radius > share*size) then
      call refuse(error, sheet, record, "radius", "is "//real_text(well%radius)//" but must be "// &
                     "at most a twentieth of the smallest cells, "//rounded_text(share*size)// &
                     ", for a well with a pressure control")
      end if
   end subroutine check_radius

end module scene_check_fluid
